!> The task `sweep`: the dynamic factor over speed and relief, resonances, and the best of the listed reliefs.
module gearsweep_study_tasks_sweep
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_base, only: axis, dp, error_t, fixed, left, lines_t, no_number, right, str, table_t
  use gearsweep_motion, only: all_motions, all_motions_t, attractor_options_t, both, contact_lost, contact_name, count_motions, &
    down, find_corner_estimate, find_resonances, frequency_ratio, has_result, oscillator_t, peak_t, run_sweep, status_meaning, &
    status_name, status_ok, status_stopped, sweep_options_t, sweep_t, up, worst_of
  use gearsweep_study_case_task, only: stage, task_info_t
  use gearsweep_study_run_points, only: add_seen, factor_of, factor_text, of_coast, of_corner, of_dte_estimate, of_dte_range, &
    of_dte_rms, of_estimate, of_factor, of_periods, of_relief, of_seen, of_speed, of_status, of_worst, speed_of, words_of
  use gearsweep_study_run_stages, only: runnable_t, stages_t
  implicit none
  private
  public :: sweep_task_t

  character(*), parameter :: of_its_speed = 'speed of the pinion where that is'
  character(*), parameter :: of_other = 'with direction both: largest DF over the speeds in the direction in which it is smaller'

  type, extends(runnable_t) :: sweep_task_t
  contains
    procedure, nopass :: describe
    procedure :: run, add_report
  end type sweep_task_t

  !> Names of the directions in which a motion was found, as in `sweep_t`.
  character(4), parameter :: direction_names(-1:1) = [character(4) :: 'down', 'both', 'up']

