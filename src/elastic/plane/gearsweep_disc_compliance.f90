!> What the body behind the teeth deflects under all teeth in contact together.
!>
!> All loads of a gear mesh lie on one line, tangent to the base circle. So whichever tooth takes
!> them, a whole gear held at its bore turns by the same angle, and on any body the teeth beside it move too.
!> A spring of each pair's own would count that once for each pair.
module gearsweep_disc_compliance
  use gearsweep_kinds, only: dp, pi
  use gearsweep_body, only: body_t
  use gearsweep_compliance, only: flank_load
  use gearsweep_disc, only: disc_t
  use gearsweep_error, only: error_t
  use gearsweep_gear, only: drive
  use gearsweep_memory, only: claim_memory
  use gearsweep_q8, only: element_mass
  use gearsweep_section, only: section_t
  use gearsweep_text, only: str
  implicit none
  private
  public :: disc_compliance, turning

contains

  !> `disc` of a section of two teeth or more under a unit line load (m2/N), over radii of curvature of the drive
  !> flank from `first` to `last` (m): over the interval where two teeth touch, by Gauss's rule. A section of
  !> one tooth has no neighbour and shares nothing; one that is no whole gear is held at its sides and does not turn. What the
  !> tooth after the next one shares hardly changes along the path: it is taken at one place, and is nothing beyond a section.
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
    real(dp) :: pitch, curvature, turn(places), both(places)
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
    turn = body%thickness*[(dot_product(x(:, i), couple), i=1, places)]
    both = body%thickness*[(dot_product(x(:, i), beside(:, i)), i=1, places)] - turn
    disc%turn = sum(weight*turn)
    disc%shared = sum(weight*both)
    disc%change = [3*sum(weight*(2*node - 1)*both), 5*sum(weight*(1.5_dp*(2*node - 1)**2 - 0.5_dp)*both)]
    disc%decline = disc%shared
    if (section%loaded + 2 > section%options%teeth) return
    beside(:, 1) = 0
    curvature = first + (last - pitch - first)*node(1)
    call load_tooth(section%loaded + 2, min(last, curvature + 2*pitch), beside(:, 1))
    if (allocated(error)) return
    disc%decline = disc%shared - (body%thickness*dot_product(x(:, 1), beside(:, 1)) - turn(1))

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
end module gearsweep_disc_compliance
