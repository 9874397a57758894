"""Formulas as the pages print them, evaluated, and the library's values for what they say."""

import functools
import math
import re
import warnings

import numpy as np

import gearsweep

from . import cases

FUNCTIONS = {'sqrt': math.sqrt, 'exp': math.exp, 'ln': math.log, 'log': math.log, 'sin': math.sin, 'cos': math.cos, 'tan': math.tan,
             'arctan': math.atan, 'inv': lambda angle: math.tan(angle) - angle, 'abs': abs}
TOKEN = re.compile(r"\s*(?:(\d+(?:\.\d+)?(?:e-?\d+)?)|([A-Za-z]\w*(?:\([a-z]\))?'?\*?)|(\S))")


def value(text, names):
    """Of an expression such as `30000/(pi z1) sqrt(c/m)`: what stands side by side is multiplied, from left to right."""
    text = re.sub(r'\|([^|]*)\|', r'abs(\1)', text)
    parts, ends = [], False
    position = 0
    while position < len(text.rstrip()):
        found = TOKEN.match(text, position)
        position = found.end()
        number, name, sign = found.groups()
        if name and name.endswith('*') and name not in names:
            position -= 1
            name = name[:-1]
        if name and name not in names and name.endswith(')'):
            position -= len(name) - name.index('(')
            name = name[:name.index('(')]
        if ends and (number or name or sign == '('):
            parts.append('*')
        if number:
            parts.append(number)
        elif name == 'pi':
            parts.append(repr(math.pi))
        elif name in FUNCTIONS and name not in names:
            parts.append(f'FUNCTIONS[{name!r}]')
        elif name:
            parts.append(f'({float(names[name])!r})')
        else:
            parts.append('**' if sign == '^' else sign)
        ends = bool(number or sign == ')' or (name and not parts[-1].startswith('FUNCTIONS')))
    return eval(''.join(parts), {'FUNCTIONS': FUNCTIONS, '__builtins__': {}})


def off(written, names, expected, tolerance):
    """What of the page's formulas is not what is expected, or nothing."""
    if len(written) != len(expected):
        return f'{len(written)} formulas, {len(expected)} expected'
    of_each = names if isinstance(names, list) else len(written) * [names]
    ours = [value(text, of) for text, of in zip(written, of_each)]
    return '; '.join(f'{text} is {one:.9g}, by the library {other:.9g}' for text, one, other in zip(written, ours, expected)
                     if abs(one - other) > tolerance * abs(other))


# What the formulas of a page have in them, and what the library says of the same

PAIR = """&case tasks = {tasks} / &pair module_mm = 3 face_width_mm = 20 / &pinion teeth = 21 profile_shift = {shift} / &gear teeth = 34 /
&load torque_nm = 100 / &relief amount_um = {relief} / &mesh model = 'weber' / &dynamics friction = {friction} / {more}"""


@functools.cache
def _run(tasks, shift=0, relief=0, friction=0, more=''):
    return _of(PAIR.format(tasks=tasks, shift=shift, relief=relief, friction=friction, more=more))


def _of(text):
    with warnings.catch_warnings():
        warnings.simplefilter('ignore', gearsweep.UnusedWarning)   # not every task has a use for all of it
        return gearsweep.run(gearsweep.Case(text))


def friction_factors():
    """Of the pinion in approach and in recess, where one pair carries: its torque over that without friction."""
    mu = 0.1
    study = _run("'load', 'mesh', 'geometry'", friction=mu, more='&sweep load_rpm = 5 load_torque = .true. /')
    torque, mesh = study.torque, study.mesh
    places = {point: float(study.contact_points.at(point=point).s) for point in 'BPD'}
    names, expected = [], []
    for tau in ((places['B'] + places['P']) / 2, (places['P'] + places['D']) / 2):
        at = abs(torque.tau - tau).argmin()
        parts = [float(torque[name].ravel()[at]) for name in ('pinion_torque_nm', 'pinion_friction_nm', 'pinion_damping_nm')]
        names.append({'mu': mu, 'rho': float(np.interp(torque.tau[at], mesh.s, mesh.pinion_curvature_mm)), 'r_b': study.gears.base_diameter_mm[0] / 2})
        expected.append((parts[0] - parts[2]) / (parts[0] - parts[1] - parts[2]))
    return names, expected


