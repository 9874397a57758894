!> One run through the mesh periods of a motion, and what is read off it: its end, its dynamic factor, the harmonics of its
!> transmission error, and in which order its contacts change.
module gearsweep_motion_reading
  use gearsweep_coefficients, only: resolution_t
  use gearsweep_contact_set, only: period_t
  use gearsweep_kinds, only: dp, pi
  use gearsweep_oscillator, only: oscillator_t
  use gearsweep_period, only: run_period
  use gearsweep_period_map, only: discretise, period_map_t, set_durations
  use gearsweep_quadrature, only: gauss_legendre
  use gearsweep_quintic, only: quintic, value_of
  use gearsweep_trace, only: trace_t
  implicit none
  private
  public :: reading_t, differentiable_t, read_motion, nearest_change

  type :: reading_t
    logical :: found = .false.                   !< contact does not change too often, and the memory holds the steps
    real(dp) :: state(2) = 0                     !< after the mesh periods, m
    real(dp) :: monodromy(2, 2) = 0              !< derivative of that by the state before them
    !> Contact sets in their order, as one number: where they differ, this most likely does.
    integer :: contacts = 0
    !> Dynamic factor; mean of the transmission error; cosine and sine part of each harmonic, m.
    real(dp), allocatable :: value(:)
  end type reading_t

  !> A motion, in coarse and in fine steps.
  type :: differentiable_t
    type(oscillator_t) :: osc
    real(dp) :: duration = 0                     !< of the mesh period, s
    integer :: periods = 1                       !< mesh periods after which it repeats
    integer :: harmonics = 0                     !< of the mesh frequency that are read
    logical :: found = .false.
    type(resolution_t) :: resolution(2)
    real(dp) :: start(2, 2) = 0                  !< its state at the begin, m; (, level)
    type(reading_t) :: reading(2)
  end type differentiable_t

contains

  !> The motion from a state, with the mesh periods, harmonics and steps of another one.
  subroutine read_motion(motion, level, osc, duration, start, map, reading)
    type(differentiable_t), intent(in) :: motion
    integer, intent(in) :: level                 !< of its steps
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< of the mesh period, s
    real(dp), intent(in) :: start(2)             !< m
    type(period_map_t), intent(inout) :: map     !< its memory serves again
    type(reading_t), intent(out) :: reading
    type(trace_t) :: trace
    type(period_t) :: run
    real(dp) :: peak, sums(2*motion%harmonics + 1)
    integer :: i

    call discretise(osc, motion%resolution(level), map)
    if (map%steps == 0) return
    call set_durations(map, [duration])
    reading%state = start
    reading%monodromy = reshape([1.0_dp, 0.0_dp, 0.0_dp, 1.0_dp], [2, 2])
    peak = 0
    sums = 0
    do i = 1, motion%periods
      trace%rows = 0
      call run_period(map, reading%state, run, trace)
      if (run%failed) return
      reading%state = run%state
      reading%monodromy = matmul(run%monodromy, reading%monodromy)
      peak = max(peak, run%peak)
      call note_contacts(trace, reading%contacts)
      call add_harmonics(trace, motion%harmonics, sums)
    end do
    reading%found = all(abs(reading%state) < huge(1.0_dp))
    reading%value = [peak/osc%load, sums/motion%periods]
  end subroutine read_motion

  !> A mesh period's contact sets in their order.
  pure subroutine note_contacts(trace, contacts)
    type(trace_t), intent(in) :: trace
    integer, intent(inout) :: contacts
    integer, parameter :: many = 1000003
    integer :: k, last

    last = -1
    do k = 1, trace%rows
      if (trace%contact_set(k) == last) cycle
      last = trace%contact_set(k)
      contacts = modulo(31*contacts + last + 1, many)
    end do
  end subroutine note_contacts

  !> Adds a mesh period's integrals of the transmission error x: of x, and of 2 x cos(2 pi k tau) and -2 x sin(2 pi k tau), so that
  !> the amplitude's phase is that of gearsweep_spectrum. By Gauss's rule, exact for steps that are much shorter than a cycle.
  pure subroutine add_harmonics(trace, harmonics, sums)
    type(trace_t), intent(in) :: trace
    integer, intent(in) :: harmonics
    real(dp), intent(inout) :: sums(:)
    integer, parameter :: points = 8
    real(dp) :: node(points), weight(points), c(0:5), x
    complex(dp) :: turn, term
    integer :: i, k, row

    call gauss_legendre(node, weight)
    do row = 1, trace%rows, 2
      c = quintic(trace%x(:, row), trace%x(:, row + 1))
      associate (width => trace%phase(row + 1) - trace%phase(row))
        do i = 1, points
          x = value_of(c, (1 + node(i))/2)*width*weight(i)/2
          sums(1) = sums(1) + x
          turn = exp(cmplx(0.0_dp, -2*pi*(trace%phase(row) + width*(1 + node(i))/2), dp))
          term = 2*x
          do k = 1, harmonics
            term = term*turn
            sums(2*k:2*k + 1) = sums(2*k:2*k + 1) + [real(term, dp), aimag(term)]
          end do
        end do
      end associate
    end do
  end subroutine add_harmonics

  !> Is the overlap that is nearest to 0, of those that decide on contact, one at a break, where a pair enters or leaves?
  subroutine nearest_change(motion, level, at_break)
    type(differentiable_t), intent(in) :: motion
    integer, intent(in) :: level
    logical, intent(out) :: at_break
    type(period_map_t) :: map
    type(trace_t) :: trace
    type(period_t) :: run
    real(dp) :: state(2), nearest
    integer :: i, k

    call discretise(motion%osc, motion%resolution(level), map)
    call set_durations(map, [motion%duration])
    allocate (trace%overlaps)
    state = motion%start(:, level)
    at_break = .false.
    nearest = huge(nearest)
    do i = 1, motion%periods
      trace%rows = 0
      trace%overlaps%count = 0
      call run_period(map, state, run, trace)
      state = run%state
      do k = 1, trace%overlaps%count
        associate (overlap => trace%overlaps%list(k))
          if (abs(overlap%value) >= nearest) cycle
          nearest = abs(overlap%value)
          at_break = overlap%at_break
        end associate
      end do
    end do
  end subroutine nearest_change
end module gearsweep_motion_reading
