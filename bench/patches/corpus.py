"""The corpora of the patch bench: deterministic, seeded, written as patch JSON into bench/out/."""

import json
import math
import os
import random
import sys
from pathlib import Path

SEED = 20250101
PER_FAMILY = 52
BENCH = Path(__file__).resolve().parent.parent


def grid(size_u=1.0, size_v=1.0):
    """Sixteen control points of the flat, evenly parametrized patch."""
    return [[[size_u * j / 3, size_v * i / 3, 0.0] for j in range(4)] for i in range(4)]


def noisy(rng, strength):
    """A grid with noise in all three coordinates; the strength is in grid spacings."""
    step = strength / 3
    return [[[x + rng.gauss(0, step) for x in p] for p in row] for row in grid()]


def arc(angle):
    """The usual cubic for a circular arc of that angle about the origin: four points in the plane."""
    k = 4 / 3 * math.tan(angle / 4)
    c, s = math.cos(angle), math.sin(angle)
    return [(1, 0), (1, k), (c + k * s, s - k * c), (c, s)]


def bent(rng):
    """A strip rolled up by 200 to 330 degrees in one single piece, a little conical."""
    profile = arc(math.radians(rng.uniform(200, 330)))
    height, taper = rng.uniform(0.3, 2), rng.uniform(-0.5, 0.5)
    return [[[x * (1 + taper * i / 3), y * (1 + taper * i / 3), height * i / 3] for x, y in profile] for i in range(4)]


def saddle(rng):
    """A hyperbolic paraboloid of random steepness and direction, cubic terms added."""
    a, b, c = (rng.uniform(-2, 2) for _ in range(3))

    def z(i, j):
        u, v = j / 1.5 - 1, i / 1.5 - 1
        return 0.4 * ((abs(a) + 0.3) * u * u - (abs(b) + 0.3) * v * v) + 0.3 * c * u * v * (u + v)

    return [[[x, y, z(i, j)] for j, (x, y, _) in enumerate(row)] for i, row in enumerate(grid())]


def sphere(rng):
    """A piece of a sphere-like surface of revolution; one edge is the pole, a single point."""
    turn, rise = arc(math.radians(rng.uniform(45, 120))), arc(math.radians(90))
    squash = rng.uniform(0.3, 2)
    return [[[r * x, r * y, squash * z] for x, y in turn] for r, z in rise[:3]] + [[[0.0, 0.0, squash]] * 4]


def cylinder(rng):
    """A quarter to a half of a cylinder between two slanted ends."""
    profile, height = arc(math.radians(rng.uniform(60, 180))), rng.uniform(0.1, 3)
    slant = rng.uniform(-0.5, 0.5)
    return [[[x, y, height * i / 3 + slant * x * (i - 1.5)] for x, y in profile] for i in range(4)]


def twisted(rng):
    """Rows turned about the middle line, up to a full turn from first to last."""
    turn, length = math.radians(rng.uniform(90, 360)), rng.uniform(0.5, 3)

    def row(i):
        c, s = math.cos(turn * i / 3), math.sin(turn * i / 3)
        return [[(j - 1.5) * c, (j - 1.5) * s, length * i] for j in range(4)]

    return [row(i) for i in range(4)]


def corner(rng):
    """Nearly flat, but sharply curved at one corner: three control points sit close together there and stand up."""
    patch, near = noisy(rng, 0.05), rng.uniform(0.01, 0.1)
    patch[0][0] = [rng.uniform(-near, near), rng.uniform(-near, near), rng.uniform(0.2, 0.8)]
    patch[0][1] = [near, 0.0, rng.uniform(0, 0.1)]
    patch[1][0] = [0.0, near, rng.uniform(0, 0.1)]
    patch[1][1] = [near, near, 0.0]
    return patch


def pole(rng):
    """Noise, with one edge pulled together to a point."""
    patch = noisy(rng, 0.3)
    side, tip = rng.randrange(4), [rng.uniform(0, 1), rng.uniform(0, 1), rng.uniform(-1, 1)]
    for k in range(4):
        i, j = [(0, k), (3, k), (k, 0), (k, 3)][side]
        patch[i][j] = list(tip)
    return patch


FAMILIES = {
    "noise-weak": lambda rng: noisy(rng, 0.15),
    "noise-mid": lambda rng: noisy(rng, 0.5),
    "noise-strong": lambda rng: noisy(rng, 1.5),
    "bent": bent,
    "saddle": saddle,
    "sphere": sphere,
    "cylinder": cylinder,
    "twisted": twisted,
    "corner": corner,
    "pole": pole,
}


def normalised(patches):
    """The same patches, scaled and moved together so that the box of the control points has diagonal 1 at 0."""
    points = [p for patch in patches for row in patch for p in row]
    low = [min(p[k] for p in points) for k in range(3)]
    high = [max(p[k] for p in points) for k in range(3)]
    size = math.dist(low, high)
    return [[[[(p[k] - low[k]) / size for k in range(3)] for p in row] for row in patch] for patch in patches]


def teaset(path):
    """Newell's text: a count, rows of 16 one-based indices, a count, rows of x,y,z."""
    lines = [line for line in Path(path).read_text().split("\n") if line.strip()]
    n = int(lines[0])
    rows = [[int(x) for x in line.split(",")] for line in lines[1 : 1 + n]]
    points = [[float(x) for x in line.split(",")] for line in lines[2 + n :]]
    return [[[points[i - 1] for i in row[4 * r : 4 * r + 4]] for r in range(4)] for row in rows]


def bpt(path):
    """A count, then for each patch its two degrees and sixteen points."""
    numbers = iter(Path(path).read_text().split())
    patches = []
    for _ in range(int(next(numbers))):
        if (next(numbers), next(numbers)) != ("3", "3"):
            sys.exit(f"{path}: only bicubic patches are known")
        patches.append([[[float(next(numbers)) for _ in range(3)] for _ in range(4)] for _ in range(4)])
    return patches


def teapot():
    """The shipped teapot, or the teaset's where that is not there."""
    shipped = BENCH.parent / "examples" / "teapot.bpt"
    data = Path(os.environ.get("CHORDAL_DATA", BENCH.parent.parent / "shared" / "data"))
    return bpt(shipped) if shipped.exists() else teaset(data / "patches" / "teapot")


def write(name, patches, families):
    """One corpus: NAME.json with the patches, NAME.labels.json with the family of each."""
    out = BENCH / "out"
    out.mkdir(exist_ok=True)
    (out / f"{name}.json").write_text(json.dumps({"patches": patches}))
    (out / f"{name}.labels.json").write_text(json.dumps(families))
    print(f"{name}: {len(patches)} patches")


def main():
    """Writes every corpus."""
    pot = normalised(teapot())
    write("teapot", pot, ["teapot"] * len(pot))
    rng = random.Random(SEED)
    hard, labels = [], []
    for name, make in FAMILIES.items():
        for _ in range(PER_FAMILY):
            hard += normalised([make(rng)])
            labels.append(name)
    write("hard", hard, labels)


if __name__ == "__main__":
    main()
