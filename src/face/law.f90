!> Compliance along the lines of contact of spur and helical gears: the displacement of each slice of a line under a line load on
!> any slice, from the plane compliance of the tooth.
!>
!> A line load that varies along the face as w cos(k z) moves an endless gear by c(k) w cos(k z) (lengths in modules, compliance
!> times E/(1 - nu**2)). c(k) is the sum of a half space, of the tooth as a plate on an elastic foundation, and of the body that
!> neighbouring teeth share:
!>
!>     c(k) = (2/pi) (ln(4/a) + 1/2 - gamma - ln(k**2 + 1/D**2)/2) + c1/(1 + (k lam)**2 + (k lam)**4) + c12 exp(-(k lam_x)**2)
!>
!> with a the half width of Hertz's contact, gamma Euler's constant, c12 the plane displacement of the next tooth, and c1 such that
!> c(0) is the plane compliance. The constants D, lam, lam_x and those of the free end faces are fits to finite elements in three
!> dimensions: 17 to 100 teeth, face widths of 5 to 20 modules, profile shifts from -0.2 to 0.8, solid bodies, helix angles to 30
!> degrees.
!>
!> Integrals over slices are differences of P(r), whose second derivative is the kernel of a term and which is zero with its slope
!> at r = 0. A free end face is a mirror of the load; two further terms correct its stiffness.
!>
!> On helical gears the lines are oblique, lengths count along the line, and the plane compliance is that of the virtual gear. c1
!> and c12 change along the line; between two slices their geometric mean acts. An end face where the loaded flank is acute is
!> softer than a right-angled one, one where it is obtuse stiffer. A line that ends inside the face needs no correction there, as
!> the tooth continues beyond it without a load.
module gearsweep_face_law
  use gearsweep_base, only: dp, pi
  implicit none
  private
  public :: face_law_t, line_law_t, make_face_law, graded_slices, make_oblique, mean_of, root_spread, tooth_remainder

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

  !> Exponents, per tangent of the helix angle, of the mirror images of half space and tooth in an acute end face, and of its
  !> stiffness for gradients of the load.
  real(dp), parameter :: acute_half_space = 3.3_dp, acute_tooth = 1, acute_gradient = 0.7_dp
  !> Relative increase of c1 and c12 by oblique lines, per squared tangent of the helix angle.
  real(dp), parameter :: oblique = 0.15_dp

  !> One gear's compliance along lines of contact: second primitives of each kernel at the distances between bounds of slices, those
  !> of the images in both end faces minus those of the slices themselves; (bound, bound), in modules.
  type :: face_law_t
    !> Distances along the line from the end face z = 0, modules; in any order, the largest that of the other end face.
    real(dp), allocatable :: bounds(:)
    real(dp) :: tilt = 0                         !< tangent of the helix angle, positive: acute at z = 0; 0: a spur gear
    real(dp) :: tooth_length = 0, body_length = 0  !< lam and lam_x, modules
    real(dp), allocatable :: half_space(:, :)    !< with a half width of one module
    real(dp), allocatable :: tooth(:, :)         !< per c1
    real(dp), allocatable :: body(:, :)          !< per c12
  contains
    procedure :: add_bounds
    procedure :: of_line
    procedure :: between
  end type face_law_t

  !> Terms of one gear's compliance over the slices of one line; (slice, slice), integrated over both, in modules.
  type :: line_law_t
    real(dp), allocatable :: half_space(:, :)    !< with a half width of one module
    real(dp), allocatable :: tooth(:, :)         !< per c1
    real(dp), allocatable :: body(:, :)          !< per c12
    real(dp), allocatable :: ends(:, :)          !< per c1 + c12 + 2.12
  contains
    procedure :: of_tooth
  end type line_law_t

