!> Tables of the transmission error over the turn of gears whose teeth have errors of their own, and of its orders.
module gearsweep_order_tables
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_decimal, only: in_um
  use gearsweep_deviations, only: wave_t
  use gearsweep_error, only: error_t
  use gearsweep_harmonics, only: find_harmonics, harmonics_t
  use gearsweep_kinds, only: dp, pi
  use gearsweep_oscillator, only: oscillator_t
  use gearsweep_points, only: of_relief, of_speed, status_length, words_of
  use gearsweep_sharing, only: share_load, sharing_t
  use gearsweep_spectrum, only: find_spectrum, spectrum_t
  use gearsweep_table, only: axis, no_number, table_t
  use gearsweep_task, only: members
  use gearsweep_text, only: str
  use gearsweep_turn, only: length_of, turn_t
  implicit none
  private
  public :: fill_turn, fill_orders, fill_waterfall

  real(dp), parameter :: micro = 1e6_dp

  !> An order of pinion or gear.
  type :: order_t
    integer :: gear = 1                          !< 1: pinion, 2: gear
    integer :: number = 0                        !< cycles a turn of it
    real(dp) :: cycles = 0                       !< a turn of the pinion
    character(32) :: name = ''
  end type order_t

  character(*), parameter :: of_order = 'order: cycles a turn of the pinion'
  character(*), parameter :: of_amplitude = 'half of peak-to-peak of this part of the dynamic transmission error; NaN where '// &
    'there is no answer'

