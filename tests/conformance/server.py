# SPDX-License-Identifier: Apache-2.0
"""A daemon for a test, and one connection to it: lines and bodies, no more."""

import json
import os
import pathlib
import select
import socket
import subprocess
import threading

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAMS = pathlib.Path(os.environ.get("TETRAD_EXEC_PATH", ROOT / "build/release"))
PATIENCE = 60  # seconds until a test gives an answer up


class Daemon:
    """tetrad on a Unix socket and, with `tcp`, on a port of the loopback."""

    def __init__(self, folder, *options, tcp=False):
        self.unix = str(folder / "tetrad.socket")
        arguments = [PROGRAMS / "tetrad", "--unix", self.unix, "--spool", folder, *options]
        if tcp:
            with socket.socket() as probe:  # a port that is free now
                probe.bind(("127.0.0.1", 0))
                self.tcp = probe.getsockname()
            arguments += ["--tcp", "%s:%d" % self.tcp]
        self.log = []
        self.process = subprocess.Popen(list(map(str, arguments)), stderr=subprocess.PIPE, text=True)
        self._await_listening()
        threading.Thread(target=self.log.extend, args=(self.process.stderr,), daemon=True).start()

    def _await_listening(self):
        """Tries after each line of the log, as one of them tells of the listening."""
        while self.process.poll() is None:
            ready, _, _ = select.select([self.process.stderr], [], [], PATIENCE)
            assert ready, "the daemon is silent"
            self.log.append(self.process.stderr.readline())
            with socket.socket(socket.AF_UNIX) as probe:
                try:
                    probe.connect(self.unix)
                    return
                except OSError:
                    pass
        raise AssertionError("the daemon ended:\n" + "".join(self.log))

    def connect(self, over="unix"):
        """A new connection."""
        return Connection(socket.AF_UNIX, self.unix) if over == "unix" else Connection(
            socket.AF_INET, self.tcp)

    def stop(self):
        """Ends it at once; returns its exit status."""
        self.process.kill()
        return self.process.wait(PATIENCE)


class Connection:
    """Sends what it is told, right or wrong, and sorts what comes by request id."""

    def __init__(self, family, address):
        self.socket = socket.socket(family)
        self.socket.settimeout(PATIENCE)
        self.socket.connect(address)
        self.reader = self.socket.makefile("rb")
        self.replies, self.told = [], []

    def send(self, message, body=b""):
        """A message; `jsonrpc` and `body` are filled in where they are not given."""
        line = {"jsonrpc": "2.0", **message}
        if body and "body" not in line:
            line["body"] = len(body)
        self.send_bytes(json.dumps(line).encode() + b"\n" + body)

    def send_bytes(self, data):
        """Bytes as they are."""
        self.socket.sendall(data)

    def read(self):
        """The next message with its body, or None at the end of the stream."""
        line = self.reader.readline()
        if not line:
            return None
        assert line.endswith(b"\n"), line
        assert len(line) <= 65536
        message = json.loads(line)
        assert message["jsonrpc"] == "2.0"
        size = message.get("body", 0)
        body = self.reader.read(size)
        assert len(body) == size
        return message, body

    def reply(self, number):
        """Waits for the reply with that id; what comes before it is kept."""
        while True:
            for i, message in enumerate(self.replies):
                if message["id"] == number:
                    return self.replies.pop(i)
            got = self.read()
            assert got, f"the stream ended before the reply to {number!r}"
            (self.told if "method" in got[0] else self.replies).append(
                got if "method" in got[0] else got[0])

    def call(self, number, method, params=None, body=b""):
        """A request and its reply."""
        self.send({"id": number, "method": method, "params": params or {}}, body)
        return self.reply(number)

    def close(self):
        """Closes both directions."""
        self.reader.close()
        self.socket.close()
