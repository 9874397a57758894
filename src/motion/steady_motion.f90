!> Operating point: its request, its result and its status.
!>
!> The codes of a status, their names in tables and their meanings in words are defined here once.
module gearsweep_motion_steady_motion
  use, intrinsic :: iso_c_binding, only: c_null_ptr, c_ptr
  use gearsweep_base, only: dp
  use gearsweep_motion_resolution, only: resolution_t, scheme_collocation
  use gearsweep_motion_contact_set, only: dte_t
  implicit none
  private
  public :: has_result, status_name, status_meaning, accuracy_t, point_t, seen_t, steady_choice_t, steady_options_t, steady_t, &
            step_choice_t

  !> Codes of a status; up to `status_inexact` there is a dynamic factor, from `status_unstable` on there is none.
  integer, parameter, public :: &
    status_ok = 0, &           !< stable and periodic with the mesh
    status_marginal = 1, &     !< periodic, but transients never die out (largest Floquet multiplier 1)
    status_subharmonic = 2, &  !< stable and periodic with several mesh periods
    status_inexact = 3, &      !< the error estimate stays above the tolerance
    status_unstable = 4, &     !< the periodic motion repels; no steady motion was reached
    status_aperiodic = 5, &    !< without damping, no periodic motion was found
    status_unresolved = 6, &   !< the motion needs more steps than specified or allowed
    status_chatter = 7, &      !< contact changes without end
    status_chaotic = 8, &      !< no periodic motion was found, disturbances keep growing, and no bound was passed
    status_transient = 9, &    !< no periodic motion was found before the march ended, though disturbances do not grow
    status_unbounded = 10, &   !< the motion passed 1e4 static deflections: no bound was seen
    status_stopped = 11        !< not computed: the caller ended the call before

  character(*), parameter :: names(0:11) = [character(11) :: 'ok', 'marginal', 'subharmonic', 'inexact', 'unstable', &
                                            'aperiodic', 'unresolved', 'chatter', 'chaotic', 'transient', 'unbounded', 'stopped']
  character(*), parameter :: meanings(0:11) = [character(60) :: &
    'steady, stable and periodic with the mesh', &
    'periodic, but transients do not die out', &
    'the motion repeats only after several mesh periods', &
    'the estimated error exceeds the tolerance', &
    'the periodic motion repels, and no steady motion was reached', &
    'nothing is damped, and no periodic motion was found', &
    'the speed is too low for the steps given or allowed', &
    'contact changes without end', &
    'no periodic motion was found, and disturbances keep growing', &
    'the transient had not died away when the march ended', &
    'the deflection passed 1e4 static ones; no bound was seen', &
    'not computed, as the run was interrupted']

  integer, parameter, public :: by_shooting = 1, by_marching = 2

  !> Options that decide which motion is found.
  type :: steady_choice_t
    integer :: method = by_shooting
    real(dp) :: tolerance = 1e-6_dp              !< tolerance of the dynamic factor
    integer :: most_cycles = 2000                !< largest number of mesh periods marched
    integer :: most_periods = 8                  !< mesh periods of the longest subharmonic motion sought
  end type steady_choice_t

  type, extends(steady_choice_t) :: steady_options_t
    type(c_ptr) :: stop = c_null_ptr             !< an integer of the caller; the search ends if it is not 0
  end type steady_options_t

  !> Method of integration, and number of steps.
  type :: step_choice_t
    integer :: scheme = scheme_collocation       !< scheme of gearsweep_motion_resolution
    integer :: steps = 0  !< number of steps of a period; 0: chosen for the tolerance, or 200 by another scheme
    integer :: most_steps = 2**18  !< largest number of steps of a period; fewer where there are more than four contacts
  end type step_choice_t

  !> Options of an operating point.
  type, extends(step_choice_t) :: accuracy_t
    type(steady_options_t) :: steady
  end type accuracy_t

  !> Observations of a motion that does not repeat, as far as it was integrated.
  type :: seen_t
    integer :: periods = 0                       !< mesh periods; 0: no observation
    real(dp) :: peak = 0                         !< largest load on one pair, N
    type(dte_t) :: dte
  end type seen_t

  !> Periodic motion.
  type :: steady_t
    integer :: status = status_transient         !< status code of gearsweep_motion_steady_motion
    real(dp) :: state(2) = 0                     !< state at the start of the mesh period, m
    real(dp) :: peak = 0                         !< largest load on one pair, N
    real(dp) :: coast_peak = 0                   !< largest load on the coast sides, N
    real(dp) :: checksum = 0                     !< sum of x at the starts of smooth intervals, mean of the periods, m
    real(dp) :: dte_rms = 0                      !< root mean square deviation of the transmission error, m
    real(dp) :: dte_range = 0                    !< largest minus least transmission error, m
    !> Largest modulus of the Floquet multipliers; of a chaotic motion, the mean factor by which a disturbance grows over a mesh
    !> period.
    real(dp) :: multiplier = 0
    real(dp) :: mesh_multiplier = 0              !< mean of `multiplier` over the mesh periods, which does not underflow
    real(dp) :: residual = 0                     !< residual of x(T) = x(0), in static deflections
    real(dp) :: closure = 0                      !< error of the state due to the residual, in static deflections
    integer :: periods = 1                       !< mesh periods until the motion repeats
    !> True: contact was not always full, as linear motion needs.
    logical :: departs = .false.
    !> True: a pair between A and E was apart for a while; all flanks were; the coast sides came into contact.
    logical :: partial = .false., lost = .false., coast = .false.
    type(seen_t) :: seen                         !< observations of a marched motion without a result
  end type steady_t

  !> Result at one speed.
  type :: point_t
    type(steady_t) :: steady
    real(dp) :: dynamic_factor = 0               !< largest load on one pair over the static load
    real(dp) :: estimate = 0                     !< estimate of the error of the dynamic factor; NaN: not known
    real(dp) :: dte_estimate = 0                 !< estimate of the errors of `dte_rms` and `dte_range`, m; NaN: not known
    real(dp) :: step_error = 0                   !< part of `estimate` that more steps reduce
    integer :: steps = 0                         !< number of steps of the period
    type(resolution_t) :: resolution             !< resolution with these steps
    integer :: motions = 0                       !< number of attracting motions found, this being the largest; 0: no search
    !> True in a sweep up or down: the motion at the previous speed led to none, and this one was found without it.
    logical :: branch_lost = .false.
    !> Direction that led to this motion in a sweep up and down, 1 up, -1 down, 0 both; and the result of the other direction, the
    !> same motion or one of smaller dynamic factor.
    integer :: direction = 0
    integer :: other_status = 0                  !< status code of gearsweep_motion_steady_motion
    real(dp) :: other_factor = 0                 !< dynamic factor of the other motion
    real(dp) :: other_dte_rms = 0                !< root mean square of its transmission error, m
  end type point_t

contains

  !> True if there is a dynamic factor.
  elemental logical function has_result(status)
    integer, intent(in) :: status      !< one of the codes above

    has_result = status <= status_inexact
  end function has_result

  !> Name of a status in tables.
  pure function status_name(status) result(name)
    integer, intent(in) :: status      !< one of the codes above
    character(len_trim(names(status))) :: name

    name = names(status)
  end function status_name

  !> Meaning of a status in words for the report.
  pure function status_meaning(status) result(meaning)
    integer, intent(in) :: status      !< one of the codes above
    character(len_trim(meanings(status))) :: meaning

    meaning = meanings(status)
  end function status_meaning
end module gearsweep_motion_steady_motion
