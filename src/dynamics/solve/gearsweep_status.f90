!> How the calculation of an operating point ended: the codes, their names in tables, and what they mean in words.
!> Everything that shows a status takes it from here.
module gearsweep_status
  implicit none
  private
  public :: has_result, status_name, status_meaning

  !> Up to `status_inexact` there is a dynamic factor; from `status_unstable` on there is none.
  integer, parameter, public :: &
    status_ok = 0, &           !< stable and periodic with the mesh
    status_marginal = 1, &     !< periodic, but transients never die out (largest Floquet multiplier 1)
    status_subharmonic = 2, &  !< stable and periodic with several mesh periods
    status_inexact = 3, &      !< the error estimate stays above the tolerance
    status_unstable = 4, &     !< the periodic motion repels; no steady motion was reached
    status_aperiodic = 5, &    !< without damping, no periodic motion was found
    status_unresolved = 6, &   !< the motion needs more steps than given or allowed
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

contains

  !> Is there a dynamic factor?
  elemental logical function has_result(status)
    integer, intent(in) :: status      !< one of the codes above

    has_result = status <= status_inexact
  end function has_result

  !> The word that stands for a status in tables.
  pure function status_name(status) result(name)
    integer, intent(in) :: status      !< one of the codes above
    character(len_trim(names(status))) :: name

    name = names(status)
  end function status_name

  !> What a status means, in words for the report.
  pure function status_meaning(status) result(meaning)
    integer, intent(in) :: status      !< one of the codes above
    character(len_trim(meanings(status))) :: meaning

    meaning = meanings(status)
  end function status_meaning
end module gearsweep_status
