!> The motions of a batch on their way through the mesh period.
module gearsweep_integrator
  use gearsweep_change_loads, only: change_t
  use gearsweep_coefficients, only: coefficients_t
  use gearsweep_contact_set, only: contact_t
  use gearsweep_dte, only: add_batch_to_dte, add_to_dte, dte_batch_t, dte_t
  use gearsweep_gauss, only: batch_size
  use gearsweep_kinds, only: dp
  use gearsweep_load_peaks, only: candidates_t
  use gearsweep_sub_step, only: sub_steps_t
  implicit none
  private
  public :: integrator_t, watch_dte

  !> Second index of x and y: where the step begins is `from` and where it ends `to`, which change places after it.
  type :: integrator_t
    integer :: from = 1, to = 2
    real(dp), dimension(batch_size, 2) :: x, y   !< state, m
    real(dp) :: monodromy(batch_size, 4)         !< derivative by the first state, columns one after the other
    real(dp) :: shrunk(batch_size)               !< logarithm of what was taken out of it
    real(dp) :: held(batch_size)                 !< 0 where contact may change, else a height above all profile errors, m
    type(contact_t), allocatable :: contacts(:)
    integer :: contact_set(batch_size)
    integer :: law(batch_size)                   !< of these in the step, by number
    logical :: full_contact                      !< there is full contact at every speed
    logical :: all_full                          !< so it was in all steps so far, whose propagators are cached
    logical :: changes(batch_size)               !< contact may change, and then does change, within the step
    logical :: crosses                           !< single changes of contact are for gearsweep_event_crossing
    type(sub_steps_t), allocatable :: sub_steps
    logical :: peaks                             !< the largest loads are wanted
    real(dp) :: peak(batch_size)                 !< largest load so far, N
    real(dp) :: coast_peak(batch_size)           !< that on the coast sides, N
    type(dte_batch_t) :: dte                     !< so far
    type(dte_t) :: single_dte                    !< the same of a batch of one
    type(candidates_t) :: candidates(batch_size)  !< for larger ones
    type(change_t) :: change(4)                  !< steps with a change of contact in which larger ones may be
    integer :: noted                             !< how many
  end type integrator_t

contains

  !> Adds a step to the transmission error of all motions.
  pure subroutine watch_dte(table, speeds, level, step, state)
    type(coefficients_t), intent(in) :: table
    integer, intent(in) :: speeds                !< of the batch
    real(dp), intent(in) :: level                !< from which the deflection counts, m
    integer, intent(in) :: step
    type(integrator_t), intent(inout) :: state

    associate (width => table%width(step), next => table%width(merge(1, step + 1, step == table%steps)), from => state%from, &
               to => state%to, x => state%x, y => state%y)
      if (speeds == 1) then
        call add_to_dte(width, next, [x(1, from), x(1, to)] - level, [y(1, from), y(1, to)], state%single_dte)
      else
        call add_batch_to_dte(width, next, level, x(:, from), y(:, from), x(:, to), y(:, to), state%dte)
      end if
    end associate
  end subroutine watch_dte
end module gearsweep_integrator
