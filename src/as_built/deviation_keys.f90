!> Keys of &deviations: deviations of the flanks of both gears from the nominal ones.
module gearsweep_as_built_deviation_keys
  use gearsweep_base, only: code_input, dp, error_t, fail, str
  use gearsweep_gear, only: find_tolerances, gear_spec_t, tolerances_t
  use gearsweep_mesh, only: common_divisor, flank_deviations_t, length_of_turn
  use gearsweep_study, only: first_nonblank, gear_names, is_prescribed, needs_gears, reader_t, sentence_length, text_unless
  implicit none
  private
  public :: deviations_choice_t, read_deviations, check_deviations

  !> A file of measured flanks.
  type :: flank_file_t
    character(:), allocatable :: name            !< not allocated: no file
    character(:), allocatable :: flank           !< flanks of the file to use, `left` or `right`
    real(dp) :: residual = 0                     !< root mean square of the residuals of its points after the polynomial fit, m
  end type flank_file_t

  type :: deviations_choice_t
    integer :: class(2) = 0                      !< flank tolerance classes of pinion and gear; 0: none
    integer :: seed = 1, draws = 1               !< seed and number of the flanks drawn from the class
    logical :: accepted = .false.                !< true: flanks that an inspection would reject are drawn again
    type(flank_deviations_t) :: flanks(2)
    type(flank_file_t) :: files(2)               !< files of pinion and gear
    logical :: all_assemblies = .false.          !< true: all possible assemblies of the teeth
    logical :: is_told = .false.                 !< true if the case states deviations, even 0
  contains
    procedure :: assemblies, turn
    procedure, private :: any_of
  end type deviations_choice_t

  character(*), parameter :: group = 'deviations', task = 'as_built'
  real(dp), parameter :: largest = 1e4_dp        !< largest deviation, um
  real(dp), parameter :: longest_turn = 1e6_dp   !< longest revolution, mesh periods

