!> The task `transient`: stress and displacement at the fillets of one tooth while the load passes over it, by modal
!> superposition.
module gearsweep_task_transient
  use gearsweep_decimal, only: in_um
  use gearsweep_error, only: code_input, code_memory, error_t, fail
  use gearsweep_kinds, only: dp
  use gearsweep_largest_motion, only: find_motion
  use gearsweep_lines, only: lines_t, right
  use gearsweep_memory, only: claim_memory
  use gearsweep_oscillator, only: mesh_period
  use gearsweep_passage, only: load_places, pass_path, pass_static, passage_options_t, passage_t, place_radius
  use gearsweep_points, only: add_several
  use gearsweep_reader, only: reader_t
  use gearsweep_response, only: response_t
  use gearsweep_root_rating, only: shared_by_mesh, shared_equally, shares_stated, spaced_on_flank, spaced_on_path
  use gearsweep_section_body, only: stress_error_share
  use gearsweep_status, only: has_result, status_ok
  use gearsweep_stop, only: wants_stop
  use gearsweep_stages, only: runnable_t, stages_t
  use gearsweep_task, only: case_facts_t, check_reliefs, needs_moving, stage, task_info_t
  use gearsweep_text, only: str
  use gearsweep_tooth_modes, only: tooth_modes_t
  use gearsweep_tooth_transient, only: damping_t, follow_tooth, look_t
  use gearsweep_transient_tables, only: fill_histories, fill_peaks, fill_points, tooth_run_t
  use gearsweep_unit_teeth, only: find_unit_teeth, tooth_choice_t
  use gearsweep_uses, only: first_of, is_prescribed, needs_gears, sentence_length, unless
  implicit none
  private
  public :: transient_task_t

  integer, parameter :: shared_by_motion = 3
  !> Which way the load travels over the flank: as the driving pinion makes it, or as is said.
  integer, parameter :: driving = 0, inwards = 1, outwards = 2

  type, extends(runnable_t) :: transient_task_t
    type(tooth_choice_t) :: choice               !< modes, damping, chosen points
    type(passage_options_t) :: passage
    type(look_t) :: look
    integer :: travel = driving
  contains
    procedure, nopass :: describe
    procedure :: read_keys, run, add_report
    procedure :: check, uses
    procedure, private :: read_load, read_times, follow, pass
  end type transient_task_t

  character(*), parameter :: group = 'transient'
  integer, parameter :: stages_needed(*) = [stage%geometry, stage%section, stage%body, stage%mesh, stage%reliefs, &
                                            stage%amounts, stage%motion, stage%losses, stage%accuracy]
  integer, parameter :: most_passages = 10000

