"""What doc/ says in numbers, computed anew for claims.csv."""

import functools
import math
import re

import numpy as np

import gearsweep

from . import choices, dogan2021, hassan2009, ledger, life_factors, quantities, thamba2020
from .cases import ANGLES, case, given, result, run

ACROSS = 32  # the finest grid of doc/elastic.md
PLACES = (0, 0.29, 0.81)  # where it compares grids, base pitches from A
REFERENCE = ledger.FOLDER.parent / 'test' / 'reference'


# Finite elements

def stiffness_on(across):
    """Pair stiffness of case 1 at A, s = 0.29 and 0.81, N/um, with so many elements across a tooth."""
    s, stiffness = _stiffness(across)
    return list(np.interp(PLACES, s, stiffness))


def stiffest():
    """Path coordinate where a pair of case 1 is stiffest, base pitches."""
    s, stiffness = _stiffness(ACROSS)
    return s[np.argmax(stiffness)]


def stiffness_change(across):
    """Largest difference along the path from the finest grid, per cent."""
    s, stiffness = _stiffness(across)
    fine = np.interp(s, *_stiffness(ACROSS))
    return 100 * np.abs(stiffness / fine - 1).max()


def hassan_on(across):
    """Hassan's section: elements, first frequency and its estimate in per cent, tension, compression, their estimate."""
    study = _hassan(across)
    modal, stress = study.modal, study.root_stress
    return [study.elements.rows, modal.frequency_hz[0], 100 * modal.error_estimate[0], stress.tension_mpa[0],
            stress.compression_mpa[0], 100 * stress.error_estimate[0]]


def hassan_row(across):
    """The same with the true error of the frequency behind its estimate."""
    row = hassan_on(across)
    return [*row[:3], hassan_error(across), *row[3:]]


def hassan_error(across):
    """True error of its first frequency against the finest grid, per cent."""
    return 100 * abs(_hassan(across).modal.frequency_hz[0] / _hassan(ACROSS).modal.frequency_hz[0] - 1)


def stress_moves(across):
    """How far its largest tension or compression lies from the finest grid's at most, from this grid on, per cent."""
    grids = [n for n in (4, 6, 8, 12, 16, 24) if n >= across]
    fine = _hassan(ACROSS).root_stress
    return max(100 * abs(_hassan(n).root_stress[side][0] / fine[side][0] - 1)
               for n in grids for side in ('tension_mpa', 'compression_mpa'))


def support(teeth, fixed='sides+rim', plane='strain'):
    """Mean stiffness of the case 1 pair by its width, N/(um mm), and peak-to-peak static transmission error, um: each pair
    alone, and with what neighbours share."""
    section = {'teeth': teeth, 'plane': plane, 'fixed': tuple(fixed.split('+'))}
    alone, shared = (_motion_and_error(case('case1').changed(section=section, relief={'amount_um': 0},
                                                             mesh={'tooth_coupling': coupled}))[:2] for coupled in (False, True))
    return [*alone, shared[1]]


def root_stress(teeth):
    """Largest root tension of case 1 with so many teeth on the body, MPa."""
    section = {'teeth': teeth, 'elements_across': 16}
    return run(case('case1').changed(section=section, relief={'amount_um': 0}), 'static').root_stress.tension_mpa[0]


def iso_stress():
    return result('root_rating', 'case1').iso_mpa


def disc(bore):
    """Case 1 with whole gears on this bore: turning, shared, um; stiffness in the motion and static mean, N/(um mm);
    peak-to-peak static transmission error, um; largest dynamic factor of the sweep."""
    whole = case('case1').changed(section={'teeth': 25, 'fixed': 'rim'}, pinion={'bore_mm': bore}, gear={'bore_mm': bore},
                                  relief={'amount_um': 0}, mesh={'tooth_coupling': True})
    stiffness, error, motion, mesh = _motion_and_error(whole)
    static = np.interp(np.linspace(0, 1, 4001)[:-1], mesh.s, mesh.mesh_stiffness_n_um)
    width = given('case1', 'pair', 'face_width_mm')
    worst = run(whole, 'sweep').sweep.dynamic_factor.max()
    return [motion.body_rotation_um, motion.body_coupling_um, stiffness, static.mean() / width, error, worst]


def jump_ends():
    """Ends of motions in jumps.dat, folds and doublings among them."""
    kinds = [row[7] for row in _rows('jumps')]
    return [len(kinds), kinds.count(1), kinds.count(-1)]


def chaos_rows():
    """Motions in chaos.dat whose exponent is above 0, below it, and how many standard errors the test allows."""
    exponents = [row[2] for row in _rows('chaos')]
    test = (REFERENCE.parent / 'unit/nonlinear/test_branches.f90').read_text(encoding='utf-8')
    return [sum(one > 0 for one in exponents), sum(one < 0 for one in exponents), float(re.search(r'absolute=([\d.]+)\*deviation', test)[1])]


def _rows(name):
    lines = (REFERENCE / f'{name}.dat').read_text(encoding='utf-8').splitlines()
    return [tuple(map(float, line.split())) for line in lines if line[0] != '#']


def corner_part():
    """One over the part by which a corner is softer under a small load than the secant."""
    mesh = (REFERENCE.parents[1] / 'src/mesh/mesh.f90').read_text(encoding='utf-8')
    return 1 / float(re.search(r' corner_uncertainty = ([\d.]+)_dp', mesh)[1])


