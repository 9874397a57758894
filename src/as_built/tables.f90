!> Tables of the task `as_built`: factors over speeds, gears and assemblies, loads of single pairs of teeth, transmission error and
!> its orders.
!>
!> Peak-to-peak static transmission error and largest root stress are computed on request, with those of gears without deviations
!> for comparison.
module gearsweep_as_built_tables
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_base, only: axis, dp, error_t, fixed, lines_t, no_number, pi, right, sorted, str, table_t, wants_stop
  use gearsweep_gear, only: find_tolerances, pair_t, tolerances_t
  use gearsweep_mesh, only: coast_pitch_position, find_orders, flank_deviations_t, harmonics_t, mesh_t, &
    per_tooth, pitch_position, share_load, sharing_t, static_range, tooth_number, wave_t
  use gearsweep_motion, only: find_spectrum, has_result, length_of, oscillator_t, spectrum_t, sweep_t, turn_t
  use gearsweep_rating, only: flank_contact, surfaces_t
  use gearsweep_study, only: add_seen, known_count, gear_names, of_coast, of_dte_estimate, of_estimate, of_factor, of_motions, &
    of_periods, of_relief, of_speed, of_status, stages_t, status_length, words_of
  use gearsweep_as_built_specimens, only: deviating, follow_turn, specimen_t
  implicit none
  private
  public :: fill_tolerances, fill_points, fill_worst, fill_summary, fill_teeth, fill_loads, fill_turn, fill_orders, &
            fill_waterfall, extremes_t, find_extremes, add_extremes, report_extremes

  real(dp), parameter :: um = 1e-6_dp          ! m

  character(*), parameter :: of_draw = 'which gears, in the order in which they are drawn', &
    of_assembly = 'which assembly: 1 as stated; in each further one the gear''s next tooth to engage meets the '// &
    'pinion''s stated tooth'


  !> Order of pinion or gear.
  type :: order_t
    integer :: gear = 1                          !< 1: pinion, 2: gear
    integer :: number = 0                        !< cycles per revolution of that gear
    real(dp) :: cycles = 0                       !< cycles per revolution of the pinion
    character(32) :: name = ''
  end type order_t

  character(*), parameter :: of_order = 'order: cycles a turn of the pinion'
  character(*), parameter :: of_amplitude = 'half of peak-to-peak of this part of the dynamic transmission error; NaN where '// &
    'there is no answer'

  !> Arrays are allocated if requested. Specimen 0 has no deviations; the assembly index varies faster than the draw.
  type :: extremes_t
    real(dp), allocatable :: ste(:, :)           !< peak-to-peak static transmission error, m; (0:specimen, relief)
    real(dp), allocatable :: amplitude(:, :)     !< amplitude of the harmonic, m; (0:specimen, relief)
    real(dp), allocatable :: stress(:, :, :)     !< largest root stress of pinion and gear, Pa; (0:specimen, relief, gear)
  end type extremes_t

