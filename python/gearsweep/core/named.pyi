"""The tables of studies and their columns, for editors. Made by python/tools/stub.py: change that one."""

from numpy import float64, int64, str_
from numpy.typing import NDArray

from .table import Table

class GeometryTable(Table):
    """the gear pair"""

    module_mm: float
    """mm: normal module"""
    pressure_angle_deg: float
    """deg: of the drive flanks on the reference circle"""
    coast_angle_deg: float
    """deg: of the coast flanks on the reference circle"""
    face_width_mm: float
    """mm: face width of the contact"""
    centre_distance_mm: float
    """mm: centre distance"""
    working_angle_deg: float
    """deg: working pressure angle of the drive flanks"""
    coast_working_angle_deg: float
    """deg: working pressure angle of the coast flanks"""
    backlash_um: float
    """um: along the line of action: as backlash_um of &pair states it, else what centre distance and tooth thickness leave"""
    rounding_um: float
    """um: how far the centre distance lies below the one without backlash, by rounding of the inputs"""
    shorten_path: int
    """1 where the path of contact may end where undercut ends an involute, else 0"""
    contact_ratio: float
    """transverse contact ratio: the path of contact in base pitches"""
    coast_contact_ratio: float
    """the same of the coast flanks, where they carry; undercut takes its part off"""
    base_pitch_mm: float
    """mm: of the drive flanks"""
    transverse_module_mm: float
    """mm: module of helical gears in the transverse section"""
    transverse_angle_deg: float
    """deg: pressure angle of helical gears in the transverse section"""
    overlap_ratio: float
    """overlap ratio of helical gears: face width over axial pitch"""
    total_contact_ratio: float
    """total contact ratio of helical gears: contact ratio plus overlap ratio"""

class GearsTable(Table):
    """the two gears"""

    gear: NDArray[str_]
    """pinion or gear"""
    teeth: NDArray[int64]
    """number of teeth"""
    profile_shift: NDArray[float64]
    """profile shift coefficient x"""
    tip_diameter_mm: NDArray[float64]
    """mm: tip circle"""
    tip_form_diameter_mm: NDArray[float64]
    """mm: circle where the involute of the drive flank ends: the tip circle, or where its chamfer or rounding begins"""
    tip_thickness_mm: NDArray[float64]
    """mm: of the tooth on the tip circle, between its chamfers or roundings"""
    reference_diameter_mm: NDArray[float64]
    """mm: reference circle"""
    base_diameter_mm: NDArray[float64]
    """mm: base circle of the drive flanks"""
    coast_base_diameter_mm: NDArray[float64]
    """mm: base circle of the coast flanks"""
    root_diameter_mm: NDArray[float64]
    """mm: root circle"""
    form_diameter_mm: NDArray[float64]
    """mm: circle where the involute of the drive flank begins"""
    coast_form_diameter_mm: NDArray[float64]
    """mm: circle where the involute of the coast flank begins"""
    active_diameter_mm: NDArray[float64]
    """mm: circle where contact on the drive flank begins, d_Nf"""
    undercut: NDArray[int64]
    """1 where undercut of the drive flank cuts into the involute above the base circle, else 0"""
    fillet_undercut_mm: NDArray[float64]
    """mm: how deep a tool with protuberance cut the fillet in beside the finished flank, s_pr"""
    lost_path_mm: NDArray[float64]
    """mm: what undercut of this gear takes off the path of contact (shorten_path)"""
    generating_shift: NDArray[float64]
    """generating profile shift coefficient x_E"""
    reference_thickness_mm: NDArray[float64]
    """mm: tooth thickness on the reference circle, as generated"""
    span_teeth: NDArray[int64]
    """number of teeth k that the span measurement takes; 0: none can be spanned"""
    span_mm: NDArray[float64]
    """mm: span measurement W_k, base tangent length"""
    pin_diameter_mm: NDArray[float64]
    """mm: pins that the gear is measured over"""
    over_pins_mm: NDArray[float64]
    """mm: diameter over pins M_dK"""
    helix_angle_deg: NDArray[float64]
    """deg: helix angle of helical gears on the reference circle; positive: right-handed"""
    base_helix_angle_deg: NDArray[float64]
    """deg: helix angle of helical gears on the base circle; positive: right-handed"""

class ContactPointsTable(Table):
    """points of the path of contact: A start, B and D where another pair leaves and enters, P pitch point, E end"""

    point: NDArray[str_]
    """its letter"""
    s: NDArray[float64]
    """path coordinate from A, in base pitches"""
    pinion_radius_mm: NDArray[float64]
    """mm: radius at which the pinion touches"""
    gear_radius_mm: NDArray[float64]
    """mm: radius at which the gear touches"""

class OutlineTable(Table):
    """outline of both gears, each about its own centre"""

    gear: NDArray[str_]
    """pinion or gear"""
    x_mm: NDArray[float64]
    """mm: across the tooth that stands upright, towards its drive side"""
    y_mm: NDArray[float64]
    """mm: along the axis of that tooth"""

class MeshTable(Table):
    """one pair along its path of contact, static, for each relief"""

    relief_um: NDArray[float64]
    """um: amount of relief"""
    s: NDArray[float64]
    """path coordinate of the pair, in base pitches from A; below 0 before A"""
    pair_stiffness_n_um: NDArray[float64]
    """N/um: stiffness of this pair, whole face width, as in the motion"""
    mesh_stiffness_n_um: NDArray[float64]
    """N/um: of all pairs that carry load; of whole gears also their discs"""
    profile_error_um: NDArray[float64]
    """um: material missing at this point, both flanks together; beyond A and E with the gap of the tip corner, along the line of action"""
    load_share: NDArray[float64]
    """static load of this pair over the whole load"""
    ste_um: NDArray[float64]
    """um: static transmission error along the line of action"""
    pair_stiffness_estimate_n_um: NDArray[float64]
    """N/um: estimated error of pair_stiffness_n_um by the grid of its finite elements"""
    path_mm: NDArray[float64]
    """mm: distance from A on the line of action"""
    pinion_radius_mm: NDArray[float64]
    """mm: radius at which the pinion touches"""
    pinion_curvature_mm: NDArray[float64]
    """mm: radius of curvature of the pinion's flank"""
    gear_curvature_mm: NDArray[float64]
    """mm: radius of curvature of the gear's flank"""

class TransmissionErrorTable(Table):
    """static transmission error and load sharing over a mesh period, for each relief"""

    relief_um: NDArray[float64]
    """um: amount of relief"""
    peak_to_peak_um: NDArray[float64]
    """um: peak-to-peak transmission error"""
    mean_um: NDArray[float64]
    """um: mean transmission error"""
    rms_um: NDArray[float64]
    """um: root mean square deviation from the mean"""
    error_estimate_um: NDArray[float64]
    """um: estimated error of mean and amplitudes, without rounding errors"""
    largest_load_share: NDArray[float64]
    """largest load of a pair over the static load"""
    effective_contact_ratio: NDArray[float64]
    """length of the path over which a pair carries load, in base pitches"""
    mean_grid_estimate_um: NDArray[float64]
    """um: estimated error of mean_um by the grid of the finite elements"""
    grid_estimate_um: NDArray[float64]
    """um: by how much their grid changes peak_to_peak_um at most, estimated; rms and amplitudes by less"""

class HarmonicsTable(Table):
    """static transmission error for each relief, as the sum of amplitude cos(2 pi harmonic tau + phase) over the mesh phase tau, 0 where a pair enters at A; harmonic 0 is the mean"""

    relief_um: NDArray[float64]
    """um: amount of relief"""
    harmonic: NDArray[int64]
    """0 for the mean, 1, 2 ... up to ste_harmonics"""
    amplitude_um: NDArray[float64]
    """um: half of peak-to-peak; the mean for harmonic 0"""
    phase_deg: NDArray[float64]
    """deg: where the amplitude is larger than its error"""
    error_estimate_um: NDArray[float64]
    """um: estimated error of mean and amplitudes, without rounding errors"""

class StaticTable(Table):
    """stress at tangent_deg of the fillet for each relief and position of the load"""

    relief_um: NDArray[float64]
    """um: amount of relief"""
    s: NDArray[float64]
    """path coordinate of the load, in base pitches from A"""
    radius_mm: NDArray[float64]
    """mm: radius at which it acts on this gear"""
    load_share: NDArray[float64]
    """load of this pair over the whole load"""
    side: NDArray[str_]
    """drive (the loaded side: tension) or coast"""
    sigma_mpa: NDArray[float64]
    """MPa: stress along the surface"""
    sigma_x_mpa: NDArray[float64]
    """MPa: component across the tooth, x to its drive side"""
    sigma_y_mpa: NDArray[float64]
    """MPa: component along the tooth's axis y"""
    tau_xy_mpa: NDArray[float64]
    """MPa: shear component"""

class RootStressTable(Table):
    """largest stress in the root fillets over the path of contact"""

    relief_um: NDArray[float64]
    """um: amount of relief"""
    tension_mpa: NDArray[float64]
    """MPa: largest tension along the surface"""
    tension_deg: NDArray[float64]
    """deg: angle of the fillet tangent there to the tooth's axis"""
    compression_mpa: NDArray[float64]
    """MPa: largest compression along the surface, negative"""
    compression_deg: NDArray[float64]
    """deg: angle of the fillet tangent there to the tooth's axis"""
    error_estimate: NDArray[float64]
    """estimated error of the stresses, relative"""

class RootRatingTable(Table):
    """nominal root stress by ISO 6336-3 and by Lewis, the whole load at the outer point of single contact"""

    gear: str
    """pinion or gear"""
    point: str
    """of the path of contact where the load acts"""
    iso_mpa: float
    """MPa: sigma_F0 of ISO 6336-3, which takes the load there up to a contact ratio of 2"""
    iso_form_factor: float
    """Y_F"""
    iso_stress_correction: float
    """Y_S"""
    iso_thickness_mm: float
    """mm: s_Fn, thickness of the tooth at the 30 degree tangents"""
    iso_lever_mm: float
    """mm: h_Fe, lever of the load over that section"""
    iso_radius_mm: float
    """mm: rho_F, radius of the fillet there"""
    iso_angle_deg: float
    """deg: alpha_Fen, angle of the load to the normal of the tooth's axis"""
    equal_flanks: int
    """1 where both flanks have one pressure angle, as ISO 6336-3 means it, else 0"""
    lewis_mpa: float
    """MPa: by Lewis: F_n cos(alpha_L)/(b m Y), alpha_L the angle of the load to the normal of the tooth axis"""
    lewis_form_factor: float
    """Y = s^2/(6 h m): s tooth thickness and h lever arm where Lewis's parabola touches the fillet"""

class StressLoadTable(Table):
    """the load under which the stress is given all over the section"""

    relief_um: float
    """um: amount of relief: the one with the largest tension"""
    position: int
    """of the load, counted from 1 in the table static"""
    s: float
    """path coordinate of the load, in base pitches from A"""
    radius_mm: float
    """mm: radius at which it acts on this gear"""
    load_share: float
    """load of this pair over the whole load"""

class SectionTable(Table):
    """section of one gear and its grid"""

    gear: str
    """pinion or gear"""
    teeth: int
    """teeth of the section"""
    gear_teeth: int
    """teeth of the whole gear"""
    half_angle_deg: float
    """deg: half of the sector's angle"""
    inner_radius_mm: float
    """mm: where the section ends inwards"""
    elements: int
    """of eight nodes"""
    nodes: int
    """each with two displacements"""
    smallest_scaled_jacobian: float
    """of the elements: 1 is a rectangle, 0 useless"""
    area_mm2: float
    """mm2: of all elements"""

class ModalTable(Table):
    """natural frequencies of the section"""

    mode: NDArray[int64]
    """from the lowest frequency"""
    frequency_hz: NDArray[float64]
    """Hz: natural frequency"""
    error_estimate: NDArray[float64]
    """estimated discretisation error, relative"""
    residual: NDArray[float64]
    """residual of the eigenvalue problem, relative"""
    rim_share: NDArray[float64]
    """kinetic energy of the body below the teeth over the whole"""

class ModeEnergyTable(Table):
    """kinetic energy of each mode by part of the section"""

    mode: NDArray[int64]
    """from the lowest frequency"""
    tooth: NDArray[int64]
    """counted from the coast side; 0 for the body below the teeth"""
    energy_share: NDArray[float64]
    """kinetic energy of this part over the whole"""

class FaceLoadTable(Table):
    """load over the face width of each pair over a mesh period, for each relief"""

    relief_um: NDArray[float64]
    """um: amount of relief"""
    mesh_phase: NDArray[float64]
    """fraction of the mesh period, 0 where a pair enters at A, of helical gears at z = 0; both sides of a break"""
    s: NDArray[float64]
    """path coordinate of the pair at this place, in base pitches from A; oblique lines are off the path below 0 and above the contact ratio"""
    z_mm: NDArray[float64]
    """mm: place of the slice's middle along the face"""
    slice_mm: NDArray[float64]
    """mm: width of the slice"""
    gap_um: NDArray[float64]
    """um: gap of the flanks by misalignment, leads and the shaft's deflection, without tip relief"""
    line_load_n_mm: NDArray[float64]
    """N/mm: load of the slice over its width"""
    pressure_mpa: NDArray[float64]
    """MPa: Hertz's pressure under it"""

