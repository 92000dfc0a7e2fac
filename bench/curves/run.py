"""The flattening bench: all sides on each corpus at each tolerance, in one process, one after the other.

Prints tables, and writes them with what they were measured on to out/curves.csv and to RESULTS.md.
"""

import csv
import subprocess
import sys
from datetime import date
from pathlib import Path

BENCH = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(BENCH))
import section  # noqa: E402

CORPORA = {
    "random": "cubics whose control points are evenly from a square",
    "regular": "cubics that bend one way, at an even speed",
    "hard": "15 families: cusps, loops, turning back on a line, coincident points, inflections, nearly straight",
    "icons": "the curves of every fifteenth icon of Material Design Icons (npm @mdi/svg 7.4.47, Apache-2.0)",
    "letters": "every third outline of Source Serif Pro Regular (npm source-serif-pro 3.1.0, OFL-1.1)",
}
TOLERANCES = ["1e-1", "1e-2", "1e-3", "1e-4", "1e-5"]
NAMES = {
    "chordal": "Chordal, proved",
    "chordal-path": "Chordal, `curve_to_polyline`",
    "chordal-even": "Chordal, equal steps, proved",
    "kurbo": "kurbo 0.13",
    "lyon": "lyon_geom 1.0",
}
COLUMNS = [
    "corpus", "tolerance", "side", "curves", "segments", "segments where kurbo keeps", "over", "worst", "median", "least", "ns one by one",
    "ns at once",
]


class Row:
    """One side on one corpus at one tolerance."""

    def __init__(self, line):
        self.line = line.split(",")
        self.corpus, self.tolerance, self.side = self.line[:3]
        self.curves, self.segments, self.beside, self.over = map(int, self.line[3:7])
        self.worst, self.median, self.least, self.one, self.all = map(float, self.line[7:])


def rows(corpus):
    """All sides on one corpus."""
    path = BENCH / "target" / "release" / "curves"
    done = subprocess.run([path, corpus, *TOLERANCES], check=True, stdout=subprocess.PIPE, text=True)
    return [Row(line) for line in done.stdout.split()]


def table(found):
    """The Markdown table of one corpus."""
    lines = [
        "| tolerance | side | segments/curve | × least | × kurbo where it keeps | × lyon | over | worst error/tolerance | ns one by one | ns at once |",
        "|---" * 10 + "|",
    ]
    for tolerance in TOLERANCES:
        here = {row.side: row for row in found if row.tolerance == tolerance}
        kurbo, lyon = here["kurbo"], here["lyon"]
        for side, name in NAMES.items():
            row = here[side]
            lines.append(
                f"| {tolerance} | {name} | {row.segments / row.curves:.2f} | {row.segments / row.least:.3f} | {row.beside / kurbo.beside:.3f} "
                f"| {row.segments / lyon.segments:.3f} | {row.over} ({100 * row.over / row.curves:.2f} %) | {row.worst:.3f} | {row.one:.0f} | {row.all:.0f} |"
            )
    return "\n".join(lines)


def targets(found):
    """The Markdown table of what was aimed at."""
    lines = [
        "| corpus | tolerance | segments/kurbo (≤ 1) | over (0) | time/kurbo (≤ 1) | at once (≤ 0.5) | segments/lyon (≤ 0.55) | time/lyon (≤ 4) "
        "| even: counts equal | even: time/lyon (≤ 1) | at once (≤ 1) |",
        "|---" * 11 + "|",
    ]

    def cell(value, limit):
        return f"{value:.2f}" if value <= limit + 0.005 else f"**{value:.2f}**"

    for corpus in CORPORA:
        for tolerance in TOLERANCES:
            here = {row.side: row for row in found if row.corpus == corpus and row.tolerance == tolerance}
            own, even, kurbo, lyon = (here[side] for side in ("chordal", "chordal-even", "kurbo", "lyon"))
            over = own.over + even.over
            lines.append(
                f"| {corpus} | {tolerance} | {cell(own.beside / kurbo.beside, 1)} | {over or 0} | {cell(own.one / kurbo.one, 1)} "
                f"| {cell(own.all / kurbo.all, 0.5)} | {cell(own.segments / lyon.segments, 0.55)} | {cell(own.one / lyon.one, 4)} "
                f"| {'yes' if even.segments == lyon.segments else f'**{even.segments / lyon.segments:.4f}**'} "
                f"| {cell(even.one / lyon.one, 1)} | {cell(even.all / lyon.all, 1)} |"
            )
    return "\n".join(lines)


def main():
    """Runs everything."""
    found = []
    for corpus in CORPORA:
        for row in rows(corpus):
            found.append(row)
            print(*row.line, flush=True)
    with open(BENCH / "out" / "curves.csv", "w", newline="") as out:
        csv.writer(out).writerows([COLUMNS, *(row.line for row in found)])
    parts = [(BENCH / "curves" / "ABOUT.md").read_text().strip()]
    parts.append(f"Measured on {date.today()}: {section.machine()}.")
    parts.append(f"### What was aimed at, and what was missed (bold)\n\n{targets(found)}")
    for corpus, about in CORPORA.items():
        own = [row for row in found if row.corpus == corpus]
        parts.append(f"### {corpus}: {own[0].curves} curves, {about}\n\n{table(own)}")
    section.put("Flattening curves, against kurbo and lyon", "\n\n".join(parts))
    print(f"\n{targets(found)}")


if __name__ == "__main__":
    main()
