!> The profile error of a prescribed mesh from a table, which may reach beyond A and E.
module gearsweep_profile_table
  use gearsweep_error, only: code_input, error_t, fail
  use gearsweep_kinds, only: dp
  use gearsweep_piecewise, only: piecewise_t, spline
  use gearsweep_text, only: str
  implicit none
  private
  public :: profile_table

  character(*), parameter :: table = 'profile error table: '

contains

  !> Cubic splines through a table: `s` in base pitches, ascending, from 0 or below to the contact ratio or above;
  !> `values` in m. Where s comes twice one spline ends and the next begins, so that the curve may have a kink or a jump.
  pure subroutine profile_table(contact_ratio, s, values, curve, error)
    real(dp), intent(in) :: contact_ratio, s(:), values(:)
    type(piecewise_t), intent(out) :: curve
    type(error_t), allocatable, intent(out) :: error
    type(piecewise_t) :: part
    integer :: first, last

    call check_rows(contact_ratio, s, values, error)
    if (allocated(error)) return
    allocate (curve%coef(0:3, 0))
    curve%breaks = [s(1)]
    first = 1
    do while (first < size(s))
      last = first + 1
      do while (last < size(s))
        if (.not. s(last + 1) > s(last)) exit
        last = last + 1
      end do
      part = spline(s(first:last), values(first:last))
      curve%breaks = [curve%breaks, part%breaks(2:)]
      curve%coef = from_zero(reshape([curve%coef, part%coef], [4, size(curve%coef, 2) + size(part%coef, 2)]))
      first = last + 1
    end do
  end subroutine profile_table

  !> The same coefficients, whose powers count from 0.
  pure function from_zero(coef) result(same)
    real(dp), intent(in) :: coef(:, :)
    real(dp) :: same(0:size(coef, 1) - 1, size(coef, 2))

    same = coef
  end function from_zero

  pure subroutine check_rows(contact_ratio, s, values, error)
    real(dp), intent(in) :: contact_ratio, s(:), values(:)
    type(error_t), allocatable, intent(out) :: error
    real(dp), parameter :: slack = 1e-6_dp, far = 1e6_dp, closest = 1e-9_dp, largest = 1e-3_dp
    integer :: n, row

    n = size(s)
    if (n < 2) then
      call fail(error, code_input, table//'needs at least two rows of s and profile error')
      return
    end if
    do row = 1, n
      if (.not. abs(s(row)) <= far) then
        call fail(error, code_input, table//'s = '//str(s(row))//' at row '//str(row)//': must be from '//str(-far)//' to '// &
                  str(far))
      else if (.not. abs(values(row)) <= largest) then
        call fail(error, code_input, table//'the profile error must be from '//str(-1e6_dp*largest)//' to '//str(1e6_dp*largest)// &
                  ' um; at row '//str(row)//' it is beyond')
      end if
      if (allocated(error)) return
    end do
    do row = 2, n
      associate (step => s(row) - s(row - 1))
        if (step < 0) then
          call fail(error, code_input, table//'s is not ascending at row '//str(row))
        else if (step > 0 .and. step < closest) then
          call fail(error, code_input, table//'s is closer than '//str(closest)//' to the row before at row '//str(row))
        end if
      end associate
      if (allocated(error)) return
    end do
    row = findloc(s(2:n) > s(:n - 1), .false., 1)
    if (s(1) > slack .or. s(n) < contact_ratio - slack) then
      call fail(error, code_input, table//'covers s = '//str(s(1))//' to '//str(s(n))// &
                ' base pitches; the path of contact is 0 to '//str(contact_ratio))
    else if (.not. (s(2) > s(1) .and. s(n) > s(n - 1)) .or. any(.not. s(3:) > s(:n - 2))) then
      call fail(error, code_input, table//'s comes twice at row '//str(row + 1)//': it may where a spline ends and the next '// &
                'begins, each of two rows or more')
    end if
  end subroutine check_rows
end module gearsweep_profile_table
