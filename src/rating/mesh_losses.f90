!> Power loss by friction in the mesh: the mean coefficient of friction, and the tooth loss factor H_v; their product is the lost
!> part of the power.
module gearsweep_rating_mesh_losses
  use gearsweep_base, only: dp, gauss_legendre, pi
  use gearsweep_gear, only: pair_t
  use gearsweep_mesh, only: interval_t, mesh_t, segment_t, smooth_segments, solve_equilibrium_at
  use gearsweep_rating_flank, only: sliding_ratio
  implicit none
  private
  public :: friction_rule_t, mean_friction, static_loss_factor, followed_loss_factor, half_shares_factor, even_load_factor

  type :: friction_rule_t
    real(dp) :: coefficient = -1                 !< stated coefficient of friction; below 0: by the formula
    real(dp) :: roughness = 0.5e-6_dp            !< arithmetic mean Ra of both flanks, m
    real(dp) :: oil_factor = 1                   !< X_L: 1 mineral oil
    real(dp) :: viscosity = 0.03_dp              !< dynamic viscosity of the oil, Pa s
  end type friction_rule_t

  integer, parameter :: points = 12              !< points of Gauss's rule on a panel

  !> Integrand over the mesh phase: power loss over coefficient of friction and power.
  type :: integrand_t
    type(pair_t) :: pair
    type(mesh_t) :: mesh
    real(dp) :: load = 0                         !< static load, N
    type(interval_t) :: interval
    real(dp) :: node(points) = 0, weight(points) = 0   !< nodes and weights on -1 to 1
  end type integrand_t

