!> What a case says of the mesh: &mesh, &load and &relief.
module gearsweep_mesh_keys
  use gearsweep_kinds, only: dp, pi
  use gearsweep_case, only: case_t
  use gearsweep_error, only: code_input, error_t, fail
  use gearsweep_reader, only: reader_t
  use gearsweep_relief, only: linear, parabolic
  use gearsweep_root_rating, only: shared_by_mesh
  use gearsweep_uses, only: first_of, for_tasks, unless, with_load, with_motion
  implicit none
  private
  public :: read_model, read_load, read_relief, read_path

contains

  !> The stiffness; first, as it decides whether there is a geometry.
  subroutine read_model(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(*), parameter :: models(*) = [character(10) :: 'polynomial', 'table', 'fe', 'weber', 'iso6336']
    logical :: open

    case%prescribed = reader%has('mesh', 'contact_ratio')
    call reader%get('mesh', 'contact_ratio', case%contact_ratio, error, above=1.0_dp, at_most=20.0_dp)
    if (case%prescribed .and. case%asks_any('geometry, section, static, modal')) call fail(error, code_input, &
      '&case tasks: geometry, section, static and modal need a gear; a prescribed mesh (&mesh contact_ratio) has none')
    case%model = 'weber'
    if (case%prescribed) case%model = ''
    if (case%prescribed) then
      call reader%get('mesh', 'model', case%model, error, required=.true., allowed=models(:2))
    else
      call reader%get('mesh', 'model', case%model, error, waits=for_tasks(case, with_load), allowed=models([3, 4, 5, 1, 2]))
    end if
    if (allocated(error)) return
    ! What belongs to a missing model is no error of its own.
    open = len(case%model) == 0
    call reader%get('mesh', 'coefficients', case%coefficients, error, required=.not. open, &
                    at_least=-1e12_dp, at_most=1e12_dp, scale=1e6_dp, max_size=20, waits=for_tasks(case, with_load), &
                    refused=unless(open .or. case%model == 'polynomial', 'needs model = ''polynomial'''))
    call reader%get('mesh', 'file', case%file, error, required=.not. open, waits=for_tasks(case, with_load), &
                    refused=unless(open .or. case%model == 'table', 'needs model = ''table'''))
  end subroutine read_model

  !> Exactly one of the three.
  subroutine read_load(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error

    call reader%get('load', 'torque_nm', case%torque, error, waits=for_tasks(case, with_load), &
                    at_least=1e-12_dp, at_most=1e12_dp)
    call reader%get('load', 'normal_force_n', case%normal_force, error, waits=for_tasks(case, with_load), &
                    at_least=1e-12_dp, at_most=1e12_dp)
    call reader%get('load', 'line_load_n_mm', case%line_load, error, waits=for_tasks(case, with_load), &
                    at_least=1e-12_dp, at_most=1e7_dp, scale=1e3_dp)
  end subroutine read_load

  !> After the root stress, whose load need not be shared by the mesh.
  subroutine read_relief(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: shape
    character(120) :: waits
    logical :: has_length, has_roll(2)

    waits = for_tasks(case, with_load)
    if (case%root%sharing /= shared_by_mesh) waits = for_tasks(case, 'mesh, load, sweep or optimum')
    allocate (case%amount(1), source=0.0_dp)
    call reader%get('relief', 'amount_um', case%amount, error, required=reader%has_group('relief'), waits=waits, &
                    at_least=0.0_dp, at_most=1e9_dp, scale=1e-6_dp, max_size=10000)
    ! Nothing that is wanted differs between the reliefs.
    if (len_trim(waits) > 0) case%amount = [0.0_dp]
    waits = first_of(waits, unless(any(case%amount > 0) .or. case%asks('optimum'), 'optimum or an amount above 0'))
    call reader%get('relief', 'pinion_fraction', case%fraction(1), error, waits=waits, at_least=0.0_dp, at_most=1000.0_dp)
    call reader%get('relief', 'gear_fraction', case%fraction(2), error, waits=waits, at_least=0.0_dp, at_most=1000.0_dp)
    shape = 'linear'
    call reader%get('relief', 'shape', shape, error, waits=waits, allowed=[character(9) :: 'linear', 'parabolic'])
    case%shape = merge(parabolic, linear, shape == 'parabolic')
    call reader%get('relief', 'length_mm', case%length, error, given=has_length, waits=waits, &
                    at_least=1e-6_dp, at_most=1e6_dp, scale=1e-3_dp)
    call reader%get('relief', 'pinion_roll_deg', case%roll(1), error, given=has_roll(1), waits=waits, above=0.0_dp, scale=pi/180)
    call reader%get('relief', 'gear_roll_deg', case%roll(2), error, given=has_roll(2), waits=waits, above=0.0_dp, scale=pi/180)
    case%start = 'hpstc'
    if (has_length) case%start = 'length'
    if (any(has_roll)) case%start = 'roll'
    call reader%get('relief', 'start', case%start, error, waits=waits, &
                    allowed=[character(6) :: 'hpstc', 'pitch', 'length', 'roll'])
  end subroutine read_relief

  !> What else a prescribed mesh needs to be told, and the harmonics: last, as it depends on the rest.
  subroutine read_path(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(*), parameter :: by_hand = 'needs a prescribed mesh (&mesh contact_ratio)'
    character(120) :: made, waits
    logical :: relieves

    made = unless(case%prescribed, by_hand)
    relieves = any(case%amount > 0) .or. case%asks('optimum')
    waits = ''
    if (.not. (case%torque > 0 .or. any(case%inertia > 0) .or. (relieves .and. case%length > 0))) waits = for_tasks(case, 'mesh')
    call reader%get('mesh', 'base_pitch_mm', case%base_pitch, error, at_least=1e-6_dp, at_most=1e6_dp, scale=1e-3_dp, &
                    waits=waits, refused=made)
    waits = ''
    if (.not. (relieves .and. case%start == 'pitch')) waits = for_tasks(case, with_motion)
    if (.not. (relieves .or. case%friction > 0)) waits = 'optimum or an amount above 0'
    call reader%get('mesh', 'pitch_point', case%pitch_point, error, at_least=0.0_dp, waits=waits, &
                    refused=first_of(made, unless(case%friction > 0 .or. case%start == 'pitch', &
                    'a prescribed mesh uses it with friction or start = ''pitch'' only; remove it')))
    call reader%get('mesh', 'ste_harmonics', case%harmonics, error, waits=for_tasks(case, 'mesh'), at_least=1, at_most=1000)
  end subroutine read_path
end module gearsweep_mesh_keys
