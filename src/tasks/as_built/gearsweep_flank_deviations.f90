!> What a case says of one gear's flanks as made, and the profile errors on the line of action that follow.
!>
!> Deviations have the signs of ISO 1328-1: a single pitch deviation is positive where the pitch from the flank before, in the order
!> of the numbers, is too long; a profile slope or form deviation where there is more material to the tip or in the middle.
!> A flank that lies behind in the order of engagement touches late on the driving pinion and early on the driven gear.
module gearsweep_flank_deviations
  use gearsweep_deviations, only: deviations_t, make_deviations, wave_t
  use gearsweep_kinds, only: dp, pi
  use gearsweep_oscillator, only: oscillator_t
  use gearsweep_pair, only: pair_t
  use gearsweep_gear, only: drive
  use gearsweep_random_stream, only: random_stream_t
  use gearsweep_tolerances, only: tolerances_t
  implicit none
  private
  public :: flank_deviations_t, frame_t, make_frame, draw_deviations, lay_deviations, tooth_number, out_of_place, of_each

  type :: flank_deviations_t
    !> Along the measuring circle, m: of each pitch, or all of them up to a tooth; (tooth). Not both.
    real(dp), allocatable :: single_pitch(:), cumulative_pitch(:)
    real(dp), allocatable :: slope(:), form(:)   !< of the profile, m; one for all teeth, or (tooth)
    real(dp), allocatable :: measured(:, :)      !< error by the measured profile, c_n as in deviations_t, m; (0:degree, tooth)
    logical :: ascends = .true.                  !< teeth engage in the order of their numbers, not against it
    integer :: tooth = 1                         !< number of that which enters at A at the time 0
    real(dp) :: runout = 0                       !< twice the eccentricity, m
    real(dp) :: runout_phase = 0                 !< rad
    integer, allocatable :: wave_order(:)        !< waves over a turn
    real(dp), allocatable :: wave(:), wave_phase(:)        !< amplitude (m) and phase (rad)
  end type flank_deviations_t

  !> How deviations of flanks become errors on the line of action, of pinion and gear.
  type :: frame_t
    real(dp) :: along(2) = 1                     !< an arc of the measuring circle on the line of action
    real(dp) :: measured_at(2) = 0               !< path coordinate of the contact on the measuring circle
  end type frame_t

