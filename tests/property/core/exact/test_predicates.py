# SPDX-License-Identifier: Apache-2.0
"""Predicates against rational arithmetic (fractions.Fraction) on generated cases:
random, degenerate (coplanar, cospherical, collinear, coincident), one unit in the
last place off degenerate, at huge and denormal scales, of mixed magnitudes, and with
implicit points anywhere. The seed is printed; TETRAD_TEST_SEED sets it."""
import math
import os
import random
import subprocess
from fractions import Fraction as F

import pytest

SEED = int(os.environ.get("TETRAD_TEST_SEED", random.randrange(2**32)))
CASES = int(os.environ.get("TETRAD_TEST_CASES", 1500))
DRIVER = os.environ.get("PREDICATE_DRIVER")
COUNT = {"orient3d": 4, "insphere": 5, "orient2d": 3, "collinear": 3, "dot_sign": 3,
         "compare_distance": 3, "in_diametric_ball3": 4}

pytestmark = pytest.mark.skipif(not DRIVER, reason="PREDICATE_DRIVER names no program")


# The reference: a point is (x, y, z) or ((ax, ay, az), (bx, by, bz), t).

def is_implicit(p):
    return isinstance(p[0], tuple)


def exact(p):
    if not is_implicit(p):
        return [F(x) for x in p]
    a, b, t = p
    return [F(x) + F(t) * (F(y) - F(x)) for x, y in zip(a, b)]


def sign(x):
    return (x > 0) - (x < 0)


def sub(a, b):
    return [x - y for x, y in zip(a, b)]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def det(m):
    if len(m) == 1:
        return m[0][0]
    return sum((-1) ** i * m[i][0] * det([r[1:] for j, r in enumerate(m) if j != i])
               for i in range(len(m)) if m[i][0] != 0)


def reference(name, axis, points):
    p = [exact(q) for q in points]
    if name == "orient3d":
        return sign(det([sub(q, p[0]) for q in p[1:]]))
    if name == "insphere":
        # (lift, x, y, z, 1): positive when e is inside of a positive abcd.
        return sign(det([[dot(q, q), *q, F(1)] for q in p]))
    if name == "orient2d":
        return sign(cross(sub(p[1], p[0]), sub(p[2], p[0]))[axis])
    if name == "collinear":
        return int(not any(cross(sub(p[1], p[0]), sub(p[2], p[0]))))
    if name == "dot_sign":
        return sign(dot(sub(p[0], p[2]), sub(p[1], p[2])))
    if name == "compare_distance":
        return sign(dot(sub(p[1], p[0]), sub(p[1], p[0])) - dot(sub(p[2], p[0]), sub(p[2], p[0])))
    return ball3(p)


def ball3(p):
    u, v, w = (sub(q, p[0]) for q in p[1:])
    n = cross(u, v)
    if not any(n):
        return 0
    c = [(dot(u, u) * x + dot(v, v) * y) / (2 * dot(n, n))
         for x, y in zip(cross(v, n), cross(n, u))]
    return sign(dot(c, c) - dot(sub(w, c), sub(w, c)))


def test_reference_conventions():
    unit = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)]
    assert reference("orient3d", 0, unit) == 1
    assert reference("insphere", 0, unit + [(0.25, 0.25, 0.25)]) == 1
    assert reference("insphere", 0, unit + [(1.0, 1.0, 1.0)]) == 0
    assert reference("insphere", 0, unit + [(2.0, 1.0, 1.0)]) == -1
    assert reference("in_diametric_ball3", 0, unit[:3] + [(0.5, 0.5, 0.5)]) == 1
    assert reference("in_diametric_ball3", 0, unit[:3] + [(1.0, 1.0, 0.0)]) == 0


# Generators of coordinates, and of points related to earlier ones.

def coordinates(rng):
    kind = rng.randrange(9)
    if kind == 0:
        return lambda: rng.uniform(-1, 1)
    if kind == 1:
        m = 10 ** rng.randint(1, 15)
        return lambda: float(rng.randint(-m, m))
    if kind == 2:
        return lambda: float(rng.randint(-2, 2))
    if kind == 3:  # an offset that leaves few bits
        o = rng.uniform(1, 1000) * 10 ** rng.randint(0, 9)
        return lambda: o + rng.uniform(0, 1)
    if kind == 4:  # a scale up to the limits
        s = rng.randint(-1100, 499)
        return lambda: math.ldexp(rng.uniform(-1, 1), s)
    if kind == 5:  # mixed magnitudes
        return lambda: math.ldexp(rng.uniform(-1, 1), rng.randint(-1074, 499))
    if kind == 6:
        return lambda: math.ldexp(rng.uniform(-1, 1), rng.randint(-40, 40))
    if kind == 7:  # denormals
        return lambda: rng.randint(-9, 9) * 5e-324
    return lambda: rng.choice([0.0, -0.0, 0.5, 1 / 3, 0.1, 1e-9, 1e9])


def cospherical(rng, n):
    """Points of x^2 + y^2 + z^2 = const by permuting and reflecting; shifted."""
    m = [float(rng.randint(0, 2 ** rng.choice([3, 10, 20]))) for _ in range(3)]
    o = [float(rng.randint(-1000, 1000)) for _ in range(3)]
    s = math.ldexp(1.0, rng.choice([0, 0, -20, 30, -150, 200]))
    return [tuple((x * rng.choice([-1, 1]) + y) * s for x, y in zip(rng.sample(m, 3), o))
            for _ in range(n)]


