# SPDX-License-Identifier: Apache-2.0
"""Valid piecewise linear systems spoiled in one known way each, with the refusal that
is the right one.

spoil(pls, seed) returns (name of the way, the spoiled system, what is expected); a way
that does not apply to the system is not drawn.  An expectation is the set of statuses
that will do, and a rule that every listed offence obeys, or None where nothing need be
listed.  An offence is ((kind, number), (kind, number)): all that is wrong comes from the
spoiled element, so that each must name it."""

import math
import random

import exact

VERTEX, SEGMENT, FACET, HOLE, REGION = range(5)
WAYS = {}


class Expected:
    def __init__(self, statuses, rule=None):
        self.statuses, self.rule = statuses, rule


def way(function):
    WAYS[function.__name__.replace("_", "-")] = function
    return function


def names(kind, number):
    return lambda offence: (kind, number) in offence


def spoil(pls, seed, only=None):
    rng = random.Random(f"spoil {seed}")
    order = [only] if only else rng.sample(sorted(WAYS), len(WAYS))
    for name in order:
        for _ in range(8):
            spoiled = pls.copy()
            spoiled.volume = None
            expected = WAYS[name](rng, spoiled)
            if expected:
                return name, spoiled, expected
    return None


def some_polygon(rng, pls, least=3):
    """A (facet's number, polygon) of at least so many vertices, or None."""
    found = [(f, p) for f, facet in enumerate(pls.facets) for p in facet.polygons if len(p) >= least]
    return rng.choice(found) if found else None


def some_triangle(rng, pls):
    """A (facet's number, its vertices): a facet of one triangle, or None."""
    found = [(f, facet.polygons[0]) for f, facet in enumerate(pls.facets)
             if len(facet.polygons) == 1 and len(facet.polygons[0]) == 3]
    return rng.choice(found) if found else None


# ---- arrays ---------------------------------------------------------------------------

@way
def index_out_of_range(rng, pls):
    _, polygon = some_polygon(rng, pls, 1)
    polygon[rng.randrange(len(polygon))] = len(pls.points) + rng.choice((0, 1, 1000, 2**31))
    return Expected({"index"})


@way
def not_finite(rng, pls):
    v = rng.randrange(len(pls.points))
    p = list(pls.points[v])
    p[rng.randrange(3)] = rng.choice((math.nan, math.inf, -math.inf, 1e200, -1e300))
    pls.points[v] = tuple(p)
    return Expected({"not_finite"}, names(VERTEX, v))


@way
def seed_not_finite(rng, pls):
    pls.regions.append((0.0, math.nan, 0.0, 1))
    return Expected({"not_finite"}, names(REGION, len(pls.regions) - 1))


# ---- crossings -------------------------------------------------------------------------

def needle_through(rng, pls):
    """The number of a facet that is a triangle, and two points close to its middle, one on
    either side and exactly so."""
    found = some_triangle(rng, pls)
    if not found:
        return None
    f, t = found
    a, b, c = (pls.points[v] for v in t)
    normal = exact.cross(exact.minus(b, a), exact.minus(c, a))
    area = math.sqrt(exact.dot(normal, normal))
    longest = max(math.dist(a, b), math.dist(b, c), math.dist(c, a))
    if not area:
        return None
    step = 0.1 * area / longest  # a tenth of the least height
    m = [(a[k] + b[k] + c[k]) / 3 for k in range(3)]
    p, q = (tuple(m[k] + s * step * normal[k] / area for k in range(3)) for s in (1, -1))
    x = exact.scaled([a, b, c, p, q])
    if exact.orient(*x[:3], x[3]) * exact.orient(*x[:3], x[4]) >= 0:
        return None
    sides = [exact.orient(x[3], x[4], x[i], x[(i + 1) % 3]) for i in range(3)]
    through = all(s > 0 for s in sides) or all(s < 0 for s in sides)
    return (f, p, q, [u + step * w for u, w in zip(p, exact.minus(b, a))]) if through else None


@way
def crossing_facets(rng, pls):
    found = needle_through(rng, pls)
    if not found:
        return None
    _, p, q, r = found
    new = pls.add_facet([pls.add_point(*x) for x in (p, q, r)], marker=999)
    return Expected({"intersection"}, names(FACET, new))


@way
def crossing_segment(rng, pls):
    found = needle_through(rng, pls)
    if not found:
        return None
    _, p, q, _ = found
    new = pls.add_facet([pls.add_point(*x) for x in (p, q)], marker=999)
    return Expected({"intersection"}, names(FACET, new))


@way
def overlapping_facets(rng, pls):
    """A triangle that has another one's corner and goes on in its plane."""
    found = some_triangle(rng, pls)
    if not found:
        return None
    a, b, c = (pls.points[v] for v in found[1])
    d = tuple(2 * z - x for x, z in zip(a, c))
    x = exact.scaled([a, b, c, d])
    if any(w - v != v - u for u, v, w in zip(x[0], x[2], x[3])) or exact.orient(*x) or exact.collinear(*x[:3]):
        return None
    new = pls.add_facet([found[1][0], found[1][1], pls.add_point(*d)], marker=999)
    return Expected({"intersection"}, names(FACET, new))


