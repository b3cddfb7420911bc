# SPDX-License-Identifier: Apache-2.0
"""Lets the tests of this folder import what tests/support has for all."""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
