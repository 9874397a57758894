!> Runs the test suites, or only those named as arguments: SUITE, or SUITE:TEST for its tests whose names contain TEST.
!> With `--short`, all but those that take long with run-time checks.
!> With `limits` alone, prints the table of test/properties/extreme/table.md instead; with `reference`, doc/case.md as
!> the keys are declared. Where the environment's GEARSWEEP_CHECKS names a file, each check
!> is added to it as a line `passed SUITE: NAME` or `failed SUITE: NAME`.
program check
  use, intrinsic :: iso_fortran_env, only: int64, output_unit
  use test_properties_extreme_table, only: print_limits
  use test_sparse, only: run_sparse => run
  use test_as_built, only: run_as_built => run
  use test_quick_turns, only: run_quick_turns => run
  use test_attractors, only: run_attractors => run
  use test_contact_beyond_path, only: run_contact_beyond_path => run
  use test_bifurcations, only: run_bifurcations => run
  use test_bracket, only: run_bracket => run
  use test_branches, only: run_branches => run
  use test_calls, only: run_calls => run
  use test_static_estimates, only: run_static_estimates => run
  use test_geometry_closed_forms, only: run_geometry_closed_forms => run
  use test_refusal_limits, only: run_refusal_limits => run
  use test_modes_closed_forms, only: run_modes_closed_forms => run
  use test_piecewise, only: run_piecewise => run
  use test_relief_closed_forms, only: run_relief_closed_forms => run
  use test_stiffness_closed_forms, only: run_stiffness_closed_forms => run
  use test_stress_closed_forms, only: run_stress_closed_forms => run
  use test_coast_flanks, only: run_coast_flanks => run
  use test_tip_corner, only: run_tip_corner => run
  use test_defaults_written_out, only: run_defaults_written_out => run
  use test_declarations, only: run_declarations => run, write_page
  use test_reuse, only: run_reuse => run
  use test_elastic_body, only: run_elastic_body => run
  use test_body_modes, only: run_body_modes => run
  use test_elastic_corner, only: run_elastic_corner => run
  use test_elastic_disc, only: run_elastic_disc => run
  use test_elastic_modes, only: run_elastic_modes => run
  use test_elastic_stiffness, only: run_elastic_stiffness => run
  use test_elastic_stress, only: run_elastic_stress => run
  use test_energy, only: run_energy => run
  use test_estimate_closed_forms, only: run_estimate_closed_forms => run
  use test_extremes, only: run_extremes => run
  use test_table_filling, only: run_table_filling => run
  use test_face_law, only: run_face_law => run
  use test_face_distribution, only: run_face_distribution => run
  use test_face_helical, only: run_face_helical => run
  use test_face_motion, only: run_face_motion => run
  use test_flank, only: run_flank => run
  use test_motion_selection, only: run_motion_selection => run
  use test_frequency_response, only: run_frequency_response => run
  use test_geometry, only: run_geometry => run
  use test_graded_steps, only: run_graded_steps => run
  use test_estimate_coverage, only: run_estimate_coverage => run
  use test_harmonics, only: run_harmonics => run
  use test_hub, only: run_hub => run
  use test_inputs, only: run_inputs => run
  use test_iso_rating, only: run_iso_rating => run
  use test_life, only: run_life => run
  use test_measures, only: run_measures => run
  use test_mesh, only: run_mesh => run
  use test_methods, only: run_methods => run
  use test_motion, only: run_motion => run
  use test_oscillator, only: run_oscillator => run
  use test_same_point_in_all_tasks, only: run_same_point_in_all_tasks => run
  use test_precision, only: run_precision => run
  use test_rating, only: run_rating => run
  use test_rating_methods, only: run_rating_methods => run
  use test_reader, only: run_reader => run
  use test_reliefs, only: run_reliefs => run
  use test_resonances, only: run_resonances => run
  use test_selective_evaluation, only: run_selective_evaluation => run
  use test_sensitivity, only: run_sensitivity => run
  use test_stability, only: run_stability => run
  use test_stopping, only: run_stopping => run
  use test_motion_summary, only: run_motion_summary => run
  use test_sweep, only: run_sweep => run
  use test_torques, only: run_torques => run
  use test_transient, only: run_transient => run
  use test_support_testing, only: suite_t, tally_t
  implicit none
  !> With run-time checks these take longer than all others together; `--short` leaves them out.
  character(*), parameter :: long(13) = [character(24) :: 'inputs', 'methods', 'bifurcations', 'elastic_modes', 'body_modes', &
                                         'elastic_corner', 'selective_evaluation', 'reliefs', 'transient', 'precision', &
                                         'same_point_in_all_tasks', 'attractors', 'as_built']
  integer :: passed = 0, failed = 0
  character(:), allocatable :: ignored

  if (command_argument_count() == 1 .and. is_asked(1, 'limits', ignored)) then
    call print_limits()
    stop
  end if
  if (command_argument_count() == 1 .and. is_asked(1, 'reference', ignored)) then
    call write_page()
    stop
  end if
  call run_wanted([ &
    & suite_t('reader', run_reader), &
    & suite_t('inputs', run_inputs), &
    & suite_t('declarations', run_declarations), &
    & suite_t('defaults_written_out', run_defaults_written_out), &
    & suite_t('geometry', run_geometry), &
    & suite_t('geometry_closed_forms', run_geometry_closed_forms), &
    & suite_t('measures', run_measures), &
    & suite_t('relief_closed_forms', run_relief_closed_forms), &
    & suite_t('tip_corner', run_tip_corner), &
    & suite_t('mesh', run_mesh), &
    & suite_t('stiffness_closed_forms', run_stiffness_closed_forms), &
    & suite_t('harmonics', run_harmonics), &
    & suite_t('contact_beyond_path', run_contact_beyond_path), &
    & suite_t('motion', run_motion), &
    & suite_t('motion_selection', run_motion_selection), &
    & suite_t('oscillator', run_oscillator), &
    & suite_t('graded_steps', run_graded_steps), &
    & suite_t('methods', run_methods), &
    & suite_t('sweep', run_sweep), &
    & suite_t('resonances', run_resonances), &
    & suite_t('same_point_in_all_tasks', run_same_point_in_all_tasks), &
    & suite_t('precision', run_precision), &
    & suite_t('reuse', run_reuse), &
    & suite_t('stopping', run_stopping), &
    & suite_t('stability', run_stability), &
    & suite_t('bracket', run_bracket), &
    & suite_t('branches', run_branches), &
    & suite_t('attractors', run_attractors), &
    & suite_t('as_built', run_as_built), &
    & suite_t('coast_flanks', run_coast_flanks), &
    & suite_t('quick_turns', run_quick_turns), &
    & suite_t('bifurcations', run_bifurcations), &
    & suite_t('sensitivity', run_sensitivity), &
    & suite_t('energy', run_energy), &
    & suite_t('reliefs', run_reliefs), &
    & suite_t('torques', run_torques), &
    & suite_t('motion_summary', run_motion_summary), &
    & suite_t('estimate_closed_forms', run_estimate_closed_forms), &
    & suite_t('extremes', run_extremes), &
    & suite_t('estimate_coverage', run_estimate_coverage), &
    & suite_t('face_law', run_face_law), &
    & suite_t('face_distribution', run_face_distribution), &
    & suite_t('face_helical', run_face_helical), &
    & suite_t('face_motion', run_face_motion), &
    & suite_t('rating', run_rating), &
    & suite_t('table_filling', run_table_filling), &
    & suite_t('flank', run_flank), &
    & suite_t('iso_rating', run_iso_rating), &
    & suite_t('rating_methods', run_rating_methods), &
    & suite_t('transient', run_transient), &
    & suite_t('frequency_response', run_frequency_response), &
    & suite_t('life', run_life), &
    & suite_t('stress_closed_forms', run_stress_closed_forms), &
    & suite_t('static_estimates', run_static_estimates), &
    & suite_t('refusal_limits', run_refusal_limits), &
    & suite_t('modes_closed_forms', run_modes_closed_forms), &
    & suite_t('piecewise', run_piecewise), &
    & suite_t('sparse', run_sparse), &
    & suite_t('elastic_body', run_elastic_body), &
    & suite_t('elastic_modes', run_elastic_modes), &
    & suite_t('elastic_stiffness', run_elastic_stiffness), &
    & suite_t('elastic_stress', run_elastic_stress), &
    & suite_t('elastic_disc', run_elastic_disc), &
    & suite_t('body_modes', run_body_modes), &
    & suite_t('elastic_corner', run_elastic_corner), &
    & suite_t('hub', run_hub), &
    & suite_t('selective_evaluation', run_selective_evaluation), &
    & suite_t('calls', run_calls)])
  print '(i0, a, i0, a)', passed, ' passed, ', failed, ' failed'
  if (failed > 0 .or. passed == 0) stop 1, quiet=.true.

