# SPDX-License-Identifier: Apache-2.0
"""Refines piecewise linear systems with the engine alone and holds the meshes against what
their input angles promise (thesis 3.3.3, 3.4.1, 4.2.2).

    python3 tests/support/families/refined.py --count 500 --seed 1
    python3 tests/support/families/refined.py --family voxels --seed 17 --count 1
    python3 tests/support/families/refined.py MODEL...

all large: no dihedral, plane or segment-facet angle is sharp: boundary conforming Delaunay,
    radius-edge ratios up to 1.4143 without exception; and with default bounds no sliver.
plane: some plane angle is: boundary conforming Delaunay; what is over 1.4143 is listed, its
    circumcentre within (3 + sqrt 2) / 2 |S| of the midpoint of a sharp subsegment S (3.4.1; angles.py says
    which are).
dihedral: some dihedral angle is: constrained Delaunay; what is over 2.0 is listed.
In every class slivers that are left are listed, each traced to a sharp segment (TET_TRACE_REACH)
unless the budget of their removal or of thin facets was spent, and without sharp segments no
candidate is rejected.  Prints each case that does not hold, and a table.  A system of thin gaps needs
points without end: what goes over the limit of vertices or of seconds is counted apart."""

import argparse
import collections
import math
import os
import pathlib
import sys
import tempfile
from fractions import Fraction

import angles
import blind
import families
import runs

CLASSES = ("all large", "plane", "dihedral")
REACH = (3 + math.sqrt(2)) / 2
TIGHT, LOOSE = "1.4143", "2.0"
TOLERANCE = "1e-13"  # new points on facets are rounded; some systems have gaps of 1e-9
NO_SLIVERS = {"boxes-nested", "boxes-touching", "voxels"}


class Case:
    def __init__(self, name):
        self.name, self.kind, self.faults = name, "", []
        self.over_limit = ""     # why it was not finished
        self.exceptions = self.slivers = self.tets = 0
        self.seconds = 0.0
        self.untraced = 0
        self.pls = None
        self.farthest = 0.0      # times the bound, of 3.4.1
        self.angles = None


def circumcentre(corners):
    """In rationals, for what is over a bound may be all but flat; floats, or None."""
    a, b, c, d = ([Fraction(x) for x in p] for p in corners)
    rows = [[y - x for x, y in zip(a, p)] for p in (b, c, d)]
    right = [sum(x * x for x in r) / 2 for r in rows]
    det = sum(rows[0][i] * (rows[1][(i + 1) % 3] * rows[2][(i + 2) % 3] - rows[1][(i + 2) % 3] * rows[2][(i + 1) % 3])
              for i in range(3))
    if not det:
        return None
    found = []
    for i in range(3):
        m = [[right[k] if j == i else rows[k][j] for j in range(3)] for k in range(3)]
        found.append(a[i] + sum(m[0][j] * (m[1][(j + 1) % 3] * m[2][(j + 2) % 3] - m[1][(j + 2) % 3] * m[2][(j + 1) % 3])
                                for j in range(3)) / det)
    return tuple(map(float, found))


def on_segment(p, a, b):
    d = angles.minus(b, a)
    t = angles.dot(angles.minus(p, a), d) / angles.dot(d, d)
    foot = tuple(x + min(1.0, max(0.0, t)) * y for x, y in zip(a, d))
    return math.dist(p, foot) <= 1e-9 * math.sqrt(angles.dot(d, d))


def sharp_subsegments(mesh, found):
    """Those of the mesh that lie on sharp subsegments of the CDT that `found` is of."""
    x, y = mesh.points, found.mesh.points
    known = [(y[a], y[b]) for a, b in found.sharp]
    kept = set()
    for row, (a, b) in enumerate(mesh.edges):
        for p, q in known:
            if on_segment(x[a], p, q) and on_segment(x[b], p, q):
                kept.add(row)
                break
    return kept


