!> Checks of combinations of the keys of a case.
module gearsweep_study_case_case_checks
  use gearsweep_base, only: code_input, dp, error_t, fail, pi, str
  use gearsweep_motion, only: most_points
  use gearsweep_study_case_case, only: case_t
  use gearsweep_study_case_task, only: case_facts_t, stage
  implicit none
  private
  public :: add_length_cautions, check_case

contains

  subroutine check_case(case, error)
    type(case_t), intent(in) :: case
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: torques(:)
    integer :: i, given

    allocate (torques(0))
    if (allocated(case%torques)) torques = case%torques
    given = count([case%torque, case%normal_force, case%line_load] > 0)
    if (given > 1 .or. (given == 0 .and. case%needs(stage%mesh))) call fail(error, code_input, &
      '&load: give one of torque_nm (on the pinion), torques_nm, normal_force_n and line_load_n_mm; '//str(given)//' are given')
    if (allocated(case%torques)) then
      if (size(case%torques) > 1 .and. case%needs(stage%mesh) .and. .not. case%requests('optimum')) call fail(error, code_input, &
        '&load torques_nm: only the task optimum uses several torques; without it give torque_nm = '//str(case%torque))
    end if
    do i = 1, 2
      if (case%mass(i) > 0 .and. case%inertia(i) > 0) call fail(error, code_input, '&'//trim(case%spec(i)%name)// &
        ' inertia_kgm2: give effective_mass_kg or inertia_kgm2, not both')
    end do
    if (case%prescribed) call check_prescribed(case, error)
    call check_face(case, error)
    if (all(case%fraction <= 0)) call fail(error, code_input, &
      '&relief gear_fraction = 0: with pinion_fraction = 0 no gear is relieved')
    if (case%length > 0 .neqv. case%start == 'length') call fail(error, code_input, &
      '&relief length_mm: goes with start = ''length'' and only with it')
    if (any(case%roll > 0 .neqv. (case%start == 'roll' .and. case%fraction > 0))) call fail(error, code_input, &
      '&relief pinion_roll_deg, gear_roll_deg: go with start = ''roll'', one for each relieved gear')
    if (.not. case%prescribed) call check_units(case, error)
    if (case%needs(stage%speeds)) then
      if (case%rpm_last < case%rpm_first) call fail(error, code_input, '&sweep rpm_last = '//str(case%rpm_last)// &
        ': must not lie below rpm_first = '//str(case%rpm_first)//'; to sweep downwards, direction = ''down''')
      if ((1 + (case%rpm_last - case%rpm_first)/case%rpm_step)*size(case%amount) > most_points) call fail(error, code_input, &
        '&sweep rpm_step = '//str(case%rpm_step)//': more than '//str(most_points)//' operating points')
    end if
    do i = 1, size(case%tasks)
      if (case%tasks(i)%is_requested) call case%tasks(i)%task%check( &
        case_facts_t(case%amount, case%spec, case%accuracy%scheme, torques), error)
    end do
  end subroutine check_case

  !> Refuses bodies and stiffnesses whose load over the face width is not known, and friction in the motions that follow from it.
  subroutine check_face(case, error)
    type(case_t), intent(in) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(*), parameter :: tasks = '&case tasks: the load over the face width needs ', &
                               purpose = ' for the load over the face width'

    if (.not. (case%needs_face_load() .or. case%has_uneven_motion() .or. case%is_helical() .and. case%needs(stage%mesh))) return
    if (case%prescribed) return
    if (case%model /= 'fe') call fail(error, code_input, '&mesh model = '''//case%model//''': must be ''fe'''//purpose)
    if (abs(case%spec(1)%helix_angle) > 30.001_dp*pi/180) call fail(error, code_input, '&pair helix_angle_deg = '// &
      str(abs(case%spec(1)%helix_angle)*180/pi)//': must be at most 30'//purpose)
    if (abs(case%spec(1)%helix_angle) > 0 .and. case%section%teeth >= minval(case%spec%teeth)) call fail(error, code_input, &
      '&section teeth = '//str(case%section%teeth)//': must be 0, for whole gears, or fewer than helical gears have')
    if (.not. case%section%plane_strain) call fail(error, code_input, '&section plane = ''stress'': must be ''strain'''//purpose)
    if (case%has_support .and. .not. case%section%fixed_rim) call fail(error, code_input, tasks// &
      'bodies held inside, &section fixed = ''sides'', ''rim''')
    ! The pair stiffness of a gear with a web has a rim that is free inside, unless the section says otherwise.
    if (any(case%iso%web_thickness > 0) .and. .not. (case%has_support .or. case%section%rim > 0 .or. case%section%teeth == 0)) &
      call fail(error, code_input, tasks//'bodies held inside: of gears with a web, &section fixed = ''sides'', ''rim''')
    if (case%friction > 0 .and. case%is_helical() .and. case%needs(stage%motion)) call fail(error, code_input, &
      '&dynamics friction = '//str(case%friction)//': must be 0 for helical gears; remove it')
    if (case%friction > 0 .and. case%has_uneven_motion()) call fail(error, code_input, '&dynamics friction = '// &
      str(case%friction)//': must be 0 in a sweep with uneven faces; remove it, or &face and the leads')
  end subroutine check_face

  !> Refuses keys of a prescribed mesh that follow from gears.
  subroutine check_prescribed(case, error)
    type(case_t), intent(in) :: case
    type(error_t), allocatable, intent(inout) :: error
    integer :: i

    do i = 1, 2
      if (case%mass(i) <= 0 .and. case%inertia(i) <= 0) call fail(error, code_input, '&'//trim(case%spec(i)%name)// &
        ' effective_mass_kg: missing; a prescribed mesh has no body to take it from; must be above 0')
    end do
    if (case%base_pitch <= 0) then
      if (case%torque > 0) call need('&mesh base_pitch_mm', 'a torque on a prescribed mesh needs it')
      if (any(case%inertia > 0)) call need('&mesh base_pitch_mm', 'an inertia on a prescribed mesh needs it')
      if (case%length > 0) call need('&mesh base_pitch_mm', '&relief length_mm needs it')
    end if
    if (case%line_load > 0 .and. case%spec(1)%face_width <= 0) call need('&pair face_width_mm', 'a line load needs it')
    if (case%spec(2)%teeth == 0) then
      if (case%friction > 0) call fail(error, code_input, '&gear teeth: missing; friction needs it; must be at least 5')
      if (case%inertia(2) > 0) call fail(error, code_input, &
        '&gear teeth: missing; &gear inertia_kgm2 of a prescribed mesh needs it; must be at least 5')
    end if
    if (case%pitch_point > case%contact_ratio) call fail(error, code_input, &
      '&mesh pitch_point = '//str(case%pitch_point)//': must be at most the contact ratio')
    if (case%start == 'roll') call fail(error, code_input, &
      '&relief start = ''roll'': a prescribed mesh has no roll angles; use length_mm')

  contains

    subroutine need(key, why)
      character(*), intent(in) :: key, why

      call fail(error, code_input, key//': missing; '//why//'; must be above 0')
    end subroutine need
  end subroutine check_prescribed

  !> Refuses lengths that no gear has, usually from a number in another unit than its key's.
  subroutine check_units(case, error)
    type(case_t), intent(in) :: case
    type(error_t), allocatable, intent(inout) :: error
    real(dp), parameter :: mm = 1e-3_dp, um = 1e-6_dp, least_relief = 0.05_dp*um, fraction = 0.1_dp
    integer :: i

    associate (module => case%spec(1)%module, width => case%spec(1)%face_width)
      if (width < fraction*module) call fail(error, code_input, '&pair face_width_mm = '//str(width/mm)// &
        ': must be at least a tenth of the module'//trim(meant(width, mm, 'm')))
      do i = 1, size(case%amount)
        associate (amount => case%amount(i))
          if (amount > 0 .and. amount < least_relief) call fail(error, code_input, '&relief amount_um = '//str(amount/um)// &
            ': must be 0 or at least 0.05'//trim(meant(amount, um, 'mm')))
          if (amount > fraction*module) call fail(error, code_input, '&relief amount_um = '//str(amount/um)// &
            ': must be at most a tenth of the module, '//str(fraction*module/um))
        end associate
      end do
    end associate

  contains

    !> Suggests the value for a number in a unit 1000 times as large.
    function meant(value, unit, other) result(words)
      real(dp), intent(in) :: value, unit
      character(*), intent(in) :: other
      character(100) :: words

      words = '; if '//str(value/unit)//' '//other//' is meant, write '//str(1000*value/unit)
    end function meant
  end subroutine check_units

  !> Warns of lengths that are unusually small compared with the module, usually from a number in metres.
  subroutine add_length_cautions(case)
    type(case_t), intent(inout) :: case
    real(dp), parameter :: mm = 1e-3_dp, part = 0.1_dp, edge = 0.002_dp
    integer :: i

    if (case%prescribed) return
    call judge('&relief length_mm', case%length, part/2)
    if (case%needs_elements()) call judge('&section rim_mm', case%section%rim, part)
    do i = 1, 2
      associate (spec => case%spec(i), iso => case%iso)
        call judge('&'//trim(spec%name)//' bore_mm', 2*spec%bore_radius, part)
        call judge('&'//trim(spec%name)//' web_thickness_mm', iso%web_thickness(i), part)
        call judge('&'//trim(spec%name)//' rim_thickness_mm', iso%rim_thickness(i), part)
        call judge('&'//trim(spec%name)//' tip_chamfer_mm', spec%tip_chamfer, edge)
        call judge('&'//trim(spec%name)//' tip_rounding_mm', spec%tip_rounding, edge)
        call judge('&'//trim(spec%name)//' protuberance_mm', spec%protuberance, edge)
        call judge('&'//trim(spec%name)//' grinding_stock_mm', spec%grinding_stock, edge)
      end associate
    end do

  contains

    subroutine judge(key, length, least)
      character(*), intent(in) :: key
      real(dp), intent(in) :: length, least      ! length, m; its least usual value, modules

      if (length <= 0 .or. length >= least*case%spec(1)%module) return
      case%cautions = case%cautions//key//': '//str(length/mm)//' is unusual beside a module of '//str(case%spec(1)%module/mm)// &
                      ' mm; if '//str(length/mm)//' m is meant, write '//str(length/mm**2)//new_line('a')
    end subroutine judge
  end subroutine add_length_cautions
end module gearsweep_study_case_case_checks
