# SPDX-License-Identifier: Apache-2.0
"""A daemon under test and a client for it.

Everything that waits waits for an event (a message, a log line, the end of a process)
and gives up after LIMIT seconds; nothing sleeps.  The programs are those of the build
folder $TETRAD_BUILD, build/release where it is not set.
"""

import array
import json
import os
import pathlib
import queue
import random
import re
import select
import socket
import subprocess
import threading
import time

LIMIT = 60.0
ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ.get("TETRAD_BUILD", ROOT / "build/release"))
TETRACTL = BUILD / "tetractl"
os.environ.setdefault("TETRAD_EXEC_PATH", str(BUILD))  # tetractl's private daemon, too


def free_port():
    """A port of the loopback that nobody has now."""
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


def program(name):
    for folder in os.environ["TETRAD_EXEC_PATH"].split(":"):
        path = os.path.join(folder, name)
        if os.access(path, os.X_OK):
            return path
    raise FileNotFoundError(name)


def sanitized():
    with open(program("tetrad-worker"), "rb") as f:
        return b"__asan_init" in f.read()


class Daemon:
    """`tetrad` on a Unix socket in `folder`; its log is kept as a list of dicts."""

    def __init__(self, folder, *options, config=None, workers=2, inherit=None, prefix=(), env=None):
        self.folder = str(folder)
        self.path = os.path.join(self.folder, "socket")
        command = [*prefix, program("tetrad"), "--workers", str(workers), "--spool", self.folder]
        if inherit is None:
            command += ["--unix", self.path]
        else:
            command += ["--inherit", str(inherit.fileno())]
        if config is not None:
            name = os.path.join(self.folder, "config.json")
            with open(name, "w") as f:
                json.dump(config, f)
            command += ["--config", name]
        self.process = subprocess.Popen(
            command + list(options), stderr=subprocess.PIPE, env={**os.environ, **(env or {})},
            pass_fds=[inherit.fileno()] if inherit else [], text=True)
        self.log = []
        self.lines = queue.Queue()
        self.reader = threading.Thread(target=self._read_log, daemon=True)
        self.reader.start()
        if inherit is None:
            for _ in range(1 + options.count("--tcp")):
                self.wait_log("listening")

    def _read_log(self):
        for line in self.process.stderr:
            self.lines.put(line)
        self.lines.put(None)

    def _next_line(self, deadline):
        line = self.lines.get(timeout=max(0.01, deadline - time.monotonic()))
        if line is None:
            self.lines.put(None)
            raise EOFError("the log ended:\n" + "".join(e["line"] for e in self.log))
        entry = {k: v[1:-1] if v.startswith('"') else v
                 for k, v in re.findall(r'(\w+)=("(?:[^"\\]|\\.)*"|\S*)', line)}
        entry["line"] = line
        self.log.append(entry)
        return entry

    def wait_log(self, msg, **fields):
        """The next log entry of that kind (already seen ones are not looked at again)."""
        deadline = time.monotonic() + LIMIT
        while True:
            entry = self._next_line(deadline)
            if entry.get("msg") == msg and all(entry.get(k) == v for k, v in fields.items()):
                return entry

    def drain_log(self):
        try:
            while True:
                self._next_line(time.monotonic() + LIMIT)
        except EOFError:
            return self.log

    def connect(self, **options):
        s = socket.socket(socket.AF_UNIX)
        s.connect(self.path)
        return Client(s, **options)

    def worker_pids(self):
        """Children of the daemon."""
        pid = self.process.pid
        with open(f"/proc/{pid}/task/{pid}/children") as f:
            return [int(p) for p in f.read().split()]

    def descriptors(self):
        return len(os.listdir(f"/proc/{self.process.pid}/fd"))

    def resident_kib(self):
        with open(f"/proc/{self.process.pid}/status") as f:
            return int(re.search(r"VmRSS:\s*(\d+)", f.read()).group(1))

    def spooled(self):
        """Names of the files in the spool."""
        folders = [d for d in os.listdir(self.folder) if d.startswith("tetrad-")]
        return [n for d in folders for n in os.listdir(os.path.join(self.folder, d)) if n != "lock"]

    def signal_worker(self, job, number):
        """Sends a signal to the worker that has started that job."""
        os.kill(int(self.wait_log("job started", job=job)["worker"]), number)

    def wait(self):
        return self.process.wait(timeout=LIMIT)

    def stop(self):
        """Ends it at once and looks for what must not be left."""
        if self.process.poll() is None:
            self.process.terminate()
            try:
                self.wait_log("draining")
                self.process.terminate()
            except EOFError:
                pass  # nothing was left to drain
            try:
                self.process.wait(timeout=LIMIT)
            except subprocess.TimeoutExpired:
                self.process.kill()
                raise
        self.reader.join(LIMIT)
        log = self.drain_log()
        text = "".join(e["line"] for e in log)
        assert "Sanitizer" not in text and "runtime error" not in text, text
        left = [d for d in os.listdir(self.folder) if d.startswith("tetrad-")]
        assert not left, "the spool is left"

    def __enter__(self):
        return self

    def __exit__(self, *what):
        self.stop()


