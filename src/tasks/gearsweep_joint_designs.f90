!> What the task `optimum` varies beside one amount of relief: amounts and lengths of both gears' reliefs under several loads.
module gearsweep_joint_designs
  use gearsweep_decimal, only: in_um
  use gearsweep_error, only: error_t
  use gearsweep_inputs, only: motions_inputs_t
  use gearsweep_joint_optimum, only: joint_optimum_t
  use gearsweep_kinds, only: dp
  use gearsweep_motions, only: build_motion, relief_start
  use gearsweep_oscillator, only: oscillator_t
  use gearsweep_points, only: factor_of, of_worst, speed_of
  use gearsweep_table, only: no_number, table_t
  implicit none
  private
  public :: designs_t, relief_of, design_starts, with_design, fill_design, fill_loads

  !> Designs of a case: their numbers are one amount, or that of each gear, and one length, or that of each gear, if it counts.
  type :: designs_t
    logical :: with_length = .false., each_gear = .false.
    real(dp), allocatable :: load_factor(:)      !< loads over that of the case
    type(motions_inputs_t) :: inputs
    real(dp) :: largest = 0                      !< amount at the tips, m
  end type designs_t

  !> Shortest relief, of the path of contact.
  real(dp), parameter :: shortest = 0.05_dp

contains

  !> Amounts of relief at the tips of pinion and gear (m), and the path coordinates at which they begin.
  pure subroutine relief_of(designs, number, amount, start)
    type(designs_t), intent(in) :: designs
    real(dp), intent(in) :: number(:)            !< parts of their ranges, 0 to 1
    real(dp), intent(out) :: amount(2), start(2)
    real(dp) :: longest(2), length(2)

    associate (relief => designs%inputs%motion%relief, ratio => designs%inputs%motion%relief%contact_ratio)
      if (designs%each_gear) then
        amount = designs%largest*number(:2)
      else
        amount = designs%largest*number(1)*relief%fraction
      end if
      start = relief_start(relief)
      if (.not. designs%with_length) return
      ! At most from the pitch point.
      longest = [ratio - relief%pitch_point, relief%pitch_point]
      length = shortest*ratio + (longest - shortest*ratio)*[number(size(number) - merge(1, 0, designs%each_gear)), &
                                                            number(size(number))]
      start = [ratio - length(1), length(2)]
    end associate
  end subroutine relief_of

  !> A grid over the ranges, with the same parts of them for both gears: a group for each length.
  pure function design_starts(designs) result(starts)
    type(designs_t), intent(in) :: designs
    integer, parameter :: amounts = 8, lengths = 4
    real(dp), allocatable :: starts(:, :, :)     !< (number, amount, length)
    integer :: each, groups, i, k

    each = merge(2, 1, designs%each_gear)
    groups = merge(lengths, 1, designs%with_length)
    allocate (starts(each*merge(2, 1, designs%with_length), amounts + 1, groups))
    do k = 1, groups
      do i = 0, amounts
        starts(:each, i + 1, k) = i/real(amounts, dp)
        starts(each + 1:, i + 1, k) = k/real(lengths, dp)
      end do
    end do
  end function design_starts

  !> The oscillators of a design, one for each load.
  subroutine with_design(context, number, motion, error)
    class(*), intent(in) :: context              !< designs_t
    real(dp), intent(in) :: number(:)
    type(oscillator_t), allocatable, intent(out) :: motion(:)
    type(error_t), allocatable, intent(out) :: error
    type(motions_inputs_t) :: inputs
    real(dp) :: amount(2), start(2)
    integer :: i

    select type (context)
    type is (designs_t)
      inputs = context%inputs
      call relief_of(context, number, amount, start)
      ! A length needs no room that short relief needs.
      if (context%with_length) inputs%motion%relief%start = 'pitch'
      inputs%motion%relief%shift = inputs%motion%relief%shift + start - relief_start(inputs%motion%relief)
      inputs%motion%relief%fraction = amount
      allocate (motion(size(context%load_factor)))
      do i = 1, size(motion)
        inputs%motion%load = context%load_factor(i)*context%inputs%motion%load
        call build_motion(inputs%motion, inputs%stiffness, inputs%profile_error, merge(1.0_dp, 0.0_dp, any(amount > 0)), &
                          motion(i), error)
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
    real(dp) :: amount(2), start(2), worst
    integer :: where_worst

    if (allocated(error)) return
    call table%begin('the reliefs of both gears whose largest dynamic factor over all speeds and loads is least', 1, 9, error)
    if (allocated(error)) return
    amount = no_number()
    start = no_number()
    worst = no_number()
    where_worst = 0
    if (allocated(optimum%best%worst)) then
      call relief_of(designs, optimum%best%number, amount, start)
      where_worst = maxloc(optimum%best%worst%dynamic_factor, 1, mask=optimum%best%worst%rpm > 0)
      worst = optimum%best%worst(where_worst)%dynamic_factor
    end if
    call table%add('pinion_relief_um', 'um', 'amount of relief at the pinion''s tip; NaN where no point has an answer', &
                   in_um(amount(1:1)))
    call table%add('gear_relief_um', 'um', 'at the gear''s', in_um(amount(2:2)))
    call table%add('pinion_relief_start', '', 'path coordinate at which the pinion''s relief begins, in base pitches from A', &
                   start(1:1))
    call table%add('gear_relief_start', '', 'at which the gear''s begins', start(2:2))
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
      call table%begin('the best reliefs of both gears under each load', n, 5, error, extent=[n])
      if (allocated(error)) return
      call table%add_index('load_factor', '', 'load over that of the case', designs%load_factor)
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
