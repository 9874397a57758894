!> The task `deflection_relief`: tip relief from the deflection of the loaded teeth, by formula and by finite elements.
!>
!> Each relief is compared with those of least static transmission error and of least dynamic factor; a table has the relief at
!> chosen diameters of both flanks.
module gearsweep_study_tasks_deflection_relief
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_base, only: axis, code_input, dp, each, error_t, fail, lines_t, no_number, str, table_t, wants_stop
  use gearsweep_gear, only: drive, pair_t, relief_t, tip_relief
  use gearsweep_elastic, only: contact_half_width, fe_deflection
  use gearsweep_mesh, only: find_harmonics, harmonics_t
  use gearsweep_motion, only: find_optimum, most_tried, optimum_t, oscillator_t, peak_t, run_sweep, status_stopped, &
    sweep_options_t, sweep_t, worst_of
  use gearsweep_rating, only: formula_deflection, formula_deflection_t, formula_relief
  use gearsweep_study_case_task, only: gear_names, stage, task_info_t
  use gearsweep_study_reader_reader, only: is_prescribed, needs_gears, reader_t, sentence_length, text_unless
  use gearsweep_study_run_case_variation, only: case_variation_t, largest_relief, relief_start, with_relief
  use gearsweep_study_run_inputs, only: motions_inputs_t
  use gearsweep_study_run_points, only: factor_of, of_worst, speed_of
  use gearsweep_study_run_stages, only: runnable_t, stages_t
  implicit none
  private
  public :: deflection_relief_task_t

  !> Diameters of one flank at which the relief is printed.
  type :: flank_t
    real(dp), allocatable :: diameter(:)         !< diameters, m; not allocated: equal steps of the roll angle
  end type flank_t

  real(dp), parameter :: milli = 1e3_dp

  !> A relief, its method, and its effect.
  type :: relief_method_t
    character(18) :: name = ''
    real(dp) :: amount(2) = 0                    !< amounts at the tips of pinion and gear, m
    real(dp) :: within = -1                      !< tolerance of the method's search for a minimum, m; below 0: no search
    real(dp) :: error_range = 0                  !< peak-to-peak static transmission error, m
    type(peak_t) :: worst                        !< largest dynamic factor over the speeds; speed 0: no speed converged
    integer :: failed = 0                        !< number of speeds that did not converge
  end type relief_method_t

  type, extends(runnable_t) :: deflection_relief_task_t
    character(5) :: point = 'tip'
    type(flank_t) :: flank(2)
  contains
    procedure, nopass :: describe
    procedure :: read_keys, run, add_report, count_points
    procedure, private :: find_deflection, fill_teeth
  end type deflection_relief_task_t

  !> Loaded teeth of both gears.
  type :: teeth_t
    real(dp) :: s(2) = 0                         !< path coordinates of the loads
    real(dp) :: half_width(2) = 0                !< half widths of the contact there, m
    type(formula_deflection_t) :: formula(2)
    real(dp) :: elements(2) = 0                  !< deflections by finite elements, m; NaN: none
  end type teeth_t

  character(*), parameter :: group = 'deflection_relief'

