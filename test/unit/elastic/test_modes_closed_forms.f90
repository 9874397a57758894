!> Modes and grids by elements of the tests' own: mass, stiffness and energies of the shapes that are told, integrated anew
!> from the grid that is told; nodes on the surface against the sampled outline.
module test_modes_closed_forms
  use gearsweep_gear_profile, only: gear_outline
  use gearsweep_base_error, only: error_t
  use gearsweep_gear_gear, only: gear_spec_t, gear_t, make_gear
  use gearsweep_elastic_grid, only: grid_t
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_base_text, only: str
  use test_support_ask_by_name, only: answer_t, ask, elements_of
  use test_support_random_numbers, only: random_t
  use test_support_gears, only: stated_t, examples, text_of, degree
  use test_support_plain_grids, only: rectangle_grid
  use test_support_testing, only: tally_t, check_true, check_close, check_equal
  implicit none
  private
  public :: run

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('energies strain')) call energies(t, 'strain')
    if (t%wants('energies stress')) call energies(t, 'stress')
    if (t%wants('surfaces')) call surfaces(t)
    if (t%wants('places_in_elements')) call places_in_elements(t)
  end subroutine run

  !> The shapes for a modal mass of 1 kg: both energies of every pair of modes, by Gauss's rule of four points, are those of
  !> unit mass and of (2 pi f)**2, and 0 between unlike modes; the rim's share in the kinetic energy.
  subroutine energies(t, plane)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: plane
    integer, parameter :: modes = 5
    real(dp), parameter :: young = 190e9_dp, nu = 0.28_dp, density = 7400, width = 0.02_dp
    type(stated_t) :: list(5)
    type(answer_t) :: answer
    real(dp), allocatable :: x(:), y(:), frequency(:), shape(:, :, :), rim(:)
    integer, allocatable :: element(:, :), tooth(:)
    real(dp) :: mass(modes, modes), stiffness(modes, modes), in_rim(modes), law(3), expected
    integer :: i, k

    list = examples()
    call ask(t, '&case tasks=''modal'' / '//text_of(list(3))//'&material young_gpa=190 poisson=0.28 density_kgm3=7400 / '// &
             '&section elements_across=5 plane='''//plane//''' / &modal modes=5 /', answer)
    x = answer%all_of('nodes.x_mm')/1000
    y = answer%all_of('nodes.y_mm')/1000
    tooth = nint(answer%all_of('elements.tooth'))
    element = elements_of(answer)
    allocate (shape(2, size(x), modes))
    shape(1, :, :) = reshape(answer%all_of('mode_shapes.shape_x'), [size(x), modes])
    shape(2, :, :) = reshape(answer%all_of('mode_shapes.shape_y'), [size(x), modes])
    frequency = answer%all_of('modal.frequency_hz')
    rim = answer%all_of('modal.rim_share')
    if (plane == 'strain') law = young/((1 + nu)*(1 - 2*nu))*[1 - nu, nu, (1 - 2*nu)/2]
    if (plane == 'stress') law = young/(1 - nu**2)*[1.0_dp, nu, (1 - nu)/2]
    mass = 0
    stiffness = 0
    in_rim = 0
    do i = 1, size(tooth)
      call integrate(transpose(reshape([x(element(:, i)), y(element(:, i))], [8, 2])), shape(:, element(:, i), :), &
                     density*width, width*law, tooth(i) == 0, mass, stiffness, in_rim)
    end do
    do k = 1, modes
      do i = 1, k
        expected = merge(1.0_dp, 0.0_dp, i == k)
        call check_close(t, 'plane '//plane//': modal mass', mass(i, k), expected, absolute=1e-4_dp)
        call check_close(t, 'plane '//plane//': modal stiffness', stiffness(i, k)/(4*pi**2*frequency(i)*frequency(k)), expected, &
                         absolute=1e-3_dp)
      end do
      call check_close(t, 'plane '//plane//': share of the rim', rim(k), in_rim(k), absolute=1e-4_dp)
    end do
  end subroutine energies

  !> Adds one element's integrals. Corners first, then the middles of the sides, anticlockwise.
  subroutine integrate(x, u, density, law, is_rim, mass, stiffness, in_rim)
    real(dp), intent(in) :: x(:, :), u(:, :, :), density, law(3)
    logical, intent(in) :: is_rim
    real(dp), intent(inout) :: mass(:, :), stiffness(:, :), in_rim(:)
    real(dp), parameter :: place(4) = [-0.861136311594053_dp, -0.339981043584856_dp, 0.339981043584856_dp, 0.861136311594053_dp]
    real(dp), parameter :: weight(4) = [0.347854845137454_dp, 0.652145154862546_dp, 0.652145154862546_dp, 0.347854845137454_dp]
    real(dp), parameter :: step = 1e-5_dp
    real(dp) :: slope(8, 2), j(2, 2), inverse(2, 2), det, h(2, 2), at(2), strain(3, size(u, 3)), moved(2, size(u, 3)), w
    integer :: a, b, k, m

    do a = 1, 4
      do b = 1, 4
        at = [place(a), place(b)]
        ! The functions are quadratic along each coordinate, so that central differences are exact.
        slope(:, 1) = (functions(at + [step, 0.0_dp]) - functions(at - [step, 0.0_dp]))/(2*step)
        slope(:, 2) = (functions(at + [0.0_dp, step]) - functions(at - [0.0_dp, step]))/(2*step)
        j = matmul(x, slope)
        det = j(1, 1)*j(2, 2) - j(1, 2)*j(2, 1)
        inverse = reshape([j(2, 2), -j(2, 1), -j(1, 2), j(1, 1)], [2, 2])/det
        w = weight(a)*weight(b)*det
        do k = 1, size(u, 3)
          moved(:, k) = matmul(u(:, :, k), functions(at))
          h = matmul(matmul(u(:, :, k), slope), inverse)
          strain(:, k) = [h(1, 1), h(2, 2), h(1, 2) + h(2, 1)]
        end do
        do k = 1, size(u, 3)
          do m = 1, size(u, 3)
            mass(m, k) = mass(m, k) + w*density*dot_product(moved(:, m), moved(:, k))
            stiffness(m, k) = stiffness(m, k) + w*(law(1)*(strain(1, m)*strain(1, k) + strain(2, m)*strain(2, k)) &
              + law(2)*(strain(1, m)*strain(2, k) + strain(2, m)*strain(1, k)) + law(3)*strain(3, m)*strain(3, k))
          end do
          if (is_rim) in_rim(k) = in_rim(k) + w*density*sum(moved(:, k)**2)
        end do
      end do
    end do
  end subroutine integrate

  !> Of the quadrilateral with eight nodes: each is 1 at its own node and 0 at the others.
  pure function functions(p) result(f)
    real(dp), intent(in) :: p(2)
    real(dp) :: f(8)
    real(dp), parameter :: corner(2, 4) = reshape([-1, -1, 1, -1, 1, 1, -1, 1], [2, 4])
    integer :: k

    f(5:7:2) = (1 - p(1)**2)*(1 + [-1, 1]*p(2))/2
    f(6:8:2) = (1 - p(2)**2)*(1 + [1, -1]*p(1))/2
    do k = 1, 4
      f(k) = (1 + corner(1, k)*p(1))*(1 + corner(2, k)*p(2))/4 - (f(4 + k) + f(4 + merge(4, k - 1, k == 1)))/2
    end do
  end function functions

  !> Every node that only one element's side has lies on the gear's outline, on the section's inner circle or on its cuts. The
  !> loaded tooth's axis lies along y, or that of the space beside it where the number of teeth is even.
  subroutine surfaces(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: steps = 200
    character(*), parameter :: options(3) = [character(40) :: 'teeth=3', 'teeth=2 half_angle_deg=15', 'teeth=0 rim_mm=8']
    type(stated_t) :: list(5)
    type(answer_t) :: answer
    type(gear_t) :: gear
    type(error_t), allocatable :: error
    real(dp), allocatable :: outline(:, :), x(:), y(:)
    integer, allocatable :: element(:, :), seen(:)
    real(dp) :: inner, farthest, cuts(2), turn
    integer :: i, k, n, on(3)

    list = examples()
    associate (pair => list(3))
      call make_gear(gear_spec_t('gear', pair%teeth(1), pair%module, pair%angle*degree, pair%shift(1), pair%addendum(1), &
        pair%dedendum(1), pair%rounding(1), face_width=1.0_dp), gear, error)
      outline = gear_outline(gear, steps)
      do n = 1, size(options)
        call ask(t, '&case tasks=''modal'' / &modal modes=1 / '//text_of(pair)//'&section elements_across=6 '// &
                 trim(options(n))//' /', answer)
        x = answer%all_of('nodes.x_mm')
        y = answer%all_of('nodes.y_mm')
        element = elements_of(answer)
        if (allocated(seen)) deallocate (seen)
        allocate (seen(size(x)), source=0)
        do i = 1, size(element, 2)
          seen(element(5:, i)) = seen(element(5:, i)) + 1
        end do
        inner = minval(hypot(x, y))
        turn = merge(0.0_dp, pi/pair%teeth(1), n == 1)
        ! 2.5 tooth heights below the root, or the rim's thickness; cut in the middle of the spaces, or as asked.
        call check_close(t, 'inner radius, '//trim(options(n)), inner, gear%root_radius - merge(8.0_dp, &
          2.5_dp*pair%module*(pair%addendum(1) + pair%dedendum(1)), n == 3))
        cuts = [minval(atan2(x, y)), maxval(atan2(x, y))]
        if (n < 3) call check_close(t, 'angle of the section', cuts(2) - cuts(1), merge(3*2*pi/pair%teeth(1), 30*degree, n == 1))
        on = 0
        farthest = 0
        do i = 1, size(x)
          if (seen(i) /= 1) cycle
          if (hypot(x(i), y(i)) < inner*(1 + 1e-9_dp)) then
            on(1) = on(1) + 1
          else if (n < 3 .and. minval(abs(atan2(x(i), y(i)) - cuts)) < 1e-9_dp) then
            on(2) = on(2) + 1
          else
            on(3) = on(3) + 1
            farthest = max(farthest, distance([x(i)*cos(turn) + y(i)*sin(turn), y(i)*cos(turn) - x(i)*sin(turn)]))
          end if
        end do
        call check_close(t, 'surface nodes on the outline, '//trim(options(n)), farthest, 0.0_dp, absolute=2e-4_dp*pair%module)
        call check_true(t, 'inner circle and cuts, '//trim(options(n)), on(1) > 5 .and. (on(2) > 5 .neqv. n == 3) .and. on(3) > 50)
      end do
    end associate

  contains

    !> From the outline's chords.
    real(dp) function distance(point)
      real(dp), intent(in) :: point(2)
      real(dp) :: along(2), part

      distance = huge(distance)
      do k = 1, size(outline, 2) - 1
        along = outline(:, k + 1) - outline(:, k)
        part = max(0.0_dp, min(1.0_dp, dot_product(point - outline(:, k), along)/sum(along**2)))
        distance = min(distance, norm2(point - outline(:, k) - part*along))
      end do
    end function distance
  end subroutine surfaces

  !> Points are found again in very crooked elements, at the local coordinates that they were made from; none is found outside.
  subroutine places_in_elements(t)
    type(tally_t), intent(inout) :: t
    type(grid_t) :: grid
    type(error_t), allocatable :: error
    type(random_t) :: random
    real(dp) :: made(2), local(2), point(2), off
    integer :: e, element, k

    call rectangle_grid(reshape([0.0_dp, 0.0_dp, 4.0_dp, 3.0_dp, 4.6_dp, 4.9_dp, 0.3_dp, 0.8_dp], [2, 4]), 3, 2, grid, error)
    call check_true(t, 'crooked grid', .not. allocated(error))
    ! The middles of the inner sides are moved, so that the sides are curved.
    do e = 1, size(grid%element, 2)
      associate (middle => grid%x(:, grid%element(6, e)))
        if (e /= 3 .and. e /= 6) middle = middle + [0.06_dp, -0.05_dp]
      end associate
    end do
    off = 0
    do e = 1, size(grid%element, 2)
      do k = 1, 20
        made = 0.98_dp*[random%between(-1.0_dp, 1.0_dp), random%between(-1.0_dp, 1.0_dp)]
        point = matmul(grid%x(:, grid%element(:, e)), functions(made))
        call grid%find(point, 0, element, local)
        if (element /= e) off = huge(off)
        off = max(off, maxval(abs(local - made)))
      end do
    end do
    call check_close(t, 'found where they were made', off, 0.0_dp, absolute=1e-11_dp)
    call grid%find([2.0_dp, 0.5_dp], 0, element, local)
    call check_equal(t, 'outside', element, 0)
    call grid%find([2.3_dp, 2.2_dp], 7, element, local)
    call check_equal(t, 'of no such part', element, 0)
    ! A trapezium whose sides are 1 and 2 has its smallest Jacobian at the short one, two thirds of the mean; whichever side.
    do k = 0, 3
      call rectangle_grid(cshift(reshape([0.0_dp, 0.0_dp, 3.0_dp, 0.0_dp, 3.0_dp, 2.0_dp, 0.0_dp, 1.0_dp], [2, 4]), k, 2), 1, 1, &
                          grid, error)
      call check_close(t, 'quality of a trapezium', grid%quality(), 2/3.0_dp)
    end do
  end subroutine places_in_elements
end module test_modes_closed_forms
