"""The short table of the quick bench, from quick.json: in README.md one line a job, on top of RESULTS.md every line.

`front_table.py` writes both between their markers; `front_table.py --check` says whether they agree with quick.json.
"""

import json
import sys
from pathlib import Path

BENCH = Path(__file__).resolve().parent
RESULT = BENCH / "quick.json"
START, END = "<!-- quick bench: written by bench/front_table.py -->", "<!-- end of the quick bench -->"


def shown(value):
    """A number in two or three digits."""
    if value is None:
        return "–"
    return f"{value:.3g}" if abs(value) < 100 else f"{value:,.0f}"


def verdict(line):
    """What came of a line."""
    if line["skipped"]:
        return "**SKIPPED**"
    return "yes" if line["passed"] else "**missed**"


def urgency(line):
    """Where a line is sorted among those of its job: by how much of its limit it uses."""
    if line["skipped"]:
        return 0.0
    return line["ratio"] / line["limit"] if line["limit"] else 1.0 + line["ratio"]


def quantity(value, unit):
    """A number with its unit."""
    return "–" if value is None else f"{shown(value)} {unit}"


def target(line):
    """The limit: of the number itself, or as a multiple of the peer's."""
    is_absolute = line["ratio"] == line["ours"]
    return f"≤ {shown(line['limit'])} {line['unit']}" if is_absolute else f"≤ {shown(line['limit'])} ×"


def job_row(lines):
    """The line of one job that is farthest beyond its target, or nearest to it."""
    measured = [line for line in lines if not line["skipped"]]
    missed = sum(not line["passed"] for line in measured)
    skipped = len(lines) - len(measured)
    worst = max(lines, key=urgency)
    kept = f"{len(measured) - missed} of {len(lines)}"
    kept = f"**{kept}**" if missed or skipped else kept
    kept += f", {skipped} SKIPPED" if skipped else ""
    if worst["skipped"]:
        return [worst["job"], worst["what"], "–", "–", "–", "–", kept]
    theirs = f"{quantity(worst['theirs'], worst['unit'])} ({worst['peer']})"
    times = f"{shown(worst['ours'] / worst['theirs'])} ×" if worst["theirs"] else "–"
    return [worst["job"], worst["what"], quantity(worst["ours"], worst["unit"]), theirs, times, target(worst), kept]


def measured_on(result):
    """What the numbers were measured on."""
    machine, loads = result["machine"], [line["load"] for line in result["lines"]]
    dates = sorted({line["date"] for line in result["lines"]})
    return (
        f"Measured on {' to '.join(dict.fromkeys([dates[0], dates[-1]]))}: {machine['cpu']}, {machine['cores']} cores, "
        f"load {min(loads):.1f} to {max(loads):.1f}."
    )


def behind(result):
    """The number of lines in which the peer has less."""
    measured = [line for line in result["lines"] if not line["skipped"] and line["theirs"]]
    n = sum(line["ours"] > line["theirs"] for line in measured)
    return f"In {n} of {len(measured)} lines the peer has less."


def table(head, rows):
    """A table in Markdown."""
    return "\n".join([f"| {' | '.join(head)} |", "|" + "---|" * len(head), *(f"| {' | '.join(row)} |" for row in rows)])


def short(result):
    """The table of README.md: one line a job."""
    jobs = dict.fromkeys(line["job"] for line in result["lines"])
    rows = [job_row([line for line in result["lines"] if line["job"] == job]) for job in jobs]
    head = ["job", "the worst of its lines", "ours", "best peer", "ours / theirs", "target", "targets kept"]
    links = "`make bench-quick` measures again; [all lines](bench/RESULTS.md)."
    return "\n\n".join([table(head, rows), f"{behind(result)} {measured_on(result)} {links}"])


def long(result):
    """The table on top of RESULTS.md: every line."""
    rows = [
        [
            line["job"], line["what"], line["peer"], line["unit"], shown(line["ours"]), shown(line["theirs"]), shown(line["ratio"]),
            f"≤ {shown(line['limit'])}", verdict(line), "yes" if line["proved"] else "no",
        ]
        for line in result["lines"]
    ]
    head = ["job", "what is compared", "best peer", "unit", "ours", "theirs", "ours / theirs", "target", "kept", "ours proved"]
    reasons = sorted({f"{line['peer']}: {line['skipped']}" for line in result["lines"] if line["skipped"]})
    parts = [f"The quick bench (`make bench-quick`): the lines of the targets, both sides in one run. {measured_on(result)}", table(head, rows)]
    if reasons:
        parts.append("SKIPPED, which counts as not kept: " + "; ".join(reasons) + ".")
    return "\n\n".join(parts)


def pages(result):
    """The files that hold a table, and what each is to hold between its markers."""
    return {BENCH.parent / "README.md": short(result), BENCH / "RESULTS.md": long(result)}


def with_table(text, part):
    """The text with what is between its markers replaced."""
    before, rest = text.split(START, 1)
    after = rest.split(END, 1)[1]
    return f"{before}{START}\n{part}\n{END}{after}"


def stale():
    """The names of the files whose table is not that of quick.json."""
    result = json.loads(RESULT.read_text(encoding="utf-8"))
    texts = {path: path.read_text(encoding="utf-8") for path in pages(result)}
    return [path.name for path, part in pages(result).items() if with_table(texts[path], part) != texts[path]]


def render():
    """Writes both tables."""
    for path, part in pages(json.loads(RESULT.read_text(encoding="utf-8"))).items():
        path.write_text(with_table(path.read_text(encoding="utf-8"), part), encoding="utf-8")


if __name__ == "__main__":
    if "--check" in sys.argv:
        names = stale()
        sys.exit(f"not the table of quick.json: {', '.join(names)}; run bench/front_table.py" if names else 0)
    render()
