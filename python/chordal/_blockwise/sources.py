"""Arrays of samples that stay on disk, with the lattice that their files describe.

Each is read by slices along x, y and z, and is pickled as its path: each worker opens it again. Sources: the
specifications of the formats: NumPy's .npy, NIfTI-1, Zarr with OME-NGFF 0.4 and 0.5, and Neuroglancer's precomputed.
"""

from __future__ import annotations

import importlib
import math
import mmap
import os
import secrets
import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Literal

from chordal._arguments import warn
from chordal._blockwise.file_marks import known_of_files
from chordal._blockwise.sampled import FieldSamples
from chordal._images import nibabel_facts
from chordal._units import METRES

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

#: Names of units in files, each with a unit of ours and the factor that converts to it.
_UNITS = {
    "micrometer": ("um", 1.0),
    "nanometer": ("um", 1e-3),
    "angstrom": ("um", 1e-4),
    "millimeter": ("mm", 1.0),
    "centimeter": ("cm", 1.0),
    "meter": ("m", 1.0),
}
#: Micrometres in a nanometre, the unit of precomputed volumes.
_NANOMETRES = 1e-3


@dataclass(frozen=True)
class Placed:
    """Samples that are read by slices, with the affine matrix (3 × 4) and the unit, if the file states them."""

    array: Any
    affine: tuple[tuple[float, ...], ...] | None = None
    unit: str | None = None


def opened(path: str, level: int, channel: int | None) -> Placed:
    """The samples of a file or folder. Raises `OSError` if there are none."""
    if path.endswith((".nii", ".nii.gz")):
        refuse_choice("level", level, "a NIfTI file")
        return _nifti(path, channel)
    if path.endswith(".npy"):
        refuse_choice("level", level, "an .npy file")
        refuse_choice("channel", channel, "an .npy file")
        return Placed(_NpyFile(path))
    if path.startswith("precomputed://") or os.path.isfile(os.path.join(path, "info")):
        return _precomputed(path.removeprefix("precomputed://").removeprefix("file://"), level, channel)
    node = importlib.import_module("zarr").open(path, mode="r")
    if hasattr(node, "dtype"):
        refuse_choice("level", level, "an array of Zarr")
        refuse_choice("channel", channel, "an array of Zarr")
        return Placed(_ZarrArray(path, "", None))
    return _ome(path, node, level, channel)


def _chosen(channel: int | None, count: int, of: str) -> int:
    """The index of the chosen channel or volume. Raises if the choice is missing or out of range."""
    if channel is None and count > 1:
        raise ValueError(f"channel: {of} has {count}, so say which, from 0 to {count - 1}")
    if channel is not None and not 0 <= channel < count:
        raise ValueError(f"channel: {of} has {count}, so from 0 on and below that, not {channel}")
    return channel or 0


def refuse_choice(name: str, value: int | None, of: str) -> None:
    """Raises if a caller chooses among several levels or channels of a source that has only one."""
    if value:
        raise ValueError(f"{name}: {of} has one alone, so 0 and not {value}")


def source_of(array: Any) -> str:
    """A text that identifies samples: their location with the identity of its files, or a digest of all samples in memory."""
    if isinstance(array, (_Opened, FieldSamples)):
        return array.source()
    if not hasattr(array, "__array_interface__"):
        # The name of a Dask array has a digest of its graph.
        return f"{type(array).__name__} {getattr(array, 'name', '')}".strip()
    import hashlib

    import numpy as np

    samples, digest = np.asarray(array), hashlib.sha256()
    for layer in samples:
        digest.update(np.ascontiguousarray(layer).data)
    return digest.hexdigest()


class _Opened:
    """An array that each process opens for itself."""

    shape: tuple[int, ...]
    dtype: np.dtype[Any]

    @property
    def _place(self) -> str:
        """The file or folder, or its address."""
        return str(vars(self)["_path"])

    def source(self) -> str:
        """Its path, its options, and the identity of its files, which changes if they are rewritten."""
        options = {name: value for name, value in vars(self).items() if name not in ("shape", "dtype", "_token")}
        return f"{sorted(options.items())!r} {known_of_files(self._place)}"

    def _array(self) -> Any:
        raise NotImplementedError

    def __getitem__(self, slices: tuple[slice, ...]) -> Any:
        return self._array()[slices]


