"""Fewer triangles, side by side with other programs; writes a section of RESULTS.md and out/simplify_*.csv.

Run by `make simplify`, which keeps to the inputs of USUAL. `run.py --only torus,lobes` looks at these, `run.py --only all` at every one there
is, and both write out/simplify.md instead. `run.py --jobs tolerance` measures that alone; the other tables are those of their last run. Every job is a
process of its own, held to as many processors as it may use threads.
"""

import argparse
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
from distances import measured, table_of_distances  # noqa: E402
from meshfile import foreign, read, write  # noqa: E402

OUT = BENCH / "out" / "simplify"
PROGRAM = Path(os.environ.get("CARGO_TARGET_DIR", BENCH / "target")) / "release" / "simplify"
DATA = Path(os.environ.get("CHORDAL_DATA", BENCH.parent.parent / "shared" / "data")) / "mesh"
#: What the program makes, and what it is.
MADE = {
    "torus": "a torus", "bumpy": "a torus with bumps", "sphere": "a sphere", "lobes": "four balls as one, creases across the triangles",
    "gear": "an extruded gear wheel, creases along edges", "shaft": "a turned part, long thin triangles",
    "plate": "a plate with 24 holes, long thin triangles", "tray": "a tray with walls of 0.002",
    "heights": "hills with noise, open",
}
#: What is looked at where the folder of data is there.
FOUND = {
    "bunny": "bunny/testdata/bun_zipper.ply", "spot": "odedstein/objects/spot/spot.obj", "fandisk": "common/data/fandisk.obj",
    "camelhead": "libigl/camelhead.off", "lion": "libigl/lion.off", "fertility": "libigl/fertility.off",
    "beetle": "common/data/beetle-alt.obj", "boot": "odedstein/objects/boot/boot.obj",
}
NAMES = {
    "ours": "Chordal", "meshopt": "meshoptimizer", "meshopt-update": "meshoptimizer, with update", "vtk": "VTK quadric",
    "fast": "fast-simplification", "open3d": "Open3D", "meshlib": "MeshLib",
}
#: What a usual run looks at, an hour and a half of it; all inputs take a day.
USUAL = ("torus", "bumpy", "lobes", "gear", "tray", "bunny", "fandisk", "fertility")
#: Shares that are kept, and shares of the diagonal that may be lost.
SHARES, TOLERANCES = (0.1, 0.01), (1e-3, 1e-2)
#: Inputs too large or too slow for a search: a trial of the slow ones takes half a minute.
NO_SEARCH = ("heights", "bumpy", "fertility", "tray")
ABOUT = """
*off* is the true two-sided Hausdorff distance in shares of the diagonal of the input's box: the upper end of
`check::deviation` to a hundredth, the same for all, proved from both sides; where 200,000 random points and all vertices,
compared by libigl, find more than that, a row says so. Times are medians of five runs in memory (of three, where one takes ten seconds), of
the call alone: conversions to and from each side's own data structures are not counted, nor is the reading. meshoptimizer
1.3 is asked through the crate meshopt 0.7, with all errors as lengths; *with update* is `meshopt_simplifyWithUpdate`, which moves vertices. CGAL's
wheel on PyPI has no simplification, so it is left out. All coordinates are such as f32 holds.
""".strip()


def ask(side, job, threads, *words, limit=3600):
    """The line of JSON of one side, or an empty one with the reason."""
    cores = ",".join(str(i) for i in range(threads))
    environment = {**os.environ, "OMP_NUM_THREADS": str(threads)}
    command = ["taskset", "-c", cores, sys.executable, str(HERE / "peers.py"), side, job, str(threads), *map(str, words)]
    try:
        done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=limit)
        return json.loads(done.stdout.strip().split("\n")[-1])
    except subprocess.TimeoutExpired:
        return {"seconds": None, "why": "more than an hour"}
    except json.JSONDecodeError:
        return {"seconds": None, "why": (done.stderr.strip().split("\n") or [""])[-1][:80] or f"exit code {done.returncode}"}


def diagonal(name):
    """The diagonal of the box of the vertices that faces name."""
    points, faces = read(OUT / f"{name}.mesh")
    used = points[faces.ravel()]
    return float(((used.max(0) - used.min(0)) ** 2).sum() ** 0.5)


def share(value, whole):
    return "–" if value is None else f"{value / whole:.2e}"


def ratio(true, declared):
    """How many times what is declared the truth is."""
    if true is None or declared is None:
        return "–"
    return f"{true / declared:.2f}" if declared > 0 else "∞" if true > 0 else "0 of 0"


def said(seconds):
    """A time in three digits."""
    return "–" if seconds is None else f"{seconds:.3g} s" if seconds >= 1 else f"{1000 * seconds:.3g} ms"


