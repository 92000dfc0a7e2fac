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


def test_a_dask_array_is_read_by_blocks() -> None:
    array: Any = pytest.importorskip("dask.array", reason="dask is not installed: its arrays are not tried")
    samples = ball()
    volume = chordal.block_volume(array.from_array(samples, chunks=(8, 9, 10)), spacing=0.5)
    made, whole = volume.mesh(iso=1.5, block=8), chordal.volume(samples, spacing=0.5).mesh(iso=1.5)
    assert np.array_equal(made.vertices, whole.vertices) and np.array_equal(made.faces, whole.faces)
