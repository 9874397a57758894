!> Piecewise polynomials: the only form of stiffness and profile error along the path of contact, for all models.
module gearsweep_base_piecewise
  use gearsweep_base_bracket, only: bracket_t
  use gearsweep_base_kinds, only: dp, pi
  implicit none
  private
  public :: piecewise_t, polynomial, interpolated, joined, spline, constant

  !> Piecewise polynomial: on piece i, between breaks(i) and breaks(i+1), the value is sum_k coef(k,i) v**k, with v running from
  !> -1 to 1 over the piece.
  type :: piecewise_t
    real(dp), allocatable :: breaks(:)
    real(dp), allocatable :: coef(:, :)
  contains
    procedure :: locate
    procedure :: value
    procedure :: slope
    procedure :: sample
    procedure :: integral
    procedure :: minimum
    procedure :: maximum
    procedure :: scaled
    procedure :: is_smooth_at
  end type piecewise_t

contains

  !> Single polynomial over [first, last], `coefficients` in ascending powers of u = -1 at `first` ... 1 at `last`.
  pure function polynomial(first, last, coefficients) result(p)
    real(dp), intent(in) :: first, last, coefficients(:)
    type(piecewise_t) :: p

    allocate (p%breaks, source=[first, last])
    allocate (p%coef(0:size(coefficients) - 1, 1))
    p%coef(:, 1) = coefficients
  end function polynomial

  pure function constant(first, last, level) result(p)
    real(dp), intent(in) :: first, last, level
    type(piecewise_t) :: p

    p = polynomial(first, last, [level])
  end function constant

  !> Cubic spline through (x, y), x ascending, at least two points; the third derivative is continuous at the last but one knots
  !> (not-a-knot), so cubics are reproduced exactly. Two points result in a line, three in a parabola.
  pure function spline(x, y) result(p)
    real(dp), intent(in) :: x(:), y(:)
    type(piecewise_t) :: p
    real(dp) :: slopes(size(x)), h, secant
    integer :: i, n

    n = size(x)
    slopes = knot_slopes(x, y)
    allocate (p%breaks, source=x)
    allocate (p%coef(0:3, n - 1))
    do i = 1, n - 1
      h = (x(i + 1) - x(i))/2
      secant = (y(i + 1) - y(i))/2
      associate (dl => h*slopes(i), dr => h*slopes(i + 1))
        p%coef(0, i) = (y(i) + y(i + 1))/2 + (dl - dr)/4
        p%coef(1, i) = secant + (secant - (dl + dr)/2)/2
        p%coef(2, i) = (dr - dl)/4
        p%coef(3, i) = ((dl + dr)/2 - secant)/2
      end associate
    end do
  end function spline

  !> Slopes at the knots that make the second derivative continuous.
  pure function knot_slopes(x, y) result(m)
    real(dp), intent(in) :: x(:), y(:)
    real(dp) :: m(size(x))
    real(dp), dimension(size(x)) :: lower, diagonal, upper
    real(dp) :: h(size(x) - 1), s(size(x) - 1), factor
    integer :: i, n

    n = size(x)
    h = x(2:) - x(:n - 1)
    s = (y(2:) - y(:n - 1))/h
    select case (n)
    case (2)
      m = s(1)
    case (3)
      m(2) = (h(2)*s(1) + h(1)*s(2))/(h(1) + h(2))
      m(1) = 2*s(1) - m(2)
      m(3) = 2*s(2) - m(2)
    case default
      diagonal(1) = h(2)
      upper(1) = h(1) + h(2)
      m(1) = ((h(1) + 2*upper(1))*h(2)*s(1) + h(1)**2*s(2))/upper(1)
      do i = 2, n - 1
        lower(i) = h(i)
        diagonal(i) = 2*(h(i - 1) + h(i))
        upper(i) = h(i - 1)
        m(i) = 3*(h(i)*s(i - 1) + h(i - 1)*s(i))
      end do
      lower(n) = h(n - 2) + h(n - 1)
      diagonal(n) = h(n - 2)
      m(n) = ((h(n - 1) + 2*lower(n))*h(n - 2)*s(n - 1) + h(n - 1)**2*s(n - 2))/lower(n)
      do i = 2, n
        factor = lower(i)/diagonal(i - 1)
        diagonal(i) = diagonal(i) - factor*upper(i - 1)
        m(i) = m(i) - factor*m(i - 1)
      end do
      m(n) = m(n)/diagonal(n)
      do i = n - 1, 1, -1
        m(i) = (m(i) - upper(i)*m(i + 1))/diagonal(i)
      end do
    end select
  end function knot_slopes

  !> Index of the piece that contains x; beyond the ends the first or last one, or of those `among`.
  pure integer function locate(p, x, among) result(piece)
    class(piecewise_t), intent(in) :: p
    real(dp), intent(in) :: x
    integer, intent(in), optional :: among(2)    !< first and last piece considered
    integer :: low, high

    low = 1
    high = size(p%breaks)
    if (present(among)) then
      low = among(1)
      high = among(2) + 1
    end if
    do while (high - low > 1)
      piece = (low + high)/2
      if (x < p%breaks(piece)) then
        high = piece
      else
        low = piece
      end if
    end do
    piece = low
  end function locate

  !> Value at x. At a jump, `piece` selects the side.
  pure real(dp) function value(p, x, piece)
    class(piecewise_t), intent(in) :: p
    real(dp), intent(in) :: x
    integer, intent(in), optional :: piece
    real(dp) :: v
    integer :: i, k

    i = chosen(p, x, piece)
    v = (2*x - p%breaks(i) - p%breaks(i + 1))/(p%breaks(i + 1) - p%breaks(i))
    value = 0
    do k = ubound(p%coef, 1), lbound(p%coef, 1), -1
      value = value*v + p%coef(k, i)
    end do
  end function value

  !> First derivative at x. At a kink, `piece` selects the side.
  pure real(dp) function slope(p, x, piece)
    class(piecewise_t), intent(in) :: p
    real(dp), intent(in) :: x
    integer, intent(in), optional :: piece
    real(dp) :: v, width
    integer :: i, k

    i = chosen(p, x, piece)
    width = p%breaks(i + 1) - p%breaks(i)
    v = (2*x - p%breaks(i) - p%breaks(i + 1))/width
    slope = 0
    do k = ubound(p%coef, 1), lbound(p%coef, 1) + 1, -1
      slope = slope*v + (k - lbound(p%coef, 1))*p%coef(k, i)
    end do
    slope = slope*2/width
  end function slope

  !> Evaluates the curve at ascending `x`, and optionally its first and second derivatives, each by the piece of `among` that
  !> contains the place: the first or last one beyond their ends.
  pure subroutine sample(p, x, among, f, slope, curvature)
    class(piecewise_t), intent(in) :: p
    real(dp), intent(in) :: x(:)
    integer, intent(in) :: among(2)              !< first and last piece considered
    real(dp), intent(out), contiguous :: f(:)
    real(dp), intent(out), contiguous, optional :: slope(:), curvature(:)
    ! Number of places evaluated at once, whose coordinates in the piece need no allocated memory.
    integer, parameter :: most = 64
    real(dp) :: v(most), scale
    integer :: i, k, first, last

    last = 0
    i = p%locate(x(1), among)
    do while (last < size(x))
      first = last + 1
      last = min(size(x), last + most)
      if (i < among(2)) then
        do while (i < among(2) .and. x(first) >= p%breaks(i + 1))
          i = i + 1
        end do
        if (i < among(2)) last = first - 1 + count(x(first:last) < p%breaks(i + 1))
      end if
      associate (left => p%breaks(i), right => p%breaks(i + 1))
        do k = first, last
          v(k - first + 1) = (2*x(k) - left - right)/(right - left)
        end do
        scale = 2/(right - left)
      end associate
      associate (n => last - first + 1)
        call evaluate(p%coef(:, i), v(:n), 0, 1.0_dp, f(first:last))
        if (present(slope)) call evaluate(p%coef(:, i), v(:n), 1, scale, slope(first:last))
        if (present(curvature)) call evaluate(p%coef(:, i), v(:n), 2, scale**2, curvature(first:last))
      end associate
    end do
  end subroutine sample

  !> Evaluates a polynomial (order 0), or its first or second derivative, with coefficients times `scale`.
  pure subroutine evaluate(coef, v, order, scale, f)
    real(dp), intent(in), contiguous :: coef(0:), v(:)
    integer, intent(in) :: order
    real(dp), intent(in) :: scale
    real(dp), intent(out), contiguous :: f(:)
    real(dp) :: factor
    integer :: k

    f = 0
    do k = ubound(coef, 1), order, -1
      factor = coef(k)*scale
      if (order > 0) factor = factor*k
      if (order > 1) factor = factor*(k - 1)
      f = f*v + factor
    end do
  end subroutine evaluate

  pure integer function chosen(p, x, piece)
    type(piecewise_t), intent(in) :: p
    real(dp), intent(in) :: x
    integer, intent(in), optional :: piece

    if (present(piece)) then
      chosen = piece
    else
      chosen = p%locate(x)
    end if
  end function chosen

  !> Integral from `first` to `last`, exact.
  pure real(dp) function integral(p, first, last)
    class(piecewise_t), intent(in) :: p
    real(dp), intent(in) :: first, last
    real(dp) :: centre, half, left, right
    integer :: i, k, degree

    integral = 0
    do i = p%locate(first), p%locate(last)
      centre = (p%breaks(i) + p%breaks(i + 1))/2
      half = (p%breaks(i + 1) - p%breaks(i))/2
      left = -1
      right = 1
      if (i == p%locate(first)) left = (first - centre)/half
      if (i == p%locate(last)) right = (last - centre)/half
      do k = lbound(p%coef, 1), ubound(p%coef, 1)
        degree = k - lbound(p%coef, 1) + 1
        integral = integral + half*p%coef(k, i)*(right**degree - left**degree)/degree
      end do
    end do
  end function integral

  !> Smallest value over all pieces.
  pure real(dp) function minimum(p)
    class(piecewise_t), intent(in) :: p

    minimum = -maximum(p%scaled(-1.0_dp))
  end function minimum

  !> Largest value over all pieces.
  pure real(dp) function maximum(p)
    class(piecewise_t), intent(in) :: p
    real(dp), allocatable :: v(:)
    integer :: i, k

    maximum = -huge(maximum)
    do i = 1, size(p%coef, 2)
      v = turning_points(p%coef(:, i))
      do k = 1, size(v)
        maximum = max(maximum, horner(p%coef(:, i), v(k)))
      end do
    end do
  end function maximum

  !> Points of [-1, 1], including its ends, between which the polynomial with these coefficients is monotone: the roots of its
  !> slope, which lie between the turning points of the slope.
  pure recursive function turning_points(coef) result(points)
    real(dp), intent(in) :: coef(0:)
    real(dp), allocatable :: points(:)
    real(dp), allocatable :: slope(:), ends(:)
    type(bracket_t) :: zero
    integer :: i, k

    points = [-1.0_dp, 1.0_dp]
    if (size(coef) <= 2) return
    slope = [(k*coef(k), k=1, ubound(coef, 1))]
    ends = turning_points(slope)
    points = [-1.0_dp]
    do i = 1, size(ends) - 1
      if (horner(slope, ends(i)) < 0 .neqv. horner(slope, ends(i + 1)) < 0) then
        zero = bracket_t(ends(i), ends(i + 1))
        do while (zero%is_open())
          call zero%halve(horner(slope, zero%middle()) < 0 .eqv. horner(slope, ends(i)) < 0)
        end do
        points = [points, zero%middle()]
      end if
    end do
    points = [points, 1.0_dp]
  end function turning_points

  pure real(dp) function horner(coef, v)
    real(dp), intent(in) :: coef(:), v
    integer :: k

    horner = 0
    do k = size(coef), 1, -1
      horner = horner*v + coef(k)
    end do
  end function horner

  !> True if value, slope and second derivative are continuous at break i, which is not an end. Their jumps are rounding then.
  pure logical function is_smooth_at(p, i) result(smooth)
    class(piecewise_t), intent(in) :: p
    integer, intent(in) :: i
    real(dp), parameter :: rounding = 1e-9_dp
    real(dp), dimension(size(p%coef, 1)) :: left, right
    real(dp) :: sense(size(p%coef, 1))
    integer :: order, k

    left = p%coef(:, i - 1)
    right = p%coef(:, i)
    sense = [((-1.0_dp)**k, k=0, size(sense) - 1)]
    smooth = .true.
    do order = 0, 2
      smooth = smooth .and. abs(sum(left) - sum(sense*right)) <= rounding*(sum(abs(left)) + sum(abs(right)))
      ! Coefficients of the derivative, ascending, of which the first has a factor 0.
      left = 2/(p%breaks(i) - p%breaks(i - 1))*[(k, k=0, size(left) - 1)]*left
      right = 2/(p%breaks(i + 1) - p%breaks(i))*[(k, k=0, size(right) - 1)]*right
      left = eoshift(left, 1)
      right = eoshift(right, 1)
    end do
  end function is_smooth_at

  pure function scaled(p, factor) result(q)
    class(piecewise_t), intent(in) :: p
    real(dp), intent(in) :: factor
    type(piecewise_t) :: q

    allocate (q%breaks, source=p%breaks)
    allocate (q%coef, source=p%coef)
    q%coef = factor*p%coef
  end function scaled

  !> Polynomial over [first, last] with these `values` at v = -cos(pi k/n), k = 0 to n, which are denser towards both ends: there
  !> it is exact, and between it is nearly the best of its degree n.
  !> Source: Trefethen 2013, Approximation Theory and Approximation Practice, chapters 3 and 15.
  pure function interpolated(first, last, values) result(p)
    real(dp), intent(in) :: first, last, values(0:)
    type(piecewise_t) :: p
    real(dp), dimension(0:ubound(values, 1)) :: chebyshev, before, term, power
    integer :: n, j, k

    n = ubound(values, 1)
    do j = 0, n
      chebyshev(j) = 0
      do k = 0, n
        chebyshev(j) = chebyshev(j) + values(k)*cos(pi*j*(n - k)/n)/merge(2, 1, k == 0 .or. k == n)
      end do
      chebyshev(j) = 2*chebyshev(j)/n/merge(2, 1, j == 0 .or. j == n)
    end do
    ! Chebyshev polynomials by their recurrence, in powers of v.
    before = 0
    term = 0
    term(0) = 1
    power = chebyshev(0)*term
    do j = 1, n
      associate (next => merge(1, 2, j == 1)*eoshift(term, -1) - before)
        before = term
        term = next
      end associate
      power = power + chebyshev(j)*term
    end do
    p = polynomial(first, last, power)
  end function interpolated

  !> Curve `left` up to its end, then `right`.
  pure function joined(left, right) result(p)
    type(piecewise_t), intent(in) :: left, right
    type(piecewise_t) :: p
    integer :: n, m

    n = size(left%coef, 2)
    m = size(right%coef, 2)
    p%breaks = [left%breaks, right%breaks(2:)]
    allocate (p%coef(0:max(ubound(left%coef, 1), ubound(right%coef, 1)), n + m), source=0.0_dp)
    p%coef(:ubound(left%coef, 1), :n) = left%coef
    p%coef(:ubound(right%coef, 1), n + 1:) = right%coef
  end function joined
end module gearsweep_base_piecewise
