!> Gear bodies drawn at random, the same in every run: teeth, flanks, bores from
!> small ones to thin rims, sections and whole gears, supports, fineness.
module test_properties_random_bodies
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_base_error, only: error_t
  use gearsweep_gear_gear, only: drive, gear_spec_t, gear_t, make_gear
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_elastic_section, only: section_options_t
  use test_support_random_numbers, only: random_t
  implicit none
  private
  public :: random_body_t, random_body

  type :: random_body_t
    type(gear_t) :: gear
    type(section_options_t) :: options
    real(dp) :: bore_share = 0                   !< of the root radius
    real(dp) :: radius = 0                       !< of a load on the drive flank, m
  end type random_body_t

contains

  !> Draw `number`; every second one a whole gear held at its bore, of at most 24 teeth
  !> and `most_whole` elements across, the others sections of 1 to 5 teeth.
  subroutine random_body(number, most_section, most_whole, body)
    integer, intent(in) :: number, most_section, most_whole
    type(random_body_t), intent(out) :: body
    integer, parameter :: least_across = 3
    type(gear_spec_t) :: spec
    type(error_t), allocatable :: error
    type(random_t) :: random
    logical :: whole

    random%seed = 7919_int64*number + 12345
    whole = mod(number, 2) == 0
    do
      spec = gear_spec_t('pinion', nint(random%power(9.0_dp, merge(24.0_dp, 80.0_dp, whole))), 0.003_dp, face_width=0.02_dp)
      spec%pressure_angle = [random%between(17.5_dp, 27.0_dp), random%between(17.5_dp, 27.0_dp)]*pi/180
      if (random%uniform() < 0.7_dp) spec%pressure_angle(2) = spec%pressure_angle(1)
      spec%profile_shift = random%between(-0.2_dp, 0.6_dp)
      spec%rack_tip_radius = random%between(0.05_dp, 0.3_dp)
      call make_gear(spec, body%gear, error)
      if (.not. allocated(error)) exit
    end do
    associate (gear => body%gear, options => body%options)
      body%bore_share = random%power(0.03_dp, 1 - 1.2_dp*spec%module/gear%root_radius)
      spec%bore_radius = body%bore_share*gear%root_radius
      call make_gear(spec, gear, error)
      options%plane_strain = random%uniform() < 0.5_dp
      if (whole) then
        options%teeth = 0
        options%elements_across = least_across + int(random%uniform()*(most_whole - least_across + 1))
      else
        options%teeth = min(spec%teeth - 1, 1 + int(5*random%uniform()))
        options%fixed_sides = random%uniform() < 0.7_dp
        ! Within .or. the compiler would decide whether a number is drawn, and so what the set is.
        options%fixed_rim = .true.
        if (options%fixed_sides) options%fixed_rim = random%uniform() < 0.7_dp
        options%elements_across = least_across + int(random%uniform()*(most_section - least_across + 1))
      end if
      body%radius = random%between(0.4_dp*gear%form_radius(drive) + 0.6_dp*gear%tip_radius, gear%tip_radius)
    end associate
  end subroutine random_body
end module test_properties_random_bodies
