!> Periodic motions of a family of oscillators as a curve, followed by pseudo-arclength continuation.
!>
!> The equations are x(nT) = x(0) over state and parameter. The unknowns are x over the static deflection, its rate over that
!> and the natural frequency, both of the first oscillator of the family, and the parameter over its range, which is `width` long.
!>
!> From a point on the curve, the tangent predicts the next; Newton's method corrects it within the plane through the
!> prediction and normal to the tangent, so that the curve may turn back over any of its unknowns.
!> Source: Keller 1977, Numerical solution of bifurcation and nonlinear eigenvalue problems.
!>
!> The equations need only be continuous and piecewise smooth. The tangent is the vector of minors of the Jacobian, whose sign
!> is kept: the curve therefore continues through corners, where a tangent chosen for the smallest angle to the last one may turn
!> back (Allgower, Georg 1990, Numerical Continuation Methods, chapters 2 and 14).
module gearsweep_nonlinear_motion_equations
  use gearsweep_base, only: dp, error_t
  use gearsweep_motion, only: discretise, dte_t, join, largest_multiplier, oscillator_t, overlap_t, overlaps_t, period_map_t, &
    period_t, resolution_t, run_period, set_durations, trace_t
  implicit none
  private
  public :: correct, tangent_of, angle_between, family_t, motion_t, motion_equations_t, make_equations, factor_of_motion, width, &
            kind_names

  !> Step size below which Newton's method has converged. Next to a grazing it leaves a thousand times as much in the parameter.
  real(dp), parameter :: small = 1e-12_dp

  !> Oscillators over a parameter.
  type, abstract :: family_t
    real(dp) :: first = 0, last = 0              !< range of the parameter, in its unit
    real(dp) :: least = 0                        !< least value of the parameter for which an oscillator exists
    logical :: is_speed = .false.                !< true if the parameter changes only the speed
  contains
    procedure(oscillator_at), deferred :: oscillator_at
    procedure(duration_at), deferred :: duration_at
  end type family_t

  abstract interface
    subroutine oscillator_at(self, value, osc, error)
      import :: dp, error_t, family_t, oscillator_t
      class(family_t), intent(in) :: self
      real(dp), intent(in) :: value              !< value of the parameter
      type(oscillator_t), intent(out) :: osc
      type(error_t), allocatable, intent(out) :: error
    end subroutine oscillator_at

    !> Duration of the mesh period, s.
    pure real(dp) function duration_at(self, value)
      import :: dp, family_t
      class(family_t), intent(in) :: self
      real(dp), intent(in) :: value
    end function duration_at
  end interface

  !> A motion over some mesh periods, in the unknowns' units.
  type :: motion_t
    real(dp), allocatable :: state(:, :)         !< state once a mesh period; (2, 0:periods)
    real(dp), allocatable :: each(:, :, :)       !< derivative of each state by the previous one; (2, 2, periods)
    real(dp) :: monodromy(2, 2) = 0              !< product of these derivatives
    real(dp) :: peak = 0                         !< largest load on one pair, N
    type(dte_t) :: dte                           !< dynamic transmission error
    integer :: events = 0                        !< number of contact events
    logical :: partial = .false., lost = .false., coast = .false.  !< as in `period_t`
    type(overlaps_t), allocatable :: overlaps    !< overlaps, if requested
  end type motion_t

  !> Unknown: contact or stability changes at an unknown point. Vertical: a line of motions at one value of the parameter.
  integer, parameter, public :: kind_fold = 1, kind_doubling = 2, kind_grazing = 3, kind_unknown = 4, kind_vertical = 5
  !> Words for them in tables.
  character(*), parameter :: kind_names(5) = [character(8) :: 'fold', 'doubling', 'grazing', 'unknown', 'vertical']
  real(dp), parameter :: width = 10

  type :: motion_equations_t
    class(family_t), allocatable :: family
    integer :: periods = 1                       !< mesh periods until the motion repeats
    real(dp) :: angle = 0.2_dp                   !< step, rad of the natural motion
    integer :: level = -1                        !< refinement level of `choose_steps`
    type(oscillator_t) :: osc                    !< oscillator of the last motion
    real(dp) :: scale(2) = 1                     !< static deflection (m) and its product with the natural frequency (m/s)
    type(period_map_t) :: map
    real(dp) :: made_for = -huge(1.0_dp)         !< parameter of the oscillator
    integer :: made_level = -1                   !< level of the period map
    integer :: runs = 0                          !< number of mesh periods computed
  contains
    procedure :: evaluate, differentiate, choose_steps, run_motion, value_at, need_oscillator
  end type motion_equations_t

  !> Steps of a mesh period at level 0; each further level doubles them.
  integer, parameter :: fewest_steps = 16, most_level = 12

