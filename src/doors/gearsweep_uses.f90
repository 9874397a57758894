!> Why a key has no effect in the case at hand, and what would give it one. Blank: it has one.
module gearsweep_uses
  use gearsweep_case, only: case_t
  implicit none
  private
  public :: for_tasks, unless, first_of

  integer, parameter :: longest = 160
  character(*), parameter, public :: needs_gears = 'not used by a prescribed mesh (&mesh contact_ratio); remove it'
  character(*), parameter, public :: with_load = 'mesh, static, load, sweep or optimum', with_motion = 'load, sweep or optimum'

contains

  !> Blank where the case names one of the tasks, which are told as in `load, sweep or optimum`.
  pure function for_tasks(case, tasks) result(why)
    type(case_t), intent(in) :: case
    character(*), intent(in) :: tasks
    character(longest) :: why

    why = unless(case%asks_any(tasks), 'no task of this case uses it; add '//tasks//' to &case tasks, or remove the key')
  end function for_tasks

  pure function unless(used, reason) result(why)
    logical, intent(in) :: used
    character(*), intent(in) :: reason
    character(longest) :: why

    why = ''
    if (.not. used) why = reason
  end function unless

  !> The first reason there is.
  pure function first_of(one, other) result(why)
    character(*), intent(in) :: one, other
    character(longest) :: why

    why = one
    if (len_trim(one) == 0) why = other
  end function first_of
end module gearsweep_uses
