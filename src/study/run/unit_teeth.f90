!> Common parts of the tasks `transient` and `harmonic`: a loaded tooth in its modes on two grids, and the keys for the modes, their
!> damping and the points of the fillets.
module gearsweep_study_run_unit_teeth
  use gearsweep_base, only: dp, error_t, pi
  use gearsweep_elastic, only: find_tooth_modes, tooth_modes_t
  use gearsweep_rating, only: damp_modes, damping_t
  use gearsweep_study_reader_reader, only: first_nonblank, reader_t, sentence_length, text_unless
  use gearsweep_study_run_stages, only: stages_t
  implicit none
  private
  public :: tooth_choice_t, find_unit_teeth

  type :: tooth_choice_t
    integer :: modes = 20
    type(damping_t) :: damping
    real(dp), allocatable :: tangent(:)          !< fillet tangent angles of the points, rad
  contains
    procedure :: read_keys
  end type tooth_choice_t

contains

  !> Reads the keys. `group`: that of the task, with the same name. `geared`: reason why they are refused.
  subroutine read_keys(self, reader, group, geared, error)
    class(tooth_choice_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    character(*), intent(in) :: group, geared
    type(error_t), allocatable, intent(inout) :: error
    character(sentence_length) :: by_ratio
    logical :: has_alpha, has_beta

    call reader%get(group, 'modes', self%modes, error, at_least=1, at_most=1000, tasks=group, not_allowed=geared, &
                    meaning='natural modes of the section that move, from the lowest')
    call reader%get(group, 'rayleigh_alpha_1_s', self%damping%alpha, error, unit='1/s', is_stated=has_alpha, tasks=group, &
                    not_allowed=geared, at_least=-1e9_dp, at_most=1e9_dp, default_note='none, or 0 with rayleigh_beta_s', &
                    meaning='alpha of damping by Rayleigh: mass times alpha plus stiffness times beta')
    call reader%get(group, 'rayleigh_beta_s', self%damping%beta, error, unit='s', is_stated=has_beta, tasks=group, &
                    not_allowed=geared, at_least=0.0_dp, at_most=1.0_dp, default_note='none, or 0 with rayleigh_alpha_1_s', &
                    meaning='beta of damping by Rayleigh')
    self%damping%is_rayleigh = has_alpha .or. has_beta
    by_ratio = first_nonblank(geared, text_unless(.not. self%damping%is_rayleigh, &
                              'damping by Rayleigh is given; remove one of the two'))
    ! The resonances of an undamped mode are unbounded, but its response to a passing load is not.
    call reader%get(group, 'damping_ratio', self%damping%ratio, error, at_least=merge(1e-6_dp, 0.0_dp, group == 'harmonic'), &
                    at_most=1e3_dp, tasks=group, &
                    not_allowed=by_ratio, meaning='damping ratio of every mode')
    allocate (self%tangent, source=[pi/6])
    call reader%get(group, 'tangent_deg', self%tangent, error, unit='deg', above=0.0_dp, below=90.0_dp, min_size=1, &
                    max_size=20, tasks=group, not_allowed=geared, &
                    meaning='points of the fillets that the tables show, by the angle between the tangent there and the axis '// &
                    'of the tooth; they must lie on the fillet')
  end subroutine read_keys

  !> Builds the tooth on both grids, the finer first, with loads at given radii (m). `group`: for messages.
  subroutine find_unit_teeth(stages, choice, group, radius, teeth, error)
    type(stages_t), intent(in) :: stages
    type(tooth_choice_t), intent(in) :: choice
    character(*), intent(in) :: group
    real(dp), intent(in) :: radius(:)
    type(tooth_modes_t), intent(out) :: teeth(2)
    type(error_t), allocatable, intent(inout) :: error
    integer :: i, n
    character(*), parameter :: quantity(2) = [character(27) :: 'tangent at the fillet (deg)', 'number of modes']
    character(*), parameter :: key(2) = [character(11) :: 'tangent_deg', 'modes']

    call stages%running%need_modes(stages%body_inputs, choice%modes, error)
    if (.not. allocated(error)) then
      associate (running => stages%running)
        call find_tooth_modes(running%bodies(1), running%modal%modes, radius, choice%tangent, teeth(1), error)
        call find_tooth_modes(running%bodies(2), running%modal%coarse, radius, choice%tangent, teeth(2), error)
      end associate
      do i = 1, 2
        call damp_modes(choice%damping, teeth(i), '&'//group//' rayleigh_alpha_1_s', error)
      end do
    end if
    if (allocated(error)) then
      do i = 1, size(key)
        n = len_trim(quantity(i))
        if (index(error%message, quantity(i)(:n)) == 1) error%message = '&'//group//' '//trim(key(i))//error%message(n + 1:)
      end do
    end if
  end subroutine find_unit_teeth
end module gearsweep_study_run_unit_teeth
