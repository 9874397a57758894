!> Scenes that leave something out, beside the same scenes with it, for bench/scenes.py.
!>
!>     scenes PRESCRIBED PAIR SECTION
!>
!> Three cases: a prescribed mesh, a pair with all that follows from it, a section. For each scene
!> a line: its name, the seconds (medians) without and with what may be left out, the largest
!> relative difference of the answers, what it may be. One thread. Stops where it is more.
program scenes
  use bench_tools, only: word, seconds, median, check
  use gearsweep, only: dp, case_t, disc_t, study_t, oscillator_t, error_t, pair_t, read_case, run_study, &
                       fe_options_t, fe_stiffness
  use gearsweep_motion_resolution, only: resolution_t
  use gearsweep_motion_contact_set, only: period_t
  use gearsweep_motion_gauss, only: batch_size
  use gearsweep_motion_oscillator, only: mesh_period
  use gearsweep_motion_period, only: run_batch, run_full_contact
  use gearsweep_motion_period_map, only: discretise, period_map_t, set_durations
  use gearsweep_motion_periodic_orbit, only: newton_step
  use gearsweep_study_case_case, only: speeds
  use gearsweep_study_reader_edit, only: change_key
  use gearsweep_study_run_files, only: read_text
  use gearsweep_base_piecewise, only: piecewise_t
  use gearsweep_api_tables, only: column_of
  implicit none

  !> Numbers of a scene, and by how much they may be off; 0: not a bit.
  type :: answer_t
    real(dp), allocatable :: value(:), slack(:)
  end type answer_t

  abstract interface
    subroutine scene_i(full, answer)
      import :: answer_t
      logical, intent(in) :: full
      type(answer_t), intent(out) :: answer
    end subroutine scene_i
  end interface

  character(*), parameter :: everything(*) = [character(8) :: 'geometry', 'mesh', 'static', 'modal', 'load', 'sweep', &
                                              'optimum']
  type(case_t) :: prescribed, pair_case, section
  type(oscillator_t), allocatable :: osc(:)
  type(study_t) :: of_pair
  type(pair_t) :: pair
  type(period_map_t) :: map
  real(dp) :: duration(batch_size)
  real(dp), allocatable :: best(:)                 ! relief, m

  call get_case(word(1), prescribed)
  call get_case(word(2), pair_case)
  call get_case(word(3), section)
  call prepare()

  call compare('geometry', geometry_alone, 5, [1000, 1])
  call compare('speed', one_speed, 21, [10, 1])
  call compare('friction', no_friction, 11, [1, 1])
  call compare('relief', no_relief, 21, [1, 1])
  call compare('coast', no_coast, 11, [1, 1])
  call compare('contact', no_loss, 21, [1000, 1000])
  call compare('reliefs', one_relief, 5, [1, 1])
  call compare('optimum', known_optimum, 21, [1, 1])
  call compare('gears', equal_gears, 21, [1, 1])
  call compare('stiffness', known_stiffness, 11, [1, 1])
  call compare('modes', modes_alone, 5, [1, 1])
  call compare('mode', one_mode, 5, [1, 1])
  call compare('stress', stress_alone, 5, [1, 1])
  call compare('body', one_body, 5, [1, 1])

