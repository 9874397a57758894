!> Grids and fields for ParaView and its kin (VTK's unstructured XML format).
module gearsweep_vtu
  use gearsweep_kinds, only: dp
  use gearsweep_error, only: error_t, fail, code_file
  use gearsweep_grid, only: grid_t
  implicit none
  private
  public :: vtu_field_t, write_vtu

  !> Values at the nodes: one component, or two for vectors (components, nodes).
  type :: vtu_field_t
    character(:), allocatable :: name
    real(dp), allocatable :: values(:, :)
  end type vtu_field_t

  integer, parameter :: quadratic_quadrilateral = 23

contains

  !> Writes to `unit`, which the caller has opened for formatted output.
  subroutine write_vtu(unit, grid, fields, error)
    integer, intent(in) :: unit
    type(grid_t), intent(in) :: grid
    type(vtu_field_t), intent(in) :: fields(:)
    type(error_t), allocatable, intent(out) :: error
    character(*), parameter :: ints = '(8(i0, 1x))', reals = '(3(es16.8e3, 1x))'
    integer :: nodes, elements, i, status

    nodes = size(grid%x, 2)
    elements = size(grid%element, 2)
    call line('<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian"><UnstructuredGrid>')
    write (unit, '(a, i0, a, i0, a)', iostat=status) '<Piece NumberOfPoints="', nodes, '" NumberOfCells="', elements, '">'
    call line('<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">')
    write (unit, reals, iostat=status) (grid%x(:, i), 0.0_dp, i=1, nodes)
    call line('</DataArray></Points>')
    call line('<Cells><DataArray type="Int32" Name="connectivity" format="ascii">')
    write (unit, ints, iostat=status) grid%element - 1
    call line('</DataArray><DataArray type="Int32" Name="offsets" format="ascii">')
    write (unit, ints, iostat=status) (8*i, i=1, elements)
    call line('</DataArray><DataArray type="UInt8" Name="types" format="ascii">')
    write (unit, ints, iostat=status) (quadratic_quadrilateral, i=1, elements)
    call line('</DataArray></Cells>')
    call line('<CellData><DataArray type="Int32" Name="tooth" format="ascii">')
    write (unit, ints, iostat=status) grid%part
    call line('</DataArray></CellData><PointData>')
    do i = 1, size(fields)
      call write_field(fields(i))
    end do
    call line('</PointData></Piece></UnstructuredGrid></VTKFile>')
    if (status /= 0) call fail(error, code_file, 'cannot write the grid')

  contains

    subroutine line(text)
      character(*), intent(in) :: text

      write (unit, '(a)', iostat=status) text
    end subroutine line

    !> Vectors get the third component that the format's readers expect.
    subroutine write_field(field)
      type(vtu_field_t), intent(in) :: field
      integer :: n

      if (size(field%values, 1) == 2) then
        call line('<DataArray type="Float64" Name="'//field%name//'" NumberOfComponents="3" format="ascii">')
        write (unit, reals, iostat=status) (field%values(:, n), 0.0_dp, n=1, nodes)
      else
        write (unit, '(3a, i0, a)', iostat=status) '<DataArray type="Float64" Name="', field%name, &
          '" NumberOfComponents="', size(field%values, 1), '" format="ascii">'
        write (unit, reals, iostat=status) field%values
      end if
      call line('</DataArray>')
    end subroutine write_field
  end subroutine write_vtu
end module gearsweep_vtu
