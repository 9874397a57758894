!> Stability over speed and damping: closed forms, identities, and the sweep's own multipliers.
module test_stability
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_motion_oscillator, only: make_oscillator, mesh_period, oscillator_t
  use gearsweep_nonlinear_stability, only: find_tongues, map_stability, stability_t, tongue_t
  use gearsweep_motion_sweep, only: contact_full, each, run_sweep, sweep_options_t, sweep_t
  use gearsweep_base_error, only: error_t
  use gearsweep_base_piecewise, only: polynomial
  use gearsweep_base_text, only: str
  use test_support_reference_rows, only: next_row, prescribed
  use test_support_testing, only: tally_t, check_true, check_close, check_equal, check_no_error
  implicit none
  private
  public :: run

  !> A row of test/reference/meissner.dat.
  type :: tongue_row_t
    integer :: teeth, tongue
    real(dp) :: ratio, stiffness, mass(2), edge(2), closing_damping, closing_rpm
  end type tongue_row_t

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('meissner_tongues')) call meissner_tongues(t)
    if (t%wants('meissner_map')) call meissner_map(t)
    if (t%wants('coexistence')) call coexistence(t)
    if (t%wants('mathieu_tongues')) call mathieu_tongues(t)
    if (t%wants('edges_of_a_curved_stiffness')) call edges_of_a_curved_stiffness(t)
    if (t%wants('same_as_the_sweep')) call same_as_the_sweep(t)
    if (t%wants('load_and_relief_drop_out')) call load_and_relief_drop_out(t)
    if (t%wants('too_slow')) call too_slow(t)
  end subroutine run

  !> A mesh without relief, N/um.
  type(oscillator_t) function mesh_of(contact_ratio, coef) result(osc)
    real(dp), intent(in) :: contact_ratio, coef(:)
    type(error_t), allocatable :: error

    call prescribed(contact_ratio, coef, [0.0_dp, 0.0_dp], 1, osc)
    osc%mesh%teeth = 25
    osc%mass = 0.8_dp
    osc%load = 7000
    call make_oscillator(osc, error)
    if (allocated(error)) error stop 'test mesh'
  end function mesh_of

  subroutine read_tongues(rows)
    type(tongue_row_t), allocatable, intent(out) :: rows(:)
    type(tongue_row_t) :: row
    integer :: unit, k
    character(1000) :: line

    allocate (rows(0))
    k = 1
    open (newunit=unit, file='test/reference/meissner.dat', status='old', action='read')
    do while (next_row(unit, line))
      read (line, *) row%teeth, row%ratio, row%stiffness, row%mass, row%edge(k), row%tongue, row%closing_damping, &
        row%closing_rpm
      if (k == 2) rows = [rows, row]
      k = 3 - k
    end do
    close (unit)
  end subroutine read_tongues

  !> Edges and closing of Meissner's square wave against closed forms in 40 digits; the closing is a
  !> maximum, so that its speed is less sharp than its damping.
  subroutine meissner_tongues(t)
    type(tally_t), intent(inout) :: t
    type(tongue_row_t), allocatable :: rows(:)
    type(tongue_t) :: tongue(3)
    type(oscillator_t) :: osc
    type(error_t), allocatable :: error
    character(:), allocatable :: name
    integer :: i

    call read_tongues(rows)
    call check_equal(t, 'tongues read', size(rows), 15)
    do i = 1, size(rows)
      associate (row => rows(i))
        osc = mesh_of(row%ratio, [row%stiffness])
        osc%mesh%teeth = row%teeth
        osc%mass = row%mass
        call make_oscillator(osc, error)
        call find_tongues(osc, [0.0_dp, 0.999_dp, 1.001_dp]*row%closing_damping, tongue, error)
        call check_no_error(t, 'tongues', error)
        name = 'row '//str(i)//', '
        associate (found => tongue(row%tongue))
          call check_close(t, name//'lower edge', found%edge(1, 1), row%edge(1), relative=1e-11_dp)
          call check_close(t, name//'upper edge', found%edge(2, 1), row%edge(2), relative=1e-11_dp)
          call check_close(t, name//'closing damping', found%closing_damping, row%closing_damping, relative=1e-9_dp)
          call check_close(t, name//'closing speed', found%closing_rpm, row%closing_rpm, relative=1e-8_dp)
          call check_true(t, name//'nearly closed', found%edge(1, 2) < row%closing_rpm .and. found%edge(2, 2) > row%closing_rpm)
          call check_true(t, name//'closed', all(ieee_is_nan(found%edge(:, 3))))
        end associate
      end associate
    end do
  end subroutine meissner_tongues

  !> The damped square wave over speed and damping: the product of two closed-form maps.
  subroutine meissner_map(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: damping(5) = [0.0_dp, 0.01_dp, 0.05_dp, 0.3_dp, 0.9_dp]
    type(oscillator_t) :: osc
    type(stability_t) :: map
    real(dp) :: rpm(45), half_trace, determinant, worst(2)
    integer :: i, k, wrong

    osc = mesh_of(1.6_dp, [400.0_dp])
    rpm = [(1500 + 777.7_dp*i, i=1, size(rpm))]
    call map_stability(osc, rpm, damping, 1e-10_dp, map)
    worst = 0
    wrong = 0
    do k = 1, size(damping)
      do i = 1, size(rpm)
        call exact(rpm(i), damping(k), half_trace, determinant)
        associate (square => half_trace**2 - determinant)
          if (square < 0) then
            worst(1) = max(worst(1), abs(map%modulus(i, k) - sqrt(determinant)))
            if (map%sense(i, k) /= 0) wrong = wrong + 1
          else
            worst(2) = max(worst(2), abs(map%modulus(i, k) - abs(half_trace) - sqrt(square)))
            if (map%sense(i, k) /= merge(1, -1, half_trace > 0)) wrong = wrong + 1
          end if
        end associate
      end do
    end do
    call check_true(t, 'some are real and beyond 1', any(map%modulus > 1 .and. map%sense == -1) .and. &
                    any(map%modulus > 1 .and. map%sense == 1))
    call check_close(t, 'complex pairs', worst(1), 0.0_dp, absolute=1e-13_dp)
    call check_close(t, 'real multipliers', worst(2), 0.0_dp, absolute=1e-9_dp)
    call check_equal(t, 'of another kind', wrong, 0)

  contains

    subroutine exact(rpm, zeta, half_trace, determinant)
      real(dp), intent(in) :: rpm, zeta
      real(dp), intent(out) :: half_trace, determinant
      real(dp) :: part(2, 2), whole(2, 2), w, angle, root
      integer :: pairs

      root = sqrt(1 - zeta**2)
      whole = reshape([1, 0, 0, 1], [2, 2])
      determinant = 1
      do pairs = 2, 1, -1
        w = sqrt(pairs*400e6_dp*2/0.8_dp)
        angle = w*mesh_period(25, rpm)*merge(0.6_dp, 0.4_dp, pairs == 2)
        part = exp(-zeta*angle)*reshape([cos(root*angle) + zeta/root*sin(root*angle), -w/root*sin(root*angle), &
                                         sin(root*angle)/(w*root), cos(root*angle) - zeta/root*sin(root*angle)], [2, 2])
        whole = matmul(part, whole)
        determinant = determinant*exp(-2*zeta*angle)
      end do
      half_trace = (whole(1, 1) + whole(2, 2))/2
    end subroutine exact
  end subroutine meissner_map

  !> At a contact ratio of sqrt(2) the natural motion turns by the same angle in both smooth intervals; where that is
  !> pi, the map is 1 times itself: the second tongue has no width.
  subroutine coexistence(t)
    type(tally_t), intent(inout) :: t
    type(tongue_t) :: tongue(3)
    type(error_t), allocatable :: error

    call find_tongues(mesh_of(sqrt(2.0_dp), [400.0_dp]), [0.0_dp, 0.01_dp], tongue, error)
    call check_true(t, 'no second tongue', all(ieee_is_nan(tongue(2)%edge)))
    call check_close(t, 'closed without damping', tongue(2)%closing_damping, 0.0_dp, absolute=0.0_dp)
    call check_close(t, 'where it would be', tongue(2)%closing_rpm, &
                     60/25.0_dp*sqrt(400e6_dp*2/0.8_dp)*(2 - sqrt(2.0_dp))/pi, relative=1e-6_dp)
    call check_true(t, 'the others are open', .not. any(ieee_is_nan([tongue(1)%edge, tongue(3)%edge(:, 1)])))
  end subroutine coexistence

  !> A mesh stiffness of k (1 + depth cos(2 pi tau)), from two pairs of half of that: Mathieu's equation.
  !> Between its edges and values beside them Hill's determinant of the Fourier coefficients changes sign.
  subroutine mathieu_tongues(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: depth = 0.4_dp, stiffness = 500e6_dp, margin = 1e-10_dp
    type(oscillator_t) :: osc
    type(tongue_t) :: tongue(4)
    type(error_t), allocatable :: error
    real(dp) :: cosine(0:40), beside(2), square
    integer :: n, side, sense, k

    ! Taylor's series of cos(2 pi s) about the middle of [0, 2].
    cosine = 0
    cosine(0) = 1
    do k = 2, 40, 2
      cosine(k) = -cosine(k - 2)*(2*pi)**2/(k*(k - 1))
    end do
    osc = mesh_of(2.0_dp, [250.0_dp])
    osc%mesh%stiffness = polynomial(0.0_dp, 2.0_dp, stiffness/2*([1.0_dp, spread(0.0_dp, 1, 40)] + depth*cosine))
    call make_oscillator(osc, error)
    call find_tongues(osc, [0.0_dp], tongue, error)
    call check_no_error(t, 'Mathieu', error)
    square = stiffness*sum(1/osc%mass)
    do n = 1, size(tongue)
      do side = 1, 2
        associate (edge => tongue(n)%edge(side, 1))
          ! Of the even and the odd solution, whichever is periodic here.
          do sense = -1, 1, 2
            beside = [(hill_determinant(n, sense, square*(mesh_period(25, edge*(1 + k*margin))/pi)**2), k=-1, 1, 2)]
            if (beside(1)*beside(2) < 0) exit
          end do
          call check_true(t, 'tongue '//str(n)//', edge '//str(side), sense <= 1)
        end associate
      end do
      call check_true(t, 'tongue '//str(n)//' is wider', tongue(n)%edge(2, 1) > tongue(n)%edge(1, 1)*(1 + 1e-4_dp))
    end do

  contains

    !> Of y" + a (1 + depth cos 2z) y = 0 for sum of c_m cos m z (sense 1) or sin m z (-1), m = n modulo 2.
    pure real(dp) function hill_determinant(n, sense, a) result(this)
      integer, intent(in) :: n, sense
      real(dp), intent(in) :: a
      integer, parameter :: terms = 40
      real(dp) :: off, before, next
      integer :: m, first

      off = a*depth/2
      first = modulo(n, 2)
      if (first == 0 .and. sense == -1) first = 2
      before = 1
      this = 0
      do m = first, first + 2*terms, 2
        ! Rows divided by m^2 + 1, so that nothing overflows.
        next = (a - m**2 + merge(sense*off, 0.0_dp, m == 1))/(m**2 + 1.0_dp)
        if (m > first) then
          ! cos 0 takes part in row 2 twice.
          next = next*this - merge(2, 1, m == 2 .and. first == 0)*off**2/((m**2 + 1.0_dp)*((m - 2)**2 + 1.0_dp))*before
          before = this
        end if
        this = next
      end do
    end function hill_determinant
  end subroutine mathieu_tongues

  !> Whatever the stiffness, with friction: beside an edge the map's modulus passes 1, by a multiplier of
  !> the tongue's sign.
  subroutine edges_of_a_curved_stiffness(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: damping(2) = [0.0_dp, 0.01_dp]
    type(tongue_t) :: tongue(4)
    type(oscillator_t) :: osc
    type(stability_t) :: map
    type(error_t), allocatable :: error
    real(dp) :: margin
    integer :: n, k

    osc = curved(0.05_dp)
    call find_tongues(osc, damping, tongue, error)
    call check_no_error(t, 'curved stiffness', error)
    do n = 1, size(tongue)
      do k = 1, size(damping)
        if (damping(k) > tongue(n)%closing_damping) cycle
        associate (edge => tongue(n)%edge(:, k))
          margin = 1e-3_dp*(edge(2) - edge(1))
          call map_stability(osc, [edge(1) - margin, edge(1) + margin, edge(2) - margin, edge(2) + margin], &
                             damping(k:k), 1e-12_dp, map)
        end associate
        call check_true(t, 'tongue '//str(n), all(map%modulus([2, 3], 1) > 1 + 1e-9_dp) .and. &
                        all(map%modulus([1, 4], 1) < 1 + 1e-9_dp) .and. all(map%sense([2, 3], 1) == (-1)**n))
      end do
    end do
    call check_true(t, 'tongues at both dampings', tongue(1)%closing_damping > damping(2))
  end subroutine edges_of_a_curved_stiffness

  !> With friction, and a relief that all pairs keep in contact.
  type(oscillator_t) function curved(zeta, relief) result(osc)
    real(dp), intent(in) :: zeta
    real(dp), intent(in), optional :: relief
    type(error_t), allocatable :: error
    real(dp) :: amount

    amount = 0
    if (present(relief)) amount = relief
    call prescribed(1.6_dp, [400.0_dp, 30.0_dp, -110.0_dp], amount*[1.0_dp, 1.0_dp], 1, osc)
    osc%mesh%teeth = [25, 31]
    osc%mesh%pitch_point = 0.7_dp
    osc%mesh%tan_angle = tan(20*pi/180)
    osc%mass = [0.8_dp, 1.1_dp]
    osc%load = 7000
    osc%friction = 0.08_dp
    osc%damping_ratio = zeta
    call make_oscillator(osc, error)
    if (allocated(error)) error stop 'curved stiffness'
  end function curved

  !> The multipliers of the sweep's own motions, where all pairs stay in contact.
  subroutine same_as_the_sweep(t)
    type(tally_t), intent(inout) :: t
    type(oscillator_t) :: osc(1)
    type(sweep_options_t) :: options
    type(sweep_t) :: sweep
    type(stability_t) :: map
    type(error_t), allocatable :: error
    logical, allocatable :: full(:)
    real(dp) :: rpm(60)
    integer :: i

    osc(1) = curved(0.15_dp, 5.0_dp)
    rpm = [(500*i, i=1, size(rpm))]
    options%direction = each
    options%accuracy%steady%tolerance = 1e-10_dp
    call run_sweep(osc, rpm, options, sweep, error)
    call map_stability(osc(1), rpm, [0.15_dp], 1e-10_dp, map)
    full = sweep%contact(:, 1) == contact_full .and. rpm > 3000
    call check_true(t, 'speeds to compare', count(full) > 40)
    call check_close(t, 'multipliers', maxval(abs(sweep%multiplier(:, 1) - map%modulus(:, 1)), mask=full), 0.0_dp, &
                     absolute=1e-8_dp)
  end subroutine same_as_the_sweep

  !> The same bits.
  subroutine load_and_relief_drop_out(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: rpm(3) = [9000, 16000, 31000]
    type(oscillator_t) :: osc
    type(stability_t) :: one, other
    type(error_t), allocatable :: error

    call map_stability(curved(0.0_dp), rpm, [0.02_dp], 1e-10_dp, one)
    osc = curved(0.3_dp, 20.0_dp)
    osc%load = 10
    call make_oscillator(osc, error)
    call map_stability(osc, rpm, [0.02_dp], 1e-10_dp, other)
    call check_true(t, 'load, relief and own damping drop out', all(transfer(one%modulus, [0]) == transfer(other%modulus, [0])))
  end subroutine load_and_relief_drop_out

  !> Speeds that no number of steps would do for get no number; the others are not harmed.
  subroutine too_slow(t)
    type(tally_t), intent(inout) :: t
    type(stability_t) :: map

    call map_stability(mesh_of(1.6_dp, [400.0_dp]), [1e-3_dp], [0.1_dp], 1e-10_dp, map)
    call check_true(t, 'too slow', ieee_is_nan(map%modulus(1, 1)))
    call map_stability(mesh_of(1.6_dp, [400.0_dp]), [1e-3_dp, 30000.0_dp], [0.1_dp], 1e-10_dp, map)
    call check_true(t, 'fast enough', .not. ieee_is_nan(map%modulus(2, 1)))
  end subroutine too_slow
end module test_stability
