!> Stress at the nodes of a grid, for pictures.
module gearsweep_nodal_stress
  use gearsweep_kinds, only: dp
  use gearsweep_body, only: body_t, elastic_law
  use gearsweep_q8, only: nodes_per_element, element_gradients
  implicit none
  private
  public :: nodal_stress

contains

  !> Stress components sigma_x, sigma_y, tau_xy (3, nodes) of displacements `u`
  !> (2, nodes) at the nodes, averaged over the elements that meet there; for pictures.
  pure function nodal_stress(body, u) result(stress)
    type(body_t), intent(in) :: body
    real(dp), intent(in) :: u(:, :)
    real(dp) :: stress(3, size(body%grid%x, 2))
    real(dp), parameter :: place(2, nodes_per_element) = reshape([real(dp) :: &
      -1, -1, 1, -1, 1, 1, -1, 1, 0, -1, 1, 0, 0, 1, -1, 0], [2, nodes_per_element])
    real(dp) :: law(3), g(nodes_per_element, 2), h(2, 2), det
    integer :: meeting(size(body%grid%x, 2)), e, i

    law = elastic_law(body%material, body%plane_strain)
    stress = 0
    meeting = 0
    do e = 1, size(body%grid%element, 2)
      associate (list => body%grid%element(:, e))
        do i = 1, nodes_per_element
          call element_gradients(body%grid%x(:, list), place(:, i), g, det)
          h = matmul(u(:, list), g)
          stress(:, list(i)) = stress(:, list(i)) + [law(1)*h(1, 1) + law(2)*h(2, 2), &
            law(2)*h(1, 1) + law(1)*h(2, 2), law(3)*(h(1, 2) + h(2, 1))]
          meeting(list(i)) = meeting(list(i)) + 1
        end do
      end associate
    end do
    stress = stress/spread(meeting, 1, 3)
  end function nodal_stress
end module gearsweep_nodal_stress
