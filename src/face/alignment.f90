!> Gap between the flanks of a pair over the face width: misalignment, lead slope, crowning and end relief.
module gearsweep_face_alignment
  use gearsweep_base, only: code_input, dp, error_t, fail, str
  implicit none
  private
  public :: lead_t, alignment_t, check_alignment

  !> Flank modification of one gear along its face.
  type :: lead_t
    real(dp) :: slope = 0                        !< lead slope over the face width: material missing at its end z = b, m
    real(dp) :: crowning = 0                     !< height of a parabola: material missing at both ends, m
    real(dp) :: end_relief = 0                   !< amount of linear end relief at both ends, m
    real(dp) :: end_relief_length = 0            !< length of it from each end, m
  end type lead_t

  !> How two faces meet.
  type :: alignment_t
    !> Misalignment on the line of action over the face width, m; positive: the flanks are nearer at z = 0.
    real(dp) :: misalignment = 0
    type(lead_t) :: lead(2)                      !< of pinion and gear
  contains
    procedure :: slope
    procedure :: gap
  end type alignment_t

  real(dp), parameter :: most_gap = 1e-3_dp, most_tilt = 0.1_dp

contains

  !> Misalignment with the lead slopes of both gears, m.
  pure real(dp) function slope(alignment)
    class(alignment_t), intent(in) :: alignment

    slope = alignment%misalignment + sum([alignment%lead%slope])
  end function slope

  !> Gap (m) of the unloaded flanks at distances `z` (m) along the face `width` (m).
  elemental real(dp) function gap(alignment, width, z)
    class(alignment_t), intent(in) :: alignment
    real(dp), intent(in) :: width, z
    integer :: i

    associate (f => alignment%slope())
      if (f >= 0) then
        gap = f*z/width
      else
        gap = -f*(width - z)/width
      end if
    end associate
    do i = 1, 2
      associate (lead => alignment%lead(i))
        gap = gap + lead%crowning*((2*z - width)/width)**2
        if (lead%end_relief_length > 0) gap = gap &
          + lead%end_relief*max(0.0_dp, 1 - min(z, width - z)/lead%end_relief_length)
      end associate
    end do
  end function gap

  !> Refuses gaps that are no deviations of gears any more, and end reliefs that overlap.
  pure subroutine check_alignment(alignment, width, error)
    type(alignment_t), intent(in) :: alignment
    real(dp), intent(in) :: width                !< m
    type(error_t), allocatable, intent(inout) :: error
    character(6), parameter :: names(2) = ['pinion', 'gear  ']
    integer :: i

    associate (f => alignment%slope())
      if (.not. abs(f) <= min(most_gap, most_tilt*width)) call fail(error, code_input, &
        'misalignment and lead slopes (um) = '//str(1e6_dp*f)//' together: must be from '// &
        str(-1e6_dp*min(most_gap, most_tilt*width))//' to '//str(1e6_dp*min(most_gap, most_tilt*width)))
    end associate
    do i = 1, 2
      associate (lead => alignment%lead(i))
        if (.not. abs(lead%crowning) <= most_gap) call fail(error, code_input, trim(names(i))//' crowning (um) = '// &
          str(1e6_dp*lead%crowning)//': must be from '//str(-1e6_dp*most_gap)//' to '//str(1e6_dp*most_gap))
        if (.not. (lead%end_relief >= 0 .and. lead%end_relief <= most_gap)) call fail(error, code_input, &
          trim(names(i))//' end relief (um) = '//str(1e6_dp*lead%end_relief)//': must be from 0 to '//str(1e6_dp*most_gap))
        if (.not. (lead%end_relief_length >= 0 .and. lead%end_relief_length <= width/2)) call fail(error, code_input, &
          trim(names(i))//' end relief length (mm) = '//str(1e3_dp*lead%end_relief_length)//': must be from 0 to half of '// &
          'the face width, '//str(500*width)//' mm')
        if (lead%end_relief > 0 .and. .not. lead%end_relief_length > 0) call fail(error, code_input, &
          trim(names(i))//' end relief (um) = '//str(1e6_dp*lead%end_relief)//': needs a length')
      end associate
    end do
  end subroutine check_alignment
end module gearsweep_face_alignment
