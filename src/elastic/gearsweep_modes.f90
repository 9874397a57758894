!> Natural frequencies and mode shapes of a held body, by block Lanczos
!> in shift-invert mode about zero with the factored stiffness.
module gearsweep_modes
  use gearsweep_kinds, only: dp, pi
  use gearsweep_blas, only: begin_products, end_products
  use gearsweep_body, only: body_t
  use gearsweep_error, only: error_t, fail, code_input, code_numerical
  use gearsweep_lapack, only: dgemm, dsyev
  use gearsweep_memory, only: claim_memory
  use gearsweep_q8, only: nodes_per_element
  use gearsweep_text, only: str
  implicit none
  private
  public :: modes_t, find_modes

  type :: modes_t
    real(dp), allocatable :: frequency(:)        !< Hz, ascending
    real(dp), allocatable :: shape(:, :, :)      !< displacements for unit modal mass (2, nodes, modes), kg**-0.5
    real(dp), allocatable :: residual(:)         !< |K u - w^2 M u| / |K u|
    !> Share of each part's kinetic energy: rim (0), then the teeth (0:parts, modes).
    real(dp), allocatable :: participation(:, :)
  end type modes_t

  integer, parameter :: block = 2                !< vectors at a time; more read less and compute more
  real(dp), parameter :: tolerance = 1e-9_dp     !< of the shapes

