!> The task `poincare`: the motion once a mesh period, and its largest Lyapunov exponent (see gearsweep_motion_poincare).
module gearsweep_nonlinear_task_poincare
  use gearsweep_base, only: axis, claim_memory, code_input, code_memory, dp, error_t, fail, left, lines_t, right, str, table_t
  use gearsweep_motion, only: sample_section, section_points_t, status_chaotic, status_chatter, status_name, status_stopped, &
    status_unbounded, status_unresolved
  use gearsweep_study, only: reader_t, runnable_t, stage, stages_t, task_info_t
  implicit none
  private
  public :: poincare_task_t

  type, extends(runnable_t) :: poincare_task_t
    integer :: periods_before = 500, kept = 400        !< mesh periods
    logical :: at_rest = .true.                  !< true: the motion begins at rest under the static load
    real(dp) :: start(2) = 0                     !< initial state, m and m/s
  contains
    procedure, nopass :: describe
    procedure :: read_keys, run, add_report
  end type poincare_task_t

  character(*), parameter :: group = 'poincare'

contains

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t(group, needs=[stage%mesh, stage%reliefs, stage%amounts, stage%motion, stage%losses, stage%speeds], &
                       tables='poincare lyapunov', fields='', &
                       summary='the motion seen once a mesh period, and its largest Lyapunov exponent')
  end subroutine describe

  subroutine read_keys(self, reader, error)
    class(poincare_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    type(error_t), allocatable, intent(inout) :: error
    real(dp), parameter :: far = 1e9_dp
    character(*), parameter :: at_rest = 'at rest under the static load'
    logical :: has(2)

    call reader%add_group(group, 'The task poincare, over the speeds of &sweep or its own.')
    call self%read_speeds(reader, group, error, order='in the order followed: at each further one the motion starts where '// &
                          'it was at the one before')
    call self%read_reliefs(reader, group, error)
    call reader%get(group, 'settling_periods', self%periods_before, error, tasks=group, at_least=0, at_most=10**7, &
                    meaning='mesh periods passed over at each speed')
    call reader%get(group, 'kept_periods', self%kept, error, tasks=group, at_least=1, at_most=10**7, &
                    meaning='mesh periods kept after them')
    call reader%get(group, 'start_um', self%start(1), error, unit='um', is_stated=has(1), tasks=group, at_least=-far, at_most=far, &
                    default_note=at_rest, &
                    meaning='dynamic transmission error to begin with, as of a motion in the table hysteresis')
    call reader%get(group, 'start_mm_s', self%start(2), error, unit='mm/s', is_stated=has(2), tasks=group, at_least=-far, &
                    at_most=far, default_note=at_rest, meaning='rate of the dynamic transmission error to begin with')
    self%at_rest = .not. any(has)
    if (has(1) .neqv. has(2)) call fail(error, code_input, '&poincare start_um, start_mm_s: give both or neither')
  end subroutine read_keys

  subroutine run(self, stages, error)
    class(poincare_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(error_t), allocatable, intent(inout) :: error
    type(section_points_t), allocatable :: section(:)
    real(dp), allocatable :: rpm(:), relief(:)
    integer, allocatable :: which(:)
    integer :: i

    call self%list_speeds(stages, rpm)
    call self%list_reliefs(stages, which)
    relief = stages%amount(which)
    call claim_memory(size(which)*size(rpm)*(24 + 16.0_dp*self%kept), '&poincare: '//str(size(rpm))//' speeds by '// &
                      str(self%kept)//' kept periods', error)
    if (allocated(error)) return
    allocate (section(size(which)))
    do i = 1, size(which)
      associate (motion => stages%motion(which(i)), stop => stages%accuracy%steady%stop)
        if (self%at_rest) then
          call sample_section(motion, rpm, self%periods_before, self%kept, section(i), stop=stop)
        else
          call sample_section(motion, rpm, self%periods_before, self%kept, section(i), self%start, stop)
        end if
      end associate
      if (section(i)%lacks) call fail(error, code_memory, '&poincare: the memory does not hold the motions')
      if (allocated(error) .or. any(section(i)%status == status_stopped)) return
      self%failed = self%failed + count(section(i)%status == status_unresolved .or. section(i)%status == status_chatter .or. &
                                         section(i)%status == status_unbounded)
      call stages%running%report_progress(size(rpm), stages%accuracy%steady%stop)
    end do
    call fill_points(rpm, relief, section, self%tables(self%place('poincare')), error)
    call fill_exponents(rpm, relief, section, self%tables(self%place('lyapunov')), error)
    self%is_done = .true.
    self%log = 'poincare: '//str(size(which)*size(rpm))//' motions seen over '//str(self%kept)//' mesh periods each'
  end subroutine run

  !> Fills a row for each relief, speed and mesh period kept.
  pure subroutine fill_points(rpm, relief, section, table, error)
    real(dp), intent(in) :: rpm(:), relief(:)    ! 1/min, m
    type(section_points_t), intent(in) :: section(:)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: seen(:, :)
    integer :: i, n, m, kept, each_speed

    kept = size(section(1)%x, 1)
    n = size(rpm)
    m = size(relief)
    call table%over('the motion seen once a mesh period, as a new pair enters', error, &
                    axis('relief_um', 'um', 'tip relief, as amount_um of the case', relief), &
                    axis('rpm', '1/min', 'speed of the pinion', rpm), &
                    axis('period', '', 'which of the mesh periods kept', [(i, i=1, kept)]))
    if (allocated(error)) return
    each_speed = n*kept
    allocate (seen(m*each_speed, 2))
    do i = 1, m
      seen((i - 1)*each_speed + 1:i*each_speed, 1) = reshape(section(i)%x, [each_speed])
      seen((i - 1)*each_speed + 1:i*each_speed, 2) = reshape(section(i)%v, [each_speed])
    end do
    call table%add('dte_um', 'um', 'dynamic transmission error; NaN where the motion was not followed', seen(:, 1))
    call table%add('dte_rate_mm_s', 'mm/s', 'rate of the dynamic transmission error', seen(:, 2))
  end subroutine fill_points

  !> Fills a row for each relief and speed.
  pure subroutine fill_exponents(rpm, relief, section, table, error)
    real(dp), intent(in) :: rpm(:), relief(:)    ! 1/min, m
    type(section_points_t), intent(in) :: section(:)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: exponent(:)
    integer, allocatable :: periods(:)
    character(12), allocatable :: status(:)
    integer :: i, k, n, m

    n = size(rpm)
    m = size(relief)
    allocate (exponent(m*n), periods(m*n), status(m*n))
    do i = 1, m
      exponent((i - 1)*n + 1:i*n) = section(i)%exponent
      periods((i - 1)*n + 1:i*n) = section(i)%periods
      do k = 1, n
        status((i - 1)*n + k) = status_name(section(i)%status(k))
      end do
    end do
    call table%over('how the motion seen once a mesh period goes on', error, &
                    axis('relief_um', 'um', 'tip relief, as amount_um of the case', relief), &
                    axis('rpm', '1/min', 'speed of the pinion', rpm))
    if (allocated(error)) return
    call table%add('lyapunov_exponent', '', 'largest Lyapunov exponent, of a mesh period: the mean logarithm by which a '// &
                   'disturbance grows, below 0 where the motion repeats and above 0 where it is chaotic', &
                   exponent)
    call table%add_words('status', 'ok, subharmonic, chaotic; transient, without damping aperiodic: neither repeats nor is '// &
                         'surely chaotic within what was kept; unbounded, unresolved, chatter', status)
    call table%add('mesh_periods', '', 'mesh periods until the motion repeats; 0: it does not', periods)
  end subroutine fill_exponents

  pure subroutine add_report(self, lines)
    class(poincare_task_t), intent(in) :: self
    type(lines_t), intent(inout) :: lines
    character(12) :: found
    integer :: i, at, status, n

    associate (table => self%tables(self%place('lyapunov')))
      associate (reliefs => table%extent(1), speeds => table%extent(2), exponent => table%numbers('lyapunov_exponent'), &
                 ended => table%columns(table%position('status'))%words)
        call lines%add('')
        call lines%add('Motion seen once a mesh period, '//str(speeds)//' speeds, '//str(self%kept)//' periods kept')
        call lines%add('   relief um   largest Lyapunov exponent      at rpm   motions')
        do i = 1, table%rows, speeds
          ! NaN is never the largest.
          at = i - 1 + maxloc(exponent(i:i + speeds - 1), 1, mask=exponent(i:i + speeds - 1) > -huge(1.0_dp))
          call lines%put(right(str(table%number('relief_um', i)), 12))
          if (at >= i) call lines%put(right(str(exponent(at), 4), 28)//right(str(table%number('rpm', at)), 12)//'  ')
          if (at < i) call lines%put(right('none', 28)//right('-', 12)//'  ')
          do status = 0, status_stopped
            found = status_name(status)
            n = count(ended(i:i + speeds - 1) == found)
            if (n > 0) call lines%put(' '//str(n)//' '//trim(found))
          end do
          call lines%add('')
        end do
        found = status_name(status_chaotic)
        if (any(ended == found)) call lines%add(left('', 19)//'chaotic: disturbances keep growing')
      end associate
    end associate
  end subroutine add_report
end module gearsweep_nonlinear_task_poincare
