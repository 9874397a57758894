!> The tables of the task `as_built`.
module gearsweep_as_built_tables
  use gearsweep_decimal, only: in_um
  use gearsweep_error, only: error_t
  use gearsweep_flank, only: flank_contact, surfaces_t
  use gearsweep_flank_deviations, only: flank_deviations_t, tooth_number
  use gearsweep_kinds, only: dp, pi
  use gearsweep_pair, only: pair_t
  use gearsweep_points, only: of_estimate, of_factor, of_periods, of_relief, of_speed, of_status, words_of
  use gearsweep_stages, only: stages_t
  use gearsweep_status, only: has_result
  use gearsweep_sweep, only: sweep_t
  use gearsweep_table, only: axis, no_number, table_t
  use gearsweep_task, only: members
  use gearsweep_text, only: str
  use gearsweep_tolerances, only: find_tolerances, tolerances_t
  use gearsweep_turn, only: curve_t, find_amplitudes, turn_t
  implicit none
  private
  public :: machine_t, tooth_t, fill_tolerances, fill_points, fill_worst, fill_summary, fill_loads, fill_turn, fill_orders, &
            fill_waterfall

  real(dp), parameter :: micro = 1e6_dp
  integer, parameter :: name_length = 32

  !> Where a largest load is.
  type :: tooth_t
    real(dp) :: rpm = 0                          !< 0: there is none
    real(dp) :: dynamic_factor = 0
    integer :: pair = -1                         !< number of the pair, from 0; -1: not known
    real(dp) :: place = 0                        !< path coordinate, base pitches
  end type tooth_t

  !> Two gears, put together with certain teeth meeting.
  type :: machine_t
    type(flank_deviations_t) :: flanks(2)
    integer :: turn = 1                          !< mesh periods after which the errors repeat
    integer :: offset = 0                        !< by how many teeth of the gear the assembly is not the stated one
    type(sweep_t) :: sweep
    type(tooth_t), allocatable :: worst(:)       !< (relief)
  end type machine_t

  character(*), parameter :: of_draw = 'which gears, in the order in which they are drawn', &
    of_assembly = 'which assembly: 1 as stated; in each further one the gear''s next tooth to engage meets the '// &
    'pinion''s stated tooth'
  character(*), parameter :: of_order = 'order: cycles a turn of the pinion'

