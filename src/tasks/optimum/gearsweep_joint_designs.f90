!> What the task `optimum` varies beside one amount of relief: amounts and lengths of both gears' reliefs under several loads.
module gearsweep_joint_designs
  use gearsweep_case_variation, only: case_variation_t, of_force
  use gearsweep_decimal, only: in_um
  use gearsweep_error, only: error_t
  use gearsweep_inputs, only: motions_inputs_t
  use gearsweep_joint_optimum, only: joint_optimum_t, starts_t
  use gearsweep_kinds, only: dp
  use gearsweep_motions, only: largest_relief, relief_start
  use gearsweep_oscillator, only: oscillator_t
  use gearsweep_points, only: factor_of, of_worst, speed_of
  use gearsweep_table, only: axis, no_number, table_t
  implicit none
  private
  public :: designs_t, make_designs, relief_of, design_starts, with_design, fill_design, fill_loads

  !> Designs of a case: their numbers are one amount, or that of each gear, and one length, or that of each gear, if it counts.
  !> The design with the case's own lengths and the best amount by itself is one of them.
  type :: designs_t
    logical :: with_length = .false., each_gear = .false.
    real(dp), allocatable :: load_factor(:)      !< loads over that of the case
    type(motions_inputs_t) :: inputs
    real(dp) :: largest(2) = 0                   !< amounts at the tips, m
    !> Lengths of both reliefs in base pitches, and which parts of their ranges the case's own ones are.
    real(dp), dimension(2) :: shortest = 0, own = 0, longest = 0, own_part = 0
  end type designs_t

  !> Shortest relief, of the path of contact.
  real(dp), parameter :: least_length = 0.05_dp

