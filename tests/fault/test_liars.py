# SPDX-License-Identifier: Apache-2.0
"""Workers that break their protocol and clients that send garbage: the job or the
connection pays, the daemon goes on."""

import json
import random
import stat
import sys

import pytest
from harness import Daemon, cloud

LIAR = '''#!{python}
import json, os, sys
stdin, stdout = os.fdopen(0, "rb", 0), os.fdopen(1, "wb", 0)
def tell(method, body=b"", **params):
    message = {{"jsonrpc": "2.0", "method": method, "params": params}}
    if body:
        message["body"] = len(body)
    stdout.write(json.dumps(message).encode() + b"\\n" + body)
def chunk(number=0, array="a", rows=4, body=b"1234"):
    tell("job.chunk", body, job=job, array=array, chunk=number, row=0, rows=rows, crc32=0)
def table(**change):
    return [{{"name": "a", "dtype": "|u1", "shape": [4], "codec": "raw", "rows_per_chunk": 1048576,
             "chunks": 1, "crc32": 0, **change}}]
tell("worker.ready", protocol=1, version="0", pid=os.getpid())
line = b""
while not line.endswith(b"\\n"):
    line += stdin.read(1)
run = json.loads(line)
job = run["params"]["job"]
left = run.get("body", 0)
while left:
    left -= len(stdin.read(left))
{lie}
stdin.read(1)
'''

LIES = {
    "garbage": 'stdout.write(b"what?\\n")',
    "a line without end": 'stdout.write(b"x" * 2000000)',
    "a request": 'stdout.write(b\'{"jsonrpc":"2.0","id":1,"method":"job.done"}\\n\')',
    "an unknown message": 'tell("job.walk", job=job)',
    "another job": 'tell("job.progress", job="x.77", stage="delaunay")',
    "ready twice": 'tell("worker.ready", protocol=1)',
    "a body with progress": 'tell("job.progress", b"12", job=job)',
    "a huge chunk": 'stdout.write(b\'{"jsonrpc":"2.0","method":"job.chunk","body":99999999999,'
                    '"params":{"job":"%s"}}\\n\' % job.encode())',
    "a chunk without a number": 'tell("job.chunk", b"1", job=job, array="a")',
    "a skipped chunk": 'chunk(1)',
    "a repeated chunk": 'chunk(); chunk()',
    "an array taken up again": 'chunk(); chunk(array="b"); chunk(1)',
    "no table": 'chunk(); tell("job.done", job=job)',
    "a missing array": 'chunk(); chunk(array="b"); tell("job.done", job=job, arrays=table())',
    "missing chunks": 'tell("job.done", job=job, arrays=table())',
    "a wrong table": 'chunk(); tell("job.done", job=job, arrays=table(shape=[5]))',
    "a failure without an error": 'tell("job.failed", job=job)',
    "a failure that is none of a job":
        'tell("job.failed", job=job, error={"code": 4, "message": "m"})',
    "exit": 'sys.exit(3)',
    "a closed stream": 'os.close(1); os.close(0); import signal; signal.pause()',
}


def install(folder, lie):
    path = folder / "tetrad-worker"
    path.write_text(LIAR.format(python=sys.executable, lie=lie))
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return {"TETRAD_EXEC_PATH": str(folder)}


@pytest.mark.parametrize("what", LIES)
def test_a_worker_that_lies_loses_its_job_and_its_life(tmp_path, what):
    folder = tmp_path / "bin"
    folder.mkdir()
    with Daemon(tmp_path, workers=1, env=install(folder, LIES[what])) as daemon, \
            daemon.connect() as client:
        job = client.submit(10)
        end = client.call("job.wait", job=job)
        assert end["state"] == "failed"
        name = end["error"]["data"]["name"]
        assert name == "worker_exited"
        assert what != "exit" or end["error"]["data"]["status"] == 3
        daemon.wait_log("worker ready")
        assert client.call("server.stats")["bytes"]["results"] == 0


def test_an_honest_worker_of_the_same_make(tmp_path):
    """The liar's frame is not what the daemon objects to."""
    folder = tmp_path / "bin"
    folder.mkdir()
    honest = 'chunk(); tell("job.done", job=job, arrays=table(), report={"x": 1})'
    with Daemon(tmp_path, workers=1, env=install(folder, honest)) as daemon, \
            daemon.connect() as client:
        job = client.submit(10)
        end = client.call("job.wait", job=job)
        assert (end["state"], end["report"]) == ("done", {"x": 1})
        client.call("mesh.fetch", job=job)
        (message, body), = client.notes
        assert (message["params"]["array"], body) == ("a", b"1234")


def messages(chance):
    """A valid stream of messages to be damaged."""
    body, params = cloud(20, seed=chance.randrange(1000), key=f"k{chance.randrange(3)}")
    texts = [("server.hello", {"protocol": 1}), ("mesh.submit", params), ("job.list", {"limit": 5}),
             ("job.wait", {"key": "k1", "progress_ms": 50}), ("mesh.fetch", {"key": "k0"}),
             ("job.cancel", {"key": "k2"}), ("job.delete", {"key": "k0"}), ("server.stats", {})]
    stream = b""
    for i, (method, p) in enumerate(texts):
        message = {"jsonrpc": "2.0", "id": i, "method": method, "params": p}
        if method == "mesh.submit":
            message["body"] = len(body)
        stream += json.dumps(message).encode() + b"\n" + (body if method == "mesh.submit" else b"")
    return bytearray(stream)


def damage(chance, stream):
    for _ in range(chance.randrange(1, 6)):
        at = chance.randrange(len(stream))
        what = chance.randrange(4)
        if what == 0:
            stream[at] = chance.randrange(256)
        elif what == 1:
            del stream[at:at + chance.randrange(1, 20)]
        elif what == 2:
            stream[at:at] = stream[chance.randrange(len(stream)):][:chance.randrange(1, 40)]
        else:
            stream[at:at] = chance.choice([b'"', b"{", b"]", b"\n", b"-1", b"1e999", b"null"])
    return bytes(stream)


def test_damaged_streams_hurt_nobody_else(tmp_path):
    seed = 7
    chance = random.Random(seed)
    with Daemon(tmp_path, workers=2) as daemon, daemon.connect() as client:
        client.call("server.stats")
        descriptors = daemon.descriptors()
        for number in range(300):
            print("seed", seed, "stream", number)
            victim = daemon.connect()
            try:
                victim.socket.sendall(damage(chance, messages(chance)))
                victim.socket.shutdown(1)
                while victim.socket.recv(1 << 16):
                    pass
            except ConnectionError:
                pass  # it was closed while we wrote
            victim.close()
        assert client.call("job.wait", job=client.submit(100))["state"] == "done"
        while client.call("server.stats")["connections"] > 1:
            pass
        assert daemon.descriptors() == descriptors
        assert client.call("server.stats")["bytes"]["uploads"] == 0
