!> The relief that is best over several torques, against searches of this suite's own: runs of the tasks `mesh` and `sweep` at each
!> torque by itself, with a list of reliefs.
module test_torques
  use gearsweep_base_kinds, only: dp
  use gearsweep_study_results_report, only: write_report
  use gearsweep_base_text, only: str
  use test_support_ask_by_name, only: answer_t, ask, refusal
  use test_support_testing, only: check_close, check_true, tally_t
  implicit none
  private
  public :: run

  !> A pair whose body is stated: three teeth on a section that is held at its sides and below.
  character(*), parameter :: pair = '&pair module_mm = 2.5 face_width_mm = 28 / &pinion teeth = 23 profile_shift = 0.3 / '// &
    '&gear teeth = 57 profile_shift = -0.1 / &section teeth = 3 fixed = ''sides'', ''rim'' / '
  !> A mesh without geometry, which takes no time.
  character(*), parameter :: plain = '&pinion teeth = 25 effective_mass_kg = 0.8 / &gear effective_mass_kg = 1.1 / '// &
    '&mesh model = ''polynomial'' contact_ratio = 1.6 coefficients = 400, 0, -110 base_pitch_mm = 10 / '// &
    '&dynamics damping_ratio = 0.1 / &sweep rpm_first = 4000 rpm_last = 20000 rpm_step = 1000 direction = ''each'' / '
  real(dp), parameter :: torques(5) = [40.0_dp, 75.0_dp, 110.0_dp, 145.0_dp, 180.0_dp]
  character(*), parameter :: listed = '&load torques_nm = 40, 75, 110, 145, 180 '

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('quietest')) call quietest(t)
    if (t%wants('least_motion')) call least_motion(t)
    if (t%wants('static_needs_no_motion')) call static_needs_no_motion(t)
    if (t%wants('one_answer')) call one_answer(t)
    if (t%wants('several_numbers')) call several_numbers(t)
    if (t%wants('refused')) call refused(t)
  end subroutine run

  !> Amounts of relief from 0 on in equal steps, as a case lists them.
  function amounts(step, count) result(words)
    real(dp), intent(in) :: step                 ! um
    integer, intent(in) :: count
    character(:), allocatable :: words
    integer :: i

    words = '0'
    do i = 1, count
      words = words//', '//str(step*i, 17)
    end do
  end function amounts

  !> Static transmission error: the best amount of a fine grid, each judged at each torque by a run of its own, lies by the optimum;
  !> and what the map has of a relief is what such a run says.
  subroutine quietest(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: step = 0.1_dp, share(5) = [4.0_dp, 1.0_dp, 1.0_dp, 1.0_dp, 1.0_dp]
    integer, parameter :: n = 100
    type(answer_t) :: by_range, by_harmonic, by_mean, at_torque
    real(dp) :: range(0:n, 5), amplitude(0:n, 5), map(0:n, 5)
    real(dp), allocatable :: values(:), own(:), relief(:)
    integer :: i

    do i = 1, 5
      call ask(t, '&case tasks = ''mesh'' / '//pair//'&mesh ste_harmonics = 2 / &load torque_nm = '//str(torques(i))// &
               ' / &relief amount_um = '//amounts(step, n)//' /', at_torque)
      range(:, i) = at_torque%all_of('transmission_error.peak_to_peak_um')
      values = at_torque%all_of('harmonics.amplitude_um')
      amplitude(:, i) = values(2::3)
    end do
    call ask(t, '&case tasks = ''optimum'' / '//pair//listed//'/ &optimum judged = ''ste_peak_to_peak'' /', by_range)
    call by_grid('peak to peak', maxval(range, 2), by_range, 'ste_peak_to_peak_um')
    ! Found beforehand by a minimiser outside of this program, over runs at single torques.
    call check_close(t, 'quietest relief', by_range%one('optimum.relief_um'), 6.9_dp, absolute=0.06_dp)
    call check_close(t, 'its error', by_range%one('optimum.ste_peak_to_peak_um'), 2.26_dp, absolute=0.006_dp)
    values = by_range%all_of('optimum_curve.ste_peak_to_peak_um')
    call check_close(t, 'without relief', values(1), 5.22_dp, absolute=0.006_dp)
    call ask(t, '&case tasks = ''optimum'' / '//pair//listed//'/ &optimum judged = ''mesh_harmonic'' /', by_harmonic)
    call by_grid('harmonic', maxval(amplitude, 2), by_harmonic, 'mesh_harmonic_um')
    call ask(t, '&case tasks = ''optimum'' / '//pair//listed//'torque_shares = 4, 1, 1, 1, 1 / '// &
             '&optimum judged = ''ste_peak_to_peak'' over_torques = ''weighted'' /', by_mean)
    map = spread(share/8, 1, n + 1)*range
    call by_grid('weighted', sum(map, 2), by_mean, 'ste_peak_to_peak_um')
    ! The second torque's part of the map.
    relief = by_range%all_of('optimum_map.relief_um')
    relief = relief(1::5)
    call ask(t, '&case tasks = ''mesh'' / '//pair//'&load torque_nm = 75 / &relief amount_um = '//listing(relief)//' /', at_torque)
    own = at_torque%all_of('transmission_error.peak_to_peak_um')
    values = by_range%all_of('optimum_map.ste_peak_to_peak_um')
    call check_close(t, 'the map', maxval(abs(values(2::5) - own)), 0.0_dp, absolute=1e-9_dp)
    own = at_torque%all_of('harmonics.amplitude_um')
    values = by_range%all_of('optimum_map.mesh_harmonic_um')
    call check_close(t, 'harmonics of the map', maxval(abs(values(2::5) - own(2::9))), 0.0_dp, absolute=1e-9_dp)
    values = by_range%all_of('optimum_map.torque_nm')
    call check_close(t, 'its torques', maxval(abs(values(6:10) - torques)), 0.0_dp)

  contains

    subroutine by_grid(name, judged, answer, column)
      character(*), intent(in) :: name, column
      real(dp), intent(in) :: judged(0:)
      type(answer_t), intent(in) :: answer
      integer :: best

      best = minloc(judged, 1) - 1
      call check_close(t, name//': the amount', answer%one('optimum.relief_um'), step*best, absolute=step)
      ! Where the best is known to `within_um`, an error that changes by no more than both reliefs is known to twice that.
      call check_true(t, name//': nothing of the grid is better', answer%one('optimum.'//column) < judged(best) + &
                      2*answer%one('optimum.within_um'), str(answer%one('optimum.'//column))//' and '//str(judged(best)))
      call check_close(t, name//': the value', answer%one('optimum.'//column), judged(best), absolute=0.08_dp)
    end subroutine by_grid
  end subroutine quietest

  function listing(values) result(words)
    real(dp), intent(in) :: values(:)
    character(:), allocatable :: words
    integer :: i

    words = str(values(1), 17)
    do i = 2, size(values)
      words = words//', '//str(values(i), 17)
    end do
  end function listing

  !> Dynamic factor and dynamic transmission error over two torques, against sweeps at each of them.
  subroutine least_motion(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: step = 0.25_dp, torque(2) = [150.0_dp, 300.0_dp]
    integer, parameter :: n = 110, speeds = 17
    type(answer_t) :: swept, answer
    real(dp) :: factor(0:n, 2), rms(0:n, 2), least
    integer :: i

    do i = 1, 2
      call ask(t, '&case tasks = ''sweep'' / '//plain//'&load torque_nm = '//str(torque(i))//' / &relief amount_um = '// &
               amounts(step, n)//' /', swept)
      factor(:, i) = maxval(reshape(swept%all_of('sweep.dynamic_factor'), [speeds, n + 1]), 1)
      rms(:, i) = sqrt(sum(reshape(swept%all_of('sweep.dte_rms_um'), [speeds, n + 1])**2, 1)/speeds)
    end do
    call ask(t, '&case tasks = ''optimum'' / '//plain//'&load torques_nm = 150, 300 / ', answer)
    least = minval(maxval(factor, 2))
    call check_true(t, 'no better factor', answer%one('optimum.worst_dynamic_factor') < least + 2e-5_dp)
    call check_close(t, 'its relief', answer%one('optimum.relief_um'), step*(minloc(maxval(factor, 2), 1) - 1), absolute=step)
    call check_close(t, 'its factor', answer%one('optimum.worst_dynamic_factor'), least, absolute=0.02_dp)
    call check_true(t, 'the largest of all motions is under the worst torque', answer%one('optimum.largest_dynamic_factor') >= &
                    answer%one('optimum.worst_dynamic_factor'))
    call ask(t, '&case tasks = ''optimum'' / '//plain//'&load torques_nm = 150, 300 / &optimum judged = ''dte_rms'' /', answer)
    least = minval(maxval(rms, 2))
    call check_true(t, 'no better error', answer%one('optimum.dte_rms_um') < least + 1e-4_dp)
    call check_close(t, 'its relief', answer%one('optimum.relief_um'), step*(minloc(maxval(rms, 2), 1) - 1), absolute=step)
    call check_close(t, 'the error', answer%one('optimum.dte_rms_um'), least, absolute=0.05_dp)
    ! Of loads in a constant ratio nothing but the scale changes: half the torque has half the relief and half the error.
    call ask(t, '&case tasks = ''optimum'' / '//plain//'&load torque_nm = 150 / &optimum judged = ''dte_rms'' /', swept)
    call ask(t, '&case tasks = ''optimum'' / '//plain//'&load torque_nm = 300 / &optimum judged = ''dte_rms'' /', answer)
    call check_close(t, 'half the relief', answer%one('optimum.relief_um')/2, swept%one('optimum.relief_um'), relative=1e-9_dp)
    call check_close(t, 'half the error', answer%one('optimum.dte_rms_um')/2, swept%one('optimum.dte_rms_um'), relative=1e-6_dp)
  end subroutine least_motion

  !> A case that judges by the static transmission error needs neither speeds nor damping, and computes no motion.
  subroutine static_needs_no_motion(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: still = '&case tasks = ''optimum'' / &pair module_mm = 3 face_width_mm = 20 / '// &
      '&pinion teeth = 21 / &gear teeth = 34 / &mesh model = ''weber'' / &load torques_nm = 60, 100 / '
    type(answer_t) :: answer

    call ask(t, still//'&optimum judged = ''mesh_harmonic'' harmonic = 2 /', answer)
    call check_true(t, 'no speeds', size(answer%study%rpm) == 0)
    call check_true(t, 'no dynamic factor', size(answer%all_of('optimum.worst_dynamic_factor')) == 0)
    call ask(t, still//'&dynamics damping_ratio = 0.3 / &optimum judged = ''mesh_harmonic'' /', answer)
    call check_true(t, 'damping is not used', index(answer%study%case%unused, 'damping_ratio') > 0)
    call check_true(t, 'by the dynamic factor, speeds are missing', index(refusal(still), '&sweep rpm_first: missing') > 0)
  end subroutine static_needs_no_motion

  !> The screen has one optimum, with its criterion and its torques.
  subroutine one_answer(t)
    type(tally_t), intent(inout) :: t
    type(answer_t) :: answer
    character(:), allocatable :: text

    call ask(t, '&case tasks = ''optimum'' / '//plain//'&load torques_nm = 150, 300 / &optimum each_gear = .true. /', answer)
    call write_report(answer%study, text)
    call check_true(t, 'one', index(text, 'Best ') > 0 .and. index(text, 'Best ') == index(text, 'Best ', back=.true.))
    call check_true(t, 'by what', index(text, 'judged by the largest dynamic factor over the speeds, worst over torques '// &
                                          '150, 300 N m') > 0)
    call ask(t, '&case tasks = ''optimum'' / '//plain//'&load torque_nm = 150 / &optimum judged = ''ste_peak_to_peak'' /', answer)
    call write_report(answer%study, text)
    call check_true(t, 'under one torque', index(text, 'static transmission error, under 150 N m') > 0)
  end subroutine one_answer

  !> More freedom leads to nothing worse, by each criterion; and what the design does at a torque is what `mesh` says of it.
  subroutine several_numbers(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: criteria(3) = [character(16) :: 'ste_peak_to_peak', 'mesh_harmonic', 'dte_rms']
    character(*), parameter :: columns(3) = [character(20) :: 'ste_peak_to_peak_um', 'mesh_harmonic_um', 'dte_rms_um']
    type(answer_t) :: answer, static
    real(dp), allocatable :: start(:), value(:)
    integer :: i

    do i = 1, size(criteria)
      call ask(t, '&case tasks = ''optimum'' / '//plain//'&load torques_nm = 150, 300 / &optimum judged = '''// &
               trim(criteria(i))//''' with_length = .true. /', answer)
      call check_true(t, trim(criteria(i))//' with its length', answer%one('optimum_design.'//trim(columns(i))) < &
                      answer%one('optimum.'//trim(columns(i)))*(1 + 1e-9_dp))
      value = answer%all_of('optimum_loads.'//trim(columns(i)))
      call check_close(t, 'its worst torque', maxval(value), answer%one('optimum_design.'//trim(columns(i))), relative=1e-12_dp)
      if (i > 1) cycle
      start = answer%all_of('optimum_design.gear_relief_start')
      call ask(t, '&case tasks = ''mesh'' / '//plain//'&load torque_nm = 300 / &relief start = ''length'' length_mm = '// &
               str(10*start(1), 17)//' amount_um = '//str(answer%one('optimum_design.pinion_relief_um'), 17)//' /', static)
      call check_close(t, 'what mesh says', static%one('transmission_error.peak_to_peak_um'), value(2), relative=1e-9_dp)
    end do
  end subroutine several_numbers

  subroutine refused(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: start = '&case tasks = ''optimum'' / '//plain

    call check_refusal('torques_nm = 10, 20 torque_nm = 10 /', '&load torques_nm: give torque_nm, or several torques_nm, not both')
    call check_refusal('torques_nm = 10, 20 normal_force_n = 10 /', '2 are given')
    call check_refusal('torques_nm = 10, -20 /', '&load torques_nm = 10, -20: must be at least')
    call check_refusal('torques_nm = 10, 10 /', '&load torques_nm = 10, 10: 10 is given twice')
    call check_refusal('torques_nm = 10, 20 torque_shares = 1, 2 /', &
                       '&load torque_shares = 1, 2: needs &optimum over_torques = ''weighted''')
    call check_refusal('torques_nm = 10, 20 torque_shares = 1, 2, 3 / &optimum over_torques = ''weighted'' /', &
                       '&load torque_shares: 3 numbers for 2 of torques_nm')
    call check_refusal('torque_nm = 10 torque_shares = 1 / &optimum over_torques = ''weighted'' /', 'needs torques_nm')
    call check_refusal('torques_nm = 10, 20 torque_shares = 1, 0 / &optimum over_torques = ''weighted'' /', &
                       '&load torque_shares = 1, 0: must be above 0')
    call check_refusal('torque_nm = 10 / &optimum load_factors = 1, 2 /', 'list the torques in &load torques_nm')
    call check_refusal('torque_nm = 10 / &optimum judged = ''noise'' /', '''ste_peak_to_peak''')
    call check_true(t, 'no task for several torques', index(refusal('&case tasks = ''mesh'' / '//plain// &
      '&load torques_nm = 10, 20 /'), 'only the task optimum uses several torques') > 0)

  contains

    subroutine check_refusal(load, message)
      character(*), intent(in) :: load, message
      character(:), allocatable :: said

      said = refusal(start//'&load '//load)
      call check_true(t, message, index(said, message) > 0, said)
    end subroutine check_refusal
  end subroutine refused
end module test_torques
