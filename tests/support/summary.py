#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints the report that `tetractl mesh --report FILE` writes, for people.

    summary.py REPORT.json
"""

import json
import sys

MEASURES = [("radius_edge", "radius-edge ratio"), ("dihedral_min", "smallest dihedral angle, degrees"),
            ("dihedral_max", "largest dihedral angle, degrees"), ("aspect", "aspect ratio")]
BAR = 40


def print_stages(stages):
    print(f"{'stage':<10} {'seconds':>8} {'vertices':>10} {'tetrahedra':>11}")
    for stage in stages:
        print(f"{stage['name']:<10} {stage['seconds']:>8.3f}"
              f" {stage.get('vertices', ''):>10} {stage.get('tetrahedra', ''):>11}")


def print_histogram(title, histogram):
    print(f"\n{title}: {histogram['min']:.4g} to {histogram['max']:.4g}")
    edges, bins = histogram["edges"], histogram["bins"]
    most = max(bins, default=0)
    for low, high, count in zip(edges, edges[1:] + [None], bins):
        if count:
            upto = f"{high:g}" if high is not None and high < 1e300 else "more"
            print(f"  {low:>6g} - {upto:<6} {count:>9} {'#' * max(1, round(BAR * count / most))}")


def words(value):
    """A promise or a finding on one line."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:g}" if isinstance(value, float) else str(value)


def main(path):
    with open(path, encoding="utf-8") as f:
        report = json.load(f)
    print_stages(report["stages"])
    for key, title in MEASURES:
        if key in report["quality"]:
            print_histogram(title, report["quality"][key])
    print("\npromised: " + ", ".join(f"{k} {words(v)}" for k, v in report["promised"].items()))
    print("audit:    " + ", ".join(f"{k} {words(v)}" for k, v in report["audit"].items()))
    print(f"tetrahedra listed as exceptions: {report['exceptions']['count']}, as slivers: {report['slivers']['count']}")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: summary.py REPORT.json")
    main(sys.argv[1])