def check_places(case, mesh, listed, sharp):
    """That what is over the bound is near a sharp subsegment."""
    x = mesh.points
    middles = [(tuple((p + q) / 2 for p, q in zip(x[mesh.edges[s][0]], x[mesh.edges[s][1]])),
                math.dist(x[mesh.edges[s][0]], x[mesh.edges[s][1]])) for s in sharp]
    strangers = 0
    for tet, _, segment in listed:
        c = circumcentre([x[v] for v in mesh.tets[tet]])
        if segment < 0 or (sharp and segment not in sharp):
            strangers += 1
        if c is None or not middles:
            case.farthest = math.inf
            continue
        case.farthest = max(case.farthest, min(math.dist(c, m) / (REACH * size) for m, size in middles))
    if strangers:
        case.faults.append(f"{strangers} exceptions without a sharp segment to blame")
    if case.farthest > 1:
        case.faults.append(f"an exception {case.farthest:.3g} times too far from sharp subsegments")


def check_slivers(case, mesh, report, listed, found):
    """That each sliver left is traced to a sharp segment, as those at one are, or the budget of their removal
    was spent, or that of thin facets."""
    x, y = mesh.points, found.mesh.points
    known = [(y[a], y[b]) for a, b in found.sharp]
    at_sharp = {v: any(on_segment(x[v], p, q) for p, q in known) for v in {v for t, _, _ in listed for v in mesh.tets[t]}}
    away = [t for t, _, _ in listed if not any(at_sharp[v] for v in mesh.tets[t])]
    untraced = len(listed) - report["traced"]["slivers"]
    if len(away) < untraced:
        case.faults.append(f"{untraced} slivers not traced, and {len(away)} at no sharp segment")
    if untraced and report["sliver_points"] < report["sliver_budget"] and report["thin_points"] < report["thin_budget"]:
        case.faults.append(f"{untraced} of {len(listed)} slivers not traced, and no budget is spent")


def judged(case, judge, path, prefix, options):
    if not judge:
        return
    said = runs.judge_says(judge, path, prefix, ["--tol", TOLERANCE, *options])
    if said and not (case.pls and blind.cannot_tell(runs.JUDGE_FAULT.findall(said), case.pls, prefix)):
        case.faults.append(said)


def refine(case, path, prefix, options, limits):
    """Runs the engine; its report, or None where that ended by a limit or in a fault."""
    done, seconds = runs.run_engine(path, prefix, ["--stage", "refine", "--vertices", str(limits[0]), *options], limits[1])
    case.seconds = max(case.seconds, seconds)
    if done is None:
        case.over_limit = f"not done in {limits[1]} seconds"
    elif done.returncode == 1 and "vertex_limit" in done.stderr:
        case.over_limit = f"over {limits[0]} vertices"
    elif done.returncode:
        case.faults.append(runs.fault_of(done))
    else:
        return runs.report_of(done)
    return None


def check_default(case, path, prefix, outside, judge, limits):
    """No sliver with default bounds."""
    report = refine(case, path, prefix, [], limits)
    if report and report["slivers"]:
        case.faults.append(f"{report['slivers']} slivers left with default bounds")
    elif report:
        judged(case, judge, path, prefix, ["--delaunay", "--gabriel", "--rho", LOOSE, "--dihedral", "5", *outside])


def run_case(name, path, folder, judge, limits, outside, pls=None, is_blocks=False):
    """Classifies, refines and judges the system in one file."""
    case = Case(name)
    case.pls = pls
    prefix = os.path.join(folder, "refined")
    done, _ = runs.run_engine(path, prefix, ["--stage", "cdt"])
    if done is None or done.returncode:
        case.faults.append("CDT: " + runs.fault_of(done))
        return case
    cdt = runs.report_of(done)
    found = case.angles = angles.Angles(angles.Mesh(prefix), cdt["points"] - cdt["steiner"])
    case.kind = CLASSES[2] if found.has_sharp_dihedral() else CLASSES[0] if found.meets_3_3_3() else CLASSES[1]
    bound = LOOSE if case.kind == "dihedral" else TIGHT
    report = refine(case, path, prefix, ["--radius-edge", bound], limits)
    if not report:
        return case
    case.tets, case.exceptions, case.slivers = report["tets"], report["exceptions"], report["slivers"]
    mesh = angles.Mesh(prefix)
    listed = mesh.listed(prefix, ".over")
    case.untraced = report["exceptions"] - report["traced"]["traced"]
    check_slivers(case, mesh, report, mesh.listed(prefix, ".sliver"), found)
    promised = report["promised"]
    if case.kind == "dihedral":
        if not promised["cdt"]:
            case.faults.append("not constrained Delaunay: {} faces".format(report["audit"].get("not_cdt", 0)))
        unblamed = sum(s < 0 for _, _, s in listed)
        if unblamed:
            case.faults.append(f"{unblamed} exceptions without a segment to blame")
        judged(case, judge, path, prefix, ["--cdt", "--rho", bound, "--allow-bad", str(len(listed)), *outside])
        return case
    if not (promised["delaunay"] and promised["gabriel"]):
        case.faults.append("not boundary conforming Delaunay")
    if not found.sharp and sum(report["rejected"].values()):
        case.faults.append(f"rejections without a sharp segment: {report['rejected']}")
    if case.kind == "all large" and listed:
        case.faults.append(f"{len(listed)} exceptions")
    if case.kind == "plane" and listed:
        check_places(case, mesh, listed, sharp_subsegments(mesh, found))
    judged(case, judge, path, prefix,
           ["--delaunay", "--gabriel", "--rho", bound, "--allow-bad", str(len(listed)), *outside])
    if case.kind == "all large" or is_blocks:
        check_default(case, path, prefix, outside, judge, limits)
    return case


