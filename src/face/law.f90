!> Compliance over the face width of spur gears: the displacement of each slice of a line of contact under a line load on any slice,
!> from the plane compliance of the tooth.
!>
!> A line load that varies along the face as w cos(k z) moves an endless gear by c(k) w cos(k z) (lengths in modules, compliance
!> times E/(1 - nu**2)). c(k) is the sum of a half space, of the tooth as a plate on an elastic foundation, and of the body that
!> neighbouring teeth share:
!>
!>     c(k) = (2/pi) (ln(4/a) + 1/2 - gamma - ln(k**2 + 1/D**2)/2) + c1/(1 + (k lam)**2 + (k lam)**4) + c12 exp(-(k lam_x)**2)
!>
!> with a the half width of Hertz's contact, gamma Euler's constant, c12 the plane displacement of the next tooth, and c1 such that
!> c(0) is the plane compliance. The constants D, lam, lam_x and those of the free end faces are fits to finite elements in three
!> dimensions: 17 to 100 teeth, face widths of 5 to 20 modules, profile shifts from -0.2 to 0.8, solid bodies.
!>
!> Integrals over slices are differences of P(r), whose second derivative is the kernel of a term and which is zero with its slope
!> at r = 0. A free end face is a mirror of the load; two further terms correct its stiffness.
module gearsweep_face_law
  use gearsweep_base, only: dp, pi
  implicit none
  private
  public :: face_law_t, make_face_law, graded_slices, root_spread, tooth_remainder

  real(dp), parameter :: euler = 0.5772156649015329_dp
  !> Length (modules) within which the half space spreads a load.
  real(dp), parameter :: depth = 2.15_dp
  !> Compliance that the half space has at k = 0 with a half width of one module, 1/E'.
  real(dp), parameter, public :: even_half_space = 2/pi*(2*log(2.0_dp) + 0.5_dp - euler + log(depth))
  !> Compliance of the tooth at its surface that the tooth's own length refers to, 1/E'.
  real(dp), parameter :: surface = 2.12_dp
  !> Stiffness of the end faces: their reach (modules) and strength, for the body behind them and for gradients of the load.
  real(dp), parameter :: end_reach = 4.5_dp, end_body = 0.009_dp, end_gradient = 0.4_dp
  !> Length (modules) over which the root stress spreads along the face, and the shear of its foundation.
  real(dp), parameter :: root_length = 1.24_dp, root_shear = 1.2_dp
  !> Width of the slices at ends and kinks, its increase per distance from them, and the largest width, in modules.
  real(dp), parameter :: narrow = 0.285_dp, growth = 0.4_dp, wide = 1

  !> Terms of one gear's compliance over slices; (slice, slice), integrated over both, in modules.
  type :: face_law_t
    real(dp), allocatable :: half_space(:, :)    !< with a half width of one module
    real(dp), allocatable :: tooth(:, :)         !< per c1
    real(dp), allocatable :: body(:, :)          !< per c12
    real(dp), allocatable :: ends(:, :)          !< per c1 + c12 + 2.12
  contains
    procedure :: of_tooth
  end type face_law_t

