# SPDX-License-Identifier: Apache-2.0
"""Clients that are slow, silent, gone or wrong: they cost a bounded amount of memory,
delay nobody, and lose no job."""

import json
import os
import shutil
import socket
import subprocess

import pytest
from harness import Client, Daemon, Refused, cloud, program

SOON = {"limits": {"stall_ms": 500}}


def uploads(client):
    return client.call("server.stats")["bytes"]["uploads"]


def test_a_reader_that_stops_is_closed_and_its_job_kept(tmp_path):
    with Daemon(tmp_path, workers=1, config=SOON) as daemon, daemon.connect() as client:
        job = client.submit(60000, codec="raw")  # 9 MB of result
        end = client.call("job.wait", job=job)
        before = daemon.resident_kib()
        slow = daemon.connect()
        for _ in range(8):
            slow.send("mesh.fetch", job=job)
        assert client.call("job.wait", job=client.submit(100))["state"] == "done"
        daemon.wait_log("connection stalled", why="does not read")
        assert daemon.resident_kib() - before < 16384
        fetch = client.call("mesh.fetch", job=job)
        assert fetch["bytes"] == end["bytes"] > 8 << 20
        assert sum(len(body) for _, body in client.notes) == end["bytes"]
        slow.close()


def test_fetches_alternate_and_other_replies_go_between(tmp_path):
    with Daemon(tmp_path, workers=1) as daemon, daemon.connect() as client:
        job = client.submit(60000, codec="raw")
        client.call("job.wait", job=job)
        first = client.send("mesh.fetch", job=job, arrays=["tetrahedra"])
        second = client.send("mesh.fetch", job=job, arrays=["tetrahedra"])
        status = client.send("job.status", job=job)
        client.receive(status)
        seen = len(client.notes)
        chunks = client.receive(first)["chunks"]
        client.receive(second)
        of = [m["params"]["of"] for m, _ in client.notes]
        assert of.count(first) == of.count(second) == chunks
        both = of[of.index(second):len(of) - of[::-1].index(first)]  # while both send
        assert len(both) > chunks
        assert all(a != b for a, b in zip(both, both[1:]))
        assert seen < len(of), "the status did not wait for the fetches"