contains

  !> Tolerances of the classes that the case names.
  subroutine fill_tolerances(pair, class, table, error)
    type(pair_t), intent(in) :: pair
    integer, intent(in) :: class(2)              ! of pinion and gear; 0: none
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    character(*), parameter :: symbols(*) = [character(8) :: 'f_p', 'F_p', 'f_Halpha', 'f_falpha', 'F_alpha', 'f_Hbeta', &
                                             'f_fbeta', 'F_beta', 'F_r']
    type(error_t), allocatable :: outside
    type(tolerances_t) :: t
    integer, allocatable :: gears(:)
    real(dp), allocatable :: values(:, :), exact(:, :)
    integer :: i, k

    gears = pack([1, 2], class > 0)
    allocate (values(size(symbols), size(gears)), exact(size(symbols), size(gears)))
    do i = 1, size(gears)
      associate (spec => pair%gear(gears(i))%spec)
        do k = 1, 2
          call find_tolerances(class(gears(i)), spec%teeth, 1e3_dp*spec%module, 1e3_dp*spec%face_width, t, outside, exactly=k == 2)
          exact(:, i) = [t%single_pitch, t%cumulative_pitch, t%profile_slope, t%profile_form, t%profile, t%helix_slope, &
                         t%helix_form, t%helix, t%runout]
          if (k == 1) values(:, i) = exact(:, i)
        end do
      end associate
    end do
    call table%over('flank tolerances of ISO 1328-1 by class', error, axis('gear', '', 'which gear', members(gears)), &
                    axis('symbol', '', 'tolerance: single and cumulative pitch, slope, form and total of profile and helix, '// &
                    'run-out', &
                         symbols))
    if (allocated(error)) return
    call table%add('tolerance_class', '', 'flank tolerance class', table%along(1, real(class(gears), dp)))
    call table%add('tolerance_um', 'um', 'rounded as the standard does', [values])
    call table%add('exact_um', 'um', 'the same before rounding', [exact])
  end subroutine fill_tolerances

  !> All operating points.
  subroutine fill_points(amount, nominal, machines, table, error)
    real(dp), intent(in) :: amount(:)            ! m; (relief)
    type(sweep_t), intent(in) :: nominal
    type(machine_t), intent(in) :: machines(:, :)          ! (assembly, draw)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    integer, allocatable :: status(:), periods(:)
    integer :: a, d, r, i, k, m, n

    m = size(machines, 1)
    n = size(machines, 2)
    k = size(amount)
    call table%over('dynamic factor of gears as built, over speed, relief, gears and assembly', error, &
                    axis('relief_um', 'um', of_relief, in_um(amount)), axis('draw', '', of_draw, [(i, i=1, size(machines, 2))]), &
                    axis('assembly', '', of_assembly, [(i, i=1, size(machines, 1))]), axis('rpm', '1/min', of_speed, nominal%rpm))
    if (allocated(error)) return
    call table%add('dynamic_factor', '', of_factor, [(((machines(a, d)%sweep%dynamic_factor(:, r), a=1, m), d=1, n), r=1, k)])
    call table%add('error_estimate', '', of_estimate, [(((machines(a, d)%sweep%estimate(:, r), a=1, m), d=1, n), r=1, k)])
    status = [(((machines(a, d)%sweep%status(:, r), a=1, m), d=1, n), r=1, k)]
    call table%add_words('status', of_status, words_of(status))
    call table%add('nominal_factor', '', 'dynamic factor of gears without deviations; NaN where there is no answer', &
                   [(((nominal%dynamic_factor(:, r), a=1, m), d=1, n), r=1, k)])
    call table%add('dte_rms_um', 'um', 'root mean square of what the dynamic transmission error differs from its mean', &
                   micro*[(((machines(a, d)%sweep%dte_rms(:, r), a=1, m), d=1, n), r=1, k)])
    call table%add('dte_peak_to_peak_um', 'um', 'largest less least dynamic transmission error', &
                   micro*[(((machines(a, d)%sweep%dte_range(:, r), a=1, m), d=1, n), r=1, k)])
    periods = machines(1, 1)%turn*[(((machines(a, d)%sweep%periods(:, r), a=1, m), d=1, n), r=1, k)]
    call table%add('mesh_periods', '', of_periods, periods)
    call table%add('multiplier', '', 'largest Floquet modulus over one mesh period, the mean of the turn: above 1 the motion '// &
                   'repels', [(((machines(a, d)%sweep%mesh_multiplier(:, r), a=1, m), d=1, n), r=1, k)])
  end subroutine fill_points

  !> The largest dynamic factors over the speeds, and which teeth carry them.
  subroutine fill_worst(teeth, amount, nominal, machines, table, error)
    integer, intent(in) :: teeth(2)
    real(dp), intent(in) :: amount(:)            ! m; (relief)
    type(sweep_t), intent(in) :: nominal
    type(machine_t), intent(in) :: machines(:, :)          ! (assembly, draw)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: values(:, :)
    integer :: a, d, r, i, row

    call table%over('largest dynamic factor over the speeds of gears as built, and the teeth that carry it', error, &
                    axis('relief_um', 'um', of_relief, in_um(amount)), axis('draw', '', of_draw, [(i, i=1, size(machines, 2))]), &
                    axis('assembly', '', of_assembly, [(i, i=1, size(machines, 1))]))
    if (allocated(error)) return
    allocate (values(table%rows, 7), source=no_number())
    row = 0
    do r = 1, size(amount)
      do d = 1, size(machines, 2)
        do a = 1, size(machines, 1)
          row = row + 1
          if (any(has_result(nominal%status(:, r)))) &
            values(row, 1) = maxval(nominal%dynamic_factor(:, r), mask=has_result(nominal%status(:, r)))
          associate (machine => machines(a, d), worst => machines(a, d)%worst(r))
            if (.not. worst%rpm > 0) cycle
            values(row, 2:3) = [worst%dynamic_factor, worst%rpm]
            if (worst%pair < 0) cycle
            values(row, 4) = tooth_number(machine%flanks(1), teeth(1), worst%pair)
            values(row, 5) = tooth_number(machine%flanks(2), teeth(2), worst%pair + machine%offset)
            values(row, 6) = worst%place
            values(row, 7) = tooth_number(machine%flanks(2), teeth(2), machine%offset)
          end associate
        end do
      end do
    end do
    call table%add('dynamic_factor', '', 'largest DF over the speeds; NaN where none has an answer', values(:, 2))
    call table%add('rpm', '1/min', 'speed at which it is', values(:, 3))
    call table%add('nominal_factor', '', 'largest DF over the speeds of gears without deviations', values(:, 1))
    call table%add('pinion_tooth', '', 'number of the pinion''s tooth that carries the largest load', values(:, 4))
    call table%add('gear_tooth', '', 'number of the gear''s tooth that carries it', values(:, 5))
    call table%add('s', '', 'where it is: path coordinate of this pair, in base pitches from A', values(:, 6))
    call table%add('first_gear_tooth', '', 'number of the gear''s tooth that enters at A with the pinion''s stated tooth at '// &
      'the '// &
                   'time 0', values(:, 7))
  end subroutine fill_worst

  !> Of each relief, what the largest dynamic factors of all gears and assemblies are.
  subroutine fill_summary(amount, nominal, machines, table, error)
    real(dp), intent(in) :: amount(:)            ! m; (relief)
    type(sweep_t), intent(in) :: nominal
    type(machine_t), intent(in) :: machines(:, :)          ! (assembly, draw)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: values(:, :), factor(:), rpm(:)
    integer :: a, d, r

    call table%over('largest dynamic factor over the speeds, of all pairs of gears and assemblies', error, &
                    axis('relief_um', 'um', of_relief, in_um(amount)))
    if (allocated(error)) return
    allocate (values(size(amount), 6), source=no_number())
    do r = 1, size(amount)
      if (any(has_result(nominal%status(:, r)))) &
        values(r, 1) = maxval(nominal%dynamic_factor(:, r), mask=has_result(nominal%status(:, r)))
      factor = [((machines(a, d)%worst(r)%dynamic_factor, a=1, size(machines, 1)), d=1, size(machines, 2))]
      rpm = [((machines(a, d)%worst(r)%rpm, a=1, size(machines, 1)), d=1, size(machines, 2))]
      if (.not. any(rpm > 0)) cycle
      values(r, 6) = rpm(maxloc(factor, 1, mask=rpm > 0))
      factor = pack(factor, rpm > 0)
      values(r, 2:5) = [minval(factor), quantile(factor, 0.5_dp), quantile(factor, 0.95_dp), maxval(factor)]
    end do
    call table%add('nominal_factor', '', 'largest DF over the speeds of gears without deviations', values(:, 1))
    call table%add('least_factor', '', 'the least of the largest DF over the speeds', values(:, 2))
    call table%add('median_factor', '', 'its median', values(:, 3))
    call table%add('quantile_95_factor', '', 'what 95 % of them are at most', values(:, 4))
    call table%add('largest_factor', '', 'the largest', values(:, 5))
    call table%add('rpm', '1/min', 'speed at which that is', values(:, 6))
    call table%add('draws', '', 'pairs of gears that were drawn', spread(size(machines, 2), 1, size(amount)))
    call table%add('assemblies', '', 'assemblies of each', spread(size(machines, 1), 1, size(amount)))
  end subroutine fill_summary

  !> The value that this part of the values is below, linear between two of them. Source: Hyndman and Fan 1996, The American
  !> Statistician 50, 361, definition 7.
  pure real(dp) function quantile(values, part)
    real(dp), intent(in) :: values(:), part
    real(dp) :: sorted(size(values)), place
    integer :: i, k

    sorted = values
    do i = 2, size(sorted)
      do k = i, 2, -1
        if (sorted(k) >= sorted(k - 1)) exit
        sorted(k - 1:k) = sorted([k, k - 1])
      end do
    end do
    place = 1 + part*(size(sorted) - 1)
    i = min(int(place), size(sorted) - 1)
    quantile = sorted(size(sorted))
    if (i > 0) quantile = sorted(i) + (place - i)*(sorted(i + 1) - sorted(i))
  end function quantile

  !> The largest load of each pair of teeth over the turn.
  subroutine fill_loads(stages, amount, turns, machine, table, error)
    type(stages_t), intent(in) :: stages
    real(dp), intent(in) :: amount(:)            ! m; (relief)
    type(turn_t), intent(in) :: turns(:, :)      ! (speed, relief)
    type(machine_t), intent(in) :: machine
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: values(:, :), stress(:, :)
    integer :: teeth(2), i, k, n, row

    teeth = stages%motion(1)%mesh%teeth
    call table%begin('largest load of each pair of teeth over the turn, in the order in which the pairs enter at A', &
                     sum([((pairs_in(turns(k, i)), k=1, size(turns, 1)), i=1, size(turns, 2))]), error)
    if (allocated(error)) return
    allocate (values(table%rows, 7), stress(2, table%rows))
    row = 0
    do i = 1, size(turns, 2)
      do k = 1, size(turns, 1)
        do n = 1, pairs_in(turns(k, i))
          row = row + 1
          values(row, :) = [in_um(amount(i)), turns(k, i)%rpm, real(n, dp), &
                            real(tooth_number(machine%flanks(1), teeth(1), n - 1), dp), &
                            real(tooth_number(machine%flanks(2), teeth(2), n - 1 + machine%offset), dp), &
                            turns(k, i)%load(n), turns(k, i)%place(n)]
          if (allocated(turns(k, i)%stress)) stress(:, row) = turns(k, i)%stress(:, n)
        end do
      end do
    end do
    call table%add_index(axis('relief_um', 'um', of_relief, values(:, 1)))
    call table%add_index(axis('rpm', '1/min', of_speed, values(:, 2)))
    call table%add_index(axis('pair', '', 'which pair, from 1; it enters at A at the time pair - 1, in mesh periods', &
                              nint(values(:, 3))))
    call table%add('pinion_tooth', '', 'number of the pinion''s tooth', nint(values(:, 4)))
    call table%add('gear_tooth', '', 'number of the gear''s tooth', nint(values(:, 5)))
    call table%add('load_n', 'N', 'largest load on this pair', values(:, 6))
    call table%add('load_ratio', '', 'the same over the static load', values(:, 6)/stages%load)
    call table%add('s', '', 'where that load is: path coordinate of the pair, in base pitches from A', values(:, 7))
    if (.not. allocated(stages%pair)) return
    associate (contact => flank_contact(stages%pair, surfaces_t(material=stages%material), 0.0_dp, values(:, 2)*2*pi/60, &
                                        values(:, 7), values(:, 6)))
      call table%add('pressure_mpa', 'MPa', 'largest Hertz pressure on the flanks under that load; NaN at a tip corner, which '// &
                     'has no radius', contact%pressure/1e6_dp)
    end associate
    do i = 1, 2
      call table%add(trim(members(i))//'_root_stress_mpa', 'MPa', 'largest nominal tooth root stress sigma_F0 of ISO 6336-3 '// &
                     'while this pair passes through the mesh, of the load where it acts', stress(i, :)/1e6_dp)
    end do
  end subroutine fill_loads

  pure integer function pairs_in(turn)
    type(turn_t), intent(in) :: turn

    pairs_in = 0
    if (allocated(turn%load)) pairs_in = size(turn%load)
  end function pairs_in

  !> Transmission errors over the turn: at rest, then at each speed.
  subroutine fill_turn(teeth, amount, turns, static, table, error)
    integer, intent(in) :: teeth(2)
    real(dp), intent(in) :: amount(:)            ! m; (relief)
    type(turn_t), intent(in) :: turns(:, :)      ! (speed, relief)
    type(curve_t), intent(in) :: static(:)       ! (relief)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: values(:, :)
    integer :: i, k, row, rows

    rows = 0
    do i = 1, size(amount)
      rows = rows + rows_of(static(i)) + sum([(rows_of(turns(k, i)%error), k=1, size(turns, 1))])
    end do
    call table%begin('transmission error along the line of action over the turn, at rest (rpm 0) and in motion', rows, error)
    if (allocated(error)) return
    allocate (values(rows, 4))
    row = 0
    do i = 1, size(amount)
      call put(static(i), 0.0_dp)
      do k = 1, size(turns, 1)
        call put(turns(k, i)%error, turns(k, i)%rpm)
      end do
    end do
    call table%add_index(axis('relief_um', 'um', of_relief, values(:, 1)))
    call table%add_index(axis('rpm', '1/min', 'speed of the pinion; 0: at rest', values(:, 2)))
    call table%add_index(axis('tau', '', 'time in mesh periods since the stated teeth entered at A', values(:, 3)))
    call table%add('pinion_angle_deg', 'deg', 'angle through which the pinion has turned', values(:, 3)*360/teeth(1))
    call table%add('transmission_error_um', 'um', 'static (rpm 0) or dynamic transmission error along the line of action; 0 '// &
      'where '// &
                   'nominal teeth touch without load', micro*values(:, 4))

  contains

    !> Two nodes of eight.
    subroutine put(curve, rpm)
      type(curve_t), intent(in) :: curve
      real(dp), intent(in) :: rpm
      integer :: n

      do n = 1, rows_of(curve)
        row = row + 1
        values(row, :) = [in_um(amount(i)), rpm, curve%tau(4*n - 3), curve%value(4*n - 3)]
      end do
    end subroutine put
  end subroutine fill_turn

  pure integer function rows_of(curve)
    type(curve_t), intent(in) :: curve

    rows_of = 0
    if (allocated(curve%tau)) rows_of = size(curve%tau)/4
  end function rows_of

  !> Orders of the transmission error.
  subroutine fill_orders(teeth, amount, turns, static, mesh_orders, table, error)
    integer, intent(in) :: teeth(2)
    real(dp), intent(in) :: amount(:)            ! m; (relief)
    type(turn_t), intent(in) :: turns(:, :)      ! (speed, relief)
    type(curve_t), intent(in) :: static(:)       ! (relief)
    integer, intent(in) :: mesh_orders
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: order(:), values(:, :)
    character(name_length), allocatable :: name(:), names(:)
    complex(dp), allocatable :: at_rest(:), moving(:)
    integer :: i, k, n, row

    call list_orders(teeth, mesh_orders, order, name)
    n = size(order)
    call table%begin('orders of the transmission error over the turn: each part is amplitude cos(2 pi order t + phase) over '// &
      'turns '// &
                     't of the pinion', n*size(turns), error)
    if (allocated(error)) return
    allocate (values(table%rows, 8), source=no_number())
    allocate (names(table%rows))
    row = 0
    do i = 1, size(amount)
      call find_orders(static(i), teeth, mesh_orders, at_rest)
      do k = 1, size(turns, 1)
        associate (rows => values(row + 1:row + n, :))
          rows(:, 1) = in_um(amount(i))
          rows(:, 2) = turns(k, i)%rpm
          rows(:, 3) = order
          rows(:, 4) = order*turns(k, i)%rpm/60
          if (allocated(turns(k, i)%error%tau)) then
            call find_orders(turns(k, i)%error, teeth, mesh_orders, moving)
            rows(:, 5) = micro*abs(moving)
            rows(:, 6) = phase_of(moving)
          end if
          rows(:, 7) = micro*abs(at_rest)
          rows(:, 8) = phase_of(at_rest)
        end associate
        names(row + 1:row + n) = name
        row = row + n
      end do
    end do
    call table%add_index(axis('relief_um', 'um', of_relief, values(:, 1)))
    call table%add_index(axis('rpm', '1/min', of_speed, values(:, 2)))
    call table%add_index(axis('order', '', of_order, values(:, 3)))
    call table%add_words('order_name', 'what it is: mesh, pinion and gear orders, and sidebands of mesh orders', names)
    call table%add('gear_order', '', 'cycles a turn of the gear', values(:, 3)*teeth(2)/teeth(1))
    call table%add('frequency_hz', 'Hz', 'frequency at this speed', values(:, 4))
    call table%add('dte_amplitude_um', 'um', 'half of peak-to-peak of this part of the dynamic transmission error; NaN where '// &
      'there '// &
                   'is no answer', values(:, 5))
    call table%add('dte_phase_deg', 'deg', 'its phase at the time 0', values(:, 6))
    call table%add('ste_amplitude_um', 'um', 'the same of the static transmission error', values(:, 7))
    call table%add('ste_phase_deg', 'deg', 'its phase at the time 0', values(:, 8))
  end subroutine fill_orders

  elemental real(dp) function phase_of(amplitude)
    complex(dp), intent(in) :: amplitude

    phase_of = atan2(aimag(amplitude), real(amplitude, dp))*180/pi
  end function phase_of

  !> Amplitudes of the orders over the speed.
  subroutine fill_waterfall(teeth, turns, mesh_orders, table, error)
    integer, intent(in) :: teeth(2)
    type(turn_t), intent(in) :: turns(:)         ! (speed)
    integer, intent(in) :: mesh_orders
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: order(:), values(:, :)
    character(name_length), allocatable :: name(:)
    complex(dp), allocatable :: amplitude(:)
    integer :: k

    call list_orders(teeth, mesh_orders, order, name)
    call table%over('orders of the dynamic transmission error over the '// &
      'speed', error, axis('rpm', '1/min', of_speed, [(turns(k)%rpm, k=1, size(turns))]), &
                    axis('order', '', of_order, order))
    if (allocated(error)) return
    allocate (values(size(order), size(turns)), source=no_number())
    do k = 1, size(turns)
      if (.not. allocated(turns(k)%error%tau)) cycle
      call find_orders(turns(k)%error, teeth, mesh_orders, amplitude)
      values(:, k) = micro*abs(amplitude)
    end do
    call table%add('dte_amplitude_um', 'um', 'half of peak-to-peak of this part of the dynamic transmission error; NaN where '// &
      'there '// &
                   'is no answer', [values])
  end subroutine fill_waterfall

  !> The orders of both gears up to so many mesh orders, as cycles a turn of the pinion, ascending, with their names.
  pure subroutine list_orders(teeth, mesh_orders, order, name)
    integer, intent(in) :: teeth(2), mesh_orders
    real(dp), allocatable, intent(out) :: order(:)
    character(name_length), allocatable, intent(out) :: name(:)
    integer :: a, b, n, last

    last = mesh_orders*(teeth(1) + teeth(2))
    allocate (order(last), name(last))
    n = 0
    a = 1
    b = 1
    do while (a <= mesh_orders*teeth(1) .or. b <= mesh_orders*teeth(2))
      n = n + 1
      if (a*teeth(2) <= b*teeth(1)) then
        order(n) = a
        name(n) = name_of(merge('shaft ', 'pinion', teeth(1) == teeth(2)), a, teeth(1))
        if (a*teeth(2) == b*teeth(1)) b = b + 1
        a = a + 1
      else
        order(n) = b*teeth(1)/real(teeth(2), dp)
        name(n) = name_of('gear', b, teeth(2))
        b = b + 1
      end if
    end do
    order = order(:n)
    name = name(:n)
  end subroutine list_orders

  !> The amplitudes of these orders (m).
  pure subroutine find_orders(curve, teeth, mesh_orders, amplitude)
    type(curve_t), intent(in) :: curve
    integer, intent(in) :: teeth(2), mesh_orders
    complex(dp), allocatable, intent(out) :: amplitude(:)
    complex(dp) :: pinion(mesh_orders*teeth(1)), gear(mesh_orders*teeth(2))
    integer :: a, b, n

    call find_amplitudes(curve, 1.0_dp/teeth(1), pinion)
    call find_amplitudes(curve, 1.0_dp/teeth(2), gear)
    allocate (amplitude(size(pinion) + size(gear)))
    n = 0
    a = 1
    b = 1
    do while (a <= size(pinion) .or. b <= size(gear))
      n = n + 1
      if (a*teeth(2) <= b*teeth(1)) then
        amplitude(n) = pinion(a)
        if (a*teeth(2) == b*teeth(1)) b = b + 1
        a = a + 1
      else
        amplitude(n) = gear(b)
        b = b + 1
      end if
    end do
    amplitude = amplitude(:n)
  end subroutine find_orders

  !> Order n of a gear with so many teeth: an order of its own, of the mesh, or a sideband of that.
  pure function name_of(gear, n, teeth) result(name)
    character(*), intent(in) :: gear
    integer, intent(in) :: n, teeth
    character(name_length) :: name
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
end module gearsweep_as_built_tables
