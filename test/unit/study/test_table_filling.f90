!> What the tasks do with a right figure: signs, which of two extremes and when, plane strain, shares of an estimate, words, the
!> end of a range. Tables are filled from figures set by hand, and small cases are held against what follows from their own columns.
module test_table_filling
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_study_case_case, only: case_t
  use gearsweep_api_case_reader, only: read_case
  use gearsweep_motion_response, only: find_corner_estimate, motion_summary_t, summarise
  use gearsweep_elastic_corner_stiffness, only: edge_zone
  use gearsweep_motion_continuation, only: branch_t, change_t, level_t
  use gearsweep_base_table, only: axis, no_number, table_t, write_csv
  use gearsweep_base_lines, only: lines_t
  use gearsweep_base_error, only: error_t
  use gearsweep_motion_error_estimate, only: point_t
  use gearsweep_gear_gear, only: drive
  use gearsweep_study_tasks_harmonic, only: fill_resonances, fill_response, steady_load_t
  use gearsweep_nonlinear_task_hysteresis, only: fill_delays, fill_ramps, ramps_t
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_rating_flank, only: root_face_load_factor
  use gearsweep_elastic_material, only: material_t
  use gearsweep_motion_mesh_torque, only: find_torque, mesh_torque_t
  use gearsweep_elastic_modal_response, only: motion_record_t
  use gearsweep_motion_oscillator, only: make_oscillator, oscillator_t
  use gearsweep_study_tasks_optimum, only: fill_best, fill_curve
  use gearsweep_gear_pair, only: pair_t
  use gearsweep_study_tasks_relief_judge, only: amount_curve_t, errors_t, judge_t
  use gearsweep_study_run_study, only: run_study, study_t
  use gearsweep_api_tables, only: column_of, make_table
  use gearsweep_base_text, only: str
  use gearsweep_elastic_tooth_modes, only: along, moved_x, moved_y, per_point, tooth_modes_t
  use gearsweep_study_tasks_load, only: fill_torque, fill_torque_harmonics, fill_torque_points, torque_run_t
  use gearsweep_motion_trace, only: record, trace_t
  use gearsweep_study_tasks_transient, only: fill_histories, fill_peaks, fill_points, tooth_run_t
  use test_support_gears, only: dogan_pair
  use test_support_solve_one_point, only: solve_motion => solve
  use test_support_testing, only: check_close, check_equal, check_no_error, check_true, tally_t
  implicit none
  private
  public :: run

  real(dp), parameter :: mega = 1e6_dp, degree = pi/180

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('steady_load')) call steady_load(t)
    if (t%wants('passing_load')) call passing_load(t)
    if (t%wants('plane_strain')) call plane_strain(t)
    if (t%wants('place_of_compression')) call place_of_compression(t)
    if (t%wants('friction_at_rest')) call friction_at_rest(t)
    if (t%wants('phases_of_torque')) call phases_of_torque(t)
    if (t%wants('torques_of_forces')) call torques_of_forces(t)
    if (t%wants('growing_load')) call growing_load(t)
    if (t%wants('outer_single_contact')) call outer_single_contact(t)
    if (t%wants('late_jumps')) call late_jumps(t)
    if (t%wants('best_amount')) call best_amount(t)
    if (t%wants('load_factors')) call load_factors(t)
    if (t%wants('chamfered_tip')) call chamfered_tip(t)
    if (t%wants('edge_zone')) call edges(t)
    if (t%wants('softer_corners')) call softer_corners(t)
    if (t%wants('webs')) call webs(t)
    if (t%wants('each_relief')) call each_relief(t)
    if (t%wants('case_in_table')) call case_in_table(t)
    if (t%wants('table_on_screen')) call table_on_screen(t)
  end subroutine run

  ! --- tables filled by hand -------------------------------------------------------

  !> One mode w, zeta at a point of the drive fillet and one of the coast fillet; `part`: of the stress that the coarser of two
  !> grids sees.
  type(tooth_modes_t) function one_mode(w, zeta, part) result(tooth)
    real(dp), intent(in) :: w, zeta, part
    integer :: k

    allocate (tooth%side(1)%along(0), tooth%side(2)%along(0))
    tooth%direction = reshape([0.6_dp, 0.8_dp, -0.8_dp, 0.6_dp], [2, 2])
    tooth%model%frequency = [w]
    tooth%model%damping = [2*zeta*w]
    allocate (tooth%model%shape(2*per_point, 1), tooth%model%force(1, 1), tooth%model%static(2*per_point, 1))
    do k = 0, 1
      tooth%model%shape(per_point*k + [along, moved_x, moved_y], 1) = [(1 - 3*k)*part, -2.0_dp, 0.5_dp]
    end do
    tooth%model%force = 3
    tooth%model%static = tooth%model%shape*3/w**2
  end function one_mode

  !> One mode in closed form (Clough and Penzien 1993, section 3.2): in phase at rest, a quarter behind at the natural frequency,
  !> nearly half behind far above; a displacement against the load is ahead by half. The coarser grid sees 0.9 of the stress: the
  !> estimate is a tenth, times the share.
  subroutine steady_load(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: w = 7, zeta = 0.02_dp, ratio(4) = [0.0_dp, 1.0_dp, 2.0_dp, 30.0_dp], share = 0.25_dp
    type(steady_load_t) :: load
    type(tooth_modes_t) :: tooth(2)
    type(table_t) :: table
    type(error_t), allocatable :: error
    real(dp) :: size_of, behind
    integer :: k

    tooth = [one_mode(w, zeta, 1.0_dp), one_mode(w, zeta, 0.9_dp)]
    load = steady_load_t(5.0_dp, s=[0.4_dp], tangent=[pi/6], modulus=2e11_dp, error_share=share)
    call fill_response(load, tooth, ratio*w, table, error)
    call check_no_error(t, 'the table of responses', error)
    do k = 1, size(ratio)
      associate (r => ratio(k))
        size_of = 3*5/w**2/sqrt((1 - r**2)**2 + (2*zeta*r)**2)
        behind = atan2(2*zeta*r, 1 - r**2)/degree
      end associate
      call check_close(t, 'stress', table%number('stress_mpa', k), size_of/mega, 1e-9_dp)
      call check_close(t, 'its phase', table%number('stress_phase_deg', k), -behind, absolute=1e-9_dp)
      call check_close(t, 'phase of a displacement against the load', table%number('phase_x_deg', k), 180 - behind, &
                       absolute=1e-9_dp)
      call check_close(t, 'phase of a displacement along the tooth', table%number('phase_y_deg', k), -behind, absolute=1e-9_dp)
      call check_close(t, 'displacement across the tooth', table%number('displacement_x_um', k), 2*mega*size_of, 1e-9_dp)
      call check_close(t, 'strain', table%number('strain_um_m', k), mega*size_of/2e11_dp, 1e-9_dp)
      call check_close(t, 'estimate: a tenth times the share', table%number('error_estimate', k), 0.1_dp*share, 1e-9_dp)
      call check_close(t, 'the coast side sees twice the stress', table%number('stress_mpa', 4 + k), 2*size_of/mega, 1e-9_dp)
    end do
    table = table_t()
    call fill_resonances(load, tooth, [0.03_dp], table, error)
    call check_no_error(t, 'the table of resonances', error)
    call check_close(t, 'peak', table%number('peak_frequency_hz', 1), w*sqrt(1 - 2*zeta**2)/(2*pi), 1e-7_dp)
    call check_close(t, 'amplification', table%number('amplification', 2), 1/(2*zeta*sqrt(1 - zeta**2)), 1e-9_dp)
    call check_close(t, 'damping ratio', table%number('damping_ratio', 1), zeta, 1e-14_dp)
    call check_close(t, 'error of the natural frequency', table%number('frequency_error', 1), 0.03_dp, 0.0_dp)
    call check_close(t, 'estimate of the peak', table%number('error_estimate', 1), 0.1_dp*share, 1e-9_dp)
  end subroutine steady_load

  !> A passage that begins at 2 ms: the drive fillet sees 9 Pa after 1 ms and -4 after 3, the coast fillet 3 and -8.
  subroutine passing_load(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: tangent(1) = [pi/6], poisson = 0.3_dp, high(2) = [9.0_dp, 3.0_dp], low(2) = [-4.0_dp, -8.0_dp]
    type(tooth_run_t) :: one(1)
    type(tooth_modes_t) :: tooth
    type(table_t) :: points, times, peaks
    type(error_t), allocatable :: error
    real(dp) :: of_mises, value(2*per_point, 0:4)
    integer :: k

    tooth = one_mode(1.0_dp, 0.1_dp, 1.0_dp)
    value = 0
    value([1, 4], 1) = high
    value([1, 4], 3) = low
    value(moved_x, 2) = -7
    associate (run => one(1)%tooth)
      run%record = motion_record_t(time=2e-3_dp + 1e-3_dp*[(k, k=0, 4)], value=value, static=value/2, highest=maxval(value, 2), &
        lowest=minval(value, 2), time_highest=spread(3e-3_dp, 1, 6), time_lowest=spread(5e-3_dp, 1, 6), &
        static_highest=maxval(value, 2)/2, static_lowest=minval(value, 2)/2)
      run%s = [(0.1_dp*k, k=0, 4)]
      run%load = spread(10.0_dp, 1, 5)
      run%point_error = [0.01_dp, 0.02_dp]
      run%peaks%tension%stress = 9
      run%peaks%tension%tangent = 0.3_dp
      run%peaks%compression%stress = -8
      run%peaks%compression%tangent = 0.4_dp
      run%static%tension%stress = 6
      run%static%compression%stress = -2
    end associate
    call fill_points(one, tooth, tangent, 1, poisson, points, error)
    call fill_histories(one, tooth, tangent, poisson, times, error)
    call fill_peaks(one, 1, poisson, peaks, error)
    call check_no_error(t, 'tables of a passage', error)
    do k = 1, 2
      call check_close(t, 'highest', mega*points%number('highest_mpa', k), high(k))
      call check_close(t, 'and when', points%number('highest_ms', k), 1.0_dp)
      call check_close(t, 'lowest', mega*points%number('lowest_mpa', k), low(k))
      call check_close(t, 'and when it is', points%number('lowest_ms', k), 3.0_dp)
    end do
    ! Uniaxial, and nu times as much across the plane: sigma^2 (1 - nu + nu^2).
    of_mises = sqrt(1 - poisson + poisson**2)
    call check_close(t, 'the larger in size', mega*points%number('sigma_mpa', 2), -8.0_dp)
    call check_close(t, 'the larger in size at rest', mega*points%number('static_mpa', 2), -4.0_dp)
    call check_close(t, 'von Mises', mega*points%number('mises_mpa', 2), 8*of_mises)
    call check_close(t, 'component across the tooth', mega*points%number('sigma_x_mpa', 1), 9*0.36_dp)
    call check_close(t, 'component along the tooth', mega*points%number('sigma_y_mpa', 1), 9*0.64_dp)
    call check_close(t, 'shear on the drive side', mega*points%number('tau_xy_mpa', 1), 9*0.48_dp)
    call check_close(t, 'shear on the coast side', mega*points%number('tau_xy_mpa', 2), -8*(-0.48_dp))
    call check_close(t, 'displacement, the larger in size', points%number('displacement_x_um', 1)/mega, -7.0_dp)
    call check_close(t, 'estimate of a point', points%number('error_estimate', 2), 0.02_dp)
    call check_close(t, 'von Mises over time', mega*times%number('mises_mpa', 4), 4*of_mises)
    call check_close(t, 'time since the load met the tooth', times%number('time_ms', 4), 3.0_dp)
    call check_close(t, 'the coast side over time', mega*times%number('sigma_mpa', 9), -8.0_dp)
    call check_close(t, 'largest von Mises of the fillets', mega*peaks%number('mises_mpa', 1), 9*of_mises)
    call check_close(t, 'where compression is', peaks%number('compression_deg', 1), 0.4_dp/degree)
    call check_close(t, 'tension over that at rest', peaks%number('tension_ratio', 1), 1.5_dp)
    call check_close(t, 'compression over that at rest', peaks%number('compression_ratio', 1), 4.0_dp)
  end subroutine passing_load

  !> Friction on a step in which the pair's load is a parabola and the lever arm grows in proportion to the path, so that what it
  !> adds is a cubic, whose mean over the period, and least and largest at rest, are known. F_i = F + mu rho_i/r_bi (recess).
  subroutine friction_at_rest(t)
    type(tally_t), intent(inout) :: t
    type(oscillator_t) :: osc
    type(trace_t) :: trace(1)
    type(mesh_torque_t) :: torque
    real(dp), parameter :: load(0:2) = [1000.0_dp, 600.0_dp, -900.0_dp], friction = 0.1_dp
    real(dp) :: ends(0:2, 1, 2), x(0:2, 2), arm(0:1), mean
    integer :: gear

    osc%mass = [0.8_dp, 1.1_dp]
    osc%load = 1000
    osc%friction = friction
    osc%pairs = 1
    osc%contacts = 1
    osc%highest_frequency = 1
    osc%mesh%teeth = [25, 34]
    osc%mesh%contact_ratio = 1.5_dp
    osc%mesh%pitch_point = -1
    osc%mesh%tan_angle = tan(20*degree)
    ends(:, 1, 1) = [load(0), load(1), 2*load(2)]
    ends(:, 1, 2) = [sum(load), load(1) + 2*load(2), 2*load(2)]
    x = 0
    call record(trace(1), 1, [0, 0], [0.0_dp, 1.0_dp], [1, 1], x, ends)
    call find_torque(osc, 1.0_dp, trace, 1, torque)
    do gear = 1, 2
      arm = friction*[osc%mesh%curvature_ratio(gear, 0.0_dp), &
                      osc%mesh%curvature_ratio(gear, 1.0_dp) - osc%mesh%curvature_ratio(gear, 0.0_dp)]
      call check_true(t, 'the arm changes over the path', abs(arm(1)) > 0)
      mean = load(0)*arm(0) + (load(1)*arm(0) + load(0)*arm(1))/2 + (load(2)*arm(0) + load(1)*arm(1))/3 + load(2)*arm(1)/4
      call check_close(t, 'mean of what friction adds', torque%mean_friction(gear), mean, 1e-12_dp)
    end do
  end subroutine friction_at_rest

  !> Harmonics of 30, 20 and 0.001 N with an error of 0.01 N: the last has no phase. In half the steps the second is 1 N off and the
  !> mean 0.5 N: so much is the error more, times the base radius.
  subroutine phases_of_torque(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: radius(2) = [0.03_dp, 0.05_dp], open = 0.01_dp
    type(torque_run_t) :: one(1)
    type(table_t) :: table
    type(error_t), allocatable :: error
    integer :: i

    one%rpm = 3000
    one%period = 1e-3_dp
    one%other_error = open
    one(1)%mesh%tau = [0.0_dp, 1.0_dp]
    do i = 1, 2
      one(1)%mesh%force(i)%mean = 1000
      one(1)%mesh%force(i)%amplitude = [30.0_dp, 20.0_dp, 1e-3_dp]
      one(1)%mesh%force(i)%phase = [1.0_dp, -2.0_dp, 3.0_dp]
      one(1)%half(i) = one(1)%mesh%force(i)
      one(1)%half(i)%mean = 1000.5_dp
      one(1)%half(i)%amplitude(2) = 21
    end do
    call fill_torque_harmonics(one, radius, table, error)
    call check_no_error(t, 'harmonics of a torque', error)
    call check_close(t, 'error of the mean', table%number('gear_error_nm', 1), radius(2)*(0.5_dp + open), 1e-12_dp)
    call check_close(t, 'error of a harmonic', table%number('pinion_error_nm', 3), radius(1)*(1 + open), 1e-12_dp)
    call check_close(t, 'a harmonic', table%number('gear_amplitude_nm', 2), 30*radius(2), 1e-12_dp)
    call check_close(t, 'its phase', table%number('gear_phase_deg', 2), 1/degree, 1e-12_dp)
    call check_close(t, 'its frequency', table%number('frequency_hz', 3), 2000.0_dp, 1e-12_dp)
    call check_true(t, 'no phase of what is below its error', ieee_is_nan(table%number('pinion_phase_deg', 4)))
  end subroutine phases_of_torque

  !> Each gear feels elastic load, damping and its own friction at its own base radius, the damping of the table at the pinion's. Of
  !> mean, least and largest force the mean differs most between the steps, by 2 N: three times that and what is left open, 0.3 N.
  subroutine torques_of_forces(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: radius(2) = [0.03_dp, 0.05_dp], open = 0.3_dp
    type(torque_run_t) :: one(1)
    type(table_t) :: times, points
    type(error_t), allocatable :: error
    character(:), allocatable :: name
    integer :: i

    one%rpm = 3000
    one%period = 1e-3_dp
    one%other_error = open
    associate (mesh => one(1)%mesh, half => one(1)%half)
      mesh%tau = [0.0_dp, 1.0_dp]
      mesh%error = [3e-6_dp, 4e-6_dp]
      mesh%elastic = [900.0_dp, 1100.0_dp]
      mesh%damping = [70.0_dp, -50.0_dp]
      mesh%friction = reshape([8.0_dp, -9.0_dp, 5.0_dp, -6.0_dp], [2, 2])
      mesh%mean_friction = [6.5_dp, -7.5_dp]
      do i = 1, 2
        mesh%force(i)%mean = 1000 - 20*(i - 1)
        mesh%force(i)%least = 850
        mesh%force(i)%largest = 1200
        half(i)%mean = mesh%force(i)%mean - 2
        half(i)%least = 851
        half(i)%largest = 1200.5_dp
      end do
    end associate
    call fill_torque(one, radius, times, error)
    call fill_torque_points(one, 1, radius, points, error)
    call check_no_error(t, 'tables of a torque', error)
    call check_close(t, 'torque of the pinion', times%number('pinion_torque_nm', 1), 0.03_dp*978)
    call check_close(t, 'torque of the gear', times%number('gear_torque_nm', 2), 0.05_dp*1044)
    call check_close(t, 'friction on the pinion', times%number('pinion_friction_nm', 2), 0.03_dp*5)
    call check_close(t, 'friction on the gear', times%number('gear_friction_nm', 1), -0.05_dp*9)
    call check_close(t, 'damping, at the pinion', times%number('pinion_damping_nm', 1), 0.03_dp*70)
    do i = 1, 2
      name = trim(merge('pinion', 'gear  ', i == 1))
      call check_close(t, 'mean torque, '//name, points%number(name//'_mean_nm', 1), radius(i)*(1020 - 20*i))
      call check_close(t, 'least torque, '//name, points%number(name//'_least_nm', 1), radius(i)*850)
      call check_close(t, 'largest torque, '//name, points%number(name//'_largest_nm', 1), radius(i)*1200)
      call check_close(t, 'error of a torque, '//name, points%number(name//'_error_nm', 1), radius(i)*(3*2 + open))
      call check_close(t, 'mean friction, '//name, points%number(name//'_friction_mean_nm', 1), radius(i)*(20.5_dp - 14*i))
    end do
    call check_close(t, 'of the power that goes in friction takes', points%number('friction_loss', 1), 0.02_dp)
  end subroutine torques_of_forces

  !> A load that grows over one step from nothing has 1/sqrt(3) of its last value as root mean square, 1/2 as mean.
  subroutine growing_load(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: last = 900
    type(oscillator_t) :: osc
    type(trace_t) :: trace(1)
    type(motion_summary_t) :: summary
    real(dp) :: ends(0:2, 1, 2), x(0:2, 2)

    osc%pairs = 1
    osc%contacts = 1
    x = 0
    ends(:, 1, 1) = [0.0_dp, last, 0.0_dp]
    ends(:, 1, 2) = [last, last, 0.0_dp]
    call record(trace(1), 1, [0, 0], [0.0_dp, 1.0_dp], [1, 1], x, ends)
    call summarise(osc, trace, 1, summary)
    call check_close(t, 'mean of a load that grows', summary%load%mean, last/2)
    call check_close(t, 'root mean square on a pair', summary%pair_rms, last/sqrt(3.0_dp))
  end subroutine growing_load

  !> Runs up and down at 50 rpm a second that jump 20 and 10 rpm behind slow ones: later in either direction, by 0.4 and 0.2 s. With
  !> twice the steps 1 rpm earlier, that is by 0.02 s, and a mesh period of 60/(25 n) s is what the time is a multiple of.
  subroutine late_jumps(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: rate = 50, behind(2) = [20.0_dp, -10.0_dp], rpm(2) = [1000.0_dp, 1100.0_dp]
    type(branch_t) :: branch(2, 1)
    type(ramps_t) :: ramps(2, 1)
    type(table_t) :: delays, runs
    type(error_t), allocatable :: error
    integer :: way

    do way = 1, 2
      ! Of two changes of the slow run, the second is the jump that the run at a finite rate is compared with.
      branch(way, 1)%change = [change_t(rpm=1020 + [-0.1_dp, 0.0_dp]), change_t(rpm=1050 + [-0.1_dp, 0.0_dp])]
      associate (ramp => ramps(way, 1))
        ramp%teeth = 25
        ramp%level = [level_t(1050.0_dp, 1.5_dp, .true.)]
        ramp%change = [2]
        ramp%fine%passed = [1050 + behind(way)]
        ramp%coarse%passed = [1050 + behind(way) - sign(1.0_dp, behind(way))]
        ramp%fine%factor = [1.0_dp, 1.25_dp] + way
        ramp%coarse%factor = [1.5_dp, 1.125_dp] + way
      end associate
    end do
    call fill_delays([0.0_dp], branch, ramps, rate, delays, error)
    call fill_ramps(rpm, [0.0_dp], ramps, runs, error)
    call check_no_error(t, 'tables of the ramps', error)
    do way = 1, 2
      call check_close(t, 'which change it is', delays%number('change', way), 2.0_dp)
      call check_close(t, 'just after the slow run''s jump', delays%number('rpm', way), 1050.0_dp)
      call check_close(t, 'where the run jumps', delays%number('ramp_rpm', way), 1050 + behind(way))
      call check_close(t, 'later, whichever way', delays%number('delay_s', way), abs(behind(way))/rate)
      call check_close(t, 'error of that', delays%number('error_estimate_s', way), 1/rate + 60/(25*(1050 + behind(way))))
    end do
    call check_close(t, 'DF of the run up', runs%number('dynamic_factor', 2), 2.25_dp)
    call check_close(t, 'DF of the run down at its last speed', runs%number('dynamic_factor', 3), 3.25_dp)
    call check_close(t, 'its error', runs%number('error_estimate', 3), 0.125_dp)
    call check_close(t, 'and at its first speed', runs%number('error_estimate', 4), 0.5_dp)
  end subroutine late_jumps

  !> Of three amounts of relief under two torques: the best one's speeds without an answer are those under both torques, and its
  !> speed and its torque are where the larger of its two values is. The others have other numbers.
  subroutine best_amount(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: torque(2) = [50.0_dp, 100.0_dp], speed(3) = [2000.0_dp, 3000.0_dp, 5000.0_dp], &
                           failed(3) = [12.0_dp, 3.0_dp, 24.0_dp]
    type(amount_curve_t) :: curve
    type(judge_t) :: judge
    type(table_t) :: best, all_amounts, none
    type(error_t), allocatable :: error
    integer :: i

    curve%amount = [0.0_dp, 1e-6_dp, 2e-6_dp]
    curve%of_load = reshape([1.5_dp, 1.75_dp, 1.25_dp, 1.125_dp, 1.5_dp, 1.25_dp], [2, 3])
    curve%rpm = reshape([1000.0_dp, 2000.0_dp, 3000.0_dp, 4000.0_dp, 5000.0_dp, 6000.0_dp], [2, 3])
    curve%failed = reshape([7, 5, 2, 1, 11, 13], [2, 3])
    curve%value = [1.75_dp, 1.25_dp, 1.5_dp]
    curve%is_bound = [.false., .false., .true.]
    curve%errors = [(errors_t([1e-6_dp, 2e-6_dp]*i, [3e-6_dp, 2e-6_dp]*i), i=1, 3)]
    curve%best = 2
    call fill_best(judge, torque, curve, 1.375_dp, best, error)
    call fill_curve(judge, curve, all_amounts, error)
    call check_no_error(t, 'tables of the best amount', error)
    call check_close(t, 'best amount', best%number('relief_um', 1), 1.0_dp)
    call check_close(t, 'its worst DF', best%number('worst_dynamic_factor', 1), 1.25_dp)
    call check_close(t, 'speed of that', best%number('rpm', 1), 3000.0_dp)
    call check_close(t, 'torque of that', best%number('torque_nm', 1), 50.0_dp)
    call check_close(t, 'its speeds without an answer', best%number('points_without_answer', 1), 3.0_dp)
    call check_close(t, 'larger error', best%number('ste_peak_to_peak_um', 1), 4.0_dp)
    call check_close(t, 'larger harmonic', best%number('mesh_harmonic_um', 1), 6.0_dp)
    do i = 1, 3
      call check_close(t, 'speed of each amount', all_amounts%number('rpm', i), speed(i))
      call check_close(t, 'of each without an answer', all_amounts%number('points_without_answer', i), failed(i))
      call check_close(t, 'tried at some speeds only', all_amounts%number('at_least', i), merge(1.0_dp, 0.0_dp, i == 3))
    end do
    curve%best = 0
    call fill_best(judge, torque, curve, 1.375_dp, none, error)
    call check_close(t, 'without a best one, those of all', none%number('points_without_answer', 1), 39.0_dp)
  end subroutine best_amount

  ! --- small cases and calls -------------------------------------------------------

  subroutine solve(t, text, study)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: text
    type(study_t), intent(out) :: study
    type(case_t) :: case
    type(error_t), allocatable :: error

    call read_case(text, case, error)
    if (.not. allocated(error)) call run_study(case, '', 1, study, error)
    call check_no_error(t, 'a study', error)
  end subroutine solve

  !> In plane strain E/(1 - nu^2) takes the place of E, and nu sigma acts across the plane. Looked at in the rows of the table
  !> alone, its least value and when it is are those of the points. A driving pinion is loaded from its root to its tip, so that s
  !> grows, and the gear from its tip to its root, where s grows too.
  subroutine plane_strain(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: begin = '&pair module_mm = 3 face_width_mm = 20 / &pinion teeth = 21 / &gear teeth = 34 / '// &
      '&load normal_force_n = 4000 / &mesh model = ''iso6336'' / &material young_gpa = 200 poisson = 0.25 / '
    character(6), parameter :: gear(2) = [character(6) :: 'pinion', 'gear']
    character(8), parameter :: travel(3) = [character(8) :: 'driving', 'outwards', 'inwards']
    real(dp), parameter :: poisson = 0.25_dp
    type(study_t) :: study
    type(table_t) :: points
    type(error_t), allocatable :: error
    real(dp), allocatable :: stress(:), strain(:), mises(:), time(:), s(:)
    integer :: i, k, n

    do k = 1, size(travel)
      do i = 1, 2
        call solve(t, begin//'&case tasks = ''harmonic'', ''transient'' / &section teeth = 1 elements_across = 3 plane = '// &
                   '''strain'' gear = '''//trim(gear(i))//''' / &harmonic modes = 2 frequency_hz = 0, 2000 / &transient '// &
                   'rpm = 9000 modes = 2 sharing = ''equal'' positions = 4 time_step_s = 2e-6 travel = '''//trim(travel(k))// &
                   ''' /', study)
        s = column_of(study, 'transient', 's')
        call check_true(t, 'the load of the '//trim(gear(i))//' travels: '//travel(k), &
                        (s(2) > s(1)) .eqv. (k == 1 .or. (k == 2 .eqv. i == 1)))
      end do
    end do
    stress = column_of(study, 'harmonic', 'stress_mpa')
    strain = column_of(study, 'harmonic', 'strain_um_m')
    call check_close(t, 'strain over stress', maxval(abs(strain*0.2_dp/(stress*(1 - poisson**2)) - 1)), 0.0_dp, absolute=1e-12_dp)
    stress = column_of(study, 'transient', 'sigma_mpa')
    mises = column_of(study, 'transient', 'mises_mpa')
    time = column_of(study, 'transient', 'time_ms')
    call check_close(t, 'von Mises over the stress along the surface', maxval(abs(mises - abs(stress)*sqrt(1 - poisson &
                     + poisson**2))), 0.0_dp, absolute=1e-12_dp*maxval(abs(stress)))
    call make_table(study, 'transient_points', points, error)
    n = size(stress)/2
    do i = 1, 2
      associate (one => stress(n*(i - 1) + 1:n*i))
        call check_close(t, 'the least', points%number('lowest_mpa', i), minval(one), 1e-12_dp)
        call check_close(t, 'when it is', points%number('lowest_ms', i), time(minloc(one, 1)), absolute=1e-9_dp)
        call check_close(t, 'the largest', points%number('highest_mpa', i), maxval(one), 1e-12_dp)
        call check_close(t, 'when that is', points%number('highest_ms', i), time(maxloc(one, 1)), absolute=1e-9_dp)
      end associate
    end do
  end subroutine plane_strain

  !> Where the table of the largest stresses says that compression is largest, a look at that angle finds it, on the coast side; and
  !> tension at its angle, on the drive side.
  subroutine place_of_compression(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: begin = '&case tasks = ''static'' / &pair module_mm = 3 face_width_mm = 20 '// &
      'coast_angle_deg = 30 / &pinion teeth = 21 rack_tip_radius = 0.1 / &gear teeth = 34 rack_tip_radius = 0.1 / '// &
      '&load normal_force_n = 4000 / &mesh model = ''iso6336'' / '// &
      '&section teeth = 1 elements_across = 4 / &static positions = 5 sharing = ''equal'''
    character(11), parameter :: which(2) = [character(11) :: 'tension', 'compression']
    type(study_t) :: study, there
    type(table_t) :: largest, looks
    type(error_t), allocatable :: error
    real(dp), allocatable :: stress(:)
    real(dp) :: angle(2)
    integer :: i

    call solve(t, begin//' /', study)
    call make_table(study, 'root_stress', largest, error)
    do i = 1, 2
      angle(i) = largest%number(trim(which(i))//'_deg', 1)
      call solve(t, begin//' tangent_deg = '//str(angle(i), 12)//' /', there)
      stress = column_of(there, 'static', 'sigma_mpa')
      call make_table(there, 'static', looks, error)
      call check_close(t, 'the largest '//which(i), merge(maxval(stress), minval(stress), i == 1), &
                       largest%number(trim(which(i))//'_mpa', 1), 1e-3_dp)
      call check_equal(t, 'on which side', trim(looks%word('side', merge(maxloc(stress, 1), minloc(stress, 1), i == 1))), &
                       trim(merge('drive', 'coast', i == 1)))
    end do
    call check_true(t, 'at different angles', abs(angle(2) - angle(1)) > 3)
  end subroutine place_of_compression

  !> K_F_beta = K_H_beta**(1/(1 + h/b + (h/b)^2)) (ISO 6336-1:2006, clause 7), h of the standard rack 2.25 modules; h/b no more
  !> than a third.
  subroutine load_factors(t)
    type(tally_t), intent(inout) :: t
    type(pair_t) :: pair
    real(dp) :: slender

    pair = dogan_pair([25, 31])
    slender = 2.25_dp*3.18_dp/25.4_dp
    call check_close(t, 'K_F_beta', root_face_load_factor(pair, 1.4_dp), 1.4_dp**(1/(1 + slender + slender**2)), 1e-12_dp)
    pair%gear%spec%face_width = 0.01_dp
    call check_close(t, 'K_F_beta of a narrow gear', root_face_load_factor(pair, 1.4_dp), 1.4_dp**(9/13.0_dp), 1e-12_dp)
  end subroutine load_factors

  !> The whole amount of relief is at the end of the involute, the tip form circle, of a chamfered tip too, by either measure; none
  !> where it begins.
  subroutine chamfered_tip(t)
    type(tally_t), intent(inout) :: t
    type(study_t) :: study
    type(table_t) :: flank, methods, gears
    type(error_t), allocatable :: error
    character(:), allocatable :: relief
    real(dp) :: amount
    integer :: i, k, gear

    call solve(t, '&case tasks = ''deflection_relief'', ''geometry'' / &pair module_mm = 3 face_width_mm = 20 / '// &
               '&pinion teeth = 21 tip_chamfer_mm = 0.3 effective_mass_kg = 0.5 / '// &
               '&gear teeth = 34 tip_chamfer_mm = 0.2 effective_mass_kg = 0.7 / &load normal_force_n = 4000 / '// &
               '&mesh model = ''iso6336'' / &sweep rpm_first = 5000 rpm_last = 6000 '// &
               'rpm_step = 500 / &relief amount_um = 0, 10 /', study)
    call make_table(study, 'relief_flank', flank, error)
    call make_table(study, 'deflection_relief', methods, error)
    call make_table(study, 'gears', gears, error)
    call check_no_error(t, 'tables of the relief', error)
    call check_equal(t, 'ten places for each gear and method', flank%rows, 20*methods%rows)
    do i = 1, methods%rows
      do gear = 1, 2
        k = 20*(i - 1) + 10*gear
        relief = trim(merge('pinion', 'gear  ', gear == 1))
        amount = methods%number(relief//'_relief_um', i)
        call check_true(t, 'whose place it is', flank%word('gear', k) == relief .and. &
                        flank%word('method', k) == methods%word('method', i))
        call check_close(t, 'the last place', flank%number('diameter_mm', k), gears%number('tip_form_diameter_mm', gear), &
                         1e-12_dp)
        call check_close(t, 'relief at the end of the involute', flank%number('relief_um', k), amount, absolute=1e-9_dp)
        call check_close(t, 'the same by diameter', flank%number('relief_by_diameter_um', k), amount, absolute=1e-9_dp)
        call check_close(t, 'relief where it begins', flank%number('relief_um', k - 9), 0.0_dp, absolute=1e-9_dp)
      end do
    end do
    call check_true(t, 'there is relief, and a chamfer', amount > 1 .and. &
                    gears%number('tip_form_diameter_mm', 1) < gears%number('tip_diameter_mm', 1) - 0.1_dp)
  end subroutine chamfered_tip

  !> The outer point of single contact is D of the pinion and B of the gear, as the table of contact points has them.
  subroutine outer_single_contact(t)
    type(tally_t), intent(inout) :: t
    type(study_t) :: study
    real(dp), allocatable :: loaded(:), pinion(:), gear(:)

    call solve(t, '&case tasks = ''deflection_relief'', ''geometry'' / &pair module_mm = 3 face_width_mm = 20 / '// &
               '&pinion teeth = 21 effective_mass_kg = 0.5 / &gear teeth = 34 effective_mass_kg = 0.7 / '// &
               '&load normal_force_n = 4000 / &mesh model = ''iso6336'' / &sweep rpm_first = 5000 rpm_last = 6000 '// &
               'rpm_step = 500 / &relief amount_um = 0, 10 / &deflection_relief point = ''hpstc'' /', study)
    loaded = column_of(study, 'relief_deflection', 'load_diameter_mm')
    pinion = column_of(study, 'contact_points', 'pinion_radius_mm')
    gear = column_of(study, 'contact_points', 'gear_radius_mm')
    call check_close(t, 'D of the pinion', loaded(1), 2*pinion(4), 1e-12_dp)
    call check_close(t, 'B of the gear', loaded(2), 2*gear(2), 1e-12_dp)
    call check_true(t, 'beyond the pitch point', loaded(1) > 2*pinion(3) .and. loaded(2) > 2*gear(3))
  end subroutine outer_single_contact

  !> The zone of the edge is the arc of 1.4 half widths of Hertz's contact, an involute's arc being rho^2/(2 r_b): in proportion to
  !> the root of the load where it is small, and an eighth of the path at most.
  subroutine edges(t)
    type(tally_t), intent(inout) :: t
    type(material_t), parameter :: steel(2) = material_t(2.1e11_dp, 0.3_dp, 7800.0_dp)
    type(pair_t) :: pair
    real(dp) :: zone(2), other(2), tip, arc(2)
    integer :: i

    pair = dogan_pair([25, 31])
    zone = edge_zone(pair, steel, .true., 2e5_dp)
    other = edge_zone(pair, steel, .true., 8e5_dp)
    do i = 1, 2
      tip = pair%curvature(3 - i, merge(0.0_dp, pair%contact_ratio, i == 1))
      arc = [tip**2 - (tip - pair%base_pitch*zone(i))**2, tip**2 - (tip - pair%base_pitch*other(i))**2] &
            /(2*pair%gear(3 - i)%base_radius(drive))
      call check_close(t, 'twice the arc for four times the load', arc(2), 2*arc(1), 1e-9_dp)
    end do
    zone = edge_zone(pair, steel, .true., 1e8_dp)
    call check_close(t, 'at A an eighth of the path at most', zone(1), pair%contact_ratio/8, 1e-15_dp)
    call check_close(t, 'at E an eighth of the path at most', zone(2), pair%contact_ratio/8, 1e-15_dp)
  end subroutine edges

  !> What is left open of tip corners is what a motion with a tenth less of their stiffness has for a dynamic factor, whichever way
  !> it lies.
  subroutine softer_corners(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: rpm(2) = [5000.0_dp, 7000.0_dp]
    type(study_t) :: study
    type(oscillator_t) :: motion
    type(point_t) :: usual, softer
    type(error_t), allocatable :: error
    real(dp) :: estimate
    integer :: i

    call solve(t, '&case tasks = ''sweep'' / &pair module_mm = 3 face_width_mm = 20 / '// &
               '&pinion teeth = 21 effective_mass_kg = 0.5 / &gear teeth = 34 effective_mass_kg = 0.7 / '// &
               '&load normal_force_n = 4000 / &mesh model = ''weber'' nonlinear_contact = .false. / '// &
               '&sweep rpm_first = 5000 rpm_last = 5500 rpm_step = 500 / &relief amount_um = 0 /', study)
    motion = study%motion(1)
    associate (stiffness => motion%mesh%stiffness)
      do i = 1, size(stiffness%breaks) - 1
        if (stiffness%breaks(i + 1) <= 1e-9_dp .or. stiffness%breaks(i) >= motion%mesh%contact_ratio - 1e-9_dp) &
          stiffness%coef(:, i) = 0.9_dp*stiffness%coef(:, i)
      end do
    end associate
    call make_oscillator(motion, error)
    call check_no_error(t, 'softer corners', error)
    do i = 1, size(rpm)
      call solve_motion(study%motion(1), rpm(i), study%case%accuracy, usual)
      call solve_motion(motion, rpm(i), study%case%accuracy, softer)
      call find_corner_estimate(study%motion(1), rpm(i), study%case%accuracy, estimate)
      call check_true(t, 'it matters at '//str(rpm(i)), abs(softer%dynamic_factor - usual%dynamic_factor) > 1e-4_dp)
      call check_close(t, 'left open of corners at '//str(rpm(i)), estimate, abs(softer%dynamic_factor - usual%dynamic_factor), &
                       absolute=2*(usual%estimate + softer%estimate))
    end do
  end subroutine softer_corners

  !> Of two webs the one that takes more counts: C_R = 1 + ln(b_s/b)/(5 exp(s_R/(5 m))) (ISO 6336-1:2006, 9.3.1.3), whichever gear
  !> has it.
  subroutine webs(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: keys(2) = [character(50) :: 'web_thickness_mm = 10 rim_thickness_mm = 9', &
                                          'web_thickness_mm = 6 rim_thickness_mm = 6']
    type(study_t) :: study
    real(dp), allocatable :: factor(:)
    integer :: i

    do i = 1, 2
      call solve(t, '&case tasks = ''mesh'' / &pair module_mm = 3 face_width_mm = 20 / &load normal_force_n = 4000 / '// &
                 '&mesh model = ''iso6336'' / &pinion teeth = 31 effective_mass_kg = 0.5 '//trim(keys(i))// &
                 ' / &gear teeth = 34 effective_mass_kg = 0.9 '//trim(keys(3 - i))//' /', study)
      factor = column_of(study, 'motion', 'iso_blank_factor')
      call check_close(t, 'C_R of the thinner web', factor(1), 1 + log(0.3_dp)/(5*exp(0.4_dp)), 1e-12_dp)
    end do
  end subroutine webs

  !> Above a contact ratio of two relief decides how much of the load a pair has at rest, and in a fine accuracy grade K_v by Method
  !> B: each relief has its own. What the grade allows is that of the larger gear, f_pb = (0.3 (m + 0.4 sqrt(d)) + 4) cos(alpha) in
  !> grade 5 (ISO 1328-1:1995).
  subroutine each_relief(t)
    type(tally_t), intent(inout) :: t
    type(study_t) :: study
    real(dp), allocatable :: share(:), rated(:), factor(:), deviation(:)

    call solve(t, '&case tasks = ''mesh'', ''rating'' / &pair module_mm = 3 face_width_mm = 20 / '// &
               '&pinion teeth = 40 addendum = 1.35 dedendum = 1.5 effective_mass_kg = 0.5 / '// &
               '&gear teeth = 60 addendum = 1.35 dedendum = 1.5 effective_mass_kg = 0.9 / '// &
               '&load normal_force_n = 6000 / &relief amount_um = 0, 20 / &mesh model = ''weber'' corner_contact = .false. / '// &
               '&rating rpm = 3000 accuracy_grade = 5 running_in = 0 /', study)
    share = column_of(study, 'transmission_error', 'largest_load_share')
    rated = column_of(study, 'dynamic_factors', 'static_share')
    factor = column_of(study, 'dynamic_factors', 'dynamic_factor_b')
    deviation = column_of(study, 'rating_factors', 'pitch_deviation_um')
    call check_true(t, 'relief changes the largest share', abs(share(2) - share(1)) > 0.01_dp)
    call check_close(t, 'share at rest of each relief', maxval(abs(rated - share)), 0.0_dp, absolute=1e-3_dp)
    call check_true(t, 'relief counts in K_v by Method B', abs(factor(2) - factor(1)) > 1e-3_dp)
    call check_close(t, 'f_pb of the larger gear', deviation(1), (0.3_dp*(3 + 0.4_dp*sqrt(180.0_dp)) + 4)*cos(20*degree), 1e-9_dp)
  end subroutine each_relief

  !> A table has the whole case, with the end of a last line that no new line follows.
  subroutine case_in_table(t)
    type(tally_t), intent(inout) :: t
    type(table_t) :: table
    type(error_t), allocatable :: error
    character(:), allocatable :: text

    call table%begin('a table', 1, error)
    call table%add('x', 'um', 'a number', [0.5_dp])
    call write_csv(table, '&case title = ''two'' /'//new_line('a')//'&load torque_nm = 3 /', text, error)
    call check_no_error(t, 'the text of a table', error)
    call check_true(t, 'the case in a table', index(text, new_line('a')//'#   &case title = ''two'' /'//new_line('a')// &
                    '#   &load torque_nm = 3 /'//new_line('a')//'x'//new_line('a')) > 0, text)
  end subroutine case_in_table

  !> Names in up to two lines with their units; columns without a number are omitted, and rows beyond sixty.
  subroutine table_on_screen(t)
    type(tally_t), intent(inout) :: t
    type(table_t) :: table
    type(lines_t) :: screen
    type(error_t), allocatable :: error
    character(:), allocatable :: text
    character, parameter :: nl = new_line('a')
    real(dp) :: none(62)
    integer :: i

    table%name = 'some'
    call table%over('rows', error, axis('relief_um', 'um', 'amount', [(1e-6_dp*i, i=1, 62)]))
    call check_no_error(t, 'table for the screen', error)
    none = no_number()
    call table%add('dynamic_factor', '', 'DF', [1.25_dp, none(2:)])
    call table%add('error_estimate', '', 'of DF', [1.234e-7_dp, none(2:)])
    call table%add('torque_nm', 'N m', 'torque', [123456.7_dp, 0.1234567_dp, none(3:)])
    call table%add('seen_factor', '', 'nowhere', none)
    call table%add('teeth', '', 'number', [(1000000 + i, i=1, 62)])
    call table%add_words('status', 'word', [('ok', i=1, 62)])
    call table%show(screen, 'relief_um status dynamic_factor error_estimate lacking seen_factor torque_nm teeth')
    text = screen%text()
    call check_true(t, 'head and rows of a table on the screen', index(text, &
      '                        dynamic      error'//nl// &
      '   relief um   status    factor   estimate   torque N m     teeth'//nl// &
      '           1   ok        1.2500     1.2e-7       123457   1000001'//nl// &
      '           2   ok             -          -      0.12346   1000002'//nl) == 1)
    call check_true(t, 'rows beyond sixty', index(text, nl//'          60   ok') > 0 .and. index(text, nl//'          61') == 0 &
                    .and. index(text, '   and 2 more in the table some'//nl) > 0)
  end subroutine table_on_screen
end module test_table_filling