contains

  !> Mean coefficient of friction over the mesh under `load` (N) at `speed` (of the pinion, rad/s):
  !> 0.048 (F_bt/b/(v_Sigma rho))**0.2 eta**-0.05 Ra**0.25 X_L with F_bt/b in N/mm, the sum of both rolling speeds v_Sigma in
  !> m/s and the reduced radius of curvature rho in mm, both at the pitch point, eta in mPa s, Ra in um.
  !> Source: ISO/TR 14179-2:2001, after Schlenk 1995.
  pure real(dp) function mean_friction(rule, pair, load, speed) result(friction)
    type(friction_rule_t), intent(in) :: rule
    type(pair_t), intent(in) :: pair
    real(dp), intent(in) :: load, speed
    real(dp) :: points(5), radius(2), rolling

    friction = rule%coefficient
    if (.not. friction < 0) return
    points = pair%points()
    radius = pair%curvature([1, 2], points(3))
    rolling = 2*speed*radius(1)
    friction = 0.048_dp*(1e-3_dp*load/minval(pair%gear%spec%face_width)/(rolling*1e3_dp*product(radius)/sum(radius)))**0.2_dp &
               *(1e3_dp*rule%viscosity)**(-0.05_dp)*(1e6_dp*rule%roughness)**0.25_dp*rule%oil_factor
  end function mean_friction

  !> H_v under the static `load` (N) with the sharing by stiffness and relief: the mean over the mesh period of the sum over the
  !> pairs of load times sliding speed, over the static load and the speed of the base circles. Smooth intervals are halved until
  !> the integral no longer changes.
  pure real(dp) function static_loss_factor(pair, mesh, load) result(factor)
    type(pair_t), intent(in) :: pair
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: load
    integer, parameter :: halvings = 16
    type(interval_t), allocatable :: intervals(:)
    type(segment_t), allocatable :: segments(:)
    type(integrand_t) :: f
    real(dp) :: kink, ends(3)
    integer :: i, k

    call smooth_segments(mesh, load, intervals, segments)
    f%pair = pair
    f%mesh = mesh
    f%load = load
    call gauss_legendre(f%node, f%weight)
    ! Sliding changes its sign where a pair passes the pitch point.
    kink = mesh%pitch_point - floor(mesh%pitch_point)
    factor = 0
    do i = 1, size(segments)
      f%interval = intervals(segments(i)%interval)
      ends = [segments(i)%first, min(max(kink, segments(i)%first), segments(i)%last), segments(i)%last]
      do k = 1, 2
        if (ends(k + 1) > ends(k)) factor = factor + refined(f, ends(k), ends(k + 1), panel(f, ends(k), ends(k + 1)), halvings)
      end do
    end do
  end function static_loss_factor

  !> Integral from phase a to b by repeated halving; `undivided` is its first value.
  pure recursive real(dp) function refined(f, a, b, undivided, halvings) result(total)
    type(integrand_t), intent(in) :: f
    real(dp), intent(in) :: a, b, undivided
    integer, intent(in) :: halvings
    real(dp), parameter :: tolerance = 1e-14_dp
    real(dp) :: middle, left, right

    middle = (a + b)/2
    left = panel(f, a, middle)
    right = panel(f, middle, b)
    total = left + right
    if (abs(total - undivided) <= tolerance*(b - a) .or. halvings == 0) return
    total = refined(f, a, middle, left, halvings - 1) + refined(f, middle, b, right, halvings - 1)
  end function refined

  !> Integral over a panel by Gauss's rule.
  pure real(dp) function panel(f, a, b)
    type(integrand_t), intent(in) :: f
    real(dp), intent(in) :: a, b
    integer :: i

    panel = sum([(f%weight(i)*loss_at(f, (a + b + (b - a)*f%node(i))/2), i=1, points)])*(b - a)/2
  end function panel

  pure real(dp) function loss_at(f, phase)
    type(integrand_t), intent(in) :: f
    real(dp), intent(in) :: phase
    real(dp) :: deflection, force(f%interval%pairs)
    integer :: j

    call solve_equilibrium_at(f%mesh, f%interval, f%load, phase, deflection, force)
    associate (s => f%interval%place(phase, [(j, j=1, f%interval%pairs)]))
      loss_at = sum(force*abs(sliding_ratio(f%pair, s)))/f%load
    end associate
  end function loss_at

  !> H_v of a computed motion: `load` (N) of each pair at its path coordinates `s`, pair after pair, as in
  !> gearsweep_motion_response; over the nominal load (N).
  pure real(dp) function followed_loss_factor(pair, which, s, load, nominal) result(factor)
    type(pair_t), intent(in) :: pair
    integer, intent(in) :: which(:)              !< index of the pair, 1, 2 ...; there are as many as the motion has mesh periods
    real(dp), intent(in) :: s(:), load(:), nominal
    real(dp) :: loss(size(s))
    integer :: i

    loss = load*abs(sliding_ratio(pair, s))/nominal
    factor = sum([((s(i + 1) - s(i))*(loss(i) + loss(i + 1))/2, i=1, size(s) - 1)], &
                 mask=[(which(i) == which(i + 1), i=1, size(s) - 1)])/maxval(which)
  end function followed_loss_factor

  !> H_v in closed form if all pairs in contact carry the same load, by Ohlendorf for contact ratios from 1 to 2 with the pitch
  !> point between B and D: pi (1/z1 + 1/z2) (1 - eps + eps1**2 + eps2**2), with the recess and approach parts eps1 and eps2 of the
  !> contact ratio eps. Source: ISO/TR 14179-2:2001, after Ohlendorf 1958.
  pure real(dp) function half_shares_factor(pair) result(factor)
    type(pair_t), intent(in) :: pair

    associate (parts => parts_of(pair))
      factor = pi*sum(1.0_dp/pair%gear%spec%teeth)*(1 - sum(parts) + sum(parts**2))
    end associate
  end function half_shares_factor

  !> H_v in closed form if a pair carries the same load all along its path, the static load over the contact ratio: pi (1/z1 + 1/z2)
  !> (eps1**2 + eps2**2)/eps, the inverse of the mesh mechanical advantage of ISO/TR 14179-1:2001.
  pure real(dp) function even_load_factor(pair) result(factor)
    type(pair_t), intent(in) :: pair

    associate (parts => parts_of(pair))
      factor = pi*sum(1.0_dp/pair%gear%spec%teeth)*sum(parts**2)/sum(parts)
    end associate
  end function even_load_factor

  !> Recess and approach parts of the contact ratio; one is below 0 if the pitch point lies outside the path.
  pure function parts_of(pair) result(parts)
    type(pair_t), intent(in) :: pair
    real(dp) :: parts(2), points(5)

    points = pair%points()
    parts = [pair%contact_ratio - points(3), points(3)]
  end function parts_of
end module gearsweep_rating_mesh_losses
