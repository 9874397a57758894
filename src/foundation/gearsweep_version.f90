!> The version, as in fpm.toml; a test holds the two together.
module gearsweep_version
  implicit none
  private

  character(*), parameter, public :: version = '0.1.0'
end module gearsweep_version
