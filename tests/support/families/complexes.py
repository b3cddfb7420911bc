# SPDX-License-Identifier: Apache-2.0
"""Complexes of cells (tetrahedra, boxes) and the interfaces between their materials.

A complex of tetrahedra fills a box.  It is valid for its doubles if each tetrahedron is
positive and the faces on the box's sides do not clash: a piecewise linear map of a ball
that keeps every orientation, and is one to one on the border, is one to one.  Whatever
happened to the coordinates, this is what is checked, in exact arithmetic."""

import itertools

import exact
from pls import BOX_SIDES, Pls

OUTSIDE = 0  # a label: what is not the domain, on the hull's far side and inside
TET_FACES = ((1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1))


class Cells:
    """Points and cells; faces[i] are the local faces of each cell."""

    def __init__(self, points, cells, faces):
        self.points, self.cells, self.faces = points, cells, faces

    def borders(self):
        """Each face, as sorted vertices, to its (cell, vertices in order) on one side or both."""
        found = {}
        for c, cell in enumerate(self.cells):
            for face in self.faces:
                v = [cell[i] for i in face]
                found.setdefault(tuple(sorted(v)), []).append((c, v))
        return found


def kuhn_cube(corner):
    """The six tetrahedra of a cube around the diagonal; corner maps (i, j, k) of 0 and 1."""
    for path in itertools.permutations(range(3)):
        at, cell = [0, 0, 0], [corner((0, 0, 0))]
        for axis in path:
            at[axis] = 1
            cell.append(corner(tuple(at)))
        odd = path in ((0, 2, 1), (1, 0, 2), (2, 1, 0))
        yield (cell[0], cell[2], cell[1], cell[3]) if odd else tuple(cell)


def kuhn_grid(n, step):
    """A grid of n[0] x n[1] x n[2] cubes, all of whose corners are on common spheres."""
    number = {}
    points = []
    for k, j, i in itertools.product(range(n[2] + 1), range(n[1] + 1), range(n[0] + 1)):
        number[i, j, k] = len(points)
        points.append((i * step[0], j * step[1], k * step[2]))
    cells = [tet for k, j, i in itertools.product(range(n[2]), range(n[1]), range(n[0]))
             for tet in kuhn_cube(lambda d, at=(i, j, k): number[at[0] + d[0], at[1] + d[1], at[2] + d[2]])]
    return Cells(points, cells, TET_FACES)


def box_grid(lines):
    """Boxes between the given x, y and z."""
    n = [len(x) for x in lines]
    points = [(x, y, z) for z in lines[2] for y in lines[1] for x in lines[0]]
    cells = []
    for k, j, i in itertools.product(range(n[2] - 1), range(n[1] - 1), range(n[0] - 1)):
        cells.append(tuple((k + (c >> 2)) * n[0] * n[1] + (j + (c >> 1 & 1)) * n[0] + i + (c & 1) for c in range(8)))
    return Cells(points, cells, BOX_SIDES)


def random_tetrahedra(rng, n, weight, side=1 << 20):
    """A regular (weighted Delaunay) tetrahedralization of a cube's corners and of up to n
    random points, by insertion; weight: the largest, as part of side^2."""
    corners = [(side * (i & 1), side * (i >> 1 & 1), side * (i >> 2)) for i in range(8)]
    points = list(corners)
    lift = dict.fromkeys(corners, 0)
    cells = list(kuhn_cube(lambda d: d[0] + 2 * d[1] + 4 * d[2]))
    for _ in range(n):
        p = tuple(rng.randrange(1, side) for _ in range(3))
        if p in lift:
            continue
        lift[p] = int(rng.random() * weight * side * side)
        seen = [t for t in cells if exact.power(*(points[v] for v in t), p, lift) > 0]
        border = {}
        for t in seen:
            for face in TET_FACES:
                f = tuple(t[i] for i in face)
                border[tuple(sorted(f))] = None if tuple(sorted(f)) in border else f
        made = [(f[0], f[2], f[1], len(points)) for f in border.values() if f]
        before = sum(exact.orient(*(points[v] for v in t)) for t in seen)
        points.append(p)
        volumes = [exact.orient(*(points[v] for v in t)) for t in made]
        if not made or min(volumes) <= 0 or sum(volumes) != before:  # hidden by its weight, or not a star
            points.pop()
            continue
        gone = set(seen)
        cells = [t for t in cells if t not in gone] + made
    return Cells([tuple(x / side for x in p) for p in points], cells, TET_FACES)


def flip_at_random(rng, complex_, n):
    """Tries n 2-3 flips, away from any Delaunay property."""
    x = exact.scaled(complex_.points)
    cells = list(complex_.cells)
    for _ in range(n):
        t = rng.choice(cells)
        i = rng.randrange(4)
        face = [t[k] for k in TET_FACES[i]]
        others = [s for s in cells if s != t and all(v in s for v in face)]
        if not others:
            continue
        top, bottom = t[i], next(v for v in others[0] if v not in face)
        made = [(face[k], face[k - 2], top, bottom) for k in range(3)]
        made = [m if exact.orient(*(x[v] for v in m)) > 0 else (m[1], m[0], *m[2:]) for m in made]
        total = sum(exact.orient(*(x[v] for v in m)) for m in made)
        if total != sum(exact.orient(*(x[v] for v in m)) for m in (t, others[0])):
            continue
        if all(exact.orient(*(x[v] for v in m)) > 0 for m in made):
            cells = [s for s in cells if s not in (t, others[0])] + made
    return Cells(complex_.points, cells, TET_FACES)


