!> Errors of the rooms below name quantities, such as the stiffness table. This module replaces each by the group and key of the
!> case, so that a user finds it there. A message, and its part after a semicolon, may begin with a quantity.
module gearsweep_study_case_key_names
  use gearsweep_base, only: error_t
  implicit none
  private
  public :: name_key, key_names, gear_key_names

  type :: key_name_t
    character(44) :: quantity
    character(28) :: key                         !< key with its group
  end type key_name_t

  type(key_name_t), parameter :: key_names(*) = [ &
    & key_name_t('stiffness table', '&mesh file'), &
    & key_name_t('stiffness polynomial', '&mesh coefficients'), &
    & key_name_t('profile error table', '&mesh profile_error_file'), &
    & key_name_t('positions of the load', '&static positions'), &
    & key_name_t('position of the load of the stress field', '&static field_position'), &
    & key_name_t('sweep', '&sweep'), &
    & key_name_t('centre distance (mm)', '&pair centre_distance_mm'), &
    & key_name_t('module', '&pair module_mm'), &
    & key_name_t('pressure angle', '&pair pressure_angle_deg'), &
    & key_name_t('path of contact', '&pair'), &
    & key_name_t('shortened path', '&pair shorten_path'), &
    & key_name_t('face width', '&pair face_width_mm'), &
    & key_name_t('face width (mm)', '&pair face_width_mm'), &
    & key_name_t('relief', '&relief'), &
    & key_name_t('amount of relief', '&relief amount_um'), &
    & key_name_t('line load (N/mm)', '&load line_load_n_mm'), &
    & key_name_t('Young''s modulus', '&material young_gpa'), &
    & key_name_t('Poisson''s ratio', '&material poisson'), &
    & key_name_t('density', '&material density_kgm3'), &
    & key_name_t('pair stiffness', '&mesh model'), &
    & key_name_t('misalignment and lead slopes (um)', '&face misalignment_um'), &
    & key_name_t('slices of the face', '&face slices'), &
    & key_name_t('shaft diameter (mm)', '&face shaft_diameter_mm'), &
    & key_name_t('bearing offset (mm)', '&face bearing_offset_mm'), &
    & key_name_t('corner contact', '&mesh corner_contact'), &
    & key_name_t('teeth of the section', '&section teeth'), &
    & key_name_t('support of the section', '&section fixed'), &
    & key_name_t('rim (mm)', '&section rim_mm'), &
    & key_name_t('plane of the section', '&section plane'), &
    & key_name_t('half angle of the section (deg)', '&section half_angle_deg'), &
    & key_name_t('elements across a tooth', '&section elements_across'), &
    & key_name_t('static stress', '&static'), &
    & key_name_t('tangent at the fillet (deg)', '&static tangent_deg'), &
    & key_name_t('step of the passage (s)', '&transient time_step_s'), &
    & key_name_t('number of modes', '&modal modes'), &
    & key_name_t('number of body modes', '&body_modes modes'), &
    & key_name_t('nodal diameters', '&body_modes nodal_diameters'), &
    & key_name_t('hub diameter (mm)', '&body_modes hub_diameter_mm'), &
    & key_name_t('elements across a tooth of the body', '&body_modes elements_across')]

  !> Keys of quantities of one gear, whose name precedes them, as in `pinion profile shift`.
  type(key_name_t), parameter :: gear_key_names(*) = [ &
    & key_name_t('addendum', 'addendum'), &
    & key_name_t('dedendum', 'dedendum'), &
    & key_name_t('rack tip radius', 'rack_tip_radius'), &
    & key_name_t('rack tip radii', 'rack_tip_radius'), &
    & key_name_t('protuberance (mm)', 'protuberance_mm'), &
    & key_name_t('grinding stock (mm)', 'grinding_stock_mm'), &
    & key_name_t('profile shift', 'profile_shift'), &
    & key_name_t('crowning (um)', 'crowning_um'), &
    & key_name_t('end relief (um)', 'end_relief_um'), &
    & key_name_t('end relief length (mm)', 'end_relief_mm'), &
    & key_name_t('bore diameter (mm)', 'bore_mm'), &
    & key_name_t('web thickness (mm)', 'web_thickness_mm'), &
    & key_name_t('rim thickness (mm)', 'rim_thickness_mm'), &
    & key_name_t('tip diameter (mm)', 'tip_diameter_mm'), &
    & key_name_t('tip chamfer (mm)', 'tip_chamfer_mm'), &
    & key_name_t('tip rounding (mm)', 'tip_rounding_mm'), &
    & key_name_t('tip form diameter (mm)', 'tip_form_diameter_mm'), &
    & key_name_t('pin diameter (mm)', 'pin_diameter_mm')]

contains

  !> Replaces the quantity at the beginning of a message, and of its parts after semicolons, by its group and key; other text
  !> remains unchanged.
  pure subroutine name_key(error)
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: remaining, part, text
    integer :: n

    if (.not. allocated(error)) return
    remaining = error%message
    text = ''
    do
      n = index(remaining, '; ')
      if (n == 0) exit
      part = remaining(:n - 1)
      call name_part(part)
      text = text//part//'; '
      remaining = remaining(n + 2:)
    end do
    call name_part(remaining)
    error%message = text//remaining
  end subroutine name_key

  !> Replaces the quantity at the beginning of a part by its key.
  pure subroutine name_part(part)
    character(:), allocatable, intent(inout) :: part
    character(:), allocatable :: words
    integer :: n

    words = part
    n = index(words, ' ')
    if (words(:n) == 'pinion ' .or. words(:n) == 'gear ') call put_key(gear_key_names, '&'//words(:n), words(n + 1:), part)
    call put_key(key_names, '', words, part)
  end subroutine name_part

  !> Returns the text of a part that begins with one of these quantities, with its key; otherwise `text` is unchanged.
  pure subroutine put_key(keys, before, part, text)
    type(key_name_t), intent(in) :: keys(:)
    character(*), intent(in) :: before           !< group of the key
    character(*), intent(in) :: part             !< may begin with a quantity, followed by ` =` or a colon
    character(:), allocatable, intent(inout) :: text
    integer :: i, n

    do i = 1, size(keys)
      n = len_trim(keys(i)%quantity)
      if (index(part, keys(i)%quantity(:n)//':') /= 1 .and. index(part, keys(i)%quantity(:n)//' =') /= 1) cycle
      text = before//trim(keys(i)%key)//part(n + 1:)
      return
    end do
  end subroutine put_key
end module gearsweep_study_case_key_names
