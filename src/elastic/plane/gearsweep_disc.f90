!> What the body behind the teeth deflects under all teeth in contact together, as numbers; gearsweep_disc_compliance finds them.
module gearsweep_disc
  use gearsweep_kinds, only: dp
  implicit none
  private
  public :: disc_t

  !> Displacement along the line of action, m/N; of both gears where it belongs to a mesh.
  type :: disc_t
    !> As the body turns: the mean over its mass, which is what a rigid gear's inertia feels.
    real(dp) :: turn = 0
    !> What the load on a tooth moves the next one by beyond that; of a mesh also what of the turning the inertia at the hubs
    !> makes the motion feel (gearsweep_hub), which is not in `turn` then.
    real(dp) :: shared = 0
    !> How that changes along the path, over which `shared` is the mean: coefficients of Legendre's polynomials of first and
    !> second degree over the interval where two teeth touch, from -1 to 1.
    real(dp) :: change(2) = 0
    real(dp) :: decline = 0                      !< how much less than `shared` the tooth after the next one shares
    real(dp) :: twist(2) = 0                     !< of a mesh: all the turning of pinion and gear, each by itself
  contains
    procedure :: compliance
    procedure :: shared_at
    procedure :: most_shared
    procedure :: shared_beyond
  end type disc_t

contains

  !> Both together, m/N: a spring in series with all pairs.
  pure real(dp) function compliance(disc)
    class(disc_t), intent(in) :: disc

    compliance = disc%turn + disc%shared
  end function compliance

  !> What neighbours share where two teeth touch (m/N), with its first and second derivative over u, which is -1 where they
  !> begin to and 1 where they cease; (0:2).
  pure function shared_at(disc, u) result(c)
    class(disc_t), intent(in) :: disc
    real(dp), intent(in) :: u
    real(dp) :: c(0:2)

    associate (b => disc%change)
      c = [disc%shared + b(1)*u + b(2)*(1.5_dp*u**2 - 0.5_dp), b(1) + 3*b(2)*u, 3*b(2)]
    end associate
  end function shared_at

  !> What pairs share that are not neighbours, m/N.
  pure real(dp) function shared_beyond(disc)
    class(disc_t), intent(in) :: disc

    shared_beyond = disc%shared - disc%decline
  end function shared_beyond

  !> A bound of what neighbours share from above, m/N.
  pure real(dp) function most_shared(disc)
    class(disc_t), intent(in) :: disc

    most_shared = disc%shared + sum(abs(disc%change))
  end function most_shared
end module gearsweep_disc
