!> Deflection of the body under all teeth in contact together, as numbers; gearsweep_elastic_compliance computes them.
module gearsweep_elastic_disc
  use gearsweep_base, only: dp
  implicit none
  private
  public :: disc_t

  !> Displacement along the line of action, m/N; of a mesh, that of both gears.
  type :: disc_t
    !> Compliance by rotation of the body: the mean over its mass, which accelerates a rigid gear's inertia.
    real(dp) :: turn = 0
    !> Further deflection of the next tooth per load on a tooth; of a mesh also the part of the rotation that the motion feels due
    !> to inertia at the hubs (gearsweep_elastic_hub), which is then not in `turn`.
    real(dp) :: shared = 0
    !> Change of `shared`, its mean, along the path: coefficients of Legendre's polynomials of first and second degree over the
    !> interval where two teeth touch, from -1 to 1.
    real(dp) :: change(2) = 0
    real(dp) :: decline = 0                      !< `shared` minus the compliance shared by the tooth after the next one
    real(dp) :: twist(2) = 0                     !< twist of a mesh: the full rotation of pinion and gear, each by itself
  contains
    procedure :: compliance
    procedure :: shared_at
    procedure :: most_shared
    procedure :: shared_beyond
  end type disc_t

contains

  !> Compliance of both together, m/N: a spring in series with all pairs.
  pure real(dp) function compliance(disc)
    class(disc_t), intent(in) :: disc

    compliance = disc%turn + disc%shared
  end function compliance

  !> Compliance shared by neighbours while two teeth touch (m/N), with its first and second derivative over u, which is -1 at the
  !> start and 1 at the end of that interval; (0:2).
  pure function shared_at(disc, u) result(c)
    class(disc_t), intent(in) :: disc
    real(dp), intent(in) :: u
    real(dp) :: c(0:2)

    associate (b => disc%change)
      c = [disc%shared + b(1)*u + b(2)*(1.5_dp*u**2 - 0.5_dp), b(1) + 3*b(2)*u, 3*b(2)]
    end associate
  end function shared_at

  !> Compliance shared by pairs that are not neighbours, m/N.
  pure real(dp) function shared_beyond(disc)
    class(disc_t), intent(in) :: disc

    shared_beyond = disc%shared - disc%decline
  end function shared_beyond

  !> Upper bound of the compliance shared by neighbours, m/N.
  pure real(dp) function most_shared(disc)
    class(disc_t), intent(in) :: disc

    most_shared = disc%shared + sum(abs(disc%change))
  end function most_shared
end module gearsweep_elastic_disc
