# SPDX-License-Identifier: Apache-2.0
"""A daemon under test, and connections to it, for tests and measurements in Python."""

import json
import os
import pathlib
import signal
import socket
import subprocess
import threading

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ.get("TETRAD_BUILD", ROOT / "build/release"))
TETRAD, TETRACTL = BUILD / "server/tetrad", BUILD / "clients/tetractl"
os.environ.setdefault("TETRAD_EXEC_PATH", str(BUILD / "server"))  # for tetractl's private daemon
PATIENCE = 60  # seconds until a test gives a process up


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


class Daemon:
    """A running `tetrad`; as a context it is ended, and its draining waited for."""

    def __init__(self, *options):
        self.process = subprocess.Popen([TETRAD, *map(str, options)], stderr=subprocess.PIPE, text=True)
        self.log = []
        for line in self.process.stderr:
            self.log.append(line)
            if "listening" in line:
                break
        else:
            raise RuntimeError("the daemon ended: " + "".join(self.log))
        self.reader = threading.Thread(target=lambda: self.log.extend(self.process.stderr), daemon=True)
        self.reader.start()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
        try:
            self.status = self.process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            self.process.kill()
            raise
        self.reader.join()
        self.process.stderr.close()

    def workers(self):
        """Process ids of the daemon's children."""
        pid = self.process.pid
        return [int(p) for p in pathlib.Path(f"/proc/{pid}/task/{pid}/children").read_text("ascii").split()]

    def descriptors(self):
        return len(os.listdir(f"/proc/{self.process.pid}/fd"))


class Refused(Exception):
    """An error reply; its first argument is the error object."""


class Connection:
    """One connection that speaks PROTOCOL.md. Address: a Unix path, or (host, port)."""

    def __init__(self, address):
        if isinstance(address, tuple):
            self.socket = socket.create_connection(address)
        else:
            self.socket = socket.socket(socket.AF_UNIX)
            self.socket.connect(str(address))
        self.socket.settimeout(PATIENCE)
        self.stream = self.socket.makefile("rwb")
        self.sent = 0
        self.bytes_read = 0

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.stream.close()
        self.socket.close()

    def send(self, method, params=None, body=b""):
        """Writes a request without waiting; returns its id."""
        self.sent += 1
        message = {"jsonrpc": "2.0", "id": self.sent, "method": method, "params": params or {}}
        if body:
            message["body"] = len(body)
        self.stream.write(json.dumps(message).encode() + b"\n" + body)
        self.stream.flush()
        return self.sent

    def read(self):
        """The next message and its body."""
        line = self.stream.readline()
        if not line:
            raise EOFError("the server closed the connection")
        message = json.loads(line)
        body = self.stream.read(message.get("body", 0))
        self.bytes_read += len(line) + len(body)
        return message, body

    def call(self, method, params=None, body=b"", on_notification=lambda message, body: None):
        """A request and its result; raises Refused. For connections with one request open at a time."""
        number = self.send(method, params, body)
        while True:
            message, data = self.read()
            if message.get("id") != number:
                on_notification(message, data)
            elif "error" in message:
                raise Refused(message["error"])
            else:
                return message["result"]
