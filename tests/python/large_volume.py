"""A Zarr volume of 8 GB becomes a tileset on three workers, one of which is killed meanwhile; then its tiles are looked at.

`python tests/python/large_volume.py FOLDER [--side 2048]` makes what it needs in the folder (10 GB), prints one line of JSON
with times and memory, and ends with an error where something is lost. Needs zarr and distributed.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import shutil
import signal
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
import zarr
from distributed import Client, LocalCluster
from numpy.typing import NDArray

import chordal

CHUNK = 128
#: Samples of an intensity: so many steps of it for a step of the lattice, 127.5 on the surface.
SLOPE = 40.0


def blobs(side: int, count: int) -> NDArray[np.float64]:
    """Centres and radii."""
    rng = np.random.default_rng(side)
    radii = rng.uniform(0.03, 0.11, count) * side
    centres = rng.uniform(0.12, 0.88, (count, 3)) * side
    return np.column_stack([centres, radii])


def fill(path: str, side: int, known: NDArray[np.float64], low: tuple[int, int, int]) -> None:
    """A chunk: bumpy balls, as intensities."""
    axes = [np.arange(at, min(at + CHUNK, side), dtype=np.float32) for at in low]
    x, y, z = np.meshgrid(*axes, indexing="ij", sparse=True)
    middle, reach = np.array(low) + CHUNK / 2, CHUNK
    found = np.full((len(axes[0]), len(axes[1]), len(axes[2])), -10.0, np.float32)
    for *centre, radius in known:
        if np.linalg.norm(np.array(centre) - middle) < radius + 2 * reach:
            dx, dy, dz = (axis - np.float32(at) for axis, at in zip((x, y, z), centre, strict=True))
            away = np.sqrt(dx * dx + dy * dy + dz * dz)
            bumps = 2 * np.sin(dx / 9) * np.sin(dy / 11) * np.sin(dz / 10)
            np.maximum(found, np.float32(radius) - away + bumps, out=found)
    samples = np.clip(127.5 + SLOPE * found, 0, 255).astype(np.uint8)
    place = tuple(slice(at, at + n) for at, n in zip(low, samples.shape, strict=True))
    zarr.open_array(path, mode="r+")[place] = samples


def find_chordal(paths: list[str]) -> None:
    sys.path[:0] = [path for path in paths if path not in sys.path]


def most_memory() -> int:
    """The largest memory of this process so far, in MB; what `getrusage` says begins with that of who started it."""
    found = re.search(r"VmHWM:\s*(\d+)", Path("/proc/self/status").read_text())
    assert found is not None
    return int(found[1]) // 1024


def shown(tile: Any, rng: np.random.Generator, often: float) -> list[Any]:
    children = tile.get("children", [])
    if not children or ("content" in tile and rng.random() > often):
        return [tile]
    return [one for child in children for one in shown(child, rng, often)]


def check(folder: Path, chosen: list[Any]) -> int:
    """Tiles that show all are closed together: each edge is run through once each way. The number of their triangles."""
    corners = []
    for tile in chosen:
        mesh = chordal.load(folder / tile["content"]["uri"])
        assert isinstance(mesh, chordal.Mesh)
        corners.append(mesh.vertices[mesh.faces].reshape(-1, 3))
    places = np.ascontiguousarray(np.concatenate(corners))
    _, index = np.unique(places.view([("", places.dtype)] * 3), return_inverse=True)
    faces = index.reshape(-1, 3).astype(np.int64)
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    count = index.max() + 1
    there, back = np.sort(edges[:, 0] * count + edges[:, 1]), np.sort(edges[:, 1] * count + edges[:, 0])
    assert np.array_equal(there, back) and np.all(np.diff(there) > 0), "tiles do not fit"
    return len(faces)


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("folder", type=Path)
    arguments.add_argument("--side", type=int, default=2048)
    arguments.add_argument("--blobs", type=int, default=60)
    arguments.add_argument("--block", type=int, default=256)
    arguments.add_argument("--tol", type=float, default=1.0)
    arguments.add_argument("--workers", type=int, default=3)
    given = arguments.parse_args()
    path = str(given.folder / f"blobs_{given.side}.zarr")
    facts: dict[str, Any] = {"samples": given.side**3, "workers": given.workers, "block": given.block, "tol": given.tol}
    if not (given.folder / "made").exists():
        began = time.monotonic()
        shape, chunks = (given.side,) * 3, (CHUNK,) * 3
        zarr.create_array(path, shape=shape, chunks=chunks, dtype="u1", overwrite=True)
        low = [(i, j, k) for i in range(0, given.side, CHUNK) for j in range(0, given.side, CHUNK) for k in range(0, given.side, CHUNK)]
        with ProcessPoolExecutor(os.cpu_count(), mp_context=get_context("spawn")) as pool:
            call = partial(fill, path, given.side, blobs(given.side, given.blobs))
            assert sum(1 for _ in pool.map(call, low, chunksize=8)) == len(low)
        (given.folder / "made").touch()
        facts["making"] = round(time.monotonic() - began, 1)
    target = given.folder / "tiles"
    shutil.rmtree(target, ignore_errors=True)
    limits: Any = {"n_workers": given.workers, "threads_per_worker": 1, "processes": True, "dashboard_address": None}
    killed: list[int] = []
    with LocalCluster(**limits, silence_logs=50) as cluster, Client(cluster) as client:
        client.run(find_chordal, sys.path)
        pids = client.run(os.getpid)

        def kill(stage: str, done: int, total: int) -> None:
            if 5 * done > total and not killed:
                killed.append(next(iter(pids.values())))
                os.kill(killed[0], signal.SIGKILL)
            if done % 50 == 0 or done == total:
                print(f"{stage} {done} of {total}", file=sys.stderr, flush=True)

        began = time.monotonic()
        volume = chordal.block_volume(path, spacing=0.5, unit="um")
        made = volume.tileset(target, iso=127.5, tol=given.tol, block=given.block, executor=client, progress=kill)
        facts["seconds"] = round(time.monotonic() - began, 1)
        facts["MB_of_workers"] = sorted(client.run(most_memory).values())
    facts |= {"MB_here": most_memory(), "tiles": made.tiles, "triangles": made.triangles, "at_most": made.bound.at_most}
    facts["bytes"] = sum(file.stat().st_size for file in target.rglob("*") if file.is_file())
    assert killed and made.bound.evidence == "proved" and made.bound.at_most is not None and made.bound.at_most <= given.tol
    root = json.loads(Path(made.path).read_text())["root"]
    rng = np.random.default_rng(1)
    facts["shown"] = [check(target, shown(root, rng, often)) for often in (1.0, 0.7, 0.3, 0.0)]
    assert facts["shown"][0] == made.triangles
    print(json.dumps(facts))


if __name__ == "__main__":
    main()
