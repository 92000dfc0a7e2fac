"""Neuroglancer's meshes of several levels, read by what its format says: each level is closed, cut where it is to be, and not
off by more than was said."""

from __future__ import annotations

import importlib
import json
import os
import signal
import struct
import subprocess
import sys
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import chordal

DracoPy: Any = pytest.importorskip("DracoPy", reason="DracoPy is not installed: meshes of several levels are not tried")

#: The largest number of a coordinate, and where the halves of a fragment meet: those of Neuroglancer's format and viewer.
STEPS, MIDDLE = 65_535, 32_768
OBLIQUE = [[0.9, 0.2, 0.0, -30.0], [0.0, 1.1, 0.1, 400.0], [0.1, 0.0, -2.3, 7.0], [0.0, 0.0, 0.0, 1.0]]


@dataclass
class Level:
    """One as the files have it: the places of its fragments with their bytes, and the whole in numbers of the finest step."""

    places: dict[tuple[int, int, int], int]
    #: For each fragment that is not empty: whole numbers, and triangles.
    fragments: dict[tuple[int, int, int], tuple[NDArray[np.int64], NDArray[np.int64]]]
    scale: float

    def whole(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """All triangles, joined where their vertices are the same numbers: steps of the level from the origin of the grid."""
        corners = [
            (np.array(place) * STEPS + numbers)[faces].reshape(-1, 3) for place, (numbers, faces) in self.fragments.items()
        ]
        vertices, rows = np.unique(np.concatenate(corners), axis=0, return_inverse=True)
        return vertices, rows.reshape(-1, 3).astype(np.int64)


@dataclass
class Read:
    """The levels of a label, and what places them."""

    shape: NDArray[np.float64]
    origin: NDArray[np.float64]
    transform: NDArray[np.float64]
    levels: list[Level]

    def points(self, lod: int, numbers: NDArray[np.int64]) -> NDArray[np.float64]:
        """Where whole numbers of a level are, in micrometres."""
        stored = self.origin + self.shape * 2.0**lod * numbers / STEPS
        placed: NDArray[np.float64] = (stored @ self.transform[:, :3].T + self.transform[:, 3]) / 1e3
        return placed


def read(folder: Path, label: int) -> Read:
    """By the text of the format, and no code of the package."""
    info = json.loads((folder / "info").read_text())
    assert info["@type"] == "neuroglancer_multilod_draco" and info["vertex_quantization_bits"] == 16
    content = (folder / f"{label}.index").read_bytes()
    at = 0

    def take(form: str, n: int) -> list[Any]:
        nonlocal at
        found = struct.unpack_from(f"<{n}{form}", content, at)
        at += 4 * n
        return list(found)

    shape, origin = np.array(take("f", 3)), np.array(take("f", 3))
    (n,) = take("I", 1)
    scales = [scale * info["lod_scale_multiplier"] for scale in take("f", n)]
    assert take("f", 3 * n) == [0.0] * (3 * n)
    counts = take("I", n)
    data = (folder / f"{label}").read_bytes()
    levels, start = [], 0
    for lod in range(n):
        axes = [take("I", counts[lod]) for _ in range(3)]
        level = Level({}, {}, scales[lod])
        for x, y, z, size in zip(*axes, take("I", counts[lod]), strict=True):
            level.places[x, y, z] = size
            if size:
                level.fragments[x, y, z] = decoded(data[start : start + size])
            start += size
        levels.append(level)
    assert start == len(data) and at == len(content)
    return Read(shape, origin, np.array(info["transform"]).reshape(3, 4), levels)


def decoded(content: bytes) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    mesh = DracoPy.decode(content)
    # 5 is Draco's type of whole numbers of 32 bits: Neuroglancer refuses others, and nothing was quantised by Draco itself.
    assert [attribute["data_type"] for attribute in mesh.attributes] == [5]
    numbers = np.asarray(mesh.points).astype(np.int64)
    assert np.array_equal(numbers, mesh.points) and numbers.min() >= 0 and numbers.max() <= STEPS
    return numbers, np.asarray(mesh.faces).astype(np.int64)


def is_before(a: tuple[int, ...], b: tuple[int, ...]) -> bool:
    """Whether a place comes first on the Z-curve: the axis of the highest bit that differs decides, z before y before x."""
    highest = [((x ^ y).bit_length(), axis) for axis, (x, y) in enumerate(zip(a, b, strict=True))]
    axis = max(highest)[1]
    return a[axis] < b[axis]


def is_closed(faces: NDArray[np.int64]) -> bool:
    """Whether as many triangles run along each edge as back."""
    edges: Counter[tuple[int, int]] = Counter()
    for a, b in np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]).tolist():
        edges[min(a, b), max(a, b)] += 1 if a < b else -1
    return not any(edges.values())