class FaceLoadPhasesTable(Table):
    """load over the face width over a mesh period, for each relief"""

    relief_um: NDArray[float64]
    """um: amount of relief"""
    mesh_phase: NDArray[float64]
    """fraction of the mesh period, 0 where a pair enters at A, of helical gears at z = 0; both sides of a break"""
    pairs: NDArray[int64]
    """pairs in contact"""
    ste_um: NDArray[float64]
    """um: static transmission error along the line of action"""
    mesh_stiffness_n_um: NDArray[float64]
    """N/um: tangent stiffness of the mesh: load over deflection for a small change"""
    face_load_factor: NDArray[float64]
    """largest load on one module of the face over the mean, of all pairs together"""

class FaceLoadSummaryTable(Table):
    """face load factors for each relief"""

    relief_um: NDArray[float64]
    """um: amount of relief"""
    face_load_factor: NDArray[float64]
    """K_H_beta in the middle of contact of the fewest pairs, of helical gears of the mean over the mesh period: largest load on one module of the face over the mean"""
    mean_face_load_factor: NDArray[float64]
    """K_H_beta of the load's mean over the mesh period"""
    worst_face_load_factor: NDArray[float64]
    """K_H_beta at the phase where it is largest"""
    worst_phase: NDArray[float64]
    """that mesh phase"""
    root_face_load_factor: NDArray[float64]
    """K_F_beta: largest root stress along the face over that of an even load, at the outer points of contact of the fewest pairs, of helical gears under the mean load"""
    edge_load: NDArray[float64]
    """mean over the period of the load on the outermost module of the face, larger end, over the mean"""
    face_in_contact: NDArray[float64]
    """fraction of the face that carries in the middle of contact of the fewest pairs, of helical gears of all lines, as the mean over the mesh period"""
    largest_pressure_mpa: NDArray[float64]
    """MPa: largest Hertz pressure of a slice"""
    ste_peak_to_peak_um: NDArray[float64]
    """um: peak-to-peak static transmission error"""
    iso_face_load_factor: NDArray[float64]
    """K_H_beta of ISO 6336-1, method C, for the misalignment and 1.33 f_sh, without crowning, end relief and running in"""
    largest_line_load_n_mm: NDArray[float64]
    """N/mm: largest load of a slice over its width"""
    ste_mean_um: NDArray[float64]
    """um: mean static transmission error"""
    mesh_stiffness_n_um: NDArray[float64]
    """N/um: mean tangent stiffness of the mesh"""
    misalignment_um: NDArray[float64]
    """um: misalignment with both lead slopes"""
    shaft_gap_um: NDArray[float64]
    """um: largest gap by twist and bending of pinion and shaft; 0 for a rigid shaft"""
    iso_shaft_misalignment_um: NDArray[float64]
    """um: f_sh of ISO 6336-1 for that shaft"""

class FaceMisalignmentsTable(Table):
    """face load factors over the misalignment, for each relief"""

    relief_um: NDArray[float64]
    """um: amount of relief"""
    misalignment_um: NDArray[float64]
    """um: misalignment without lead slopes"""
    face_load_factor: NDArray[float64]
    """K_H_beta in the middle of contact of the fewest pairs, of helical gears of the mean over the mesh period: largest load on one module of the face over the mean"""
    mean_face_load_factor: NDArray[float64]
    """K_H_beta of the load's mean over the mesh period"""
    worst_face_load_factor: NDArray[float64]
    """K_H_beta at the phase where it is largest"""
    worst_phase: NDArray[float64]
    """that mesh phase"""
    root_face_load_factor: NDArray[float64]
    """K_F_beta: largest root stress along the face over that of an even load, at the outer points of contact of the fewest pairs, of helical gears under the mean load"""
    edge_load: NDArray[float64]
    """mean over the period of the load on the outermost module of the face, larger end, over the mean"""
    face_in_contact: NDArray[float64]
    """fraction of the face that carries in the middle of contact of the fewest pairs, of helical gears of all lines, as the mean over the mesh period"""
    largest_pressure_mpa: NDArray[float64]
    """MPa: largest Hertz pressure of a slice"""
    ste_peak_to_peak_um: NDArray[float64]
    """um: peak-to-peak static transmission error"""
    iso_face_load_factor: NDArray[float64]
    """K_H_beta of ISO 6336-1, method C, for the misalignment and 1.33 f_sh, without crowning, end relief and running in"""

class LoadTable(Table):
    """dynamic load of one pair along its path of contact"""

    relief_um: NDArray[float64]
    """um: amount of relief"""
    rpm: NDArray[float64]
    """1/min: speed of the pinion"""
    s: NDArray[float64]
    """path coordinate of the pair, in base pitches from A"""
    pair_load_n: NDArray[float64]
    """N: elastic load on the pair"""
    load_ratio: NDArray[float64]
    """the same over the static load; its largest value is DF, up to the refinement of the peak between two rows"""
    dte_um: NDArray[float64]
    """um: dynamic transmission error along the line of action, without the turning of whole gears about their bores"""
    status: NDArray[str_]
    """how the operating point ended, in a word"""
    mesh_periods: NDArray[int64]
    """mesh periods until the motion repeats"""
    pair: NDArray[int64]
    """index of the pair, from 1; 0 without an answer"""

class LoadPointsTable(Table):
    """dynamic factor and what else is read off the motion, at the speeds of the task load"""

    relief_um: NDArray[float64]
    """um: amount of relief"""
    rpm: NDArray[float64]
    """1/min: speed of the pinion"""
    dynamic_factor: NDArray[float64]
    """dynamic factor DF: largest load of a pair over the static load; NaN where there is no answer"""
    error_estimate: NDArray[float64]
    """estimated error of DF; NaN where there is no answer or it is not known"""
    status: NDArray[str_]
    """how the operating point ended, in a word"""
    mesh_periods: NDArray[int64]
    """mesh periods until the motion repeats"""
    motions: NDArray[float64]
    """how many motions attract at this speed, of which this is the one with the largest DF; NaN where that is not known"""
    coast_factor: NDArray[float64]
    """largest load on the coast sides over the static load; 0 where they do not touch; NaN where there is no answer"""
    mean_load_ratio: NDArray[float64]
    """mean elastic load of the mesh over the static load: all pairs less the coast sides; what is left is carried by damping; NaN where there is no answer"""
    load_rms_ratio: NDArray[float64]
    """root mean square deviation of that load from its mean, over the static load; NaN where there is no answer"""
    pair_load_rms_ratio: NDArray[float64]
    """root mean square of the load on a pair over its path, over the static load; NaN where there is no answer"""
    impacts: NDArray[float64]
    """how often flanks meet after all had been apart, in a mesh period; NaN where there is no answer"""
    load_reversals: NDArray[float64]
    """how often the load goes over to the other sides of the teeth, in a mesh period; NaN where there is no answer"""
    separation_share: NDArray[float64]
    """part of the time during which all flanks are apart; NaN where there is no answer"""
    dte_mean_um: NDArray[float64]
    """um: mean dynamic transmission error; NaN where there is no answer"""
    dte_rms_um: NDArray[float64]
    """um: root mean square deviation from that; NaN where there is no answer"""
    dte_peak_to_peak_um: NDArray[float64]
    """um: peak-to-peak dynamic transmission error; NaN where there is no answer"""

class MotionHarmonicsTable(Table):
    """dynamic transmission error and elastic load of the mesh, each as the sum of amplitude cos(2 pi harmonic tau + phase) over the mesh periods tau; harmonic 0 is the mean"""

    relief_um: NDArray[float64]
    """um: amount of relief"""
    rpm: NDArray[float64]
    """1/min: speed of the pinion"""
    harmonic: NDArray[float64]
    """0 for the mean, 1, 2 ... up to motion_harmonics for the mesh frequency; of a motion that repeats after several mesh periods, also the parts between"""
    frequency_hz: NDArray[float64]
    """Hz: frequency of that harmonic"""
    dte_amplitude_um: NDArray[float64]
    """um: half of peak-to-peak of the dynamic transmission error; the mean for harmonic 0"""
    dte_phase_deg: NDArray[float64]
    """deg: its phase at tau = 0, where a pair enters at A"""
    mesh_load_amplitude_n: NDArray[float64]
    """N: the same of the elastic load of the mesh: all pairs less the coast sides"""
    mesh_load_phase_deg: NDArray[float64]
    """deg: its phase at tau = 0"""

class TorqueTable(Table):
    """transmitted torque over the time after which the motion repeats"""

    relief_um: NDArray[float64]
    """um: amount of relief"""
    rpm: NDArray[float64]
    """1/min: speed of the pinion"""
    tau: NDArray[float64]
    """time in mesh periods since a pair entered at A; both ends of each step"""
    time_s: NDArray[float64]
    """s: the same time"""
    pinion_torque_nm: NDArray[float64]
    """N m: torque that the mesh takes from the pinion"""
    gear_torque_nm: NDArray[float64]
    """N m: torque that the mesh gives to the gear"""
    pinion_friction_nm: NDArray[float64]
    """N m: friction's share of the pinion's torque"""
    gear_friction_nm: NDArray[float64]
    """N m: friction's share of the gear's torque"""
    pinion_damping_nm: NDArray[float64]
    """N m: what damping carries of the pinion's torque; of the gear's it carries as much as the base radii have it"""
    dte_um: NDArray[float64]
    """um: dynamic transmission error along the line of action, without the turning of whole gears about their bores"""

class TorquePointsTable(Table):
    """mean, least and largest transmitted torque at the speeds of the task load"""

    relief_um: NDArray[float64]
    """um: amount of relief"""
    rpm: NDArray[float64]
    """1/min: speed of the pinion"""
    pinion_mean_nm: NDArray[float64]
    """N m: mean torque of the pinion; without friction it is the static one"""
    pinion_least_nm: NDArray[float64]
    """N m: least torque"""
    pinion_largest_nm: NDArray[float64]
    """N m: largest torque"""
    pinion_error_nm: NDArray[float64]
    """N m: estimated error of these three; NaN where it is not known"""
    pinion_friction_mean_nm: NDArray[float64]
    """N m: friction's share of the mean torque"""
    gear_mean_nm: NDArray[float64]
    """N m: mean torque of the gear; without friction it is the static one"""
    gear_least_nm: NDArray[float64]
    """N m: least torque"""
    gear_largest_nm: NDArray[float64]
    """N m: largest torque"""
    gear_error_nm: NDArray[float64]
    """N m: estimated error of these three; NaN where it is not known"""
    gear_friction_mean_nm: NDArray[float64]
    """N m: friction's share of the mean torque"""
    friction_loss: NDArray[float64]
    """part of the pinion's power that friction between the flanks takes"""
    dynamic_factor: NDArray[float64]
    """dynamic factor DF: largest load of a pair over the static load; NaN where there is no answer"""
    error_estimate: NDArray[float64]
    """estimated error of DF; NaN where there is no answer or it is not known"""
    status: NDArray[str_]
    """how the operating point ended, in a word"""
    mesh_periods: NDArray[int64]
    """mesh periods until the motion repeats"""
    motions: NDArray[float64]
    """how many motions attract at this speed, of which this is the one with the largest DF; NaN where that is not known"""

class TorqueHarmonicsTable(Table):
    """transmitted torque as the sum of amplitude cos(2 pi harmonic tau + phase) over the mesh periods tau; harmonic 0 is the mean"""

    relief_um: NDArray[float64]
    """um: amount of relief"""
    rpm: NDArray[float64]
    """1/min: speed of the pinion"""
    harmonic: NDArray[float64]
    """0 for the mean, 1, 2 ... up to motion_harmonics for the mesh frequency; of a motion that repeats after several mesh periods, also the parts between"""
    frequency_hz: NDArray[float64]
    """Hz: frequency of that harmonic"""
    pinion_amplitude_nm: NDArray[float64]
    """N m: half of peak-to-peak of the torque of the pinion; the mean for harmonic 0"""
    pinion_phase_deg: NDArray[float64]
    """deg: its phase at tau = 0, where a pair enters at A, where the amplitude is larger than its error"""
    pinion_error_nm: NDArray[float64]
    """N m: estimated error of the amplitude; NaN where it is not known"""
    gear_amplitude_nm: NDArray[float64]
    """N m: half of peak-to-peak of the torque of the gear; the mean for harmonic 0"""
    gear_phase_deg: NDArray[float64]
    """deg: its phase at tau = 0, where a pair enters at A, where the amplitude is larger than its error"""
    gear_error_nm: NDArray[float64]
    """N m: estimated error of the amplitude; NaN where it is not known"""

