"""RESULTS.md: one section for each bench, which replaces its own and leaves the others; and what it was measured on."""

import os
import platform
from pathlib import Path

RESULTS = Path(__file__).resolve().parent / "RESULTS.md"
TITLE = """# Results of the benches, as measured

`make bench` writes this file. Every figure is that of one run of both sides on the same input, also where Chordal
loses.
"""


def cpu():
    """The processor's name."""
    cpu = platform.processor() or platform.machine()
    info = Path("/proc/cpuinfo")
    if info.exists():
        models = [line.split(":")[1].strip() for line in info.read_text().split("\n") if line.startswith("model name")]
        cpu = models[0] if models else cpu
    return cpu


def machine():
    """What the times were measured on."""
    load = ", ".join(f"{x:.1f}" for x in os.getloadavg())
    return f"{cpu()}, {os.cpu_count()} cores, load {load} at the end of the run"


def put(title, text):
    """Writes the section `## title`."""
    whole = RESULTS.read_text() if RESULTS.exists() else TITLE
    head, *sections = whole.split("\n## ")
    kept = {section.split("\n")[0]: section for section in sections}
    kept[title] = f"{title}\n\n{text.strip()}\n"
    parts = [head.strip() + "\n", *(f"## {kept[name].strip()}\n" for name in sorted(kept))]
    RESULTS.write_text("\n".join(parts))
