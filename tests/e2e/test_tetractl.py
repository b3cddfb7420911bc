# SPDX-License-Identifier: Apache-2.0
"""tetractl from the command line to the written files, most of it with the private daemon
that `tetractl mesh` starts for itself."""

import json
import pathlib
import random
import signal
import subprocess
import sys
import time

import pytest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from serving import PATIENCE, ROOT, TETRACTL, Daemon  # noqa: E402

BRACKET = ROOT / "tests/support/parts/bracket.poly"

CUBE = """OFF
8 6 0
0 0 0
1 0 0
1 1 0
0 1 0
0 0 1
1 0 1
1 1 1
0 1 1
4 0 3 2 1
4 4 5 6 7
4 0 1 5 4
4 1 2 6 5
4 2 3 7 6
4 3 0 4 7
"""


def tetractl(*arguments, timeout=300):
    return subprocess.run([TETRACTL, *map(str, arguments)], capture_output=True, text=True,
                          timeout=timeout, check=False)


def rows(path):
    """The rows of a .node, .ele, .face or .edge file, header first, as lists of words."""
    lines = (line.split("#")[0].split() for line in path.read_text(encoding="ascii").splitlines())
    return [line for line in lines if line]


@pytest.fixture(name="cube")
def fixture_cube(tmp_path):
    path = tmp_path / "cube.off"
    path.write_text(CUBE, encoding="ascii")
    return path


@pytest.fixture(name="daemon")
def fixture_daemon(tmp_path):
    """A running daemon; gives the address to connect to."""
    path = tmp_path / "d.sock"
    with Daemon("--unix", path, "--workers", 1) as running:
        yield f"unix:{path}"
    assert running.status == 0


def test_part_is_meshed_with_its_regions_and_markers(tmp_path):
    out, report = tmp_path / "b.node", tmp_path / "b.json"
    done = tetractl("mesh", BRACKET, "-o", out, "--report", report, "--max-volume", 40)
    assert done.returncode == 0, done.stderr
    given, nodes, tetrahedra = rows(BRACKET), rows(out), rows(out.with_suffix(".ele"))
    assert len(nodes) == int(nodes[0][0]) + 1 and len(tetrahedra) == int(tetrahedra[0][0]) + 1
    first = given[1][0]
    assert nodes[1][0] == first and tetrahedra[1][0] == first
    for mine, theirs in zip(given[1:int(given[0][0]) + 1], nodes[1:]):
        assert [float(x) for x in mine[1:4]] == [float(x) for x in theirs[1:4]]
    assert {float(t[5]) for t in tetrahedra[1:]} == {1.0, 2.0}
    assert {f[4] for f in rows(out.with_suffix(".face"))[1:]} >= {"1", "2", "3"}
    assert out.with_suffix(".edge").exists()

    said = json.loads(report.read_text(encoding="utf-8"))
    names = [stage["name"] for stage in said["stages"]]
    assert names == ["delaunay", "surface", "segments", "facets", "regions", "refine", "audit", "encode"]
    assert all(stage["seconds"] >= 0 and stage["peak_bytes"] > 0 for stage in said["stages"])
    assert said["audit"]["passed"] is True
    assert said["promised"]["radius_edge"] == 2.0 and said["promised"]["max_volume"] == 40
    assert said["quality"]["volume"] == pytest.approx(52165.49, rel=1e-6)
    assert said["exceptions"]["count"] == 0


def test_points_alone_are_triangulated(tmp_path):
    numbers = random.Random(7)
    points = tmp_path / "p.node"
    points.write_text("50 3 0 0\n" + "".join(
        f"{i} {numbers.random()} {numbers.random()} {numbers.random()}\n" for i in range(50)), encoding="ascii")
    out = tmp_path / "out.node"
    done = tetractl("mesh", points, "-o", out, "--stage", "delaunay")
    assert done.returncode == 0, done.stderr
    assert len(rows(out)) == 51


def test_same_input_gives_the_same_files(tmp_path):
    written = []
    for name in ("one", "two"):
        out = tmp_path / f"{name}.node"
        assert tetractl("mesh", BRACKET, "-o", out, "--quiet").returncode == 0
        written.append([out.with_suffix(s).read_bytes() for s in (".node", ".ele", ".face", ".edge")])
    assert written[0] == written[1]


@pytest.mark.parametrize("suffix, begins", [(".mesh", b"MeshVersionFormatted"), (".vtu", b"<?xml"), (".off", b"OFF")])
def test_output_format_goes_by_the_extension(tmp_path, cube, suffix, begins):
    out = tmp_path / ("out" + suffix)
    done = tetractl("mesh", cube, "-o", out)
    assert done.returncode == 0, done.stderr
    assert out.read_bytes().startswith(begins)
    assert {p.name for p in tmp_path.iterdir()} == {"cube.off", out.name}


def test_extension_may_be_in_capitals(tmp_path, cube):
    loud = cube.rename(tmp_path / "CUBE.OFF")
    assert tetractl("mesh", loud, "-o", tmp_path / "out.NODE").returncode == 0


def only(folder, *names):
    return {p.name for p in folder.iterdir()} == set(names)


