!> Text helpers, namelist text and the reader: what is accepted, and each error.
module test_reader
  use, intrinsic :: ieee_arithmetic, only: ieee_negative_inf, ieee_quiet_nan, ieee_value
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_study_case_case, only: case_t
  use gearsweep_api_case_reader, only: read_case
  use gearsweep_base_text, only: closest_word, join, lower, shown, str, to_number, visible
  use gearsweep_base_decimal, only: write_decimal
  use gearsweep_base_error, only: code_input, error_t
  use gearsweep_base_kinds, only: dp
  use gearsweep_study_reader_namelist, only: namelist_t, parse_namelist
  use gearsweep_study_reader_reader, only: open_reader, reader_t
  use gearsweep_base_text_rows, only: find_rows, rows_t
  use test_support_testing, only: check_close, check_equal, check_error, check_no_error, check_true, tally_t
  implicit none
  private
  public :: run

  character, parameter :: lf = achar(10), cr = achar(13), tab = achar(9)

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('str')) call test_str(t)
    if (t%wants('decimals')) call test_decimals(t)
    if (t%wants('words')) call test_words(t)
    if (t%wants('to_number')) call test_to_number(t)
    if (t%wants('layout')) call test_layout(t)
    if (t%wants('strings')) call test_strings(t)
    if (t%wants('counts')) call test_counts(t)
    if (t%wants('broken_text')) call test_broken_text(t)
    if (t%wants('odd_characters')) call test_odd_characters(t)
    if (t%wants('tables')) call test_tables(t)
    if (t%wants('broken_tables')) call test_broken_tables(t)
    if (t%wants('absurd_sizes')) call test_absurd_sizes(t)
    if (t%wants('numbers')) call test_numbers(t)
    if (t%wants('lists')) call test_lists(t)
    if (t%wants('twice')) call test_twice(t)
    if (t%wants('texts')) call test_texts(t)
    if (t%wants('defaults')) call test_defaults(t)
    if (t%wants('wrong_values')) call test_wrong_values(t)
    if (t%wants('unknown')) call test_unknown(t)
    if (t%wants('random_text')) call test_random_text(t)
  end subroutine run

  subroutine test_str(t)
    type(tally_t), intent(inout) :: t

    call check_equal(t, 'a short real', str(3.18_dp), '3.18')
    call check_equal(t, 'a whole real', str(1600.0_dp), '1600')
    call check_equal(t, 'a tiny real', str(1.2e-7_dp), '1.2e-7')
    call check_equal(t, 'a small real', str(-0.00012345678_dp), '-0.000123457')
    call check_equal(t, 'a large real', str(123456789.0_dp), '1.23457e8')
    call check_equal(t, 'rounding up to a new digit', str(999999.7_dp), '1e6')
    call check_equal(t, 'zero', str(0.0_dp), '0')
    call check_equal(t, 'three digits', str(2.0_dp/3, 3), '0.667')
    call check_equal(t, 'all digits', str(0.1_dp, 17), '0.10000000000000001')
    call check_equal(t, 'no number', str(ieee_value(1.0_dp, ieee_quiet_nan)), 'NaN')
    call check_equal(t, 'an integer', str(-42), '-42')
    call check_equal(t, 'a logical', str(.true.)//str(.false.), 'truefalse')
  end subroutine test_str

  !> Against Fortran's own editing: all sizes, ties, what is about to get another digit, and no numbers.
  subroutine test_decimals(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: draws = 20000
    real(dp) :: x(8*draws), u(2)
    character(24) :: ours, own
    integer :: i, length, off

    do i = 1, draws
      call random_number(u)
      associate (y => (2*u(1) - 1)*10**(600*u(2) - 300), p => 10.0_dp**modulo(i, 30)/1e12_dp)
        x(8*i - 7:8*i) = [y, u(1)*10**(20*u(2)), u(1)/10**(20*u(2)), anint(1e16_dp*u(1))/8, p, nearest(p, -1.0_dp), &
                          nearest(p, 1.0_dp), 0.0_dp]
      end associate
    end do
    x(:4) = [-0.0_dp, ieee_value(u(1), ieee_quiet_nan), ieee_value(u(1), ieee_negative_inf), 12345678901234.25_dp]
    off = 0
    do i = 1, size(x)
      call write_decimal(x(i), merge(15, 9, modulo(i, 16) < 8), ours, length)
      if (modulo(i, 16) < 8) write (own, '(es24.14e3)') x(i)
      if (modulo(i, 16) >= 8) write (own, '(es24.8e3)') x(i)
      if (ours(:length) /= adjustl(own)) off = off + 1
    end do
    call check_equal(t, 'decimals as Fortran rounds them', off, 0)
  end subroutine test_decimals

  subroutine test_words(t)
    type(tally_t), intent(inout) :: t

    call check_equal(t, 'lower case', lower('Module_MM [Z]'), 'module_mm [z]')
    call check_equal(t, 'joined words', join(['up  ', 'down'], ', '), 'up, down')
    call check_equal(t, 'a short text is shown', shown('a'//tab//'b'//char(200)), 'a<U+0009>b'//char(195)//char(136))
    call check_equal(t, 'a text is cut between characters', shown(repeat('x', 56)//repeat(char(195)//char(136), 9)), &
                     repeat('x', 56)//'...')
    call check_equal(t, 'a long text is cut', shown(repeat('x', 100)), repeat('x', 57)//'...')
    call check_equal(t, 'the closest word', closest_word('modul_mm', ['bore_mm  ', 'module_mm']), 2)
    call check_equal(t, 'a forgotten unit', closest_word('face_width', ['face_width_mm']), 1)
    call check_equal(t, 'one character rather than an ending', closest_word('rpm_stp', ['rpm     ', 'rpm_step']), 2)
    call check_equal(t, 'an ending rather than two characters', closest_word('module', ['nodules  ', 'module_mm']), 2)
    call check_equal(t, 'a slip and a forgotten ending', closest_word('dampping', ['friction     ', 'damping_ratio']), 2)
    call check_equal(t, 'the present name of a former one', closest_word('member', ['remember', 'gear    ']), 2)
    call check_equal(t, 'no close word', closest_word('colour', ['module_mm', 'bore_mm  ']), 0)
  end subroutine test_words

  subroutine test_to_number(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: good(*) = [character(8) :: '1', '1.', '.5', '1e3', '1d3', '+1', '-2.5E-3', '1e-999']
    real(dp), parameter :: expected(*) = [1.0_dp, 1.0_dp, 0.5_dp, 1e3_dp, 1e3_dp, 1.0_dp, -2.5e-3_dp, 0.0_dp]
    character(*), parameter :: bad(*) = [character(8) :: '', '.', '+', 'e5', '1e', '1e5.', '1.2.3', 'nan', &
      & 'inf', 'Infinity', '0x10', '1e999', '-1e308', '1+3', '1 2', '1,5', '1_dp', '1e9e9', '--1']
    real(dp) :: x
    integer :: i, whole
    logical :: ok

    do i = 1, size(good)
      call to_number(trim(good(i)), x, ok)
      call check_true(t, 'number '//good(i), ok)
      call check_close(t, 'value of '//good(i), x, expected(i), relative=1e-15_dp)
    end do
    do i = 1, size(bad)
      call to_number(trim(bad(i)), x, ok)
      call check_true(t, 'no number: '//bad(i), .not. ok)
      call to_number(trim(bad(i)), whole, ok)
      call check_true(t, 'no integer: '//bad(i), .not. ok)
    end do
    call to_number('-2147483647', whole, ok)
    call check_true(t, 'a large integer', ok .and. whole == -huge(whole))
    call to_number('2147483648', whole, ok)
    call check_true(t, 'too large an integer', .not. ok)
    call to_number('25.', whole, ok)
    call check_true(t, 'a point is not for integers', .not. ok)
  end subroutine test_to_number

  subroutine test_layout(t)
    type(tally_t), intent(inout) :: t

    call check_parsed(t, 'one line', '&pair a=1 b = 2/', 'pair:a=1;pair:b=2;')
    call check_parsed(t, 'CRLF, tabs and case', '&Pair'//cr//lf//tab//'A'//tab//'= X'//cr//lf//'/'//cr//lf, &
      & 'pair:a=X;')
    call check_parsed(t, 'a byte order mark', char(239)//char(187)//char(191)//'&p a=1 /', 'p:a=1;')
    call check_parsed(t, '&end', '&p a=1 &END'//lf//'&q &end', 'p:a=1;')
    call check_parsed(t, '& alone', '&p a=1 &'//lf//'&q b=2 &'//lf, 'p:a=1;q:b=2;')
    call check_parsed(t, 'old names of groups', '$p a=1 $end $q b=''$'' $'//lf//'$r c=3 /', 'p:a=1;q:b="$";r:c=3;')
    call check_parsed(t, 'CR', '&p a=1 ! x'//cr//' b=2'//cr//'/'//cr, 'p:a=1;p:b=2;')
    call check_parsed(t, 'an end mark', '&p a=1 /'//cr//lf//achar(26), 'p:a=1;')
    call check_parsed(t, 'indices', '&p a(1)=1 a(2)=2, 3, a( 4 ) = ''x'' b (1) = 5 c=6 /', 'p:a=1|2|3|"x";p:b=5;p:c=6;')
    call check_parsed(t, 'values over lines', '&p a = 1,'//lf//' 2'//lf//' 3 ! 4'//lf//', 5, /', 'p:a=1|2|3|5;')
    call check_parsed(t, 'nothing given', '&p a =   b = 5 c = / ! x', 'p:b=5;')
    call check_parsed(t, 'nothing but a comma given', '&p a = , b = 5 /', 'p:b=5;')
    call check_parsed(t, 'comments', '! &q'//lf//'&p ! a=1'//lf//'b!'//lf//'=2!/'//lf//'/! end', 'p:b=2;')
    call check_parsed(t, 'equal keys in two groups', '&p a=1/ &q a=2/', 'p:a=1;q:a=2;')
  end subroutine test_layout

  subroutine test_strings(t)
    type(tally_t), intent(inout) :: t

    call check_parsed(t, 'both quotes', '&p a=''it''''s'', "say ""yes""", '''', "it''s" /', &
      & 'p:a="it''s"|"say "yes""|""|"it''s";')
    call check_parsed(t, 'signs in strings', '&p a="! / & = ,"/', 'p:a="! / & = ,";')
    call check_parsed(t, 'other alphabets', '&p a="Z'//char(195)//char(164)//'hne"/', &
      & 'p:a="Z'//char(195)//char(164)//'hne";')
  end subroutine test_strings

  subroutine test_counts(t)
    type(tally_t), intent(inout) :: t

    call check_parsed(t, 'repeated values', '&p a = 3*0.5, 1 2*''x y'' /', 'p:a=0.5|0.5|0.5|1|"x y"|"x y";')
    call check_parsed(t, 'a star alone', '&p a = *, x*2 /', 'p:a=*|x*2;')
    call check_broken(t, 'count 0', '&p a = 0*1 /', 'line 1: a repeat count must be 1 to 100000')
    call check_broken(t, 'count too large', '&p a = 100001*1 /', 'a repeat count must be')
    call check_broken(t, 'count beyond integers', '&p a = 99999999999999999999*1 /', 'a repeat count must be')
    call check_broken(t, 'null values', '&p'//lf//' a = 3* /', 'line 2: a repeat count without a value')
  end subroutine test_counts

  subroutine test_broken_text(t)
    type(tally_t), intent(inout) :: t

    call check_broken(t, 'empty', '', 'line 1: there is no group')
    call check_broken(t, 'only comments', '! x'//lf//'! y', 'there is no group')
    call check_broken(t, 'outside', '&p /'//lf//'a = 1', 'line 2: text outside a group: a = 1')
    call check_broken(t, 'never closed', lf//'&p a = 1'//lf//lf, 'line 2: group &p is never closed')
    call check_broken(t, 'next without end', '&p a = 1'//lf//'&q /', 'line 1: group &p is never closed')
    call check_broken(t, 'a group twice', '&p /'//lf//'&P /', 'line 2: group &p is given twice')
    call check_broken(t, 'a key twice', '&p a = 1'//lf//'A = 2 /', 'line 2: key a is given twice in &p')
    call check_broken(t, 'no group name', '& p /', 'no group can be called')
    call check_broken(t, 'a wrong group name', '&2p /', 'no group can be called &2p')
    call check_broken(t, 'only an end', '&end', 'no group can be called &end')
    call check_broken(t, 'no key', '&p'//lf//'1, 2 /', 'line 2: a value without a key: 1')
    call check_broken(t, 'no =', '&p a 1 /', 'a value without a key: a')
    call check_broken(t, 'no key at all', '&p = 1 /', 'no key in front of =')
    call check_broken(t, 'two =', '&p a == 1 /', 'no key in front of =')
    call check_broken(t, 'a string as key', '&p ''a'' = 1 /', 'a value without a key')
    call check_broken(t, 'no first index', '&p a(2) = 1 /', 'line 1: a(2): the values of a list must follow each other')
    call check_broken(t, 'an index left out', '&p a(1) = 1 a(3) = 2 /', 'a(3): the values of a list must follow each other')
    call check_broken(t, 'an index twice', '&p a(1) = 1 a(1) = 2 /', 'key a is given twice in &p')
    call check_broken(t, 'an index behind another key', '&p a(1) = 1 b = 2 a(2) = 3 /', 'a(2): the values of a list must')
    call check_broken(t, 'an index of another key', '&p a(1) = 1 b(2) = 2 /', 'b(2): the values of a list must')
    call check_broken(t, 'two indices', '&p'//lf//'a(1, 2) = 1 /', 'line 2: a(1, 2): an index must be one whole number')
    call check_broken(t, 'a range of indices', '&p a(1:2) = 1, 2 /', 'a(1:2): an index must be one whole number')
    call check_broken(t, 'index 0', '&p a(0) = 1 /', 'a(0): an index must be one whole number from 1 on')
    call check_broken(t, 'an open index', '&p a(1 = 2 /', 'a(1: an index must be')
    call check_broken(t, 'an index and no key', '&p (1) = 2 /', 'this is no key: (1)')
    call check_broken(t, 'a part', '&p a%b = 1 /', 'keys with parts are not supported: a%b')
    call check_broken(t, 'a number as key', '&p 5 = 1 /', 'this is no key: 5')
    call check_broken(t, 'an open string', '&p a = "x'//lf//' " /', 'line 1: a string is never closed: "x')
    call check_broken(t, 'an open string at the end', '&p a = "', 'a string is never closed')
    call check_broken(t, 'a quote in a word', '&p a = it''s /', 'a quote inside it''')
    call check_broken(t, 'a word at a string', '&p a = "x"y /', 'no blank or comma behind "x"')
    call check_broken(t, 'null between', '&p a = 1,,2 /', 'no value between two commas')
    call check_broken(t, 'null first', '&p a = ,2 /', 'no value in front of a comma')
    call check_broken(t, 'a comma first', '&p , a = 2 /', 'a comma without a key')
    call check_broken(t, 'a NUL byte', '&p'//lf//'a = 1'//achar(0)//' /', 'line 2: a control character (code 0)')
    call check_broken(t, 'an escape byte', '&p a = "'//achar(27)//'" /', 'a control character (code 27)')
    call check_broken(t, 'an end mark inside', '&p'//achar(26)//'a = 1 /', 'a control character (code 26)')
    call check_broken(t, 'old names of groups', '$p a = 1', 'group &p is never closed')
  end subroutine test_broken_text

  !> Characters that text programs put in place of those of ASCII, by their bytes in UTF-8 as the Unicode standard lists them.
  subroutine test_odd_characters(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: e2 = achar(226), c2 = achar(194)
    character(*), parameter :: minus = e2//achar(136)//achar(146), dash = e2//achar(128)//achar(147), &
                               left = e2//achar(128)//achar(152), right = e2//achar(128)//achar(153), space = c2//achar(160), &
                               no_width = e2//achar(128)//achar(139), wide = achar(239)//achar(188)//achar(145)

    call check_broken(t, 'a minus sign', '&p'//lf//' a = '//minus//'0.1 /', &
                      'line 2: &p a = '//minus//'0.1: '''//minus//''' is U+2212, a minus sign of text programs; type ''-''')
    call check_broken(t, 'a dash', '&p a = 1 b = '//dash//'2 /', &
                      '&p b = '//dash//'2: '''//dash//''' is U+2013, an en dash; type ''-''')
    call check_broken(t, 'curly quotes', '&p a = '//left//'x'//right//' /', left//''' is U+2018, a quotation mark')
    call check_broken(t, 'a no-break space', '&p a ='//space//'21 /', '&p a = <U+00A0>21: U+00A0 is a no-break space; type a plain')
    call check_broken(t, 'the same in Latin-1', '&p a ='//achar(160)//'21 /', '<U+00A0>21: U+00A0 is a no-break space')
    call check_broken(t, 'in front of a key', '&p a = 1 '//space//'b = 21 /', 'line 1: &p <U+00A0>b: U+00A0 is')
    call check_broken(t, 'in front of a group', no_width//'&p a = 1 /', 'line 1: <U+200B>: U+200B is a zero-width space; remove it')
    call check_broken(t, 'in the name of a group', '&p'//no_width//' a = 1 /', '&p<U+200B>: U+200B is a zero-width space')
    call check_broken(t, 'a figure of full width', '&p a = '//wide//' /', &
                      wide//''' is U+FF11, a character of full width; type ''1''')
    call check_broken(t, 'a letter', '&p gr'//achar(246)//achar(223)//'e = 1 /', 'U+00F6, which may be in quotation marks')
    call check_broken(t, 'UTF-16', achar(255)//achar(254)//'&'//achar(0)//'p'//achar(0), 'in UTF-16; save it in UTF-8')
    call check_broken(t, 'UTF-16, the high byte first', achar(0)//'&'//achar(0)//'p', 'in UTF-16; save it in UTF-8')
    call check_parsed(t, 'all of them in strings and remarks', &
                      '&p a = "'//minus//dash//left//space//'" ! '//minus//space//lf//'/', &
                      'p:a="'//minus//dash//left//space//'";')
    ! Of Latin-1, and of neither: half a character, one with a byte too many, half a pair of UTF-16.
    call check_parsed(t, 'Latin-1', '&p a = "'//achar(228)//achar(246)//'" /', &
                      'p:a="'//achar(195)//achar(164)//achar(195)//achar(182)//'";')
    call check_parsed(t, 'half a character', '&p a = "'//achar(226)//'" /', 'p:a="'//achar(195)//achar(162)//'";')
    call check_parsed(t, 'too long a form', '&p a = "'//achar(224)//achar(160)//'x" /', &
                      'p:a="'//achar(195)//achar(160)//c2//achar(160)//'x";')
  end subroutine test_odd_characters

  !> One table in all ways in which spreadsheets, data frames and hands write it: with the same rows in all.
  subroutine test_tables(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: separators(*) = [character(2) :: ',', ';', tab, ' ', ', ', ' ;']
    character(*), parameter :: ends(*) = [character(2) :: lf, cr//lf, cr]
    character(*), parameter :: mark = char(239)//char(187)//char(191)
    character(:), allocatable :: separator, line_end, table, name
    integer :: i, k, decimal

    do i = 1, size(separators)
      separator = separators(i) (:merge(2, 1, i > 4))
      do k = 1, size(ends)
        line_end = trim(ends(k))
        do decimal = 0, merge(1, 0, index(separator, ',') == 0)
          name = 'separator '//str(i)//', line end '//str(k)//', decimals '//str(decimal)
          call write_table('name', '')
          call check_table(t, name, table)
          call write_table('"NAME"', mark)
          call check_table(t, name//', all else besides', table//'! remark'//line_end//repeat(separator, 3)//line_end// &
                           ' '//line_end//char(26))
        end do
      end do
    end do
    ! Numbers without a header, as of a stiffness over the path.
    call check_pairs(t, 'commas', '0,150'//lf//'0.8,200')
    call check_pairs(t, 'commas and blanks', '0, 150 '//lf//'0.8 ,'//tab//'200')
    call check_pairs(t, 'semicolons with decimal commas', '0;150,0'//lf//'0,8;200;')
    call check_pairs(t, 'tabs with decimal commas', '0'//tab//'150,0'//lf//'0,8'//tab//tab//'200')
    call check_pairs(t, 'blanks with decimal commas', '  0,0  150'//lf//'0,8 200')
    call check_pairs(t, 'a comma, then a tab', '0, 150'//lf//'0.8'//tab//'200')
    call check_pairs(t, 'a semicolon, then a tab', '0; 150'//lf//'0,8'//tab//'200')
    call check_pairs(t, 'names above', mark//'S, Stiffness'//lf//'0, 150'//lf//'8d-1, 2e2'//lf//',,')

  contains

    !> With a name that has the separator in it, in quotation marks.
    subroutine write_table(column, front)
      character(*), intent(in) :: column, front

      table = front//'# remark; with, all'//tab//'of them'//line_end//'Tooth'//separator//column//separator//'deviation_UM'// &
              separator//line_end//'21.0'//separator//'"a'//separators(i) (1:1)//' ""b"""'//separator//'-1.5e1'//line_end// &
              '3'//separator//'plain'//separator//merge('0,25', '0.25', decimal == 1)//separator//line_end
    end subroutine write_table

    subroutine check_table(t, name, text)
      type(tally_t), intent(inout) :: t
      character(*), intent(in) :: name, text
      type(rows_t) :: rows
      type(error_t), allocatable :: error
      character(:), allocatable :: fields(:)
      real(dp) :: x
      integer :: whole
      logical :: ok(3)

      call find_rows(text, 'file', 'tooth,name,deviation_um', rows, error)
      call check_no_error(t, name, error)
      if (allocated(error)) return
      call check_equal(t, name//': rows', size(rows%rows), 2)
      if (size(rows%rows) /= 2) return
      call rows%fields(1, 3, fields, ok(1))
      call rows%whole_number(fields(1), whole, ok(2))
      call rows%number(fields(3), x, ok(3))
      call check_true(t, name//': first row', all(ok) .and. whole == 21 .and. abs(x + 15) <= 0 .and. &
                      fields(2) == 'a'//separators(i) (1:1)//' "b"')
      call rows%fields(2, 3, fields, ok(1))
      call rows%whole_number(fields(1), whole, ok(2))
      call rows%number(fields(3), x, ok(3))
      call check_true(t, name//': second row', all(ok) .and. whole == 3 .and. abs(x - 0.25_dp) <= 0 .and. fields(2) == 'plain')
    end subroutine check_table

    !> 0, 150 and 0.8, 200.
    subroutine check_pairs(t, name, text)
      type(tally_t), intent(inout) :: t
      character(*), intent(in) :: name, text
      type(rows_t) :: rows
      type(error_t), allocatable :: error
      character(:), allocatable :: fields(:)
      real(dp) :: x(2, 2)
      logical :: ok(3)
      integer :: row

      call find_rows(text, 'file', '', rows, error)
      call check_no_error(t, name, error)
      if (allocated(error)) return
      call check_equal(t, name//': rows', size(rows%rows), 2)
      x = -1
      do row = 1, min(2, size(rows%rows))
        call rows%fields(row, 2, fields, ok(1))
        call rows%number(fields(1), x(1, row), ok(2))
        call rows%number(fields(2), x(2, row), ok(3))
        call check_true(t, name//': two numbers', all(ok))
      end do
      call check_true(t, name//': numbers', all(abs(x - reshape([0.0_dp, 150.0_dp, 0.8_dp, 200.0_dp], [2, 2])) <= 0))
    end subroutine check_pairs
  end subroutine test_tables

  !> What no rule covers is not guessed.
  subroutine test_broken_tables(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: header = 'tooth,roll_mm', minus = char(226)//char(136)//char(146)

    call refuse('no header', '# x', 'file: lacks the line tooth,roll_mm')
    call refuse('another header', lf//'roll_mm;tooth'//lf, 'file line 2: roll_mm;tooth: must be tooth,roll_mm')
    call refuse('a column more', 'tooth,roll_mm,flank'//lf, 'must be tooth,roll_mm')
    call refuse('UTF-16', char(255)//char(254)//'t'//char(0), 'file line 1: the text is in UTF-16; save it in UTF-8')
    call refuse('a control character', 'tooth,roll_mm'//cr//'1,'//char(27), 'file line 2: a control character (code 27)')
    call refuse('a no-break space in the header', 'tooth,'//char(194)//char(160)//'roll_mm', 'U+00A0 is a no-break space; type a')
    call refuse_row('a decimal comma among commas', '1,2,5', 'file line 2: why; decimals take a point')
    call refuse_row('a minus sign', '1,'//minus//'2', 'why; '''//minus//''' is U+2212')
    call refuse_row('a field less', '1', 'file line 2: why')
    call refuse_row('two commas in a number', '1;1,2,3', 'file line 2: why')
    call refuse_row('a decimal comma alone', '1;', 'file line 2: why')
    call refuse_pair('0;150'//lf//'0,8')
    call refuse_pair('0,0 150'//lf//'0,8')
    call refuse_row('points of thousands', '1;1.234,5', 'file line 2: why')

  contains

    subroutine refuse(name, text, message)
      character(*), intent(in) :: name, text, message
      type(rows_t) :: rows
      type(error_t), allocatable :: error

      call find_rows(text, 'file', header, rows, error)
      call check_error(t, name, error, contains=message)
    end subroutine refuse

    !> A row of one number with a decimal comma below one that has such commas.
    subroutine refuse_pair(text)
      character(*), intent(in) :: text
      type(rows_t) :: rows
      type(error_t), allocatable :: error
      character(:), allocatable :: fields(:)
      logical :: ok

      call find_rows(text, 'file', '', rows, error)
      call check_no_error(t, text, error)
      call rows%fields(2, 2, fields, ok)
      call check_true(t, 'not two numbers: '//text, .not. ok)
    end subroutine refuse_pair

    !> A row that cannot be read as two numbers.
    subroutine refuse_row(name, row, message)
      character(*), intent(in) :: name, row, message
      type(rows_t) :: rows
      type(error_t), allocatable :: error
      character(:), allocatable :: fields(:)
      real(dp) :: x
      logical :: ok(3)

      call find_rows(merge('tooth;roll_mm', 'tooth,roll_mm', index(row, ';') > 0)//lf//row, 'file', header, rows, error)
      call check_no_error(t, name, error)
      call rows%fields(1, 2, fields, ok(1))
      call rows%number(fields(1), x, ok(2))
      call rows%number(fields(2), x, ok(3))
      call check_true(t, name//': is not read', .not. all(ok))
      call rows%refuse(1, 'why', error)
      call check_error(t, name, error, contains=message)
    end subroutine refuse_row
  end subroutine test_broken_tables

  !> None of these takes long, or much memory.
  subroutine test_absurd_sizes(t)
    type(tally_t), intent(inout) :: t
    type(namelist_t) :: namelist
    type(error_t), allocatable :: error
    character(*), parameter :: long_name = repeat('x', 64)
    integer, parameter :: million = 1000000

    call check_broken(t, 'a long text', repeat(' ', 10*million + 1), 'the text is longer than 10 MB')
    call check_broken(t, 'many keys', '&p '//repeat('a= ', million), 'more than 1000 keys')
    call check_broken(t, 'many repeated values', '&p a='//repeat('100000*"abcdefghi" ', 20)//'/', &
      & 'the repeated values are too many')
    call check_broken(t, 'a long key', '&p '//long_name//' = 1 /', 'this is no key')
    call check_broken(t, 'a long group', '&'//long_name//' /', 'no group can be called')
    call parse_namelist('&p a='//repeat('1 ', million)//' b='//repeat('''''''''', million)//'/', namelist, error)
    call check_no_error(t, 'many values', error)
    if (allocated(error)) return
    call check_equal(t, 'all of the values', size(namelist%entries(1)%values), million)
    call check_equal(t, 'a long string', len(namelist%entries(2)%values(1)%text), 2*million - 1)
  end subroutine test_absurd_sizes

  subroutine test_numbers(t)
    type(tally_t), intent(inout) :: t
    type(reader_t) :: reader
    type(error_t), allocatable :: error
    real(dp) :: module, angle
    integer :: teeth
    logical :: flag, other, given

    module = 0
    angle = 0
    teeth = 0
    flag = .false.
    other = .true.
    call open_reader('&Pair Module_mm=3d0 angle=-.5 teeth = +25 flag=T other=.FALSE./', reader, error)
    call reader%add_group('pair', '')
    call reader%get('pair', 'module_mm', module, error, 'a meaning', unit='mm', is_stated=given, above=0.0_dp)
    call reader%get('pair', 'angle', angle, error, 'a meaning', at_least=-0.5_dp, below=1.0_dp)
    call reader%get('pair', 'teeth', teeth, error, 'a meaning', required=.true., at_least=25, at_most=25)
    call reader%get('pair', 'flag', flag, error, 'a meaning')
    call reader%get('pair', 'other', other, error, 'a meaning')
    call reader%finish(error)
    call check_no_error(t, 'single values', error)
    call check_close(t, 'a scaled number', module, 0.003_dp)
    call check_close(t, 'a number', angle, -0.5_dp)
    call check_equal(t, 'an integer', teeth, 25)
    call check_true(t, 'logicals', flag .and. .not. other)
    call check_true(t, 'given', given)
    call check_true(t, 'has', reader%has('PAIR', 'teeth') .and. .not. reader%has('pair', 'bore'))
    call check_true(t, 'has group', reader%has_group('Pair') .and. .not. reader%has_group('gear'))
  end subroutine test_numbers

  subroutine test_lists(t)
    type(tally_t), intent(inout) :: t
    type(reader_t) :: reader
    type(error_t), allocatable :: error
    real(dp), allocatable :: amounts(:), one(:), none(:)

    call open_reader('&relief amount_um = 0, 5 2*10  one = 7 /', reader, error)
    call reader%add_group('relief', '')
    call reader%get('relief', 'amount_um', amounts, error, 'a meaning', unit='um', at_least=0.0_dp, max_size=4)
    call reader%get('relief', 'one', one, error, 'a meaning', min_size=1)
    call reader%get('relief', 'none', none, error, 'a meaning', min_size=1)
    call reader%finish(error)
    call check_no_error(t, 'lists', error)
    if (allocated(error)) return
    call check_equal(t, 'length of a list', size(amounts), 4)
    call check_close(t, 'sum of a list', sum(amounts), 25e-6_dp)
    call check_close(t, 'a list of one', one(1), 7.0_dp)
    call check_true(t, 'an absent list', .not. allocated(none))
  end subroutine test_lists

  !> Reliefs and speeds name the rows of tables: none may be there twice, in whatever order they come.
  subroutine test_twice(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: mesh = '&pinion teeth = 25 effective_mass_kg = 0.8 / &gear effective_mass_kg = 0.9 / '// &
      '&load normal_force_n = 6858 / &mesh model=''polynomial'' contact_ratio=1.6 coefficients=400,0,-120 / '

    call one('&case tasks = ''sweep'' / &sweep rpm_first = 3000 rpm_last = 6000 rpm_step = 1000 / &relief amount_um = 0, 1, 1 /', &
             '&relief amount_um = 0, 1, 1: 1 is given twice')
    call one('&case tasks = ''poincare'' / &relief amount_um = 0 / &poincare rpm = 3000, 4000, 3e3 /', &
             '&poincare rpm = 3000, 4000, 3e3: 3000 is given twice')
    call one('&case tasks = ''load'' / &sweep load_rpm = 2*5000 /', '5000 is given twice')
    call one('&case tasks = ''poincare'' / &relief amount_um = 2, 1, 0 / &poincare rpm = 3000 relief_um = 1, 2, 1 /', &
             '1 is given twice')
    call one('&case tasks = ''poincare'' / &relief amount_um = 2, 1, 0 / &poincare rpm = 4000, 3000 relief_um = 2, 1 /', '')

  contains

    subroutine one(text, message)
      character(*), intent(in) :: text, message
      type(case_t) :: case
      type(error_t), allocatable :: error

      call read_case(text//mesh, case, error)
      if (len(message) > 0) call check_error(t, text, error, contains=message)
      if (len(message) == 0) call check_no_error(t, text, error)
    end subroutine one
  end subroutine test_twice

  subroutine test_texts(t)
    type(tally_t), intent(inout) :: t
    type(reader_t) :: reader
    type(error_t), allocatable :: error
    character(:), allocatable :: title, model, tasks(:), names(:)
    character(*), parameter :: models(*) = [character(5) :: 'fe', 'weber']

    call open_reader('&case title = "A & B"  model = Weber  tasks="FE", ''weber''  names = "ab", "c" /', reader, error)
    call reader%add_group('case', '')
    call reader%get('case', 'title', title, error, 'a meaning')
    call reader%get('case', 'model', model, error, 'a meaning', allowed=models)
    call reader%get('case', 'tasks', tasks, error, 'a meaning', allowed=models, max_size=2)
    call reader%get('case', 'names', names, error, 'a meaning')
    call reader%finish(error)
    call check_no_error(t, 'texts', error)
    if (allocated(error)) return
    call check_equal(t, 'free text', title, 'A & B')
    call check_equal(t, 'a word', model, 'weber')
    call check_equal(t, 'words', join(tasks, '+'), 'fe+weber')
    call open_reader('&case model = ''ste'' /', reader, error)
    call reader%add_group('case', '')
    call reader%get('case', 'model', model, error, 'a meaning', allowed=[character(7) :: 'section', 'mesh'])
    call check_error(t, 'a short word of the field', error, contains='(did you mean mesh?)')
    call check_equal(t, 'free texts', join(names, '+'), 'ab+c')
  end subroutine test_texts

  subroutine test_defaults(t)
    type(tally_t), intent(inout) :: t
    type(reader_t) :: reader
    type(error_t), allocatable :: error
    character(:), allocatable :: text
    real(dp) :: x
    integer :: i
    logical :: given

    x = 2.5_dp
    i = 3
    text = 'up'
    call open_reader('&p x = /', reader, error)
    call reader%add_group('p', '')
    call reader%get('p', 'x', x, error, 'a meaning', unit='N/um', is_stated=given)
    call reader%get('p', 'i', i, error, 'a meaning')
    call reader%get('p', 'text', text, error, 'a meaning', allowed=['up'])
    call reader%get('p', 'y', x, error, 'a meaning', required=.true., not_allowed='has no effect')
    call reader%finish(error)
    call check_no_error(t, 'nothing given', error)
    call check_true(t, 'not given', .not. given)
    call check_close(t, 'a default number', x, 2.5_dp)
    call check_equal(t, 'a default integer', i, 3)
    call check_equal(t, 'a default text', text, 'up')
  end subroutine test_defaults

  subroutine test_wrong_values(t)
    type(tally_t), intent(inout) :: t

    call check_refused(t, 'x = -3', '&p x = -3: must be above 0 and at most 1000000')
    call check_refused(t, 'x = 0', '&p x = 0: must be above 0 and at most 1000000')
    call check_refused(t, 'x = 1000001', '&p x = 1000001: must be above 0 and at most 1000000')
    call check_refused(t, 'x = 1, 2', '&p x = 1, 2: must be a single number')
    call check_refused(t, 'x = abc', '&p x = abc: must be a number')
    call check_refused(t, 'x = ''3''', '&p x = ''3'': must be a number')
    call check_refused(t, 'x = ''''', '&p x = '''': must be a number')
    call check_refused(t, 'x = nan', '&p x = nan: must be a number')
    call check_refused(t, 'x = 1e999', '&p x = 1e999: must be a number')
    call check_refused(t, 'x = (1,2)', '&p x = (1, 2): must be a single number')
    call check_refused(t, '', '&p x: missing; must be above 0')
    call check_refused(t, 'x=1 big = 1e307', '&p big = 1e307: is too large')
    call check_refused(t, 'x=1 i = 2.5', '&p i = 2.5: must be an integer')
    call check_refused(t, 'x=1 i = 5.5e3 0', 'must be a single integer')
    call check_refused(t, 'x=1 i = 1e10', '&p i = 1e10: must be an integer')
    call check_refused(t, 'x=1 i = ''abc''', '&p i = ''abc'': must be an integer')
    call check_refused(t, 'x=1 i = 4', '&p i = 4: must be at least 5')
    call check_refused(t, 'x=1 i = 5 6', '&p i = 5, 6: must be a single integer')
    call check_refused(t, 'x=1 list = 1 2 3 4', '&p list = 1, 2, 3, 4: must be at most 3 numbers')
    call check_refused(t, 'x=1 list = 1', '&p list = 1: must be at least 2 numbers')
    call check_refused(t, 'x=1 list = 1, 2, 9', '&p list = 1, 2, 9: must be below 9')
    call check_refused(t, 'x=1 flag = yes', '&p flag = yes: must be .true. or .false.')
    call check_refused(t, 'x=1 flag = ''T''', '&p flag = ''T'': must be .true. or .false.')
    call check_refused(t, 'x=1 word = ''left''', '&p word = ''left'': must be one of ''up'', ''down''')
    call check_refused(t, 'x=1 word = ''up'' ''up''', '&p word = ''up'', ''up'': must be a single text')
    call check_refused(t, 'x=1 free = table', '&p free = table: must be a text in quotes')
    call check_refused(t, 'x=1 never = 1', '&p never = 1: has no effect')
    call check_refused(t, 'never = 1', '&p never = 1: has no effect')
    call check_refused(t, 'x = '''//repeat('z', 100)//'''', &
      & '&p x = '''//repeat('z', 56)//'...: must be a number')
  end subroutine test_wrong_values

  subroutine test_unknown(t)
    type(tally_t), intent(inout) :: t

    call check_refused(t, 'x=1 lsit = 1', '&p lsit = 1: unknown key (did you mean list?); ' &
      & //'the keys of &p are x, big, i, list, flag, word, free, never')
    call check_refused(t, 'x=1 colour = 1', '&p colour = 1: unknown key; the keys of &p are x, big')
    call check_refused(t, 'x=1 only_q = 1', '&p only_q = 1: unknown key; it belongs to &q; the keys of &p are x')
    call check_refused(t, 'x=1 / &r', '&r: unknown group; the groups are p, q')
    call check_refused(t, 'x=1 / &qq', '&qq: unknown group (did you mean &q?); the groups are p, q')
  end subroutine test_unknown

  !> Random text, plain and out of the words of the format: an error, or groups with full entries.
  subroutine test_random_text(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: words(*) = [character(8) :: '&p', '&q', '&end', '/', 'key', 'x', '=', '=', ',', &
      & '''', '"', '3*', '99999*', '1e999', '-.5', '!', 'a(1)', 'b%c', lf, cr, tab, '&', '*', 'nan', &
      & char(0), char(255), '=''s''', '= 1']
    character(:), allocatable :: text
    integer(int64) :: seed
    integer :: i, j, broken

    seed = 20240229
    broken = 0
    do i = 1, 4000
      text = ''
      if (mod(i, 2) == 0) text = '&p '
      do j = 1, random(60)
        if (mod(i, 4) == 0) then
          text = text//char(random(256) - 1)
        else
          text = text//trim(words(random(size(words) - merge(2, 0, random(9) > 1))))//repeat(' ', random(2) - 1)
        end if
      end do
      if (.not. is_sound(text//' /')) broken = broken + 1
    end do
    call check_equal(t, 'random texts neither refused nor read', broken, 0)

  contains

    !> 1 to n, from a small generator with a fixed seed.
    integer function random(n)
      integer, intent(in) :: n

      seed = mod(seed*48271_int64, 2147483647_int64)
      random = 1 + int(mod(seed/8, int(n, int64)))
    end function random
  end subroutine test_random_text

  !> Parsing and reading give an error with a one-line message, or what the type promises.
  logical function is_sound(text)
    character(*), intent(in) :: text
    type(namelist_t) :: namelist
    type(error_t), allocatable :: error
    integer :: i

    call parse_namelist(text, namelist, error)
    if (allocated(error)) then
      is_sound = error%code == code_input .and. error%message == visible(error%message)
    else
      is_sound = size(namelist%groups) > 0
      do i = 1, size(namelist%entries)
        is_sound = is_sound .and. size(namelist%entries(i)%values) > 0 .and. len(namelist%entries(i)%key) > 0
      end do
    end if
    call read_all(text, error)
    is_sound = is_sound .and. allocated(error)
    if (is_sound) is_sound = error%message == visible(error%message)
  end function is_sound

  !> Compares all that was parsed: `group:key=value|value;`, with strings in "".
  subroutine check_parsed(t, name, text, expected)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: name, text, expected
    type(namelist_t) :: namelist
    type(error_t), allocatable :: error
    character(:), allocatable :: found, mark
    integer :: i, j

    call parse_namelist(text, namelist, error)
    call check_no_error(t, name, error)
    if (allocated(error)) return
    found = ''
    do i = 1, size(namelist%entries)
      associate (entry => namelist%entries(i))
        found = found//entry%group//':'//entry%key//'='
        do j = 1, size(entry%values)
          mark = trim(merge('"', ' ', entry%values(j)%quoted))
          found = found//mark//entry%values(j)%text//mark//'|'
        end do
      end associate
      found(len(found):) = ';'
    end do
    call check_equal(t, name, found, expected)
  end subroutine check_parsed

  subroutine check_broken(t, name, text, message)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: name, text, message
    type(namelist_t) :: namelist
    type(error_t), allocatable :: error

    call parse_namelist(text, namelist, error)
    call check_error(t, name, error, message)
    if (allocated(error)) call check_equal(t, name, error%code, code_input)
  end subroutine check_broken

  subroutine check_refused(t, keys, message)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: keys, message
    type(error_t), allocatable :: error

    call read_all('&p '//keys//' /', error)
    call check_error(t, keys, error, message)
  end subroutine check_refused

  !> A small format with a key of every kind.
  subroutine read_all(text, error)
    character(*), intent(in) :: text
    type(error_t), allocatable, intent(inout) :: error
    type(reader_t) :: reader
    real(dp) :: x
    real(dp), allocatable :: list(:)
    character(:), allocatable :: word, free
    integer :: i
    logical :: flag

    x = 1
    i = 5
    flag = .false.
    call open_reader(text, reader, error)
    call reader%add_group('p', '')
    call reader%add_group('q', '')
    call reader%get('p', 'x', x, error, 'a meaning', required=.true., above=0.0_dp, at_most=1e6_dp)
    call reader%get('p', 'big', x, error, 'a meaning', unit='GPa')
    call reader%get('p', 'i', i, error, 'a meaning', at_least=5)
    call reader%get('p', 'list', list, error, 'a meaning', below=9.0_dp, min_size=2, max_size=3)
    call reader%get('p', 'flag', flag, error, 'a meaning')
    call reader%get('p', 'word', word, error, 'a meaning', allowed=[character(4) :: 'up', 'down'])
    call reader%get('p', 'free', free, error, 'a meaning')
    call reader%get('p', 'never', i, error, 'a meaning', not_allowed='has no effect')
    call reader%get('q', 'only_q', free, error, 'a meaning')
    call reader%finish(error)
  end subroutine read_all
end module test_reader
