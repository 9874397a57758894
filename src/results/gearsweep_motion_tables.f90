!> Tables of the tasks `load`, `sweep` and `optimum`: what the motion does.
module gearsweep_motion_tables
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_decimal, only: in_um
  use gearsweep_error, only: error_t
  use gearsweep_kinds, only: dp
  use gearsweep_optimum, only: peak_t, worst_of
  use gearsweep_oscillator, only: frequency_ratio
  use gearsweep_status, only: has_result, status_meaning, status_name, status_ok, status_stopped
  use gearsweep_study, only: study_t
  use gearsweep_table, only: each, no_number, over_and_over, table_t
  implicit none
  private
  public :: load_table, load_points_table, sweep_table, sweep_worst_table, resonances_table, sweep_summary_table
  public :: optimum_table, optimum_curve_table, find_best, worst_near

  real(dp), parameter :: micro = 1e6_dp
  character(*), parameter :: of_relief = 'amount of relief', of_speed = 'speed of the pinion'
  character(*), parameter :: of_factor = 'dynamic factor DF: largest load of a pair over the static load; NaN where '// &
                             'there is no answer', &
                             of_estimate = 'estimated error of DF; NaN where there is no answer or it is not known'
  character(*), parameter :: of_status = 'how the operating point ended, in a word', &
                             of_worst = 'largest DF over the speeds; NaN where none has an answer', &
                             of_periods = 'mesh periods until the motion repeats'
  !> At `contact` + 1 of a sweep.
  character(7), parameter :: contact_names(4) = [character(7) :: 'full', 'partial', 'lost', 'coast']
  integer, parameter :: status_length = 12

