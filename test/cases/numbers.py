"""What the numbers of a run's tables must be to each other and to the case, as a reader with a pocket calculator finds them:
python3 numbers.py FOLDER NAME, for the case that test_program.sh calls every.nml.

Prints `passed NAME` or `FAILED NAME: what it is, and what it should be` for each.
"""

import cmath
import csv
import math
import sys
from itertools import pairwise
from pathlib import Path

Z1, Z2, MODULE, WIDTH, LOAD, FRICTION, NU = 21, 34, 3.0, 20.0, 4000.0, 0.06, 0.3
BASES = [MODULE * z / 2 * math.cos(math.radians(20)) for z in (Z1, Z2)]  # base radii, mm
folder, name = Path(sys.argv[1]), sys.argv[2]
found = {}


def value(word):
    try:
        return float(word)
    except ValueError:
        return word


def table(of):
    """Rows of a table, by column."""
    with open(folder / f'{name}.{of}.csv') as file:
        rows = csv.DictReader(line for line in file if not line.startswith('#'))
        return [{column: value(word) for column, word in row.items()} for row in rows]


def near(title, is_so, should_be, relative=1e-9, absolute=1e-12):
    """Each time that something is looked at; one that failed stays failed."""
    good = abs(is_so - should_be) <= max(relative * abs(should_be), absolute)
    found.setdefault(title, '')
    if not good:
        found[title] = f'{is_so}, should be {should_be}'


def true(title, good):
    near(title, bool(good), True)


def rows_of(rows, *like):
    """Those that have the relief and speed of a row, or what else of it is named."""
    row, *columns = like
    return [one for one in rows if all(one[column] == row[column] for column in columns)]


def pair_and_motion():
    pair, gears, points, motion = table('geometry')[0], table('gears'), table('contact_points'), table('motion')[0]
    alpha = math.radians(20)
    for gear, z, x in zip(gears, (Z1, Z2), (0.1, 0)):
        near('base diameter', gear['base_diameter_mm'], MODULE * z * math.cos(alpha))
        near('tip diameter', gear['tip_diameter_mm'], MODULE * (z + 2 + 2 * x))
        near('root diameter', gear['root_diameter_mm'], MODULE * (z - 2.5 + 2 * x))
    near('contact ratio by the points', points[4]['s'], pair['contact_ratio'])
    near('B, one base pitch before E', points[1]['s'], pair['contact_ratio'] - 1)
    near('D, one base pitch behind A', points[3]['s'], 1)
    # Each gear is touched at its tip at one end of the path, and at its active diameter at the other.
    near('pinion at E', 2 * points[4]['pinion_radius_mm'], gears[0]['tip_diameter_mm'])
    near('gear at A', 2 * points[0]['gear_radius_mm'], gears[1]['tip_diameter_mm'])
    near('pinion at A', 2 * points[0]['pinion_radius_mm'], gears[0]['active_diameter_mm'])
    near('gear at E', 2 * points[4]['gear_radius_mm'], gears[1]['active_diameter_mm'])
    # On the coast side, a base circle and a working angle of its own.
    coast = math.radians(22)
    bases = [MODULE * z / 2 * math.cos(coast) for z in (Z1, Z2)]
    working = math.acos(sum(bases) / pair['centre_distance_mm'])
    path = sum(math.sqrt((gear['tip_diameter_mm'] / 2) ** 2 - base**2) for gear, base in zip(gears, bases))
    path -= pair['centre_distance_mm'] * math.sin(working)
    near('working angle of the coast flanks', pair['coast_working_angle_deg'], math.degrees(working))
    near('contact ratio of the coast flanks', pair['coast_contact_ratio'], path / (math.pi * MODULE * math.cos(coast)))
    mass = 0.5 * 0.9 / 1.4
    near('natural frequency', motion['natural_frequency_hz'], math.sqrt(1e6 * motion['mean_mesh_stiffness_n_um'] / mass) / math.tau)
    near('resonance', motion['resonance_rpm'], 60 * motion['natural_frequency_hz'] / Z1)


