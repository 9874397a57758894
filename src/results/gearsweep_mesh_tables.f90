!> Tables of the task `mesh`: load sharing along the path of contact and the static transmission error.
module gearsweep_mesh_tables
  use gearsweep_decimal, only: in_um
  use gearsweep_error, only: error_t
  use gearsweep_kinds, only: dp, pi
  use gearsweep_study, only: study_t
  use gearsweep_table, only: each, over_and_over, table_t
  implicit none
  private
  public :: mesh_table, harmonics_table

  real(dp), parameter :: micro = 1e6_dp, milli = 1e3_dp

contains

  !> One pair along its path of contact, static, for each relief: s ascends; where a pair enters or a relief begins, both
  !> sides have a row.
  pure subroutine mesh_table(study, table, error)
    type(study_t), intent(in) :: study
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: s(:), values(:, :)
    integer :: i, j, k, row, rows

    if (.not. allocated(study%sharing)) return
    rows = sum([(sum(study%sharing(i)%pairs), i=1, size(study%sharing))])
    call table%begin('mesh', 'one pair along the path of contact, static', rows, 18, error)
    if (allocated(error)) return
    allocate (values(rows, 7))
    row = 0
    do i = 1, size(study%sharing)
      associate (sharing => study%sharing(i), mesh => study%motion(i)%mesh, relief_um => in_um(study%case%amount(i)))
        do j = 1, maxval(sharing%pairs)
          do k = 1, size(sharing%phase)
            if (sharing%pairs(k) < j) cycle
            row = row + 1
            values(row, :) = [relief_um, sharing%s(j, k), mesh%stiffness%value(sharing%s(j, k))/micro, &
                              sharing%stiffness(k)/micro, micro*mesh%profile_error%value(sharing%s(j, k)), &
                              sharing%load(j, k)/study%load, micro*sharing%error(k)]
          end do
        end do
      end associate
    end do
    s = values(:, 2)
    call table%add_index('relief_um', 'um', 'tip relief, as amount_um of the case', values(:, 1))
    call table%add_index('s', '', 'path coordinate of the pair from A, in base pitches', s)
    call table%add('pair_stiffness_n_um', 'N/um', 'stiffness of this pair, over the whole face width', values(:, 3))
    call table%add('mesh_stiffness_n_um', 'N/um', 'of the pairs that carry load and of whole gears'' discs', values(:, 4))
    call table%add('profile_error_um', 'um', 'what the relief takes off the pair here', values(:, 5))
    call table%add('load_share', '', 'load of this pair over the static load', values(:, 6))
    call table%add('ste_um', 'um', 'static transmission error', values(:, 7))
    if (study%base_pitch > 0) call table%add('path_mm', 'mm', 'path coordinate from A', milli*s*study%base_pitch)
    if (.not. allocated(study%pair)) return
    call table%add('pinion_radius_mm', 'mm', 'radius at which the pinion touches', milli*study%pair%radius(1, s))
    call table%add('pinion_curvature_mm', 'mm', 'radius of curvature of its flank', milli*study%pair%curvature(1, s))
    call table%add('gear_curvature_mm', 'mm', 'radius of curvature of the gear''s flank', milli*study%pair%curvature(2, s))
  end subroutine mesh_table

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
      call table%begin('harmonics', 'static transmission error as the sum of amplitude cos(2 pi harmonic tau + phase) over '// &
                       'the mesh phase tau, 0 where a pair enters at A; harmonic 0 is the mean', n*m, 5, error, extent=[m, n])
      if (allocated(error)) return
      call table%add_index('relief_um', 'um', 'tip relief, as amount_um of the case', each(in_um(study%case%amount), n))
      call table%add_index('harmonic', '', 'of the mesh frequency; 0: the mean', over_and_over([(i, i=0, n - 1)], m))
      call table%add('amplitude_um', 'um', 'amplitude of the harmonic', [(micro*[ste(i)%mean, ste(i)%amplitude], i=1, m)])
      call table%add('phase_deg', 'deg', 'phase of the harmonic', [([0.0_dp, ste(i)%phase]*180/pi, i=1, m)])
      call table%add('error_estimate_um', 'um', 'estimated error of the amplitudes', each(micro*ste%error_estimate, n))
    end associate
  end subroutine harmonics_table
end module gearsweep_mesh_tables
