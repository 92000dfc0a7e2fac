"""Shape scripts, read as the Python that their syntax is, with the referee's own words."""

from __future__ import annotations

import ast
import builtins
import math
from collections.abc import Callable
from typing import Any

import numpy as np

from . import combine, words
from . import ranges as r
from .ranges import Value
from .words import EVERYWHERE, SIGN, Function, Solid


class Formula:
    """A formula in x, y and z."""

    def __init__(self, value: Function, weight: int = 1) -> None:
        self.value, self.weight = value, weight

    def __add__(self, other: object) -> Formula:
        return joined(lambda a, b: a + b, self, other)

    def __radd__(self, other: object) -> Formula:
        return joined(lambda a, b: a + b, other, self)

    def __sub__(self, other: object) -> Formula:
        return joined(lambda a, b: a - b, self, other)

    def __rsub__(self, other: object) -> Formula:
        return joined(lambda a, b: a - b, other, self)

    def __mul__(self, other: object) -> Formula:
        # The square is tighter over boxes than a product of two that are not known to be the same.
        if other is self:
            return joined(lambda a, _: r.square(a), self, self)
        return joined(lambda a, b: a * b, self, other)

    def __rmul__(self, other: object) -> Formula:
        return joined(lambda a, b: a * b, other, self)

    def __truediv__(self, other: object) -> Formula:
        return joined(lambda a, b: a / b, self, other)

    def __rtruediv__(self, other: object) -> Formula:
        return joined(lambda a, b: a / b, other, self)

    def __neg__(self) -> Formula:
        return Formula(lambda x, y, z: -self.value(x, y, z), self.weight + 1)

    def __abs__(self) -> Formula:
        return Formula(lambda x, y, z: abs(self.value(x, y, z)), self.weight + 1)


def of_formula(given: object) -> Formula:
    """A formula; a number is one too."""
    if isinstance(given, Formula):
        return given
    number = float(given)  # type: ignore[arg-type]
    return Formula(lambda x, y, z: number)


def joined(operation: Callable[[Value, Value], Value], a: object, b: object) -> Formula:
    """What an operation makes of two."""
    first, second = of_formula(a), of_formula(b)
    value: Function = lambda x, y, z: operation(np.float64(1) * first.value(x, y, z), second.value(x, y, z))
    return Formula(value, first.weight + second.weight + 1)


def of_one(number: Callable[[float], float], values: Callable[[Value], Value]) -> Callable[[Any], Any]:
    """A word that takes a number or a formula."""

    def word(value: Any) -> Any:
        if isinstance(value, Formula):
            return Formula(lambda x, y, z: values(value.value(x, y, z)), value.weight + 4)
        return number(value)

    return word


def of_two(number: Callable[[float, float], float], values: Callable[[Value, Value], Value]) -> Callable[[Any, Any], Any]:
    """A word that takes two of them."""

    def word(a: Any, b: Any) -> Any:
        return joined(values, a, b) if isinstance(a, Formula) or isinstance(b, Formula) else number(a, b)

    return word


def field(formula: object) -> Solid:
    """The points where a formula is negative."""
    made = of_formula(formula)
    return Solid(made.value, SIGN, SIGN, EVERYWHERE, made.weight, (made.value,))


FORMULAS: dict[str, Any] = {
    "x": Formula(lambda x, y, z: x),
    "y": Formula(lambda x, y, z: y),
    "z": Formula(lambda x, y, z: z),
    "pi": math.pi,
    "field": field,
    "sqrt": of_one(math.sqrt, r.sqrt),
    "exp": of_one(math.exp, lambda v: r.rising(v, np.exp)),
    "log": of_one(math.log, lambda v: r.rising(v, np.log, 0.0)),
    "sin": of_one(math.sin, r.sin),
    "cos": of_one(math.cos, r.cos),
    "tan": of_one(math.tan, r.tan),
    "asin": of_one(math.asin, lambda v: r.rising(v, np.arcsin, -1.0, 1.0)),
    "acos": of_one(math.acos, lambda v: -r.rising(v, lambda u: -np.arccos(u), -1.0, 1.0)),
    "atan": of_one(math.atan, lambda v: r.rising(v, np.arctan)),
    "floor": of_one(lambda v: float(math.floor(v)), lambda v: r.rising(v, np.floor)),
    "ceil": of_one(lambda v: float(math.ceil(v)), lambda v: r.rising(v, np.ceil)),
    "radians": lambda degrees: degrees * (math.pi / 180),
    "atan2": of_two(math.atan2, r.atan2),
    "minimum": of_two(min, r.minimum),
    "maximum": of_two(max, r.maximum),
}
#: What a script has of Python itself.
PLAIN = "abs bool enumerate float int len list max min range reversed sum tuple zip True False None".split()


def vocabulary() -> dict[str, Any]:
    """Every word."""
    solids = "sphere box rounded_box cylinder cone capsule torus ellipsoid octahedron tetrahedron plane triangle gyroid"
    flat = "schwarz_p diamond circle rectangle rounded_rectangle segment polygon regular_polygon"
    made = "union intersection difference complement smooth_union smooth_intersection smooth_difference"
    placed = "move rotate_x rotate_y rotate_z rotate scale stretch mirror repeat"
    changed = "offset shell extrude revolve twist bend displace"
    known = {name: getattr(words, name) for name in f"{solids} {flat}".split()}
    known.update({name: getattr(combine, name) for name in f"{made} {placed} {changed}".split()})
    known["prism"] = lambda sides, radius, height: combine.extrude(words.regular_polygon(sides, radius), height)
    known.update({name: getattr(builtins, name) for name in PLAIN if hasattr(builtins, name)})
    return known | FORMULAS


def solid_of(text: str, **parameters: float) -> Solid:
    """The solid that is the value of the last expression of a script."""
    tree = ast.parse(text)
    last = tree.body.pop()
    assert isinstance(last, ast.Expr), "a script ends with an expression"
    names = vocabulary()
    names["param"] = lambda name, default: parameters.get(name, default)
    names["__builtins__"] = {}
    exec(compile(tree, "script", "exec"), names)
    found = eval(compile(ast.Expression(last.value), "script", "eval"), names)
    assert isinstance(found, Solid), "the value of a script is a solid"
    return found
