!> The task `mesh`: load sharing along the path of contact and the static transmission error with its harmonics.
module gearsweep_study_tasks_mesh
  use gearsweep_base, only: axis, claim_memory, dp, each, error_t, fixed, lines_t, right, str, table_t
  use gearsweep_gear, only: drive, touching_curvature
  use gearsweep_elastic, only: on_second_grid
  use gearsweep_mesh, only: balance_t, contact_intervals, corner_uncertainty, coupling, find_harmonics, harmonics_t, interval_t, &
    mesh_t, own_corner_uncertainty, share_load, sharing_t, smooth_intervals, transmission_error
  use gearsweep_study_case_task, only: stage, task_info_t
  use gearsweep_study_reader_reader, only: reader_t
  use gearsweep_study_run_stages, only: runnable_t, stages_t
  implicit none
  private
  public :: mesh_task_t

  type, extends(runnable_t) :: mesh_task_t
    integer :: harmonics = 8                     !< number of harmonics of the static transmission error
  contains
    procedure, nopass :: describe
    procedure :: read_keys, run, add_report
  end type mesh_task_t

  character(*), parameter :: of_relief = 'amount of relief'

contains

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t('mesh', needs=[stage%mesh, stage%reliefs, stage%amounts], &
                       tables='mesh transmission_error harmonics compliance', fields='', &
                       summary='pair and mesh stiffness, load sharing, static transmission error and its harmonics')
  end subroutine describe

  !> Reads keys in the group of the stiffness, which all tasks that need the mesh use.
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
    real(dp), allocatable :: corner(:), grid(:, :)
    integer :: i, n, m

    allocate (corner(size(stages%motion)), source=0.0_dp)
    allocate (grid(2, size(stages%motion)), source=0.0_dp)
    associate (motion => stages%motion)
      allocate (sharing(size(motion)), ste(size(motion)))
      do i = 1, size(motion)
        ! The size of the first result is that of the others.
        if (i == 2) call claim_memory(size(motion)*(1000 + 24.0_dp*self%harmonics + size(sharing(1)%phase)* &
          (28.0_dp + 16*size(sharing(1)%s, 1))), '&relief amount_um: '//str(size(motion))//' reliefs', error)
        if (allocated(error)) return
        intervals = contact_intervals(motion(i)%mesh, balance_t(motion(i)%load))
        call share_load(motion(i)%mesh, motion(i)%load, samples, sharing(i), intervals)
        call find_harmonics(motion(i)%mesh, motion(i)%load, self%harmonics, ste(i))
        if (allocated(stages%second_grid)) grid(:, i) = ste_off_grid(stages, motion(i)%mesh, motion(i)%load)
        if (.not. stages%has_corners()) cycle
        mesh = motion(i)%mesh%with_softer_corners(merge(own_corner_uncertainty, corner_uncertainty, &
                                                        motion(i)%mesh%flattening%within > 0))
        call share_load(mesh, motion(i)%load, samples, softer, intervals)
        corner(i) = maxval(abs(softer%error - sharing(i)%error))
      end do
    end associate
    call fill_path(stages, sharing, self%tables(self%place('mesh')), error)
    call fill_ste(stages, sharing, ste, corner, grid, self%tables(self%place('transmission_error')), error)
    associate (table => self%tables(self%place('harmonics')))
      m = size(ste)
      n = size(ste(1)%amplitude) + 1
      call table%over('static transmission error for each relief, as the sum of amplitude '// &
                      'cos(2 pi harmonic tau + phase) over '// &
                      'the mesh phase tau, 0 where a pair enters at A; harmonic 0 is the mean', error, &
                      axis('relief_um', 'um', of_relief, stages%amount), &
                      axis('harmonic', '', '0 for the mean, 1, 2 ... up to ste_harmonics', [(i, i=0, n - 1)]))
      if (allocated(error)) return
      call table%add('amplitude_um', 'um', 'half of peak-to-peak; the mean for harmonic 0', &
                     [([ste(i)%mean, ste(i)%amplitude], i=1, m)])
      call table%add('phase_deg', 'deg', 'where the amplitude is larger than its error', [([0.0_dp, ste(i)%phase], i=1, m)])
      call table%add('error_estimate_um', 'um', 'estimated error of mean and amplitudes, without rounding errors', &
                     each([ste%error_estimate], n))
    end associate
    call fill_compliance(stages%motion(1)%mesh, sharing(1), self%tables(self%place('compliance')), error)
    self%is_done = .true.
    self%log = 'mesh: static load sharing and transmission error'
  end subroutine run

  !> Error on the grid over the difference to the second grid, for an error of second order, increased by half: on coarse grids the
  !> order is lower.
  pure real(dp) function error_share(stages)
    type(stages_t), intent(in) :: stages
    real(dp), parameter :: safety = 1.5_dp

    associate (section => stages%elements_inputs%options%section)
      associate (second => on_second_grid(section))
        error_share = safety/abs((real(section%elements_across, dp)/second%elements_across)**2 - 1)
      end associate
    end associate
  end function error_share

  !> Estimated relative error of the pair stiffness by its grid: the largest over the path.
  pure real(dp) function stiffness_off_grid(stages) result(part)
    type(stages_t), intent(in) :: stages
    integer, parameter :: places = 200
    integer :: i

    part = 0
    do i = 0, places
      associate (s => stages%mesh%contact_ratio*i/places)
        part = max(part, abs(stages%second_grid%stiffness%value(s)/stages%mesh%stiffness%value(s) - 1))
      end associate
    end do
    part = part*error_share(stages)
  end function stiffness_off_grid

  !> Estimated errors by the grid (m): of the mean transmission error, and an upper bound for peak-to-peak, rms and amplitudes.
  pure function ste_off_grid(stages, mesh, load) result(off)
    type(stages_t), intent(in) :: stages
    type(mesh_t), intent(in) :: mesh             ! mesh with its relief
    real(dp), intent(in) :: load
    real(dp) :: off(2)
    integer, parameter :: samples = 400
    type(mesh_t) :: second
    real(dp) :: apart(samples)

    second = mesh
    second%stiffness = stages%second_grid%stiffness
    second%disc = stages%second_grid%disc
    second%reach = stages%second_grid%reach
    apart = ste_over_period(second, load, samples) - ste_over_period(mesh, load, samples)
    off = error_share(stages)*[abs(sum(apart)/samples), maxval(apart) - minval(apart)]
  end function ste_off_grid

  !> Static transmission error (m) in the middles of equal parts of the mesh period.
  pure function ste_over_period(mesh, load, samples) result(error)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: load
    integer, intent(in) :: samples
    real(dp) :: error(samples)
    type(interval_t), allocatable :: intervals(:)
    integer :: i, k

    intervals = smooth_intervals(mesh, .false.)
    k = 1
    do i = 1, samples
      associate (phase => (i - 0.5_dp)/samples)
        do while (phase > intervals(k)%last)
          k = k + 1
        end do
        error(i) = transmission_error(mesh, intervals(k), load, phase)
      end associate
    end do
  end function ste_over_period

  !> Fills static values of one pair along its path of contact, for each relief: s ascends; where a pair enters, begins or ends to
  !> carry load, or a relief begins, both sides have a row.
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
      associate (one => sharing(i), mesh => stages%motion(i)%mesh, relief => stages%amount(i))
        do n = minval(one%offset), maxval(one%offset + one%pairs) - 1
          do k = 1, size(one%phase)
            j = 1 + n - one%offset(k)
            if (j < 1 .or. j > one%pairs(k)) cycle
            row = row + 1
            values(row, :) = [relief, one%s(j, k), mesh%stiffness%value(one%s(j, k)), one%stiffness(k), &
                              mesh%profile_error%value(one%s(j, k)), one%load(j, k)/stages%load, one%error(k)]
          end do
        end do
      end associate
    end do
    s = values(:, 2)
    call table%add_index(axis('relief_um', 'um', of_relief, values(:, 1)))
    call table%add_index(axis('s', '', 'path coordinate of the pair, in base pitches from A; below 0 before A', s))
    call table%add('pair_stiffness_n_um', 'N/um', 'stiffness of this pair, whole face width, as in the motion', &
                   values(:, 3))
    call table%add('mesh_stiffness_n_um', 'N/um', 'of all pairs that carry load; of whole gears also their discs', values(:, 4))
    call table%add('profile_error_um', 'um', 'material missing at this point, both flanks together; beyond '// &
                   'A and E with the gap of the tip corner, along the line of action', values(:, 5))
    call table%add('load_share', '', 'static load of this pair over the whole load', values(:, 6))
    call table%add('ste_um', 'um', 'static transmission error along the line of action', values(:, 7))
    if (allocated(stages%second_grid)) call table%add('pair_stiffness_estimate_n_um', 'N/um', 'estimated error of '// &
      'pair_stiffness_n_um by the grid of its finite elements', stiffness_off_grid(stages)*values(:, 3))
    if (stages%base_pitch > 0) call table%add('path_mm', 'mm', 'distance from A on the line of action', s*stages%base_pitch)
    if (.not. allocated(stages%pair)) return
    associate (pinion => touching_curvature(stages%pair, 1, s), gear => touching_curvature(stages%pair, 2, s))
      call table%add('pinion_radius_mm', 'mm', 'radius at which the pinion touches', &
                     hypot(stages%pair%gear(1)%base_radius(drive), pinion))
      call table%add('pinion_curvature_mm', 'mm', 'radius of curvature of the pinion''s flank', pinion)
      call table%add('gear_curvature_mm', 'mm', 'radius of curvature of the gear''s flank', gear)
    end associate
  end subroutine fill_path

  !> Fills the static transmission error over a mesh period, for each relief.
  pure subroutine fill_ste(stages, sharing, ste, corner, grid, table, error)
    type(stages_t), intent(in) :: stages
    type(sharing_t), intent(in) :: sharing(:)
    type(harmonics_t), intent(in) :: ste(:)
    real(dp), intent(in) :: corner(:)            ! error of the transmission error from the tip corners' stiffness, m
    real(dp), intent(in) :: grid(:, :)           ! grid errors of `ste_off_grid`, m; (2, relief)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    integer :: i, m

    m = size(ste)
    call table%over('static transmission error and load sharing over a mesh period, for each relief', error, &
                    axis('relief_um', 'um', of_relief, stages%amount))
    if (allocated(error)) return
    call table%add('peak_to_peak_um', 'um', 'peak-to-peak transmission error', [(ste(i)%peak_to_peak(), i=1, m)])
    call table%add('mean_um', 'um', 'mean transmission error', [ste%mean])
    call table%add('rms_um', 'um', 'root mean square deviation from the mean', [ste%rms])
    call table%add('error_estimate_um', 'um', 'estimated error of mean and amplitudes, without rounding errors', &
                   [ste%error_estimate])
    call table%add('largest_load_share', '', 'largest load of a pair over the static load', &
                   [(maxval(sharing(i)%load)/stages%load, i=1, m)])
    call table%add('effective_contact_ratio', '', 'length of the path over which a pair carries load, in base pitches', &
                   [(ste(i)%effective_contact_ratio, i=1, m)])
    if (allocated(stages%second_grid)) then
      call table%add('mean_grid_estimate_um', 'um', 'estimated error of mean_um by the grid of the finite elements', grid(1, :))
      call table%add('grid_estimate_um', 'um', 'by how much their grid changes peak_to_peak_um at most, estimated; rms and '// &
                     'amplitudes by less', grid(2, :))
    end if
    if (.not. stages%has_corners()) return
    call table%add('corner_estimate_um', 'um', 'what a tenth of the stiffness at a tip corner, with nonlinear_contact 3 % of '// &
                   'it, changes of the transmission error where it changes most: it is not known better', corner)
  end subroutine fill_ste

  !> Fills the deflection of each pair under a load on each other one, if pairs share a compliance: the matrix of the load sharing
  !> and of the motion, at the phases of the table mesh. It does not depend on the relief.
  pure subroutine fill_compliance(mesh, sharing, table, error)
    type(mesh_t), intent(in) :: mesh
    type(sharing_t), intent(in) :: sharing       !< load sharing, with its phases and the pairs that may be in contact
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
            values(row, :) = [sharing%phase(k), s(j), s(i), matrix(i, j)]
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
      ! One pair carries all load for a while; otherwise the share has a column.
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
      if (ste%position('grid_estimate_um') > 0) call lines%add('   the grid of the finite elements leaves up to '// &
        str(maxval(ste%numbers('grid_estimate_um')), 2)//' um of peak-to-peak and '// &
        str(maxval(ste%numbers('mean_grid_estimate_um')), 2)//' um of the mean, estimated')
    end associate
  end subroutine add_report
end module gearsweep_study_tasks_mesh