class SweepTable(Table):
    """dynamic factor over speed and relief"""

    relief_um: NDArray[float64]
    """um: amount of relief"""
    rpm: NDArray[float64]
    """1/min: speed of the pinion"""
    dynamic_factor: NDArray[float64]
    """dynamic factor DF: largest load of a pair over the static load; NaN where there is no answer"""
    error_estimate: NDArray[float64]
    """estimated error of DF; NaN where there is no answer or it is not known"""
    status: NDArray[str_]
    """how the operating point ended, in a word"""
    contact: NDArray[str_]
    """full; partial: a pair was apart for a while; lost: all were; coast: the coast sides touched"""
    floquet_modulus: NDArray[float64]
    """largest modulus of the Floquet multipliers: what remains of a disturbance after the motion has repeated once; of a chaotic motion, its mean growth in a mesh period; NaN where it is not known"""
    residual: NDArray[float64]
    """by how much the motion fails to repeat, in static deflections"""
    steps: NDArray[int64]
    """steps in a mesh period"""
    mesh_periods: NDArray[int64]
    """mesh periods until the motion repeats"""
    branch_lost: NDArray[int64]
    """with direction up, down or both: 1 if the motion at the previous speed led to none here, else 0"""
    frequency_ratio: NDArray[float64]
    """mesh frequency over the natural frequency of the mean mesh stiffness"""
    coast_factor: NDArray[float64]
    """largest load on the coast sides over the static load; 0 where they do not touch; NaN where there is no answer"""
    dte_rms_um: NDArray[float64]
    """um: root mean square of the dynamic transmission error about its mean over the steady motion; NaN where there is no answer"""
    dte_peak_to_peak_um: NDArray[float64]
    """um: peak-to-peak dynamic transmission error of the steady motion; NaN where there is no answer"""
    dte_error_estimate_um: NDArray[float64]
    """um: estimated error of either of these; NaN: not known"""
    seen_dynamic_factor: NDArray[float64]
    """largest load of a pair over the static load that was seen in a motion that does not repeat: a lower bound; NaN where each motion that was met repeats"""
    seen_dte_rms_um: NDArray[float64]
    """um: root mean square deviation of its dynamic transmission error from its mean"""
    seen_dte_peak_to_peak_um: NDArray[float64]
    """um: peak-to-peak value of that error; a lower bound too"""
    seen_periods: NDArray[int64]
    """mesh periods over which that motion was watched; 0: none"""
    motions: NDArray[float64]
    """with direction all: how many motions attract at this speed"""
    largest_dynamic_factor: NDArray[float64]
    """with direction all: largest DF of these, without those that no start reaches"""
    share: NDArray[float64]
    """with direction all: share of the starts that lead to the motion of this row"""

class SweepWorstTable(Table):
    """largest dynamic factor of the sweep for each relief"""

    relief_um: NDArray[float64]
    """um: amount of relief"""
    worst_dynamic_factor: NDArray[float64]
    """largest DF over the speeds; NaN where none has an answer"""
    rpm: NDArray[float64]
    """1/min: speed of the pinion where that is"""
    seen_dynamic_factor: NDArray[float64]
    """largest load of a pair over the static load that was seen in a motion that does not repeat: a lower bound; NaN where each motion repeats"""
    seen_rpm: NDArray[float64]
    """1/min: speed of the pinion where that is"""

class ResonancesTable(Table):
    """largest dynamic factor of each relief about the peaks of the least relieved mesh, within 15 % and half-way to the next"""

    relief_um: NDArray[float64]
    """um: amount of relief"""
    resonance_rpm: NDArray[float64]
    """1/min: speed of the pinion at a peak of the dynamic factor: a resonance, or where a bent branch of motions ends and the motion jumps"""
    dynamic_factor: NDArray[float64]
    """largest DF within 15 % of that speed, and no farther than half-way to the next peak; NaN where none has an answer"""
    rpm: NDArray[float64]
    """1/min: speed of the pinion where that is"""

class SweepSummaryTable(Table):
    """the points of the sweep, and the best of the listed reliefs"""

    best_relief_um: float
    """um: of the listed reliefs, the one whose largest DF, or seen DF where that is larger, is least; NaN where the sweep was interrupted"""
    worst_dynamic_factor: float
    """largest DF over the speeds with that relief"""
    rpm: float
    """1/min: speed of the pinion where that is"""
    speeds: int
    """of the pinion"""
    points: int
    """speeds times reliefs"""
    points_without_answer: int
    """points without a dynamic factor"""
    largest_error_estimate: float
    """largest estimated error of a dynamic factor"""
    tolerance: float
    """largest error that the case asks for"""
    points_with_contact_loss: int
    """points at which all pairs were apart for a while"""
    seen_dynamic_factor: float
    """largest load of a pair over the static load that was seen in a motion that does not repeat: a lower bound, at any point; NaN where each motion repeats"""
    seen_periods: int
    """mesh periods over which that motion was watched; 0: none"""
    points_ok: int
    """steady, stable and periodic with the mesh"""
    points_marginal: int
    """periodic, but transients do not die out"""
    points_subharmonic: int
    """the motion repeats only after several mesh periods"""
    points_inexact: int
    """the estimated error exceeds the tolerance"""
    points_unstable: int
    """the periodic motion repels, and no steady motion was reached"""
    points_aperiodic: int
    """nothing is damped, and no periodic motion was found"""
    points_unresolved: int
    """the speed is too low for the steps given or allowed"""
    points_chatter: int
    """contact changes without end"""
    points_chaotic: int
    """no periodic motion was found, and disturbances keep growing"""
    points_transient: int
    """the transient had not died away when the march ended"""
    points_unbounded: int
    """the deflection passed 1e4 static ones; no bound was seen"""
    points_stopped: int
    """not computed, as the run was interrupted"""

class OptimumTable(Table):
    """the best amount of relief, and by what it is judged"""

    relief_um: float
    """um: best amount of relief; NaN where no point has an answer"""
    worst_dynamic_factor: float
    """largest DF over the speeds; NaN where none has an answer (over several torques as over_torques says)"""
    rpm: float
    """1/min: speed of the pinion where what is judged is largest, under the worst torque"""
    largest_dynamic_factor: float
    """largest DF at that speed of all motions that are known: its own, and those that a start reaches; NaN where there is none"""
    within_um: float
    """um: largest distance to the true optimum"""
    points_without_answer: int
    """speeds without an answer there; of all reliefs where no point has one"""
    ste_peak_to_peak_um: float
    """um: peak-to-peak static transmission error, over several torques as over_torques says"""
    mesh_harmonic_um: float
    """um: amplitude of the harmonic of the static transmission error that &optimum harmonic names, over several torques as over_torques says"""
    torque_nm: float
    """N m: the torque on the pinion under which what is judged is largest; NaN: not known"""
    judged: str
    """what is judged: &optimum judged"""
    over_torques: str
    """which of several torques counts: the worst, or their weighted mean"""

class OptimumCurveTable(Table):
    """what is judged against the relief, all torques together"""

    relief_um: NDArray[float64]
    """um: amount of relief, ascending"""
    worst_dynamic_factor: NDArray[float64]
    """largest DF over the speeds; NaN where none has an answer"""
    rpm: NDArray[float64]
    """1/min: speed of the pinion where what is judged is largest"""
    points_without_answer: NDArray[int64]
    """speeds without an answer"""
    at_least: NDArray[int64]
    """1: computed at a few speeds only, which show that this relief is not the best; the largest DF is theirs; else 0"""
    ste_peak_to_peak_um: NDArray[float64]
    """um: peak-to-peak static transmission error"""
    mesh_harmonic_um: NDArray[float64]
    """um: amplitude of the harmonic of the static transmission error that &optimum harmonic names"""

class OptimumMapTable(Table):
    """transmission error and what is judged, for each relief that was tried under each torque"""

    relief_um: NDArray[float64]
    """um: amount of relief, ascending"""
    torque_nm: NDArray[float64]
    """N m: torque on the pinion"""
    ste_peak_to_peak_um: NDArray[float64]
    """um: peak-to-peak static transmission error"""
    mesh_harmonic_um: NDArray[float64]
    """um: amplitude of the harmonic of the static transmission error that &optimum harmonic names"""
    worst_dynamic_factor: NDArray[float64]
    """largest DF over the speeds; NaN where none has an answer"""
    rpm: NDArray[float64]
    """1/min: speed of the pinion where what is judged is largest"""
    points_without_answer: NDArray[int64]
    """speeds without an answer"""
    at_least: NDArray[int64]
    """1: computed at a few speeds only, which show that this relief is not the best; the largest DF is theirs; else 0"""

class OptimumDesignTable(Table):
    """the best reliefs of both gears, by what is judged"""

    pinion_relief_um: float
    """um: amount of relief at the pinion's tip; NaN where no point has an answer"""
    gear_relief_um: float
    """um: at the gear's"""
    pinion_relief_start: float
    """path coordinate at which the pinion's relief begins, in base pitches from A"""
    gear_relief_start: float
    """at which the gear's begins"""
    pinion_start_diameter_mm: float
    """mm: diameter of the pinion at which its relief begins; NaN for a prescribed mesh"""
    gear_start_diameter_mm: float
    """mm: the same of the gear"""
    worst_dynamic_factor: float
    """largest DF over the speeds; NaN where none has an answer (over several torques as over_torques says)"""
    within: float
    """no better design was found within this part of the ranges, up and down"""
    designs_tried: int
    """designs tried"""
    ste_peak_to_peak_um: float
    """um: peak-to-peak static transmission error, over several torques as over_torques says"""
    mesh_harmonic_um: float
    """um: amplitude of the harmonic of the static transmission error that &optimum harmonic names, over several torques as over_torques says"""

class OptimumLoadsTable(Table):
    """the best reliefs under each torque"""

    torque_nm: NDArray[float64]
    """N m: torque on the pinion"""
    ste_peak_to_peak_um: NDArray[float64]
    """um: peak-to-peak static transmission error"""
    mesh_harmonic_um: NDArray[float64]
    """um: amplitude of the harmonic of the static transmission error that &optimum harmonic names"""
    worst_dynamic_factor: NDArray[float64]
    """largest DF over the speeds; NaN where none has an answer"""
    rpm: NDArray[float64]
    """1/min: speed of the pinion where what is judged is largest"""
    points_without_answer: NDArray[int64]
    """speeds without an answer"""

class DeflectionReliefTable(Table):
    """tip reliefs by several methods, and what they do"""

    method: NDArray[str_]
    """none: without relief; markovic_vrcan: bending and half the flattening by the formula; whole_flattening: bending and all of it; finite_elements: the deflection by finite elements, of the stiffness model fe; transmission_error: the least peak-to-peak static transmission error; dynamic_factor: the least of the largest dynamic factors over the speeds, where one has an answer"""
    pinion_relief_um: NDArray[float64]
    """um: amount of relief at the pinion's tip"""
    gear_relief_um: NDArray[float64]
    """um: amount of relief at the gear's tip"""
    within_um: NDArray[float64]
    """um: largest distance to the true least; NaN without a search"""
    ste_range_um: NDArray[float64]
    """um: peak-to-peak static transmission error with this relief"""
    worst_dynamic_factor: NDArray[float64]
    """largest DF over the speeds; NaN where none has an answer"""
    rpm: NDArray[float64]
    """1/min: speed of the pinion where that is"""
    points_without_answer: NDArray[int64]
    """speeds without an answer"""

class ReliefDeflectionTable(Table):
    """deflection of the teeth under the whole load"""

    gear: NDArray[str_]
    """pinion or gear"""
    load_diameter_mm: NDArray[float64]
    """mm: diameter at which the load acts"""
    start_diameter_mm: NDArray[float64]
    """mm: diameter at which relief begins, d_k"""
    load_height_mm: NDArray[float64]
    """mm: y_p: height of the load above the root circle, along the tooth's axis"""
    half_width_um: NDArray[float64]
    """um: b_H: half width of the contact there, by Hertz"""
    bending_um: NDArray[float64]
    """um: delta_b: bending of the tooth on its body, by the formula"""
    flattening_um: NDArray[float64]
    """um: delta_H: flattening of this flank, by the formula"""
    formula_deflection_um: NDArray[float64]
    """um: their sum"""
    fe_deflection_um: NDArray[float64]
    """um: deflection of the tooth by finite elements, flattening included; NaN without the stiffness model fe"""

class ReliefCurveTable(Table):
    """static transmission error and dynamic factor over the amount of relief"""

    relief_um: NDArray[float64]
    """um: amount of relief, ascending"""
    ste_range_um: NDArray[float64]
    """um: peak-to-peak static transmission error"""
    worst_dynamic_factor: NDArray[float64]
    """largest DF over the speeds; NaN where none has an answer"""
    at_least: NDArray[int64]
    """1: computed at a few speeds only, which show that this relief is not the best; the largest DF is theirs; else 0"""

class ReliefFlankTable(Table):
    """relief of the flanks at chosen diameters, by each method"""

    method: NDArray[str_]
    """as in the table deflection_relief"""
    gear: NDArray[str_]
    """pinion or gear"""
    diameter_mm: NDArray[float64]
    """mm: diameter on the flank"""
    roll_deg: NDArray[float64]
    """deg: roll angle there"""
    relief_um: NDArray[float64]
    """um: relief as the motion has it: linear or parabolic in the roll angle"""
    relief_by_diameter_um: NDArray[float64]
    """um: relief of the same amount that grows in proportion to the diameter, as in Eq. 1 of Thamba et al. 2020"""

