!> The task `precision`: error against run time of several methods at several resolutions.
!>
!> Methods of integration at some speeds, two methods for the harmonics of the static transmission error, and natural frequency,
!> root stress and pair stiffness by finite elements are each computed at several resolutions, and compared with a result of finer
!> resolution than all of them.
module gearsweep_study_tasks_precision
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use, intrinsic :: iso_c_binding, only: c_ptr
  use gearsweep_base, only: axis, claim_memory, dp, error_t, left, lines_t, no_number, pi, piecewise_t, right, stopwatch_t, &
    str, table_t, wants_stop
  use gearsweep_elastic, only: disc_t, fe_stiffness, make_two_grids, modal_t, root_stress, root_stress_t, section_body_t, &
    section_modes, section_options_t
  use gearsweep_mesh, only: find_harmonics, harmonics_t, interval_t, mesh_t, smooth_intervals, transmission_error
  use gearsweep_motion, only: accuracy_t, has_result, levels_t, mesh_period, oscillator_t, point_t, scheme_collocation, &
    scheme_constant, scheme_rk4, scheme_rk4_equal, solve_point, status_inexact, status_name, status_ok
  use gearsweep_rating, only: outer_point
  use gearsweep_study_case_task, only: stage, task_info_t
  use gearsweep_study_reader_reader, only: is_prescribed, needs_gears, reader_t, sentence_length, text_unless
  use gearsweep_study_run_inputs, only: elements_inputs_t
  use gearsweep_study_run_stages, only: runnable_t, stages_t
  implicit none
  private
  public :: precision_task_t

  integer, parameter :: word = 18

  !> One result; if a reference, without error and run time.
  type :: result_t
    character(word) :: quantity = '', method = ''
    integer :: number = 1                        !< index of the harmonic or mode
    real(dp) :: relief = -1, rpm = -1            !< relief, m, and speed, 1/min; below 0: no effect
    character(4) :: unit = ''
    integer :: resolution = 0
    real(dp) :: value = 0                        !< value in this unit
    real(dp) :: error = 0, estimate = 0          !< relative error and its estimate
    real(dp) :: seconds = 0
    integer :: status = status_ok
  end type result_t

  !> Lists of results; of each the first elements are in use.
  type :: trials_t
    type(result_t), allocatable :: results(:), references(:)
    integer :: result_count = 0, reference_count = 0
  end type trials_t

  integer, parameter, public :: least_steps = 25, least_samples = 16, least_elements = 3
  integer, parameter :: schemes(4) = [scheme_collocation, scheme_rk4, scheme_rk4_equal, scheme_constant]
  character(*), parameter :: names(4) = [character(word) :: 'collocation', 'rk4', 'rk4_equal', 'constant']

  type, extends(runnable_t) :: precision_task_t
    integer :: most_steps = 1600, most_samples = 4096, most_elements = 12
    integer :: harmonics = 3, modes = 3
    logical :: has_gears = .true.                !< true if there are grids
  contains
    procedure, nopass :: describe
    procedure :: read_keys, run, add_report
    procedure :: uses, count_points => no_points
  end type precision_task_t

  character(*), parameter :: group = 'precision'
  integer, parameter :: time_width = 9

