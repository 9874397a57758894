!> Printed values to set beside ours: a file names quantities, where they are
!> printed, how much, and whether they follow from the stated inputs.
module gearsweep_published
  use gearsweep_kinds, only: dp
  use gearsweep_error, only: error_t, fail, code_input
  use gearsweep_text, only: join, str, to_number
  use gearsweep_text_rows, only: find_rows, row_t
  implicit none
  private
  public :: published_t, read_published, split_quantity

  type :: published_t
    character(:), allocatable :: quantity, place, unit, status, reason
    real(dp) :: printed = 0
  end type published_t

  !> What we can set beside a printed value; # stands for a number from 1.
  character(*), parameter :: quantities(*) = [character(24) :: 'contact_ratio', 'tangential_force_n', 'radial_force_n', &
    'beam_frequency_rad_s', 'rayleigh_frequency_rad_s', 'beam_sigma_x_mpa', 'beam_sigma_y_mpa', 'mode_#_hz', &
    'step_#_sigma_x_mpa', 'step_#_sigma_y_mpa', 'step_#_tau_xy_mpa']
  character(*), parameter :: header = 'quantity,place,printed,unit,status,reason'

contains

  !> Reads `text`: comment lines (#), the header, then a row a value; the reason
  !> is the rest of its line. A text may stand in quotation marks, doubled inside. `path` is for messages.
  subroutine read_published(path, text, rows, error)
    character(*), intent(in) :: path, text
    type(published_t), allocatable, intent(out) :: rows(:)
    type(error_t), allocatable, intent(out) :: error
    type(row_t), allocatable :: lines(:)
    integer :: i

    call find_rows(text, path, header, lines, error)
    if (allocated(error)) return
    allocate (rows(size(lines)))
    do i = 1, size(lines)
      call read_row(text(lines(i)%first:lines(i)%last), lines(i)%line, rows(i))
      if (allocated(error)) return
    end do

  contains

    subroutine read_row(row, line, entry)
      character(*), intent(in) :: row
      integer, intent(in) :: line
      type(published_t), intent(out) :: entry
      character(:), allocatable :: rest, number
      character(:), allocatable :: name
      logical :: ok
      integer :: n

      rest = row
      call cut(rest, entry%quantity)
      call cut(rest, entry%place)
      call cut(rest, number)
      call cut(rest, entry%unit)
      call cut(rest, entry%status)
      call unquote(rest, entry%reason, n)
      if (n <= len(rest)) entry%reason = rest
      call to_number(trim(adjustl(number)), entry%printed, ok)
      if (ok) ok = abs(entry%printed) > 0
      if (.not. ok) call fail(error, code_input, path//' line '//str(line)//': printed = '//number// &
                              ': must be a number other than 0')
      call split_quantity(entry%quantity, name, n)
      if (all(quantities /= name)) call fail(error, code_input, path//' line '//str(line)//': quantity = '// &
        entry%quantity//': must be one of '//join(quantities, ', '))
      if (all(entry%status /= [character(16) :: 'stated', 'inferred', 'fitted', 'not reproducible'])) &
        call fail(error, code_input, path//' line '//str(line)//': status = '//entry%status// &
        ': must be stated, inferred, fitted or not reproducible')
    end subroutine read_row
  end subroutine read_published

  !> Replaces the number in a quantity's name by #, and tells it; 0 for none.
  pure subroutine split_quantity(quantity, name, n)
    character(*), intent(in) :: quantity
    character(:), allocatable, intent(out) :: name
    integer, intent(out) :: n
    integer :: from, until
    logical :: ok

    name = quantity
    n = 0
    from = scan(quantity, '0123456789')
    if (from == 0) return
    until = from + verify(quantity(from:)//' ', '0123456789') - 2
    call to_number(quantity(from:until), n, ok)
    if (ok .and. n > 0) name = quantity(:from - 1)//'#'//quantity(until + 1:)
  end subroutine split_quantity

  !> Takes the first field off a row.
  pure subroutine cut(rest, field)
    character(:), allocatable, intent(inout) :: rest
    character(:), allocatable, intent(out) :: field
    integer :: at

    call unquote(rest, field, at)
    if (at == 0) then
      at = index(rest, ',')
      if (at == 0) at = len(rest) + 1
      field = rest(:at - 1)
    end if
    rest = rest(min(at + 1, len(rest) + 1):)
  end subroutine cut

  !> The words of a first field that stands wholly in quotation marks, and where it ends; 0 where it does not stand so.
  pure subroutine unquote(rest, field, end)
    character(*), intent(in) :: rest
    character(:), allocatable, intent(out) :: field
    integer, intent(out) :: end
    integer :: used

    field = ''
    end = 0
    if (index(rest, '"') /= 1) return
    deallocate (field)
    allocate (character(len(rest)) :: field)
    used = 0
    end = 2
    do while (end <= len(rest))
      if (rest(end:end) == '"') then
        if (rest(end + 1:min(end + 1, len(rest))) /= '"') exit
        end = end + 1
      end if
      used = used + 1
      field(used:used) = rest(end:end)
      end = end + 1
    end do
    field = field(:used)
    ! Behind the closing mark.
    end = end + 1
    if (end == len(rest) + 1) return
    if (end > len(rest)) then
      end = 0
    else if (rest(end:end) /= ',') then
      end = 0
    end if
  end subroutine unquote
end module gearsweep_published
