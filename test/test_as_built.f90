!> Motions of gears whose teeth have errors of their own: against six motions of a solver written apart
!> (test/reference/as_built.dat), and identities.
module test_as_built
  use gearsweep_deviations, only: make_deviations, wave_t
  use gearsweep_error, only: error_t
  use gearsweep_error_estimate, only: accuracy_t
  use gearsweep_kinds, only: dp, pi
  use gearsweep_oscillator, only: make_oscillator, oscillator_t
  use gearsweep_piecewise, only: piecewise_t, polynomial
  use gearsweep_refinement, only: levels_t
  use gearsweep_text, only: str
  use gearsweep_turn, only: amplitude_of, curve_t, find_static_turn, find_turn, turn_t
  use reference_rows, only: next_row
  use testing, only: check_close, check_true, tally_t
  implicit none
  private
  public :: run

  real(dp), parameter :: um = 1e-6_dp

  type :: given_t
    character(8) :: name = ''
    type(oscillator_t) :: osc
    real(dp) :: rpm = 0
    integer :: periods = 0, tooth(2) = 0, changes = 0
    real(dp) :: dynamic_factor = 0, least = 0, largest = 0, modulus = 0, state(2) = 0, dynamic(10) = 0, static(10) = 0, range = 0
  end type given_t

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t
    type(given_t), allocatable :: given(:)

    call read_given(given)
    if (t%wants('given_motions')) call given_motions(t, given)
  end subroutine run

  subroutine read_given(given)
    type(given_t), allocatable, intent(out) :: given(:)
    character(1000) :: line
    type(given_t) :: one
    type(wave_t), allocatable :: waves(:)
    real(dp), allocatable :: k(:), pinion(:, :), gear(:, :)
    real(dp) :: ratio, relief(2), start(2)
    integer :: unit, n, i

    allocate (given(0))
    open (newunit=unit, file='test/reference/as_built.dat', status='old', action='read')
    do while (next_row(unit, line))
      one = given_t()
      one%name = line(:8)
      associate (osc => one%osc, mesh => one%osc%mesh)
        read (unit, *) mesh%teeth, one%rpm, ratio, osc%load, osc%damping_ratio, osc%mass
        read (unit, '(a)') line
        read (line, *) n
        allocate (k(n))
        read (line, *) n, k
        read (unit, *) relief, start
        read (unit, *) n
        allocate (waves(n), pinion(0:2, mesh%teeth(1)), gear(0:2, mesh%teeth(2)))
        do i = 1, n
          read (unit, *) waves(i)%gear, waves(i)%order, waves(i)%amplitude, waves(i)%phase
          waves(i)%amplitude = um*waves(i)%amplitude
        end do
        read (unit, *) pinion, gear
        mesh%contact_ratio = ratio
        mesh%reach = [0.0_dp, ratio]
        mesh%stiffness = polynomial(0.0_dp, ratio, 1e6_dp*k)
        mesh%profile_error = tip_relief(ratio, um*relief, start)
        mesh%deviations = make_deviations(mesh%teeth, um*pinion, um*gear, waves, 0)
        deallocate (k, waves, pinion, gear)
      end associate
      read (unit, *) one%periods, one%dynamic_factor, one%tooth, one%least, one%largest, one%modulus, one%changes, one%state
      read (unit, *) one%dynamic
      read (unit, *) one%static
      read (unit, *) one%range
      given = [given, one]
    end do
    close (unit)
  end subroutine read_given

  !> Linear relief at the tips of pinion and gear.
  type(piecewise_t) function tip_relief(ratio, amount, start) result(error)
    real(dp), intent(in) :: ratio, amount(2), start(2)
    real(dp) :: breaks(4)

    ! Where the reliefs overlap, both count; here they do not.
    breaks = [0.0_dp, min(start(2), ratio/2), max(start(1), ratio/2), ratio]
    allocate (error%breaks, source=breaks)
    allocate (error%coef(0:1, 3), source=0.0_dp)
    error%coef(:, 1) = amount(2)/2*[1, -1]
    error%coef(:, 3) = amount(1)/2*[1, 1]
  end function tip_relief

  subroutine given_motions(t, given)
    type(tally_t), intent(inout) :: t
    type(given_t), intent(in) :: given(:)
    type(error_t), allocatable :: error
    type(accuracy_t) :: options
    type(levels_t), allocatable :: levels
    type(oscillator_t) :: osc
    type(turn_t) :: turn
    type(curve_t) :: static
    integer :: i

    options%steady%tolerance = 1e-11_dp
    do i = 1, size(given)
      associate (one => given(i))
        osc = one%osc
        call make_oscillator(osc, error)
        call check_true(t, 'accepted', .not. allocated(error), one%name)
        if (allocated(error)) cycle
        call check_true(t, 'periods of the turn', osc%mesh%deviations%periods == one%periods, one%name)
        if (allocated(levels)) deallocate (levels)
        allocate (levels)
        call find_turn(osc, one%rpm, options, levels, turn)
        call check_close(t, 'dynamic factor', turn%point%dynamic_factor, one%dynamic_factor, absolute=1e-9_dp)
        if (.not. allocated(turn%load)) cycle
        call check_close(t, 'largest load of a pair', maxval(turn%load)/osc%load, one%dynamic_factor, absolute=1e-9_dp)
        call check_true(t, 'where the largest load is', &
                        all(modulo(maxloc(turn%load, 1) - 1, osc%mesh%teeth) == one%tooth), one%name)
        call check_close(t, 'least transmission error', turn%error%least, um*one%least, absolute=1e-9_dp*um)
        call check_close(t, 'largest transmission error', turn%error%largest, um*one%largest, absolute=1e-9_dp*um)
        call check_close(t, 'state', turn%point%steady%state(1), um*one%state(1), absolute=1e-9_dp*um)
        call check_close(t, 'derivative', turn%point%steady%state(2), um*one%state(2), absolute=1e-8_dp*um)
        call check_orders(t, one, turn%error, one%dynamic, 'dynamic')
        call find_static_turn(osc, static)
        call check_orders(t, one, static, one%static, 'static')
        ! Where pairs part at rest the given ranges come short of values that the curve takes, by less than 1e-6 um.
        call check_true(t, 'static range', static%largest - static%least > um*(one%range - 1e-9_dp) .and. &
                        static%largest - static%least < um*(one%range + merge(2e-6_dp, 1e-9_dp, one%changes > 0)), one%name)
      end associate
    end do
  end subroutine given_motions

  subroutine check_orders(t, given, curve, expected, what)
    type(tally_t), intent(inout) :: t
    type(given_t), intent(in) :: given
    type(curve_t), intent(in) :: curve
    real(dp), intent(in) :: expected(10)
    character(*), intent(in) :: what
    real(dp) :: harmonic(10), pinion, gear
    integer :: k

    pinion = 1.0_dp/given%osc%mesh%teeth(1)
    gear = 1.0_dp/given%osc%mesh%teeth(2)
    harmonic = [0.0_dp, pinion, gear, 1.0_dp, 2.0_dp, 1 - pinion, 1 + pinion, 1 - gear, 1 + gear, 1.0_dp/given%periods]
    do k = 1, 10
      call check_close(t, given%name//what//' order '//str(k), abs(amplitude_of(curve, harmonic(k))), um*expected(k), &
                       absolute=1e-9_dp*um)
    end do
  end subroutine check_orders
end module test_as_built
