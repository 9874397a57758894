!> The section of one gear while a study is made: held and factored, and with its modes, once for all tasks that need it.
module gearsweep_member_section
  use gearsweep_error, only: error_t
  use gearsweep_inputs, only: body_inputs_t
  use gearsweep_modal, only: modal_t, section_modes
  use gearsweep_section_body, only: make_two_grids, section_body_t
  use gearsweep_text, only: str
  implicit none
  private
  public :: member_section_t

  type :: member_section_t
    type(section_body_t), allocatable :: bodies(:)  !< factored, on two grids
    type(modal_t), allocatable :: modal          !< the lowest modes, as many as the last task wanted that needs them
    character(:), allocatable :: log             !< of the study: stages run and left out, a line each
  contains
    procedure :: note, need_bodies, need_modes
  end type member_section_t

contains

  !> A line of the log.
  subroutine note(self, line)
    class(member_section_t), intent(inout) :: self
    character(*), intent(in) :: line

    self%log = self%log//line//new_line('a')
  end subroutine note

  !> The gear's body, factored on two grids, for all tasks that need it; nothing is done where it is there.
  subroutine need_bodies(self, inputs, error)
    class(member_section_t), intent(inout) :: self
    type(body_inputs_t), intent(in) :: inputs
    type(error_t), allocatable, intent(inout) :: error

    if (allocated(self%bodies) .or. allocated(error)) return
    allocate (self%bodies(2))
    call make_two_grids(inputs%gear, inputs%material, inputs%options, self%bodies, error)
    call self%note('section: two grids made and factored')
  end subroutine need_bodies

  !> The lowest `count` modes of the gear's section on two grids; nothing is done where just these are there.
  subroutine need_modes(self, inputs, count, error)
    class(member_section_t), intent(inout) :: self
    type(body_inputs_t), intent(in) :: inputs
    integer, intent(in) :: count
    type(error_t), allocatable, intent(inout) :: error

    call self%need_bodies(inputs, error)
    if (allocated(error)) return
    if (allocated(self%modal)) then
      if (size(self%modal%modes%frequency) == count) return
      deallocate (self%modal)
    end if
    allocate (self%modal)
    call section_modes(self%bodies, count, self%modal, error)
    if (allocated(error)) then
      deallocate (self%modal)
    else
      call self%note('section: '//str(count)//' natural modes on both grids')
    end if
  end subroutine need_modes
end module gearsweep_member_section
