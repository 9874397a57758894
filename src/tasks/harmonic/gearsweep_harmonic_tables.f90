!> What the task `harmonic` finds, as its tables.
module gearsweep_harmonic_tables
  use gearsweep_error, only: error_t
  use gearsweep_frequency_response, only: find_peak, response_to
  use gearsweep_kinds, only: dp, pi
  use gearsweep_memory, only: claim_memory
  use gearsweep_table, only: axis, each, table_t
  use gearsweep_text, only: str
  use gearsweep_tooth_modes, only: along, moved_x, moved_y, per_point, tooth_modes_t
  implicit none
  private
  public :: steady_load_t, fill_response, fill_resonances, fill_speeds

  !> A load of steady frequency on a tooth.
  type :: steady_load_t
    real(dp) :: amplitude = 0                    !< N
    real(dp), allocatable :: s(:)                !< places, path coordinates
    real(dp), allocatable :: tangent(:)          !< points of the fillets that are looked at, rad
    real(dp) :: modulus = 0                      !< stress along a free surface over the strain along it, Pa
    real(dp) :: error_share = 0                  !< of the difference of both grids, as in gearsweep_section_body
  end type steady_load_t

  character(*), parameter :: of_s = 'path coordinate of the load, in base pitches from A', &
    of_tangent = 'angle of the fillet''s tangent at this point to the tooth''s axis', of_side = 'drive (the loaded side) or coast'
  character(*), parameter :: ahead = 'by how much it runs ahead of the load', of_mode = 'from the lowest frequency'
  character(*), parameter :: sides(2) = [character(5) :: 'drive', 'coast']
  real(dp), parameter :: degree = pi/180, micro = 1e6_dp, mega = 1e-6_dp

