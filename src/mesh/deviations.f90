!> Deviations of real teeth as profile errors on the line of action: a polynomial for each tooth, and waves over the rotation.
!>
!> Pair k, k = ..., -1, 0, 1, ..., enters at A at the time k (in mesh periods). It is on tooth k mod z1 of the pinion and tooth
!> (k + offset) mod z2 of the gear, both counted from 0 in the order in which they engage. Its profile error at the path
!> coordinate s is the nominal one and
!>
!>     p_i(s) + g_j(s) + w(tau),  p_i(s) = sum over n of c_n (s - contact ratio/2)^n,  g_j likewise,
!>     w = sum of a sin(2 pi o tau/z + phase).
!>
!> The waves of the gear are those of its tooth 0, so that their time is tau + offset. A positive error separates the flanks.
!> Beyond A and E, where a tip corner touches, the polynomials keep their value at A or E.
!>
!> A tooth with a position error moves its coast flank with its drive flank: the length that is added to the distance of the drive
!> flanks of its pair is subtracted from the distance of its coast flank to the mate. While the pair k is between A and E, the
!> neighbouring coast flanks may touch: of the pinion's tooth k, which is in the space between the gear's teeth k and k + 1, and
!> of the gear's tooth k + 1. An eccentric gear moves all its coast flanks, as described by the coast waves. Profiles of coast
!> flanks are nominal. The errors repeat after an integer number of mesh periods, the turn: the least common multiple of the
!> numbers of teeth, or the number of teeth of the gear if it alone deviates. A smooth interval is a part of the mesh period
!> without a break of any coefficient.
module gearsweep_mesh_deviations
  use gearsweep_base, only: dp, pi, sorted
  implicit none
  private
  public :: deviations_t, wave_t, make_deviations, common_divisor, length_of_turn, interval_t, distinct_phases, phase_of

  type :: wave_t
    integer :: gear = 1                !< 1: pinion, 2: gear
    integer :: order = 1               !< waves per turn of this gear
    real(dp) :: amplitude = 0          !< m
    real(dp) :: phase = 0              !< phase at which tooth 0 enters at A, rad
  end type wave_t

  type :: deviations_t
    integer :: periods = 1             !< mesh periods after which the errors repeat
    integer :: teeth(2) = 1            !< numbers of teeth of pinion and gear
    integer :: offset = 0              !< number, from 0, of the gear's tooth that meets the pinion's tooth 0 at tau = 0
    !> Coefficients c_n, m; (0:degree, tooth). Not allocated if no tooth of the gear deviates.
    real(dp), allocatable :: pinion(:, :), gear(:, :)
    type(wave_t), allocatable :: waves(:)
    !> Shift of a tooth's coast flank towards its mate by the tooth's position error, m; (tooth). Not allocated if no tooth of the
    !> gear has one.
    real(dp), allocatable :: pinion_place(:), gear_place(:)
    type(wave_t), allocatable :: coast_waves(:)  !< change of the distance of the coast flanks; not more waves than in `waves`
  contains
    procedure :: any => deviate
    procedure :: moves_coast
    procedure :: coast_of_pair
    procedure :: coast_wave_at
    procedure :: rates
    procedure :: amplitudes_in
    procedure :: coast_nearer
    procedure :: largest_of_coast
    procedure :: of_both_teeth
    procedure :: of_pair
    procedure :: wave_at
    procedure :: largest
  end type deviations_t

  !> Smooth interval: a part of the mesh period within which no coefficient has a break. If pairs of teeth have errors of their
  !> own, a part of one of the mesh periods after which these repeat.
  type :: interval_t
    integer :: period = 0                        !< index of the mesh period from 0
    real(dp) :: first = 0, last = 0              !< phases of its ends
    integer :: pairs = 0                         !< number of pairs that may be in contact
    integer :: offset = 0                        !< path coordinate of the first of them minus the phase
    integer, allocatable :: piece(:, :)          !< first and last piece of the profile error; (2, pair)
    integer, allocatable :: stiffness_piece(:, :)    !< first and last piece of the stiffness; (2, pair)
    logical, allocatable :: recess(:)            !< the pair has passed the pitch point
    logical, allocatable :: between(:)           !< the pair is between A and E
    !> Compliance shared by a pair and the next one (m/N), as a polynomial of the phase; (0:2, pair but the last, at least one).
    real(dp), allocatable :: shared(:, :)
    logical, allocatable :: carries(:)           !< pairs of the reference contact: all, or those that carry a static load
    !> Deviation of each pair's profile error due to its teeth (m), as a polynomial of s; (0:degree, pair). Not allocated if no
    !> tooth deviates.
    real(dp), allocatable :: deviation(:, :)
    !> Deviation of the distance of the coast flanks next to each pair due to the positions of their teeth (m); (pair). Not
    !> allocated if no tooth deviates.
    real(dp), allocatable :: coast(:)
  contains
    procedure :: place
    procedure :: shared_at
    procedure :: shared_with_slopes
    procedure :: add_deviation
  end type interval_t

  !> Breaks closer than this count as one: no step could separate them.
  real(dp), parameter :: same_phase = 1e-11_dp

