! The flat layer: stability and branches of the motion; what the arguments mean is told in
! gearsweep_flat. The case must name a task that needs the mesh; its own speeds are not used.

!> Stability of the motion with all pairs in contact, whatever the load and relief.
!>
!> rpm(speeds)                of the pinion, ascending       damping_ratio(dampings)
!> modulus(speeds, dampings)  largest of the Floquet multipliers; NaN where the speed is too low
!> sense(speeds, dampings)    its sign where it is real, 0 for a complex pair: beyond 1, a motion with 1
!>                            does not return, one with -1 doubles its period
!> Tongues of instability, from the highest speed on (tongues: how many, or 0):
!> closing_ratio(tongues)     damping ratio that closes it; NaN: above 1
!> closing_rpm(tongues)       where its last point is
!> edge_rpm(2, dampings, tongues)  lower and upper speed at each damping ratio; NaN where closed
subroutine gs_stability(text, nwork, work, speeds, rpm, dampings, damping_ratio, tongues, modulus, sense, &
                        closing_ratio, closing_rpm, edge_rpm, info, message)
  use gearsweep_border, only: begin_call, need_between, need_order, open_case, run_case, tell
  use gearsweep_case, only: case_t
  use gearsweep_error, only: code_memory, error_t, fail
  use gearsweep_stability, only: map_stability, stability_t
  use gearsweep_tongues, only: find_tongues, tongue_t
  use gearsweep_study, only: study_t
  implicit none
  character(*), intent(in) :: text
  integer, intent(in) :: nwork, speeds, dampings, tongues
  double precision, intent(in) :: work(*), rpm(speeds), damping_ratio(dampings)
  double precision, intent(inout) :: modulus(speeds, dampings), closing_ratio(tongues), closing_rpm(tongues)
  double precision, intent(inout) :: edge_rpm(2, dampings, tongues)
  integer, intent(inout) :: sense(speeds, dampings)
  integer, intent(out) :: info
  character(*), intent(out) :: message
  double precision, parameter :: tolerance = 1d-10, slowest = tiny(1d0), fastest = 1d9
  integer, parameter :: most_tongues = 100
  type(case_t) :: case
  type(study_t) :: study
  type(error_t), allocatable :: error
  type(stability_t) :: map
  type(tongue_t) :: tongue(max(0, min(tongues, most_tongues)))
  integer :: n

  call begin_call()
  call open_case(text, 'motion', 1, case, error)
  call need_between('rpm', rpm, slowest, fastest, error)
  call need_order('rpm', rpm, 1, error)
  call need_between('damping_ratio', damping_ratio, 0d0, 1d3, error)
  call need_between('tongues', [dble(tongues)], 0d0, dble(most_tongues), error)
  call run_case(case, nwork, work, 1, study, error)
  if (.not. allocated(error)) call find_tongues(study%motion(1), damping_ratio, tongue, error)
  if (.not. allocated(error)) then
    call map_stability(study%motion(1), rpm, damping_ratio, tolerance, map)
    if (map%lacks) call fail(error, code_memory, 'speeds, dampings: the memory does not hold the map')
  end if
  if (.not. allocated(error)) then
    modulus = map%modulus
    sense = map%sense
    closing_ratio = tongue%closing_damping
    closing_rpm = tongue%closing_rpm
    do n = 1, tongues
      edge_rpm(:, :, n) = tongue(n)%edge
    end do
  end if
  call tell(error, info, message)
end subroutine gs_stability

!> The steady motions that a slow run through the speeds meets, and where they change, for one relief.
!>
!> relief                     which of the case's, from 1
!> rpm(speeds)                of the pinion, in the direction of travel
!> jump                       a dynamic factor that changes by more at once has jumped (0.02)
!> closeness                  of the speeds before and after a change, relative (1e-6)
!> changes                    that there are (given: room for them); also where room is too small
!> change_rpm, change_factor, change_status, change_periods (2, room)  before and after each
!> dynamic_factor, estimate, status, contact, floquet_modulus, periods (speeds)  as from gs_sweep
!> x_um(speeds), v_mm_s(speeds)  dynamic transmission error and its rate as a new pair enters; NaN without
!>                            an answer
subroutine gs_follow(text, nwork, work, relief, speeds, rpm, jump, closeness, room, changes, change_rpm, &
                     change_factor, change_status, change_periods, dynamic_factor, estimate, status, contact, &
                     floquet_modulus, periods, x_um, v_mm_s, info, message)
  use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
  use gearsweep_continuation, only: branch_t, branch_options_t, follow_branch
  use gearsweep_oscillator, only: mesh_period
  use gearsweep_sweep, only: contact_of
  use gearsweep_border, only: begin_call, need_between, need_order, need_room, open_case, run_case, tell
  use gearsweep_case, only: case_t
  use gearsweep_error, only: code_memory, error_t, fail
  use gearsweep_status, only: has_result
  use gearsweep_study, only: study_t
  implicit none
  character(*), intent(in) :: text
  integer, intent(in) :: nwork, relief, speeds, room
  double precision, intent(in) :: work(*), rpm(speeds), jump, closeness
  double precision, intent(inout), dimension(speeds) :: dynamic_factor, estimate, floquet_modulus, x_um, v_mm_s
  integer, intent(inout), dimension(speeds) :: status, contact, periods
  integer, intent(inout) :: changes
  double precision, intent(inout), dimension(2, room) :: change_rpm, change_factor
  integer, intent(inout), dimension(2, room) :: change_status, change_periods
  integer, intent(out) :: info
  character(*), intent(out) :: message
  double precision, parameter :: slowest = tiny(1d0), fastest = 1d9
  type(case_t) :: case
  type(study_t) :: study
  type(error_t), allocatable :: error
  type(branch_t) :: branch
  double precision :: none
  integer :: i

  call begin_call()
  call open_case(text, 'motion', 1, case, error)
  call need_room('speeds', speeds, 1, error)
  call need_between('rpm', rpm, slowest, fastest, error)
  if (.not. allocated(error)) call need_order('rpm', rpm, merge(-1, 1, rpm(speeds) < rpm(1)), error)
  call need_between('jump', [jump], 1d-6, 1d6, error)
  call need_between('closeness', [closeness], 1d-12, 1d0, error)
  if (.not. allocated(error)) call need_between('relief', [dble(relief)], 1d0, dble(size(case%amount)), error)
  call run_case(case, nwork, work, 1, study, error)
  if (.not. allocated(error)) then
    call follow_branch(study%motion(relief), rpm, branch_options_t(case%accuracy, jump, closeness), branch)
    if (branch%lacks) call fail(error, code_memory, 'speeds: the memory does not hold the motions')
  end if
  if (.not. allocated(error)) then
    changes = size(branch%change)
    call need_room('room', room, changes, error)
  end if
  if (.not. allocated(error)) then
    none = ieee_value(none, ieee_quiet_nan)
    associate (point => branch%point, steady => branch%point%steady)
      dynamic_factor = merge(point%dynamic_factor, none, has_result(steady%status))
      estimate = merge(point%estimate, none, has_result(steady%status))
      status = steady%status
      contact = contact_of(steady)
      floquet_modulus = steady%multiplier
      periods = steady%periods
      do i = 1, speeds
        x_um(i) = none
        v_mm_s(i) = none
        if (.not. has_result(steady(i)%status)) cycle
        x_um(i) = 1d6*steady(i)%state(1)
        v_mm_s(i) = 1d3*steady(i)%state(2)/mesh_period(study%motion(relief)%mesh%teeth(1), rpm(i))
      end do
    end associate
    do i = 1, changes
      associate (change => branch%change(i))
        change_rpm(:, i) = change%rpm
        change_status(:, i) = change%point%steady%status
        change_factor(:, i) = merge(change%point%dynamic_factor, none, has_result(change_status(:, i)))
        change_periods(:, i) = change%point%steady%periods
      end associate
    end do
  end if
  call tell(error, info, message)
