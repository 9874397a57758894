"""Six-node triangles in a section of a gear: one tooth is triangulated, its copies are turned beside each other.

The sides of the tooth's sector are radial lines through the middles of the spaces, with the same nodes on both.
"""
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise
from math import cos, pi, sin

import numpy as np
from scipy.spatial import Delaunay, cKDTree

from .gears import Gear


@dataclass
class Piece:
    """A part of the outline, from parameter 0 to 1, clockwise around the tooth's material left to right."""
    name: str
    point: Callable[[float], np.ndarray]
    nodes: np.ndarray = field(default_factory=lambda: np.zeros(0))    # parameters of the vertices


@dataclass
class Grid:
    points: np.ndarray                        # (n, 2)
    triangles: np.ndarray                     # (m, 6): corners, then the middles of 12, 23, 31
    edges: list = field(default_factory=list)  # of free outline: (nodes a, b, middle, piece's name, tooth, t at a and b, piece)
    sides: np.ndarray = field(default_factory=lambda: np.zeros(0, int))  # nodes of the outer cuts
    rim: np.ndarray = field(default_factory=lambda: np.zeros(0, int))    # nodes of the inner edge


def pieces(gear: Gear, inner: float):
    """The outline of one tooth's sector, from the left side's top over tooth and right side back."""
    def arc(radius, start, end):
        return lambda t: radius * np.array([sin(start + t * (end - start)), cos(start + t * (end - start))])

    def fillet(side, t):
        a = gear.angle[side]
        return gear.fillet(side, pi / 2 + t * (a - pi / 2))

    ends = [gear.fillet_end(s) for s in (0, 1)]
    right = (gear.pitch + ends[0] - ends[1]) / 2                # the middle of the root land
    left = right - gear.pitch
    tips = [gear.flank_angle(s, gear.tip) for s in (0, 1)]
    return [Piece('land-', arc(gear.root, left, -ends[1])),
            Piece('fillet-', lambda t: fillet(1, t)),
            Piece('flank-', lambda t: gear.flank_at(1, t)),
            Piece('tip', arc(gear.tip, -tips[1], tips[0])),
            Piece('flank', lambda t: gear.flank_at(0, 1 - t)),
            Piece('fillet', lambda t: fillet(0, 1 - t)),
            Piece('land', arc(gear.root, ends[0], right)),
            Piece('side', lambda t: (gear.root + t * (inner - gear.root)) * np.array([sin(right), cos(right)])),
            Piece('rim', arc(inner, right, left)),
            Piece('side-', lambda t: (inner + t * (gear.root - inner)) * np.array([sin(left), cos(left)]))]


class Size:
    """Wanted length of edges: `surface` on the tooth's outline, `corner` at the working tip corner, growing inwards."""

    def __init__(self, gear, outline, surface, corner, spread, growth=0.25, largest=None):
        self.surface, self.corner, self.spread, self.growth = surface, corner, spread, growth
        self.largest = largest or 0.5 * gear.module
        self.tip = gear.flank(0, gear.tip)
        fine = [p for p in outline if not p.name.startswith(('side', 'rim'))]
        self.tree = cKDTree(np.array([p.point(t) for p in fine for t in np.linspace(0, 1, 200)]))

    def plain(self, points):
        """Without the corner: the same in every sector."""
        return np.minimum(self.largest, self.surface + self.growth * self.tree.query(points)[0])

    def __call__(self, points):
        far = np.hypot(*(points - self.tip).T)
        fine = (self.surface - self.corner) / self.spread
        return np.minimum(self.plain(points), np.where(far < fine, self.corner + self.spread * far,
                                                       self.surface + self.growth * (far - fine)))


def divide(piece, size):
    """Parameters along a piece such that its edges have the wanted lengths."""
    t = np.linspace(0, 1, 4001)
    x = np.array([piece.point(v) for v in t])
    length = np.hypot(*np.diff(x, axis=0).T)
    count = np.concatenate([[0], np.cumsum(length / size((x[1:] + x[:-1]) / 2))])
    n = max(2, int(np.ceil(count[-1])))
    return np.interp(np.linspace(0, count[-1], n + 1), count, t)


