!> Stress and displacement at a tooth's fillets while the load passes over it, by modal superposition on two grids.
module gearsweep_rating_tooth_transient
  use gearsweep_base, only: code_input, dp, error_t, fail, pi, sorted, str
  use gearsweep_gear, only: coast, drive
  use gearsweep_elastic, only: find_peaks, load_history_t, motion_record_t, peak_difference, per_point, root_stress_t, superpose, &
    tooth_modes_t
  use gearsweep_rating_passage, only: passage_t
  implicit none
  private
  public :: damping_t, sampling_t, tooth_transient_t, damp_modes, follow_tooth

  !> Damping of the modes: a ratio for each, or by Rayleigh C = alpha M + beta K.
  type :: damping_t
    logical :: is_rayleigh = .false.
    real(dp) :: ratio = 0.01_dp
    real(dp) :: alpha = 0                        !< mass-proportional part, 1/s
    real(dp) :: beta = 0                         !< stiffness-proportional part, s
  end type damping_t

  !> Times of the samples.
  type :: sampling_t
    integer :: samples = 400                     !< number of equal steps of the total time, if no step is stated
    real(dp) :: step = 0                         !< time step, s; 0: from the number of samples
    logical :: corrected = .true.                !< true: with the static correction
  end type sampling_t

  type :: tooth_transient_t
    type(motion_record_t) :: record              !< recorded rows: those of the chosen points, per_point for each
    real(dp), allocatable :: s(:), load(:)       !< path coordinate and load (N); (sample)
    type(root_stress_t) :: peaks                 !< largest stresses of the fillets over time, with the error estimate
    type(root_stress_t) :: static                !< largest stresses under the static load
    real(dp), allocatable :: point_error(:)      !< relative error of the largest stress at each chosen point
    real(dp) :: look = 0                         !< time between the samples of the peak search, s
  end type tooth_transient_t

  !> Samples per period of the highest mode, largest number of samples in the peak search, and of steps.
  integer, parameter :: per_period = 8, most_looks = 10000, most_steps = 1000000
  !> Points on either side of the largest one whose times are examined.
  integer, parameter :: about = 2