def static():
    mesh, ste, harmonics = table('mesh'), table('transmission_error'), table('harmonics')
    ratio = table('geometry')[0]['contact_ratio']
    for one in ste:
        rows = rows_of(mesh, one, 'relief_um')
        near('largest static share', one['largest_load_share'], max(row['load_share'] for row in rows), 1e-12)
        # A tenth less of a corner's stiffness: as the loads add up to the whole, the gears deflect by a tenth of the corner's load
        # over the stiffness of all pairs.
        beyond = [row for row in rows if not 0 <= row['s'] <= ratio]
        softer = max(0.1 * row['load_share'] * LOAD / row['mesh_stiffness_n_um'] for row in beyond)
        near('what is not known of corners', one['corner_estimate_um'], softer, 0.1)
        error = [row['ste_um'] for row in rows]
        near('peak-to-peak', one['peak_to_peak_um'], max(error) - min(error), 1e-3)
        # Mean and harmonics add up to the transmission error, but for steep steps: the sign of a phase shows.
        parts = [cmath.rect(row['amplitude_um'], math.radians(row['phase_deg'])) for row in rows_of(harmonics, one, 'relief_um')]
        off = [sum((a * cmath.exp(2j * math.pi * k * row['s'])).real for k, a in enumerate(parts)) - row['ste_um'] for row in rows]
        true('harmonics add up', sum(x * x for x in off) < 0.2 * sum((x - one['mean_um']) ** 2 for x in error))


def load():
    points, paths, harmonics = table('load_points'), table('load'), table('motion_harmonics')
    for one in points:
        rows = rows_of(paths, one, 'relief_um', 'rpm')
        near('load ratio', max(abs(row['load_ratio'] - row['pair_load_n'] / LOAD) for row in rows), 0)
        near('DF is the largest load ratio', one['dynamic_factor'], max(row['load_ratio'] for row in rows), 1e-3)
        error = [row['dte_um'] for row in rows]
        near('DTE from peak to peak', one['dte_peak_to_peak_um'], max(error) - min(error), 1e-3)
        parts = rows_of(harmonics, one, 'relief_um', 'rpm')
        near('mean DTE', parts[0]['dte_amplitude_um'], one['dte_mean_um'])
        near('mean load', parts[0]['mesh_load_amplitude_n'], one['mean_load_ratio'] * LOAD)
        for part in parts:
            near('frequency of a harmonic', part['frequency_hz'], part['harmonic'] * Z1 * one['rpm'] / 60)
        # Parseval, as far as the harmonics go.
        for what, rms in (('dte_amplitude_um', one['dte_rms_um']), ('mesh_load_amplitude_n', one['load_rms_ratio'] * LOAD)):
            near(f'{what}: Parseval', math.sqrt(sum(part[what] ** 2 for part in parts[1:]) / 2), rms, 0.03)
        terms = [(part['harmonic'], cmath.rect(part['dte_amplitude_um'], math.radians(part['dte_phase_deg']))) for part in parts]
        off = [sum((a * cmath.exp(2j * math.pi * k * row['s'])).real for k, a in terms) - row['dte_um'] for row in rows if row['pair'] == 1]
        true('harmonics add up to the DTE', max(map(abs, off)) < 0.05 * one['dte_peak_to_peak_um'])
        near('a pair has the rms of its path', one['pair_load_rms_ratio'], rms_over(rows, 'load_ratio'), 1e-3)


def rms_over(rows, column):
    """Of values over the path of all different pairs, by the trapezoidal rule."""
    ends = [(a, b) for a, b in pairwise(rows) if a['pair'] == b['pair']]
    area = sum((b['s'] - a['s']) * (a[column] ** 2 + b[column] ** 2) / 2 for a, b in ends)
    return math.sqrt(area / sum(b['s'] - a['s'] for a, b in ends))


