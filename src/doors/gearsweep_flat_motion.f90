! The flat layer: gears, mesh and motion; what the arguments mean is told in gearsweep_flat.

!> Geometry of the pair. Second index of arrays: pinion, gear.
!>
!> radius_mm(6, 2)       tip, reference, drive base, coast base, root, start of the drive involute
!> point(5)              A, B, P, D, E along the path of contact, base pitches
!> point_radius_mm(5, 2) radius at which each member touches there
!> distance_mm           centre distance
!> working_angle_deg(2)  of the drive and the coast flanks
!> contact_ratio         transverse
!> base_pitch_mm         of the drive flanks
!> backlash_um           along the line of action
subroutine gs_geometry(text, radius_mm, point, point_radius_mm, distance_mm, working_angle_deg, &
                       contact_ratio, base_pitch_mm, backlash_um, info, message)
  use gearsweep_border, only: begin_call, open_case, run_case, tell
  use gearsweep_case, only: case_t
  use gearsweep_error, only: error_t
  use gearsweep_gear, only: coast, drive
  use gearsweep_kinds, only: pi
  use gearsweep_study, only: study_t
  implicit none
  character(*), intent(in) :: text
  double precision, intent(inout) :: radius_mm(6, 2), point(5), point_radius_mm(5, 2), distance_mm
  double precision, intent(inout) :: working_angle_deg(2), contact_ratio, base_pitch_mm, backlash_um
  integer, intent(out) :: info
  character(*), intent(out) :: message
  double precision, parameter :: none(1) = 0
  type(case_t) :: case
  type(study_t) :: study
  type(error_t), allocatable :: error
  integer :: i

  call begin_call()
  call open_case(text, 'geometry', 1, case, error)
  call run_case(case, 0, none, 1, study, error)
  if (.not. allocated(error)) then
    associate (pair => study%pair)
      point = pair%points()
      do i = 1, 2
        associate (gear => pair%gear(i))
          radius_mm(:, i) = 1d3*[gear%tip_radius, gear%reference_radius, gear%base_radius(drive), &
                                 gear%base_radius(coast), gear%root_radius, gear%form_radius(drive)]
        end associate
        point_radius_mm(:, i) = 1d3*pair%radius(i, point)
      end do
      distance_mm = 1d3*pair%centre_distance
      working_angle_deg = pair%working_angle/(pi/180)
      contact_ratio = pair%contact_ratio
      base_pitch_mm = 1d3*pair%base_pitch
      backlash_um = 1d6*abs(max(0d0, pair%backlash))
    end associate
  end if
  call tell(error, info, message)
end subroutine gs_geometry

!> What drives the motion.
!>
!> load_n        static load on the line of action      mass_kg(2)    effective masses on it
!> stiffness_n_um mean mesh stiffness, whole width      frequency_hz  natural frequency
!> turn_um       what whole gears turn about their bores under the load, on the line of action; not in the motion
!> shared_um     what neighbouring teeth share beyond that, in the stiffness of each pair; both of model 'fe', else 0
subroutine gs_motion(text, nwork, work, load_n, mass_kg, stiffness_n_um, frequency_hz, turn_um, shared_um, info, message)
  use gearsweep_border, only: begin_call, open_case, run_case, tell
  use gearsweep_case, only: case_t
  use gearsweep_error, only: error_t
  use gearsweep_kinds, only: pi
  use gearsweep_study, only: study_t
  implicit none
  character(*), intent(in) :: text
  integer, intent(in) :: nwork
  double precision, intent(in) :: work(*)
  double precision, intent(inout) :: load_n, mass_kg(2), stiffness_n_um, frequency_hz, turn_um, shared_um
  integer, intent(out) :: info
  character(*), intent(out) :: message
  type(case_t) :: case
  type(study_t) :: study
  type(error_t), allocatable :: error

  call begin_call()
  call open_case(text, 'motion', 1, case, error)
  call run_case(case, nwork, work, 1, study, error)
  if (.not. allocated(error)) then
    load_n = study%load
    mass_kg = study%mass
    stiffness_n_um = study%mesh%mean_stiffness()/1d6
    frequency_hz = study%motion(1)%natural_frequency/(2*pi)
    turn_um = 1d6*study%load*study%mesh%disc%turn
    shared_um = 1d6*study%load*study%mesh%disc%shared
  end if
  call tell(error, info, message)
end subroutine gs_motion

