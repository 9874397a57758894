"""The load over the face width beside finite elements in three dimensions: python bench/face.py (bench/run.sh face sets up and does this).

Two equal gears touch in the middle of single contact. The section of `&section` goes on along the face in elements of its own grid,
quadratic along the face, with free ends; the load of a slice is a parabola along the flank, and Hertz's strip takes its place in closed form.
"""
import numpy as np
import scipy.linalg
import scipy.sparse as sparse
import scipy.sparse.linalg
from numpy.polynomial.legendre import leggauss
from report import Report, machine

import gearsweep
from gearsweep.core.outline import contact_path

# Teeth, profile shift, face width in modules. None of these served to find the law's constants.
GEARS = ((30, 0.2, 8), (22, 0.4, 12))
# Misalignment and crowning (um), at a module of 1 mm and 100 N/mm.
CASES = ((0, 0), (10, 0), (25, 0), (0, 15), (20, 10))
CASE = """&case tasks = 'face_load', 'modal' / &pair module_mm = 1 face_width_mm = {width} /
&pinion teeth = {teeth} profile_shift = {shift} crowning_um = {crowning} / &gear teeth = {teeth} profile_shift = {shift} /
&load line_load_n_mm = 100 / &section teeth = 3 fixed = 'sides', 'rim' elements_across = 8 / &modal modes = 1 / &face misalignment_um = {misalignment} /
"""
POISSON, MODULUS = 0.3, 206e3  # MPa
PARABOLA = 0.3  # half width of the load, mm
LOGARITHM = np.log(2) - 1.75  # mean over two parabolas of half width 1 of the logarithm of the distance of their points
TOLERANCE = 1e-9  # of the conjugate gradients


def main():
    report = Report('face', 'Load over the face width beside finite elements in three dimensions')
    report.add(f'{machine()}. Module 1 mm, 100 N/mm, in the middle of single contact; each number of gearsweep, of the bricks, and by how many '
               'per cent it is off: deflection (um), K_H_beta, load of the outermost module at z = 0 (N/mm) where that is loaded.\n')  # fmt: skip
    rows = [row for gear in GEARS for row in compared(*gear)]
    report.csv('face', ['teeth', 'b/m', 'misalignment', 'crowning', *(f'{name} {of}' for name in ('deflection', 'K_H_beta', 'outermost') for of in ('ours', 'bricks', '%'))],
               [[*row[:4], *(f'{one:.5g}' for one in row[4:])] for row in rows])
    report.table(['teeth', 'b/m', 'misalignment um', 'crowning um', *('deflection', 'bricks', '%', 'K_H_beta', 'bricks', '%', 'outermost', 'bricks', '%')],
                 [[*map(str, row[:4]), *(f'{one:.4g}' if k % 3 < 2 else f'{one:+.1f}' if np.isfinite(one) else '' for k, one in enumerate(row[4:]))] for row in rows])
    report.save()


