"""Files read and written side by side with other programs; writes a section of RESULTS.md and out/files-speed.csv.

Run by `make files-speed`. Every job is a process of its own, held to as many processors as it may use threads. The time is
that from bytes in memory (Chordal and crates) or a file that the system has in memory (the others) to arrays, and back.
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

OUT = BENCH / "out" / "file_speed"
OURS = Path(os.environ.get("CARGO_TARGET_DIR", BENCH / "target")) / "release" / "file_speed"
#: The crates that the program of the bench has beside Chordal; they only read.
CRATES = ["tobj", "stl_io", "gltf"]
#: The file, what it is called, and who else reads and writes it.
JOBS = [
    ("mesh.obj", "OBJ", ["tobj", "tinyobjloader", "open3d", "vtk", "trimesh", "meshio"]),
    ("mesh.ply", "PLY, binary", ["open3d", "vtk", "trimesh", "meshio"]),
    ("text.ply", "PLY, text", ["open3d", "vtk", "trimesh", "meshio"]),
    ("mesh.stl", "STL, binary", ["stl_io", "open3d", "vtk", "trimesh", "meshio"]),
    ("text.stl", "STL, text", ["stl_io", "open3d", "vtk", "trimesh", "meshio"]),
    ("mesh.glb", "GLB", ["gltf", "open3d", "trimesh"]),
    ("mesh.gltf", "glTF with a .bin", ["gltf", "open3d", "trimesh"]),
    ("mesh.off", "OFF", ["open3d", "trimesh", "meshio"]),
    ("mesh.3mf", "3MF", ["trimesh"]),
    ("mesh.vtp", "VTP", ["vtk"]),
]
NAMES = {
    "ours": "Chordal", "vtk": "VTK", "open3d": "Open3D", "gltf": "crate gltf", "tobj": "crate tobj",
    "stl_io": "crate stl_io",
}
TRIANGLES = 1_000_000
#: What a program does not write, or writes as something else.
NOT_WRITTEN = {"tinyobjloader"}
#: Chordal reads them only.
ONLY_READ = {"text.ply", "text.stl"}


def ask(who, verb, threads, name):
    """What a program prints, or nothing where it fails or takes more than two minutes."""
    if who in ("ours", *CRATES):
        command = [str(OURS), verb, who, str(threads), str(OUT / name)]
    else:
        command = [sys.executable, str(HERE / "peers.py"), who, verb, str(threads), str(OUT / name)]
    cores = ",".join(str(i) for i in range(threads))
    try:
        done = subprocess.run(
            ["taskset", "-c", cores, *command], capture_output=True, text=True, timeout=120,
            env={**os.environ, "OMP_NUM_THREADS": str(threads)},
        )
        return json.loads(done.stdout.strip().split("\n")[-1])
    except (subprocess.TimeoutExpired, json.JSONDecodeError):
        return None


def speed(answer):
    """MB/s; nothing where not all triangles came."""
    if answer is None or answer["triangles"] != TRIANGLES:
        return "none"
    rate = answer["bytes"] / 1e6 / answer["seconds"]
    return f"{rate:.0f}" if rate >= 10 else f"{rate:.1f}"


def main():
    only = sys.argv[1:]
    OUT.mkdir(parents=True, exist_ok=True)
    subprocess.run([OURS, "make", OUT], check=True)
    rows, text = [], [ABOUT, ""]
    text += ["| file | MB | program | read | write |"]
    text += ["|---|---|---|---|---|"]
    for name, title, peers in JOBS:
        if only and name not in only:
            continue
        megabytes = f"{(OUT / name).stat().st_size / 1e6:.0f}"
        for who, threads in [("ours", 1), ("ours", 2), *((peer, 2) for peer in peers)]:
            is_skipped = who in CRATES or who in NOT_WRITTEN or (who == "ours" and name in ONLY_READ)
            said = {}
            for verb in ("read", "write"):
                if verb == "write" and is_skipped:
                    said[verb] = ""
                    continue
                answer = ask(who, verb, threads, name)
                said[verb] = speed(answer)
                if answer:
                    rows.append([title, NAMES.get(who, who), verb, threads, *answer.values()])
            called = f"Chordal, {threads} thread{'s' if threads > 1 else ''}" if who == "ours" else NAMES.get(who, who)
            cells = " | ".join(said.values())
            text.append(f"| {title} | {megabytes} | {called} | {cells} |")
            print(title, called, cells, flush=True)
    with open(BENCH / "out" / "files-speed.csv", "w", newline="") as file:
        head = ["file", "program", "verb", "threads", "seconds", "bytes", "triangles"]
        csv.writer(file).writerows([head, *rows])
    if not only:
        text.append(f"\nMeasured on {section.machine()}.")
        section.put("Files read and written, against other programs and crates", "\n".join(text))


ABOUT = """
MB/s of the file that is read or written, the best of five times (of fewer where these took ten seconds), since other work
on the machine only adds to a time; each program in a process of its own that may use two processors, Chordal also on one.
The mesh is a bumpy torus of 1,000,000 triangles and 500,000 vertices with normals and texture coordinates, whose
numbers are those of single precision; where a format has no place for them, they are not in the file. Chordal's reading
includes what it says of every file: bounds, flat and repeated triangles, repeated vertices, unused rows; of STL also
which corners are one vertex, which of the others VTK, stl_io and Open3D find too, and trimesh and meshio as they are
asked here do not. trimesh is told not to process. VTK's OBJ and PLY readers keep what they know of normals and texture
coordinates. Programs in Python write to a disk of memory, Chordal to memory. Empty: not done by that program; `none`:
it failed, took more than two minutes, or did not find all triangles.
""".strip()

main()
