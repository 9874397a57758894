!> The task `rating`: contact and tooth root stress of both gears by ISO 6336 with every factor, the dynamic factor by Method A,
!> from the motion, and by Method B, and the safety factors for stated limits.
module gearsweep_task_rating
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_decimal, only: in_um
  use gearsweep_dynamic_factor, only: dynamic_factor_a, dynamic_factor_b, method_b_t, resonance_ratio
  use gearsweep_equal_flanks, only: add_caution, add_equal_flanks
  use gearsweep_error, only: code_memory, error_t, fail
  use gearsweep_error_estimate, only: point_t
  use gearsweep_kinds, only: dp
  use gearsweep_largest_motion, only: find_point
  use gearsweep_lines, only: left, lines_t, right
  use gearsweep_load_factors, only: contact_stress, load_factors_t, tooth_root_stress
  use gearsweep_memory, only: claim_memory
  use gearsweep_points, only: add_several, known_count, of_estimate, of_factor, of_motions, of_relief, of_speed, of_status, words_of
  use gearsweep_rating_limits, only: add_ground, add_limits, limits_t, read_limits
  use gearsweep_rating_parts, only: accuracy_of_teeth_t, largest_share, need_method_b, nominal_of, nominal_t
  use gearsweep_reader, only: reader_t
  use gearsweep_status, only: has_result, status_stopped
  use gearsweep_stop, only: wants_stop
  use gearsweep_table, only: axis, each, no_number, table_t
  use gearsweep_stages, only: runnable_t, stages_t
  use gearsweep_task, only: members, stage, task_info_t
  use gearsweep_text, only: fixed, str
  use gearsweep_uses, only: first_of, is_prescribed, needs_gears, sentence_length, unless
  implicit none
  private
  public :: rating_task_t

  !> Methods of the dynamic factor, their words in a case and on the screen.
  integer, parameter :: by_larger = 1, by_a = 2, by_b = 3
  character(*), parameter :: methods(3) = [character(6) :: 'larger', 'a', 'b']
  character(*), parameter :: signs(3) = [character(60) :: 'by the larger of Methods A (motion) and B (formula)', &
    'by Method A (motion, without deviations of the teeth)', 'by Method B (formula)']

  type, extends(runnable_t) :: rating_task_t
    type(accuracy_of_teeth_t) :: accuracy
    integer :: method = by_larger                !< of the dynamic factor that counts
    type(load_factors_t) :: factors              !< K_A is that of &load
    type(limits_t) :: limits                     !< what the gears bear
  contains
    procedure, nopass :: describe
    procedure :: read_keys, run, add_report
    procedure, private :: read_method, read_accuracy, signed
  end type rating_task_t

  character(*), parameter :: group = 'rating'
  real(dp), parameter :: micro = 1e6_dp, mega = 1e-6_dp

