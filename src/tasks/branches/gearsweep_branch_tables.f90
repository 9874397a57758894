!> The tables of the task `branches`.
module gearsweep_branch_tables
  use gearsweep_bifurcation, only: branch_point_t, end_name, kind_grazing, kind_name, special_curve_t, whole_branch_t, width
  use gearsweep_case_family, only: case_family_t
  use gearsweep_case_variation, only: of_damping, of_force, of_relief, of_rpm
  use gearsweep_decimal, only: in_um
  use gearsweep_error, only: error_t
  use gearsweep_kinds, only: dp
  use gearsweep_periodic_orbit, only: steady_t
  use gearsweep_points, only: of_periods, of_relief_amount => of_relief, of_speed
  use gearsweep_sweep, only: contact_name, contact_of
  use gearsweep_table, only: axis, no_number, table_t
  implicit none
  private
  public :: branch_set_t, fill_branches, fill_points, fill_changes, fill_curves

  !> What was found of one amount of relief.
  type :: branch_set_t
    type(case_family_t) :: family
    type(whole_branch_t), allocatable :: branch(:)
    integer :: unresolved = 0                    !< seeds whose speed is too low
    type(case_family_t) :: plane                 !< over both parameters, where there is a second one
    type(special_curve_t), allocatable :: curve(:)
  end type branch_set_t

  !> Where a row stands: which set, branch and point.
  type :: row_t
    integer :: set = 0, branch = 0, at = 0, number = 0
  end type row_t

  integer, parameter :: word = 8
  real(dp), parameter :: neutral = 1e-7_dp        ! a multiplier this close to 1 counts as 1
  character(*), parameter :: of_branch = 'which branch', of_damping_ratio = 'damping ratio', of_normal_force = 'static load', &
    of_dynamic_factor = 'dynamic factor DF: largest load of a pair over the static load', &
    of_contact = 'full; partial: a pair was apart for a while; lost: all were; coast: the coast sides touched'