class _NpyFile(_Opened):
    """The array of an .npy file."""

    def __init__(self, path: str) -> None:
        self._path: Final = os.path.abspath(path)
        array = self._array()
        self.shape, self.dtype = array.shape, array.dtype

    def _array(self) -> Any:
        import numpy as np

        return np.load(self._path, mmap_mode="r")


class _MappedFile(_Opened):
    """An array that is mapped from a file. It is pickled as the position in the file, without the samples."""

    def __init__(self, mapped: np.memmap[Any, Any]) -> None:
        self._path: Final = os.path.abspath(mapped.filename or "")
        self._offset: Final = mapped.offset
        self._order: Final[Literal["C", "F"]] = "C" if mapped.flags.c_contiguous else "F"
        self.shape, self.dtype = mapped.shape, mapped.dtype

    def _array(self) -> Any:
        import numpy as np

        return np.memmap(self._path, self.dtype, "r", self._offset, self.shape, self._order)


def mapped_file(array: Any) -> Any:
    """Replaces an array that numpy has mapped from a file by one that each process maps for itself. Other arrays are returned as
    they are, also a part of a mapped array, and one whose changes stay in memory."""
    import numpy as np

    is_whole = isinstance(array, np.memmap) and isinstance(array.base, mmap.mmap)
    if not is_whole or array.mode == "c" or not isinstance(array.filename, (str, os.PathLike)):
        return array
    return _MappedFile(array)


class _NiftiFile(_Opened):
    """The samples of a volume of a NIfTI file, scaled as in its header. An uncompressed file is read by slices; a compressed one
    is decompressed up to the end of each slice."""

    def __init__(self, path: str, volume: int | None) -> None:
        import numpy as np

        self._path: Final = os.path.abspath(path)
        image = importlib.import_module("nibabel").load(self._path)
        self.shape = tuple(int(n) for n in image.shape[:3])
        is_plain, _ = nibabel_facts(image)
        self.dtype = image.get_data_dtype() if is_plain else np.dtype(np.float64)
        more = tuple(int(n) for n in image.shape[3:])
        number = _chosen(volume, math.prod(more), "the file")
        # Volumes are numbered as they lie in the file: the fourth axis runs fastest.
        self._more: Final = tuple(int(n) for n in np.unravel_index(number, more, order="F")) if more else ()

    def _array(self) -> Any:
        return importlib.import_module("nibabel").load(self._path).dataobj

    def __getitem__(self, slices: tuple[slice, ...]) -> Any:
        index = (*slices, *self._more)
        return self._array()[index]


def _nifti(path: str, volume: int | None) -> Placed:
    import numpy as np

    image = importlib.import_module("nibabel").load(path)
    _, unit = nibabel_facts(image)
    return Placed(_NiftiFile(path, volume), matrix_rows(np.asarray(image.affine, dtype=np.float64)), unit)


def nibabel_in_file(image: Any, volume: int | None) -> Placed | None:
    """The samples of an image of nibabel that are still in its file and can be read there by slices; None for others."""
    import numpy as np

    if not (hasattr(image, "dataobj") and hasattr(image, "file_map")) or isinstance(image.dataobj, np.ndarray):
        return None
    path = getattr(image.file_map.get("image"), "filename", None)
    if not isinstance(path, str) or not path.endswith(".nii") or not hasattr(image.dataobj, "file_like"):
        return None
    _, unit = nibabel_facts(image)
    return Placed(_NiftiFile(path, volume), matrix_rows(np.asarray(image.affine, dtype=np.float64)), unit)


