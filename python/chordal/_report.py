"""`Report`: everything known about a result, shown in a few lines."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from chordal._bound import Bound, bound_of
from chordal._html import table

#: The properties of triangles that are listed if they hold, by their names in the report.
_VALID = ("closed", "manifold", "oriented")
#: The most texts that are listed; further ones are counted. Chosen so that a report fits on a screen.
_MOST_LISTED = 3


class Report(dict[str, Any]):
    """The report on a result or a written file: a dictionary in the form of JSON, which `docs/schema` describes. Only a few lines
    of it are shown. You may change it.

    >>> import chordal, json
    >>> report = chordal.load(b"v 0 0 0\\nv 1 0 0\\nv 0 1 0\\nf 1 2 3\\n", format="obj").mesh(tol=1).report
    >>> report
    <Report: mesh of triangles
      bound: between 0 and 0, proved; hausdorff distance to the input triangles
      output: 3 vertices, 1 triangle
      valid: manifold, oriented
      notes: 1 triangles were simplified to 1>
    >>> report["certificate"]["valid"]["boundary_edges"], json.loads(json.dumps(report)) == report
    (3, True)
    """

    __slots__ = ()

    @property
    def bound(self) -> Bound | None:
        """The bound in the report; None if there is none, or if it is incomplete."""
        facts = _value_at(self, "certificate", "bound")
        try:
            return None if facts is None else bound_of(facts)
        except (KeyError, TypeError, ValueError):
            return None

    def copy(self) -> Report:
        """Another report with the same entries."""
        return Report(self)

    def __or__(self, other: Mapping[str, Any]) -> Report:  # type: ignore[override]
        return Report({**self, **other}) if isinstance(other, Mapping) else NotImplemented

    def __ror__(self, other: Mapping[str, Any]) -> Report:  # type: ignore[override]
        return Report({**other, **self}) if isinstance(other, Mapping) else NotImplemented

    def rows(self) -> list[tuple[str, str]]:
        """The lines that are shown, as pairs of a title and a text."""
        rows: list[tuple[str, str]] = []
        verdict = self.get("verdict", _value_at(self, "deviation", "verdict"))
        if isinstance(verdict, str):
            rows.append(("verdict", verdict))
        if self.bound is not None:
            rows.append(("bound", self.bound.sentence()))
        rows.append(("output", _counts(_value_at(self, "certificate", "output"))))
        levels = _value_at(self, "certificate", "levels", "levels")
        if isinstance(levels, list):
            rows.append(("levels", f"{len(levels):,}"))
        valid = _value_at(self, "certificate", "valid")
        if isinstance(valid, dict):
            rows.append(("valid", ", ".join(word for word in _VALID if valid.get(word)) or "no"))
        box = _value_at(self, "inspection", "box")
        if isinstance(box, list) and len(box) == 2:
            rows.append(("box", " to ".join(f"({', '.join(f'{x:.6g}' for x in corner)})" for corner in box)))
        output, n_bytes = _value_at(self, "run", "output"), _value_at(self, "run", "bytes")
        if output is not None:
            rows.append(("file", output if n_bytes is None else f"{output}, {n_bytes:,} bytes"))
        findings = _value_at(self, "inspection", "findings")
        rows.append(("found", _listed(_formatted(findings, "{count:,} {words}"), ", ")))
        warnings = _value_at(self, "certificate", "input", "warnings")
        rows.append(("warnings", _listed(_formatted(warnings, "{message} ({count:,})"), "; ")))
        rows.append(("notes", _listed(_formatted(_value_at(self, "certificate", "notes"), "{}"), "; ")))
        return [(title, text) for title, text in rows if text]

    def _title(self) -> str:
        verb, kind = _value_at(self, "run", "verb"), _value_at(self, "certificate", "input", "kind")
        return " of ".join(str(word) for word in (verb, kind) if word)

    def __repr__(self) -> str:
        lines = [
            f"<Report: {self._title()}" if self._title() else "<Report",
            *(f"  {title}: {text}" for title, text in self.rows()),
        ]
        return "\n".join(lines) + ">"

    def __reduce__(self) -> Any:
        return Report, (dict(self),)

    def _repr_html_(self) -> str:
        return table(f"Report: {self._title()}", self.rows())


def _value_at(facts: Any, *path: str) -> Any:
    """The value at a path of keys; None if the path does not exist."""
    for name in path:
        if not isinstance(facts, dict):
            return None
        facts = facts.get(name)
    return facts


def _formatted(entries: Any, template: str) -> list[str]:
    """Each entry of a list in a template. Entries without its keys are skipped, since a report may have been changed."""
    texts = []
    for entry in entries if isinstance(entries, list) else ():
        try:
            texts.append(template.format(**entry) if isinstance(entry, dict) else template.format(entry))
        except (LookupError, TypeError, ValueError):
            continue
    return texts


def _counts(output: Any) -> str:
    """Counts with their nouns, as in "1 triangle"."""
    if not isinstance(output, dict):
        return ""
    singular = {
        "vertices": "vertex",
        "triangles": "triangle",
        "polylines": "polyline",
        "segments": "segment",
        "faces": "face",
    }
    # Positions are listed only if their number differs from that of vertices.
    counts = [
        (name, n)
        for name, n in output.items()
        if isinstance(n, int) and (name != "positions" or n != output.get("vertices"))
    ]
    return ", ".join(f"{n:,} {singular.get(name, name) if n == 1 else name}" for name, n in counts)


def _listed(texts: list[str], between: str) -> str:
    """The first texts, and the number of further ones."""
    more = len(texts) - _MOST_LISTED
    return between.join([*texts[:_MOST_LISTED], *([f"and {more:,} more"] if more > 0 else [])])
