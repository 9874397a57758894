!> Load of a pair of teeth over its path of contact, static or in motion, for the tasks `flank` and `life`.
module gearsweep_study_run_flank_paths
  use gearsweep_base, only: code_memory, dp, error_t, fail, no_number, pi, str
  use gearsweep_gear, only: pair_t
  use gearsweep_mesh, only: share_load, sharing_t
  use gearsweep_motion, only: has_result, oscillator_t, response_t, status_ok
  use gearsweep_rating, only: contact_t, followed_loss_factor, static_loss_factor
  implicit none
  private
  public :: path_t, follow_static, follow_motion, angular

  !> Contacts of a pair with one relief, at one speed, under the static load or that of a motion.
  type :: path_t
    real(dp) :: relief = 0, rpm = 0              !< amount of relief, m; speed of the pinion, 1/min
    logical :: is_dynamic = .false.
    integer :: status = status_ok                !< status of the motion
    integer :: motions = 0                       !< number of steady motions; 0: not known, or none converged
    integer, allocatable :: pair(:)              !< index of the pair, as in response_t; (row)
    real(dp), allocatable :: s(:), load(:)       !< path coordinate, base pitches, and load, N; (row)
    real(dp) :: friction = 0                     !< mean coefficient of friction
    real(dp) :: loss_factor = 0                  !< tooth loss factor; NaN if the motion did not converge
    real(dp) :: dynamic_factor = 0, estimate = 0  !< dynamic factor and its error estimate; NaN if there is no motion
    real(dp) :: input = 0                        !< input power of the pinion's torque, W
    type(contact_t), allocatable :: contact(:)   !< contact of the flanks; (row)
  end type path_t

contains

  !> Samples the static load of a pair from its first contact to its last, in about 200 steps of a mesh period.
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

  !> Samples the load of a motion under the load `static` (N). `key`: of the speed, for messages. `error`: out of memory.
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

  !> Angular speed, rad/s.
  elemental real(dp) function angular(rpm)
    real(dp), intent(in) :: rpm                  !< speed, 1/min

    angular = rpm*pi/30
  end function angular
end module gearsweep_study_run_flank_paths