contains

  !> Fills the tolerances of the classes in the case.
  subroutine fill_tolerances(pair, class, table, error)
    type(pair_t), intent(in) :: pair
    integer, intent(in) :: class(2)              ! tolerance classes of pinion and gear; 0: none
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
    call table%over('flank tolerances of ISO 1328-1 by class', error, axis('gear', '', 'which gear', gear_names(gears)), &
                    axis('symbol', '', 'tolerance: single and cumulative pitch, slope, form and total of profile and helix, '// &
                         'run-out', symbols))
    if (allocated(error)) return
    call table%add('tolerance_class', '', 'flank tolerance class', table%along(1, real(class(gears), dp)))
    call table%add('tolerance_um', 'um', 'rounded as the standard does', um*[values])
    call table%add('exact_um', 'um', 'the same before rounding', um*[exact])
  end subroutine fill_tolerances

  !> Fills all operating points.
  subroutine fill_points(amount, nominal, specimens, table, error)
    real(dp), intent(in) :: amount(:)            ! m; (relief)
    type(sweep_t), intent(in) :: nominal
    type(specimen_t), intent(in) :: specimens(:, :)          ! (assembly, draw)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    integer, allocatable :: status(:), periods(:)
    integer :: a, d, r, i, k, m, n

    m = size(specimens, 1)
    n = size(specimens, 2)
    k = size(amount)
    call table%over('dynamic factor of gears as built, over speed, relief, gears and assembly', error, &
                    axis('relief_um', 'um', of_relief, amount), axis('draw', '', of_draw, [(i, i=1, size(specimens, 2))]), &
                    axis('assembly', '', of_assembly, [(i, i=1, size(specimens, 1))]), axis('rpm', '1/min', of_speed, nominal%rpm))
    if (allocated(error)) return
    call table%add('dynamic_factor', '', of_factor, [(((specimens(a, d)%sweep%dynamic_factor(:, r), a=1, m), d=1, n), r=1, k)])
    call table%add('error_estimate', '', of_estimate, [(((specimens(a, d)%sweep%estimate(:, r), a=1, m), d=1, n), r=1, k)])
    status = [(((specimens(a, d)%sweep%status(:, r), a=1, m), d=1, n), r=1, k)]
    call table%add_words('status', of_status, words_of(status))
    call table%add('coast_factor', '', of_coast//'; NaN where there is no answer', &
                   [(((specimens(a, d)%sweep%coast_factor(:, r), a=1, m), d=1, n), r=1, k)])
    call table%add('nominal_factor', '', 'dynamic factor of gears without deviations; NaN where there is no answer', &
                   [(((nominal%dynamic_factor(:, r), a=1, m), d=1, n), r=1, k)])
    call table%add('dte_rms_um', 'um', 'root mean square deviation of the dynamic transmission error from its mean', &
                   [(((specimens(a, d)%sweep%dte_rms(:, r), a=1, m), d=1, n), r=1, k)])
    call table%add('dte_peak_to_peak_um', 'um', 'peak-to-peak dynamic transmission error', &
                   [(((specimens(a, d)%sweep%dte_range(:, r), a=1, m), d=1, n), r=1, k)])
    call table%add('dte_error_estimate_um', 'um', of_dte_estimate, &
                   [(((specimens(a, d)%sweep%dte_estimate(:, r), a=1, m), d=1, n), r=1, k)])
    call table%add('nominal_dte_peak_to_peak_um', 'um', 'the same of gears without deviations', &
                   [(((nominal%dte_range(:, r), a=1, m), d=1, n), r=1, k)])
    periods = specimens(1, 1)%deviations%periods*[(((specimens(a, d)%sweep%periods(:, r), a=1, m), d=1, n), r=1, k)]
    call table%add('mesh_periods', '', of_periods, periods)
    call table%add('multiplier', '', 'largest Floquet modulus over one mesh period, the mean of the turn: above 1 the motion '// &
                   'repels; NaN where it is not known', &
                   [(((specimens(a, d)%sweep%mesh_multiplier(:, r), a=1, m), d=1, n), r=1, k)])
    call table%add('motions', '', of_motions, known_count([(((specimens(a, d)%sweep%motions(:, r), a=1, m), d=1, n), r=1, k)]))
    call add_seen([(((specimens(a, d)%sweep%seen_factor(:, r), a=1, m), d=1, n), r=1, k)], &
                  [(((specimens(a, d)%sweep%seen_dte_rms(:, r), a=1, m), d=1, n), r=1, k)], &
                  [(((specimens(a, d)%sweep%seen_dte_range(:, r), a=1, m), d=1, n), r=1, k)], &
                  [(((specimens(a, d)%sweep%seen_periods(:, r), a=1, m), d=1, n), r=1, k)], table)
  end subroutine fill_points

  !> Fills the largest dynamic factors over the speeds, and the teeth that carry them.
  subroutine fill_worst(teeth, amount, nominal, specimens, table, error)
    integer, intent(in) :: teeth(2)
    real(dp), intent(in) :: amount(:)            ! m; (relief)
    type(sweep_t), intent(in) :: nominal
    type(specimen_t), intent(in) :: specimens(:, :)          ! (assembly, draw)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: values(:, :)
    integer :: a, d, r, i, row

    call table%over('largest dynamic factor over the speeds of gears as built, and the teeth that carry it', error, &
                    axis('relief_um', 'um', of_relief, amount), axis('draw', '', of_draw, [(i, i=1, size(specimens, 2))]), &
                    axis('assembly', '', of_assembly, [(i, i=1, size(specimens, 1))]))
    if (allocated(error)) return
    allocate (values(table%rows, 7), source=no_number())
    row = 0
    do r = 1, size(amount)
      do d = 1, size(specimens, 2)
        do a = 1, size(specimens, 1)
          row = row + 1
          values(row, 1) = largest_factor(nominal, r)
          associate (specimen => specimens(a, d), worst => specimens(a, d)%worst(r))
            values(row, 7) = tooth_number(specimen%flanks(2), teeth(2), specimen%offset)
            if (.not. worst%rpm > 0) cycle
            values(row, 2:3) = [worst%dynamic_factor, worst%rpm]
            if (worst%pair < 0) cycle
            values(row, 4) = tooth_number(specimen%flanks(1), teeth(1), worst%pair)
            values(row, 5) = tooth_number(specimen%flanks(2), teeth(2), worst%pair + specimen%offset)
            values(row, 6) = worst%place
          end associate
        end do
      end do
    end do
    call table%add('dynamic_factor', '', 'largest DF over the speeds; NaN where none has an answer', values(:, 2))
    call table%add('rpm', '1/min', 'speed at which it is', values(:, 3))
    call table%add('nominal_factor', '', 'largest DF over the speeds of gears without deviations', values(:, 1))
    call table%add('pinion_tooth', '', 'number of the pinion''s tooth that carries the largest load; NaN where with '// &
                   '`quick` that motion had to be computed to the tolerance', values(:, 4))
    call table%add('gear_tooth', '', 'number of the gear''s tooth that carries it', values(:, 5))
    call table%add('s', '', 'where it is: path coordinate of this pair, in base pitches from A', values(:, 6))
    call table%add('first_gear_tooth', '', 'number of the gear''s tooth that enters at A with the pinion''s stated tooth at '// &
                   'the time 0', values(:, 7))
  end subroutine fill_worst

  !> Fills, for each relief, the distribution of the largest dynamic factors over all gears and assemblies.
  subroutine fill_summary(amount, nominal, specimens, class, sample_error, table, error)
    real(dp), intent(in) :: amount(:)            ! m; (relief)
    type(sweep_t), intent(in) :: nominal
    type(specimen_t), intent(in) :: specimens(:, :)          ! (assembly, draw)
    integer, intent(in) :: class(2)              ! tolerance classes of pinion and gear; 0: none
    real(dp), intent(in) :: sample_error(:)      ! (relief)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: values(:, :), factor(:), rpm(:)
    real(dp) :: within
    integer :: a, d, i, k, r

    call table%over('largest dynamic factor over the speeds, of all pairs of gears and assemblies', error, &
                    axis('relief_um', 'um', of_relief, amount))
    if (allocated(error)) return
    allocate (values(size(amount), 10), source=no_number())
    do r = 1, size(amount)
      values(r, 1) = largest_factor(nominal, r)
      factor = [((specimens(a, d)%worst(r)%dynamic_factor, a=1, size(specimens, 1)), d=1, size(specimens, 2))]
      rpm = [((specimens(a, d)%worst(r)%rpm, a=1, size(specimens, 1)), d=1, size(specimens, 2))]
      if (.not. any(rpm > 0)) cycle
      do k = 1, 2
        i = merge(maxloc(factor, 1, mask=rpm > 0), minloc(factor, 1, mask=rpm > 0), k == 1)
        if (k == 1) values(r, 6) = rpm(i)
        values(r, 5 + 2*k:6 + 2*k) = [1 + (i - 1)/size(specimens, 1), 1 + modulo(i - 1, size(specimens, 1))]
      end do
      factor = pack(factor, rpm > 0)
      values(r, 2:5) = [minval(factor), quantile(factor, 0.5_dp), quantile(factor, 0.95_dp), maxval(factor)]
    end do
    call table%add('nominal_factor', '', 'largest DF over the speeds of gears without deviations', values(:, 1))
    call table%add('least_factor', '', 'the least of the largest DF over the speeds', values(:, 2))
    call table%add('median_factor', '', 'its median', values(:, 3))
    call table%add('quantile_95_factor', '', 'its 95th percentile', values(:, 4))
    call table%add('largest_factor', '', 'the largest', values(:, 5))
    call table%add('rpm', '1/min', 'speed at which that is', values(:, 6))
    call table%add('worst_draw', '', 'of which gears, in the order in which they are drawn', values(:, 7))
    call table%add('worst_assembly', '', 'of which assembly of these', values(:, 8))
    call table%add('best_draw', '', 'gears with the least', values(:, 9))
    call table%add('best_assembly', '', 'assembly of these with the least', values(:, 10))
    call table%add('sample_error', '', 'with `quick`, by how much the dynamic factors that were computed both ways differ '// &
                   'at most; else NaN, and where there are none', sample_error)
    within = count(specimens(1, :)%is_within)/real(size(specimens, 2), dp)
    if (.not. any(class > 0)) within = no_number()
    call table%add('within_class', '', 'part of the pairs whose drawn gears are within their classes in f_p, F_p, f_Halpha '// &
                   'and F_r; NaN where none is drawn', spread(within, 1, size(amount)))
    call table%add('draws', '', 'pairs of gears that were drawn', spread(size(specimens, 2), 1, size(amount)))
    call table%add('assemblies', '', 'assemblies of each', spread(size(specimens, 1), 1, size(amount)))
  end subroutine fill_summary

  !> Largest dynamic factor over the speeds; NaN if none converged.
  pure real(dp) function largest_factor(sweep, relief)
    type(sweep_t), intent(in) :: sweep
    integer, intent(in) :: relief

    largest_factor = no_number()
    associate (answered => has_result(sweep%status(:, relief)))
      if (any(answered)) largest_factor = maxval(sweep%dynamic_factor(:, relief), mask=answered)
    end associate
  end function largest_factor

  !> Quantile: the value below which this part of the values lies, linear between two of them. Source: Hyndman and Fan 1996, The
  !> American Statistician 50, 361, definition 7.
  pure real(dp) function quantile(values, part)
    real(dp), intent(in) :: values(:), part
    real(dp) :: ascending(size(values)), place
    integer :: i

    ascending = sorted(values)
    place = 1 + part*(size(values) - 1)
    i = int(place)
    quantile = ascending(i) + (place - i)*(ascending(min(i + 1, size(values))) - ascending(i))
  end function quantile

  !> Fills the errors of each tooth of a pair of gears, as stated or drawn.
  subroutine fill_teeth(teeth, flanks, table, error)
    integer, intent(in) :: teeth(2)
    type(flank_deviations_t), intent(in) :: flanks(2)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: values(:, :)
    integer :: i, k, row

    call table%begin('errors of each tooth of the pair of gears that is followed, with the signs of &deviations', sum(teeth), error)
    if (allocated(error)) return
    allocate (values(table%rows, 7), source=0.0_dp)
    row = 0
    do i = 1, 2
      associate (own => flanks(i), new => values(row + 1:row + teeth(i), :))
        new(:, 2) = pitch_position(own, teeth(i))
        new(:, 1) = new(:, 2) - cshift(new(:, 2), -1)
        if (allocated(own%single_pitch)) new(:, 1) = own%single_pitch
        new(:, 7) = coast_pitch_position(own, teeth(i))
        new(:, 3) = per_tooth(own%slope, teeth(i))
        new(:, 4) = per_tooth(own%form, teeth(i))
        if (allocated(own%measured)) new(:, 3:4) = no_number()
        new(:, 5) = own%runout
        new(:, 6) = own%runout_phase
      end associate
      row = row + teeth(i)
    end do
    call table%add_index(axis('gear', '', 'which gear', gear_names([((i, k=1, teeth(i)), i=1, 2)])))
    call table%add_index(axis('tooth', '', 'number of the tooth; teeth of drawn gears are numbered as they engage', &
                              [((k, k=1, teeth(i)), i=1, 2)]))
    call table%add('single_pitch_um', 'um', 'single pitch deviation, without the run-out', values(:, 1))
    call table%add('cumulative_pitch_um', 'um', 'cumulative pitch deviation, without the run-out', values(:, 2))
    call table%add('coast_pitch_um', 'um', 'the same of the coast flanks', values(:, 7))
    call table%add('profile_slope_um', 'um', 'profile slope deviation; NaN where a file has the profile', values(:, 3))
    call table%add('profile_form_um', 'um', 'profile form deviation; NaN where a file has the profile', values(:, 4))
    call table%add('runout_um', 'um', 'run-out of the gear', values(:, 5))
    call table%add('runout_phase_deg', 'deg', 'its phase where the stated tooth enters at A', values(:, 6))
  end subroutine fill_teeth

  !> Fills the largest load of each pair of teeth over the revolution.
  subroutine fill_loads(stages, amount, turns, specimen, table, error)
    type(stages_t), intent(in) :: stages
    real(dp), intent(in) :: amount(:)            ! m; (relief)
    type(turn_t), intent(in) :: turns(:, :)      ! (speed, relief)
    type(specimen_t), intent(in) :: specimen
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: values(:, :), stress(:, :)
    integer :: teeth(2), i, k, n, row

    teeth = stages%motion(1)%mesh%teeth
    call table%begin('largest load of each pair of teeth over the turn, in the order in which the pairs enter at A', &
                     sum([((length_of(turns(k, i)%load), k=1, size(turns, 1)), i=1, size(turns, 2))]), error)
    if (allocated(error)) return
    allocate (values(table%rows, 7), stress(2, table%rows))
    row = 0
    do i = 1, size(turns, 2)
      do k = 1, size(turns, 1)
        do n = 1, length_of(turns(k, i)%load)
          row = row + 1
          values(row, :) = [amount(i), turns(k, i)%rpm, real(n, dp), &
                            real(tooth_number(specimen%flanks(1), teeth(1), n - 1), dp), &
                            real(tooth_number(specimen%flanks(2), teeth(2), n - 1 + specimen%offset), dp), &
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
      call table%add('pressure_mpa', 'MPa', 'largest Hertz pressure on the flanks under that load, where it is; NaN at a tip '// &
                     'corner, which has no radius', [contact%pressure])
    end associate
    do i = 1, 2
      call table%add(trim(gear_names(i))//'_root_stress_mpa', 'MPa', 'largest nominal tooth root stress sigma_F0 of ISO 6336-3 '// &
                     'while this pair passes through the mesh, of the load where it acts', stress(i, :))
    end do
  end subroutine fill_loads

  !> Fills the transmission errors over the revolution: static, then at each speed.
  subroutine fill_turn(osc, amount, turns, table, error)
    type(oscillator_t), intent(in) :: osc(:)     !< (relief)
    real(dp), intent(in) :: amount(:)            !< m; (relief)
    type(turn_t), intent(in) :: turns(:, :)      !< (speed, relief)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    integer, parameter :: samples = 50           ! per mesh period, static
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
    call table%add('pinion_angle_deg', 'deg', 'angle through which the pinion has turned', values(:, 3)*2*pi/osc(1)%mesh%teeth(1))
    call table%add('transmission_error_um', 'um', 'static (rpm 0) or dynamic transmission error along the line of action; 0 '// &
                   'where nominal teeth touch without load', values(:, 4))

  contains

    subroutine put(rpm, tau, value)
      real(dp), intent(in) :: rpm, tau(:), value(:)

      associate (new => values(row + 1:row + size(tau), :))
        new(:, 1) = amount(i)
        new(:, 2) = rpm
        new(:, 3) = tau
        new(:, 4) = value
      end associate
      row = row + size(tau)
    end subroutine put
  end subroutine fill_turn

  !> Fills the orders of the transmission error.
  subroutine fill_orders(osc, amount, turns, mesh_orders, table, error)
    type(oscillator_t), intent(in) :: osc(:)     !< (relief)
    real(dp), intent(in) :: amount(:)            !< m; (relief)
    type(turn_t), intent(in) :: turns(:, :)      !< (speed, relief)
    integer, intent(in) :: mesh_orders
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    type(order_t), allocatable :: orders(:)
    real(dp), allocatable :: values(:, :), at_rest(:, :)
    character(status_length), allocatable :: words(:)      ! (speed)
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
        at_rest = static_orders(osc(i), mesh_orders, orders)
        do k = 1, size(turns, 1)
          associate (new => values(row + 1:row + n, :), turn => turns(k, i))
            new(:, 1) = amount(i)
            new(:, 2) = turn%rpm
            new(:, 3) = orders%cycles
            new(:, 4) = orders%cycles*turn%rpm/60
            if (allocated(turn%left)) new(:, 5:6) = dynamic_orders(turn, teeth, mesh_orders, orders)
            new(:, 7:8) = at_rest
          end associate
          row = row + n
        end do
      end do
      call table%add_index(axis('relief_um', 'um', of_relief, values(:, 1)))
      call table%add_index(axis('rpm', '1/min', of_speed, values(:, 2)))
      call table%add_index(axis('order', '', of_order, values(:, 3)))
      call table%add_words('order_name', 'what it is: mesh, pinion and gear orders, sidebands of mesh orders, and stated waves', &
                           [(orders%name, k=1, size(turns))])
      words = reshape(words_of(turns%point%steady%status), [size(turns)])
      where (.not. reshape(turns%rpm > 0, [size(turns)])) words = 'none'
      call table%add_words('status', 'how this operating point ended, in a word; none: no speed has an answer', &
                           [(spread(words(k), 1, n), k=1, size(turns))])
      call table%add('gear_order', '', 'cycles a turn of the gear', values(:, 3)*teeth(2)/teeth(1))
      call table%add('frequency_hz', 'Hz', 'frequency at this speed', values(:, 4))
      call table%add('dte_amplitude_um', 'um', of_amplitude, values(:, 5))
      call table%add('dte_phase_deg', 'deg', 'its phase at the time 0', values(:, 6))
      call table%add('ste_amplitude_um', 'um', 'the same of the static transmission error', values(:, 7))
      call table%add('ste_phase_deg', 'deg', 'its phase at the time 0', values(:, 8))
    end associate
  end subroutine fill_orders

  !> Fills the amplitudes of the orders over the speed.
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
      moving = dynamic_orders(turns(k), teeth, mesh_orders, orders)
      values(:, k) = moving(:, 1)
    end do
    call table%add('dte_amplitude_um', 'um', of_amplitude, [values])
  end subroutine fill_waterfall

  !> Amplitude (m) and phase (rad) of the orders of a motion; (order, 2).
  pure function dynamic_orders(turn, teeth, mesh_orders, orders) result(values)
    type(turn_t), intent(in) :: turn             ! converged motion
    integer, intent(in) :: teeth(2), mesh_orders
    type(order_t), intent(in) :: orders(:)
    real(dp) :: values(size(orders), 2)
    type(spectrum_t) :: spectrum
    integer :: i

    values = 0
    do i = 1, 2
      if (.not. any(orders%gear == i)) cycle
      call find_spectrum(turn%left, turn%width, turn%error, mesh_orders*teeth(i), spectrum, base=1.0_dp/teeth(i))
      call select_orders(orders, i, size(turn%load), teeth, spectrum%amplitude, spectrum%phase, values)
    end do
  end function dynamic_orders

  !> Amplitude (m) and phase (rad) of the static orders; (order, 2).
  pure function static_orders(osc, mesh_orders, orders) result(values)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: mesh_orders
    type(order_t), intent(in) :: orders(:)
    real(dp) :: values(size(orders), 2)
    type(harmonics_t) :: harmonics(2)
    integer :: i

    values = 0
    associate (teeth => osc%mesh%teeth)
      call find_orders(osc%mesh, osc%load, [(mesh_orders*merge(teeth(i), 0, any(orders%gear == i)), i=1, 2)], 1.0_dp/teeth, &
                       harmonics)
      do i = 1, 2
        call select_orders(orders, i, osc%mesh%deviations%periods, teeth, harmonics(i)%amplitude, harmonics(i)%phase, values)
      end do
    end associate
  end function static_orders

  !> Selects the orders of one gear from its harmonics, those with whole cycles over the motion's period.
  pure subroutine select_orders(orders, gear, periods, teeth, amplitude, phase, values)
    type(order_t), intent(in) :: orders(:)
    integer, intent(in) :: gear, periods, teeth(2)
    real(dp), intent(in) :: amplitude(:), phase(:)         ! (cycles per revolution of the gear)
    real(dp), intent(inout) :: values(:, :)      ! (order, 2)
    integer :: i

    do i = 1, size(orders)
      if (orders(i)%gear /= gear) cycle
      if (modulo(int(orders(i)%number, int64)*periods, int(teeth(gear), int64)) /= 0) cycle
      values(i, :) = [amplitude(orders(i)%number), phase(orders(i)%number)]
    end do
  end subroutine select_orders

  !> Lists the orders of both gears up to so many mesh orders, ascending. An order of both gears is listed for the pinion.
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

  !> Names the orders of stated waves after these.
  pure subroutine name_waves(waves, teeth, orders)
    type(wave_t), intent(in) :: waves(:)
    integer, intent(in) :: teeth(2)
    type(order_t), intent(inout) :: orders(:)
    integer :: i

    do i = 1, size(waves)
      associate (wave => waves(i))
        if (wave%order == 1) cycle               ! run-out
        where (int(orders%number, int64)*teeth(wave%gear) == int(wave%order, int64)*teeth(orders%gear)) &
          orders%name = trim(gear_names(wave%gear))//' wave '//str(wave%order)
      end associate
    end do
  end subroutine name_waves

  !> Name of order n of a gear with so many teeth: an order of the gear, of the mesh, or a sideband of that.
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

  !> Computes the extremes of all specimens. Returns early if the caller stops the run.
  subroutine find_extremes(stages, which, nominal, specimens, with_ste, harmonic, unit_stress, found, error)
    type(stages_t), intent(in) :: stages
    integer, intent(in) :: which(:)              !< reliefs of the case
    type(sweep_t), intent(in) :: nominal
    type(specimen_t), intent(in) :: specimens(:, :)          !< specimens with their sweeps; (assembly, draw)
    logical, intent(in) :: with_ste
    integer, intent(in) :: harmonic              !< mesh harmonic of the static transmission error; 0: not requested
    real(dp), allocatable, intent(in) :: unit_stress(:, :)           !< stresses of `unit_root_stress`; not allocated: not requested
    type(extremes_t), intent(out) :: found
    type(error_t), allocatable, intent(inout) :: error
    type(mesh_t) :: mesh
    integer :: a, d, i, k

    if (with_ste) allocate (found%ste(0:size(specimens), size(which)), source=no_number())
    if (harmonic > 0) allocate (found%amplitude(0:size(specimens), size(which)), source=no_number())
    if (allocated(unit_stress)) allocate (found%stress(0:size(specimens), size(which), 2), source=no_number())
    do i = 1, size(which)
      associate (motion => stages%motion(which(i):which(i)), answered => has_result(nominal%status(:, i)))
        call find_static(motion(1)%mesh, 0)
        if (allocated(unit_stress) .and. any(answered)) &
          call find_stress(motion, nominal%rpm(maxloc(nominal%dynamic_factor(:, i), 1, mask=answered)), nominal, 0)
        k = 0
        do d = 1, size(specimens, 2)
          do a = 1, size(specimens, 1)
            if (allocated(error) .or. wants_stop(stages%accuracy%steady%stop)) return
            k = k + 1
            if (with_ste .or. harmonic > 0) then
              mesh = motion(1)%mesh
              mesh%deviations = specimens(a, d)%deviations
              call find_static(mesh, k)
            end if
            if (.not. allocated(unit_stress)) cycle
            associate (worst => specimens(a, d)%worst(i))
              if (allocated(worst%stress)) then
                found%stress(k, i, :) = worst%stress
              else if (worst%rpm > 0) then
                call find_stress(deviating(motion, specimens(a, d)%deviations, error), worst%rpm, specimens(a, d)%sweep, k)
              end if
            end associate
          end do
        end do
      end associate
    end do

  contains

    !> Computes the static transmission error of one specimen.
    subroutine find_static(mesh, specimen)
      type(mesh_t), intent(in) :: mesh
      integer, intent(in) :: specimen
      type(harmonics_t) :: harmonics(1)

      if (with_ste) found%ste(specimen, i) = static_range(mesh, stages%load)
      if (harmonic == 0) return
      call find_orders(mesh, stages%load, [harmonic], [1.0_dp], harmonics)
      found%amplitude(specimen, i) = harmonics(1)%amplitude(harmonic)
    end subroutine find_static

    !> Computes the largest root stress of one specimen.
    subroutine find_stress(osc, rpm, sweep, specimen)
      type(oscillator_t), intent(in) :: osc(:)   ! one element
      real(dp), intent(in) :: rpm
      type(sweep_t), intent(in) :: sweep         ! sweep of these gears
      integer, intent(in) :: specimen
      type(turn_t) :: turn

      if (allocated(error)) return
      call follow_turn(osc(1), rpm, stages, sweep, i, turn, error, unit_stress)
      if (allocated(turn%stress)) found%stress(specimen, i, :) = maxval(turn%stress, 2)
    end subroutine find_stress
  end subroutine find_extremes

  !> Adds the columns of the extremes to the table over relief, draw and assembly.
  subroutine add_extremes(found, table)
    type(extremes_t), intent(in) :: found
    type(table_t), intent(inout) :: table
    integer :: i

    if (allocated(found%ste)) then
      call table%add('ste_peak_to_peak_um', 'um', 'peak-to-peak static transmission error over the turn', [found%ste(1:, :)])
      call table%add('nominal_ste_peak_to_peak_um', 'um', 'the same of gears without deviations', &
                     [spread(found%ste(0, :), 1, ubound(found%ste, 1))])
    end if
    if (allocated(found%amplitude)) then
      call table%add('ste_harmonic_um', 'um', 'amplitude over the turn of the harmonic of the mesh frequency in the static '// &
                     'transmission error that &as_built ste_harmonic names', [found%amplitude(1:, :)])
      call table%add('nominal_ste_harmonic_um', 'um', 'the same of gears without deviations', &
                     [spread(found%amplitude(0, :), 1, ubound(found%amplitude, 1))])
    end if
    if (.not. allocated(found%stress)) return
    do i = 1, 2
      call table%add(trim(gear_names(i))//'_root_stress_mpa', 'MPa', 'largest nominal tooth root stress sigma_F0 of ISO 6336-3 '// &
                     'over the turn, of the load where it acts, in motion at the speed of the largest DF', &
                     [found%stress(1:, :, i)])
      call table%add('nominal_'//trim(gear_names(i))//'_root_stress_mpa', 'MPa', 'the same of gears without deviations, at the '// &
                     'speed of their largest DF', [spread(found%stress(0, :, i), 1, ubound(found%stress, 1))])
    end do
  end subroutine add_extremes

  !> Reports the extremes: nominal, and their distribution over all gears and assemblies.
  pure subroutine report_extremes(table, lines)
    type(table_t), intent(in) :: table
    type(lines_t), intent(inout) :: lines
    character(*), parameter :: columns(4) = [character(22) :: 'ste_peak_to_peak_um', 'ste_harmonic_um', &
                                             'pinion_root_stress_mpa', 'gear_root_stress_mpa']
    character(*), parameter :: titles(4) = [character(50) :: 'peak-to-peak static transmission error, um', &
                                            'mesh harmonic of the static transmission error, um', &
                                            'root stress of the pinion, MPa', 'root stress of the gear, MPa']
    real(dp), allocatable :: values(:)
    integer :: i, k, specimens, row

    specimens = table%extent(2)*table%extent(3)
    do i = 1, size(columns)
      if (table%position(trim(columns(i))) == 0) cycle
      call lines%add('')
      call lines%add('Gears as built: '//trim(titles(i)))
      call lines%add('   relief um   nominal     least    median      95 %   largest')
      do row = 1, table%rows, specimens
        values = [(table%number(trim(columns(i)), row + k), k=0, specimens - 1)]
        values = pack(values, .not. ieee_is_nan(values))
        call lines%put(right(str(table%number('relief_um', row)), 12)//cell(table%number('nominal_'//trim(columns(i)), row)))
        if (size(values) > 0) call lines%put(cell(minval(values))//cell(quantile(values, 0.5_dp))// &
                                             cell(quantile(values, 0.95_dp))//cell(maxval(values)))
        call lines%add('')
      end do
    end do

  contains

    pure character(10) function cell(number)
      real(dp), intent(in) :: number

      cell = right('none', 10)
      if (.not. ieee_is_nan(number)) cell = right(fixed(number, 2), 10)
    end function cell
  end subroutine report_extremes
end module gearsweep_as_built_tables
