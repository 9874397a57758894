!> What follows from the gears' geometry in closed form: relief along the path of contact, masses, loads and
!> friction factors, for equal and unequal flanks, shifted and spread gears.
module test_relief_closed_forms
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_motion_oscillator, only: mobility
  use gearsweep_base_text, only: str
  use test_support_ask_by_name, only: answer_t, ask
  use test_support_gears, only: stated_t, examples, text_of, base_radius, tip_radius, working_angle, first_curvature, &
    & base_pitch, contact_ratio, degree, drive
  use test_support_testing, only: tally_t, check_true, check_close, check_equal
  implicit none
  private
  public :: run

  character(*), parameter :: driven = '&load torque_nm=150 / &mesh model=''iso6336'' corner_contact=.false. / '

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('relief_by_roll_angle')) call relief_by_roll_angle(t)
    if (t%wants('relief_by_length')) call relief_by_length(t)
    if (t%wants('masses_and_loads')) call masses_and_loads(t)
    if (t%wants('friction_factors')) call friction_factors(t)
  end subroutine run

  !> Relief that begins at stated roll angles grows in proportion to them up to the tip (Dogan et al. 2021,
  !> section 2.2), on both gears at once, each by its own; a parabola by their square.
  subroutine relief_by_roll_angle(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: amount = 12, share(2) = [1.0_dp, 0.5_dp]
    character(*), parameter :: shapes(2) = [character(9) :: 'linear', 'parabolic']
    type(stated_t) :: list(5)
    type(answer_t) :: answer
    real(dp), allocatable :: s(:), found(:)
    real(dp) :: rb(2), ra(2), rho(2), roll(2), from(2), tip(2), part(2)
    integer :: n, i, k, shape

    list = examples()
    do n = 2, 4
      do shape = 1, 2
        associate (pair => list(n), tangent => list(n)%distance*sin(working_angle(list(n), drive)))
          rb = base_radius(pair, drive)
          ra = tip_radius(pair)
          tip = sqrt(ra**2 - rb**2)/rb
          ! Some way from the pitch point's roll angle to the tip's.
          from = tan(working_angle(pair, drive)) + [0.3_dp, 0.55_dp]*(tip - tan(working_angle(pair, drive)))
          call ask(t, '&case tasks=''mesh'' / '//text_of(pair)//driven//'&relief amount_um='//str(amount, 17)// &
                   ' pinion_fraction='//str(share(1))//' gear_fraction='//str(share(2))//' pinion_roll_deg='// &
                   str(from(1)/degree, 17)//' gear_roll_deg='//str(from(2)/degree, 17)//' shape='''// &
                   trim(shapes(shape))//''' /', answer)
          s = answer%all_of('mesh.s')
          found = answer%all_of('mesh.profile_error_um')
          call check_true(t, 'rows of the relief', size(s) > 100 .and. size(s) == size(found))
          do k = 1, size(s), 7
            rho(1) = first_curvature(pair) + s(k)*base_pitch(pair)
            rho(2) = tangent - rho(1)
            roll = rho/rb
            part = [(max(0.0_dp, (roll(i) - from(i))/(tip(i) - from(i))), i=1, 2)]
            call check_close(t, 'relief by roll angle, pair '//str(n)//', '//trim(shapes(shape)), found(k), &
                             sum(amount*share*part**shape), absolute=1e-9_dp)
          end do
          call check_close(t, 'whole relief at the pinion''s tip', maxval(found), amount, 1e-9_dp)
        end associate
      end do
    end do
  end subroutine relief_by_roll_angle

  !> A length of relief is counted along the path of contact from either end; the long relief begins at the pitch point.
  subroutine relief_by_length(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: amount = 10, length = 2.7_dp
    type(stated_t) :: list(5)
    type(answer_t) :: answer
    real(dp), allocatable :: s(:), found(:)
    real(dp) :: path, x, pitch, rb(2)
    integer :: k

    list = examples()
    associate (pair => list(3))
      path = contact_ratio(pair)*base_pitch(pair)
      call ask(t, '&case tasks=''mesh'' / '//text_of(pair)//driven//'&relief amount_um='//str(amount)//' length_mm='// &
               str(length)//' /', answer)
      s = answer%all_of('mesh.s')
      found = answer%all_of('mesh.profile_error_um')
      do k = 1, size(s), 5
        x = s(k)*base_pitch(pair)
        call check_close(t, 'relief by length', found(k), amount*(max(0.0_dp, 1 - x/length) &
                         + max(0.0_dp, 1 - (path - x)/length)), absolute=1e-9_dp)
      end do
      call ask(t, '&case tasks=''mesh'' / '//text_of(pair)//driven//'&relief amount_um='//str(amount)//' start=''pitch'' /', answer)
      s = answer%all_of('mesh.s')
      found = answer%all_of('mesh.profile_error_um')
      rb = base_radius(pair, drive)
      pitch = rb(1)*tan(working_angle(pair, drive)) - first_curvature(pair)
      do k = 1, size(s), 5
        x = s(k)*base_pitch(pair)
        call check_close(t, 'relief from the pitch point', found(k), amount*max(1 - x/pitch, (x - pitch)/(path - pitch)), &
                         absolute=1e-9_dp)
      end do
    end associate
  end subroutine relief_by_length

  !> Load on the line of action: T/r_b1, a force, or a line load times the width. Effective mass J/r_b**2; that of
  !> a disc of the reference radius with its bore has J = pi/2 rho b (r**4 - r_bore**4). Natural frequency of both
  !> masses on the mean stiffness.
  subroutine masses_and_loads(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: inertia(2) = [3.1e-3_dp, 1.7e-2_dp], bore(2) = [18, 30], density = 7200, width = 0.020_dp
    character(*), parameter :: task = '&case tasks=''mesh'' / ', by_standard = '&mesh model=''iso6336'' corner_contact=.false. / '
    type(stated_t) :: list(5)
    type(answer_t) :: answer
    real(dp) :: rb(2), r(2)
    integer :: n, i

    list = examples()
    do n = 2, 4
      associate (pair => list(n))
        rb = 1e-3_dp*base_radius(pair, drive)
        r = 1e-3_dp*pair%module*pair%teeth/2
        call ask(t, task//text_of(pair, ' inertia_kgm2='//str(inertia(1), 17), ' inertia_kgm2='//str(inertia(2), 17))// &
                 by_standard//'&load torque_nm=170 /', answer)
        call check_masses('inertia over base radius squared', inertia/rb**2)
        call check_close(t, 'torque over base radius', answer%one('motion.load_n'), 170/rb(1))
        call check_close(t, 'natural frequency', answer%one('motion.natural_frequency_hz'), &
                         sqrt(1e6_dp*answer%one('motion.mean_mesh_stiffness_n_um')*sum(rb**2/inertia))/(2*pi))
        call ask(t, task//text_of(pair, ' bore_mm='//str(bore(1)), ' bore_mm='//str(bore(2)))//by_standard// &
                 '&load line_load_n_mm=210 / &material density_kgm3='//str(density)//' /', answer)
        call check_masses('solid discs', pi/2*density*width*(r**4 - (bore/2000)**4)/rb**2)
        call ask(t, task//text_of(pair)//by_standard//'&load line_load_n_mm=210 /', answer)
        call check_masses('solid discs of steel, 7850 kg/m3', pi/2*7850*width*r**4/rb**2)
        call check_close(t, 'line load times width', answer%one('motion.load_n'), 4200.0_dp)
        call ask(t, task//text_of(pair, ' effective_mass_kg=0.7', ' inertia_kgm2='//str(inertia(2), 17))//by_standard// &
                 '&load normal_force_n=3100 /', answer)
        call check_masses('one stated, one by inertia', [0.7_dp, inertia(2)/rb(2)**2])
        call check_close(t, 'normal force', answer%one('motion.load_n'), 3100.0_dp)
      end associate
    end do
    ! A prescribed mesh has its base pitch for that: r_b = p_b z/(2 pi).
    rb = 8.5e-3_dp*[23, 51]/(2*pi)
    call ask(t, task//'&pinion teeth=23 inertia_kgm2=2e-3 / &gear teeth=51 inertia_kgm2=3e-2 / &load torque_nm=90 / '// &
             '&mesh model=''polynomial'' contact_ratio=1.6 coefficients=400,0,-120 base_pitch_mm=8.5 /', answer)
    call check_masses('inertias of a prescribed mesh', [2e-3_dp, 3e-2_dp]/rb**2)
    call check_close(t, 'torque of a prescribed mesh', answer%one('motion.load_n'), 90/rb(1))

  contains

    subroutine check_masses(name, expected)
      character(*), intent(in) :: name
      real(dp), intent(in) :: expected(2)
      real(dp), allocatable :: mass(:)

      mass = [answer%all_of('motion.pinion_mass_kg'), answer%all_of('motion.gear_mass_kg')]
      call check_equal(t, name//': how many', size(mass), 2)
      do i = 1, size(mass)
        call check_close(t, name//', gear '//str(i), mass(i), expected(i), relative=1e-12_dp)
      end do
    end subroutine check_masses
  end subroutine masses_and_loads

  !> With friction a tooth force F makes the acceleration F (f1/m1 + f2/m2). Moments about the gears' centres, per base
  !> radius: before the pitch point the gear's flank is the faster one, so friction helps the pinion on and holds the
  !> gear back, f = 1 - mu rho/r_b for both; behind it f = 1 + mu rho/r_b. rho from the tip circles, on shifted gears too.
  subroutine friction_factors(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: mu = 0.08_dp, mass(2) = [0.7_dp, 1.9_dp]
    type(stated_t) :: list(5)
    type(answer_t) :: answer
    real(dp) :: rb(2), rho(2), s, pitch
    integer :: n, k, sense

    list = examples()
    do n = 1, size(list)
      associate (pair => list(n))
        call ask(t, '&case tasks=''sweep'' / '//text_of(pair, ' effective_mass_kg=0.7', ' effective_mass_kg=1.9')//driven// &
                 '&dynamics friction='//str(mu)//' / &sweep rpm_first=3000 rpm_last=3000 rpm_step=100 /', answer)
        rb = base_radius(pair, drive)
        pitch = (rb(1)*tan(working_angle(pair, drive)) - first_curvature(pair))/base_pitch(pair)
        do k = 0, 12
          s = contact_ratio(pair)*k/12
          rho(1) = first_curvature(pair) + s*base_pitch(pair)
          rho(2) = pair%distance*sin(working_angle(pair, drive)) - rho(1)
          sense = merge(1, -1, s > pitch)
          call check_close(t, 'friction factors, pair '//str(n), mobility(answer%study%motion(1), s, s > pitch), &
                           sum((1 + sense*mu*rho/rb)/mass), relative=1e-10_dp)
        end do
        call check_close(t, 'break at the pitch point', &
                         minval(abs(answer%study%motion(1)%intervals%first - modulo(pitch, 1.0_dp))), &
                         0.0_dp, absolute=1e-9_dp)
      end associate
    end do
  end subroutine friction_factors
end module test_relief_closed_forms
