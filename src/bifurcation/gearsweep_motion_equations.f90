!> The periodic motions of a family of oscillators as a curve: x(nT) = x(0) over state and parameter, and with a third equation
!> the places where the motion changes its kind, over a second parameter.
!>
!> The unknowns are x over the static deflection, its rate over that and the natural frequency, both of the first oscillator of
!> the family, and the parameters over their ranges, each of which is `width` long.
module gearsweep_motion_equations
  use gearsweep_arclength, only: equations_t
  use gearsweep_coefficients, only: resolution_t
  use gearsweep_contact_set, only: period_t
  use gearsweep_error, only: error_t
  use gearsweep_kinds, only: dp
  use gearsweep_oscillator, only: oscillator_t
  use gearsweep_overlaps, only: overlap_t, overlaps_t
  use gearsweep_period, only: run_period
  use gearsweep_period_map, only: discretise, period_map_t, set_durations
  use gearsweep_periodic_orbit, only: largest_multiplier
  use gearsweep_trace, only: trace_t
  implicit none
  private
  public :: family_t, motion_t, motion_equations_t, make_equations, factor_of_motion, width, kind_name

  !> Oscillators over one or two parameters.
  type, abstract :: family_t
    real(dp) :: first(2) = 0, last(2) = 0        !< ranges of the parameters, in their units
    real(dp) :: least(2) = 0                     !< no oscillator has a smaller one
    logical :: is_speed(2) = .false.             !< this parameter changes only the speed
  contains
    procedure(oscillator_at), deferred :: oscillator_at
    procedure(duration_at), deferred :: duration_at
  end type family_t

  abstract interface
    subroutine oscillator_at(self, value, osc, error)
      import :: dp, error_t, family_t, oscillator_t
      class(family_t), intent(in) :: self
      real(dp), intent(in) :: value(2)           !< of the parameters
      type(oscillator_t), intent(out) :: osc
      type(error_t), allocatable, intent(out) :: error
    end subroutine oscillator_at

    !> Duration of the mesh period, s.
    pure real(dp) function duration_at(self, value)
      import :: dp, family_t
      class(family_t), intent(in) :: self
      real(dp), intent(in) :: value(2)
    end function duration_at
  end interface

  !> A motion over some mesh periods, in the unknowns' units.
  type :: motion_t
    real(dp), allocatable :: state(:, :)         !< once a mesh period; (2, 0:periods)
    real(dp), allocatable :: each(:, :, :)       !< derivative of each state by the one before; (2, 2, periods)
    real(dp) :: monodromy(2, 2) = 0              !< all of them composed
    real(dp) :: peak = 0                         !< largest load on one pair, N
    integer :: events = 0                        !< changes of contact
    logical :: partial = .false., lost = .false., coast = .false.  !< as in `period_t`
    type(overlaps_t), allocatable :: overlaps    !< where asked for
  end type motion_t

  !> Unknown: contact or stability changes, and no place of it is known. Vertical: a line of motions at one value of the parameter.
  integer, parameter, public :: kind_fold = 1, kind_doubling = 2, kind_grazing = 3, kind_unknown = 4, kind_vertical = 5
  character(*), parameter :: kind_names(5) = [character(8) :: 'fold', 'doubling', 'grazing', 'unknown', 'vertical']
  real(dp), parameter :: width = 10

  type, extends(equations_t) :: motion_equations_t
    class(family_t), allocatable :: family
    integer :: periods = 1                       !< mesh periods until the motion repeats
    integer :: kind = 0                          !< of the third equation; 0: there is none
    type(overlap_t) :: overlap                   !< that is 0 where contact grazes
    real(dp) :: angle = 0.2_dp                   !< of the natural motion in a step, rad
    real(dp) :: value(2) = 0                     !< of the parameters, where no unknown gives them
    integer :: level = -1                        !< of `choose_steps`
    type(oscillator_t) :: osc                    !< of the last motion
    real(dp) :: scale(2) = 1                     !< static deflection (m) and its product with the natural frequency (m/s)
    type(period_map_t) :: map
    real(dp) :: made_for(2) = -huge(1.0_dp)      !< the oscillator
    integer :: made_level = -1                   !< the map
    integer :: runs = 0                          !< mesh periods computed
  contains
    procedure :: evaluate, differentiate, choose_steps, run_motion, values_at, unknown_of, special_value, need_oscillator
  end type motion_equations_t

  !> Steps of a mesh period at level 0; each further level doubles them.
  integer, parameter :: fewest_steps = 16, most_level = 12

