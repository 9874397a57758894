!> The record of an interrupted run as text: a run of the same version on the same inputs goes on from it, to the
!> same bits.
!>
!> The first line names the format, version and a checksum of the inputs: the case's text and the stiffness table
!> that it names. Then come the sweeps that had begun: a line with number, speeds and reliefs, and the bits of their
!> state as hexadecimal words; and the tables of the other tasks that were done. The last line has a checksum of all
!> before it.
module gearsweep_checkpoint
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_error_estimate, only: point_t
  use gearsweep_optimum, only: most_tried
  use gearsweep_sweep, only: sweep_state_t
  use gearsweep_sweep_state, only: begin_state
  use gearsweep_case, only: case_t, speeds
  use gearsweep_error, only: error_t, fail, code_file
  use gearsweep_file_set, only: file_set_t
  use gearsweep_files, only: beside, read_text
  use gearsweep_lines, only: lines_t
  use gearsweep_study, only: record_t
  use gearsweep_task_record, only: add_tasks, add_words, hexadecimal, place_t, read_task, take_line, take_words
  use gearsweep_text, only: str
  use gearsweep_version, only: version
  implicit none
  private
  public :: save_record, load_record, drop_checkpoint

  character(*), parameter :: format = 'gearsweep checkpoint 2'
  integer, parameter :: longest = 10**9          ! bytes

