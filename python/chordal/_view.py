"""`View`: the camera and the screen."""

from __future__ import annotations

from collections.abc import Sequence
from typing import SupportsFloat, SupportsInt

from chordal import _chordal
from chordal._arguments import number
from chordal._errors import BudgetError


class View:
    """The camera from which a shape is seen, and the size of the screen in device pixels.

    The text has the syntax of the command's `--view`; `closest` and `camera` build it from numbers.

    >>> from chordal import View
    >>> View("1920x1080 fov=45 dist=4") == View.closest(distance=4, fov_deg=45, size_px=(1920, 1080))
    True
    >>> View.camera(eye=(4, -6, 3), target=(0, 0, 1), fov_deg=30, size_px=(1280, 960))
    View('1280x960 fov=30 eye=4,-6,3 target=0,0,1 up=0,0,1 near=0')
    """

    __slots__ = ("_text",)

    _text: str

    def __init__(self, text: str) -> None:
        if not isinstance(text, str):
            raise TypeError(f"view: a text like '1920x1080 fov=45 dist=4', not {type(text).__name__}")
        object.__setattr__(self, "_text", _chordal.view(words_of(text)))

    @classmethod
    def closest(
        cls,
        *,
        distance: SupportsFloat | None = None,
        fov_deg: SupportsFloat | None = None,
        height: SupportsFloat | None = None,
        size_px: tuple[SupportsInt, SupportsInt],
    ) -> View:
        """Any camera that is not nearer than `distance` to the shape's box, in any direction.

        `fov_deg` is the vertical field of view in degrees. With `height` instead, the projection is parallel, the picture is
        so many units high, and no distance is needed.
        """
        words = [_size(size_px), *_projection(fov_deg, height)]
        if distance is not None:
            words.append(f"dist={number('distance', distance)!r}")
        return cls(" ".join(words))

    @classmethod
    def camera(
        cls,
        *,
        eye: Sequence[SupportsFloat],
        target: Sequence[SupportsFloat],
        up: Sequence[SupportsFloat] | None = None,
        near: SupportsFloat = 0.0,
        fov_deg: SupportsFloat | None = None,
        height: SupportsFloat | None = None,
        size_px: tuple[SupportsInt, SupportsInt],
    ) -> View:
        """A camera at a fixed place. Without `up`, z is up, or y for a camera that looks along z."""
        words = [_size(size_px), *_projection(fov_deg, height)]
        words += [f"eye={_point('eye', eye)}", f"target={_point('target', target)}"]
        if up is not None:
            words.append(f"up={_point('up', up)}")
        words.append(f"near={number('near', near)!r}")
        return cls(" ".join(words))

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"a view does not change: cannot set '{name}'")

    def __delattr__(self, name: str) -> None:
        raise AttributeError(f"a view does not change: cannot delete '{name}'")

    def __eq__(self, other: object) -> bool:
        return isinstance(other, View) and self._text == other._text

    def __hash__(self) -> int:
        return hash(self._text)

    def __reduce__(self) -> tuple[type[View], tuple[str]]:
        return View, (self._text,)

    def __str__(self) -> str:
        return self._text

    def __repr__(self) -> str:
        return f"View({self._text!r})"


def words_of(view: View | str) -> str:
    """The text of a view. Raises `BudgetError` if it does not begin with the size of the screen."""
    if not isinstance(view, (str, View)):
        raise TypeError(f"view: a chordal.View or the text of one, not {type(view).__name__}")
    if isinstance(view, str) and not view.lstrip()[:1].isdigit():
        raise BudgetError(
            f"view: it begins with the size of the screen, as in '1280x960 fov=30 eye=4,-6,3 target=0,0,1', not {view!r}; "
            "chordal.View.camera(eye=…, target=…, fov_deg=…, size_px=…) makes one of numbers"
        )
    return str(view)


def _size(size_px: tuple[SupportsInt, SupportsInt]) -> str:
    try:
        width, height = size_px
        return f"{int(width)}x{int(height)}"
    except (TypeError, ValueError) as error:
        raise BudgetError(f"size_px: columns and rows, as in (1920, 1080), not {size_px!r}") from error


def _projection(fov_deg: SupportsFloat | None, height: SupportsFloat | None) -> list[str]:
    words = []
    if fov_deg is not None:
        words.append(f"fov={number('fov_deg', fov_deg)!r}")
    if height is not None:
        words.append(f"height={number('height', height)!r}")
    return words


def _point(name: str, point: Sequence[SupportsFloat]) -> str:
    try:
        x, y, z = point
    except (TypeError, ValueError) as error:
        raise BudgetError(f"{name}: three coordinates, not {point!r}") from error
    return ",".join(repr(number(name, part)) for part in (x, y, z))