contains

  !> The frame of gears measured on their reference circles. Without gears, of a prescribed mesh, pitch is that on the line of
  !> action and measured at the pitch point.
  pure function make_frame(osc, pair) result(frame)
    type(oscillator_t), intent(in) :: osc
    type(pair_t), intent(in), optional :: pair
    type(frame_t) :: frame
    real(dp) :: angle
    integer :: i

    frame%measured_at = osc%mesh%pitch_point
    if (.not. present(pair)) return
    do i = 1, 2
      frame%along(i) = pair%gear(i)%base_radius(drive)/pair%gear(i)%reference_radius
      angle = acos(frame%along(i))
      frame%measured_at(i) = osc%mesh%pitch_point + merge(1, -1, i == 1)* &
                             (tan(angle) - tan(pair%working_angle(drive)))*pair%gear(i)%spec%teeth/(2*pi)
    end do
  end function make_frame

  !> Flanks drawn at random from a tolerance class. Normal distributions: positions of single flanks with the standard deviation
  !> f_p/(3 sqrt 2), so that 99.7 % of the pitches are within f_p; slopes, of a gear 0.25 f_Halpha and of each tooth beside it
  !> 0.2 f_Halpha; both parts of the eccentricity so that 99 % of the run-outs are within F_r.
  pure subroutine draw_deviations(tolerances, teeth, random, flanks)
    type(tolerances_t), intent(in) :: tolerances           !< um
    integer, intent(in) :: teeth
    type(random_stream_t), intent(inout) :: random
    type(flank_deviations_t), intent(inout) :: flanks      !< whose waves stay as they are told
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

  !> The errors of both gears' teeth in the order of engagement, for the gear's tooth that is `offset` behind the stated one.
  pure function lay_deviations(flanks, frame, teeth, contact_ratio, offset) result(deviations)
    type(flank_deviations_t), intent(in) :: flanks(2)      !< of pinion and gear
    type(frame_t), intent(in) :: frame
    integer, intent(in) :: teeth(2)
    real(dp), intent(in) :: contact_ratio
    integer, intent(in) :: offset
    type(deviations_t) :: deviations
    type(wave_t), allocatable :: waves(:)
    real(dp), allocatable :: pinion(:, :), gear(:, :)
    integer :: i, k

    call lay_teeth(flanks(1), frame, 1, teeth(1), contact_ratio, pinion)
    call lay_teeth(flanks(2), frame, 2, teeth(2), contact_ratio, gear)
    allocate (waves(0))
    do i = 1, 2
      associate (own => flanks(i))
        if (abs(own%runout) > 0) waves = [waves, wave_t(i, 1, own%runout/2, own%runout_phase)]
        if (allocated(own%wave_order)) waves = [waves, (wave_t(i, own%wave_order(k), own%wave(k), own%wave_phase(k)), &
                                                  k=1, size(own%wave_order))]
      end associate
    end do
    deviations = make_deviations(teeth, pinion, gear, waves, offset)
  end function lay_deviations

  !> c_n of each tooth of a gear in the order of engagement (m), (0:degree, tooth); no tooth where none deviates.
  pure subroutine lay_teeth(flanks, frame, gear, teeth, contact_ratio, c)
    type(flank_deviations_t), intent(in) :: flanks
    type(frame_t), intent(in) :: frame
    integer, intent(in) :: gear, teeth
    real(dp), intent(in) :: contact_ratio
    real(dp), allocatable, intent(out) :: c(:, :)
    real(dp), dimension(teeth) :: form, late, slope
    integer :: degree, i, tooth

    degree = 2
    if (allocated(flanks%measured)) degree = max(degree, ubound(flanks%measured, 1))
    if (.not. (allocated(flanks%single_pitch) .or. allocated(flanks%cumulative_pitch) .or. allocated(flanks%slope) .or. &
               allocated(flanks%form) .or. allocated(flanks%measured))) then
      allocate (c(0:degree, 0))
      return
    end if
    allocate (c(0:degree, teeth), source=0.0_dp)
    late = merge(1, -1, flanks%ascends)*out_of_place(flanks, teeth)
    slope = merge(-1, 1, gear == 1)*of_each(flanks%slope, teeth)/contact_ratio
    form = of_each(flanks%form, teeth)
    do i = 1, teeth
      tooth = tooth_number(flanks, teeth, i - 1)
      c(0, i) = merge(1, -1, gear == 1)*frame%along(gear)*late(tooth)
      c(0, i) = c(0, i) + slope(tooth)*(contact_ratio/2 - frame%measured_at(gear)) - form(tooth)/3
      c(1, i) = slope(tooth)
      c(2, i) = 4*form(tooth)/contact_ratio**2
      if (allocated(flanks%measured)) c(:, i) = c(:, i) + flanks%measured(:, tooth)
    end do
  end subroutine lay_teeth

  !> How far each flank is out of place in the direction of counting (m), (tooth).
  pure function out_of_place(flanks, teeth) result(position)
    type(flank_deviations_t), intent(in) :: flanks
    integer, intent(in) :: teeth
    real(dp) :: position(teeth)
    integer :: i

    position = 0
    if (allocated(flanks%single_pitch)) position = [(sum(flanks%single_pitch(:i)), i=1, teeth)]
    if (allocated(flanks%cumulative_pitch)) position = flanks%cumulative_pitch
  end function out_of_place

  !> What is told of all teeth, of each or not at all, of each; (tooth).
  pure function of_each(told, teeth) result(values)
    real(dp), allocatable, intent(in) :: told(:)
    integer, intent(in) :: teeth
    real(dp) :: values(teeth)
    integer :: i

    values = 0
    if (allocated(told)) values = told([(min(i, size(told)), i=1, teeth)])
  end function of_each

  !> The number of the tooth that engages so many teeth behind the stated one.
  pure integer function tooth_number(flanks, teeth, behind)
    type(flank_deviations_t), intent(in) :: flanks
    integer, intent(in) :: teeth, behind

    tooth_number = 1 + modulo(flanks%tooth - 1 + merge(behind, -behind, flanks%ascends), teeth)
  end function tooth_number
end module gearsweep_flank_deviations
