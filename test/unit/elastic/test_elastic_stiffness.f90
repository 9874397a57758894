!> Tooth compliance and pair stiffness: convergence with the grid, the depth
!> that must not matter, supports, equal and unequal gears.
module test_elastic_stiffness
  use test_support_gears, only: dogan_pair
  use gearsweep_elastic_disc, only: disc_t
  use gearsweep_base_error, only: error_t
  use gearsweep_elastic_fe_stiffness, only: fe_deflection, fe_options_t, fe_stiffness
  use gearsweep_elastic_flattening, only: contact_half_width, surface_to_depth
  use gearsweep_gear_gear, only: gear_spec_t, gear_t, make_gear
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_elastic_material, only: material_t
  use gearsweep_gear_pair, only: make_pair, pair_t
  use gearsweep_base_piecewise, only: piecewise_t
  use gearsweep_base_text, only: str
  use gearsweep_elastic_compliance, only: tooth_compliance, tooth_t
  use test_support_ask_by_name, only: answer_t, ask
  use test_support_testing, only: tally_t, check_true, check_close, check_error, check_no_error
  implicit none
  private
  public :: run

  real(dp), parameter :: load = 280e3_dp

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('flattening')) call flattening(t)
    if (t%wants('convergence')) call convergence(t)
    if (t%wants('undercut')) call undercut(t)
    if (t%wants('depth')) call depth(t)
    if (t%wants('supports')) call supports(t)
    if (t%wants('exchange')) call exchange(t)
    if (t%wants('two_materials')) call two_materials(t)
    if (t%wants('each_tooth')) call each_tooth(t)
    if (t%wants('grid_estimates')) call grid_estimates(t)
    if (t%wants('refusals')) call refusals(t)
  end subroutine run

  !> Reported errors of the grid against grids three to six times as fine, of usual gears, of few teeth with much profile shift, of
  !> many, of equal ones and of whole ones: above the error, and not without measure.
  subroutine grid_estimates(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: gears(5) = [character(200) :: &
      '&pair module_mm = 3, face_width_mm = 20 / &pinion teeth = 17, profile_shift = 0.2 / &gear teeth = 43 / &section teeth = 3', &
      '&pair module_mm = 4.5, face_width_mm = 14 / &pinion teeth = 16, profile_shift = 0.8 / &gear teeth = 24, '// &
      'profile_shift = -0.5 / &section teeth = 3', &
      '&pair module_mm = 2, face_width_mm = 30, pressure_angle_deg = 25 / &pinion teeth = 60 / &gear teeth = 80 / '// &
      '&section teeth = 5', &
      '&pair module_mm = 3, face_width_mm = 20 / &pinion teeth = 25 / &gear teeth = 25 / &section teeth = 3, rim_mm = 4', &
      '&pair module_mm = 3, face_width_mm = 20 / &pinion teeth = 20 / &gear teeth = 30 / &section teeth = 0']
    integer, parameter :: across(3) = [48, 16, 8]
    type(answer_t) :: answer, finest
    real(dp), allocatable :: off(:), told(:)
    integer :: i, k

    do i = 1, size(gears)
      do k = 1, size(across)
        call ask(t, '&case tasks = ''mesh'' / &load torque_nm = 200 / &relief amount_um = 0, 12 / '// &
                 '&mesh model = ''fe'', corner_contact = .false. / '//trim(gears(i))//', elements_across = '// &
                 str(across(k))//' / ', answer)
        if (k == 1) then
          finest = answer
          cycle
        end if
        associate (rows => count(.not. answer%all_of('mesh.relief_um') > 0), where => trim(gears(i))//', '//str(across(k)))
          off = abs(answer%all_of('mesh.pair_stiffness_n_um') - finest%all_of('mesh.pair_stiffness_n_um'))
          told = answer%all_of('mesh.pair_stiffness_estimate_n_um')
          call check_true(t, 'pair stiffness: '//where, all(off(:rows) <= told(:rows)), str(maxval(off(:rows)/told(:rows))))
          call check_true(t, 'not far above: '//where, maxval(told(:rows)) < 8*maxval(off(:rows)), &
                          str(maxval(told(:rows))/maxval(off(:rows))))
          call check_below('mean_um', 'mean_grid_estimate_um', where)
          call check_below('peak_to_peak_um', 'grid_estimate_um', where)
          call check_below('rms_um', 'grid_estimate_um', where)
        end associate
      end do
    end do

  contains

    subroutine check_below(column, estimate, where)
      character(*), intent(in) :: column, estimate, where

      off = abs(answer%all_of('transmission_error.'//column) - finest%all_of('transmission_error.'//column))
      told = answer%all_of('transmission_error.'//estimate)
      call check_true(t, column//': '//where, all(off <= told), str(off(1))//' told '//str(told(1)))
      ! A part of the stiffness changes the transmission error by at most that part, from its peak to its trough by twice that.
      associate (part => maxval(answer%all_of('mesh.pair_stiffness_estimate_n_um')/answer%all_of('mesh.pair_stiffness_n_um')))
        call check_true(t, column//' not far above: '//where, maxval(told) <= 2.5_dp*part*maxval(answer%all_of( &
                        'transmission_error.mean_um')), str(maxval(told)))
      end associate
    end subroutine check_below
  end subroutine grid_estimates

  !> Largest relative difference of two curves over the path.
  real(dp) function apart(a, b, last) result(most)
    type(piecewise_t), intent(in) :: a, b
    real(dp), intent(in) :: last
    integer :: i

    most = 0
    do i = 0, 200
      most = max(most, abs(a%value(last*i/200)/b%value(last*i/200) - 1))
    end do
  end function apart

  !> Johnson's numbers in two lines.
  subroutine flattening(t)
    type(tally_t), intent(inout) :: t
    type(material_t), parameter :: steel = material_t(), brass = material_t(young=100e9_dp, poisson=0.35_dp)
    real(dp) :: a

    a = contact_half_width(steel, steel, .true., 1e5_dp, 0.01_dp, 0.02_dp)
    call check_close(t, 'half width', a, sqrt(4*1e5_dp*(0.02_dp/3)/(pi*206e9_dp/2/0.91_dp)))
    call check_close(t, 'half width of two materials', contact_half_width(steel, brass, .true., 1e5_dp, 0.01_dp, 0.02_dp), &
                     sqrt(4*1e5_dp*(0.02_dp/3)/pi*(0.91_dp/206e9_dp + (1 - 0.35_dp**2)/100e9_dp)))
    call check_close(t, 'and in plane stress', contact_half_width(brass, steel, .false., 1e5_dp, 0.01_dp, 0.02_dp), &
                     sqrt(4*1e5_dp*(0.02_dp/3)/pi*(1/206e9_dp + 1/100e9_dp)))
    call check_close(t, 'approach', surface_to_depth(steel, .true., a, 50*a), &
                     0.91_dp/(pi*206e9_dp)*(2*log(100.0_dp) - 0.3_dp/0.7_dp))
    call check_close(t, 'approach, plane stress', surface_to_depth(steel, .false., a, 50*a), &
                     (2*log(100.0_dp) - 0.3_dp)/(pi*206e9_dp))
  end subroutine flattening

  !> The default grid against one three times as fine.
  subroutine convergence(t)
    type(tally_t), intent(inout) :: t
    type(pair_t) :: pair
    type(fe_options_t) :: options
    type(piecewise_t) :: rough, usual, fine
    type(disc_t) :: disc
    type(error_t), allocatable :: error

    pair = dogan_pair([25, 25])
    call fe_stiffness(pair, [material_t(), material_t()], options, load, usual, disc, error)
    call check_no_error(t, 'fe stiffness', error)
    options%section%elements_across = 7
    call fe_stiffness(pair, [material_t(), material_t()], options, load, rough, disc, error)
    options%section%elements_across = 40
    options%section%others_across = 10
    options%positions = 33
    call fe_stiffness(pair, [material_t(), material_t()], options, load, fine, disc, error)
    call check_close(t, 'pair stiffness, default grid', apart(usual, fine, pair%contact_ratio), 0.0_dp, absolute=1e-3_dp)
    call check_close(t, 'pair stiffness, rough grid', apart(rough, fine, pair%contact_ratio), 0.0_dp, absolute=1e-2_dp)
    call check_close(t, 'same at both ends', usual%value(0.0_dp), usual%value(pair%contact_ratio), relative=1e-12_dp)
    call check_close(t, 'single tooth at the pitch point near 34 N/(um mm)', &
                     2*usual%value(pair%contact_ratio/2)/0.0254_dp, 34e9_dp, relative=0.03_dp)
  end subroutine convergence

  !> Undercut teeth, whose fillets meet the involutes in an edge: FZG type A, where contact stays 0.4 mm above it, and ten
  !> teeth whose path of contact begins at it. Finer grids come nearer to a fine one, as with other teeth.
  subroutine undercut(t)
    type(tally_t), intent(inout) :: t
    type(gear_t) :: gear(2)
    type(pair_t) :: pair
    type(fe_options_t) :: options
    type(piecewise_t) :: curve(3)
    type(disc_t) :: disc
    type(error_t), allocatable :: error
    integer, parameter :: across(3) = [8, 16, 40]
    real(dp) :: off(2)
    integer :: k, i

    do k = 1, 2
      if (k == 1) then
        call make_gear(gear_spec_t('pinion', 16, 0.0045_dp, profile_shift=0.8532_dp, rack_tip_radius=0.38_dp, &
                                   face_width=0.02_dp), gear(1), error)
        call make_gear(gear_spec_t('gear', 24, 0.0045_dp, profile_shift=-0.5_dp, rack_tip_radius=0.38_dp, &
                                   face_width=0.02_dp), gear(2), error)
        call make_pair(gear(1), gear(2), 0.0915_dp, pair, error)
      else
        call make_gear(gear_spec_t('pinion', 10, 0.003_dp, face_width=0.02_dp), gear(1), error)
        call make_gear(gear_spec_t('gear', 40, 0.003_dp, face_width=0.02_dp), gear(2), error)
        call make_pair(gear(1), gear(2), 0.075_dp, pair, error, shorten=.true.)
      end if
      call check_no_error(t, 'undercut pair '//str(k), error)
      do i = 1, 3
        options%section%elements_across = across(i)
        options%section%others_across = max(4, across(i)/4)
        call fe_stiffness(pair, [material_t(), material_t()], options, load, curve(i), disc, error)
        call check_no_error(t, 'stiffness of undercut teeth', error)
      end do
      off = [apart(curve(1), curve(3), pair%contact_ratio), apart(curve(2), curve(3), pair%contact_ratio)]
      call check_true(t, 'undercut pair '//str(k)//' converges', off(2) < 0.5_dp*off(1), str(off(1))//' then '//str(off(2)))
      call check_close(t, 'undercut pair '//str(k)//', default grid', off(2), 0.0_dp, absolute=3e-3_dp)
    end do
  end subroutine undercut

  !> Where the grid ends and Hertz begins is ours to choose.
  subroutine depth(t)
    type(tally_t), intent(inout) :: t
    type(pair_t) :: pair
    type(fe_options_t) :: options
    type(piecewise_t) :: near, far
    type(disc_t) :: disc
    type(error_t), allocatable :: error

    pair = dogan_pair([25, 25])
    options%section%elements_across = 24
    options%depth = 0.25_dp
    call fe_stiffness(pair, [material_t(), material_t()], options, load, near, disc, error)
    options%depth = 0.4_dp
    call fe_stiffness(pair, [material_t(), material_t()], options, load, far, disc, error)
    call check_close(t, 'depth of the cut', apart(near, far, pair%contact_ratio), 0.0_dp, absolute=5e-3_dp)
  end subroutine depth

  !> More body is softer; the whole gear is what a very wide section tends to.
  subroutine supports(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: teeth(5) = [1, 2, 3, 7, 25]
    type(pair_t) :: pair
    type(fe_options_t) :: options
    type(piecewise_t) :: curve, wide
    type(disc_t) :: disc, slit
    type(error_t), allocatable :: error
    real(dp) :: last, now
    integer :: i

    pair = dogan_pair([25, 25])
    options%section%elements_across = 8
    ! All end at the same circle, the whole gear too.
    options%section%rim = 2.5_dp*(pair%gear(1)%tip_radius - pair%gear(1)%root_radius)
    last = huge(last)
    do i = 1, size(teeth)
      options%section%teeth = teeth(i)
      call fe_stiffness(pair, [material_t(), material_t()], options, load, curve, disc, error)
      call check_no_error(t, 'support with '//str(teeth(i))//' teeth', error)
      now = 1/(1/curve%value(pair%contact_ratio/2) + disc%turn)
      call check_true(t, 'wider is softer', now < last, str(now)//' after '//str(last))
      call check_true(t, 'only a whole gear turns', disc%turn > 0 .eqv. teeth(i) == 25)
      last = now
    end do
    options%section%half_angle = pi - 1e-9_dp
    call fe_stiffness(pair, [material_t(), material_t()], options, load, wide, slit, error)
    do i = 0, 8
      associate (s => pair%contact_ratio*i/8)
        call check_close(t, 'whole gear and slit gear', 1/curve%value(s) + disc%turn, 1/wide%value(s), relative=3e-3_dp)
      end associate
    end do
  end subroutine supports

  !> Exchanging unequal gears mirrors the curve; flanks of unequal angle work.
  subroutine exchange(t)
    type(tally_t), intent(inout) :: t
    type(pair_t) :: pair
    type(fe_options_t) :: options
    type(piecewise_t) :: one, other
    type(disc_t) :: disc
    type(error_t), allocatable :: error
    integer :: i

    options%section%elements_across = 8
    pair = dogan_pair([25, 40])
    call fe_stiffness(pair, [material_t(), material_t()], options, load, one, disc, error)
    call check_no_error(t, 'unequal gears', error)
    pair = dogan_pair([40, 25])
    call fe_stiffness(pair, [material_t(), material_t()], options, load, other, disc, error)
    do i = 0, 8
      call check_close(t, 'mirrored', one%value(pair%contact_ratio*i/8), other%value(pair%contact_ratio*(8 - i)/8), &
                       relative=1e-9_dp)
    end do
    pair = dogan_pair([25, 25], angles=[20.0_dp, 30.0_dp])
    call fe_stiffness(pair, [material_t(), material_t()], options, load, one, disc, error)
    pair = dogan_pair([25, 25], angles=[20.0_dp, 20.0_dp])
    call fe_stiffness(pair, [material_t(), material_t()], options, load, other, disc, error)
    call check_true(t, 'a steeper coast flank stiffens', one%integral(0.0_dp, 1.0_dp) > 1.02_dp*other%integral(0.0_dp, 1.0_dp))
  end subroutine exchange

  !> Equal gears of two materials that differ in E only: how far a tooth deflects goes with 1/E, so that the compliance of two of
  !> steel, less Hertz's part, gives that of steel on brass, and as the mate grows stiff, half of it is left. Hertz's part is a
  !> closed form in each material's own E on the half width of both.
  subroutine two_materials(t)
    type(tally_t), intent(inout) :: t
    type(material_t), parameter :: steel = material_t(), brass = material_t(young=100e9_dp)
    type(material_t), parameter :: diamond = material_t(young=206e15_dp)
    type(fe_options_t) :: options
    type(piecewise_t) :: alike, mixed, stiff
    type(disc_t) :: disc
    type(pair_t) :: pair
    type(error_t), allocatable :: error
    real(dp) :: middle, tooth
    integer :: i

    pair = dogan_pair([25, 25])
    middle = pair%contact_ratio/2
    options%section%elements_across = 6
    do i = 1, 2
      options%section%plane_strain = i == 1
      call fe_stiffness(pair, [steel, steel], options, load, alike, disc, error)
      call check_no_error(t, 'steel on steel', error)
      call fe_stiffness(pair, [steel, brass], options, load, mixed, disc, error)
      call fe_stiffness(pair, [diamond, steel], options, load, stiff, disc, error)
      call check_no_error(t, 'other materials', error)
      tooth = (0.0254_dp/alike%value(middle) - flat(steel, steel))/2
      call check_close(t, 'steel on brass', 0.0254_dp/mixed%value(middle), tooth*(1 + 2.06_dp) + flat(steel, brass), 1e-9_dp)
      call check_close(t, 'a stiff mate', 0.0254_dp/stiff%value(middle), tooth + flat(steel, diamond), 1e-5_dp)
    end do

  contains

    !> What both flanks flatten by in the middle of the path, down to a module (m2/N): Weber and Banaschek.
    real(dp) function flat(one, other)
      type(material_t), intent(in) :: one, other
      real(dp) :: a, e(2), nu

      e = [one%young, other%young]
      nu = one%poisson
      if (options%section%plane_strain) then
        e = e/(1 - nu**2)
        nu = nu/(1 - nu)
      end if
      associate (r => pair%curvature(1, middle))
        a = sqrt(4*load*(r/2)/pi*sum(1/e))
      end associate
      flat = sum((2*log(2*0.00318_dp/a) - nu)/(pi*e))
    end function flat
  end subroutine two_materials

  !> What both teeth of a pair deflect at one place adds up to what the pair does, which the stiffness has; at the pitch point of
  !> equal gears each has half of it; and a tooth of brass deflects as many times more as its modulus is less, but for Hertz's part.
  subroutine each_tooth(t)
    type(tally_t), intent(inout) :: t
    type(material_t), parameter :: steel = material_t(), brass = material_t(young=100e9_dp)
    type(fe_options_t) :: options
    type(piecewise_t) :: curve
    type(disc_t) :: disc
    type(pair_t) :: pair
    type(error_t), allocatable :: error
    real(dp) :: s, half_width(2), deflection(2), points(5)
    integer :: i

    options%section%elements_across = 6
    pair = dogan_pair([25, 40])
    call fe_stiffness(pair, [steel, brass], options, load, curve, disc, error)
    do i = 0, 3
      s = pair%contact_ratio*i/3
      half_width = contact_half_width(steel, brass, .true., load, pair%curvature(1, s), pair%curvature(2, s))
      call fe_deflection(pair, [steel, brass], options, load, half_width, [s, s], deflection, error)
      call check_no_error(t, 'each tooth', error)
      call check_close(t, 'both teeth are the pair', sum(deflection), &
                       load*minval(pair%gear%spec%face_width)/curve%value(s), 1e-9_dp)
    end do
    pair = dogan_pair([25, 25])
    points = pair%points()
    s = points(3)
    half_width = contact_half_width(steel, steel, .true., load, pair%curvature(1, s), pair%curvature(2, s))
    call fe_deflection(pair, [steel, steel], options, load, half_width, [s, s], deflection, error)
    call check_close(t, 'half of the pair each', deflection(1), deflection(2), 1e-9_dp)
    call fe_deflection(pair, [steel, brass], options, load, half_width, [s, s], deflection, error)
    call check_close(t, 'brass beside steel', deflection(2), 2.06_dp*deflection(1), 1e-9_dp)
  end subroutine each_tooth

  subroutine refusals(t)
    type(tally_t), intent(inout) :: t
    type(fe_options_t) :: options
    type(piecewise_t) :: curve
    type(disc_t) :: disc
    type(tooth_t) :: tooth
    type(error_t), allocatable :: error
    type(pair_t) :: pair

    pair = dogan_pair([25, 25])
    call fe_stiffness(pair, [material_t(), material_t()], options, 0.0_dp, curve, disc, error)
    call check_error(t, 'no load', error, 'line load (N/mm) = 0')
    call fe_stiffness(pair, [material_t(), material_t(poisson=0.5_dp)], options, load, curve, disc, error)
    call check_error(t, 'incompressible', error, 'Poisson''s ratio')
    call tooth_compliance(pair%gear(1), material_t(), options, 0.001_dp, 0.03_dp, tooth, error)
    call check_error(t, 'load off the path', error, 'off the flank')
    options%section%fixed_sides = .false.
    options%section%fixed_rim = .false.
    call fe_stiffness(pair, [material_t(), material_t()], options, load, curve, disc, error)
    call check_error(t, 'nothing fixed', error, 'support of the section')
  end subroutine refusals
end module test_elastic_stiffness
