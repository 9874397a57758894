!> What the keys of a case must be together.
module gearsweep_case_checks
  use gearsweep_case, only: case_t
  use gearsweep_kinds, only: dp
  use gearsweep_error, only: code_input, error_t, fail
  use gearsweep_sweep_state, only: most_points
  use gearsweep_task, only: case_facts_t, stage
  use gearsweep_text, only: str
  implicit none
  private
  public :: check_case

contains

  subroutine check_case(case, error)
    type(case_t), intent(in) :: case
    type(error_t), allocatable, intent(inout) :: error
    integer :: i

    call check_load(case, error)
    if (case%prescribed) call check_prescribed(case, error)
    call check_relief(case, error)
    if (.not. case%prescribed) call check_units(case, error)
    call check_speeds(case, error)
    do i = 1, size(case%tasks)
      if (case%tasks(i)%is_wanted) call case%tasks(i)%task%check(case_facts_t(case%amount, case%spec, case%accuracy%scheme), error)
    end do
  end subroutine check_case

  subroutine check_load(case, error)
    type(case_t), intent(in) :: case
    type(error_t), allocatable, intent(inout) :: error
    integer :: given, i

    given = count([case%torque, case%normal_force, case%line_load] > 0)
    if (given > 1 .or. (given == 0 .and. case%needs(stage%mesh))) call fail(error, code_input, &
      '&load: give one of torque_nm (on the pinion), normal_force_n and line_load_n_mm; '//str(given)//' are given')
    do i = 1, 2
      if (case%mass(i) > 0 .and. case%inertia(i) > 0) call fail(error, code_input, '&'//trim(case%spec(i)%name)// &
        ' inertia_kgm2: give effective_mass_kg or inertia_kgm2, not both')
    end do
  end subroutine check_load

  !> What follows from the gears where there are any.
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

  subroutine check_relief(case, error)
    type(case_t), intent(in) :: case
    type(error_t), allocatable, intent(inout) :: error

    if (all(case%fraction <= 0)) call fail(error, code_input, &
      '&relief gear_fraction = 0: with pinion_fraction = 0 no gear is relieved')
    if (case%length > 0 .neqv. case%start == 'length') call fail(error, code_input, &
      '&relief length_mm: goes with start = ''length'' and only with it')
    if (any(case%roll > 0 .neqv. (case%start == 'roll' .and. case%fraction > 0))) call fail(error, code_input, &
      '&relief pinion_roll_deg, gear_roll_deg: go with start = ''roll'', one for each relieved gear')
  end subroutine check_relief

  !> Lengths that no gear has, as they come about where a number is in another unit than its key.
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

    !> What the number would be if it was meant in a unit 1000 times as large.
    function meant(value, unit, other) result(words)
      real(dp), intent(in) :: value, unit
      character(*), intent(in) :: other
      character(100) :: words

      words = '; if '//str(value/unit)//' '//other//' is meant, write '//str(1000*value/unit)
    end function meant
  end subroutine check_units

  subroutine check_speeds(case, error)
    type(case_t), intent(in) :: case
    type(error_t), allocatable, intent(inout) :: error

    associate (reliefs => size(case%amount))
      if (.not. case%needs(stage%speeds)) return
      if (case%rpm_last < case%rpm_first) call fail(error, code_input, '&sweep rpm_last = '//str(case%rpm_last)// &
        ': must not lie below rpm_first = '//str(case%rpm_first)//'; to sweep downwards, direction = ''down''')
      if ((1 + (case%rpm_last - case%rpm_first)/case%rpm_step)*reliefs > most_points) call fail(error, code_input, &
        '&sweep rpm_step = '//str(case%rpm_step)//': more than '//str(most_points)//' operating points')
    end associate
  end subroutine check_speeds
end module gearsweep_case_checks
