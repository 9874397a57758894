!> List of all tasks, help, and the calls for Fortran 77, C and Python.
!>
!> Other rooms use this module, and none of the room's own modules.
module gearsweep_api
  ! The calls of all languages.
  use gearsweep_api_api, only: resuming_is_gone
  ! The calls for C, which have no names in Fortran; so fpm takes them into the library that it installs.
  use gearsweep_api_c, only:
  ! Reads a case, one text for every interface.
  use gearsweep_api_case_reader, only: read_case
  ! Describes tasks, groups and keys as JSON, from the declarations of the keys.
  use gearsweep_api_describe, only: describe
  ! Describes tasks, groups and keys as text, from the declarations of the keys.
  use gearsweep_api_help, only: help_on
  ! Template of a case.
  use gearsweep_api_new_case, only: write_new_case
  ! Tables of a study by name, and their files.
  use gearsweep_api_tables, only: make_table, table_names, write_results, write_table
  implicit none
  public
end module gearsweep_api
