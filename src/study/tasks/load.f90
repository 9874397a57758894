!> The task `load`: at chosen speeds, the load of one pair along its path of contact, and other results of the motion.
module gearsweep_study_tasks_load
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_base, only: axis, claim_memory, code_input, code_memory, dp, error_t, fail, lines_t, no_number, str, table_t, &
    wants_stop
  use gearsweep_gear, only: drive
  use gearsweep_motion, only: find_corner_estimate, find_torque, has_result, mesh_period, mesh_torque_t, point_t, response_t, &
    spectrum_t, status_stopped, trace_motion, trace_t
  use gearsweep_study_case_task, only: case_facts_t, gear_names, stage, task_info_t
  use gearsweep_study_reader_reader, only: is_prescribed, needs_gears, reader_t, text_unless
  use gearsweep_study_run_points, only: add_several, find_motion, known_count, of_coast, of_corner, of_estimate, &
    of_factor, of_motions, of_periods, of_relief, of_speed, of_status, words_of
  use gearsweep_study_run_stages, only: runnable_t, stages_t
  implicit none
  private
  public :: load_task_t, fill_torque, fill_torque_harmonics, fill_torque_points, torque_run_t

  !> Torque with one relief at one speed.
  type :: torque_run_t
    real(dp) :: relief = 0                       !< amount of relief, m
    real(dp) :: rpm = 0                          !< speed, 1/min
    real(dp) :: period = 0                       !< mesh period, s
    type(point_t) :: point
    integer :: motions = 0                       !< number of motions; 0: not known
    type(mesh_torque_t) :: mesh                  !< empty if the point did not converge
    type(spectrum_t) :: half(2)                  !< spectra of the forces with half as many steps
    !> Error of the forces apart from the steps, N, as the motion only nearly repeats; NaN for a method whose steps have no error
    !> estimate.
    real(dp) :: other_error = 0
  end type torque_run_t

  integer, parameter :: time_columns = 10
  !> Memory of a row of the table of times before it is written, without the table, and of a harmonic of both gears with its row.
  real(dp), parameter :: row_bytes = 8*(time_columns + 6), harmonic_bytes = 8*(8 + 10)
  character(*), parameter :: unknown = '; NaN where it is not known'

  type, extends(runnable_t) :: load_task_t
    integer :: harmonics = 8                     !< number of mesh harmonics
    logical :: with_torque = .false.             !< true: also the torques of the mesh
  contains
    procedure, nopass :: describe
    procedure :: read_keys, run, add_report
    procedure :: check, uses
  end type load_task_t

