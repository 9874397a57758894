!> The body behind the teeth as far as mass and stiffness know it: a solid disc, or a rim on a web.
module gearsweep_blank
  use gearsweep_gear, only: coast, drive, gear_t
  use gearsweep_kinds, only: dp, pi
  use gearsweep_outline, only: fillet_point, involute_point, root_angle
  implicit none
  private
  public :: has_web, web_inertia

  integer, parameter :: steps = 400              !< along a fillet or a flank

contains

  !> Is there a web between the rim (thickness below the root circle, m) and the bore that is narrower than the teeth?
  !> `web`: its thickness, m; 0 where none is stated.
  pure logical function has_web(gear, web, rim)
    type(gear_t), intent(in) :: gear
    real(dp), intent(in) :: web, rim

    has_web = web > 0 .and. web < gear%spec%face_width .and. rim > 0 .and. rim < gear%root_radius - gear%spec%bore_radius
  end function has_web

  !> Polar moment of inertia (kg m^2) of teeth, rim and web: that within the true outline, without reliefs and chamfers, less the
  !> bore and less what the web, from the bore to the rim, is narrower than the teeth. `density` in kg/m^3.
  pure real(dp) function web_inertia(gear, web, rim, density) result(inertia)
    type(gear_t), intent(in) :: gear
    real(dp), intent(in) :: web, rim, density

    associate (bore => pi/2*gear%spec%bore_radius**4, gap => pi/2*(gear%root_radius - rim)**4)
      inertia = density*(gear%spec%face_width*(outline_moment(gear) - bore) - (gear%spec%face_width - web)*(gap - bore))
    end associate
  end function web_inertia

  !> Polar second moment (m^4) of the area within the outline: the integral of r^4/4 over the angle, all around.
  pure real(dp) function outline_moment(gear) result(moment)
    type(gear_t), intent(in) :: gear
    real(dp) :: point(2, 0:2*steps), radius(0:2*steps), angle(0:2*steps), land
    integer :: side, i

    moment = 0
    land = 2*pi/gear%spec%teeth
    do side = drive, coast
      do i = 0, steps
        associate (share => real(i, dp)/steps)
          point(:, i) = fillet_point(gear, side, pi/2 + (gear%fillet_start(side) - pi/2)*share)
          point(:, steps + i) = involute_point(gear, side, (1 - share)*gear%form_radius(side) + share*gear%tip_radius)
        end associate
      end do
      radius = norm2(point, 1)
      angle = atan2(point(1, :), point(2, :))
      moment = moment + sum((radius(:2*steps - 1)**4 + radius(1:)**4)/2*(angle(:2*steps - 1) - angle(1:))) &
               + radius(2*steps)**4*angle(2*steps)
      land = land - root_angle(gear, side)
    end do
    moment = gear%spec%teeth*(moment + gear%root_radius**4*land)/4
  end function outline_moment
end module gearsweep_blank
