!> The calls for C that run all tasks and write files; include/gearsweep.h describes them.
module gearsweep_c_run
  use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_int, c_null_ptr, c_ptr, c_size_t
  use gearsweep_c_border, only: give_text, longest_message, make_room, need_all, numbers, take_string, take_text
  use gearsweep_calls, only: gs_all
  use gearsweep_error, only: code_ok
  implicit none
  private
  public :: gsc_files, gsc_all

contains

  function gsc_files(text, text_length, folder, nwork, work, threads, out, name, answer, answer_size, length, &
                     stages, stages_size, files, files_size, message, message_size) result(info) bind(c)
    type(c_ptr), value :: text, folder, work, out, name, answer, stages, files, message
    integer(c_size_t), value :: text_length, answer_size, stages_size, files_size, message_size
    integer(c_int), value :: nwork, threads
    integer(c_size_t), intent(inout), optional :: length
    integer(c_int) :: info

    info = gsc_all(text, text_length, folder, nwork, work, threads, out, name, resume=c_null_ptr, keep=c_null_ptr, &
                   answer=answer, answer_size=answer_size, length=length, stages=stages, stages_size=stages_size, &
                   files=files, files_size=files_size, message=message, message_size=message_size)
  end function gsc_files

  !> `length` is that of the whole answer without its NUL.
  function gsc_all(text, text_length, folder, nwork, work, threads, out, name, watch, resume, keep, answer, answer_size, &
                   length, stages, stages_size, files, files_size, message, message_size) result(info) bind(c)
    type(c_ptr), value :: text, folder, work, out, name, resume, keep, answer, stages, files, message
    integer(c_size_t), value :: text_length, answer_size, stages_size, files_size, message_size
    integer(c_int), value :: nwork, threads
    integer(c_int), intent(inout), target, optional :: watch(3)
    integer(c_size_t), intent(inout), optional :: length
    integer(c_int) :: info
    character(:), allocatable :: case, place, folder_out, stem, before, later, answer_room, &
                                 stages_room, files_room
    character(longest_message) :: words
    character :: names
    real(c_double) :: none(1)
    integer :: used, listed
    integer, target :: unwatched(3)
    integer, pointer :: mark(:)

    call take_text(text, text_length, case, info, words)
    call take_string(folder, place, info, words)
    call take_string(out, folder_out, info, words)
    call take_string(name, stem, info, words)
    call take_string(resume, before, info, words)
    call take_string(keep, later, info, words)
    call need_all([nwork == 0 .or. c_associated(work), c_associated(out), c_associated(name), present(length)], &
                  info, words)
    call make_room('answer_size', answer_size, answer_room, info, words)
    call make_room('stages_size', stages_size, stages_room, info, words)
    call make_room('files_size', files_size, files_room, info, words)
    used = -1
    unwatched = 0
    mark => unwatched
    if (present(watch)) mark => watch
    if (info == code_ok) call gs_all(case, place, nwork, numbers(work, nwork), threads, folder_out, stem, mark, before, later, &
                                     0, none, listed, names, answer_room, used, stages_room, files_room, info, words)
    if (used >= 0) then
      length = used
      call give_text(answer_room(:min(used, len(answer_room))), answer, answer_size)
      call give_text(trim(stages_room), stages, stages_size)
      call give_text(trim(files_room), files, files_size)
    end if
    call give_text(trim(words), message, message_size)
  end function gsc_all
end module gearsweep_c_run
