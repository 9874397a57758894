!> Natural modes of the gear of Thamba et al. 2020 in three dimensions; prints plain numbers for bench/body_modes.py.
!>
!>     body_modes modes ACROSS COUNT     seconds, unknowns of a half sector; then a line for each mode of either symmetry:
!>                                       its symmetry, its nodal diameter, how often it is there, its frequency
!>     body_modes deck ACROSS SYMMETRY COUNT FILE   the same half of the whole gear for CalculiX
program body_modes
  use, intrinsic :: iso_c_binding, only: c_null_ptr
  use bench_tools, only: check, number, seconds, word
  use gearsweep_base_error, only: error_t
  use gearsweep_gear_gear, only: gear_spec_t, gear_t, make_gear
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_elastic_material, only: material_t
  use gearsweep_body_modes_sector, only: gear_blank_t, make_gear_sector, sector_t
  use gearsweep_body_modes_sector_modes, only: find_sector_modes, sector_mode_t, support_t
  implicit none

  type(material_t), parameter :: steel = material_t(205e9_dp, 0.285_dp, 7850.0_dp)
  type(sector_t) :: sector

  call make_sector(number(2))
  if (word(1) == 'modes') call time_modes(number(3))
  if (word(1) == 'deck') call write_deck(number(3), number(4), word(5))

contains

  subroutine make_sector(across)
    integer, intent(in) :: across
    type(gear_spec_t) :: spec
    type(gear_t) :: gear
    type(error_t), allocatable :: error

    spec = gear_spec_t('gear', 60, 0.005_dp, face_width=0.09_dp, addendum=1.0_dp, dedendum=1.25_dp, rack_tip_radius=0.25_dp)
    spec%bore_radius = 0.00635_dp
    call make_gear(spec, gear, error)
    call check(error)
    call make_gear_sector(gear, gear_blank_t(), across, sector, error)
    call check(error)
  end subroutine make_sector

  !> All nodal diameters.
  subroutine time_modes(count)
    integer, intent(in) :: count
    type(sector_mode_t), allocatable :: modes(:, :, :)
    type(error_t), allocatable :: error
    real(dp) :: start
    integer :: k, symmetry, n

    start = seconds()
    call find_sector_modes(sector, steel, support_t(), count, [0, sector%sectors/2], c_null_ptr, modes, error)
    call check(error)
    print '(f12.4, 1x, i0)', seconds() - start, 3*size(sector%x, 2)
    do symmetry = 1, 2
      do n = lbound(modes, 3), ubound(modes, 3)
        do k = 1, count
          associate (mode => modes(k, symmetry, n))
            print '(3(i0, 1x), es22.14)', symmetry, n, mode%count, mode%frequency
          end associate
        end do
      end do
    end do
  end subroutine time_modes

  !> Bore and middle plane held as for this symmetry.
  subroutine write_deck(symmetry, count, path)
    integer, intent(in) :: symmetry, count
    character(*), intent(in) :: path
    integer, parameter :: order(20) = [1, 2, 3, 4, 9, 10, 11, 12, 5, 6, 7, 8, 13, 14, 15, 16, 17, 18, 19, 20]
    integer :: number_of(size(sector%x, 2), 0:sector%sectors - 1)
    integer :: unit, s, p, e, n, turns
    real(dp) :: angle, x(3)

    turns = sector%sectors
    open (newunit=unit, file=path, status='replace', action='write')
    write (unit, '(a)') '*NODE, NSET=ALL'
    number_of = 0
    n = 0
    do s = 0, turns - 1
      number_of(sector%far, s) = -1
      angle = 2*pi*s/turns
      do p = 1, size(sector%x, 2)
        if (number_of(p, s) < 0) cycle
        n = n + 1
        number_of(p, s) = n
        x = sector%x(:, p)
        x(:2) = [x(1)*cos(angle) - x(2)*sin(angle), x(1)*sin(angle) + x(2)*cos(angle)]
        write (unit, '(i0, 3(",", es19.11))') n, x
      end do
    end do
    do s = 0, turns - 1
      number_of(sector%far, s) = number_of(sector%near, modulo(s + 1, turns))
    end do
    write (unit, '(a)') '*ELEMENT, TYPE=C3D20, ELSET=BODY'
    n = 0
    do s = 0, turns - 1
      do e = 1, size(sector%element, 2)
        n = n + 1
        write (unit, '(i0, 15(",", i0), ",")') n, number_of(sector%element(order(:15), e), s)
        write (unit, '(4(i0, ","), i0)') number_of(sector%element(order(16:), e), s)
      end do
    end do
    call write_set(unit, 'BORE', sector%in_bore, number_of)
    call write_set(unit, 'MIDDLE', sector%in_middle, number_of)
    write (unit, '(a)') '*BOUNDARY', 'BORE, 1, 3', trim(merge('MIDDLE, 3, 3', 'MIDDLE, 1, 2', symmetry == 1)), &
      '*MATERIAL, NAME=STEEL', '*ELASTIC', '205e9, 0.285', '*DENSITY', '7850', '*SOLID SECTION, ELSET=BODY, MATERIAL=STEEL', &
      '*STEP', '*FREQUENCY'
    write (unit, '(i0)') count
    write (unit, '(a)') '*END STEP'
    close (unit)
  end subroutine write_deck

  !> `mask(nodes)`: which nodes of the sector; `number_of(nodes, sectors)`: their numbers in the whole gear.
  subroutine write_set(unit, name, mask, number_of)
    integer, intent(in) :: unit, number_of(:, :)
    character(*), intent(in) :: name
    logical, intent(in) :: mask(:)
    integer :: s, p

    write (unit, '(a)') '*NSET, NSET='//name
    do s = 1, size(number_of, 2)
      do p = 1, size(mask)
        if (mask(p)) write (unit, '(i0, ",")') number_of(p, s)
      end do
    end do
  end subroutine write_set
end program body_modes
