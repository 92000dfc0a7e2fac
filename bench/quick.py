"""The quick bench: the lines of the targets on a few inputs, both sides in one run, in ten minutes.

`quick.py [--strict] [--only JOB,...]` writes quick.json, and the tables in README.md and RESULTS.md. A peer that is not
there is SKIPPED, which counts as not kept. A missed target is shown; the exit status is 1 for it only with `--strict`.
With `--only` the lines of these jobs are replaced and the others kept: each line has the date and the load of its own.

Every ratio is ours over theirs, of times, of triangles or of segments, so that less is better; where there is no peer to
divide by, the limit is in the unit itself.
"""

import argparse
import csv
import json
import os
import subprocess
import sys
import time
from datetime import date
from pathlib import Path

import front_table
import section

BENCH = Path(__file__).resolve().parent
OUT = BENCH / "out" / "quick"
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", BENCH / "target")) / "release"
DATA = Path(os.environ.get("CHORDAL_DATA", BENCH.parent.parent / "shared" / "data"))
#: The Python of each job's peers: an environment of the Makefile.
PYTHON = {
    job: Path(os.environ.get(variable, BENCH / folder / "bin" / "python"))
    for job, variable, folder in (
        ("patches", "PEERS", ".venv"), ("meshes", "MESH_PEERS", ".venv-meshes"), ("volumes", "VOLUME_PEERS", ".venv-volumes"),
        ("baking", "BAKING_PEERS", ".venv-baking"),
    )
}
SYSTEM_PYTHON = Path("/usr/bin/python3")
PEER = {
    "occt": "OpenCASCADE", "kurbo": "kurbo", "lyon": "lyon_geom", "meshopt": "meshoptimizer", "earcut": "earcut", "osd": "OpenSubdiv",
    "vtk": "VTK", "vm": "fidget VM", "jit": "fidget JIT", "embree": "Embree", "meshlib": "MeshLib", "pymeshlab": "pymeshlab",
    "open3d": "Open3D", "openvdb": "OpenVDB",
}


class PeerMissing(Exception):
    """A peer cannot be had here; the message says why."""


def ask(command, threads=1, limit=240, cwd=None):
    """What a program prints, held to so many processors."""
    cores = ",".join(str(i) for i in range(threads))
    environment = {
        **os.environ, "OMP_NUM_THREADS": str(threads), "RAYON_NUM_THREADS": str(threads), "VTK_SMP_BACKEND_IN_USE": "STDThread",
    }
    words = ["taskset", "-c", cores, *map(str, command)]
    done = subprocess.run(words, env=environment, capture_output=True, text=True, timeout=limit, check=False, cwd=cwd)
    if done.returncode:
        raise RuntimeError((done.stderr.strip().split("\n") or [""])[-1][:200] or f"exit status {done.returncode}")
    return done.stdout


def ours(name, *words, threads=1):
    """What one of the bench's programs prints."""
    return ask([TARGET / name, *words], threads)


def ours_json(name, *words, threads=1):
    return json.loads(ours(name, *words, threads=threads).strip().split("\n")[-1])


def peer_python(job, *words, threads=1, cwd=None):
    """What a script prints in the environment of a job's peers."""
    if not PYTHON[job].exists():
        raise PeerMissing(f"no {PYTHON[job].parent.parent.name}")
    try:
        return ask([PYTHON[job], *words], threads, cwd=cwd)
    except RuntimeError as error:
        raise PeerMissing(str(error)) from error
    except subprocess.TimeoutExpired as error:
        raise PeerMissing("no answer in time") from error


def peer_json(job, *words, threads=1):
    found = json.loads(peer_python(job, *words, threads=threads).strip().split("\n")[-1])
    if found.get("seconds") is None:
        raise PeerMissing("no answer")
    return found


