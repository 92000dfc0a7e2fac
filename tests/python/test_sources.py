"""Volumes by their path: what a file says of its lattice holds, and slices of it are those of the whole."""

from __future__ import annotations

import json
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import chordal


def ball(shape: tuple[int, int, int] = (19, 23, 17)) -> NDArray[np.float32]:
    middle = (np.array(shape) - 1) / 2
    places = np.moveaxis(np.indices(shape), 0, -1) - middle
    found: NDArray[np.float32] = (0.4 * min(shape) - np.linalg.norm(places, axis=-1)).astype(np.float32)
    return found


def check(volume: chordal.BlockVolume, samples: NDArray[Any], affine: NDArray[Any], unit: str | None) -> None:
    """The volume of a file is that of its samples with a matrix, also where a pickle of it is opened."""
    assert volume.shape == samples.shape and volume.dtype == samples.dtype
    assert np.allclose(volume.affine, affine, rtol=1e-12, atol=0), (volume.affine, affine)
    whole = chordal.volume(samples, affine=volume.affine, unit=unit).mesh(iso=1.5)
    for one in (volume, pickle.loads(pickle.dumps(volume))):
        made = one.mesh(iso=1.5, block=8)
        assert np.array_equal(made.vertices, whole.vertices) and np.array_equal(made.faces, whole.faces)
    assert len(pickle.dumps(volume)) < 4_000, "a pickle says where samples are"


def placed(steps: tuple[float, ...], origin: tuple[float, ...]) -> NDArray[np.float64]:
    affine = np.diag([*steps, 1.0])
    affine[:3, 3] = origin
    return affine


@pytest.mark.parametrize("version", ["0.4", "0.5"])
def test_an_ome_zarr_image_has_its_axes_scale_and_unit(tmp_path: Path, version: str) -> None:
    zarr = pytest.importorskip("zarr", reason="zarr is not installed: OME-Zarr is not tried")
    samples = ball()
    root = zarr.open_group(tmp_path / "cells.zarr", mode="w", zarr_format=2 if version == "0.4" else 3)
    axes = [{"name": "c", "type": "channel"}]
    axes += [{"name": name, "type": "space", "unit": "micrometer"} for name in "zyx"]
    both = np.stack([np.zeros_like(samples), samples]).transpose(0, 3, 2, 1)
    levels = []
    for level, step in enumerate((1, 2)):
        array = both[:, ::step, ::step, ::step]
        root.create_array(str(level), shape=array.shape, chunks=(1, 8, 8, 8), dtype="f4")[...] = array
        scale = {"type": "scale", "scale": [1.0, 0.5 * step, 0.25 * step, 0.25 * step]}
        move = {"type": "translation", "translation": [0.0, 3.0, 2.0, 1.0]}
        levels.append({"path": str(level), "coordinateTransformations": [scale, move]})
    multiscales = [{"axes": axes, "datasets": levels, "version": "0.4"}]
    root.attrs.update({"multiscales": multiscales} if version == "0.4" else {"ome": {"version": "0.5", "multiscales": multiscales}})
    fine = chordal.block_volume(tmp_path / "cells.zarr", channel=1)
    check(fine, samples, placed((0.25, 0.25, 0.5), (1.0, 2.0, 3.0)), "um")
    assert fine.mesh(iso=1.5).mesh(tol="0.0001mm").bound.evidence == "proved"
    half = chordal.block_volume(tmp_path / "cells.zarr", channel=1, level=1)
    check(half, samples[::2, ::2, ::2].copy(), placed((0.5, 0.5, 1.0), (1.0, 2.0, 3.0)), "um")
    with pytest.raises(ValueError, match="has the levels 0 to 1, not 2"):
        chordal.block_volume(tmp_path / "cells.zarr", level=2)


def test_a_group_of_zarr_that_is_no_image_says_so(tmp_path: Path) -> None:
    zarr = pytest.importorskip("zarr", reason="zarr is not installed: groups are not tried")
    root = zarr.open_group(tmp_path / "some.zarr", mode="w")
    root.create_array("density", shape=(4, 4, 4), dtype="f4")[...] = 1
    with pytest.raises(ValueError, match="no OME-Zarr image; name one of its arrays"):
        chordal.block_volume(tmp_path / "some.zarr")
    assert chordal.block_volume(tmp_path / "some.zarr" / "density").shape == (4, 4, 4)


