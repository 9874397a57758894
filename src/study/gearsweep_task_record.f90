!> The result of a task that is done as part of a checkpoint.
module gearsweep_task_record
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_kinds, only: dp
  use gearsweep_record_file, only: record_reader_t, record_writer_t
  use gearsweep_table, only: column_t, kind_real, kind_text, table_t
  use gearsweep_task, only: task_slot_t, task_t
  implicit none
  private
  public :: is_recorded, put_task, take_task

contains

  !> Is this task's result recorded? Not where it has more than tables: a grid.
  pure logical function is_recorded(task)
    class(task_t), intent(in) :: task

    is_recorded = task%is_done .and. .not. (task%is_stopped .or. allocated(task%grid))
  end function is_recorded

  subroutine put_task(slot, writer)
    type(task_slot_t), intent(in) :: slot
    type(record_writer_t), intent(inout) :: writer
    integer :: k

    call writer%put_text(trim(slot%info%name))
    call writer%put([int(slot%task%failed, int64)])
    call writer%put_text(slot%task%log)
    do k = 1, size(slot%task%tables)
      call put_table(slot%task%tables(k), writer)
    end do
  end subroutine put_task

  subroutine put_table(table, writer)
    type(table_t), intent(in) :: table
    type(record_writer_t), intent(inout) :: writer
    integer :: i

    if (.not. table%is_there()) then
      call writer%put([-1_int64])
      return
    end if
    call writer%put(int([table%rows, size(table%columns)], int64))
    call writer%put_text(table%meaning)
    call writer%put_text(table%grid)
    if (allocated(table%extent)) then
      call writer%put(int([size(table%extent), table%extent], int64))
    else
      call writer%put([-1_int64])
    end if
    do i = 1, size(table%columns)
      associate (column => table%columns(i))
        call writer%put(int([column%kind, merge(1, 0, column%is_index), merge(1, 0, column%is_reproducible)], int64))
        call writer%put_text(column%name)
        call writer%put_text(column%unit)
        call writer%put_text(column%meaning)
        if (column%kind == kind_text) call put_words(column%words, writer)
        if (column%kind /= kind_text) call writer%put(transfer(column%numbers, [0_int64]))
      end associate
    end do
  end subroutine put_table

  subroutine put_words(words, writer)
    character(*), intent(in) :: words(:)
    type(record_writer_t), intent(inout) :: writer
    character(:), allocatable :: text
    integer(int64) :: k

    ! gfortran 12 mixes letters up in a transfer of words of deferred length.
    allocate (character(len(words, int64)*size(words)) :: text)
    do k = 1, size(words)
      text(len(words)*(k - 1) + 1:len(words)*k) = words(k)
    end do
    call writer%put([len(words, int64)])
    call writer%put_text(text)
  end subroutine put_words

  !> The next task into its slot.
  subroutine take_task(reader, tasks)
    type(record_reader_t), intent(inout) :: reader
    type(task_slot_t), intent(inout) :: tasks(:)  !< all that there are
    character(:), allocatable :: name
    integer(int64) :: failed(1)
    integer :: i, k

    call reader%take_text(name)
    i = findloc(tasks%info%name == name, .true., 1)
    reader%is_good = reader%is_good .and. i > 0
    if (.not. reader%is_good) return
    associate (task => tasks(i)%task)
      reader%is_good = .not. task%is_done
      if (.not. reader%is_good) return
      call task%prepare()
      failed = 0
      call reader%take(failed)
      task%failed = int(failed(1))
      call reader%take_text(task%log)
      do k = 1, size(task%tables)
        if (reader%is_good) call take_table(reader, task%tables(k))
      end do
      task%is_done = reader%is_good
    end associate
  end subroutine take_task

  subroutine take_table(reader, table)
    type(record_reader_t), intent(inout) :: reader
    type(table_t), intent(inout) :: table
    integer(int64) :: sizes(2), extents(1)
    integer(int64), allocatable :: extent(:)
    integer :: i

    sizes = -1
    call reader%take(sizes(:1))
    if (sizes(1) == -1) return
    call reader%take(sizes(2:))
    reader%is_good = reader%is_good .and. all(sizes >= 0) .and. sizes(1) <= huge(1) .and. sizes(2) <= reader%words
    if (.not. reader%is_good) return
    table%rows = int(sizes(1))
    call reader%take_text(table%meaning)
    call reader%take_text(table%grid)
    extents = -1
    call reader%take(extents)
    reader%is_good = reader%is_good .and. extents(1) <= sizes(2)
    if (.not. reader%is_good) return
    allocate (extent(max(0_int64, extents(1))))
    call reader%take(extent)
    if (extents(1) >= 0) then
      reader%is_good = reader%is_good .and. abs(product(real(extent, dp)) - sizes(1)) < 0.5_dp .and. all(abs(extent) <= huge(1))
      table%extent = int(extent)
    end if
    allocate (table%columns(sizes(2)))
    do i = 1, size(table%columns)
      if (reader%is_good) call take_column(reader, table%rows, table%columns(i))
    end do
  end subroutine take_table

  subroutine take_column(reader, rows, column)
    type(record_reader_t), intent(inout) :: reader
    integer, intent(in) :: rows
    type(column_t), intent(inout) :: column
    integer(int64) :: about(3), width(1)
    integer(int64), allocatable :: words(:)
    character(:), allocatable :: text
    integer(int64) :: k

    about = 0
    call reader%take(about)
    call reader%take_text(column%name)
    call reader%take_text(column%unit)
    call reader%take_text(column%meaning)
    reader%is_good = reader%is_good .and. about(1) >= kind_real .and. about(1) <= kind_text
    if (.not. reader%is_good) return
    column%kind = int(about(1))
    column%is_index = about(2) == 1
    column%is_reproducible = about(3) == 1
    if (column%kind == kind_text) then
      width = 0
      call reader%take(width)
      call reader%take_text(text)
      reader%is_good = reader%is_good .and. width(1) >= 0 .and. width(1) <= len(text) .and. width(1)*rows == len(text, int64)
      if (.not. reader%is_good) return
      allocate (character(width(1)) :: column%words(rows))
      do k = 1, rows
        column%words(k) = text(width(1)*(k - 1) + 1:width(1)*k)
      end do
    else
      reader%is_good = rows <= reader%words
      if (.not. reader%is_good) return
      allocate (words(rows))
      call reader%take(words)
      column%numbers = transfer(words, 0.0_dp, rows)
    end if
  end subroutine take_column
end module gearsweep_task_record
