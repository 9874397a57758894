!> The stages of the load over the face width, one load distribution for each relief, and of the motion of helical gears, which
!> follows from it.
module gearsweep_study_run_face_stage
  use gearsweep_base, only: claim_memory, dp, error_t, str
  use gearsweep_elastic, only: disc_t, teeth_t
  use gearsweep_face, only: alignment_t, face_load_t, face_mesh_t, find_face_load, find_springs, make_face_mesh
  use gearsweep_motion, only: oscillator_t
  use gearsweep_study_run_case_variation, only: build_motion
  use gearsweep_study_run_inputs, only: motions_inputs_t
  use gearsweep_study_run_stages, only: stages_t
  implicit none
  private
  public :: build_faces, find_face_loads, build_helical_motions

contains

  !> Builds the mesh over the face width without relief. Its plane compliance is that of the pair stiffness, which is by finite
  !> elements (`check_case`).
  subroutine build_faces(stages, faces, error)
    type(stages_t), intent(in) :: stages
    type(face_mesh_t), intent(out) :: faces
    type(error_t), allocatable, intent(inout) :: error
    type(teeth_t) :: teeth

    if (allocated(error)) return
    teeth = stages%teeth
    associate (inputs => stages%elements_inputs)
      call make_face_mesh(inputs%pair, inputs%material, inputs%options, faces, error, teeth=teeth)
    end associate
  end subroutine build_faces

  !> Finds the load distribution with each relief under the static load of the case.
  subroutine find_face_loads(stages, faces, loads, error)
    type(stages_t), intent(in) :: stages
    type(face_mesh_t), intent(in) :: faces       !< of `build_faces`
    type(face_load_t), allocatable, intent(out) :: loads(:)          !< (relief)
    type(error_t), allocatable, intent(inout) :: error
    type(face_mesh_t) :: mesh
    integer :: i

    if (allocated(error)) return
    call claim_memory(2e5_dp*size(stages%amount), '&relief amount_um: '//str(size(stages%amount))//' reliefs', error)
    if (allocated(error)) return
    mesh = faces
    allocate (loads(size(stages%amount)))
    do i = 1, size(loads)
      if (allocated(stages%profile_error)) then
        mesh%profile_error = stages%profile_error(i)
      else
        mesh%profile_error = stages%motion(i)%mesh%profile_error
      end if
      call find_face_load(mesh, stages%faces%alignment, stages%load, loads(i), error, stages%faces%slices, stages%faces%shaft)
      if (allocated(error)) return
    end do
  end subroutine find_face_loads

  !> Builds the oscillators of helical gears, one for each relief, with parallel faces: their pairs as springs.
  subroutine build_helical_motions(stages, faces, inputs, motion, error)
    type(stages_t), intent(in) :: stages
    type(face_mesh_t), intent(in) :: faces       !< of `build_faces`
    type(motions_inputs_t), intent(inout) :: inputs        !< of the oscillators; out: with the springs of the first relief
    type(oscillator_t), allocatable, intent(out) :: motion(:)        !< (relief)
    type(error_t), allocatable, intent(inout) :: error
    type(face_mesh_t) :: mesh
    type(face_load_t) :: load
    type(motions_inputs_t) :: one
    real(dp) :: total
    integer :: i

    if (allocated(error)) return
    mesh = faces
    total = mesh%pair%contact_ratio + mesh%pair%lag()*mesh%width
    allocate (motion(size(stages%amount)))
    do i = 1, size(motion)
      mesh%profile_error = stages%profile_error(i)
      call find_face_load(mesh, alignment_t(), stages%load, load, error)
      if (allocated(error)) return
      one = inputs
      call find_springs(load, total, one%stiffness, one%profile_error)
      one%motion%relief%contact_ratio = total
      one%motion%reach = [0.0_dp, total]
      one%motion%disc = disc_t(turn=sum(mesh%tooth%turn)/mesh%width)
      call build_motion(one, 0.0_dp, motion(i), error)
      if (allocated(error)) return
      if (i == 1) inputs%stiffness = one%stiffness
      if (i == 1) inputs%profile_error = one%profile_error
    end do
  end subroutine build_helical_motions
end module gearsweep_study_run_face_stage
