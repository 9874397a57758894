!> Natural frequencies and root stress of random gear bodies with their error estimates, for bench/honesty_bodies.py.
!>
!>     honesty_bodies asked|true|asked_stress|true_stress FIRST LAST
!>
!> A line for each body, on its grid or on one three to four times as fine: number, teeth in the section (0: whole gear),
!> bore over root radius, elements across the tooth; tension, compression (Pa) and their estimate; frequencies (Hz) and
!> their estimates. With `stress`: sections only, every second body, and no frequencies.
program honesty_bodies
  use, intrinsic :: iso_fortran_env, only: output_unit
  use bench_tools, only: check, number, numbers, word
  use gearsweep_base_error, only: error_t
  use gearsweep_base_kinds, only: dp
  use gearsweep_elastic_material, only: material_t
  use gearsweep_elastic_modes, only: modal_t, section_modes
  use gearsweep_elastic_section, only: make_two_grids, section_body_t
  use gearsweep_elastic_stress, only: root_stress, root_stress_t
  use test_properties_random_bodies, only: random_body_t, random_body
  implicit none
  integer, parameter :: modes = 8, most_section = 10, most_whole = 6, finest_section = 30, finest_whole = 20
  integer :: i
  logical :: of_stress

  of_stress = index(word(1), '_stress') > 0
  do i = number(2), number(3), merge(2, 1, of_stress)
    call one_body(i)
  end do

contains

  subroutine one_body(i)
    integer, intent(in) :: i
    type(random_body_t) :: body
    type(section_body_t) :: grids(2)
    type(error_t), allocatable :: error
    type(modal_t) :: modal
    type(root_stress_t) :: stress

    call random_body(i, most_section, most_whole, body)
    associate (options => body%options, across => body%options%elements_across)
      if (index(word(1), 'true') == 1) across = min(4*across, merge(finest_whole, finest_section, options%teeth == 0))
      call make_two_grids(body%gear, material_t(), options, grids, error)
      call check(error)
      call root_stress(grids, [body%radius], [1e5_dp], stress, error)
      call check(error)
      if (of_stress) then
        write (output_unit, numbers) i, options%teeth, body%bore_share, across, stress%tension%stress, &
          stress%compression%stress, stress%error_estimate
        return
      end if
      call section_modes(grids, modes, modal, error)
      call check(error)
      write (output_unit, numbers) i, options%teeth, body%bore_share, across, stress%tension%stress, &
        stress%compression%stress, stress%error_estimate, modal%modes%frequency, modal%error_estimate
    end associate
  end subroutine one_body
end program honesty_bodies
