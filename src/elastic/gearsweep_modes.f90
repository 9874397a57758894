!> Natural frequencies and mode shapes of a held body, by ARPACK in
!> shift-invert mode about zero with the factored stiffness.
!>
!> ARPACK keeps saved state: calls from several threads wait for each other.
module gearsweep_modes
  use gearsweep_kinds, only: dp, pi
  use gearsweep_body, only: body_t
  use gearsweep_error, only: error_t, fail, code_input, code_numerical
  use gearsweep_lapack, only: dsaupd, dseupd
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

contains

  !> The lowest `count` modes of `body`.
  !> Source: Lehoucq, Sorensen, Yang 1998, ARPACK Users' Guide, mode 3.
  subroutine find_modes(body, count, modes, error)
    type(body_t), intent(in) :: body
    integer, intent(in) :: count
    type(modes_t), intent(out) :: modes
    type(error_t), allocatable, intent(out) :: error
    real(dp), allocatable :: masses(:, :, :), values(:), vectors(:, :)

    if (count < 1 .or. 2*count + 2 > body%unknowns) then
      call fail(error, code_input, '&modal modes = '//str(count)//': must lie between 1 and '// &
        str(body%unknowns/2 - 1))
      return
    end if
    if (.not. body%material%density > 0) then
      call fail(error, code_input, '&material density_kgm3: must be above 0')
      return
    end if
    allocate (masses, source=body%mass_matrices())
    !$omp critical (gearsweep_arpack)
    call iterate(body, masses, count, values, vectors, error)
    !$omp end critical (gearsweep_arpack)
    if (allocated(error)) return
    call describe(body, masses, values, vectors, modes)
  end subroutine find_modes

  !> ARPACK's reverse communication; eigenvalues w^2 ascending.
  subroutine iterate(body, masses, count, values, vectors, error)
    type(body_t), intent(in) :: body
    real(dp), intent(in) :: masses(:, :, :)
    integer, intent(in) :: count
    real(dp), allocatable, intent(out) :: values(:), vectors(:, :)
    type(error_t), allocatable, intent(inout) :: error
    integer :: n, basis, lwork, ido, info, param(11), at(11), dof(2, nodes_per_element, size(masses, 3))
    real(dp) :: tolerance, shift
    real(dp), allocatable :: start(:), v(:, :), work(:), small(:)
    logical, allocatable :: chosen(:)

    n = body%unknowns
    basis = min(n, max(2*count + 1, count + 12))
    lwork = basis*(basis + 8)
    allocate (start(n), v(n, basis), work(3*n), small(lwork), chosen(basis), values(count))
    call fill_start(start)
    dof = reshape(body%equation(:, reshape(body%grid%element, [size(body%grid%element)])), shape(dof))
    param = 0
    param([1, 3, 7]) = [1, 300, 3]
    at = 0
    ido = 0
    info = 1
    tolerance = 1e-8_dp
    shift = 0
    do
      call dsaupd(ido, 'G', n, 'LM', count, tolerance, start, basis, v, n, param, at, work, small, lwork, info)
      associate (x => work(at(1):at(1) + n - 1), y => work(at(2):at(2) + n - 1))
        select case (ido)
        case (-1)
          call mass_times(masses, dof, x, y)
          call body%stiffness%solve_one(y)
        case (1)
          y = work(at(3):at(3) + n - 1)
          call body%stiffness%solve_one(y)
        case (2)
          call mass_times(masses, dof, x, y)
        case default
          exit
        end select
      end associate
    end do
    if (info == 0) call dseupd(.true., 'A', chosen, values, v, n, shift, 'G', n, 'LM', count, tolerance, start, &
                               basis, v, n, param(1:7), at, work, small, lwork, info)
    if (info /= 0 .or. any(.not. values > 0)) then
      call fail(error, code_numerical, 'no convergence of the modes (ARPACK '//str(info)//')')
      return
    end if
    vectors = v(:, :count)
  end subroutine iterate

  !> The same start for every run, with a part in every mode.
  pure subroutine fill_start(x)
    real(dp), intent(out) :: x(:)
    integer :: i

    do i = 1, size(x)
      x(i) = 0.1_dp + modulo(i*0.6180339887498949_dp, 1.0_dp)
    end do
  end subroutine fill_start

  !> y = M x on the unknowns, element by element: less memory to stream than a band.
  pure subroutine mass_times(masses, dof, x, y)
    real(dp), intent(in) :: masses(:, :, :), x(:)
    integer, intent(in) :: dof(:, :, :)
    real(dp), intent(out) :: y(:)
    real(dp) :: xe(nodes_per_element), ye(nodes_per_element)
    integer :: e, d, i

    y = 0
    do e = 1, size(masses, 3)
      do d = 1, 2
        do i = 1, nodes_per_element
          xe(i) = 0
          if (dof(d, i, e) > 0) xe(i) = x(dof(d, i, e))
        end do
        ye = matmul(masses(:, :, e), xe)
        do i = 1, nodes_per_element
          if (dof(d, i, e) > 0) y(dof(d, i, e)) = y(dof(d, i, e)) + ye(i)
        end do
      end do
    end do
  end subroutine mass_times

  !> Frequencies, shapes, residuals and energy shares.
  subroutine describe(body, masses, values, vectors, modes)
    type(body_t), intent(in) :: body
    real(dp), intent(in) :: masses(:, :, :), values(:), vectors(:, :)
    type(modes_t), intent(out) :: modes
    real(dp), allocatable :: u(:, :), forces(:, :)
    real(dp) :: pulled(body%unknowns), moved(body%unknowns), energy
    integer :: count, nodes, k, e, d, dof(2, nodes_per_element, size(masses, 3))

    count = size(values)
    nodes = size(body%grid%x, 2)
    dof = reshape(body%equation(:, reshape(body%grid%element, [size(body%grid%element)])), shape(dof))
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
      pulled = body%gather(reshape(forces(:, k), [2, nodes]))
      call mass_times(masses, dof, body%gather(modes%shape(:, :, k)), moved)
      modes%residual(k) = norm2(pulled - values(k)*moved)/norm2(pulled)
    end do
  end subroutine describe
end module gearsweep_modes