class AsBuiltTable(Table):
    """dynamic factor of gears as built, over speed, relief, gears and assembly"""

    relief_um: NDArray[float64]
    """um: amount of relief"""
    draw: NDArray[int64]
    """which gears, in the order in which they are drawn"""
    assembly: NDArray[int64]
    """which assembly: 1 as stated; in each further one the gear's next tooth to engage meets the pinion's stated tooth"""
    rpm: NDArray[float64]
    """1/min: speed of the pinion"""
    dynamic_factor: NDArray[float64]
    """dynamic factor DF: largest load of a pair over the static load; NaN where there is no answer"""
    error_estimate: NDArray[float64]
    """estimated error of DF; NaN where there is no answer or it is not known"""
    status: NDArray[str_]
    """how the operating point ended, in a word"""
    coast_factor: NDArray[float64]
    """largest load on the coast sides over the static load; 0 where they do not touch; NaN where there is no answer"""
    nominal_factor: NDArray[float64]
    """dynamic factor of gears without deviations; NaN where there is no answer"""
    dte_rms_um: NDArray[float64]
    """um: root mean square deviation of the dynamic transmission error from its mean"""
    dte_peak_to_peak_um: NDArray[float64]
    """um: peak-to-peak dynamic transmission error"""
    dte_error_estimate_um: NDArray[float64]
    """um: estimated error of either of these; NaN: not known"""
    nominal_dte_peak_to_peak_um: NDArray[float64]
    """um: the same of gears without deviations"""
    mesh_periods: NDArray[int64]
    """mesh periods until the motion repeats"""
    multiplier: NDArray[float64]
    """largest Floquet modulus over one mesh period, the mean of the turn: above 1 the motion repels; NaN where it is not known"""
    motions: NDArray[float64]
    """how many motions attract at this speed, of which this is the one with the largest DF; NaN where that is not known"""
    seen_dynamic_factor: NDArray[float64]
    """largest load of a pair over the static load that was seen in a motion that does not repeat: a lower bound; NaN where each motion that was met repeats"""
    seen_dte_rms_um: NDArray[float64]
    """um: root mean square deviation of its dynamic transmission error from its mean"""
    seen_dte_peak_to_peak_um: NDArray[float64]
    """um: peak-to-peak value of that error; a lower bound too"""
    seen_periods: NDArray[int64]
    """mesh periods over which that motion was watched; 0: none"""

class AsBuiltSummaryTable(Table):
    """largest dynamic factor over the speeds, of all pairs of gears and assemblies"""

    relief_um: NDArray[float64]
    """um: amount of relief"""
    nominal_factor: NDArray[float64]
    """largest DF over the speeds of gears without deviations"""
    least_factor: NDArray[float64]
    """the least of the largest DF over the speeds"""
    median_factor: NDArray[float64]
    """its median"""
    quantile_95_factor: NDArray[float64]
    """its 95th percentile"""
    largest_factor: NDArray[float64]
    """the largest"""
    rpm: NDArray[float64]
    """1/min: speed at which that is"""
    worst_draw: NDArray[float64]
    """of which gears, in the order in which they are drawn"""
    worst_assembly: NDArray[float64]
    """of which assembly of these"""
    best_draw: NDArray[float64]
    """gears with the least"""
    best_assembly: NDArray[float64]
    """assembly of these with the least"""
    sample_error: NDArray[float64]
    """with `quick`, by how much the dynamic factors that were computed both ways differ at most; else NaN, and where there are none"""
    within_class: NDArray[float64]
    """part of the pairs whose drawn gears are within their classes in f_p, F_p, f_Halpha and F_r; NaN where none is drawn"""
    draws: NDArray[int64]
    """pairs of gears that were drawn"""
    assemblies: NDArray[int64]
    """assemblies of each"""

class AsBuiltWorstTable(Table):
    """largest dynamic factor over the speeds of gears as built, and the teeth that carry it"""

    relief_um: NDArray[float64]
    """um: amount of relief"""
    draw: NDArray[int64]
    """which gears, in the order in which they are drawn"""
    assembly: NDArray[int64]
    """which assembly: 1 as stated; in each further one the gear's next tooth to engage meets the pinion's stated tooth"""
    dynamic_factor: NDArray[float64]
    """largest DF over the speeds; NaN where none has an answer"""
    rpm: NDArray[float64]
    """1/min: speed at which it is"""
    nominal_factor: NDArray[float64]
    """largest DF over the speeds of gears without deviations"""
    pinion_tooth: NDArray[float64]
    """number of the pinion's tooth that carries the largest load; NaN where with `quick` that motion had to be computed to the tolerance"""
    gear_tooth: NDArray[float64]
    """number of the gear's tooth that carries it"""
    s: NDArray[float64]
    """where it is: path coordinate of this pair, in base pitches from A"""
    first_gear_tooth: NDArray[float64]
    """number of the gear's tooth that enters at A with the pinion's stated tooth at the time 0"""
    ste_peak_to_peak_um: NDArray[float64]
    """um: peak-to-peak static transmission error over the turn"""
    nominal_ste_peak_to_peak_um: NDArray[float64]
    """um: the same of gears without deviations"""
    pinion_root_stress_mpa: NDArray[float64]
    """MPa: largest nominal tooth root stress sigma_F0 of ISO 6336-3 over the turn, of the load where it acts, in motion at the speed of the largest DF"""
    nominal_pinion_root_stress_mpa: NDArray[float64]
    """MPa: the same of gears without deviations, at the speed of their largest DF"""
    gear_root_stress_mpa: NDArray[float64]
    """MPa: largest nominal tooth root stress sigma_F0 of ISO 6336-3 over the turn, of the load where it acts, in motion at the speed of the largest DF"""
    nominal_gear_root_stress_mpa: NDArray[float64]
    """MPa: the same of gears without deviations, at the speed of their largest DF"""

class AsBuiltTeethTable(Table):
    """errors of each tooth of the pair of gears that is followed, with the signs of &deviations"""

    gear: NDArray[str_]
    """which gear"""
    tooth: NDArray[int64]
    """number of the tooth; teeth of drawn gears are numbered as they engage"""
    single_pitch_um: NDArray[float64]
    """um: single pitch deviation, without the run-out"""
    cumulative_pitch_um: NDArray[float64]
    """um: cumulative pitch deviation, without the run-out"""
    coast_pitch_um: NDArray[float64]
    """um: the same of the coast flanks"""
    profile_slope_um: NDArray[float64]
    """um: profile slope deviation; NaN where a file has the profile"""
    profile_form_um: NDArray[float64]
    """um: profile form deviation; NaN where a file has the profile"""
    runout_um: NDArray[float64]
    """um: run-out of the gear"""
    runout_phase_deg: NDArray[float64]
    """deg: its phase where the stated tooth enters at A"""

class AsBuiltLoadsTable(Table):
    """largest load of each pair of teeth over the turn, in the order in which the pairs enter at A"""

    relief_um: NDArray[float64]
    """um: amount of relief"""
    rpm: NDArray[float64]
    """1/min: speed of the pinion"""
    pair: NDArray[int64]
    """which pair, from 1; it enters at A at the time pair - 1, in mesh periods"""
    pinion_tooth: NDArray[int64]
    """number of the pinion's tooth"""
    gear_tooth: NDArray[int64]
    """number of the gear's tooth"""
    load_n: NDArray[float64]
    """N: largest load on this pair"""
    load_ratio: NDArray[float64]
    """the same over the static load"""
    s: NDArray[float64]
    """where that load is: path coordinate of the pair, in base pitches from A"""
    pressure_mpa: NDArray[float64]
    """MPa: largest Hertz pressure on the flanks under that load, where it is; NaN at a tip corner, which has no radius"""
    pinion_root_stress_mpa: NDArray[float64]
    """MPa: largest nominal tooth root stress sigma_F0 of ISO 6336-3 while this pair passes through the mesh, of the load where it acts"""
    gear_root_stress_mpa: NDArray[float64]
    """MPa: largest nominal tooth root stress sigma_F0 of ISO 6336-3 while this pair passes through the mesh, of the load where it acts"""

class AsBuiltTurnTable(Table):
    """transmission error along the line of action over the turn, at rest (rpm 0) and in motion"""

    relief_um: NDArray[float64]
    """um: amount of relief"""
    rpm: NDArray[float64]
    """1/min: speed of the pinion; 0: at rest"""
    tau: NDArray[float64]
    """time in mesh periods since the stated teeth entered at A"""
    pinion_angle_deg: NDArray[float64]
    """deg: angle through which the pinion has turned"""
    transmission_error_um: NDArray[float64]
    """um: static (rpm 0) or dynamic transmission error along the line of action; 0 where nominal teeth touch without load"""

class AsBuiltOrdersTable(Table):
    """orders of the transmission error over the turn: each part is amplitude cos(2 pi order t + phase) over turns t of the pinion"""

    relief_um: NDArray[float64]
    """um: amount of relief"""
    rpm: NDArray[float64]
    """1/min: speed of the pinion"""
    order: NDArray[float64]
    """order: cycles a turn of the pinion"""
    order_name: NDArray[str_]
    """what it is: mesh, pinion and gear orders, sidebands of mesh orders, and stated waves"""
    status: NDArray[str_]
    """how this operating point ended, in a word; none: no speed has an answer"""
    gear_order: NDArray[float64]
    """cycles a turn of the gear"""
    frequency_hz: NDArray[float64]
    """Hz: frequency at this speed"""
    dte_amplitude_um: NDArray[float64]
    """um: half of peak-to-peak of this part of the dynamic transmission error; NaN where there is no answer"""
    dte_phase_deg: NDArray[float64]
    """deg: its phase at the time 0"""
    ste_amplitude_um: NDArray[float64]
    """um: the same of the static transmission error"""
    ste_phase_deg: NDArray[float64]
    """deg: its phase at the time 0"""

class AsBuiltWaterfallTable(Table):
    """orders of the dynamic transmission error over the speed"""

    rpm: NDArray[float64]
    """1/min: speed of the pinion"""
    order: NDArray[float64]
    """order: cycles a turn of the pinion"""
    dte_amplitude_um: NDArray[float64]
    """um: half of peak-to-peak of this part of the dynamic transmission error; NaN where there is no answer"""

class TolerancesTable(Table):
    """flank tolerances of ISO 1328-1 by class"""

    gear: NDArray[str_]
    """which gear"""
    symbol: NDArray[str_]
    """tolerance: single and cumulative pitch, slope, form and total of profile and helix, run-out"""
    tolerance_class: NDArray[float64]
    """flank tolerance class"""
    tolerance_um: NDArray[float64]
    """um: rounded as the standard does"""
    exact_um: NDArray[float64]
    """um: the same before rounding"""

class StabilityTable(Table):
    """stability of the motion with all pairs in contact; unstable where floquet_modulus is above 1"""

    rpm: NDArray[float64]
    """1/min: speed of the pinion"""
    damping_ratio: NDArray[float64]
    """damping ratio"""
    floquet_modulus: NDArray[float64]
    """largest modulus of the Floquet multipliers: what remains of a disturbance after a mesh period; NaN where the speed is too low"""
    sense: NDArray[int64]
    """sign of that multiplier where it is real, 0 for a complex pair: beyond 1, a motion with 1 does not return, one with -1 doubles its period"""

class TonguesTable(Table):
    """tongues of instability, from the highest speed on"""

    tongue: NDArray[int64]
    """which tongue"""
    closing_damping_ratio: NDArray[float64]
    """damping ratio from which it is closed; NaN: above 1"""
    closing_rpm: NDArray[float64]
    """1/min: speed of the pinion at its last point"""

class TongueEdgesTable(Table):
    """edges of the tongues of instability: between them the motion repels"""

    tongue: NDArray[int64]
    """which tongue"""
    damping_ratio: NDArray[float64]
    """damping ratio"""
    lower_rpm: NDArray[float64]
    """1/min: speed of the pinion; NaN where the tongue is closed"""
    upper_rpm: NDArray[float64]
    """1/min: speed of the pinion; NaN where the tongue is closed"""

class HysteresisTable(Table):
    """steady motions that a slow run up through the speeds and one down meet"""

    relief_um: NDArray[float64]
    """um: tip relief, as amount_um of the case"""
    direction: NDArray[str_]
    """of the slow run through the speeds"""
    rpm: NDArray[float64]
    """1/min: speed of the pinion"""
    dynamic_factor: NDArray[float64]
    """largest load of a pair over the static load"""
    error_estimate: NDArray[float64]
    """estimated error of the dynamic factor"""
    status: NDArray[str_]
    """how the calculation of the operating point ended"""
    contact: NDArray[str_]
    """full; partial: a pair was apart for a while; lost: all were; coast: the coast sides touched"""
    floquet_modulus: NDArray[float64]
    """largest modulus of the Floquet multipliers"""
    mesh_periods: NDArray[int64]
    """mesh periods until the motion repeats"""
    dte_um: NDArray[float64]
    """um: dynamic transmission error as a new pair enters"""
    dte_rate_mm_s: NDArray[float64]
    """mm/s: rate of the dynamic transmission error as a new pair enters: the motion can be continued from both"""
    dte_rms_um: NDArray[float64]
    """um: root mean square of the dynamic transmission error about its mean over the steady motion; NaN where there is no answer"""
    dte_peak_to_peak_um: NDArray[float64]
    """um: peak-to-peak dynamic transmission error of the steady motion; NaN where there is no answer"""
    dte_error_estimate_um: NDArray[float64]
    """um: estimated error of either of these; NaN: not known"""

class HysteresisChangesTable(Table):
    """speeds at which the motion of a slow run changes, in the order met"""

    relief_um: NDArray[float64]
    """um: tip relief, as amount_um of the case"""
    direction: NDArray[str_]
    """of the slow run through the speeds"""
    change: NDArray[int64]
    """which change of this run"""
    kind: NDArray[str_]
    """doubling or halving of the period, or a jump to another motion; where there is no result before or after, the status there"""
    rpm_before: NDArray[float64]
    """1/min: speed of the pinion just before"""
    rpm_after: NDArray[float64]
    """1/min: speed of the pinion just after"""
    dynamic_factor_before: NDArray[float64]
    """largest load of a pair over the static load, before"""
    dynamic_factor_after: NDArray[float64]
    """largest load of a pair over the static load, after"""
    status_before: NDArray[str_]
    """status of the motion before"""
    status_after: NDArray[str_]
    """status of the motion after"""
    mesh_periods_before: NDArray[int64]
    """mesh periods until the motion repeats, before"""
    mesh_periods_after: NDArray[int64]
    """mesh periods until the motion repeats, after"""

