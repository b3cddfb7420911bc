#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws a tetrahedral mesh, cut open, as a PNG.

    picture.py MESH.node OUT.png [--cut NX,NY,NZ] [--at S] [--view AZIMUTH,ELEVATION]

Reads MESH.node and MESH.ele beside each other.  Whole tetrahedra are taken away
on the side of the cutting plane that its normal points to; --at says where the
plane stands between the mesh's two ends along the normal (0 to 1).  Faces that
the cut lays bare are coloured by region, the boundary is grey.
Needs matplotlib and numpy.
"""

import argparse
import pathlib
import sys

import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib.collections import PolyCollection  # noqa: E402

FACES = np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]])  # outward, face i opposite vertex i
BOUNDARY = (0.80, 0.83, 0.86)
REGIONS = [(0.93, 0.64, 0.28), (0.36, 0.58, 0.80), (0.55, 0.73, 0.42), (0.80, 0.45, 0.55), (0.62, 0.54, 0.76)]


def read_rows(path):
    """The numbers of a .node or .ele file: its header, then its rows."""
    lines = (line.split("#")[0].split() for line in open(path, encoding="ascii"))
    rows = [row for row in lines if row]
    count = int(rows[0][0])
    return [int(x) for x in rows[0]], np.array(rows[1:count + 1], dtype=float)


def read_mesh(path):
    """Points [n,3], tetrahedra [t,4] and the region of each tetrahedron [t]."""
    path = pathlib.Path(path)
    _, nodes = read_rows(path)
    header, rows = read_rows(path.with_suffix(".ele"))
    tetrahedra = rows[:, 1:5].astype(int) - int(nodes[0, 0])
    regions = rows[:, 5].astype(int) if header[2] > 0 else np.zeros(len(rows), dtype=int)
    return nodes[:, 1:4], tetrahedra, regions


def bare_faces(tetrahedra):
    """(rows, which): the faces [f,3] that belong to one tetrahedron only, and its number [f]."""
    faces = tetrahedra[:, FACES].reshape(-1, 3)
    owner = np.repeat(np.arange(len(tetrahedra)), 4)
    _, inverse, count = np.unique(np.sort(faces, axis=1), axis=0, return_inverse=True, return_counts=True)
    bare = count[inverse.ravel()] == 1
    return faces[bare], owner[bare]


def draw(points, tetrahedra, regions, normal, at, view, out):
    centres = points[tetrahedra].mean(axis=1)
    along = centres @ normal
    ends = points @ normal
    keep = along <= ends.min() + at * (ends.max() - ends.min())
    if not keep.any():
        sys.exit("picture: the cut leaves nothing")
    hull, _ = bare_faces(tetrahedra)
    faces, owner = bare_faces(tetrahedra[keep])
    on_hull = {tuple(row) for row in np.sort(hull, axis=1)}
    old = np.array([tuple(row) in on_hull for row in np.sort(faces, axis=1)])
    numbers = {region: i for i, region in enumerate(np.unique(regions))}
    colours = np.array([BOUNDARY if o else REGIONS[numbers[regions[keep][t]] % len(REGIONS)]
                        for o, t in zip(old, owner)])

    azimuth, elevation = np.radians(view)
    to_eye = np.array([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)])
    right = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
    up = np.cross(to_eye, right)
    corners = points[faces]
    outward = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    outward /= np.linalg.norm(outward, axis=1)[:, None] + 1e-300
    facing = outward @ to_eye > 0
    light = to_eye + 0.6 * up - 0.5 * right
    light /= np.linalg.norm(light)
    shade = 0.62 + 0.38 * np.clip(outward @ light, 0, 1)
    order = np.argsort(corners.mean(axis=1) @ to_eye)
    order = order[facing[order]]
    flat = np.stack([corners @ right, corners @ up], axis=2)

    figure, axes = plt.subplots(figsize=(9, 7), dpi=100)
    axes.add_collection(PolyCollection(flat[order], facecolors=(colours * shade[:, None])[order],
                                       edgecolors=(0.15, 0.17, 0.2, 0.75), linewidths=0.3))
    axes.autoscale_view()
    axes.set_aspect("equal")
    axes.axis("off")
    figure.savefig(out, bbox_inches="tight", pad_inches=0.1)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("mesh")
    parser.add_argument("out")
    parser.add_argument("--cut", default="0,-1,0", help="normal of the cutting plane")
    parser.add_argument("--at", type=float, default=0.5)
    parser.add_argument("--view", default="-60,28", help="azimuth and elevation of the eye, in degrees")
    options = parser.parse_args()
    normal = np.array([float(x) for x in options.cut.split(",")])
    draw(*read_mesh(options.mesh), normal / np.linalg.norm(normal), options.at,
         [float(x) for x in options.view.split(",")], options.out)


if __name__ == "__main__":
    main()
