!> Elastic material; steel unless said.
module gearsweep_material
  use gearsweep_kinds, only: dp
  implicit none
  private

  type, public :: material_t
    real(dp) :: young = 206e9_dp       !< E, Pa
    real(dp) :: poisson = 0.3_dp       !< nu
    real(dp) :: density = 7850         !< kg/m^3
  end type material_t
end module gearsweep_material
