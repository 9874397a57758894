"""Expected values of gears and their bodies, for expect.py; cases are {'group key': text}, lengths in mm.

geometry    contact ratio of involute gears
iso         ISO 6336-1:2006, method B
Weber       Weber and Banaschek's formula in the middle of the path, integrated over the exact outline
elements    first mode by scikit-fem with elements of fourth order, on two of the library's grids; needs
            the program (build/run/gearsweep) for these, whose outline has tests of its own
"""
import subprocess
import tempfile
from math import acos, cos, log, pi, radians, sin, sqrt, tan
from pathlib import Path

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq

HERE = Path(__file__).parent
PROGRAM = HERE.parents[2] / "build/run/gearsweep"
ALPHA = radians(20)


def inv(a):
    return tan(a) - a


def number(case, key, default=None):
    return float(case[key]) if case.get(key) else default


class Gear:
    """One gear in modules: teeth, profile shift, addendum, dedendum, tip radius of the rack."""

    def __init__(self, case, gear):
        self.z = int(case[f"{gear} teeth"])
        self.x = number(case, f"{gear} profile_shift", 0.0)
        self.addendum = number(case, f"{gear} addendum", 1.0)
        self.dedendum = number(case, f"{gear} dedendum", 1.25)
        self.rounding = number(case, f"{gear} rack_tip_radius", 0.25)
        self.base = self.z / 2 * cos(ALPHA)
        self.tip = self.z / 2 + self.x + self.addendum

    def half_angle(self, radius):
        """Half of the tooth's thickness at a radius, as an angle about the gear's axis."""
        return (pi / 2 + 2 * self.x * tan(ALPHA)) / self.z + inv(ALPHA) - inv(acos(self.base / radius))


def gears(case):
    return Gear(case, "pinion"), Gear(case, "gear")


def contact_ratio(case):
    one, two = gears(case)
    working = inv(ALPHA) + 2 * tan(ALPHA) * (one.x + two.x) / (one.z + two.z)
    angle = brentq(lambda a: inv(a) - working, 1e-3, 1.2, xtol=1e-15)
    path = sum(sqrt(g.tip**2 - g.base**2) for g in (one, two)) - (one.base + two.base) * tan(angle)
    return path / (pi * cos(ALPHA)), 1e-9


def iso(case):
    one, two = gears(case)
    q = 0.04723 + 0.15551 / one.z + 0.25791 / two.z
    rack = 1 + 0.5 * (1.2 - 1.25)
    tangential = number(case, "load line_load_n_mm") * cos(ALPHA)
    return 0.8 * rack / q * min(1.0, tangential / 100)**0.25 * number(case, "pair face_width_mm"), 1e-9


def weber(case):
    """Compliance of equal gears without shift, which touch on their reference circles, in um/N."""
    gear, other = gears(case)
    assert gear.z == other.z and gear.x == other.x == 0
    module, load, width = (number(case, k) for k in ("pair module_mm", "load line_load_n_mm", "pair face_width_mm"))
    young, nu = 206e3, 0.3
    half_width, foot = tooth(gear)
    radius = gear.z / 2
    # The load's angle to the tooth's width, its line's way to the tooth's axis and height there.
    angle = ALPHA - gear.half_angle(radius)
    depth = radius * sin(gear.half_angle(radius)) / cos(angle)
    height = gear.base / cos(angle) - foot
    bending = quad(lambda y: (height - y)**2 / (2 * half_width(foot + y))**3, 0, height, epsrel=1e-10, limit=200)[0]
    shear = quad(lambda y: 1 / (2 * half_width(foot + y)), 0, height, epsrel=1e-10, limit=200)[0]
    slender, t = height / (2 * half_width(foot)), tan(angle)**2
    bend = (1 - nu**2) / young * cos(angle)**2 * (12 * bending + (2.4 / (1 - nu) + t) * shear)
    found = (1 - nu**2) / young * cos(angle)**2 * (
        18 / pi * slender**2 + 2 * (1 - 2 * nu) / (1 - nu) * slender + 4.8 / pi * (1 + (1 - nu) / 2.4 * t))
    curvature = radius * sin(ALPHA) * module / 2
    contact = sqrt(8 * load * curvature * (1 - nu**2) / (pi * young))
    flatten = 2 * (1 - nu**2) / (pi * young) * (log(2 * depth * module / contact) - nu / (2 * (1 - nu)))
    return 2 * (bend + found + flatten) / width * 1e3, 1e-9


