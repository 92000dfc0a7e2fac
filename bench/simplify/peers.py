"""One side, one job, a line of JSON: `peers.py SIDE count THREADS MESH OUT TRIANGLES`, `peers.py SIDE tolerance THREADS MESH
OUT LENGTH` or `peers.py SIDE chain THREADS MESH FROM`. Chordal and meshoptimizer are asked through the `simplify` program.
"""

import json
import math
import os
import statistics
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
from meshfile import read, write

BENCH = Path(__file__).resolve().parent.parent
PROGRAM = str(Path(os.environ.get("CARGO_TARGET_DIR", BENCH / "target")) / "release" / "simplify")
#: Sides that are asked through the program.
COMPILED = ("ours", "meshopt", "meshopt-update")
#: Sides that take an error as a length and say one. VTK's and Open3D's are errors of quadrics, no lengths.
BY_ERROR = ("ours", "meshopt", "meshopt-update", "meshlib")
#: A chain ends at so many triangles, as in the program.
LEAST = 1000


def program(*words):
    """The line of JSON that the program prints."""
    done = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True, check=True)
    return json.loads(done.stdout.strip().split("\n")[-1])


def judge(mesh, other, limit=None):
    """How far two files are apart, proved, and what holds of the second."""
    return program("judge", mesh, other, *([] if limit is None else [repr(limit)]))


# Each of these: what a mesh is made into before the clock starts, what is timed, and what becomes of its result.


def vtk_(points, faces, count, length):
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy

    def prepare():
        poly, at, cells = vtk.vtkPolyData(), vtk.vtkPoints(), vtk.vtkCellArray()
        at.SetDataTypeToDouble()
        at.SetData(numpy_to_vtk(points, deep=True))
        rows = np.hstack([np.full((len(faces), 1), 3), faces]).astype(np.int64).ravel()
        cells.ImportLegacyFormat(numpy_to_vtkIdTypeArray(rows, deep=True))
        poly.SetPoints(at)
        poly.SetPolys(cells)
        made = vtk.vtkQuadricDecimation()
        made.SetInputData(poly)
        made.SetTargetReduction(1 - count / len(faces))
        return made

    def work(made):
        made.Update()
        return made.GetOutput()

    def result(out):
        rows = vtk_to_numpy(out.GetPolys().GetConnectivityArray()).reshape(-1, 3)
        return vtk_to_numpy(out.GetPoints().GetData()), rows, None

    return prepare, work, result


def fast_(points, faces, count, length):
    import fast_simplification

    def work(_):
        return fast_simplification.simplify(points, faces, target_count=count)

    return lambda: 0, work, lambda out: (*out, None)


def open3d_(points, faces, count, length):
    import open3d

    def prepare():
        vector = open3d.utility
        return open3d.geometry.TriangleMesh(vector.Vector3dVector(points), vector.Vector3iVector(faces))

    def result(out):
        return np.asarray(out.vertices), np.asarray(out.triangles), None

    return prepare, lambda mesh: mesh.simplify_quadric_decimation(count), result


def meshlib_(points, faces, count, length):
    from meshlib import mrmeshnumpy, mrmeshpy

    def prepare():
        settings = mrmeshpy.DecimateSettings()
        settings.packMesh = True
        if length is not None:
            settings.maxError = length
        if count is not None:
            settings.maxDeletedFaces = max(0, len(faces) - count)
        return mrmeshnumpy.meshFromFacesVerts(faces, points), settings

    def work(given):
        return given[0], mrmeshpy.decimateMesh(*given)

    def result(out):
        mesh, said = out
        verts, rows = mrmeshnumpy.getNumpyVerts(mesh), mrmeshnumpy.getNumpyFaces(mesh.topology)
        return verts.astype(np.float64), rows, said.errorIntroduced

    return prepare, work, result


def asked(side, threads, mesh, out, *, count=None, length=None, times=1):
    """Runs a side so many times and leaves its mesh in `out`: the median of the times, the triangles, the declared error."""
    if side in COMPILED:
        aim = f"error={length!r}" if count is None else f"count={count}"
        return program("run", side, threads, mesh, out, aim, times)
    prepare, work, result = globals()[side + "_"](*read(mesh), count, length)
    seconds = []
    while len(seconds) < times:
        given = prepare()
        start = time.perf_counter()
        made = work(given)
        seconds.append(time.perf_counter() - start)
        if seconds[0] > 10:
            times = min(times, 3)
    points, faces, declared = result(made)
    write(out, points, faces)
    return {"seconds": statistics.median(seconds), "declared": declared, "triangles": len(faces)}


