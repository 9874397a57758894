!> The stages that need the motion: sweep, loads along the path, optimum relief.
module gearsweep_motion_stage
  use gearsweep_error_estimate, only: accuracy_t, point_t
  use gearsweep_case, only: speed_count, speeds
  use gearsweep_error, only: code_memory, error_t, fail
  use gearsweep_inputs, only: choice_t, motions_inputs_t, points_inputs_t, relief_inputs_t, same, same_but_amounts
  use gearsweep_kinds, only: dp
  use gearsweep_memory, only: claim_memory
  use gearsweep_oscillator, only: oscillator_t
  use gearsweep_optimum, only: find_optimum, find_resonances, most_tried, optimum_t
  use gearsweep_products, only: ends_here, note, record_t, study_t
  use gearsweep_response, only: find_response
  use gearsweep_stages, only: build_motion, deepest_relief
  use gearsweep_status, only: status_stopped
  use gearsweep_stop, only: wants_stop
  use gearsweep_sweep, only: progress_of_sweep, run_sweep, sweep_options_t, sweep_state_t, sweep_t
  use gearsweep_text, only: str
  implicit none
  private
  public :: move

contains

  !> The tasks that need the motion. What an `earlier` study has whole of the same inputs is taken over.
  subroutine move(study, options, error, progress, record, earlier)
    type(study_t), intent(inout) :: study
    type(sweep_options_t), intent(inout) :: options
    type(error_t), allocatable, intent(inout) :: error
    procedure(progress_of_sweep), optional :: progress
    type(record_t), intent(inout), optional :: record
    type(study_t), intent(in), optional :: earlier

    associate (case => study%case)
      if (case%asks('sweep') .or. case%asks('optimum')) options%all_points = speed_count(case)* &
        (merge(size(case%amount), 0, case%asks('sweep')) + merge(most_tried, 0, case%asks('optimum')))
      if (case%asks('sweep')) call sweep_all(study, options, error, progress, record, earlier)
      if (case%asks('load') .and. .not. allocated(error)) call respond(study, options, error, earlier)
      if (case%asks('optimum') .and. .not. allocated(error)) &
        call optimise(study, options, error, progress, record, earlier)
    end associate
  end subroutine move

  !> What the steady motions of a study depend on beside the oscillator. `swept`: they lie on the branch that a sweep
  !> follows.
  pure subroutine list_inputs(study, swept, inputs)
    type(study_t), intent(in) :: study
    logical, intent(in) :: swept
    type(points_inputs_t), intent(out) :: inputs

    associate (case => study%case)
      inputs%choice = choice_t(steps=case%accuracy%step_choice_t, steady=case%accuracy%steady%steady_choice_t)
      if (swept) inputs%choice%direction = case%direction
      allocate (inputs%rpm(0), inputs%keep(0))
      if (swept) inputs%rpm = speeds(case)
      if (case%asks('load')) inputs%keep = case%load_rpm
    end associate
  end subroutine list_inputs

  !> The options that these inputs make, with threads, progress and stop of `options`.
  pure subroutine set_options(inputs, options)
    type(points_inputs_t), intent(in) :: inputs
    type(sweep_options_t), intent(inout) :: options

    options%accuracy%step_choice_t = inputs%choice%steps
    options%accuracy%steady%steady_choice_t = inputs%choice%steady
    options%direction = inputs%choice%direction
  end subroutine set_options

  subroutine sweep_all(study, options, error, progress, record, earlier)
    type(study_t), intent(inout) :: study
    type(sweep_options_t), intent(inout) :: options
    type(error_t), allocatable, intent(inout) :: error
    procedure(progress_of_sweep), optional :: progress
    type(record_t), intent(inout), optional :: record
    type(study_t), intent(in), optional :: earlier
    logical :: known
    integer :: left

    call claim_memory(24.0_dp*speed_count(study%case), '&sweep: '//str(speed_count(study%case))//' speeds', error)
    if (allocated(error)) return
    call list_inputs(study, .true., study%sweep_inputs)
    known = .false.
    if (present(earlier)) known = allocated(earlier%sweep)
    if (known) known = .not. any(earlier%sweep%status == status_stopped) .and. &
                       same(study%motions_inputs, earlier%motions_inputs) .and. same(study%sweep_inputs, earlier%sweep_inputs)
    if (known) then
      call copy_sweep(earlier%sweep, study%sweep, error)
    else
      allocate (study%sweep)
      call find_sweep(study%sweep_inputs, study%motion, options, study%sweep, error, progress, record)
    end if
    if (allocated(error)) return
    options%done_before = size(study%sweep%status)
    left = count(study%sweep%status == status_stopped)
    study%stopped = study%stopped .or. left > 0
    if (left == 0) then
      study%resonance = find_resonances(study%sweep%rpm, study%sweep%dynamic_factor(:, minloc(study%case%amount, 1)))
      call note(study, 'sweep: '//str(size(study%sweep%status))//' operating points'//trim(merge(', taken over', '            ', &
                                                                                                 known)))
    else
      ! Part of a curve may end at what is no resonance.
      allocate (study%resonance(0))
      call note(study, 'sweep: interrupted, '//str(size(study%sweep%status) - left)//' of '//str(size(study%sweep%status))// &
                ' operating points computed')
    end if
  end subroutine sweep_all

  subroutine find_sweep(inputs, motion, options, sweep, error, progress, record)
    type(points_inputs_t), intent(in) :: inputs
    type(oscillator_t), intent(in) :: motion(:)
    type(sweep_options_t), intent(in) :: options
    type(sweep_t), intent(out) :: sweep
    type(error_t), allocatable, intent(inout) :: error
    procedure(progress_of_sweep), optional :: progress
    type(record_t), intent(inout), optional :: record
    type(sweep_options_t) :: own

    own = options
    call set_options(inputs, own)
    if (size(inputs%keep) > 0) own%keep = inputs%keep
    if (present(record)) then
      call run_sweep(motion, inputs%rpm, own, sweep, error, progress, record%states(1))
    else
      call run_sweep(motion, inputs%rpm, own, sweep, error, progress)
    end if
  end subroutine find_sweep

  subroutine copy_sweep(from, sweep, error)
    type(sweep_t), intent(in) :: from
    type(sweep_t), allocatable, intent(out) :: sweep
    type(error_t), allocatable, intent(inout) :: error
    type(point_t) :: point

    call claim_memory(60.0_dp*size(from%status) + real(storage_size(point)/8, dp)*size(from%kept), &
                      '&sweep: '//str(size(from%status))//' points', error)
    if (.not. allocated(error)) sweep = from
  end subroutine copy_sweep

  !> One operating point has one answer: what a sweep of this run found, or follows from there, is taken over.
  subroutine respond(study, options, error, earlier)
    type(study_t), intent(inout) :: study
    type(sweep_options_t), intent(in) :: options
    type(error_t), allocatable, intent(inout) :: error
    type(study_t), intent(in), optional :: earlier
    logical :: known
    integer :: i, k

    call claim_memory(1000.0_dp*size(study%motion)*size(study%case%load_rpm), &
                      '&sweep load_rpm: '//str(size(study%motion)*size(study%case%load_rpm))//' motions', error)
    if (allocated(error)) return
    call list_inputs(study, allocated(study%sweep), study%response_inputs)
    known = .false.
    if (present(earlier)) known = allocated(earlier%response)
    if (known) known = .not. any(earlier%response%point%steady%status == status_stopped) .and. &
                       same(study%motions_inputs, earlier%motions_inputs) .and. &
                       same(study%response_inputs, earlier%response_inputs)
    if (known) then
      call claim_memory(sum([((28.0_dp*size(earlier%response(i, k)%s), i=1, size(earlier%response, 1)), &
                              k=1, size(earlier%response, 2))]), '&sweep load_rpm: the motions', error)
      if (allocated(error)) return
      study%response = earlier%response
    else
      call find_responses(study, options, error)
    end if
    if (allocated(error)) return
    study%stopped = study%stopped .or. any(study%response%point%steady%status == status_stopped)
    call note(study, 'load: '//str(size(study%response))//' motions '//trim(merge('taken over            ', &
                                                                                 'followed over the path', known)))
  end subroutine respond

  subroutine find_responses(study, options, error)
    type(study_t), intent(inout) :: study
    type(sweep_options_t), intent(in) :: options
    type(error_t), allocatable, intent(inout) :: error
    type(sweep_options_t) :: own
    type(point_t) :: none
    integer :: i, k

    none%steady%status = status_stopped
    own = options
    call set_options(study%response_inputs, own)
    allocate (study%response(size(study%motion), size(study%response_inputs%keep)))
    associate (rpm => study%response_inputs%keep, accuracy => own%accuracy)
      do k = 1, size(rpm)
        do i = 1, size(study%motion)
          if (allocated(study%sweep)) then
            call find_response(study%motion(i), rpm(k), accuracy, study%response(i, k), study%sweep%kept(k, i))
          else if (wants_stop(accuracy%steady%stop)) then
            call find_response(study%motion(i), rpm(k), accuracy, study%response(i, k), none)
          else
            call find_response(study%motion(i), rpm(k), accuracy, study%response(i, k))
          end if
          if (study%response(i, k)%lacks) call fail(error, code_memory, &
            '&sweep load_rpm = '//str(rpm(k))//': the memory does not hold the motion')
          if (allocated(error)) return
        end do
      end do
    end associate
  end subroutine find_responses

  subroutine optimise(study, options, error, progress, record, earlier)
    type(study_t), intent(inout) :: study
    type(sweep_options_t), intent(in) :: options
    type(error_t), allocatable, intent(inout) :: error
    procedure(progress_of_sweep), optional :: progress
    type(record_t), intent(inout), optional :: record
    type(study_t), intent(in), optional :: earlier
    type(optimum_t), allocatable :: optimum
    logical :: known

    if (ends_here(study, options, 'optimum relief')) return
    call claim_memory(24.0_dp*speed_count(study%case), '&sweep: '//str(speed_count(study%case))//' speeds', error)
    if (allocated(error)) return
    call list_inputs(study, .true., study%optimum_inputs)
    study%optimum_inputs%keep = [real(dp) ::]
    study%optimum_inputs%choice%largest = largest_relief(study)
    known = .false.
    if (present(earlier)) known = allocated(earlier%optimum)
    if (known) known = same_but_amounts(study%motions_inputs, earlier%motions_inputs) .and. &
                       same(study%optimum_inputs, earlier%optimum_inputs)
    if (known) then
      optimum = earlier%optimum
    else
      allocate (optimum)
      call search(study%optimum_inputs, study%motions_inputs, options, optimum, error, progress, record)
    end if
    if (allocated(error)) return
    if (optimum%stopped) then
      study%stopped = .true.
      call note(study, 'optimum relief left out: the run was interrupted')
      return
    end if
    call move_alloc(optimum, study%optimum)
    call note(study, 'optimum: '//str(size(study%optimum%amount))//' reliefs '//trim(merge('taken over', 'swept     ', known)))
  end subroutine optimise

  !> Beyond some 1.5 static deflections of one pair, pairs no longer share the load.
  real(dp) function largest_relief(study) result(largest)
    type(study_t), intent(in) :: study

    associate (inputs => study%motions_inputs)
      largest = max(maxval(inputs%amount), 1.5_dp*inputs%motion%load &
                    /inputs%stiffness%value(inputs%motion%relief%contact_ratio/2)/maxval(inputs%motion%relief%fraction))
      largest = min(largest, deepest_relief(inputs%motion%relief))
    end associate
  end function largest_relief

  subroutine search(inputs, motions, options, optimum, error, progress, record)
    type(points_inputs_t), intent(in) :: inputs
    type(motions_inputs_t), intent(in) :: motions
    type(sweep_options_t), intent(in) :: options
    type(optimum_t), intent(out) :: optimum
    type(error_t), allocatable, intent(inout) :: error
    procedure(progress_of_sweep), optional :: progress
    type(record_t), intent(inout), optional :: record
    type(sweep_options_t) :: own

    own = options
    call set_options(inputs, own)
    if (present(record)) then
      call find_optimum(with_relief, motions, inputs%choice%largest, inputs%rpm, own, optimum, error, progress, &
                        record%states(2:))
    else
      call find_optimum(with_relief, motions, inputs%choice%largest, inputs%rpm, own, optimum, error, progress)
    end if
  end subroutine search

  subroutine with_relief(context, amount, motion, error)
    class(*), intent(in) :: context
    real(dp), intent(in) :: amount
    type(oscillator_t), intent(out) :: motion
    type(error_t), allocatable, intent(out) :: error

    select type (context)
    type is (motions_inputs_t)
      call build_motion(context%motion, context%stiffness, context%profile_error, amount, motion, error)
    end select
  end subroutine with_relief
end module gearsweep_motion_stage
