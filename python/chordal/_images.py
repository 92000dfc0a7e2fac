"""Conversion of volumes from and to images of other libraries. Libraries are imported only for conversions to them: their
objects are recognized by their attributes.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from chordal._arguments import warn

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Lattice:
    """Samples, the matrix that maps their indices to space, and the unit of space."""

    array: Any
    affine: NDArray[np.float64]
    unit: str | None


def lattice_of(thing: Any) -> Lattice | None:
    """The lattice of an image of another library; None for anything else."""
    return next((read(thing) for is_of_library, read in _KNOWN if is_of_library(thing)), None)


def lattice_like(thing: Any) -> bool:
    """Whether an object is an image of another library."""
    return any(is_of_library(thing) for is_of_library, _ in _KNOWN)


def _has(*names: str) -> Callable[[Any], bool]:
    return lambda thing: all(hasattr(thing, name) for name in names)


def _of_nibabel(image: Any) -> Lattice:
    import numpy as np

    is_plain, unit = nibabel_facts(image)
    array = np.asarray(image.dataobj) if is_plain else image.get_fdata(dtype=np.float64)
    return Lattice(array, np.asarray(image.affine, dtype=np.float64), unit)


def nibabel_facts(image: Any) -> tuple[bool, str | None]:
    """Whether the stored numbers are the values, without a scale; and the unit of the coordinates."""
    # The scale is an attribute of the data object, since the header of a file no longer has it once it is read. An image from an
    # array has none.
    slope, inter = getattr(image.dataobj, "slope", 1), getattr(image.dataobj, "inter", 0)
    unit = None
    if hasattr(image.header, "get_xyzt_units"):
        unit = {"mm": "mm", "meter": "m", "micron": "um"}.get(image.header.get_xyzt_units()[0])
    return slope in (None, 1) and inter in (None, 0), unit


def _of_simpleitk(image: Any) -> Lattice:
    import numpy as np

    if image.GetDimension() != 3:
        raise ValueError(f"array: an image of three axes, not {image.GetDimension()}")
    SimpleITK = importlib.import_module("SimpleITK")

    array = SimpleITK.GetArrayViewFromImage(image)
    affine = np.eye(4)
    # The columns of the matrix are directions of unit length; each is multiplied by its spacing.
    affine[:3, :3] = np.reshape(image.GetDirection(), (3, 3)) * np.asarray(image.GetSpacing())
    affine[:3, 3] = image.GetOrigin()
    # Arrays of SimpleITK have z first.
    return Lattice(array.transpose(2, 1, 0), affine, "mm")


def _of_xarray(data: Any) -> Lattice:
    import numpy as np

    if len(data.dims) != 3:
        raise ValueError(f"array: a DataArray of three dimensions, not {len(data.dims)}")
    names = ("x", "y", "z") if set(data.dims) == {"x", "y", "z"} else tuple(data.dims)
    affine = np.eye(4)
    for axis, name in enumerate(names):
        if name not in data.coords:
            continue
        places = np.asarray(data.coords[name].values, dtype=np.float64)
        steps = np.diff(places)
        if len(steps) and not np.allclose(steps, steps[0], rtol=1e-6, atol=0):
            raise ValueError(f"array: the coordinates along {name!r} are not evenly spaced")
        affine[axis, 3] = places[0]
        affine[axis, axis] = (places[-1] - places[0]) / len(steps) if len(steps) else 1.0
    units = {str(data.coords[name].attrs.get("units")) for name in names if name in data.coords}
    known_units = {"um", "mm", "cm", "m", "km", "in", "ft"}
    transposed = data.transpose(*names)
    # `data` keeps a Dask array as it is, while `values` would load it.
    values = transposed.data if hasattr(transposed, "data") else transposed.values
    return Lattice(values, affine, units.pop() if len(units) == 1 and units <= known_units else None)


def _of_vtk(image: Any) -> Lattice:
    """The lattice of an image of VTK or PyVista. Indices are relative to the start of its extent."""
    import numpy as np

    values = _scalars_of_vtk(image)
    shape = tuple(int(side) for side in image.GetDimensions())
    # There is one cell less than points along each axis, and scalars of cells are samples at their centres.
    is_of_cells = len(values) != int(np.prod(shape))
    if is_of_cells:
        shape = tuple(max(side - 1, 1) for side in shape)
    if np.ndim(values) != 1 or len(values) != int(np.prod(shape)):
        raise ValueError(f"array: one number for each point, not scalars of shape {np.shape(values)}")
    matrix = image.GetIndexToPhysicalMatrix()
    affine = np.array([[matrix.GetElement(row, column) for column in range(4)] for row in range(4)])
    first = np.asarray(image.GetExtent()[::2]) + (0.5 if is_of_cells else 0.0)
    affine[:3, 3] = affine[:3, 3] + affine[:3, :3] @ first
    return Lattice(np.asarray(values).reshape(shape, order="F"), affine, None)


def _scalars_of_vtk(image: Any) -> NDArray[Any]:
    """The active scalars: PyVista's own choice, else those of points, else those of cells."""
    import numpy as np

    if hasattr(image, "active_scalars"):
        values = image.active_scalars
    else:
        scalars = image.GetPointData().GetScalars() or image.GetCellData().GetScalars()
        values = None if scalars is None else importlib.import_module("vtkmodules.util.numpy_support").vtk_to_numpy(scalars)
    if values is None:
        raise ValueError("array: this image has no active scalars")
    scalars_array: NDArray[Any] = np.asarray(values)
    return scalars_array


