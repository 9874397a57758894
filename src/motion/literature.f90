!> Methods of the literature for one mesh period, which locate no changes of contact, and their coefficients.
!>
!> - the classical Runge-Kutta method of fourth order, with contact by the overlap at each of its stages: in equal steps, as in
!> Dogan et al. 2021, or in steps that end at the breaks of the coefficients;
!> - the exact motion over steps with constant coefficients, those of the middle, and the contact at the start (Karpat et al.
!> 2012: "various parameters ... are taken as constants and an analytical solution obtained").
!>
!> The coefficients are those at the start, the middle and the end of each step. Steps that end at the breaks have one-sided
!> coefficients there; equal steps ignore breaks, so that contact is decided at each of the three places separately. The monodromy
!> matrix is the derivative of the steps' result by the state, with the contact that they found.
module gearsweep_motion_literature
  use gearsweep_base, only: dp, has_memory
  use gearsweep_mesh, only: interval_t
  use gearsweep_motion_resolution, only: resolution_t, scheme_constant, scheme_rk4
  use gearsweep_motion_contact_law, only: find_closed, find_law, find_law_values, kind_of, shared_t
  use gearsweep_motion_contact_set, only: add_to_dte, in_contact, period_t, record_contact
  use gearsweep_motion_load_peaks, only: cubic_curvature
  use gearsweep_motion_oscillator, only: acceleration, damping, mobility, oscillator_t
  use gearsweep_motion_trace, only: record, trace_t
  implicit none
  private
  public :: literature_table_t, exact_step_t, tabulate_literature, run_literature_period

  !> Exact motion over a step with constant coefficients, for the last contact set that needed it.
  type :: exact_step_t
    integer :: contact_set = -1                  !< -1: not computed
    real(dp) :: balance = 0                      !< deflection at which the forces balance, m
    real(dp) :: drift = 0                        !< change of y over the step without contact, m
    real(dp) :: propagator(2, 2) = 0             !< propagator of the distance from balance
  end type exact_step_t

  type :: literature_table_t
    integer :: scheme = 0                        !< scheme_rk4 ... of gearsweep_motion_resolution
    integer :: steps = 0                         !< steps of the period; 0: memory is too small for them
    real(dp), allocatable :: left(:), width(:)   !< start and length of a step, mesh phase; (step)
    integer, allocatable :: pairs(:)             !< pairs that may be in contact at any of its places; (step)
    integer, allocatable :: offset(:, :)         !< path coordinate of the first pair minus the phase; (place, step)
    integer, allocatable :: between(:, :)        !< contact set of the pairs between A and E; (place, step)
    !> K_j (N/m) of a pair that carries alone, 0 for one that cannot be in contact, and e_j (m), with first derivatives over the
    !> phase; the second ones, which no method uses, are 0. (0:2, pair, place, step)
    real(dp), allocatable, dimension(:, :, :, :) :: stiffness, profile_error
    real(dp), allocatable :: mobility(:, :, :)   !< acceleration per load of a pair, 1/kg; (pair, place, step)
    !> Compliance shared by neighbours (m/N) with its derivatives over the phase; (0:2, pair but the last, place, step).
    real(dp), allocatable :: shared(:, :, :, :)
    real(dp), allocatable :: coast(:, :)         !< stiffness of the coast sides, N/m; (place, step)
    type(shared_t) :: kind                       !< kind of compliance that the pairs share
    type(exact_step_t), allocatable :: exact(:)  !< with constant coefficients; (step)
  end type literature_table_t

  !> Places of a step.
  integer, parameter :: begins = 1, middle = 2, ends = 3
  !> Limit of the deflection (m), beyond any motion's.
  real(dp), parameter :: lost = 1e60_dp

