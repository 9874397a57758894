!> Inertia at the bores of whole gears: against finite elements of the whole gear with its hub, and closed forms.
module test_hub
  use gearsweep_elastic_hub, only: chain_frequencies
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_base_text, only: str
  use test_support_ask_by_name, only: answer_t, ask
  use test_support_reference_rows, only: next_row
  use test_support_testing, only: tally_t, check_true, check_close
  implicit none
  private
  public :: run

  real(dp), parameter :: width = 0.0254_dp, base_radius = 25*3.18e-3_dp/2*cos(pi/9)

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('chain')) call chain(t)
    if (t%wants('whole_gears')) call whole_gears(t)
    if (t%wants('felt_turning')) call felt_turning(t)
    if (t%wants('rigid_gears')) call rigid_gears(t)
    if (t%wants('webs')) call webs(t)
  end subroutine run

  !> Two gears of 80 teeth with a rim of 5 mm, a web of 4 mm and a bore of 40 mm. Their moment of inertia is that of the bricks
  !> of the task body_modes and within 5 % that of rings, the rim up to the reference circle: less than half of a solid disc's. The
  !> stiffness is that of sections of the rim alone, as one would state them by hand. And a web that is 1 mm thicker adds that ring.
  subroutine webs(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: teeth = ' teeth = 80 bore_mm = 40', web = ' web_thickness_mm = 4 rim_thickness_mm = 5'
    character(*), parameter :: case = '&case tasks = ''mesh'' / &pair module_mm = 2 face_width_mm = 20 / &load torque_nm = 200 / '
    real(dp), parameter :: base = 0.08_dp*cos(pi/9), inside = 0.08_dp - 0.0025_dp - 0.005_dp, bore = 0.02_dp
    type(answer_t) :: described, by_hand, solid, held, thicker, body
    character(:), allocatable :: inertia

    call ask(t, case//'&pinion'//teeth//web//' / &gear'//teeth//web//' /', described)
    call ask(t, case//'&pinion'//teeth//' / &gear'//teeth//' / &section fixed = ''sides'', ''rim'' /', solid)
    call ask(t, '&case tasks = ''body_modes'' / &pair module_mm = 2 face_width_mm = 20 / &pinion'//teeth//web//' / &gear'//teeth// &
             ' / &body_modes modes = 1 nodal_diameters = 0 elements_across = 3 /', body)
    call check_close(t, 'mass of rim and web', described%one('motion.pinion_mass_kg'), 7850*pi/2*(0.02_dp*(0.08_dp**4 - bore**4) &
                     - 0.016_dp*(inside**4 - bore**4))/base**2, 0.05_dp)
    call check_close(t, 'moment of inertia of the bricks', described%one('motion.gear_mass_kg')*base**2, &
                     body%one('gear_body.polar_inertia_kgm2'), 1e-3_dp)
    call check_close(t, 'solid disc', solid%one('motion.pinion_mass_kg'), &
                     pi/2*7850*0.02_dp*(0.08_dp**4 - bore**4)/base**2, 1e-12_dp)
    inertia = ' inertia_kgm2 = '//str(described%one('motion.gear_mass_kg')*base**2, 15)
    call ask(t, case//'&pinion'//teeth//inertia//' / &gear'//teeth//inertia//' / &section teeth = 5 fixed = ''sides'' &
             &rim_mm = 5 /', by_hand)
    call check_close(t, 'stiffness as stated by hand', described%one('motion.mean_mesh_stiffness_n_um'), &
                     by_hand%one('motion.mean_mesh_stiffness_n_um'), 1e-9_dp)
    call check_close(t, 'resonance as stated by hand', described%one('motion.resonance_rpm'), &
                     by_hand%one('motion.resonance_rpm'), 1e-9_dp)
    call check_true(t, 'a rim is softer than a solid body', described%one('motion.mean_mesh_stiffness_n_um') &
                    < 0.8_dp*solid%one('motion.mean_mesh_stiffness_n_um'), str(described%one('motion.mean_mesh_stiffness_n_um')))
    call ask(t, case//'&pinion'//teeth//web//' / &gear'//teeth//web//' / &section fixed = ''sides'', ''rim'' /', held)
    call check_close(t, 'what is held may be said', held%one('motion.mean_mesh_stiffness_n_um'), &
                     solid%one('motion.mean_mesh_stiffness_n_um'), 1e-12_dp)
    call ask(t, case//'&pinion'//teeth//' web_thickness_mm = 5 rim_thickness_mm = 5 / &gear'//teeth//web//' /', thicker)
    call check_close(t, 'a ring of the web', thicker%one('motion.pinion_mass_kg') - described%one('motion.pinion_mass_kg'), &
                     7850*0.001_dp*pi/2*(inside**4 - bore**4)/base**2, 1e-9_dp)
  end subroutine webs

  !> A chain of two equal halves vibrates with its middle at rest or with the mesh unstrained: two masses on a spring of half the
  !> mesh's length, and the free pair of body and hub. With one hub, two springs: a quadratic equation. Without, one.
  subroutine chain(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: body = 0.7_dp, hub = 1.9_dp, mesh = 2e-9_dp, twist = 3e-9_dp
    real(dp) :: b, c, omega(2)

    omega = chain_frequencies([body, body], [hub, hub], mesh, [twist, twist])
    b = 2/mesh/body + (1/body + 1/hub)/twist
    c = 2/mesh/body/twist/hub
    call check_close(t, 'halves against each other', omega(1), sqrt(2*c/(b + sqrt(b**2 - 4*c))), 1e-12_dp)
    call check_close(t, 'bodies against their hubs', omega(2), sqrt((1/body + 1/hub)/twist), 1e-12_dp)
    b = 2/mesh/body + (1/body + 1/hub)/twist
    c = (2/body**2 + 2/body/hub - 1/body**2)/mesh/twist
    omega = chain_frequencies([body, body], [0.0_dp, hub], mesh, [twist, twist])
    call check_close(t, 'one hub', omega(1), sqrt(2*c/(b + sqrt(b**2 - 4*c))), 1e-12_dp)
    call check_close(t, 'one hub, next', omega(2), sqrt((b + sqrt(b**2 - 4*c))/2), 1e-12_dp)
    omega = chain_frequencies([body, 2*body], [hub, 0.0_dp], mesh, [0.0_dp, twist])
    call check_close(t, 'rigid hubs', omega(1), sqrt((1/(body + hub) + 1/(2*body))/mesh), 1e-12_dp)
    call check_close(t, 'and no other', omega(2), 0.0_dp)
    omega = chain_frequencies([body, body], [1e-9_dp, 1e12_dp], mesh, [twist, twist])
    call check_close(t, 'next to no hub, and a fixed one', omega(1), sqrt(fixed_one()), 1e-8_dp)

  contains

    !> Lowest eigenvalue of two bodies with the mesh between them, the second one held by its twist.
    real(dp) function fixed_one()
      associate (sum_of => 2/mesh/body + 1/twist/body, product_of => 1/(mesh*twist*body**2))
        fixed_one = 2*product_of/(sum_of + sqrt(sum_of**2 - 4*product_of))
      end associate
    end function fixed_one
  end subroutine chain

  !> Against whole gears of finite elements with rigid hubs, written apart from the library (hub.dat): how much lower the natural
  !> frequency lies than with all inertia in one body, by the chain within 0.8 %, and by the one degree of freedom that the
  !> motion has as far as doc/dynamics.md says; the turning itself.
  subroutine whole_gears(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: within(3) = [5e-3_dp, 12e-3_dp, 8e-2_dp], bores(3) = [20, 10, 5]
    type(answer_t) :: plain, answer
    character(1000) :: line
    real(dp) :: row(7), last
    integer :: unit, rows

    open (newunit=unit, file='test/reference/hub.dat', status='old', action='read')
    rows = 0
    last = 0
    do while (next_row(unit, line))
      read (line, *) row
      rows = rows + 1
      if (abs(row(1) - last) > 0) call ask(t, text_of(row, ''), plain)
      last = row(1)
      call check_close(t, 'turning, bore '//str(row(1)), plain%one('motion.body_rotation_um')/plain%one('motion.load_n') &
                       *width*1e3_dp, 2*row(7), 5e-3_dp)
      if (.not. row(4) > 0) cycle
      call ask(t, text_of(row, ' hub_inertia_kgm2='//str(row(4)*row(3)*1e3_dp*width*base_radius**2)), answer)
      associate (rigid => plain%one('motion.natural_frequency_hz')/sqrt(1 + row(4)), &
                 name => 'bore '//str(row(1))//', hub '//str(row(4)))
        call check_close(t, 'chain, '//name, answer%one('motion.chain_frequency_hz')/rigid, row(5)/row(6), 8e-3_dp)
        call check_close(t, 'one degree of freedom, '//name, answer%one('motion.natural_frequency_hz')/rigid, row(5)/row(6), &
                         within(findloc(bores >= row(1) - 1e-9_dp, .true., 1, back=.true.)))
        call check_true(t, 'the next frequency is far, '//name, &
                        answer%one('motion.next_chain_frequency_hz') > 1.5_dp*answer%one('motion.chain_frequency_hz'))
      end associate
    end do
    close (unit)
    call check_true(t, 'rows of hub.dat', rows == 12, str(rows))
  end subroutine whole_gears

  !> Dogan's gear, whole, with a bore, and the mass of a row of the table.
  function text_of(row, hub) result(text)
    real(dp), intent(in) :: row(:)
    character(*), intent(in) :: hub
    character(:), allocatable :: text

    text = '&case tasks=''mesh'' / &pair module_mm=3.18 face_width_mm=25.4 / &load line_load_n_mm=276 / '// &
           '&mesh model=''fe'' corner_contact=.false. / &section teeth=0 fixed=''rim'' elements_across=6 / '// &
           '&pinion '//gear()//'/ &gear '//gear()//'/'

  contains

    function gear()
      character(:), allocatable :: gear

      gear = 'teeth=25 bore_mm='//str(2*row(1))//' effective_mass_kg='//str(row(3)*1e3_dp*width)//hub
    end function gear
  end function text_of

  !> Identities: inertia at a bore moves mu**2 of that gear's turning into the compliance of each pair, and the static
  !> transmission error not at all.
  subroutine felt_turning(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: body = '&case tasks=''mesh'' / &pair module_mm=3 face_width_mm=20 / &load line_load_n_mm=200 / '// &
      '&mesh model=''fe'' corner_contact=.false. / &section teeth=0 fixed=''rim'' elements_across=4 / &relief amount_um=0, 12 / '
    type(answer_t) :: plain, answer
    real(dp), allocatable :: before(:), after(:), s(:)
    real(dp) :: share
    integer :: i

    call ask(t, body//'&pinion teeth=21 bore_mm=14 effective_mass_kg=0.5 / &gear teeth=30 bore_mm=60 effective_mass_kg=0.4 /', &
             plain)
    call ask(t, body//'&pinion teeth=21 bore_mm=14 effective_mass_kg=0.5 hub_inertia_kgm2=5e-4 / '// &
             '&gear teeth=30 bore_mm=60 effective_mass_kg=0.4 /', answer)
    associate (hub => 5e-4_dp/(21*1.5e-3_dp*cos(pi/9))**2)
      share = hub/(0.5_dp + hub)
      call check_close(t, 'mass with its hub', answer%one('motion.pinion_mass_kg'), 0.5_dp + hub, 1e-12_dp)
    end associate
    before = plain%all_of('mesh.pair_stiffness_n_um')
    after = answer%all_of('mesh.pair_stiffness_n_um')
    s = plain%all_of('mesh.s')
    call check_true(t, 'the same rows', size(before) == size(after) .and. size(s) > 100)
    associate (felt => answer%one('motion.felt_rotation_um')/answer%one('motion.load_n'), &
               turned => (plain%one('motion.body_rotation_um'))/answer%one('motion.load_n'))
      ! The gear's wide bore turns little, but it does.
      call check_true(t, 'a share of the pinion''s turning', felt < share**2*turned .and. felt > 0.9_dp*share**2*turned, &
                      str(felt/turned))
      do i = 1, size(s), 7
        if (s(i) < 0 .or. s(i) > plain%one('geometry.contact_ratio')) cycle
        call check_close(t, 'it is in each pair', 1/after(i) - 1/before(i), felt, 1e-4_dp)
      end do
    end associate
    call check_close(t, 'all the turning', answer%one('motion.body_rotation_um'), plain%one('motion.body_rotation_um'), 1e-12_dp)
    call check_close(t, 'what neighbours share', answer%one('motion.body_coupling_um'), plain%one('motion.body_coupling_um'), &
                     1e-12_dp)
    call same('transmission_error.mean_um')
    call same('transmission_error.peak_to_peak_um')
    call same('mesh.ste_um')
    call same('mesh.load_share')
    ! With relief, rounding decides on which side of a pair's last place with load a row lies, and the stiffness jumps there.
    call same('mesh.mesh_stiffness_n_um', plain%all_of('mesh.relief_um') == 0)

  contains

    subroutine same(name, where)
      character(*), intent(in) :: name
      logical, intent(in), optional :: where(:)

      before = plain%all_of(name)
      after = answer%all_of(name)
      if (present(where)) then
        before = pack(before, where)
        after = pack(after, where)
      end if
      call check_close(t, 'unmoved: '//name, maxval(abs(after - before))/maxval(abs(before)), 0.0_dp, absolute=1e-5_dp)
    end subroutine same
  end subroutine felt_turning

  !> Where the body is no whole gear, or no finite elements are, the hub is one with the teeth: the same as its inertia
  !> in the gear's own.
  subroutine rigid_gears(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: models(2) = [character(48) :: '''weber'' /', '''fe'' / &section teeth=3 elements_across=4 /']
    type(answer_t) :: apart, together
    integer :: i

    do i = 1, size(models)
      call ask(t, text(trim(models(i)), 'inertia_kgm2=3e-4 hub_inertia_kgm2=2e-4'), apart)
      call ask(t, text(trim(models(i)), 'inertia_kgm2=5e-4'), together)
      call check_close(t, 'one body', apart%one('motion.natural_frequency_hz'), together%one('motion.natural_frequency_hz'), &
                       1e-12_dp)
      call check_true(t, 'nothing is felt', size(apart%all_of('motion.felt_rotation_um')) == 0)
    end do

  contains

    pure function text(model, inertia)
      character(*), intent(in) :: model, inertia
      character(:), allocatable :: text

      text = '&case tasks=''mesh'' / &pair module_mm=3 face_width_mm=20 / &load line_load_n_mm=200 / &pinion teeth=21 '// &
             inertia//' / &gear teeth=30 / &mesh model='//model
    end function text
  end subroutine rigid_gears
end module test_hub
