!> Which motion is found where pairs part: known ones from elsewhere, the same at every tolerance, speed by speed as in
!> batches, and the words for what is none.
module test_motion_selection
  use gearsweep_motion_resolution, only: resolution_t
  use gearsweep_motion_contact_set, only: period_t
  use gearsweep_base_error, only: error_t
  use gearsweep_motion_error_estimate, only: accuracy_t, point_t
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_motion_oscillator, only: make_oscillator, mesh_period, oscillator_t
  use gearsweep_motion_period, only: run_period
  use gearsweep_motion_periodic_orbit, only: is_bounded
  use gearsweep_motion_period_map, only: discretise, period_map_t, set_durations
  use gearsweep_motion_steady_motion, only: has_result, status_marginal, status_name, status_ok, status_subharmonic, &
            status_unbounded
  use gearsweep_motion_sweep, only: each, run_sweep, sweep_options_t, sweep_t, up
  use gearsweep_base_text, only: str
  use gearsweep_motion_steady_motion, only: by_marching
  use test_support_random_numbers, only: random_t
  use test_support_reference_rows, only: oscillator_of, prescribed, row_of, row_t
  use test_support_solve_one_point, only: solve
  use test_support_testing, only: tally_t, check_close, check_equal, check_no_error, check_true
  implicit none
  private
  public :: run

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('known_motions')) call known_motions(t)
    if (t%wants('shortest_period')) call shortest_period(t)
    if (t%wants('bouncing')) call bouncing(t)
    if (t%wants('any_tolerance')) call any_tolerance(t)
    if (t%wants('batches')) call batches(t)
    if (t%wants('lost_branches')) call lost_branches(t)
    if (t%wants('unbounded')) call unbounded(t)
  end subroutine run

  !> Two equal gears of 1 kg under 3000 N, pairs of 300 N/um all along the path, without relief.
  type(oscillator_t) function mesh_of(ratio, zeta, backlash) result(osc)
    real(dp), intent(in) :: ratio, zeta
    real(dp), intent(in), optional :: backlash   ! m
    type(error_t), allocatable :: error

    call prescribed(ratio, [300.0_dp], [0.0_dp, 0.0_dp], 1, osc)
    osc%mesh%teeth = 25
    osc%mass = 1
    osc%load = 3000
    osc%damping_ratio = zeta
    osc%has_backlash = present(backlash)
    if (present(backlash)) osc%backlash = backlash
    call make_oscillator(osc, error)
    if (allocated(error)) error stop 'test mesh'
  end function mesh_of

  !> Speed at which the mesh frequency is so many times the natural one, 1/min.
  real(dp) function speed_at(osc, ratio)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: ratio

    speed_at = mesh_period(osc%mesh%teeth(1), 2*pi/(ratio*osc%natural_frequency))
  end function speed_at

  !> Values by tools/reference/make_light.py, in closed form between the changes of contact.
  subroutine known_motions(t)
    type(tally_t), intent(inout) :: t
    type(accuracy_t) :: options
    type(point_t) :: point
    type(oscillator_t) :: osc
    integer :: k

    options%steady%tolerance = 1e-9_dp
    call solve(mesh_of(1.6_dp, 1e-3_dp), 8000.0_dp, options, point)
    call check_equal(t, 'little damping', status_name(point%steady%status), 'ok')
    call check_close(t, 'its dynamic factor', point%dynamic_factor, 1.0172745066539_dp, absolute=1e-8_dp)
    call check_close(t, 'its multiplier', point%steady%multiplier, 0.991039102_dp, absolute=1e-7_dp)
    call solve(mesh_of(1.6_dp, 0.0_dp), 8000.0_dp, options, point)
    call check_equal(t, 'no damping', point%steady%status, status_marginal)
    call check_close(t, 'dynamic factor of the neutral motion', point%dynamic_factor, 1.0172048534605_dp, absolute=1e-8_dp)
    osc = mesh_of(1.6_dp, 0.01_dp)
    do k = 4, 8
      options%steady%tolerance = 0.1_dp**k
      call solve(osc, speed_at(osc, 0.5_dp), options, point)
      call check_equal(t, 'the one motion that attracts, tolerance 1e-'//str(k), status_name(point%steady%status), 'ok')
      call check_close(t, 'its dynamic factor', point%dynamic_factor, 3.232340375_dp, absolute=max(0.1_dp**k, 1e-8_dp))
    end do
  end subroutine known_motions

  !> Motions with little damping that several starts are needed for, with the mesh periods after which they repeat. Rows and values
  !> by tools/reference/motions/motions.cpp, which was given the states found here; the motions found are the same where the
  !> damping differs in its 13th digit.
  subroutine shortest_period(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: rows(5) = [character(130) :: &
      '4106 25 40 20 1.4195 0.7097 3 300 37.7 29.2 0 0 2.355 0.474 9864 0.000157 0 -1 0 0 2 2514.0', &
      '6815 25 40 20 1.5683 0.7842 1 300 0 0 0 0 0.644 1.109 2351 0.000109 0 -1 2.11 2.11 1 3008.92', &
      '60 25 40 20 2.7333 1.3666 3 300 -7.8 -29.2 0 0 0.328 1.941 7504 0.000284 0 7.88 0 0 1 2913.78', &
      '305 25 40 20 2.8397 1.4199 1 300 0 0 0 0 1.176 0.569 3779 0.000356 0 -1 0 0 2 4448.37', &
      '933 25 40 20 1.191 0.5955 1 300 0 0 0 0 0.379 0.552 7437 0.00119 0 6.08 0 0 1 2528.49']
    integer, parameter :: periods(5) = [2, 1, 6, 1, 3]
    real(dp), parameter :: dynamic_factor(5) = [1.719573528534_dp, 3.224568907546_dp, 1.308221879616_dp, 4.153859354404_dp, &
                                                2.562521255580_dp]
    type(row_t) :: row
    type(oscillator_t) :: osc
    type(accuracy_t) :: options
    type(point_t) :: point
    integer :: i

    do i = 1, size(rows)
      row = row_of(rows(i))
      call oscillator_of(row, osc)
      call solve(osc, row%rpm, options, point)
      call check_equal(t, 'mesh periods, row '//str(row%id), point%steady%periods, periods(i))
      call check_equal(t, 'status', point%steady%status, merge(status_ok, status_subharmonic, periods(i) == 1))
      call check_close(t, 'dynamic factor', point%dynamic_factor, dynamic_factor(i), absolute=2*point%estimate)
    end do
  end subroutine shortest_period

  !> The impact oscillator: two pairs always, of constant stiffness, so that all flanks part and meet as a ball does that bounces on
  !> a damped spring. The flight is a parabola, the contact a damped oscillation; where it ends is a transcendental equation of one
  !> unknown. Under next to no load an impact leaves exp(-pi zeta/sqrt(1 - zeta^2)) of the speed; without damping every
  !> bounce repeats, here with the mesh.
  subroutine bouncing(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: zeta(4) = [0.0_dp, 1e-3_dp, 0.03_dp, 0.17_dp], drop(3) = [4.0_dp, 50.0_dp, 1e4_dp]
    type(oscillator_t) :: osc
    type(period_map_t) :: map
    type(period_t) :: run
    real(dp) :: pull, omega, rest, into, out, touching, highest, flight, duration, state(2)
    character(:), allocatable :: name
    integer :: i, k

    do i = 1, size(zeta)
      osc = mesh_of(2.0_dp, zeta(i))
      pull = osc%load*sum(1/osc%mass)
      omega = osc%natural_frequency
      rest = pull/omega**2
      do k = 1, size(drop)
        name = ', zeta '//str(zeta(i))//', from '//str(drop(k))//' static deflections'
        into = sqrt(2*pull*drop(k)*rest)
        call impact(omega, zeta(i), rest, into, touching, out, highest)
        ! To the top of the flight behind the impact.
        duration = into/pull + touching - out/pull
        call discretise(osc, resolution_t(60*omega*duration), map)
        call set_durations(map, [duration])
        call run_period(map, [-drop(k)*rest, 0.0_dp], run)
        flight = -out**2/(2*pull)
        state = [run%state(1), run%state(2)/duration]
        call check_close(t, 'top of the flight'//name, state(1), flight, 1e-8_dp)
        call check_close(t, 'at rest there'//name, state(2), 0.0_dp, absolute=1e-8_dp*into)
        call check_close(t, 'largest load'//name, run%peak, 300e6_dp*highest, 1e-8_dp)
        call check_true(t, 'all flanks part'//name, run%lost)
        if (k == size(drop)) call check_close(t, 'what an impact leaves'//name, sqrt(state(2)**2 - 2*pull*state(1))/into, &
                                              exp(-pi*zeta(i)/sqrt(1 - zeta(i)**2)), absolute=2/sqrt(drop(k)))
        if (i == 1) call check_close(t, 'repeats'//name, state(1), -drop(k)*rest, 1e-8_dp)
      end do
    end do
  end subroutine bouncing

  !> A mass that meets its spring at a speed: how long it touches, at which speed it leaves, and how far it went in.
  pure subroutine impact(omega, zeta, rest, into, touching, out, highest)
    real(dp), intent(in) :: omega, zeta, rest, into
    real(dp), intent(out) :: touching, out, highest
    real(dp) :: turn, low, high
    integer :: i

    turn = omega*sqrt(1 - zeta**2)
    ! It goes in until its speed is 0 for the first time, and is back within half a cycle more.
    low = atan2(into*turn, zeta*omega*into - omega**2*rest)/turn
    highest = place(low)
    high = low + pi/turn
    do i = 1, 200
      if (place((low + high)/2) > 0) then
        low = (low + high)/2
      else
        high = (low + high)/2
      end if
    end do
    touching = low
    out = speed(low)

  contains

    pure real(dp) function place(time)
      real(dp), intent(in) :: time

      place = rest + exp(-zeta*omega*time)*(-rest*cos(turn*time) + (into - zeta*omega*rest)/turn*sin(turn*time))
    end function place

    pure real(dp) function speed(time)
      real(dp), intent(in) :: time

      speed = exp(-zeta*omega*time)*(into*cos(turn*time) + (omega**2*rest - zeta*omega*into)/turn*sin(turn*time))
    end function speed
  end subroutine impact

  !> The tolerance decides how exact a motion is, not which it is.
  subroutine any_tolerance(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: points = 60
    type(random_t) :: random
    type(oscillator_t) :: osc
    type(accuracy_t) :: options
    type(point_t) :: point(3)
    real(dp) :: rpm
    integer :: i, k, parted

    random%seed = 14
    parted = 0
    do i = 1, points
      osc = mesh_of(random%between(1.05_dp, 2.9_dp), random%power(1e-3_dp, 3e-2_dp))
      rpm = speed_at(osc, random%power(0.1_dp, 1.1_dp))
      do k = 1, 3
        options%steady%tolerance = 0.01_dp**(k + 1)
        call solve(osc, rpm, options, point(k))
      end do
      if (point(3)%steady%partial .and. has_result(point(3)%steady%status)) parted = parted + 1
      do k = 1, 2
        call check_equal(t, 'status, point '//str(i), status_name(point(k)%steady%status), status_name(point(3)%steady%status))
        if (.not. has_result(point(k)%steady%status)) cycle
        call check_close(t, 'dynamic factor, point '//str(i), point(k)%dynamic_factor, point(3)%dynamic_factor, &
                         absolute=2*(point(k)%estimate + point(3)%estimate))
      end do
    end do
    call check_true(t, 'many with parted pairs', parted > points/4, str(parted))
  end subroutine any_tolerance

  !> A speed among others has the motion that it has alone.
  subroutine batches(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: speeds = 60
    type(oscillator_t) :: osc
    type(sweep_options_t) :: options
    type(sweep_t) :: sweep
    type(point_t) :: point
    type(error_t), allocatable :: error
    real(dp), parameter :: zeta(3) = [0.1_dp, 0.03_dp, 0.01_dp]
    integer :: i, k

    options%direction = each
    do i = 1, size(zeta)
      osc = mesh_of(1.4_dp, zeta(i))
      call run_sweep([osc], speed_at(osc, 0.3_dp) + (speed_at(osc, 2.5_dp) - speed_at(osc, 0.3_dp))/speeds*[(k, k=1, speeds)], &
                     options, sweep, error)
      call check_no_error(t, 'the sweep', error)
      do k = 1, speeds
        call solve(osc, sweep%rpm(k), options%accuracy, point)
        call check_equal(t, 'status at '//str(sweep%rpm(k)), status_name(sweep%status(k, 1)), status_name(point%steady%status))
        if (has_result(point%steady%status)) &
          call check_close(t, 'dynamic factor at '//str(sweep%rpm(k)), sweep%dynamic_factor(k, 1), point%dynamic_factor, &
                           absolute=2*(point%estimate + sweep%estimate(k, 1)))
      end do
    end do
  end subroutine batches

  !> A sweep up has no point without a motion where the speed by itself has one, unless the motion at hand grows without bound;
  !> where the branch was lost, it is that of the speed by itself.
  subroutine lost_branches(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: speeds = 120
    type(oscillator_t) :: osc
    type(sweep_options_t) :: options
    type(sweep_t) :: alone, followed
    type(error_t), allocatable :: error
    integer :: k

    osc = mesh_of(1.6_dp, 0.01_dp)
    options%direction = each
    call run_sweep([osc], speed_at(osc, 0.3_dp) + speed_at(osc, 2.0_dp)/speeds*[(k, k=1, speeds)], options, alone, error)
    call check_no_error(t, 'each', error)
    options%direction = up
    call run_sweep([osc], alone%rpm, options, followed, error)
    call check_no_error(t, 'up', error)
    call check_true(t, 'each loses none', .not. any(alone%branch_lost))
    call check_true(t, 'up loses some', any(followed%branch_lost), str(count(followed%branch_lost)))
    do k = 1, speeds
      if (followed%status(k, 1) == status_unbounded .or. .not. has_result(alone%status(k, 1))) cycle
      call check_true(t, 'has a motion at '//str(alone%rpm(k)), has_result(followed%status(k, 1)))
      if (followed%branch_lost(k, 1)) &
        call check_close(t, 'that by itself at '//str(alone%rpm(k)), followed%dynamic_factor(k, 1), alone%dynamic_factor(k, 1), &
                         absolute=2*(followed%estimate(k, 1) + alone%estimate(k, 1)))
    end do
  end subroutine lost_branches

  !> Where both flanks touch, a large motion is that of the mesh without load or backlash: it grows without bound in the tongue of
  !> parametric resonance, here about 20 000 1/min, and decays outside. From rest it gets there where damping is small.
  subroutine unbounded(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: backlash = 12e-6_dp
    type(oscillator_t) :: osc
    type(accuracy_t) :: options
    type(point_t) :: point

    osc = mesh_of(1.3_dp, 0.03_dp, backlash)
    call solve(osc, 20000.0_dp, options, point, [100*osc%static_deflection, 0.0_dp])
    call check_equal(t, 'in the tongue', point%steady%status, status_unbounded)
    call solve(osc, 18000.0_dp, options, point, [100*osc%static_deflection, 0.0_dp])
    call check_true(t, 'beside it', has_result(point%steady%status), status_name(point%steady%status))
    osc = mesh_of(1.3_dp, 0.005_dp, backlash)
    options%steady%method = by_marching
    call solve(osc, 20000.0_dp, options, point)
    call check_equal(t, 'from rest', point%steady%status, status_unbounded)
    call check_true(t, 'no number', .not. has_result(point%steady%status))
    ! Where the word begins: at 1e4 static deflections, with those of the mean and of the backlash beside; with less damping
    ! later, as a harmonic of the load drives a linear motion to 1/(2 zeta) of them.
    osc = mesh_of(1.3_dp, 0.02_dp)
    call check_true(t, 'below 1e4', is_bounded(osc, 1e-3_dp, [0.99e4_dp*osc%static_deflection, 0.0_dp]))
    call check_true(t, 'above 1e4', .not. is_bounded(osc, 1e-3_dp, [2.1e4_dp*osc%static_deflection, 0.0_dp]))
    osc = mesh_of(1.3_dp, 1e-5_dp)
    call check_true(t, 'with less damping', is_bounded(osc, 1e-3_dp, [0.99e5_dp*osc%static_deflection, 0.0_dp]))
    call check_true(t, 'with less damping, further', .not. is_bounded(osc, 1e-3_dp, [2.1e5_dp*osc%static_deflection, 0.0_dp]))
  end subroutine unbounded
end module test_motion_selection