class HysteresisRampsTable(Table):
    """runs through the speeds at a finite rate"""

    relief_um: NDArray[float64]
    """um: tip relief, as amount_um of the case"""
    direction: NDArray[str_]
    """of the run through the speeds"""
    rpm: NDArray[float64]
    """1/min: speed of the pinion"""
    dynamic_factor: NDArray[float64]
    """largest load of a pair over the static load in the mesh periods between the speed before and this one; NaN at the first speed, and where no mesh period lies between"""
    error_estimate: NDArray[float64]
    """estimated error of the dynamic factor: its change with steps twice as long"""

class HysteresisDelaysTable(Table):
    """how late the runs at a finite rate jump"""

    relief_um: NDArray[float64]
    """um: tip relief, as amount_um of the case"""
    direction: NDArray[str_]
    """of the run through the speeds"""
    change: NDArray[int64]
    """which change of this direction in hysteresis_changes"""
    rpm: NDArray[float64]
    """1/min: speed of the pinion just after the jump of the slow run"""
    ramp_rpm: NDArray[float64]
    """1/min: speed at which the largest load of a mesh period is first halfway from that before to that after the jump; NaN where it never is"""
    delay_s: NDArray[float64]
    """s: time from the jump of the slow run to that"""
    error_estimate_s: NDArray[float64]
    """s: estimated error of the delay: its change with steps twice as long, and a mesh period, of which it is a whole number"""

class PoincareTable(Table):
    """the motion seen once a mesh period, as a new pair enters"""

    relief_um: NDArray[float64]
    """um: tip relief, as amount_um of the case"""
    rpm: NDArray[float64]
    """1/min: speed of the pinion"""
    period: NDArray[int64]
    """which of the mesh periods kept"""
    dte_um: NDArray[float64]
    """um: dynamic transmission error; NaN where the motion was not followed"""
    dte_rate_mm_s: NDArray[float64]
    """mm/s: rate of the dynamic transmission error"""

class LyapunovTable(Table):
    """how the motion seen once a mesh period goes on"""

    relief_um: NDArray[float64]
    """um: tip relief, as amount_um of the case"""
    rpm: NDArray[float64]
    """1/min: speed of the pinion"""
    lyapunov_exponent: NDArray[float64]
    """largest Lyapunov exponent, of a mesh period: the mean logarithm by which a disturbance grows, below 0 where the motion repeats and above 0 where it is chaotic"""
    status: NDArray[str_]
    """ok, subharmonic, chaotic; transient, without damping aperiodic: neither repeats nor is surely chaotic within what was kept; unbounded, unresolved, chatter"""
    mesh_periods: NDArray[int64]
    """mesh periods until the motion repeats; 0: it does not"""

class AttractorsTable(Table):
    """attracting motions at each speed, the one to which most starts lead first"""

    relief_um: NDArray[float64]
    """um: amount of relief"""
    rpm: NDArray[float64]
    """1/min: speed of the pinion"""
    motion: NDArray[int64]
    """which of the motions at this speed"""
    dynamic_factor: NDArray[float64]
    """dynamic factor DF: largest load of a pair over the static load; NaN where there is no answer"""
    error_estimate: NDArray[float64]
    """estimated error of DF; NaN where there is no answer or it is not known"""
    status: NDArray[str_]
    """how the operating point ended, in a word"""
    contact: NDArray[str_]
    """full; partial: a pair was apart for a while; lost: all were; coast: the coast sides touched"""
    floquet_modulus: NDArray[float64]
    """largest modulus of the Floquet multipliers"""
    mesh_periods: NDArray[int64]
    """mesh periods until the motion repeats"""
    starts: NDArray[int64]
    """how many starts lead to it; 0: none reaches it, and it is left out of largest values"""
    share: NDArray[float64]
    """the same as a share of all starts"""
    dte_um: NDArray[float64]
    """um: dynamic transmission error as a new pair enters"""
    dte_rate_mm_s: NDArray[float64]
    """mm/s: rate of the dynamic transmission error as a new pair enters: the motion can be continued from both"""

class AttractorPointsTable(Table):
    """how many motions attract, and what a sweep of single speeds shows of them"""

    relief_um: NDArray[float64]
    """um: amount of relief"""
    rpm: NDArray[float64]
    """1/min: speed of the pinion"""
    motions: NDArray[int64]
    """how many attracting motions are known"""
    largest_dynamic_factor: NDArray[float64]
    """largest DF of those that a start reaches or a sweep of single speeds shows; NaN where none is known"""
    each_dynamic_factor: NDArray[float64]
    """DF that a sweep with direction = 'each' shows; NaN where it has no answer"""
    each_motion: NDArray[int64]
    """which of the motions that is; 0: none of them"""
    each_share: NDArray[float64]
    """share of the starts that lead to it"""
    unsettled_share: NDArray[float64]
    """share of the starts that nothing captured within followed_periods"""
    status: NDArray[str_]
    """ok; unresolved: the speed is too low to be searched"""

class BasinsTable(Table):
    """starts, and the motion that each leads to"""

    relief_um: NDArray[float64]
    """um: amount of relief"""
    rpm: NDArray[float64]
    """1/min: speed of the pinion"""
    start: NDArray[int64]
    """which start: the displacement varies fastest"""
    dte_um: NDArray[float64]
    """um: dynamic transmission error at the start, as a new pair enters"""
    dte_rate_mm_s: NDArray[float64]
    """mm/s: its rate there"""
    motion: NDArray[int64]
    """the motion of the table attractors that it leads to; 0: none within followed_periods"""

class BranchesTable(Table):
    """branches of periodic motions over the parameter"""

    branch: NDArray[int64]
    """which branch"""
    relief_um: NDArray[float64]
    """um: amount of relief; NaN where it is the parameter"""
    mesh_periods: NDArray[int64]
    """mesh periods until the motion repeats"""
    least: NDArray[float64]
    """least value of the parameter, in the unit of its name"""
    largest: NDArray[float64]
    """largest value of the parameter"""
    largest_dynamic_factor: NDArray[float64]
    """largest DF on the branch"""
    points: NDArray[int64]
    """points followed"""
    stable_points: NDArray[int64]
    """of these, where the motion attracts"""
    first_end: NDArray[str_]
    """how it ends where its points begin: range: of the parameter; closed: in itself; doubling: in a motion of half the period, whose period doubles there; lost: Newton's method does not go on; length: so many points"""
    last_end: NDArray[str_]
    """how it ends where its points end"""

class BranchPointsTable(Table):
    """points of the branches, from one end to the other"""

    branch: NDArray[int64]
    """which branch"""
    point: NDArray[int64]
    """number of the point on its branch"""
    rpm: NDArray[float64]
    """1/min: speed of the pinion"""
    damping_ratio: NDArray[float64]
    """damping ratio"""
    relief_um: NDArray[float64]
    """um: amount of relief"""
    normal_force_n: NDArray[float64]
    """N: static load"""
    dynamic_factor: NDArray[float64]
    """dynamic factor DF: largest load of a pair over the static load"""
    mesh_periods: NDArray[int64]
    """mesh periods until the motion repeats"""
    floquet_modulus: NDArray[float64]
    """largest modulus of the Floquet multipliers"""
    stability: NDArray[str_]
    """stable: the motion attracts; unstable: it repels; marginal: neither, to 1e-7"""
    contact: NDArray[str_]
    """full; partial: a pair was apart for a while; lost: all were; coast: the coast sides touched"""
    dte_rms_um: NDArray[float64]
    """um: root mean square of the dynamic transmission error about its mean over the steady motion; NaN where there is no answer"""
    dte_peak_to_peak_um: NDArray[float64]
    """um: peak-to-peak dynamic transmission error of the steady motion; NaN where there is no answer"""
    dte_um: NDArray[float64]
    """um: dynamic transmission error as a new pair enters"""
    dte_rate_mm_s: NDArray[float64]
    """mm/s: rate of the dynamic transmission error as a new pair enters: the motion can be continued from both"""

class BranchChangesTable(Table):
    """where the motion changes its kind along a branch"""

    branch: NDArray[int64]
    """which branch"""
    kind: NDArray[str_]
    """fold: a Floquet multiplier is 1, and the branch turns back; doubling: one is -1; grazing: the overlap of a contact is 0 where it is smallest or largest, or where a pair enters or leaves; vertical: a line of motions begins at one value of the parameter; unknown: contact or stability changes between this point and the one before, and it is not known how"""
    after_point: NDArray[int64]
    """the point of the branch before it"""
    rpm: NDArray[float64]
    """1/min: speed of the pinion"""
    damping_ratio: NDArray[float64]
    """damping ratio"""
    relief_um: NDArray[float64]
    """um: amount of relief"""
    normal_force_n: NDArray[float64]
    """N: static load"""
    dynamic_factor: NDArray[float64]
    """dynamic factor DF: largest load of a pair over the static load"""
    mesh_periods: NDArray[int64]
    """mesh periods until the motion repeats"""
    floquet_modulus: NDArray[float64]
    """largest modulus of the Floquet multipliers"""
    stability: NDArray[str_]
    """stable: the motion attracts; unstable: it repels; marginal: neither, to 1e-7"""
    contact: NDArray[str_]
    """full; partial: a pair was apart for a while; lost: all were; coast: the coast sides touched"""
    dte_rms_um: NDArray[float64]
    """um: root mean square of the dynamic transmission error about its mean over the steady motion; NaN where there is no answer"""
    dte_peak_to_peak_um: NDArray[float64]
    """um: peak-to-peak dynamic transmission error of the steady motion; NaN where there is no answer"""
    phase: NDArray[float64]
    """of grazing, the mesh phase; NaN where it is not known or no grazing"""
    in_period: NDArray[int64]
    """of grazing, in which of the mesh periods; 0 as above"""
    enclosed: NDArray[float64]
    """between motions so far apart it is enclosed, as a distance in the unit of the parameter's name"""

class SensitivityTable(Table):
    """how the dynamic factor changes with each number of the motion"""

    relief_um: NDArray[float64]
    """um: amount of relief"""
    rpm: NDArray[float64]
    """1/min: speed of the pinion"""
    number: NDArray[str_]
    """which number of the case, with its unit"""
    value: NDArray[float64]
    """its value, in the unit of its name"""
    dynamic_factor: NDArray[float64]
    """dynamic factor DF: largest load of a pair over the static load; NaN where there is no answer"""
    slope: NDArray[float64]
    """derivative of DF, for one unit more of the number; NaN where there is none"""
    error_estimate: NDArray[float64]
    """estimated error of the slope; NaN where it is not known"""
    slope_below: NDArray[float64]
    """derivative to smaller values; NaN where there are none or contact changes"""
    slope_above: NDArray[float64]
    """derivative to larger values"""
    relative_slope: NDArray[float64]
    """by how many per cent DF grows where the number grows by one per cent"""
    derivative: NDArray[str_]
    """smooth: there is a derivative; least: to larger values only, as there are no smaller ones; peak: the largest load changes its place; contact: a pair that enters or leaves begins or ceases to touch; grazing: flanks on the path do; fold: the motion ceases to be; none: no motion"""

class DteSensitivityTable(Table):
    """how mean and harmonics of the dynamic transmission error change with each number of the motion"""

    relief_um: NDArray[float64]
    """um: amount of relief"""
    rpm: NDArray[float64]
    """1/min: speed of the pinion"""
    number: NDArray[str_]
    """which number of the case, with its unit"""
    harmonic: NDArray[int64]
    """0 for the mean, 1, 2 ... for the mesh frequency"""
    dte_slope_um: NDArray[float64]
    """um: derivative of its amplitude, for one unit more of the number; NaN where there is none"""
    error_estimate: NDArray[float64]
    """um: estimated error of the slope; NaN where it is not known"""
    derivative: NDArray[str_]
    """smooth: there is a derivative; least: to larger values only, as there are no smaller ones; peak: the largest load changes its place; contact: a pair that enters or leaves begins or ceases to touch; grazing: flanks on the path do; fold: the motion ceases to be; none: no motion"""

class SteSensitivityTable(Table):
    """how mean and harmonics of the static transmission error change with each number of the motion"""

    relief_um: NDArray[float64]
    """um: amount of relief"""
    number: NDArray[str_]
    """which number of the case, with its unit"""
    harmonic: NDArray[int64]
    """0 for the mean, 1, 2 ... for the mesh frequency"""
    ste_slope_um: NDArray[float64]
    """um: derivative of its amplitude, for one unit more of the number; NaN where there is none"""
    error_estimate: NDArray[float64]
    """um: estimated error of the slope; NaN where it is not known"""
    derivative: NDArray[str_]
    """smooth: there is a derivative; least: to larger values only, as there are no smaller ones; peak: the largest load changes its place; contact: a pair that enters or leaves begins or ceases to touch; grazing: flanks on the path do; fold: the motion ceases to be; none: no motion"""

