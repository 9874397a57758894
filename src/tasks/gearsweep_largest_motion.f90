!> The motion of largest dynamic factor at a speed, as tasks of single speeds take it.
module gearsweep_largest_motion
  use gearsweep_attractor_search, only: attractor_options_t
  use gearsweep_attractors, only: largest_motion
  use gearsweep_kinds, only: dp
  use gearsweep_oscillator, only: mesh_period, oscillator_t
  use gearsweep_response, only: find_response, response_t
  use gearsweep_steady_motion, only: accuracy_t, point_t
  implicit none
  private
  public :: find_motion, find_point

contains

  !> The operating point at a speed (1/min): of the motions that attract there, the one of largest dynamic factor that a start
  !> reaches. So it depends on the case alone, and not on how a sweep comes to this speed.
  subroutine find_point(motion, rpm, accuracy, point, motions, lacks)
    type(oscillator_t), intent(in) :: motion
    real(dp), intent(in) :: rpm
    type(accuracy_t), intent(in) :: accuracy
    type(point_t), intent(out) :: point
    integer, intent(out) :: motions              !< how many there are; 0: not known
    logical, intent(out) :: lacks                !< the memory does not hold it

    call largest_motion(motion, mesh_period(motion%mesh%teeth(1), rpm), attractor_options_t(accuracy), point, motions, lacks)
  end subroutine find_point

  !> The same, followed over the path of contact.
  subroutine find_motion(motion, rpm, accuracy, response, motions, harmonics)
    type(oscillator_t), intent(in) :: motion
    real(dp), intent(in) :: rpm
    type(accuracy_t), intent(in) :: accuracy
    type(response_t), intent(out) :: response
    integer, intent(out) :: motions              !< how many there are; 0: not known
    integer, intent(in), optional :: harmonics   !< with it there is a summary, with so many of the mesh frequency
    type(point_t) :: point
    logical :: lacks

    call find_point(motion, rpm, accuracy, point, motions, lacks)
    if (.not. lacks) call find_response(motion, rpm, accuracy, response, point, harmonics)
    response%lacks = response%lacks .or. lacks
  end subroutine find_motion
end module gearsweep_largest_motion
