!> The flat layer under run-time checks: sizes, what is refused, what is left alone, messages.
module test_flat
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_old_calls
  use gearsweep_error, only: code_file, code_input, code_ok
  use gearsweep_kinds, only: dp
  use gearsweep_text, only: str
  use random_numbers, only: random_t
  use testing, only: check_close, check_equal, check_true, new_folder, remove_folder, tally_t
  implicit none
  private
  public :: run

  character(*), parameter :: pair = '&pair module_mm = 3 face_width_mm = 20 / '// &
    '&pinion teeth = 21 effective_mass_kg = 0.5 / &gear teeth = 34 effective_mass_kg = 0.9 / '// &
    '&load normal_force_n = 4000 / &relief amount_um = 0, 10 / &section elements_across = 4 / '
  character(*), parameter :: text = '&case tasks = ''mesh'', ''load'', ''sweep'', ''optimum'', ''static'', ''modal'' / '// &
    pair//'&mesh model = ''fe'' / &static positions = 5 / &modal modes = 3 / '// &
    '&sweep rpm_first = 3000 rpm_last = 6000 rpm_step = 1000 load_rpm = 4000 /    '
  character(*), parameter :: with_section = '&case tasks = ''section'', ''modal'', ''static'', ''sweep'' / '// &
    text(index(text, '/') + 1:)
  real(dp), parameter :: mark = -7

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('messages')) call test_messages(t)
    if (t%wants('geometry_call')) call test_geometry_call(t)
    if (t%wants('results')) call test_results(t)
    if (t%wants('static_results')) call test_static_results(t)
    if (t%wants('shapes')) call test_shapes(t)
    if (t%wants('texts')) call test_texts(t)
    if (t%wants('complete_texts')) call test_complete_texts(t)
    if (t%wants('files')) call test_files(t)
  end subroutine run

  subroutine test_messages(t)
    type(tally_t), intent(inout) :: t
    character(200) :: message
    character(6) :: short
    integer :: n(10), info

    n = -7
    call gs_sizes('', '', n(1), n(2), n(3), n(4), n(5), n(6), n(7), n(8), n(9), n(10), info, message)
    call check_equal(t, 'an empty case is refused', info, code_input)
    call check_true(t, 'it says why', index(message, '&') > 0)
    call check_true(t, 'and leaves the results', all(n == -7))
    call gs_sizes('&colour red = 1 /', '', n(1), n(2), n(3), n(4), n(5), n(6), n(7), n(8), n(9), n(10), info, short)
    call check_true(t, 'a short message is cut', info == code_input .and. len_trim(short) == 6)
    call gs_sizes(text, '', n(1), n(2), n(3), n(4), n(5), n(6), n(7), n(8), n(9), n(10), info, message)
    call check_equal(t, 'sizes', info, code_ok)
    call check_true(t, 'no message', message == '')
    call check_true(t, 'speeds, reliefs, modes', all(n([1, 2, 6]) == [4, 2, 3]))
  end subroutine test_messages

  subroutine test_geometry_call(t)
    type(tally_t), intent(inout) :: t
    real(dp) :: radius(6, 2), point(5), at(5, 2), distance, angle(2), ratio, pitch, backlash
    character(100) :: message
    integer :: info

    call gs_geometry('&case tasks = ''geometry'' / '//pair, radius, point, at, distance, angle, ratio, pitch, &
                     backlash, info, message)
    call check_equal(t, 'geometry', info, code_ok)
    call check_close(t, 'centre distance', distance, 82.5_dp)
    call check_close(t, 'tip radius of the gear', radius(1, 2), 54.0_dp)
    call check_close(t, 'E ends the path', point(5), ratio)
    call check_close(t, 'the pitch point lies on the pitch circle', at(3, 1), 31.5_dp)
    call check_close(t, 'working angle', angle(1), 20.0_dp)
  end subroutine test_geometry_call

  !> Larger arrays than need be, with and without the stiffness passed in.
  subroutine test_results(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: most = 6, room = 60
    real(dp) :: rpm(most), relief(3), df(most, 3, 2), estimate(most, 3), modulus(most, 3), residual(most, 3), none(1)
    real(dp) :: curve(room, 3), best(4), peak(5, 2), rows(3000, 5), ste(2, 4), amplitude(8, 2), phase(8, 2)
    real(dp), allocatable :: work(:)
    integer :: n(10), status(most, 3), contact(most, 3), steps(most, 3), periods(most, 3), failed(room), tried, found, info
    integer :: whole(3000, 3)
    character(200) :: message

    none = 0
    call gs_sizes(text, '', n(1), n(2), n(3), n(4), n(5), n(6), n(7), n(8), n(9), n(10), info, message)
    allocate (work(n(10)), source=mark)
    call gs_prepare(text, '', n(10) - 1, work, info, message)
    call check_true(t, 'work too small', info == code_input .and. index(message, 'at least') > 0)
    call check_true(t, 'work is as it was', all(.not. abs(work - mark) > 0))
    call gs_prepare(text, '', n(10), work, info, message)
    call check_equal(t, 'prepare', info, code_ok)
    df = mark
    call gs_sweep(text, n(10), work, 1, 3, 3, rpm, relief, df(:, :, 1), estimate, status, contact, &
                  modulus, residual, steps, periods, info, message)
    call check_true(t, 'too few speeds', info == code_input .and. all(.not. abs(df - mark) > 0))
    call gs_sweep(text, n(10), work, 1, most, 3, rpm, relief, df(:, :, 1), estimate, status, contact, &
                  modulus, residual, steps, periods, info, message)
    call gs_sweep(text, 0, none, 2, most, 3, rpm, relief, df(:, :, 2), estimate, status, contact, &
                  modulus, residual, steps, periods, info, message)
    call check_equal(t, 'sweep', info, code_ok)
    call check_true(t, 'the same bits with the stiffness passed in', all(.not. abs(df(:, :, 1) - df(:, :, 2)) > 0))
    call check_true(t, 'dynamic factors', all(df(:4, :2, 1) > 0.5_dp))
    call check_true(t, 'what lies beyond is not touched', all(.not. abs(df(5:, :, 1) - mark) > 0) .and. &
                    all(.not. abs(df(:, 3, 1) - mark) > 0))
    call gs_resonances(4, rpm, df(:4, 1, 1), found, peak(:, 1), peak(:, 2), info, message)
    call check_true(t, 'resonances', info == code_ok .and. found >= 0)
    call gs_optimum(text, n(10), work, 1, room, tried, curve(:, 1), curve(:, 2), curve(:, 3), failed, best(1), best(2), &
                    best(3), best(4), info, message)
    call check_true(t, 'optimum', info == code_ok .and. tried > 16 .and. tried <= n(4))
    call check_close(t, 'the best is the least of the curve', best(2), minval(curve(:tried, 2)))
    call gs_harmonics(text, n(10), work, n(9), 2, relief, ste(:, 1), ste(:, 2), ste(:, 3), amplitude, phase, ste(:, 4), &
                      info, message)
    call check_true(t, 'harmonics', info == code_ok .and. n(9) == 8 .and. all(amplitude > 0) .and. all(ste(:, 3) > ste(:, 2)))
    call gs_harmonics(text, n(10), work, n(9) - 1, 2, relief, ste(:, 1), ste(:, 2), ste(:, 3), amplitude, phase, ste(:, 4), &
                      info, message)
    call check_true(t, 'too few harmonics', info == code_input .and. index(message, 'at least 8') > 0)
    call gs_load(text, n(10), work, 10, found, rows(:, 1), rows(:, 2), rows(:, 3), rows(:, 4), rows(:, 5), &
                 whole(:, 1), whole(:, 2), whole(:, 3), info, message)
    call check_true(t, 'load: too little room', info == code_input .and. found > 10)
    call gs_load(text, n(10), work, 3000, found, rows(:, 1), rows(:, 2), rows(:, 3), rows(:, 4), rows(:, 5), &
                 whole(:, 1), whole(:, 2), whole(:, 3), info, message)
    call check_true(t, 'load', info == code_ok .and. maxval(rows(:found, 4)) > 4000*0.9_dp)
    call check_true(t, 'load: steady, one pair like the next', all(whole(:found, 1) == 0) .and. all(whole(:found, 2:) == 1))
    call gs_prepare('&case tasks = ''modal'' / '//pair, '', n(10), work, info, message)
    call check_equal(t, 'no mesh to prepare', info, code_input)
  end subroutine test_results

  subroutine test_static_results(t)
    type(tally_t), intent(inout) :: t
    real(dp), allocatable :: s(:), radius(:), share(:, :), sigma(:, :, :), parts(:, :, :, :), mesh(:, :)
    real(dp) :: relief(2), peak(2, 5), iso, lewis, modes(3, 4), none(1), drive(7)
    integer :: n(10), length, info
    character(200) :: message
    character(9000) :: answer

    none = 0
    call gs_sizes(text, '', n(1), n(2), n(3), n(4), n(5), n(6), n(7), n(8), n(9), n(10), info, message)
    allocate (s(n(5)), radius(n(5)), share(n(5), 2), sigma(2, n(5), 2), parts(3, 2, n(5), 2), mesh(n(3), 7))
    call gs_root(text, 0, none, n(5), 2, relief, s, radius, share, sigma, parts, peak(:, 1), peak(:, 2), peak(:, 3), &
                 peak(:, 4), peak(:, 5), iso, lewis, info, message)
    call check_equal(t, 'root', info, code_ok)
    call check_true(t, 'tension pulls, compression pushes', all(peak(:, 1) > 0 .and. peak(:, 3) < 0) .and. iso > 0)
    call gs_modes(text, 3, 0, modes(:, 1), modes(:, 2), modes(:, 3), modes(:, 4), none, info, message)
    call check_true(t, 'modes', info == code_ok .and. modes(1, 1) > 0)
    call gs_mesh(text, 0, none, n(3) - 1, mesh(:, 1), mesh(:, 2), mesh(:, 3), mesh(:, 4), mesh(:, 5), mesh(:, 6), &
                 mesh(:, 7), info, message)
    call check_equal(t, 'mesh: a row is missing', info, code_input)
    call gs_mesh(text, 0, none, n(3), mesh(:, 1), mesh(:, 2), mesh(:, 3), mesh(:, 4), mesh(:, 5), mesh(:, 6), &
                 mesh(:, 7), info, message)
    call check_true(t, 'mesh', info == code_ok .and. maxval(mesh(:, 6)) <= 1 + 1e-12_dp)
    call gs_motion(text, 0, none, drive(1), drive(2:3), drive(4), drive(5), drive(6), drive(7), info, message)
    call check_close(t, 'load', drive(1), 4000.0_dp)
    call gs_report(text, '', 0, none, 1, answer(:20), length, info, message)
    call check_true(t, 'the answer needs room', info == code_input .and. length > 500)
    call gs_report(text, '', 0, none, 1, answer, length, info, message)
    call check_true(t, 'report', info == code_ok .and. len_trim(answer) >= length - 1)
  end subroutine test_static_results

  !> Outline, grid, mode shapes and stress on the grid fit each other.
  subroutine test_shapes(t)
    type(tally_t), intent(inout) :: t
    real(dp), allocatable :: x(:), y(:), shape(:, :, :), sigma(:, :), outline(:, :)
    integer, allocatable :: element(:, :), tooth(:)
    real(dp) :: modes(3, 4), none(1), place(4)
    integer :: n(10), points, info
    character(200) :: message

    none = 0
    call gs_sizes(with_section, '', n(1), n(2), n(3), n(4), n(5), n(6), n(7), n(8), n(9), n(10), info, message)
    call check_true(t, 'the grid has nodes and elements', info == code_ok .and. n(7) > n(8) .and. n(8) > 0)
    allocate (x(n(7)), y(n(7)), element(8, n(8) + 1), tooth(n(8) + 1), shape(2, n(7), 3), sigma(3, n(7)), outline(5000, 2))
    call gs_section(with_section, n(7) - 1, n(8), x, y, element, tooth, info, message)
    call check_true(t, 'a node is missing', info == code_input .and. index(message, 'nodes') > 0)
    element = -7
    call gs_section(with_section, n(7), n(8) + 1, x, y, element, tooth, info, message)
    call check_equal(t, 'section', info, code_ok)
    call check_true(t, 'elements have nodes', minval(element(:, :n(8))) == 1 .and. maxval(element) == n(7))
    call check_true(t, 'what lies beyond is not touched', all(element(:, n(8) + 1) == -7))
    call gs_outline(with_section, 1, 7, points, outline(:, 1), outline(:, 2), info, message)
    call check_true(t, 'outline: too little room', info == code_input .and. points == 72*21)
    call gs_outline(with_section, 1, 5000, points, outline(:, 1), outline(:, 2), info, message)
    call check_close(t, 'the tip is the grid''s', maxval(norm2(outline(:points, :), 2)), maxval(sqrt(x**2 + y**2)))
    call gs_outline(with_section, 0, 5000, points, outline(:, 1), outline(:, 2), info, message)
    call check_true(t, 'no such gear', info == code_input .and. index(message, 'member') > 0)
    shape = mark
    call gs_modes(with_section, 3, n(7), modes(:, 1), modes(:, 2), modes(:, 3), modes(:, 4), shape, info, message)
    call check_true(t, 'shapes', info == code_ok .and. all(abs(shape - mark) > 0))
    call gs_stress(with_section, 0, none, 2, 1, n(7), place(1), place(2), place(3), place(4), sigma, info, message)
    call check_true(t, 'stress', info == code_ok .and. maxval(sigma) > 0 .and. minval(sigma) < 0)
    call gs_stress(with_section, 0, none, 99, 1, n(7), place(1), place(2), place(3), place(4), sigma, info, message)
    call check_true(t, 'no such position', info == code_input .and. index(message, 'position') > 0)
    call gs_stress(with_section, 0, none, 1, 3, n(7), place(1), place(2), place(3), place(4), sigma, info, message)
    call check_true(t, 'no such relief', info == code_input .and. index(message, 'relief') > 0)
  end subroutine test_shapes

  subroutine test_texts(t)
    type(tally_t), intent(inout) :: t
    character(len(text) + 100) :: changed
    character(9000) :: complete, again
    integer :: length, info
    character(200) :: message

    call gs_change(text, 'pair', 'module_mm', '3.5', changed, length, info, message)
    call check_true(t, 'a key is changed', info == code_ok .and. index(changed, 'module_mm = 3.5 face') > 0)
    call gs_change(text, 'pair', 'backlash_um', '', changed, length, info, message)
    call check_true(t, 'a key that is not there is taken out', info == code_ok .and. changed == text)
    call gs_change(text, 'pair', 'backlash_um', '5 / &x y = 1', changed, length, info, message)
    call check_equal(t, 'one key and no more', info, code_input)
    call gs_change(text, 'pair', 'modul_mm', '3.5', changed, length, info, message)
    call check_true(t, 'a misspelt key', info == code_input .and. &
                    index(message, '&pair modul_mm: unknown key (did you mean module_mm?)') == 1)
    call gs_change(text, 'pairs', 'module_mm', '3.5', changed, length, info, message)
    call check_true(t, 'a misspelt group', info == code_input .and. &
                    index(message, '&pairs: unknown group (did you mean &pair?)') == 1)
    call gs_change(text, 'pair', 'modul_mm', '', changed, length, info, message)
    call check_equal(t, 'a misspelt key taken out', info, code_input)
    call gs_change('&pair modul_mm = 3 /', 'pair', 'modul_mm', '', changed, length, info, message)
    call check_true(t, 'one that the text has is taken out', info == code_ok .and. index(changed, 'modul') == 0)
    call gs_complete(text, complete(:5), length, info, message)
    call check_true(t, 'the complete case needs room', info == code_input .and. length > len(text))
    call gs_complete(text, complete, length, info, message)
    call check_true(t, 'defaults', info == code_ok .and. index(complete, 'damping_ratio = 0.17') > 0)
    call gs_complete(complete(:length), again, length, info, message)
    call check_true(t, 'the complete case is complete', info == code_ok .and. again == complete)
    call gs_change(text, 'case', 'tasks', '''geometry''', changed, length, info, message)
    call gs_unused(changed, again, length, info, message)
    call check_true(t, 'what other tasks would use', info == code_ok .and. &
                    index(again(:length), 'hysteresis or poincare: &sweep rpm_first, rpm_last, rpm_step'//achar(10)) > 0)
    call gs_unused(text, again, length, info, message)
    call check_true(t, 'all is used', info == code_ok .and. length == 0)
  end subroutine test_texts

  !> Random texts, with values of 1 to 17 digits and keys left out at random: where a text is accepted, so is the
  !> complete one; that completes to itself, and has the same answer bit by bit.
  subroutine test_complete_texts(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: draws = 400
    type(random_t) :: random
    character(:), allocatable :: case
    character(9000) :: complete, again
    character(200) :: message
    real(dp) :: ours(20000), other(20000)
    integer :: i, length, info, used, accepted, unlike

    accepted = 0
    unlike = 0
    do i = 1, draws
      call draw_case(random, case)
      call find_numbers(case, ours, used, info)
      if (info /= code_ok) cycle
      accepted = accepted + 1
      call gs_complete(case, complete, length, info, message)
      if (info == code_ok) call gs_complete(complete(:length), again, length, info, message)
      if (info == code_ok) info = merge(0, 1, again == complete)
      if (info == code_ok) call find_numbers(complete(:length), other, used, info)
      if (info == code_ok .and. used <= size(ours)) then
        if (all(transfer(ours(:used), [0_int64]) == transfer(other(:used), [0_int64]))) cycle
      end if
      if (unlike == 0) print '(a)', case, trim(message)
      unlike = unlike + 1
    end do
    call check_true(t, 'most random texts are accepted', 2*accepted > draws, str(accepted)//' of '//str(draws))
    call check_equal(t, 'complete texts with another answer', unlike, 0)
  end subroutine test_complete_texts

  subroutine draw_case(random, case)
    type(random_t), intent(inout) :: random
    character(:), allocatable, intent(out) :: case

    case = '&case tasks = ''geometry'', ''mesh'' / &pair'
    case = case//key('module_mm', 1.0_dp, 5.0_dp, .false.)//key('face_width_mm', 10.0_dp, 30.0_dp, .false.)
    case = case//key('pressure_angle_deg', 17.0_dp, 24.0_dp, .true.)//key('backlash_um', 0.0_dp, 50.0_dp, .true.)
    case = case//' / &pinion teeth = 25'//key('profile_shift', 0.0_dp, 0.2_dp, .true.)//key('addendum', 0.9_dp, 1.0_dp, .true.)
    case = case//key('bore_mm', 0.0_dp, 5.0_dp, .true.)
    case = case//' / &gear teeth = 31'//key('dedendum', 1.2_dp, 1.3_dp, .true.)//key('rack_tip_radius', 0.2_dp, 0.3_dp, .true.)
    case = case//' / &material'//key('young_gpa', 190.0_dp, 215.0_dp, .true.)//key('poisson', 0.2_dp, 0.4_dp, .true.)
    case = case//' / &load'//key('line_load_n_mm', 50.0_dp, 500.0_dp, .false.)//' / &relief'
    case = case//key('amount_um', 0.0_dp, 30.0_dp, .false.)//key('gear_fraction', 0.0_dp, 1.0_dp, .true.)//' /'

  contains

    !> ` name = value`; where it may be left out, each second time.
    function key(name, low, high, may_lack) result(words)
      character(*), intent(in) :: name
      real(dp), intent(in) :: low, high
      logical, intent(in) :: may_lack
      character(:), allocatable :: words
      integer :: digits

      words = ''
      ! Not in one condition: the compiler would decide whether a number is drawn.
      if (may_lack) then
        if (random%uniform() < 0.5_dp) return
      end if
      digits = 1 + int(17*random%uniform())
      words = ' '//name//' = '//str(random%between(low, high), digits)
    end function key
  end subroutine draw_case

  !> All numbers of all tasks.
  subroutine find_numbers(case, values, used, info)
    character(*), intent(in) :: case
    real(dp), intent(out) :: values(:)
    integer, intent(out) :: used, info
    character :: names, answer, stages, files
    character(200) :: message
    real(dp) :: none(1)
    integer :: length

    none = 0
    used = 0
    call gs_files(case, '', 0, none, 1, '', '', size(values), values, used, names, answer, length, stages, files, info, message)
  end subroutine find_numbers

  !> The program's files.
  subroutine test_files(t)
    type(tally_t), intent(inout) :: t
    character(:), allocatable :: out
    character(3000) :: answer, said
    character(2000) :: stages, files, names
    real(dp) :: none(1), values(1)
    real(dp), allocatable :: numbers(:)
    character(*), parameter :: bad(*) = [character(4) :: '', '.', '..', '../x', 'a/b', '/x', 'a'//achar(10)//'b', achar(27)]
    integer :: length, info, used, i
    logical :: there
    character(200) :: message

    none = 0
    out = new_folder()
    call gs_files(with_section, '', 0, none, 1, out, 'case', 0, none, used, names, answer, length, stages, files, info, message)
    call check_true(t, 'write', info == code_ok .and. index(stages, 'sweep') > 0)
    inquire (file=out//'/case.sweep.csv', exist=there)
    call check_true(t, 'the table is there', there .and. index(files, out//'/case.sweep.csv'//new_line('a')) > 0)
    call gs_report(with_section, '', 0, none, 1, said, length, info, message)
    call check_true(t, 'the answer is the report', info == code_ok .and. answer == said)
    call gs_files(with_section, '', 0, none, 1, out//'/no/folder', 'case', 0, none, used, names, answer, length, stages, &
                  files, info, message)
    call check_equal(t, 'no folder', info, code_file)
    do i = 1, size(bad)
      call gs_files(with_section, '', 0, none, 1, out, bad(i), 0, none, used, names, answer, length, stages, files, info, message)
      call check_true(t, 'no name: '//bad(i), info == code_input .and. index(message, 'name') == 1)
    end do
    values = -1
    call gs_files(with_section, '', 0, none, 1, ' ', 'case', 1, values, used, names, answer, length, stages, files, info, message)
    call check_true(t, 'too many numbers: untouched', info == code_ok .and. used > 1 .and. all(values < 0))
    allocate (numbers(used + 1), source=-1.0_dp)
    call gs_files(with_section, '', 0, none, 1, ' ', 'case', size(numbers), numbers, used, names, answer, length, stages, files, &
                info, message)
    call check_true(t, 'numbers alone: no file', info == code_ok .and. files == '')
    call check_true(t, 'the numbers that are told', used == size(numbers) - 1 .and. numbers(used + 1) < 0)
    call check_true(t, 'their names', index(names, 'sweep.dynamic_factor ') > 0 .and. index(names, 'section.x_mm ') > 0)
    call remove_folder(out)
  end subroutine test_files
end module test_flat
