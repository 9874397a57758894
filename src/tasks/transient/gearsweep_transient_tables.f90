!> What the task `transient` found, as its tables.
module gearsweep_transient_tables
  use gearsweep_decimal, only: in_um
  use gearsweep_error, only: error_t
  use gearsweep_kinds, only: dp, pi
  use gearsweep_points, only: known_count, of_motions, of_relief, of_speed, of_status, words_of
  use gearsweep_status, only: has_result, status_ok
  use gearsweep_stress, only: stress_peak_t
  use gearsweep_table, only: axis, no_number, table_t
  use gearsweep_tooth_modes, only: along, moved_x, moved_y, per_point, tooth_modes_t
  use gearsweep_tooth_transient, only: tooth_transient_t
  implicit none
  private
  public :: tooth_run_t, fill_histories, fill_points, fill_peaks

  !> One passage of the load.
  type :: tooth_run_t
    real(dp) :: relief = 0, rpm = 0              !< m, 1/min
    integer :: status = status_ok                !< of the motion whose load it is
    integer :: motions = 0                       !< how many there are; 0: not known, or it is not that of a motion
    type(tooth_transient_t) :: tooth             !< empty without a result
  end type tooth_run_t

  !> Columns of a row over time; the error is that of the stress.
  integer, parameter :: highest = 1, when_highest = 2, lowest = 3, when_lowest = 4, largest = 5, largest_at_rest = 6, &
    estimate = 7
  real(dp), parameter :: degree = pi/180, milli = 1e3_dp, micro = 1e6_dp, mega = 1e-6_dp
  character(*), parameter :: sides(2) = [character(5) :: 'drive', 'coast']
  character(*), parameter :: of_tangent = 'angle of the fillet''s tangent at this point to the tooth''s axis', &
    of_side = 'drive (the loaded side: tension) or coast'

