!> Compliance over the face: exact properties, the closed form of its waves, and the contact of slices.
module test_face_law
  use gearsweep_base_error, only: error_t
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_base_text, only: str
  use gearsweep_face_contact, only: flat_t, solve_contact
  use gearsweep_face_law, only: even_half_space, face_law_t, graded_slices, line_law_t, make_face_law, root_spread, tooth_remainder
  use test_support_testing, only: tally_t, check_true, check_close, check_no_error
  implicit none
  private
  public :: run

  !> Of 25 teeth on a section of three, times E/(1 - nu**2): beyond half space and body, and shared.
  real(dp), parameter :: remainder = 3.2_dp, shared = 0.26_dp

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('waves')) call waves(t)
    if (t%wants('symmetric')) call symmetric(t)
    if (t%wants('even_load')) call even_load(t)
    if (t%wants('oblique')) call oblique(t)
    if (t%wants('slices')) call slices(t)
    if (t%wants('proportional')) call proportional(t)
    if (t%wants('root_waves')) call root_waves(t)
  end subroutine run

  pure function equal_slices(width, n) result(bounds)
    real(dp), intent(in) :: width
    integer, intent(in) :: n
    real(dp) :: bounds(0:n)
    integer :: i

    bounds = [(width*i/n, i=0, n)]
  end function equal_slices

  !> Law of a line over the whole face of a spur gear.
  pure type(line_law_t) function whole_line(bounds) result(line)
    real(dp), intent(in) :: bounds(0:)
    type(face_law_t) :: law
    integer :: i

    call make_face_law(bounds, remainder, shared, law)
    line = law%of_line([(i, i=1, size(bounds))])
  end function whole_line

  !> Compliance of a tooth that is alike all along the line.
  pure function even_tooth(law) result(compliance)
    type(line_law_t), intent(in) :: law
    real(dp) :: compliance(size(law%ends, 1), size(law%ends, 2))
    integer :: i

    compliance = law%of_tooth([(remainder, i=1, size(law%ends, 1))], [(shared, i=1, size(law%ends, 1))])
  end function even_tooth

  !> A load cos(k z) with slope 0 at both ends is its own mirror image there, so that a face of many slices deflects as an endless
  !> one: by the closed form of c(k), less what free end faces add. Expected values: the formula of gearsweep_face_law.
  subroutine waves(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: n = 800
    real(dp), parameter :: width = 40, euler = 0.5772156649015329_dp
    type(line_law_t) :: law
    real(dp) :: bounds(0:n), load(n), moved(n), k, plate, space, length, reach
    integer :: half_waves

    bounds = equal_slices(width, n)
    law = whole_line(bounds)
    length = 0.62_dp + 0.11_dp*(remainder + 2.12_dp)
    reach = 1.5_dp + 1.1_dp*shared
    do half_waves = 0, 24, 6
      k = pi*half_waves/width
      load = cos(k*(bounds(:n - 1) + bounds(1:))/2)
      space = 2/pi*(log(4.0_dp) + 0.5_dp - euler - log(k**2 + 1/2.15_dp**2)/2)
      plate = 1/(1 + (k*length)**2 + (k*length)**4)
      moved = matmul(law%half_space, load)*n/width
      call check_close(t, 'half space, '//str(half_waves)//' half waves', moved(1), space*load(1), absolute=3e-3_dp)
      moved = matmul(law%tooth, load)*n/width
      call check_close(t, 'tooth, '//str(half_waves)//' half waves', moved(1), plate*load(1), absolute=3e-3_dp)
      moved = matmul(law%body, load)*n/width
      call check_close(t, 'body, '//str(half_waves)//' half waves', moved(1), exp(-(k*reach)**2)*load(1), absolute=3e-3_dp)
    end do
  end subroutine waves

  !> The compliance is that of an elastic body: symmetric to the last bit, positive definite for slices of 0.3 modules and more
  !> under a contact of 0.1 modules, and the same from either end of the face.
  subroutine symmetric(t)
    type(tally_t), intent(inout) :: t
    type(line_law_t) :: law
    real(dp), allocatable :: c(:, :), bounds(:)
    integer :: n, i

    do n = 10, 60, 25
      bounds = equal_slices(0.3_dp*n, n)
      law = whole_line(bounds)
      c = even_tooth(law)
      do i = 1, n
        c(i, i) = c(i, i) + 2/pi*log(10.0_dp)*0.3_dp
      end do
      call check_true(t, 'symmetric', all(.not. abs(c - transpose(c)) > 0))
      call check_close(t, 'alike from both ends', maxval(abs(c - c(n:1:-1, n:1:-1))), 0.0_dp, absolute=1e-12_dp)
      call check_true(t, 'positive definite', is_positive(c), str(n)//' slices')
    end do
  end subroutine symmetric

  !> All pivots of Cholesky's method are positive.
  logical function is_positive(matrix)
    real(dp), intent(in) :: matrix(:, :)
    real(dp) :: l(size(matrix, 1), size(matrix, 1))
    integer :: i, j

    l = matrix
    is_positive = .true.
    do j = 1, size(l, 1)
      is_positive = is_positive .and. l(j, j) > 0
      if (.not. is_positive) return
      do i = j + 1, size(l, 1)
        l(i:, i) = l(i:, i) - l(i:, j)*l(i, j)/l(j, j)
      end do
    end do
  end function is_positive

  !> An even load deflects the middle of a wide face by the plane compliance.
  subroutine even_load(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: n = 200
    real(dp) :: bounds(0:n), moved(n)
    type(line_law_t) :: law

    bounds = equal_slices(60.0_dp, n)
    law = whole_line(bounds)
    moved = sum(even_tooth(law), 2)*n/60
    call check_close(t, 'middle of a wide face', moved(n/2), remainder + shared + even_half_space, 1e-6_dp)
    call check_close(t, 'remainder of the plane compliance', tooth_remainder(moved(n/2), shared), remainder, 1e-5_dp)
    call check_true(t, 'free ends are softer by some per cent', moved(1) > 1.01_dp*moved(n/2) .and. &
                    moved(1) < 1.1_dp*moved(n/2), str(moved(1)/moved(n/2)))
  end subroutine even_load

  !> Oblique lines: the compliance is symmetric and positive definite, with both end faces exchanged it is its own mirror image, an
  !> acute end is softer and an obtuse one stiffer than a right-angled one, and far from the ends it is that of a spur gear. Bounds
  !> that are added count as those that were there: the law of a part of the line is that of the same slices.
  subroutine oblique(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: n = 60
    real(dp), parameter :: tilt = 0.36_dp
    type(face_law_t) :: law, mirrored, parts, spur
    type(line_law_t) :: line
    real(dp) :: bounds(0:n)
    real(dp), allocatable :: c(:, :), d(:, :), moved(:), straight(:)
    integer :: i

    bounds = equal_slices(30.0_dp, n)
    call make_face_law(bounds, remainder, shared, law, tilt)
    call make_face_law(bounds, remainder, shared, mirrored, -tilt)
    call make_face_law(bounds, remainder, shared, spur)
    line = law%of_line([(i, i=1, n + 1)])
    c = even_tooth(line)
    moved = sum(c, 2)*n/30
    line = mirrored%of_line([(i, i=1, n + 1)])
    d = even_tooth(line)
    call check_close(t, 'exchanged ends', maxval(abs(c - d(n:1:-1, n:1:-1))), 0.0_dp, absolute=1e-12_dp)
    line = spur%of_line([(i, i=1, n + 1)])
    straight = sum(even_tooth(line), 2)*n/30
    call check_true(t, 'acute end softer', moved(1) > 1.2_dp*straight(1), str(moved(1)/straight(1)))
    call check_true(t, 'obtuse end stiffer', moved(n) < 0.9_dp*straight(n), str(moved(n)/straight(n)))
    call check_close(t, 'far from both', moved(n/2), straight(n/2), 1e-3_dp)
    do i = 1, n
      c(i, i) = c(i, i) + 2/pi*log(10.0_dp)*0.5_dp
    end do
    call check_true(t, 'symmetric', all(.not. abs(c - transpose(c)) > 0))
    call check_true(t, 'positive definite', is_positive(c))
    call make_face_law(bounds([0, n]), remainder, shared, parts, tilt)
    call parts%add_bounds(bounds(n - 1:1:-1))
    line = parts%of_line([1, [(n + 2 - i, i=1, n - 1)], 2])
    call check_close(t, 'bounds added later', maxval(abs(line%half_space - sub(law%of_line([(i, i=1, n + 1)])))), 0.0_dp, &
                     absolute=1e-12_dp)
    call check_close(t, 'between lines', maxval(abs(law%between([(i, i=1, 9)], [(i, i=5, 20)]) - &
                     transpose(law%between([(i, i=5, 20)], [(i, i=1, 9)])))), 0.0_dp, absolute=0.0_dp)

  contains

    pure function sub(line)
      type(line_law_t), intent(in) :: line
      real(dp), allocatable :: sub(:, :)

      sub = line%half_space
    end function sub
  end subroutine oblique

  !> Automatic slices: 0.35 modules at the ends, a module inside, symmetric, and bounds at the kinks.
  subroutine slices(t)
    type(tally_t), intent(inout) :: t
    real(dp), allocatable :: bounds(:)
    real(dp), parameter :: module = 4e-3_dp, width = 40e-3_dp, kink = 4e-3_dp
    integer :: n

    bounds = graded_slices(width, module, [0.0_dp, kink], 0.0_dp, 0)
    n = size(bounds)
    associate (widths => (bounds(2:) - bounds(:n - 1))/module)
      call check_true(t, 'neither narrow nor wide', all(widths > 0.28_dp .and. widths < 1.1_dp), &
                      str(minval(widths))//' to '//str(maxval(widths)))
    end associate
    call check_close(t, 'whole face', bounds(n), width)
    call check_close(t, 'symmetric', maxval(abs(bounds + bounds(n:1:-1) - width)), 0.0_dp, absolute=1e-16_dp)
    call check_close(t, 'a bound at the kink', minval(abs(bounds - kink)), 0.0_dp, absolute=1e-16_dp)
    call check_true(t, 'as many as wanted', abs(size(graded_slices(width, module, [0.0_dp], 0.0_dp, 24)) - 25) <= 1)
    bounds = graded_slices(width, module, [real(dp) ::], 4e-3_dp, 0)
    call check_true(t, 'a wide contact has wide slices', minval(bounds(2:) - bounds(:size(bounds) - 1)) > 3e-3_dp)
  end subroutine slices

  !> Without flattening by the load, ten times the load with ten times the gap gives ten times the line loads.
  subroutine proportional(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: n = 20
    real(dp), parameter :: width(n) = 0.5_dp
    real(dp) :: gap(n), once(n), tenfold(n), x(2), rate(n)
    real(dp), allocatable :: c(:, :)
    type(line_law_t) :: law
    type(flat_t) :: flat
    type(error_t), allocatable :: error
    integer :: i

    law = whole_line(equal_slices(10.0_dp, n))
    c = even_tooth(law)
    do i = 1, n
      c(i, i) = c(i, i) + 2/pi*log(20.0_dp)*width(i)
    end do
    gap = [(3.0_dp*i, i=1, n)]
    allocate (flat%scale(n), source=1.0_dp)
    call solve_contact(c, width, gap, flat, 20.0_dp, x(1), once, rate, error)
    call check_no_error(t, 'contact', error)
    call solve_contact(c, width, 10*gap, flat, 200.0_dp, x(2), tenfold, rate, error)
    call check_no_error(t, 'tenfold', error)
    call check_true(t, 'part of the face', any(once > 0) .and. any(.not. once > 0))
    call check_close(t, 'sum of the loads', dot_product(once, width), 20.0_dp, 1e-13_dp)
    call check_close(t, 'ten times the loads', maxval(abs(tenfold - 10*once)), 0.0_dp, absolute=1e-10_dp)
    call check_close(t, 'ten times the deflection', x(2), 10*x(1))
    call check_true(t, 'no penetration', all(x(1) - gap - matmul(c, once)/width < 1e-10_dp))
  end subroutine proportional

  !> The root stress of an even load is even, and that of a wave follows its closed form.
  subroutine root_waves(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: n = 400
    real(dp) :: bounds(0:n), load(n), stress(n), k

    bounds = equal_slices(40.0_dp, n)
    k = pi*10/40
    load = 1
    stress = matmul(root_spread(bounds), load)
    call check_close(t, 'even stress', maxval(abs(stress - 1)), 0.0_dp, absolute=1e-9_dp)
    load = cos(k*(bounds(:n - 1) + bounds(1:))/2)
    stress = matmul(root_spread(bounds), load)
    call check_close(t, 'wave', stress(1), load(1)/(1 + 1.2_dp*(1.24_dp*k)**2 + (1.24_dp*k)**4), 2e-3_dp)
  end subroutine root_waves
end module test_face_law
