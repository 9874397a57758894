!> Steps that are short behind a break and grow as what it stirs up dies away.
!>
!> A motion of rate r that decays at the rate d is followed in steps of the same error, in proportion
!> to the tolerance, when these grow like exp(d t/6), as a step h makes an error of (r h)**7. Then 6 r/d times
!> the steps of a radian do, however long the motion goes on.
module gearsweep_grading
  use gearsweep_kinds, only: dp, pi
  implicit none
  private
  public :: grading_t, make_grading, is_stiff, has_turned, expected_steps, count_steps, spread_steps

  !> Steps over the mesh phase at the phase t behind a break: the sum of dense*exp(-fade*t).
  type :: grading_t
    private
    real(dp), dimension(3) :: dense = 0, fade = 0
    real(dp) :: fastest = 0                      !< rate of the natural motion over the phase
    real(dp) :: turn = 0                         !< phase behind the break at which it is noted
  end type grading_t

contains

  !> Grading for natural motion of the frequencies `lowest` to `highest` (rad/s) and damping ratio `zeta`,
  !> with `finest` steps a radian at the break, for a period of `duration` (s).
  elemental type(grading_t) function make_grading(lowest, highest, zeta, finest, duration) result(grading)
    real(dp), intent(in) :: lowest, highest, zeta, finest, duration
    ! As if what the coefficients ask for turned so many radians a period.
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

  !> Is a step too long to see the natural motion, or its decay?
  elemental logical function is_stiff(grading, width)
    type(grading_t), intent(in) :: grading
    real(dp), intent(in) :: width
    real(dp), parameter :: most = 2.6_dp         ! rad

    is_stiff = grading%fastest*width > most
  end function is_stiff

  !> Has the natural motion done three quarters of a turn at the phase t behind the break, or decayed to a
  !> third? There errors of the steps behind the break show that its end, and the peak, may not.
  elemental logical function has_turned(grading, t)
    type(grading_t), intent(in) :: grading
    real(dp), intent(in) :: t

    has_turned = t >= grading%turn
  end function has_turned

  !> About how many steps a zone of `length` gets, a quarter less at worst.
  elemental real(dp) function expected_steps(grading, length) result(steps)
    type(grading_t), intent(in) :: grading
    real(dp), intent(in) :: length

    ! For the integral, (1 - exp(-x))/x; this is asked for every point.
    steps = sum(grading%dense*length/(1 + grading%fade*length))
  end function expected_steps

  !> The steps that it gets.
  elemental integer function count_steps(grading, length) result(n)
    type(grading_t), intent(in) :: grading
    real(dp), intent(in) :: length
    real(dp) :: t

    t = 0
    n = 0
    do while (t < length)
      t = t + next_width(grading, t)
      n = n + 1
    end do
  end function count_steps

  !> Their widths.
  pure subroutine spread_steps(grading, length, widths)
    type(grading_t), intent(in) :: grading
    real(dp), intent(in) :: length
    real(dp), intent(out) :: widths(:)
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