contains

  !> Tabulates the period.
  pure subroutine tabulate_literature(osc, resolution, table)
    type(oscillator_t), intent(in) :: osc
    type(resolution_t), intent(in) :: resolution             !< with the scheme; not graded
    type(literature_table_t), intent(out) :: table           !< table; no steps if memory is too small
    integer, allocatable :: counts(:)
    integer :: i, k, step

    associate (intervals => osc%intervals)
      table%scheme = resolution%scheme
      table%kind = kind_of(osc%mesh, osc%pairs)
      if (table%scheme == scheme_rk4) then
        counts = resolution%times*max(1, ceiling(resolution%base*(intervals%last - intervals%first) - 1e-6_dp))
      else
        counts = [max(1, nint(resolution%times*resolution%base))]
      end if
      call allocate_table(osc, sum(counts), table)
      if (table%steps == 0) return
      step = 0
      do i = 1, size(counts)
        do k = 1, counts(i)
          step = step + 1
          if (table%scheme == scheme_rk4) then
            table%width(step) = (intervals(i)%last - intervals(i)%first)/counts(i)
            table%left(step) = intervals(i)%first + (k - 1)*table%width(step)
            call fill_aligned(osc, intervals(i), step, table)
          else
            table%width(step) = 1.0_dp/counts(i)
            table%left(step) = real(k - 1, dp)/counts(i)
            call fill_equal(osc, step, table)
          end if
        end do
      end do
    end associate
  end subroutine tabulate_literature

  pure subroutine allocate_table(osc, steps, table)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: steps
    type(literature_table_t), intent(inout) :: table
    real(dp), parameter :: small = 256e3_dp
    real(dp) :: bytes
    logical :: fits

    associate (p => osc%pairs)
      bytes = 8.0_dp*steps*(20 + 30*p)
      fits = .true.
      if (bytes > small) call has_memory(bytes, fits)
      if (.not. fits) return
      table%steps = steps
      allocate (table%left(steps), table%width(steps), table%pairs(steps), table%exact(steps))
      allocate (table%stiffness(0:2, p, 3, steps), table%profile_error(0:2, p, 3, steps), table%mobility(p, 3, steps), &
                table%shared(0:2, max(1, p - 1), 3, steps), table%coast(3, steps), source=0.0_dp)
      allocate (table%offset(3, steps), table%between(3, steps), source=0)
    end associate
  end subroutine allocate_table

  !> Fills in a step within a smooth interval.
  pure subroutine fill_aligned(osc, interval, step, table)
    type(oscillator_t), intent(in) :: osc
    type(interval_t), intent(in) :: interval
    integer, intent(in) :: step
    type(literature_table_t), intent(inout) :: table
    integer :: j, place

    table%pairs(step) = interval%pairs
    table%offset(:, step) = interval%offset
    do place = 1, 3
      table%shared(:, :size(interval%shared, 2), place, step) = interval%shared_with_slopes(phase_of(table, place, step))
      do j = 1, interval%pairs
        associate (s => interval%place(phase_of(table, place, step), j))
          call fill_pair(osc, j, place, step, s, interval%stiffness_piece(:, j), interval%piece(:, j), interval%recess(j), table)
        end associate
        if (interval%between(j)) table%between(place, step) = ibset(table%between(place, step), j - 1)
      end do
      call fill_coast(osc, place, step, table)
    end do
  end subroutine fill_aligned

  !> Fills in a step that may extend across breaks.
  pure subroutine fill_equal(osc, step, table)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: step
    type(literature_table_t), intent(inout) :: table
    ! At the end of the period no pair has entered that is not present before.
    real(dp), parameter :: before_end = 1 - 1e-12_dp
    real(dp) :: s
    integer :: j, place

    table%pairs(step) = 0
    associate (mesh => osc%mesh)
      do place = 1, 3
        table%offset(place, step) = ceiling(mesh%reach(1) - min(phase_of(table, place, step), before_end))
        do j = 1, size(table%shared, 2)
          table%shared(:, j, place, step) = mesh%shared_from(phase_of(table, place, step) + (j + table%offset(place, step)) - 1)
        end do
        do j = 1, osc%pairs
          s = phase_of(table, place, step) + (j + table%offset(place, step)) - 1
          if (s > mesh%reach(2)) cycle
          table%pairs(step) = max(table%pairs(step), j)
          call fill_pair(osc, j, place, step, s, [1, size(mesh%stiffness%breaks) - 1], spread(mesh%profile_error%locate(s), 1, 2), &
                         s > mesh%pitch_point, table)
          if (s >= 0 .and. s <= mesh%contact_ratio) table%between(place, step) = ibset(table%between(place, step), j - 1)
        end do
        call fill_coast(osc, place, step, table)
      end do
    end associate
  end subroutine fill_equal

  pure real(dp) function phase_of(table, place, step) result(phase)
    type(literature_table_t), intent(in) :: table
    integer, intent(in) :: place, step

    phase = table%left(step) + table%width(step)*(place - 1)/2
  end function phase_of

  !> Fills in pair j at the path coordinate s from these pieces of stiffness and profile error.
  pure subroutine fill_pair(osc, j, place, step, s, stiffness_piece, piece, recess, table)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: j, place, step, stiffness_piece(2), piece(2)
    real(dp), intent(in) :: s
    logical, intent(in) :: recess
    type(literature_table_t), intent(inout) :: table
    real(dp) :: k, slope
    integer :: i

    i = osc%mesh%stiffness%locate(s, stiffness_piece)
    k = osc%mesh%stiffness%value(s, i)
    slope = osc%mesh%stiffness%slope(s, i)
    table%stiffness(:, j, place, step) = [k, slope, 0.0_dp]
    table%mobility(j, place, step) = mobility(osc, s, recess)
    i = osc%mesh%profile_error%locate(s, piece)
    table%profile_error(:, j, place, step) = [osc%mesh%profile_error%value(s, i), osc%mesh%profile_error%slope(s, i), 0.0_dp]
  end subroutine fill_pair

  !> Computes the stiffness of the coast sides, backed by all pairs between A and E.
  pure subroutine fill_coast(osc, place, step, table)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: place, step
    type(literature_table_t), intent(inout) :: table
    real(dp), dimension(0:2, osc%pairs) :: effective, touching

    if (.not. osc%has_backlash) return
    call find_law(table%between(place, step), table%kind, table%stiffness(:, :, place, step), &
                  table%profile_error(:, :, place, step), table%shared(:, :, place, step), effective, touching)
    table%coast(place, step) = sum(effective(0, :))
  end subroutine fill_coast

  !> Integrates the motion over one period. The largest load is a sample at the ends of steps; where steps end at the breaks, it
  !> is the maximum of the cubic through the loads and their derivatives there.
  pure subroutine run_literature_period(osc, table, duration, start, held, period, trace)
    type(oscillator_t), intent(in) :: osc
    type(literature_table_t), intent(inout) :: table     !< caches the motion over steps with constant coefficients
    real(dp), intent(in) :: duration                     !< duration of the mesh period, s
    real(dp), intent(in) :: start(2)                     !< x and its derivative over the phase, m
    logical, intent(in) :: held                          !< the pairs between A and E stay in contact, push or pull
    type(period_t), intent(out) :: period
    type(trace_t), intent(inout), optional :: trace      !< trace to which the motion is added
    real(dp) :: before(2), state(2), columns(2, 2)
    integer :: contact_set, last_set, i

    state = start
    columns = reshape([1.0_dp, 0.0_dp, 0.0_dp, 1.0_dp], [2, 2])
    last_set = 0
    do i = 1, table%steps
      before = state
      contact_set = contacts_at(osc, table, begins, i, state(1), held)
      call record_contact(osc, contact_set, table%between(begins, i), table%between(begins, i), period)
      if (i > 1 .and. contact_set /= last_set) period%events = period%events + 1
      if (table%scheme == scheme_constant) then
        call step_exactly(osc, table, i, duration, held, state, columns)
      else
        call step_rk4(osc, table, i, duration, held, state, columns)
      end if
      last_set = contacts_at(osc, table, ends, i, state(1), held)
      call add_to_dte(table%width(i), table%width(merge(1, i + 1, i == table%steps)), &
                      [before(1), state(1)] - osc%mean_deflection, [before(2), state(2)], period%dte)
      call raise_peak(osc, table, i, [contact_set, last_set], before, state, period%peak)
      if (osc%has_backlash) period%coast_peak = max(period%coast_peak, coast_at(osc, table, begins, i, before(1)), &
                                                    coast_at(osc, table, ends, i, state(1)))
      if (present(trace)) call record_step(osc, table, i, [contact_set, last_set], reshape([before, state], [2, 2]), trace)
      ! Where steps are so long that the method is unstable, the state grows until its square would overflow.
      if (.not. maxval(abs(state)) < lost) exit
    end do
    period%state = state
    period%monodromy = columns
  end subroutine run_literature_period

  !> Finds the contact set at a place of a step and its law; where it is held, that of all pairs between A and E.
  pure subroutine find_contacts(osc, table, place, step, x, held, contact_set, effective, touching)
    type(oscillator_t), intent(in) :: osc
    type(literature_table_t), intent(in) :: table
    integer, intent(in) :: place, step
    real(dp), intent(in) :: x
    logical, intent(in) :: held
    integer, intent(out) :: contact_set
    real(dp), intent(out), dimension(1, osc%pairs) :: effective, touching

    associate (stiffness => table%stiffness(0:0, :, place, step), error => table%profile_error(0:0, :, place, step), &
               shared => table%shared(0:0, :, place, step))
      if (held) then
        contact_set = table%between(place, step)
        call find_law_values(contact_set, table%kind, stiffness, error, shared, effective, touching)
        return
      end if
      call find_closed(table%kind, stiffness, error, shared, x, contact_set, effective, touching)
    end associate
    if (osc%has_backlash) then
      if (x < -osc%backlash) contact_set = ibset(contact_set, osc%contacts - 1)
    end if
  end subroutine find_contacts

  pure integer function contacts_at(osc, table, place, step, x, held) result(contact_set)
    type(oscillator_t), intent(in) :: osc
    type(literature_table_t), intent(in) :: table
    integer, intent(in) :: place, step
    real(dp), intent(in) :: x
    logical, intent(in) :: held
    real(dp), dimension(1, osc%pairs) :: effective, touching

    call find_contacts(osc, table, place, step, x, held, contact_set, effective, touching)
  end function contacts_at

  !> Records a step: its motion is a cubic, and the loads are straight lines.
  pure subroutine record_step(osc, table, step, contact_set, state, trace)
    type(oscillator_t), intent(in) :: osc
    type(literature_table_t), intent(in) :: table
    integer, intent(in) :: step
    integer, intent(in) :: contact_set(2)        ! contact sets at both ends
    real(dp), intent(in) :: state(2, 2)          ! (x or y, end)
    type(trace_t), intent(inout) :: trace
    integer, parameter :: place(2) = [begins, ends]
    real(dp) :: x(0:2, 2), load(0:2, osc%contacts, 2)
    integer :: end

    x(0, :) = state(1, :)
    x(1, :) = table%width(step)*state(2, :)
    x(2, :) = cubic_curvature(x(0, :), [x(1, 1), x(1, 2)])
    load = 0
    do end = 1, 2
      load(0, :osc%pairs, end) = loads_at(osc, table, place(end), step, contact_set(end), state(1, end))
      if (osc%has_backlash) load(0, osc%contacts, end) = coast_at(osc, table, place(end), step, state(1, end))
    end do
    load(1, :, :) = spread(load(0, :, 2) - load(0, :, 1), 2, 2)
    call record(trace, table%pairs(step), [table%offset(begins, step), table%offset(ends, step)], &
                table%left(step) + [0.0_dp, table%width(step)], contact_set, x, load)
  end subroutine record_step

  !> Load (N) of the coast sides at a place of a step.
  pure real(dp) function coast_at(osc, table, place, step, x) result(load)
    type(oscillator_t), intent(in) :: osc
    type(literature_table_t), intent(in) :: table
    integer, intent(in) :: place, step
    real(dp), intent(in) :: x                    ! m

    load = table%coast(place, step)*max(0.0_dp, -osc%backlash - x)
  end function coast_at

  !> Loads (N) of the pairs at a place of a step; (pair).
  pure function loads_at(osc, table, place, step, contact_set, x) result(load)
    type(oscillator_t), intent(in) :: osc
    type(literature_table_t), intent(in) :: table
    integer, intent(in) :: place, step, contact_set
    real(dp), intent(in) :: x
    real(dp) :: load(osc%pairs)
    real(dp), dimension(0:2, osc%pairs) :: effective, touching

    call law_at(osc, table, place, step, contact_set, effective, touching)
    load = max(0.0_dp, effective(0, :)*(x - touching(0, :)))
  end function loads_at

  !> Computes the law of a contact set at a place of a step.
  pure subroutine law_at(osc, table, place, step, contact_set, effective, touching)
    type(oscillator_t), intent(in) :: osc
    type(literature_table_t), intent(in) :: table
    integer, intent(in) :: place, step, contact_set
    real(dp), intent(out), dimension(0:2, osc%pairs) :: effective, touching

    call find_law(contact_set, table%kind, table%stiffness(:, :, place, step), table%profile_error(:, :, place, step), &
                  table%shared(:, :, place, step), effective, touching)
  end subroutine law_at

  !> Finds the contact set at x with the coefficients of a place, and its omega^2 and sum of k e.
  pure subroutine sum_contacts(osc, table, place, step, x, held, contact_set, omega_squared, forcing)
    type(oscillator_t), intent(in) :: osc
    type(literature_table_t), intent(in) :: table
    integer, intent(in) :: place, step
    real(dp), intent(in) :: x
    logical, intent(in) :: held
    integer, intent(out) :: contact_set
    real(dp), intent(out) :: omega_squared, forcing
    real(dp), dimension(1, osc%pairs) :: effective, touching
    real(dp) :: coast

    call find_contacts(osc, table, place, step, x, held, contact_set, effective, touching)
    omega_squared = sum(table%mobility(:, place, step)*effective(1, :))
    forcing = sum(table%mobility(:, place, step)*effective(1, :)*touching(1, :))
    if (.not. osc%has_backlash) return
    if (.not. in_contact(contact_set, osc%contacts)) return
    coast = table%coast(place, step)*sum(1/osc%mass)
    omega_squared = omega_squared + coast
    forcing = forcing - coast*osc%backlash
  end subroutine sum_contacts

  !> Integrates a step by the Runge-Kutta method; where contact is held, that of all pairs between A and E.
  pure subroutine step_rk4(osc, table, step, duration, held, state, columns)
    type(oscillator_t), intent(in) :: osc
    type(literature_table_t), intent(in) :: table
    integer, intent(in) :: step
    real(dp), intent(in) :: duration
    logical, intent(in) :: held
    real(dp), intent(inout) :: state(2), columns(2, 2)
    integer, parameter :: place(4) = [begins, middle, middle, ends]
    ! State and both columns of its derivative: slopes at the stages, and the part of the step up to each stage.
    real(dp) :: z(2, 3), slope(2, 3, 4), omega_squared, forcing, damped
    real(dp), parameter :: part(4) = [0.0_dp, 0.5_dp, 0.5_dp, 1.0_dp]
    integer :: contact_set, k

    associate (h => table%width(step))
      do k = 1, 4
        z(:, 1) = state
        z(:, 2:) = columns
        if (k > 1) z = z + part(k)*h*slope(:, :, k - 1)
        call sum_contacts(osc, table, place(k), step, z(1, 1), held, contact_set, omega_squared, forcing)
        damped = damping(osc, duration)*sqrt(omega_squared)
        slope(1, :, k) = z(2, :)
        slope(2, 1, k) = acceleration(osc, omega_squared, forcing, duration, z(1, 1), z(2, 1))
        slope(2, 2:, k) = -duration**2*omega_squared*z(1, 2:) - damped*z(2, 2:)
      end do
      slope(:, :, 1) = h/6*(slope(:, :, 1) + 2*(slope(:, :, 2) + slope(:, :, 3)) + slope(:, :, 4))
      state = state + slope(:, 1, 1)
      columns = columns + slope(:, 2:, 1)
    end associate
  end subroutine step_rk4

  !> Integrates a step exactly, with the coefficients of its middle and the contact of its initial state.
  pure subroutine step_exactly(osc, table, step, duration, held, state, columns)
    type(oscillator_t), intent(in) :: osc
    type(literature_table_t), intent(inout) :: table
    integer, intent(in) :: step
    real(dp), intent(in) :: duration
    logical, intent(in) :: held
    real(dp), intent(inout) :: state(2), columns(2, 2)
    real(dp) :: omega_squared, forcing
    integer :: contact_set

    call sum_contacts(osc, table, middle, step, state(1), held, contact_set, omega_squared, forcing)
    if (contact_set /= table%exact(step)%contact_set) then
      call make_exact(osc, omega_squared*duration**2, (forcing + osc%load*sum(1/osc%mass))*duration**2, table%width(step), &
                      table%exact(step))
      table%exact(step)%contact_set = contact_set
    end if
    associate (exact => table%exact(step), h => table%width(step))
      state = matmul(exact%propagator, state - [exact%balance, 0.0_dp]) + [exact%balance + exact%drift*h/2, exact%drift]
      columns = matmul(exact%propagator, columns)
    end associate
  end subroutine step_exactly

  !> Solves x" + 2 zeta omega x' + omega^2 x = forcing over the phase exactly, with constant coefficients.
  pure subroutine make_exact(osc, omega_squared, forcing, width, exact)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: omega_squared, forcing, width
    type(exact_step_t), intent(inout) :: exact
    real(dp) :: decay, root, c, s

    exact = exact_step_t()
    if (.not. omega_squared > 0) then
      exact%propagator = reshape([1.0_dp, 0.0_dp, width, 1.0_dp], [2, 2])
      exact%drift = forcing*width
      return
    end if
    exact%balance = forcing/omega_squared
    decay = damping(osc, sqrt(omega_squared))/2
    root = sqrt(abs(omega_squared - decay**2))
    if (root*width <= 1e-8_dp) then              ! critical damping
      c = exp(-decay*width)
      s = c*width
    else if (omega_squared > decay**2) then
      c = exp(-decay*width)*cos(root*width)
      s = exp(-decay*width)*sin(root*width)/root
    else
      c = (exp((root - decay)*width) + exp(-(root + decay)*width))/2
      s = (exp((root - decay)*width) - exp(-(root + decay)*width))/(2*root)
    end if
    exact%propagator = reshape([c + decay*s, -omega_squared*s, s, c - decay*s], [2, 2])
  end subroutine make_exact

  !> Raises the largest load by the loads of a step. Where pairs share a compliance, the load depends on the contact set.
  pure subroutine raise_peak(osc, table, step, contact_set, before, state, peak)
    type(oscillator_t), intent(in) :: osc
    type(literature_table_t), intent(in) :: table
    integer, intent(in) :: step
    integer, intent(in) :: contact_set(2)        ! contact sets at both ends
    real(dp), intent(in) :: before(2), state(2)
    real(dp), intent(inout) :: peak
    real(dp), dimension(0:2, osc%pairs, 2) :: effective, touching
    real(dp), dimension(0:1, 2) :: gap, load
    integer :: j

    call law_at(osc, table, begins, step, contact_set(1), effective(:, :, 1), touching(:, :, 1))
    call law_at(osc, table, ends, step, contact_set(2), effective(:, :, 2), touching(:, :, 2))
    do j = 1, osc%pairs
      gap = reshape([before, state], [2, 2]) - touching(:1, j, :)
      load(0, :) = effective(0, j, :)*gap(0, :)
      peak = max(peak, load(0, 1), load(0, 2))
      if (table%scheme /= scheme_rk4) cycle
      load(1, :) = table%width(step)*(effective(1, j, :)*gap(0, :) + effective(0, j, :)*gap(1, :))
      if (load(1, 1) > 0 .and. load(1, 2) < 0) peak = max(peak, maximum_of_cubic(load))
    end do
  end subroutine raise_peak

  !> Maximum of the cubic with these values and derivatives at 0 and 1, where it rises at 0 and falls at 1.
  pure real(dp) function maximum_of_cubic(f)
    real(dp), intent(in) :: f(0:1, 2)
    real(dp) :: p, q, t

    p = f(1, 1) + f(1, 2) - 2*(f(0, 2) - f(0, 1))
    q = 3*(f(0, 2) - f(0, 1)) - 2*f(1, 1) - f(1, 2)
    t = f(1, 1)/(sqrt(q**2 - 3*p*f(1, 1)) - q)
    maximum_of_cubic = f(0, 1) + t*(f(1, 1) + t*(q + t*p))
  end function maximum_of_cubic
end module gearsweep_motion_literature
