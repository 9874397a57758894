!> A case with every default written out is the same case.
module test_defaults_written_out
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_study_case_case, only: case_t
  use gearsweep_api_case_reader, only: complete_case, read_case
  use gearsweep_base_error, only: code_input, code_ok, error_t
  use gearsweep_base_kinds, only: dp
  use gearsweep_study_run_study, only: run_study, study_t
  use gearsweep_base_table, only: kind_text, table_t
  use gearsweep_api_tables, only: make_table, table_names
  use gearsweep_base_text, only: str
  use test_support_random_numbers, only: random_t
  use test_support_testing, only: check_equal, check_true, tally_t
  implicit none
  private
  public :: run

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('complete_texts')) call test_complete_texts(t)
  end subroutine run

  !> Random texts, with values of 1 to 17 digits and keys left out at random: where a text is accepted, so is the
  !> complete one; that completes to itself, and has the same tables bit by bit.
  subroutine test_complete_texts(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: draws = 400
    type(random_t) :: random
    character(:), allocatable :: case, complete, again
    type(error_t), allocatable :: error
    integer(int64), allocatable :: ours(:), other(:)
    integer :: i, info, accepted, unlike

    accepted = 0
    unlike = 0
    do i = 1, draws
      call draw_case(random, case)
      call find_bits(case, ours, info)
      if (info /= code_ok) cycle
      accepted = accepted + 1
      call complete_case(case, complete, error)
      if (.not. allocated(error)) call complete_case(complete, again, error)
      info = merge(code_input, code_ok, allocated(error))
      if (info == code_ok) info = merge(0, 1, again == complete)
      if (info == code_ok) call find_bits(complete, other, info)
      if (info == code_ok .and. size(ours) == size(other) .and. size(ours) > 0) then
        if (all(ours == other)) cycle
      end if
      if (unlike == 0) print '(a)', case
      unlike = unlike + 1
    end do
    call check_true(t, 'most random texts are accepted', 2*accepted > draws, str(accepted)//' of '//str(draws))
    call check_equal(t, 'complete texts with another result', unlike, 0)
  end subroutine test_complete_texts

  !> The bits of all numbers of all tables.
  subroutine find_bits(text, bits, info)
    character(*), intent(in) :: text
    integer(int64), allocatable, intent(out) :: bits(:)
    integer, intent(out) :: info
    type(case_t) :: case
    type(study_t) :: study
    type(table_t) :: table
    type(error_t), allocatable :: error
    character(18), allocatable :: names(:)
    integer :: i, k

    allocate (bits(0))
    call read_case(text, case, error)
    if (.not. allocated(error)) call run_study(case, '', 1, study, error)
    info = merge(code_input, code_ok, allocated(error))
    if (allocated(error)) return
    names = table_names()
    do i = 1, size(names)
      call make_table(study, trim(names(i)), table, error)
      if (.not. table%is_there()) cycle
      do k = 1, size(table%columns)
        if (table%columns(k)%kind /= kind_text) bits = [bits, transfer(table%columns(k)%numbers, [0_int64])]
      end do
    end do
  end subroutine find_bits

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
    case = case//key('amount_um', 0.0_dp, 30.0_dp, .false.)//key('gear_fraction', 0.0_dp, 1.0_dp, .true.)
    case = case//' / &mesh model = ''weber'' /'

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
end module test_defaults_written_out
