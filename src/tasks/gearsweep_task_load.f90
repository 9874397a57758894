!> The task `load`: the load of one pair along its path of contact at chosen speeds.
module gearsweep_task_load
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_decimal, only: in_um
  use gearsweep_error, only: code_input, code_memory, error_t, fail
  use gearsweep_kinds, only: dp
  use gearsweep_lines, only: lines_t, right
  use gearsweep_memory, only: claim_memory
  use gearsweep_points, only: factor_in, of_estimate, of_factor, of_periods, of_relief, of_speed, of_status, status_length, &
    words_of
  use gearsweep_reader, only: reader_t
  use gearsweep_response, only: response_t
  use gearsweep_status, only: has_result, status_name, status_stopped
  use gearsweep_stop, only: wants_stop
  use gearsweep_table, only: each, no_number, over_and_over, table_t
  use gearsweep_task, only: stages_t, task_info_t, task_t
  use gearsweep_text, only: str
  implicit none
  private
  public :: load_task_t

  type, extends(task_t) :: load_task_t
  contains
    procedure, nopass :: describe
    procedure :: read_keys, run, add_report
    procedure :: check
  end type load_task_t

  real(dp), parameter :: micro = 1e6_dp

contains

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t('load', needs='mesh reliefs amounts motion losses accuracy kept', tables='load load_points', fields='', &
                       gives='load of one pair along its path at chosen speeds')
  end subroutine describe

  !> Its speeds stand beside those of the sweep, which keeps its motions there.
  subroutine read_keys(self, reader, error)
    class(load_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    type(error_t), allocatable, intent(inout) :: error

    call reader%get('sweep', 'load_rpm', self%own_rpm, error, unit='1/min', required=.true., tasks='load', &
                    at_least=1e-6_dp, at_most=1e9_dp, max_size=1000, meaning='speeds of the pinion for the task load')
    if (allocated(self%own_rpm)) self%keep = self%own_rpm
  end subroutine read_keys

  !> So many paths are followed and no more.
  subroutine check(self, amount, error)
    class(load_task_t), intent(in) :: self
    real(dp), intent(in) :: amount(:)
    type(error_t), allocatable, intent(inout) :: error
    integer, parameter :: most_paths = 10000

    if (size(self%own_rpm)*size(amount) > most_paths) call fail(error, code_input, &
      '&sweep load_rpm: with '//str(size(amount))//' reliefs more than '//str(most_paths)//' paths')
  end subroutine check

  subroutine run(self, stages, error)
    class(load_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(error_t), allocatable, intent(inout) :: error
    type(response_t), allocatable :: response(:, :)        ! (relief, speed)
    integer :: i, k

    associate (motion => stages%motion, rpm => self%own_rpm, accuracy => stages%accuracy)
      call claim_memory(1000.0_dp*size(motion)*size(rpm), '&sweep load_rpm: '//str(size(motion)*size(rpm))//' motions', error)
      if (allocated(error)) return
      allocate (response(size(motion), size(rpm)))
      do k = 1, size(rpm)
        do i = 1, size(motion)
          if (wants_stop(accuracy%steady%stop)) return
          call stages%find_motion(i, rpm(k), response(i, k))
          if (response(i, k)%lacks) call fail(error, code_memory, &
            '&sweep load_rpm = '//str(rpm(k))//': the memory does not hold the motion')
          if (allocated(error)) return
          call stages%running%tell(1, accuracy%steady%stop)
        end do
      end do
    end associate
    call fill_paths(stages, response, self%tables(self%place('load')), error)
    call fill_points(stages%amount, response, self%tables(self%place('load_points')), error)
    self%is_done = .true.
    associate (status => response%point%steady%status)
      self%is_stopped = any(status == status_stopped)
      self%failed = count(.not. has_result(status))
    end associate
    self%log = 'load: '//str(size(response))//' motions followed over the path'
  end subroutine run

  !> Load of one pair along its path (Dogan et al. 2021, Figs. 5, 6).
  pure subroutine fill_paths(stages, response, table, error)
    type(stages_t), intent(in) :: stages
    type(response_t), intent(in) :: response(:, :)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: values(:, :)
    integer, allocatable :: periods(:), pair(:)
    character(status_length), allocatable :: status(:)
    integer :: i, k, rows, from, until

    rows = sum([((size(response(i, k)%s), i=1, size(response, 1)), k=1, size(response, 2))])
    call table%begin('dynamic load of one pair along its path of contact', rows, 16, error)
    if (allocated(error)) return
    allocate (values(rows, 5), periods(rows), pair(rows), status(rows))
    from = 1
    do k = 1, size(response, 2)
      do i = 1, size(response, 1)
        associate (one => response(i, k), steady => response(i, k)%point%steady)
          until = from + size(one%s) - 1
          values(from:until, 1) = in_um(stages%amount(i))
          values(from:until, 2) = one%rpm
          values(from:until, 3) = one%s
          values(from:until, 4) = one%load
          values(from:until, 5) = micro*one%error
          status(from:until) = status_name(steady%status)
          periods(from:until) = steady%periods
          pair(from:until) = one%pair
        end associate
        from = until + 1
      end do
    end do
    call table%add_index('relief_um', 'um', of_relief, values(:, 1))
    call table%add_index('rpm', '1/min', of_speed, values(:, 2))
    call table%add_index('s', '', 'path coordinate of the pair, in base pitches from A', values(:, 3))
    call table%add('pair_load_n', 'N', 'elastic load on the pair', values(:, 4))
    call table%add('load_ratio', '', 'the same over the static load; its largest value is DF, up to the refinement of '// &
                   'the peak between two rows', values(:, 4)/stages%load)
    call table%add('dte_um', 'um', 'dynamic transmission error along the line of action, without the turning of whole '// &
                   'gears about their bores', values(:, 5))
    call table%add_words('status', of_status, status)
    call table%add('mesh_periods', '', of_periods, periods)
    call table%add_index('pair', '', 'which of so many pairs this is, from 1; 0 without an answer', pair)
  end subroutine fill_paths

  !> Dynamic factor at the chosen speeds.
  pure subroutine fill_points(amount, response, table, error)
    real(dp), intent(in) :: amount(:)            ! of relief, m
    type(response_t), intent(in) :: response(:, :)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: factor(:), estimate(:)
    integer, allocatable :: status(:)
    integer :: i, k, m, n

    m = size(response, 1)
    n = size(response, 2)
    call table%begin('dynamic factor at the speeds of the task load', m*n, 8, error, extent=[m, n])
    if (allocated(error)) return
    associate (point => response%point)
      factor = [((point(i, k)%dynamic_factor, k=1, n), i=1, m)]
      estimate = [((point(i, k)%estimate, k=1, n), i=1, m)]
      status = [((point(i, k)%steady%status, k=1, n), i=1, m)]
      where (.not. has_result(status))
        factor = no_number()
        estimate = no_number()
      end where
      call table%add_index('relief_um', 'um', of_relief, each(in_um(amount), n))
      call table%add_index('rpm', '1/min', of_speed, over_and_over([response(1, :)%rpm], m))
      call table%add('dynamic_factor', '', of_factor, factor)
      call table%add('error_estimate', '', of_estimate, estimate)
      call table%add_words('status', of_status, words_of(status))
      call table%add('mesh_periods', '', of_periods, [((point(i, k)%steady%periods, k=1, n), i=1, m)])
    end associate
  end subroutine fill_points

  pure subroutine add_report(self, lines)
    class(load_task_t), intent(in) :: self
    type(lines_t), intent(inout) :: lines
    integer :: i, k, row

    call lines%add('')
    call lines%add('Dynamic factor at chosen speeds')
    call lines%add('   relief um         rpm        DF     error est.   status')
    associate (points => self%tables(self%place('load_points')))
      do k = 1, points%extent(2)
        do i = 1, points%extent(1)
          row = (i - 1)*points%extent(2) + k
          call lines%put(right(str(points%number('relief_um', row)), 12)//right(str(points%number('rpm', row)), 12)// &
                         factor_in(points%number('dynamic_factor', row)))
          if (.not. ieee_is_nan(points%number('dynamic_factor', row))) then
            call lines%put(right(str(points%number('error_estimate', row), 2), 15))
          else
            call lines%put(right('-', 15))
          end if
          call lines%add('   '//trim(points%word('status', row)))
        end do
      end do
    end associate
  end subroutine add_report
end module gearsweep_task_load
