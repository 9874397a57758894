!> The task `harmonic`: stress, strain and displacement at the fillets of one tooth under a harmonic load.
!>
!> Resonances are located and resolved; a table has the speeds at which harmonics of the mesh frequency meet natural frequencies.
module gearsweep_study_tasks_harmonic
  use gearsweep_base, only: axis, claim_memory, code_input, dp, each, error_t, fail, lines_t, pi, str, table_t
  use gearsweep_elastic, only: along, find_peak, frequencies_around, moved_x, moved_y, per_point, response_to, stress_error_share, &
    tooth_modes_t
  use gearsweep_study_case_task, only: stage, task_info_t
  use gearsweep_study_reader_reader, only: is_prescribed, needs_gears, reader_t, sentence_length, text_unless
  use gearsweep_study_run_stages, only: runnable_t, stages_t
  use gearsweep_study_run_unit_teeth, only: find_unit_teeth, tooth_choice_t
  implicit none
  private
  public :: steady_load_t, fill_response, fill_resonances, harmonic_task_t

  !> A load of constant frequency on a tooth.
  type :: steady_load_t
    real(dp) :: amplitude = 0                    !< amplitude, N
    real(dp), allocatable :: s(:)                !< path coordinates of the load
    real(dp), allocatable :: tangent(:)          !< fillet tangent angles of the points, rad
    real(dp) :: modulus = 0                      !< stress along a free surface over the strain along it, Pa
    real(dp) :: error_share = 0  !< part of the difference of both grids that is the error, as in gearsweep_elastic_section
  end type steady_load_t

  character(*), parameter :: of_s = 'path coordinate of the load, in base pitches from A', &
    of_tangent = 'angle of the fillet''s tangent at this point to the tooth''s axis', of_side = 'drive (the loaded side) or coast'
  character(*), parameter :: ahead = 'phase by which it leads the load', of_mode = 'from the lowest frequency'
  character(*), parameter :: sides(2) = [character(5) :: 'drive', 'coast']

  type, extends(runnable_t) :: harmonic_task_t
    type(tooth_choice_t) :: choice               !< modes, damping and points
    real(dp), allocatable :: frequency(:)        !< frequencies, Hz, ascending
    real(dp), allocatable :: s(:)                !< path coordinates of the load; not allocated: the outer point of single contact
    real(dp) :: amplitude = 0                    !< amplitude of the load, N; 0: the static load
    integer :: harmonics = 5                     !< number of mesh harmonics in the table of speeds
  contains
    procedure, nopass :: describe
    procedure :: read_keys, run, add_report
    procedure, private :: place_load
  end type harmonic_task_t

  character(*), parameter :: group = 'harmonic'

