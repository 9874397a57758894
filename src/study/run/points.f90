!> Texts, limits and helpers of the tables of several tasks.
!>
!> Meanings of columns of operating points and of largest dynamic factors; the motion of largest dynamic factor at a speed; the
!> warning for values of ISO 6336-3 with asymmetric teeth.
module gearsweep_study_run_points
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_base, only: dp, fixed, lines_t, no_number, right, str, table_t
  use gearsweep_gear, only: coast, drive, pair_t
  use gearsweep_motion, only: accuracy_t, attractor_options_t, find_response, largest_motion, mesh_period, oscillator_t, peak_t, &
    point_t, response_t, status_name
  implicit none
  private
  public :: add_seen, add_several, factor_text, factor_of, known_count, speed_of, words_of, find_motion, find_point, &
            add_equal_flanks, add_caution

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
  character(*), parameter, public :: of_dte_rms = 'root mean square of the dynamic transmission error about its mean over the '// &
    'steady motion; NaN where there is no answer', of_dte_range = 'peak-to-peak dynamic transmission error of the '// &
    'steady motion; NaN where there is no answer', of_dte_estimate = 'estimated error of either of these; NaN: not known'
  character(*), parameter, public :: of_seen = 'largest load of a pair over the static load that was seen in a motion that '// &
    'does not repeat: a lower bound'
  integer, parameter, public :: status_length = 12

  character(*), parameter :: column = 'equal_flanks'

contains

  !> Dynamic factor of a peak, if it exists.
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

  !> Dynamic factor for the screen, or the word for none.
  pure character(10) function factor_text(factor)
    real(dp), intent(in) :: factor

    factor_text = right('none', 10)
    if (.not. ieee_is_nan(factor)) factor_text = right(fixed(factor, 4), 10)
  end function factor_text

  !> Number of motions, if it is known (not 0); otherwise NaN.
  elemental real(dp) function known_count(motions)
    integer, intent(in) :: motions

    known_count = merge(real(motions, dp), no_number(), motions > 0)
  end function known_count

  !> Adds columns for motions that do not repeat.
  pure subroutine add_seen(factor, dte_rms, dte_range, periods, table)
    real(dp), intent(in) :: factor(:)            !< largest load over the static load; NaN: motion not observed; (row)
    real(dp), intent(in) :: dte_rms(:), dte_range(:)       !< rms and peak to peak of the dynamic transmission error, m; (row)
    integer, intent(in) :: periods(:)            !< mesh periods of the observation; (row)
    type(table_t), intent(inout) :: table

    call table%add('seen_dynamic_factor', '', of_seen//'; NaN where each motion that was met repeats', factor)
    call table%add('seen_dte_rms_um', 'um', 'root mean square deviation of its dynamic transmission error from its mean', dte_rms)
    call table%add('seen_dte_peak_to_peak_um', 'um', 'peak-to-peak value of that error; a lower bound too', dte_range)
    call table%add('seen_periods', '', 'mesh periods over which that motion was watched; 0: none', periods)
  end subroutine add_seen

  !> Adds a line if several motions attract at some of a table's rows.
  pure subroutine add_several(table, lines)
    type(table_t), intent(in) :: table           !< table with the column `motions`
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

  !> Finds the operating point at a speed (1/min): of the attracting motions, that of largest dynamic factor that a start reaches.
  !> It therefore depends on the case alone, not on the order of the speeds in a sweep.
  subroutine find_point(motion, rpm, accuracy, point, motions, out_of_memory)
    type(oscillator_t), intent(in) :: motion
    real(dp), intent(in) :: rpm
    type(accuracy_t), intent(in) :: accuracy
    type(point_t), intent(out) :: point
    integer, intent(out) :: motions              !< number of motions; 0: not known
    logical, intent(out) :: out_of_memory                !< true if out of memory

    call largest_motion(motion, mesh_period(motion%mesh%teeth(1), rpm), attractor_options_t(accuracy), point, motions, &
                        out_of_memory)
  end subroutine find_point

  !> Finds the operating point, and its motion over the path of contact.
  subroutine find_motion(motion, rpm, accuracy, response, motions, harmonics)
    type(oscillator_t), intent(in) :: motion
    real(dp), intent(in) :: rpm
    type(accuracy_t), intent(in) :: accuracy
    type(response_t), intent(out) :: response
    integer, intent(out) :: motions              !< number of motions; 0: not known
    integer, intent(in), optional :: harmonics   !< number of mesh harmonics of the summary; absent: no summary
    type(point_t) :: point
    logical :: out_of_memory

    call find_point(motion, rpm, accuracy, point, motions, out_of_memory)
    if (.not. out_of_memory) call find_response(motion, rpm, accuracy, response, point, harmonics)
    response%lacks = response%lacks .or. out_of_memory
  end subroutine find_motion

  !> Adds the column on equal flanks, with the same value in all rows.
  pure subroutine add_equal_flanks(pair, rows, table)
    type(pair_t), intent(in) :: pair
    integer, intent(in) :: rows
    type(table_t), intent(inout) :: table

    associate (angle => pair%gear(1)%spec%pressure_angle)
      call table%add(column, '', '1 where both flanks have one pressure angle, as ISO 6336-3 means it, else 0', &
                     spread(merge(0, 1, abs(angle(coast) - angle(drive)) > 0), 1, rows))
    end associate
  end subroutine add_equal_flanks

  !> Adds the warning if the flanks of a table are unequal.
  pure subroutine add_caution(table, lines)
    type(table_t), intent(in) :: table
    type(lines_t), intent(inout) :: lines

    if (.not. table%number(column, 1) > 0) &
      call lines%add('   ISO 6336-3 is made for equal flanks: here its section lies between the 30 degree tangents of unequal '// &
                     'ones, which nothing confirms')
  end subroutine add_caution
end module gearsweep_study_run_points
