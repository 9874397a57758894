!> Interfaces of the flat layer for modern Fortran, whose compiler then checks
!> the arguments. What they mean is told in gearsweep_flat*.f90.
module gearsweep_old_calls
  implicit none
  private
  public :: gs_sizes, gs_prepare, gs_report, gs_files, gs_all, gs_complete, gs_unused, gs_change
  public :: gs_geometry, gs_motion, gs_mesh, gs_harmonics, gs_load, gs_sweep, gs_resonances, gs_optimum
  public :: gs_outline, gs_section, gs_modes, gs_root, gs_stress
  public :: gs_stability, gs_follow, gs_strobe

  interface

    subroutine gs_sizes(text, folder, speeds, reliefs, rows, tried, positions, modes, nodes, elements, harmonics, &
                        nwork, info, message)
      character(*), intent(in) :: text, folder
      integer, intent(inout) :: speeds, reliefs, rows, tried, positions, modes, nodes, elements, harmonics, nwork
      integer, intent(out) :: info
      character(*), intent(out) :: message
    end subroutine gs_sizes

    subroutine gs_prepare(text, folder, nwork, work, info, message)
      character(*), intent(in) :: text, folder
      integer, intent(in) :: nwork
      double precision, intent(inout) :: work(*)
      integer, intent(out) :: info
      character(*), intent(out) :: message
    end subroutine gs_prepare

    subroutine gs_report(text, folder, nwork, work, threads, answer, length, info, message)
      character(*), intent(in) :: text, folder
      integer, intent(in) :: nwork, threads
      double precision, intent(in) :: work(*)
      character(*), intent(inout) :: answer
      integer, intent(inout) :: length
      integer, intent(out) :: info
      character(*), intent(out) :: message
    end subroutine gs_report

    subroutine gs_files(text, folder, nwork, work, threads, out, name, room, values, used, names, answer, length, stages, &
                        files, info, message)
      character(*), intent(in) :: text, folder, out, name
      integer, intent(in) :: nwork, threads, room
      double precision, intent(in) :: work(*)
      double precision, intent(inout) :: values(room)
      character(*), intent(inout) :: names, answer, stages, files
      integer, intent(inout) :: used, length
      integer, intent(out) :: info
      character(*), intent(out) :: message
    end subroutine gs_files

    subroutine gs_all(text, folder, nwork, work, threads, out, name, watch, resume, keep, room, values, used, names, &
                      answer, length, stages, files, info, message)
      character(*), intent(in) :: text, folder, out, name, resume, keep
      integer, intent(in) :: nwork, threads, room
      integer, intent(inout), target :: watch(3)
      double precision, intent(in) :: work(*)
      double precision, intent(inout) :: values(room)
      character(*), intent(inout) :: names, answer, stages, files
      integer, intent(inout) :: used, length
      integer, intent(out) :: info
      character(*), intent(out) :: message
    end subroutine gs_all

    subroutine gs_complete(text, complete, length, info, message)
      character(*), intent(in) :: text
      character(*), intent(inout) :: complete
      integer, intent(inout) :: length
      integer, intent(out) :: info
      character(*), intent(out) :: message
    end subroutine gs_complete

    subroutine gs_unused(text, unused, length, info, message)
      character(*), intent(in) :: text
      character(*), intent(inout) :: unused
      integer, intent(inout) :: length
      integer, intent(out) :: info
      character(*), intent(out) :: message
    end subroutine gs_unused

    subroutine gs_change(text, group, key, value, changed, length, info, message)
      character(*), intent(in) :: text, group, key, value
      character(*), intent(inout) :: changed
      integer, intent(inout) :: length
      integer, intent(out) :: info
      character(*), intent(out) :: message
    end subroutine gs_change

    subroutine gs_geometry(text, radius_mm, point, point_radius_mm, distance_mm, working_angle_deg, &
                           contact_ratio, base_pitch_mm, backlash_um, info, message)
      character(*), intent(in) :: text
      double precision, intent(inout) :: radius_mm(6, 2), point(5), point_radius_mm(5, 2), distance_mm
      double precision, intent(inout) :: working_angle_deg(2), contact_ratio, base_pitch_mm, backlash_um
      integer, intent(out) :: info
      character(*), intent(out) :: message
    end subroutine gs_geometry

    subroutine gs_motion(text, nwork, work, load_n, mass_kg, stiffness_n_um, frequency_hz, turn_um, shared_um, info, message)
      character(*), intent(in) :: text
      integer, intent(in) :: nwork
      double precision, intent(in) :: work(*)
      double precision, intent(inout) :: load_n, mass_kg(2), stiffness_n_um, frequency_hz, turn_um, shared_um
      integer, intent(out) :: info
      character(*), intent(out) :: message
    end subroutine gs_motion

    subroutine gs_mesh(text, nwork, work, rows, relief_um, s, pair_n_um, mesh_n_um, error_um, share, ste_um, &
                       info, message)
      character(*), intent(in) :: text
      integer, intent(in) :: nwork, rows
      double precision, intent(in) :: work(*)
      double precision, intent(inout), dimension(rows) :: relief_um, s, pair_n_um, mesh_n_um, error_um, share, ste_um
      integer, intent(out) :: info
      character(*), intent(out) :: message
    end subroutine gs_mesh

    subroutine gs_harmonics(text, nwork, work, harmonics, reliefs, relief_um, mean_um, rms_um, peak_to_peak_um, &
                            amplitude_um, phase_deg, estimate_um, info, message)
      character(*), intent(in) :: text
      integer, intent(in) :: nwork, harmonics, reliefs
      double precision, intent(in) :: work(*)
      double precision, intent(inout), dimension(reliefs) :: relief_um, mean_um, rms_um, peak_to_peak_um, estimate_um
      double precision, intent(inout), dimension(harmonics, reliefs) :: amplitude_um, phase_deg
      integer, intent(out) :: info
      character(*), intent(out) :: message
    end subroutine gs_harmonics

    subroutine gs_load(text, nwork, work, room, rows, relief_um, rpm, s, pair_load_n, dte_um, status, periods, pair, &
                       info, message)
      character(*), intent(in) :: text
      integer, intent(in) :: nwork, room
      double precision, intent(in) :: work(*)
      integer, intent(inout) :: rows
      double precision, intent(inout), dimension(room) :: relief_um, rpm, s, pair_load_n, dte_um
      integer, intent(inout), dimension(room) :: status, periods, pair
      integer, intent(out) :: info
      character(*), intent(out) :: message
    end subroutine gs_load

    subroutine gs_sweep(text, nwork, work, threads, speeds, reliefs, rpm, relief_um, dynamic_factor, estimate, &
                        status, contact, floquet_modulus, residual, steps, periods, info, message)
      character(*), intent(in) :: text
      integer, intent(in) :: nwork, threads, speeds, reliefs
      double precision, intent(in) :: work(*)
      double precision, intent(inout) :: rpm(speeds), relief_um(reliefs)
      double precision, intent(inout), dimension(speeds, reliefs) :: dynamic_factor, estimate, floquet_modulus, residual
      integer, intent(inout), dimension(speeds, reliefs) :: status, contact, steps, periods
      integer, intent(out) :: info
      character(*), intent(out) :: message
    end subroutine gs_sweep

    subroutine gs_resonances(speeds, rpm, dynamic_factor, found, peak_rpm, peak_factor, info, message)
      integer, intent(in) :: speeds
      double precision, intent(in) :: rpm(speeds), dynamic_factor(speeds)
      integer, intent(inout) :: found
      double precision, intent(inout) :: peak_rpm(5), peak_factor(5)
      integer, intent(out) :: info
      character(*), intent(out) :: message
    end subroutine gs_resonances

    subroutine gs_optimum(text, nwork, work, threads, room, tried, relief_um, worst_factor, rpm, failed, &
                          best_um, best_factor, best_rpm, within_um, info, message)
      character(*), intent(in) :: text
      integer, intent(in) :: nwork, threads, room
      double precision, intent(in) :: work(*)
      integer, intent(inout) :: tried, failed(room)
      double precision, intent(inout), dimension(room) :: relief_um, worst_factor, rpm
      double precision, intent(inout) :: best_um, best_factor, best_rpm, within_um
      integer, intent(out) :: info
      character(*), intent(out) :: message
    end subroutine gs_optimum

    subroutine gs_outline(text, member, room, points, x_mm, y_mm, info, message)
      character(*), intent(in) :: text
      integer, intent(in) :: member, room
      integer, intent(inout) :: points
      double precision, intent(inout) :: x_mm(room), y_mm(room)
      integer, intent(out) :: info
      character(*), intent(out) :: message
    end subroutine gs_outline

    subroutine gs_section(text, nodes, elements, x_mm, y_mm, element, tooth, info, message)
      character(*), intent(in) :: text
      integer, intent(in) :: nodes, elements
      double precision, intent(inout) :: x_mm(nodes), y_mm(nodes)
      integer, intent(inout) :: element(8, elements), tooth(elements)
      integer, intent(out) :: info
      character(*), intent(out) :: message
    end subroutine gs_section

    subroutine gs_modes(text, modes, nodes, frequency_hz, estimate, residual, rim_share, shape, info, message)
      character(*), intent(in) :: text
      integer, intent(in) :: modes, nodes
      double precision, intent(inout), dimension(modes) :: frequency_hz, estimate, residual, rim_share
      double precision, intent(inout) :: shape(2, nodes, modes)
      integer, intent(out) :: info
      character(*), intent(out) :: message
    end subroutine gs_modes

    subroutine gs_root(text, nwork, work, positions, reliefs, relief_um, s, radius_mm, share, sigma_mpa, parts_mpa, &
                       tension_mpa, tension_deg, compression_mpa, compression_deg, estimate, iso_mpa, lewis_mpa, &
                       info, message)
      character(*), intent(in) :: text
      integer, intent(in) :: nwork, positions, reliefs
      double precision, intent(in) :: work(*)
      double precision, intent(inout), dimension(positions) :: s, radius_mm
      double precision, intent(inout) :: share(positions, reliefs), sigma_mpa(2, positions, reliefs)
      double precision, intent(inout) :: parts_mpa(3, 2, positions, reliefs), iso_mpa, lewis_mpa
      double precision, intent(inout), dimension(reliefs) :: relief_um, tension_mpa, tension_deg
      double precision, intent(inout), dimension(reliefs) :: compression_mpa, compression_deg, estimate
      integer, intent(out) :: info
      character(*), intent(out) :: message
    end subroutine gs_root

    subroutine gs_stress(text, nwork, work, position, relief, nodes, relief_um, s, radius_mm, share, sigma_mpa, &
                         info, message)
      character(*), intent(in) :: text
      integer, intent(in) :: nwork, position, relief, nodes
      double precision, intent(in) :: work(*)
      double precision, intent(inout) :: relief_um, s, radius_mm, share, sigma_mpa(3, nodes)
      integer, intent(out) :: info
      character(*), intent(out) :: message
    end subroutine gs_stress

    subroutine gs_stability(text, nwork, work, speeds, rpm, dampings, damping_ratio, tongues, modulus, sense, &
                            closing_ratio, closing_rpm, edge_rpm, info, message)
      character(*), intent(in) :: text
      integer, intent(in) :: nwork, speeds, dampings, tongues
      double precision, intent(in) :: work(*), rpm(speeds), damping_ratio(dampings)
      double precision, intent(inout) :: modulus(speeds, dampings), closing_ratio(tongues), closing_rpm(tongues)
      double precision, intent(inout) :: edge_rpm(2, dampings, tongues)
      integer, intent(inout) :: sense(speeds, dampings)
      integer, intent(out) :: info
      character(*), intent(out) :: message
    end subroutine gs_stability

    subroutine gs_follow(text, nwork, work, relief, speeds, rpm, jump, closeness, room, changes, change_rpm, &
                         change_factor, change_status, change_periods, dynamic_factor, estimate, status, contact, &
                         floquet_modulus, periods, x_um, v_mm_s, info, message)
      character(*), intent(in) :: text
      integer, intent(in) :: nwork, relief, speeds, room
      double precision, intent(in) :: work(*), rpm(speeds), jump, closeness
      double precision, intent(inout), dimension(speeds) :: dynamic_factor, estimate, floquet_modulus, x_um, v_mm_s
      integer, intent(inout), dimension(speeds) :: status, contact, periods
      integer, intent(inout) :: changes
      double precision, intent(inout), dimension(2, room) :: change_rpm, change_factor
      integer, intent(inout), dimension(2, room) :: change_status, change_periods
      integer, intent(out) :: info
      character(*), intent(out) :: message
    end subroutine gs_follow

    subroutine gs_strobe(text, nwork, work, relief, speeds, rpm, start_um, start_mm_s, settle, keep, x_um, v_mm_s, &
                         exponent, status, periods, info, message)
      character(*), intent(in) :: text
      integer, intent(in) :: nwork, relief, speeds, settle, keep
      double precision, intent(in) :: work(*), rpm(speeds), start_um, start_mm_s
      double precision, intent(inout), dimension(keep, speeds) :: x_um, v_mm_s
      double precision, intent(inout) :: exponent(speeds)
      integer, intent(inout), dimension(speeds) :: status, periods
      integer, intent(out) :: info
      character(*), intent(out) :: message
    end subroutine gs_strobe

  end interface
end module gearsweep_old_calls