class Lines:
    """The lines of one job."""

    def __init__(self, job):
        self.job, self.all = job, []

    def add(self, what, peer, unit, mine, theirs, limit, *, proved):
        """A line whose ratio is at most a limit."""
        ratio = mine / theirs if theirs else mine
        self.put(what, peer, unit, mine, theirs, ratio, limit, proved, None)

    def absolute(self, what, peer, unit, mine, theirs, limit, *, proved):
        """A line whose own number is at most a limit; the peer's is shown."""
        self.put(what, peer, unit, mine, theirs, mine, limit, proved, None)

    def skip(self, what, peer, why, *, proved):
        self.put(what, peer, "–", None, None, None, None, proved, why)

    def fail(self, why):
        """The job ended early: that is not kept either."""
        self.put("the rest of the job", None, "–", None, None, None, None, False, f"did not end: {why}")

    def put(self, what, peer, unit, mine, theirs, ratio, limit, proved, why):
        passed = ratio is not None and ratio <= limit
        line = {
            "job": self.job, "what": what, "peer": PEER.get(peer, "–"), "unit": unit, "ours": mine, "theirs": theirs, "ratio": ratio,
            "limit": limit, "passed": passed, "proved": proved, "skipped": why, "load": round(os.getloadavg()[0], 1),
            "date": str(date.today()),
        }
        self.all.append(line)
        print(f"{self.job}: {what}, {line['peer']}: " + (f"SKIPPED: {why}" if why else
              f"{front_table.shown(mine)} against {front_table.shown(theirs)} {unit}, ratio {front_table.shown(ratio)}, "
              f"at most {front_table.shown(limit)}: {'kept' if passed else 'MISSED'}"), flush=True)


def patches(lines):
    """Bicubic patches to tolerance."""
    ask([sys.executable, BENCH / "patches" / "corpus.py"])
    script = (
        "import sys, occt\n"
        "for row in occt.run(sys.argv[1], sys.argv[2], 'wide', 1): print(*row, sep=',')"
    )
    for corpus, tolerance, more in (("teapot", "1e-3", 1.2), ("teapot", "1e-4", 1.05), ("hard", "1e-3", 1.2)):
        title = f"{corpus} to {tolerance}"
        mine = ours("patches", corpus, tolerance).strip().split(",")
        triangles, seconds = int(mine[3]), float(mine[4])
        engines = {"chordal": None}
        try:
            found = peer_python("patches", "-c", script, corpus, tolerance, cwd=BENCH / "patches")
            rows = [row.split(",") for row in found.split()]
            _, their_triangles, their_seconds, _ = next(row for row in rows if row[0] == "occt")
            engines["occt"] = None
            lines.add(f"{title}, CPU time", "occt", "s", seconds, float(their_seconds), 0.02, proved=True)
            lines.add(f"{title}, triangles", "occt", "triangles", triangles, int(their_triangles), more, proved=True)
        except PeerMissing as missing:
            lines.skip(f"{title}, CPU time", "occt", str(missing), proved=True)
            lines.skip(f"{title}, triangles", "occt", str(missing), proved=True)
        for row in csv.reader(ours("measure", corpus, tolerance, *engines, threads=2).splitlines()):
            if row[3] == "all":
                engines[row[2]] = int(row[6])
        lines.absolute(f"{title}, shapes over it", "occt", "shapes", engines["chordal"], engines.get("occt"), 0, proved=True)


def curves(lines):
    """Cubics to polylines."""
    for corpus in ("random", "hard"):
        rows = {row[2]: row for row in csv.reader(ours("curves", corpus, "1e-3", threads=2).splitlines())}
        own, even, kurbo, lyon = (rows[side] for side in ("chordal", "chordal-even", "kurbo", "lyon"))
        title = f"{corpus} cubics to 1e-3"
        lines.absolute(f"{title}, curves over it", "kurbo", "curves", int(own[6]) + int(even[6]), int(kurbo[6]), 0, proved=True)
        lines.add(f"{title}, segments where it keeps", "kurbo", "segments", int(own[5]), int(kurbo[5]), 1.0, proved=True)
        lines.add(f"{title}, one by one", "kurbo", "ns a curve", float(own[10]), float(kurbo[10]), 1.0, proved=True)
        lines.add(f"{title}, as one batch", "kurbo", "ns a curve", float(own[11]), float(kurbo[11]), 0.5, proved=True)
        lines.add(f"{title}, segments", "lyon", "segments", int(own[4]), int(lyon[4]), 0.55, proved=True)
        lines.add(f"{title}, equal steps, one by one", "lyon", "ns a curve", float(even[10]), float(lyon[10]), 1.0, proved=True)


