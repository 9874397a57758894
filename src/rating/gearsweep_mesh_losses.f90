!> What friction in the mesh costs: the mean coefficient of friction, and the loss factor H_v, which times that coefficient is
!> the part of the power that is lost.
module gearsweep_mesh_losses
  use gearsweep_flank, only: sliding_ratio
  use gearsweep_interval, only: interval_t
  use gearsweep_kinds, only: dp, pi
  use gearsweep_mesh, only: mesh_t
  use gearsweep_pair, only: pair_t
  use gearsweep_quadrature, only: gauss_legendre
  use gearsweep_segments, only: segment_t, smooth_segments
  use gearsweep_sharing, only: solve_equilibrium_at
  implicit none
  private
  public :: friction_rule_t, mean_friction, static_loss_factor, followed_loss_factor, half_shares_factor, even_load_factor

  type :: friction_rule_t
    real(dp) :: coefficient = -1                 !< as stated; below 0: by the formula
    real(dp) :: roughness = 0.5e-6_dp            !< arithmetic mean Ra of both flanks, m
    real(dp) :: oil_factor = 1                   !< X_L: 1 mineral oil
    real(dp) :: viscosity = 0.03_dp              !< dynamic, of the oil, Pa s
  end type friction_rule_t

  integer, parameter :: points = 12              !< of Gauss's rule on a panel

  !> Power lost per coefficient of friction and power, over the mesh phase.
  type :: integrand_t
    type(pair_t) :: pair
    type(mesh_t) :: mesh
    real(dp) :: load = 0                         !< N
    type(interval_t) :: interval
    real(dp) :: node(points) = 0, weight(points) = 0   !< on -1 to 1
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

  !> H_v under the static `load` (N) as stiffness and relief share it: the mean over the mesh period of the sum over the pairs
  !> of load times sliding speed, over the whole load and the speed of the base circles. Smooth segments are halved until both
  !> halves agree with the whole.
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
    ! Where a pair passes the pitch point, sliding changes its sign.
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

  !> Integral from phase a to b, of which `whole` is a first value.
  pure recursive real(dp) function refined(f, a, b, whole, halvings) result(total)
    type(integrand_t), intent(in) :: f
    real(dp), intent(in) :: a, b, whole
    integer, intent(in) :: halvings
    real(dp), parameter :: tolerance = 1e-14_dp
    real(dp) :: middle, left, right

    middle = (a + b)/2
    left = panel(f, a, middle)
    right = panel(f, middle, b)
    total = left + right
    if (abs(total - whole) <= tolerance*(b - a) .or. halvings == 0) return
    total = refined(f, a, middle, left, halvings - 1) + refined(f, middle, b, right, halvings - 1)
  end function refined

  !> The same by Gauss's rule.
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

  !> The same of a motion that was followed: `load` (N) of each pair at its path coordinates `s`, pair after pair, as in
  !> gearsweep_response; over the nominal load (N).
  pure real(dp) function followed_loss_factor(pair, which, s, load, nominal) result(factor)
    type(pair_t), intent(in) :: pair
    integer, intent(in) :: which(:)              !< 1, 2 ...: of as many pairs as the motion has mesh periods
    real(dp), intent(in) :: s(:), load(:), nominal
    real(dp) :: loss(size(s))
    integer :: i

    loss = load*abs(sliding_ratio(pair, s))/nominal
    factor = sum([((s(i + 1) - s(i))*(loss(i) + loss(i + 1))/2, i=1, size(s) - 1)], &
                 mask=[(which(i) == which(i + 1), i=1, size(s) - 1)])/maxval(which)
  end function followed_loss_factor

  !> H_v in closed form where all pairs in contact carry the same load, as Ohlendorf has it for contact ratios from 1 to 2 with
  !> the pitch point between B and D: pi (1/z1 + 1/z2) (1 - eps + eps1**2 + eps2**2), with the recess and approach parts
  !> eps1 and eps2 of the contact ratio eps. Source: ISO/TR 14179-2:2001, after Ohlendorf 1958.
  pure real(dp) function half_shares_factor(pair) result(factor)
    type(pair_t), intent(in) :: pair

    associate (parts => parts_of(pair))
      factor = pi*sum(1.0_dp/pair%gear%spec%teeth)*(1 - sum(parts) + sum(parts**2))
    end associate
  end function half_shares_factor

  !> H_v in closed form where a pair carries the same load all along its path, the whole one over the contact ratio:
  !> pi (1/z1 + 1/z2) (eps1**2 + eps2**2)/eps, the inverse of the mesh mechanical advantage of ISO/TR 14179-1:2001.
  pure real(dp) function even_load_factor(pair) result(factor)
    type(pair_t), intent(in) :: pair

    associate (parts => parts_of(pair))
      factor = pi*sum(1.0_dp/pair%gear%spec%teeth)*sum(parts**2)/sum(parts)
    end associate
  end function even_load_factor

  !> Parts of the contact ratio behind the pitch point and before it; one is below 0 where the pitch point lies off the path.
  pure function parts_of(pair) result(parts)
    type(pair_t), intent(in) :: pair
    real(dp) :: parts(2), points(5)

    points = pair%points()
    parts = [pair%contact_ratio - points(3), points(3)]
  end function parts_of
end module gearsweep_mesh_losses
