!> Reported error estimates over random meshes, for bench/honesty.py.
!>
!>     honesty MESHES SPEEDS
!>
!> Prints the problems for the reference, at the speeds whose motion repeats with each
!> mesh period, with the motions to start from; on the error unit a line for each mesh and speed: mesh, contact ratio, relief over the mean
!> deflection, damping ratio, speed over the main resonance, tolerance, status,
!> contact, mesh periods, dynamic factor, estimate, 1 where the reference has it.
program honesty
  use bench_problem, only: write_problem
  use bench_tools, only: word, number, check, numbers
  use gearsweep, only: dp, error_t, oscillator_t, run_sweep, sweep_t, sweep_options_t, each
  use gearsweep_error_estimate, only: accuracy_t, point_t
  use gearsweep_operating_point, only: solve_point
  use gearsweep_oscillator, only: mesh_period
  use gearsweep_refinement, only: levels_t
  use gearsweep_kinds, only: pi
  use gearsweep_status, only: has_result
  use random_meshes, only: draw_t, random_mesh
  use, intrinsic :: iso_fortran_env, only: error_unit
  implicit none
  integer :: i

  do i = 1, number(1)
    call one_mesh(i)
  end do

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

    call random_mesh(i, number(2), draw)
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
end program honesty
