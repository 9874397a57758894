!> Stated or drawn flank deviations of one gear, and the profile errors on the line of action that follow.
!>
!> Deviations have the signs of ISO 1328-1: a single pitch deviation is positive if the pitch from the previous flank, in the order
!> of the numbers, is too long; a profile slope or form deviation if there is more material at the tip or in the middle. A flank
!> displaced backwards in the order of engagement engages late on the driving pinion and early on the driven gear. The coast flank
!> of its tooth is early or late by the same amount.
module gearsweep_mesh_flank_deviations
  use gearsweep_base, only: dp, pi, random_stream_t
  use gearsweep_gear, only: coast, drive, pair_t, tolerances_t
  use gearsweep_mesh_deviations, only: deviations_t, make_deviations, wave_t
  use gearsweep_mesh_mesh, only: mesh_t
  implicit none
  private
  public :: flank_deviations_t, frame_t, make_frame, draw_deviations, is_within, place_deviations, tooth_number, &
    pitch_position, coast_pitch_position, per_tooth

  type :: flank_deviations_t
    !> Single or cumulative pitch deviation on the measuring circle, m; (tooth). Not both.
    real(dp), allocatable :: single_pitch(:), cumulative_pitch(:)
    !> Cumulative pitch deviation of the coast flanks, m; (tooth). Not allocated: each tooth displaces both its flanks.
    real(dp), allocatable :: coast_pitch(:)
    real(dp), allocatable :: slope(:), form(:)   !< profile slope and form deviations, m; one for all teeth, or (tooth)
    real(dp), allocatable :: measured(:, :)      !< error by the measured profile, c_n as in deviations_t, m; (0:degree, tooth)
    logical :: ascends = .true.                  !< true: teeth engage in the order of their numbers; false: in reverse order
    integer :: tooth = 1                         !< number of the tooth that enters at A at the time 0
    real(dp) :: runout = 0                       !< twice the eccentricity, m
    real(dp) :: runout_phase = 0                 !< phase of the run-out, rad
    integer, allocatable :: wave_order(:)        !< waves per revolution
    real(dp), allocatable :: wave(:), wave_phase(:)        !< amplitude (m) and phase (rad)
  end type flank_deviations_t

  !> Conversion of the flank deviations of pinion and gear to errors on the line of action.
  type :: frame_t
    real(dp) :: along(2) = 1                     !< length on the line of action per arc of the measuring circle
    real(dp) :: measured_at(2) = 0               !< path coordinate of the contact on the measuring circle
    real(dp) :: between_lines = 0                !< angle between the lines of action of drive and coast flanks, rad
    real(dp) :: coast_part = 1                   !< transmission error per length on the line of action of the coast flanks
  end type frame_t