contains

  subroutine read_deviations(reader, choice, error)
    type(reader_t), intent(inout) :: reader
    type(deviations_choice_t), intent(inout) :: choice
    type(error_t), allocatable, intent(inout) :: error
    logical :: with_class
    character(:), allocatable :: assembly
    integer :: i

    call reader%add_group(group, 'How the flanks of the gears as made deviate from the nominal ones, for the task as_built. '// &
                          'Signs are those of ISO 1328-1.')
    do i = 1, 2
      ! If the group is present, `check_deviations` requires some deviation.
      call reader%get(group, trim(gear_names(i))//'_class', choice%class(i), error, tasks=task, at_least=1, at_most=11, &
                      required=i == 1 .and. .not. (reader%has_group(group) .or. is_prescribed(reader)), &
                      not_allowed=text_unless(.not. is_prescribed(reader), needs_gears), default_note='none', &
                      meaning='flank tolerance class of ISO 1328-1, from whose tolerances flanks are drawn at random: '// &
                      'positions of the flanks, slopes of the profiles, run-out')
    end do
    with_class = any(choice%class > 0)
    call reader%get(group, 'seed', choice%seed, error, tasks=task, at_least=1, at_most=10**9, &
                    unused_without=text_unless(with_class, 'a class'), meaning='number that decides which flanks are drawn')
    call reader%get(group, 'draws', choice%draws, error, tasks=task, at_least=1, at_most=10000, &
                    unused_without=text_unless(with_class, 'a class'), &
                    meaning='how many pairs of gears are drawn')
    call reader%get(group, 'accepted', choice%accepted, error, tasks=task, unused_without=text_unless(with_class, 'a class'), &
                    meaning='whether a drawn gear that is outside its class in f_p, F_p, f_Halpha or F_r is drawn again, '// &
                    'as an inspection would reject it')
    do i = 1, 2
      call read_flanks(reader, trim(gear_names(i))//'_', choice%class(i) > 0, choice%flanks(i), choice%files(i), error)
    end do
    choice%is_told = choice%any_of(1) .or. choice%any_of(2) .or. reader%has(group, 'pinion_runout_um') .or. &
                     reader%has(group, 'gear_runout_um')
    assembly = 'stated'
    call reader%get(group, 'assembly', assembly, error, tasks=task, allowed=[character(6) :: 'stated', 'all'], &
                    unused_without=text_unless(choice%any_of(1) .and. choice%any_of(2), 'deviations of both gears'), &
                    meaning='which teeth meet: the stated teeth at the time 0, or each assembly in turn; numbers of teeth '// &
                    'with the common divisor g have g of them where both gears deviate')
    choice%all_assemblies = assembly == 'all' .and. choice%any_of(1) .and. choice%any_of(2)
  end subroutine read_deviations

  !> Reads the keys of one gear. Lists of single teeth require the counting of the teeth.
  subroutine read_flanks(reader, gear, with_class, flanks, file, error)
    type(reader_t), intent(inout) :: reader
    character(*), intent(in) :: gear           ! beginning of its keys
    logical, intent(in) :: with_class
    type(flank_deviations_t), intent(inout) :: flanks
    type(flank_file_t), intent(inout) :: file
    type(error_t), allocatable, intent(inout) :: error
    character(sentence_length) :: drawn, measured
    integer :: i
    logical :: given, has_backlash, has_waves

    has_backlash = reader%has('pair', 'backlash_um') .or. any([(reader%has(trim(gear_names(i)), 'thickness_allowance_um') .or. &
                                                                reader%has(trim(gear_names(i)), 'generating_shift'), i=1, 2)])
    drawn = text_unless(.not. with_class, 'does not go with '//gear//'class; remove one')
    call get_list('single_pitch_um', flanks%single_pitch, 'of each tooth the pitch to it from the tooth before, longer than '// &
                  'the mean pitch (+) or shorter (-), on the measuring circle; they add up to 0', drawn)
    call get_list('cumulative_pitch_um', flanks%cumulative_pitch, 'of each tooth how far its flank is out of place, ahead (+) '// &
                  'or behind (-) in the direction of counting, on the measuring circle, instead of single pitches', &
                  first_nonblank(drawn, text_unless(.not. allocated(flanks%single_pitch), 'does not go with '//gear// &
                                         'single_pitch_um; remove one')))
    call get_list('coast_pitch_um', flanks%coast_pitch, 'cumulative pitch of the coast flanks, on the measuring circle: of '// &
                  'each tooth how far its coast flank is out of place; without it each tooth moves both its flanks. Its mean '// &
                  'does not count: the backlash has the thickness of the teeth', &
                  first_nonblank(drawn, text_unless(has_backlash, 'goes with a backlash only')))
    call reader%get(group, gear//'flanks_file', file%name, error, tasks=task, default_note='none', &
                    not_allowed=first_nonblank(text_unless(.not. is_prescribed(reader), needs_gears), drawn), &
                    meaning='file of measured profiles of the flanks, instead of slope and form: below the line '// &
                    'tooth,flank,roll_mm,deviation_um a row for each point, with the number of the tooth, left or right, the '// &
                    'radius of curvature of the involute there, and the deviation from it, more material (+) or less (-). A '// &
                    'relative name lies beside the case')
    measured = first_nonblank(drawn, text_unless(.not. allocated(file%name), 'does not go with '//gear//'flanks_file; remove one'))
    call get_list('profile_slope_um', flanks%slope, 'profile slope deviation over the path of contact, more material to the '// &
                  'tip (+) or less (-): of all teeth, or of each', measured)
    call get_list('profile_form_um', flanks%form, 'profile form deviation as a parabola over the path of contact, more '// &
                  'material in the middle (+) or less (-): of all teeth, or of each', measured)
    call reader%get(group, gear//'runout_um', flanks%runout, error, unit='um', is_stated=given, tasks=task, not_allowed=drawn, &
                    at_least=0.0_dp, at_most=largest, default_note='none', &
                    meaning='run-out F_r, twice the eccentricity: a wave of order 1 of half as much')
    call reader%get(group, gear//'runout_phase_deg', flanks%runout_phase, error, unit='deg', tasks=task, &
                    required=given, at_least=-360.0_dp, at_most=360.0_dp, &
                    unused_without=text_unless(given, gear//'runout_um'), default_note='none; required with '//gear//'runout_um', &
                    meaning='phase of that wave where the stated tooth enters at A: with 90 the flanks are farthest apart')
    call get_orders(has_waves)
    call reader%get(group, gear//'wave_um', flanks%wave, error, unit='um', tasks=task, required=has_waves, &
                    unused_without=text_unless(has_waves, gear//'wave_order'), at_least=0.0_dp, at_most=largest, max_size=100, &
                    default_note='none; required with '//gear//'wave_order', meaning='amplitude of each wave')
    call reader%get(group, gear//'wave_phase_deg', flanks%wave_phase, error, unit='deg', tasks=task, &
                    required=has_waves, unused_without=text_unless(has_waves, gear//'wave_order'), at_least=-360.0_dp, &
                    at_most=360.0_dp, max_size=100, default_note='none; required with '//gear//'wave_order', &
                    meaning='phase of each where the stated tooth enters at A')
    call read_counting(reader, gear, flanks, file, error)

  contains

    subroutine get_list(key, values, meaning, refused)
      character(*), intent(in) :: key, meaning, refused
      real(dp), allocatable, intent(inout) :: values(:)

      call reader%get(group, gear//key, values, error, unit='um', tasks=task, not_allowed=refused, at_least=-largest, &
                      at_most=largest, max_size=100000, default_note='none', meaning=meaning)
    end subroutine get_list

    !> Reads the orders of the waves, whole numbers.
    subroutine get_orders(given)
      logical, intent(out) :: given
      real(dp), allocatable :: order(:)

      call reader%get(group, gear//'wave_order', order, error, tasks=task, at_least=1.0_dp, at_most=1e5_dp, max_size=100, &
                      default_note='none', &
                      meaning='waviness of the flanks: whole numbers of waves over a turn, which go on from '// 'tooth to tooth')
      given = allocated(order)
      if (.not. given) return
      if (any(abs(order - anint(order)) > 0)) call fail(error, code_input, '&deviations '//gear//'wave_order = '// &
        str(order(maxloc(abs(order - anint(order)), 1)))//': must be a whole number')
      flanks%wave_order = nint(order)
    end subroutine get_orders
  end subroutine read_flanks

  !> Reads how the teeth of the lists and of the file are counted, and which tooth meshes at the time 0.
  subroutine read_counting(reader, gear, flanks, file, error)
    type(reader_t), intent(inout) :: reader
    character(*), intent(in) :: gear
    type(flank_deviations_t), intent(inout) :: flanks
    type(flank_file_t), intent(inout) :: file
    type(error_t), allocatable, intent(inout) :: error
    character(*), parameter :: without = 'none; required with a list or a file of single teeth'
    character(:), allocatable :: counting, flank
    character(sentence_length) :: lacks
    logical :: listed, turns_clockwise

    listed = is_list(flanks%single_pitch) .or. is_list(flanks%cumulative_pitch) .or. is_list(flanks%slope) .or. &
             is_list(flanks%form) .or. is_list(flanks%coast_pitch) .or. allocated(file%name)
    lacks = text_unless(listed, 'a list or a file of single teeth')
    call reader%get(group, gear//'counting', counting, error, tasks=task, required=listed, unused_without=lacks, &
                    allowed=[character(16) :: 'clockwise', 'counterclockwise'], default_note=without, &
                    meaning='direction in which the teeth are counted, seen from the datum face')
    call reader%get(group, gear//'flank', flank, error, tasks=task, required=listed, unused_without=lacks, &
                    allowed=[character(5) :: 'left', 'right'], default_note=without, &
                    meaning='flanks that carry the load, of which the lists are and that count in the file: seen from '// &
                    'the datum face with the tip up')
    call reader%get(group, gear//'tooth', flanks%tooth, error, tasks=task, required=listed, unused_without=lacks, at_least=1, &
                    at_most=100000, default_note=without, &
                    meaning='number of the tooth that enters contact at A at the time 0')
    if (.not. listed) flanks%tooth = 1
    if (.not. (listed .and. allocated(counting) .and. allocated(flank))) return
    file%flank = flank
    ! The driving tooth is loaded on the side to which it moves, the driven one on the other; teeth engage one after the other.
    turns_clockwise = flank == 'right' .eqv. gear == 'pinion_'
    flanks%ascends = counting == 'clockwise' .neqv. turns_clockwise
  end subroutine read_counting

  pure logical function is_list(values)
    real(dp), allocatable, intent(in) :: values(:)

    is_list = .false.
    if (allocated(values)) is_list = size(values) > 1
  end function is_list

  !> True if the case states a deviation of this gear.
  pure logical function any_of(self, i)
    class(deviations_choice_t), intent(in) :: self
    integer, intent(in) :: i

    associate (flanks => self%flanks(i))
      any_of = self%class(i) > 0 .or. allocated(flanks%single_pitch) .or. allocated(flanks%cumulative_pitch) .or. &
               allocated(flanks%slope) .or. allocated(flanks%form) .or. flanks%runout > 0 .or. allocated(flanks%wave_order) .or. &
               allocated(self%files(i)%name) .or. allocated(flanks%coast_pitch)
    end associate
  end function any_of

  !> Number of assemblies of gears with these numbers of teeth.
  pure integer function assemblies(self, teeth)
    class(deviations_choice_t), intent(in) :: self
    integer, intent(in) :: teeth(2)

    assemblies = 1
    if (self%all_assemblies) assemblies = common_divisor(teeth(1), teeth(2))
  end function assemblies

  !> Mesh periods after which the deviations of gears with these numbers of teeth repeat.
  pure real(dp) function turn(self, teeth)
    class(deviations_choice_t), intent(in) :: self
    integer, intent(in) :: teeth(2)

    turn = length_of_turn(teeth, [self%any_of(1), self%any_of(2)])
  end function turn

  !> Checks the keys against the gears.
  subroutine check_deviations(choice, spec, error)
    type(deviations_choice_t), intent(in) :: choice
    type(gear_spec_t), intent(in) :: spec(2)     !< pinion and gear
    type(error_t), allocatable, intent(inout) :: error
    type(error_t), allocatable :: outside
    type(tolerances_t) :: tolerances
    integer :: i, teeth_of(2)

    if (.not. choice%is_told) call fail(error, code_input, '&deviations: tells of no deviation of either gear; the task '// &
      'as_built needs one, such as pinion_class = 6')
    do i = 1, 2
      associate (flanks => choice%flanks(i), teeth => spec(i)%teeth, gear => '&deviations '//trim(gear_names(i))//'_')
        if (teeth == 0) then
          call fail(error, code_input, '&'//trim(gear_names(i))//' teeth: missing; the task as_built needs it; must be at least 5')
          return
        end if
        if (choice%class(i) > 0) then
          call find_tolerances(choice%class(i), teeth, 1e3_dp*spec(i)%module, 1e3_dp*spec(i)%face_width, tolerances, outside)
          if (allocated(outside)) call fail(error, code_input, gear//'class = '//str(choice%class(i))//': '//outside%message)
        end if
        call check_length(gear//'single_pitch_um', flanks%single_pitch, teeth, 'teeth', .false.)
        call check_length(gear//'cumulative_pitch_um', flanks%cumulative_pitch, teeth, 'teeth', .false.)
        call check_length(gear//'coast_pitch_um', flanks%coast_pitch, teeth, 'teeth', .false.)
        call check_length(gear//'profile_slope_um', flanks%slope, teeth, 'teeth', .true.)
        call check_length(gear//'profile_form_um', flanks%form, teeth, 'teeth', .true.)
        if (flanks%tooth > teeth) call fail(error, code_input, gear//'tooth = '//str(flanks%tooth)// &
          ': is above the number of teeth, '//str(teeth))
        if (allocated(flanks%single_pitch)) call check_sum(gear, flanks%single_pitch)
        if (.not. allocated(flanks%wave_order)) cycle
        call check_length(gear//'wave_um', flanks%wave, size(flanks%wave_order), 'waves', .false.)
        call check_length(gear//'wave_phase_deg', flanks%wave_phase, size(flanks%wave_order), 'waves', .false.)
      end associate
    end do
    teeth_of = spec%teeth
    associate (periods => choice%turn(teeth_of))
      if (periods > longest_turn) call fail(error, code_input, '&gear teeth = '//str(spec(2)%teeth)//': the deviations of both '// &
        'gears repeat after '//str(periods, 10)//' mesh periods; must be at most '//str(longest_turn, 10))
    end associate

  contains

    subroutine check_length(key, values, length, what, or_one)
      character(*), intent(in) :: key
      real(dp), allocatable, intent(in) :: values(:)
      integer, intent(in) :: length
      character(*), intent(in) :: what           ! elements, each of which requires a number
      logical, intent(in) :: or_one

      if (.not. allocated(values)) return
      if (size(values) == length .or. (or_one .and. size(values) == 1)) return
      call fail(error, code_input, key//': numbers given: '//str(size(values))//'; must have one for each of '// &
                str(length)//' '//what//trim(merge(', or one for all', '                ', or_one)))
    end subroutine check_length

    !> Checks that the pitches add up to 0; they are stated to a tenth of a um, and so deviate from it by rounding.
    subroutine check_sum(gear, pitch)
      character(*), intent(in) :: gear
      real(dp), intent(in) :: pitch(:)
      real(dp), parameter :: um = 1e-6_dp, rounding = 0.05_dp*um

      if (abs(sum(pitch)) > size(pitch)*rounding) call fail(error, code_input, gear//'single_pitch_um: add up to '// &
        str(sum(pitch)/um, 4)//' um; must add up to 0, as the pitches fill the circle')
    end subroutine check_sum
  end subroutine check_deviations
end module gearsweep_as_built_deviation_keys
