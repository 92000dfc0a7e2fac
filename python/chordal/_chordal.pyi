"""The compiled part of chordal."""

from collections.abc import Callable, Sequence
from typing import Any, Final, TypedDict, final, type_check_only

from chordal._blockwise.packing import BoundState, TileEntry
from chordal._budget import BudgetArguments

__all__ = [
    "Array", "Block", "BlockPart", "Cage", "Conversion", "Levels", "MOST_BYTES", "Outcome", "Picture", "ScriptValue", "Source",
    "VERSION", "block", "combine", "command", "convert", "drawing_field", "extruded", "field_of", "fit", "join_parts", "joined",
    "label_blocks", "label_parts", "language", "levels", "mend", "mesh_field", "part", "path_at", "path_facts", "path_source",
    "picture", "revolved",
    "samples", "scene_array", "scene_facts", "scene_image", "scene_of_state", "scene_state", "script", "surface", "tileset",
    "to_cubics", "view",
]

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
    letters: tuple[str, float, list[tuple[str, float]]] | None

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

@type_check_only
class FitArguments(TypedDict):
    width: int
    tolerance: float
    closed: bool
    corners: float
    unit: str | None

@type_check_only
class SurfaceArguments(TypedDict):
    shape: tuple[int, int]
    degrees: tuple[int, int]
    knots: tuple[list[float], list[float]] | None
    unit: str | None

@type_check_only
class MendArguments(TypedDict):
    all: bool
    weld: str | None
    drop_duplicates: str | None
    drop_degenerate: bool
    resolve_t_junctions: str | None
    split_nonmanifold: bool
    orient: bool
    fill_holes: int | None
    drop_unused: bool

@type_check_only
class LodArguments(TypedDict):
    pixels: float
    view: str
    nearest: float | None
    length: tuple[str, str] | None
    distances: Sequence[float]
    uv_error: float | None
    normal_error: float | None
    normals: str | None
    errors: str
    tile_triangles: int | None
    merge: bool
    place: str | None
    quantize: bool
    compress: bool

@type_check_only
class PictureArguments(TypedDict):
    show: str
    cull: str
    size: tuple[int, int]
    view: str | None
    pixels: float | None
    length: tuple[str, str] | None
    darkest: str | None

@type_check_only
class BlockArguments(TypedDict):
    iso: float
    inside: str
    capped: list[list[bool]]
    offset: list[int]
    affine: list[list[float]]
    wanted: float | None

@type_check_only
class BoxArguments(TypedDict):
    low: list[int]
    high: list[int]
    goes_on: list[list[bool]]

@type_check_only
class FragmentArguments(TypedDict):
    low: list[int]
    sides: list[int]
    affine: list[list[float]]
    is_halved: bool

@final
class Array:
    @property
    def __array_interface__(self) -> dict[str, Any]: ...

@final
class Block:
    @property
    def n_faces(self) -> int: ...
    def state(self) -> tuple[list[bytes], BoundState | None]: ...
    @staticmethod
    def of_state(blocks: list[bytes], bound: BoundState | None) -> Block: ...

@final
class BlockPart:
    @property
    def n_faces(self) -> int: ...
    @property
    def n_shared(self) -> int: ...
    @property
    def at_most(self) -> float: ...
    def simplified(self, length: float) -> BlockPart: ...
    def rounded(self, origin: tuple[float, float, float]) -> BlockPart: ...
    def tile(self, name: str, metres_per_unit: float | None) -> tuple[bytes, TileEntry]: ...
    def fragment(self, scale: float) -> bytes: ...
    def lattice_fragment(self, place: BoxArguments, within: FragmentArguments) -> tuple[bytes, bytes, int, float]: ...
    def source(self, metres_per_unit: float | None) -> tuple[Source, str]: ...
    def state(self) -> tuple[bytes, BoundState]: ...
    @staticmethod
    def of_state(bytes: bytes, bound: BoundState) -> BlockPart: ...

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
    @property
    def kind(self) -> str: ...
    @staticmethod
    def is_format(name: str) -> bool: ...
    @property
    def kinds(self) -> str: ...
    @property
    def written(self) -> list[str]: ...
    @property
    def format(self) -> str: ...
    @property
    def name(self) -> str | None: ...
    def inspect(self) -> str: ...
    def deviation(
        self, other: Source, arguments: DeviationArguments, progress: Callable[[str, int, int], object] | None
    ) -> str: ...
    def surface(self, meant: Meant) -> Source: ...
    def transformed(
        self, rows: Sequence[Sequence[float]], unit: str | None, interval: tuple[float, float | None]
    ) -> tuple[Source, tuple[float, float | None]]: ...
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
    def source(self) -> Source: ...
    def remake(self, format: str, quantize: bool, compress: str | None) -> Outcome: ...
    def write(self) -> bytes: ...
    @property
    def names_files(self) -> bool: ...
    def write_files(self, stem: str) -> tuple[bytes, list[tuple[str, bytes]]]: ...

