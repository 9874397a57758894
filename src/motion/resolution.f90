!> Resolution of a mesh period: the method, and how many steps a smooth interval has.
!>
!> Graded steps are short after a break and grow as the natural motion that the break excites decays. Where a motion of angular
!> rate r decays at the rate d, a step h makes an error of the order (r h)**7, so that steps that grow like exp(d t/6) make the
!> same error each, in proportion to the tolerance. Then 6 r/d times the steps of one radian are enough, however long the motion
!> lasts.
module gearsweep_motion_resolution
  use gearsweep_base, only: dp, pi
  use gearsweep_motion_oscillator, only: oscillator_t
  implicit none
  private
  public :: resolution_t, grading_t, gradings, count_steps, spread_steps, equal_steps, graded_steps, is_stiff, has_turned

  !> Number of steps per unit of phase at the phase t after a break: the sum of dense*exp(-fade*t).
  type :: grading_t
    real(dp), dimension(3) :: dense = 0, fade = 0
    real(dp) :: fastest = 0                      !< rate of the natural motion, rad over the phase
    real(dp) :: turn = 0                         !< phase after the break at which a checksum is computed
  end type grading_t

  !> Methods of integration.
  integer, parameter, public :: &
    scheme_collocation = 0, &          !< Gauss collocation in steps that end at the breaks; contact events are located
    scheme_rk4 = 1, &                  !< classical Runge-Kutta in steps that end at the breaks
    scheme_rk4_equal = 2, &            !< classical Runge-Kutta in equal steps (Dogan et al. 2021)
    scheme_constant = 3                !< exact motion over equal steps with constant coefficients (Karpat et al. 2012)

  !> Method and number of the steps. A smooth interval is divided into parts by `base`, each part into `times` equal steps: the
  !> steps of a multiple of `times` nest in those of the same base.
  type :: resolution_t
    real(dp) :: base = 0               !< parts of a mesh period; graded: parts of a radian of the natural motion after a break
    integer :: times = 1               !< steps of a part
    real(dp) :: graded_for = 0         !< duration of the mesh period for which parts grow after a break, s; 0: parts are equal
    integer :: scheme = scheme_collocation
    logical :: by_load = .false.       !< smooth intervals also end where pairs begin and cease to carry the static load
  end type resolution_t

contains

  !> Computes the grading of a smooth interval.
  elemental type(grading_t) function make_grading(lowest, highest, zeta, finest, duration) result(grading)
    real(dp), intent(in) :: lowest, highest      !< bounds of the natural frequency over the interval, rad/s
    real(dp), intent(in) :: zeta                 !< damping ratio
    real(dp), intent(in) :: finest               !< steps per radian of the natural motion right after the break
    real(dp), intent(in) :: duration             !< duration of the mesh period, s
    ! Equivalent angle of the coefficients in a period (rad), which sets the steps that resolve them.
    real(dp), parameter :: smooth = 24
    real(dp), parameter :: slower = 1/7.0_dp     ! instead of the sufficient 1/6, to be safe
    real(dp) :: rate, decay                      ! rate and decay of the fastest motion, over the frequency

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

  !> True if a step is too long to follow the natural motion or its decay.
  elemental logical function is_stiff(grading, width)
    type(grading_t), intent(in) :: grading
    real(dp), intent(in) :: width                !< width of the step, mesh phase
    real(dp), parameter :: most = 2.6_dp         ! rad

    is_stiff = grading%fastest*width > most
  end function is_stiff

  !> True if the natural motion has passed three quarters of a cycle or decayed to a third. There the errors of the first steps
  !> after the break still show, while at the end of the interval and in the largest load they may not.
  elemental logical function has_turned(grading, t)
    type(grading_t), intent(in) :: grading
    real(dp), intent(in) :: t                    !< mesh phase after the break

    has_turned = t >= grading%turn
  end function has_turned

  !> Estimate of the number of steps of a smooth interval; at most a quarter below the true number.
  elemental real(dp) function expected_steps(grading, length) result(steps)
    type(grading_t), intent(in) :: grading
    real(dp), intent(in) :: length               !< length of the interval, mesh phase

    ! Estimate instead of the exact integral (1 - exp(-x))/x, to save time: every operating point needs it.
    steps = sum(grading%dense*length/(1 + grading%fade*length))
  end function expected_steps

  !> Number of steps of a smooth interval.
  elemental integer function count_steps(grading, length) result(n)
    type(grading_t), intent(in) :: grading
    real(dp), intent(in) :: length               !< length of the interval, mesh phase
    real(dp) :: t

    t = 0
    n = 0
    do while (t < length)
      t = t + next_width(grading, t)
      n = n + 1
    end do
  end function count_steps

  !> Computes the widths of these steps.
  pure subroutine spread_steps(grading, length, widths)
    type(grading_t), intent(in) :: grading
    real(dp), intent(in) :: length               !< length of the interval, mesh phase
    real(dp), intent(out) :: widths(:)           !< mesh phase; as many as `count_steps` returns; their sum is `length`
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

  !> Number of steps of a smooth interval of this length (mesh phase), of one part at least. Twice the `times` halves every step,
  !> so that the difference of two resolutions shows the error of each.
  elemental integer function equal_steps(length, resolution) result(steps)
    real(dp), intent(in) :: length
    type(resolution_t), intent(in) :: resolution

    steps = resolution%times*max(1, ceiling(resolution%base*length - 1e-6_dp))
  end function equal_steps

  !> Growth of the steps after the start of each smooth interval of a mesh period; (interval).
  pure function gradings(osc, resolution) result(grading)
    type(oscillator_t), intent(in) :: osc
    type(resolution_t), intent(in) :: resolution
    type(grading_t) :: grading(size(osc%frequency, 2))

    grading = make_grading(osc%frequency(1, :), osc%frequency(2, :), osc%damping_ratio, resolution%base, resolution%graded_for)
  end function gradings

  !> Estimate of the number of graded steps of all mesh periods after which the deviations repeat.
  pure real(dp) function graded_steps(osc, resolution)
    type(oscillator_t), intent(in) :: osc
    type(resolution_t), intent(in) :: resolution           !< graded

    associate (intervals => osc%intervals(:size(osc%frequency, 2)))
      graded_steps = resolution%times*osc%mesh%deviations%periods* &
                     sum(expected_steps(gradings(osc, resolution), intervals%last - intervals%first))
    end associate
  end function graded_steps
end module gearsweep_motion_resolution
