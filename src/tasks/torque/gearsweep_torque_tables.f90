!> What the task `torque` finds, as its tables.
module gearsweep_torque_tables
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_decimal, only: in_um
  use gearsweep_error, only: error_t
  use gearsweep_error_estimate, only: point_t
  use gearsweep_kinds, only: dp, pi
  use gearsweep_memory, only: claim_memory
  use gearsweep_mesh_torque, only: mesh_torque_t
  use gearsweep_points, only: known_count, of_estimate, of_factor, of_motions, of_periods, of_relief, of_speed, of_status, words_of
  use gearsweep_spectrum, only: spectrum_t
  use gearsweep_status, only: has_result
  use gearsweep_table, only: axis, no_number, table_t
  implicit none
  private
  public :: torque_run_t, row_bytes, harmonic_bytes, fill_time, fill_points, fill_harmonics

  !> Of one relief and speed.
  type :: torque_run_t
    real(dp) :: relief = 0                       !< m
    real(dp) :: rpm = 0                          !< 1/min
    real(dp) :: period = 0                       !< of the mesh, s
    type(point_t) :: point
    integer :: motions = 0                       !< how many there are; 0: not known
    type(mesh_torque_t) :: mesh                  !< without rows where the point has no result
    type(spectrum_t) :: half(2)                  !< of the forces in half as many steps
    !> How wrong the forces may be beside the steps, N, as the motion was followed until it nearly repeats; NaN by a method whose
    !> steps do not tell their error.
    real(dp) :: left_open = 0
  end type torque_run_t

  integer, parameter :: time_columns = 10
  !> What a row of the table of times takes until it is written, beside the table, and a harmonic of both gears with its row.
  real(dp), parameter :: row_bytes = 8*(time_columns + 6), harmonic_bytes = 8*(8 + 10)
  character(*), parameter :: unknown = '; NaN where it is not known'
  character(6), parameter :: members(2) = [character(6) :: 'pinion', 'gear']
  real(dp), parameter :: micro = 1e6_dp

