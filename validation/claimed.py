"""What doc/ says in numbers, computed anew for claims.csv."""

import functools
import re

import numpy as np

import gearsweep

from . import dogan2021, hassan2009, ledger, quantities, thamba2020
from .cases import case, given, result, run

ACROSS = 32  # the finest grid of doc/elastic.md
REFERENCE = ledger.FOLDER.parent / 'test' / 'reference'


# Finite elements

def stiffness_on(across):
    """Pair stiffness of case 1 at A, s = 0.29 and 0.81, N/um, with so many elements across a tooth."""
    s, stiffness = _stiffness(across)
    return list(np.interp((0, 0.29, 0.81), s, stiffness))


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


def hub(bore, ratio):
    """Case 1 with whole gears on this bore, mm, and this inertia there over that of the gear: how many per cent a natural
    frequency lies above that of finite elements with a hub: all inertia in one body, the motion's, the chain's."""
    lines = (REFERENCE / 'hub.dat').read_text(encoding='utf-8').splitlines()
    rows = [tuple(map(float, line.split())) for line in lines if line[0] != '#']
    mass, whole, rigid = next((row[2], row[4], row[5]) for row in rows if (2 * row[0], row[3]) == (bore, ratio))
    mass *= given('case1', 'pair', 'face_width_mm')
    base = 0.5e-3 * given('case1', 'pinion', 'teeth') * given('case1', 'pair', 'module_mm') * np.cos(np.radians(20))
    member = {'bore_mm': bore, 'effective_mass_kg': mass}
    plain, with_hub = (run(case('case1').changed(section={'teeth': 25, 'fixed': 'rim'}, pinion=member | added, gear=member | added,
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
    return run(case('hassan').changed(section={'elements_across': across}), ('static', 'modal', 'section'))


# What README.md takes from the tables of doc/performance.md

def sweep_ms():
    """Points of the sweep of case 1, and its time within the error, in ms: as released, built for the processor."""
    released, native = _row(r'gearsweep \| 1'), _row('gearsweep, native build')
    rpm, relief = (case('case1').get(*key) for key in (('sweep', 'rpm_step'), ('relief', 'amount_um')))
    speeds = (given('case1', 'sweep', 'rpm_last') - given('case1', 'sweep', 'rpm_first')) // rpm + 1
    return [speeds * len(relief), 1000 * released[4], 1000 * native[4]]


def ten_modes():
    """Unknowns and seconds of the last grid, and how many times as long the peers take."""
    text = _performance().partition('**Ten modes on the same grid.**')[2].partition('\n**')[0]
    last = re.findall(r'^\| (\d+) \| \d+ \| gearsweep \|.*?\| ([\d.]+) \|  \|  \|\n((?:\|  \|.*\n){3})', text, flags=re.MULTILINE)[-1]
    peers = [float(line.split('|')[-3]) for line in last[2].splitlines()]
    return [float(last[0]), float(last[1]), *peers]


def _performance():
    return (REFERENCE.parents[1] / 'doc' / 'performance.md').read_text(encoding='utf-8')


def _row(begin):
    """The first row of a table that begins so, as numbers where it has them."""
    cells = re.search(rf'^\| {begin}.*$', _performance(), flags=re.MULTILINE)[0].strip('|').split('|')
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


def extreme_cases():
    """Of test/extreme/cases.txt: all, and those that only another of them checks."""
    text = (REFERENCE.parent / 'extreme' / 'cases.txt').read_text(encoding='utf-8')
    rows = [line.split('|') for line in text.splitlines() if line.count('|') == 7 and line[0] != '#']
    return [len(rows), sum(row[5].strip().startswith('=') for row in rows)]


def prescribed():
    """The prescribed mesh of doc/limits.md: mean stiffness, N/um, natural frequency, Hz, and its speed, 1/min."""
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


def tip_over_base():
    """Of Hassan's pinion, mm."""
    return quantities.radius('hassan', 1, 'tip') - quantities.radius('hassan', 1, 'base')


def signed_alpha():
    """Hassan's alpha with its sign, by frequencies in Hz."""
    return -hassan2009.rayleigh_alpha()


def printed_falls():
    """Least and largest fall of a dynamic factor that Dogan et al. print with and without relief, per cent."""
    pairs = (('df_1', 'df_15'), ('df1_1', 'df1_15'), ('df2_1', 'df2_15'), ('df1_2', 'df1_28'))
    falls = [100 * (1 - printed_of('dogan2021', with_relief) / printed_of('dogan2021', without)) for without, with_relief in pairs]
    return [min(falls), max(falls)]


def least_difference():
    """Of DF at 15 and at 18 um and 1600 rpm, case 1."""
    return abs(dogan2021.factor('case1', 1600, 15) - dogan2021.factor('case1', 1600, 18))


def one_range(of, first, last):
    """Least and largest of a function of Hassan's load steps."""
    values = [getattr(hassan2009, of)(k) for k in range(first, last + 1)]
    return [min(values), max(values)]


# Dynamics

def poisson_high():
    """By how much the first mode of the row "Poisson 0.4999, plane strain" of doc/limits.md lies off, per cent."""
    text = (REFERENCE.parents[1] / 'doc' / 'limits.md').read_text(encoding='utf-8')
    return 100 * float(re.search(r'\| Poisson 0\.4999, plane strain \|.*\| (\S+) \| elements \|', text)[1])


def _prescribed():
    return (REFERENCE.parent / 'extreme' / 'prescribed.nml').read_text(encoding='utf-8')


def thermal_contact():
    """Thermal contact coefficient that the defaults of &flank and &material make, N/(mm s^0.5 K)."""
    complete = case('fzg_c40').changed(flank={'conductivity_w_mk': None, 'specific_heat_j_kgk': None},
                                             material={'density_kgm3': None}).complete()  # fmt: skip
    heat = [complete.get('flank', key) for key in ('conductivity_w_mk', 'specific_heat_j_kgk')]
    return (heat[0] * heat[1] * complete.get('material', 'density_kgm3'))**0.5 / 1000
