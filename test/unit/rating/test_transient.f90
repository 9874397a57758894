!> A tooth under a load that passes over it: closed forms of one mode, direct integration of all unknowns, the load at rest.
module test_transient
  use gearsweep_elastic_body, only: body_t
  use gearsweep_elastic_compliance, only: flank_load
  use gearsweep_base_error, only: error_t
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_elastic_material, only: material_t
  use gearsweep_mesh_mesh, only: mesh_t
  use gearsweep_elastic_modes, only: modal_t, section_modes
  use gearsweep_gear_pair, only: pair_t
  use gearsweep_rating_passage, only: load_places, pass_path, pass_static, passage_options_t, passage_t, place_radius
  use gearsweep_rating_root_rating, only: root_options_t, shared_equally, shares_stated, spaced_on_flank
  use gearsweep_elastic_section, only: make_two_grids, section_body_t, stress_error_share
  use gearsweep_elastic_stress, only: root_stress, root_stress_t
  use gearsweep_elastic_modal_response, only: advance_mode, load_history_t, modal_model_t, motion_record_t, superpose
  use gearsweep_base_text, only: str
  use gearsweep_elastic_tooth_modes, only: along, find_tooth_modes, moved_y, per_point, tooth_modes_t
  use gearsweep_rating_tooth_transient, only: damp_modes, damping_t, follow_tooth, sampling_t, tooth_transient_t
  use test_support_gears, only: hassan_gear, hassan_options, hassan_pair
  use test_support_testing, only: check_close, check_error, check_no_error, check_true, tally_t
  implicit none
  private
  public :: run

  interface
    subroutine dpotrf(uplo, n, a, lda, info)
      import :: dp
      character, intent(in) :: uplo
      integer, intent(in) :: n, lda
      real(dp), intent(inout) :: a(lda, *)
      integer, intent(out) :: info
    end subroutine dpotrf

    subroutine dpotrs(uplo, n, nrhs, a, lda, b, ldb, info)
      import :: dp
      character, intent(in) :: uplo
      integer, intent(in) :: n, nrhs, lda, ldb
      real(dp), intent(in) :: a(lda, *)
      real(dp), intent(inout) :: b(ldb, *)
      integer, intent(out) :: info
    end subroutine dpotrs
  end interface

  type(material_t), parameter :: steel = material_t(2.15e11_dp, 0.3_dp, 8750.0_dp)

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('one_mode')) call one_mode(t)
    if (t%wants('moving_load')) call moving_load(t)
    if (t%wants('passages')) call passages(t)
    if (t%wants('direct')) call direct(t)
    if (t%wants('jumps')) call jumps(t)
    if (t%wants('mirrored')) call mirrored(t)
    if (t%wants('at_rest')) call at_rest(t)
    if (t%wants('grids')) call grids_differ(t)
    if (t%wants('refusals')) call refusals(t)
  end subroutine run

  !> p" + c p' + w^2 p = f from rest under a step and under a ramp, in closed form (Clough and Penzien 1993, section 5.2), below,
  !> at and above critical damping; and no number of pieces changes it.
  subroutine one_mode(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: w = 3, time = 2.3_dp, damping(*) = [0.0_dp, 0.06_dp, 1.2_dp, 6 - 1e-7_dp, 6.0_dp, 6 + 1e-7_dp, 60.0_dp]
    real(dp) :: p, v, q, rate, step, ramp, c
    complex(dp) :: root(2)
    integer :: i, k

    do i = 1, size(damping)
      c = damping(i)
      if (abs(c - 2*w) < 1e-6_dp) then
        ! The closed form of critical damping, which the near ones differ from by less than their distance.
        step = (1 - exp(-w*time)*(1 + w*time))/w**2
        ramp = (time - 2/w + exp(-w*time)*(2/w + time))/w**2
      else
        ! Of the roots a, b of x^2 + c x + w^2: responses are sums of exponentials, complex where they oscillate.
        root = -c/2 + [1, -1]*sqrt(cmplx(c**2/4 - w**2, 0.0_dp, dp))
        step = real(1 + (root(2)*exp(root(1)*time) - root(1)*exp(root(2)*time))/(root(1) - root(2)), dp)/w**2
        ramp = real(time + (root(2)*(exp(root(1)*time) - 1)/root(1) - root(1)*(exp(root(2)*time) - 1)/root(2)) &
                    /(root(1) - root(2)), dp)/w**2
      end if
      p = 0
      v = 0
      call advance_mode(w, c, time, 1.0_dp, 1.0_dp, p, v)
      call check_close(t, 'step, c = '//str(c), p, step, absolute=1e-7_dp*merge(1.0_dp, 1e-6_dp, abs(c - 6) < 1e-6_dp))
      p = 0
      v = 0
      call advance_mode(w, c, time, 0.0_dp, time, p, v)
      call check_close(t, 'ramp, c = '//str(c), p, ramp, absolute=1e-7_dp*merge(1.0_dp, 1e-6_dp, abs(c - 6) < 1e-6_dp))
      call check_close(t, 'rate under a ramp, c = '//str(c), v, step, &
                       absolute=1e-7_dp*merge(1.0_dp, 1e-6_dp, abs(c - 6) < 1e-6_dp))
      q = 0
      rate = 0
      do k = 1, 50
        call advance_mode(w, c, time/50, time*(k - 1)/50, time*k/50, q, rate)
      end do
      call check_close(t, 'in 50 pieces, c = '//str(c), q, p, absolute=1e-13_dp)
      call check_close(t, 'its rate in 50 pieces, c = '//str(c), rate, v, absolute=1e-13_dp)
    end do
  end subroutine one_mode

  !> A load that moves over a shape sin(pi s): the undamped mode's motion in closed form, (sin at - a/w sin wt)/(w^2 - a^2)
  !> (Fryba 1999, Vibration of Solids and Structures under Moving Loads, section 1.1), approached in second order as
  !> the pieces become shorter, and by the places' spline in fourth order.
  subroutine moving_load(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: w = 7, speed = 0.4_dp
    type(modal_model_t) :: model
    type(load_history_t) :: history
    type(motion_record_t) :: record
    type(error_t), allocatable :: error
    real(dp) :: off(2), exact(21), a
    integer :: i, k, n

    a = pi*speed
    model%frequency = [w]
    model%damping = [0.0_dp]
    allocate (model%shape(1, 1), source=2.0_dp)
    do k = 1, 2
      n = 40*k
      if (allocated(model%force)) deallocate (model%force, model%static)
      allocate (model%force(1, n + 1), source=reshape([(sin(pi*i/n), i=0, n)], [1, n + 1]))
      allocate (model%static, source=2*model%force/w**2)
      ! Of which nothing is left.
      model%residual_frequency = spread(w, 1, n + 1)
      history%time = [(i/(speed*n), i=0, n)]
      history%load = spread(3.0_dp, 1, n + 1)
      history%weight = reshape([((merge(1.0_dp, 0.0_dp, i == n), n=1, 40*k + 1), i=1, 40*k + 1)], [40*k + 1, 40*k + 1])
      call superpose(model, history, [1], [(i/(20*speed), i=0, 20)], 7, .true., record, error)
      call check_no_error(t, 'moving load', error)
      exact = [(6*(sin(a*record%time(i)) - a/w*sin(w*record%time(i)))/(w**2 - a**2), i=1, 21)]
      off(k) = maxval(abs(record%value(1, :) - exact))/maxval(abs(exact))
    end do
    call check_true(t, 'moving load, 80 pieces', off(2) < 1e-3_dp, str(off(2)))
    call check_true(t, 'moving load: second order', abs(log(off(1)/off(2))/log(2.0_dp) - 2) < 0.2_dp, &
                    str(log(off(1)/off(2))/log(2.0_dp)))
    call check_true(t, 'largest is at least the largest sample', record%highest(1) >= maxval(record%value(1, :)))
    ! Between samples a sine is seen up to this share of its amplitude.
    call check_close(t, 'largest value', record%highest(1), largest_exact(w, a), relative=2e-3_dp)
  end subroutine moving_load

  real(dp) function largest_exact(w, a) result(largest)
    real(dp), intent(in) :: w, a
    integer :: i

    largest = maxval([(6*(sin(pi*i/100000) - a/w*sin(w*pi*i/a/100000))/(w**2 - a**2), i=0, 100000)])
  end function largest_exact

  !> Times, places and weights of passages: a load between two places is shared among them, so that weights add up to 1.
  subroutine passages(t)
    type(tally_t), intent(inout) :: t
    type(pair_t) :: pair
    type(mesh_t) :: mesh
    type(passage_options_t) :: options
    type(passage_t) :: passage
    real(dp), allocatable :: s(:)
    real(dp) :: period
    integer :: i

    pair = hassan_pair()
    mesh%contact_ratio = pair%contact_ratio
    mesh%reach = [0.0_dp, pair%contact_ratio]
    period = 1e-3_dp
    options%root = root_options_t(positions=12, sharing=shared_equally)
    options%after = 0.25_dp
    call pass_static(pair, mesh, 1000.0_dp, options, period, passage)
    associate (history => passage%history, n => size(passage%s))
      call check_close(t, 'weights', maxval(abs(sum(history%weight, 1) - 1)), 0.0_dp, absolute=1e-12_dp)
      call check_close(t, 'passes in the contact ratio', history%time(n - 1)/period, pair%contact_ratio, relative=1e-12_dp)
      call check_close(t, 'and is looked at thereafter', (history%time(n) - history%time(n - 1))/period, 0.25_dp, relative=1e-9_dp)
      call check_close(t, 'outwards from A', passage%s(1), 0.0_dp, absolute=1e-15_dp)
      ! One pair carries from B, where the pair ahead leaves, to D: 2 - contact ratio base pitches.
      call check_close(t, 'impulse of the load', sum([((history%time(i + 1) - history%time(i)) &
                       *(history%load(i + 1) + history%load(i))/2, i=1, n - 1)]), &
                       1000*period*(0.5_dp*2*(pair%contact_ratio - 1) + (2 - pair%contact_ratio)), relative=1e-7_dp)
    end associate
    options%inwards = .true.
    call pass_static(pair, mesh, 1000.0_dp, options, period, passage)
    call check_close(t, 'inwards from E', passage%s(1), pair%contact_ratio, relative=1e-12_dp)

    ! The pair that is not loaded at first and at last has a passage of what lies between.
    s = [(pair%contact_ratio*i/10, i=0, 10)]
    options%inwards = .false.
    call pass_path(pair, s, [0.0_dp, 0.0_dp, 0.0_dp, 1.0_dp, 2.0_dp, 2.0_dp, 0.0_dp, 1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp], options, &
                   period, passage)
    call check_close(t, 'first contact', passage%s(1), s(3), relative=1e-12_dp)
    call check_close(t, 'last contact', passage%s(size(passage%s)), s(9), relative=1e-12_dp)

    options = passage_options_t(inwards=.true., periods=1.0_dp, jump=0.25_dp)
    options%root%spacing = spaced_on_flank
    options%root%sharing = shares_stated
    allocate (options%root%shares, source=[0.5_dp, 1.0_dp, 1.0_dp, 0.5_dp])
    options%root%positions = 4
    call pass_static(pair, mesh, 8.0_dp, options, period, passage)
    call check_true(t, 'stated shares: points and two for each jump', size(passage%s) == 8, str(size(passage%s)))
    if (size(passage%s) /= 8) return
    associate (history => passage%history, third => period/3)
      call check_close(t, 'stated shares: times', maxval(abs(history%time - third*[0.0_dp, 0.25_dp, 0.25_dp, 1.0_dp, 2.0_dp, &
                       2.25_dp, 2.25_dp, 3.0_dp])), 0.0_dp, absolute=1e-15_dp)
      call check_close(t, 'stated shares: loads', maxval(abs(history%load - [4, 4, 8, 8, 8, 8, 4, 4])), 0.0_dp, absolute=1e-12_dp)
      ! Where the load stands is the sum of the places by their weights, in a jump too.
      s = load_places(pair, options)
      call check_close(t, 'stated shares: places', maxval(abs(matmul(s, history%weight) - passage%s)), 0.0_dp, absolute=1e-14_dp)
      call check_close(t, 'stated shares: the load before its jump stands at a quarter of the way', &
                       maxval(abs(history%weight(:, 2) - [0.75_dp, 0.25_dp, 0.0_dp, 0.0_dp])), 0.0_dp, absolute=1e-15_dp)
    end associate
  end subroutine passages

  !> Hassan's section on a coarse grid, loaded as in the paper but from and to nothing, with damping by Rayleigh.
  subroutine prepare(t, across, modes, places, tooth, grids, options)
    type(tally_t), intent(inout) :: t
    integer, intent(in) :: across, modes
    integer, intent(in) :: places
    type(tooth_modes_t), intent(out) :: tooth(2)
    type(section_body_t), intent(inout) :: grids(2)
    type(passage_options_t), intent(out) :: options
    type(modal_t) :: modal
    type(error_t), allocatable :: error
    integer :: i

    options%inwards = .true.
    options%periods = 1
    options%root = root_options_t(positions=places, spacing=spaced_on_flank, sharing=shares_stated)
    allocate (options%root%shares, source=[(sin(pi*i/(places - 1))**2, i=0, places - 1)])
    call make_two_grids(hassan_gear(30), steel, hassan_options(across), grids, error)
    call check_no_error(t, 'grids', error)
    call section_modes(grids, modes, modal, error)
    call check_no_error(t, 'modes', error)
    associate (pair => hassan_pair())
      associate (radius => place_radius(pair, options, load_places(pair, options)))
        call find_tooth_modes(grids(1), modal%modes, radius, [25*pi/180], tooth(1), error)
        call find_tooth_modes(grids(2), modal%coarse, radius, [25*pi/180], tooth(2), error)
      end associate
    end associate
    call check_no_error(t, 'tooth', error)
    do i = 1, 2
      call damp_modes(damping_t(.true., alpha=1000.0_dp, beta=4e-7_dp), tooth(i), 'alpha', error)
    end do
    call check_no_error(t, 'damping', error)
  end subroutine prepare

  !> Against the trapezoidal rule for all unknowns at once, with matrices put together and factored densely by LAPACK: another
  !> method in time and in space; only the reading of the fillets is shared. Two step lengths and Richardson's
  !> extrapolation leave an error of fourth order. The tolerance of the modes falls with their number.
  subroutine direct(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: places = 5, samples = 20, counts(2) = [8, 60]
    real(dp), parameter :: tolerance(2) = [2e-2_dp, 1e-3_dp]
    type(tooth_modes_t) :: tooth(2)
    type(section_body_t) :: grids(2)
    type(passage_options_t) :: options
    type(passage_t) :: passage
    type(tooth_transient_t) :: found
    type(error_t), allocatable :: error
    type(mesh_t) :: mesh
    real(dp), allocatable :: rough(:, :), fine(:, :)
    real(dp) :: exact(0:samples), off
    integer :: k

    do k = 1, size(counts)
      call prepare(t, 3, counts(k), places, tooth, grids, options)
      mesh%contact_ratio = 1.7_dp
      call pass_static(hassan_pair(), mesh, 28000.0_dp, options, 5e-4_dp, passage)
      call follow_tooth(tooth, stress_error_share(grids), passage, sampling_t(samples=samples), found, error)
      call check_no_error(t, 'passage', error)
      if (k == 1) then
        call integrate(grids(1)%body, grids(1), options, passage%history, 500, samples, rough)
        call integrate(grids(1)%body, grids(1), options, passage%history, 1000, samples, fine)
        exact = fine(1, :) + (fine(1, :) - rough(1, :))/3
        call check_true(t, 'direct integration: its own error', maxval(abs(fine(1, :) - rough(1, :)))/3 &
                        < 1e-3_dp*maxval(abs(exact)), str(maxval(abs(fine(1, :) - rough(1, :)))/3/maxval(abs(exact))))
      end if
      off = maxval(abs(found%record%value(along, :) - exact))/maxval(abs(exact))
      call check_true(t, 'stress by '//str(counts(k))//' modes and by all unknowns', off < tolerance(k), str(off))
    end do
    exact = fine(2, :) + (fine(2, :) - rough(2, :))/3
    off = maxval(abs(found%record%value(moved_y, :) - exact))/maxval(abs(exact))
    call check_true(t, 'displacement', off < tolerance(2), str(off))
    call check_true(t, 'it is no motion at rest', maxval(abs(found%record%value(along, :) - found%record%static(along, :))) &
                    > 0.05_dp*maxval(abs(found%record%static(along, :))))
  end subroutine direct

  !> A load that is there at once, doubles at once and halves at once: against the same direct integration, whose steps have the
  !> jumps in their middles. Nothing has moved yet as the load comes, whatever the modes leave out. What these leave out rings by
  !> itself after a jump, which no correction has: with 30 modes the largest stress is right within 1 %, and that of any time
  !> within 4 % of it.
  subroutine jumps(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: places = 5, samples = 500, modes = 30
    type(tooth_modes_t) :: tooth(2)
    type(section_body_t) :: grids(2)
    type(passage_options_t) :: options
    type(passage_t) :: passage
    type(tooth_transient_t) :: found
    type(error_t), allocatable :: error
    type(mesh_t) :: mesh
    real(dp), allocatable :: rough(:, :), fine(:, :)
    real(dp) :: off, own
    integer :: i, row
    integer, parameter :: seen(2) = [1, 3]

    call prepare(t, 3, modes, places, tooth, grids, options)
    options%root%shares = [0.5_dp, 0.5_dp, 1.0_dp, 1.0_dp, 0.5_dp]
    options%jump = 0.5_dp
    mesh%contact_ratio = 1.7_dp
    call pass_static(hassan_pair(), mesh, 28000.0_dp, options, 5e-4_dp, passage)
    call follow_tooth(tooth, stress_error_share(grids), passage, sampling_t(samples=samples), found, error)
    call check_no_error(t, 'passage', error)
    call integrate(grids(1)%body, grids(1), options, passage%history, samples, samples, rough)
    call integrate(grids(1)%body, grids(1), options, passage%history, 3*samples, samples, fine)
    do i = 1, 2
      row = per_point*(i - 1) + along
      associate (stress => found%record%value(row, :), exact => fine(seen(i), :), rest => found%record%static(row, :))
        call check_close(t, 'nothing has moved yet', stress(1), 0.0_dp, absolute=1e-12_dp*maxval(abs(rest)))
        off = abs(maxval(abs(stress))/maxval(abs(exact)) - 1)
        own = abs(maxval(abs(rough(seen(i), :)))/maxval(abs(exact)) - 1)/8
        call check_true(t, 'direct integration: its own error', own < 1e-3_dp, str(own))
        call check_true(t, 'largest stress, side '//str(i), off < 1e-2_dp, str(off))
        off = maxval(abs(stress - exact))/maxval(abs(exact))
        call check_true(t, 'stress at all times', off < 0.04_dp, str(off))
      end associate
    end do
  end subroutine jumps

  !> Ten times the load, ten times the stress, and the same relative errors; a load that pulls mirrors them: the highest is the
  !> lowest, at the same time, and as uncertain. The times are those of the largest and least sample.
  subroutine mirrored(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: places = 5, modes = 6
    real(dp), parameter :: times(3) = [1.0_dp, 10.0_dp, -1.0_dp]
    type(tooth_modes_t) :: tooth(2)
    type(section_body_t) :: grids(2)
    type(passage_options_t) :: options
    type(passage_t) :: passage
    type(tooth_transient_t) :: found(3)
    type(error_t), allocatable :: error
    type(mesh_t) :: mesh
    real(dp), allocatable :: load(:)
    integer :: i, k

    call prepare(t, 3, modes, places, tooth, grids, options)
    mesh%contact_ratio = 1.7_dp
    call pass_static(hassan_pair(), mesh, 28000.0_dp, options, 5e-4_dp, passage)
    load = passage%history%load
    do i = 1, 3
      passage%history%load = times(i)*load
      call follow_tooth(tooth, stress_error_share(grids), passage, sampling_t(step=5e-6_dp), found(i), error)
      call check_no_error(t, 'a passage', error)
    end do
    associate (one => found(1), ten => found(2), back => found(3), n => size(found(1)%record%highest))
      do k = 1, size(one%point_error)
        call check_close(t, 'relative error under ten times the load', ten%point_error(k), one%point_error(k), 1e-9_dp)
        call check_close(t, 'relative error of the mirrored stress', back%point_error(k), one%point_error(k), 1e-9_dp)
        i = tooth(1)%row_of(k) + along
        associate (seen => one%record%value(per_point*(k - 1) + along, :), record => one%record)
          call check_close(t, 'time of the highest', record%time_highest(i), record%time(maxloc(seen, 1)), absolute=1e-12_dp)
          call check_close(t, 'time of the lowest', record%time_lowest(i), record%time(minloc(seen, 1)), absolute=1e-12_dp)
          call check_close(t, 'highest of the samples', record%highest(i), maxval(seen), 1e-12_dp)
          call check_close(t, 'lowest of the samples', record%lowest(i), minval(seen), 1e-12_dp)
        end associate
      end do
      call check_close(t, 'error of the largest under ten times the load', ten%peaks%error_estimate, one%peaks%error_estimate, &
                       1e-9_dp)
      call check_close(t, 'error of the mirrored largest', back%peaks%error_estimate, one%peaks%error_estimate, 1e-9_dp)
      call check_close(t, 'the highest mirrored', maxval(abs(back%record%highest + one%record%lowest)), 0.0_dp, &
                       absolute=1e-12_dp*maxval(abs(one%record%lowest)))
      call check_close(t, 'tension mirrored', back%peaks%tension%stress, -one%peaks%compression%stress, 1e-9_dp)
      call check_close(t, 'where', back%peaks%tension%tangent, one%peaks%compression%tangent, 1e-9_dp)
    end associate
  end subroutine mirrored

  !> Stress along the drive fillet, displacement along the tooth there and stress along the coast fillet at the chosen points
  !> (3, 0:samples), by Newmark's method of
  !> constant average acceleration.
  subroutine integrate(body, grid, options, history, steps, samples, seen)
    type(body_t), intent(in) :: body
    type(section_body_t), intent(in) :: grid
    type(passage_options_t), intent(in) :: options
    type(load_history_t), intent(in) :: history
    integer, intent(in) :: steps, samples
    real(dp), allocatable, intent(out) :: seen(:, :)
    real(dp), allocatable :: k(:, :), m(:, :), c(:, :), whole(:, :), force(:, :), radius(:), kept(:, :)
    real(dp), dimension(body%unknowns) :: u, v, a, guess_u, guess_v
    type(error_t), allocatable :: error
    real(dp) :: h, now
    integer :: i, info

    call assemble(grid, k, m)
    allocate (c, source=1000*m + 4e-7_dp*k)
    radius = place_radius(hassan_pair(), options, load_places(hassan_pair(), options))
    allocate (force(body%unknowns, size(radius)), source=0.0_dp)
    do i = 1, size(radius)
      ! The body is a metre wide.
      call flank_load(grid%section, body, radius(i), force(:, i), error)
    end do
    force = force/grid%section%gear%spec%face_width
    h = history%time(size(history%time))/steps
    allocate (whole, source=m + h/2*c + h**2/4*k)
    call dpotrf('L', body%unknowns, whole, body%unknowns, info)
    allocate (kept(body%unknowns, 0:samples))
    u = 0
    v = 0
    ! Where the load is there at once.
    a = matmul(force, load_at(history, 0.0_dp))
    call dpotrf('L', body%unknowns, m, body%unknowns, info)
    call dpotrs('L', body%unknowns, 1, m, body%unknowns, a, body%unknowns, info)
    kept(:, 0) = u
    do i = 1, steps
      now = h*i
      guess_u = u + h*v + h**2/4*a
      guess_v = v + h/2*a
      a = matmul(force, load_at(history, now)) - matmul(c, guess_v) - matmul(k, guess_u)
      call dpotrs('L', body%unknowns, 1, whole, body%unknowns, a, body%unknowns, info)
      u = guess_u + h**2/4*a
      v = guess_v + h/2*a
      if (modulo(i*samples, steps) == 0) kept(:, i*samples/steps) = u
    end do
    call look_at(grid, kept, seen)
  end subroutine integrate

  !> The load at each place: products of load and weight are linear in time.
  function load_at(history, now) result(load)
    type(load_history_t), intent(in) :: history
    real(dp), intent(in) :: now
    real(dp) :: load(size(history%weight, 1))
    real(dp) :: share
    integer :: i

    i = max(1, min(size(history%time) - 1, count(history%time <= now)))
    share = min(1.0_dp, (now - history%time(i))/(history%time(i + 1) - history%time(i)))
    load = (1 - share)*history%load(i)*history%weight(:, i) + share*history%load(i + 1)*history%weight(:, i + 1)
  end function load_at

  !> Stiffness and mass on the unknowns, element by element, for the section's own modulus.
  subroutine assemble(grid, k, m)
    type(section_body_t), intent(in) :: grid
    real(dp), allocatable, intent(out) :: k(:, :), m(:, :)
    real(dp), allocatable :: masses(:, :, :), u(:, :), forces(:, :)
    real(dp) :: one(grid%body%unknowns)
    integer :: e, i, j, d, n

    n = grid%body%unknowns
    allocate (k(n, n), u(2*size(grid%section%grid%x, 2), n))
    allocate (m(n, n), source=0.0_dp)
    do i = 1, n
      one = 0
      one(i) = 1
      u(:, i) = reshape(grid%body%spread_out(one), [size(u, 1)])
    end do
    forces = grid%body%stiffness_times(u)
    do i = 1, n
      k(:, i) = grid%body%gather(reshape(forces(:, i), [2, size(u, 1)/2]))
    end do
    k = k*grid%material%young/grid%body%material%young
    masses = grid%body%mass_matrices()
    do e = 1, size(masses, 3)
      do d = 1, 2
        associate (at => grid%body%equation(d, grid%section%grid%element(:, e)))
          do i = 1, size(at)
            do j = 1, size(at)
              if (at(i) > 0 .and. at(j) > 0) m(at(i), at(j)) = m(at(i), at(j)) + masses(i, j, e)
            end do
          end do
        end associate
      end do
    end do
  end subroutine assemble

  !> Reads displacements of all unknowns at the chosen point, as if they were modes.
  subroutine look_at(grid, kept, seen)
    type(section_body_t), intent(in) :: grid
    real(dp), intent(in) :: kept(:, :)
    real(dp), allocatable, intent(out) :: seen(:, :)
    type(modal_t) :: as_modes
    type(tooth_modes_t) :: tooth
    type(error_t), allocatable :: error
    integer :: i, n

    n = size(kept, 2)
    allocate (as_modes%modes%frequency(n), source=1.0_dp)
    allocate (as_modes%modes%shape(2, size(grid%section%grid%x, 2), n))
    do i = 1, n
      as_modes%modes%shape(:, :, i) = grid%body%spread_out(kept(:, i))
    end do
    call find_tooth_modes(grid, as_modes%modes, [grid%section%gear%reference_radius], [25*pi/180], tooth, error)
    allocate (seen(3, 0:n - 1))
    seen(1, :) = tooth%model%shape(tooth%row_of(1) + along, :)
    seen(2, :) = tooth%model%shape(tooth%row_of(1) + moved_y, :)
    seen(3, :) = tooth%model%shape(tooth%row_of(2) + along, :)
  end subroutine look_at

  !> The slower the load passes, the nearer comes the stress to that at rest: with damping in proportion to the speed. At rest
  !> the static correction makes it exact with any number of modes, and what is at rest is what the task `static` has.
  subroutine at_rest(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: places = 9
    type(tooth_modes_t) :: tooth(2)
    type(section_body_t) :: grids(2)
    type(passage_options_t) :: options
    type(passage_t) :: passage
    type(tooth_transient_t) :: slow, slower, alone
    type(root_stress_t) :: static
    type(error_t), allocatable :: error
    type(mesh_t) :: mesh
    real(dp), allocatable :: radius(:), stress(:), components(:, :)
    real(dp) :: off(2)

    call prepare(t, 6, 3, places, tooth, grids, options)
    mesh%contact_ratio = 1.7_dp
    call pass_static(hassan_pair(), mesh, 28000.0_dp, options, 1.0_dp, passage)
    call follow_tooth(tooth, stress_error_share(grids), passage, sampling_t(samples=80), slow, error)
    call pass_static(hassan_pair(), mesh, 28000.0_dp, options, 2.0_dp, passage)
    call follow_tooth(tooth, stress_error_share(grids), passage, sampling_t(samples=80), slower, error)
    call follow_tooth(tooth, stress_error_share(grids), passage, sampling_t(samples=80, corrected=.false.), alone, error)
    call check_no_error(t, 'slow passages', error)
    off = [away(slow), away(slower)]
    call check_true(t, 'slow: nearly at rest', off(1) < 1e-4_dp, str(off(1)))
    call check_true(t, 'half as fast: half as far from rest', abs(off(1)/off(2) - 2) < 0.1_dp, str(off(1)/off(2)))
    call check_true(t, 'three modes alone miss much of it', away(alone) > 0.01_dp, str(away(alone)))
    radius = place_radius(hassan_pair(), options, load_places(hassan_pair(), options))
    call root_stress(grids, radius, 28000*options%root%shares/grids(1)%section%gear%spec%face_width, static, error)
    call check_no_error(t, 'static stress', error)
    call check_close(t, 'tension at rest', slow%static%tension%stress, static%tension%stress, relative=1e-9_dp)
    call check_close(t, 'compression at rest', slow%static%compression%stress, static%compression%stress, relative=1e-9_dp)
    call check_close(t, 'compression of a slow passage', slower%peaks%compression%stress, static%compression%stress, &
                     relative=2*off(2))
    call static%at_tangent(1, 25*pi/180, stress, components, error)
    call check_no_error(t, 'tangent', error)
    call check_close(t, 'at the chosen point, load by load', maxval(abs(slow%record%static(along, 1::10) - stress)), 0.0_dp, &
                     absolute=1e-9_dp*maxval(abs(stress)))

  contains

    real(dp) function away(found)
      type(tooth_transient_t), intent(in) :: found

      away = maxval(abs(found%record%value(along, :) - found%record%static(along, :)))/maxval(abs(found%record%static(along, :)))
    end function away
  end subroutine at_rest

  !> The error estimate is of the size of the true error, that against a much finer grid.
  subroutine grids_differ(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: across(2) = [10, 32]
    type(tooth_modes_t) :: tooth(2)
    type(section_body_t) :: grids(2)
    type(passage_options_t) :: options
    type(passage_t) :: passage
    type(tooth_transient_t) :: found(2)
    type(error_t), allocatable :: error
    type(mesh_t) :: mesh
    real(dp) :: off
    integer :: k

    do k = 1, 2
      call prepare(t, across(k), 20, 9, tooth, grids, options)
      mesh%contact_ratio = 1.7_dp
      call pass_static(hassan_pair(), mesh, 28000.0_dp, options, 1.4e-3_dp, passage)
      call follow_tooth(tooth, stress_error_share(grids), passage, sampling_t(), found(k), error)
      call check_no_error(t, 'passage', error)
    end do
    off = abs(found(1)%peaks%tension%stress/found(2)%peaks%tension%stress - 1)
    call check_true(t, 'tension within twice its estimate', off < 2*found(1)%peaks%error_estimate, &
                    str(off, 3)//' and '//str(found(1)%peaks%error_estimate, 3))
    off = abs(found(1)%peaks%compression%stress/found(2)%peaks%compression%stress - 1)
    call check_true(t, 'compression within twice its estimate', off < 2*found(1)%peaks%error_estimate, &
                    str(off, 3)//' and '//str(found(1)%peaks%error_estimate, 3))
    call check_true(t, 'the estimate is no alarm', found(1)%peaks%error_estimate < 0.05_dp)
  end subroutine grids_differ

  subroutine refusals(t)
    type(tally_t), intent(inout) :: t
    type(tooth_modes_t) :: tooth(2)
    type(section_body_t) :: grids(2)
    type(passage_options_t) :: options
    type(modal_t) :: modal
    type(error_t), allocatable :: error

    call prepare(t, 3, 2, 4, tooth, grids, options)
    deallocate (tooth(1)%model%damping)
    call damp_modes(damping_t(.true., alpha=-1.0_dp, beta=1e-12_dp), tooth(1), '&transient rayleigh_alpha_1_s', error)
    call check_error(t, 'negative damping', error, contains='&transient rayleigh_alpha_1_s = -1: the damping ratio of mode 1')
    deallocate (error)
    call section_modes(grids, 2, modal, error)
    call find_tooth_modes(grids(1), modal%modes, [0.36_dp], [pi/6], tooth(1), error)
    call check_no_error(t, 'a place on the flank', error)
    call find_tooth_modes(grids(1), modal%modes, [0.36_dp], [1e-3_dp], tooth(1), error)
    call check_error(t, 'a tangent off the fillet', error, contains='tangent at the fillet')
    deallocate (error)
    call find_tooth_modes(grids(1), modal%modes, [0.5_dp], [pi/6], tooth(1), error)
    call check_error(t, 'a place off the flank', error, contains='off the flank')
  end subroutine refusals
end module test_transient
