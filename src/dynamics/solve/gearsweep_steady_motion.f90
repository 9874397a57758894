!> What an operating point is asked for, and what is found there.
module gearsweep_steady_motion
  use, intrinsic :: iso_c_binding, only: c_null_ptr, c_ptr
  use gearsweep_coefficient_table, only: resolution_t, scheme_collocation
  use gearsweep_kinds, only: dp
  use gearsweep_status, only: status_transient
  implicit none
  private
  public :: accuracy_t, point_t, steady_choice_t, steady_options_t, steady_t, step_choice_t

  integer, parameter, public :: by_shooting = 1, by_marching = 2

  !> What the motion that is found depends on.
  type :: steady_choice_t
    integer :: method = by_shooting
    real(dp) :: tolerance = 1e-6_dp              !< of the dynamic factor
    integer :: most_cycles = 2000                !< mesh periods marched at most
    integer :: most_periods = 8                  !< mesh periods of the longest subharmonic motion looked for
  end type steady_choice_t

  type, extends(steady_choice_t) :: steady_options_t
    type(c_ptr) :: stop = c_null_ptr             !< an integer of the caller; the search ends where it is not 0
  end type steady_options_t

  !> The method of integration, and how many steps there are.
  type :: step_choice_t
    integer :: scheme = scheme_collocation       !< of gearsweep_coefficients
    integer :: steps = 0                         !< of a period; 0: chosen for the tolerance, or 200 by another scheme
    integer :: most_steps = 2**18                !< of a period; fewer where there are more than four contacts
  end type step_choice_t

  !> What an operating point is asked for.
  type, extends(step_choice_t) :: accuracy_t
    type(steady_options_t) :: steady
    logical :: with_dte = .true.                 !< root mean square and range of the transmission error are wanted
  end type accuracy_t

  !> A periodic motion.
  type :: steady_t
    integer :: status = status_transient         !< of gearsweep_status
    real(dp) :: state(2) = 0                     !< at the begin of the mesh period, m
    real(dp) :: peak = 0                         !< largest load on one pair, N
    real(dp) :: coast_peak = 0                   !< largest load on the coast sides, N
    real(dp) :: checksum = 0                     !< sum of x where smooth intervals begin, mean of the periods, m
    real(dp) :: dte_rms = 0                      !< of what the transmission error differs from its mean, m
    real(dp) :: dte_range = 0                    !< largest less least transmission error, m
    !> Largest modulus of the Floquet multipliers; of a chaotic motion, the mean factor by which a disturbance grows
    !> over a mesh period.
    real(dp) :: multiplier = 0
    real(dp) :: mesh_multiplier = 0              !< its mean over the mesh periods, which does not underflow
    real(dp) :: residual = 0                     !< of x(T) = x(0), in static deflections
    real(dp) :: closure = 0                      !< error of the state that the residual leaves, in static deflections
    integer :: periods = 1                       !< mesh periods until the motion repeats
    real(dp) :: work = 0                         !< computing time to find it, in steps
    !> It was not all in full contact, about which the motion is linear.
    logical :: departs = .false.
    !> A pair between A and E was apart for a while; all flanks were; the coast sides came into contact.
    logical :: partial = .false., lost = .false., coast = .false.
  end type steady_t

  !> The result at one speed.
  type :: point_t
    type(steady_t) :: steady
    real(dp) :: dynamic_factor = 0               !< largest load on one pair over the static load
    real(dp) :: estimate = 0                     !< of the error of the dynamic factor; NaN: not known
    real(dp) :: dte_estimate = 0                 !< of the errors of `dte_rms` and `dte_range`, m; NaN: not known
    real(dp) :: step_error = 0                   !< its part that more steps reduce
    real(dp) :: work = 0                         !< steps in all, at every level tried; not counted in batches
    integer :: steps = 0                         !< of the period
    type(resolution_t) :: resolution             !< that has them
    !> In a sweep up or down: the motion at the speed before led to none, and this one was found without it.
    logical :: branch_lost = .false.
    !> In a sweep up and down: the direction that led to this motion, 1 up, -1 down, 0 both; and what the other led to, the
    !> same motion or one of smaller dynamic factor.
    integer :: direction = 0
    integer :: other_status = 0                  !< of gearsweep_status
    real(dp) :: other_factor = 0                 !< its dynamic factor
  end type point_t
end module gearsweep_steady_motion
