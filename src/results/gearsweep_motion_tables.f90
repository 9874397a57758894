!> Tables of the tasks `load`, `sweep` and `optimum`: what the motion does.
module gearsweep_motion_tables
  use gearsweep_decimal, only: in_um
  use gearsweep_error, only: error_t
  use gearsweep_kinds, only: dp
  use gearsweep_status, only: status_name
  use gearsweep_study, only: study_t
  use gearsweep_table, only: each, over_and_over, table_t
  implicit none
  private
  public :: load_table, sweep_table, optimum_table

  real(dp), parameter :: micro = 1e6_dp
  character(*), parameter :: of_relief = 'tip relief, as amount_um of the case', of_speed = 'speed of the pinion'
  character(*), parameter :: of_status = 'what was found of the operating point', &
                             of_periods = 'mesh periods until the motion repeats'
  !> At `contact` + 1 of a sweep.
  character(7), parameter :: contact_names(4) = [character(7) :: 'full', 'partial', 'lost', 'coast']
  integer, parameter :: status_length = 12

contains

  !> Load of one pair along its path at the speeds `load_rpm` (Dogan et al. 2021, Figs. 5, 6).
  pure subroutine load_table(study, table, error)
    type(study_t), intent(in) :: study
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: values(:, :)
    integer, allocatable :: periods(:), pair(:)
    character(status_length), allocatable :: status(:)
    integer :: i, k, rows, from, until

    if (.not. allocated(study%response)) return
    rows = sum([((size(study%response(i, k)%s), i=1, size(study%response, 1)), k=1, size(study%response, 2))])
    call table%begin('load', 'dynamic load of one pair along the path of contact', rows, 16, error)
    if (allocated(error)) return
    allocate (values(rows, 5), periods(rows), pair(rows), status(rows))
    from = 1
    do k = 1, size(study%response, 2)
      do i = 1, size(study%response, 1)
        associate (one => study%response(i, k), steady => study%response(i, k)%point%steady)
          until = from + size(one%s) - 1
          values(from:until, 1) = in_um(study%case%amount(i))
          values(from:until, 2) = one%rpm
          values(from:until, 3) = one%s
          values(from:until, 4) = one%load
          values(from:until, 5) = micro*one%error
          status(from:until) = status_name(steady%status)
          periods(from:until) = steady%periods
          pair(from:until) = one%pair
        end associate
        from = until + 1
      end do
    end do
    call table%add_index('relief_um', 'um', of_relief, values(:, 1))
    call table%add_index('rpm', '1/min', of_speed, values(:, 2))
    call table%add_index('s', '', 'path coordinate of the pair from A, in base pitches', values(:, 3))
    call table%add('pair_load_n', 'N', 'load of the pair', values(:, 4))
    call table%add('load_ratio', '', 'load of the pair over the static load', values(:, 4)/study%load)
    call table%add('dte_um', 'um', 'dynamic transmission error', values(:, 5))
    call table%add_words('status', of_status, status)
    call table%add('mesh_periods', '', of_periods, periods)
    call table%add_index('pair', '', 'of so many different pairs as there are mesh_periods, which', pair)
  end subroutine load_table

  !> One row an operating point. `contact`: full, partial (a pair was apart for a while), lost (all were), coast (the
  !> coast sides touched).
  pure subroutine sweep_table(study, table, error)
    type(study_t), intent(in) :: study
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    integer :: n, m

    if (.not. allocated(study%sweep)) return
    associate (sweep => study%sweep)
      n = size(sweep%status, 1)
      m = size(sweep%status, 2)
      call table%begin('sweep', 'dynamic factor over speed and relief', n*m, 12, error, extent=[m, n])
      if (allocated(error)) return
      call table%add_index('relief_um', 'um', of_relief, each(in_um(study%case%amount), n))
      call table%add_index('rpm', '1/min', of_speed, over_and_over(sweep%rpm, m))
      call table%add('dynamic_factor', '', 'largest load of a pair over the static load', [sweep%dynamic_factor])
      call table%add('error_estimate', '', 'estimated error of the dynamic factor', [sweep%estimate])
      call table%add_words('status', of_status, words_of([sweep%status]))
      call table%add_words('contact', 'full; partial: a pair was apart for a while; lost: all were; coast: the coast sides '// &
                           'touched', contact_names(1 + [sweep%contact]))
      call table%add('floquet_modulus', '', 'largest modulus of the Floquet multipliers', [sweep%multiplier])
      call table%add('residual', '', 'of periodicity, in static deflections', [sweep%residual])
      call table%add('steps', '', 'steps of a mesh period', [sweep%steps])
      call table%add('mesh_periods', '', of_periods, [sweep%periods])
    end associate
  end subroutine sweep_table

  !> Largest dynamic factor over the speeds against the relief (Dogan et al. 2021, Fig. 8).
  pure subroutine optimum_table(study, table, error)
    type(study_t), intent(in) :: study
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error

    if (.not. allocated(study%optimum)) return
    associate (optimum => study%optimum, n => size(study%optimum%amount))
      call table%begin('vcurve', 'largest dynamic factor over the speeds against the relief', n, 4, error, extent=[n])
      if (allocated(error)) return
      call table%add_index('relief_um', 'um', 'tip relief that the search tried', in_um(optimum%amount))
      call table%add('worst_dynamic_factor', '', 'largest dynamic factor over the speeds', optimum%dynamic_factor)
      call table%add('rpm', '1/min', 'speed of the pinion where that is', optimum%rpm)
      call table%add('points_without_answer', '', 'speeds without an answer', optimum%failed)
    end associate
  end subroutine optimum_table

  !> Names of statuses, padded to one length.
  pure function words_of(status) result(words)
    integer, intent(in) :: status(:)
    character(status_length) :: words(size(status))
    integer :: i

    do i = 1, size(status)
      words(i) = status_name(status(i))
    end do
  end function words_of
end module gearsweep_motion_tables
