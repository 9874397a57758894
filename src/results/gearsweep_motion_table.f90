!> What all tasks that need the mesh start from, as a table and for the screen: load, masses and stiffness.
module gearsweep_motion_table
  use gearsweep_blank, only: has_web
  use gearsweep_error, only: error_t
  use gearsweep_gear, only: drive
  use gearsweep_hub, only: chain_frequencies, felt_twist
  use gearsweep_kinds, only: dp, pi
  use gearsweep_lines, only: left, lines_t
  use gearsweep_material, only: material_t
  use gearsweep_piecewise, only: piecewise_t
  use gearsweep_stiffness, only: gear_blank_factor
  use gearsweep_first_stages, only: name_load, pressure_at_pitch, rim_teeth, rims
  use gearsweep_study, only: study_t
  use gearsweep_table, only: no_number, table_t
  use gearsweep_task, only: stage
  use gearsweep_text, only: str
  use gearsweep_weber, only: weber_stiffness
  implicit none
  private
  public :: motion_table, add_motion

  !> What stands beside a stiffness by ISO 6336-1.
  type :: iso_beside_t
    real(dp) :: line_load = 0                    !< F_t K_A/b, N/m
    real(dp) :: blank_factor = 1                 !< C_R
    real(dp) :: weber_stiffness = 0              !< mean of the mesh by Weber and Banaschek, N/m
  end type iso_beside_t

  real(dp), parameter :: micro = 1e6_dp, milli = 1e3_dp
  character(*), parameter :: of_web = 'rim and web'

