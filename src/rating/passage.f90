!> Passage of the load over a tooth: position and size of the load over time.
!>
!> The load moves steadily along the path of contact (spaced_on_path) or, as in Hassan et al. 2009, from one stated point of the
!> flank to the next in equal times, distributed to both points in between (spaced_on_flank).
module gearsweep_rating_passage
  use gearsweep_base, only: dp, piecewise_t, spline
  use gearsweep_gear, only: pair_t
  use gearsweep_elastic, only: load_history_t
  use gearsweep_mesh, only: mesh_t
  use gearsweep_rating_root_rating, only: load_positions, load_radius, load_shares, root_options_t, shared_by_mesh, &
    spaced_on_flank, spaced_on_path
  implicit none
  private
  public :: passage_options_t, passage_t, load_places, place_radius, pass_static, pass_path

  type :: passage_options_t
    !> Positions, load shares and spacing.
    type(root_options_t) :: root
    logical :: inwards = .false.                 !< true: from the tip down
    real(dp) :: periods = 0                      !< mesh periods from the first position to the last; 0: the contact ratio
    !> Place between two positions at which the share jumps, 0 to 1; below 0: it changes linearly.
    real(dp) :: jump = -1
    real(dp) :: after = 0                        !< time after the last contact, mesh periods
  end type passage_options_t

  type :: passage_t
    type(load_history_t) :: history
    real(dp), allocatable :: s(:)                !< path coordinate of the load; (time)
  end type passage_t

contains

  !> Path coordinates of the load positions.
  pure function load_places(pair, options) result(s)
    type(pair_t), intent(in) :: pair
    type(passage_options_t), intent(in) :: options
    real(dp), allocatable :: s(:)
    integer :: i

    if (options%root%spacing == spaced_on_flank) then
      s = load_positions(pair, options%root, [0.0_dp, pair%contact_ratio])
    else
      s = [(pair%contact_ratio*i/(options%root%positions - 1), i=0, options%root%positions - 1)]
    end if
  end function load_places

  !> Radii of the positions on the gear (m).
  pure function place_radius(pair, options, s) result(radius)
    type(pair_t), intent(in) :: pair
    type(passage_options_t), intent(in) :: options
    real(dp), intent(in) :: s(:)
    real(dp) :: radius(size(s))

    radius = load_radius(pair, options%root, s)
  end function place_radius

  !> Passage of the static `load` (N), shared by `mesh` or as in the options. `period`: of the mesh, s.
  subroutine pass_static(pair, mesh, load, options, period, passage)
    type(pair_t), intent(in) :: pair
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: load, period
    type(passage_options_t), intent(in) :: options
    type(passage_t), intent(out) :: passage
    integer, parameter :: finer = 8, steps = 64
    type(root_options_t) :: fine
    real(dp), allocatable :: s(:)
    real(dp) :: time
    integer :: last, places, i

    if (options%root%spacing == spaced_on_flank) then
      s = load_places(pair, options)
      call pass_places(s, load*load_shares(mesh, load, options%root, s), options, &
                       period*merge(options%periods, pair%contact_ratio, options%periods > 0), passage)
    else
      ! Between the positions the response of the tooth is smooth; the shares need not be.
      fine = options%root
      fine%positions = finer*(fine%positions - 1) + 1
      fine%spacing = spaced_on_path
      s = load_positions(pair, fine, mesh%reach)
      if (fine%sharing == shared_by_mesh) then
        ! Path coordinates beyond A and E at which tip corners touch.
        associate (reach => mesh%reach, e => pair%contact_ratio)
          if (reach(1) < 0) s = [(reach(1)*(1 - i/real(steps, dp)), i=0, steps - 1), s]
          if (reach(2) > e) s = [s, (e + (reach(2) - e)*i/real(steps, dp), i=1, steps)]
        end associate
      end if
      call pass_path(pair, s, load*load_shares(mesh, load, fine, s), options, period, passage)
    end if
    ! Time without load after the last contact.
    time = options%after*period
    if (.not. time > 0) return
    associate (history => passage%history)
      last = size(history%time)
      passage%s = [passage%s, passage%s(last), passage%s(last)]
      history%time = [history%time, history%time(last), history%time(last) + time]
      history%load = [history%load, 0.0_dp, 0.0_dp]
      places = size(history%weight, 1)
      history%weight = reshape([history%weight, history%weight(:, last), history%weight(:, last)], [places, last + 2])
    end associate
  end subroutine pass_static

  !> Passage of a known load (N) at path coordinates `s`, ascending, with uniform speed; the times before the first and after the
  !> last contact are omitted. Beyond A and E the load acts at that end of the path.
  pure subroutine pass_path(pair, s, load, options, period, passage)
    type(pair_t), intent(in) :: pair
    real(dp), intent(in) :: s(:), load(:), period
    type(passage_options_t), intent(in) :: options
    type(passage_t), intent(out) :: passage
    integer, allocatable :: order(:)
    real(dp), allocatable :: place(:), one(:)
    type(piecewise_t) :: curve
    integer :: first, last, i, k

    first = max(1, findloc(load > 0, .true., 1) - 1)
    last = min(size(s), findloc(load > 0, .true., 1, back=.true.) + 1)
    if (.not. any(load > 0)) last = size(s)
    order = [(i, i=first, last)]
    if (options%inwards .eqv. options%root%gear == 1) order = order(size(order):1:-1)
    associate (history => passage%history)
      passage%s = s(order)
      history%time = period*abs(passage%s - passage%s(1))
      history%load = load(order)
      ! Spline weights of the values at each position for points between them.
      place = load_places(pair, options)
      allocate (history%weight(size(place), size(order)))
      do i = 1, size(place)
        one = merge(1.0_dp, 0.0_dp, [(k == i, k=1, size(place))])
        curve = spline(place, one)
        do k = 1, size(order)
          history%weight(i, k) = curve%value(max(0.0_dp, min(pair%contact_ratio, passage%s(k))))
        end do
      end do
    end associate
  end subroutine pass_path

  !> Passage from one position to the next in equal times, `duration` (s) from first to last. `s`, `load` (N): outermost first.
  subroutine pass_places(s, load, options, duration, passage)
    real(dp), intent(in) :: s(:), load(:), duration
    type(passage_options_t), intent(in) :: options
    type(passage_t), intent(inout) :: passage
    real(dp) :: step
    integer :: n, i, from, to, point

    n = size(s)
    step = duration/(n - 1)
    associate (history => passage%history)
      allocate (passage%s(3*n), history%time(3*n), history%load(3*n))
      allocate (history%weight(n, 3*n), source=0.0_dp)
      point = 0
      do i = 1, n
        from = merge(i, n + 1 - i, options%inwards)
        to = merge(min(i + 1, n), max(n - i, 1), options%inwards)
        call add(0.0_dp, load(from))
        if (options%jump < 0 .or. .not. abs(load(to) - load(from)) > 0) cycle
        call add(options%jump, load(from))
        call add(options%jump, load(to))
      end do
      passage%s = passage%s(:point)
      history%time = history%time(:point)
      history%load = history%load(:point)
      history%weight = history%weight(:, :point)
    end associate

  contains

    subroutine add(share, load_there)
      real(dp), intent(in) :: share, load_there

      point = point + 1
      passage%s(point) = s(from)*(1 - share) + s(to)*share
      passage%history%time(point) = step*(i - 1 + share)
      passage%history%load(point) = load_there
      passage%history%weight(from, point) = 1 - share
      passage%history%weight(to, point) = passage%history%weight(to, point) + share
    end subroutine add
  end subroutine pass_places
end module gearsweep_rating_passage
