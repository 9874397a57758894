!> Reported error estimates over random meshes, for bench/honesty.py.
!>
!>     honesty MESHES SPEEDS KIND
!>     honesty motions FIRST LAST
!>
!> KIND is one of those of random_meshes.
!>
!> Prints the problems for the reference, at the speeds whose motion repeats with each
!> mesh period, with the motions to start from; on the error unit a line for each mesh and speed: mesh, contact ratio, relief over the mean
!> deflection, damping ratio, speed over the main resonance, tolerance, status,
!> contact, mesh periods, dynamic factor, estimate, 1 where the reference has it.
!>
!> Or the draws of random_motions from FIRST to LAST, at eight speeds each, in a batch and one by one in turns of eight draws.
!> A line for each motion found: draw, contact ratio, relief, friction, 1 with backlash, damping ratio, speed over the main resonance,
!> tolerance, contact, 1 in graded steps, estimate, error. The error is that against four times as many steps and more, cut
!> otherwise, less by what they are off from still more.
program honesty
  use bench_problem, only: write_problem
  use bench_tools, only: word, number, check, numbers
  use gearsweep, only: dp, error_t, oscillator_t, run_sweep, sweep_t, sweep_options_t, each
  use gearsweep_motion_error_estimate, only: accuracy_t, levels_t, point_t
  use gearsweep_motion_resolution, only: resolution_t
  use gearsweep_motion_gauss, only: batch_size
  use gearsweep_motion_operating_point, only: solve_batch, solve_point
  use gearsweep_motion_oscillator, only: mesh_period, resolving_steps
  use gearsweep_motion_period_map, only: discretise, period_map_t, set_durations
  use gearsweep_motion_periodic_orbit, only: shoot, steady_t
  use gearsweep_base_kinds, only: pi
  use gearsweep_motion_steady_motion, only: has_result
  use test_properties_random_meshes, only: draw_t, random_mesh
  use test_properties_random_motions, only: random_motion
  use, intrinsic :: iso_fortran_env, only: error_unit
  implicit none
  integer :: i

  if (word(1) == 'motions') then
    do i = number(2), number(3)
      call one_draw(i)
    end do
  else
    do i = 1, number(1)
      call one_mesh(i)
    end do
  end if

