"""The exceptions of Chordal, by who can solve the problem. Each carries the details that a program needs."""

from __future__ import annotations

import re
from decimal import Decimal
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from chordal._bound import Bound


class Error(Exception):
    """The base of all exceptions of Chordal; arguments of the wrong type raise Python's own `TypeError`.

    >>> import chordal
    >>> try:
    ...     chordal.load(b"no shape", format="obj").mesh(tol=-1)
    ... except chordal.Error as error:
    ...     print(type(error).__name__)
    ReadError
    """


class ReadError(Error):
    """The file is invalid, at this place.

    >>> import chordal
    >>> try:
    ...     chordal.load(b"v 0 0 0\\nv 1 0\\n", format="obj")
    ... except chordal.ReadError as error:
    ...     print(error.place)
    line 2
    """

    #: Stable, for programs, as in "index-out-of-range".
    code: str
    #: The place of the error: a line, a byte, a row of a list or a JSON pointer. None for the file as a whole.
    place: str | None
    #: The error in one sentence, with the value and the limit.
    message: str
    #: The name of the file, if it was one.
    source: str | None

    def __init__(self, code: str, place: str | None, message: str, source: str | None = None) -> None:
        super().__init__(code, place, message, source)
        self.code, self.place, self.message, self.source = code, place, message, source

    def __str__(self) -> str:
        return ": ".join(part for part in (self.source, self.place, self.message) if part)


class WriteError(Error):
    """The format cannot store the shape. A full disk raises `OSError`, as everywhere in Python.

    >>> import chordal
    >>> try:
    ...     chordal.shapes.sphere(1).lod(tol=0.1).to_bytes("obj")
    ... except chordal.WriteError as error:
    ...     print(error)
    obj holds no levels of detail
    """


class BudgetError(Error, ValueError):
    """The budget makes no sense: no limit, a limit that is not positive, pixels without a view.

    >>> import chordal
    >>> shape = chordal.load(b"v 0 0 0\\nv 1 0 0\\nv 0 1 0\\nf 1 2 3\\n", format="obj")
    >>> shape.mesh(pixels=1)
    Traceback (most recent call last):
        ...
    chordal._errors.BudgetError: a budget in pixels needs a view: add view="1920x1080 fov=45 dist=4" to pixels=1
    """


class BudgetUnmet(Error):
    """The budget makes sense, but was not met. The exception has the best result, with its own bound.

    >>> import chordal
    >>> try:
    ...     chordal.shapes.sphere(1).mesh(tol=0.01, triangles=10)
    ... except chordal.BudgetUnmet as error:
    ...     print(len(error.best.faces) > 10, error.bound.evidence)
    True proved
    """

    #: The best result, as the call would have returned it: a `Mesh`, `Polylines`, `Volume` or `Levels`.
    best: Any

    def __init__(self, message: str, best: Any) -> None:
        super().__init__(plain_numbers(message), best)
        self.best = best

    @property
    def bound(self) -> Bound:
        """The bound of the best result against the true shape."""
        bound: Bound = self.best.bound
        return bound

    def __str__(self) -> str:
        return f"{self.args[0]}; `best` of this error holds it"


def plain_numbers(text: str) -> str:
    """A text whose numbers of usual size are written with the same digits, but without powers of ten."""

    def plain(match: re.Match[str]) -> str:
        number = Decimal(match.group())
        # As Python writes numbers: from 1e-4 on, and with up to 16 digits.
        return f"{number:f}" if -5 < number.adjusted() < 16 or number == 0 else match.group()

    return re.sub(r"\d\.\d+e-?\d+", plain, text)


class Refused(Error):
    """The operation was refused, for a reason that `code` names; trying again would not help.

    >>> import chordal
    >>> try:
    ...     chordal.shapes.arc(1).shape().cage()
    ... except chordal.Refused as error:
    ...     print(error.code)
    unsupported
    """

    #: Stable, for programs, as in "too-many-triangles".
    code: str
    #: One sentence.
    message: str

    def __init__(self, code: str, message: str) -> None:
        super().__init__(code, message)
        self.code, self.message = code, message

    def __str__(self) -> str:
        return self.message


class InternalError(Error):
    """An invariant of the library is violated: a bug in Chordal, not in your code."""
