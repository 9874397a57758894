!> Tables of what every task starts from: the gear pair, its load, masses and stiffness.
module gearsweep_geometry_tables
  use gearsweep_error, only: error_t
  use gearsweep_gear, only: coast, drive
  use gearsweep_kinds, only: dp, pi
  use gearsweep_study, only: study_t
  use gearsweep_table, only: table_t
  implicit none
  private
  public :: geometry_table, gears_table, contact_points_table, motion_table

  real(dp), parameter :: micro = 1e6_dp, milli = 1e3_dp, degree = pi/180

contains

  !> The gear pair.
  pure subroutine geometry_table(study, table, error)
    type(study_t), intent(in) :: study
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error

    if (.not. allocated(study%pair)) return
    call table%begin('the gear pair', 1, 11, error)
    if (allocated(error)) return
    associate (pair => study%pair, spec => study%pair%gear(1)%spec, widths => study%pair%gear%spec%face_width)
      call table%add('module_mm', 'mm', 'normal module', [milli*spec%module])
      call table%add('pressure_angle_deg', 'deg', 'of the drive flanks on the reference circle', &
                     [spec%pressure_angle(drive)/degree])
      call table%add('coast_angle_deg', 'deg', 'of the coast flanks on the reference circle', &
                     [spec%pressure_angle(coast)/degree])
      call table%add('face_width_mm', 'mm', 'face width of the contact', [milli*minval(widths)])
      call table%add('centre_distance_mm', 'mm', 'centre distance', [milli*pair%centre_distance])
      call table%add('working_angle_deg', 'deg', 'working pressure angle of the drive flanks', &
                     [pair%working_angle(drive)/degree])
      call table%add('coast_working_angle_deg', 'deg', 'working pressure angle of the coast flanks', &
                     [pair%working_angle(coast)/degree])
      call table%add('backlash_um', 'um', 'along the line of action', [micro*abs(max(0.0_dp, pair%backlash))])
      call table%add('contact_ratio', '', 'transverse contact ratio: the path of contact in base pitches', &
                     [pair%contact_ratio])
      call table%add('base_pitch_mm', 'mm', 'of the drive flanks', [milli*pair%base_pitch])
    end associate
  end subroutine geometry_table

  !> The two gears and their circles.
  pure subroutine gears_table(study, table, error)
    type(study_t), intent(in) :: study
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    character(*), parameter :: members(2) = [character(6) :: 'pinion', 'gear']
    integer :: i

    if (.not. allocated(study%pair)) return
    call table%begin('the two gears', 2, 9, error, extent=[2])
    if (allocated(error)) return
    associate (gear => study%pair%gear)
      call table%add_index('member', '', 'pinion or gear', members)
      call table%add('teeth', '', 'number of teeth', [gear%spec%teeth])
      call table%add('tip_diameter_mm', 'mm', 'tip circle', [2*milli*gear%tip_radius])
      call table%add('reference_diameter_mm', 'mm', 'reference circle', [2*milli*gear%reference_radius])
      call table%add('base_diameter_mm', 'mm', 'base circle of the drive flanks', &
                     [(2*milli*gear(i)%base_radius(drive), i=1, 2)])
      call table%add('coast_base_diameter_mm', 'mm', 'base circle of the coast flanks', &
                     [(2*milli*gear(i)%base_radius(coast), i=1, 2)])
      call table%add('root_diameter_mm', 'mm', 'root circle', [2*milli*gear%root_radius])
      call table%add('form_diameter_mm', 'mm', 'circle where the involute of the drive flank begins', &
                     [(2*milli*gear(i)%form_radius(drive), i=1, 2)])
    end associate
  end subroutine gears_table

  !> Points of the path of contact.
  pure subroutine contact_points_table(study, table, error)
    type(study_t), intent(in) :: study
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: s(5)

    if (.not. allocated(study%pair)) return
    call table%begin('points of the path of contact: A start, B and D where another pair leaves and enters, P pitch point, '// &
                     'E end', 5, 4, error, extent=[5])
    if (allocated(error)) return
    s = study%pair%points()
    call table%add_index('point', '', 'its letter', ['A', 'B', 'P', 'D', 'E'])
    call table%add('s', '', 'path coordinate from A, in base pitches', s)
    call table%add('pinion_radius_mm', 'mm', 'radius at which the pinion touches', milli*study%pair%radius(1, s))
    call table%add('gear_radius_mm', 'mm', 'radius at which the gear touches', milli*study%pair%radius(2, s))
  end subroutine contact_points_table

  !> What drives the motion.
  pure subroutine motion_table(study, table, error)
    type(study_t), intent(in) :: study
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: frequency, mean, width

    if (.not. allocated(study%motion)) return
    call table%begin('load, masses and stiffness of the mesh, and its natural frequency', 1, 13, error)
    if (allocated(error)) return
    associate (mesh => study%motion(1)%mesh, case => study%case)
      frequency = study%motion(1)%natural_frequency/(2*pi)
      mean = mesh%mean_stiffness()
      width = case%spec(1)%face_width
      call table%add('load_n', 'N', 'static load on the line of action', [study%load])
      call table%add('pinion_mass_kg', 'kg', 'effective mass of the pinion on the line of action', study%mass(1:1))
      call table%add('gear_mass_kg', 'kg', 'effective mass of the gear on the line of action', study%mass(2:2))
      call table%add('least_pair_stiffness_n_um', 'N/um', 'least stiffness of a pair on its path, whole face width', &
                     [mesh%stiffness%minimum()/micro])
      call table%add('largest_pair_stiffness_n_um', 'N/um', 'largest stiffness of a pair on its path, whole face width', &
                     [mesh%stiffness%maximum()/micro])
      call table%add('mean_mesh_stiffness_n_um', 'N/um', 'mean over a mesh period of all pairs in contact', [mean/micro])
      if (width > 0) call table%add('mean_mesh_stiffness_n_um_mm', 'N/um/mm', 'the same per mm of face width', &
                                    [mean/width*1e-9_dp])
      call table%add('natural_frequency_hz', 'Hz', 'of the mean mesh stiffness and the effective masses', [frequency])
      call table%add('resonance_rpm', '1/min', 'speed of the pinion at which the mesh excites it', &
                     [60*frequency/mesh%teeth(1)])
      call table%add('body_rotation_um', 'um', 'turn of whole gears about their bores under the load, on the line of '// &
                     'action: not in the motion', [micro*study%load*mesh%disc%turn])
      call table%add('body_coupling_um', 'um', 'what neighbouring teeth share beyond that: in the stiffness of each pair', &
                     [micro*study%load*mesh%disc%shared])
      if (case%needs('losses')) call table%add('damping_ratio', '', 'as in the case', [case%damping_ratio])
      if (case%needs('motion')) call table%add('friction', '', 'friction coefficient, as in the case', [case%friction])
    end associate
  end subroutine motion_table
end module gearsweep_geometry_tables
