!> The task `stability`: where the motion with all pairs in contact repels, over speed and damping. Load and relief drop
!> out of it (see gearsweep_stability).
module gearsweep_task_stability
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_error, only: code_input, code_memory, error_t, fail
  use gearsweep_kinds, only: dp
  use gearsweep_lines, only: left, lines_t, right
  use gearsweep_memory, only: claim_memory
  use gearsweep_reader, only: reader_t
  use gearsweep_stability, only: map_stability, stability_t
  use gearsweep_table, only: each, over_and_over, table_t
  use gearsweep_task, only: stages_t, task_info_t, task_t
  use gearsweep_text, only: str
  use gearsweep_tongues, only: find_tongues, tongue_t
  implicit none
  private
  public :: stability_task_t

  type, extends(task_t) :: stability_task_t
    real(dp) :: damping_first = 0, damping_last = 0.2_dp
    integer :: damping_count = 101
    integer :: tongues = 10                      !< how many to find
    ! Result:
    real(dp), allocatable :: rpm(:), damping(:)
    type(stability_t) :: map
    type(tongue_t), allocatable :: tongue(:)
  contains
    procedure, nopass :: describe
    procedure :: read_keys, run, fill_table, add_report
  end type stability_task_t

  character(*), parameter :: group = 'stability'
  !> Of the trace of a mesh period's map.
  real(dp), parameter :: tolerance = 1e-10_dp