class Search:
    """The fewest triangles that a side makes within a length of a mesh, as the judge proves it."""

    def __init__(self, side, threads, mesh, out, length):
        self.side, self.threads, self.mesh, self.length = side, threads, mesh, length
        self.trial, self.out = out + ".trial", out
        self.n = len(read(mesh)[1])
        self.best = None

    def run(self, **aim):
        return asked(self.side, self.threads, self.mesh, self.trial, **aim)

    def passes(self, how, at):
        """Whether a trial is within the length; the best one is kept."""
        if how == "error":
            got = self.run(length=at)
        elif at < 4:
            return False
        else:
            got = self.run(count=min(int(at), self.n))
        found = judge(self.mesh, self.trial, self.length)["at_most"]
        ok = found is not None and found <= self.length
        if ok and (self.best is None or got["triangles"] < self.best["triangles"]):
            self.best = {**got, "by": how, "parameter": at}
            os.replace(self.trial, self.out)
        return ok

    def over(self, how, at):
        """Looks along one parameter: doubled or halved until one trial passes and one fails, then their middle, until they
        are 2.3 % apart."""
        ends = {True: None, False: None}
        towards_fewer = 0.5 if how == "count" else 2.0
        for _ in range(18):
            ok = self.passes(how, at)
            ends[ok] = at
            if None in ends.values():
                at *= towards_fewer if ok else 1 / towards_fewer
            elif abs(math.log2(ends[True] / ends[False])) < 1 / 30:
                break
            else:
                at = math.sqrt(ends[True] * ends[False])


def tolerance(side, threads, mesh, out, length):
    """A side at its own setting, and the fewest triangles that it makes within the length, by either of its settings."""
    search = Search(side, threads, mesh, out, length)
    answer = {"n": search.n, "plain": None, "best": None}
    if side in BY_ERROR:
        plain = search.run(length=length)
        if plain["seconds"] is None:
            return {**answer, "why": plain["why"]}
        answer["plain"] = {**plain, **judge(mesh, search.trial)}
        if side == "ours":
            # Its own bound is the promise that counts: nothing is searched for.
            return {**answer, "best": answer["plain"]}
        search.over("error", length)
    # A distance goes as one over the triangles, where a surface is smooth; from 200 on, below which none is.
    count = min(max(200, search.n // 10), search.n)
    search.run(count=count)
    first = judge(mesh, search.trial)["at_most"]
    search.over("count", min(max(count * (first or length) / length, 12), search.n))
    if search.best:
        answer["best"] = {**search.best, **judge(mesh, out)}
    return answer


def chain(side, threads, mesh, start_from):
    """Levels of half the triangles each. The peak is what the process grew by from where it had read the mesh, and that
    mesh; the clock runs around the simplifying alone."""
    if side in COMPILED:
        return program("chain", side, threads, mesh, start_from)
    points, faces = read(mesh)
    globals()[side + "_"](points[:3], np.array([[0, 1, 2]], np.int32), 1, None)[0]()  # Loads the library.
    size = points.nbytes + faces.nbytes
    Path("/proc/self/clear_refs").write_text("5")
    before, whole, seconds, triangles, count = held("VmRSS"), size, 0.0, [], len(faces)
    at = points, faces
    while count > LEAST:
        count //= 2
        prepare, work, result = globals()[side + "_"](*(at if start_from == "last" else (points, faces)), count, None)
        given = prepare()
        start = time.perf_counter()
        made = work(given)
        seconds += time.perf_counter() - start
        made = result(made)
        at = made[0].astype(np.float64), made[1].astype(np.int32)
        whole += 24 * len(at[0]) + 12 * len(at[1])
        triangles.append(len(at[1]))
    return {"seconds": seconds, "triangles": triangles, "peak": held("VmHWM") - before + size, "bytes": whole}


def held(name):
    """A line of /proc/self/status in bytes."""
    line = next(line for line in open("/proc/self/status") if line.startswith(name))
    return int(line.split()[1]) * 1024


def sampled(mesh, other, n=200_000):
    """The largest distance between two files that samples find: both meshes' vertices, and `n` points of each at random, in a
    random order, as many as two seconds allow. It shares no code with Chordal: the nearest points are libigl's, whose tree
    is slow among long thin triangles."""
    import igl

    random, worst = np.random.default_rng(1), 0.0
    both = [read(mesh), read(other)]
    for (points, faces), (to, triangles) in (both, both[::-1]):
        corners = points[faces]
        area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        chosen = corners[random.choice(len(faces), n, p=area / area.sum())]
        u, v = random.random((2, n))
        u, v = np.where(u + v > 1, 1 - u, u), np.where(u + v > 1, 1 - v, v)
        inside = chosen[:, 0] + u[:, None] * (chosen[:, 1] - chosen[:, 0]) + v[:, None] * (chosen[:, 2] - chosen[:, 0])
        tree, triangles = igl.AABB(), triangles.astype(np.int64)
        tree.init(to, triangles)
        every = random.permutation(np.vstack([points[np.unique(faces)], inside]))
        end = time.perf_counter() + 2
        for some in np.array_split(every, 1000):
            worst = max(worst, float(tree.squared_distance(to, triangles, some)[0].max()) ** 0.5)
            if time.perf_counter() > end:
                break
    return worst


def main():
    side, job, threads, mesh, *rest = sys.argv[1:]
    if job == "count":
        out, count = rest
        answer = asked(side, threads, mesh, out, count=int(count), times=5)
        if answer["seconds"] is not None:
            answer.update(judge(mesh, out), sampled=sampled(mesh, out))
    elif job == "tolerance":
        out, length = rest
        answer = tolerance(side, threads, mesh, out, float(length))
    elif job == "chain":
        answer = chain(side, threads, mesh, *rest)
    else:
        sys.exit(f"no job is called {job}")
    print(json.dumps(answer))


main()