_KNOWN: tuple[tuple[Callable[[Any], bool], Callable[[Any], Lattice]], ...] = (
    (_has("dataobj", "affine"), _of_nibabel),
    (_has("GetDirection", "GetSpacing", "GetOrigin"), _of_simpleitk),
    (_has("GetExtent", "GetIndexToPhysicalMatrix", "GetPointData"), _of_vtk),
    (_has("dims", "coords", "values"), _of_xarray),
)


class Imaged:
    """Conversions of a volume to images of other libraries."""

    __slots__ = ()
    array: Any
    affine: Any
    unit: Any

    def to_nibabel(self) -> Any:
        """An image of nibabel, with the matrix of this volume, and its unit if NIfTI has it."""
        nibabel = importlib.import_module("nibabel")
        import numpy as np

        array = self.array
        # NIfTI-1 has 64-bit integers, but nibabel wants the type to be stated for them.
        image = nibabel.Nifti1Image(np.asarray(array), self.affine, dtype=array.dtype)
        name = {"mm": "mm", "m": "meter", "um": "micron"}.get(self.unit)
        if name is not None:
            image.header.set_xyzt_units(name)
        elif self.unit is not None:
            warn(f"unit: NIfTI has mm, m and um, and not {self.unit}: its numbers stay, and their unit is not said")
        return image

    def to_simpleitk(self) -> Any:
        """An image of SimpleITK. Raises `ValueError` if the axes are not orthogonal, which SimpleITK cannot represent."""
        import numpy as np
        SimpleITK = importlib.import_module("SimpleITK")

        steps = self.affine[:3, :3]
        # The other way round: the length of each column is the spacing.
        spacing = np.linalg.norm(steps, axis=0)
        direction = steps / spacing
        if not np.allclose(direction.T @ direction, np.eye(3), atol=1e-6):
            raise ValueError("the axes are not at right angles, and SimpleITK has no others")
        image = SimpleITK.GetImageFromArray(np.ascontiguousarray(self.array.transpose(2, 1, 0)))
        image.SetSpacing(spacing.tolist())
        image.SetOrigin(self.affine[:3, 3].tolist())
        image.SetDirection(direction.ravel().tolist())
        return image

    def to_pyvista(self) -> Any:
        """A `pyvista.ImageData` with a copy of the samples as point data "values"."""
        pyvista = importlib.import_module("pyvista")
        import numpy as np

        image = pyvista.ImageData(dimensions=self.array.shape)
        image.index_to_physical_matrix = np.array(self.affine)
        image.point_data["values"] = self.array.ravel(order="F")
        image.set_active_scalars("values")
        return image

    def to_xarray(self) -> Any:
        """A DataArray of xarray along x, y and z. Raises `ValueError` if the axes are rotated, which xarray cannot represent."""
        import numpy as np
        xarray = importlib.import_module("xarray")

        steps = self.affine[:3, :3]
        if np.any(steps != np.diag(np.diag(steps))):
            raise ValueError("the axes are not those of space, and coordinates along dimensions cannot say that")
        attributes = {} if self.unit is None else {"units": self.unit}
        coords = {
            name: (name, self.affine[axis, 3] + steps[axis, axis] * np.arange(self.array.shape[axis]), attributes)
            for axis, name in enumerate("xyz")
        }
        return xarray.DataArray(self.array, dims=("x", "y", "z"), coords=coords)