def test_a_client_that_vanishes_in_an_upload_leaves_nothing(tmp_path):
    with Daemon(tmp_path, workers=1) as daemon, daemon.connect() as client:
        client.call("server.stats")  # its connection is there now
        descriptors = daemon.descriptors()
        body, params = cloud(50000)
        gone = daemon.connect()
        line = {"jsonrpc": "2.0", "id": 1, "method": "mesh.submit", "params": params,
                "body": len(body)}
        gone.socket.sendall(json.dumps(line).encode() + b"\n" + body[: len(body) // 2])
        while not uploads(client):
            pass
        gone.close()
        while uploads(client):
            pass
        assert client.call("job.list")["jobs"] == []
        assert daemon.descriptors() == descriptors


@pytest.mark.parametrize("half", [
    b'{"jsonrpc":"2.0",',
    b'{"jsonrpc":"2.0","id":1,"method":"mesh.submit","body":48,'
    b'"params":{"pls":{"points":{"dtype":"<f8","shape":[2,3],"at":[0,48]}}}}\n12345'])
def test_a_half_sent_message_ends_its_connection(tmp_path, half):
    with Daemon(tmp_path, workers=1, config=SOON) as daemon, daemon.connect() as client:
        silent = daemon.connect()
        silent.socket.sendall(half)
        daemon.wait_log("connection stalled", why="message half sent")
        assert silent.socket.recv(1) == b""
        assert uploads(client) == 0
        assert client.call("job.list")["jobs"] == []  # idle for longer, and still there


def test_uploads_share_a_budget(tmp_path):
    config = {"limits": {"upload_bytes": 100000}}
    with Daemon(tmp_path, workers=1, config=config) as daemon, daemon.connect() as client:
        body, params = cloud(3000)
        first = daemon.connect()
        line = {"jsonrpc": "2.0", "id": 1, "method": "mesh.submit", "params": params,
                "body": len(body)}
        first.socket.sendall(json.dumps(line).encode() + b"\n" + body[:100])
        while not uploads(client):
            pass
        with pytest.raises(Refused) as refused:
            client.call("mesh.submit", body, **params)
        assert refused.value.name == "busy"
        assert refused.value.data["retry_ms"] > 0
        # The refused body was dropped: the connection goes on, and so does the first one.
        first.socket.sendall(body[100:])
        first.last = 1
        job = first.receive(1)["job"]
        assert first.call("job.wait", job=job)["state"] == "done"
        assert client.submit(3000)


def test_a_body_over_the_limit_is_dropped(tmp_path):
    with Daemon(tmp_path, workers=1, config={"limits": {"max_body": 5000}}) as daemon, \
            daemon.connect() as client:
        body, params = cloud(5000)
        with pytest.raises(Refused) as refused:
            client.call("mesh.submit", body, **params)
        assert refused.value.name == "body_too_large"
        assert client.submit(100)


def test_a_full_line_of_short_numbers_reaches_the_worker(tmp_path):
    """What the daemon passes on is written anew, and longer: 0.1 becomes 0.10000000000000001."""
    with Daemon(tmp_path, workers=1) as daemon, daemon.connect() as client:
        points = [[round(x * 0.1, 1), round(y * 0.1, 1), round(z * 0.1, 1)]
                  for x in range(15) for y in range(15) for z in range(16)]
        pls = {"points": points}
        assert 40000 < len(json.dumps(pls)) < 65000
        job = client.call("mesh.submit", pls=pls, options={"stage": "delaunay"})["job"]
        end = client.call("job.wait", job=job)
        assert end["state"] == "done", end["error"]


def test_open_requests_are_bounded(tmp_path):
    config = {"limits": {"max_requests": 4}}
    with Daemon(tmp_path, workers=1, config=config) as daemon, daemon.connect() as client:
        job = client.submit(100000)
        waits = [client.send("job.wait", job=job) for _ in range(4)]
        late = client.send("server.stats")
        assert client.receive(waits[0])["state"] == "done"
        assert late not in client.replies, "it was not read before the job ended"
        assert client.receive(late)["jobs"]["done"] == 1


@pytest.mark.parametrize("line, name", [
    (b"[]\n", "parse_error"), (b"{}}\n", "parse_error"), (b'{"id":1,"id":2}\n', "parse_error"),
    (b'{"jsonrpc":"2.0","id":1,"method":"server.stats","body":-1}\n', "bad_body"),
    (b"x" * 70000, "line_too_long"),
])
def test_a_broken_stream_is_told_and_closed(tmp_path, line, name):
    with Daemon(tmp_path, workers=1) as daemon:
        client = daemon.connect()
        client.socket.sendall(line + b'{"jsonrpc":"2.0","id":1,"method":"server.stats"}\n')
        message, _ = client.next()
        assert message["id"] is None
        assert message["error"]["data"]["name"] == name
        assert client.socket.recv(100) == b""


def test_a_client_comes_back_for_its_job(tmp_path):
    with Daemon(tmp_path, workers=1) as daemon:
        with daemon.connect() as client:
            job = client.submit(20000)
        with daemon.connect() as client:
            assert client.call("job.wait", job=job)["state"] == "done"
            assert client.call("mesh.fetch", job=job)["chunks"] > 0


def test_a_client_that_only_half_closes_gets_its_answers(tmp_path):
    with Daemon(tmp_path, workers=1) as daemon, daemon.connect() as client:
        job = client.submit(50000)
        wait = client.send("job.wait", job=job)
        client.socket.shutdown(socket.SHUT_WR)
        assert client.receive(wait)["state"] == "done"
        assert client.socket.recv(1) == b""


def test_connections_over_the_limit_wait(tmp_path):
    with Daemon(tmp_path, workers=1, config={"limits": {"max_connections": 2}}) as daemon:
        first, second = daemon.connect(), daemon.connect()
        first.call("server.stats")
        second.call("server.stats")
        third = daemon.connect()
        late = third.send("server.stats")
        first.close()
        assert third.receive(late)["connections"] == 2
        second.close()
        third.close()


@pytest.mark.skipif(not shutil.which("prlimit"), reason="prlimit is not installed")
def test_connections_without_descriptors_wait(tmp_path):
    with Daemon(tmp_path, workers=1, prefix=["prlimit", "--nofile=32"]) as daemon:
        clients = [daemon.connect() for _ in range(40)]
        job = clients[0].submit(100)
        assert clients[0].call("job.wait", job=job)["state"] == "done"
        assert clients[0].call("mesh.fetch", job=job)["chunks"] > 0
        late = clients[-1].send("server.stats")
        for client in clients[:-1]:
            client.close()
        assert clients[-1].receive(late)["jobs"]["done"] == 1
        clients[-1].close()
    assert not [e for e in daemon.log if e.get("level") == "error"]


def test_tcp_needs_hello_and_the_token(tmp_path):
    config = {"tokens": {"ann": "s3cret", "bob": "other"}}
    with Daemon(tmp_path, "--tcp", "127.0.0.1:0", workers=1, config=config) as daemon:
        host, port = next(e["tcp"] for e in daemon.log if "tcp" in e).split(":")

        def connect():
            return Client(socket.create_connection((host, int(port))))

        def refused(client, method, **params):
            with pytest.raises(Refused) as error:
                client.call(method, **params)
            return error.value.name

        assert refused(connect(), "server.stats") == "hello_required"
        assert refused(connect(), "server.hello", protocol=1) == "unauthorized"
        assert refused(connect(), "server.hello", protocol=1, token="s3cre") == "unauthorized"
        ann, bob = connect(), connect()
        assert refused(ann, "server.hello", protocol=9, token="s3cret") == "version_unsupported"
        assert ann.call("server.hello", protocol=1, token="s3cret")["principal"] == "token:ann"
        assert bob.call("server.hello", protocol=1, token="other")["principal"] == "token:bob"
        job = ann.submit(100)
        assert refused(bob, "job.status", job=job) == "job_unknown"
        assert bob.call("job.list")["jobs"] == []
        assert [j["job"] for j in ann.call("job.list")["jobs"]] == [job]
        with daemon.connect() as operator:
            assert [j["job"] for j in operator.call("job.list")["jobs"]] == [job]


def test_a_served_socket_is_not_taken_away(tmp_path):
    with Daemon(tmp_path, workers=1) as daemon:
        second = subprocess.run(
            [program("tetrad"), "--unix", daemon.path, "--spool", str(tmp_path)],
            stderr=subprocess.PIPE, text=True, timeout=60)
        assert second.returncode == 1
        assert "Address already in use" in second.stderr
        with daemon.connect() as client:
            client.call("server.stats")
    assert not os.path.exists(daemon.path)
