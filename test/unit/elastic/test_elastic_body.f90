!> Grid, elements and statics: patch test, rigid motion, mass, exact solutions
!> and the orders at which they are approached.
module test_elastic_body
  use gearsweep_elastic_body, only: body_t, make_body
  use gearsweep_base_error, only: error_t
  use gearsweep_gear_gear, only: coast, drive, gear_spec_t, gear_t, make_gear
  use gearsweep_elastic_grid, only: grid_t, make_grid
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_elastic_material, only: material_t
  use gearsweep_gear_profile, only: root_angle
  use gearsweep_elastic_section, only: make_section, section_options_t, section_t
  use gearsweep_elastic_stress, only: nodal_stress
  use gearsweep_base_text, only: str
  use test_support_plain_grids, only: rectangle_grid
  use test_support_testing, only: tally_t, check_true, check_close, check_error, check_no_error
  implicit none
  private
  public :: run

  type(material_t), parameter :: unit_material = material_t(young=1.0_dp, poisson=0.3_dp, density=1.0_dp)

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('patch_and_rigid')) call patch_and_rigid(t)
    if (t%wants('mass_and_area')) call mass_and_area(t)
    if (t%wants('cantilevers')) call cantilevers(t)
    if (t%wants('thick_ring')) call thick_ring(t)
    if (t%wants('sections')) call sections(t)
    if (t%wants('refusals')) call refusals(t)
  end subroutine run

  type(gear_t) function sample(teeth, angles, rounding) result(gear)
    integer, intent(in) :: teeth
    real(dp), intent(in) :: angles(2), rounding
    type(error_t), allocatable :: error

    call make_gear(gear_spec_t('pinion', teeth, 0.003_dp, angles*pi/180, face_width=0.02_dp, &
                               rack_tip_radius=rounding), gear, error)
  end function sample

  !> A linear field leaves no forces inside the curved grid; a rigid one none at all.
  subroutine patch_and_rigid(t)
    type(tally_t), intent(inout) :: t
    type(section_t) :: section
    type(body_t) :: body
    type(error_t), allocatable :: error
    real(dp), allocatable :: u(:, :), f(:, :), alternating(:, :)
    logical, allocatable :: inside(:)
    real(dp) :: scale
    integer :: nodes, i

    call make_section(sample(25, [25.0_dp, 20.0_dp], 0.2_dp), section_options_t(elements_across=6), section, error)
    call check_no_error(t, 'section for the patch test', error)
    call make_body(section%grid, unit_material, .true., 1.0_dp, spread(section%is_held(), 1, 2), 1e9_dp, body, error)
    call check_no_error(t, 'body for the patch test', error)
    nodes = size(section%grid%x, 2)
    allocate (u(2*nodes, 4))
    associate (x => section%grid%x(1, :), y => section%grid%x(2, :))
      u(1::2, 1) = 0.3_dp*x - 0.2_dp*y
      u(2::2, 1) = 0.7_dp*x + 0.1_dp*y
      u(1::2, 2) = 1e-3_dp
      u(2::2, 2) = 0
      u(1::2, 3) = 0
      u(2::2, 3) = 1e-3_dp
      u(1::2, 4) = -y
      u(2::2, 4) = x
    end associate
    f = body%stiffness_times(u)
    scale = maxval(abs(f(:, 1)))
    allocate (inside(nodes), source=surrounded(section%grid))
    call check_true(t, 'patch has inner nodes', count(inside) > 100)
    call check_close(t, 'patch test on the curved grid', &
      maxval(abs(pack(f(:, 1), reshape(spread(inside, 1, 2), [2*nodes])))), 0.0_dp, absolute=1e-12_dp*scale)
    ! Rounding is that of the forces that cancel: they show where the signs of a motion alternate.
    u(:, 4) = u(:, 4)*[(merge(1, -1, mod(i/2, 2) == 0), i=0, 2*nodes - 1)]
    alternating = body%stiffness_times(u(:, 4:4))
    call check_close(t, 'rigid motion', maxval(abs(f(:, 2:4))), 0.0_dp, absolute=1e-15_dp*maxval(abs(alternating)))
  end subroutine patch_and_rigid

  !> Nodes whose angles at all elements add up to a full turn: those that belong
  !> to edges seen twice.
  function surrounded(grid) result(inside)
    type(grid_t), intent(in) :: grid
    logical :: inside(size(grid%x, 2))
    integer :: seen(size(grid%x, 2)), e, k

    seen = 0
    do e = 1, size(grid%element, 2)
      seen(grid%element(5:8, e)) = seen(grid%element(5:8, e)) + 1
    end do
    inside = .true.
    do e = 1, size(grid%element, 2)
      do k = 5, 8
        if (seen(grid%element(k, e)) == 2) cycle
        inside(grid%element([k, k - 4, modulo(k - 4, 4) + 1], e)) = .false.
      end do
    end do
  end function surrounded

  subroutine mass_and_area(t)
    type(tally_t), intent(inout) :: t
    type(grid_t) :: grid
    type(body_t) :: body
    type(section_t) :: section
    type(error_t), allocatable :: error
    real(dp), allocatable :: m(:, :, :)
    real(dp) :: area(2)
    integer :: i

    call rectangle_grid(reshape([0.0_dp, 0.0_dp, 3.0_dp, 0.0_dp, 3.0_dp, 2.0_dp, 0.0_dp, 1.0_dp], [2, 4]), 5, 3, grid, error)
    call make_body(grid, material_t(1.0_dp, 0.3_dp, 7.0_dp), .false., 0.5_dp, spread(grid%x(1, :) <= 0, 1, 2), 1e9_dp, &
                   body, error)
    call check_no_error(t, 'trapezoid', error)
    allocate (m, source=body%mass_matrices())
    call check_close(t, 'mass of a trapezoid', body%mass(), 4.5_dp*0.5_dp*7)
    call check_close(t, 'consistent mass', sum(m), 4.5_dp*0.5_dp*7)
    do i = 1, 2
      call make_section(sample(25, [20.0_dp, 20.0_dp], 0.25_dp), section_options_t(teeth=merge(25, 1, i == 1), &
                        rim=0.015_dp, elements_across=8), section, error)
      area(i) = section%grid%area()
    end do
    call check_close(t, 'whole gear is its teeth', area(1), 25*area(2), relative=1e-12_dp)
  end subroutine mass_and_area

  !> Tip deflection of cantilevers with nu = 0 under a parabolic end shear.
  subroutine cantilevers(t)
    type(tally_t), intent(inout) :: t
    real(dp) :: bending, shear

    bending = 4*100.0_dp**3
    call check_close(t, 'slender cantilever, Euler-Bernoulli', tip_deflection(100.0_dp, 100, 2), bending, relative=1e-3_dp)
    bending = 4*3.0_dp**3
    shear = 3*2*1.2_dp
    call check_close(t, 'thick cantilever, Timoshenko', tip_deflection(3.0_dp, 24, 8), bending + shear, relative=3e-3_dp)
  end subroutine cantilevers

  !> Unit height, thickness, E and load.
  real(dp) function tip_deflection(length, columns, rows) result(deflection)
    real(dp), intent(in) :: length
    integer, intent(in) :: columns, rows
    type(grid_t) :: grid
    type(body_t) :: body
    type(error_t), allocatable :: error
    real(dp), allocatable :: f(:, :), x(:, :)
    integer, allocatable :: end_nodes(:)
    real(dp) :: y(3), shear(3)
    integer :: r

    call rectangle_grid(reshape([0.0_dp, 0.0_dp, length, 0.0_dp, length, 1.0_dp, 0.0_dp, 1.0_dp], [2, 4]), &
                        columns, rows, grid, error)
    call make_body(grid, material_t(1.0_dp, 0.0_dp, 1.0_dp), .false., 1.0_dp, spread(grid%x(1, :) <= 0, 1, 2), 1e9_dp, &
                   body, error)
    allocate (f(2, size(grid%x, 2)), source=0.0_dp)
    end_nodes = grid%column_nodes(2*columns)
    do r = 1, rows
      associate (on => end_nodes(2*r - 1:2*r + 1))
        y = grid%x(2, on)
        shear = 6*y*(1 - y)
        f(2, on) = f(2, on) + (y(3) - y(1))/30*matmul(reshape([4, 2, -1, 2, 16, 2, -1, 2, 4], [3, 3]), shear)
      end associate
    end do
    x = reshape(body%gather(f), [body%unknowns, 1])
    call body%stiffness%solve(x, error)
    deflection = sum(x(:, 1)*body%gather(f))
  end function tip_deflection

  !> Lame's ring under internal pressure: orders of displacement and stress.
  subroutine thick_ring(t)
    type(tally_t), intent(inout) :: t
    real(dp) :: coarse(2), fine(2), order(2)

    coarse = ring_errors(6)
    fine = ring_errors(12)
    order = log(coarse/fine)/log(2.0_dp)
    call check_true(t, 'order of the work', order(1) > 3.5_dp, str(order(1))//' '//str(coarse(1))//' '//str(fine(1)))
    call check_true(t, 'order of the stress', order(2) > 1.8_dp, str(order(2))//' '//str(coarse(2))//' '//str(fine(2)))
    call check_close(t, 'work in the ring', fine(1), 0.0_dp, absolute=1e-5_dp)
    call check_close(t, 'stress in the ring', fine(2), 0.0_dp, absolute=2e-2_dp)
  end subroutine thick_ring

  !> Relative errors of the work done and of the stress at the bore (largest, sum
  !> of the principal ones); radii 1 and 2.
  function ring_errors(n) result(errors)
    integer, intent(in) :: n
    real(dp) :: errors(2)
    real(dp) :: points(2, 0:2*n, 0:2*n), angle, exact
    real(dp), allocatable :: f(:, :), x(:, :), u(:, :), stress(:, :)
    logical, allocatable :: held(:, :)
    integer, allocatable :: bore(:)
    type(grid_t) :: grid
    type(body_t) :: body
    type(error_t), allocatable :: error
    integer :: i, j

    do j = 0, 2*n
      do i = 0, 2*n
        angle = pi/2*(2*n - i)/(2*n)
        points(:, i, j) = (1 + j/(2.0_dp*n))*[cos(angle), sin(angle)]
      end do
    end do
    call make_grid(points, reshape([(0, i=1, n*n)], [n, n]), .false., grid, error)
    allocate (held(2, size(grid%x, 2)), source=.false.)
    held(1, grid%column_nodes(0)) = .true.
    held(2, grid%column_nodes(2*n)) = .true.
    call make_body(grid, unit_material, .false., 1.0_dp, held, 1e9_dp, body, error)
    allocate (f(2, size(grid%x, 2)), source=0.0_dp)
    bore = grid%row_nodes(0)
    do i = 1, n
      call press(grid%x(:, bore(2*i - 1:2*i + 1)), f, bore(2*i - 1:2*i + 1))
    end do
    x = reshape(body%gather(f), [body%unknowns, 1])
    call body%stiffness%solve(x, error)
    u = body%spread_out(x(:, 1))
    stress = nodal_stress(body, u)
    exact = 5.0_dp/3 + unit_material%poisson
    errors(1) = abs(sum(x(:, 1)*body%gather(f))/(exact*pi/2) - 1)
    errors(2) = maxval(abs((stress(1, bore) + stress(2, bore))/(2.0_dp/3) - 1))
  end function ring_errors

  !> Unit pressure, outwards, on a quadratic edge that runs clockwise.
  subroutine press(x, f, nodes)
    real(dp), intent(in) :: x(2, 3)
    real(dp), intent(inout) :: f(:, :)
    integer, intent(in) :: nodes(3)
    real(dp), parameter :: place(3) = [-sqrt(0.6_dp), 0.0_dp, sqrt(0.6_dp)], weight(3) = [5, 8, 5]/9.0_dp
    real(dp) :: along(2), shares(3)
    integer :: g, k

    do g = 1, 3
      associate (p => place(g))
        along = matmul(x, [p - 0.5_dp, -2*p, p + 0.5_dp])
        shares = [p*(p - 1)/2, 1 - p**2, p*(p + 1)/2]
      end associate
      do k = 1, 3
        f(:, nodes(k)) = f(:, nodes(k)) + weight(g)*shares(k)*[-along(2), along(1)]
      end do
    end do
  end subroutine press

  !> Sound grids for all kinds of gears; every surface runs from land to tip.
  subroutine sections(t)
    type(tally_t), intent(inout) :: t
    type(section_t) :: section
    type(error_t), allocatable :: error
    integer, allocatable :: nodes(:)
    integer :: teeth, n, side

    do n = 3, 9, 2
      do teeth = 1, 4
        call make_section(sample(30, [20.0_dp, 30.0_dp], 0.1_dp), section_options_t(teeth=merge(30, teeth, teeth == 4), &
                          elements_across=n, others_across=3), section, error)
        call check_no_error(t, 'asymmetric section', error)
        call check_true(t, 'quality', section%grid%quality() > 0.1_dp)
        do side = drive, coast
          nodes = section%surface(section%loaded, side)
          call check_true(t, 'surface of whole edges', mod(size(nodes), 2) == 1)
          call check_close(t, 'surface ends at the tip', norm2(section%grid%x(:, nodes(size(nodes)))), &
                           section%gear%tip_radius)
          call check_close(t, 'surface begins at the root', norm2(section%grid%x(:, nodes(1))), section%gear%root_radius)
        end do
      end do
      call make_section(sample(25, [20.0_dp, 20.0_dp], 0.0_dp), section_options_t(elements_across=n), section, error)
      call check_no_error(t, 'sharp rack', error)
    end do
  end subroutine sections

  subroutine refusals(t)
    type(tally_t), intent(inout) :: t

    call refuse('teeth of the section = 26', section_options_t(teeth=26))
    call refuse('elements across a tooth = 2', section_options_t(elements_across=2))
    call refuse('rim (mm) = -1', section_options_t(rim=-1e-3_dp))
    call refuse('rim (mm) = 40', section_options_t(rim=40e-3_dp))
    call refuse('overlaps the next tooth', section_options_t(half_angle=0.6_dp))
    call refuse('teeth cut', section_options_t(half_angle=0.25_dp))
    call refuse('the section is not held', section_options_t(fixed_sides=.false., fixed_rim=.false.))
    call refuse('GB; at most', section_options_t(elements_across=40, most_memory=1e7_dp))
    call refuse('GB; at most', section_options_t(teeth=25, elements_across=200))

  contains

    subroutine refuse(expected, options)
      character(*), intent(in) :: expected
      type(section_options_t), intent(in) :: options
      type(section_t) :: section
      type(body_t) :: body
      type(error_t), allocatable :: error

      call make_section(sample(25, [20.0_dp, 20.0_dp], 0.25_dp), options, section, error)
      if (.not. allocated(error)) call make_body(section%grid, unit_material, .false., 1.0_dp, &
        spread(section%is_held(), 1, 2), options%most_memory, body, error)
      call check_error(t, 'refused: '//expected, error, expected)
    end subroutine refuse
  end subroutine refusals
end module test_elastic_body