@final
class Conversion:
    @property
    def report(self) -> str: ...
    @property
    def names_files(self) -> bool: ...
    def write(self) -> bytes: ...
    def write_files(self, stem: str) -> tuple[bytes, list[tuple[str, bytes]]]: ...

@final
class Levels:
    @property
    def report(self) -> str: ...
    def level(self, number: int) -> tuple[Source, str] | None: ...
    def write(self, format: str) -> bytes: ...
    def tileset(self) -> tuple[bytes, list[tuple[str, bytes]]]: ...

@final
class Picture:
    def array(self) -> Array: ...
    @property
    def report(self) -> str: ...
    @property
    def view(self) -> str: ...
    @property
    def darkest(self) -> float | None: ...
    def write(self, format: str) -> bytes: ...

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
    def notes(self) -> list[str]: ...
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
    first: Source,
    others: list[tuple[str, Source]],
    arguments: BudgetArguments,
    format: str,
    progress: Callable[[str, int, int], object] | None,
) -> Outcome: ...
def block(samples: Source, arguments: BlockArguments) -> Block: ...
def label_blocks(samples: Source, arguments: BlockArguments) -> list[tuple[int, Block]]: ...
def part(
    samples: Source, arguments: BlockArguments, place: BoxArguments, around: tuple[Source, BlockArguments] | None
) -> BlockPart | None: ...
def label_parts(
    samples: Source, arguments: BlockArguments, place: BoxArguments
) -> list[tuple[int, BlockPart]]: ...
def join_parts(parts: Sequence[BlockPart], place: BoxArguments) -> BlockPart: ...
def tileset(
    entries: Sequence[tuple[str, Sequence[float], BoundState, int, Sequence[int]]],
    origin: tuple[float, float, float],
    metres_per_unit: float | None,
) -> bytes: ...
def joined(blocks: Sequence[Block], metres_per_unit: float | None) -> tuple[Source, str]: ...
def convert(
    source: Source, format: str, packing: tuple[bool, str | None], length: tuple[str, str] | None
) -> Conversion: ...
def levels(
    source: Source, arguments: LodArguments, progress: Callable[[str, int, int], object] | None
) -> Levels: ...
def mend(
    source: Source, arguments: MendArguments, format: str, progress: Callable[[str, int, int], object] | None
) -> Outcome: ...
def picture(
    source: Source,
    against: Source | None,
    arguments: PictureArguments,
    progress: Callable[[str, int, int], object] | None,
) -> Picture: ...
def samples(source: Source) -> tuple[Array, list[list[float]]]: ...
def scene_facts(source: Source) -> str: ...
def scene_array(source: Source, part: int | None, name: str, attribute: int | None) -> Array: ...
def scene_image(source: Source, number: int) -> bytes | None: ...
def scene_state(source: Source) -> tuple[str, list[bytes]]: ...
def scene_of_state(text: str, blocks: Sequence[bytes], unit: str | None) -> Source: ...
def field_of(source: Source) -> ScriptValue | None: ...
def mesh_field(source: Source) -> tuple[ScriptValue, Source]: ...
def path_source(value: ScriptValue, unit: str | None) -> Source: ...
def path_facts(source: Source) -> tuple[int, int, int, bool]: ...
def path_at(source: Source, places: bytes | bytearray, order: int) -> bytes: ...
def to_cubics(source: Source, tol: float) -> tuple[Source, str]: ...
def fit(points: bytes | bytearray, how: FitArguments) -> tuple[Source, str]: ...
def drawing_field(source: Source, name: str, tolerance: float) -> ScriptValue: ...
def surface(control: bytes | bytearray, weights: bytes | bytearray, of: SurfaceArguments) -> Source: ...
def revolved(source: Source) -> Source: ...
def extruded(source: Source, along: Sequence[float]) -> Source: ...
def language() -> list[tuple[str, str, str, str]]: ...
def script(
    text: str, set: Sequence[tuple[str, float]]
) -> tuple[ScriptValue, list[tuple[str, float, float]], list[tuple[int, str]]]: ...
def command(args: Sequence[str], program: Sequence[str], bridge: Sequence[str]) -> int: ...
def view(text: str) -> str: ...
