!> What a case says of the body behind the teeth, its stress and its modes: &section, &static, &modal.
module gearsweep_body_keys
  use gearsweep_kinds, only: dp
  use gearsweep_case, only: case_t
  use gearsweep_error, only: error_t
  use gearsweep_reader, only: reader_t
  use gearsweep_root_rating, only: shared_by_mesh, shared_equally, shares_stated, spaced_on_flank, spaced_on_path
  use gearsweep_tasks, only: sentence_length, sentence_of
  use gearsweep_uses, only: first_of, needs_gears, unless
  implicit none
  private
  public :: read_section, read_static, read_modal

contains

  subroutine read_section(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(2*sentence_length) :: with_body, with_support
    character(sentence_length) :: geared, shape, support, looks
    character(:), allocatable :: fixed(:), plane, member

    if (allocated(error)) return
    geared = unless(.not. case%prescribed, needs_gears)
    with_body = trim(sentence_of(case%tasks, 'body'))//', '//sentence_of(case%tasks, 'mesh', but='static')
    with_support = 'modal, '//case%tasks_for('mesh')
    shape = unless(case%needs_section() .or. case%needs_elements(), 'section, static, modal or a stiffness by elements')
    support = unless(case%asks_any('static, modal') .or. case%needs_elements(), 'static, modal or a stiffness by elements')
    ! Printed values may be a tooth's of this member.
    looks = unless(case%needs_section() .or. allocated(case%published), 'section, static or modal')
    associate (section => case%section)
      section%elements_across = 16
      section%others_across = 0
      call reader%get('section', 'teeth', section%teeth, error, tasks=with_body, waits=shape, refused=geared, &
                      at_least=0, at_most=100000, &
                      meaning='teeth in the section, the middle one (of an even number, the left one of the two) loaded; '// &
                      '0, or as many as the gear has without half_angle_deg, for the whole gear')
      call reader%get('section', 'half_angle_deg', section%half_angle, error, unit='deg', tasks=with_body, waits=shape, &
                      refused=geared, above=0.0_dp, below=180.0_dp, otherwise='to the middle of the outer spaces', &
                      meaning='angle from the section''s axis to either of its cut sides, which must lie between the fillets '// &
                      'of the outer teeth and the next teeth')
      call reader%get('section', 'rim_mm', section%rim, error, unit='mm', tasks=with_body, waits=shape, refused=geared, &
                      above=0.0_dp, otherwise='down to the bore, or 2.5 tooth heights', &
                      meaning='thickness of the body below the root circle; it must leave room to the bore')
      call reader%get('section', 'elements_across', section%elements_across, error, tasks=with_body, waits=shape, &
                      refused=geared, at_least=3, at_most=200, &
                      meaning='finite elements across the loaded tooth, which all else follows')
      allocate (fixed, source=[character(5) :: 'sides', 'rim'])
      call reader%get('section', 'fixed', fixed, error, tasks=with_support, waits=support, refused=geared, &
                      allowed=[character(5) :: 'sides', 'rim'], &
                      meaning='what is held: the two cut sides, the inner edge; a whole gear has no sides, so its inner '// &
                      'edge must be held')
      section%fixed_sides = any(fixed == 'sides')
      section%fixed_rim = any(fixed == 'rim')
      plane = 'strain'
      call reader%get('section', 'plane', plane, error, tasks=with_support, waits=support, refused=geared, &
                      allowed=[character(6) :: 'stress', 'strain'], &
                      meaning='plane strain suits a wide gear, plane stress a thin one')
      section%plane_strain = plane == 'strain'
    end associate
    member = 'pinion'
    call reader%get('section', 'member', member, error, waits=looks, refused=geared, &
                    allowed=[character(6) :: 'pinion', 'gear'], &
                    meaning='the gear whose section the tasks section, static and modal take')
    case%root%member = merge(2, 1, member == 'gear')
  end subroutine read_section

  subroutine read_static(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: sharing, spacing
    character(*), parameter :: task = 'static'
    character(sentence_length) :: geared
    logical :: stated

    geared = unless(.not. case%prescribed, needs_gears)
    associate (root => case%root)
      call reader%get('static', 'shares', root%shares, error, given=stated, tasks=task, refused=geared, &
                      at_least=0.0_dp, at_most=1.0_dp, min_size=2, otherwise='as sharing says', &
                      meaning='share of the static load at each position, from the outermost point of contact inwards in '// &
                      'equal arcs of the flank')
      call reader%get('static', 'positions', root%positions, error, at_least=2, at_most=1000, tasks=task, &
                      refused=first_of(geared, unless(.not. stated, 'there are as many as shares; remove it')), &
                      meaning='positions of the load on the flank; not with shares, of which there is one for each')
      spacing = 'path'
      call reader%get('static', 'spacing', spacing, error, allowed=[character(5) :: 'path', 'flank'], tasks=task, &
                      refused=first_of(geared, unless(.not. stated, 'stated shares stand at equal arcs of the flank; remove it')), &
                      meaning='path: equal steps along the path of contact from A to E, and either side of the places where '// &
                      'the share jumps; flank: equal arcs of the flank, from the outermost point of contact inwards')
      root%spacing = merge(spaced_on_flank, spaced_on_path, stated .or. spacing == 'flank')
      sharing = 'mesh'
      call reader%get('static', 'sharing', sharing, error, allowed=[character(5) :: 'mesh', 'equal'], tasks=task, &
                      refused=first_of(geared, unless(.not. stated, 'the shares are stated; give one of the two')), &
                      meaning='load on the tooth: as stiffness and relief share it (mesh), or the same for all pairs in '// &
                      'contact (equal); not with shares')
      root%sharing = merge(shared_equally, shared_by_mesh, sharing == 'equal')
      call reader%get('static', 'tangent_deg', root%tangent, error, unit='deg', tasks=task, refused=geared, &
                      above=0.0_dp, below=90.0_dp, &
                      meaning='angle between the tangent to the fillet and the axis of the tooth where the table gives the '// &
                      'stress; such a point must lie on the fillet')
      call reader%get('static', 'field_position', root%field_position, error, at_least=0, at_most=2000, tasks=task, &
                      refused=geared, otherwise='no such table', &
                      meaning='position of the load, counted from 1 in the table static, for the stress all over the section '// &
                      'in the table stress; 0: where the tension is largest')
      if (.not. stated .or. allocated(error)) return
      root%sharing = shares_stated
      root%positions = size(root%shares)
    end associate
  end subroutine read_static

  subroutine read_modal(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error

    call reader%get('modal', 'modes', case%modes, error, at_least=1, at_most=1000, tasks='modal', &
                    refused=unless(.not. case%prescribed, needs_gears), &
                    meaning='number of natural modes from the lowest, below half the unknowns of the grid')
  end subroutine read_modal
end module gearsweep_body_keys
