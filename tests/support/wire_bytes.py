#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Bytes on the wire per raw byte: a surface's mesh fetched over TCP.

    wire_bytes.py SURFACE.off [RADIUS-EDGE]

Starts a daemon on the loopback, submits the surface once per order of the points
and codec, fetches all arrays, and prints a Markdown table: raw bytes, bytes that
came over the socket for the fetch (lines and bodies), their ratio, also for the
points and the tetrahedra alone.
"""

import array
import json
import os
import pathlib
import re
import socket
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ.get("TETRAD_BUILD", ROOT / "build/release"))


def read_off(path):
    """(points, triangles) as flat lists."""
    words = re.sub(r"#.*", "", pathlib.Path(path).read_text(encoding="ascii")).split()
    n, m = int(words[1]), int(words[2])
    faces = words[4 + 3 * n:4 + 3 * n + 4 * m]
    if any(k != "3" for k in faces[::4]):
        sys.exit("wire_bytes: not a triangulated surface")
    return [float(x) for x in words[4:4 + 3 * n]], [int(v) for i, v in enumerate(faces) if i % 4]


class Client:
    """One connection; calls in turn."""

    def __init__(self, address):
        self.stream = socket.create_connection(address).makefile("rwb")
        self.received = self.calls = 0

    def call(self, method, params, body=b"", on_notification=lambda message, size: None):
        self.calls += 1
        message = {"jsonrpc": "2.0", "id": self.calls, "method": method, "params": params}
        if body:
            message["body"] = len(body)
        self.stream.write(json.dumps(message).encode() + b"\n" + body)
        self.stream.flush()
        while True:
            line = self.stream.readline()
            if not line:
                sys.exit(f"wire_bytes: the server hung up in {method}")
            message = json.loads(line)
            size = message.get("body", 0)
            self.stream.read(size)
            self.received += len(line) + size
            if "id" not in message:
                on_notification(message, len(line) + size)
            elif "error" in message:
                sys.exit(f"wire_bytes: {method}: {message['error']}")
            else:
                return message["result"]


def raw_bytes(entry):
    size = int(entry["dtype"][2:])
    for extent in entry["shape"]:
        size *= extent
    return size


def measure(client, points, triangles, radius_edge, order, codec):
    coordinates, vertices = array.array("d", points).tobytes(), array.array("I", triangles).tobytes()
    pls = {"points": {"dtype": "<f8", "shape": [len(points) // 3, 3], "at": [0, len(coordinates)]},
           "triangles": {"dtype": "<u4", "shape": [len(triangles) // 3, 3], "at": [len(coordinates), len(vertices)]},
           "loose_points": []}
    options = {"radius_edge": radius_edge, "point_order": order}
    job = client.call("mesh.submit", {"pls": pls, "options": options, "codec": codec}, coordinates + vertices)["job"]
    done = client.call("job.wait", {"job": job})
    if done["state"] != "done":
        sys.exit(f"wire_bytes: job {done['state']}: {done.get('error')}")
    wire = {}

    def count(message, size):
        name = message["params"]["array"]
        wire[name] = wire.get(name, 0) + size

    before = client.received
    client.call("mesh.fetch", {"job": job}, on_notification=count)
    raw = {entry["name"]: raw_bytes(entry) for entry in done["arrays"]}
    shapes = {entry["name"]: entry["shape"][0] for entry in done["arrays"]}
    client.call("job.delete", {"job": job})
    total = client.received - before
    mesh = ["points", "tetrahedra"]
    part_raw, part_wire = sum(raw[n] for n in mesh), sum(wire[n] for n in mesh)
    print(f"| {order} | {codec} | {shapes['tetrahedra']} | {sum(raw.values())} | {total}"
          f" | {total / sum(raw.values()):.3f} | {part_raw} | {part_wire} | {part_wire / part_raw:.3f} |", flush=True)


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


def connect(daemon, address):
    """A connection, once the daemon says on its standard error that it listens."""
    for line in daemon.stderr:
        if b"listening" in line:
            return Client(address)
    sys.exit("wire_bytes: the daemon ended")


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit("usage: wire_bytes.py SURFACE.off [RADIUS-EDGE]")
    points, triangles = read_off(sys.argv[1])
    radius_edge = float(sys.argv[2]) if len(sys.argv) > 2 else 1.414
    address = ("127.0.0.1", free_port())
    daemon = subprocess.Popen([BUILD / "server/tetrad", "--tcp", f"{address[0]}:{address[1]}", "--workers", "1"],
                              stderr=subprocess.PIPE)
    try:
        client = connect(daemon, address)
        client.call("server.hello", {"protocol": 1})
        print("| order | codec | tetrahedra | raw | wire | wire/raw | points+tetrahedra raw | wire | wire/raw |")
        print("|---|---|---|---|---|---|---|---|---|")
        for order in ("hilbert", "input_first"):
            for codec in ("mesh", "zlib"):
                measure(client, points, triangles, radius_edge, order, codec)
    finally:
        daemon.terminate()
        daemon.wait()


if __name__ == "__main__":
    main()
