!> The flat layer for C: the same calls as gs_..., named gsc_..., which return
!> the code. The header gearsweep.h describes them.
module gearsweep_c
  use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_double, c_f_pointer, c_int, c_null_char, c_ptr, &
                                         c_size_t
  use gearsweep_calls
  use gearsweep_error, only: code_input, code_memory, code_ok
  implicit none
  private
  public :: gsc_version, gsc_sizes, gsc_geometry, gsc_prepare, gsc_motion, gsc_mesh, gsc_sweep, gsc_optimum
  public :: gsc_resonances, gsc_load, gsc_modes, gsc_root, gsc_report

  !> Longest message; longest text and answer.
  integer, parameter :: longest_message = 1000
  integer(c_size_t), parameter :: longest_text = 10**9

contains

  function gsc_sizes(text, text_length, speeds, reliefs, rows, tried, positions, modes, nwork, message, &
                     message_size) result(info) bind(c)
    type(c_ptr), value :: text, message
    integer(c_size_t), value :: text_length, message_size
    integer(c_int), intent(inout), optional :: speeds, reliefs, rows, tried, positions, modes, nwork
    integer(c_int) :: info
    character(:), allocatable :: case
    character(longest_message) :: words

    call take_text(text, text_length, case, info, words)
    call need_all([present(speeds), present(reliefs), present(rows), present(tried), present(positions), &
                   present(modes), present(nwork)], info, words)
    if (info == code_ok) call gs_sizes(case, speeds, reliefs, rows, tried, positions, modes, nwork, info, words)
    call give_text(trim(words), message, message_size)
  end function gsc_sizes

  function gsc_geometry(text, text_length, radius_mm, point, point_radius_mm, distance_mm, working_angle_deg, &
                        contact_ratio, base_pitch_mm, backlash_um, message, message_size) result(info) bind(c)
    type(c_ptr), value :: text, message
    integer(c_size_t), value :: text_length, message_size
    real(c_double), intent(inout), optional :: radius_mm(6, 2)
    real(c_double), intent(inout), optional :: point(5)
    real(c_double), intent(inout), optional :: point_radius_mm(5, 2)
    real(c_double), intent(inout), optional :: distance_mm, contact_ratio, base_pitch_mm, backlash_um
    real(c_double), intent(inout), optional :: working_angle_deg(2)
    integer(c_int) :: info
    character(:), allocatable :: case
    character(longest_message) :: words

    call take_text(text, text_length, case, info, words)
    call need_all([present(radius_mm), present(point), present(point_radius_mm), present(distance_mm), &
                   present(working_angle_deg), present(contact_ratio), present(base_pitch_mm), &
                   present(backlash_um)], info, words)
    if (info == code_ok) call gs_geometry(case, radius_mm, point, point_radius_mm, distance_mm, &
                                          working_angle_deg, contact_ratio, base_pitch_mm, backlash_um, info, &
                                          words)
    call give_text(trim(words), message, message_size)
  end function gsc_geometry

  function gsc_prepare(text, text_length, nwork, work, message, message_size) result(info) bind(c)
    type(c_ptr), value :: text, message
    integer(c_size_t), value :: text_length, message_size
    integer(c_int), value :: nwork
    real(c_double), intent(inout), optional :: work(*)
    integer(c_int) :: info
    character(:), allocatable :: case
    character(longest_message) :: words

    call take_text(text, text_length, case, info, words)
    call need_all([present(work)], info, words)
    if (info == code_ok) call gs_prepare(case, nwork, work, info, words)
    call give_text(trim(words), message, message_size)
  end function gsc_prepare

  function gsc_motion(text, text_length, nwork, work, load_n, mass_kg, stiffness_n_um, frequency_hz, message, &
                      message_size) result(info) bind(c)
    type(c_ptr), value :: text, work, message
    integer(c_size_t), value :: text_length, message_size
    integer(c_int), value :: nwork
    real(c_double), intent(inout), optional :: load_n, stiffness_n_um, frequency_hz
    real(c_double), intent(inout), optional :: mass_kg(2)
    integer(c_int) :: info
    character(:), allocatable :: case
    character(longest_message) :: words

    call take_text(text, text_length, case, info, words)
    call need_all([nwork == 0 .or. c_associated(work), present(load_n), present(mass_kg), &
                   present(stiffness_n_um), present(frequency_hz)], info, words)
    if (info == code_ok) call gs_motion(case, nwork, numbers(work, nwork), load_n, mass_kg, stiffness_n_um, &
                                        frequency_hz, info, words)
    call give_text(trim(words), message, message_size)
  end function gsc_motion

  function gsc_mesh(text, text_length, nwork, work, rows, relief_um, s, pair_n_um, mesh_n_um, error_um, share, &
                    ste_um, message, message_size) result(info) bind(c)
    type(c_ptr), value :: text, work, message
    integer(c_size_t), value :: text_length, message_size
    integer(c_int), value :: nwork, rows
    real(c_double), intent(inout), optional :: relief_um(rows), s(rows), pair_n_um(rows), mesh_n_um(rows)
    real(c_double), intent(inout), optional :: error_um(rows), share(rows), ste_um(rows)
    integer(c_int) :: info
    character(:), allocatable :: case
    character(longest_message) :: words

    call take_text(text, text_length, case, info, words)
    call need_all([nwork == 0 .or. c_associated(work), present(relief_um), present(s), present(pair_n_um), &
                   present(mesh_n_um), present(error_um), present(share), present(ste_um)], info, words)
    if (info == code_ok) call gs_mesh(case, nwork, numbers(work, nwork), rows, relief_um, s, pair_n_um, &
                                      mesh_n_um, error_um, share, ste_um, info, words)
    call give_text(trim(words), message, message_size)
  end function gsc_mesh

  function gsc_sweep(text, text_length, nwork, work, threads, speeds, reliefs, rpm, relief_um, dynamic_factor, &
                     estimate, status, contact, message, message_size) result(info) bind(c)
    type(c_ptr), value :: text, work, message
    integer(c_size_t), value :: text_length, message_size
    integer(c_int), value :: nwork, threads, speeds, reliefs
    integer(c_int), intent(inout), optional :: status(speeds, reliefs), contact(speeds, reliefs)
    real(c_double), intent(inout), optional :: rpm(speeds)
    real(c_double), intent(inout), optional :: relief_um(reliefs)
    real(c_double), intent(inout), optional :: dynamic_factor(speeds, reliefs), estimate(speeds, reliefs)
    integer(c_int) :: info
    character(:), allocatable :: case
    character(longest_message) :: words

    call take_text(text, text_length, case, info, words)
    call need_all([nwork == 0 .or. c_associated(work), present(rpm), present(relief_um), &
                   present(dynamic_factor), present(estimate), present(status), present(contact)], info, words)
    if (info == code_ok) call gs_sweep(case, nwork, numbers(work, nwork), threads, speeds, reliefs, rpm, &
                                       relief_um, dynamic_factor, estimate, status, contact, info, words)
    call give_text(trim(words), message, message_size)
  end function gsc_sweep

  function gsc_optimum(text, text_length, nwork, work, threads, room, tried, relief_um, worst_factor, rpm, &
                       failed, best_um, best_factor, best_rpm, within_um, message, message_size) &
                       result(info) bind(c)
    type(c_ptr), value :: text, work, message
    integer(c_size_t), value :: text_length, message_size
    integer(c_int), value :: nwork, threads, room
    integer(c_int), intent(inout), optional :: tried
    integer(c_int), intent(inout), optional :: failed(room)
    real(c_double), intent(inout), optional :: relief_um(room), worst_factor(room), rpm(room)
    real(c_double), intent(inout), optional :: best_um, best_factor, best_rpm, within_um
    integer(c_int) :: info
    character(:), allocatable :: case
    character(longest_message) :: words

    call take_text(text, text_length, case, info, words)
    call need_all([nwork == 0 .or. c_associated(work), present(tried), present(relief_um), &
                   present(worst_factor), present(rpm), present(failed), present(best_um), &
                   present(best_factor), present(best_rpm), present(within_um)], info, words)
    if (info == code_ok) call gs_optimum(case, nwork, numbers(work, nwork), threads, room, tried, relief_um, &
                                         worst_factor, rpm, failed, best_um, best_factor, best_rpm, within_um, &
                                         info, words)
    call give_text(trim(words), message, message_size)
  end function gsc_optimum

  function gsc_resonances(speeds, rpm, dynamic_factor, found, peak_rpm, peak_factor, message, message_size) &
                          result(info) bind(c)
    type(c_ptr), value :: message
    integer(c_size_t), value :: message_size
    integer(c_int), value :: speeds
    integer(c_int), intent(inout), optional :: found
    real(c_double), intent(in), optional :: rpm(speeds), dynamic_factor(speeds)
    real(c_double), intent(inout), optional :: peak_rpm(5), peak_factor(5)
    integer(c_int) :: info
    character(longest_message) :: words

    info = code_ok
    call need_all([present(rpm), present(dynamic_factor), present(found), present(peak_rpm), &
                   present(peak_factor)], info, words)
    if (info == code_ok) call gs_resonances(speeds, rpm, dynamic_factor, found, peak_rpm, peak_factor, info, &
                                            words)
    call give_text(trim(words), message, message_size)
  end function gsc_resonances

  function gsc_load(text, text_length, nwork, work, room, rows, relief_um, rpm, s, pair_load_n, dte_um, &
                    message, message_size) result(info) bind(c)
    type(c_ptr), value :: text, work, message
    integer(c_size_t), value :: text_length, message_size
    integer(c_int), value :: nwork, room
    integer(c_int), intent(inout), optional :: rows
    real(c_double), intent(inout), optional :: relief_um(room), rpm(room), s(room), pair_load_n(room)
    real(c_double), intent(inout), optional :: dte_um(room)
    integer(c_int) :: info
    character(:), allocatable :: case
    character(longest_message) :: words

    call take_text(text, text_length, case, info, words)
    call need_all([nwork == 0 .or. c_associated(work), present(rows), present(relief_um), present(rpm), &
                   present(s), present(pair_load_n), present(dte_um)], info, words)
    if (info == code_ok) call gs_load(case, nwork, numbers(work, nwork), room, rows, relief_um, rpm, s, &
                                      pair_load_n, dte_um, info, words)
    call give_text(trim(words), message, message_size)
  end function gsc_load

  function gsc_modes(text, text_length, modes, frequency_hz, estimate, residual, rim_share, message, &
                     message_size) result(info) bind(c)
    type(c_ptr), value :: text, message
    integer(c_size_t), value :: text_length, message_size
    integer(c_int), value :: modes
    real(c_double), intent(inout), optional :: frequency_hz(modes), estimate(modes), residual(modes)
    real(c_double), intent(inout), optional :: rim_share(modes)
    integer(c_int) :: info
    character(:), allocatable :: case
    character(longest_message) :: words

    call take_text(text, text_length, case, info, words)
    call need_all([present(frequency_hz), present(estimate), present(residual), present(rim_share)], info, words)
    if (info == code_ok) call gs_modes(case, modes, frequency_hz, estimate, residual, rim_share, info, words)
    call give_text(trim(words), message, message_size)
  end function gsc_modes

  function gsc_root(text, text_length, nwork, work, positions, reliefs, relief_um, s, radius_mm, share, &
                    sigma_mpa, parts_mpa, tension_mpa, tension_deg, compression_mpa, compression_deg, estimate, &
                    iso_mpa, lewis_mpa, message, message_size) result(info) bind(c)
    type(c_ptr), value :: text, work, message
    integer(c_size_t), value :: text_length, message_size
    integer(c_int), value :: nwork, positions, reliefs
    real(c_double), intent(inout), optional :: relief_um(reliefs), tension_mpa(reliefs), tension_deg(reliefs)
    real(c_double), intent(inout), optional :: compression_mpa(reliefs), compression_deg(reliefs)
    real(c_double), intent(inout), optional :: estimate(reliefs)
    real(c_double), intent(inout), optional :: s(positions), radius_mm(positions)
    real(c_double), intent(inout), optional :: share(positions, reliefs)
    real(c_double), intent(inout), optional :: sigma_mpa(2, positions, reliefs)
    real(c_double), intent(inout), optional :: parts_mpa(3, 2, positions, reliefs)
    real(c_double), intent(inout), optional :: iso_mpa, lewis_mpa
    integer(c_int) :: info
    character(:), allocatable :: case
    character(longest_message) :: words

    call take_text(text, text_length, case, info, words)
    call need_all([nwork == 0 .or. c_associated(work), present(relief_um), present(s), present(radius_mm), &
                   present(share), present(sigma_mpa), present(parts_mpa), present(tension_mpa), &
                   present(tension_deg), present(compression_mpa), present(compression_deg), present(estimate), &
                   present(iso_mpa), present(lewis_mpa)], info, words)
    if (info == code_ok) call gs_root(case, nwork, numbers(work, nwork), positions, reliefs, relief_um, s, &
                                      radius_mm, share, sigma_mpa, parts_mpa, tension_mpa, tension_deg, &
                                      compression_mpa, compression_deg, estimate, iso_mpa, lewis_mpa, info, &
                                      words)
    call give_text(trim(words), message, message_size)
  end function gsc_root

  function gsc_version(version, version_size, message, message_size) result(info) bind(c)
    type(c_ptr), value :: version, message
    integer(c_size_t), value :: version_size, message_size
    integer(c_int) :: info
    character(32) :: this
    character(longest_message) :: words

    call gs_version(this, info, words)
    call need_all([c_associated(version)], info, words)
    call need_size('version_size', version_size, len_trim(this), info, words)
    if (info == code_ok) call give_text(trim(this), version, version_size)
    call give_text(trim(words), message, message_size)
  end function gsc_version

  !> `length` is that of the answer without its NUL.
  function gsc_report(text, text_length, nwork, work, threads, answer, answer_size, length, message, &
                      message_size) result(info) bind(c)
    type(c_ptr), value :: text, work, answer, message
    integer(c_size_t), value :: text_length, answer_size, message_size
    integer(c_int), value :: nwork, threads
    integer(c_size_t), intent(inout), optional :: length
    integer(c_int) :: info
    character(:), allocatable :: case, room
    character(longest_message) :: words
    integer :: used, stat

    call take_text(text, text_length, case, info, words)
    call need_all([nwork == 0 .or. c_associated(work), answer_size == 0 .or. c_associated(answer), present(length)], &
                  info, words)
    if (info == code_ok) then
      allocate (character(max(0_c_size_t, min(answer_size, longest_text) - 1)) :: room, stat=stat)
      if (stat /= 0) call refuse(code_memory, 'answer_size: does not fit into memory', info, words)
    end if
    if (info == code_ok) then
      used = -1
      call gs_report(case, nwork, numbers(work, nwork), threads, room, used, info, words)
      if (used >= 0) length = used
      if (used > len(room)) then
        info = code_ok
        call need_size('answer_size', answer_size, used, info, words)
      else if (used >= 0) then
        call give_text(room(:used), answer, answer_size)
      end if
    end if
    call give_text(trim(words), message, message_size)
  end function gsc_report

  !> The case as a Fortran text: `length` characters, or up to the first NUL.
  subroutine take_text(text, length, case, info, words)
    type(c_ptr), intent(in) :: text
    integer(c_size_t), intent(in) :: length
    character(:), allocatable, intent(out) :: case
    integer(c_int), intent(out) :: info
    character(*), intent(out) :: words
    character(c_char), pointer :: letters(:)
    integer(c_size_t) :: i, n
    integer :: stat

    info = code_ok
    words = ''
    if (.not. c_associated(text)) then
      call refuse(code_input, 'text: is a null pointer', info, words)
    else if (length < 0 .or. length > longest_text) then
      call refuse(code_input, 'text_length: more than 1000000000 characters', info, words)
    end if
    if (info /= code_ok) return
    call c_f_pointer(text, letters, [length])
    n = 0
    do while (n < length)
      if (letters(n + 1) == c_null_char) exit
      n = n + 1
    end do
    allocate (character(n) :: case, stat=stat)
    if (stat /= 0) then
      call refuse(code_memory, 'text: does not fit into memory', info, words)
      return
    end if
    do i = 1, n
      case(i:i) = letters(i)
    end do
  end subroutine take_text

  !> `words` and a NUL, cut where `room` bytes are too few; none where there is no room.
  subroutine give_text(words, target, room)
    character(*), intent(in) :: words
    type(c_ptr), intent(in) :: target
    integer(c_size_t), intent(in) :: room
    character(c_char), pointer :: letters(:)
    integer(c_size_t) :: i, n

    if (.not. c_associated(target) .or. room < 1) return
    n = min(len(words, c_size_t), room - 1)
    call c_f_pointer(target, letters, [n + 1])
    do i = 1, n
      letters(i) = words(i:i)
    end do
    letters(n + 1) = c_null_char
  end subroutine give_text

  !> A copy of work(n); empty where there is none.
  function numbers(work, n) result(values)
    type(c_ptr), intent(in) :: work
    integer, intent(in) :: n
    real(c_double), allocatable :: values(:)
    real(c_double), pointer :: all(:)

    allocate (values(0))
    if (n <= 0 .or. .not. c_associated(work)) return
    call c_f_pointer(work, all, [n])
    values = all
  end function numbers

  subroutine need_all(given, info, words)
    logical, intent(in) :: given(:)
    integer(c_int), intent(inout) :: info
    character(*), intent(inout) :: words

    if (.not. all(given)) call refuse(code_input, 'an array or result is a null pointer', info, words)
  end subroutine need_all

  !> Room for `need` characters and a NUL.
  subroutine need_size(name, have, need, info, words)
    character(*), intent(in) :: name
    integer(c_size_t), intent(in) :: have
    integer, intent(in) :: need
    integer(c_int), intent(inout) :: info
    character(*), intent(inout) :: words
    character(20) :: number

    if (have >= 0 .and. have <= need) then
      write (number, '(i0)') need + 1_c_size_t
      call refuse(code_input, name//': too small, must be at least '//trim(number), info, words)
    end if
  end subroutine need_size

  !> The first refusal is kept.
  subroutine refuse(code, reason, info, words)
    integer, intent(in) :: code
    character(*), intent(in) :: reason
    integer(c_int), intent(inout) :: info
    character(*), intent(inout) :: words

    if (info /= code_ok) return
    info = code
    words = reason
  end subroutine refuse
end module gearsweep_c
