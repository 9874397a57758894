!> Tables of the task `optimum`, and its lines for the screen: the best relief, and the results of all tried amounts over all and
!> under each of the loads.
module gearsweep_study_tasks_optimum_tables
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_base, only: axis, dp, error_t, fixed, no_number, str, table_t
  use gearsweep_motion, only: joint_optimum_t
  use gearsweep_study_tasks_relief_judge, only: amount_curve_t, by_dte, by_factor, by_harmonic, by_range, errors_t, judge_t, &
    judged_words, relief_of
  implicit none
  private
  public :: value_name, fill_best, fill_curve, fill_design, fill_loads, fill_map, relief_in, value_in

  character(*), parameter :: names(4) = [character(20) :: 'worst_dynamic_factor', 'ste_peak_to_peak_um', 'mesh_harmonic_um', &
                                         'dte_rms_um']
  character(*), parameter :: of_factor = 'largest DF over the speeds; NaN where none has an answer', &
    of_dte = 'root mean square of the dynamic transmission error about its mean: the quadratic mean over the speeds; NaN where '// &
    'none has an answer', of_range = 'peak-to-peak static transmission error', of_harmonic = 'amplitude of the harmonic of the '// &
    'static transmission error that &optimum harmonic names', of_rpm = 'speed of the pinion '// &
    'where what is judged is largest', of_failed = 'speeds without an answer', &
    of_bound = '1: a few speeds showed that this relief is not the best, and the largest DF is that of these; else 0'

