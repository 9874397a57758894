!> The task `load`: at chosen speeds, the load of one pair along its path of contact, and other results of the motion.
module gearsweep_study_tasks_load
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_base, only: axis, claim_memory, code_input, code_memory, dp, error_t, fail, lines_t, no_number, right, &
    str, table_t, wants_stop
  use gearsweep_gear, only: drive
  use gearsweep_motion, only: find_corner_estimate, has_result, mesh_period, response_t, status_name, status_stopped
  use gearsweep_study_case_task, only: case_facts_t, stage, task_info_t
  use gearsweep_study_reader_reader, only: reader_t
  use gearsweep_study_reader_uses, only: is_prescribed, needs_gears, unless
  use gearsweep_study_run_points, only: add_several, factor_in, find_motion, known_count, of_coast, of_corner, of_estimate, &
    of_factor, of_motions, of_periods, of_relief, of_speed, of_status, status_length, words_of
  use gearsweep_study_run_stages, only: runnable_t, stages_t
  use gearsweep_study_tasks_load_torque, only: add_torques, claim_torques, fill_time, fill_torque_harmonics => fill_harmonics, &
    fill_torque_points => fill_points, follow_torque, torque_run_t
  implicit none
  private
  public :: load_task_t

  type, extends(runnable_t) :: load_task_t
    integer :: harmonics = 8                     !< number of mesh harmonics
    logical :: with_torque = .false.             !< true: also the torques of the mesh
  contains
    procedure, nopass :: describe
    procedure :: read_keys, run, add_report
    procedure :: check, uses
    procedure, private :: add_torque_tables
  end type load_task_t

