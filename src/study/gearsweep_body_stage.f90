!> The stages that look at one member's body: the grid of its section, its modes and its root stress.
module gearsweep_body_stage
  use gearsweep_error, only: error_t
  use gearsweep_inputs, only: body_inputs_t, modes_inputs_t, same, unit_inputs_t
  use gearsweep_kinds, only: dp
  use gearsweep_memory, only: claim_memory
  use gearsweep_mesh, only: mesh_t
  use gearsweep_modal, only: modal_t, section_modes
  use gearsweep_products, only: note, study_t
  use gearsweep_root_rating, only: load_positions, load_radius, rate_root
  use gearsweep_section, only: make_section
  use gearsweep_section_body, only: make_section_body, make_two_grids, section_body_t
  use gearsweep_stress, only: root_stress, root_stress_t
  use gearsweep_stress_field, only: find_stress_field
  use gearsweep_text, only: str
  implicit none
  private
  public :: look_at_body

contains

  !> Grid, modes and root stress, from the same two factored grids; these are made only where something is not taken
  !> over from an `earlier` study.
  subroutine look_at_body(study, error, earlier)
    type(study_t), intent(inout) :: study
    type(error_t), allocatable, intent(inout) :: error
    type(study_t), intent(in), optional :: earlier
    type(body_inputs_t) :: body
    type(section_body_t) :: grids(2)
    logical :: new_modes, new_stress

    associate (case => study%case)
      body = body_inputs_t(study%pair%gear(case%root%member), case%material, case%section)
      study%modes_inputs = modes_inputs_t(body, case%modes)
      study%unit_inputs%body = body
      allocate (study%unit_inputs%radius, source=load_radius(study%pair, case%root, load_positions(study%pair, case%root)))
      new_modes = case%asks('modal')
      new_stress = case%asks('static')
      if (present(earlier)) call take_over(study, earlier, new_modes, new_stress, error)
      if (allocated(error)) return
      if (new_modes .or. new_stress) then
        call make_two_grids(body%gear, body%material, body%options, grids, error)
        call note(study, 'section: two grids made and factored')
      else if (case%asks('section')) then
        call make_section(body%gear, body%options, grids(1)%section, error)
        call note(study, 'section: grid made')
      end if
      if (allocated(error)) return
      if (case%asks('section')) study%section = grids(1)%section
      if (new_modes) call find_modes(study%modes_inputs, grids, study%modal, error)
      if (allocated(error)) return
      if (case%asks('modal')) call note(study, 'modal: '//str(case%modes)//' modes'//how(new_modes))
      if (new_stress) call find_unit_stress(study%unit_inputs, grids, study%unit_stress, error)
      if (case%asks('static')) call rate(study, error)
      if (case%asks('static')) &
        call note(study, 'static: root stress at '//str(case%root%positions)//' positions of the load'//how(new_stress))
      if (case%asks('static') .and. case%root%field_position >= 0) &
        call find_field(study, grids(1), new_modes .or. new_stress, error)
    end associate
  end subroutine look_at_body

  pure function how(new)
    logical, intent(in) :: new
    character(merge(17, 12, new)) :: how

    how = ', taken over'
    if (new) how = ' on the two grids'
  end function how

  !> What the earlier study has of the same inputs needs not be made.
  subroutine take_over(study, earlier, new_modes, new_stress, error)
    type(study_t), intent(inout) :: study
    type(study_t), intent(in) :: earlier
    logical, intent(inout) :: new_modes, new_stress
    type(error_t), allocatable, intent(inout) :: error

    if (new_modes .and. allocated(earlier%modal)) new_modes = .not. same(study%modes_inputs, earlier%modes_inputs)
    if (new_stress .and. allocated(earlier%unit_stress)) new_stress = .not. same(study%unit_inputs, earlier%unit_inputs)
    if (study%case%asks('modal') .and. .not. new_modes) then
      associate (grid => earlier%modal%section%grid)
        call claim_memory(16.0_dp*size(earlier%modal%modes%shape) + 100.0_dp*(size(grid%x) + size(grid%element)), &
                          '&modal modes = '//str(study%case%modes), error)
      end associate
      if (.not. allocated(error)) study%modal = earlier%modal
    end if
    if (study%case%asks('static') .and. .not. new_stress .and. .not. allocated(error)) study%unit_stress = earlier%unit_stress
  end subroutine take_over

  subroutine find_modes(inputs, grids, modal, error)
    type(modes_inputs_t), intent(in) :: inputs
    type(section_body_t), intent(in) :: grids(2)
    type(modal_t), allocatable, intent(out) :: modal
    type(error_t), allocatable, intent(inout) :: error

    allocate (modal)
    call section_modes(grids, inputs%modes, modal, error)
  end subroutine find_modes

  subroutine find_unit_stress(inputs, grids, stress, error)
    type(unit_inputs_t), intent(in) :: inputs
    type(section_body_t), intent(in) :: grids(2)
    type(root_stress_t), allocatable, intent(out) :: stress
    type(error_t), allocatable, intent(inout) :: error

    allocate (stress)
    call root_stress(grids, inputs%radius, spread(1.0_dp, 1, size(inputs%radius)), stress, error)
  end subroutine find_unit_stress

  !> The root under what each mesh lets a pair carry.
  subroutine rate(study, error)
    type(study_t), intent(inout) :: study
    type(error_t), allocatable, intent(inout) :: error
    type(mesh_t), allocatable :: meshes(:)

    if (allocated(error)) return
    meshes = study%motion%mesh
    call rate_root(study%pair, meshes, study%load, study%unit_stress, study%case%root, study%root, error)
  end subroutine rate

  !> Stress all over the section, on the finer of the two grids.
  subroutine find_field(study, section, is_made, error)
    type(study_t), intent(inout) :: study
    type(section_body_t), intent(inout) :: section
    logical, intent(in) :: is_made
    type(error_t), allocatable, intent(inout) :: error

    if (allocated(error)) return
    associate (body => study%unit_inputs%body)
      if (.not. is_made) call make_section_body(body%gear, body%material, body%options, section, error)
    end associate
    if (allocated(error)) return
    allocate (study%field)
    call find_stress_field(section, study%root, study%load/minval(study%pair%gear%spec%face_width), &
                           study%case%root%field_position, study%field, error)
    call note(study, 'static: stress all over the section under one position of the load')
  end subroutine find_field
end module gearsweep_body_stage
