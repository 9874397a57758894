!> What a case says of the body behind the teeth: &section.
module gearsweep_body_keys
  use gearsweep_kinds, only: dp
  use gearsweep_case, only: case_t
  use gearsweep_error, only: error_t
  use gearsweep_reader, only: reader_t
  use gearsweep_task, only: sentence_of, stage
  use gearsweep_uses, only: needs_gears, sentence_length, unless
  implicit none
  private
  public :: read_section

contains

  subroutine read_section(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(2*sentence_length) :: with_body, with_support
    character(sentence_length) :: geared, shape, fineness, support, looks
    character(:), allocatable :: fixed(:), plane, member

    if (allocated(error)) return
    geared = unless(.not. case%prescribed, needs_gears)
    with_body = sentence_of(case%tasks, stage%section, other=stage%mesh)
    with_support = 'modal, '//case%tasks_for(stage%mesh)
    shape = unless(case%needs(stage%section) .or. case%needs_elements(), &
                   'section, static, modal, precision, transient, harmonic or a stiffness by elements')
    ! The task precision has a fineness of its own.
    fineness = unless(case%asks('section') .or. case%asks('static') .or. case%asks('modal') .or. &
                      case%asks('transient') .or. case%asks('harmonic') .or. case%needs_elements(), &
                      'section, static, modal, transient, harmonic or a stiffness by elements')
    support = unless(case%needs(stage%body) .or. case%needs_elements(), &
                     'static, modal, precision, transient, harmonic or a stiffness by elements')
    ! Printed values may be a tooth's of this gear.
    looks = unless(case%needs(stage%section) .or. case%needs(stage%solid) .or. allocated(case%published), &
                   'section, static, modal, precision, transient, harmonic or body_modes')
    associate (section => case%section)
      section%elements_across = 16
      section%others_across = 0
      call reader%get('section', 'teeth', section%teeth, error, tasks=with_body, lacks=shape, refused=geared, &
                      at_least=0, at_most=100000, &
                      meaning='teeth in the section, the middle one (of an even number, the left one of the two) loaded; '// &
                      '0, or as many as the gear has without half_angle_deg, for the whole gear')
      call reader%get('section', 'half_angle_deg', section%half_angle, error, unit='deg', tasks=with_body, lacks=shape, &
                      refused=geared, above=0.0_dp, below=180.0_dp, otherwise='to the middle of the outer spaces', &
                      meaning='angle from the section''s axis to either of its cut sides, which must lie between the fillets '// &
                      'of the outer teeth and the next teeth')
      call reader%get('section', 'rim_mm', section%rim, error, unit='mm', tasks=with_body, lacks=shape, refused=geared, &
                      above=0.0_dp, otherwise='down to the bore, or 2.5 tooth heights', &
                      meaning='thickness of the body below the root circle; it must leave room to the bore; without it and '// &
                      'fixed, the pair stiffness of a gear with a web takes its rim_thickness_mm, free inside')
      call reader%get('section', 'elements_across', section%elements_across, error, tasks=with_body, lacks=fineness, &
                      refused=geared, at_least=3, at_most=200, &
                      meaning='finite elements across the loaded tooth, which all else follows')
      allocate (fixed, source=[character(5) :: 'sides', 'rim'])
      call reader%get('section', 'fixed', fixed, error, tasks=with_support, lacks=support, refused=geared, &
                      allowed=[character(5) :: 'sides', 'rim'], &
                      meaning='what is held: the two cut sides, the inner edge; a whole gear has no sides, so its inner '// &
                      'edge must be held')
      case%has_extent = reader%has('section', 'teeth') .or. reader%has('section', 'half_angle_deg')
      case%has_support = reader%has('section', 'fixed')
      section%fixed_sides = any(fixed == 'sides')
      section%fixed_rim = any(fixed == 'rim')
      plane = 'strain'
      call reader%get('section', 'plane', plane, error, tasks=with_support, lacks=support, refused=geared, &
                      allowed=[character(6) :: 'stress', 'strain'], &
                      meaning='plane strain suits a wide gear, plane stress a thin one')
      section%plane_strain = plane == 'strain'
    end associate
    member = 'pinion'
    call reader%get('section', 'member', member, error, lacks=looks, refused=geared, &
                    allowed=[character(6) :: 'pinion', 'gear'], &
                    meaning='the gear whose section the tasks section, static, modal, precision, transient and harmonic take, '// &
                    'and whose body body_modes')
    case%member = merge(2, 1, member == 'gear')
  end subroutine read_section
end module gearsweep_body_keys
