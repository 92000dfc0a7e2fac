"""Blocks on a Dask cluster of three processes on this machine, one of which is killed meanwhile: nothing is lost."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import chordal

distributed: Any = pytest.importorskip(
    "distributed", reason="distributed is not installed: blocks on a cluster are not tried"
)
zarr: Any = pytest.importorskip("zarr", reason="zarr is not installed: blocks on a cluster are not tried")


def waves(n: int) -> Any:
    x, y, z = (axis / 7.0 for axis in np.meshgrid(*[np.arange(n, dtype=np.float32)] * 3, indexing="ij", sparse=True))
    return np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x)


class Slowed:
    """A Zarr array whose reads take a while, so that there is time to kill who reads."""

    def __init__(self, path: str) -> None:
        self._path = path
        array = zarr.open_array(path, mode="r")
        self.shape, self.dtype = array.shape, array.dtype

    def __getitem__(self, slices: Any) -> Any:
        time.sleep(0.1)
        return zarr.open_array(self._path, mode="r")[slices]


@pytest.fixture(name="cluster")
def three_workers() -> Any:
    with distributed.LocalCluster(
        n_workers=3, threads_per_worker=1, processes=True, dashboard_address=None, silence_logs=50
    ) as cluster:
        yield cluster


def test_a_worker_that_is_killed_loses_nothing(tmp_path: Path, cluster: Any) -> None:
    samples = waves(60)
    zarr.create_array(str(tmp_path / "waves.zarr"), shape=samples.shape, chunks=(16, 16, 16), dtype="f4")[...] = samples
    whole = chordal.volume(samples, spacing=0.5).mesh(iso=0.1)
    volume = chordal.block_volume(Slowed(str(tmp_path / "waves.zarr")), spacing=0.5)
    told: list[int] = []
    with distributed.Client(cluster) as client:
        client.run(_find_chordal, sys.path)
        victims = [worker["name"] for worker in client.scheduler_info()["workers"].values()]
        pids = client.run(os.getpid)

        def kill(stage: str, done: int, total: int) -> None:
            told.append(done)
            if done == 4:
                with contextlib.suppress(ProcessLookupError):
                    os.kill(next(iter(pids.values())), signal.SIGKILL)

        made = volume.mesh(iso=0.1, block=16, executor=client, folder=tmp_path / "done", progress=kill)
    assert len(victims) == 3 and told[-1] == 4**3
    assert made.vertices.tobytes() == whole.vertices.tobytes() and made.faces.tobytes() == whole.faces.tobytes()


def test_a_scheduler_is_named_by_its_address(tmp_path: Path, cluster: Any) -> None:
    samples = waves(24)
    zarr.create_array(str(tmp_path / "waves.zarr"), shape=samples.shape, chunks=(8, 8, 8), dtype="f4")[...] = samples
    volume = chordal.block_volume(tmp_path / "waves.zarr")
    with distributed.Client(cluster) as client:
        client.run(_find_chordal, sys.path)
    made = volume.mesh(iso=0.1, block=8, cluster=cluster.scheduler_address)
    whole = chordal.volume(samples).mesh(iso=0.1)
    assert made.vertices.tobytes() == whole.vertices.tobytes() and made.faces.tobytes() == whole.faces.tobytes()


def test_two_runs_on_one_folder_disturb_nothing(tmp_path: Path) -> None:
    samples = waves(30)
    volume = chordal.block_volume(samples)
    found: list[Any] = []
    both = [
        threading.Thread(target=lambda: found.append(volume.mesh(iso=0.1, block=10, folder=tmp_path / "done")))
        for _ in range(2)
    ]
    for one in both:
        one.start()
    for one in both:
        one.join()
    whole = chordal.volume(samples).mesh(iso=0.1)
    assert [made.faces.tobytes() for made in found] == [whole.faces.tobytes()] * 2


def _find_chordal(path: list[str]) -> None:
    """The workers look for modules where this process does."""
    sys.path[:] = path


def test_a_worker_that_is_killed_loses_no_tile(tmp_path: Path, cluster: Any) -> None:
    samples = waves(60)
    zarr.create_array(str(tmp_path / "waves.zarr"), shape=samples.shape, chunks=(16, 16, 16), dtype="f4")[...] = samples
    arguments: Any = {"iso": 0.1, "tol": 0.4, "block": 16}
    alone = chordal.block_volume(samples, spacing=0.5).tileset(tmp_path / "alone", **arguments)
    volume = chordal.block_volume(Slowed(str(tmp_path / "waves.zarr")), spacing=0.5)
    told: list[int] = []
    with distributed.Client(cluster) as client:
        client.run(_find_chordal, sys.path)
        pids = client.run(os.getpid)

        def kill(stage: str, done: int, total: int) -> None:
            told.append(done)
            if done == 5:
                with contextlib.suppress(ProcessLookupError):
                    os.kill(next(iter(pids.values())), signal.SIGKILL)

        made = volume.tileset(tmp_path / "tiles", executor=client, progress=kill, **arguments)
    assert told[-1] == 4**3 + 2**3 + 1 and made.tiles == alone.tiles > 64 and made.bound == alone.bound
    here, there = [sorted(path for path in (tmp_path / name).rglob("*") if path.is_file()) for name in ("alone", "tiles")]
    assert [path.read_bytes() for path in here] == [path.read_bytes() for path in there]


def test_levels_of_labels_are_the_same_on_a_cluster(tmp_path: Path, cluster: Any) -> None:
    pytest.importorskip("DracoPy", reason="DracoPy is not installed: meshes of several levels are not tried")
    i, j, k = np.indices((30, 26, 22))
    volume = chordal.block_volume(((i // 9 + j // 8 + k // 7) % 4).astype(np.uint16), spacing=0.5, unit="um")
    with distributed.Client(cluster) as client:
        client.run(_find_chordal, sys.path)
        there = volume.precomputed_levels(tmp_path / "there", tol=0.5, block=9, executor=client)
    here = volume.precomputed_levels(tmp_path / "here", tol=0.5, block=9)
    assert there == here and max(map(len, here.values())) > 2
    made = [{path.name: path.read_bytes() for path in (tmp_path / name).iterdir()} for name in ("there", "here")]
    assert made[0] == made[1]
