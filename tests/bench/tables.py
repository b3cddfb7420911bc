# SPDX-License-Identifier: Apache-2.0
"""The thesis's tables of refinement (3.3 to 3.6), ours beside its figures and TetGen's.

Mesh sizes, no times: one run each. Models are the real ones beside the checkout, where they are.
"""

import json
import math
import re
import shutil
import subprocess
import sys

from inputs import as_tetgen, line_and_circle, write_node, write_smesh

ORDERS = ["O2_O1", "O1", "O2", "O3", "O4", "O5", "relatively_short"]
LIMIT = 120  # seconds for one run of TetGen, which does not end on everything

LINE_AND_CIRCLE = {"O1": 14111, "O2": 12522, "O3": 13674, "O5": 12924}  # nodes, Table 3.3
NESTED = {2.0: (1085, 1153, 1208), 1.4: (1586, 1821, 2034), 1.2: (2560, 3380, 4081)}  # nodes, Table 3.5
PER_SLIVER = {"Line & Circle": (298, 397), "2-Spheres": (118, 151), "Head": (324, 431), "Hose, points": (453, 532),
              "DEMO03": (110, 349), "Pmdc": (629, 1607), "Thepart": (363, 1075), "Hose": (324, 691)}  # Table 3.6
ORDER_MODELS = ["multi/sfepy_cylinder_in_box.smesh", "multi/sfepy_perfusion_micro3d.smesh", "surface/hand.off",
                "surface/casting.off"]  # the first two without sharp dihedral angles
SLIVER_MODELS = ["multi/sfepy_cylinder_in_box.smesh", "multi/sfepy_perfusion_micro3d.smesh", "sizing/mmg_torus.smesh",
                 "plc/ex1.smesh", "surface/boeing_part.off", "surface/casting.off", "surface/turbine.off"]


def boxed_line_and_circle(n):
    """Those points, and a box's surface of 4 x 4 x 4 points."""
    ticks = [-2.0, -2 / 3, 2 / 3, 2.0]
    return line_and_circle(n) + [p for x in ticks for y in ticks for z in ticks if max(map(abs, p := (x, y, z))) == 2]


def sphere(n):
    """A cube with n x n squares on each side, each cut by its shorter diagonal, pushed out onto the
    unit sphere from its centre: points and outward triangles."""
    numbers, points, triangles = {}, [], []

    def number(axis, side, i, j):
        at = [0, 0, 0]
        at[axis], at[(axis + 1) % 3], at[(axis + 2) % 3] = side * n, 2 * i - n, 2 * j - n
        if tuple(at) not in numbers:
            numbers[tuple(at)] = len(points)
            length = math.sqrt(sum((x / n) ** 2 for x in at))
            points.append(tuple(x / n / length for x in at))
        return numbers[tuple(at)]

    for axis in range(3):
        for side in (-1, 1):
            for i in range(n):
                for j in range(n):
                    a, b, c, d = (number(axis, side, i + u, j + v) for u, v in ((0, 0), (1, 0), (1, 1), (0, 1)))
                    if side < 0:
                        b, d = d, b
                    if math.dist(points[a], points[c]) <= math.dist(points[b], points[d]):
                        triangles += [(a, b, c), (a, c, d)]
                    else:
                        triangles += [(a, b, d), (b, c, d)]
    return points, triangles


def nested(path, radius):
    """R_10 and its like: a unit sphere within another, both with their insides."""
    points, triangles = sphere(8)
    write_smesh(path, [tuple(r * x for x in p) for r in (1, radius) for p in points],
                [tuple(v + shift for v in t) for shift in (0, len(points)) for t in triangles])
    return path


def ours(b, path, *options):
    done = subprocess.run([str(b.meshpls), str(path), *options], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"meshpls {path} {' '.join(options)}: status {done.returncode}: {done.stderr.strip()}")
    return json.loads(done.stdout)


def nodes(b, path, *options):
    return ours(b, path, "--min-dihedral", "0", *options)["points"]