def fewest(mesh, out, length, whole):
    """The fewest triangles of meshoptimizer whose true distance is within a length, by halving the span of counts, and its
    time for them."""
    low, high, best = 200, whole, None
    for _ in range(8):
        count = int((low * high) ** 0.5)
        got = ours_json("simplify", "run", "meshopt", 1, mesh, out, f"count={count}", 1)
        found = ours_json("simplify", "judge", mesh, out, repr(length), threads=2)["at_most"]
        if found is not None and found <= length:
            best, high = got, count
        else:
            low = count
    return best


def least_length(mesh, out, count, near):
    """The least length that leaves so many triangles, by halving the span around one that is near it."""
    low, high = near / 1.5, 1.1 * near
    for _ in range(6):
        length = (low * high) ** 0.5
        if ours_json("simplify", "run", "ours", 1, mesh, out, f"error={length!r}", 1)["triangles"] <= count:
            high = length
        else:
            low = length
    return high


def diagonal(path):
    """The diagonal of the box of a mesh that the bench wrote, all of whose vertices are used."""
    import array

    raw = path.read_bytes()
    n = int.from_bytes(raw[:4], "little")
    numbers = array.array("d", raw[8:8 + 24 * n])
    return sum((max(numbers[k::3]) - min(numbers[k::3])) ** 2 for k in range(3)) ** 0.5


def simplify(lines):
    """Fewer triangles."""
    folder = OUT / "simplify"
    ours("simplify", "make", folder)
    torus, gear, out = folder / "torus.mesh", folder / "gear.mesh", folder / "out.mesh"
    mine = {threads: ours_json("simplify", "run", "ours", threads, torus, out, "count=16000", 3, threads=threads) for threads in (1, 2)}
    off = ours_json("simplify", "judge", torus, out, threads=2)["at_most"]
    peer = ours_json("simplify", "run", "meshopt", 1, torus, out, "count=16000", 3)
    their_off = ours_json("simplify", "judge", torus, out, threads=2)["at_most"]
    title = "torus, 160k to 16k triangles"
    best = ours_json("simplify", "run", "ours", 1, torus, out, "best=16000", 3)
    best_off = ours_json("simplify", "judge", torus, out, threads=2)["at_most"]
    lines.add(f"{title}, the least work, 1 thread", "meshopt", "s", mine[1]["seconds"], peer["seconds"], 2.0, proved=True)
    lines.add(f"{title}, the least work, 2 threads", "meshopt", "s", mine[2]["seconds"], peer["seconds"], 1.2, proved=True)
    lines.add(f"{title}, the least work, true distance", "meshopt", "units", off, their_off, 1.0, proved=True)
    lines.absolute(f"{title}, seconds by default", "meshopt", "s", best["seconds"], peer["seconds"], 0.6, proved=True)
    lines.add(f"{title}, true distance by default", "meshopt", "units", best_off, their_off, 0.6, proved=True)
    over = best_off / least_length(torus, out, 16000, best_off)
    lines.absolute(f"{title}, true distance over that of a length", "meshopt", "×", over, None, 1.05, proved=True)
    length = 1e-3 * diagonal(torus)
    within = ours_json("simplify", "run", "ours", 1, torus, out, f"error={length!r}", 3)
    at_most = ours_json("simplify", "judge", torus, out, threads=2)["at_most"]
    best = fewest(torus, out, length, within["triangles"] * 16)
    title = "torus to 0.1 %"
    if best:
        lines.add(f"{title}, time for its best count", "meshopt", "s", within["seconds"], best["seconds"], 4.0, proved=True)
        lines.add(f"{title}, triangles", "meshopt", "triangles", within["triangles"], best["triangles"], 0.6, proved=True)
    lines.absolute(f"{title}, true distance over it", "meshopt", "× the tolerance", at_most / length, None, 1.0, proved=True)
    length = 1e-3 * diagonal(gear)
    flat = ours_json("simplify", "run", "ours", 1, gear, out, f"error={length!r}", 3)
    best = ours_json("simplify", "run", "meshopt", 1, gear, out, f"error={length!r}", 3)
    lines.absolute("flat gear to 0.1 %, seconds", "meshopt", "s", flat["seconds"], best["seconds"], 0.3, proved=True)


