# SPDX-License-Identifier: Apache-2.0
"""What the benchmarks share of inputs: files in TetGen's formats, and points of the thesis."""

import math
import pathlib
import subprocess
import sys

sys.path.insert(1, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import models  # noqa: E402


def write_node(path, points):
    with open(path, "w", encoding="ascii") as f:
        f.write(f"{len(points)} 3 0 0\n")
        f.writelines(f"{i} {x!r} {y!r} {z!r}\n" for i, (x, y, z) in enumerate(points))


def row(numbers):
    return f"{len(numbers)} {' '.join(map(str, numbers))}\n"


def write_smesh(path, points, facets):
    """facets: one polygon each, a list of points' numbers."""
    write_node(path, points)
    with open(path, "a", encoding="ascii") as f:
        f.write(f"{len(facets)} 0\n")
        f.writelines(map(row, facets))
        f.write("0\n0\n")


def write_poly(path, points, facets):
    """facets: lists of polygons."""
    write_node(path, points)
    with open(path, "a", encoding="ascii") as f:
        f.write(f"{len(facets)} 0\n")
        for polygons in facets:
            f.write(f"{len(polygons)} 0\n")
            f.writelines(map(row, polygons))
        f.write("0\n0\n")


def line_and_circle(n):
    """n points on a line through the middle of a circle of n others."""
    points = [(0.0, 0.0, -1 + (2 * i + 1) / n) for i in range(n)]
    return points + [(math.cos(2 * math.pi * i / n), math.sin(2 * math.pi * i / n), 0.0) for i in range(n)]


def as_tetgen(model, scratch):
    """A surface model as .smesh, one marker for each coplanar group, so that TetGen keeps its facets."""
    if model.suffix == ".smesh":
        return model
    path = scratch / (model.stem + ".smesh")
    off = models.as_off(model, scratch)
    subprocess.run([sys.executable, models.SHARED / "judge/tosmesh.py", off, path], check=True)
    return path
