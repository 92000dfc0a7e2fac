"""Volumes from arrays, their surfaces, and baking."""

from __future__ import annotations

import copy
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import chordal

I, J, K = np.indices((13, 15, 17)).astype(float)  # noqa: E741
BALL = np.sqrt((I - 6) ** 2 + (J - 7) ** 2 + (K - 8) ** 2) - 4


@pytest.mark.parametrize("dtype", ["f4", ">f8", "f8"])
@pytest.mark.parametrize("order", ["C", "F"])
def test_an_array_stands_where_its_indices_say(dtype: str, order: str) -> None:
    mesh = chordal.volume(np.array(BALL, dtype, order=order)).mesh(iso=0)  # type: ignore[call-overload]
    assert np.allclose(mesh.vertices.min(axis=0), [2, 3, 4]) and np.allclose(mesh.vertices.max(axis=0), [10, 11, 12])
    assert mesh.report["certificate"]["valid"]["closed"] and mesh.bound.evidence == "proved"


def test_spacing_and_origin_are_the_affine() -> None:
    affine = np.array([[0.5, 0, 0, 1], [0, 0.25, 0, 2], [0, 0, 2, 3], [0, 0, 0, 1]])
    one = chordal.volume(BALL, spacing=(0.5, 0.25, 2), origin=(1, 2, 3)).mesh()
    two = chordal.volume(BALL, affine=affine).mesh()
    assert one.vertices.tobytes() == two.vertices.tobytes()
    assert np.allclose(one.vertices.min(axis=0), affine[:3, :3] @ [2, 3, 4] + affine[:3, 3])


def test_sides_borders_and_labels() -> None:
    mask = (BALL < 0).astype(np.uint8)
    assert len(chordal.volume(mask).mesh(iso=0.5, inside="low").faces) > len(chordal.volume(mask).mesh().faces)
    half = chordal.volume(BALL[6:])
    assert half.mesh().report["certificate"]["valid"]["closed"]
    assert not half.mesh(border="open").report["certificate"]["valid"]["closed"]
    both = chordal.volume(mask + (BALL < -2))
    assert "2 labels" in str(both.mesh(labels="all").report["certificate"]["notes"])
    assert len(both.mesh(labels=[2]).faces) < len(both.mesh(labels=[1]).faces)


def test_labels_within_a_budget_and_smoothed_masks() -> None:
    mask = (BALL < 0).astype(np.uint8)
    both = chordal.volume(mask + (BALL < -2))
    few = both.mesh(labels="all", tol=1.5)
    assert few.bound.at_most is not None and few.bound.at_most <= 1.5
    assert len(few.faces) < len(both.mesh(labels="all").faces)
    smooth = chordal.volume(mask).mesh(smooth="0.8vox")
    assert smooth.report["certificate"]["smoothed"]["changed"] < mask.sum()
    assert chordal.volume(mask).mesh(smooth=0.8).vertices.tobytes() == smooth.vertices.tobytes()
    with pytest.raises(ValueError, match="smooth"):
        chordal.volume(mask).mesh(smooth="much")


def test_what_is_wrong_is_said() -> None:
    with pytest.raises(ValueError, match="three axes"):
        chordal.volume(np.zeros((3, 3)))
    with pytest.raises(TypeError, match="complex"):
        chordal.volume(np.zeros((3, 3, 3), complex))
    with pytest.raises(TypeError, match="one or the other"):
        chordal.volume(BALL, affine=np.eye(4), spacing=1)
    with pytest.raises(chordal.Refused, match="no surface"):
        chordal.volume(BALL).mesh(iso=1000)


def test_settings_are_spelled_as_arguments() -> None:
    with pytest.raises(chordal.Refused, match="the level of the surface is not known: iso=LEVEL sets it") as caught:
        chordal.volume(np.where(I < 6, 10.5, 90.25)).mesh()
    assert "--" not in str(caught.value)
    with pytest.raises(chordal.Refused, match=r"give labels= alone, or iso=$"):
        chordal.volume((BALL < 0).astype(np.uint8)).mesh(iso=0.5, labels="all")
    with pytest.raises(chordal.Refused, match=r"cut it off at a box \(within\(\)\)$"):
        chordal.shapes.complement(chordal.shapes.sphere(1)).mesh(tol=0.1)


