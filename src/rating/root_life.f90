!> Fatigue life of the tooth root under the loads of a pair over its path of contact.
!>
!> Cycles of the stress history by the rainflow method, mean stress, S-N curve, Miner's sum.
module gearsweep_rating_root_life
  use gearsweep_base, only: dp, no_number
  use gearsweep_gear, only: pair_t
  use gearsweep_rating_flank, only: rim_factor
  use gearsweep_rating_form, only: iso_form, nominal_root_stress
  implicit none
  private
  public :: curve_t, cycle_t, strength_t, count_cycles, damage_of, equivalent_amplitude, root_life_t, root_life, root_history

  integer, parameter, public :: mean_ignored = 0, by_goodman = 1, by_gerber = 2, by_soderberg = 3, by_iso = 4

  !> S-N curve: cycles to failure under fully reversed stress or, for a material by ISO 6336-3, under stress from zero. It is
  !> straight over both logarithms between its points; before the first point the first line is extended.
  type :: curve_t
    real(dp), allocatable :: cycles(:)           !< cycles to failure, ascending
    real(dp), allocatable :: stress(:)           !< stress amplitude, Pa, descending
    logical :: is_endless = .true.  !< true: amplitudes below the last one cause no damage; false: the last line is extended
  end type curve_t

  !> A closed cycle of a stress history.
  type :: cycle_t
    real(dp) :: amplitude = 0                    !< half of the range, Pa
    real(dp) :: mean = 0                         !< mean stress, Pa
  end type cycle_t

  !> Rule for the mean stress.
  type :: strength_t
    integer :: rule = mean_ignored
    !> Tensile strength, yield strength for Soderberg's line, or by ISO 6336-3 the largest equivalent amplitude, Pa.
    real(dp) :: limit = 0
  end type strength_t

  !> Damage of one engagement.
  type :: root_life_t
    real(dp) :: largest = 0                      !< largest root stress, Pa
    type(cycle_t) :: worst                       !< cycle of largest damage
    real(dp) :: equivalent = 0                   !< its equivalent amplitude without mean stress, Pa
    real(dp) :: cycles = 0                       !< number of cycles of an engagement
    real(dp) :: damage = 0                       !< Miner's sum of an engagement; NaN where the strength is exceeded
    logical :: is_over = .false.                 !< true if some cycle exceeds the strength
  end type root_life_t

