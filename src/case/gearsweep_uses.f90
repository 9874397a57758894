!> What a key is good for. It waits where a task that the case does not name would use it, or where
!> another of its values makes it idle: it is read, and named as not used. It is refused where it contradicts
!> the case's other keys.
module gearsweep_uses
  use gearsweep_case, only: case_t
  implicit none
  private
  public :: for_tasks, unless, first_of

  integer, parameter :: longest = 120
  character(*), parameter, public :: needs_gears = 'not used by a prescribed mesh (&mesh contact_ratio); remove it'
  !> The tasks that need the mesh, the motion, and a body by finite elements, be it for the stiffness.
  character(*), parameter, public :: with_load = 'mesh, static, load, sweep or optimum', with_motion = 'load, sweep or optimum', &
                                     with_body = 'section, mesh, static, modal, load, sweep or optimum'

contains

  !> What the key waits for: these tasks, told as in `load, sweep or optimum`, or nothing where the case
  !> names one of them.
  pure function for_tasks(case, tasks) result(what)
    type(case_t), intent(in) :: case
    character(*), intent(in) :: tasks
    character(longest) :: what

    what = unless(case%asks_any(tasks), tasks)
  end function for_tasks

  !> Blank where that holds.
  pure function unless(holds, words) result(what)
    logical, intent(in) :: holds
    character(*), intent(in) :: words
    character(longest) :: what

    what = ''
    if (.not. holds) what = words
  end function unless

  pure function first_of(one, other) result(words)
    character(*), intent(in) :: one, other
    character(longest) :: words

    words = one
    if (len_trim(one) == 0) words = other
  end function first_of
end module gearsweep_uses