def _rated(relief=5, rpm=3000, more=''):
    more = (f"&rating rpm = {rpm} material = '16MnCr5' accuracy_grade = 5 face_load_factor = 1.1 transverse_load_factor = 1.05 "
            f'life_h = 1000 {more} /')
    study = _run("'rating', 'geometry'", relief=relief, more=more)
    table = study.rating_factors
    return study, {
        'Z_H': table.zone_factor[0], 'Z_E': table.elasticity_factor_sqrt_mpa[0], 'Z_eps': table.contact_ratio_factor[0],
        'Z_B': table.single_pair_factor[0], 'F_t': table.tangential_load_n[0], 'd1': study.gears.reference_diameter_mm[0], 'b': 20, 'm': 3,
        'u': 34 / 21, 'z1': 21, 'K_A': 1, 'K_H_beta': 1.1, 'K_H_alpha': 1.05, 'K_F_alpha': 1.05, 'K_F_beta': table.root_face_load_factor[0],
        'K_v': study.rating.internal_dynamic_factor.ravel()[0], 'Y_F': table.form_factor[0], 'Y_S': table.stress_correction[0],
        'Y_B': table.rim_factor[0], 'Y_DT': table.deep_tooth_factor[0], 'sigma_H0': table.nominal_contact_mpa[0], 'sigma_F0': table.nominal_root_mpa[0],
        'sigma_HG': table.contact_limit_mpa[0], 'sigma_FG': table.root_limit_mpa[0], 'sigma_Hlim': table.contact_number_mpa[0],
        'sigma_Flim': table.root_number_mpa[0], 'sigma_H': study.rating.contact_stress_mpa.ravel()[0], 'sigma_F': study.rating.root_stress_mpa.ravel()[0],
        "c'": table.single_stiffness_n_mm_um[0], 'c_gamma_alpha': table.mesh_stiffness_n_mm_um[0], 'm_red': table.reduced_mass_kg_mm[0],
        'n_E1': table.resonance_rpm[0], 'n1': rpm, 'f_pb': table.pitch_deviation_um[0], 'f_f_alpha': table.profile_deviation_um[0], 'C_a': relief,
        'N_L': study.rating.load_cycles.ravel()[0], 'n': rpm, 'L_h': 1000}


def contact_stress():
    """Z_B by the radii of curvature at B and P: distances on the line of action from the base circles' tangent points."""
    study, names = _rated()
    base = study.gears.base_diameter_mm / 2
    line = np.sqrt(float(study.geometry.centre_distance_mm)**2 - base.sum()**2)
    for point in 'PB':
        own = np.sqrt(float(study.contact_points.at(point=point).pinion_radius_mm)**2 - base[0]**2)
        names |= {f'rho_1{point}': own, f'rho_2{point}': line - own}
    return names, [names['sigma_H0'], names['sigma_H'], names['Z_B'], study.rating.contact_safety.ravel()[0]]


def root_stress():
    study, names = _rated()
    return names, [names['sigma_F0'], names['sigma_F'], study.rating.root_safety.ravel()[0]]


def resonance_speed():
    study, names = _rated()
    return names, [study.dynamic_factors.resonance_ratio.ravel()[0], names['n_E1']]


def allowed_stress():
    """The numbers of the material give the limits, and Y_ST is 2."""
    _, names = _rated()
    return names, [names['sigma_HG'], names['sigma_FG'] * names.setdefault('Y_ST', 2) / 2, names['sigma_FG'] / names['sigma_Flim']]


def load_cycles():
    _, names = _rated()
    return names, [names['N_L']]


def mean_stress():
    """Goodman, Gerber, Soderberg: the equivalent amplitude whose cycles on the curve make the damage that the library says."""
    strength, knee, first = {'goodman': 'tensile_strength_mpa = 900', 'gerber': 'tensile_strength_mpa = 900', 'soderberg': 'yield_strength_mpa = 700'}, (1e6, 86.0), (1e3, 500.0)
    names, expected = [], []
    for rule, of in strength.items():
        more = (f"&life rpm = 3000 duration_h = 1 {of} curve_cycles = {first[0]}, {knee[0]} curve_stress_mpa = {first[1]}, {knee[1]} "
                f"dynamic_load = .false. mean_stress = '{rule}' stress_factor = 1.5 /")
        life = _run("'life'", more=more).life
        half = float(life.largest_root_stress_mpa.ravel()[0]) / 2    # from zero to the largest: amplitude and mean are alike
        cycles = 60 * 3000 / float(life.damage.ravel()[0])
        slope = math.log(first[1] / knee[1]) / math.log(knee[0] / first[0])
        names.append({'sigma_a': half, 'sigma_m': half, 'R_m': 900, 'R_e': 700})
        expected.append(knee[1] * (knee[0] / cycles)**slope)
    return names, expected


