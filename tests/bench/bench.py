#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the benchmarks and prints what they measured beside the peers that are installed.

    bench.py FOLDER-OF-THE-PROGRAMS [kernel|removal|threads|growth|recovery|refine|tables|codec ...] [--repeat N]
        [--small]

Ours and a peer's runs take turns, as machines are shared and noisy; a row gives medians,
and the ratio is that of the medians. --small divides all sizes by ten. `tables` prints mesh sizes beside the thesis's. Nothing here fails by
the clock; a program that does not work is a failure.
"""

import argparse
import json
import os
import pathlib
import random
import re
import shutil
import statistics
import subprocess
import sys
import tempfile

from inputs import as_tetgen, line_and_circle, models, write_poly
from tables import tables

KERNEL = [("cube", 100_000), ("cube", 1_000_000), ("cube", 4_000_000), ("clusters", 1_000_000), ("planes", 200_000),
          ("grid", 262_144), ("lattice", 262_144), ("sphere", 200_000), ("circle", 2_000)]
REMOVAL = [("cube", 1_000_000), ("clusters", 200_000), ("planes", 200_000), ("grid", 262_144), ("sphere", 200_000),
           ("circle", 2_000)]


def output(*command):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{command[0]}: status {done.returncode}: {done.stderr.strip()}")
    return done.stdout


def pairs(line):
    """`name number name number ...` as a dict."""
    words = line.split()
    return {k: float(v) for k, v in zip(words[::2], words[1::2])}


class Bench:
    """The programs, a folder for files, and how often and how large to run."""

    def __init__(self, programs, scratch, repeat, small):
        self.programs, self.scratch, self.repeat, self.small = programs, scratch, repeat, small
        self.meshpls = programs.parent / "support" / "meshpls"
        self.cgal = (programs / "peer_cgal") if (programs / "peer_cgal").exists() else None

    def sized(self, points):
        return points // 10 if self.small else points

    def kernel(self, *arguments):
        return pairs(output(self.programs / "bench_kernel", *arguments))

    def kernel_each(self, family, points, threads):
        """One process, a row for each of these numbers of threads."""
        said = output(self.programs / "bench_kernel", family, points, ",".join(map(str, threads)))
        return [pairs(line) for line in said.splitlines() if line.startswith("seconds")]

    def written(self, what, family, points):
        path = self.scratch / f"{family}-{points}-{what}"
        if not path.exists():
            output(self.programs / "bench_kernel", family, points, what, path)
        return path

    def turns(self, *runs):
        """Calls each of `runs` in turn, `repeat` times; a list of results for each."""
        results = [[] for _ in runs]
        for _ in range(self.repeat):
            for run, found in zip(runs, results):
                found.append(run())
        return results


def median(rows, name="seconds"):
    return statistics.median(row[name] for row in rows)


def kernel(b):
    print(f"Delaunay tetrahedralization, one thread, CPU seconds (medians of {b.repeat}; ratio: CGAL's by ours)")
    for family, points in KERNEL:
        points = b.sized(points)
        runs = [lambda f=family, n=points: b.kernel(f, n)]
        if b.cgal:
            path = b.written("write", family, points)
            runs.append(lambda p=path: pairs(output(b.cgal, p)))
        results = b.turns(*runs)
        ours = results[0]
        line = (f"  {family:<9}{points:>9}  {median(ours):8.3f} s {ours[0]['tetrahedra']:>10.0f} tetrahedra"
                f" {ours[0]['bytes_per_tetrahedron']:6.1f} B each")
        if b.cgal:
            line += f"   CGAL {median(results[1]):8.3f} s  {median(results[1]) / median(ours):5.2f}"
        print(line, flush=True)
    if shutil.which("tetgen"):
        tetgen(b)


def tetgen(b):
    points = b.sized(1_000_000)
    data = b.written("write", "cube", points).read_bytes()
    node = b.scratch / "cube.node"
    values = memoryview(data).cast("d")
    with open(node, "w", encoding="ascii") as f:
        f.write(f"{points} 3 0 0\n")
        for i in range(points):
            f.write(f"{i} {values[3 * i]!r} {values[3 * i + 1]!r} {values[3 * i + 2]!r}\n")

    def run():
        said = output("tetgen", "-NEFV", node)
        return {"seconds": float(re.search(r"Delaunay seconds:\s*([\d.e-]+)", said).group(1))}

    ours, theirs = b.turns(lambda: b.kernel("cube", points), run)
    print(f"  cube     {points:>9}  {median(ours):8.3f} s   TetGen {median(theirs):8.3f} s"
          f"  {median(theirs) / median(ours):5.2f}", flush=True)


def removal(b):
    print("Removal of half the vertices in random order, one thread (thousands a second; ratio to CGAL's)")
    for family, points in REMOVAL:
        points = b.sized(points)
        order = b.written("order", family, points)
        count = order.stat().st_size // 4 // 2
        runs = [lambda f=family, n=points, c=count: b.kernel(f, n, "remove", c)]
        if b.cgal:
            path = b.written("write", family, points)
            runs.append(lambda p=path, o=order, c=count: pairs(output(b.cgal, p, o, c)))
        results = b.turns(*runs)
        rates = [1e-3 * count / median(rows) for rows in results]
        line = f"  {family:<9}{points:>9}  {rates[0]:8.1f}"
        if b.cgal:
            line += f"   CGAL {rates[1]:8.1f}  {rates[0] / rates[1]:5.2f}"
            if results[0][0]["tetrahedra"] != results[1][0]["tetrahedra"]:
                line += "   (another number of tetrahedra: ties are broken otherwise)"
        print(line, flush=True)


def threads(b):
    points = b.sized(4_000_000)
    most = len(os.sched_getaffinity(0))
    counts = [1] + [n for n in (2, 4, 8, 16, 31) if n <= most]
    print(f"Threads, cube {points}, wall seconds (medians and least of {b.repeat} turns in one process)")
    _first_touch, *runs = b.kernel_each("cube", points, counts[-1:] + counts * b.repeat)
    alone = runs[::len(counts)]
    for i, n in enumerate(counts):
        rows = runs[i::len(counts)]
        wall, least = median(rows, "wall"), min(row["wall"] for row in rows)
        pairs_of = statistics.median(one["wall"] / row["wall"] for one, row in zip(alone, rows))
        print(f"  {n:>2}  {wall:8.3f} {least:8.3f}   {pairs_of:5.2f} times as fast by the median of pairs,"
              f" {min(row['wall'] for row in alone) / least:.2f} by the least", flush=True)


def growth(b):
    few, many = b.sized(100_000), b.sized(10_000_000)
    print("Cost per point, cube, microseconds; one process for each size, its first run not counted")
    small, large = (b.kernel_each("cube", n, [1] * (b.repeat + 1))[1:] for n in (few, many))
    costs = [1e6 * median(small) / few, 1e6 * median(large) / many]
    print(f"  {few}: {costs[0]:.3f}   {many}: {costs[1]:.3f}   ratio {costs[1] / costs[0]:.2f}")


CDT_STAGES = ("delaunay", "surface", "segments", "facets", "regions")
TETGEN_PHASES = ("Delaunay", "Surface mesh", "Constrained Delaunay", "Exterior tets removal")
LEAST = 0.05  # seconds: a model that takes TetGen less says little by itself


def cdt(b, path, *options):
    """Processor seconds of the stages of the CDT, and counts."""
    said = json.loads(re.sub(r":-?(inf|nan)", ":0", output(b.meshpls, path, "--stage", "cdt", *options)))
    return {"seconds": sum(said["cpu"][s] for s in CDT_STAGES), "facets": said["cpu"]["facets"],
            "steiner": said["steiner"], "cavities": said["cavities"], "tets": said["tets"]}


def tetgen_cdt(path):
    """Seconds of the same phases by its own clock; None where it gives up."""
    done = subprocess.run(["tetgen", "-pVNEFB", str(path)], capture_output=True, text=True, check=False)
    found = [re.search(rf"^{phase} seconds:\s*([\d.e-]+)", done.stdout, re.M) for phase in TETGEN_PHASES]
    return {"seconds": sum(float(m.group(1)) for m in found)} if done.returncode == 0 and all(found) else None


def surfaces(b):
    """The surface models, one marker for each group of coplanar facets, so that both keep every facet."""
    sums, worst = [0.0, 0.0], 0.0
    for model in models.folder("surface"):
        smesh = as_tetgen(model, b.scratch)
        runs = [lambda p=smesh: cdt(b, p)]
        if shutil.which("tetgen"):
            runs.append(lambda p=smesh: tetgen_cdt(p))
        results = b.turns(*runs)
        line = f"  {model.stem:<16}{median(results[0]):8.4f} s {results[0][0]['steiner']:>7} Steiner points"
        if len(results) > 1 and all(results[1]):
            ours, theirs = median(results[0]), median(results[1])
            sums = [sums[0] + ours, sums[1] + theirs]
            worst = max(worst, ours / theirs) if theirs >= LEAST else worst
            line += f"   TetGen {theirs:8.4f} s  {theirs / ours:5.2f}"
        elif len(results) > 1:
            line += "   TetGen gives up"
        print(line, flush=True)
    if sums[1]:
        print(f"  sum             {sums[0]:8.4f} s   TetGen {sums[1]:8.4f} s  {sums[1] / sums[0]:5.2f};"
              f" the least of those over {LEAST} s {1 / worst if worst else 0:5.2f}", flush=True)


def layers(v, f, upwards):
    """L(v, f) of thesis Fig. 5.15: f large parallel squares under a cluster of v points, and a
    point below, whose v edges to them cross all the squares; all of these are missing, and no
    segment. The order of the facets is that of their recovery."""
    rng = random.Random(v + f)
    points, facets = [], []
    for i in range(f):
        z = -1.0 - 38.0 * (f - 1 - i if upwards else i) / f
        facets.append([list(range(len(points), len(points) + 4))])
        points += [(x + rng.uniform(-1e-4, 1e-4), y + rng.uniform(-1e-4, 1e-4), z)
                   for x, y in ((-20, -20), (20, -20), (20, 20), (-20, 20))]
    for _ in range(v):  # on a bowl, so that the point below sees them all
        x, y = rng.uniform(-0.1, 0.1), rng.uniform(-0.1, 0.1)
        points.append((x, y, x * x + y * y))
    return points + [(0.0, 0.0, -40.0)], facets


def boxed_line_and_circle(n):
    """Those points, and a box round them."""
    points = line_and_circle(n)
    first = len(points)
    points += [(4.0 * (i & 1) - 2, 2.0 * (i & 2) - 2, 1.0 * (i & 4) - 2) for i in range(8)]
    sides = ((0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6))
    return points, [[[first + i for i in side]] for side in sides]


def recovery(b):
    print(f"CDT, one thread, processor seconds (medians of {b.repeat}; ratio: TetGen's by ours)")
    if models.available():
        surfaces(b)
    else:
        print("  no models beside the checkout")
    for upwards in (False, True):
        costs = []
        for v, f in ((500, 50), (1000, 100)):
            path = b.scratch / "layers.poly"
            write_poly(path, *layers(b.sized(v), b.sized(f), upwards))
            rows = b.turns(lambda p=path: cdt(b, p, "--keep-hull"))[0]
            costs.append(median(rows))
            print(f"  L({b.sized(v)}, {b.sized(f)}) {'upwards' if upwards else 'downwards':<10}{costs[-1]:8.4f} s,"
                  f" facets {median(rows, 'facets'):8.4f} s, {rows[0]['cavities']} cavities,"
                  f" {rows[0]['steiner']} Steiner points", flush=True)
        print(f"    grows {costs[1] / costs[0]:.2f} times", flush=True)
    n = b.sized(1000)
    path = b.scratch / "line_and_circle.poly"
    write_poly(path, *boxed_line_and_circle(n))
    rows = b.turns(lambda: cdt(b, path))[0]
    print(f"  line and circle of {n} + {n} points {median(rows):8.4f} s, {rows[0]['tets']} tetrahedra", flush=True)


CUBE = """8 3 0 0
0 0 0 0
1 1 0 0
2 1 1 0
3 0 1 0
4 0 0 1
5 1 0 1
6 1 1 1
7 0 1 1
6 0
1
4 0 1 2 3
1
4 4 5 6 7
1
4 0 1 5 4
1
4 1 2 6 5
1
4 2 3 7 6
1
4 3 0 4 7
0
0
"""


def refine(b):
    """Seconds of refinement alone, which both tell; thousands of tetrahedra a second."""
    cube = b.scratch / "cube.poly"
    cube.write_text(CUBE, encoding="ascii")
    print(f"Refinement of a cube by volume, radius-edge 1.414, one thread (medians of {b.repeat})")
    for wanted in [b.sized(1_000_000), b.sized(5_000_000)]:
        volume = f"{1.8 / wanted:.3e}"

        def ours(v=volume):
            said = json.loads(output(b.meshpls, cube, "--radius-edge", "1.4143", "--max-volume", v,
                                     "--min-dihedral", "0"))
            return {"rate": 1e-3 * said["tets"] / said["stages"]["refine"], "tets": said["tets"],
                    "bytes": said["peak"] / said["tets"]}

        def tetgen(v=volume):
            said = output("tetgen", f"-pq1.414a{float(v):.12f}VNEF", cube)
            tets = float(re.search(r"Mesh tetrahedra:\s*(\d+)", said).group(1))
            return {"rate": 1e-3 * tets / float(re.search(r"Refinement seconds:\s*([\d.e-]+)", said).group(1))}

        results = b.turns(ours, *([tetgen] if shutil.which("tetgen") else []))
        row = results[0][0]
        line = f"  {row['tets']:>9}  {median(results[0], 'rate'):8.0f} k/s {row['bytes']:6.1f} B each at peak"
        if len(results) > 1:
            theirs = median(results[1], "rate")
            line += f"   TetGen {theirs:6.0f} k/s  {median(results[0], 'rate') / theirs:5.2f}"
        print(line, flush=True)


def codec(b):
    points = b.sized(200_000)
    print(f"Codecs on the mesh of {points} random points: bytes on the wire per raw byte")
    for line in output(b.programs / "bench_codec", points, "1").splitlines():
        order, name, rest = line.split(" ", 2)
        row = pairs(rest)
        print(f"  {order:<12} {name:<5} {row['ratio']:6.3f}"
              f"  encode {row['encode_MBps']:6.0f} MB/s  decode {row['decode_MBps']:6.0f} MB/s")


def main():
    benches = {"kernel": kernel, "removal": removal, "threads": threads, "growth": growth, "recovery": recovery,
               "refine": refine, "tables": tables, "codec": codec}
    parser = argparse.ArgumentParser()
    parser.add_argument("programs", type=pathlib.Path)
    parser.add_argument("which", nargs="*", choices=[[], *benches], default=[])
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--small", action="store_true")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        bench = Bench(given.programs, pathlib.Path(scratch), given.repeat, given.small)
        if not bench.cgal:
            print("CGAL is not installed: no ratios to it")
        for name in given.which or benches:
            benches[name](bench)


if __name__ == "__main__":
    main()
