"""Images of other libraries stand where their files do: an object that is taken, and the file that its library writes of it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import chordal

#: A block in the middle of samples, so that its surface is half a step from its samples on each side.
BLOCK = np.zeros((10, 12, 14), np.float32)
BLOCK[2:6, 3:8, 4:9] = 1
LOW, HIGH = np.array([1.5, 2.5, 3.5]), np.array([5.5, 7.5, 8.5])
#: A step along each axis, and the place of the first sample.
STEPS, FIRST = np.array([0.5, 2.0, 3.0]), np.array([-10.0, 20.0, 31.0])
#: Turned about z, so that i runs along y.
TURN = np.array([(0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)])


def library(name: str) -> Any:
    return pytest.importorskip(name, reason=f"{name} is not installed: its images are not taken")


def box(low: npt.NDArray[np.float64], high: npt.NDArray[np.float64], turn: npt.NDArray[np.float64] | None = None) -> Any:
    """The box of the block between two indices."""
    corners = np.array(np.meshgrid(*zip(low, high, strict=True))).reshape(3, -1) * STEPS[:, None]
    places = (np.eye(3) if turn is None else turn) @ corners + FIRST[:, None]
    return np.array([places.min(axis=1), places.max(axis=1)])


def vtk_image(cells: bool = False) -> Any:
    """An image whose extent begins elsewhere than at 0."""
    vtk = library("vtk")
    numpy_support = library("vtkmodules.util.numpy_support")
    image = vtk.vtkImageData()
    more = 1 if cells else 0
    image.SetExtent(100, 109 + more, -7, 4 + more, 3, 16 + more)
    image.SetSpacing(*STEPS)
    image.SetOrigin(*FIRST)
    scalars = numpy_support.numpy_to_vtk(BLOCK.ravel(order="F"), deep=True)
    scalars.SetName("v")
    (image.GetCellData() if cells else image.GetPointData()).SetScalars(scalars)
    return image


EXTENT = np.array([100.0, -7.0, 3.0])


def of_vtk(path: Path) -> tuple[Any, Path, Any]:
    vtk, image = library("vtk"), vtk_image()
    writer = vtk.vtkXMLImageDataWriter()
    writer.SetFileName(str(path / "a.vti"))
    writer.SetInputData(image)
    writer.Write()
    return image, path / "a.vti", box(LOW + EXTENT, HIGH + EXTENT)


def of_pyvista(path: Path) -> tuple[Any, Path, Any]:
    image = library("pyvista").wrap(vtk_image())
    image.save(path / "a.vti")
    return image, path / "a.vti", box(LOW + EXTENT, HIGH + EXTENT)


def of_turned_pyvista(path: Path) -> tuple[Any, Path, Any]:
    image = library("pyvista").wrap(vtk_image())
    image.direction_matrix = TURN
    image.save(path / "a.vti")
    return image, path / "a.vti", box(LOW + EXTENT, HIGH + EXTENT, TURN)


def of_pyvista_cells(path: Path) -> tuple[Any, Path, Any]:
    image = library("pyvista").wrap(vtk_image(cells=True))
    image.save(path / "a.vti")
    return image, path / "a.vti", box(LOW + EXTENT + 0.5, HIGH + EXTENT + 0.5)


def of_nibabel(path: Path) -> tuple[Any, Path, Any]:
    nibabel = library("nibabel")
    affine = np.eye(4)
    affine[:3, :3], affine[:3, 3] = TURN * STEPS, FIRST
    image = nibabel.Nifti1Image(BLOCK, affine)
    image.header.set_xyzt_units("mm")
    nibabel.save(image, path / "a.nii")
    return image, path / "a.nii", box(LOW, HIGH, TURN)


def of_simpleitk(suffix: str) -> Callable[[Path], tuple[Any, Path, Any]]:
    def made(path: Path) -> tuple[Any, Path, Any]:
        sitk = library("SimpleITK")
        image = sitk.GetImageFromArray(np.ascontiguousarray(BLOCK.transpose(2, 1, 0)))
        image.SetSpacing(STEPS.tolist())
        image.SetOrigin(FIRST.tolist())
        image.SetDirection(TURN.ravel().tolist())
        sitk.WriteImage(image, str(path / f"a.{suffix}"))
        return image, path / f"a.{suffix}", box(LOW, HIGH, TURN)

    return made


PAIRS = {
    "vtk .vti": of_vtk,
    "pyvista .vti": of_pyvista,
    "pyvista, turned, .vti": of_turned_pyvista,
    "pyvista, cells, .vti": of_pyvista_cells,
    "nibabel .nii": of_nibabel,
    "SimpleITK .nrrd": of_simpleitk("nrrd"),
    "SimpleITK .mha": of_simpleitk("mha"),
    "SimpleITK .nii": of_simpleitk("nii"),
}


@pytest.mark.parametrize("pair", PAIRS)
def test_an_image_stands_where_its_file_does(pair: str, tmp_path: Path) -> None:
    image, path, wanted = PAIRS[pair](tmp_path)
    taken = chordal.volume(image)
    # Single precision is what headers have of some of these numbers.
    assert np.allclose(taken.mesh().bounds, wanted, atol=1e-5)
    read = chordal.load(path, kind=chordal.Volume)
    found = read.mesh().bounds
    # ITK has its axes to the left and to the back, and NIfTI and chordal's readers of it to the right and to the front.
    turned = np.array([-1, -1, 1]) if pair == "SimpleITK .nii" else np.ones(3)
    assert np.allclose(np.sort(found * turned, axis=0), wanted, atol=1e-4)
    assert read.shape == taken.shape == BLOCK.shape and np.array_equal(read.array, taken.array)
    assert chordal.block_volume(image).affine.tolist() == taken.affine.tolist()


@pytest.mark.parametrize("suffix", [".zarr", ".nc"])
def test_a_data_array_stands_where_its_coordinates_say(suffix: str, tmp_path: Path) -> None:
    xarray = library("xarray")
    coords = {name: FIRST[k] + STEPS[k] * np.arange(BLOCK.shape[k]) for k, name in enumerate("xyz")}
    data = xarray.DataArray(BLOCK, dims=("x", "y", "z"), coords=coords, name="v")
    path = tmp_path / f"a{suffix}"
    if suffix == ".zarr":
        library("zarr")
        data.to_dataset().to_zarr(path, zarr_format=2, consolidated=False)
        read = xarray.open_zarr(path, consolidated=False)["v"]
    else:
        library("scipy")
        data.to_netcdf(path, engine="scipy")
        read = xarray.open_dataset(path, engine="scipy")["v"]
    wanted = box(LOW, HIGH)
    for image in (data, read, data.transpose("z", "y", "x"), data.isel(y=slice(None, None, -1))):
        volume = chordal.volume(image)
        assert np.allclose(volume.mesh().bounds, wanted)
        # Round about again.
        assert np.allclose(chordal.volume(volume.to_xarray()).affine, volume.affine)


def test_what_goes_to_another_library_comes_back_to_its_place() -> None:
    affine = np.diag([*STEPS, 1.0])
    affine[:3, 3] = FIRST
    volume = chordal.volume(BLOCK, affine=affine)
    for give in (volume.to_pyvista, volume.to_nibabel, volume.to_simpleitk, volume.to_xarray):
        try:
            image = give()
        except ImportError:
            continue
        assert np.allclose(chordal.volume(image).affine, affine), give.__name__


def test_images_without_scalars_and_with_vectors_are_refused() -> None:
    vtk = library("vtk")
    empty = vtk.vtkImageData()
    empty.SetDimensions(3, 3, 3)
    with pytest.raises(ValueError, match="no active scalars"):
        chordal.volume(empty)