class Refused(Exception):
    def __init__(self, error):
        super().__init__(error["message"])
        self.error = error
        self.name = error["data"]["name"]
        self.data = error["data"]


class Client:
    """One connection; replies and notifications are matched by id."""

    def __init__(self, sock, timeout=LIMIT):
        self.socket = sock
        sock.settimeout(timeout)
        self.input = b""
        self.last = 0
        self.replies = {}
        self.notes = []

    def send(self, method, body=b"", **params):
        self.last += 1
        message = {"jsonrpc": "2.0", "id": self.last, "method": method, "params": params}
        if body:
            message["body"] = len(body)
        self.socket.sendall(json.dumps(message).encode() + b"\n" + body)
        return self.last

    def notify(self, method, **params):
        message = {"jsonrpc": "2.0", "method": method, "params": params}
        self.socket.sendall(json.dumps(message).encode() + b"\n")

    def _fill(self):
        data = self.socket.recv(1 << 20)
        if not data:
            raise EOFError("the server closed the connection")
        self.input += data

    def next(self):
        """The next message and its body."""
        while b"\n" not in self.input:
            self._fill()
        line, _, self.input = self.input.partition(b"\n")
        message = json.loads(line)
        size = message.get("body", 0)
        while len(self.input) < size:
            self._fill()
        body, self.input = self.input[:size], self.input[size:]
        return message, body

    def receive(self, request):
        """The result of a request; notifications on the way are kept."""
        while request not in self.replies:
            message, body = self.next()
            if "method" in message:
                self.notes.append((message, body))
            else:
                self.replies[message["id"]] = message
        message = self.replies.pop(request)
        if "error" in message:
            raise Refused(message["error"])
        return message["result"]

    def wait_note(self, method, test=lambda params: True):
        while True:
            for i, (message, body) in enumerate(self.notes):
                if message["method"] == method and test(message["params"]):
                    del self.notes[i]
                    return message["params"], body
            message, body = self.next()
            if "method" in message:
                self.notes.append((message, body))
            else:
                self.replies[message["id"]] = message

    def call(self, method, body=b"", **params):
        return self.receive(self.send(method, body, **params))

    def submit(self, n, seed=1, **params):
        """Submits a cloud of n points; returns the job's id."""
        body, params = cloud(n, seed, **params)
        return self.call("mesh.submit", body, **params)["job"]

    def close(self):
        self.socket.close()

    def __enter__(self):
        return self

    def __exit__(self, *what):
        self.close()


def cloud(n, seed=1, stage="delaunay", options=None, **params):
    """Body and params of mesh.submit for n points, the same ones for the same seed."""
    random_value = random.Random(seed).random
    body = array.array("d", (random_value() for _ in range(3 * n))).tobytes()
    descriptor = {"dtype": "<f8", "shape": [n, 3], "codec": "raw", "at": [0, len(body)]}
    return body, {"pls": {"points": descriptor}, "options": {"stage": stage, **(options or {})},
                  **params}


def wait_dead(pids):
    """Waits until none of these processes is there any more (not children of ours)."""
    for pid in pids:
        try:
            fd = os.pidfd_open(pid)
        except ProcessLookupError:
            continue
        try:
            poll = select.poll()
            poll.register(fd, select.POLLIN)
            assert poll.poll(LIMIT * 1000), f"process {pid} lives on"
        finally:
            os.close(fd)
