# SPDX-License-Identifier: Apache-2.0
"""Workers that die: their job ends with an error that says how, nothing else does."""

import contextlib
import os
import random
import resource
import signal
import subprocess
import threading

import pytest
from harness import Daemon, Refused, cloud, program, sanitized, wait_dead

LONG = 400000  # points: seconds of work


@pytest.mark.parametrize("number, name", [
    (signal.SIGKILL, "worker_killed"), (signal.SIGTERM, "worker_killed"),
    (signal.SIGABRT, "worker_crashed"),
    pytest.param(signal.SIGSEGV, "worker_crashed",
                 marks=pytest.mark.skipif(sanitized(), reason="the sanitizer catches the signal")),
])
def test_a_dead_worker_fails_its_job_alone(tmp_path, number, name):
    with Daemon(tmp_path, workers=2) as daemon, daemon.connect() as client:
        victim = client.submit(LONG)
        other = client.submit(1000)
        daemon.signal_worker(victim, number)
        end = client.call("job.wait", job=victim)
        assert end["state"] == "failed"
        assert end["error"]["data"]["name"] == name
        assert end["error"]["data"]["signal"] == signal.Signals(number).name
        assert client.call("job.wait", job=other)["state"] == "done"
        with pytest.raises(Refused) as refused:
            client.call("mesh.fetch", job=victim)
        assert refused.value.name == "job_failed"
        assert refused.value.data["error"]["data"]["name"] == name
        daemon.wait_log("worker ready")  # a new one
        assert client.call("job.wait", job=client.submit(100))["state"] == "done"
        stats = client.call("server.stats")
        assert stats["workers"]["restarts"] == 1
        assert stats["bytes"]["uploads"] == 0


def test_the_budget_ends_a_job_cleanly(tmp_path):
    with Daemon(tmp_path, workers=1) as daemon, daemon.connect() as client:
        job = client.submit(100000, options={"memory_bytes": 1 << 20})
        end = client.call("job.wait", job=job)
        assert (end["state"], end["error"]["data"]["name"]) == ("failed", "memory")
        assert client.call("server.stats")["workers"]["restarts"] == 0


@pytest.mark.skipif(sanitized(), reason="sanitized workers have no RLIMIT_DATA")
def test_the_systems_limit_ends_a_job(tmp_path):
    config = {"limits": {"worker_memory_bytes": 48 << 20, "memory_bytes": 1 << 40}}
    with Daemon(tmp_path, workers=1, config=config) as daemon, daemon.connect() as client:
        end = client.call("job.wait", job=client.submit(LONG))
        assert end["state"] == "failed"
        assert end["error"]["data"]["name"] in ("memory", "worker_memory")
        assert client.call("job.wait", job=client.submit(100))["state"] == "done"


def test_a_worker_shares_nothing_with_the_daemon(tmp_path):
    with Daemon(tmp_path, workers=1) as daemon, daemon.connect() as client:
        client.call("job.wait", job=client.submit(100))
        pid, = daemon.worker_pids()
        assert sorted(map(int, os.listdir(f"/proc/{pid}/fd"))) == [0, 1, 2]
        assert os.getpgid(pid) == pid
        with open(f"/proc/{pid}/oom_score_adj") as f:
            assert int(f.read()) == 1000
        soft, _ = resource.prlimit(pid, resource.RLIMIT_DATA)
        assert (soft == resource.RLIM_INFINITY) == sanitized()


def test_workers_end_with_a_killed_daemon(tmp_path):
    daemon = Daemon(tmp_path, workers=2)
    with daemon.connect() as client:
        client.submit(LONG)
        daemon.wait_log("job started")
        pids = daemon.worker_pids()
        daemon.process.kill()
        daemon.process.wait()
        wait_dead(pids)
    left = [d for d in os.listdir(tmp_path) if d.startswith("tetrad-")]
    assert left, "a killed daemon cannot remove its spool"
    with Daemon(tmp_path, workers=1):
        assert not set(left) & set(os.listdir(tmp_path)), "the next one does"


def test_workers_that_cannot_start_end_the_daemon(tmp_path):
    command = [program("tetrad"), "--unix", str(tmp_path / "s"), "--spool", str(tmp_path),
               "--worker-prefix", "false"]
    run = subprocess.run(command, stderr=subprocess.PIPE, text=True, timeout=60)
    assert run.returncode == 1
    assert "workers do not start" in run.stderr
    assert not (tmp_path / "s").exists()


def pipeline(client, count):
    """Submits `count` small clouds without waiting for replies; gives the ids of the requests."""
    first = client.last + 1

    def send():
        for i in range(count):
            body, params = cloud(60, seed=i)
            client.send("mesh.submit", body, **params)

    sender = threading.Thread(target=send)
    sender.start()
    return range(first, first + count), sender


def idle(client, workers):
    """Asks until all workers are idle; each answer is an event of the daemon."""
    while client.call("server.stats")["workers"]["idle"] < workers:
        pass


def kill_one(daemon, chance):
    """Kills one of the workers, unless it ended between being listed and being killed."""
    pids = daemon.worker_pids()
    if pids:
        with contextlib.suppress(ProcessLookupError):
            os.kill(chance.choice(pids), signal.SIGKILL)


def one_round(daemon, client, chance, workers, count):
    """Submits, kills on the way, waits for every job; returns how many ended how."""
    requests, sender = pipeline(client, count)
    jobs = []
    for i, request in enumerate(requests):
        jobs.append(client.receive(request)["job"])
        if i % 25 == 24:
            kill_one(daemon, chance)
    sender.join()
    ends = {}
    for i, job in enumerate(jobs):
        end = client.call("job.wait", job=job)
        what = end["state"]
        if what == "failed":
            what = end["error"]["data"]["name"]
        ends[what] = ends.get(what, 0) + 1
        if i % 100 == 50:
            kill_one(daemon, chance)
    for job in jobs:
        client.call("job.delete", job=job)
    idle(client, workers)
    return ends


def test_a_thousand_submissions_while_workers_are_killed(tmp_path, record_property):
    seed, count, workers = 20, 1000, 4
    chance = random.Random(seed)
    with Daemon(tmp_path, workers=workers) as daemon, daemon.connect() as client:
        idle(client, workers)
        start = daemon.resident_kib(), daemon.descriptors()
        measures = [start]
        for _ in range(3):
            ends = one_round(daemon, client, chance, workers, count)
            print("seed", seed, "ends", ends)
            assert set(ends) <= {"done", "worker_killed"}
            assert sum(ends.values()) == count
            assert ends["done"] > count / 2
            measures.append((daemon.resident_kib(), daemon.descriptors()))
        stats = client.call("server.stats")
        print("VmRSS (KiB) and descriptors before and after each round:", measures)
        record_property("memory", str(measures))
        assert stats["totals"]["submitted"] == 3 * count
        assert stats["workers"]["restarts"] > 20
        assert stats["bytes"]["uploads"] == 0 and stats["bytes"]["results"] == 0
        assert sum(stats["jobs"].values()) == 0
        assert {fds for _, fds in measures} == {start[1]}
        while daemon.spooled():  # the spool's thread may be behind; the run's time limit ends it
            client.call("server.stats")
        if not sanitized():  # a sanitizer keeps what was freed
            assert measures[3][0] - measures[1][0] < 1024