def tooth(gear):
    """Half width of the tooth over the height on its axis, and where the fillet's tangent makes 30 degrees with it."""
    radius, depth = gear.z / 2, gear.dedendum - gear.rounding - gear.x
    # The centre of the rack's rounded corner: below the pitch line, and beside the axis of the rack's space.
    beside = pi / 4 + (gear.dedendum - gear.rounding) * tan(ALPHA) + gear.rounding / cos(ALPHA)

    def turned(b):
        return (-depth / tan(b) - beside) / radius

    def fillet(b):
        """The point cut where the common normal, through the pitch point, has the slope b."""
        x, y = -depth / tan(b) - gear.rounding * cos(b), radius - depth - gear.rounding * sin(b)
        angle = np.arctan2(x, y) - turned(b)
        return np.hypot(x, y) * sin(angle), np.hypot(x, y) * cos(angle)

    lowest = brentq(lambda b: b + turned(b) - pi / 6, ALPHA, pi / 2, xtol=1e-14)
    form = np.hypot(*fillet(ALPHA))
    join = form * cos(gear.half_angle(form))

    def half_width(y):
        if y < join:
            return fillet(brentq(lambda b: fillet(b)[1] - y, ALPHA - 1e-9, lowest + 1e-9, xtol=1e-14))[0]
        r = brentq(lambda r: r * cos(gear.half_angle(r)) - y, form * (1 - 1e-9), gear.tip + 1, xtol=1e-14)
        return r * sin(gear.half_angle(r))

    return half_width, fillet(lowest)[1]


# --- finite elements ----------------------------------------------------------------------------

def elements(case):
    """First frequency; what is left by the finer grid is taken to be its distance from the coarser one."""
    coarse, fine = (first_mode(case, across) for across in (6, 12))
    return fine, abs(fine / coarse - 1)


def first_mode(case, across):
    import skfem
    from scipy.sparse.linalg import eigsh
    from skfem.helpers import ddot, dot, eye, sym_grad, trace

    young, nu = number(case, "material young_gpa", 206.0) * 1e9, number(case, "material poisson", 0.3)
    plane_stress = "stress" in case.get("section plane", "")
    shear = young / (2 * (1 + nu))
    first = young * nu / (1 - nu**2) if plane_stress else young * nu / ((1 + nu) * (1 - 2 * nu))
    density = 7850.0

    @skfem.BilinearForm
    def stiffness(u, v, _):
        strain = sym_grad(u)
        return ddot(2 * shear * strain + first * eye(trace(strain), 2), sym_grad(v))

    @skfem.BilinearForm
    def mass(u, v, _):
        return density * dot(u, v)

    mesh = section_grid(case, across)
    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementQuadP(4)), intorder=10)
    held = basis.get_dofs(held_facets(mesh)).all()
    k, m, *_ = skfem.condense(stiffness.assemble(basis), mass.assemble(basis), D=held)
    square = eigsh(k, k=1, M=m, sigma=0, return_eigenvectors=False)[0]
    return sqrt(square) / (2 * pi)


def held_facets(mesh):
    """Facets of the inner edge and of the two cut sides."""
    outer = mesh.boundary_facets()
    x, y = mesh.p[:, mesh.facets[:, outer]]
    radius, angle = np.hypot(x, y), np.abs(np.arctan2(x, y))
    low, wide = np.hypot(*mesh.p).min(), np.abs(np.arctan2(*mesh.p)).max()
    inner = np.all(radius < low * (1 + 1e-6), axis=0)
    sides = np.all(angle > wide - 1e-6, axis=0)
    return outer[inner | sides]


def section_grid(case, across):
    """The library's grid, as curved elements for scikit-fem."""
    import skfem
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "case.nml"
        groups = {}
        for key, value in {**case, "section elements_across": str(across)}.items():
            group, name = key.split()
            groups.setdefault(group, []).append(f"{name} = {value}")
        path.write_text("".join(f"&{g}\n  " + "\n  ".join(lines) + "\n/\n" for g, lines in groups.items()))
        subprocess.run([PROGRAM, path, "--out", folder], check=True, capture_output=True)
        text = (Path(folder) / "case.mode_shapes.vtu").read_text()
    points = np.fromstring(text.split('format="ascii">')[1].split("<")[0], sep=" ").reshape(-1, 3)[:, :2]
    element = np.fromstring(text.split('Name="connectivity" format="ascii">')[1].split("<")[0], sep=" ", dtype=int).reshape(-1, 8)
    corners, index = np.unique(element[:, :4], return_inverse=True)
    mesh = skfem.MeshQuad2.from_mesh(skfem.MeshQuad(points[corners].T.copy(), index.reshape(-1, 4).T.copy()))
    places, own = mesh.doflocs.copy(), points[element]
    places[:, mesh.dofs.element_dofs[:8]] = own.transpose(2, 1, 0)
    places[:, mesh.dofs.element_dofs[8]] = (own[:, 4:].sum(1) / 2 - own[:, :4].sum(1) / 4).T
    return skfem.MeshQuad2(places, mesh.t)
