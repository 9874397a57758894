!> What the teeth of real gears differ by from the nominal ones, as profile errors on the line of action: a polynomial over the path
!> of contact for each tooth, and waves that go on from tooth to tooth.
!>
!> Pair k, k = ..., -1, 0, 1, ..., enters at A at the time k (in mesh periods). It is on tooth k mod z1 of the pinion and tooth
!> (k + offset) mod z2 of the gear, both counted from 0 in the order in which they engage. Its profile error at the path
!> coordinate s is the nominal one and
!>
!> p_i(s) + g_j(s) + w(tau), p_i(s) = sum over n of c_n (s - contact ratio/2)^n and so g_j, w = sum of a sin(2 pi o tau/z +
!> phase).
!>
!> The waves of the gear are those of its tooth 0, and so count the time from tau + offset. An error above 0 keeps the flanks
!> apart. Beyond A and E, where a tip corner touches, the polynomials keep their value at A or E.
!> The errors repeat after a whole number of mesh periods, the turn: the least common multiple of the numbers of teeth, or of those
!> of the gear alone that deviates.
module gearsweep_deviations
  use gearsweep_kinds, only: dp, pi
  implicit none
  private
  public :: deviations_t, wave_t, make_deviations, common_divisor, length_of_turn

  type :: wave_t
    integer :: gear = 1                !< 1: pinion, 2: gear
    integer :: order = 1               !< waves over a turn of it
    real(dp) :: amplitude = 0          !< m
    real(dp) :: phase = 0              !< where tooth 0 enters at A, rad
  end type wave_t

  type :: deviations_t
    integer :: periods = 1             !< mesh periods after which the errors repeat
    integer :: teeth(2) = 1            !< of pinion and gear
    integer :: offset = 0              !< number, from 0, of the gear's tooth that meets the pinion's tooth 0 at tau = 0
    !> Coefficients c_n, m; (0:degree, tooth). Not allocated where no tooth of a gear deviates.
    real(dp), allocatable :: pinion(:, :), gear(:, :)
    type(wave_t), allocatable :: waves(:)
  contains
    procedure :: any => deviate
    procedure :: of_both_teeth
    procedure :: of_pair
    procedure :: wave_at
    procedure :: largest
  end type deviations_t

contains

  !> The deviations of these teeth and waves.
  pure function make_deviations(teeth, pinion, gear, waves, offset) result(deviations)
    integer, intent(in) :: teeth(2)              !< of pinion and gear
    real(dp), intent(in) :: pinion(0:, :), gear(0:, :)     !< c_n, m; (0:degree, tooth); without teeth where none deviates
    type(wave_t), intent(in) :: waves(:)
    integer, intent(in) :: offset                !< as in deviations_t
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
    deviations%periods = nint(length_of_turn(teeth, [size(pinion, 2) > 0 .or. any(waves%gear == 1), &
                                                     size(gear, 2) > 0 .or. any(waves%gear == 2)]))
  end function make_deviations

  !> Mesh periods after which deviations of pinion and gear repeat: a number that an integer may not hold.
  pure real(dp) function length_of_turn(teeth, deviates) result(periods)
    integer, intent(in) :: teeth(2)
    logical, intent(in) :: deviates(2)

    periods = product(real(teeth, dp), mask=deviates)
    if (all(deviates)) periods = periods/common_divisor(teeth(1), teeth(2))
  end function length_of_turn

  !> The greatest common divisor of two numbers above 0, by Euclid's algorithm.
  pure integer function common_divisor(a, b)
    integer, intent(in) :: a, b
    integer :: rest, next

    common_divisor = a
    rest = b
    do while (rest > 0)
      next = modulo(common_divisor, rest)
      common_divisor = rest
      rest = next
    end do
  end function common_divisor

  !> Does anything deviate?
  pure logical function deviate(self)
    class(deviations_t), intent(in) :: self

    deviate = allocated(self%waves)
  end function deviate

  !> The polynomial (m) of the pair with this number over s - contact ratio/2: both teeth's; (0:degree).
  pure subroutine of_both_teeth(self, number, c)
    class(deviations_t), intent(in) :: self
    integer, intent(in) :: number                !< k
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

  !> The polynomial (m) of the pair with this number, about s = 0; (0:degree). Beyond A and E a constant.
  pure function of_pair(self, number, contact_ratio, s) result(c)
    class(deviations_t), intent(in) :: self
    integer, intent(in) :: number                !< k
    real(dp), intent(in) :: contact_ratio
    real(dp), intent(in) :: s                    !< path coordinate in the interval for which it is wanted
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
    ! Taylor's shift by Horner's scheme: from powers of s - contact ratio/2 to powers of s.
    do i = 0, degree - 1
      do n = degree - 1, i, -1
        c(n) = c(n) - contact_ratio/2*c(n + 1)
      end do
    end do
  end function of_pair

  !> The waves (m) at a time, with their first and second derivative over it; (0:2).
  pure function wave_at(self, period, phase) result(w)
    class(deviations_t), intent(in) :: self
    integer, intent(in) :: period                !< whole mesh periods of the time
    real(dp), intent(in) :: phase                !< the rest
    real(dp) :: w(0:2), rate, angle
    integer :: i

    w = 0
    do i = 1, size(self%waves)
      associate (wave => self%waves(i))
        rate = 2*pi*wave%order/self%teeth(wave%gear)
        angle = rate*(modulo(period + merge(self%offset, 0, wave%gear == 2), self%teeth(wave%gear)) + phase) + wave%phase
        w = w + wave%amplitude*[sin(angle), rate*cos(angle), -rate**2*sin(angle)]
      end associate
    end do
  end function wave_at

  !> Bound of the errors' size, m.
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
end module gearsweep_deviations
