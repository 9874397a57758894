!> The task `deflection_relief`: tip relief from the deflection of the loaded teeth, by formula and by finite elements, beside the
!> reliefs whose transmission error and whose dynamic factor are least; and the relief at chosen diameters of the flanks.
module gearsweep_task_deflection_relief
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_case_variation, only: with_relief
  use gearsweep_decimal, only: in_um
  use gearsweep_deflection_formula, only: formula_deflection, formula_deflection_t, formula_relief
  use gearsweep_error, only: error_t
  use gearsweep_fe_stiffness, only: fe_deflection
  use gearsweep_flattening, only: contact_half_width
  use gearsweep_kinds, only: dp
  use gearsweep_lines, only: left, lines_t, right
  use gearsweep_motions, only: largest_relief, relief_start
  use gearsweep_optimum, only: find_optimum, most_tried, optimum_t
  use gearsweep_oscillator, only: oscillator_t
  use gearsweep_points, only: factor_in, factor_of, of_worst, speed_of
  use gearsweep_reader, only: reader_t
  use gearsweep_relief_flank, only: fill_flank, flank_t
  use gearsweep_relief_methods, only: error_range, judge_reliefs, least_error_relief, relief_method_t
  use gearsweep_stop, only: wants_stop
  use gearsweep_sweep, only: sweep_options_t
  use gearsweep_table, only: axis, no_number, table_t
  use gearsweep_stages, only: runnable_t, stages_t
  use gearsweep_task, only: members, stage, task_info_t
  use gearsweep_text, only: str
  use gearsweep_uses, only: is_prescribed, needs_gears, sentence_length, unless
  implicit none
  private
  public :: deflection_relief_task_t

  type, extends(runnable_t) :: deflection_relief_task_t
    character(5) :: point = 'tip'
    type(flank_t) :: flank(2)
  contains
    procedure, nopass :: describe
    procedure :: read_keys, run, add_report, count_points
    procedure, private :: find_deflection, fill_teeth
  end type deflection_relief_task_t

  !> Of the loaded teeth of both gears.
  type :: teeth_t
    real(dp) :: s(2) = 0                         !< path coordinates at which each is loaded
    real(dp) :: half_width(2) = 0                !< of the contact there, m
    type(formula_deflection_t) :: formula(2)
    real(dp) :: elements(2) = 0                  !< deflection by finite elements, m; NaN: there are none
  end type teeth_t

  character(*), parameter :: group = 'deflection_relief'
  real(dp), parameter :: milli = 1e3_dp, micro = 1e6_dp

