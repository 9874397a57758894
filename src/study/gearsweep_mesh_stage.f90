!> The stages that make the mesh: load, pair stiffness, one oscillator for each relief.
module gearsweep_mesh_stage
  use gearsweep_corner, only: add_corner_stiffness, arm_change
  use gearsweep_error, only: error_t
  use gearsweep_fe_stiffness, only: fe_options_t, fe_stiffness
  use gearsweep_inputs, only: elements_inputs_t, motion_inputs_t, relief_inputs_t, same
  use gearsweep_kinds, only: dp, pi
  use gearsweep_memory, only: claim_memory
  use gearsweep_mesh, only: mesh_t
  use gearsweep_motions, only: build_motion
  use gearsweep_pair, only: pair_t
  use gearsweep_products, only: study_t
  use gearsweep_section, only: section_options_t
  use gearsweep_first_stages, only: build_profile_error, build_stiffness, check_load, find_load, place_mesh, rim_teeth, rims
  use gearsweep_teeth, only: teeth_t
  use gearsweep_text, only: str
  implicit none
  private
  public :: mesh_and_motion

contains

  !> What all that needs a load starts from. What an `earlier` study has of the same inputs is taken over.
  subroutine mesh_and_motion(study, folder, error, earlier)
    type(study_t), intent(inout) :: study
    character(*), intent(in) :: folder
    type(error_t), allocatable, intent(inout) :: error
    type(study_t), intent(in), optional :: earlier

    call find_load(study%case, study%pair, study%base_pitch, study%load, study%mass, study%hub_mass)
    if (allocated(study%pair)) call check_load(study%case, study%pair, study%load, error)
    if (allocated(error)) return
    allocate (study%mesh)
    call place_mesh(study%case, study%pair, study%mesh)
    if (study%case%model == 'fe') then
      call find_by_elements(study, error, earlier)
    else
      call build_stiffness(study%case, study%pair, study%load, folder, study%mesh%contact_ratio, study%mesh%stiffness, error)
      call study%running%note('mesh: pair stiffness by model '//study%case%model)
      if (study%case%touches_beyond() .and. .not. allocated(error)) &
        call add_corner_stiffness(study%pair, study%load, study%mesh%stiffness)
      if (study%case%prescribed .and. .not. allocated(error)) call build_profile_error(study%case, folder, study%mesh, error)
    end if
    if (allocated(error)) return
    if (study%case%touches_beyond()) then
      study%mesh%reach = study%mesh%stiffness%breaks([1, size(study%mesh%stiffness%breaks)])
      call find_friction_arms(study%pair, study%mesh)
    end if
    call build_motions(study, error)
  end subroutine mesh_and_motion

  subroutine find_by_elements(study, error, earlier)
    type(study_t), intent(inout) :: study
    type(error_t), allocatable, intent(inout) :: error
    type(study_t), intent(in), optional :: earlier
    type(section_options_t) :: body
    character(40) :: how
    logical :: known

    ! The unloaded teeth may be coarser.
    body = study%case%section
    body%others_across = min(4, body%elements_across)
    study%elements_inputs = elements_inputs_t(study%pair, study%case%material, fe_options_t( &
      section=body, tooth_coupling=study%case%tooth_coupling, rim=rims(study%case, study%pair), &
      rim_teeth=rim_teeth(study%case), &
      hub_share=study%hub_mass/study%mass, &
      corner_contact=study%case%corner_contact), &
      study%load/study%case%spec(1)%face_width)
    known = .false.
    if (present(earlier)) known = allocated(earlier%elements_inputs)
    if (known) study%teeth%list = earlier%teeth%list
    if (known) known = same(study%elements_inputs, earlier%elements_inputs)
    if (known) then
      study%mesh%stiffness = earlier%mesh%stiffness
      study%mesh%disc = earlier%mesh%disc
      study%mesh%flattening = earlier%mesh%flattening
      call study%running%note('mesh: pair stiffness by model fe, taken over')
    else
      call by_elements(study%elements_inputs, study%mesh, study%teeth, error)
      how = ''
      if (study%teeth%taken > 0) how = ', one gear''s teeth taken over'
      if (study%teeth%taken > 0 .and. study%teeth%solved == 0) how = ', the teeth taken over'
      call study%running%note('mesh: pair stiffness by model fe'//trim(how))
    end if
  end subroutine find_by_elements

  !> Straight lines up to half of the reach; on the line of action the arms change by 2 pi/z per base pitch.
  pure subroutine find_friction_arms(pair, mesh)
    type(pair_t), intent(in) :: pair
    type(mesh_t), intent(inout) :: mesh
    integer :: end, member

    if (.not. mesh%reaches_beyond()) return
    do end = 1, 2
      associate (s => merge(mesh%reach(1), mesh%contact_ratio + mesh%reach(2), end == 1)/2)
        do member = 1, 2
          mesh%arm_change(member, end) = arm_change(pair, member, end, s) - merge(2*pi, -2*pi, member == 1)/mesh%teeth(member)
        end do
      end associate
    end do
  end subroutine find_friction_arms

  subroutine by_elements(inputs, mesh, teeth, error)
    type(elements_inputs_t), intent(in) :: inputs
    type(mesh_t), intent(inout) :: mesh
    type(teeth_t), intent(inout) :: teeth
    type(error_t), allocatable, intent(inout) :: error

    call fe_stiffness(inputs%pair, inputs%material, inputs%options, inputs%line_load, mesh%stiffness, mesh%disc, error, &
                      mesh%flattening, teeth)
  end subroutine by_elements

  !> One oscillator for each relief.
  subroutine build_motions(study, error)
    type(study_t), intent(inout) :: study
    type(error_t), allocatable, intent(inout) :: error
    integer :: i

    ! Each has a mesh of its own.
    associate (curve => study%mesh%stiffness)
      call claim_memory((size(study%case%amount) + 1)*(8000 + 8.0_dp*(size(curve%coef) + size(curve%breaks))), &
                        '&relief amount_um: '//str(size(study%case%amount))//' reliefs', error)
    end associate
    if (allocated(error)) return
    call list_inputs(study)
    allocate (study%motion(size(study%case%amount)))
    do i = 1, size(study%motion)
      call build_motion(study%motions_inputs, study%case%amount(i), study%motion(i), error)
      if (allocated(error)) return
    end do
  end subroutine build_motions

  !> What the oscillators are made from.
  subroutine list_inputs(study)
    type(study_t), intent(inout) :: study
    type(relief_inputs_t) :: relief

    associate (case => study%case, mesh => study%mesh)
      relief = relief_inputs_t(prescribed=case%prescribed, base_pitch=study%base_pitch, contact_ratio=mesh%contact_ratio, &
                               pitch_point=mesh%pitch_point, fraction=case%fraction, shape=case%shape, start=case%start, &
                               length=case%length, roll=case%roll)
      if (allocated(study%pair)) relief%pair = study%pair
      study%motions_inputs%motion = motion_inputs_t( &
        relief=relief, disc=mesh%disc, reach=mesh%reach, teeth=mesh%teeth, &
        tan_angle=mesh%tan_angle, arm_change=mesh%arm_change, load=study%load, mass=study%mass, damping_ratio=case%damping_ratio, &
        friction=case%friction, has_backlash=case%has_backlash, backlash=case%backlash)
      if (case%nonlinear_contact) study%motions_inputs%motion%flattening = mesh%flattening
      ! Where a gear's teeth are stated to be thinner, backlash is meant to be.
      if (case%has_allowance .and. .not. case%has_backlash) then
        study%motions_inputs%motion%has_backlash = .true.
        study%motions_inputs%motion%backlash = max(0.0_dp, study%pair%backlash)
      end if
      study%motions_inputs%stiffness = mesh%stiffness
      study%motions_inputs%profile_error = mesh%profile_error
      study%motions_inputs%amount = case%amount
    end associate
  end subroutine list_inputs
end module gearsweep_mesh_stage
