# SPDX-License-Identifier: Apache-2.0
"""Real models, end to end: tetractl meshes each, and an independent judge looks at the
mesh; invalid ones are refused with the offending facets named."""

import re

import models
import pytest

pytestmark = pytest.mark.skipif(not models.available(), reason="no models beside the checkout")
VALID = models.valid_models() if models.available() else []
INVALID = models.folder("invalid") if models.available() else []


@pytest.fixture(scope="module")
def judge():
    program = models.judge()
    if program is None:
        pytest.skip("the judge needs g++ and CGAL")
    return program


@pytest.mark.parametrize("stage", ["cdt", "refine"])
@pytest.mark.parametrize("model", VALID, ids=lambda m: m.name)
def test_mesh_is_what_it_says(model, stage, judge, tmp_path):
    fault, _ = models.check(judge, model, stage, tmp_path)
    assert fault == ""


@pytest.mark.parametrize("model", INVALID, ids=lambda m: m.name)
def test_invalid_model_is_refused(model, tmp_path):
    done, report = models.run_mesher(model, tmp_path / "out.node")
    assert done.returncode == 1, done.stderr
    assert report is None
    assert list(tmp_path.iterdir()) == []
    if model.stem == "degenerated":
        assert re.search(r"enclose", done.stderr) and re.search(r"repeated", done.stderr), done.stderr
    else:
        assert re.search(r"facets? \d+", done.stderr), done.stderr
