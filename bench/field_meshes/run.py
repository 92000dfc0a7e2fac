"""Fields to triangles side by side with other programs; writes a section of RESULTS.md and out/field_meshes.csv.

Run by `make field-meshes`. Every run is a process of its own, held to as many processors as it may use threads.
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

OUT = BENCH / "out" / "field_meshes"
OURS = BENCH / "target" / "release" / "field_meshes"
THREADS = 2
MODELS = {
    "ball": "a ball", "torus": "a torus", "cube-ball": "a cube without a ball", "csg6": "CSG of 6 solids",
    "gyroid-ball": "a gyroid within a ball", "blobs": "100 smooth blobs",
}
#: Who is asked with which sizes: depths of an octree, or cells along a side.
PEERS = {"fidget": (5, 6, 7, 8), "sdf": (32, 64, 128), "manifold": (32, 64)}
NAMES = {"fidget": "fidget 0.5 (JIT, f32)", "sdf": "fogleman/sdf (sdf_fork)", "manifold": "Manifold.level_set"}
#: Models that are written for the peers in Python.
PYTHON = ("ball", "torus", "cube-ball", "gyroid-ball")
#: Shares of a peer's error that Chordal is asked for until its own measured error is no larger.
SHARES = (2.0, 1.6, 1.3, 1.0, 0.8)
ABOUT = """
Six fields in a box of side 2.5 to triangles, on two threads. Each peer is run at some sizes (depths of an octree, or cells
along a side) and its mesh measured: points of the surface (crossings of a lattice of 160 steps, by halving) to the
mesh, and points of the triangles along the gradient to the surface; the larger of both is its *error*. Beside sharp edges the
way along the gradient is longer than the distance, so that there errors of all are overstated, also beyond what is proved. Chordal is then
asked for a length at which its own error, measured alike, is no larger: the row holds its time with the proof and all
trials, its triangles, and its proved bound. Errors have units of the model. Callbacks of Manifold are
Python functions, asked point by point, which is most of its time.
""".strip()


def ask(command, threads=THREADS, limit=600):
    """The line of JSON that a program prints, or nothing where it does not come in time."""
    cores = ",".join(str(i) for i in range(threads))
    environment = {**os.environ, "RAYON_NUM_THREADS": str(threads)}
    try:
        done = subprocess.run(["taskset", "-c", cores, *command], env=environment, capture_output=True, text=True, timeout=limit)
        return json.loads(done.stdout.strip().split("\n")[-1])
    except (subprocess.TimeoutExpired, json.JSONDecodeError):
        return {"seconds": None, "triangles": None}


def judge(model, path):
    """The measured error of a mesh, and whether it is closed and manifold."""
    return ask([str(OURS), "judge", model, path], 2)


def equal(model, error):
    """Chordal at an error that is no larger; the last try where none is."""
    path = str(OUT / "ours.mesh")
    tried = None
    for share in SHARES:
        got = ask([str(OURS), "ours", model, str(THREADS), str(share * error), path])
        if got["triangles"] is None:
            tried = tried or got
            continue
        got.update(judge(model, path))
        tried = got
        if got["error"] <= error:
            break
    return tried


def shown(value, form):
    """A number, or a dash."""
    return "–" if value is None else format(value, form)


def main():
    """Runs everything and writes the table."""
    OUT.mkdir(parents=True, exist_ok=True)
    head = "| model | program | size | ms | triangles | error | closed, manifold | Chordal ms | triangles | error | proved | its time / Chordal's |"
    text, rows = [ABOUT, "", head, "|" + "---|" * 12], []
    for model, title in MODELS.items():
        for who, sizes in PEERS.items():
            if who != "fidget" and model not in PYTHON:
                continue
            for size in sizes:
                path = str(OUT / "peer.mesh")
                program = [str(OURS), who] if who == "fidget" else [sys.executable, str(HERE / "peers.py"), who]
                peer = ask([*program, model, str(THREADS), str(size), path])
                if peer["triangles"] is None:
                    print(model, who, size, "no answer", flush=True)
                    continue
                peer.update(judge(model, path))
                mine = equal(model, peer["error"])
                if mine["triangles"] is None:
                    print(model, who, size, mine, flush=True)
                ratio = peer["seconds"] / mine["seconds"] if mine["triangles"] else None
                sound = ", ".join("yes" if peer[key] else "no" for key in ("closed", "manifold"))
                cells = [
                    title, NAMES[who], str(size), f"{1e3 * peer['seconds']:.0f}", f"{peer['triangles']:,}", f"{peer['error']:.1e}", sound,
                    shown(mine["seconds"] and 1e3 * mine["seconds"], ".0f"), shown(mine["triangles"], ",d"),
                    shown(mine.get("error"), ".1e"), shown(mine.get("most"), ".1e"), shown(ratio, ".2f"),
                ]
                rows.append(cells)
                text.append(f"| {' | '.join(cells)} |")
                print(*cells, flush=True)
    with open(BENCH / "out" / "field_meshes.csv", "w", newline="") as file:
        csv.writer(file).writerows(rows)
    text += ["", f"Measured on {section.machine()}."]
    section.put("Fields to triangles, against fidget, sdf and Manifold", "\n".join(text))


main()
