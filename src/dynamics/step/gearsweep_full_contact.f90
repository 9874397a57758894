!> One mesh period of the motion in full contact, about which it is linear.
module gearsweep_full_contact
  use gearsweep_contact_set, only: keep_derivative, period_t
  use gearsweep_gauss, only: batch_size
  use gearsweep_kinds, only: dp
  use gearsweep_literature_period, only: run_literature_period
  use gearsweep_period_map, only: compose, flush_to_zero, period_map_t, propagate_alike, take_step, whole
  implicit none
  private
  public :: run_full_contact

contains

  !> One period in which full contact stays, whether a pair pushes or pulls: the state after it and the monodromy matrix,
  !> but no loads.
  pure subroutine run_full_contact(map, start, period)
    type(period_map_t), intent(inout) :: map
    real(dp), intent(in) :: start(:, :)                    !< x, y (m) at the begin; (2, speed)
    type(period_t), intent(inout) :: period(:)             !< of each speed
    real(dp) :: monodromy(batch_size, 4), shrunk(batch_size), x(batch_size, 2), y(batch_size, 2)
    integer :: place, from, to, i, l

    if (allocated(map%literature)) then
      call run_literature_period(map%osc, map%literature, map%duration(1), start(:, 1), .true., period(1))
      return
    end if
    from = 1
    to = 2
    x(:, from) = 0
    y(:, from) = 0
    x(:map%speeds, from) = start(1, :)
    y(:map%speeds, from) = start(2, :)
    monodromy = 0
    monodromy(:, 1) = 1
    monodromy(:, 4) = 1
    shrunk = 0
    do i = 1, map%table%steps
      place = merge(i, 1, map%cached)
      call propagate_alike(map%osc, map%table, i, map%duration(:map%speeds), i, whole, map%propagator(:, :, place))
      map%contact_set(:, place) = map%table%full(i)
      call compose(map%propagator(:, :, place), monodromy)
      if (modulo(i, 64) == 0) call flush_to_zero(monodromy, shrunk)
      call take_step(map%propagator(:, :, place), x(:, from), y(:, from), x(:, to), y(:, to))
      from = to
      to = 3 - from
    end do
    map%all_full = map%cached
    map%monodromy = monodromy
    map%shrunk = shrunk
    do l = 1, map%speeds
      call keep_derivative(monodromy(l, :), shrunk(l), period(l))
      period(l)%state = [x(l, from), y(l, from)]
    end do
  end subroutine run_full_contact
end module gearsweep_full_contact