contains

  !> Builds the frame of gears measured on their reference circles. Without gears, for a prescribed mesh, pitch is that on the line
  !> of action and measured at the pitch point.
  pure function make_frame(mesh, pair) result(frame)
    type(mesh_t), intent(in) :: mesh
    type(pair_t), intent(in), optional :: pair
    type(frame_t) :: frame
    real(dp) :: angle
    integer :: i

    frame%measured_at = mesh%pitch_point
    frame%between_lines = 2*atan(mesh%tan_angle)
    if (.not. present(pair)) return
    frame%between_lines = sum(pair%working_angle)
    frame%coast_part = cos(pair%working_angle(drive))/cos(pair%working_angle(coast))
    do i = 1, 2
      frame%along(i) = pair%gear(i)%base_radius(drive)/pair%gear(i)%reference_radius
      angle = acos(frame%along(i))
      frame%measured_at(i) = mesh%pitch_point + merge(1, -1, i == 1)* &
                             (tan(angle) - tan(pair%working_angle(drive)))*pair%gear(i)%spec%teeth/(2*pi)
    end do
  end function make_frame

  !> Draws flanks at random from a tolerance class. Normal distributions: positions of single flanks with the standard deviation
  !> f_p/(3 sqrt 2), so that 99.7 % of the pitches are within f_p; slopes, of a gear 0.25 f_Halpha and of each tooth additionally
  !> 0.2 f_Halpha; both components of the eccentricity so that 99 % of the run-outs are within F_r.
  pure subroutine draw_deviations(tolerances, teeth, random, flanks)
    type(tolerances_t), intent(in) :: tolerances           !< tolerances, um
    integer, intent(in) :: teeth
    type(random_stream_t), intent(inout) :: random
    type(flank_deviations_t), intent(inout) :: flanks      !< its waves remain as stated
    real(dp), parameter :: um = 1e-6_dp
    real(dp) :: position(teeth), common(1), own(teeth), part(2)

    call random%draw_normal(position)
    call random%draw_normal(common)
    call random%draw_normal(own)
    call random%draw_normal(part)
    flanks%cumulative_pitch = um*tolerances%single_pitch/(3*sqrt(2.0_dp))*position
    flanks%slope = um*tolerances%profile_slope*(0.25_dp*common(1) + 0.2_dp*own)
    flanks%runout = um*tolerances%runout*hypot(part(1), part(2))/sqrt(-2*log(0.01_dp))
    flanks%runout_phase = atan2(part(2), part(1))
  end subroutine draw_deviations

  !> True if an inspection by ISO 1328-1 would accept these flanks, whose teeth are numbered in the order of engagement: single and
  !> cumulative pitch, measured about the axis and so including run-out; profile slopes; run-out, as twice the eccentricity.
  pure logical function is_within(flanks, tolerances, frame, gear)
    type(flank_deviations_t), intent(in) :: flanks         !< drawn flanks
    type(tolerances_t), intent(in) :: tolerances           !< tolerances, um
    type(frame_t), intent(in) :: frame
    integer, intent(in) :: gear                  !< 1: pinion, 2: gear
    real(dp), parameter :: um = 1e-6_dp
    real(dp), dimension(size(flanks%cumulative_pitch)) :: place
    integer :: i, n

    n = size(place)
    place = flanks%cumulative_pitch + merge(1, -1, gear == 1)*flanks%runout/(2*frame%along(gear))* &
            sin(flanks%runout_phase + [(2*pi*(i - 1 + frame%measured_at(gear))/n, i=1, n)])
    is_within = maxval(abs(place - cshift(place, -1))) <= um*tolerances%single_pitch .and. &
                maxval(place) - minval(place) <= um*tolerances%cumulative_pitch .and. &
                maxval(abs(flanks%slope)) <= um*tolerances%profile_slope .and. flanks%runout <= um*tolerances%runout
  end function is_within

  !> Computes the errors of both gears' teeth in the order of engagement, if the gear's tooth `offset` after the stated one meshes.
  pure function place_deviations(flanks, frame, teeth, contact_ratio, offset) result(deviations)
    type(flank_deviations_t), intent(in) :: flanks(2)      !< flanks of pinion and gear
    type(frame_t), intent(in) :: frame
    integer, intent(in) :: teeth(2)
    real(dp), intent(in) :: contact_ratio
    integer, intent(in) :: offset
    type(deviations_t) :: deviations
    type(wave_t), allocatable :: waves(:), coast_waves(:)
    real(dp), allocatable :: pinion(:, :), gear(:, :), pinion_place(:), gear_place(:)
    integer :: i, k

    call find_tooth_errors(flanks(1), frame, 1, teeth(1), contact_ratio, pinion, pinion_place)
    call find_tooth_errors(flanks(2), frame, 2, teeth(2), contact_ratio, gear, gear_place)
    allocate (waves(0), coast_waves(0))
    do i = 1, 2
      associate (own => flanks(i))
        if (abs(own%runout) > 0) then
          waves = [waves, wave_t(i, 1, own%runout/2, own%runout_phase)]
          ! The centre of an eccentric gear moves along a circle. The normals of drive and coast flanks have opposite directions but
          ! for the angle between the lines of action; the gears rotate in opposite directions.
          coast_waves = [coast_waves, wave_t(i, 1, -frame%coast_part*own%runout/2, &
                                             own%runout_phase + merge(-1, 1, i == 1)*frame%between_lines)]
        end if
        if (allocated(own%wave_order)) waves = [waves, (wave_t(i, own%wave_order(k), own%wave(k), own%wave_phase(k)), &
                                                  k=1, size(own%wave_order))]
      end associate
    end do
    deviations = make_deviations(teeth, pinion, gear, waves, offset, pinion_place, gear_place, coast_waves)
  end function place_deviations

  !> Computes c_n of each tooth of a gear in the order of engagement (m), (0:degree, tooth), and the distance by which its coast
  !> flank is closer to its mate, the part of c_0 from the tooth's position; no teeth if none deviates.
  pure subroutine find_tooth_errors(flanks, frame, gear, teeth, contact_ratio, c, place)
    type(flank_deviations_t), intent(in) :: flanks
    type(frame_t), intent(in) :: frame
    integer, intent(in) :: gear, teeth
    real(dp), intent(in) :: contact_ratio
    real(dp), allocatable, intent(out) :: c(:, :), place(:)
    real(dp), dimension(teeth) :: coast_late, form, late, slope
    integer :: degree, i, tooth

    degree = 2
    if (allocated(flanks%measured)) degree = max(degree, ubound(flanks%measured, 1))
    if (.not. (allocated(flanks%single_pitch) .or. allocated(flanks%cumulative_pitch) .or. allocated(flanks%slope) .or. &
               allocated(flanks%form) .or. allocated(flanks%measured) .or. allocated(flanks%coast_pitch))) then
      allocate (c(0:degree, 0), place(0))
      return
    end if
    allocate (c(0:degree, teeth), place(teeth), source=0.0_dp)
    late = merge(1, -1, flanks%ascends)*pitch_position(flanks, teeth)
    coast_late = merge(1, -1, flanks%ascends)*coast_pitch_position(flanks, teeth)
    slope = merge(-1, 1, gear == 1)*per_tooth(flanks%slope, teeth)/contact_ratio
    form = per_tooth(flanks%form, teeth)
    do i = 1, teeth
      tooth = tooth_number(flanks, teeth, i - 1)
      place(i) = merge(1, -1, gear == 1)*frame%along(gear)*coast_late(tooth)
      c(0, i) = merge(1, -1, gear == 1)*frame%along(gear)*late(tooth)
      c(0, i) = c(0, i) + slope(tooth)*(contact_ratio/2 - frame%measured_at(gear)) - form(tooth)/3
      c(1, i) = slope(tooth)
      c(2, i) = 4*form(tooth)/contact_ratio**2
      if (allocated(flanks%measured)) c(:, i) = c(:, i) + flanks%measured(:, tooth)
    end do
  end subroutine find_tooth_errors

  !> Position error of each flank in the direction of counting (m), (tooth).
  pure function pitch_position(flanks, teeth) result(position)
    type(flank_deviations_t), intent(in) :: flanks
    integer, intent(in) :: teeth
    real(dp) :: position(teeth)
    integer :: i

    position = 0
    if (allocated(flanks%single_pitch)) position = [(sum(flanks%single_pitch(:i)), i=1, teeth)]
    if (allocated(flanks%cumulative_pitch)) position = flanks%cumulative_pitch
  end function pitch_position

  !> Position error of each coast flank. If stated separately, they have the mean of the drive flanks: a difference of the means is
  !> the tooth thickness, which the backlash covers.
  pure function coast_pitch_position(flanks, teeth) result(position)
    type(flank_deviations_t), intent(in) :: flanks
    integer, intent(in) :: teeth
    real(dp) :: position(teeth)

    position = pitch_position(flanks, teeth)
    if (allocated(flanks%coast_pitch)) position = flanks%coast_pitch + sum(position - flanks%coast_pitch)/teeth
  end function coast_pitch_position

  !> Values of each tooth from one value for all teeth, one for each, or none (0); (tooth).
  pure function per_tooth(stated, teeth) result(values)
    real(dp), allocatable, intent(in) :: stated(:)
    integer, intent(in) :: teeth
    real(dp) :: values(teeth)
    integer :: i

    values = 0
    if (allocated(stated)) values = stated([(min(i, size(stated)), i=1, teeth)])
  end function per_tooth

  !> Number of the tooth that engages `later` teeth after the stated one.
  pure integer function tooth_number(flanks, teeth, later)
    type(flank_deviations_t), intent(in) :: flanks
    integer, intent(in) :: teeth, later

    tooth_number = 1 + modulo(flanks%tooth - 1 + merge(later, -later, flanks%ascends), teeth)
  end function tooth_number
end module gearsweep_mesh_flank_deviations
