!> What a key is good for. It waits where a task that the case does not name would use it, or where
!> another of its values makes it idle: it is read, and named as not used. It is refused where it contradicts
!> the case's other keys.
module gearsweep_uses
  use gearsweep_case, only: case_t
  use gearsweep_tasks, only: sentence_length
  implicit none
  private
  public :: for_stage, unless, first_of

  integer, parameter :: longest = sentence_length
  character(*), parameter, public :: needs_gears = 'not used by a prescribed mesh (&mesh contact_ratio); remove it'

contains

  !> What the key waits for: the tasks that need this stage, told as in `load, sweep or optimum`, or nothing where the
  !> case names one of them.
  pure function for_stage(case, stage) result(what)
    type(case_t), intent(in) :: case
    character(*), intent(in) :: stage
    character(longest) :: what

    what = unless(case%needs(stage), trim(case%tasks_for(stage)))
  end function for_stage

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
