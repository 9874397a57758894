!> Dynamic factor K_v by ISO 6336-1, Method B: a formula in five ranges of the running speed, for a pair of gears whose mass
!> acts on the line of action; and by Method A, from the loads of the equation of motion.
module gearsweep_rating_dynamic_factor
  use gearsweep_base, only: dp, pi
  implicit none
  private
  public :: method_b_t, resonance_ratio, is_in_range, dynamic_factor_a, dynamic_factor_b, deviations_of, grade_of, counted_relief

  !> Inputs of Method B for a pair.
  type :: method_b_t
    integer :: teeth = 0                         !< number of teeth of the pinion, z_1
    real(dp) :: contact_ratio = 0                !< contact ratio epsilon_alpha
    real(dp) :: single_stiffness = 0             !< single stiffness c' per unit of face width, N/m^2
    real(dp) :: mesh_stiffness = 0               !< mesh stiffness c_gamma_alpha per unit of face width, N/m^2
    real(dp) :: mass = 0                         !< reduced mass m_red per unit of face width, kg/m
    real(dp) :: line_load = 0                    !< line load F_t K_A/b, N/m
    real(dp) :: pitch_deviation = 0              !< effective base pitch deviation f_pb, less running in, m
    real(dp) :: profile_deviation = 0            !< effective profile form deviation f_f_alpha, m
    real(dp) :: relief(2) = 0                    !< tip relief C_a of pinion and gear, m
  end type method_b_t

  real(dp), parameter :: main_end = 1.15_dp, above = 1.5_dp
  !> Coarsest accuracy grade in which relief counts, and the number that marks a grade beyond the coarsest.
  integer, parameter :: coarsest_relieved = 5
  integer, parameter, public :: no_grade = 13