contains

  !> Amplitudes and phases at each place of the load, point, side and frequency. `tooth(2)`: on both grids, the finer first.
  subroutine fill_response(load, tooth, angular, table, error)
    type(steady_load_t), intent(in) :: load
    type(tooth_modes_t), intent(in) :: tooth(2)
    real(dp), intent(in) :: angular(:)           !< rad/s
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    complex(dp), allocatable, dimension(:, :, :, :) :: seen, coarse  ! (frequency, quantity, point, place)
    real(dp), allocatable :: stress(:)
    integer :: n, points, places

    if (allocated(error)) return
    points = 2*size(load%tangent)
    places = size(load%s)
    n = size(angular)
    call claim_memory(8.0_dp*n*points*places*(4*per_point + 14), '&harmonic frequency_hz: '//str(n)//' frequencies', error)
    if (allocated(error)) return
    call find_amplitudes(tooth(1), places, points, angular, seen)
    call find_amplitudes(tooth(2), places, points, angular, coarse)
    call table%over('stress, strain and displacement at points of the fillets over the frequency of the load', error, &
                    axis('s', '', of_s, load%s), &
                    axis('tangent_deg', 'deg', of_tangent, load%tangent/degree), axis('side', '', of_side, sides), &
                    axis('frequency_hz', 'Hz', 'frequency of the load', angular/(2*pi)))
    if (allocated(error)) return
    stress = load%amplitude*reshape(abs(seen(:, along, :, :)), [n*points*places])
    call table%add('stress_mpa', 'MPa', 'amplitude of the stress along the surface', mega*stress)
    call table%add('stress_phase_deg', 'deg', ahead, flat(phase(seen(:, along, :, :))/degree))
    call table%add('strain_um_m', 'um/m', 'amplitude of the strain along the surface', micro*stress/load%modulus)
    call table%add('displacement_x_um', 'um', 'amplitude of the displacement across the tooth', &
                   micro*load%amplitude*flat(abs(seen(:, moved_x, :, :))))
    call table%add('phase_x_deg', 'deg', ahead, flat(phase(seen(:, moved_x, :, :))/degree))
    call table%add('displacement_y_um', 'um', 'amplitude of the displacement along the tooth''s axis', &
                   micro*load%amplitude*flat(abs(seen(:, moved_y, :, :))))
    call table%add('phase_y_deg', 'deg', ahead, flat(phase(seen(:, moved_y, :, :))/degree))
    call table%add('error_estimate', '', 'estimated discretisation error of the stress at this frequency, relative', &
                   flat(off_by(seen(:, along, :, :), coarse(:, along, :, :), load%error_share)))
  end subroutine fill_response

  !> Of a load of 1 N.
  pure subroutine find_amplitudes(tooth, places, points, angular, seen)
    type(tooth_modes_t), intent(in) :: tooth
    integer, intent(in) :: places, points
    real(dp), intent(in) :: angular(:)
    complex(dp), allocatable, intent(out) :: seen(:, :, :, :)
    integer :: i, k, rows(per_point*points)

    rows = [(tooth%row_of(1) + i, i=1, size(rows))]
    allocate (seen(size(angular), per_point, points, places))
    do i = 1, places
      do k = 1, size(angular)
        seen(k, :, :, i) = reshape(response_to(tooth%model, rows, i, angular(k)), [per_point, points])
      end do
    end do
  end subroutine find_amplitudes

  !> -pi to pi; 0 of nothing.
  elemental real(dp) function phase(amplitude)
    complex(dp), intent(in) :: amplitude

    phase = 0
    if (abs(amplitude) > 0) phase = atan2(aimag(amplitude), real(amplitude, dp))
  end function phase

  !> The discretisation error that two grids leave, relative.
  elemental real(dp) function off_by(fine, coarse, error_share)
    complex(dp), intent(in) :: fine, coarse
    real(dp), intent(in) :: error_share

    off_by = abs(fine - coarse)/max(abs(fine), tiny(1.0_dp))*error_share
  end function off_by

  pure function flat(values)
    real(dp), intent(in) :: values(:, :, :)
    real(dp) :: flat(size(values))

    flat = reshape(values, [size(values)])
  end function flat

  !> Where each mode peaks in the stress at each point. `frequency_error(:)`: of the natural frequencies, relative.
  subroutine fill_resonances(load, tooth, frequency_error, table, error)
    type(steady_load_t), intent(in) :: load
    type(tooth_modes_t), intent(in) :: tooth(2)
    real(dp), intent(in) :: frequency_error(:)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable, dimension(:) :: peak, largest, at_rest, coarse
    integer :: i, k, m, n, points, places, row

    if (allocated(error)) return
    points = 2*size(load%tangent)
    places = size(load%s)
    m = size(tooth(1)%model%frequency)
    allocate (peak(m*points*places), largest(m*points*places), at_rest(m*points*places), coarse(m*points*places))
    n = 0
    do i = 1, places
      do k = 1, points*m
        n = n + 1
        associate (point => 1 + (k - 1)/m, mode => 1 + modulo(k - 1, m))
          row = tooth(1)%row_of(point) + along
          peak(n) = find_peak(tooth(1)%model, row, i, mode)
          largest(n) = size_at(tooth(1), row, i, peak(n))
          at_rest(n) = abs(tooth(1)%model%static(row, i))
          row = tooth(2)%row_of(point) + along
          coarse(n) = size_at(tooth(2), row, i, find_peak(tooth(2)%model, row, i, mode))
        end associate
      end do
    end do
    call table%over('where each mode of the section peaks in the stress at points of the fillets', error, &
                    axis('s', '', of_s, load%s), &
                    axis('tangent_deg', 'deg', of_tangent, load%tangent/degree), axis('side', '', of_side, sides), &
                    axis('mode', '', of_mode, [(i, i=1, m)]))
    if (allocated(error)) return
    associate (w => tooth(1)%model%frequency, c => tooth(1)%model%damping)
      call table%add('natural_frequency_hz', 'Hz', 'natural frequency', table%along(4, w/(2*pi)))
      call table%add('frequency_error', '', 'its estimated discretisation error, relative', &
                     table%along(4, frequency_error))
      call table%add('damping_ratio', '', 'damping ratio of the mode', table%along(4, c/(2*w)))
      call table%add('peak_frequency_hz', 'Hz', 'frequency of the load at which the stress is largest about this mode', &
                     peak/(2*pi))
      call table%add('stress_mpa', 'MPa', 'amplitude of the stress along the surface there', mega*load%amplitude*largest)
      call table%add('amplification', '', 'the same over that under the load at rest', largest/at_rest)
      call table%add('error_estimate', '', 'estimated discretisation error of this stress, relative', &
                     abs(coarse/largest - 1)*load%error_share)
    end associate
  end subroutine fill_resonances

  pure real(dp) function size_at(tooth, row, place, angular)
    type(tooth_modes_t), intent(in) :: tooth
    integer, intent(in) :: row, place
    real(dp), intent(in) :: angular

    size_at = maxval(abs(response_to(tooth%model, [row], place, angular)))
  end function size_at

  !> Speeds at which harmonics of the mesh frequency meet natural frequencies (Hz): of the gears on the mesh, the first one, and
  !> of the section, the others. `teeth`: of the pinion.
  subroutine fill_speeds(frequency, teeth, harmonics, table, error)
    real(dp), intent(in) :: frequency(:)
    integer, intent(in) :: teeth, harmonics
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    character(7), parameter :: systems(2) = [character(7) :: 'gears', 'section']
    integer, allocatable :: mode(:)
    integer :: i, k, n

    if (allocated(error)) return
    n = size(frequency)
    mode = [1, (i, i=1, n - 1)]
    call table%begin('speeds at which harmonics of the mesh frequency meet natural frequencies', n*harmonics, error)
    if (allocated(error)) return
    call table%add_index(axis('system', '', 'gears: both gears on the mean mesh stiffness; section: the teeth of one gear', &
                              systems(each([(merge(1, 2, i == 1), i=1, n)], harmonics))))
    call table%add_index(axis('mode', '', of_mode, each(mode, harmonics)))
    call table%add_index(axis('harmonic', '', 'of the mesh frequency', [((k, k=1, harmonics), i=1, n)]))
    call table%add('frequency_hz', 'Hz', 'natural frequency', each(frequency, harmonics))
    call table%add('rpm', '1/min', 'speed of the pinion at which this harmonic meets it', &
                   each(60*frequency/teeth, harmonics)/[((k, k=1, harmonics), i=1, n)])
  end subroutine fill_speeds
end module gearsweep_harmonic_tables