class PrecisionTable(Table):
    """results at several resolutions, with their errors and run times"""

    quantity: NDArray[str_]
    """dynamic_factor; ste_harmonic: amplitude of the static transmission error; natural_frequency; root_tension: the largest under the whole load at the outer point of single contact; pair_stiffness: in the middle of the path of contact"""
    number: NDArray[int64]
    """which harmonic or mode; 1 for what is alone"""
    relief_um: NDArray[float64]
    """um: tip relief; NaN where it does not matter"""
    rpm: NDArray[float64]
    """1/min: speed of the pinion; NaN where it does not matter"""
    method: NDArray[str_]
    """of integration as &numerics method; segments: integration over smooth segments; fft: Fourier transform of equally spaced samples; elements: finite elements"""
    resolution: NDArray[int64]
    """steps of a mesh period, about, as some methods end steps at breaks; samples of a mesh period; elements across the loaded tooth"""
    value: NDArray[float64]
    """the result, in the unit beside it"""
    unit: NDArray[str_]
    """of the value; empty for a plain number"""
    error: NDArray[float64]
    """difference to the value in the table precision_finest over that value, or, of harmonics, over the largest amplitude; it says nothing where it is below the error_estimate there"""
    error_estimate: NDArray[float64]
    """the method's own estimate of the error, relative in the same way; NaN: it has none. For pair_stiffness that of the reference alone: a third of the difference to half as many elements"""
    status: NDArray[str_]
    """ok, or why there is no value, as in the table sweep"""
    run_time_s: NDArray[float64]
    """s: processor time of the calling thread, the shortest of several runs, with the error estimate where the method has one; it differs from run to run. Dynamic factor: one speed, from the reference's motion on, with the coefficients tabulated before. Harmonics and modes: all of them together. Elements: with building and factoring the grids"""

class PrecisionFinestTable(Table):
    """what the results in the table precision are compared with"""

    quantity: NDArray[str_]
    """dynamic_factor; ste_harmonic: amplitude of the static transmission error; natural_frequency; root_tension: the largest under the whole load at the outer point of single contact; pair_stiffness: in the middle of the path of contact"""
    number: NDArray[int64]
    """which harmonic or mode; 1 for what is alone"""
    relief_um: NDArray[float64]
    """um: tip relief; NaN where it does not matter"""
    rpm: NDArray[float64]
    """1/min: speed of the pinion; NaN where it does not matter"""
    method: NDArray[str_]
    """of integration as &numerics method; segments: integration over smooth segments; fft: Fourier transform of equally spaced samples; elements: finite elements"""
    resolution: NDArray[int64]
    """steps of a mesh period, about, as some methods end steps at breaks; samples of a mesh period; elements across the loaded tooth"""
    value: NDArray[float64]
    """the result, in the unit beside it"""
    unit: NDArray[str_]
    """of the value; empty for a plain number"""
    error_estimate: NDArray[float64]
    """the method's own estimate of the error, relative in the same way; NaN: it has none. For pair_stiffness that of the reference alone: a third of the difference to half as many elements"""
    status: NDArray[str_]
    """ok, or why there is no value, as in the table sweep"""

class FlankTable(Table):
    """the contact of one pair along its path, from its first contact to its last"""

    relief_um: NDArray[float64]
    """um: amount of relief"""
    rpm: NDArray[float64]
    """1/min: speed of the pinion"""
    loading: NDArray[str_]
    """static: as stiffness and relief share the load; dynamic: that of the motion"""
    pair: NDArray[int64]
    """index of the pair, from 1; 0 without an answer"""
    s: NDArray[float64]
    """path coordinate of the pair, in base pitches from A; below 0 before A"""
    path_mm: NDArray[float64]
    """mm: distance from A on the line of action"""
    pair_load_n: NDArray[float64]
    """N: load of the pair"""
    pinion_rolling_m_s: NDArray[float64]
    """m/s: speed at which the pinion's flank rolls through the contact"""
    gear_rolling_m_s: NDArray[float64]
    """m/s: the same of the gear's flank"""
    sliding_m_s: NDArray[float64]
    """m/s: sliding speed: that of the pinion less that of the gear"""
    pinion_specific_sliding: NDArray[float64]
    """sliding speed over the pinion's rolling speed"""
    gear_specific_sliding: NDArray[float64]
    """the same of the gear, whose sliding speed has the other sign"""
    pressure_mpa: NDArray[float64]
    """MPa: largest Hertz pressure; NaN beyond A and E, where a sharp corner touches, as is all that follows from it"""
    half_width_um: NDArray[float64]
    """um: half the width of the contact"""
    shear_stress_mpa: NDArray[float64]
    """MPa: largest shear stress below the surface, without friction"""
    shear_depth_um: NDArray[float64]
    """um: depth at which it lies"""
    friction_power_w: NDArray[float64]
    """W: coefficient of friction times load and sliding speed"""
    flash_temperature_k: NDArray[float64]
    """K: by how much the flanks become hotter within the contact"""
    film_thickness_um: NDArray[float64]
    """um: least thickness of the oil film; NaN where no load is"""

class FlankLossesTable(Table):
    """what the mesh loses by friction, and the extremes along the path"""

    relief_um: NDArray[float64]
    """um: amount of relief"""
    rpm: NDArray[float64]
    """1/min: speed of the pinion"""
    loading: NDArray[str_]
    """static: as stiffness and relief share the load; dynamic: that of the motion"""
    friction_coefficient: NDArray[float64]
    """mean coefficient of friction"""
    viscosity_mpa_s: NDArray[float64]
    """mPa s: of the case: viscosity of the oil"""
    roughness_um: NDArray[float64]
    """um: of the case: roughness Ra; NaN where the coefficient of friction is stated"""
    oil_factor: NDArray[float64]
    """of the case: X_L of the oil; NaN where the coefficient of friction is stated"""
    loss_factor: NDArray[float64]
    """H_v: mean of load times sliding speed of all pairs, over static load and speed of the base circles"""
    loss_factor_half_shares: NDArray[float64]
    """the same in closed form where all pairs carry alike (Ohlendorf, ISO/TR 14179-2)"""
    loss_factor_even_load: NDArray[float64]
    """the same in closed form for one load all along the path (ISO/TR 14179-1)"""
    input_power_w: NDArray[float64]
    """W: power of the pinion's torque"""
    friction_loss_w: NDArray[float64]
    """W: mean power lost by friction in the mesh"""
    efficiency: NDArray[float64]
    """input power less that loss, over the input power"""
    largest_pressure_mpa: NDArray[float64]
    """MPa: largest Hertz pressure along the path"""
    largest_flash_k: NDArray[float64]
    """K: largest flash temperature along the path"""
    least_film_um: NDArray[float64]
    """um: least film thickness along the path"""
    dynamic_factor: NDArray[float64]
    """dynamic factor DF: largest load of a pair over the static load; NaN where there is no answer, and for the static load"""
    error_estimate: NDArray[float64]
    """estimated error of DF; NaN where there is no answer or it is not known"""
    status: NDArray[str_]
    """how the operating point ended, in a word"""
    motions: NDArray[float64]
    """how many motions attract at this speed, of which this is the one with the largest DF; NaN where that is not known; also under the static load"""

class RatingTable(Table):
    """contact stress and tooth root stress by ISO 6336, and their safety factors"""

    relief_um: NDArray[float64]
    """um: amount of relief"""
    rpm: NDArray[float64]
    """1/min: speed of the pinion"""
    gear: NDArray[str_]
    """pinion or gear"""
    method: NDArray[str_]
    """method of this K_v, as in dynamic_factor_method: a or b"""
    internal_dynamic_factor: NDArray[float64]
    """K_v by that method; NaN where there is no answer"""
    contact_stress_mpa: NDArray[float64]
    """MPa: contact stress sigma_H"""
    contact_safety: NDArray[float64]
    """S_H; NaN without contact_limit_mpa or a material"""
    root_stress_mpa: NDArray[float64]
    """MPa: tooth root stress sigma_F"""
    root_safety: NDArray[float64]
    """S_F; NaN without root_limit_mpa or a material"""
    required_life_h: NDArray[float64]
    """h: as in the case"""
    load_cycles: NDArray[float64]
    """N_L in the required life, one a revolution"""
    contact_life_factor: NDArray[float64]
    """Z_NT"""
    contact_life_safety: NDArray[float64]
    """S_H for the required life"""
    root_life_factor: NDArray[float64]
    """Y_NT"""
    root_life_safety: NDArray[float64]
    """S_F for the required life"""

class RatingFactorsTable(Table):
    """factors of ISO 6336:2006 that do not depend on the speed"""

    gear: NDArray[str_]
    """pinion or gear"""
    tangential_load_n: NDArray[float64]
    """N: nominal load F_t on the reference circle"""
    application_factor: NDArray[float64]
    """K_A, of the case"""
    face_load_factor: NDArray[float64]
    """K_H_beta, of the case"""
    root_face_load_factor: NDArray[float64]
    """K_F_beta, ISO 6336-1, clause 7"""
    transverse_load_factor: NDArray[float64]
    """K_H_alpha and K_F_alpha, of the case"""
    zone_factor: NDArray[float64]
    """Z_H, ISO 6336-2, clause 6"""
    single_pair_factor: NDArray[float64]
    """Z_B of the pinion, Z_D of the gear, ISO 6336-2, clause 6"""
    elasticity_factor_sqrt_mpa: NDArray[float64]
    """sqrt(MPa): Z_E, ISO 6336-2, clause 7"""
    contact_ratio_factor: NDArray[float64]
    """Z_eps, ISO 6336-2, clause 8"""
    helix_factor: NDArray[float64]
    """of helical gears: Z_beta, ISO 6336-2, clause 9"""
    root_helix_factor: NDArray[float64]
    """of helical gears: Y_beta, ISO 6336-3, clause 8"""
    nominal_contact_mpa: NDArray[float64]
    """MPa: nominal contact stress sigma_H0, ISO 6336-2, clause 5"""
    form_factor: NDArray[float64]
    """Y_F, ISO 6336-3, clause 6"""
    stress_correction: NDArray[float64]
    """Y_S, ISO 6336-3, clause 7"""
    rim_factor: NDArray[float64]
    """Y_B, ISO 6336-3, clause 9"""
    deep_tooth_factor: NDArray[float64]
    """Y_DT, ISO 6336-3, clause 10"""
    nominal_root_mpa: NDArray[float64]
    """MPa: nominal tooth root stress sigma_F0, ISO 6336-3, clause 5"""
    single_stiffness_n_mm_um: NDArray[float64]
    """N/(mm um): c', ISO 6336-1, clause 9"""
    mesh_stiffness_n_mm_um: NDArray[float64]
    """N/(mm um): c_gamma_alpha, ISO 6336-1, clause 9"""
    reduced_mass_kg_mm: NDArray[float64]
    """kg/mm: m_red of a unit of face width, from the effective masses of the case"""
    resonance_rpm: NDArray[float64]
    """1/min: resonance running speed n_E1 of the pinion, ISO 6336-1, 6.5.3"""
    accuracy_grade: NDArray[int64]
    """of ISO 1328-1; with stated deviations the finest that allows both, 13 for none"""
    pitch_deviation_um: NDArray[float64]
    """um: f_pb after running in"""
    profile_deviation_um: NDArray[float64]
    """um: f_f_alpha after running in"""
    material: NDArray[str_]
    """whose numbers are taken; empty for none"""
    material_name: NDArray[str_]
    """what the case calls it; empty for none"""
    material_grade: NDArray[str_]
    """its quality grade by ISO 6336-5; empty for none"""
    contact_number_mpa: NDArray[float64]
    """MPa: allowable stress number sigma_Hlim of the material; NaN without one"""
    root_number_mpa: NDArray[float64]
    """MPa: nominal stress number sigma_Flim of the material; NaN without one"""
    contact_static_factor: NDArray[float64]
    """Z_NT up to contact_static_cycles"""
    contact_static_cycles: NDArray[float64]
    """load cycles at the static end of Z_NT"""
    contact_knee_cycles: NDArray[float64]
    """load cycles at the knee of Z_NT, where it is 1"""
    root_static_factor: NDArray[float64]
    """Y_NT up to root_static_cycles"""
    root_static_cycles: NDArray[float64]
    """load cycles at the static end of Y_NT"""
    root_knee_cycles: NDArray[float64]
    """load cycles at the knee of Y_NT, where it is 1"""
    long_life_factor: NDArray[float64]
    """Z_NT and Y_NT from last_cycles on"""
    last_cycles: NDArray[float64]
    """load cycles at the last point of both"""
    contact_limit_mpa: NDArray[float64]
    """MPa: sigma_HG: as stated, or sigma_Hlim of the material; NaN for none"""
    root_limit_mpa: NDArray[float64]
    """MPa: sigma_FG: as stated, or twice sigma_Flim of the material; NaN for none"""
    equal_flanks: NDArray[int64]
    """1 where both flanks have one pressure angle, as ISO 6336-3 means it, else 0"""