def test_missing_file_is_refused_by_name(tmp_path):
    done = tetractl("mesh", tmp_path / "absent.off", "-o", tmp_path / "out.node")
    assert done.returncode == 1 and "absent.off" in done.stderr and only(tmp_path)


@pytest.mark.parametrize("text, line", [
    (CUBE.replace("0 1 1\n", "0 1 one\n"), 10), (CUBE.replace("4 3 0 4 7", "4 3 0 4 8"), 16),
    (CUBE.replace("4 3 0 4 7\n", ""), 15)], ids=["word", "index", "short"])
def test_malformed_file_is_refused_with_its_line(tmp_path, text, line):
    bad = tmp_path / "bad.off"
    bad.write_text(text, encoding="ascii")
    done = tetractl("mesh", bad, "-o", tmp_path / "out.node")
    assert done.returncode == 1 and f"bad.off:{line}" in done.stderr, done.stderr
    assert only(tmp_path, "bad.off")


def test_crossing_facets_are_refused_and_named(tmp_path):
    bad = tmp_path / "crossing.off"
    bad.write_text("OFF\n6 2 0\n0 0 0\n2 0 0\n0 2 0\n.5 .5 -1\n.5 .5 1\n2 2 1\n3 0 1 2\n3 3 4 5\n", encoding="ascii")
    done = tetractl("mesh", bad, "-o", tmp_path / "out.node")
    assert done.returncode == 1 and only(tmp_path, "crossing.off")
    assert "0" in done.stderr and "1" in done.stderr and "facet" in done.stderr


def test_surface_that_encloses_nothing_is_refused(tmp_path):
    bad = tmp_path / "open.off"
    bad.write_text("\n".join(CUBE.replace("8 6 0", "8 5 0").splitlines()[:-1]) + "\n", encoding="ascii")
    done = tetractl("mesh", bad, "-o", tmp_path / "out.node")
    assert done.returncode == 1 and "enclose" in done.stderr and only(tmp_path, "open.off")


@pytest.mark.parametrize("arguments", [[], ["mesh"], ["mesh", "in.off"], ["dance"],
                                       ["mesh", "in.off", "-o", "out.node", "--radius-edge", "x"],
                                       ["mesh", "in.off", "-o", "out.node", "--stage", "half"],
                                       ["mesh", "in.off", "-o", "out.node", "--unheard-of"]])
def test_wrong_usage_ends_with_2(arguments):
    done = tetractl(*arguments)
    assert done.returncode == 2 and done.stderr and not done.stdout


def test_no_server_ends_with_3(tmp_path, cube):
    done = tetractl("mesh", cube, "-o", tmp_path / "out.node", "--connect", f"unix:{tmp_path}/none.sock")
    assert done.returncode == 3 and "none.sock" in done.stderr and only(tmp_path, "cube.off")


def test_unwritable_output_ends_with_5(tmp_path, cube):
    done = tetractl("mesh", cube, "-o", tmp_path / "absent" / "out.node")
    assert done.returncode == 5 and "absent" in done.stderr and only(tmp_path, "cube.off")


def test_jobs_can_be_submitted_watched_fetched_and_deleted(tmp_path, cube, daemon):
    connect = ["--connect", daemon]
    submitted = tetractl("submit", cube, *connect)
    assert submitted.returncode == 0, submitted.stderr
    job = submitted.stdout.strip()
    assert tetractl("watch", job, *connect).returncode == 0
    status = json.loads(tetractl("status", job, "--json", *connect).stdout)
    assert status["state"] == "done"
    assert job in tetractl("jobs", *connect).stdout
    out = tmp_path / "out.node"
    assert tetractl("fetch", job, "-o", out, *connect).returncode == 0
    assert rows(out.with_suffix(".ele"))
    assert tetractl("delete", job, *connect).returncode == 0
    assert tetractl("status", job, *connect).returncode != 0
    assert json.loads(tetractl("stats", "--json", *connect).stdout)["jobs"]["done"] == 0


def wait_for_running_job(connect):
    """The id of the first job that runs."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        listed = json.loads(tetractl("jobs", "--json", *connect).stdout)
        for job in listed["jobs"] if isinstance(listed, dict) else listed:
            if job["state"] == "running":
                return job["job"]
    raise AssertionError("no job came to run")


def test_running_job_is_cancelled(cube, daemon):
    connect = ["--connect", daemon]
    job = tetractl("submit", cube, "--max-volume", "1e-8", *connect).stdout.strip()
    assert wait_for_running_job(connect) == job
    assert tetractl("cancel", job, *connect).returncode == 0
    assert json.loads(tetractl("status", job, "--json", *connect).stdout)["state"] == "cancelled"


def test_interrupt_cancels_the_job_and_ends_with_130(tmp_path, cube, daemon):
    connect = ["--connect", daemon]
    with subprocess.Popen([TETRACTL, "mesh", cube, "-o", tmp_path / "out.node", "--max-volume", "1e-8", *connect],
                          stderr=subprocess.DEVNULL) as mesher:
        job = wait_for_running_job(connect)
        mesher.send_signal(signal.SIGINT)
        assert mesher.wait(PATIENCE) == 130
    status = tetractl("status", job, "--json", *connect)
    assert status.returncode != 0 or json.loads(status.stdout)["state"] == "cancelled"
    assert not list(tmp_path.glob("out*"))
