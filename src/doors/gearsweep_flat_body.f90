! The flat layer: outlines, and one member's body by finite elements; what the arguments mean is told
! in gearsweep_flat.

!> Outline of one gear about its own centre, its first tooth's axis along y, clockwise; the last point
!> joins the first. Of a gear with more than 500 teeth, one tooth.
!>
!> member               1 pinion, 2 gear
!> points               that there are; also where room is too small (given: room)
!> x_mm(room), y_mm(room)
subroutine gs_outline(text, member, room, points, x_mm, y_mm, info, message)
  use gearsweep_border, only: begin_call, need_room, open_case, run_case, tell
  use gearsweep_case, only: case_t
  use gearsweep_contour, only: shown_contour
  use gearsweep_error, only: code_input, error_t, fail
  use gearsweep_study, only: study_t
  implicit none
  character(*), intent(in) :: text
  integer, intent(in) :: member, room
  integer, intent(inout) :: points
  double precision, intent(inout) :: x_mm(room), y_mm(room)
  integer, intent(out) :: info
  character(*), intent(out) :: message
  double precision, parameter :: none(1) = 0
  double precision, allocatable :: contour(:, :)
  type(case_t) :: case
  type(study_t) :: study
  type(error_t), allocatable :: error

  call begin_call()
  call open_case(text, 'geometry', 1, case, error)
  if (member < 1 .or. member > 2) call fail(error, code_input, 'member: must be 1 (pinion) or 2 (gear)')
  call run_case(case, 0, none, 1, study, error)
  if (.not. allocated(error)) then
    call shown_contour(study%pair%gear(member), contour)
    points = size(contour, 2)
    call need_room('room', room, points, error)
  end if
  if (.not. allocated(error)) then
    x_mm(:points) = 1d3*contour(1, :)
    y_mm(:points) = 1d3*contour(2, :)
  end if
  call tell(error, info, message)
end subroutine gs_outline

!> Grid of the section: task section; the same as that of gs_modes.
!>
!> x_mm(nodes), y_mm(nodes)  the loaded tooth's axis along y, the gear's centre at 0; of an even number of teeth, the middle
!>                           of the space between the loaded tooth and the next one along y
!> element(8, elements)      its nodes, counted from 1: corners, then the middles of the sides, anticlockwise
!> tooth(elements)           0 for the body, 1 for the first tooth from the left
subroutine gs_section(text, nodes, elements, x_mm, y_mm, element, tooth, info, message)
  use gearsweep_border, only: begin_call, need_room, open_case, run_case, tell
  use gearsweep_case, only: case_t
  use gearsweep_error, only: error_t
  use gearsweep_study, only: study_t
  implicit none
  character(*), intent(in) :: text
  integer, intent(in) :: nodes, elements
  double precision, intent(inout) :: x_mm(nodes), y_mm(nodes)
  integer, intent(inout) :: element(8, elements), tooth(elements)
  integer, intent(out) :: info
  character(*), intent(out) :: message
  double precision, parameter :: none(1) = 0
  type(case_t) :: case
  type(study_t) :: study
  type(error_t), allocatable :: error
  integer :: n, m

  call begin_call()
  call open_case(text, 'section', 1, case, error)
  call run_case(case, 0, none, 1, study, error)
  if (.not. allocated(error)) then
    n = size(study%section%grid%x, 2)
    m = size(study%section%grid%element, 2)
    call need_room('nodes', nodes, n, error)
    call need_room('elements', elements, m, error)
  end if
  if (.not. allocated(error)) then
    x_mm(:n) = 1d3*study%section%grid%x(1, :)
    y_mm(:n) = 1d3*study%section%grid%x(2, :)
    element(:, :m) = study%section%grid%element
    tooth(:m) = study%section%grid%part
  end if
  call tell(error, info, message)
end subroutine gs_section

