# SPDX-License-Identifier: Apache-2.0
"""One daemon for all cases; it must outlive them all."""

import pathlib
import sys

import pytest

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from server import PATIENCE, PROGRAMS, Daemon  # pylint: disable=wrong-import-position


@pytest.fixture(scope="session", name="daemon")
def fixture_daemon(tmp_path_factory):
    """The daemon, with a TCP port, two workers and known names."""
    if not (PROGRAMS / "tetrad").exists():
        pytest.skip(f"no programs in {PROGRAMS}")
    daemon = Daemon(tmp_path_factory.mktemp("daemon"), "--workers", 2, "--instance", "here", tcp=True)
    yield daemon
    assert daemon.process.poll() is None, "".join(daemon.log)
    daemon.process.terminate()
    assert daemon.process.wait(PATIENCE) == 0
