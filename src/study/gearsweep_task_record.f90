!> The tables of tasks that are done as text, and the bits of any numbers: parts of a checkpoint.
module gearsweep_task_record
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_kinds, only: dp
  use gearsweep_lines, only: lines_t
  use gearsweep_table, only: kind_text, table_t
  use gearsweep_task, only: task_t
  use gearsweep_tasks, only: list_tasks, task_slot_t
  use gearsweep_text, only: str
  implicit none
  private
  public :: place_t, is_recorded, add_tasks, read_task, add_words, take_words, take_line, hexadecimal

  integer, parameter :: digits = 16              ! of a word of 64 bits
  integer, parameter :: row = 8                  ! words in a line

  !> Where the reader is in the text.
  type :: place_t
    integer(int64) :: at = 1
    logical :: ok = .true.
  end type place_t

contains

  !> Is a task that is done recorded by its tables? Of those that sweep, the sweeps are.
  pure logical function is_recorded(task)
    class(task_t), intent(in) :: task

    is_recorded = task%is_done .and. .not. task%is_stopped .and. task%uses('motion') .and. .not. task%uses('direction')
  end function is_recorded

  subroutine add_tasks(tasks, lines)
    type(task_slot_t), intent(in) :: tasks(:)
    type(lines_t), intent(inout) :: lines
    integer :: i, k

    do i = 1, size(tasks)
      associate (task => tasks(i)%task)
        if (.not. is_recorded(task)) cycle
        call lines%add('task '//trim(tasks(i)%info%name))
        call lines%add(str(task%failed))
        call lines%add(task%log)
        do k = 1, size(task%tables)
          call add_table(task%tables(k), lines)
        end do
      end associate
    end do
  end subroutine add_tasks

  subroutine add_table(table, lines)
    type(table_t), intent(in) :: table
    type(lines_t), intent(inout) :: lines
    integer :: i, k

    if (.not. table%is_there()) then
      call lines%add('-1 0 0')
      return
    end if
    call lines%put(str(table%rows)//' '//str(size(table%columns)))
    if (.not. allocated(table%extent)) call lines%put(' 0')
    if (allocated(table%extent)) then
      call lines%put(' '//str(size(table%extent)))
      do i = 1, size(table%extent)
        call lines%put(' '//str(table%extent(i)))
      end do
    end if
    call lines%add('')
    call lines%add(table%meaning)
    do i = 1, size(table%columns)
      associate (column => table%columns(i))
        k = 0
        if (column%kind == kind_text) k = len(column%words)
        call lines%add(str(column%kind)//' '//str(merge(1, 0, column%is_index))//' '// &
                       str(merge(1, 0, column%is_reproducible))//' '//str(k))
        call lines%add(column%name)
        call lines%add(column%unit)
        call lines%add(column%meaning)
        if (column%kind == kind_text) then
          do k = 1, table%rows
            call lines%add(column%words(k))
          end do
        else
          call add_words(transfer(column%numbers, [0_int64]), lines)
        end if
      end associate
    end do
  end subroutine add_table

  !> The task of this name into its slot; all slots are made where there are none.
  subroutine read_task(text, place, name, tasks)
    character(*), intent(in) :: text, name
    type(place_t), intent(inout) :: place
    type(task_slot_t), allocatable, intent(inout) :: tasks(:)
    character(:), allocatable :: line
    integer :: i, k, stat

    if (.not. allocated(tasks)) call list_tasks(tasks)
    i = findloc(tasks%info%name == name, .true., 1)
    place%ok = i > 0
    if (.not. place%ok) return
    call tasks(i)%task%prepare()
    call take_line(text, place, line)
    read (line, *, iostat=stat) tasks(i)%task%failed
    place%ok = place%ok .and. stat == 0
    call take_line(text, place, tasks(i)%task%log)
    do k = 1, size(tasks(i)%task%tables)
      if (place%ok) call read_table(text, place, tasks(i)%task%tables(k))
    end do
    tasks(i)%task%is_done = place%ok
  end subroutine read_task

  subroutine read_table(text, place, table)
    character(*), intent(in) :: text
    type(place_t), intent(inout) :: place
    type(table_t), intent(inout) :: table
    integer(int64), allocatable :: words(:)
    character(:), allocatable :: line
    integer :: sizes(3), column(4), i, k, stat

    call take_line(text, place, line)
    read (line, *, iostat=stat) sizes
    place%ok = place%ok .and. stat == 0 .and. all(sizes(2:) >= 0) .and. real(sizes(1), dp)*sizes(2) < len(text)
    if (.not. place%ok .or. sizes(1) < 0) return
    table%rows = sizes(1)
    table%grid = ''
    if (sizes(3) > 0) allocate (table%extent(sizes(3)))
    if (sizes(3) > 0) read (line, *, iostat=stat) sizes, table%extent
    place%ok = stat == 0
    call take_line(text, place, table%meaning)
    allocate (table%columns(sizes(2)))
    do i = 1, sizes(2)
      associate (to => table%columns(i))
        call take_line(text, place, line)
        read (line, *, iostat=stat) column
        place%ok = place%ok .and. stat == 0
        call take_line(text, place, to%name)
        call take_line(text, place, to%unit)
        call take_line(text, place, to%meaning)
        if (.not. place%ok) return
        to%kind = column(1)
        to%is_index = column(2) == 1
        to%is_reproducible = column(3) == 1
        if (to%kind == kind_text) then
          allocate (character(column(4)) :: to%words(table%rows))
          do k = 1, table%rows
            call take_line(text, place, line)
            to%words(k) = line
          end do
        else
          allocate (words(table%rows))
          call take_words(text, place, words)
          to%numbers = transfer(words, 0.0_dp, table%rows)
          deallocate (words)
        end if
      end associate
    end do
  end subroutine read_table

  pure subroutine add_words(words, lines)
    integer(int64), intent(in) :: words(:)
    type(lines_t), intent(inout) :: lines
    integer :: i

    do i = 1, size(words)
      call lines%put(hexadecimal(words(i)))
      if (modulo(i, row) == 0 .or. i == size(words)) call lines%add('')
    end do
  end subroutine add_words

  subroutine take_words(text, place, words)
    character(*), intent(in) :: text
    type(place_t), intent(inout) :: place
    integer(int64), intent(out) :: words(:)
    integer :: j, stat

    words = 0
    do j = 1, size(words)
      if (place%ok) place%ok = place%at + digits <= len(text)
      if (.not. place%ok) return
      read (text(place%at:place%at + digits - 1), '(z16)', iostat=stat) words(j)
      place%ok = stat == 0
      place%at = place%at + digits
      if (modulo(j, row) == 0 .or. j == size(words)) place%at = place%at + 1
    end do
  end subroutine take_words

  !> The next line, without its end.
  subroutine take_line(text, place, line)
    character(*), intent(in) :: text
    type(place_t), intent(inout) :: place
    character(:), allocatable, intent(out) :: line
    integer :: length

    length = 0
    if (place%ok .and. place%at <= len(text)) length = index(text(place%at:), new_line('a'))
    place%ok = length > 0
    line = text(place%at:place%at + length - 2)
    place%at = place%at + length
  end subroutine take_line

  pure function hexadecimal(word) result(text)
    integer(int64), intent(in) :: word
    character(digits) :: text
    character(*), parameter :: figures = '0123456789ABCDEF'
    integer :: i, figure

    do i = 1, digits
      figure = int(ibits(word, 4*(digits - i), 4))
      text(i:i) = figures(figure + 1:figure + 1)
    end do
  end function hexadecimal
end module gearsweep_task_record
