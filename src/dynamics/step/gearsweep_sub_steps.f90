!> What is known of the sub-steps of one step while changes of contact are looked for in it. Each speed of a batch has its own.
module gearsweep_sub_steps
  use gearsweep_gauss, only: batch_size
  use gearsweep_kinds, only: dp
  use gearsweep_nodes, only: nodes
  use gearsweep_oscillator, only: oscillator_t, damping, mobility
  use gearsweep_period_map, only: period_map_t
  use gearsweep_quintic, only: bounds_of, quintic
  implicit none
  private
  public :: sub_steps_t, event_t, make_sub_steps, enter_step, places, last

  !> Places in a sub-step at which its coefficients are known: both ends, and the nodes of the integration between.
  real(dp), parameter :: places(5) = [0.0_dp, nodes, 1.0_dp]
  integer, parameter :: last = size(places)
  integer, parameter :: none_yet = -1

  !> The search for changes of contact (events) of one speed in its step.
  type :: event_t
    logical :: active = .false.
    logical :: found = .false.                   !< the contact does change in this step
    integer :: contact = 0                       !< whose event is bracketed; 0: none has been detected
    integer :: trials = 0, events = 0
    real(dp) :: length = 1                       !< of the sub-step in which it was detected, part of the step
    real(dp) :: part = 1, low = 0, high = 1      !< estimate and bracket of the event, parts of this length
    logical :: jumps = .false.                   !< contact has just changed:
    real(dp) :: before = 0                       !< omega^2 before the change, 1/s^2
    real(dp) :: ratio = 0                        !< y over the speed of approach
    real(dp) :: propagator(4) = [1, 0, 0, 1]     !< of the sub-steps so far, columns one after the other
  end type event_t

  !> Own stiffness and profile error within the step are quintics through what the table has at its ends, (0:5, pair) and
  !> (0:5, contact); the mobility is linear, (0:1, pair). Places count from 0 to 1 over the step.
  type :: sub_steps_t
    integer :: step = 0
    real(dp), allocatable :: stiffness(:, :), profile_error(:, :), mobility(:, :)
    !> The deflection x that decides on contact, a quintic too, (0:5, contact): the profile error or, where pairs share a
    !> compliance, what `need_error` makes of it while these others are in contact, as a contact set, (pair).
    real(dp), allocatable :: error(:, :)
    integer, allocatable :: others(:)
    !> Bounds of `error` over the step, (least or most, contact), and of the own stiffness from above, (pair).
    real(dp), allocatable :: error_bounds(:, :), most_stiffness(:)
    real(dp), allocatable :: shared(:, :)        !< what neighbours share (m/N), a parabola, (0:2, pair but the last)
    real(dp), dimension(batch_size) :: longest = 1                     !< sub-step that is allowed, part of the step
    type(event_t) :: event(batch_size)
    real(dp), dimension(batch_size) :: left = 0, width = 0             !< begin and length of the sub-step
    !> omega^2 (1/s^2) and sum of k e (m/s^2) of the contacts; (speed, place)
    real(dp), dimension(batch_size, last) :: omega_squared = 0, forcing = 0
    real(dp), dimension(batch_size, 2) :: x = 0, y = 0                 !< state at both ends, m
    real(dp) :: propagator(batch_size, 6) = 0
  end type sub_steps_t
contains

  !> Memory for the sub-steps of one step.
  pure subroutine make_sub_steps(osc, c)
    type(oscillator_t), intent(in) :: osc
    type(sub_steps_t), allocatable, intent(out) :: c

    allocate (c)
    allocate (c%stiffness(0:5, osc%pairs), c%profile_error(0:5, osc%contacts), c%mobility(0:1, osc%pairs))
    allocate (c%error(0:5, osc%contacts), c%others(osc%pairs), c%shared(0:2, max(1, osc%pairs - 1)))
    allocate (c%error_bounds(2, osc%contacts), c%most_stiffness(osc%pairs))
  end subroutine make_sub_steps

  !> The coefficients within a step.
  pure subroutine enter_step(map, step, c)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: step
    type(sub_steps_t), intent(inout) :: c
    real(dp) :: scale(0:2), bounds(2)
    integer :: j

    c%step = step
    associate (osc => map%osc, table => map%table)
      scale = [1.0_dp, table%width(step), table%width(step)**2]
      do j = 1, table%pairs(step)
        c%stiffness(:, j) = quintic(scale*table%end_stiffness(:, j, 1, step), scale*table%end_stiffness(:, j, 2, step))
        bounds = bounds_of(c%stiffness(:, j))
        c%most_stiffness(j) = bounds(2)
        associate (left => osc%intervals(table%interval(step))%place(table%left(step), j), &
                   recess => osc%intervals(table%interval(step))%recess(j))
          c%mobility(0, j) = mobility(osc, left, recess)
          c%mobility(1, j) = mobility(osc, left + table%width(step), recess) - c%mobility(0, j)
        end associate
      end do
      do j = 1, osc%contacts
        c%profile_error(:, j) = 0
        if (j > table%pairs(step) .and. j <= osc%pairs) cycle
        c%profile_error(:, j) = quintic(scale*table%end_profile_error(:, j, 1, step), &
                                        scale*table%end_profile_error(:, j, 2, step))
        c%error_bounds(:, j) = bounds_of(c%profile_error(:, j))
      end do
      c%error(:, :) = c%profile_error
      c%others(:) = none_yet
      if (osc%shared > 0) then
        associate (n => max(1, table%pairs(step) - 1))
          do j = 0, 2
            c%shared(j, :n) = scale(j)*table%end_shared(j, :n, 1, step)/max(1, j)
          end do
        end associate
      end if
      if (osc%damping_ratio > 1) c%longest = longest_sub_step(osc, map%duration*table%width(step))
    end associate
  end subroutine enter_step

  !> The longest sub-step under strong damping, as a part of a step of this time (s). Changes of contact cut the steps
  !> of every refinement level at the same places, so that doubling the steps does not show the error of sub-steps:
  !> where a contact lasts shorter than a step, and damping changes the motion within it, they are made short.
  elemental real(dp) function longest_sub_step(osc, time)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: time
    real(dp), parameter :: decay = 0.05_dp

    longest_sub_step = 1
    if (time > 0) longest_sub_step = min(1.0_dp, decay/(damping(osc, osc%highest_frequency)*time))
  end function longest_sub_step
end module gearsweep_sub_steps