def most_body_tenths():
    """Tenths of the root radius to which the body of a gear without a bore reaches at most."""
    section = (REFERENCE.parents[1] / 'src/elastic/section.f90').read_text(encoding='utf-8')
    return 10 * (1 - 1 / float(re.search(r'gear%tip_radius - gear%root_radius\), gear%root_radius/(\d+)\)', section)[1]))


def hub(bore, ratio):
    """Case 1 with whole gears on this bore, mm, and this inertia there over that of the gear: how many per cent a natural
    frequency lies above that of finite elements with a hub: all inertia in one body, the motion's, the chain's."""
    lines = (REFERENCE / 'hub.dat').read_text(encoding='utf-8').splitlines()
    rows = [tuple(map(float, line.split())) for line in lines if line[0] != '#']
    mass, whole, rigid = next((row[2], row[4], row[5]) for row in rows if (2 * row[0], row[3]) == (bore, ratio))
    mass *= given('case1', 'pair', 'face_width_mm')
    base = 0.5e-3 * given('case1', 'pinion', 'teeth') * given('case1', 'pair', 'module_mm') * np.cos(np.radians(20))
    body = {'bore_mm': bore, 'effective_mass_kg': mass}
    plain, with_hub = (run(case('case1').changed(section={'teeth': 25, 'fixed': 'rim'}, pinion=body | added, gear=body | added,
                                                 relief={'amount_um': 0}, mesh={'tooth_coupling': True}), 'mesh').motion
                       for added in ({}, {'hub_inertia_kgm2': ratio * mass * base**2}))
    alone = plain.natural_frequency_hz / np.sqrt(1 + ratio)
    ours = [alone, with_hub.natural_frequency_hz, with_hub.chain_frequency_hz if ratio else alone]
    return [100 * (hertz / alone * rigid / whole - 1) for hertz in ours]


def corner(relief):
    """Case 1 from A to E, with corner contact, and by default, each with this relief: peak-to-peak static transmission error, um, of
    all three, then their worst dynamic factors."""
    keys = ({}, {'corner_contact': True}, {'corner_contact': True, 'tooth_coupling': True, 'nonlinear_contact': True})
    errors, factors = [], []
    for mesh in keys:
        study = run(case('case1').changed(mesh=mesh), ('mesh', 'sweep'))
        at = list(study.transmission_error.relief_um).index(relief)
        errors.append(study.transmission_error.peak_to_peak_um[at])
        factors.append(study.sweep.dynamic_factor[at].max())
    return [*errors, *factors]


def own_load():
    """How much more the transmission error of case 1 varies with flanks that flatten by the nominal load, per cent."""
    mesh = {'corner_contact': True, 'tooth_coupling': True}
    nominal, own = (np.ptp(run(case('case1').changed(mesh={**mesh, 'nonlinear_contact': on}, relief={'amount_um': 0}),
                               'mesh').mesh.ste_um) for on in (False, True))
    return 100 * (nominal / own - 1)


def edge_flattening():
    """How many times as fast as Hertz has it the compliance of a pair of case 1 falls with the logarithm of its load: at A where
    the path ends at an edge, and as far beyond as a smaller load is looked for."""
    part = 0.3
    loads = [{'line_load_n_mm': 276 * factor} for factor in (1, part)]
    meshes = [run(case('case1').changed(mesh={'corner_contact': True}, relief={'amount_um': 0}, load=load), 'mesh').mesh
              for load in loads]
    hertz = 2e6 * (1 - 0.3**2) / (np.pi * 206e9) / 0.0254
    farthest = meshes[1].s[0]
    whole, small = (np.interp([0, farthest], mesh.s[mesh.s <= 0], mesh.pair_stiffness_n_um[mesh.s <= 0]) for mesh in meshes)
    return list((1 / small - 1 / whole) / -np.log(part) / hertz)


def edge_softer():
    """How much softer a pair of case 1 is 0.05 base pitches before A than at A without an edge, per cent."""
    meshes = [run(case('case1').changed(mesh={'corner_contact': on}, relief={'amount_um': 0}), 'mesh').mesh for on in (False, True)]
    plain, edge = (np.interp(s, mesh.s, mesh.pair_stiffness_n_um) for s, mesh in zip((0, -0.05), meshes, strict=True))
    return 100 * (1 - edge / plain)


def _motion_and_error(of_case):
    study = run(of_case, 'mesh')
    return study.motion.mean_mesh_stiffness_n_um_mm, np.ptp(study.mesh.ste_um), study.motion, study.mesh


def tilted_relief():
    """By how much less the gap of case 1 is where its relieved flank touches at E than on the line of action, um; the relief."""
    amount = 15.0
    study = run(case('case1').changed(relief={'amount_um': amount}), 'mesh')
    mesh, points = study.mesh, study.contact_points
    pinion, gear = mesh.pinion_curvature_mm[-1], mesh.gear_curvature_mm[-1]
    base = np.sqrt(mesh.pinion_radius_mm[-1]**2 - pinion**2)
    length = np.interp(points.s[points.point == 'E'] - 1, mesh.s, mesh.path_mm)[0]   # of the relieved path, D to E
    slope = 1e-3 * amount / (length * pinion / base)
    return 1e3 * slope**2 / (2 * (1 / pinion + 1 / gear)), amount


