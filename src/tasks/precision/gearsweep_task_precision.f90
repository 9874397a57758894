!> The task `precision`: error against run time for the case at hand.
!>
!> The methods of integration at some speeds, the two ways to the harmonics of the static transmission error, and natural
!> frequency, root stress and pair stiffness by finite elements are each computed at several resolutions, and compared
!> with a result that is finer than all of them.
module gearsweep_task_precision
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_decimal, only: in_um
  use gearsweep_error, only: error_t
  use gearsweep_kinds, only: dp, pi
  use gearsweep_lines, only: left, lines_t, right
  use gearsweep_memory, only: claim_memory
  use gearsweep_reader, only: reader_t
  use gearsweep_status, only: has_result, status_name
  use gearsweep_stop, only: wants_stop
  use gearsweep_table, only: axis, no_number, table_t
  use gearsweep_stages, only: runnable_t, stages_t
  use gearsweep_task, only: stage, task_info_t
  use gearsweep_text, only: str
  use gearsweep_trials, only: least_elements, least_samples, least_steps, result_t, trials_t, try_grids, try_harmonics, &
                              try_methods
  use gearsweep_uses, only: is_prescribed, needs_gears, sentence_length, unless
  implicit none
  private
  public :: precision_task_t

  type, extends(runnable_t) :: precision_task_t
    integer :: most_steps = 1600, most_samples = 4096, most_elements = 12
    integer :: harmonics = 3, modes = 3
    logical :: has_gears = .true.                !< there are grids
  contains
    procedure, nopass :: describe
    procedure :: read_keys, run, add_report
    procedure :: uses, count_points => no_points
  end type precision_task_t

  character(*), parameter :: group = 'precision'

contains

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t(group, needs=[stage%mesh, stage%reliefs, stage%amounts, stage%motion, stage%losses, stage%section, &
                                     stage%body], &
                       tables='precision precision_finest', fields='', &
                       gives='error against run time of the methods of integration over their steps, of harmonics over '// &
                       'samples, and of finite elements over their grids')
  end subroutine describe

  subroutine read_keys(self, reader, error)
    class(precision_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    type(error_t), allocatable, intent(inout) :: error
    character(sentence_length) :: geared

    self%has_gears = .not. is_prescribed(reader)
    geared = unless(self%has_gears, needs_gears)
    call reader%add_group(group, 'The task precision, at some speeds and reliefs.')
    call reader%get(group, 'rpm', self%own_rpm, error, unit='1/min', tasks=group, at_least=1e-6_dp, at_most=1e9_dp, &
                    max_size=1000, distinct=.true., otherwise='where the mesh frequency is the natural frequency', &
                    meaning='speeds of the pinion')
    call self%read_reliefs(reader, group, error)
    call reader%get(group, 'most_steps', self%most_steps, error, tasks=group, at_least=2*least_steps, at_most=2**16, &
                    meaning='most steps of a mesh period; they are halved down to 25. The reference has four times as many')
    call reader%get(group, 'most_samples', self%most_samples, error, tasks=group, at_least=2*least_samples, at_most=2**24, &
                    meaning='most samples of the static transmission error for the Fourier transform; they are halved down to 16')
    call reader%get(group, 'harmonics', self%harmonics, error, tasks=group, at_least=1, at_most=100, &
                    meaning='harmonics of the static transmission error to compare')
    call reader%get(group, 'most_elements', self%most_elements, error, tasks=group, refused=geared, at_least=least_elements + 1, &
                    at_most=50, &
                    meaning='most elements across the loaded tooth, instead of &section elements_across; the reference has '// &
                    'twice as many. Not for a prescribed mesh, which has no grid')
    call reader%get(group, 'modes', self%modes, error, tasks=group, refused=geared, at_least=1, at_most=100, &
                    meaning='natural modes to compare, from the lowest')
  end subroutine read_keys

  !> Without gears there are no grids.
  pure logical function uses(self, which)
    class(precision_task_t), intent(in) :: self
    integer, intent(in) :: which                 !< of `stage`

    uses = any(self%needs == which)
    if (which == stage%section .or. which == stage%body) uses = uses .and. self%has_gears
  end function uses

  !> It solves the same points many times, and tells of none.
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
    associate (stop => stages%accuracy%steady%stop, motion => stages%motion, amount => in_um(stages%amount))
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

  !> A row for each result; references have neither error nor run time.
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
      'speed, from the reference''s motion on, with the coefficients tabulated before. Harmonics and modes: all numbers '// &
      'together. Elements: with making and factoring the grids', [list%seconds])
  end subroutine fill

  !> What each method reaches at the first speed and relief, and the resolution that it needs for some errors. Times are in
  !> the table, as the screen is the same in every run.
  pure subroutine add_report(self, lines)
    class(precision_task_t), intent(in) :: self
    type(lines_t), intent(inout) :: lines
    logical, allocatable :: is_new(:), mine(:)
    character(:), allocatable :: place
    integer :: i

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
        call lines%add('   quantity            method           1e-2     1e-4     1e-6    finest      error   estimate')
        is_new = is_first
        do i = 1, table%rows
          if (.not. is_new(i)) cycle
          mine = is_first .and. quantity == quantity(i) .and. method == method(i)
          is_new = is_new .and. .not. mine
          call lines%put('   '//left(trim(quantity(i)), 20)//left(trim(method(i)), 12))
          call add_line(nint(pack(table%numbers('resolution'), mine)), pack(table%numbers('error'), mine), &
                        pack(table%numbers('error_estimate'), mine), lines)
        end do
      end associate
    end associate
  end subroutine add_report

  !> Where values are the first that is a number, or NaN.
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

  !> One quantity by one method, from the coarsest on.
  pure subroutine add_line(resolution, error, estimate, lines)
    integer, intent(in) :: resolution(:)
    real(dp), intent(in) :: error(:), estimate(:)
    type(lines_t), intent(inout) :: lines
    real(dp), parameter :: bounds(3) = [1e-2_dp, 1e-4_dp, 1e-6_dp]
    integer :: i, k, n

    n = size(resolution)
    do k = 1, size(bounds)
      do i = n, 1, -1
        if (ieee_is_nan(error(i))) exit
        if (error(i) > bounds(k)) exit
      end do
      if (i == n) call lines%put(right('-', 9))
      if (i < n) call lines%put(right(str(resolution(i + 1)), 9))
    end do
    call lines%put(right(str(resolution(n)), 10)//right(str(error(n), 2), 11))
    if (ieee_is_nan(estimate(n))) call lines%add(right('none', 11))
    if (.not. ieee_is_nan(estimate(n))) call lines%add(right(str(estimate(n), 2), 11))
  end subroutine add_line
end module gearsweep_task_precision
