!> The stage of the load over the face width: one load distribution for each relief.
module gearsweep_study_run_face_stage
  use gearsweep_base, only: claim_memory, dp, error_t, str
  use gearsweep_elastic, only: teeth_t
  use gearsweep_face, only: face_load_t, face_mesh_t, find_face_load, make_face_mesh
  use gearsweep_study_run_stages, only: stages_t
  implicit none
  private
  public :: find_face_loads

contains

  !> Finds the load distribution with each relief under the static load of the case. The plane compliance is that of the pair
  !> stiffness, which is by finite elements (`check_case`).
  subroutine find_face_loads(stages, loads, error)
    type(stages_t), intent(in) :: stages
    type(face_load_t), allocatable, intent(out) :: loads(:)          !< (relief)
    type(error_t), allocatable, intent(inout) :: error
    type(face_mesh_t) :: mesh
    type(teeth_t) :: teeth
    integer :: i

    if (allocated(error)) return
    associate (inputs => stages%elements_inputs)
      call claim_memory(2e5_dp*size(stages%amount), '&relief amount_um: '//str(size(stages%amount))//' reliefs', error)
      if (allocated(error)) return
      teeth = stages%teeth
      call make_face_mesh(inputs%pair, inputs%material, inputs%options, mesh, error, teeth=teeth)
    end associate
    if (allocated(error)) return
    allocate (loads(size(stages%amount)))
    do i = 1, size(loads)
      if (allocated(stages%motion)) then
        mesh%profile_error = stages%motion(i)%mesh%profile_error
      else
        mesh%profile_error = stages%profile_error(i)
      end if
      call find_face_load(mesh, stages%faces%alignment, stages%load, loads(i), error, stages%faces%slices, stages%faces%shaft)
      if (allocated(error)) return
    end do
  end subroutine find_face_loads
end module gearsweep_study_run_face_stage
