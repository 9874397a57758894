!> Lanes on their way through one step, each in stretches of its own: the coefficients between the table's
!> places, and the motion over a stretch, all lanes side by side.
module gearsweep_stretch
  use gearsweep_kinds, only: dp
  use gearsweep_gauss, only: collocate, lanes, nodes
  use gearsweep_motion, only: oscillator_t, table_t, mobility, acceleration
  use gearsweep_quintic, only: quintic, evaluate, bend_of
  use gearsweep_step, only: member_t
  implicit none
  private
  public :: crossing_t, search_t, make_crossing, take_step, sum_up, follow, move_end, slopes_of, bends_of, &
            motion_bends, last

  !> Places in a stretch at which its coefficients are known: both ends, and the nodes between.
  real(dp), parameter :: places(5) = [0.0_dp, nodes, 1.0_dp]
  integer, parameter :: last = size(places)

  !> What a lane does in its step.
  type :: search_t
    logical :: active = .false.
    logical :: begun = .false.                   !< it goes in stretches: its contact does change
    integer :: member = 0                        !< closing in on its change; 0: looking for one
    integer :: trials = 0, events = 0
    real(dp) :: room = 1, part = 1, low = 0, high = 1   !< the stretch looked at; guess and bounds as parts of it
    logical :: jumps = .false.                   !< contact has just changed:
    real(dp) :: before = 0, ratio = 0            !< w^2 before, y over the speed of approach
    real(dp) :: map(4) = [1, 0, 0, 1]            !< of the stretches so far
  end type search_t

  !> Lanes on their way through step `i`. Stiffness and profile error are quintics through what the table
  !> knows of the step's ends, (0:5, pair) and (0:5, member), the mobility is linear, (0:1, pair). A stretch
  !> is a part of the step with the contact as it is; its places count from 0 to 1 over the step.
  type :: crossing_t
    integer :: i = 0, n = 0
    real(dp), allocatable :: stiffness(:, :), error(:, :), mobility(:, :)
    real(dp), dimension(lanes) :: duration = 0, longest = 1
    type(search_t) :: search(lanes)
    real(dp), dimension(lanes) :: left = 0, width = 0
    real(dp), dimension(lanes, last) :: square = 0, push = 0           !< w^2 and sum of k e
    real(dp), dimension(lanes, 2) :: x = 0, y = 0                      !< at the stretch's ends
    real(dp) :: map(lanes, 6) = 0
    integer :: touch(lanes) = 0
    logical :: peaks = .true.                                          !< are wanted
  end type crossing_t

