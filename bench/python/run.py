"""The Python package side by side with other packages; writes a section of RESULTS.md.

Run by `make python` with the package installed for release. What one call costs, arrays to and from trimesh, volumes block by
block against the whole and against other meshers of blocks.
"""

import argparse
import os
import re
import statistics
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from multiprocessing import get_context
from pathlib import Path

import numpy as np

import chordal

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import section  # noqa: E402

TITLE = "Python: calls, arrays, blocks and labels, against trimesh, zmesh, scikit-image and VTK"


def timed(work, runs=5):
    """The median of some runs, in seconds."""
    found = []
    for _ in range(runs):
        begun = time.perf_counter()
        work()
        found.append(time.perf_counter() - begun)
    return statistics.median(found)


def each(work, times):
    """Microseconds of one call of many."""
    return 1e6 * timed(lambda: [work() for _ in range(times)]) / times


def calls():
    """What one small call costs."""
    ball, point, curve = chordal.shapes.sphere(1), np.array([[0.1, 0.2, 0.3]]), chordal.shapes.arc(1)
    bezier = chordal.shapes.bezier([[0, 0], [0, 1], [1, 1], [1, 0]])
    mesh = ball.mesh(tol=0.1)
    rows = [
        ("`field(point)`", each(lambda: ball(point), 2_000)),
        ("`field.gradient(point)`", each(lambda: ball.gradient(point), 2_000)),
        ("`bezier.points_at(0.5)`", each(lambda: bezier.points_at(0.5), 2_000)),
        ("`bezier.flatten(tol=0.01)`", each(lambda: bezier.flatten(tol=0.01), 500)),
        ("`arc.flatten(tol=0.01)`", each(lambda: curve.flatten(tol=0.01), 500)),
        ("`mesh.vertices`", each(lambda: mesh.vertices, 5_000)),
        ("`shapes.sphere(1)`", each(lambda: chordal.shapes.sphere(1), 500)),
    ]
    return ["| call | µs |", "|---|---|", *(f"| {name} | {us:.1f} |" for name, us in rows)]


def grid(n):
    """A sheet of 2 n² triangles."""
    i, j = np.meshgrid(np.arange(n + 1), np.arange(n + 1), indexing="ij")
    vertices = np.stack([i, j, np.sin(i / 9.0) * np.cos(j / 7.0)], axis=-1).reshape(-1, 3).astype(float)
    at = (i * (n + 1) + j)[:-1, :-1].ravel()
    faces = np.concatenate([np.stack([at, at + n + 1, at + n + 2], 1), np.stack([at, at + n + 2, at + 1], 1)])
    return vertices, faces


def arrays():
    """A million triangles to and from trimesh."""
    import trimesh

    vertices, faces = grid(707)
    theirs = trimesh.Trimesh(vertices, faces, process=False)
    ours = chordal.Mesh(vertices, faces)
    rows = [
        ("`Mesh(vertices, faces)`", timed(lambda: chordal.Mesh(vertices, faces))),
        ("`Mesh.from_(trimesh)`", timed(lambda: chordal.Mesh.from_(theirs))),
        ("`mesh.to_trimesh()`", timed(ours.to_trimesh)),
        ("`trimesh.Trimesh(vertices, faces, process=False)`", timed(lambda: trimesh.Trimesh(vertices, faces, process=False))),
    ]
    return [f"| {len(faces):,} triangles | ms |", "|---|---|", *(f"| {name} | {1e3 * s:.1f} |" for name, s in rows)]


def waves(n):
    """Four periods of a gyroid a side, as f32."""
    axis = np.linspace(0, 8 * np.pi, n, dtype=np.float32)
    x, y, z = np.meshgrid(axis, axis, axis, indexing="ij", sparse=True)
    return np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x)


def skimage_blocks(samples, side):
    """The same blocks by scikit-image, joined by nothing."""
    from skimage.measure import marching_cubes

    count = 0
    for block in chordal.block_volume(samples).blocks(side):
        count += len(marching_cubes(samples[block.slices], 0.0)[1])
    return count


def vtk_blocks(samples, side):
    """The same by VTK's Flying Edges."""
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D

    count = 0
    for block in chordal.block_volume(samples).blocks(side):
        part = np.asfortranarray(samples[block.slices])
        image = vtkImageData()
        image.SetDimensions(*part.shape)
        image.GetPointData().SetScalars(numpy_to_vtk(part.ravel(order="F")))
        edges = vtkFlyingEdges3D()
        edges.SetInputData(image)
        edges.SetValue(0, 0.0)
        edges.ComputeNormalsOff()
        edges.ComputeGradientsOff()
        edges.ComputeScalarsOff()
        edges.Update()
        count += edges.GetOutput().GetNumberOfPolys()
    return count


