!> Teeth by finite elements, each with what it was made from: of these none is solved twice.
!>
!> A tooth knows its own gear, and of the mate only which part of its flank that touches. It knows neither the load nor relief,
!> face width, masses and densities.
module gearsweep_teeth
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_elastic_options, only: fe_options_t
  use gearsweep_error, only: error_t
  use gearsweep_gear, only: gear_spec_t, gear_t
  use gearsweep_kinds, only: dp
  use gearsweep_material, only: material_t
  use gearsweep_tooth_compliance, only: tooth_compliance, tooth_t
  implicit none
  private
  public :: teeth_t

  !> All that a tooth is made from: nothing else is at hand as it is solved. Without allocatable components, so that one `write`
  !> gives all of it to the last bit.
  type :: tooth_inputs_t
    type(gear_t) :: gear
    type(material_t) :: material
    type(fe_options_t) :: options
    real(dp) :: first = 0, last = 0              !< radii of curvature of the drive flank where it touches, m
  end type tooth_inputs_t

  type :: solved_tooth_t
    type(tooth_inputs_t) :: inputs
    character(:), allocatable :: words           !< the inputs as text
    type(tooth_t) :: tooth
  end type solved_tooth_t

  !> The last teeth that were solved, the newest first.
  type :: teeth_t
    type(solved_tooth_t), allocatable :: list(:)
    integer :: solved = 0, taken = 0             !< how many in this run
  contains
    procedure :: find
  end type teeth_t

  !> How many are kept; each takes some 6 kB.
  integer, parameter :: most = 64
  integer(int64), parameter :: bytes(1) = 0

contains

  !> The `tooth` of this gear, solved where it is not among those that are known; arguments as of `tooth_compliance`, but of
  !> `options` the rims of pinion and gear and what sits at their bores do not count.
  subroutine find(self, gear, material, options, first, last, tooth, error)
    class(teeth_t), intent(inout) :: self
    type(gear_t), intent(in) :: gear
    type(material_t), intent(in) :: material
    type(fe_options_t), intent(in) :: options
    real(dp), intent(in) :: first, last
    type(tooth_t), intent(out) :: tooth
    type(error_t), allocatable, intent(inout) :: error
    type(tooth_inputs_t) :: inputs
    character(storage_size(inputs)) :: words
    type(solved_tooth_t), allocatable :: others(:)
    type(gear_spec_t) :: usual_gear
    type(fe_options_t) :: usual
    type(material_t) :: steel
    integer :: at

    inputs = tooth_inputs_t(gear, material, options, first, last)
    ! What does not count is as in any other gear.
    inputs%gear%spec%name = usual_gear%name
    inputs%gear%spec%face_width = usual_gear%face_width
    inputs%gear%spec%pin_diameter = usual_gear%pin_diameter
    inputs%material%density = steel%density
    inputs%options%rim = usual%rim
    inputs%options%rim_teeth = usual%rim_teeth
    inputs%options%hub_share = usual%hub_share
    if (.not. allocated(self%list)) allocate (self%list(0))
    do at = size(self%list), 1, -1
      if (all(transfer(self%list(at)%inputs, bytes) == transfer(inputs, bytes))) exit
    end do
    ! Where the bytes differ, the numbers need not: those of gaps and of blanks do not count.
    if (at == 0) then
      write (words, '(*(g0, 1x))') inputs
      do at = size(self%list), 1, -1
        if (self%list(at)%words == words) exit
      end do
    end if
    if (at > 0) then
      self%taken = self%taken + 1
      tooth = self%list(at)%tooth
      return
    end if
    call tooth_compliance(inputs%gear, inputs%material, inputs%options, inputs%first, inputs%last, tooth, error)
    if (allocated(error)) return
    self%solved = self%solved + 1
    call move_alloc(self%list, others)
    allocate (self%list(min(most, size(others) + 1)))
    self%list(1)%inputs = inputs
    self%list(1)%words = trim(words)
    self%list(1)%tooth = tooth
    do at = 2, size(self%list)
      self%list(at) = others(at - 1)
    end do
  end subroutine find
end module gearsweep_teeth