contains

  !> Stress and displacement at the chosen points over time.
  !>
  !> `runs`: reliefs, of each all speeds. `tangent`: the chosen points, rad. `poisson`: Poisson's ratio in plane strain, 0 in
  !> plane stress.
  pure subroutine fill_histories(runs, tooth, tangent, poisson, table, error)
    type(tooth_run_t), intent(in) :: runs(:)
    type(tooth_modes_t), intent(in) :: tooth
    real(dp), intent(in) :: tangent(:), poisson
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    integer :: i, k, n, points

    if (allocated(error)) return
    points = 2*size(tangent)
    call table%begin('stress and displacement at points of the fillets while the load passes', &
                     sum([(samples_of(runs(i)), i=1, size(runs))])*points, error)
    if (allocated(error)) return
    associate (run => [((i, k=1, points*samples_of(runs(i))), i=1, size(runs))], &
               point => [(((k, n=1, samples_of(runs(i))), k=1, points), i=1, size(runs))])
      call table%add_index(axis('relief_um', 'um', of_relief, in_um(runs(run)%relief)))
      call table%add_index(axis('rpm', '1/min', of_speed, [runs(run)%rpm]))
      call table%add_index(axis('tangent_deg', 'deg', of_tangent, tangent((point + 1)/2)/degree))
      call table%add_index(axis('side', '', of_side, sides(2 - modulo(point, 2))))
      call table%add_index(axis('time_ms', 'ms', 'time since the load met the tooth', &
                                milli*[((times_of(runs(i)), k=1, points), i=1, size(runs))]))
      call table%add('s', '', 'path coordinate of the load, in base pitches from A', [((places_of(runs(i)), k=1, points), &
                                                                                      i=1, size(runs))])
      call table%add('load_n', 'N', 'load on the tooth', [((loads_of(runs(i)), k=1, points), i=1, size(runs))])
      associate (sigma => [((history_of(runs(i), k, along), k=1, points), i=1, size(runs))])
        call add_stress(sigma, tooth%direction(:, point), poisson, table)
      end associate
      call table%add('static_mpa', 'MPa', 'stress along the surface under the same load at rest', &
                     mega*[((static_of(runs(i), k), k=1, points), i=1, size(runs))])
      call table%add('displacement_x_um', 'um', 'displacement across the tooth, to its drive side', &
                     micro*[((history_of(runs(i), k, moved_x), k=1, points), i=1, size(runs))])
      call table%add('displacement_y_um', 'um', 'displacement along the tooth''s axis', &
                     micro*[((history_of(runs(i), k, moved_y), k=1, points), i=1, size(runs))])
    end associate
  end subroutine fill_histories

  !> The largest at each chosen point over time; there are `speeds` of each relief.
  pure subroutine fill_points(runs, tooth, tangent, speeds, poisson, table, error)
    type(tooth_run_t), intent(in) :: runs(:)
    type(tooth_modes_t), intent(in) :: tooth
    real(dp), intent(in) :: tangent(:), poisson
    integer, intent(in) :: speeds
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    integer :: i, k, points

    if (allocated(error)) return
    points = 2*size(tangent)
    call table%begin('the largest stress and displacement at points of the fillets while the load passes', size(runs)*points, &
                     error, extent=[size(runs)/speeds, speeds, size(tangent), 2])
    if (allocated(error)) return
    associate (run => [((i, k=1, points), i=1, size(runs))], point => [((k, k=1, points), i=1, size(runs))])
      call table%add_index(axis('relief_um', 'um', of_relief, in_um(runs(run)%relief)))
      call table%add_index(axis('rpm', '1/min', of_speed, [runs(run)%rpm]))
      call table%add_index(axis('tangent_deg', 'deg', of_tangent, tangent((point + 1)/2)/degree))
      call table%add_index(axis('side', '', of_side, sides(2 - modulo(point, 2))))
      call table%add('highest_mpa', 'MPa', 'highest stress along the surface', &
                     mega*of_points(runs, tooth, points, along, highest))
      call table%add('highest_ms', 'ms', 'when', milli*of_points(runs, tooth, points, along, when_highest))
      call table%add('lowest_mpa', 'MPa', 'lowest stress along the surface', mega*of_points(runs, tooth, points, along, lowest))
      call table%add('lowest_ms', 'ms', 'when', milli*of_points(runs, tooth, points, along, when_lowest))
      call add_stress(of_points(runs, tooth, points, along, largest), tooth%direction(:, point), poisson, table, &
                      'where it is largest in size: ')
      call table%add('static_mpa', 'MPa', 'stress along the surface, the largest in size with the load at rest', &
                     mega*of_points(runs, tooth, points, along, largest_at_rest))
      call table%add('displacement_x_um', 'um', 'displacement across the tooth, to its drive side, the largest in size', &
                     micro*of_points(runs, tooth, points, moved_x, largest))
      call table%add('displacement_y_um', 'um', 'displacement along the tooth''s axis, the largest in size', &
                     micro*of_points(runs, tooth, points, moved_y, largest))
      call table%add('error_estimate', '', 'estimated discretisation error of the largest stress, relative', &
                     of_points(runs, tooth, points, along, estimate))
    end associate
  end subroutine fill_points

  !> The largest of the fillets, wherever it lies.
  pure subroutine fill_peaks(runs, speeds, poisson, table, error)
    type(tooth_run_t), intent(in) :: runs(:)
    real(dp), intent(in) :: poisson
    integer, intent(in) :: speeds
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    type(stress_peak_t) :: high(size(runs)), low(size(runs))

    if (allocated(error)) return
    call table%begin('the largest stress in the root fillets while the load passes', size(runs), error, &
                     extent=[size(runs)/speeds, speeds])
    if (allocated(error)) return
    high = runs%tooth%peaks%tension
    low = runs%tooth%peaks%compression
    associate (known => has_result(runs%status))
      call table%add_index(axis('relief_um', 'um', of_relief, in_um(runs%relief)))
      call table%add_index(axis('rpm', '1/min', of_speed, [runs%rpm]))
      call table%add('tension_mpa', 'MPa', 'largest tension along the surface', known_only(mega*high%stress, known))
      call table%add('tension_deg', 'deg', 'angle of the fillet''s tangent there to the tooth''s axis', &
                     known_only(high%tangent/degree, known))
      call table%add('static_tension_mpa', 'MPa', 'largest tension with the load at rest', &
                     known_only(mega*runs%tooth%static%tension%stress, known))
      call table%add('compression_mpa', 'MPa', 'largest compression along the surface, negative', &
                     known_only(mega*low%stress, known))
      call table%add('compression_deg', 'deg', 'angle of the fillet''s tangent there to the tooth''s axis', &
                     known_only(low%tangent/degree, known))
      call table%add('static_compression_mpa', 'MPa', 'largest compression with the load at rest, negative', &
                     known_only(mega*runs%tooth%static%compression%stress, known))
      call table%add('mises_mpa', 'MPa', 'largest von Mises stress', &
                     known_only(mega*mises(larger(high%stress, low%stress), poisson), known))
      call table%add('tension_ratio', '', 'largest tension over that with the load at rest', &
                     known_only(high%stress/over(runs%tooth%static%tension%stress), known))
      call table%add('compression_ratio', '', 'the same of the compression', &
                     known_only(low%stress/over(runs%tooth%static%compression%stress), known))
      call table%add('look_us', 'us', 'time between two looks for the largest values', known_only(micro*runs%tooth%look, known))
      call table%add('error_estimate', '', 'estimated discretisation error of the stresses, relative', &
                     known_only(runs%tooth%peaks%error_estimate, known))
      call table%add_words('status', of_status, words_of([runs%status]))
      call table%add('motions', '', of_motions//'; also under a static load', known_count(runs%motions))
    end associate
  end subroutine fill_peaks

  !> The columns of a stress along the surface (Pa) and its components. The fillet carries no load, so that there is no other;
  !> in plane strain nu times it acts across the plane.
  pure subroutine add_stress(sigma, direction, poisson, table, before)
    real(dp), intent(in) :: sigma(:), direction(:, :), poisson
    type(table_t), intent(inout) :: table
    character(*), intent(in), optional :: before
    character(:), allocatable :: lead

    lead = ''
    if (present(before)) lead = before
    call table%add('sigma_mpa', 'MPa', lead//'stress along the surface', mega*sigma)
    call table%add('sigma_x_mpa', 'MPa', lead//'component across the tooth, x to its drive side', mega*sigma*direction(1, :)**2)
    call table%add('sigma_y_mpa', 'MPa', lead//'component along the tooth''s axis y', mega*sigma*direction(2, :)**2)
    call table%add('tau_xy_mpa', 'MPa', lead//'shear component', mega*sigma*direction(1, :)*direction(2, :))
    call table%add('mises_mpa', 'MPa', lead//'von Mises stress', mega*mises(sigma, poisson))
  end subroutine add_stress

  !> Of a stress along a free surface.
  elemental real(dp) function mises(sigma, poisson)
    real(dp), intent(in) :: sigma, poisson

    mises = abs(sigma)*sqrt(1 - poisson + poisson**2)
  end function mises

  !> The larger in size of two.
  elemental real(dp) function larger(a, b)
    real(dp), intent(in) :: a, b

    larger = merge(a, b, abs(a) >= abs(b))
  end function larger

  !> A divisor that may be zero where nothing is known.
  elemental real(dp) function over(value)
    real(dp), intent(in) :: value

    over = merge(value, 1.0_dp, abs(value) > 0)
  end function over

  elemental real(dp) function known_only(value, known)
    real(dp), intent(in) :: value
    logical, intent(in) :: known

    known_only = no_number()
    if (known) known_only = value
  end function known_only

  !> A passage without a result has one row of each point.
  pure integer function samples_of(run)
    type(tooth_run_t), intent(in) :: run

    samples_of = 1
    if (allocated(run%tooth%s)) samples_of = size(run%tooth%s)
  end function samples_of

  pure function times_of(run) result(values)
    type(tooth_run_t), intent(in) :: run
    real(dp) :: values(samples_of(run))

    values = no_number()
    if (allocated(run%tooth%s)) values = run%tooth%record%time - run%tooth%record%time(1)
  end function times_of

  pure function places_of(run) result(values)
    type(tooth_run_t), intent(in) :: run
    real(dp) :: values(samples_of(run))

    values = no_number()
    if (allocated(run%tooth%s)) values = run%tooth%s
  end function places_of

  pure function loads_of(run) result(values)
    type(tooth_run_t), intent(in) :: run
    real(dp) :: values(samples_of(run))

    values = no_number()
    if (allocated(run%tooth%s)) values = run%tooth%load
  end function loads_of

  pure function history_of(run, point, what) result(values)
    type(tooth_run_t), intent(in) :: run
    integer, intent(in) :: point, what
    real(dp) :: values(samples_of(run))

    values = no_number()
    if (allocated(run%tooth%s)) values = run%tooth%record%value(per_point*(point - 1) + what, :)
  end function history_of

  pure function static_of(run, point) result(values)
    type(tooth_run_t), intent(in) :: run
    integer, intent(in) :: point
    real(dp) :: values(samples_of(run))

    values = no_number()
    if (allocated(run%tooth%s)) values = run%tooth%record%static(per_point*(point - 1) + along, :)
  end function static_of

  !> Of one row (`what`) of the chosen points of all runs: see the constants.
  pure function of_points(runs, tooth, points, what, which) result(values)
    type(tooth_run_t), intent(in) :: runs(:)
    type(tooth_modes_t), intent(in) :: tooth
    integer, intent(in) :: points, what, which
    real(dp) :: values(points*size(runs))
    integer :: i, k, row

    values = no_number()
    do i = 1, size(runs)
      if (.not. allocated(runs(i)%tooth%s)) cycle
      associate (record => runs(i)%tooth%record)
        do k = 1, points
          row = tooth%row_of(k) + what
          associate (value => values(points*(i - 1) + k))
            select case (which)
            case (highest)
              value = record%highest(row)
            case (when_highest)
              value = record%time_highest(row) - record%time(1)
            case (lowest)
              value = record%lowest(row)
            case (when_lowest)
              value = record%time_lowest(row) - record%time(1)
            case (largest)
              value = larger(record%highest(row), record%lowest(row))
            case (largest_at_rest)
              value = larger(record%static_highest(row), record%static_lowest(row))
            case default
              value = runs(i)%tooth%point_error(k)
            end select
          end associate
        end do
      end associate
    end do
  end function of_points
end module gearsweep_transient_tables
