!> The task `harmonic`: stress, strain and displacement at the fillets of one tooth under a load of steady frequency, resonances
!> found and resolved, and the speeds at which harmonics of the mesh frequency meet natural frequencies.
module gearsweep_task_harmonic
  use gearsweep_error, only: code_input, error_t, fail
  use gearsweep_frequency_response, only: frequencies_around
  use gearsweep_harmonic_tables, only: fill_resonances, fill_response, fill_speeds, steady_load_t
  use gearsweep_kinds, only: dp, pi
  use gearsweep_lines, only: left, lines_t, right
  use gearsweep_long_tables, only: add_rest, most_rows
  use gearsweep_reader, only: reader_t
  use gearsweep_section_body, only: stress_error_share
  use gearsweep_stages, only: runnable_t, stages_t
  use gearsweep_task, only: stage, task_info_t
  use gearsweep_text, only: str
  use gearsweep_tooth_modes, only: tooth_modes_t
  use gearsweep_unit_teeth, only: find_unit_teeth, tooth_choice_t
  use gearsweep_uses, only: is_prescribed, needs_gears, sentence_length, unless
  implicit none
  private
  public :: harmonic_task_t

  type, extends(runnable_t) :: harmonic_task_t
    type(tooth_choice_t) :: choice               !< modes, damping, chosen points
    real(dp), allocatable :: frequency(:)        !< Hz, ascending
    real(dp), allocatable :: s(:)                !< places of the load; not allocated: the outer point of single contact
    real(dp) :: amplitude = 0                    !< of the load, N; 0: the static load
    integer :: harmonics = 5                     !< of the mesh frequency, in the table of speeds
  contains
    procedure, nopass :: describe
    procedure :: read_keys, run, add_report
    procedure, private :: place_load
  end type harmonic_task_t

  character(*), parameter :: group = 'harmonic'

contains

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t(group, needs=[stage%geometry, stage%section, stage%body, stage%mesh], &
                       tables='harmonic section_resonances campbell', &
                       fields='', gives='root stress of one gear over the frequency of its load, resonances, and the speeds '// &
                       'that meet them')
  end subroutine describe

  subroutine read_keys(self, reader, error)
    class(harmonic_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    type(error_t), allocatable, intent(inout) :: error
    character(sentence_length) :: geared
    integer :: i

    call reader%add_group(group, 'The task harmonic: root stress under a load of steady frequency.')
    geared = unless(.not. is_prescribed(reader), needs_gears)
    call reader%get(group, 'frequency_hz', self%frequency, error, unit='Hz', required=.true., tasks=group, refused=geared, &
                    at_least=0.0_dp, at_most=1e9_dp, max_size=10000, &
                    meaning='frequencies of the load, ascending; those that resolve the response and each resonance between '// &
                    'the first and the last are added')
    call self%choice%read_keys(reader, group, geared, error)
    call reader%get(group, 's', self%s, error, tasks=group, refused=geared, at_least=0.0_dp, at_most=20.0_dp, max_size=100, &
                    otherwise='the outermost point at which the fewest pairs are in contact', &
                    meaning='places of the load, as path coordinates in base pitches from A, at most the contact ratio')
    call reader%get(group, 'amplitude_n', self%amplitude, error, unit='N', tasks=group, refused=geared, above=0.0_dp, &
                    at_most=1e12_dp, otherwise='the static load', meaning='amplitude of the load')
    call reader%get(group, 'harmonics', self%harmonics, error, tasks=group, refused=geared, at_least=1, at_most=100, &
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
    real(dp), allocatable :: angular(:)

    if (allocated(error)) return
    call self%place_load(stages, load, error)
    if (allocated(error)) return
    associate (gear => stages%pair%gear(stages%member))
      call find_unit_teeth(stages, self%choice, group, &
                           min(stages%pair%radius(stages%member, load%s), gear%tip_radius), teeth, error)
    end associate
    if (allocated(error)) return
    call check_damping(teeth(1), error)
    if (allocated(error)) return
    load%error_share = stress_error_share(stages%running%bodies)
    allocate (angular, source=frequencies_around(teeth(1)%model, 2*pi*self%frequency))
    call fill_response(load, teeth, angular, self%tables(self%place('harmonic')), error)
    associate (modal => stages%running%modal)
      call fill_resonances(load, teeth, modal%error_estimate, self%tables(self%place('section_resonances')), error)
      call fill_speeds([stages%motion(1)%natural_frequency/(2*pi), modal%modes%frequency], stages%pair%gear(1)%spec%teeth, &
                       self%harmonics, self%tables(self%place('campbell')), error)
    end associate
    self%is_done = .not. allocated(error)
    self%log = 'harmonic: '//str(size(angular))//' frequencies'
  end subroutine run

  !> Where the load stands and how large it is.
  subroutine place_load(self, stages, load, error)
    class(harmonic_task_t), intent(in) :: self
    type(stages_t), intent(in) :: stages
    type(steady_load_t), intent(out) :: load
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: points(5)

    load%amplitude = self%amplitude
    if (.not. load%amplitude > 0) load%amplitude = stages%load
    load%tangent = self%choice%tangent
    associate (material => stages%material(stages%member))
      load%modulus = material%young
      if (stages%body_inputs%options%plane_strain) load%modulus = load%modulus/(1 - material%poisson**2)
    end associate
    points = stages%pair%points()
    ! D on the pinion, B on the gear.
    load%s = [points(merge(4, 2, stages%member == 1))]
    if (.not. allocated(self%s)) return
    load%s = self%s
    if (any(self%s > stages%pair%contact_ratio)) call fail(error, code_input, '&harmonic s = '//str(maxval(self%s))// &
      ': must be at most the contact ratio '//str(stages%pair%contact_ratio, 6))
  end subroutine place_load

  !> Without damping a resonance has no bounds.
  pure subroutine check_damping(tooth, error)
    type(tooth_modes_t), intent(in) :: tooth
    type(error_t), allocatable, intent(inout) :: error
    integer :: k

    k = minloc(tooth%model%damping, 1)
    if (.not. tooth%model%damping(k) > 0) call fail(error, code_input, '&harmonic damping_ratio: mode '//str(k)// &
      ' is not damped, and so its resonance has no bounds; must be above 0')
  end subroutine check_damping

  pure subroutine add_report(self, lines)
    class(harmonic_task_t), intent(in) :: self
    type(lines_t), intent(inout) :: lines
    integer :: i

    associate (peaks => self%tables(self%place('section_resonances')))
      call lines%add('')
      call lines%add('Resonances of the section')
      call lines%add('           s   tangent deg   side    mode     peak Hz   stress MPa   amplification')
      do i = 1, min(peaks%rows, most_rows)
        call lines%add(right(str(peaks%number('s', i), 5), 12)//right(str(peaks%number('tangent_deg', i)), 14)//'   '// &
                       left(trim(peaks%word('side', i)), 5)//right(str(nint(peaks%number('mode', i))), 7)// &
                       right(str(peaks%number('peak_frequency_hz', i), 6), 12)//right(str(peaks%number('stress_mpa', i), 4), 13)// &
                       right(str(peaks%number('amplification', i), 3), 16))
      end do
      call add_rest(peaks%rows, peaks%name, lines)
    end associate
  end subroutine add_report
end module gearsweep_task_harmonic
