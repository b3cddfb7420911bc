# SPDX-License-Identifier: Apache-2.0
"""A thousand jobs over one connection while workers are killed: every job ends in a
definite state, and the daemon keeps neither memory nor descriptors."""

import os
import random
import signal

from harness import Daemon, sanitized

JOBS, KILLS, WORKERS, AT_ONCE = 1000, 4, 2, 16
PLS = {"points": [[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)],
       "polygon_vertices": [0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5],
       "polygon_start": list(range(0, 25, 4))}
SEED = 20  # of the moments at which workers die


def run_jobs(connection, jobs, daemon, kill_at):
    """Submits, awaits and deletes jobs, AT_ONCE of them open; kills a worker after each number of
    ended jobs in kill_at. Returns how many ended in each state, and the errors of the failed."""
    states, errors = {}, []
    submits, waits = {}, {}
    submitted = ended = 0

    def submit():
        nonlocal submitted
        submitted += 1
        submits[connection.send("mesh.submit", pls=PLS, options={"max_volume": 0.01})] = submitted

    for _ in range(min(AT_ONCE, jobs)):
        submit()
    while ended < jobs:
        message, _ = connection.next()
        assert "error" not in message, message
        if submits.pop(message["id"], None):
            waits[connection.send("job.wait", job=message["result"]["job"])] = message["result"]["job"]
        elif message["id"] in waits:
            job = waits.pop(message["id"])
            state = message["result"]["state"]
            states[state] = states.get(state, 0) + 1
            if state == "failed":
                errors.append(message["result"]["error"]["data"]["name"])
            connection.send("job.delete", job=job)
            ended += 1
            if ended in kill_at:
                os.kill(random.Random(SEED + ended).choice(daemon.worker_pids()), signal.SIGKILL)
            if submitted < jobs:
                submit()
    return states, errors


def settled(connection):
    """The daemon's figures, once its workers are all idle and no request is open but this."""
    while True:
        stats = connection.call("server.stats")
        if stats["workers"]["idle"] == stats["workers"]["wanted"] and stats["jobs"]["done"] == 0:
            return stats


def test_thousand_jobs_with_killed_workers(tmp_path, monkeypatch):
    # The address sanitizer keeps freed memory for a while, and books of its own: little of the one, and
    # room for the other, or they are what is measured.
    monkeypatch.setenv("ASAN_OPTIONS", os.environ.get("ASAN_OPTIONS", "") + ":quarantine_size_mb=1")
    with Daemon(tmp_path, workers=WORKERS) as daemon, daemon.connect() as connection:
        run_jobs(connection, 300, daemon, set())  # what is allocated once is allocated now
        before, descriptors = settled(connection), daemon.descriptors()
        kill_at = set(random.Random(SEED).sample(range(50, JOBS - 50), KILLS))
        states, errors = run_jobs(connection, JOBS, daemon, kill_at)
        after = settled(connection)

        print(f"seed {SEED}: {states}, {errors}; memory {before['memory_bytes']} to {after['memory_bytes']}")
        assert sum(states.values()) == JOBS
        assert set(states) <= {"done", "failed"}
        assert len(errors) <= KILLS and set(errors) <= {"worker_killed"}
        assert after["workers"]["restarts"] - before["workers"]["restarts"] == KILLS
        assert after["memory_bytes"] - before["memory_bytes"] < (8 << 20 if sanitized() else 1 << 20)
        assert daemon.descriptors() == descriptors
        daemon.process.terminate()
        assert daemon.wait() == 0
