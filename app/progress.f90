!> One line of a terminal that tells how far a run is: points, per cent, time left.
module gearsweep_progress
  use, intrinsic :: iso_fortran_env, only: error_unit, int64
  use gearsweep_base, only: dp, fixed, str
  implicit none
  private
  public :: show_progress

  integer(int64) :: told = 0, first_told = 0     ! ticks of the clock
  integer :: first_done = -1                     ! points that were done when the first were told

contains

  !> At most ten times a second; the time left once it can be told.
  subroutine show_progress(done, total)
    integer, intent(in) :: done, total
    integer(int64) :: now, rate
    character(60) :: line
    real(dp) :: seconds

    call system_clock(now, rate)
    if (first_done < 0) then
      first_done = done
      first_told = now
    end if
    if (done < total .and. 10*(now - told) < rate) return
    told = now
    seconds = real(now - first_told, dp)/rate
    line = str(done)//' of '//str(total)//' points, '//str(int(100.0_dp*done/total))//' %'
    if (seconds > 1 .and. done > first_done) then
      line = trim(line)//', '//trim(duration(seconds*(total - done)/(done - first_done)))//' left'
    end if
    write (error_unit, '(a)', advance='no') achar(13)//line
    flush (error_unit)
  end subroutine show_progress

  !> As 45 s, 12 min, 3.5 h.
  pure function duration(seconds) result(words)
    real(dp), intent(in) :: seconds
    character(24) :: words

    if (seconds < 100) then
      words = str(nint(seconds))//' s'
    else if (seconds < 6000) then
      words = str(nint(seconds/60))//' min'
    else
      words = fixed(seconds/3600, 1)//' h'
    end if
  end function duration
end module gearsweep_progress
