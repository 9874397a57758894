!> Tolerances by ISO 1328, tip relief from the deflection, a sweep and safety by ISO 6336: plain calls, without a case. SI units.
program plain
  use gearsweep_base, only: dp, error_t
  use gearsweep_elastic, only: contact_half_width, material_t
  use gearsweep_gear, only: drive, find_tolerances, gear_spec_t, gear_t, make_gear, make_pair, pair_t, profile_error, relief_t, &
    solid_inertia, tolerances_t
  use gearsweep_mesh, only: mesh_of, weber_stiffness
  use gearsweep_motion, only: make_oscillator, oscillator_t, run_sweep, sweep_options_t, sweep_t
  use gearsweep_rating, only: contact_stress, formula_deflection, formula_relief, load_factors_t, nominal_of, nominal_t, &
    tooth_root_stress
  implicit none
  integer, parameter :: teeth(2) = [21, 34]
  real(dp), parameter :: module = 3e-3_dp, width = 20e-3_dp, load = 3000, rpm(3) = [3000, 6000, 9000]
  type(material_t) :: steel(2)
  type(gear_t) :: gear(2)
  type(pair_t) :: pair
  type(tolerances_t) :: tolerances
  type(oscillator_t) :: motion
  type(sweep_t) :: sweep
  type(nominal_t) :: nominal
  type(error_t), allocatable :: error
  real(dp) :: s(2), half_width(2), relief(2), factor(3)
  integer :: i

  do i = 1, 2
    call make_gear(gear_spec_t(teeth=teeth(i), module=module, face_width=width), gear(i), error)
    if (allocated(error)) error stop error%message
  end do
  call make_pair(gear(1), gear(2), sum(teeth)*module/2, pair, error)
  if (.not. allocated(error)) call find_tolerances(6, teeth(1), 1e3_dp*module, 1e3_dp*width, tolerances, error)
  if (allocated(error)) error stop error%message
  print '(a, 3(1x, f0.1))', 'class 6, um: f_p, F_p and f_Halpha of the pinion', tolerances%single_pitch, &
    tolerances%cumulative_pitch, tolerances%profile_slope

  ! Each tooth bears the load at its tip: the pinion's at the end of the path of contact, the gear's at its start.
  s = [pair%contact_ratio, 0.0_dp]
  half_width = contact_half_width(steel(1), steel(2), .true., load/width, pair%curvature(1, s), pair%curvature(2, s))
  do i = 1, 2
    relief(i) = formula_relief(formula_deflection(gear(i), steel(i), load/width, half_width(i), pair%radius(i, s(i))), all=.false.)
  end do
  print '(a, 2(1x, f0.3))', 'relief by deflection, um: pinion and gear', 1e6_dp*relief

  ! Short relief, from the outer points of single contact to the tips.
  motion%mesh = mesh_of(pair)
  motion%mass = [(solid_inertia(gear(i), steel(i)%density)/gear(i)%base_radius(drive)**2, i=1, 2)]
  motion%load = load
  motion%damping_ratio = 0.1_dp
  call weber_stiffness(pair, steel, load/width, motion%mesh%stiffness, error)
  associate (ratio => pair%contact_ratio)
    if (.not. allocated(error)) call profile_error(relief_t(relief, [aint(ratio), ratio - aint(ratio)]), ratio, &
                                                   motion%mesh%profile_error, error)
  end associate
  if (.not. allocated(error)) call make_oscillator(motion, error)
  if (.not. allocated(error)) call run_sweep([motion], rpm, sweep_options_t(), sweep, error)
  if (allocated(error)) error stop error%message
  factor = sweep%dynamic_factor(:, 1)
  print '(a, 3(1x, f0.4))', 'dynamic factor at 3000, 6000 and 9000 1/min', factor

  nominal = nominal_of(pair, steel, load, rim_thickness=[0.0_dp, 0.0_dp], face_load=1.0_dp, grade=5)
  print '(a, 2(1x, f0.3))', 'S_H of pinion and gear for 1500 MPa at 9000 1/min', &
    1500e6_dp/contact_stress(nominal%contact, nominal%flank%single_pair, load_factors_t(), factor(3))
  print '(a, 2(1x, f0.3))', 'S_F for 900 MPa', &
    900e6_dp/tooth_root_stress(nominal%root, load_factors_t(), nominal%root_face_load, factor(3))
end program plain
