!> Motions drawn at random over all that a case may ask for, the same in every run: damping from next to none to fifty times
!> critical, contact ratios just above a whole number, reliefs, backlash, friction, tip corners that touch.
module test_properties_random_motions
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_study_case_case, only: case_t
  use gearsweep_api_case_reader, only: read_case
  use gearsweep_base_error, only: error_t
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_motion_oscillator, only: make_oscillator, oscillator_t
  use gearsweep_gear_relief, only: linear, parabolic, profile_error, relief_t
  use gearsweep_mesh_stiffness, only: polynomial_stiffness
  use gearsweep_study_run_study, only: run_study, study_t
  use test_properties_random_meshes, only: draw_t
  use test_support_random_numbers, only: random_t
  implicit none
  private
  public :: random_motion, has_corners

contains

  !> Draw `number` with so many speeds: within 15 % of one that is 0.05 to 3 times the main resonance. Damping ratio 1e-4 to 50
  !> and tolerance 1e-10 to 1e-3, their logarithms evenly spread; backlash of 1 to 100 um in three of ten, friction up to 0.1 in
  !> three of ten. Every eighth is a pair of gears like case 1, of other tooth heights, loads and reliefs, whose tip corners touch.
  subroutine random_motion(number, speeds, draw)
    integer, intent(in) :: number, speeds
    type(draw_t), intent(out) :: draw
    type(error_t), allocatable :: error
    type(random_t) :: random
    real(dp) :: main
    integer :: i

    random%seed = 104729_int64*number + 777
    ! The first few are much alike for seeds that are.
    do i = 1, 6
      main = random%uniform()
    end do
    if (has_corners(number)) then
      call gears(random, draw%osc)
    else
      call prescribed(random, draw%osc)
    end if
    associate (osc => draw%osc)
      osc%damping_ratio = random%power(1e-4_dp, 50.0_dp)
      osc%has_backlash = random%uniform() < 0.3_dp
      osc%backlash = random%power(1e-6_dp, 1e-4_dp)
      if (random%uniform() < 0.3_dp) osc%friction = random%between(0.0_dp, 0.1_dp)
      call make_oscillator(osc, error)
      if (allocated(error)) error stop 'random motion'
      main = 60*osc%natural_frequency/(2*pi*osc%mesh%teeth(1))*random%power(0.05_dp, 3.0_dp)
      draw%rpm = [(main*(0.85_dp + 0.3_dp*(i - 0.5_dp)/speeds), i=1, speeds)]
    end associate
    draw%tolerance = random%power(1e-10_dp, 1e-3_dp)
  end subroutine random_motion

  elemental logical function has_corners(number)
    integer, intent(in) :: number

    has_corners = modulo(number, 8) == 0
  end function has_corners

  !> A prescribed mesh. Its contact ratio is 1.05 to 2.9 or, in half of them, 0.005 to 0.15 above 1 or 2. None or up to 1.6 mean
  !> deflections of relief: short, linear and the same on both gears or, in half of them, from anywhere, of either shape.
  subroutine prescribed(random, osc)
    type(random_t), intent(inout) :: random
    type(oscillator_t), intent(inout) :: osc
    type(error_t), allocatable :: error
    type(relief_t) :: relief
    real(dp) :: shape(5), deflection

    associate (mesh => osc%mesh)
      mesh%contact_ratio = random%between(1.05_dp, 2.9_dp)
      if (random%uniform() < 0.5_dp) mesh%contact_ratio = 1 + int(2*random%uniform()) + random%between(0.005_dp, 0.15_dp)
      mesh%reach = [0.0_dp, mesh%contact_ratio]
      mesh%teeth = 25
      mesh%tan_angle = tan(20*pi/180)
      mesh%pitch_point = mesh%contact_ratio*random%between(0.4_dp, 0.6_dp)
      shape = [1.0_dp, random%between(-0.15_dp, 0.15_dp), random%between(-0.4_dp, 0.0_dp), &
               random%between(-0.1_dp, 0.1_dp), random%between(0.0_dp, 0.1_dp)]
      call polynomial_stiffness(mesh%contact_ratio, 4e8_dp*shape, mesh%stiffness, error)
      osc%mass = [random%power(0.3_dp, 3.0_dp), random%power(0.3_dp, 3.0_dp)]
      deflection = random%power(1e-6_dp, 5e-5_dp)
      osc%load = deflection*mesh%mean_stiffness()
      relief%amount = max(0.0_dp, random%between(-0.5_dp, 1.6_dp))*deflection
      relief%start = [aint(mesh%contact_ratio), modulo(mesh%contact_ratio, 1.0_dp)]
      if (random%uniform() < 0.5_dp) then
        relief%amount(2) = relief%amount(1)*random%uniform()
        relief%start = mesh%contact_ratio*[random%between(0.5_dp, 0.98_dp), random%between(0.02_dp, 0.5_dp)]
        relief%shape = merge(linear, parabolic, random%uniform() < 0.5_dp)
      end if
      call profile_error(relief, mesh%contact_ratio, mesh%profile_error, error)
      if (allocated(error)) error stop 'random motion'
    end associate
  end subroutine prescribed

  !> A pair of gears with contact at tip corners. Its stiffness is a spline through many knots.
  subroutine gears(random, osc)
    type(random_t), intent(inout) :: random
    type(oscillator_t), intent(inout) :: osc
    type(case_t) :: case
    type(study_t) :: study
    type(error_t), allocatable :: error
    character(1000) :: text
    real(dp) :: amount, load, addendum

    amount = max(0.0_dp, random%between(-10.0_dp, 30.0_dp))
    load = random%power(100.0_dp, 600.0_dp)
    addendum = random%between(0.8_dp, 1.15_dp)
    write (text, '(4(a, es12.5), a)') &
      '&case tasks = "mesh" / &pair module_mm = 3.18 pressure_angle_deg = 20 face_width_mm = 25.4 /'// &
      '&pinion teeth = 25 profile_shift = 0 addendum = ', addendum, ' dedendum = 1.25 rack_tip_radius = 0.25'// &
      ' effective_mass_kg = 0.8113 / &gear teeth = 31 profile_shift = 0 addendum = ', addendum, &
      ' dedendum = 1.25 rack_tip_radius = 0.25 effective_mass_kg = 0.9 / &material young_gpa = 206 poisson = 0.3 /'// &
      '&load line_load_n_mm = ', load, '/ &relief amount_um = ', amount, ' pinion_fraction = 1 gear_fraction = 1'// &
      ' start = "hpstc" shape = "linear" / &mesh model = "weber" corner_contact = .true. /'// &
      '&dynamics damping_ratio = 0.1 / &sweep rpm_first = 1000 rpm_last = 1000 rpm_step = 1 /'
    call read_case(trim(text), case, error)
    if (allocated(error)) error stop 'random motion'
    call case%request(['mesh'])
    call run_study(case, '', 1, study, error)
    if (allocated(error)) error stop 'random motion'
    osc = study%motion(1)
  end subroutine gears
end module test_properties_random_motions
