!> The task `modal`: natural frequencies and mode shapes of a section of one gear.
module gearsweep_study_tasks_modal
  use gearsweep_base, only: axis, dp, error_t, lines_t, right, str
  use gearsweep_study_case_task, only: gear_names, stage, task_info_t
  use gearsweep_study_reader_reader, only: is_prescribed, needs_gears, reader_t, text_unless
  use gearsweep_study_run_grid_tables, only: add_section, fill_elements, fill_nodes, fill_section, grid_of_section
  use gearsweep_study_run_stages, only: runnable_t, stages_t
  implicit none
  private
  public :: modal_task_t

  type, extends(runnable_t) :: modal_task_t
    integer :: modes = 10
  contains
    procedure, nopass :: describe
    procedure :: read_keys, run, add_report
  end type modal_task_t

  character(*), parameter :: of_mode = 'from the lowest frequency'

contains

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t('modal', needs=[stage%geometry, stage%section, stage%body], tables='modal mode_energy section', &
                       fields='nodes elements mode_shapes', &
                       summary='natural frequencies and mode shapes of the section of one gear, and its grid')
  end subroutine describe

  subroutine read_keys(self, reader, error)
    class(modal_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    type(error_t), allocatable, intent(inout) :: error

    call reader%add_group('modal', 'The task modal: natural modes of the section.')
    call reader%get('modal', 'modes', self%modes, error, at_least=1, at_most=1000, tasks='modal', &
                    not_allowed=text_unless(.not. is_prescribed(reader), needs_gears), &
                    meaning='number of natural modes from the lowest, below half the unknowns of the grid')
  end subroutine read_keys

  subroutine run(self, stages, error)
    class(modal_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(error_t), allocatable, intent(inout) :: error
    integer :: i

    call stages%running%need_modes(stages%body_inputs, self%modes, error)
    if (allocated(error)) return
    associate (modal => stages%running%modal)
      call fill_section(modal%section, gear_names(stages%gear), self%tables(self%place('section')), error)
      if (allocated(error)) return
      associate (table => self%tables(self%place('modal')), modes => modal%modes, n => size(modal%modes%frequency))
        call table%over('natural frequencies of the section', error, axis('mode', '', of_mode, [(i, i=1, n)]))
        if (allocated(error)) return
        call table%add('frequency_hz', 'Hz', 'natural frequency', modes%frequency)
        call table%add('error_estimate', '', 'estimated discretisation error, relative', modal%error_estimate)
        call table%add('residual', '', 'residual of the eigenvalue problem, relative', modes%residual)
        call table%add('rim_share', '', 'kinetic energy of the body below the teeth over the whole', modes%participation(0, :))
      end associate
      associate (table => self%tables(self%place('mode_energy')), &
                 parts => size(modal%modes%participation, 1), n => size(modal%modes%participation, 2))
        call table%over('kinetic energy of each mode by part of the section', error, axis('mode', '', of_mode, [(i, i=1, n)]), &
                        axis('tooth', '', 'counted from the coast side; 0 for the body below the teeth', [(i, i=0, parts - 1)]))
        if (allocated(error)) return
        call table%add('energy_share', '', 'kinetic energy of this part over the whole', [modal%modes%participation])
      end associate
      associate (table => self%tables(self%place('mode_shapes')), m => size(modal%modes%shape, 2), n => size(modal%modes%shape, 3))
        call table%over('mode shapes at the nodes of the section''s grid, for unit modal mass', error, &
                        axis('mode', '', of_mode, [(i, i=1, n)]), axis('node', '', 'its number', [(i, i=1, m)]), &
                        grid=grid_of_section)
        if (allocated(error)) return
        call table%add('shape_x', 'kg**-0.5', 'displacement in x over the modal coordinate', [modal%modes%shape(1, :, :)])
        call table%add('shape_y', 'kg**-0.5', 'displacement in y over the modal coordinate', [modal%modes%shape(2, :, :)])
      end associate
      call fill_nodes(modal%section%grid, self%tables(self%place('nodes')), error)
      call fill_elements(modal%section%grid, self%tables(self%place('elements')), error)
      self%grid = modal%section%grid
    end associate
    self%is_done = .true.
    self%log = 'modal: '//str(self%modes)//' modes'
  end subroutine run

  pure subroutine add_report(self, lines)
    class(modal_task_t), intent(in) :: self
    type(lines_t), intent(inout) :: lines
    integer, parameter :: most_teeth = 7
    integer :: i, part

    call lines%add('')
    call lines%add('Natural frequencies of the section of the '//trim(self%tables(self%place('section'))%word('gear', 1)))
    call add_section(self%tables(self%place('section')), lines)
    call lines%add('   mode          Hz   error est. %   residual   kinetic energy of rim and teeth %')
    associate (modes => self%tables(self%place('modal')), energy => self%tables(self%place('mode_energy')))
      do i = 1, modes%rows
        call lines%put(right(str(i), 7)//right(str(modes%number('frequency_hz', i), 6), 12)// &
                       right(str(100*modes%number('error_estimate', i), 2), 15)// &
                       right(str(modes%number('residual', i), 1), 11)//'   ')
        associate (parts => energy%extent(2))
          do part = 1, min(parts, most_teeth + 1)
            call lines%put(right(str(nint(100*energy%number('energy_share', (i - 1)*parts + part))), 4))
          end do
        end associate
        call lines%add('')
      end do
    end associate
  end subroutine add_report
end module gearsweep_study_tasks_modal
