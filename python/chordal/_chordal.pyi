"""The compiled part of chordal."""

from collections.abc import Callable, Sequence
from typing import Any, Final, TypedDict, final, type_check_only

from chordal._budget import BudgetArguments

__all__ = ["Array", "Cage", "MOST_BYTES", "Outcome", "ScriptValue", "Source", "VERSION", "combine", "command", "language", "script", "view"]

VERSION: Final[str]
MOST_BYTES: Final[int]

@type_check_only
class Reading(TypedDict):
    name: str | None
    format: str | None
    unit: str | None
    up: str | None
    strict: bool
    lenient: bool
    drop_nonfinite: bool
    surface: str | None

@type_check_only
class Tags(TypedDict):
    creases: Sequence[tuple[int, int, float]]
    corners: Sequence[tuple[int, float]]
    holes: Sequence[int]
    scheme: str
    boundary: str
    creasing: str

@type_check_only
class DeviationArguments(TypedDict):
    relative: float
    absolute: str | None
    max: str | None

@type_check_only
class BakeArguments(TypedDict):
    cells: int | None
    length: tuple[str, str] | None
    band: float | None
    bound: bool

@type_check_only
class Meant(TypedDict):
    iso: float | None
    inside: str | None
    border: str
    labels: Sequence[int] | None
    smooth: str | None

@final
class Array:
    @property
    def __array_interface__(self) -> dict[str, Any]: ...

@final
class Cage:
    def __new__(
        cls, numbers: bytes | bytearray, indices: bytes | bytearray, ends: bytes | bytearray, tags: Tags
    ) -> Cage: ...
    def refined(self, levels: int) -> Cage: ...
    def array(self, name: str) -> Array: ...
    @property
    def creases(self) -> list[tuple[int, int, float]]: ...
    @property
    def corners(self) -> list[tuple[int, float]]: ...
    @property
    def holes(self) -> list[int]: ...
    @property
    def rules(self) -> tuple[str, str, str]: ...
    def source(self, unit: str | None) -> Source: ...

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
        self, other: Source | Outcome, arguments: DeviationArguments, progress: Callable[[str, int, int], object] | None
    ) -> str: ...
    def surface(self, meant: Meant) -> Source: ...
    def cage(self) -> Cage: ...
    def bake(self, arguments: BakeArguments) -> tuple[Source, str, str | None]: ...
    def mesh(
        self, arguments: BudgetArguments, format: str, progress: Callable[[str, int, int], object] | None
    ) -> Outcome: ...

@final
class Outcome:
    @property
    def unmet(self) -> str | None: ...
    @property
    def report(self) -> str: ...
    def array(self, name: str) -> Array: ...
    def deviation(
        self, other: Source | Outcome, arguments: DeviationArguments, progress: Callable[[str, int, int], object] | None
    ) -> str: ...
    def bake(self, arguments: BakeArguments) -> tuple[Source, str, str | None]: ...
    def remake(self, format: str, quantize: bool, compress: str | None) -> Outcome: ...
    def write(self) -> bytes: ...
    @property
    def names_files(self) -> bool: ...
    def write_files(self, stem: str) -> tuple[bytes, list[tuple[str, bytes]]]: ...

@final
class ScriptValue:
    @staticmethod
    def call(name: str, *args: Any, **named: Any) -> ScriptValue | float: ...
    @staticmethod
    def operate(operator: str, a: Any, b: Any) -> ScriptValue | float | None: ...
    @staticmethod
    def axis(k: int) -> ScriptValue: ...
    @staticmethod
    def callable(
        call: Callable[[bytes], bytes],
        gradient: Callable[[bytes], bytes] | None,
        bounds: Sequence[Sequence[float]] | None,
        lipschitz: float | None,
    ) -> ScriptValue: ...
    @property
    def is_shape(self) -> bool: ...
    @property
    def distance(self) -> tuple[str, str]: ...
    @property
    def evidence(self) -> tuple[str, list[str]]: ...
    @property
    def bounds(self) -> list[list[float]]: ...
    @property
    def terms(self) -> int: ...
    def values(self, points: bytes | bytearray) -> bytes: ...
    def gradients(self, points: bytes | bytearray) -> bytes: ...
    def source(self, region: Sequence[Sequence[float]] | None) -> Source: ...

def combine(
    first: Source | Outcome,
    others: list[tuple[str, Source | Outcome]],
    arguments: BudgetArguments,
    format: str,
    progress: Callable[[str, int, int], object] | None,
) -> Outcome: ...
def language() -> list[tuple[str, str, str, str]]: ...
def script(
    text: str, set: Sequence[tuple[str, float]]
) -> tuple[ScriptValue, list[tuple[str, float, float]], list[tuple[int, str]]]: ...
def command(args: Sequence[str]) -> int: ...
def view(text: str) -> str: ...
