#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A whole client, from PROTOCOL.md alone: client.py unix:PATH|tcp:HOST:PORT [POINTS]
meshes a unit cube with POINTS points inside, and prints what came back as JSON."""
import json, random, socket, struct, sys, zlib

CUBE = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
SQUARES = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]

def call(stream, number, method, params, body=b""):  # -> result, notifications
    line, told = {"jsonrpc": "2.0", "id": number, "method": method, "params": params}, []
    stream.write(json.dumps({**line, "body": len(body)}).encode() + b"\n" + body)
    stream.flush()
    while True:
        message = json.loads(stream.readline())
        data = stream.read(message.get("body", 0))
        if "method" in message:
            told.append((message["method"], message["params"], data))
        elif "error" in message:
            sys.exit(f"{method}: {message['error']}")
        else:
            return message["result"], told

def decode(info, rows, data):  # one chunk -> its little-endian bytes
    data = zlib.decompress(data) if data and info["codec"] != "raw" else data
    if not data or info["codec"] != "mesh":
        return data
    width, columns, out = int(info["dtype"][2:]), (info["shape"] + [1])[1], []
    plane = lambda b, c: data[(b * columns + c) * rows:(b * columns + c + 1) * rows]
    for c in range(columns):
        y = [int.from_bytes(bytes(e), "little") for e in zip(*(plane(b, c) for b in range(width)))]
        for r in range(rows):
            if info["dtype"] == "<u4":
                base = out[0][r] if c else (y[r - 1] if r else 0)
                y[r] = ((y[r] >> 1 ^ -(y[r] & 1)) + base) & 0xFFFFFFFF
            elif info["dtype"][1] == "f" and r:
                y[r] ^= y[r - 1]
        out.append(y)
    return b"".join(v.to_bytes(width, "little") for row in zip(*out) for v in row)

kind, place = sys.argv[1].split(":", 1)
wire = socket.socket(socket.AF_UNIX if kind == "unix" else socket.AF_INET)
wire.connect(place if kind == "unix" else (place.split(":")[0], int(place.split(":")[1])))
wire = wire.makefile("rwb")
call(wire, 1, "server.hello", {"protocol": 1, "client": "client.py"})
draw, inside = random.Random(1), int(([0] + sys.argv[2:])[-1])
points = CUBE + [[draw.uniform(0.01, 0.99) for _ in "xyz"] for _ in range(inside)]
body = zlib.compress(b"".join(struct.pack("<3d", *p) for p in points))
pls = {"points": {"dtype": "<f8", "shape": [len(points), 3], "codec": "zlib", "at": [0, len(body)]},
       "polygon_vertices": [v for s in SQUARES for v in s], "polygon_start": list(range(0, 25, 4))}
job = call(wire, 2, "mesh.submit", {"pls": pls, "options": {"stage": "cdt"}}, body)[0]["job"]
end, progress = call(wire, 3, "job.wait", {"job": job, "progress_ms": 50})
end["state"] == "done" or sys.exit(f"job {end['state']}: {end.get('error')}")
table, mesh = {a["name"]: a for a in end["arrays"]}, {a["name"]: b"" for a in end["arrays"]}
for _, chunk, data in call(wire, 4, "mesh.fetch", {"job": job})[1]:
    mesh[chunk["array"]] += (raw := decode(table[chunk["array"]], chunk["rows"], data))
    assert zlib.crc32(raw) == chunk["crc32"], chunk
assert all(zlib.crc32(mesh[name]) == table[name]["crc32"] for name in mesh), table
print(json.dumps({"shapes": {n: a["shape"] for n, a in table.items()}, "progress": len(progress),
                  "points": mesh["points"].hex(), "tetrahedra": mesh["tetrahedra"].hex()}))