contains

  !> Room for the steps of a period at `n` speeds.
  pure subroutine make_crossing(osc, n, duration, c)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: n
    real(dp), intent(in) :: duration(lanes)
    type(crossing_t), allocatable, intent(out) :: c

    allocate (c)
    c%n = n
    c%duration = duration
    allocate (c%stiffness(0:5, osc%pairs), c%error(0:5, osc%members), c%mobility(0:1, osc%pairs))
  end subroutine make_crossing

  !> The quintics of step i.
  pure subroutine take_step(osc, table, i, c)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i
    type(crossing_t), intent(inout) :: c
    real(dp) :: scale(0:2)
    integer :: j

    c%i = i
    scale = [1.0_dp, table%width(i), table%width(i)**2]
    do j = 1, table%pairs(i)
      c%stiffness(:, j) = quintic(scale*table%end_stiffness(:, j, 1, i), scale*table%end_stiffness(:, j, 2, i))
      associate (left => table%left(i) + j - 1, recess => osc%zones(table%zone(i))%recess(j))
        c%mobility(0, j) = mobility(osc, left, recess)
        c%mobility(1, j) = mobility(osc, left + table%width(i), recess) - c%mobility(0, j)
      end associate
    end do
    do j = 1, osc%members
      if (j > table%pairs(i) .and. j <= osc%pairs) cycle
      c%error(:, j) = quintic(scale*table%end_error(:, j, 1, i), scale*table%end_error(:, j, 2, i))
    end do
    if (osc%damping_ratio > 1) c%longest = longest_stretch(osc, c%duration*table%width(i))
  end subroutine take_step

  !> The longest stretch as a part of a step of this time (s), under strong damping. Changes of contact cut
  !> stretches to the same length in every table, so that step doubling does not tell their error: where
  !> contact lasts shorter than a step, and drag changes the motion within it, they are made short.
  elemental real(dp) function longest_stretch(osc, time)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: time
    real(dp), parameter :: decay = 0.05_dp

    longest_stretch = 1
    if (time > 0) longest_stretch = min(1.0_dp, decay/(2*osc%damping_ratio*osc%highest_frequency*time))
  end function longest_stretch

  !> Sums over the members in contact at the place k of the stretches: w^2 and sum of k e.
  pure subroutine sum_up(osc, table, member, k, c)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    type(member_t), intent(in) :: member(osc%members)
    integer, intent(in) :: k
    type(crossing_t), intent(inout) :: c
    real(dp) :: place(lanes), square(lanes), push(lanes), slack(0:5)
    integer :: j

    place = c%left + c%width*places(k)
    square = 0
    push = 0
    do j = 1, table%pairs(c%i)
      call add_pair(c%n, c%stiffness(:, j), c%error(:, j), c%mobility(:, j), place, member(j)%weight, square, push)
    end do
    if (osc%has_backlash) then
      slack = 0
      slack(0) = -osc%backlash
      do j = 1, table%pairs(c%i)
        call add_pair(c%n, c%stiffness(:, j), slack, [sum(1/osc%mass), 0.0_dp], place, member(osc%members)%weight, &
                      square, push)
      end do
    end if
    c%square(:, k) = square
    c%push(:, k) = push
  end subroutine sum_up

  pure subroutine add_pair(n, stiffness, error, mobility, place, weight, square, push)
    integer, intent(in) :: n
    real(dp), intent(in) :: stiffness(0:5), error(0:5), mobility(0:1)
    real(dp), intent(in), dimension(lanes) :: place, weight
    real(dp), intent(inout), dimension(lanes) :: square, push
    real(dp) :: t, k, e, rate
    integer :: l

    do l = 1, n
      t = place(l)
      k = ((((stiffness(5)*t + stiffness(4))*t + stiffness(3))*t + stiffness(2))*t + stiffness(1))*t + stiffness(0)
      e = ((((error(5)*t + error(4))*t + error(3))*t + error(2))*t + error(1))*t + error(0)
      rate = weight(l)*k*(mobility(0) + mobility(1)*t)
      square(l) = square(l) + rate
      push(l) = push(l) + rate*e
    end do
  end subroutine add_pair

  !> The motion over the stretches, whose places are set; no lane is harmed by one of no width.
  pure subroutine follow(osc, table, member, c)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    type(member_t), intent(in) :: member(osc%members)
    type(crossing_t), intent(inout) :: c
    real(dp), dimension(lanes, size(nodes)) :: square, drag, push
    real(dp) :: time, width, load
    integer :: k, l

    do k = 1, last
      call sum_up(osc, table, member, k, c)
    end do
    load = osc%load*sum(1/osc%mass)
    do k = 1, size(nodes)
      do l = 1, c%n
        time = c%duration(l)*(c%width(l)*table%width(c%i))
        square(l, k) = time**2*c%square(l, k + 1)
        drag(l, k) = 2*osc%damping_ratio*time*sqrt(c%square(l, k + 1))
        push(l, k) = time**2*(c%push(l, k + 1) + load)
      end do
    end do
    call collocate(c%n, square, drag, push, c%map)
    do l = 1, c%n
      width = c%width(l)*table%width(c%i)
      c%map(l, 2) = c%map(l, 2)/max(width, tiny(width))
      c%map(l, 3) = c%map(l, 3)*width
      c%map(l, 6) = c%map(l, 6)/max(width, tiny(width))
      c%x(l, 2) = c%map(l, 1)*c%x(l, 1) + c%map(l, 3)*c%y(l, 1) + c%map(l, 5)
      c%y(l, 2) = c%map(l, 2)*c%x(l, 1) + c%map(l, 4)*c%y(l, 1) + c%map(l, 6)
    end do
  end subroutine follow

  !> Moves the end of the stretch of lane l by a tiny part of the step.
  pure subroutine move_end(osc, table, l, part, c)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: l
    real(dp), intent(in) :: part
    type(crossing_t), intent(inout) :: c
    real(dp) :: bend, by, square, drag

    by = part*table%width(c%i)
    bend = curvature(osc, l, last, c)
    c%width(l) = c%width(l) + part
    c%x(l, 2) = c%x(l, 2) + by*(c%y(l, 2) + by/2*bend)
    c%y(l, 2) = c%y(l, 2) + by*bend
    square = c%duration(l)**2*c%square(l, last)
    drag = 2*osc%damping_ratio*c%duration(l)*sqrt(c%square(l, last))
    c%map(l, 1:3:2) = c%map(l, 1:3:2) + by*c%map(l, 2:4:2)
    c%map(l, 2:4:2) = c%map(l, 2:4:2) - by*(square*c%map(l, 1:3:2) + drag*c%map(l, 2:4:2))
  end subroutine move_end

  !> Second derivative of the motion over the phase at an end of the stretch of lane l, its place k.
  pure real(dp) function curvature(osc, l, k, c)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: l, k
    type(crossing_t), intent(in) :: c
    integer :: end

    end = merge(1, 2, k == 1)
    curvature = acceleration(osc, c%square(l, k), c%push(l, k), c%duration(l), c%x(l, end), c%y(l, end))
  end function curvature

  !> Second derivative over the stretch of lane l, at both ends, of the motion.
  pure function motion_bends(osc, table, l, c) result(f)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: l
    type(crossing_t), intent(in) :: c
    real(dp) :: f(2)

    f(1) = curvature(osc, l, 1, c)
    f(2) = curvature(osc, l, last, c)
    f = (c%width(l)*table%width(c%i))**2*f
  end function motion_bends

  !> Value and first derivative over the stretch, at both ends, of a quintic over the step.
  pure function slopes_of(c, l, q) result(f)
    type(crossing_t), intent(in) :: c
    integer, intent(in) :: l
    real(dp), intent(in) :: q(0:5)
    real(dp) :: f(0:1, 2)

    call evaluate(q, c%left(l), f(0, 1), f(1, 1))
    call evaluate(q, c%left(l) + c%width(l), f(0, 2), f(1, 2))
    f(1, :) = f(1, :)*c%width(l)
  end function slopes_of

  !> Second derivative.
  pure function bends_of(c, l, q) result(f)
    type(crossing_t), intent(in) :: c
    integer, intent(in) :: l
    real(dp), intent(in) :: q(0:5)
    real(dp) :: f(2)

    f(1) = bend_of(q, c%left(l))*c%width(l)**2
    f(2) = bend_of(q, c%left(l) + c%width(l))*c%width(l)**2
  end function bends_of
end module gearsweep_stretch
