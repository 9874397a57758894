! The flat layer: external subroutines for Fortran 77 and whatever can call it.
!
! text            the case, as the program reads it; groups may follow each other on one line.
!                 Files that it names lie relative to the current folder.
! nwork, work     the pair stiffness from gs_prepare, for cases with the same gears, material,
!                 section and load; nwork = 0: each call finds it itself (work is not touched).
! threads         of the sweep; 0: all. The answer is the same for any number.
! info, message   0 and blank; else a code of gearsweep_error: 1 case or argument unusable (an
!                 array too small: the message says the size), 3 file, 4 some operating points have
!                 no answer (NaN; all else is filled), 5 a method failed, 6 memory. But for 4, the
!                 results are as they were. A message that is too long is cut.
!
! A call runs one task, which the case must name among its tasks. Arrays belong to the caller; they
! may be larger than gs_sizes says, and what lies beyond is not touched. Units are those of the case
! and the tables. Nothing prints, stops or keeps state: any number of callers at once. While a call
! computes, OpenBLAS is kept to one thread; the number before comes back when the last call ends.
! gearsweep_calls has the interfaces for modern Fortran.

!> Version of the library, as 0.1.0.
subroutine gs_version(version, info, message)
  use gearsweep_border, only: need_room, tell
  use gearsweep_error, only: error_t
  use gearsweep_version, only: this => version
  implicit none
  character(*), intent(out) :: version
  integer, intent(out) :: info
  character(*), intent(out) :: message
  type(error_t), allocatable :: error

  version = this
  call need_room('len(version)', len(version), len(this), error)
  call tell(error, info, message)
end subroutine gs_version

!> Sizes of the results, 0 for tasks that the case does not name. No finite elements run.
!>
!> speeds, reliefs  of the sweep                rows       of gs_mesh, over all reliefs
!> tried            most reliefs of gs_optimum  positions  of the load, gs_root
!> modes            of gs_modes                 nwork      of gs_prepare
subroutine gs_sizes(text, speeds, reliefs, rows, tried, positions, modes, nwork, info, message)
  use gearsweep_border, only: measure, open_case, tell, work_size
  use gearsweep_case, only: case_t, list_speeds => speeds
  use gearsweep_error, only: error_t
  use gearsweep_optimum, only: most_tried
  use gearsweep_root_rating, only: load_positions
  use gearsweep_study, only: study_t
  implicit none
  character(*), intent(in) :: text
  integer, intent(inout) :: speeds, reliefs, rows, tried, positions, modes, nwork
  integer, intent(out) :: info
  character(*), intent(out) :: message
  type(case_t) :: case
  type(study_t) :: study
  type(error_t), allocatable :: error
  integer :: i

  call open_case(text, 'all', 1, case, error)
  call measure(case, study, error)
  if (.not. allocated(error)) then
    speeds = 0
    rows = 0
    positions = 0
    if (case%asks('sweep') .or. case%asks('optimum')) speeds = size(list_speeds(case))
    reliefs = size(case%amount)
    tried = merge(most_tried, 0, case%asks('optimum'))
    if (case%asks('mesh')) rows = sum([(sum(study%sharing(i)%pairs), i=1, reliefs)])
    if (case%asks('static')) positions = size(load_positions(study%pair, case%root))
    modes = merge(case%modes, 0, case%asks('modal'))
    nwork = work_size(study)
  end if
  call tell(error, info, message)
end subroutine gs_sizes

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
  use gearsweep_border, only: open_case, run_case, tell
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

!> The pair stiffness, by finite elements where the case says so: the costly part of a mesh, kept in
!> work(nwork) for the calls below. It holds for cases that differ in reliefs, speeds, masses,
!> damping, friction, backlash or tasks.
subroutine gs_prepare(text, nwork, work, info, message)
  use gearsweep_border, only: open_case, pack_stiffness, run_case, tell
  use gearsweep_case, only: case_t
  use gearsweep_error, only: error_t
  use gearsweep_study, only: study_t
  implicit none
  character(*), intent(in) :: text
  integer, intent(in) :: nwork
  double precision, intent(inout) :: work(*)
  integer, intent(out) :: info
  character(*), intent(out) :: message
  type(case_t) :: case
  type(study_t) :: study
  type(error_t), allocatable :: error

  call open_case(text, 'motion', 1, case, error)
  call run_case(case, 0, work, 1, study, error)
  if (.not. allocated(error)) call pack_stiffness(study, nwork, work, error)
  call tell(error, info, message)
end subroutine gs_prepare