@functools.cache
def _stiffness(across):
    mesh = run(case('case1').changed(section={'elements_across': across}, relief={'amount_um': 0}), 'mesh').mesh
    return mesh.s, mesh.pair_stiffness_n_um


@functools.cache
def _hassan(across):
    return run(case('hassan').changed(section={'elements_across': across}), ('static', 'modal'))


# What README.md and doc/accuracy.md take from bench/measured

def sweep_ms():
    """Points of the sweep of case 1, and its time within the error, in ms: as released, built for the processor."""
    released, native = _row(r'gearsweep \| 1'), _row('gearsweep, native build')
    rpm, relief = (case('case1').get(*key) for key in (('sweep', 'rpm_step'), ('relief', 'amount_um')))
    speeds = (given('case1', 'sweep', 'rpm_last') - given('case1', 'sweep', 'rpm_first')) // rpm + 1
    return [speeds * len(relief), 1000 * released[4], 1000 * native[4]]


def ten_modes():
    """Unknowns and seconds of the last grid, and how many times as long the peers take."""
    text = _measured('elastic').partition('**Ten modes on the same grid.**')[2].partition('\n**')[0]
    last = re.findall(r'^\| (\d+) \| \d+ \| gearsweep \|.*?\| ([\d.]+) \|  \|  \|\n((?:\|  \|.*\n){3})', text, flags=re.MULTILINE)[-1]
    peers = [float(line.split('|')[-3]) for line in last[2].splitlines()]
    return [float(last[0]), float(last[1]), *peers]


def _measured(name):
    return (REFERENCE.parents[1] / 'bench' / 'measured' / f'{name}.md').read_text(encoding='utf-8')


def _row(begin):
    """The first row of a table that begins so, as numbers where it has them."""
    cells = re.search(rf'^\| {begin}.*$', _measured('dynamics'), flags=re.MULTILINE)[0].strip('|').split('|')
    return [float(cell) if re.fullmatch(r'[\d.e+-]+', cell.strip()) else cell for cell in map(str.strip, cells)]


# Tests and their references

def motions():
    """Reference motions of test/reference: all, those with all pairs in contact, the others."""
    loss = []
    for name in ('constant_stiffness', 'constant_stiffness_contact_loss', 'smooth_stiffness'):
        lines = (REFERENCE / f'{name}.dat').read_text(encoding='utf-8').splitlines()
        header = next(line for line in lines if line.startswith('# id z1')).lstrip('# ').split()
        loss += [int(line.split()[header.index('loss')]) for line in lines if line.strip() and line[0] != '#']
    return [len(loss), loss.count(0), len(loss) - loss.count(0)]


def prescribed():
    """The prescribed mesh of test/properties/extreme: mean stiffness, N/um, natural frequency, Hz, and its speed, 1/min."""
    motion = run(gearsweep.Case(_prescribed()), 'mesh').motion
    return [motion.mean_mesh_stiffness_n_um, motion.natural_frequency_hz, motion.resonance_rpm]


# Printed numbers, and what the reasons in the ledger say of them

def printed_of(paper, id):
    """The printed number of a row."""
    return ledger.find(paper, id).value


def corrected_um():
    """Thamba's relief by the formulas as corrected, and, next, what one pair yields at D, um."""
    return 1e3 * thamba2020.corrected_relief()


def relief_um():
    return 1e3 * thamba2020.relief_for_load()


def disc_over_printed():
    """Our deflection of Thamba's disc over the printed one, per cent more."""
    return 100 * (thamba2020.disc_deflection() / printed_of('thamba2020', 'deformation_involute_pitch') - 1)


def signed_alpha():
    """Hassan's alpha with its sign, by frequencies in Hz."""
    return -hassan2009.rayleigh_alpha()


def printed_falls():
    """Least and largest fall of a dynamic factor that Dogan et al. print with and without relief, per cent."""
    pairs = (('df_1', 'df_15'), ('df1_1', 'df1_15'), ('df2_1', 'df2_15'), ('df1_2', 'df1_28'))
    falls = [100 * (1 - printed_of('dogan2021', with_relief) / printed_of('dogan2021', without)) for without, with_relief in pairs]
    return [min(falls), max(falls)]


def resonances_above():
    """By how many per cent the printed resonances of case 1 lie above ours: the least, the most."""
    above = [100 * (printed_of('dogan2021', f'n{k}_1') / dogan2021.peak_rpm('case1', k) - 1) for k in (1, 2)]
    return [min(above), max(above)]


def papers():
    """Of the ledger."""
    return len(ledger.PAPERS)


def agreement(sort):
    """Of doc/validation.md: results of this sort within their tolerances, and all results of it."""
    text = (REFERENCE.parents[1] / 'doc' / 'validation.md').read_text(encoding='utf-8')
    results, stated, inferred = map(int, re.search(rf'^\| {sort.replace("_", " ")} \| (\d+) \| (\d+) \| (\d+) \|', text, re.MULTILINE).groups())
    return [stated + inferred, results]


def one_range(of, first, last):
    """Least and largest of a function of Hassan's load steps."""
    values = [getattr(hassan2009, of)(k) for k in range(first, last + 1)]
    return [min(values), max(values)]


# Dynamics

def poisson_high():
    """By how much the first mode of the row "Poisson 0.4999, plane strain" of test/properties/extreme/table.md lies off, per cent."""
    text = (REFERENCE.parent / 'properties/extreme' / 'table.md').read_text(encoding='utf-8')
    return 100 * float(re.search(r'\| Poisson 0\.4999, plane strain \|.*\| (\S+) \| elements \|', text)[1])


