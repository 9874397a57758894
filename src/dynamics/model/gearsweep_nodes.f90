!> Where in a step the coefficients of the equation of motion are taken: the nodes of the methods that integrate it.
module gearsweep_nodes
  use gearsweep_kinds, only: dp
  implicit none
  private

  real(dp), parameter :: r15 = sqrt(15.0_dp), r6 = sqrt(6.0_dp)

  !> Places within the step, 0 to 1: of Gauss's method and, for steps that do not follow the natural motion, of Radau's.
  real(dp), parameter, public :: nodes(3) = [0.5_dp - r15/10, 0.5_dp, 0.5_dp + r15/10]
  real(dp), parameter, public :: stiff_nodes(3) = [(4 - r6)/10, (4 + r6)/10, 1.0_dp]
end module gearsweep_nodes
