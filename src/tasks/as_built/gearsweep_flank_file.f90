!> Measured points of the flanks of one gear, from the text of a file.
!>
!> The file has the line `tooth,flank,roll_mm,deviation_um` and below it a row for each point: the number of the tooth; its left or
!> right flank; the length of roll, which is the radius of curvature of the involute at the point; and the deviation from the
!> involute, positive where material stands out. Rows may have any order. Lines that begin with `#`, and blank ones, do not count.
module gearsweep_flank_file
  use gearsweep_error, only: code_input, error_t, fail
  use gearsweep_kinds, only: dp
  use gearsweep_text, only: lower, shown, str, to_number
  use gearsweep_text_rows, only: find_rows, row_t
  implicit none
  private
  public :: flank_points_t, read_flank_points

  !> Points of the flanks of one side of all teeth, tooth by tooth.
  type :: flank_points_t
    integer, allocatable :: first(:)             !< where those of a tooth begin, and behind the last one's end; (tooth + 1)
    real(dp), allocatable :: roll(:)             !< m; (point)
    real(dp), allocatable :: deviation(:)        !< m; (point)
  end type flank_points_t

  character(*), parameter :: header = 'tooth,flank,roll_mm,deviation_um', blanks = ' '//achar(9)
  real(dp), parameter :: longest_roll = 1e5_dp   ! mm
  real(dp), parameter :: largest = 1e4_dp        ! um, as of the lists of &deviations
  real(dp), parameter :: mm = 1e-3_dp, um = 1e-6_dp

  type :: point_t
    integer :: tooth = 0                         ! 0: of the other flank
    real(dp) :: roll = 0, deviation = 0          ! m
  end type point_t

contains

  !> The points of one flank of each tooth. Fails at the first line that is not as it must be, whichever flank it is of.
  subroutine read_flank_points(path, text, teeth, flank, points, error)
    character(*), intent(in) :: path             !< for messages
    character(*), intent(in) :: text             !< of the file
    integer, intent(in) :: teeth                 !< of the gear
    character(*), intent(in) :: flank            !< `left` or `right`; rows of the other one are left out
    type(flank_points_t), intent(out) :: points
    type(error_t), allocatable, intent(inout) :: error
    type(row_t), allocatable :: rows(:)
    type(point_t), allocatable :: found(:)
    integer :: i

    call find_rows(text, path, header, rows, error)
    if (allocated(error)) return
    allocate (found(size(rows)))
    do i = 1, size(rows)
      call read_row(text(rows(i)%first:rows(i)%last), path//' line '//str(rows(i)%line)//': ', teeth, flank, found(i), error)
      if (allocated(error)) return
    end do
    call sort_by_tooth(pack(found, found%tooth > 0), teeth, points)
  end subroutine read_flank_points

  subroutine read_row(text, place, teeth, flank, point, error)
    character(*), intent(in) :: text, place, flank
    integer, intent(in) :: teeth
    type(point_t), intent(out) :: point
    type(error_t), allocatable, intent(inout) :: error
    character(len(text)) :: fields(4)
    integer :: tooth
    logical :: ok

    call split_fields(text, fields, ok)
    if (.not. ok) then
      call fail(error, code_input, place//'must have four fields: '//header)
      return
    end if
    call to_number(trim(fields(1)), tooth, ok)
    if (.not. (ok .and. tooth >= 1 .and. tooth <= teeth)) call refuse('tooth', fields(1), 'a whole number from 1 to '//str(teeth))
    fields(2) = lower(fields(2))
    if (fields(2) /= 'left' .and. fields(2) /= 'right') call refuse('flank', fields(2), 'left or right')
    call to_number(trim(fields(3)), point%roll, ok)
    if (.not. (ok .and. point%roll >= 0 .and. point%roll <= longest_roll)) call refuse('roll_mm', fields(3), &
      'a number from 0 to '//str(longest_roll))
    call to_number(trim(fields(4)), point%deviation, ok)
    if (.not. (ok .and. abs(point%deviation) <= largest)) call refuse('deviation_um', fields(4), &
      'a number from '//str(-largest)//' to '//str(largest))
    if (fields(2) == flank) point%tooth = tooth
    point%roll = mm*point%roll
    point%deviation = um*point%deviation

  contains

    subroutine refuse(name, given, allowed)
      character(*), intent(in) :: name, given, allowed

      call fail(error, code_input, place//name//' = '//shown(trim(given))//': must be '//allowed)
    end subroutine refuse
  end subroutine read_row

  !> What stands between commas, without the blanks and tabs around it; `ok`: as many as there is room for.
  pure subroutine split_fields(text, fields, ok)
    character(*), intent(in) :: text
    character(len(text)), intent(out) :: fields(:)
    logical, intent(out) :: ok
    integer :: from, until, i

    fields = ''
    from = 1
    do i = 1, size(fields)
      until = from + scan(text(from:), ',') - 2
      ok = until >= from - 1 .eqv. i < size(fields)
      if (.not. ok) return
      if (i == size(fields)) until = len(text)
      from = from + max(1, verify(text(from:until), blanks)) - 1
      fields(i) = text(from:from - 1 + verify(text(from:until), blanks, back=.true.))
      from = until + 2
    end do
  end subroutine split_fields

  !> Counts the points of each tooth, and puts each point to its tooth.
  pure subroutine sort_by_tooth(found, teeth, points)
    type(point_t), intent(in) :: found(:)
    integer, intent(in) :: teeth
    type(flank_points_t), intent(out) :: points
    integer :: next(teeth), i, k

    allocate (points%first(teeth + 1), source=0)
    allocate (points%roll(size(found)), points%deviation(size(found)))
    do i = 1, size(found)
      points%first(found(i)%tooth + 1) = points%first(found(i)%tooth + 1) + 1
    end do
    points%first(1) = 1
    do k = 1, teeth
      points%first(k + 1) = points%first(k + 1) + points%first(k)
    end do
    next = points%first(:teeth)
    do i = 1, size(found)
      associate (at => next(found(i)%tooth))
        points%roll(at) = found(i)%roll
        points%deviation(at) = found(i)%deviation
        at = at + 1
      end associate
    end do
  end subroutine sort_by_tooth
end module gearsweep_flank_file
