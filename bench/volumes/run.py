"""Volumes to triangles side by side with other programs; writes a section of RESULTS.md and out/volumes.csv.

Run by `make volumes`. Every run is a process of its own, held to as many processors as it may use threads; reading is not
counted.
"""

import csv
import json
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
BENCH = HERE.parent
sys.path.insert(0, str(BENCH))
import section  # noqa: E402

OUT = BENCH / "out" / "volumes"
OURS = BENCH / "target" / "release" / "volumes"
NAMES = {
    "f64": "Chordal, f64", "f32": "Chordal, f32", "bound": "Chordal, f64 with its bound", "nets": "fast-surface-nets",
    "vtk": "VTK FlyingEdges3D (SMP backend STDThread)", "skimage": "scikit-image (Lewiner)", "mcubes": "PyMCubes",
}
RUNS = [
    ("f64", 1), ("f32", 1), ("bound", 1), ("vtk", 1), ("nets", 1), ("skimage", 1), ("mcubes", 1),
    ("f64", 2), ("f32", 2), ("bound", 2), ("vtk", 2),
]
ABOUT = """
The job: a gyroid of 256³ samples of f32, four periods a side, to indexed triangles at level 0, open at the border, without
normals. Medians of 9 runs (scikit-image and PyMCubes: 3), each program in a process of its own that is held to as many
processors as it has threads. Chordal's topology is the same for all samples of the same signs, ties included. fast-surface-nets
makes another surface (a vertex a cell) in f32, with normals. Times *with its bound* include the proof of the distance
to the trilinear interpolant, which no other has.
""".strip()


def ask(who, threads, n):
    """The line of JSON that a program prints."""
    path = str(OUT / f"gyroid-{n}.raw")
    ours = who in ("f64", "f32", "bound", "nets", "ties")
    program = [str(OURS)] if ours else [sys.executable, str(HERE / "peers.py")]
    command = ["taskset", "-c", ",".join(str(i) for i in range(threads)), *program, who, str(threads), path, str(n)]
    done = subprocess.run(command, check=True, capture_output=True, text=True, timeout=600)
    return json.loads(done.stdout.strip().split("\n")[-1])


def main():
    """Runs everything and writes the table."""
    OUT.mkdir(parents=True, exist_ok=True)
    for n in (100, 256, 512):
        if not (OUT / f"gyroid-{n}.raw").exists():
            subprocess.run([OURS, "make", str(OUT / f"gyroid-{n}.raw"), str(n)], check=True)
    rows = [(who, threads, ask(who, threads, 256)) for who, threads in RUNS]
    vtk = {threads: got["seconds"] for who, threads, got in rows if who == "vtk"}
    text = [ABOUT, "", "| program | threads | ms | triangles | M triangles/s | VTK's time / it |", "|---|---|---|---|---|---|"]
    for who, threads, got in rows:
        speed = got["triangles"] / got["seconds"] / 1e6
        ratio = vtk[threads] / got["seconds"]
        text.append(f"| {NAMES[who]} | {threads} | {1e3 * got['seconds']:.1f} | {got['triangles']:,} | {speed:.1f} | {ratio:.2f} |")
    bound = next(got["bound"] for who, _, got in rows if who == "bound")
    text += ["", f"The bound of this mesh is {bound:.2e} steps of the lattice, proved."]
    ties = [(name, ask(who, 1, 100)) for who, name in
            (("ties", "Chordal"), ("ties-skimage", NAMES["skimage"]), ("ties-mcubes", NAMES["mcubes"]))]
    text += ["", "Ties: the gyroid of 100³ samples rounded to tenths, closed at the border. Edges with one face:"]
    text += [f"{name} {got['open']:,} (of {got['triangles']:,} triangles)," for name, got in ties]
    text[-1] = text[-1][:-1] + "."
    big = ask("f64", 2, 512)
    # Volume, and 24 bytes a vertex (half as many as triangles) and 12 a triangle.
    needed = 4 * 512**3 + 24 * big["triangles"] // 2 + 12 * big["triangles"]
    text += ["", f"512³: {big['triangles']:,} triangles in {big['seconds']:.2f} s on 2 threads; the process peaks at "
             f"{big['peak'] / 2**20:,.0f} MiB, reading of the file included, {big['peak'] / needed:.2f} × the bytes of volume and output."]
    text.append(f"Measured on {section.machine()}.")
    with open(BENCH / "out" / "volumes.csv", "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["program", "threads", "seconds", "triangles"])
        writer.writerows([who, threads, got["seconds"], got["triangles"]] for who, threads, got in rows)
    section.put("Volumes to triangles, against VTK, scikit-image, PyMCubes and fast-surface-nets", "\n".join(text))


main()