!> Natural frequencies of the section, ascending: task modal.
!>
!> frequency_hz(modes)  estimate(modes) relative error  residual(modes) of the eigenvalue problem
!> rim_share(modes)     share of the rim in the kinetic energy
!> shape(2, nodes, modes)  displacements in x and y at the grid's nodes for a modal mass of 1 kg, in
!>                      m/sqrt(kg); nodes = 0: they are not wanted
subroutine gs_modes(text, modes, nodes, frequency_hz, estimate, residual, rim_share, shape, info, message)
  use gearsweep_border, only: begin_call, need_room, open_case, run_case, tell
  use gearsweep_case, only: case_t
  use gearsweep_error, only: error_t
  use gearsweep_study, only: study_t
  implicit none
  character(*), intent(in) :: text
  integer, intent(in) :: modes, nodes
  double precision, intent(inout), dimension(modes) :: frequency_hz, estimate, residual, rim_share
  double precision, intent(inout) :: shape(2, nodes, modes)
  integer, intent(out) :: info
  character(*), intent(out) :: message
  double precision, parameter :: none(1) = 0
  type(case_t) :: case
  type(study_t) :: study
  type(error_t), allocatable :: error
  integer :: n, m

  call begin_call()
  call open_case(text, 'modal', 1, case, error)
  call need_room('modes', modes, case%modes, error)
  call run_case(case, 0, none, 1, study, error)
  if (.not. allocated(error)) then
    m = size(study%modal%section%grid%x, 2)
    if (nodes /= 0) call need_room('nodes', nodes, m, error)
  end if
  if (.not. allocated(error)) then
    associate (found => study%modal%modes)
      n = size(found%frequency)
      frequency_hz(:n) = found%frequency
      estimate(:n) = study%modal%error_estimate
      residual(:n) = found%residual
      rim_share(:n) = found%participation(0, :)
      if (nodes > 0) shape(:, :m, :n) = found%shape
    end associate
  end if
  call tell(error, info, message)
end subroutine gs_modes

!> Root stress while the load moves over the path with its real share: task static.
!>
!> relief_um(reliefs)  s(positions) of the load, base pitches  radius_mm(positions) where it acts
!> share(positions, reliefs)             of the static load
!> sigma_mpa(2, positions, reliefs)      along the surface at the fillet tangent; drive, coast side
!> parts_mpa(3, 2, positions, reliefs)   its components across and along the tooth axis, and shear
!> tension_mpa(reliefs), compression_mpa(reliefs): largest over fillets and path
!> tension_deg(reliefs), compression_deg(reliefs): tangent to the tooth axis there
!> estimate(reliefs)                     relative error of the larger one
!> iso_mpa, lewis_mpa                    ISO 6336-3 sigma_F0 and Lewis, whole load at the outer
!>                                       point of single contact
subroutine gs_root(text, nwork, work, positions, reliefs, relief_um, s, radius_mm, share, sigma_mpa, parts_mpa, &
                   tension_mpa, tension_deg, compression_mpa, compression_deg, estimate, iso_mpa, lewis_mpa, &
                   info, message)
  use gearsweep_border, only: begin_call, in_um, measure, need_room, open_case, run_case, tell
  use gearsweep_case, only: case_t
  use gearsweep_error, only: error_t
  use gearsweep_kinds, only: pi
  use gearsweep_root_rating, only: load_positions
  use gearsweep_study, only: study_t
  implicit none
  character(*), intent(in) :: text
  integer, intent(in) :: nwork, positions, reliefs
  double precision, intent(in) :: work(*)
  double precision, intent(inout), dimension(positions) :: s, radius_mm
  double precision, intent(inout) :: share(positions, reliefs), sigma_mpa(2, positions, reliefs)
  double precision, intent(inout) :: parts_mpa(3, 2, positions, reliefs), iso_mpa, lewis_mpa
  double precision, intent(inout), dimension(reliefs) :: relief_um, tension_mpa, tension_deg
  double precision, intent(inout), dimension(reliefs) :: compression_mpa, compression_deg, estimate
  integer, intent(out) :: info
  character(*), intent(out) :: message
  type(case_t) :: case
  type(study_t) :: study
  type(error_t), allocatable :: error
  integer :: i, n

  call begin_call()
  call open_case(text, 'static', 1, case, error)
  call measure(case, '', study, error)
  if (.not. allocated(error)) then
    call need_room('positions', positions, size(load_positions(study%pair, case%root)), error)
    call need_room('reliefs', reliefs, size(case%amount), error)
  end if
  call run_case(case, nwork, work, 1, study, error)
  if (.not. allocated(error)) then
    iso_mpa = study%root(1)%iso_stress/1d6
    lewis_mpa = study%root(1)%lewis_stress/1d6
    n = size(study%root(1)%s)
    s(:n) = study%root(1)%s
    radius_mm(:n) = 1d3*study%root(1)%radius
    do i = 1, size(study%root)
      associate (root => study%root(i), stress => study%root(i)%stress)
        relief_um(i) = in_um(case%amount(i))
        share(:n, i) = root%share
        sigma_mpa(:, :n, i) = 1d-6*root%along
        parts_mpa(:, :, :n, i) = 1d-6*root%components
        tension_mpa(i) = 1d-6*stress%tension%stress
        tension_deg(i) = stress%tension%tangent/(pi/180)
        compression_mpa(i) = 1d-6*stress%compression%stress
        compression_deg(i) = stress%compression%tangent/(pi/180)
        estimate(i) = stress%error_estimate
      end associate
    end do
  end if
  call tell(error, info, message)