def _flank():
    """Names and library values at a place where one pair carries, behind the pitch point."""
    more = "&flank rpm = 3000 dynamic_load = .false. /"
    text = PAIR.format(tasks="'flank', 'mesh', 'geometry'", shift=0, relief=0, friction=0, more=more)
    study, case = _of(text), gearsweep.Case(text).complete()
    table, losses = study.flank, study.flank_losses
    at = int(abs(table.s - 0.9).argmin())
    points = {point: float(study.contact_points.at(point=point).s) for point in 'APE'}
    pitch = study.geometry.base_pitch_mm

    def of(column):
        values = table[column]
        return float(values.reshape(-1, len(table.s))[0, at]) if values.size >= len(table.s) else float(values[at])

    rho = [float(np.interp(table.s[at], study.mesh.s, study.mesh[f'{gear}_curvature_mm'])) for gear in ('pinion', 'gear')]
    at_pitch = [float(np.interp(points['P'], study.mesh.s, study.mesh[f'{gear}_curvature_mm'])) for gear in ('pinion', 'gear')]
    heat = math.sqrt(case.get('flank', 'conductivity_w_mk') * case.get('material', 'density_kgm3') * case.get('flank', 'specific_heat_j_kgk'))
    young, poisson = 1e9 * case.get('material', 'young_gpa'), case.get('material', 'poisson')
    modulus = young / (2 * (1 - poisson**2))
    radius = 1e-3 / (1 / rho[0] + 1 / rho[1])
    v = [of('pinion_rolling_m_s'), of('gear_rolling_m_s')]
    eta, alpha = 1e-3 * case.get('flank', 'viscosity_mpa_s'), 1e-9 * case.get('flank', 'pressure_viscosity_1_gpa')
    w = of('pair_load_n') / 0.02
    names = {'nu1': poisson, 'nu2': poisson, 'E1': young, 'E2': young, 'rho1': 1e-3 * rho[0], 'rho2': 1e-3 * rho[1], 'R': radius, 'E*': modulus, 'w': w,
             'a': 1e-6 * of('half_width_um'), 'p': 1e6 * of('pressure_mpa'), 'g': (math.sqrt(5) - 1) / 2, 'mu': losses.friction_coefficient.ravel()[0],
             'v1': v[0], 'v2': v[1], 'B1': heat, 'B2': heat, "E'": 2 * modulus, 'U': eta * sum(v) / 2 / (2 * modulus * radius), 'u': sum(v) / 2, 'eta': eta,
             'alpha': alpha, 'G': alpha * 2 * modulus, 'W': w / (2 * modulus * radius), 'z1': 21, 'z2': 34,
             'eps': points['E'] - points['A'], 'eps1': points['E'] - points['P'], 'eps2': points['P'] - points['A']}
    mean = {'w': study.motion.load_n / 20, 'v': 2 * 2 * math.pi * 50 * 1e-3 * at_pitch[0], 'R': 1 / (1 / at_pitch[0] + 1 / at_pitch[1]),
            'eta': 1e3 * eta, 'Ra': losses.roughness_um.ravel()[0], 'X_L': losses.oil_factor.ravel()[0]}
    return names, of, losses, mean, (radius, modulus, pitch)


def hertz():
    names, of, *_, (radius, modulus, _) = _flank()
    return names, [1 / radius, 1 / modulus, names['a'], names['p'], 1e6 * of('shear_stress_mpa'), 1e6 * of('shear_stress_mpa'), 1e-6 * of('shear_depth_um'),
                   1e-6 * of('shear_depth_um'), names['g']]


def flash():
    names, of, *_ = _flank()
    return names, [of('flash_temperature_k')]


def film():
    names, of, *_ = _flank()
    return names, [1e-6 * of('film_thickness_um'), names['U'], names['G'], names['W'], names["E'"]]


def friction_coefficient():
    _, _, losses, mean, _ = _flank()
    return mean, [losses.friction_coefficient.ravel()[0]]


def loss_factors():
    names, _, losses, *_ = _flank()
    return names, [losses.loss_factor_half_shares.ravel()[0], losses.loss_factor_even_load.ravel()[0]]


def half_shares():
    names, expected = loss_factors()
    return names, expected[:1]


def even_load():
    names, expected = loss_factors()
    return names, expected[1:]


def mises():
    """Along a free surface in plane strain: the square of von Mises over that of the stress, the principal stresses being 1, nu and 0."""
    nu = 0.3
    return {'nu': nu}, [((1 - nu)**2 + nu**2 + 1) / 2]


