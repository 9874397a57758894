!> The task `mesh`: load sharing along the path of contact and the static transmission error with its harmonics.
module gearsweep_task_mesh
  use gearsweep_corner, only: touching_curvature
  use gearsweep_decimal, only: in_um
  use gearsweep_error, only: error_t
  use gearsweep_gear, only: drive
  use gearsweep_harmonics, only: find_harmonics, harmonics_t
  use gearsweep_interval, only: interval_t
  use gearsweep_kinds, only: dp, pi
  use gearsweep_lines, only: lines_t, right
  use gearsweep_memory, only: claim_memory
  use gearsweep_reader, only: reader_t
  use gearsweep_mesh, only: corner_uncertainty, coupling, mesh_t, own_corner_uncertainty
  use gearsweep_segments, only: balance_t, contact_intervals
  use gearsweep_sharing, only: share_load, sharing_t
  use gearsweep_table, only: axis, each, table_t
  use gearsweep_stages, only: runnable_t, stages_t
  use gearsweep_task, only: stage, task_info_t
  use gearsweep_text, only: fixed, str
  implicit none
  private
  public :: mesh_task_t

  type, extends(runnable_t) :: mesh_task_t
    integer :: harmonics = 8                     !< of the static transmission error
  contains
    procedure, nopass :: describe
    procedure :: read_keys, run, add_report
  end type mesh_task_t

  real(dp), parameter :: micro = 1e6_dp, milli = 1e3_dp
  character(*), parameter :: of_relief = 'amount of relief'