def test_notes_are_in_the_words_of_python_and_in_a_file_in_those_of_the_command() -> None:
    mesh = chordal.volume(BALL[6:]).mesh()
    assert 'border="open" leaves it open' in str(mesh.report["certificate"]["notes"])
    assert b"--open leaves it open" in mesh.to_bytes("ply")


def test_a_cube_comes_back_from_its_distances() -> None:
    corners = np.indices((2, 2, 2)).reshape(3, -1).T * 2.0 - 1
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    cube = chordal.Mesh(corners, [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])
    for made in (cube, cube.mesh(tol=0.1)):
        baked = made.bake(cells=20)
        facts = baked.report["certificate"]["baked"]  # type: ignore[index]
        assert facts["solid"]["is_solid"] and facts["off_at_most"] < 1e-12 and facts["evidence"] == "proved"
        assert np.allclose(abs(baked.mesh(iso=0).vertices).max(axis=0), 1)
    assert cube.bake(cells=4, band=1).report["certificate"]["baked"]["band"] is not None  # type: ignore[index]


def test_a_field_becomes_triangles_and_what_it_raises_comes_through() -> None:
    block = chordal.shapes.box(2, 2, 1) - chordal.shapes.cylinder(0.4, 2)
    mesh = block.mesh(tol=0.05)
    assert mesh.bound.at_most is not None and mesh.bound.at_most <= 0.05 and mesh.bound.evidence == "proved"
    assert mesh.report["certificate"]["valid"]["closed"]

    def broken(points: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        chordal.field(broken, bounds=((-1, -1, -1), (1, 1, 1)), lipschitz=1).mesh(tol=0.1)


@pytest.mark.parametrize("order", ["C", "F"])
@pytest.mark.parametrize("suffix", [".npy", ".npz"])
def test_a_file_of_numpy_has_the_axes_of_numpy(order: str, suffix: str, tmp_path: Path) -> None:
    samples = np.array(BALL, "f4", order=order)  # type: ignore[call-overload]
    path = tmp_path / f"ball{suffix}"
    np.save(path, samples) if suffix == ".npy" else np.savez(path, ball=samples)
    found = chordal.load(path, kind=chordal.Volume)
    assert found.array.shape == found.shape == samples.shape and np.array_equal(found.array, samples)
    assert np.array_equal(found.affine, np.eye(4)) and not found.array.flags.owndata
    for other in (pickle.loads(pickle.dumps(found)), found.surface(iso=0), copy.copy(found)):
        assert np.array_equal(other.array, samples) and np.array_equal(other.affine, np.eye(4))
    stretched = chordal.volume(path, spacing=(1, 2, 3))
    assert np.array_equal(stretched.array, samples) and stretched.spacing == (1, 2, 3)
    assert np.allclose(found.mesh(iso=0).bounds, chordal.volume(samples).mesh(iso=0).bounds)
    again = tmp_path / "again.npy"
    found.export(again)
    assert np.array_equal(np.load(again), samples)


def test_words_on_a_surface_add_up() -> None:
    halves = np.ones((12, 12, 12), np.uint8)
    halves[6:] = 2
    both = chordal.labels(halves)
    assert [part.name for part in both.mesh(border="open").parts] == ["label 1", "label 2"]
    with pytest.raises(chordal.Refused, match="labels would no longer fit together"):
        both.mesh(smooth=1)
    # A level takes the place of labels, and they that of a level.
    assert len(both.mesh(iso=1.5).parts) == 1
    assert len(chordal.volume(halves).surface(iso=1.5, inside="low").mesh(labels="all").parts) == 2
    kept = chordal.volume(BALL).surface(inside="low", border="open")
    assert np.array_equal(kept.mesh(iso=0).vertices, chordal.volume(BALL).mesh(iso=0, inside="low", border="open").vertices)


def test_colours_are_shares_or_bytes() -> None:
    corners, faces = np.eye(3), [(0, 1, 2)]
    with pytest.raises(ValueError, match="colors: floats from 0 to 1, or bytes, .* not 200"):
        chordal.Mesh(corners, faces, colors=np.full((3, 3), 200.0))
    assert chordal.Mesh(corners, faces, colors=np.full((3, 3), 200, np.uint8)).colors is not None


SCAN = np.where(BALL < 0, 40.0, -1000.0)
#: Outside is positive, as of distances; all are whole numbers.
BLOCK = np.max(np.abs([I - 6, J - 7, K - 8]), axis=0) - 3


@pytest.mark.parametrize("dtype", [np.int16, np.int32, np.float32, np.float64])
def test_the_same_samples_are_the_same_solid_in_every_type(dtype: Any) -> None:
    for samples, within in ((SCAN, BALL < 0), (BLOCK, BLOCK < 0)):
        mesh = chordal.volume(samples.astype(dtype)).mesh(iso=0)
        # Not the box without it: a solid of about as many cells as there are samples in it.
        assert 0.5 * within.sum() < mesh.volume < 2 * within.sum() + 60
        other = chordal.volume((0.97 * samples).astype(np.float64)).mesh(iso=0)
        assert np.sign(other.volume) == np.sign(mesh.volume) and other.volume == pytest.approx(mesh.volume, rel=0.01)
    assert chordal.volume(BLOCK.astype(np.int16)).mesh().volume == chordal.volume(BLOCK).mesh().volume


def test_a_side_that_samples_do_not_tell_is_warned_of() -> None:
    wave = np.sin(I) * np.cos(J) + np.sin(K)
    with pytest.warns(UserWarning, match="taken for outside.*say inside="):
        chordal.volume(wave).mesh(iso=0)
    for inside in ("low", "high"):
        chordal.volume(wave).mesh(iso=0, inside=inside)
    for samples in (np.float32(wave), np.int16(1000 * wave)):
        with pytest.raises(ValueError, match="inside: 'low' if these are distances"):
            chordal.block_volume(samples).mesh(iso=0)


def test_labels_are_whole_numbers_of_whatever_type() -> None:
    samples = np.zeros((10, 10, 10))
    samples[2:5], samples[5:8] = 1, 2
    whole = chordal.labels(samples.astype(np.uint8)).mesh()
    for dtype in (np.float32, np.float64):
        made = chordal.labels(samples.astype(dtype)).mesh()
        assert [part.name for part in made.parts] == ["label 1", "label 2"]
        assert np.array_equal(made.vertices, whole.vertices) and np.array_equal(made.faces, whole.faces)
    volume = chordal.volume(samples)
    one = volume.mesh(labels=[2])
    for said in (2, np.int64(2), np.array([2]), 2.0, np.unique(samples)[2:]):
        assert np.array_equal(volume.mesh(labels=said).vertices, one.vertices)  # type: ignore[arg-type]
    assert np.array_equal(chordal.labels(samples, only=2).mesh().vertices, one.vertices)
    assert list(chordal.block_volume(samples.astype(np.uint8)).labels(2)) == [2]
    with pytest.raises(ValueError, match="labels: whole numbers, not 1.5"):
        volume.mesh(labels=1.5)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="labels as whole numbers"):
        volume.mesh(labels="some")  # type: ignore[arg-type]
    with pytest.raises(chordal.Refused, match="not all of these samples are"):
        chordal.labels(samples + 0.5 * (samples == 2)).mesh()
    with pytest.raises(chordal.Refused, match="at most 65,536 different"):
        chordal.labels(np.arange(42**3, dtype=np.float64).reshape(42, 42, 42)).mesh()