contains

  !> Fills a row for each method, flank and diameter.
  subroutine fill_flank(stages, flank, methods, table, error)
    type(stages_t), intent(in) :: stages
    type(flank_t), intent(in) :: flank(2)
    type(relief_method_t), intent(in) :: methods(:)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: diameter(:), roll(:), along(:, :), straight(:, :)   ! (diameter, method)
    integer, allocatable :: which(:)
    type(relief_t) :: relief
    integer :: i, k, m, n

    if (allocated(error)) return
    call find_places(stages, flank, diameter, which, error)
    if (allocated(error)) return
    m = size(methods)
    n = size(diameter)
    call table%begin('relief of the flanks at chosen diameters, by each method', m*n, error)
    if (allocated(error)) return
    allocate (roll(n), along(n, m), straight(n, m))
    associate (pair => stages%pair, inputs => stages%motions_inputs%motion%relief)
      relief%start = relief_start(inputs)
      relief%shape = inputs%shape
      do k = 1, n
        associate (which => which(k), gear => pair%gear(which(k)))
          associate (curvature => gear%curvature(drive, diameter(k)/2), start => pair%radius(which, relief%start(which)))
            roll(k) = curvature/gear%base_radius(drive)
            do i = 1, m
              relief%amount = methods(i)%amount
              along(k, i) = tip_relief(relief, inputs%contact_ratio, which, path_place(pair, which, curvature))
              straight(k, i) = relief%amount(which)*max(0.0_dp, (diameter(k)/2 - start)/(gear%tip_form_radius - start))
            end do
          end associate
        end associate
      end do
    end associate
    call table%add_index(axis('method', '', 'as in the table deflection_relief', [methods(each([(i, i=1, m)], n))%name]))
    call table%add_index(axis('gear', '', 'pinion or gear', gear_names([(which, i=1, m)])))
    call table%add_index(axis('diameter_mm', 'mm', 'diameter on the flank', [(diameter, i=1, m)]))
    call table%add('roll_deg', 'deg', 'roll angle there', [(roll, i=1, m)])
    call table%add('relief_um', 'um', 'relief as the motion has it: linear or parabolic in the roll angle', [along])
    call table%add('relief_by_diameter_um', 'um', 'relief of the same amount that grows in proportion to the diameter, as in '// &
                   'Eq. 1 of Thamba et al. 2020', [straight])
  end subroutine fill_flank

  !> Finds the diameters (m) and their gears: those of the case, which must lie on the involute.
  subroutine find_places(stages, flank, diameter, which, error)
    type(stages_t), intent(in) :: stages
    type(flank_t), intent(in) :: flank(2)
    real(dp), allocatable, intent(out) :: diameter(:)
    integer, allocatable, intent(out) :: which(:)
    type(error_t), allocatable, intent(inout) :: error
    integer, parameter :: steps = 9
    real(dp), allocatable :: own(:)
    real(dp) :: start(2), tip
    integer :: i, k

    allocate (diameter(0), which(0))
    start = relief_start(stages%motions_inputs%motion%relief)
    do i = 1, 2
      associate (gear => stages%pair%gear(i))
        if (allocated(flank(i)%diameter)) then
          own = flank(i)%diameter
          k = findloc(own < 2*gear%form_radius(drive) .or. own > 2*gear%tip_radius, .true., 1)
          if (k > 0) call fail(error, code_input, '&deflection_relief '//trim(gear_names(i))//'_diameter_mm = '// &
            str(milli*own(k))//': must lie on the involute, from '//str(2*milli*gear%form_radius(drive))//' to '// &
            str(2*milli*gear%tip_radius))
        else
          tip = path_place(stages%pair, i, gear%curvature(drive, gear%tip_form_radius))
          own = [(2*stages%pair%radius(i, start(i) + (tip - start(i))*k/steps), k=0, steps)]
        end if
      end associate
      diameter = [diameter, own]
      which = [which, spread(i, 1, size(own))]
    end do
  end subroutine find_places

  !> Path coordinate at which a gear's flank has this radius of curvature (m).
  pure real(dp) function path_place(pair, gear, curvature) result(s)
    type(pair_t), intent(in) :: pair
    integer, intent(in) :: gear
    real(dp), intent(in) :: curvature

    s = (curvature - pair%curvature(gear, 0.0_dp))/(pair%curvature(gear, 1.0_dp) - pair%curvature(gear, 0.0_dp))
  end function path_place

  !> Computes the effect of the reliefs of all methods at these speeds (1/min). `inputs`: of the case's motions, whose reliefs begin
  !> at the same diameters. `stopped`: the caller ended the run, and the results are incomplete.
  subroutine judge_reliefs(inputs, rpm, options, methods, stopped, error)
    type(motions_inputs_t), intent(in) :: inputs
    real(dp), intent(in) :: rpm(:)
    type(sweep_options_t), intent(in) :: options
    type(relief_method_t), intent(inout) :: methods(:)
    logical, intent(out) :: stopped
    type(error_t), allocatable, intent(inout) :: error
    type(oscillator_t) :: motion(size(methods))
    type(sweep_t) :: sweep
    integer :: i
    type(case_variation_t) :: case

    stopped = .false.
    do i = 1, size(methods)
      associate (amount => methods(i)%amount)
        case = case_variation_t(inputs, maxval(amount))
        if (case%relief > 0) case%inputs%motion%relief%fraction = amount/case%relief
        call case%build(motion(i), error)
      end associate
      if (allocated(error)) return
      methods(i)%error_range = error_range(motion(i))
    end do
    call run_sweep(motion, rpm, options, sweep, error)
    if (allocated(error)) return
    stopped = any(sweep%status == status_stopped)
    do i = 1, size(methods)
      methods(i)%worst = worst_of(sweep%rpm, sweep%dynamic_factor(:, i))
      methods(i)%failed = count(ieee_is_nan(sweep%dynamic_factor(:, i)))
    end do
  end subroutine judge_reliefs

  !> Peak-to-peak static transmission error under the static load of a motion (m).
  pure real(dp) function error_range(motion)
    type(oscillator_t), intent(in) :: motion
    type(harmonics_t) :: harmonics

    call find_harmonics(motion%mesh, motion%load, 1, harmonics)
    error_range = harmonics%peak_to_peak()
  end function error_range

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t(group, needs=[stage%geometry, stage%elasticity, stage%mesh, stage%reliefs, stage%motion, stage%losses, &
                                     stage%accuracy, stage%speeds, stage%direction], &
                       tables='deflection_relief relief_deflection relief_curve relief_flank', fields='', &
                       summary='tip relief from the deflection of the teeth, by formula and by finite elements, beside the '// &
                       'reliefs of least transmission error and least dynamic factor')
  end subroutine describe

  subroutine read_keys(self, reader, error)
    class(deflection_relief_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: point
    character(sentence_length) :: geared
    integer :: i

    geared = text_unless(.not. is_prescribed(reader), needs_gears)
    call reader%add_group(group, 'The task deflection_relief: tip relief from the deflection under load.')
    point = trim(self%point)
    call reader%get(group, 'point', point, error, tasks=group, not_allowed=geared, allowed=[character(5) :: 'tip', 'hpstc'], &
                    meaning='where the whole load bends each tooth: at its tip, or at its outer point of single contact, D of '// &
                    'the pinion and B of the gear (hpstc)')
    self%point = point
    do i = 1, 2
      call reader%get(group, trim(gear_names(i))//'_diameter_mm', self%flank(i)%diameter, error, unit='mm', tasks=group, &
                      not_allowed=geared, above=0.0_dp, at_most=1e6_dp, min_size=1, max_size=10000, &
                      default_note='ten, from where relief begins to the tip in equal steps of the roll angle', &
                      meaning='diameters of the '//trim(gear_names(i))//'''s flank at which relief_flank has the relief')
    end do
  end subroutine read_keys

  !> Upper bound of the operating points, as the search may try some reliefs twice.
  integer function count_points(self, stages) result(points)
    class(deflection_relief_task_t), intent(in) :: self
    type(stages_t), intent(in) :: stages

    points = most_tried*merge(size(stages%rpm), 0, self%uses(stage%speeds))
  end function count_points

  subroutine run(self, stages, error)
    class(deflection_relief_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(error_t), allocatable, intent(inout) :: error
    type(relief_method_t), allocatable :: methods(:)
    type(sweep_options_t) :: options
    type(optimum_t) :: optimum
    type(teeth_t) :: teeth
    logical :: stopped

    if (allocated(error)) return
    call self%find_deflection(stages, teeth, error)
    if (allocated(error) .or. wants_stop(stages%accuracy%steady%stop)) return
    options = stages%sweep_options()
    associate (inputs => stages%motions_inputs)
      if (associated(stages%running%progress)) then
        call find_optimum(with_relief, inputs, largest_relief(inputs), stages%rpm, options, optimum, error, &
                          stages%running%progress)
      else
        call find_optimum(with_relief, inputs, largest_relief(inputs), stages%rpm, options, optimum, error)
      end if
      if (allocated(error) .or. optimum%stopped) return
      stages%running%done = stages%running%done + size(optimum%amount)*size(stages%rpm)
      call list_methods(stages, teeth, optimum, methods, error)
      if (allocated(error)) return
      options%is_counted = .false.
      call judge_reliefs(inputs, stages%rpm, options, methods, stopped, error)
      if (allocated(error) .or. stopped) return
      associate (table => self%tables(self%place(group)))
        call table%over('tip reliefs by several methods, and what they do', error, &
                        axis('method', '', 'none: without relief; markovic_vrcan: bending and half the flattening by the '// &
                        'formula; whole_flattening: bending and all of it; finite_elements: the deflection by finite elements, '// &
                        'of the stiffness model fe; transmission_error: the least peak-to-peak static transmission error; '// &
                        'dynamic_factor: the least of the largest dynamic factors over the speeds, where one has an answer', &
                        [methods%name]))
        if (allocated(error)) return
        call table%add('pinion_relief_um', 'um', 'amount of relief at the pinion''s tip', [methods%amount(1)])
        call table%add('gear_relief_um', 'um', 'amount of relief at the gear''s tip', [methods%amount(2)])
        call table%add('within_um', 'um', 'largest distance to the true least; NaN without a search', &
                       merge(methods%within, no_number(), methods%within >= 0))
        call table%add('ste_range_um', 'um', 'peak-to-peak static transmission error with this relief', [methods%error_range])
        call table%add('worst_dynamic_factor', '', of_worst, factor_of(methods%worst))
        call table%add('rpm', '1/min', 'speed of the pinion where that is', speed_of(methods%worst))
        call table%add('points_without_answer', '', 'speeds without an answer', [methods%failed])
      end associate
      call self%fill_teeth(stages, teeth, error)
      call fill_curve(stages, optimum, self%tables(self%place('relief_curve')), error)
      call fill_flank(stages, self%flank, methods, self%tables(self%place('relief_flank')), error)
    end associate
    if (allocated(error)) return
    self%is_done = .true.
    self%failed = sum(methods%failed)
    self%log = group//': '//str(size(methods))//' reliefs compared, '//str(size(optimum%amount))//' swept'
  end subroutine run

  !> Computes the deflection of each tooth under the full load at its own point.
  subroutine find_deflection(self, stages, teeth, error)
    class(deflection_relief_task_t), intent(in) :: self
    type(stages_t), intent(in) :: stages
    type(teeth_t), intent(out) :: teeth
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: line_load
    integer :: i

    associate (pair => stages%pair, ratio => stages%pair%contact_ratio)
      line_load = stages%load/minval(pair%gear%spec%face_width)
      teeth%s = [ratio, 0.0_dp]
      if (self%point == 'hpstc') teeth%s = [aint(ratio), ratio - aint(ratio)]
      teeth%half_width = contact_half_width(stages%material(1), stages%material(2), .true., line_load, &
                                            pair%curvature(1, teeth%s), pair%curvature(2, teeth%s))
      do i = 1, 2
        teeth%formula(i) = formula_deflection(pair%gear(i), stages%material(i), line_load, teeth%half_width(i), &
                                              pair%radius(i, teeth%s(i)))
      end do
      teeth%elements = no_number()
      if (allocated(stages%elements_inputs)) call fe_deflection(pair, stages%material, stages%elements_inputs%options, line_load, &
                                                                teeth%half_width, teeth%s, teeth%elements, error)
    end associate
  end subroutine find_deflection

  !> Lists the methods with their reliefs. A gear whose fraction is 0 has no relief.
  subroutine list_methods(stages, teeth, optimum, methods, error)
    type(stages_t), intent(in) :: stages
    type(teeth_t), intent(in) :: teeth
    type(optimum_t), intent(in) :: optimum
    type(relief_method_t), allocatable, intent(out) :: methods(:)
    type(error_t), allocatable, intent(inout) :: error
    integer, parameter :: scan = 16, rounds = 4
    real(dp) :: amount, within, range(0:scan), first, last
    integer :: i, round, best
    type(oscillator_t) :: motion

    associate (inputs => stages%motions_inputs, fraction => stages%motions_inputs%motion%relief%fraction)
      ! Finds the amount of relief (m) between 0 and `largest` of least peak-to-peak static transmission error: a scan, then finer
      ! scans around the best amount, as the curve has kinks. `within`: distance from the minimum at most (m).
      first = 0
      last = largest_relief(inputs)
      do round = 1, rounds
        do i = 0, scan
          call with_relief(inputs, first + (last - first)*i/scan, motion, error)
          if (allocated(error)) return
          range(i) = error_range(motion)
        end do
        best = minloc(range, 1) - 1
        amount = first + (last - first)*best/scan
        within = (last - first)/scan
        first = max(0.0_dp, amount - within)
        last = min(largest_relief(inputs), amount + within)
      end do
      if (allocated(error)) return
      methods = [relief_method_t('none'), relief_method_t('markovic_vrcan', formula_relief(teeth%formula, .false.)), &
                 relief_method_t('whole_flattening', formula_relief(teeth%formula, .true.))]
      if (allocated(stages%elements_inputs)) methods = [methods, relief_method_t('finite_elements', teeth%elements)]
      methods = [methods, relief_method_t('transmission_error', amount*fraction, within)]
      if (optimum%best > 0) methods = [methods, relief_method_t('dynamic_factor', optimum%amount(optimum%best)*fraction, &
                                                               optimum%resolution)]
      do i = 1, 2
        if (.not. fraction(i) > 0) methods%amount(i) = 0
      end do
    end associate
  end subroutine list_methods

  !> Fills the table of the inputs of the deflections.
  subroutine fill_teeth(self, stages, teeth, error)
    class(deflection_relief_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(teeth_t), intent(in) :: teeth
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: start(2)

    start = relief_start(stages%motions_inputs%motion%relief)
    associate (table => self%tables(self%place('relief_deflection')), pair => stages%pair)
      call table%over('deflection of the teeth under the whole load', error, axis('gear', '', 'pinion or gear', gear_names))
      if (allocated(error)) return
      call table%add('load_diameter_mm', 'mm', 'diameter at which the load acts', 2*pair%radius([1, 2], teeth%s))
      call table%add('start_diameter_mm', 'mm', 'diameter at which relief begins, d_k', 2*pair%radius([1, 2], start))
      call table%add('load_height_mm', 'mm', 'y_p: height of the load above the root circle, along the tooth''s axis', &
                     [teeth%formula%height])
      call table%add('half_width_um', 'um', 'b_H: half width of the contact there, by Hertz', teeth%half_width)
      call table%add('bending_um', 'um', 'delta_b: bending of the tooth on its body, by the formula', [teeth%formula%bending])
      call table%add('flattening_um', 'um', 'delta_H: flattening of this flank, by the formula', [teeth%formula%flattening])
      call table%add('formula_deflection_um', 'um', 'their sum', formula_relief(teeth%formula, .true.))
      call table%add('fe_deflection_um', 'um', 'deflection of the tooth by finite elements, flattening included; NaN without '// &
                     'the stiffness model fe', teeth%elements)
    end associate
  end subroutine fill_teeth

  !> Fills transmission error and dynamic factor over the amounts that the search for the least dynamic factor tried.
  subroutine fill_curve(stages, optimum, table, error)
    type(stages_t), intent(in) :: stages
    type(optimum_t), intent(in) :: optimum
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    type(oscillator_t) :: motion
    real(dp) :: range(size(optimum%amount))
    integer :: i

    if (allocated(error)) return
    do i = 1, size(range)
      call with_relief(stages%motions_inputs, optimum%amount(i), motion, error)
      if (allocated(error)) return
      range(i) = error_range(motion)
    end do
    call table%over('static transmission error and dynamic factor over the amount of relief', error, &
                    axis('relief_um', 'um', 'amount of relief, ascending', optimum%amount))
    if (allocated(error)) return
    call table%add('ste_range_um', 'um', 'peak-to-peak static transmission error', range)
    call table%add('worst_dynamic_factor', '', of_worst, optimum%dynamic_factor)
    call table%add('at_least', '', '1: computed at a few speeds only, which show that this relief is not the best; the largest '// &
                   'DF is theirs; else 0', merge(1, 0, optimum%is_bound))
  end subroutine fill_curve

  pure subroutine add_report(self, lines)
    class(deflection_relief_task_t), intent(in) :: self
    type(lines_t), intent(inout) :: lines

    associate (table => self%tables(self%place(group)))
      call lines%add('')
      call lines%add('Tip relief')
      call table%show(lines, 'method pinion_relief_um gear_relief_um ste_range_um worst_dynamic_factor rpm')
    end associate
  end subroutine add_report
end module gearsweep_study_tasks_deflection_relief
