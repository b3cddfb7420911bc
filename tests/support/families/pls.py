# SPDX-License-Identifier: Apache-2.0
"""A piecewise linear system under construction, and its .poly file."""

import copy


class Facet:
    def __init__(self, polygons, marker=0, holes=()):
        self.polygons = [list(p) for p in polygons]
        self.marker = marker
        self.holes = list(holes)

    def triangles(self):
        """Fans of the polygons, which are convex where they have more than three vertices."""
        return [(p[0], p[i], p[i + 1]) for p in self.polygons for i in range(1, len(p) - 1)]


class Pls:
    """Points are triples of floats, holes are too, regions are (x, y, z, attribute).

    volume: of the domain, where it is known (None: not);  shell: the facets are one
    closed surface, which any of them missing would open."""

    def __init__(self):
        self.points, self.facets, self.holes, self.regions = [], [], [], []
        self.volume = None
        self.shell = False

    def add_point(self, x, y, z):
        self.points.append((float(x), float(y), float(z)))
        return len(self.points) - 1

    def add_facet(self, *polygons, marker=0, holes=()):
        self.facets.append(Facet(polygons, marker, holes))
        return len(self.facets) - 1

    def copy(self):
        return copy.deepcopy(self)

    def add_box(self, low, high, marker=1, skip=()):
        """Six rectangles with markers from `marker` on; returns the corners, x fastest.
        skip: sides (0: low x, 1: high x, 2: low y ...) to leave out."""
        v = [self.add_point(*((high if i >> k & 1 else low)[k] for k in range(3))) for i in range(8)]
        for side, quad in enumerate(BOX_SIDES):
            if side not in skip:
                self.add_facet([v[i] for i in quad], marker=marker + side)
        return v

    def simplices(self):
        """The facets' triangles, and segments, as tuples."""
        found = []
        for facet in self.facets:
            found += [tuple(p) for p in facet.polygons if len(p) == 2] + facet.triangles()
        return found

    def write(self, path):
        with open(path, "w", encoding="ascii") as f:
            if self.volume is not None:
                f.write(f"# volume {self.volume!r}\n")
            f.write(f"{len(self.points)} 3 0 0\n")
            f.writelines(f"{i} {x!r} {y!r} {z!r}\n" for i, (x, y, z) in enumerate(self.points))
            f.write(f"{len(self.facets)} 1\n")
            for facet in self.facets:
                f.write(f"{len(facet.polygons)} {len(facet.holes)} {facet.marker}\n")
                f.writelines(f"{len(p)} {' '.join(map(str, p))}\n" for p in facet.polygons)
                f.writelines(f"{i} {x!r} {y!r} {z!r}\n" for i, (x, y, z) in enumerate(facet.holes))
            f.write(f"{len(self.holes)}\n")
            f.writelines(f"{i} {x!r} {y!r} {z!r}\n" for i, (x, y, z) in enumerate(self.holes))
            f.write(f"{len(self.regions)}\n")
            f.writelines(f"{i} {x!r} {y!r} {z!r} {a!r} 0\n" for i, (x, y, z, a) in enumerate(self.regions))


# The sides of a box whose corners are numbered x fastest, seen from outside.
BOX_SIDES = ((0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6))
