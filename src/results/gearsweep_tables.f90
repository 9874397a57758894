!> The tables of a study, by name.
module gearsweep_tables
  use gearsweep_body_tables, only: mode_table, outline_table, published_table, root_table
  use gearsweep_csv, only: write_csv
  use gearsweep_error, only: error_t
  use gearsweep_mesh_tables, only: harmonics_table, mesh_table
  use gearsweep_motion_tables, only: load_table, optimum_table, sweep_table
  use gearsweep_study, only: study_t
  use gearsweep_table, only: table_t
  implicit none
  private
  public :: make_table, write_table

  !> All that there can be, in the order in which they are written and listed.
  character(*), parameter, public :: table_names(9) = [character(9) :: 'mesh', 'harmonics', 'load', 'sweep', 'vcurve', &
                                                       'outline', 'root', 'modes', 'published']

contains

  !> Fills the table of this name from the study. Where the study has none, `table%is_there()` is false. `error`: the
  !> memory does not hold it. Any number of callers at once.
  pure subroutine make_table(study, name, table, error)
    type(study_t), intent(in) :: study
    character(*), intent(in) :: name
    type(table_t), intent(out) :: table
    type(error_t), allocatable, intent(inout) :: error

    if (allocated(error)) return
    select case (name)
    case ('mesh')
      call mesh_table(study, table, error)
    case ('harmonics')
      call harmonics_table(study, table, error)
    case ('load')
      call load_table(study, table, error)
    case ('sweep')
      call sweep_table(study, table, error)
    case ('vcurve')
      call optimum_table(study, table, error)
    case ('outline')
      call outline_table(study, table, error)
    case ('root')
      call root_table(study, table, error)
    case ('modes')
      call mode_table(study, table, error)
    case ('published')
      call published_table(study, table, error)
    case default  ! `table` stays one that is not there
    end select
  end subroutine make_table

  !> The table of this name as CSV; `text` is not allocated where the study has none or `error` is.
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
