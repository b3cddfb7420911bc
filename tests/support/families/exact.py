# SPDX-License-Identifier: Apache-2.0
"""Exact geometry on doubles, by integers: every coordinate of a set of points is a
whole multiple of one power of two, and Python's integers have no bounds.  Shares no code
with the engine, whose inputs it vouches for."""


def scaled(points):
    """The points as integers, all by the same power of two."""
    ratios = [[x.as_integer_ratio() for x in map(float, p)] for p in points]
    most = max((d for p in ratios for _, d in p), default=1)
    return [tuple(n * (most // d) for n, d in p) for p in ratios]


def minus(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def orient(a, b, c, d):
    """Six times the volume of abcd: positive where abc turns counterclockwise seen from
    the side that d is not on, negative, or 0."""
    return dot(cross(minus(b, a), minus(c, a)), minus(d, a))


def power(a, b, c, d, p, lift):
    """Positive where p lies inside the sphere of the positive tetrahedron abcd, its
    points being lifted to |x|^2 - weight: lift maps each to its weight."""
    rows = []
    for q in (a, b, c, d):
        x, y, z = minus(q, p)
        rows.append((x, y, z, x * x + y * y + z * z - lift[q] + lift[p]))
    (ax, ay, az, aw), (bx, by, bz, bw), (cx, cy, cz, cw), (dx, dy, dz, dw) = rows
    ab, ac, ad = ax * by - bx * ay, ax * cy - cx * ay, ax * dy - dx * ay
    bc, bd, cd = bx * cy - cx * by, bx * dy - dx * by, cx * dy - dx * cy
    abc, abd = az * bc - bz * ac + cz * ab, az * bd - bz * ad + dz * ab
    acd, bcd = az * cd - cz * ad + dz * ac, bz * cd - cz * bd + dz * bc
    return -(dw * abc - cw * abd + bw * acd - aw * bcd)


def collinear(a, b, c):
    return cross(minus(b, a), minus(c, a)) == (0, 0, 0)


def _flat(normal, p):
    """p without the axis along which the normal is longest."""
    k = max(range(3), key=lambda i: abs(normal[i]))
    return (p[(k + 1) % 3], p[(k + 2) % 3])


def _turn(a, b, c):
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _between(a, b, p):
    return all(min(x, y) <= z <= max(x, y) for x, y, z in zip(a, b, p))


def _meet_2d(a, b, c, d):
    """Whether the closed segments ab and cd of the plane have a point in common."""
    s, t, u, v = _turn(a, b, c), _turn(a, b, d), _turn(c, d, a), _turn(c, d, b)
    if (s > 0) != (t > 0) and s and t and (u > 0) != (v > 0) and u and v:
        return True
    return (not s and _between(a, b, c)) or (not t and _between(a, b, d)) or \
        (not u and _between(c, d, a)) or (not v and _between(c, d, b))


def segments_meet(a, b, c, d):
    """Whether the closed segments ab and cd have a point in common."""
    if orient(a, b, c, d):
        return False
    normal = cross(minus(b, a), minus(d, c))
    if normal == (0, 0, 0):  # parallel
        normal = cross(minus(b, a), minus(c, a))
        if normal == (0, 0, 0):
            return _between(a, b, c) or _between(a, b, d) or _between(c, d, a)
        return False
    return _meet_2d(*(_flat(normal, p) for p in (a, b, c, d)))


def segment_meets_triangle(p, q, t):
    """Whether closed segment and closed triangle have a point in common."""
    a, b, c = t
    normal = cross(minus(b, a), minus(c, a))
    s, u = dot(normal, minus(p, a)), dot(normal, minus(q, a))
    if (s > 0 and u > 0) or (s < 0 and u < 0):
        return False
    if s == 0 and u == 0:
        a, b, c, p, q = (_flat(normal, x) for x in (a, b, c, p, q))
        turns = [_turn(a, b, p), _turn(b, c, p), _turn(c, a, p)]
        inside = all(x >= 0 for x in turns) or all(x <= 0 for x in turns)
        return inside or any(_meet_2d(x, y, p, q) for x, y in ((a, b), (b, c), (c, a)))
    sides = [orient(p, q, a, b), orient(p, q, b, c), orient(p, q, c, a)]
    return all(x >= 0 for x in sides) or all(x <= 0 for x in sides)


def _triangles_clash(x, s, t):
    shared = [v for v in s if v in t]
    if len(shared) == 3:
        return True
    xs, xt = [x[v] for v in s], [x[v] for v in t]
    if len(shared) == 2:
        apex_s, apex_t = (next(x[v] for v in k if v not in shared) for k in (s, t))
        if orient(*xs, apex_t):
            return False
        a, b = x[shared[0]], x[shared[1]]
        normal = cross(minus(xs[1], xs[0]), minus(xs[2], xs[0]))
        a, b, p, q = (_flat(normal, y) for y in (a, b, apex_s, apex_t))
        return (_turn(a, b, p) > 0) == (_turn(a, b, q) > 0)
    if len(shared) == 1:
        a, b = (x[v] for v in s if v not in shared)
        c, d = (x[v] for v in t if v not in shared)
        return segment_meets_triangle(a, b, xt) or segment_meets_triangle(c, d, xs)
    return any(segment_meets_triangle(k[i], k[i - 1], m) for k, m in ((xs, xt), (xt, xs)) for i in range(3))


def _segments_clash(x, s, t):
    shared = [v for v in s if v in t]
    if len(shared) == 2:
        return True
    if len(shared) == 1:
        v = x[shared[0]]
        p, q = (next(x[w] for w in k if w not in shared) for k in (s, t))
        return collinear(v, p, q) and dot(minus(p, v), minus(q, v)) > 0
    return segments_meet(*(x[v] for v in s + t))


def _segment_triangle_clash(x, s, t):
    shared = [v for v in s if v in t]
    if len(shared) == 2:
        return False  # a side
    if len(shared) == 1:
        v = x[shared[0]]
        far = next(x[w] for w in s if w not in shared)
        c, d = (x[w] for w in t if w not in shared)
        if orient(v, c, d, far):
            return False
        normal = cross(minus(c, v), minus(d, v))
        a, c, d, p = (_flat(normal, y) for y in (v, c, d, far))
        turn = 1 if _turn(a, c, d) > 0 else -1
        return _turn(a, c, p) * turn >= 0 and _turn(a, p, d) * turn >= 0  # within the corner, or along a side
    return segment_meets_triangle(x[s[0]], x[s[1]], [x[v] for v in t])


def clash(x, simplices):
    """The first two triangles or segments (tuples of numbers into the integer points x)
    that meet other than in shared vertices and sides, or None.  Quadratic, but for boxes."""
    boxes = [[(min(x[v][k] for v in s), max(x[v][k] for v in s)) for k in range(3)] for s in simplices]
    order = sorted(range(len(simplices)), key=lambda i: boxes[i][0][0])
    for n, i in enumerate(order):
        (_, hx), (ly, hy), (lz, hz) = boxes[i]
        for j in order[n + 1:]:
            other = boxes[j]
            if other[0][0] > hx:
                break
            if other[1][0] > hy or other[1][1] < ly or other[2][0] > hz or other[2][1] < lz:
                continue
            s, t = sorted((simplices[i], simplices[j]), key=len)
            kind = {(2, 2): _segments_clash, (2, 3): _segment_triangle_clash, (3, 3): _triangles_clash}
            if kind[len(s), len(t)](x, s, t):
                return s, t
    return None
