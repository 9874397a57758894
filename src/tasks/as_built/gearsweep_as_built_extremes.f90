!> What the task `as_built` tells of each pair of gears and assembly on demand: peak-to-peak static transmission error and largest
!> root stress, beside those of gears without deviations.
module gearsweep_as_built_extremes
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_as_built_machines, only: deviating, follow_turn, machine_t
  use gearsweep_as_built_tables, only: quantile
  use gearsweep_error, only: error_t
  use gearsweep_harmonics, only: static_range
  use gearsweep_kinds, only: dp
  use gearsweep_lines, only: lines_t, right
  use gearsweep_mesh, only: mesh_t
  use gearsweep_oscillator, only: oscillator_t
  use gearsweep_stages, only: stages_t
  use gearsweep_status, only: has_result
  use gearsweep_stop, only: wants_stop
  use gearsweep_sweep, only: sweep_t
  use gearsweep_table, only: no_number, table_t
  use gearsweep_task, only: members
  use gearsweep_text, only: fixed, str
  use gearsweep_turn, only: turn_t
  implicit none
  private
  public :: extremes_t, find_extremes, add_extremes, report_extremes

  !> Not allocated where not wanted. Machine 0 has no deviations; the assembly changes faster than the draw.
  type :: extremes_t
    real(dp), allocatable :: ste(:, :)           !< m; (0:machine, relief)
    real(dp), allocatable :: stress(:, :, :)     !< of pinion and gear, Pa; (0:machine, relief, gear)
  end type extremes_t

contains

  !> Those of all pairs of gears. Ends early where the caller stops the run.
  subroutine find_extremes(stages, which, nominal, machines, with_ste, unit_stress, found, error)
    type(stages_t), intent(in) :: stages
    integer, intent(in) :: which(:)              !< reliefs of the case
    type(sweep_t), intent(in) :: nominal
    type(machine_t), intent(in) :: machines(:, :)          !< as swept; (assembly, draw)
    logical, intent(in) :: with_ste
    real(dp), allocatable, intent(in) :: unit_stress(:, :)           !< of `unit_root_stress`; not allocated: no stress is wanted
    type(extremes_t), intent(out) :: found
    type(error_t), allocatable, intent(inout) :: error
    type(mesh_t) :: mesh
    integer :: a, d, i, k

    if (with_ste) allocate (found%ste(0:size(machines), size(which)), source=no_number())
    if (allocated(unit_stress)) allocate (found%stress(0:size(machines), size(which), 2), source=no_number())
    do i = 1, size(which)
      associate (motion => stages%motion(which(i):which(i)), answered => has_result(nominal%status(:, i)))
        if (with_ste) found%ste(0, i) = static_range(motion(1)%mesh, motion(1)%load)
        if (allocated(unit_stress) .and. any(answered)) &
          call find_stress(motion, nominal%rpm(maxloc(nominal%dynamic_factor(:, i), 1, mask=answered)), 0)
        k = 0
        do d = 1, size(machines, 2)
          do a = 1, size(machines, 1)
            if (allocated(error) .or. wants_stop(stages%accuracy%steady%stop)) return
            k = k + 1
            if (with_ste) then
              mesh = motion(1)%mesh
              mesh%deviations = machines(a, d)%deviations
              found%ste(k, i) = static_range(mesh, motion(1)%load)
            end if
            if (.not. allocated(unit_stress)) cycle
            associate (worst => machines(a, d)%worst(i))
              if (allocated(worst%stress)) then
                found%stress(k, i, :) = worst%stress
              else if (worst%rpm > 0) then
                call find_stress(deviating(motion, machines(a, d)%deviations, error), worst%rpm, k)
              end if
            end associate
          end do
        end do
      end associate
    end do

  contains

    !> That of the teeth of one machine which are stressed most.
    subroutine find_stress(osc, rpm, machine)
      type(oscillator_t), intent(in) :: osc(:)   ! one
      real(dp), intent(in) :: rpm
      integer, intent(in) :: machine
      type(turn_t) :: turn

      if (allocated(error)) return
      call follow_turn(osc(1), rpm, stages, turn, error, unit_stress)
      if (allocated(turn%stress)) found%stress(machine, i, :) = maxval(turn%stress, 2)
    end subroutine find_stress
  end subroutine find_extremes

  !> Adds their columns to the table over relief, draw and assembly.
  subroutine add_extremes(found, table)
    type(extremes_t), intent(in) :: found
    type(table_t), intent(inout) :: table
    integer :: i

    if (allocated(found%ste)) then
      call table%add('ste_peak_to_peak_um', 'um', 'largest less least static transmission error over the turn', &
                     1e6_dp*[found%ste(1:, :)])
      call table%add('nominal_ste_peak_to_peak_um', 'um', 'the same of gears without deviations', &
                     1e6_dp*[spread(found%ste(0, :), 1, ubound(found%ste, 1))])
    end if
    if (.not. allocated(found%stress)) return
    do i = 1, 2
      call table%add(trim(members(i))//'_root_stress_mpa', 'MPa', 'largest nominal tooth root stress sigma_F0 of ISO 6336-3 '// &
                     'over the turn, of the load where it acts, in motion at the speed of the largest DF', &
                     [found%stress(1:, :, i)]/1e6_dp)
      call table%add('nominal_'//trim(members(i))//'_root_stress_mpa', 'MPa', 'the same of gears without deviations, at the '// &
                     'speed of their largest DF', [spread(found%stress(0, :, i), 1, ubound(found%stress, 1))]/1e6_dp)
    end do
  end subroutine add_extremes

  !> The same for the screen: nominal, and what those of all pairs of gears and assemblies are.
  pure subroutine report_extremes(table, lines)
    type(table_t), intent(in) :: table
    type(lines_t), intent(inout) :: lines
    character(*), parameter :: columns(3) = [character(22) :: 'ste_peak_to_peak_um', 'pinion_root_stress_mpa', &
                                             'gear_root_stress_mpa']
    character(*), parameter :: titles(3) = [character(44) :: 'peak-to-peak static transmission error, um', &
                                            'root stress of the pinion, MPa', 'root stress of the gear, MPa']
    real(dp), allocatable :: values(:)
    integer :: i, k, machines, row

    machines = table%extent(2)*table%extent(3)
    do i = 1, size(columns)
      if (table%position(trim(columns(i))) == 0) cycle
      call lines%add('')
      call lines%add('Gears as built: '//trim(titles(i)))
      call lines%add('   relief um   nominal     least    median      95 %   largest')
      do row = 1, table%rows, machines
        values = [(table%number(trim(columns(i)), row + k), k=0, machines - 1)]
        values = pack(values, .not. ieee_is_nan(values))
        call lines%put(right(str(table%number('relief_um', row)), 12)//told(table%number('nominal_'//trim(columns(i)), row)))
        if (size(values) > 0) call lines%put(told(minval(values))//told(quantile(values, 0.5_dp))// &
                                             told(quantile(values, 0.95_dp))//told(maxval(values)))
        call lines%add('')
      end do
    end do

  contains

    pure character(10) function told(number)
      real(dp), intent(in) :: number

      told = right('none', 10)
      if (.not. ieee_is_nan(number)) told = right(fixed(number, 2), 10)
    end function told
  end subroutine report_extremes
end module gearsweep_as_built_extremes
