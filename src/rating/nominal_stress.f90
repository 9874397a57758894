!> Nominal contact and tooth root stress of both gears by ISO 6336, with the factors that do not depend on the speed.
module gearsweep_rating_nominal_stress
  use gearsweep_base, only: dp
  use gearsweep_gear, only: drive, gear_t, pair_t
  use gearsweep_elastic, only: material_t
  use gearsweep_rating_dynamic_factor, only: no_grade
  use gearsweep_rating_flank, only: flank_factors, flank_factors_t, nominal_flank_stress, rim_factor, root_face_load_factor
  use gearsweep_rating_form, only: deep_tooth_factor, helix_factor, iso_form, iso_form_t, nominal_root_stress, &
    outer_single_contact, virtual_outer_contact
  implicit none
  private
  public :: nominal_t, nominal_of

  !> Nominal stresses of both gears, and the factors in them.
  type :: nominal_t
    integer :: grade = no_grade                  !< accuracy grade of the pair
    real(dp) :: load = 0                         !< tangential load F_t on the reference circle, N
    type(flank_factors_t) :: flank
    real(dp) :: contact = 0                      !< nominal contact stress sigma_H0, Pa
    type(iso_form_t) :: form(2)
    real(dp) :: rim(2) = 1                       !< rim thickness factors Y_B
    real(dp) :: deep = 1                         !< deep tooth factor Y_DT
    real(dp) :: helix = 1                        !< helix angle factor Y_beta
    real(dp) :: root(2) = 0                      !< nominal root stresses sigma_F0, Pa
    real(dp) :: root_face_load = 1               !< face load factor K_F_beta
  end type nominal_t

contains

  !> Computes the nominal stresses and their factors.
  !> Source: ISO 6336-1, -2 and -3:2006, the clauses of each factor.
  pure type(nominal_t) function nominal_of(pair, material, load, rim_thickness, face_load, grade, virtual) result(nominal)
    type(pair_t), intent(in) :: pair
    type(material_t), intent(in) :: material(2)  !< of pinion and gear
    real(dp), intent(in) :: load                 !< load on the line of action, N
    real(dp), intent(in) :: rim_thickness(2)     !< rim thickness of pinion and gear, m; 0: solid
    real(dp), intent(in) :: face_load            !< face load factor K_H_beta
    integer, intent(in) :: grade                 !< accuracy grade of the pair by ISO 1328-1; no_grade: not known
    type(gear_t), intent(in), optional :: virtual(2)       !< virtual gears of helical gears
    integer :: i

    nominal%grade = grade
    nominal%load = load*cos(pair%gear(1)%transverse_angle(drive))
    nominal%flank = flank_factors(pair, [material%young], [material%poisson])
    nominal%contact = nominal_flank_stress(pair, nominal%flank, nominal%load)
    nominal%root_face_load = root_face_load_factor(pair, face_load)
    nominal%deep = deep_tooth_factor(pair%contact_ratio/cos(pair%gear(1)%base_helix())**2, grade)
    nominal%helix = helix_factor(pair)
    do i = 1, 2
      associate (gear => pair%gear(i))
        if (present(virtual)) then
          nominal%form(i) = iso_form(virtual(i), virtual_outer_contact(pair, virtual(i)))
        else
          nominal%form(i) = iso_form(gear, outer_single_contact(pair, i))
        end if
        nominal%rim(i) = rim_factor(rim_thickness(i), gear%tip_radius - gear%root_radius)
        nominal%root(i) = nominal_root_stress(pair, i, nominal%form(i), load)*nominal%rim(i)*nominal%deep
      end associate
    end do
  end function nominal_of
end module gearsweep_rating_nominal_stress