@dataclass(frozen=True)
class _Axes:
    """The axes of an array that are x, y and z, and the index along each of the others."""

    xyz: tuple[int, int, int]
    others: tuple[tuple[int, int], ...]

    def of(self, slices: Sequence[slice]) -> tuple[slice | int, ...]:
        """The index into the array for slices along x, y and z."""
        indices: list[slice | int] = [0] * (3 + len(self.others))
        for axis, index in self.others:
            indices[axis] = index
        for axis, part in zip(self.xyz, slices, strict=True):
            indices[axis] = part
        return tuple(indices)

    def turned(self, samples: NDArray[Any]) -> NDArray[Any]:
        """Samples that were read, with their axes in the order x, y, z."""
        order = sorted(self.xyz)
        return samples.transpose([order.index(axis) for axis in self.xyz])


#: The arrays that this process has opened, by the tokens of their volumes: opening an array takes as long as reading a chunk.
#: They are not found by path, since another volume may be written there later. A few, since tasks are about one or two.
_opened_here: dict[str, Any] = {}
_MOST_OPENED = 8
_lock = threading.Lock()


def _once(token: str, open_it: Callable[[], Any]) -> Any:
    """An array that is opened once in each process."""
    with _lock:
        array = _opened_here.get(token)
        if array is None:
            # A dictionary keeps the order of insertion, so the array that was opened first goes.
            while len(_opened_here) >= _MOST_OPENED:
                del _opened_here[next(iter(_opened_here))]
            array = _opened_here[token] = open_it()
    return array


class _ZarrArray(_Opened):
    """An array of Zarr: the one at the path, or the one with a name in the group there."""

    def __init__(self, path: str, name: str, axes: _Axes | None) -> None:
        self._path: Final = path if "://" in path else os.path.abspath(path)
        self._name: Final = name
        self._axes: Final = axes
        self._token: Final = secrets.token_hex(16)
        array = self._array()
        shape = tuple(int(n) for n in array.shape)
        self.shape = shape if axes is None else tuple(shape[axis] for axis in axes.xyz)
        self.dtype = array.dtype

    def _array(self) -> Any:
        zarr = importlib.import_module("zarr")
        if self._name:
            return _once(self._token, lambda: zarr.open_group(self._path, mode="r")[self._name])
        return _once(self._token, lambda: zarr.open_array(self._path, mode="r"))

    def __getitem__(self, slices: tuple[slice, ...]) -> Any:
        if self._axes is None:
            return self._array()[slices]
        return self._axes.turned(self._array()[self._axes.of(slices)])


def _ome(path: str, group: Any, level: int, channel: int | None) -> Placed:
    """A level of an OME-Zarr pyramid, with its scale and translation and its axes by name."""
    import numpy as np

    facts = dict(group.attrs)
    images = facts.get("ome", facts).get("multiscales")
    if not images:
        raise ValueError(f"{path}: a Zarr group that is no OME-Zarr image; name one of its arrays, as in {path}/0")
    image = images[0]
    levels = image["datasets"]
    if not 0 <= level < len(levels):
        raise ValueError(f"level: {path} has the levels 0 to {len(levels) - 1}, not {level}")
    axes = [_axis(axis) for axis in image["axes"]]
    names = [name for name, _, _ in axes]
    if not {"x", "y", "z"} <= set(names):
        raise ValueError(f"{path}: the axes {', '.join(names)} are not those of a volume")
    xyz = (names.index("x"), names.index("y"), names.index("z"))
    sizes = {name: int(group[levels[level]["path"]].shape[at]) for at, name in enumerate(names)}
    channel_index = _chosen(channel, sizes.get("c", 1), "the image")
    if any(size > 1 for name, size in sizes.items() if name not in ("x", "y", "z", "c")):
        warn(f"{path}: the first along {', '.join(name for name in names if name not in ('x', 'y', 'z', 'c'))} is taken")
    others = tuple((at, channel_index if name == "c" else 0) for at, name in enumerate(names) if name not in ("x", "y", "z"))
    instead = f"name an array, as in {path}/{levels[level]['path']}"
    steps, first = np.ones(len(names)), np.zeros(len(names))
    # In the order of OME-NGFF: those of the level, then those of all levels. A scale applies to the translations before it,
    # too.
    for transform in [*levels[level].get("coordinateTransformations", []), *image.get("coordinateTransformations", [])]:
        kind = transform.get("type")
        if kind == "scale" and kind in transform:
            steps, first = steps * transform[kind], first * transform[kind]
        elif kind == "translation" and kind in transform:
            first = first + transform[kind]
        elif kind != "identity":
            raise ValueError(f"{path}: a transformation of the type {kind!r} is not read; {instead}, and say affine=")
    units = [_UNITS.get(axes[at][2] or "") for at in xyz]
    known_units = [known for known in units if known is not None]
    unit, factors = None, [1.0] * 3
    if len(known_units) == len(units):
        # Axes with different units are all converted to micrometres.
        is_same = len({name for name, _ in known_units}) == 1
        unit = known_units[0][0] if is_same else "um"
        factors = [factor if is_same else factor * float(METRES[name] / METRES["um"]) for name, factor in known_units]
    elif known_units or len({axes[at][2] for at in xyz}) > 1:
        raise ValueError(f"{path}: the units of the axes are not all known; {instead}, and say spacing=")
    factor_of_axis = zip(xyz, factors, strict=True)
    lattice = [(steps[at] * factor, first[at] * factor) for at, factor in factor_of_axis]
    array = _ZarrArray(path, levels[level]["path"], _Axes(xyz, others))
    return Placed(array, _diagonal([step for step, _ in lattice], [origin for _, origin in lattice]), unit)


