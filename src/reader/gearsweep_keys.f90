!> The keys of a format, as its reader asks for them, with the values in effect.
module gearsweep_keys
  use gearsweep_key, only: key_t
  use gearsweep_lines, only: lines_t
  use gearsweep_namelist, only: name_length, namelist_t, value_t
  use gearsweep_text, only: closest_word, join, lower
  implicit none
  private
  public :: group_t, keys_t

  type :: group_t
    character(name_length) :: name = ''
    character(:), allocatable :: meaning         !< one sentence
  end type group_t

  type :: keys_t
    type(group_t), allocatable :: groups(:)      !< of the format
    type(key_t), allocatable :: key(:)           !< the first `known` count
    integer :: known = 0, last = 0               !< the key added last
  contains
    procedure :: add_group, add, set_default, list_groups, has, why_unknown, find_lacking, list_waiting, write_case, write_given
  end type keys_t

contains

  !> A group of the format, in the order in which a case is written.
  pure subroutine add_group(self, name, meaning)
    class(keys_t), intent(inout) :: self
    character(*), intent(in) :: name, meaning
    type(group_t), allocatable :: more(:)
    integer :: n

    if (.not. allocated(self%groups)) allocate (self%groups(0))
    n = size(self%groups)
    ! gfortran does not free the texts of an array constructor's elements.
    allocate (more(n + 1))
    more(:n) = self%groups
    more(n + 1)%name = name
    more(n + 1)%meaning = meaning
    call move_alloc(more, self%groups)
  end subroutine add_group

  !> The groups' names, as many as there are.
  pure subroutine list_groups(self, names)
    class(keys_t), intent(in) :: self
    character(name_length), allocatable, intent(out) :: names(:)
    integer :: i

    allocate (names(size(self%groups)))
    do i = 1, size(names)
      names(i) = self%groups(i)%name
    end do
  end subroutine list_groups

  !> A key that is asked for again stays one.
  pure subroutine add(self, key)
    class(keys_t), intent(inout) :: self
    type(key_t), intent(in) :: key
    integer, parameter :: first_size = 64
    type(key_t), allocatable :: more(:)
    integer :: i

    if (.not. allocated(self%key)) allocate (self%key(first_size))
    do i = 1, self%known
      if (self%key(i)%name == key%name .and. self%key(i)%group == key%group) exit
    end do
    if (i > size(self%key)) then
      allocate (more(2*size(self%key)))
      more(:size(self%key)) = self%key
      call move_alloc(more, self%key)
    end if
    self%last = i
    self%known = max(i, self%known)
    self%key(i) = key
  end subroutine add

  !> The default of the key added last, where it is not given.
  pure subroutine set_default(self, default)
    class(keys_t), intent(inout) :: self
    character(*), intent(in) :: default

    self%key(self%last)%default = default
  end subroutine set_default

  !> Has this key been asked for? Names in lower case.
  pure logical function has(self, group, name)
    class(keys_t), intent(in) :: self
    character(*), intent(in) :: group, name
    integer :: i

    has = any([(self%key(i)%group == group .and. self%key(i)%name == name, i=1, self%known)])
  end function has

  !> Why there is no such key, and which would be right.
  pure subroutine why_unknown(self, group, name, why)
    class(keys_t), intent(in) :: self
    character(*), intent(in) :: group, name
    character(:), allocatable, intent(out) :: why
    character(name_length), allocatable :: names(:), homes(:)
    integer :: closest, i

    call self%list_groups(homes)
    homes = pack(homes, [(self%has(trim(homes(i)), name), i=1, size(homes))])
    names = pack([(self%key(i)%name, i=1, self%known)], [(self%key(i)%group == group, i=1, self%known)])
    closest = closest_word(name, names)
    why = 'unknown key'
    if (closest > 0) then
      why = why//' (did you mean '//trim(names(closest))//'?)'
    else if (size(homes) > 0) then
      why = why//'; it belongs to &'//trim(homes(1))
    end if
    why = why//'; the keys of &'//group//' are '//join(names, ', ')
  end subroutine why_unknown

  !> Keys of which exactly one must be given, if none is, with a comma in front; else empty.
  pure subroutine find_lacking(self, words)
    class(keys_t), intent(in) :: self
    character(:), allocatable, intent(out) :: words
    integer :: i

    words = ''
    do i = 1, self%known
      associate (key => self%key(i))
        if (.not. key%is_one_of .or. len(key%lacks) > 0) cycle
        if (key%entry > 0) exit
        if (len(words) == 0) words = ', one of &'//trim(key%group)
        words = words//' '//trim(key%name)
      end associate
    end do
    if (i <= self%known) words = ''
  end subroutine find_lacking

  !> The given keys that are not used: for each set of tasks a line `tasks: &group key, key; &group key`.
  pure subroutine list_waiting(self, text)
    class(keys_t), intent(in) :: self
    character(:), allocatable, intent(out) :: text
    type(lines_t) :: lines
    logical :: told(self%known)
    integer :: i, k, before

    told = .false.
    do i = 1, self%known
      if (told(i) .or. .not. is_unused(i)) cycle
      call lines%put(self%key(i)%lacks//':')
      before = 0
      do k = i, self%known
        if (.not. is_unused(k)) cycle
        if (self%key(k)%lacks /= self%key(i)%lacks) cycle
        if (before == 0) then
          call lines%put(' &'//trim(self%key(k)%group)//' ')
        else if (self%key(k)%group == self%key(before)%group) then
          call lines%put(', ')
        else
          call lines%put('; &'//trim(self%key(k)%group)//' ')
        end if
        call lines%put(trim(self%key(k)%name))
        told(k) = .true.
        before = k
      end do
      call lines%add('')
    end do
    text = lines%text()

  contains

    pure logical function is_unused(i)
      integer, intent(in) :: i

      is_unused = self%key(i)%entry > 0 .and. len(self%key(i)%lacks) > 0
    end function is_unused
  end subroutine list_waiting

  !> All values in effect as a case: what `list` gives, and the defaults of the rest.
  pure subroutine write_case(self, list, text)
    class(keys_t), intent(in) :: self
    type(namelist_t), intent(in) :: list
    character(:), allocatable, intent(out) :: text
    type(lines_t) :: lines
    logical :: opened
    integer :: i, k

    do i = 1, size(self%groups)
      opened = .false.
      do k = 1, self%known
        associate (key => self%key(k))
          if (key%group /= self%groups(i)%name .or. .not. (key%entry > 0 .or. counts(key))) cycle
          if (.not. opened) call lines%add('&'//trim(self%groups(i)%name))
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

  contains

    !> Does the default of this key take part?
    pure logical function counts(key)
      type(key_t), intent(in) :: key

      counts = allocated(key%default) .and. len(key%lacks) == 0 .and. len(key%refused) == 0
    end function counts
  end subroutine write_case

  !> What `list` gives of the keys from the one with the number `first` on, as assignments.
  pure subroutine write_given(self, list, first, text)
    class(keys_t), intent(in) :: self
    type(namelist_t), intent(in) :: list
    integer, intent(in) :: first
    character(:), allocatable, intent(out) :: text
    type(lines_t) :: lines
    integer :: k

    do k = first, self%known
      associate (key => self%key(k))
        if (key%entry > 0) call add_values(lines, trim(key%name), list%entries(key%entry)%values)
      end associate
    end do
    text = lines%text()
  end subroutine write_given

  !> An assignment, on as many lines as it needs.
  pure subroutine add_values(lines, name, values)
    type(lines_t), intent(inout) :: lines
    character(*), intent(in) :: name
    type(value_t), intent(in) :: values(:)
    integer, parameter :: wide = 100
    integer :: i, width

    call lines%put('  '//name//' =')
    width = 0
    do i = 1, size(values)
      if (width > wide) then
        call lines%add('')
        call lines%put('   ')
        width = 0
      end if
      call lines%put(' ')
      call put_value(lines, values(i))
      if (i < size(values)) call lines%put(',')
      width = width + len(values(i)%text) + 2
    end do
    call lines%add('')
  end subroutine add_values

  !> A value as a case has it: text in quotes, which are doubled inside.
  pure subroutine put_value(lines, value)
    type(lines_t), intent(inout) :: lines
    type(value_t), intent(in) :: value
    integer :: i

    if (.not. value%quoted) then
      call lines%put(value%text)
      return
    end if
    call lines%put('''')
    do i = 1, len(value%text)
      call lines%put(value%text(i:i))
      if (value%text(i:i) == '''') call lines%put('''')
    end do
    call lines%put('''')
  end subroutine put_value
end module gearsweep_keys
