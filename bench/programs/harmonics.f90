!> Harmonics of the static transmission error, for bench/harmonics.py.
!>
!>     harmonics PROBLEM COUNT
!>
!> For each relief a line: seconds (the median of 101 runs), the amplitudes of the
!> first COUNT harmonics, m; after them the problem.
program harmonics
  use bench_problem, only: problem_t, read_problem, write_problem
  use bench_tools, only: word, number, seconds, median, numbers
  use gearsweep, only: dp
  use gearsweep_mesh_harmonics, only: find_harmonics, harmonics_t
  implicit none
  integer, parameter :: repeats = 101
  type(problem_t) :: problem
  type(harmonics_t) :: found
  real(dp) :: taken(repeats), from
  integer :: i, k

  call read_problem(word(1), problem)
  do i = 1, size(problem%osc)
    do k = 1, repeats
      from = seconds()
      call find_harmonics(problem%osc(i)%mesh, problem%osc(i)%load, number(2), found)
      taken(k) = seconds() - from
    end do
    print numbers, median(taken), found%amplitude
  end do
  call write_problem(problem%osc, problem%rpm)
end program harmonics