def _prescribed():
    return (REFERENCE.parent / 'properties/extreme' / 'prescribed.nml').read_text(encoding='utf-8')


def thermal_contact():
    """Thermal contact coefficient that the defaults of &flank and &material make, N/(mm s^0.5 K)."""
    complete = case('fzg_c40').changed(flank={'conductivity_w_mk': None, 'specific_heat_j_kgk': None},
                                             material={'density_kgm3': None}).complete()  # fmt: skip
    heat = [complete.get('flank', key) for key in ('conductivity_w_mk', 'specific_heat_j_kgk')]
    return (heat[0] * heat[1] * complete.get('material', 'density_kgm3'))**0.5 / 1000


# Rating, choices, codes

def material_row(material):
    """Hardness of its surface, sigma_Hlim and sigma_Flim of the grades ml, mq and me, MPa."""
    source = (REFERENCE.parents[1] / 'src/rating/gear_materials.f90').read_text(encoding='utf-8')
    hardness = float(re.search(rf"gear_material_t\('{material}', (\d+)", source)[1])
    tables = [run(case('case1').changed(mesh={'model': 'weber'}, section=dict.fromkeys(case('case1').values['section']), relief={'amount_um': 0},
                                        rating={'rpm': 1000, 'material': material, 'material_grade': grade}), 'rating').rating_factors
              for grade in ('ml', 'mq', 'me')]
    return [hardness, *(table.contact_number_mpa[0] for table in tables), *(table.root_number_mpa[0] for table in tables)]


def rack_row(profile):
    """Addendum, dedendum and tip radius of a rack as the tables of doc/choices.md are computed with it."""
    return list(choices.RACKS[profile])


def code(name):
    """An exit code by its name in the Python package."""
    return int(gearsweep.Code[name])


def parts_of(tree, words):
    """How many public calls the C header declares, or other things that can be counted."""
    text = (REFERENCE.parents[1] / tree).read_text(encoding='utf-8')
    return len(re.findall(words, text, flags=re.MULTILINE))


def singular_power(angle, clamped_free=False, poisson=0.3):
    """The least power of the distance to which displacements go at a corner of this angle, deg, in plane strain (Williams 1952): free on both
    sides, or held on one and free on the other."""
    alpha = np.radians(angle)
    kappa = 3 - 4 * poisson

    def residual(power):
        if clamped_free:
            return np.sin(power * alpha)**2 - ((kappa + 1)**2 / (4 * kappa) - power**2 * np.sin(alpha)**2 / kappa)
        return np.sin(power * alpha)**2 - (power * np.sin(alpha))**2

    powers = np.linspace(0.3, 0.99, 6901)
    values = residual(powers)
    return powers[np.flatnonzero(values[:-1] * values[1:] < 0)[0]]


def whole_source(path, pattern):
    """A number of a file of the source, by the words around it with blanks as underscores."""
    text = (REFERENCE.parents[1] / path).read_text(encoding='utf-8')
    return float(re.findall(pattern, text)[0].replace('_dp', ''))


def normal_within(deviations):
    """Per cent of a normal distribution within so many standard deviations."""
    return 100 * math.erf(deviations / math.sqrt(2))


def runouts_within():
    """Per cent of the run-outs drawn that are within F_r: both parts of the eccentricity are normal."""
    return 100 * (1 - whole_source('src/mesh/flank_deviations.f90', r'sqrt\(-2\*log\((0\.\d+_dp)\)'))


def per_cent(path, pattern):
    return 100 * whole_source(path, pattern)


def one_over(path, pattern):
    return 1 / whole_source(path, pattern)


def bandwidths():
    """To either side of a mode in which its resonance is looked for."""
    path = 'src/elastic/modal_response.f90'
    return whole_source(path, r'scan = (\d+)') * whole_source(path, r'step = (0\.\d+)')


def twice_power(angle, held=''):
    """Order in which frequencies converge at a corner: twice the power of the displacements."""
    return 2 * singular_power(angle, held)


def most_gigabytes():
    return 1e-9 * whole_source('src/elastic/material.f90', r'most_memory = (\S+)_dp')


def stiffness_range():
    """That the library accepts, N/um."""
    path = 'src/mesh/stiffness.f90'
    return [1e-6 * whole_source(path, rf'{end} = (\S+_dp)') for end in ('softest', 'stiffest')]


def c_calls():
    """Functions that the C header declares."""
    return parts_of('include/gearsweep.h', r'^(?:int|void) gsc_\w+\(')


def deep_end():
    """Contact ratio at which the line of the deep tooth factor reaches its last value."""
    path = 'src/rating/form.f90'
    first, slope, last = (whole_source(path, pattern) for pattern in (r'([\d.]+)_dp - 0\.\d+_dp\*contact_ratio', r' - (0\.\d+)_dp\*contact_ratio', r'max\((0\.\d+)_dp, min'))
    return (first - last) / slope


def deep_teeth():
    """From which contact ratio, and up to which grade, teeth count as deep."""
    path = 'src/rating/form.f90'
    return [whole_source(path, r'contact_ratio > ([\d.]+)_dp .and. grade'), whole_source(path, r'coarsest = (\d)')]


