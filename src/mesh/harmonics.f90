!> Harmonics of the static transmission error, which excite gear whine.
!>
!> Over the time tau in mesh periods, x = mean + sum of amplitude(k) cos(2 pi k tau + phase(k)) or, with another base than the mesh
!> frequency, of amplitude(k) cos(2 pi k base tau + phase(k)).
!> Where pairs enter and leave, x jumps, and where one separates it has a kink, so that the transform of n samples has an error of
!> the order 1/n or 1/n^2. Here every smooth segment is integrated by itself.
module gearsweep_mesh_harmonics
  use gearsweep_base, only: dp, gauss_legendre, pi
  use gearsweep_mesh_deviations, only: interval_t
  use gearsweep_mesh_mesh, only: mesh_t
  use gearsweep_mesh_sharing, only: balance_t, carrying, segment_t, smooth_segments, solve_equilibrium_at
  use gearsweep_mesh_smooth_intervals, only: smooth_intervals
  implicit none
  private
  public :: harmonics_t, find_harmonics, find_orders, static_range

  type :: harmonics_t
    real(dp) :: mean = 0                         !< mean of the static transmission error, m
    real(dp) :: rms = 0                          !< root mean square of its deviation from the mean, m
    real(dp) :: least = 0, largest = 0           !< m
    real(dp), allocatable :: amplitude(:)        !< amplitude of harmonics 1, 2 ..., m
    real(dp), allocatable :: phase(:)            !< rad, at time 0, when a pair enters at A
    real(dp) :: error_estimate = 0               !< estimate for mean and amplitudes, m
    !> Length of the path, in base pitches, over which a pair carries load: the mean number of loaded pairs.
    real(dp) :: effective_contact_ratio = 0
    integer :: samples = 0                       !< samples of the transmission error in the integrals
  contains
    procedure :: peak_to_peak
  end type harmonics_t

  integer, parameter :: most_halvings = 16

  !> Integrand: the pairs' part of the transmission error over its scale, minus 1; the part due to the turning of the discs is
  !> constant.
  type :: integrand_t
    type(mesh_t) :: mesh
    real(dp) :: load = 0, scale = 1
    integer, allocatable :: count(:)             !< harmonics of each series
    real(dp), allocatable :: base(:)             !< cycles of its first harmonic in a mesh period
    integer :: points = 16                       !< points of Gauss's rule on a panel
    real(dp), allocatable :: node(:), weight(:)  !< nodes and weights on 0 to 1
    real(dp) :: tolerance = 0                    !< of the integrals over a mesh period
    real(dp) :: negligible = 0                   !< disagreement in a panel that is accepted whatever its length
    integer :: halvings = most_halvings
  end type integrand_t

