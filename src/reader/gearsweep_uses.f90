!> What a key is good for. It is not used where a task that the case does not name would use it, or where
!> another of its values makes it idle: it is read, and named as not used. It is refused where it contradicts
!> the case's other keys.
module gearsweep_uses
  use gearsweep_reader, only: reader_t
  implicit none
  private
  public :: unless, first_of, is_prescribed

  !> Of a list of tasks as in a sentence: room for the 32 tasks that gearsweep_tasks may hold, with what stands between them.
  integer, parameter, public :: sentence_length = 32*24
  character(*), parameter, public :: needs_gears = 'not used by a prescribed mesh (&mesh contact_ratio); remove it'

contains

  !> Blank where that holds.
  pure function unless(holds, words) result(what)
    logical, intent(in) :: holds
    character(*), intent(in) :: words
    character(sentence_length) :: what

    what = ''
    if (.not. holds) what = words
  end function unless

  pure function first_of(one, other) result(words)
    character(*), intent(in) :: one, other
    character(sentence_length) :: words

    words = one
    if (len_trim(one) == 0) words = other
  end function first_of

  !> Is the mesh prescribed, with no gears behind it?
  pure logical function is_prescribed(reader)
    type(reader_t), intent(in) :: reader

    is_prescribed = reader%has('mesh', 'contact_ratio')
  end function is_prescribed
end module gearsweep_uses