contains

  !> Computes the terms for slices between the ascending `bounds` (modules; first 0, last the face width), for a gear whose plane
  !> compliance without half space is `remainder` in the middle of the path (c1) and whose neighbouring teeth share `shared` (c12),
  !> both times E/(1 - nu**2).
  pure subroutine make_face_law(bounds, remainder, shared, law)
    real(dp), intent(in) :: bounds(0:), remainder, shared
    type(face_law_t), intent(out) :: law
    real(dp), allocatable :: apart(:, :), image(:, :, :)
    real(dp) :: length, reach
    integer :: n

    n = ubound(bounds, 1)
    length = 0.62_dp + 0.11_dp*(remainder + surface)
    reach = 1.5_dp + 1.1_dp*shared
    call find_distances(bounds, apart, image)
    law%half_space = over_slices(half_space(image(:, :, 1)) + half_space(image(:, :, 2)) - half_space(apart))
    law%tooth = over_slices(plate(image(:, :, 1), length, 1.0_dp) + plate(image(:, :, 2), length, 1.0_dp) &
                            - plate(apart, length, 1.0_dp))
    law%body = over_slices(body(image(:, :, 1), reach) + body(image(:, :, 2), reach) - body(apart, reach))
    law%ends = of_end(bounds) + of_end(bounds(n) - bounds)
  end subroutine make_face_law

  !> Term of the end face from which the `distance` (modules) of the slices' bounds counts; (slice, slice).
  pure function of_end(distance) result(term)
    real(dp), intent(in) :: distance(0:)
    real(dp) :: term(ubound(distance, 1), ubound(distance, 1))
    real(dp), dimension(ubound(distance, 1)) :: even, gradient
    integer :: j, n

    n = size(even)
    associate (y => distance)
      even = end_reach*sqrt(pi)/2*abs(erf(y(1:)/end_reach) - erf(y(:n - 1)/end_reach))
      gradient = y(1:)*exp(-y(1:)) - y(:n - 1)*exp(-y(:n - 1))
    end associate
    do j = 1, n
      term(:, j) = end_body*(even*even(j)) + end_gradient*(gradient*gradient(j))
    end do
  end function of_end

  !> Compliance of slices (modules) of a tooth with this c1 and c12, times E/(1 - nu**2).
  pure function of_tooth(law, remainder, shared) result(compliance)
    class(face_law_t), intent(in) :: law
    real(dp), intent(in) :: remainder, shared
    real(dp) :: compliance(size(law%ends, 1), size(law%ends, 2))

    compliance = law%half_space + remainder*law%tooth + shared*law%body + (remainder + shared + surface)*law%ends
  end function of_tooth

  !> Plane compliance of a tooth beyond those of half space and body, c1, from its `plane` compliance with a half width of one
  !> module and from what it shares with the next tooth; all times E/(1 - nu**2).
  elemental real(dp) function tooth_remainder(plane, shared) result(remainder)
    real(dp), intent(in) :: plane, shared

    remainder = plane - shared - even_half_space
  end function tooth_remainder

  !> Root stress of each slice per line load on a slice, relative to that under an even load; (slice, slice) with rows that add up
  !> to 1. It spreads along the face as the tooth's bending does: 1/(1 + 1.2 (1.24 k)**2 + (1.24 k)**4).
  pure function root_spread(bounds) result(spread)
    real(dp), intent(in) :: bounds(0:)           !< of the slices, modules
    real(dp) :: spread(ubound(bounds, 1), ubound(bounds, 1))
    real(dp), allocatable :: apart(:, :), image(:, :, :)
    integer :: i

    call find_distances(bounds, apart, image)
    spread = over_slices(plate(image(:, :, 1), root_length, root_shear) + plate(image(:, :, 2), root_length, root_shear) &
                         - plate(apart, root_length, root_shear))
    do i = 1, size(spread, 1)
      spread(i, :) = spread(i, :)/(bounds(i) - bounds(i - 1))
    end do
  end function root_spread

  !> Finds the distances between the bounds of slices, and between bounds and the images of bounds in the end faces; (bound, bound)
  !> and (bound, bound, end face).
  pure subroutine find_distances(bounds, apart, image)
    real(dp), intent(in) :: bounds(0:)
    real(dp), allocatable, intent(out) :: apart(:, :), image(:, :, :)
    integer :: i, n

    n = ubound(bounds, 1)
    allocate (apart(0:n, 0:n), image(0:n, 0:n, 2))
    do i = 0, n
      apart(:, i) = abs(bounds - bounds(i))
      image(:, i, 1) = bounds + bounds(i)
      image(:, i, 2) = (bounds(n) - bounds) + (bounds(n) - bounds(i))
    end do
  end subroutine find_distances

  !> Integrals over pairs of slices, (slice, slice), from second primitives at the distances of their bounds, (bound, bound): of
  !> images minus those of the slices themselves, as the distance to an image grows with both places.
  pure function over_slices(primitive) result(integral)
    real(dp), intent(in) :: primitive(0:, 0:)
    real(dp) :: integral(ubound(primitive, 1), ubound(primitive, 1))
    integer :: i, j

    do j = 1, size(integral, 1)
      do i = 1, j
        integral(i, j) = (primitive(i, j) - primitive(i, j - 1)) - (primitive(i - 1, j) - primitive(i - 1, j - 1))
        integral(j, i) = integral(i, j)
      end do
    end do
  end function over_slices

  !> Second primitive of the kernel of the half space with a half width of one module.
  elemental real(dp) function half_space(r)
    real(dp), intent(in) :: r

    half_space = even_half_space*r/2
    if (r > 0) half_space = half_space - (r*exponential_integral(r/depth) + depth*(1 - exp(-r/depth)))/pi
  end function half_space

  !> Second primitive of the kernel of the body, exp(-(k reach)**2).
  elemental real(dp) function body(r, reach)
    real(dp), intent(in) :: r, reach

    associate (t => r/(2*reach))
      body = r/2*erf(t) + reach/sqrt(pi)*(exp(-t**2) - 1)
    end associate
  end function body

  !> Second primitive of the kernel of a plate on an elastic foundation, 1/(1 + shear (k length)**2 + (k length)**4).
  elemental real(dp) function plate(r, length, shear)
    real(dp), intent(in) :: r, length, shear
    real(dp) :: p, q, t

    p = sqrt((2 + shear)/4)
    q = sqrt((2 - shear)/4)
    t = r/length
    plate = r/2 + length*((p/2 + shear/(8*p))*(exp(-p*t)*cos(q*t) - 1) - (q/2 - shear/(8*q))*exp(-p*t)*sin(q*t))
  end function plate

  !> Exponential integral E1(x) of x > 0. Source: Abramowitz, Stegun 1964, 5.1.11 and 5.1.22 (continued fraction).
  elemental real(dp) function exponential_integral(x) result(value)
    real(dp), intent(in) :: x
    real(dp), parameter :: rounding = 1e-17_dp, far = 700
    integer, parameter :: depth_of_fraction = 60
    real(dp) :: term
    integer :: n

    if (x > far) then
      value = 0
    else if (x > 1.5_dp) then
      value = 0
      do n = depth_of_fraction, 1, -1
        value = n/(1 + n/(x + value))
      end do
      value = exp(-x)/(x + value)
    else
      value = -euler - log(x)
      term = 1
      n = 0
      do while (abs(term) > rounding)
        n = n + 1
        term = -term*x/n
        value = value - term/n
      end do
    end if
  end function exponential_integral

  !> Bounds of slices over a face, symmetric about its middle, in the unit of `width`: narrow at the ends and at kinks of the gap,
  !> at most a module wide between them.
  pure function graded_slices(width, module, kinks, least, slices) result(bounds)
    real(dp), intent(in) :: width, module
    real(dp), intent(in) :: kinks(:)             !< distances from either end face; beyond the middle: none
    real(dp), intent(in) :: least                !< no slice is to be much narrower
    integer, intent(in) :: slices                !< about this number; 0: automatic
    real(dp), allocatable :: bounds(:)
    real(dp), allocatable :: fixed(:), half(:)
    real(dp) :: finest, refinement
    integer :: i, n

    finest = max(narrow, 0.8_dp*least/module)
    fixed = [0.0_dp]
    do i = 1, size(kinks)
      ! Kinks in no order: the next one inwards.
      associate (next => minval(kinks, mask=kinks > fixed(size(fixed)) + finest*module))
        if (next < width/2 - finest*module) fixed = [fixed, next]
      end associate
    end do
    fixed = [fixed, width/2]/module
    refinement = 1
    if (slices > 0) refinement = slices/(2*sum([(steps(fixed(i), fixed(i + 1), i == size(fixed) - 1), i=1, size(fixed) - 1)]))
    half = [0.0_dp]
    do i = 1, size(fixed) - 1
      associate (last => i == size(fixed) - 1)
        n = max(1, nint(refinement*steps(fixed(i), fixed(i + 1), last)))
        half = [half, places(fixed(i), fixed(i + 1), n, last)]
      end associate
    end do
    half = half*module
    n = size(half)
    bounds = [half, width - half(n - 1:1:-1)]

  contains

    !> Wanted width of a slice (modules) at a distance (modules) from the nearest end or kink.
    pure real(dp) function desired(distance)
      real(dp), intent(in) :: distance

      desired = min(max(wide, finest), finest + growth*distance)
    end function desired

    !> Number of slices of the wanted widths between two fixed bounds, not rounded. The middle of the face is no kink.
    pure real(dp) function steps(from, to, is_last)
      real(dp), intent(in) :: from, to
      logical, intent(in) :: is_last

      if (is_last) then
        steps = steps_within(to - from)
      else
        steps = 2*steps_within((to - from)/2)
      end if
    end function steps

    !> Number of slices of the wanted widths over a length (modules) from an end or kink: the integral of 1/desired.
    pure real(dp) function steps_within(length)
      real(dp), intent(in) :: length
      real(dp) :: turn

      turn = min(length, max(0.0_dp, wide - finest)/growth)
      steps_within = log(1 + growth*turn/finest)/growth + (length - turn)/desired(length)
    end function steps_within

    !> Ends of the `n` slices between the fixed bounds `from` and `to`: all are wider or narrower than wanted by the same factor.
    pure function places(from, to, n, is_last)
      real(dp), intent(in) :: from, to
      integer, intent(in) :: n
      logical, intent(in) :: is_last
      real(dp) :: places(n), half
      integer :: i

      half = (to - from)/2
      do i = 1, n - 1
        if (is_last) then
          places(i) = from + after(steps_within(to - from)*i/n)
        else if (2*i <= n) then
          places(i) = from + after(2*steps_within(half)*i/n)
        else
          places(i) = to - after(2*steps_within(half)*(n - i)/n)
        end if
      end do
      places(n) = to
    end function places

    !> Length (modules), from an end or kink, over this number of slices of the wanted widths: the inverse of `steps_within`.
    pure real(dp) function after(count)
      real(dp), intent(in) :: count
      real(dp) :: turn

      turn = max(0.0_dp, wide - finest)/growth
      associate (graded => log(1 + growth*turn/finest)/growth)
        if (count < graded) then
          after = finest*(exp(growth*count) - 1)/growth
        else
          after = turn + (count - graded)*max(wide, finest)
        end if
      end associate
    end function after
  end function graded_slices
end module gearsweep_face_law
