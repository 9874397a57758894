!> A problem of the benchmark: a prescribed mesh over speeds and reliefs, from
!> the text of a case.
module bench_problem
  use bench_tools, only: check
  use gearsweep, only: case_t, study_t, oscillator_t, error_t, read_case, run_study, dp
  use gearsweep_study_case_case, only: speeds
  use gearsweep_study_run_files, only: read_text
  implicit none
  private
  public :: problem_t, read_problem, write_problem

  type :: problem_t
    type(case_t) :: case
    type(oscillator_t), allocatable :: osc(:)    !< one for each relief
    real(dp), allocatable :: rpm(:)
  end type problem_t

contains

  !> Builds the oscillators and solves nothing.
  subroutine read_problem(path, problem, corners, coupling)
    character(*), intent(in) :: path
    type(problem_t), intent(out) :: problem
    !> In place of what the case says: contact beyond A and E; what neighbouring teeth share.
    logical, intent(in), optional :: corners, coupling
    type(study_t) :: study
    type(error_t), allocatable :: error
    character(:), allocatable :: text

    call read_text(path, text, error)
    call check(error)
    call read_case(text, problem%case, error)
    call check(error)
    if (present(corners)) problem%case%corner_contact = corners
    if (present(coupling)) problem%case%tooth_coupling = coupling
    problem%rpm = speeds(problem%case)
    call problem%case%request(['mesh'])
    call run_study(problem%case, '', 1, study, error)
    call check(error)
    problem%osc = study%motion
  end subroutine read_problem

  !> For the other contenders, in SI: teeth and contact ratio; masses, load and
  !> damping ratio; stiffness; reliefs, linear and alike for both gears from
  !> the HPSTC; speeds; for each relief and speed, x and dx/dt to start from, over
  !> the mean deflection and its product with the natural frequency (none: from
  !> rest). Each list follows its length. `osc` are alike but for the relief.
  subroutine write_problem(osc, rpm, start)
    type(oscillator_t), intent(in) :: osc(:)
    real(dp), intent(in) :: rpm(:)
    real(dp), intent(in), optional :: start(:, :)
    character(*), parameter :: numbers = '(*(es24.16e3, 1x))'
    real(dp) :: ends(2, size(osc))
    integer :: i

    do i = 1, size(osc)
      associate (mesh => osc(i)%mesh)
        ends(:, i) = [mesh%profile_error%value(0.0_dp), mesh%profile_error%value(mesh%contact_ratio)]
      end associate
    end do
    if (any(abs(ends(1, :) - ends(2, :)) > 1e-12_dp) .or. osc(1)%friction > 0 .or. osc(1)%has_backlash) &
      error stop 'the other contenders know neither friction nor backlash, and equal reliefs on both gears only'
    print numbers, real(osc(1)%mesh%teeth(1), dp), osc(1)%mesh%contact_ratio
    print numbers, osc(1)%mass, osc(1)%load, osc(1)%damping_ratio
    call write_list(osc(1)%mesh%stiffness%coef(:, 1))
    call write_list(ends(1, :))
    call write_list(rpm)
    if (present(start)) call write_list(reshape(start, [size(start)]))
    if (.not. present(start)) call write_list([real(dp) ::])

  contains

    subroutine write_list(values)
      real(dp), intent(in) :: values(:)

      print '(i0)', size(values)
      if (size(values) > 0) print numbers, values
    end subroutine write_list
  end subroutine write_problem
end module bench_problem
