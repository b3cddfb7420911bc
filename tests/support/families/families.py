# SPDX-License-Identifier: Apache-2.0
"""Families of piecewise linear systems that are valid for their doubles.

make(family, seed) is one of them; the same arguments give the same one.  Facets of more
than three vertices are rectangles in a plane of two axes or of the z axis, so flat
whatever the coordinates; all others are triangles.  Where construction alone does not
say that nothing clashes, exact.py does, and the maker draws again."""

import math
import random

import complexes
import exact
from pls import Pls

FAMILIES = {}
DRAWS = 200  # more have never been needed


def family(function):
    FAMILIES[function.__name__.replace("_", "-")] = function
    return function


def make(name, seed):
    rng = random.Random(f"{name} {seed}")
    for _ in range(DRAWS):
        pls = FAMILIES[name](rng)
        if pls is not None:
            return pls
    raise RuntimeError(f"{name}: no valid system in {DRAWS} draws")


# ---- materials of tetrahedral complexes and of voxels -------------------------------

def materials(rng, cells, n=None):
    label = rng.choice((complexes.blob_labels, complexes.random_labels))
    labels = label(rng, cells, n or rng.randrange(1, 5), rng.random() < 0.4)
    return complexes.interfaces(rng, cells, labels, keep_unused=rng.random() < 0.5)


@family
def interfaces(rng):
    return materials(rng, complexes.random_tetrahedra(rng, rng.randrange(2, 40), 0))


@family
def interfaces_weighted(rng):
    return materials(rng, complexes.random_tetrahedra(rng, rng.randrange(2, 40), 10 ** rng.uniform(-3, -1)))


@family
def interfaces_random(rng):
    """Flipped away from Delaunay, each tetrahedron of a material of its own choice."""
    cells = complexes.random_tetrahedra(rng, rng.randrange(2, 25), rng.choice((0, 0.02)))
    cells = complexes.flip_at_random(rng, cells, 4 * len(cells.points))
    labels = complexes.random_labels(rng, cells, rng.randrange(1, 4), rng.random() < 0.4)
    return complexes.interfaces(rng, cells, labels)


def moved(cells, change):
    return complexes.Cells([tuple(change(p)) for p in cells.points], cells.cells, cells.faces)


def squeeze(rng, cells, share):
    axis = rng.randrange(3)
    return moved(cells, lambda p: (x * share if k == axis else x for k, x in enumerate(p)))


@family
def interfaces_squeezed(rng):
    cells = complexes.random_tetrahedra(rng, rng.randrange(2, 30), rng.choice((0, 0.01)))
    cells = squeeze(rng, cells, rng.choice((1e-2, 1e-3, 1e-4, 1e-5)))
    return materials(rng, cells) if complexes.is_valid(cells) else None


def shifted(rng, cells):
    offset = [rng.choice((-1, 0, 1)) * 1e6 * rng.choice((1, 1.1, 0.123456789)) for _ in range(3)]
    cells = moved(cells, lambda p: (x + o for x, o in zip(p, offset)))
    pls = materials(rng, cells) if complexes.is_valid(cells) else None
    if pls:
        pls.volume = None  # Steiner points round by 1e-10 of the size
    return pls


@family
def interfaces_shifted(rng):
    return shifted(rng, complexes.random_tetrahedra(rng, rng.randrange(2, 30), rng.choice((0, 0.01))))


@family
def interfaces_far(rng):
    """Squeezed and shifted: doubles are 1e-10 apart where the sizes are 1 and down to 1e-5."""
    cells = complexes.random_tetrahedra(rng, rng.randrange(2, 15), rng.choice((0, 0.01)))
    return shifted(rng, squeeze(rng, cells, rng.choice((1e-2, 1e-3, 1e-4, 1e-5))))


def kuhn(rng, most=27):
    n = [rng.randrange(1, 5) for _ in range(3)]
    while n[0] * n[1] * n[2] > most:
        n[rng.randrange(3)] = 1
    return n, complexes.kuhn_grid(n, (1.0, 1.0, 1.0))


@family
def interfaces_kuhn(rng):
    """All the corners of a cube are on one sphere."""
    return materials(rng, kuhn(rng)[1])


@family
def interfaces_jittered(rng):
    n, cells = kuhn(rng)
    return materials(rng, complexes.jitter(rng, cells, n, (1.0, 1.0, 1.0), 10 ** rng.uniform(-17, 0)))