!> One pair along the path of contact, static: task mesh. Rows as in the table of that name, reliefs
!> after each other, s ascending; where a pair enters or a relief begins, both sides have a row.
!>
!> relief_um(rows)  s(rows) base pitches from A    pair_n_um(rows)  stiffness of this pair
!> mesh_n_um(rows)  of all pairs that carry and whole gears' discs  error_um(rows)  profile error
!> share(rows)      of the static load             ste_um(rows)     static transmission error
subroutine gs_mesh(text, nwork, work, rows, relief_um, s, pair_n_um, mesh_n_um, error_um, share, ste_um, &
                   info, message)
  use gearsweep_border, only: begin_call, in_um, need_room, open_case, run_case, tell
  use gearsweep_case, only: case_t
  use gearsweep_error, only: error_t
  use gearsweep_study, only: study_t
  implicit none
  character(*), intent(in) :: text
  integer, intent(in) :: nwork, rows
  double precision, intent(in) :: work(*)
  double precision, intent(inout), dimension(rows) :: relief_um, s, pair_n_um, mesh_n_um, error_um, share, ste_um
  integer, intent(out) :: info
  character(*), intent(out) :: message
  type(case_t) :: case
  type(study_t) :: study
  type(error_t), allocatable :: error
  integer :: i, j, k, row

  call begin_call()
  call open_case(text, 'mesh', 1, case, error)
  call run_case(case, nwork, work, 1, study, error)
  if (.not. allocated(error)) call need_room('rows', rows, &
    sum([(sum(study%sharing(i)%pairs), i=1, size(study%sharing))]), error)
  if (.not. allocated(error)) then
    row = 0
    do i = 1, size(study%sharing)
      associate (sharing => study%sharing(i), mesh => study%motion(i)%mesh, relief => in_um(study%case%amount(i)))
        do j = 1, maxval(sharing%pairs)
          do k = 1, size(sharing%phase)
            if (sharing%pairs(k) < j) cycle
            row = row + 1
            relief_um(row) = relief
            s(row) = sharing%s(j, k)
            pair_n_um(row) = mesh%stiffness%value(s(row))/1d6
            mesh_n_um(row) = sharing%stiffness(k)/1d6
            error_um(row) = 1d6*mesh%profile_error%value(s(row))
            share(row) = sharing%load(j, k)/study%load
            ste_um(row) = 1d6*sharing%error(k)
          end do
        end do
      end associate
    end do
  end if
  call tell(error, info, message)
end subroutine gs_mesh

!> Static transmission error over one mesh period, for each relief: task mesh. Over the phase tau, 0
!> where a pair enters at A, it is mean + sum of amplitude(k) cos(2 pi k tau + phase(k)).
!>
!> relief_um(reliefs)
!> mean_um(reliefs)  rms_um(reliefs) of the deviation from it  peak_to_peak_um(reliefs)
!> amplitude_um(harmonics, reliefs), phase_deg(harmonics, reliefs)
!> estimate_um(reliefs)  error of mean and amplitudes
subroutine gs_harmonics(text, nwork, work, harmonics, reliefs, relief_um, mean_um, rms_um, peak_to_peak_um, &
                        amplitude_um, phase_deg, estimate_um, info, message)
  use gearsweep_border, only: begin_call, in_um, need_room, open_case, run_case, tell
  use gearsweep_case, only: case_t
  use gearsweep_error, only: error_t
  use gearsweep_kinds, only: pi
  use gearsweep_study, only: study_t
  implicit none
  character(*), intent(in) :: text
  integer, intent(in) :: nwork, harmonics, reliefs
  double precision, intent(in) :: work(*)
  double precision, intent(inout), dimension(reliefs) :: relief_um, mean_um, rms_um, peak_to_peak_um, estimate_um
  double precision, intent(inout), dimension(harmonics, reliefs) :: amplitude_um, phase_deg
  integer, intent(out) :: info
  character(*), intent(out) :: message
  type(case_t) :: case
  type(study_t) :: study
  type(error_t), allocatable :: error
  integer :: i, n

  call begin_call()
  call open_case(text, 'mesh', 1, case, error)
  if (.not. allocated(error)) then
    call need_room('harmonics', harmonics, case%harmonics, error)
    call need_room('reliefs', reliefs, size(case%amount), error)
  end if
  call run_case(case, nwork, work, 1, study, error)
  if (.not. allocated(error)) then
    n = case%harmonics
    do i = 1, size(study%harmonics)
      associate (ste => study%harmonics(i))
        relief_um(i) = in_um(case%amount(i))
        mean_um(i) = 1d6*ste%mean
        rms_um(i) = 1d6*ste%rms
        peak_to_peak_um(i) = 1d6*ste%peak_to_peak()
        amplitude_um(:n, i) = 1d6*ste%amplitude
        phase_deg(:n, i) = ste%phase*180/pi
        estimate_um(i) = 1d6*ste%error_estimate
      end associate
    end do
  end if
  call tell(error, info, message)
end subroutine gs_harmonics

