# SPDX-License-Identifier: Apache-2.0
"""The input angles of a piecewise linear system (thesis 3.3.1), and its sharp segments.

Read off a constrained Delaunay tetrahedralization of it, whose subfaces and tetrahedra say
what meets where and what is inside; nothing is asked of the engine about angles, nor
about which edges are segments but for those that bound no corner of any facet.  In doubles:
an angle within 1e-7 degrees of a bound counts as at it."""

import collections
import math

from exact import cross, dot, minus

PLANE = 60.0
DIHEDRAL = math.degrees(math.acos(1 / (2 * 2 ** 0.5)))
LOW = math.degrees(math.asin(1 / (2 * 2 ** 0.5)))  # below, a segment and a facet force ratios over sqrt(2)
ROOM = 1e-7   # degrees
FLAT = 1e-4   # degrees: what is straighter than 180 less that is no edge between two facets


def unit(a):
    n = math.sqrt(dot(a, a))
    return (a[0] / n, a[1] / n, a[2] / n) if n > 0 else a


def between(a, b):
    """The angle of two vectors in degrees, good for small ones as well."""
    c = cross(a, b)
    return math.degrees(math.atan2(math.sqrt(dot(c, c)), dot(a, b)))


def read_rows(path):
    with open(path, encoding="ascii") as f:
        lines = [line.split() for line in f]
    return lines[1:]


class Mesh:
    """What the engine wrote: points, tets, faces and edges as tuples of numbers from 0."""

    def __init__(self, prefix):
        self.points = [tuple(map(float, r[1:4])) for r in read_rows(prefix + ".node")]
        self.tets = [tuple(map(int, r[1:5])) for r in read_rows(prefix + ".ele")]
        self.faces = [tuple(map(int, r[1:4])) for r in read_rows(prefix + ".face")]
        self.edges = [tuple(map(int, r[1:3])) for r in read_rows(prefix + ".edge")]

    def listed(self, prefix, suffix):
        """(tetrahedron, value, subsegment or -1) of each listed one."""
        return [(int(t), float(x), int(s)) for t, x, s in read_rows(prefix + suffix)]