def sheared(rng, shares, most):
    """Kuhn grids sheared by more than their size, exactly or with rounding, and squeezed."""
    _, cells = kuhn(rng, most)
    a, b = (rng.choice((k / 8, 3.0, rng.uniform(-4, 4))) for k in (3, 5))
    cells = moved(cells, lambda p: (p[0] + a * p[2], p[1] + b * p[2], p[2]))
    cells = squeeze(rng, cells, rng.choice(shares))
    return materials(rng, cells) if complexes.is_valid(cells) else None


@family
def interfaces_sheared(rng):
    return sheared(rng, (1, 0.25, 0.1), 27)


@family
def interfaces_flattened(rng):
    return sheared(rng, (1e-3, 1e-5), 8)


@family
def voxels(rng):
    exactly = rng.random() < 0.5
    lines = []
    for _ in range(3):
        line = [0.0]
        for _ in range(rng.randrange(1, 5)):
            line.append(line[-1] + (1.0 if exactly else 10 ** rng.uniform(-2, 0)))
        lines.append(line)
    cells = complexes.box_grid(lines)
    label = rng.choice((complexes.blob_labels, complexes.random_labels))
    labels = label(rng, cells, rng.randrange(1, 4), rng.random() < 0.6)
    return complexes.interfaces(rng, cells, labels, split_quads=rng.random() < 0.3)


# ---- boxes ---------------------------------------------------------------------------

def middle(low, high):
    return tuple((a + b) / 2 for a, b in zip(low, high))


def box_size(low, high):
    return (high[0] - low[0]) * (high[1] - low[1]) * (high[2] - low[2])


@family
def boxes_nested(rng):
    """Boxes in each other, as thin shells or not, each a hole, a region or nothing said."""
    pls = Pls()
    low, high = (0.0, 0.0, 0.0), tuple(rng.choice((1.0, 2.0, 7.5)) for _ in range(3))
    sizes, kinds = [], []
    for depth in range(rng.randrange(1, 6)):
        pls.add_box(low, high, marker=1 + 6 * depth)
        sizes.append(box_size(low, high))
        wall = [min(h - a for a, h in zip(low, high)) * rng.choice((0.25, 0.1, 0.01, 1e-3)) for _ in range(6)]
        inner_low = tuple(a + wall[k] for k, a in enumerate(low))
        inner_high = tuple(h - wall[3 + k] for k, h in enumerate(high))
        kinds.append(rng.choice(("hole", "region", "")) if depth else rng.choice(("region", "")))
        between = tuple((a + b) / 2 for a, b in zip(low, inner_low))  # in the wall; in the last box, too
        if kinds[-1] == "hole":
            pls.holes.append(between)
        elif kinds[-1] == "region":
            pls.regions.append((*between, depth + 1))
        low, high = inner_low, inner_high
    sizes.append(0.0)
    pls.volume = sum(sizes[i] - sizes[i + 1] for i, kind in enumerate(kinds) if kind != "hole")
    return pls


@family
def boxes_touching(rng):
    """A box with smaller ones on some of its walls, inside or outside: a piece of the wall
    is a polygon of its facet, or a hole of it that joins the two."""
    pls = Pls()
    high = (4.0, 4.0, 4.0)
    pls.add_box((0.0, 0.0, 0.0), high, marker=1)
    facet_of = list(range(6))
    pls.volume = 64.0
    for side in sorted(rng.sample(range(6), rng.randrange(1, 5))):
        axis, up = side // 2, side % 2
        inwards = rng.random() < 0.5
        depth = rng.choice((0.5, 0.0625)) if inwards else rng.choice((1.0, 0.01))
        low, top = [0.0] * 3, [0.0] * 3
        for k in range(3):
            low[k] = 1.0 + rng.choice((0, 0.25, 0.123))
            top[k] = 3.0 - rng.choice((0, 0.25, 0.123))
        wall = 4.0 * up
        low[axis], top[axis] = sorted((wall, wall + depth * (1 if bool(up) != inwards else -1)))
        opposite = side if inwards else side ^ 1  # the small box's side that lies on the wall
        small = pls.add_box(low, top, marker=10 * side + 10, skip=(opposite,))
        on_wall = [small[i] for i in complexes.BOX_SIDES[opposite]]
        joined = rng.random() < 0.4
        pls.facets[facet_of[side]].polygons.append(on_wall)
        seed = middle(low, top)
        patch = list(seed)
        patch[axis] = wall
        if joined:
            pls.facets[facet_of[side]].holes.append(tuple(patch))
        if not inwards:
            pls.volume += box_size(low, top)
        elif joined:
            pls.volume -= box_size(low, top)  # a dent
        if not joined and rng.random() < 0.6:
            if inwards and rng.random() < 0.5:
                pls.holes.append(seed)
                pls.volume -= box_size(low, top)
            else:
                pls.regions.append((*seed, side + 2))
    return pls