@way
def overlapping_part(rng, pls):
    """Half of a rectangle as a facet of its own."""
    found = some_polygon(rng, pls, 4)
    if not found or len(pls.facets[found[0]].polygons) > 1 or len(found[1]) != 4:
        return None
    new = pls.add_facet(found[1][:3], marker=999)
    return Expected({"intersection"}, names(FACET, new))


@way
def crossing_segments(rng, pls):
    """The diagonals of a rectangle, without the point where they meet."""
    found = some_polygon(rng, pls, 4)
    if not found or len(pls.facets[found[0]].polygons) > 1 or len(found[1]) != 4:
        return None
    a, b, c, d = found[1]
    pls.facets[found[0]].polygons += [[a, c], [b, d]]
    return Expected({"intersection"}, names(FACET, found[0]))


# ---- polygons ----------------------------------------------------------------------------

@way
def degenerate_line(rng, pls):
    """A triangle of three points on a line."""
    _, polygon = some_polygon(rng, pls)
    a, b = (pls.points[v] for v in polygon[:2])
    m = tuple((x + y) / 2 for x, y in zip(a, b))
    if not exact.collinear(*exact.scaled([a, b, m])):
        return None
    new = pls.add_facet([polygon[0], pls.add_point(*m), polygon[1]], marker=999)
    return Expected({"degenerate"}, names(FACET, new))


@way
def empty_polygon(rng, pls):
    pls.facets[rng.randrange(len(pls.facets))].polygons.append([])
    return Expected({"argument"})


@way
def bent_polygon(rng, pls):
    """A facet of four corners, one of them far out of plane."""
    found = some_polygon(rng, pls)
    a, b, c = (pls.points[v] for v in found[1][:3])
    big = max(max(p[k] for p in pls.points) - min(p[k] for p in pls.points) for k in range(3))
    high = max(p[2] for p in pls.points) + 2 * big  # above everything
    corners = ((0, 0, 0), (big, 0, 0), (big, big, 0.1 * big), (0, big, 0))
    new = pls.add_facet([pls.add_point(a[0] + x, a[1] + y, high + z) for x, y, z in corners], marker=999)
    return Expected({"not_planar"}, names(FACET, new))


@way
def flat_world(rng, pls):
    """Everything in one plane."""
    axis = rng.randrange(3)
    pls.points = [tuple(1.0 if k == axis else x for k, x in enumerate(p)) for p in pls.points]
    return Expected({"degenerate"})


# ---- domain ------------------------------------------------------------------------------

@way
def open_shell(rng, pls):
    if not pls.shell:
        return None
    del pls.facets[rng.randrange(len(pls.facets))]
    return Expected({"open"})


@way
def all_holes(rng, pls):
    if not pls.shell or not pls.regions:
        return None
    pls.holes, pls.regions = [r[:3] for r in pls.regions], []
    return Expected({"open"})


def add_seed(rng, pls, x):
    if rng.random() < 0.5:
        pls.holes.append(x)
        return Expected({"seed"}, names(HOLE, len(pls.holes) - 1))
    pls.regions.append((*x, 1))
    return Expected({"seed"}, names(REGION, len(pls.regions) - 1))


@way
def seed_outside(rng, pls):
    far = [max(p[k] for p in pls.points) for k in range(3)]
    axis = rng.randrange(3)
    far[axis] += rng.choice((1e-6, 1.0, 1e9)) * max(abs(far[axis]), 1.0)
    return add_seed(rng, pls, tuple(far))


def on_hull(pls, t):
    """Whether all points are on one side of the plane of the polygon."""
    x = exact.scaled(pls.points)
    sides = [exact.orient(*(x[v] for v in t[:3]), y) for y in x]
    return all(s >= 0 for s in sides) or all(s <= 0 for s in sides)


@way
def seed_on_facet(rng, pls):
    """On a facet of the hull: in its middle, on a side of it, or at a corner."""
    found = some_polygon(rng, pls)
    if len(pls.facets[found[0]].polygons) > 1 or not on_hull(pls, found[1]):
        return None
    t = found[1][:3]
    a, b, c = (pls.points[v] for v in t)
    place = rng.choice(("middle", "side", "corner"))
    if place == "corner":
        return add_seed(rng, pls, a)
    x = tuple((u + v) / 2 for u, v in zip(a, b))
    if place == "side":
        return add_seed(rng, pls, x) if exact.collinear(*exact.scaled([a, b, x])) else None
    x = tuple((u + v) / 2 for u, v in zip(x, c))
    return add_seed(rng, pls, x) if not exact.orient(*exact.scaled([a, b, c, x])) else None
