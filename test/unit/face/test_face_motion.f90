!> Motion of gears whose faces meet unevenly: several springs a pair against the load distribution solved at each deflection,
!> against an independent program, and against parallel faces.
module test_face_motion
  use gearsweep_base_error, only: error_t
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_base_text, only: str
  use gearsweep_face_alignment, only: alignment_t, lead_t
  use gearsweep_face_load, only: face_mesh_t, find_pair_loads, pair_loads_t
  use gearsweep_face_springs, only: chord_loads, find_chords, springs_of_pair
  use gearsweep_motion_error_estimate, only: accuracy_t, point_t
  use gearsweep_motion_oscillator, only: mesh_period, oscillator_t
  use test_support_ask_by_name, only: answer_t, ask, refusal
  use test_support_faces, only: make_faces
  use test_support_solve_one_point, only: solve
  use test_support_springs_in_motion, only: add_up, march, set_in_motion, steps, table_t, tabulate_springs
  use test_support_testing, only: tally_t, check_true, check_close, check_no_error
  implicit none
  private
  public :: run

  real(dp), parameter :: load = 1e3_dp           ! N, 100 N/mm

  !> Cases of an independent program: 25/25 teeth of 1 mm, face width 10 mm, 100 N/mm, damping ratio 0.07.
  type :: given_t
    character(24) :: name
    real(dp) :: helix_angle                      !< deg
    real(dp) :: misalignment, crowning           !< um
    !> Largest force of the mesh over the load, mesh frequency 0.2 to 1.3 of the natural one: with the load distribution solved at
    !> each moment, and with five springs a pair.
    real(dp) :: smooth, springs
    real(dp) :: apart                            !< largest difference of both at any speed; 0: not known
  end type given_t

  type(given_t), parameter :: given(5) = [ &
    given_t('parallel', 0.0_dp, 0.0_dp, 0.0_dp, 3.62_dp, 3.61_dp, 0.0_dp), &
    given_t('misaligned by 5 um', 0.0_dp, 5.0_dp, 0.0_dp, 3.96_dp, 3.94_dp, 0.05_dp), &
    given_t('misaligned by 15 um', 0.0_dp, 15.0_dp, 0.0_dp, 4.44_dp, 4.28_dp, 0.21_dp), &
    given_t('crowned by 5 um', 0.0_dp, 0.0_dp, 5.0_dp, 3.87_dp, 3.85_dp, 0.09_dp), &
    given_t('helical, misaligned', 20.0_dp, 15.0_dp, 0.0_dp, 1.84_dp, 1.83_dp, 0.0_dp)]

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('chords')) call chords(t)
    if (t%wants('independent')) call independent(t)
    if (t%wants('parallel_limit')) call parallel_limit(t)
    if (t%wants('contacts')) call contacts(t)
    if (t%wants('refused')) call refused(t)
  end subroutine run

  !> Face of a given case.
  subroutine make(t, of, mesh, alignment)
    type(tally_t), intent(inout) :: t
    type(given_t), intent(in) :: of
    type(face_mesh_t), intent(out) :: mesh
    type(alignment_t), intent(out) :: alignment

    call make_faces(t, [25, 25], [0.0_dp, 0.0_dp], 1.0_dp, 10.0_dp, mesh, helix_angle=of%helix_angle)
    alignment%misalignment = of%misalignment*1e-6_dp
    alignment%lead(1) = lead_t(crowning=of%crowning*1e-6_dp)
  end subroutine make

  !> Oscillator with several springs a pair.
  subroutine make_motion(t, mesh, alignment, osc)
    type(tally_t), intent(inout) :: t
    type(face_mesh_t), intent(in) :: mesh
    type(alignment_t), intent(in) :: alignment
    type(oscillator_t), intent(out) :: osc
    type(pair_loads_t) :: loads
    type(error_t), allocatable :: error

    call find_pair_loads(mesh, alignment, load, load*chord_loads, loads, error)
    call check_no_error(t, 'loads', error)
    associate (own => osc%mesh)
      own%contact_ratio = mesh%pair%contact_ratio + mesh%pair%overlap_ratio
      own%spacing = ceiling(own%contact_ratio)
      own%reach = [-real((springs_of_pair - 1)*own%spacing, dp), own%contact_ratio]
      call find_chords(loads, own%contact_ratio, own%spacing, own%stiffness, own%profile_error)
    end associate
    call set_in_motion(t, load, osc)
  end subroutine make_motion

  !> Tabulates the loads of the pairs over the deflection at the half steps of a mesh period. They follow from the load distribution
  !> under 28 loads, from 0.01 to 5 times the static one, interpolated linearly between its phases.
  subroutine tabulate(t, mesh, alignment, table)
    type(tally_t), intent(inout) :: t
    type(face_mesh_t), intent(in) :: mesh
    type(alignment_t), intent(in) :: alignment
    type(table_t), intent(out) :: table
    integer, parameter :: levels = 28
    type(pair_loads_t) :: loads
    type(error_t), allocatable :: error
    real(dp) :: phase, part
    integer :: i, k

    call find_pair_loads(mesh, alignment, load, load*[(0.01_dp*1.26_dp**k, k=0, levels - 1)], loads, error)
    call check_no_error(t, 'loads', error)
    allocate (table%deflection(0:levels, 0:2*steps), table%force(0:levels, size(loads%touching, 1), 0:2*steps), source=0.0_dp)
    do k = 0, 2*steps
      phase = k/(2.0_dp*steps)
      i = min(count(loads%phase <= phase), size(loads%phase) - 1)
      part = (phase - loads%phase(i))/(loads%phase(i + 1) - loads%phase(i))
      table%deflection(1:, k) = (1 - part)*loads%deflection(:, i) + part*loads%deflection(:, i + 1)
      table%deflection(0, k) = minval((1 - part)*loads%touching(:, i) + part*loads%touching(:, i + 1))
      table%force(1:, :, k) = (1 - part)*loads%load(:, :, i) + part*loads%load(:, :, i + 1)
    end do
  end subroutine tabulate

  !> The springs of a pair follow its load over the deflection up to 2.8 times the static load, as closely as chords of a load that
  !> grows with the square of the deflection, the largest power of a misaligned face: the widest, from 1.6 to 2.8, is off by
  !> (sqrt(2.8) - sqrt(1.6))**2/4 of the static load. At that load, where the chords end, they are exact at each place at which the
  !> load distribution is solved.
  subroutine chords(t)
    type(tally_t), intent(inout) :: t
    type(face_mesh_t) :: mesh
    type(alignment_t) :: alignment
    type(oscillator_t) :: osc
    type(table_t) :: table
    type(pair_loads_t) :: loads
    type(error_t), allocatable :: error
    real(dp), allocatable :: springs(:)
    real(dp) :: worst, slope
    integer :: at, i, k, row

    do i = 1, size(given)
      call make(t, given(i), mesh, alignment)
      call make_motion(t, mesh, alignment, osc)
      call tabulate(t, mesh, alignment, table)
      worst = 0
      allocate (springs(size(table%force, 2)))
      do at = 1, 2*steps - 1, 7
        do k = 1, ubound(table%force, 1)
          associate (force => table%force(k, :, at))
            if (sum(force) > 2.8_dp*load) exit
            call add_up(osc, at/(2.0_dp*steps), table%deflection(k, at), springs, slope)
            worst = max(worst, maxval(abs(springs - force))/load)
          end associate
        end do
      end do
      call check_true(t, trim(given(i)%name)//': between the ends of chords', &
                      worst < (sqrt(2.8_dp) - sqrt(1.6_dp))**2/4, str(worst))
      call find_pair_loads(mesh, alignment, load, load*chord_loads, loads, error)
      call check_no_error(t, 'loads', error)
      worst = 0
      associate (last => size(chord_loads))
        do row = 2, size(loads%phase) - 1
          ! Where pairs enter or leave, loads jump: there the distribution has two rows.
          if (min(loads%phase(row) - loads%phase(row - 1), loads%phase(row + 1) - loads%phase(row)) < 1e-9_dp) cycle
          call add_up(osc, loads%phase(row), loads%deflection(last, row), springs, slope)
          worst = max(worst, maxval(abs(springs - loads%load(last, :, row)))/load)
        end do
      end associate
      call check_close(t, trim(given(i)%name)//': where the chords end', worst, 0.0_dp, absolute=1e-9_dp)
      deallocate (springs)
    end do
  end subroutine chords

  !> Largest force of the mesh over the load, by the classical Runge-Kutta method with one damping coefficient at 45 speeds upwards
  !> and downwards: with the load distribution solved at each deflection, and with the springs. An independent program, with
  !> elements, law, speeds and 16 phases of its own, has what exceeds the load within 20 %: the largest force is that where a bent
  !> resonance ends, which depends on the speeds. By how much the springs are off does not: theirs is within 0.06 of it.
  !> The library, with its damping by the stiffness of the moment, finds the largest load of a pair in the springs' motion, with
  !> and without loss of contact.
  subroutine independent(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: speeds = 45
    type(face_mesh_t) :: mesh
    type(alignment_t) :: alignment
    type(oscillator_t) :: osc
    type(table_t) :: smooth, springs
    type(accuracy_t) :: options
    type(point_t) :: point
    character(:), allocatable :: name
    real(dp) :: state(2, 2), of(2, 2), largest(2), apart, ratio, rpm
    integer :: i, k, n, way

    do i = 1, size(given)
      call make(t, given(i), mesh, alignment)
      call make_motion(t, mesh, alignment, osc)
      call tabulate(t, mesh, alignment, smooth)
      call tabulate_springs(osc, springs)
      largest = 0
      apart = 0
      do way = 1, 2
        state(1, :) = osc%mean_deflection
        state(2, :) = 0
        do k = 1, speeds
          ratio = 0.2_dp + 1.1_dp*(merge(k, speeds + 1 - k, way == 1) - 1)/(speeds - 1)
          call march(osc, smooth, 2*pi/(ratio*osc%natural_frequency), .true., state(:, 1), of(:, 1))
          call march(osc, springs, 2*pi/(ratio*osc%natural_frequency), .true., state(:, 2), of(:, 2))
          largest = max(largest, of(1, :))
          apart = max(apart, abs(of(1, 2) - of(1, 1)))
        end do
      end do
      name = trim(given(i)%name)
      call check_close(t, name//': largest force', largest(1) - 1, given(i)%smooth - 1, 0.2_dp)
      call check_close(t, name//': springs', (largest(2) - 1)/(largest(1) - 1), (given(i)%springs - 1)/(given(i)%smooth - 1), &
                       0.03_dp)
      if (given(i)%apart > 0) call check_true(t, name//': springs at any speed', apart < given(i)%apart + 0.06_dp, str(apart))
      do k = 3, 10, 7
        rpm = k/10.0_dp*osc%natural_frequency*60/(2*pi*25)
        state(:, 1) = [osc%mean_deflection, 0.0_dp]
        do n = 1, 3
          call march(osc, springs, mesh_period(25, rpm), .false., state(:, 1), of(:, 1))
        end do
        call solve(osc, rpm, options, point)
        call check_close(t, name//': dynamic factor at '//str(k/10.0_dp), point%dynamic_factor, of(2, 1), 2e-3_dp)
      end do
    end do
  end subroutine independent

  !> A case of 23/41 teeth with a sweep; `more`: further groups.
  pure function sweep_of(more) result(text)
    character(*), intent(in) :: more
    character(:), allocatable :: text

    text = '&case tasks = ''sweep'' / &load line_load_n_mm = 300 / &sweep rpm_first = 2000 rpm_last = 14000 rpm_step = 2000 / '// &
           more
  end function sweep_of

  !> With next to no misalignment the sweep is that of parallel faces, of spur and of helical gears, within what the springs leave
  !> out at the nominal load or put right beside it; and a small misalignment changes it in proportion.
  subroutine parallel_limit(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: gears = '&pinion teeth = 23 / &gear teeth = 41 / &mesh corner_contact = .false. / &dynamics '// &
      'damping_ratio = 0.15 / &relief amount_um = 0, 10 / &pair module_mm = 3 face_width_mm = 30 helix_angle_deg = '
    character(12), parameter :: amounts(4) = [character(12) :: '0', '1e-4', '0.1', '0.2']
    type(answer_t) :: answer
    real(dp), allocatable :: of(:, :)
    integer :: angle, i

    do angle = 0, 15, 15
      if (allocated(of)) deallocate (of)
      do i = 1, size(amounts)
        call ask(t, sweep_of(gears//str(angle)//' / &face misalignment_um = '//trim(amounts(i))//' /'), answer)
        associate (found => answer%all_of('sweep.dynamic_factor'))
          call check_true(t, 'two reliefs and seven speeds', size(found) == 14)
          if (.not. allocated(of)) allocate (of(size(found), size(amounts)))
          of(:, i) = found
        end associate
        call check_true(t, 'estimated', maxval(answer%all_of('sweep.error_estimate')) < 1e-6_dp)
      end do
      call check_close(t, 'parallel faces at '//str(angle)//' deg', maxval(abs(of(:, 2) - of(:, 1))), 0.0_dp, absolute=0.02_dp)
      do i = 3, 4
        associate (change => maxval(abs(of(:, i) - of(:, 2))))
          call check_true(t, 'a misalignment of '//trim(amounts(i))//' um changes little', change < 5e-4_dp*(i - 2), str(change))
        end associate
      end do
    end do
  end subroutine parallel_limit

  !> Lightly damped, all flanks part and the coast flanks touch: each point has a result, which the states of contact describe.
  subroutine contacts(t)
    type(tally_t), intent(inout) :: t
    type(answer_t) :: answer

    call ask(t, sweep_of('&pinion teeth = 23 crowning_um = 10 / &gear teeth = 41 / &pair module_mm = 3 face_width_mm = 30 '// &
                         'backlash_um = 5 / &face misalignment_um = 15 / &dynamics damping_ratio = 0.04 / '), answer)
    call check_true(t, 'each has a result', nint(answer%one('sweep_summary.points_without_answer')) == 0)
    call check_true(t, 'some part', answer%one('sweep_summary.points_with_contact_loss') > 0)
    call check_true(t, 'coast flanks touch', maxval(answer%all_of('sweep.coast_factor')) > 0)
    call check_true(t, 'estimated', maxval(answer%all_of('sweep.error_estimate')) < 1e-6_dp)
  end subroutine contacts

  !> One sentence each for what the motion does not have.
  subroutine refused(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: gears = '&pinion teeth = 23 / &gear teeth = 41 / &face misalignment_um = 15 / &pair module_mm = 3 '

    call expect('face_width_mm = 30 / &dynamics friction = 0.05 /', &
                '&dynamics friction = 0.05: must be 0 in a sweep with uneven faces')
    call expect('face_width_mm = 100 helix_angle_deg = 28 /', 'the motion with an uneven load over the face needs at most 6')
    call expect('face_width_mm = 30 / &mesh model = ''weber'' /', &
                '&mesh model = ''weber'': must be ''fe'' for the load over the face width')

  contains

    subroutine expect(groups, words)
      character(*), intent(in) :: groups, words
      character(:), allocatable :: message

      message = refusal(sweep_of(gears//groups))
      call check_true(t, words, index(message, words) > 0, message)
    end subroutine expect
  end subroutine refused
end module test_face_motion
