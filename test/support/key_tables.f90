!> Tables of the keys for doc/case.md, from their declarations.
module test_support_key_tables
  use gearsweep_api_case_reader, only: list_keys
  use gearsweep_api_help, only: default_of
  use gearsweep_base_lines, only: lines_t
  use gearsweep_study_case_task, only: task_length
  use gearsweep_study_reader_keys, only: keys_t, kind_logical, kind_text
  implicit none
  private
  public :: write_key_table

contains

  !> Writes the keys of a group as a table of doc/case.md; keys that pinion and gear have alike share a row. Units are in the names
  !> of the keys, ranges in the help on a key.
  subroutine write_key_table(group, text)
    character(*), intent(in) :: group
    character(:), allocatable, intent(out) :: text
    character(*), parameter :: of_pinion = 'pinion_', of_gear = 'gear_'
    type(keys_t) :: keys
    type(lines_t) :: lines
    character(:), allocatable :: names, default, words
    integer :: i, gear

    call list_keys([character(task_length) ::], keys)
    call lines%add('| key | default | meaning |')
    call lines%add('|---|---|---|')
    do i = 1, keys%known
      if (keys%key(i)%group /= group) cycle
      if (twin_of(i, of_gear, of_pinion) > 0) cycle
      names = '`'//trim(keys%key(i)%name)//'`'
      gear = twin_of(i, of_pinion, of_gear)
      if (gear > 0) names = names//', `'//trim(keys%key(gear)%name)//'`'
      default = trim(default_of(keys%key(i)))
      if (default == 'required') default = '**required**'
      if (keys%key(i)%is_one_of) default = '**one of these**'
      if (default == 'none') default = '-'
      if (allocated(keys%key(i)%default) .and. len(keys%key(i)%default_note) == 0 .and. default /= 'empty' .and. &
          any(keys%key(i)%kind == [kind_logical, kind_text])) default = '`'//keys%key(i)%default//'`'
      words = ''
      if (allocated(keys%key(i)%words)) then
        call keys%key(i)%list_allowed(words)
        words = ' (`'//words//'`)'
      end if
      call lines%add('| '//names//' | '//default//' | '//keys%key(i)%meaning//words//' |')
    end do
    text = lines%text()

  contains

    !> Index of the key of the other gear with the same default and meaning, or 0.
    pure integer function twin_of(i, begin, other)
      integer, intent(in) :: i
      character(*), intent(in) :: begin, other
      integer :: j

      twin_of = 0
      if (index(keys%key(i)%name, begin) /= 1) return
      do j = 1, keys%known
        if (keys%key(j)%group == group .and. keys%key(j)%name == other//keys%key(i)%name(len(begin) + 1:) .and. &
            keys%key(j)%meaning == keys%key(i)%meaning .and. default_of(keys%key(j)) == default_of(keys%key(i))) twin_of = j
      end do
    end function twin_of
  end subroutine write_key_table
end module test_support_key_tables