def vibration():
    """Method B below and in resonance and above: with what ISO 6336-1 has for C_v1 to C_v7 at a contact ratio of 1.62."""
    curves = {'C_v1': 0.32, 'C_v2': 0.34, 'C_v3': 0.23, 'C_v4': 0.9, 'C_v5': 0.47, 'C_v6': 0.47, 'C_v7': 0.125 * math.sin(math.pi * (1.62485 - 2)) + 0.875}
    names, expected = 3 * [None], []
    for rpm in (3000, 19500, 32000):
        study, of = _rated(relief=5, rpm=rpm, more='running_in = 0')
        load = of['F_t'] * of['K_A'] / of['b']
        of |= curves | {'N': study.dynamic_factors.resonance_ratio.ravel()[0], 'B_p': of["c'"] * of['f_pb'] / load, 'B_f': of["c'"] * of['f_f_alpha'] / load,
                        'B_k': abs(1 - of["c'"] * of['C_a'] / load)}
        names.append(of)
        expected.append(study.dynamic_factors.dynamic_factor_b.ravel()[0])
    names[:3] = 3 * [of]
    return names, [of['B_p'], of['B_f'], of['B_k'], *expected]


def vibration_below():
    names, expected = vibration()
    return names[:5], expected[:5]


def vibration_above():
    names, expected = vibration()
    return names[5:], expected[5:]


def campbell():
    table = _of(PAIR.format(tasks="'harmonic'", shift=0, relief=0, friction=0, more='').replace("&mesh model = 'weber' /", '')
                + '&harmonic frequency_hz = 1000 / &section elements_across = 4 teeth = 1 /').campbell
    found = [(f, k, rpm) for system, f, k, rpm in zip(table.system, table.frequency_hz, table.harmonic, table.rpm) if k > 1]
    return {'f': found[0][0], 'k': found[0][1], 'z': 21}, [found[0][2]]


@functools.cache
def _deep(addendum):
    study = _of(PAIR.format(tasks="'rating', 'geometry'", shift=0, relief=0, friction=0, more='&rating rpm = 1000 accuracy_grade = 4 contact_limit_mpa = 1500 root_limit_mpa = 800 /')
                .replace('profile_shift = 0', f'addendum = {addendum} dedendum = 1.7 rack_tip_radius = 0.1').replace('teeth = 21', 'teeth = 70').replace('teeth = 34', f'teeth = 70 addendum = {addendum} dedendum = 1.7 rack_tip_radius = 0.1'))
    return study.geometry.contact_ratio, study.rating_factors.deep_tooth_factor[0]


def deep_tooth_factor():
    """Just where it begins, between, twice, and beyond."""
    usual, deep, deeper = _deep(1.05), _deep(1.2), _deep(1.45)
    if not usual[0] < 2.05 < deep[0] < 2.5 < deeper[0]:
        raise ValueError(f'contact ratios {usual}, {deep}, {deeper}')
    return [{}, {'eps_alpha': deep[0]}, {}], [usual[1], deep[1], deeper[1]]


def deep_begin():
    return _part(deep_tooth_factor(), 0)


def deep_middle():
    return _part(deep_tooth_factor(), 1)


def deep_beyond():
    return _part(deep_tooth_factor(), 2)


def _part(all_of, at):
    names, expected = all_of
    return [names[at]], [expected[at]]


def root_radius():
    study = _run("'geometry'", shift=0.3)
    return {'m': 3, 'z': 21, 'x': 0.3}, [study.gears.root_diameter_mm[0] / 2]


def root_and_base_radius():
    study = _run("'geometry'", shift=0.3)
    names = {'m': 3, 'z': 21, 'x': 0.3, 'alpha': math.radians(20)}
    return names, [study.gears.root_diameter_mm[0] / 2, study.gears.base_diameter_mm[0] / 2]


def sharing():
    """Law of two pairs behind one compliance C: stiffness and touching deflection of the first, by the linear system at two deflections."""
    stiffness, error, common = np.array([3.0, 2.0]), np.array([0.4, 0.3]), 0.07
    matrix = np.eye(2) + stiffness[:, None] * np.array([[0, common], [common, 0]])
    low, high = (np.linalg.solve(matrix, stiffness * (x - error))[0] for x in (1.0, 2.0))
    slope = high - low
    names = {'K_1': stiffness[0], 'K_2': stiffness[1], 'C': common, 'e_1': error[0], 'e_2': error[1]}
    return names, [slope, 1 - low / slope]


def wave_product():
    names = {'k': 2, 'z': 21, 'n': 3, 'p': 0.4}
    return names, [math.cos(2 * 21 * 0.4) * math.cos(3 * 0.4)]


