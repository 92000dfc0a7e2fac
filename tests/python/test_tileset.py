"""Tilesets of volumes that are read a block at a time: no cracks whichever tiles are shown, and none is off by more than it says."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import chordal

STEPS: Any = {"spacing": (0.7, 1.1, 0.5), "origin": (-30.0, 4.0, 100.0)}


def waves(shape: tuple[int, ...], seed: int) -> NDArray[np.float32]:
    """Sheets with handles, and some noise."""
    rng = np.random.default_rng(seed)
    x, y, z = (axis / 4.0 + rng.uniform(0, 6) for axis in np.indices(shape))
    smooth = np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x)
    found: NDArray[np.float32] = (smooth + rng.normal(0, 0.03, shape)).astype(np.float32)
    return found


def tiles(document: Path) -> Any:
    return json.loads(document.read_text())["root"]


def shown(tile: Any, rng: np.random.Generator, often: float) -> list[Any]:
    """Some tiles that together show all: a tile, or in its place its children."""
    children = tile.get("children", [])
    if not children or ("content" in tile and rng.random() > often):
        return [tile]
    return [one for child in children for one in shown(child, rng, often)]


def together(folder: Path, chosen: list[Any]) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    """The triangles of tiles, joined where their coordinates are the same numbers; and their normals."""
    points, normals, corners = [], [], []
    for tile in chosen:
        mesh = chordal.load(folder / tile["content"]["uri"])
        assert isinstance(mesh, chordal.Mesh)
        points.append(mesh.vertices[mesh.faces].reshape(-1, 3))
        vertex = np.asarray(mesh.vertex_normals)
        normals.append(vertex[mesh.faces].reshape(-1, 3))
        corners.append(len(mesh.faces))
    places, index = np.unique(np.concatenate(points), axis=0, return_inverse=True)
    return places, index.reshape(-1, 3).astype(np.int64), np.concatenate(normals)


@pytest.mark.parametrize("seed", range(4))
def test_any_mixture_of_tiles_is_closed_and_as_near_as_they_say(tmp_path: Path, seed: int) -> None:
    shape = ((22, 20, 28), (40, 14, 14), (21, 21, 21), (12, 28, 23))[seed]
    samples = waves(shape, seed)
    volume = chordal.block_volume(samples, **STEPS)
    tol = (0.8, None, 0.9, 1.2)[seed]
    made = volume.tileset(tmp_path / "tiles", iso=0.1, tol=tol, block=(8, (11, 9, 7), 6, 9)[seed], normals=seed != 2)
    whole = chordal.volume(samples, **STEPS).mesh(iso=0.1)
    assert made.bound.evidence == "proved" and made.bound.at_most is not None
    assert tol is None or made.bound.at_most <= tol
    assert made.triangles > made.coarsest and not (tmp_path / "tiles" / "parts").exists()
    root = tiles(Path(made.path))
    origin = np.array(root.get("transform", np.eye(4).ravel())).reshape(4, 4)[3, :3]
    # Tiles are z-up, and what is shown in them is turned.
    middle = np.array([origin[0], origin[2], -origin[1]])
    rng = np.random.default_rng(seed)
    for often in (1.0, 0.8, 0.4, 0.0):
        chosen = shown(root, rng, often)
        places, faces, _ = together(tmp_path / "tiles", chosen)
        mesh = chordal.Mesh(places + middle, faces)
        assert mesh.is_watertight, (often, len(chosen))
        says = max(tile["extras"]["chordal"]["at_most"] for tile in chosen)
        off = mesh.deviation(whole).bound
        assert off.at_least <= says + (whole.bound.at_most or 0.0), (often, off, says)
        errors = [(tile["geometricError"], tile["extras"]["chordal"]["at_most"]) for tile in chosen]
        assert all(error >= off or error == 0 for error, off in errors)


def test_normals_of_vertices_that_tiles_share_are_the_same(tmp_path: Path) -> None:
    samples = waves((20, 20, 20), 7)
    volume = chordal.block_volume(samples)
    made = volume.tileset(tmp_path / "tiles", iso=0.0, inside="high", border="open", block=7)
    places, faces, normals = together(tmp_path / "tiles", shown(tiles(Path(made.path)), np.random.default_rng(0), 1.0))
    assert np.allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-6)
    first = np.zeros((len(places), 3))
    first[faces.ravel()] = normals
    assert np.array_equal(first[faces.ravel()], normals)
    # They point away from what is above the level.
    corners = places[faces]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert np.mean(np.einsum("ij,ij->i", across, normals.reshape(-1, 3, 3).mean(axis=1)) > 0) > 0.95


def files(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


KILLED = """
import sys, numpy, chordal
samples = numpy.load(sys.argv[1], mmap_mode="r")
def told(stage, done, total):
    print(done, flush=True)
    if done == 20:
        sys.stdin.readline()
