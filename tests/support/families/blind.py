# SPDX-License-Identifier: Apache-2.0
"""Where the judge cannot tell: it takes a face for a part of a facet from which it is less
than eight units in the last place of the largest coordinate away, which is its least
tolerance; but facets may be nearer to each other than that, where one axis is squeezed and another is
far from 0.  Here distances are exact."""

import fractions
import itertools

import exact

LEAST = 8 * 2.3e-16  # the judge's, as part of the largest coordinate
ROUNDED = 2.0 ** -53  # rounding moves a coordinate by no more than this part of its axis's largest
KINDS = ("facets not covered", "subfaces not listed")


def table(path):
    with open(path, encoding="ascii") as f:
        return [line.split() for line in f if line.strip() and not line.startswith("#")][1:]


def _segment_distance(p, a, b):
    u, w = exact.minus(b, a), exact.minus(p, a)
    t = min(max(fractions.Fraction(exact.dot(w, u), exact.dot(u, u)), 0), 1)
    d = tuple(x - t * y for x, y in zip(w, u))
    return exact.dot(d, d)


def _normal(t):
    return exact.cross(exact.minus(t[1], t[0]), exact.minus(t[2], t[0]))


def _may_be_in_plane(p, t, moved):
    """Whether p is in the plane of t, but for rounding, by which coordinates moved."""
    n = _normal(t)
    return abs(exact.dot(exact.minus(p, t[0]), n)) <= sum(abs(a) * m for a, m in zip(n, moved))


def _distance(p, t):
    """Squared, between a point and a triangle."""
    n = _normal(t)
    sides = [exact.dot(exact.cross(exact.minus(t[i - 2], t[i]), exact.minus(p, t[i])), n) for i in range(3)]
    if all(s >= 0 for s in sides):
        return fractions.Fraction(exact.dot(exact.minus(p, t[0]), n) ** 2) / exact.dot(n, n)
    return min(_segment_distance(p, t[i], t[i - 1]) for i in range(3))


def _is_far(p, t, room):
    """Whether p is surely more than `room` from the triangle: from its box, or its plane.  In doubles, of places near the
    origin."""
    if any(p[k] < min(c[k] for c in t) - room or p[k] > max(c[k] for c in t) + room for k in range(3)):
        return True
    n = _normal(t)
    return abs(exact.dot(exact.minus(p, t[0]), n)) > room * exact.dot(n, n) ** 0.5


def cannot_tell(faults, pls, prefix):
    """Whether the judge's faults (its words) are all due to faces that lie on no facet but within its
    tolerance of one.  That all facets are covered the engine's own exact audit says."""
    if not all(f.strip(' "').startswith(KINDS) for f in faults):
        return False
    nodes = [tuple(map(float, r[1:4])) for r in table(f"{prefix}.node")]
    x = [tuple(map(fractions.Fraction, p)) for p in nodes]
    facets = [[x[v] for v in s] for s in pls.simplices() if len(s) == 3]  # input vertices come first
    largest = [max(abs(p[k]) for p in nodes) for k in range(3)]
    near = fractions.Fraction(LEAST * max(largest)) ** 2
    moved = [fractions.Fraction(ROUNDED * c) for c in largest]
    listed = {tuple(sorted(map(int, r[1:4]))) for r in table(f"{prefix}.face")}
    faces = {f for r in table(f"{prefix}.ele") for f in itertools.combinations(sorted(map(int, r[1:5])), 3)} - listed
    near_origin = [tuple(float(a - b) for a, b in zip(p, x[0])) for p in x]
    near_facets = [tuple(tuple(float(a - b) for a, b in zip(p, x[0])) for p in t) for t in facets]
    room = 10 * float(near) ** 0.5
    found = False
    for face in faces:
        corners = [x[v] for v in face]
        middle = tuple(sum(c) / 3 for c in zip(*corners))
        about = tuple(sum(near_origin[v][k] for v in face) / 3 for k in range(3))
        for t, there in zip(facets, near_facets):
            if _is_far(about, there, room) or _distance(middle, t) > near:
                continue
            if all(_may_be_in_plane(p, t, moved) for p in corners):
                return False
            found = True
    return found
