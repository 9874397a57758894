!> The stresses that gears bear, for the task `rating`: stated by the case, or those of a material. And the lines that say what a
!> rating rests on.
module gearsweep_rating_limits
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_error, only: error_t
  use gearsweep_gear_materials, only: common_names, contact_number, gear_materials, grades, material_length, root_number, &
                                      test_gear_correction
  use gearsweep_kinds, only: dp
  use gearsweep_lines, only: lines_t
  use gearsweep_reader, only: reader_t
  use gearsweep_table, only: no_number, table_t
  use gearsweep_text, only: lower, str
  use gearsweep_uses, only: first_of, unless
  implicit none
  private
  public :: limits_t, read_limits, add_limits, add_ground

  !> Of pinion and gear, Pa; NaN where the case says nothing of them.
  type :: limits_t
    real(dp) :: contact(2) = 0, root(2) = 0                !< sigma_HG and sigma_FG
    real(dp) :: contact_number(2) = 0, root_number(2) = 0  !< sigma_Hlim and sigma_Flim; NaN without a material
    character(material_length) :: material(2) = '', named(2) = ''  !< of `gear_materials`; as the case calls them
    character(2) :: grade = ''                             !< of the material
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
                    allowed=[gear_materials%name, common_names%name], min_size=1, max_size=2, otherwise='none', &
                    meaning='material of both gears, or of pinion and gear, whose allowable stress numbers are taken; a '// &
                    'common name stands for its usual treatment')
    call reader%get(group, 'material_grade', grade, error, tasks=group, &
                    refused=first_of(refused, unless(has_material, 'needs a material')), allowed=grades, &
                    otherwise='mq, with a material', meaning='quality grade of the material by ISO 6336-5')
    call reader%get(group, 'contact_limit_mpa', contact, error, unit='MPa', tasks=group, &
                    refused=first_of(refused, unless(.not. has_material, by_material)), above=0.0_dp, at_most=1e6_dp, max_size=2, &
                    otherwise='that of the material; without one, no safety factor', &
                    meaning='contact stress sigma_HG that both gears, or pinion and gear, bear, for the safety factor S_H: '// &
                    'sigma_Hlim with its factors of life, lubrication and size')
    call reader%get(group, 'root_limit_mpa', root, error, unit='MPa', tasks=group, &
                    refused=first_of(refused, unless(.not. has_material, by_material)), above=0.0_dp, at_most=1e6_dp, max_size=2, &
                    otherwise='that of the material; without one, no safety factor', &
                    meaning='tooth root stress sigma_FG that they bear, for the safety factor S_F: sigma_FE with its factors '// &
                    'of life, notch and size')
    if (allocated(error)) return
    if (allocated(contact)) limits%contact = contact([1, size(contact)])
    if (allocated(root)) limits%root = root([1, size(root)])
    if (.not. has_material) return
    if (.not. allocated(grade)) grade = 'mq'
    limits%named = material([1, size(material)])
    limits%grade = grade
    do i = 1, 2
      k = findloc([(lower(common_names(k)%name) == limits%named(i), k=1, size(common_names))], .true., 1)
      limits%material(i) = limits%named(i)
      if (k > 0) limits%named(i) = common_names(k)%name
      if (k > 0) limits%material(i) = common_names(k)%material
      k = findloc([gear_materials%name], limits%material(i), 1)
      limits%contact_number(i) = contact_number(gear_materials(k), findloc(grades, grade, 1))
      limits%root_number(i) = root_number(gear_materials(k), findloc(grades, grade, 1))
    end do
    limits%contact = limits%contact_number
    limits%root = test_gear_correction*limits%root_number
  end subroutine read_limits

  !> Their columns, a row for each gear.
  pure subroutine add_limits(limits, table)
    type(limits_t), intent(in) :: limits
    type(table_t), intent(inout) :: table

    call table%add_words('material', 'whose numbers are taken; empty for none', limits%material)
    call table%add_words('material_name', 'what the case calls it; empty for none', limits%named)
    call table%add_words('material_grade', 'its quality grade by ISO 6336-5; empty for none', spread(limits%grade, 1, 2))
    call table%add('contact_number_mpa', 'MPa', 'allowable stress number sigma_Hlim of the material; NaN without one', &
                   mega*limits%contact_number)
    call table%add('root_number_mpa', 'MPa', 'nominal stress number sigma_Flim of the material; NaN without one', &
                   mega*limits%root_number)
    call table%add('contact_limit_mpa', 'MPa', 'sigma_HG: as stated, or sigma_Hlim of the material; NaN for none', &
                   mega*limits%contact)
    call table%add('root_limit_mpa', 'MPa', 'sigma_FG: as stated, or twice sigma_Flim of the material; NaN for none', &
                   mega*limits%root)
  end subroutine add_limits

  !> What safety factors rest on, from the table `rating_factors`.
  pure subroutine add_ground(factors, lines)
    type(table_t), intent(in) :: factors
    type(lines_t), intent(inout) :: lines
    character(:), allocatable :: ground(:)
    integer :: grade

    grade = nint(factors%number('accuracy_grade', 1))
    call lines%add('   K_A '//str(factors%number('application_factor', 1), 4)//', K_H_beta '// &
                   trim(told(factors%number('face_load_factor', 1)))//', K_H_alpha and K_F_alpha '// &
                   trim(told(factors%number('transverse_load_factor', 1)))//'; accuracy grade '//str(grade))
    ground = [of_member(factors, 1), of_member(factors, 2)]
    if (ground(1) == ground(2)) then
      call lines%add('   both gears: '//trim(ground(1)))
    else
      call lines%add('   pinion: '//trim(ground(1)))
      call lines%add('   gear: '//trim(ground(2)))
    end if
  end subroutine add_ground

  !> A load factor that only the case can state.
  pure function told(factor) result(words)
    real(dp), intent(in) :: factor
    character(20) :: words

    words = str(factor, 4)
    if (.not. factor > 1) words = '1 (not computed)'
  end function told

  !> What one gear bears.
  pure function of_member(factors, i) result(words)
    type(table_t), intent(in) :: factors
    integer, intent(in) :: i                     ! row of the gear
    integer, parameter :: length = 120
    character(length) :: words
    character(:), allocatable :: material

    material = trim(factors%word('material_name', i))
    if (material /= factors%word('material', i)) material = material//' as '//trim(factors%word('material', i))
    words = ''
    if (material /= '') words = material//' of grade '//trim(factors%word('material_grade', i))//': sigma_Hlim '// &
      str(factors%number('contact_number_mpa', i), 5)//', sigma_Flim '//str(factors%number('root_number_mpa', i), 5)//' MPa; '
    if (bears('contact')) words = trim(words)//' sigma_HG '//trim(limit('contact'))
    if (bears('root')) words = trim(words)//trim(merge(',', ' ', bears('contact')))//' sigma_FG '//trim(limit('root'))
    if (.not. (bears('contact') .or. bears('root'))) words = 'no limits and no material are stated, so there is no safety factor'
    if (material == '' .and. (bears('contact') .or. bears('root'))) words = trim(words)//', as stated'
    words = adjustl(words)

  contains

    pure logical function bears(what)
      character(*), intent(in) :: what

      bears = .not. ieee_is_nan(factors%number(what//'_limit_mpa', i))
    end function bears

    pure function limit(what)
      character(*), intent(in) :: what
      character(30) :: limit

      limit = str(factors%number(what//'_limit_mpa', i), 5)//' MPa'
    end function limit
  end function of_member
end module gearsweep_rating_limits
