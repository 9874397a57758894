!> The smooth intervals of a mesh over the mesh period or, where teeth have errors of their own, over all mesh periods after which
!> these repeat.
module gearsweep_smooth_intervals
  use gearsweep_interval, only: distinct_phases, interval_t, phase_of
  use gearsweep_kinds, only: dp
  use gearsweep_mesh, only: mesh_t
  use gearsweep_piecewise, only: piecewise_t
  implicit none
  private
  public :: smooth_intervals

contains

  !> Splits the period where a pair enters or leaves, where a relief begins, with friction at the pitch point and, where
  !> contact reaches beyond A and E, where the stiffness has a kink, as it may at A and E.
  pure function smooth_intervals(mesh, friction) result(intervals)
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
    breaks = distinct_phases(breaks)

    allocate (intervals(size(breaks) - 1))
    do i = 1, size(intervals)
      intervals(i)%first = breaks(i)
      intervals(i)%last = breaks(i + 1)
      call list_pairs(mesh, (breaks(i) + breaks(i + 1))/2, profile_breaks, stiffness_breaks, intervals(i))
    end do
    if (mesh%deviations%any()) intervals = over_turn(mesh, intervals)
  end function smooth_intervals

  !> The intervals of all mesh periods after which the deviations repeat.
  pure function over_turn(mesh, intervals) result(all_intervals)
    type(mesh_t), intent(in) :: mesh
    type(interval_t), intent(in) :: intervals(:)           !< of one
    type(interval_t), allocatable :: all_intervals(:)
    real(dp), allocatable :: c(:)
    integer :: i, j, k

    allocate (all_intervals(size(intervals)*mesh%deviations%periods))
    do k = 1, size(all_intervals)
      i = 1 + modulo(k - 1, size(intervals))
      associate (interval => all_intervals(k))
        interval = intervals(i)
        interval%period = (k - 1)/size(intervals)
        do j = 1, interval%pairs
          c = mesh%deviations%of_pair(interval%period - (j + interval%offset - 1), mesh%contact_ratio, &
                                      interval%place((interval%first + interval%last)/2, j))
          if (j == 1) allocate (interval%deviation(0:size(c) - 1, interval%pairs))
          interval%deviation(:, j) = c
        end do
      end associate
    end do
  end function over_turn

  !> The pairs that may be in contact at the middle of an interval, and so in all of it.
  pure subroutine list_pairs(mesh, middle, profile_breaks, stiffness_breaks, interval)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: middle               !< phase
    logical, intent(in) :: profile_breaks(:), stiffness_breaks(:)  !< of `breaks_of`
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
      ! Taylor's series from the phase 0.
      interval%shared(:, j) = mesh%shared_from(interval%place(0.0_dp, j), interval%place(middle, j))/[1, 1, 2]
    end do
  end subroutine list_pairs

  !> Where a curve is not smooth from one of its pieces to the next; (break). Its ends count as smooth.
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
    logical, intent(in) :: breaks(:)             !< of `breaks_of`
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
end module gearsweep_smooth_intervals