contains

  !> Transmission errors over the turn: at rest, then at each speed.
  subroutine fill_turn(osc, amount, turns, table, error)
    type(oscillator_t), intent(in) :: osc(:)     !< (relief)
    real(dp), intent(in) :: amount(:)            !< m; (relief)
    type(turn_t), intent(in) :: turns(:, :)      !< (speed, relief)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    integer, parameter :: samples = 50           ! of a mesh period at rest
    type(sharing_t) :: at_rest(size(osc))
    real(dp), allocatable :: values(:, :)
    integer :: i, k, row, rows

    rows = 0
    do i = 1, size(osc)
      call share_load(osc(i)%mesh, osc(i)%load, samples, at_rest(i))
      rows = rows + size(at_rest(i)%phase) + sum([(length_of(turns(k, i)%left), k=1, size(turns, 1))])
    end do
    call table%begin('transmission error along the line of action over the turn, at rest (rpm 0) and in motion', rows, error)
    if (allocated(error)) return
    allocate (values(rows, 4))
    row = 0
    do i = 1, size(osc)
      call put(0.0_dp, at_rest(i)%phase, at_rest(i)%error)
      do k = 1, size(turns, 1)
        if (length_of(turns(k, i)%left) > 0) call put(turns(k, i)%rpm, turns(k, i)%left, turns(k, i)%error(0, :))
      end do
    end do
    call table%add_index(axis('relief_um', 'um', of_relief, values(:, 1)))
    call table%add_index(axis('rpm', '1/min', 'speed of the pinion; 0: at rest', values(:, 2)))
    call table%add_index(axis('tau', '', 'time in mesh periods since the stated teeth entered at A', values(:, 3)))
    call table%add('pinion_angle_deg', 'deg', 'angle through which the pinion has turned', &
                   values(:, 3)*360/osc(1)%mesh%teeth(1))
    call table%add('transmission_error_um', 'um', 'static (rpm 0) or dynamic transmission error along the line of action; 0 '// &
                   'where nominal teeth touch without load', micro*values(:, 4))

  contains

    subroutine put(rpm, tau, value)
      real(dp), intent(in) :: rpm, tau(:), value(:)

      associate (new => values(row + 1:row + size(tau), :))
        new(:, 1) = in_um(amount(i))
        new(:, 2) = rpm
        new(:, 3) = tau
        new(:, 4) = value
      end associate
      row = row + size(tau)
    end subroutine put
  end subroutine fill_turn

  !> Orders of the transmission error.
  subroutine fill_orders(osc, amount, turns, mesh_orders, table, error)
    type(oscillator_t), intent(in) :: osc(:)     !< (relief)
    real(dp), intent(in) :: amount(:)            !< m; (relief)
    type(turn_t), intent(in) :: turns(:, :)      !< (speed, relief)
    integer, intent(in) :: mesh_orders
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    type(order_t), allocatable :: orders(:)
    real(dp), allocatable :: values(:, :), at_rest(:, :)
    character(status_length), allocatable :: words(:)      ! (turn)
    integer :: i, k, n, row

    associate (teeth => osc(1)%mesh%teeth)
      orders = list_orders(teeth, mesh_orders)
      call name_waves(osc(1)%mesh%deviations%waves, teeth, orders)
      n = size(orders)
      call table%begin('orders of the transmission error over the turn: each part is amplitude cos(2 pi order t + phase) over '// &
                       'turns t of the pinion', n*size(turns), error)
      if (allocated(error)) return
      allocate (values(table%rows, 8), source=no_number())
      row = 0
      do i = 1, size(osc)
        at_rest = orders_at_rest(osc(i), mesh_orders, orders)
        do k = 1, size(turns, 1)
          associate (new => values(row + 1:row + n, :), turn => turns(k, i))
            new(:, 1) = in_um(amount(i))
            new(:, 2) = turn%rpm
            new(:, 3) = orders%cycles
            new(:, 4) = orders%cycles*turn%rpm/60
            if (allocated(turn%left)) new(:, 5:6) = orders_moving(turn, teeth, mesh_orders, orders)
            new(:, 7:8) = at_rest
          end associate
          row = row + n
        end do
      end do
      call table%add_index(axis('relief_um', 'um', of_relief, values(:, 1)))
      call table%add_index(axis('rpm', '1/min', of_speed, values(:, 2)))
      call table%add_index(axis('order', '', of_order, values(:, 3)))
      call table%add_words('order_name', 'what it is: mesh, pinion and gear orders, sidebands of mesh orders, and told waves', &
                           [(orders%name, k=1, size(turns))])
      words = reshape(words_of(turns%point%steady%status), [size(turns)])
      where (.not. reshape(turns%rpm > 0, [size(turns)])) words = 'none'
      call table%add_words('status', 'how this operating point ended, in a word; none: no speed has an answer', &
                           [(spread(words(k), 1, n), k=1, size(turns))])
      call table%add('gear_order', '', 'cycles a turn of the gear', values(:, 3)*teeth(2)/teeth(1))
      call table%add('frequency_hz', 'Hz', 'frequency at this speed', values(:, 4))
      call table%add('dte_amplitude_um', 'um', of_amplitude, micro*values(:, 5))
      call table%add('dte_phase_deg', 'deg', 'its phase at the time 0', values(:, 6)*180/pi)
      call table%add('ste_amplitude_um', 'um', 'the same of the static transmission error', micro*values(:, 7))
      call table%add('ste_phase_deg', 'deg', 'its phase at the time 0', values(:, 8)*180/pi)
    end associate
  end subroutine fill_orders

  !> Amplitudes of the orders over the speed.
  subroutine fill_waterfall(teeth, turns, mesh_orders, table, error)
    integer, intent(in) :: teeth(2)              !< of pinion and gear
    type(turn_t), intent(in) :: turns(:)         !< (speed)
    integer, intent(in) :: mesh_orders
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    type(order_t), allocatable :: orders(:)
    real(dp), allocatable :: values(:, :), moving(:, :)
    integer :: k

    orders = list_orders(teeth, mesh_orders)
    call table%over('orders of the dynamic transmission error over the speed', error, &
                    axis('rpm', '1/min', of_speed, [(turns(k)%rpm, k=1, size(turns))]), &
                    axis('order', '', of_order, [(orders(k)%cycles, k=1, size(orders))]))
    if (allocated(error)) return
    allocate (values(size(orders), size(turns)), source=no_number())
    do k = 1, size(turns)
      if (.not. allocated(turns(k)%left)) cycle
      moving = orders_moving(turns(k), teeth, mesh_orders, orders)
      values(:, k) = moving(:, 1)
    end do
    call table%add('dte_amplitude_um', 'um', of_amplitude, micro*[values])
  end subroutine fill_waterfall

  !> Amplitude (m) and phase (rad) of the orders in motion; (order, 2).
  pure function orders_moving(turn, teeth, mesh_orders, orders) result(values)
    type(turn_t), intent(in) :: turn             ! with a result
    integer, intent(in) :: teeth(2), mesh_orders
    type(order_t), intent(in) :: orders(:)
    real(dp) :: values(size(orders), 2)
    type(spectrum_t) :: spectrum
    integer :: i

    values = 0
    do i = 1, 2
      if (.not. any(orders%gear == i)) cycle
      call find_spectrum(turn%left, turn%width, turn%error, mesh_orders*teeth(i), spectrum, base=1.0_dp/teeth(i))
      call take_orders(orders, i, size(turn%load), teeth, spectrum%amplitude, spectrum%phase, values)
    end do
  end function orders_moving

  !> The same at rest.
  pure function orders_at_rest(osc, mesh_orders, orders) result(values)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: mesh_orders
    type(order_t), intent(in) :: orders(:)
    real(dp) :: values(size(orders), 2)
    !> Where a pair begins to carry, its flattening has no Taylor series, and each halving only quarters the error there: behind
    !> these it is 1e-9 of the curve.
    integer, parameter :: halvings = 4
    type(harmonics_t) :: harmonics
    integer :: i

    values = 0
    associate (teeth => osc%mesh%teeth)
      do i = 1, 2
        if (.not. any(orders%gear == i)) cycle
        call find_harmonics(osc%mesh, osc%load, mesh_orders*teeth(i), harmonics, halvings, base=1.0_dp/teeth(i))
        call take_orders(orders, i, osc%mesh%deviations%periods, teeth, harmonics%amplitude, harmonics%phase, values)
      end do
    end associate
  end function orders_at_rest

  !> Takes the orders of one gear from its harmonics, those that are whole over the turn.
  pure subroutine take_orders(orders, gear, periods, teeth, amplitude, phase, values)
    type(order_t), intent(in) :: orders(:)
    integer, intent(in) :: gear, periods, teeth(2)
    real(dp), intent(in) :: amplitude(:), phase(:)         ! (cycles a turn of the gear)
    real(dp), intent(inout) :: values(:, :)      ! (order, 2)
    integer :: i

    do i = 1, size(orders)
      if (orders(i)%gear == gear .and. is_whole(orders(i), periods, teeth)) &
        values(i, :) = [amplitude(orders(i)%number), phase(orders(i)%number)]
    end do
  end subroutine take_orders

  !> Does an order have whole cycles over so many mesh periods? What repeats after these has no others.
  pure logical function is_whole(order, periods, teeth)
    type(order_t), intent(in) :: order
    integer, intent(in) :: periods, teeth(2)

    is_whole = modulo(int(order%number, int64)*periods, int(teeth(order%gear), int64)) == 0
  end function is_whole

  !> The orders of both gears up to so many mesh orders, ascending. What is an order of both is the pinion's.
  pure function list_orders(teeth, mesh_orders) result(orders)
    integer, intent(in) :: teeth(2), mesh_orders
    type(order_t), allocatable :: orders(:)
    integer :: next(2), n
    logical :: is_gears

    allocate (orders(mesh_orders*sum(teeth)))
    next = 1
    n = 0
    do while (any(next <= mesh_orders*teeth))
      n = n + 1
      is_gears = int(next(2), int64)*teeth(1) < int(next(1), int64)*teeth(2)
      if (is_gears) then
        orders(n) = order_t(2, next(2), next(2)*real(teeth(1), dp)/teeth(2), name_of('gear', next(2), teeth(2)))
      else
        orders(n) = order_t(1, next(1), real(next(1), dp), &
                            name_of(merge('shaft ', 'pinion', teeth(1) == teeth(2)), next(1), teeth(1)))
        if (int(next(2), int64)*teeth(1) == int(next(1), int64)*teeth(2)) next(2) = next(2) + 1
      end if
      if (is_gears) next(2) = next(2) + 1
      if (.not. is_gears) next(1) = next(1) + 1
    end do
    orders = orders(:n)
  end function list_orders

  !> Names the orders of told waves by these.
  pure subroutine name_waves(waves, teeth, orders)
    type(wave_t), intent(in) :: waves(:)
    integer, intent(in) :: teeth(2)
    type(order_t), intent(inout) :: orders(:)
    integer :: i

    do i = 1, size(waves)
      associate (wave => waves(i))
        if (wave%order == 1) cycle               ! run-out
        where (int(orders%number, int64)*teeth(wave%gear) == int(wave%order, int64)*teeth(orders%gear)) &
          orders%name = trim(members(wave%gear))//' wave '//str(wave%order)
      end associate
    end do
  end subroutine name_waves

  !> Order n of a gear with so many teeth: an order of its own, of the mesh, or a sideband of that.
  pure function name_of(gear, n, teeth) result(name)
    character(*), intent(in) :: gear
    integer, intent(in) :: n, teeth
    character(32) :: name
    integer :: mesh, beside

    mesh = nint(n/real(teeth, dp))
    beside = n - mesh*teeth
    if (mesh == 0) then
      name = trim(gear)//' '//str(n)
    else if (beside == 0) then
      name = 'mesh '//str(mesh)
    else
      name = 'mesh '//str(mesh)//' '//merge('+', '-', beside > 0)//' '//trim(gear)//' '//str(abs(beside))
    end if
  end function name_of
end module gearsweep_order_tables
