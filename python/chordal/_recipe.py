"""Recipes, by which shapes are pickled and rebuilt in another process.

A recipe is a function of this package with its arguments, which may be shapes with recipes of their own. A shape is
pickled as a list of all recipes, each once and after those that it depends on, so that a shape of ten thousand steps
needs no deep recursion.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

#: A function and its arguments.
Recipe = tuple[Callable[..., Any], tuple[Any, ...], dict[str, Any]]


class Step(NamedTuple):
    """The result of an earlier step, in the arguments of a later one."""

    number: int


class Remakeable:
    """An immutable object with a recipe."""

    __slots__ = ()
    _recipe: Recipe | None

    def __copy__(self) -> Any:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> Any:
        return self

    def __reduce__(self) -> Any:
        return made_again, (steps_of(self),)


def _direct(value: Any) -> list[Any]:
    """The objects with recipes in a value, or in its lists."""
    if isinstance(value, Remakeable):
        return [value]
    if isinstance(value, (list, tuple)):
        return [shape for item in value for shape in _direct(item)]
    return []


def steps_of(last: Remakeable) -> list[Recipe]:
    """All steps to a shape in topological order: each after those that it depends on, and the shape itself last."""
    numbers: dict[int, int] = {}
    steps: list[Recipe] = []
    # Depth-first search with a stack: each shape is visited before its operands, and again, ready, after them.
    stack: list[tuple[Any, bool]] = [(last, False)]
    while stack:
        shape, is_ready = stack.pop()
        if id(shape) in numbers:
            continue
        recipe = shape._recipe if isinstance(shape, Remakeable) else None
        if recipe is None:
            if shape is last:
                raise TypeError(f"{type(shape).__name__}: nothing is known of how it was made, so it cannot be pickled")
            continue
        function, args, named = recipe
        operands = _direct(list(args)) + _direct(list(named.values()))
        if is_ready:
            numbers[id(shape)] = len(steps)
            steps.append((function, _numbered(args, numbers), {k: _numbered(v, numbers) for k, v in named.items()}))
        else:
            stack.append((shape, True))
            stack += [(operand, False) for operand in operands if id(operand) not in numbers]
    return steps


def _numbered(value: Any, numbers: dict[int, int]) -> Any:
    """A value in which shapes are replaced by the numbers of their steps."""
    if isinstance(value, Remakeable) and id(value) in numbers:
        return Step(numbers[id(value)])
    if type(value) in (list, tuple):
        return type(value)(_numbered(item, numbers) for item in value)
    return value


def made_again(steps: list[Recipe]) -> Any:
    """Runs the steps, and returns the result of the last."""
    results: list[Any] = []

    def filled(value: Any) -> Any:
        if isinstance(value, Step):
            return results[value.number]
        if type(value) in (list, tuple):
            return type(value)(filled(item) for item in value)
        return value

    for function, args, named in steps:
        results.append(function(*filled(args), **{name: filled(value) for name, value in named.items()}))
    return results[-1]