!> What drives the motion.
!>
!> load_n        static load on the line of action      mass_kg(2)    effective masses on it
!> stiffness_n_um mean mesh stiffness, whole width      frequency_hz  natural frequency
subroutine gs_motion(text, nwork, work, load_n, mass_kg, stiffness_n_um, frequency_hz, info, message)
  use gearsweep_border, only: open_case, run_case, tell
  use gearsweep_case, only: case_t
  use gearsweep_error, only: error_t
  use gearsweep_kinds, only: pi
  use gearsweep_study, only: study_t
  implicit none
  character(*), intent(in) :: text
  integer, intent(in) :: nwork
  double precision, intent(in) :: work(*)
  double precision, intent(inout) :: load_n, mass_kg(2), stiffness_n_um, frequency_hz
  integer, intent(out) :: info
  character(*), intent(out) :: message
  type(case_t) :: case
  type(study_t) :: study
  type(error_t), allocatable :: error

  call open_case(text, 'motion', 1, case, error)
  call run_case(case, nwork, work, 1, study, error)
  if (.not. allocated(error)) then
    load_n = study%load
    mass_kg = study%mass
    stiffness_n_um = study%mesh%mean_stiffness()/1d6
    frequency_hz = study%motion(1)%natural_frequency/(2*pi)
  end if
  call tell(error, info, message)
end subroutine gs_motion

!> One pair along the path of contact, static: task mesh. Rows as in the table of that name, reliefs
!> after each other, s ascending; where a pair enters or a relief begins, both sides have a row.
!>
!> relief_um(rows)  s(rows) base pitches from A    pair_n_um(rows)  stiffness of this pair
!> mesh_n_um(rows)  stiffness of all pairs that carry             error_um(rows)  profile error
!> share(rows)      of the static load             ste_um(rows)     static transmission error
subroutine gs_mesh(text, nwork, work, rows, relief_um, s, pair_n_um, mesh_n_um, error_um, share, ste_um, &
                   info, message)
  use gearsweep_border, only: need_room, open_case, run_case, tell
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

  call open_case(text, 'mesh', 1, case, error)
  call run_case(case, nwork, work, 1, study, error)
  if (.not. allocated(error)) call need_room('rows', rows, &
    sum([(sum(study%sharing(i)%pairs), i=1, size(study%sharing))]), error)
  if (.not. allocated(error)) then
    row = 0
    do i = 1, size(study%sharing)
      associate (sharing => study%sharing(i), mesh => study%motion(i)%mesh)
        do j = 1, maxval(sharing%pairs)
          do k = 1, size(sharing%phase)
            if (sharing%pairs(k) < j) cycle
            row = row + 1
            relief_um(row) = 1d6*study%case%amount(i)
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

!> Dynamic factor over speed and relief: task sweep.
!>
!> rpm(speeds)                      of the pinion, ascending
!> relief_um(reliefs)               as in the case
!> dynamic_factor(speeds, reliefs)  NaN without an answer
!> estimate(speeds, reliefs)        of its error
!> status(speeds, reliefs)          0 ok, 1 marginal, 2 subharmonic, 3 inexact; without an answer:
!>                                  4 unstable, 5 aperiodic, 6 unresolved, 7 chatter, 8 chaotic
!> contact(speeds, reliefs)         0 full, 1 partial, 2 lost, 3 coast sides touched
subroutine gs_sweep(text, nwork, work, threads, speeds, reliefs, rpm, relief_um, dynamic_factor, estimate, &
                    status, contact, info, message)
  use gearsweep_border, only: need_room, open_case, run_case, tell
  use gearsweep_case, only: case_t, list_speeds => speeds
  use gearsweep_error, only: error_t
  use gearsweep_study, only: study_t
  implicit none
  character(*), intent(in) :: text
  integer, intent(in) :: nwork, threads, speeds, reliefs
  double precision, intent(in) :: work(*)
  double precision, intent(inout) :: rpm(speeds), relief_um(reliefs)
  double precision, intent(inout), dimension(speeds, reliefs) :: dynamic_factor, estimate
  integer, intent(inout), dimension(speeds, reliefs) :: status, contact
  integer, intent(out) :: info
  character(*), intent(out) :: message
  type(case_t) :: case
  type(study_t) :: study
  type(error_t), allocatable :: error
  integer :: n, m

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
    relief_um(:m) = 1d6*study%case%amount
    dynamic_factor(:n, :m) = study%sweep%dynamic_factor
    estimate(:n, :m) = study%sweep%estimate
    status(:n, :m) = study%sweep%status
    contact(:n, :m) = study%sweep%contact
  end if
  call tell(error, info, message, study)
end subroutine gs_sweep

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
  use gearsweep_border, only: need_room, open_case, run_case, tell
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

  call open_case(text, 'optimum', threads, case, error)
  call need_room('room', room, most_tried, error)
  call run_case(case, nwork, work, threads, study, error)
  if (.not. allocated(error)) then
    associate (optimum => study%optimum)
      tried = size(optimum%amount)
      relief_um(:tried) = 1d6*optimum%amount
      worst_factor(:tried) = optimum%dynamic_factor
      rpm(:tried) = optimum%rpm
      failed(:tried) = optimum%failed
      within_um = 1d6*optimum%resolution
      best_um = ieee_value(best_um, ieee_quiet_nan)
      best_factor = best_um
      best_rpm = 0
      if (optimum%best > 0) then
        best_um = relief_um(optimum%best)
        best_factor = worst_factor(optimum%best)
        best_rpm = rpm(optimum%best)
      end if
    end associate
  end if
  call tell(error, info, message, study)
end subroutine gs_optimum