def sweep():
    points, worst, summary, motion = table('sweep'), table('sweep_worst'), table('sweep_summary')[0], table('motion')[0]
    for one in worst:
        rows = rows_of(points, one, 'relief_um')
        top = max(rows, key=lambda row: row['dynamic_factor'])
        near('worst DF', one['worst_dynamic_factor'], top['dynamic_factor'])
        near('worst speed', one['rpm'], top['rpm'])
        # Of the runs up and down, the one whose worst is less.
        ways = [max(row['dynamic_factor' if row['direction'] in (way, 'both') else 'other_dynamic_factor'] for row in rows)
                for way in ('up', 'down')]  # fmt: skip
        near('worst of the other direction', one['other_dynamic_factor'], min(ways))
    best = min(worst, key=lambda row: row['worst_dynamic_factor'])
    near('best relief', summary['best_relief_um'], best['relief_um'])
    near('its worst DF', summary['worst_dynamic_factor'], best['worst_dynamic_factor'])
    near('largest estimate', summary['largest_error_estimate'], max(row['error_estimate'] for row in points))
    near('points with contact loss', summary['points_with_contact_loss'], sum(row['contact'] in ('lost', 'coast') for row in points))
    near('points', summary['points'], len(points))
    near('of which ok', summary['points_ok'], sum(row['status'] == 'ok' for row in points))
    for row in points:
        near('frequency ratio', row['frequency_ratio'], Z1 * row['rpm'] / 60 / motion['natural_frequency_hz'])
        true('of two motions the larger', not row['other_dynamic_factor'] > row['dynamic_factor'])
    for one in table('resonances'):
        rows = [row for row in rows_of(points, one, 'relief_um') if abs(row['rpm'] / one['resonance_rpm'] - 1) <= 0.15]
        true('resonance: of the points about it', any(row['dynamic_factor'] == one['dynamic_factor'] and row['rpm'] == one['rpm']
                                                       for row in rows))  # fmt: skip


def torque():
    points, times = table('torque_points'), table('torque')
    rb1, rb2 = (radius / 1000 for radius in BASES)
    for one in points:
        rows = rows_of(times, one, 'relief_um', 'rpm')
        for gear in ('pinion', 'gear'):
            values = [row[f'{gear}_torque_nm'] for row in rows]
            near('largest torque', one[f'{gear}_largest_nm'], max(values), 1e-3)
            near('least torque', one[f'{gear}_least_nm'], min(values), 1e-3)
            true('mean between them', one[f'{gear}_least_nm'] < one[f'{gear}_mean_nm'] < one[f'{gear}_largest_nm'])
            mean = sum((b['tau'] - a['tau']) * (a[f'{gear}_friction_nm'] + b[f'{gear}_friction_nm']) / 2
                       for a, b in pairwise(rows)) / rows[-1]['tau']  # fmt: skip
            near('mean friction', one[f'{gear}_friction_mean_nm'], mean, 0.02, 0.01)
        near('mean without friction', one['pinion_mean_nm'] / rb1 - one['gear_mean_nm'] / rb2,
             one['pinion_friction_mean_nm'] / rb1 - one['gear_friction_mean_nm'] / rb2, 1e-4)  # fmt: skip
        near('what friction takes', one['friction_loss'], 1 - one['gear_mean_nm'] / one['pinion_mean_nm'] * Z1 / Z2)
        true('it is some per cent', 0 < one['friction_loss'] < FRICTION)
        for row in rows:
            near('time', row['time_s'], row['tau'] * 60 / (Z1 * row['rpm']))
            # Both gears feel one load and one damping, at their base radii, and each its friction.
            near('torques of both gears', (row['pinion_torque_nm'] - row['pinion_friction_nm']) / rb1,
                 (row['gear_torque_nm'] - row['gear_friction_nm']) / rb2)  # fmt: skip
    # What damping carries has no mean over a period but by friction; elastic load and damping make the rest of the torque.
    loads = {(row['relief_um'], row['rpm']): row for row in table('load_points')}
    for one in points:
        rows = rows_of(times, one, 'relief_um', 'rpm')
        elastic = [(row['pinion_torque_nm'] - row['pinion_friction_nm'] - row['pinion_damping_nm']) / rb1 for row in rows]
        steps = [(b['tau'] - a['tau'], x, y) for a, b, x, y in zip(rows, rows[1:], elastic, elastic[1:])]
        mean = sum(step * (x + y) / 2 for step, x, y in steps) / rows[-1]['tau']
        near('elastic load by the torque', mean, loads[one['relief_um'], one['rpm']]['mean_load_ratio'] * LOAD, 5e-3)
        apart = sum(step for step, x, y in steps if abs(x) + abs(y) < 1e-6 * LOAD) / rows[-1]['tau']
        near('time apart by the torque', loads[one['relief_um'], one['rpm']]['separation_share'], apart, 0.02, 0.01)
        # Harmonics of the load, signs of phases included, add up to it, but for what is above the highest.
        terms = [(part['harmonic'], cmath.rect(part['mesh_load_amplitude_n'], math.radians(part['mesh_load_phase_deg'])))
                 for part in rows_of(table('motion_harmonics'), one, 'relief_um', 'rpm')]  # fmt: skip
        off = [sum((a * cmath.exp(2j * math.pi * k * row['tau'])).real for k, a in terms) - x for row, x in zip(rows, elastic)]
        true('harmonics add up to the load', sum(x * x for x in off) < 0.06 * sum((x - mean) ** 2 for x in elastic))
    for row in table('torque_harmonics'):
        for gear in ('pinion', 'gear'):
            known = row['harmonic'] == 0 or row[f'{gear}_amplitude_nm'] > row[f'{gear}_error_nm']
            true('a phase where the amplitude is known', math.isnan(row[f'{gear}_phase_deg']) != known)