contains

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t(group, needs='mesh motion speeds', tables='stability tongues tongue_edges', &
      gives='Floquet multipliers of the motion with all pairs in contact over speed and damping, and its tongues of instability')
  end subroutine describe

  subroutine read_keys(self, reader, error)
    class(stability_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    type(error_t), allocatable, intent(inout) :: error

    call reader%add_group(group, 'The task stability, over the speeds of &sweep or its own; relief, load and '// &
                          '&dynamics damping_ratio do not matter to it.')
    call self%read_speeds(reader, group, error)
    call reader%get(group, 'damping_first', self%damping_first, error, tasks=group, at_least=0.0_dp, at_most=1000.0_dp, &
                    meaning='least damping ratio of the map')
    call reader%get(group, 'damping_last', self%damping_last, error, tasks=group, at_least=0.0_dp, at_most=1000.0_dp, &
                    meaning='largest damping ratio of the map, above damping_first')
    call reader%get(group, 'damping_count', self%damping_count, error, tasks=group, at_least=2, at_most=100000, &
                    meaning='how many damping ratios the map has, in equal steps')
    call reader%get(group, 'tongues', self%tongues, error, tasks=group, at_least=0, at_most=100, &
                    meaning='how many tongues of instability to find, from the highest speed on')
    if (reader%wants(group) .and. self%damping_last <= self%damping_first) call fail(error, code_input, &
      '&stability damping_last = '//str(self%damping_last)//': does not lie above damping_first = '//str(self%damping_first))
  end subroutine read_keys

  subroutine run(self, stages, error)
    class(stability_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(error_t), allocatable, intent(inout) :: error
    integer :: i

    call self%list_speeds(stages, self%rpm)
    associate (n => self%damping_count)
      self%damping = [(self%damping_first + (self%damping_last - self%damping_first)*(i - 1)/(n - 1), i=1, n)]
      call claim_memory(12.0_dp*size(self%rpm)*n, '&stability: '//str(size(self%rpm))//' speeds by '//str(n)// &
                        ' damping ratios', error)
    end associate
    if (allocated(error)) return
    allocate (self%tongue(self%tongues))
    call find_tongues(stages%motion(1), self%damping, self%tongue, error)
    if (allocated(error)) return
    call map_stability(stages%motion(1), self%rpm, self%damping, tolerance, self%map)
    if (self%map%lacks) call fail(error, code_memory, '&stability: the memory does not hold the map')
    if (allocated(error)) return
    self%is_done = .true.
    self%failed = count(ieee_is_nan(self%map%modulus))
    self%log = 'stability: '//str(size(self%map%modulus))//' points, '//str(self%tongues)//' tongues'
  end subroutine run

  pure subroutine fill_table(self, table, error)
    class(stability_task_t), intent(in) :: self
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: edge(:, :)
    integer :: i, n, m, k

    n = size(self%rpm)
    m = size(self%damping)
    k = size(self%tongue)
    select case (table%name)
    case ('stability')
      call table%begin('stability of the motion with all pairs in contact; unstable where floquet_modulus is above 1', &
                       n*m, 4, error, extent=[n, m])
      if (allocated(error)) return
      call table%add_index('rpm', '1/min', 'speed of the pinion', each(self%rpm, m))
      call table%add_index('damping_ratio', '', 'damping ratio', over_and_over(self%damping, n))
      call table%add('floquet_modulus', '', 'largest modulus of the Floquet multipliers: what remains of a disturbance '// &
                     'after a mesh period; NaN where the speed is too low', [transpose(self%map%modulus)])
      call table%add('sense', '', 'sign of that multiplier where it is real, 0 for a complex pair: beyond 1, a motion with '// &
                     '1 does not return, one with -1 doubles its period', [transpose(self%map%sense)])
    case ('tongues')
      call table%begin('tongues of instability, from the highest speed on', k, 3, error, extent=[k])
      if (allocated(error)) return
      call table%add_index('tongue', '', 'which tongue', [(i, i=1, k)])
      call table%add('closing_damping_ratio', '', 'damping ratio from which it is closed; NaN: above 1', &
                     [self%tongue%closing_damping])
      call table%add('closing_rpm', '1/min', 'speed of the pinion at its last point', [self%tongue%closing_rpm])
    case ('tongue_edges')
      call table%begin('edges of the tongues of instability: between them the motion repels', k*m, 4, error, extent=[k, m])
      if (allocated(error)) return
      call table%add_index('tongue', '', 'which tongue', each([(i, i=1, k)], m))
      call table%add_index('damping_ratio', '', 'damping ratio', over_and_over(self%damping, k))
      allocate (edge(m*k, 2))
      do i = 1, k
        edge((i - 1)*m + 1:i*m, 1) = self%tongue(i)%edge(1, :)
        edge((i - 1)*m + 1:i*m, 2) = self%tongue(i)%edge(2, :)
      end do
      call table%add('lower_rpm', '1/min', 'speed of the pinion; NaN where the tongue is closed', edge(:, 1))
      call table%add('upper_rpm', '1/min', 'speed of the pinion; NaN where the tongue is closed', edge(:, 2))
    case default  ! it has no other
    end select
  end subroutine fill_table

  pure subroutine add_report(self, lines)
    class(stability_task_t), intent(in) :: self
    type(lines_t), intent(inout) :: lines
    integer :: i

    call lines%add('')
    call lines%add('Stability with all pairs in contact, damping ratio '//str(self%damping(1))//' to '// &
                   str(self%damping(size(self%damping))))
    if (size(self%tongue) > 0) call lines%add('   tongue   unstable at damping ratio '//left(str(self%damping(1)), 6)// &
                                              ', rpm   closed from damping ratio    at rpm')
    do i = 1, size(self%tongue)
      associate (tongue => self%tongue(i))
        call lines%put(right(str(i), 9))
        if (tongue%edge(1, 1) > 0) call lines%put(right(str(tongue%edge(1, 1), 5)//' to '//str(tongue%edge(2, 1), 5), 41))
        if (.not. tongue%edge(1, 1) > 0) call lines%put(right('nowhere', 41))
        call lines%add(right(str(tongue%closing_damping, 4), 28)//right(str(tongue%closing_rpm, 5), 10))
      end associate
    end do
    call lines%add(left('Points', 19)//str(size(self%map%modulus))//', unstable '//str(count(self%map%modulus > 1))// &
                   ', too slow for the steps there may be '//str(self%failed))
  end subroutine add_report
end module gearsweep_task_stability
