!> The search for the best relief, of one amount and of several numbers, against brute force.
module test_reliefs
  use gearsweep_motion_optimum, only: find_optimum, optimum_t, peak_t, worst_of
  use gearsweep_base_error, only: error_t
  use gearsweep_motion_joint_optimum, only: design_t, find_joint_optimum, joint_optimum_t, largest_value, starts_t, sweep_design
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_motion_oscillator, only: make_oscillator, oscillator_t
  use gearsweep_gear_relief, only: profile_error, relief_t
  use gearsweep_motion_steady_motion, only: has_result
  use gearsweep_motion_sweep, only: each, run_sweep, sweep_options_t, sweep_t
  use gearsweep_study_results_report, only: write_report
  use gearsweep_base_text, only: fixed, str
  use test_support_ask_by_name, only: answer_t, ask
  use test_properties_random_meshes, only: draw_t, random_mesh
  use test_support_random_numbers, only: random_t
  use test_support_solve_one_point, only: mesh_of
  use test_support_testing, only: check_close, check_no_error, check_true, tally_t
  implicit none
  private
  public :: run

  !> What designs of a mesh are judged by.
  type :: problem_t
    type(oscillator_t) :: osc
    type(sweep_options_t) :: options
    real(dp) :: rpm(40) = 0
  end type problem_t

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('optimum_by_brute_force')) call optimum_by_brute_force(t)
    if (t%wants('joint_optimum')) call joint_optimum(t)
    if (t%wants('joint_optimum_of_a_case')) call joint_optimum_of_a_case(t)
    if (t%wants('where_reliefs_begin')) call where_reliefs_begin(t)
    if (t%wants('joint_never_worse')) call joint_never_worse(t)
  end subroutine run

  !> The oscillator of a draw with a part of its relief.
  subroutine relieve(whole, part, osc)
    type(oscillator_t), intent(in) :: whole
    real(dp), intent(in) :: part
    type(oscillator_t), intent(out) :: osc
    type(error_t), allocatable :: error

    osc = whole
    osc%mesh%profile_error%coef = part*whole%mesh%profile_error%coef
    call make_oscillator(osc, error)
    if (allocated(error)) error stop 'relieved mesh'
  end subroutine relieve

  subroutine build(context, amount, motion, error)
    class(*), intent(in) :: context
    real(dp), intent(in) :: amount
    type(oscillator_t), intent(out) :: motion
    type(error_t), allocatable, intent(out) :: error

    select type (context)
    type is (oscillator_t)
      call relieve(context, amount, motion)
    end select
  end subroutine build

  !> Every relief of the optimum's curve, swept by itself at all speeds: the largest is that of the curve, or at least that where
  !> the curve says so.
  subroutine optimum_by_brute_force(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: meshes = 6
    type(draw_t) :: draw
    type(oscillator_t) :: osc(1)
    type(optimum_t) :: optimum
    type(sweep_options_t) :: options
    type(sweep_t) :: sweep
    type(error_t), allocatable :: error
    type(peak_t) :: peak
    real(dp) :: worst
    integer :: i, k, bounds

    bounds = 0
    options%direction = each
    options%accuracy%steady%tolerance = 1e-5_dp
    do i = 1, meshes
      call random_mesh(100 + i, 40, draw)
      draw%osc%damping_ratio = max(0.05_dp, draw%osc%damping_ratio)
      call relieve_both(draw%osc, 1.6_dp*draw%osc%load/draw%osc%mesh%mean_stiffness())
      draw%rpm = draw%rpm(1)*[(0.3_dp + 0.03_dp*k, k=1, 40)]
      call find_optimum(build, draw%osc, 1.0_dp, draw%rpm, options, optimum, error)
      call check_no_error(t, 'optimum', error)
      do k = 1, size(optimum%amount)
        call relieve(draw%osc, optimum%amount(k), osc(1))
        call run_sweep(osc, draw%rpm, options, sweep, error)
        peak = worst_of(draw%rpm, sweep%dynamic_factor(:, 1))
        worst = peak%dynamic_factor
        if (optimum%is_bound(k)) then
          bounds = bounds + 1
          call check_true(t, 'at least that', worst > optimum%dynamic_factor(k) - 3e-5_dp)
          call check_true(t, 'not the best', worst > optimum%dynamic_factor(optimum%best))
        else
          call check_close(t, 'the largest of all speeds', optimum%dynamic_factor(k), worst, absolute=3e-5_dp)
        end if
      end do
    end do
    call check_true(t, 'some reliefs take a few speeds only', bounds > 0, str(bounds))
  end subroutine optimum_by_brute_force

  !> Linear relief on both gears, from where one pair begins to carry alone, so deep (m).
  subroutine relieve_both(osc, deepest)
    type(oscillator_t), intent(inout) :: osc
    real(dp), intent(in) :: deepest
    type(relief_t) :: relief
    type(error_t), allocatable :: error

    relief%amount = deepest
    relief%start = [aint(osc%mesh%contact_ratio), modulo(osc%mesh%contact_ratio, 1.0_dp)]
    call profile_error(relief, osc%mesh%contact_ratio, osc%mesh%profile_error, error)
    if (allocated(error)) error stop 'relief'
  end subroutine relieve_both

  !> A mesh whose reliefs of both gears have amounts of up to 30 um and lengths of up to half of the path.
  subroutine with_reliefs(osc, number, motion, error)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: number(:)
    type(oscillator_t), allocatable, intent(out) :: motion(:)
    type(error_t), allocatable, intent(out) :: error
    real(dp), parameter :: load_factor(2) = [1.0_dp, 0.5_dp]
    type(relief_t) :: relief
    integer :: i

    allocate (motion(size(load_factor)))
    do i = 1, size(motion)
      motion(i) = osc
      motion(i)%load = load_factor(i)*osc%load
      relief%amount = 30e-6_dp*number(1)
      associate (ratio => osc%mesh%contact_ratio, length => 0.1_dp + 0.7_dp*number(2))
        relief%start = [ratio - length, length]
        call profile_error(relief, ratio, motion(i)%mesh%profile_error, error)
      end associate
      if (.not. allocated(error)) call make_oscillator(motion(i), error)
      if (allocated(error)) return
    end do
  end subroutine with_reliefs

  !> The judge of these: all dynamic factors.
  subroutine by_factors(context, number, design, stopped, error, best)
    class(*), intent(in) :: context
    real(dp), intent(in) :: number(:)
    type(design_t), intent(out) :: design
    logical, intent(out) :: stopped
    type(error_t), allocatable, intent(out) :: error
    type(design_t), intent(in), optional :: best
    type(oscillator_t), allocatable :: motion(:)

    stopped = .false.
    select type (context)
    type is (problem_t)
      call with_reliefs(context%osc, number, motion, error)
      if (.not. allocated(error)) call sweep_design(motion, context%rpm, context%options, design, stopped, error, best)
      design%number = number
    end select
  end subroutine by_factors

  !> Amount and length together under two loads: no design of a grid over both is better, by more than the last step changes.
  subroutine joint_optimum(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: amounts = 24, lengths = 14
    type(oscillator_t) :: osc
    type(oscillator_t), allocatable :: motion(:)
    type(sweep_options_t) :: options
    type(sweep_t) :: sweep
    type(joint_optimum_t) :: found
    type(error_t), allocatable :: error
    real(dp) :: least, largest, rpm(40)
    type(starts_t) :: starts(3)
    integer :: i, k

    osc = mesh_of(1.6_dp, [400.0_dp, 0.0_dp, -110.0_dp], [0.0_dp, 0.0_dp], 0.1_dp)
    options%direction = each
    options%accuracy%steady%tolerance = 1e-5_dp
    rpm = [(4000 + 500*i, i=1, size(rpm))]
    do k = 1, 3
      starts(k)%number = reshape([([i/4.0_dp, k/3.0_dp], i=0, 4)], [2, 5])
    end do
    call find_joint_optimum(by_factors, problem_t(osc, options, rpm), starts, found, error)
    call check_no_error(t, 'joint optimum', error)
    least = huge(least)
    do i = 0, amounts
      do k = 0, lengths
        call with_reliefs(osc, [i/real(amounts, dp), k/real(lengths, dp)], motion, error)
        call run_sweep(motion, rpm, options, sweep, error)
        if (all(has_result(sweep%status))) least = min(least, maxval(sweep%dynamic_factor))
      end do
    end do
    call check_true(t, 'it has all speeds', all(found%best%failed == 0))
    ! Steps are halved from an eighth of the ranges down to 1/512 (`last_step`), in which nothing better was found.
    call check_close(t, 'no better one so near', found%within, 2.0_dp**(-9))
    largest = largest_value(found%best)
    call check_true(t, 'no design of the grid is better', largest < least + 1e-4_dp, str(largest)//' and '//str(least))
    call check_true(t, 'it is better than the grid', largest < least, str(largest)//' and '//str(least))
    call with_reliefs(osc, found%best%number, motion, error)
    call run_sweep(motion, rpm, options, sweep, error)
    do i = 1, 2
      call check_close(t, 'what is told of a load', found%best%of_load(i), maxval(sweep%dynamic_factor(:, i)), &
                       absolute=4e-5_dp)
    end do
  end subroutine joint_optimum

  !> Of a case: what is told is what a sweep says with those reliefs, written as amount, fraction and length; and with more
  !> freedom there is nothing worse.
  subroutine joint_optimum_of_a_case(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: rest = '&pinion teeth = 25 effective_mass_kg = 0.8 / &gear effective_mass_kg = 1.1 / '// &
      '&mesh model = ''polynomial'' contact_ratio = 1.6 coefficients = 400, 0, -110 '// &
      'base_pitch_mm = 10 / &dynamics damping_ratio = 0.1 / &sweep rpm_first = 4000 rpm_last = 20000 rpm_step = 500 '// &
      'direction = ''each'' / &relief amount_um = '
    character(*), parameter :: loaded = '&load normal_force_n = 7000 / ', search = '&case tasks = ''optimum'' / '//rest//'0 / '
    real(dp), parameter :: arm = 25*0.01_dp/(2*pi)         ! of the normal force: the base radius, m
    type(answer_t) :: one, length, both, swept
    real(dp) :: amount(2), start(2)

    call ask(t, search//loaded, one)
    call check_true(t, 'nothing that is not asked for', size(one%all_of('optimum_design.worst_dynamic_factor')) == 0)
    call ask(t, search//loaded//'&optimum with_length = .true. /', length)
    call ask(t, search//loaded//'&optimum with_length = .true. each_gear = .true. /', both)
    call check_true(t, 'length beside the amount', length%one('optimum_design.worst_dynamic_factor') < &
                    one%one('optimum.worst_dynamic_factor') + 1e-3_dp)
    call check_true(t, 'each gear by itself', both%one('optimum_design.worst_dynamic_factor') < &
                    length%one('optimum_design.worst_dynamic_factor') + 1e-3_dp)
    amount = [both%one('optimum_design.pinion_relief_um'), both%one('optimum_design.gear_relief_um')]
    start = [length%one('optimum_design.pinion_relief_start'), length%one('optimum_design.gear_relief_start')]
    call check_close(t, 'lengths of both', start(1) + start(2), 1.6_dp, 1e-12_dp)
    amount = [length%one('optimum_design.pinion_relief_um'), length%one('optimum_design.gear_relief_um')]
    call check_close(t, 'amounts of both', amount(1), amount(2), 1e-12_dp)
    call ask(t, '&case tasks = ''sweep'' / '//loaded//rest//str(amount(1), 17)//' start = ''length'' length_mm = '// &
             str(10*start(2), 17)//' /', swept)
    call check_close(t, 'what a sweep says', maxval(swept%all_of('sweep.dynamic_factor')), &
                     length%one('optimum_design.worst_dynamic_factor'), absolute=3e-5_dp)
    call ask(t, search//'&load torques_nm = '//str(3500*arm, 17)//', '//str(7000*arm, 17)//', '//str(10500*arm, 17)//' /', both)
    call check_true(t, 'three loads', size(both%all_of('optimum_loads.torque_nm')) == 3)
    call check_close(t, 'the largest of all loads', maxval(both%all_of('optimum_loads.worst_dynamic_factor')), &
                     both%one('optimum.worst_dynamic_factor'), 1e-14_dp)
    call told_with_loads(t, both)
    call check_true(t, 'several loads ask for a compromise', both%one('optimum.worst_dynamic_factor') > &
                    one%one('optimum.worst_dynamic_factor'))
  end subroutine joint_optimum_of_a_case

  !> Each dynamic factor on the screen names its load.
  subroutine told_with_loads(t, answer)
    type(tally_t), intent(inout) :: t
    type(answer_t), intent(in) :: answer         ! with several loads
    character(:), allocatable :: text
    real(dp), allocatable :: torque(:), factor(:)
    integer :: i

    call write_report(answer%study, text)
    torque = answer%all_of('optimum_loads.torque_nm')
    factor = answer%all_of('optimum_loads.worst_dynamic_factor')
    do i = 1, size(torque)
      call check_true(t, 'with its load', index(text, '   '//str(torque(i))//' N m: worst DF '//fixed(factor(i), 4)) > 0)
    end do
    call check_true(t, 'and all together', index(text, 'worst over torques '//str(torque(1))//', ') > 0)
  end subroutine told_with_loads

  !> Reliefs that begin at the pitch point do so at the reference diameters of gears without profile shift: 3 mm times 21 and 34.
  subroutine where_reliefs_begin(t)
    type(tally_t), intent(inout) :: t
    type(answer_t) :: answer
    character(:), allocatable :: text

    call ask(t, '&case tasks = ''optimum'' / &pair module_mm = 3 face_width_mm = 20 / &pinion teeth = 21 / &gear teeth = 34 / '// &
             '&load torque_nm = 100 / &relief amount_um = 0 start = ''pitch'' / &mesh model = ''weber'' / '// &
             '&sweep rpm_first = 10000 rpm_last = 30000 rpm_step = 2000 / &optimum each_gear = .true. /', answer)
    call check_close(t, 'pinion', answer%one('optimum_design.pinion_start_diameter_mm'), 63.0_dp, relative=1e-12_dp)
    call check_close(t, 'gear', answer%one('optimum_design.gear_start_diameter_mm'), 102.0_dp, relative=1e-12_dp)
    call write_report(answer%study, text)
    call check_true(t, 'on the screen', index(text, ' um from 102.000 mm diameter') > 0)
  end subroutine where_reliefs_begin

  !> The designs of several numbers have that of one amount among them: none of theirs that is told is worse. Little damping, so
  !> that contact is lost and DF jumps over the reliefs; from a grid of starts only, 1, 2, 3 and 4 ended by 0.06, 0.12, 0.17 and
  !> 0.14 above it, and with lengths 1 and 2 by 0.13 and 0.10.
  subroutine joint_never_worse(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: drawn(5, 5) = reshape([1.407_dp, -12.5_dp, -135.2_dp, 0.0156_dp, 0.0_dp, &
                                                  1.702_dp, -43.4_dp, -21.4_dp, 0.0273_dp, 0.0_dp, &
                                                  1.288_dp, 0.6_dp, -5.0_dp, 0.0347_dp, 0.0_dp, &
                                                  1.811_dp, -26.4_dp, -91.1_dp, 0.0163_dp, 0.0_dp, &
                                                  ! The gear has half of the relief, and the pitch point is not in the middle.
                                                  1.521_dp, 18.1_dp, -148.4_dp, 0.0172_dp, 1.0_dp], [5, 5])
    character(*), parameter :: varied(2) = [character(20) :: 'each_gear', 'with_length'], &
      uneven(2) = [character(40) :: ' pitch_point = 0.6', 'gear_fraction = 0.5 start = ''pitch''']
    integer :: i, k

    do i = 1, size(drawn, 2)
      do k = 1, 2
        call compare(drawn(:, i), trim(varied(k)), 'each', 'mesh '//str(i))
        ! Where both ways are followed, too.
        if (i < 3) call compare(drawn(:, i), trim(varied(k)), 'both', 'mesh '//str(i))
      end do
    end do

  contains

    subroutine compare(drawn, varied, direction, name)
      real(dp), intent(in) :: drawn(5)
      character(*), intent(in) :: varied, direction, name
      type(answer_t) :: answer

      call ask(t, '&case tasks = ''optimum'' / &pinion teeth = 25 effective_mass_kg = 0.8 / &gear effective_mass_kg = 1.1 / '// &
               '&load normal_force_n = 7000 / &mesh model = ''polynomial'' base_pitch_mm = 10 contact_ratio = '// &
               str(drawn(1))//' coefficients = 400, '//str(drawn(2))//', '//str(drawn(3))// &
               trim(merge(uneven(1), repeat(' ', 40), drawn(5) > 0))//' / &dynamics damping_ratio = '// &
               str(drawn(4))//' / &sweep rpm_first = 4000 rpm_last = 20000 rpm_step = 400 direction = '''//direction//''' / '// &
               '&relief amount_um = 0 '//trim(merge(uneven(2), repeat(' ', 40), drawn(5) > 0))// &
               ' / &optimum '//varied//' = .true. /', answer)
      ! Both are told to 1e-5.
      call check_true(t, varied//' of '//name//', direction '//direction, answer%one('optimum_design.worst_dynamic_factor') < &
                      answer%one('optimum.worst_dynamic_factor') + 2e-5_dp, &
                      str(answer%one('optimum_design.worst_dynamic_factor'))//' and '// &
                      str(answer%one('optimum.worst_dynamic_factor')))
      if (direction == 'both') call look_for_all(drawn, name, answer%one('optimum.relief_um'), answer%one('optimum.rpm'), &
                                                 answer%one('optimum.largest_dynamic_factor'))
    end subroutine compare

    !> The optimum tells the largest of the motions that the task `attractors` finds with that relief at that speed.
    subroutine look_for_all(drawn, name, relief, rpm, largest)
      real(dp), intent(in) :: drawn(5), relief, rpm, largest
      character(*), intent(in) :: name
      type(answer_t) :: answer

      call ask(t, '&case tasks = ''attractors'' / &pinion teeth = 25 effective_mass_kg = 0.8 / &gear effective_mass_kg = 1.1 / '// &
               '&load normal_force_n = 7000 / &mesh model = ''polynomial'' base_pitch_mm = 10 contact_ratio = '// &
               str(drawn(1))//' coefficients = 400, '//str(drawn(2))//', '//str(drawn(3))//' / &dynamics damping_ratio = '// &
               str(drawn(4))//' / &relief amount_um = '//str(relief, 17)//' / &attractors rpm = '//str(rpm, 17)//' /', answer)
      call check_true(t, 'no motion that a start reaches is larger: '//name, largest > (1 - 1e-5_dp)* &
                      answer%one('attractor_points.largest_dynamic_factor'), str(largest)//' and '// &
                      str(answer%one('attractor_points.largest_dynamic_factor')))
    end subroutine look_for_all
  end subroutine joint_never_worse
end module test_reliefs
