!> The task `transient`: stress and displacement at the fillets of one tooth while the load passes over it, by modal
!> superposition.
module gearsweep_study_tasks_transient
  use gearsweep_base, only: axis, claim_memory, code_input, code_memory, dp, error_t, fail, lines_t, no_number, str, table_t, &
    wants_stop
  use gearsweep_elastic, only: along, moved_x, moved_y, per_point, stress_error_share, stress_peak_t, tooth_modes_t
  use gearsweep_motion, only: has_result, mesh_period, response_t, status_ok
  use gearsweep_rating, only: follow_tooth, load_places, sampling_t, pass_path, pass_static, passage_options_t, passage_t, &
    place_radius, shared_by_mesh, shared_equally, shares_stated, spaced_on_flank, spaced_on_path, tooth_transient_t
  use gearsweep_study_case_task, only: case_facts_t, check_reliefs, needs_moving, stage, task_info_t
  use gearsweep_study_reader_reader, only: first_nonblank, is_prescribed, needs_gears, reader_t, sentence_length, text_unless
  use gearsweep_study_run_points, only: add_several, find_motion, known_count, of_motions, of_relief, of_speed, of_status, &
    words_of
  use gearsweep_study_run_stages, only: runnable_t, stages_t
  use gearsweep_study_run_unit_teeth, only: find_unit_teeth, tooth_choice_t
  implicit none
  private
  public :: tooth_run_t, fill_histories, fill_points, fill_peaks, transient_task_t

  !> One passage of the load.
  type :: tooth_run_t
    real(dp) :: relief = 0, rpm = 0              !< amount of relief, m, and speed, 1/min
    integer :: status = status_ok                !< status of the motion whose load it is
    integer :: motions = 0                       !< number of motions; 0: not known, or a static load
    type(tooth_transient_t) :: tooth             !< empty if the motion did not converge
  end type tooth_run_t

  !> Columns of a row over time; the error is that of the stress.
  integer, parameter :: highest = 1, when_highest = 2, lowest = 3, when_lowest = 4, largest = 5, largest_at_rest = 6, &
    estimate = 7
  !> Quantities of `history_of` beside those of a point.
  integer, parameter :: times = -1, places = -2, loads = -3, at_rest = -4
  character(*), parameter :: sides(2) = [character(5) :: 'drive', 'coast']
  character(*), parameter :: of_tangent = 'angle of the fillet''s tangent at this point to the tooth''s axis', &
    of_side = 'drive (the loaded side: tension) or coast'

  integer, parameter :: shared_by_motion = 3
  !> Direction of the load over the flank: that of a driving pinion, or as stated.
  integer, parameter :: driving = 0, inwards = 1, outwards = 2

  type, extends(runnable_t) :: transient_task_t
    type(tooth_choice_t) :: choice               !< modes, damping and points
    type(passage_options_t) :: passage
    type(sampling_t) :: look
    integer :: travel = driving
  contains
    procedure, nopass :: describe
    procedure :: read_keys, run, add_report
    procedure :: check, uses
    procedure, private :: read_load, pass
  end type transient_task_t

  character(*), parameter :: group = 'transient'
  integer, parameter :: stages_needed(*) = [stage%geometry, stage%section, stage%body, stage%mesh, stage%reliefs, &
                                            stage%amounts, stage%motion, stage%losses, stage%accuracy]
  integer, parameter :: most_passages = 10000

