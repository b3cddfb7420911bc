# SPDX-License-Identifier: Apache-2.0
"""Generated systems of every family are meshed to what is exactly a CDT, and their
spoiled twins are refused for the right reason; so are the systems in cases/, each of
which once was not.  So they are with break points, which leave no local degeneracy.

TETRAD_RUNS cases in all from seed TETRAD_TEST_SEED on (1: the same ones every time); a
failure prints the command that runs its case again.  tests/support/families does long
runs."""

import functools
import os
import pathlib
import sys

import pytest

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parents[2] / "support"), str(HERE.parents[2] / "support/families")]
import blind  # noqa: E402
import families  # noqa: E402
import models  # noqa: E402
import runs  # noqa: E402

NAMES = sorted(families.FAMILIES)
RUNS = int(os.environ.get("TETRAD_RUNS", 500))
SEED = int(os.environ.get("TETRAD_TEST_SEED", 1))
JUDGE = os.environ.get("TETRAD_JUDGE", "1") == "1"
CASES = sorted((HERE / "cases").glob("*.poly"))


@functools.cache
def judge():
    return models.judge() if JUDGE and models.available() else None


@functools.cache
def results(name):
    return runs.run([name], -(-RUNS // len(NAMES)), SEED, judge())[name]


@functools.cache
def broken(name):
    """Some of the cases with their local degeneracies removed."""
    return runs.run([name], -(-RUNS // len(NAMES) // 4), SEED, judge(), options=runs.BREAKING)[name]


def assert_no(fault, name, found=results):
    said = [runs.complaint(r) for r in found(name) if getattr(r, fault)]
    assert not said, f"{len(said)} of {len(found(name))}:\n" + "\n".join(said)


@pytest.mark.parametrize("name", NAMES)
def test_members_are_meshed(name):
    assert_no("fault", name)


@pytest.mark.parametrize("name", NAMES if JUDGE else [])
def test_meshes_are_judged_exact(name):
    if judge() is None:
        pytest.skip("no judge beside the checkout, or no g++ and CGAL")
    assert all(r.judged or r.blind or r.fault for r in results(name))
    assert sum(r.blind for r in results(name)) < 0.2 * len(results(name))  # it can, mostly
    assert_no("judge_fault", name)


def test_faults_of_meshes_are_not_taken_for_the_judges_blindness(tmp_path):
    pls, path, prefix = families.make("interfaces-far", 3400007), tmp_path / "far.poly", tmp_path / "far"
    pls.write(path)
    done, _ = runs.run_engine(path, prefix)
    assert done.returncode == 0
    said = ["subfaces not listed: 17", "subfaces with another facet's marker: 3"]
    assert blind.cannot_tell(said, pls, prefix)  # a layer of five units in the last place
    assert not blind.cannot_tell([*said, "flat tetrahedra: 1"], pls, prefix)
    faces = prefix.with_suffix(".face")
    head, *rows = faces.read_text().splitlines()
    other = rows[0].rsplit(" ", 1)[0] + " 77"
    faces.write_text("\n".join([head, other, *rows[1:]]) + "\n")
    assert not blind.cannot_tell(said, pls, prefix)
    faces.write_text("\n".join([head, *rows[1:]]) + "\n")
    assert not blind.cannot_tell(said[:1], pls, prefix)


@pytest.mark.parametrize("name", NAMES)
def test_spoiled_members_are_refused(name):
    assert all(r.way for r in results(name))
    assert_no("spoil_fault", name)


@pytest.mark.parametrize("name", NAMES if JUDGE else [])
def test_none_is_slow(name):
    assert_no("time_fault", name)


@pytest.mark.parametrize("name", NAMES)
def test_degeneracies_are_removed(name):
    assert_no("fault", name, broken)
    assert_no("judge_fault", name, broken)
    assert_no("spoil_fault", name, broken)


@pytest.mark.parametrize("path", CASES, ids=lambda p: p.stem)
def test_case(path, tmp_path):
    """The first line says what is to come: `# volume V`, `# meshed` or `# refused STATUS`."""
    _, kind, *value = path.read_text(encoding="ascii").splitlines()[0].split()
    prefix = tmp_path / "case.1"
    done, _ = runs.run_engine(path, prefix)
    if kind == "refused":
        assert runs.refusal_fault(done, runs.spoils.Expected(set(value))) == ""
        return
    assert runs.fault_of(done) == ""
    if kind == "volume":
        assert runs.report_of(done)["volume"] == pytest.approx(float(value[0]), rel=1e-9)
    if judge():
        assert runs.judge_fault(judge(), path, prefix, kind == "volume") == ""