def test_precomputed_samples_have_their_resolution_and_offset(tmp_path: Path) -> None:
    tensorstore: Any = pytest.importorskip("tensorstore", reason="tensorstore is not installed: precomputed is not tried")
    samples = ball()
    spec = {
        "driver": "neuroglancer_precomputed",
        "kvstore": {"driver": "file", "path": str(tmp_path / "cells")},
        "multiscale_metadata": {"type": "image", "data_type": "float32", "num_channels": 1},
        "scale_metadata": {
            "size": list(samples.shape),
            "encoding": "raw",
            "chunk_size": [8, 8, 8],
            "resolution": [8, 8, 40],
            "voxel_offset": [100, 200, 300],
        },
    }
    store = tensorstore.open(spec, create=True).result()
    store[..., 0].write(samples).result()
    affine = placed((0.008, 0.008, 0.04), (0.8, 1.6, 12.0))
    check(chordal.block_volume(tmp_path / "cells"), samples, affine, "um")
    check(chordal.block_volume(f"precomputed://file://{tmp_path}/cells"), samples, affine, "um")
    assert json.loads((tmp_path / "cells" / "info").read_text())["type"] == "image"


@pytest.mark.parametrize("name", ["ball.nii", "ball.nii.gz"])
def test_a_nifti_file_is_read_by_slices(tmp_path: Path, name: str) -> None:
    nibabel = pytest.importorskip("nibabel", reason="nibabel is not installed: NIfTI by slices is not tried")
    samples = ball()
    affine = placed((-0.5, 0.75, 2.0), (90.0, -126.0, -72.0))
    image = nibabel.Nifti1Image(samples, affine)
    image.header.set_xyzt_units("mm")
    nibabel.save(image, tmp_path / name)
    check(chordal.block_volume(tmp_path / name), samples, affine, "mm")


def test_an_image_of_nibabel_stays_in_its_file(tmp_path: Path) -> None:
    nibabel = pytest.importorskip("nibabel", reason="nibabel is not installed: its images are not tried")
    samples, affine = ball(), placed((-0.5, 0.75, 2.0), (90.0, -126.0, -72.0))
    several = np.stack([samples[::-1], samples], axis=3)
    for name, array in (("one.nii", samples), ("one.nii.gz", samples), ("two.nii", several)):
        image = nibabel.Nifti1Image(array, affine)
        image.header.set_xyzt_units("mm")
        nibabel.save(image, tmp_path / name)
    lazy = nibabel.load(tmp_path / "one.nii")
    check(chordal.block_volume(lazy), samples, affine, "mm")
    assert not lazy.in_memory
    check(chordal.block_volume(nibabel.load(tmp_path / "two.nii"), channel=1), samples, affine, "mm")
    # In memory: what is compressed, and what was made or changed there.
    whole = chordal.volume(samples, affine=affine, unit="mm").mesh(iso=1.5)
    for image in (nibabel.load(tmp_path / "one.nii.gz"), nibabel.Nifti1Image(samples, affine)):
        assert np.array_equal(chordal.block_volume(image).mesh(iso=1.5, block=8).vertices, whole.vertices)


def test_a_dask_array_is_read_by_blocks() -> None:
    array: Any = pytest.importorskip("dask.array", reason="dask is not installed: its arrays are not tried")
    samples = ball()
    volume = chordal.block_volume(array.from_array(samples, chunks=(8, 9, 10)), spacing=0.5)
    made, whole = volume.mesh(iso=1.5, block=8), chordal.volume(samples, spacing=0.5).mesh(iso=1.5)
    assert np.array_equal(made.vertices, whole.vertices) and np.array_equal(made.faces, whole.faces)


def test_scaled_samples_of_nifti_are_what_they_mean(tmp_path: Path) -> None:
    nibabel = pytest.importorskip("nibabel", reason="nibabel is not installed: NIfTI by slices is not tried")
    image = nibabel.Nifti1Image(np.round(ball() * 1000).astype(np.int16), np.eye(4))
    image.header.set_slope_inter(0.001, -0.5)
    # What an image of an array has in its header is not applied to it: write the bytes with it.
    content = bytearray(image.to_bytes())
    content[112:120] = np.array([0.001, -0.5], "<f4").tobytes()
    (tmp_path / "scaled.nii").write_bytes(content)
    volume = chordal.block_volume(tmp_path / "scaled.nii")
    whole = np.asarray(nibabel.load(tmp_path / "scaled.nii").dataobj)
    assert volume.dtype == np.float64 and whole.dtype == np.float64
    made, expected = volume.mesh(iso=1.5, block=8), chordal.volume(whole).mesh(iso=1.5)
    assert np.array_equal(made.vertices, expected.vertices)
    with pytest.raises(ValueError, match="level 0 alone does not say which"):
        volume.mesh(iso=0)