def step_growth():
    """Exponents by which graded steps may grow and do: the sixth order of the method, and the one of the source."""
    order = whole_source('src/motion/gauss.f90', r'order = (\d)')
    return [order, whole_source('src/motion/resolution.f90', r'slower = 1/([\d.]+)_dp')]


def doubling_part():
    """What Richardson's extrapolation takes of the difference to half the steps, at the method's order, and what the source takes."""
    order = whole_source('src/motion/gauss.f90', r'order = (\d)')
    return [2**order - 1, whole_source('src/motion/error_estimate.f90', r'doubling_error = raise\*max\(peak, raise\*state/4\)/(\d+)')]


def order_of_method(name):
    """In which a test finds that a method of the literature converges: whole, between its bounds."""
    words = {'rk4': 'rk4: fourth order', 'rk4_equal': 'rk4_equal: first order', 'constant': 'constant: second order'}[name]
    text = (REFERENCE.parent / 'unit/motion/test_methods.f90').read_text(encoding='utf-8')
    least, largest = map(float, re.search(rf"'{words}', order\(\d\) > ([\d.]+)_dp .and. order\(\d\) < ([\d.]+)_dp", text).groups())
    return next(whole for whole in range(10) if least < whole < largest)


def orders_of_methods():
    """Of Runge and Kutta's method in full contact, and where a step meets a break."""
    return [order_of_method('rk4'), order_of_method('rk4_equal')]


def softer_places():
    """How much softer a pair with a corner is than without at A and where contact begins, per cent: as suite `elastic_corner` has it."""
    text = (REFERENCE.parent / 'unit/elastic/test_elastic_corner.f90').read_text(encoding='utf-8')
    return [100 * float(number) for number in re.findall(r"softer\(\d+\), (0\.\d+)_dp", text)]


def shorter_arm():
    """By how much the lever arm is less where contact begins, per cent, as suite `tip_corner` has it."""
    return 100 * (1 - whole_source('test/unit/gear/test_tip_corner.f90', r"'lever arm where contact begins', here%lever, (0\.\d+)_dp"))


def stability_steps():
    """Thousands and the rest of the most steps."""
    return divmod(2**int(whole_source('src/nonlinear/stability.f90', r'most_steps = 2\*\*(\d+)')), 1000)


def handle_bytes():
    bits = whole_source('src/api/flat_calls.f90', r'integer\(int(\d+)\), intent\(inout\) :: study')
    return bits / 8


def spare_megabytes():
    return 1e-3 * whole_source('test/cases/test_memory.sh', r'least=\$\(\(least \+ (2\d+)\)\)')


def blas_megabytes():
    return whole_source('src/base/gearsweep_memory.c', r'blas_buffer = (\d+)\*1024\.0\*1024')


def heap_megabytes():
    return whole_source('src/base/gearsweep_team.c', r'heap = (\d+)\*1024\.0\*1024')


def minor_versions():
    """That of the library, and the one from which on calls do not change: app/install.sh."""
    version = (REFERENCE.parents[1] / 'src/base/version.f90').read_text(encoding='utf-8')
    return [float(re.search(r"'(\d+\.\d+)\.\d+'", version)[1]), whole_source('app/install.sh', r'Before (\d+\.\d+) each minor')]


def slow_periods():
    """Thousands and the rest of the mesh periods of the slowest march in slow_sweeps.dat."""
    lines = (REFERENCE / 'slow_sweeps.dat').read_text(encoding='utf-8').splitlines()
    return divmod(max(int(line.split()[1]) for line in lines if line.startswith('0.')), 1000)


def delay_power():
    """Of the rate, with which the delay grows: 8 times the rate made it 4 times as long in suite `bifurcations`."""
    text = (REFERENCE.parent / 'unit/nonlinear/test_bifurcations.f90').read_text(encoding='utf-8')
    times = float(re.search(r"'(\d) times the speed', behind\(2\)/behind\(1\)", text)[1])
    return [round(3 * math.log(times) / math.log(8)), 3]


def natural_radians(rpm):
    """By which the natural motion of the prescribed mesh, with two pairs and with one, turns in a mesh period at so many 1/min."""
    get = gearsweep.Case(_prescribed()).get
    masses = [get(gear, 'effective_mass_kg') for gear in ('pinion', 'gear')]
    ratio, stiffness = get('mesh', 'contact_ratio'), 1e6 * get('mesh', 'coefficients')
    of_one, of_two = (math.sqrt(pairs * stiffness * sum(masses) / math.prod(masses)) for pairs in (1, 2))
    return 60 / (float(rpm) * get('pinion', 'teeth')) * ((2 - ratio) * of_one + (ratio - 1) * of_two)


def unbounded():
    """Static deflections that a motion passes where it has no bound, and the damping ratio below which it is the reciprocal of that."""
    ratio = whole_source('src/motion/periodic_orbit.f90', r'most = (1e-4)_dp +! damping ratios')
    return [1 / ratio, ratio]


def places_on_path():
    """Where the grids are compared, base pitches, and the finest of them."""
    return [*PLACES[1:], ACROSS]


