!> Face load factor of ISO 6336-1, method C, and the equivalent misalignment of the pinion's shaft.
module gearsweep_face_iso
  use gearsweep_base, only: dp
  use gearsweep_face_shaft, only: shaft_t
  implicit none
  private
  public :: iso_face_load_factor, iso_shaft_misalignment

  !> Share of the mesh stiffness c_gamma_alpha that counts for the load over the face, c_gamma_beta.
  real(dp), parameter :: face_share = 0.85_dp

contains

  !> K_H beta by method C for an equivalent misalignment after running in (m), the mesh stiffness c_gamma_alpha (N/m2) and the mean
  !> line load (N/m). Source: ISO 6336-1:2006, 7.4.1.
  elemental real(dp) function iso_face_load_factor(misalignment, mesh_stiffness, line_load) result(factor)
    real(dp), intent(in) :: misalignment, mesh_stiffness, line_load

    associate (ratio => abs(misalignment)*face_share*mesh_stiffness/line_load)
      factor = 1 + ratio/2
      if (factor > 2) factor = sqrt(2*ratio)
    end associate
  end function iso_face_load_factor

  !> Equivalent misalignment f_sh (m) by the deflection of the pinion and its shaft, spur gears, under a mean line load (N/m) over a
  !> face `width` (m): a pinion that is one with its shaft or shrunk on it stiffens the shaft from 1.15 of its diameter on.
  !> Source: ISO 6336-1:2006, 7.5.2, as two public programs have it.
  pure real(dp) function iso_shaft_misalignment(shaft, line_load, width) result(misalignment)
    type(shaft_t), intent(in) :: shaft
    real(dp), intent(in) :: line_load, width
    real(dp), parameter :: rule = 0.023e-9_dp, stiffening = 1.15_dp
    real(dp) :: place

    misalignment = 0
    if (.not. shaft%span > 0) return
    associate (d => shaft%pinion_diameter)
      place = merge(0.48_dp, 0.8_dp, d >= stiffening*shaft%diameter)*shaft%span*shaft%offset_to_torque()/d**2 &
              *(d/shaft%diameter)**4
      misalignment = line_load*rule*(abs(1 + place - 0.3_dp) + 0.3_dp)*(width/d)**2
    end associate
  end function iso_shaft_misalignment
end module gearsweep_face_iso