contains

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t(group, needs=[stage%geometry, stage%elasticity, stage%mesh, stage%reliefs, stage%motion, stage%losses, &
                                     stage%accuracy, stage%speeds, stage%direction], &
                       tables='deflection_relief relief_deflection relief_curve relief_flank', fields='', &
                       gives='tip relief from the deflection of the teeth, by formula and by finite elements, beside the '// &
                       'reliefs of least transmission error and least dynamic factor')
  end subroutine describe

  subroutine read_keys(self, reader, error)
    class(deflection_relief_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: point
    character(sentence_length) :: geared
    integer :: i

    geared = unless(.not. is_prescribed(reader), needs_gears)
    call reader%add_group(group, 'The task deflection_relief: tip relief from the deflection under load.')
    point = trim(self%point)
    call reader%get(group, 'point', point, error, tasks=group, refused=geared, allowed=[character(5) :: 'tip', 'hpstc'], &
                    meaning='where the whole load bends each tooth: at its tip, or at its outer point of single contact, D of '// &
                    'the pinion and B of the gear (hpstc)')
    self%point = point
    do i = 1, 2
      call reader%get(group, trim(members(i))//'_diameter_mm', self%flank(i)%diameter, error, unit='mm', tasks=group, &
                      refused=geared, above=0.0_dp, at_most=1e6_dp, min_size=1, max_size=10000, &
                      otherwise='ten, from where relief begins to the tip in equal steps of the roll angle', &
                      meaning='diameters of the '//trim(members(i))//'''s flank at which the table relief_flank tells the relief')
    end do
  end subroutine read_keys

  !> At most, as the search may try some reliefs twice.
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
      call fill_methods(methods, self%tables(self%place(group)), error)
      call self%fill_teeth(stages, teeth, error)
      call fill_curve(stages, optimum, self%tables(self%place('relief_curve')), error)
      call fill_flank(stages, self%flank, methods, self%tables(self%place('relief_flank')), error)
    end associate
    if (allocated(error)) return
    self%is_done = .true.
    self%failed = sum(methods%failed)
    self%log = group//': '//str(size(methods))//' reliefs compared, '//str(size(optimum%amount))//' swept'
  end subroutine run

  !> What the teeth deflect, each under the whole load at its own point.
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

  !> Each method with its relief. A gear whose fraction is 0 gets none.
  subroutine list_methods(stages, teeth, optimum, methods, error)
    type(stages_t), intent(in) :: stages
    type(teeth_t), intent(in) :: teeth
    type(optimum_t), intent(in) :: optimum
    type(relief_method_t), allocatable, intent(out) :: methods(:)
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: amount, within
    integer :: i

    associate (inputs => stages%motions_inputs, fraction => stages%motions_inputs%motion%relief%fraction)
      call least_error_relief(inputs, largest_relief(inputs), amount, within, error)
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

  !> The reliefs side by side.
  pure subroutine fill_methods(methods, table, error)
    type(relief_method_t), intent(in) :: methods(:)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error

    call table%over('tip reliefs by several methods, and what they do', error, &
                    axis('method', '', 'none: without relief; markovic_vrcan: bending and half the flattening by the formula; '// &
                    'whole_flattening: bending and all of it; finite_elements: the deflection by finite elements, of '// &
                    'the stiffness model fe; transmission_error: the least peak-to-peak static transmission error; '// &
                    'dynamic_factor: the least of the largest dynamic factors over the speeds, where one has an answer', &
                    [methods%name]))
    if (allocated(error)) return
    call table%add('pinion_relief_um', 'um', 'amount of relief at the pinion''s tip', in_um(methods%amount(1)))
    call table%add('gear_relief_um', 'um', 'amount of relief at the gear''s tip', in_um(methods%amount(2)))
    call table%add('within_um', 'um', 'the least lies so near; NaN for methods that look for none', &
                   merge(micro*methods%within, no_number(), methods%within >= 0))
    call table%add('ste_range_um', 'um', 'peak-to-peak static transmission error with this relief', micro*methods%error_range)
    call table%add('worst_dynamic_factor', '', of_worst, factor_of(methods%worst))
    call table%add('rpm', '1/min', 'speed of the pinion where that is', speed_of(methods%worst))
    call table%add('points_without_answer', '', 'speeds without an answer', [methods%failed])
  end subroutine fill_methods

  !> What the deflections are made from.
  subroutine fill_teeth(self, stages, teeth, error)
    class(deflection_relief_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(teeth_t), intent(in) :: teeth
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: start(2)

    start = relief_start(stages%motions_inputs%motion%relief)
    associate (table => self%tables(self%place('relief_deflection')), pair => stages%pair)
      call table%over('deflection of the teeth under the whole load', error, axis('member', '', 'pinion or gear', members))
      if (allocated(error)) return
      call table%add('load_diameter_mm', 'mm', 'diameter at which the load acts', 2*milli*pair%radius([1, 2], teeth%s))
      call table%add('start_diameter_mm', 'mm', 'diameter at which relief begins, d_k', 2*milli*pair%radius([1, 2], start))
      call table%add('load_height_mm', 'mm', 'y_p: height of the load above the root circle, along the tooth''s axis', &
                     milli*teeth%formula%height)
      call table%add('half_width_um', 'um', 'b_H: half width of the contact there, by Hertz', micro*teeth%half_width)
      call table%add('bending_um', 'um', 'delta_b: bending of the tooth on its body, by the formula', micro*teeth%formula%bending)
      call table%add('flattening_um', 'um', 'delta_H: flattening of this flank, by the formula', micro*teeth%formula%flattening)
      call table%add('formula_deflection_um', 'um', 'their sum', micro*formula_relief(teeth%formula, .true.))
      call table%add('fe_deflection_um', 'um', 'deflection of the tooth by finite elements, flattening included; NaN without '// &
                     'the stiffness model fe', micro*teeth%elements)
    end associate
  end subroutine fill_teeth

  !> Transmission error and dynamic factor over the amount of relief that the search for the least dynamic factor tried.
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
                    axis('relief_um', 'um', 'amount of relief, ascending', in_um(optimum%amount)))
    if (allocated(error)) return
    call table%add('ste_range_um', 'um', 'peak-to-peak static transmission error', micro*range)
    call table%add('worst_dynamic_factor', '', of_worst, optimum%dynamic_factor)
    call table%add('at_least', '', '1: a few speeds showed that this relief is not the best, and the largest DF is that of '// &
                   'these; else 0', merge(1, 0, optimum%is_bound))
  end subroutine fill_curve

  pure subroutine add_report(self, lines)
    class(deflection_relief_task_t), intent(in) :: self
    type(lines_t), intent(inout) :: lines
    integer :: i

    associate (table => self%tables(self%place(group)))
      call lines%add('')
      call lines%add('Tip relief')
      call lines%add('   method                pinion um     gear um   STE range um  worst DF         rpm')
      do i = 1, table%rows
        call lines%put('   '//left(trim(table%word('method', i)), 20)//right(str(table%number('pinion_relief_um', i), 4), 11)// &
                       right(str(table%number('gear_relief_um', i), 4), 12)//right(str(table%number('ste_range_um', i), 4), 15)// &
                       factor_in(table%number('worst_dynamic_factor', i)))
        if (ieee_is_nan(table%number('rpm', i))) call lines%add('')
        if (.not. ieee_is_nan(table%number('rpm', i))) call lines%add(right(str(table%number('rpm', i)), 12))
      end do
    end associate
  end subroutine add_report
end module gearsweep_task_deflection_relief