def polygons(lines):
    """Polygons to triangles."""
    folder = DATA / "polygon/earcut/test/fixtures"
    if not folder.is_dir():
        folder = OUT / "no-fixtures"
        folder.mkdir(parents=True, exist_ok=True)
    for name in ("400 holes: 45.6k", "star of 10k"):
        row = list(csv.reader(ours("polygons", folder, name).splitlines()))[1]
        lines.add(name, "earcut", "µs, CPU", float(row[3]), float(row[4]), 1.2, proved=True)


def subdivision(lines):
    """Cages to a level, and moved."""
    titles = ["torus of 20k to level 4, refined", "torus of 20k to level 4, table built", "torus of 20k to level 4, moved"]
    peer = BENCH / "out" / "opensubdiv"
    if not peer.exists():
        for title in titles:
            lines.skip(title, "osd", "no libosd-dev (Debian)", proved=False)
        return
    torus, points = OUT / "torus.obj", OUT / "points.bin"
    ours("subdivision", "make", torus)
    theirs = json.loads(ask([peer, torus, 4, 3, points]).strip().split("\n")[-1])
    mine = ours_json("subdivision", "run", torus, 4, 7, 1, points)
    whole = theirs["topology"] + theirs["positions_f32"]
    lines.add(titles[0], "osd", "s", mine["refine"], whole, 0.25, proved=False)
    lines.add(titles[1], "osd", "s", mine["build"], theirs["build"], 0.05, proved=False)
    lines.add(titles[2], "osd", "s", mine["apply_f32"], theirs["apply"], 1.0, proved=False)
    lines.absolute("torus of 20k to level 4, points apart", "osd", "of the diagonal", mine["off"], None, 1e-6, proved=False)


def volumes(lines):
    """Volumes to triangles."""
    path = OUT / "gyroid-256.raw"
    if not path.exists():
        ours("volumes", "make", path, 256)
    for threads in (1, 2):
        mine = {who: ours_json("volumes", who, threads, path, 256, threads=threads)["seconds"] for who in ("f64", "f32")}
        titles = {who: f"gyroid 256³, {who}, {threads} thread{'s' * (threads > 1)}" for who in mine}
        try:
            theirs = peer_json("volumes", BENCH / "volumes" / "peers.py", "vtk", threads, path, 256, threads=threads)["seconds"]
        except PeerMissing as missing:
            for title in titles.values():
                lines.skip(title, "vtk", str(missing), proved=False)
            continue
        for who, faster in (("f64", 1.2), ("f32", 1.5)):
            lines.add(titles[who], "vtk", "s", mine[who], theirs, 1 / faster, proved=False)
    small = OUT / "gyroid-100.raw"
    ours("volumes", "make", small, 100)
    ties = ours_json("volumes", "ties", 1, small, 100)
    lines.absolute("gyroid 100³ with samples at the isovalue, open edges", "vtk", "edges", ties["open"], None, 0, proved=True)


def fields(lines):
    """Fields evaluated."""
    nothing = OUT / "no-models"
    nothing.mkdir(parents=True, exist_ok=True)
    rows = {(row["model"], row["what"]): row for row in csv.DictReader(ours("fields", nothing).splitlines())}

    def time_of(model, what, side):
        return 1.0 / float(rows[model, what][side])

    cases = [
        ("CSG of 64 solids", "f32 points", "vm", 0.1, False), ("CSG of 64 solids", "f32 points", "jit", 1 / 0.6, False),
        ("two gyroids", "f32 points", "jit", 1 / 8, False),
        ("CSG of 64 solids", "ranges (f64 proved; theirs f32)", "vm", 0.5, True),
    ]
    for model, what, peer, limit, proved in cases:
        mine, theirs = time_of(model, what, "chordal"), time_of(model, what, f"fidget_{peer}")
        lines.add(f"{model}, {what}", peer, "µs each", mine, theirs, limit, proved=proved)


