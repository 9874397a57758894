!> The version, as in fpm.toml; a test compares both.
module gearsweep_base_version
  implicit none
  private

  character(*), parameter, public :: version = '0.2.0'
end module gearsweep_base_version