def inside(points, polygon):
    """Which points lie in a polygon."""
    x, y = points[:, 0, None], points[:, 1, None]
    a, b = polygon, np.roll(polygon, -1, axis=0)
    crosses = (a[:, 1] > y) != (b[:, 1] > y)
    with np.errstate(divide='ignore', invalid='ignore'):
        at = a[:, 0] + (y - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0])
    return np.sum(crosses & (x < at), axis=1) % 2 == 1


def triangles(points, polygon):
    """Delaunay's triangles within the polygon."""
    found = Delaunay(points).simplices
    return found[inside(points[found].mean(axis=1), polygon)]


def lattice(polygon, size):
    """Points in the polygon about as far from each other as wanted: for each size, those of its own lattice."""
    low, high = polygon.min(axis=0), polygon.max(axis=0)
    ladder = [size(polygon).min()]
    while ladder[-1] < size.largest:
        ladder.append(ladder[-1] * 1.15)
    found = []
    for h, coarser in zip(ladder, [*ladder[1:], np.inf]):
        lo, hi = low, high
        if h < 0.3 * size.surface:                             # only near the corner
            reach = 1.3 * h / size.spread
            lo, hi = np.maximum(low, size.tip - reach), np.minimum(high, size.tip + reach)
        x, y = np.meshgrid(np.arange(lo[0], hi[0], h), np.arange(lo[1], hi[1], h * 3**0.5 / 2))
        x[1::2] += h / 2
        p = np.column_stack([x.ravel(), y.ravel()])
        wanted = size(p)
        found.append(p[(wanted >= h) & (wanted < coarser)])
    p = np.vstack(found)
    return p[inside(p, polygon)]


def repelled(p, fixed, tri, size):
    """Points moved away from neighbours that are nearer than wanted (Persson and Strang 2004); the first `fixed` stay."""
    bars = np.unique(np.sort(np.vstack([tri[:, [0, 1]], tri[:, [1, 2]], tri[:, [2, 0]]]), axis=1), axis=0)
    d = p[bars[:, 0]] - p[bars[:, 1]]
    length = np.hypot(*d.T)
    wanted = size((p[bars[:, 0]] + p[bars[:, 1]]) / 2)
    wanted *= 1.15 * np.sqrt(np.sum(length**2) / np.sum(wanted**2))
    push = np.maximum(wanted - length, 0)[:, None] * d / length[:, None]
    move = np.zeros_like(p)
    np.add.at(move, bars[:, 0], push)
    np.add.at(move, bars[:, 1], -push)
    move[:fixed] = 0
    return p + 0.2 * move


def averaged(p, fixed, tri):
    """Points moved to the mean of their neighbours; the first `fixed` stay."""
    total, count = np.zeros_like(p), np.zeros(len(p))
    for i, j in ((0, 1), (1, 2), (2, 0)):
        np.add.at(total, tri[:, i], p[tri[:, j]])
        np.add.at(total, tri[:, j], p[tri[:, i]])
        np.add.at(count, tri[:, [i, j]], 1)
    mean = total / np.maximum(count, 1)[:, None]
    mean[:fixed] = p[:fixed]
    return mean


def triangulate(polygon, size, steps=40):
    """Points in a polygon, its own first, and triangles between them that fill it."""
    fixed, edge = len(polygon), cKDTree(polygon)
    p = lattice(polygon, size)
    p = p[edge.query(p)[0] > 0.6 * size(p)]
    p += 1e-6 * size(p)[:, None] * np.random.default_rng(1).standard_normal(p.shape)
    p = np.vstack([polygon, p])
    for step in range(steps):
        p = repelled(p, fixed, triangles(p, polygon), size)
        if step % 8 == 7 and step < steps - 8:                  # what has come too close to the outline goes
            keep = inside(p, polygon) & (edge.query(p)[0] > 0.45 * size(p))
            keep[:fixed] = True
            p = p[keep]
    for _ in range(4):
        p = averaged(p, fixed, triangles(p, polygon))
    tri = triangles(p, polygon)
    one, two = p[tri[:, 1]] - p[tri[:, 0]], p[tri[:, 2]] - p[tri[:, 0]]
    area = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]
    after = np.roll(polygon, -1, axis=0)
    whole = np.sum(polygon[:, 0] * after[:, 1] - after[:, 0] * polygon[:, 1])
    if abs(np.abs(area).sum() - whole) > 1e-9 * whole:
        raise ValueError('the triangles do not fill the outline')
    tri[area < 0] = tri[area < 0][:, ::-1]
    return p, tri


