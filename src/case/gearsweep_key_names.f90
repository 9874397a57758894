!> Errors of the rooms below speak of quantities, such as the stiffness table; here each gets the group and the key by which a
!> case gives it, so that whoever wrote the case finds it there. A message begins with its quantity.
module gearsweep_key_names
  use gearsweep_error, only: error_t
  implicit none
  private
  public :: name_key, key_name_t, key_names

  type :: key_name_t
    character(44) :: quantity
    character(26) :: key                         !< with its group
  end type key_name_t

  !> Where one quantity's name begins with that of another, the longer one stands first.
  type(key_name_t), parameter :: key_names(*) = [ &
    & key_name_t('stiffness table', '&mesh file'), &
    & key_name_t('stiffness polynomial', '&mesh coefficients'), &
    & key_name_t('profile error table', '&mesh profile_error_file'), &
    & key_name_t('positions of the load', '&static positions'), &
    & key_name_t('position of the load of the stress field', '&static field_position'), &
    & key_name_t('sweep', '&sweep')]

contains

  !> Replaces the quantity at the begin of a message by its group and key; other messages stay as they are.
  pure subroutine name_key(error)
    type(error_t), allocatable, intent(inout) :: error
    integer :: i, n

    if (.not. allocated(error)) return
    do i = 1, size(key_names)
      n = len_trim(key_names(i)%quantity)
      if (index(error%message, key_names(i)%quantity(:n)//':') /= 1 .and. &
          index(error%message, key_names(i)%quantity(:n)//' =') /= 1) cycle
      error%message = trim(key_names(i)%key)//error%message(n + 1:)
      return
    end do
  end subroutine name_key
end module gearsweep_key_names