def distances(points: NDArray[Any], triangles: NDArray[Any]) -> NDArray[Any]:
    """From each point to the nearest of the triangles: to its plane where the foot is inside, or to its edges."""
    best = np.full(len(points), np.inf)
    for k in range(3):
        a, along = triangles[:, k], triangles[:, (k + 1) % 3] - triangles[:, k]
        length = np.maximum(np.einsum("fi,fi->f", along, along), 1e-300)
        t = np.clip(np.einsum("pfi,fi->pf", points[:, None] - a, along) / length, 0, 1)
        best = np.minimum(best, np.linalg.norm(points[:, None] - a - t[..., None] * along, axis=2).min(axis=1))
    a, u, v = triangles[:, 0], triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    normal = np.cross(u, v)
    area = np.einsum("fi,fi->f", normal, normal)
    some = area > 1e-18
    a, u, v, normal, area = a[some], u[some], v[some], normal[some], area[some]
    from_a = points[:, None] - a
    s = np.einsum("pfi,fi->pf", np.cross(from_a, v), normal) / area
    t = np.einsum("pfi,fi->pf", np.cross(u, from_a), normal) / area
    height = np.abs(np.einsum("pfi,fi->pf", from_a, normal)) / np.sqrt(area)
    inside = np.where((s >= 0) & (t >= 0) & (s + t <= 1), height, np.inf)
    nearest: NDArray[Any] = np.minimum(best, inside.min(axis=1))
    return nearest


def cells(shape: tuple[int, int, int], n: int, seed: int) -> NDArray[np.uint16]:
    """Labels that are round where nobody is beside them, some with an island of one sample elsewhere."""
    rng = np.random.default_rng(seed)
    at = np.indices(shape)
    centres = rng.uniform(0, 1, (n, 3)) * shape
    away = np.stack([sum((at[k] - centre[k]) ** 2 for k in range(3)) for centre in centres])
    found = np.where(away.min(axis=0) < 60, away.argmin(axis=0) + 1, 0).astype(np.uint16)
    found[tuple(n - 2 for n in shape)] = 1
    return found


CASES: Any = [
    ((21, 26, 18), (7, 8, 5), 0.9, {"affine": OBLIQUE, "unit": "um"}),
    ((30, 17, 22), 9, None, {"spacing": (0.5, 0.7, 2.0), "unit": "um"}),
    ((24, 24, 24), 6, 0.6, {"spacing": 0.5, "origin": (1e4, -3e4, 5.0), "unit": "um"}),
]


