"""Budgets: keyword arguments to what the compiled part wants."""

from __future__ import annotations

import re
from decimal import Decimal
from fractions import Fraction
from typing import SupportsFloat, SupportsIndex, TypedDict

from chordal._arguments import number, text, whole
from chordal._errors import BudgetError
from chordal._units import VOLUME_METRES
from chordal._view import View

#: A length in units of the shape, or a text with a unit, as in "0.1mm".
Length = SupportsFloat | str
#: A share of the diagonal of the shape's box, as in 0.001, or a text, as in "0.1%".
Share = SupportsFloat | str
#: Seconds, or a text with a unit, as in "20s", "2m" or "500ms".
Time = SupportsFloat | str


class BudgetArguments(TypedDict):
    """A budget as the compiled part takes it."""

    length: tuple[str, str] | None
    pixels: tuple[float, str] | None
    angle_deg: float | None
    uv_error: float | None
    normal_error: float | None
    triangles: int | None
    segments: int | None
    spacing: str
    effort: str | None
    require: str | None
    within: str | None
    extrude: tuple[str, str] | None
    bevel: tuple[str, str] | None


def budget_arguments(
    *,
    tol: Length | None,
    rel: Share | None,
    pixels: SupportsFloat | None,
    view: str | View | None,
    angle: SupportsFloat | None = None,
    uv_error: SupportsFloat | None = None,
    normal_error: SupportsFloat | None = None,
    triangles: SupportsIndex | None = None,
    segments: SupportsIndex | None = None,
    spacing: str = "fewest",
    effort: str | None = None,
    require: str | None = None,
    within: Time | None = None,
    extrude: Length | None = None,
    bevel: Length | None = None,
    counted: str,
    is_needed: bool = True,
) -> BudgetArguments:
    """The budget of these arguments, if they belong together. `counted` names the count that the caller has; without
    `is_needed` there may be none of them."""
    if tol is not None and rel is not None:
        raise BudgetError("tol, rel: give one of them, they are both a length")
    found: BudgetArguments = {
        "length": _tol(tol) or _rel(rel),
        "pixels": _pixels(pixels, view),
        "angle_deg": None if angle is None else number("angle", angle),
        "uv_error": None if uv_error is None else number("uv_error", uv_error),
        "normal_error": None if normal_error is None else number("normal_error", normal_error),
        "triangles": None if triangles is None else whole("triangles", triangles),
        "segments": None if segments is None else whole("segments", segments),
        "spacing": text("spacing", spacing) or "",
        "effort": text("effort", effort),
        "require": None if require is None else text("require", require),
        "within": None if within is None else _time("within", within),
        "extrude": None if extrude is None else ("extrude", length("extrude", extrude)),
        "bevel": None if bevel is None else ("bevel", length("bevel", bevel)),
    }
    if is_needed and not (found["length"] or found["pixels"] or found["triangles"] or found["segments"]):
        raise BudgetError(
            "a budget is needed: tol=0.1 in units, rel=0.001 of the diagonal, "
            f'pixels=1 with view="1920x1080 fov=45 dist=4", or {counted}=5000'
        )
    return found


#: What needs no limit.
NO_BUDGET: BudgetArguments = {
    "length": None,
    "pixels": None,
    "angle_deg": None,
    "uv_error": None,
    "normal_error": None,
    "triangles": None,
    "segments": None,
    "spacing": "fewest",
    "effort": None,
    "require": None,
    "within": None,
    "extrude": None,
    "bevel": None,
}


def length(name: str, value: Length) -> str:
    """A length as the command reads it."""
    return value if isinstance(value, str) else repr(number(name, value))


def length_in(name: str, value: Length, unit: str | None) -> float:
    """A length as a number in that unit, for what is not read as a whole: of its diagonal nothing is known."""
    if not isinstance(value, str):
        return number(name, value)
    said = re.fullmatch(r"\s*([0-9.eE+-]+)\s*([a-z]*)\s*", value)
    try:
        count = Decimal(said[1]) if said else None
    except ArithmeticError:
        count = None
    if said is None or count is None or said[2] not in ("", *VOLUME_METRES):
        raise BudgetError(f"{name}: a length in units, or a text as in '0.1mm', not {value!r}")
    if not said[2]:
        return float(count)
    if unit is None:
        raise BudgetError(f"{name}: nothing says the unit of the volume, which {value!r} needs: unit=\"mm\" does")
    return float(Fraction(count) * VOLUME_METRES[said[2]] / VOLUME_METRES[unit])


def _time(name: str, value: Time) -> str:
    """A time as the command reads it."""
    return value if isinstance(value, str) else f"{number(name, value)!r}s"


def _tol(tol: Length | None) -> tuple[str, str] | None:
    if tol is None:
        return None
    return "tol", length("tol", tol)


def _rel(rel: Share | None) -> tuple[str, str] | None:
    if rel is None:
        return None
    if not isinstance(rel, str):
        # In decimals, so that 0.001 is the same as "0.1%" to the last bit.
        return "rel", f"{Decimal(repr(number('rel', rel))) * 100}%"
    if not rel.strip().endswith("%"):
        raise BudgetError(f"rel: a share of the diagonal, as in 0.001 or '0.1%', not '{rel}'")
    return "rel", rel


def _pixels(pixels: SupportsFloat | None, view: str | View | None) -> tuple[float, str] | None:
    if pixels is None and view is None:
        return None
    if pixels is None:
        raise BudgetError("view: it is for a budget in pixels; add pixels=1")
    if view is None:
        raise BudgetError('pixels: say from where they are seen, as in view="1920x1080 fov=45 dist=4"')
    return number("pixels", pixels), str(view if isinstance(view, View) else View(view))
