!> Measured flanks of one gear: reads the points of a file and fits one polynomial per tooth over the path of contact.
!>
!> The file has the line `tooth,flank,roll_mm,deviation_um` and below it a row for each point: the number of the tooth; its
!> left or right flank; the length of roll, which is the radius of curvature of the involute at the point; and the deviation
!> from the involute, positive where material is in excess. Rows may have any order. The polynomials are least-squares fits.
!> See gearsweep_base_text_rows for the forms of a table.
module gearsweep_gear_measured_flanks
  use gearsweep_base, only: code_input, dp, error_t, fail, find_rows, lower, rows_t, shown, solve_small, sorted, str
  use gearsweep_gear_gear, only: drive
  use gearsweep_gear_pair, only: pair_t
  implicit none
  private
  public :: flank_points_t, read_flank_points, fit_flanks

  !> Points of the flanks of one side of all teeth, tooth by tooth.
  type :: flank_points_t
    integer, allocatable :: first(:)             !< index of each tooth's first point, last: one past the end; (tooth + 1)
    real(dp), allocatable :: roll(:)             !< m; (point)
    real(dp), allocatable :: deviation(:)        !< m; (point)
  end type flank_points_t

  character(*), parameter :: header = 'tooth,flank,roll_mm,deviation_um'
  real(dp), parameter :: longest_roll = 1e5_dp   ! mm
  real(dp), parameter :: largest = 1e4_dp        ! um, as of the lists of &deviations
  real(dp), parameter :: mm = 1e-3_dp, um = 1e-6_dp

  type :: point_t
    integer :: tooth = 0                         ! index of the tooth; 0: of the other flank
    real(dp) :: roll = 0, deviation = 0          ! m
  end type point_t

  integer, parameter :: degree = 4
  integer, parameter :: least_points = 8         ! smallest number per tooth on the path of contact
  real(dp), parameter :: least_part = 0.8_dp     ! fraction of the path that they must cover
  real(dp), parameter :: widest_gap = 0.2_dp     ! largest gap between neighbouring points, parts of the path
  real(dp), parameter :: rounding = 1e-6_dp      ! rounding of rolls in a file, parts of the path
  !> Legendre polynomials in powers of u; (power, polynomial).
  real(dp), parameter :: legendre(0:degree, 0:degree) = reshape([ &
    1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, &
    0.0_dp, 1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, &
    -0.5_dp, 0.0_dp, 1.5_dp, 0.0_dp, 0.0_dp, &
    0.0_dp, -1.5_dp, 0.0_dp, 2.5_dp, 0.0_dp, &
    0.375_dp, 0.0_dp, -3.75_dp, 0.0_dp, 4.375_dp], [degree + 1, degree + 1])