contains

  subroutine one_mesh(i)
    integer, intent(in) :: i
    type(draw_t) :: draw
    type(sweep_options_t) :: options
    type(sweep_t) :: sweep
    type(error_t), allocatable :: error
    real(dp), allocatable :: start(:, :)
    logical, allocatable :: known(:)
    integer :: k

    call random_mesh(i, number(2), draw, number(3))
    options%direction = each
    options%threads = 1
    options%accuracy%steady%tolerance = draw%tolerance
    call run_sweep([draw%osc], draw%rpm, options, sweep, error)
    call check(error)
    call find_motions(draw%osc, sweep, draw%tolerance, start, known)
    if (any(known)) call write_problem([draw%osc], pack(draw%rpm, known), &
      reshape(pack(start, spread(known, 1, 2)), [2, count(known)]))
    associate (osc => draw%osc, mesh => draw%osc%mesh)
      do k = 1, size(draw%rpm)
        write (error_unit, numbers) i, mesh%contact_ratio, mesh%profile_error%value(0.0_dp)/osc%static_deflection, &
          osc%damping_ratio, draw%rpm(k)*mesh%teeth(1)/60*2*pi/osc%natural_frequency, draw%tolerance, sweep%status(k, 1), &
          sweep%contact(k, 1), sweep%periods(k, 1), sweep%dynamic_factor(k, 1), sweep%estimate(k, 1), merge(1, 0, known(k))
      end do
    end associate
  end subroutine one_mesh

  !> Where the motions of a sweep that repeat with each mesh period pass phase 0. A sweep does not
  !> tell, so each point is solved again; `known` where that came to the same motion. As several may
  !> coexist, some tolerances are tried.
  subroutine find_motions(osc, sweep, tolerance, start, known)
    type(oscillator_t), intent(in) :: osc
    type(sweep_t), intent(in) :: sweep
    real(dp), intent(in) :: tolerance
    real(dp), allocatable, intent(out) :: start(:, :)
    logical, allocatable, intent(out) :: known(:)
    integer, parameter :: tries = 8
    type(accuracy_t) :: options
    type(levels_t), allocatable :: tables
    type(point_t) :: point
    real(dp) :: duration
    integer :: k, try

    allocate (start(2, size(sweep%rpm)), known(size(sweep%rpm)))
    known = .false.
    do k = 1, size(sweep%rpm)
      if (.not. has_result(sweep%status(k, 1)) .or. sweep%periods(k, 1) > 1) cycle
      duration = mesh_period(osc%mesh%teeth(1), sweep%rpm(k))
      do try = 1, tries
        tables = levels_t()
        options%steady%tolerance = tolerance/10.0_dp**(try - 1)
        call solve_point(osc, duration, options, tables, point)
        known(k) = has_result(point%steady%status) .and. point%steady%periods == 1 .and. &
                   abs(point%dynamic_factor - sweep%dynamic_factor(k, 1)) < 1e-3_dp
        if (known(k)) exit
      end do
      start(:, k) = point%steady%state/osc%static_deflection/[1.0_dp, osc%natural_frequency*duration]
    end do
  end subroutine find_motions

  subroutine one_draw(i)
    integer, intent(in) :: i
    type(draw_t) :: draw
    type(accuracy_t) :: options
    type(levels_t), allocatable :: levels
    type(point_t) :: points(batch_size)
    logical :: solved(batch_size)
    real(dp) :: duration(batch_size), steps, truth(2)
    integer :: k, contact

    call random_motion(i, batch_size, draw)
    associate (osc => draw%osc, mesh => draw%osc%mesh)
      options%steady%tolerance = draw%tolerance
      duration = mesh_period(mesh%teeth(1), draw%rpm)
      solved = .false.
      levels = levels_t()
      if (modulo(i/8, 2) == 0) call solve_batch(osc, duration, options, levels, points, solved)
      do k = 1, batch_size
        levels = levels_t()
        if (.not. solved(k)) call solve_point(osc, duration(k), options, levels, points(k))
        associate (point => points(k))
          if (.not. has_result(point%steady%status)) cycle
          steps = min(max(1500.0_dp, 4.0_dp*point%steps, 16*resolving_steps(osc, duration(k))), 4e5_dp)
          truth = [in_many_steps(osc, duration(k), steps, point%steady), &
                   in_many_steps(osc, duration(k), 1.37_dp*steps, point%steady)]
          contact = merge(1, 0, point%steady%partial)
          if (point%steady%lost) contact = 2
          print numbers, i, mesh%contact_ratio, mesh%profile_error%value(0.0_dp)/osc%static_deflection, osc%friction, &
            merge(1, 0, osc%has_backlash), osc%damping_ratio, 2*pi/duration(k)/osc%natural_frequency, draw%tolerance, contact, &
            merge(1, 0, point%resolution%graded_for > 0), point%estimate, &
            max(0.0_dp, abs(point%dynamic_factor - truth(2)) - abs(truth(1) - truth(2)))
        end associate
      end do
    end associate
  end subroutine one_draw

  !> The dynamic factor of a motion.
  real(dp) function in_many_steps(osc, duration, steps, motion) result(dynamic_factor)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration, steps
    type(steady_t), intent(in) :: motion
    type(period_map_t) :: map
    type(steady_t) :: steady

    call discretise(osc, resolution_t(steps/7, 7), map)
    call set_durations(map, [duration])
    call shoot(map, 1e-12_dp, motion%periods, motion%state, steady)
    dynamic_factor = merge(steady%peak/osc%load, huge(dynamic_factor), has_result(steady%status))
  end function in_many_steps
end program honesty
