!> The steady motion of a gear pair whose teeth have errors of their own, over the mesh periods after which these repeat: the
!> largest load of each pair of teeth, and the dynamic and static transmission error with their orders.
module gearsweep_turn
  use gearsweep_error_estimate, only: accuracy_t, point_t
  use gearsweep_kinds, only: dp, pi
  use gearsweep_mesh, only: interval_t
  use gearsweep_operating_point, only: solve_point
  use gearsweep_oscillator, only: mesh_period, oscillator_t
  use gearsweep_quadrature, only: gauss_legendre
  use gearsweep_quintic, only: maximum_of, quintic, value_of
  use gearsweep_refinement, only: levels_t
  use gearsweep_response, only: trace_motion
  use gearsweep_segments, only: segment_t, smooth_segments
  use gearsweep_sharing, only: transmission_error
  use gearsweep_spectrum, only: find_spectrum, spectrum_t
  use gearsweep_status, only: has_result
  use gearsweep_trace, only: trace_t
  implicit none
  private
  public :: curve_t, turn_t, find_turn, find_static_turn, find_amplitudes

  !> A transmission error at the nodes of an integration rule over the turn.
  type :: curve_t
    real(dp) :: least = 0, largest = 0           !< m
    integer :: periods = 0                       !< mesh periods that it is of
    !> Time in mesh periods, weight in the integral over the time, value (m).
    real(dp), allocatable :: tau(:), weight(:), value(:)
  end type curve_t

  type :: turn_t
    real(dp) :: rpm = 0                          !< speed of the pinion, 1/min
    type(point_t) :: point
    logical :: lacks = .false.                   !< the memory does not hold it
    type(curve_t) :: error                       !< dynamic transmission error; with a result alone
    !> Of the pair that enters with each mesh period: the largest load (N) and where on its path; (period)
    real(dp), allocatable :: load(:), place(:)
    !> Where a stress for a unit load is given, the largest stress that the pair's loads make in pinion and gear (Pa); (gear,
    !> period)
    real(dp), allocatable :: stress(:, :)
  end type turn_t

  integer, parameter :: points = 8               !< of Gauss's rule