contains

  !> Fills `largest` and the lengths from the other components.
  subroutine make_designs(designs, amount)
    type(designs_t), intent(inout) :: designs
    real(dp), intent(in) :: amount               !< the best one by itself, m; 0: none is known
    type(motions_inputs_t) :: inputs

    inputs = designs%inputs
    inputs%motion%load = maxval(designs%load_factor)*inputs%motion%load
    if (designs%each_gear) inputs%motion%relief%fraction = 1
    associate (relief => designs%inputs%motion%relief, low => designs%shortest, own => designs%own, high => designs%longest)
      designs%largest = largest_relief(inputs)
      if (designs%each_gear) then
        designs%largest = max(designs%largest, amount*relief%fraction)
      else
        designs%largest = max(designs%largest, amount)*relief%fraction
      end if
      own = relief_start(relief)
      own(1) = relief%contact_ratio - own(1)
      low = min(least_length*relief%contact_ratio, own)
      ! At most from the pitch point.
      high = max([relief%contact_ratio - relief%pitch_point, relief%pitch_point], own)
      designs%own_part = (own - low)/max(high - low, tiny(1.0_dp))
      if (.not. designs%each_gear) designs%own_part = sum(designs%own_part)/2
    end associate
  end subroutine make_designs

  !> Amounts of relief at the tips of pinion and gear (m), and the path coordinates at which they begin.
  pure subroutine relief_of(designs, number, amount, start)
    type(designs_t), intent(in) :: designs
    real(dp), intent(in) :: number(:)            !< parts of their ranges, 0 to 1
    real(dp), intent(out) :: amount(2), start(2)
    real(dp) :: part(2), length(2)

    associate (relief => designs%inputs%motion%relief)
      amount = designs%largest*[number(1), number(merge(2, 1, designs%each_gear))]
      start = relief_start(relief)
      if (.not. designs%with_length) return
      part = [number(size(number) - merge(1, 0, designs%each_gear)), number(size(number))]
      length = length_at(part, designs%own_part, designs%shortest, designs%own, designs%longest)
      start = [relief%contact_ratio - length(1), length(2)]
    end associate
  end subroutine relief_of

  !> The length at a part of its range: in two straight pieces, which meet at the case's own.
  elemental real(dp) function length_at(part, own_part, shortest, own, longest) result(length)
    real(dp), intent(in) :: part, own_part, shortest, own, longest

    if (part < own_part) then
      length = shortest + (own - shortest)*(part/own_part)
    else
      length = own
      if (own_part < 1) length = own + (longest - own)*((part - own_part)/(1 - own_part))
    end if
  end function length_at

  !> The best amount by itself; and a grid over the ranges, with the same parts of them for both gears: a group for each length.
  pure function design_starts(designs, amount) result(starts)
    type(designs_t), intent(in) :: designs
    real(dp), intent(in) :: amount               !< the best one by itself, m; below 0: none has a result
    integer, parameter :: amounts = 8, lengths = 4
    type(starts_t), allocatable :: starts(:)
    real(dp), allocatable :: number(:, :)
    real(dp) :: tip(2), of_amount(2)
    integer :: each, groups, first, i, k

    each = merge(2, 1, designs%each_gear)
    groups = merge(lengths, 1, designs%with_length)
    first = merge(1, 0, amount >= 0)
    allocate (starts(first + groups), number(each*merge(2, 1, designs%with_length), amounts + 1))
    do k = 1, groups
      do i = 0, amounts
        number(:each, i + 1) = i/real(amounts, dp)
        number(each + 1:, i + 1) = k/real(lengths, dp)
      end do
      starts(first + k)%number = number
    end do
    if (first == 0) return
    tip = amount*designs%inputs%motion%relief%fraction
    of_amount = 0
    where (designs%largest > 0) of_amount = tip/designs%largest
    if (.not. designs%each_gear) of_amount = maxval(of_amount)
    number(:each, 1) = min(1.0_dp, of_amount(:each))
    if (designs%with_length) number(each + 1:, 1) = designs%own_part(:each)
    starts(1)%number = number(:, :1)
  end function design_starts

  !> The oscillators of a design, one for each load.
  subroutine with_design(context, number, motion, error)
    class(*), intent(in) :: context              !< designs_t
    real(dp), intent(in) :: number(:)
    type(oscillator_t), allocatable, intent(out) :: motion(:)
    type(error_t), allocatable, intent(out) :: error
    type(case_variation_t) :: case
    real(dp) :: amount(2), start(2)
    integer :: i

    select type (context)
    type is (designs_t)
      case%inputs = context%inputs
      call relief_of(context, number, amount, start)
      associate (relief => case%inputs%motion%relief)
        ! A length needs no room that short relief needs.
        if (context%with_length) relief%start = 'pitch'
        relief%shift = relief%shift + start - relief_start(relief)
      end associate
      call case%set_reliefs(amount)
      allocate (motion(size(context%load_factor)))
      do i = 1, size(motion)
        call case%set(of_force, context%load_factor(i)*context%inputs%motion%load)
        call case%build(motion(i), error)
        if (allocated(error)) return
      end do
    end select
  end subroutine with_design

  !> The best design, and how exactly it is known.
  pure subroutine fill_design(designs, optimum, table, error)
    type(designs_t), intent(in) :: designs
    type(joint_optimum_t), intent(in) :: optimum
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: amount(2), start(2), diameter(2), worst
    integer :: where_worst

    if (allocated(error)) return
    call table%begin('the reliefs of both gears whose largest dynamic factor over all speeds and loads is least', 1, error)
    if (allocated(error)) return
    amount = no_number()
    start = no_number()
    diameter = no_number()
    worst = no_number()
    where_worst = 0
    if (allocated(optimum%best%worst)) then
      call relief_of(designs, optimum%best%number, amount, start)
      associate (relief => designs%inputs%motion%relief)
        if (.not. relief%prescribed) diameter = 2e3_dp*relief%pair%radius([1, 2], start)
      end associate
      where_worst = maxloc(optimum%best%worst%dynamic_factor, 1, mask=optimum%best%worst%rpm > 0)
      worst = optimum%best%worst(where_worst)%dynamic_factor
    end if
    call table%add('pinion_relief_um', 'um', 'amount of relief at the pinion''s tip; NaN where no point has an answer', &
                   in_um(amount(1:1)))
    call table%add('gear_relief_um', 'um', 'at the gear''s', in_um(amount(2:2)))
    call table%add('pinion_relief_start', '', 'path coordinate at which the pinion''s relief begins, in base pitches from A', &
                   start(1:1))
    call table%add('gear_relief_start', '', 'at which the gear''s begins', start(2:2))
    call table%add('pinion_start_diameter_mm', 'mm', 'diameter of the pinion at which its relief begins; NaN for a '// &
                   'prescribed mesh', diameter(1:1))
    call table%add('gear_start_diameter_mm', 'mm', 'the same of the gear', diameter(2:2))
    call table%add('worst_dynamic_factor', '', 'largest DF over the speeds and loads; NaN where none has an answer', [worst])
    call table%add('within', '', 'within such a part of the ranges, up and down in each of these numbers, no better design '// &
                   'was found', [optimum%within])
    call table%add('designs_tried', '', 'designs tried', [optimum%tried])
  end subroutine fill_design

  !> What the best design does under each load.
  pure subroutine fill_loads(designs, optimum, table, error)
    type(designs_t), intent(in) :: designs
    type(joint_optimum_t), intent(in) :: optimum
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error

    if (allocated(error)) return
    associate (n => size(designs%load_factor))
      call table%over('the best reliefs of both gears under each load', error, &
                      axis('load_factor', '', 'load over that of the case', designs%load_factor))
      if (allocated(error)) return
      if (allocated(optimum%best%worst)) then
        call table%add('worst_dynamic_factor', '', of_worst, factor_of(optimum%best%worst))
        call table%add('rpm', '1/min', 'speed of the pinion where that is', speed_of(optimum%best%worst))
        call table%add('points_without_answer', '', 'speeds without an answer', optimum%best%failed)
      else
        call table%add('worst_dynamic_factor', '', of_worst, spread(no_number(), 1, n))
        call table%add('rpm', '1/min', 'speed of the pinion where that is', spread(no_number(), 1, n))
        call table%add('points_without_answer', '', 'speeds without an answer', spread(-1, 1, n))
      end if
    end associate
  end subroutine fill_loads
end module gearsweep_joint_designs
