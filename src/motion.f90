!> The equation of motion of a gear pair: steady motions, sweeps over speed and relief, response, optimum.
!>
!> Other rooms use this module, and none of the room's own modules.
module gearsweep_motion
  ! All attracting motions of operating points, and the largest of them in a sweep.
  use gearsweep_motion_attractors, only: all_motions_t, attractor_options_t, attractor_t, attractors_t, count_motions, &
    find_attractors, largest_motion, largest_reached, search_motions, start_states
  ! Coefficients of the equation of motion over one mesh period, step by step.
  use gearsweep_motion_coefficients, only: coefficients_t
  ! Method and fineness of the steps of a mesh period.
  use gearsweep_motion_resolution, only: resolution_t, scheme_collocation, scheme_constant, scheme_rk4, scheme_rk4_equal
  ! Contact sets, and the result of one mesh period of the motion with the mean square and range of its transmission error.
  use gearsweep_motion_contact_set, only: dte_t, join, period_t, range_of, rms_of
  ! Steady motions followed up and down over the speed, slowly or at a finite rate.
  use gearsweep_motion_continuation, only: branch_options_t, branch_t, change_t, follow_branch, follow_ramp, level_t, &
    periods_of_ramp, ramp_options_t, ramp_t
  ! Error estimate of an operating point from the solution with half the steps, and the number of steps that a tolerance needs.
  use gearsweep_motion_error_estimate, only: levels_t
  ! One step of x" + damping x' + omega_squared x = forcing by collocation at three Gauss or three Radau points.
  use gearsweep_motion_gauss, only: batch_size
  ! Design of least noise or load over several numbers of a case at once, and over several loads.
  use gearsweep_motion_joint_optimum, only: design_t, find_joint_optimum, joint_optimum_t, starts_t, sweep_design
  ! Periodic motions known at one speed.
  use gearsweep_motion_known_motions, only: known_t
  ! Torque of the mesh on pinion and gear, over the time after which a motion repeats.
  use gearsweep_motion_mesh_torque, only: find_torque, mesh_torque_t
  ! Operating points to a tolerance.
  use gearsweep_motion_operating_point, only: solve_point
  ! Resonances, worst dynamic factor over the speeds, and the amount of relief that minimises it.
  use gearsweep_motion_optimum, only: find_optimum, find_resonances, most_tried, optimum_t, peak_t, worst_of
  ! Equation of motion of the gear pair along the line of action.
  use gearsweep_motion_oscillator, only: damping, frequency_ratio, make_oscillator, mesh_period, oscillator_t
  ! One mesh period of the motion, for a batch of speeds with contact sets of their own.
  use gearsweep_motion_period, only: run_full_contact, run_period
  ! The map of the state over one mesh period, for a batch of speeds.
  use gearsweep_motion_period_map, only: discretise, period_map_t, set_durations
  ! A periodic motion.
  use gearsweep_motion_periodic_orbit, only: distance, largest_multiplier, near, newton_step, shoot
  ! The Poincare section of the motion.
  use gearsweep_motion_poincare, only: sample_section, section_points_t
  ! Steps of a mesh period for a batch of gears in quick turns.
  use gearsweep_motion_quick_steps, only: quick_motion_t
  ! Quick turns.
  use gearsweep_motion_quick_turn, only: run_quickly
  ! Response of a steady motion in addition to its dynamic factor.
  use gearsweep_motion_response, only: find_corner_estimate, find_response, find_turn, length_of, response_t, trace_motion, turn_t
  ! A periodic quantity with one quintic a step.
  use gearsweep_motion_spectrum, only: find_spectrum, spectrum_t
  ! Operating point.
  use gearsweep_motion_steady_motion, only: accuracy_t, by_marching, by_shooting, has_result, point_t, status_chaotic, &
    status_chatter, status_inexact, status_meaning, status_name, status_ok, status_stopped, status_unbounded, status_unresolved, &
    steady_choice_t, steady_t, step_choice_t
  ! Many operating points.
  use gearsweep_motion_sweep, only: all_motions, both, contact_lost, contact_name, contact_of, counter_t, down, each, most_points, &
    progress_of_sweep, run_sweep, sweep_options_t, sweep_t, untold, up
  ! Record of a motion over one mesh period, and the overlaps of its contacts.
  use gearsweep_motion_trace, only: overlap_t, overlaps_t, trace_t
  implicit none
  public
end module gearsweep_motion
