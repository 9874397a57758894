!> Kinds of numbers, errors, texts, tables, polynomials, solvers, memory and the operating system.
!>
!> Other rooms use this module, and none of the room's own modules.
module gearsweep_base
  ! Lowest eigenvalues of K u = lambda M u by ARPACK, implicitly restarted Lanczos method in shift-invert mode.
  use gearsweep_base_arpack, only: lowest_eigenpairs, pencil_t, residual_of, work_bytes
  ! Interval that contains a zero, bisected or narrowed by the Illinois method.
  use gearsweep_base_bracket, only: bracket_t
  ! Numbers as text, digit for digit as Fortran's ES editing rounds them, but many times as fast.
  use gearsweep_base_decimal, only: write_decimal
  ! Errors as values.
  use gearsweep_base_error, only: code_file, code_input, code_memory, code_numerical, code_ok, code_partial, code_stopped, &
    code_usage, error_t, fail
  ! The working precision and the constants that follow from it.
  use gearsweep_base_kinds, only: dp, pi
  ! Interfaces of LAPACK.
  use gearsweep_base_lapack, only: dgesv, dposv, zpotrf, zpotrs
  ! A text that grows in linear time.
  use gearsweep_base_lines, only: left, lines_t, right
  ! Protection of a call.
  use gearsweep_base_memory, only: bring_traps_back, claim_memory, has_memory, leader_traps, release_claim, set_traps_aside, &
    share_traps, team, wants_stop
  ! Piecewise polynomials.
  use gearsweep_base_piecewise, only: constant, interpolated, joined, piecewise_t, polynomial, spline
  ! Gauss-Legendre quadrature.
  use gearsweep_base_quadrature, only: gauss_legendre
  ! The polynomial of fifth degree through value, first and second derivative at both ends of a step.
  use gearsweep_base_quintic, only: bounds_of, derivative_of, evaluate, first_zero, maximum_of, may_cross_zero, over_part, &
    place_of_largest, quintic, value_of
  ! Random numbers that are the same on every machine.
  use gearsweep_base_random_stream, only: begin_stream, random_stream_t
  ! Systems of a few linear equations, solved at each place of a motion.
  use gearsweep_base_small_system, only: solve_small
  ! Numbers in ascending order, by LAPACK.
  use gearsweep_base_sorting, only: sorted
  ! Sparse symmetric positive definite matrices.
  use gearsweep_base_sparse, only: elements_t, factor, factor_inner, sparse_t
  ! Interfaces to the operating system and to BLAS.
  use gearsweep_base_system, only: add_file, begin_files, begin_products, close_file, end_files, end_products, &
    hold_blas, make_folder_at, open_file, print_text, read_file, reason_of, release_blas, remove_folder_at, show_files, &
    stopwatch_t
  ! Table of results.
  use gearsweep_base_table, only: axis, column_t, csv_start, each, kind_integer, kind_real, kind_text, no_number, table_t, &
    write_csv
  ! Text helpers for messages, tables and readers, and names of characters that cannot be seen.
  use gearsweep_base_text, only: closest_word, find_control, find_odd, first_control, fixed, join, lower, shown, split, str, &
    to_number, utf8, visible, with_blanks
  ! The lines of a text, and the reader of all tables.
  use gearsweep_base_text_rows, only: find_rows, rows_t
  ! The units of keys and columns.
  use gearsweep_base_units, only: in_si
  ! The version, as in fpm.toml.
  use gearsweep_base_version, only: version
  implicit none
  public
end module gearsweep_base