contains

  !> Writes the record to a file, whole or not at all.
  subroutine save_record(record, case, folder, path, error)
    type(record_t), intent(in) :: record
    type(case_t), intent(in) :: case
    character(*), intent(in) :: folder, path
    type(error_t), allocatable, intent(inout) :: error
    type(file_set_t) :: files
    character(:), allocatable :: text, place

    call write_record(record, case, folder, text)
    ! Not by folder_of: callers at once would share the length of its result.
    place = path(:index(path, '/', back=.true.))
    call files%begin(place//'.', error)
    call files%add(path(len(place) + 1:), format, text, error)
    call files%finish(error)
  end subroutine save_record

  !> Reads the record of an interrupted run of this case.
  subroutine load_record(path, case, folder, record, error)
    character(*), intent(in) :: path, folder
    type(case_t), intent(in) :: case
    type(record_t), intent(out) :: record
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: text

    call read_text(path, text, error, longest=longest)
    if (allocated(error)) return
    call read_record(text, path, case, folder, record, error)
  end subroutine load_record

  !> Removes a checkpoint that is no longer needed, if there is one.
  subroutine drop_checkpoint(path)
    character(*), intent(in) :: path
    character(:), allocatable :: line
    integer :: unit, stat

    open (newunit=unit, file=path, status='old', action='readwrite', iostat=stat)
    if (stat /= 0) return
    allocate (character(len(format)) :: line)
    read (unit, '(a)', iostat=stat) line
    ! Another file of this name is none of ours.
    if (stat == 0 .and. line == format) close (unit, status='delete', iostat=stat)
    if (line /= format) close (unit, iostat=stat)
  end subroutine drop_checkpoint

  !> `folder` is where the case's files lie, with its slash.
  subroutine write_record(record, case, folder, text)
    type(record_t), intent(in) :: record
    type(case_t), intent(in) :: case
    character(*), intent(in) :: folder
    character(:), allocatable, intent(out) :: text
    type(lines_t) :: lines
    character(:), allocatable :: opening
    integer :: i

    call first_line(case, folder, opening)
    call lines%add(opening)
    do i = 1, size(record%states)
      if (allocated(record%states(i)%points)) call add_state(record%states(i), i, lines)
    end do
    if (allocated(record%tasks)) call add_tasks(record%tasks, lines)
    text = lines%text()
    text = text//'end '//hexadecimal(checksum(text))//new_line('a')
  end subroutine write_record

  !> The record in a checkpoint's text; `path` is for messages.
  subroutine read_record(text, path, case, folder, record, error)
    character(*), intent(in) :: text, path, folder
    type(case_t), intent(in) :: case
    type(record_t), intent(out) :: record
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: opening
    integer :: last

    if (allocated(error)) return
    call first_line(case, folder, opening)
    last = index(text, new_line('a')//'end ', back=.true.)
    if (index(text, format) /= 1) then
      call fail(error, code_file, path//': is no checkpoint of gearsweep')
    else if (index(text, format//' version '//version//' ') /= 1) then
      call fail(error, code_file, path//': is of another version of gearsweep than '//version)
    else if (last == 0) then
      call fail(error, code_file, path//': is damaged')
    else if (text(last + 1:) /= 'end '//hexadecimal(checksum(text(:last)))//new_line('a')) then
      call fail(error, code_file, path//': is damaged')
    else if (index(text, opening//new_line('a')) /= 1) then
      call fail(error, code_file, path//': is of another case: the case or a file that it names was changed since')
    else
      call read_states(text(:last), len(opening) + 2, case, record, error)
    end if
    if (allocated(error)) error%message = 'cannot resume from '//error%message
  end subroutine read_record

  subroutine first_line(case, folder, line)
    type(case_t), intent(in) :: case
    character(*), intent(in) :: folder
    character(:), allocatable, intent(out) :: line
    character(:), allocatable :: inputs, table
    type(error_t), allocatable :: missing

    inputs = case%text
    call add_table(case%file)
    call add_table(case%profile_error_file)
    line = format//' version '//version//' inputs '//hexadecimal(checksum(inputs))

  contains

    subroutine add_table(file)
      character(:), allocatable, intent(in) :: file

      if (.not. allocated(file)) return
      call read_text(beside(folder, file), table, missing)
      if (.not. allocated(missing)) inputs = inputs//achar(0)//table
    end subroutine add_table
  end subroutine first_line

  subroutine add_state(state, number, lines)
    type(sweep_state_t), intent(in) :: state
    integer, intent(in) :: number
    type(lines_t), intent(inout) :: lines

    call lines%add('sweep '//str(number)//' '//str(size(state%points, 1))//' '//str(size(state%points, 2)))
    call add_words(transfer(state%blocks, [0_int64]), lines)
    call add_words(int(state%followed, int64), lines)
    call add_words(transfer(state%pace, [0_int64]), lines)
    call add_words(int(merge(1, 0, reshape(state%solved, [size(state%solved)])), int64), lines)
    call add_points(state%points, lines)
  end subroutine add_state

  subroutine add_points(points, lines)
    type(point_t), intent(in) :: points(:, :)
    type(lines_t), intent(inout) :: lines
    integer :: i, k

    do k = 1, size(points, 2)
      do i = 1, size(points, 1)
        call add_words(transfer(points(i, k), [0_int64]), lines)
      end do
    end do
  end subroutine add_points

  !> `first` is where the sweeps begin.
  subroutine read_states(text, first, case, record, error)
    character(*), intent(in) :: text
    integer, intent(in) :: first
    type(case_t), intent(in) :: case
    type(record_t), intent(inout) :: record
    type(error_t), allocatable, intent(inout) :: error
    type(place_t) :: place
    character(:), allocatable :: line
    integer :: sizes(3), stat

    place%at = first
    do while (place%at < len(text) .and. place%ok)
      call take_line(text, place, line)
      if (index(line, 'task ') == 1) then
        call read_task(text, place, line(6:), record%tasks)
        cycle
      end if
      sizes = 0
      stat = 1
      if (len(line) > 6) read (line(7:), *, iostat=stat) sizes
      place%ok = stat == 0 .and. sizes(1) >= 1 .and. sizes(1) <= size(record%states) .and. &
                 sizes(2) == size(speeds(case)) .and. sizes(3) >= 1 .and. sizes(3) <= max(size(case%amount), most_tried)
      if (place%ok) call read_state(text, place, sizes, record%states(sizes(1)))
    end do
    if (.not. place%ok) call fail(error, code_file, 'a checkpoint that does not fit this case')
  end subroutine read_states

  subroutine read_state(text, place, sizes, state)
    character(*), intent(in) :: text
    type(place_t), intent(inout) :: place
    integer, intent(in) :: sizes(3)
    type(sweep_state_t), intent(inout) :: state
    integer(int64), allocatable :: words(:)
    type(point_t) :: point
    integer :: i, k

    call begin_state(sizes(2), sizes(3), state)
    allocate (words(size(transfer(state%blocks, [0_int64]))))
    call take_words(text, place, words)
    if (place%ok) state%blocks = transfer(words, state%blocks)
    deallocate (words)
    allocate (words(sizes(3)))
    call take_words(text, place, words)
    if (place%ok) state%followed = int(words)
    call take_words(text, place, words)
    if (place%ok) state%pace = transfer(words, state%pace)
    deallocate (words)
    allocate (words(size(state%solved)))
    call take_words(text, place, words)
    if (place%ok) state%solved = reshape(words == 1, shape(state%solved))
    deallocate (words)
    allocate (words(size(transfer(point, [0_int64]))))
    do k = 1, sizes(3)
      do i = 1, sizes(2)
        call take_words(text, place, words)
        if (place%ok) state%points(i, k) = transfer(words, point)
      end do
    end do

  end subroutine read_state

  !> Two sums over the bytes, each modulo a large prime; against accidents, not against intent.
  pure integer(int64) function checksum(text)
    character(*), intent(in) :: text
    integer(int64), parameter :: modulus = 2147483647_int64
    integer(int64) :: first, second, i

    first = 1
    second = 0
    do i = 1, len(text, int64)
      first = modulo(first*31_int64 + iachar(text(i:i)), modulus)
      second = modulo(second + first, modulus)
    end do
    checksum = ior(ishft(second, 32), first)
  end function checksum
end module gearsweep_checkpoint