contains

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t('load', needs=[stage%geometry, stage%mesh, stage%reliefs, stage%amounts, stage%motion, stage%losses, &
                                      stage%accuracy], &
                       tables='load load_points motion_harmonics torque torque_points torque_harmonics', fields='', &
                       gives='load of one pair along its path at chosen speeds, harmonics, coast load, impacts; with '// &
                       'load_torque the torques of both gears over time')
  end subroutine describe

  !> Only the torques need gears.
  pure logical function uses(self, which)
    class(load_task_t), intent(in) :: self
    integer, intent(in) :: which                 !< index of the stage in `stage`

    uses = any(self%needs == which) .and. (which /= stage%geometry .or. self%with_torque)
  end function uses

  !> Reads the keys; the task's speeds do not replace those of the sweep.
  subroutine read_keys(self, reader, error)
    class(load_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    type(error_t), allocatable, intent(inout) :: error

    call reader%get('sweep', 'load_rpm', self%own_rpm, error, unit='1/min', required=.true., tasks='load', &
                    at_least=1e-6_dp, at_most=1e9_dp, max_size=1000, distinct=.true., &
                    meaning='speeds of the pinion for the task load')
    call reader%get('sweep', 'motion_harmonics', self%harmonics, error, tasks='load', at_least=1, at_most=1000, &
                    meaning='harmonics of the mesh frequency in the tables motion_harmonics and torque_harmonics')
    call reader%get('sweep', 'load_torque', self%with_torque, error, tasks='load', &
                    refused=unless(.not. is_prescribed(reader), needs_gears), &
                    meaning='true: the task load also follows the torque that the mesh takes from the pinion and gives to the '// &
                    'gear (tables torque, torque_points and torque_harmonics)')
  end subroutine read_keys

  !> Refuses more paths than the table can hold.
  subroutine check(self, facts, error)
    class(load_task_t), intent(in) :: self
    type(case_facts_t), intent(in) :: facts
    type(error_t), allocatable, intent(inout) :: error
    integer, parameter :: most_paths = 10000

    if (size(self%own_rpm)*size(facts%amount) > most_paths) call fail(error, code_input, &
      '&sweep load_rpm: with '//str(size(facts%amount))//' reliefs more than '//str(most_paths)//' paths')
  end subroutine check

  subroutine run(self, stages, error)
    class(load_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(error_t), allocatable, intent(inout) :: error
    type(response_t), allocatable :: response(:, :)        ! (relief, speed)
    integer, allocatable :: motions(:, :)                  ! number of motions; (relief, speed)
    real(dp), allocatable :: corner(:, :)                  ! uncertainty from the tip corners' stiffness; (relief, speed)
    type(torque_run_t), allocatable :: torque(:, :)        ! (speed, relief)
    integer :: i, k

    associate (motion => stages%motion, rpm => self%own_rpm, accuracy => stages%accuracy)
      call claim_memory((1000.0_dp + 64*self%harmonics)*size(motion)*size(rpm), &
                        '&sweep load_rpm: '//str(size(motion)*size(rpm))//' motions', error)
      if (self%with_torque) call claim_torques(size(motion)*size(rpm), self%harmonics, error)
      if (allocated(error)) return
      allocate (motions(size(motion), size(rpm)))
      if (self%with_torque) allocate (torque(size(rpm), size(motion)))
      allocate (response(size(motion), size(rpm)), corner(merge(size(motion), 0, stages%has_corners()), size(rpm)))
      do k = 1, size(rpm)
        do i = 1, size(motion)
          if (wants_stop(accuracy%steady%stop)) return
          call find_motion(motion(i), rpm(k), stages%accuracy, response(i, k), motions(i, k), self%harmonics)
          if (response(i, k)%lacks) call fail(error, code_memory, &
            '&sweep load_rpm = '//str(rpm(k))//': the memory does not hold the motion')
          if (allocated(error)) return
          if (self%with_torque) then
            torque(k, i)%point = response(i, k)%point
            torque(k, i)%motions = motions(i, k)
            call follow_torque(stages, i, rpm(k), self%harmonics, torque(k, i), error)
            if (allocated(error)) return
          end if
          if (size(corner) > 0) call find_corner_estimate(motion(i), rpm(k), accuracy, corner(i, k), response(i, k)%point)
          call stages%running%tell(1, accuracy%steady%stop)
        end do
      end do
    end associate
    call fill_paths(stages, response, self%tables(self%place('load')), error)
    call fill_points(stages, response, motions, corner, self%tables(self%place('load_points')), error)
    call fill_harmonics(stages, self%harmonics, response, self%tables(self%place('motion_harmonics')), error)
    if (self%with_torque) call self%add_torque_tables([torque], stages, error)
    self%is_done = .true.
    associate (status => response%point%steady%status)
      self%is_stopped = any(status == status_stopped)
      self%failed = count(.not. has_result(status))
    end associate
    self%log = 'load: '//str(size(response))//' motions followed over the path'
  end subroutine run

  !> Fills the tables of the torques: `runs` has the first relief at all speeds, then the next one.
  subroutine add_torque_tables(self, runs, stages, error)
    class(load_task_t), intent(inout) :: self
    type(torque_run_t), intent(in) :: runs(:)
    type(stages_t), intent(in) :: stages
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: radius(2)
    integer :: i

    radius = [(stages%pair%gear(i)%base_radius(drive), i=1, 2)]
    call fill_time(runs, radius, self%tables(self%place('torque')), error)
    call fill_torque_points(runs, size(self%own_rpm), radius, self%tables(self%place('torque_points')), error)
    call fill_torque_harmonics(runs, radius, self%tables(self%place('torque_harmonics')), error)
  end subroutine add_torque_tables

  !> Fills the load of one pair along its path (Dogan et al. 2021, Figs. 5, 6).
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
    call table%begin('dynamic load of one pair along its path of contact', rows, error)
    if (allocated(error)) return
    allocate (values(rows, 5), periods(rows), pair(rows), status(rows))
    from = 1
    do k = 1, size(response, 2)
      do i = 1, size(response, 1)
        associate (one => response(i, k), steady => response(i, k)%point%steady)
          until = from + size(one%s) - 1
          values(from:until, 1) = stages%amount(i)
          values(from:until, 2) = one%rpm
          values(from:until, 3) = one%s
          values(from:until, 4) = one%load
          values(from:until, 5) = one%error
          status(from:until) = status_name(steady%status)
          periods(from:until) = steady%periods
          pair(from:until) = one%pair
        end associate
        from = until + 1
      end do
    end do
    call table%add_index(axis('relief_um', 'um', of_relief, values(:, 1)))
    call table%add_index(axis('rpm', '1/min', of_speed, values(:, 2)))
    call table%add_index(axis('s', '', 'path coordinate of the pair, in base pitches from A', values(:, 3)))
    call table%add('pair_load_n', 'N', 'elastic load on the pair', values(:, 4))
    call table%add('load_ratio', '', 'the same over the static load; its largest value is DF, up to the refinement of '// &
                   'the peak between two rows', values(:, 4)/stages%load)
    call table%add('dte_um', 'um', 'dynamic transmission error along the line of action, without the turning of whole '// &
                   'gears about their bores', values(:, 5))
    call table%add_words('status', of_status, status)
    call table%add('mesh_periods', '', of_periods, periods)
    call table%add_index(axis('pair', '', 'which of so many pairs this is, from 1; 0 without an answer', pair))
  end subroutine fill_paths

  !> Fills dynamic factor and other results of the motion at the chosen speeds.
  pure subroutine fill_points(stages, response, motions, corner, table, error)
    type(stages_t), intent(in) :: stages
    type(response_t), intent(in) :: response(:, :)
    integer, intent(in) :: motions(:, :)         ! number of motions
    real(dp), intent(in) :: corner(:, :)         ! uncertainty from the tip corners' stiffness; empty without them
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: factor(:), estimate(:)
    integer, allocatable :: status(:)
    integer :: i, k, m, n

    m = size(response, 1)
    n = size(response, 2)
    call table%over('dynamic factor and what else is read off the motion, at the speeds of the task load', error, &
                    axis('relief_um', 'um', of_relief, stages%amount), &
                    axis('rpm', '1/min', of_speed, [response(1, :)%rpm]))
    if (allocated(error)) return
    associate (point => response%point)
      factor = [((point(i, k)%dynamic_factor, k=1, n), i=1, m)]
      estimate = [((point(i, k)%estimate, k=1, n), i=1, m)]
      status = [((point(i, k)%steady%status, k=1, n), i=1, m)]
      where (.not. has_result(status))
        factor = no_number()
        estimate = no_number()
      end where
      call table%add('dynamic_factor', '', of_factor, factor)
      call table%add('error_estimate', '', of_estimate, estimate)
      call table%add_words('status', of_status, words_of(status))
      call table%add('mesh_periods', '', of_periods, [((point(i, k)%steady%periods, k=1, n), i=1, m)])
      call table%add('motions', '', of_motions, [transpose(known_count(motions))])
    end associate
    if (size(corner) > 0) call table%add('corner_estimate', '', of_corner, [transpose(corner)])
    call add_loads(stages%load, response, has_result(status), table)
    call add_motion(response, has_result(status), table)
  end subroutine fill_points

  !> Adds columns of the loads other than the largest of a pair.
  pure subroutine add_loads(load, response, found, table)
    real(dp), intent(in) :: load                 ! static load, N
    type(response_t), intent(in) :: response(:, :)
    logical, intent(in) :: found(:)
    type(table_t), intent(inout) :: table
    real(dp) :: values(size(response, 1), size(response, 2))

    associate (summary => response%summary)
      call add_found('coast_factor', '', of_coast, response%point%steady%coast_peak/load, found, table)
      call add_found('mean_load_ratio', '', 'mean elastic load of the mesh over the static load: all pairs less the coast '// &
                     'sides; what is left is carried by damping', summary%load%mean/load, found, table)
      call add_found('load_rms_ratio', '', 'root mean square deviation of that load from its mean, over the static load', &
                     summary%load%rms/load, found, table)
      call add_found('pair_load_rms_ratio', '', 'root mean square of the load on a pair over its path, over the static load', &
                     summary%pair_rms/load, found, table)
    end associate
    values = response%summary%impacts
    call add_found('impacts', '', 'how often flanks meet after all had been apart, in a mesh period', values, found, table)
    values = response%summary%reversals
    call add_found('load_reversals', '', 'how often the load goes over to the other sides of the teeth, in a mesh period', &
                   values, found, table)
    values = response%summary%apart
    call add_found('separation_share', '', 'part of the time during which all flanks are apart', values, found, table)
  end subroutine add_loads

  !> Adds columns of the dynamic transmission error.
  pure subroutine add_motion(response, found, table)
    type(response_t), intent(in) :: response(:, :)
    logical, intent(in) :: found(:)
    type(table_t), intent(inout) :: table

    associate (error => response%summary%error)
      call add_found('dte_mean_um', 'um', 'mean dynamic transmission error', (error%mean), found, table)
      call add_found('dte_rms_um', 'um', 'root mean square deviation from that', (error%rms), found, table)
      call add_found('dte_peak_to_peak_um', 'um', 'largest less least dynamic transmission error', &
                     (error%largest - error%least), found, table)
    end associate
  end subroutine add_motion

  !> Adds a column with values at the converged points.
  pure subroutine add_found(name, unit, meaning, values, found, table)
    character(*), intent(in) :: name, unit, meaning
    real(dp), intent(in) :: values(:, :)         ! (relief, speed)
    logical, intent(in) :: found(:)              ! (row)
    type(table_t), intent(inout) :: table

    call table%add(name, unit, meaning//'; NaN where there is no answer', &
                   merge(reshape(transpose(values), [size(values)]), no_number(), found))
  end subroutine add_found

  !> Fills harmonics of the dynamic transmission error and of the load of the mesh.
  pure subroutine fill_harmonics(stages, harmonics, response, table, error)
    type(stages_t), intent(in) :: stages
    integer, intent(in) :: harmonics             ! number of mesh harmonics
    type(response_t), intent(in) :: response(:, :)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: values(:, :)
    integer :: i, k, n, rows, from

    rows = sum(1 + harmonics*merge(response%point%steady%periods, 0, has_result(response%point%steady%status)))
    call table%begin('dynamic transmission error and elastic load of the mesh, each as the sum of amplitude '// &
                     'cos(2 pi harmonic tau + phase) over the mesh periods tau; harmonic 0 is the mean', rows, error)
    if (allocated(error)) return
    allocate (values(rows, 8), source=no_number())
    from = 1
    do i = 1, size(response, 1)
      do k = 1, size(response, 2)
        associate (one => response(i, k), steady => response(i, k)%point%steady)
          n = merge(harmonics*steady%periods, 0, has_result(steady%status))
          values(from:from + n, 1) = stages%amount(i)
          values(from:from + n, 2) = one%rpm
          values(from, 3) = 0
          if (has_result(steady%status)) call fill_one(one, n, mesh_period(stages%motion(1)%mesh%teeth(1), one%rpm), &
                                                       values(from:from + n, 3:))
        end associate
        from = from + n + 1
      end do
    end do
    call table%add_index(axis('relief_um', 'um', of_relief, values(:, 1)))
    call table%add_index(axis('rpm', '1/min', of_speed, values(:, 2)))
    call table%add_index(axis('harmonic', '', &
                              '0 for the mean, 1, 2 ... up to motion_harmonics for the mesh frequency; of a motion '// &
                              'that repeats after several mesh periods, also the parts between', values(:, 3)))
    call table%add('frequency_hz', 'Hz', 'frequency of that harmonic', values(:, 4))
    call table%add('dte_amplitude_um', 'um', 'half of peak-to-peak of the dynamic transmission error; the mean for harmonic 0', &
                   values(:, 5))
    call table%add('dte_phase_deg', 'deg', 'its phase at tau = 0, where a pair enters at A', values(:, 6))
    call table%add('mesh_load_amplitude_n', 'N', 'the same of the elastic load of the mesh: all pairs less the coast sides', &
                   values(:, 7))
    call table%add('mesh_load_phase_deg', 'deg', 'its phase at tau = 0', values(:, 8))
  end subroutine fill_harmonics

  !> Computes harmonic, frequency (Hz), amplitude (m) and phase (rad) of the transmission error, and of the load (N).
  pure subroutine fill_one(response, n, period, values)
    type(response_t), intent(in) :: response
    integer, intent(in) :: n
    real(dp), intent(in) :: period               ! mesh period, s
    real(dp), intent(inout) :: values(0:, :)     ! (harmonic, column)
    integer :: k

    values(:, 1) = [(real(k, dp)/response%point%steady%periods, k=0, n)]
    values(:, 2) = values(:, 1)/period
    associate (error => response%summary%error, load => response%summary%load)
      values(:, 3) = [error%mean, error%amplitude]
      values(:, 4) = [0.0_dp, error%phase]
      values(:, 5) = [load%mean, load%amplitude]
      values(:, 6) = [0.0_dp, load%phase]
    end associate
  end subroutine fill_one

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
      call add_several(points, lines)
    end associate
    if (self%with_torque) call add_torques(self%tables(self%place('torque_points')), lines)
  end subroutine add_report
end module gearsweep_study_tasks_load
