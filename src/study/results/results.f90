!> Results of the tasks of a study, by the names of tables and columns.
module gearsweep_study_results_results
  use gearsweep_base, only: axis, claim_memory, dp, error_t, no_number, table_t
  use gearsweep_gear, only: drive
  use gearsweep_rating, only: beam_t, hassan_shape
  use gearsweep_study_case_published, only: split_quantity
  use gearsweep_study_run_study, only: study_t
  use gearsweep_study_results_motion_table, only: motion_table
  implicit none
  private
  public :: get_result, column_of, published_table, our_value

contains

  !> Copies the table of this name; an empty one if no task has it. `error`: out of memory.
  pure subroutine get_result(study, name, table, error)
    type(study_t), intent(in) :: study
    character(*), intent(in) :: name
    type(table_t), intent(out) :: table
    type(error_t), allocatable, intent(inout) :: error
    integer :: i, at

    table%name = trim(name)
    if (name == 'motion') call motion_table(study, table, error)
    if (allocated(error) .or. .not. allocated(study%tasks)) return
    do i = 1, size(study%tasks)
      associate (task => study%tasks(i)%task)
        if (.not. task%is_done) cycle
        at = task%place(trim(name))
        if (at == 0) cycle
        if (.not. task%tables(at)%is_there()) cycle
        call claim_memory(task%tables(at)%bytes(), 'the table '//trim(name), error)
        if (.not. allocated(error)) table = task%tables(at)
        return
      end associate
    end do
  end subroutine get_result

  !> Numbers of a column by the names of table and column; none if the study does not have the table.
  pure function column_of(study, table_name, name) result(numbers)
    type(study_t), intent(in) :: study
    character(*), intent(in) :: table_name, name
    real(dp), allocatable :: numbers(:)
    type(table_t) :: table
    type(error_t), allocatable :: error

    allocate (numbers(0))
    call get_result(study, table_name, table, error)
    if (table%is_there()) numbers = table%numbers(name)
  end function column_of

  !> Fills the table of printed and computed values; NaN where no task computes a value.
  pure subroutine published_table(study, table, error)
    type(study_t), intent(in) :: study
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: ours(:)
    logical :: known
    integer :: i, longest

    if (.not. allocated(study%published)) return
    associate (rows => study%published)
      call table%begin('printed values and ours', size(rows), error)
      if (allocated(error)) return
      longest = maxval([(len(rows(i)%quantity), len(rows(i)%place), len(rows(i)%unit), len(rows(i)%status), &
                         len(rows(i)%reason), i=1, size(rows)), 1])
      block
        character(longest) :: words(size(rows), 5)

        allocate (ours(size(rows)))
        do i = 1, size(rows)
          call our_value(study, rows(i)%quantity, ours(i), known)
          if (.not. known) ours(i) = no_number()
          words(i, 1) = rows(i)%quantity
          words(i, 2) = rows(i)%place
          words(i, 3) = rows(i)%unit
          words(i, 4) = rows(i)%status
          words(i, 5) = rows(i)%reason
        end do
        call table%add_index(axis('quantity', '', 'what is printed', words(:, 1)))
        call table%add_words('place', 'where it is printed', words(:, 2))
        call table%add('printed', '', 'the printed value, in the unit of its row', [rows%printed])
        call table%add('ours', '', 'our value; NaN where the tasks do not compute it', ours)
        call table%add('deviation', '', 'ours over the printed value, less 1', ours/rows%printed - 1)
        call table%add_words('unit', 'of both values', words(:, 3))
        call table%add_words('status', 'of the inputs: stated, inferred, fitted or not reproducible', words(:, 4))
        call table%add_words('reason', 'for the status', words(:, 5))
      end block
    end associate
  end subroutine published_table

  !> Returns the computed value of a named quantity; `known` is false if the study does not have it.
  pure subroutine our_value(study, quantity, value, known)
    type(study_t), intent(in) :: study
    character(*), intent(in) :: quantity
    real(dp), intent(out) :: value
    logical, intent(out) :: known
    character(:), allocatable :: name
    integer :: n

    value = 0
    known = allocated(study%pair)
    if (.not. known) return
    call split_quantity(quantity, name, n)
    associate (angle => study%pair%gear(1)%spec%pressure_angle(drive))
      select case (name)
      case ('contact_ratio')
        call read_row(study, 'geometry', 'contact_ratio', 1, value, known)
      case ('tangential_force_n')
        call read_row(study, 'motion', 'load_n', 1, value, known)
        value = value*cos(angle)
      case ('radial_force_n')
        call read_row(study, 'motion', 'load_n', 1, value, known)
        value = value*sin(angle)
      case ('mode_#_hz')
        call read_row(study, 'modal', 'frequency_hz', n, value, known)
      case ('step_#_sigma_x_mpa', 'step_#_sigma_y_mpa', 'step_#_tau_xy_mpa')
        ! Each position has two rows; printed sizes are those of the coast side, the second row.
        call read_row(study, 'static', name(len('step_#_') + 1:), 2*n, value, known)
        value = abs(value)
      case default
        call beam_value(study, name, value, known)
      end select
    end associate
  end subroutine our_value

  !> Reads a row of a table's column; `known` is false if there is no such row.
  pure subroutine read_row(study, table, column, row, value, known)
    type(study_t), intent(in) :: study
    character(*), intent(in) :: table, column
    integer, intent(in) :: row
    real(dp), intent(inout) :: value
    logical, intent(out) :: known
    real(dp), allocatable :: numbers(:)

    numbers = column_of(study, table, column)
    known = row <= size(numbers)
    if (known) value = numbers(row)
  end subroutine read_row

  !> Computes values of the tooth as a beam: its height is that from root to reference circle, its thickness that on the reference
  !> circle.
  pure subroutine beam_value(study, quantity, value, known)
    type(study_t), intent(in) :: study
    character(*), intent(in) :: quantity
    real(dp), intent(out) :: value
    logical, intent(out) :: known
    type(error_t), allocatable :: error
    type(beam_t) :: beam
    real(dp) :: stress(2)

    known = .true.
    value = 0
    associate (gear => study%pair%gear(study%gear), material => study%case%material(study%gear))
      beam = beam_t(gear%tip_radius - gear%root_radius, gear%thickness(gear%reference_radius), gear%spec%face_width)
      select case (quantity)
      case ('beam_frequency_rad_s')
        value = beam%spring_frequency(material)
      case ('rayleigh_frequency_rad_s')
        call beam%rayleigh_frequency(material, hassan_shape, value, error)
        known = .not. allocated(error)
      case ('beam_sigma_x_mpa', 'beam_sigma_y_mpa')
        known = study%load > 0
        beam%length = gear%reference_radius - gear%root_radius
        stress = beam%stress(study%load, gear%spec%pressure_angle(drive))
        value = 1e-6_dp*merge(stress(1), stress(2), quantity == 'beam_sigma_x_mpa')
      case default
        known = .false.
      end select
    end associate
  end subroutine beam_value
end module gearsweep_study_results_results