contains

  subroutine run_wanted(suites)
    type(suite_t), intent(in) :: suites(:)
    character(:), allocatable :: test
    integer :: i, k

    do i = 1, size(suites)
      if (is_asked(1, '--short', test)) then
        if (all(long /= suites(i)%name)) call run_suite(suites(i), '')
        cycle
      end if
      do k = 0, command_argument_count()
        if (is_asked(k, suites(i)%name, test)) call run_suite(suites(i), test)
      end do
    end do
  end subroutine run_wanted

  !> `test` is part of the names of the tests to be run, empty for all.
  subroutine run_suite(suite, test)
    type(suite_t), intent(in) :: suite
    character(*), intent(in) :: test
    type(tally_t) :: one
    integer(int64) :: start, finish, rate

    print '(a)', trim(suite%name)//' ...'
    flush (output_unit)
    one%only = test
    call system_clock(start, rate)
    call suite%run(one)
    call system_clock(finish)
    print '(a, i6, a, i3, a, f8.2, a)', suite%name, one%passed(), ' passed, ', one%failed(), &
      & ' failed, ', real(finish - start)/real(rate), ' s'
    flush (output_unit)
    if (one%count == 0 .and. allocated(one%tests)) print '(a)', trim(suite%name)//' has no test of that name, but these:'//one%tests
    call list_checks(trim(suite%name), one)
    passed = passed + one%passed()
    failed = failed + one%failed()
  end subroutine run_suite

  subroutine list_checks(suite, one)
    character(*), intent(in) :: suite
    type(tally_t), intent(in) :: one
    character(1000) :: path
    integer :: i, unit

    call get_environment_variable('GEARSWEEP_CHECKS', path)
    if (path == '') return
    open (newunit=unit, file=trim(path), position='append', action='write')
    do i = 1, one%count
      write (unit, '(a)') merge('passed', 'failed', one%check(i)%passed)//' '//suite//': '//one%check(i)%name
    end do
    close (unit)
  end subroutine list_checks

  !> Whether argument k asks for the suite, and for which of its tests. Argument 0 stands for all suites where there is
  !> no other.
  logical function is_asked(k, suite, test)
    integer, intent(in) :: k
    character(*), intent(in) :: suite
    character(:), allocatable, intent(out) :: test
    character(200) :: argument
    integer :: colon

    test = ''
    is_asked = command_argument_count() == 0
    if (k == 0) return
    call get_command_argument(k, argument)
    colon = index(argument, ':')
    if (colon > 0) test = trim(argument(colon + 1:))
    if (colon > 0) argument = argument(:colon - 1)
    is_asked = argument == suite
  end function is_asked
end program check