contains

  subroutine get_case(path, case)
    character(*), intent(in) :: path
    type(case_t), intent(out) :: case
    type(error_t), allocatable :: error
    character(:), allocatable :: text

    call read_text(path, text, error)
    call check(error)
    call read_case(text, case, error)
    call check(error)
    if (allocated(case%published)) deallocate (case%published)
  end subroutine get_case

  !> What scenes start from: made once, outside what is timed.
  subroutine prepare()
    type(case_t) :: case
    type(study_t) :: study
    real(dp) :: all(327)
    integer :: l

    case = prescribed
    call run(case, ['mesh'], study)
    osc = study%motion
    all = speeds(case)
    duration = mesh_period(osc(1)%mesh%teeth(1), [(all(160 + l), l=1, batch_size)])
    call discretise(osc(1), resolution_t(16.0_dp, 2), map)
    call run(case, ['optimum'], study)
    best = 1e-6_dp*column_of(study, 'optimum', 'relief_um')
    call run(pair_case, ['mesh'], of_pair)
    pair = of_pair%pair
  end subroutine prepare

  !> Takes both ways in turn, so that a busy machine slows both alike, each so many `times` in a row.
  subroutine compare(name, scene, rounds, times)
    character(*), intent(in) :: name
    procedure(scene_i) :: scene
    integer, intent(in) :: rounds, times(2)
    type(answer_t) :: answer(2)
    real(dp) :: taken(rounds, 2), from
    integer :: i, way, k

    do i = 1, rounds
      do way = 1, 2
        from = seconds()
        do k = 1, times(way)
          call scene(way == 2, answer(way))
        end do
        taken(i, way) = (seconds() - from)/times(way)
      end do
    end do
    associate (off => abs(answer(1)%value - answer(2)%value), slack => answer(1)%slack + answer(2)%slack, &
               unit => max(abs(answer(2)%value), tiny(from)))
      print '(a, 1x, *(g0, 1x))', name, median(taken(:, 1)), median(taken(:, 2)), maxval(off/unit), maxval(slack/unit)
      if (any(.not. off <= slack)) error stop 'the answers differ'
    end associate
  end subroutine compare

  !> Runs these tasks.
  subroutine run(case, tasks, study, known)
    type(case_t), intent(in) :: case
    character(*), intent(in) :: tasks(:)
    type(study_t), intent(out) :: study
    type(study_t), intent(in), optional :: known
    type(case_t) :: wanted
    type(error_t), allocatable :: error

    wanted = case
    call wanted%request(tasks)
    call run_study(wanted, '', 1, study, error, earlier=known)
    call check(error)
  end subroutine run

  !> To the last bit, or within a relative error.
  pure function exact(value, relative) result(answer)
    real(dp), intent(in) :: value(:)
    real(dp), intent(in), optional :: relative
    type(answer_t) :: answer

    answer%value = value
    answer%slack = 0*value
    if (present(relative)) answer%slack = relative*abs(value)
  end function exact

  !> Dynamic factors, to the tolerance asked for.
  subroutine sweep_of(case, answer, known)
    type(case_t), intent(in) :: case
    type(answer_t), intent(out) :: answer
    type(study_t), intent(in), optional :: known
    type(study_t) :: study

    call run(case, ['sweep'], study, known)
    answer%value = column_of(study, 'sweep', 'dynamic_factor')
    answer%slack = 0*answer%value + case%accuracy%steady%tolerance
  end subroutine sweep_of

  subroutine geometry_alone(full, answer)
    logical, intent(in) :: full
    type(answer_t), intent(out) :: answer
    type(study_t) :: study

    if (full) then
      call run(pair_case, everything, study)
    else
      call run(pair_case, ['geometry'], study)
    end if
    associate (p => study%pair)
      answer = exact([p%contact_ratio, p%centre_distance, p%base_pitch, p%working_angle, p%backlash, p%gear%tip_radius, &
                      p%gear%root_radius, p%gear(1)%form_radius, p%gear(2)%form_radius])
    end associate
  end subroutine geometry_alone

  !> The steps at a speed follow from those of its neighbours, and so do the last digits.
  subroutine one_speed(full, answer)
    logical, intent(in) :: full
    type(answer_t), intent(out) :: answer
    type(case_t) :: case
    type(answer_t) :: swept
    integer :: n, i

    case = prescribed
    if (.not. full) case%rpm_first = 10000
    if (.not. full) case%rpm_last = 10000
    call sweep_of(case, swept)
    n = size(speeds(case))
    answer%value = [(swept%value(n*(i - 1) + merge(161, 1, full)), i=1, size(case%amount))]
    answer%slack = [(swept%slack(n*(i - 1) + merge(161, 1, full)), i=1, size(case%amount))]
  end subroutine one_speed

  !> A coefficient that changes no digit, but takes the way of a friction that does.
  subroutine no_friction(full, answer)
    logical, intent(in) :: full
    type(answer_t), intent(out) :: answer
    type(case_t) :: case

    case = prescribed
    case%spec(2)%teeth = case%spec(1)%teeth
    if (full) case%friction = 1e-30_dp
    call sweep_of(case, answer)
  end subroutine no_friction

  !> A relief that changes no digit, but has its breaks.
  subroutine no_relief(full, answer)
    logical, intent(in) :: full
    type(answer_t), intent(out) :: answer
    type(case_t) :: case

    case = prescribed
    case%amount = [merge(1e-30_dp, 0.0_dp, full)]
    case%start = 'pitch'
    call sweep_of(case, answer)
  end subroutine no_relief

  !> A backlash that no motion comes through.
  subroutine no_coast(full, answer)
    logical, intent(in) :: full
    type(answer_t), intent(out) :: answer
    type(case_t) :: case

    case = prescribed
    case%has_backlash = full
    case%backlash = 1
    call sweep_of(case, answer)
    answer%slack = 0
  end subroutine no_coast

  !> Eight speeds with all pairs in contact: period map, then the motion with or without making the
  !> steps' propagators again.
  subroutine no_loss(full, answer)
    logical, intent(in) :: full
    type(answer_t), intent(out) :: answer
    type(period_t) :: one(batch_size)
    real(dp) :: from(2, batch_size)
    logical :: solved, open(batch_size)
    integer :: l

    open = .true.
    from = 0
    call set_durations(map, duration)
    call run_full_contact(map, from, one)
    do l = 1, batch_size
      call newton_step(one(l)%monodromy, one(l)%state, from(:, l), solved)
    end do
    if (full) call set_durations(map, duration)
    call run_batch(map, from, open, .true., one)
    if (any(one%partial)) error stop 'no_loss: a pair parts'
    answer = exact([one%peak])
  end subroutine no_loss

  !> Ten times the speeds, one relief of five.
  subroutine one_relief(full, answer)
    logical, intent(in) :: full
    type(answer_t), intent(out) :: answer
    type(case_t) :: case

    case = prescribed
    case%rpm_step = case%rpm_step/10
    if (.not. full) case%amount = case%amount(4:4)
    call sweep_of(case, answer)
    associate (n => size(speeds(case)))
      if (full) answer%value = answer%value(3*n + 1:4*n)
      answer%slack = answer%slack(:n)
    end associate
  end subroutine one_relief

  !> The best relief is known, or searched for.
  subroutine known_optimum(full, answer)
    logical, intent(in) :: full
    type(answer_t), intent(out) :: answer
    type(case_t) :: case
    type(study_t) :: study

    case = prescribed
    if (full) then
      call run(case, ['optimum'], study)
      answer%value = column_of(study, 'optimum', 'worst_dynamic_factor')
    else
      case%amount = best
      call run(case, ['sweep'], study)
      answer%value = [maxval(column_of(study, 'sweep', 'dynamic_factor'))]
    end if
    ! The search is for a dynamic factor to 1e-5.
    answer%slack = [1e-5_dp]
  end subroutine known_optimum

  !> A bore that the rim does not reach makes the gears unequal and changes nothing.
  subroutine equal_gears(full, answer)
    logical, intent(in) :: full
    type(answer_t), intent(out) :: answer
    type(piecewise_t) :: curve
    type(disc_t) :: disc
    type(fe_options_t) :: options
    type(error_t), allocatable :: error
    type(pair_t) :: gears
    integer :: i

    gears = pair
    if (full) gears%gear(2)%spec%bore_radius = 1e-3_dp
    options%section%rim = 5*gears%gear(1)%spec%module
    call fe_stiffness(gears, pair_case%material, options, pair_case%line_load, curve, disc, error)
    call check(error)
    answer = exact([(curve%value(pair%contact_ratio*i/100), i=0, 100)])
  end subroutine equal_gears

  !> Only the reliefs change; the teeth do not.
  subroutine known_stiffness(full, answer)
    logical, intent(in) :: full
    type(answer_t), intent(out) :: answer

    if (full) call sweep_of(pair_case, answer)
    if (.not. full) call sweep_of(pair_case, answer, of_pair)
    answer%slack = 0
  end subroutine known_stiffness

  subroutine modes_alone(full, answer)
    logical, intent(in) :: full
    type(answer_t), intent(out) :: answer
    type(study_t) :: study

    if (full) call run(section, [character(8) :: 'static', 'modal', 'mesh'], study)
    if (.not. full) call run(section, ['modal'], study)
    answer = exact([column_of(study, 'modal', 'frequency_hz'), column_of(study, 'modal', 'error_estimate')])
  end subroutine modes_alone

  !> Frequencies err by the square of what the shapes do, 1e-9, and by rounding.
  subroutine one_mode(full, answer)
    logical, intent(in) :: full
    type(answer_t), intent(out) :: answer
    type(case_t) :: case
    type(study_t) :: study
    type(error_t), allocatable :: error
    character(:), allocatable :: text

    call change_key(section%text, 'modal', 'modes', trim(merge('10', '1 ', full)), text, error)
    call check(error)
    call read_case(text, case, error)
    call check(error)
    if (allocated(case%published)) deallocate (case%published)
    call run(case, ['modal'], study)
    associate (frequency => column_of(study, 'modal', 'frequency_hz'))
      answer = exact(frequency(:1), 1e-11_dp)
    end associate
  end subroutine one_mode

  subroutine stress_alone(full, answer)
    logical, intent(in) :: full
    type(answer_t), intent(out) :: answer
    type(study_t) :: study

    if (full) call run(section, [character(6) :: 'static', 'modal'], study)
    if (.not. full) call run(section, ['static'], study)
    answer = exact([column_of(study, 'static', 'sigma_mpa'), column_of(study, 'root_stress', 'tension_mpa'), &
                    column_of(study, 'root_stress', 'compression_mpa'), column_of(study, 'root_stress', 'error_estimate')])
  end subroutine stress_alone

  !> Stress and modes of one case, or each by a case of its own.
  subroutine one_body(full, answer)
    logical, intent(in) :: full
    type(answer_t), intent(out) :: answer
    type(study_t) :: stress, modes

    if (full) then
      call run(section, ['static'], stress)
      call run(section, ['modal'], modes)
    else
      call run(section, [character(6) :: 'static', 'modal'], stress)
      modes = stress
    end if
    answer = exact([column_of(stress, 'static', 'sigma_mpa'), column_of(modes, 'modal', 'frequency_hz'), &
                    column_of(modes, 'modal', 'error_estimate')])
  end subroutine one_body
end program scenes
