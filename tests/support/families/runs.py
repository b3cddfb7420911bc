# SPDX-License-Identifier: Apache-2.0
"""Meshes members of the families and their spoiled twins with the engine alone
(tests/support/meshpls), has the judge look at the meshes, and tabulates.

A member and its twin are one case.  Its time is the engine's processor time; one slower
than MOST_TIMES its family's median is measured again, so that a busy machine is no fault."""

import collections
import json
import os
import pathlib
import re
import resource
import statistics
import subprocess
import sys
import tempfile

import blind
import families
import spoils

sys.path.insert(1, str(pathlib.Path(__file__).resolve().parents[1]))
import models  # noqa: E402

MESHPLS = models.BUILD / "tests/support/meshpls"
MOST_TIMES = 20
LEAST_MEDIAN = 0.005  # seconds: below it the clock says nothing
LIMIT = 120
OFFENCE = re.compile(r"^  kind (\d+) number (\d+), kind (\d+) number (\d+)", re.M)
STATUS = re.compile(r": ([a-z_]+): ")
JUDGE_TOLERANCE = "0"
JUDGE_FAULT = re.compile(r'"[^"]*"')


class Result:
    """What came of a case; a fault is empty, or says what is wrong."""

    def __init__(self, name, seed, options):
        self.name, self.seed, self.options = name, seed, options
        self.fault = self.judge_fault = self.time_fault = self.spoil_fault = ""
        self.blind = False  # the judge could not tell
        self.way = ""  # in which the twin was spoiled
        self.seconds, self.judged, self.report = 0.0, False, {}

    def faults(self):
        spoiled = f"spoiled by {self.way}: {self.spoil_fault}" if self.spoil_fault else ""
        return [f for f in (self.fault, self.judge_fault, self.time_fault, spoiled) if f]


CDT = ("--stage", "cdt")
BREAKING = (*CDT, "--break-points")


def run_engine(path, prefix=None, options=CDT, limit=LIMIT):
    """(completed process, its processor seconds); None instead of the process that is not done
    in `limit` seconds."""
    command = [MESHPLS, path, *([prefix] if prefix else []), *options]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=limit, check=False)
    except subprocess.TimeoutExpired:
        return None, float(limit)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return done, after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def fault_of(done):
    if done is None:
        return f"not done in {LIMIT} s"
    if done.returncode == 3:
        return "the audit did not pass: " + re.search(r'"audit":\{[^}]*\}', done.stdout).group(0)
    if done.returncode != 0:
        return (done.stderr.strip().splitlines() or ["no word"])[0] + f" (status {done.returncode})"
    return ""


def report_of(done):
    return json.loads(done.stdout.replace(":inf", ":Infinity").replace(":nan", ":NaN"))


def judge_fault(judge, path, prefix, has_volume):
    return judge_says(judge, path, prefix, ["--cdt", "--tol", JUDGE_TOLERANCE,
                                            *([] if has_volume else ["--allow-outside", models.ANY_NUMBER])])


def judge_says(judge, path, prefix, options):
    command = [judge, path, prefix, "--markers", *options]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode == 0:
        return ""
    said = re.search(r'"faults":\[(.*)\]', done.stdout)
    return "judge: " + ((said.group(1) if said else done.stdout + done.stderr).strip() or f"status {done.returncode}")


def refusal_fault(done, expected):
    """What is wrong with the refusal of a spoiled system; empty where it is right."""
    if done is None or done.returncode != 1:
        return "not refused: " + (fault_of(done) or "meshed")
    status = STATUS.search(done.stderr)
    if not status or status.group(1) not in expected.statuses:
        return f"refused as {done.stderr.strip()[-300:]}, not as {' or '.join(sorted(expected.statuses))}"
    if expected.rule:
        offences = [tuple(zip(o[::2], o[1::2])) for o in (tuple(map(int, m)) for m in OFFENCE.findall(done.stderr))]
        if not offences or not all(expected.rule(o) for o in offences):
            return f"offences named: {done.stderr.strip()[-300:]}"
    return ""


