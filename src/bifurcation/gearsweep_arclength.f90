!> Curves in a few dimensions: the solutions of one equation less than there are unknowns, followed by pseudo-arclength
!> continuation. From a point on the curve, the tangent predicts the next; Newton's method corrects it within the plane
!> through the prediction and normal to the tangent, so that the curve may turn back over any of its unknowns.
!> Source: Keller 1977, Numerical solution of bifurcation and nonlinear eigenvalue problems.
!>
!> The equations need only be continuous and piecewise smooth. The tangent is the vector of minors of the Jacobian, whose
!> sign is kept: along the curve it leads on through corners too, where a tangent that is told to be like the last one may
!> lead back (Allgower, Georg 1990, Numerical Continuation Methods, chapters 2 and 14).
module gearsweep_arclength
  use gearsweep_kinds, only: dp
  implicit none
  private
  public :: equations_t, correct, tangent_of, angle_between

  type, abstract :: equations_t
  contains
    procedure(evaluate_equations), deferred :: evaluate
    procedure(differentiate_equations), deferred :: differentiate
  end type equations_t

  abstract interface
    !> The left sides, all 0 on the curve.
    subroutine evaluate_equations(self, z, g, ok)
      import :: dp, equations_t
      class(equations_t), intent(inout) :: self
      real(dp), intent(in) :: z(:)               !< unknowns
      real(dp), intent(out) :: g(:)              !< one less
      logical, intent(out) :: ok                 !< they have a value there
    end subroutine evaluate_equations

    !> Their derivatives.
    subroutine differentiate_equations(self, z, jacobian, ok)
      import :: dp, equations_t
      class(equations_t), intent(inout) :: self
      real(dp), intent(in) :: z(:)
      real(dp), intent(out) :: jacobian(:, :)    !< (equation, unknown)
      logical, intent(out) :: ok
    end subroutine differentiate_equations
  end interface

  !> Newton's method has converged where a step is below this.
  real(dp), parameter :: small = 1e-11_dp

contains

  !> To the curve from a point nearby, in the plane through it with this normal. The Jacobian follows the steps by Broyden's
  !> formula, and is made anew where they do not shrink.
  subroutine correct(equations, normal, farthest, jacobian, z, ok)
    class(equations_t), intent(inout) :: equations
    real(dp), intent(in) :: normal(:)            !< of length 1
    real(dp), intent(in) :: farthest             !< distance moved, beyond which this is another curve
    real(dp), intent(inout) :: jacobian(:, :)    !< there or nearby
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

  !> The direction of the curve, of length 1: the minors of the Jacobian with alternating signs; 0 where there is none.
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

  !> Angle between two directions of length 1, rad.
  pure real(dp) function angle_between(a, b)
    real(dp), intent(in) :: a(:), b(:)

    angle_between = 2*atan2(norm2(a - b), norm2(a + b))
  end function angle_between

  !> Gauss's elimination with pivots, for a few unknowns; the determinant beside it. A system without solution has the
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
end module gearsweep_arclength
