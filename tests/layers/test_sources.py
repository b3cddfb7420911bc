# SPDX-License-Identifier: Apache-2.0
"""What can be seen of the sources without compiling them: who includes whom, how long
files and functions are, that each names its licence, and that none speaks of the
machine it was written on."""

import pathlib
import re
import shutil
import subprocess
import sys

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
CODE = ("core", "protocol", "server", "clients")
INCLUDE = re.compile(r'^\s*#\s*include\s+(["<])([^">]+)[">]', re.M)

# The parts of the project, folders or single files: what each may include beside its own.
CORE_CHAIN = ["core/base", "core/exact", "core/mesh", "core/build", "core/refine"]
MAY_INCLUDE = {"core/include": []}
for place, folder in enumerate(CORE_CHAIN):
    MAY_INCLUDE[folder] = ["core/include", *CORE_CHAIN[:place]]
MAY_INCLUDE.update({
    "core/dual": ["core/include", "core/base", "core/exact", "core/mesh"],
    "core/audit": ["core/include", "core/base", "core/exact"],
    "core/engine": ["core/include", *CORE_CHAIN, "core/dual", "core/audit"],
    "protocol": [],
    "server/log.h": [],
    "server/log.c": ["server/log.h"],
    "server/daemon": ["protocol", "server/log.h"],
    "server/worker": ["protocol", "server/log.h", "core/include"],
    "clients/c": ["protocol"],
    "clients/formats": ["protocol/array.h", "protocol/error.h"],
    "clients/cli": ["clients/c", "clients/formats"],
})

# Headers of libraries, by the part that may use them; any part may use the C library's.
LIBRARIES = {
    "jansson.h": ("protocol", "server", "clients"),
    "zlib.h": ("protocol", "server", "clients"),
    "event2/": ("server/daemon",),
}


def sources(suffixes, folders=CODE + ("tests",)):
    return sorted(p for f in folders for p in (ROOT / f).rglob("*") if p.suffix in suffixes and p.is_file())


def within(name, part):
    return name == part or name.startswith(part + "/")


def relative(path):
    return path.relative_to(ROOT).as_posix()


def part_of(path):
    """The part that a path belongs to, or None."""
    name = relative(path)
    owners = [part for part in MAY_INCLUDE if within(name, part)]
    return max(owners, key=len, default=None)


def resolve(source, name):
    """The project's file that an include names, or None where it is not the project's."""
    bases = [source.parent, ROOT, ROOT / "core", ROOT / "core/include", ROOT / "clients/c/include"]
    return next((base / name for base in bases if (base / name).is_file()), None)


def includes(source):
    """(name, the project's file or None) of every include of a source."""
    text = source.read_text(encoding="utf-8")
    return [(name, resolve(source, name)) for _, name in INCLUDE.findall(text)]


def allowed(part, target):
    name = relative(target.resolve())
    return any(within(name, other) for other in [part, *MAY_INCLUDE[part]])


C_SOURCES = sources({".c", ".h"}, CODE)


def test_every_source_belongs_to_a_part():
    assert C_SOURCES
    assert not [relative(p) for p in C_SOURCES if part_of(p) is None]


def test_includes_follow_the_layers():
    wrong = [f"{relative(source)} includes {name}"
             for source in C_SOURCES if part_of(source)
             for name, target in includes(source)
             if target is not None and not allowed(part_of(source), target)]
    assert not wrong, "\n".join(wrong)


def test_libraries_are_used_where_they_may_be():
    wrong = []
    for source in C_SOURCES:
        for name, target in includes(source):
            for library, users in LIBRARIES.items():
                if target is None and name.startswith(library) and not relative(source).startswith(users):
                    wrong.append(f"{relative(source)} includes {name}")
    assert not wrong, "\n".join(wrong)


def test_headers_have_no_circles():
    graph = {s: [t.resolve() for _, t in includes(s) if t] for s in C_SOURCES if s.suffix == ".h"}
    done, open_now = set(), []

    def visit(header):
        if header in done:
            return
        assert header not in open_now, " -> ".join(map(relative, [*open_now, header]))
        open_now.append(header)
        for other in graph.get(header, []):
            visit(other)
        open_now.pop()
        done.add(header)

    for header in graph:
        visit(header)


def test_files_are_short():
    long = [f"{relative(p)}: {n} lines" for p in sources({".c", ".h", ".py"})
            if (n := len(p.read_text(encoding="utf-8").splitlines())) >= 800]
    assert not long, "\n".join(long)


def test_functions_are_short():
    if not shutil.which("ctags"):
        pytest.skip("no ctags")
    if "Universal" not in subprocess.run(["ctags", "--version"], capture_output=True, text=True, check=False).stdout:
        pytest.skip("not universal-ctags")
    tags = subprocess.run(
        ["ctags", "--c-kinds=f", "--fields=+ne", "-f", "-", "-L", "-"], cwd=ROOT, check=True,
        input="\n".join(relative(p) for p in C_SOURCES), capture_output=True, text=True).stdout
    seen, long = 0, []
    for tag in tags.splitlines():
        fields = dict(f.split(":", 1) for f in tag.split("\t")[3:] if ":" in f)
        if "line" in fields and "end" in fields:
            seen += 1
            lines = int(fields["end"]) - int(fields["line"]) + 1
            if lines > 80:
                long.append(f"{tag.split(chr(9))[1]}:{fields['line']} {tag.split(chr(9))[0]}: {lines} lines")
    assert seen > 0
    assert not long, "\n".join(long)


def test_sources_name_their_licence():
    missing = [relative(p) for p in sources({".c", ".h", ".py"})
               if "SPDX-License-Identifier: Apache-2.0" not in "".join(p.read_text(encoding="utf-8").splitlines(True)[:2])]
    assert not missing, "\n".join(missing)


def test_sources_name_no_place_of_a_machine():
    # In two pieces each, so that this file does not find itself.
    places = re.compile("|".join(a + b for a, b in (("/wo", "rk/"), ("/ro", "ot/"), ("/ho", "me/"))))
    marks = re.compile(r"\b(" + "|".join(a + b for a, b in (("TO", "DO"), ("FIX", "ME"), ("X", "XX"))) + r")\b")
    found = []
    for path in sources({".c", ".h", ".py", ".md", ".build", ".service", ".socket", ".conf"}, CODE + ("tests", "systemd")):
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            if places.search(line) or marks.search(line):
                found.append(f"{relative(path)}:{number}: {line.strip()}")
    assert not found, "\n".join(found)


def test_sample_part_is_what_its_generator_prints():
    parts = ROOT / "tests/support/parts"
    printed = subprocess.run([sys.executable, parts / "bracket.py"], capture_output=True, text=True, check=True).stdout
    assert printed == (parts / "bracket.poly").read_text(encoding="ascii")
