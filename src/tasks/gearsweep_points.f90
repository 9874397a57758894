!> Words and numbers that the tables of several tasks share: of operating points, and of the largest dynamic factors.
module gearsweep_points
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_kinds, only: dp
  use gearsweep_lines, only: lines_t, right
  use gearsweep_optimum, only: peak_t
  use gearsweep_status, only: status_name
  use gearsweep_table, only: no_number, table_t
  use gearsweep_text, only: fixed, str
  implicit none
  private
  public :: add_several, factor_in, factor_of, known_count, speed_of, words_of

  character(*), parameter, public :: of_relief = 'amount of relief', of_speed = 'speed of the pinion'
  character(*), parameter, public :: of_factor = 'dynamic factor DF: largest load of a pair over the static load; NaN '// &
    'where there is no answer', of_estimate = 'estimated error of DF; NaN where there is no answer or it is not known'
  character(*), parameter, public :: of_status = 'how the operating point ended, in a word', &
    of_worst = 'largest DF over the speeds; NaN where none has an answer', of_periods = 'mesh periods until the motion repeats'
  character(*), parameter, public :: of_coast = 'largest load on the coast sides over the static load; 0 where they do not touch'
  character(*), parameter, public :: of_corner = 'what a tenth of the stiffness at a tip corner changes of DF: it is not known '// &
    'better under small loads; NaN where there is no answer'
  character(*), parameter, public :: of_motions = 'how many motions attract at this speed, of which this is the one with the '// &
    'largest DF; NaN where that is not known'
  integer, parameter, public :: status_length = 12

contains

  !> Of a peak that there is.
  elemental real(dp) function factor_of(peak)
    type(peak_t), intent(in) :: peak

    factor_of = no_number()
    if (peak%rpm > 0) factor_of = peak%dynamic_factor
  end function factor_of

  elemental real(dp) function speed_of(peak)
    type(peak_t), intent(in) :: peak

    speed_of = no_number()
    if (peak%rpm > 0) speed_of = peak%rpm
  end function speed_of

  !> A dynamic factor on the screen, or that there is none.
  pure character(10) function factor_in(factor)
    real(dp), intent(in) :: factor

    factor_in = right('none', 10)
    if (.not. ieee_is_nan(factor)) factor_in = right(fixed(factor, 4), 10)
  end function factor_in

  !> How many motions there are, where that is known (not 0).
  elemental real(dp) function known_count(motions)
    integer, intent(in) :: motions

    known_count = merge(real(motions, dp), no_number(), motions > 0)
  end function known_count

  !> One line for the screen where several motions attract at some of a table's rows.
  pure subroutine add_several(table, lines)
    type(table_t), intent(in) :: table           !< with the column `motions`
    type(lines_t), intent(inout) :: lines
    real(dp), allocatable :: known(:)
    character(:), allocatable :: many

    known = table%numbers('motions')
    known = pack(known, .not. ieee_is_nan(known))
    known = pack(known, known > 1)
    if (size(known) == 0) return
    many = str(minval(known))
    if (maxval(known) > minval(known)) many = many//' to '//str(maxval(known))
    call lines%add('   '//str(size(known))//' of '//str(table%rows)//' rows: '//many//' motions attract at the speed; '// &
                   'this is the one with the largest dynamic factor')
  end subroutine add_several

  !> Names of statuses, padded to one length.
  elemental character(status_length) function words_of(status)
    integer, intent(in) :: status

    words_of = status_name(status)
  end function words_of
end module gearsweep_points
