!> Texts of C as texts of Fortran, and back.
module gearsweep_c_texts
  use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_f_pointer, c_null_char, c_ptr, c_size_t
  use gearsweep_api, only: longest_text
  use gearsweep_error, only: code_input, code_memory, error_t, fail
  use gearsweep_text, only: str
  implicit none
  private
  public :: take_text, take_string, give, copy_text

contains

  !> The text of this name: `length` bytes, or up to the first NUL.
  subroutine take_text(name, text, length, taken, error)
    character(*), intent(in) :: name
    type(c_ptr), intent(in) :: text
    integer(c_size_t), intent(in) :: length
    character(:), allocatable, intent(out) :: taken
    type(error_t), allocatable, intent(inout) :: error
    character(c_char), pointer :: letters(:)
    integer(c_size_t) :: i, n
    integer :: stat

    if (.not. c_associated(text)) call fail(error, code_input, name//': is a null pointer')
    ! A length beyond the half of C's comes as a negative one.
    if (length < 0 .or. length > longest_text) &
      call fail(error, code_input, name//': longer than '//str(longest_text)//' characters')
    if (allocated(error)) return
    call c_f_pointer(text, letters, [length])
    n = 0
    do while (n < length)
      if (letters(n + 1) == c_null_char) exit
      n = n + 1
    end do
    allocate (character(n) :: taken, stat=stat)
    if (stat /= 0) then
      call fail(error, code_memory, name//': does not fit into memory')
      return
    end if
    do i = 1, n
      taken(i:i) = letters(i)
    end do
  end subroutine take_text

  !> A text that ends with its NUL; empty for a null pointer.
  subroutine take_string(name, text, taken, error)
    character(*), intent(in) :: name
    type(c_ptr), intent(in) :: text
    character(:), allocatable, intent(out) :: taken
    type(error_t), allocatable, intent(inout) :: error

    taken = ''
    if (c_associated(text)) call take_text(name, text, int(longest_text, c_size_t), taken, error)
  end subroutine take_string

  !> A text and its NUL into the buffer of this name, if it fits; `length` is told either way.
  subroutine give(name, words, buffer, buffer_size, error, length)
    character(*), intent(in) :: name, words
    type(c_ptr), intent(in) :: buffer
    integer(c_size_t), intent(in) :: buffer_size
    type(error_t), allocatable, intent(inout) :: error
    integer(c_size_t), intent(inout), optional :: length

    if (present(length)) length = len(words)
    if (buffer_size >= 0 .and. buffer_size <= len(words)) then
      call fail(error, code_input, name//'_size = '//str(int(buffer_size))//': too small, must be at least '// &
                str(len(words) + 1))
    else if (.not. c_associated(buffer)) then
      call fail(error, code_input, name//': is a null pointer')
    else
      call copy_text(words, buffer, buffer_size)
    end if
  end subroutine give

  !> `words` and a NUL, cut where `room` bytes are too few; none where there is no room. A room beyond
  !> the half of C's sizes, which comes as a negative one, is enough for any.
  subroutine copy_text(words, target, room)
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
  end subroutine copy_text
end module gearsweep_c_texts
