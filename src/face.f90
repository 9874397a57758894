!> Load distribution over the face width: compliance over the face, leads and misalignment, load and K_H beta.
!>
!> Other rooms use this module, and none of the room's own modules.
module gearsweep_face
  ! Gap between the flanks of a pair over the face width.
  use gearsweep_face_alignment, only: alignment_t, lead_t
  ! Face load factor of ISO 6336-1, method C, and the equivalent misalignment of the pinion's shaft.
  use gearsweep_face_iso, only: iso_face_load_factor, iso_shaft_misalignment
  ! Load distribution over the face width and the path of contact of a pair of gears.
  use gearsweep_face_load, only: face_load_t, face_mesh_t, find_face_load, find_pair_loads, make_face_mesh, pair_loads_t
  ! Deflection of the pinion's shaft over the face width.
  use gearsweep_face_shaft, only: far, near, shaft_t
  ! Pairs of teeth as springs, for their motion.
  use gearsweep_face_springs, only: chord_loads, find_chords, find_springs, springs_of_pair
  implicit none
  public
end module gearsweep_face
