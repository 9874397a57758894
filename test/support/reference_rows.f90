!> Reads the reference tables of test/reference: prescribed meshes with their
!> dynamic factor and largest Floquet multiplier, had by independent methods.
module test_support_reference_rows
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_base_error, only: error_t
  use gearsweep_motion_oscillator, only: make_oscillator, oscillator_t
  use gearsweep_gear_relief, only: profile_error, relief_t
  use gearsweep_mesh_stiffness, only: polynomial_stiffness
  implicit none
  private
  public :: row_t, next_row, read_rows, row_of, oscillator_of, complete, prescribed

  type :: row_t
    integer :: id = 0, teeth(2) = 0, n_coef = 0, shape = 0, loss = 0
    real(dp) :: angle = 0, contact_ratio = 0, pitch_point = 0, coef(5) = 0, mass(2) = 0, load = 0, zeta = 0, friction = 0
    real(dp) :: backlash = -1, relief(2) = 0, rpm = 0, dynamic_factor = 0, multiplier = 0, x = 0, v = 0
  end type row_t

contains

  !> Reads the next row of a file that is open; remarks, which begin with #, are passed over. False at its end.
  logical function next_row(unit, line)
    integer, intent(in) :: unit
    character(1000), intent(out) :: line
    integer :: status

    do
      read (unit, '(a)', iostat=status) line
      next_row = status == 0
      if (.not. next_row .or. line(1:1) /= '#') return
    end do
  end function next_row

  subroutine read_rows(path, rows)
    character(*), intent(in) :: path
    type(row_t), allocatable, intent(out) :: rows(:)
    type(row_t) :: row
    character(1000) :: line
    integer :: unit

    allocate (rows(0))
    open (newunit=unit, file=path, status='old', action='read')
    do while (next_row(unit, line))
      read (line, *) row%id, row%teeth, row%angle, row%contact_ratio, row%pitch_point, row%n_coef, row%coef, &
        row%mass, row%load, row%zeta, row%friction, row%backlash, row%relief, row%shape, row%rpm, &
        row%dynamic_factor, row%multiplier, row%x, row%v, row%loss
      rows = [rows, row]
    end do
    close (unit)
  end subroutine read_rows

  !> The columns from id to rpm.
  type(row_t) function row_of(line) result(row)
    character(*), intent(in) :: line

    read (line, *) row%id, row%teeth, row%angle, row%contact_ratio, row%pitch_point, row%n_coef, row%coef, &
      row%mass, row%load, row%zeta, row%friction, row%backlash, row%relief, row%shape, row%rpm
  end function row_of

  subroutine oscillator_of(row, osc)
    type(row_t), intent(in) :: row
    type(oscillator_t), intent(out) :: osc

    call prescribed(row%contact_ratio, row%coef(:row%n_coef), row%relief, row%shape, osc)
    call complete(row, osc)
  end subroutine oscillator_of

  !> What a row says beside stiffness and profile error.
  subroutine complete(row, osc)
    class(row_t), intent(in) :: row
    type(oscillator_t), intent(inout) :: osc
    type(error_t), allocatable :: error

    osc%mesh%teeth = row%teeth
    osc%mesh%pitch_point = row%pitch_point
    osc%mesh%tan_angle = tan(row%angle*pi/180)
    osc%mass = row%mass
    osc%load = row%load
    osc%damping_ratio = row%zeta
    osc%friction = row%friction
    osc%has_backlash = row%backlash >= 0
    osc%backlash = max(0.0_dp, row%backlash)*1e-6_dp
    call make_oscillator(osc, error)
    if (allocated(error)) error stop 'reference row'
  end subroutine complete

  !> A prescribed mesh: coefficients in N/um, short reliefs in um; the rest to be set by the caller.
  subroutine prescribed(contact_ratio, coef, relief_um, shape, osc)
    real(dp), intent(in) :: contact_ratio, coef(:), relief_um(2)
    integer, intent(in) :: shape
    type(oscillator_t), intent(out) :: osc
    type(relief_t) :: relief
    type(error_t), allocatable :: error

    osc%mesh%contact_ratio = contact_ratio
    osc%mesh%reach = [0.0_dp, osc%mesh%contact_ratio]
    call polynomial_stiffness(contact_ratio, 1e6_dp*coef, osc%mesh%stiffness, error)
    relief%amount = 1e-6_dp*relief_um
    relief%start = [aint(contact_ratio), contact_ratio - aint(contact_ratio)]
    relief%shape = shape
    call profile_error(relief, contact_ratio, osc%mesh%profile_error, error)
    if (allocated(error)) error stop 'prescribed mesh'
  end subroutine prescribed
end module test_support_reference_rows
