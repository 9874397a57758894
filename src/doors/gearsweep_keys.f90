!> The keys of a format, as its reader asks for them, with the values in effect.
module gearsweep_keys
  use gearsweep_lines, only: lines_t
  use gearsweep_namelist, only: name_length, namelist_t, value_t
  use gearsweep_text, only: closest_word, join, lower
  implicit none
  private
  public :: keys_t

  !> Where it is given, its entry in the namelist; else its default as a case has
  !> it, not allocated where there is none.
  type :: key_t
    character(name_length) :: group, name
    integer :: entry = 0
    character(:), allocatable :: default
  end type key_t

  type :: keys_t
    private
    type(key_t), allocatable :: key(:)           !< the first `known` count
    integer :: known = 0, last = 0               !< the key added last
  contains
    procedure :: add, settle, forget, groups, why_unknown, write_case
  end type keys_t

contains

  !> A key that is asked for again stays one. `entry` is 0 where it is not given.
  pure subroutine add(self, group, name, entry)
    class(keys_t), intent(inout) :: self
    character(*), intent(in) :: group, name
    integer, intent(in) :: entry
    integer, parameter :: most = 1000
    integer :: i

    if (.not. allocated(self%key)) allocate (self%key(most))
    self%last = 0
    do i = 1, self%known
      if (self%key(i)%group == lower(group) .and. self%key(i)%name == lower(name)) self%last = i
    end do
    if (self%last == 0) then
      self%known = self%known + 1
      self%last = self%known
    end if
    associate (key => self%key(self%last))
      key%group = lower(group)
      key%name = lower(name)
      key%entry = entry
    end associate
  end subroutine add

  !> The default of the key added last, where it is not given.
  pure subroutine settle(self, default)
    class(keys_t), intent(inout) :: self
    character(*), intent(in) :: default

    if (self%last > 0) self%key(self%last)%default = default
  end subroutine settle

  !> What the case must not have is not in effect.
  pure subroutine forget(self, group, name)
    class(keys_t), intent(inout) :: self
    character(*), intent(in) :: group
    character(*), intent(in), optional :: name
    integer :: i

    do i = 1, self%known
      associate (key => self%key(i))
        if (key%group /= lower(group)) cycle
        if (present(name)) then
          if (key%name /= lower(name)) cycle
        end if
        key%entry = 0
        if (allocated(key%default)) deallocate (key%default)
      end associate
    end do
  end subroutine forget

  pure function groups(self)
    class(keys_t), intent(in) :: self
    character(name_length), allocatable :: groups(:)

    groups = distinct(self%key(:self%known)%group)
  end function groups

  !> Why there is no such key, and which would be right.
  pure function why_unknown(self, group, name) result(why)
    class(keys_t), intent(in) :: self
    character(*), intent(in) :: group, name
    character(:), allocatable :: why
    character(name_length), allocatable :: names(:), homes(:)

    associate (key => self%key(:self%known))
      names = distinct(pack(key%name, key%group == group))
      homes = pack(key%group, key%name == name)
    end associate
    why = closest_word(name, names)
    if (why /= '') then
      why = ' (did you mean '//why//'?)'
    else if (size(homes) > 0) then
      why = '; it belongs to &'//trim(homes(1))
    end if
    why = 'unknown key'//why//'; the keys of &'//group//' are '//join(names, ', ')
  end function why_unknown

  !> All values in effect as a case: what `list` gives, and the defaults of the rest.
  pure subroutine write_case(self, list, text)
    class(keys_t), intent(in) :: self
    type(namelist_t), intent(in) :: list
    character(:), allocatable, intent(out) :: text
    character(name_length), allocatable :: names(:)
    type(lines_t) :: lines
    logical :: opened
    integer :: i, k

    names = distinct(self%key(:self%known)%group)
    do i = 1, size(names)
      opened = .false.
      do k = 1, self%known
        associate (key => self%key(k))
          if (key%group /= names(i) .or. .not. (key%entry > 0 .or. allocated(key%default))) cycle
          if (.not. opened) call lines%add('&'//trim(names(i)))
          opened = .true.
          if (key%entry > 0) then
            call add_values(lines, trim(key%name), list%entries(key%entry)%values)
          else
            call lines%add('  '//trim(key%name)//' = '//key%default)
          end if
        end associate
      end do
      if (opened) call lines%add('/')
    end do
    text = lines%text()
  end subroutine write_case

  !> An assignment, on as many lines as it needs.
  pure subroutine add_values(lines, name, values)
    type(lines_t), intent(inout) :: lines
    character(*), intent(in) :: name
    type(value_t), intent(in) :: values(:)
    integer, parameter :: wide = 100
    character(:), allocatable :: line
    integer :: i

    line = '  '//name//' ='
    do i = 1, size(values)
      if (len(line) > wide) then
        call lines%add(line)
        line = '   '
      end if
      line = line//' '//written(values(i))
      if (i < size(values)) line = line//','
    end do
    call lines%add(line)
  end subroutine add_values

  !> A value as a case has it: text in quotes, which are doubled inside.
  pure function written(value) result(words)
    type(value_t), intent(in) :: value
    character(:), allocatable :: words
    integer :: i

    words = value%text
    if (.not. value%quoted) return
    words = ''''
    do i = 1, len(value%text)
      words = words//value%text(i:i)
      if (value%text(i:i) == '''') words = words//''''
    end do
    words = words//''''
  end function written

  pure function distinct(words) result(once)
    character(name_length), intent(in) :: words(:)
    character(name_length), allocatable :: once(:)
    integer :: i, n

    allocate (once(size(words)))
    n = 0
    do i = 1, size(words)
      if (any(once(:n) == words(i))) cycle
      n = n + 1
      once(n) = words(i)
    end do
    once = once(:n)
  end function distinct
end module gearsweep_keys
