!> The stages of the load over the face width, one load distribution for each relief, and of the motions that follow from it: of
!> helical gears, and of gears whose faces meet unevenly.
module gearsweep_study_run_face_stage
  use gearsweep_base, only: claim_memory, code_input, dp, error_t, fail, str
  use gearsweep_elastic, only: disc_t, flattening_t, teeth_t
  use gearsweep_face, only: alignment_t, chord_loads, face_load_t, face_mesh_t, find_chords, find_face_load, find_pair_loads, &
    find_springs, make_face_mesh, pair_loads_t, springs_of_pair
  use gearsweep_motion, only: oscillator_t
  use gearsweep_study_run_case_variation, only: build_motion
  use gearsweep_study_run_inputs, only: motions_inputs_t
  use gearsweep_study_run_stages, only: stages_t
  implicit none
  private
  public :: build_faces, find_face_loads, build_helical_motions, build_uneven_motions

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
      mesh%profile_error = stages%profile_error_of(i)
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
      mesh%profile_error = stages%profile_error_of(i)
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

  !> Builds the oscillators of gears whose faces meet unevenly, one for each relief: several springs a pair. The shaft deflects as
  !> under the static load.
  subroutine build_uneven_motions(stages, faces, inputs, motion, error)
    type(stages_t), intent(in) :: stages
    type(face_mesh_t), intent(in) :: faces       !< of `build_faces`
    type(motions_inputs_t), intent(in) :: inputs           !< of the oscillators
    type(oscillator_t), allocatable, intent(out) :: motion(:)        !< (relief)
    type(error_t), allocatable, intent(inout) :: error
    integer, parameter :: most = 6               ! with the coast sides, a contact set has room for so many pairs
    type(face_mesh_t) :: mesh
    type(pair_loads_t) :: loads
    type(motions_inputs_t) :: one
    real(dp) :: total
    integer :: i

    if (allocated(error)) return
    mesh = faces
    total = mesh%pair%contact_ratio + mesh%pair%lag()*mesh%width
    one = inputs
    associate (of => one%motion)
      of%spacing = ceiling(total)
      of%relief%contact_ratio = total
      of%reach = [-real((springs_of_pair - 1)*of%spacing, dp), total]
      of%disc = disc_t(turn=sum(mesh%tooth%turn)/mesh%width)
      of%flattening = flattening_t()
      of%arm_change = 0
      if (of%spacing > most) call fail(error, code_input, '&pair face_width_mm = '//str(1000*mesh%width)//': the total contact '// &
        'ratio is '//str(total, 4)//'; the motion with an uneven load over the face needs at most '//str(most))
    end associate
    if (allocated(error)) return
    allocate (motion(size(stages%amount)))
    do i = 1, size(motion)
      mesh%profile_error = stages%profile_error_of(i)
      call find_pair_loads(mesh, stages%faces%alignment, stages%load, stages%load*chord_loads, loads, error, &
                           stages%faces%slices, stages%faces%shaft)
      if (allocated(error)) return
      call find_chords(loads, total, one%motion%spacing, one%stiffness, one%profile_error)
      call build_motion(one, 0.0_dp, motion(i), error)
      if (allocated(error)) return
    end do
  end subroutine build_uneven_motions
end module gearsweep_study_run_face_stage
