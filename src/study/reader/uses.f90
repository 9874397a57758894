!> Applicability of a key. A key is not used if only tasks outside the case would use it, or if another value of the case makes it
!> idle: it is read, and listed as not used. It is refused if it contradicts other keys of the case.
module gearsweep_study_reader_uses
  use gearsweep_study_reader_reader, only: reader_t
  implicit none
  private
  public :: unless, first_of, is_prescribed

  !> Length of a list of tasks in a sentence: room for the 32 tasks that gearsweep_api_tasks may hold, with the separators.
  integer, parameter, public :: sentence_length = 32*24
  character(*), parameter, public :: needs_gears = 'not used by a prescribed mesh (&mesh contact_ratio); remove it'

contains

  !> Returns the words unless the condition holds.
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

  !> True if the mesh is prescribed, without gears.
  pure logical function is_prescribed(reader)
    type(reader_t), intent(in) :: reader

    is_prescribed = reader%has('mesh', 'contact_ratio')
  end function is_prescribed
end module gearsweep_study_reader_uses
