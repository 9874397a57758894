!> Smooth intervals of a mesh over its period, and the profile error of a prescribed mesh from a table.
!>
!> If teeth have errors of their own, the period is that of all mesh periods after which the errors repeat. A table of profile
!> errors may extend beyond A and E.
module gearsweep_mesh_smooth_intervals
  use gearsweep_base, only: code_input, dp, error_t, fail, piecewise_t, spline, str
  use gearsweep_mesh_deviations, only: distinct_phases, interval_t, phase_of
  use gearsweep_mesh_mesh, only: mesh_t
  implicit none
  private
  public :: smooth_intervals, intervals_of_period, repeat_intervals, set_period, profile_table

  character(*), parameter :: table = 'profile error table: '

contains

  !> Intervals of all mesh periods after which the deviations repeat.
  pure function smooth_intervals(mesh, friction) result(intervals)
    type(mesh_t), intent(in) :: mesh
    logical, intent(in) :: friction
    type(interval_t), allocatable :: intervals(:)

    intervals = repeat_intervals(mesh, intervals_of_period(mesh, friction))
  end function smooth_intervals

  !> Splits a mesh period where a pair enters or leaves, where a relief begins, with friction at the pitch point and, if contact
  !> extends beyond A and E, where the stiffness has a kink, as it may at A and E.
  pure function intervals_of_period(mesh, friction) result(intervals)
    type(mesh_t), intent(in) :: mesh
    logical, intent(in) :: friction
    type(interval_t), allocatable :: intervals(:)
    real(dp), allocatable :: breaks(:)
    logical, allocatable :: profile_breaks(:), stiffness_breaks(:)
    integer :: i

    profile_breaks = breaks_of(mesh%profile_error)
    allocate (stiffness_breaks(size(mesh%stiffness%breaks)), source=.false.)
    if (mesh%reaches_beyond()) stiffness_breaks = breaks_of(mesh%stiffness)
    breaks = [0.0_dp, 1.0_dp, phase_of(mesh%contact_ratio), phase_of(mesh%reach), &
              phase_of(pack(mesh%profile_error%breaks, profile_breaks)), phase_of(pack(mesh%stiffness%breaks, stiffness_breaks))]
    if (friction .and. mesh%pitch_point > 0 .and. mesh%pitch_point < mesh%contact_ratio) then
      breaks = [breaks, phase_of(mesh%pitch_point)]
    end if
    breaks = distinct_phases(breaks, 0.0_dp, 1.0_dp)

    allocate (intervals(size(breaks) - 1))
    do i = 1, size(intervals)
      intervals(i)%first = breaks(i)
      intervals(i)%last = breaks(i + 1)
      call list_pairs(mesh, (breaks(i) + breaks(i + 1))/2, profile_breaks, stiffness_breaks, intervals(i))
    end do
    call set_period(mesh, 0, intervals)
  end function intervals_of_period

  !> Intervals of all mesh periods after which the deviations repeat, with the deviations of their pairs.
  pure function repeat_intervals(mesh, intervals) result(all_intervals)
    type(mesh_t), intent(in) :: mesh
    type(interval_t), intent(in) :: intervals(:)           !< intervals of one mesh period
    type(interval_t), allocatable :: all_intervals(:)
    integer :: k, n

    n = size(intervals)
    allocate (all_intervals(n*mesh%deviations%periods))
    do k = 0, mesh%deviations%periods - 1
      all_intervals(k*n + 1:(k + 1)*n) = intervals
      call set_period(mesh, k, all_intervals(k*n + 1:(k + 1)*n))
    end do
  end function repeat_intervals

  !> Fills in the deviations of the pairs in one of the mesh periods after which they repeat.
  pure subroutine set_period(mesh, period, intervals)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: period                !< index from 0
    type(interval_t), intent(inout) :: intervals(:)        !< intervals of one mesh period
    real(dp), allocatable :: c(:)
    integer :: i, j

    if (.not. mesh%deviations%any()) return
    do i = 1, size(intervals)
      associate (interval => intervals(i))
        interval%period = period
        interval%coast = [(mesh%deviations%coast_of_pair(period - (j + interval%offset - 1)), j=1, interval%pairs)]
        do j = 1, interval%pairs
          c = mesh%deviations%of_pair(period - (j + interval%offset - 1), mesh%contact_ratio, &
                                      interval%place((interval%first + interval%last)/2, j))
          if (.not. allocated(interval%deviation)) allocate (interval%deviation(0:size(c) - 1, interval%pairs))
          interval%deviation(:, j) = c
        end do
      end associate
    end do
  end subroutine set_period

  !> Lists the pairs that may be in contact at the middle of an interval, and so in all of it.
  pure subroutine list_pairs(mesh, middle, profile_breaks, stiffness_breaks, interval)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: middle               !< phase
    logical, intent(in) :: profile_breaks(:), stiffness_breaks(:)  !< results of `breaks_of`
    type(interval_t), intent(inout) :: interval
    integer :: j

    interval%offset = floor(mesh%reach(1) - middle) + 1
    interval%pairs = ceiling(mesh%reach(2) - middle) - interval%offset
    allocate (interval%piece(2, interval%pairs), interval%stiffness_piece(2, interval%pairs))
    associate (s => interval%place(middle, [(j, j=1, interval%pairs)]))
      do j = 1, interval%pairs
        interval%piece(:, j) = smooth_pieces(mesh%profile_error, profile_breaks, s(j))
        interval%stiffness_piece(:, j) = [1, size(mesh%stiffness%breaks) - 1]
        if (mesh%reaches_beyond()) interval%stiffness_piece(:, j) = smooth_pieces(mesh%stiffness, stiffness_breaks, s(j))
      end do
      interval%recess = s > mesh%pitch_point
      interval%between = s > 0 .and. s < mesh%contact_ratio
    end associate
    allocate (interval%carries(interval%pairs), source=.true.)
    allocate (interval%shared(0:2, max(1, interval%pairs - 1)))
    do j = 1, size(interval%shared, 2)
      ! Taylor series from phase 0.
      interval%shared(:, j) = mesh%shared_from(interval%place(0.0_dp, j), interval%place(middle, j))/[1, 1, 2]
    end do
  end subroutine list_pairs

  !> True where a curve is not smooth from one of its pieces to the next; (break). Its ends count as smooth.
  pure function breaks_of(curve) result(breaks)
    type(piecewise_t), intent(in) :: curve
    logical :: breaks(size(curve%breaks))
    integer :: i

    breaks = .false.
    do i = 2, size(breaks) - 1
      breaks(i) = .not. curve%is_smooth_at(i)
    end do
  end function breaks_of

  !> First and last piece of the part of a curve around s within which it is smooth.
  pure function smooth_pieces(curve, breaks, s) result(piece)
    type(piecewise_t), intent(in) :: curve
    logical, intent(in) :: breaks(:)             !< result of `breaks_of`
    real(dp), intent(in) :: s
    integer :: piece(2)

    piece = curve%locate(s)
    do while (piece(1) > 1)
      if (breaks(piece(1))) exit
      piece(1) = piece(1) - 1
    end do
    do while (piece(2) < size(curve%breaks) - 1)
      if (breaks(piece(2) + 1)) exit
      piece(2) = piece(2) + 1
    end do
  end function smooth_pieces

  !> Builds cubic splines through a table: `s` in base pitches, ascending, from 0 or below to the contact ratio or above; `values`
  !> in m. Where s appears twice one spline ends and the next begins, so that the curve may have a kink or a jump.
  pure subroutine profile_table(contact_ratio, s, values, curve, error)
    real(dp), intent(in) :: contact_ratio, s(:), values(:)
    type(piecewise_t), intent(out) :: curve
    type(error_t), allocatable, intent(out) :: error
    type(piecewise_t) :: part
    real(dp), allocatable :: coef(:, :)
    integer :: first, last, pieces

    call check_rows(contact_ratio, s, values, error)
    if (allocated(error)) return
    allocate (curve%breaks(size(s)), curve%coef(0:3, size(s)))
    curve%breaks(1) = s(1)
    pieces = 0
    first = 1
    do while (first < size(s))
      last = first + 1
      do while (last < size(s))
        if (.not. s(last + 1) > s(last)) exit
        last = last + 1
      end do
      part = spline(s(first:last), values(first:last))
      associate (more => last - first)
        curve%breaks(pieces + 2:pieces + 1 + more) = part%breaks(2:)
        curve%coef(:, pieces + 1:pieces + more) = part%coef
        pieces = pieces + more
      end associate
      first = last + 1
    end do
    curve%breaks = curve%breaks(:pieces + 1)
    allocate (coef(0:3, pieces), source=curve%coef(:, :pieces))
    call move_alloc(coef, curve%coef)
  end subroutine profile_table

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
end module gearsweep_mesh_smooth_intervals