!> Resonances of one curve of gs_sweep; runs nothing. At most five.
!>
!> rpm(speeds), dynamic_factor(speeds)  the curve; NaN where there is no answer
!> found                                how many stand out
!> peak_rpm(5), peak_factor(5)          speed and dynamic factor of each, by speed
subroutine gs_resonances(speeds, rpm, dynamic_factor, found, peak_rpm, peak_factor, info, message)
  use gearsweep_border, only: need_room, tell
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

  call need_room('speeds', speeds, 1, error)
  if (.not. allocated(error)) then
    peaks = find_resonances(rpm, dynamic_factor)
    found = size(peaks)
    peak_rpm(:found) = peaks%rpm
    peak_factor(:found) = peaks%dynamic_factor
  end if
  call tell(error, info, message)
end subroutine gs_resonances

!> Dynamic load of one pair along its path at the speeds load_rpm: task load. Rows as in the table.
!>
!> rows  that there are; also where room is too small (given: room)
!> relief_um(room)  rpm(room)  s(room) base pitches from A  pair_load_n(room)  dte_um(room) dynamic
!> transmission error
subroutine gs_load(text, nwork, work, room, rows, relief_um, rpm, s, pair_load_n, dte_um, info, message)
  use gearsweep_border, only: need_room, open_case, run_case, tell
  use gearsweep_case, only: case_t
  use gearsweep_error, only: error_t
  use gearsweep_study, only: study_t
  implicit none
  character(*), intent(in) :: text
  integer, intent(in) :: nwork, room
  double precision, intent(in) :: work(*)
  integer, intent(inout) :: rows
  double precision, intent(inout), dimension(room) :: relief_um, rpm, s, pair_load_n, dte_um
  integer, intent(out) :: info
  character(*), intent(out) :: message
  type(case_t) :: case
  type(study_t) :: study
  type(error_t), allocatable :: error
  integer :: i, k, from, until

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
          relief_um(from:until) = 1d6*study%case%amount(i)
          rpm(from:until) = response%rpm
          s(from:until) = response%s
          pair_load_n(from:until) = response%load
          dte_um(from:until) = 1d6*response%error
        end associate
      end do
    end do
  end if
  call tell(error, info, message, study)
end subroutine gs_load

!> Natural frequencies of the section, ascending: task modal.
!>
!> frequency_hz(modes)  estimate(modes) relative error  residual(modes) of the eigenvalue problem
!> rim_share(modes)     share of the rim in the kinetic energy
subroutine gs_modes(text, modes, frequency_hz, estimate, residual, rim_share, info, message)
  use gearsweep_border, only: need_room, open_case, run_case, tell
  use gearsweep_case, only: case_t
  use gearsweep_error, only: error_t
  use gearsweep_study, only: study_t
  implicit none
  character(*), intent(in) :: text
  integer, intent(in) :: modes
  double precision, intent(inout), dimension(modes) :: frequency_hz, estimate, residual, rim_share
  integer, intent(out) :: info
  character(*), intent(out) :: message
  double precision, parameter :: none(1) = 0
  type(case_t) :: case
  type(study_t) :: study
  type(error_t), allocatable :: error
  integer :: n

  call open_case(text, 'modal', 1, case, error)
  call need_room('modes', modes, case%modes, error)
  call run_case(case, 0, none, 1, study, error)
  if (.not. allocated(error)) then
    associate (found => study%modal%modes)
      n = size(found%frequency)
      frequency_hz(:n) = found%frequency
      estimate(:n) = study%modal%error_estimate
      residual(:n) = found%residual
      rim_share(:n) = found%participation(0, :)
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
  use gearsweep_border, only: measure, need_room, open_case, run_case, tell
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

  call open_case(text, 'static', 1, case, error)
  call measure(case, study, error)
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
        relief_um(i) = 1d6*case%amount(i)
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

!> The whole answer as text, lines ended by char(10), as the program prints it: all tasks.
!>
!> length  of the answer; also where `answer` is too short for it (then info is 1 and `answer` as it
!>         was)
subroutine gs_report(text, nwork, work, threads, answer, length, info, message)
  use gearsweep_border, only: need_room, open_case, run_case, tell
  use gearsweep_case, only: case_t
  use gearsweep_error, only: error_t
  use gearsweep_report, only: report
  use gearsweep_study, only: study_t
  implicit none
  character(*), intent(in) :: text
  integer, intent(in) :: nwork, threads
  double precision, intent(in) :: work(*)
  character(*), intent(inout) :: answer
  integer, intent(inout) :: length
  integer, intent(out) :: info
  character(*), intent(out) :: message
  type(case_t) :: case
  type(study_t) :: study
  type(error_t), allocatable :: error
  character(:), allocatable :: words

  call open_case(text, 'all', threads, case, error)
  call run_case(case, nwork, work, threads, study, error)
  if (.not. allocated(error)) then
    ! Its texts have lengths that gfortran keeps in static memory; see gearsweep_text.
    !$omp critical (gearsweep_texts)
    words = report(study)
    !$omp end critical (gearsweep_texts)
    length = len(words)
    call need_room('len(answer)', len(answer), length, error)
    if (.not. allocated(error)) answer = words
  end if
  call tell(error, info, message, study)
end subroutine gs_report
