!> The load of a pair of teeth along its path of contact, static or of the motion, as the tasks `flank` and `life` take it.
module gearsweep_flank_paths
  use gearsweep_error, only: code_memory, error_t, fail
  use gearsweep_flank, only: contact_t
  use gearsweep_kinds, only: dp, pi
  use gearsweep_mesh_losses, only: followed_loss_factor, static_loss_factor
  use gearsweep_oscillator, only: oscillator_t
  use gearsweep_pair, only: pair_t
  use gearsweep_response, only: response_t
  use gearsweep_sharing, only: share_load, sharing_t
  use gearsweep_status, only: has_result, status_ok
  use gearsweep_table, only: no_number
  use gearsweep_text, only: str
  implicit none
  private
  public :: path_t, follow_static, follow_motion, angular

  !> The contacts with one relief, at one speed, under one kind of load.
  type :: path_t
    real(dp) :: relief = 0, rpm = 0              !< m, 1/min
    logical :: is_dynamic = .false.
    integer :: status = status_ok                !< of the motion
    integer :: motions = 0                       !< how many there are; 0: not known, or no motion
    integer, allocatable :: pair(:)              !< as in response_t; (row)
    real(dp), allocatable :: s(:), load(:)       !< base pitches, N; (row)
    real(dp) :: friction = 0                     !< mean coefficient
    real(dp) :: loss_factor = 0                  !< NaN where the motion has no result
    real(dp) :: dynamic_factor = 0, estimate = 0  !< with its error; NaN where there is no motion
    real(dp) :: input = 0                        !< power of the pinion's torque, W
    type(contact_t), allocatable :: contact(:)   !< (row)
  end type path_t

contains

  !> The static load of a pair from its first contact to its last, in about 200 steps of a mesh period.
  pure subroutine follow_static(pair, motion, path)
    type(pair_t), intent(in) :: pair
    type(oscillator_t), intent(in) :: motion
    type(path_t), intent(inout) :: path
    integer, parameter :: samples = 200
    type(sharing_t) :: sharing
    integer :: j, k, n, row

    call share_load(motion%mesh, motion%load, samples, sharing)
    associate (rows => sum(sharing%pairs))
      allocate (path%s(rows), path%load(rows))
      allocate (path%pair(rows), source=1)
    end associate
    row = 0
    do n = minval(sharing%offset), maxval(sharing%offset + sharing%pairs) - 1
      do k = 1, size(sharing%phase)
        j = 1 + n - sharing%offset(k)
        if (j < 1 .or. j > sharing%pairs(k)) cycle
        row = row + 1
        path%s(row) = sharing%s(j, k)
        path%load(row) = sharing%load(j, k)
      end do
    end do
    path%loss_factor = static_loss_factor(pair, motion%mesh, motion%load)
    path%dynamic_factor = no_number()
    path%estimate = no_number()
  end subroutine follow_static

  !> The load of a motion under the load `static` (N). `key`: of the speed, for messages. `error`: the memory does not hold it.
  subroutine follow_motion(pair, response, static, key, path, error)
    type(pair_t), intent(in) :: pair
    type(response_t), intent(in) :: response
    real(dp), intent(in) :: static
    character(*), intent(in) :: key
    type(path_t), intent(inout) :: path
    type(error_t), allocatable, intent(inout) :: error

    if (response%lacks) call fail(error, code_memory, key//' = '//str(response%rpm)//': the memory does not hold the motion')
    if (allocated(error)) return
    path%is_dynamic = .true.
    path%status = response%point%steady%status
    path%pair = response%pair
    path%s = response%s
    path%load = response%load
    path%loss_factor = no_number()
    path%dynamic_factor = no_number()
    path%estimate = no_number()
    if (.not. has_result(path%status)) return
    path%loss_factor = followed_loss_factor(pair, path%pair, path%s, path%load, static)
    path%dynamic_factor = response%point%dynamic_factor
    path%estimate = response%point%estimate
  end subroutine follow_motion

  !> rad/s
  elemental real(dp) function angular(rpm)
    real(dp), intent(in) :: rpm                  !< 1/min

    angular = rpm*pi/30
  end function angular
end module gearsweep_flank_paths