chordal.block_volume(sys.argv[1]).tileset(sys.argv[2], iso=0.0, inside="high", block=8, progress=told)
"""


def test_what_was_killed_goes_on(tmp_path: Path) -> None:
    samples = waves((30, 30, 30), 3)
    np.save(tmp_path / "waves.npy", samples)
    command = [sys.executable, "-c", KILLED, str(tmp_path / "waves.npy"), str(tmp_path / "tiles")]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, encoding="utf-8") as child:
        assert child.stdout is not None
        for line in child.stdout:
            if line.strip() == "20":
                break
        volume = chordal.block_volume(tmp_path / "waves.npy")
        with pytest.raises(chordal.Error, match="parts: another program is at work in this folder"):
            volume.tileset(tmp_path / "tiles", iso=0.0, inside="high", block=8)
        os.kill(child.pid, signal.SIGKILL)
    assert not (tmp_path / "tiles" / "tileset.json").exists()
    with pytest.raises(chordal.Error, match="holds blocks of another volume, level or version"):
        volume.tileset(tmp_path / "tiles", iso=0.25, block=8)
    # One of what is kept is damaged, too.
    damaged = next(iter(sorted((tmp_path / "tiles" / "parts").glob("*.chordal"))))
    damaged.write_bytes(damaged.read_bytes()[:-1])
    told: list[int] = []
    volume.tileset(tmp_path / "tiles", iso=0.0, inside="high", block=8, progress=lambda stage, done, total: told.append(done))
    assert 0 < len(told) < 4**3 + 8 + 1
    whole = chordal.block_volume(samples).tileset(tmp_path / "whole", iso=0.0, inside="high", block=8)
    assert files(tmp_path / "tiles") == files(tmp_path / "whole") and whole.tiles > 64
    with pytest.raises(chordal.Error, match="this folder holds a tileset"):
        volume.tileset(tmp_path / "tiles", iso=0.0, inside="high", block=8)


def test_a_level_without_a_surface_and_a_length_that_is_too_short_are_said(tmp_path: Path) -> None:
    samples = waves((20, 20, 20), 5)
    volume = chordal.block_volume(samples)
    with pytest.raises(chordal.Refused, match="no block has a surface"):
        volume.tileset(tmp_path / "none", iso=50.0, block=8)
    with pytest.raises(chordal.BudgetUnmet, match="the finest tiles are proved to be within") as unmet:
        volume.tileset(tmp_path / "short", iso=0.0, inside="high", tol=1e-9, block=8)
    assert Path(unmet.value.best.path).exists() and (unmet.value.bound.at_most or 0.0) > 1e-9
    with pytest.raises(chordal.BudgetUnmet, match="the triangles of the blocks are proved to be within"):
        volume.mesh(iso=0.0, inside="high", tol=1e-9, block=8)
    with pytest.raises(chordal.BudgetError, match="a length above 0"):
        volume.mesh(iso=0.0, inside="high", tol=0.0)


@pytest.mark.parametrize("seed", range(3))
def test_blocks_are_simplified_within_the_length_and_fit(seed: int) -> None:
    samples = waves((26, 21, 17), seed)
    volume = chordal.block_volume(samples, **STEPS)
    whole = chordal.volume(samples, **STEPS).mesh(iso=0.0, inside="high")
    for tol in (0.9, 1.6):
        made = volume.mesh(iso=0.0, inside="high", tol=tol, block=9)
        assert made.is_watertight and made.bound.evidence == "proved"
        assert made.bound.at_most is not None and made.bound.at_most <= tol
        assert made.deviation(whole).bound.at_least <= tol + (whole.bound.at_most or 0.0)
        assert len(made.faces) < 0.6 * len(whole.faces)


def test_a_bound_of_a_block_is_of_its_own_triangles_also_with_normals() -> None:
    # What lies beyond a block may be near its surface, and belongs to a part that is simplified by itself.
    from chordal._blockwise.tasks import part_of_block

    samples = waves((20, 20, 20), 2)
    samples[10:] = samples[10]
    volume = chordal.block_volume(samples)
    plain = volume._surface(0.0, "high", "capped")
    shaded = replace(plain, normals=True)
    for block in volume.blocks(7):
        one, two = part_of_block(plain, samples, block), part_of_block(shaded, samples, block)
        assert (one is None) == (two is None)
        if one is not None and two is not None:
            assert one.at_most == two.at_most and one.n_faces == two.n_faces


def test_folders_with_other_things_in_them_stay_as_they_are(tmp_path: Path) -> None:
    volume = chordal.block_volume(waves((20, 20, 20), 3))
    mine = tmp_path / "tiles" / "parts" / "mine.txt"
    mine.parent.mkdir(parents=True)
    mine.write_text("precious")
    with pytest.raises(chordal.Error, match=r"parts: this folder holds other files, as mine\.txt"):
        volume.tileset(tmp_path / "tiles", iso=0.0, inside="high", block=8)
    assert mine.read_text() == "precious"
    # Nor are results of other samples taken for these.
    folder = tmp_path / "done"
    volume.mesh(iso=0.0, inside="high", block=8, folder=folder)
    with pytest.raises(chordal.Error, match="blocks of another volume"):
        chordal.block_volume(waves((20, 20, 20), 4)).mesh(iso=0.0, inside="high", block=8, folder=folder)


def test_a_result_that_is_damaged_meanwhile_is_no_hole(tmp_path: Path) -> None:
    volume = chordal.block_volume(waves((20, 20, 20), 3))

    def damage(stage: str, done: int, total: int) -> None:
        if done == 1:
            path = next((tmp_path / "tiles" / "parts").glob("*.chordal"))
            path.write_bytes(path.read_bytes()[:-1] + b"?")

    arguments: Any = {"iso": 0.0, "inside": "high", "block": 8}
    with pytest.raises(chordal.Error, match="is damaged or gone: the same call again"):
        volume.tileset(tmp_path / "tiles", progress=damage, **arguments)
    volume.tileset(tmp_path / "tiles", **arguments)
    volume.tileset(tmp_path / "whole", **arguments)
    assert files(tmp_path / "tiles") == files(tmp_path / "whole")
