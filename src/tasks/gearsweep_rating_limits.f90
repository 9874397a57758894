!> The stresses that gears bear, for the task `rating`: stated by the case, or those of a material.
module gearsweep_rating_limits
  use gearsweep_error, only: error_t
  use gearsweep_gear_materials, only: contact_number, gear_materials, grades, material_length, root_number, test_gear_correction
  use gearsweep_kinds, only: dp
  use gearsweep_reader, only: reader_t
  use gearsweep_table, only: no_number, table_t
  use gearsweep_uses, only: first_of, unless
  implicit none
  private
  public :: limits_t, read_limits, add_limits

  !> Of pinion and gear, Pa; NaN where the case says nothing of them.
  type :: limits_t
    real(dp) :: contact(2) = 0, root(2) = 0                !< sigma_HG and sigma_FG
    real(dp) :: contact_number(2) = 0, root_number(2) = 0  !< sigma_Hlim and sigma_Flim; NaN without a material
    character(material_length) :: material(2) = ''
  end type limits_t

  real(dp), parameter :: mega = 1e-6_dp

contains

  !> The keys of the limits; `refused`: why none of them is allowed, or blank.
  subroutine read_limits(reader, group, refused, limits, error)
    type(reader_t), intent(inout) :: reader
    character(*), intent(in) :: group, refused
    type(limits_t), intent(out) :: limits
    type(error_t), allocatable, intent(inout) :: error
    character(*), parameter :: by_material = 'the material says it; give one of the two'
    character(:), allocatable :: material(:), grade
    real(dp), allocatable :: contact(:), root(:)
    logical :: has_material
    integer :: i, k

    limits%contact = no_number()
    limits%root = no_number()
    limits%contact_number = no_number()
    limits%root_number = no_number()
    call reader%get(group, 'material', material, error, given=has_material, tasks=group, refused=refused, &
                    allowed=[gear_materials%name], min_size=1, max_size=2, otherwise='none', &
                    meaning='material of both gears, or of pinion and gear, whose allowable stress numbers are taken')
    call reader%get(group, 'material_grade', grade, error, tasks=group, &
                    refused=first_of(refused, unless(has_material, 'needs a material')), allowed=grades, &
                    otherwise='mq, with a material', meaning='quality grade of the material by ISO 6336-5')
    call reader%get(group, 'contact_limit_mpa', contact, error, unit='MPa', tasks=group, &
                    refused=first_of(refused, unless(.not. has_material, by_material)), above=0.0_dp, at_most=1e6_dp, max_size=2, &
                    otherwise='that of the material; without one, no safety factor', &
                    meaning='contact stress sigma_HG that both gears, or pinion and gear, bear: sigma_Hlim with its factors of '// &
                    'life, lubrication and size')
    call reader%get(group, 'root_limit_mpa', root, error, unit='MPa', tasks=group, &
                    refused=first_of(refused, unless(.not. has_material, by_material)), above=0.0_dp, at_most=1e6_dp, max_size=2, &
                    otherwise='that of the material; without one, no safety factor', &
                    meaning='tooth root stress sigma_FG that they bear: sigma_FE with its factors of life, notch and size')
    if (allocated(error)) return
    if (allocated(contact)) limits%contact = contact([1, size(contact)])
    if (allocated(root)) limits%root = root([1, size(root)])
    if (.not. has_material) return
    if (.not. allocated(grade)) grade = 'mq'
    limits%material = material([1, size(material)])
    do i = 1, 2
      k = findloc([gear_materials%name], limits%material(i), 1)
      limits%contact_number(i) = contact_number(gear_materials(k), findloc(grades, grade, 1))
      limits%root_number(i) = root_number(gear_materials(k), findloc(grades, grade, 1))
    end do
    limits%contact = limits%contact_number
    limits%root = test_gear_correction*limits%root_number
  end subroutine read_limits

  !> Their columns, a row for each member.
  pure subroutine add_limits(limits, table)
    type(limits_t), intent(in) :: limits
    type(table_t), intent(inout) :: table

    call table%add_words('material', 'of the case; empty for none', limits%material)
    call table%add('contact_number_mpa', 'MPa', 'allowable stress number sigma_Hlim of the material; NaN without one', &
                   mega*limits%contact_number)
    call table%add('root_number_mpa', 'MPa', 'nominal stress number sigma_Flim of the material; NaN without one', &
                   mega*limits%root_number)
    call table%add('contact_limit_mpa', 'MPa', 'sigma_HG: as stated, or sigma_Hlim of the material; NaN for none', &
                   mega*limits%contact)
    call table%add('root_limit_mpa', 'MPa', 'sigma_FG: as stated, or twice sigma_Flim of the material; NaN for none', &
                   mega*limits%root)
  end subroutine add_limits
end module gearsweep_rating_limits
