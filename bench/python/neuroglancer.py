"""Meshes of labels for Neuroglancer by igneous and by Chordal, of the same samples: a row of docs/scale.md each.

Each is run in an environment of its own: `python bench/python/neuroglancer.py igneous` with igneous-pipeline 4.37.0 installed,
`… chordal` with this package and DracoPy 2.2.0; `taskset -c 0` before it keeps it to one thread.
"""

import os
import shutil
import sys
import tempfile
import time

import numpy as np
from scipy.spatial import cKDTree

# 192³ samples of 8 nm with 400 labels: each sample has that of its nearest centre. Blocks of 96³.
SIDE, LABELS, NANOMETRES, BLOCK, ERROR = 192, 400, 8, 96, 40


def samples():
    """The labels."""
    tree = cKDTree(np.random.default_rng(5).uniform(0, SIDE, (LABELS, 3)))
    places = np.stack(np.indices((SIDE, SIDE, SIDE), dtype=np.float32), axis=-1).reshape(-1, 3)
    return (tree.query(places)[1].reshape(SIDE, SIDE, SIDE) + 1).astype(np.uint32)


def told(name, begun, folder):
    """A row: what was done, in which time, and what the folder takes."""
    size = sum(os.path.getsize(os.path.join(at, file)) for at, _, files in os.walk(folder) for file in files)
    print(f"{name}: {time.perf_counter() - begun:.1f} s, {size / 1e6:.1f} MB", flush=True)


def igneous(folder):
    """One level, simplified within 40 nm as its default is, then two more levels of the format."""
    import igneous.task_creation as tasks
    from cloudvolume import CloudVolume
    from taskqueue import LocalTaskQueue

    url = f"file://{folder}"
    CloudVolume.from_numpy(
        samples(), vol_path=url, resolution=(NANOMETRES,) * 3, chunk_size=(64, 64, 64), layer_type="segmentation"
    )
    queue = LocalTaskQueue(parallel=1)
    begun = time.perf_counter()
    queue.insert(tasks.create_meshing_tasks(url, mip=0, shape=(BLOCK,) * 3, mesh_dir="mesh", fill_missing=True))
    queue.execute()
    told("igneous, one level", begun, os.path.join(folder, "mesh"))
    queue.insert(tasks.create_unsharded_multires_mesh_tasks(url, num_lod=2, mesh_dir="mesh"))
    queue.execute()
    told("igneous, one level and then several", begun, os.path.join(folder, "mesh"))


def chordal(folder):
    """One level within the same length, proved; then all levels."""
    import chordal as package

    volume = package.block_volume(samples(), spacing=NANOMETRES, unit="nm")
    for method in ("precomputed", "precomputed_levels"):
        begun, target = time.perf_counter(), os.path.join(folder, method)
        getattr(volume, method)(target, tol=ERROR, block=BLOCK)
        told(method, begun, target)


if __name__ == "__main__":
    where = tempfile.mkdtemp()
    try:
        {"igneous": igneous, "chordal": chordal}[sys.argv[1]](where)
    finally:
        shutil.rmtree(where)
