!> Steps that are short behind a break and grow as the natural motion that the break excites decays.
!>
!> Where a motion of angular rate r decays at the rate d, a step h makes an error of the order (r h)**7. Steps that
!> grow like exp(d t/6) make the same error each, in proportion to the tolerance. Then 6 r/d times the steps of one
!> radian are enough, however long the motion goes on.
module gearsweep_grading
  use gearsweep_kinds, only: dp, pi
  implicit none
  private
  public :: grading_t, make_grading, is_stiff, has_turned, expected_steps, count_steps, spread_steps

  !> Number of steps per unit of phase at the phase t behind a break: the sum of dense*exp(-fade*t).
  type :: grading_t
    private
    real(dp), dimension(3) :: dense = 0, fade = 0
    real(dp) :: fastest = 0                      !< rate of the natural motion, rad over the phase
    real(dp) :: turn = 0                         !< phase behind the break at which a checksum is taken
  end type grading_t

contains

  !> Grading of a smooth interval.
  elemental type(grading_t) function make_grading(lowest, highest, zeta, finest, duration) result(grading)
    real(dp), intent(in) :: lowest, highest      !< bounds of the natural frequency over the interval, rad/s
    real(dp), intent(in) :: zeta                 !< damping ratio
    real(dp), intent(in) :: finest               !< steps of a radian of the natural motion right behind the break
    real(dp), intent(in) :: duration             !< of the mesh period, s
    ! The coefficients themselves are followed as if they went through so many radians in a period.
    real(dp), parameter :: smooth = 24
    real(dp), parameter :: slower = 1/7.0_dp     ! than the sixth that would do, to be safe
    real(dp) :: rate, decay                      ! of the fastest motion, over the frequency

    rate = 1
    decay = zeta
    if (zeta > 1) then
      rate = zeta + sqrt(zeta**2 - 1)
      decay = rate
      grading%dense(3) = finest*highest*duration/rate
      grading%fade(3) = slower*lowest*duration/rate
    end if
    grading%dense(:2) = finest*[smooth, rate*highest*duration]
    grading%fade(2) = slower*decay*lowest*duration
    grading%fastest = rate*highest*duration
    grading%turn = min(1.5_dp*pi/rate, 1/max(decay, tiny(decay)))/(highest*duration)
  end function make_grading

  !> Is a step too long to follow the natural motion, or its decay?
  elemental logical function is_stiff(grading, width)
    type(grading_t), intent(in) :: grading
    real(dp), intent(in) :: width                !< of the step, mesh phase
    real(dp), parameter :: most = 2.6_dp         ! rad

    is_stiff = grading%fastest*width > most
  end function is_stiff

  !> Has the natural motion gone through three quarters of a cycle, or decayed to a third? There the errors of the
  !> steps right behind the break still show, while at the end of the interval and in the largest load they may not.
  elemental logical function has_turned(grading, t)
    type(grading_t), intent(in) :: grading
    real(dp), intent(in) :: t                    !< mesh phase behind the break

    has_turned = t >= grading%turn
  end function has_turned

  !> About how many steps a smooth interval gets; at worst a quarter less than it does get.
  elemental real(dp) function expected_steps(grading, length) result(steps)
    type(grading_t), intent(in) :: grading
    real(dp), intent(in) :: length               !< of the interval, mesh phase

    ! In place of the integral (1 - exp(-x))/x, as this is asked for every operating point.
    steps = sum(grading%dense*length/(1 + grading%fade*length))
  end function expected_steps

  !> How many steps a smooth interval gets.
  elemental integer function count_steps(grading, length) result(n)
    type(grading_t), intent(in) :: grading
    real(dp), intent(in) :: length               !< of the interval, mesh phase
    real(dp) :: t

    t = 0
    n = 0
    do while (t < length)
      t = t + next_width(grading, t)
      n = n + 1
    end do
  end function count_steps

  !> The widths of these steps.
  pure subroutine spread_steps(grading, length, widths)
    type(grading_t), intent(in) :: grading
    real(dp), intent(in) :: length               !< of the interval, mesh phase
    real(dp), intent(out) :: widths(:)           !< mesh phase, as many as `count_steps` says; they add up to `length`
    real(dp) :: t
    integer :: i

    t = 0
    do i = 1, size(widths)
      widths(i) = next_width(grading, t)
      t = t + widths(i)
    end do
    widths = widths*(length/t)
  end subroutine spread_steps

  pure real(dp) function next_width(grading, t)
    type(grading_t), intent(in) :: grading
    real(dp), intent(in) :: t

    next_width = 1/sum(grading%dense*exp(-grading%fade*t))
  end function next_width
end module gearsweep_grading