def jitter(rng, grid, n, step, share):
    """Moves the inner vertices of a Kuhn grid, each as far as all tetrahedra stay positive."""
    points = list(grid.points)
    around = {}
    for t in grid.cells:
        for v in t:
            around.setdefault(v, []).append(t)
    for v, p in enumerate(grid.points):
        if any(p[k] in (0, n[k] * step[k]) for k in range(3)):
            continue
        points[v] = tuple(p[k] + share * step[k] * (rng.random() - 0.5) for k in range(3))
        if not are_positive(points, around[v]):
            points[v] = p
    return Cells(points, grid.cells, TET_FACES)


def are_positive(points, cells):
    used = sorted({v for t in cells for v in t})
    x = dict(zip(used, exact.scaled([points[v] for v in used])))
    return all(exact.orient(*(x[v] for v in t)) > 0 for t in cells)


def is_valid(complex_):
    """Whether the complex of tetrahedra is one for its doubles."""
    if not are_positive(complex_.points, complex_.cells):
        return False
    hull = [tuple(sides[0][1]) for sides in complex_.borders().values() if len(sides) == 1]
    return exact.clash(exact.scaled(complex_.points), hull) is None


def components(cells, borders, labels):
    """The number of each cell's connected part of one label; the part that goes on outside
    the hull, if any, is -1."""
    parent = list(range(len(cells) + 1))

    def root(c):
        while parent[c] != c:
            parent[c] = c = parent[parent[c]]
        return c

    for sides in borders.values():
        a = sides[0][0]
        b = sides[1][0] if len(sides) == 2 else len(cells)
        label_b = labels[b] if b < len(cells) else OUTSIDE
        if labels[a] == label_b:
            parent[root(a)] = root(b)
    return [-1 if root(c) == root(len(cells)) else root(c) for c in range(len(cells))]


def seed_inside(cell, points):
    """A point of doubles strictly inside the cell, or None."""
    middle = tuple(sum(points[v][k] for v in cell) / len(cell) for k in range(3))
    *corners, m = exact.scaled([points[v] for v in cell] + [middle])
    if len(cell) == 8:
        low, high = corners[0], corners[7]
        return middle if all(low[k] < m[k] < high[k] for k in range(3)) else None
    inside = all(exact.orient(*(m if i == k else corners[i] for i in range(4))) > 0 for k in range(4))
    return middle if inside else None


def size_of(points, cell):
    p = [points[v] for v in cell]
    if len(cell) == 8:
        return (p[7][0] - p[0][0]) * (p[7][1] - p[0][1]) * (p[7][2] - p[0][2])
    return exact.orient(*p) / 6


def interfaces(rng, complex_, labels, keep_unused=False, seeded=0.5, split_quads=False):
    """The PLS of the faces between cells of different labels.  Parts of label 0 that are shut
    in are holes; others get a region's seed by chance.  None where nothing is left."""
    borders = complex_.borders()
    part = components(complex_.cells, borders, labels)
    if all(label == OUTSIDE for label in labels):
        return None
    pls = Pls()
    pls.points = [tuple(map(float, p)) for p in complex_.points]
    for sides in borders.values():
        a, b = labels[sides[0][0]], labels[sides[1][0]] if len(sides) == 2 else OUTSIDE
        if a == b:
            continue
        v, marker = sides[0][1], 10 * min(a, b) + max(a, b)
        if len(v) == 4 and split_quads:
            i = rng.randrange(2)
            pls.add_facet((v[i], v[i + 1], v[i + 2]), marker=marker)
            pls.add_facet((v[i], v[i + 2], v[i - 1]), marker=marker)
        else:
            pls.add_facet(v, marker=marker)
    sizes = [size_of(pls.points, c) for c in complex_.cells]
    pls.volume = sum(s for s, label in zip(sizes, labels) if label != OUTSIDE)
    for number in sorted(set(part) - {-1}):
        biggest = max((c for c in range(len(part)) if part[c] == number), key=lambda c: sizes[c])
        seed = seed_inside(complex_.cells[biggest], pls.points)
        hole = labels[biggest] == OUTSIDE
        if seed is None and hole:
            return None
        if hole:
            pls.holes.append(seed)
        elif seed is not None and rng.random() < seeded:
            pls.regions.append((*seed, labels[biggest]))
    if not keep_unused:
        drop_unused(pls)
    return pls


def drop_unused(pls):
    used = sorted({v for f in pls.facets for p in f.polygons for v in p})
    number = {v: i for i, v in enumerate(used)}
    pls.points = [pls.points[v] for v in used]
    for f in pls.facets:
        f.polygons = [[number[v] for v in p] for p in f.polygons]


def blob_labels(rng, complex_, n, with_void):
    """Materials as the nearest of some random centres says."""
    low = [min(p[k] for p in complex_.points) for k in range(3)]
    high = [max(p[k] for p in complex_.points) for k in range(3)]
    first = 0 if with_void else 1
    centres = [([low[k] + rng.random() * (high[k] - low[k]) for k in range(3)], rng.randrange(first, n + 1)) for _ in range(2 * n)]
    labels = []
    for cell in complex_.cells:
        m = [sum(complex_.points[v][k] for v in cell) / len(cell) for k in range(3)]
        labels.append(min((sum((m[k] - c[k]) ** 2 for k in range(3)), label) for c, label in centres)[1])
    return labels


def random_labels(rng, complex_, n, with_void):
    return [rng.randrange(0 if with_void else 1, n + 1) for _ in complex_.cells]