# ---- small angles --------------------------------------------------------------------

def around(pls, low, high):
    """A box round everything."""
    pls.add_box(low, high, marker=1)
    pls.volume = box_size(low, high)


@family
def pages(rng):
    """Rectangles that share a spine, under angles from 20 down to 0.01 degrees."""
    pls = Pls()
    angle = math.radians(20 * (0.01 / 20) ** rng.random())
    height, n = rng.choice((1.0, 0.3, 5.0)), rng.randrange(2, 6)
    start = rng.uniform(0, 2 * math.pi)
    foot, head = pls.add_point(0, 0, 0), pls.add_point(0, 0, height)
    for i in range(n):
        radius = rng.choice((1.0, 1.0, rng.uniform(0.5, 1)))
        x, y = radius * math.cos(start + i * angle), radius * math.sin(start + i * angle)
        pls.add_facet((foot, pls.add_point(x, y, 0), pls.add_point(x, y, height), head), marker=100 + i)
    around(pls, (-2.0, -2.0, -1.0), (2.0, 2.0, height + 1))
    return pls if clean(pls) else None


@family
def wedge(rng):
    """A prism with one edge as sharp as the pages."""
    pls = Pls()
    angle = math.radians(20 * (0.01 / 20) ** rng.random())
    height, turn = rng.choice((1.0, 0.1, 5.0)), rng.uniform(0, 2 * math.pi)
    corners = [(0.0, 0.0)] + [(math.cos(a), math.sin(a)) for a in (turn, turn + angle)]
    n = len(corners)
    v = [pls.add_point(x, y, z) for z in (0.0, height) for x, y in corners]
    pls.add_facet([v[2], v[1], v[0]], marker=1)
    pls.add_facet(v[3:], marker=2)
    for i in range(n):
        j = (i + 1) % n
        pls.add_facet((v[i], v[j], v[n + j], v[n + i]), marker=3 + i)
    pls.shell = True
    return pls


@family
def star(rng):
    """Segments from one point, one of them with a vertex close below it (Fig. 5.9)."""
    pls = Pls()
    centre = pls.add_point(0, 0, 0)
    spread = rng.choice((math.pi, 0.5, 0.05))
    for i in range(rng.randrange(3, 25)):
        z = 1 - rng.random() * (1 - math.cos(spread))
        phi, r = rng.uniform(0, 2 * math.pi), math.sqrt(1 - z * z)
        end = pls.add_point(r * math.cos(phi), r * math.sin(phi), z)
        pls.add_facet((centre, end))
    x, y, z = pls.points[1]
    share, below = 2 / 3 - 10 ** rng.uniform(-8, -1), 10 ** rng.uniform(-9, -2)
    pls.add_point(share * x, share * y, share * z - below)
    around(pls, (-2.0, -2.0, -2.0), (2.0, 2.0, 2.0))
    return pls if clean(pls) else None


@family
def layers(rng):
    """Parallel rectangles under a cluster of points (Fig. 5.15)."""
    pls = Pls()
    gap = rng.choice((0.1, 0.01, 1e-3, 1e-4))
    n = rng.randrange(1, 8)
    for i in range(n):
        z = -i * gap
        pls.add_facet([pls.add_point(x, y, z) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))], marker=100 + i)
    size = 10 ** rng.uniform(-3, -0.5)
    for _ in range(rng.randrange(5, 60)):
        x, y, z = (rng.uniform(-1, 1) * size for _ in range(3))
        pls.add_point(x, y, size + gap + z)
    pls.add_point(0, 0, -n * gap)
    around(pls, (-2.0, -2.0, -2.0), (2.0, 2.0, 2.0))
    return pls


