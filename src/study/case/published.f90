!> Printed values for comparison: a file names each quantity, its place in print, its value, and whether it follows from the stated
!> inputs.
module gearsweep_study_case_published
  use gearsweep_base, only: dp, error_t, find_rows, join, rows_t, shown, to_number
  implicit none
  private
  public :: published_t, read_published, split_quantity

  type :: published_t
    character(:), allocatable :: quantity, place, unit, status, reason
    real(dp) :: printed = 0
  end type published_t

  !> Quantities that can be compared with a printed value; # is a number from 1.
  character(*), parameter :: quantities(*) = [character(24) :: 'contact_ratio', 'tangential_force_n', 'radial_force_n', &
    'beam_frequency_rad_s', 'rayleigh_frequency_rad_s', 'beam_sigma_x_mpa', 'beam_sigma_y_mpa', 'mode_#_hz', &
    'step_#_sigma_x_mpa', 'step_#_sigma_y_mpa', 'step_#_tau_xy_mpa']
  character(*), parameter :: header = 'quantity,place,printed,unit,status,reason'

contains

  !> Reads `text`, one value in each row; the end of the row is the reason. `path` is for messages.
  subroutine read_published(path, text, rows, error)
    character(*), intent(in) :: path, text
    type(published_t), allocatable, intent(out) :: rows(:)
    type(error_t), allocatable, intent(out) :: error
    type(rows_t) :: table
    integer :: i

    call find_rows(text, path, header, table, error)
    if (allocated(error)) return
    allocate (rows(size(table%rows)))
    do i = 1, size(rows)
      call read_row(i, rows(i))
      if (allocated(error)) return
    end do

  contains

    subroutine read_row(row, entry)
      integer, intent(in) :: row
      type(published_t), intent(out) :: entry
      character(:), allocatable :: fields(:), name
      logical :: ok
      integer :: n

      call table%fields(row, 6, fields, ok, open_end=.true.)
      entry%quantity = trim(fields(1))
      entry%place = trim(fields(2))
      entry%unit = trim(fields(4))
      entry%status = trim(fields(5))
      entry%reason = trim(fields(6))
      call table%number(fields(3), entry%printed, ok)
      if (ok) ok = abs(entry%printed) > 0
      if (.not. ok) call table%refuse(row, 'printed = '//shown(trim(fields(3)))//': must be a number other than 0', error)
      call split_quantity(entry%quantity, name, n)
      if (all(quantities /= name)) call table%refuse(row, 'quantity = '//shown(entry%quantity)// &
        ': must be one of '//join(quantities, ', '), error)
      if (all(entry%status /= [character(16) :: 'stated', 'inferred', 'fitted', 'not reproducible'])) &
        call table%refuse(row, 'status = '//shown(entry%status)//': must be stated, inferred, fitted or not reproducible', error)
    end subroutine read_row
  end subroutine read_published

  !> Replaces the number in a quantity's name by #, and returns it; 0 for none.
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
end module gearsweep_study_case_published
