!> All numbers of a study as one list, in the units of the tables; each array by its name, such as
!> `sweep.dynamic_factor`, and with its shape.
module gearsweep_numbers
  use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_decimal, only: in_um
  use gearsweep_error, only: error_t
  use gearsweep_kinds, only: dp, pi
  use gearsweep_lines, only: lines_t
  use gearsweep_memory, only: claim_memory
  use gearsweep_section, only: section_t
  use gearsweep_study, only: study_t
  use gearsweep_text, only: str
  implicit none
  private
  public :: numbers_t, list_numbers

  type :: numbers_t
    type(lines_t) :: names                       !< for each array a line: its name, then its shape
    real(dp), allocatable :: values(:)           !< of all arrays, one after the other, and room for more
    integer :: used = 0
  contains
    procedure, private :: add
  end type numbers_t

  real(dp), parameter :: micro = 1e6_dp, milli = 1e3_dp, mega = 1e-6_dp, degree = pi/180

contains

  subroutine list_numbers(study, numbers, error)
    type(study_t), intent(in) :: study
    type(numbers_t), intent(out) :: numbers
    type(error_t), allocatable, intent(out) :: error

    ! In room that doubles and is copied, and each array once more as it is made.
    call claim_memory(40*(1000 + count_numbers(study)), '&case tasks: the list of all numbers', error)
    if (allocated(error)) return
    allocate (numbers%values(1000))
    if (allocated(study%motion)) call list_motion(study, numbers)
    if (allocated(study%sharing)) call list_mesh(study, numbers)
    if (allocated(study%harmonics)) call list_harmonics(study, numbers)
    if (allocated(study%root)) call list_root(study, numbers)
    if (allocated(study%section)) call list_section('section', study%section, numbers)
    if (allocated(study%modal)) call list_modes(study, numbers)
    if (allocated(study%response)) call list_load(study, numbers)
    if (allocated(study%sweep)) call list_sweep(study, numbers)
    if (allocated(study%optimum)) call list_optimum(study, numbers)
  end subroutine list_numbers

  !> How many numbers there are, at least where they are many.
  pure real(dp) function count_numbers(study) result(n)
    type(study_t), intent(in) :: study
    integer :: i, k

    n = 0
    if (allocated(study%sharing)) n = n + 7.0_dp*sum([(sum(study%sharing(i)%pairs), i=1, size(study%sharing))])
    if (allocated(study%harmonics)) n = n + size(study%harmonics)*(2.0_dp*study%case%harmonics + 6)
    if (allocated(study%root)) n = n + size(study%root)*(12.0_dp*size(study%root(1)%s) + 8)
    if (allocated(study%section)) n = n + section_numbers(study%section)
    if (allocated(study%modal)) n = n + section_numbers(study%modal%section) + size(study%modal%modes%shape, kind=int64)
    if (allocated(study%sweep)) n = n + 9.0_dp*size(study%sweep%status)
    if (.not. allocated(study%response)) return
    do k = 1, size(study%response, 2)
      do i = 1, size(study%response, 1)
        n = n + 8.0_dp*size(study%response(i, k)%s)
      end do
    end do
  end function count_numbers

  pure real(dp) function section_numbers(section)
    type(section_t), intent(in) :: section

    section_numbers = 2.0_dp*size(section%grid%x, 2) + 9.0_dp*size(section%grid%part)
  end function section_numbers

  subroutine add(self, name, values, shape)
    class(numbers_t), intent(inout) :: self
    character(*), intent(in) :: name
    real(dp), intent(in) :: values(:)
    integer, intent(in) :: shape(:)
    real(dp), allocatable :: larger(:)
    integer :: i, needed

    call self%names%put(name)
    do i = 1, size(shape)
      call self%names%put(' '//str(shape(i)))
    end do
    call self%names%add('')
    needed = self%used + size(values)
    if (needed > size(self%values)) then
      allocate (larger(2*needed))
      larger(:self%used) = self%values(:self%used)
      call move_alloc(larger, self%values)
    end if
    self%values(self%used + 1:needed) = values
    self%used = needed
  end subroutine add

  subroutine list_motion(study, numbers)
    type(study_t), intent(in) :: study
    type(numbers_t), intent(inout) :: numbers

    call numbers%add('motion.load_n', [study%load], [integer ::])
    call numbers%add('motion.mass_kg', study%mass, [2])
    call numbers%add('motion.stiffness_n_um', [study%mesh%mean_stiffness()/1e6_dp], [integer ::])
    call numbers%add('motion.frequency_hz', [study%motion(1)%natural_frequency/(2*pi)], [integer ::])
    call numbers%add('motion.turn_um', [micro*study%load*study%mesh%disc%turn], [integer ::])
    call numbers%add('motion.shared_um', [micro*study%load*study%mesh%disc%shared], [integer ::])
  end subroutine list_motion

  subroutine list_mesh(study, numbers)
    type(study_t), intent(in) :: study
    type(numbers_t), intent(inout) :: numbers
    real(dp), allocatable :: rows(:, :)
    character(*), parameter :: names(7) = &
      [character(10) :: 'relief_um', 's', 'pair_n_um', 'mesh_n_um', 'error_um', 'share', 'ste_um']
    integer :: i, j, k, n

    allocate (rows(sum([(sum(study%sharing(i)%pairs), i=1, size(study%sharing))]), size(names)))
    n = 0
    do i = 1, size(study%sharing)
      associate (sharing => study%sharing(i), mesh => study%motion(i)%mesh)
        do j = 1, maxval(sharing%pairs)
          do k = 1, size(sharing%phase)
            if (sharing%pairs(k) < j) cycle
            n = n + 1
            rows(n, :) = [in_um(study%case%amount(i)), sharing%s(j, k), mesh%stiffness%value(sharing%s(j, k))/1e6_dp, &
                          sharing%stiffness(k)/1e6_dp, micro*mesh%profile_error%value(sharing%s(j, k)), &
                          sharing%load(j, k)/study%load, micro*sharing%error(k)]
          end do
        end do
      end associate
    end do
    do k = 1, size(names)
      call numbers%add('mesh.'//trim(names(k)), rows(:, k), [n])
    end do
  end subroutine list_mesh

  subroutine list_harmonics(study, numbers)
    type(study_t), intent(in) :: study
    type(numbers_t), intent(inout) :: numbers
    integer :: i, n, m

    n = study%case%harmonics
    associate (ste => study%harmonics)
      m = size(ste)
      call numbers%add('harmonics.harmonic', [(real(i, dp), i=1, n)], [n])
      call numbers%add('harmonics.relief_um', in_um(study%case%amount), [m])
      call numbers%add('harmonics.mean_um', micro*ste%mean, [m])
      call numbers%add('harmonics.rms_um', micro*ste%rms, [m])
      call numbers%add('harmonics.peak_to_peak_um', [(micro*ste(i)%peak_to_peak(), i=1, m)], [m])
      call numbers%add('harmonics.amplitude_um', [(micro*ste(i)%amplitude, i=1, m)], [n, m])
      call numbers%add('harmonics.phase_deg', [(ste(i)%phase*180/pi, i=1, m)], [n, m])
      call numbers%add('harmonics.estimate_um', micro*ste%error_estimate, [m])
    end associate
  end subroutine list_harmonics

  subroutine list_root(study, numbers)
    type(study_t), intent(in) :: study
    type(numbers_t), intent(inout) :: numbers
    integer :: i, n, m

    associate (root => study%root, one => study%root(1))
      m = size(root)
      n = size(one%s)
      call numbers%add('static.relief_um', in_um(study%case%amount), [m])
      call numbers%add('static.s', one%s, [n])
      call numbers%add('static.radius_mm', milli*one%radius, [n])
      call numbers%add('static.share', [(root(i)%share, i=1, m)], [n, m])
      call numbers%add('static.sigma_mpa', [(mega*root(i)%along, i=1, m)], [2, n, m])
      call numbers%add('static.parts_mpa', [(mega*root(i)%components, i=1, m)], [3, 2, n, m])
      call numbers%add('static.tension_mpa', mega*root%stress%tension%stress, [m])
      call numbers%add('static.tension_deg', root%stress%tension%tangent/degree, [m])
      call numbers%add('static.compression_mpa', mega*root%stress%compression%stress, [m])
      call numbers%add('static.compression_deg', root%stress%compression%tangent/degree, [m])
      call numbers%add('static.estimate', [root%stress%error_estimate], [m])
      call numbers%add('static.iso_mpa', [one%iso_stress/1e6_dp], [integer ::])
      call numbers%add('static.lewis_mpa', [one%lewis_stress/1e6_dp], [integer ::])
    end associate
  end subroutine list_root

  !> Nodes of elements are counted from 1.
  subroutine list_section(task, section, numbers)
    character(*), intent(in) :: task
    type(section_t), intent(in) :: section
    type(numbers_t), intent(inout) :: numbers

    associate (grid => section%grid)
      call numbers%add(task//'.x_mm', milli*grid%x(1, :), [size(grid%x, 2)])
      call numbers%add(task//'.y_mm', milli*grid%x(2, :), [size(grid%x, 2)])
      call numbers%add(task//'.element', [real(grid%element, dp)], shape(grid%element))
      call numbers%add(task//'.tooth', real(grid%part, dp), shape(grid%part))
    end associate
  end subroutine list_section

  subroutine list_modes(study, numbers)
    type(study_t), intent(in) :: study
    type(numbers_t), intent(inout) :: numbers

    call list_section('modal', study%modal%section, numbers)
    associate (modes => study%modal%modes, n => size(study%modal%modes%frequency))
      call numbers%add('modal.frequency_hz', modes%frequency, [n])
      call numbers%add('modal.estimate', study%modal%error_estimate, [n])
      call numbers%add('modal.residual', modes%residual, [n])
      call numbers%add('modal.rim_share', modes%participation(0, :), [n])
      call numbers%add('modal.shape', [modes%shape], shape(modes%shape))
    end associate
  end subroutine list_modes

  subroutine list_load(study, numbers)
    type(study_t), intent(in) :: study
    type(numbers_t), intent(inout) :: numbers
    real(dp), allocatable :: relief(:), rpm(:), s(:), load(:), error(:), status(:), periods(:), pair(:)
    integer :: i, k

    relief = [real(dp) ::]
    status = relief
    periods = relief
    pair = relief
    rpm = relief
    s = relief
    load = relief
    error = relief
    do k = 1, size(study%response, 2)
      do i = 1, size(study%response, 1)
        associate (one => study%response(i, k))
          relief = [relief, spread(in_um(study%case%amount(i)), 1, size(one%s))]
          rpm = [rpm, spread(one%rpm, 1, size(one%s))]
          s = [s, one%s]
          load = [load, one%load]
          error = [error, micro*one%error]
          status = [status, spread(real(one%point%steady%status, dp), 1, size(one%s))]
          periods = [periods, spread(real(one%point%steady%periods, dp), 1, size(one%s))]
          pair = [pair, real(one%pair, dp)]
        end associate
      end do
    end do
    call numbers%add('load.relief_um', relief, shape(relief))
    call numbers%add('load.rpm', rpm, shape(rpm))
    call numbers%add('load.s', s, shape(s))
    call numbers%add('load.pair_load_n', load, shape(load))
    call numbers%add('load.dte_um', error, shape(error))
    call numbers%add('load.status', status, shape(status))
    call numbers%add('load.periods', periods, shape(periods))
    call numbers%add('load.pair', pair, shape(pair))
  end subroutine list_load

  subroutine list_sweep(study, numbers)
    type(study_t), intent(in) :: study
    type(numbers_t), intent(inout) :: numbers

    associate (sweep => study%sweep, every => shape(study%sweep%status))
      call numbers%add('sweep.rpm', sweep%rpm, shape(sweep%rpm))
      call numbers%add('sweep.relief_um', in_um(study%case%amount), shape(study%case%amount))
      call numbers%add('sweep.dynamic_factor', [sweep%dynamic_factor], every)
      call numbers%add('sweep.estimate', [sweep%estimate], every)
      call numbers%add('sweep.status', [real(sweep%status, dp)], every)
      call numbers%add('sweep.contact', [real(sweep%contact, dp)], every)
      call numbers%add('sweep.floquet_modulus', [sweep%multiplier], every)
      call numbers%add('sweep.residual', [sweep%residual], every)
      call numbers%add('sweep.steps', [real(sweep%steps, dp)], every)
      call numbers%add('sweep.periods', [real(sweep%periods, dp)], every)
    end associate
  end subroutine list_sweep

  subroutine list_optimum(study, numbers)
    type(study_t), intent(in) :: study
    type(numbers_t), intent(inout) :: numbers
    real(dp) :: best(3)

    associate (optimum => study%optimum, n => shape(study%optimum%amount))
      best = ieee_value(best, ieee_quiet_nan)
      if (optimum%best > 0) best = [in_um(optimum%amount(optimum%best)), optimum%dynamic_factor(optimum%best), &
                                    optimum%rpm(optimum%best)]
      call numbers%add('optimum.relief_um', in_um(optimum%amount), n)
      call numbers%add('optimum.worst_factor', optimum%dynamic_factor, n)
      call numbers%add('optimum.rpm', optimum%rpm, n)
      call numbers%add('optimum.failed', real(optimum%failed, dp), n)
      call numbers%add('optimum.best_um', best(1:1), [integer ::])
      call numbers%add('optimum.best_factor', best(2:2), [integer ::])
      call numbers%add('optimum.best_rpm', best(3:3), [integer ::])
      call numbers%add('optimum.within_um', [micro*optimum%resolution], [integer ::])
    end associate
  end subroutine list_optimum
end module gearsweep_numbers
