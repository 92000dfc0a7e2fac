"""`Made`: what meshes and polylines have in common."""

from __future__ import annotations

import html
import json
import os
import warnings
from typing import TYPE_CHECKING, Any, Final, Literal, TypeVar

from chordal import _chordal, _files
from chordal._bound import Bound, bound_of
from chordal._errors import BudgetUnmet

if TYPE_CHECKING:
    from numpy.typing import NDArray

Self = TypeVar("Self", bound="Made")


class Made:
    """Something that was made within a budget, with its bound. It does not change."""

    __slots__ = ("_outcome", "_report")

    def __init__(self, outcome: _chordal.Outcome) -> None:
        self._outcome: Final = outcome
        self._report: Final = outcome.report

    @classmethod
    def of(cls: type[Self], outcome: _chordal.Outcome) -> Self:
        """What was made, if it meets its budget."""
        made = cls(outcome)
        if outcome.unmet is not None:
            raise BudgetUnmet(outcome.unmet, made)
        return made

    @property
    def bound(self) -> Bound:
        """How far it is from the true shape, and how that is known."""
        return bound_of(self.report["certificate"]["bound"])

    @property
    def report(self) -> dict[str, Any]:
        """The report of `chordal mesh --json`, which `docs/schema` describes. It is yours to change."""
        report: dict[str, Any] = json.loads(self._report)
        return report

    def to_bytes(
        self, format: str, *, quantize: bool = False, compress: Literal["meshopt"] | None = None
    ) -> bytes:
        """The file of that format, as `export` writes it.

        Gives a `UserWarning` where `export` would write files beside it, as an OBJ has its materials.
        """
        written = self._for(format, quantize, compress)
        if written.names_files:
            warnings.warn("materials stand in files beside it, which export writes", stacklevel=2)
        return written.write()

    def export(
        self,
        path: str | os.PathLike[str],
        *,
        quantize: bool = False,
        compress: Literal["meshopt"] | None = None,
    ) -> dict[str, Any]:
        """Write a file, in the format that its extension names, and return the report on what is in it.

        A file of that name is replaced, by a whole one and at the end. GLB and STL hold single precision. Their
        rounding counts against the budget, so for them the shape is meshed again, a little finer; the file is then
        the same, byte for byte, as that of the command. An OBJ with materials gets a material library and pictures
        beside it, whose names begin like its own; files of these names are replaced too.

        For GLB and glTF: `quantize` rounds positions to steps of 16 bits and attributes to 8 and 16, within the budget
        and covered by the bound; `compress="meshopt"` compresses what is left without loss.
        """
        extension = os.path.splitext(os.fspath(path))[1].lstrip(".")
        if not extension:
            raise ValueError(f"path: the name does not say the format: {_files.shown(path)}")
        written = self._for(extension, quantize, compress)
        content = _write(written, path) if written.names_files else written.write()
        _files.replace(path, content)
        report: dict[str, Any] = json.loads(written.report)
        report["run"].update(output=_files.shown(path), bytes=len(content))
        return report

    def _for(self, format: str, quantize: bool, compress: str | None) -> _chordal.Outcome:
        remade = self._outcome.remake(format, quantize, compress)
        # The best of a budget that was not met may be written all the same: its owner knows.
        return remade if self._outcome.unmet is not None else type(self).of(remade)._outcome

    def _array(self, name: str) -> NDArray[Any]:
        import numpy as np

        array: NDArray[Any] = np.asarray(self._outcome.array(name))
        return array

    def _size(self) -> str:
        raise NotImplementedError

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {self._size()}; {self.bound.sentence()}>"

    def _repr_html_(self) -> str:
        rows = ((type(self).__name__, self._size()), ("bound", self.bound.sentence()))
        cells = "".join(f"<tr><th>{name}</th><td>{html.escape(text)}</td></tr>" for name, text in rows)
        return f"<table>{cells}</table>"


def _write(written: _chordal.Outcome, path: str | os.PathLike[str]) -> bytes:
    """Write the files beside a file, and give the content of that one."""
    target = os.path.realpath(path)
    _files.refuse_irregular_target(target, path)
    folder, name = os.path.split(target)
    content, beside = written.write_files(os.path.splitext(name)[0])
    for own, content_of_own in beside:
        _files.replace(os.path.join(folder, own), content_of_own)
    return content


def counted(count: int, one: str, many: str) -> str:
    """A number with its noun."""
    return f"{count:,} {one if count == 1 else many}"
