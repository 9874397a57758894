!> What a case can say follows from the declarations of its keys: the help, cases to begin with, and the tables of
!> doc/case.md.
module test_declarations
  use gearsweep_study_case_case, only: case_t
  use gearsweep_api_case_reader, only: list_keys, read_case
  use gearsweep_api_describe, only: describe
  use gearsweep_api_help, only: help_on
  use gearsweep_base_error, only: code_input, error_t, fail
  use gearsweep_study_run_files, only: read_text
  use gearsweep_study_case_key_names, only: gear_key_names, key_names, name_key
  use gearsweep_study_reader_keys, only: keys_t
  use gearsweep_base_kinds, only: dp
  use gearsweep_api_new_case, only: write_new_case
  use gearsweep_base_table, only: axis, kind_integer, table_t
  use gearsweep_study_case_task, only: task_length
  use gearsweep_api_tasks, only: list_task_names
  use gearsweep_base_text, only: to_number
  use gearsweep_study_reader_unit_slips, only: find_slip
  use gearsweep_base_units, only: in_si, is_unit
  use test_support_key_tables, only: write_key_table
  use test_support_testing, only: check_close, check_equal, check_error, check_no_error, check_true, tally_t
  implicit none
  private
  public :: run, write_page

  character, parameter :: lf = new_line('a')
  character(*), parameter :: page = 'doc/case.md', begins = '<!-- keys of ', ends = '<!-- end of keys -->'

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('every_key')) call every_key(t)
    if (t%wants('help')) call help(t)
    if (t%wants('descriptions')) call descriptions(t)
    if (t%wants('quantities')) call quantities(t)
    if (t%wants('new_cases')) call new_cases(t)
    if (t%wants('slips')) call slips(t)
    if (t%wants('helical')) call helical(t)
    if (t%wants('cautions')) call cautions(t)
    if (t%wants('reference')) call reference(t)
    if (t%wants('axes')) call axes(t)
    if (t%wants('units')) call units(t)
  end subroutine run

  subroutine every_key(t)
    type(tally_t), intent(inout) :: t
    type(keys_t) :: keys
    character(:), allocatable :: name, allowed
    integer :: i

    call list_keys([character(task_length) ::], keys)
    call check_true(t, 'there are keys', keys%known > 80)
    do i = 1, keys%known
      associate (key => keys%key(i))
        name = '&'//trim(key%group)//' '//trim(key%name)
        call check_true(t, name//': a meaning', len(key%meaning) > 8)
        call check_true(t, name//': a unit of the list', is_unit(key%unit))
        call check_true(t, name//': a group of the list', any(keys%groups%name == key%group))
        call key%list_allowed(allowed)
        call check_true(t, name//': what is allowed', len(allowed) > 3)
        call check_true(t, name//': a default, or what holds without', allocated(key%default) .or. len(key%default_note) > 0 .or. &
                        key%is_required .or. key%is_one_of)
      end associate
    end do
  end subroutine every_key

  !> Index columns: all combinations of the axes' values, the first axis slowest and the last fastest.
  subroutine axes(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: relief(2) = [0.0_dp, 12.5e-6_dp]
    real(dp), parameter :: relief_um(2) = [0.0_dp, 12.5_dp]
    character(5), parameter :: side(3) = [character(5) :: 'drive', 'coast', 'tip']
    integer, parameter :: mode(2) = [4, 7]
    type(table_t) :: table
    type(error_t), allocatable :: error
    integer :: i, j, k, row

    table%name = 'combinations'
    call table%over('all combinations', error, axis('relief_um', 'um', 'relief', relief), axis('side', '', 'side', side), &
                    axis('mode', '', 'mode', mode))
    call check_no_error(t, 'axes', error)
    call table%add('doubled', '', 'twice the mode', table%along(3, 2.0_dp*mode))
    call check_equal(t, 'axes: rows', table%rows, 12)
    call check_true(t, 'axes: extent', all(table%extent == [2, 3, 2]))
    call check_true(t, 'axes: index columns and others', all(table%columns%is_index .eqv. [.true., .true., .true., .false.]))
    call check_equal(t, 'axes: kind', table%columns(3)%kind, kind_integer)
    row = 0
    do i = 1, 2
      do j = 1, 3
        do k = 1, 2
          row = row + 1
          call check_true(t, 'axes: values', .not. abs(table%number('relief_um', row) - relief_um(i)) > 0 .and. &
                          table%word('side', row) == side(j) .and. nint(table%number('mode', row)) == mode(k) .and. &
                          nint(table%number('doubled', row)) == 2*mode(k))
        end do
      end do
    end do
  end subroutine axes

  !> A table divides by the unit of a column, as the reader multiplies by that of a key: the numbers of a key return as they were
  !> written. The sizes of the units are those of the SI. A unit that is not in the list is an error of the table.
  subroutine units(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: names(*) = [character(9) :: '', 'mm', 'um', 'mm2', 'ms', 'h', '1/min', 'mm/s', 'MPa', 'GPa', &
                                           'mPa s', 'N/um', 'um/N', 'N/mm', 'N/(mm um)', 'kg/mm', 'deg']
    real(dp), parameter :: sizes(size(names)) = [1.0_dp, 1e-3_dp, 1e-6_dp, 1e-6_dp, 1e-3_dp, 3600.0_dp, 1.0_dp, 1e-3_dp, 1e6_dp, &
                                                 1e9_dp, 1e-3_dp, 1e6_dp, 1e-6_dp, 1e3_dp, 1e9_dp, 1e3_dp, &
                                                 acos(-1.0_dp)/180]
    real(dp), parameter :: written(*) = [0.0_dp, 0.1_dp, -12.5_dp, 20.0_dp, 0.003_dp, 1234.567_dp]
    real(dp), parameter :: root_of_two = 1.4142135623730951_dp
    type(table_t) :: table
    type(error_t), allocatable :: error
    integer :: i

    table%name = 'units'
    call table%begin('numbers in several units', size(written), error)
    do i = 1, size(names)
      call check_close(t, 'size of the unit '//names(i), in_si(trim(names(i))), sizes(i), 1e-15_dp)
      call table%add('of_key', trim(names(i)), 'numbers of a key', written*in_si(trim(names(i))))
      call check_true(t, 'numbers of a key in '//names(i), all(abs(table%numbers('of_key') - written) <= 0))
      call table%add('computed', trim(names(i)), 'a computed number', root_of_two*spread(sizes(i), 1, size(written)))
      call check_close(t, 'a computed number in '//names(i), table%number('computed'), root_of_two, 4e-16_dp)
    end do
    call check_true(t, 'units of the list', .not. allocated(table%error))
    call table%add('length_in', 'inch', 'a length', written)
    call check_true(t, 'a unit that is not in the list', allocated(table%error))
  end subroutine units

  !> Helical gears: the tasks geometry, face_load, sweep, rating and life and no other, with one sentence each for what is not
  !> allowed.
  subroutine helical(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: only = ' is for spur gears; for helical gears &case tasks can have geometry, '// &
      'face_load, sweep, rating, life only'
    character(*), parameter :: speeds = ' / &sweep rpm_first = 1000 rpm_last = 2000 rpm_step = 500'
    character(task_length), allocatable :: tasks(:)
    character(:), allocatable :: words
    integer :: i

    call list_task_names(tasks)
    do i = 1, size(tasks)
      if (any(tasks(i) == [character(task_length) :: 'geometry', 'face_load', 'sweep', 'rating', 'life'])) then
        words = ''
        if (tasks(i) == 'rating') words = ' / &rating rpm = 500'
        if (tasks(i) == 'life') words = ' / &rating material = ''C45'' / &life rpm = 500 duration_h = 1'
        if (tasks(i) == 'sweep') words = speeds
        call state('helix_angle_deg = 15'//load(tasks(i) /= 'geometry')//words, trim(tasks(i)), '')
      else
        call state('helix_angle_deg = 15', trim(tasks(i)), '&pair helix_angle_deg = 15: the task '//trim(tasks(i))//only)
      end if
    end do
    call state('helix_angle_deg = 15 pinion_hand = ''left''', 'geometry', '')
    call find_slip('helix_angle_deg', 'deg', [0.35_dp], words)
    call check_equal(t, 'radians', words, '0.35 is unusual: 1 deg or more is usual; if 0.35 rad is meant, write 20.0535')
    call state('helix_angle_deg = 90', 'geometry', '&pair helix_angle_deg = 90: must be at least 0 and at most 35')
    call state('helix_angle_deg = -15', 'geometry', '&pair helix_angle_deg = -15: must be at least 0 and at most 35')
    call state('helix_angle_deg = 15 coast_angle_deg = 25', 'geometry', &
               '&pair coast_angle_deg = 25: helical gears have equal pressure angles; remove it')
    call state('helix_angle_deg = 15 pinion_hand = ''up''', 'geometry', &
               '&pair pinion_hand = ''up'': must be one of ''right'', ''left''')
    call state('helix_angle_deg = 32'//load(.true.), 'face_load', &
               '&pair helix_angle_deg = 32: must be at most 30 for the load over the face width')
    call state('helix_angle_deg = 15'//load(.true.)//' / &section teeth = 21', 'face_load', &
               '&section teeth = 21: must be 0, for whole gears, or fewer than helical gears have')
    call state('helix_angle_deg = 15'//load(.true.)//' / &mesh model = ''iso6336''', 'face_load', &
               '&mesh model = ''iso6336'': must be ''fe'' for the load over the face width')
    call state('helix_angle_deg = 15'//load(.true.)//' / &mesh model = ''weber'' / &rating rpm = 500', 'rating', &
               '&mesh model = ''weber'': must be ''fe'' for the load over the face width')
    call state('helix_angle_deg = 32'//load(.true.)//speeds, 'sweep', &
               '&pair helix_angle_deg = 32: must be at most 30 for the load over the face width')
    call state('helix_angle_deg = 32'//load(.true.)//' / &rating rpm = 500', 'rating', &
               '&pair helix_angle_deg = 32: must be at most 30 for the load over the face width')
    call state('helix_angle_deg = 15'//load(.true.)//speeds//' / &dynamics friction = 0.05', 'sweep', &
               '&dynamics friction = 0.05: must be 0 for helical gears; remove it')
    call state('helix_angle_deg = 0 pinion_hand = ''left''', 'geometry', &
               '&pair pinion_hand = ''left'': is for helical gears, helix_angle_deg; remove it')
    call state('pinion_hand = ''right''', 'geometry', &
               '&pair pinion_hand = ''right'': is for helical gears, helix_angle_deg; remove it')

  contains

    !> The load that a task needs, after the keys of &pair.
    pure function load(is_needed)
      logical, intent(in) :: is_needed
      character(:), allocatable :: load

      load = ''
      if (is_needed) load = ' / &load line_load_n_mm = 200'
    end function load

    subroutine state(pair, task, message)
      character(*), intent(in) :: pair           !< keys of this group, and further groups
      character(*), intent(in) :: task
      character(*), intent(in) :: message        !< empty: accepted
      type(case_t) :: case
      type(error_t), allocatable :: error

      call read_case('&case tasks = '''//task//''' / &pair module_mm = 3 face_width_mm = 20 '//pair// &
                     ' / &pinion teeth = 21 / &gear teeth = 34 / ', case, error)
      if (len(message) > 0) call check_error(t, task//' '//pair, error, message)
      if (len(message) == 0) call check_no_error(t, task//' '//pair, error)
    end subroutine state
  end subroutine helical

  !> Words that users of other gear software search for have an entry, and each key that an entry names exists.
  subroutine glossary(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: words(*) = [character(12) :: 'noise', 'rms', 'quality', 'helix', 'scuffing', 'misalignment', &
      'crowning', 'wear', 'bearing', 'bevel']
    type(error_t), allocatable :: error
    character(:), allocatable :: text, key, description
    integer :: i, at, length

    do i = 1, size(words)
      call help_on(trim(words(i)), text, error)
      call check_no_error(t, 'help on '//trim(words(i)), error)
      if (allocated(error)) return
      at = index(text, '&')
      do while (at > 0)
        text = text(at + 1:)
        length = scan(text, ' '//lf)
        length = length + verify(text(length + 1:), 'abcdefghijklmnopqrstuvwxyz_') - 1
        key = text(:length)
        call help_on(key, description, error)
        call check_no_error(t, 'help on '//trim(words(i))//' names a key: '//text(:length), error)
        if (allocated(error)) return
        at = index(text, '&')
      end do
    end do
  end subroutine glossary

  !> Every name gets help; a misspelt one is told the closest.
  subroutine help(t)
    type(tally_t), intent(inout) :: t
    type(keys_t) :: keys
    type(error_t), allocatable :: error
    character(:), allocatable :: text
    integer :: i

    call list_keys([character(task_length) ::], keys)
    do i = 1, keys%known
      associate (key => keys%key(i))
        call help_on(trim(key%group)//' '//trim(key%name), text, error)
        call check_no_error(t, 'help on a key', error)
        if (.not. allocated(error)) call check_true(t, 'help on &'//trim(key%group)//' '//trim(key%name), &
          index(text, '&'//trim(key%group)//' '//trim(key%name)//lf) == 1)
        call check_true(t, 'its tasks are one list: '//trim(key%group)//' '//trim(key%name), &
                        index(key%tasks, ' or ') == index(key%tasks, ' or ', back=.true.))
      end associate
    end do
    do i = 1, size(keys%groups)
      call help_on('&'//trim(keys%groups(i)%name), text, error)
      call check_no_error(t, 'help on a group', error)
      call check_true(t, 'help on &'//trim(keys%groups(i)%name), index(text, 'group &'//trim(keys%groups(i)%name)//lf) > 0)
    end do
    call help_on('optimum', text, error)
    call check_true(t, 'help on a task', index(text, 'task optimum'//lf) == 1)
    call help_on('damping_ratio', text, error)
    call check_true(t, 'the default', index(text, 'default   0.1'//lf) > 0)
    call check_true(t, 'the bounds', index(text, 'allowed   0 to 1000'//lf) > 0)
    call help_on('profile shift', text, error)
    call check_no_error(t, 'help by the words of a meaning', error)
    call check_true(t, 'help by words finds the key', index(text, '&pinion, &gear profile_shift'//lf) > 0)
    call help_on('tip relief', text, error)
    call check_no_error(t, 'help by words of a group', error)
    call check_true(t, 'help by words of a group begins with the keys of the group', &
                    index(text, '&relief amount_um'//lf) == 1 .and. &
                    index(text, '&relief start'//lf) < index(text, 'task deflection_relief'//lf))
    call check_true(t, 'help lists a key of several groups once', &
                    index(text, 'relief_um'//lf, back=.true.) == index(text, ' relief_um'//lf) + 1)
    call glossary(t)
    call help_on('K_A', text, error)
    call check_true(t, 'help by a symbol finds the key that means it', index(text, '&load application_factor'//lf) > 0)
    call help_on('S_H', text, error)
    call check_true(t, 'help by the symbol of a result', index(text, '&rating contact_limit_mpa'//lf) > 0)
    call help_on('K_Hbeta', text, error)
    call check_no_error(t, 'help by a symbol without all of its underscores', error)
    call check_true(t, 'it finds the key', index(text, '&rating face_load_factor'//lf) > 0)
    call help_on('rim_m', text, error)
    call check_error(t, 'a misspelt key', error, 'rim_m: no such task, group or key (did you mean rim_mm?)')
    deallocate (error)
    call help_on('section rim_m', text, error)
    call check_error(t, 'a misspelt key of a group', error, '&section rim_m: unknown key (did you mean rim_mm?)')
    deallocate (error)
    call help_on('sectio rim_mm', text, error)
    call check_error(t, 'a misspelt group', error, '&sectio: unknown group (did you mean &section?)')
  end subroutine help

  subroutine descriptions(t)
    type(tally_t), intent(inout) :: t
    type(error_t), allocatable :: error
    character(:), allocatable :: text

    call describe('key dynamics damping_ratio', text, error)
    call check_no_error(t, 'a key in JSON', error)
    call check_equal(t, 'a key in JSON', text(:index(text, ', "tasks"') - 1), &
                     '{"group": "dynamics", "name": "damping_ratio", "unit": "", "kind": "number", "list": false, '// &
                     '"required": false, "one_of": false, "default": "0.1", "otherwise": "", "allowed": "0 to 1000", '// &
                     '"low": 0, "low_is_allowed": true, "high": 1000, "high_is_allowed": true, "words": []')
    call describe('key mesh model', text, error)
    call check_no_error(t, 'a key with words in JSON', error)
    call check_true(t, 'its words have their digits', index(text, '"words": ["fe", "weber", "iso6336", "polynomial", "table"]') > 0)
    call describe('taks', text, error)
    call check_error(t, 'what cannot be described', error, 'taks: cannot be described (did you mean tasks?)')
  end subroutine descriptions

  !> The quantities of messages from below have keys that there are, and get them.
  subroutine quantities(t)
    type(tally_t), intent(inout) :: t
    type(keys_t) :: keys
    type(error_t), allocatable :: error
    integer :: i

    call list_keys([character(task_length) ::], keys)
    do i = 1, size(key_names)
      call check_quantity(t, keys, trim(key_names(i)%quantity), trim(key_names(i)%key))
    end do
    do i = 1, size(gear_key_names)
      call check_quantity(t, keys, 'pinion '//trim(gear_key_names(i)%quantity), '&pinion '//trim(gear_key_names(i)%key))
      call check_quantity(t, keys, 'gear '//trim(gear_key_names(i)%quantity), '&gear '//trim(gear_key_names(i)%key))
    end do
    call fail(error, code_input, 'pinion profile shift = 0: undercut; shortened path = .true. mends it; the rim (mm) = 3 stays')
    call name_key(error)
    call check_equal(t, 'behind a semicolon', error%message, &
                     '&pinion profile_shift = 0: undercut; &pair shorten_path = .true. mends it; the rim (mm) = 3 stays')
  end subroutine quantities

  subroutine check_quantity(t, keys, quantity, key)
    type(tally_t), intent(inout) :: t
    type(keys_t), intent(in) :: keys             !< all that there are
    character(*), intent(in) :: quantity         !< with which a message begins
    character(*), intent(in) :: key              !< that it is to get, or a group
    type(error_t), allocatable :: error
    logical :: is_there
    integer :: at, k

    at = index(key//' ', ' ')
    is_there = .false.
    do k = 1, keys%known
      if (keys%key(k)%group /= key(2:at - 1)) cycle
      is_there = is_there .or. at > len(key) .or. keys%key(k)%name == key(min(at + 1, len(key)):)
    end do
    call check_true(t, 'one of the keys or groups: '//key, is_there)
    call fail(error, code_input, quantity//' = 3: is too much')
    call name_key(error)
    call check_equal(t, quantity, error%message, key//' = 3: is too much')
    deallocate (error)
    call fail(error, code_input, quantity//'s are many')
    call name_key(error)
    call check_equal(t, 'other words than '//quantity, error%message, quantity//'s are many')
  end subroutine check_quantity

  !> For every task and for all together: read without a word of unused keys once the required ones are filled.
  subroutine new_cases(t)
    type(tally_t), intent(inout) :: t
    character(task_length), allocatable :: names(:)
    character(:), allocatable :: text
    type(case_t) :: short
    type(error_t), allocatable :: error
    integer :: i

    call list_task_names(names)
    do i = 1, size(names)
      call check_new(names(i:i), trim(names(i)))
    end do
    call check_new(names, 'all')
    call write_new_case([character(task_length) :: '--short', 'sweep'], text, error)
    call check_no_error(t, 'a short case', error)
    call check_true(t, 'a short case has the required keys', index(text, '&sweep') > 0 .and. index(text, 'rpm_first') > 0)
    call check_true(t, 'and no key that has a default and is rare', index(text, 'steps_per_period') == 0)
    call read_case(filled(text), short, error)
    call check_no_error(t, 'a short case runs with its required keys', error)
    call write_new_case(['sweeep'], text, error)
    call check_error(t, 'a misspelt task', error, 'sweeep: no such task (did you mean sweep?)')
    deallocate (error)
    call write_new_case([character(8) ::], text, error)
    call check_error(t, 'no task', error, 'name at least one task; the tasks are geometry, ')

  contains

    subroutine check_new(tasks, name)
      character(*), intent(in) :: tasks(:), name
      type(case_t) :: case
      integer :: k

      call write_new_case(tasks, text, error)
      call check_no_error(t, 'a new case for '//name, error)
      call read_case(text, case, error)
      call check_true(t, 'required keys are missing: '//name, allocated(error))
      if (allocated(error)) then
        call check_true(t, 'as an error says: '//name, error%code == code_input .and. index(error%message, ': missing; ') > 0)
        deallocate (error)
      end if
      call read_case(filled(text), case, error)
      call check_no_error(t, 'a new case with the required keys: '//name, error)
      if (allocated(error)) return
      call check_equal(t, 'all of its keys are used: '//name, case%unused, '')
      do k = 1, size(tasks)
        call check_true(t, 'its tasks are those asked for: '//name, case%requests(trim(tasks(k))))
      end do
    end subroutine check_new
  end subroutine new_cases

  !> Numbers that are allowed but likely in another unit: a caution says what to write. What is none in every unit, and every
  !> default, is usual.
  subroutine cautions(t)
    type(tally_t), intent(inout) :: t
    type(keys_t) :: keys
    character(:), allocatable :: words
    integer :: i

    call list_keys([character(1) ::], keys)
    do i = 1, keys%known
      associate (key => keys%key(i))
        if (key%unit == 'um' .and. key%name /= 'start_um') then
          call find_slip(trim(key%name), key%unit, [0.0_dp, 0.009_dp], words)
          call check_true(t, 'millimetres: '//trim(key%group)//' '//trim(key%name), &
                          index(words, '; if 0.009 mm is meant, write 9') > 0)
        end if
        call find_slip(trim(key%name), key%unit, [0.0_dp, 0.0_dp], words)
        call check_equal(t, 'none: '//trim(key%name), words, '')
        if (allocated(key%default) .and. len(key%unit) > 0) call check_default(key%name, key%unit, key%default)
      end associate
    end do
    call caution('&material density_kgm3 = 7.85', '&material density_kgm3: 7.85 is unusual: 200 to 25000 kg/m^3 is usual; '// &
                 'if 7.85 g/cm^3 is meant, write 7850')
    call caution('&pinion density_kgm3 = 7.85', '&pinion density_kgm3: 7.85 is unusual')
    call caution('&pair backlash_um = 0.08', '1 um or more is usual; if 0.08 mm is meant, write 80')
    call caution('&pair backlash_um = 0', '')
    ! A damping ratio of 0.17 in per cent, which would hide all resonances.
    call caution('&dynamics damping_ratio = 17', '&dynamics damping_ratio: 17 is unusual: at most 1 is usual; '// &
                 'if 17 % is meant, write 0.17')
    call caution('&dynamics damping_ratio = 1', '')
    ! Reliefs of 0 and 60 um in millimetres, above the least relief that is allowed.
    call caution('&relief amount_um = 0, 0.06', '&relief amount_um: at most 0.06 is unusual: 0.5 um or more is usual; '// &
                 'if 0.06 mm is meant, write 60')
    call caution('&relief amount_um = 0, 0.06, 10', '')
    call caution('&pinion thickness_allowance_um = -0.06', '&pinion thickness_allowance_um: -0.06 is unusual: '// &
                 '1 um or more is usual; if -0.06 mm is meant, write -60')
    call caution('&pinion thickness_allowance_um = 0', '')
    call caution('&deviations pinion_runout_um = 0.02 pinion_runout_phase_deg = 0', '&deviations pinion_runout_um: 0.02 is unusual')
    call caution('&deviations pinion_single_pitch_um = 20*0.008, -0.16 pinion_counting = ''clockwise'' '// &
                 'pinion_flank = ''right'' pinion_tooth = 1', '')
    call caution('&rating rpm = 9000 pitch_deviation_um = 0.008 profile_deviation_um = 0.009 '// &
                 'dynamic_factor_method = ''b''', &
                 '&rating pitch_deviation_um: 0.008 is unusual: 0.1 um or more is usual; if 0.008 mm is meant, write 8')
    call caution('&rating rpm = 9000 contact_limit_mpa = 1.5', 'if 1.5 GPa is meant, write 1500')
    call caution('&flank rpm = 9000 viscosity_mpa_s = 0.03', 'if 0.03 Pa s is meant, write 30')
    call caution('&relief amount_um = 10 length_mm = 0.0015', '&relief length_mm: 0.0015 is unusual beside a module of 3 mm; '// &
                 'if 0.0015 m is meant, write 1.5')
    call caution('&pinion bore_mm = 0.02', '&pinion bore_mm: 0.02 is unusual beside a module of 3 mm; if 0.02 m is meant, write 20')
    call caution('&gear tip_chamfer_mm = 0.0003', '&gear tip_chamfer_mm: 0.0003 is unusual')
    call caution('&gear tip_chamfer_mm = 0.3', '')
    ! What does not count need not be looked at.
    call caution('&flank viscosity_mpa_s = 0.03', '', 'sweep')

  contains

    subroutine check_default(name, unit, default)
      character(*), intent(in) :: name, unit, default
      real(dp) :: value
      logical :: ok

      call to_number(trim(default), value, ok)
      if (.not. ok) return
      call find_slip(trim(name), unit, [value], words)
      call check_equal(t, 'a default is usual: '//trim(name), words, '')
    end subroutine check_default

    subroutine caution(more, words, tasks)
      character(*), intent(in) :: more, words    !< keys of a group; what the caution has, empty: there is none
      character(*), intent(in), optional :: tasks
      type(case_t) :: case
      type(error_t), allocatable :: error
      character(:), allocatable :: text, wanted
      integer :: group

      wanted = 'sweep'', ''as_built'', ''rating'', ''flank'
      if (present(tasks)) wanted = tasks
      if (index(more, '&deviations') == 0 .and. .not. present(tasks)) wanted = 'sweep'', ''rating'', ''flank'
      text = '&case tasks = '''//wanted//''' / &pair module_mm = 3 face_width_mm = 20 / &pinion teeth = 21 / '// &
             '&gear teeth = 34 / &load torque_nm = 100 / &mesh model = ''weber'' / '// &
             '&sweep rpm_first = 1000 rpm_last = 3000 rpm_step = 1000 / '
      if (index(more, '&rating') == 0) text = text//'&rating rpm = 3000 / '
      if (index(more, '&flank') == 0 .and. .not. present(tasks)) text = text//'&flank rpm = 3000 / '
      group = index(text, more(:index(more, ' ')))
      if (group > 0) then
        text = text(:group - 1)//more//text(group + index(more, ' ') - 1:)
      else
        text = text//more//' /'
      end if
      call read_case(text, case, error)
      call check_no_error(t, 'only a caution: '//more, error)
      if (allocated(error)) return
      if (len(words) == 0) call check_equal(t, 'no caution: '//more, case%cautions, '')
      call check_true(t, 'the caution: '//more//': '//case%cautions, index(case%cautions, words) > 0)
    end subroutine caution
  end subroutine cautions

  !> Numbers in another unit than their key's, decimal commas, and what is missing: each message says what was given and what
  !> was probably meant.
  subroutine slips(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: pair = 'module_mm = 3 face_width_mm = 20'

    call slip('module_mm = 0.003 face_width_mm = 20', '', &
              '&pair module_mm = 0.003: must be at least 0.05 and at most 1000; if 0.003 m is meant, write 3')
    call slip(pair//' pressure_angle_deg = 0.349', '', &
              'must be above 3 and below 45; if 0.349 rad is meant, write 19.9962')
    call slip(pair, '&material density_kgm3 = 7.85e-9 /', &
              'must be at least 1 and at most 100000; if 7.85e-9 t/mm^3 is meant, write 7850')
    call slip(pair, '&material young_gpa = 206000 /', 'if 206000 MPa is meant, write 206')
    call slip('helix_angle = 15', '', '&pair helix_angle = 15: unknown key (did you mean helix_angle_deg?)')
    call slip('diametral_pitch = 8', '', 'unknown key: module_mm = 25.4/(diametral pitch)')
    call slip('module_mm = 3,18 face_width_mm = 20', '', &
              '&pair module_mm = 3, 18: must be a single number; decimals take a point')
    call slip('module_mm = 3 face_width_mm = 0.02', '', &
              '&pair face_width_mm = 0.02: must be at least a tenth of the module; if 0.02 m is meant, write 20')
    call slip(pair, '&relief amount_um = 0, 0.01 /', &
              '&relief amount_um = 0.01: must be 0 or at least 0.05; if 0.01 mm is meant, write 10')
    call slip(pair, '&relief amount_um = 301 /', '&relief amount_um = 301: must be at most a tenth of the module, 300')
    call slip(pair, '&relief amount_um = 0,5 10,5 /', '&relief amount_um = 0, 5, 10, 5: has commas without a blank')
    call slip(pair, '&relief amount_um = 0,5, 10,5 /', '&relief amount_um = 0, 5, 10, 5: has pairs with a comma and no blank')
    call slip(pair, '&mesh model = ''webr'' /', '(did you mean weber?)')
    call slip('face_width_mm = 20', '', &
              '&pair module_mm: missing; must be at least 0.05 and at most 1000 (normal module)')
    call slip('', '', '&pair module_mm: missing; must be at least 0.05 and at most 1000 (normal module); '// &
              'missing too: &pair face_width_mm')
    call slip(pair, '&relief amount_um = 0,5,10 /', '')
    call slip(pair, '&relief amount_um = 0 5 10.5 /', '')
    call slip(pair, '&relief amount_um = 0, 5, 10, 15 /', '')
    call slip(pair, '&relief amount_um = 0,5,10, 15 /', '')
    call slip(pair, '&relief amount_um = 0,5,'//lf//'10,15 /', '')
    call slip(pair, '&relief amount_um = 0,5,'//lf//'10 /', '')
    call slip(pair, '&relief amount_um = 300 /', '')

  contains

    subroutine slip(given, more, message)
      character(*), intent(in) :: given, more    !< keys of &pair; other groups
      character(*), intent(in) :: message        !< empty: accepted
      type(case_t) :: case
      type(error_t), allocatable :: error

      call read_case('&case tasks = ''sweep'' / &pair '//given//' / &pinion teeth = 21 / &gear teeth = 34 / '// &
                     '&load torque_nm = 100 / &sweep rpm_first = 1000 rpm_last = 2000 rpm_step = 500 / '//more, case, error)
      if (len(message) > 0) call check_error(t, given//more, error, message)
      if (len(message) == 0) call check_no_error(t, given//more, error)
    end subroutine slip
  end subroutine slips

  !> With values for the keys that are marked as required, of the load for the first.
  function filled(text) result(case)
    character(*), intent(in) :: text
    character(:), allocatable :: case, line, key
    integer :: from, until
    logical :: loaded

    case = ''
    loaded = .false.
    from = 1
    do while (from <= len(text))
      until = from + index(text(from:), lf) - 2
      line = text(from:until)
      from = until + 2
      if (index(line, '! REQUIRED') > 0 .and. .not. (loaded .and. index(line, 'one of these') > 0)) then
        loaded = loaded .or. index(line, 'one of these') > 0
        key = trim(adjustl(line(:index(line, '=') - 1)))
        select case (key)
        case ('teeth')
          line = 'teeth = 25'
        case ('material')
          line = key//' = ''C45'''
        case ('pinion_class')
          line = key//' = 6'
        case ('rpm_first')
          line = key//' = 5000'
        case ('rpm_last', 'load_rpm')
          line = key//' = 6000'
        case ('rpm_step')
          line = key//' = 500'
        case ('module_mm')
          line = key//' = 3'
        case ('last')
          line = key//' = 40'
        case default
          line = key//' = 20'
        end select
      end if
      case = case//line//lf
    end do
  end function filled

  !> The page's tables of keys are those that follow from the declarations.
  subroutine reference(t)
    type(tally_t), intent(inout) :: t
    character(:), allocatable :: text, fresh
    type(error_t), allocatable :: error
    integer :: i

    call read_text(page, text, error)
    call check_no_error(t, 'the page', error)
    if (allocated(error)) return
    call refresh(text, fresh)
    call check_true(t, 'the page has tables of keys', count([(text(i:i + len(begins) - 1) == begins, &
                                                              i=1, len(text) - len(begins))]) > 15)
    call check_true(t, page//' is up to date; build/run/check-release reference prints it anew', text == fresh)
  end subroutine reference

  !> Prints the page with its tables made anew.
  subroutine write_page()
    character(:), allocatable :: text, fresh
    type(error_t), allocatable :: error

    call read_text(page, text, error)
    if (allocated(error)) error stop error%message
    call refresh(text, fresh)
    write (*, '(a)', advance='no') fresh
  end subroutine write_page

  !> Replaces what stands between the marks `<!-- keys of GROUP -->` and `<!-- end of keys -->`.
  subroutine refresh(text, fresh)
    character(*), intent(in) :: text
    character(:), allocatable, intent(out) :: fresh
    character(:), allocatable :: table
    integer :: from, at, behind

    fresh = ''
    from = 1
    do
      at = index(text(from:), begins)
      if (at == 0) exit
      at = from + at - 1 + len(begins)
      behind = at + index(text(at:), ' ') - 1
      call write_key_table(text(at:behind - 1), table)
      fresh = fresh//text(from:behind)//'-->'//lf//table
      from = at + index(text(at:), ends) - 1
    end do
    fresh = fresh//text(from:)
  end subroutine refresh
end module test_declarations
