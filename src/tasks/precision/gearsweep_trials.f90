!> What the task `precision` tries: one result by several methods at several resolutions, each with its run time and its
!> error against a result that is finer than all of them.
module gearsweep_trials
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use, intrinsic :: iso_c_binding, only: c_ptr
  use gearsweep_clock, only: stopwatch_t
  use gearsweep_coefficients, only: scheme_collocation, scheme_constant, scheme_rk4, scheme_rk4_equal
  use gearsweep_error, only: error_t
  use gearsweep_error_estimate, only: accuracy_t, point_t
  use gearsweep_fe_stiffness, only: fe_stiffness
  use gearsweep_disc, only: disc_t
  use gearsweep_harmonics, only: find_harmonics, harmonics_t
  use gearsweep_inputs, only: elements_inputs_t
  use gearsweep_interval, only: interval_t
  use gearsweep_kinds, only: dp, pi
  use gearsweep_mesh, only: mesh_t
  use gearsweep_modal, only: modal_t, section_modes
  use gearsweep_operating_point, only: solve_point
  use gearsweep_oscillator, only: mesh_period, oscillator_t
  use gearsweep_piecewise, only: piecewise_t
  use gearsweep_refinement, only: levels_t
  use gearsweep_root_rating, only: outer_point
  use gearsweep_section, only: section_options_t
  use gearsweep_section_body, only: make_two_grids, section_body_t
  use gearsweep_sharing, only: transmission_error
  use gearsweep_smooth_intervals, only: smooth_intervals
  use gearsweep_status, only: has_result, status_inexact, status_name, status_ok
  use gearsweep_stop, only: wants_stop
  use gearsweep_stress, only: root_stress, root_stress_t
  use gearsweep_table, only: no_number
  use gearsweep_stages, only: stages_t
  use gearsweep_text, only: str
  implicit none
  private
  public :: trials_t, result_t, try_methods, try_harmonics, try_grids

  integer, parameter :: word = 18

  !> One result; as a reference, without error and run time.
  type :: result_t
    character(word) :: quantity = '', method = ''
    integer :: number = 1                        !< of the harmonic or mode
    real(dp) :: relief = -1, rpm = -1            !< um, 1/min; below 0: does not matter
    character(4) :: unit = ''
    integer :: resolution = 0
    real(dp) :: value = 0                        !< in this unit
    real(dp) :: error = 0, estimate = 0          !< relative
    real(dp) :: seconds = 0
    integer :: status = status_ok
  end type result_t

  !> Of each list the first so many.
  type :: trials_t
    type(result_t), allocatable :: results(:), references(:)
    integer :: result_count = 0, reference_count = 0
  end type trials_t

  integer, parameter, public :: least_steps = 25, least_samples = 16, least_elements = 3
  integer, parameter :: schemes(4) = [scheme_collocation, scheme_rk4, scheme_rk4_equal, scheme_constant]
  character(*), parameter :: names(4) = [character(word) :: 'collocation', 'rk4', 'rk4_equal', 'constant']

