#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the benchmarks and prints what they measured beside the peers that are installed.

    bench.py FOLDER-OF-THE-PROGRAMS [POINTS]

Nothing here fails by the clock; a program that does not work is a failure.
"""

import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

SEED = "1"


def output(*command):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{command[0]}: status {done.returncode}: {done.stderr.strip()}")
    return done.stdout


def pairs(line):
    """`name number name number ...` as a dict."""
    words = line.split()
    return {k: float(v) for k, v in zip(words[::2], words[1::2])}


def delaunay(programs, points):
    print(f"Delaunay tetrahedralization of {points} random points")
    with tempfile.TemporaryDirectory() as scratch:
        node = pathlib.Path(scratch, "points.node")
        ours = pairs(output(programs / "bench_delaunay", points, SEED, node))
        print(f"  {'tetrad':<10} {ours['delaunay']:8.3f} s  {ours['tetrahedra']:>10.0f} tetrahedra")
        rows = []
        if shutil.which("tetgen"):
            said = output("tetgen", "-NEF", node)
            seconds = re.search(r"Delaunay seconds:\s*([\d.e-]+)", said)
            count = re.search(r"Mesh tetrahedra: (\d+)", said)
            rows.append(("tetgen", float(seconds.group(1)), float(count.group(1)) if count else 0))
        if (programs / "peer_cgal").exists():
            cgal = pairs(output(programs / "peer_cgal", node))
            rows.append(("CGAL", cgal["delaunay"], cgal["tetrahedra"]))
        for name, seconds, count in rows:
            print(f"  {name:<10} {seconds:8.3f} s  {count:>10.0f} tetrahedra"
                  f"  tetrad takes {ours['delaunay'] / seconds:.2f} of its time")
        if not rows:
            print("  no peer is installed (tetgen, CGAL)")


def codec(programs, points):
    print(f"Codecs on the mesh of {points} random points: bytes on the wire per raw byte")
    for line in output(programs / "bench_codec", points, SEED).splitlines():
        order, name, rest = line.split(" ", 2)
        row = pairs(rest)
        print(f"  {order:<12} {name:<5} {row['ratio']:6.3f}"
              f"  encode {row['encode_MBps']:6.0f} MB/s  decode {row['decode_MBps']:6.0f} MB/s")


def main():
    programs = pathlib.Path(sys.argv[1])
    points = sys.argv[2] if len(sys.argv) > 2 else "200000"
    delaunay(programs, points)
    codec(programs, points)


if __name__ == "__main__":
    main()