def run_member(family, seed, folder, judge, limits):
    pls = families.make(family, seed)
    path = os.path.join(folder, "case.poly")
    pls.write(path)
    outside = [] if pls.volume is not None else ["--allow-outside", runs.models.ANY_NUMBER]
    return run_case(f"{family} {seed}", path, folder, judge, limits, outside, pls, family in NO_SLIVERS)


def run_model(model, folder, judge, limits):
    path = runs.models.as_judge_reads(model, folder)
    outside = ["--allow-outside", runs.models.ANY_NUMBER] if runs.models.may_dangle(model) else []
    return run_case(model.name, path, folder, judge, limits, outside)


def command_for(case):
    family, _, seed = case.name.partition(" ")
    return f"python3 tests/support/families/refined.py --family {family} --seed {seed} --count 1" if seed else ""


def complaint(case):
    what = case.faults + ([case.over_limit] if case.over_limit else [])
    return f"{case.name} [{case.kind}, {case.seconds:.1f} s]: " + "; ".join(what) + "\n    " + command_for(case)


def table(cases):
    kinds = collections.defaultdict(list)
    for c in cases:
        kinds[c.kind].append(c)
    lines = [f"{'class':10} {'cases':>6} {'hold':>6} {'limit':>6} {'over':>8} {'untraced':>8} {'slivers':>8} {'tets':>9} {'worst s':>8} {'farthest':>9}"]
    for kind, cs in sorted(kinds.items()):
        lines.append(f"{kind or '-':10} {len(cs):6} {sum(not c.faults and not c.over_limit for c in cs):6} "
                     f"{sum(bool(c.over_limit) for c in cs):6} {sum(c.exceptions for c in cs):8} {sum(c.untraced for c in cs):8} {sum(c.slivers for c in cs):8} "
                     f"{sum(c.tets for c in cs):9} {max(c.seconds for c in cs):8.2f} {max(c.farthest for c in cs):9.3f}")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("model", nargs="*", type=pathlib.Path, help="files instead of generated systems")
    parser.add_argument("--family", action="append", choices=sorted(families.FAMILIES), help="these alone")
    parser.add_argument("--count", type=int, default=200, help="cases, of all families in turn")
    parser.add_argument("--seed", type=int, default=1, help="of the first case of each family")
    parser.add_argument("--vertices", type=int, default=30000, help="limit of each mesh")
    parser.add_argument("--seconds", type=float, default=30, help="limit of each run")
    parser.add_argument("--no-judge", action="store_true", help="the engine's own audit alone")
    given = parser.parse_args()
    judge = None if given.no_judge or not runs.models.available() else runs.models.judge()
    names = given.family or sorted(families.FAMILIES)
    limits, cases = (given.vertices, given.seconds), []
    with tempfile.TemporaryDirectory() as folder:
        for i in range(len(given.model) or given.count):
            case = run_model(given.model[i], folder, judge, limits) if given.model else \
                run_member(names[i % len(names)], given.seed + i // len(names), folder, judge, limits)
            cases.append(case)
            if case.faults or case.over_limit:
                print(complaint(case), flush=True)
    print(table(cases))
    return 1 if any(c.faults for c in cases) else 0


if __name__ == "__main__":
    sys.exit(main())