contains

  !> Builds the deviations of these teeth and waves.
  pure function make_deviations(teeth, pinion, gear, waves, offset, pinion_place, gear_place, coast_waves) result(deviations)
    integer, intent(in) :: teeth(2)              !< numbers of teeth of pinion and gear
    real(dp), intent(in) :: pinion(0:, :), gear(0:, :)     !< c_n, m; (0:degree, tooth); without teeth if none deviates
    type(wave_t), intent(in) :: waves(:)
    integer, intent(in) :: offset                !< as in deviations_t
    real(dp), intent(in), optional :: pinion_place(:), gear_place(:)   !< as in deviations_t; if absent, all are 0
    type(wave_t), intent(in), optional :: coast_waves(:)   !< as in deviations_t; if absent, there are none
    type(deviations_t) :: deviations

    deviations%teeth = teeth
    deviations%offset = offset
    if (size(pinion, 2) > 0) then
      allocate (deviations%pinion(0:ubound(pinion, 1), teeth(1)))
      deviations%pinion = pinion
    end if
    if (size(gear, 2) > 0) then
      allocate (deviations%gear(0:ubound(gear, 1), teeth(2)))
      deviations%gear = gear
    end if
    deviations%waves = waves
    allocate (deviations%coast_waves(0))
    if (present(coast_waves)) deviations%coast_waves = coast_waves
    if (present(pinion_place)) then
      if (any(abs(pinion_place) > 0)) deviations%pinion_place = pinion_place
    end if
    if (present(gear_place)) then
      if (any(abs(gear_place) > 0)) deviations%gear_place = gear_place
    end if
    deviations%periods = nint(length_of_turn(teeth, [size(pinion, 2) > 0 .or. any(waves%gear == 1), &
                                                     size(gear, 2) > 0 .or. any(waves%gear == 2)]))
  end function make_deviations

  !> Mesh periods after which deviations of pinion and gear repeat, as a real number, which may exceed the largest integer.
  pure real(dp) function length_of_turn(teeth, deviates) result(periods)
    integer, intent(in) :: teeth(2)
    logical, intent(in) :: deviates(2)

    periods = product(real(teeth, dp), mask=deviates)
    if (all(deviates)) periods = periods/common_divisor(teeth(1), teeth(2))
  end function length_of_turn

  !> Greatest common divisor of two numbers above 0, by Euclid's algorithm.
  pure integer function common_divisor(a, b)
    integer, intent(in) :: a, b
    integer :: remainder, next

    common_divisor = a
    remainder = b
    do while (remainder > 0)
      next = modulo(common_divisor, remainder)
      common_divisor = remainder
      remainder = next
    end do
  end function common_divisor

  !> True if there is any deviation.
  pure logical function deviate(self)
    class(deviations_t), intent(in) :: self

    deviate = allocated(self%waves)
  end function deviate

  !> True if coast flanks deviate.
  pure logical function moves_coast(self)
    class(deviations_t), intent(in) :: self

    moves_coast = allocated(self%pinion_place) .or. allocated(self%gear_place)
    if (self%any()) moves_coast = moves_coast .or. size(self%coast_waves) > 0
  end function moves_coast

  !> Deviation of the distance of the coast flanks next to the pair with this number, due to the positions of their teeth, m.
  pure real(dp) function coast_of_pair(self, number) result(e)
    class(deviations_t), intent(in) :: self
    integer, intent(in) :: number                !< number k of the pair

    e = 0
    if (allocated(self%pinion_place)) e = e - self%pinion_place(1 + modulo(number, self%teeth(1)))
    if (allocated(self%gear_place)) e = e - self%gear_place(1 + modulo(number + 1 + self%offset, self%teeth(2)))
  end function coast_of_pair

  !> Upper bound of the reduction of the distance of coast flanks in a mesh period, m.
  pure real(dp) function coast_nearer(self, period, pairs) result(nearer)
    class(deviations_t), intent(in) :: self
    integer, intent(in) :: period
    integer, intent(in) :: pairs                 !< largest number of pairs that may be in contact
    real(dp) :: w(0:2, 2)
    integer :: k

    w(:, 1) = self%coast_wave_at(period, 0.0_dp)
    w(:, 2) = self%coast_wave_at(period, 1.0_dp)
    nearer = -minval([(self%coast_of_pair(k), k=period - pairs, period + 1)]) - minval(w(0, :))
    ! Largest distance of the wave from its chord.
    do k = 1, size(self%coast_waves)
      associate (wave => self%coast_waves(k))
        nearer = nearer + abs(wave%amplitude)*(2*pi*wave%order/self%teeth(wave%gear))**2/8
      end associate
    end do
  end function coast_nearer

  !> Upper bound of the size of the deviations of coast flanks, m.
  pure real(dp) function largest_of_coast(self) result(largest)
    class(deviations_t), intent(in) :: self

    largest = 0
    if (.not. self%moves_coast()) return
    largest = sum(abs(self%coast_waves%amplitude))
    if (allocated(self%pinion_place)) largest = largest + maxval(abs(self%pinion_place))
    if (allocated(self%gear_place)) largest = largest + maxval(abs(self%gear_place))
  end function largest_of_coast

  !> Computes the polynomial (m) of the pair with this number over s - contact ratio/2, the sum of both teeth's; (0:degree).
  pure subroutine of_both_teeth(self, number, c)
    class(deviations_t), intent(in) :: self
    integer, intent(in) :: number                !< number k of the pair
    real(dp), allocatable, intent(out) :: c(:)
    integer :: degree, n

    degree = 0
    if (allocated(self%pinion)) degree = ubound(self%pinion, 1)
    if (allocated(self%gear)) degree = max(degree, ubound(self%gear, 1))
    allocate (c(0:degree), source=0.0_dp)
    if (allocated(self%pinion)) then
      n = ubound(self%pinion, 1)
      c(:n) = c(:n) + self%pinion(:, 1 + modulo(number, self%teeth(1)))
    end if
    if (allocated(self%gear)) then
      n = ubound(self%gear, 1)
      c(:n) = c(:n) + self%gear(:, 1 + modulo(number + self%offset, self%teeth(2)))
    end if
  end subroutine of_both_teeth

  !> Polynomial (m) of the pair with this number, about s = 0; (0:degree). A constant beyond A and E.
  pure function of_pair(self, number, contact_ratio, s) result(c)
    class(deviations_t), intent(in) :: self
    integer, intent(in) :: number                !< number k of the pair
    real(dp), intent(in) :: contact_ratio
    real(dp), intent(in) :: s                    !< path coordinate in the interval where it is used
    real(dp), allocatable :: c(:)
    real(dp) :: centre
    integer :: degree, i, n

    call self%of_both_teeth(number, c)
    degree = ubound(c, 1)
    if (s < 0 .or. s > contact_ratio) then
      centre = sign(contact_ratio/2, s)
      c(0) = sum([(c(i)*centre**i, i=0, degree)])
      c(1:) = 0
      return
    end if
    ! Taylor shift by Horner's scheme: from powers of s - contact ratio/2 to powers of s.
    do i = 0, degree - 1
      do n = degree - 1, i, -1
        c(n) = c(n) - contact_ratio/2*c(n + 1)
      end do
    end do
  end function of_pair

  !> Waves (m) at a time, with their first and second derivative over it; (0:2).
  pure function wave_at(self, period, phase) result(w)
    class(deviations_t), intent(in) :: self
    integer, intent(in) :: period                !< complete mesh periods of the time
    real(dp), intent(in) :: phase                !< fraction of the next mesh period
    real(dp) :: w(0:2)

    w = sum_of(self, self%waves, period, phase)
  end function wave_at

  !> Coast waves (m) at a time, with their first and second derivative over it; (0:2).
  pure function coast_wave_at(self, period, phase) result(w)
    class(deviations_t), intent(in) :: self
    integer, intent(in) :: period                !< complete mesh periods of the time
    real(dp), intent(in) :: phase                !< fraction of the next mesh period
    real(dp) :: w(0:2)

    w = sum_of(self, self%coast_waves, period, phase)
  end function coast_wave_at

  pure function sum_of(self, waves, period, phase) result(w)
    type(deviations_t), intent(in) :: self
    type(wave_t), intent(in) :: waves(:)
    integer, intent(in) :: period
    real(dp), intent(in) :: phase
    real(dp) :: w(0:2), rate, angle
    integer :: i

    w = 0
    do i = 1, size(waves)
      rate = rate_of(self, waves(i))
      angle = angle_at(self, waves(i), period) + rate*phase
      w = w + waves(i)%amplitude*[sin(angle), rate*cos(angle), -rate**2*sin(angle)]
    end do
  end function sum_of

  !> Rates r of the waves, then of the coast waves, rad per mesh period; of size 0 without deviations.
  pure function rates(self) result(r)
    class(deviations_t), intent(in) :: self
    real(dp), allocatable :: r(:)
    integer :: i

    allocate (r(0))
    if (.not. self%any()) return
    r = [(rate_of(self, self%waves(i)), i=1, size(self%waves)), (rate_of(self, self%coast_waves(i)), i=1, size(self%coast_waves))]
  end function rates

  !> Amplitudes a (m) in one mesh period of the waves, then of the coast waves: a wave is a_1 cos(r phase) + a_2 sin(r phase) with
  !> its rate r; (2, wave).
  pure subroutine amplitudes_in(self, period, a)
    class(deviations_t), intent(in) :: self
    integer, intent(in) :: period                !< index from 0
    real(dp), intent(out) :: a(:, :)
    integer :: i, n

    n = size(self%waves)
    do i = 1, n
      a(:, i) = amplitude_in(self, self%waves(i), period)
    end do
    do i = 1, size(self%coast_waves)
      a(:, n + i) = amplitude_in(self, self%coast_waves(i), period)
    end do
  end subroutine amplitudes_in

  pure function amplitude_in(self, wave, period) result(a)
    type(deviations_t), intent(in) :: self
    type(wave_t), intent(in) :: wave
    integer, intent(in) :: period
    real(dp) :: a(2), angle

    angle = angle_at(self, wave, period)
    a = wave%amplitude*[sin(angle), cos(angle)]
  end function amplitude_in

  !> Rate of a wave, rad per mesh period.
  pure real(dp) function rate_of(self, wave) result(rate)
    type(deviations_t), intent(in) :: self
    type(wave_t), intent(in) :: wave

    rate = 2*pi*wave%order/self%teeth(wave%gear)
  end function rate_of

  !> Phase angle of a wave at the start of a mesh period, rad.
  pure real(dp) function angle_at(self, wave, period) result(angle)
    type(deviations_t), intent(in) :: self
    type(wave_t), intent(in) :: wave
    integer, intent(in) :: period                ! index from 0

    angle = rate_of(self, wave)*modulo(period + merge(self%offset, 0, wave%gear == 2), self%teeth(wave%gear)) + wave%phase
  end function angle_at

  !> Upper bound of the size of the errors, m.
  pure real(dp) function largest(self, contact_ratio)
    class(deviations_t), intent(in) :: self
    real(dp), intent(in) :: contact_ratio
    integer :: n

    largest = 0
    if (.not. self%any()) return
    largest = sum(abs(self%waves%amplitude))
    if (allocated(self%pinion)) largest = largest + maxval(matmul([((contact_ratio/2)**n, n=0, ubound(self%pinion, 1))], &
                                                                   abs(self%pinion)))
    if (allocated(self%gear)) largest = largest + maxval(matmul([((contact_ratio/2)**n, n=0, ubound(self%gear, 1))], &
                                                               abs(self%gear)))
  end function largest

  !> Path coordinate of pair j of an interval.
  elemental real(dp) function place(interval, phase, j) result(s)
    class(interval_t), intent(in) :: interval
    real(dp), intent(in) :: phase
    integer, intent(in) :: j

    s = phase + (j + interval%offset) - 1
  end function place

  !> Compliance shared by each pair of an interval and the next one, m/N; (pair but the last, at least one).
  pure function shared_at(interval, phase) result(shared)
    class(interval_t), intent(in) :: interval
    real(dp), intent(in) :: phase
    real(dp) :: shared(size(interval%shared, 2))

    shared = interval%shared(0, :) + phase*(interval%shared(1, :) + phase*interval%shared(2, :))
  end function shared_at

  !> Compliance shared by each pair of an interval and the next one, with its first and second derivative over the phase, m/N;
  !> (0:2, pair but the last, at least one).
  pure function shared_with_slopes(interval, phase) result(c)
    class(interval_t), intent(in) :: interval
    real(dp), intent(in) :: phase
    real(dp) :: c(0:2, size(interval%shared, 2))

    c(0, :) = interval%shared_at(phase)
    c(1, :) = interval%shared(1, :) + 2*phase*interval%shared(2, :)
    c(2, :) = 2*interval%shared(2, :)
  end function shared_with_slopes

  !> Adds the deviation of the profile error of pair j due to its teeth, without waves, at some phases.
  pure subroutine add_deviation(interval, phase, j, d)
    class(interval_t), intent(in) :: interval    !< with deviations
    real(dp), intent(in) :: phase(:)
    integer, intent(in) :: j
    real(dp), intent(inout) :: d(0:, :)          !< m, with its first and second derivative over the phase; (0:2, phase)
    real(dp) :: s, p(0:2)
    integer :: k, n

    do k = 1, size(phase)
      s = interval%place(phase(k), j)
      p = 0
      do n = ubound(interval%deviation, 1), 0, -1
        p(2) = p(2)*s + 2*p(1)
        p(1) = p(1)*s + p(0)
        p(0) = p(0)*s + interval%deviation(n, j)
      end do
      d(:, k) = d(:, k) + p
    end do
  end subroutine add_deviation

  !> Mesh phase of a path coordinate.
  elemental real(dp) function phase_of(s) result(phase)
    real(dp), intent(in) :: s                    !< base pitches

    phase = s - floor(s)
  end function phase_of

  !> Distinct phases between `first` and `last` and both of these, ascending; the ends stay exact.
  pure function distinct_phases(values, first, last, same) result(list)
    real(dp), intent(in) :: values(:)            !< phases
    real(dp), intent(in) :: first, last
    real(dp), intent(in), optional :: same       !< phases closer than this count as one
    real(dp), allocatable :: list(:)
    real(dp) :: ascending(size(values)), near
    integer :: i, n

    near = same_phase
    if (present(same)) near = same
    ascending = sorted(values)
    allocate (list(size(values) + 2))
    list(1) = first
    n = 1
    do i = 1, size(values)
      if (ascending(i) > last - near) exit
      if (.not. ascending(i) > list(n) + near) cycle
      n = n + 1
      list(n) = ascending(i)
    end do
    list = [list(:n), last]
  end function distinct_phases
end module gearsweep_mesh_deviations