@pytest.mark.parametrize("case", range(len(CASES)))
def test_each_level_is_closed_cut_and_within_its_bound(tmp_path: Path, case: int) -> None:
    shape, block, tol, placed = CASES[case]
    samples = cells(shape, 5, case)
    volume = chordal.block_volume(samples, **placed)
    found = volume.precomputed_levels(tmp_path / "levels", tol=tol, block=block)
    names = sorted(path.name for path in (tmp_path / "levels").iterdir())
    assert names == sorted(["info", *(f"{label}{end}" for label in found for end in ("", ".index"))])
    whole = volume.labels()
    assert list(found) == list(whole)
    affine = volume._affine
    rng = np.random.default_rng(case)
    directions = rng.normal(size=(500, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    steps = np.array([[row[k] for row in affine] for k in range(3)])
    # What a viewer takes for the size of a cell on the screen, seen from somewhere: of the steps the longest one.
    seen = np.sqrt(np.sum(steps**2, axis=1) - (directions @ steps.T) ** 2).max(axis=1)
    for label, levels in found.items():
        made = read(tmp_path / "levels", label)
        assert np.array_equal(made.transform, np.array(affine) * 1e3) and len(made.levels) == len(levels)
        assert len(made.levels[-1].fragments) == 1
        truth = on_surface(samples == label, rng)
        truth = truth @ np.array(affine)[:, :3].T + np.array(affine)[:, 3]
        for lod, (level, says) in enumerate(zip(made.levels, levels, strict=True)):
            places = list(level.places)
            assert all(is_before(a, b) for a, b in pairwise(places))
            assert says.fragments == len(level.fragments)
            if lod > 0:
                check_octants(level, made.levels[lod - 1])
                assert level.scale > made.levels[lod - 1].scale
            numbers, faces = level.whole()
            assert says.triangles == len(faces) and is_closed(faces)
            at_most = says.bound.at_most
            assert at_most is not None and says.bound.evidence == "proved"
            assert level.scale * seen.min() >= at_most, "no view takes a level for finer than it is"
            assert level.scale * seen.min() <= 1.6 * at_most
            points = made.points(lod, numbers)
            off = chordal.Mesh(points, faces).deviation(whole[label]).bound
            # The places of what was read are rounded, too.
            assert off.at_least <= at_most + (whole[label].bound.at_most or 0.0) + 1e-9
            assert distances(truth, points[faces]).max() <= at_most + 1e-9
            assert signed_volume(points, faces) > 0
        assert tol is None or (levels[0].bound.at_most or 0.0) <= tol
    assert max(map(len, found.values())) >= 3


def on_surface(mask: NDArray[np.bool_], rng: np.random.Generator) -> NDArray[np.float64]:
    """Points where the interpolant of a mask is a half for certain: in the middle between samples of both sides."""
    found = [np.argwhere(np.diff(mask.astype(np.int8), axis=axis)) + 0.5 * np.eye(3)[axis] for axis in range(3)]
    points: NDArray[np.float64] = np.concatenate(found)
    return points[rng.permutation(len(points))[:60]]


def check_octants(level: Level, below: Level) -> None:
    """Triangles are cut, and where there are some, the level below says what is there."""
    for place, (numbers, faces) in level.fragments.items():
        beyond = np.sign(numbers[faces] - MIDDLE)
        assert not np.any((beyond.min(axis=1) < 0) & (beyond.max(axis=1) > 0)), "a triangle crosses the middle"
        for x, y, z in np.unique(beyond.max(axis=1) > 0, axis=0).astype(int).tolist():
            assert (2 * place[0] + x, 2 * place[1] + y, 2 * place[2] + z) in below.places
    for x, y, z in below.places:
        assert (x // 2, y // 2, z // 2) in level.fragments


def signed_volume(points: NDArray[Any], faces: NDArray[Any]) -> float:
    """That of what triangles enclose; above 0 where they are wound as the front is."""
    corner = points[faces] - points[0]
    return float(np.einsum("ij,ij->i", corner[:, 0], np.cross(corner[:, 1], corner[:, 2])).sum())


def test_numbers_of_all_sizes_come_back_as_they_were() -> None:
    # Whole numbers of 16 bits, those at the ends among them.
    rng = np.random.default_rng(5)
    numbers = np.unique(rng.integers(0, STEPS + 1, (400, 3)), axis=0).astype(np.int32)
    numbers[:2] = [[0, 0, 0], [STEPS, STEPS, STEPS]]
    faces = rng.permutation(len(numbers))[: len(numbers) // 3 * 3].reshape(-1, 3).astype(np.uint32)
    found, corners = decoded(bytes(DracoPy.encode(numbers, faces, compression_level=7)))
    assert by_places(found, corners) == by_places(numbers.astype(np.int64), faces.astype(np.int64))


def by_places(numbers: NDArray[np.int64], faces: NDArray[np.int64]) -> list[Any]:
    """Triangles by the places of their corners, the least first, wound as they are."""
    triangles = []
    for face in faces:
        a, b, c = (tuple(numbers[row].tolist()) for row in face)
        triangles.append(min((a, b, c), (b, c, a), (c, a, b)))
    return sorted(triangles)


def files(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


KILLED = """
import sys, chordal
def told(stage, done, total):
    print(stage, done, flush=True)
    if f"{stage} {done}" == sys.argv[3]:
        sys.stdin.readline()
chordal.block_volume(sys.argv[1], spacing=0.5, unit="um").precomputed_levels(sys.argv[2], tol=0.5, block=7, progress=told)
"""


@pytest.mark.parametrize("when", ["level 0 9", "level 1 3"])
def test_what_was_killed_goes_on(tmp_path: Path, when: str) -> None:
    samples = cells((22, 24, 20), 4, 3)
    np.save(tmp_path / "cells.npy", samples)
    arguments: Any = {"tol": 0.5, "block": 7}
    folder = tmp_path / "levels"
    command = [sys.executable, "-c", KILLED, str(tmp_path / "cells.npy"), str(folder), when]
    volume = chordal.block_volume(tmp_path / "cells.npy", spacing=0.5, unit="um")
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, encoding="utf-8") as child:
        assert child.stdout is not None
        for line in child.stdout:
            if line.strip() == when:
                break
        with pytest.raises(chordal.Error, match="parts: another program is at work in this folder"):
            volume.precomputed_levels(folder, **arguments)
        os.kill(child.pid, signal.SIGKILL)
    assert not (folder / "info").exists()
    with pytest.raises(chordal.Error, match="holds blocks of another volume, level or version"):
        volume.precomputed_levels(folder, tol=0.25, block=7)
    # Of what is kept one is damaged, too, and what a level above it was made of is gone.
    kept = [sorted((folder / "parts").glob(name))[:1] for name in ("*_fragments.chordal", "1_*_0.chordal")]
    assert any(kept)
    for damaged in (one for some in kept for one in some):
        damaged.write_bytes(damaged.read_bytes()[:-1])
    told: list[str] = []
    volume.precomputed_levels(folder, progress=lambda stage, done, total: told.append(stage), **arguments)
    fresh: list[str] = []
    whole = chordal.block_volume(samples, spacing=0.5, unit="um")
    whole.precomputed_levels(tmp_path / "whole", progress=lambda stage, done, total: fresh.append(stage), **arguments)
    assert files(folder) == files(tmp_path / "whole") and 0 < len(told) < len(fresh)
    with pytest.raises(chordal.Error, match="this folder holds meshes or samples"):
        volume.precomputed_levels(folder, **arguments)


def test_a_result_that_is_damaged_meanwhile_is_no_hole(tmp_path: Path) -> None:
    volume = chordal.block_volume(cells((18, 18, 18), 3, 2), spacing=0.5, unit="um")
    arguments: Any = {"tol": 0.5, "block": 7}
    for name in ("0_1_1_1.chordal", "0_1_1_1_fragments.chordal"):
        folder = tmp_path / name

        def damage(stage: str, done: int, total: int, path: Path = folder / "parts" / name) -> None:
            if (stage, done) == ("level 0", total):
                path.write_bytes(path.read_bytes()[:-1] + b"?")

        with pytest.raises(chordal.Error, match="is damaged or gone: the same call again"):
            volume.precomputed_levels(folder, progress=damage, **arguments)
        volume.precomputed_levels(folder, **arguments)
        if not (tmp_path / "whole").exists():
            volume.precomputed_levels(tmp_path / "whole", **arguments)
        assert files(folder) == files(tmp_path / "whole")


def test_what_only_a_coarser_level_has_is_empty_below(tmp_path: Path) -> None:
    # A ball that ends beside a block: coarser triangles reach beyond it, into a block that has nothing.
    i, j, k = np.indices((40, 40, 40))
    ball = (i - 8.5) ** 2 + (j - 8.1) ** 2 + (k - 8.3) ** 2 < 7.8**2
    chordal.block_volume(ball.astype(np.uint8), unit="um").precomputed_levels(tmp_path / "ball", tol=1.2, block=16)
    fine, coarse = read(tmp_path / "ball", 1).levels
    assert 0 in fine.places.values() and not ball[:17, 16:33, :17].any()
    check_octants(coarse, fine)


def test_processes_give_the_same_bytes(tmp_path: Path) -> None:
    volume = chordal.block_volume(cells((22, 24, 20), 4, 8), spacing=0.5, unit="um")
    one = volume.precomputed_levels(tmp_path / "one", [1, 3, 77], block=8)
    with ProcessPoolExecutor(2) as executor:
        two = volume.precomputed_levels(tmp_path / "two", [1, 3, 77], block=8, executor=executor)
    assert one == two and set(one) <= {1, 3} and files(tmp_path / "one") == files(tmp_path / "two")


def test_what_cannot_be_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    samples = cells((12, 12, 12), 2, 1)
    with pytest.raises(ValueError, match="unit: these meshes are in nanometres"):
        chordal.block_volume(samples).precomputed_levels(tmp_path / "no unit")
    volume = chordal.block_volume(samples, unit="um")
    with pytest.raises(chordal.Refused, match="no block has a label"):
        volume.precomputed_levels(tmp_path / "none", [99], block=6)
    found = importlib.import_module

    def without(name: str) -> Any:
        if name == "DracoPy":
            raise ModuleNotFoundError("No module named 'DracoPy'", name=name)
        return found(name)

    monkeypatch.setattr(importlib, "import_module", without)
    with pytest.raises(ImportError, match="install the package DracoPy"):
        volume.precomputed_levels(tmp_path / "no Draco", block=6)
    assert not (tmp_path / "no Draco").exists()