contains

  !> The word that stands for a kind in tables.
  elemental character(8) function kind_name(kind)
    integer, intent(in) :: kind

    kind_name = kind_names(kind)
  end function kind_name

  !> The equations of a family, at the first value of each parameter.
  subroutine make_equations(family, angle, equations, error)
    class(family_t), intent(in) :: family
    real(dp), intent(in) :: angle                !< of the natural motion in a step, rad
    type(motion_equations_t), intent(out) :: equations
    type(error_t), allocatable, intent(out) :: error

    equations%family = family
    equations%angle = angle
    equations%value = family%first
    call family%oscillator_at(equations%value, equations%osc, error)
    if (allocated(error)) return
    equations%scale = equations%osc%static_deflection*[1.0_dp, equations%osc%natural_frequency]
    equations%made_for = equations%value
  end subroutine make_equations

  !> Values of the parameters at a point, within what there can be.
  pure function values_at(self, z) result(value)
    class(motion_equations_t), intent(in) :: self
    real(dp), intent(in) :: z(:)
    real(dp) :: value(2)

    value = self%value
    associate (n => size(z) - 2, family => self%family)
      value(:n) = max(family%least(:n), family%first(:n) + (family%last(:n) - family%first(:n))*z(3:)/width)
    end associate
  end function values_at

  !> The unknown that stands for a value of a parameter.
  pure real(dp) function unknown_of(self, parameter, value)
    class(motion_equations_t), intent(in) :: self
    integer, intent(in) :: parameter             !< first or second
    real(dp), intent(in) :: value

    associate (family => self%family)
      unknown_of = width*(value - family%first(parameter))/(family%last(parameter) - family%first(parameter))
    end associate
  end function unknown_of

  !> The oscillator of these values.
  subroutine need_oscillator(self, value, ok)
    class(motion_equations_t), intent(inout) :: self
    real(dp), intent(in) :: value(2)
    logical, intent(out) :: ok
    type(error_t), allocatable :: error

    ok = .true.
    if (all(self%family%is_speed .or. .not. abs(value - self%made_for) > 0)) return
    call self%family%oscillator_at(value, self%osc, error)
    self%made_for = value
    self%made_level = -1
    ok = .not. allocated(error)
  end subroutine need_oscillator

  !> Cuts the mesh period into steps that follow the natural motion at a point. Until this is called again they stay, so that
  !> the equations are continuous.
  subroutine choose_steps(self, z, ok)
    class(motion_equations_t), intent(inout) :: self
    real(dp), intent(in) :: z(:)
    logical, intent(out) :: ok
    real(dp) :: steps

    call self%need_oscillator(self%values_at(z), ok)
    if (.not. ok) return
    associate (osc => self%osc)
      steps = max(osc%natural_frequency, osc%highest_frequency*max(0.5_dp, osc%damping_ratio)) &
              *self%family%duration_at(self%values_at(z))/self%angle
    end associate
    ok = steps <= fewest_steps*2.0_dp**most_level
    if (ok) self%level = max(0, ceiling(log(steps/fewest_steps)/log(2.0_dp)))
  end subroutine choose_steps

  !> The motion that starts at a point, over its mesh periods.
  subroutine run_motion(self, z, watch, motion, ok)
    class(motion_equations_t), intent(inout) :: self
    real(dp), intent(in) :: z(:)
    logical, intent(in) :: watch                 !< the overlaps are wanted
    type(motion_t), intent(out) :: motion
    logical, intent(out) :: ok                   !< contact changes a finite number of times, and the motion stays finite
    type(trace_t) :: trace
    type(period_t) :: run
    real(dp) :: scale(2)
    integer :: i

    call prepare_map(self, z, scale, ok)
    if (.not. ok) return
    if (watch) allocate (trace%overlaps)
    allocate (motion%state(2, 0:self%periods), motion%each(2, 2, self%periods))
    motion%state(:, 0) = z(:2)
    motion%monodromy = reshape([1.0_dp, 0.0_dp, 0.0_dp, 1.0_dp], [2, 2])
    do i = 1, self%periods
      if (watch) then
        trace%rows = 0
        trace%overlaps%period = i
        call run_period(self%map, scale*motion%state(:, i - 1), run, trace)
      else
        call run_period(self%map, scale*motion%state(:, i - 1), run)
      end if
      self%runs = self%runs + 1
      motion%state(:, i) = run%state/scale
      ok = .not. run%failed .and. all(abs(motion%state(:, i)) < 1e6_dp)
      if (.not. ok) return
      motion%each(:, :, i) = run%monodromy*spread(scale, 1, 2)/spread(scale, 2, 2)
      motion%monodromy = matmul(motion%each(:, :, i), motion%monodromy)
      call add_up(run, motion)
    end do
    if (watch) call move_alloc(trace%overlaps, motion%overlaps)
  end subroutine run_motion

  !> The map of a mesh period at a point, and what multiplies the unknowns to make its state of them.
  subroutine prepare_map(self, z, scale, ok)
    class(motion_equations_t), intent(inout) :: self
    real(dp), intent(in) :: z(:)
    real(dp), intent(out) :: scale(2)
    logical, intent(out) :: ok
    real(dp) :: value(2), duration

    scale = 0
    value = self%values_at(z)
    call self%need_oscillator(value, ok)
    if (.not. ok) return
    if (self%made_level /= self%level) call discretise(self%osc, resolution_t(real(fewest_steps*2**self%level, dp)), self%map)
    self%made_level = self%level
    ok = self%map%steps > 0
    if (.not. ok) return
    duration = self%family%duration_at(value)
    call set_durations(self%map, [duration])
    scale = self%scale*[1.0_dp, duration]
  end subroutine prepare_map

  pure subroutine add_up(run, motion)
    type(period_t), intent(in) :: run
    type(motion_t), intent(inout) :: motion

    motion%peak = max(motion%peak, run%peak)
    motion%events = motion%events + run%events
    motion%partial = motion%partial .or. run%partial
    motion%lost = motion%lost .or. run%lost
    motion%coast = motion%coast .or. run%coast
  end subroutine add_up

  !> How far the motion is from repeating and, with a third equation, from where it changes its kind.
  subroutine evaluate(self, z, g, ok)
    class(motion_equations_t), intent(inout) :: self
    real(dp), intent(in) :: z(:)
    real(dp), intent(out) :: g(:)
    logical, intent(out) :: ok
    type(motion_t) :: motion

    g = 0
    call self%run_motion(z, self%kind == kind_grazing, motion, ok)
    if (.not. ok) return
    g(:2) = motion%state(:, self%periods) - z(:2)
    if (size(g) > 2) call self%special_value(motion, g(3), ok)
  end subroutine evaluate

  !> The test function of a kind: det(M - 1), det(M + 1), or the smallest overlap over the static deflection.
  subroutine special_value(self, motion, value, ok, phase)
    class(motion_equations_t), intent(in) :: self
    type(motion_t), intent(in) :: motion
    real(dp), intent(out) :: value
    logical, intent(out) :: ok
    real(dp), intent(out), optional :: phase     !< of the overlap; 0 for other kinds
    real(dp), parameter :: nearby = 0.05_dp      ! of a mesh period
    real(dp) :: trace, determinant, distance, best
    integer :: i

    ok = .true.
    value = 0
    if (present(phase)) phase = 0
    associate (m => motion%monodromy)
      trace = m(1, 1) + m(2, 2)
      determinant = m(1, 1)*m(2, 2) - m(1, 2)*m(2, 1)
    end associate
    if (self%kind == kind_fold) value = 1 - trace + determinant
    if (self%kind == kind_doubling) value = 1 + trace + determinant
    if (self%kind /= kind_grazing) return
    best = nearby
    do i = 1, motion%overlaps%count
      associate (now => motion%overlaps%list(i), sought => self%overlap)
        if (now%contact /= sought%contact .or. now%period /= sought%period .or. (now%at_break .neqv. sought%at_break)) cycle
        distance = abs(now%phase - sought%phase)
        if (distance >= best) cycle
        best = distance
        value = now%value/self%scale(1)
        if (present(phase)) phase = now%phase
      end associate
    end do
    ok = best < nearby
  end subroutine special_value

  !> Derivatives: those by the state are the monodromy matrix, with its jumps where contact changes; those by the parameters are
  !> central differences of each mesh period's map, taken to the end by the maps behind it. A third equation is differentiated
  !> by differences. The derivatives affect how fast a solution is found, not where it lies.
  subroutine differentiate(self, z, jacobian, ok)
    class(motion_equations_t), intent(inout) :: self
    real(dp), intent(in) :: z(:)
    real(dp), intent(out) :: jacobian(:, :)
    logical, intent(out) :: ok
    real(dp), parameter :: step = 1e-7_dp
    type(motion_t) :: motion
    real(dp) :: sides(size(z), 2), g(size(z) - 1, 2)
    integer :: i, k

    jacobian = 0
    call self%run_motion(z, .false., motion, ok)
    if (.not. ok) return
    do i = merge(1, 3, size(z) > 3), size(z)
      sides = spread(z, 2, 2)
      sides(i, :) = z(i) + step*[-1, 1]
      if (i > 2) sides(i, 1) = max(sides(i, 1), self%unknown_of(i - 2, self%family%least(i - 2)))
      if (size(z) > 3) then
        do k = 1, 2
          call self%evaluate(sides(:, k), g(:, k), ok)
          if (.not. ok) return
        end do
        jacobian(3, i) = (g(3, 2) - g(3, 1))/(sides(i, 2) - sides(i, 1))
      end if
      if (i > 2) call differentiate_maps(self, motion, sides, i, jacobian(:2, i), ok)
      if (.not. ok) return
    end do
    jacobian(:2, :2) = motion%monodromy
    jacobian(1, 1) = jacobian(1, 1) - 1
    jacobian(2, 2) = jacobian(2, 2) - 1
  end subroutine differentiate

  !> The derivative of the last state of a motion by an unknown that is a parameter, from both sides.
  subroutine differentiate_maps(self, motion, sides, unknown, column, ok)
    class(motion_equations_t), intent(inout) :: self
    type(motion_t), intent(in) :: motion
    real(dp), intent(in) :: sides(:, :)
    integer, intent(in) :: unknown
    real(dp), intent(out) :: column(2)
    logical, intent(out) :: ok
    type(period_t) :: run
    real(dp) :: ends(2, self%periods, 2), scale(2)
    integer :: i, k

    column = 0
    do k = 1, 2
      call prepare_map(self, sides(:, k), scale, ok)
      if (.not. ok) return
      do i = 1, self%periods
        call run_period(self%map, scale*motion%state(:, i - 1), run)
        ends(:, i, k) = run%state/scale
        ok = .not. run%failed
        if (.not. ok) return
      end do
    end do
    self%runs = self%runs + 2*self%periods
    do i = 1, self%periods
      column = matmul(motion%each(:, :, i), column) + (ends(:, i, 2) - ends(:, i, 1))/(sides(unknown, 2) - sides(unknown, 1))
    end do
  end subroutine differentiate_maps

  !> The dynamic factor of a motion, and the largest modulus of its multipliers.
  pure function factor_of_motion(osc, motion) result(factor)
    type(oscillator_t), intent(in) :: osc
    type(motion_t), intent(in) :: motion
    real(dp) :: factor(2)

    factor = [motion%peak/osc%load, largest_multiplier(motion%monodromy)]
  end function factor_of_motion
end module gearsweep_motion_equations