contains

  !> Computes the first `count` harmonics of the static transmission error of `mesh` under `load` (N). Segments are halved, at
  !> most `halvings` times, until the integrals over both halves agree with that over the segment.
  pure subroutine find_harmonics(mesh, load, count, harmonics, halvings)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: load
    integer, intent(in) :: count
    type(harmonics_t), intent(out) :: harmonics
    integer, intent(in), optional :: halvings
    type(harmonics_t) :: series(1)
    type(integrand_t) :: f

    f = integrand_t(mesh, load, count=[count], base=[1.0_dp])
    if (present(halvings)) f%halvings = halvings
    ! Rounding errors of the phase grow with the harmonic.
    f%tolerance = 1e-13_dp + 4e-15_dp*count
    call integrate(f, series)
    harmonics = series(1)
  end subroutine find_harmonics

  !> Computes several series of orders of the static transmission error at once, as of both gears whose teeth deviate, to about
  !> 1e-9 of the largest transmission error. Where a pair begins to carry, its flattening has no Taylor series, and each halving
  !> of a panel only quarters the error there: over a turn more would cost too much.
  pure subroutine find_orders(mesh, load, count, base, harmonics)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: load                 !< N
    integer, intent(in) :: count(:)              !< harmonics of each series
    !> Cycles of the first harmonic of each series in a mesh period. Only harmonics with a whole number of cycles in the periods
    !> after which the deviations repeat are meaningful.
    real(dp), intent(in) :: base(:)
    type(harmonics_t), intent(out) :: harmonics(:)         !< (series)
    real(dp), parameter :: negligible = 1e-9_dp
    integer, parameter :: points = 4
    type(integrand_t) :: f

    f = integrand_t(mesh, load, count=count, base=base, points=points, negligible=negligible)
    call integrate(f, harmonics)
  end subroutine find_orders

  !> Integrates each series of `f`.
  pure subroutine integrate(f, harmonics)
    type(integrand_t), intent(inout) :: f
    type(harmonics_t), intent(out) :: harmonics(:)         !< (series)
    type(interval_t), allocatable :: intervals(:)
    type(segment_t), allocatable :: segments(:)
    complex(dp), dimension(-1:sum(f%count)) :: total, undivided
    type(harmonics_t) :: all
    integer :: i, first, last

    call smooth_segments(f%mesh, f%load, intervals, segments)
    allocate (f%node(f%points), f%weight(f%points))
    call gauss_legendre(f%node, f%weight)
    f%node = (1 + f%node)/2
    f%weight = f%weight/2
    f%scale = maxval([(error_at(f, intervals(segments(i)%interval), segments(i)%first), i=1, size(segments))])
    call find_range(f, intervals, all%least, all%largest)
    total = 0
    do i = 1, size(segments)
      associate (interval => intervals(segments(i)%interval), a => segments(i)%first, b => segments(i)%last)
        undivided = panel(f, interval, a, b)
        call refine(f, interval, a, b, undivided, f%halvings, total, all)
        all%effective_contact_ratio = all%effective_contact_ratio + &
                                      (b - a)*sum(merge(1, 0, carrying(f%mesh, balance_t(f%load), interval, (a + b)/2)))
      end associate
    end do
    total = total/f%mesh%deviations%periods
    all%effective_contact_ratio = all%effective_contact_ratio/f%mesh%deviations%periods
    associate (discs => f%mesh%disc%turn*f%load)
      all%mean = f%scale*(1 + real(total(0), dp)) + discs
      all%least = all%least + discs
      all%largest = all%largest + discs
    end associate
    all%rms = f%scale*sqrt(max(0.0_dp, real(total(-1), dp) - real(total(0), dp)**2))
    all%error_estimate = 2*f%scale*all%error_estimate/f%mesh%deviations%periods
    all%samples = all%samples + f%points*size(segments)
    last = 0
    do i = 1, size(harmonics)
      first = last + 1
      last = last + f%count(i)
      harmonics(i) = all
      harmonics(i)%amplitude = 2*f%scale*abs(total(first:last))
      harmonics(i)%phase = atan2(aimag(total(first:last)), real(total(first:last), dp))
    end do
  end subroutine integrate

  !> Largest minus least static transmission error (m) of `mesh` under `load` (N), without the slower integrals.
  pure real(dp) function static_range(mesh, load)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: load
    type(integrand_t) :: f
    real(dp) :: least, largest

    f%mesh = mesh
    f%load = load
    call find_range(f, smooth_intervals(mesh, .false.), least, largest)
    static_range = largest - least
  end function static_range

  pure real(dp) function peak_to_peak(self)
    class(harmonics_t), intent(in) :: self

    peak_to_peak = self%largest - self%least
  end function peak_to_peak

  !> Static transmission error of the pairs, without the turning of discs, m.
  pure real(dp) function error_at(f, interval, phase)
    type(integrand_t), intent(in) :: f
    type(interval_t), intent(in) :: interval
    real(dp), intent(in) :: phase
    real(dp) :: force(interval%pairs)

    call solve_equilibrium_at(f%mesh, interval, f%load, phase, error_at, force)
  end function error_at

  !> Integrals from phase a to b by Gauss's rule: of x**2 in part(-1), of x in part(0), and of x exp(-2 pi i k base tau) for the
  !> harmonics k of each series, one series after the other.
  pure function panel(f, interval, a, b) result(part)
    type(integrand_t), intent(in) :: f
    type(interval_t), intent(in) :: interval
    real(dp), intent(in) :: a, b
    complex(dp) :: part(-1:sum(f%count))
    complex(dp), dimension(f%points) :: turn, term
    real(dp), dimension(f%points) :: phase, x, weight
    integer :: i, k, n

    phase = a + (b - a)*f%node
    weight = (b - a)*f%weight
    x = [(error_at(f, interval, phase(i)), i=1, f%points)]/f%scale - 1
    part(-1) = sum(weight*x**2)
    part(0) = sum(weight*x)
    n = 0
    do i = 1, size(f%count)
      turn = exp(cmplx(0.0_dp, -2*pi*modulo(f%base(i)*(interval%period + phase), 1.0_dp), dp))
      term = weight*x
      do k = 1, f%count(i)
        term = term*turn
        n = n + 1
        part(n) = sum(term)
      end do
    end do
  end function panel

  !> Adds the integrals from a to b to `total`: those of the halves if their sum agrees with `undivided`, else after further
  !> halving. Adds the disagreement to the error estimate of `harmonics`.
  pure recursive subroutine refine(f, interval, a, b, undivided, halvings, total, harmonics)
    type(integrand_t), intent(in) :: f
    type(interval_t), intent(in) :: interval
    real(dp), intent(in) :: a, b
    complex(dp), intent(in) :: undivided(-1:)
    integer, intent(in) :: halvings
    complex(dp), intent(inout) :: total(-1:)
    type(harmonics_t), intent(inout) :: harmonics
    complex(dp), dimension(-1:ubound(undivided, 1)) :: left, right
    real(dp) :: off

    associate (middle => (a + b)/2)
      left = panel(f, interval, a, middle)
      right = panel(f, interval, middle, b)
      off = maxval(abs(undivided - left - right))
      harmonics%samples = harmonics%samples + 2*f%points
      if (off <= max(f%tolerance*(b - a), f%negligible) .or. halvings == 0) then
        total = total + left + right
        harmonics%error_estimate = harmonics%error_estimate + off
      else
        call refine(f, interval, a, middle, left, halvings - 1, total, harmonics)
        call refine(f, interval, middle, b, right, halvings - 1, total, harmonics)
      end if
    end associate
  end subroutine refine

  !> Finds the least and the largest static transmission error of the pairs, m. The smooth intervals are sampled; extremes that
  !> may exceed the outermost samples are located, also at kinks, where a pair begins or ceases to carry.
  pure subroutine find_range(f, intervals, least, largest)
    type(integrand_t), intent(in) :: f
    type(interval_t), intent(in) :: intervals(:)
    real(dp), intent(out) :: least, largest
    real(dp), parameter :: samples = 48, of_wave = 16      ! samples of a mesh period, and of a wave of a flank
    real(dp), allocatable :: x(:, :)
    real(dp) :: per_period, outermost(2)
    integer, allocatable :: steps(:)
    integer :: i, k, way

    per_period = samples
    associate (of => f%mesh%deviations)
      if (of%any()) per_period = per_period + of_wave*maxval([0.0_dp, of%waves%order/real(of%teeth(of%waves%gear), dp)])
    end associate
    steps = 4 + nint(per_period*(intervals%last - intervals%first))
    allocate (x(0:maxval(steps), size(intervals)))
    do i = 1, size(intervals)
      x(:steps(i), i) = [(error_at(f, intervals(i), phase(i, k)), k=0, steps(i))]
      x(steps(i) + 1:, i) = x(0, i)
    end do
    do way = 1, 2
      ! The least is the largest of the negative.
      if (way == 2) x = -x
      outermost(way) = maxval(x)
      do i = 1, size(intervals)
        do k = 0, steps(i)
          associate (before => max(0, k - 1), after => min(steps(i), k + 1))
            if (x(k, i) < max(x(before, i), x(after, i)) .or. &
                2*x(k, i) - min(x(before, i), x(after, i)) <= outermost(way)) cycle
            outermost(way) = max(outermost(way), summit(f, intervals(i), phase(i, before), phase(i, after), 3 - 2*way))
          end associate
        end do
      end do
    end do
    largest = outermost(1)
    least = -outermost(2)

  contains

    pure real(dp) function phase(i, k)
      integer, intent(in) :: i, k

      phase = intervals(i)%first + (intervals(i)%last - intervals(i)%first)*k/steps(i)
    end function phase
  end subroutine find_range

  !> Largest value of way*x between two phases with one maximum between them, by golden section.
  pure real(dp) function summit(f, interval, first, last, way)
    type(integrand_t), intent(in) :: f
    type(interval_t), intent(in) :: interval
    real(dp), intent(in) :: first, last
    integer, intent(in) :: way
    real(dp), parameter :: golden = (sqrt(5.0_dp) - 1)/2
    integer, parameter :: cuts = 40
    real(dp) :: a, b, inner(2), x(2)
    integer :: i

    a = first
    b = last
    inner = [b - golden*(b - a), a + golden*(b - a)]
    x = way*[error_at(f, interval, inner(1)), error_at(f, interval, inner(2))]
    do i = 1, cuts
      if (x(1) > x(2)) then
        b = inner(2)
        inner = [b - golden*(b - a), inner(1)]
        x = [way*error_at(f, interval, inner(1)), x(1)]
      else
        a = inner(1)
        inner = [inner(2), a + golden*(b - a)]
        x = [x(2), way*error_at(f, interval, inner(2))]
      end if
    end do
    summit = maxval(x)
  end function summit
end module gearsweep_mesh_harmonics
