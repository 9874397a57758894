!> What the body behind the teeth yields under all teeth in contact together.
!>
!> All loads of a gear mesh lie on one line, tangent to the base circle. So whichever tooth takes
!> them, a whole gear held at its bore turns by the same angle, and on any body the teeth beside it move too.
!> A spring of each pair's own would count that once for each pair.
module gearsweep_disc
  use gearsweep_kinds, only: dp, pi
  use gearsweep_body, only: body_t
  use gearsweep_compliance, only: flank_load
  use gearsweep_error, only: error_t
  use gearsweep_gear, only: drive
  use gearsweep_memory, only: claim_memory
  use gearsweep_q8, only: element_mass
  use gearsweep_section, only: section_t
  use gearsweep_text, only: str
  implicit none
  private
  public :: disc_t, disc_compliance, turning

  !> Displacement along the line of action, m/N; of both gears where it belongs to a mesh.
  type :: disc_t
    !> As the body turns: the mean over its mass, which is what a rigid gear's inertia feels.
    real(dp) :: turn = 0
    !> What the load on a tooth moves the next one by beyond that; of a mesh also what of the turning the inertia at the hubs
    !> makes the motion feel (gearsweep_hub), which is not in `turn` then.
    real(dp) :: shared = 0
    real(dp) :: twist(2) = 0                     !< of a mesh: all the turning of pinion and gear, each by itself
  contains
    procedure :: yield
  end type disc_t

contains

  !> Both together, m/N: a spring in series with all pairs.
  pure real(dp) function yield(disc)
    class(disc_t), intent(in) :: disc

    yield = disc%turn + disc%shared
  end function yield

  !> `disc` of a section of two teeth or more under a unit line load (m2/N), over radii of curvature of the drive
  !> flank from `first` to `last` (m): the mean over the stretch where two teeth touch, by Gauss's rule. A section of
  !> one tooth has no neighbour and shares nothing; one that is no whole gear is held at its sides and does not turn.
  subroutine disc_compliance(section, body, first, last, disc, error)
    type(section_t), intent(in) :: section
    type(body_t), intent(in) :: body
    real(dp), intent(in) :: first, last
    type(disc_t), intent(out) :: disc
    type(error_t), allocatable, intent(out) :: error
    integer, parameter :: places = 3
    real(dp), parameter :: node(places) = 0.5_dp + [-0.5_dp, 0.0_dp, 0.5_dp]*sqrt(0.6_dp)
    real(dp), parameter :: weight(places) = [5, 8, 5]/18.0_dp
    real(dp), allocatable :: x(:, :), beside(:, :), couple(:)
    real(dp) :: pitch, curvature, turn, both
    integer :: i

    if (section%options%teeth == 1) return
    call claim_memory(8.0_dp*body%unknowns*(2*places + 6), 'teeth of the section: what neighbours share, on '// &
                      str(body%unknowns)//' unknowns', error)
    if (allocated(error)) return
    allocate (x(body%unknowns, places), beside(body%unknowns, places), source=0.0_dp)
    pitch = 2*pi*section%gear%base_radius(drive)/section%gear%spec%teeth
    do i = 1, places
      curvature = first + (last - pitch - first)*node(i)
      call load_tooth(section%loaded, curvature, x(:, i))
      if (.not. allocated(error)) call load_tooth(section%loaded + 1, curvature + pitch, beside(:, i))
      if (allocated(error)) return
    end do
    allocate (couple(body%unknowns), source=0.0_dp)
    if (section%grid%closed) couple = section%gear%base_radius(drive)*turning(body)
    call body%stiffness%solve(x, error)
    if (allocated(error)) return
    do i = 1, places
      turn = dot_product(x(:, i), couple)
      both = dot_product(x(:, i), beside(:, i))
      disc%turn = disc%turn + body%thickness*weight(i)*turn
      disc%shared = disc%shared + body%thickness*weight(i)*(both - turn)
    end do

  contains

    subroutine load_tooth(tooth, curvature, force)
      integer, intent(in) :: tooth
      real(dp), intent(in) :: curvature
      real(dp), intent(inout) :: force(:)

      call flank_load(section, body, min(hypot(section%gear%base_radius(drive), curvature), section%gear%tip_radius), &
                      force, error, tooth)
    end subroutine load_tooth
  end subroutine disc_compliance

  !> The weights of the displacements in the angle (rad) by which `body` turns about the origin: angular
  !> momentum over moment of inertia, for uniform density. As forces they are a unit couple.
  pure function turning(body) result(weights)
    type(body_t), intent(in) :: body
    real(dp) :: weights(body%unknowns)
    real(dp) :: share(2, size(body%grid%x, 2)), inertia
    integer :: e

    share = 0
    inertia = 0
    do e = 1, size(body%grid%element, 2)
      associate (list => body%grid%element(:, e), x => body%grid%x(:, body%grid%element(:, e)))
        associate (moment => matmul(x, element_mass(x)))
          share(1, list) = share(1, list) - moment(2, :)
          share(2, list) = share(2, list) + moment(1, :)
          inertia = inertia + sum(moment*x)
        end associate
      end associate
    end do
    weights = body%gather(share)/inertia
  end function turning
end module gearsweep_disc
