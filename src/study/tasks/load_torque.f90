!> Tables of the task `load` on the torques of the mesh on pinion and gear over time, at chosen speeds.
module gearsweep_study_tasks_load_torque
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_base, only: axis, claim_memory, code_memory, dp, error_t, fail, lines_t, no_number, right, str, table_t
  use gearsweep_motion, only: find_torque, has_result, mesh_period, mesh_torque_t, point_t, spectrum_t, trace_motion, trace_t
  use gearsweep_study_case_task, only: gear_names
  use gearsweep_study_run_points, only: known_count, of_estimate, of_factor, of_motions, of_periods, of_relief, &
    of_speed, of_status, words_of
  use gearsweep_study_run_stages, only: stages_t
  implicit none
  private
  public :: torque_run_t, claim_torques, follow_torque, fill_time, fill_points, fill_harmonics, add_torques

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
    real(dp) :: left_open = 0
  end type torque_run_t

  integer, parameter :: time_columns = 10
  !> Memory of a row of the table of times before it is written, without the table, and of a harmonic of both gears with its row.
  real(dp), parameter :: row_bytes = 8*(time_columns + 6), harmonic_bytes = 8*(8 + 10)
  character(*), parameter :: unknown = '; NaN where it is not known'

contains

  !> Fills torques over the period of the motion (Karpat et al. 2012, Fig. 6).
  subroutine fill_time(runs, radius, table, error)
    type(torque_run_t), intent(in) :: runs(:)
    real(dp), intent(in) :: radius(2)            !< base radii of pinion and gear, m
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: values(:, :)
    integer :: i, from, n, rows

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
      if (has_rows(runs(i))) call fill_run(runs(i)%mesh, radius, runs(i)%period, values(from:from + n, 3:))
      from = from + n + 1
    end do
    call table%add_index(axis('relief_um', 'um', of_relief, values(:, 1)))
    call table%add_index(axis('rpm', '1/min', of_speed, values(:, 2)))
    call table%add_index(axis('tau', '', 'time in mesh periods since a pair entered at A; both ends of each step', values(:, 3)))
    call table%add('time_s', 's', 'the same time', values(:, 4))
    call table%add('pinion_torque_nm', 'N*m', 'torque that the mesh takes from the pinion', values(:, 5))
    call table%add('gear_torque_nm', 'N*m', 'torque that the mesh gives to the gear', values(:, 6))
    call table%add('pinion_friction_nm', 'N*m', 'friction''s share of the pinion''s torque', values(:, 7))
    call table%add('gear_friction_nm', 'N*m', 'friction''s share of the gear''s torque', values(:, 8))
    call table%add('pinion_damping_nm', 'N*m', 'what damping carries of the pinion''s torque; of the gear''s it carries as '// &
                   'much as the base radii have it', values(:, 9))
    call table%add('dte_um', 'um', 'dynamic transmission error along the line of action, without the turning of whole '// &
                   'gears about their bores', values(:, 10))
  end subroutine fill_time

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

  !> Computes time (mesh periods, s), torques of both gears, parts of friction and damping (N m), and transmission error (m).
  pure subroutine fill_run(mesh, radius, period, values)
    type(mesh_torque_t), intent(in) :: mesh
    real(dp), intent(in) :: radius(2)            ! base radii, m
    real(dp), intent(in) :: period               ! mesh period, s
    real(dp), intent(inout) :: values(:, :)
    integer :: i

    values(:, 1) = mesh%tau
    values(:, 2) = mesh%tau*period
    do i = 1, 2
      values(:, 2 + i) = radius(i)*(mesh%elastic + mesh%damping + mesh%friction(i, :))
      values(:, 4 + i) = radius(i)*mesh%friction(i, :)
    end do
    values(:, 7) = radius(1)*mesh%damping
    values(:, 8) = mesh%error
  end subroutine fill_run

  !> Fills a row for each relief and speed: mean, least and largest torque, and the power loss of the mesh.
  subroutine fill_points(runs, speeds, radius, table, error)
    type(torque_run_t), intent(in) :: runs(:)
    integer, intent(in) :: speeds                !< number of speeds for each relief
    real(dp), intent(in) :: radius(2)            !< base radii of pinion and gear, m
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: values(size(runs), 5, 2), loss(size(runs))
    real(dp), dimension(size(runs)) :: factor, estimate
    integer :: i, gear

    call table%begin('mean, least and largest transmitted torque at the speeds of the task load', size(runs), error, &
                     extent=[size(runs)/speeds, speeds])
    if (allocated(error)) return
    values = no_number()
    loss = no_number()
    do i = 1, size(runs)
      if (.not. has_rows(runs(i))) cycle
      do gear = 1, 2
        values(i, :, gear) = radius(gear)*figures(runs(i), gear)
      end do
      loss(i) = 1 - runs(i)%mesh%force(2)%mean/runs(i)%mesh%force(1)%mean
    end do
    factor = merge(runs%point%dynamic_factor, no_number(), has_result(runs%point%steady%status))
    estimate = merge(runs%point%estimate, no_number(), has_result(runs%point%steady%status))
    call table%add_index(axis('relief_um', 'um', of_relief, [runs%relief]))
    call table%add_index(axis('rpm', '1/min', of_speed, [runs%rpm]))
    do gear = 1, 2
      call add_gear(trim(gear_names(gear)), values(:, :, gear), table)
    end do
    call table%add('friction_loss', '', 'part of the pinion''s power that friction between the flanks takes', loss)
    call table%add('dynamic_factor', '', of_factor, factor)
    call table%add('error_estimate', '', of_estimate, estimate)
    call table%add_words('status', of_status, words_of(runs%point%steady%status))
    call table%add('mesh_periods', '', of_periods, [runs%point%steady%periods])
    call table%add('motions', '', of_motions, [known_count(runs%motions)])
  end subroutine fill_points

  pure subroutine add_gear(name, values, table)
    character(*), intent(in) :: name
    real(dp), contiguous, intent(in) :: values(:, :)   ! mean, least, largest, their error, part of friction, N m; (row, 5)
    type(table_t), intent(inout) :: table

    call table%add(name//'_mean_nm', 'N*m', 'mean torque of the '//name//'; without friction it is the static one', values(:, 1))
    call table%add(name//'_least_nm', 'N*m', 'least torque', values(:, 2))
    call table%add(name//'_largest_nm', 'N*m', 'largest torque', values(:, 3))
    call table%add(name//'_error_nm', 'N*m', 'estimated error of these three'//unknown, values(:, 4))
    call table%add(name//'_friction_mean_nm', 'N*m', 'friction''s share of the mean torque', values(:, 5))
  end subroutine add_gear

  !> Mean, least and largest force on a gear, their estimated error, and the mean part of friction (N).
  pure function figures(run, gear)
    type(torque_run_t), intent(in) :: run
    integer, intent(in) :: gear
    real(dp) :: figures(5)

    associate (force => run%mesh%force(gear), half => run%half(gear))
      figures(:3) = [force%mean, force%least, force%largest]
      ! Three times the change: where in its step an extreme lies is chance.
      figures(4) = 3*maxval(abs(figures(:3) - [half%mean, half%least, half%largest])) + run%left_open
      figures(5) = run%mesh%mean_friction(gear)
    end associate
  end function figures

  !> Fills harmonics of the torque of both gears.
  subroutine fill_harmonics(runs, radius, table, error)
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
            spectrum_of(runs(i)%mesh%force(gear), runs(i)%half(gear), runs(i)%left_open, radius(gear))
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
        call table%add(trim(name)//'_amplitude_nm', 'N*m', 'half of peak-to-peak of the torque of the '//trim(name)// &
                       '; the mean for harmonic 0', values(:, first))
        call table%add(trim(name)//'_phase_deg', 'deg', 'its phase at tau = 0, where a pair enters at A, where the amplitude '// &
                       'is larger than its error', values(:, first + 1))
        call table%add(trim(name)//'_error_nm', 'N*m', 'estimated error of the amplitude'//unknown, values(:, first + 2))
      end associate
    end do
  end subroutine fill_harmonics

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

  !> Claims the memory of `n` motions with so many mesh harmonics.
  subroutine claim_torques(n, harmonics, error)
    integer, intent(in) :: n, harmonics
    type(error_t), allocatable, intent(inout) :: error
    real(dp), parameter :: fewest_rows = 400

    call claim_memory((row_bytes*fewest_rows + harmonic_bytes*harmonics)*n, '&sweep load_torque: '//str(n)//' motions', error)
  end subroutine claim_torques

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
    logical :: lacks

    associate (motion => stages%motion(relief), accuracy => stages%accuracy)
      run%relief = stages%amount(relief)
      run%rpm = rpm
      run%period = mesh_period(motion%mesh%teeth(1), rpm)
      if (.not. has_result(run%point%steady%status)) return
      run%left_open = stages%load*(accuracy%steady%tolerance + run%point%estimate - run%point%step_error)
      call trace_motion(motion, run%period, accuracy, run%point, trace, lacks, in_half=.true.)
      if (.not. lacks) then
        call find_torque(motion, run%period, trace, harmonics*size(trace), half)
        run%half = half%force
        call trace_motion(motion, run%period, accuracy, run%point, trace, lacks)
      end if
      if (.not. lacks) call find_torque(motion, run%period, trace, harmonics*size(trace), run%mesh)
    end associate
    if (lacks) call fail(error, code_memory, '&sweep load_rpm = '//str(rpm)//': the memory does not hold the motion')
  end subroutine follow_torque

  !> Reports the torques of a table of `fill_points`.
  pure subroutine add_torques(points, lines)
    type(table_t), intent(in) :: points
    type(lines_t), intent(inout) :: lines
    integer :: row

    call lines%add('')
    call lines%add('Transmitted torque (N m): mean, least to largest')
    call lines%add('   relief um         rpm      pinion                      gear                        friction loss')
    do row = 1, points%rows
      call lines%put(right(str(points%number('relief_um', row)), 12)//right(str(points%number('rpm', row)), 12)//'   ')
      if (ieee_is_nan(points%number('pinion_mean_nm', row))) then
        call lines%add('   '//trim(points%word('status', row)))
        cycle
      end if
      call lines%add('   '//torques('pinion', points, row)//torques('gear', points, row)// &
                     str(points%number('friction_loss', row), 4))
    end do
  end subroutine add_torques

  pure function torques(gear, points, row) result(words)
    character(*), intent(in) :: gear
    type(table_t), intent(in) :: points
    integer, intent(in) :: row
    character(28) :: words

    words = str(points%number(gear//'_mean_nm', row), 5)//', '//str(points%number(gear//'_least_nm', row), 5)//' to '// &
            str(points%number(gear//'_largest_nm', row), 5)
  end function torques
end module gearsweep_study_tasks_load_torque
