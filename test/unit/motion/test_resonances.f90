!> Resonances in a curve of dynamic factors: which maxima stand out, and the parabola through each.
!> These tests matter most as released: an optimiser once took the two sides of a maximum for one.
module test_resonances
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
  use gearsweep_study_case_case, only: case_t
  use gearsweep_api_case_reader, only: read_case
  use gearsweep_base_error, only: error_t
  use gearsweep_study_run_files, only: read_text
  use gearsweep_base_kinds, only: dp
  use gearsweep_motion_optimum, only: find_resonances, peak_t
  use gearsweep_study_run_study, only: run_study, study_t
  use gearsweep_api_tables, only: column_of
  use gearsweep_base_text, only: str
  use test_support_random_numbers, only: random_t
  use test_support_testing, only: tally_t, check_true, check_close, check_equal, check_no_error
  implicit none
  private
  public :: run

  !> What a maximum must stand out by, and how many are listed.
  real(dp), parameter :: prominence = 0.01_dp
  integer, parameter :: most = 5
  real(dp), parameter :: none = -huge(1.0_dp)

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('sides_of_a_maximum')) call sides_of_a_maximum(t)
    if (t%wants('random_curves')) call random_curves(t)
    if (t%wants('parabolas')) call parabolas(t)
    if (t%wants('case_2_has_none_at_666_rpm')) call case_2_has_none_at_666_rpm(t)
  end subroutine run

  !> Does the maximum at `i` stand out, by the definition: to the left and to the right there is a place
  !> that lies lower by the prominence, with nothing in between that is higher than the maximum? Points
  !> without an answer are passed over (`none`: comparing NaN would trap).
  pure logical function stands_out(y, i)
    real(dp), intent(in) :: y(:)
    integer, intent(in) :: i
    integer :: j

    stands_out = any([(is_fall(y(j:i)), j=1, i - 1)]) .and. any([(is_fall(y(j:i:-1)), j=size(y), i + 1, -1)])

  contains

    !> For a piece that ends at the maximum.
    pure logical function is_fall(piece)
      real(dp), intent(in) :: piece(:)

      is_fall = piece(1) > none .and. piece(1) <= y(i) - prominence .and. all(piece <= y(i))
    end function is_fall
  end function stands_out

  !> All maxima that stand out, by the definition.
  pure function places(curve) result(place)
    real(dp), intent(in) :: curve(:)
    integer, allocatable :: place(:)
    real(dp) :: y(size(curve))
    integer :: i

    y = merge(none, curve, ieee_is_nan(curve))
    place = pack([(i, i=2, size(y) - 1)], [(is_maximum(y(i - 1:i + 1)) .and. stands_out(y, i), i=2, size(y) - 1)])
  end function places

  !> The first one of a plateau counts.
  pure logical function is_maximum(y)
    real(dp), intent(in) :: y(3)

    is_maximum = y(1) < y(2) .and. y(3) <= y(2) .and. all(y > none)
  end function is_maximum

  !> The smallest curves: a fall of 1 on one side, of 0.005 or 0.02 on the other.
  subroutine sides_of_a_maximum(t)
    type(tally_t), intent(inout) :: t

    call check_count('nothing to the left', [1.995_dp, 2.0_dp, 1.0_dp], 0)
    call check_count('nothing to the right', [1.0_dp, 2.0_dp, 1.995_dp], 0)
    call check_count('both sides', [1.98_dp, 2.0_dp, 1.0_dp], 1)
    call check_count('shoulder of a rise', [1.0_dp, 2.0_dp, 1.995_dp, 3.0_dp], 0)
    call check_count('shoulder of a fall', [3.0_dp, 1.995_dp, 2.0_dp, 1.0_dp], 0)
    call check_count('two of the same height', [1.0_dp, 2.0_dp, 1.98_dp, 2.0_dp, 1.0_dp], 2)
    call check_count('plateau', [1.0_dp, 2.0_dp, 2.0_dp, 1.0_dp], 1)
    call check_count('monotone', [1.0_dp, 2.0_dp, 3.0_dp], 0)
    call check_count('two points', [1.0_dp, 2.0_dp], 0)
    call check_count('none', [real(dp) ::], 0)

  contains

    subroutine check_count(name, y, expected)
      character(*), intent(in) :: name
      real(dp), intent(in) :: y(:)
      integer, intent(in) :: expected
      type(peak_t), allocatable :: peaks(:)
      integer :: i

      peaks = find_resonances([(real(i, dp), i=1, size(y))], y)
      call check_equal(t, name, size(peaks), expected)
    end subroutine check_count
  end subroutine sides_of_a_maximum

  !> Random curves of whole multiples of 1/1024, of which none lies at the prominence: no comparison hangs
  !> on rounding. Coarse ones have plateaus and equal heights, some have points without an answer.
  subroutine random_curves(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: curves = 3000
    type(random_t) :: random
    integer :: k, counts, heights, listed

    random%seed = 666
    counts = 0
    heights = 0
    listed = 0
    do k = 1, curves
      call one_curve(3 + int(38*random%uniform()), int(random%power(5.0_dp, 200.0_dp)), merge(0.05_dp, 0.0_dp, mod(k, 3) == 0))
    end do
    call check_equal(t, 'curves with a wrong number of resonances, of '//str(curves), counts, 0)
    call check_equal(t, 'curves with wrong resonances, of '//str(curves), heights, 0)
    call check_true(t, 'there are resonances to find', listed > curves)

  contains

    subroutine one_curve(points, steps, missing)
      integer, intent(in) :: points, steps
      real(dp), intent(in) :: missing
      real(dp), allocatable :: y(:)
      type(peak_t), allocatable :: peaks(:)
      integer, allocatable :: place(:)
      integer :: i

      allocate (y(points))
      do i = 1, points
        y(i) = 1 + int(steps*random%uniform())/1024.0_dp
        if (random%uniform() < missing) y(i) = ieee_value(1.0_dp, ieee_quiet_nan)
      end do
      peaks = find_resonances([(100.0_dp*i, i=1, points)], y)
      place = places(y)
      if (size(peaks) /= min(size(place), most)) counts = counts + 1
      if (.not. are_those(peaks, y, place)) heights = heights + 1
      listed = listed + size(peaks)
    end subroutine one_curve
  end subroutine random_curves

  !> Is every resonance one of the maxima at `place`, by speed, and no maximum left out that is higher than
  !> one listed? A parabola's vertex lies within half a step of the middle point, not below it and above it
  !> by at most an eighth of the larger fall to a neighbour.
  pure logical function are_those(peaks, y, place)
    type(peak_t), intent(in) :: peaks(:)
    real(dp), intent(in) :: y(:)
    integer, intent(in) :: place(:)
    logical :: is_listed(size(place))
    real(dp) :: height
    integer :: k

    are_those = all(peaks(2:)%rpm > peaks(:size(peaks) - 1)%rpm)
    is_listed = .false.
    do k = 1, size(peaks)
      associate (near => abs(100.0_dp*place - peaks(k)%rpm) <= 50*(1 + 1e-12_dp) .and. .not. is_listed)
        if (count(near) == 0) then
          are_those = .false.
          cycle
        end if
        associate (i => place(findloc(near, .true., 1)))
          is_listed(findloc(near, .true., 1)) = .true.
          height = peaks(k)%dynamic_factor - y(i)
          are_those = are_those .and. height >= 0 .and. height <= (y(i) - min(y(i - 1), y(i + 1)))/8*(1 + 1e-12_dp) + 1e-15_dp
        end associate
      end associate
    end do
    ! Listed are the highest vertices, which stand above their points by less than an eighth of a step's fall.
    if (size(place) > most .and. are_those) are_those = all(pack(vertices(), .not. is_listed) <= minval(peaks%dynamic_factor))

  contains

    !> Of the parabolas through three points, one unit apart: y - b**2/(2 c) with slope b and curvature c.
    pure function vertices() result(top)
      real(dp) :: top(size(place))

      associate (left => y(place - 1), middle => y(place), right => y(place + 1))
        top = middle + ((right - left)/2)**2/(2*(2*middle - left - right))
        ! Two vertices of one height may differ in their last bits: those are no order.
        top = top*(1 - 1e-14_dp)
      end associate
    end function vertices
  end function are_those

  !> Three points of a parabola give its vertex, at any distances: closed form.
  subroutine parabolas(t)
    type(tally_t), intent(inout) :: t
    type(peak_t), allocatable :: peaks(:)
    type(random_t) :: random
    real(dp) :: top, height, fall, rpm(3)
    integer :: k

    random%seed = 7
    do k = 1, 20
      top = random%between(3000.0_dp, 9000.0_dp)
      height = random%between(1.1_dp, 2.0_dp)
      ! The middle point lies nearer to the vertex than the others.
      rpm = top + [-random%between(60.0_dp, 150.0_dp), random%between(-50.0_dp, 50.0_dp), random%between(60.0_dp, 150.0_dp)]
      fall = random%power(1e-5_dp, 1e-4_dp)
      peaks = find_resonances(rpm, height - fall*(rpm - top)**2)
      call check_equal(t, 'one vertex', size(peaks), 1)
      if (size(peaks) /= 1) cycle
      call check_close(t, 'speed of the vertex', peaks(1)%rpm, top, absolute=1e-6_dp)
      call check_close(t, 'height of the vertex', peaks(1)%dynamic_factor, height, absolute=1e-10_dp)
    end do
  end subroutine parabolas

  !> Between 600 and 720 rpm the curve of case 2 is a shoulder of a fall. Where its resonances are is
  !> asked of the definition.
  subroutine case_2_has_none_at_666_rpm(t)
    type(tally_t), intent(inout) :: t
    type(case_t) :: case
    type(study_t) :: study
    type(error_t), allocatable :: error
    character(:), allocatable :: text
    real(dp), allocatable :: factor(:), resonance(:)

    call read_text('data/case2.nml', text, error)
    call check_no_error(t, 'case 2', error)
    call read_case(text, case, error)
    call check_no_error(t, 'case 2', error)
    call run_study(case, 'data/', 2, study, error)
    call check_no_error(t, 'case 2', error)
    if (allocated(error)) return
    factor = column_of(study, 'sweep', 'dynamic_factor')
    resonance = column_of(study, 'resonances', 'resonance_rpm')
    resonance = resonance(:size(resonance)/size(study%amount))
    call check_true(t, 'case 2 has no resonance at 666 rpm', .not. any(abs(resonance - 666) < 60))
    associate (expected => places(factor(:size(study%rpm))))
      call check_true(t, 'case 2 has resonances, few enough to list all', size(expected) > 0 .and. size(expected) <= most)
      call check_equal(t, 'resonances of case 2', size(resonance), size(expected))
      if (size(resonance) == size(expected)) call check_true(t, 'their speeds', &
        all(abs(resonance - study%rpm(expected)) <= 30))
    end associate
  end subroutine case_2_has_none_at_666_rpm
end module test_resonances