contains

  !> Load of one pair along its path at the speeds `load_rpm` (Dogan et al. 2021, Figs. 5, 6).
  pure subroutine load_table(study, table, error)
    type(study_t), intent(in) :: study
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: values(:, :)
    integer, allocatable :: periods(:), pair(:)
    character(status_length), allocatable :: status(:)
    integer :: i, k, rows, from, until

    if (.not. allocated(study%response)) return
    rows = sum([((size(study%response(i, k)%s), i=1, size(study%response, 1)), k=1, size(study%response, 2))])
    call table%begin('dynamic load of one pair along its path of contact', rows, 16, error)
    if (allocated(error)) return
    allocate (values(rows, 5), periods(rows), pair(rows), status(rows))
    from = 1
    do k = 1, size(study%response, 2)
      do i = 1, size(study%response, 1)
        associate (one => study%response(i, k), steady => study%response(i, k)%point%steady)
          until = from + size(one%s) - 1
          values(from:until, 1) = in_um(study%case%amount(i))
          values(from:until, 2) = one%rpm
          values(from:until, 3) = one%s
          values(from:until, 4) = one%load
          values(from:until, 5) = micro*one%error
          status(from:until) = status_name(steady%status)
          periods(from:until) = steady%periods
          pair(from:until) = one%pair
        end associate
        from = until + 1
      end do
    end do
    call table%add_index('relief_um', 'um', of_relief, values(:, 1))
    call table%add_index('rpm', '1/min', of_speed, values(:, 2))
    call table%add_index('s', '', 'path coordinate of the pair, in base pitches from A', values(:, 3))
    call table%add('pair_load_n', 'N', 'elastic load on the pair', values(:, 4))
    call table%add('load_ratio', '', 'the same over the static load; its largest value is DF, up to the refinement of '// &
                   'the peak between two rows', values(:, 4)/study%load)
    call table%add('dte_um', 'um', 'dynamic transmission error along the line of action, without the turning of whole '// &
                   'gears about their bores', values(:, 5))
    call table%add_words('status', of_status, status)
    call table%add('mesh_periods', '', of_periods, periods)
    call table%add_index('pair', '', 'which of so many pairs this is, from 1; 0 without an answer', pair)
  end subroutine load_table

  !> Dynamic factor at the speeds `load_rpm`.
  pure subroutine load_points_table(study, table, error)
    type(study_t), intent(in) :: study
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: factor(:), estimate(:)
    integer :: i, k, m, n

    if (.not. allocated(study%response)) return
    associate (point => study%response%point)
      m = size(point, 1)
      n = size(point, 2)
      call table%begin('dynamic factor at the speeds of the task load', m*n, 8, error, extent=[m, n])
      if (allocated(error)) return
      factor = [((point(i, k)%dynamic_factor, k=1, n), i=1, m)]
      estimate = [((point(i, k)%estimate, k=1, n), i=1, m)]
      associate (status => [((point(i, k)%steady%status, k=1, n), i=1, m)])
        where (.not. has_result(status))
          factor = no_number()
          estimate = no_number()
        end where
        call table%add_index('relief_um', 'um', of_relief, each(in_um(study%case%amount), n))
        call table%add_index('rpm', '1/min', of_speed, over_and_over(study%case%load_rpm, m))
        call table%add('dynamic_factor', '', of_factor, factor)
        call table%add('error_estimate', '', of_estimate, estimate)
        call table%add_words('status', of_status, words_of(status))
        call table%add('mesh_periods', '', of_periods, [((point(i, k)%steady%periods, k=1, n), i=1, m)])
      end associate
    end associate
  end subroutine load_points_table

  !> One row an operating point. `contact`: full, partial (a pair was apart for a while), lost (all were), coast (the
  !> coast sides touched).
  pure subroutine sweep_table(study, table, error)
    type(study_t), intent(in) :: study
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    integer :: n, m

    if (.not. allocated(study%sweep)) return
    associate (sweep => study%sweep)
      n = size(sweep%status, 1)
      m = size(sweep%status, 2)
      call table%begin('dynamic factor over speed and relief', n*m, 12, error, extent=[m, n])
      if (allocated(error)) return
      call table%add_index('relief_um', 'um', of_relief, each(in_um(study%case%amount), n))
      call table%add_index('rpm', '1/min', of_speed, over_and_over(sweep%rpm, m))
      call table%add('dynamic_factor', '', of_factor, [sweep%dynamic_factor])
      call table%add('error_estimate', '', of_estimate, [sweep%estimate])
      call table%add_words('status', of_status, words_of([sweep%status]))
      call table%add_words('contact', 'full; partial: a pair was apart for a while; lost: all were; coast: the coast sides '// &
                           'touched', contact_names(1 + [sweep%contact]))
      call table%add('floquet_modulus', '', 'largest modulus of the Floquet multipliers: what remains of a '// &
                     'disturbance after the motion has repeated once; of a chaotic motion, its mean '// &
                     'growth in a mesh period', [sweep%multiplier])
      call table%add('residual', '', 'by how much the motion fails to repeat, in static deflections', [sweep%residual])
      call table%add('steps', '', 'steps in a mesh period', [sweep%steps])
      call table%add('mesh_periods', '', of_periods, [sweep%periods])
      call table%add('frequency_ratio', '', 'mesh frequency over the natural frequency of the mean mesh stiffness', &
                     over_and_over(frequency_ratio(study%motion(1), sweep%rpm), m))
    end associate
  end subroutine sweep_table

  !> The largest dynamic factor of each relief.
  pure subroutine sweep_worst_table(study, table, error)
    type(study_t), intent(in) :: study
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    type(peak_t) :: worst(size(study%case%amount))
    integer :: i

    if (.not. allocated(study%sweep)) return
    associate (sweep => study%sweep, m => size(study%case%amount))
      call table%begin('largest dynamic factor of the sweep for each relief', m, 3, error, extent=[m])
      if (allocated(error)) return
      worst = [(worst_of(sweep%rpm, sweep%dynamic_factor(:, i)), i=1, m)]
      call table%add_index('relief_um', 'um', of_relief, in_um(study%case%amount))
      call table%add('worst_dynamic_factor', '', of_worst, [factor_of(worst)])
      call table%add('rpm', '1/min', 'speed of the pinion where that is', [speed_of(worst)])
    end associate
  end subroutine sweep_worst_table

  !> The dynamic factor in the resonances of the least relieved mesh, for each relief.
  pure subroutine resonances_table(study, table, error)
    type(study_t), intent(in) :: study
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    integer :: i, k, m, n

    if (.not. allocated(study%sweep)) return
    associate (sweep => study%sweep, resonance => study%resonance)
      m = size(study%case%amount)
      n = size(resonance)
      call table%begin('largest dynamic factor of each relief within 15 % of the speeds at which the least relieved mesh '// &
                       'resonates', m*n, 4, error, extent=[m, n])
      if (allocated(error)) return
      call table%add_index('relief_um', 'um', of_relief, each(in_um(study%case%amount), n))
      call table%add_index('resonance_rpm', '1/min', 'speed of the pinion in the resonance', over_and_over([resonance%rpm], m))
      call table%add('dynamic_factor', '', 'largest DF within 15 % of that speed; NaN where none has an answer', &
                     [((factor_of(worst_near(sweep%rpm, sweep%dynamic_factor(:, i), resonance(k)%rpm)), k=1, n), i=1, m)])
      call table%add('rpm', '1/min', 'speed of the pinion where that is', &
                     [((speed_of(worst_near(sweep%rpm, sweep%dynamic_factor(:, i), resonance(k)%rpm)), k=1, n), i=1, m)])
    end associate
  end subroutine resonances_table

  !> How many points the sweep has and how they ended, how exact they are, and the best of the listed reliefs.
  pure subroutine sweep_summary_table(study, table, error)
    type(study_t), intent(in) :: study
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    logical, allocatable :: known(:, :)
    real(dp) :: estimate
    type(peak_t) :: best
    integer :: i, least

    if (.not. allocated(study%sweep)) return
    call table%begin('the points of the sweep, and the best of the listed reliefs', 1, 20, error)
    if (allocated(error)) return
    associate (sweep => study%sweep)
      estimate = no_number()
      known = has_result(sweep%status) .and. .not. ieee_is_nan(sweep%estimate)
      if (any(known)) estimate = maxval(sweep%estimate, mask=known)
      call find_best(study, least, best)
      call table%add('best_relief_um', 'um', 'of the listed reliefs, the one whose largest DF is least; NaN where '// &
                     'the sweep was interrupted', &
                     [merge(in_um(study%case%amount(max(1, least))), no_number(), least > 0)])
      call table%add('worst_dynamic_factor', '', 'largest DF over the speeds with that relief', [factor_of(best)])
      call table%add('rpm', '1/min', 'speed of the pinion where that is', [speed_of(best)])
      call table%add('speeds', '', 'of the pinion', [size(sweep%rpm)])
      call table%add('points', '', 'speeds times reliefs', [size(sweep%status)])
      call table%add('points_without_answer', '', 'points without a dynamic factor', [count(.not. has_result(sweep%status))])
      call table%add('largest_error_estimate', '', 'largest estimated error of a dynamic factor', [estimate])
      call table%add('tolerance', '', 'largest error that the case asks for', [study%case%accuracy%steady%tolerance])
      call table%add('points_with_contact_loss', '', 'points at which all pairs were apart for a while', &
                     [count(sweep%contact >= 2)])
      do i = status_ok, status_stopped
        call table%add('points_'//status_name(i), '', status_meaning(i), [count(sweep%status == i)])
      end do
    end associate
  end subroutine sweep_summary_table

  !> Index and peak of the relief whose largest dynamic factor is least; 0 where the curves are not whole: then none is
  !> known to be the best.
  pure subroutine find_best(study, least, best)
    type(study_t), intent(in) :: study
    integer, intent(out) :: least
    type(peak_t), intent(out) :: best
    type(peak_t) :: worst
    integer :: i

    least = 0
    if (any(study%sweep%status == status_stopped)) return
    do i = 1, size(study%case%amount)
      worst = worst_of(study%sweep%rpm, study%sweep%dynamic_factor(:, i))
      if (.not. worst%rpm > 0) cycle
      if (least > 0 .and. .not. worst%dynamic_factor < best%dynamic_factor) cycle
      least = i
      best = worst
    end do
  end subroutine find_best

  !> The largest value within 15 % of a speed.
  pure type(peak_t) function worst_near(rpm, dynamic_factor, centre) result(worst)
    real(dp), intent(in) :: rpm(:), dynamic_factor(:), centre
    logical :: near(size(rpm))

    near = abs(rpm - centre) <= 0.15_dp*centre
    worst = worst_of(pack(rpm, near), pack(dynamic_factor, near))
  end function worst_near

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

  !> The optimum relief.
  pure subroutine optimum_table(study, table, error)
    type(study_t), intent(in) :: study
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: best(3)
    integer :: failed

    if (.not. allocated(study%optimum)) return
    call table%begin('the relief whose largest dynamic factor over the speeds is least', 1, 5, error)
    if (allocated(error)) return
    associate (optimum => study%optimum)
      best = no_number()
      failed = sum(optimum%failed)
      if (optimum%best > 0) then
        best = [in_um(optimum%amount(optimum%best)), optimum%dynamic_factor(optimum%best), optimum%rpm(optimum%best)]
        failed = optimum%failed(optimum%best)
      end if
      call table%add('relief_um', 'um', 'optimum relief; NaN where no point has an answer', best(1:1))
      call table%add('worst_dynamic_factor', '', of_worst, best(2:2))
      call table%add('rpm', '1/min', 'speed of the pinion where that is', best(3:3))
      call table%add('within_um', 'um', 'the true optimum lies so near', [micro*optimum%resolution])
      call table%add('points_without_answer', '', 'speeds without an answer there; of all reliefs where no point has one', &
                     [failed])
    end associate
  end subroutine optimum_table

  !> Largest dynamic factor over the speeds against the relief (Dogan et al. 2021, Fig. 8).
  pure subroutine optimum_curve_table(study, table, error)
    type(study_t), intent(in) :: study
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error

    if (.not. allocated(study%optimum)) return
    associate (optimum => study%optimum, n => size(study%optimum%amount))
      call table%begin('largest dynamic factor over the speeds against the relief', n, 4, error, extent=[n])
      if (allocated(error)) return
      call table%add_index('relief_um', 'um', 'amount of relief, ascending', in_um(optimum%amount))
      call table%add('worst_dynamic_factor', '', of_worst, optimum%dynamic_factor)
      call table%add('rpm', '1/min', 'speed of the pinion where that is', optimum%rpm)
      call table%add('points_without_answer', '', 'speeds without an answer', optimum%failed)
    end associate
  end subroutine optimum_curve_table

  !> Names of statuses, padded to one length.
  pure function words_of(status) result(words)
    integer, intent(in) :: status(:)
    character(status_length) :: words(size(status))
    integer :: i

    do i = 1, size(status)
      words(i) = status_name(status(i))
    end do
  end function words_of
end module gearsweep_motion_tables