def ome(path: Path, units: list[str | None], transforms: list[Any]) -> Path:
    zarr = pytest.importorskip("zarr", reason="zarr is not installed: OME-Zarr is not tried")
    root = zarr.open_group(path, mode="w")
    root.create_array("0", shape=(4, 4, 4), dtype="u1")[...] = 1
    axes = [{"name": name, "type": "space"} | ({} if unit is None else {"unit": unit}) for name, unit in zip("zyx", units, strict=True)]
    root.attrs["multiscales"] = [{"axes": axes, "datasets": [{"path": "0", "coordinateTransformations": transforms}]}]
    return path


def test_units_of_axes_that_differ_are_brought_together(tmp_path: Path) -> None:
    scale = [{"type": "scale", "scale": [0.04, 8.0, 8.0]}]
    made = chordal.block_volume(ome(tmp_path / "a.zarr", ["micrometer", "nanometer", "nanometer"], scale))
    assert np.allclose(np.diag(made.affine), [0.008, 0.008, 0.04, 1.0]) and made._unit == "um"
    both = chordal.block_volume(ome(tmp_path / "b.zarr", ["millimeter", "micrometer", "micrometer"], scale))
    assert np.allclose(np.diag(both.affine), [8.0, 8.0, 40.0, 1.0]) and both._unit == "um"
    with pytest.raises(ValueError, match="units of the axes are not all known"):
        chordal.block_volume(ome(tmp_path / "c.zarr", ["micrometer", None, None], scale))
    with pytest.raises(ValueError, match="a transformation of the type 'affine' is not read"):
        chordal.block_volume(ome(tmp_path / "d.zarr", [None] * 3, [{"type": "affine", "affine": []}]))


def test_masked_samples_are_no_numbers() -> None:
    samples: Any = np.ma.masked_array(ball(), mask=np.zeros((19, 23, 17), bool))  # type: ignore[no-untyped-call]
    samples[8:11, 10:13, 7:10] = np.ma.masked
    made, whole = chordal.block_volume(samples).mesh(iso=1.5, block=8), chordal.volume(samples).mesh(iso=1.5)
    assert np.array_equal(made.vertices, whole.vertices) and len(whole.vertices) > len(chordal.volume(ball()).mesh(iso=1.5).vertices)


def test_a_path_that_holds_something_else_by_now_is_read_anew(tmp_path: Path) -> None:
    zarr = pytest.importorskip("zarr", reason="zarr is not installed: Zarr is not tried")
    for shape in ((8, 8, 8), (9, 10, 11)):
        zarr.create_array(tmp_path / "a.zarr", shape=shape, dtype="f4", overwrite=True)[...] = ball(shape)
        volume = chordal.block_volume(tmp_path / "a.zarr")
        assert volume.shape == shape and len(volume.mesh(iso=0.5, block=4).faces) > 8


@pytest.mark.parametrize("order", ["C", "F"])
def test_an_array_mapped_from_a_file_is_pickled_as_its_place(tmp_path: Path, order: Any) -> None:
    samples = np.random.default_rng(3).uniform(-1, 1, (40, 30, 20))
    path = tmp_path / "raw.bin"
    mapped = np.memmap(path, np.float64, "w+", offset=24, shape=samples.shape, order=order)
    mapped[...] = samples
    mapped.flush()
    whole = chordal.volume(samples).mesh(iso=0, inside="low")
    for given in (mapped, np.memmap(path, np.float64, "r", offset=24, shape=samples.shape, order=order)):
        volume = chordal.block_volume(given)
        assert len(pickle.dumps(volume._array)) < 1000
        mesh = pickle.loads(pickle.dumps(volume)).mesh(iso=0, inside="low", block=16)
        assert np.array_equal(mesh.vertices, whole.vertices) and np.array_equal(mesh.faces, whole.faces)
    # What is not all of the file, or not what is in it, is samples like any others.
    part = chordal.block_volume(mapped[5:30, ::2])
    assert part.shape == (25, 15, 20) and np.array_equal(part._array[0:25, 0:15, 0:20], samples[5:30, ::2])
    changed = np.memmap(path, np.float64, "c", offset=24, shape=samples.shape, order=order)
    changed[0, 0, 0] = 9
    assert chordal.block_volume(changed)._array[0, 0, 0] == 9
