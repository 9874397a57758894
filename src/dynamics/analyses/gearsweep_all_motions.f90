!> How many motions attract at each point of a sweep, the largest dynamic factor of all of them, and the share of the starts
!> that lead to the one that the sweep tells.
module gearsweep_all_motions
  use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
  use gearsweep_attractor_search, only: attractor_options_t
  use gearsweep_attractors, only: attractors_t, find_attractors
  use gearsweep_error, only: code_memory, error_t, fail
  use gearsweep_kinds, only: dp
  use gearsweep_memory, only: claim_memory
  use gearsweep_oscillator, only: oscillator_t
  use gearsweep_status, only: has_result, status_ok, status_stopped
  use gearsweep_text, only: str
  implicit none
  private
  public :: all_motions_t, count_motions, largest_reached

  !> NaN where nothing was looked for, or the speed is too low to be searched; (speed, relief).
  type :: all_motions_t
    real(dp), allocatable :: motions(:, :)       !< how many attract
    real(dp), allocatable :: largest(:, :)       !< dynamic factor of those that a start reaches or a sweep of single speeds shows
    real(dp), allocatable :: share(:, :)         !< of the starts, to the motion of a sweep of single speeds; 0: to none
    logical :: stopped = .false.                 !< the caller ended it
  end type all_motions_t

  !> Speeds that are held at a time.
  integer, parameter :: portion = 256

contains

  !> Searches at all speeds and with all reliefs; or, where it is not wanted, tells nothing of them.
  subroutine count_motions(osc, rpm, options, wanted, found, error)
    type(oscillator_t), intent(in) :: osc(:)     !< one for each relief
    real(dp), intent(in) :: rpm(:)               !< speeds of the pinion, 1/min
    type(attractor_options_t), intent(in) :: options
    logical, intent(in) :: wanted
    type(all_motions_t), intent(out) :: found
    type(error_t), allocatable, intent(inout) :: error
    type(attractors_t), allocatable :: some(:)
    integer :: i, first, last

    allocate (found%motions(size(rpm), size(osc)), source=ieee_value(1.0_dp, ieee_quiet_nan))
    found%largest = found%motions
    found%share = found%motions
    if (.not. wanted) return
    call claim_memory(portion*(1e4_dp + 40.0_dp*options%starts**2), 'all motions at '//str(portion)//' speeds', error)
    do i = 1, size(osc)
      do first = 1, size(rpm), portion
        if (allocated(error) .or. found%stopped) return
        last = min(first + portion - 1, size(rpm))
        allocate (some(last - first + 1))
        call find_attractors(osc(i), rpm(first:last), options, some)
        if (any(some%lacks)) call fail(error, code_memory, 'sweep: the memory does not hold all motions at a speed')
        found%stopped = any(some%status == status_stopped)
        if (.not. found%stopped) call summarise(some, found%motions(first:last, i), found%largest(first:last, i), &
                                                found%share(first:last, i))
        deallocate (some)
      end do
    end do
  end subroutine count_motions

  elemental subroutine summarise(found, motions, largest, share)
    type(attractors_t), intent(in) :: found
    real(dp), intent(inout) :: motions, largest, share

    if (found%status /= status_ok) return
    motions = size(found%motion)
    largest = largest_reached(found)
    share = 0
    if (found%alone_is > 0) share = found%motion(found%alone_is)%starts/real(size(found%to), dp)
  end subroutine summarise

  !> The largest dynamic factor of the motions that a start reaches, or a sweep of single speeds shows; NaN where there is none.
  pure real(dp) function largest_reached(found) result(largest)
    type(attractors_t), intent(in) :: found
    logical :: counts(size(found%motion))

    largest = ieee_value(1.0_dp, ieee_quiet_nan)
    counts = found%motion%starts > 0
    if (found%alone_is > 0) counts(found%alone_is) = .true.
    counts = counts .and. has_result(found%motion%point%steady%status)
    if (any(counts)) largest = maxval(found%motion%point%dynamic_factor, mask=counts)
  end function largest_reached
end module gearsweep_all_motions
