!> Specimens of the task `as_built`: pairs of gears drawn or measured, assembled and swept over the speeds.
!>
!> With `quick`, a sample is solved to the tolerance and the others by the quick method.
module gearsweep_as_built_specimens
  use gearsweep_base, only: begin_stream, code_input, code_memory, dp, error_t, fail, no_number, pi, random_stream_t, str, &
    wants_stop
  use gearsweep_gear, only: find_tolerances, pair_t, tolerances_t
  use gearsweep_mesh, only: deviations_t, draw_deviations, flank_deviations_t, frame_t, is_within, place_deviations, make_frame
  use gearsweep_motion, only: each, find_turn, frequency_ratio, has_result, levels_t, make_oscillator, oscillator_t, &
    quick_motion_t, run_quickly, run_sweep, status_inexact, status_ok, status_stopped, sweep_options_t, sweep_t, turn_t
  use gearsweep_rating, only: root_history
  use gearsweep_study, only: stages_t
  use gearsweep_as_built_deviation_keys, only: deviations_choice_t
  implicit none
  private
  public :: specimen_t, draw_specimens, deviating, sweep_each, follow_turn, unit_root_stress, run_specimens

  !> Place of a largest load.
  type :: tooth_t
    real(dp) :: rpm = 0                          !< speed of the pinion, 1/min; 0: none
    real(dp) :: dynamic_factor = 0
    integer :: pair = -1                         !< index of the pair of teeth, from 0; -1: not known
    real(dp) :: place = 0                        !< path coordinate, base pitches
    !> Largest nominal root stress over that revolution, if requested, Pa; (gear)
    real(dp), allocatable :: stress(:)
  end type tooth_t

  !> Specimen: two gears in one assembly of their teeth.
  type :: specimen_t
    type(flank_deviations_t) :: flanks(2)
    type(deviations_t) :: deviations             !< deviations of the assembled gears
    logical :: is_within = .true.                !< true if the drawn gears are within their classes
    integer :: offset = 0                        !< number of teeth of the gear by which the assembly differs from the stated one
    type(sweep_t) :: sweep
    type(tooth_t), allocatable :: worst(:)       !< teeth of largest load; (relief)
  end type specimen_t

  !> Tolerance of the dynamic factors of the quick method.
  real(dp), parameter :: tolerance = 1e-3_dp
  !> Relative tolerance of its peak-to-peak transmission errors, which a sample is too small to confirm.
  real(dp), parameter :: dte_tolerance = 2e-3_dp
  !> Least error estimate, as a small sample may have small errors by chance: of 21644 points with a damping ratio of 0.1, 16 had
  !> errors above twice this value.
  real(dp), parameter :: least_error = 2.5e-4_dp

