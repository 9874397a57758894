!> Bounds of curves that are convex, between three places at which they are known or bounded.
!>
!> A convex curve lies below its chords, and above what these become beyond their ends.
module gearsweep_convex_bounds
  use gearsweep_kinds, only: dp
  implicit none
  private
  public :: known_curve_t, bound_curves, may_be_largest

  !> Many curves at one place.
  type :: known_curve_t
    real(dp) :: place = 0
    !> Between these each curve lies there; unallocated where nothing is known or the curves are not convex; (curve)
    real(dp), allocatable :: lower(:), upper(:)
  end type known_curve_t

contains

  !> Bounds at a place between the first and the last of three.
  pure subroutine bound_curves(three, place, lower, upper)
    type(known_curve_t), intent(in) :: three(3)        !< by place, ascending, all known
    real(dp), intent(in) :: place
    real(dp), intent(out) :: lower(:), upper(:)  !< (curve)
    integer :: near, far
    real(dp) :: part, beyond

    near = merge(1, 3, place < three(2)%place)
    far = 4 - near
    part = (place - three(2)%place)/(three(near)%place - three(2)%place)
    upper = (1 - part)*three(2)%upper + part*three(near)%upper
    beyond = (place - three(2)%place)/(three(2)%place - three(far)%place)
    lower = (1 + beyond)*three(2)%lower - beyond*three(far)%upper
  end subroutine bound_curves

  !> The curves that may be the largest at one of these places, among curves that are known up to so much.
  pure subroutine may_be_largest(three, places, slack, candidates)
    type(known_curve_t), intent(in) :: three(3)        !< by place, ascending
    real(dp), intent(in) :: places(:)
    real(dp), intent(in) :: slack
    logical, intent(inout) :: candidates(:)      !< all where too little is known; (curve)
    real(dp), dimension(size(candidates)) :: lower, upper
    integer :: i

    candidates = .not. all([(allocated(three(i)%upper), i=1, 3)])
    if (all(candidates)) return
    do i = 1, size(places)
      call bound_curves(three, places(i), lower, upper)
      candidates = candidates .or. upper + slack >= maxval(lower)
    end do
  end subroutine may_be_largest
end module gearsweep_convex_bounds
