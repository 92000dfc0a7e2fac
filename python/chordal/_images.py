"""Images of other libraries as volumes, and volumes as theirs. Nothing of these libraries is imported before it is asked
for: an object is known by what it says of itself.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from chordal._arguments import warn
from chordal._libraries import library

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Lattice:
    """Samples, the matrix that takes their indices to space, and the unit of that."""

    array: Any
    affine: NDArray[np.float64]
    unit: str | None


def lattice_of(thing: Any) -> Lattice | None:
    """What an image of another library says; None for anything else."""
    return next((read(thing) for is_one, read in _KNOWN if is_one(thing)), None)


def lattice_like(thing: Any) -> bool:
    """Whether it is an image of another library."""
    return any(is_one(thing) for is_one, _ in _KNOWN)


def _has(*names: str) -> Callable[[Any], bool]:
    return lambda thing: all(hasattr(thing, name) for name in names)


def _of_nibabel(image: Any) -> Lattice:
    import numpy as np

    is_plain, unit = nibabel_facts(image)
    array = np.asarray(image.dataobj) if is_plain else image.get_fdata(dtype=np.float64)
    return Lattice(array, np.asarray(image.affine, dtype=np.float64), unit)


def nibabel_facts(image: Any) -> tuple[bool, str | None]:
    """Whether its numbers are meant as they are stored, since nothing scales them; and the unit of its coordinates."""
    # A header that was read has lost these; an image that was made of an array has none.
    slope, inter = getattr(image.dataobj, "slope", 1), getattr(image.dataobj, "inter", 0)
    unit = None
    if hasattr(image.header, "get_xyzt_units"):
        unit = {"mm": "mm", "meter": "m", "micron": "um"}.get(image.header.get_xyzt_units()[0])
    return slope in (None, 1) and inter in (None, 0), unit


def _of_simpleitk(image: Any) -> Lattice:
    import numpy as np

    if image.GetDimension() != 3:
        raise ValueError(f"array: an image of three axes, not {image.GetDimension()}")
    SimpleITK = library("SimpleITK")

    array = SimpleITK.GetArrayViewFromImage(image)
    affine = np.eye(4)
    affine[:3, :3] = np.reshape(image.GetDirection(), (3, 3)) * np.asarray(image.GetSpacing())
    affine[:3, 3] = image.GetOrigin()
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
    known = {"um", "mm", "cm", "m", "km", "in", "ft"}
    turned = data.transpose(*names)
    # An array of Dask stays one.
    values = turned.data if hasattr(turned, "data") else turned.values
    return Lattice(values, affine, units.pop() if len(units) == 1 and units <= known else None)


def _of_vtk(image: Any) -> Lattice:
    """An image of VTK, which PyVista's are, too: its samples are counted from where its extent begins."""
    import numpy as np

    values = _scalars_of_vtk(image)
    shape = tuple(int(side) for side in image.GetDimensions())
    # Scalars of cells are one less along each axis, and stand at their middles.
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
    """The active scalars of points, else of cells; of PyVista's those that it calls active."""
    import numpy as np

    if hasattr(image, "active_scalars"):
        values = image.active_scalars
    else:
        scalars = image.GetPointData().GetScalars() or image.GetCellData().GetScalars()
        values = None if scalars is None else library("vtkmodules.util.numpy_support").vtk_to_numpy(scalars)
    if values is None:
        raise ValueError("array: this image has no active scalars")
    found: NDArray[Any] = np.asarray(values)
    return found


_KNOWN: tuple[tuple[Callable[[Any], bool], Callable[[Any], Lattice]], ...] = (
    (_has("dataobj", "affine"), _of_nibabel),
    (_has("GetDirection", "GetSpacing", "GetOrigin"), _of_simpleitk),
    (_has("GetExtent", "GetIndexToPhysicalMatrix", "GetPointData"), _of_vtk),
    (_has("dims", "coords", "values"), _of_xarray),
)


class Imaged:
    """A volume as an image of another library."""

    __slots__ = ()
    array: Any
    affine: Any
    unit: Any

    def to_nibabel(self) -> Any:
        """An image of nibabel, with this volume's matrix as it is, and its unit where NIfTI has it."""
        nibabel = library("nibabel")
        import numpy as np

        array = self.array
        # NIfTI-1 has these, and nibabel asks for 64-bit integers to be meant.
        image = nibabel.Nifti1Image(np.asarray(array), self.affine, dtype=array.dtype)
        name = {"mm": "mm", "m": "meter", "um": "micron"}.get(self.unit)
        if name is not None:
            image.header.set_xyzt_units(name)
        elif self.unit is not None:
            warn(f"unit: NIfTI has mm, m and um, and not {self.unit}: its numbers stay, and their unit is not said")
        return image

    def to_simpleitk(self) -> Any:
        """An image of SimpleITK. Raises `ValueError` where the axes are not at right angles, which it cannot say."""
        import numpy as np
        SimpleITK = library("SimpleITK")

        steps = self.affine[:3, :3]
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
        """A `pyvista.ImageData` with the samples as point data "values". Its scalars are a copy."""
        pyvista = library("pyvista")
        import numpy as np

        made = pyvista.ImageData(dimensions=self.array.shape)
        made.index_to_physical_matrix = np.array(self.affine)
        made.point_data["values"] = self.array.ravel(order="F")
        made.set_active_scalars("values")
        return made

    def to_xarray(self) -> Any:
        """A DataArray of xarray along x, y and z. Raises `ValueError` where the axes are turned, which it cannot say."""
        import numpy as np
        xarray = library("xarray")

        steps = self.affine[:3, :3]
        if np.any(steps != np.diag(np.diag(steps))):
            raise ValueError("the axes are not those of space, and coordinates along dimensions cannot say that")
        told = {} if self.unit is None else {"units": self.unit}
        coords = {
            name: (name, self.affine[axis, 3] + steps[axis, axis] * np.arange(self.array.shape[axis]), told)
            for axis, name in enumerate("xyz")
        }
        return xarray.DataArray(self.array, dims=("x", "y", "z"), coords=coords)
