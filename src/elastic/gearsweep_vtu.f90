!> Grids and fields for ParaView and its kin (VTK's unstructured XML format), as text.
module gearsweep_vtu
  use gearsweep_kinds, only: dp
  use gearsweep_decimal, only: write_decimal
  use gearsweep_grid, only: grid_t
  use gearsweep_lines, only: lines_t
  implicit none
  private
  public :: vtu_field_t, vtu_text

  !> Values at the nodes: one component, or two for vectors (components, nodes).
  type :: vtu_field_t
    character(:), allocatable :: name
    real(dp), allocatable :: values(:, :)
  end type vtu_field_t

  character(*), parameter :: quadratic_quadrilateral = '23'

contains

  !> The grid with its fields; lengths in m, cells carry the tooth they belong to.
  pure function vtu_text(grid, fields) result(text)
    type(grid_t), intent(in) :: grid
    type(vtu_field_t), intent(in) :: fields(:)
    character(:), allocatable :: text
    type(lines_t) :: lines
    integer :: i

    call lines%add('<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian"><UnstructuredGrid>')
    call lines%add('<Piece NumberOfPoints="'//whole([size(grid%x, 2)])//'" NumberOfCells="'// &
                   whole([size(grid%element, 2)])//'">')
    call lines%add('<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">')
    call add_vectors(lines, grid%x)
    call lines%add('</DataArray></Points>')
    call lines%add('<Cells><DataArray type="Int32" Name="connectivity" format="ascii">')
    do i = 1, size(grid%element, 2)
      call lines%add(whole(grid%element(:, i) - 1))
    end do
    call lines%add('</DataArray><DataArray type="Int32" Name="offsets" format="ascii">')
    do i = 1, size(grid%element, 2)
      call lines%add(whole([8*i]))
    end do
    call lines%add('</DataArray><DataArray type="UInt8" Name="types" format="ascii">')
    do i = 1, size(grid%element, 2)
      call lines%add(quadratic_quadrilateral)
    end do
    call lines%add('</DataArray></Cells>')
    call lines%add('<CellData><DataArray type="Int32" Name="tooth" format="ascii">')
    do i = 1, size(grid%part)
      call lines%add(whole([grid%part(i)]))
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
  end function vtu_text

  !> A row a node; vectors get the third component that the format's readers expect.
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

  pure function whole(numbers) result(words)
    integer, intent(in) :: numbers(:)
    character(:), allocatable :: words
    character(12*size(numbers)) :: row

    write (row, '(*(i0, 1x))') numbers
    words = trim(row)
  end function whole
end module gearsweep_vtu