@family
def needles(rng):
    """Tetrahedra as long as 1 and as thin as 1e-6, apart or from a common tip."""
    pls = Pls()
    tip = pls.add_point(0, 0, 0) if rng.random() < 0.5 else None
    holes = 0.0
    for i in range(rng.randrange(1, 7)):
        width = 10 ** rng.uniform(-6, -1)
        base = [rng.uniform(-1, 1) for _ in range(3)]
        first = len(pls.points)
        a = tip if tip is not None else pls.add_point(*(rng.uniform(-1, 1) for _ in range(3)))
        b, c, d = (pls.add_point(*(x + width * rng.uniform(-1, 1) for x in base)) for _ in range(3))
        faces = ((b, c, d), (a, c, b), (a, d, c), (a, b, d))
        before = pls.simplices()
        x = exact.scaled(pls.points)
        if exact.orient(x[a], x[b], x[c], x[d]) == 0 or exact.clash(x, before + list(faces)):
            del pls.points[first:]
            continue
        for f in faces:
            pls.add_facet(f, marker=100 + i)
        cell = (a, b, c, d) if exact.orient(x[a], x[b], x[c], x[d]) > 0 else (b, a, c, d)
        seed = complexes.seed_inside(cell, pls.points)
        kind = rng.randrange(3) if seed else 0
        if kind == 1:
            pls.holes.append(seed)
            holes += complexes.size_of(pls.points, cell)
        elif kind == 2:
            pls.regions.append((*seed, i + 2))
    alone = rng.random() < 0.2 and tip is None and len(pls.facets) >= 4
    if alone:  # the first one alone
        pls.facets, pls.holes, pls.regions, pls.shell = pls.facets[:4], [], [], True
        pls.facets[0].polygons[0].reverse()  # no orientation, no volume: the judge's doubles do not hold that small ones
        complexes.drop_unused(pls)
        return pls
    around(pls, (-2.0, -2.0, -2.0), (2.0, 2.0, 2.0))
    pls.volume -= holes
    return pls if pls.facets else None


# ---- polyhedra that no tetrahedralization without Steiner points has -------------------

def clean(pls):
    """Whether nothing clashes: for facets that are convex polygons, each with its own plane."""
    return exact.clash(exact.scaled(pls.points), pls.simplices()) is None


@family
def schoenhardt(rng):
    """A prism over a regular polygon, twisted so that the diagonals of its sides go in."""
    pls = Pls()
    n = rng.randrange(3, 9)
    twist = rng.choice((1, -1)) * (10 ** rng.uniform(-6, 0)) * 0.9 * math.pi / n
    height, radius = rng.choice((1.0, 0.1, 10.0)), rng.choice((1.0, 0.5, 2.0))
    low = [pls.add_point(math.cos(2 * math.pi * i / n), math.sin(2 * math.pi * i / n), 0) for i in range(n)]
    high = [pls.add_point(radius * math.cos(2 * math.pi * i / n + twist), radius * math.sin(2 * math.pi * i / n + twist), height)
            for i in range(n)]
    pls.add_facet(low[::-1], marker=1)
    pls.add_facet(high, marker=2)
    for i in range(n):
        j = (i + 1) % n
        a, b, c, d = low[i], low[j], high[j], high[i]
        if twist > 0:  # the diagonal that goes in
            pls.add_facet((a, b, c), marker=3)
            pls.add_facet((a, c, d), marker=4)
        else:
            pls.add_facet((a, b, d), marker=3)
            pls.add_facet((b, c, d), marker=4)
    pls.shell = True
    return pls if clean(pls) else None


def chazelle_sides(pls, n, floor, width, lift, height):
    """The points of the notches from below (up=False) or above: (foot left, foot right,
    ridge) at both ends."""
    rows = []
    for i in range(n):
        ends = []
        for far in (0.0, n + 1.0):
            at = i + 1.0
            ends.append([pls.add_point(*lift(at - width, far, floor)), pls.add_point(*lift(at + width, far, floor)),
                         pls.add_point(*lift(at, far, height(at, far)))])
        rows.append(ends)
    return rows


