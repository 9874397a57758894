!> Tables of the tasks `section`, `static` and `modal`: one member's body, and printed values beside ours.
module gearsweep_body_tables
  use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
  use gearsweep_contour, only: shown_contour
  use gearsweep_decimal, only: in_um
  use gearsweep_error, only: error_t
  use gearsweep_gear, only: coast, drive
  use gearsweep_kinds, only: dp
  use gearsweep_published, only: published_t
  use gearsweep_quantities, only: our_value
  use gearsweep_study, only: study_t
  use gearsweep_table, only: each, over_and_over, table_t
  implicit none
  private
  public :: outline_table, root_table, mode_table, published_table

  real(dp), parameter :: milli = 1e3_dp, mega = 1e-6_dp
  character(*), parameter :: members(2) = [character(6) :: 'pinion', 'gear'], sides(2) = [character(5) :: 'drive', 'coast']

contains

  !> Outlines of both gears as points, clockwise, centres at the origin.
  pure subroutine outline_table(study, table, error)
    type(study_t), intent(in) :: study
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: pinion(:, :), gear(:, :)
    integer :: i

    if (.not. allocated(study%section)) return
    call shown_contour(study%pair%gear(1), pinion)
    call shown_contour(study%pair%gear(2), gear)
    associate (n => size(pinion, 2), m => size(gear, 2))
      call table%begin('outline', 'outline of both gears, each about its own centre', n + m, 6, error)
      if (allocated(error)) return
      call table%add_index('member', '', 'pinion or gear', members([(1, i=1, n), (2, i=1, m)]))
      call table%add('x_mm', 'mm', 'across the tooth that stands upright, towards its drive side', &
                     milli*[pinion(1, :), gear(1, :)])
      call table%add('y_mm', 'mm', 'along the axis of that tooth', milli*[pinion(2, :), gear(2, :)])
    end associate
  end subroutine outline_table

  !> Root stress of one member under the moving load, at the fillet tangent of the case.
  pure subroutine root_table(study, table, error)
    type(study_t), intent(in) :: study
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    integer :: i, n, m

    if (.not. allocated(study%root)) return
    associate (root => study%root)
      m = size(root)
      n = size(root(1)%s)
      call table%begin('root', 'stress at the fillet tangent while the load moves over the flank', 2*n*m, 9, error, &
                       extent=[m, n, 2])
      if (allocated(error)) return
      call table%add_index('relief_um', 'um', 'tip relief, as amount_um of the case', each(in_um(study%case%amount), 2*n))
      call table%add_index('s', '', 'path coordinate of the load from A, in base pitches', [(each(root(i)%s, 2), i=1, m)])
      call table%add('radius_mm', 'mm', 'where the load acts on the member', [(each(milli*root(i)%radius, 2), i=1, m)])
      call table%add('load_share', '', 'load on this tooth over the static load', [(each(root(i)%share, 2), i=1, m)])
      call table%add_index('side', '', 'of the tooth', sides(over_and_over([drive, coast], n*m)))
      call table%add('sigma_mpa', 'MPa', 'stress along the surface', [(mega*root(i)%along, i=1, m)])
      call table%add('sigma_x_mpa', 'MPa', 'stress across the tooth, to its drive side', &
                     [(mega*root(i)%components(1, :, :), i=1, m)])
      call table%add('sigma_y_mpa', 'MPa', 'stress along the tooth''s axis', [(mega*root(i)%components(2, :, :), i=1, m)])
      call table%add('tau_xy_mpa', 'MPa', 'shear stress', [(mega*root(i)%components(3, :, :), i=1, m)])
    end associate
  end subroutine root_table

  !> Natural frequencies of the section.
  pure subroutine mode_table(study, table, error)
    type(study_t), intent(in) :: study
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    integer :: i

    if (.not. allocated(study%modal)) return
    associate (modes => study%modal%modes, n => size(study%modal%modes%frequency))
      call table%begin('modes', 'natural frequencies of the section', n, 5, error, extent=[n])
      if (allocated(error)) return
      call table%add_index('mode', '', 'from the lowest frequency', [(i, i=1, n)])
      call table%add('frequency_hz', 'Hz', 'natural frequency', modes%frequency)
      call table%add('error_estimate', '', 'estimated error of the frequency, relative', study%modal%error_estimate)
      call table%add('residual', '', 'of the eigenvalue problem, relative', modes%residual)
      call table%add('rim_share', '', 'kinetic energy of the rim over that of all', modes%participation(0, :))
    end associate
  end subroutine mode_table

  !> Printed values beside ours; NaN where the tasks do not compute it.
  pure subroutine published_table(study, table, error)
    type(study_t), intent(in) :: study
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: ours(:)
    logical :: known
    integer :: i

    if (.not. allocated(study%published)) return
    associate (rows => study%published)
      call table%begin('published', 'printed values and ours', size(rows), 16, error)
      if (allocated(error)) return
      allocate (ours(size(rows)))
      do i = 1, size(rows)
        call our_value(study, rows(i)%quantity, ours(i), known)
        if (.not. known) ours(i) = ieee_value(ours(i), ieee_quiet_nan)
      end do
      call table%add_index('quantity', '', 'what is printed', words_of(rows, 'quantity'))
      call table%add_words('place', 'where it is printed', words_of(rows, 'place'))
      call table%add('printed', '', 'the printed value, in the unit of its row', [rows%printed])
      call table%add('ours', '', 'our value; NaN where the tasks do not compute it', ours)
      call table%add('deviation', '', 'ours over the printed value, less 1', ours/rows%printed - 1)
      call table%add_words('unit', 'of both values', words_of(rows, 'unit'))
      call table%add_words('status', 'of the inputs: stated, inferred, fitted or not reproducible', words_of(rows, 'status'))
      call table%add_words('reason', 'for the status', words_of(rows, 'reason'))
    end associate
  end subroutine published_table

  !> One field of all rows, padded to one length.
  pure function words_of(rows, field) result(words)
    type(published_t), intent(in) :: rows(:)
    character(*), intent(in) :: field
    character(:), allocatable :: words(:)
    integer :: i, longest

    longest = 1
    do i = 1, size(rows)
      longest = max(longest, len(word_of(rows(i), field)))
    end do
    allocate (character(longest) :: words(size(rows)))
    do i = 1, size(rows)
      words(i) = word_of(rows(i), field)
    end do
  end function words_of

  pure function word_of(row, field) result(word)
    type(published_t), intent(in) :: row
    character(*), intent(in) :: field
    character(:), allocatable :: word

    select case (field)
    case ('quantity')
      word = row%quantity
    case ('place')
      word = row%place
    case ('unit')
      word = row%unit
    case ('status')
      word = row%status
    case default
      word = row%reason
    end select
  end function word_of
end module gearsweep_body_tables
