!> Root stress under the real load sharing, and printed values beside ours.
module test_rating
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_base_error, only: error_t
  use gearsweep_study_case_case, only: case_t
  use gearsweep_api_case_reader, only: read_case
  use gearsweep_study_run_files, only: read_text
  use gearsweep_gear_gear, only: coast, drive
  use gearsweep_motion_oscillator, only: oscillator_t
  use gearsweep_study_case_published, only: published_t, read_published
  use gearsweep_study_results_results, only: our_value
  use gearsweep_rating_root_rating, only: rate_root, root_rating_t
  use gearsweep_mesh_sharing, only: load_share
  use gearsweep_study_run_study, only: run_study, study_t
  use gearsweep_api_tables, only: column_of
  use test_support_reference_rows, only: prescribed
  use test_support_testing, only: tally_t, check_true, check_close, check_error, check_no_error, check_equal
  implicit none
  private
  public :: run

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('shares_add_up')) call shares_add_up(t)
    if (t%wants('hassan')) call hassan(t)
    if (t%wants('reliefs_share_one_solution')) call reliefs_share_one_solution(t)
    if (t%wants('malformed_tables')) call malformed_tables(t)
  end subroutine run

  !> The pairs at one phase carry the load together.
  subroutine shares_add_up(t)
    type(tally_t), intent(inout) :: t
    type(oscillator_t) :: osc
    real(dp) :: s
    integer :: i

    call prescribed(1.6_dp, [400.0_dp, 20.0_dp, -110.0_dp], [12.0_dp, 25.0_dp], 1, osc)
    do i = 1, 10
      s = 0.0597_dp*i
      call check_close(t, 'two pairs', load_share(osc%mesh, 7000.0_dp, s) + load_share(osc%mesh, 7000.0_dp, s + 1), &
                       1.0_dp, 1e-13_dp)
    end do
    call check_close(t, 'one pair', load_share(osc%mesh, 7000.0_dp, 0.8_dp), 1.0_dp, 1e-14_dp)
    call check_close(t, 'relief unloads the tip', load_share(osc%mesh, 5000.0_dp, 0.0_dp), 0.0_dp, absolute=1e-15_dp)
  end subroutine shares_add_up

  !> Hassan et al. 2009, by way of the case that users run: Table 1 within
  !> 0.5 %, the values that follow from the stated inputs, and those that the
  !> stated inputs give instead of the printed ones.
  subroutine hassan(t)
    type(tally_t), intent(inout) :: t
    type(case_t) :: case
    type(study_t) :: study
    type(error_t), allocatable :: error
    character(:), allocatable :: text
    character(1) :: digit
    integer :: i

    call read_text('data/hassan.nml', text, error)
    call read_case(text, case, error)
    call check_no_error(t, 'hassan.nml', error)
    call run_study(case, 'data/', 1, study, error)
    call check_no_error(t, 'hassan study', error)
    do i = 1, 5
      write (digit, '(i1)') i
      call printed('mode_'//digit//'_hz', 0.005_dp)
    end do
    call printed('tangential_force_n', 2e-6_dp)
    call printed('radial_force_n', 1e-5_dp)
    ! The prototypes' values by the stated inputs, independent of ours.
    call given('beam_frequency_rad_s', 30761.0_dp, 2e-5_dp)
    call given('rayleigh_frequency_rad_s', 64525.0_dp, 2e-5_dp)
    call given('beam_sigma_x_mpa', 4.064_dp, 2e-4_dp)
    call given('beam_sigma_y_mpa', 53.32_dp, 1e-4_dp)
    call check_true(t, 'every printed value has ours', all_known())

  contains

    subroutine printed(quantity, relative)
      character(*), intent(in) :: quantity
      real(dp), intent(in) :: relative
      integer :: k

      do k = 1, size(study%published)
        if (study%published(k)%quantity == quantity) call given(quantity, study%published(k)%printed, relative)
      end do
    end subroutine printed

    subroutine given(quantity, expected, relative)
      character(*), intent(in) :: quantity
      real(dp), intent(in) :: expected, relative
      real(dp) :: value
      logical :: known

      call our_value(study, quantity, value, known)
      call check_true(t, quantity//' is known', known)
      call check_close(t, quantity, value, expected, relative)
    end subroutine given

    logical function all_known()
      real(dp) :: value
      integer :: k

      do k = 1, size(study%published)
        call our_value(study, study%published(k)%quantity, value, all_known)
        if (.not. all_known) return
      end do
    end function all_known
  end subroutine hassan

  !> Stress is linear in the load share; deep relief takes load off the tip, not
  !> off the outer point of single contact, where the peak is.
  subroutine reliefs_share_one_solution(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: text = '&case tasks=''static'' / &pair module_mm=3.18 face_width_mm=25.4 /'// &
      '&pinion teeth=25 / &gear teeth=25 / &load line_load_n_mm=276 / &relief amount_um=0, 15 / '// &
      '&mesh model=''weber'' corner_contact=.false. / &section elements_across=8 / &static positions=9 /'
    type(case_t) :: case
    type(study_t) :: study
    type(error_t), allocatable :: error
    real(dp), allocatable :: s(:, :), share(:, :), stress(:, :, :), tension(:), iso(:)
    integer :: k

    call read_case(text, case, error)
    call check_no_error(t, 'static case', error)
    call run_study(case, '', 1, study, error)
    call check_no_error(t, 'static study', error)
    ! Rows of the table: relief, position, side.
    stress = reshape(column_of(study, 'static', 'sigma_mpa'), [2, size(column_of(study, 'static', 's'))/4, 2])
    associate (n => size(stress, 2), from => column_of(study, 'static', 's'), shares => column_of(study, 'static', 'load_share'))
      s = reshape(from(::2), [n, 2])
      share = reshape(shares(::2), [n, 2])
      do k = 1, n
        if (share(k, 2) <= 0) cycle
        call check_close(t, 'linear in the share', stress(coast, k, 2)/share(k, 2), stress(coast, k, 1)/share(k, 1), 1e-9_dp)
      end do
      tension = column_of(study, 'root_stress', 'tension_mpa')
      iso = column_of(study, 'root_rating', 'iso_mpa')
      k = maxloc(stress(drive, :, 1), 1)
      call check_close(t, 'peak at the outer point of single contact', s(k, 1), 1.0_dp, absolute=1e-6_dp)
      call check_close(t, 'same peak with relief', tension(2), tension(1), 1e-12_dp)
      call check_true(t, 'relief unloads the tip', share(n, 2) < 0.2_dp*share(n, 1))
      ! ISO 6336-3 for the same tooth: an independent method, good to some per cent.
      call check_close(t, 'beside the standard', tension(1), iso(1), 0.05_dp)
    end associate
  end subroutine reliefs_share_one_solution

  subroutine malformed_tables(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: header = 'quantity,place,printed,unit,status,reason'//new_line('a')
    type(published_t), allocatable :: rows(:)
    type(error_t), allocatable :: error

    call read_published('p.csv', '# remark'//new_line('a')//header// &
                        'contact_ratio,b,1.5,mm,stated,because, and so'//new_line('a'), rows, error)
    call check_no_error(t, 'published', error)
    call check_equal(t, 'rows', size(rows), 1)
    call check_equal(t, 'reason keeps its commas', rows(1)%reason, 'because, and so')
    call read_published('p.csv', 'a,b'//new_line('a'), rows, error)
    call check_error(t, 'no header', error, 'must be quantity,place')
    call read_published('p.csv', header//'contact_ratio,b,x,mm,stated,r', rows, error)
    call check_error(t, 'no number', error, 'p.csv line 2: printed = x: must be a number')
    call read_published('p.csv', header//'mode_3_hz,b,1,mm,guessed,r', rows, error)
    call check_error(t, 'no status', error, 'status = guessed')
    call read_published('p.csv', header//'mode_3_rad_s,b,1,mm,stated,r', rows, error)
    call check_error(t, 'no such quantity', error, 'quantity = mode_3_rad_s: must be one of contact_ratio')
    call read_published('p.csv', '', rows, error)
    call check_error(t, 'empty', error, 'lacks the line')
  end subroutine malformed_tables
end module test_rating