def field_meshes(lines):
    """Fields to triangles at equal measured error."""
    for model, depth in (("csg6", 6), ("gyroid-ball", 6), ("torus", 6)):
        theirs_at, mine_at = OUT / "fidget.mesh", OUT / "field.mesh"
        theirs = ours_json("field_meshes", "fidget", model, 2, depth, theirs_at, threads=2)
        error = ours_json("field_meshes", "judge", model, theirs_at, threads=2)["error"]
        mine = None
        for share in (2.0, 1.6, 1.3, 1.0, 0.8):
            tried = ours_json("field_meshes", "ours", model, 2, share * error, mine_at, threads=2)
            if tried["triangles"] is None:
                continue
            mine = {**tried, **ours_json("field_meshes", "judge", model, mine_at, threads=2)}
            if mine["error"] <= error:
                break
        if mine is None:
            raise RuntimeError(f"{model}: no mesh within {error}")
        title = f"{model} at the peer's error at octree depth {depth}"
        lines.add(f"{title}, time", "jit", "s", mine["seconds"], theirs["seconds"], 2.0, proved=True)
        lines.add(f"{title}, triangles", "jit", "triangles", mine["triangles"], theirs["triangles"], 0.5, proved=True)
        unsound = int(not mine["closed"]) + int(not mine["manifold"])
        lines.absolute(f"{title}, not closed or not manifold", "jit", "meshes", unsound, None, 0, proved=True)


def meshes(lines):
    """Weld, normals, validity, distance."""
    cases = [
        ("whole", "weld + normals + validity, 1 M triangles", "million-soup", "vtk", 0.2, True, 1),
        ("whole", "weld + normals + validity, 1 M triangles, 2 threads", "million-soup", "vtk", 0.2, True, 2),
        ("weld", "weld, 3 M corners", "million-soup", "vtk", 1.0, True, 1),
        ("self", "self-intersections, 980 k triangles, 2 threads", "crossing", "meshlib", 1.0, True, 2),
        ("deviation", "distance, 160 k against 16 k triangles, 2 threads", "fine coarse", "pymeshlab", 0.5, True, 2),
    ]
    on_meshes(lines, cases)


def rays(lines):
    """Rays on a million triangles."""
    cases = [
        ("rays-coherent", "a million rays of a camera on 1 M triangles", "million", "embree", 1 / 0.35, False, 1),
        ("rays-random", "half a million random rays on 1 M triangles", "million", "embree", 1 / 0.35, False, 1),
    ]
    on_meshes(lines, cases)


def on_meshes(lines, cases):
    """Jobs of the `meshes` program."""
    folder = OUT / "meshes"
    if not (folder / "shifted.mesh").exists():
        ours("meshes", "make", folder)
    for job, title, names, peer, limit, proved, threads in cases:
        paths = [folder / f"{name}.mesh" for name in names.split()]
        mine = ours_json("meshes", job, threads, *paths, threads=threads)
        try:
            theirs = peer_json("meshes", BENCH / "meshes" / "peers.py", peer, job, threads, *paths, threads=threads)
        except PeerMissing as missing:
            lines.skip(title, peer, str(missing), proved=proved)
            continue
        lines.add(title, peer, "s", mine["seconds"], theirs["seconds"], limit, proved=proved)
        if job == "deviation":
            # A sampled distance is low; ours holds the true one between its ends.
            low = max(0.0, theirs["found"] - mine["found"][1])
            lines.absolute(f"{title}, upper end below a sample", peer, "units", low, None, 0, proved=True)