contains

  !> Draws all pairs of gears: (assembly, draw).
  subroutine draw_specimens(choice, stages, assemblies, specimens, error)
    type(deviations_choice_t), intent(in) :: choice
    type(stages_t), intent(in) :: stages
    integer, intent(in) :: assemblies
    type(specimen_t), allocatable, intent(out) :: specimens(:, :)
    type(error_t), allocatable, intent(inout) :: error
    type(flank_deviations_t) :: flanks(2)
    type(random_stream_t) :: random(2)
    type(frame_t) :: frame
    logical :: within
    integer :: draw, i

    if (allocated(stages%pair)) then
      frame = make_frame(stages%motion(1)%mesh, stages%pair)
    else
      frame = make_frame(stages%motion(1)%mesh)
    end if
    allocate (specimens(assemblies, choice%draws))
    random = [(begin_stream(2*choice%seed + i), i=1, 2)]
    do draw = 1, choice%draws
      flanks = choice%flanks
      call draw_flanks(choice, stages, frame, random, flanks, within, error)
      if (allocated(error)) return
      do i = 1, assemblies
        associate (mesh => stages%motion(1)%mesh, specimen => specimens(i, draw))
          specimen%flanks = flanks
          specimen%is_within = within
          specimen%offset = i - 1
          specimen%deviations = place_deviations(flanks, frame, mesh%teeth, mesh%contact_ratio, i - 1)
        end associate
      end do
    end do
  end subroutine draw_specimens

  !> Computes all speeds and reliefs of a specimen, each to the tolerance, and its teeth of largest load.
  subroutine run_exactly(stages, which, rpm, specimen, error, unit_stress)
    type(stages_t), intent(in) :: stages
    integer, intent(in) :: which(:)              !< reliefs of the case
    real(dp), intent(in) :: rpm(:)               !< speeds of the pinion, 1/min
    type(specimen_t), intent(inout) :: specimen
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable, intent(in) :: unit_stress(:, :)   !< stresses of `unit_root_stress`; not allocated: not requested
    type(oscillator_t) :: osc(size(which))       ! (relief)

    osc = deviating(stages%motion(which), specimen%deviations, error)
    call sweep_each(stages, osc, rpm, specimen%sweep, error)
    if (.not. allocated(error)) call find_worst(stages, osc, specimen, error, unit_stress)
  end subroutine run_exactly

  !> Draws the flanks of the gears with a tolerance class.
  subroutine draw_flanks(choice, stages, frame, random, flanks, within, error)
    type(deviations_choice_t), intent(in) :: choice
    type(stages_t), intent(in) :: stages
    type(frame_t), intent(in) :: frame
    type(random_stream_t), intent(inout) :: random(2)      ! streams of pinion and gear, after the earlier draws
    type(flank_deviations_t), intent(inout) :: flanks(2)
    logical, intent(out) :: within               ! true if all drawn flanks are within their classes
    type(error_t), allocatable, intent(inout) :: error
    integer, parameter :: most_tries = 10000
    type(error_t), allocatable :: outside
    type(tolerances_t) :: tolerances
    logical :: is_good
    integer :: i, k

    within = .true.
    do i = 1, 2
      if (choice%class(i) == 0) cycle
      associate (spec => stages%pair%gear(i)%spec)
        call find_tolerances(choice%class(i), spec%teeth, 1e3_dp*spec%module, 1e3_dp*spec%face_width, tolerances, outside)
        if (allocated(outside)) call fail(error, outside%code, outside%message)
        do k = 1, merge(most_tries, 1, choice%accepted)
          call draw_deviations(tolerances, spec%teeth, random(i), flanks(i))
          is_good = is_within(flanks(i), tolerances, frame, i)
          if (is_good) exit
        end do
        within = within .and. is_good
        if (choice%accepted .and. .not. is_good) call fail(error, code_input, '&deviations accepted: of '//str(most_tries)// &
          ' gears of '//str(spec%teeth)//' teeth drawn in class '//str(choice%class(i))//' none is within it; remove the key')
      end associate
    end do
  end subroutine draw_flanks

  !> Builds the oscillators with these deviations.
  function deviating(motion, deviations, error) result(osc)
    type(oscillator_t), intent(in) :: motion(:)  ! (relief)
    type(deviations_t), intent(in) :: deviations
    type(error_t), allocatable, intent(inout) :: error
    type(oscillator_t) :: osc(size(motion))
    type(error_t), allocatable :: refused
    integer :: i

    osc = motion
    do i = 1, size(osc)
      osc(i)%mesh%deviations = deviations
      osc(i)%by_load = .false.
      call make_oscillator(osc(i), refused)
      if (allocated(refused)) call fail(error, refused%code, refused%message)
    end do
  end function deviating

  !> Computes all speeds and reliefs, each point separately.
  subroutine sweep_each(stages, osc, rpm, found, error)
    type(stages_t), intent(in) :: stages
    type(oscillator_t), intent(in) :: osc(:)     ! (relief)
    real(dp), intent(in) :: rpm(:)
    type(sweep_t), intent(out) :: found
    type(error_t), allocatable, intent(inout) :: error
    type(sweep_options_t) :: options

    if (allocated(error)) return
    options = stages%sweep_options()
    options%direction = each
    options%largest = .true.
    if (associated(stages%running%progress)) then
      call run_sweep(osc, rpm, options, found, error, stages%running%progress)
    else
      call run_sweep(osc, rpm, options, found, error)
    end if
    stages%running%done = stages%running%done + size(rpm)*size(osc)
  end subroutine sweep_each

  !> Finds the teeth that carry the largest load with each relief, and its place on their path. Returns early if the caller stops
  !> the run.
  subroutine find_worst(stages, osc, specimen, error, unit_stress)
    type(stages_t), intent(in) :: stages
    type(oscillator_t), intent(in) :: osc(:)     ! (relief)
    type(specimen_t), intent(inout) :: specimen
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable, intent(in) :: unit_stress(:, :)
    type(turn_t) :: turn
    integer :: i, k

    allocate (specimen%worst(size(osc)))
    do i = 1, size(osc)
      if (wants_stop(stages%accuracy%steady%stop)) return
      associate (factor => specimen%sweep%dynamic_factor(:, i), found => has_result(specimen%sweep%status(:, i)))
        if (.not. any(found)) cycle
        k = maxloc(factor, 1, mask=found)
        call follow_turn(osc(i), specimen%sweep%rpm(k), stages, specimen%sweep, i, turn, error, unit_stress)
        if (allocated(error)) return
        specimen%worst(i) = tooth_t(specimen%sweep%rpm(k), factor(k))
        if (.not. allocated(turn%load)) cycle
        specimen%worst(i)%pair = maxloc(turn%load, 1) - 1
        specimen%worst(i)%place = turn%place(specimen%worst(i)%pair + 1)
        if (allocated(turn%stress)) specimen%worst(i)%stress = maxval(turn%stress, 2)
      end associate
    end do
  end subroutine find_worst

  !> Computes the motion of one oscillator over the revolution: that of the sweep, if it has that speed.
  subroutine follow_turn(osc, rpm, stages, sweep, relief, turn, error, unit_stress)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm                  !< speed of the pinion, 1/min
    type(stages_t), intent(in) :: stages
    type(sweep_t), intent(in) :: sweep           !< sweep of this oscillator
    integer, intent(in) :: relief                !< index of the relief in the sweep
    type(turn_t), intent(out) :: turn
    type(error_t), allocatable, intent(inout) :: error
    real(dp), intent(in), optional :: unit_stress(:, :)    !< stresses of `unit_root_stress`; absent: no stress
    type(levels_t), allocatable :: levels
    real(dp), allocatable :: start(:)
    integer :: k

    allocate (levels)
    k = minloc(abs(sweep%rpm - rpm), 1)
    if (abs(sweep%rpm(k) - rpm) <= epsilon(rpm)*rpm .and. has_result(sweep%status(k, relief))) start = sweep%state(:, k, relief)
    call find_turn(osc, rpm, stages%accuracy, levels, turn, unit_stress, start)
    if (turn%lacks) call fail(error, code_memory, 'as_built at '//str(rpm)//' 1/min: the memory does not hold the motion')
  end subroutine follow_turn

  !> Nominal root stress of pinion and gear under a unit load that acts from A to E (Pa/N); (gear, place).
  pure function unit_root_stress(pair) result(stress)
    type(pair_t), intent(in) :: pair
    integer, parameter :: places = 101
    real(dp), parameter :: solid = 0             ! rim thickness
    real(dp) :: stress(2, places)
    integer :: i, k

    do i = 1, 2
      stress(i, :) = root_history(pair, i, pair%contact_ratio*[(k, k=0, places - 1)]/(places - 1), &
                                  spread(1.0_dp, 1, places), solid)
    end do
  end function unit_root_stress

  !> Computes all specimens, each to the tolerance or, with `quick`, a sample to the tolerance and the others by the quick method.
  !> Returns early if the caller stops the run.
  subroutine run_specimens(stages, which, rpm, quick, n, specimens, sample_error, error, unit_stress)
    type(stages_t), intent(in) :: stages
    integer, intent(in) :: which(:)              !< reliefs of the case
    real(dp), intent(in) :: rpm(:)               !< speeds of the pinion, 1/min
    logical, intent(in) :: quick
    integer, intent(in) :: n                     !< number of specimens
    type(specimen_t), intent(inout) :: specimens(n)  !< as drawn
    real(dp), intent(inout) :: sample_error(:)   !< largest difference of both methods' dynamic factors, NaN if none; (relief)
    real(dp), allocatable, intent(in) :: unit_stress(:, :)           !< as in `run_exactly`
    type(error_t), allocatable, intent(inout) :: error
    type(deviations_t), allocatable :: deviations(:)
    type(quick_motion_t), allocatable :: motions(:, :)     ! (speed, specimen)
    real(dp) :: sample_dte                       ! largest difference of both methods' transmission errors, m
    logical :: alike(size(rpm)), in_sample(n)
    real(dp) :: class_error(2)                   ! largest difference of motions whose flanks never all separate, and of the others
    integer :: k, r

    ! The first specimen, and one in ten, ten at most.
    in_sample = .not. quick
    associate (sample => min(10, 1 + (n - 1)/10))
      in_sample([(1 + k*(n - 1)/max(1, sample - 1), k=0, sample - 1)]) = .true.
    end associate
    do k = 1, n
      if (.not. in_sample(k)) cycle
      if (allocated(error) .or. wants_stop(stages%accuracy%steady%stop)) return
      call run_exactly(stages, which, rpm, specimens(k), error, unit_stress)
    end do
    if (allocated(error) .or. .not. quick) return
    deviations = [(specimens(k)%deviations, k=1, n)]
    allocate (motions(size(rpm), n))
    do r = 1, size(which)
      call run_quickly(stages%motion(which(r)), deviations, rpm, stages%running%threads, stages%accuracy%steady%stop, motions)
      if (wants_stop(stages%accuracy%steady%stop)) return
      call stages%running%report_progress(size(rpm)*count(.not. in_sample), stages%accuracy%steady%stop)
      sample_error(r) = -1
      class_error = -1
      do k = 1, n
        if (.not. in_sample(k)) cycle
        alike = motions(:, k)%is_found
        sample_error(r) = max(sample_error(r), difference(motions(:, k), specimens(k)%sweep, r, alike))
        ! If one method found more motions than the other, they do not show the error of one.
        alike = motions(:, k)%motions == specimens(k)%sweep%motions(:, r)
        class_error(1) = max(class_error(1), &
                             difference(motions(:, k), specimens(k)%sweep, r, alike .and. .not. motions(:, k)%lost))
        class_error(2) = max(class_error(2), difference(motions(:, k), specimens(k)%sweep, r, alike .and. motions(:, k)%lost))
      end do
      sample_dte = no_number()
      if (sample_error(r) < 0) then
        sample_error(r) = no_number()
      else
        sample_dte = maxval([(dte_off(k), k=1, n)])
        where (class_error < 0) class_error = sample_error(r)
        class_error = max(class_error, least_error)
      end if
      do k = 1, n
        if (in_sample(k)) cycle
        if (r == 1) call allocate_results(size(rpm), size(which), specimens(k))
        call store_motions(stages, which(r), rpm, motions(:, k), class_error, sample_dte, r, specimens(k), error)
        if (allocated(error)) return
      end do
    end do

  contains

    !> Largest difference of the selected motions; below 0 if none of them is known by both methods.
    pure real(dp) function difference(found, sweep, relief, counts)
      type(quick_motion_t), intent(in) :: found(:)         ! (speed)
      type(sweep_t), intent(in) :: sweep
      integer, intent(in) :: relief
      logical, intent(in) :: counts(:)           ! (speed)
      logical :: known(size(found))

      known = counts .and. found%is_found .and. has_result(sweep%status(:, relief))
      difference = maxval(abs(found%peak/stages%motion(1)%load - sweep%dynamic_factor(:, relief)), mask=known)
    end function difference

    !> Largest difference of both methods' peak-to-peak and rms transmission errors of a specimen of the sample, m.
    pure real(dp) function dte_off(k) result(off)
      integer, intent(in) :: k
      logical :: known(size(rpm))

      off = 0
      if (.not. in_sample(k)) return
      associate (found => motions(:, k), sweep => specimens(k)%sweep)
        known = found%is_found .and. has_result(sweep%status(:, r))
        off = max(0.0_dp, maxval(abs(found%largest - found%least - sweep%dte_range(:, r)), mask=known), &
                  maxval(abs(rms_of(found) - sweep%dte_rms(:, r)), mask=known))
      end associate
    end function dte_off
  end subroutine run_specimens

  !> Root mean square of the transmission error about its mean, m.
  elemental real(dp) function rms_of(motion) result(rms)
    type(quick_motion_t), intent(in) :: motion

    rms = sqrt(max(0.0_dp, motion%sums(2) - motion%sums(1)**2))
  end function rms_of

  pure subroutine allocate_results(speeds, reliefs, specimen)
    integer, intent(in) :: speeds, reliefs
    type(specimen_t), intent(inout) :: specimen

    associate (sweep => specimen%sweep)
      allocate (sweep%rpm(speeds))
      allocate (sweep%dynamic_factor(speeds, reliefs), sweep%estimate(speeds, reliefs), sweep%dte_rms(speeds, reliefs), &
                sweep%dte_range(speeds, reliefs), sweep%dte_estimate(speeds, reliefs), sweep%coast_factor(speeds, reliefs), &
                sweep%mesh_multiplier(speeds, reliefs), sweep%seen_factor(speeds, reliefs), &
                sweep%seen_dte_rms(speeds, reliefs), sweep%seen_dte_range(speeds, reliefs), source=no_number())
      allocate (sweep%status(speeds, reliefs), source=status_stopped)
      allocate (sweep%periods(speeds, reliefs), source=1)
      allocate (sweep%motions(speeds, reliefs), sweep%seen_periods(speeds, reliefs), source=0)
      allocate (sweep%state(2, speeds, reliefs), source=0.0_dp)
      allocate (specimen%worst(reliefs))
    end associate
  end subroutine allocate_results

  !> Stores the motions of a specimen, and computes those that the quick method did not find to the tolerance.
  subroutine store_motions(stages, which, rpm, motions, class_error, sample_dte, relief, specimen, error)
    type(stages_t), intent(in) :: stages
    integer, intent(in) :: which                 ! index of the relief in the case
    real(dp), intent(in) :: rpm(:)
    type(quick_motion_t), intent(in) :: motions(:)         ! (speed)
    real(dp), intent(in) :: class_error(2)  ! error of motions whose flanks never all separate, and of the others; -1: not known
    real(dp), intent(in) :: sample_dte           ! error of the transmission error, m
    integer, intent(in) :: relief
    type(specimen_t), intent(inout) :: specimen
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: turning(size(rpm))               ! natural motion over a mesh period, rad
    logical :: is_known                          ! true if the sample has an error
    integer :: k

    is_known = all(class_error >= 0)
    associate (sweep => specimen%sweep, load => stages%motion(which)%load)
      sweep%rpm = rpm
      turning = 2*pi/frequency_ratio(stages%motion(which), rpm)
      where (motions%is_found)
        sweep%dynamic_factor(:, relief) = motions%peak/load
        sweep%estimate(:, relief) = max(merge(class_error(2), class_error(1), motions%lost), motions%off/load)
        sweep%dte_rms(:, relief) = rms_of(motions)
        sweep%dte_range(:, relief) = motions%largest - motions%least
        sweep%coast_factor(:, relief) = 0
        sweep%status(:, relief) = merge(status_ok, status_inexact, sweep%estimate(:, relief) <= tolerance .and. is_known)
        sweep%motions(:, relief) = motions%motions
        sweep%state(1, :, relief) = motions%begin(1)
        sweep%state(2, :, relief) = motions%begin(2)*turning
      end where
      if (is_known) then
        where (motions%is_found) sweep%dte_estimate(:, relief) = max(sample_dte, dte_tolerance*sweep%dte_range(:, relief))
      else
        where (motions%is_found) sweep%estimate(:, relief) = no_number()
      end if
      if (.not. all(motions%is_found)) call solve_remaining(stages, which, rpm, motions, relief, specimen, error)
      if (allocated(error) .or. .not. any(has_result(sweep%status(:, relief)))) return
      k = maxloc(sweep%dynamic_factor(:, relief), 1, mask=has_result(sweep%status(:, relief)))
      specimen%worst(relief) = tooth_t(rpm(k), sweep%dynamic_factor(k, relief), motions(k)%pair, motions(k)%place)
      if (.not. motions(k)%is_found) specimen%worst(relief)%pair = -1
    end associate
  end subroutine store_motions

  !> Computes the speeds that the quick method did not solve.
  subroutine solve_remaining(stages, which, rpm, motions, relief, specimen, error)
    type(stages_t), intent(in) :: stages
    integer, intent(in) :: which, relief
    real(dp), intent(in) :: rpm(:)
    type(quick_motion_t), intent(in) :: motions(:)         ! (speed)
    type(specimen_t), intent(inout) :: specimen
    type(error_t), allocatable, intent(inout) :: error
    type(error_t), allocatable :: refused
    type(sweep_options_t) :: options
    type(sweep_t) :: found
    integer, allocatable :: unsolved(:)
    integer :: i

    unsolved = pack([(i, i=1, size(rpm))], .not. motions%is_found)
    options = stages%sweep_options()
    options%direction = each
    options%largest = .true.
    options%is_counted = .false.
    call run_sweep(deviating(stages%motion([which]), specimen%deviations, error), rpm(unsolved), options, found, refused)
    if (allocated(refused)) then
      call fail(error, refused%code, refused%message)
      return
    end if
    associate (sweep => specimen%sweep)
      sweep%dynamic_factor(unsolved, relief) = found%dynamic_factor(:, 1)
      sweep%estimate(unsolved, relief) = found%estimate(:, 1)
      sweep%dte_rms(unsolved, relief) = found%dte_rms(:, 1)
      sweep%dte_range(unsolved, relief) = found%dte_range(:, 1)
      sweep%dte_estimate(unsolved, relief) = found%dte_estimate(:, 1)
      sweep%coast_factor(unsolved, relief) = found%coast_factor(:, 1)
      sweep%mesh_multiplier(unsolved, relief) = found%mesh_multiplier(:, 1)
      sweep%status(unsolved, relief) = found%status(:, 1)
      sweep%periods(unsolved, relief) = found%periods(:, 1)
      sweep%motions(unsolved, relief) = found%motions(:, 1)
      sweep%seen_factor(unsolved, relief) = found%seen_factor(:, 1)
      sweep%seen_dte_rms(unsolved, relief) = found%seen_dte_rms(:, 1)
      sweep%seen_dte_range(unsolved, relief) = found%seen_dte_range(:, 1)
      sweep%seen_periods(unsolved, relief) = found%seen_periods(:, 1)
      sweep%state(:, unsolved, relief) = found%state(:, :, 1)
    end associate
  end subroutine solve_remaining
end module gearsweep_as_built_specimens
