!> The tables of the task `as_built` over speeds, gears and assemblies, and of the loads of single pairs of teeth.
module gearsweep_as_built_tables
  use gearsweep_as_built_machines, only: machine_t
  use gearsweep_decimal, only: in_um
  use gearsweep_error, only: error_t
  use gearsweep_flank, only: flank_contact, surfaces_t
  use gearsweep_flank_deviations, only: flank_deviations_t, of_each, out_of_place, tooth_number
  use gearsweep_kinds, only: dp, pi
  use gearsweep_pair, only: pair_t
  use gearsweep_points, only: of_estimate, of_factor, of_periods, of_relief, of_speed, of_status, words_of
  use gearsweep_stages, only: stages_t
  use gearsweep_sorting, only: sorted
  use gearsweep_status, only: has_result
  use gearsweep_sweep, only: sweep_t
  use gearsweep_table, only: axis, no_number, table_t
  use gearsweep_task, only: members
  use gearsweep_tolerances, only: find_tolerances, tolerances_t
  use gearsweep_turn, only: length_of, turn_t
  implicit none
  private
  public :: fill_tolerances, fill_points, fill_worst, fill_summary, fill_teeth, fill_loads, quantile

  real(dp), parameter :: micro = 1e6_dp

  character(*), parameter :: of_draw = 'which gears, in the order in which they are drawn', &
    of_assembly = 'which assembly: 1 as stated; in each further one the gear''s next tooth to engage meets the '// &
    'pinion''s stated tooth'

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
                         'run-out', symbols))
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
    call table%add('nominal_dte_peak_to_peak_um', 'um', 'the same of gears without deviations', &
                   micro*[(((nominal%dte_range(:, r), a=1, m), d=1, n), r=1, k)])
    periods = machines(1, 1)%deviations%periods*[(((machines(a, d)%sweep%periods(:, r), a=1, m), d=1, n), r=1, k)]
    call table%add('mesh_periods', '', of_periods, periods)
    call table%add('multiplier', '', 'largest Floquet modulus over one mesh period, the mean of the turn: above 1 the motion '// &
                   'repels; NaN where it is not known', &
                   [(((machines(a, d)%sweep%mesh_multiplier(:, r), a=1, m), d=1, n), r=1, k)])
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
          values(row, 1) = largest_factor(nominal, r)
          associate (machine => machines(a, d), worst => machines(a, d)%worst(r))
            values(row, 7) = tooth_number(machine%flanks(2), teeth(2), machine%offset)
            if (.not. worst%rpm > 0) cycle
            values(row, 2:3) = [worst%dynamic_factor, worst%rpm]
            if (worst%pair < 0) cycle
            values(row, 4) = tooth_number(machine%flanks(1), teeth(1), worst%pair)
            values(row, 5) = tooth_number(machine%flanks(2), teeth(2), worst%pair + machine%offset)
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

  !> Of each relief, what the largest dynamic factors of all gears and assemblies are.
  subroutine fill_summary(amount, nominal, machines, sample_error, table, error)
    real(dp), intent(in) :: amount(:)            ! m; (relief)
    type(sweep_t), intent(in) :: nominal
    type(machine_t), intent(in) :: machines(:, :)          ! (assembly, draw)
    real(dp), intent(in) :: sample_error(:)      ! (relief)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: values(:, :), factor(:), rpm(:)
    integer :: a, d, i, k, r

    call table%over('largest dynamic factor over the speeds, of all pairs of gears and assemblies', error, &
                    axis('relief_um', 'um', of_relief, in_um(amount)))
    if (allocated(error)) return
    allocate (values(size(amount), 10), source=no_number())
    do r = 1, size(amount)
      values(r, 1) = largest_factor(nominal, r)
      factor = [((machines(a, d)%worst(r)%dynamic_factor, a=1, size(machines, 1)), d=1, size(machines, 2))]
      rpm = [((machines(a, d)%worst(r)%rpm, a=1, size(machines, 1)), d=1, size(machines, 2))]
      if (.not. any(rpm > 0)) cycle
      do k = 1, 2
        i = merge(maxloc(factor, 1, mask=rpm > 0), minloc(factor, 1, mask=rpm > 0), k == 1)
        if (k == 1) values(r, 6) = rpm(i)
        values(r, 5 + 2*k:6 + 2*k) = [1 + (i - 1)/size(machines, 1), 1 + modulo(i - 1, size(machines, 1))]
      end do
      factor = pack(factor, rpm > 0)
      values(r, 2:5) = [minval(factor), quantile(factor, 0.5_dp), quantile(factor, 0.95_dp), maxval(factor)]
    end do
    call table%add('nominal_factor', '', 'largest DF over the speeds of gears without deviations', values(:, 1))
    call table%add('least_factor', '', 'the least of the largest DF over the speeds', values(:, 2))
    call table%add('median_factor', '', 'its median', values(:, 3))
    call table%add('quantile_95_factor', '', 'what 95 % of them are at most', values(:, 4))
    call table%add('largest_factor', '', 'the largest', values(:, 5))
    call table%add('rpm', '1/min', 'speed at which that is', values(:, 6))
    call table%add('worst_draw', '', 'of which gears, in the order in which they are drawn', values(:, 7))
    call table%add('worst_assembly', '', 'of which assembly of these', values(:, 8))
    call table%add('best_draw', '', 'gears with the least', values(:, 9))
    call table%add('best_assembly', '', 'assembly of these with the least', values(:, 10))
    call table%add('sample_error', '', 'with `quick`, by how much the dynamic factors that were computed both ways differ '// &
                   'at most; else NaN, and where there are none', sample_error)
    call table%add('draws', '', 'pairs of gears that were drawn', spread(size(machines, 2), 1, size(amount)))
    call table%add('assemblies', '', 'assemblies of each', spread(size(machines, 1), 1, size(amount)))
  end subroutine fill_summary

  !> The largest dynamic factor over the speeds; NaN where none has an answer.
  pure real(dp) function largest_factor(sweep, relief)
    type(sweep_t), intent(in) :: sweep
    integer, intent(in) :: relief

    largest_factor = no_number()
    associate (answered => has_result(sweep%status(:, relief)))
      if (any(answered)) largest_factor = maxval(sweep%dynamic_factor(:, relief), mask=answered)
    end associate
  end function largest_factor

  !> The value that this part of the values is below, linear between two of them. Source: Hyndman and Fan 1996, The American
  !> Statistician 50, 361, definition 7.
  pure real(dp) function quantile(values, part)
    real(dp), intent(in) :: values(:), part
    real(dp) :: ascending(size(values)), place
    integer :: i

    ascending = sorted(values)
    place = 1 + part*(size(values) - 1)
    i = int(place)
    quantile = ascending(i) + (place - i)*(ascending(min(i + 1, size(values))) - ascending(i))
  end function quantile

  !> The errors of each tooth of a pair of gears, as they are told or drawn.
  subroutine fill_teeth(teeth, flanks, table, error)
    integer, intent(in) :: teeth(2)
    type(flank_deviations_t), intent(in) :: flanks(2)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: values(:, :)
    integer :: i, k, row

    call table%begin('errors of each tooth of the pair of gears that is followed, with the signs of &deviations', sum(teeth), error)
    if (allocated(error)) return
    allocate (values(table%rows, 6), source=0.0_dp)
    row = 0
    do i = 1, 2
      associate (own => flanks(i), new => values(row + 1:row + teeth(i), :))
        new(:, 2) = out_of_place(own, teeth(i))
        new(:, 1) = new(:, 2) - cshift(new(:, 2), -1)
        if (allocated(own%single_pitch)) new(:, 1) = own%single_pitch
        new(:, 3) = of_each(own%slope, teeth(i))
        new(:, 4) = of_each(own%form, teeth(i))
        if (allocated(own%measured)) new(:, 3:4) = no_number()
        new(:, 5) = own%runout
        new(:, 6) = own%runout_phase*180/pi
      end associate
      row = row + teeth(i)
    end do
    call table%add_index(axis('gear', '', 'which gear', members([((i, k=1, teeth(i)), i=1, 2)])))
    call table%add_index(axis('tooth', '', 'number of the tooth; teeth of drawn gears are numbered as they engage', &
                              [((k, k=1, teeth(i)), i=1, 2)]))
    call table%add('single_pitch_um', 'um', 'single pitch deviation, without the run-out', micro*values(:, 1))
    call table%add('cumulative_pitch_um', 'um', 'cumulative pitch deviation, without the run-out', micro*values(:, 2))
    call table%add('profile_slope_um', 'um', 'profile slope deviation; NaN where a file tells the profile', micro*values(:, 3))
    call table%add('profile_form_um', 'um', 'profile form deviation; NaN where a file tells the profile', micro*values(:, 4))
    call table%add('runout_um', 'um', 'run-out of the gear', micro*values(:, 5))
    call table%add('runout_phase_deg', 'deg', 'its phase where the stated tooth enters at A', values(:, 6))
  end subroutine fill_teeth

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
                     sum([((length_of(turns(k, i)%load), k=1, size(turns, 1)), i=1, size(turns, 2))]), error)
    if (allocated(error)) return
    allocate (values(table%rows, 7), stress(2, table%rows))
    row = 0
    do i = 1, size(turns, 2)
      do k = 1, size(turns, 1)
        do n = 1, length_of(turns(k, i)%load)
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
      call table%add('pressure_mpa', 'MPa', 'largest Hertz pressure on the flanks under that load, where it is; NaN at a tip '// &
                     'corner, which has no radius', contact%pressure/1e6_dp)
    end associate
    do i = 1, 2
      call table%add(trim(members(i))//'_root_stress_mpa', 'MPa', 'largest nominal tooth root stress sigma_F0 of ISO 6336-3 '// &
                     'while this pair passes through the mesh, of the load where it acts', stress(i, :)/1e6_dp)
    end do
  end subroutine fill_loads
end module gearsweep_as_built_tables