contains

  !> Torques over the time after which the motion repeats (Karpat et al. 2012, Fig. 6).
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
      values(from:from + n, 1) = in_um(runs(i)%relief)
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

  !> A row of nothing where there is no result.
  elemental integer function rows_of(run)
    type(torque_run_t), intent(in) :: run

    rows_of = 1
    if (has_rows(run)) rows_of = size(run%mesh%tau)
  end function rows_of

  !> Time (mesh periods, s), torques of both gears, friction's shares, damping's (N m), and the transmission error (um).
  pure subroutine fill_run(mesh, radius, period, values)
    type(mesh_torque_t), intent(in) :: mesh
    real(dp), intent(in) :: radius(2)            ! base radii, m
    real(dp), intent(in) :: period               ! s
    real(dp), intent(inout) :: values(:, :)
    integer :: i

    values(:, 1) = mesh%tau
    values(:, 2) = mesh%tau*period
    do i = 1, 2
      values(:, 2 + i) = radius(i)*(mesh%elastic + mesh%damping + mesh%friction(i, :))
      values(:, 4 + i) = radius(i)*mesh%friction(i, :)
    end do
    values(:, 7) = radius(1)*mesh%damping
    values(:, 8) = micro*mesh%error
  end subroutine fill_run

  !> A row for each relief and speed: mean, least and largest torque, and what the mesh loses.
  subroutine fill_points(runs, speeds, radius, table, error)
    type(torque_run_t), intent(in) :: runs(:)
    integer, intent(in) :: speeds                !< of each relief
    real(dp), intent(in) :: radius(2)            !< base radii of pinion and gear, m
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: values(size(runs), 5, 2), loss(size(runs))
    real(dp), dimension(size(runs)) :: factor, estimate
    integer :: i, member

    call table%begin('mean, least and largest transmitted torque at the speeds of the task torque', size(runs), error, &
                     extent=[size(runs)/speeds, speeds])
    if (allocated(error)) return
    values = no_number()
    loss = no_number()
    do i = 1, size(runs)
      if (.not. has_rows(runs(i))) cycle
      do member = 1, 2
        values(i, :, member) = radius(member)*figures(runs(i), member)
      end do
      loss(i) = 1 - runs(i)%mesh%force(2)%mean/runs(i)%mesh%force(1)%mean
    end do
    factor = merge(runs%point%dynamic_factor, no_number(), has_result(runs%point%steady%status))
    estimate = merge(runs%point%estimate, no_number(), has_result(runs%point%steady%status))
    call table%add_index(axis('relief_um', 'um', of_relief, in_um(runs%relief)))
    call table%add_index(axis('rpm', '1/min', of_speed, [runs%rpm]))
    do member = 1, 2
      call add_member(trim(members(member)), values(:, :, member), table)
    end do
    call table%add('friction_loss', '', 'part of the pinion''s power that friction between the flanks takes', loss)
    call table%add('dynamic_factor', '', of_factor, factor)
    call table%add('error_estimate', '', of_estimate, estimate)
    call table%add_words('status', of_status, words_of(runs%point%steady%status))
    call table%add('mesh_periods', '', of_periods, [runs%point%steady%periods])
    call table%add('motions', '', of_motions, [known_count(runs%motions)])
  end subroutine fill_points

  pure subroutine add_member(name, values, table)
    character(*), intent(in) :: name
    real(dp), contiguous, intent(in) :: values(:, :)   ! mean, least, largest, their error, friction's share, N m; (row, 5)
    type(table_t), intent(inout) :: table

    call table%add(name//'_mean_nm', 'N*m', 'mean torque of the '//name//'; without friction it is the static one', values(:, 1))
    call table%add(name//'_least_nm', 'N*m', 'least torque', values(:, 2))
    call table%add(name//'_largest_nm', 'N*m', 'largest torque', values(:, 3))
    call table%add(name//'_error_nm', 'N*m', 'estimated error of these three'//unknown, values(:, 4))
    call table%add(name//'_friction_mean_nm', 'N*m', 'friction''s share of the mean torque', values(:, 5))
  end subroutine add_member

  !> Mean, least and largest force on a gear, the estimated error of these, and friction's mean share (N).
  pure function figures(run, member)
    type(torque_run_t), intent(in) :: run
    integer, intent(in) :: member
    real(dp) :: figures(5)

    associate (force => run%mesh%force(member), half => run%half(member))
      figures(:3) = [force%mean, force%least, force%largest]
      ! Three times raised: it is chance where in its step an extreme lies.
      figures(4) = 3*maxval(abs(figures(:3) - [half%mean, half%least, half%largest])) + run%left_open
      figures(5) = run%mesh%mean_friction(member)
    end associate
  end function figures

  !> Harmonics of the torque of both gears.
  subroutine fill_harmonics(runs, radius, table, error)
    type(torque_run_t), intent(in) :: runs(:)
    real(dp), intent(in) :: radius(2)            !< base radii of pinion and gear, m
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: values(:, :)
    integer :: i, k, n, rows, from, member

    if (allocated(error)) return
    rows = sum([(1 + harmonics_of(runs(i)), i=1, size(runs))])
    call table%begin('transmitted torque as the sum of amplitude cos(2 pi harmonic tau + phase) over the mesh periods tau; '// &
                     'harmonic 0 is the mean', rows, error)
    if (allocated(error)) return
    allocate (values(rows, 10), source=no_number())
    from = 1
    do i = 1, size(runs)
      n = harmonics_of(runs(i))
      values(from:from + n, 1) = in_um(runs(i)%relief)
      values(from:from + n, 2) = runs(i)%rpm
      values(from:from + n, 3) = [(real(k, dp)/max(1, runs(i)%point%steady%periods), k=0, n)]
      values(from:from + n, 4) = values(from:from + n, 3)/runs(i)%period
      if (has_rows(runs(i))) then
        do member = 1, 2
          values(from:from + n, 3*member + 2:3*member + 4) = &
            spectrum_of(runs(i)%mesh%force(member), runs(i)%half(member), runs(i)%left_open, radius(member))
        end do
      end if
      from = from + n + 1
    end do
    call table%add_index(axis('relief_um', 'um', of_relief, values(:, 1)))
    call table%add_index(axis('rpm', '1/min', of_speed, values(:, 2)))
    call table%add_index(axis('harmonic', '', &
                              '0 for the mean, 1, 2 ... up to harmonics for the mesh frequency; of a motion that '// &
                              'repeats after several mesh periods, also the parts between', values(:, 3)))
    call table%add('frequency_hz', 'Hz', 'frequency of that harmonic', values(:, 4))
    do member = 1, 2
      associate (name => members(member), first => 3*member + 2)
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

  !> Mean and harmonics of a force times a radius: amplitude (N m), phase (deg) and estimated error (N m).
  pure function spectrum_of(force, half, more, radius) result(values)
    type(spectrum_t), intent(in) :: force
    type(spectrum_t), intent(in) :: half         ! in half as many steps
    real(dp), intent(in) :: more                 ! error beside that of the steps, N
    real(dp), intent(in) :: radius               ! m
    real(dp) :: values(0:size(force%amplitude), 3)

    values(:, 1) = [force%mean, force%amplitude]
    values(:, 2) = [0.0_dp, force%phase]*180/pi
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
end module gearsweep_torque_tables