contains

  !> Makes the law for bounds of slices that ascend from 0 to the length of a line over the whole face (modules), for a gear whose
  !> plane compliance without half space is `remainder` in the middle of the path (c1) and whose neighbouring teeth share `shared`
  !> (c12), both times E/(1 - nu**2).
  pure subroutine make_face_law(bounds, remainder, shared, law, tilt)
    real(dp), intent(in) :: bounds(0:), remainder, shared
    type(face_law_t), intent(out) :: law
    real(dp), intent(in), optional :: tilt       !< as of face_law_t; absent: 0

    if (present(tilt)) law%tilt = tilt
    law%tooth_length = 0.62_dp + 0.11_dp*(remainder + surface)
    law%body_length = 1.5_dp + 1.1_dp*shared
    allocate (law%bounds(0), law%half_space(0, 0), law%tooth(0, 0), law%body(0, 0))
    call law%add_bounds(bounds)
  end subroutine make_face_law

  !> Adds bounds of slices (modules), after those that the law has.
  pure subroutine add_bounds(law, bounds)
    class(face_law_t), intent(inout) :: law
    real(dp), intent(in) :: bounds(:)
    real(dp) :: length
    integer :: before, n, j

    before = size(law%bounds)
    law%bounds = [law%bounds, bounds]
    n = size(law%bounds)
    call enlarge(law%half_space)
    call enlarge(law%tooth)
    call enlarge(law%body)
    length = maxval(law%bounds)
    do j = before + 1, n
      associate (at => law%bounds(j), others => law%bounds(:j))
        associate (apart => abs(others - at), near => others + at, far => (length - others) + (length - at))
          law%half_space(:j, j) = exp(acute_half_space*law%tilt)*half_space(near) &
                                  + exp(-acute_half_space*law%tilt)*half_space(far) - half_space(apart)
          law%tooth(:j, j) = exp(acute_tooth*law%tilt)*plate(near, law%tooth_length, 1.0_dp) &
                             + exp(-acute_tooth*law%tilt)*plate(far, law%tooth_length, 1.0_dp) &
                             - plate(apart, law%tooth_length, 1.0_dp)
          law%body(:j, j) = body(near, law%body_length) + body(far, law%body_length) - body(apart, law%body_length)
        end associate
      end associate
      law%half_space(j, :j) = law%half_space(:j, j)
      law%tooth(j, :j) = law%tooth(:j, j)
      law%body(j, :j) = law%body(:j, j)
    end do

  contains

    pure subroutine enlarge(table)
      real(dp), allocatable, intent(inout) :: table(:, :)
      real(dp), allocatable :: known(:, :)

      call move_alloc(table, known)
      allocate (table(n, n))
      table(:before, :before) = known
    end subroutine enlarge
  end subroutine add_bounds

  !> Terms over the slices of one line. `list`: indices of their bounds in the law, along the line.
  pure type(line_law_t) function of_line(law, list) result(line)
    class(face_law_t), intent(in) :: law
    integer, intent(in) :: list(:)
    real(dp), dimension(size(list)) :: y, primitive  ! y: distances from an end face
    real(dp), dimension(size(list) - 1) :: even, gradient
    integer :: end, j, n

    n = size(list) - 1
    line%half_space = over_slices(law%half_space(list, list))
    line%tooth = over_slices(law%tooth(list, list))
    line%body = over_slices(law%body(list, list))
    allocate (line%ends(n, n), source=0.0_dp)
    do end = 1, 2
      y = law%bounds(list)
      if (end == 2) y = maxval(law%bounds) - y
      primitive = erf(y/end_reach)
      even = end_reach*sqrt(pi)/2*abs(primitive(2:) - primitive(:n))
      primitive = y*exp(-y)
      gradient = primitive(2:) - primitive(:n)
      associate (steep => end_gradient*exp(merge(acute_gradient, -acute_gradient, end == 1)*law%tilt))
        do j = 1, n
          line%ends(:, j) = line%ends(:, j) + (end_body*(even*even(j)) + steep*(gradient*gradient(j)))
        end do
      end associate
    end do
  end function of_line

  !> Term per c12 between the slices of two lines; (slice of the one, slice of the other).
  pure function between(law, list, other) result(term)
    class(face_law_t), intent(in) :: law
    integer, intent(in) :: list(:), other(:)     !< as of `of_line`
    real(dp) :: term(size(list) - 1, size(other) - 1)

    term = over_slices(law%body(list, other))
  end function between

  !> Compliance over the slices (modules) of a line where the tooth has this c1 and c12, times E/(1 - nu**2).
  pure function of_tooth(line, remainder, shared) result(compliance)
    class(line_law_t), intent(in) :: line
    real(dp), intent(in) :: remainder(:), shared(:)        !< (slice)
    real(dp) :: compliance(size(line%ends, 1), size(line%ends, 2))
    integer :: j

    do j = 1, size(remainder)
      compliance(:, j) = line%half_space(:, j) + mean_of(remainder, remainder(j))*line%tooth(:, j) &
                         + mean_of(shared, shared(j))*line%body(:, j) &
                         + mean_of(remainder + shared + surface, remainder(j) + shared(j) + surface)*line%ends(:, j)
    end do
  end function of_tooth

  !> Geometric mean, which is exact for equal numbers; with the sign of the first.
  elemental real(dp) function mean_of(a, b) result(mean)
    real(dp), intent(in) :: a, b

    mean = sign(sqrt(max(0.0_dp, a*b)), a)
  end function mean_of

  !> Raises c1 and c12 (times E/(1 - nu**2)) of the virtual gear for oblique lines at this tangent of the helix angle.
  elemental subroutine make_oblique(tilt, remainder, shared)
    real(dp), intent(in) :: tilt
    real(dp), intent(inout) :: remainder, shared

    remainder = remainder + oblique*tilt**2*(remainder + surface)
    shared = shared + oblique*tilt**2*shared
  end subroutine make_oblique

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
    real(dp) :: primitive(0:ubound(bounds, 1), 0:ubound(bounds, 1))
    integer :: i, n

    n = ubound(bounds, 1)
    do i = 0, n
      primitive(:, i) = plate(bounds + bounds(i), root_length, root_shear) &
                        + plate((bounds(n) - bounds) + (bounds(n) - bounds(i)), root_length, root_shear) &
                        - plate(abs(bounds - bounds(i)), root_length, root_shear)
    end do
    spread = over_slices(primitive)
    do i = 1, size(spread, 1)
      spread(i, :) = spread(i, :)/(bounds(i) - bounds(i - 1))
    end do
  end function root_spread

  !> Integrals over pairs of slices, (slice, slice), from second primitives at the distances of their bounds, (bound, bound): of
  !> images minus those of the slices themselves, as the distance to an image grows with both places.
  pure function over_slices(primitive) result(integral)
    real(dp), intent(in) :: primitive(0:, 0:)
    real(dp) :: integral(ubound(primitive, 1), ubound(primitive, 2))
    integer :: i, j

    do j = 1, size(integral, 2)
      do i = 1, size(integral, 1)
        ! In this order symmetric to the last bit for a symmetric primitive.
        if (i <= j) then
          integral(i, j) = (primitive(i, j) - primitive(i, j - 1)) - (primitive(i - 1, j) - primitive(i - 1, j - 1))
        else
          integral(i, j) = (primitive(i, j) - primitive(i - 1, j)) - (primitive(i, j - 1) - primitive(i - 1, j - 1))
        end if
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
