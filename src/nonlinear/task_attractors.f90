!> The task `attractors`: all attracting motions at chosen speeds, from a grid of starts, and the starts that lead to each of them
!> (see gearsweep_motion_attractors).
module gearsweep_nonlinear_task_attractors
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_base, only: axis, claim_memory, code_memory, dp, error_t, fail, left, lines_t, no_number, str, table_t
  use gearsweep_motion, only: attractor_options_t, attractors_t, contact_name, contact_of, find_attractors, has_result, &
    largest_reached, mesh_period, point_t, start_states, status_ok, status_stopped
  use gearsweep_study, only: of_estimate, of_factor, of_periods, of_relief, of_speed, of_status, &
    reader_t, runnable_t, stage, stages_t, task_info_t, words_of
  implicit none
  private
  public :: attractors_task_t

  type, extends(runnable_t) :: attractors_task_t
    type(attractor_options_t) :: options
  contains
    procedure, nopass :: describe
    procedure :: read_keys, run, add_report
  end type attractors_task_t

  !> Row of attractors.
  type :: row_t
    real(dp) :: relief, rpm, period              !< m, 1/min; mesh period, s
    integer :: number                            !< index of the motion at this speed
    integer :: starts                            !< number of starts that lead to it
    real(dp) :: share                            !< the same as a share of all starts
    type(point_t) :: point
  end type row_t

  character(*), parameter :: group = 'attractors'

