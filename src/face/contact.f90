!> Line loads on slices of flanks in contact, with Hertz's flattening under the own load of each slice.
module gearsweep_face_contact
  use gearsweep_base, only: code_numerical, dp, dposv, error_t, fail, str
  implicit none
  private
  public :: flat_t, solve_contact

  !> Flattening of both flanks under a line load w: -rate w log(w scale)/2.
  type :: flat_t
    real(dp) :: rate = 0                         !< m2/N; 0: no dependence on the load
    !> Square of the contact's half width per line load, over the square of the reference half width, m/N; (slice).
    real(dp), allocatable :: scale(:)
  end type flat_t

contains

  !> Finds the line loads w >= 0 (N/m) and the common deflection x (m) of slices that carry `load` together. A slice with a load
  !> touches: x - gap = C w/width + flattening. A slice without a load does not penetrate.
  !>
  !> Newton's method finds the loads of the slices in contact. Slices under tension leave the contact, and slices that penetrate
  !> join it; after the first changes one at a time, so that the energy falls with each change.
  !> `error`: the compliance is not positive definite, where slices are much narrower than Hertz's contact.
  subroutine solve_contact(compliance, width, gap, flat, load, deflection, line_load, rate, error)
    real(dp), intent(in) :: compliance(:, :)     !< displacement of a slice, integrated over it, per line load, m3/N
    real(dp), intent(in) :: width(:), gap(:)     !< m; (slice)
    type(flat_t), intent(in) :: flat
    real(dp), intent(in) :: load                 !< N
    real(dp), intent(out) :: deflection          !< m
    real(dp), intent(out) :: line_load(:)        !< N/m; (slice)
    real(dp), intent(out) :: rate(:)             !< d line load/d deflection, Pa; (slice)
    type(error_t), allocatable, intent(inout) :: error
    real(dp), parameter :: rounding = 1e-13_dp, near = 1e-2_dp, negligible = 1e-12_dp
    integer, parameter :: most = 500, many_at_once = 8
    real(dp), dimension(size(width)) :: change, open
    logical, dimension(size(width)) :: joins, touches
    real(dp) :: part, typical, stiffness
    integer :: i, at, changes
    logical :: is_near, is_done

    touches = .true.
    typical = load/sum(width)
    line_load = typical
    deflection = 0
    changes = 0
    do i = 1, most
      call newton_step()
      if (allocated(error)) return
      if (any(touches .and. line_load + change <= 0)) then
        changes = changes + 1
        if (changes <= many_at_once) then
          line_load = line_load + change
          touches = touches .and. line_load > 0
        else
          ! The step ends where the load of the first slice vanishes.
          at = minloc(-line_load/change, 1, mask=touches .and. line_load + change <= 0)
          part = -line_load(at)/change(at)
          line_load = line_load + part*change
          touches(at) = .false.
        end if
        where (.not. touches) line_load = 0
        cycle
      end if
      line_load = line_load + change
      associate (largest => maxval(abs(change)), whole => maxval(line_load))
        is_done = largest <= rounding*whole
        is_near = largest <= merge(near, sqrt(rounding), changes <= many_at_once)*whole
      end associate
      if (.not. is_near) cycle
      open = deflection - gap - matmul(compliance, line_load)/width
      where (touches) open = 0
      if (.not. any(open > rounding*max(abs(deflection), maxval(abs(gap))))) then
        if (is_done) return
        cycle
      end if
      changes = changes + 1
      joins = open > 0
      if (changes > many_at_once) joins = [(at == maxloc(open, 1), at=1, size(width))]
      ! A load below the slice's own one under this penetration: from there Newton's method does not pass 0, as the flattening
      ! makes the slice stiffer with the load.
      where (joins) line_load = open/own_compliance()
      touches = touches .or. joins
    end do
    call fail(error, code_numerical, 'load over the face: the slices in contact did not converge in '//str(most)//' steps')

  contains

    !> Displacement of a slice per own line load, under a load that is negligible, m2/N.
    pure function own_compliance() result(own)
      real(dp) :: own(size(width))
      integer :: j

      own = [(compliance(j, j), j=1, size(width))]/width
      if (flat%rate > 0) own = own - flat%rate/2*log(negligible*typical*flat%scale)
    end function own_compliance

    !> Computes the `change` of the loads in contact, and the deflection, by the tangent of the flattening.
    subroutine newton_step()
      real(dp) :: matrix(count(touches), count(touches)), x(count(touches), 2), own(count(touches))
      integer :: list(count(touches)), j, info

      list = pack([(j, j=1, size(width))], touches)
      matrix = compliance(list, list)
      own = width(list)
      associate (w => line_load(list))
        x(:, 1) = -own*gap(list) - matmul(matrix, w)
        x(:, 2) = own
        if (flat%rate > 0) then
          do j = 1, size(list)
            associate (logarithm => log(w(j)*flat%scale(list(j))))
              x(j, 1) = x(j, 1) + own(j)*flat%rate/2*w(j)*logarithm
              matrix(j, j) = matrix(j, j) - own(j)*flat%rate/2*(logarithm + 1)
            end associate
          end do
        end if
        call dposv('L', size(list), 2, matrix, size(list), x, size(list), info)
        if (info /= 0) then
          call fail(error, code_numerical, 'slices of the face: too narrow beside Hertz''s contact; use fewer')
          return
        end if
        stiffness = dot_product(own, x(:, 2))
        deflection = (load - dot_product(own, w) - dot_product(own, x(:, 1)))/stiffness
      end associate
      change = 0
      change(list) = x(:, 1) + deflection*x(:, 2)
      rate = 0
      rate(list) = x(:, 2)
    end subroutine newton_step
  end subroutine solve_contact
end module gearsweep_face_contact
