# SPDX-License-Identifier: Apache-2.0
"""Requests and replies as data: the files of cases/, whose form cases/README.md tells."""

import json
import pathlib

import pytest

FILES = sorted(pathlib.Path(__file__).with_name("cases").glob("*.json"))
CASES = [(file.stem, case) for file in FILES for case in json.loads(file.read_text("utf-8"))]

KINDS = {
    "$string": lambda v: isinstance(v, str),
    "$integer": lambda v: isinstance(v, int) and not isinstance(v, bool),
    "$number": lambda v: isinstance(v, (int, float)) and not isinstance(v, bool),
    "$boolean": lambda v: isinstance(v, bool),
    "$object": lambda v: isinstance(v, dict),
    "$list": lambda v: isinstance(v, list),
}


def check(pattern, value, names, place="reply"):
    """Compares a value with a pattern; "$=x" remembers it, or compares with what x was."""
    if isinstance(pattern, str) and pattern in KINDS:
        assert KINDS[pattern](value), f"{place}: {value!r} is no {pattern[1:]}"
    elif isinstance(pattern, str) and pattern.startswith("$="):
        assert names.setdefault(pattern[2:], value) == value, place
    elif isinstance(pattern, dict):
        assert isinstance(value, dict), f"{place}: {value!r} is no object"
        for name, part in pattern.items():
            if name.startswith("!"):
                assert name[1:] not in value, f"{place}.{name[1:]} should be absent"
            else:
                assert name in value, f"{place}.{name} is absent from {value!r}"
                check(part, value[name], names, f"{place}.{name}")
    elif isinstance(pattern, list) and pattern[:1] == ["$all"]:
        assert isinstance(value, list)
        for i, part in enumerate(value):
            check(pattern[1], part, names, f"{place}[{i}]")
    elif isinstance(pattern, list):
        assert isinstance(value, list) and len(value) == len(pattern), f"{place}: {value!r}"
        for i, (part, entry) in enumerate(zip(pattern, value)):
            check(part, entry, names, f"{place}[{i}]")
    else:
        assert type(value) is type(pattern) and value == pattern, f"{place}: {value!r}"


def fill(value, names):
    """Puts remembered values into what is sent."""
    if isinstance(value, str) and value.startswith("$="):
        return names[value[2:]]
    if isinstance(value, dict):
        return {name: fill(part, names) for name, part in value.items()}
    if isinstance(value, list):
        return [fill(part, names) for part in value]
    return value


def run_step(wire, step, names):
    """One step of a case."""
    if "send" in step:
        wire.send(fill(step["send"], names), step.get("body", "").encode("latin-1"))
    elif "raw" in step:
        wire.send_bytes(step["raw"].encode("latin-1") * step.get("repeat", 1))
    elif "reply" in step:
        reply = wire.reply(step["reply"])
        wanted = {name: step[name] for name in ("result", "error") if name in step}
        check(wanted, reply, names)
    elif "told" in step:
        found = [params for message, _ in wire.told for params in [message["params"]]
                 if message["method"] == step["told"] and params["of"] == step["of"]]
        assert len(found) >= step.get("least", 1)
        assert len(found) <= step.get("most", len(found))
        check(["$all", step.get("params", {})], found, names, step["told"])
    elif "closed" in step:
        assert wire.read() is None
    else:
        raise AssertionError(f"no such step: {step}")


@pytest.mark.parametrize("subject,case", CASES, ids=[f"{s}: {c['case']}" for s, c in CASES])
def test_case(daemon, subject, case):
    """Runs the steps on a connection of their own."""
    del subject
    wire, names = daemon.connect(case.get("over", "unix")), {}
    try:
        for step in case["steps"]:
            run_step(wire, step, names)
    finally:
        wire.close()