end subroutine gs_root

!> Stress all over the section for one position of the load: task static; at the nodes of gs_section.
!>
!> position, relief     which of gs_root's, counted from 1
!> relief_um, s, radius_mm, share: what gs_root has there
!> sigma_mpa(3, nodes)  in x, in y, and shear
subroutine gs_stress(text, nwork, work, position, relief, nodes, relief_um, s, radius_mm, share, sigma_mpa, &
                     info, message)
  use gearsweep_border, only: begin_call, in_um, need_room, open_case, run_case, tell
  use gearsweep_case, only: case_t
  use gearsweep_error, only: code_input, error_t, fail
  use gearsweep_root_rating, only: load_positions, load_radius, load_shares
  use gearsweep_section_stress, only: section_stress
  use gearsweep_study, only: study_t
  implicit none
  character(*), intent(in) :: text
  integer, intent(in) :: nwork, position, relief, nodes
  double precision, intent(in) :: work(*)
  double precision, intent(inout) :: relief_um, s, radius_mm, share, sigma_mpa(3, nodes)
  integer, intent(out) :: info
  character(*), intent(out) :: message
  type(case_t) :: case
  type(study_t) :: study
  type(error_t), allocatable :: error
  double precision, allocatable :: path(:), radius(:), part(:), stress(:, :)

  call begin_call()
  call open_case(text, 'static', 1, case, error)
  call case%want(['mesh'])
  call run_case(case, nwork, work, 1, study, error)
  if (.not. allocated(error)) then
    path = load_positions(study%pair, case%root)
    if (position < 1 .or. position > size(path)) call fail(error, code_input, 'position: is none of gs_root')
    if (relief < 1 .or. relief > size(case%amount)) call fail(error, code_input, 'relief: is none of the case')
  end if
  if (.not. allocated(error)) then
    radius = load_radius(study%pair, case%root, path)
    part = load_shares(study%motion(relief)%mesh, study%load, case%root, path)
    call section_stress(study%pair%gear(case%root%member), case%material, case%section, radius(position), &
                        part(position)*study%load/minval(study%pair%gear%spec%face_width), stress, error)
  end if
  if (.not. allocated(error)) call need_room('nodes', nodes, size(stress, 2), error)
  if (.not. allocated(error)) then
    relief_um = in_um(case%amount(relief))
    s = path(position)
    radius_mm = 1d3*radius(position)
    share = part(position)
    sigma_mpa(:, :size(stress, 2)) = 1d-6*stress
  end if
  call tell(error, info, message)
end subroutine gs_stress
