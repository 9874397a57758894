!> Piecewise polynomials and splines against brute force: random pieces, their values, slopes, integrals and extremes;
!> what makes a spline; a picture's file read back.
module test_piecewise
  use gearsweep_base_error, only: error_t
  use gearsweep_elastic_grid, only: grid_t
  use gearsweep_base_kinds, only: dp
  use gearsweep_base_piecewise, only: piecewise_t, polynomial, spline
  use gearsweep_base_text, only: str
  use gearsweep_elastic_vtu, only: vtu_field_t, write_vtu
  use test_support_random_numbers, only: random_t
  use test_support_plain_grids, only: rectangle_grid
  use test_support_testing, only: tally_t, check_true, check_close, check_equal, check_no_error
  implicit none
  private
  public :: run

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('random_pieces')) call random_pieces(t)
    if (t%wants('splines')) call splines(t)
    if (t%wants('picture_read_back')) call picture_read_back(t)
  end subroutine run

  !> Pieces of degrees 0 to 6 with jumps between them.
  subroutine random_pieces(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: samples = 4000
    type(random_t) :: random
    type(piecewise_t) :: p, counted_from_one
    real(dp) :: x(7), f(7), slope(7), bend(7), first, last, sum_of, scan(0:samples), least, largest
    integer :: n, i, k, degree, pieces, piece

    do n = 1, 30
      degree = mod(n, 7)
      pieces = 1 + mod(n, 4)
      p%breaks = [(0.3_dp*i + 0.2_dp*random%uniform(), i=0, pieces)]
      p%coef = reshape([(random%between(-1.0_dp, 1.0_dp), i=1, (degree + 1)*pieces)], [degree + 1, pieces])
      p = from_zero(p%breaks, p%coef)
      first = p%breaks(1)
      last = p%breaks(pieces + 1)
      least = huge(least)
      largest = -huge(largest)
      sum_of = 0
      do i = 1, pieces
        scan = [(naive(i, -1 + 2.0_dp*k/samples), k=0, samples)]
        least = min(least, minval(scan))
        largest = max(largest, maxval(scan))
        ! Simpson's rule.
        sum_of = sum_of + (p%breaks(i + 1) - p%breaks(i))/(3*samples) &
                 *(scan(0) + 4*sum(scan(1:samples - 1:2)) + 2*sum(scan(2:samples - 2:2)) + scan(samples))
      end do
      call check_close(t, 'least value', p%minimum(), least, absolute=1e-5_dp)
      call check_close(t, 'largest value', p%maximum(), largest, absolute=1e-5_dp)
      call check_true(t, 'no sample beyond', p%minimum() <= least + 1e-13_dp .and. p%maximum() >= largest - 1e-13_dp)
      counted_from_one%breaks = p%breaks
      counted_from_one%coef = reshape(p%coef, shape(p%coef))
      call check_equal(t, 'coefficients counted from 1', lbound(counted_from_one%coef, 1), 1)
      call check_close(t, 'largest value of these', counted_from_one%maximum(), largest, absolute=1e-5_dp)
      call check_close(t, 'integral', p%integral(first, last), sum_of, absolute=1e-12_dp)
      x = [(first + (last - first)*(i - 0.5_dp)/7, i=1, 7)]
      call check_close(t, 'parts of an integral', p%integral(first, x(3)) + p%integral(x(3), x(6)) + p%integral(x(6), last), &
                       sum_of, absolute=1e-12_dp)
      call p%sample(x, [1, pieces], f, slope, bend)
      do k = 1, 7
        piece = count(p%breaks(:pieces) <= x(k))
        call check_equal(t, 'piece', p%locate(x(k)), piece)
        associate (half => (p%breaks(piece + 1) - p%breaks(piece))/2, h => 1e-4_dp)
          associate (v => (x(k) - p%breaks(piece))/half - 1)
            call check_close(t, 'value', p%value(x(k)), naive(piece, v), absolute=1e-13_dp)
            call check_close(t, 'slope', p%slope(x(k)), (naive(piece, v + h) - naive(piece, v - h))/(2*h*half), absolute=1e-5_dp)
            call check_close(t, 'sampled', f(k), naive(piece, v), absolute=1e-13_dp)
            call check_close(t, 'sampled slope', slope(k), p%slope(x(k)), absolute=1e-11_dp)
            call check_close(t, 'sampled curvature', bend(k), (naive(piece, v + h) + naive(piece, v - h) - 2*naive(piece, v)) &
                             /(h*half)**2, absolute=1e-4_dp*max(1.0_dp, 1/half**2))
          end associate
        end associate
      end do
    end do

  contains

    pure real(dp) function naive(piece, v)
      integer, intent(in) :: piece
      real(dp), intent(in) :: v
      integer :: power

      naive = sum([(p%coef(power, piece)*v**power, power=0, degree)])
    end function naive
  end subroutine random_pieces

  !> Coefficients count from 0.
  type(piecewise_t) function from_zero(breaks, coef) result(p)
    real(dp), intent(in) :: breaks(:), coef(0:, :)

    p%breaks = breaks
    allocate (p%coef(0:ubound(coef, 1), size(coef, 2)))
    p%coef = coef
  end function from_zero

  !> Through its points; slope and curvature are continuous, and the third derivative at the last but one knots.
  subroutine splines(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: x(7) = [0.0_dp, 0.3_dp, 0.7_dp, 0.8_dp, 1.4_dp, 1.5_dp, 2.3_dp]
    real(dp), parameter :: y(7) = [1.0_dp, -0.4_dp, 0.2_dp, 0.9_dp, 0.7_dp, -1.1_dp, 0.3_dp]
    type(piecewise_t) :: p
    real(dp) :: jump(0:3)
    integer :: i, k, n

    do n = 4, 7
      p = spline(x(:n), y(:n))
      call check_equal(t, 'pieces', size(p%coef, 2), n - 1)
      do i = 1, n
        call check_close(t, 'through the points', p%value(x(i)), y(i), absolute=1e-13_dp)
      end do
      do i = 2, n - 1
        jump = derivatives(i, -1) - derivatives(i - 1, 1)
        do k = 0, merge(3, 2, i == 2 .or. i == n - 1)
          call check_close(t, 'continuous derivative '//str(k), jump(k), 0.0_dp, absolute=1e-8_dp)
        end do
      end do
    end do

  contains

    !> Value and derivatives at an end of a piece.
    pure function derivatives(piece, v) result(d)
      integer, intent(in) :: piece, v
      real(dp) :: d(0:3)

      associate (c => p%coef(:, piece), scale => 2/(x(piece + 1) - x(piece)))
        d = [sum(c*[1, v, 1, v]), (c(2) + 2*v*c(3) + 3*c(4))*scale, (2*c(3) + 6*v*c(4))*scale**2, 6*c(4)*scale**3]
      end associate
    end function derivatives
  end subroutine splines

  !> The file for ParaView: as many points and cells, nodes of cells from 0, eight each, VTK's type 23, fields with one
  !> component or three.
  subroutine picture_read_back(t)
    type(tally_t), intent(inout) :: t
    type(grid_t) :: grid
    type(vtu_field_t) :: fields(2)
    type(error_t), allocatable :: error
    character(:), allocatable :: text, part
    real(dp), allocatable :: points(:, :), numbers(:)
    integer, allocatable :: cells(:, :), list(:)
    integer :: i, nodes, elements

    call rectangle_grid(reshape([0.0_dp, 0.0_dp, 3.0_dp, 0.0_dp, 3.0_dp, 2.0_dp, 0.0_dp, 1.0_dp], [2, 4]), 3, 2, grid, error)
    call check_no_error(t, 'grid of the picture', error)
    nodes = size(grid%x, 2)
    elements = size(grid%element, 2)
    grid%part = [(i, i=1, elements)]
    fields(1)%name = 'shape'
    fields(1)%values = -1.25_dp*grid%x
    fields(2)%name = 'stress'
    fields(2)%values = grid%x(1:1, :)**2
    call write_vtu(grid, fields, text)
    call check_true(t, 'numbers of points and cells', index(text, 'NumberOfPoints="'//str(nodes)//'" NumberOfCells="'// &
                    str(elements)//'"') > 0)
    allocate (points(3, nodes), cells(8, elements), list(elements), numbers(nodes))
    part = behind('<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">')
    read (part, *) points
    call check_close(t, 'points', maxval(abs(points(:2, :) - grid%x)) + maxval(abs(points(3, :))), 0.0_dp, absolute=1e-8_dp)
    part = behind('Name="connectivity" format="ascii">')
    read (part, *) cells
    call check_true(t, 'nodes of cells', all(cells == grid%element - 1))
    part = behind('Name="offsets" format="ascii">')
    read (part, *) list
    call check_true(t, 'offsets', all(list == [(8*i, i=1, elements)]))
    part = behind('Name="types" format="ascii">')
    read (part, *) list
    call check_true(t, 'types', all(list == 23))
    part = behind('Name="tooth" format="ascii">')
    read (part, *) list
    call check_true(t, 'teeth', all(list == grid%part))
    part = behind('Name="shape" NumberOfComponents="3" format="ascii">')
    read (part, *) points
    call check_close(t, 'a vector', maxval(abs(points(:2, :) + 1.25_dp*grid%x)) + maxval(abs(points(3, :))), 0.0_dp, &
                     absolute=1e-8_dp)
    part = behind('Name="stress" NumberOfComponents="1" format="ascii">')
    read (part, *) numbers
    call check_close(t, 'one component', maxval(abs(numbers - grid%x(1, :)**2)), 0.0_dp, absolute=1e-7_dp)
    call check_equal(t, 'arrays', count_of('<DataArray'), 7)
    call check_equal(t, 'their ends', count_of('</DataArray>'), 7)

  contains

    !> What stands between these words and the next tag, its lines as blanks.
    function behind(words) result(values)
      character(*), intent(in) :: words
      character(:), allocatable :: values
      integer :: first, k

      call check_true(t, words, index(text, words) > 0)
      first = index(text, words) + len(words)
      values = text(first:first + index(text(first:), '<') - 2)
      do k = 1, len(values)
        if (values(k:k) == new_line('a')) values(k:k) = ' '
      end do
    end function behind

    pure integer function count_of(words)
      character(*), intent(in) :: words
      integer :: k

      count_of = count([(text(k:k + len(words) - 1) == words, k=1, len(text) - len(words) + 1)])
    end function count_of
  end subroutine picture_read_back
end module test_piecewise
