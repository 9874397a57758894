!> The task `sweep`: the dynamic factor over speed and relief, resonances, and the best of the listed reliefs.
module gearsweep_task_sweep
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_all_motions, only: all_motions_t, count_motions
  use gearsweep_attractor_search, only: attractor_options_t
  use gearsweep_corner_estimate, only: find_corner_estimate
  use gearsweep_decimal, only: in_um
  use gearsweep_error, only: error_t
  use gearsweep_kinds, only: dp
  use gearsweep_lines, only: left, lines_t, right
  use gearsweep_optimum, only: find_resonances, peak_t, worst_of
  use gearsweep_oscillator, only: frequency_ratio
  use gearsweep_points, only: factor_in, factor_of, of_coast, of_corner, of_estimate, of_factor, of_periods, of_relief, of_speed, &
    of_status, of_worst, speed_of, words_of
  use gearsweep_status, only: has_result, status_meaning, status_name, status_ok, status_stopped
  use gearsweep_sweep_state, only: all_motions, both, down, up
  use gearsweep_sweep, only: contact_lost, contact_name, run_sweep, sweep_options_t, sweep_state_t, sweep_t
  use gearsweep_table, only: axis, no_number, table_t
  use gearsweep_stages, only: runnable_t, stages_t
  use gearsweep_task, only: stage, task_info_t
  use gearsweep_text, only: fixed, str
  implicit none
  private
  public :: sweep_task_t

  real(dp), parameter :: micro = 1e6_dp
  character(*), parameter :: of_other = 'with direction both: largest DF over the speeds in the direction in which it is smaller'

  type, extends(runnable_t) :: sweep_task_t
  contains
    procedure, nopass :: describe
    procedure :: run, add_report
  end type sweep_task_t