contains

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t('mesh', needs=[stage%mesh, stage%reliefs, stage%amounts], &
                       tables='mesh transmission_error harmonics compliance', fields='', &
                       gives='pair and mesh stiffness, load sharing, static transmission error and its harmonics')
  end subroutine describe

  !> In the group of the stiffness, which all tasks that need the mesh share.
  subroutine read_keys(self, reader, error)
    class(mesh_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    type(error_t), allocatable, intent(inout) :: error

    call reader%get('mesh', 'ste_harmonics', self%harmonics, error, tasks='mesh', at_least=1, at_most=1000, &
                    meaning='harmonics of the static transmission error in the table harmonics')
  end subroutine read_keys

  subroutine run(self, stages, error)
    class(mesh_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(error_t), allocatable, intent(inout) :: error
    integer, parameter :: samples = 200
    type(sharing_t), allocatable :: sharing(:)
    type(sharing_t) :: softer
    type(mesh_t) :: mesh
    type(interval_t), allocatable :: intervals(:)
    type(harmonics_t), allocatable :: ste(:)
    real(dp), allocatable :: corner(:)
    integer :: i

    allocate (corner(size(stages%motion)), source=0.0_dp)
    associate (motion => stages%motion)
      allocate (sharing(size(motion)), ste(size(motion)))
      do i = 1, size(motion)
        ! The first tells what the others take.
        if (i == 2) call claim_memory(size(motion)*(1000 + 24.0_dp*self%harmonics + size(sharing(1)%phase)* &
          (28.0_dp + 16*size(sharing(1)%s, 1))), '&relief amount_um: '//str(size(motion))//' reliefs', error)
        if (allocated(error)) return
        intervals = contact_intervals(motion(i)%mesh, balance_t(motion(i)%load))
        call share_load(motion(i)%mesh, motion(i)%load, samples, sharing(i), intervals)
        call find_harmonics(motion(i)%mesh, motion(i)%load, self%harmonics, ste(i))
        if (.not. stages%has_corners()) cycle
        mesh = motion(i)%mesh%with_softer_corners(merge(own_corner_uncertainty, corner_uncertainty, &
                                                        motion(i)%mesh%flattening%within > 0))
        call share_load(mesh, motion(i)%load, samples, softer, intervals)
        corner(i) = maxval(abs(softer%error - sharing(i)%error))
      end do
    end associate
    call fill_path(stages, sharing, self%tables(self%place('mesh')), error)
    call fill_ste(stages, sharing, ste, corner, self%tables(self%place('transmission_error')), error)
    call fill_harmonics(stages%amount, ste, self%tables(self%place('harmonics')), error)
    call fill_compliance(stages%motion(1)%mesh, sharing(1), self%tables(self%place('compliance')), error)
    self%is_done = .true.
    self%log = 'mesh: static load sharing and transmission error'
  end subroutine run

  !> One pair along its path of contact, static, for each relief: s ascends; where a pair enters, begins or ceases to
  !> carry, or a relief begins, both sides have a row.
  pure subroutine fill_path(stages, sharing, table, error)
    type(stages_t), intent(in) :: stages
    type(sharing_t), intent(in) :: sharing(:)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: s(:), values(:, :)
    integer :: i, j, k, n, row, rows

    rows = sum([(sum(sharing(i)%pairs), i=1, size(sharing))])
    call table%begin('one pair along its path of contact, static, for each relief', rows, error)
    if (allocated(error)) return
    allocate (values(rows, 7))
    row = 0
    do i = 1, size(sharing)
      associate (one => sharing(i), mesh => stages%motion(i)%mesh, relief_um => in_um(stages%amount(i)))
        do n = minval(one%offset), maxval(one%offset + one%pairs) - 1
          do k = 1, size(one%phase)
            j = 1 + n - one%offset(k)
            if (j < 1 .or. j > one%pairs(k)) cycle
            row = row + 1
            values(row, :) = [relief_um, one%s(j, k), mesh%stiffness%value(one%s(j, k))/micro, one%stiffness(k)/micro, &
                              micro*mesh%profile_error%value(one%s(j, k)), one%load(j, k)/stages%load, micro*one%error(k)]
          end do
        end do
      end associate
    end do
    s = values(:, 2)
    call table%add_index(axis('relief_um', 'um', of_relief, values(:, 1)))
    call table%add_index(axis('s', '', 'path coordinate of the pair, in base pitches from A; below 0 before A', s))
    call table%add('pair_stiffness_n_um', 'N/um', 'stiffness of this pair, whole face width; what the dynamics take', &
                   values(:, 3))
    call table%add('mesh_stiffness_n_um', 'N/um', 'of all pairs that carry load; of whole gears also their discs', values(:, 4))
    call table%add('profile_error_um', 'um', 'material missing at this point, both flanks together; beyond '// &
                   'A and E with the gap of the tip corner, along the line of action', values(:, 5))
    call table%add('load_share', '', 'static load of this pair over the whole load', values(:, 6))
    call table%add('ste_um', 'um', 'static transmission error along the line of action', values(:, 7))
    if (stages%base_pitch > 0) call table%add('path_mm', 'mm', 'distance from A on the line of action', milli*s*stages%base_pitch)
    if (.not. allocated(stages%pair)) return
    associate (pinion => touching_curvature(stages%pair, 1, s), gear => touching_curvature(stages%pair, 2, s))
      call table%add('pinion_radius_mm', 'mm', 'radius at which the pinion touches', &
                     milli*hypot(stages%pair%gear(1)%base_radius(drive), pinion))
      call table%add('pinion_curvature_mm', 'mm', 'radius of curvature of the pinion''s flank', milli*pinion)
      call table%add('gear_curvature_mm', 'mm', 'radius of curvature of the gear''s flank', milli*gear)
    end associate
  end subroutine fill_path

  !> The static transmission error over a mesh period, for each relief.
  pure subroutine fill_ste(stages, sharing, ste, corner, table, error)
    type(stages_t), intent(in) :: stages
    type(sharing_t), intent(in) :: sharing(:)
    type(harmonics_t), intent(in) :: ste(:)
    real(dp), intent(in) :: corner(:)            ! error of the transmission error from the tip corners' stiffness, m
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    integer :: i, m

    m = size(ste)
    call table%over('static transmission error and load sharing over a mesh period, for each relief', error, &
                    axis('relief_um', 'um', of_relief, in_um(stages%amount)))
    if (allocated(error)) return
    call table%add('peak_to_peak_um', 'um', 'largest less least transmission error', [(micro*ste(i)%peak_to_peak(), i=1, m)])
    call table%add('mean_um', 'um', 'mean transmission error', micro*ste%mean)
    call table%add('rms_um', 'um', 'root mean square of what differs from the mean', micro*ste%rms)
    call table%add('error_estimate_um', 'um', 'estimated error of mean and amplitudes, without rounding errors', &
                   micro*ste%error_estimate)
    call table%add('largest_load_share', '', 'largest load of a pair over the static load', &
                   [(maxval(sharing(i)%load)/stages%load, i=1, m)])
    call table%add('effective_contact_ratio', '', 'length of the path over which a pair carries load, in base pitches', &
                   [(ste(i)%effective_contact_ratio, i=1, m)])
    if (.not. stages%has_corners()) return
    call table%add('corner_estimate_um', 'um', 'what a tenth of the stiffness at a tip corner, with nonlinear_contact 3 % of '// &
                   'it, changes of the transmission error where it changes most: it is not known better', micro*corner)
  end subroutine fill_ste

  !> Harmonics of the static transmission error for each relief; harmonic 0 is the mean.
  pure subroutine fill_harmonics(amount, ste, table, error)
    real(dp), intent(in) :: amount(:)            ! of relief, m
    type(harmonics_t), intent(in) :: ste(:)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    integer :: i, n, m

    m = size(ste)
    n = size(ste(1)%amplitude) + 1
    call table%over('static transmission error for each relief, as the sum of amplitude '// &
                    'cos(2 pi harmonic tau + phase) over '// &
                    'the mesh phase tau, 0 where a pair enters at A; harmonic 0 is the mean', error, &
                    axis('relief_um', 'um', of_relief, in_um(amount)), &
                    axis('harmonic', '', '0 for the mean, 1, 2 ... up to ste_harmonics', [(i, i=0, n - 1)]))
    if (allocated(error)) return
    call table%add('amplitude_um', 'um', 'half of peak-to-peak; the mean for harmonic 0', &
                   [(micro*[ste(i)%mean, ste(i)%amplitude], i=1, m)])
    call table%add('phase_deg', 'deg', 'where the amplitude is larger than its error', &
                   [([0.0_dp, ste(i)%phase]*180/pi, i=1, m)])
    call table%add('error_estimate_um', 'um', 'estimated error of mean and amplitudes, without rounding errors', &
                   each(micro*ste%error_estimate, n))
  end subroutine fill_harmonics

  !> What a load on each pair moves each pair by, where pairs share a compliance: the matrix that the load sharing and the motion
  !> take, at the phases of the table mesh. It does not depend on the relief.
  pure subroutine fill_compliance(mesh, sharing, table, error)
    type(mesh_t), intent(in) :: mesh
    type(sharing_t), intent(in) :: sharing       !< for its phases, and the pairs that may be in contact
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: values(:, :), shared(:, :), matrix(:, :)
    integer :: i, j, k, row, rows

    if (.not. mesh%disc%shared > 0) return
    rows = sum(sharing%pairs**2)
    call table%begin('deflection of each pair under a unit load on each pair, over a mesh period', rows, error)
    if (allocated(error)) return
    allocate (values(rows, 4))
    row = 0
    do k = 1, size(sharing%phase)
      associate (n => sharing%pairs(k), s => sharing%s(:sharing%pairs(k), k))
        shared = reshape([(mesh%shared_from(s(j)), j=1, max(1, n - 1))], [3, max(1, n - 1)])
        matrix = coupling(mesh, [(mesh%stiffness%value(s(j)), j=1, n)], shared(1, :))
        do j = 1, n
          do i = 1, n
            row = row + 1
            values(row, :) = [sharing%phase(k), s(j), s(i), micro*matrix(i, j)]
          end do
        end do
      end associate
    end do
    call table%add_index(axis('mesh_phase', '', 'fraction of the mesh period, 0 where a pair enters at A; both sides of a break', &
                              values(:, 1)))
    call table%add_index(axis('loaded_s', '', 'path coordinate of the pair that is loaded, in base pitches from A', values(:, 2)))
    call table%add_index(axis('moved_s', '', 'path coordinate of the pair that is moved', values(:, 3)))
    call table%add('compliance_um_n', 'um/N', 'by how much it moves along the line of action under a unit load, both gears '// &
                   'together, as at the load of the case and without the turning of whole bodies', values(:, 4))
  end subroutine fill_compliance

  pure subroutine add_report(self, lines)
    class(mesh_task_t), intent(in) :: self
    type(lines_t), intent(inout) :: lines
    real(dp), parameter :: shown = 5e-5_dp
    logical :: one_carries_all
    integer :: i, k

    associate (ste => self%tables(self%place('transmission_error')), harmonics => self%tables(self%place('harmonics')))
      ! As it is where one pair is alone for a while; else the share is worth a column.
      one_carries_all = all(abs(ste%numbers('largest_load_share') - 1) < shown)
      call lines%add('')
      call lines%add('Static transmission error')
      call lines%put('   relief um   peak-to-peak um   mean um   harmonics 1, 2, 3 um')
      if (.not. one_carries_all) call lines%put('         largest pair load/static')
      call lines%add('')
      do i = 1, ste%rows
        call lines%put(right(str(ste%number('relief_um', i)), 12)//right(str(ste%number('peak_to_peak_um', i), 4), 18)// &
                       right(str(ste%number('mean_um', i), 4), 10)//'  ')
        associate (n => harmonics%extent(2))
          do k = 1, 3
            if (k >= n) call lines%put(repeat(' ', 9))
            if (k < n) call lines%put(right(str(harmonics%number('amplitude_um', (i - 1)*n + 1 + k), 3), 9))
          end do
        end associate
        if (.not. one_carries_all) call lines%put(right(fixed(ste%number('largest_load_share', i), 4), 26))
        call lines%add('')
      end do
    end associate
  end subroutine add_report
end module gearsweep_task_mesh