def half_width(load, gear, radius):
    """Of the contact (um) at `radius` (mm) of the pinion (0) or the gear (1): Hertz, both flanks in plane strain."""
    first = math.sqrt(radius**2 - BASES[gear] ** 2)
    second = math.sqrt(table('geometry')[0]['centre_distance_mm'] ** 2 - sum(BASES) ** 2) - first
    modulus = 206e3 / (2 * (1 - NU**2))
    return 1e3 * math.sqrt(4 * load / WIDTH * first * second / (first + second) / (math.pi * modulus))


def flank():
    contacts, losses = table('flank'), table('flank_losses')
    pitch = math.pi * MODULE * math.cos(math.radians(20))
    for row in contacts:
        near('sliding', row['sliding_m_s'], row['pinion_rolling_m_s'] - row['gear_rolling_m_s'], 1e-9, 1e-9)
        near('specific sliding of the pinion', row['pinion_specific_sliding'], row['sliding_m_s'] / row['pinion_rolling_m_s'])
        near('specific sliding of the gear', row['gear_specific_sliding'], -row['sliding_m_s'] / row['gear_rolling_m_s'])
        near('place on the path', row['path_mm'], pitch * row['s'], 1e-9, 1e-9)
        if row['pressure_mpa'] > 0:
            start = math.sqrt(table('contact_points')[0]['pinion_radius_mm'] ** 2 - BASES[0] ** 2)
            radius = math.hypot(start + row['path_mm'], BASES[0])
            near('half width of the contact', row['half_width_um'], half_width(row['pair_load_n'], 0, radius), 1e-6)
            near('p = 2 F/(pi b a)', row['pressure_mpa'], 2e3 * row['pair_load_n'] / (math.pi * WIDTH * row['half_width_um']), 1e-9)
            # Blok's flash temperature, of two flanks that conduct 45 and 60 W/(m K): 7850 kg/m^3, 484 J/(kg K).
            heat = sum(math.sqrt(conductivity * 7850 * 484 * row[f'{gear}_rolling_m_s'])
                       for gear, conductivity in (('pinion', 45), ('gear', 60)))  # fmt: skip
            power = row['friction_power_w'] / (WIDTH / 1000)
            near('flash temperature', row['flash_temperature_k'], 1.11 * power / (heat * math.sqrt(2e-6 * row['half_width_um'])), 2e-3)
    for one in losses:
        rows = rows_of(contacts, one, 'relief_um', 'rpm', 'loading')
        known = [row for row in rows if row['pressure_mpa'] >= 0]
        near('largest pressure', one['largest_pressure_mpa'], max(row['pressure_mpa'] for row in known))
        near('largest flash', one['largest_flash_k'], max(row['flash_temperature_k'] for row in known))
        near('least film', one['least_film_um'], min(row['film_thickness_um'] for row in known if row['film_thickness_um'] > 0))
        near('power', one['input_power_w'], LOAD * BASES[0] / 1000 * math.pi * one['rpm'] / 30)
        near('loss', one['friction_loss_w'], one['friction_coefficient'] * one['loss_factor'] * one['input_power_w'])
        near('efficiency', one['efficiency'], 1 - one['friction_loss_w'] / one['input_power_w'])
        for row in rows:
            near('friction power', row['friction_power_w'], one['friction_coefficient'] * row['pair_load_n'] * abs(row['sliding_m_s']))