contains

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t('sweep', needs=[stage%mesh, stage%reliefs, stage%amounts, stage%motion, stage%losses, stage%accuracy, &
                                       stage%speeds, stage%direction], &
                       tables='sweep sweep_worst resonances sweep_summary', fields='', &
                       gives='dynamic factor over speed and relief, resonances, best of the listed reliefs')
  end subroutine describe

  subroutine run(self, stages, error)
    class(sweep_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(error_t), allocatable, intent(inout) :: error
    type(sweep_options_t) :: options
    type(sweep_state_t), pointer :: state
    type(sweep_t) :: sweep
    type(all_motions_t) :: motions
    type(peak_t), allocatable :: resonance(:)

    options = stages%sweep_options()
    nullify (state)
    if (associated(stages%running%states)) state => stages%running%states(1)
    if (associated(stages%running%progress)) then
      call run_sweep(stages%motion, stages%rpm, options, sweep, error, stages%running%progress, state)
    else
      call run_sweep(stages%motion, stages%rpm, options, sweep, error, state=state)
    end if
    if (allocated(error)) return
    stages%running%done = stages%running%done + size(sweep%status)
    ! Part of a curve may end at what is no resonance.
    allocate (resonance(0))
    self%is_stopped = any(sweep%status == status_stopped)
    call count_motions(stages%motion, stages%rpm, attractor_options_t(stages%accuracy, threads=stages%running%threads), &
                       stages%direction == all_motions .and. .not. self%is_stopped, motions, error)
    self%is_stopped = self%is_stopped .or. motions%stopped
    if (.not. self%is_stopped) resonance = find_resonances(sweep%rpm, sweep%dynamic_factor(:, minloc(stages%amount, 1)))
    call fill_sweep(stages, sweep, motions, self%tables(self%place('sweep')), error)
    call fill_worst(stages, sweep, self%is_stopped, self%tables(self%place('sweep_worst')), error)
    call fill_resonances(stages%amount, sweep, [resonance%rpm], self%tables(self%place('resonances')), error)
    call fill_summary(stages, sweep, self%tables(self%place('sweep_summary')), error)
    self%is_done = .true.
    self%failed = count(.not. has_result(sweep%status))
    associate (points => size(sweep%status), left_out => count(sweep%status == status_stopped))
      self%log = 'sweep: '//str(points)//' operating points'
      if (left_out > 0) self%log = 'sweep: interrupted, '//str(points - left_out)//' of '//str(points)// &
                                   ' operating points computed'
    end associate
  end subroutine run

  !> One row an operating point.
  pure subroutine fill_sweep(stages, sweep, motions, table, error)
    type(stages_t), intent(in) :: stages
    type(sweep_t), intent(in) :: sweep
    type(all_motions_t), intent(in) :: motions
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error

    call table%over('dynamic factor over speed and relief', error, axis('relief_um', 'um', of_relief, in_um(stages%amount)), &
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
    call table%add('branch_lost', '', 'with direction up, down or both, 1: the motion at the speed before led to none here, '// &
                   'and this point was solved by itself; else 0', merge(1, 0, [sweep%branch_lost]))
    call table%add('frequency_ratio', '', 'mesh frequency over the natural frequency of the mean mesh stiffness', &
                   table%along(2, frequency_ratio(stages%motion(1), sweep%rpm)))
    call table%add('coast_factor', '', of_coast//'; NaN where there is no answer', [sweep%coast_factor])
    call table%add('dte_rms_um', 'um', 'root mean square of what the dynamic transmission error differs from its mean over the '// &
                   'steady motion; NaN where there is no answer', [micro*sweep%dte_rms])
    call table%add('dte_peak_to_peak_um', 'um', 'largest less least dynamic transmission error of the steady motion; NaN where '// &
                   'there is no answer', [micro*sweep%dte_range])
    call table%add('dte_error_estimate_um', 'um', 'estimated error of either of these; NaN: not known', &
                   [micro*sweep%dte_estimate])
    if (stages%direction == both) then
      call table%add_words('direction', 'with direction both: in which the motion of this row was met: up, down or both', &
                           direction_name([sweep%direction]))
      call table%add('other_dynamic_factor', '', 'with direction both: DF of the motion met in the other direction, the same '// &
                     'where both meet one; NaN where it has no answer', [sweep%other_factor])
      call table%add_words('other_status', 'with direction both: status of the motion met in the other direction', &
                           words_of([sweep%other_status]))
    end if
    if (stages%direction /= all_motions) return
    call table%add('motions', '', 'with direction all: how many motions attract at this speed', [motions%motions])
    call table%add('largest_dynamic_factor', '', 'with direction all: largest DF of these, without those that no start '// &
                   'reaches', [motions%largest])
    call table%add('share', '', 'with direction all: share of the starts that lead to the motion of this row', [motions%share])
  end subroutine fill_sweep

  !> The largest dynamic factor of each relief.
  subroutine fill_worst(stages, sweep, stopped, table, error)
    type(stages_t), intent(in) :: stages
    type(sweep_t), intent(in) :: sweep
    logical, intent(in) :: stopped               ! by the caller
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    type(peak_t) :: worst(size(stages%amount)), other(size(stages%amount))
    real(dp) :: corner(size(stages%amount))
    integer :: i

    call table%over('largest dynamic factor of the sweep for each relief', error, &
                    axis('relief_um', 'um', of_relief, in_um(stages%amount)))
    if (allocated(error)) return
    worst = [(worst_of(sweep%rpm, sweep%dynamic_factor(:, i)), i=1, size(worst))]
    call table%add('worst_dynamic_factor', '', of_worst, [factor_of(worst)])
    call table%add('rpm', '1/min', 'speed of the pinion where that is', [speed_of(worst)])
    if (stages%direction == both) then
      other = [(smaller_worst(sweep, i), i=1, size(worst))]
      call table%add('other_dynamic_factor', '', of_other, [factor_of(other)])
      call table%add('other_rpm', '1/min', 'speed of the pinion where that is', [speed_of(other)])
    end if
    if (.not. stages%has_corners()) return
    corner = no_number()
    do i = 1, size(worst)
      if (worst(i)%rpm > 0 .and. .not. stopped) &
        call find_corner_estimate(stages%motion(i), worst(i)%rpm, stages%accuracy, corner(i))
    end do
    call table%add('corner_estimate', '', of_corner, corner)
  end subroutine fill_worst

  !> The dynamic factor in the resonances of the least relieved mesh, which are at the speeds `rpm` (1/min), for each
  !> relief.
  pure subroutine fill_resonances(amount, sweep, rpm, table, error)
    real(dp), intent(in) :: amount(:), rpm(:)
    type(sweep_t), intent(in) :: sweep
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    type(peak_t), allocatable :: worst(:)
    integer :: i, k, m, n

    m = size(amount)
    n = size(rpm)
    call table%over('largest dynamic factor of each relief about the speeds at which the least relieved mesh resonates, '// &
                    'within 15 % and half-way to the next', error, axis('relief_um', 'um', of_relief, in_um(amount)), &
                    axis('resonance_rpm', '1/min', 'speed of the pinion in the resonance', rpm))
    if (allocated(error)) return
    worst = [((worst_near(sweep%rpm, sweep%dynamic_factor(:, i), rpm, k), k=1, n), i=1, m)]
    call table%add('dynamic_factor', '', 'largest DF within 15 % of that speed, and no farther than half-way to the next '// &
                   'resonance; NaN where none has an answer', [factor_of(worst)])
    call table%add('rpm', '1/min', 'speed of the pinion where that is', [speed_of(worst)])
  end subroutine fill_resonances

  !> How many points the sweep has and how they ended, how exact they are, and the best of the listed reliefs.
  pure subroutine fill_summary(stages, sweep, table, error)
    type(stages_t), intent(in) :: stages
    type(sweep_t), intent(in) :: sweep
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    logical, allocatable :: known(:, :)
    real(dp) :: estimate
    type(peak_t) :: best, other
    integer :: i, least

    call table%begin('the points of the sweep, and the best of the listed reliefs', 1, error)
    if (allocated(error)) return
    estimate = no_number()
    known = has_result(sweep%status) .and. .not. ieee_is_nan(sweep%estimate)
    if (any(known)) estimate = maxval(sweep%estimate, mask=known)
    call find_best(sweep, least, best)
    call table%add('best_relief_um', 'um', 'of the listed reliefs, the one whose largest DF is least; NaN where '// &
                   'the sweep was interrupted', [merge(in_um(stages%amount(max(1, least))), no_number(), least > 0)])
    call table%add('worst_dynamic_factor', '', 'largest DF over the speeds with that relief', [factor_of(best)])
    call table%add('rpm', '1/min', 'speed of the pinion where that is', [speed_of(best)])
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
    do i = status_ok, status_stopped
      call table%add('points_'//status_name(i), '', status_meaning(i), [count(sweep%status == i)])
    end do
  end subroutine fill_summary

  !> Index and peak of the relief whose largest dynamic factor is least; 0 where the curves are not whole: then none is
  !> known to be the best.
  pure subroutine find_best(sweep, least, best)
    type(sweep_t), intent(in) :: sweep
    integer, intent(out) :: least
    type(peak_t), intent(out) :: best
    type(peak_t) :: worst
    integer :: i

    least = 0
    if (any(sweep%status == status_stopped)) return
    do i = 1, size(sweep%status, 2)
      worst = worst_of(sweep%rpm, sweep%dynamic_factor(:, i))
      if (.not. worst%rpm > 0) cycle
      if (least > 0 .and. .not. worst%dynamic_factor < best%dynamic_factor) cycle
      least = i
      best = worst
    end do
  end subroutine find_best

  !> The largest dynamic factor over the speeds in that of the directions up and down in which it is smaller.
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

  !> The direction in which a motion was met.
  elemental function direction_name(direction) result(name)
    integer, intent(in) :: direction             !< of `sweep_t`
    character(4) :: name
    character(4), parameter :: names(-1:1) = [character(4) :: 'down', 'both', 'up']

    name = names(direction)
  end function direction_name

  !> The largest value within 15 % of resonance number `k`, no farther than half-way to its neighbours.
  pure type(peak_t) function worst_near(rpm, dynamic_factor, resonance, k) result(worst)
    real(dp), intent(in) :: rpm(:), dynamic_factor(:)
    real(dp), intent(in) :: resonance(:)         !< speeds, ascending
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
    logical :: has_two

    associate (sweep => self%tables(self%place('sweep')), worst => self%tables(self%place('sweep_worst')), &
               resonances => self%tables(self%place('resonances')), all_points => self%tables(self%place('sweep_summary')))
      has_two = .false.
      if (all_points%position('points_with_two_motions') > 0) has_two = all_points%number('points_with_two_motions') > 0
      associate (speeds => sweep%extent(2), peaks => resonances%extent(2))
        call lines%add('')
        call lines%put('Dynamic factor over '//str(speeds)//' speed'//trim(merge('s', ' ', speeds > 1))//', '// &
                       str(sweep%number('rpm')))
        if (speeds > 1) call lines%put(' to '//str(sweep%number('rpm', speeds)))
        call lines%add(' rpm')
        call lines%put('   relief um     worst    at rpm')
        if (has_two) call lines%put('     other    at rpm')
        if (peaks > 0) then
          call lines%add('   in resonance at rpm (within 15 %)')
          call lines%put(repeat(' ', merge(52, 32, has_two)))
        end if
        do k = 1, peaks
          call lines%put(right(str(anint(resonances%number('resonance_rpm', k))), 10))
        end do
        call lines%add('')
        do i = 1, worst%rows
          call lines%put(right(str(worst%number('relief_um', i)), 12)//factor_in(worst%number('worst_dynamic_factor', i)))
          if (.not. ieee_is_nan(worst%number('rpm', i))) then
            call lines%put(right(str(worst%number('rpm', i)), 10))
            if (has_two) call lines%put(factor_in(worst%number('other_dynamic_factor', i))// &
                                        right(str(worst%number('other_rpm', i)), 10))
            do k = 1, peaks
              call lines%put(factor_in(resonances%number('dynamic_factor', (i - 1)*peaks + k)))
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

  !> Where several motions attract, as far as that was looked for.
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

  !> How exact, and what failed.
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
    n = nint(all_points%number('points_with_contact_loss'))
    if (n == 0) return
    call lines%add(left('', 19)//str(n)//' with loss of contact, where several motions may exist: direction = ''all'' and the '// &
                   'task attractors show them')
    if (all_points%position('points_with_two_motions') == 0) return
    n = nint(all_points%number('points_with_two_motions'))
    if (n > 0) call lines%add(left('', 19)//str(n)//' with another motion as the speed falls than as it rises: the '// &
                              'larger counts, "other" is the worst in the direction in which that is smaller')
  end subroutine add_quality
end module gearsweep_task_sweep