class Angles:
    """Least angles in degrees (180: there is none) and sharp segments, as pairs of points:
    plane: segment with segment;  facet: segment with facet, sharp below LOW;  dihedral: facet with facet."""

    def __init__(self, mesh, n_input):
        self.plane = self.facet = self.dihedral = 180.0
        self.sharp = {}  # subsegment of the mesh: the least sharp angle of its segment
        self.mesh = mesh
        self._dihedrals()
        self._plane_angles()
        self._spread(n_input)

    def has_sharp_dihedral(self):
        return self.dihedral < DIHEDRAL - ROOM

    def meets_3_3_3(self):
        return not self.has_sharp_dihedral() and min(self.plane, self.facet) >= PLANE - ROOM

    def _blame(self, edge, angle):
        self.sharp[edge] = min(angle, self.sharp.get(edge, 180.0))

    def _dihedrals(self):
        """Of the fans of tetrahedra between subfaces; those of about 180 degrees bound no facet."""
        x, mesh = self.mesh.points, self.mesh
        subfaces = {tuple(sorted(f)) for f in mesh.faces}
        at = collections.defaultdict(list)  # edge: its subfaces' third vertices
        for f in subfaces:
            for i in range(3):
                at[f[i - 1] if f[i - 1] < f[i] else f[i], max(f[i - 1], f[i])].append(f[i - 2])
        around = collections.defaultdict(list)
        for t in mesh.tets:
            for i in range(4):
                for j in range(i):
                    e = (min(t[i], t[j]), max(t[i], t[j]))
                    if e in at:
                        around[e].append([v for v in t if v not in e])
        listed = {tuple(sorted(e)) for e in mesh.edges}
        self.segments = set(listed)
        for e, thirds in at.items():
            next_to = collections.defaultdict(list)
            for p, q in around[e]:
                next_to[p].append(q)
                next_to[q].append(p)
            axis = unit(minus(x[e[1]], x[e[0]]))
            arm = {v: minus(d, tuple(dot(d, axis) * a for a in axis))
                   for v, d in ((v, minus(x[v], x[e[0]])) for v in set(next_to) | set(thirds))}
            ends, straight = set(thirds), len(thirds) == 2
            for start in thirds:
                for step in next_to[start]:
                    turn, last, v = 0.0, start, step
                    while True:
                        turn += between(arm[last], arm[v])
                        if v in ends:
                            break
                        onwards = [w for w in next_to[v] if w != last]
                        if len(onwards) != 1:
                            break
                        last, v = v, onwards[0]
                    if v not in ends or v == start:
                        continue
                    straight &= abs(turn - 180) < FLAT
                    self.dihedral = min(self.dihedral, turn)
                    if turn < DIHEDRAL - ROOM:
                        self._blame(e, turn)
            if not straight:
                self.segments.add(e)

    def _plane_angles(self):
        mesh, x = self.mesh, self.mesh.points
        ends, corners, cells = (collections.defaultdict(list) for _ in range(3))
        for e in self.segments:
            ends[e[0]].append(e[1])
            ends[e[1]].append(e[0])
        for f in mesh.faces:
            for i in range(3):
                corners[f[i]].append((f[i - 2], f[i - 1]))
        for t in mesh.tets:
            for v in t:
                if v in ends:
                    cells[v].append(t)
        for v, others in ends.items():
            at = [(w, unit(minus(x[w], x[v]))) for w in others]
            sides = {frozenset(c) for c in corners[v]}
            for i, (p, d) in enumerate(at):
                for q, e in at[:i]:
                    angle = between(d, e)
                    if angle >= PLANE - ROOM:
                        continue
                    if frozenset((p, q)) not in sides and not self._inside(v, d, e, cells[v]):
                        continue
                    self.plane = min(self.plane, angle)
                    self._blame((min(v, p), max(v, p)), angle)
                    self._blame((min(v, q), max(v, q)), angle)
                for c in corners[v]:
                    if p in c:
                        continue
                    foot = self._foot(v, d, c)
                    if foot and between(d, foot) < PLANE - ROOM and self._inside(v, d, foot, cells[v]):
                        self.facet = min(self.facet, between(d, foot))
                        if between(d, foot) < LOW - ROOM:
                            self._blame((min(v, p), max(v, p)), between(d, foot))

    def _spread(self, n_input):
        """A segment is sharp as a whole: from subsegment to subsegment across its Steiner points."""
        at = collections.defaultdict(list)
        for e in self.segments:
            for v in e:
                if v >= n_input:
                    at[v].append(e)
        todo = list(self.sharp)
        while todo:
            e = todo.pop()
            for f in (f for v in e for f in at[v]):
                if self.sharp.get(f, 180.0) > self.sharp[e]:
                    self._blame(f, self.sharp[e])
                    todo.append(f)

    def _foot(self, v, d, corner):
        """The direction in the corner's plane nearest to d where it lies within the corner and
        off d; the sides are segments or other corners' business."""
        a, b = (unit(minus(self.mesh.points[w], self.mesh.points[v])) for w in corner)
        n = unit(cross(a, b))
        h = dot(d, n)
        foot = (d[0] - h * n[0], d[1] - h * n[1], d[2] - h * n[2])
        if abs(h) < 1e-9 or dot(foot, foot) < 0.1 or dot(cross(a, foot), n) < 0 or dot(cross(foot, b), n) < 0:
            return None
        return unit(foot)

    def _inside(self, v, d, e, cells):
        """Whether the sector from v between the two directions lies in the domain."""
        for share in (0.1, 0.35, 0.6, 0.9):
            way = tuple((1 - share) * p + share * q for p, q in zip(d, e))
            if not any(self._in_cell(v, way, t) for t in cells):
                return False
        return True

    def _in_cell(self, v, way, t):
        x = self.mesh.points
        a, b, c = (unit(minus(x[w], x[v])) for w in t if w != v)
        size = dot(cross(a, b), c)
        sign = 1 if size > 0 else -1
        room = -1e-9 * abs(size) ** 0.5 - 1e-15
        return all(sign * dot(cross(p, q), way) >= room for p, q in ((a, b), (b, c), (c, a)))
