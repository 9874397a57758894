!> Fatigue of one gear's tooth root under the loads of a pair over its path of contact.
module gearsweep_root_life
  use gearsweep_fatigue, only: curve_t, cycle_t, count_cycles, damage_of, equivalent_amplitude, strength_t
  use gearsweep_form, only: iso_form, nominal_root_stress
  use gearsweep_kinds, only: dp
  use gearsweep_load_factors, only: rim_factor
  use gearsweep_pair, only: pair_t
  use gearsweep_table, only: no_number
  implicit none
  private
  public :: root_life_t, root_life, root_history

  !> What one engagement does.
  type :: root_life_t
    real(dp) :: largest = 0                      !< root stress, Pa
    type(cycle_t) :: worst                       !< the cycle that does most harm
    real(dp) :: equivalent = 0                   !< its amplitude without mean stress, Pa
    real(dp) :: cycles = 0                       !< of an engagement
    real(dp) :: damage = 0                       !< Miner's sum of an engagement; NaN where the strength is exceeded
    logical :: is_over = .false.                 !< the mean stress of some cycle alone is above the strength
  end type root_life_t

contains

  !> From loads over the path to the damage of one engagement. A motion that repeats after several mesh periods has as many
  !> different engagements; a tooth meets each of them equally often.
  pure type(root_life_t) function root_life(pair, member, which, s, load, rim, stress_ratio, strength, curve) result(life)
    type(pair_t), intent(in) :: pair
    integer, intent(in) :: member                !< 1 pinion, 2 gear
    integer, intent(in) :: which(:)              !< of the different pairs, from 1, ascending; (row)
    real(dp), intent(in) :: s(:)                 !< path coordinate of the pair, base pitches; (row)
    real(dp), intent(in) :: load(:)              !< of the pair, N; (row)
    real(dp), intent(in) :: rim                  !< thickness of the rim, m; 0: a solid disc
    real(dp), intent(in) :: stress_ratio         !< least stress of a revolution over its largest
    type(strength_t), intent(in) :: strength
    type(curve_t), intent(in) :: curve
    type(cycle_t), allocatable :: cycles(:)
    real(dp), allocatable :: stress(:)
    real(dp) :: amplitude, harm, most
    integer :: i, k, pairs

    pairs = maxval(which)
    most = -1
    do i = 1, pairs
      stress = root_history(pair, member, pack(s, which == i), pack(load, which == i), rim)
      life%largest = max(life%largest, maxval(stress))
      cycles = count_cycles([stress, 0.0_dp, stress_ratio*maxval(stress), 0.0_dp])
      life%cycles = life%cycles + size(cycles)/real(pairs, dp)
      do k = 1, size(cycles)
        amplitude = equivalent_amplitude(cycles(k), strength)
        life%is_over = life%is_over .or. amplitude < 0
        harm = damage_of(curve, amplitude)
        life%damage = life%damage + harm/pairs
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

  !> Tooth root stress (Pa) by ISO 6336-3, with form factors for the place at which the load acts; beyond the path of contact,
  !> that of its end.
  pure function root_history(pair, member, s, load, rim) result(stress)
    type(pair_t), intent(in) :: pair
    integer, intent(in) :: member
    real(dp), intent(in) :: s(:), load(:), rim
    real(dp) :: stress(size(s))
    real(dp) :: radius
    integer :: i

    associate (gear => pair%gear(member))
      do i = 1, size(s)
        radius = min(gear%tip_radius, pair%radius(member, max(0.0_dp, min(pair%contact_ratio, s(i)))))
        stress(i) = nominal_root_stress(pair, member, iso_form(gear, radius), load(i)) &
                    *rim_factor(rim, gear%tip_radius - gear%root_radius)
      end do
    end associate
  end function root_history
end module gearsweep_root_life