contains

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t('sweep', needs=[stage%mesh, stage%reliefs, stage%amounts, stage%motion, stage%losses, stage%accuracy, &
                                       stage%speeds, stage%direction, stage%face], &
                       tables='sweep sweep_worst resonances sweep_summary', fields='', has_helical=.true., &
                       has_uneven_motion=.true., &
                       summary='dynamic factor over speed and relief, resonances, best of the listed reliefs')
  end subroutine describe

  subroutine run(self, stages, error)
    class(sweep_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(error_t), allocatable, intent(inout) :: error

    if (allocated(stages%uneven_motion)) then
      call run_motions(self, stages, stages%uneven_motion, error)
    else
      call run_motions(self, stages, stages%motion, error)
    end if
  end subroutine run

  !> Sweeps the speeds with these oscillators, one for each relief.
  subroutine run_motions(self, stages, motion, error)
    class(sweep_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(oscillator_t), intent(in) :: motion(:)
    type(error_t), allocatable, intent(inout) :: error
    type(sweep_options_t) :: options
    type(sweep_t) :: sweep
    type(all_motions_t) :: motions
    type(peak_t), allocatable :: resonance(:)
    character(*), parameter :: of_peak = 'speed of the pinion at a peak of the dynamic factor: a resonance, or where a bent '// &
      'branch of motions ends and the motion jumps'
    type(peak_t), allocatable :: worst(:)
    integer :: i, k, m, n

    options = stages%sweep_options()
    if (associated(stages%running%progress)) then
      call run_sweep(motion, stages%rpm, options, sweep, error, stages%running%progress)
    else
      call run_sweep(motion, stages%rpm, options, sweep, error)
    end if
    if (allocated(error)) return
    stages%running%done = stages%running%done + size(sweep%status)
    ! The end of an incomplete curve need not be a resonance.
    allocate (resonance(0))
    self%is_stopped = any(sweep%status == status_stopped)
    call count_motions(motion, stages%rpm, attractor_options_t(stages%accuracy, threads=stages%running%threads), &
                       stages%direction == all_motions .and. .not. self%is_stopped, motions, error)
    self%is_stopped = self%is_stopped .or. motions%stopped
    if (.not. self%is_stopped) resonance = find_resonances(sweep%rpm, sweep%dynamic_factor(:, minloc(stages%amount, 1)))
    call fill_sweep(stages, motion(1), sweep, motions, self%tables(self%place('sweep')), error)
    call fill_worst(stages, motion, sweep, self%is_stopped, self%tables(self%place('sweep_worst')), error)
    associate (rpm => [resonance%rpm], table => self%tables(self%place('resonances')))
      m = size(stages%amount)
      n = size(rpm)
      call table%over('largest dynamic factor of each relief about the peaks of the least relieved mesh, within 15 % and '// &
                      'half-way to the next', error, axis('relief_um', 'um', of_relief, stages%amount), &
                      axis('resonance_rpm', '1/min', of_peak, rpm))
      if (allocated(error)) return
      worst = [((worst_near(sweep%rpm, sweep%dynamic_factor(:, i), rpm, k), k=1, n), i=1, m)]
      call table%add('dynamic_factor', '', 'largest DF within 15 % of that speed, and no farther than half-way to the next '// &
                     'peak; NaN where none has an answer', [factor_of(worst)])
      call table%add('rpm', '1/min', 'speed of the pinion where that is', [speed_of(worst)])
    end associate
    call fill_summary(stages, sweep, self%tables(self%place('sweep_summary')), error)
    self%is_done = .true.
    self%failed = count(.not. has_result(sweep%status))
    associate (points => size(sweep%status), left_out => count(sweep%status == status_stopped))
      self%log = 'sweep: '//str(points)//' operating points'
      if (left_out > 0) self%log = 'sweep: interrupted, '//str(points - left_out)//' of '//str(points)// &
                                   ' operating points computed'
    end associate
  end subroutine run_motions

  !> Fills one row for each operating point.
  pure subroutine fill_sweep(stages, motion, sweep, motions, table, error)
    type(stages_t), intent(in) :: stages
    type(oscillator_t), intent(in) :: motion     ! of the first relief
    type(sweep_t), intent(in) :: sweep
    type(all_motions_t), intent(in) :: motions
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error

    call table%over('dynamic factor over speed and relief', error, axis('relief_um', 'um', of_relief, stages%amount), &
                    axis('rpm', '1/min', of_speed, sweep%rpm))
    if (allocated(error)) return
    call table%add('dynamic_factor', '', of_factor, [sweep%dynamic_factor])
    call table%add('error_estimate', '', of_estimate, [sweep%estimate])
    call table%add_words('status', of_status, words_of([sweep%status]))
    call table%add_words('contact', 'full; partial: a pair was apart for a while; lost: all were; coast: the coast sides '// &
                         'touched', contact_name([sweep%contact]))
    call table%add('floquet_modulus', '', 'largest modulus of the Floquet multipliers: what remains of a '// &
                   'disturbance after the motion has repeated once; of a chaotic motion, its mean '// &
                   'growth in a mesh period; NaN where it is not known', [sweep%multiplier])
    call table%add('residual', '', 'by how much the motion fails to repeat, in static deflections', [sweep%residual])
    call table%add('steps', '', 'steps in a mesh period', [sweep%steps])
    call table%add('mesh_periods', '', of_periods, [sweep%periods])
    call table%add('branch_lost', '', 'with direction up, down or both: 1 if the motion at the previous speed led to none '// &
                   'here, else 0', merge(1, 0, [sweep%branch_lost]))
    call table%add('frequency_ratio', '', 'mesh frequency over the natural frequency of the mean mesh stiffness', &
                   table%along(2, frequency_ratio(motion, sweep%rpm)))
    call table%add('coast_factor', '', of_coast//'; NaN where there is no answer', [sweep%coast_factor])
    call table%add('dte_rms_um', 'um', of_dte_rms, [sweep%dte_rms])
    call table%add('dte_peak_to_peak_um', 'um', of_dte_range, [sweep%dte_range])
    call table%add('dte_error_estimate_um', 'um', of_dte_estimate, [sweep%dte_estimate])
    call add_seen([sweep%seen_factor], [sweep%seen_dte_rms], [sweep%seen_dte_range], [sweep%seen_periods], table)
    if (stages%direction == both) then
      call table%add_words('direction', 'with direction both: in which the motion of this row was met: up, down or both', &
                           direction_names([sweep%direction]))
      call table%add('other_dynamic_factor', '', 'with direction both: DF of the motion met in the other direction, the same '// &
                     'where both meet one; NaN where it has no answer', [sweep%other_factor])
      call table%add_words('other_status', 'with direction both: status of the motion met in the other direction', &
                           words_of([sweep%other_status]))
      call table%add('other_dte_rms_um', 'um', 'with direction both: dte_rms_um of the motion met in the other direction', &
                     [sweep%other_dte_rms])
    end if
    if (stages%direction /= all_motions) return
    call table%add('motions', '', 'with direction all: how many motions attract at this speed', [motions%motions])
    call table%add('largest_dynamic_factor', '', 'with direction all: largest DF of these, without those that no start '// &
                   'reaches', [motions%largest])
    call table%add('share', '', 'with direction all: share of the starts that lead to the motion of this row', [motions%share])
  end subroutine fill_sweep

  !> Fills the largest dynamic factor of each relief.
  subroutine fill_worst(stages, motion, sweep, stopped, table, error)
    type(stages_t), intent(in) :: stages
    type(oscillator_t), intent(in) :: motion(:)
    type(sweep_t), intent(in) :: sweep
    logical, intent(in) :: stopped               ! true if the caller ended the run
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    type(peak_t) :: worst(size(stages%amount)), other(size(stages%amount))
    real(dp) :: corner(size(stages%amount))
    integer :: i

    call table%over('largest dynamic factor of the sweep for each relief', error, axis('relief_um', 'um', of_relief, stages%amount))
    if (allocated(error)) return
    worst = [(worst_of(sweep%rpm, sweep%dynamic_factor(:, i)), i=1, size(worst))]
    call table%add('worst_dynamic_factor', '', of_worst, [factor_of(worst)])
    call table%add('rpm', '1/min', of_its_speed, [speed_of(worst)])
    other = [(worst_of(sweep%rpm, sweep%seen_factor(:, i)), i=1, size(worst))]
    call table%add('seen_dynamic_factor', '', of_seen//'; NaN where each motion repeats', [factor_of(other)])
    call table%add('seen_rpm', '1/min', of_its_speed, [speed_of(other)])
    if (stages%direction == both) then
      other = [(smaller_worst(sweep, i), i=1, size(worst))]
      call table%add('other_dynamic_factor', '', of_other, [factor_of(other)])
      call table%add('other_rpm', '1/min', of_its_speed, [speed_of(other)])
    end if
    if (.not. stages%has_corners() .or. allocated(stages%uneven_motion)) return
    corner = no_number()
    do i = 1, size(worst)
      if (worst(i)%rpm > 0 .and. .not. stopped) &
        call find_corner_estimate(motion(i), worst(i)%rpm, stages%accuracy, corner(i))
    end do
    call table%add('corner_estimate', '', of_corner, corner)
  end subroutine fill_worst

  !> Fills the number of points by status, their accuracy, and the best of the listed reliefs.
  pure subroutine fill_summary(stages, sweep, table, error)
    type(stages_t), intent(in) :: stages
    type(sweep_t), intent(in) :: sweep
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    logical, allocatable :: known(:, :)
    real(dp) :: estimate
    type(peak_t) :: best, other, seen            ! the last has an index in place of its speed
    integer :: at, i, least

    call table%begin('the points of the sweep, and the best of the listed reliefs', 1, error)
    if (allocated(error)) return
    estimate = no_number()
    known = has_result(sweep%status) .and. .not. ieee_is_nan(sweep%estimate)
    if (any(known)) estimate = maxval(sweep%estimate, mask=known)
    call find_best(sweep, least, best)
    call table%add('best_relief_um', 'um', 'of the listed reliefs, the one whose largest DF, or seen DF where that is larger, '// &
                   'is least; NaN where the sweep was interrupted', &
                   [merge(stages%amount(max(1, least)), no_number(), least > 0)])
    call table%add('worst_dynamic_factor', '', 'largest DF over the speeds with that relief', [factor_of(best)])
    call table%add('rpm', '1/min', of_its_speed, [speed_of(best)])
    if (stages%direction == both) then
      other = peak_t(0, no_number())
      if (least > 0) other = smaller_worst(sweep, least)
      call table%add('other_dynamic_factor', '', of_other, [factor_of(other)])
    end if
    call table%add('speeds', '', 'of the pinion', [size(sweep%rpm)])
    call table%add('points', '', 'speeds times reliefs', [size(sweep%status)])
    call table%add('points_without_answer', '', 'points without a dynamic factor', [count(.not. has_result(sweep%status))])
    call table%add('largest_error_estimate', '', 'largest estimated error of a dynamic factor', [estimate])
    call table%add('tolerance', '', 'largest error that the case asks for', [stages%accuracy%steady%tolerance])
    call table%add('points_with_contact_loss', '', 'points at which all pairs were apart for a while', &
                   [count(sweep%contact >= contact_lost)])
    if (stages%direction == both) call table%add('points_with_two_motions', '', 'points at which the directions up and down '// &
                                                 'meet different motions', [count(sweep%direction /= 0)])
    seen = worst_of([(real(i, dp), i=1, size(sweep%seen_factor))], [sweep%seen_factor])
    at = max(1, nint(seen%rpm))
    call table%add('seen_dynamic_factor', '', of_seen//', at any point; NaN where each motion repeats', [factor_of(seen)])
    call table%add('seen_periods', '', 'mesh periods over which that motion was watched; 0: none', &
                   [merge(sweep%seen_periods(1 + modulo(at - 1, size(sweep%rpm)), 1 + (at - 1)/size(sweep%rpm)), 0, seen%rpm > 0)])
    do i = status_ok, status_stopped
      call table%add('points_'//status_name(i), '', status_meaning(i), [count(sweep%status == i)])
    end do
  end subroutine fill_summary

  !> Finds index and peak of the relief whose largest dynamic factor is least, including motions that do not repeat; index 0 if the
  !> curves are incomplete and the best is not known.
  pure subroutine find_best(sweep, least, best)
    type(sweep_t), intent(in) :: sweep
    integer, intent(out) :: least
    type(peak_t), intent(out) :: best
    type(peak_t) :: worst
    real(dp) :: largest, smallest
    integer :: i

    least = 0
    if (any(sweep%status == status_stopped)) return
    do i = 1, size(sweep%status, 2)
      worst = worst_of(sweep%rpm, sweep%dynamic_factor(:, i))
      if (.not. worst%rpm > 0) cycle
      largest = maxval([worst%dynamic_factor, pack(sweep%seen_factor(:, i), sweep%seen_periods(:, i) > 0)])
      if (least > 0) then
        if (.not. largest < smallest) cycle
      end if
      smallest = largest
      least = i
      best = worst
    end do
  end subroutine find_best

  !> Largest dynamic factor over the speeds in the direction, up or down, in which it is smaller.
  pure type(peak_t) function smaller_worst(sweep, relief) result(worst)
    type(sweep_t), intent(in) :: sweep
    integer, intent(in) :: relief
    type(peak_t) :: of_way(2)

    associate (larger => sweep%dynamic_factor(:, relief), smaller => sweep%other_factor(:, relief), &
               direction => sweep%direction(:, relief))
      of_way = [worst_of(sweep%rpm, merge(smaller, larger, direction == down)), &
                worst_of(sweep%rpm, merge(smaller, larger, direction == up))]
    end associate
    worst = of_way(1)
    if (min(of_way(1)%rpm, of_way(2)%rpm) > 0) then
      if (of_way(2)%dynamic_factor < worst%dynamic_factor) worst = of_way(2)
    end if
  end function smaller_worst

  !> Largest value within 15 % of peak number `k`, at most half-way to its neighbours.
  pure type(peak_t) function worst_near(rpm, dynamic_factor, resonance, k) result(worst)
    real(dp), intent(in) :: rpm(:), dynamic_factor(:)
    real(dp), intent(in) :: resonance(:)         !< speeds of the peaks, ascending
    integer, intent(in) :: k
    logical :: near(size(rpm))

    near = abs(rpm - resonance(k)) <= 0.15_dp*resonance(k)
    if (k > 1) near = near .and. rpm > (resonance(k - 1) + resonance(k))/2
    if (k < size(resonance)) near = near .and. rpm <= (resonance(k) + resonance(k + 1))/2
    worst = worst_of(pack(rpm, near), pack(dynamic_factor, near))
  end function worst_near

  pure subroutine add_report(self, lines)
    class(sweep_task_t), intent(in) :: self
    type(lines_t), intent(inout) :: lines
    integer :: i, k
    logical :: has_two, has_seen

    associate (sweep => self%tables(self%place('sweep')), worst => self%tables(self%place('sweep_worst')), &
               resonances => self%tables(self%place('resonances')), all_points => self%tables(self%place('sweep_summary')))
      has_two = .false.
      if (all_points%position('points_with_two_motions') > 0) has_two = all_points%number('points_with_two_motions') > 0
      has_seen = .not. ieee_is_nan(all_points%number('seen_dynamic_factor'))
      associate (speeds => sweep%extent(2), peaks => resonances%extent(2))
        call lines%add('')
        call lines%put('Dynamic factor over '//str(speeds)//' speed'//trim(merge('s', ' ', speeds > 1))//', '// &
                       str(sweep%number('rpm')))
        if (speeds > 1) call lines%put(' to '//str(sweep%number('rpm', speeds)))
        call lines%add(' rpm')
        call lines%put('   relief um     worst    at rpm')
        if (has_seen) call lines%put('      seen    at rpm')
        if (has_two) call lines%put('     other    at rpm')
        if (peaks > 0) then
          call lines%add('   largest within 15 % of a peak at rpm')
          call lines%put(repeat(' ', 32 + 20*count([has_seen, has_two])))
        end if
        do k = 1, peaks
          call lines%put(right(str(anint(resonances%number('resonance_rpm', k))), 10))
        end do
        call lines%add('')
        do i = 1, worst%rows
          call lines%put(right(str(worst%number('relief_um', i)), 12)//factor_text(worst%number('worst_dynamic_factor', i)))
          if (.not. ieee_is_nan(worst%number('rpm', i))) then
            call lines%put(right(str(worst%number('rpm', i)), 10))
            if (has_seen) then
              call lines%put(factor_text(worst%number('seen_dynamic_factor', i)))
              if (ieee_is_nan(worst%number('seen_rpm', i))) call lines%put(repeat(' ', 10))
              if (.not. ieee_is_nan(worst%number('seen_rpm', i))) call lines%put(right(str(worst%number('seen_rpm', i)), 10))
            end if
            if (has_two) call lines%put(factor_text(worst%number('other_dynamic_factor', i))// &
                                        right(str(worst%number('other_rpm', i)), 10))
            do k = 1, peaks
              call lines%put(factor_text(resonances%number('dynamic_factor', (i - 1)*peaks + k)))
            end do
          end if
          call lines%add('')
        end do
      end associate
      if (worst%rows > 1 .and. .not. ieee_is_nan(all_points%number('rpm'))) call lines%add(left('Best of the list', 19)// &
        str(all_points%number('best_relief_um'))//' um: worst DF '//fixed(all_points%number('worst_dynamic_factor'), 4))
      call add_quality(all_points, lines)
    end associate
    call add_motions(self%tables(self%place('sweep')), lines)
  end subroutine add_report

  !> Adds a line on speeds with several attracting motions, if these were searched.
  pure subroutine add_motions(sweep, lines)
    type(table_t), intent(in) :: sweep
    type(lines_t), intent(inout) :: lines
    real(dp), allocatable :: motions(:), largest(:)

    if (sweep%position('motions') == 0) return
    motions = sweep%numbers('motions')
    largest = sweep%numbers('largest_dynamic_factor')
    largest = pack(largest, .not. ieee_is_nan(largest))
    motions = pack(motions, .not. ieee_is_nan(motions))
    if (any(motions > 1)) call lines%add(left('', 19)//str(count(motions > 1))// &
      ' with several motions; the largest DF of those that a start reaches is '//fixed(maxval(largest), 4))
  end subroutine add_motions

  !> Adds lines on the accuracy of the points and on those that failed.
  pure subroutine add_quality(all_points, lines)
    type(table_t), intent(in) :: all_points      ! sweep_summary
    type(lines_t), intent(inout) :: lines
    integer :: status, n, failed

    failed = nint(all_points%number('points_without_answer'))
    call lines%put(left('Points', 19)//str(nint(all_points%number('points')))//', without an answer '//str(failed))
    if (.not. ieee_is_nan(all_points%number('largest_error_estimate'))) then
      call lines%put('; estimated error of DF at most '//str(all_points%number('largest_error_estimate'), 2)// &
                     ' (asked for '//str(all_points%number('tolerance'))//')')
    else if (failed < nint(all_points%number('points'))) then
      call lines%put('; the error of DF is not known, as breaks lie within equal steps')
    end if
    call lines%add('')
    do status = 1, status_stopped
      n = nint(all_points%number('points_'//status_name(status)))
      if (n > 0) call lines%add(left('', 19)//str(n)//' '//status_name(status)//': '//status_meaning(status))
    end do
    if (.not. ieee_is_nan(all_points%number('seen_dynamic_factor'))) call lines%add(left('', 19)//'"seen": DF is at least '// &
      fixed(all_points%number('seen_dynamic_factor'), 4)//' in a motion that does not repeat, watched for '// &
      str(nint(all_points%number('seen_periods')))//' mesh periods')
    n = nint(all_points%number('points_with_contact_loss'))
    if (n == 0) return
    call lines%add(left('', 19)//str(n)//' with loss of contact, where several motions may exist: direction = ''all'' shows them')
    if (all_points%position('points_with_two_motions') == 0) return
    n = nint(all_points%number('points_with_two_motions'))
    if (n > 0) call lines%add(left('', 19)//str(n)//' with another motion as the speed falls than as it rises: the '// &
                              'larger counts, "other" is the worst in the direction in which that is smaller')
  end subroutine add_quality
end module gearsweep_study_tasks_sweep
