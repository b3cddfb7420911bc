# SPDX-License-Identifier: Apache-2.0
"""tetractl from the command line to the written files, most of it with the private daemon
that `tetractl mesh` starts for itself."""

import base64
import itertools
import json
import math
import operator
import os
import pathlib
import pty
import random
import select
import signal
import struct
import subprocess
import time
import xml.etree.ElementTree
import zlib

import pytest
from harness import LIMIT, ROOT, TETRACTL, Daemon, free_port

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
def fixture_daemon(tmp_path_factory):
    """A running daemon; gives the address to connect to."""
    with Daemon(tmp_path_factory.mktemp("daemon"), workers=1) as running:
        yield f"unix:{running.path}"
        running.process.terminate()
        assert running.wait() == 0


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
    assert sorted(names) == sorted(["delaunay", "surface", "segments", "facets", "regions", "refine", "audit",
                                    "encode"])
    assert all(stage["seconds"] >= 0 and stage["peak_bytes"] > 0 for stage in said["stages"])
    assert said["audit"]["passed"] is True
    assert said["promised"]["radius_edge"] == 2.0 and said["promised"]["max_volume"] == 40
    assert said["quality"]["volume"] == pytest.approx(52165.49, rel=1e-6)
    # The rib's ends are sharp (45 degrees): what they forbid is listed with them, and is little.
    assert said["exceptions"]["count"] <= 0.05 * (len(tetrahedra) - 1)
    assert all(exception["segment"] for exception in said["exceptions"]["list"])


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


def test_threads_do_not_show_in_the_mesh(tmp_path):
    random.seed(8)
    points = tmp_path / "points.node"
    lines = [f"{i} {random.random()!r} {random.random()!r} {random.random()!r}" for i in range(60000)]
    points.write_text("\n".join(["60000 3 0 0", *lines]), encoding="ascii")
    for threads in "1", "2":
        done = tetractl("mesh", points, "-o", tmp_path / f"out{threads}.node", "--stage", "delaunay",
                        "--threads", threads)
        assert done.returncode == 0, done.stderr
    for suffix in ".node", ".ele", ".face":
        assert (tmp_path / f"out1{suffix}").read_bytes() == (tmp_path / f"out2{suffix}").read_bytes()
    assert tetractl("mesh", points, "-o", tmp_path / "no.node", "--threads", "0").returncode == 2


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
    end = time.monotonic() + LIMIT
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
        assert mesher.wait(LIMIT) == 130
    status = tetractl("status", job, "--json", *connect)
    assert status.returncode != 0 or json.loads(status.stdout)["state"] == "cancelled"
    assert not list(tmp_path.glob("out*"))