contains

  !> The motion at one speed.
  pure subroutine find_turn(osc, rpm, options, levels, turn, unit_stress)
    type(oscillator_t), intent(in) :: osc        !< with deviations in its mesh, or without: one mesh period
    real(dp), intent(in) :: rpm                  !< speed of the pinion, 1/min
    type(accuracy_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels      !< of this oscillator
    type(turn_t), intent(out) :: turn
    !> Stress in pinion and gear under a unit load (Pa/N), at equal distances from A to E; (gear, place)
    real(dp), intent(in), optional :: unit_stress(:, :)
    type(trace_t), allocatable :: trace(:)
    real(dp) :: duration
    integer :: i

    turn%rpm = rpm
    duration = mesh_period(osc%mesh%teeth(1), rpm)
    call solve_point(osc, duration, options, levels, turn%point)
    turn%lacks = levels%lacks
    if (turn%lacks .or. .not. has_result(turn%point%steady%status)) return
    call trace_motion(osc, duration, options, turn%point, trace, turn%lacks)
    if (turn%lacks) return
    associate (periods => osc%mesh%deviations%periods)
      turn%error%periods = size(trace)*periods
      allocate (turn%load(size(trace)*periods), turn%place(size(trace)*periods), source=0.0_dp)
      do i = 1, size(trace)
        call read_loads(trace(i), (i - 1)*periods, osc%pairs, turn)
      end do
      if (present(unit_stress)) then
        allocate (turn%stress(2, size(turn%load)), source=0.0_dp)
        do i = 1, size(trace)
          call read_stress(trace(i), (i - 1)*periods, osc%pairs, unit_stress, osc%mesh%contact_ratio, turn%stress)
        end do
      end if
      call read_error(trace, periods, turn%error)
    end associate
  end subroutine find_turn

  !> Raises the largest loads of the pairs.
  pure subroutine read_loads(trace, before, pairs, turn)
    type(trace_t), intent(in) :: trace
    integer, intent(in) :: before                ! mesh periods before this trace
    integer, intent(in) :: pairs
    type(turn_t), intent(inout) :: turn
    real(dp) :: c(0:5), at, load
    integer :: j, k, number

    do k = 1, trace%rows, 2
      do j = 1, min(trace%pairs(k), pairs)
        number = 1 + modulo(before - (j + trace%offset(k) - 1), size(turn%load))
        c = quintic(trace%load(:, j, k), trace%load(:, j, k + 1))
        at = 0
        if (trace%load(0, j, k + 1) > trace%load(0, j, k)) at = 1
        if (c(1) > 0 .and. trace%load(1, j, k + 1) < 0) at = maximum_of(c)
        load = value_of(c, at)
        if (load <= turn%load(number)) cycle
        turn%load(number) = load
        turn%place(number) = trace%phase(k) + at*(trace%phase(k + 1) - trace%phase(k)) + (j + trace%offset(k) - 1)
      end do
    end do
  end subroutine read_loads

  !> Raises the largest stresses, at a few places of each step.
  pure subroutine read_stress(trace, before, pairs, unit_stress, contact_ratio, stress)
    type(trace_t), intent(in) :: trace
    integer, intent(in) :: before                ! mesh periods before this trace
    integer, intent(in) :: pairs
    real(dp), intent(in) :: unit_stress(:, :), contact_ratio
    real(dp), intent(inout) :: stress(:, :)
    integer, parameter :: places = 4
    real(dp) :: c(0:5), at, along
    integer :: i, j, k, n, number

    do k = 1, trace%rows, 2
      do j = 1, min(trace%pairs(k), pairs)
        number = 1 + modulo(before - (j + trace%offset(k) - 1), size(stress, 2))
        c = quintic(trace%load(:, j, k), trace%load(:, j, k + 1))
        do i = 0, places
          at = real(i, dp)/places
          along = (trace%phase(k) + at*(trace%phase(k + 1) - trace%phase(k)) + (j + trace%offset(k) - 1))/contact_ratio
          ! A tip corner takes its load where the path ends.
          along = max(0.0_dp, min(1.0_dp, along))*(size(unit_stress, 2) - 1)
          n = min(int(along), size(unit_stress, 2) - 2)
          stress(:, number) = max(stress(:, number), value_of(c, at)*(unit_stress(:, n + 1) + &
                                                                      (along - n)*(unit_stress(:, n + 2) - unit_stress(:, n + 1))))
        end do
      end do
    end do
  end subroutine read_stress

  !> The dynamic transmission error.
  pure subroutine read_error(trace, periods, curve)
    type(trace_t), intent(in) :: trace(:)
    integer, intent(in) :: periods               ! mesh periods of each
    type(curve_t), intent(inout) :: curve
    type(spectrum_t) :: spectrum
    real(dp) :: node(points), weight(points)
    real(dp), allocatable :: left(:), width(:), c(:, :)
    integer :: i, k, n

    n = sum(trace%rows)/2
    allocate (left(n), width(n), c(0:5, n))
    n = 0
    do i = 1, size(trace)
      do k = 1, trace(i)%rows, 2
        n = n + 1
        left(n) = (i - 1)*periods + trace(i)%phase(k)
        width(n) = trace(i)%phase(k + 1) - trace(i)%phase(k)
        c(:, n) = quintic(trace(i)%x(:, k), trace(i)%x(:, k + 1))
      end do
    end do
    call find_spectrum(left, width, c, 0, spectrum)
    curve%least = spectrum%least
    curve%largest = spectrum%largest
    call gauss_legendre(node, weight)
    allocate (curve%tau(points*n), curve%weight(points*n), curve%value(points*n))
    do i = 1, n
      do k = 1, points
        curve%tau(points*(i - 1) + k) = left(i) + width(i)*(1 + node(k))/2
        curve%weight(points*(i - 1) + k) = width(i)*weight(k)/2
        curve%value(points*(i - 1) + k) = value_of(c(:, i), (1 + node(k))/2)
      end do
    end do
  end subroutine read_error

  !> The static transmission error.
  pure subroutine find_static_turn(osc, curve)
    type(oscillator_t), intent(in) :: osc
    type(curve_t), intent(out) :: curve
    type(interval_t), allocatable :: intervals(:)
    type(segment_t), allocatable :: segments(:), whole(:)
    real(dp) :: node(points), weight(points)
    integer :: i, k, row

    call smooth_segments(osc%mesh, osc%load, intervals, whole)
    allocate (segments(0))
    do i = 1, size(whole)
      segments = [segments, parts_of(whole(i))]
    end do
    call gauss_legendre(node, weight)
    curve%periods = osc%mesh%deviations%periods
    allocate (curve%tau(points*size(segments)), curve%weight(points*size(segments)), curve%value(points*size(segments)))
    curve%least = huge(1.0_dp)
    curve%largest = -huge(1.0_dp)
    do i = 1, size(segments)
      associate (segment => segments(i), interval => intervals(segments(i)%interval))
        do k = 1, points
          row = points*(i - 1) + k
          curve%tau(row) = segment%first + (segment%last - segment%first)*(1 + node(k))/2
          curve%weight(row) = (segment%last - segment%first)*weight(k)/2
          curve%value(row) = transmission_error(osc%mesh, interval, osc%load, curve%tau(row))
          curve%tau(row) = curve%tau(row) + interval%period
        end do
        call raise_range(osc, interval, segment, node, curve%value(row - points + 1:row), curve)
      end associate
    end do
  end subroutine find_static_turn

  !> A segment in parts that are short beside the waves of high orders.
  pure function parts_of(segment) result(parts)
    type(segment_t), intent(in) :: segment
    real(dp), parameter :: longest = 0.1_dp      ! mesh periods
    type(segment_t) :: parts(max(1, ceiling((segment%last - segment%first)/longest)))
    integer :: k, n

    n = size(parts)
    do k = 1, n
      parts(k) = segment
      parts(k)%first = segment%first + (segment%last - segment%first)*(k - 1)/n
      if (k < n) parts(k)%last = segment%first + (segment%last - segment%first)*k/n
    end do
  end function parts_of

  !> The extremes of the static transmission error over a part of a segment, of which the values at the nodes are known.
  pure subroutine raise_range(osc, interval, segment, node, value, curve)
    type(oscillator_t), intent(in) :: osc
    type(interval_t), intent(in) :: interval
    type(segment_t), intent(in) :: segment
    real(dp), intent(in) :: node(points), value(points)
    type(curve_t), intent(inout) :: curve
    real(dp) :: v(0:points + 1), u(0:points + 1), extreme
    integer :: k, sense

    u = segment%first + (segment%last - segment%first)*(1 + [-1.0_dp, node, 1.0_dp])/2
    v(0) = transmission_error(osc%mesh, interval, osc%load, u(0))
    v(1:points) = value
    v(points + 1) = transmission_error(osc%mesh, interval, osc%load, u(points + 1))
    do sense = -1, 1, 2
      k = maxloc(sense*v, 1) - 1
      extreme = v(k)
      if (k > 0 .and. k < points + 1) then
        ! Within so short a part the curve is near the parabola, which is higher by less than this.
        if (sense*extreme + (maxval(v) - minval(v)) > merge(curve%largest, -curve%least, sense > 0)) &
          extreme = sense*largest_between(osc, interval, sense, u(k - 1), u(k + 1))
      end if
      if (sense > 0) curve%largest = max(curve%largest, extreme)
      if (sense < 0) curve%least = min(curve%least, extreme)
    end do
  end subroutine raise_range

  !> The largest value of `sense` times the static transmission error between two phases with one maximum, by golden section.
  pure real(dp) function largest_between(osc, interval, sense, first, last) result(largest)
    type(oscillator_t), intent(in) :: osc
    type(interval_t), intent(in) :: interval
    integer, intent(in) :: sense
    real(dp), intent(in) :: first, last
    real(dp), parameter :: golden = (sqrt(5.0_dp) - 1)/2
    integer, parameter :: most = 40
    real(dp) :: left, right, inner(2), value(2)
    integer :: i

    left = first
    right = last
    inner = [right - golden*(right - left), left + golden*(right - left)]
    value = [sense*transmission_error(osc%mesh, interval, osc%load, inner(1)), &
             sense*transmission_error(osc%mesh, interval, osc%load, inner(2))]
    do i = 1, most
      if (value(1) > value(2)) then
        right = inner(2)
        inner = [right - golden*(right - left), inner(1)]
        value = [sense*transmission_error(osc%mesh, interval, osc%load, inner(1)), value(1)]
      else
        left = inner(1)
        inner = [inner(2), left + golden*(right - left)]
        value = [value(2), sense*transmission_error(osc%mesh, interval, osc%load, inner(2))]
      end if
    end do
    largest = maxval(value)
  end function largest_between

  !> Amplitudes of the harmonics base, 2 base ... of the mesh frequency (m), as complex numbers: the curve has the parts
  !> real(amplitude exp(2 pi i harmonic tau)).
  pure subroutine find_amplitudes(curve, base, amplitude)
    type(curve_t), intent(in) :: curve
    real(dp), intent(in) :: base                 !< a whole number over the periods of the curve
    complex(dp), intent(out) :: amplitude(:)
    complex(dp) :: turn, part
    integer :: k, n

    amplitude = 0
    do n = 1, size(curve%tau)
      associate (angle => -2*pi*modulo(base*curve%tau(n), 1.0_dp))
        turn = cmplx(cos(angle), sin(angle), dp)
      end associate
      part = 2*curve%weight(n)*curve%value(n)/curve%periods
      do k = 1, size(amplitude)
        part = part*turn
        amplitude(k) = amplitude(k) + part
      end do
    end do
  end subroutine find_amplitudes
end module gearsweep_turn
