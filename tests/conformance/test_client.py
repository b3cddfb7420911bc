# SPDX-License-Identifier: Apache-2.0
"""The small client of client.py, written from PROTOCOL.md alone, against the daemon."""

import json
import pathlib
import struct
import subprocess
import sys

import pytest

CLIENT = pathlib.Path(__file__).with_name("client.py")


def volume(points, tetrahedron):
    """Of one tetrahedron, signed."""
    a, b, c, d = (points[v] for v in tetrahedron)
    u, v, w = ([q - p for p, q in zip(a, e)] for e in (b, c, d))
    return (u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0])
            + u[2] * (v[0] * w[1] - v[1] * w[0])) / 6


@pytest.mark.parametrize("over", ["unix", "tcp"])
@pytest.mark.parametrize("inside", [0, 1000, 50000])
def test_cube(daemon, over, inside):
    """The cube comes back with its volume; 50000 points need several chunks per array."""
    address = "unix:" + daemon.unix if over == "unix" else "tcp:%s:%d" % daemon.tcp
    done = subprocess.run([sys.executable, CLIENT, address, str(inside)], capture_output=True,
                          text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    mesh = json.loads(done.stdout)
    points = list(struct.iter_unpack("<3d", bytes.fromhex(mesh["points"])))
    tetrahedra = list(struct.iter_unpack("<4I", bytes.fromhex(mesh["tetrahedra"])))
    assert len(points) == mesh["shapes"]["points"][0] >= 8 + inside
    assert len(tetrahedra) == mesh["shapes"]["tetrahedra"][0] >= 5
    volumes = [volume(points, t) for t in tetrahedra]
    assert min(volumes) > 0
    assert abs(sum(volumes) - 1) < 1e-12


def test_client_is_small():
    """Standard library alone, and at most 60 lines."""
    lines = CLIENT.read_text("utf-8").splitlines()
    assert len(lines) <= 60
    imports = [line for line in lines if line.startswith(("import", "from"))]
    assert imports == ["import json, random, socket, struct, sys, zlib"]