contains

  !> The lowest `count` modes of `body`.
  subroutine find_modes(body, count, modes, error)
    type(body_t), intent(in) :: body
    integer, intent(in) :: count
    type(modes_t), intent(out) :: modes
    type(error_t), allocatable, intent(out) :: error
    real(dp), allocatable :: masses(:, :, :), values(:), vectors(:, :)
    integer, allocatable :: dof(:, :, :)

    if (count < 1 .or. 2*count + 2 > body%unknowns) then
      call fail(error, code_input, '&modal modes = '//str(count)//': must lie between 1 and '// &
        str(body%unknowns/2 - 1))
      return
    end if
    if (.not. body%material%density > 0) then
      call fail(error, code_input, '&material density_kgm3: must be above 0')
      return
    end if
    call claim_modes(body, count, error)
    if (allocated(error)) return
    allocate (masses, source=body%mass_matrices())
    dof = reshape(body%equation(:, reshape(body%grid%element, [size(body%grid%element)])), &
                  [2, nodes_per_element, size(masses, 3)])
    call iterate(body, masses, dof, count, values, vectors, error)
    if (allocated(error)) return
    call describe(body, masses, dof, values, vectors, modes)
  end subroutine find_modes

  !> How many vectors the basis may have.
  pure integer function most_vectors(unknowns, count)
    integer, intent(in) :: unknowns, count

    most_vectors = min(unknowns, 10*count + 300)
  end function most_vectors

  !> The basis and its product, of which usually some three vectors a mode are touched, the small problem with
  !> its vectors, the modes in several forms, and the elements' masses.
  subroutine claim_modes(body, count, error)
    type(body_t), intent(in) :: body
    integer, intent(in) :: count
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: basis, most, others, usual

    most = most_vectors(body%unknowns, count)
    basis = 16.0_dp*body%unknowns*most
    usual = min(1.0_dp, (3*count + 100)/most)
    others = 8.0_dp*body%unknowns*(5*count + 20) + 16.0_dp*size(body%grid%x, 2)*(7*count + 10) &
             + 1300.0_dp*size(body%grid%element, 2)
    call claim_memory(basis + 48*most**2 + others, '&modal modes = '//str(count), error, &
                      used=usual*basis + 48*(usual*most)**2 + others, blas=.true.)
  end subroutine claim_modes

  !> Block Lanczos on K^-1 M without restart, every vector made M-orthogonal to
  !> all before; eigenvalues w^2 ascending.
  !>
  !> The factor is larger than the cache, so that reading it is what takes time:
  !> a block of vectors reads it once. Untouched columns of the basis cost no memory.
  !> Source: Golub, Van Loan 2013, Matrix Computations, section 10.3.
  subroutine iterate(body, masses, dof, count, values, vectors, error)
    type(body_t), intent(in) :: body
    real(dp), intent(in) :: masses(:, :, :)
    integer, intent(in) :: dof(:, :, :), count
    real(dp), allocatable, intent(out) :: values(:), vectors(:, :)
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: v(:, :), mv(:, :), w(:, :), mw(:, :), t(:, :), ritz(:, :), theta(:), share(:, :)
    integer :: n, most, before, k, info
    logical :: done

    n = body%unknowns
    most = most_vectors(n, count)
    allocate (v(n, most), mv(n, most), t(most, most), w(n, min(block, count + 1)))
    call fill_start(w)
    mw = mass_times(masses, dof, w)
    call orthonormalise(w, mw)
    k = 0
    done = .false.
    do while (k < most .and. size(w, 2) > 0)
      before = k
      k = min(most, k + size(w, 2))
      v(:, before + 1:k) = w(:, :k - before)
      mv(:, before + 1:k) = mw(:, :k - before)
      w = mv(:, before + 1:k)
      call body%stiffness%solve(w)
      call subtract_basis(share)
      t(:k, before + 1:k) = share
      if (k >= count) then
        call eigenvectors(t(:k, :k), theta, ritz, info)
        if (info /= 0) exit
        done = is_converged(inner(w, mw), theta(k - count + 1:), ritz(before + 1:, k - count + 1:))
        if (done) exit
      end if
      ! Twice is enough.
      call orthonormalise(w, mw)
      call subtract_basis(share)
      call orthonormalise(w, mw)
    end do
    if (.not. done) then
      call fail(error, code_numerical, 'no convergence of the modes with '//str(k)//' vectors')
      return
    end if
    values = 1/theta(k:k - count + 1:-1)
    allocate (vectors(n, count))
    ! One more step of the iteration, K^-1 M x/theta, is at hand: its rough part is much smaller.
    ritz = ritz(:, k:k - count + 1:-1)
    call begin_products()
    call dgemm('N', 'N', n, count, k, 1.0_dp, v, n, ritz, k, 0.0_dp, vectors, n)
    call end_products()
    vectors = vectors + matmul(w, ritz(before + 1:, :)*spread(values, 1, k - before))

  contains

    !> Takes from `w` its share in the basis, as components of that.
    subroutine subtract_basis(share)
      real(dp), allocatable, intent(out) :: share(:, :)

      share = inner(mv(:, :k), w)
      call begin_products()
      call dgemm('N', 'N', n, size(w, 2), k, -1.0_dp, v, n, share, k, 1.0_dp, w, n)
      call end_products()
      mw = mass_times(masses, dof, w)
    end subroutine subtract_basis
  end subroutine iterate

  !> The same start for every run, with a part in every mode.
  pure subroutine fill_start(x)
    real(dp), intent(out) :: x(:, :)
    integer :: i, j

    do j = 1, size(x, 2)
      do i = 1, size(x, 1)
        x(i, j) = 0.1_dp + modulo(i*sqrt(real(j, dp))*0.6180339887498949_dp, 1.0_dp)
      end do
    end do
  end subroutine fill_start

  !> Makes the columns of `w` M-orthonormal; one that depends on the others is left out.
  pure subroutine orthonormalise(w, mw)
    real(dp), allocatable, intent(inout) :: w(:, :), mw(:, :)
    real(dp) :: length, was, share
    integer :: i, j, k

    k = 0
    do j = 1, size(w, 2)
      was = dot_product(w(:, j), mw(:, j))
      do i = 1, k
        share = dot_product(mw(:, i), w(:, j))
        w(:, j) = w(:, j) - share*w(:, i)
        mw(:, j) = mw(:, j) - share*mw(:, i)
      end do
      length = dot_product(w(:, j), mw(:, j))
      if (.not. length > 1e-20_dp*was) cycle
      k = k + 1
      w(:, k) = w(:, j)/sqrt(length)
      mw(:, k) = mw(:, j)/sqrt(length)
    end do
    w = w(:, :k)
    mw = mw(:, :k)
  end subroutine orthonormalise

  !> |K^-1 M x - theta x| <= tolerance theta in the norm of M, from what the newest
  !> block leaves outside the basis: its Gram matrix, and the last rows of the Ritz vectors.
  pure logical function is_converged(gram, theta, last)
    real(dp), intent(in) :: gram(:, :), theta(:), last(:, :)

    is_converged = all(theta > 0 .and. sum(last*matmul(gram, last), 1) <= (tolerance*theta)**2)
  end function is_converged

  !> a' b
  function inner(a, b) result(c)
    real(dp), intent(in), contiguous :: a(:, :), b(:, :)
    real(dp) :: c(size(a, 2), size(b, 2))

    c = 0
    call begin_products()
    call dgemm('T', 'N', size(a, 2), size(b, 2), size(a, 1), 1.0_dp, a, size(a, 1), b, size(b, 1), 0.0_dp, c, size(c, 1))
    call end_products()
  end function inner

  !> Of a symmetric matrix, whose upper triangle counts; eigenvalues ascending.
  subroutine eigenvectors(t, values, vectors, info)
    real(dp), intent(in) :: t(:, :)
    real(dp), allocatable, intent(out) :: values(:), vectors(:, :)
    integer, intent(out) :: info
    real(dp) :: work(34*size(t, 1))

    allocate (values(size(t, 1)))
    vectors = t
    call begin_products()
    call dsyev('V', 'U', size(values), vectors, size(values), values, work, size(work), info)
    call end_products()
  end subroutine eigenvectors

  !> y = M x on the unknowns, element by element: less memory to stream than a band.
  pure function mass_times(masses, dof, x) result(y)
    real(dp), intent(in) :: masses(:, :, :), x(:, :)
    integer, intent(in) :: dof(:, :, :)
    real(dp) :: y(size(x, 1), size(x, 2))
    real(dp) :: xe(nodes_per_element), ye(nodes_per_element)
    integer :: e, d, i, j

    y = 0
    do e = 1, size(masses, 3)
      do j = 1, size(x, 2)
        do d = 1, 2
          do i = 1, nodes_per_element
            xe(i) = 0
            if (dof(d, i, e) > 0) xe(i) = x(dof(d, i, e), j)
          end do
          ye = 0
          do i = 1, nodes_per_element
            ye = ye + masses(:, i, e)*xe(i)
          end do
          do i = 1, nodes_per_element
            if (dof(d, i, e) > 0) y(dof(d, i, e), j) = y(dof(d, i, e), j) + ye(i)
          end do
        end do
      end do
    end do
  end function mass_times

  !> Frequencies, shapes, residuals and energy shares.
  subroutine describe(body, masses, dof, values, vectors, modes)
    type(body_t), intent(in) :: body
    real(dp), intent(in) :: masses(:, :, :), values(:), vectors(:, :)
    integer, intent(in) :: dof(:, :, :)
    type(modes_t), intent(out) :: modes
    real(dp), allocatable :: u(:, :), forces(:, :)
    real(dp) :: pulled(body%unknowns), moved(body%unknowns, size(values)), energy
    integer :: count, nodes, k, e, d

    count = size(values)
    nodes = size(body%grid%x, 2)
    modes%frequency = sqrt(values)/(2*pi)
    allocate (modes%shape(2, nodes, count), modes%residual(count))
    allocate (modes%participation(0:maxval(body%grid%part), count), source=0.0_dp)
    do k = 1, count
      modes%shape(:, :, k) = body%spread_out(vectors(:, k))
      do e = 1, size(masses, 3)
        associate (list => body%grid%element(:, e), part => body%grid%part(e))
          do d = 1, 2
            energy = dot_product(modes%shape(d, list, k), matmul(masses(:, :, e), modes%shape(d, list, k)))
            modes%participation(part, k) = modes%participation(part, k) + energy
          end do
        end associate
      end do
      modes%shape(:, :, k) = modes%shape(:, :, k)/sqrt(sum(modes%participation(:, k)))
      modes%participation(:, k) = modes%participation(:, k)/sum(modes%participation(:, k))
    end do
    u = reshape(modes%shape, [2*nodes, count])
    forces = body%stiffness_times(u)
    do k = 1, count
      moved(:, k) = body%gather(modes%shape(:, :, k))
    end do
    moved = mass_times(masses, dof, moved)
    do k = 1, count
      pulled = body%gather(reshape(forces(:, k), [2, nodes]))
      modes%residual(k) = norm2(pulled - values(k)*moved(:, k))/norm2(pulled)
    end do
  end subroutine describe
end module gearsweep_modes
