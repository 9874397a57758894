!> The stages of the load over the face width, and of the motions that follow from it: of helical gears, and of gears whose faces
!> meet unevenly.
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
  public :: build_faces, find_face_loads, build_face_motions, build_face_motion

contains

  !> Builds the mesh over the face width without relief. Its plane compliance is that of the pair stiffness, which is by finite
  !> elements (`check_case`).
  subroutine build_faces(stages, faces, error)
    type(stages_t), intent(in) :: stages
    type(face_mesh_t), allocatable, intent(out) :: faces
    type(error_t), allocatable, intent(inout) :: error
    type(teeth_t) :: teeth

    allocate (faces)
    if (allocated(error)) return
    teeth = stages%teeth
    associate (inputs => stages%elements_inputs)
      call make_face_mesh(inputs%pair, inputs%material, inputs%options, faces, error, teeth=teeth)
    end associate
  end subroutine build_faces

  !> Finds the load distribution with each relief and alignment under the static load of the case.
  subroutine find_face_loads(stages, alignment, loads, error)
    type(stages_t), intent(in) :: stages         !< with `face_mesh`
    type(alignment_t), intent(in) :: alignment(:)
    type(face_load_t), allocatable, intent(out) :: loads(:)          !< of the alignments with the first relief, then the others
    type(error_t), allocatable, intent(inout) :: error
    type(face_mesh_t) :: mesh
    integer :: i, k, n

    if (allocated(error)) return
    n = size(alignment)
    call claim_memory(2e5_dp*n*size(stages%amount), '&relief amount_um, &face_load misalignment_um: '// &
                      str(n*size(stages%amount))//' load distributions', error)
    if (allocated(error)) return
    mesh = stages%face_mesh
    allocate (loads(n*size(stages%amount)))
    do i = 1, size(stages%amount)
      mesh%profile_error = stages%profile_error_of(i)
      do k = 1, n
        call find_face_load(mesh, alignment(k), stages%load, loads((i - 1)*n + k), error, stages%faces%slices, stages%faces%shaft)
        if (allocated(error)) return
      end do
    end do
  end subroutine find_face_loads

  !> Builds the oscillators whose pairs are springs by the load over the face, one for each relief: one spring a pair of helical
  !> gears with parallel faces, several springs where the faces meet unevenly; there the shaft deflects as under the static load.
  subroutine build_face_motions(stages, is_uneven, motion, error)
    type(stages_t), intent(in) :: stages         !< with `face_mesh`
    logical, intent(in) :: is_uneven             !< as the faces meet; false: parallel
    type(oscillator_t), allocatable, intent(out) :: motion(:)        !< (relief)
    type(error_t), allocatable, intent(inout) :: error
    integer :: i

    if (allocated(error)) return
    allocate (motion(size(stages%amount)))
    do i = 1, size(motion)
      call build_face_motion(stages, is_uneven, i, stages%load, motion(i), error)
      if (allocated(error)) return
    end do
  end subroutine build_face_motions

  !> Builds the oscillator of one relief under a load of its own.
  subroutine build_face_motion(stages, is_uneven, relief, load, motion, error)
    type(stages_t), intent(in) :: stages         !< with `face_mesh`
    logical, intent(in) :: is_uneven             !< as the faces meet; false: parallel
    integer, intent(in) :: relief                !< index among the reliefs of the case
    real(dp), intent(in) :: load                 !< static load, N
    type(oscillator_t), intent(out) :: motion
    type(error_t), allocatable, intent(inout) :: error
    integer, parameter :: most = 6               ! with the coast sides, a contact set has room for so many pairs
    type(face_mesh_t) :: mesh
    type(face_load_t) :: of_face
    type(pair_loads_t) :: of_pairs
    type(motions_inputs_t) :: inputs
    real(dp) :: total

    mesh = stages%face_mesh
    mesh%profile_error = stages%profile_error_of(relief)
    inputs = stages%motions_inputs
    total = mesh%pair%contact_ratio + mesh%pair%overlap_ratio
    associate (of => inputs%motion)
      of%load = load
      if (is_uneven) of%spacing = ceiling(total)
      of%relief%contact_ratio = total
      of%reach = [-real((springs_of_pair - 1)*of%spacing, dp), total]
      of%disc = disc_t(turn=sum(mesh%tooth%turn)/mesh%width)
      of%flattening = flattening_t()
      of%arm_change = 0
      if (of%spacing > most) call fail(error, code_input, '&pair face_width_mm = '//str(1000*mesh%width)//': the total contact '// &
        'ratio is '//str(total, 4)//'; the motion with an uneven load over the face needs at most '//str(most))
    end associate
    if (allocated(error)) return
    if (is_uneven) then
      call find_pair_loads(mesh, stages%faces%alignment, load, load*chord_loads, of_pairs, error, stages%faces%slices, &
                           stages%faces%shaft)
      if (.not. allocated(error)) call find_chords(of_pairs, total, inputs%motion%spacing, inputs%stiffness, inputs%profile_error)
    else
      call find_face_load(mesh, alignment_t(), load, of_face, error)
      if (.not. allocated(error)) call find_springs(of_face, total, inputs%stiffness, inputs%profile_error)
    end if
    if (.not. allocated(error)) call build_motion(inputs, 0.0_dp, motion, error)
  end subroutine build_face_motion
end module gearsweep_study_run_face_stage
