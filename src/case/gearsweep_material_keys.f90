!> What a case says of materials: &material for both gears, and the same keys of &pinion and &gear for one of them.
module gearsweep_material_keys
  use gearsweep_case, only: case_t
  use gearsweep_error, only: error_t
  use gearsweep_kinds, only: dp
  use gearsweep_material, only: material_t
  use gearsweep_reader, only: reader_t
  use gearsweep_task, only: stage
  use gearsweep_uses, only: first_of, needs_gears, sentence_length, unless
  implicit none
  private
  public :: read_materials

  integer, parameter :: young = 1, poisson = 2, density = 3
  !> Values that no material has: none is given.
  type(material_t), parameter :: not_given = material_t(0.0_dp, -1.0_dp, 0.0_dp)

contains

  !> After the section, which names a gear, and the gears, whose masses decide about the density.
  subroutine read_materials(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(sentence_length), parameter :: users(*) = [character(sentence_length) :: &
      'modal, deflection_relief, as_built, precision, flank, rating, transient, harmonic, body_modes or a stiffness that is '// &
      'computed', &
      'static, modal, deflection_relief, as_built, precision, flank, rating, transient, harmonic, body_modes or a stiffness '// &
      'that depends on it', &
      'modal, precision, flank, transient, harmonic, body_modes or a mass that is not stated']
    logical :: counts(3, 2), own(3, 2)
    character(sentence_length) :: geared, lacks(3)
    type(material_t) :: common
    integer :: i

    if (allocated(error)) return
    geared = unless(.not. case%prescribed, needs_gears)
    do i = 1, 2
      counts(:, i) = uses_of(case, i)
      lacks = ''
      where (.not. counts(:, i)) lacks = 'a stiffness or mass that depends on it, or a task that takes this gear (&section member)'
      case%material(i) = not_given
      call read_group(reader, trim(case%spec(i)%name), lacks, geared, case%material(i), error)
      own(:, i) = [case%material(i)%young > 0, case%material(i)%poisson >= 0, case%material(i)%density > 0]
    end do
    do i = 1, 3
      lacks(i) = first_of(unless(any(counts(i, :)), users(i)), &
                          unless(any(counts(i, :) .and. .not. own(i, :)), 'a gear without its own'))
    end do
    call read_group(reader, 'material', lacks, geared, common, error)
    do i = 1, 2
      if (.not. own(young, i)) case%material(i)%young = common%young
      if (.not. own(poisson, i)) case%material(i)%poisson = common%poisson
      if (.not. own(density, i)) case%material(i)%density = common%density
    end do
  end subroutine read_materials

  !> Does a result depend on the gear's modulus, Poisson's ratio and density?
  pure function uses_of(case, member) result(uses)
    type(case_t), intent(in) :: case
    integer, intent(in) :: member
    logical :: uses(3), deflects, vibrates, touches

    deflects = case%needs(stage%mesh) .and. case%models_teeth()
    ! Printed values may be a tooth's as a beam.
    vibrates = case%asks('modal') .or. case%asks('precision') .or. case%asks('transient') .or. &
               case%asks('harmonic') .or. case%needs(stage%solid) .or. allocated(case%published)
    vibrates = vibrates .and. member == case%member
    touches = case%needs(stage%elasticity)
    uses(young) = deflects .or. vibrates .or. touches
    uses(poisson) = (deflects .and. case%model /= 'iso6336') .or. touches .or. &
                    ((case%needs(stage%body) .or. case%needs(stage%solid)) .and. member == case%member)
    uses(density) = case%weighs(member) .or. vibrates .or. case%needs(stage%density)
  end function uses_of

  !> The keys of one group; for a single gear without defaults.
  subroutine read_group(reader, group, lacks, geared, material, error)
    type(reader_t), intent(inout) :: reader
    character(*), intent(in) :: group, lacks(:), geared
    type(material_t), intent(inout) :: material
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: common          !< not allocated: not said

    if (group /= 'material') common = 'that of &material'
    call reader%get(group, 'young_gpa', material%young, error, unit='GPa', at_least=1e-3_dp, at_most=1e4_dp, &
                    lacks=lacks(young), refused=geared, otherwise=common, &
                    meaning='Young''s modulus, for a stiffness that is computed, natural modes and contact pressure; root '// &
                    'stress depends on it only in how pairs share the load')
    call reader%get(group, 'poisson', material%poisson, error, at_least=0.0_dp, below=0.5_dp, lacks=lacks(poisson), &
                    refused=geared, otherwise=common, &
                    meaning='Poisson''s ratio, for a stiffness by fe or weber, root stress, natural modes and contact pressure')
    call reader%get(group, 'density_kgm3', material%density, error, unit='kg/m^3', at_least=1.0_dp, at_most=1e5_dp, &
                    lacks=lacks(density), refused=geared, otherwise=common, &
                    meaning='density, for natural modes, flash temperature and gears with neither mass nor inertia given')
  end subroutine read_group
end module gearsweep_material_keys
