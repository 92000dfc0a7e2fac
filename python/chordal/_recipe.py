"""How a shape came about, so that it can be made again in another process: what `pickle` and `copy` do with shapes.

A recipe is a function of this package with its arguments. Those may be shapes with recipes of their own: all of them
together are written as a list, each once and after what it is made of, so that a shape of ten thousand steps takes no deep
stack.
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
    """What has a recipe and does not change."""

    __slots__ = ()
    _recipe: Recipe | None

    def __copy__(self) -> Any:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> Any:
        return self

    def __reduce__(self) -> Any:
        return made_again, (steps_of(self),)


def _direct(value: Any) -> list[Any]:
    """What has recipes in a value and its lists."""
    if isinstance(value, Remakeable):
        return [value]
    if isinstance(value, (list, tuple)):
        return [found for item in value for found in _direct(item)]
    return []


def steps_of(last: Remakeable) -> list[Recipe]:
    """All steps to a shape, each after those that it takes; the last of them gives the shape."""
    numbers: dict[int, int] = {}
    steps: list[Recipe] = []
    waiting: list[tuple[Any, bool]] = [(last, False)]
    while waiting:
        one, is_ready = waiting.pop()
        if id(one) in numbers:
            continue
        recipe = one._recipe if isinstance(one, Remakeable) else None
        if recipe is None:
            if one is last:
                raise TypeError(f"{type(one).__name__}: nothing is known of how it was made, so it cannot be pickled")
            continue
        function, args, named = recipe
        needed = _direct(list(args)) + _direct(list(named.values()))
        if is_ready:
            numbers[id(one)] = len(steps)
            steps.append((function, _numbered(args, numbers), {k: _numbered(v, numbers) for k, v in named.items()}))
        else:
            waiting.append((one, True))
            waiting += [(other, False) for other in needed if id(other) not in numbers]
    return steps


def _numbered(value: Any, numbers: dict[int, int]) -> Any:
    """A value with steps in place of shapes."""
    if isinstance(value, Remakeable) and id(value) in numbers:
        return Step(numbers[id(value)])
    if type(value) in (list, tuple):
        return type(value)(_numbered(item, numbers) for item in value)
    return value


def made_again(steps: list[Recipe]) -> Any:
    """What such steps lead to."""
    made: list[Any] = []

    def filled(value: Any) -> Any:
        if isinstance(value, Step):
            return made[value.number]
        if type(value) in (list, tuple):
            return type(value)(filled(item) for item in value)
        return value

    for function, args, named in steps:
        made.append(function(*filled(args), **{name: filled(value) for name, value in named.items()}))
    return made[-1]