def kept(found):
    """Whether what was closed, manifold and oriented still is, and of the same topology."""
    if "manifold" not in found:
        return "–"
    lost = [f"not {word}" for word in ("manifold", "closed", "oriented") if found[f"was_{word}"] and not found[word]]
    if found["was_manifold"] and found["manifold"] and found["euler"] != found["was_euler"]:
        lost.append(f"Euler number {found['was_euler']} → {found['euler']}")
    if found["bad_edges"] + found["bad_vertices"] and found["was_manifold"]:
        lost.append(f"{found['bad_edges']} edges, {found['bad_vertices']} vertices")
    if found["zero_area"]:
        lost.append(f"{found['zero_area']} without area")
    return ", ".join(lost) or "yes"


def save(name, rows):
    keys = list(dict.fromkeys(key for row in rows for key in row))
    with open(BENCH / "out" / f"simplify_{name}.csv", "w", newline="") as file:
        table = csv.DictWriter(file, keys)
        table.writeheader()
        table.writerows(rows)


def saved(name):
    """The rows of the last run of a job; none where there was none."""
    path = BENCH / "out" / f"simplify_{name}.csv"
    if not path.exists():
        return []
    with open(path, newline="") as file:
        return [{key: value_of(text) for key, text in row.items()} for row in csv.DictReader(file)]


def value_of(text):
    """What a cell of CSV was."""
    words = {"": None, "True": True, "False": False}
    if text in words:
        return words[text]
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            pass
    return json.loads(text.replace("'", '"')) if text.startswith("[") else text


def count(inputs):
    """To a share of the triangles."""
    rows = []
    for name in inputs:
        whole, n = diagonal(name), len(read(OUT / f"{name}.mesh")[1])
        for part in SHARES:
            for side in NAMES:
                got = ask(side, "count", 1, OUT / f"{name}.mesh", OUT / "count.mesh", round(part * n))
                two = ask(side, "count", 2, OUT / f"{name}.mesh", OUT / "count.mesh", round(part * n)) if side == "ours" else {}
                got["two_threads"] = two.get("seconds")
                rows.append({"input": name, "n": n, "share": part, "side": side, "diagonal": whole, **got})
                print(name, part, NAMES[side], said(got["seconds"]), got.get("triangles"), share(got.get("at_most"), whole), flush=True)
    save("count", rows)


def table_of_count(rows):
    text = ["### To a count", "", "| input | to | program | 1 thread | 2 threads | triangles | off | × VTK's | kept |",
            "|---|---|---|---|---|---|---|---|---|"]
    vtk = {(row["input"], row["share"]): row.get("at_most") for row in rows if row["side"] == "vtk"}
    for row in rows:
        head = f"| {row['input']} ({row['n']:,}) | {row['share']:.0%} | {NAMES[row['side']]} |"
        if row["seconds"] is None:
            text.append(f"{head} {row['why']} | | | | | |")
            continue
        whole, off, quality, times = row["diagonal"], row["at_most"], vtk.get((row["input"], row["share"])), "–"
        # Below a millionth of a millionth all are exact, and their ratio is one of roundings (chosen).
        if off is not None and quality is not None and quality > 1e-12 * whole:
            times = f"{off / quality:.2f}"
        more = ", a sample is farther" if off is not None and row["sampled"] > off * (1 + 1e-9) + 1e-9 * whole else ""
        text.append(f"{head} {said(row['seconds'])} | {said(row['two_threads'])} | {row['triangles']:,} | "
                    f"{share(off, whole)}{more} | {times} | {kept(row)} |")
    return text


def tolerance(inputs):
    """To a length."""
    rows = []
    for name in (name for name in inputs if name not in NO_SEARCH):
        whole = diagonal(name)
        for part in TOLERANCES:
            length = part * whole
            for side in NAMES:
                got = ask(side, "tolerance", 2, OUT / f"{name}.mesh", OUT / f"{name}-{part}-{side}.mesh", length)
                row = {"input": name, "tolerance": part, "length": length, "side": side, "why": got.get("why")}
                for which in ("plain", "best"):
                    row.update({f"{which}_{key}": value for key, value in (got.get(which) or {}).items()})
                rows.append(row)
                print(name, part, NAMES[side], row.get("plain_triangles"), row.get("best_triangles"), flush=True)
    save("tolerance", rows)


