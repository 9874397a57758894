!> The calls for C, as include/gearsweep.h has them: named gsc_..., they return the code.
module gearsweep_c
  use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_int, c_null_ptr, c_ptr, c_size_t
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_api, only: begin_call, describe, edit, end_call, numbers_of, run, size_of, text_of, word_of, write_files
  use gearsweep_c_texts, only: copy_text, give, take_string, take_text
  use gearsweep_error, only: code_input, error_t, fail
  use gearsweep_kept, only: release
  use gearsweep_version, only: version
  implicit none
  private
  public :: gsc_version, gsc_describe, gsc_edit, gsc_run, gsc_text, gsc_size, gsc_column, gsc_words, gsc_write, gsc_free

contains

  function gsc_version(buffer, buffer_size, message, message_size) result(info) bind(c)
    type(c_ptr), value :: buffer, message
    integer(c_size_t), value :: buffer_size, message_size
    integer(c_int) :: info
    type(error_t), allocatable :: error

    call begin_call()
    call give('version', version, buffer, buffer_size, error)
    info = ended(error, message, message_size)
  end function gsc_version

  function gsc_describe(what, buffer, buffer_size, length, message, message_size) result(info) bind(c)
    type(c_ptr), value :: what, buffer, message
    integer(c_size_t), value :: buffer_size, message_size
    integer(c_size_t), intent(inout), optional :: length
    integer(c_int) :: info
    type(error_t), allocatable :: error
    character(:), allocatable :: subject, words

    call begin_call()
    call take_string('what', what, subject, error)
    if (.not. allocated(error)) call describe(subject, words, error)
    if (.not. allocated(error)) call give('buffer', words, buffer, buffer_size, error, length)
    info = ended(error, message, message_size)
  end function gsc_describe

  function gsc_edit(action, text, text_length, group, key, value, buffer, buffer_size, length, message, message_size) &
                    result(info) bind(c)
    type(c_ptr), value :: action, text, group, key, value, buffer, message
    integer(c_size_t), value :: text_length, buffer_size, message_size
    integer(c_size_t), intent(inout), optional :: length
    integer(c_int) :: info
    type(error_t), allocatable :: error
    character(:), allocatable :: verb, case, group_name, key_name, new, words

    call begin_call()
    call take_string('action', action, verb, error)
    call take_text('text', text, text_length, case, error)
    call take_string('group', group, group_name, error)
    call take_string('key', key, key_name, error)
    call take_string('value', value, new, error)
    if (.not. allocated(error)) call edit(verb, case, group_name, key_name, new, words, error)
    if (.not. allocated(error)) call give('buffer', words, buffer, buffer_size, error, length)
    info = ended(error, message, message_size)
  end function gsc_edit

  function gsc_run(text, text_length, folder, threads, earlier, watch, resume, keep, study, message, message_size) &
                   result(info) bind(c)
    type(c_ptr), value :: text, folder, earlier, resume, keep, message
    integer(c_size_t), value :: text_length, message_size
    integer(c_int), value :: threads
    integer(c_int), intent(inout), target, optional :: watch(3)
    type(c_ptr), intent(inout), optional :: study
    integer(c_int) :: info
    type(error_t), allocatable :: error
    character(:), allocatable :: case, place, before, later
    integer(int64) :: number
    integer, target :: unwatched(3)

    call begin_call()
    call take_text('text', text, text_length, case, error)
    call take_string('folder', folder, place, error)
    call take_string('resume', resume, before, error)
    call take_string('keep', keep, later, error)
    if (.not. present(study)) call fail(error, code_input, 'study: is a null pointer')
    number = 0
    unwatched = 0
    if (allocated(error)) then
      continue
    else if (present(watch)) then
      call run(case, place, threads, transfer(earlier, number), watch, before, later, number, error)
    else
      call run(case, place, threads, transfer(earlier, number), unwatched, before, later, number, error)
    end if
    if (number /= 0) study = transfer(number, study)
    info = ended(error, message, message_size)
  end function gsc_run

  function gsc_text(study, what, buffer, buffer_size, length, message, message_size) result(info) bind(c)
    type(c_ptr), value :: study, what, buffer, message
    integer(c_size_t), value :: buffer_size, message_size
    integer(c_size_t), intent(inout), optional :: length
    integer(c_int) :: info
    type(error_t), allocatable :: error
    character(:), allocatable :: subject, words

    call begin_call()
    call take_string('what', what, subject, error)
    if (.not. allocated(error)) call text_of(transfer(study, 0_int64), subject, words, error)
    if (.not. allocated(error)) call give('buffer', words, buffer, buffer_size, error, length)
    info = ended(error, message, message_size)
  end function gsc_text

  function gsc_size(study, table, column, rows, kind, width, message, message_size) result(info) bind(c)
    type(c_ptr), value :: study, table, column, message
    integer(c_int), intent(inout), optional :: rows, kind, width
    integer(c_size_t), value :: message_size
    integer(c_int) :: info
    type(error_t), allocatable :: error
    character(:), allocatable :: table_name, column_name

    call begin_call()
    call take_string('table', table, table_name, error)
    call take_string('column', column, column_name, error)
    if (.not. (present(rows) .and. present(kind) .and. present(width))) &
      call fail(error, code_input, 'rows, kind or width: is a null pointer')
    if (.not. allocated(error)) call size_of(transfer(study, 0_int64), table_name, column_name, rows, kind, width, error)
    info = ended(error, message, message_size)
  end function gsc_size

  function gsc_column(study, table, column, rows, values, message, message_size) result(info) bind(c)
    type(c_ptr), value :: study, table, column, message
    integer(c_int), value :: rows
    real(c_double), intent(inout), optional :: values(rows)
    integer(c_size_t), value :: message_size
    integer(c_int) :: info
    type(error_t), allocatable :: error
    character(:), allocatable :: table_name, column_name

    call begin_call()
    call take_string('table', table, table_name, error)
    call take_string('column', column, column_name, error)
    if (.not. present(values)) call fail(error, code_input, 'values: is a null pointer')
    if (.not. allocated(error)) call numbers_of(transfer(study, 0_int64), table_name, column_name, values, error)
    info = ended(error, message, message_size)
  end function gsc_column

  !> Rows are counted from 0.
  function gsc_words(study, table, column, row, word, word_size, message, message_size) result(info) bind(c)
    type(c_ptr), value :: study, table, column, word, message
    integer(c_int), value :: row
    integer(c_size_t), value :: word_size, message_size
    integer(c_int) :: info
    type(error_t), allocatable :: error
    character(:), allocatable :: table_name, column_name, words

    call begin_call()
    call take_string('table', table, table_name, error)
    call take_string('column', column, column_name, error)
    if (.not. allocated(error)) call word_of(transfer(study, 0_int64), table_name, column_name, row, 0, words, error)
    if (.not. allocated(error)) call give('word', words, word, word_size, error)
    info = ended(error, message, message_size)
  end function gsc_words

  function gsc_write(study, folder, name, buffer, buffer_size, length, message, message_size) result(info) bind(c)
    type(c_ptr), value :: study, folder, name, buffer, message
    integer(c_size_t), value :: buffer_size, message_size
    integer(c_size_t), intent(inout), optional :: length
    integer(c_int) :: info
    type(error_t), allocatable :: error
    character(:), allocatable :: place, stem, words

    call begin_call()
    call take_string('folder', folder, place, error)
    call take_string('name', name, stem, error)
    if (.not. allocated(error)) call write_files(transfer(study, 0_int64), place, stem, words, error)
    if (.not. allocated(error)) call give('buffer', words, buffer, buffer_size, error, length)
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

  !> The code of a call, whose message goes out, cut where it is too long.
  integer(c_int) function ended(error, message, message_size) result(info)
    type(error_t), allocatable, intent(in) :: error
    type(c_ptr), intent(in) :: message
    integer(c_size_t), intent(in) :: message_size
    character(1000) :: words

    call end_call(error, info, words)
    call copy_text(trim(words), message, message_size)
  end function ended
end module gearsweep_c