contains

  !> K_v by Method A: the largest load of a pair in motion over its largest static load, at least 1; NaN if not known. It therefore
  !> contains the vibration alone, without the load sharing of the pairs, for which the standard has other factors.
  !> Source: ISO 6336-1:2006, 6.3 and 6.4.
  elemental real(dp) function dynamic_factor_a(in_motion, at_rest) result(factor)
    real(dp), intent(in) :: in_motion            !< largest load in motion over the static load of the mesh
    real(dp), intent(in) :: at_rest              !< largest static load over the static load of the mesh

    factor = in_motion/at_rest
    if (factor < 1) factor = 1
  end function dynamic_factor_a

  !> C_a as used by Method B (m): 0 in the grades 6 and coarser, so that B_k is 1.
  !> Source: ISO 6336-1:2006, 6.5.4.
  elemental real(dp) function counted_relief(relief, grade) result(counted)
    real(dp), intent(in) :: relief               !< tip relief, m
    integer, intent(in) :: grade                 !< accuracy grade of ISO 1328-1

    counted = merge(relief, 0.0_dp, grade <= coarsest_relieved)
  end function counted_relief

  !> Resonance ratio N: speed of the pinion over its resonance running speed n_E1.
  !> Source: ISO 6336-1:2006, 6.5.3.
  elemental real(dp) function resonance_ratio(of, rpm) result(ratio)
    type(method_b_t), intent(in) :: of
    real(dp), intent(in) :: rpm                  !< speed of the pinion, 1/min

    ratio = rpm*2*pi/60*of%teeth/sqrt(of%mesh_stiffness/of%mass)
  end function resonance_ratio

  !> True if the speed is high enough for the method: (v z_1/100) sqrt(u^2/(1 + u^2)) at least 3 m/s. Below, K_v is near 1.
  !> Source: ISO 6336-1:2006, 6.3.2.
  elemental logical function is_in_range(speed, teeth, ratio)
    real(dp), intent(in) :: speed                !< pitch line velocity v at the reference circle, m/s
    integer, intent(in) :: teeth                 !< number of teeth of the pinion
    real(dp), intent(in) :: ratio                !< gear ratio u, number of teeth of the gear over that of the pinion

    is_in_range = speed*teeth/100*ratio/sqrt(1 + ratio**2) >= 3
  end function is_in_range

  !> K_v at a speed. In the intermediate range between resonance and supercritical range it is interpolated linearly.
  !> Source: ISO 6336-1:2006, 6.5.4 to 6.5.7 and Table 8.
  elemental real(dp) function dynamic_factor_b(of, rpm) result(factor)
    type(method_b_t), intent(in) :: of
    real(dp), intent(in) :: rpm                  !< speed of the pinion, 1/min
    real(dp), parameter :: threshold = 100e3_dp  ! N/m
    real(dp) :: b(3), c(7), ratio, begins

    b(1) = of%single_stiffness*of%pitch_deviation/of%line_load
    b(2) = of%single_stiffness*of%profile_deviation/of%line_load
    ! Relief that fits the load removes the excitation; the gear whose relief fits less counts.
    b(3) = maxval(abs(1 - of%single_stiffness*of%relief/of%line_load))
    ! C_v1 to C_v7 of Table 8.
    associate (e => of%contact_ratio)
      c = [0.32_dp, 0.34_dp, 0.23_dp, 0.90_dp, 0.47_dp, 0.47_dp, 0.75_dp]
      if (e > 2) c([2, 3, 4, 6]) = [0.57_dp/(e - 0.3_dp), 0.096_dp/(e - 1.56_dp), (0.57_dp - 0.05_dp*e)/(e - 1.44_dp), &
                                    0.12_dp/(e - 1.74_dp)]
      if (e > 1.5_dp) c(7) = 0.125_dp*sin(pi*(e - 2)) + 0.875_dp
      if (e > 2.5_dp) c(7) = 1
    end associate
    ratio = resonance_ratio(of, rpm)
    begins = 0.85_dp
    if (of%line_load < threshold) begins = 0.5_dp + 0.35_dp*sqrt(of%line_load/threshold)
    if (ratio <= begins) then
      factor = 1 + ratio*dot_product(c(:3), b)
    else if (ratio <= main_end) then
      factor = in_resonance()
    else if (ratio < above) then
      factor = beyond() + (in_resonance() - beyond())*(above - ratio)/(above - main_end)
    else
      factor = beyond()
    end if

  contains

    pure real(dp) function in_resonance()
      in_resonance = 1 + dot_product([c(1), c(2), c(4)], b)
    end function in_resonance

    pure real(dp) function beyond()
      beyond = dot_product(c(5:6), b(:2)) + c(7)
    end function beyond
  end function dynamic_factor_b

  !> Largest deviations that an accuracy grade allows, before running in: transverse base pitch deviation f_pb and
  !> profile form deviation f_f_alpha (m).
  !> Source: ISO 1328-1:1995, 6.1 and Annex B, without its rounding; f_pb = f_pt cos(alpha) by ISO 6336-1:2006, 6.5.4.
  pure function deviations_of(grade, module, diameter, pressure_angle) result(deviations)
    integer, intent(in) :: grade                 !< accuracy grade, 0 to 12
    real(dp), intent(in) :: module               !< module, m
    real(dp), intent(in) :: diameter             !< reference diameter, m
    real(dp), intent(in) :: pressure_angle       !< pressure angle of the rack, rad
    real(dp) :: deviations(2)
    real(dp) :: m, d

    m = 1000*module
    d = 1000*diameter
    deviations = 1e-6_dp*sqrt(2.0_dp)**(grade - 5)* &
                 [(0.3_dp*(m + 0.4_dp*sqrt(d)) + 4)*cos(pressure_angle), 2.5_dp*sqrt(m) + 0.17_dp*sqrt(d) + 0.5_dp]
  end function deviations_of

  !> Finest accuracy grade that allows these deviations of a pair, whose larger gear has the larger limits; `no_grade` for none.
  pure integer function grade_of(stated, module, diameter, pressure_angle) result(grade)
    real(dp), intent(in) :: stated(2)            !< deviations in the order of `deviations_of`, m
    real(dp), intent(in) :: module               !< module, m
    real(dp), intent(in) :: diameter             !< reference diameter of the larger gear, m
    real(dp), intent(in) :: pressure_angle       !< pressure angle of the rack, rad
    real(dp), parameter :: rounding = 1e-9_dp

    do grade = 0, no_grade - 1
      if (all(stated <= (1 + rounding)*deviations_of(grade, module, diameter, pressure_angle))) exit
    end do
  end function grade_of
end module gearsweep_rating_dynamic_factor
