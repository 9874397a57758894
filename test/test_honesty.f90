!> Reported error estimates over random meshes: they may be exceeded twofold by
!> one in twenty at most, and the tolerance by one in a hundred. Half of the errors lie below
!> 20/63 of the estimate, as a result of sixth order errs by 1/63 of its difference to half the steps, and
!> the estimate says 1/20 of it: neither too small nor too large. What is true comes from
!> the library itself at 1e-11; `sh bench/run.sh honesty` asks an independent reference.
module test_honesty
  use gearsweep_error, only: error_t
  use gearsweep_kinds, only: dp
  use gearsweep_status, only: has_result
  use gearsweep_sweep, only: sweep_t, sweep_options_t, run_sweep, each, contact_full
  use gearsweep_text, only: str
  use random_meshes, only: draw_t, random_mesh
  use test_estimates, only: median
  use testing, only: tally_t, check_close, check_true
  implicit none
  private
  public :: run

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: meshes = 32, speeds = 4
    integer :: i, points, optimistic, beyond, parted, told(2)
    real(dp) :: part(meshes*speeds, 2)

    told = 0
    points = 0
    optimistic = 0
    beyond = 0
    parted = 0
    do i = 1, meshes
      call one_mesh(i)
    end do
    call check_true(t, 'most points have an answer', points >= meshes*speeds*8/10, str(points))
    call check_true(t, 'some lose contact', parted >= meshes*speeds/10, str(parted))
    call check_true(t, 'estimates hold twofold in 95 %', 20*optimistic <= points, str(optimistic)//' of '//str(points))
    call check_true(t, 'the tolerance holds in 99 %', 100*beyond <= points, str(beyond)//' of '//str(points))
    call check_close(t, 'in contact: error over estimate, median', median(part(:told(1), 1)), 20/63.0_dp, 0.4_dp)
    call check_close(t, 'parted: error over estimate, median', median(part(:told(2), 2)), 20/63.0_dp, 0.4_dp)

  contains

    subroutine one_mesh(i)
      integer, intent(in) :: i
      !> What is true is no better than this.
      real(dp), parameter :: rounding = 2e-11_dp
      type(draw_t) :: draw
      type(sweep_t) :: asked, truth
      real(dp) :: error
      integer :: k, kind

      call random_mesh(1000 + i, speeds, draw)
      asked = swept(draw, draw%tolerance)
      truth = swept(draw, 1e-11_dp)
      do k = 1, speeds
        if (.not. (has_result(asked%status(k, 1)) .and. has_result(truth%status(k, 1)))) cycle
        error = abs(asked%dynamic_factor(k, 1) - truth%dynamic_factor(k, 1)) - rounding
        points = points + 1
        if (error > 2*asked%estimate(k, 1)) optimistic = optimistic + 1
        if (error > draw%tolerance) beyond = beyond + 1
        kind = merge(1, 2, asked%contact(k, 1) == contact_full)
        if (kind == 2) parted = parted + 1
        ! Of errors near rounding nothing can be said.
        if (error < 5*rounding) cycle
        told(kind) = told(kind) + 1
        part(told(kind), kind) = error/asked%estimate(k, 1)
      end do
    end subroutine one_mesh
  end subroutine run

  type(sweep_t) function swept(draw, tolerance) result(sweep)
    type(draw_t), intent(in) :: draw
    real(dp), intent(in) :: tolerance
    type(sweep_options_t) :: options
    type(error_t), allocatable :: error

    options%direction = each
    options%accuracy%steady%tolerance = tolerance
    call run_sweep([draw%osc], draw%rpm, options, sweep, error)
  end function swept
end module test_honesty
