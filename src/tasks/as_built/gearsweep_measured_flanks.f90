!> Profile errors of single teeth from measured points of their flanks: for each tooth the polynomial over the path of contact that
!> lies closest to the points on it, by least squares.
module gearsweep_measured_flanks
  use gearsweep_error, only: code_input, error_t, fail
  use gearsweep_flank_file, only: flank_points_t
  use gearsweep_gear, only: drive
  use gearsweep_kinds, only: dp
  use gearsweep_pair, only: pair_t
  use gearsweep_small_system, only: solve_small
  use gearsweep_sorting, only: sorted
  use gearsweep_text, only: str
  implicit none
  private
  public :: fit_flanks

  integer, parameter :: degree = 4
  integer, parameter :: least_points = 8         ! of a tooth on the path of contact
  real(dp), parameter :: least_part = 0.8_dp     ! of the path that they must reach over
  real(dp), parameter :: widest_gap = 0.2_dp     ! between neighbouring points, parts of the path
  real(dp), parameter :: rounding = 1e-6_dp      ! of rolls as a file tells them, parts of the path
  !> Legendre's polynomials in powers of u; (power, polynomial).
  real(dp), parameter :: legendre(0:degree, 0:degree) = reshape([ &
    1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, &
    0.0_dp, 1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, &
    -0.5_dp, 0.0_dp, 1.5_dp, 0.0_dp, 0.0_dp, &
    0.0_dp, -1.5_dp, 0.0_dp, 2.5_dp, 0.0_dp, &
    0.375_dp, 0.0_dp, -3.75_dp, 0.0_dp, 4.375_dp], [degree + 1, degree + 1])

