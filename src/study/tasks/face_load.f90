!> The task `face_load`: load distribution over the face width and the path of contact, and the face load factors.
module gearsweep_study_tasks_face_load
  use gearsweep_base, only: axis, dp, error_t, lines_t, piecewise_t, str, table_t
  use gearsweep_face, only: alignment_t, face_load_t, iso_face_load_factor, iso_shaft_misalignment
  use gearsweep_mesh, only: iso_stiffness
  use gearsweep_study_case_task, only: stage, task_info_t
  use gearsweep_study_reader_reader, only: reader_t
  use gearsweep_study_run_face_stage, only: find_face_loads
  use gearsweep_study_run_points, only: of_relief
  use gearsweep_study_run_stages, only: runnable_t, stages_t
  implicit none
  private
  public :: face_load_task_t

  character(*), parameter :: of_phase = 'fraction of the mesh period, 0 where a pair enters at A, of helical gears at z = 0; '// &
                                       'both sides of a break'

  type, extends(runnable_t) :: face_load_task_t
    real(dp), allocatable :: misalignment(:)     !< over which the factors are computed too, m; not allocated: none
  contains
    procedure, nopass :: describe
    procedure :: read_keys, run, add_report
  end type face_load_task_t

contains

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t('face_load', needs=[stage%geometry, stage%face, stage%elasticity, stage%rims, stage%webs, stage%mesh, &
                                           stage%reliefs, stage%amounts], &
                       tables='face_load face_load_phases face_load_summary face_misalignments', fields='', has_helical=.true., &
                       summary='load over face width and path with misalignment and leads, K_H_beta, K_F_beta, edge load')
  end subroutine describe

  subroutine read_keys(self, reader, error)
    class(face_load_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    type(error_t), allocatable, intent(inout) :: error

    call reader%add_group('face_load', 'The task face_load: the load over the face width.')
    call reader%get('face_load', 'misalignment_um', self%misalignment, error, unit='um', tasks='face_load', at_least=-1000.0_dp, &
                    at_most=1000.0_dp, max_size=1000, distinct=.true., default_note='none', &
                    meaning='misalignments, in place of that of &face, over which face_misalignments has the face load factors')
  end subroutine read_keys

  subroutine run(self, stages, error)
    class(face_load_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(error_t), allocatable, intent(inout) :: error

    if (allocated(error)) return
    associate (loads => stages%face_loads)
      call fill_load(stages, loads, self%tables(self%place('face_load')), error)
      call fill_phases(stages, loads, self%tables(self%place('face_load_phases')), error)
      call fill_summary(stages, loads, self%tables(self%place('face_load_summary')), error)
      if (allocated(self%misalignment)) &
        call fill_misalignments(stages, self%misalignment, self%tables(self%place('face_misalignments')), error)
      self%is_done = .true.
      self%log = 'face_load: load over '//str(size(loads(1)%gap))//' slices of the face'
    end associate
  end subroutine run

  !> Fills the load of each pair on each slice.
  subroutine fill_load(stages, loads, table, error)
    type(stages_t), intent(in) :: stages
    type(face_load_t), intent(in) :: loads(:)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: values(:, :)
    integer :: i, j, k, n, row, rows

    n = size(loads(1)%gap)
    rows = n*sum([(sum(loads(i)%pairs), i=1, size(loads))])
    call table%begin('load over the face width of each pair over a mesh period, for each relief', rows, error)
    if (allocated(error)) return
    allocate (values(rows, 8))
    row = 0
    do i = 1, size(loads)
      associate (one => loads(i))
        do k = 1, size(one%phase)
          do j = 1, one%pairs(k)
            values(row + 1:row + n, 1) = stages%amount(i)
            values(row + 1:row + n, 2) = one%phase(k)
            values(row + 1:row + n, 3) = one%path(:, j, k)
            values(row + 1:row + n, 4) = one%middle()
            values(row + 1:row + n, 5) = one%bounds(1:) - one%bounds(:n - 1)
            values(row + 1:row + n, 6) = one%gap
            values(row + 1:row + n, 7) = one%line_load(:, j, k)
            values(row + 1:row + n, 8) = one%pressure(:, j, k)
            row = row + n
          end do
        end do
      end associate
    end do
    call table%add_index(axis('relief_um', 'um', of_relief, values(:, 1)))
    call table%add_index(axis('mesh_phase', '', of_phase, values(:, 2)))
    call table%add_index(axis('s', '', 'path coordinate of the pair at this place, in base pitches from A; oblique lines are '// &
                              'off the path below 0 and above the contact ratio', values(:, 3)))
    call table%add_index(axis('z_mm', 'mm', 'place of the slice''s middle along the face', values(:, 4)))
    call table%add('slice_mm', 'mm', 'width of the slice', values(:, 5))
    call table%add('gap_um', 'um', 'gap of the flanks by misalignment, leads and the shaft''s deflection, without tip relief', &
                   values(:, 6))
    call table%add('line_load_n_mm', 'N/mm', 'load of the slice over its width', values(:, 7))
    call table%add('pressure_mpa', 'MPa', 'Hertz''s pressure under it', values(:, 8))
  end subroutine fill_load

  !> Fills what belongs to a phase.
  subroutine fill_phases(stages, loads, table, error)
    type(stages_t), intent(in) :: stages
    type(face_load_t), intent(in) :: loads(:)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    integer :: i, k

    if (allocated(error)) return
    call table%begin('load over the face width over a mesh period, for each relief', &
                     sum([(size(loads(i)%phase), i=1, size(loads))]), error)
    if (allocated(error)) return
    call table%add_index(axis('relief_um', 'um', of_relief, [((stages%amount(i), k=1, size(loads(i)%phase)), i=1, size(loads))]))
    call table%add_index(axis('mesh_phase', '', of_phase, [(loads(i)%phase, i=1, size(loads))]))
    call table%add('pairs', '', 'pairs in contact', [(loads(i)%pairs, i=1, size(loads))])
    call table%add('ste_um', 'um', 'static transmission error along the line of action', [(loads(i)%error, i=1, size(loads))])
    call table%add('mesh_stiffness_n_um', 'N/um', 'tangent stiffness of the mesh: load over deflection for a small change', &
                   [(loads(i)%stiffness, i=1, size(loads))])
    call table%add('face_load_factor', '', 'largest load on one module of the face over the mean, of all pairs together', &
                   [(loads(i)%factor, i=1, size(loads))])
  end subroutine fill_phases

  !> Fills the factors of each relief, and those of ISO 6336-1.
  subroutine fill_summary(stages, loads, table, error)
    type(stages_t), intent(in) :: stages
    type(face_load_t), intent(in) :: loads(:)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: width
    integer :: i, m

    if (allocated(error)) return
    m = size(loads)
    width = minval(stages%pair%gear%spec%face_width)
    call table%over('face load factors for each relief', error, axis('relief_um', 'um', of_relief, stages%amount))
    call add_factors(stages, loads, spread(stages%faces%alignment, 1, m), table, error)
    if (allocated(error)) return
    call table%add('largest_line_load_n_mm', 'N/mm', 'largest load of a slice over its width', &
                   [(maxval(loads(i)%line_load), i=1, m)])
    call table%add('ste_mean_um', 'um', 'mean static transmission error', [(sum(loads(i)%share*loads(i)%error), i=1, m)])
    call table%add('mesh_stiffness_n_um', 'N/um', 'mean tangent stiffness of the mesh', &
                   [(sum(loads(i)%share*loads(i)%stiffness), i=1, m)])
    call table%add('misalignment_um', 'um', 'misalignment with both lead slopes', spread(stages%faces%alignment%slope(), 1, m))
    call table%add('shaft_gap_um', 'um', 'largest gap by twist and bending of pinion and shaft; 0 for a rigid shaft', &
                   [(maxval(stages%faces%shaft%gap(stages%load, width, loads(i)%middle())), i=1, m)])
    call table%add('iso_shaft_misalignment_um', 'um', 'f_sh of ISO 6336-1 for that shaft', &
                   spread(iso_shaft_misalignment(stages%faces%shaft, stages%load/width, width), 1, m))
  end subroutine fill_summary

  !> Fills the factors of each relief over a list of misalignments (m).
  subroutine fill_misalignments(stages, misalignment, table, error)
    type(stages_t), intent(in) :: stages
    real(dp), intent(in) :: misalignment(:)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    type(face_load_t), allocatable :: loads(:)
    type(alignment_t) :: alignment(size(misalignment))
    integer :: i

    alignment = stages%faces%alignment
    alignment%misalignment = misalignment
    call find_face_loads(stages, alignment, loads, error)
    if (allocated(error)) return
    call table%over('face load factors over the misalignment, for each relief', error, &
                    axis('relief_um', 'um', of_relief, stages%amount), &
                    axis('misalignment_um', 'um', 'misalignment without lead slopes', misalignment))
    call add_factors(stages, loads, [(alignment, i=1, size(stages%amount))], table, error)
  end subroutine fill_misalignments

  !> Adds the face load factors of load distributions, and those of ISO 6336-1.
  subroutine add_factors(stages, loads, alignment, table, error)
    type(stages_t), intent(in) :: stages
    type(face_load_t), intent(in) :: loads(:)
    type(alignment_t), intent(in) :: alignment(:)  ! of each
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    ! Part of f_sh in the misalignment before running in. Source: ISO 6336-1:2006, 7.5.2.
    real(dp), parameter :: of_shaft = 1.33_dp
    type(piecewise_t) :: stiffness
    real(dp) :: width, shaft
    integer :: i, m

    if (allocated(error)) return
    m = size(loads)
    width = minval(stages%pair%gear%spec%face_width)
    call iso_stiffness(stages%pair, stages%material, stages%load/width, stiffness, error, stages%iso)
    if (allocated(error)) return
    shaft = iso_shaft_misalignment(stages%faces%shaft, stages%load/width, width)
    call table%add('face_load_factor', '', 'K_H_beta in the middle of contact of the fewest pairs, of helical gears of the '// &
                   'mean over the mesh period: largest load on one module of the face over the mean', &
                   [(loads(i)%single_factor, i=1, m)])
    call table%add('mean_face_load_factor', '', 'K_H_beta of the load''s mean over the mesh period', &
                   [(loads(i)%mean_factor, i=1, m)])
    call table%add('worst_face_load_factor', '', 'K_H_beta at the phase where it is largest', [(maxval(loads(i)%factor), i=1, m)])
    call table%add('worst_phase', '', 'that mesh phase', &
                   [(loads(i)%phase(maxloc(loads(i)%factor, 1)), i=1, m)])
    call table%add('root_face_load_factor', '', 'K_F_beta: largest root stress along the face over that of an even load, at '// &
                   'the outer points of contact of the fewest pairs, of helical gears under the mean load', &
                   [(loads(i)%root_factor, i=1, m)])
    call table%add('edge_load', '', 'mean over the period of the load on the outermost module of the face, larger end, over '// &
                   'the mean', [(loads(i)%edge_load, i=1, m)])
    call table%add('face_in_contact', '', 'fraction of the face that carries in the middle of contact of the fewest pairs, of '// &
                   'helical gears of all lines, as the mean over the mesh period', &
                   [(loads(i)%in_contact, i=1, m)])
    call table%add('largest_pressure_mpa', 'MPa', 'largest Hertz pressure of a slice', [(maxval(loads(i)%pressure), i=1, m)])
    call table%add('ste_peak_to_peak_um', 'um', 'peak-to-peak static transmission error', &
                   [(maxval(loads(i)%error) - minval(loads(i)%error), i=1, m)])
    call table%add('iso_face_load_factor', '', 'K_H_beta of ISO 6336-1, method C, for the misalignment and 1.33 f_sh, without '// &
                   'crowning, end relief and running in', [(iso_face_load_factor(abs(alignment(i)%slope()) + of_shaft*shaft, &
                   stiffness%integral(0.0_dp, stages%pair%contact_ratio)/width, stages%load/width), i=1, m)])
  end subroutine add_factors

  pure subroutine add_report(self, lines)
    class(face_load_task_t), intent(in) :: self
    type(lines_t), intent(inout) :: lines

    associate (summary => self%tables(self%place('face_load_summary')))
      call lines%add('')
      call lines%add('Load over the face width, misalignment '//str(summary%number('misalignment_um', 1), 4)//' um')
      call summary%show(lines, 'relief_um face_load_factor mean_face_load_factor worst_face_load_factor root_face_load_factor '// &
                        'edge_load face_in_contact iso_face_load_factor')
      if (allocated(self%misalignment)) then
        associate (over => self%tables(self%place('face_misalignments')))
          call lines%add('')
          call lines%add('Over the misalignment')
          call over%show(lines, 'relief_um misalignment_um face_load_factor mean_face_load_factor worst_face_load_factor '// &
                         'root_face_load_factor edge_load face_in_contact iso_face_load_factor')
        end associate
      end if
      if (minval(summary%numbers('face_in_contact'))*10 < 1) call lines%add('   a tenth of the face carries: such line loads '// &
        'need another lead, or a check of what is stated')
    end associate
  end subroutine add_report
end module gearsweep_study_tasks_face_load
