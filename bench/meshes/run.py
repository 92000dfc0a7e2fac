"""Meshes side by side with other programs; writes a section of RESULTS.md and out/meshes.csv.

Run by `make meshes`. Every job is a process of its own, held to as many processors as it may use threads; reading and
the making of each side's own data structures are not counted, except where they are the job.
"""

import csv
import json
import os
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
BENCH = HERE.parent
sys.path.insert(0, str(BENCH))
import section  # noqa: E402

OUT = BENCH / "out" / "meshes"
OURS = BENCH / "target" / "release" / "meshes"
#: What is asked, of which meshes, and who else is asked.
JOBS = [
    ("whole", "weld + normals + validity, 1 M triangles as a soup", ["million-soup"], ["vtk", "trimesh", "open3d"]),
    ("weld", "weld alone: 3 M corners", ["million-soup"], ["vtk"]),
    ("normals", "smooth normals, 1 M triangles", ["million"], []),
    ("validity", "validity, 1 M triangles", ["million"], []),
    ("self", "self-intersections, 980 k triangles that cross along a curve", ["crossing"], ["meshlib", "pymeshlab"]),
    ("tree", "the tree of boxes, 1 M triangles", ["million"], []),
    ("closest", "200 k nearest points in the box around 1 M triangles", ["million"], ["open3d", "igl", "meshlib", "vtk"]),
    ("rays-coherent", "1024 x 1024 rays of a camera on 1 M triangles", ["million"], ["embree", "open3d"]),
    ("rays-random", "524,288 random rays on 1 M triangles", ["million"], ["embree", "open3d"]),
    ("deviation", "distance, 160 k against 16 k triangles", ["fine", "coarse"], ["pymeshlab", "meshlib", "igl"]),
    ("deviation-1%", "the same to 1 %", ["fine", "coarse"], []),
    ("within", "whether it is at most 0.01", ["fine", "coarse"], []),
    ("deviation", "distance, 160 k against 160 k, turned by a third of a per mille", ["fine", "turned"], ["pymeshlab"]),
    ("deviation", "distance, 160 k against 160 k with noise", ["fine", "rough"], ["pymeshlab"]),
    ("deviation", "distance, 160 k against 160 k, shifted", ["fine", "shifted"], ["pymeshlab"]),
]
NAMES = {
    "ours": "Chordal", "vtk": "VTK", "trimesh": "trimesh", "open3d": "Open3D", "meshlib": "MeshLib",
    "pymeshlab": "pymeshlab", "igl": "libigl", "embree": "Embree (embreex)",
}


def ask(who, job, threads, meshes):
    """The line of JSON that a program prints, or an empty answer where it does not come in ten minutes."""
    paths = [str(OUT / f"{mesh}.mesh") for mesh in meshes]
    program = [str(OURS)] if who == "ours" else [sys.executable, str(HERE / "peers.py"), who]
    cores = ",".join(str(i) for i in range(threads))
    environment = {**os.environ, "OMP_NUM_THREADS": str(threads), "VTK_SMP_BACKEND_IN_USE": "STDThread"}
    command = ["taskset", "-c", cores, *program, job, str(threads), *paths]
    try:
        done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=600)
        return json.loads(done.stdout.strip().split("\n")[-1])
    except (subprocess.TimeoutExpired, json.JSONDecodeError):
        return {"seconds": None, "found": None}


def said(seconds):
    """A time in three digits."""
    if seconds is None:
        return "none"
    return f"{seconds:.3g} s" if seconds >= 1 else f"{1000 * seconds:.3g} ms"


def found(value):
    """What was found, in short."""
    if isinstance(value, list):
        return ", ".join(found(x) for x in value)
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def main():
    subprocess.run([OURS, "make", OUT], check=True)
    rows, text = [], [ABOUT, ""]
    for job, title, meshes, peers in JOBS:
        text += [f"### {title}", "", "| program | 1 thread | 2 threads | found |", "|---|---|---|---|"]
        for who in ["ours", *peers]:
            answers = {threads: ask(who, job, threads, meshes) for threads in (1, 2)}
            for threads, answer in answers.items():
                rows.append([title, NAMES[who], threads, answer["seconds"], found(answer["found"])])
            times = [said(answers[threads]["seconds"]) for threads in (1, 2)]
            text.append(f"| {NAMES[who]} | {times[0]} | {times[1]} | {found(answers[1]['found'])} |")
            print(title, NAMES[who], times, flush=True)
        text.append("")
    with open(BENCH / "out" / "meshes.csv", "w", newline="") as file:
        csv.writer(file).writerows([["job", "program", "threads", "seconds", "found"], *rows])
    text.append(f"Measured on {section.machine()}.")
    section.put("Meshes, against VTK, trimesh, Open3D, MeshLib, pymeshlab, libigl and Embree", "\n".join(text))


ABOUT = """
Medians of three or five runs; each program in a process of its own, held to one processor or two. Inputs are bumpy tori
that the bench makes. Distances: Chordal's are both ends of a proved interval, to 10 % unless said; pymeshlab samples
2,000,000 points of each surface and gives the largest distance that it met; MeshLib and libigl look at the vertices
alone. Nearest points of MeshLib and VTK are asked one by one from Python, for a tenth of the points, times ten; those
of trimesh are left out, since it takes minutes. MeshLib keeps the
tree that its first run made, so its medians are without it; Chordal's self-intersections build theirs each time, the
row "tree".
""".strip()

main()
