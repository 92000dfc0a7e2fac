"""What can go wrong, one exception for each person who can mend it. All carry what a program wants to know."""

from __future__ import annotations

import re
from decimal import Decimal
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from chordal._bound import Bound


class Error(Exception):
    """Anything that Chordal itself raises; arguments of the wrong type raise Python's own `TypeError`.

    >>> import chordal
    >>> try:
    ...     chordal.load(b"no shape", format="obj").mesh(tol=-1)
    ... except chordal.Error as error:
    ...     print(type(error).__name__)
    ReadError
    """


class ReadError(Error):
    """The file is wrong, at this place.

    >>> import chordal
    >>> try:
    ...     chordal.load(b"v 0 0 0\\nv 1 0\\n", format="obj")
    ... except chordal.ReadError as error:
    ...     print(error.place)
    line 2
    """

    #: Stable, for programs, as in "index-out-of-range".
    code: str
    #: Where: a line, a byte, a row of a list or a JSON pointer. None for the file as a whole.
    place: str | None
    #: What, in one sentence, with the value and the limit.
    message: str
    #: The name of the file, if it was one.
    source: str | None

    def __init__(self, code: str, place: str | None, message: str, source: str | None = None) -> None:
        super().__init__(code, place, message, source)
        self.code, self.place, self.message, self.source = code, place, message, source

    def __str__(self) -> str:
        return ": ".join(part for part in (self.source, self.place, self.message) if part)


class WriteError(Error):
    """The format cannot hold the shape. A disk that is full raises `OSError`, as everywhere in Python.

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
    """The budget makes sense and was not met. The best that was reached is at hand, with its own bound.

    >>> import chordal
    >>> try:
    ...     chordal.shapes.sphere(1).mesh(tol=0.01, triangles=10)
    ... except chordal.BudgetUnmet as error:
    ...     print(len(error.best.faces) > 10, error.bound.evidence)
    True proved
    """

    #: The best that was reached, as the call would have returned it: a `Mesh`, `Polylines`, `Volume` or `Levels`.
    best: Any

    def __init__(self, message: str, best: Any) -> None:
        super().__init__(plain_numbers(message), best)
        self.best = best

    @property
    def bound(self) -> Bound:
        """How far the best is from the true shape."""
        bound: Bound = self.best.bound
        return bound

    def __str__(self) -> str:
        return f"{self.args[0]}; `best` of this error holds it"


def plain_numbers(text: str) -> str:
    """The same digits without powers of ten, where a number of usual size has some."""

    def plain(found: re.Match[str]) -> str:
        number = Decimal(found.group())
        # As Python writes numbers: from 1e-4 on, and with up to 16 digits.
        return f"{number:f}" if -5 < number.adjusted() < 16 or number == 0 else found.group()

    return re.sub(r"\d\.\d+e-?\d+", plain, text)


class Refused(Error):
    """The work was not done, and will not be: for a reason that `code` names.

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
    """A promise that the library makes to itself is broken: a bug of Chordal, not of yours."""