contains

  !> Fills stress and displacement at the chosen points over time.
  !>
  !> `runs`: one for each relief and speed, speeds first. `tangent`: of the chosen points, rad. `poisson`: Poisson's ratio in plane
  !> strain, 0 in plane stress.
  pure subroutine fill_histories(runs, tooth, tangent, poisson, table, error)
    type(tooth_run_t), intent(in) :: runs(:)
    type(tooth_modes_t), intent(in) :: tooth
    real(dp), intent(in) :: tangent(:), poisson
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    integer :: i, k, n, points

    if (allocated(error)) return
    points = 2*size(tangent)
    call table%begin('stress and displacement at points of the fillets while the load passes', &
                     sum([(samples_of(runs(i)), i=1, size(runs))])*points, error)
    if (allocated(error)) return
    associate (run => [((i, k=1, points*samples_of(runs(i))), i=1, size(runs))], &
               point => [(((k, n=1, samples_of(runs(i))), k=1, points), i=1, size(runs))])
      call table%add_index(axis('relief_um', 'um', of_relief, [runs(run)%relief]))
      call table%add_index(axis('rpm', '1/min', of_speed, [runs(run)%rpm]))
      call table%add_index(axis('tangent_deg', 'deg', of_tangent, tangent((point + 1)/2)))
      call table%add_index(axis('side', '', of_side, sides(2 - modulo(point, 2))))
      call table%add_index(axis('time_ms', 'ms', 'time since the load met the tooth', &
                                [((history_of(runs(i), times), k=1, points), i=1, size(runs))]))
      call table%add('s', '', 'path coordinate of the load, in base pitches from A', [((history_of(runs(i), places), k=1, points), &
                                                                                      i=1, size(runs))])
      call table%add('load_n', 'N', 'load on the tooth', [((history_of(runs(i), loads), k=1, points), i=1, size(runs))])
      associate (sigma => [((history_of(runs(i), along, k), k=1, points), i=1, size(runs))])
        call add_stress(sigma, tooth%direction(:, point), poisson, table)
      end associate
      call table%add('static_mpa', 'MPa', 'stress along the surface under the same load at rest', &
                     [((history_of(runs(i), at_rest, k), k=1, points), i=1, size(runs))])
      call table%add('displacement_x_um', 'um', 'displacement across the tooth, to its drive side', &
                     [((history_of(runs(i), moved_x, k), k=1, points), i=1, size(runs))])
      call table%add('displacement_y_um', 'um', 'displacement along the tooth''s axis', &
                     [((history_of(runs(i), moved_y, k), k=1, points), i=1, size(runs))])
    end associate
  end subroutine fill_histories

  !> Fills the largest values at each chosen point over time; each relief has `speeds` runs.
  pure subroutine fill_points(runs, tooth, tangent, speeds, poisson, table, error)
    type(tooth_run_t), intent(in) :: runs(:)
    type(tooth_modes_t), intent(in) :: tooth
    real(dp), intent(in) :: tangent(:), poisson
    integer, intent(in) :: speeds
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    integer :: i, k, points

    if (allocated(error)) return
    points = 2*size(tangent)
    call table%begin('the largest stress and displacement at points of the fillets while the load passes', size(runs)*points, &
                     error, extent=[size(runs)/speeds, speeds, size(tangent), 2])
    if (allocated(error)) return
    associate (run => [((i, k=1, points), i=1, size(runs))], point => [((k, k=1, points), i=1, size(runs))])
      call table%add_index(axis('relief_um', 'um', of_relief, [runs(run)%relief]))
      call table%add_index(axis('rpm', '1/min', of_speed, [runs(run)%rpm]))
      call table%add_index(axis('tangent_deg', 'deg', of_tangent, tangent((point + 1)/2)))
      call table%add_index(axis('side', '', of_side, sides(2 - modulo(point, 2))))
      call table%add('highest_mpa', 'MPa', 'highest stress along the surface', of_points(runs, tooth, points, along, highest))
      call table%add('highest_ms', 'ms', 'when', of_points(runs, tooth, points, along, when_highest))
      call table%add('lowest_mpa', 'MPa', 'lowest stress along the surface', of_points(runs, tooth, points, along, lowest))
      call table%add('lowest_ms', 'ms', 'when', of_points(runs, tooth, points, along, when_lowest))
      call add_stress(of_points(runs, tooth, points, along, largest), tooth%direction(:, point), poisson, table, &
                      'where it is largest in size: ')
      call table%add('static_mpa', 'MPa', 'stress along the surface, the largest in size with the load at rest', &
                     of_points(runs, tooth, points, along, largest_at_rest))
      call table%add('displacement_x_um', 'um', 'displacement across the tooth, to its drive side, the largest in size', &
                     of_points(runs, tooth, points, moved_x, largest))
      call table%add('displacement_y_um', 'um', 'displacement along the tooth''s axis, the largest in size', &
                     of_points(runs, tooth, points, moved_y, largest))
      call table%add('error_estimate', '', 'estimated discretisation error of the largest stress, relative', &
                     of_points(runs, tooth, points, along, estimate))
    end associate
  end subroutine fill_points

  !> Fills the largest values of the fillets, at any point.
  pure subroutine fill_peaks(runs, speeds, poisson, table, error)
    type(tooth_run_t), intent(in) :: runs(:)
    real(dp), intent(in) :: poisson
    integer, intent(in) :: speeds
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    type(stress_peak_t) :: high(size(runs)), low(size(runs))

    if (allocated(error)) return
    call table%begin('the largest stress in the root fillets while the load passes', size(runs), error, &
                     extent=[size(runs)/speeds, speeds])
    if (allocated(error)) return
    high = runs%tooth%peaks%tension
    low = runs%tooth%peaks%compression
    associate (known => has_result(runs%status))
      call table%add_index(axis('relief_um', 'um', of_relief, [runs%relief]))
      call table%add_index(axis('rpm', '1/min', of_speed, [runs%rpm]))
      call table%add('tension_mpa', 'MPa', 'largest tension along the surface', known_only(high%stress, known))
      call table%add('tension_deg', 'deg', 'angle of the fillet''s tangent there to the tooth''s axis', &
                     known_only(high%tangent, known))
      call table%add('static_tension_mpa', 'MPa', 'largest tension with the load at rest', &
                     known_only(runs%tooth%static%tension%stress, known))
      call table%add('compression_mpa', 'MPa', 'largest compression along the surface, negative', known_only(low%stress, known))
      call table%add('compression_deg', 'deg', 'angle of the fillet''s tangent there to the tooth''s axis', &
                     known_only(low%tangent, known))
      call table%add('static_compression_mpa', 'MPa', 'largest compression with the load at rest, negative', &
                     known_only(runs%tooth%static%compression%stress, known))
      call table%add('mises_mpa', 'MPa', 'largest von Mises stress', &
                     known_only(mises(larger(high%stress, low%stress), poisson), known))
      call table%add('tension_ratio', '', 'largest tension over that with the load at rest', &
                     known_only(high%stress/over(runs%tooth%static%tension%stress), known))
      call table%add('compression_ratio', '', 'the same of the compression', &
                     known_only(low%stress/over(runs%tooth%static%compression%stress), known))
      call table%add('look_us', 'us', 'time between two looks for the largest values', known_only(runs%tooth%look, known))
      call table%add('error_estimate', '', 'estimated discretisation error of the stresses, relative', &
                     known_only(runs%tooth%peaks%error_estimate, known))
      call table%add_words('status', of_status, words_of([runs%status]))
      call table%add('motions', '', of_motions//'; also under a static load', known_count(runs%motions))
    end associate
  end subroutine fill_peaks

  !> Adds columns of a stress along the surface (Pa) and its components. The fillet carries no load, so that it is the only stress
  !> in the plane; in plane strain, nu times it acts across the plane.
  pure subroutine add_stress(sigma, direction, poisson, table, before)
    real(dp), intent(in) :: sigma(:), direction(:, :), poisson
    type(table_t), intent(inout) :: table
    character(*), intent(in), optional :: before
    character(:), allocatable :: lead

    lead = ''
    if (present(before)) lead = before
    call table%add('sigma_mpa', 'MPa', lead//'stress along the surface', sigma)
    call table%add('sigma_x_mpa', 'MPa', lead//'component across the tooth, x to its drive side', sigma*direction(1, :)**2)
    call table%add('sigma_y_mpa', 'MPa', lead//'component along the tooth''s axis y', sigma*direction(2, :)**2)
    call table%add('tau_xy_mpa', 'MPa', lead//'shear component', sigma*direction(1, :)*direction(2, :))
    call table%add('mises_mpa', 'MPa', lead//'von Mises stress', mises(sigma, poisson))
  end subroutine add_stress

  !> Von Mises stress of a stress along a free surface.
  elemental real(dp) function mises(sigma, poisson)
    real(dp), intent(in) :: sigma, poisson

    mises = abs(sigma)*sqrt(1 - poisson + poisson**2)
  end function mises

  !> The one of larger magnitude.
  elemental real(dp) function larger(a, b)
    real(dp), intent(in) :: a, b

    larger = merge(a, b, abs(a) >= abs(b))
  end function larger

  !> The value as a divisor, 1 in place of 0.
  elemental real(dp) function over(value)
    real(dp), intent(in) :: value

    over = merge(value, 1.0_dp, abs(value) > 0)
  end function over

  elemental real(dp) function known_only(value, known)
    real(dp), intent(in) :: value
    logical, intent(in) :: known

    known_only = no_number()
    if (known) known_only = value
  end function known_only

  !> Number of rows of each point: one if the passage has no result.
  pure integer function samples_of(run)
    type(tooth_run_t), intent(in) :: run

    samples_of = 1
    if (allocated(run%tooth%s)) samples_of = size(run%tooth%s)
  end function samples_of

  !> Time since the load met the tooth (s), path coordinate and load (N) of the samples of a passage, and of a chosen point stress
  !> along the surface, also at rest, and displacement; NaN if there is no result.
  pure function history_of(run, what, point) result(values)
    type(tooth_run_t), intent(in) :: run
    integer, intent(in) :: what                  !< one of the constants of this module, or along, moved_x or moved_y
    integer, intent(in), optional :: point
    real(dp) :: values(samples_of(run))

    values = no_number()
    if (.not. allocated(run%tooth%s)) return
    associate (record => run%tooth%record)
      select case (what)
      case (times)
        values = record%time - record%time(1)
      case (places)
        values = run%tooth%s
      case (loads)
        values = run%tooth%load
      case (at_rest)
        values = record%static(per_point*(point - 1) + along, :)
      case default
        values = record%value(per_point*(point - 1) + what, :)
      end select
    end associate
  end function history_of

  !> Values of one row (`what`) of the chosen points of all runs, as in the constants.
  pure function of_points(runs, tooth, points, what, which) result(values)
    type(tooth_run_t), intent(in) :: runs(:)
    type(tooth_modes_t), intent(in) :: tooth
    integer, intent(in) :: points, what, which
    real(dp) :: values(points*size(runs))
    integer :: i, k, row

    values = no_number()
    do i = 1, size(runs)
      if (.not. allocated(runs(i)%tooth%s)) cycle
      associate (record => runs(i)%tooth%record)
        do k = 1, points
          row = tooth%row_of(k) + what
          associate (value => values(points*(i - 1) + k))
            select case (which)
            case (highest)
              value = record%highest(row)
            case (when_highest)
              value = record%time_highest(row) - record%time(1)
            case (lowest)
              value = record%lowest(row)
            case (when_lowest)
              value = record%time_lowest(row) - record%time(1)
            case (largest)
              value = larger(record%highest(row), record%lowest(row))
            case (largest_at_rest)
              value = larger(record%static_highest(row), record%static_lowest(row))
            case default
              value = runs(i)%tooth%point_error(k)
            end select
          end associate
        end do
      end associate
    end do
  end function of_points

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t(group, needs=stages_needed, tables='transient transient_points transient_peaks', fields='', &
                       summary='root stress of one gear over time while the load passes over a tooth, by modal superposition')
  end subroutine describe

  !> The motion is needed for its pair load only, and relief where the mesh or the motion shares the load.
  pure logical function uses(self, which)
    class(transient_task_t), intent(in) :: self
    integer, intent(in) :: which                 !< index of the stage in `stage`

    associate (sharing => self%passage%root%sharing)
      uses = needs_moving(stages_needed, which, sharing == shared_by_motion)
      if (which == stage%reliefs) uses = uses .and. (sharing == shared_by_motion .or. sharing == shared_by_mesh)
    end associate
  end function uses

  subroutine read_keys(self, reader, error)
    class(transient_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    type(error_t), allocatable, intent(inout) :: error
    character(sentence_length) :: geared
    logical :: counted

    call reader%add_group(group, 'The task transient: root stress over time while the load passes over a tooth.')
    geared = text_unless(.not. is_prescribed(reader), needs_gears)
    call reader%get(group, 'rpm', self%own_rpm, error, unit='1/min', required=.true., tasks=group, not_allowed=geared, &
                    at_least=1e-6_dp, at_most=1e9_dp, max_size=1000, distinct=.true., meaning='speeds of the pinion')
    call self%read_reliefs(reader, group, error)
    call self%choice%read_keys(reader, group, geared, error)
    call reader%get(group, 'static_correction', self%look%corrected, error, tasks=group, not_allowed=geared, &
                    meaning='what the modes that are left out would add to a load at rest is added at once; without it, stress '// &
                    'is that of the modes alone')
    call self%read_load(reader, geared, error)
    call reader%get(group, 'after_periods', self%passage%after, error, at_least=0.0_dp, at_most=100.0_dp, tasks=group, &
                    not_allowed=geared, meaning='time that is looked at when the load has left the tooth, in mesh periods')
    call reader%get(group, 'samples', self%look%samples, error, is_stated=counted, at_least=1, at_most=100000, tasks=group, &
                    default_note='400, or as time_step_s says', &
                    not_allowed=geared, meaning='equal steps of the whole time in the table transient; the largest values are '// &
                    'looked for eight times in a period of the highest mode, at most 10000 times in all')
    call reader%get(group, 'time_step_s', self%look%step, error, unit='s', at_least=1e-7_dp, at_most=1.0_dp, tasks=group, &
                    not_allowed=first_nonblank(geared, text_unless(.not. counted, 'samples is given; remove one of the two')), &
                    default_note='as samples says', &
                    meaning='step between the rows of the table transient; the largest values are then the largest of its '// &
                    'rows, as papers have it. Stress between two steps is not changed by it')
  end subroutine read_keys

  !> Reads how the load is shared and its positions.
  subroutine read_load(self, reader, geared, error)
    class(transient_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    character(*), intent(in) :: geared
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: sharing, spacing, travel
    character(sentence_length) :: unstated, nodal
    logical :: stated

    associate (root => self%passage%root)
      call reader%get(group, 'shares', root%shares, error, is_stated=stated, tasks=group, not_allowed=geared, at_least=0.0_dp, &
                      at_most=1.0_dp, min_size=4, max_size=1000, default_note='as sharing says', &
                      meaning='share of the static load at each place, from the outermost point of contact inwards in equal '// &
                      'arcs of the flank')
      unstated = first_nonblank(geared, text_unless(.not. stated, &
                                'the shares are stated, which says this too; remove one of the two'))
      call reader%get(group, 'positions', root%positions, error, at_least=4, at_most=1000, tasks=group, not_allowed=unstated, &
                      meaning='places on the flank at which the tooth is loaded')
      sharing = 'mesh'
      call reader%get(group, 'sharing', sharing, error, allowed=[character(6) :: 'mesh', 'equal', 'motion'], tasks=group, &
                      not_allowed=unstated, &
                      meaning='load on the tooth: as stiffness and relief share it at rest (mesh), the same for all pairs in '// &
                      'contact (equal), or that of the motion at this speed (motion)')
      spacing = 'path'
      call reader%get(group, 'spacing', spacing, error, allowed=[character(5) :: 'path', 'flank'], tasks=group, &
                      not_allowed=first_nonblank(unstated, text_unless(sharing /= 'motion', &
                      'the load of a motion moves along the path')), &
                      meaning='path: the load moves steadily along the path of contact; flank: from one place to the next, in '// &
                      'equal arcs of the flank and equal times, on the way handed over from the one to the other')
      root%spacing = merge(spaced_on_flank, spaced_on_path, stated .or. spacing == 'flank')
      root%sharing = shared_by_mesh
      if (sharing == 'equal') root%sharing = shared_equally
      if (sharing == 'motion') root%sharing = shared_by_motion
      if (stated) root%sharing = shares_stated
      if (stated .and. .not. allocated(error)) root%positions = size(root%shares)
    end associate
    nodal = first_nonblank(geared, text_unless(self%passage%root%spacing == spaced_on_flank, &
                                    'the load moves steadily along the path; needs spacing = ''flank'' or shares'))
    call reader%get(group, 'jump_at', self%passage%jump, error, at_least=0.0_dp, at_most=1.0_dp, tasks=group, not_allowed=nodal, &
                    default_note='the share changes all along', &
                    meaning='where on the way from one place to the next of another share the share jumps: 0 as it leaves the '// &
                    'one, 1 as it arrives at the other')
    call reader%get(group, 'passage_periods', self%passage%periods, error, above=0.0_dp, at_most=100.0_dp, tasks=group, &
                    not_allowed=nodal, default_note='the contact ratio', &
                    meaning='time from the first place to the last, in mesh periods')
    travel = 'driving'
    call reader%get(group, 'travel', travel, error, allowed=[character(8) :: 'driving', 'inwards', 'outwards'], tasks=group, &
                    not_allowed=first_nonblank(geared, text_unless(self%passage%root%sharing /= shared_by_motion, &
                                                    'in the motion the pinion drives; remove it')), &
                    meaning='the load travels over the flank as the driving pinion makes it (driving), from the tip down '// &
                    '(inwards) or up to it (outwards)')
    if (travel == 'inwards') self%travel = inwards
    if (travel == 'outwards') self%travel = outwards
  end subroutine read_load

  !> Refuses more passages than the tables can hold.
  subroutine check(self, facts, error)
    class(transient_task_t), intent(in) :: self
    type(case_facts_t), intent(in) :: facts
    type(error_t), allocatable, intent(inout) :: error
    integer :: reliefs

    call check_reliefs(self, facts, error)
    if (.not. allocated(self%own_rpm)) return
    reliefs = size(facts%amount)
    if (allocated(self%own_relief)) reliefs = size(self%own_relief)
    if (size(self%own_rpm)*reliefs > most_passages) call fail(error, code_input, &
      '&transient rpm: with '//str(reliefs)//' reliefs more than '//str(most_passages)//' passages')
  end subroutine check

  subroutine run(self, stages, error)
    class(transient_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(error_t), allocatable, intent(inout) :: error
    type(tooth_modes_t) :: teeth(2)
    type(tooth_run_t), allocatable :: runs(:)
    real(dp) :: poisson
    type(passage_t) :: passage
    integer, allocatable :: which(:)
    integer :: i, k, n

    if (allocated(error)) return
    self%passage%root%gear = stages%gear
    self%passage%inwards = self%travel == inwards .or. (self%travel == driving .and. stages%gear == 2)
    call find_unit_teeth(stages, self%choice, group, &
                         place_radius(stages%pair, self%passage, load_places(stages%pair, self%passage)), teeth, error)
    if (allocated(error)) return
    call self%list_reliefs(stages, which)
    call claim_memory(size(which)*size(self%own_rpm)*8.0_dp*(12*size(self%choice%tangent) + 4)*self%look%samples, &
                      '&transient rpm: '//str(size(which)*size(self%own_rpm))//' passages', error)
    if (allocated(error)) return
    allocate (runs(size(which)*size(self%own_rpm)))
    n = 0
    do i = 1, size(which)
      do k = 1, size(self%own_rpm)
        self%is_stopped = wants_stop(stages%accuracy%steady%stop)
        if (self%is_stopped) return
        n = n + 1
        runs(n)%relief = stages%amount(which(i))
        runs(n)%rpm = self%own_rpm(k)
        call self%pass(stages, which(i), runs(n)%rpm, passage, runs(n)%status, runs(n)%motions, error)
        if (allocated(error)) return
        if (has_result(runs(n)%status)) call follow_tooth(teeth, stress_error_share(stages%running%bodies), passage, self%look, &
                                                           runs(n)%tooth, error)
        if (allocated(error)) return
        if (self%uses(stage%motion)) call stages%running%report_progress(1, stages%accuracy%steady%stop)
      end do
    end do
    poisson = 0
    if (stages%body_inputs%options%plane_strain) poisson = stages%material(stages%gear)%poisson
    call fill_histories(runs, teeth(1), self%choice%tangent, poisson, self%tables(self%place('transient')), error)
    call fill_points(runs, teeth(1), self%choice%tangent, size(self%own_rpm), poisson, &
                     self%tables(self%place('transient_points')), error)
    call fill_peaks(runs, size(self%own_rpm), poisson, self%tables(self%place('transient_peaks')), error)
    self%is_done = .true.
    self%failed = count(.not. has_result(runs%status))
    self%log = 'transient: '//str(size(runs))//' passages of the load followed'
  end subroutine run

  !> Computes the passage of the load with relief number `relief`. For a motion that repeats after several mesh periods it is that
  !> of the pair with the largest load.
  subroutine pass(self, stages, relief, rpm, passage, status, motions, error)
    class(transient_task_t), intent(in) :: self
    type(stages_t), intent(in) :: stages
    integer, intent(in) :: relief
    real(dp), intent(in) :: rpm
    type(passage_t), intent(out) :: passage
    integer, intent(out) :: status, motions
    type(error_t), allocatable, intent(inout) :: error
    type(response_t) :: response
    real(dp) :: period
    integer :: worst

    status = status_ok
    motions = 0
    period = mesh_period(stages%pair%gear(1)%spec%teeth, rpm)
    associate (motion => stages%motion(relief))
      if (self%passage%root%sharing /= shared_by_motion) then
        call pass_static(stages%pair, motion%mesh, motion%load, self%passage, period, passage)
        return
      end if
    end associate
    call find_motion(stages%motion(relief), rpm, stages%accuracy, response, motions)
    if (response%lacks) call fail(error, code_memory, '&transient rpm = '//str(rpm)//': the memory does not hold the motion')
    if (allocated(error)) return
    status = response%point%steady%status
    if (.not. has_result(status)) return
    worst = response%pair(maxloc(response%load, 1))
    call pass_path(stages%pair, pack(response%s, response%pair == worst), pack(response%load, response%pair == worst), &
                   self%passage, period, passage)
  end subroutine pass

  pure subroutine add_report(self, lines)
    class(transient_task_t), intent(in) :: self
    type(lines_t), intent(inout) :: lines

    associate (peaks => self%tables(self%place('transient_peaks')))
      call lines%add('')
      call lines%add('Root stress while the load passes, largest over time anywhere on the fillets (chosen points: table '// &
                     'transient_points)')
      call peaks%show(lines, 'relief_um rpm tension_mpa static_tension_mpa compression_mpa static_compression_mpa mises_mpa '// &
                      'error_estimate')
      call add_several(peaks, lines)
    end associate
  end subroutine add_report
end module gearsweep_study_tasks_transient
