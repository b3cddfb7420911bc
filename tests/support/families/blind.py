# SPDX-License-Identifier: Apache-2.0
"""Where the judge cannot tell: it takes a face for a part of a facet from which it is less
than eight units in the last place of the largest coordinate away, which is its least
tolerance; but facets may be nearer to each other than that, where one axis is squeezed and another is
far from 0.  Here distances are exact, and a Steiner point of a segment is in a plane where the segment is,
however near rounding has put it."""

import collections
import fractions
import itertools

import exact

LEAST = 8 * 2.3e-16  # the judge's, as part of the largest coordinate
ROUNDED = 2.0 ** -53  # rounding moves a coordinate by no more than this part of its axis's largest
MARKED = "subfaces with another facet's marker"
KINDS = ("facets not covered", "subfaces not listed", MARKED)


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


class _Mesh:
    """What the files of `prefix` say, exactly, with the system's triangles."""

    def __init__(self, pls, prefix):
        nodes = [tuple(map(float, r[1:4])) for r in table(f"{prefix}.node")]
        self.x = [tuple(map(fractions.Fraction, p)) for p in nodes]
        self.n_input = len(pls.points)  # they come first
        self.triangles = [(facet.marker, t) for facet in pls.facets for t in facet.triangles()]
        largest = [max(abs(p[k]) for p in nodes) for k in range(3)]
        self.near = LEAST * max(largest)
        self.moved = [fractions.Fraction(ROUNDED * c) for c in largest]
        self.subfaces = {tuple(sorted(map(int, r[1:4]))): int(r[4]) for r in table(f"{prefix}.face")}
        self.inner = {f for r in table(f"{prefix}.ele") for f in itertools.combinations(sorted(map(int, r[1:5])), 3)}
        self.inner -= self.subfaces.keys()
        self.on_facet = {v for f in self.subfaces for v in f}
        self.beside = collections.defaultdict(list)
        for r in table(f"{prefix}.edge"):
            a, b = map(int, r[1:3])
            self.beside[a].append(b)
            self.beside[b].append(a)
        self.near_origin = [self._moved_to_origin(p) for p in self.x]

    def _moved_to_origin(self, p):
        return tuple(float(a - b) for a, b in zip(p, self.x[0]))

    def _end(self, v, before):
        """The input vertex where a segment ends that comes from `before` to v."""
        while v >= self.n_input:
            before, v = v, next(w for w in self.beside[v] if w != before)
        return v

    def _may_be_in_plane(self, v, t):
        if not _may_be_in_plane(self.x[v], t, self.moved):
            return False
        if v >= self.n_input and v in self.beside:
            return all(_may_be_in_plane(self.x[self._end(w, v)], t, self.moved) for w in self.beside[v])
        return v < self.n_input or v in self.on_facet

    def near_triangles(self, face):
        """(marker, whether the face may be part of it) of the triangles that its middle is near."""
        middle = tuple(sum(c) / 3 for c in zip(*(self.x[v] for v in face)))
        about = tuple(sum(self.near_origin[v][k] for v in face) / 3 for k in range(3))
        for marker, corners in self.triangles:
            t = [self.x[v] for v in corners]
            if _is_far(about, [self.near_origin[v] for v in corners], 10 * self.near):
                continue
            if _distance(middle, t) <= fractions.Fraction(self.near) ** 2:
                yield marker, all(self._may_be_in_plane(v, t) for v in face)


def cannot_tell(faults, pls, prefix):
    """Whether the judge's faults (its words) are all due to faces that lie on no facet but within its
    tolerance of one, or to subfaces that are within it of another.  That all facets are covered the engine's own exact
    audit says."""
    faults = [f.strip(' "') for f in faults]
    if not all(f.startswith(KINDS) for f in faults):
        return False
    mesh = _Mesh(pls, prefix)
    near = [is_part for face in mesh.inner for _, is_part in mesh.near_triangles(face)]
    if any(near):
        return False
    foreign = False
    if any(f.startswith(MARKED) for f in faults):
        for face, marker in mesh.subfaces.items():
            found = list(mesh.near_triangles(face))
            if (marker, True) not in found:
                return False
            foreign |= any(not is_part and m != marker for m, is_part in found)
    return bool(near) or foreign
