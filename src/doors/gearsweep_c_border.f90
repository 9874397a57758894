!> What the calls for C have in common: texts of C as texts of Fortran and back,
!> arrays that may be missing, refusals.
module gearsweep_c_border
  use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_double, c_f_pointer, c_int, c_null_char, c_ptr, &
                                         c_size_t
  use gearsweep_border, only: longest_text
  use gearsweep_error, only: code_input, code_memory, code_ok
  use gearsweep_text, only: str
  implicit none
  private
  public :: take_text, take_string, give_text, give_answer, make_room, numbers, need_all, need_size

  !> Longest message.
  integer, parameter, public :: longest_message = 1000

contains

  !> The case as a Fortran text: `length` characters, or up to the first NUL.
  subroutine take_text(text, length, case, info, words)
    type(c_ptr), intent(in) :: text
    integer(c_size_t), intent(in) :: length
    character(:), allocatable, intent(out) :: case
    integer(c_int), intent(out) :: info
    character(*), intent(out) :: words
    character(c_char), pointer :: letters(:)
    integer(c_size_t) :: i, n
    integer :: stat

    info = code_ok
    words = ''
    if (.not. c_associated(text)) then
      call refuse(code_input, 'text: is a null pointer', info, words)
    else if (length < 0 .or. length > longest_text) then
      call refuse_length('text_length', info, words)
    end if
    if (info /= code_ok) return
    call c_f_pointer(text, letters, [length])
    n = 0
    do while (n < length)
      if (letters(n + 1) == c_null_char) exit
      n = n + 1
    end do
    allocate (character(n) :: case, stat=stat)
    if (stat /= 0) then
      call refuse(code_memory, 'text: does not fit into memory', info, words)
      return
    end if
    do i = 1, n
      case(i:i) = letters(i)
    end do
  end subroutine take_text

  !> A text that ends with its NUL; empty for a null pointer.
  subroutine take_string(text, string, info, words)
    type(c_ptr), intent(in) :: text
    character(:), allocatable, intent(out) :: string
    integer(c_int), intent(inout) :: info
    character(*), intent(inout) :: words

    string = ''
    if (info == code_ok .and. c_associated(text)) &
      call take_text(text, int(longest_text, c_size_t), string, info, words)
  end subroutine take_string

  !> A Fortran text as long as `size` bytes hold without their NUL.
  subroutine make_room(name, size, text, info, words)
    character(*), intent(in) :: name
    integer(c_size_t), intent(in) :: size
    character(:), allocatable, intent(out) :: text
    integer(c_int), intent(inout) :: info
    character(*), intent(inout) :: words
    integer :: stat

    ! A size beyond the half of C's comes as a negative one.
    if (size < 0 .or. size > longest_text) call refuse_length(name, info, words)
    if (info /= code_ok) return
    allocate (character(max(0_c_size_t, size - 1)) :: text, stat=stat)
    if (stat /= 0) call refuse(code_memory, name//': does not fit into memory', info, words)
  end subroutine make_room

  !> `words` and a NUL, cut where `room` bytes are too few; none where there is no room. A room beyond
  !> the half of C's sizes, which comes as a negative one, is enough for any.
  subroutine give_text(words, target, room)
    character(*), intent(in) :: words
    type(c_ptr), intent(in) :: target
    integer(c_size_t), intent(in) :: room
    character(c_char), pointer :: letters(:)
    integer(c_size_t) :: i, n

    if (.not. c_associated(target) .or. room == 0) return
    n = len(words, c_size_t)
    if (room > 0) n = min(n, room - 1)
    call c_f_pointer(target, letters, [n + 1])
    do i = 1, n
      letters(i) = words(i:i)
    end do
    letters(n + 1) = c_null_char
  end subroutine give_text

  !> The text that a call left in `room`, and its length; refused where it needs more.
  subroutine give_answer(name, room, used, answer, answer_size, length, info, words)
    character(*), intent(in) :: name
    character(:), allocatable, intent(in) :: room
    integer, intent(in) :: used
    type(c_ptr), intent(in) :: answer
    integer(c_size_t), intent(in) :: answer_size
    integer(c_size_t), intent(inout) :: length
    integer(c_int), intent(inout) :: info
    character(*), intent(inout) :: words

    if (used < 0) return
    length = used
    if (used > len(room)) then
      info = code_ok
      call need_size(name, answer_size, used, info, words)
    else
      call give_text(room(:used), answer, answer_size)
    end if
  end subroutine give_answer

  !> A copy of work(n); empty where there is none.
  function numbers(work, n) result(values)
    type(c_ptr), intent(in) :: work
    integer, intent(in) :: n
    real(c_double), allocatable :: values(:)
    real(c_double), pointer :: all(:)

    allocate (values(0))
    if (n <= 0 .or. .not. c_associated(work)) return
    call c_f_pointer(work, all, [n])
    values = all
  end function numbers

  subroutine need_all(given, info, words)
    logical, intent(in) :: given(:)
    integer(c_int), intent(inout) :: info
    character(*), intent(inout) :: words

    if (.not. all(given)) call refuse(code_input, 'an array or result is a null pointer', info, words)
  end subroutine need_all

  !> Room for `need` characters and a NUL.
  subroutine need_size(name, have, need, info, words)
    character(*), intent(in) :: name
    integer(c_size_t), intent(in) :: have
    integer, intent(in) :: need
    integer(c_int), intent(inout) :: info
    character(*), intent(inout) :: words

    if (have >= 0 .and. have <= need) call refuse(code_input, name//' = '//str(int(have))// &
      ': too small, must be at least '//str(need + 1), info, words)
  end subroutine need_size

  subroutine refuse_length(name, info, words)
    character(*), intent(in) :: name
    integer(c_int), intent(inout) :: info
    character(*), intent(inout) :: words

    call refuse(code_input, name//': more than '//str(longest_text)//' characters', info, words)
  end subroutine refuse_length

  !> The first refusal is kept.
  subroutine refuse(code, reason, info, words)
    integer, intent(in) :: code
    character(*), intent(in) :: reason
    integer(c_int), intent(inout) :: info
    character(*), intent(inout) :: words

    if (info /= code_ok) return
    info = code
    words = reason
  end subroutine refuse
end module gearsweep_c_border