def tetgen(path, bound):
    """Nodes of TetGen's mesh; None where it is missing or fails."""
    if not shutil.which("tetgen"):
        return None
    try:
        done = subprocess.run(["tetgen", f"-pq{bound}NEF", str(path)], capture_output=True, text=True, check=False,
                              timeout=LIMIT)
    except subprocess.TimeoutExpired:
        return None
    found = re.search(r"Mesh points:\s*(\d+)", done.stdout)
    return int(found.group(1)) if found and done.returncode == 0 else None


def told(number):
    return "-" if number is None else str(number)


def insertion_orders(b):
    n = b.sized(1000)
    path = b.scratch / "line_and_circle.node"
    points = boxed_line_and_circle(n)
    write_node(path, points)
    box = b.scratch / "line_and_circle.smesh"
    corner = {p: i for i, p in enumerate(points)}
    sides = [[corner[tuple(2.0 * s for s in (p[k:] + p[:k]))] for p in ((side, -1, -1), (side, 1, -1), (side, 1, 1),
                                                                       (side, -1, 1))]
             for k in range(3) for side in (-1, 1)]
    write_smesh(box, points, sides)
    print(f"Table 3.3: line and circle, {n} + {n} points in a box of 56, nodes at bound 2.0"
          f" (thesis: 1000 + 1000; TetGen 1.5: {told(tetgen(box, 2.0))})")
    for order in ORDERS:
        found = nodes(b, path, "--order", order)
        print(f"  {order:<17}{found:>7}   thesis {told(LINE_AND_CIRCLE.get(order)):>6}", flush=True)


def order_models(b, models):
    print("Table 3.4: nodes at bound 2.0 by insertion order (the thesis's models are not public)")
    for name in ORDER_MODELS:
        print(f"  {name}, TetGen 1.5: {told(tetgen(as_tetgen(models / name, b.scratch), 2.0))}")
        for order in ORDERS:
            said = ours(b, models / name, "--min-dihedral", "0", "--order", order)
            print(f"    {order:<17}{said['points']:>7} nodes {said['tets']:>7} tetrahedra,"
                  f" {said['exceptions']} over the bound", flush=True)


def nested_spheres(b):
    print("Table 3.5: nodes between spheres of radii 1 and R, of 386 nodes each, by the bound")
    for bound, thesis in NESTED.items():
        for radius, printed in zip((10, 100, 1000), thesis):
            path = nested(b.scratch / f"nested_{radius}.smesh", radius)
            found, other = nodes(b, path, "--radius-edge", str(bound)), tetgen(path, bound)
            ratio = f"{found / other:.3f}" if other else "-"
            print(f"  {bound}  R {radius:>4}  {found:>5}   TetGen 1.5 {told(other):>5} ({ratio} of it)"
                  f"   thesis {printed:>5} ({found / printed:.3f})", flush=True)


def steiner_points_per_sliver(b, models):
    print("Table 3.6: points that the removal of slivers (below 5 degrees) took at bound 2.0")
    for name, (slivers, spent) in PER_SLIVER.items():
        print(f"  thesis, {name:<22}{slivers:>5} slivers {spent:>5} points {spent / slivers:5.2f} each")
    path = b.scratch / "line_and_circle.node"
    write_node(path, boxed_line_and_circle(b.sized(1000)))
    named = [models / name for name in SLIVER_MODELS] if models else []
    for path in [path, *named]:
        said = ours(b, path, "--min-dihedral", "5")
        first, spent = said["first_slivers"], said["sliver_points"]
        print(f"  {path.name:<30}{first:>5} slivers {spent:>5} points {spent / max(first, 1):5.2f} each,"
              f" {said['slivers']} left", flush=True)


def tables(b):
    import models  # pylint: disable=import-outside-toplevel

    folder = models.SHARED / "models" if (models.SHARED / "models").is_dir() else None
    if folder is None:
        print("no real models beside the checkout: without Table 3.4 and most of Table 3.6")
    insertion_orders(b)
    if folder:
        order_models(b, folder)
    nested_spheres(b)
    steiner_points_per_sliver(b, folder)