def generating_shift():
    study = gearsweep.run(gearsweep.Case("&case tasks = 'geometry' / &pair module_mm = 3 face_width_mm = 20 / &gear teeth = 34 / "
                                         '&pinion teeth = 21 profile_shift = 0.2 thickness_allowance_um = -60 /'))
    return {'x': 0.2, 'A_s': -0.06, 'm': 3, 'alpha': math.radians(20)}, [study.gears.generating_shift[0]]


def formula_relief():
    """Bending and flattening of the pinion's tooth by the formula, um: each by the lines before it on the page."""
    study = _of(PAIR.format(tasks="'deflection_relief', 'geometry'", shift=0.2, relief=0, friction=0, more='&sweep rpm_first = 5000 rpm_last = 6000 rpm_step = 1000 /'))
    table, gears = study.relief_deflection, study.gears
    torque = 100e3 / (gears.base_diameter_mm[0] / 2)
    radius, base, root = table.load_diameter_mm[0] / 2, gears.base_diameter_mm[0] / 2, gears.root_diameter_mm[0] / 2
    names = {'F': torque, 'b': 20, 'nu': 0.3, 'E': 206e3, 'x': 0.2, 'z': 21, 'm': 3, 'b_H': 1e-3 * table.half_width_um[0], 'alpha': math.radians(20),
             'rho': math.sqrt(radius**2 - base**2), 'r_b': base, 'r_f': root, 'r_p': radius, 'y_p': table.load_height_mm[0]}
    bending, flattening = 1e-3 * table.bending_um[0], 1e-3 * table.flattening_um[0]
    names['phi'] = (math.pi + 4 * names['x'] * math.tan(names['alpha'])) / (2 * names['z']) + math.tan(names['alpha']) - names['alpha']
    names['alpha_b'], names['omega_b'] = math.atan(names['rho'] / base), names['rho'] / base - names['phi']
    # A to D of the page, which the bending of the library holds together.
    names |= dict(zip('ABCD', (-1.05 + 153 * math.exp(-8.1 * 0.2) * 21**-(1.75 - 1.6 * 0.2), 0.63 + (7.35 - 0.924 * 0.2) / 21,
                               1.28 - (2.88 + 3.68 * 0.2) / 21, -1.06 + 0.638 * math.log(63))))
    names |= {'delta_b': bending, 'delta_H': flattening}
    return names, [bending, *(names[one] for one in 'ABCD'), flattening, names['y_p'], math.tan(names['alpha_b']), names['omega_b'], names['phi'],
                   1e-3 * study.deflection_relief.pinion_relief_um[1]]


def annulus_twist():
    """Turning of a disc of case 1 on a bore of 5 mm under its load, per unit of it, mm/N: both gears are alike."""
    disc = cases.case('case1').changed(section={'teeth': 25, 'fixed': 'rim'}, pinion={'bore_mm': 5}, gear={'bore_mm': 5},
                                            relief={'amount_um': 0}, mesh={'tooth_coupling': True})
    motion = gearsweep.run(disc, 'mesh').motion
    module, width = (cases.given('case1', 'pair', key) for key in ('module_mm', 'face_width_mm'))
    base = 12.5 * module * math.cos(math.radians(20))
    return ({'r_b': base, 'G': 206e3 / 2.6, 'b': width, 'r_i': 2.5, 'r_o': 12.5 * module},
            [1e-3 * motion.body_rotation_um / (2 * motion.load_n)])


def dependent_modulus():
    names, expected = hertz()
    return names, expected[1:2]


def square_eigenvalues():
    """The multipliers of a map with this trace and determinant, put into their equation: 0."""
    trace, determinant = 1.7, 0.6
    root = np.linalg.eigvals([[0, 1], [-determinant, trace]])[0]
    return {'mu': root.real, 'S': trace, 'D': determinant, 'i': root.imag}, [root.imag**2]


def mean_modulus():
    """That the standard's formula for the stiffness takes for two materials: the stiffness of a pair is in proportion to it."""
    def stiffness(*young):
        keys = "&rating rpm = 3000 accuracy_grade = 5 contact_limit_mpa = 1500 root_limit_mpa = 800 / &pinion young_gpa = {} / &gear young_gpa = {} /"
        text = PAIR.format(tasks="'rating'", shift=0, relief=0, friction=0, more='').replace('profile_shift = 0', f'young_gpa = {young[0]}').replace(
            'teeth = 34', f'teeth = 34 young_gpa = {young[1]}')
        del keys
        return _of(text + '&rating rpm = 3000 accuracy_grade = 5 contact_limit_mpa = 1500 root_limit_mpa = 800 /').rating_factors.single_stiffness_n_mm_um[0]

    return {'E1': 206, 'E2': 121}, [206 * stiffness(206, 121) / stiffness(206, 206)]
