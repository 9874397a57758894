!> What a designer reads off a steady motion beside its dynamic factor: transmission error and load of the mesh with their
!> harmonics, the mean square load on a pair, and how often flanks meet.
module gearsweep_motion_summary
  use gearsweep_contact_set, only: in_contact
  use gearsweep_kinds, only: dp
  use gearsweep_oscillator, only: oscillator_t
  use gearsweep_quintic, only: quintic
  use gearsweep_spectrum, only: find_spectrum, spectrum_t
  use gearsweep_trace, only: trace_t
  implicit none
  private
  public :: motion_summary_t, summarise, gather_steps

  type :: motion_summary_t
    type(spectrum_t) :: error                    !< dynamic transmission error, m
    type(spectrum_t) :: load                     !< elastic load of the mesh: all pairs less the coast sides, N
    real(dp) :: pair_rms = 0                     !< root mean square of the load on a pair over its path, N
    real(dp) :: impacts = 0                      !< that flanks meet after all had been apart, a mesh period
    real(dp) :: reversals = 0                    !< that the load goes over to the other sides of the teeth, a mesh period
    real(dp) :: apart = 0                        !< part of the time during which all flanks are apart
  end type motion_summary_t

contains

  !> The summary of a motion, whose harmonics are those of the time after which it repeats: of the mesh frequency over the
  !> number of mesh periods.
  pure subroutine summarise(osc, trace, count, summary)
    type(oscillator_t), intent(in) :: osc
    type(trace_t), intent(in) :: trace(:)        !< the mesh periods after which the motion repeats
    integer, intent(in) :: count                 !< harmonics
    type(motion_summary_t), intent(out) :: summary
    real(dp), allocatable :: left(:), width(:), error(:, :), load(:, :)

    call gather_steps(trace, 1, left, width, error)
    left = left/size(trace)
    width = width/size(trace)
    load = mesh_load(osc, trace)
    call find_spectrum(left, width, error, count, summary%error)
    call find_spectrum(left, width, load, count, summary%load)
    summary%pair_rms = mean_square_load(osc, trace)
    call count_meetings(osc, trace, summary)
  end subroutine summarise

  !> The steps of a motion.
  pure subroutine gather_steps(trace, periods, left, width, error)
    type(trace_t), intent(in) :: trace(:)
    integer, intent(in) :: periods               !< mesh periods of each trace
    real(dp), allocatable, intent(out) :: left(:), width(:)          !< begin and length, mesh periods; (step)
    !> Quintic of the dynamic transmission error over 0 to 1 in the step, m; (0:5, step)
    real(dp), allocatable, intent(out) :: error(:, :)
    integer :: i, k, n

    n = sum(trace%rows)/2
    allocate (left(n), width(n), error(0:5, n))
    n = 0
    do i = 1, size(trace)
      do k = 1, trace(i)%rows, 2
        n = n + 1
        left(n) = (i - 1)*periods + trace(i)%phase(k)
        width(n) = trace(i)%phase(k + 1) - trace(i)%phase(k)
        error(:, n) = quintic(trace(i)%x(:, k), trace(i)%x(:, k + 1))
      end do
    end do
  end subroutine gather_steps

  !> The elastic load of the mesh as a quintic in each of these steps, N; (0:5, step).
  pure function mesh_load(osc, trace) result(load)
    type(oscillator_t), intent(in) :: osc
    type(trace_t), intent(in) :: trace(:)
    real(dp) :: load(0:5, sum(trace%rows)/2)
    real(dp) :: total(0:2, 2)
    integer :: i, k, n

    n = 0
    do i = 1, size(trace)
      do k = 1, trace(i)%rows, 2
        n = n + 1
        total = sum(trace(i)%load(:, :osc%pairs, [k, k + 1]), 2)
        if (osc%has_backlash) total = total - trace(i)%load(:, osc%contacts, [k, k + 1])
        load(:, n) = quintic(total(:, 1), total(:, 2))
      end do
    end do
  end function mesh_load

  !> Root mean square of the load on a pair over the path on which it may be in contact.
  pure real(dp) function mean_square_load(osc, trace) result(rms)
    type(oscillator_t), intent(in) :: osc
    type(trace_t), intent(in) :: trace(:)
    type(spectrum_t) :: part
    real(dp) :: path
    integer :: i, j, k

    rms = 0
    path = 0
    do i = 1, size(trace)
      do k = 1, trace(i)%rows, 2
        associate (width => trace(i)%phase(k + 1) - trace(i)%phase(k), ends => trace(i)%load(:, :, k:k + 1))
          do j = 1, min(trace(i)%pairs(k), osc%pairs)
            call find_spectrum([0.0_dp], [1.0_dp], reshape(quintic(ends(:, j, 1), ends(:, j, 2)), [6, 1]), 0, part)
            rms = rms + width*(part%mean**2 + part%rms**2)
            path = path + width
          end do
        end associate
      end do
    end do
    rms = sqrt(rms/path)
  end function mean_square_load

  !> How often flanks meet and the load changes sides, and how long all are apart.
  pure subroutine count_meetings(osc, trace, summary)
    type(oscillator_t), intent(in) :: osc
    type(trace_t), intent(in) :: trace(:)
    type(motion_summary_t), intent(inout) :: summary
    integer, parameter :: nowhere = 0, drive = 1, coast = 2
    integer :: side, last, last_loaded, i, k, pass

    last = nowhere
    last_loaded = nowhere
    ! A first time to know how it ends, as the end goes before the begin.
    do pass = 1, 2
      summary%impacts = 0
      summary%reversals = 0
      summary%apart = 0
      do i = 1, size(trace)
        do k = 1, trace(i)%rows
          side = merge(nowhere, drive, trace(i)%contact_set(k) == 0)
          if (osc%has_backlash .and. side == drive) then
            if (in_contact(trace(i)%contact_set(k), osc%contacts)) side = coast
          end if
          if (side == nowhere) then
            if (modulo(k, 2) == 1) summary%apart = summary%apart + (trace(i)%phase(k + 1) - trace(i)%phase(k))
          else
            if (last == nowhere) summary%impacts = summary%impacts + 1
            if (last_loaded /= nowhere .and. side /= last_loaded) summary%reversals = summary%reversals + 1
            last_loaded = side
          end if
          last = side
        end do
      end do
    end do
    summary%impacts = summary%impacts/size(trace)
    summary%reversals = summary%reversals/size(trace)
    summary%apart = summary%apart/size(trace)
  end subroutine count_meetings
end module gearsweep_motion_summary
