"""Fields evaluated beside fidget's interpreter and machine code; writes a section of RESULTS.md and out/fields.csv.

Run by `make fields`. Three models are made by the program; the others are op lists of fidget's repository, which are not
part of this tree: CHORDAL_DATA says where they are.
"""

import csv
import os
import subprocess
import sys
from pathlib import Path

BENCH = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(BENCH))
import section  # noqa: E402

MODELS = Path(os.environ.get("CHORDAL_DATA", BENCH.parent.parent / "shared" / "data")) / "implicit/fidget/models"
ABOUT = """
Millions of points or boxes a second on one thread, medians of runs in turn, 16,384 points or 4,096 boxes a call. fidget
(0.5, f32 throughout) has an interpreter and a compiler to machine code; the time of compiling is not counted. Chordal
compiles nothing. Its ranges are f64, rounded outward, and hold the true values; fidget's are f32 and not rounded
outward. fidget has neither f64 points nor ranges of gradients.
""".strip()


def rate(text):
    """A rate with three digits, or a dash."""
    return f"{float(text):,.3g}" if text else "–"


def main():
    """Runs the program and writes the table."""
    done = subprocess.run([BENCH / "target" / "release" / "fields", MODELS], check=True, capture_output=True, text=True)
    (BENCH / "out" / "fields.csv").write_text(done.stdout)
    text = [ABOUT, "", "| model | what | Chordal | fidget VM | fidget JIT | over VM | over JIT |", "|---|---|---|---|---|---|---|"]
    for row in csv.DictReader(done.stdout.splitlines()):
        vm, jit = row["fidget_vm"], row["fidget_jit"]
        ratios = [f"{float(row['chordal']) / float(x):.2f}" if x else "–" for x in (vm, jit)]
        cells = [row["model"], row["what"], rate(row["chordal"]), rate(vm), rate(jit), *ratios]
        text.append(f"| {' | '.join(cells)} |")
    text += ["", f"Measured on {section.machine()}."]
    section.put("Fields, against fidget", "\n".join(text))


main()