@family
def chazelle(rng):
    """A box with wedges cut in from below and above, up to the hyperbolic paraboloids z = xy
    and z = xy + epsilon (Fig. 1.6)."""
    pls = Pls()
    n = rng.randrange(1, 5)
    epsilon, width = 10 ** rng.uniform(-4, -0.5), rng.choice((0.3, 0.1, 0.01))
    side, low, high = n + 1.0, -(n + 2.0), (n + 1.0) ** 2 + n + 2
    below = chazelle_sides(pls, n, low, width, lambda a, b, z: (b, a, z), lambda a, b: a * b)
    above = chazelle_sides(pls, n, high, width, lambda a, b, z: (a, b, z), lambda a, b: a * b + epsilon)
    v = [pls.add_point(side * (i & 1), side * (i >> 1 & 1), high if i >> 2 else low) for i in range(8)]
    for rows, marker in ((below, 10), (above, 20)):
        for near, far in rows:
            for k in (0, 1):
                pls.add_facet((near[k], far[k], far[2]), marker=marker)
                pls.add_facet((near[k], far[2], near[2]), marker=marker + 1)
    for rows, c0, c1, c2, c3, marker in ((below, 0, 1, 2, 3, 1), (above, 4, 6, 5, 7, 2)):
        left = [(v[c0], v[c1])] + [(near[1], far[1]) for near, far in rows]
        right = [(near[0], far[0]) for near, far in rows] + [(v[c2], v[c3])]
        for (a, b), (c, d) in zip(left, right):
            pls.add_facet((a, b, d, c), marker=marker)

    def bite(rows, end):
        return [w for ends in rows for w in (ends[end][0], ends[end][2], ends[end][1])]

    pls.add_facet([v[0], *bite(below, 0), v[2], v[6], v[4]], marker=3)
    pls.add_facet([v[1], *bite(below, 1), v[3], v[7], v[5]], marker=4)
    pls.add_facet([v[4], *bite(above, 0), v[5], v[1], v[0]], marker=5)
    pls.add_facet([v[6], *bite(above, 1), v[7], v[3], v[2]], marker=6)
    walls = pls.facets[-4:]
    del pls.facets[-4:]
    inner = clean(pls)  # the walls are not convex, and in planes of their own
    pls.facets += walls
    pls.shell = True
    return pls if inner else None


# ---- round things ----------------------------------------------------------------------

GOLD = (1 + 5 ** 0.5) / 2
ICOSAHEDRON = [p for a in (-1, 1) for b in (-GOLD, GOLD) for p in ((0, a, b), (a, b, 0), (b, 0, a))]


def sphere(pls, radius, rounds, marker):
    points = [tuple(map(float, p)) for p in ICOSAHEDRON]
    faces = []
    for a in range(12):
        for b in range(a + 1, 12):
            for c in range(b + 1, 12):
                if all(abs(math.dist(points[i], points[j]) - 2) < 1e-9 for i, j in ((a, b), (b, c), (a, c))):
                    faces.append((a, b, c) if exact.dot(exact.cross(points[a], points[b]), points[c]) > 0 else (a, c, b))
    halves = {}

    def half(i, j):
        if (min(i, j), max(i, j)) not in halves:
            halves[min(i, j), max(i, j)] = len(points)
            points.append(tuple((x + y) / 2 for x, y in zip(points[i], points[j])))
        return halves[min(i, j), max(i, j)]

    for _ in range(rounds):
        halves.clear()
        split = []
        for a, b, c in faces:
            d, e, f = half(a, b), half(b, c), half(c, a)
            split += [(a, d, f), (b, e, d), (c, f, e), (d, e, f)]
        faces = split
    first = len(pls.points)
    for p in points:
        size = math.sqrt(exact.dot(p, p))
        pls.add_point(*(radius * x / size for x in p))
    for f in faces:
        pls.add_facet([first + i for i in f], marker=marker)


@family
def spheres(rng):
    """Concentric ones, the largest 10 to 1000 times the smallest."""
    pls = Pls()
    ratio, n = 10 ** rng.uniform(1, 3), rng.randrange(2, 4)
    rounds = [rng.randrange(0, 3) for _ in range(n)]
    while sum(rounds) > 3:
        rounds[rng.randrange(n)] = 0
    radii = [ratio ** (-i / (n - 1)) for i in range(n)]
    for i, r in enumerate(radii):
        sphere(pls, r, rounds[i], 10 + i)
    if rng.random() < 0.5:
        pls.holes.append((0.0, 0.0, 0.0))
    elif rng.random() < 0.5:
        pls.regions.append((0.0, 0.0, 0.0, 7))
    return pls