class DynamicFactorsTable(Table):
    """dynamic factor K_v by Method A, from the motion, and by Method B"""

    relief_um: NDArray[float64]
    """um: amount of relief"""
    rpm: NDArray[float64]
    """1/min: speed of the pinion"""
    dynamic_factor: NDArray[float64]
    """dynamic factor DF: largest load of a pair over the static load; NaN where there is no answer"""
    error_estimate: NDArray[float64]
    """estimated error of DF; NaN where there is no answer or it is not known"""
    status: NDArray[str_]
    """how the operating point ended, in a word"""
    motions: NDArray[float64]
    """how many motions attract at this speed, of which this is the one with the largest DF; NaN where that is not known"""
    static_share: NDArray[float64]
    """largest load of a pair at rest over the static load"""
    dynamic_factor_a: NDArray[float64]
    """K_v by ISO 6336-1, Method A: DF over static_share, at least 1; NaN where there is no answer"""
    dynamic_factor_b: NDArray[float64]
    """K_v by ISO 6336-1, Method B"""
    resonance_ratio: NDArray[float64]
    """N: speed over the resonance running speed of Method B"""

class TransientTable(Table):
    """stress and displacement at points of the fillets while the load passes"""

    relief_um: NDArray[float64]
    """um: amount of relief"""
    rpm: NDArray[float64]
    """1/min: speed of the pinion"""
    tangent_deg: NDArray[float64]
    """deg: angle of the fillet's tangent at this point to the tooth's axis"""
    side: NDArray[str_]
    """drive (the loaded side: tension) or coast"""
    time_ms: NDArray[float64]
    """ms: time since the load met the tooth"""
    s: NDArray[float64]
    """path coordinate of the load, in base pitches from A"""
    load_n: NDArray[float64]
    """N: load on the tooth"""
    sigma_mpa: NDArray[float64]
    """MPa: stress along the surface"""
    sigma_x_mpa: NDArray[float64]
    """MPa: component across the tooth, x to its drive side"""
    sigma_y_mpa: NDArray[float64]
    """MPa: component along the tooth's axis y"""
    tau_xy_mpa: NDArray[float64]
    """MPa: shear component"""
    mises_mpa: NDArray[float64]
    """MPa: von Mises stress"""
    static_mpa: NDArray[float64]
    """MPa: stress along the surface under the same load at rest"""
    displacement_x_um: NDArray[float64]
    """um: displacement across the tooth, to its drive side"""
    displacement_y_um: NDArray[float64]
    """um: displacement along the tooth's axis"""

class TransientPointsTable(Table):
    """the largest stress and displacement at points of the fillets while the load passes"""

    relief_um: NDArray[float64]
    """um: amount of relief"""
    rpm: NDArray[float64]
    """1/min: speed of the pinion"""
    tangent_deg: NDArray[float64]
    """deg: angle of the fillet's tangent at this point to the tooth's axis"""
    side: NDArray[str_]
    """drive (the loaded side: tension) or coast"""
    highest_mpa: NDArray[float64]
    """MPa: highest stress along the surface"""
    highest_ms: NDArray[float64]
    """ms: when"""
    lowest_mpa: NDArray[float64]
    """MPa: lowest stress along the surface"""
    lowest_ms: NDArray[float64]
    """ms: when"""
    sigma_mpa: NDArray[float64]
    """MPa: where it is largest in size: stress along the surface"""
    sigma_x_mpa: NDArray[float64]
    """MPa: where it is largest in size: component across the tooth, x to its drive side"""
    sigma_y_mpa: NDArray[float64]
    """MPa: where it is largest in size: component along the tooth's axis y"""
    tau_xy_mpa: NDArray[float64]
    """MPa: where it is largest in size: shear component"""
    mises_mpa: NDArray[float64]
    """MPa: where it is largest in size: von Mises stress"""
    static_mpa: NDArray[float64]
    """MPa: stress along the surface, the largest in size with the load at rest"""
    displacement_x_um: NDArray[float64]
    """um: displacement across the tooth, to its drive side, the largest in size"""
    displacement_y_um: NDArray[float64]
    """um: displacement along the tooth's axis, the largest in size"""
    error_estimate: NDArray[float64]
    """estimated discretisation error of the largest stress, relative"""

class TransientPeaksTable(Table):
    """the largest stress in the root fillets while the load passes"""

    relief_um: NDArray[float64]
    """um: amount of relief"""
    rpm: NDArray[float64]
    """1/min: speed of the pinion"""
    tension_mpa: NDArray[float64]
    """MPa: largest tension along the surface"""
    tension_deg: NDArray[float64]
    """deg: angle of the fillet's tangent there to the tooth's axis"""
    static_tension_mpa: NDArray[float64]
    """MPa: largest tension with the load at rest"""
    compression_mpa: NDArray[float64]
    """MPa: largest compression along the surface, negative"""
    compression_deg: NDArray[float64]
    """deg: angle of the fillet's tangent there to the tooth's axis"""
    static_compression_mpa: NDArray[float64]
    """MPa: largest compression with the load at rest, negative"""
    mises_mpa: NDArray[float64]
    """MPa: largest von Mises stress"""
    tension_ratio: NDArray[float64]
    """largest tension over that with the load at rest"""
    compression_ratio: NDArray[float64]
    """the same of the compression"""
    look_us: NDArray[float64]
    """us: time between two looks for the largest values"""
    error_estimate: NDArray[float64]
    """estimated discretisation error of the stresses, relative"""
    status: NDArray[str_]
    """how the operating point ended, in a word"""
    motions: NDArray[float64]
    """how many motions attract at this speed, of which this is the one with the largest DF; NaN where that is not known; also under a static load"""

class HarmonicTable(Table):
    """stress, strain and displacement at points of the fillets over the frequency of the load"""

    s: NDArray[float64]
    """path coordinate of the load, in base pitches from A"""
    tangent_deg: NDArray[float64]
    """deg: angle of the fillet's tangent at this point to the tooth's axis"""
    side: NDArray[str_]
    """drive (the loaded side) or coast"""
    frequency_hz: NDArray[float64]
    """Hz: frequency of the load"""
    stress_mpa: NDArray[float64]
    """MPa: amplitude of the stress along the surface"""
    stress_phase_deg: NDArray[float64]
    """deg: phase by which it leads the load"""
    strain_um_m: NDArray[float64]
    """um/m: amplitude of the strain along the surface"""
    displacement_x_um: NDArray[float64]
    """um: amplitude of the displacement across the tooth"""
    phase_x_deg: NDArray[float64]
    """deg: phase by which it leads the load"""
    displacement_y_um: NDArray[float64]
    """um: amplitude of the displacement along the tooth's axis"""
    phase_y_deg: NDArray[float64]
    """deg: phase by which it leads the load"""
    error_estimate: NDArray[float64]
    """estimated discretisation error of the stress at this frequency, relative"""

class SectionResonancesTable(Table):
    """where each mode of the section peaks in the stress at points of the fillets"""

    s: NDArray[float64]
    """path coordinate of the load, in base pitches from A"""
    tangent_deg: NDArray[float64]
    """deg: angle of the fillet's tangent at this point to the tooth's axis"""
    side: NDArray[str_]
    """drive (the loaded side) or coast"""
    mode: NDArray[int64]
    """from the lowest frequency"""
    natural_frequency_hz: NDArray[float64]
    """Hz: natural frequency"""
    frequency_error: NDArray[float64]
    """its estimated discretisation error, relative"""
    damping_ratio: NDArray[float64]
    """damping ratio of the mode"""
    peak_frequency_hz: NDArray[float64]
    """Hz: frequency of the load at which the stress is largest about this mode"""
    stress_mpa: NDArray[float64]
    """MPa: amplitude of the stress along the surface there"""
    amplification: NDArray[float64]
    """the same over that under the load at rest"""
    error_estimate: NDArray[float64]
    """estimated discretisation error of this stress, relative"""

class CampbellTable(Table):
    """speeds at which harmonics of the mesh frequency meet natural frequencies"""

    system: NDArray[str_]
    """gears: both gears on the mean mesh stiffness; section: the teeth of one gear"""
    mode: NDArray[int64]
    """from the lowest frequency"""
    harmonic: NDArray[int64]
    """of the mesh frequency"""
    frequency_hz: NDArray[float64]
    """Hz: natural frequency"""
    rpm: NDArray[float64]
    """1/min: speed of the pinion at which this harmonic meets it"""

class LifeTable(Table):
    """how long the tooth roots last"""

    relief_um: NDArray[float64]
    """um: amount of relief"""
    gear: NDArray[str_]
    """pinion or gear"""
    kind: NDArray[str_]
    """of the root: finite: damage adds up; endless: no cycle harms; overloaded: some cycle is above the static strength of the material or has a mean stress above the strength; unknown: some part has no motion"""
    damage: NDArray[float64]
    """Miner's sum of the root in one pass of the spectrum"""
    passes: NDArray[float64]
    """of the spectrum until the sum is 1; NaN unless finite"""
    life_h: NDArray[float64]
    """h: time until then"""
    largest_root_stress_mpa: NDArray[float64]
    """MPa: largest tooth root stress of all parts"""
    worst_part: NDArray[int64]
    """part that does most harm to the root; 0 where none does"""
    contact_kind: NDArray[str_]
    """of the flank, as kind"""
    contact_damage: NDArray[float64]
    """Miner's sum of the flank in one pass of the spectrum"""
    contact_life_h: NDArray[float64]
    """h: time until the sum of the flank is 1; NaN unless finite"""
    largest_contact_stress_mpa: NDArray[float64]
    """MPa: largest contact stress sigma_H of all parts"""
    worst_contact_part: NDArray[int64]
    """part that does most harm to the flank; 0 where none does"""
    equal_flanks: NDArray[int64]
    """1 where both flanks have one pressure angle, as ISO 6336-3 means it, else 0"""

class LifePartsTable(Table):
    """what each part of the load spectrum does to the tooth roots"""

    relief_um: NDArray[float64]
    """um: amount of relief"""
    part: NDArray[int64]
    """of the load spectrum, from 1"""
    gear: NDArray[str_]
    """pinion or gear"""
    rpm: NDArray[float64]
    """1/min: speed of the pinion"""
    load_factor: NDArray[float64]
    """load over that of the case"""
    dynamic_factor: NDArray[float64]
    """dynamic factor DF: largest load of a pair over the static load; NaN where there is no answer, and for the static load"""
    status: NDArray[str_]
    """how the operating point ended, in a word"""
    motions: NDArray[float64]
    """how many motions attract at this speed, of which this is the one with the largest DF; NaN where that is not known; also under the static load"""
    engagements: NDArray[float64]
    """how often a tooth carries"""
    root_stress_mpa: NDArray[float64]
    """MPa: largest tooth root stress by ISO 6336-3, of spur gears with the load where it acts"""
    amplitude_mpa: NDArray[float64]
    """MPa: stress amplitude of the cycle that does most harm"""
    mean_mpa: NDArray[float64]
    """MPa: mean stress of that cycle"""
    equivalent_amplitude_mpa: NDArray[float64]
    """MPa: amplitude that does the same harm without mean stress; NaN where the mean stress alone is above the strength"""
    cycles: NDArray[float64]
    """cycles of an engagement, by the rainflow method"""
    damage: NDArray[float64]
    """Miner's sum of the root in this part of one pass"""
    contact_stress_mpa: NDArray[float64]
    """MPa: contact stress sigma_H by ISO 6336-2"""
    contact_damage: NDArray[float64]
    """Miner's sum of the flank in this part of one pass"""

class LifeCurveTable(Table):
    """the S-N curve"""

    failure_cycles: NDArray[float64]
    """cycles to failure"""
    stress_mpa: NDArray[float64]
    """MPa: root stress amplitude: fully reversed of a stated curve, of a material with a stress that rises from zero"""
    life_factor: NDArray[float64]
    """stress over that at the second point: Y_NT or Z_NT of a material"""
    gear: NDArray[str_]
    """pinion, gear or both"""
    curve: NDArray[str_]
    """the material whose curve by ISO 6336-2 or -3 it is, or stated"""

class ContactCurveTable(Table):
    """the S-N curve"""

    failure_cycles: NDArray[float64]
    """cycles to failure"""
    stress_mpa: NDArray[float64]
    """MPa: contact stress sigma_H"""
    life_factor: NDArray[float64]
    """stress over that at the second point: Y_NT or Z_NT of a material"""
    gear: NDArray[str_]
    """pinion, gear or both"""
    curve: NDArray[str_]
    """the material whose curve by ISO 6336-2 or -3 it is, or stated"""

class GearBodyTable(Table):
    """the gear as a body, and the grid of half a tooth sector"""

    gear: str
    """pinion or gear"""
    mass_kg: float
    """kg: mass"""
    polar_inertia_kgm2: float
    """kg m^2: moment of inertia about the axis"""
    rigid_motions: int
    """motions as a rigid body that the bore leaves; they are not among the modes"""
    sectors: int
    """tooth sectors"""
    nodes: int
    """nodes of the grid, three displacements each"""
    elements: int
    """its bricks"""

class BodyModesTable(Table):
    """natural modes of the gear body"""

    mode: NDArray[int64]
    """from the lowest frequency"""
    frequency_hz: NDArray[float64]
    """Hz: natural frequency"""
    mode_name: NDArray[str_]
    """torsion, umbrella, rocking, ... by nodal diameter, symmetry and energy"""
    nodal_diameter: NDArray[int64]
    """waves around the gear"""
    symmetry: NDArray[str_]
    """of the displacements in the plane about the middle plane"""
    order: NDArray[int64]
    """from the lowest of this nodal diameter and symmetry"""
    multiplicity: NDArray[int64]
    """modes of this frequency, equal but for a turn about the axis"""
    error_estimate: NDArray[float64]
    """estimated discretisation error, relative"""
    residual: NDArray[float64]
    """residual of the eigenvalue problem, relative"""
    radial_share: NDArray[float64]
    """kinetic energy of the radial motion over the whole"""
    tangential_share: NDArray[float64]
    """kinetic energy of the tangential motion over the whole"""
    axial_share: NDArray[float64]
    """kinetic energy of the axial motion over the whole"""

