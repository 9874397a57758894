!> What the task `rating` takes from a case: what Method B of the dynamic factor needs, the nominal stresses of both gears with what
!> they were made from, and how the pairs share the load at rest.
module gearsweep_rating_parts
  use gearsweep_dynamic_factor, only: counted_relief, deviations_of, grade_of, method_b_t, no_grade
  use gearsweep_error, only: error_t
  use gearsweep_flank_factors, only: flank_factors, flank_factors_t, nominal_flank_stress
  use gearsweep_form, only: deep_tooth_factor, iso_form, iso_form_t, nominal_root_stress, outer_single_contact
  use gearsweep_gear, only: drive
  use gearsweep_kinds, only: dp
  use gearsweep_load_factors, only: load_factors_t, rim_factor, root_face_load_factor
  use gearsweep_oscillator, only: oscillator_t
  use gearsweep_piecewise, only: piecewise_t
  use gearsweep_segments, only: balance_t, contact_intervals
  use gearsweep_sharing, only: share_load, sharing_t
  use gearsweep_stiffness, only: iso_stiffness
  use gearsweep_stages, only: stages_t
  implicit none
  private
  public :: accuracy_of_teeth_t, nominal_t, need_method_b, nominal_of, largest_share

  !> How exact the teeth are.
  type :: accuracy_of_teeth_t
    integer :: grade = 5                         !< of ISO 1328-1; stated deviations have their own
    real(dp) :: deviation(2) = -1                !< f_pb and f_f_alpha, m; below 0: by the grade
    real(dp) :: running_in = 0.075_dp            !< what it takes of the deviations
  end type accuracy_of_teeth_t

  !> The nominal stresses of both gears, and what they were made from.
  type :: nominal_t
    integer :: grade = no_grade                  !< accuracy grade that counts
    real(dp) :: load = 0                         !< F_t on the reference circle, N
    type(flank_factors_t) :: flank
    real(dp) :: contact = 0                      !< sigma_H0, Pa
    type(iso_form_t) :: form(2)
    real(dp) :: rim(2) = 1                       !< Y_B
    real(dp) :: deep = 1                         !< Y_DT
    real(dp) :: root(2) = 0                      !< sigma_F0, Pa
    real(dp) :: root_face_load = 1               !< K_F_beta
  end type nominal_t

contains

  !> What Method B needs, for each relief, and the accuracy grade that counts. Relief counts by its amount at the tips. `error`: the
  !> stiffness by ISO 6336 cannot be had.
  subroutine need_method_b(stages, accuracy, of, grade, error)
    type(stages_t), intent(in) :: stages
    type(accuracy_of_teeth_t), intent(in) :: accuracy
    type(method_b_t), allocatable, intent(out) :: of(:)    !< (relief)
    integer, intent(out) :: grade
    type(error_t), allocatable, intent(inout) :: error
    type(piecewise_t) :: stiffness
    type(method_b_t) :: one
    real(dp) :: deviation(2), diameter
    integer :: i

    grade = no_grade
    associate (pair => stages%pair, spec => stages%pair%gear%spec, width => minval(stages%pair%gear%spec%face_width))
      call iso_stiffness(pair, stages%material, stages%load/width, stiffness, error, stages%iso)
      if (allocated(error)) return
      ! The larger gear is allowed more.
      diameter = 2*maxval(pair%gear%reference_radius)
      deviation = deviations_of(accuracy%grade, spec(1)%module, diameter, spec(1)%pressure_angle(drive))
      deviation = merge(accuracy%deviation, deviation, accuracy%deviation >= 0)
      grade = grade_of(deviation, spec(1)%module, diameter, spec(1)%pressure_angle(drive))
      deviation = deviation*(1 - accuracy%running_in)
      one = method_b_t(spec(1)%teeth, pair%contact_ratio, single_stiffness=stiffness%maximum()/width, &
                       mass=product(stages%mass)/sum(stages%mass)/width, pitch_deviation=deviation(1), &
                       profile_deviation=deviation(2))
      one%mesh_stiffness = one%single_stiffness*(0.75_dp*pair%contact_ratio + 0.25_dp)
      one%line_load = tangential(stages)*stages%iso%application_factor/width
    end associate
    allocate (of(size(stages%amount)), source=one)
    do i = 1, size(of)
      of(i)%relief = counted_relief(stages%amount(i)*stages%motions_inputs%motion%relief%fraction, grade)
    end do
  end subroutine need_method_b

  !> F_t on the reference circle (N).
  pure real(dp) function tangential(stages) result(load)
    type(stages_t), intent(in) :: stages

    load = stages%load*cos(stages%pair%gear(1)%spec%pressure_angle(drive))
  end function tangential

  !> The nominal stresses, and what does not depend on the speed.
  pure type(nominal_t) function nominal_of(stages, factors, grade) result(nominal)
    type(stages_t), intent(in) :: stages
    type(load_factors_t), intent(in) :: factors
    integer, intent(in) :: grade                 !< accuracy grade that counts
    integer :: i

    associate (pair => stages%pair)
      nominal%grade = grade
      nominal%load = tangential(stages)
      nominal%flank = flank_factors(pair, [stages%material%young], [stages%material%poisson])
      nominal%contact = nominal_flank_stress(pair, nominal%flank, nominal%load)
      nominal%root_face_load = root_face_load_factor(pair, factors%face_load)
      nominal%deep = deep_tooth_factor(pair%contact_ratio, grade)
      do i = 1, 2
        associate (gear => pair%gear(i))
          nominal%form(i) = iso_form(gear, outer_single_contact(pair, i))
          nominal%rim(i) = rim_factor(stages%iso%rim_thickness(i), gear%tip_radius - gear%root_radius)
          nominal%root(i) = nominal_root_stress(pair, i, nominal%form(i), stages%load)*nominal%rim(i)*nominal%deep
        end associate
      end do
    end associate
  end function nominal_of

  !> The largest load of a pair at rest over the static load of the mesh.
  pure real(dp) function largest_share(motion) result(share)
    type(oscillator_t), intent(in) :: motion
    integer, parameter :: samples = 400
    type(sharing_t) :: sharing

    call share_load(motion%mesh, motion%load, samples, sharing, contact_intervals(motion%mesh, balance_t(motion%load)))
    share = maxval(sharing%load)/motion%load
  end function largest_share
end module gearsweep_rating_parts
