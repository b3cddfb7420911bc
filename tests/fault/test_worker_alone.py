# SPDX-License-Identifier: Apache-2.0
"""tetrad-worker without a daemon: PROTOCOL.md's appendix, and how it ends."""

import json

import socket
import subprocess
import zlib

import pytest
from harness import LIMIT, Client, cloud, program


class Worker:
    def __init__(self):
        ours, theirs = socket.socketpair()
        self.process = subprocess.Popen([program("tetrad-worker")], stdin=theirs, stdout=theirs,
                                        stderr=subprocess.PIPE)
        theirs.close()
        self.client = Client(ours)
        ready, _ = self.client.next()
        assert ready["method"] == "worker.ready"
        assert ready["params"]["protocol"] == 1
        assert ready["params"]["pid"] == self.process.pid

    def tell(self, method, body=b"", **params):
        message = {"jsonrpc": "2.0", "method": method, "params": params}
        if body:
            message["body"] = len(body)
        self.client.socket.sendall(json.dumps(message).encode() + b"\n" + body)

    def run(self, job, body, params):
        params = {"codec": "raw", "max_decoded_bytes": 1 << 24, **params}
        self.tell("job.run", body, job=job, **params)

    def answer(self):
        """Chunks by array, and the last message."""
        chunks = {}
        while True:
            message, body = self.client.next()
            params = message["params"]
            if message["method"] == "job.chunk":
                chunks.setdefault(params["array"], []).append((params, body))
            elif message["method"] != "job.progress":
                return chunks, message

    def end(self):
        self.client.close()
        _, log = self.process.communicate(timeout=LIMIT)
        assert b"Sanitizer" not in log, log.decode()
        return self.process.returncode


def test_jobs_one_after_the_other_and_the_end_of_input():
    worker = Worker()
    for number in range(20):
        body, params = cloud(200, seed=number)
        worker.run(f"x.{number}", body, params)
        chunks, last = worker.answer()
        assert last["method"] == "job.done"
        assert last["params"]["job"] == f"x.{number}"
        for info in last["params"]["arrays"]:
            came = chunks.pop(info["name"], [])
            assert [p["chunk"] for p, _ in came] == list(range(info["chunks"]))
            assert sum(p["rows"] for p, _ in came) == info["shape"][0]
            data = b"".join(b for _, b in came)
            assert all(zlib.crc32(b) == p["crc32"] for p, b in came)
            assert zlib.crc32(data) == info["crc32"]
        assert not chunks
        names = [s["name"] for s in last["params"]["report"]["stages"]]
        assert names[0] == "delaunay" and names[-2:] == ["audit", "encode"]
    assert worker.end() == 0  # and without a leak, where the build looks for them


@pytest.mark.parametrize("change, name, where", [
    ({"crc32": 1}, "upload", "points"),
    ({"codec": "zlib"}, "upload", "points"),
])
def test_an_upload_that_does_not_open_fails_the_job(change, name, where):
    worker = Worker()
    body, params = cloud(50)
    params["pls"]["points"].update(change)
    worker.run("x.1", body, params)
    _, last = worker.answer()
    error = last["params"]["error"]
    assert last["method"] == "job.failed"
    assert (error["data"]["name"], error["data"]["where"]) == (name, where)
    body, params = cloud(50)
    worker.run("x.2", body, params)
    assert worker.answer()[1]["method"] == "job.done"
    assert worker.end() == 0


def test_a_refused_input_names_its_elements():
    worker = Worker()
    points = [[0, 0, 0], [2, 2, 0], [0, 2, 0], [2, 0, 0], [1, 1, 5], [1, 0, -5]]
    pls = {"points": points, "segments": [[4, 5], [0, 1], [2, 3]]}
    worker.run("x.1", b"", {"pls": pls, "options": {"stage": "cdt", "keep_hull": True}})
    error = worker.answer()[1]["params"]["error"]
    assert (error["code"], error["data"]["name"]) == (106, "intersection")
    assert error["data"]["offences"]["count"] == 1
    offence = error["data"]["offences"]["list"][0]
    assert offence["kind"] == ["segment", "segment"]
    assert sorted(offence["index"]) == [1, 2]
    assert offence["place"] == pytest.approx([1, 1, 0])
    assert worker.end() == 0


@pytest.mark.parametrize("text", [b"nonsense\n", b'{"jsonrpc":"2.0","method":"job.walk","params":{}}\n',
                                  b'{"jsonrpc":"2.0","method":"job.run","params":{}}\n'])
def test_a_broken_daemon_ends_it(text):
    worker = Worker()
    worker.client.socket.sendall(text)
    assert worker.process.wait(timeout=LIMIT) == 70
    worker.end()


def test_the_end_of_input_ends_it_in_mid_job():
    worker = Worker()
    body, params = cloud(400000)
    worker.run("x.1", body, params)
    message, _ = worker.client.next()
    assert message["method"] == "job.progress"
    assert worker.end() == 0
