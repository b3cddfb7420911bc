# SPDX-License-Identifier: Apache-2.0
"""Real models and the independent judge of meshes, where they are at hand.

They are no part of the project: a folder `shared` beside the checkout, or the one
that TETRAD_SHARED names, holds models/ and judge/.  Whoever uses this module skips
where they, a C++ compiler or CGAL are missing.
"""

import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

from harness import BUILD, ROOT, TETRACTL

SHARED = pathlib.Path(os.environ.get("TETRAD_SHARED", ROOT.parent / "shared"))
RADIUS_EDGE = 2.0
MOST_EXCEPTIONS = 0.05  # of the tetrahedra
MOST_OF_REFERENCE = 0.5  # of those of the reference mesh
ANY_NUMBER = "1000000000"


def available():
    return (SHARED / "models").is_dir() and (SHARED / "judge/judge.cpp").is_file()


def folder(name):
    """The model files of one folder, one path per model."""
    files = sorted((SHARED / "models" / name).glob("*.*"))
    return [p for p in files if p.suffix != ".node"]


def valid_models():
    return [p for name in ("plc", "multi", "surface") for p in folder(name)]


def table_rows():
    """The rows of the models' README as lists of cells."""
    text = (SHARED / "models/README.md").read_text(encoding="utf-8")
    return [[c.strip() for c in line.strip("|").split("|")] for line in text.splitlines() if line.startswith("|")]


def may_dangle(model):
    """Whether some of the model's facets may have no tetrahedron beside them."""
    return any(len(r) > 4 and r[1] == model.name and not r[4].startswith("closed") for r in table_rows())


def reference_over(model):
    """Tetrahedra over the radius-edge bound in the reference mesh; 0 where there is none."""
    for row in table_rows():
        if len(row) == 3 and row[0] == model.stem and row[2].count("/") == 3:
            return int(row[2].split("/")[3])
    return 0


def judge():
    """The judge's program, compiled at most once per source; None where that cannot be."""
    source = SHARED / "judge/judge.cpp"
    program = BUILD / "judge"
    if program.exists() and program.stat().st_mtime > source.stat().st_mtime:
        return program
    compiler = shutil.which("g++")
    if compiler is None or not BUILD.is_dir():
        return None
    part = program.with_suffix(".part")
    done = subprocess.run([compiler, "-O2", "-std=c++17", "-o", part, source, "-lgmp", "-lmpfr"],
                          capture_output=True, check=False)
    if done.returncode != 0:
        return None
    part.rename(program)
    return program


def as_off(model, scratch):
    """A surface model as .off."""
    if model.suffix.lower() == ".off":
        return model
    surface = pathlib.Path(scratch) / (model.stem + ".off")
    subprocess.run([sys.executable, SHARED / "judge/tooff.py", model, surface], check=True)
    return surface


def medit_as_smesh(model, scratch):
    """A Medit surface of triangles as .smesh, which keeps its markers."""
    words = iter(model.read_text(encoding="ascii").split())
    tables = {"Vertices": [], "Triangles": []}
    for word in words:
        if word in tables:
            tables[word] = [[next(words) for _ in range(4)] for _ in range(int(next(words)))]
    surface = pathlib.Path(scratch) / (model.stem + ".smesh")
    with open(surface, "w", encoding="ascii") as f:
        f.write(f"{len(tables['Vertices'])} 3 0 0\n")
        f.writelines(f"{i} {' '.join(p[:3])}\n" for i, p in enumerate(tables["Vertices"], 1))
        f.write(f"{len(tables['Triangles'])} 1\n")
        f.writelines(f"3 {' '.join(t)}\n" for t in tables["Triangles"])
        f.write("0\n0\n")
    return surface


def as_judge_reads(model, scratch):
    """The model in a format that the judge reads."""
    suffix = model.suffix.lower()
    if suffix in (".poly", ".smesh"):
        return model
    return medit_as_smesh(model, scratch) if suffix == ".mesh" else as_off(model, scratch)


def run_mesher(model, out, *options, timeout=300):
    """Runs tetractl; returns (completed process, report or None)."""
    report = pathlib.Path(str(out) + ".json")
    done = subprocess.run([TETRACTL, "mesh", model, "-o", out, "--report", report, "--quiet", *options],
                          capture_output=True, text=True, timeout=timeout, check=False)
    return done, json.loads(report.read_text(encoding="utf-8")) if report.exists() else None


def run_judge(program, model, prefix, *options):
    """The judge's faults on one mesh, as one line; empty where there are none."""
    with tempfile.TemporaryDirectory() as scratch:
        command = [program, as_judge_reads(model, scratch), prefix, *options]
        if may_dangle(model):
            command += ["--allow-outside", ANY_NUMBER]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode == 0:
        return ""
    said = re.search(r'"faults":\[(.*)\]', done.stdout)
    return (said.group(1) if said else done.stdout + done.stderr).strip() or f"status {done.returncode}"


def check(program, model, stage, folder_out):
    """Meshes one model up to a stage and has it judged.

    Returns (fault, report): an empty fault means that everything holds."""
    prefix = pathlib.Path(folder_out) / f"{model.stem}.{stage}"
    out = pathlib.Path(str(prefix) + ".node")
    bound = ["--radius-edge", str(RADIUS_EDGE)] if stage == "refine" else []
    done, report = run_mesher(model, out, "--stage", stage, *bound)
    if done.returncode != 0:
        return f"tetractl ended with {done.returncode}: {done.stderr.strip()[-400:]}", report
    if report is None:
        return "no report", None
    if stage != "refine":
        return run_judge(program, model, prefix, "--" + stage, "--markers"), report
    count = report["exceptions"]["count"]
    fault = run_judge(program, model, prefix, "--markers", "--rho", str(RADIUS_EDGE), "--allow-bad", str(count))
    if fault:
        return fault, report
    unblamed = sum(e["segment"] is None for e in report["exceptions"]["list"])
    if unblamed:
        return f"{unblamed} of {count} exceptions have no sharp segment to blame", report
    tetrahedra = report["stages"][-1]["tetrahedra"]
    most = max(MOST_EXCEPTIONS * tetrahedra, MOST_OF_REFERENCE * reference_over(model))
    if count > most:
        return f"{count} exceptions of {tetrahedra} tetrahedra, {most:.0f} would do", report
    return "", report
