!> Which relief is best? The worst dynamic factor over the speeds, for each relief.
program first
  use gearsweep, only: case_t, error_t, make_table, read_case, run_study, study_t, table_t
  implicit none
  character(*), parameter :: text = "&case tasks = 'sweep' / &pair module_mm = 3 face_width_mm = 20 / &pinion teeth = 21 /"// &
    "&gear teeth = 34 / &load torque_nm = 100 / &relief amount_um = 0, 10, 20 /"// &
    "&sweep rpm_first = 1000 rpm_last = 15000 rpm_step = 500 /"
  type(case_t) :: case
  type(study_t) :: study
  type(table_t) :: worst
  type(error_t), allocatable :: error
  integer :: i

  call read_case(text, case, error)
  if (.not. allocated(error)) call run_study(case, '', 0, study, error)
  if (.not. allocated(error)) call make_table(study, 'sweep_worst', worst, error)
  if (allocated(error)) error stop error%message
  associate (relief => worst%columns(worst%position('relief_um'))%numbers, rpm => worst%columns(worst%position('rpm'))%numbers, &
             factor => worst%columns(worst%position('worst_dynamic_factor'))%numbers)
    print '(f5.1, a, f8.4, a, f8.1, a)', (relief(i), ' um: worst dynamic factor', factor(i), ' at', rpm(i), ' rpm', i=1, worst%rows)
  end associate
end program first
