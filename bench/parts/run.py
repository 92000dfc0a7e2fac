"""The everyday parts of tests/parts side by side with Manifold; writes out/parts.json, and with --results a section of RESULTS.md.

    run.py --command ../target/release/chordal             every part that Manifold can make by language.py
    run.py --command ../target/release/chordal bowl mug    some of them

Run by `make parts`, on one processor.
"""

import argparse
import collections
import json
import os
import re
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import language

HERE = Path(__file__).resolve().parent
BENCH = HERE.parent
sys.path.insert(0, str(BENCH))
import section  # noqa: E402
from front_table import table  # noqa: E402

PARTS = BENCH.parent / "tests" / "parts"
TOLERANCE = "0.1%"
#: A part is made once with so much of its tolerance, and then its volume is within so many percent of the one in its script.
FINE, RIGHT = 1 / 20, 1.0
#: What takes so many ms is not run again.
LONG = 5000
ABOUT = """
The parts of `tests/parts` within 0.1 % of their diagonals, on one processor. Each script runs as Python on functions made of
manifold3d {version}, whose curves have as many segments as the tolerance needs. A part counts where its volume, made so twenty
times as fine, is within 1 % of the one in its script. Manifold's time is that of building and combining in memory, in a process
that runs already, without parsing the script: the median of five. Chordal's is the wall time of its command from the script
to a .ply, of which {start:.0f} ms are start and end (those of `box(1, 1, 1)`): the median of three, or one run where that takes
5 s. Chordal's error is measured (`--require measured`), or proved as far as that goes (the default); of Manifold's mesh nobody
says one. To start Python and load manifold3d takes {python:.0f} ms more.
""".strip()


def spent():
    """The CPU time of this process and of its children that ended, in seconds."""
    return time.process_time() + sum(resource.getrusage(resource.RUSAGE_CHILDREN)[:2])


def timed(run, runs):
    """The medians of a job's wall time and CPU time in ms, children's included, and what it gave at last."""
    wall, cpu = [], []
    while len(wall) < runs and (not wall or wall[-1] < LONG):
        before, began = spent(), time.perf_counter()
        given = run()
        wall.append(1e3 * (time.perf_counter() - began))
        cpu.append(1e3 * (spent() - before))
    return {"ms": statistics.median(wall), "cpu_ms": statistics.median(cpu), "runs": len(wall)}, given


def process(*words):
    """Runs a process to its end."""
    return subprocess.run([str(word) for word in words], capture_output=True, text=True, timeout=300, check=False)


def by_chordal(command, script, folder, runs, *more):
    """What the command makes of a script."""
    words = [command, "mesh", script, "--tol", TOLERANCE, "-o", folder / "out.ply", "--force", "--threads", 1, "--json"]
    times, done = timed(lambda: process(*words, *more), runs)
    if done.returncode not in (0, 5):
        raise RuntimeError(f"{script}: {done.stderr.strip()[:300]}")
    report = json.loads(done.stdout)
    certificate = report.get("certificate", report)
    return {
        **times, "code": done.returncode, "triangles": certificate["output"]["triangles"],
        "evidence": certificate["bound"]["evidence"], "tolerance": certificate["budget"]["length"],
    }


def by_manifold(code, tolerance, runs):
    """What Manifold makes of a script; to count triangles makes it evaluate them."""
    around = [language.names(tolerance) for _ in range(runs)]

    def run():
        solids = language.made(code, around.pop())
        return solids, sum(solid.num_tri() for solid in solids)

    times, (solids, count) = timed(run, runs)
    return {**times, "triangles": count, "volume": sum(solid.volume() for solid in solids)}


def judged(text, code, tolerance):
    """Why Manifold cannot make a part by these functions, or nothing; and by how many percent the volume is off."""
    said = float(re.search(r"^# volume: (\S+)", text, re.MULTILINE).group(1))
    try:
        off = 100 * (by_manifold(code, FINE * tolerance, 1)["volume"] / said - 1)
    except (AttributeError, NameError, TypeError) as error:
        return (re.findall(r"'(\w+)'", str(error)) or [str(error)])[0], None
    return (None if abs(off) <= RIGHT else f"volume off by {off:.1f} %"), off


def compared(name, asked, folder):
    """One part by both, or why not."""
    script = PARTS / f"{name}.star"
    text = script.read_text(encoding="utf-8")
    code = language.compiled(text)
    measured = by_chordal(asked.command, script, folder, 3, "--require", "measured")
    tolerance = measured["tolerance"]
    why, off = judged(text, code, tolerance)
    if why:
        return {"name": name, "skipped": why}
    return {
        "name": name, "tolerance": tolerance, "fine_volume_percent": off, "manifold": by_manifold(code, tolerance, 5),
        "measured": measured, "proof": by_chordal(asked.command, script, folder, 3),
    }