contains

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t('load', needs=[stage%geometry, stage%mesh, stage%reliefs, stage%amounts, stage%motion, stage%losses, &
                                      stage%accuracy], &
                       tables='load load_points motion_harmonics torque torque_points torque_harmonics', fields='', &
                       summary='load of one pair along its path at chosen speeds, harmonics, coast load, impacts; with '// &
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
                    not_allowed=text_unless(.not. is_prescribed(reader), needs_gears), &
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
    type(torque_run_t), allocatable :: torque(:)           ! the first relief at all speeds, then the next one
    real(dp), parameter :: fewest_rows = 400
    real(dp) :: radius(2)
    integer :: i, k

    associate (motion => stages%motion, rpm => self%own_rpm, accuracy => stages%accuracy)
      call claim_memory((1000.0_dp + 64*self%harmonics)*size(motion)*size(rpm), &
                        '&sweep load_rpm: '//str(size(motion)*size(rpm))//' motions', error)
      if (self%with_torque) call claim_memory((row_bytes*fewest_rows + harmonic_bytes*self%harmonics)*size(motion)*size(rpm), &
                                              '&sweep load_torque: '//str(size(motion)*size(rpm))//' motions', error)
      if (allocated(error)) return
      allocate (motions(size(motion), size(rpm)))
      if (self%with_torque) allocate (torque(size(rpm)*size(motion)))
      allocate (response(size(motion), size(rpm)), corner(merge(size(motion), 0, stages%has_corners()), size(rpm)))
      do k = 1, size(rpm)
        do i = 1, size(motion)
          if (wants_stop(accuracy%steady%stop)) return
          call find_motion(motion(i), rpm(k), stages%accuracy, response(i, k), motions(i, k), self%harmonics)
          if (response(i, k)%lacks) call fail(error, code_memory, &
            '&sweep load_rpm = '//str(rpm(k))//': the memory does not hold the motion')
          if (allocated(error)) return
          if (self%with_torque) then
            associate (run => torque(k + (i - 1)*size(rpm)))
              run%point = response(i, k)%point
              run%motions = motions(i, k)
              call follow_torque(stages, i, rpm(k), self%harmonics, run, error)
            end associate
            if (allocated(error)) return
          end if
          if (size(corner) > 0) call find_corner_estimate(motion(i), rpm(k), accuracy, corner(i, k), response(i, k)%point)
          call stages%running%report_progress(1, accuracy%steady%stop)
        end do
      end do
    end associate
    call fill_paths(stages, response, self%tables(self%place('load')), error)
    call fill_points(stages, response, motions, corner, self%tables(self%place('load_points')), error)
    call fill_harmonics(stages, self%harmonics, response, self%tables(self%place('motion_harmonics')), error)
    if (self%with_torque) then
      radius = [(stages%pair%gear(i)%base_radius(drive), i=1, 2)]
      call fill_torque(torque, radius, self%tables(self%place('torque')), error)
      call fill_torque_points(torque, size(self%own_rpm), radius, self%tables(self%place('torque_points')), error)
      call fill_torque_harmonics(torque, radius, self%tables(self%place('torque_harmonics')), error)
    end if
    self%is_done = .true.
    associate (status => response%point%steady%status)
      self%is_stopped = any(status == status_stopped)
      self%failed = count(.not. has_result(status))
    end associate
    self%log = 'load: '//str(size(response))//' motions followed over the path'
  end subroutine run

  !> Fills the load of one pair along its path (Dogan et al. 2021, Figs. 5, 6).
  pure subroutine fill_paths(stages, response, table, error)
    type(stages_t), intent(in) :: stages
    type(response_t), intent(in) :: response(:, :)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    integer, allocatable :: run(:)               ! index of the motion, reliefs first; (row)
    integer :: i, j, k, m, n

    m = size(response, 1)
    n = size(response, 2)
    call table%begin('dynamic load of one pair along its path of contact', sum([((size(response(i, k)%s), i=1, m), k=1, n)]), &
                     error)
    if (allocated(error)) return
    run = [(((i + m*(k - 1), j=1, size(response(i, k)%s)), i=1, m), k=1, n)]
    associate (rpm => [response%rpm], status => [response%point%steady%status], periods => [response%point%steady%periods], &
               load => [((response(i, k)%load, i=1, m), k=1, n)])
      call table%add_index(axis('relief_um', 'um', of_relief, stages%amount(1 + modulo(run - 1, m))))
      call table%add_index(axis('rpm', '1/min', of_speed, rpm(run)))
      call table%add_index(axis('s', '', 'path coordinate of the pair, in base pitches from A', &
                                [((response(i, k)%s, i=1, m), k=1, n)]))
      call table%add('pair_load_n', 'N', 'elastic load on the pair', load)
      call table%add('load_ratio', '', 'the same over the static load; its largest value is DF, up to the refinement of '// &
                     'the peak between two rows', load/stages%load)
      call table%add('dte_um', 'um', 'dynamic transmission error along the line of action, without the turning of whole '// &
                     'gears about their bores', [((response(i, k)%error, i=1, m), k=1, n)])
      call table%add_words('status', of_status, words_of(status(run)))
      call table%add('mesh_periods', '', of_periods, periods(run))
      call table%add_index(axis('pair', '', 'index of the pair, from 1; 0 without an answer', &
                                [((response(i, k)%pair, i=1, m), k=1, n)]))
    end associate
  end subroutine fill_paths

  !> Fills dynamic factor and other results of the motion at the chosen speeds.
  pure subroutine fill_points(stages, response, motions, corner, table, error)
    type(stages_t), intent(in) :: stages
    type(response_t), intent(in) :: response(:, :)
    integer, intent(in) :: motions(:, :)         ! number of motions
    real(dp), intent(in) :: corner(:, :)         ! uncertainty from the tip corners' stiffness; empty without them
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    integer, allocatable :: status(:)
    logical, allocatable :: found(:)
    integer :: i, k, m, n
    real(dp) :: values(size(response, 1), size(response, 2))

    m = size(response, 1)
    n = size(response, 2)
    call table%over('dynamic factor and what else is read off the motion, at the speeds of the task load', error, &
                    axis('relief_um', 'um', of_relief, stages%amount), &
                    axis('rpm', '1/min', of_speed, [response(1, :)%rpm]))
    if (allocated(error)) return
    associate (point => response%point)
      status = [((point(i, k)%steady%status, k=1, n), i=1, m)]
      found = has_result(status)
      call table%add('dynamic_factor', '', of_factor, &
                     merge([((point(i, k)%dynamic_factor, k=1, n), i=1, m)], no_number(), found))
      call table%add('error_estimate', '', of_estimate, merge([((point(i, k)%estimate, k=1, n), i=1, m)], no_number(), found))
      call table%add_words('status', of_status, words_of(status))
      call table%add('mesh_periods', '', of_periods, [((point(i, k)%steady%periods, k=1, n), i=1, m)])
      call table%add('motions', '', of_motions, [transpose(known_count(motions))])
    end associate
    if (size(corner) > 0) call table%add('corner_estimate', '', of_corner, [transpose(corner)])
    associate (summary => response%summary)
      call add_found('coast_factor', '', of_coast, response%point%steady%coast_peak/stages%load, found, table)
      call add_found('mean_load_ratio', '', 'mean elastic load of the mesh over the static load: all pairs less the coast '// &
                     'sides; what is left is carried by damping', summary%load%mean/stages%load, found, table)
      call add_found('load_rms_ratio', '', 'root mean square deviation of that load from its mean, over the static load', &
                     summary%load%rms/stages%load, found, table)
      call add_found('pair_load_rms_ratio', '', 'root mean square of the load on a pair over its path, over the static load', &
                     summary%pair_rms/stages%load, found, table)
    end associate
    values = response%summary%impacts
    call add_found('impacts', '', 'how often flanks meet after all had been apart, in a mesh period', values, found, table)
    values = response%summary%reversals
    call add_found('load_reversals', '', 'how often the load goes over to the other sides of the teeth, in a mesh period', &
                   values, found, table)
    values = response%summary%apart
    call add_found('separation_share', '', 'part of the time during which all flanks are apart', values, found, table)
    associate (error => response%summary%error)
      call add_found('dte_mean_um', 'um', 'mean dynamic transmission error', (error%mean), found, table)
      call add_found('dte_rms_um', 'um', 'root mean square deviation from that', (error%rms), found, table)
      call add_found('dte_peak_to_peak_um', 'um', 'peak-to-peak dynamic transmission error', &
                     (error%largest - error%least), found, table)
    end associate
  end subroutine fill_points

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
    integer :: i, j, k, n, rows, from

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
          values(from:from + n, 3) = [(real(j, dp)/max(1, steady%periods), j=0, n)]
          if (has_result(steady%status)) then
            values(from:from + n, 4) = values(from:from + n, 3)/mesh_period(stages%motion(1)%mesh%teeth(1), one%rpm)
            associate (dte => one%summary%error, load => one%summary%load)
              values(from:from + n, 5) = [dte%mean, dte%amplitude]
              values(from:from + n, 6) = [0.0_dp, dte%phase]
              values(from:from + n, 7) = [load%mean, load%amplitude]
              values(from:from + n, 8) = [0.0_dp, load%phase]
            end associate
          end if
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

  pure subroutine add_report(self, lines)
    class(load_task_t), intent(in) :: self
    type(lines_t), intent(inout) :: lines

    call lines%add('')
    call lines%add('Dynamic factor at chosen speeds')
    associate (points => self%tables(self%place('load_points')))
      call points%show(lines, 'relief_um rpm dynamic_factor error_estimate status')
      call add_several(points, lines)
    end associate
    if (.not. self%with_torque) return
    call lines%add('')
    call lines%add('Transmitted torque')
    associate (points => self%tables(self%place('torque_points')))
      call points%show(lines, 'relief_um rpm pinion_mean_nm pinion_least_nm pinion_largest_nm gear_mean_nm gear_least_nm '// &
                       'gear_largest_nm friction_loss status')
    end associate
  end subroutine add_report

  !> Fills torques over the period of the motion (Karpat et al. 2012, Fig. 6).
  subroutine fill_torque(runs, radius, table, error)
    type(torque_run_t), intent(in) :: runs(:)
    real(dp), intent(in) :: radius(2)            !< base radii of pinion and gear, m
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: values(:, :)
    integer :: i, k, from, n, rows

    rows = sum([(rows_of(runs(i)), i=1, size(runs))])
    call claim_memory(8.0_dp*time_columns*rows, 'the table torque', error)
    if (allocated(error)) return
    allocate (values(rows, time_columns), source=no_number())
    call table%begin('transmitted torque over the time after which the motion repeats', rows, error)
    if (allocated(error)) return
    from = 1
    do i = 1, size(runs)
      n = rows_of(runs(i)) - 1
      values(from:from + n, 1) = runs(i)%relief
      values(from:from + n, 2) = runs(i)%rpm
      if (has_rows(runs(i))) then
        associate (mesh => runs(i)%mesh)
          values(from:from + n, 3) = mesh%tau
          values(from:from + n, 4) = mesh%tau*runs(i)%period
          do k = 1, 2
            values(from:from + n, 4 + k) = radius(k)*(mesh%elastic + mesh%damping + mesh%friction(k, :))
            values(from:from + n, 6 + k) = radius(k)*mesh%friction(k, :)
          end do
          values(from:from + n, 9) = radius(1)*mesh%damping
          values(from:from + n, 10) = mesh%error
        end associate
      end if
      from = from + n + 1
    end do
    call table%add_index(axis('relief_um', 'um', of_relief, values(:, 1)))
    call table%add_index(axis('rpm', '1/min', of_speed, values(:, 2)))
    call table%add_index(axis('tau', '', 'time in mesh periods since a pair entered at A; both ends of each step', values(:, 3)))
    call table%add('time_s', 's', 'the same time', values(:, 4))
    call table%add('pinion_torque_nm', 'N m', 'torque that the mesh takes from the pinion', values(:, 5))
    call table%add('gear_torque_nm', 'N m', 'torque that the mesh gives to the gear', values(:, 6))
    call table%add('pinion_friction_nm', 'N m', 'friction''s share of the pinion''s torque', values(:, 7))
    call table%add('gear_friction_nm', 'N m', 'friction''s share of the gear''s torque', values(:, 8))
    call table%add('pinion_damping_nm', 'N m', 'what damping carries of the pinion''s torque; of the gear''s it carries as '// &
                   'much as the base radii have it', values(:, 9))
    call table%add('dte_um', 'um', 'dynamic transmission error along the line of action, without the turning of whole '// &
                   'gears about their bores', values(:, 10))
  end subroutine fill_torque

  elemental logical function has_rows(run)
    type(torque_run_t), intent(in) :: run

    has_rows = allocated(run%mesh%tau)
  end function has_rows

  !> Number of rows of a run: one with NaN if it did not converge.
  elemental integer function rows_of(run)
    type(torque_run_t), intent(in) :: run

    rows_of = 1
    if (has_rows(run)) rows_of = size(run%mesh%tau)
  end function rows_of

  !> Fills a row for each relief and speed: mean, least and largest torque, and the power loss of the mesh.
  subroutine fill_torque_points(runs, speeds, radius, table, error)
    type(torque_run_t), intent(in) :: runs(:)
    integer, intent(in) :: speeds                !< number of speeds for each relief
    real(dp), intent(in) :: radius(2)            !< base radii of pinion and gear, m
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: values(size(runs), 5, 2)         ! mean, least, largest, their error, part of friction, N m; (run, 5, gear)
    real(dp) :: figures(5)                       ! the same of a force, N
    real(dp), dimension(size(runs)) :: loss, factor, estimate
    integer :: i, gear

    call table%begin('mean, least and largest transmitted torque at the speeds of the task load', size(runs), error, &
                     extent=[size(runs)/speeds, speeds])
    if (allocated(error)) return
    values = no_number()
    loss = no_number()
    do i = 1, size(runs)
      if (.not. has_rows(runs(i))) cycle
      do gear = 1, 2
        associate (force => runs(i)%mesh%force(gear), half => runs(i)%half(gear))
          figures(:3) = [force%mean, force%least, force%largest]
          ! Three times the change: where in its step an extreme lies is chance.
          figures(4) = 3*maxval(abs(figures(:3) - [half%mean, half%least, half%largest])) + runs(i)%other_error
          figures(5) = runs(i)%mesh%mean_friction(gear)
        end associate
        values(i, :, gear) = radius(gear)*figures
      end do
      loss(i) = 1 - runs(i)%mesh%force(2)%mean/runs(i)%mesh%force(1)%mean
    end do
    factor = merge(runs%point%dynamic_factor, no_number(), has_result(runs%point%steady%status))
    estimate = merge(runs%point%estimate, no_number(), has_result(runs%point%steady%status))
    call table%add_index(axis('relief_um', 'um', of_relief, [runs%relief]))
    call table%add_index(axis('rpm', '1/min', of_speed, [runs%rpm]))
    do gear = 1, 2
      associate (name => gear_names(gear))
        call table%add(trim(name)//'_mean_nm', 'N m', 'mean torque of the '//trim(name)//'; without friction it is the '// &
                       'static one', values(:, 1, gear))
        call table%add(trim(name)//'_least_nm', 'N m', 'least torque', values(:, 2, gear))
        call table%add(trim(name)//'_largest_nm', 'N m', 'largest torque', values(:, 3, gear))
        call table%add(trim(name)//'_error_nm', 'N m', 'estimated error of these three'//unknown, values(:, 4, gear))
        call table%add(trim(name)//'_friction_mean_nm', 'N m', 'friction''s share of the mean torque', values(:, 5, gear))
      end associate
    end do
    call table%add('friction_loss', '', 'part of the pinion''s power that friction between the flanks takes', loss)
    call table%add('dynamic_factor', '', of_factor, factor)
    call table%add('error_estimate', '', of_estimate, estimate)
    call table%add_words('status', of_status, words_of(runs%point%steady%status))
    call table%add('mesh_periods', '', of_periods, [runs%point%steady%periods])
    call table%add('motions', '', of_motions, [known_count(runs%motions)])
  end subroutine fill_torque_points

  !> Fills harmonics of the torque of both gears.
  subroutine fill_torque_harmonics(runs, radius, table, error)
    type(torque_run_t), intent(in) :: runs(:)
    real(dp), intent(in) :: radius(2)            !< base radii of pinion and gear, m
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: values(:, :)
    integer :: i, k, n, rows, from, gear

    if (allocated(error)) return
    rows = sum([(1 + harmonics_of(runs(i)), i=1, size(runs))])
    call table%begin('transmitted torque as the sum of amplitude cos(2 pi harmonic tau + phase) over the mesh periods tau; '// &
                     'harmonic 0 is the mean', rows, error)
    if (allocated(error)) return
    allocate (values(rows, 10), source=no_number())
    from = 1
    do i = 1, size(runs)
      n = harmonics_of(runs(i))
      values(from:from + n, 1) = runs(i)%relief
      values(from:from + n, 2) = runs(i)%rpm
      values(from:from + n, 3) = [(real(k, dp)/max(1, runs(i)%point%steady%periods), k=0, n)]
      values(from:from + n, 4) = values(from:from + n, 3)/runs(i)%period
      if (has_rows(runs(i))) then
        do gear = 1, 2
          values(from:from + n, 3*gear + 2:3*gear + 4) = &
            spectrum_of(runs(i)%mesh%force(gear), runs(i)%half(gear), runs(i)%other_error, radius(gear))
        end do
      end if
      from = from + n + 1
    end do
    call table%add_index(axis('relief_um', 'um', of_relief, values(:, 1)))
    call table%add_index(axis('rpm', '1/min', of_speed, values(:, 2)))
    call table%add_index(axis('harmonic', '', &
                              '0 for the mean, 1, 2 ... up to motion_harmonics for the mesh frequency; of a motion that '// &
                              'repeats after several mesh periods, also the parts between', values(:, 3)))
    call table%add('frequency_hz', 'Hz', 'frequency of that harmonic', values(:, 4))
    do gear = 1, 2
      associate (name => gear_names(gear), first => 3*gear + 2)
        call table%add(trim(name)//'_amplitude_nm', 'N m', 'half of peak-to-peak of the torque of the '//trim(name)// &
                       '; the mean for harmonic 0', values(:, first))
        call table%add(trim(name)//'_phase_deg', 'deg', 'its phase at tau = 0, where a pair enters at A, where the amplitude '// &
                       'is larger than its error', values(:, first + 1))
        call table%add(trim(name)//'_error_nm', 'N m', 'estimated error of the amplitude'//unknown, values(:, first + 2))
      end associate
    end do
  end subroutine fill_torque_harmonics

  elemental integer function harmonics_of(run)
    type(torque_run_t), intent(in) :: run

    harmonics_of = 0
    if (has_rows(run)) harmonics_of = size(run%mesh%force(1)%amplitude)
  end function harmonics_of

  !> Mean and harmonics of a force times a radius: amplitude (N m), phase (rad) and estimated error (N m).
  pure function spectrum_of(force, half, more, radius) result(values)
    type(spectrum_t), intent(in) :: force
    type(spectrum_t), intent(in) :: half         ! spectrum with half as many steps
    real(dp), intent(in) :: more                 ! error apart from that of the steps, N
    real(dp), intent(in) :: radius               ! radius, m
    real(dp) :: values(0:size(force%amplitude), 3)

    values(:, 1) = [force%mean, force%amplitude]
    values(:, 2) = [0.0_dp, force%phase]
    values(0, 3) = abs(force%mean - half%mean)
    values(1:, 3) = abs(polar(force%amplitude, force%phase) - polar(half%amplitude, half%phase))
    values(:, 3) = values(:, 3) + more
    if (.not. ieee_is_nan(more)) then
      where (values(:, 1) <= values(:, 3)) values(:, 2) = no_number()
    end if
    values(:, 1) = radius*values(:, 1)
    values(:, 3) = radius*values(:, 3)
  end function spectrum_of

  elemental complex(dp) function polar(amplitude, phase)
    real(dp), intent(in) :: amplitude, phase

    polar = amplitude*cmplx(cos(phase), sin(phase), dp)
  end function polar

  !> Computes the forces of a motion, and their figures with half as many steps.
  subroutine follow_torque(stages, relief, rpm, harmonics, run, error)
    type(stages_t), intent(in) :: stages
    integer, intent(in) :: relief                !< which of the case's reliefs
    real(dp), intent(in) :: rpm                  !< speed, 1/min
    integer, intent(in) :: harmonics             !< number of mesh harmonics
    type(torque_run_t), intent(inout) :: run     !< has the point; without a result it remains empty
    type(error_t), allocatable, intent(inout) :: error   !< out of memory
    type(trace_t), allocatable :: trace(:)
    type(mesh_torque_t) :: half
    logical :: out_of_memory

    associate (motion => stages%motion(relief), accuracy => stages%accuracy)
      run%relief = stages%amount(relief)
      run%rpm = rpm
      run%period = mesh_period(motion%mesh%teeth(1), rpm)
      if (.not. has_result(run%point%steady%status)) return
      run%other_error = stages%load*(accuracy%steady%tolerance + run%point%estimate - run%point%step_error)
      call trace_motion(motion, run%period, accuracy, run%point, trace, out_of_memory, in_half=.true.)
      if (.not. out_of_memory) then
        call find_torque(motion, run%period, trace, harmonics*size(trace), half)
        run%half = half%force
        call trace_motion(motion, run%period, accuracy, run%point, trace, out_of_memory)
      end if
      if (.not. out_of_memory) call find_torque(motion, run%period, trace, harmonics*size(trace), run%mesh)
    end associate
    if (out_of_memory) call fail(error, code_memory, '&sweep load_rpm = '//str(rpm)//': the memory does not hold the motion')
  end subroutine follow_torque
end module gearsweep_study_tasks_load
