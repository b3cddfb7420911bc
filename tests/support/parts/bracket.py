#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints the sample part as a .poly file: a mounting bracket, in millimetres.

Two plates at a right angle, four bolt holes (facets with facet holes, joined by
polygonal cylinders), and a rib that is a second material: the facets between it
and the plates are inside the body.

    python3 bracket.py > bracket.poly
"""

import math

LENGTH, WIDTH, HEIGHT, THICK = 80.0, 50.0, 60.0, 8.0
RIB = (22.0, 28.0, 33.0)  # from y, to y, reach along either plate
SIDES = 24  # of a hole
OUTSIDE, BOLT_HOLES, JOINT = 1, 2, 3  # facet markers

points = []
facets = []  # (marker, polygons, hole points)


def vertex(p):
    if p not in points:
        points.append(p)
    return points.index(p)


def facet(marker, *polygons, holes=()):
    facets.append((marker, [[vertex(p) for p in polygon] for polygon in polygons], list(holes)))


def circle(u, v, radius):
    turn = [2 * math.pi * k / SIDES for k in range(SIDES)]
    return [(round(u + radius * math.cos(a), 6), round(v + radius * math.sin(a), 6)) for a in turn]


def plate_with_holes(lower, upper, low_outline, high_outline, bolts):
    """Both faces of a plate and the walls of its holes; lower(u, v) and upper(u, v) place a
    point on either face."""
    rings = [circle(*bolt) for bolt in bolts]
    for place, outline in ((lower, low_outline), (upper, high_outline)):
        facet(OUTSIDE, [place(u, v) for u, v in outline],
              *[[place(u, v) for u, v in ring] for ring in rings],
              holes=[place(u, v) for u, v, _ in bolts])
    for ring in rings:
        for (u, v), (s, t) in zip(ring, ring[1:] + ring[:1]):
            facet(BOLT_HOLES, [lower(u, v), lower(s, t), upper(s, t), upper(u, v)])


def bracket():
    y0, y1, reach = RIB

    def notched(near, far):  # the face of a plate that the rib stands on, less its foot
        return [(near, 0.0), (far, 0.0), (far, WIDTH), (near, WIDTH),
                (near, y1), (reach, y1), (reach, y0), (near, y0)]

    def whole(far):
        return [(0.0, 0.0), (far, 0.0), (far, WIDTH), (0.0, WIDTH)]

    plate_with_holes(lambda u, v: (u, v, 0.0), lambda u, v: (u, v, THICK),
                     whole(LENGTH), notched(THICK, LENGTH), [(58.0, 13.0, 5.5), (58.0, 37.0, 5.5)])
    plate_with_holes(lambda u, v: (0.0, v, u), lambda u, v: (THICK, v, u),
                     whole(HEIGHT), notched(THICK, HEIGHT), [(40.0, 12.0, 4.5), (40.0, 38.0, 4.5)])
    for y in (0.0, WIDTH):
        facet(OUTSIDE, [(0.0, y, 0.0), (LENGTH, y, 0.0), (LENGTH, y, THICK), (THICK, y, THICK),
                        (THICK, y, HEIGHT), (0.0, y, HEIGHT)])
    facet(OUTSIDE, [(LENGTH, 0.0, 0.0), (LENGTH, WIDTH, 0.0), (LENGTH, WIDTH, THICK), (LENGTH, 0.0, THICK)])
    facet(OUTSIDE, [(0.0, 0.0, HEIGHT), (0.0, WIDTH, HEIGHT), (THICK, WIDTH, HEIGHT), (THICK, 0.0, HEIGHT)])
    for y in (y0, y1):
        facet(OUTSIDE, [(THICK, y, THICK), (reach, y, THICK), (THICK, y, reach)])
    facet(OUTSIDE, [(reach, y0, THICK), (reach, y1, THICK), (THICK, y1, reach), (THICK, y0, reach)])
    facet(JOINT, [(THICK, y0, THICK), (reach, y0, THICK), (reach, y1, THICK), (THICK, y1, THICK)])
    facet(JOINT, [(THICK, y0, THICK), (THICK, y0, reach), (THICK, y1, reach), (THICK, y1, THICK)])


def write():
    print("# A mounting bracket, in millimetres; made by bracket.py beside this file.")
    print(f"{len(points)} 3 0 0")
    for i, p in enumerate(points, 1):
        print(i, *p)
    print(f"\n# Facets; markers: {OUTSIDE} outside, {BOLT_HOLES} bolt holes, {JOINT} between plates and rib")
    print(len(facets), 1)
    for marker, polygons, holes in facets:
        print(len(polygons), len(holes), marker)
        for polygon in polygons:
            print(len(polygon), *[i + 1 for i in polygon])
        for i, p in enumerate(holes, 1):
            print(i, *p)
    print("\n# No volume holes; regions: 1 the plates, 2 the rib\n0\n2")
    print("1 70 25 4 1")
    print("2 12 25 12 2")


if __name__ == "__main__":
    bracket()
    write()
