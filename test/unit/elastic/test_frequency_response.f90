!> A tooth under a load of steady frequency: closed forms of one mode, the load at rest, reciprocity, resonances against a dense
!> scan, and the motion over time that the same modes have.
module test_frequency_response
  use gearsweep_study_case_case, only: case_t
  use gearsweep_api_case_reader, only: read_case
  use gearsweep_base_error, only: error_t
  use gearsweep_elastic_modal_response, only: find_peak, frequencies_around, load_history_t, modal_model_t, motion_record_t, &
            response_to, superpose
  use gearsweep_elastic_compliance, only: flank_load
  use gearsweep_gear_gear, only: coast
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_elastic_material, only: material_t
  use gearsweep_elastic_modes, only: find_modes, modes_t
  use gearsweep_elastic_section, only: make_section_body, make_two_grids, section_body_t
  use gearsweep_elastic_stress, only: root_stress, root_stress_t
  use gearsweep_study_run_study, only: run_study, study_t
  use gearsweep_base_table, only: table_t
  use gearsweep_api_tables, only: column_of, make_table
  use gearsweep_base_text, only: str
  use test_support_gears, only: contact_ratio, hassan_gear, hassan_options, stated_t
  use test_support_testing, only: check_close, check_equal, check_error, check_no_error, check_true, tally_t
  implicit none
  private
  public :: run

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('one_mode')) call one_mode(t)
    if (t%wants('steady_motion')) call steady_motion(t)
    if (t%wants('reciprocity')) call reciprocity(t)
    if (t%wants('reciprocity_of_a_section')) call reciprocity_of_a_section(t)
    if (t%wants('whatever_is_listed')) call whatever_is_listed(t)
    if (t%wants('at_rest')) call at_rest(t)
    if (t%wants('resonances')) call resonances(t)
    if (t%wants('campbell')) call campbell(t)
    if (t%wants('refusals')) call refusals(t)
  end subroutine run

  !> One oscillator without what its static response lacks: 1/(w^2 sqrt((1 - r^2)^2 + (2 zeta r)^2)), behind the load by
  !> atan(2 zeta r/(1 - r^2)), largest at r^2 = 1 - 2 zeta^2 (Clough and Penzien 1993, section 3.2).
  subroutine one_mode(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: w = 7, zeta(*) = [1e-4_dp, 0.02_dp, 0.3_dp], r(*) = [0.0_dp, 1e-6_dp, 0.4_dp, 0.999_dp, 1.0_dp, 30.0_dp]
    type(modal_model_t) :: model
    complex(dp) :: found(1)
    integer :: i, k

    do i = 1, size(zeta)
      model = model_of([w], 2*zeta(i)*[w], reshape([2.0_dp], [1, 1]), reshape([3.0_dp], [1, 1]), reshape([6/w**2], [1, 1]))
      do k = 1, size(r)
        found = response_to(model, [1], 1, r(k)*w)
        call check_close(t, 'amplitude, ratio '//str(r(k)), abs(found(1)), 6/w**2/sqrt((1 - r(k)**2)**2 + (2*zeta(i)*r(k))**2), &
                         1e-11_dp)
        call check_close(t, 'phase, ratio '//str(r(k)), atan2(aimag(found(1)), real(found(1), dp)), &
                         -atan2(2*zeta(i)*r(k), 1 - r(k)**2), absolute=1e-9_dp)
      end do
      call check_close(t, 'peak', find_peak(model, 1, 1, 1), w*sqrt(1 - 2*zeta(i)**2), 1e-7_dp)
    end do
  end subroutine one_mode

  type(modal_model_t) function model_of(frequency, damping, shape, force, static) result(model)
    real(dp), intent(in) :: frequency(:), damping(:), shape(:, :), force(:, :), static(:, :)

    model%frequency = frequency
    model%damping = damping
    model%shape = shape
    model%force = force
    model%static = static
  end function model_of

  !> Three modes, of which the static response has more than they have.
  type(modal_model_t) function some_modes() result(model)
    real(dp), parameter :: force(3, 2) = reshape([1.0_dp, -2.0_dp, 0.5_dp, 0.3_dp, 1.1_dp, -0.7_dp], [3, 2])

    model = model_of([2.0_dp, 2.5_dp, 9.0_dp], [0.05_dp, 0.02_dp, 0.4_dp], transpose(force), force, &
                     reshape([0.9_dp, -0.2_dp, -0.2_dp, 0.8_dp], [2, 2]))
  end function some_modes

  !> What a load sin(a t) does over time, in short pieces and long after its begin, has this amplitude and phase.
  subroutine steady_motion(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: turns = 200, pieces = 400
    type(modal_model_t) :: model
    type(load_history_t) :: history
    type(motion_record_t) :: record
    type(error_t), allocatable :: error
    complex(dp) :: expected(2)
    real(dp), parameter :: frequency(3) = [1.1_dp, 2.45_dp, 8.0_dp]
    real(dp) :: largest
    integer :: i, k

    model = some_modes()
    model%damping = [0.2_dp, 0.25_dp, 0.4_dp]
    ! In the response, what the modes leave out follows the load at once; over time it has inertia, here of next to no effect.
    model%residual_frequency = [1e5_dp, 1e5_dp]
    do k = 1, 3
      associate (a => frequency(k))
        expected = response_to(model, [1, 2], 1, a)
        history%time = [(2*pi/a*i/pieces, i=0, turns*pieces)]
        history%load = sin(a*history%time)
        history%weight = spread([1.0_dp, 0.0_dp], 2, turns*pieces + 1)
        call superpose(model, history, [1, 2], history%time((turns - 1)*pieces:), 1, .true., record, error)
        call check_no_error(t, 'motion', error)
        largest = maxval(abs(expected))
        do i = 1, 2
          call check_close(t, 'steady motion, row '//str(i), maxval(abs(record%value(i, :) - aimag(expected(i) &
                           *exp(cmplx(0.0_dp, a*record%time, dp)))))/largest, 0.0_dp, absolute=1e-4_dp)
        end do
      end associate
    end do
  end subroutine steady_motion

  !> A displacement at one place under a load at another is the same the other way round (Maxwell, Rayleigh).
  subroutine reciprocity(t)
    type(tally_t), intent(inout) :: t
    type(modal_model_t) :: model
    complex(dp) :: one(1), other(1)
    integer :: k

    model = some_modes()
    do k = 0, 40
      one = response_to(model, [1], 2, k/4.0_dp)
      other = response_to(model, [2], 1, k/4.0_dp)
      call check_close(t, 'reciprocity', abs(one(1) - other(1)), 0.0_dp, absolute=1e-14_dp*abs(one(1)))
    end do
  end subroutine reciprocity

  !> The same of a section by finite elements, at rest, between its natural frequencies and in them: what a node of the coast fillet
  !> does sideways under a load on the drive flank is what that place of the flank does along its load under a force on the node.
  !> Displacements are read off the solutions, not made from both loads alike.
  subroutine reciprocity_of_a_section(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: count = 6
    type(section_body_t) :: grid
    type(modes_t) :: modes
    type(modal_model_t) :: model
    type(error_t), allocatable :: error
    real(dp), allocatable :: load(:, :), x(:, :), force(:, :)
    integer, allocatable :: fillet(:)
    complex(dp) :: there(1), back(1)
    real(dp) :: angular
    integer :: node, i, k

    call make_section_body(hassan_gear(30), material_t(), hassan_options(6), grid, error)
    if (.not. allocated(error)) call find_modes(grid%body, count, modes, error)
    call check_no_error(t, 'a section and its modes', error)
    associate (body => grid%body, section => grid%section)
      fillet = section%surface(section%loaded, coast)
      node = fillet(5)
      allocate (load(body%unknowns, 2), source=0.0_dp)
      allocate (force(2, size(section%grid%x, 2)), source=0.0_dp)
      force(1, node) = 1
      call flank_load(section, body, 0.99_dp*section%gear%tip_radius, load(:, 1), error)
      call check_no_error(t, 'load on the flank', error)
      load(:, 2) = body%gather(force)
      x = load
      call body%stiffness%solve(x, error)
      call check_no_error(t, 'both loads', error)
      model%static = reshape([(seen(x(:, i)), i=1, 2)], [2, 2])
      model%shape = reshape([(seen(body%gather(modes%shape(:, :, k))), k=1, count)], [2, count])
      allocate (model%force(count, 2))
      do k = 1, count
        model%force(k, :) = matmul(body%gather(modes%shape(:, :, k)), load)
      end do
    end associate
    model%frequency = 2*pi*modes%frequency
    model%damping = 0.02_dp*model%frequency
    do i = 0, 2*count
      angular = 0
      if (i > 0) angular = model%frequency((i + 1)/2)*merge(1.0_dp, 1.03_dp, mod(i, 2) == 1)
      there = response_to(model, [2], 1, angular)
      back = response_to(model, [1], 2, angular)
      call check_true(t, 'there is a response', abs(there(1)) > 1e-3_dp*maxval(abs(model%static)))
      call check_close(t, 'there and back', abs(there(1) - back(1))/abs(there(1)), 0.0_dp, absolute=1e-8_dp)
    end do

  contains

    !> What is seen of a displacement: along the load on the flank, by the work that a unit load does, and at the node sideways.
    function seen(unknowns) result(values)
      real(dp), intent(in) :: unknowns(:)
      real(dp) :: values(2)
      real(dp), allocatable :: u(:, :)

      u = grid%body%spread_out(unknowns)
      values = [dot_product(load(:, 1), unknowns), u(1, node)]
    end function seen
  end subroutine reciprocity_of_a_section

  !> Between two listed frequencies far apart a narrow peak is met, which a dense scan finds too; each frequency stands once, and
  !> they ascend.
  subroutine whatever_is_listed(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: dense = 200000
    type(modal_model_t) :: model
    real(dp), allocatable :: angular(:), size_of(:)
    real(dp) :: largest, found
    complex(dp) :: seen(1)
    integer :: i

    model = some_modes()
    model%damping(2) = 1e-4_dp
    angular = frequencies_around(model, [0.0_dp, 20.0_dp])
    call check_true(t, 'ascending', all(angular(2:) > angular(:size(angular) - 1)))
    call check_close(t, 'from the first', angular(1), 0.0_dp, absolute=0.0_dp)
    call check_close(t, 'to the last', angular(size(angular)), 20.0_dp, absolute=0.0_dp)
    call check_true(t, 'a hundredth of the way at most between', &
                    all(angular(2:) - angular(:size(angular) - 1) <= 0.2_dp*(1 + 1e-12_dp)))
    largest = 0
    do i = 1, dense
      seen = response_to(model, [1], 1, 2.4_dp + 0.2_dp*i/dense)
      largest = max(largest, abs(seen(1)))
    end do
    allocate (size_of(size(angular)))
    do i = 1, size(angular)
      seen = response_to(model, [1], 1, angular(i))
      size_of(i) = abs(seen(1))
    end do
    seen = response_to(model, [1], 1, find_peak(model, 1, 1, 2))
    found = abs(seen(1))
    call check_true(t, 'no frequency of a dense scan is higher than the peak', largest <= found*(1 + 1e-12_dp), &
                    str(largest/found - 1))
    call check_close(t, 'the peak is that of the scan', largest, found, 1e-2_dp)
    call check_close(t, 'the list meets it', maxval(size_of), found, 1e-3_dp)
    angular = frequencies_around(model, [3.0_dp, 4.0_dp])
    call check_true(t, 'nothing outside', all(angular >= 3) .and. all(angular <= 4))
    ! In Hz; the second is the half of the way, which rounding puts beside it.
    model%frequency = 1e6_dp
    angular = frequencies_around(model, 2*pi*[1000.0_dp, 2000.0_dp, 3000.0_dp])
    call check_equal(t, 'a listed frequency that is a hundredth of the way stands once', size(angular), 101)
  end subroutine whatever_is_listed

  ! --- the task --------------------------------------------------------------------

  subroutine solve(t, keys, study)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: keys
    type(study_t), intent(out) :: study
    type(case_t) :: case
    type(error_t), allocatable :: error

    call read_case('&case tasks = ''harmonic'' / &pair module_mm = 25 face_width_mm = 125 / '// &
                   '&pinion teeth = 30 rack_tip_radius = 0.3 effective_mass_kg = 50 / '// &
                   '&gear teeth = 60 rack_tip_radius = 0.3 effective_mass_kg = 90 / &mesh model = ''polynomial'' '// &
                   'coefficients = 1500 / &material young_gpa = 215 density_kgm3 = 8750 / &load normal_force_n = 28000 / '// &
                   '&section half_angle_deg = 17.5 rim_mm = 140.625 elements_across = 6 plane = ''stress'' / '//keys, case, error)
    call check_no_error(t, 'the case', error)
    call run_study(case, '', 1, study, error)
    call check_no_error(t, 'the study', error)
  end subroutine solve

  !> At frequency 0, and with three modes only, the stress is that of finite elements under the load at rest.
  subroutine at_rest(t)
    type(tally_t), intent(inout) :: t
    type(study_t) :: study
    type(section_body_t) :: grids(2)
    type(root_stress_t) :: static
    type(error_t), allocatable :: error
    real(dp), allocatable :: s(:), stress(:), seen(:), frequency(:), components(:, :), radius(:), strain(:)

    call solve(t, '&harmonic frequency_hz = 0, 8000 modes = 3 s = 0.9 /', study)
    frequency = column_of(study, 'harmonic', 'frequency_hz')
    seen = column_of(study, 'harmonic', 'stress_mpa')
    strain = column_of(study, 'harmonic', 'strain_um_m')
    s = column_of(study, 'harmonic', 's')
    call check_close(t, 'the first frequency', frequency(1), 0.0_dp, absolute=0.0_dp)
    call make_two_grids(hassan_gear(30), material_t(2.15e11_dp, 0.3_dp, 8750.0_dp), hassan_options(6), grids, error)
    call check_no_error(t, 'grids', error)
    allocate (radius, source=[study%pair%radius(1, s(1))])
    call root_stress(grids, radius, [28000/0.125_dp], static, error)
    call check_no_error(t, 'static stress', error)
    call static%at_tangent(1, pi/6, stress, components, error)
    call check_no_error(t, 'tangent', error)
    call check_close(t, 'stress at rest', seen(1), abs(stress(1))/1e6_dp, 1e-9_dp)
    call check_close(t, 'strain at rest', strain(1), abs(stress(1))/2.15e5_dp, 1e-9_dp)
  end subroutine at_rest

  !> No listed or added frequency has more than the peak of its mode; twice the load, twice the stress; a list of other frequencies
  !> leaves the peaks as they are, to the last bit.
  subroutine resonances(t)
    type(tally_t), intent(inout) :: t
    type(study_t) :: study, other
    type(table_t) :: peaks, again
    type(error_t), allocatable :: error
    real(dp), allocatable :: seen(:)
    integer :: i

    call solve(t, '&harmonic frequency_hz = 0, 20000 modes = 4 damping_ratio = 0.005 /', study)
    call solve(t, '&harmonic frequency_hz = 1, 3, 7000 modes = 4 damping_ratio = 0.005 amplitude_n = 56000 /', other)
    call make_table(study, 'section_resonances', peaks, error)
    call make_table(other, 'section_resonances', again, error)
    call check_no_error(t, 'tables', error)
    call check_equal(t, 'a row for each mode and side', peaks%rows, 8)
    do i = 1, peaks%rows
      call check_close(t, 'peak, row '//str(i), again%number('peak_frequency_hz', i), peaks%number('peak_frequency_hz', i), &
                       absolute=0.0_dp)
      call check_close(t, 'stress, row '//str(i), again%number('stress_mpa', i), 2*peaks%number('stress_mpa', i), 1e-13_dp)
    end do
    seen = column_of(study, 'harmonic', 'stress_mpa')
    call check_close(t, 'the largest of all frequencies', maxval(seen), maxval(column_of(study, 'section_resonances', &
                     'stress_mpa')), 1e-3_dp)
    call check_true(t, 'is not above the peaks', maxval(seen) <= maxval(column_of(study, 'section_resonances', 'stress_mpa')) &
                    *(1 + 1e-9_dp))
    call check_true(t, 'the first mode amplifies', peaks%number('amplification', 1) > 10, str(peaks%number('amplification', 1)))
  end subroutine resonances

  !> Speed times teeth times harmonic is the frequency; the section's frequencies are those of the task `modal`.
  subroutine campbell(t)
    type(tally_t), intent(inout) :: t
    type(study_t) :: study
    type(table_t) :: speeds, peaks
    type(error_t), allocatable :: error
    integer :: i

    call solve(t, '&harmonic frequency_hz = 0, 20000 modes = 2 harmonics = 3 /', study)
    call make_table(study, 'campbell', speeds, error)
    call make_table(study, 'section_resonances', peaks, error)
    call check_no_error(t, 'tables', error)
    call check_equal(t, 'rows', speeds%rows, 9)
    do i = 1, speeds%rows
      call check_close(t, 'mesh frequency', speeds%number('rpm', i)/60*30*(1 + modulo(i - 1, 3)), &
                       speeds%number('frequency_hz', i), 1e-13_dp)
      call check_true(t, 'system', speeds%word('system', i) == merge('gears  ', 'section', i <= 3))
    end do
    ! One of the two went through rad/s and back, which rounds twice.
    do i = 1, 2
      call check_close(t, 'frequency of the section', speeds%number('frequency_hz', 1 + 3*i), &
                       peaks%number('natural_frequency_hz', i), 1e-15_dp)
    end do
    ! As many pairs carry in the mean as the contact ratio says.
    call check_close(t, 'frequency of the gears', speeds%number('frequency_hz', 1), &
                     sqrt(contact_ratio(stated_t(module=25.0_dp, teeth=[30, 60], distance=1125.0_dp))*1.5e9_dp &
                          *(1/50.0_dp + 1/90.0_dp))/(2*pi), 1e-9_dp)
  end subroutine campbell

  subroutine refusals(t)
    type(tally_t), intent(inout) :: t

    call refuse('frequency_hz = 0, 9 damping_ratio = 0', '&harmonic damping_ratio = 0: must be at least 1e-6')
    call refuse('frequency_hz = 9, 9', '&harmonic frequency_hz: must ascend; 9 comes after 9')
    call refuse('frequency_hz = 0, 9 s = 1.9', '&harmonic s = 1.9: must be at most the contact ratio 1.6')
    call refuse('frequency_hz = 0, 9 tangent_deg = 1', '&harmonic tangent_deg')

  contains

    subroutine refuse(keys, says)
      character(*), intent(in) :: keys, says
      type(case_t) :: case
      type(study_t) :: study
      type(error_t), allocatable :: error

      call read_case('&case tasks = ''harmonic'' / &pair module_mm = 3 face_width_mm = 20 / &pinion teeth = 21 / '// &
                     '&gear teeth = 34 / &load normal_force_n = 4000 / &mesh model = ''iso6336'' / '// &
                     '&section teeth = 1 elements_across = 3 / &harmonic modes = 2 '//keys//' /', case, error)
      if (.not. allocated(error)) call run_study(case, '', 1, study, error)
      call check_error(t, keys, error, contains=says)
    end subroutine refuse
  end subroutine refusals
end module test_frequency_response
