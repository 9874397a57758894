!> The calls for C of gearsweep_flat_maps; include/gearsweep.h describes them.
module gearsweep_c_maps
  use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_int, c_ptr, c_size_t
  use gearsweep_c_border, only: give_text, longest_message, need_all, numbers, take_text
  use gearsweep_calls, only: gs_follow, gs_stability, gs_strobe
  use gearsweep_error, only: code_ok
  implicit none
  private
  public :: gsc_stability, gsc_follow, gsc_strobe

contains

  function gsc_stability(text, text_length, nwork, work, speeds, rpm, dampings, damping_ratio, tongues, modulus, &
                         sense, closing_ratio, closing_rpm, edge_rpm, message, message_size) result(info) bind(c)
    type(c_ptr), value :: text, work, message
    integer(c_size_t), value :: text_length, message_size
    integer(c_int), value :: nwork, speeds, dampings, tongues
    real(c_double), intent(in), optional :: rpm(speeds), damping_ratio(dampings)
    real(c_double), intent(inout), optional :: modulus(speeds, dampings), closing_ratio(tongues), closing_rpm(tongues)
    real(c_double), intent(inout), optional :: edge_rpm(2, dampings, tongues)
    integer(c_int), intent(inout), optional :: sense(speeds, dampings)
    integer(c_int) :: info
    character(:), allocatable :: case
    character(longest_message) :: words

    call take_text(text, text_length, case, info, words)
    call need_all([nwork == 0 .or. c_associated(work), present(rpm), present(damping_ratio), present(modulus), &
                   present(sense), present(closing_ratio), present(closing_rpm), present(edge_rpm)], info, words)
    if (info == code_ok) call gs_stability(case, nwork, numbers(work, nwork), speeds, rpm, dampings, damping_ratio, &
                                           tongues, modulus, sense, closing_ratio, closing_rpm, edge_rpm, info, words)
    call give_text(trim(words), message, message_size)
  end function gsc_stability

  function gsc_follow(text, text_length, nwork, work, relief, speeds, rpm, jump, closeness, room, changes, &
                      change_rpm, change_factor, change_status, change_periods, dynamic_factor, estimate, status, &
                      contact, floquet_modulus, periods, x_um, v_mm_s, message, message_size) result(info) bind(c)
    type(c_ptr), value :: text, work, message
    integer(c_size_t), value :: text_length, message_size
    integer(c_int), value :: nwork, relief, speeds, room
    real(c_double), value :: jump, closeness
    real(c_double), intent(in), optional :: rpm(speeds)
    real(c_double), intent(inout), dimension(speeds), optional :: dynamic_factor, estimate, floquet_modulus, x_um, v_mm_s
    integer(c_int), intent(inout), dimension(speeds), optional :: status, contact, periods
    integer(c_int), intent(inout), optional :: changes
    real(c_double), intent(inout), dimension(2, room), optional :: change_rpm, change_factor
    integer(c_int), intent(inout), dimension(2, room), optional :: change_status, change_periods
    integer(c_int) :: info
    character(:), allocatable :: case
    character(longest_message) :: words

    call take_text(text, text_length, case, info, words)
    call need_all([nwork == 0 .or. c_associated(work), present(rpm), present(dynamic_factor), present(estimate), &
                   present(status), present(contact), present(floquet_modulus), present(periods), present(x_um), &
                   present(v_mm_s), present(changes), present(change_rpm), present(change_factor), &
                   present(change_status), present(change_periods)], info, words)
    if (info == code_ok) call gs_follow(case, nwork, numbers(work, nwork), relief, speeds, rpm, jump, closeness, room, &
                                        changes, change_rpm, change_factor, change_status, change_periods, &
                                        dynamic_factor, estimate, status, contact, floquet_modulus, periods, x_um, &
                                        v_mm_s, info, words)
    call give_text(trim(words), message, message_size)
  end function gsc_follow

  function gsc_strobe(text, text_length, nwork, work, relief, speeds, rpm, start_um, start_mm_s, settle, keep, x_um, &
                      v_mm_s, exponent, status, periods, message, message_size) result(info) bind(c)
    type(c_ptr), value :: text, work, message
    integer(c_size_t), value :: text_length, message_size
    integer(c_int), value :: nwork, relief, speeds, settle, keep
    real(c_double), value :: start_um, start_mm_s
    real(c_double), intent(in), optional :: rpm(speeds)
    real(c_double), intent(inout), dimension(keep, speeds), optional :: x_um, v_mm_s
    real(c_double), intent(inout), optional :: exponent(speeds)
    integer(c_int), intent(inout), dimension(speeds), optional :: status, periods
    integer(c_int) :: info
    character(:), allocatable :: case
    character(longest_message) :: words

    call take_text(text, text_length, case, info, words)
    call need_all([nwork == 0 .or. c_associated(work), present(rpm), present(x_um), present(v_mm_s), &
                   present(exponent), present(status), present(periods)], info, words)
    if (info == code_ok) call gs_strobe(case, nwork, numbers(work, nwork), relief, speeds, rpm, start_um, &
                                        start_mm_s, settle, keep, x_um, v_mm_s, exponent, status, periods, &
                                        info, words)
    call give_text(trim(words), message, message_size)
  end function gsc_strobe
end module gearsweep_c_maps
