!> Prescribed meshes drawn at random, the same in every run: contact ratio,
!> stiffness, short linear relief on both gears, masses, load, damping.
module test_properties_random_meshes
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_base_error, only: error_t
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_motion_oscillator, only: make_oscillator, oscillator_t
  use gearsweep_gear_relief, only: profile_error, relief_t
  use gearsweep_mesh_stiffness, only: polynomial_stiffness
  use test_support_random_numbers, only: random_t
  implicit none
  private
  public :: draw_t, random_mesh

  !> What a draw is to be like: anything; a contact ratio 0.005 to 0.15 above a whole number, with relief, so that a smooth interval
  !> is short; damping ratios of 0.5 to 50 at 0.1 to 2.6 times the main resonance.
  integer, parameter, public :: of_any_kind = 0, with_short_intervals = 1, strongly_damped = 2

  !> One mesh, speeds (1/min, ascending) and a tolerance.
  type :: draw_t
    type(oscillator_t) :: osc
    real(dp), allocatable :: rpm(:)
    real(dp) :: tolerance = 0
  end type draw_t

contains

  !> Draw `number` with so many speeds: within 15 % of one that is 0.05 to 3 times
  !> the main resonance. Damping ratio 1e-3 to 1, tolerance 1e-8 to 1e-3, relief none
  !> or up to 1.6 mean deflections.
  subroutine random_mesh(number, speeds, draw, kind)
    integer, intent(in) :: number, speeds
    integer, intent(in), optional :: kind
    type(draw_t), intent(out) :: draw
    type(error_t), allocatable :: error
    type(relief_t) :: relief
    real(dp) :: shape(5), deflection, part, main
    type(random_t) :: random
    integer :: i, what

    what = of_any_kind
    if (present(kind)) what = kind
    random%seed = 7919_int64*number + 12345
    associate (osc => draw%osc, mesh => draw%osc%mesh)
      mesh%contact_ratio = random%between(1.05_dp, 2.9_dp)
      if (what == with_short_intervals) mesh%contact_ratio = aint(mesh%contact_ratio) + random%between(0.005_dp, 0.15_dp)
      mesh%reach = [0.0_dp, mesh%contact_ratio]
      mesh%teeth = 25
      shape = [1.0_dp, random%between(-0.15_dp, 0.15_dp), random%between(-0.4_dp, 0.0_dp), &
               random%between(-0.1_dp, 0.1_dp), random%between(0.0_dp, 0.1_dp)]
      call polynomial_stiffness(mesh%contact_ratio, 4e8_dp*shape, mesh%stiffness, error)
      osc%mass = [random%power(0.3_dp, 3.0_dp), random%power(0.3_dp, 3.0_dp)]
      deflection = random%power(1e-6_dp, 5e-5_dp)
      osc%load = deflection*mesh%mean_stiffness()
      part = max(0.0_dp, random%between(merge(0.1_dp, -0.5_dp, what == with_short_intervals), 1.6_dp))
      relief%amount = part*deflection
      relief%start = [aint(mesh%contact_ratio), modulo(mesh%contact_ratio, 1.0_dp)]
      call profile_error(relief, mesh%contact_ratio, mesh%profile_error, error)
      osc%damping_ratio = random%power(merge(0.5_dp, 1e-3_dp, what == strongly_damped), &
                                       merge(50.0_dp, 1.0_dp, what == strongly_damped))
      call make_oscillator(osc, error)
      if (allocated(error)) error stop 'random mesh'
      main = 60*osc%natural_frequency/(2*pi*mesh%teeth(1))*random%power( &
             merge(0.1_dp, 0.05_dp, what == strongly_damped), merge(2.6_dp, 3.0_dp, what == strongly_damped))
      draw%rpm = [(main*(0.85_dp + 0.3_dp*(i - 0.5_dp)/speeds), i=1, speeds)]
    end associate
    draw%tolerance = random%power(1e-8_dp, 1e-3_dp)
  end subroutine random_mesh
end module test_properties_random_meshes