contains

  !> A row for each branch.
  pure subroutine fill_branches(found, table, error)
    type(branch_set_t), intent(in) :: found(:)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    type(row_t), allocatable :: rows(:)
    real(dp), allocatable :: values(:, :)
    integer, allocatable :: counts(:, :), ends(:, :)
    integer :: i

    if (allocated(error)) return
    allocate (rows(0))
    call list_rows(found, 0, rows)
    call table%begin('branches of periodic motions over the parameter', size(rows), error)
    if (allocated(error)) return
    allocate (values(size(rows), 4), counts(size(rows), 4), ends(size(rows), 2))
    do i = 1, size(rows)
      associate (b => found(rows(i)%set)%branch(rows(i)%branch), family => found(rows(i)%set)%family)
        values(i, 1) = in_um(family%case%relief)
        if (family%which(1) == of_relief) values(i, 1) = no_number()
        values(i, 2) = min(minval(b%point%value), minval(b%special%point%value))
        values(i, 3) = max(maxval(b%point%value), maxval(b%special%point%value))
        values(i, 2:3) = values(i, 2:3)*merge(1e6_dp, 1.0_dp, family%which(1) == of_relief)
        values(i, 4) = max(maxval(b%point%dynamic_factor), maxval(b%special%point%dynamic_factor))
        counts(i, :) = [rows(i)%number, b%periods, size(b%point), count(b%point%modulus < 1 - neutral)]
        ends(i, :) = b%ends
      end associate
    end do
    call table%add_index(axis('branch', '', of_branch, counts(:, 1)))
    call table%add('relief_um', 'um', of_relief_amount//'; NaN where it is the parameter', values(:, 1))
    call table%add('mesh_periods', '', of_periods, counts(:, 2))
    call table%add('least', '', 'least value of the parameter, in the unit of its name', values(:, 2))
    call table%add('largest', '', 'largest value of the parameter', values(:, 3))
    call table%add('largest_dynamic_factor', '', 'largest DF on the branch', values(:, 4))
    call table%add('points', '', 'points followed', counts(:, 3))
    call table%add('stable_points', '', 'of these, where the motion attracts', counts(:, 4))
    call table%add_words('first_end', 'how it ends where its points begin: range: of the parameter; closed: in itself; '// &
                         'doubling: in a motion of half the period, whose period doubles there; lost: Newton''s method does '// &
                         'not go on; length: so many points', end_name(ends(:, 1)))
    call table%add_words('last_end', 'how it ends where its points end', end_name(ends(:, 2)))
  end subroutine fill_branches

  !> A row for each point of each branch.
  pure subroutine fill_points(found, table, error)
    type(branch_set_t), intent(in) :: found(:)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    type(row_t), allocatable :: rows(:)
    real(dp), allocatable :: states(:, :)
    integer, allocatable :: at(:), number(:)
    integer :: i

    if (allocated(error)) return
    allocate (rows(0))
    call list_rows(found, 1, rows)
    call table%begin('points of the branches, from one end to the other', size(rows), error)
    if (allocated(error)) return
    allocate (states(size(rows), 2), at(size(rows)), number(size(rows)))
    do i = 1, size(rows)
      associate (b => found(rows(i)%set)%branch(rows(i)%branch))
        states(i, :) = b%scale*b%point(rows(i)%at)%z(:2)
        at(i) = rows(i)%at
        number(i) = rows(i)%number
      end associate
    end do
    call table%add_index(axis('branch', '', of_branch, number))
    call table%add_index(axis('point', '', 'which of its points', at))
    call add_motions(found, rows, .false., table)
    call table%add('dte_um', 'um', 'dynamic transmission error as a new pair enters', 1e6_dp*states(:, 1))
    call table%add('dte_rate_mm_s', 'mm/s', 'rate of the dynamic transmission error as a new pair enters: the motion can be '// &
                   'continued from both', 1e3_dp*states(:, 2))
  end subroutine fill_points

  !> A row for each fold, doubling and grazing.
  pure subroutine fill_changes(found, table, error)
    type(branch_set_t), intent(in) :: found(:)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    type(row_t), allocatable :: rows(:)
    real(dp), allocatable :: phase(:), enclosed(:)
    integer, allocatable :: after(:), kind(:), period(:), number(:)
    integer :: i

    if (allocated(error)) return
    allocate (rows(0))
    call list_rows(found, 2, rows)
    call table%begin('where the motion changes its kind along a branch', size(rows), error)
    if (allocated(error)) return
    allocate (phase(size(rows)), enclosed(size(rows)), after(size(rows)), kind(size(rows)), period(size(rows)), &
              number(size(rows)))
    do i = 1, size(rows)
      associate (family => found(rows(i)%set)%family)
        associate (special => found(rows(i)%set)%branch(rows(i)%branch)%special(rows(i)%at))
          phase(i) = no_number()
          if (special%overlap%contact > 0) phase(i) = special%overlap%phase
          period(i) = special%overlap%period
          enclosed(i) = special%enclosed/width*(family%last(1) - family%first(1)) &
                        *merge(1e6_dp, 1.0_dp, family%which(1) == of_relief)
          after(i) = special%after
          kind(i) = special%kind
          number(i) = rows(i)%number
        end associate
      end associate
    end do
    call table%add_index(axis('branch', '', of_branch, number))
    call table%add_words('kind', 'fold: a Floquet multiplier is 1, and the branch turns back; doubling: one is -1; '// &
                         'grazing: the overlap of a contact is 0 where it is smallest or largest, or where a pair enters or '// &
                         'leaves; vertical: a line of motions begins at one value of the parameter; unknown: contact or '// &
                         'stability changes between this point and the one before, and it is not known how', kind_name(kind))
    call table%add('after_point', '', 'the point of the branch before it', after)
    call add_motions(found, rows, .true., table)
    call table%add('phase', '', 'of grazing, the mesh phase; NaN where it is not known or no grazing', phase)
    call table%add('in_period', '', 'of grazing, in which of the mesh periods; 0 as above', period)
    call table%add('enclosed', '', 'between motions so far apart it is enclosed, as a distance in the unit of the parameter''s '// &
                   'name', enclosed)
  end subroutine fill_changes

  !> A row for each point of each curve over both parameters.
  pure subroutine fill_curves(found, table, error)
    type(branch_set_t), intent(in) :: found(:)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: numbers(:, :), values(:, :)
    integer, allocatable :: counts(:, :), ends(:, :)
    integer :: i, k, m, n, curve

    if (allocated(error)) return
    n = sum([((size(found(i)%curve(k)%point), k=1, size(found(i)%curve)), i=1, size(found))])
    call table%begin('curves of folds, doublings and grazings over both parameters', n, error)
    if (allocated(error)) return
    allocate (numbers(n, 4), values(n, 2), counts(n, 4), ends(n, 2))
    n = 0
    curve = 0
    do i = 1, size(found)
      do k = 1, size(found(i)%curve)
        curve = curve + 1
        do m = 1, size(found(i)%curve(k)%point)
          n = n + 1
          associate (point => found(i)%curve(k)%point(m))
            numbers(n, :) = found(i)%plane%numbers_at(point%value)
            values(n, :) = [point%dynamic_factor, merge(point%phase, no_number(), found(i)%curve(k)%kind == kind_grazing)]
            counts(n, :) = [curve, m, found(i)%curve(k)%kind, found(i)%curve(k)%periods]
            ends(n, :) = found(i)%curve(k)%ends
          end associate
        end do
      end do
    end do
    call table%add_index(axis('curve', '', 'which curve', counts(:, 1)))
    call table%add_index(axis('point', '', 'which of its points', counts(:, 2)))
    call table%add_words('kind', 'fold, doubling or grazing, all along the curve', kind_name(counts(:, 3)))
    call table%add('rpm', '1/min', of_speed, numbers(:, of_rpm))
    call table%add('damping_ratio', '', of_damping_ratio, numbers(:, of_damping))
    call table%add('relief_um', 'um', of_relief_amount, in_um(numbers(:, of_relief)))
    call table%add('normal_force_n', 'N', of_normal_force, numbers(:, of_force))
    call table%add('dynamic_factor', '', of_dynamic_factor, values(:, 1))
    call table%add('mesh_periods', '', of_periods, counts(:, 4))
    call table%add('phase', '', 'of grazing, the mesh phase; else NaN', values(:, 2))
    call table%add_words('first_end', 'how the curve ends where its points begin: range: of one of both numbers; closed: in '// &
                         'itself; lost: it does not go on, as where it meets a grazing; length: so many points', &
                         end_name(ends(:, 1)))
    call table%add_words('last_end', 'how the curve ends where its points end', end_name(ends(:, 2)))
  end subroutine fill_curves

  !> The columns of a motion.
  pure subroutine add_motions(found, rows, special, table)
    type(branch_set_t), intent(in) :: found(:)
    type(row_t), intent(in) :: rows(:)
    logical, intent(in) :: special               ! those of changes, not of points
    type(table_t), intent(inout) :: table
    type(branch_point_t) :: point
    real(dp), allocatable :: numbers(:, :), values(:, :)
    integer, allocatable :: periods(:), contact(:)
    character(word), allocatable :: stability(:)
    integer :: i

    allocate (numbers(size(rows), 4), values(size(rows), 2), periods(size(rows)), contact(size(rows)), stability(size(rows)))
    do i = 1, size(rows)
      associate (b => found(rows(i)%set)%branch(rows(i)%branch), family => found(rows(i)%set)%family)
        if (special) point = b%special(rows(i)%at)%point
        if (.not. special) point = b%point(rows(i)%at)
        numbers(i, :) = family%numbers_at([point%value, 0.0_dp])
        periods(i) = b%periods
      end associate
      values(i, :) = [point%dynamic_factor, point%modulus]
      contact(i) = contact_of(steady_t(partial=point%partial, lost=point%lost, coast=point%coast))
      stability(i) = 'unstable'
      if (point%modulus <= 1 + neutral) stability(i) = 'marginal'
      if (point%modulus < 1 - neutral) stability(i) = 'stable'
    end do
    call table%add('rpm', '1/min', of_speed, numbers(:, of_rpm))
    call table%add('damping_ratio', '', of_damping_ratio, numbers(:, of_damping))
    call table%add('relief_um', 'um', of_relief_amount, in_um(numbers(:, of_relief)))
    call table%add('normal_force_n', 'N', of_normal_force, numbers(:, of_force))
    call table%add('dynamic_factor', '', of_dynamic_factor, values(:, 1))
    call table%add('mesh_periods', '', of_periods, periods)
    call table%add('floquet_modulus', '', 'largest modulus of the Floquet multipliers', values(:, 2))
    call table%add_words('stability', 'stable: the motion attracts; unstable: it repels; marginal: neither, to 1e-7', stability)
    call table%add_words('contact', of_contact, contact_name(contact))
  end subroutine add_motions

  !> The rows: one for each branch (0), point (1) or change (2). Branches are counted through all sets.
  pure subroutine list_rows(found, what, rows)
    type(branch_set_t), intent(in) :: found(:)
    integer, intent(in) :: what
    type(row_t), allocatable, intent(inout) :: rows(:)
    integer :: i, k, m, n, number, pass

    do pass = 1, 2
      n = 0
      number = 0
      do i = 1, size(found)
        do k = 1, size(found(i)%branch)
          number = number + 1
          do m = 1, how_many(found(i)%branch(k), what)
            n = n + 1
            if (pass == 2) rows(n) = row_t(i, k, m, number)
          end do
        end do
      end do
      if (pass == 2) exit
      deallocate (rows)
      allocate (rows(n))
    end do
  end subroutine list_rows

  pure integer function how_many(branch, what)
    type(whole_branch_t), intent(in) :: branch
    integer, intent(in) :: what

    how_many = 1
    if (what == 1) how_many = size(branch%point)
    if (what == 2) how_many = size(branch%special)
  end function how_many
end module gearsweep_branch_tables
