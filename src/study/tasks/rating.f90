!> The task `rating`: contact and tooth root stress of both gears by ISO 6336 with every factor, and safety factors.
!>
!> The dynamic factor is by Method A, from the motion, and by Method B. Allowable stresses are those of the case or of a named
!> material.
module gearsweep_study_tasks_rating
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_base, only: axis, claim_memory, code_memory, dp, each, error_t, fail, lines_t, lower, no_number, piecewise_t, str, &
    table_t, wants_stop
  use gearsweep_gear, only: drive, gear_t, normal_section, pair_t
  use gearsweep_mesh, only: balance_t, contact_intervals, iso_stiffness, share_load, sharing_t
  use gearsweep_motion, only: has_result, oscillator_t, point_t, status_stopped
  use gearsweep_rating, only: common_names, contact_life_curve, contact_number, contact_stress, counted_relief, deviations_of, &
    dynamic_factor_a, dynamic_factor_b, gear_materials, grade_of, grades, life_curve_t, life_curve_words, life_factor, &
    load_factors_t, material_length, method_b_t, no_grade, nominal_of, nominal_t, resonance_ratio, root_life_curve, root_number, &
    test_gear_correction, tooth_root_stress
  use gearsweep_study_case_task, only: gear_names, stage, task_info_t
  use gearsweep_study_reader_reader, only: first_nonblank, is_prescribed, needs_gears, reader_t, sentence_length, text_unless
  use gearsweep_study_run_points, only: add_caution, add_equal_flanks, add_several, find_point, known_count, of_estimate, &
    of_factor, of_motions, of_relief, of_speed, of_status, words_of
  use gearsweep_study_run_stages, only: runnable_t, stages_t
  implicit none
  private
  public :: limits_t, face_load_factor, find_nominal, read_material, read_load_factors, add_life_curves, largest_share
  public :: rating_task_t

  !> Allowable stress numbers of pinion and gear (Pa); NaN where the case gives none.
  type :: limits_t
    real(dp) :: contact(2) = 0, root(2) = 0                !< allowable stress numbers sigma_HG and sigma_FG, Pa
    real(dp) :: contact_number(2) = 0, root_number(2) = 0  !< stress numbers sigma_Hlim and sigma_Flim, Pa; NaN without a material
    character(material_length) :: material(2) = '', named(2) = ''  !< names of the materials in `gear_materials`, and in the case
    character(2) :: grade = ''                             !< quality grade of the material
    type(life_curve_t) :: contact_life(2), root_life(2)    !< life factors Z_NT and Y_NT of the materials
  contains
    procedure :: has_material
  end type limits_t

  !> Group of the material's keys and the load factors, and the tasks that use them.
  character(*), parameter :: group = 'rating', users = 'rating or life'

  !> Accuracy of the teeth.
  type :: accuracy_of_teeth_t
    integer :: grade = 5                         !< accuracy grade of ISO 1328-1, if no deviations are stated
    real(dp) :: deviation(2) = -1                !< deviations f_pb and f_f_alpha, m; below 0: by the grade
    real(dp) :: running_in = 0.075_dp            !< part of the deviations removed by running in
  end type accuracy_of_teeth_t

  !> Methods of the dynamic factor, and their words in a case and on the screen.
  integer, parameter :: by_larger = 1, by_a = 2, by_b = 3
  character(*), parameter :: methods(3) = [character(6) :: 'larger', 'a', 'b']
  character(*), parameter :: signs(3) = [character(60) :: 'by the larger of Methods A (motion) and B (formula)', &
    'by Method A (motion, without deviations of the teeth)', 'by Method B (formula)']

  type, extends(runnable_t) :: rating_task_t
    type(accuracy_of_teeth_t) :: accuracy
    integer :: method = by_larger                !< method of the dynamic factor for the stresses
    type(load_factors_t) :: factors              !< K_A is that of &load
    type(limits_t) :: limits                     !< allowable stress numbers of the gears
    real(dp) :: life = 0                         !< required life, s; 0: none
    logical :: has_face = .false.                !< true: the face load factors follow from the load over the face width
  contains
    procedure, nopass :: describe
    procedure :: read_keys, run, add_report
  end type rating_task_t

  real(dp), parameter :: hour = 3600