contains

  !> Corrects a nearby point to the curve, in the plane through it with this normal. The Jacobian is updated by Broyden's formula,
  !> and computed again if the steps do not decrease.
  subroutine correct(equations, normal, farthest, jacobian, z, ok)
    class(motion_equations_t), intent(inout) :: equations
    real(dp), intent(in) :: normal(:)            !< unit normal
    real(dp), intent(in) :: farthest             !< largest distance of the correction; beyond it lies another curve
    real(dp), intent(inout) :: jacobian(:, :)    !< Jacobian at the point or nearby
    real(dp), intent(inout) :: z(:)
    logical, intent(out) :: ok
    integer, parameter :: most_iterations = 24, renewed = 6
    real(dp), dimension(size(z)) :: step, right, start
    real(dp) :: a(size(z), size(z)), g(size(z) - 1), determinant
    integer :: iteration, n

    n = size(z)
    start = z
    call equations%evaluate(z, g, ok)
    do iteration = 1, most_iterations
      if (.not. ok) return
      if (modulo(iteration, renewed) == 0) call equations%differentiate(z, jacobian, ok)
      if (.not. ok) return
      a(:n - 1, :) = jacobian
      a(n, :) = normal
      right(:n - 1) = -g
      right(n) = 0
      call solve_small(a, right, step, determinant)
      ok = abs(determinant) > 0
      if (ok) ok = all(abs(step) < 2*farthest)
      if (.not. ok) return
      z = z + step
      ok = norm2(z - start) <= farthest
      if (.not. ok .or. maxval(abs(step)) < small) return
      call equations%evaluate(z, g, ok)
      jacobian = jacobian + spread(g/dot_product(step, step), 2, n)*spread(step, 1, n - 1)
    end do
    ok = .false.
  end subroutine correct

  !> Unit tangent of the curve: the minors of the Jacobian with alternating signs; 0 if there is none.
  pure function tangent_of(jacobian) result(tangent)
    real(dp), intent(in) :: jacobian(:, :)
    real(dp), dimension(size(jacobian, 2)) :: tangent
    real(dp) :: minor(size(jacobian, 1), size(jacobian, 1)), length
    real(dp), dimension(size(jacobian, 1)) :: right, x
    integer :: i, n

    n = size(jacobian, 2)
    right = 0
    do i = 1, n
      minor(:, :i - 1) = jacobian(:, :i - 1)
      minor(:, i:) = jacobian(:, i + 1:)
      call solve_small(minor, right, x, tangent(i))
      if (modulo(n - i, 2) == 1) tangent(i) = -tangent(i)
    end do
    length = norm2(tangent)
    if (length > 0) tangent = tangent/length
  end function tangent_of

  !> Angle between two unit directions, rad.
  pure real(dp) function angle_between(a, b)
    real(dp), intent(in) :: a(:), b(:)

    angle_between = 2*atan2(norm2(a - b), norm2(a + b))
  end function angle_between

  !> Solves a few equations by Gaussian elimination with pivoting, and returns the determinant. A singular system has the
  !> determinant 0 and the solution 0.
  pure subroutine solve_small(matrix, right, x, determinant)
    real(dp), intent(in) :: matrix(:, :), right(:)
    real(dp), intent(out) :: x(:)
    real(dp), intent(out) :: determinant
    real(dp) :: a(size(right), size(right) + 1), row(size(right) + 1)
    integer :: i, k, n, pivot

    n = size(right)
    a(:, :n) = matrix
    a(:, n + 1) = right
    determinant = 1
    x = 0
    do i = 1, n
      pivot = i - 1 + maxloc(abs(a(i:, i)), 1)
      determinant = determinant*a(pivot, i)*merge(1, -1, pivot == i)
      if (.not. abs(a(pivot, i)) > 0) return
      row = a(pivot, :)
      a(pivot, :) = a(i, :)
      a(i, :) = row/row(i)
      do k = i + 1, n
        a(k, :) = a(k, :) - a(k, i)*a(i, :)
      end do
    end do
    do i = n, 1, -1
      x(i) = a(i, n + 1) - dot_product(a(i, i + 1:n), x(i + 1:))
    end do
  end subroutine solve_small

  !> Builds the equations of a family, at the first value of the parameter.
  subroutine make_equations(family, angle, equations, error)
    class(family_t), intent(in) :: family
    real(dp), intent(in) :: angle                !< step, rad of the natural motion
    type(motion_equations_t), intent(out) :: equations
    type(error_t), allocatable, intent(out) :: error

    equations%family = family
    equations%angle = angle
    call family%oscillator_at(family%first, equations%osc, error)
    if (allocated(error)) return
    equations%scale = equations%osc%static_deflection*[1.0_dp, equations%osc%natural_frequency]
    equations%made_for = family%first
  end subroutine make_equations

  !> Value of the parameter at a point, limited to the possible ones.
  pure real(dp) function value_at(self, z)
    class(motion_equations_t), intent(in) :: self
    real(dp), intent(in) :: z(3)

    associate (family => self%family)
      value_at = max(family%least, family%first + (family%last - family%first)*z(3)/width)
    end associate
  end function value_at

  !> Builds the oscillator for this value, unless it is the last one.
  subroutine need_oscillator(self, value, ok)
    class(motion_equations_t), intent(inout) :: self
    real(dp), intent(in) :: value
    logical, intent(out) :: ok
    type(error_t), allocatable :: error

    ok = .true.
    if (self%family%is_speed .or. .not. abs(value - self%made_for) > 0) return
    call self%family%oscillator_at(value, self%osc, error)
    self%made_for = value
    self%made_level = -1
    ok = .not. allocated(error)
  end subroutine need_oscillator

  !> Divides the mesh period into steps that resolve the natural motion at a point. The steps are kept until the next call, so that
  !> the equations are continuous.
  subroutine choose_steps(self, z, ok)
    class(motion_equations_t), intent(inout) :: self
    real(dp), intent(in) :: z(3)
    logical, intent(out) :: ok
    real(dp) :: steps

    call self%need_oscillator(self%value_at(z), ok)
    if (.not. ok) return
    associate (osc => self%osc)
      steps = max(osc%natural_frequency, osc%highest_frequency*max(0.5_dp, osc%damping_ratio)) &
              *self%family%duration_at(self%value_at(z))/self%angle
    end associate
    ok = steps <= fewest_steps*2.0_dp**most_level
    if (ok) self%level = max(0, ceiling(log(steps/fewest_steps)/log(2.0_dp)))
  end subroutine choose_steps

  !> Computes the motion that starts at a point, over its mesh periods.
  subroutine run_motion(self, z, watch, motion, ok)
    class(motion_equations_t), intent(inout) :: self
    real(dp), intent(in) :: z(3)
    logical, intent(in) :: watch                 !< true: also the overlaps
    type(motion_t), intent(out) :: motion
    logical, intent(out) :: ok                   !< true if the number of contact changes and the motion are finite
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
      motion%peak = max(motion%peak, run%peak)
      motion%dte = join(motion%dte, run%dte)
      motion%events = motion%events + run%events
      motion%partial = motion%partial .or. run%partial
      motion%lost = motion%lost .or. run%lost
      motion%coast = motion%coast .or. run%coast
    end do
    if (watch) call move_alloc(trace%overlaps, motion%overlaps)
  end subroutine run_motion

  !> Prepares the period map at a point, and the factors from the unknowns to its state.
  subroutine prepare_map(self, z, scale, ok)
    class(motion_equations_t), intent(inout) :: self
    real(dp), intent(in) :: z(3)
    real(dp), intent(out) :: scale(2)
    logical, intent(out) :: ok
    real(dp) :: value, duration

    scale = 0
    value = self%value_at(z)
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

  !> Evaluates x(nT) - x(0).
  subroutine evaluate(self, z, g, ok)
    class(motion_equations_t), intent(inout) :: self
    real(dp), intent(in) :: z(3)
    real(dp), intent(out) :: g(2)                !< residuals
    logical, intent(out) :: ok                   !< true if they exist there
    type(motion_t) :: motion

    g = 0
    call self%run_motion(z, .false., motion, ok)
    if (ok) g = motion%state(:, self%periods) - z(:2)
  end subroutine evaluate

  !> Evaluates the derivatives. Those by the state are the monodromy matrix, with its jumps at contact events; those by the
  !> parameter are central differences of each mesh period's map, multiplied by the later maps. They affect the speed of
  !> convergence, not the solution.
  subroutine differentiate(self, z, jacobian, ok)
    class(motion_equations_t), intent(inout) :: self
    real(dp), intent(in) :: z(3)
    real(dp), intent(out) :: jacobian(2, 3)
    logical, intent(out) :: ok
    real(dp), parameter :: step = 1e-7_dp
    type(motion_t) :: motion
    real(dp) :: sides(3, 2), ends(2, self%periods, 2), scale(2)
    type(period_t) :: run
    integer :: i, k

    jacobian = 0
    call self%run_motion(z, .false., motion, ok)
    if (.not. ok) return
    sides = spread(z, 2, 2)
    sides(3, :) = z(3) + step*[-1, 1]
    associate (family => self%family)
      sides(3, 1) = max(sides(3, 1), width*(family%least - family%first)/(family%last - family%first))
    end associate
    jacobian(:, 3) = 0
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
      jacobian(:, 3) = matmul(motion%each(:, :, i), jacobian(:, 3)) + (ends(:, i, 2) - ends(:, i, 1))/(sides(3, 2) - sides(3, 1))
    end do
    jacobian(:, :2) = motion%monodromy
    jacobian(1, 1) = jacobian(1, 1) - 1
    jacobian(2, 2) = jacobian(2, 2) - 1
  end subroutine differentiate

  !> Dynamic factor of a motion, and the largest modulus of its multipliers.
  pure function factor_of_motion(osc, motion) result(factor)
    type(oscillator_t), intent(in) :: osc
    type(motion_t), intent(in) :: motion
    real(dp) :: factor(2)

    factor = [motion%peak/osc%load, largest_multiplier(motion%monodromy)]
  end function factor_of_motion
end module gearsweep_nonlinear_motion_equations
