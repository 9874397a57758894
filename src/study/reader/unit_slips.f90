!> Numbers that are likely in another unit than their key's, as hardly any gear has them.
!>
!> Numbers outside the bounds of a key are refused; unusual ones inside only cause a warning, so that a user may keep them.
module gearsweep_study_reader_unit_slips
  use gearsweep_base, only: dp, str
  use gearsweep_study_reader_keys, only: bounds_t
  implicit none
  private
  public :: find_slip, other_unit

  !> A unit that is often confused with the key's, and its size in the key's unit.
  type :: other_t
    character(9) :: name = ''
    real(dp) :: factor = 1
  end type other_t

contains

  !> Explains why the number of largest magnitude of a key is unusual; empty if it is not.
  pure subroutine find_slip(key, unit, numbers, words)
    character(*), intent(in) :: key, unit
    real(dp), intent(in) :: numbers(:)           !< numbers in this unit
    character(:), allocatable, intent(out) :: words
    character(:), allocatable :: other
    type(bounds_t) :: any_bounds
    real(dp) :: largest, least, most             ! largest with its sign, so that it can be copied

    words = ''
    call usual(key, unit, least, most)
    largest = numbers(maxloc(abs(numbers), 1))
    ! Zero is zero in every unit.
    if (.not. abs(largest) > 0 .or. (abs(largest) >= least .and. abs(largest) <= most)) return
    words = str(largest)
    if (size(numbers) > 1) words = 'at most '//words
    if (least <= 0) words = words//' is unusual: at most '//trim(str(most)//' '//unit)//' is usual'
    if (least > 0 .and. most >= huge(most)) words = words//' is unusual: '//str(least)//' '//unit//' or more is usual'
    if (least > 0 .and. most < huge(most)) words = words//' is unusual: '//str(least)//' to '//str(most)//' '//unit//' is usual'
    call other_unit(key, unit, any_bounds, largest, other)
    words = words//other
  end subroutine find_slip

  !> Suggests the value for a number in another unit, in which it is usual; empty if there is no such unit.
  pure subroutine other_unit(key, unit, bounds, number, words)
    character(*), intent(in) :: key, unit
    type(bounds_t), intent(in) :: bounds         !< bounds of the key
    real(dp), intent(in) :: number               !< number in the text
    character(:), allocatable, intent(out) :: words
    type(other_t), allocatable :: others(:)
    real(dp) :: least, most
    integer :: i

    words = ''
    call usual(key, unit, least, most)
    others = others_of(key, unit)
    do i = 1, size(others)
      associate (meant => others(i)%factor*number)
        if (abs(meant) < least .or. abs(meant) > most .or. .not. (abs(number) > 0 .and. bounds%allow(meant))) cycle
        words = '; if '//str(number)//' '//trim(others(i)%name)//' is meant, write '//str(meant)
        return
      end associate
    end do
  end subroutine other_unit

  !> Usual magnitudes of the numbers of a key; 0 and the largest number for any. Ranges of materials are those of gears from
  !> plastics to tungsten alloys.
  pure subroutine usual(key, unit, least, most)
    character(*), intent(in) :: key, unit
    real(dp), intent(out) :: least, most

    least = 0
    most = huge(most)
    select case (unit)
    case ('um')
      ! A deviation in millimetres is 0.1 at most. Grade 1 of ISO 1328 begins at 1 um.
      least = 0.1_dp
      if (key == 'start_um') least = 0
      if (index(key, 'wave') > 0) least = 0.01_dp
      if (key == 'roughness_um') least = 0.02_dp
      if (index(key, 'relief') > 0) least = 0.05_dp
      ! The largest relief of a list; in millimetres 0.5 and less.
      if (key == 'amount_um') least = 0.5_dp
      if (key == 'backlash_um' .or. key == 'thickness_allowance_um') least = 1
    case ('deg')
      if (key == 'helix_angle_deg') least = 1
    case ('kg/m^3')
      least = 200
      most = 25000
    case ('GPa')
      least = 0.5_dp
      most = 800
    case ('MPa')
      least = 5
      most = 10000
    case ('mPa s')
      least = 1
      most = 1e5_dp
    case ('1/GPa')
      least = 1
      most = 100
    case ('J/(kg K)')
      least = 100
      most = 5000
    case ('W/(m K)')
      least = 0.1_dp
      most = 500
    case ('N/um')
      most = 1e5_dp
    case ('')
      if (is_share(key)) most = 1
    case default
    end select
  end subroutine usual

  !> Numbers without a unit that are often written in per cent.
  pure logical function is_share(key)
    character(*), intent(in) :: key

    is_share = any(key == [character(20) :: 'damping_ratio', 'friction', 'friction_coefficient'])
  end function is_share

  pure function others_of(key, unit) result(others)
    character(*), intent(in) :: key, unit
    type(other_t), allocatable :: others(:)
    real(dp), parameter :: degrees = 57.295779513082323_dp

    allocate (others(0))
    select case (unit)
    case ('um')
      others = [other_t('mm', 1e3_dp)]
    case ('mm')
      others = [other_t('m', 1e3_dp)]
    case ('deg')
      others = [other_t('rad', degrees)]
    case ('kg/m^3')
      others = [other_t('g/cm^3', 1e3_dp), other_t('t/mm^3', 1e12_dp)]
    case ('GPa')
      others = [other_t('MPa', 1e-3_dp), other_t('Pa', 1e-9_dp)]
    case ('MPa')
      others = [other_t('GPa', 1e3_dp), other_t('Pa', 1e-6_dp)]
    case ('mPa s')
      others = [other_t('Pa s', 1e3_dp)]
    case ('1/GPa')
      others = [other_t('1/MPa', 1e3_dp), other_t('1/Pa', 1e9_dp)]
    case ('J/(kg K)')
      others = [other_t('kJ/(kg K)', 1e3_dp)]
    case ('N/um')
      others = [other_t('N/mm', 1e-3_dp), other_t('N/m', 1e-6_dp)]
    case ('')
      if (is_share(key)) others = [other_t('%', 1e-2_dp)]
    case default
    end select
  end function others_of
end module gearsweep_study_reader_unit_slips
