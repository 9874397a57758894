!> Reported error estimates over random meshes: they may be exceeded twofold by
!> one in twenty at most, and the tolerance by one in a hundred. What is true comes from
!> the library itself at 1e-11; `sh bench/run.sh honesty` asks an independent reference.
module test_honesty
  use gearsweep_error, only: error_t
  use gearsweep_kinds, only: dp
  use gearsweep_steady, only: has_answer
  use gearsweep_sweep, only: sweep_t, sweep_options_t, run_sweep, each, contact_full
  use gearsweep_text, only: str
  use random_meshes, only: draw_t, random_mesh
  use testing, only: tally_t, check_true
  implicit none
  private
  public :: run

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: meshes = 32, speeds = 4
    integer :: i, points, optimistic, beyond, parted

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

  contains

    subroutine one_mesh(i)
      integer, intent(in) :: i
      !> What is true is no better than this.
      real(dp), parameter :: rounding = 2e-11_dp
      type(draw_t) :: draw
      type(sweep_t) :: asked, truth
      real(dp) :: error
      integer :: k

      call random_mesh(1000 + i, speeds, draw)
      asked = swept(draw, draw%tolerance)
      truth = swept(draw, 1e-11_dp)
      do k = 1, speeds
        if (.not. (has_answer(asked%status(k, 1)) .and. has_answer(truth%status(k, 1)))) cycle
        error = abs(asked%dynamic_factor(k, 1) - truth%dynamic_factor(k, 1)) - rounding
        points = points + 1
        if (error > 2*asked%estimate(k, 1)) optimistic = optimistic + 1
        if (error > draw%tolerance) beyond = beyond + 1
        if (asked%contact(k, 1) /= contact_full) parted = parted + 1
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
