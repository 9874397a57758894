!> Fatigue under stress that changes: cycles of a history by the rainflow method, mean stress, S-N curve, Miner's sum.
module gearsweep_fatigue
  use gearsweep_kinds, only: dp
  implicit none
  private
  public :: curve_t, cycle_t, strength_t, count_cycles, damage_of, equivalent_amplitude, structural_steel

  integer, parameter, public :: mean_ignored = 0, by_goodman = 1, by_gerber = 2, by_soderberg = 3

  !> An S-N curve: cycles to failure under fully reversed stress. Between its points it is straight over both logarithms;
  !> above the first, the first line goes on.
  type :: curve_t
    real(dp), allocatable :: cycles(:)           !< ascending
    real(dp), allocatable :: stress(:)           !< amplitude, Pa, descending
    logical :: is_endless = .true.               !< amplitudes below the last one do no harm; otherwise the last line goes on
  end type curve_t

  !> A closed cycle of a stress history.
  type :: cycle_t
    real(dp) :: amplitude = 0                    !< half of its range, Pa
    real(dp) :: mean = 0                         !< Pa
  end type cycle_t

  !> How a mean stress counts.
  type :: strength_t
    integer :: rule = mean_ignored
    real(dp) :: limit = 0                        !< tensile strength, for Soderberg's line yield strength, Pa
  end type strength_t

contains

  !> The cycles of a stress history that repeats without end, by the rainflow method: all of them close, as the count begins at
  !> the largest stress. Those of the size of rounding do not count. Source: ASTM E1049-85, 5.4.5.
  pure function count_cycles(stress) result(cycles)
    real(dp), intent(in) :: stress(:)            !< one turn of the history, Pa
    type(cycle_t), allocatable :: cycles(:)
    real(dp), parameter :: rounding = 1e-9_dp    ! of the largest amplitude
    type(cycle_t) :: found(size(stress))
    real(dp) :: turn(size(stress) + 1)
    integer :: first, i, n, m

    n = 0
    m = 0
    first = maxloc(stress, 1)
    do i = 0, size(stress)
      m = m + 1
      turn(m) = stress(1 + modulo(first - 1 + i, size(stress)))
      ! A value between its neighbours is no turn.
      if (m > 2) then
        if ((turn(m) - turn(m - 1))*(turn(m - 1) - turn(m - 2)) >= 0) then
          turn(m - 1) = turn(m)
          m = m - 1
        end if
      end if
      do while (m > 3)
        ! The range in the middle closes where it is not above the ranges on both sides.
        if (abs(turn(m - 1) - turn(m - 2)) > min(abs(turn(m) - turn(m - 1)), abs(turn(m - 2) - turn(m - 3)))) exit
        call add_cycle(turn(m - 2), turn(m - 1), found, n)
        turn(m - 2) = turn(m)
        m = m - 2
      end do
    end do
    if (m == 3) call add_cycle(turn(1), turn(2), found, n)
    cycles = pack(found(:n), found(:n)%amplitude > rounding*maxval(found(:n)%amplitude))
  end function count_cycles

  pure subroutine add_cycle(a, b, cycles, n)
    real(dp), intent(in) :: a, b                 ! its turns, Pa
    type(cycle_t), intent(inout) :: cycles(:)
    integer, intent(inout) :: n

    n = n + 1
    cycles(n) = cycle_t(abs(a - b)/2, (a + b)/2)
  end subroutine add_cycle

  !> The amplitude (Pa) without mean stress that does the same harm. Compression in the mean does not count. Negative: the mean
  !> stress alone is above the limit.
  !> Source: Goodman 1899, Gerber 1874, Soderberg 1930, as in textbooks of machine design.
  elemental real(dp) function equivalent_amplitude(cycle, strength) result(amplitude)
    type(cycle_t), intent(in) :: cycle
    type(strength_t), intent(in) :: strength
    real(dp) :: part

    amplitude = cycle%amplitude
    if (strength%rule == mean_ignored .or. cycle%mean <= 0) return
    part = cycle%mean/strength%limit
    if (strength%rule == by_gerber) part = part**2
    if (part >= 1) then
      amplitude = -1
    else
      amplitude = amplitude/(1 - part)
    end if
  end function equivalent_amplitude

  !> What part of its life one cycle of this equivalent amplitude (Pa) costs: 1 over the cycles to failure (Palmgren 1924,
  !> Miner 1945); at most 1.
  pure real(dp) function damage_of(curve, amplitude) result(damage)
    type(curve_t), intent(in) :: curve
    real(dp), intent(in) :: amplitude
    real(dp) :: slope
    integer :: i, n

    n = size(curve%stress)
    damage = 0
    if (amplitude <= 0 .or. (curve%is_endless .and. amplitude < curve%stress(n))) return
    i = max(1, min(n - 1, count(curve%stress > amplitude)))
    slope = log(curve%cycles(i + 1)/curve%cycles(i))/log(curve%stress(i + 1)/curve%stress(i))
    damage = exp(min(0.0_dp, -log(curve%cycles(i)) - slope*log(amplitude/curve%stress(i))))
  end function damage_of

  !> The S-N curve that finite-element programs have for structural steel: design curve of carbon steels with mean stress zero.
  !> Source: ASME Boiler and Pressure Vessel Code, Section VIII, Division 2 (1998), table 5-110.1.
  pure function structural_steel() result(curve)
    type(curve_t) :: curve

    curve%cycles = [10, 20, 50, 100, 200, 2000, 10000, 20000, 100000, 200000, 1000000]
    curve%stress = 1e5_dp*[39990, 28270, 18960, 14130, 10690, 4410, 2620, 2140, 1380, 1140, 862]
  end function structural_steel
end module gearsweep_fatigue