contains

  !> The errors of a gear's teeth on the line of action: material that stands out takes from the gap, so that they are what was
  !> measured, turned round. What was measured at the measuring circle is taken off, as the pitch has it. Fails where a tooth has
  !> too few points on the path, or has them too far apart.
  pure subroutine fit_flanks(path, points, pair, gear, c, rest, error)
    character(*), intent(in) :: path             !< of the file, for messages
    type(flank_points_t), intent(in) :: points   !< of all teeth
    type(pair_t), intent(in) :: pair
    integer, intent(in) :: gear                  !< 1: pinion, 2: gear
    real(dp), allocatable, intent(out) :: c(:, :)          !< c_n over (s - contact ratio/2)^n, m; (0:4, tooth)
    real(dp), intent(out) :: rest                !< root mean square of what the polynomials leave of the points, m
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: s(:), e(:), u(:)
    logical, allocatable :: on_path(:)
    real(dp) :: measured_at, at_circle, b(0:degree)
    integer :: tooth, used, n

    rest = 0
    used = 0
    measured_at = place_of(pair, gear, pair%gear(gear)%curvature(drive, pair%gear(gear)%reference_radius))
    allocate (c(0:degree, size(points%first) - 1))
    do tooth = 1, size(c, 2)
      associate (place => path//': tooth '//str(tooth)//': ', first => points%first(tooth), last => points%first(tooth + 1) - 1)
        e = -points%deviation(first:last)
        s = place_of(pair, gear, points%roll(first:last))
        on_path = s >= -rounding*pair%contact_ratio .and. s <= (1 + rounding)*pair%contact_ratio
        call check_points(place, pair, gear, sorted(pack(s, on_path)), error)
        if (allocated(error)) return
        u = 2*pack(s, on_path)/pair%contact_ratio - 1
        b = fitted(u, pack(e, on_path))
        rest = rest + sum((pack(e, on_path) - value_at(b, u))**2)
        used = used + size(u)
        if (measured_at >= 0 .and. measured_at <= pair%contact_ratio) then
          at_circle = sum(value_at(b, [2*measured_at/pair%contact_ratio - 1]))
        else
          call read_at(place, pair, gear, s, e, at_circle, error)
          if (allocated(error)) return
        end if
        b(0) = b(0) - at_circle
        c(:, tooth) = b*[((2/pair%contact_ratio)**n, n=0, degree)]
      end associate
    end do
    rest = sqrt(rest/used)
  end subroutine fit_flanks

  !> Path coordinate at which a flank of this gear touches where it has this radius of curvature (m).
  elemental real(dp) function place_of(pair, gear, curvature) result(s)
    type(pair_t), intent(in) :: pair
    integer, intent(in) :: gear
    real(dp), intent(in) :: curvature

    s = (curvature - pair%curvature(gear, 0.0_dp))/pair%base_pitch
    if (gear == 2) s = -s
  end function place_of

  !> Refuses what a polynomial cannot be laid through. Points as far apart as is allowed are at five places at least.
  pure subroutine check_points(place, pair, gear, s, error)
    character(*), intent(in) :: place            ! as messages begin
    type(pair_t), intent(in) :: pair
    integer, intent(in) :: gear
    real(dp), intent(in) :: s(:)                 ! on the path, ascending
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: part
    integer :: n, k

    n = size(s)
    if (n < least_points) then
      call fail(error, code_input, place//'points of this flank on the path of contact, '// &
                trim(rolls(0.0_dp, pair%contact_ratio))//': '//str(n)//'; must be at least '//str(least_points))
      return
    end if
    part = (s(n) - s(1))/pair%contact_ratio
    if (part < least_part - rounding) then
      call fail(error, code_input, place//'its points reach over '//str(100*part, 3)//' % of the path of contact, '// &
                trim(rolls(0.0_dp, pair%contact_ratio))//'; must be at least '//str(100*least_part, 3)//' %')
      return
    end if
    k = maxloc(s(2:) - s(:n - 1), 1)
    if (s(k + 1) - s(k) > (widest_gap + rounding)*pair%contact_ratio) call fail(error, code_input, place// &
      'has no point within '//trim(rolls(s(k), s(k + 1)))//'; a gap must be at most '// &
      str(1e3_dp*widest_gap*pair%contact_ratio*pair%base_pitch, 4)//' mm, a fifth of the path of contact')

  contains

    !> Between two places on the path.
    pure function rolls(first, last) result(words)
      real(dp), intent(in) :: first, last
      character(60) :: words
      real(dp) :: roll(2)

      roll = 1e3_dp*pair%curvature(gear, [first, last])
      words = 'roll '//str(minval(roll), 5)//' to '//str(maxval(roll), 5)//' mm'
    end function rolls
  end subroutine check_points

  !> The error at the measuring circle, where that lies off the path: on the straight line between the points beside it.
  pure subroutine read_at(place, pair, gear, s, e, value, error)
    character(*), intent(in) :: place            ! as messages begin
    type(pair_t), intent(in) :: pair
    integer, intent(in) :: gear
    real(dp), intent(in) :: s(:), e(:)           ! of all points of the tooth
    real(dp), intent(out) :: value               ! m
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: roll, at
    integer :: below, above

    value = 0
    roll = pair%gear(gear)%curvature(drive, pair%gear(gear)%reference_radius)
    at = place_of(pair, gear, roll)
    below = maxloc(s, 1, mask=s <= at)
    above = minloc(s, 1, mask=s >= at)
    if (below > 0 .and. above > 0) then
      if (s(above) - s(below) <= (widest_gap + rounding)*pair%contact_ratio) then
        value = e(below)
        if (s(above) > s(below)) value = e(below) + (e(above) - e(below))*(at - s(below))/(s(above) - s(below))
        return
      end if
    end if
    call fail(error, code_input, place//'has no points beside the reference circle, roll '//str(1e3_dp*roll, 5)// &
              ' mm, where pitch is measured; as this lies off the path of contact, there must be one on each side, at most '// &
              str(1e3_dp*widest_gap*pair%contact_ratio*pair%base_pitch, 4)//' mm apart')
  end subroutine read_at

  !> The polynomial in u that lies closest to points over -1 to 1, (0:4). Legendre's polynomials are nearly orthogonal over the
  !> points, so that the normal equations lose few digits.
  pure function fitted(u, e) result(b)
    real(dp), intent(in) :: u(:), e(:)
    real(dp) :: b(0:degree), normal(0:degree, 0:degree), right(0:degree, 1), value(0:degree)
    integer :: i, k

    normal = 0
    right = 0
    do i = 1, size(u)
      value = matmul(u(i)**[(k, k=0, degree)], legendre)
      do k = 0, degree
        normal(:, k) = normal(:, k) + value*value(k)
      end do
      right(:, 1) = right(:, 1) + value*e(i)
    end do
    call solve_small(normal, right)
    b = matmul(legendre, right(:, 1))
  end function fitted

  !> A polynomial at each u.
  pure function value_at(b, u) result(value)
    real(dp), intent(in) :: b(0:), u(:)
    real(dp) :: value(size(u))
    integer :: n

    value = 0
    do n = ubound(b, 1), 0, -1
      value = value*u + b(n)
    end do
  end function value_at
end module gearsweep_measured_flanks
