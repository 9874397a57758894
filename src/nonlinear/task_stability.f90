!> The task `stability`: speeds and damping ratios at which the motion with all pairs in contact is unstable. Load and relief cancel
!> (see gearsweep_nonlinear_stability).
module gearsweep_nonlinear_task_stability
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_base, only: axis, code_input, code_memory, dp, error_t, fail, left, lines_t, right, str, table_t, &
    wants_stop
  use gearsweep_study, only: reader_t, runnable_t, stage, stages_t, task_info_t
  use gearsweep_nonlinear_stability, only: find_tongues, map_stability, stability_t, tongue_t
  implicit none
  private
  public :: stability_task_t

  type, extends(runnable_t) :: stability_task_t
    real(dp) :: damping_first = 0, damping_last = 0.2_dp
    integer :: damping_count = 101
    integer :: tongues = 10                      !< number of tongues
  contains
    procedure, nopass :: describe
    procedure :: read_keys, run, add_report
  end type stability_task_t

  character(*), parameter :: group = 'stability'
  !> Tolerance of the trace of the monodromy matrix.
  real(dp), parameter :: tolerance = 1e-10_dp

contains

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t(group, needs=[stage%mesh, stage%motion, stage%speeds], tables='stability tongues tongue_edges', fields='', &
      summary='Floquet multipliers of the motion with all pairs in contact over speed and damping, and its tongues of instability')
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
    if (reader%requests(group) .and. self%damping_last <= self%damping_first) call fail(error, code_input, &
      '&stability damping_last = '//str(self%damping_last)//': does not lie above damping_first = '//str(self%damping_first))
  end subroutine read_keys

  subroutine run(self, stages, error)
    class(stability_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: rpm(:), damping(:)
    type(stability_t) :: map
    type(tongue_t), allocatable :: tongue(:)
    integer :: i

    call self%list_speeds(stages, rpm)
    associate (n => self%damping_count)
      damping = [(self%damping_first + (self%damping_last - self%damping_first)*(i - 1)/(n - 1), i=1, n)]
    end associate
    allocate (tongue(self%tongues))
    call find_tongues(stages%motion(1), damping, tongue, error, stages%accuracy%steady%stop)
    if (allocated(error)) return
    call map_stability(stages%motion(1), rpm, damping, tolerance, map, stages%accuracy%steady%stop)
    if (map%lacks) call fail(error, code_memory, '&stability: the memory does not hold the map')
    if (allocated(error) .or. wants_stop(stages%accuracy%steady%stop)) return
    associate (table => self%tables(self%place('stability')))
      call table%over('stability of the motion with all pairs in contact; unstable where floquet_modulus is above 1', error, &
                      axis('rpm', '1/min', 'speed of the pinion', rpm), axis('damping_ratio', '', 'damping ratio', damping))
      if (allocated(error)) return
      call table%add('floquet_modulus', '', 'largest modulus of the Floquet multipliers: what remains of a disturbance '// &
                     'after a mesh period; NaN where the speed is too low', [transpose(map%modulus)])
      call table%add('sense', '', 'sign of that multiplier where it is real, 0 for a complex pair: beyond 1, a motion with '// &
                     '1 does not return, one with -1 doubles its period', [transpose(map%sense)])
    end associate
    associate (table => self%tables(self%place('tongues')))
      call table%over('tongues of instability, from the highest speed on', error, &
                      axis('tongue', '', 'which tongue', [(i, i=1, size(tongue))]))
      if (allocated(error)) return
      call table%add('closing_damping_ratio', '', 'damping ratio from which it is closed; NaN: above 1', [tongue%closing_damping])
      call table%add('closing_rpm', '1/min', 'speed of the pinion at its last point', [tongue%closing_rpm])
    end associate
    associate (table => self%tables(self%place('tongue_edges')))
      call table%over('edges of the tongues of instability: between them the motion repels', error, &
                      axis('tongue', '', 'which tongue', [(i, i=1, size(tongue))]), &
                      axis('damping_ratio', '', 'damping ratio', damping))
      if (allocated(error)) return
      call table%add('lower_rpm', '1/min', 'speed of the pinion; NaN where the tongue is closed', &
                     [(tongue(i)%edge(1, :), i=1, size(tongue))])
      call table%add('upper_rpm', '1/min', 'speed of the pinion; NaN where the tongue is closed', &
                     [(tongue(i)%edge(2, :), i=1, size(tongue))])
    end associate
    self%is_done = .true.
    self%failed = count(ieee_is_nan(map%modulus))
    self%log = 'stability: '//str(size(map%modulus))//' points, '//str(self%tongues)//' tongues'
  end subroutine run

  pure subroutine add_report(self, lines)
    class(stability_task_t), intent(in) :: self
    type(lines_t), intent(inout) :: lines
    real(dp) :: lower
    integer :: i, first

    call lines%add('')
    call lines%add('Stability with all pairs in contact, damping ratio '//str(self%damping_first)//' to '//str(self%damping_last))
    associate (tongues => self%tables(self%place('tongues')), edges => self%tables(self%place('tongue_edges')), &
               map => self%tables(self%place('stability')))
      if (tongues%rows > 0) call lines%add('   tongue   unstable at damping ratio '//left(str(self%damping_first), 6)// &
                                           ', rpm   closed from damping ratio    at rpm')
      do i = 1, tongues%rows
        call lines%put(right(str(i), 9))
        first = (i - 1)*edges%extent(2) + 1
        lower = edges%number('lower_rpm', first)
        if (.not. ieee_is_nan(lower)) call lines%put(right(str(lower, 5)//' to '//str(edges%number('upper_rpm', first), 5), 41))
        if (ieee_is_nan(lower)) call lines%put(right('nowhere', 41))
        call lines%add(right(str(tongues%number('closing_damping_ratio', i), 4), 28)// &
                       right(str(tongues%number('closing_rpm', i), 5), 10))
      end do
      call lines%add(left('Points', 19)//str(map%rows)//', unstable '//str(count(map%numbers('floquet_modulus') > 1))// &
                     ', too slow for the steps there may be '//str(self%failed))
    end associate
  end subroutine add_report
end module gearsweep_nonlinear_task_stability
