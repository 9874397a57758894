!> The results as CSV text. Lines that begin with `#` carry version, units and
!> the case; numbers have 15 significant digits.
module gearsweep_tables
  use gearsweep_kinds, only: dp, pi
  use gearsweep_contour, only: shown_contour
  use gearsweep_gear, only: coast, drive
  use gearsweep_lines, only: bare, lines_t
  use gearsweep_quantities, only: our_value
  use gearsweep_status, only: status_name
  use gearsweep_study, only: study_t
  use gearsweep_version, only: version
  implicit none
  private
  public :: has_table, write_table

  character(*), parameter, public :: table_names(9) = [character(9) :: 'mesh', 'harmonics', 'load', 'sweep', 'vcurve', &
                                                       'outline', 'root', 'modes', 'published']
  !> How every table begins.
  character(*), parameter, public :: table_start = '# gearsweep '
  real(dp), parameter :: micro = 1e6_dp, milli = 1e3_dp, mega = 1e-6_dp
  character(7), parameter :: contact_names(0:3) = [character(7) :: 'full', 'partial', 'lost', 'coast']

contains

  !> Does the study have what this table shows?
  pure logical function has_table(study, name)
    type(study_t), intent(in) :: study
    character(*), intent(in) :: name

    select case (name)
    case ('mesh')
      has_table = allocated(study%sharing)
    case ('harmonics')
      has_table = allocated(study%harmonics)
    case ('load')
      has_table = allocated(study%response)
    case ('sweep')
      has_table = allocated(study%sweep)
    case ('vcurve')
      has_table = allocated(study%optimum)
    case ('outline')
      has_table = allocated(study%section)
    case ('root')
      has_table = allocated(study%root)
    case ('modes')
      has_table = allocated(study%modal)
    case ('published')
      has_table = allocated(study%published)
    case default
      has_table = .false.
    end select
  end function has_table

  !> One of the tables that the study has.
  pure subroutine write_table(study, name, text)
    type(study_t), intent(in) :: study
    character(*), intent(in) :: name
    character(:), allocatable, intent(out) :: text
    type(lines_t) :: lines

    select case (name)
    case ('mesh')
      call mesh_table(study, lines)
    case ('harmonics')
      call harmonics_table(study, lines)
    case ('load')
      call load_table(study, lines)
    case ('sweep')
      call sweep_table(study, lines)
    case ('vcurve')
      call optimum_table(study, lines)
    case ('outline')
      call outline_table(study, lines)
    case ('root')
      call root_table(study, lines)
    case ('modes')
      call mode_table(study, lines)
    case ('published')
      call published_table(study, lines)
    end select
    text = lines%text()
  end subroutine write_table

  pure subroutine open_table(study, what, columns, lines)
    type(study_t), intent(in) :: study
    character(*), intent(in) :: what, columns
    type(lines_t), intent(inout) :: lines
    integer :: from, length

    call lines%add(table_start//version//': '//what)
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

  !> Static state of one pair along its path of contact, for each relief.
  pure subroutine mesh_table(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    character(:), allocatable :: columns
    integer :: i, j, k

    columns = 'relief_um,s,pair_stiffness_n_um,mesh_stiffness_n_um,profile_error_um,load_share,ste_um'
    if (study%base_pitch > 0) columns = columns//',path_mm'
    if (allocated(study%pair)) columns = columns//',pinion_radius_mm,pinion_curvature_mm,gear_curvature_mm'
    call open_table(study, 'one pair along the path of contact, static; units: s in base pitches from A, '// &
                    'stiffness in N/um over the whole face width (mesh: of the pairs that carry, and of whole gears'' discs), '// &
                    'load_share of the static load, ste: static transmission error in um', columns, lines)
    do i = 1, size(study%sharing)
      associate (sharing => study%sharing(i))
        do j = 1, maxval(sharing%pairs)
          do k = 1, size(sharing%phase)
            if (sharing%pairs(k) >= j) call add_mesh_row(study, i, j, k, lines)
          end do
        end do
      end associate
    end do
  end subroutine mesh_table

  pure subroutine add_mesh_row(study, i, j, k, lines)
    type(study_t), intent(in) :: study
    integer, intent(in) :: i, j, k
    type(lines_t), intent(inout) :: lines
    real(dp) :: s

    associate (sharing => study%sharing(i), mesh => study%motion(i)%mesh)
      s = sharing%s(j, k)
      call lines%cell([micro*study%case%amount(i), s, mesh%stiffness%value(s)/micro, sharing%stiffness(k)/micro, &
                       micro*mesh%profile_error%value(s), sharing%load(j, k)/study%load, micro*sharing%error(k)])
    end associate
    if (study%base_pitch > 0) call lines%cell(milli*s*study%base_pitch)
    if (allocated(study%pair)) call lines%cell(milli*[study%pair%radius(1, s), study%pair%curvature([1, 2], s)])
    call lines%end_row()
  end subroutine add_mesh_row

  !> Harmonics of the static transmission error for each relief; harmonic 0 is the mean.
  pure subroutine harmonics_table(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
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
          call lines%cell(micro*study%case%amount(i))
          call lines%cell(k - 1)
          call lines%cell([micro*amplitude(k), phase(k)*180/pi, micro*ste%error_estimate])
          call lines%end_row()
        end do
      end associate
    end do
  end subroutine harmonics_table

  !> Load of one pair along its path at the speeds `load_rpm` (Dogan et al. 2021, Figs. 5, 6).
  pure subroutine load_table(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    integer :: i, k, row

    call open_table(study, 'dynamic load of one pair along the path of contact; units: s in base pitches from A, '// &
                    'speed of the pinion in 1/min, load in N, dte: dynamic transmission error in um', &
                    'relief_um,rpm,s,pair_load_n,load_ratio,dte_um,status,mesh_periods,pair', lines)
    do k = 1, size(study%response, 2)
      do i = 1, size(study%response, 1)
        associate (response => study%response(i, k), steady => study%response(i, k)%point%steady)
          do row = 1, size(response%s)
            call lines%cell([micro*study%case%amount(i), response%rpm, response%s(row), response%load(row), &
                             response%load(row)/study%load, micro*response%error(row)])
            call lines%cell(status_name(steady%status))
            call lines%cell(steady%periods)
            call lines%cell(response%pair(row))
            call lines%end_row()
          end do
        end associate
      end do
    end do
  end subroutine load_table

  !> One row an operating point. `contact`: full, partial (a pair was apart for
  !> a while), lost (all were), coast (the coast sides touched).
  pure subroutine sweep_table(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    integer :: i, k

    call open_table(study, 'dynamic factor over speed and relief; units: relief in um, speed of the pinion '// &
                    'in 1/min, residual in static deflections', 'relief_um,rpm,dynamic_factor,error_estimate,status,'// &
                    'contact,floquet_modulus,residual,steps,mesh_periods', lines)
    associate (sweep => study%sweep)
      do i = 1, size(sweep%status, 2)
        do k = 1, size(sweep%rpm)
          call lines%cell([micro*study%case%amount(i), sweep%rpm(k), sweep%dynamic_factor(k, i), sweep%estimate(k, i)])
          call lines%cell(status_name(sweep%status(k, i)))
          call lines%cell(trim(contact_names(sweep%contact(k, i))))
          call lines%cell([sweep%multiplier(k, i), sweep%residual(k, i)])
          call lines%cell(sweep%steps(k, i))
          call lines%cell(sweep%periods(k, i))
          call lines%end_row()
        end do
      end do
    end associate
  end subroutine sweep_table

  !> Largest dynamic factor over the speeds against the relief (Dogan et al. 2021, Fig. 8).
  pure subroutine optimum_table(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    integer :: i

    call open_table(study, 'largest dynamic factor over the speeds against the relief; units: relief in um, speed '// &
                    'of the pinion in 1/min', 'relief_um,worst_dynamic_factor,rpm,points_without_answer', lines)
    associate (optimum => study%optimum)
      do i = 1, size(optimum%amount)
        call lines%cell([micro*optimum%amount(i), optimum%dynamic_factor(i), optimum%rpm(i)])
        call lines%cell(optimum%failed(i))
        call lines%end_row()
      end do
    end associate
  end subroutine optimum_table

  !> Outlines of both gears as points, clockwise, centres at the origin.
  pure subroutine outline_table(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    real(dp), allocatable :: points(:, :)
    integer :: i, k

    call open_table(study, 'outline of both gears, each about its own centre; units: mm', 'member,x_mm,y_mm', lines)
    do i = 1, 2
      call shown_contour(study%pair%gear(i), points)
      do k = 1, size(points, 2)
        call lines%cell(study%pair%gear(i)%spec%name)
        call lines%cell(milli*points(:, k))
        call lines%end_row()
      end do
    end do
  end subroutine outline_table

  !> Root stress of one member under the moving load, at the fillet tangent of the case.
  pure subroutine root_table(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    integer :: i, k, side

    call open_table(study, 'stress at the fillet tangent; units: s in base pitches from A, radius of the load in mm, '// &
                    'share of the static load, stress in MPa (x across the tooth to the drive side, y along its axis)', &
                    'relief_um,s,radius_mm,load_share,side,sigma_mpa,sigma_x_mpa,sigma_y_mpa,tau_xy_mpa', lines)
    do i = 1, size(study%root)
      associate (root => study%root(i))
        do k = 1, size(root%s)
          do side = drive, coast
            call lines%cell([micro*study%case%amount(i), root%s(k), milli*root%radius(k), root%share(k)])
            call lines%cell(merge('drive', 'coast', side == drive))
            call lines%cell(mega*[root%along(side, k), root%components(:, side, k)])
            call lines%end_row()
          end do
        end do
      end associate
    end do
  end subroutine root_table

  !> Natural frequencies of the section.
  pure subroutine mode_table(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    integer :: i

    call open_table(study, 'natural frequencies of the section; units: Hz, relative error estimate, residual of the '// &
                    'eigenvalue problem, share of the rim in the kinetic energy', &
                    'mode,frequency_hz,error_estimate,residual,rim_share', lines)
    associate (modes => study%modal%modes)
      do i = 1, size(modes%frequency)
        call lines%cell(i)
        call lines%cell([modes%frequency(i), study%modal%error_estimate(i), modes%residual(i), modes%participation(0, i)])
        call lines%end_row()
      end do
    end associate
  end subroutine mode_table

  !> Printed values beside ours; NaN where the tasks do not compute it.
  pure subroutine published_table(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    real(dp) :: value
    logical :: known
    integer :: i

    call open_table(study, 'printed values and ours; deviation relative to the printed value', &
                    'quantity,place,printed,ours,deviation,unit,status,reason', lines)
    do i = 1, size(study%published)
      associate (row => study%published(i))
        call our_value(study, row%quantity, value, known)
        call lines%cell(row%quantity)
        call lines%text_cell(row%place)
        call lines%cell(row%printed)
        if (known) call lines%cell([value, value/row%printed - 1])
        if (.not. known) call lines%cell('NaN,NaN')
        call lines%text_cell(row%unit)
        call lines%cell(row%status)
        call lines%text_cell(row%reason)
        call lines%end_row()
      end associate
    end do
  end subroutine published_table
end module gearsweep_tables
