!> The flat layer for C: the same calls as gs_..., named gsc_..., which return
!> the code. The header gearsweep.h describes them.
module gearsweep_c
  use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_f_pointer, c_int, c_ptr, c_size_t
  use gearsweep_c_border, only: give_answer, give_text, longest_message, make_room, need_all, need_size, numbers, &
                                take_string, take_text
  use gearsweep_calls
  use gearsweep_error, only: code_ok
  implicit none
  private
  public :: gsc_version, gsc_sizes, gsc_prepare, gsc_report, gsc_complete, gsc_unused, gsc_change
  public :: gsc_geometry, gsc_motion, gsc_mesh, gsc_harmonics, gsc_load, gsc_sweep, gsc_resonances, gsc_optimum
  public :: gsc_outline, gsc_section, gsc_modes, gsc_root, gsc_stress

contains

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

  function gsc_sizes(text, text_length, folder, speeds, reliefs, rows, tried, positions, modes, nodes, elements, &
                     harmonics, nwork, message, message_size) result(info) bind(c)
    type(c_ptr), value :: text, folder, message
    integer(c_size_t), value :: text_length, message_size
    integer(c_int), intent(inout), optional :: speeds, reliefs, rows, tried, positions, modes, nodes, elements, &
                                               harmonics, nwork
    integer(c_int) :: info
    character(:), allocatable :: case, place
    character(longest_message) :: words

    call take_text(text, text_length, case, info, words)
    call take_string(folder, place, info, words)
    call need_all([present(speeds), present(reliefs), present(rows), present(tried), present(positions), &
                   present(modes), present(nodes), present(elements), present(harmonics), present(nwork)], info, words)
    if (info == code_ok) call gs_sizes(case, place, speeds, reliefs, rows, tried, positions, modes, nodes, elements, &
                                       harmonics, nwork, info, words)
    call give_text(trim(words), message, message_size)
  end function gsc_sizes

  function gsc_prepare(text, text_length, folder, nwork, work, message, message_size) result(info) bind(c)
    type(c_ptr), value :: text, folder, message
    integer(c_size_t), value :: text_length, message_size
    integer(c_int), value :: nwork
    real(c_double), intent(inout), optional :: work(*)
    integer(c_int) :: info
    character(:), allocatable :: case, place
    character(longest_message) :: words

    call take_text(text, text_length, case, info, words)
    call take_string(folder, place, info, words)
    call need_all([present(work)], info, words)
    if (info == code_ok) call gs_prepare(case, place, nwork, work, info, words)
    call give_text(trim(words), message, message_size)
  end function gsc_prepare

  !> `length` is that of the answer without its NUL.
  function gsc_report(text, text_length, folder, nwork, work, threads, answer, answer_size, length, message, &
                      message_size) result(info) bind(c)
    type(c_ptr), value :: text, folder, work, answer, message
    integer(c_size_t), value :: text_length, answer_size, message_size
    integer(c_int), value :: nwork, threads
    integer(c_size_t), intent(inout), optional :: length
    integer(c_int) :: info
    character(:), allocatable :: case, place, room
    character(longest_message) :: words
    integer :: used

    call take_text(text, text_length, case, info, words)
    call take_string(folder, place, info, words)
    call need_all([nwork == 0 .or. c_associated(work), answer_size == 0 .or. c_associated(answer), present(length)], &
                  info, words)
    call make_room('answer_size', answer_size, room, info, words)
    used = -1
    if (info == code_ok) call gs_report(case, place, nwork, numbers(work, nwork), threads, room, used, info, words)
    call give_answer('answer_size', room, used, answer, answer_size, length, info, words)
    call give_text(trim(words), message, message_size)
  end function gsc_report

  !> `length` is that of the completed case without its NUL.
  function gsc_complete(text, text_length, complete, complete_size, length, message, message_size) &
                        result(info) bind(c)
    type(c_ptr), value :: text, complete, message
    integer(c_size_t), value :: text_length, complete_size, message_size
    integer(c_size_t), intent(inout), optional :: length
    integer(c_int) :: info
    character(:), allocatable :: case, room
    character(longest_message) :: words
    integer :: used

    call take_text(text, text_length, case, info, words)
    call need_all([complete_size == 0 .or. c_associated(complete), present(length)], info, words)
    call make_room('complete_size', complete_size, room, info, words)
    used = -1
    if (info == code_ok) call gs_complete(case, room, used, info, words)
    call give_answer('complete_size', room, used, complete, complete_size, length, info, words)
    call give_text(trim(words), message, message_size)
  end function gsc_complete

  !> `length` is that of the list without its NUL.
  function gsc_unused(text, text_length, unused, unused_size, length, message, message_size) result(info) bind(c)
    type(c_ptr), value :: text, unused, message
    integer(c_size_t), value :: text_length, unused_size, message_size
    integer(c_size_t), intent(inout), optional :: length
    integer(c_int) :: info
    character(:), allocatable :: case, room
    character(longest_message) :: words
    integer :: used

    call take_text(text, text_length, case, info, words)
    call need_all([unused_size == 0 .or. c_associated(unused), present(length)], info, words)
    call make_room('unused_size', unused_size, room, info, words)
    used = -1
    if (info == code_ok) call gs_unused(case, room, used, info, words)
    call give_answer('unused_size', room, used, unused, unused_size, length, info, words)
    call give_text(trim(words), message, message_size)
  end function gsc_unused

  !> `length` is that of the changed case without its NUL.
  function gsc_change(text, text_length, group, key, value, changed, changed_size, length, message, message_size) &
                      result(info) bind(c)
    type(c_ptr), value :: text, group, key, value, changed, message
    integer(c_size_t), value :: text_length, changed_size, message_size
    integer(c_size_t), intent(inout), optional :: length
    integer(c_int) :: info
    character(:), allocatable :: case, room, group_name, key_name, new
    character(longest_message) :: words
    integer :: used

    call take_text(text, text_length, case, info, words)
    call take_string(group, group_name, info, words)
    call take_string(key, key_name, info, words)
    call take_string(value, new, info, words)
    call need_all([c_associated(group), c_associated(key), changed_size == 0 .or. c_associated(changed), &
                   present(length)], info, words)
    call make_room('changed_size', changed_size, room, info, words)
    used = -1
    if (info == code_ok) call gs_change(case, group_name, key_name, new, room, used, info, words)
    call give_answer('changed_size', room, used, changed, changed_size, length, info, words)
    call give_text(trim(words), message, message_size)
  end function gsc_change

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

  function gsc_motion(text, text_length, nwork, work, load_n, mass_kg, stiffness_n_um, frequency_hz, turn_um, &
                      shared_um, message, message_size) result(info) bind(c)
    type(c_ptr), value :: text, work, message
    integer(c_size_t), value :: text_length, message_size
    integer(c_int), value :: nwork
    real(c_double), intent(inout), optional :: load_n, stiffness_n_um, frequency_hz, turn_um, shared_um
    real(c_double), intent(inout), optional :: mass_kg(2)
    integer(c_int) :: info
    character(:), allocatable :: case
    character(longest_message) :: words

    call take_text(text, text_length, case, info, words)
    call need_all([nwork == 0 .or. c_associated(work), present(load_n), present(mass_kg), &
                   present(stiffness_n_um), present(frequency_hz), present(turn_um), &
                   present(shared_um)], info, words)
    if (info == code_ok) call gs_motion(case, nwork, numbers(work, nwork), load_n, mass_kg, stiffness_n_um, &
                                        frequency_hz, turn_um, shared_um, info, words)
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

  function gsc_harmonics(text, text_length, nwork, work, harmonics, reliefs, relief_um, mean_um, rms_um, &
                         peak_to_peak_um, amplitude_um, phase_deg, estimate_um, message, message_size) &
                         result(info) bind(c)
    type(c_ptr), value :: text, work, message
    integer(c_size_t), value :: text_length, message_size
    integer(c_int), value :: nwork, harmonics, reliefs
    real(c_double), intent(inout), dimension(reliefs), optional :: relief_um, mean_um, rms_um, peak_to_peak_um, &
                                                                   estimate_um
    real(c_double), intent(inout), dimension(harmonics, reliefs), optional :: amplitude_um, phase_deg
    integer(c_int) :: info
    character(:), allocatable :: case
    character(longest_message) :: words

    call take_text(text, text_length, case, info, words)
    call need_all([nwork == 0 .or. c_associated(work), present(relief_um), present(mean_um), present(rms_um), &
                   present(peak_to_peak_um), present(amplitude_um), present(phase_deg), present(estimate_um)], &
                  info, words)
    if (info == code_ok) call gs_harmonics(case, nwork, numbers(work, nwork), harmonics, reliefs, relief_um, mean_um, &
                                           rms_um, peak_to_peak_um, amplitude_um, phase_deg, estimate_um, info, words)
    call give_text(trim(words), message, message_size)
  end function gsc_harmonics

  function gsc_load(text, text_length, nwork, work, room, rows, relief_um, rpm, s, pair_load_n, dte_um, &
                    status, periods, pair, message, message_size) result(info) bind(c)
    type(c_ptr), value :: text, work, message
    integer(c_size_t), value :: text_length, message_size
    integer(c_int), value :: nwork, room
    integer(c_int), intent(inout), optional :: rows
    real(c_double), intent(inout), optional :: relief_um(room), rpm(room), s(room), pair_load_n(room)
    real(c_double), intent(inout), optional :: dte_um(room)
    integer(c_int), intent(inout), optional :: status(room), periods(room), pair(room)
    integer(c_int) :: info
    character(:), allocatable :: case
    character(longest_message) :: words

    call take_text(text, text_length, case, info, words)
    call need_all([nwork == 0 .or. c_associated(work), present(rows), present(relief_um), present(rpm), &
                   present(s), present(pair_load_n), present(dte_um), present(status), present(periods), &
                   present(pair)], info, words)
    if (info == code_ok) call gs_load(case, nwork, numbers(work, nwork), room, rows, relief_um, rpm, s, &
                                      pair_load_n, dte_um, status, periods, pair, info, words)
    call give_text(trim(words), message, message_size)
  end function gsc_load

  function gsc_sweep(text, text_length, nwork, work, threads, speeds, reliefs, rpm, relief_um, dynamic_factor, &
                     estimate, status, contact, floquet_modulus, residual, steps, periods, message, message_size) &
                     result(info) bind(c)
    type(c_ptr), value :: text, work, message
    integer(c_size_t), value :: text_length, message_size
    integer(c_int), value :: nwork, threads, speeds, reliefs
    real(c_double), intent(inout), optional :: rpm(speeds)
    real(c_double), intent(inout), optional :: relief_um(reliefs)
    real(c_double), intent(inout), dimension(speeds, reliefs), optional :: dynamic_factor, estimate, &
                                                                           floquet_modulus, residual
    integer(c_int), intent(inout), dimension(speeds, reliefs), optional :: status, contact, steps, periods
    integer(c_int) :: info
    character(:), allocatable :: case
    character(longest_message) :: words

    call take_text(text, text_length, case, info, words)
    call need_all([nwork == 0 .or. c_associated(work), present(rpm), present(relief_um), &
                   present(dynamic_factor), present(estimate), present(status), present(contact), &
                   present(floquet_modulus), present(residual), present(steps), present(periods)], info, words)
    if (info == code_ok) call gs_sweep(case, nwork, numbers(work, nwork), threads, speeds, reliefs, rpm, &
                                       relief_um, dynamic_factor, estimate, status, contact, floquet_modulus, &
                                       residual, steps, periods, info, words)
    call give_text(trim(words), message, message_size)
  end function gsc_sweep

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

  function gsc_outline(text, text_length, member, room, points, x_mm, y_mm, message, message_size) &
                       result(info) bind(c)
    type(c_ptr), value :: text, message
    integer(c_size_t), value :: text_length, message_size
    integer(c_int), value :: member, room
    integer(c_int), intent(inout), optional :: points
    real(c_double), intent(inout), optional :: x_mm(room), y_mm(room)
    integer(c_int) :: info
    character(:), allocatable :: case
    character(longest_message) :: words

    call take_text(text, text_length, case, info, words)
    call need_all([present(points), present(x_mm), present(y_mm)], info, words)
    if (info == code_ok) call gs_outline(case, member, room, points, x_mm, y_mm, info, words)
    call give_text(trim(words), message, message_size)
  end function gsc_outline

  function gsc_section(text, text_length, nodes, elements, x_mm, y_mm, element, tooth, message, message_size) &
                       result(info) bind(c)
    type(c_ptr), value :: text, message
    integer(c_size_t), value :: text_length, message_size
    integer(c_int), value :: nodes, elements
    real(c_double), intent(inout), optional :: x_mm(nodes), y_mm(nodes)
    integer(c_int), intent(inout), optional :: element(8, elements), tooth(elements)
    integer(c_int) :: info
    character(:), allocatable :: case
    character(longest_message) :: words

    call take_text(text, text_length, case, info, words)
    call need_all([present(x_mm), present(y_mm), present(element), present(tooth)], info, words)
    if (info == code_ok) call gs_section(case, nodes, elements, x_mm, y_mm, element, tooth, info, words)
    call give_text(trim(words), message, message_size)
  end function gsc_section

  function gsc_modes(text, text_length, modes, nodes, frequency_hz, estimate, residual, rim_share, shape, message, &
                     message_size) result(info) bind(c)
    type(c_ptr), value :: text, shape, message
    integer(c_size_t), value :: text_length, message_size
    integer(c_int), value :: modes, nodes
    real(c_double), intent(inout), dimension(modes), optional :: frequency_hz, estimate, residual, rim_share
    integer(c_int) :: info
    real(c_double), pointer, contiguous :: moved(:, :, :)
    real(c_double), target :: none(2, 0, 0)
    character(:), allocatable :: case
    character(longest_message) :: words

    call take_text(text, text_length, case, info, words)
    call need_all([present(frequency_hz), present(estimate), present(residual), present(rim_share), &
                   nodes == 0 .or. c_associated(shape)], info, words)
    moved => none
    if (nodes > 0 .and. modes > 0 .and. c_associated(shape)) call c_f_pointer(shape, moved, [2, nodes, modes])
    if (info == code_ok) call gs_modes(case, modes, nodes, frequency_hz, estimate, residual, rim_share, moved, info, &
                                       words)
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

  function gsc_stress(text, text_length, nwork, work, position, relief, nodes, relief_um, s, radius_mm, share, &
                      sigma_mpa, message, message_size) result(info) bind(c)
    type(c_ptr), value :: text, work, message
    integer(c_size_t), value :: text_length, message_size
    integer(c_int), value :: nwork, position, relief, nodes
    real(c_double), intent(inout), optional :: relief_um, s, radius_mm, share, sigma_mpa(3, nodes)
    integer(c_int) :: info
    character(:), allocatable :: case
    character(longest_message) :: words

    call take_text(text, text_length, case, info, words)
    call need_all([nwork == 0 .or. c_associated(work), present(relief_um), present(s), present(radius_mm), &
                   present(share), present(sigma_mpa)], info, words)
    if (info == code_ok) call gs_stress(case, nwork, numbers(work, nwork), position, relief, nodes, relief_um, s, &
                                        radius_mm, share, sigma_mpa, info, words)
    call give_text(trim(words), message, message_size)
  end function gsc_stress
end module gearsweep_c