end subroutine gs_follow

!> The motion seen once a mesh period, as a new pair enters, for one relief; at each further speed it starts
!> where it was at the one before.
!>
!> relief                     which of the case's, from 1
!> rpm(speeds)                of the pinion, in the direction of travel
!> start_um, start_mm_s       where it starts, as from gs_follow; NaN: at rest under the static load
!> settle, keep               mesh periods passed over at each speed, and kept after them
!> x_um(keep, speeds), v_mm_s(keep, speeds)  dynamic transmission error and its rate; NaN where the speed is
!>                            too low or contact changes without end
!> exponent(speeds)           largest Lyapunov exponent, of a mesh period: above 0 where the motion is chaotic
!> status(speeds)             ok, subharmonic, chaotic as from gs_sweep; aperiodic: neither repeats nor is surely
!>                            chaotic within what was kept
!> periods(speeds)            mesh periods until the motion repeats, 0: it does not
subroutine gs_strobe(text, nwork, work, relief, speeds, rpm, start_um, start_mm_s, settle, keep, x_um, v_mm_s, &
                     exponent, status, periods, info, message)
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_border, only: begin_call, need_between, open_case, run_case, tell
  use gearsweep_case, only: case_t
  use gearsweep_error, only: code_memory, error_t, fail
  use gearsweep_poincare, only: sample_section, section_points_t
  use gearsweep_study, only: study_t
  implicit none
  character(*), intent(in) :: text
  integer, intent(in) :: nwork, relief, speeds, settle, keep
  double precision, intent(in) :: work(*), rpm(speeds), start_um, start_mm_s
  double precision, intent(inout), dimension(keep, speeds) :: x_um, v_mm_s
  double precision, intent(inout) :: exponent(speeds)
  integer, intent(inout), dimension(speeds) :: status, periods
  integer, intent(out) :: info
  character(*), intent(out) :: message
  double precision, parameter :: slowest = tiny(1d0), fastest = 1d9, most = 1d7, far = 1d9
  type(case_t) :: case
  type(study_t) :: study
  type(error_t), allocatable :: error
  type(section_points_t) :: strobe
  logical :: at_rest

  call begin_call()
  call open_case(text, 'motion', 1, case, error)
  call need_between('rpm', rpm, slowest, fastest, error)
  call need_between('settle', [dble(settle)], 0d0, most, error)
  call need_between('keep', [dble(keep)], 1d0, most, error)
  if (.not. allocated(error)) call need_between('relief', [dble(relief)], 1d0, dble(size(case%amount)), error)
  at_rest = ieee_is_nan(start_um) .or. ieee_is_nan(start_mm_s)
  if (.not. at_rest) call need_between('start', [start_um, start_mm_s], -far, far, error)
  call run_case(case, nwork, work, 1, study, error)
  if (.not. allocated(error)) then
    if (at_rest) then
      call sample_section(study%motion(relief), rpm, settle, keep, strobe)
    else
      call sample_section(study%motion(relief), rpm, settle, keep, strobe, [1d-6*start_um, 1d-3*start_mm_s])
    end if
    if (strobe%lacks) call fail(error, code_memory, 'speeds, keep: the memory does not hold the motions')
  end if
  if (.not. allocated(error)) then
    x_um = 1d6*strobe%x
    v_mm_s = 1d3*strobe%v
    exponent = strobe%exponent
    status = strobe%status
    periods = strobe%periods
  end if
  call tell(error, info, message)
end subroutine gs_strobe