contains

  !> Sets the damping of the modes. `error`: one of them would gain energy; `what` names the input.
  pure subroutine damp_modes(damping, tooth, what, error)
    type(damping_t), intent(in) :: damping
    type(tooth_modes_t), intent(inout) :: tooth
    character(*), intent(in) :: what
    type(error_t), allocatable, intent(inout) :: error
    integer :: k

    if (allocated(error)) return
    associate (w => tooth%model%frequency)
      allocate (tooth%model%damping, source=2*damping%ratio*w)
      if (damping%is_rayleigh) tooth%model%damping = damping%alpha + damping%beta*w**2
      k = minloc(tooth%model%damping, 1)
      if (tooth%model%damping(k) >= 0) return
      call fail(error, code_input, what//' = '//str(damping%alpha)//': the damping ratio of mode '//str(k)//' at '// &
                str(w(k)/(2*pi), 5)//' Hz would be '//str(tooth%model%damping(k)/(2*w(k)), 3)//'; must be at least '// &
                str(-damping%beta*w(k)**2, 5)//' with this rayleigh_beta_s')
    end associate
  end subroutine damp_modes

  !> Computes the response of a tooth. `tooth(2)`: on both grids, damped, the finer first; `error_share`: of their difference.
  subroutine follow_tooth(tooth, error_share, passage, look, product, error)
    type(tooth_modes_t), intent(in) :: tooth(2)
    real(dp), intent(in) :: error_share
    type(passage_t), intent(in) :: passage
    type(sampling_t), intent(in) :: look
    type(tooth_transient_t), intent(out) :: product
    type(error_t), allocatable, intent(inout) :: error
    type(motion_record_t) :: coarse
    type(root_stress_t) :: seen, coarsely_seen
    real(dp), allocatable :: sample(:)
    integer :: finer, k, row(2)
    real(dp) :: largest, off

    associate (history => passage%history)
      call choose_times(tooth(1)%model%frequency, history%time, look, sample, finer, error)
      if (allocated(error)) return
      product%look = (sample(2) - sample(1))/finer
      call superpose(tooth(1)%model, history, chosen_rows(tooth(1)), sample, finer, look%corrected, product%record, error)
      if (allocated(error)) return
      call superpose(tooth(2)%model, history, chosen_rows(tooth(2)), sample, finer, look%corrected, coarse, error)
      if (allocated(error)) return
      allocate (product%s, source=[(at_time(history%time, passage%s, sample(k)), k=1, size(sample))])
      allocate (product%load, source=[(at_time(history%time, history%load, sample(k)), k=1, size(sample))])
    end associate
    call find_moments(tooth(1), passage%history, look%corrected, product, error)
    if (allocated(error)) return
    call fill_fillets(tooth(1), extremes(product%record), seen)
    call fill_fillets(tooth(2), extremes(coarse), coarsely_seen)
    product%peaks%error_estimate = max(peak_difference(seen, coarsely_seen, seen%tension), &
                                       peak_difference(seen, coarsely_seen, seen%compression))*error_share
    ! Relative difference of the two grids at the chosen points, for second order.
    allocate (product%point_error(size(tooth(1)%direction, 2)))
    do k = 1, size(product%point_error)
      row = [tooth(1)%row_of(k), tooth(2)%row_of(k)] + 1
      associate (fine => product%record)
        largest = max(abs(fine%highest(row(1))), abs(fine%lowest(row(1))))
        off = max(abs(fine%highest(row(1)) - coarse%highest(row(2))), abs(fine%lowest(row(1)) - coarse%lowest(row(2))))
        product%point_error(k) = off/largest*error_share
      end associate
    end do
  end subroutine follow_tooth

  !> Chooses the samples, and the number of steps between two samples for the peak search. With a stated step only the samples are
  !> used.
  pure subroutine choose_times(frequency, time, look, sample, finer, error)
    real(dp), intent(in) :: frequency(:), time(:)
    type(sampling_t), intent(in) :: look
    real(dp), allocatable, intent(out) :: sample(:)
    integer, intent(out) :: finer
    type(error_t), allocatable, intent(inout) :: error
    real(dp), parameter :: slack = 1e-9_dp
    real(dp) :: duration
    integer :: n, k

    duration = time(size(time)) - time(1)
    if (look%step > 0) then
      if (duration/look%step > most_steps) then
        call fail(error, code_input, 'step of the passage (s) = '//str(look%step)//': the passage takes more than '// &
                  str(most_steps)//' steps')
        return
      end if
      n = max(1, floor(duration/look%step*(1 + slack)))
      sample = time(1) + min(duration, [(look%step*k, k=0, n)])
      finer = 1
    else
      n = look%samples
      sample = time(1) + [(duration*k/n, k=0, n)]
      finer = max(1, ceiling(min(per_period*duration*maxval(frequency)/(2*pi), real(most_looks, dp))/n))
    end if
  end subroutine choose_times

  !> Rows of the chosen points.
  pure function chosen_rows(tooth) result(rows)
    type(tooth_modes_t), intent(in) :: tooth
    integer :: rows(per_point*size(tooth%direction, 2))
    integer :: i

    rows = [(tooth%row_of(1) + i, i=1, size(rows))]
  end function chosen_rows

  !> Finds the largest stresses of the fillets in motion and at rest, also between their points. Neighbouring points may peak at
  !> different times, so that a curve through their peaks is the stress at no time: the fillets are evaluated at the times at which
  !> the points around the largest one peak.
  subroutine find_moments(tooth, history, corrected, product, error)
    type(tooth_modes_t), intent(in) :: tooth
    type(load_history_t), intent(in) :: history
    logical, intent(in) :: corrected
    type(tooth_transient_t), intent(inout) :: product
    type(error_t), allocatable, intent(inout) :: error
    type(motion_record_t) :: moments
    real(dp), allocatable :: at_rest(:, :), time(:)
    integer :: high(2*about + 1), low(2*about + 1), i

    associate (record => product%record, n => size(tooth%side(drive)%along) + size(tooth%side(coast)%along))
      high = around(tooth, maxloc(record%highest(:n), 1))
      low = around(tooth, minloc(record%lowest(:n), 1))
      time = sorted([record%time_highest(high), record%time_lowest(low)])
      call superpose(tooth%model, history, [(i, i=1, n)], [history%time(1), time], 1, corrected, moments, error)
      if (allocated(error)) return
      call fill_fillets(tooth, moments%value, product%peaks)
      ! At rest the stress is linear between the times of the history, and so largest at one of them.
      at_rest = matmul(tooth%model%static(:n, :), history%weight*spread(history%load, 1, size(history%weight, 1)))
      high = around(tooth, maxloc(maxval(at_rest, 2), 1))
      low = around(tooth, minloc(minval(at_rest, 2), 1))
      at_rest = at_rest(:, [maxloc(at_rest(high, :), 2), minloc(at_rest(low, :), 2)])
      call fill_fillets(tooth, at_rest, product%static)
    end associate
  end subroutine find_moments

  !> Rows of the neighbours of a row of a fillet, on the same side.
  pure function around(tooth, row) result(rows)
    type(tooth_modes_t), intent(in) :: tooth
    integer, intent(in) :: row
    integer :: rows(2*about + 1)
    integer :: first, i

    first = tooth%first_of_side(merge(drive, coast, row <= tooth%first_of_side(coast)))
    associate (n => merge(size(tooth%side(drive)%along), size(tooth%side(coast)%along), first == 0))
      rows = [(max(first + 1, min(first + n, row + i)), i=-about, about)]
    end associate
  end function around

  !> Largest and least value of each row, each at its own time.
  pure function extremes(record) result(values)
    type(motion_record_t), intent(in) :: record
    real(dp) :: values(size(record%highest), 2)

    values(:, 1) = record%highest
    values(:, 2) = record%lowest
  end function extremes

  !> Collects the stresses (row, column) along the fillets as columns, and their largest values.
  pure subroutine fill_fillets(tooth, rows, fillets)
    type(tooth_modes_t), intent(in) :: tooth
    real(dp), intent(in) :: rows(:, :)
    type(root_stress_t), intent(out) :: fillets
    integer :: side

    fillets%gear = tooth%unit%gear
    fillets%side = tooth%side
    do side = drive, coast
      associate (first => tooth%first_of_side(side), n => size(tooth%side(side)%along))
        fillets%side(side)%stress = rows(first + 1:first + n, :)
      end associate
    end do
    call find_peaks(fillets)
  end subroutine fill_fillets

  !> Value at a time, linear between given times in ascending order; of two at the same time, the later one.
  pure real(dp) function at_time(time, values, now) result(value)
    real(dp), intent(in) :: time(:), values(:), now
    real(dp) :: share
    integer :: i

    i = min(size(time) - 1, max(1, count(time <= now)))
    share = 1
    if (time(i + 1) > time(i)) share = min(1.0_dp, (now - time(i))/(time(i + 1) - time(i)))
    value = values(i)*(1 - share) + values(i + 1)*share
  end function at_time
end module gearsweep_rating_tooth_transient