HEADS = ["part", "Manifold, ms", "triangles", "Chordal, measured, ms", "with proof, ms", "triangles", "proved", "measured / Manifold",
         "with proof / Manifold"]


def ratio(row, how, time="ms", less=0.0):
    """Chordal's time over Manifold's."""
    return max(row[how][time] - less, 0) / row["manifold"][time]


def cells(row):
    """The line of one part."""
    peer, measured, proof = row["manifold"], row["measured"], row["proof"]
    proved = "yes" if proof["evidence"].startswith("proved") else "no"
    return [
        row["name"], f"{peer['ms']:.2f}", f"{peer['triangles']:,}", f"{measured['ms']:.0f}", f"{proof['ms']:.0f}",
        f"{proof['triangles']:,}", proved, f"{ratio(row, 'measured'):.1f}", f"{ratio(row, 'proof'):.1f}",
    ]


def summary(rows, start, python):
    """Medians and worst of all parts, each a line of a label and numbers."""

    def as_process(row, how):
        return row[how]["ms"] / (python + row["manifold"]["ms"])

    columns = {
        "Manifold, ms": lambda row: row["manifold"]["ms"],
        "Chordal, measured, ms": lambda row: row["measured"]["ms"],
        "Chordal, with proof, ms": lambda row: row["proof"]["ms"],
        "measured / Manifold": lambda row: ratio(row, "measured"),
        "with proof / Manifold": lambda row: ratio(row, "proof"),
        "measured / Manifold, less the start": lambda row: ratio(row, "measured", less=start),
        "with proof / Manifold, less the start": lambda row: ratio(row, "proof", less=start),
        "measured / Manifold with Python's start": lambda row: as_process(row, "measured"),
        "with proof / Manifold with Python's start": lambda row: as_process(row, "proof"),
        "measured / Manifold, CPU time": lambda row: ratio(row, "measured", "cpu_ms"),
        "with proof / Manifold, CPU time": lambda row: ratio(row, "proof", "cpu_ms"),
        "Chordal's triangles / Manifold's": lambda row: row["proof"]["triangles"] / row["manifold"]["triangles"],
    }
    found = {}
    for label, value in columns.items():
        worst = max(rows, key=value)
        found[label] = {"median": statistics.median(map(value, rows)), "worst": value(worst), "of": worst["name"]}
    return found


def main():
    """Runs everything and writes the tables."""
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--command", required=True, help="the command of a release")
    arguments.add_argument("--results", action="store_true", help="write the section of RESULTS.md as well")
    arguments.add_argument("parts", nargs="*", help="names; all of them unless some are named")
    asked = arguments.parse_args()
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    names = asked.parts or sorted(path.stem for path in PARTS.glob("*.star"))
    rows, reasons = [], collections.defaultdict(list)
    print(*HEADS, sep=" | ")
    with tempfile.TemporaryDirectory() as written:
        folder = Path(written)
        (folder / "box.star").write_text("box(1, 1, 1)\n", encoding="utf-8")
        start = by_chordal(asked.command, folder / "box.star", folder, 15)["ms"]
        python = timed(lambda: process(sys.executable, "-c", "import manifold3d"), 5)[0]["ms"]
        for name in names:
            row = compared(name, asked, folder)
            if "skipped" in row:
                reasons[row["skipped"]].append(name)
                print(f"{name}: skipped: {row['skipped']}", flush=True)
                continue
            rows.append(row)
            print(*cells(row), sep=" | ", flush=True)
    if not rows:
        sys.exit("no part is compared")
    found = summary(rows, start, python)
    proved = sum(row["proof"]["evidence"].startswith("proved") for row in rows)
    whole = {"start_ms": start, "python_start_ms": python, "summary": found, "proved": proved, "parts": rows, "skipped": reasons}
    (BENCH / "out").mkdir(exist_ok=True)
    (BENCH / "out" / "parts.json").write_text(json.dumps(whole, indent=1) + "\n", encoding="utf-8")
    skipped = sum(map(len, reasons.values()))
    text = [
        ABOUT.format(version=language.VERSION, start=start, python=python),
        table(["of all parts", "median", "worst", "of"],
              [[label, f"{line['median']:.3g}", f"{line['worst']:.3g}", line["of"]] for label, line in found.items()]),
        f"{len(rows)} of {len(names)} parts are compared; of {proved} of them Chordal's error is proved. {skipped} are skipped, for what "
        "the functions lack: " + "; ".join(f"{why} ({', '.join(those)})" for why, those in sorted(reasons.items())) + ".",
        table(HEADS, list(map(cells, rows))),
        f"Measured on {section.machine()}.",
    ]
    print("", *text[:3], text[4], sep="\n\n")
    if asked.results:
        section.put("Everyday parts, against Manifold", "\n\n".join(text))


main()