class BodyCampbellTable(Table):
    """speeds at which the mesh excites the modes of the gear body as it turns past the load"""

    mode: NDArray[int64]
    """from the lowest frequency"""
    per_turn: NDArray[int64]
    """excitations in a turn of the gear: harmonic times teeth, plus or minus nodal diameters"""
    harmonic: NDArray[int64]
    """of the mesh frequency; 0: the steady load"""
    nodal_diameter: NDArray[int64]
    """waves around the gear"""
    frequency_hz: NDArray[float64]
    """Hz: natural frequency"""
    rpm: NDArray[float64]
    """1/min: speed of the pinion at which these meet it"""

class BodyNodesTable(Table):
    """nodes on the front of the tooth sector"""

    node: NDArray[int64]
    """its number"""
    x_mm: NDArray[float64]
    """mm: across the tooth"""
    y_mm: NDArray[float64]
    """mm: along the tooth, from the axis of the gear"""
    z_mm: NDArray[float64]
    """mm: along the axis of the gear, from the middle plane"""

class BodyElementsTable(Table):
    """elements on the front of the tooth sector: four corners anticlockwise, then the midsides behind each"""

    element: NDArray[int64]
    """its number"""
    node_1: NDArray[int64]
    """number of this node"""
    node_2: NDArray[int64]
    """number of this node"""
    node_3: NDArray[int64]
    """number of this node"""
    node_4: NDArray[int64]
    """number of this node"""
    node_5: NDArray[int64]
    """number of this node"""
    node_6: NDArray[int64]
    """number of this node"""
    node_7: NDArray[int64]
    """number of this node"""
    node_8: NDArray[int64]
    """number of this node"""

class BodyShapesTable(Table):
    """mode shapes on the front, for unit modal mass of the gear: k sectors on, against the clock, the displacement is cos(n k pitch) times the first part less sin(n k pitch) times the second"""

    mode: NDArray[int64]
    """from the lowest frequency"""
    node: NDArray[int64]
    """its number"""
    radial_cos: NDArray[float64]
    """kg**-0.5: radial displacement, first part"""
    radial_sin: NDArray[float64]
    """kg**-0.5: radial displacement, second part"""
    tangential_cos: NDArray[float64]
    """kg**-0.5: tangential displacement, first part"""
    tangential_sin: NDArray[float64]
    """kg**-0.5: tangential displacement, second part"""
    axial_cos: NDArray[float64]
    """kg**-0.5: axial displacement, first part"""
    axial_sin: NDArray[float64]
    """kg**-0.5: axial displacement, second part"""

class MotionTable(Table):
    """load, masses and stiffness of the mesh, and its natural frequency"""

    load_n: float
    """N: static load on the line of action"""
    pinion_mass_kg: float
    """kg: effective mass of the pinion on the line of action, with what sits at its bore"""
    gear_mass_kg: float
    """kg: effective mass of the gear on the line of action, with what sits at its bore"""
    least_pair_stiffness_n_um: float
    """N/um: least stiffness of a pair on its path, whole face width"""
    largest_pair_stiffness_n_um: float
    """N/um: largest stiffness of a pair on its path, whole face width"""
    mean_mesh_stiffness_n_um: float
    """N/um: mean over a mesh period of all pairs in contact"""
    mean_mesh_stiffness_n_um_mm: float
    """N/(mm um): the same per mm of face width"""
    natural_frequency_hz: float
    """Hz: of the mean mesh stiffness and the effective masses"""
    resonance_rpm: float
    """1/min: speed of the pinion at which the mesh excites it"""
    iso_resonance_rpm: float
    """1/min: resonance running speed n_E1 of ISO 6336-1, method B, with the same masses"""
    body_rotation_um: float
    """um: rotation of whole gears about their bores under the load, on the line of action: not in the motion, except for felt_rotation_um"""
    body_coupling_um: float
    """um: what neighbouring teeth share beyond that: in the stiffness of each pair"""
    pinion_body_teeth: int
    """teeth of the body behind the pair stiffness of the pinion; 0: the whole gear"""
    gear_body_teeth: int
    """the same of the gear"""
    pinion_held_bore_mm: float
    """mm: diameter at which a whole pinion is held; NaN of other bodies"""
    gear_held_bore_mm: float
    """mm: the same of the gear"""
    backlash_um: float
    """um: of the motion; NaN where the coast flanks never touch"""
    damping_ratio: float
    """as in the case"""
    friction: float
    """friction coefficient, as in the case"""

class NodesTable(Table):
    """nodes of the section's grid"""

    node: NDArray[int64]
    """its number"""
    x_mm: NDArray[float64]
    """mm: across the middle tooth, towards its drive side"""
    y_mm: NDArray[float64]
    """mm: along the axis of that tooth"""

class ElementsTable(Table):
    """elements of the section's grid: four corners anticlockwise, then the midsides behind each"""

    element: NDArray[int64]
    """its number"""
    node_1: NDArray[int64]
    """number of this node"""
    node_2: NDArray[int64]
    """number of this node"""
    node_3: NDArray[int64]
    """number of this node"""
    node_4: NDArray[int64]
    """number of this node"""
    node_5: NDArray[int64]
    """number of this node"""
    node_6: NDArray[int64]
    """number of this node"""
    node_7: NDArray[int64]
    """number of this node"""
    node_8: NDArray[int64]
    """number of this node"""
    tooth: NDArray[int64]
    """that it belongs to, from the coast side; 0: the rim"""

class StressTable(Table):
    """stress at the nodes of the section's grid under the load of the table stress_load"""

    node: NDArray[int64]
    """its number"""
    sigma_x_mpa: NDArray[float64]
    """MPa: component across the middle tooth, x to its drive side"""
    sigma_y_mpa: NDArray[float64]
    """MPa: component along that tooth's axis y"""
    tau_xy_mpa: NDArray[float64]
    """MPa: shear component"""

class ModeShapesTable(Table):
    """mode shapes at the nodes of the section's grid, for unit modal mass"""

    mode: NDArray[int64]
    """from the lowest frequency"""
    node: NDArray[int64]
    """its number"""
    shape_x: NDArray[float64]
    """kg**-0.5: displacement in x over the modal coordinate"""
    shape_y: NDArray[float64]
    """kg**-0.5: displacement in y over the modal coordinate"""

class PublishedTable(Table):
    """printed values and ours"""

    quantity: NDArray[str_]
    """what is printed"""
    place: NDArray[str_]
    """where it is printed"""
    printed: NDArray[float64]
    """the printed value, in the unit of its row"""
    ours: NDArray[float64]
    """our value; NaN where the tasks do not compute it"""
    deviation: NDArray[float64]
    """ours over the printed value, less 1"""
    unit: NDArray[str_]
    """of both values"""
    status: NDArray[str_]
    """of the inputs: stated, inferred, fitted or not reproducible"""
    reason: NDArray[str_]
    """for the status"""

class Named:
    @property
    def geometry(self) -> GeometryTable: ...
    @property
    def gears(self) -> GearsTable: ...
    @property
    def contact_points(self) -> ContactPointsTable: ...
    @property
    def outline(self) -> OutlineTable: ...
    @property
    def mesh(self) -> MeshTable: ...
    @property
    def transmission_error(self) -> TransmissionErrorTable: ...
    @property
    def harmonics(self) -> HarmonicsTable: ...
    @property
    def static(self) -> StaticTable: ...
    @property
    def root_stress(self) -> RootStressTable: ...
    @property
    def root_rating(self) -> RootRatingTable: ...
    @property
    def stress_load(self) -> StressLoadTable: ...
    @property
    def section(self) -> SectionTable: ...
    @property
    def modal(self) -> ModalTable: ...
    @property
    def mode_energy(self) -> ModeEnergyTable: ...
    @property
    def face_load(self) -> FaceLoadTable: ...
    @property
    def face_load_phases(self) -> FaceLoadPhasesTable: ...
    @property
    def face_load_summary(self) -> FaceLoadSummaryTable: ...
    @property
    def face_misalignments(self) -> FaceMisalignmentsTable: ...
    @property
    def load(self) -> LoadTable: ...
    @property
    def load_points(self) -> LoadPointsTable: ...
    @property
    def motion_harmonics(self) -> MotionHarmonicsTable: ...
    @property
    def torque(self) -> TorqueTable: ...
    @property
    def torque_points(self) -> TorquePointsTable: ...
    @property
    def torque_harmonics(self) -> TorqueHarmonicsTable: ...
    @property
    def sweep(self) -> SweepTable: ...
    @property
    def sweep_worst(self) -> SweepWorstTable: ...
    @property
    def resonances(self) -> ResonancesTable: ...
    @property
    def sweep_summary(self) -> SweepSummaryTable: ...
    @property
    def optimum(self) -> OptimumTable: ...
    @property
    def optimum_curve(self) -> OptimumCurveTable: ...
    @property
    def optimum_map(self) -> OptimumMapTable: ...
    @property
    def optimum_design(self) -> OptimumDesignTable: ...
    @property
    def optimum_loads(self) -> OptimumLoadsTable: ...
    @property
    def deflection_relief(self) -> DeflectionReliefTable: ...
    @property
    def relief_deflection(self) -> ReliefDeflectionTable: ...
    @property
    def relief_curve(self) -> ReliefCurveTable: ...
    @property
    def relief_flank(self) -> ReliefFlankTable: ...
    @property
    def as_built(self) -> AsBuiltTable: ...
    @property
    def as_built_summary(self) -> AsBuiltSummaryTable: ...
    @property
    def as_built_worst(self) -> AsBuiltWorstTable: ...
    @property
    def as_built_teeth(self) -> AsBuiltTeethTable: ...
    @property
    def as_built_loads(self) -> AsBuiltLoadsTable: ...
    @property
    def as_built_turn(self) -> AsBuiltTurnTable: ...
    @property
    def as_built_orders(self) -> AsBuiltOrdersTable: ...
    @property
    def as_built_waterfall(self) -> AsBuiltWaterfallTable: ...
    @property
    def tolerances(self) -> TolerancesTable: ...
    @property
    def stability(self) -> StabilityTable: ...
    @property
    def tongues(self) -> TonguesTable: ...
    @property
    def tongue_edges(self) -> TongueEdgesTable: ...
    @property
    def hysteresis(self) -> HysteresisTable: ...
    @property
    def hysteresis_changes(self) -> HysteresisChangesTable: ...
    @property
    def hysteresis_ramps(self) -> HysteresisRampsTable: ...
    @property
    def hysteresis_delays(self) -> HysteresisDelaysTable: ...
    @property
    def poincare(self) -> PoincareTable: ...
    @property
    def lyapunov(self) -> LyapunovTable: ...
    @property
    def attractors(self) -> AttractorsTable: ...
    @property
    def attractor_points(self) -> AttractorPointsTable: ...
    @property
    def basins(self) -> BasinsTable: ...
    @property
    def branches(self) -> BranchesTable: ...
    @property
    def branch_points(self) -> BranchPointsTable: ...
    @property
    def branch_changes(self) -> BranchChangesTable: ...
    @property
    def sensitivity(self) -> SensitivityTable: ...
    @property
    def dte_sensitivity(self) -> DteSensitivityTable: ...
    @property
    def ste_sensitivity(self) -> SteSensitivityTable: ...
    @property
    def precision(self) -> PrecisionTable: ...
    @property
    def precision_finest(self) -> PrecisionFinestTable: ...
    @property
    def flank(self) -> FlankTable: ...
    @property
    def flank_losses(self) -> FlankLossesTable: ...
    @property
    def rating(self) -> RatingTable: ...
    @property
    def rating_factors(self) -> RatingFactorsTable: ...
    @property
    def dynamic_factors(self) -> DynamicFactorsTable: ...
    @property
    def transient(self) -> TransientTable: ...
    @property
    def transient_points(self) -> TransientPointsTable: ...
    @property
    def transient_peaks(self) -> TransientPeaksTable: ...
    @property
    def harmonic(self) -> HarmonicTable: ...
    @property
    def section_resonances(self) -> SectionResonancesTable: ...
    @property
    def campbell(self) -> CampbellTable: ...
    @property
    def life(self) -> LifeTable: ...
    @property
    def life_parts(self) -> LifePartsTable: ...
    @property
    def life_curve(self) -> LifeCurveTable: ...
    @property
    def contact_curve(self) -> ContactCurveTable: ...
    @property
    def gear_body(self) -> GearBodyTable: ...
    @property
    def body_modes(self) -> BodyModesTable: ...
    @property
    def body_campbell(self) -> BodyCampbellTable: ...
    @property
    def body_nodes(self) -> BodyNodesTable: ...
    @property
    def body_elements(self) -> BodyElementsTable: ...
    @property
    def body_shapes(self) -> BodyShapesTable: ...
    @property
    def motion(self) -> MotionTable: ...
    @property
    def nodes(self) -> NodesTable: ...
    @property
    def elements(self) -> ElementsTable: ...
    @property
    def stress(self) -> StressTable: ...
    @property
    def mode_shapes(self) -> ModeShapesTable: ...
    @property
    def published(self) -> PublishedTable: ...
