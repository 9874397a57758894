!> What a case says of the body behind the teeth, its stress and its modes: &section, &static, &modal.
module gearsweep_body_keys
  use gearsweep_kinds, only: dp, pi
  use gearsweep_case, only: case_t
  use gearsweep_error, only: error_t
  use gearsweep_reader, only: reader_t
  use gearsweep_root_rating, only: shared_by_mesh, shared_equally, shares_stated, spaced_on_flank, spaced_on_path
  use gearsweep_uses, only: first_of, for_tasks, needs_gears, unless
  implicit none
  private
  public :: read_section, read_static, read_modal

contains

  subroutine read_section(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(120) :: geared, shape, support, looks
    character(:), allocatable :: fixed(:), plane, member

    if (allocated(error)) return
    geared = unless(.not. case%prescribed, needs_gears)
    shape = unless(case%needs_section() .or. case%needs_elements(), 'section, static, modal or a stiffness by elements')
    support = unless(case%asks_any('static, modal') .or. case%needs_elements(), 'static, modal or a stiffness by elements')
    ! Printed values may be a tooth's of this member.
    looks = unless(case%needs_section() .or. allocated(case%published), 'section, static or modal')
    associate (section => case%section)
      section%elements_across = 16
      section%others_across = 0
      call reader%get('section', 'teeth', section%teeth, error, waits=shape, refused=geared, at_least=0, at_most=100000)
      call reader%get('section', 'half_angle_deg', section%half_angle, error, waits=shape, refused=geared, &
                      above=0.0_dp, below=180.0_dp, scale=pi/180)
      call reader%get('section', 'rim_mm', section%rim, error, waits=shape, refused=geared, above=0.0_dp, scale=1e-3_dp)
      call reader%get('section', 'elements_across', section%elements_across, error, waits=shape, refused=geared, &
                      at_least=3, at_most=200)
      allocate (fixed, source=[character(5) :: 'sides', 'rim'])
      call reader%get('section', 'fixed', fixed, error, waits=support, refused=geared, &
                      allowed=[character(5) :: 'sides', 'rim'])
      section%fixed_sides = any(fixed == 'sides')
      section%fixed_rim = any(fixed == 'rim')
      plane = 'strain'
      call reader%get('section', 'plane', plane, error, waits=support, refused=geared, &
                      allowed=[character(6) :: 'stress', 'strain'])
      section%plane_strain = plane == 'strain'
    end associate
    member = 'pinion'
    call reader%get('section', 'member', member, error, waits=looks, refused=geared, allowed=[character(6) :: 'pinion', 'gear'])
    case%root%member = merge(2, 1, member == 'gear')
  end subroutine read_section

  subroutine read_static(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: sharing, spacing
    character(120) :: geared, waits
    logical :: stated

    geared = unless(.not. case%prescribed, needs_gears)
    waits = for_tasks(case, 'static')
    associate (root => case%root)
      call reader%get('static', 'shares', root%shares, error, given=stated, waits=waits, refused=geared, &
                      at_least=0.0_dp, at_most=1.0_dp, min_size=2)
      call reader%get('static', 'positions', root%positions, error, at_least=2, at_most=1000, waits=waits, &
                      refused=first_of(geared, unless(.not. stated, 'there are as many as shares; remove it')))
      spacing = 'path'
      call reader%get('static', 'spacing', spacing, error, allowed=[character(5) :: 'path', 'flank'], waits=waits, &
                      refused=first_of(geared, unless(.not. stated, 'stated shares stand at equal arcs of the flank; remove it')))
      root%spacing = merge(spaced_on_flank, spaced_on_path, stated .or. spacing == 'flank')
      sharing = 'mesh'
      call reader%get('static', 'sharing', sharing, error, allowed=[character(5) :: 'mesh', 'equal'], waits=waits, &
                      refused=first_of(geared, unless(.not. stated, 'the shares are stated; give one of the two')))
      root%sharing = merge(shared_equally, shared_by_mesh, sharing == 'equal')
      call reader%get('static', 'tangent_deg', root%tangent, error, waits=waits, refused=geared, above=0.0_dp, below=90.0_dp, &
                      scale=pi/180)
      if (.not. stated .or. allocated(error)) return
      root%sharing = shares_stated
      root%positions = size(root%shares)
    end associate
  end subroutine read_static

  subroutine read_modal(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error

    call reader%get('modal', 'modes', case%modes, error, at_least=1, at_most=1000, &
                    waits=for_tasks(case, 'modal'), refused=unless(.not. case%prescribed, needs_gears))
  end subroutine read_modal
end module gearsweep_body_keys