def degeneracy_fault(report):
    """With break points: whether a facet's triangulation is degenerate still."""
    left = report.get("degeneracies_left", 0)
    return f"{left} local degeneracies are left" if left else ""


def run_case(name, seed, folder, judge=None, way=None, options=CDT):
    """Meshes and judges one member, and has its twin refused."""
    result = Result(name, seed, options)
    pls = families.make(name, seed)
    path, prefix = os.path.join(folder, "case.poly"), os.path.join(folder, "case.1")
    pls.write(path)
    done, result.seconds = run_engine(path, prefix, options)
    result.fault = fault_of(done)
    if not result.fault:
        result.report = report_of(done)
        result.fault = degeneracy_fault(result.report)
        if judge:
            result.judged = True
            result.judge_fault = judge_fault(judge, path, prefix, pls.volume is not None)
            result.blind = bool(result.judge_fault) and blind.cannot_tell(JUDGE_FAULT.findall(result.judge_fault), pls, prefix)
            if result.blind:
                result.judge_fault, result.judged = "", False
    spoiled = spoils.spoil(pls, f"{name} {seed}", way)
    if spoiled:
        result.way, twin, expected = spoiled
        twin.write(path)
        done, _ = run_engine(path, options=options)
        result.spoil_fault = refusal_fault(done, expected)
    return result


def time_fault(result, median, folder, options):
    """Whether a result is too slow still where it is the best of three more."""
    most = MOST_TIMES * max(median, LEAST_MEDIAN)
    if result.seconds <= most:
        return ""
    path = os.path.join(folder, "slow.poly")
    families.make(result.name, result.seed).write(path)
    result.seconds = min(result.seconds, *(run_engine(path, os.path.join(folder, "slow.1"), options)[1] for _ in range(3)))
    return f"{result.seconds:.2f} s, the family's median is {median:.3f} s" if result.seconds > most else ""


def run(names, count, first, judge, tell=None, options=CDT):
    """`count` cases, the families in turn; returns {family: [Result]}."""
    found = collections.defaultdict(list)
    with tempfile.TemporaryDirectory() as folder:
        for i in range(count):
            name = names[i % len(names)]
            result = run_case(name, first + i // len(names), folder, judge, options=options)
            found[name].append(result)
            if tell and result.faults():
                tell(result)
        for results in found.values():
            median = statistics.median(r.seconds for r in results)
            for r in results:
                r.time_fault = time_fault(r, median, folder, options)
                if r.time_fault and tell:
                    tell(r)
    return found


def command_for(result):
    option = " --break-points" if result.options == BREAKING else ""
    return f"python3 tests/support/families --family {result.name} --seed {result.seed} --count 1{option}"


def complaint(result):
    return f"{result.name} {result.seed}: " + "; ".join(result.faults()) + "\n    " + command_for(result)


def table(found):
    head = f"{'family':22} {'cases':>6} {'meshed':>7} {'judged':>7} {'blind':>6} {'spoiled':>8} {'refused':>8} {'median s':>9} {'worst s':>8} {'Steiner':>8} {'breaks':>7} {'flips':>7} {'moves':>6}"
    lines = [head]
    for name, rs in found.items():
        spoiled = [r for r in rs if r.way]
        counts = [statistics.fmean([r.report.get(k, 0) for r in rs]) for k in ("steiner", "break_points", "flips", "moves")]
        lines.append(f"{name:22} {len(rs):6} {sum(bool(r.report) for r in rs):7} {sum(r.judged and not r.judge_fault for r in rs):7} {sum(r.blind for r in rs):6} {len(spoiled):8} "
                     f"{sum(not r.spoil_fault for r in spoiled):8} {statistics.median(r.seconds for r in rs):9.4f} "
                     f"{max(r.seconds for r in rs):8.3f} {counts[0]:8.1f} {counts[1]:7.1f} {counts[2]:7.1f} {counts[3]:6.2f}")
    return "\n".join(lines)
