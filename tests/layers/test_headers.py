# SPDX-License-Identifier: Apache-2.0
"""Each public header compiles alone, twice in one file, as C11 and as C++17."""

import pathlib
import shutil
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
HEADERS = sorted(ROOT.glob("core/include/tet/*.h")) + sorted(ROOT.glob("clients/c/include/*/*.h"))
LANGUAGES = {
    "c11": (["gcc", "clang", "cc"], ["-x", "c", "-std=c11", "-Wstrict-prototypes"]),
    "c++17": (["g++", "clang++", "c++"], ["-x", "c++", "-std=c++17"]),
}


def include_folder(header):
    return header.parent.parent


@pytest.mark.parametrize("language", LANGUAGES)
@pytest.mark.parametrize("header", HEADERS, ids=lambda h: str(h.relative_to(ROOT)))
def test_header_stands_alone(header, language):
    compilers, flags = LANGUAGES[language]
    found = [c for c in compilers if shutil.which(c)]
    if not found:
        pytest.skip(f"no compiler for {language}")
    line = f'#include "{header}"\n'
    for compiler in found:
        result = subprocess.run(
            [compiler, *flags, "-fsyntax-only", "-pedantic-errors", "-Wall", "-Wextra", "-Werror",
             "-I", str(include_folder(header)), "-"],
            input=line + line, capture_output=True, text=True, check=False)
        assert result.returncode == 0, f"{compiler}: {result.stderr}"


def test_there_are_public_headers():
    assert {h.name for h in HEADERS} >= {"context.h", "engine.h", "mesh.h", "pls.h", "status.h"}