def rating():
    rows, factors, dynamic = table('rating'), table('rating_factors'), table('dynamic_factors')
    shares = {row['relief_um']: row['largest_load_share'] for row in table('transmission_error')}
    points = {(row['relief_um'], row['rpm']): row['dynamic_factor'] for row in table('load_points')}
    for row in dynamic:
        near('static share', row['static_share'], shares[row['relief_um']], 1e-3)
        near('DF as in the task load', row['dynamic_factor'], points[row['relief_um'], row['rpm']], 1e-6)
        near('K_v by A', row['dynamic_factor_a'], max(1, row['dynamic_factor'] / row['static_share']))
        near('N', row['resonance_ratio'], row['rpm'] / factors[0]['resonance_rpm'])
    # n_E1 = 30000/(pi z1) sqrt(c_gamma/m_red), ISO 6336-1, 6.5.3.
    first = factors[0]
    near('n_E1', first['resonance_rpm'], 3e4 / math.pi / Z1 * math.sqrt(first['mesh_stiffness_n_mm_um'] / first['reduced_mass_kg_mm']))
    near('m_red', first['reduced_mass_kg_mm'], 0.5 * 0.9 / 1.4 / WIDTH)
    # Stated are 10 and 8 um, of which running in takes 7.5 %.
    near('f_pb after running in', first['pitch_deviation_um'], 9.25)
    near('f_f_alpha after running in', first['profile_deviation_um'], 7.4)
    for row in rows:
        k = row['gear'] == 'gear'
        of = factors[k]
        k_v = rows_of(dynamic, row, 'relief_um', 'rpm')[0]
        near('K_v', row['internal_dynamic_factor'], max(k_v['dynamic_factor_a'], k_v['dynamic_factor_b']))
        near('S_H', row['contact_safety'], (1400, 1300)[k] / row['contact_stress_mpa'])
        near('S_F', row['root_safety'], (700, 650)[k] / row['root_stress_mpa'])
        near('sigma_H', row['contact_stress_mpa'], of['single_pair_factor'] * of['nominal_contact_mpa']
             * math.sqrt(row['internal_dynamic_factor'] * 1.2))  # fmt: skip
        near('sigma_F', row['root_stress_mpa'], of['nominal_root_mpa'] * row['internal_dynamic_factor'] * of['root_face_load_factor'])
        # Y_F Y_S Y_B Y_DT F_t/(b m)
        near('sigma_F0', of['nominal_root_mpa'], of['tangential_load_n'] / (WIDTH * MODULE) * of['form_factor']
             * of['stress_correction'] * of['rim_factor'] * of['deep_tooth_factor'])  # fmt: skip
    # The gear's rim of 6 mm below teeth of 6.75 mm, the pinion solid: Y_B = 1.6 ln(2.242 h_t/s_R).
    near('Y_B of the pinion', factors[0]['rim_factor'], 1)
    near('Y_B of the gear', factors[1]['rim_factor'], 1.6 * math.log(2.242 * 6.75 / 6))