def coplanar(rng, n, new):
    """Points with exactly equal second differences: o + i u + j v in integers."""
    if rng.random() < 0.4:
        axis, level = rng.randrange(3), rng.choice([0.0, new()])
        return [tuple(level if k == axis else new() for k in range(3)) for _ in range(n)]
    vec = lambda m: [rng.randint(-m, m) for _ in range(3)]
    m = 2 ** rng.choice([2, 10, 24])
    o, u, v = vec(m), vec(m), vec(m)
    s = math.ldexp(1.0, rng.choice([0, -10, 100, -300]))
    if rng.random() < 0.3:
        v = [0, 0, 0]  # collinear
    points = []
    for _ in range(n):
        i, j = rng.randint(-m, m), rng.randint(-m, m)
        points.append(tuple((o[k] + i * u[k] + j * v[k]) * s for k in range(3)))
    return points


def at_the_brink(rng, n):
    """Products of two or more coordinates are a few of the least denormals, and lose
    most of their bits, beside a third coordinate that hides it by being large."""
    if rng.random() < 0.3:
        e = [rng.choice([-537, -358, -215, -179])] * 3
    else:
        e = rng.sample([-537, -537, rng.choice([0, 150, 300, 400])], 3)
    return [tuple(math.ldexp(rng.uniform(-1.2, 1.2), k) for k in e) for _ in range(n)]


def nudge(rng, p):
    q = list(p)
    k = rng.randrange(3)
    q[k] = math.nextafter(q[k], rng.choice([-math.inf, math.inf]))
    return tuple(q)


def parameter(rng):
    return rng.choice([0.5, 0.25, 0.75, rng.random() or 0.5, rng.random() or 0.5, 1 / 3,
                       math.ldexp(1, -rng.randint(1, 1074)), 1 - 2.0 ** -53,
                       math.ldexp(rng.uniform(0.5, 1), -rng.randint(0, 1000))])


def make_case(rng, name):
    n = COUNT[name]
    new = coordinates(rng)
    kind = rng.randrange(5)
    if kind == 0:
        explicit = [(new(), new(), new()) for _ in range(3 * n)]
    elif kind == 1:
        explicit = cospherical(rng, 3 * n)
    elif kind == 2:
        explicit = coplanar(rng, 3 * n, new)
    elif kind == 3:
        explicit = at_the_brink(rng, 3 * n)
    else:
        explicit = coplanar(rng, 3, new) * n
    if rng.random() < 0.1:
        explicit[1] = explicit[0]
    if rng.random() < 0.3:
        explicit = [nudge(rng, p) if rng.random() < 0.3 else p for p in explicit]
    share = rng.choice([0, 0, 0.3, 0.7, 1])
    points = []
    for _ in range(n):
        if rng.random() < share:
            points.append((rng.choice(explicit), rng.choice(explicit), parameter(rng)))
        else:
            points.append(rng.choice(explicit))
    if rng.random() < 0.2:  # on the segment of two others, if these are explicit
        i, j, k = rng.sample(range(n), 3)
        if not is_implicit(points[i]) and not is_implicit(points[j]):
            points[k] = (points[i], points[j], parameter(rng))
    return name, rng.randrange(3), points


def encode(case):
    name, axis, points = case
    words = [name, str(axis), str(len(points))]
    for p in points:
        if is_implicit(p):
            words += ["i"] + [x.hex() for x in (*p[0], *p[1], p[2])]
        else:
            words += ["e"] + [x.hex() for x in p]
    return " ".join(words)


def answers(cases):
    out = subprocess.run([DRIVER], input="\n".join(map(encode, cases)) + "\n", text=True,
                         capture_output=True, check=True)
    lines = out.stdout.splitlines()
    assert len(lines) == len(cases)
    return lines


@pytest.mark.parametrize("name", COUNT)
def test_sign(name):
    print("seed", SEED)
    rng = random.Random(f"{SEED} {name}")
    cases = [make_case(rng, name) for _ in range(CASES)]
    seen = set()
    for case, answer in zip(cases, answers(cases)):
        expected = reference(*case)
        seen.add(expected)
        assert answer == str(expected), f"seed {SEED}: {encode(case)}"
    assert seen == ({0, 1} if name == "collinear" else {-1, 0, 1})


def test_implicit_points_stay_on_their_facet():
    """Implicit points on segments between vertices of one plane are exactly in it."""
    print("seed", SEED)
    rng = random.Random(f"{SEED} facet")
    cases = []
    for _ in range(CASES):
        vertices = coplanar(rng, 8, coordinates(rng))
        points = [(*rng.sample(vertices, 2), parameter(rng)) if rng.random() < 0.7
                  else rng.choice(vertices) for _ in range(4)]
        cases.append(("orient3d", 0, points))
    kept = [c for c in cases if all_coplanar(c)]
    assert len(kept) > CASES // 2
    assert set(answers(kept)) == {"0"}


def all_coplanar(case):
    """coplanar() rounds where its numbers have too many bits: such cases are out."""
    vertices = []
    for p in case[2]:
        vertices += [p[0], p[1]] if is_implicit(p) else [p]
    p = [exact(v) for v in vertices]
    for u in p:
        n = cross(sub(p[1], p[0]), sub(u, p[0]))
        if any(n):
            return all(dot(n, sub(q, p[0])) == 0 for q in p)
    return True


def test_rounding_is_to_nearest():
    print("seed", SEED)
    rng = random.Random(f"{SEED} round")
    cases = []
    for _ in range(CASES):
        new = coordinates(rng)
        a, b = (tuple(new() for _ in range(3)) for _ in range(2))
        cases.append(("round", 0, [(a, b, parameter(rng))]))
    for case, answer in zip(cases, answers(cases)):
        for x, word in zip(exact(case[2][0]), answer.split()):
            # float(Fraction) rounds to nearest, ties to even, denormals included.
            assert float.fromhex(word) == float(x), f"seed {SEED}: {encode(case)}"
