!> Pairs of spur and helical gears for tests of the load over the face, and numbers of a load distribution.
module test_support_faces
  use gearsweep_base_error, only: error_t
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_elastic_fe_stiffness, only: fe_options_t
  use gearsweep_elastic_material, only: material_t
  use gearsweep_face_alignment, only: alignment_t, lead_t
  use gearsweep_face_load, only: face_load_t, face_mesh_t, make_face_mesh
  use gearsweep_gear_gear, only: gear_spec_t, gear_t, make_gear
  use gearsweep_gear_pair, only: free_centre_distance, make_pair, pair_t
  use gearsweep_gear_relief, only: profile_error, relief_t
  use test_support_random_numbers, only: random_t
  use test_support_testing, only: check_no_error, tally_t
  implicit none
  private
  public :: make_teeth, make_faces, relieve, random_alignment, mirrored, mean_error, range_of, miss_of_sum, numbers_of

contains

  !> Makes a pair without backlash; lengths in mm, angle in degrees. `addendum` in modules; absent: the standard rack.
  subroutine make_teeth(t, teeth, shift, module, width, pair, helix_angle, addendum)
    type(tally_t), intent(inout) :: t
    integer, intent(in) :: teeth(2)
    real(dp), intent(in) :: shift(2), module, width
    type(pair_t), intent(out) :: pair
    real(dp), intent(in), optional :: helix_angle, addendum
    type(gear_spec_t) :: spec
    type(gear_t) :: gear(2)
    type(error_t), allocatable :: error
    integer :: i

    do i = 1, 2
      spec%teeth = teeth(i)
      spec%module = module/1000
      spec%profile_shift = shift(i)
      spec%face_width = width/1000
      if (present(helix_angle)) spec%helix_angle = helix_angle*pi/180*merge(1, -1, i == 1)
      if (present(addendum)) then
        spec%addendum = addendum
        spec%dedendum = addendum + 0.25_dp
        spec%rack_tip_radius = 0.2_dp
      end if
      call make_gear(spec, gear(i), error)
      call check_no_error(t, 'gear', error)
    end do
    call make_pair(gear(1), gear(2), free_centre_distance(gear(1), gear(2)), pair, error)
    call check_no_error(t, 'pair', error)
  end subroutine make_teeth

  !> Makes the mesh over the face of such a pair of steel gears. `options`: of the plane compliance; absent: the default.
  subroutine make_faces(t, teeth, shift, module, width, mesh, helix_angle, addendum, options)
    type(tally_t), intent(inout) :: t
    integer, intent(in) :: teeth(2)
    real(dp), intent(in) :: shift(2), module, width
    type(face_mesh_t), intent(out) :: mesh
    real(dp), intent(in), optional :: helix_angle, addendum
    type(fe_options_t), intent(in), optional :: options
    type(fe_options_t) :: own
    type(material_t) :: steel(2)
    type(pair_t) :: pair
    type(error_t), allocatable :: error

    if (present(options)) own = options
    call make_teeth(t, teeth, shift, module, width, pair, helix_angle, addendum)
    call make_face_mesh(pair, steel, own, mesh, error)
    call check_no_error(t, 'mesh over the face', error)
  end subroutine make_faces

  !> Gives the mesh tip relief of both gears: um, and mm of the path.
  subroutine relieve(t, tip_relief, mesh)
    type(tally_t), intent(inout) :: t
    real(dp), intent(in) :: tip_relief(2)
    type(face_mesh_t), intent(inout) :: mesh
    type(relief_t) :: relief
    type(error_t), allocatable :: error

    if (.not. tip_relief(1) > 0) return
    relief%amount = tip_relief(1)*1e-6_dp
    associate (length => tip_relief(2)/1000/mesh%pair%base_pitch)
      relief%start = [mesh%pair%contact_ratio - length, length]
    end associate
    call profile_error(relief, mesh%pair%contact_ratio, mesh%profile_error, error)
    call check_no_error(t, 'tip relief', error)
  end subroutine relieve

  !> Random misalignment and leads of a face of this width (m).
  type(alignment_t) function random_alignment(random, width) result(alignment)
    type(random_t), intent(inout) :: random
    real(dp), intent(in) :: width

    alignment%misalignment = random%between(-80e-6_dp, 80e-6_dp)
    alignment%lead(1) = lead_t(slope=random%between(-10e-6_dp, 10e-6_dp), crowning=random%between(0.0_dp, 40e-6_dp))
    alignment%lead(2) = lead_t(end_relief=random%between(0.0_dp, 20e-6_dp), &
                               end_relief_length=width*random%between(0.01_dp, 0.5_dp))
  end function random_alignment

  !> The same faces, seen from the other end of the face.
  elemental type(alignment_t) function mirrored(alignment)
    type(alignment_t), intent(in) :: alignment

    mirrored = alignment
    mirrored%misalignment = -alignment%misalignment
    mirrored%lead%slope = -alignment%lead%slope
  end function mirrored

  !> Mean over the period of the static transmission error, um.
  pure real(dp) function mean_error(found)
    type(face_load_t), intent(in) :: found

    mean_error = 1e6_dp*sum(found%share*found%error)
  end function mean_error

  !> Peak-to-peak static transmission error, um.
  pure real(dp) function range_of(found)
    type(face_load_t), intent(in) :: found

    range_of = 1e6_dp*(maxval(found%error) - minval(found%error))
  end function range_of

  !> Largest relative deviation of the sum of all loads on slices from the `load` (N), over all phases.
  pure real(dp) function miss_of_sum(found, load) result(miss)
    type(face_load_t), intent(in) :: found
    real(dp), intent(in) :: load
    integer :: k, n

    n = size(found%gap)
    miss = maxval([(abs(sum(found%load_at(k)*(found%bounds(1:) - found%bounds(:n - 1)))/load - 1), k=1, size(found%phase))])
  end function miss_of_sum

  !> Numbers above 0 that are the same from either end of the face.
  pure function numbers_of(found) result(numbers)
    type(face_load_t), intent(in) :: found
    real(dp) :: numbers(8)

    numbers = [found%mean_factor, maxval(found%factor), found%single_factor, found%root_factor, found%edge_load + 1, &
               found%in_contact, maxval(found%pressure), mean_error(found)]
  end function numbers_of
end module test_support_faces