def table_of_tolerance(rows):
    text = ["### To a tolerance", "", SEARCHED, "",
            "| input | tolerance | program | asked for it: triangles | true / tolerance | true / declared | seconds "
            "| fewest within it | true / tolerance | true / declared | kept |", "|---|---|---|---|---|---|---|---|---|---|---|"]
    for row in rows:
        cells = []
        for which in ("plain", "best"):
            one = {key.removeprefix(which + "_"): value for key, value in row.items() if key.startswith(which + "_")}
            true, triangles = one.get("at_most"), one.get("triangles")
            cells.append(f"{triangles:,}" if triangles else "–")
            cells.append(f"{true / row['length']:.2f}" if true is not None else "–")
            # From below, so that what is called too small a declaration is one.
            cells.append(ratio(one.get("at_least"), one.get("declared")))
            if which == "plain":
                cells.append(said(one.get("seconds")))
        if row.get("why"):
            cells[0] = row["why"]
        text.append(f"| {row['input']} | {row['tolerance']:.2%} | {NAMES[row['side']]} | {' | '.join(cells)} | "
                    f"{kept({key.removeprefix('best_'): value for key, value in row.items() if value is not None})} |")
    return text


def chain(_):
    """All levels of a mesh of a million triangles."""
    rows = []
    asked = [("ours", "errors", 1), ("ours", "errors", 2), ("ours", "source", 1), ("ours", "source", 2), ("meshopt", "source", 1), ("meshopt-update", "source", 1)]
    asked += [(side, "last", 1) for side in NAMES if side != "ours"]
    for side, start, threads in asked:
        got = ask(side, "chain", threads, OUT / "million.mesh", start)
        rows.append({"side": side, "from": start, "threads": threads, **got})
        print(NAMES[side], start, got, flush=True)
    save("chain", rows)


def table_of_chain(rows):
    text = ["### A chain", "", CHAINED, "", "| program | each level from | threads | time | peak | input and output | × | levels |",
            "|---|---|---|---|---|---|---|---|"]
    for row in rows:
        head = f"| {NAMES[row['side']]} | {row['from']} | {row['threads']} |"
        if row["seconds"] is None:
            text.append(f"{head} {row['why']} | | | | |")
            continue
        text.append(f"{head} {said(row['seconds'])} | {row['peak'] / 2**20:.0f} MiB | {row['bytes'] / 2**20:.0f} MiB | "
                    f"{row['peak'] / row['bytes']:.1f} | {len(row['triangles'])} |")
    return text


def distances(_):
    save("distances", measured(ask, NAMES, OUT))


SEARCHED = """
Left: the program is given the tolerance. Right: its settings (an error, and a count) are searched until its triangles are
the fewest whose true distance is proved to be within the tolerance, to 2.3 % of the setting. *declared* is the error that it
says itself; above 1, more is lost than it says. VTK, fast-simplification and Open3D take no length and say none.
""".strip()
CHAINED = """
A bumpy torus of 1,000,000 triangles in levels of half the triangles each, down to 1,000; Chordal's `chain`, from *errors*, has levels each
twice as far off, from the error of half the triangles on. All of Chordal's are proved to be within a bound, and that is in the time. *peak* is what the process grew by, and the mesh
itself; input and output are counted at 24 bytes a vertex and 12 a triangle. Copies that the conversion into a program's own structures makes are in
it.
""".strip()


#: What is measured, and how its rows become a table.
JOBS = {
    "count": (count, table_of_count), "chain": (chain, table_of_chain),
    "tolerance": (tolerance, table_of_tolerance), "distances": (distances, table_of_distances),
}


def publish(only):
    """Writes what the last run of each job found."""
    text = [ABOUT, "", "Inputs that are made here: " + "; ".join(f"`{name}`, {what}" for name, what in MADE.items()) + ".", ""]
    for job, (_, table) in JOBS.items():
        if rows := saved(job):
            text += [*table(rows), ""]
    text.append(f"Measured on {section.machine()}.")
    if only:
        (BENCH / "out" / "simplify.md").write_text("\n".join(text) + "\n")
    else:
        section.put("Fewer triangles, against meshoptimizer, VTK, fast-simplification, Open3D and MeshLib", "\n".join(text))


def main():
    words = argparse.ArgumentParser()
    words.add_argument("--only", type=lambda text: text.split(","))
    words.add_argument("--jobs", type=lambda text: text.split(","), default=list(JOBS))
    given = words.parse_args()
    OUT.mkdir(parents=True, exist_ok=True)
    subprocess.run([PROGRAM, "make", OUT], check=True)
    inputs = list(MADE)
    for name, path in FOUND.items():
        if (DATA / path).exists():
            write(OUT / f"{name}.mesh", *foreign(DATA / path))
            inputs.append(name)
        else:
            print(f"{name}: left out, because there is no {DATA / path}")
    if given.only != ["all"]:
        inputs = [name for name in inputs if name in (given.only or USUAL)]
    for job in given.jobs:
        JOBS[job][0](inputs)
    publish(given.only)


main()
