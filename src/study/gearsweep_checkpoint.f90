!> The record of an interrupted run in a file: a run of the same version on the same inputs goes on from it, to the
!> same bits.
!>
!> The first line names the format, version and a sum of the inputs: the case's text and the files that it names. Then come, in
!> words of 64 bits, the sweeps that had begun and were not done, and the tasks that were; each begins with a word that says what
!> it is.
module gearsweep_checkpoint
  use, intrinsic :: iso_c_binding, only: c_null_char
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_case, only: case_t, speed_count
  use gearsweep_error, only: error_t, fail, code_file
  use gearsweep_file_set, only: file_set_t
  use gearsweep_files, only: beside, read_text
  use gearsweep_kinds, only: dp
  use gearsweep_memory, only: claim_memory
  use gearsweep_optimum, only: most_tried
  use gearsweep_record_file, only: opening_length, record_reader_t, record_writer_t, sum_of_text
  use gearsweep_steady_motion, only: point_t
  use gearsweep_study, only: record_t
  use gearsweep_sweep_state, only: begin_state, sweep_state_t
  use gearsweep_system, only: drop_file
  use gearsweep_task_record, only: is_recorded, put_task, take_task
  use gearsweep_text, only: str
  use gearsweep_version, only: version
  implicit none
  private
  public :: save_record, load_record, try_checkpoint, drop_checkpoint

  character(*), parameter :: start = 'gearsweep checkpoint ', format = start//'4'
  !> What comes next in the file.
  integer(int64), parameter :: at_end = 0, at_sweep = 1, at_task = 2
  !> In the word before a point: it is solved. The bits below name the words that differ from those of the point before.
  integer, parameter :: solved_bit = 62