contains

  !> The dynamic factor by all methods, each from the motion of the reference on, so that all find that one.
  subroutine try_methods(osc, rpm, relief, most_steps, stop, trials)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm, relief          !< 1/min, um
    integer, intent(in) :: most_steps
    type(c_ptr), intent(in) :: stop              !< the flag that ends the run
    type(trials_t), intent(inout) :: trials
    ! Newton's method is to leave no error.
    real(dp), parameter :: closed = 1e-11_dp
    type(accuracy_t) :: options
    type(levels_t), allocatable :: levels
    type(point_t) :: truth, point
    type(stopwatch_t) :: watch
    type(result_t) :: found
    integer :: i

    found = result_t('dynamic_factor', 'collocation', relief=relief, rpm=rpm, resolution=4*most_steps)
    options%steady%tolerance = closed
    options%steady%stop = stop
    options%steps = found%resolution
    allocate (levels)
    call solve_point(osc, mesh_period(osc%mesh%teeth(1), rpm), options, levels, truth)
    call note(truth)
    call append(found, trials%references, trials%reference_count)
    if (.not. has_result(found%status)) return
    do i = 1, size(schemes)
      options%scheme = schemes(i)
      options%steps = fewest(most_steps, least_steps)
      do while (options%steps <= most_steps)
        if (wants_stop(stop)) return
        found%method = names(i)
        found%resolution = options%steps
        deallocate (levels)
        allocate (levels)
        ! The coefficients are tabulated once, as in a sweep, and so before the first lap.
        call solve_point(osc, mesh_period(osc%mesh%teeth(1), rpm), options, levels, point, truth%steady%state)
        watch = stopwatch_t()
        do while (watch%goes_on())
          call solve_point(osc, mesh_period(osc%mesh%teeth(1), rpm), options, levels, point, truth%steady%state)
        end do
        found%seconds = watch%shortest
        call note(point)
        found%error = abs(found%value/truth%dynamic_factor - 1)
        call append(found, trials%results, trials%result_count)
        options%steps = 2*options%steps
      end do
    end do

  contains

    !> None is asked for a tolerance.
    subroutine note(point)
      type(point_t), intent(in) :: point
      real(dp), parameter :: no_estimate = 1e3_dp

      found%status = point%steady%status
      if (found%status == status_inexact) found%status = status_ok
      found%value = no_number()
      found%estimate = no_number()
      if (.not. has_result(found%status)) return
      found%value = point%dynamic_factor
      if (ieee_is_nan(point%estimate)) return
      if (point%estimate < no_estimate) found%estimate = point%estimate/point%dynamic_factor
    end subroutine note
  end subroutine try_methods

  !> Amplitudes of the static transmission error, by integration over its smooth segments and by the Fourier transform of
  !> equally spaced samples.
  subroutine try_harmonics(osc, relief, harmonics, most_samples, trials)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: relief               !< um
    integer, intent(in) :: harmonics, most_samples
    type(trials_t), intent(inout) :: trials
    integer, parameter :: most_halvings = 4
    real(dp), parameter :: nothing = 1e-12_dp    ! of the mean
    type(harmonics_t) :: truth, part
    type(stopwatch_t) :: watch
    real(dp) :: scale, amplitude(harmonics)
    integer :: i, samples

    call find_harmonics(osc%mesh, osc%load, harmonics, truth)
    scale = max(maxval(truth%amplitude), nothing*abs(truth%mean))
    samples = 0
    do i = 0, most_halvings
      watch = stopwatch_t()
      do while (watch%goes_on())
        call find_harmonics(osc%mesh, osc%load, harmonics, part, halvings=i)
      end do
      if (part%samples == samples) exit
      samples = part%samples
      call add('segments', part%amplitude, part%error_estimate)
    end do
    samples = fewest(most_samples, least_samples)
    do while (samples <= most_samples)
      watch = stopwatch_t()
      do while (watch%goes_on())
        call transform(osc%mesh, osc%load, samples, amplitude)
      end do
      call add('fft', amplitude, no_number())
      samples = 2*samples
    end do
    do i = 1, harmonics
      call append(result_t('ste_harmonic', 'segments', i, relief, -1.0_dp, 'um', truth%samples, 1e6_dp*truth%amplitude(i), &
                           estimate=truth%error_estimate/scale), trials%references, trials%reference_count)
    end do

  contains

    subroutine add(method, amplitude, estimate)
      character(*), intent(in) :: method
      real(dp), intent(in) :: amplitude(:), estimate
      integer :: k

      do k = 1, size(amplitude)
        ! So few samples do not have it.
        if (ieee_is_nan(amplitude(k))) cycle
        call append(result_t('ste_harmonic', method, k, relief, -1.0_dp, 'um', samples, 1e6_dp*amplitude(k), &
                             abs(amplitude(k) - truth%amplitude(k))/scale, estimate/scale, watch%shortest), &
                    trials%results, trials%result_count)
      end do
    end subroutine add
  end subroutine try_harmonics

  !> Amplitudes (m) of the first harmonics of the static transmission error from equally spaced samples, as a fast Fourier
  !> transform gives them; NaN for those of which a period has not more than two samples.
  pure subroutine transform(mesh, load, samples, amplitude)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: load                 !< N
    integer, intent(in) :: samples
    real(dp), intent(out) :: amplitude(:)
    type(interval_t), allocatable :: intervals(:)
    complex(dp) :: total(size(amplitude)), turn, term
    integer :: i, k, n

    intervals = smooth_intervals(mesh, .false.)
    total = 0
    n = 1
    do i = 0, samples - 1
      associate (phase => real(i, dp)/samples)
        do while (n < size(intervals) .and. phase >= intervals(n)%last)
          n = n + 1
        end do
        turn = exp(cmplx(0.0_dp, -2*pi*phase, dp))
        term = 2*transmission_error(mesh, intervals(n), load, phase)/samples
      end associate
      do k = 1, size(total)
        term = term*turn
        total(k) = total(k) + term
      end do
    end do
    amplitude = abs(total)
    do k = 1, size(amplitude)
      if (2*k >= samples) amplitude(k) = no_number()
    end do
  end subroutine transform

  !> What finite elements give, the reference first: on grids of twice as many elements across.
  subroutine try_grids(stages, most_elements, modes, trials, error)
    type(stages_t), intent(in) :: stages         !< with a pair of gears
    integer, intent(in) :: most_elements, modes
    type(trials_t), intent(inout) :: trials
    type(error_t), allocatable, intent(inout) :: error
    type(result_t), allocatable :: truth(:), found(:)
    integer :: across(6), i, k

    across = [2*most_elements, most_elements/4, (3*most_elements)/8, most_elements/2, &
              (3*most_elements)/4, most_elements]
    do i = 1, size(across)
      if (across(i) < least_elements .or. wants_stop(stages%accuracy%steady%stop)) cycle
      call solve_grids(stages, across(i), modes, merge(1, 3, i == 1), found, error)
      if (allocated(error)) error%message = '&precision most_elements = '//str(most_elements)//': '//error%message
      if (allocated(error)) return
      if (i == 1) then
        call move_alloc(found, truth)
        cycle
      end if
      found%error = abs(found%value/truth%value - 1)
      do k = 1, size(found)
        call append(found(k), trials%results, trials%result_count)
      end do
    end do
    if (.not. allocated(found)) return
    ! Nothing estimates the error of the pair stiffness: as for the others, it is taken from half the fineness.
    where (truth%quantity == 'pair_stiffness') truth%estimate = found%error/3
    do k = 1, size(truth)
      call append(truth(k), trials%references, trials%reference_count)
    end do
  end subroutine try_grids

  !> All that is computed on grids of this fineness. A result needs its two grids and what is solved on them.
  subroutine solve_grids(stages, across, modes, laps, found, error)
    type(stages_t), intent(in) :: stages
    integer, intent(in) :: across, modes
    integer, intent(in) :: laps                  !< at least, of which the shortest counts
    type(result_t), allocatable, intent(out) :: found(:)
    type(error_t), allocatable, intent(inout) :: error
    type(section_options_t) :: options
    type(section_body_t) :: grids(2)
    type(modal_t) :: modal
    type(root_stress_t) :: stress
    type(stopwatch_t) :: making, vibrating, loading
    integer :: i

    making = stopwatch_t(fewest=laps)
    vibrating = making
    loading = making
    options = stages%body_inputs%options
    options%elements_across = across
    do while (making%goes_on())
      call make_two_grids(stages%body_inputs%gear, stages%body_inputs%material, options, grids, error)
      if (allocated(error)) return
    end do
    do while (vibrating%goes_on())
      call section_modes(grids, modes, modal, error)
      if (allocated(error)) return
    end do
    do while (loading%goes_on())
      call root_stress(grids, [outer_point(stages%pair, stages%member)], &
                       [stages%load/minval(stages%pair%gear%spec%face_width)], stress, error)
      if (allocated(error)) return
    end do
    found = [(result_t('natural_frequency', 'elements', i, -1.0_dp, -1.0_dp, 'Hz', across, modal%modes%frequency(i), &
                       estimate=modal%error_estimate(i), seconds=making%shortest + vibrating%shortest), i=1, modes), &
             result_t('root_tension', 'elements', 1, -1.0_dp, -1.0_dp, 'MPa', across, 1e-6_dp*stress%tension%stress, &
                      estimate=stress%error_estimate, seconds=making%shortest + loading%shortest)]
    if (allocated(stages%elements_inputs)) call add_stiffness(stages, across, laps, found, error)
  end subroutine solve_grids

  !> Stiffness of a pair in the middle of the path of contact.
  subroutine add_stiffness(stages, across, laps, found, error)
    type(stages_t), intent(in) :: stages
    integer, intent(in) :: across, laps
    type(result_t), allocatable, intent(inout) :: found(:)
    type(error_t), allocatable, intent(inout) :: error
    type(elements_inputs_t) :: inputs
    type(piecewise_t) :: curve
    type(disc_t) :: disc
    type(stopwatch_t) :: watch

    inputs = stages%elements_inputs
    inputs%options%section%elements_across = across
    inputs%options%section%others_across = min(4, across)
    watch = stopwatch_t(fewest=laps)
    do while (watch%goes_on())
      call fe_stiffness(inputs%pair, inputs%material, inputs%options, inputs%line_load, curve, disc, error)
      if (allocated(error)) return
    end do
    found = [found, result_t('pair_stiffness', 'elements', 1, -1.0_dp, -1.0_dp, 'N/um', across, &
                             1e-6_dp*curve%value(stages%pair%contact_ratio/2), estimate=no_number(), seconds=watch%shortest)]
  end subroutine add_stiffness

  !> The number that leads to `most` by doubling, and not below `least`.
  pure integer function fewest(most, least)
    integer, intent(in) :: most, least

    fewest = most
    do while (mod(fewest, 2) == 0 .and. fewest/2 >= least)
      fewest = fewest/2
    end do
  end function fewest

  !> Appends to a list of which `length` are in use.
  pure subroutine append(one, list, length)
    type(result_t), intent(in) :: one
    type(result_t), allocatable, intent(inout) :: list(:)
    integer, intent(inout) :: length
    type(result_t), allocatable :: larger(:)

    if (.not. allocated(list)) allocate (list(64))
    if (length == size(list)) then
      allocate (larger(2*length))
      larger(:length) = list
      call move_alloc(larger, list)
    end if
    length = length + 1
    list(length) = one
  end subroutine append
end module gearsweep_trials