contains

  !> Counts the cycles of a periodic stress history by the rainflow method: all cycles close, as the count begins at the largest
  !> stress. Cycles of the size of rounding are omitted. Source: ASTM E1049-85, 5.4.5.
  pure function count_cycles(stress) result(cycles)
    real(dp), intent(in) :: stress(:)            !< one period of the history, Pa
    type(cycle_t), allocatable :: cycles(:)
    real(dp), parameter :: rounding = 1e-9_dp    ! relative to the largest amplitude
    type(cycle_t) :: found(size(stress))
    real(dp) :: turn(size(stress) + 1)
    integer :: first, i, n, m

    n = 0
    m = 0
    first = maxloc(stress, 1)
    do i = 0, size(stress)
      m = m + 1
      turn(m) = stress(1 + modulo(first - 1 + i, size(stress)))
      ! A value between its neighbours is no reversal.
      if (m > 2) then
        if ((turn(m) - turn(m - 1))*(turn(m - 1) - turn(m - 2)) >= 0) then
          turn(m - 1) = turn(m)
          m = m - 1
        end if
      end if
      do while (m > 3)
        ! The middle range closes if it does not exceed the ranges on both sides.
        if (abs(turn(m - 1) - turn(m - 2)) > min(abs(turn(m) - turn(m - 1)), abs(turn(m - 2) - turn(m - 3)))) exit
        n = n + 1
        found(n) = cycle_t(abs(turn(m - 2) - turn(m - 1))/2, (turn(m - 2) + turn(m - 1))/2)
        turn(m - 2) = turn(m)
        m = m - 2
      end do
    end do
    if (m == 3) then
      n = n + 1
      found(n) = cycle_t(abs(turn(1) - turn(2))/2, (turn(1) + turn(2))/2)
    end if
    cycles = pack(found(:n), found(:n)%amplitude > rounding*maxval(found(:n)%amplitude))
  end function count_cycles

  !> Amplitude (Pa) of the same damage without mean stress or, by ISO 6336-3, with a stress from zero. The other rules neglect
  !> compressive mean stress. Negative: the mean stress alone, or by ISO 6336-3 the equivalent amplitude, exceeds the limit.
  !> Source: Goodman 1899, Gerber 1874, Soderberg 1930, as in textbooks of machine design. ISO 6336-3:2006, Annex B: a largest
  !> stress sigma with the stress ratio R counts as sigma/Y_M, Y_M = 1/(1 - R (1 - M)/(1 + M)), which is twice (amplitude + M
  !> mean)/(1 + M); with M = 0.4 an idler, R = -1, has the Y_M = 0.7 of the standard's clause 5.
  elemental real(dp) function equivalent_amplitude(cycle, strength) result(amplitude)
    type(cycle_t), intent(in) :: cycle
    type(strength_t), intent(in) :: strength
    real(dp), parameter :: sensitivity = 0.4_dp
    real(dp) :: part

    if (strength%rule == by_iso) then
      amplitude = (cycle%amplitude + sensitivity*cycle%mean)/(1 + sensitivity)
      if (amplitude > strength%limit) amplitude = -1
      return
    end if
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

  !> Damage of one cycle of this equivalent amplitude (Pa): 1 over the cycles to failure (Palmgren 1924, Miner 1945); at most 1.
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

  !> Damage of one engagement from its stress. A motion that repeats after several mesh periods has as many different engagements; a
  !> tooth meets each of them equally often.
  pure type(root_life_t) function root_life(which, stress, stress_ratio, strength, curve) result(life)
    integer, intent(in) :: which(:)              !< index of the engagement, from 1, ascending; (row)
    real(dp), intent(in) :: stress(:)            !< tooth root stress, Pa; (row)
    real(dp), intent(in) :: stress_ratio         !< least stress of a revolution over its largest
    type(strength_t), intent(in) :: strength
    type(curve_t), intent(in) :: curve
    type(cycle_t), allocatable :: cycles(:)
    real(dp) :: amplitude, harm, most
    integer :: i, k, engagements

    engagements = maxval(which)
    most = -1
    life%largest = max(life%largest, maxval(stress))
    do i = 1, engagements
      associate (history => pack(stress, which == i))
        cycles = count_cycles([history, 0.0_dp, stress_ratio*maxval(history), 0.0_dp])
      end associate
      life%cycles = life%cycles + size(cycles)/real(engagements, dp)
      do k = 1, size(cycles)
        amplitude = equivalent_amplitude(cycles(k), strength)
        life%is_over = life%is_over .or. amplitude < 0
        harm = damage_of(curve, amplitude)
        life%damage = life%damage + harm/engagements
        if (amplitude < 0) harm = 2
        if (harm < most .or. (harm <= most .and. cycles(k)%amplitude <= life%worst%amplitude)) cycle
        most = harm
        life%worst = cycles(k)
        life%equivalent = amplitude
      end do
    end do
    if (.not. life%is_over) return
    life%damage = no_number()
    if (life%equivalent < 0) life%equivalent = no_number()
  end function root_life

  !> Tooth root stress (Pa) by ISO 6336-3, with form factors for the position of the load; beyond the path of contact that of its
  !> end.
  pure function root_history(pair, which, s, load, rim) result(stress)
    type(pair_t), intent(in) :: pair
    integer, intent(in) :: which
    real(dp), intent(in) :: s(:), load(:), rim
    real(dp) :: stress(size(s))
    real(dp) :: radius
    integer :: i

    associate (gear => pair%gear(which))
      do i = 1, size(s)
        radius = min(gear%tip_radius, pair%radius(which, max(0.0_dp, min(pair%contact_ratio, s(i)))))
        stress(i) = nominal_root_stress(pair, which, iso_form(gear, radius), load(i)) &
                    *rim_factor(rim, gear%tip_radius - gear%root_radius)
      end do
    end associate
  end function root_history
end module gearsweep_rating_root_life