contains

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t(group, needs=[stage%mesh, stage%reliefs, stage%amounts, stage%motion, stage%losses, stage%accuracy, &
                                     stage%speeds], &
                       tables='attractors attractor_points basins', fields='', &
                       summary='all attracting motions from spread starts, and which starts lead to which')
  end subroutine describe

  subroutine read_keys(self, reader, error)
    class(attractors_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    type(error_t), allocatable, intent(inout) :: error
    logical :: has_most

    call reader%add_group(group, 'The task attractors, over the speeds of &sweep or its own.')
    call self%read_speeds(reader, group, error)
    call self%read_reliefs(reader, group, error)
    call reader%get(group, 'starts', self%options%starts, error, tasks=group, at_least=1, at_most=1000, &
                    meaning='starts along each axis of their grid, displacement and velocity as a new pair enters')
    call reader%get(group, 'span', self%options%span, error, tasks=group, at_least=1e-6_dp, at_most=1e6_dp, &
                    meaning='from the middle of the grid, at rest at the mean deflection, to its edge, in static deflections; '// &
                    'velocities: those with which the natural motion has such amplitudes')
    call reader%get(group, 'most_periods', self%options%most_periods, error, tasks=group, at_least=1, at_most=64, &
                    meaning='mesh periods after which a motion that is looked for repeats, at most')
    call reader%get(group, 'followed_periods', self%options%most_cycles, error, tasks=group, is_stated=has_most, at_least=1, &
                    at_most=10**7, default_note='as many as decay to exp(-5) takes, 2000 to 100 000', &
                    meaning='mesh periods that a start is followed at most until a motion has captured it or it is chaotic')
  end subroutine read_keys

  subroutine run(self, stages, error)
    class(attractors_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(error_t), allocatable, intent(inout) :: error
    type(attractors_t), allocatable :: found(:, :)
    type(attractor_options_t) :: options
    real(dp), allocatable :: rpm(:)
    integer, allocatable :: which(:)
    integer :: i

    call self%list_speeds(stages, rpm)
    call self%list_reliefs(stages, which)
    call claim_memory(size(which)*size(rpm)*(1e4_dp + 40.0_dp*self%options%starts**2), '&attractors: '//str(size(rpm))// &
                      ' speeds by '//str(self%options%starts**2)//' starts', error)
    if (allocated(error)) return
    options = self%options
    options%accuracy = stages%accuracy
    options%threads = stages%running%threads
    allocate (found(size(rpm), size(which)))
    do i = 1, size(which)
      call find_attractors(stages%motion(which(i)), rpm, options, found(:, i))
      if (any(found(:, i)%lacks)) call fail(error, code_memory, '&attractors: the memory does not hold the motions')
      if (allocated(error) .or. any(found(:, i)%status == status_stopped)) return
      self%failed = self%failed + count(found(:, i)%status /= status_ok)
      call stages%running%report_progress(size(rpm), stages%accuracy%steady%stop)
    end do
    associate (amount => stages%amount(which))
      call fill_motions(rpm, mesh_period(stages%motion(1)%mesh%teeth(1), rpm), amount, found, &
                        self%tables(self%place('attractors')), error)
      call fill_points(rpm, amount, found, self%tables(self%place('attractor_points')), error)
      call fill_basins(stages, rpm, which, options, found, self%tables(self%place('basins')), error)
    end associate
    self%is_done = .true.
    self%log = 'attractors: '//str(size(found))//' operating points, '//str(self%options%starts**2)//' starts each'
  end subroutine run

  !> Fills a row for each relief, speed and motion. `period`: of the mesh at the speeds, s.
  pure subroutine fill_motions(rpm, period, relief, found, table, error)
    real(dp), intent(in) :: rpm(:), period(:), relief(:)   ! 1/min, s, m
    type(attractors_t), intent(in) :: found(:, :)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    type(row_t), allocatable :: rows(:)
    logical, allocatable :: known(:)
    integer :: i, k, m, n

    n = sum([((size(found(k, i)%motion), k=1, size(rpm)), i=1, size(relief))])
    call table%begin('attracting motions at each speed, the one to which most starts lead first', n, error)
    if (allocated(error)) return
    allocate (rows(n))
    n = 0
    do i = 1, size(relief)
      do k = 1, size(rpm)
        do m = 1, size(found(k, i)%motion)
          n = n + 1
          associate (motion => found(k, i)%motion(m))
            rows(n) = row_t(relief(i), rpm(k), period(k), m, motion%starts, share_of(found(k, i), m), motion%point)
          end associate
        end do
      end do
    end do
    associate (point => rows%point, steady => rows%point%steady)
      known = has_result(steady%status)
      call table%add_index(axis('relief_um', 'um', of_relief, [rows%relief]))
      call table%add_index(axis('rpm', '1/min', of_speed, [rows%rpm]))
      call table%add_index(axis('motion', '', 'which of the motions at this speed', [rows%number]))
      call table%add('dynamic_factor', '', of_factor, merge(point%dynamic_factor, no_number(), known))
      call table%add('error_estimate', '', of_estimate, merge(point%estimate, no_number(), known))
      call table%add_words('status', of_status, words_of(steady%status))
      call table%add_words('contact', 'full; partial: a pair was apart for a while; lost: all were; coast: the coast sides '// &
                           'touched', contact_name(contact_of(steady)))
      call table%add('floquet_modulus', '', 'largest modulus of the Floquet multipliers', [steady%multiplier])
      call table%add('mesh_periods', '', of_periods, [steady%periods])
      call table%add('starts', '', 'how many starts lead to it; 0: none reaches it, and it is left out of largest values', &
                     [rows%starts])
      call table%add('share', '', 'the same as a share of all starts', [rows%share])
      call table%add('dte_um', 'um', 'dynamic transmission error as a new pair enters', merge(steady%state(1), no_number(), known))
      call table%add('dte_rate_mm_s', 'mm/s', 'rate of the dynamic transmission error as a new pair enters: the motion can be '// &
                     'continued from both', merge(steady%state(2)/rows%period, no_number(), known))
    end associate
  end subroutine fill_motions

  !> Fills a row for each relief and speed.
  pure subroutine fill_points(rpm, relief, found, table, error)
    real(dp), intent(in) :: rpm(:), relief(:)    ! 1/min, m
    type(attractors_t), intent(in) :: found(:, :)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    integer :: i, k

    call table%over('how many motions attract, and what a sweep of single speeds shows of them', error, &
                    axis('relief_um', 'um', of_relief, relief), axis('rpm', '1/min', of_speed, rpm))
    if (allocated(error)) return
    associate (n => size(rpm), m => size(relief))
      call table%add('motions', '', 'how many attracting motions are known', [((size(found(k, i)%motion), k=1, n), i=1, m)])
      call table%add('largest_dynamic_factor', '', 'largest DF of those that a start reaches or a sweep of single speeds '// &
                     'shows; NaN where none is known', [((largest_reached(found(k, i)), k=1, n), i=1, m)])
      call table%add('each_dynamic_factor', '', 'DF that a sweep with direction = ''each'' shows; NaN where it has no answer', &
                     [merge(found%alone%dynamic_factor, no_number(), has_result(found%alone%steady%status))])
      call table%add('each_motion', '', 'which of the motions that is; 0: none of them', [found%alone_is])
      call table%add('each_share', '', 'share of the starts that lead to it', &
                     [((merge(share_of(found(k, i), found(k, i)%alone_is), no_number(), found(k, i)%alone_is > 0), &
                        k=1, n), i=1, m)])
      call table%add('unsettled_share', '', 'share of the starts that nothing captured within followed_periods', &
                     [((merge(share_of(found(k, i), 0), no_number(), found(k, i)%status == status_ok), k=1, n), i=1, m)])
      call table%add_words('status', 'ok; unresolved: the speed is too low to be searched', words_of([found%status]))
    end associate
  end subroutine fill_points

  !> Share of the starts that lead to the motion with this index, or to none of the motions (0).
  pure real(dp) function share_of(found, motion) result(share)
    type(attractors_t), intent(in) :: found
    integer, intent(in) :: motion

    share = no_number()
    if (allocated(found%to)) share = count(found%to == motion)/real(size(found%to), dp)
  end function share_of

  !> Fills a row for each relief, speed and start.
  pure subroutine fill_basins(stages, rpm, which, options, found, table, error)
    type(stages_t), intent(in) :: stages
    real(dp), intent(in) :: rpm(:)               ! 1/min
    integer, intent(in) :: which(:)              ! indices of the reliefs
    type(attractor_options_t), intent(in) :: options
    type(attractors_t), intent(in) :: found(:, :)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: states(:, :)
    integer, allocatable :: to(:)
    real(dp) :: duration
    integer :: i, k, row, m, n, starts

    starts = options%starts**2
    n = size(rpm)
    m = size(which)
    call table%over('starts, and the motion that each leads to', error, &
                    axis('relief_um', 'um', of_relief, stages%amount(which)), axis('rpm', '1/min', of_speed, rpm), &
                    axis('start', '', 'which start: the displacement varies fastest', [(i, i=1, starts)]))
    if (allocated(error)) return
    allocate (states(2, m*n*starts), to(m*n*starts))
    row = 0
    do i = 1, m
      do k = 1, n
        duration = mesh_period(stages%motion(1)%mesh%teeth(1), rpm(k))
        states(:, row + 1:row + starts) = start_states(stages%motion(which(i)), duration, options)
        states(2, row + 1:row + starts) = states(2, row + 1:row + starts)/duration
        to(row + 1:row + starts) = found(k, i)%to
        row = row + starts
      end do
    end do
    call table%add('dte_um', 'um', 'dynamic transmission error at the start, as a new pair enters', states(1, :))
    call table%add('dte_rate_mm_s', 'mm/s', 'its rate there', states(2, :))
    call table%add('motion', '', 'the motion of the table attractors that it leads to; 0: none within followed_periods', to)
  end subroutine fill_basins

  pure subroutine add_report(self, lines)
    class(attractors_task_t), intent(in) :: self
    type(lines_t), intent(inout) :: lines
    integer :: i

    associate (found => self%tables(self%place('attractors')), points => self%tables(self%place('attractor_points')))
      call lines%add('')
      call lines%add('Attracting motions, '//str(points%extent(2))//' speeds, '//str(self%options%starts**2)//' starts each')
      call found%show(lines, 'relief_um rpm mesh_periods dynamic_factor starts share contact')
      call lines%add(left('Several motions', 19)//'at '//str(count(points%numbers('motions') > 1))//' of '//str(points%rows)// &
                     ' operating points')
      i = count(points%numbers('unsettled_share') > 0)
      if (i > 0) call lines%add(left('', 19)//'at '//str(i)//' some starts were not captured within followed_periods')
      i = count(ieee_is_nan(points%numbers('unsettled_share')))
      if (i > 0) call lines%add(left('', 19)//'at '//str(i)//' the speed is too low to be searched')
    end associate
  end subroutine add_report
end module gearsweep_nonlinear_task_attractors
