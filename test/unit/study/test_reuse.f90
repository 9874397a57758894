!> A run from an earlier study takes over what that has of the same inputs, and nothing else. That all it gives is the same
!> bits, for every key, is told by the suite `inputs`.
module test_reuse
  use gearsweep_study_case_case, only: case_t
  use gearsweep_api_case_reader, only: read_case
  use gearsweep_study_reader_edit, only: change_key
  use gearsweep_base_error, only: error_t
  use gearsweep_study_run_study, only: run_study, study_t
  use test_support_testing, only: check_no_error, check_true, tally_t
  implicit none
  private
  public :: run

  character(*), parameter :: pair = '&pair module_mm = 3 face_width_mm = 20 / '// &
    '&pinion teeth = 21 effective_mass_kg = 0.5 / &gear teeth = 34 effective_mass_kg = 0.9 / '// &
    '&load normal_force_n = 4000 / &relief amount_um = 0, 10 / &section elements_across = 4 / '
  character(*), parameter :: text = '&case tasks = ''mesh'', ''load'', ''sweep'', ''static'', ''modal'' / '// &
    pair//'&mesh model = ''fe'' / &static positions = 5 / &modal modes = 3 / '// &
    '&sweep rpm_first = 3000 rpm_last = 6000 rpm_step = 1000 load_rpm = 4000 /    '

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('taken_over')) call taken_over(t)
  end subroutine run

  !> The log says what is taken over; all else is made anew.
  subroutine taken_over(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: n = 40
    character(n), parameter :: fe = 'stiffness by model fe, taken over', modes = 'modes, taken over', &
      shared = 'transmission error, taken over', swept = 'operating points, taken over', root = 'of the load, taken over', &
      followed = 'over the path, taken over', factored = 'factored', teeth = 'the teeth taken over', &
      tooth = 'one gear''s teeth taken over'
    type(study_t) :: study
    type(case_t) :: case
    type(error_t), allocatable :: error

    call read_case(text, case, error)
    call run_study(case, '', 1, study, error)
    call check_no_error(t, 'the earlier study', error)
    call try('case', 'title', '''again''', [fe, modes, shared, swept, root, followed], [factored])
    call try('relief', 'amount_um', '0, 10, 20', [fe, modes, root], [shared, swept, factored])
    call try('sweep', 'rpm_step', '500', [fe, modes, shared, root, followed], [swept])
    call try('dynamics', 'damping_ratio', '0.12', [fe, modes, root], [swept, followed])
    call try('pinion', 'effective_mass_kg', '0.6', [fe, modes, root], [swept, followed])
    call try('static', 'positions', '6', [fe, modes, swept], [root])
    call try('modal', 'modes', '4', [fe, root, swept], [modes])
    call try('section', 'elements_across', '5', [character(n) ::], [fe, teeth, modes, root, swept])
    call try('load', 'normal_force_n', '4001', [teeth, modes, root], [fe, shared, swept])
    ! What a tooth does not know: its width, the masses at the bores, densities and how it is measured.
    call try('pair', 'face_width_mm', '21', [teeth], [fe, swept])
    call try('gear', 'hub_inertia_kgm2', '1e-4', [teeth], [fe, swept])
    call try('gear', 'pin_diameter_mm', '6', [teeth], [fe])
    ! What it does: its own body, the part of its flank that touches, the grid.
    call try('gear', 'bore_mm', '20', [tooth], [fe, teeth])
    call try('pair', 'centre_distance_mm', '82.6', [character(n) ::], [fe, teeth, tooth])
    call try('mesh', 'tooth_coupling', '.false.', [character(n) ::], [fe, teeth, tooth])
    call try('material', 'young_gpa', '200', [character(n) ::], [fe, teeth, tooth])

  contains

    subroutine try(group, key, value, taken, made)
      character(*), intent(in) :: group, key, value, taken(:), made(:)
      character(:), allocatable :: changed
      type(study_t) :: later
      integer :: i

      call change_key(text, group, key, value, changed, error)
      call read_case(changed, case, error)
      if (.not. allocated(error)) call run_study(case, '', 1, later, error, earlier=study)
      call check_no_error(t, 'from an earlier study: &'//group//' '//key, error)
      call check_true(t, 'from an earlier study: &'//group//' '//key, &
                      all([(index(later%log, trim(taken(i))) > 0, i=1, size(taken))]) .and. &
                      .not. any([(index(later%log, trim(made(i))) > 0, i=1, size(made))]), later%log)
    end subroutine try
  end subroutine taken_over
end module test_reuse