def contact_ratio_apart(name):
    """Of a pair of the analysis apart, test/reference/load_distribution.dat, and how far we are off its transmission error, per cent."""
    text = (REFERENCE / 'load_distribution.dat').read_text(encoding='utf-8')
    ratio = next(float(line.split()[11]) for line in text.splitlines() if line.startswith(f'= {name} '))
    test = (REFERENCE.parents[1] / 'python/tests/mechanics/test_load_distribution.py').read_text(encoding='utf-8')
    return [ratio, 100 * float(re.search(rf"\(\('{name}',.*?set\(\), (0\.\d+),", test)[1])]


def most_arguments():
    """Of a procedure of the library, but for the reader's, ARPACK's, those that run a study and the calls of other languages."""
    most = 0
    for path in (REFERENCE.parents[1] / 'src').rglob('*.f90'):
        if path.parent.name in ('reader', 'api') or path.stem in ('arpack', 'study'):
            continue
        text = re.sub(r'&\s*\n\s*&?', '', path.read_text(encoding='utf-8'))
        for arguments in re.findall(r'(?im)^(?!\s*end)[^!\'"\n]*\b(?:subroutine|function)\s+\w+\s*\(([^)]*)\)', text):
            most = max(most, len([name for name in arguments.split(',') if name.strip()]))
    return most


def longest_file():
    """Lines of the longest file of src and app, to the next hundred."""
    lines = [path.read_text(encoding='utf-8').count('\n') for folder in ('src', 'app') for path in (REFERENCE.parents[1] / folder).rglob('*.f90')]
    return 100 * math.ceil(max(lines) / 100)


# Examples and interfaces

def reliefs_of(name):
    """How many reliefs a case lists."""
    return len(case(name).get('relief', 'amount_um'))


def _first():
    return gearsweep.Case.read(REFERENCE.parents[1] / 'examples' / 'first.nml')


def example_lines():
    """Lines of the case of examples, of the shortest and the longest program there, and how many languages they are in."""
    lengths = {path.suffix: path.read_text(encoding='utf-8').count('\n') for path in (REFERENCE.parents[1] / 'examples').glob('first.*')}
    case_lines = lengths.pop('.nml')
    return [case_lines, min(lengths.values()), max(lengths.values()), len(lengths)]


def example_languages():
    return example_lines()[-1]


def first_case():
    of = _first()
    keys = ('pair', 'module_mm'), ('pair', 'face_width_mm'), ('pinion', 'teeth'), ('gear', 'teeth'), ('load', 'torque_nm')
    return [*(of.get(*key) for key in keys), *of.get('relief', 'amount_um'), *(of.get('sweep', key) for key in ('rpm_first', 'rpm_last', 'rpm_step'))]


def first_reliefs():
    return len(_first().get('relief', 'amount_um'))


def first_worst():
    """What the examples print: relief, worst dynamic factor and its speed."""
    table = gearsweep.run(_first()).sweep_worst
    return [number for row in zip(table.relief_um, table.worst_dynamic_factor, table.rpm) for number in row]


def column_kinds():
    text = (REFERENCE.parents[1] / 'src/base/table.f90').read_text(encoding='utf-8')
    return list(re.search(r'kind_real = (\d), kind_integer = (\d), kind_text = (\d)', text).groups())


def first_row():
    """The number of the first row for gsc_text, as the callers of tools/callers begin their loops."""
    return whole_source('tools/callers/results.c', r'for \(row = (\d); word')


def asymmetric_pairs():
    return len(ANGLES)


def closing_damping():
    """Where the tongue of doc/nonlinear.md closes, as its lines of Python print it."""
    text = (REFERENCE.parents[1] / 'doc/nonlinear.md').read_text(encoding='utf-8')
    return float(re.search(r'\n(0\.0\d{3})\n', text)[1])


def bifurcation_reference():
    """Mesh periods and digits of tools/reference/make_bifurcations.py."""
    rows = [line.split() for line in (REFERENCE / 'bifurcations.dat').read_text(encoding='utf-8').splitlines() if line and line[0] not in '#=']
    periods = max(int(word) for row in rows for word in row if word in '1248')
    return [periods, whole_source('tools/reference/make_bifurcations.py', r'mpmath\.mp\.dps = (\d+)')]


def minor_version():
    return minor_versions()[0]


def bench_problems():
    """Problems of the benchmark, of which one is a single operating point."""
    return len([path for path in (REFERENCE.parents[1] / 'bench/problems').glob('*.nml') if path.stem != 'point'])


def methods():
    """Words of &numerics method."""
    return len(next(key['words'] for key in gearsweep.core.library.declared()['keys'] if (key['group'], key['name']) == ('numerics', 'method')))


def difference_places():
    """Of the formula of the highest order."""
    words = {'seven': 7}
    return words[re.search(r'sixth order over (\w+) places', (REFERENCE.parents[1] / 'src/nonlinear/sensitivity.f90').read_text(encoding='utf-8'))[1]]