def life():
    rows, parts, passes = table('life'), table('life_parts'), 30
    for row in parts:
        hours, ratio = (10, 20)[int(row['part']) - 1], 1 if row['gear'] == 'pinion' else Z1 / Z2
        near('engagements', row['engagements'], 60 * row['rpm'] * hours * ratio)
        near('cycle about its mean', row['amplitude_mpa'] / (1 - row['mean_mpa'] / 1100), row['equivalent_amplitude_mpa'])
    for one in rows:
        own = rows_of(parts, one, 'relief_um', 'gear')
        near('damage of both parts', one['damage'], sum(row['damage'] for row in own))
        near('worst part', one['worst_part'], max(own, key=lambda row: row['damage'])['part'] if one['damage'] else 0)
        near('largest stress', one['largest_root_stress_mpa'], max(row['root_stress_mpa'] for row in own))
        true('kind', one['kind'] == ('finite' if one['damage'] else 'endless'))
        if one['damage']:
            near('passes', one['passes'], 1 / one['damage'])
            near('life', one['life_h'], passes / one['damage'])
    true('some life ends', any(row['damage'] > 0 for row in rows))


def tooth():
    mises = math.sqrt(1 - NU + NU**2)
    points, times, peaks = table('transient_points'), table('transient'), table('transient_peaks')
    for row in times + points:
        near('von Mises', row['mises_mpa'], mises * abs(row['sigma_mpa']))
        near('trace', row['sigma_x_mpa'] + row['sigma_y_mpa'], row['sigma_mpa'])
        near('determinant', row['sigma_x_mpa'] * row['sigma_y_mpa'], row['tau_xy_mpa'] ** 2, 1e-9, 1e-9)
    for one in points:
        rows = rows_of(times, one, 'relief_um', 'rpm', 'tangent_deg', 'side')
        high, low = (f(rows, key=lambda row: row['sigma_mpa']) for f in (max, min))
        scale = max(abs(high['sigma_mpa']), abs(low['sigma_mpa']))
        near('highest', one['highest_mpa'], high['sigma_mpa'], 0.01, 0.01 * scale)
        near('lowest', one['lowest_mpa'], low['sigma_mpa'], 0.01, 0.01 * scale)
        for extreme in ('highest', 'lowest'):
            then = min(rows, key=lambda row: abs(row['time_ms'] - one[f'{extreme}_ms']))
            near(f'when {extreme}', then['sigma_mpa'], one[f'{extreme}_mpa'], 0, 0.02 * scale)
        near('at rest', abs(one['static_mpa']), max(abs(row['static_mpa']) for row in rows), 0.01)
        near('displacement', abs(one['displacement_x_um']), max(abs(row['displacement_x_um']) for row in rows), 0.03)
    for one in peaks:
        near('tension ratio', one['tension_ratio'], one['tension_mpa'] / one['static_tension_mpa'])
        near('compression ratio', one['compression_ratio'], one['compression_mpa'] / one['static_compression_mpa'])
        near('von Mises of the largest', one['mises_mpa'], mises * max(one['tension_mpa'], -one['compression_mpa']))
    for row in table('harmonic'):
        near('strain in plane strain', row['strain_um_m'], row['stress_mpa'] * (1 - NU**2) / 0.206)
        if row['frequency_hz'] == 0:
            near('at rest tension or compression', abs(row['stress_phase_deg']) % 180, 0)
        true('behind the load', row['side'] == 'coast' or row['stress_phase_deg'] <= 0)
    modal = {row['mode']: row for row in table('modal')}
    for row in table('section_resonances'):
        near('natural frequency of the section', row['natural_frequency_hz'], modal[row['mode']]['frequency_hz'])
        near('its error', row['frequency_error'], modal[row['mode']]['error_estimate'])
    for row in table('campbell'):
        near('speed', row['rpm'], 60 * row['frequency_hz'] / (Z1 * row['harmonic']))
    for row in table('mode_energy'):
        if row['tooth'] == 0:
            near('energy of the rim', modal[row['mode']]['rim_share'], row['energy_share'])
    static_rows, root = table('static'), table('root_stress')
    for one in root:
        stress = [row['sigma_mpa'] for row in rows_of(static_rows, one, 'relief_um')]
        true('largest of the fillet', one['tension_mpa'] >= max(stress) > 0 > min(stress) >= one['compression_mpa'])
    near('where ISO takes the load', table('root_rating')[0]['point'] == 'D', 1)