def vtu_array(grid, name, code):
    """One inline array of a .vtu file, as VTK reads it: base64 of a header and of zlib blocks."""
    text = grid.find(f".//DataArray[@Name='{name}']").text.strip()
    blocks = struct.unpack("<Q", base64.b64decode(text[:12])[:8])[0]
    header_text = 4 * ((8 * (3 + blocks) + 2) // 3)
    header = struct.unpack(f"<{3 + blocks}Q", base64.b64decode(text[:header_text]))
    packed, raw = base64.b64decode(text[header_text:]), b""
    for size in header[3:]:
        raw += zlib.decompress(packed[:size])
        packed = packed[size:]
    assert packed == b""
    assert header[0] == blocks and header[1] == 1 << 16
    return [v[0] for v in struct.iter_unpack("<" + code, raw)]


def test_vtu_holds_cells_regions_markers_and_quality(tmp_path):
    out, text, report = tmp_path / "b.vtu", tmp_path / "b.node", tmp_path / "b.json"
    for path in (out, text):
        assert tetractl("mesh", BRACKET, "-o", path, "--quiet", "--report", report).returncode == 0
    grid = xml.etree.ElementTree.parse(out).getroot()
    piece = grid.find(".//Piece")
    tetrahedra, faces, edges = (rows(text.with_suffix(s))[1:] for s in (".ele", ".face", ".edge"))
    kinds = vtu_array(grid, "types", "B")
    assert kinds == [10] * len(tetrahedra) + [5] * len(faces) + [3] * len(edges)
    assert int(piece.get("NumberOfCells")) == len(kinds)
    points = vtu_array(grid, "points", "d")
    assert points == [float(x) for node in rows(text)[1:] for x in node[1:4]]
    first = int(rows(text)[1][0])
    ends = [int(v) - first for t in tetrahedra for v in t[1:5]]
    assert vtu_array(grid, "connectivity", "q")[:len(ends)] == ends
    assert vtu_array(grid, "offsets", "q")[-1] == 4 * len(tetrahedra) + 3 * len(faces) + 2 * len(edges)
    assert vtu_array(grid, "region", "i")[:len(tetrahedra)] == [int(t[5]) for t in tetrahedra]
    markers = [int(f[4]) for f in faces] + [int(e[3]) for e in edges]
    cells = grid.find(".//CellData")
    assert vtu_array(cells, "marker", "i")[len(tetrahedra):] == markers
    ratios = vtu_array(grid, "radius_edge", "d")[:len(tetrahedra)]
    said = json.loads(report.read_text(encoding="utf-8"))["exceptions"]
    assert 0.6 < min(ratios) and sum(ratio > 2.0 for ratio in ratios) == said["count"]
    assert 0 < min(vtu_array(grid, "least_dihedral", "d")[:len(tetrahedra)]) < 70.6


@pytest.mark.parametrize("options, name", [
    (["--max-vertices", "20"], "vertex_limit"), (["--deadline", "0.05"], "deadline"),
    (["--memory", "1M"], "memory")], ids=lambda v: v if isinstance(v, str) else "")
def test_limits_end_with_4(tmp_path, cube, options, name):
    done = tetractl("mesh", cube, "-o", tmp_path / "out.node", "--max-volume", "1e-7", *options)
    assert done.returncode == 4 and name in done.stderr, done.stderr
    assert only(tmp_path, "cube.off")


def test_neighbours_are_mutual(tmp_path, cube):
    out = tmp_path / "out.node"
    assert tetractl("mesh", cube, "-o", out, "--neighbours", "--quiet").returncode == 0
    table = [[int(x) for x in row[1:]] for row in rows(out.with_suffix(".neigh"))[1:]]
    assert len(table) == len(rows(out.with_suffix(".ele"))) - 1
    for t, row in enumerate(table):
        assert all(n == -1 or t in table[n] for n in row)
    assert any(-1 in row for row in table)


def numbers(path):
    """The rows of a table, without header and number: words."""
    return [row[1:] for row in rows(path)[1:]]


def test_voronoi_cells_are_written(tmp_path):
    out, report = tmp_path / "b.node", tmp_path / "b.json"
    done = tetractl("mesh", BRACKET, "-o", out, "--report", report, "--max-volume", 100, "--voronoi")
    assert done.returncode == 0, done.stderr
    assert "Voronoi" in done.stdout
    said = json.loads(report.read_text(encoding="utf-8"))
    points = [tuple(map(float, p[:3])) for p in numbers(out)]
    cells, factors = numbers(tmp_path / "b.v.volume"), numbers(tmp_path / "b.v.factor")
    assert len(cells) == said["voronoi"]["cells"] and len(factors) == said["voronoi"]["edges"]
    by_region = {}
    for _, region, volume in cells:
        by_region[region] = by_region.get(region, 0) + float(volume)
    assert set(by_region) == {"1", "2"}
    assert sum(by_region.values()) == pytest.approx(said["quality"]["volume"], rel=1e-12)
    if said["promised"]["delaunay"] and said["promised"]["gabriel"]:
        assert said["voronoi"]["negative_factors"] == 0

    # Every cell's volume follows from its factors; every surface share belongs to its .face row.
    of_cell = {(int(k), region): 0 for k, region, _ in cells}
    for k, l, region, factor in factors:
        squared = sum((a - b) ** 2 for a, b in zip(points[int(k) - 1], points[int(l) - 1]))
        for v in int(k), int(l):
            of_cell[v, region] += float(factor) * squared / 6
    for k, region, volume in cells:
        assert of_cell[int(k), region] == pytest.approx(float(volume), rel=1e-9)
    shares = numbers(tmp_path / "b.v.share")
    assert [s[:4] for s in shares] == numbers(out.with_suffix(".face"))

    # The polyhedra: each edge of a cell has two of its faces.
    sides, faces = numbers(tmp_path / "b.v.edge"), numbers(tmp_path / "b.v.face")
    bodies = numbers(tmp_path / "b.v.cell")
    assert len(bodies) == len(cells)
    assert len(numbers(tmp_path / "b.v.node")) == max(int(x) for s in sides for x in s)
    for c, body in enumerate(bodies, 1):
        met = {}
        assert len(body) == int(body[0]) + 1
        for face in (faces[int(f) - 1] for f in body[1:]):
            assert str(c) in face[:2] and len(face) == int(face[2]) + 3
            for side in face[3:]:
                met[side] = met.get(side, 0) + 1
        assert set(met.values()) == {2}


def test_voronoi_cells_beside_vtu(tmp_path, cube):
    out = tmp_path / "c.vtu"
    assert tetractl("mesh", cube, "-o", out, "--voronoi", "--quiet").returncode == 0
    grid = xml.etree.ElementTree.parse(tmp_path / "c.voronoi.vtu").getroot()
    assert grid.find("UnstructuredGrid/Piece").get("NumberOfCells") == "8"
    flat = vtu_array(grid, "points", "d")
    points = [flat[i:i + 3] for i in range(0, len(flat), 3)]
    corners, offsets = vtu_array(grid, "connectivity", "q"), vtu_array(grid, "offsets", "q")
    faces, ends = vtu_array(grid, "faces", "q"), vtu_array(grid, "faceoffsets", "q")
    assert vtu_array(grid, "types", "B") == [42] * 8
    assert vtu_array(grid, "vertex", "q") == list(range(8))
    assert offsets[-1] == len(corners) and ends[-1] == len(faces)
    for c, volume in enumerate(vtu_array(grid, "volume", "d")):
        assert volume == pytest.approx(1 / 8)
        stream, used, found = iter(faces[ends[c - 1] if c else 0:ends[c]]), set(), 0
        for _ in range(next(stream)):
            polygon = [next(stream) for _ in range(next(stream))]
            used.update(polygon)
            a, *others = (points[i] for i in polygon)
            for b, d in zip(others, others[1:]):  # the cell's outward side: six times the volume under it
                found += (a[0] * (b[1] * d[2] - b[2] * d[1]) - a[1] * (b[0] * d[2] - b[2] * d[0])
                          + a[2] * (b[0] * d[1] - b[1] * d[0]))
        assert next(stream, None) is None
        assert found / 6 == pytest.approx(1 / 8)
        assert sorted(used) == corners[offsets[c - 1] if c else 0:offsets[c]]


@pytest.mark.parametrize("wrong", [("--stage", "delaunay"), ("--stage", "cdt", "--keep-hull")])
def test_voronoi_cells_need_facets(tmp_path, cube, wrong):
    done = tetractl("mesh", cube, "-o", tmp_path / "c.node", "--voronoi", *wrong)
    assert done.returncode == 2 and "--voronoi" in done.stderr
    assert only(tmp_path, "cube.off")


def test_voronoi_cells_need_a_format_that_has_them(tmp_path, cube):
    done = tetractl("mesh", cube, "-o", tmp_path / "c.mesh", "--voronoi")
    assert done.returncode == 2 and "Voronoi" in done.stderr
    assert only(tmp_path, "cube.off")


def test_quiet_is_silent_and_json_is_the_report(tmp_path, cube):
    report = tmp_path / "r.json"
    done = tetractl("mesh", cube, "-o", tmp_path / "a.node", "--quiet", "--report", report)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    shown = json.loads(tetractl("mesh", cube, "-o", tmp_path / "a.node", "--json").stdout)
    kept = json.loads(report.read_text(encoding="utf-8"))
    assert shown["counts"] == kept["counts"] and shown["exceptions"] == {"count": 0, "list": []}
    assert kept["first_index"] == 0


@pytest.fixture(name="wedge")
def fixture_wedge(tmp_path):
    path = tmp_path / "wedge.smesh"
    path.write_text("6 3 0 0\n1 0 0 0\n2 0 1 0\n3 1 0 0\n4 1 1 0\n5 1 0 .02\n6 1 1 .02\n5 1\n"
                    "4 1 3 4 2 1\n4 1 5 6 2 2\n3 1 3 5 3\n3 2 4 6 4\n4 3 4 6 5 5\n0\n0\n", encoding="ascii")
    return path


def test_exceptions_are_listed_with_their_sharp_segment(tmp_path, wedge):
    out, report = tmp_path / "out.node", tmp_path / "r.json"
    done = tetractl("mesh", wedge, "-o", out, "--report", report, "--radius-edge", "1.2")
    assert done.returncode == 0, done.stderr
    said = json.loads(report.read_text(encoding="utf-8"))
    listed = said["exceptions"]["list"]
    assert said["first_index"] == 1 and said["exceptions"]["count"] == len(listed)
    tetrahedra, edges = rows(out.with_suffix(".ele"))[1:], rows(out.with_suffix(".edge"))[1:]
    ends = {tuple(sorted(int(v) for v in edge[1:3])) for edge in edges}
    for exception in listed:
        assert exception["radius_edge"] > 1.2
        assert 1 <= exception["tetrahedron"] <= len(tetrahedra)
        assert exception["segment"] is None or tuple(sorted(exception["segment"]["vertices"])) in ends


def least_dihedral(corners):
    """A tetrahedron's smallest dihedral angle, degrees."""
    normals = []
    for i in range(4):
        a, b, c = (corners[j] for j in range(4) if j != i)
        u, v, w = ([q - p for p, q in zip(a, other)] for other in (b, c, corners[i]))
        n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
        outward = -math.copysign(math.hypot(*n), sum(map(operator.mul, n, w)))
        normals.append([x / outward for x in n])
    return math.degrees(math.acos(-min(sum(map(operator.mul, m, n)) for m, n in itertools.combinations(normals, 2))))


def test_slivers_are_removed_unless_they_may_stay(tmp_path, cube):
    said, least = {}, {}
    for name, options in (("usual", []), ("bound", ["--bound-only"]), ("more", ["--min-dihedral", "12"])):
        report = tmp_path / f"{name}.json"
        done = tetractl("mesh", cube, "-o", tmp_path / f"{name}.node", "--max-volume", "2e-4", "--report", report,
                        *options)
        assert done.returncode == 0, done.stderr
        assert (", slivers " in done.stdout) == (name != "bound")
        said[name] = json.loads(report.read_text(encoding="utf-8"))
        points = [tuple(map(float, p[:3])) for p in numbers(tmp_path / f"{name}.node")]
        least[name] = [least_dihedral([points[int(v)] for v in t[:4]]) for t in numbers(tmp_path / f"{name}.ele")]
        assert said[name]["audit"]["passed"] is True and said[name]["audit"]["under_dihedral"] == 0
        assert min(least[name]) == pytest.approx(said[name]["quality"]["dihedral_min"]["min"])
    assert said["usual"]["promised"]["min_dihedral"] == 5 and said["usual"]["slivers"] == {"count": 0, "list": []}
    assert min(least["usual"]) >= 5
    assert "min_dihedral" not in said["bound"]["promised"] and said["bound"]["counts"]["first_slivers"] == 0
    slivers = sum(angle < 5 for angle in least["bound"])
    assert slivers == said["usual"]["counts"]["first_slivers"] > 0
    assert said["usual"]["counts"]["sliver_points"] > 0 == said["bound"]["counts"]["sliver_points"]
    assert said["usual"]["counts"]["sliver_budget"] > said["usual"]["counts"]["sliver_points"]
    assert said["more"]["promised"]["min_dihedral"] == 12
    assert sum(angle < 12 for angle in least["more"]) == said["more"]["slivers"]["count"]


def test_facets_are_merged_by_an_angle_and_the_report_says_how_far(tmp_path):
    roof = tmp_path / "roof.off"  # its two sides meet at 11.42 degrees off flat
    roof.write_text("OFF\n10 8 0\n0 0 0\n2 0 0\n2 1 0\n0 1 0\n0 0 1\n2 0 1\n2 1 1\n0 1 1\n1 0 1.1\n1 1 1.1\n"
                    "4 0 1 2 3\n5 0 1 5 8 4\n4 1 2 6 5\n5 2 3 7 9 6\n4 3 0 4 7\n4 4 8 9 7\n4 8 5 6 9\n"
                    "4 4 8 9 7\n", encoding="utf-8")
    for angle, merged in ((11, 0), (12, 11.4211862)):
        report = tmp_path / "r.json"
        done = tetractl("mesh", roof, "-o", tmp_path / "a.node", "--merge-angle", str(angle), "--report", report)
        assert done.returncode == 0, done.stderr
        said = json.loads(report.read_text(encoding="utf-8"))
        assert said["audit"]["passed"] is True and said["promised"]["merge_angle"] == angle
        assert said["promised"]["merged_angle"] == pytest.approx(merged)
        assert said["promised"]["merged_distance"] == pytest.approx(0.19900744 if merged else 0)
    done = tetractl("mesh", roof, "-o", tmp_path / "a.node", "--report", report)
    assert done.returncode == 0 and "merge_angle" not in json.loads(report.read_text(encoding="utf-8"))["promised"]


@pytest.mark.parametrize("stage", ["cdt", "refine"])
def test_break_points_are_added_where_asked_for(tmp_path, cube, stage):
    for option, counts in (([], {0}), (["--break-points"], {3, 4, 5, 6})):  # one on a side, of two squares mostly
        out, report = tmp_path / "out.node", tmp_path / "r.json"
        done = tetractl("mesh", cube, "-o", out, "--report", report, "--stage", stage, *option)
        assert done.returncode == 0, done.stderr
        said = json.loads(report.read_text(encoding="utf-8"))
        assert said["audit"]["passed"] is True
        assert said["counts"]["break_points"] in counts and said["counts"]["degeneracies_left"] == 0
        assert len(numbers(out)) >= 8 + said["counts"]["break_points"]
        assert ("degeneracies" in [s["name"] for s in said["stages"]]) == bool(option)


def test_break_points_without_facets_end_with_2(tmp_path, cube):
    done = tetractl("mesh", cube, "-o", tmp_path / "out.node", "--stage", "delaunay", "--break-points")
    assert done.returncode == 2 and "--break-points" in done.stderr, done.stderr
    assert only(tmp_path, "cube.off")


def test_slivers_that_stay_are_listed_with_their_sharp_segment(tmp_path, wedge):
    out, report = tmp_path / "out.node", tmp_path / "r.json"
    done = tetractl("mesh", wedge, "-o", out, "--report", report, "--min-dihedral", "20")
    assert done.returncode == 0, done.stderr
    listed = json.loads(report.read_text(encoding="utf-8"))["slivers"]
    assert 0 < listed["count"] == len(listed["list"])
    points = [None, *(tuple(map(float, p[:3])) for p in numbers(out))]
    tetrahedra, edges = rows(out.with_suffix(".ele"))[1:], rows(out.with_suffix(".edge"))[1:]
    ends = {tuple(sorted(int(v) for v in edge[1:3])) for edge in edges}
    for sliver in listed["list"]:
        corners = [points[int(v)] for v in tetrahedra[sliver["tetrahedron"] - 1][1:5]]
        assert sliver["dihedral"] < 20 and sliver["dihedral"] == pytest.approx(least_dihedral(corners))
        assert tuple(sorted(sliver["segment"]["vertices"])) in ends


@pytest.mark.parametrize("wrong, told", [
    (["--min-dihedral", "40"], "min_dihedral is no number from 0 to 30"), (["--min-dihedral", "-1"], "--min-dihedral"),
    (["--min-dihedral", "5", "--bound-only"], "--bound-only"),
    (["--stage", "cdt", "--min-dihedral", "5"], "--stage refine"),
    (["--stage", "cdt", "--bound-only"], "--stage refine"),
    (["--merge-angle", "46"], "merge_angle is no number from 0 to 45"), (["--merge-angle", "0"], "--merge-angle"),
    (["--merge-angle", "x"], "--merge-angle"), (["--stage", "cdt", "--merge-angle", "5"], "--stage refine")])
def test_wrong_angles_end_with_2(tmp_path, cube, wrong, told):
    done = tetractl("mesh", cube, "-o", tmp_path / "out.node", *wrong)
    assert done.returncode == 2 and told in done.stderr, done.stderr
    assert only(tmp_path, "cube.off")


def test_the_insertion_order_is_chosen(tmp_path):
    points = ["10 3 0 0", *(f"{i} {i & 1} {i >> 1 & 1} {i >> 2}" for i in range(8)), "8 .5 .5 .5", "9 .5 .5 .503"]
    (tmp_path / "box.smesh").write_text("\n".join([*points, "6 0", "4 0 1 3 2", "4 4 5 7 6", "4 0 1 5 4", "4 2 3 7 6",
                                                    "4 0 2 6 4", "4 1 3 7 5", "0", "0", ""]), encoding="ascii")
    meshes = {}
    for order in ("O2_O1", "O1", "O2", "O3", "O4", "O5", "relatively_short", None):
        out, report = tmp_path / "out.node", tmp_path / "report.json"
        done = tetractl("mesh", tmp_path / "box.smesh", "-o", out, "--report", report, "--radius-edge", "1.2",
                        *(["--order", order] if order else []))
        assert done.returncode == 0, done.stderr
        said = json.loads(report.read_text(encoding="utf-8"))
        assert said["audit"]["passed"] and said["exceptions"]["count"] == 0
        meshes[order] = out.read_bytes()
    assert meshes[None] == meshes["O2_O1"] and len(set(meshes.values())) > 3


@pytest.mark.parametrize("wrong, told", [
    (["--order", "O6"], "'O6' is no value of --order"), (["--order", "short"], "--order"),
    (["--stage", "cdt", "--order", "O1"], "--stage refine")])
def test_wrong_insertion_orders_end_with_2(tmp_path, cube, wrong, told):
    done = tetractl("mesh", cube, "-o", tmp_path / "out.node", *wrong)
    assert done.returncode == 2 and told in done.stderr, done.stderr
    assert only(tmp_path, "cube.off")


@pytest.mark.parametrize("bound, proven", [("1", False), ("1.4139", False), ("1.414", True), ("2", True)])
def test_bounds_below_the_root_of_2_come_without_a_guarantee(tmp_path, cube, bound, proven):
    report = tmp_path / "report.json"
    done = tetractl("mesh", cube, "-o", tmp_path / "out.node", "--report", report, "--radius-edge", bound)
    assert done.returncode == 0, done.stderr
    assert ("no guarantee" in done.stdout) == (not proven), done.stdout
    promised = json.loads(report.read_text(encoding="utf-8"))["promised"]
    assert promised["radius_edge"] == float(bound) and promised["radius_edge_proven"] is proven


@pytest.mark.parametrize("bound", ["0.999", "0", "-2", "nan", "two"])
def test_bounds_below_1_are_refused(tmp_path, cube, bound):
    done = tetractl("mesh", cube, "-o", tmp_path / "out.node", "--radius-edge", bound)
    assert done.returncode == 2 and "--radius-edge" in done.stderr, done.stderr
    assert only(tmp_path, "cube.off")


def test_a_point_cloud_is_refined(tmp_path):
    row = "{} {} {} {}".format
    cloud = [row(i, i & 1, i >> 1 & 1, i >> 2) for i in range(8)]  # a cube, and two clusters in it
    cloud += [row(8 + i, .3 + .01 * (i % 3), .4 + .011 * (i % 5), .4 + .012 * (i % 7)) for i in range(60)]
    (tmp_path / "cloud.node").write_text("\n".join([f"{len(cloud)} 3 0 0", *cloud, ""]), encoding="ascii")
    out, report = tmp_path / "out.node", tmp_path / "report.json"
    done = tetractl("mesh", tmp_path / "cloud.node", "-o", out, "--report", report)
    assert done.returncode == 0, done.stderr
    assert "boundary conforming Delaunay" in done.stdout
    said = json.loads(report.read_text(encoding="utf-8"))
    assert said["audit"]["passed"] and said["exceptions"]["count"] == 0
    assert said["quality"]["radius_edge"]["max"] < 2.0000001
    assert said["quality"]["volume"] == pytest.approx(1)
    assert [r[:4] for r in rows(out)[1:69]] == [[f"{float(x):.17g}" for x in r.split()] for r in cloud]
    surface = numbers(out.with_suffix(".face"))
    points = [tuple(map(float, p[:3])) for p in numbers(out)]
    for corners in surface:
        corners = [points[int(v)] for v in corners[:3]]
        assert any(len({c[k] for c in corners}) == 1 and corners[0][k] in (0, 1) for k in range(3))


def test_progress_is_drawn_on_a_terminal_alone(tmp_path, cube):
    try:
        master, slave = pty.openpty()
    except OSError:
        pytest.skip("no terminals here")
    with subprocess.Popen([TETRACTL, "mesh", cube, "-o", tmp_path / "a.node", "--max-volume", "1e-5"],
                          stderr=slave, stdout=subprocess.DEVNULL) as mesher:
        os.close(slave)
        drawn = b""
        while True:
            try:
                piece = os.read(master, 4096)
            except OSError:  # how Linux tells the other end's close
                break
            if not piece:
                break
            drawn += piece
    os.close(master)
    assert mesher.returncode == 0
    assert b"tetrahedra" in drawn and b"refine" in drawn and drawn.endswith(b"\r\x1b[K")


def children(pid):
    return [int(p) for p in pathlib.Path(f"/proc/{pid}/task/{pid}/children").read_text("ascii").split()]


def test_private_daemon_ends_when_its_client_is_killed(tmp_path, cube):
    with subprocess.Popen([TETRACTL, "mesh", cube, "-o", tmp_path / "a.node", "--max-volume", "1e-8"],
                          stderr=subprocess.DEVNULL) as mesher:
        end = time.monotonic() + LIMIT
        while not (daemons := children(mesher.pid)) or not (workers := children(daemons[0])):
            assert time.monotonic() < end
        ends = [os.pidfd_open(p) for p in daemons + workers]
        mesher.kill()
    for end_of in ends:
        # A pidfd can be read when its process has ended.
        assert select_one(end_of), "a process of the private daemon lives on"
        os.close(end_of)
    assert only(tmp_path, "cube.off")


def test_every_codec_brings_the_same_mesh_over_tcp(tmp_path, tmp_path_factory):
    port, written = free_port(), []
    with Daemon(tmp_path_factory.mktemp("daemon"), "--tcp", f"127.0.0.1:{port}", workers=1):
        for codec in ("mesh", "zlib", "raw"):
            out = tmp_path / f"{codec}.node"
            done = tetractl("mesh", BRACKET, "-o", out, "--codec", codec, "--quiet", "--voronoi",
                            "--connect", f"tcp:127.0.0.1:{port}")
            assert done.returncode == 0, done.stderr
            written.append([out.with_suffix(s).read_bytes() for s in (".node", ".ele", ".face", ".edge", ".v.volume",
                                                                      ".v.factor", ".v.share", ".v.node", ".v.cell")])
    assert written[0] == written[1] == written[2]


def select_one(descriptor):
    return select.select([descriptor], [], [], LIMIT)[0]