def compared(teeth, shift, width):
    """Rows of the table for a pair of gears."""
    compliance = None
    for misalignment, crowning in CASES:
        case = CASE.format(teeth=teeth, shift=shift, width=width, misalignment=misalignment, crowning=crowning)
        study = gearsweep.run(gearsweep.Case(case))
        load, phases = study.face_load, study.face_load_phases
        single = np.flatnonzero(phases.pairs == 1)
        at = phases.mesh_phase[(single[0] + single[-1]) // 2]
        mine = load.mesh_phase == at
        sizes, gap, ours = load.slice_mm[mine], load.gap_um[mine], load.line_load_n_mm[mine]
        bounds = np.append(0, np.cumsum(sizes))
        if compliance is None:
            compliance = of_bricks(study, contact_path(study, load.s[mine][:1])[0], bounds)
        deflection, bricks = touching(study, compliance, sizes, gap)
        both = [(phases.ste_um[phases.mesh_phase == at][0], deflection), *((of(bounds, ours), of(bounds, bricks)) for of in (largest, outermost))]
        yield [teeth, width, misalignment, crowning, *(one for pair in both for one in (*pair, 100 * (pair[0] / pair[1] - 1) if pair[1] > 1 else np.nan))]


def touching(study, compliance, sizes, gap):
    """Deflection (um) and line loads (N/mm) of two such gears that touch, by Newton's method within an active set."""
    modulus = MODULUS / (1 - POISSON**2)
    radius = study.gears.base_diameter_mm[0] / 2 * np.tan(np.radians(study.geometry.working_angle_deg)) / 2
    force = 100 * sizes.sum()
    w, active = np.full(len(sizes), 100.0), np.ones(len(sizes), bool)
    while True:
        for _ in range(30):
            half = np.sqrt(8 * w * radius / (np.pi * modulus))
            strip = 4 / (np.pi * modulus) * (np.log(2 * PARABOLA / half) + 0.5 + LOGARITHM)  # of both gears
            matrix = 2 * compliance + np.diag(strip)
            slope = matrix - np.diag(np.full(len(w), 2 / (np.pi * modulus)))
            n = active.sum()
            system = np.zeros((n + 1, n + 1))
            system[:n, :n] = slope[np.ix_(active, active)]
            system[:n, n], system[n, :n] = -1, sizes[active]
            residual = np.append((slope - matrix)[np.ix_(active, active)] @ w[active] - 1e-3 * gap[active], force)
            new = np.linalg.solve(system, residual)
            change = abs(new[:n] - w[active]).max()
            w[active] = np.maximum(new[:n], 1e-3)
            if change < 1e-9:
                break
        if (new[:n] < 0).any():
            leaves = np.flatnonzero(active)[new[:n].argmin()]
            active[leaves], w[leaves] = False, 1e-3
            continue
        w[~active] = 0
        enters = new[n] - 1e-3 * gap - 2 * compliance @ w > 1e-12
        if not (enters & ~active).any():
            return 1e3 * new[n], w
        active |= enters
        w = np.maximum(w, 1e-3)


def largest(bounds, load):
    """K_H_beta: largest mean over one module over the mean."""
    sums = np.append(0, np.cumsum(load * np.diff(bounds)))
    starts = np.clip(np.concatenate((bounds, bounds - 1)), 0, bounds[-1] - 1)
    return (np.interp(starts + 1, bounds, sums) - np.interp(starts, bounds, sums)).max() / (sums[-1] / bounds[-1])


def outermost(bounds, load):
    """Mean over the module at z = 0, N/mm."""
    return np.interp(1, bounds, np.append(0, np.cumsum(load * np.diff(bounds))))


def of_bricks(study, touch, bounds):
    """Mean displacement (mm) along the line of action of each slice under a line load of 1 N/mm on another one."""
    x, y = study.nodes.x_mm, study.nodes.y_mm
    corners = np.column_stack([study.elements[f'node_{k}'] for k in range(1, 9)]) - 1
    radius, angle = np.hypot(x, y), np.arctan2(x, y)
    is_held = np.isclose(radius, radius.min(), atol=1e-9) | np.isclose(abs(angle), abs(angle).max(), atol=1e-9)
    free = np.repeat(~is_held, 3)
    plane, mixed, cross = (one[free][:, free] for one in plane_matrices(x, y, corners))
    mass, slope, stiff, means = along_face(bounds)
    pull = flank_load(study, x, y, corners, touch)[free]
    values, modes = scipy.linalg.eigh(stiff, mass)
    solvers = [scipy.sparse.linalg.splu((plane + max(value, 0) * cross).tocsc()) for value in values]

    def times(u):
        return sum(product(part, u) @ along.T for part, along in ((plane, mass), (mixed, slope), (mixed.T, slope.T), (cross, stiff)))

    def product(matrix, u):
        return (matrix @ u.transpose(1, 0, 2).reshape(len(pull), -1)).reshape(len(pull), u.shape[0], -1).transpose(1, 0, 2)

    def solved(u):
        waves = u @ modes
        found = np.empty_like(waves)
        for k, solver in enumerate(solvers):
            found[:, :, k] = solver.solve(waves[:, :, k].T).T
        return found @ modes.T

    # Conjugate gradients for all slices at once; without what mixes plane and axial displacements the waves are independent.
    loads = pull[None, :, None] * means[:, None, :]
    u = np.zeros_like(loads)
    residual, scale = loads.copy(), np.sqrt((loads**2).sum(axis=(1, 2)))
    better = solved(residual)
    way, energy = better, (residual * better).sum(axis=(1, 2))
    for _ in range(200):
        image = times(way)
        step = energy / (way * image).sum(axis=(1, 2))
        u += step[:, None, None] * way
        residual -= step[:, None, None] * image
        if (np.sqrt((residual**2).sum(axis=(1, 2))) < TOLERANCE * scale).all():
            break
        better = solved(residual)
        energy, before = (residual * better).sum(axis=(1, 2)), energy
        way = better + (energy / before)[:, None, None] * way
    return np.einsum('jpz,p,iz->ij', u, pull, means) / np.diff(bounds)[:, None]


def plane_matrices(x, y, corners):
    """Integrals over the section: of plane with plane strains, of plane with axial, of axial with axial ones."""
    lame = MODULUS * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
    shear = MODULUS / (2 * (1 + POISSON))
    elastic = np.diag([2 * shear] * 3 + [shear] * 3)
    elastic[:3, :3] += lame
    points, weights = leggauss(3)
    signs = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    n, count = len(x), len(corners)
    sums = [np.zeros((count, 24, 24)) for _ in range(3)]
    for a, wa in zip(points, weights):
        for b, wb in zip(points, weights):
            shape, da, db = serendipity(a, b, signs)
            jacobian = np.einsum('dk,ekc->edc', np.array([da, db]), np.stack((x, y), -1)[corners])
            det = np.linalg.det(jacobian)
            dx, dy = np.einsum('edc,ck->dek', np.linalg.inv(jacobian), np.array([da, db]))
            in_plane, axial = np.zeros((count, 6, 24)), np.zeros((count, 6, 24))
            in_plane[:, 0, 0::3], in_plane[:, 1, 1::3] = dx, dy
            in_plane[:, 3, 2::3], in_plane[:, 4, 2::3] = dy, dx
            in_plane[:, 5, 0::3], in_plane[:, 5, 1::3] = dy, dx
            axial[:, 2, 2::3], axial[:, 3, 1::3], axial[:, 4, 0::3] = shape, shape, shape
            weight = wa * wb * abs(det)
            for total, left, right in zip(sums, (in_plane, in_plane, axial), (in_plane, axial, axial)):
                total += np.einsum('e,eip,ij,ejq->epq', weight, left, elastic, right, optimize=True)
    rows = (3 * corners[:, :, None] + np.arange(3)).reshape(count, 24)
    at = np.repeat(rows, 24, axis=1).ravel(), np.tile(rows, 24).ravel()
    return [sparse.csr_matrix((total.ravel(), at), shape=(3 * n, 3 * n)) for total in sums]


def serendipity(a, b, signs):
    """Shape functions of eight nodes, corners first, and their derivatives."""
    shape, da, db = np.zeros(8), np.zeros(8), np.zeros(8)
    for k, (p, q) in enumerate(signs):
        shape[k] = (1 + p * a) * (1 + q * b) * (p * a + q * b - 1) / 4
        da[k] = p * (1 + q * b) * (2 * p * a + q * b) / 4
        db[k] = q * (1 + p * a) * (p * a + 2 * q * b) / 4
        (r, s) = (signs[k] + signs[(k + 1) % 4]) / 2  # the side after this corner
        shape[4 + k] = (1 - a**2) * (1 + s * b) / 2 if r == 0 else (1 - b**2) * (1 + r * a) / 2
        da[4 + k], db[4 + k] = (-a * (1 + s * b), s * (1 - a**2) / 2) if r == 0 else (r * (1 - b**2) / 2, -b * (1 + r * a))
    return shape, da, db


def along_face(bounds):
    """Integrals of the quadratic functions along the face, of their derivatives, and their means over each slice, times its width."""
    n = 2 * len(bounds) - 1
    mass, slope, stiff, means = np.zeros((n, n)), np.zeros((n, n)), np.zeros((n, n)), np.zeros((len(bounds) - 1, n))
    points, weights = leggauss(4)
    for e, width in enumerate(np.diff(bounds)):
        own = slice(2 * e, 2 * e + 3)
        for t, weight in zip(points, weights * width / 2):
            f, d = np.array([t * (t - 1) / 2, 1 - t**2, t * (t + 1) / 2]), np.array([t - 0.5, -2 * t, t + 0.5]) * 2 / width
            mass[own, own] += weight * np.outer(f, f)
            slope[own, own] += weight * np.outer(f, d)
            stiff[own, own] += weight * np.outer(d, d)
            means[e, own] += weight * f
    return mass, slope, stiff, means


def flank_load(study, x, y, corners, touch):
    """Nodal loads of a parabola of unit load about the point of contact on the drive flank, along the line of action, (3 nodes)."""
    reach, base, tip = np.hypot(*touch), study.gears.base_diameter_mm[0] / 2, study.gears.tip_diameter_mm[0] / 2
    sides = np.concatenate([corners[:, [k, 4 + k, (k + 1) % 4]] for k in range(4)])
    _, back, times = np.unique(np.sort(sides[:, [0, 2]], axis=1), axis=0, return_inverse=True, return_counts=True)
    sides = sides[times[back.ravel()] == 1]
    radius, angle = np.hypot(x, y), np.arctan2(x, y)
    middle = sides[:, 1]
    sides = sides[(angle[middle] > 0) & (angle[middle] < np.pi / study.case.get('pinion', 'teeth')) & (base < radius[middle]) & (radius[middle] < tip - 1e-6)]
    order = np.argsort(radius[sides[:, 1]])
    polar = np.interp(reach, radius[sides[order, 1]], angle[sides[order, 1]])
    pressure = np.arccos(base / reach)
    # Into the body along the flank's normal, which touches the base circle.
    lean = polar - pressure
    direction = np.array([-np.cos(lean), np.sin(lean)])
    points, weights = leggauss(60)
    shape = np.array([points * (points - 1) / 2, 1 - points**2, points * (points + 1) / 2])
    slopes = np.array([points - 0.5, -2 * points, points + 0.5])
    force = np.zeros((len(x), 3))
    for side in sides:
        px, py, length = shape.T @ x[side], shape.T @ y[side], np.hypot(slopes.T @ x[side], slopes.T @ y[side])
        # The involute is as long as half the base radius times the square of the roll angle.
        place = ((px**2 + py**2 - reach**2) / (2 * base)) / PARABOLA
        density = np.where(abs(place) < 1, 0.75 * (1 - place**2) / PARABOLA, 0) * length * weights
        force[side, :2] += np.outer(shape @ density, direction)
    return (force / np.hypot(*force.sum(axis=0)[:2])).ravel()


if __name__ == '__main__':
    main()
