!> Root stress: convergence, its error estimate, load shares, components, and
!> ISO 6336's form factors beside it. Beam formulas, outline, pictures.
module test_elastic_stress
  use gearsweep_rating_beam, only: beam_t, hassan_shape
  use gearsweep_gear_profile, only: gear_outline
  use gearsweep_base_error, only: error_t
  use gearsweep_rating_form, only: iso_form, iso_form_t, lewis_factor, outer_single_contact
  use gearsweep_gear_gear, only: coast, drive, gear_spec_t, gear_t, make_gear
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_elastic_material, only: material_t
  use gearsweep_elastic_section, only: make_section, make_two_grids, section_body_t, section_options_t, section_t
  use gearsweep_elastic_stress, only: root_stress, root_stress_t
  use gearsweep_base_text, only: str
  use gearsweep_elastic_vtu, only: vtu_field_t, write_vtu
  use test_support_gears, only: hassan_gear, hassan_options, hassan_pair
  use test_properties_random_bodies, only: random_body, random_body_t
  use test_support_testing, only: tally_t, check_true, check_close, check_error, check_no_error
  implicit none
  private
  public :: run

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('hassan_root')) call hassan_root(t)
    if (t%wants('load_and_sides')) call load_and_sides(t)
    if (t%wants('whole_gear')) call whole_gear(t)
    if (t%wants('beams')) call beams(t)
    if (t%wants('forms')) call forms(t)
    if (t%wants('outline')) call outline(t)
    if (t%wants('picture')) call picture(t)
    if (t%wants('honest_estimates')) call honest_estimates(t)
    if (t%wants('few_teeth')) call few_teeth(t)
  end subroutine run

  subroutine stress_of(gear, material, options, radius, line_load, stress, error)
    type(gear_t), intent(in) :: gear
    type(material_t), intent(in) :: material
    type(section_options_t), intent(in) :: options
    real(dp), intent(in) :: radius(:), line_load(:)
    type(root_stress_t), intent(out) :: stress
    type(error_t), allocatable, intent(out) :: error
    type(section_body_t) :: grids(2)

    call make_two_grids(gear, material, options, grids, error)
    if (.not. allocated(error)) call root_stress(grids, radius, line_load, stress, error)
  end subroutine stress_of

  !> Largest stress converges to 0.1 %, and the estimate covers the error.
  subroutine hassan_root(t)
    type(tally_t), intent(inout) :: t
    type(root_stress_t) :: fine, usual, other
    type(iso_form_t) :: form
    type(error_t), allocatable :: error
    type(material_t) :: material
    type(gear_t) :: gear
    real(dp) :: radius
    real(dp), allocatable :: along(:), components(:, :)

    material = material_t(2.15e11_dp, 0.3_dp, 8750.0_dp)
    gear = hassan_gear(30)
    radius = outer_single_contact(hassan_pair(), 1)
    call stress_of(gear, material, hassan_options(36), [radius], [224e3_dp], fine, error)
    call check_no_error(t, 'root stress', error)
    call stress_of(gear, material, hassan_options(20), [radius], [224e3_dp], usual, error)
    call stress_of(gear, material, hassan_options(10), [radius], [224e3_dp], other, error)
    call check_close(t, 'largest tension', usual%tension%stress, fine%tension%stress, relative=1e-3_dp)
    call check_close(t, 'largest compression', usual%compression%stress, fine%compression%stress, relative=1e-3_dp)
    call check_true(t, 'the estimate covers the error', abs(other%tension%stress/fine%tension%stress - 1) &
      < other%error_estimate, str(other%error_estimate))
    call check_true(t, 'the estimate is small', usual%error_estimate < 1e-2_dp, str(usual%error_estimate))
    call check_true(t, 'tension on the loaded side', fine%tension%side == drive .and. fine%compression%side == coast)
    form = iso_form(gear, radius)
    call check_close(t, 'ISO 6336-3 for the same tooth', fine%tension%stress, &
      224e3_dp*cos(20*pi/180)/gear%spec%module*form%form_factor*form%correction, relative=0.05_dp)
    call fine%at_tangent(coast, pi/6, along, components, error)
    call check_close(t, 'components on the compression side', components(1, 1) + components(2, 1), along(1))
    call check_close(t, 'uniaxial', components(1, 1)*components(2, 1), components(3, 1)**2)
    call fine%at_tangent(drive, 2.0_dp, along, components, error)
    call check_error(t, 'no such tangent', error, 'must lie between')
  end subroutine hassan_root

  !> Stress is proportional to the share of the load, and moves out with it.
  subroutine load_and_sides(t)
    type(tally_t), intent(inout) :: t
    type(root_stress_t) :: stress
    type(error_t), allocatable :: error
    type(gear_t) :: gear

    gear = hassan_gear(30)
    call stress_of(gear, material_t(), hassan_options(8), [gear%tip_radius, gear%tip_radius, 0.37_dp], &
                     [1e5_dp, 2e5_dp, 2e5_dp], stress, error)
    call check_no_error(t, 'moving load', error)
    call check_true(t, 'the worst load', stress%tension%load == 2)
    call check_close(t, 'proportional', maxval(stress%side(drive)%stress(:, 2)), &
                     2*maxval(stress%side(drive)%stress(:, 1)), relative=1e-10_dp)
    call stress_of(gear, material_t(), hassan_options(8), [0.3_dp], [1e5_dp], stress, error)
    call check_error(t, 'load off the path', error, 'off the flank')
    call stress_of(gear, material_t(), hassan_options(8), [0.37_dp], [real(dp) ::], stress, error)
    call check_error(t, 'no load', error, 'line loads')
  end subroutine load_and_sides

  !> The notch sees the tooth, not the far support.
  subroutine whole_gear(t)
    type(tally_t), intent(inout) :: t
    type(root_stress_t) :: part, whole
    type(section_options_t) :: options
    type(error_t), allocatable :: error
    type(gear_t) :: gear

    gear = hassan_gear(30)
    options%rim = 0.140625_dp
    options%elements_across = 10
    options%others_across = 4
    call stress_of(gear, material_t(), options, [0.385_dp], [1e5_dp], part, error)
    options%teeth = 30
    call stress_of(gear, material_t(), options, [0.385_dp], [1e5_dp], whole, error)
    call check_no_error(t, 'whole gear', error)
    call check_close(t, 'largest tension of whole gear and section', whole%tension%stress, part%tension%stress, &
                     relative=0.06_dp)
  end subroutine whole_gear

  !> Hassan et al. 2009, Eqs. 1 to 8; the printed 50968 rad/s does not follow from them.
  subroutine beams(t)
    type(tally_t), intent(inout) :: t
    type(material_t) :: stated
    type(beam_t) :: beam
    type(error_t), allocatable :: error
    real(dp) :: omega

    stated = material_t(2.15e11_dp, 0.3_dp, 8750.0_dp)
    beam = beam_t(0.05625_dp, pi*0.025_dp/2, 0.125_dp)
    call check_close(t, 'Eq. 1 with the stated inputs', beam%spring_frequency(stated), 30761.0_dp, relative=1e-4_dp)
    call beam%rayleigh_frequency(stated, hassan_shape, omega, error)
    call check_close(t, 'Eqs. 5, 6', omega, sqrt(66.0_dp/5)/sqrt(3.0_dp)*beam%spring_frequency(stated))
    call check_true(t, 'Rayleigh bounds from above', omega > beam%exact_frequency(stated))
    call beam%rayleigh_frequency(stated, [1.0_dp, 2.0_dp], omega, error)
    call check_error(t, 'a shape that does not bend', error, 'Rayleigh')
    beam%length = 0.047615_dp
    call check_close(t, '44600 rad/s with the inferred inputs', &
                     beam%spring_frequency(material_t(2.07e11_dp, 0.3_dp, 7800.0_dp)), 44600.0_dp, relative=1e-3_dp)
    associate (sigma => beam%stress(28000.0_dp, 20*pi/180)/1e6_dp)
      call check_close(t, 'Eq. 7', sigma(1), 1.951_dp, relative=1e-3_dp)
      call check_close(t, 'Eq. 8', sigma(2), 39.006_dp, relative=1e-3_dp)
    end associate
  end subroutine beams

  subroutine forms(t)
    type(tally_t), intent(inout) :: t
    type(gear_t) :: gear
    type(iso_form_t) :: form
    type(error_t), allocatable :: error
    real(dp) :: turn, g, h
    integer :: i

    call make_gear(gear_spec_t('pinion', 30, 1.0_dp, face_width=1.0_dp), gear, error)
    call check_close(t, 'Lewis factor of 30 full-depth teeth, tip load', lewis_factor(gear, gear%tip_radius), 0.359_dp, &
                     relative=0.02_dp)
    ! The standard's own equations for a generated tooth.
    form = iso_form(gear, gear%tip_radius)
    g = 0.25_dp - 1.25_dp
    h = 2.0_dp/30*(pi/2 - (pi/4 - 1.25_dp*tan(20*pi/180) - 0.25_dp*(1 - sin(20*pi/180))/cos(20*pi/180))) - pi/3
    turn = pi/6
    do i = 1, 50
      turn = 2*g/30*tan(turn) - h
    end do
    call check_close(t, 'ISO root thickness', form%thickness, 30*sin(pi/3 - turn) + sqrt(3.0_dp)*(g/cos(turn) - 0.25_dp), &
                     relative=1e-9_dp)
    call check_close(t, 'ISO notch radius', form%radius, 0.25_dp + 2*g**2/(cos(turn)*(30*cos(turn)**2 - 2*g)), &
                     relative=1e-9_dp)
  end subroutine forms

  subroutine outline(t)
    type(tally_t), intent(inout) :: t
    real(dp), allocatable :: points(:, :)
    type(gear_t) :: gear
    type(section_t) :: section
    type(error_t), allocatable :: error
    real(dp) :: area

    gear = hassan_gear(30)
    points = gear_outline(gear, 40)
    area = sum(cshift(points(1, :), 1)*points(2, :) - points(1, :)*cshift(points(2, :), 1))/2
    call make_section(gear, section_options_t(teeth=30, rim=0.1_dp, elements_across=10), section, error)
    call check_close(t, 'outline and grid enclose the same area', area, &
                     section%grid%area() + pi*section%inner_radius**2, relative=1e-5_dp)
    call check_close(t, 'outline reaches the tip', maxval(norm2(points, 1)), gear%tip_radius)
    call check_close(t, 'outline reaches the root', minval(norm2(points, 1)), gear%root_radius)
  end subroutine outline

  subroutine picture(t)
    type(tally_t), intent(inout) :: t
    type(section_t) :: section
    type(vtu_field_t) :: position(1)
    type(error_t), allocatable :: error
    character(:), allocatable :: text
    integer :: i

    call make_section(hassan_gear(30), section_options_t(teeth=1, elements_across=3), section, error)
    position(1) = vtu_field_t('position', section%grid%x)
    call write_vtu(section%grid, position, text)
    call check_true(t, 'VTK file', index(text, '<VTKFile') == 1 .and. index(text, '</VTKFile>') > 0)
    call check_true(t, 'a line for each node, twice', &
                    count([(text(i:i) == new_line('a'), i=1, len(text))]) > 2*size(section%grid%x, 2))
  end subroutine picture

  !> Random sections of 12 to 80 teeth on 3 to 10 elements across, beside grids three times as fine: the error of the largest
  !> stresses is nowhere above twice the estimate, nor a hundredth of it throughout. `sh bench/run.sh honesty` has many more.
  subroutine honest_estimates(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: bodies = 14, finest = 27
    type(random_body_t) :: body
    real(dp) :: ratio(bodies), asked(3), truth(3)
    integer :: i, found

    i = -1
    found = 0
    do while (found < bodies)
      i = i + 2
      call random_body(i, 10, 6, body)
      if (body%gear%spec%teeth < 12 .or. body%options%teeth > 3) cycle
      found = found + 1
      asked = peaks_of(t, body)
      body%options%elements_across = min(3*body%options%elements_across, finest)
      truth = peaks_of(t, body)
      ratio(found) = maxval(abs(asked(:2)/truth(:2) - 1))/asked(3)
    end do
    call check_true(t, 'no error above twice its estimate', all(ratio <= 2), str(maxval(ratio)))
    call check_true(t, 'estimates are not far too large', 2*count(ratio > 0.1_dp) > bodies, str(count(ratio > 0.1_dp)))
  end subroutine honest_estimates

  !> An undercut tooth, whose fillet has two points of one height: the finer the grid, the smaller the estimate, down to what the
  !> peaks of two fine grids differ by.
  subroutine few_teeth(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: across(3) = [6, 12, 24]
    type(random_body_t) :: body
    type(error_t), allocatable :: error
    real(dp) :: peaks(3, 3)
    integer :: i

    call make_gear(gear_spec_t('pinion', 12, 0.003_dp, face_width=0.02_dp), body%gear, error)
    call check_no_error(t, 'twelve teeth', error)
    body%radius = 0.98_dp*body%gear%tip_radius
    do i = 1, 3
      body%options = section_options_t(elements_across=across(i))
      peaks(:, i) = peaks_of(t, body)
    end do
    call check_true(t, 'finer grids have smaller estimates', peaks(3, 2) < peaks(3, 1) .and. peaks(3, 3) < peaks(3, 2), &
                    str(peaks(3, 1))//', '//str(peaks(3, 2))//', '//str(peaks(3, 3)))
    call check_true(t, 'a fine grid has a small one', peaks(3, 3) < 5e-3_dp, str(peaks(3, 3)))
    do i = 1, 2
      call check_true(t, 'twelve teeth: the estimate covers the error', maxval(abs(peaks(:2, i)/peaks(:2, 3) - 1)) < &
                      2*peaks(3, i), str(peaks(3, i)))
    end do
  end subroutine few_teeth

  !> Largest tension and compression of a body under its load, and their error estimate.
  function peaks_of(t, body) result(peaks)
    type(tally_t), intent(inout) :: t
    type(random_body_t), intent(in) :: body
    real(dp) :: peaks(3)
    type(section_body_t) :: grids(2)
    type(root_stress_t) :: stress
    type(error_t), allocatable :: error

    call make_two_grids(body%gear, material_t(), body%options, grids, error)
    if (.not. allocated(error)) call root_stress(grids, [body%radius], [1e5_dp], stress, error)
    call check_no_error(t, 'stress of a random body', error)
    peaks = [stress%tension%stress, stress%compression%stress, stress%error_estimate]
  end function peaks_of
end module test_elastic_stress
