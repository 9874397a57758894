!> What all tasks that need the mesh start from, as a table and for the screen: load, masses and stiffness.
module gearsweep_motion_table
  use gearsweep_error, only: error_t
  use gearsweep_kinds, only: dp, pi
  use gearsweep_lines, only: left, lines_t
  use gearsweep_study, only: study_t
  use gearsweep_table, only: table_t
  use gearsweep_text, only: str
  implicit none
  private
  public :: motion_table, add_motion

  real(dp), parameter :: micro = 1e6_dp

contains

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
    if (table%number('body_rotation_um') > 0) then
      call lines%add(left('Discs', 19)//'turn by '//str(table%number('body_rotation_um'), 4)//' um on the line of action '// &
                     'about their bores: in the static transmission error,')
      call lines%add(left('', 19)//'not in the pairs'' stiffness nor in the motion; neighbouring teeth share '// &
                     str(table%number('body_coupling_um'), 4)//' um')
    end if
    call lines%put(left('Load', 19)//str(table%number('load_n'), 5)//' N on the line of action, effective masses '// &
                   str(table%number('pinion_mass_kg'), 4)//' and '//str(table%number('gear_mass_kg'), 4)//' kg')
    if (table%position('damping_ratio') > 0) call lines%put(', damping ratio '//str(table%number('damping_ratio')))
    if (table%position('friction') > 0) call lines%put(', friction '//str(table%number('friction')))
    call lines%add('')
    call lines%add(left('Natural frequency', 19)//str(table%number('natural_frequency_hz'), 5)//' Hz: the mesh excites it at '// &
                   str(table%number('resonance_rpm'), 5)//' rpm of the pinion')
  end subroutine add_motion
end module gearsweep_motion_table