contains

  !> Reads the points of one flank of each tooth, sorted by tooth. Fails at the first invalid line, of either flank.
  subroutine read_flank_points(path, text, teeth, flank, points, error)
    character(*), intent(in) :: path             !< path of the file, for messages
    character(*), intent(in) :: text             !< text of the file
    integer, intent(in) :: teeth                 !< number of teeth of the gear
    character(*), intent(in) :: flank            !< `left` or `right`; rows of the other flank are skipped
    type(flank_points_t), intent(out) :: points
    type(error_t), allocatable, intent(inout) :: error
    type(rows_t) :: table
    type(point_t), allocatable :: found(:)
    real(dp), parameter :: least = 0.1_dp*um
    real(dp) :: largest
    integer :: next(teeth), i

    call find_rows(text, path, header, table, error)
    if (allocated(error)) return
    allocate (found(size(table%rows)))
    do i = 1, size(found)
      call read_row(table, i, teeth, flank, found(i), error)
      if (allocated(error)) return
    end do
    largest = maxval(abs(found%deviation))
    if (largest > 0 .and. largest < least) call fail(error, code_input, path//': deviation_um: the largest is '// &
      str(largest/um)//', less than can be measured; if mm is meant, multiply by 1000')
    if (allocated(error)) return
    found = pack(found, found%tooth > 0)
    allocate (points%first(teeth + 1), source=0)
    allocate (points%roll(size(found)), points%deviation(size(found)))
    do i = 1, size(found)
      points%first(found(i)%tooth + 1) = points%first(found(i)%tooth + 1) + 1
    end do
    points%first(1) = 1
    do i = 1, teeth
      points%first(i + 1) = points%first(i + 1) + points%first(i)
    end do
    next = points%first(:teeth)
    do i = 1, size(found)
      associate (at => next(found(i)%tooth))
        points%roll(at) = found(i)%roll
        points%deviation(at) = found(i)%deviation
        at = at + 1
      end associate
    end do
  end subroutine read_flank_points

  subroutine read_row(table, row, teeth, flank, point, error)
    type(rows_t), intent(in) :: table
    integer, intent(in) :: row, teeth
    character(*), intent(in) :: flank
    type(point_t), intent(out) :: point
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: fields(:)
    integer :: tooth
    logical :: ok

    call table%fields(row, 4, fields, ok)
    if (.not. ok) then
      call table%refuse(row, 'must have four fields: '//header, error)
      return
    end if
    call table%whole_number(fields(1), tooth, ok)
    if (.not. (ok .and. tooth >= 1 .and. tooth <= teeth)) call refuse('tooth', fields(1), 'a whole number from 1 to '//str(teeth))
    fields(2) = lower(fields(2))
    if (fields(2) /= 'left' .and. fields(2) /= 'right') call refuse('flank', fields(2), 'left or right')
    call table%number(fields(3), point%roll, ok)
    if (.not. (ok .and. point%roll >= 0 .and. point%roll <= longest_roll)) call refuse('roll_mm', fields(3), &
      'a number from 0 to '//str(longest_roll))
    call table%number(fields(4), point%deviation, ok)
    if (.not. (ok .and. abs(point%deviation) <= largest)) call refuse('deviation_um', fields(4), &
      'a number from '//str(-largest)//' to '//str(largest))
    if (fields(2) == flank) point%tooth = tooth
    point%roll = mm*point%roll
    point%deviation = um*point%deviation

  contains

    subroutine refuse(name, given, allowed)
      character(*), intent(in) :: name, given, allowed

      call table%refuse(row, name//' = '//shown(trim(given))//': must be '//allowed, error)
    end subroutine refuse
  end subroutine read_row

  !> Fits the errors of a gear's teeth on the line of action. Excess material reduces the gap, so that the errors are the negative
  !> of the measured deviations. The deviation at the measuring circle is subtracted, as it belongs to the pitch. Fails if a tooth
  !> has too few points on the path, or too large gaps between them.
  pure subroutine fit_flanks(path, points, pair, gear, c, residual, error)
    character(*), intent(in) :: path             !< path of the file, for messages
    type(flank_points_t), intent(in) :: points   !< points of all teeth
    type(pair_t), intent(in) :: pair
    integer, intent(in) :: gear                  !< 1: pinion, 2: gear
    real(dp), allocatable, intent(out) :: c(:, :)          !< c_n over (s - contact ratio/2)^n, m; (0:4, tooth)
    real(dp), intent(out) :: residual            !< root mean square of the points' distances from the polynomials, m
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: s(:), e(:), u(:)
    logical, allocatable :: on_path(:)
    real(dp) :: measured_at, at_circle, b(0:degree)
    integer :: tooth, used, n

    residual = 0
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
        residual = residual + sum((pack(e, on_path) - value_at(b, u))**2)
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
    residual = sqrt(residual/used)
  end subroutine fit_flanks

  !> Path coordinate of the contact of a flank of this gear at this radius of curvature (m).
  elemental real(dp) function place_of(pair, gear, curvature) result(s)
    type(pair_t), intent(in) :: pair
    integer, intent(in) :: gear
    real(dp), intent(in) :: curvature

    s = (curvature - pair%curvature(gear, 0.0_dp))/pair%base_pitch
    if (gear == 2) s = -s
  end function place_of

  !> Refuses points that do not determine a polynomial. With the largest gaps allowed there are points at five places at least.
  pure subroutine check_points(place, pair, gear, s, error)
    character(*), intent(in) :: place            ! start of messages
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

    !> Range of rolls between two places on the path, for messages.
    pure function rolls(first, last) result(words)
      real(dp), intent(in) :: first, last
      character(60) :: words
      real(dp) :: roll(2)

      roll = 1e3_dp*pair%curvature(gear, [first, last])
      words = 'roll '//str(minval(roll), 5)//' to '//str(maxval(roll), 5)//' mm'
    end function rolls
  end subroutine check_points

  !> Interpolates the error at the measuring circle, if it is outside the path: on the straight line between the neighbouring
  !> points.
  pure subroutine read_at(place, pair, gear, s, e, value, error)
    character(*), intent(in) :: place            ! start of messages
    type(pair_t), intent(in) :: pair
    integer, intent(in) :: gear
    real(dp), intent(in) :: s(:), e(:)           ! path coordinates and errors of all points of the tooth
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

  !> Fits the polynomial in u to points over -1 to 1 by least squares, (0:4). Legendre polynomials are nearly orthogonal over the
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

  !> Value of a polynomial at each u.
  pure function value_at(b, u) result(value)
    real(dp), intent(in) :: b(0:), u(:)
    real(dp) :: value(size(u))
    integer :: n

    value = 0
    do n = ubound(b, 1), 0, -1
      value = value*u + b(n)
    end do
  end function value_at
end module gearsweep_gear_measured_flanks