def body():
    body, modes = table('gear_body')[0], table('body_modes')
    near('it can slide', body['rigid_motions'], 1)
    for row in modes:
        shares = {way: row[f'{way}_share'] for way in ('radial', 'tangential', 'axial')}
        near('all energy', sum(shares.values()), 1)
        near('multiplicity', row['multiplicity'], 2 if row['nodal_diameter'] > 0 else 1)
        flat = row['symmetry'] == 'symmetric'
        if row['nodal_diameter'] == 1:
            true('a tilt or a step', row['mode_name'] == ('translation' if flat else 'rocking'))
        if row['nodal_diameter'] == 0:
            most = max(shares, key=shares.get)
            names = {'radial': 'breathing', 'tangential': 'torsion', 'axial': 'stretch' if flat else 'umbrella'}
            true('what moves most', row['mode_name'] == names[most])
    true('ascending', all(a['frequency_hz'] <= b['frequency_hz'] for a, b in pairwise(modes)))
    true('umbrella and torsion', {'umbrella', 'torsion', 'rocking'} <= {row['mode_name'] for row in modes})


def motions():
    points, all_motions, starts = table('attractor_points'), table('attractors'), table('basins')
    for one in points:
        known = rows_of(all_motions, one, 'relief_um', 'rpm')
        near('how many motions', one['motions'], len(known))
        near('all starts', sum(row['share'] for row in known) + one['unsettled_share'], 1)
        near('largest DF', one['largest_dynamic_factor'], max(row['dynamic_factor'] for row in known if row['starts'] > 0))
        if one['each_motion'] > 0:
            near('share of the single one', one['each_share'], known[int(one['each_motion']) - 1]['share'])
            near('DF of the single one', one['each_dynamic_factor'], known[int(one['each_motion']) - 1]['dynamic_factor'], 1e-4)
        own = rows_of(starts, one, 'relief_um', 'rpm')
        for row in known:
            near('starts', row['starts'], sum(start['motion'] == row['motion'] for start in own))
    # Starts are spread alike at all speeds: by static deflections, and those times the natural frequency.
    for row in starts:
        like = [start for start in starts if start['start'] == row['start']]
        near('rates of starts', row['dte_rate_mm_s'], like[0]['dte_rate_mm_s'])
    # The section is the motion of the attractors, where there is one of a mesh period.
    seen = table('poincare')
    for one in table('lyapunov'):
        known = rows_of(all_motions, one, 'relief_um', 'rpm')
        last = rows_of(seen, one, 'relief_um', 'rpm')[-1]
        if one['status'] == 'ok' and len(known) == 1:
            near('section: DTE', last['dte_um'], known[0]['dte_um'], 1e-4)
            near('section: rate', last['dte_rate_mm_s'], known[0]['dte_rate_mm_s'], 1e-3, 0.01)
            near('growth by the multiplier', math.exp(one['lyapunov_exponent']), known[0]['floquet_modulus'], 0.05)
    edges, tongue = table('tongue_edges'), table('tongues')[0]
    for row in edges:
        true('edges', row['lower_rpm'] < row['upper_rpm'] or row['damping_ratio'] > tongue['closing_damping_ratio'])
        true('closed from there on', (row['lower_rpm'] > 0) == (row['damping_ratio'] < tongue['closing_damping_ratio']))
    # Between the edges of the first tongue the period doubles: the multiplier is below -1.
    for row in table('stability'):
        edge = rows_of(edges, row, 'damping_ratio')[0]
        inside = edge['lower_rpm'] < row['rpm'] < edge['upper_rpm']
        true('unstable between the edges', (row['floquet_modulus'] > 1) == inside)
        true('sense of what doubles', row['sense'] == -1 or not inside)
    true('a speed between them', any(row['floquet_modulus'] > 1 for row in table('stability')))
    for row in table('sensitivity'):
        near('relative slope', row['relative_slope'], row['value'] * row['slope'] / row['dynamic_factor'])
        # Where the derivative is smooth, both sides have it, to the differences that they are taken by (1e-7 here).
        if row['derivative'] == 'smooth':
            for side in ('slope_below', 'slope_above'):
                near(side, row[side], row['slope'], 1e-5, 10 * row['error_estimate'])
    kept, alike = table('hysteresis'), 0
    for row in kept:
        other = [one for one in table('sweep') if one['rpm'] == row['rpm'] and one['relief_um'] == row['relief_um']]
        if not other:
            continue
        true('a slow run meets the sweep', any(abs(x - row['dynamic_factor']) < 1e-4 * x for x in
                                               (other[0]['dynamic_factor'], other[0]['other_dynamic_factor'])))  # fmt: skip
        # Where there is one motion only: from another start, and in steps of another level.
        if other[0]['direction'] == 'both':
            beside = other[0]
            both = row['error_estimate'] + beside['error_estimate']
            near('one motion of a slow run, within the estimates', row['dynamic_factor'], beside['dynamic_factor'], 0, both)
            # Equal to rounding: in the same steps.
            if abs(row['dynamic_factor'] - beside['dynamic_factor']) < 1e-11:
                alike += 1
                near('estimate of a slow run, in the same steps', row['error_estimate'], beside['error_estimate'], 0.01)
            true('estimate of a slow run, to a level of steps', 1 / 4 < beside['error_estimate'] / row['error_estimate'] < 4)
    true('slow runs in the steps of the sweep', alike > 0)
    for row in kept:
        for one in rows_of(all_motions, row, 'relief_um', 'rpm'):
            if abs(one['dynamic_factor'] - row['dynamic_factor']) < 1e-6:
                # Of sixth order; a level has the cube root of two times as many steps as the one before.
                true('estimate of an attractor, to a level of steps', 1 / 4 < one['error_estimate'] / row['error_estimate'] < 4)
    changes = table('hysteresis_changes')
    for row in changes:
        before, after = row['mesh_periods_before'], row['mesh_periods_after']
        true('kind of a change', row['kind'] == {2: 'doubling', 0.5: 'halving'}.get(after / before, 'jump'))
        true('in its direction', (row['rpm_after'] > row['rpm_before']) == (row['direction'] == 'up'))
    true('there is a doubling and a jump', {'doubling', 'jump'} <= {row['kind'] for row in changes})
    best, curve = table('optimum')[0], table('optimum_curve')
    row = min(curve, key=lambda one: (one['worst_dynamic_factor'], one['relief_um']))
    near('optimum', best['relief_um'], row['relief_um'])
    near('its DF', best['worst_dynamic_factor'], row['worst_dynamic_factor'])
    near('its speed', best['rpm'], row['rpm'])
    at = curve.index(row)
    near('within', best['within_um'], max(abs(curve[i]['relief_um'] - row['relief_um']) for i in (at - 1, at + 1)
                                         if 0 <= i < len(curve)), 1e-6)  # fmt: skip
    parts, reliefs = table('relief_deflection'), {row['method']: row for row in table('deflection_relief')}
    gears = table('gears')
    curve, found = table('relief_curve'), reliefs['dynamic_factor']
    at = min(range(len(curve)), key=lambda i: abs(curve[i]['relief_um'] - found['pinion_relief_um']))
    gaps = [abs(curve[i]['relief_um'] - curve[at]['relief_um']) for i in (at - 1, at + 1) if 0 <= i < len(curve)]
    near('least dynamic factor: within the reliefs beside', found['within_um'], max(gaps), 1e-6)
    for k, (part, key) in enumerate(zip(parts, ('pinion_relief_um', 'gear_relief_um'))):
        near('sum of both parts', part['formula_deflection_um'], part['bending_um'] + part['flattening_um'])
        near('loaded at the tip', part['load_diameter_mm'], gears[k]['tip_diameter_mm'])
        near('half width under the load at the tip', part['half_width_um'], half_width(LOAD, k, part['load_diameter_mm'] / 2), 1e-6)
        near('half of the flattening', reliefs['markovic_vrcan'][key], part['bending_um'] + part['flattening_um'] / 2)
        near('all of it', reliefs['whole_flattening'][key], part['formula_deflection_um'])


for check in (pair_and_motion, static, load, sweep, torque, flank, rating, life, tooth, body, motions):
    check()
for title, wrong in found.items():
    print(f'FAILED {title}: {wrong}' if wrong else f'passed {title}')