contains

  !> Computes the dynamic factor by all methods, each from the motion of the reference, so that all find the same motion.
  subroutine try_methods(osc, rpm, relief, most_steps, stop, trials)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm, relief          !< speed, 1/min, and relief, m
    integer, intent(in) :: most_steps
    type(c_ptr), intent(in) :: stop              !< flag that ends the run
    type(trials_t), intent(inout) :: trials
    ! The error of Newton's method must be negligible.
    real(dp), parameter :: closed = 1e-11_dp
    type(accuracy_t) :: options
    type(levels_t), allocatable :: levels
    type(point_t) :: truth, point
    type(stopwatch_t) :: watch
    type(result_t) :: found
    integer :: i

    found = result_t('dynamic_factor', 'collocation', relief=relief, rpm=rpm, resolution=4*most_steps)
    options%steady%tolerance = closed
    options%steady%stop = stop
    options%steps = found%resolution
    allocate (levels)
    call solve_point(osc, mesh_period(osc%mesh%teeth(1), rpm), options, levels, truth)
    call note(truth)
    call append(found, trials%references, trials%reference_count)
    if (.not. has_result(found%status)) return
    do i = 1, size(schemes)
      options%scheme = schemes(i)
      options%steps = fewest(most_steps, least_steps)
      do while (options%steps <= most_steps)
        if (wants_stop(stop)) return
        found%method = names(i)
        found%resolution = options%steps
        deallocate (levels)
        allocate (levels)
        ! The coefficients are tabulated once, as in a sweep, and so before the timed runs.
        call solve_point(osc, mesh_period(osc%mesh%teeth(1), rpm), options, levels, point, truth%steady%state)
        watch = stopwatch_t()
        do while (watch%goes_on())
          call solve_point(osc, mesh_period(osc%mesh%teeth(1), rpm), options, levels, point, truth%steady%state)
        end do
        found%seconds = watch%shortest
        call note(point)
        found%error = abs(found%value/truth%dynamic_factor - 1)
        call append(found, trials%results, trials%result_count)
        options%steps = 2*options%steps
      end do
    end do

  contains

    !> Stores the result of a point; no method has a tolerance to keep.
    subroutine note(point)
      type(point_t), intent(in) :: point
      real(dp), parameter :: no_estimate = 1e3_dp

      found%status = point%steady%status
      if (found%status == status_inexact) found%status = status_ok
      found%value = no_number()
      found%estimate = no_number()
      if (.not. has_result(found%status)) return
      found%value = point%dynamic_factor
      if (ieee_is_nan(point%estimate)) return
      if (point%estimate < no_estimate) found%estimate = point%estimate/point%dynamic_factor
    end subroutine note
  end subroutine try_methods

  !> Computes amplitudes of the static transmission error, by integration over its smooth intervals and by the Fourier transform of
  !> equally spaced samples.
  subroutine try_harmonics(osc, relief, harmonics, most_samples, trials)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: relief               !< amount of relief, m
    integer, intent(in) :: harmonics, most_samples
    type(trials_t), intent(inout) :: trials
    integer, parameter :: most_halvings = 4
    real(dp), parameter :: nothing = 1e-12_dp    ! relative to the mean
    type(harmonics_t) :: truth, part
    type(stopwatch_t) :: watch
    real(dp) :: scale, amplitude(harmonics)
    integer :: i, samples

    call find_harmonics(osc%mesh, osc%load, harmonics, truth)
    scale = max(maxval(truth%amplitude), nothing*abs(truth%mean))
    samples = 0
    do i = 0, most_halvings
      watch = stopwatch_t()
      do while (watch%goes_on())
        call find_harmonics(osc%mesh, osc%load, harmonics, part, halvings=i)
      end do
      if (part%samples == samples) exit
      samples = part%samples
      call add('segments', part%amplitude, part%error_estimate)
    end do
    samples = fewest(most_samples, least_samples)
    do while (samples <= most_samples)
      watch = stopwatch_t()
      do while (watch%goes_on())
        call transform(osc%mesh, osc%load, samples, amplitude)
      end do
      call add('fft', amplitude, no_number())
      samples = 2*samples
    end do
    do i = 1, harmonics
      call append(result_t('ste_harmonic', 'segments', i, relief, -1.0_dp, 'um', truth%samples, 1e6_dp*truth%amplitude(i), &
                           estimate=truth%error_estimate/scale), trials%references, trials%reference_count)
    end do

  contains

    subroutine add(method, amplitude, estimate)
      character(*), intent(in) :: method
      real(dp), intent(in) :: amplitude(:), estimate
      integer :: k

      do k = 1, size(amplitude)
        ! So few samples do not resolve this harmonic.
        if (ieee_is_nan(amplitude(k))) cycle
        call append(result_t('ste_harmonic', method, k, relief, -1.0_dp, 'um', samples, 1e6_dp*amplitude(k), &
                             abs(amplitude(k) - truth%amplitude(k))/scale, estimate/scale, watch%shortest), &
                    trials%results, trials%result_count)
      end do
    end subroutine add
  end subroutine try_harmonics

  !> Amplitudes (m) of the first harmonics of the static transmission error from equally spaced samples, as by a fast Fourier
  !> transform; NaN for those with at most two samples in a period.
  pure subroutine transform(mesh, load, samples, amplitude)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: load                 !< static load, N
    integer, intent(in) :: samples
    real(dp), intent(out) :: amplitude(:)
    type(interval_t), allocatable :: intervals(:)
    complex(dp) :: total(size(amplitude)), turn, term
    integer :: i, k, n

    intervals = smooth_intervals(mesh, .false.)
    total = 0
    n = 1
    do i = 0, samples - 1
      associate (phase => real(i, dp)/samples)
        do while (n < size(intervals) .and. phase >= intervals(n)%last)
          n = n + 1
        end do
        turn = exp(cmplx(0.0_dp, -2*pi*phase, dp))
        term = 2*transmission_error(mesh, intervals(n), load, phase)/samples
      end associate
      do k = 1, size(total)
        term = term*turn
        total(k) = total(k) + term
      end do
    end do
    amplitude = abs(total)
    do k = 1, size(amplitude)
      if (2*k >= samples) amplitude(k) = no_number()
    end do
  end subroutine transform

  !> Computes results by finite elements, the reference first: on grids of twice as many elements across.
  subroutine try_grids(stages, most_elements, modes, trials, error)
    type(stages_t), intent(in) :: stages         !< with a pair of gears
    integer, intent(in) :: most_elements, modes
    type(trials_t), intent(inout) :: trials
    type(error_t), allocatable, intent(inout) :: error
    type(result_t), allocatable :: truth(:), found(:)
    integer :: across(6), i, k

    across = [2*most_elements, most_elements/4, (3*most_elements)/8, most_elements/2, &
              (3*most_elements)/4, most_elements]
    do i = 1, size(across)
      if (across(i) < least_elements .or. wants_stop(stages%accuracy%steady%stop)) cycle
      call solve_grids(stages, across(i), modes, merge(1, 3, i == 1), found, error)
      if (allocated(error)) error%message = '&precision most_elements = '//str(most_elements)//': '//error%message
      if (allocated(error)) return
      if (i == 1) then
        call move_alloc(found, truth)
        cycle
      end if
      found%error = abs(found%value/truth%value - 1)
      do k = 1, size(found)
        call append(found(k), trials%results, trials%result_count)
      end do
    end do
    if (.not. allocated(found)) return
    ! The pair stiffness has no estimate of its own: as for the other results, it comes from half the refinement.
    where (truth%quantity == 'pair_stiffness') truth%estimate = found%error/3
    do k = 1, size(truth)
      call append(truth(k), trials%references, trials%reference_count)
    end do
  end subroutine try_grids

  !> Computes all results on grids of this refinement. A result needs its two grids and their solutions.
  subroutine solve_grids(stages, across, modes, laps, found, error)
    type(stages_t), intent(in) :: stages
    integer, intent(in) :: across, modes
    integer, intent(in) :: laps                  !< least number of timed runs, of which the shortest counts
    type(result_t), allocatable, intent(out) :: found(:)
    type(error_t), allocatable, intent(inout) :: error
    type(section_options_t) :: options
    type(section_body_t) :: grids(2)
    type(modal_t) :: modal
    type(root_stress_t) :: stress
    type(stopwatch_t) :: making, vibrating, loading, watch
    integer :: i
    type(elements_inputs_t) :: inputs
    type(piecewise_t) :: curve
    type(disc_t) :: disc

    making = stopwatch_t(fewest=laps)
    vibrating = making
    loading = making
    options = stages%body_inputs%options
    options%elements_across = across
    do while (making%goes_on())
      call make_two_grids(stages%body_inputs%gear, stages%body_inputs%material, options, grids, error)
      if (allocated(error)) return
    end do
    do while (vibrating%goes_on())
      call section_modes(grids, modes, modal, error)
      if (allocated(error)) return
    end do
    do while (loading%goes_on())
      call root_stress(grids, [outer_point(stages%pair, stages%gear)], &
                       [stages%load/minval(stages%pair%gear%spec%face_width)], stress, error)
      if (allocated(error)) return
    end do
    found = [(result_t('natural_frequency', 'elements', i, -1.0_dp, -1.0_dp, 'Hz', across, modal%modes%frequency(i), &
                       estimate=modal%error_estimate(i), seconds=making%shortest + vibrating%shortest), i=1, modes), &
             result_t('root_tension', 'elements', 1, -1.0_dp, -1.0_dp, 'MPa', across, 1e-6_dp*stress%tension%stress, &
                      estimate=stress%error_estimate, seconds=making%shortest + loading%shortest)]
    if (allocated(stages%elements_inputs)) then
      inputs = stages%elements_inputs
      inputs%options%section%elements_across = across
      inputs%options%section%others_across = min(4, across)
      watch = stopwatch_t(fewest=laps)
      do while (watch%goes_on())
        call fe_stiffness(inputs%pair, inputs%material, inputs%options, inputs%line_load, curve, disc, error)
        if (allocated(error)) return
      end do
      found = [found, result_t('pair_stiffness', 'elements', 1, -1.0_dp, -1.0_dp, 'N/um', across, &
                               1e-6_dp*curve%value(stages%pair%contact_ratio/2), estimate=no_number(), seconds=watch%shortest)]
    end if
  end subroutine solve_grids

  !> Smallest number, at least `least`, that reaches `most` by doubling.
  pure integer function fewest(most, least)
    integer, intent(in) :: most, least

    fewest = most
    do while (mod(fewest, 2) == 0 .and. fewest/2 >= least)
      fewest = fewest/2
    end do
  end function fewest

  !> Appends to a list with `length` elements in use.
  pure subroutine append(one, list, length)
    type(result_t), intent(in) :: one
    type(result_t), allocatable, intent(inout) :: list(:)
    integer, intent(inout) :: length
    type(result_t), allocatable :: larger(:)

    if (.not. allocated(list)) allocate (list(64))
    if (length == size(list)) then
      allocate (larger(2*length))
      larger(:length) = list
      call move_alloc(larger, list)
    end if
    length = length + 1
    list(length) = one
  end subroutine append

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t(group, needs=[stage%mesh, stage%reliefs, stage%amounts, stage%motion, stage%losses, stage%section, &
                                     stage%body], &
                       tables='precision precision_finest', fields='', &
                       summary='error against run time of the methods of integration over their steps, of harmonics over '// &
                       'samples, and of finite elements over their grids')
  end subroutine describe

  subroutine read_keys(self, reader, error)
    class(precision_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    type(error_t), allocatable, intent(inout) :: error
    character(sentence_length) :: geared

    self%has_gears = .not. is_prescribed(reader)
    geared = text_unless(self%has_gears, needs_gears)
    call reader%add_group(group, 'The task precision, at some speeds and reliefs.')
    call reader%get(group, 'rpm', self%own_rpm, error, unit='1/min', tasks=group, at_least=1e-6_dp, at_most=1e9_dp, &
                    max_size=1000, distinct=.true., default_note='where the mesh frequency is the natural frequency', &
                    meaning='speeds of the pinion')
    call self%read_reliefs(reader, group, error)
    call reader%get(group, 'most_steps', self%most_steps, error, tasks=group, at_least=2*least_steps, at_most=2**16, &
                    meaning='most steps of a mesh period; they are halved down to 25. The reference has four times as many')
    call reader%get(group, 'most_samples', self%most_samples, error, tasks=group, at_least=2*least_samples, at_most=2**24, &
                    meaning='most samples of the static transmission error for the Fourier transform; they are halved down to 16')
    call reader%get(group, 'harmonics', self%harmonics, error, tasks=group, at_least=1, at_most=100, &
                    meaning='harmonics of the static transmission error to compare')
    call reader%get(group, 'most_elements', self%most_elements, error, tasks=group, not_allowed=geared, &
                    at_least=least_elements + 1, at_most=50, &
                    meaning='most elements across the loaded tooth, instead of &section elements_across; the reference has '// &
                    'twice as many. Not for a prescribed mesh, which has no grid')
    call reader%get(group, 'modes', self%modes, error, tasks=group, not_allowed=geared, at_least=1, at_most=100, &
                    meaning='natural modes to compare, from the lowest')
  end subroutine read_keys

  !> Without gears there are no grids.
  pure logical function uses(self, which)
    class(precision_task_t), intent(in) :: self
    integer, intent(in) :: which                 !< index of the stage in `stage`

    uses = any(self%needs == which)
    if (which == stage%section .or. which == stage%body) uses = uses .and. self%has_gears
  end function uses

  !> The task solves the same points many times, and reports none of them.
  integer function no_points(self, stages)
    class(precision_task_t), intent(in) :: self
    type(stages_t), intent(in) :: stages

    no_points = 0
    if (.not. self%has_gears .and. allocated(stages%pair)) no_points = 0
  end function no_points

  subroutine run(self, stages, error)
    class(precision_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: rpm(:)
    integer, allocatable :: which(:)
    type(trials_t) :: trials
    integer :: i, k

    associate (motion => stages%motion(1))
      rpm = [60*motion%natural_frequency/(2*pi*motion%mesh%teeth(1))]
    end associate
    if (allocated(self%own_rpm)) rpm = self%own_rpm
    call self%list_reliefs(stages, which)
    call claim_memory(size(which)*(60*size(rpm) + 20.0_dp*self%harmonics)*300, '&precision: '//str(size(which))// &
                      ' reliefs by '//str(size(rpm))//' speeds', error)
    if (allocated(error)) return
    associate (stop => stages%accuracy%steady%stop, motion => stages%motion, amount => stages%amount)
      do i = 1, size(which)
        do k = 1, size(rpm)
          call try_methods(motion(which(i)), rpm(k), amount(which(i)), self%most_steps, stop, trials)
          if (wants_stop(stop)) return
        end do
        call try_harmonics(motion(which(i)), amount(which(i)), self%harmonics, self%most_samples, trials)
      end do
      if (allocated(stages%pair)) call try_grids(stages, self%most_elements, self%modes, trials, error)
      if (allocated(error) .or. wants_stop(stop)) return
    end associate
    self%is_done = .true.
    self%failed = count(.not. has_result(trials%references(:trials%reference_count)%status)) &
                  + count(.not. has_result(trials%results(:trials%result_count)%status))
    self%log = 'precision: '//str(trials%result_count)//' results beside '//str(trials%reference_count)//' references'
    if (.not. allocated(stages%pair)) self%log = self%log//'; grids left out: the mesh is prescribed'
    call fill('results at several resolutions, with their errors and run times', trials%results(:trials%result_count), &
              .false., self%tables(self%place('precision')), error)
    call fill('what the results in the table precision are compared with', trials%references(:trials%reference_count), &
              .true., self%tables(self%place('precision_finest')), error)
  end subroutine run

  !> Fills a row for each result; references have neither error nor run time.
  pure subroutine fill(meaning, list, are_references, table, error)
    character(*), intent(in) :: meaning
    type(result_t), intent(in) :: list(:)
    logical, intent(in) :: are_references
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    character(12) :: status(size(list))
    integer :: i

    call table%begin(meaning, size(list), error)
    if (allocated(error)) return
    do i = 1, size(list)
      status(i) = status_name(list(i)%status)
    end do
    call table%add_index(axis('quantity', '', 'dynamic_factor; ste_harmonic: amplitude of the static transmission error; '// &
                      'natural_frequency; root_tension: the largest under the whole load at the outer point of single contact; '// &
                              'pair_stiffness: in the middle of the path of contact', [list%quantity]))
    call table%add_index(axis('number', '', 'which harmonic or mode; 1 for what is alone', [list%number]))
    call table%add_index(axis('relief_um', 'um', 'tip relief; NaN where it does not matter', &
                              merge(list%relief, no_number(), list%relief >= 0)))
    call table%add_index(axis('rpm', '1/min', 'speed of the pinion; NaN where it does not matter', &
                              merge(list%rpm, no_number(), list%rpm >= 0)))
    call table%add_index(axis('method', '', 'of integration as &numerics method; segments: integration over smooth segments; '// &
                              'fft: Fourier transform of equally spaced samples; elements: finite elements', [list%method]))
    call table%add_index(axis('resolution', '', &
                              'steps of a mesh period, about, as some methods end steps at breaks; samples of '// &
                              'a mesh period; elements across the loaded tooth', [list%resolution]))
    call table%add('value', '', 'the result, in the unit beside it', [list%value])
    call table%add_words('unit', 'of the value; empty for a plain number', [list%unit])
    if (.not. are_references) call table%add('error', '', 'difference to the value in the table precision_finest over '// &
      'that value, or, of harmonics, over the largest amplitude; it says nothing where it is below the error_estimate there', &
      [list%error])
    call table%add('error_estimate', '', 'the method''s own estimate of the error, relative in the same way; NaN: it has '// &
      'none. For pair_stiffness that of the reference alone: a third of the difference to half as many elements', [list%estimate])
    call table%add_words('status', 'ok, or why there is no value, as in the table sweep', status)
    if (.not. are_references) call table%add_times('run_time_s', 'processor time of the calling thread, the shortest of '// &
      'several runs, with the error estimate where the method has one; it differs from run to run. Dynamic factor: one '// &
      'speed, from the reference''s motion on, with the coefficients tabulated before. Harmonics and modes: all of '// &
      'them together. Elements: with building and factoring the grids', [list%seconds])
  end subroutine fill

  !> Reports the error of each method at the first speed and relief, the resolution for some errors, and the run time of the finest
  !> one, rounded.
  pure subroutine add_report(self, lines)
    class(precision_task_t), intent(in) :: self
    type(lines_t), intent(inout) :: lines
    logical, allocatable :: is_new(:), mine(:)
    character(:), allocatable :: place
    integer :: i, k, n, last
    real(dp), parameter :: bounds(3) = [1e-2_dp, 1e-4_dp, 1e-6_dp]

    associate (table => self%tables(self%place('precision')))
      associate (quantity => table%columns(table%position('quantity'))%words, &
                 method => table%columns(table%position('method'))%words, &
                 is_first => nint(table%numbers('number')) == 1 .and. is_same(table%numbers('relief_um')) .and. &
                             is_same(table%numbers('rpm')))
        call lines%add('')
        place = ''
        if (.not. ieee_is_nan(table%number('rpm', 1))) &
          place = ' at '//str(table%number('rpm', 1))//' rpm, relief '//str(table%number('relief_um', 1))//' um'
        call lines%add('Precision'//place//': resolution needed for relative errors, and what the finest has')
        call lines%add('   quantity            method           1e-2     1e-4     1e-6    finest      error   estimate'// &
                       right('time', time_width))
        is_new = is_first
        do i = 1, table%rows
          if (.not. is_new(i)) cycle
          mine = is_first .and. quantity == quantity(i) .and. method == method(i)
          is_new = is_new .and. .not. mine
          ! The coarsest resolution comes first.
          call lines%put('   '//left(trim(quantity(i)), 20)//left(trim(method(i)), 12))
          associate (resolution => nint(pack(table%numbers('resolution'), mine)), error => pack(table%numbers('error'), mine), &
                     estimate => pack(table%numbers('error_estimate'), mine))
            n = size(resolution)
            do k = 1, size(bounds)
              do last = n, 1, -1
                if (ieee_is_nan(error(last))) exit
                if (error(last) > bounds(k)) exit
              end do
              if (last == n) call lines%put(right('-', 9))
              if (last < n) call lines%put(right(str(resolution(last + 1)), 9))
            end do
            call lines%put(right(str(resolution(n)), 10)//right(str(error(n), 2), 11))
            if (ieee_is_nan(estimate(n))) call lines%put(right('none', 11))
            if (.not. ieee_is_nan(estimate(n))) call lines%put(right(str(estimate(n), 2), 11))
          end associate
          call lines%add(right(trim(rounded_time(table%number('run_time_s', findloc(mine, .true., 1, back=.true.)))), time_width))
        end do
      end associate
    end associate
  end subroutine add_report

  !> True for each value that equals the first one that is a number, or is NaN itself.
  pure function is_same(values)
    real(dp), intent(in) :: values(:)
    logical :: is_same(size(values))
    integer :: i, first

    first = findloc(ieee_is_nan(values), .false., 1)
    is_same = .true.
    do i = 1, size(values)
      if (.not. ieee_is_nan(values(i))) is_same(i) = .not. abs(values(i) - values(first)) > 0
    end do
  end function is_same

  !> Formats a time in s to one digit, in us, ms or s: further digits differ from run to run.
  pure function rounded_time(seconds) result(words)
    real(dp), intent(in) :: seconds
    character(12) :: words
    character(2), parameter :: units(3) = [character(2) :: 'us', 'ms', 's']
    real(dp) :: microseconds
    integer :: power, unit

    words = 'none'
    if (.not. seconds > 0) return
    microseconds = max(1.0_dp, 1e6_dp*seconds)
    power = floor(log10(microseconds))
    microseconds = nint(microseconds/10.0_dp**power)*10.0_dp**power
    unit = min(3, 1 + int(log10(1.0000001_dp*microseconds))/3)
    words = str(nint(microseconds/1000.0_dp**(unit - 1)))//' '//trim(units(unit))
  end function rounded_time
end module gearsweep_study_tasks_precision