contains

  !> What ISO 6336-1 takes beside the teeth, and what another model gives.
  pure function find_iso_beside(study) result(beside)
    type(study_t), intent(in) :: study
    type(iso_beside_t) :: beside
    type(piecewise_t) :: curve
    type(material_t) :: steel(2)
    type(error_t), allocatable :: error

    beside%weber_stiffness = no_number()
    associate (spec => study%pair%gear%spec, iso => study%case%iso)
      beside%line_load = iso%application_factor*study%load/spec(1)%face_width*cos(spec(1)%pressure_angle(drive))
      beside%blank_factor = minval(gear_blank_factor(iso%web_thickness, iso%rim_thickness, spec%face_width, spec%module))
      ! The standard does not know Poisson's ratio: that of steel, then.
      steel%young = study%case%material%young
      call weber_stiffness(study%pair, steel, study%load/spec(1)%face_width, curve, error)
    end associate
    if (.not. allocated(error)) beside%weber_stiffness = curve%integral(0.0_dp, study%pair%contact_ratio)
  end function find_iso_beside

  !> What drives the motion.
  pure subroutine motion_table(study, table, error)
    type(study_t), intent(in) :: study
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    type(iso_beside_t) :: beside
    real(dp) :: frequency, mean, width, felt

    if (.not. allocated(study%motion)) return
    call table%begin('load, masses and stiffness of the mesh, and its natural frequency', 1, error)
    if (allocated(error)) return
    associate (mesh => study%motion(1)%mesh, case => study%case)
      frequency = study%motion(1)%natural_frequency/(2*pi)
      mean = mesh%mean_stiffness()
      width = case%spec(1)%face_width
      call table%add('load_n', 'N', 'static load on the line of action', [study%load])
      call table%add('pinion_mass_kg', 'kg', 'effective mass of the pinion on the line of action, with what sits at its '// &
                     'bore', study%mass(1:1))
      call table%add('gear_mass_kg', 'kg', 'effective mass of the gear on the line of action, with what sits at its bore', &
                     study%mass(2:2))
      call table%add('least_pair_stiffness_n_um', 'N/um', 'least stiffness of a pair on its path, whole face width', &
                     [mesh%stiffness%minimum()/micro])
      call table%add('largest_pair_stiffness_n_um', 'N/um', 'largest stiffness of a pair on its path, whole face width', &
                     [mesh%stiffness%maximum()/micro])
      call table%add('mean_mesh_stiffness_n_um', 'N/um', 'mean over a mesh period of all pairs in contact', [mean/micro])
      if (width > 0) call table%add('mean_mesh_stiffness_n_um_mm', 'N/um/mm', 'the same per mm of face width', &
                                    [mean/width*1e-9_dp])
      if (case%model == 'iso6336') then
        beside = find_iso_beside(study)
        call table%add('iso_line_load_n_mm', 'N/mm', 'F_t K_A/b, below 100 N/mm of which ISO 6336-1 lowers the stiffness', &
                       [beside%line_load/milli])
        call table%add('iso_blank_factor', '', 'C_R, the smaller one of both gears', [beside%blank_factor])
        call table%add('weber_mesh_stiffness_n_um', 'N/um', 'mean mesh stiffness by the model weber, to compare', &
                       [beside%weber_stiffness/micro])
      end if
      call table%add('natural_frequency_hz', 'Hz', 'of the mean mesh stiffness and the effective masses', [frequency])
      call table%add('resonance_rpm', '1/min', 'speed of the pinion at which the mesh excites it', &
                     [60*frequency/mesh%teeth(1)])
      felt = sum(felt_twist(study%hub_mass/study%mass, mesh%disc%twist))
      call table%add('body_rotation_um', 'um', 'turn of whole gears about their bores under the load, on the line of '// &
                     'action: not in the motion but for felt_rotation_um', [micro*study%load*(mesh%disc%turn + felt)])
      call table%add('body_coupling_um', 'um', 'what neighbouring teeth share beyond that: in the stiffness of each pair', &
                     [micro*study%load*(mesh%disc%shared - felt)])
      if (felt > 0) call add_hubs(study, felt, mean, table)
      if (case%needs(stage%losses)) call table%add('damping_ratio', '', 'as in the case', [case%damping_ratio])
      if (case%needs(stage%motion)) call table%add('friction', '', 'friction coefficient, as in the case', [case%friction])
    end associate
  end subroutine motion_table

  !> What inertia at the hubs makes of the turning, and how the chain of all four inertias vibrates. `felt` (m/N) of the
  !> turning is in the `mean` stiffness (N/m) of the mesh.
  pure subroutine add_hubs(study, felt, mean, table)
    type(study_t), intent(in) :: study
    real(dp), intent(in) :: felt, mean
    type(table_t), intent(inout) :: table
    real(dp) :: frequencies(2)

    frequencies = chain_frequencies(study%mass - study%hub_mass, study%hub_mass, 1/mean - felt, study%mesh%disc%twist)/(2*pi)
    call table%add('felt_rotation_um', 'um', 'what of the bodies'' turn the inertia at the hubs makes the motion feel: in the '// &
                   'stiffness of each pair', [micro*study%load*felt])
    call table%add('chain_frequency_hz', 'Hz', 'lowest natural frequency of the chain hub, body, mean mesh stiffness, body, hub', &
                   frequencies(1:1))
    call table%add('next_chain_frequency_hz', 'Hz', 'its next one, at which a body turns against its hub: not in the motion', &
                   frequencies(2:2))
  end subroutine add_hubs

  pure subroutine add_motion(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    type(table_t) :: table
    type(error_t), allocatable :: error

    table%name = 'motion'
    call motion_table(study, table, error)
    if (.not. table%is_there()) return
    call lines%put(left('Stiffness', 19)//study%case%model//': pair '//str(table%number('least_pair_stiffness_n_um'), 4)// &
                   ' to '//str(table%number('largest_pair_stiffness_n_um'), 4)//', mesh mean '// &
                   str(table%number('mean_mesh_stiffness_n_um'), 4)//' N/um')
    if (table%position('mean_mesh_stiffness_n_um_mm') > 0) &
      call lines%put(' ('//str(table%number('mean_mesh_stiffness_n_um_mm'), 4)//' N/um per mm of width)')
    call lines%add('')
    if (table%position('iso_blank_factor') > 0) call add_iso(study, table, lines)
    if (table%number('body_rotation_um') > 0) then
      call lines%add(left('Discs', 19)//'turn by '//str(table%number('body_rotation_um'), 4)//' um on the line of action '// &
                     'about their bores: in the static transmission error,')
      call lines%add(left('', 19)//'not in the pairs'' stiffness nor in the motion; neighbouring teeth share '// &
                     str(table%number('body_coupling_um'), 4)//' um')
    end if
    if (table%position('felt_rotation_um') > 0) call tell_hubs(table, lines)
    call lines%put(left('Load', 19)//str(table%number('load_n'), 5)//' N on the line of action, effective masses '// &
                   str(table%number('pinion_mass_kg'), 4)//' and '//str(table%number('gear_mass_kg'), 4)//' kg ('// &
                   trim(origin(study, 1)))
    if (origin(study, 1) /= origin(study, 2)) call lines%put('; '//trim(origin(study, 2)))
    call lines%put(')')
    if (table%position('damping_ratio') > 0) call lines%put(', damping ratio '//str(table%number('damping_ratio')))
    if (table%position('friction') > 0) call lines%put(', friction '//str(table%number('friction')))
    call lines%add('')
    if (allocated(study%pair)) call tell_pressure(study, lines)
    call tell_webs(study, lines)
    call lines%add(left('Natural frequency', 19)//str(table%number('natural_frequency_hz'), 5)//' Hz: the mesh excites it at '// &
                   str(table%number('resonance_rpm'), 5)//' rpm of the pinion')
  end subroutine add_motion

  !> A load that no flank bears, as where a torque is in another unit than its key. Steel of rolling bearings, harder than that of
  !> gears, takes a lasting dent from 4000 MPa on in contacts along a line (ISO 76:2006, static load rating of roller bearings).
  pure subroutine tell_pressure(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    real(dp), parameter :: most = 4e9_dp
    character(:), allocatable :: key
    real(dp) :: pressure, given

    pressure = pressure_at_pitch(study%case, study%pair, study%load)
    if (pressure <= most) return
    call name_load(study%case, key, given)
    call lines%add(left('', 19)//'caution: &load '//key//' = '//str(given)//' makes a pressure of '//str(pressure/micro, 4)// &
                   ' MPa at the pitch point; hardened steel bears '//str(most/micro))
    if (key == 'torque_nm') call lines%add(left('', 19)//'if N mm is meant, write '//str(given/1000))
  end subroutine tell_pressure

  !> Where a gear's effective mass comes from.
  pure function origin(study, member) result(words)
    type(study_t), intent(in) :: study
    integer, intent(in) :: member
    character(11) :: words

    words = 'stated'
    if (study%case%mass(member) > 0 .or. study%case%inertia(member) > 0) return
    words = 'solid disc'
    if (is_webbed(study, member)) words = of_web
  end function origin

  !> Does the case describe a web behind the teeth of this gear?
  pure logical function is_webbed(study, member)
    type(study_t), intent(in) :: study
    integer, intent(in) :: member

    is_webbed = allocated(study%pair)
    if (is_webbed) is_webbed = has_web(study%pair%gear(member), study%case%iso%web_thickness(member), &
                                       study%case%iso%rim_thickness(member))
  end function is_webbed

  !> What of rims and webs masses and stiffness know, where the case describes any.
  pure subroutine tell_webs(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    character(:), allocatable :: words
    integer :: i

    if (.not. any([(is_webbed(study, i), i=1, 2)])) return
    words = 'count in the masses'
    if (.not. any([(origin(study, i) == of_web, i=1, 2)])) words = 'do not count in the masses, which are stated'
    select case (study%case%model)
    case ('iso6336')
      words = words//'; in the stiffness by C_R'
    case ('fe')
      if (any(rims(study%case, study%pair) > 0)) then
        words = words//'; in the stiffness as rims that sections of '//str(rim_teeth(study%case))// &
          ' teeth hold at their sides: that the webs hold them too is left out'
      else
        words = words//'; not in the stiffness, as &section says what is held'
      end if
    case default
      words = words//'; not in the stiffness by '//study%case%model
    end select
    call lines%add(left('Rim and web', 19)//words)
  end subroutine tell_webs

  !> How much of the turning the motion has, and how far one degree of freedom is from the chain of all inertias.
  pure subroutine tell_hubs(table, lines)
    type(table_t), intent(in) :: table
    type(lines_t), intent(inout) :: lines
    real(dp), parameter :: much = 0.01_dp
    real(dp) :: more

    call lines%add(left('Hubs', 19)//'their inertia makes the motion feel '//str(table%number('felt_rotation_um'), 4)// &
                   ' um of that turn; as a chain of four inertias the gears have')
    call lines%add(left('', 19)//'natural frequencies of '//str(table%number('chain_frequency_hz'), 5)//' and '// &
                   str(table%number('next_chain_frequency_hz'), 5)//' Hz, of which the motion has one')
    more = table%number('natural_frequency_hz')/table%number('chain_frequency_hz') - 1
    if (more > much) call lines%add(left('', 19)//'caution: its natural frequency lies '//str(100*more, 2)// &
      ' % above the chain''s, as the bodies turn too softly about these hubs')
  end subroutine tell_hubs

  !> What the standard took, and how far another model is from it.
  pure subroutine add_iso(study, table, lines)
    type(study_t), intent(in) :: study
    type(table_t), intent(in) :: table
    type(lines_t), intent(inout) :: lines
    real(dp), parameter :: wide = 0.15_dp
    !> Where q' holds: ISO 6336-1:2006, 9.3.1.1.
    real(dp), parameter :: least_sum = -0.5_dp, most_sum = 2
    !> Below, c_gamma may be up to a tenth less than by its formula: ISO 6336-1:2006, 9.3.2.
    real(dp), parameter :: least_ratio = 1.2_dp
    real(dp) :: more

    call lines%add(left('', 19)//'F_t K_A/b '//str(table%number('iso_line_load_n_mm'), 4)//' N/mm, C_R '// &
                   str(table%number('iso_blank_factor'), 4))
    more = table%number('weber_mesh_stiffness_n_um')/table%number('mean_mesh_stiffness_n_um') - 1
    if (abs(more) > wide) call lines%add(left('', 19)//'the model weber has a mesh mean of '// &
      str(table%number('weber_mesh_stiffness_n_um'), 4)//' N/um, '//str(100*abs(more), 2)//' % '// &
      merge('more', 'less', more > 0)//'; ISO 6336-1 is a mean of usual gears')
    associate (x => study%pair%gear%spec%profile_shift)
      if (x(1) < x(2) .or. sum(x) < least_sum .or. sum(x) > most_sum) call lines%add(left('', 19)//'caution: the standard has '// &
        'its formula for profile shifts of the pinion at least as large as the gear''s, with a sum from '//str(least_sum)// &
        ' to '//str(most_sum))
    end associate
    if (study%pair%contact_ratio < least_ratio) call lines%add(left('', 19)//'caution: below a contact ratio of '// &
      str(least_ratio)//' the standard has a mesh stiffness up to a tenth less')
  end subroutine add_iso
end module gearsweep_motion_table