contains

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t(group, needs=stages_needed, tables='transient transient_points transient_peaks', fields='', &
                       gives='root stress of one gear over time while the load passes over a tooth, by modal superposition')
  end subroutine describe

  !> The motion matters for its pair load alone, and relief where the mesh or the motion shares the load.
  pure logical function uses(self, which)
    class(transient_task_t), intent(in) :: self
    integer, intent(in) :: which                 !< of `stage`

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

    call reader%add_group(group, 'The task transient: root stress over time while the load passes over a tooth.')
    geared = unless(.not. is_prescribed(reader), needs_gears)
    call reader%get(group, 'rpm', self%own_rpm, error, unit='1/min', required=.true., tasks=group, refused=geared, &
                    at_least=1e-6_dp, at_most=1e9_dp, max_size=1000, distinct=.true., meaning='speeds of the pinion')
    call self%read_reliefs(reader, group, error)
    call self%choice%read_keys(reader, group, geared, error)
    call reader%get(group, 'static_correction', self%look%corrected, error, tasks=group, refused=geared, &
                    meaning='what the modes that are left out would add to a load at rest is added at once; without it, stress '// &
                    'is that of the modes alone')
    call self%read_load(reader, geared, error)
    call self%read_times(reader, geared, error)
  end subroutine read_keys

  !> How the load is shared and where it stands.
  subroutine read_load(self, reader, geared, error)
    class(transient_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    character(*), intent(in) :: geared
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: sharing, spacing, travel
    character(sentence_length) :: unstated, nodal
    logical :: stated

    associate (root => self%passage%root)
      call reader%get(group, 'shares', root%shares, error, given=stated, tasks=group, refused=geared, at_least=0.0_dp, &
                      at_most=1.0_dp, min_size=4, max_size=1000, otherwise='as sharing says', &
                      meaning='share of the static load at each place, from the outermost point of contact inwards in equal '// &
                      'arcs of the flank')
      unstated = first_of(geared, unless(.not. stated, 'the shares are stated, which says this too; remove one of the two'))
      call reader%get(group, 'positions', root%positions, error, at_least=4, at_most=1000, tasks=group, refused=unstated, &
                      meaning='places on the flank at which the tooth is loaded')
      sharing = 'mesh'
      call reader%get(group, 'sharing', sharing, error, allowed=[character(6) :: 'mesh', 'equal', 'motion'], tasks=group, &
                      refused=unstated, &
                      meaning='load on the tooth: as stiffness and relief share it at rest (mesh), the same for all pairs in '// &
                      'contact (equal), or that of the motion at this speed (motion)')
      spacing = 'path'
      call reader%get(group, 'spacing', spacing, error, allowed=[character(5) :: 'path', 'flank'], tasks=group, &
                      refused=first_of(unstated, unless(sharing /= 'motion', 'the load of a motion moves along the path')), &
                      meaning='path: the load moves steadily along the path of contact; flank: from one place to the next, in '// &
                      'equal arcs of the flank and equal times, on the way handed over from the one to the other')
      root%spacing = merge(spaced_on_flank, spaced_on_path, stated .or. spacing == 'flank')
      root%sharing = shared_by_mesh
      if (sharing == 'equal') root%sharing = shared_equally
      if (sharing == 'motion') root%sharing = shared_by_motion
      if (stated) root%sharing = shares_stated
      if (stated .and. .not. allocated(error)) root%positions = size(root%shares)
    end associate
    nodal = first_of(geared, unless(self%passage%root%spacing == spaced_on_flank, &
                                    'the load moves steadily along the path; needs spacing = ''flank'' or shares'))
    call reader%get(group, 'jump_at', self%passage%jump, error, at_least=0.0_dp, at_most=1.0_dp, tasks=group, refused=nodal, &
                    otherwise='the share changes all along', &
                    meaning='where on the way from one place to the next of another share the share jumps: 0 as it leaves the '// &
                    'one, 1 as it arrives at the other')
    call reader%get(group, 'passage_periods', self%passage%periods, error, above=0.0_dp, at_most=100.0_dp, tasks=group, &
                    refused=nodal, otherwise='the contact ratio', &
                    meaning='time from the first place to the last, in mesh periods')
    travel = 'driving'
    call reader%get(group, 'travel', travel, error, allowed=[character(8) :: 'driving', 'inwards', 'outwards'], tasks=group, &
                    refused=first_of(geared, unless(self%passage%root%sharing /= shared_by_motion, &
                                                    'in the motion the pinion drives; remove it')), &
                    meaning='the load travels over the flank as the driving pinion makes it (driving), from the tip down '// &
                    '(inwards) or up to it (outwards)')
    if (travel == 'inwards') self%travel = inwards
    if (travel == 'outwards') self%travel = outwards
  end subroutine read_load

  !> When the tooth is looked at.
  subroutine read_times(self, reader, geared, error)
    class(transient_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    character(*), intent(in) :: geared
    type(error_t), allocatable, intent(inout) :: error
    logical :: counted

    call reader%get(group, 'after_periods', self%passage%after, error, at_least=0.0_dp, at_most=100.0_dp, tasks=group, &
                    refused=geared, meaning='time that is looked at when the load has left the tooth, in mesh periods')
    call reader%get(group, 'samples', self%look%samples, error, given=counted, at_least=1, at_most=100000, tasks=group, &
                    otherwise='400, or as time_step_s says', &
                    refused=geared, meaning='equal steps of the whole time in the table transient; the largest values are '// &
                    'looked for eight times in a period of the highest mode, at most 10000 times in all')
    call reader%get(group, 'time_step_s', self%look%step, error, unit='s', at_least=1e-7_dp, at_most=1.0_dp, tasks=group, &
                    refused=first_of(geared, unless(.not. counted, 'samples is given; remove one of the two')), &
                    otherwise='as samples says', &
                    meaning='step between the rows of the table transient; the largest values are then the largest of its '// &
                    'rows, as papers have it. Stress between two steps is not changed by it')
  end subroutine read_times

  !> So many passages and no more.
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

    if (allocated(error)) return
    self%passage%root%member = stages%member
    self%passage%inwards = self%travel == inwards .or. (self%travel == driving .and. stages%member == 2)
    call find_unit_teeth(stages, self%choice, group, &
                         place_radius(stages%pair, self%passage, load_places(stages%pair, self%passage)), teeth, error)
    if (allocated(error)) return
    call self%follow(stages, teeth, runs, error)
    if (allocated(error)) return
    self%is_stopped = .not. allocated(runs)
    if (self%is_stopped) return
    poisson = 0
    if (stages%body_inputs%options%plane_strain) poisson = stages%material(stages%member)%poisson
    call fill_histories(runs, teeth(1), self%choice%tangent, poisson, self%tables(self%place('transient')), error)
    call fill_points(runs, teeth(1), self%choice%tangent, size(self%own_rpm), poisson, &
                     self%tables(self%place('transient_points')), error)
    call fill_peaks(runs, size(self%own_rpm), poisson, self%tables(self%place('transient_peaks')), error)
    self%is_done = .true.
    self%failed = count(.not. has_result(runs%status))
    self%log = 'transient: '//str(size(runs))//' passages of the load followed'
  end subroutine run

  !> All reliefs at all speeds; not allocated where the run was interrupted.
  subroutine follow(self, stages, teeth, runs, error)
    class(transient_task_t), intent(in) :: self
    type(stages_t), intent(in) :: stages
    type(tooth_modes_t), intent(in) :: teeth(2)
    type(tooth_run_t), allocatable, intent(out) :: runs(:)
    type(error_t), allocatable, intent(inout) :: error
    type(tooth_run_t), allocatable :: found(:)
    type(passage_t) :: passage
    integer, allocatable :: which(:)
    integer :: i, k, n

    call self%list_reliefs(stages, which)
    call claim_memory(size(which)*size(self%own_rpm)*8.0_dp*(12*size(self%choice%tangent) + 4)*self%look%samples, &
                      '&transient rpm: '//str(size(which)*size(self%own_rpm))//' passages', error)
    if (allocated(error)) return
    allocate (found(size(which)*size(self%own_rpm)))
    n = 0
    do i = 1, size(which)
      do k = 1, size(self%own_rpm)
        if (wants_stop(stages%accuracy%steady%stop)) return
        n = n + 1
        found(n)%relief = stages%amount(which(i))
        found(n)%rpm = self%own_rpm(k)
        call self%pass(stages, which(i), found(n)%rpm, passage, found(n)%status, found(n)%motions, error)
        if (allocated(error)) return
        if (has_result(found(n)%status)) call follow_tooth(teeth, stress_error_share(stages%running%bodies), passage, self%look, &
                                                           found(n)%tooth, error)
        if (allocated(error)) return
        if (self%uses(stage%motion)) call stages%running%tell(1, stages%accuracy%steady%stop)
      end do
    end do
    call move_alloc(found, runs)
  end subroutine follow

  !> The passage of the load with relief number `relief`. Of a motion that repeats after several mesh periods it is the pair
  !> with the largest load.
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
    integer :: i

    associate (peaks => self%tables(self%place('transient_peaks')))
      call lines%add('')
      call lines%add('Root stress while the load passes, largest over time anywhere on the fillets (chosen points: table '// &
                     'transient_points)')
      call lines%add('   relief um         rpm   tension MPa    at rest   compression MPa    at rest   von Mises MPa'// &
                     '   error est. %')
      do i = 1, peaks%rows
        call lines%add(right(str(peaks%number('relief_um', i)), 12)//right(str(peaks%number('rpm', i)), 12)// &
                       right(str(peaks%number('tension_mpa', i), 5), 14)// &
                       right(str(peaks%number('static_tension_mpa', i), 5), 11)// &
                       right(str(peaks%number('compression_mpa', i), 5), 18)// &
                       right(str(peaks%number('static_compression_mpa', i), 5), 11)// &
                       right(str(peaks%number('mises_mpa', i), 5), 16)// &
                       right(str(100*peaks%number('error_estimate', i), 2), 15))
      end do
      call add_several(peaks, lines)
    end associate
  end subroutine add_report
end module gearsweep_task_transient
