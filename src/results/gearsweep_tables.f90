!> The tables of a study, by name.
module gearsweep_tables
  use gearsweep_body_tables, only: elements_table, modal_table, mode_energy_table, mode_shapes_table, nodes_table, &
    outline_table, root_rating_table, root_stress_table, section_table, static_table, stress_load_table, stress_table
  use gearsweep_csv, only: write_csv
  use gearsweep_error, only: error_t
  use gearsweep_geometry_tables, only: contact_points_table, gears_table, geometry_table, motion_table
  use gearsweep_mesh_tables, only: harmonics_table, mesh_table, transmission_error_table
  use gearsweep_motion_tables, only: load_points_table, load_table, optimum_curve_table, optimum_table, resonances_table, &
    sweep_summary_table, sweep_table, sweep_worst_table
  use gearsweep_published_table, only: published_table
  use gearsweep_study, only: study_t
  use gearsweep_table, only: table_t
  use gearsweep_task, only: includes
  use gearsweep_tasks, only: list_tasks, task_slot_t
  implicit none
  private
  public :: table_names, make_table, write_table

  abstract interface
    !> Fills a table that has its name already. A study that lacks it leaves it as it is.
    pure subroutine fill(study, table, error)
      import :: study_t, table_t, error_t
      type(study_t), intent(in) :: study
      type(table_t), intent(inout) :: table
      type(error_t), allocatable, intent(inout) :: error
    end subroutine fill
  end interface

  type :: entry_t
    character(18) :: name
    procedure(fill), pointer, nopass :: fill => null()
    logical :: on_grid = .false.                 !< its rows are nodes or elements
  end type entry_t

contains

  !> All that there can be, in the order of the screen: a line each.
  pure function entries() result(list)
    type(entry_t) :: list(28)

    list = [ &
      & entry_t('geometry', geometry_table), &
      & entry_t('gears', gears_table), &
      & entry_t('contact_points', contact_points_table), &
      & entry_t('motion', motion_table), &
      & entry_t('section', section_table), &
      & entry_t('outline', outline_table), &
      & entry_t('nodes', nodes_table, on_grid=.true.), &
      & entry_t('elements', elements_table, on_grid=.true.), &
      & entry_t('modal', modal_table), &
      & entry_t('mode_energy', mode_energy_table), &
      & entry_t('mode_shapes', mode_shapes_table, on_grid=.true.), &
      & entry_t('static', static_table), &
      & entry_t('root_stress', root_stress_table), &
      & entry_t('root_rating', root_rating_table), &
      & entry_t('stress_load', stress_load_table), &
      & entry_t('stress', stress_table, on_grid=.true.), &
      & entry_t('mesh', mesh_table), &
      & entry_t('transmission_error', transmission_error_table), &
      & entry_t('harmonics', harmonics_table), &
      & entry_t('load', load_table), &
      & entry_t('load_points', load_points_table), &
      & entry_t('sweep', sweep_table), &
      & entry_t('sweep_worst', sweep_worst_table), &
      & entry_t('resonances', resonances_table), &
      & entry_t('sweep_summary', sweep_summary_table), &
      & entry_t('optimum', optimum_table), &
      & entry_t('optimum_curve', optimum_curve_table), &
      & entry_t('published', published_table)]
  end function entries

  !> Names of all tables that a study can have, padded with blanks; only of those that belong to a grid, or of the
  !> others, where `on_grid` says so.
  function table_names(on_grid) result(names)
    logical, intent(in), optional :: on_grid
    character(18), allocatable :: names(:)
    type(entry_t), allocatable :: list(:)
    type(task_slot_t), allocatable :: slots(:)
    integer :: i, from, length

    list = entries()
    if (present(on_grid)) list = pack(list, list%on_grid .eqv. on_grid)
    names = list%name
    if (present(on_grid)) then
      if (on_grid) return
    end if
    call list_tasks(slots)
    do i = 1, size(slots)
      if (.not. allocated(slots(i)%task)) cycle
      from = 1
      do while (from <= len(slots(i)%info%tables))
        length = index(slots(i)%info%tables(from:)//' ', ' ') - 1
        names = [character(18) :: names, slots(i)%info%tables(from:from + length - 1)]
        from = from + length + 1
      end do
    end do
  end function table_names

  !> Fills the table of this name from the study. Where the study has none, `table%is_there()` is false. `error`: the
  !> memory does not hold it. Any number of callers at once.
  pure subroutine make_table(study, name, table, error)
    type(study_t), intent(in) :: study
    character(*), intent(in) :: name
    type(table_t), intent(out) :: table
    type(error_t), allocatable, intent(inout) :: error
    type(entry_t), allocatable :: list(:)
    integer :: i

    if (allocated(error)) return
    list = entries()
    do i = 1, size(list)
      if (list(i)%name /= name) cycle
      table%name = trim(name)
      call list(i)%fill(study, table, error)
    end do
    if (.not. allocated(study%tasks)) return
    do i = 1, size(study%tasks)
      if (.not. allocated(study%tasks(i)%task) .or. .not. includes(study%tasks(i)%info%tables, trim(name))) cycle
      table%name = trim(name)
      if (study%tasks(i)%task%is_done) call study%tasks(i)%task%fill_table(table, error)
    end do
  end subroutine make_table

  !> The table of this name as CSV; `text` is not allocated where the study has none or after an `error`.
  pure subroutine write_table(study, name, text, error)
    type(study_t), intent(in) :: study
    character(*), intent(in) :: name
    character(:), allocatable, intent(out) :: text
    type(error_t), allocatable, intent(inout) :: error
    type(table_t) :: table

    call make_table(study, name, table, error)
    if (table%is_there()) call write_csv(table, study%case%text, text, error)
  end subroutine write_table
end module gearsweep_tables
