"""RESULTS.md: one section for each bench, which replaces its own and leaves the others."""

from pathlib import Path

RESULTS = Path(__file__).resolve().parent / "RESULTS.md"
TITLE = """# Results of the benches, as measured

`make bench` writes this file. Every figure is that of one run of both sides on the same input, also where Chordal
loses.
"""


def put(title, text):
    """Writes the section `## title`."""
    whole = RESULTS.read_text() if RESULTS.exists() else TITLE
    head, *sections = whole.split("\n## ")
    kept = {section.split("\n")[0]: section for section in sections}
    kept[title] = f"{title}\n\n{text.strip()}\n"
    parts = [head.strip() + "\n", *(f"## {kept[name].strip()}\n" for name in sorted(kept))]
    RESULTS.write_text("\n".join(parts))
