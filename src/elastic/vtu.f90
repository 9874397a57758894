!> Grids and fields for ParaView and similar programs (VTK's unstructured XML format), as text.
module gearsweep_elastic_vtu
  use gearsweep_base, only: dp, lines_t, str, write_decimal
  use gearsweep_elastic_grid, only: grid_t
  implicit none
  private
  public :: vtu_field_t, write_vtu

  !> Values at the nodes: one component, or two for vectors (components, nodes).
  type :: vtu_field_t
    character(:), allocatable :: name
    real(dp), allocatable :: values(:, :)
  end type vtu_field_t

  !> Start of every such file.
  character(*), parameter, public :: vtu_start = '<VTKFile type="UnstructuredGrid"'
  character(*), parameter :: quadratic_quadrilateral = '23'

contains

  !> Writes the grid with its fields as text; lengths in m, cells have the number of their tooth.
  pure subroutine write_vtu(grid, fields, text)
    type(grid_t), intent(in) :: grid
    type(vtu_field_t), intent(in) :: fields(:)
    character(:), allocatable, intent(out) :: text
    type(lines_t) :: lines
    character(12*8) :: row
    integer :: i

    call lines%add(vtu_start//' version="0.1" byte_order="LittleEndian"><UnstructuredGrid>')
    call lines%add('<Piece NumberOfPoints="'//str(size(grid%x, 2))//'" NumberOfCells="'// &
                   str(size(grid%element, 2))//'">')
    call lines%add('<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">')
    call add_vectors(lines, grid%x)
    call lines%add('</DataArray></Points>')
    call lines%add('<Cells><DataArray type="Int32" Name="connectivity" format="ascii">')
    do i = 1, size(grid%element, 2)
      write (row, '(*(i0, 1x))') grid%element(:, i) - 1
      call lines%add(trim(row))
    end do
    call lines%add('</DataArray><DataArray type="Int32" Name="offsets" format="ascii">')
    do i = 1, size(grid%element, 2)
      call lines%add(str(8*i))
    end do
    call lines%add('</DataArray><DataArray type="UInt8" Name="types" format="ascii">')
    do i = 1, size(grid%element, 2)
      call lines%add(quadratic_quadrilateral)
    end do
    call lines%add('</DataArray></Cells>')
    call lines%add('<CellData><DataArray type="Int32" Name="tooth" format="ascii">')
    do i = 1, size(grid%part)
      call lines%add(str(grid%part(i)))
    end do
    call lines%add('</DataArray></CellData><PointData>')
    do i = 1, size(fields)
      call lines%add('<DataArray type="Float64" Name="'//fields(i)%name//'" NumberOfComponents="'// &
                     trim(merge('3', '1', size(fields(i)%values, 1) == 2))//'" format="ascii">')
      call add_vectors(lines, fields(i)%values)
      call lines%add('</DataArray>')
    end do
    call lines%add('</PointData></Piece></UnstructuredGrid></VTKFile>')
    text = lines%text()
  end subroutine write_vtu

  !> Adds a row for each node; vectors get the third component that the format requires.
  pure subroutine add_vectors(lines, values)
    type(lines_t), intent(inout) :: lines
    real(dp), intent(in) :: values(:, :)
    character(24) :: word
    integer :: i, k, length

    do i = 1, size(values, 2)
      do k = 1, size(values, 1)
        call write_decimal(values(k, i), 9, word, length)
        call lines%put(word(:length)//' ')
      end do
      call lines%add(trim(merge('0', ' ', size(values, 1) == 2)))
    end do
  end subroutine add_vectors
end module gearsweep_elastic_vtu
