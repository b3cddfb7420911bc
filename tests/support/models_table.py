#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Seconds and tetrahedra per stage of the surface models, beside tetgen in the same run.

    models_table.py [MODEL-NAME-PART]...

Both get the same files of one run after the other on an otherwise idle machine.
tetgen gets each surface with one marker per exactly coplanar group of facets, so
that it keeps every facet: `-p` for the CDT, `-pq2.0` for the quality mesh.
Prints a Markdown table.
"""

import pathlib
import re
import resource
import shutil
import subprocess
import sys
import tempfile

import models

STAGES = ["delaunay", "surface", "segments", "facets", "regions", "refine", "audit", "encode"]
LIMIT = 300  # seconds for one run of either


def cpu_of_children():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def tetgen(smesh, switches):
    """(CPU seconds, tetrahedra) of one run, or a word for what happened."""
    before = cpu_of_children()
    try:
        done = subprocess.run(["tetgen", switches + "NEF", smesh], capture_output=True, text=True,
                              timeout=LIMIT, check=False)
    except subprocess.TimeoutExpired:
        return f"over {LIMIT} s"
    count = re.search(r"Mesh tetrahedra: (\d+)", done.stdout)
    if done.returncode != 0 or count is None:
        return "abort" if done.returncode < 0 else "refused"
    return f"{cpu_of_children() - before:.2f} s, {count.group(1)}"


def tetrad(model, scratch):
    """The stages of a run as cells, or a word for what happened in the first."""
    try:
        done, report = models.run_mesher(model, pathlib.Path(scratch) / "out.node", timeout=LIMIT)
    except subprocess.TimeoutExpired:
        return [f"over {LIMIT} s"] + [""] * (len(STAGES) + 1)
    if done.returncode != 0 or report is None:
        return [f"status {done.returncode}"] + [""] * (len(STAGES) + 1)
    stages = {s["name"]: s for s in report["stages"]}
    cells = [f"{stages[s]['seconds']:.2f}" if s in stages else "" for s in STAGES]
    cdt = sum(stages[s]["seconds"] for s in STAGES[:5] if s in stages)
    return [f"{cdt:.2f} s, {stages['regions']['tetrahedra']}",
            f"{cdt + stages['refine']['seconds']:.2f} s, {stages['refine']['tetrahedra']}", *cells]


def main():
    if not models.available():
        sys.exit("models_table: no models beside the checkout")
    if not shutil.which("tetgen"):
        sys.exit("models_table: no tetgen")
    wanted = sys.argv[1:] or [""]
    print("| model | tetrad CDT | tetrad quality | " + " | ".join(STAGES) + " | tetgen -p | tetgen -pq2.0 |")
    print("|---" * (len(STAGES) + 5) + "|")
    for model in models.folder("surface"):
        if not any(part in model.name for part in wanted):
            continue
        with tempfile.TemporaryDirectory() as scratch:
            off = models.as_off(model, scratch)
            smesh = pathlib.Path(scratch) / "in.smesh"
            subprocess.run([sys.executable, models.SHARED / "judge/tosmesh.py", off, smesh], check=True)
            row = [model.stem, *tetrad(model, scratch), tetgen(smesh, "-p"), tetgen(smesh, "-pq2.0")]
        print("| " + " | ".join(row) + " |", flush=True)


if __name__ == "__main__":
    main()
