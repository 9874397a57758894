!> The task `precision`: orders of convergence as theory has them, amplitudes in closed form, estimates beside true errors,
!> and which of its numbers are the same in every run.
module test_precision
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_study_case_case, only: case_t
  use gearsweep_api_case_reader, only: read_case
  use gearsweep_base_error, only: error_t
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_study_results_report, only: failed_points, write_report
  use gearsweep_motion_steady_motion, only: status_name
  use gearsweep_study_run_study, only: run_study, study_t
  use gearsweep_base_table, only: kind_text, table_t
  use gearsweep_api_tables, only: make_table, table_names
  use gearsweep_base_text, only: str
  use test_support_reproducible, only: write_reproducible
  use test_support_testing, only: check_close, check_equal, check_error, check_no_error, check_true, tally_t
  implicit none
  private
  public :: run

  character, parameter :: lf = new_line('a')
  !> Stiffness over the path as teeth have it; all pairs stay in contact.
  character(*), parameter :: prescribed = '&case tasks = ''precision'' / &pinion teeth = 25 effective_mass_kg = 0.5 / '// &
    '&gear effective_mass_kg = 0.9 / &load normal_force_n = 4000 / &dynamics damping_ratio = 0.15 / '
  character(*), parameter :: curved = prescribed//'&mesh model = ''polynomial'' contact_ratio = 1.637 '// &
    'coefficients = 400, 30, -110 / &precision rpm = 4330, 5330, 6660, 7990, 9320, 10650 '
  !> Each pair is equally stiff everywhere.
  character(*), parameter :: even = prescribed//'&mesh model = ''polynomial'' contact_ratio = 1.6 coefficients = 400 / '// &
    '&precision harmonics = 5 most_steps = 50 '
  character(*), parameter :: geared = '&case tasks = ''precision'' / &pair module_mm = 3 face_width_mm = 20 / '// &
    '&pinion teeth = 21 / &gear teeth = 34 / &load normal_force_n = 4000 / &mesh model = ''fe'' / '// &
    '&precision most_steps = 50 most_samples = 32 '

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('orders')) call orders(t)
    if (t%wants('estimates')) call estimates(t)
    if (t%wants('harmonics')) call harmonics(t)
    if (t%wants('grids')) call grids(t)
    if (t%wants('times')) call times(t)
    if (t%wants('meanings')) call meanings(t)
    if (t%wants('without_values')) call without_values(t)
  end subroutine run

  !> The study of a case's text, and one of its tables.
  subroutine answer(t, text, study, table, name)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: text
    type(study_t), intent(out) :: study
    type(table_t), intent(out) :: table
    character(*), intent(in) :: name
    type(case_t) :: case
    type(error_t), allocatable :: error

    call read_case(text, case, error)
    if (.not. allocated(error)) call run_study(case, '', 1, study, error)
    if (.not. allocated(error)) call make_table(study, name, table, error)
    call check_no_error(t, 'the run', error)
  end subroutine answer

  !> The numbers of a column in the rows of a quantity and method; of `number` where it is present.
  function numbers(table, column, quantity, method, number) result(list)
    type(table_t), intent(in) :: table
    character(*), intent(in) :: column, quantity, method
    integer, intent(in), optional :: number
    real(dp), allocatable :: list(:)
    logical, allocatable :: mine(:)

    mine = table%columns(table%position('quantity'))%words == quantity .and. &
           table%columns(table%position('method'))%words == method
    if (present(number)) mine = mine .and. nint(table%columns(table%position('number'))%numbers) == number
    list = pack(table%columns(table%position(column))%numbers, mine)
  end function numbers

  !> Mean errors over the speeds, with few steps and with many: Gauss collocation at three points is of sixth order, Runge and
  !> Kutta's method of fourth where steps end at the breaks; with breaks within steps the methods are of first.
  subroutine orders(t)
    type(tally_t), intent(inout) :: t
    type(study_t) :: study
    type(table_t) :: table

    call answer(t, curved//'most_steps = 800 /', study, table, 'precision')
    call check_order('collocation', 25, 100, 6.0_dp, 0.7_dp)
    call check_order('rk4', 50, 400, 4.0_dp, 0.5_dp)
    call check_order('rk4_equal', 50, 800, 1.0_dp, 0.5_dp)
    call check_order('constant', 50, 800, 1.0_dp, 0.5_dp)

  contains

    subroutine check_order(method, few, many, expected, margin)
      character(*), intent(in) :: method
      integer, intent(in) :: few, many
      real(dp), intent(in) :: expected, margin
      real(dp), allocatable :: error(:), steps(:)
      real(dp) :: order

      error = numbers(table, 'error', 'dynamic_factor', method)
      steps = numbers(table, 'resolution', 'dynamic_factor', method)
      call check_equal(t, method//': rows', size(error), 6*6)
      order = log(sum(error, mask=nint(steps) == few)/sum(error, mask=nint(steps) == many))/log(real(many, dp)/few)
      call check_true(t, method//': order', abs(order - expected) < margin, str(order))
    end subroutine check_order
  end subroutine orders

  !> Where a method has an estimate, the true error lies below it, but for what the reference and rounding leave.
  subroutine estimates(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: methods(4) = [character(11) :: 'collocation', 'rk4', 'rk4_equal', 'constant']
    real(dp), parameter :: rounding = 1e-13_dp
    type(study_t) :: study
    type(table_t) :: table, reference
    type(error_t), allocatable :: error
    real(dp), allocatable :: true_error(:), estimate(:)
    real(dp) :: left
    integer :: i

    call answer(t, curved//'most_steps = 800 /', study, table, 'precision')
    call make_table(study, 'precision_finest', reference, error)
    left = maxval(numbers(reference, 'error_estimate', 'dynamic_factor', 'collocation'))
    call check_true(t, 'the reference is exact', left < 1e-10_dp, str(left))
    do i = 1, size(methods)
      true_error = numbers(table, 'error', 'dynamic_factor', trim(methods(i)))
      estimate = numbers(table, 'error_estimate', 'dynamic_factor', trim(methods(i)))
      if (i <= 2) call check_true(t, trim(methods(i))//': within its estimate', all(true_error <= estimate + left + rounding), &
                                  str(maxval(true_error - estimate)))
      if (i > 2) call check_true(t, trim(methods(i))//': has no estimate', all(ieee_is_nan(estimate)))
    end do
  end subroutine estimates

  !> Equal stiffness everywhere: the transmission error jumps between load/(2 K) over the fraction 0.6 of the period and
  !> load/K, whose Fourier series is known.
  subroutine harmonics(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: jump = 1e6_dp*4000/(2*400e6_dp)     ! um
    type(study_t) :: study
    type(table_t) :: table, reference
    type(error_t), allocatable :: error
    real(dp), allocatable :: value(:), off(:)
    real(dp) :: amplitude, scale
    integer :: k

    call answer(t, even//'most_samples = 4096 /', study, table, 'precision')
    call make_table(study, 'precision_finest', reference, error)
    scale = 2*jump*sin(0.6_dp*pi)/pi
    do k = 1, 5
      amplitude = 2*jump*abs(sin(0.6_dp*pi*k))/(pi*k)
      value = numbers(reference, 'value', 'ste_harmonic', 'segments', k)
      call check_close(t, 'the reference, harmonic '//str(k), value(1), amplitude, absolute=1e-12_dp*scale)
      value = numbers(table, 'value', 'ste_harmonic', 'segments', k)
      call check_close(t, 'by segments, harmonic '//str(k), value(size(value)), amplitude, absolute=1e-12_dp*scale)
      value = numbers(table, 'value', 'ste_harmonic', 'fft', k)
      off = numbers(table, 'error', 'ste_harmonic', 'fft', k)
      call check_equal(t, 'samples from 16 to 4096', size(value), 9)
      call check_close(t, 'the error is that of the closed form, harmonic '//str(k), off(9), abs(value(9) - amplitude)/scale, &
                       absolute=1e-12_dp)
      ! Each of the two jumps is up to one sample late.
      call check_true(t, 'by samples, harmonic '//str(k), off(9) < 4.0_dp*jump/4096/scale .and. off(9) > 0, str(off(9)))
    end do
    off = numbers(table, 'error_estimate', 'ste_harmonic', 'fft')
    call check_true(t, 'samples tell no error', all(ieee_is_nan(off)))
    off = numbers(table, 'error', 'natural_frequency', 'elements')
    call check_equal(t, 'a prescribed mesh has no grids', size(off), 0)
    call check_true(t, 'which the log says', index(study%log, 'grids left out: the mesh is prescribed'//lf) > 0, study%log)
  end subroutine harmonics

  !> So few samples do not have all harmonics, and have no rows for the others; a row without a value says why and counts.
  subroutine without_values(t)
    type(tally_t), intent(inout) :: t
    type(study_t) :: study
    type(table_t) :: table
    type(case_t) :: case
    type(error_t), allocatable :: error
    character(12) :: ok
    real(dp), allocatable :: value(:)
    integer :: k

    call answer(t, prescribed//'&mesh model = ''polynomial'' contact_ratio = 1.6 coefficients = 400 / '// &
                '&precision harmonics = 20 most_steps = 50 most_samples = 64 /', study, table, 'precision')
    ! Of 16, 32 and 64 samples, those with more than two in a period of the harmonic.
    do k = 1, 20
      value = numbers(table, 'value', 'ste_harmonic', 'fft', k)
      call check_equal(t, 'samples that have harmonic '//str(k), size(value), count([16, 32, 64] > 2*k))
    end do
    call check_equal(t, 'a value in every row', count(ieee_is_nan(table%numbers('value'))), 0)
    call check_equal(t, 'none fails', failed_points(study), 0)
    ! Equal steps of the fourth-order method are too long for a mesh so much slower than its own motion.
    call answer(t, prescribed//'&mesh model = ''polynomial'' contact_ratio = 1.6 coefficients = 400 / '// &
                '&precision rpm = 40 most_steps = 1600 most_samples = 32 /', study, table, 'precision')
    ok = status_name(0)
    call check_equal(t, 'each row without a value says why', count(ieee_is_nan(table%numbers('value'))), &
                     count(table%columns(table%position('status'))%words /= ok))
    call check_true(t, 'there are such rows', failed_points(study) > 0)
    call check_equal(t, 'and counts', failed_points(study), count(ieee_is_nan(table%numbers('value'))))
    call read_case(geared//'most_elements = 51 /', case, error)
    call check_error(t, 'more elements than the reference has a grid for', error, contains='&precision most_elements = 51')
    deallocate (error)
    ! A whole ring takes more still, and it is not elements_across that is at fault.
    call read_case(geared//'most_elements = 50 / &section teeth = 0 /', case, error)
    if (.not. allocated(error)) call run_study(case, '', 1, study, error)
    call check_error(t, 'more elements than the memory holds', error, contains='&precision most_elements = 50: ')
  end subroutine without_values

  !> The error shrinks with the elements, and the estimate, for second order, is of its size: the order lies between 1.5 and 4.
  subroutine grids(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: quantities(2) = [character(17) :: 'natural_frequency', 'root_tension']
    type(study_t) :: study
    type(table_t) :: table, reference
    type(error_t), allocatable :: error
    real(dp), allocatable :: off(:), estimate(:), across(:)
    integer :: i

    call answer(t, geared//'most_elements = 12 /', study, table, 'precision')
    call make_table(study, 'precision_finest', reference, error)
    across = numbers(table, 'resolution', 'pair_stiffness', 'elements')
    call check_true(t, 'elements across', all(nint(across) == [3, 4, 6, 9, 12]))
    across = numbers(reference, 'resolution', 'pair_stiffness', 'elements')
    call check_true(t, 'of the reference', all(nint(across) == [24]))
    do i = 1, size(quantities)
      off = numbers(table, 'error', trim(quantities(i)), 'elements', 1)
      estimate = numbers(table, 'error_estimate', trim(quantities(i)), 'elements', 1)
      call check_true(t, trim(quantities(i))//': converges', off(5) < off(2)/3, str(off(2))//' '//str(off(5)))
      call check_true(t, trim(quantities(i))//': estimate', all(off < 4*estimate .and. off > estimate/20), &
                      str(maxval(off/estimate))//' '//str(minval(off/estimate)))
    end do
    off = numbers(table, 'error', 'pair_stiffness', 'elements')
    call check_true(t, 'pair stiffness: converges', off(5) < off(1)/3, str(off(1))//' '//str(off(5)))
  end subroutine grids

  !> Run times are the only column that is declared as differing from run to run, and all else is the same bits.
  subroutine times(t)
    type(tally_t), intent(inout) :: t
    type(study_t) :: study, again
    type(table_t) :: table, ignored
    type(error_t), allocatable :: error
    character(:), allocatable :: names(:), text, other
    real(dp), allocatable :: seconds(:)
    integer :: i, k

    call answer(t, geared//'most_elements = 4 /', study, table, 'precision')
    call answer(t, geared//'most_elements = 4 /', again, ignored, 'precision')
    seconds = table%columns(table%position('run_time_s'))%numbers
    call check_true(t, 'times are above 0', all(seconds > 0), str(minval(seconds)))
    call check_true(t, 'and of seconds', all(seconds < 60), str(maxval(seconds)))
    call write_report(study, text)
    call check_rounded_times(t, text, table)
    call answer(t, curved//'most_steps = 6400 /', again, ignored, 'precision')
    seconds = numbers(ignored, 'run_time_s', 'dynamic_factor', 'rk4')
    call check_true(t, '256 times the steps take longer', seconds(9) > 20*seconds(1), str(seconds(1))//' '//str(seconds(9)))
    call answer(t, geared//'most_elements = 4 /', again, ignored, 'precision')
    names = table_names()
    do i = 1, size(names)
      call make_table(study, trim(names(i)), table, error)
      if (.not. table%is_there()) cycle
      do k = 1, size(table%columns)
        call check_true(t, trim(names(i))//' '//table%columns(k)%name//': is declared', &
                        table%columns(k)%is_reproducible .neqv. table%columns(k)%name == 'run_time_s')
      end do
      call write_reproducible(study, trim(names(i)), text, error)
      call write_reproducible(again, trim(names(i)), other, error)
      call check_true(t, trim(names(i))//': the same bits', text == other)
    end do
  end subroutine times

  !> The last column of the screen is the run time of the finest resolution of each method, to one digit.
  subroutine check_rounded_times(t, screen, table)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: screen
    type(table_t), intent(in) :: table
    character(20) :: quantity, method
    character(2) :: unit
    character(:), allocatable :: line
    real(dp), allocatable :: seconds(:)
    real(dp) :: shown
    integer :: from, until, shown_lines

    shown_lines = 0
    from = index(screen, 'Precision at')
    do
      from = from + index(screen(from:)//lf, lf)
      if (from > len(screen)) exit
      until = from + index(screen(from:)//lf, lf) - 2
      line = screen(from:until)
      if (len_trim(line) == 0) exit
      if (index(line, 'quantity') > 0) cycle
      read (line, *) quantity, method
      read (line(len(line) - 7:), *) shown, unit
      if (unit == 'us') shown = 1e-6_dp*shown
      if (unit == 'ms') shown = 1e-3_dp*shown
      seconds = numbers(table, 'run_time_s', trim(quantity), trim(method), 1)
      ! A half of its digit, which is 0.5e-6 s at least.
      call check_close(t, line, shown, max(1e-6_dp, seconds(size(seconds))), &
                       absolute=0.5001_dp*10.0_dp**floor(log10(1.001_dp*shown)))
      shown_lines = shown_lines + 1
    end do
    call check_equal(t, 'lines with a time', shown_lines, 9)
  end subroutine check_rounded_times

  !> No number without a meaning: each column says what it is, each row which unit.
  subroutine meanings(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: quantities(5) = [character(17) :: 'dynamic_factor', 'ste_harmonic', 'natural_frequency', &
                                                'root_tension', 'pair_stiffness']
    character(*), parameter :: units(5) = [character(4) :: '', 'um', 'Hz', 'MPa', 'N/um']
    character(*), parameter :: names(2) = [character(16) :: 'precision', 'precision_finest']
    type(study_t) :: study
    type(table_t) :: table
    type(error_t), allocatable :: error
    integer :: i, k, which

    call answer(t, geared//'most_elements = 4 /', study, table, 'precision')
    do i = 1, size(names)
      call make_table(study, trim(names(i)), table, error)
      do k = 1, size(table%columns)
        call check_true(t, trim(names(i))//' '//table%columns(k)%name//': a meaning', len(table%columns(k)%meaning) > 15)
      end do
      do k = 1, table%rows
        which = findloc(quantities == table%columns(table%position('quantity'))%words(k), .true., 1)
        call check_true(t, trim(names(i))//': every quantity is one of the list', which > 0)
        if (which > 0) call check_equal(t, 'unit of '//quantities(which), &
                                        trim(table%columns(table%position('unit'))%words(k)), trim(units(which)))
      end do
      do which = 1, size(quantities)
        call check_true(t, trim(names(i))//' has '//quantities(which), &
                        any(table%columns(table%position('quantity'))%words == quantities(which)))
        call check_true(t, trim(names(i))//': its meaning names '//quantities(which), &
                        index(table%columns(table%position('quantity'))%meaning, trim(quantities(which))) > 0)
      end do
    end do
    call check_equal(t, 'words are text', table%columns(1)%kind, kind_text)
  end subroutine meanings
end module test_precision