def section(gear, inner, teeth, surface, corner=None, spread=0.15, largest=None):
    """Grid of `teeth` teeth (0: the whole gear) between their spaces, down to the radius `inner`; edges about `surface`
    long on the teeth, and down to `corner` at the working tip corner of the middle one."""
    others = sector(gear, inner, surface, surface, spread, largest)
    middle = sector(gear, inner, surface, corner, spread, largest) if corner and corner < surface else others
    return assemble(gear, middle, others, teeth or gear.teeth, teeth in (0, gear.teeth))


def sector(gear, inner, surface, corner, spread, largest):
    """Points, triangles and edges of one tooth's grid."""
    outline = pieces(gear, inner)
    size = Size(gear, outline, surface, corner, spread, largest=largest or max(surface, 0.5 * gear.module))
    corners, edges = [], []                                    # where edges begin; (piece, its parameter there and at the end)
    for k, piece in enumerate(outline):
        piece.nodes = divide(piece, size.plain if piece.name.startswith(('side', 'rim')) else size)
        if piece.name == 'side-':                              # as the other side, seen from below
            piece.nodes = 1 - outline[k - 2].nodes[::-1]
        corners += [piece.point(t) for t in piece.nodes[:-1]]
        edges += [(piece, a, b) for a, b in pairwise(piece.nodes)]
    n = len(corners)
    p, tri = triangulate(np.array(corners)[::-1], size)        # counter-clockwise
    index, middles, six = {}, [], np.zeros((len(tri), 6), int)
    six[:, :3] = tri
    for e, (a, b, c) in enumerate(tri):
        for q, (i, j) in enumerate(((a, b), (b, c), (c, a))):
            key = (min(i, j), max(i, j))
            if key not in index:
                index[key] = len(p) + len(middles)
                middles.append((p[i] + p[j]) / 2)
            six[e, 3 + q] = index[key]
    found = []
    for k, (piece, a, b) in enumerate(edges):                  # their middles lie on the true curve
        i, j = n - 1 - k, n - 1 - (k + 1) % n
        key = (min(i, j), max(i, j))
        if key not in index:
            raise ValueError('the triangulation misses an edge of the outline')
        middles[index[key] - len(p)] = piece.point((a + b) / 2)
        found.append((i, j, index[key], piece.name, a, b, piece))
    return np.vstack([p, middles]), six, found


def assemble(gear, middle, others, teeth, whole):
    """Copies of one tooth's grid, turned beside each other and joined at their sides."""
    numbers = list(range(-((teeth - 1) // 2), teeth // 2 + 1))
    points, triangles, start = [], [], [0]
    for k in numbers:
        p, tri, _ = others if k else middle
        a = -k * gear.pitch                                     # tooth 1 stands to the right of tooth 0
        points.append(p @ np.array([[cos(a), sin(a)], [-sin(a), cos(a)]]))
        triangles.append(tri + start[-1])
        start.append(start[-1] + len(p))
    points, triangles = np.vstack(points), np.vstack(triangles)
    # Nodes in the same place become one.
    pairs = cKDTree(points).query_pairs(1e-7 * gear.module, output_type='ndarray')
    name = np.arange(len(points))
    for a, b in np.sort(pairs, axis=1):
        name[b] = min(name[b], name[a])
    name = name[name]
    kept, new = np.unique(name, return_inverse=True)
    cut = 2 * len([e for e in others[2] if e[3] == 'side']) + 1
    if len(points) - len(kept) != cut * (len(numbers) - (0 if whole else 1)):
        raise ValueError('the sectors do not fit each other')
    grid = Grid(points[kept], new[triangles])
    sides, rim = set(), set()
    for place, k in enumerate(numbers):
        for a, b, mid, what, t0, t1, piece in (others if k else middle)[2]:
            nodes = [int(new[v + start[place]]) for v in (a, b, mid)]
            if what == 'rim':
                rim.update(nodes)
            elif what.startswith('side'):
                last = (what == 'side' and place == teeth - 1) or (what == 'side-' and place == 0)
                if last and not whole:
                    sides.update(nodes)
            else:
                grid.edges.append((*nodes, what, k, t0, t1, piece))
    grid.sides, grid.rim = np.array(sorted(sides), int), np.array(sorted(rim), int)
    return grid