def difference_formula():
    """Order of a central difference over so many places, and how many are to each side."""
    places = difference_places()
    return [places - 1, (places - 1) // 2]


def sensitivity_closeness():
    """By how much a number is changed: phase of the natural motion, rad, and state, static deflections."""
    return 2 * [whole_source('src/nonlinear/sensitivity.f90', r'closeness = (\S+)_dp')]


# Numbers that a page takes from its own blocks, which other tests hold

def shown(page, pattern):
    """Numbers of what a page shows of a program's answer."""
    text = (REFERENCE.parents[1] / 'doc' / f'{page}.md').read_text(encoding='utf-8')
    found = re.search(pattern, text, flags=re.MULTILINE)
    return [float(number) for number in found.groups()]


def quick_beyond():
    """Dynamic factors found both ways, how many differ by more than 1e-3, and the largest difference: bench/measured/as_built.md."""
    rows = re.findall(r'^\| \d \| (\d+) \| ([\d.e-]+) \| (\d+) \|$', (REFERENCE.parents[1] / 'bench/measured/as_built.md').read_text(encoding='utf-8'), flags=re.MULTILINE)
    return [sum(int(row[0]) for row in rows), sum(int(row[2]) for row in rows), max(float(row[1]) for row in rows)]


def hunting_price():
    """Teeth, class, mesh periods, milliseconds of a point, tolerance, pairs of gears, speeds, reliefs and seconds: bench/measured/hunting.md."""
    text = (REFERENCE.parents[1] / 'bench/measured/hunting.md').read_text(encoding='utf-8')
    stated = re.search(r'(\d+)/(\d+) teeth of class (\d) .* (\d+) mesh periods, at (\d+) speeds .* tolerance (\S+),', text)
    pinion, gear, grade, periods, speeds, tolerance = map(float, stated.groups())
    points = [float(value) for value in re.findall(r'^\| \d+ \| (\d+) ms \|$', text, flags=re.MULTILINE)]
    pairs, seconds = map(float, re.search(r'(\d+) pairs of gears, .*: (\d+) s of', text).groups())
    return [pinion, gear, grade, periods, min(points), max(points), tolerance, pairs, speeds, len(points), seconds]


def hunting_point():
    """Teeth and milliseconds of a point: bench/measured/hunting.md."""
    price = hunting_price()
    return price[:2] + price[4:6]


def names_of(material):
    """Digits of its common names, in the order of the source."""
    text = (REFERENCE.parents[1] / 'src/rating/gear_materials.f90').read_text(encoding='utf-8')
    return [float(number) for name in re.findall(rf"common_name_t\('([^']*)', '{material}'\)", text) for number in re.findall(r'\d+', name)]


def default(group, key):
    """What the library declares for a key."""
    return float(next(one['default'] for one in gearsweep.core.library.declared()['keys'] if (one['group'], one['name']) == (group, key)))


def printed_damping():
    """Of the first mode by the alpha and beta that Hassan et al. print, per cent."""
    alpha, beta = case('hassan_transient').get('transient', 'rayleigh_alpha_1_s'), case('hassan_transient').get('transient', 'rayleigh_beta_s')
    omega = printed_of('hassan2009', 'mode_1_rad_s')
    return 100 * (alpha / omega + beta * omega) / 2


def hassan_ratio():
    return quantities.contact_ratio('hassan')


def hassan_given(group, key):
    value = case('hassan_transient').get(group, key)
    return len(value) if isinstance(value, tuple) else value


def mean_stress_sensitivity():
    """M of ISO 6336-3, Annex B, three times, and the factor of an idler, whose stress swings to minus 1.2 times the largest: as the standard rounds it."""
    m = whole_source('src/rating/root_life.f90', r'sensitivity = (0\.\d)_dp')
    return [m, 1 + m, m]


def body_bench(sector):
    """A row of bench/measured/body_modes.csv."""
    rows = [line.split(',') for line in (REFERENCE.parents[1] / 'bench/measured/body_modes.csv').read_text(encoding='utf-8').splitlines()[2:]]
    return [float(cell) for row in rows if row[0] == str(sector) for cell in row[1:]]


def face_bench(quantity):
    """Largest difference in per cent from finite elements in three dimensions: bench/measured/face.csv."""
    head, *rows = [line.split(',') for line in (REFERENCE.parents[1] / 'bench/measured/face.csv').read_text(encoding='utf-8').splitlines()[1:]]
    return np.nanmax([abs(float(row[head.index(f'{quantity} %')])) for row in rows])


def spring_loads():
    """How many loads of uneven faces are solved for the springs of a pair, and the largest over the static load: src/face/springs.f90."""
    text = (REFERENCE.parents[1] / 'src/face/springs.f90').read_text(encoding='utf-8')
    loads = re.findall(r'([\d.]+)_dp', re.search(r'chord_loads\(\*\) = \[(.*?)\]', text, re.DOTALL)[1])
    return [len(loads), max(map(float, loads))]


def face_in_contact(misalignment):
    """Per cent of the face of test/unit/face/test_face_motion.f90 that carries."""
    found = gearsweep.run(gearsweep.Case(f"""&case tasks = 'face_load' / &pair module_mm = 1 face_width_mm = 10 / &pinion teeth = 25 / &gear teeth = 25 /
        &load line_load_n_mm = 100 / &face misalignment_um = {misalignment} /"""))
    return 100 * float(found.face_load_summary.face_in_contact[0])


def many_bench(row):
    """A row of bench/measured/many.csv."""
    rows = [line.split(',') for line in (REFERENCE.parents[1] / 'bench/measured/many.csv').read_text(encoding='utf-8').splitlines()[2:]]
    return [float(cell) for cell in rows[row][2:]]


def few_starts():
    """Starts of a motion as built: pairs of displacement and velocity."""
    return len(_few_starts())


def start_sizes():
    """Least and largest distance of those beside rest from it, static deflections."""
    sizes = [float(np.hypot(*pair)) for pair in _few_starts()]
    return [round(min(size for size in sizes if size)), round(max(sizes))]


def _few_starts():
    text = (REFERENCE.parents[1] / 'src/motion/search.f90').read_text(encoding='utf-8')
    numbers = [float(number) for number in re.findall(r'-?[\d.]+(?=_dp)', re.search(r'few_starts\(2, \d+\) = reshape\( &\n *\[([^]]*)\]', text)[1])]
    return list(zip(numbers[::2], numbers[1::2], strict=True))


def attractor_starts():
    return default('attractors', 'starts')**2


def thamba_teeth():
    return given('thamba', 'pinion', 'teeth')


def racks_listed():
    return len(choices.RACKS)


def tried_ratios():
    """Least and largest damping ratio of the table."""
    return [min(choices.RATIOS), max(choices.RATIOS)]


def least_ratios():
    """The two least damping ratios of the table."""
    return sorted(choices.RATIOS)[:2]


def mean_sensitivity():
    """M of ISO 6336-3, Annex B, as the library has it."""
    return whole_source('src/rating/root_life.f90', r'sensitivity = (0\.\d)_dp')


def stress_from_zero():
    """Twice the amplitude of a cycle from zero with the life of one with amplitude sigma_a and mean sigma_m: 2, M and 1 + M."""
    return [2, mean_sensitivity(), 1 + mean_sensitivity()]


def idler_factor():
    """Of a stress that swings as far to both sides: over that of one from zero, 1/(1 + M)."""
    return round(1 / (1 + mean_sensitivity()), 1)


def life_end():
    return result_of_rating('long_life_factor')


def life_last():
    return result_of_rating('last_cycles')


def result_of_rating(column):
    """Of a case without keys for it."""
    study = run(case('case1').changed(mesh={'model': 'weber'}, section=dict.fromkeys(case('case1').values['section']), relief={'amount_um': 0},
                                      rating={'rpm': 1000, 'material': 'C45'}), 'rating')
    return study.rating_factors[column][0]


def rated_materials():
    return len(life_factors.materials())


def hassan_tangent():
    tangents = np.atleast_1d(case('hassan_transient').get('transient', 'tangent_deg'))
    return float(tangents[-1]) if len(tangents) > 1 else float(tangents[0])


def hassan_modes():
    of = case('hassan_transient')
    return [of.get('transient', 'modes'), len(of.get('transient', 'shares'))]


def many_shown():
    """Of the first example of doc/many.md: quantile, variants, its band."""
    value, lower, upper = shown('many', r'^([\d.]+) \(([\d.]+) to ([\d.]+)\)$')
    return [value, *shown('many', r"^\{'ok': (\d+)\}$"), lower, upper]


def needed_draws():
    """For an upper end of the band of a 95 % quantile with a confidence of 95 %, two-sided: the largest of n lies above it."""
    n = 1
    while 0.95**n > 0.025:
        n += 1
    return n


def secant_part():
    """By how many per cent the secant of a pair under its whole load is stiffer than that under half of it: c F K log 2 with Hertz's slope."""
    flattening = 2 * (1 - 0.3**2) / (math.pi * 206e3) / given('case1', 'pair', 'face_width_mm')    # mm/N
    stiffness = np.interp(_at_half(), *_stiffness(16)) * 1e3
    return 100 * flattening * stiffness * math.log(2)


def _at_half():
    """In the middle of the path where two pairs touch, base pitches from A."""
    return (result('geometry', 'case1').contact_ratio - 1) / 2


def listed_maxima():
    return 2 * [whole_source('src/motion/optimum.f90', r'integer, parameter :: most = (\d)')]


def mutants(room):
    """Mutants of a room, or of all of a day: made, killed, explained, survived, killed in per cent: tools/mutation/measured.csv."""
    lines = (REFERENCE.parents[1] / 'tools' / 'mutation' / 'measured.csv').read_text(encoding='utf-8').splitlines()[2:]
    rows = [[int(cell) for cell in line.split(',')[2:]] for line in lines if room in line.split(',')[:2]]
    total = [sum(column) for column in zip(*rows)]
    return [*total, 100 * total[1] / total[0]]


def cut_digits():
    """First frequency of Hassan et al. in rad/s and what that is in Hz; alpha, beta and the time in engagement as printed."""
    omega = printed_of('hassan2009', 'mode_1_rad_s')
    return [omega, omega / (2 * math.pi), *(printed_of('hassan2009', row) for row in ('rayleigh_alpha', 'rayleigh_beta', 'contact_time'))]


def valley():
    """The numbers that doc/many.md has of its valley, in order: bench/measured/valley.md, which `sh bench/run.sh valley` writes."""
    text = (REFERENCE.parents[1] / 'bench/measured/valley.md').read_text(encoding='utf-8')
    rows = re.findall(r'^ +(\d+) +([\d.]+) +[\d.]+ +([\d.]+) +([\d.]+) to ([\d.]+) +\+([\d.]+) +([+-][\d.]+) to ([+-][\d.]+) ', text, flags=re.MULTILINE)
    rows = [[float(number) for number in row] for row in rows]
    nominal, best = min(rows, key=lambda row: row[1]), min(rows, key=lambda row: row[2])
    alike = [row[0] for row in rows if row[6] < 0]
    near = [row for row in rows if row[5] < 0.1]
    return [*nominal[:5], best[0], *best[2:5], *alike, nominal[0], *nominal[5:], near[0][0], near[-1][0], max(row[5] for row in near)]