!> Dynamic load of one pair along its path at the speeds load_rpm: task load. Rows as in the table. Where the case
!> names the task sweep too, the motions are those of its sweep, which is run for them.
!>
!> rows  that there are; also where room is too small (given: room)
!> relief_um(room)  rpm(room)  s(room) base pitches from A  pair_load_n(room)  dte_um(room) dynamic
!> transmission error
!> status(room)  of the operating point, as from gs_sweep; one without an answer has a single row of NaN
!> periods(room) mesh periods until the motion repeats: so many pairs differ
!> pair(room)    which of them, from 1; 0 without an answer
subroutine gs_load(text, nwork, work, room, rows, relief_um, rpm, s, pair_load_n, dte_um, status, periods, pair, &
                   info, message)
  use gearsweep_border, only: begin_call, in_um, need_room, open_case, run_case, tell
  use gearsweep_case, only: case_t
  use gearsweep_error, only: error_t
  use gearsweep_study, only: study_t
  implicit none
  character(*), intent(in) :: text
  integer, intent(in) :: nwork, room
  double precision, intent(in) :: work(*)
  integer, intent(inout) :: rows
  double precision, intent(inout), dimension(room) :: relief_um, rpm, s, pair_load_n, dte_um
  integer, intent(inout), dimension(room) :: status, periods, pair
  integer, intent(out) :: info
  character(*), intent(out) :: message
  type(case_t) :: case
  type(study_t) :: study
  type(error_t), allocatable :: error
  integer :: i, k, from, until

  call begin_call()
  call open_case(text, 'load', 1, case, error)
  call run_case(case, nwork, work, 1, study, error)
  if (.not. allocated(error)) then
    rows = sum([((size(study%response(i, k)%s), i=1, size(study%response, 1)), k=1, size(study%response, 2))])
    call need_room('room', room, rows, error)
  end if
  if (.not. allocated(error)) then
    until = 0
    do k = 1, size(study%response, 2)
      do i = 1, size(study%response, 1)
        associate (response => study%response(i, k))
          from = until + 1
          until = until + size(response%s)
          relief_um(from:until) = in_um(study%case%amount(i))
          rpm(from:until) = response%rpm
          s(from:until) = response%s
          pair_load_n(from:until) = response%load
          dte_um(from:until) = 1d6*response%error
          status(from:until) = response%point%steady%status
          periods(from:until) = response%point%steady%periods
          pair(from:until) = response%pair
        end associate
      end do
    end do
  end if
  ! Of the sweep nothing is told here.
  if (allocated(study%sweep)) deallocate (study%sweep)
  call tell(error, info, message, study)
end subroutine gs_load

!> Dynamic factor over speed and relief: task sweep.
!>
!> rpm(speeds)                      of the pinion, ascending
!> relief_um(reliefs)               as in the case
!> dynamic_factor(speeds, reliefs)  NaN without an answer
!> estimate(speeds, reliefs)        of its error
!> status(speeds, reliefs)          0 ok, 1 marginal, 2 subharmonic, 3 inexact; without an answer:
!>                                  4 unstable, 5 aperiodic, 6 unresolved, 7 chatter, 8 chaotic
!> contact(speeds, reliefs)         0 full, 1 partial, 2 lost, 3 coast sides touched
!> floquet_modulus(speeds, reliefs) largest of the multipliers: what is left of a disturbance
!> residual(speeds, reliefs)        by how much the motion fails to repeat, static deflections
!> steps(speeds, reliefs)           in a mesh period
!> periods(speeds, reliefs)         mesh periods until the motion repeats
subroutine gs_sweep(text, nwork, work, threads, speeds, reliefs, rpm, relief_um, dynamic_factor, estimate, &
                    status, contact, floquet_modulus, residual, steps, periods, info, message)
  use gearsweep_border, only: begin_call, in_um, need_room, open_case, run_case, tell
  use gearsweep_case, only: case_t, list_speeds => speeds
  use gearsweep_error, only: error_t
  use gearsweep_study, only: study_t
  implicit none
  character(*), intent(in) :: text
  integer, intent(in) :: nwork, threads, speeds, reliefs
  double precision, intent(in) :: work(*)
  double precision, intent(inout) :: rpm(speeds), relief_um(reliefs)
  double precision, intent(inout), dimension(speeds, reliefs) :: dynamic_factor, estimate, floquet_modulus, residual
  integer, intent(inout), dimension(speeds, reliefs) :: status, contact, steps, periods
  integer, intent(out) :: info
  character(*), intent(out) :: message
  type(case_t) :: case
  type(study_t) :: study
  type(error_t), allocatable :: error
  integer :: n, m

  call begin_call()
  call open_case(text, 'sweep', threads, case, error)
  if (.not. allocated(error)) then
    call need_room('speeds', speeds, size(list_speeds(case)), error)
    call need_room('reliefs', reliefs, size(case%amount), error)
  end if
  call run_case(case, nwork, work, threads, study, error)
  if (.not. allocated(error)) then
    n = size(study%sweep%rpm)
    m = size(study%case%amount)
    rpm(:n) = study%sweep%rpm
    relief_um(:m) = in_um(study%case%amount)
    dynamic_factor(:n, :m) = study%sweep%dynamic_factor
    estimate(:n, :m) = study%sweep%estimate
    status(:n, :m) = study%sweep%status
    contact(:n, :m) = study%sweep%contact
    floquet_modulus(:n, :m) = study%sweep%multiplier
    residual(:n, :m) = study%sweep%residual
    steps(:n, :m) = study%sweep%steps
    periods(:n, :m) = study%sweep%periods
  end if
  call tell(error, info, message, study)
