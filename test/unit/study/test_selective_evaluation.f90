!> What a scene does not ask for is not computed, and what it gives is what
!> the whole gives, to the last bit or within a stated error.
module test_selective_evaluation
  use gearsweep_motion_resolution, only: resolution_t
  use gearsweep_motion_contact_set, only: period_t
  use gearsweep_motion_gauss, only: batch_size
  use gearsweep_motion_oscillator, only: mesh_period, oscillator_t
  use gearsweep_motion_period, only: run_batch, run_full_contact
  use gearsweep_motion_period_map, only: discretise, period_map_t, set_durations
  use gearsweep_motion_periodic_orbit, only: newton_step
  use gearsweep_study_case_case, only: case_t
  use gearsweep_api_case_reader, only: read_case
  use gearsweep_elastic_disc, only: disc_t
  use gearsweep_base_error, only: error_t
  use gearsweep_elastic_fe_stiffness, only: fe_options_t, fe_stiffness
  use gearsweep_base_kinds, only: dp
  use gearsweep_gear_pair, only: pair_t
  use gearsweep_base_piecewise, only: piecewise_t
  use gearsweep_study_run_study, only: run_study, study_t
  use gearsweep_base_table, only: table_t
  use gearsweep_api_tables, only: column_of, make_table, table_names
  use gearsweep_study_case_task, only: split_names, stage, table_length, task_length
  use gearsweep_api_tasks, only: list_task_names
  use gearsweep_base_text, only: str
  use test_support_testing, only: tally_t, check_true, check_close, check_equal, check_no_error
  implicit none
  private
  public :: run

  character(*), parameter :: text = &
    '&pair module_mm = 3 face_width_mm = 20 / &pinion teeth = 21 bore_mm = 12 / &gear teeth = 34 / &load torque_nm = 100 /'// &
    '&relief amount_um = 0, 8, 20 / &mesh model = ''fe'' / &section elements_across = 4 /'// &
    '&static positions = 5 field_position = 0 / &face_load misalignment_um = -20, 0, 20 /'// &
    '&dynamics damping_ratio = 0.1 /'// &
    '&sweep rpm_first = 4000 rpm_last = 9000 rpm_step = 250 load_rpm = 5000 load_torque = .true. /'// &
    '&body_modes nodal_diameters = 2 elements_across = 2 /'// &
    '&as_built waterfall = .true. with_ste = .true. ste_harmonic = 1 with_root_stress = .true. / &deviations pinion_class = 6 /'// &
    '&flank rpm = 5000 / &rating rpm = 5000 material = ''C45'' / '// &
    '&transient rpm = 5000 modes = 4 samples = 20 /'// &
    '&harmonic frequency_hz = 0, 1e5 modes = 3 /'// &
    '&life rpm = 5000 duration_h = 1 /'// &
    '&stability damping_count = 3 tongues = 2 /'// &
    '&hysteresis relief_um = 8 ramp_rpm_s = 1e5 / '// &
    '&poincare rpm = 6000, 5000 relief_um = 0, 20 settling_periods = 20 kept_periods = 9 /'// &
    '&attractors rpm = 5000, 7000 relief_um = 0 starts = 3 /'// &
    '&branches first = 5000 last = 7000 relief_um = 0 seeds = 2 points = 20 most_periods = 1 /'// &
    '&optimum with_length = .true. / &sensitivity rpm = 5000 relief_um = 8 /'// &
    '&precision relief_um = 8 most_steps = 50 most_samples = 64 most_elements = 4 modes = 1 /'

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t
    type(case_t) :: case
    type(error_t), allocatable :: error

    call read_case(text//every_task(), case, error)
    call check_no_error(t, 'the case of all tasks: `text` in test_selective_evaluation.f90 has what each needs', error)
    if (t%wants('single_tasks')) call single_tasks(t, case)
    if (t%wants('one_body')) call one_body(t, case)
    if (t%wants('single_reliefs')) call single_reliefs(t, case)
    if (t%wants('one_speed')) call one_speed(t, case)
    if (t%wants('no_coast')) call no_coast(t, case)
    if (t%wants('no_friction')) call no_friction(t, case)
    if (t%wants('no_relief')) call no_relief(t, case)
    if (t%wants('one_mode')) call one_mode(t, case)
    if (t%wants('no_contact_loss')) call no_contact_loss(t, case)
    if (t%wants('equal_gears')) call equal_gears(t)
  end subroutine run

  subroutine study_of(t, case, study, task)
    type(tally_t), intent(inout) :: t
    type(case_t), intent(in) :: case
    type(study_t), intent(out) :: study
    character(*), intent(in), optional :: task
    type(case_t) :: wanted
    type(error_t), allocatable :: error

    wanted = case
    if (present(task)) call wanted%request([task])
    call run_study(wanted, '', 1, study, error)
    call check_no_error(t, 'study', error)
  end subroutine study_of

  !> The numbers of a task's first table, which has its name; none where it was not run.
  function numbers_of(study, task) result(numbers)
    type(study_t), intent(in) :: study
    character(*), intent(in) :: task
    real(dp), allocatable :: numbers(:)
    type(table_t) :: table
    type(error_t), allocatable :: error
    integer :: i

    numbers = [real(dp) ::]
    call make_table(study, task, table, error)
    if (.not. table%is_there()) return
    do i = 1, size(table%columns)
      if (allocated(table%columns(i)%numbers) .and. table%columns(i)%is_reproducible) &
        numbers = [numbers, table%columns(i)%numbers]
    end do
  end function numbers_of

  !> Dynamic factors of a sweep with relief number `i`.
  function factors(study, i)
    type(study_t), intent(in) :: study
    integer, intent(in) :: i
    real(dp), allocatable :: factors(:)

    factors = column_of(study, 'sweep', 'dynamic_factor')
    factors = factors((i - 1)*size(study%rpm) + 1:i*size(study%rpm))
  end function factors

  pure logical function same_bits(a, b)
    real(dp), intent(in) :: a(:), b(:)

    same_bits = size(a) == size(b) .and. size(a) > 0
    if (same_bits) same_bits = all(transfer(a, [0]) == transfer(b, [0]))
  end function same_bits

  !> The group that names all tasks there are.
  function every_task() result(group)
    character(:), allocatable :: group
    character(task_length), allocatable :: names(:)
    integer :: i

    call list_task_names(names)
    group = '&case tasks ='
    do i = 1, size(names)
      group = group//' '''//trim(names(i))//''','
    end do
    group(len(group):) = '/'
  end function every_task

  !> Each task alone gives what it gives among all, and nothing else; the geometry comes with all.
  subroutine single_tasks(t, case)
    type(tally_t), intent(inout) :: t
    type(case_t), intent(in) :: case
    type(study_t) :: all_tasks, alone
    character(task_length), allocatable :: names(:)
    integer :: i

    call list_task_names(names)
    call study_of(t, case, all_tasks)
    do i = 1, size(names)
      call study_of(t, case, alone, names(i))
      call check_true(t, trim(names(i))//' alone: the same bits', &
                      same_bits(numbers_of(alone, names(i)), numbers_of(all_tasks, names(i))))
      call its_tables(t, alone, i)
      call check_true(t, trim(names(i))//' alone: stiffness only where it is needed', allocated(alone%mesh) .eqv. &
                      any(alone%tasks(i)%info%needs == stage%mesh), 'its `needs`, in describe of its file')
    end do
  end subroutine single_tasks

  !> A task fills all tables that it lists and no others, but for those that come with all.
  subroutine its_tables(t, study, i)
    type(tally_t), intent(inout) :: t
    type(study_t), intent(in) :: study
    integer, intent(in) :: i                     ! which task
    character(table_length), allocatable :: names(:)
    type(table_t) :: table
    type(error_t), allocatable :: error
    character(table_length), allocatable :: listed(:)
    integer :: k

    call split_names(study%tasks(i)%info%tables//' '//study%tasks(i)%info%fields//' '//study%tasks(1)%info%tables//' '// &
                     trim(merge('motion', '      ', allocated(study%mesh))), listed)
    names = table_names()
    do k = 1, size(names)
      call make_table(study, names(k), table, error)
      call check_true(t, trim(study%tasks(i)%info%name)//' alone: the table '//trim(names(k))//' where it is listed', &
                      table%is_there() .eqv. any(listed == names(k)))
    end do
  end subroutine its_tables

  !> Stress and modes read the same two factored grids.
  subroutine one_body(t, case)
    type(tally_t), intent(inout) :: t
    type(case_t), intent(in) :: case
    character(*), parameter :: twice = 'section: two grids made and factored'
    type(case_t) :: both
    type(study_t) :: study, alone
    character(8), parameter :: tasks(2) = [character(8) :: 'static', 'modal']
    integer :: i

    both = case
    call both%request(tasks)
    call study_of(t, both, study)
    call check_equal(t, 'grids for stress and modes: factored once', occurrences(study%log, twice), 1)
    do i = 1, size(tasks)
      call study_of(t, case, alone, tasks(i))
      call check_true(t, trim(tasks(i))//' with the others: the same bits', &
                      same_bits(numbers_of(study, tasks(i)), numbers_of(alone, tasks(i))))
      call check_equal(t, trim(tasks(i))//': factored', occurrences(alone%log, twice), 1)
    end do
  end subroutine one_body

  pure integer function occurrences(text, words) result(n)
    character(*), intent(in) :: text, words
    integer :: i

    n = count([(text(i:i + len(words) - 1) == words, i=1, len(text) - len(words) + 1)])
  end function occurrences

  subroutine single_reliefs(t, case)
    type(tally_t), intent(inout) :: t
    type(case_t), intent(in) :: case
    type(case_t) :: alone
    type(study_t) :: all_reliefs, one
    integer :: i

    call study_of(t, case, all_reliefs, 'sweep')
    alone = case
    do i = 1, size(case%amount)
      alone%amount = case%amount(i:i)
      call study_of(t, alone, one, 'sweep')
      call check_true(t, 'one relief: the same bits', &
                      same_bits(factors(one, 1), factors(all_reliefs, i)))
    end do
  end subroutine single_reliefs

  !> Two sweeps agree within the tolerance that both were asked for.
  subroutine check_within(t, name, a, b)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: name
    type(study_t), intent(in) :: a, b
    real(dp), allocatable :: one(:), other(:)
    integer :: i, k

    do i = 1, size(a%amount)
      one = factors(a, i)
      other = factors(b, i)
      do k = 1, size(a%rpm)
        call check_close(t, name//' at '//str(a%rpm(k))//' rpm, relief '//str(i), one(k), other(k), &
                         absolute=2*a%case%accuracy%steady%tolerance)
      end do
    end do
  end subroutine check_within

  !> The steps at a speed may follow from its neighbours'.
  subroutine one_speed(t, case)
    type(tally_t), intent(inout) :: t
    type(case_t), intent(in) :: case
    type(case_t) :: alone
    type(study_t) :: one, many

    call study_of(t, case, many, 'sweep')
    alone = case
    alone%rpm_last = case%rpm_first
    call study_of(t, alone, one, 'sweep')
    call check_within(t, 'one speed', one, many)
  end subroutine one_speed

  !> A backlash that no motion comes through.
  subroutine no_coast(t, case)
    type(tally_t), intent(inout) :: t
    type(case_t), intent(in) :: case
    type(case_t) :: with
    type(study_t) :: lean, full
    type(table_t) :: table
    type(error_t), allocatable :: error

    with = case
    with%has_backlash = .true.
    with%backlash = 1
    call study_of(t, case, lean, 'sweep')
    call study_of(t, with, full, 'sweep')
    call check_true(t, 'no coast side: the same bits', same_bits(numbers_of(lean, 'sweep'), numbers_of(full, 'sweep')))
    call make_table(lean, 'sweep', table, error)
    call check_true(t, 'with separation among them', any(table%columns(table%position('contact'))%words /= 'full'))
    call check_equal(t, 'no coast side: no contact for it', lean%motion(1)%contacts, full%motion(1)%contacts - 1)
  end subroutine no_coast

  !> A friction too small for any digit has its break, at the pitch point, all the same.
  subroutine no_friction(t, case)
    type(tally_t), intent(inout) :: t
    type(case_t), intent(in) :: case
    type(case_t) :: with
    type(study_t) :: lean, full

    with = case
    with%friction = 1e-30_dp
    call study_of(t, case, lean, 'sweep')
    call study_of(t, with, full, 'sweep')
    call check_within(t, 'no friction', lean, full)
    call check_equal(t, 'no friction: no break', size(lean%motion(1)%intervals), size(full%motion(1)%intervals) - 1)
  end subroutine no_friction

  !> So has such a relief, where it begins.
  subroutine no_relief(t, case)
    type(tally_t), intent(inout) :: t
    type(case_t), intent(in) :: case
    type(case_t) :: with
    type(study_t) :: lean, full

    with = case
    with%start = 'pitch'
    with%amount = [0.0_dp]
    call study_of(t, with, lean, 'sweep')
    with%amount = [1e-30_dp]
    call study_of(t, with, full, 'sweep')
    call check_within(t, 'no relief', lean, full)
    call check_equal(t, 'no relief: no break', size(lean%motion(1)%intervals), size(full%motion(1)%intervals) - 1)
  end subroutine no_relief

  !> Frequencies err by the square of the shapes' error, 1e-9, and by rounding.
  subroutine one_mode(t, case)
    type(tally_t), intent(inout) :: t
    type(case_t), intent(in) :: case
    type(case_t) :: alone
    type(study_t) :: one, ten
    type(error_t), allocatable :: error

    call study_of(t, case, ten, 'modal')
    call read_case(text//every_task()//' &modal modes = 1 /', alone, error)
    call check_no_error(t, 'one mode', error)
    call study_of(t, alone, one, 'modal')
    associate (few => column_of(one, 'modal', 'frequency_hz'), many => column_of(ten, 'modal', 'frequency_hz'))
      call check_equal(t, 'one mode', size(few), 1)
      call check_close(t, 'one mode of ten', few(1), many(1), relative=1e-11_dp)
    end associate
  end subroutine one_mode

  !> Motions that keep contact: without looking for changes of contact, and with; with the propagators of the steps as
  !> they were cached before, and made anew.
  subroutine no_contact_loss(t, case)
    type(tally_t), intent(inout) :: t
    type(case_t), intent(in) :: case
    type(case_t) :: without
    type(study_t) :: study
    type(period_map_t) :: map
    type(period_t), dimension(batch_size) :: full, held, free, anew
    real(dp) :: duration(batch_size), from(2, batch_size)
    logical :: solved
    integer :: l

    ! Where tip corners may touch, some pair that could always parts.
    without = case
    without%corner_contact = .false.
    call study_of(t, without, study, 'mesh')
    associate (osc => study%motion(1))
      call discretise(osc, resolution_t(20.0_dp, 2), map)
      duration = mesh_period(osc%mesh%teeth(1), [(3000 + 100.0_dp*l, l=1, batch_size)])
      from = 0
      call set_durations(map, duration)
      call run_full_contact(map, from, full)
      do l = 1, batch_size
        call newton_step(full(l)%monodromy, full(l)%state, from(:, l), solved)
      end do
      call run_batch(map, from, [(.false., l=1, batch_size)], .true., held)
      call run_batch(map, from, [(.true., l=1, batch_size)], .true., free)
      call set_durations(map, duration)
      call run_batch(map, from, [(.true., l=1, batch_size)], .true., anew)
    end associate
    call check_true(t, 'all pairs in contact', .not. any(held%partial .or. free%partial))
    do l = 1, batch_size
      call check_close(t, 'largest load', held(l)%peak, free(l)%peak)
      call check_close(t, 'end of the period', held(l)%state(1), free(l)%state(1))
      call check_true(t, 'the same bits', all(abs(anew(l)%state - free(l)%state) <= 0) .and. anew(l)%peak <= free(l)%peak &
                      .and. all(abs(anew(l)%monodromy - full(l)%monodromy) <= 0))
    end do
  end subroutine no_contact_loss

  !> A bore that the rim does not reach makes gears unequal and changes nothing else.
  subroutine equal_gears(t)
    type(tally_t), intent(inout) :: t
    type(case_t) :: case
    type(study_t) :: study
    type(pair_t) :: pair
    type(fe_options_t) :: options
    type(piecewise_t) :: once, twice
    type(disc_t) :: disc
    type(error_t), allocatable :: error

    call read_case('&case tasks = ''geometry'' / &pair module_mm = 3 face_width_mm = 20 / &pinion teeth = 25 /'// &
                   '&gear teeth = 25 /', case, error)
    call check_no_error(t, 'equal gears', error)
    call study_of(t, case, study)
    pair = study%pair
    options%section%rim = 15e-3_dp
    options%section%elements_across = 6
    call fe_stiffness(pair, case%material, options, 280e3_dp, once, disc, error)
    call check_no_error(t, 'equal gears', error)
    pair%gear(2)%spec%bore_radius = 1e-3_dp
    call fe_stiffness(pair, case%material, options, 280e3_dp, twice, disc, error)
    call check_no_error(t, 'the same twice', error)
    call check_true(t, 'equal gears: the same bits', same_bits(reshape(once%coef, [size(once%coef)]), &
                                                               reshape(twice%coef, [size(twice%coef)])))
  end subroutine equal_gears
end module test_selective_evaluation
