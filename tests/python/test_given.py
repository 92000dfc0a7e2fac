"""What people have in hand: masked arrays, open files, folders of slices, images of other libraries."""

from __future__ import annotations

import io
import pickle
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import SQUARE

import chordal

#: Without its types, which numpy has not.
MASKED: Any = np.ma.masked_array
BALL: Any = np.linalg.norm(np.indices((9, 9, 9)) - 4.0, axis=0) - 3


def test_masked_samples_of_floats_are_outside() -> None:
    masked = MASKED(BALL, BALL > 2)
    filled = np.where(BALL > 2, np.nan, BALL)
    assert np.array_equal(chordal.volume(masked).array, filled, equal_nan=True)
    assert np.array_equal(chordal.volume(masked).mesh(iso=0).vertices, chordal.volume(filled).mesh(iso=0).vertices)
    whole = MASKED(BALL.astype(np.int16), False)
    assert np.array_equal(chordal.volume(whole).array, BALL.astype(np.int16))
    with pytest.raises(ValueError, match=r"array: some samples are masked, and int16 has no NaN .* array\.filled\(0\)"):
        chordal.volume(MASKED(BALL.astype(np.int16), BALL > 2))


def test_what_is_no_lattice_is_refused_by_its_argument() -> None:
    with pytest.raises(ValueError, match="array: 2 samples or more along each axis, not 1 along x"):
        chordal.volume(np.zeros((1, 5, 5)))
    with pytest.raises(ValueError, match="spacing: a step of 0 along x and y and z"):
        chordal.volume(BALL, spacing=0)
    with pytest.raises(ValueError, match="spacing: a step of 0 along y"):
        chordal.volume(BALL, spacing=(1, 0, 1))
    with pytest.raises(ValueError, match="affine: its three steps lie in a plane"):
        chordal.volume(BALL, affine=np.diag([1, 1, 0, 1]))
    with pytest.raises(ValueError, match="^array: "):
        chordal.volume(np.arange(8).reshape(2, 2, 2) * 2**60 + 1)
    assert chordal.volume(BALL, spacing=(1, 1, -1)).bounds.tolist() == [[0, 0, -8], [8, 8, 0]]


def test_levels_are_pickled() -> None:
    for shape in (chordal.shapes.sphere(1), chordal.shapes.sphere(1).mesh(tol=0.01)):
        levels = shape.lod(pixels=1, tol=0.05)
        again = pickle.loads(pickle.dumps(levels))
        assert again.distances == levels.distances and again.to_bytes("glb") == levels.to_bytes("glb")


def test_open_files_are_read(tmp_path: Path) -> None:
    square: Any = chordal.load(io.BytesIO(SQUARE), format="obj")
    assert len(square.faces) == 2
    path = tmp_path / "square.obj"
    path.write_bytes(SQUARE)
    with path.open("rb") as file:
        # By its name.
        mesh: Any = chordal.load(file)
    assert mesh.format == "obj" and "square.obj" in repr(mesh)
    with path.open("rb") as file:
        assert chordal.inspect(file)["certificate"]["output"]["triangles"] == 2
    with path.open() as text, pytest.raises(TypeError, match="open in binary mode"):
        chordal.load(text)  # type: ignore[call-overload]


def slice_of(height: float, samples: np.ndarray[Any, Any]) -> bytes:
    """A slice of DICOM, explicit and little-endian."""

    def element(group: int, number: int, kind: bytes, value: bytes) -> bytes:
        padded = value + b" " * (len(value) % 2)
        long = kind in (b"OW", b"OB")
        size = struct.pack("<HI", 0, len(padded)) if long else struct.pack("<H", len(padded))
        return struct.pack("<HH", group, number) + kind + size + padded

    rows, columns = samples.shape
    meta = element(2, 0x10, b"UI", b"1.2.840.10008.1.2.1\0")
    data = [
        element(0x20, 0x0E, b"UI", b"1.2.3\0"),
        element(0x20, 0x32, b"DS", f"0\\0\\{height}".encode()),
        element(0x20, 0x37, b"DS", rb"1\0\0\0\1\0"),
        element(0x28, 0x02, b"US", struct.pack("<H", 1)),
        element(0x28, 0x04, b"CS", b"MONOCHROME2"),
        element(0x28, 0x10, b"US", struct.pack("<H", rows)),
        element(0x28, 0x11, b"US", struct.pack("<H", columns)),
        element(0x28, 0x30, b"DS", rb"0.5\0.5"),
        element(0x28, 0x100, b"US", struct.pack("<H", 16)),
        element(0x28, 0x101, b"US", struct.pack("<H", 16)),
        element(0x28, 0x102, b"US", struct.pack("<H", 15)),
        element(0x28, 0x103, b"US", struct.pack("<H", 0)),
        element(0x7FE0, 0x10, b"OW", samples.astype("<u2").tobytes()),
    ]
    head = element(2, 0, b"UL", struct.pack("<I", len(meta)))
    return bytes(128) + b"DICM" + head + meta + b"".join(data)


def test_a_folder_of_slices_is_a_volume(tmp_path: Path) -> None:
    samples = np.random.default_rng(1).integers(0, 4000, (4, 3, 5))
    for k, rows in enumerate(samples):
        (tmp_path / f"{7 - k}.dcm").write_bytes(slice_of(1.5 * k, rows))
    (tmp_path / "notes.txt").write_text("no slice")
    for found in (chordal.load(tmp_path), chordal.volume(tmp_path)):
        assert isinstance(found, chordal.Volume)
        assert np.array_equal(found.array, samples.transpose(2, 1, 0))
        assert found.spacing == (0.5, 0.5, 1.5)
    with pytest.raises(chordal.ReadError, match="give the folder with all of them"):
        chordal.load(tmp_path / "7.dcm")
    with pytest.raises(TypeError, match="load takes their folder"):
        chordal.load([tmp_path / "7.dcm"])  # type: ignore[call-overload]
    (tmp_path / "empty").mkdir()
    with pytest.raises(IsADirectoryError, match="this has none"):
        chordal.load(tmp_path / "empty")


def test_load_says_who_takes_what_it_does_not() -> None:
    with pytest.raises(TypeError, match=r"chordal\.volume takes arrays"):
        chordal.load(BALL)
    with pytest.raises(TypeError, match=r"Mesh\.from_ takes meshes"):
        chordal.load(chordal.shapes.sphere(1).mesh(tol=0.1))  # type: ignore[call-overload]


def test_images_of_pyvista_are_taken_and_given() -> None:
    pyvista = pytest.importorskip("pyvista")
    volume = chordal.volume(BALL[:, :8, :7], spacing=(1, 2, 0.5), origin=(3, 4, 5))
    image = volume.to_pyvista()
    assert np.allclose(image.bounds, volume.bounds.T.ravel()) and image.dimensions == (9, 8, 7)
    again = chordal.volume(image)
    assert np.array_equal(again.array, volume.array) and np.allclose(again.affine, volume.affine)
    cells = pyvista.ImageData(dimensions=(4, 5, 6), spacing=(2, 2, 2))
    cells.cell_data["v"] = np.arange(60.0)
    of_cells = chordal.volume(cells)
    assert of_cells.shape == (3, 4, 5) and of_cells.origin == (1, 1, 1) and of_cells.array[1, 0, 0] == 1
    with pytest.raises(ValueError, match="no active scalars"):
        chordal.volume(pyvista.ImageData(dimensions=(3, 3, 3)))
