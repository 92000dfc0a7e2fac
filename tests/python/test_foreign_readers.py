"""Every format of triangles and volumes that Chordal writes, opened by two libraries of others: they find the triangles, and the
bounds, whatever the certificate's length."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import ROOT, Command

#: Which libraries open a format. Of VTP and USD there is one that pip installs.
READERS = {
    "obj": ["pymeshlab", "open3d", "trimesh", "vtk", "assimp"],
    "ply": ["pymeshlab", "open3d", "trimesh", "vtk", "assimp"],
    "stl": ["pymeshlab", "open3d", "trimesh", "vtk", "assimp"],
    "off": ["pymeshlab", "open3d", "trimesh", "assimp"],
    "glb": ["pymeshlab", "open3d", "trimesh", "vtk", "assimp"],
    "gltf": ["pymeshlab", "open3d", "trimesh", "vtk", "assimp"],
    "3mf": ["lib3mf", "trimesh", "assimp"],
    "vtp": ["vtk"],
    "usda": ["usd"],
    "usdz": ["usd"],
}


@dataclass(frozen=True)
class Shape:
    """An OBJ, how many triangles it is, and its bounds."""

    text: str
    n: int
    low: tuple[float, ...]
    high: tuple[float, ...]


def of_lists(points: list[tuple[float, ...]], faces: list[list[int]], before: str = "", after: str = "") -> Shape:
    rows = [f"v {' '.join(map(repr, point))}" for point in points]
    rows += [before] if before else []
    rows += ["f " + " ".join(map(str, face)) for face in faces]
    rows += [after] if after else []
    low, high = (tuple(pick(point[k] for point in points) for k in range(3)) for pick in (min, max))
    return Shape("\n".join(rows) + "\n", sum(len(face) - 2 for face in faces), low, high)


CORNERS: list[tuple[float, ...]] = [(float(i & 1), float(i >> 1 & 1), float(i >> 2)) for i in range(8)]
SIDES = [[1, 3, 4, 2], [5, 6, 8, 7], [1, 2, 6, 5], [3, 7, 8, 4], [1, 5, 7, 3], [2, 4, 8, 6]]


def ball(n: int, colors: bool) -> Shape:
    """A sphere of bands, with a colour at each vertex or without."""
    points: list[tuple[float, ...]] = [(0.0, 0.0, 1.0), (0.0, 0.0, -1.0)]
    for band in range(1, n):
        for step in range(2 * n):
            a, b = math.pi * band / n, math.pi * step / n
            points.append((math.sin(a) * math.cos(b), math.sin(a) * math.sin(b), math.cos(a)))

    def at(band: int, step: int) -> int:
        return 1 if band == 0 else 2 if band == n else 3 + (band - 1) * 2 * n + step % (2 * n)

    faces = []
    for band in range(n):
        for step in range(2 * n):
            quad = [at(band, step), at(band + 1, step), at(band + 1, step + 1), at(band, step + 1)]
            corners = list(dict.fromkeys(quad))
            # Binary PLY of polygons of several sizes is beyond trimesh.
            faces += [[corners[0], b, c] for b, c in pairwise(corners[1:])]
    if colors:
        points = [(*p, (1 + p[0]) / 2, (1 + p[1]) / 2, (1 + p[2]) / 2) for p in points]
    return of_lists(points, faces)


TEXTURED = (
    "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\n"
    "f 1/1/1 2/2/1 3/3/1\nf 1/2/1 3/3/1 4/4/1\n"
)
TWO_PARTS = "\n".join(
    f"o part {k} «é»\n"
    + "\n".join(f"v {x + 3 * k} {y} {z}" for x, y, z in CORNERS)
    + f"\nusemtl colour {k}\n"
    + "\n".join("f " + " ".join(str(corner + 8 * k) for corner in side) for side in SIDES)
    for k in range(2)
)

SHAPES = {
    "tetrahedron": of_lists([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [[1, 3, 2], [1, 2, 4], [2, 3, 4], [3, 1, 4]]),
    "cube": of_lists(CORNERS, SIDES),
    "open": of_lists(CORNERS, SIDES[:3]),
    "polygon": of_lists([(math.cos(a), math.sin(a), 0.0) for a in range(6)], [[1, 2, 3, 4, 5, 6]]),
    "ball": ball(12, colors=False),
    "coloured": ball(8, colors=True),
    "textured": Shape(TEXTURED, 2, (0, 0, 0), (2, 1, 0)),
    "two parts": Shape(TWO_PARTS + "\n", 24, (0, 0, 0), (4, 1, 1)),
    "far": of_lists([(x + 4096, y - 4096, z) for x, y, z in CORNERS], SIDES),
    "tiny": of_lists([(x / 1024, y / 1024, z / 1024) for x, y, z in CORNERS], SIDES),
    # Its certificate is over ten thousand letters, see below.
    "long history": of_lists(CORNERS, SIDES),
}

#: Enough steps for a certificate of ten kilobytes.
STEPS = 30


@pytest.fixture(scope="module")
def written(cargo_chordal: Command, tmp_path_factory: pytest.TempPathFactory) -> dict[str, dict[str, Path]]:
    """The files of each format, by their shape."""
    folder = tmp_path_factory.mktemp("foreign readers")
    files: dict[str, dict[str, Path]] = {extension: {} for extension in READERS}

    def convert(source: Path, out: Path) -> Path:
        done = cargo_chordal("convert", source, "-o", out, "-q")
        assert done.returncode == 0, (out.name, done.stderr.decode())
        return out

    for i, (name, shape) in enumerate(SHAPES.items()):
        source = folder / f"{i}.obj"
        source.write_text(shape.text, encoding="utf-8")
        if name == "long history":
            for step in range(STEPS):
                source = convert(source, folder / f"{i}_{step}.obj")
        for extension, of_format in files.items():
            of_format[name] = convert(source, folder / f"shape_{i}.{extension}")
    return files


def opened_by(library: str, paths: list[Path]) -> list[dict[str, Any]]:
    """What a library says of files. One at which it ended its process is the last that has an answer."""
    answers: list[dict[str, Any]] = []
    while len(answers) < len(paths):
        rest = "\n".join(map(str, paths[len(answers) :]))
        program = [sys.executable, str(Path(__file__).with_name("foreign_readers.py")), library]
        done = subprocess.run(program, input=rest, capture_output=True, encoding="utf-8", check=False, timeout=300)
        # Some print to the same place.
        found = [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]
        if found and "missing" in found[0]:
            pytest.skip(f"{library} is not installed: {found[0]['missing']}")
        answers += found
        if len(answers) < len(paths):
            answers.append({"error": f"it ended the process: {done.stderr[-300:]}"})
    return answers


LIBRARIES = sorted({library for readers in READERS.values() for library in readers})


@pytest.mark.parametrize("library", LIBRARIES)
def test_another_library_finds_the_same_triangles(written: dict[str, dict[str, Path]], library: str) -> None:
    opened = [extension for extension, readers in READERS.items() if library in readers]
    files = [(path, name) for extension in opened for name, path in written[extension].items()]
    wrong = []
    for (path, name), found in zip(files, opened_by(library, [path for path, _ in files]), strict=True):
        shape = SHAPES[name]
        about = f"{path.suffix} of {name}"
        if "error" in found:
            wrong.append(f"{about}: {found['error']}")
            continue
        if found["n"] != shape.n:
            wrong.append(f"{about}: {found['n']} triangles, not {shape.n}")
        bounds = np.array(found["bounds"])
        # Single precision, of the place and of sums with it.
        slack = 4 * 2.0**-24 * np.abs([shape.low, shape.high]).max()
        if np.abs(bounds - [shape.low, shape.high]).max() > slack:
            wrong.append(f"{about}: bounds {bounds.tolist()}, not {[shape.low, shape.high]}")
    assert not wrong, "\n".join(wrong)


def test_the_long_certificate_is_long_and_still_read(
    written: dict[str, dict[str, Path]], cargo_chordal: Command
) -> None:
    for extension in ("ply", "obj", "off", "glb", "3mf", "vtp", "usda"):
        done = cargo_chordal("inspect", written[extension]["long history"], "--json")
        found = json.loads(done.stdout)["inspection"]["found"]
        steps = found["certificate"]["history"]["steps"]
        assert len(steps) == STEPS + 1 and len(json.dumps(found["certificate"])) > 10_000, extension


@pytest.mark.parametrize("library", ["pynrrd", "vtk_nrrd"])
def test_another_library_reads_a_volume(cargo_chordal: Command, tmp_path: Path, library: str) -> None:
    out = tmp_path / "ball.nrrd"
    done = cargo_chordal("bake", ROOT / "examples" / "block.star", "--cells", "12", "-o", out, "-q")
    assert done.returncode == 0, done.stderr.decode()
    dense = tmp_path / "ball.npy"
    assert cargo_chordal("convert", out, "-o", dense, "-q").returncode == 0
    values = np.load(dense)
    [found] = opened_by(library, [out])
    assert found == {"n": values.size, "bounds": [[values.min()] * 3, [values.max()] * 3]}