def blocks(n):
    """A volume whole and in blocks."""
    samples = waves(n)
    volume, whole = chordal.block_volume(samples), chordal.volume(samples)
    made = whole.mesh(iso=0, inside="high")
    base = timed(lambda: chordal.volume(samples).mesh(iso=0, inside="high"), 3)
    rows = [(f"Chordal, whole, from the array: {len(made.faces):,} triangles, proved", base)]
    for side in (64, 128, 256):
        if side < n:
            rows.append((f"Chordal, blocks of {side}³, joined bit for bit, proved", timed(lambda s=side: volume.mesh(iso=0, inside="high", block=s), 3)))
    rows.append(("Chordal, blocks of 128³, simplified within half a cell, joined", timed(lambda: volume.mesh(iso=0, inside="high", tol=0.5, block=128), 1)))
    for name, call in (("scikit-image", skimage_blocks), ("VTK Flying Edges", vtk_blocks)):
        rows.append((f"{name}, blocks of 128³, not joined", timed(lambda c=call: c(samples, 128), 3)))
    mega = n**3 / 1e6
    head = [f"| {n}³ samples of f32 | s | M samples/s | speed / whole |", "|---|---|---|---|"]
    return [*head, *(f"| {name} | {s:.2f} | {mega / s:.0f} | {base / s:.2f} |" for name, s in rows)]


def cells_of(n, count):
    """Labels: each sample has that of its nearest centre."""
    from scipy.spatial import cKDTree

    rng = np.random.default_rng(5)
    tree = cKDTree(rng.uniform(0, n, (count, 3)))
    places = np.stack(np.indices((n, n, n), dtype=np.float32), axis=-1).reshape(-1, 3)
    return (tree.query(places, workers=-1)[1].reshape(n, n, n) + 1).astype(np.uint32)


def labels(n, count):
    """Every label of a volume."""
    import zmesh

    samples = cells_of(n, count)
    volume = chordal.block_volume(samples)

    def theirs():
        mesher = zmesh.Mesher((1, 1, 1))
        mesher.mesh(samples, close=True)
        found = [mesher.get(label, normals=False, reduction_factor=0) for label in mesher.ids()]
        return sum(len(mesh.faces) for mesh in found)

    ours = volume.labels(block=n)
    n_ours, n_theirs = sum(len(mesh.faces) for mesh in ours.values()), theirs()
    rows = [
        (f"Chordal, whole: {n_ours:,} triangles, proved", timed(lambda: chordal.labels(samples).mesh(), 3)),
        ("Chordal, one block, each label's mesh", timed(lambda: volume.labels(block=n), 3)),
        ("Chordal, blocks of 64³, joined bit for bit, proved", timed(lambda: volume.labels(block=64), 3)),
        (f"zmesh, whole: {n_theirs:,} triangles, one thread", timed(theirs, 3)),
    ]
    head = [f"| {n}³ samples, {count:,} labels | s | M samples/s |", "|---|---|---|"]
    return [*head, *(f"| {name} | {s:.2f} | {n**3 / 1e6 / s:.1f} |" for name, s in rows)]


def tasks(n):
    """Tiles of a Zarr volume by one, two … processes of this machine."""
    import zarr

    rows = []
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "waves.zarr")
        samples = (127.5 + 60 * waves(n)).clip(0, 255).astype(np.uint8)
        zarr.create_array(path, shape=samples.shape, chunks=(64, 64, 64), dtype="u1")[...] = samples
        volume = chordal.block_volume(path)
        for workers in range(1, (os.cpu_count() or 1) + 1):
            with ProcessPoolExecutor(workers, mp_context=get_context("spawn"), initializer=_one_thread) as pool:
                list(pool.map(_warm, range(2 * workers)))
                begun = time.perf_counter()
                made = volume.tileset(os.path.join(folder, f"tiles{workers}"), iso=127.5, tol=0.5, block=128, executor=pool)
                seconds = time.perf_counter() - begun
                memory = max(pool.map(_memory, range(8 * workers)))
            rows.append((workers, seconds, made.tiles, made.triangles, memory))
        raw = len(volume.mesh(iso=127.5, block=128).faces)
    head = [f"| workers | s | M samples/s | of {raw:,} triangles, µs each and worker | tiles | finest triangles | MB a worker, at most |", "|---|---|---|---|---|---|---|"]
    return [
        *head,
        *(
            f"| {workers} | {s:.1f} | {n**3 / 1e6 / s:.1f} | {1e6 * s * workers / raw:.1f} | {tiles:,} | {triangles:,} | {memory} |"
            for workers, s, tiles, triangles, memory in rows
        ),
    ]


