!> Error estimates of statics from both sides: against what a much finer grid or a closed form gives, they may neither be
!> too small nor too large throughout.
module test_static_estimates
  use gearsweep_mesh_harmonics, only: find_harmonics, harmonics_t
  use gearsweep_base_kinds, only: dp
  use gearsweep_motion_oscillator, only: oscillator_t
  use gearsweep_base_piecewise, only: piecewise_t, polynomial
  use gearsweep_base_text, only: str
  use test_support_ask_by_name, only: answer_t, ask
  use test_support_reference_rows, only: prescribed
  use test_support_gears, only: stated_t, examples, text_of
  use test_support_testing, only: tally_t, check_true, check_close
  implicit none
  private
  public :: run

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('root_stress')) call root_stress(t)
    if (t%wants('harmonics')) call harmonics(t)
  end subroutine run

  !> Both peaks on coarse grids, beside those of a grid three times as fine or more: twice the estimate is exceeded by one in
  !> fifteen at most; the middle one of all ratios of error to estimate lies between a fifth and one.
  subroutine root_stress(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: across(3) = [4, 6, 8], fine = 24
    type(stated_t) :: list(5)
    real(dp) :: ratio(3, 5), truth(2), estimate
    integer :: n, k

    list = examples()
    do n = 1, 5
      call peaks(fine, truth, estimate)
      do k = 1, size(across)
        ratio(k, n) = error_ratio(across(k))
      end do
    end do
    call check_true(t, 'root stress: hardly any beyond twice the estimate', count(ratio > 2) <= 1, str(maxval(ratio)))
    call check_true(t, 'root stress: estimates are not too small', middle(ratio) < 1, str(middle(ratio)))
    call check_true(t, 'root stress: estimates are not too large', middle(ratio) > 0.2_dp, str(middle(ratio)))

  contains

    subroutine peaks(elements, peak, estimate)
      integer, intent(in) :: elements
      real(dp), intent(out) :: peak(2), estimate
      type(answer_t) :: answer

      call ask(t, '&case tasks=''static'' / '//text_of(list(n))//'&mesh model=''iso6336'' / &load line_load_n_mm=210 / '// &
               '&section elements_across='//str(elements)//' / &static positions=3 /', answer)
      peak = [answer%one('root_stress.tension_mpa'), answer%one('root_stress.compression_mpa')]
      estimate = answer%one('root_stress.error_estimate')
    end subroutine peaks

    real(dp) function error_ratio(elements)
      integer, intent(in) :: elements
      real(dp) :: peak(2), estimate

      call peaks(elements, peak, estimate)
      call check_true(t, 'root stress: an estimate', estimate > 0 .and. estimate < 0.3_dp)
      error_ratio = maxval(abs(peak/truth - 1))/max(estimate, tiny(estimate))
    end function error_ratio
  end subroutine root_stress

  !> The value with as many above as below.
  pure real(dp) function middle(values)
    real(dp), intent(in) :: values(:, :)
    real(dp) :: list(size(values))
    integer :: k

    list = reshape(values, [size(values)])
    middle = minval(list, mask=[(2*count(list <= list(k)) > size(list), k=1, size(list))])
  end function middle

  !> Of three curves of stiffness and a pair that parts shortly: the estimate is never 0 where the transmission error is curved,
  !> nor beyond what the integration is asked for, 1e-12 of the mean; so good is the mean, which has a closed form where
  !> the stiffness is constant and the relief e = e_0 - c (s - s_0)**2 parts a pair over a length of 2 w.
  subroutine harmonics(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: load = 6000, single = 15e-6_dp
    type(oscillator_t) :: osc
    type(harmonics_t) :: ste
    type(piecewise_t) :: relief
    real(dp) :: at, w, c, top, mean
    integer :: k, n

    do k = 1, 9
      at = 0.3375_dp + 0.001_dp*k
      w = 0.004_dp*k**0.6_dp
      c = single/at**2
      top = single + c*w**2
      call prescribed(1.6_dp, [400.0_dp], [0.0_dp, 0.0_dp], 1, osc)
      relief = polynomial(0.0_dp, 0.6_dp, [top - c*(0.3_dp - at)**2, -2*c*(0.3_dp - at)*0.3_dp, -c*0.3_dp**2])
      osc%mesh%profile_error%breaks = [0.0_dp, 0.6_dp, 1.6_dp]
      osc%mesh%profile_error%coef = reshape([relief%coef(:, 1), 0.0_dp, 0.0_dp, 0.0_dp], [3, 2])
      call find_harmonics(osc%mesh, load, 4, ste)
      ! Two pairs deflect (F/K + e)/2, one F/K: what the parting takes off is half a parabola's area.
      mean = single*0.4_dp + (single*0.6_dp + top*0.6_dp - c*((0.6_dp - at)**3 + at**3)/3)/2 - 2*w/3*(top - single)
      call check_close(t, 'mean with a parting', ste%mean, mean, 1e-12_dp)
      call check_estimate('a pair that parts')
    end do
    do n = 1, 3
      call prescribed(1.6_dp, [400.0_dp, 0.0_dp, -130.0_dp*n], [4.0_dp, 9.0_dp], 2, osc)
      do k = 4, 40, 12
        call find_harmonics(osc%mesh, load, k, ste)
        call check_estimate('curved stiffness')
      end do
    end do

  contains

    subroutine check_estimate(name)
      character(*), intent(in) :: name

      call check_true(t, 'harmonics, '//name//': the estimate is not 0', ste%error_estimate > 0)
      call check_true(t, 'harmonics, '//name//': nor more than was asked for', ste%error_estimate < 1e-12_dp*ste%mean, &
                      str(ste%error_estimate/ste%mean))
    end subroutine check_estimate
  end subroutine harmonics
end module test_static_estimates
