!> The tip reliefs of the task `deflection_relief` at chosen diameters of both flanks.
module gearsweep_relief_flank
  use gearsweep_error, only: code_input, error_t, fail
  use gearsweep_gear, only: drive
  use gearsweep_kinds, only: dp, pi
  use gearsweep_motions, only: relief_start
  use gearsweep_pair, only: pair_t
  use gearsweep_relief, only: relief_t, tip_relief
  use gearsweep_relief_methods, only: relief_method_t
  use gearsweep_table, only: axis, each, table_t
  use gearsweep_stages, only: stages_t
  use gearsweep_task, only: members
  use gearsweep_text, only: str
  implicit none
  private
  public :: flank_t, fill_flank

  !> Where the relief of one flank is told.
  type :: flank_t
    real(dp), allocatable :: diameter(:)         !< m; not allocated: in equal steps of the roll angle
  end type flank_t

  real(dp), parameter :: milli = 1e3_dp, micro = 1e6_dp, degree = pi/180

contains

  !> A row for each method, flank and diameter.
  subroutine fill_flank(stages, flank, methods, table, error)
    type(stages_t), intent(in) :: stages
    type(flank_t), intent(in) :: flank(2)
    type(relief_method_t), intent(in) :: methods(:)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: diameter(:), roll(:), along(:, :), straight(:, :)   ! (place, method)
    integer, allocatable :: member(:)
    type(relief_t) :: relief
    integer :: i, k, m, n

    if (allocated(error)) return
    call find_places(stages, flank, diameter, member, error)
    if (allocated(error)) return
    m = size(methods)
    n = size(diameter)
    call table%begin('relief of the flanks at chosen diameters, by each method', m*n, error)
    if (allocated(error)) return
    allocate (roll(n), along(n, m), straight(n, m))
    associate (pair => stages%pair, inputs => stages%motions_inputs%motion%relief)
      relief%start = relief_start(inputs)
      relief%shape = inputs%shape
      do k = 1, n
        associate (which => member(k), gear => pair%gear(member(k)))
          associate (curvature => gear%curvature(drive, diameter(k)/2), start => pair%radius(which, relief%start(which)))
            roll(k) = curvature/gear%base_radius(drive)
            do i = 1, m
              relief%amount = methods(i)%amount
              along(k, i) = tip_relief(relief, inputs%contact_ratio, which, path_place(pair, which, curvature))
              straight(k, i) = relief%amount(which)*max(0.0_dp, (diameter(k)/2 - start)/(gear%tip_form_radius - start))
            end do
          end associate
        end associate
      end do
    end associate
    call table%add_index(axis('method', '', 'as in the table deflection_relief', [methods(each([(i, i=1, m)], n))%name]))
    call table%add_index(axis('member', '', 'pinion or gear', members([(member, i=1, m)])))
    call table%add_index(axis('diameter_mm', 'mm', 'diameter on the flank', [(milli*diameter, i=1, m)]))
    call table%add('roll_deg', 'deg', 'roll angle there', [(roll/degree, i=1, m)])
    call table%add('relief_um', 'um', 'relief as the motion has it: linear or parabolic in the roll angle', [micro*along])
    call table%add('relief_by_diameter_um', 'um', 'relief of the same amount that grows in proportion to the diameter, as in '// &
                   'Eq. 1 of Thamba et al. 2020', [micro*straight])
  end subroutine fill_flank

  !> The diameters (m), and of which gear each is: those of the case, which must lie on the involute.
  subroutine find_places(stages, flank, diameter, member, error)
    type(stages_t), intent(in) :: stages
    type(flank_t), intent(in) :: flank(2)
    real(dp), allocatable, intent(out) :: diameter(:)
    integer, allocatable, intent(out) :: member(:)
    type(error_t), allocatable, intent(inout) :: error
    integer, parameter :: steps = 9
    real(dp), allocatable :: own(:)
    real(dp) :: start(2), tip
    integer :: i, k

    allocate (diameter(0), member(0))
    start = relief_start(stages%motions_inputs%motion%relief)
    do i = 1, 2
      associate (gear => stages%pair%gear(i))
        if (allocated(flank(i)%diameter)) then
          own = flank(i)%diameter
          k = findloc(own < 2*gear%form_radius(drive) .or. own > 2*gear%tip_radius, .true., 1)
          if (k > 0) call fail(error, code_input, '&deflection_relief '//trim(members(i))//'_diameter_mm = '//str(milli*own(k))// &
            ': must lie on the involute, from '//str(2*milli*gear%form_radius(drive))//' to '//str(2*milli*gear%tip_radius))
        else
          tip = path_place(stages%pair, i, gear%curvature(drive, gear%tip_form_radius))
          own = [(2*stages%pair%radius(i, start(i) + (tip - start(i))*k/steps), k=0, steps)]
        end if
      end associate
      diameter = [diameter, own]
      member = [member, spread(i, 1, size(own))]
    end do
  end subroutine find_places

  !> Path coordinate at which a gear touches with this radius of curvature (m).
  pure real(dp) function path_place(pair, member, curvature) result(s)
    type(pair_t), intent(in) :: pair
    integer, intent(in) :: member
    real(dp), intent(in) :: curvature

    s = (curvature - pair%curvature(member, 0.0_dp))/(pair%curvature(member, 1.0_dp) - pair%curvature(member, 0.0_dp))
  end function path_place
end module gearsweep_relief_flank