def _one_thread():
    os.environ["RAYON_NUM_THREADS"] = "1"


def _warm(_):
    chordal.shapes.sphere(1).mesh(tol=0.1)
    time.sleep(0.2)


def _memory(_):
    """The most memory of this process in MB; what `getrusage` says begins with that of the process which started it."""
    time.sleep(0.02)
    return int(re.search(r"VmHWM:\s*(\d+)", Path("/proc/self/status").read_text())[1]) // 1024


def costs():
    """What a sample without a surface costs, and a task."""
    import distributed

    rows = []
    empty = chordal.block_volume(np.zeros((512, 512, 512), np.uint8))
    nothing = timed(lambda: _refused(empty, 128), 3)
    rows.append(("a sample without a surface, blocks of 128³ of u8", f"{1e9 * nothing / 512**3:.1f} ns"))
    few = chordal.block_volume(np.zeros((161, 161, 161), np.uint8))
    tasks = len(list(few.blocks(16)))
    rows.append(("a task of 16³ samples, in this process", f"{1e3 * timed(lambda: _refused(few, 16), 3) / tasks:.2f} ms"))
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        list(pool.map(_warm, range(4)))
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "few.npy")
            np.save(path, np.zeros((161, 161, 161), np.uint8))
            there = chordal.block_volume(path)
            rows.append(("the same, in two processes", f"{1e3 * timed(lambda: _refused(there, 16, executor=pool), 3) / tasks:.2f} ms"))
            limits = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None, "silence_logs": 50}
            with distributed.LocalCluster(**limits) as cluster, distributed.Client(cluster) as client:
                list(client.gather(client.map(_warm, range(4))))
                cost = 1e3 * timed(lambda: _refused(there, 16, executor=client), 3) / tasks
                rows.append(("the same, on a Dask scheduler with two workers", f"{cost:.2f} ms"))
    return ["| what | costs |", "|---|---|", *(f"| {name} | {cost} |" for name, cost in rows)]


def _refused(volume, side, **more):
    """Meshes what has no surface."""
    try:
        volume.mesh(iso=0.5, block=side, **more)
    except chordal.Refused:
        return
    raise AssertionError("there is a surface")


def large(n):
    """A volume of a billion samples from a file, in a process of its own, by its largest memory."""
    code = """
import re, sys, time, chordal
begun = time.perf_counter()
mesh = chordal.block_volume(sys.argv[1]).mesh(iso=0, inside="high", tol=0.5, block=256)
memory = int(re.search(r"VmHWM:\\s*(\\d+)", open("/proc/self/status").read())[1]) // 1024
print(len(mesh.faces), time.perf_counter() - begun, memory, mesh.bound.at_most)
"""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "waves.npy")
        file = np.lib.format.open_memmap(path, mode="w+", dtype=np.float32, shape=(n, n, n))
        axis = np.linspace(0, 8 * np.pi, n, dtype=np.float32)
        y, z = np.meshgrid(axis, axis, indexing="ij", sparse=True)
        for i, x in enumerate(axis):
            file[i] = np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x)
        del file
        done = subprocess.run([sys.executable, "-c", code, path], check=True, capture_output=True, text=True)
    faces, seconds, memory, most = done.stdout.split()
    return [
        f"{n}³ samples of f32 ({4 * n**3 / 1e9:.1f} GB) from an .npy file, `mesh(iso=0, tol=0.5, block=256)`: {float(seconds):.0f} s, "
        f"{int(faces):,} triangles within {float(most):.3f} cells, proved; {int(memory):,} MB at most, of which the file's own pages are part."
    ]


def main():
    """Runs what is asked and writes the section."""
    given = argparse.ArgumentParser(description=__doc__)
    given.add_argument("--only", help="the name of one part, which is printed and not written")
    given.add_argument("--side", type=int, default=256)
    given.add_argument("--large", type=int, default=0, help="samples a side of a volume from a file: 1024 takes 20 minutes")
    given = given.parse_args()
    parts = [calls, arrays, partial(blocks, given.side), partial(labels, 192, 400), costs, partial(tasks, 2 * given.side)]
    if given.large:
        parts.append(partial(large, given.large))
    if given.only:
        print("\n".join(next(part for part in parts if getattr(part, "func", part).__name__ == given.only)()))
        return
    text = []
    for part in parts:
        found = part()
        print("\n".join(found), flush=True)
        text += [*found, ""]
    section.put(TITLE, "\n".join([f"Measured on {section.machine()}.", "", *text]))


if __name__ == "__main__":
    main()