@family
def line_and_circle(rng):
    """Points on a line through points on a circle, as points, segments or a facet."""
    pls = Pls()
    n, m = rng.randrange(4, 40), rng.randrange(2, 20)
    kind = rng.choice(("points", "segments", "facet"))
    ring = [pls.add_point(math.cos(2 * math.pi * i / n), math.sin(2 * math.pi * i / n), 0) for i in range(n)]
    centre = [pls.add_point(0, 0, (i - m) / m) for i in range(2 * m + 1)]
    if kind == "facet":
        pls.add_facet(ring, (centre[m],), marker=100)
    elif kind == "segments":
        for i in range(n):
            pls.add_facet((ring[i - 1], ring[i]))
    if kind != "points":
        for a, b in zip(centre, centre[1:]):
            pls.add_facet((a, b))
    around(pls, (-2.0, -2.0, -2.0), (2.0, 2.0, 2.0))
    return pls


# ---- loose parts -------------------------------------------------------------------------

@family
def loose(rng):
    """Segments and points in the facets of a box, on them, and in the volume."""
    pls = Pls()
    pls.add_box((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
    pls.volume = 1.0
    for side in range(6):
        axis, wall = side // 2, float(side % 2)
        drawn = []
        for _ in range(rng.randrange(0, 5)):
            ends = [[rng.choice((rng.uniform(0.05, 0.95), rng.randrange(1, 8) / 8)) for _ in range(3)] for _ in range(rng.choice((1, 2, 2)))]
            for p in ends:
                p[axis] = wall
            trial = drawn + [ends]
            points = [p for part in trial for p in part]
            if ends[0] == ends[-1] and len(ends) == 2 or not apart(points, trial):
                continue
            drawn.append(ends)
            numbers = [pls.add_point(*p) for p in ends]
            if len(ends) == 2 and rng.random() < 0.3:
                pls.add_facet(numbers)  # on the facet, but not of it
            else:
                pls.facets[side].polygons.append(numbers)
    walls = [p for p in range(8, len(pls.points))]
    inner = []
    for _ in range(rng.randrange(0, 12)):
        p = tuple(rng.uniform(0.1, 0.9) for _ in range(3))
        q = rng.choice((tuple(rng.uniform(0.1, 0.9) for _ in range(3)), None))
        start = rng.choice(walls) if walls and q and rng.random() < 0.3 else None
        ends = [p] if q is None else [pls.points[start] if start is not None else p, q]
        if not apart([x for part in inner + [ends] for x in part], inner + [ends]):
            continue
        inner.append(ends)
        if q is None:
            pls.add_point(*p)
        else:
            a = start if start is not None else pls.add_point(*p)
            pls.add_facet((a, pls.add_point(*q)))
    return pls


@family
def turned(rng):
    """A lattice of points in a box, turned: all but cospherical, and tetrahedra flat but for the last bits."""
    pls = Pls()
    pls.add_box((-1.0, -1.0, -1.0), (1.0, 1.0, 1.0))
    pls.volume = 8.0
    n = [rng.randrange(2, 6) for _ in range(3)]
    step = tuple(rng.choice((1.0, 1.0, rng.uniform(0.7, 1))) for _ in range(3))
    a, b, c = (rng.uniform(0, 2 * math.pi) for _ in range(3))
    turn = ((math.cos(b) * math.cos(c), math.sin(a) * math.sin(b) * math.cos(c) - math.cos(a) * math.sin(c),
             math.cos(a) * math.sin(b) * math.cos(c) + math.sin(a) * math.sin(c)),
            (math.cos(b) * math.sin(c), math.sin(a) * math.sin(b) * math.sin(c) + math.cos(a) * math.cos(c),
             math.cos(a) * math.sin(b) * math.sin(c) - math.sin(a) * math.cos(c)),
            (-math.sin(b), math.sin(a) * math.cos(b), math.cos(a) * math.cos(b)))
    for i in range(math.prod(n)):
        at = (i % n[0], i // n[0] % n[1], i // n[0] // n[1])
        x = [s * (k - (m - 1) / 2) * 0.2 for s, k, m in zip(step, at, n)]
        pls.add_point(*(sum(r * y for r, y in zip(row, x)) for row in turn))
    return pls


def apart(points, parts):
    """Whether segments and points, as lists of coordinates, do not meet."""
    x = exact.scaled(points)
    spans, n = [], 0
    for part in parts:
        spans.append(x[n:n + len(part)])
        n += len(part)
    return not any(exact.segments_meet(a[0], a[-1], b[0], b[-1]) for i, a in enumerate(spans) for b in spans[:i])
