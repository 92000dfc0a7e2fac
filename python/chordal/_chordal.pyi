"""The compiled part of chordal."""

from collections.abc import Callable, Sequence
from typing import Any, Final, TypedDict, final, type_check_only

from chordal._budget import Wanted

__all__ = ["Array", "MOST_BYTES", "Outcome", "Source", "VERSION", "command", "view"]

VERSION: Final[str]
MOST_BYTES: Final[int]

@type_check_only
class Reading(TypedDict):
    name: str | None
    format: str | None
    unit: str | None
    up: str | None
    lenient: bool
    drop_nonfinite: bool

@type_check_only
class Asked(TypedDict):
    relative: float
    absolute: str | None
    max: str | None

@final
class Array:
    @property
    def __array_interface__(self) -> dict[str, Any]: ...

@final
class Source:
    def __new__(cls, bytes: bytes | bytearray, reading: Reading) -> Source: ...
    @staticmethod
    def curves(numbers: bytes | bytearray, shape: tuple[int, int, int], unit: str | None) -> Source: ...
    @staticmethod
    def triangles(numbers: bytes | bytearray, indices: bytes | bytearray, unit: str | None) -> Source: ...
    @property
    def kind(self) -> str: ...
    @property
    def format(self) -> str: ...
    @property
    def name(self) -> str | None: ...
    def inspect(self) -> str: ...
    def deviation(
        self, other: Source | Outcome, asked: Asked, progress: Callable[[str, int, int], object] | None
    ) -> str: ...
    def mesh(
        self, wanted: Wanted, format: str, progress: Callable[[str, int, int], object] | None
    ) -> Outcome: ...

@final
class Outcome:
    @property
    def unmet(self) -> str | None: ...
    @property
    def report(self) -> str: ...
    def array(self, name: str) -> Array: ...
    def deviation(
        self, other: Source | Outcome, asked: Asked, progress: Callable[[str, int, int], object] | None
    ) -> str: ...
    def remake(self, format: str) -> Outcome: ...
    def write(self) -> bytes: ...

def command(args: Sequence[str]) -> int: ...
def view(text: str) -> str: ...
