!> Times the finite elements; prints plain numbers for bench/compare.py.
!>
!>     elastic grid ACROSS FILE                 writes the grid that the others are given
!>     elastic modes ACROSS COUNT               seconds of each stage, frequencies
!>     elastic first ACROSS                     first frequency, its estimate, seconds without and with it
!>     elastic compliance ACROSS OTHERS PLACES  seconds for one gear, pair compliance along the path
program elastic
  use, intrinsic :: iso_fortran_env, only: output_unit
  use bench_tools, only: word, number, seconds, check, numbers
  use gearsweep_band, only: band_t, make_band
  use gearsweep_body, only: body_t, make_body
  use gearsweep_error, only: error_t
  use gearsweep_fe_stiffness, only: fe_options_t, fe_stiffness
  use gearsweep_gear, only: gear_t, gear_spec_t, make_gear
  use gearsweep_kinds, only: dp, pi
  use gearsweep_material, only: material_t
  use gearsweep_modal, only: modal_t, section_modes
  use gearsweep_modes, only: modes_t, find_modes
  use gearsweep_pair, only: pair_t, make_pair
  use gearsweep_piecewise, only: piecewise_t
  use gearsweep_section, only: section_t, section_options_t, make_section
  implicit none

  type(material_t), parameter :: hassan_steel = material_t(2.15e11_dp, 0.3_dp, 8750.0_dp)
  type(error_t), allocatable :: error

  select case (word(1))
  case ('grid')
    call write_grid(number(2), word(3))
  case ('modes')
    call time_modes(number(2), number(3))
  case ('first')
    call time_first(number(2))
  case ('compliance')
    call time_compliance(number(2), number(3), number(4))
  case default
    error stop 'elastic: grid, modes, first or compliance'
  end select

contains

  !> Hassan et al. 2009, module 25 mm; the rack tip radius is inferred.
  subroutine hassan(across, section)
    integer, intent(in) :: across
    type(section_t), intent(out) :: section

    call make_section(hassan_gear(), hassan_options(across), section, error)
    call check(error)
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

  !> Counts, then a line for each node (x, y, held) and each element.
  subroutine write_grid(across, path)
    integer, intent(in) :: across
    character(*), intent(in) :: path
    type(section_t) :: section
    logical, allocatable :: held(:)
    integer :: unit, i

    call hassan(across, section)
    held = section%is_held()
    open (newunit=unit, file=path, action='write', status='replace')
    associate (x => section%grid%x, element => section%grid%element)
      write (unit, numbers) size(x, 2), size(element, 2)
      do i = 1, size(x, 2)
        write (unit, '(2(es24.16e3, 1x), i0)') x(:, i), merge(1, 0, held(i))
      end do
      write (unit, '(8(i0, 1x))') element
    end associate
    close (unit)
  end subroutine write_grid

  !> Assembly is what the body takes beyond the factorisation, which is timed
  !> again by itself on a matrix of the same shape.
  subroutine time_modes(across, count)
    integer, intent(in) :: across, count
    type(section_t) :: section
    type(body_t) :: body
    type(modes_t) :: modes
    type(band_t) :: same_shape
    real(dp) :: from, whole, factor, eigen

    call hassan(across, section)
    from = seconds()
    call make_body(section%grid, hassan_steel, .false., section%gear%spec%face_width, &
                   spread(section%is_held(), 1, 2), 8e9_dp, body, error)
    call check(error)
    whole = seconds() - from
    from = seconds()
    call find_modes(body, count, modes, error)
    call check(error)
    eigen = seconds() - from
    call make_band(body%unknowns, body%stiffness%width, 8e9_dp, same_shape, error)
    call check(error)
    where (abs(body%stiffness%a) > 0) same_shape%a = 1
    same_shape%a(1, :) = 2*same_shape%width + 1
    from = seconds()
    call same_shape%factor(error)
    call check(error)
    factor = seconds() - from
    write (output_unit, numbers) body%unknowns, body%stiffness%width, whole - factor, factor, eigen, &
      maxval(modes%residual), modes%frequency
  end subroutine time_modes

  !> From the gear's numbers to the first frequency, grid included.
  subroutine time_first(across)
    integer, intent(in) :: across
    type(section_t) :: section
    type(body_t) :: body
    type(modes_t) :: modes
    type(modal_t) :: modal
    real(dp) :: from, alone, estimated

    from = seconds()
    call hassan(across, section)
    call make_body(section%grid, hassan_steel, .false., section%gear%spec%face_width, &
                   spread(section%is_held(), 1, 2), 8e9_dp, body, error)
    call check(error)
    call find_modes(body, 1, modes, error)
    call check(error)
    alone = seconds() - from
    from = seconds()
    call section_modes(hassan_gear(), hassan_steel, hassan_options(across), 1, modal, error)
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
    call fe_stiffness(pair, material_t(), options, 280e3_dp, curve, error)
    call check(error)
    taken = seconds() - from
    write (output_unit, numbers) taken, (1/curve%value(pair%contact_ratio*i/(points - 1)), i=0, points - 1)
  end subroutine time_compliance
end program elastic
