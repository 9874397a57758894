!> The results as CSV text. Lines that begin with `#` carry version, units and
!> the case; numbers have 15 significant digits.
module gearsweep_tables
  use gearsweep_kinds, only: dp, pi
  use gearsweep_body_report, only: mode_rows, outline_rows, published_rows, root_rows
  use gearsweep_lines, only: bare, lines_t, field
  use gearsweep_steady, only: name_of
  use gearsweep_study, only: study_t
  use gearsweep_version, only: version
  implicit none
  private
  public :: sweep_table, mesh_table, harmonics_table, load_table, optimum_table
  public :: outline_table, root_table, mode_table, published_table

  real(dp), parameter :: micro = 1e6_dp, milli = 1e3_dp
  character(7), parameter :: contact_names(0:3) = [character(7) :: 'full', 'partial', 'lost', 'coast']

contains

  pure subroutine open_table(study, what, columns, lines)
    type(study_t), intent(in) :: study
    character(*), intent(in) :: what, columns
    type(lines_t), intent(inout) :: lines
    integer :: from, length

    call lines%add('# gearsweep '//version//': '//what)
    call lines%add('# case:')
    associate (text => study%case%text)
      from = 1
      do while (from <= len(text))
        length = index(text(from:), new_line('a')) - 1
        if (length < 0) length = len(text) - from + 1
        call lines%add('#   '//bare(text(from:from + length - 1)))
        from = from + length + 1
      end do
    end associate
    call lines%add(columns)
  end subroutine open_table

  !> One row an operating point. `contact`: full, partial (a pair was apart for
  !> a while), lost (all were), coast (the coast sides touched).
  pure function sweep_table(study) result(text)
    type(study_t), intent(in) :: study
    character(:), allocatable :: text
    type(lines_t) :: lines
    integer :: i, k

    call open_table(study, 'dynamic factor over speed and relief; units: relief in um, speed of the pinion '// &
                    'in 1/min, residual in static deflections', 'relief_um,rpm,dynamic_factor,error_estimate,status,'// &
                    'contact,floquet_modulus,residual,steps,mesh_periods', lines)
    associate (sweep => study%sweep)
      do i = 1, size(sweep%status, 2)
        do k = 1, size(sweep%rpm)
          call lines%add(field(micro*study%case%amount(i))//','//field(sweep%rpm(k))//','// &
                         field(sweep%dynamic_factor(k, i))//','//field(sweep%estimate(k, i))//','// &
                         name_of(sweep%status(k, i))//','//trim(contact_names(sweep%contact(k, i)))//','// &
                         field(sweep%multiplier(k, i))//','//field(sweep%residual(k, i))//','// &
                         field(sweep%steps(k, i))//','//field(sweep%periods(k, i)))
        end do
      end do
    end associate
    text = lines%text()
  end function sweep_table

  !> Static state of one pair along its path of contact, for each relief.
  pure function mesh_table(study) result(text)
    type(study_t), intent(in) :: study
    character(:), allocatable :: text
    type(lines_t) :: lines
    character(:), allocatable :: columns
    integer :: i, j, k

    columns = 'relief_um,s,pair_stiffness_n_um,mesh_stiffness_n_um,profile_error_um,load_share,ste_um'
    if (study%base_pitch > 0) columns = columns//',path_mm'
    if (allocated(study%pair)) columns = columns//',pinion_radius_mm,pinion_curvature_mm,gear_curvature_mm'
    call open_table(study, 'one pair along the path of contact, static; units: s in base pitches from A, '// &
                    'stiffness in N/um over the whole face width (mesh: of the pairs that carry), '// &
                    'load_share of the static load, ste: static transmission error in um', columns, lines)
    do i = 1, size(study%sharing)
      associate (sharing => study%sharing(i))
        do j = 1, maxval(sharing%pairs)
          do k = 1, size(sharing%phase)
            if (sharing%pairs(k) >= j) call lines%add(mesh_row(study, i, j, k))
          end do
        end do
      end associate
    end do
    text = lines%text()
  end function mesh_table

  pure function mesh_row(study, i, j, k) result(row)
    type(study_t), intent(in) :: study
    integer, intent(in) :: i, j, k
    character(:), allocatable :: row
    real(dp) :: s

    associate (sharing => study%sharing(i), mesh => study%motion(i)%mesh)
      s = sharing%s(j, k)
      row = field(micro*study%case%amount(i))//','//field(s)//','//field(mesh%stiffness%value(s)/micro)//','// &
            field(sharing%stiffness(k)/micro)//','//field(micro*mesh%profile_error%value(s))//','// &
            field(sharing%load(j, k)/study%load)//','//field(micro*sharing%error(k))
    end associate
    if (study%base_pitch > 0) row = row//','//field(milli*s*study%base_pitch)
    if (allocated(study%pair)) row = row//','//field(milli*study%pair%radius(1, s))//','// &
      field(milli*study%pair%curvature(1, s))//','// &
      field(milli*study%pair%curvature(2, s))
  end function mesh_row

  !> Harmonics of the static transmission error for each relief; harmonic 0 is the mean.
  pure function harmonics_table(study) result(text)
    type(study_t), intent(in) :: study
    character(:), allocatable :: text
    type(lines_t) :: lines
    real(dp), allocatable :: amplitude(:), phase(:)
    integer :: i, k

    call open_table(study, 'static transmission error as mean + sum of amplitude cos(2 pi harmonic tau + phase) over the '// &
                    'mesh phase tau, 0 where a pair enters at A; units: um, degrees', &
                    'relief_um,harmonic,amplitude_um,phase_deg,error_estimate_um', lines)
    do i = 1, size(study%harmonics)
      associate (ste => study%harmonics(i))
        amplitude = [ste%mean, ste%amplitude]
        phase = [0.0_dp, ste%phase]
        do k = 1, size(amplitude)
          call lines%add(field(micro*study%case%amount(i))//','//field(k - 1)//','//field(micro*amplitude(k))//','// &
                         field(phase(k)*180/pi)//','//field(micro*ste%error_estimate))
        end do
      end associate
    end do
    text = lines%text()
  end function harmonics_table

  !> Load of one pair along its path at the speeds `load_rpm` (Dogan et al. 2021, Figs. 5, 6).
  pure function load_table(study) result(text)
    type(study_t), intent(in) :: study
    character(:), allocatable :: text
    type(lines_t) :: lines
    integer :: i, k, row

    call open_table(study, 'dynamic load of one pair along the path of contact; units: s in base pitches from A, '// &
                    'speed of the pinion in 1/min, load in N, dte: dynamic transmission error in um', &
                    'relief_um,rpm,s,pair_load_n,load_ratio,dte_um', lines)
    do k = 1, size(study%response, 2)
      do i = 1, size(study%response, 1)
        associate (response => study%response(i, k))
          do row = 1, size(response%s)
            call lines%add(field(micro*study%case%amount(i))//','//field(response%rpm)//','//field(response%s(row))// &
                           ','//field(response%load(row))//','//field(response%load(row)/study%load)//','// &
                           field(micro*response%error(row)))
          end do
        end associate
      end do
    end do
    text = lines%text()
  end function load_table

  !> Largest dynamic factor over the speeds against the relief (Dogan et al. 2021, Fig. 8).
  pure function optimum_table(study) result(text)
    type(study_t), intent(in) :: study
    character(:), allocatable :: text
    type(lines_t) :: lines
    integer :: i

    call open_table(study, 'largest dynamic factor over the speeds against the relief; units: relief in um, speed '// &
                    'of the pinion in 1/min', 'relief_um,worst_dynamic_factor,rpm,points_without_answer', lines)
    associate (optimum => study%optimum)
      do i = 1, size(optimum%amount)
        call lines%add(field(micro*optimum%amount(i))//','//field(optimum%dynamic_factor(i))//','// &
                       field(optimum%rpm(i))//','//field(optimum%failed(i)))
      end do
    end associate
    text = lines%text()
  end function optimum_table

  !> Outlines of both gears as points, clockwise, centres at the origin.
  pure function outline_table(study) result(text)
    type(study_t), intent(in) :: study
    character(:), allocatable :: text
    type(lines_t) :: lines

    call open_table(study, 'outline of both gears, each about its own centre; units: mm', 'member,x_mm,y_mm', lines)
    call outline_rows(study, lines)
    text = lines%text()
  end function outline_table

  !> Root stress of one member under the moving load, at the fillet tangent of the case.
  pure function root_table(study) result(text)
    type(study_t), intent(in) :: study
    character(:), allocatable :: text
    type(lines_t) :: lines

    call open_table(study, 'stress at the fillet tangent; units: s in base pitches from A, radius of the load in mm, '// &
                    'share of the static load, stress in MPa (x across the tooth to the drive side, y along its axis)', &
                    'relief_um,s,radius_mm,load_share,side,sigma_mpa,sigma_x_mpa,sigma_y_mpa,tau_xy_mpa', lines)
    call root_rows(study, lines)
    text = lines%text()
  end function root_table

  !> Natural frequencies of the section.
  pure function mode_table(study) result(text)
    type(study_t), intent(in) :: study
    character(:), allocatable :: text
    type(lines_t) :: lines

    call open_table(study, 'natural frequencies of the section; units: Hz, relative error estimate, residual of the '// &
                    'eigenvalue problem, share of the rim in the kinetic energy', &
                    'mode,frequency_hz,error_estimate,residual,rim_share', lines)
    call mode_rows(study, lines)
    text = lines%text()
  end function mode_table

  !> Printed values beside ours; NaN where the tasks do not compute it.
  pure function published_table(study) result(text)
    type(study_t), intent(in) :: study
    character(:), allocatable :: text
    type(lines_t) :: lines

    call open_table(study, 'printed values and ours; deviation relative to the printed value', &
                    'quantity,place,printed,ours,deviation,unit,status,reason', lines)
    call published_rows(study, lines)
    text = lines%text()
  end function published_table
end module gearsweep_tables