end subroutine gs_sweep

!> Resonances of one curve of gs_sweep; runs nothing. At most five.
!>
!> rpm(speeds), dynamic_factor(speeds)  the curve; NaN where there is no answer
!> found                                how many stand out
!> peak_rpm(5), peak_factor(5)          speed and dynamic factor of each, by speed
subroutine gs_resonances(speeds, rpm, dynamic_factor, found, peak_rpm, peak_factor, info, message)
  use gearsweep_border, only: begin_call, need_room, tell
  use gearsweep_error, only: error_t
  use gearsweep_optimum, only: find_resonances, peak_t
  implicit none
  integer, intent(in) :: speeds
  double precision, intent(in) :: rpm(speeds), dynamic_factor(speeds)
  integer, intent(inout) :: found
  double precision, intent(inout) :: peak_rpm(5), peak_factor(5)
  integer, intent(out) :: info
  character(*), intent(out) :: message
  type(error_t), allocatable :: error
  type(peak_t), allocatable :: peaks(:)

  call begin_call()
  call need_room('speeds', speeds, 1, error)
  if (.not. allocated(error)) then
    peaks = find_resonances(rpm, dynamic_factor)
    found = size(peaks)
    peak_rpm(:found) = peaks%rpm
    peak_factor(:found) = peaks%dynamic_factor
  end if
  call tell(error, info, message)
end subroutine gs_resonances

!> The relief with the least worst dynamic factor over the speeds: task optimum.
!>
!> tried                  reliefs that were tried, ascending (given: room for them)
!> relief_um(room), worst_factor(room), rpm(room), failed(room): the curve; largest dynamic factor
!> over the speeds, where that is, speeds without an answer
!> best_um, best_factor, best_rpm: its least; NaN where no relief has an answer
!> within_um              the best lies within so much of the true optimum
subroutine gs_optimum(text, nwork, work, threads, room, tried, relief_um, worst_factor, rpm, failed, &
                      best_um, best_factor, best_rpm, within_um, info, message)
  use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
  use gearsweep_border, only: begin_call, in_um, need_room, open_case, run_case, tell
  use gearsweep_case, only: case_t
  use gearsweep_error, only: error_t
  use gearsweep_optimum, only: most_tried
  use gearsweep_study, only: study_t
  implicit none
  character(*), intent(in) :: text
  integer, intent(in) :: nwork, threads, room
  double precision, intent(in) :: work(*)
  integer, intent(inout) :: tried, failed(room)
  double precision, intent(inout), dimension(room) :: relief_um, worst_factor, rpm
  double precision, intent(inout) :: best_um, best_factor, best_rpm, within_um
  integer, intent(out) :: info
  character(*), intent(out) :: message
  type(case_t) :: case
  type(study_t) :: study
  type(error_t), allocatable :: error

  call begin_call()
  call open_case(text, 'optimum', threads, case, error)
  call need_room('room', room, most_tried, error)
  call run_case(case, nwork, work, threads, study, error)
  if (.not. allocated(error)) then
    associate (optimum => study%optimum)
      tried = size(optimum%amount)
      relief_um(:tried) = in_um(optimum%amount)
      worst_factor(:tried) = optimum%dynamic_factor
      rpm(:tried) = optimum%rpm
      failed(:tried) = optimum%failed
      within_um = 1d6*optimum%resolution
      best_um = ieee_value(best_um, ieee_quiet_nan)
      best_factor = best_um
      best_rpm = best_um
      if (optimum%best > 0) then
        best_um = relief_um(optimum%best)
        best_factor = worst_factor(optimum%best)
        best_rpm = rpm(optimum%best)
      end if
    end associate
  end if
  call tell(error, info, message, study)
end subroutine gs_optimum
