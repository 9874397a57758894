!> Times the finite elements; prints plain numbers for bench/elastic.py.
!>
!>     elastic grid KIND ACROSS FILE            writes grid and loads that the others are given
!>     elastic modes ACROSS COUNT               seconds of each stage, frequencies
!>     elastic first ACROSS                     first frequency, its estimate, seconds without and with it
!>     elastic compliance ACROSS OTHERS PLACES  seconds for one gear, pair compliance along the path
!>     elastic study KIND ACROSS                one grid's frequency, root stress, compliance, seconds of each
!>     elastic solver ACROSS LOADS              seconds of factor and solutions, compliance
!>
!> KIND is `graded` (the library's grid) or `uniform`.
program elastic
  use, intrinsic :: iso_fortran_env, only: output_unit
  use bench_tools, only: word, number, seconds, check, numbers
  use bench_uniform, only: make_uniform
  use gearsweep_elastic_body, only: body_t, elastic_law, make_body
  use gearsweep_elastic_compliance, only: deflection_at_depth, flank_load, load_line
  use gearsweep_elastic_disc, only: disc_t
  use gearsweep_base_error, only: error_t
  use gearsweep_elastic_fe_stiffness, only: fe_options_t, fe_stiffness
  use gearsweep_gear_gear, only: coast, drive, gear_spec_t, gear_t, make_gear
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_elastic_material, only: material_t
  use gearsweep_elastic_modes, only: find_modes, modal_t, modes_t, section_modes
  use gearsweep_gear_pair, only: make_pair, pair_t
  use gearsweep_base_piecewise, only: piecewise_t
  use gearsweep_elastic_q8, only: element_stiffness, shape_functions
  use gearsweep_elastic_section, only: make_section, make_two_grids, section_body_t, section_options_t, section_t
  use gearsweep_elastic_stress, only: find_root_stress, root_stress_t
  implicit none

  type(material_t), parameter :: hassan_steel = material_t(2.15e11_dp, 0.3_dp, 8750.0_dp)
  real(dp), parameter :: most_memory = 8e9_dp
  !> Where the tooth is loaded, m, and how deep below its deflection is read.
  real(dp), parameter :: loaded_radius = 0.388_dp, depth = 0.010_dp
  type(error_t), allocatable :: error

  select case (word(1))
  case ('grid')
    call write_grid(word(2), number(3), word(4))
  case ('modes')
    call time_modes(number(2), number(3))
  case ('first')
    call time_first(number(2))
  case ('compliance')
    call time_compliance(number(2), number(3), number(4))
  case ('study')
    call study(word(2), number(3))
  case ('solver')
    call time_solver(number(2), number(3))
  case default
    error stop 'elastic: grid, modes, first, compliance, study or solver'
  end select

contains

  !> Hassan et al. 2009, module 25 mm; the rack tip radius is inferred.
  subroutine hassan(kind, across, section)
    character(*), intent(in) :: kind
    integer, intent(in) :: across
    type(section_t), intent(out) :: section

    if (kind == 'uniform') then
      call make_uniform(hassan_gear(), hassan_options(across), section)
    else
      call make_section(hassan_gear(), hassan_options(across), section, error)
      call check(error)
    end if
  end subroutine hassan

  type(gear_t) function hassan_gear() result(gear)

    call make_gear(gear_spec_t('pinion', 30, 0.025_dp, face_width=0.125_dp, rack_tip_radius=0.30_dp), gear, error)
    call check(error)
  end function hassan_gear

  type(section_options_t) function hassan_options(across) result(options)
    integer, intent(in) :: across

    options%half_angle = 17.5_dp*pi/180
    options%rim = 0.140625_dp
    options%elements_across = across
  end function hassan_options

  subroutine make_hassan_body(section, body)
    type(section_t), intent(in) :: section
    type(body_t), intent(out) :: body

    call make_body(section%grid, hassan_steel, .false., section%gear%spec%face_width, &
                   spread(section%is_held(), 1, 2), most_memory, body, error)
    call check(error)
  end subroutine make_hassan_body

  !> Counts; a line for each node: x, y, the unit load's force, the force whose work is the deflection
  !> at depth, 1 where held, 1 on the loaded tooth's surface below the form circle; and each element.
  subroutine write_grid(kind, across, path)
    character(*), intent(in) :: kind, path
    integer, intent(in) :: across
    type(section_t) :: section
    type(body_t) :: body
    real(dp), allocatable :: load(:, :), reading(:, :)
    logical, allocatable :: held(:), root(:)
    integer :: unit, i

    call hassan(kind, across, section)
    call make_hassan_body(section, body)
    held = section%is_held()
    call unit_loads(section, body, load, reading)
    root = [(.false., i=1, size(held))]
    do i = drive, coast
      root(section%surface(section%loaded, i)) = .true.
    end do
    root = root .and. norm2(section%grid%x, 1) < minval(section%gear%form_radius)
    open (newunit=unit, file=path, action='write', status='replace')
    associate (x => section%grid%x, element => section%grid%element)
      write (unit, numbers) size(x, 2), size(element, 2)
      do i = 1, size(x, 2)
        write (unit, '(6(es24.16e3, 1x), 2i2)') x(:, i), load(:, i), reading(:, i), merge(1, 0, held(i)), merge(1, 0, root(i))
      end do
      write (unit, '(8(i0, 1x))') element
    end associate
    close (unit)
  end subroutine write_grid

  !> Forces at the nodes (2, nodes), N: of a unit force on the flank, and those whose work is the
  !> displacement at depth.
  subroutine unit_loads(section, body, load, reading)
    type(section_t), intent(in) :: section
    type(body_t), intent(in) :: body
    real(dp), allocatable, intent(out) :: load(:, :), reading(:, :)
    real(dp) :: x(body%unknowns), point(2), direction(2), local(2)
    integer :: element

    x = 0
    call flank_load(section, body, loaded_radius, x, error)
    call check(error)
    load = body%spread_out(x)
    call load_line(section, loaded_radius, point, direction)
    call section%grid%find(point + depth*direction, section%loaded, element, local)
    allocate (reading(2, size(load, 2)), source=0.0_dp)
    reading(:, section%grid%element(:, element)) = spread(direction, 2, 8)*spread(shape_functions(local), 1, 2)
  end subroutine unit_loads

  !> Factorisation is what the body takes beyond the elements' stiffness, which is timed again by itself.
  subroutine time_modes(across, count)
    integer, intent(in) :: across, count
    type(section_t) :: section
    type(body_t) :: body
    type(modes_t) :: modes
    real(dp) :: from, whole, assembly, eigen

    call hassan('graded', across, section)
    from = seconds()
    call make_hassan_body(section, body)
    whole = seconds() - from
    from = seconds()
    call find_modes(body, count, modes, error)
    call check(error)
    eigen = seconds() - from
    assembly = element_seconds(body)
    write (output_unit, numbers) body%unknowns, assembly, whole - assembly, eigen, maxval(modes%residual), modes%frequency
  end subroutine time_modes

  !> Seconds for the stiffness of a body's elements.
  real(dp) function element_seconds(body)
    type(body_t), intent(in) :: body
    real(dp) :: from, total
    integer :: e

    total = 0
    from = seconds()
    do e = 1, size(body%grid%element, 2)
      total = total + sum(element_stiffness(body%grid%x(:, body%grid%element(:, e)), elastic_law(body%material, body%plane_strain)))
    end do
    element_seconds = seconds() - from
    ! So that the elements are computed.
    if (total > huge(total)) error stop 'elements are not finite'
  end function element_seconds

  !> From the gear's numbers to the first frequency, grid included.
  subroutine time_first(across)
    integer, intent(in) :: across
    type(section_t) :: section
    type(body_t) :: body
    type(modes_t) :: modes
    type(modal_t) :: modal
    type(section_body_t) :: grids(2)
    real(dp) :: from, alone, estimated

    from = seconds()
    call hassan('graded', across, section)
    call make_hassan_body(section, body)
    call find_modes(body, 1, modes, error)
    call check(error)
    alone = seconds() - from
    from = seconds()
    call make_two_grids(hassan_gear(), hassan_steel, hassan_options(across), grids, error)
    call check(error)
    call section_modes(grids, 1, modal, error)
    call check(error)
    estimated = seconds() - from
    write (output_unit, numbers) body%unknowns, modes%frequency(1), modal%error_estimate(1), alone, estimated
  end subroutine time_first

  !> Dogan et al. 2021, case 1; its gears are equal, so that the pair costs one gear.
  subroutine time_compliance(across, others, places)
    integer, intent(in) :: across, others, places
    integer, parameter :: points = 101
    type(gear_t) :: gear
    type(pair_t) :: pair
    type(fe_options_t) :: options
    type(piecewise_t) :: curve
    type(disc_t) :: disc
    real(dp) :: from, taken
    integer :: i

    call make_gear(gear_spec_t('pinion', 25, 0.00318_dp, face_width=0.0254_dp), gear, error)
    call check(error)
    call make_pair(gear, gear, 2*gear%reference_radius, pair, error)
    call check(error)
    options%section%elements_across = across
    options%section%others_across = others
    options%positions = places
    from = seconds()
    call fe_stiffness(pair, [material_t(), material_t()], options, 280e3_dp, curve, disc, error)
    call check(error)
    taken = seconds() - from
    write (output_unit, numbers) taken, (1/curve%value(pair%contact_ratio*i/(points - 1)), i=0, points - 1)
  end subroutine time_compliance

  !> Unknowns; first frequency, largest root tension and deflection at depth under a unit force; seconds
  !> for each from the grid on.
  subroutine study(kind, across)
    character(*), intent(in) :: kind
    integer, intent(in) :: across
    type(section_t) :: section
    type(body_t) :: body
    type(modes_t) :: modes
    type(root_stress_t) :: stress
    real(dp) :: from, made, taken(3), near(1), far(1)

    call hassan(kind, across, section)
    from = seconds()
    call make_hassan_body(section, body)
    made = seconds() - from
    from = seconds()
    call find_modes(body, 1, modes, error)
    call check(error)
    taken(1) = seconds() - from
    from = seconds()
    call find_root_stress(section, body, [loaded_radius], [1/body%thickness], stress, error)
    call check(error)
    taken(2) = seconds() - from
    from = seconds()
    call deflection_at_depth(section, body, [loaded_radius], [depth], [2*depth], near, far, error)
    call check(error)
    taken(3) = seconds() - from
    write (output_unit, numbers) body%unknowns, modes%frequency(1), stress%tension%stress, near/body%thickness, made + taken
  end subroutine study

  !> Unknowns, seconds to factor and for one and for all of some right sides, deflection at depth.
  subroutine time_solver(across, loads)
    integer, intent(in) :: across, loads
    type(section_t) :: section
    type(body_t) :: body
    real(dp), allocatable :: load(:, :), reading(:, :), x(:, :)
    real(dp) :: from, whole, one, all

    call hassan('graded', across, section)
    from = seconds()
    call make_hassan_body(section, body)
    whole = seconds() - from
    call unit_loads(section, body, load, reading)
    x = spread(body%gather(load), 2, 1)
    from = seconds()
    call body%stiffness%solve(x, error)
    one = seconds() - from
    call check(error)
    x = spread(body%gather(load), 2, loads)
    from = seconds()
    call body%stiffness%solve(x, error)
    all = seconds() - from
    call check(error)
    write (output_unit, numbers) body%unknowns, whole - element_seconds(body), one, all, &
      dot_product(x(:, 1), body%gather(reading))
  end subroutine time_solver
end program elastic
