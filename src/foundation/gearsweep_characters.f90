!> Characters that no text of ours may have: terminals obey them.
module gearsweep_characters
  use gearsweep_text, only: str
  implicit none
  private
  public :: first_control, find_control, printable

  character, parameter :: lf = new_line('a')

contains

  !> Where the first control character stands, 0 for none: of ASCII all but tabs and line ends (LF, CRLF, and CR as
  !> the last of all), and the controls from 128 to 159, as UTF-8 or as a byte that is part of no UTF-8 character.
  pure integer function first_control(text) result(at)
    character(*), intent(in) :: text
    integer :: length

    at = 1
    do while (at <= len(text))
      length = character_length(text, at)
      select case (iachar(text(at:at)))
      case (9, 10)
      case (13)
        if (at < len(text)) then
          if (text(at + 1:at + 1) /= lf) return
        end if
      case (0:8, 11:12, 14:31, 127, 128:159)
        return
      case (194)
        if (length == 2) then
          if (iachar(text(at + 1:at + 1)) < 160) return
        end if
      case default
      end select
      at = at + length
    end do
    at = 0
  end function first_control

  !> The line of the first control character, 0 for none, and which it is, for a message.
  pure subroutine find_control(text, line, words)
    character(*), intent(in) :: text
    integer, intent(out) :: line
    character(:), allocatable, intent(out) :: words
    integer :: at, code, i

    line = 0
    at = first_control(text)
    if (at == 0) return
    line = 1
    do i = 1, at - 1
      if (text(i:i) == lf) line = line + 1
    end do
    code = iachar(text(at:at))
    if (code == 194) code = iachar(text(at + 1:at + 1))
    words = 'a control character (code '//str(code)//')'
    if (code > 127) words = words//'; is the text in UTF-8?'
  end subroutine find_control

  !> Bytes of the UTF-8 character that begins here; 1 where none does.
  pure integer function character_length(text, at) result(length)
    character(*), intent(in) :: text
    integer, intent(in) :: at
    integer :: i

    select case (iachar(text(at:at)))
    case (194:223)
      length = 2
    case (224:239)
      length = 3
    case (240:244)
      length = 4
    case default
      length = 1
    end select
    if (at + length - 1 > len(text)) length = 1
    do i = at + 1, at + length - 1
      if (iand(iachar(text(i:i)), 192) /= 128) length = 1
    end do
  end function character_length

  !> The text on one line, with `?` for every control character.
  pure function printable(text) result(clean)
    character(*), intent(in) :: text
    character(len(text)) :: clean
    integer :: at

    clean = text
    do
      at = first_control(clean)
      if (at == 0) at = scan(clean, achar(9)//achar(10)//achar(13))
      if (at == 0) return
      if (iachar(clean(at:at)) == 194) clean(at + 1:at + 1) = '?'
      clean(at:at) = '?'
    end do
  end function printable
end module gearsweep_characters