contains

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t(group, needs=[stage%geometry, stage%elasticity, stage%rims, stage%webs, stage%mesh, stage%reliefs, &
                                     stage%amounts, stage%motion, stage%losses, stage%accuracy], &
                       tables='rating rating_factors dynamic_factors', fields='', &
                       gives='contact and root stress by ISO 6336, with K_v of the motion beside that of Method B')
  end subroutine describe

  subroutine read_keys(self, reader, error)
    class(rating_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    type(error_t), allocatable, intent(inout) :: error
    character(sentence_length) :: geared

    call reader%add_group(group, 'The task rating: contact and tooth root stress by ISO 6336.')
    geared = unless(.not. is_prescribed(reader), needs_gears)
    call reader%get(group, 'rpm', self%own_rpm, error, unit='1/min', required=.true., tasks=group, refused=geared, &
                    at_least=1e-6_dp, at_most=1e9_dp, max_size=1000, distinct=.true., meaning='speeds of the pinion')
    call self%read_method(reader, geared, error)
    call self%read_accuracy(reader, geared, error)
    call reader%get(group, 'face_load_factor', self%factors%face_load, error, tasks=group, refused=geared, at_least=1.0_dp, &
                    at_most=100.0_dp, meaning='K_H_beta: largest load of a unit of face width over the mean one')
    call reader%get(group, 'transverse_load_factor', self%factors%transverse, error, tasks=group, refused=geared, &
                    at_least=1.0_dp, at_most=100.0_dp, &
                    meaning='K_H_alpha and K_F_alpha, for deviations that let the pairs share the load unevenly')
    call read_limits(reader, group, geared, self%limits, error)
  end subroutine read_keys

  subroutine read_method(self, reader, geared, error)
    class(rating_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    character(*), intent(in) :: geared
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: method

    method = methods(by_larger)
    call reader%get(group, 'dynamic_factor_method', method, error, tasks=group, refused=geared, allowed=methods, &
                    meaning='which K_v of ISO 6336-1 stresses and safety factors take: that of Method A (a: from the motion, '// &
                    'without deviations of the teeth), of Method B (b: by formula), or the larger of both')
    if (.not. allocated(error)) self%method = findloc(methods == method, .true., 1)
  end subroutine read_method

  subroutine read_accuracy(self, reader, geared, error)
    class(rating_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    character(*), intent(in) :: geared
    type(error_t), allocatable, intent(inout) :: error
    logical :: stated(2)

    call reader%get(group, 'pitch_deviation_um', self%accuracy%deviation(1), error, unit='um', given=stated(1), tasks=group, &
                    refused=geared, at_least=0.0_dp, at_most=1e4_dp, otherwise='what accuracy_grade allows', &
                    meaning='transverse base pitch deviation f_pb before running in, for K_v by Method B')
    call reader%get(group, 'profile_deviation_um', self%accuracy%deviation(2), error, unit='um', given=stated(2), tasks=group, &
                    refused=geared, at_least=0.0_dp, at_most=1e4_dp, otherwise='what accuracy_grade allows', &
                    meaning='profile form deviation f_f_alpha before running in, for K_v by Method B')
    call reader%get(group, 'accuracy_grade', self%accuracy%grade, error, tasks=group, at_least=0, at_most=12, &
                    refused=first_of(geared, unless(.not. all(stated), 'both deviations are given; remove it')), &
                    meaning='accuracy grade of ISO 1328-1, for K_v by Method B')
    call reader%get(group, 'running_in', self%accuracy%running_in, error, tasks=group, refused=geared, at_least=0.0_dp, &
                    at_most=1.0_dp, meaning='fraction of the deviations that running in takes: 0.075 for case-hardened and '// &
                    'nitrided gears')
    where (.not. stated) self%accuracy%deviation = -1
  end subroutine read_accuracy

  subroutine run(self, stages, error)
    class(rating_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(error_t), allocatable, intent(inout) :: error
    type(point_t), allocatable :: point(:, :)    ! (speed, relief)
    integer, allocatable :: motions(:, :)        ! at each
    type(method_b_t), allocatable :: of(:)                 ! of each relief
    type(nominal_t) :: nominal
    integer :: grade

    if (allocated(error)) return
    self%factors%application = stages%iso%application_factor
    call need_method_b(stages, self%accuracy, of, grade, error)
    call find_points(self%own_rpm, stages, point, motions, error)
    if (allocated(error) .or. .not. allocated(point)) return
    nominal = nominal_of(stages, self%factors, grade)
    call fill_dynamic(stages, self%own_rpm, of, point, motions, self%tables(self%place('dynamic_factors')), error)
    call fill_factors(stages, self%factors, nominal, of(1), self%limits, self%tables(self%place('rating_factors')), error)
    call fill_rating(self, nominal, stages%amount, self%tables(self%place('rating')), error)
    self%is_done = .true.
    associate (status => point%steady%status)
      self%is_stopped = any(status == status_stopped)
      self%failed = count(.not. has_result(status))
    end associate
    self%log = 'rating: '//str(size(point))//' operating points rated'
  end subroutine run

  !> The operating points at all speeds; not allocated where the run was interrupted.
  subroutine find_points(rpm, stages, point, motions, error)
    real(dp), intent(in) :: rpm(:)
    type(stages_t), intent(in) :: stages
    type(point_t), allocatable, intent(out) :: point(:, :)
    integer, allocatable, intent(out) :: motions(:, :)     ! how many there are; (speed, relief)
    type(error_t), allocatable, intent(inout) :: error
    type(point_t), allocatable :: found(:, :)
    logical :: lacks
    integer :: i, k

    if (allocated(error)) return
    call claim_memory(1000.0_dp*size(stages%motion)*size(rpm), '&rating rpm: '//str(size(stages%motion)*size(rpm))// &
                      ' motions', error)
    if (allocated(error)) return
    allocate (found(size(rpm), size(stages%motion)), motions(size(rpm), size(stages%motion)))
    do i = 1, size(stages%motion)
      do k = 1, size(rpm)
        if (wants_stop(stages%accuracy%steady%stop)) return
        call find_point(stages%motion(i), rpm(k), stages%accuracy, found(k, i), motions(k, i), lacks)
        if (lacks) call fail(error, code_memory, '&rating rpm = '//str(rpm(k))//': the memory does not hold the motion')
        if (allocated(error)) return
        call stages%running%tell(1, stages%accuracy%steady%stop)
      end do
    end do
    call move_alloc(found, point)
  end subroutine find_points

  !> K_v by both methods.
  pure subroutine fill_dynamic(stages, rpm, of, point, motions, table, error)
    type(stages_t), intent(in) :: stages
    real(dp), intent(in) :: rpm(:)
    type(method_b_t), intent(in) :: of(:)
    type(point_t), intent(in) :: point(:, :)     ! (speed, relief)
    integer, intent(in) :: motions(:, :)         ! how many there are
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: factor(:), estimate(:), share(:)
    integer, allocatable :: status(:)
    integer :: i, m, n

    m = size(stages%amount)
    n = size(rpm)
    call table%over('dynamic factor K_v by Method A, from the motion, and by Method B', error, &
                    axis('relief_um', 'um', of_relief, in_um(stages%amount)), axis('rpm', '1/min', of_speed, rpm))
    if (allocated(error)) return
    share = each([(largest_share(stages%motion(i)), i=1, m)], n)
    factor = [point%dynamic_factor]
    estimate = [point%estimate]
    status = [point%steady%status]
    where (.not. has_result(status))
      factor = no_number()
      estimate = no_number()
    end where
    call table%add('dynamic_factor', '', of_factor, factor)
    call table%add('error_estimate', '', of_estimate, estimate)
    call table%add_words('status', of_status, words_of(status))
    call table%add('motions', '', of_motions, [known_count(motions)])
    call table%add('static_share', '', 'largest load of a pair at rest over the static load', share)
    call table%add('dynamic_factor_a', '', 'K_v by ISO 6336-1, Method A: DF over static_share, at least 1; NaN where there is '// &
                   'no answer', dynamic_factor_a(factor, share))
    call table%add('dynamic_factor_b', '', 'K_v by ISO 6336-1, Method B', [(dynamic_factor_b(of(i), rpm), i=1, m)])
    call table%add('resonance_ratio', '', 'N: speed over the resonance running speed of Method B', &
                   [(resonance_ratio(of(i), rpm), i=1, m)])
  end subroutine fill_dynamic

  !> What does not depend on the speed.
  subroutine fill_factors(stages, factors, nominal, of, limits, table, error)
    type(stages_t), intent(in) :: stages
    type(load_factors_t), intent(in) :: factors
    type(nominal_t), intent(in) :: nominal
    type(method_b_t), intent(in) :: of
    type(limits_t), intent(in) :: limits
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error

    call table%over('factors of ISO 6336:2006 that do not depend on the speed', error, &
                    axis('member', '', 'pinion or gear', members))
    if (allocated(error)) return
    call both('tangential_load_n', 'N', 'nominal load F_t on the reference circle', nominal%load)
    call both('application_factor', '', 'K_A, of the case', factors%application)
    call both('face_load_factor', '', 'K_H_beta, of the case', factors%face_load)
    call both('root_face_load_factor', '', 'K_F_beta, ISO 6336-1, clause 7', nominal%root_face_load)
    call both('transverse_load_factor', '', 'K_H_alpha and K_F_alpha, of the case', factors%transverse)
    call both('zone_factor', '', 'Z_H, ISO 6336-2, clause 6', nominal%flank%zone)
    call table%add('single_pair_factor', '', 'Z_B of the pinion, Z_D of the gear, ISO 6336-2, clause 6', nominal%flank%single_pair)
    call both('elasticity_factor_sqrt_mpa', 'sqrt(MPa)', 'Z_E, ISO 6336-2, clause 7', 1e-3_dp*nominal%flank%elasticity)
    call both('contact_ratio_factor', '', 'Z_eps, ISO 6336-2, clause 8', nominal%flank%contact_ratio)
    call both('nominal_contact_mpa', 'MPa', 'nominal contact stress sigma_H0, ISO 6336-2, clause 5', mega*nominal%contact)
    call table%add('form_factor', '', 'Y_F, ISO 6336-3, clause 6', [nominal%form%form_factor])
    call table%add('stress_correction', '', 'Y_S, ISO 6336-3, clause 7', [nominal%form%correction])
    call table%add('rim_factor', '', 'Y_B, ISO 6336-3, clause 9', nominal%rim)
    call both('deep_tooth_factor', '', 'Y_DT, ISO 6336-3, clause 10', nominal%deep)
    call table%add('nominal_root_mpa', 'MPa', 'nominal tooth root stress sigma_F0, ISO 6336-3, clause 5', mega*nominal%root)
    call both('single_stiffness_n_mm_um', 'N/(mm um)', 'c'', ISO 6336-1, clause 9', 1e-9_dp*of%single_stiffness)
    call both('mesh_stiffness_n_mm_um', 'N/(mm um)', 'c_gamma_alpha, ISO 6336-1, clause 9', 1e-9_dp*of%mesh_stiffness)
    call both('reduced_mass_kg_mm', 'kg/mm', 'm_red of a unit of face width, from the effective masses of the case', &
              1e-3_dp*of%mass)
    call both('resonance_rpm', '1/min', 'resonance running speed n_E1 of the pinion, ISO 6336-1, 6.5.3', &
              1/resonance_ratio(of, 1.0_dp))
    call table%add('accuracy_grade', '', 'of ISO 1328-1; of stated deviations the finest that allows them, 13 for none', &
                   [nominal%grade, nominal%grade])
    call both('pitch_deviation_um', 'um', 'f_pb after running in', micro*of%pitch_deviation)
    call both('profile_deviation_um', 'um', 'f_f_alpha after running in', micro*of%profile_deviation)
    call add_limits(limits, table)
    call add_equal_flanks(stages%pair, 2, table)

  contains

    subroutine both(name, unit, meaning, value)
      character(*), intent(in) :: name, unit, meaning
      real(dp), intent(in) :: value

      call table%add(name, unit, meaning, [value, value])
    end subroutine both
  end subroutine fill_factors

  !> Stresses and safety factors, with the dynamic factor that counts.
  subroutine fill_rating(self, nominal, amount, table, error)
    class(rating_task_t), intent(in) :: self
    type(nominal_t), intent(in) :: nominal
    real(dp), intent(in) :: amount(:)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: dynamic(:), contact(:), root(:)
    character(1), allocatable :: method(:)
    integer, allocatable :: member(:)
    integer :: i, m, n

    m = size(amount)
    n = size(self%own_rpm)
    call table%over('contact stress and tooth root stress by ISO 6336, and their safety factors', error, &
                    axis('relief_um', 'um', of_relief, in_um(amount)), axis('rpm', '1/min', of_speed, self%own_rpm), &
                    axis('member', '', 'pinion or gear', members))
    if (allocated(error)) return
    call self%signed(method, dynamic)
    member = [(1, 2, i=1, m*n)]
    contact = contact_stress(nominal%contact, nominal%flank%single_pair(member), self%factors, dynamic)
    root = tooth_root_stress(nominal%root(member), self%factors, nominal%root_face_load, dynamic)
    call table%add_words('method', 'whose K_v it is, as dynamic_factor_method has it: a or b', method)
    call table%add('internal_dynamic_factor', '', 'K_v by that method; NaN where there is no answer', dynamic)
    call table%add('contact_stress_mpa', 'MPa', 'contact stress sigma_H', mega*contact)
    call table%add('contact_safety', '', 'S_H; NaN without contact_limit_mpa or a material', self%limits%contact(member)/contact)
    call table%add('root_stress_mpa', 'MPa', 'tooth root stress sigma_F', mega*root)
    call table%add('root_safety', '', 'S_F; NaN without root_limit_mpa or a material', self%limits%root(member)/root)
  end subroutine fill_rating

  !> The K_v that counts in each row of the table `rating`, and of which method it is. Of two of which one is not known none is
  !> the larger.
  pure subroutine signed(self, method, factor)
    class(rating_task_t), intent(in) :: self
    character(1), allocatable, intent(out) :: method(:)
    real(dp), allocatable, intent(out) :: factor(:)
    real(dp), allocatable :: a(:), b(:)
    logical, allocatable :: takes_b(:)

    associate (table => self%tables(self%place('dynamic_factors')))
      a = each(table%numbers('dynamic_factor_a'), 2)
      b = each(table%numbers('dynamic_factor_b'), 2)
    end associate
    takes_b = spread(self%method == by_b, 1, size(a))
    if (self%method == by_larger) takes_b = b > a
    factor = merge(b, a, takes_b)
    method = merge('b', 'a', takes_b)
  end subroutine signed

  pure subroutine add_report(self, lines)
    class(rating_task_t), intent(in) :: self
    type(lines_t), intent(inout) :: lines
    integer :: i

    call lines%add('')
    associate (rating => self%tables(self%place('rating')), dynamic => self%tables(self%place('dynamic_factors')), &
               factors => self%tables(self%place('rating_factors')))
      call lines%add('Rating by ISO 6336, with K_v '//trim(signs(self%method)))
      call add_ground(factors, lines)
      call lines%add('   relief um         rpm   member   K_v A   K_v B   sigma_H MPa     S_H   sigma_F MPa     S_F')
      do i = 1, rating%rows
        call lines%put(right(str(rating%number('relief_um', i)), 12)//right(str(rating%number('rpm', i)), 12)//'   '// &
                       left(trim(rating%word('member', i)), 6))
        call lines%put(shown(dynamic%number('dynamic_factor_a', (i + 1)/2))// &
                       shown(dynamic%number('dynamic_factor_b', (i + 1)/2)))
        call lines%put(right(str(rating%number('contact_stress_mpa', i), 5), 14)// &
                       shown(rating%number('contact_safety', i)))
        call lines%put(right(str(rating%number('root_stress_mpa', i), 5), 14)//shown(rating%number('root_safety', i)))
        if (dynamic%word('status', (i + 1)/2) /= 'ok') call lines%put('   motion '//trim(dynamic%word('status', (i + 1)/2)))
        call lines%add('')
      end do
      call add_several(dynamic, lines)
    end associate
    call add_caution(self%tables(self%place('rating_factors')), lines)
  end subroutine add_report

  !> A factor for the screen.
  pure function shown(value) result(text)
    real(dp), intent(in) :: value
    character(8) :: text

    text = right('-', 8)
    if (.not. ieee_is_nan(value)) text = right(fixed(value, 3), 8)
  end function shown
end module gearsweep_task_rating
