!> Runs of points along the root between two teeth: the lower fillet and the root land.
module gearsweep_root_run
  use gearsweep_kinds, only: dp, pi
  use gearsweep_gear, only: gear_t, coast
  use gearsweep_outline, only: fillet_point, root_angle
  use gearsweep_tooth_block, only: tooth_block_t, turned
  implicit none
  private
  public :: append, fillet_run

contains

  !> Adds a run of points that begins where the last one ended.
  pure subroutine append(top, run)
    real(dp), allocatable, intent(inout) :: top(:, :)
    real(dp), intent(in) :: run(:, :)
    real(dp), allocatable :: joined(:, :)
    integer :: n

    n = size(top, 2)
    if (n == 0) then
      top = run
    else
      allocate (joined(2, n + size(run, 2) - 1))
      joined(:, :n) = top
      joined(:, n + 1:) = run(:, 2:)
      call move_alloc(joined, top)
    end if
  end subroutine append

  !> The lower fillet and the root land of one side of the tooth with this
  !> `axis`, between the tooth's block and the ray at angle `ray`; left to right.
  pure function fillet_run(gear, block, side, axis, ray) result(run)
    type(gear_t), intent(in) :: gear
    type(tooth_block_t), intent(in) :: block
    integer, intent(in) :: side
    real(dp), intent(in) :: axis, ray
    real(dp), allocatable :: run(:, :)
    real(dp) :: reach, first, last, angle
    integer :: land, i, n

    reach = abs(ray - axis)
    first = block%split(side)
    last = pi/2
    land = 0
    if (reach < root_angle(gear, side)*(1 - 1e-9_dp)) then
      last = parameter_at(gear, side, first, reach)
    else if (reach > root_angle(gear, side)*(1 + 1e-9_dp)) then
      land = max(1, nint(block%across*gear%root_radius*(reach - root_angle(gear, side))/block%width))
    end if
    n = 2*block%lower
    allocate (run(2, 0:n + 2*land))
    do i = 0, n
      run(:, i) = fillet_point(gear, side, first + (last - first)*i/n)
    end do
    do i = n + 1, n + 2*land
      angle = root_angle(gear, side) + (reach - root_angle(gear, side))*(i - n)/(2*land)
      run(:, i) = gear%root_radius*[sin(angle), cos(angle)]
    end do
    if (side == coast) run(1, :) = -run(1, :)
    if (side == coast) run = run(:, ubound(run, 2):0:-1)
    run = turned(run, axis)
  end function fillet_run

  !> The fillet's parameter at the angle `reach` from the tooth axis, by bisection.
  pure real(dp) function parameter_at(gear, side, first, reach) result(beta)
    type(gear_t), intent(in) :: gear
    integer, intent(in) :: side
    real(dp), intent(in) :: first, reach
    real(dp) :: low, high, p(2)
    integer :: i

    low = first
    high = pi/2
    do i = 1, 60
      beta = (low + high)/2
      p = fillet_point(gear, side, beta)
      if (atan2(p(1), p(2)) < reach) then
        low = beta
      else
        high = beta
      end if
    end do
  end function parameter_at
end module gearsweep_root_run
