!> Keys of the load over the face width: &face, and the leads of &pinion and &gear.
module gearsweep_study_case_face_keys
  use gearsweep_base, only: code_input, error_t, fail, dp
  use gearsweep_face, only: far, lead_t, near
  use gearsweep_study_case_case, only: case_t, for_stage
  use gearsweep_study_case_task, only: gear_names, stage
  use gearsweep_study_reader_reader, only: first_nonblank, needs_gears, reader_t, sentence_length, text_unless
  use gearsweep_study_reader_values, only: fail_entry
  implicit none
  private
  public :: read_face

  real(dp), parameter :: most = 1000             !< um

contains

  !> Reads &face and the leads of both gears.
  subroutine read_face(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(sentence_length) :: geared, unused_without, users
    integer :: i

    geared = text_unless(.not. case%prescribed, needs_gears)
    users = case%tasks_for(stage%face)
    unused_without = for_stage(case, stage%face)
    do i = 1, 2
      call read_lead(trim(gear_names(i)), case%faces%alignment%lead(i))
    end do
    call reader%get('face', 'misalignment_um', case%faces%alignment%misalignment, error, unit='um', tasks=users, &
                    unused_without=unused_without, not_allowed=geared, at_least=-most, at_most=most, &
                    meaning='misalignment on the line of action over the face width; positive: the flanks are nearer at '// &
                    'the end z = 0, from which face_load counts')
    call read_shaft()
    call reader%get('face', 'slices', case%faces%slices, error, tasks=users, &
                    unused_without=first_nonblank(unused_without, text_unless(case%needs_face_load(), &
                    'face_load, a misalignment, a lead or a shaft')), not_allowed=geared, &
                    at_least=8, at_most=200, default_note='automatic, 0.35 to 1 module wide', &
                    meaning='about how many slices of the face have a load of their own')
    if (case%faces%are_uneven() .and. reader%has('rating', 'face_load_factor') .and. len_trim(unused_without) == 0) &
      call fail_entry(reader%list%entries(reader%list%position('rating', 'face_load_factor')), 'the load over the face width '// &
                      'has it, with &face or a lead of a gear; remove it', error)

  contains

    subroutine read_lead(group, lead)
      character(*), intent(in) :: group
      type(lead_t), intent(inout) :: lead
      logical :: given(2)

      call reader%get(group, 'lead_slope_um', lead%slope, error, unit='um', tasks=users, unused_without=unused_without, &
                      not_allowed=geared, at_least=-most, at_most=most, &
                      meaning='lead slope over the face width: material missing at the end z = b; negative: at z = 0')
      call reader%get(group, 'crowning_um', lead%crowning, error, unit='um', tasks=users, unused_without=unused_without, &
                      not_allowed=geared, at_least=-most, at_most=most, &
                      meaning='crowning of the lead, parabolic: material missing at both ends of the face; negative: hollow')
      call reader%get(group, 'end_relief_um', lead%end_relief, error, unit='um', is_stated=given(1), tasks=users, &
                      unused_without=unused_without, not_allowed=geared, at_least=0.0_dp, at_most=most, &
                      default_note='none', meaning='linear end relief at both ends of the face; goes with end_relief_mm')
      call reader%get(group, 'end_relief_mm', lead%end_relief_length, error, unit='mm', is_stated=given(2), tasks=users, &
                      unused_without=unused_without, not_allowed=geared, above=0.0_dp, at_most=1e5_dp, default_note='none', &
                      meaning='length of the end relief from each end, at most half of the face width')
      if (given(1) .neqv. given(2)) call fail(error, code_input, '&'//group//' '//trim(merge('end_relief_mm', 'end_relief_um', &
        given(1)))//': missing; an end relief has end_relief_um and end_relief_mm')
    end subroutine read_lead

    subroutine read_shaft()
      character(:), allocatable :: side
      logical :: given(4)
      character(*), parameter :: keys(3) = [character(17) :: 'shaft_diameter_mm', 'bearing_span_mm', 'torque_side']

      associate (shaft => case%faces%shaft)
        call reader%get('face', 'shaft_diameter_mm', shaft%diameter, error, unit='mm', is_stated=given(1), tasks=users, &
                        unused_without=unused_without, not_allowed=geared, above=0.0_dp, at_most=1e5_dp, &
                        default_note='none, a rigid shaft', &
                        meaning='diameter of the pinion''s shaft between its bearings: pinion and shaft twist and bend')
        call reader%get('face', 'bearing_span_mm', shaft%span, error, unit='mm', is_stated=given(2), tasks=users, &
                        unused_without=unused_without, not_allowed=geared, above=0.0_dp, at_most=1e5_dp, default_note='none', &
                        meaning='distance between the bearings of that shaft')
        call reader%get('face', 'torque_side', side, error, is_stated=given(3), tasks=users, unused_without=unused_without, &
                        not_allowed=geared, allowed=[character(4) :: 'near', 'far'], default_note='none', &
                        meaning='end of the face where the torque enters the pinion: near (z = 0) or far (z = b)')
        call reader%get('face', 'bearing_offset_mm', shaft%offset, error, unit='mm', is_stated=given(4), tasks=users, &
                        unused_without=unused_without, not_allowed=geared, at_least=-1e5_dp, at_most=1e5_dp, &
                        default_note='0, in the middle', &
                        meaning='place of the middle of the face from the middle between the bearings; positive towards z = b')
        if (any(given) .and. .not. all(given(:3))) call fail(error, code_input, '&face '// &
          trim(keys(findloc(given(:3), .false., 1)))//': missing; a shaft has shaft_diameter_mm, bearing_span_mm and torque_side')
        if (allocated(error) .or. .not. allocated(side)) return
        shaft%torque_side = merge(far, near, side == 'far')
      end associate
    end subroutine read_shaft
  end subroutine read_face
end module gearsweep_study_case_face_keys