contains

  !> Fills amplitudes and phases for each place of the load, point, side and frequency. `tooth(2)`: on both grids, the finer first.
  subroutine fill_response(load, tooth, angular, table, error)
    type(steady_load_t), intent(in) :: load
    type(tooth_modes_t), intent(in) :: tooth(2)
    real(dp), intent(in) :: angular(:)           !< angular frequencies, rad/s
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    complex(dp), allocatable, dimension(:, :, :, :) :: seen, coarse  ! (frequency, quantity, point, place)
    real(dp), allocatable :: stress(:)
    integer :: n, points, places

    if (allocated(error)) return
    points = 2*size(load%tangent)
    places = size(load%s)
    n = size(angular)
    call claim_memory(8.0_dp*n*points*places*(4*per_point + 14), '&harmonic frequency_hz: '//str(n)//' frequencies', error)
    if (allocated(error)) return
    call find_amplitudes(tooth(1), places, points, angular, seen)
    call find_amplitudes(tooth(2), places, points, angular, coarse)
    call table%over('stress, strain and displacement at points of the fillets over the frequency of the load', error, &
                    axis('s', '', of_s, load%s), &
                    axis('tangent_deg', 'deg', of_tangent, load%tangent), axis('side', '', of_side, sides), &
                    axis('frequency_hz', 'Hz', 'frequency of the load', angular/(2*pi)))
    if (allocated(error)) return
    stress = load%amplitude*reshape(abs(seen(:, along, :, :)), [n*points*places])
    call table%add('stress_mpa', 'MPa', 'amplitude of the stress along the surface', stress)
    call table%add('stress_phase_deg', 'deg', ahead, flat(phase(seen(:, along, :, :))))
    call table%add('strain_um_m', 'um/m', 'amplitude of the strain along the surface', stress/load%modulus)
    call table%add('displacement_x_um', 'um', 'amplitude of the displacement across the tooth', &
                   load%amplitude*flat(abs(seen(:, moved_x, :, :))))
    call table%add('phase_x_deg', 'deg', ahead, flat(phase(seen(:, moved_x, :, :))))
    call table%add('displacement_y_um', 'um', 'amplitude of the displacement along the tooth''s axis', &
                   load%amplitude*flat(abs(seen(:, moved_y, :, :))))
    call table%add('phase_y_deg', 'deg', ahead, flat(phase(seen(:, moved_y, :, :))))
    call table%add('error_estimate', '', 'estimated discretisation error of the stress at this frequency, relative', &
                   flat(abs(seen(:, along, :, :) - coarse(:, along, :, :))/ &
                        max(abs(seen(:, along, :, :)), tiny(1.0_dp))*load%error_share))
  end subroutine fill_response

  !> Computes the response to a load of 1 N.
  pure subroutine find_amplitudes(tooth, places, points, angular, seen)
    type(tooth_modes_t), intent(in) :: tooth
    integer, intent(in) :: places, points
    real(dp), intent(in) :: angular(:)
    complex(dp), allocatable, intent(out) :: seen(:, :, :, :)
    integer :: i, k, rows(per_point*points)

    rows = [(tooth%row_of(1) + i, i=1, size(rows))]
    allocate (seen(size(angular), per_point, points, places))
    do i = 1, places
      do k = 1, size(angular)
        seen(k, :, :, i) = reshape(response_to(tooth%model, rows, i, angular(k)), [per_point, points])
      end do
    end do
  end subroutine find_amplitudes

  !> Phase from -pi to pi; 0 for amplitude 0.
  elemental real(dp) function phase(amplitude)
    complex(dp), intent(in) :: amplitude

    phase = 0
    if (abs(amplitude) > 0) phase = atan2(aimag(amplitude), real(amplitude, dp))
  end function phase

  pure function flat(values)
    real(dp), intent(in) :: values(:, :, :)
    real(dp) :: flat(size(values))

    flat = reshape(values, [size(values)])
  end function flat

  !> Fills the peak of each mode in the stress at each point. `frequency_error(:)`: of the natural frequencies, relative.
  subroutine fill_resonances(load, tooth, frequency_error, table, error)
    type(steady_load_t), intent(in) :: load
    type(tooth_modes_t), intent(in) :: tooth(2)
    real(dp), intent(in) :: frequency_error(:)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable, dimension(:) :: peak, largest, at_rest, coarse
    integer :: i, k, m, n, points, places, row

    if (allocated(error)) return
    points = 2*size(load%tangent)
    places = size(load%s)
    m = size(tooth(1)%model%frequency)
    allocate (peak(m*points*places), largest(m*points*places), at_rest(m*points*places), coarse(m*points*places))
    n = 0
    do i = 1, places
      do k = 1, points*m
        n = n + 1
        associate (point => 1 + (k - 1)/m, mode => 1 + modulo(k - 1, m))
          row = tooth(1)%row_of(point) + along
          peak(n) = find_peak(tooth(1)%model, row, i, mode)
          largest(n) = size_at(tooth(1), row, i, peak(n))
          at_rest(n) = abs(tooth(1)%model%static(row, i))
          row = tooth(2)%row_of(point) + along
          coarse(n) = size_at(tooth(2), row, i, find_peak(tooth(2)%model, row, i, mode))
        end associate
      end do
    end do
    call table%over('where each mode of the section peaks in the stress at points of the fillets', error, &
                    axis('s', '', of_s, load%s), &
                    axis('tangent_deg', 'deg', of_tangent, load%tangent), axis('side', '', of_side, sides), &
                    axis('mode', '', of_mode, [(i, i=1, m)]))
    if (allocated(error)) return
    associate (w => tooth(1)%model%frequency, c => tooth(1)%model%damping)
      call table%add('natural_frequency_hz', 'Hz', 'natural frequency', table%along(4, w/(2*pi)))
      call table%add('frequency_error', '', 'its estimated discretisation error, relative', &
                     table%along(4, frequency_error))
      call table%add('damping_ratio', '', 'damping ratio of the mode', table%along(4, c/(2*w)))
      call table%add('peak_frequency_hz', 'Hz', 'frequency of the load at which the stress is largest about this mode', &
                     peak/(2*pi))
      call table%add('stress_mpa', 'MPa', 'amplitude of the stress along the surface there', load%amplitude*largest)
      call table%add('amplification', '', 'the same over that under the load at rest', largest/at_rest)
      call table%add('error_estimate', '', 'estimated discretisation error of this stress, relative', &
                     abs(coarse/largest - 1)*load%error_share)
    end associate
  end subroutine fill_resonances

  pure real(dp) function size_at(tooth, row, place, angular)
    type(tooth_modes_t), intent(in) :: tooth
    integer, intent(in) :: row, place
    real(dp), intent(in) :: angular

    size_at = maxval(abs(response_to(tooth%model, [row], place, angular)))
  end function size_at

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t(group, needs=[stage%geometry, stage%section, stage%body, stage%mesh], &
                       tables='harmonic section_resonances campbell', &
                       fields='', summary='root stress of one gear over the frequency of its load, resonances, and the speeds '// &
                       'that meet them')
  end subroutine describe

  subroutine read_keys(self, reader, error)
    class(harmonic_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    type(error_t), allocatable, intent(inout) :: error
    character(sentence_length) :: geared
    integer :: i

    call reader%add_group(group, 'The task harmonic: root stress under a load of steady frequency.')
    geared = text_unless(.not. is_prescribed(reader), needs_gears)
    call reader%get(group, 'frequency_hz', self%frequency, error, unit='Hz', required=.true., tasks=group, not_allowed=geared, &
                    at_least=0.0_dp, at_most=1e9_dp, max_size=10000, &
                    meaning='frequencies of the load, ascending; those that resolve the response and each resonance between '// &
                    'the first and the last are added')
    call self%choice%read_keys(reader, group, geared, error)
    call reader%get(group, 's', self%s, error, tasks=group, not_allowed=geared, at_least=0.0_dp, at_most=20.0_dp, max_size=100, &
                    default_note='the outermost point at which the fewest pairs are in contact', &
                    meaning='places of the load, as path coordinates in base pitches from A, at most the contact ratio')
    call reader%get(group, 'amplitude_n', self%amplitude, error, unit='N', tasks=group, not_allowed=geared, above=0.0_dp, &
                    at_most=1e12_dp, default_note='the static load', meaning='amplitude of the load')
    call reader%get(group, 'harmonics', self%harmonics, error, tasks=group, not_allowed=geared, at_least=1, at_most=100, &
                    meaning='harmonics of the mesh frequency in the table campbell')
    if (.not. allocated(self%frequency) .or. allocated(error)) return
    do i = 2, size(self%frequency)
      if (self%frequency(i) <= self%frequency(i - 1)) call fail(error, code_input, '&harmonic frequency_hz: must ascend; '// &
        str(self%frequency(i))//' comes after '//str(self%frequency(i - 1)))
    end do
  end subroutine read_keys

  subroutine run(self, stages, error)
    class(harmonic_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(error_t), allocatable, intent(inout) :: error
    type(tooth_modes_t) :: teeth(2)
    type(steady_load_t) :: load
    character(7), parameter :: systems(2) = [character(7) :: 'gears', 'section']
    real(dp), allocatable :: angular(:), frequency(:)
    integer, allocatable :: mode(:)
    integer :: i, k, n

    if (allocated(error)) return
    call self%place_load(stages, load, error)
    if (allocated(error)) return
    associate (gear => stages%pair%gear(stages%gear))
      call find_unit_teeth(stages, self%choice, group, &
                           min(stages%pair%radius(stages%gear, load%s), gear%tip_radius), teeth, error)
    end associate
    if (allocated(error)) return
    ! Resonances of undamped modes are unbounded.
    k = minloc(teeth(1)%model%damping, 1)
    if (.not. teeth(1)%model%damping(k) > 0) call fail(error, code_input, '&harmonic damping_ratio: mode '//str(k)// &
      ' is not damped, and so its resonance has no bounds; must be above 0')
    if (allocated(error)) return
    load%error_share = stress_error_share(stages%running%bodies)
    allocate (angular, source=frequencies_around(teeth(1)%model, 2*pi*self%frequency))
    call fill_response(load, teeth, angular, self%tables(self%place('harmonic')), error)
    associate (modal => stages%running%modal)
      call fill_resonances(load, teeth, modal%error_estimate, self%tables(self%place('section_resonances')), error)
      associate (table => self%tables(self%place('campbell')))
        frequency = [stages%motion(1)%natural_frequency/(2*pi), modal%modes%frequency]
        n = size(frequency)
        mode = [1, (i, i=1, n - 1)]
        call table%begin('speeds at which harmonics of the mesh frequency meet natural frequencies', n*self%harmonics, error)
        if (allocated(error)) return
        call table%add_index(axis('system', '', 'gears: both gears on the mean mesh stiffness; section: the teeth of one gear', &
                                  systems(each([(merge(1, 2, i == 1), i=1, n)], self%harmonics))))
        call table%add_index(axis('mode', '', of_mode, each(mode, self%harmonics)))
        call table%add_index(axis('harmonic', '', 'of the mesh frequency', [((k, k=1, self%harmonics), i=1, n)]))
        call table%add('frequency_hz', 'Hz', 'natural frequency', each(frequency, self%harmonics))
        call table%add('rpm', '1/min', 'speed of the pinion at which this harmonic meets it', &
                       each(60*frequency/stages%pair%gear(1)%spec%teeth, self%harmonics)/[((k, k=1, self%harmonics), i=1, n)])
      end associate
    end associate
    self%is_done = .not. allocated(error)
    self%log = 'harmonic: '//str(size(angular))//' frequencies'
  end subroutine run

  !> Sets place and amplitude of the load.
  subroutine place_load(self, stages, load, error)
    class(harmonic_task_t), intent(in) :: self
    type(stages_t), intent(in) :: stages
    type(steady_load_t), intent(out) :: load
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: points(5)

    load%amplitude = self%amplitude
    if (.not. load%amplitude > 0) load%amplitude = stages%load
    load%tangent = self%choice%tangent
    associate (material => stages%material(stages%gear))
      load%modulus = material%young
      if (stages%body_inputs%options%plane_strain) load%modulus = load%modulus/(1 - material%poisson**2)
    end associate
    points = stages%pair%points()
    ! D on the pinion, B on the gear.
    load%s = [points(merge(4, 2, stages%gear == 1))]
    if (.not. allocated(self%s)) return
    load%s = self%s
    if (any(self%s > stages%pair%contact_ratio)) call fail(error, code_input, '&harmonic s = '//str(maxval(self%s))// &
      ': must be at most the contact ratio '//str(stages%pair%contact_ratio, 6))
  end subroutine place_load

  pure subroutine add_report(self, lines)
    class(harmonic_task_t), intent(in) :: self
    type(lines_t), intent(inout) :: lines

    call lines%add('')
    call lines%add('Resonances of the section')
    associate (peaks => self%tables(self%place('section_resonances')))
      call peaks%show(lines, 's tangent_deg side mode peak_frequency_hz stress_mpa amplification')
    end associate
  end subroutine add_report
end module gearsweep_study_tasks_harmonic