contains

  !> Name of the criterion's column.
  pure function value_name(judge) result(name)
    type(judge_t), intent(in) :: judge
    character(len(names)) :: name

    name = names(judge%by)
  end function value_name

  !> Fills one row: the best amount.
  pure subroutine fill_best(judge, torque, curve, largest, table, error)
    type(judge_t), intent(in) :: judge
    real(dp), intent(in) :: torque(:)            !< torque of each load, N m; NaN: not known
    type(amount_curve_t), intent(in) :: curve
    real(dp), intent(in) :: largest              !< largest dynamic factor of all motions at the worst speed
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: best(6)
    integer :: failed, at

    if (allocated(error)) return
    call table%begin('the best amount of relief, and by what it is judged', 1, error)
    if (allocated(error)) return
    best = no_number()
    failed = sum(curve%failed)
    if (curve%best > 0) then
      associate (k => curve%best)
        at = maxloc(curve%of_load(:, k), 1)
        best = [curve%amount(k), curve%value(k), judge%combined(curve%errors(k)%range), &
                judge%combined(curve%errors(k)%amplitude), curve%rpm(at, k), torque(at)]
        failed = sum(curve%failed(:, k))
      end associate
    end if
    call table%add('relief_um', 'um', 'best amount of relief; NaN where no point has an answer', best(1:1))
    if (judge%needs_motion()) then
      call add_value(judge, best(2:2), ' (over several torques as over_torques says)', table)
      call table%add('rpm', '1/min', of_rpm//', under the worst torque', best(5:5))
    end if
    if (judge%by == by_factor) call table%add('largest_dynamic_factor', '', 'largest DF at that speed of all motions that are '// &
      'known: its own, and those that a start reaches; NaN where there is none', [largest])
    call table%add('within_um', 'um', 'the true optimum lies so near', [curve%resolution])
    if (judge%needs_motion()) call table%add('points_without_answer', '', 'speeds without an answer there; of all reliefs '// &
      'where no point has one', [failed])
    call table%add('ste_peak_to_peak_um', 'um', of_range//', over several torques as over_torques says', best(3:3))
    call table%add('mesh_harmonic_um', 'um', of_harmonic//', over several torques as over_torques says', best(4:4))
    call table%add('torque_nm', 'N m', 'the torque on the pinion under which what is judged is largest; NaN: not known', best(6:6))
    call table%add_words('judged', 'what is judged: &optimum judged', [judged_words(judge%by)])
    call table%add_words('over_torques', 'which of several torques counts: the worst, or their weighted mean', &
                         [merge('weighted', 'worst   ', allocated(judge%share))])
  end subroutine fill_best

  !> Fills the curve over the amounts (of largest dynamic factors: Dogan et al. 2021, Fig. 8).
  pure subroutine fill_curve(judge, curve, table, error)
    type(judge_t), intent(in) :: judge
    type(amount_curve_t), intent(in) :: curve
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    integer :: i, n
    integer, allocatable :: at(:)

    if (allocated(error)) return
    n = size(curve%amount)
    call table%over('what is judged against the relief, all torques together', error, &
                    axis('relief_um', 'um', 'amount of relief, ascending', curve%amount))
    if (allocated(error)) return
    if (judge%needs_motion()) then
      at = [(max(1, maxloc(curve%of_load(:, i), 1)), i=1, n)]
      call add_value(judge, curve%value, '', table)
      call table%add('rpm', '1/min', of_rpm, [(curve%rpm(at(i), i), i=1, n)])
      call table%add('points_without_answer', '', of_failed, sum(curve%failed, 1))
      call table%add('at_least', '', of_bound, merge(1, 0, curve%is_bound))
    end if
    call table%add('ste_peak_to_peak_um', 'um', of_range, [(judge%combined(curve%errors(i)%range), i=1, n)])
    call table%add('mesh_harmonic_um', 'um', of_harmonic, [(judge%combined(curve%errors(i)%amplitude), i=1, n)])
  end subroutine fill_curve

  !> Fills the map over amounts and torques.
  pure subroutine fill_map(judge, torque, curve, table, error)
    type(judge_t), intent(in) :: judge
    real(dp), intent(in) :: torque(:)            !< torque of each load, N m
    type(amount_curve_t), intent(in) :: curve
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    integer :: i, n

    if (allocated(error)) return
    n = size(curve%amount)
    call table%over('transmission error and what is judged, for each relief that was tried under each torque', error, &
                    axis('relief_um', 'um', 'amount of relief, ascending', curve%amount), &
                    axis('torque_nm', 'N m', 'torque on the pinion', torque))
    if (allocated(error)) return
    call table%add('ste_peak_to_peak_um', 'um', of_range, [(curve%errors(i)%range, i=1, n)])
    call table%add('mesh_harmonic_um', 'um', of_harmonic, [(curve%errors(i)%amplitude, i=1, n)])
    if (.not. judge%needs_motion()) return
    call add_value(judge, [curve%of_load], '', table)
    call table%add('rpm', '1/min', of_rpm, where_known([curve%rpm]))
    call table%add('points_without_answer', '', of_failed, [curve%failed])
    call table%add('at_least', '', of_bound, [(spread(merge(1, 0, curve%is_bound(i)), 1, size(torque)), i=1, size(curve%amount))])
  end subroutine fill_map

  !> Fills the best design and its error estimates.
  pure subroutine fill_design(judge, optimum, errors, table, error)
    type(judge_t), intent(in) :: judge
    type(joint_optimum_t), intent(in) :: optimum
    type(errors_t), intent(in) :: errors         !< errors of the design
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: amount(2), start(2), diameter(2), value(3)

    if (allocated(error)) return
    call table%begin('the best reliefs of both gears, by what is judged', 1, error)
    if (allocated(error)) return
    amount = no_number()
    start = no_number()
    diameter = no_number()
    value = no_number()
    if (allocated(optimum%best%value)) then
      call relief_of(judge%designs, optimum%best%number, amount, start)
      associate (relief => judge%designs%inputs%motion%relief)
        if (.not. relief%prescribed) diameter = 2*relief%pair%radius([1, 2], start)
      end associate
      value = [judge%combined(optimum%best%of_load), judge%combined(errors%range), judge%combined(errors%amplitude)]
    end if
    call table%add('pinion_relief_um', 'um', 'amount of relief at the pinion''s tip; NaN where no point has an answer', amount(1:1))
    call table%add('gear_relief_um', 'um', 'at the gear''s', amount(2:2))
    call table%add('pinion_relief_start', '', 'path coordinate at which the pinion''s relief begins, in base pitches from A', &
                   start(1:1))
    call table%add('gear_relief_start', '', 'at which the gear''s begins', start(2:2))
    call table%add('pinion_start_diameter_mm', 'mm', 'diameter of the pinion at which its relief begins; NaN for a '// &
                   'prescribed mesh', diameter(1:1))
    call table%add('gear_start_diameter_mm', 'mm', 'the same of the gear', diameter(2:2))
    if (judge%needs_motion()) call add_value(judge, value(1:1), ' (over several torques as over_torques says)', table)
    call table%add('within', '', 'within such a part of the ranges, up and down in each of these numbers, no better design '// &
                   'was found', [optimum%within])
    call table%add('designs_tried', '', 'designs tried', [optimum%tried])
    call table%add('ste_peak_to_peak_um', 'um', of_range//', over several torques as over_torques says', value(2:2))
    call table%add('mesh_harmonic_um', 'um', of_harmonic//', over several torques as over_torques says', value(3:3))
  end subroutine fill_design

  !> Fills the results of the best reliefs under each torque.
  pure subroutine fill_loads(judge, torque, of_load, rpm, failed, errors, table, error)
    type(judge_t), intent(in) :: judge
    real(dp), intent(in) :: torque(:), of_load(:), rpm(:)  !< torque, N m; value of the criterion; speed, 1/min; (load)
    integer, intent(in) :: failed(:)             !< number of speeds that did not converge
    type(errors_t), intent(in) :: errors
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error

    if (allocated(error)) return
    call table%over('the best reliefs under each torque', error, axis('torque_nm', 'N m', 'torque on the pinion', torque))
    if (allocated(error)) return
    call table%add('ste_peak_to_peak_um', 'um', of_range, errors%range)
    call table%add('mesh_harmonic_um', 'um', of_harmonic, errors%amplitude)
    if (allocated(judge%share)) call table%add('share', '', 'of this torque in the weighted mean', judge%share)
    if (.not. judge%needs_motion()) return
    call add_value(judge, of_load, '', table)
    call table%add('rpm', '1/min', of_rpm, where_known(rpm))
    call table%add('points_without_answer', '', of_failed, failed)
  end subroutine fill_loads

  !> Adds the column of the criterion, if that depends on the motion.
  pure subroutine add_value(judge, value, more, table)
    type(judge_t), intent(in) :: judge
    real(dp), intent(in) :: value(:)             ! dynamic factors, or lengths in m
    character(*), intent(in) :: more
    type(table_t), intent(inout) :: table

    if (judge%by == by_factor) call table%add(trim(names(by_factor)), '', of_factor//more, value)
    if (judge%by == by_dte) call table%add(trim(names(by_dte)), 'um', of_dte//more, value)
  end subroutine add_value

  !> Speeds, NaN for none.
  elemental real(dp) function where_known(rpm)
    real(dp), intent(in) :: rpm

    where_known = rpm
    if (.not. rpm > 0) where_known = no_number()
  end function where_known

  !> Value in the unit of tables, with its name and unit.
  pure function value_in(judge, value) result(words)
    type(judge_t), intent(in) :: judge
    real(dp), intent(in) :: value
    character(40) :: words

    select case (judge%by)
    case (by_factor)
      words = 'worst DF '//fixed(value, 4)
    case (by_range)
      words = 'peak-to-peak STE '//str(value, 4)//' um'
    case (by_harmonic)
      words = 'amplitude '//str(value, 4)//' um'
    case default
      words = 'DTE rms '//str(value, 4)//' um'
    end select
  end function value_in

  !> Amount of a gear's relief and its start: a diameter, if the gear is known.
  pure function relief_in(table, gear) result(text)
    type(table_t), intent(in) :: table
    character(*), intent(in) :: gear             ! pinion or gear
    character(80) :: text

    text = str(table%number(gear//'_relief_um'), 4)//' um from'
    if (ieee_is_nan(table%number(gear//'_start_diameter_mm'))) then
      text = trim(text)//' s = '//str(table%number(gear//'_relief_start'), 4)
    else
      text = trim(text)//' '//fixed(table%number(gear//'_start_diameter_mm'), 3)//' mm diameter'
    end if
  end function relief_in
end module gearsweep_study_tasks_optimum_tables
