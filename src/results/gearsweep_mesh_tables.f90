!> Tables of the task `mesh`: load sharing along the path of contact and the static transmission error.
module gearsweep_mesh_tables
  use gearsweep_decimal, only: in_um
  use gearsweep_error, only: error_t
  use gearsweep_kinds, only: dp, pi
  use gearsweep_study, only: study_t
  use gearsweep_table, only: each, over_and_over, table_t
  implicit none
  private
  public :: mesh_table, transmission_error_table, harmonics_table

  real(dp), parameter :: micro = 1e6_dp, milli = 1e3_dp
  character(*), parameter :: of_relief = 'amount of relief'

contains

  !> One pair along its path of contact, static, for each relief: s ascends; where a pair enters or a relief begins, both
  !> sides have a row.
  pure subroutine mesh_table(study, table, error)
    type(study_t), intent(in) :: study
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: s(:), values(:, :)
    integer :: i, j, k, n, row, rows

    if (.not. allocated(study%sharing)) return
    rows = sum([(sum(study%sharing(i)%pairs), i=1, size(study%sharing))])
    call table%begin('one pair along its path of contact, static, for each relief', rows, 18, error)
    if (allocated(error)) return
    allocate (values(rows, 7))
    row = 0
    do i = 1, size(study%sharing)
      associate (sharing => study%sharing(i), mesh => study%motion(i)%mesh, relief_um => in_um(study%case%amount(i)))
        do n = minval(sharing%offset), maxval(sharing%offset + sharing%pairs) - 1
          do k = 1, size(sharing%phase)
            j = 1 + n - sharing%offset(k)
            if (j < 1 .or. j > sharing%pairs(k)) cycle
            row = row + 1
            values(row, :) = [relief_um, sharing%s(j, k), mesh%stiffness%value(sharing%s(j, k))/micro, &
                              sharing%stiffness(k)/micro, micro*mesh%profile_error%value(sharing%s(j, k)), &
                              sharing%load(j, k)/study%load, micro*sharing%error(k)]
          end do
        end do
      end associate
    end do
    s = values(:, 2)
    call table%add_index('relief_um', 'um', of_relief, values(:, 1))
    call table%add_index('s', '', 'path coordinate of the pair, in base pitches from A; below 0 before A', s)
    call table%add('pair_stiffness_n_um', 'N/um', 'stiffness of this pair, whole face width; what the dynamics take', &
                   values(:, 3))
    call table%add('mesh_stiffness_n_um', 'N/um', 'of all pairs that carry load; of whole gears also their discs', values(:, 4))
    call table%add('profile_error_um', 'um', 'material missing at this point, both flanks together', values(:, 5))
    call table%add('load_share', '', 'static load of this pair over the whole load', values(:, 6))
    call table%add('ste_um', 'um', 'static transmission error along the line of action', values(:, 7))
    if (study%base_pitch > 0) call table%add('path_mm', 'mm', 'distance from A on the line of action', milli*s*study%base_pitch)
    if (.not. allocated(study%pair)) return
    call table%add('pinion_radius_mm', 'mm', 'radius at which the pinion touches', milli*study%pair%radius(1, s))
    call table%add('pinion_curvature_mm', 'mm', 'radius of curvature of the pinion''s flank', milli*study%pair%curvature(1, s))
    call table%add('gear_curvature_mm', 'mm', 'radius of curvature of the gear''s flank', milli*study%pair%curvature(2, s))
  end subroutine mesh_table

  !> The static transmission error over a mesh period, for each relief.
  pure subroutine transmission_error_table(study, table, error)
    type(study_t), intent(in) :: study
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    integer :: i, m

    if (.not. allocated(study%harmonics)) return
    associate (ste => study%harmonics)
      m = size(ste)
      call table%begin('static transmission error and load sharing over a mesh period, for each relief', &
                     m, 7, error, extent=[m])
      if (allocated(error)) return
      call table%add_index('relief_um', 'um', of_relief, in_um(study%case%amount))
      call table%add('peak_to_peak_um', 'um', 'largest less least transmission error', [(micro*ste(i)%peak_to_peak(), i=1, m)])
      call table%add('mean_um', 'um', 'mean transmission error', micro*ste%mean)
      call table%add('rms_um', 'um', 'root mean square of what differs from the mean', micro*ste%rms)
      call table%add('error_estimate_um', 'um', 'estimated error of mean and amplitudes, without rounding errors', &
                     micro*ste%error_estimate)
      call table%add('largest_load_share', '', 'largest load of a pair over the static load', &
                     [(maxval(study%sharing(i)%load)/study%load, i=1, m)])
      call table%add('effective_contact_ratio', '', 'length of the path over which a pair carries load, in base pitches', &
                     [(ste(i)%effective_contact_ratio, i=1, m)])
    end associate
  end subroutine transmission_error_table

  !> Harmonics of the static transmission error for each relief; harmonic 0 is the mean.
  pure subroutine harmonics_table(study, table, error)
    type(study_t), intent(in) :: study
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    integer :: i, n, m

    if (.not. allocated(study%harmonics)) return
    associate (ste => study%harmonics)
      m = size(ste)
      n = study%case%harmonics + 1
      call table%begin('static transmission error for each relief, as the sum of amplitude '// &
                       'cos(2 pi harmonic tau + phase) over '// &
                       'the mesh phase tau, 0 where a pair enters at A; harmonic 0 is the mean', n*m, 5, error, extent=[m, n])
      if (allocated(error)) return
      call table%add_index('relief_um', 'um', of_relief, each(in_um(study%case%amount), n))
      call table%add_index('harmonic', '', '0 for the mean, 1, 2 ... up to ste_harmonics', over_and_over([(i, i=0, n - 1)], m))
      call table%add('amplitude_um', 'um', 'half of peak-to-peak; the mean for harmonic 0', &
                     [(micro*[ste(i)%mean, ste(i)%amplitude], i=1, m)])
      call table%add('phase_deg', 'deg', 'where the amplitude is larger than its error', &
                     [([0.0_dp, ste(i)%phase]*180/pi, i=1, m)])
      call table%add('error_estimate_um', 'um', 'estimated error of mean and amplitudes, without rounding errors', &
                     each(micro*ste%error_estimate, n))
    end associate
  end subroutine harmonics_table
end module gearsweep_mesh_tables
