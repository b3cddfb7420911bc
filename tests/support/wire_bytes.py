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
import pathlib
import re
import socket
import sys
import tempfile

from harness import Client, Daemon, free_port


def read_off(path):
    """(points, triangles) as flat lists."""
    words = re.sub(r"#.*", "", pathlib.Path(path).read_text(encoding="ascii")).split()
    n, m = int(words[1]), int(words[2])
    faces = words[4 + 3 * n:4 + 3 * n + 4 * m]
    if any(k != "3" for k in faces[::4]):
        sys.exit("wire_bytes: not a triangulated surface")
    return [float(x) for x in words[4:4 + 3 * n]], [int(v) for i, v in enumerate(faces) if i % 4]


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
    job = client.call("mesh.submit", coordinates + vertices, pls=pls, options=options, codec=codec)["job"]
    done = client.call("job.wait", job=job)
    if done["state"] != "done":
        sys.exit(f"wire_bytes: job {done['state']}: {done.get('error')}")
    request = client.send("mesh.fetch", job=job)
    wire, total = {}, 0
    while True:
        message, body = client.next()
        size = len(json.dumps(message, separators=(",", ":"))) + 1 + len(body)  # a line as the server writes it
        total += size
        if message.get("id") == request:
            break
        name = message["params"]["array"]
        wire[name] = wire.get(name, 0) + size
    raw = {entry["name"]: raw_bytes(entry) for entry in done["arrays"]}
    shapes = {entry["name"]: entry["shape"][0] for entry in done["arrays"]}
    client.call("job.delete", job=job)
    mesh = ["points", "tetrahedra"]
    part_raw, part_wire = sum(raw[n] for n in mesh), sum(wire[n] for n in mesh)
    print(f"| {order} | {codec} | {shapes['tetrahedra']} | {sum(raw.values())} | {total}"
          f" | {total / sum(raw.values()):.3f} | {part_raw} | {part_wire} | {part_wire / part_raw:.3f} |", flush=True)


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit("usage: wire_bytes.py SURFACE.off [RADIUS-EDGE]")
    points, triangles = read_off(sys.argv[1])
    radius_edge = float(sys.argv[2]) if len(sys.argv) > 2 else 1.414
    port = free_port()
    with tempfile.TemporaryDirectory() as folder, Daemon(folder, "--tcp", f"127.0.0.1:{port}", workers=1), \
            Client(socket.create_connection(("127.0.0.1", port)), timeout=None) as client:
        client.call("server.hello", protocol=1)
        print("| order | codec | tetrahedra | raw | wire | wire/raw | points+tetrahedra raw | wire | wire/raw |")
        print("|---|---|---|---|---|---|---|---|---|")
        for order in ("hilbert", "input_first"):
            for codec in ("mesh", "zlib"):
                measure(client, points, triangles, radius_edge, order, codec)


if __name__ == "__main__":
    main()