contains

  !> True if the case names the gears' material.
  pure logical function has_material(self)
    class(limits_t), intent(in) :: self

    has_material = all(self%material /= '')
  end function has_material

  !> Reads the material of the gears, with its strength and life factors. `not_allowed`: reason why none of its keys is allowed, or
  !> blank.
  subroutine read_material(reader, not_allowed, limits, error)
    type(reader_t), intent(inout) :: reader
    character(*), intent(in) :: not_allowed
    type(limits_t), intent(out) :: limits
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: material(:), grade, without
    real(dp) :: end
    logical :: given
    integer :: i, k

    limits%contact = no_number()
    limits%root = no_number()
    limits%contact_number = no_number()
    limits%root_number = no_number()
    call reader%get(group, 'material', material, error, is_stated=given, tasks=users, not_allowed=not_allowed, &
                    required=reader%requests('life') .and. .not. (reader%has('life', 'curve_cycles') .or. &
                                                               reader%has('life', 'curve_stress_mpa')), &
                    allowed=[gear_materials%name, common_names%name], min_size=1, max_size=2, &
                    default_note='none; the task life needs it or curve_cycles', &
                    meaning='material of both gears, or of pinion and gear, whose allowable stress numbers and life factors '// &
                    'are used; a common name stands for its usual treatment')
    without = trim(first_nonblank(not_allowed, text_unless(given, 'needs a material')))
    call reader%get(group, 'material_grade', grade, error, tasks=users, not_allowed=without, allowed=grades, &
                    default_note='mq, with a material', meaning='quality grade of the material by ISO 6336-5')
    end = 0.85_dp
    call reader%get(group, 'long_life_factor', end, error, tasks=users, not_allowed=without, at_least=0.85_dp, at_most=1.0_dp, &
                    meaning='Y_NT and Z_NT from 1e10 load cycles on: 0.85, or up to 1 with optimum lubrication, material, '// &
                    'manufacturing and experience')
    if (allocated(error) .or. .not. given) return
    if (.not. allocated(grade)) grade = 'mq'
    limits%named = material([1, size(material)])
    limits%grade = grade
    do i = 1, 2
      k = findloc([(lower(common_names(k)%name) == limits%named(i), k=1, size(common_names))], .true., 1)
      limits%material(i) = limits%named(i)
      if (k > 0) limits%named(i) = common_names(k)%name
      if (k > 0) limits%material(i) = common_names(k)%material
      k = findloc([gear_materials%name], limits%material(i), 1)
      limits%contact_number(i) = contact_number(gear_materials(k), findloc(grades, grade, 1))
      limits%root_number(i) = root_number(gear_materials(k), findloc(grades, grade, 1))
      limits%contact_life(i) = contact_life_curve(gear_materials(k), end)
      limits%root_life(i) = root_life_curve(gear_materials(k), end)
    end do
    limits%contact = limits%contact_number
    limits%root = test_gear_correction*limits%root_number
  end subroutine read_material

  !> Reads K_H_beta, for faces that meet evenly, and K_H_alpha with K_F_alpha, which ISO 6336 computes from deviations and this
  !> program does not. In `life` only the contact stress uses them, which requires a material.
  subroutine read_load_factors(reader, not_allowed, has_material, factors, error)
    type(reader_t), intent(inout) :: reader
    character(*), intent(in) :: not_allowed
    logical, intent(in) :: has_material
    type(load_factors_t), intent(inout) :: factors
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: unused_without

    unused_without = trim(text_unless(reader%requests('rating') .or. (reader%requests('life') .and. has_material), &
                          'rating, or life with a material'))
    call reader%get(group, 'face_load_factor', factors%face_load, error, tasks=users, unused_without=unused_without, &
                    not_allowed=not_allowed, &
                    at_least=1.0_dp, at_most=100.0_dp, meaning='K_H_beta: largest load of a unit of face width over the mean one')
    call reader%get(group, 'transverse_load_factor', factors%transverse, error, tasks=users, unused_without=unused_without, &
                    not_allowed=not_allowed, at_least=1.0_dp, at_most=100.0_dp, &
                    meaning='K_H_alpha and K_F_alpha, for deviations that let the pairs share the load unevenly')
  end subroutine read_load_factors

  !> K_H_beta: in the middle of single contact by the load over the face width, where the faces meet unevenly; else as `stated`.
  !> It depends on the relief above a contact ratio of 2 only; then the largest counts.
  pure real(dp) function face_load_factor(stages, stated) result(factor)
    type(stages_t), intent(in) :: stages
    real(dp), intent(in) :: stated

    factor = stated
    if (stages%faces%are_uneven()) factor = maxval(stages%face_loads%single_factor)
  end function face_load_factor

  !> Adds columns of the limits, a row for each gear.
  pure subroutine add_limits(limits, table)
    type(limits_t), intent(in) :: limits
    type(table_t), intent(inout) :: table

    call table%add_words('material', 'whose numbers are taken; empty for none', limits%material)
    call table%add_words('material_name', 'what the case calls it; empty for none', limits%named)
    call table%add_words('material_grade', 'its quality grade by ISO 6336-5; empty for none', spread(limits%grade, 1, 2))
    call table%add('contact_number_mpa', 'MPa', 'allowable stress number sigma_Hlim of the material; NaN without one', &
                   limits%contact_number)
    call table%add('root_number_mpa', 'MPa', 'nominal stress number sigma_Flim of the material; NaN without one', &
                   limits%root_number)
    if (limits%has_material()) then
      call table%add('contact_static_factor', '', 'Z_NT up to contact_static_cycles', [limits%contact_life%factor(1)])
      call table%add('contact_static_cycles', '', 'load cycles at the static end of Z_NT', [limits%contact_life%cycles(1)])
      call table%add('contact_knee_cycles', '', 'load cycles at the knee of Z_NT, where it is 1', [limits%contact_life%cycles(2)])
      call table%add('root_static_factor', '', 'Y_NT up to root_static_cycles', [limits%root_life%factor(1)])
      call table%add('root_static_cycles', '', 'load cycles at the static end of Y_NT', [limits%root_life%cycles(1)])
      call table%add('root_knee_cycles', '', 'load cycles at the knee of Y_NT, where it is 1', [limits%root_life%cycles(2)])
      call table%add('long_life_factor', '', 'Z_NT and Y_NT from last_cycles on', [limits%root_life%factor(3)])
      call table%add('last_cycles', '', 'load cycles at the last point of both', [limits%root_life%cycles(3)])
    end if
    call table%add('contact_limit_mpa', 'MPa', 'sigma_HG: as stated, or sigma_Hlim of the material; NaN for none', limits%contact)
    call table%add('root_limit_mpa', 'MPa', 'sigma_FG: as stated, or twice sigma_Flim of the material; NaN for none', limits%root)
  end subroutine add_limits

  !> Reports the life factors of the materials: one line for both gears if they are the same.
  pure subroutine add_life_curves(limits, lines)
    class(limits_t), intent(in) :: limits
    type(lines_t), intent(inout) :: lines
    integer :: i

    do i = 1, 2
      if (i == 2 .and. limits%material(1) == limits%material(2)) exit
      call lines%add('   S-N curves of '//trim(limits%material(i))//' (ISO 6336-2 and -3)')
      call lines%add('     root: '//trim(life_curve_words('Y_NT', limits%root_life(i))))
      call lines%add('     flank: '//trim(life_curve_words('Z_NT', limits%contact_life(i))))
    end do
  end subroutine add_life_curves

  !> Words of a load factor that only the case can state.
  pure function load_factor_text(factor) result(words)
    real(dp), intent(in) :: factor
    character(20) :: words

    words = str(factor, 4)
    if (.not. factor > 1) words = '1 (not computed)'
  end function load_factor_text

  !> Limits of one gear, in words.
  pure function of_gear(factors, i) result(words)
    type(table_t), intent(in) :: factors
    integer, intent(in) :: i                     ! row of the gear
    integer, parameter :: length = 120
    character(length) :: words
    character(:), allocatable :: material

    material = trim(factors%word('material_name', i))
    if (material /= factors%word('material', i)) material = material//' as '//trim(factors%word('material', i))
    words = ''
    if (material /= '') words = material//' of grade '//trim(factors%word('material_grade', i))//': sigma_Hlim '// &
      str(factors%number('contact_number_mpa', i), 5)//', sigma_Flim '//str(factors%number('root_number_mpa', i), 5)//' MPa; '
    if (bears('contact')) words = trim(words)//' sigma_HG '//trim(limit('contact'))
    if (bears('root')) words = trim(words)//trim(merge(',', ' ', bears('contact')))//' sigma_FG '//trim(limit('root'))
    if (.not. (bears('contact') .or. bears('root'))) words = 'no limits and no material are stated, so there is no safety factor'
    if (material == '' .and. (bears('contact') .or. bears('root'))) words = trim(words)//', as stated'
    words = adjustl(words)

  contains

    pure logical function bears(what)
      character(*), intent(in) :: what

      bears = .not. ieee_is_nan(factors%number(what//'_limit_mpa', i))
    end function bears

    pure function limit(what)
      character(*), intent(in) :: what
      character(30) :: limit

      limit = str(factors%number(what//'_limit_mpa', i), 5)//' MPa'
    end function limit
  end function of_gear

  !> Computes the inputs of Method B for each relief, and the accuracy grade of the pair. Relief counts by its amount at the tips.
  !> `error`: the stiffness by ISO 6336 is not available.
  subroutine need_method_b(stages, accuracy, of, grade, error)
    type(stages_t), intent(in) :: stages
    type(accuracy_of_teeth_t), intent(in) :: accuracy
    type(method_b_t), allocatable, intent(out) :: of(:)    !< (relief)
    integer, intent(out) :: grade
    type(error_t), allocatable, intent(inout) :: error
    type(piecewise_t) :: stiffness
    type(method_b_t) :: one
    real(dp) :: deviation(2), diameter
    integer :: i

    grade = no_grade
    associate (pair => stages%pair, spec => stages%pair%gear%spec, width => minval(stages%pair%gear%spec%face_width))
      call iso_stiffness(pair, stages%material, stages%load/width, stiffness, error, stages%iso)
      if (allocated(error)) return
      ! The larger gear has the larger allowed deviations.
      diameter = 2*maxval(pair%gear%reference_radius)
      deviation = deviations_of(accuracy%grade, spec(1)%module, diameter, pair%gear(1)%transverse_angle(drive))
      deviation = merge(accuracy%deviation, deviation, accuracy%deviation >= 0)
      grade = grade_of(deviation, spec(1)%module, diameter, pair%gear(1)%transverse_angle(drive))
      deviation = deviation*(1 - accuracy%running_in)
      one = method_b_t(spec(1)%teeth, pair%contact_ratio + pair%overlap_ratio, single_stiffness=stiffness%maximum()/width, &
                       mass=product(stages%mass)/sum(stages%mass)/width, pitch_deviation=deviation(1), &
                       profile_deviation=deviation(2))
      one%mesh_stiffness = one%single_stiffness*(0.75_dp*pair%contact_ratio + 0.25_dp)
      one%line_load = stages%load*cos(pair%gear(1)%transverse_angle(drive))*stages%iso%application_factor/width
    end associate
    allocate (of(size(stages%amount)), source=one)
    do i = 1, size(of)
      of(i)%relief = counted_relief(stages%amount(i)*stages%motions_inputs%motion%relief%fraction, grade)
    end do
  end subroutine need_method_b

  !> Computes the nominal stresses under the load of the case, of helical roots by their virtual gears. K_F_beta of uneven faces is
  !> that of the load over the face width.
  subroutine find_nominal(stages, face_load, grade, nominal, error)
    type(stages_t), intent(in) :: stages
    real(dp), intent(in) :: face_load            !< face load factor K_H_beta
    integer, intent(in) :: grade                 !< as of `nominal_of`
    type(nominal_t), intent(out) :: nominal
    type(error_t), allocatable, intent(inout) :: error
    type(pair_t) :: normal
    type(gear_t), allocatable :: virtual(:)

    if (stages%pair%overlap_ratio > 0) then
      call normal_section(stages%pair, .false., normal, error)
      if (allocated(error)) return
      virtual = normal%gear
    end if
    nominal = nominal_of(stages%pair, stages%material, stages%load, stages%iso%rim_thickness, face_load, grade, virtual)
    if (stages%faces%are_uneven()) nominal%root_face_load = maxval(stages%face_loads%root_factor)
  end subroutine find_nominal

  !> Largest static load of a pair over the static load of the mesh.
  pure real(dp) function largest_share(motion) result(share)
    type(oscillator_t), intent(in) :: motion
    integer, parameter :: samples = 400
    type(sharing_t) :: sharing

    call share_load(motion%mesh, motion%load, samples, sharing, contact_intervals(motion%mesh, balance_t(motion%load)))
    share = maxval(sharing%load)/motion%load
  end function largest_share

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t(group, needs=[stage%geometry, stage%elasticity, stage%rims, stage%webs, stage%mesh, stage%reliefs, &
                                     stage%amounts, stage%motion, stage%losses, stage%accuracy, stage%face], &
                       tables='rating rating_factors dynamic_factors', fields='', has_helical=.true., &
                       summary='contact and root stress by ISO 6336, with K_v of the motion beside that of Method B')
  end subroutine describe

  subroutine read_keys(self, reader, error)
    class(rating_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    type(error_t), allocatable, intent(inout) :: error
    character(sentence_length) :: geared
    character(*), parameter :: by_material = 'the material says it; give one of the two'
    real(dp), allocatable :: contact(:), root(:)
    character(:), allocatable :: method
    logical :: stated(2)

    call reader%add_group(group, 'The task rating: contact and tooth root stress by ISO 6336.')
    geared = text_unless(.not. is_prescribed(reader), needs_gears)
    call reader%get(group, 'rpm', self%own_rpm, error, unit='1/min', required=.true., tasks=group, not_allowed=geared, &
                    at_least=1e-6_dp, at_most=1e9_dp, max_size=1000, distinct=.true., meaning='speeds of the pinion')
    method = methods(by_larger)
    call reader%get(group, 'dynamic_factor_method', method, error, tasks=group, not_allowed=geared, allowed=methods, &
                    meaning='which K_v of ISO 6336-1 stresses and safety factors take: that of Method A (a: from the motion, '// &
                    'without deviations of the teeth), of Method B (b: by formula), or the larger of both')
    if (.not. allocated(error)) self%method = findloc(methods == method, .true., 1)
    call reader%get(group, 'pitch_deviation_um', self%accuracy%deviation(1), error, unit='um', is_stated=stated(1), tasks=group, &
                    not_allowed=geared, at_least=0.0_dp, at_most=1e4_dp, default_note='what accuracy_grade allows', &
                    meaning='transverse base pitch deviation f_pb before running in, for K_v by Method B')
    call reader%get(group, 'profile_deviation_um', self%accuracy%deviation(2), error, unit='um', is_stated=stated(2), tasks=group, &
                    not_allowed=geared, at_least=0.0_dp, at_most=1e4_dp, default_note='what accuracy_grade allows', &
                    meaning='profile form deviation f_f_alpha before running in, for K_v by Method B')
    call reader%get(group, 'accuracy_grade', self%accuracy%grade, error, tasks=group, at_least=0, at_most=12, &
                    not_allowed=first_nonblank(geared, text_unless(.not. all(stated), 'both deviations are given; remove it')), &
                    meaning='accuracy grade of ISO 1328-1, for K_v by Method B')
    call reader%get(group, 'running_in', self%accuracy%running_in, error, tasks=group, not_allowed=geared, at_least=0.0_dp, &
                    at_most=1.0_dp, meaning='fraction of the deviations that running in takes: 0.075 for case-hardened and '// &
                    'nitrided gears')
    where (.not. stated) self%accuracy%deviation = -1
    call read_material(reader, geared, self%limits, error)
    call read_load_factors(reader, geared, self%limits%has_material(), self%factors, error)
    call reader%get(group, 'contact_limit_mpa', contact, error, unit='MPa', tasks=group, &
                    not_allowed=first_nonblank(geared, text_unless(.not. self%limits%has_material(), by_material)), above=0.0_dp, &
                    at_most=1e6_dp, max_size=2, default_note='that of the material; without one, no safety factor', &
                    meaning='contact stress sigma_HG that both gears, or pinion and gear, bear, for the safety factor S_H: '// &
                    'sigma_Hlim with its factors of life, lubrication and size')
    call reader%get(group, 'root_limit_mpa', root, error, unit='MPa', tasks=group, &
                    not_allowed=first_nonblank(geared, text_unless(.not. self%limits%has_material(), by_material)), above=0.0_dp, &
                    at_most=1e6_dp, max_size=2, default_note='that of the material; without one, no safety factor', &
                    meaning='tooth root stress sigma_FG that they bear, for the safety factor S_F: sigma_FE with its factors '// &
                    'of life, notch and size')
    if (allocated(error)) return
    if (allocated(contact)) self%limits%contact = contact([1, size(contact)])
    if (allocated(root)) self%limits%root = root([1, size(root)])
    call reader%get(group, 'life_h', self%life, error, unit='h', tasks=group, above=0.0_dp, at_most=1e9_dp, &
                    not_allowed=first_nonblank(geared, text_unless(self%limits%has_material(), 'needs a material')), &
                    default_note='none', &
                    meaning='required life: the safety factors for as many load cycles, by Z_NT and Y_NT, are added to those '// &
                    'of endurance')
  end subroutine read_keys

  subroutine run(self, stages, error)
    class(rating_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(error_t), allocatable, intent(inout) :: error
    type(point_t), allocatable :: point(:, :)    ! (speed, relief)
    integer, allocatable :: motions(:, :)        ! number of motions
    type(method_b_t), allocatable :: of(:)                 ! inputs of Method B; (relief)
    type(nominal_t) :: nominal
    integer :: grade, i, k
    logical :: out_of_memory

    if (allocated(error)) return
    self%factors%application = stages%iso%application_factor
    self%has_face = stages%faces%are_uneven()
    self%factors%face_load = face_load_factor(stages, self%factors%face_load)
    call need_method_b(stages, self%accuracy, of, grade, error)
    if (.not. allocated(error)) call find_nominal(stages, self%factors%face_load, grade, nominal, error)
    call claim_memory(1000.0_dp*size(stages%motion)*size(self%own_rpm), '&rating rpm: '// &
                      str(size(stages%motion)*size(self%own_rpm))//' motions', error)
    if (allocated(error)) return
    allocate (point(size(self%own_rpm), size(stages%motion)), motions(size(self%own_rpm), size(stages%motion)))
    do i = 1, size(stages%motion)
      do k = 1, size(self%own_rpm)
        if (wants_stop(stages%accuracy%steady%stop)) return
        call find_point(stages%motion(i), self%own_rpm(k), stages%accuracy, point(k, i), motions(k, i), out_of_memory)
        if (out_of_memory) call fail(error, code_memory, '&rating rpm = '//str(self%own_rpm(k))// &
          ': the memory does not hold the motion')
        if (allocated(error)) return
        call stages%running%report_progress(1, stages%accuracy%steady%stop)
      end do
    end do
    call fill_dynamic(stages, self%own_rpm, of, point, motions, self%tables(self%place('dynamic_factors')), error)
    call fill_factors(stages, self, nominal, of(1), self%tables(self%place('rating_factors')), error)
    call fill_rating(self, nominal, stages%amount, [stages%pair%gear%spec%teeth], self%tables(self%place('rating')), error)
    self%is_done = .true.
    self%is_stopped = any(point%steady%status == status_stopped)
    self%failed = count(.not. has_result(point%steady%status))
    self%log = 'rating: '//str(size(point))//' operating points rated'
  end subroutine run

  !> Fills K_v by both methods.
  pure subroutine fill_dynamic(stages, rpm, of, point, motions, table, error)
    type(stages_t), intent(in) :: stages
    real(dp), intent(in) :: rpm(:)
    type(method_b_t), intent(in) :: of(:)
    type(point_t), intent(in) :: point(:, :)     ! (speed, relief)
    integer, intent(in) :: motions(:, :)         ! number of motions
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: factor(:), share(:)
    integer, allocatable :: status(:)
    integer :: i, m, n

    m = size(stages%amount)
    n = size(rpm)
    call table%over('dynamic factor K_v by Method A, from the motion, and by Method B', error, &
                    axis('relief_um', 'um', of_relief, stages%amount), axis('rpm', '1/min', of_speed, rpm))
    if (allocated(error)) return
    share = each([(largest_share(stages%motion(i)), i=1, m)], n)
    status = [point%steady%status]
    factor = merge([point%dynamic_factor], no_number(), has_result(status))
    call table%add('dynamic_factor', '', of_factor, factor)
    call table%add('error_estimate', '', of_estimate, merge([point%estimate], no_number(), has_result(status)))
    call table%add_words('status', of_status, words_of(status))
    call table%add('motions', '', of_motions, [known_count(motions)])
    call table%add('static_share', '', 'largest load of a pair at rest over the static load', share)
    call table%add('dynamic_factor_a', '', 'K_v by ISO 6336-1, Method A: DF over static_share, at least 1; NaN where there is '// &
                   'no answer', dynamic_factor_a(factor, share))
    call table%add('dynamic_factor_b', '', 'K_v by ISO 6336-1, Method B', [(dynamic_factor_b(of(i), rpm), i=1, m)])
    call table%add('resonance_ratio', '', 'N: speed over the resonance running speed of Method B', &
                   [(resonance_ratio(of(i), rpm), i=1, m)])
  end subroutine fill_dynamic

  !> Fills the factors that do not depend on the speed.
  subroutine fill_factors(stages, task, nominal, of, table, error)
    type(stages_t), intent(in) :: stages
    type(rating_task_t), intent(in) :: task
    type(nominal_t), intent(in) :: nominal
    type(method_b_t), intent(in) :: of
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error

    call table%over('factors of ISO 6336:2006 that do not depend on the speed', error, &
                    axis('gear', '', 'pinion or gear', gear_names))
    if (allocated(error)) return
    call both('tangential_load_n', 'N', 'nominal load F_t on the reference circle', nominal%load)
    call both('application_factor', '', 'K_A, of the case', task%factors%application)
    if (task%has_face) then
      call both('face_load_factor', '', 'K_H_beta, by the load over the face width', task%factors%face_load)
      call both('root_face_load_factor', '', 'K_F_beta, by the load over the face width', nominal%root_face_load)
    else
      call both('face_load_factor', '', 'K_H_beta, of the case', task%factors%face_load)
      call both('root_face_load_factor', '', 'K_F_beta, ISO 6336-1, clause 7', nominal%root_face_load)
    end if
    call both('transverse_load_factor', '', 'K_H_alpha and K_F_alpha, of the case', task%factors%transverse)
    call both('zone_factor', '', 'Z_H, ISO 6336-2, clause 6', nominal%flank%zone)
    call table%add('single_pair_factor', '', 'Z_B of the pinion, Z_D of the gear, ISO 6336-2, clause 6', nominal%flank%single_pair)
    call both('elasticity_factor_sqrt_mpa', 'sqrt(MPa)', 'Z_E, ISO 6336-2, clause 7', nominal%flank%elasticity)
    call both('contact_ratio_factor', '', 'Z_eps, ISO 6336-2, clause 8', nominal%flank%contact_ratio)
    if (stages%pair%overlap_ratio > 0) then
      call both('helix_factor', '', 'of helical gears: Z_beta, ISO 6336-2, clause 9', nominal%flank%helix)
      call both('root_helix_factor', '', 'of helical gears: Y_beta, ISO 6336-3, clause 8', nominal%helix)
    end if
    call both('nominal_contact_mpa', 'MPa', 'nominal contact stress sigma_H0, ISO 6336-2, clause 5', nominal%contact)
    call table%add('form_factor', '', 'Y_F, ISO 6336-3, clause 6', [nominal%form%form_factor])
    call table%add('stress_correction', '', 'Y_S, ISO 6336-3, clause 7', [nominal%form%correction])
    call table%add('rim_factor', '', 'Y_B, ISO 6336-3, clause 9', nominal%rim)
    call both('deep_tooth_factor', '', 'Y_DT, ISO 6336-3, clause 10', nominal%deep)
    call table%add('nominal_root_mpa', 'MPa', 'nominal tooth root stress sigma_F0, ISO 6336-3, clause 5', nominal%root)
    call both('single_stiffness_n_mm_um', 'N/(mm um)', 'c'', ISO 6336-1, clause 9', of%single_stiffness)
    call both('mesh_stiffness_n_mm_um', 'N/(mm um)', 'c_gamma_alpha, ISO 6336-1, clause 9', of%mesh_stiffness)
    call both('reduced_mass_kg_mm', 'kg/mm', 'm_red of a unit of face width, from the effective masses of the case', of%mass)
    call both('resonance_rpm', '1/min', 'resonance running speed n_E1 of the pinion, ISO 6336-1, 6.5.3', &
              1/resonance_ratio(of, 1.0_dp))
    call table%add('accuracy_grade', '', 'of ISO 1328-1; with stated deviations the finest that allows both, 13 for none', &
                   [nominal%grade, nominal%grade])
    call both('pitch_deviation_um', 'um', 'f_pb after running in', of%pitch_deviation)
    call both('profile_deviation_um', 'um', 'f_f_alpha after running in', of%profile_deviation)
    call add_limits(task%limits, table)
    call add_equal_flanks(stages%pair, 2, table)

  contains

    subroutine both(name, unit, meaning, value)
      character(*), intent(in) :: name, unit, meaning
      real(dp), intent(in) :: value

      call table%add(name, unit, meaning, [value, value])
    end subroutine both
  end subroutine fill_factors

  !> Fills stresses and safety factors, with the dynamic factor of the chosen method.
  subroutine fill_rating(self, nominal, amount, teeth, table, error)
    class(rating_task_t), intent(in) :: self
    type(nominal_t), intent(in) :: nominal
    real(dp), intent(in) :: amount(:)
    integer, intent(in) :: teeth(2)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: dynamic(:), contact(:), root(:), cycles(:), factor(:), a(:), b(:)
    character(1), allocatable :: method(:)
    integer, allocatable :: gear(:)
    integer :: i, m, n
    logical, allocatable :: takes_b(:)

    m = size(amount)
    n = size(self%own_rpm)
    call table%over('contact stress and tooth root stress by ISO 6336, and their safety factors', error, &
                    axis('relief_um', 'um', of_relief, amount), axis('rpm', '1/min', of_speed, self%own_rpm), &
                    axis('gear', '', 'pinion or gear', gear_names))
    if (allocated(error)) return
    associate (table => self%tables(self%place('dynamic_factors')))
      a = each(table%numbers('dynamic_factor_a'), 2)
      b = each(table%numbers('dynamic_factor_b'), 2)
    end associate
    takes_b = spread(self%method == by_b, 1, size(a))
    if (self%method == by_larger) takes_b = b > a
    dynamic = merge(b, a, takes_b)
    method = merge('b', 'a', takes_b)
    gear = [(1, 2, i=1, m*n)]
    contact = contact_stress(nominal%contact, nominal%flank%single_pair(gear), self%factors, dynamic)
    root = tooth_root_stress(nominal%root(gear), self%factors, nominal%root_face_load, dynamic)
    call table%add_words('method', 'method of this K_v, as in dynamic_factor_method: a or b', method)
    call table%add('internal_dynamic_factor', '', 'K_v by that method; NaN where there is no answer', dynamic)
    call table%add('contact_stress_mpa', 'MPa', 'contact stress sigma_H', contact)
    call table%add('contact_safety', '', 'S_H; NaN without contact_limit_mpa or a material', self%limits%contact(gear)/contact)
    call table%add('root_stress_mpa', 'MPa', 'tooth root stress sigma_F', root)
    call table%add('root_safety', '', 'S_F; NaN without root_limit_mpa or a material', self%limits%root(gear)/root)
    if (.not. self%life > 0) return
    cycles = table%along(2, self%own_rpm)/60*self%life*teeth(1)/teeth(gear)
    call table%add('required_life_h', 'h', 'as in the case', spread(self%life, 1, size(gear)))
    call table%add('load_cycles', '', 'N_L in the required life, one a revolution', cycles)
    factor = life_factor(self%limits%contact_life(gear), cycles)
    call table%add('contact_life_factor', '', 'Z_NT', factor)
    call table%add('contact_life_safety', '', 'S_H for the required life', factor*self%limits%contact(gear)/contact)
    factor = life_factor(self%limits%root_life(gear), cycles)
    call table%add('root_life_factor', '', 'Y_NT', factor)
    call table%add('root_life_safety', '', 'S_F for the required life', factor*self%limits%root(gear)/root)
  end subroutine fill_rating

  pure subroutine add_report(self, lines)
    class(rating_task_t), intent(in) :: self
    type(lines_t), intent(inout) :: lines
    integer :: grade
    character(:), allocatable :: face
    character(:), allocatable :: ground(:)

    call lines%add('')
    associate (rating => self%tables(self%place('rating')), dynamic => self%tables(self%place('dynamic_factors')), &
               factors => self%tables(self%place('rating_factors')))
      call lines%add('Rating by ISO 6336, with K_v '//trim(signs(self%method)))
      grade = nint(factors%number('accuracy_grade', 1))
      face = trim(load_factor_text(factors%number('face_load_factor', 1)))
      if (self%has_face) face = str(factors%number('face_load_factor', 1), 4)//' and K_F_beta '// &
        str(factors%number('root_face_load_factor', 1), 4)//' by the load over the face width'
      call lines%add('   K_A '//str(factors%number('application_factor', 1), 4)//', K_H_beta '//face// &
                     ', K_H_alpha and K_F_alpha '// &
                     trim(load_factor_text(factors%number('transverse_load_factor', 1)))//'; accuracy grade '//str(grade))
      ground = [of_gear(factors, 1), of_gear(factors, 2)]
      if (ground(1) == ground(2)) then
        call lines%add('   both gears: '//trim(ground(1)))
      else
        call lines%add('   pinion: '//trim(ground(1)))
        call lines%add('   gear: '//trim(ground(2)))
      end if
      call dynamic%show(lines, 'relief_um rpm dynamic_factor_a dynamic_factor_b status')
      call rating%show(lines, 'relief_um rpm gear contact_stress_mpa contact_safety root_stress_mpa root_safety')
      call add_several(dynamic, lines)
      if (self%life > 0) then
        call lines%add('   for '//str(self%life/hour)//' h')
        call add_life_curves(self%limits, lines)
        call rating%show(lines, 'relief_um rpm gear load_cycles contact_life_factor contact_life_safety root_life_factor '// &
                         'root_life_safety')
      end if
    end associate
    call add_caution(self%tables(self%place('rating_factors')), lines)
  end subroutine add_report
end module gearsweep_study_tasks_rating
