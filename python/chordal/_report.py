"""`Report`: all that is known of a result, of which a few lines are shown."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from chordal._bound import Bound, bound_of
from chordal._table import table

#: What is said of triangles where it holds, by the names of the report.
_VALID = ("closed", "manifold", "oriented")
#: More texts than these are counted. Chosen, so that what is shown stays on a screen.
_MOST_LISTED = 3


class Report(dict[str, Any]):
    """The report on what was made or written: a dictionary as of JSON, that `docs/schema` describes, of which a few lines are
    shown. It is yours to change.

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
        """The bound that it speaks of; None where nothing was made, or where not all of it is there."""
        facts = _found(self, "certificate", "bound")
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
        """What is shown of it: titles and texts."""
        found: list[tuple[str, str]] = []
        verdict = self.get("verdict", _found(self, "deviation", "verdict"))
        if isinstance(verdict, str):
            found.append(("verdict", verdict))
        if self.bound is not None:
            found.append(("bound", self.bound.sentence()))
        found.append(("output", _counts(_found(self, "certificate", "output"))))
        levels = _found(self, "certificate", "levels", "levels")
        if isinstance(levels, list):
            found.append(("levels", f"{len(levels):,}"))
        valid = _found(self, "certificate", "valid")
        if isinstance(valid, dict):
            found.append(("valid", ", ".join(word for word in _VALID if valid.get(word)) or "no"))
        box = _found(self, "inspection", "box")
        if isinstance(box, list) and len(box) == 2:
            found.append(("box", " to ".join(f"({', '.join(f'{x:.6g}' for x in corner)})" for corner in box)))
        output, n_bytes = _found(self, "run", "output"), _found(self, "run", "bytes")
        if output is not None:
            found.append(("file", output if n_bytes is None else f"{output}, {n_bytes:,} bytes"))
        findings = _found(self, "inspection", "findings")
        found.append(("found", _listed(_told(findings, "{count:,} {words}"), ", ")))
        warnings = _found(self, "certificate", "input", "warnings")
        found.append(("warnings", _listed(_told(warnings, "{message} ({count:,})"), "; ")))
        found.append(("notes", _listed(_told(_found(self, "certificate", "notes"), "{}"), "; ")))
        return [(title, text) for title, text in found if text]

    def _title(self) -> str:
        verb, kind = _found(self, "run", "verb"), _found(self, "certificate", "input", "kind")
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


def _found(facts: Any, *path: str) -> Any:
    """What stands at the end of a path; None where it does not lead so far."""
    for name in path:
        if not isinstance(facts, dict):
            return None
        facts = facts.get(name)
    return facts


def _told(entries: Any, form: str) -> list[str]:
    """Each entry of a list in a form; those that lack what it names are passed over: a report may have been changed."""
    found = []
    for one in entries if isinstance(entries, list) else ():
        try:
            found.append(form.format(**one) if isinstance(one, dict) else form.format(one))
        except (LookupError, TypeError, ValueError):
            continue
    return found


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
    # Positions are there beside vertices, for files in which these differ.
    counts = [
        (name, n)
        for name, n in output.items()
        if isinstance(n, int) and (name != "positions" or n != output.get("vertices"))
    ]
    return ", ".join(f"{n:,} {singular.get(name, name) if n == 1 else name}" for name, n in counts)


def _listed(texts: list[str], between: str) -> str:
    """The first of some texts, and how many more there are."""
    more = len(texts) - _MOST_LISTED
    return between.join([*texts[:_MOST_LISTED], *([f"and {more:,} more"] if more > 0 else [])])
