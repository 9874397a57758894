!> What the calls of the flat layer have in common: they read the case, run the
!> one task they are for, and say what went wrong.
module gearsweep_border
  use gearsweep_kinds, only: dp
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_case, only: case_t
  use gearsweep_case_reader, only: read_case
  use gearsweep_error, only: error_t, fail, code_input, code_ok, code_partial, code_stopped
  use gearsweep_decimal, only: in_um
  use gearsweep_disc, only: disc_t
  use gearsweep_fe_stiffness, only: fe_knots
  use gearsweep_memory, only: settle_memory
  use gearsweep_piecewise, only: constant, piecewise_t
  use gearsweep_report, only: failed_points
  use gearsweep_study, only: record_t, study_t, run_study
  use gearsweep_text, only: str
  use gearsweep_traps, only: bring_traps_back, set_traps_aside
  implicit none
  private
  public :: open_case, run_case, in_folder, in_um, measure, pack_stiffness, need_room, need_between, need_order, &
            give_text, begin_call, tell, work_size

  !> Numbers before the breaks in `work`: key, pieces, terms of each piece.
  integer, parameter :: head = 5
  integer, parameter :: most_threads = 1024
  integer, parameter, public :: longest_text = 10**9

contains

  !> Reads the case and leaves `task` alone of what it asks for; 'all' leaves
  !> everything. 'geometry' and 'motion' need not be among the case's tasks.
  subroutine open_case(text, task, threads, case, error)
    character(*), intent(in) :: text, task
    integer, intent(in) :: threads
    type(case_t), intent(out) :: case
    type(error_t), allocatable, intent(out) :: error

    if (len(text, int64) > longest_text) then
      call fail(error, code_input, 'text: longer than '//str(longest_text)//' characters')
    else if (threads < 0 .or. threads > most_threads) then
      call fail(error, code_input, 'threads = '//str(threads)//': must lie between 0 (all) and '//str(most_threads))
    else
      call read_case(text, case, error)
    end if
    if (allocated(error) .or. task == 'all') return
    call choose(task, case, error)
    ! Only the report compares.
    if (allocated(case%published)) deallocate (case%published)
  end subroutine open_case

  !> Runs an opened case, unless it failed before. `work(nwork)` is what
  !> `pack_stiffness` left; none where `nwork` is 0. `folder` is where the case's
  !> files lie, with its slash; `watch` and `record` as in `run_study`.
  subroutine run_case(case, nwork, work, threads, study, error, folder, watch, record)
    type(case_t), intent(in) :: case
    integer, intent(in) :: nwork, threads
    real(dp), intent(in) :: work(*)
    type(study_t), intent(out) :: study
    type(error_t), allocatable, intent(inout) :: error
    character(*), intent(in), optional :: folder
    integer, intent(inout), target, optional :: watch(3)
    type(record_t), intent(inout), optional :: record
    type(piecewise_t), allocatable :: stiffness
    type(disc_t) :: disc
    character(:), allocatable :: place

    if (allocated(error)) return
    place = ''
    if (present(folder)) place = folder
    if (nwork /= 0) then
      allocate (stiffness)
      call unpack_stiffness(case, nwork, work, stiffness, disc, error)
    end if
    ! One that is not allocated counts as not passed.
    if (.not. allocated(error)) call run_study(case, place, threads, study, error, stiffness=stiffness, disc=disc, &
                                                watch=watch, record=record)
  end subroutine run_case

  !> A folder as the study takes it: empty for the current one, else with its slash.
  pure function in_folder(folder) result(place)
    character(*), intent(in) :: folder
    character(len_trim(folder) + merge(1, 0, index(folder, '/', back=.true.) /= len_trim(folder))) :: place

    place = folder
    if (len(place) > 0) place(len(place):) = '/'
  end function in_folder

  !> Runs the case up to the mesh and the section's grid, without finite
  !> elements: `study` then has every size, but no true stiffness for model 'fe'.
  subroutine measure(case, folder, study, error)
    type(case_t), intent(in) :: case
    character(*), intent(in) :: folder
    type(study_t), intent(out) :: study
    type(error_t), allocatable, intent(inout) :: error
    type(case_t) :: cheap

    if (allocated(error)) return
    cheap = case
    ! Of the tasks that need the mesh, load at no speed is the cheapest.
    call cheap%want(pack([character(7) :: 'section', 'mesh', 'load'], &
                         [case%needs_section(), case%asks('mesh'), case%needs_load()]))
    cheap%load_rpm = [real(dp) ::]
    cheap%harmonics = 1
    if (allocated(cheap%published)) deallocate (cheap%published)
    if (case%model == 'fe') then
      call run_study(cheap, folder, 1, study, error, stiffness=constant(0.0_dp, 20.0_dp, 1e8_dp))
    else
      call run_study(cheap, folder, 1, study, error)
    end if
  end subroutine measure

  !> Leaves one task of those that the case names.
  subroutine choose(task, case, error)
    character(*), intent(in) :: task
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error

    select case (task)
    case ('geometry')
      if (case%prescribed) call fail(error, code_input, &
        '&mesh contact_ratio: a prescribed mesh has no geometry')
    case ('motion')
      if (.not. case%needs_load()) call fail(error, code_input, &
        '&case tasks: none of them needs the mesh; name one of mesh, static, load, sweep, optimum')
    case default
      if (.not. case%asks(task)) call fail(error, code_input, '&case tasks: this call needs '//task//' among them')
    end select
    ! The motions of load are those of the case's sweep, where it names one.
    if (task == 'motion') then
      call case%want(['mesh'])
    else if (task == 'load' .and. case%asks('sweep')) then
      call case%want([character(5) :: 'load', 'sweep'])
    else
      call case%want([task])
    end if
  end subroutine choose

  !> Numbers that `pack_stiffness` needs for a measured study.
  pure integer function work_size(study)
    type(study_t), intent(in) :: study

    work_size = 0
    if (.not. allocated(study%mesh)) return
    if (study%case%model == 'fe') then
      work_size = head + fe_knots + 4*(fe_knots - 1)
    else
      work_size = size_of(study%mesh%stiffness)
    end if
  end function work_size

  pure integer function size_of(stiffness)
    type(piecewise_t), intent(in) :: stiffness

    size_of = head + size(stiffness%breaks) + size(stiffness%coef)
  end function size_of

  !> The pair stiffness as numbers that can be passed back in.
  subroutine pack_stiffness(study, nwork, work, error)
    type(study_t), intent(in) :: study
    integer, intent(in) :: nwork
    real(dp), intent(inout) :: work(*)
    type(error_t), allocatable, intent(inout) :: error
    integer :: n

    associate (stiffness => study%mesh%stiffness)
      call need_room('work', nwork, size_of(stiffness), error)
      if (allocated(error)) return
      n = size(stiffness%breaks)
      work(2:head) = [real(n - 1, dp), real(size(stiffness%coef, 1), dp), study%mesh%disc%turn, study%mesh%disc%shared]
      work(head + 1:head + n) = stiffness%breaks
      work(head + n + 1:size_of(stiffness)) = reshape(stiffness%coef, [size(stiffness%coef)])
      work(1) = key_of(study%case, work(2:size_of(stiffness)))
    end associate
  end subroutine pack_stiffness

  subroutine unpack_stiffness(case, nwork, work, stiffness, disc, error)
    type(case_t), intent(in) :: case
    integer, intent(in) :: nwork
    real(dp), intent(in) :: work(*)
    type(piecewise_t), intent(out) :: stiffness
    type(disc_t), intent(out) :: disc
    type(error_t), allocatable, intent(inout) :: error
    integer :: pieces, terms, n
    logical :: fits

    fits = nwork > head
    if (fits) fits = .not. any(ieee_is_nan(work(:head)))
    if (fits) fits = work(2) >= 1 .and. work(3) >= 1 .and. work(2) <= nwork .and. work(3) <= nwork
    if (fits) fits = head + 1 + work(2)*(1 + work(3)) <= nwork
    if (fits) then
      pieces = int(work(2))
      terms = int(work(3))
      n = head + pieces + 1
      ! One number that was spoilt could keep the motion from ever ending.
      fits = .not. abs(work(1) - key_of(case, work(2:n + pieces*terms))) > 0
    end if
    if (.not. fits) then
      call fail(error, code_input, 'work: is not of these gears, this material, section and load; prepare it again')
      return
    end if
    disc = disc_t(turn=work(4), shared=work(5))
    allocate (stiffness%breaks, source=work(head + 1:n))
    allocate (stiffness%coef(0:terms - 1, pieces))
    stiffness%coef = reshape(work(n + 1:n + pieces*terms), [terms, pieces])
  end subroutine unpack_stiffness

  !> A whole number below 2**31 that follows from all that the pair stiffness depends on, and from its
  !> own numbers.
  real(dp) function key_of(case, packed) result(key)
    type(case_t), intent(in) :: case
    real(dp), intent(in) :: packed(:)
    integer(int64), parameter :: modulus = 2147483647_int64, factor = 1000003_int64
    integer(int64) :: hash
    integer :: i

    hash = 7
    do i = 1, 2
      associate (spec => case%spec(i))
        call add([real(spec%teeth, dp), spec%module, spec%pressure_angle, spec%profile_shift, spec%addendum, &
                  spec%dedendum, spec%rack_tip_radius, spec%face_width, spec%bore_radius])
      end associate
    end do
    associate (section => case%section, material => case%material)
      call add([case%centre_distance, merge(1.0_dp, 0.0_dp, case%tip_alteration), material%young, material%poisson])
      call add([case%torque, case%normal_force, case%line_load, case%contact_ratio, case%base_pitch])
      call add([real(section%teeth, dp), section%half_angle, section%rim, real(section%elements_across, dp)])
      call add(merge(1.0_dp, 0.0_dp, [section%fixed_sides, section%fixed_rim, section%plane_strain]))
    end associate
    if (allocated(case%coefficients)) call add(case%coefficients)
    call add([(real(iachar(case%model(i:i)), dp), i=1, len(case%model))])
    if (allocated(case%file)) call add([(real(iachar(case%file(i:i)), dp), i=1, len(case%file))])
    call add(packed)
    key = real(hash, dp)

  contains

    subroutine add(values)
      real(dp), intent(in) :: values(:)
      integer(int64) :: bits
      integer :: k

      do k = 1, size(values)
        bits = transfer(values(k), bits)
        hash = modulo(hash*factor + modulo(bits, modulus), modulus)
      end do
    end subroutine add
  end function key_of

  !> Refuses an array that is too small.
  pure subroutine need_room(name, have, need, error)
    character(*), intent(in) :: name
    integer, intent(in) :: have, need
    type(error_t), allocatable, intent(inout) :: error

    if (allocated(error)) return
    if (have < need) call fail(error, code_input, name//' = '//str(have)//': too small, must be at least '//str(need))
  end subroutine need_room

  !> Refuses a value that is no number, below `least` or above `most`.
  subroutine need_between(name, values, least, most, error)
    character(*), intent(in) :: name
    real(dp), intent(in) :: values(:), least, most
    type(error_t), allocatable, intent(inout) :: error
    integer :: i

    if (allocated(error)) return
    do i = 1, size(values)
      if (.not. ieee_is_nan(values(i))) then
        if (values(i) >= least .and. values(i) <= most) cycle
      end if
      call fail(error, code_input, name//' = '//str(values(i))//': must be from '//str(least)//' to '//str(most))
      return
    end do
  end subroutine need_between

  !> Refuses values that do not climb or, with `sense` -1, fall.
  subroutine need_order(name, values, sense, error)
    character(*), intent(in) :: name
    real(dp), intent(in) :: values(:)
    integer, intent(in) :: sense
    type(error_t), allocatable, intent(inout) :: error
    integer :: i

    if (allocated(error)) return
    do i = 2, size(values)
      if (sense*(values(i) - values(i - 1)) > 0) cycle
      call fail(error, code_input, name//': '//str(values(i))//' after '//str(values(i - 1))//' is out of order')
      return
    end do
  end subroutine need_order

  !> Hands a text out, or tells the length that it needs.
  subroutine give_text(name, words, target, length, error)
    character(*), intent(in) :: name, words
    character(*), intent(inout) :: target
    integer, intent(inout) :: length
    type(error_t), allocatable, intent(inout) :: error

    length = len(words)
    call need_room('len('//name//')', len(target), length, error)
    if (.not. allocated(error)) target = words
  end subroutine give_text

  !> First of all in each call, which `tell` ends.
  subroutine begin_call()
    call set_traps_aside()
  end subroutine begin_call

  !> Code and message of a call; blank where all is well. Points without an
  !> answer are told too. Last of all in each call.
  subroutine tell(error, info, message, study)
    type(error_t), allocatable, intent(in) :: error
    integer, intent(out) :: info
    character(*), intent(out) :: message
    type(study_t), intent(in), optional :: study

    info = code_ok
    message = ''
    if (allocated(error)) then
      info = error%code
      message = error%message
    else if (present(study)) then
      if (study%stopped) then
        info = code_stopped
        message = 'interrupted: what was computed by then is there; points that were not have the status stopped'
      else if (failed_points(study) > 0) then
        info = code_partial
        message = str(failed_points(study))//' operating points have no answer (NaN); their status says why'
      end if
    end if
    call settle_memory()
    call bring_traps_back()
  end subroutine tell
end module gearsweep_border