def baking(lines):
    """Meshes to grids of distances."""
    mesh = OUT / "baking.mesh"
    ours("baking", "make", mesh)
    for what, peer, title, limit in (
        ("full", "open3d", "128³ of 102 k triangles, all samples, 2 threads", 0.05),
        ("band", "openvdb", "128³ of 102 k triangles, band of 3 cells, 2 threads", 1.0),
    ):
        grid = OUT / f"{what}.grid"
        mine = ours_json("baking", what, 2, mesh, grid, threads=2)
        words = [BENCH / "baking" / "peers.py", peer, 2, mesh, grid]
        try:
            if peer == "openvdb":
                theirs = openvdb(words)
            else:
                theirs = peer_json("baking", *words, threads=2)
        except PeerMissing as missing:
            lines.skip(title, peer, str(missing), proved=False)
            continue
        lines.add(title, peer, "s", mine["seconds"], theirs["seconds"], limit, proved=False)


def openvdb(words):
    """OpenVDB has no wheel: Debian's Python has it, or nobody."""
    try:
        return json.loads(ask([SYSTEM_PYTHON, *words], 2).strip().split("\n")[-1])
    except (RuntimeError, FileNotFoundError, json.JSONDecodeError) as error:
        raise PeerMissing(f"no python3-openvdb (Debian): {error}") from error


JOBS = {
    "patches to tolerance": patches, "curves to tolerance": curves, "fewer triangles": simplify, "polygons to triangles": polygons,
    "subdivision": subdivision, "volumes to triangles": volumes, "fields evaluated": fields, "fields to triangles": field_meshes,
    "mesh checks and distance": meshes, "rays": rays, "meshes to grids": baking,
}


def versions():
    """The versions of everything that took part, as locked."""
    lock, found = (BENCH / "Cargo.lock").read_text().split("[[package]]"), {}
    crates = {"chordal", "kurbo", "lyon_geom", "meshopt", "earcut", "fidget"}
    for package in lock:
        words = dict(line.split(" = ", 1) for line in package.strip().splitlines() if " = " in line)
        name = words.get("name", "").strip('"')
        if name in crates:
            found[name] = words["version"].strip('"')
    wanted = {"cadquery-ocp", "vtk", "embreex", "meshlib", "pymeshlab", "open3d"}
    for path in (BENCH / name / "requirements.txt" for name in ("patches", "meshes", "volumes", "baking")):
        pins = dict(line.split("==") for line in path.read_text().split())
        found.update({name: version for name, version in pins.items() if name in wanted})
    return dict(sorted(found.items()))


def main():
    """Runs all jobs, and writes what came of them."""
    words = argparse.ArgumentParser()
    words.add_argument("--strict", action="store_true", help="exit with 1 where a target is missed or a peer SKIPPED")
    words.add_argument("--only", type=lambda text: text.split(","), help="jobs, by their words in the table")
    given = words.parse_args()
    OUT.mkdir(parents=True, exist_ok=True)
    start = time.monotonic()
    found = []
    for job, run in JOBS.items():
        if given.only and job not in given.only:
            continue
        lines = Lines(job)
        try:
            run(lines)
        except (RuntimeError, OSError, subprocess.TimeoutExpired, ValueError, KeyError) as error:
            lines.fail(f"{type(error).__name__}: {error}"[:200])
        found += lines.all
        print(f"{job}: {time.monotonic() - start:.0f} s so far", flush=True)
    result = {
        "machine": {"cpu": section.cpu(), "cores": os.cpu_count()}, "seconds": round(time.monotonic() - start), "versions": versions(),
        "lines": found,
    }
    if given.only and front_table.RESULT.exists():
        before = json.loads(front_table.RESULT.read_text(encoding="utf-8"))["lines"]
        lines = found + [line for line in before if line["job"] not in given.only]
        order = list(JOBS)
        result["lines"] = sorted(lines, key=lambda line: order.index(line["job"]))
    text = json.dumps(result, indent=1, ensure_ascii=False)
    front_table.RESULT.write_text(text + "\n", encoding="utf-8")
    front_table.render()
    skipped = sum(bool(line["skipped"]) for line in found)
    missed = sum(not line["passed"] for line in found) - skipped
    print(f"{len(found)} lines: {len(found) - missed - skipped} kept, {missed} MISSED, {skipped} SKIPPED, in {result['seconds']} s")
    if given.strict and missed + skipped:
        sys.exit(1)


if __name__ == "__main__":
    main()
