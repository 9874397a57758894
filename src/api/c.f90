!> Calls for C, as in include/gearsweep.h: named gsc_..., they return the code.
module gearsweep_api_c
  use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_double, c_f_pointer, c_int, c_null_char, c_null_ptr, c_ptr, &
                                         c_size_t
  use gearsweep_base, only: code_input, code_memory, fail, str, version
  use gearsweep_api_api, only: begin_call, describe, edit, end_call, error_t, int64, longest_text, numbers_of, release, run, &
    run_with_rows, size_of, text_of, word_of, write_files
  implicit none
  private
  public :: gsc_version, gsc_describe, gsc_edit, gsc_run, gsc_rows, gsc_text, gsc_size, gsc_column, gsc_words, gsc_write, gsc_free

contains

  integer(c_int) function gsc_version(buffer, buffer_size, message, message_size) result(info) bind(c)
    type(c_ptr), value :: buffer, message
    integer(c_size_t), value :: buffer_size, message_size
    type(error_t), allocatable :: error

    call begin_call()
    call return_text('version', version, buffer, buffer_size, error)
    info = ended(error, message, message_size)
  end function gsc_version

  integer(c_int) function gsc_describe(what, buffer, buffer_size, length, message, message_size) result(info) bind(c)
    type(c_ptr), value :: what, buffer, message
    integer(c_size_t), value :: buffer_size, message_size
    integer(c_size_t), intent(inout), optional :: length
    type(error_t), allocatable :: error
    character(:), allocatable :: subject, words

    call begin_call()
    call read_string('what', what, subject, error)
    if (.not. allocated(error)) call describe(subject, words, error)
    if (.not. allocated(error)) call return_text('buffer', words, buffer, buffer_size, error, length)
    info = ended(error, message, message_size)
  end function gsc_describe

  integer(c_int) function gsc_edit(action, text, text_length, group, key, value, buffer, buffer_size, length, message, &
                                   message_size) result(info) bind(c)
    type(c_ptr), value :: action, text, group, key, value, buffer, message
    integer(c_size_t), value :: text_length, buffer_size, message_size
    integer(c_size_t), intent(inout), optional :: length
    type(error_t), allocatable :: error
    character(:), allocatable :: verb, case, group_name, key_name, new, words

    call begin_call()
    call read_string('action', action, verb, error)
    call read_text('text', text, text_length, case, error)
    call read_string('group', group, group_name, error)
    call read_string('key', key, key_name, error)
    call read_string('value', value, new, error)
    if (.not. allocated(error)) call edit(verb, case, group_name, key_name, new, words, error)
    if (.not. allocated(error)) call return_text('buffer', words, buffer, buffer_size, error, length)
    info = ended(error, message, message_size)
  end function gsc_edit

  integer(c_int) function gsc_run(text, text_length, folder, threads, earlier, watch, resume, keep, study, message, &
                                  message_size) result(info) bind(c)
    type(c_ptr), value :: text, folder, earlier, resume, keep, message
    integer(c_size_t), value :: text_length, message_size
    integer(c_int), value :: threads
    integer(c_int), intent(inout), target, optional :: watch(3)
    type(c_ptr), intent(inout), optional :: study
    type(error_t), allocatable :: error
    character(:), allocatable :: case, place, before, later
    integer(int64) :: number
    integer, target :: unwatched(3)
    integer, pointer, contiguous :: watching(:)

    call begin_call()
    call read_text('text', text, text_length, case, error)
    call read_string('folder', folder, place, error)
    call read_string('resume', resume, before, error)
    call read_string('keep', keep, later, error)
    if (.not. present(study)) call fail(error, code_input, 'study: is a null pointer')
    number = 0
    unwatched = 0
    watching => unwatched
    if (present(watch)) watching => watch
    if (.not. allocated(error)) call run(case, place, threads, transfer(earlier, number), watching, before, later, number, error)
    if (number /= 0) study = transfer(number, study)
    info = ended(error, message, message_size)
  end function gsc_run

  integer(c_int) function gsc_rows(text, text_length, folder, threads, earlier, watch, names, rows, values, take, study, &
                                   message, message_size) result(info) bind(c)
    type(c_ptr), value :: text, folder, earlier, names, take, message
    integer(c_size_t), value :: text_length, message_size
    integer(c_int), value :: threads, rows
    integer(c_int), intent(inout), target, optional :: watch(3)
    real(c_double), intent(in), optional :: values(*)
    type(c_ptr), intent(inout), optional :: study
    type(error_t), allocatable :: error
    character(:), allocatable :: case, place, keys, columns
    integer(int64) :: number
    integer, target :: unwatched(3)
    integer, pointer, contiguous :: watching(:)

    call begin_call()
    call read_text('text', text, text_length, case, error)
    call read_string('folder', folder, place, error)
    call read_string('names', names, keys, error)
    call read_string('take', take, columns, error)
    if (.not. present(study)) call fail(error, code_input, 'study: is a null pointer')
    if (.not. present(values)) call fail(error, code_input, 'values: is a null pointer')
    number = 0
    unwatched = 0
    watching => unwatched
    if (present(watch)) watching => watch
    if (.not. allocated(error)) call run_with_rows(case, place, threads, transfer(earlier, number), watching, keys, rows, values, &
                                                   columns, number, error)
    if (number /= 0) study = transfer(number, study)
    info = ended(error, message, message_size)
  end function gsc_rows

  integer(c_int) function gsc_text(study, what, buffer, buffer_size, length, message, message_size) result(info) bind(c)
    type(c_ptr), value :: study, what, buffer, message
    integer(c_size_t), value :: buffer_size, message_size
    integer(c_size_t), intent(inout), optional :: length
    type(error_t), allocatable :: error
    character(:), allocatable :: subject, words

    call begin_call()
    call read_string('what', what, subject, error)
    if (.not. allocated(error)) call text_of(transfer(study, 0_int64), subject, words, error)
    if (.not. allocated(error)) call return_text('buffer', words, buffer, buffer_size, error, length)
    info = ended(error, message, message_size)
  end function gsc_text

  integer(c_int) function gsc_size(study, table, column, rows, kind, width, message, message_size) result(info) bind(c)
    type(c_ptr), value :: study, table, column, message
    integer(c_int), intent(inout), optional :: rows, kind, width
    integer(c_size_t), value :: message_size
    type(error_t), allocatable :: error
    character(:), allocatable :: table_name, column_name

    call begin_call()
    call read_string('table', table, table_name, error)
    call read_string('column', column, column_name, error)
    if (.not. (present(rows) .and. present(kind) .and. present(width))) &
      call fail(error, code_input, 'rows, kind or width: is a null pointer')
    if (.not. allocated(error)) call size_of(transfer(study, 0_int64), table_name, column_name, rows, kind, width, error)
    info = ended(error, message, message_size)
  end function gsc_size

  integer(c_int) function gsc_column(study, table, column, rows, values, message, message_size) result(info) bind(c)
    type(c_ptr), value :: study, table, column, message
    integer(c_int), value :: rows
    real(c_double), intent(inout), optional :: values(rows)
    integer(c_size_t), value :: message_size
    type(error_t), allocatable :: error
    character(:), allocatable :: table_name, column_name

    call begin_call()
    call read_string('table', table, table_name, error)
    call read_string('column', column, column_name, error)
    if (.not. present(values)) call fail(error, code_input, 'values: is a null pointer')
    if (.not. allocated(error)) call numbers_of(transfer(study, 0_int64), table_name, column_name, rows, values, error)
    info = ended(error, message, message_size)
  end function gsc_column

  !> Returns the word in a row; rows are counted from 0.
  integer(c_int) function gsc_words(study, table, column, row, word, word_size, message, message_size) result(info) bind(c)
    type(c_ptr), value :: study, table, column, word, message
    integer(c_int), value :: row
    integer(c_size_t), value :: word_size, message_size
    type(error_t), allocatable :: error
    character(:), allocatable :: table_name, column_name, words

    call begin_call()
    call read_string('table', table, table_name, error)
    call read_string('column', column, column_name, error)
    if (.not. allocated(error)) call word_of(transfer(study, 0_int64), table_name, column_name, row, 0, words, error)
    if (.not. allocated(error)) call return_text('word', words, word, word_size, error)
    info = ended(error, message, message_size)
  end function gsc_words

  integer(c_int) function gsc_write(study, folder, name, buffer, buffer_size, length, message, message_size) result(info) bind(c)
    type(c_ptr), value :: study, folder, name, buffer, message
    integer(c_size_t), value :: buffer_size, message_size
    integer(c_size_t), intent(inout), optional :: length
    type(error_t), allocatable :: error
    character(:), allocatable :: place, stem, words

    call begin_call()
    call read_string('folder', folder, place, error)
    call read_string('name', name, stem, error)
    if (.not. allocated(error)) call write_files(transfer(study, 0_int64), place, stem, words, error)
    if (.not. allocated(error)) call return_text('buffer', words, buffer, buffer_size, error, length)
    info = ended(error, message, message_size)
  end function gsc_write

  subroutine gsc_free(study) bind(c)
    type(c_ptr), intent(inout), optional :: study
    integer(int64) :: number

    if (.not. present(study)) return
    number = transfer(study, number)
    call release(number)
    study = c_null_ptr
  end subroutine gsc_free

  !> Returns the code of a call, and its message, cut if it is too long.
  integer(c_int) function ended(error, message, message_size) result(info)
    type(error_t), allocatable, intent(in) :: error
    type(c_ptr), intent(in) :: message
    integer(c_size_t), intent(in) :: message_size
    character(1000) :: words

    call end_call(error, info, words)
    call copy_text(trim(words), message, message_size)
  end function ended

  !> Reads the text with this name: `length` bytes, or up to the first NUL.
  subroutine read_text(name, text, length, copy, error)
    character(*), intent(in) :: name
    type(c_ptr), intent(in) :: text
    integer(c_size_t), intent(in) :: length
    character(:), allocatable, intent(out) :: copy
    type(error_t), allocatable, intent(inout) :: error
    character(c_char), pointer :: letters(:)
    integer(c_size_t) :: i, n
    integer :: stat

    if (.not. c_associated(text)) call fail(error, code_input, name//': is a null pointer')
    ! A size_t above half its range arrives as a negative number.
    if (length < 0 .or. length > longest_text) &
      call fail(error, code_input, name//': longer than '//str(longest_text)//' characters')
    if (allocated(error)) return
    call c_f_pointer(text, letters, [length])
    n = 0
    do while (n < length)
      if (letters(n + 1) == c_null_char) exit
      n = n + 1
    end do
    allocate (character(n) :: copy, stat=stat)
    if (stat /= 0) then
      call fail(error, code_memory, name//': does not fit into memory')
      return
    end if
    do i = 1, n
      copy(i:i) = letters(i)
    end do
  end subroutine read_text

  !> Reads a text that ends with its NUL; empty for a null pointer.
  subroutine read_string(name, text, copy, error)
    character(*), intent(in) :: name
    type(c_ptr), intent(in) :: text
    character(:), allocatable, intent(out) :: copy
    type(error_t), allocatable, intent(inout) :: error

    copy = ''
    if (c_associated(text)) call read_text(name, text, int(longest_text, c_size_t), copy, error)
  end subroutine read_string

  !> Returns a text and its NUL in the buffer with this name, if it fits; `length` is set in any case.
  subroutine return_text(name, words, buffer, buffer_size, error, length)
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
  end subroutine return_text

  !> Copies `words` and a NUL, cut if `room` bytes are too few; copies nothing if there is no room. A negative `room`, a size_t
  !> above half its range, is enough for any text.
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
end module gearsweep_api_c