def _axis(axis: str | Mapping[str, Any]) -> tuple[str, str | None, str | None]:
    """The name, type and unit of an axis."""
    return (axis, None, None) if isinstance(axis, str) else (axis["name"], axis.get("type"), axis.get("unit"))


def _tensorstore(path: str, level: int) -> Any:
    tensorstore = importlib.import_module("tensorstore")
    kvstore = path if "://" in path else {"driver": "file", "path": path}
    spec = {"driver": "neuroglancer_precomputed", "kvstore": kvstore, "scale_index": level}
    return tensorstore.open(spec, open=True, read=True).result()


class _Precomputed(_Opened):
    """A scale of a precomputed volume."""

    def __init__(self, path: str, level: int, channel: int | None) -> None:
        self._path: Final = path if "://" in path else os.path.abspath(path)
        self._level: Final = level
        self._token: Final = secrets.token_hex(16)
        array = self._array()
        self._first: Final = tuple(int(at) for at in array.domain.inclusive_min[:3])
        self.shape = tuple(int(n) for n in array.shape[:3])
        self.dtype = array.dtype.numpy_dtype
        self._channel: Final = _chosen(channel, int(array.shape[3]), "the volume")

    def _array(self) -> Any:
        return _once(self._token, lambda: _tensorstore(self._path, self._level))

    def __getitem__(self, slices: tuple[slice, ...]) -> Any:
        # The domain of a precomputed volume need not begin at 0.
        shifted = [slice(part.start + at, part.stop + at) for part, at in zip(slices, self._first, strict=True)]
        index = (*shifted, self._channel)
        return self._array()[index].read().result()


def _precomputed(path: str, level: int, channel: int | None) -> Placed:
    array = _Precomputed(path, level, channel)
    store = array._array()
    steps = [float(unit.multiplier) * _NANOMETRES for unit in store.dimension_units[:3]]
    first = [step * at for step, at in zip(steps, array._first, strict=True)]
    return Placed(array, _diagonal(steps, first), "um")


def _diagonal(steps: Sequence[float], first: Sequence[float]) -> tuple[tuple[float, ...], ...]:
    rows = [[0.0, 0.0, 0.0, float(at)] for at in first]
    for axis, step in enumerate(steps):
        rows[axis][axis] = float(step)
    return tuple(tuple(row) for row in rows)


def matrix_rows(affine: NDArray[np.float64]) -> tuple[tuple[float, ...], ...]:
    """The first three rows of an affine matrix, as tuples that can be compared and pickled."""
    return tuple(tuple(float(x) for x in row) for row in affine[:3])