contains

  !> Fails where no checkpoint can be written under this name.
  subroutine try_checkpoint(path, error)
    character(*), intent(in) :: path
    type(error_t), allocatable, intent(inout) :: error
    type(file_set_t) :: files
    logical :: is_folder

    if (allocated(error)) return
    inquire (file=path//'/.', exist=is_folder)
    if (is_folder) call fail(error, code_file, 'cannot write '//path//': it is a folder')
    associate (last => index(path, '/', back=.true.))
      call files%begin(path(:last)//'.', error)
      call files%add(path(last + 1:), format, format, error)
    end associate
    call files%leave()
  end subroutine try_checkpoint

  !> Writes the record to a file, whole or not at all. `folder` is where the case's files lie, with its slash.
  subroutine save_record(record, case, folder, path, error)
    type(record_t), intent(in) :: record
    type(case_t), intent(in) :: case
    character(*), intent(in) :: folder, path
    type(error_t), allocatable, intent(inout) :: error
    type(record_writer_t) :: writer
    character(:), allocatable :: opening
    integer :: i

    if (allocated(error)) return
    call first_line(case, folder, opening)
    call writer%begin(path, opening, error)
    if (allocated(error)) return
    do i = 1, size(record%states)
      if (.not. allocated(record%states(i)%points) .or. is_done(record, merge('sweep  ', 'optimum', i == 1))) cycle
      call writer%put([at_sweep, int(i, int64)])
      call put_state(record%states(i), writer)
    end do
    if (allocated(record%tasks)) then
      do i = 1, size(record%tasks)
        if (.not. is_recorded(record%tasks(i)%task)) cycle
        call writer%put([at_task])
        call put_task(record%tasks(i), writer)
      end do
    end if
    call writer%put([at_end])
    call writer%finish(error)
  end subroutine save_record

  !> Is the task recorded by its tables? Then its sweeps are no longer needed.
  pure logical function is_done(record, name)
    type(record_t), intent(in) :: record
    character(*), intent(in) :: name
    integer :: i

    is_done = .false.
    if (.not. allocated(record%tasks)) return
    do i = 1, size(record%tasks)
      if (record%tasks(i)%info%name == name) is_done = is_recorded(record%tasks(i)%task)
    end do
  end function is_done

  !> Reads the record of an interrupted run of this case.
  subroutine load_record(path, case, folder, record, error)
    character(*), intent(in) :: path, folder
    type(case_t), intent(in) :: case
    type(record_t), intent(out) :: record
    type(error_t), allocatable, intent(inout) :: error
    type(record_reader_t) :: reader
    character(opening_length) :: line
    character(:), allocatable :: opening

    if (allocated(error)) return
    call first_line(case, folder, opening)
    call reader%begin(path, line, error)
    if (allocated(error)) return
    if (index(line, start) /= 1) then
      call refuse('is no checkpoint of gearsweep')
    else if (index(line, format//' version '//version//' ') /= 1) then
      call refuse('is of another version of gearsweep than '//version)
    else
      call reader%look_through(path, error)
      if (.not. (reader%is_good .or. allocated(error))) call refuse('is damaged')
      if (line(:opening_length - 1) /= opening) &
        call refuse('is of another case: the case or a file that it names was changed since')
      if (.not. allocated(error)) call take_parts(case, reader, record, error)
      if (.not. (reader%is_good .or. allocated(error))) call refuse('does not fit this case')
    end if
    call reader%finish()

  contains

    subroutine refuse(why)
      character(*), intent(in) :: why

      call fail(error, code_file, 'cannot resume from '//path//': '//why)
    end subroutine refuse
  end subroutine load_record

  !> Removes this case's checkpoint, which is no longer needed, if there is one. Another file of this name is none of ours.
  subroutine drop_checkpoint(path, case, folder)
    character(*), intent(in) :: path, folder
    type(case_t), intent(in) :: case
    character(:), allocatable :: opening

    call first_line(case, folder, opening)
    call drop_file(path//c_null_char, opening//' '//c_null_char)
  end subroutine drop_checkpoint

  subroutine first_line(case, folder, line)
    type(case_t), intent(in) :: case
    character(*), intent(in) :: folder
    character(:), allocatable, intent(out) :: line
    character(:), allocatable :: inputs, table
    type(error_t), allocatable :: missing
    character(16) :: sum
    integer :: i, k

    inputs = case%text
    call add_table(case%file)
    call add_table(case%profile_error_file)
    do i = 1, size(case%tasks)
      if (.not. (case%tasks(i)%is_wanted .and. allocated(case%tasks(i)%task%files))) cycle
      do k = 1, size(case%tasks(i)%task%files)
        call add_table(case%tasks(i)%task%files(k)%name)
      end do
    end do
    write (sum, '(z16.16)') sum_of_text(inputs)
    line = format//' version '//version//' inputs '//sum

  contains

    subroutine add_table(file)
      character(:), allocatable, intent(in) :: file

      if (.not. allocated(file)) return
      call read_text(beside(folder, file), table, missing)
      if (.not. allocated(missing)) inputs = inputs//achar(0)//table
    end subroutine add_table
  end subroutine first_line

  subroutine put_state(state, writer)
    type(sweep_state_t), intent(in) :: state
    type(record_writer_t), intent(inout) :: writer

    call writer%put(int([shape(state%points), size(state%blocks)], int64))
    associate (blocks => state%blocks)
      call writer%put(int([blocks%together, blocks%grouped, blocks%single], int64))
      call writer%put(transfer([blocks%pace_together, blocks%pace], [0_int64]))
    end associate
    call writer%put(int([state%followed, state%returned], int64))
    call writer%put(transfer(state%pace, [0_int64]))
    call put_points(state%points, state%solved, writer)
    call put_points(spread(state%above, 1, 1), spread(state%followed < 0, 1, 1), writer)
  end subroutine put_state

  !> Of each point the words that differ from those of the point before.
  subroutine put_points(points, solved, writer)
    type(point_t), intent(in) :: points(:, :)
    logical, intent(in) :: solved(:, :)
    type(record_writer_t), intent(inout) :: writer
    integer(int64), dimension(storage_size(points)/64) :: before, now
    integer(int64) :: new(0:storage_size(points)/64)   ! what differs, and the words that do
    integer :: i, k, j, n

    before = 0
    do k = 1, size(points, 2)
      do i = 1, size(points, 1)
        now = transfer(points(i, k), now)
        new(0) = 0
        n = 0
        do j = 1, size(now)
          if (now(j) == before(j)) cycle
          n = n + 1
          new(n) = now(j)
          new(0) = ibset(new(0), j - 1)
        end do
        if (solved(i, k)) new(0) = ibset(new(0), solved_bit)
        call writer%put(new(:n))
        before = now
      end do
    end do
  end subroutine put_points

  !> All that the file has, as far as it fits the case.
  subroutine take_parts(case, reader, record, error)
    type(case_t), intent(in) :: case
    type(record_reader_t), intent(inout) :: reader
    type(record_t), intent(inout) :: record
    type(error_t), allocatable, intent(inout) :: error
    integer(int64) :: part(1), number(1)

    do while (reader%is_good .and. .not. allocated(error))
      part = at_end
      call reader%take(part)
      if (part(1) == at_end) return
      if (part(1) == at_task) then
        if (.not. allocated(record%tasks)) record%tasks = case%tasks
        call take_task(reader, record%tasks)
      else
        number = 0
        call reader%take(number)
        reader%is_good = reader%is_good .and. part(1) == at_sweep .and. number(1) >= 1 .and. number(1) <= size(record%states)
        if (reader%is_good) call take_state(case, reader, record%states(number(1)), error)
      end if
    end do
  end subroutine take_parts

  subroutine take_state(case, reader, state, error)
    type(case_t), intent(in) :: case
    type(record_reader_t), intent(inout) :: reader
    type(sweep_state_t), intent(inout) :: state
    type(error_t), allocatable, intent(inout) :: error
    integer(int64) :: sizes(3)
    integer(int64), allocatable :: words(:, :), more(:)
    type(point_t), allocatable :: above(:, :)
    logical, allocatable :: none(:, :)
    integer :: i

    sizes = 0
    call reader%take(sizes)
    reader%is_good = reader%is_good .and. sizes(1) == speed_count(case) .and. sizes(2) >= 1 .and. &
                     sizes(2) <= max(size(case%amount), most_tried)
    if (.not. reader%is_good) return
    call claim_memory(sizes(1)*sizes(2)*(4.0_dp + storage_size(state%points)/8), &
                      'the checkpoint: '//str(int(sizes(1)))//' speeds times '//str(int(sizes(2)))//' reliefs', error)
    if (allocated(error)) return
    call begin_state(int(sizes(1)), int(sizes(2)), state)
    reader%is_good = size(state%blocks) == sizes(3)
    if (.not. reader%is_good) return
    allocate (words(sizes(3), 5), more(size(state%followed)))
    associate (blocks => state%blocks)
      call take_all(reader, words)
      do i = 1, 3
        reader%is_good = reader%is_good .and. all(words(:, i) >= blocks%first - 1) .and. all(words(:, i) <= blocks%last)
      end do
      if (.not. reader%is_good) return
      blocks%together = int(words(:, 1))
      blocks%grouped = int(words(:, 2))
      blocks%single = int(words(:, 3))
      blocks%pace_together = transfer(words(:, 4), 0.0_dp, size(blocks))
      blocks%pace = transfer(words(:, 5), 0.0_dp, size(blocks))
    end associate
    call reader%take(more)
    reader%is_good = reader%is_good .and. all(more >= 0 .and. more <= sizes(1))
    if (.not. reader%is_good) return
    state%followed = int(more)
    call reader%take(more)
    reader%is_good = reader%is_good .and. all(more >= 0 .and. more <= sizes(1))
    if (.not. reader%is_good) return
    state%returned = int(more)
    call reader%take(more)
    state%pace = transfer(more, 0.0_dp, size(more))
    call take_points(reader, state%points, state%solved)
    allocate (above(1, size(state%above)))
    allocate (none(1, size(state%above)))
    call take_points(reader, above, none)
    state%above = above(1, :)
  end subroutine take_state

  !> Column by column.
  subroutine take_all(reader, words)
    type(record_reader_t), intent(inout) :: reader
    integer(int64), intent(out) :: words(:, :)
    integer :: k

    words = -1
    do k = 1, size(words, 2)
      call reader%take(words(:, k))
    end do
  end subroutine take_all

  subroutine take_points(reader, points, solved)
    type(record_reader_t), intent(inout) :: reader
    type(point_t), intent(inout) :: points(:, :)
    logical, intent(inout) :: solved(:, :)
    integer(int64), dimension(storage_size(points)/64) :: now, new
    integer(int64) :: differs(1)
    integer :: i, k, j, n

    now = 0
    do k = 1, size(points, 2)
      do i = 1, size(points, 1)
        differs = 0
        call reader%take(differs)
        solved(i, k) = btest(differs(1), solved_bit)
        n = popcnt(ibclr(differs(1), solved_bit))
        reader%is_good = reader%is_good .and. n <= size(new)
        if (.not. reader%is_good) return
        call reader%take(new(:n))
        n = 0
        do j = 1, size(now)
          if (.not. btest(differs(1), j - 1)) cycle
          n = n + 1
          now(j) = new(n)
        end do
        points(i, k) = transfer(now, points(i, k))
      end do
    end do
  end subroutine take_points
end module gearsweep_checkpoint
