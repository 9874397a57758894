!> How long work takes the calling thread: the shortest of several laps, which other work on the machine hardly changes.
!>
!>     type(stopwatch_t) :: watch
!>     do while (watch%goes_on())
!>       call work()
!>     end do
!>     seconds = watch%shortest
module gearsweep_clock
  use, intrinsic :: iso_c_binding, only: c_double
  use gearsweep_kinds, only: dp
  implicit none
  private
  public :: stopwatch_t

  type :: stopwatch_t
    integer :: fewest = 3                        !< laps
    real(dp) :: shortest = huge(1.0_dp)          !< of the laps, s of processor time
    real(dp), private :: began = 0, total = 0    !< s
    integer, private :: laps = -1                !< none has begun
  contains
    procedure :: goes_on
  end type stopwatch_t

  interface
    real(c_double) function thread_seconds() bind(c, name='gearsweep_thread_seconds')
      import :: c_double
    end function thread_seconds
  end interface

contains

  !> Ends a lap, and tells whether another one begins: of short ones there are more than `fewest`.
  logical function goes_on(self)
    class(stopwatch_t), intent(inout) :: self
    real(dp), parameter :: enough = 1e-3_dp      ! s; the clock tells nanoseconds
    real(dp) :: now

    now = thread_seconds()
    if (self%laps >= 0) then
      self%shortest = min(self%shortest, now - self%began)
      self%total = self%total + (now - self%began)
    end if
    self%laps = self%laps + 1
    goes_on = self%laps < self%fewest .or. (self%total < enough .and. self%laps < 1000)
    self%began = thread_seconds()
  end function goes_on
end module gearsweep_clock
