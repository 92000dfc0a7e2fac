"""Arguments that make no sense are named, in one sentence that says what would."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import SQUARE, TEAPOT

import chordal

VIEW = "1920x1080 fov=45 dist=4"
# Not of its types, for these refuse what is tried here.
ANY: Any = chordal


@pytest.fixture(scope="module")
def shape() -> chordal.Shape:
    return chordal.load(SQUARE, format="obj")


@pytest.mark.parametrize(
    ("budget", "part"),
    [
        ({}, "tol=0.1 in units, rel=0.001 of the diagonal, pixels=1 with view="),
        ({"tol": 0.1, "rel": 0.1}, "tol, rel"),
        ({"tol": 0}, "tol: .* greater than 0"),
        ({"tol": -1.0}, "tol"),
        ({"tol": float("nan")}, "tol: a finite number"),
        ({"tol": np.inf}, "tol: a finite number"),
        ({"tol": "1 parsec"}, "tol: .*units are"),
        ({"tol": ""}, "tol"),
        ({"rel": "0.1"}, "rel: a share of the diagonal"),
        ({"rel": 0}, "rel"),
        ({"pixels": 1}, "needs a view: add view=.* to pixels=1"),
        ({"view": VIEW}, "a view is for .*: add pixels=1"),
        ({"pixels": -1, "view": VIEW}, "pixels"),
        ({"pixels": 1, "view": "1920x1080 fov=180 dist=4"}, "view"),
        ({"pixels": 1, "view": "x"}, "view"),
        ({"triangles": 0}, "triangles: a whole number greater than 0"),
        ({"triangles": 2**64}, "triangles"),
    ],
)
def test_a_budget_without_sense_is_a_value_error(shape: chordal.Shape, budget: dict[str, Any], part: str) -> None:
    with pytest.raises(chordal.BudgetError, match=part) as caught:
        shape.mesh(**budget)
    assert isinstance(caught.value, ValueError)


@pytest.mark.parametrize(
    "budget",
    [
        {"tol": True},
        {"tol": [1]},
        {"tol": np.ones(3)},
        {"rel": 1j},
        {"pixels": "1", "view": VIEW},
        {"pixels": 1, "view": 7},
        {"triangles": 1.5},
        {"triangles": "many"},
        {"triangles": True},
        {"tol": 1, "progress": 3},
    ],
)
def test_a_budget_of_another_type_is_a_type_error(shape: chordal.Shape, budget: dict[str, Any]) -> None:
    with pytest.raises(TypeError, match="|".join(budget)):
        shape.mesh(**budget)


def test_numbers_of_numpy_will_do(shape: chordal.Shape) -> None:
    for tol in (np.float32(0.5), np.int64(1), np.float64(0.5), 1):
        at_most = shape.mesh(tol=tol).bound.at_most
        assert at_most is not None and at_most <= float(tol)
    assert len(shape.mesh(triangles=np.int32(2)).faces) == 2


def test_budgets_are_given_by_name(shape: chordal.Shape) -> None:
    with pytest.raises(TypeError):
        shape.mesh(0.1)  # type: ignore[call-arg]


def test_views_are_made_from_numbers_or_text() -> None:
    closest = chordal.View.closest(distance=4, fov_deg=45, size_px=(1920, 1080))
    assert closest == chordal.View(VIEW) and hash(closest) == hash(chordal.View(VIEW))
    camera = chordal.View.camera(eye=(4, -6, 3), target=[0, 0, 1], height=3, size_px=(640, 480))
    assert str(camera) == "640x480 height=3 eye=4,-6,3 target=0,0,1 up=0,0,1 near=0"
    assert chordal.View(str(camera)) == camera
    tiny = chordal.View.closest(distance=1e-7, fov_deg=0.1, size_px=(1, 1))
    assert chordal.View(str(tiny)) == tiny


@pytest.mark.parametrize(
    ("make", "part"),
    [
        (lambda: chordal.View.closest(distance=4, size_px=(1920, 1080)), "fov"),
        (lambda: chordal.View.closest(fov_deg=45, size_px=(1920, 1080)), "dist"),
        (lambda: chordal.View.closest(distance=4, fov_deg=45, size_px=(0, 1080)), "pixel"),
        (lambda: chordal.View.closest(distance=4, fov_deg=45, size_px=(1, 2, 3)), "size_px"),  # type: ignore[arg-type]
        (lambda: chordal.View.closest(distance=float("nan"), fov_deg=45, size_px=(9, 9)), "distance"),
        (lambda: chordal.View.camera(eye=(0, 0), target=(0, 0, 1), fov_deg=9, size_px=(9, 9)), "eye"),
        (lambda: chordal.View.camera(eye=(0, 0, 1), target=(0, 0, 1), fov_deg=9, size_px=(9, 9)), "apart"),
    ],
)
def test_a_view_without_sense_says_which_word(make: Any, part: str) -> None:
    with pytest.raises(chordal.BudgetError, match=part):
        make()


@pytest.mark.parametrize(
    ("options", "error", "part"),
    [
        ({"format": "dwg"}, ValueError, "format: 'dwg' is no format"),
        ({"format": 3}, TypeError, "format"),
        ({"unit": "furlong"}, ValueError, "unit: .*units are"),
        ({"up": "x"}, ValueError, "up"),
    ],
)
def test_how_to_read_is_checked(options: dict[str, Any], error: type[Exception], part: str) -> None:
    with pytest.raises(error, match=part):
        chordal.load(SQUARE, **options)


def test_a_source_is_a_path_or_bytes() -> None:
    with pytest.raises(TypeError, match="source: a path, an open file or bytes, not int"):
        chordal.load(3)  # type: ignore[call-overload]
    for source in (SQUARE, bytearray(SQUARE), memoryview(SQUARE)):
        assert chordal.load(source, format="obj").kind == "triangles"


def test_a_file_of_another_kind_than_was_said_is_refused() -> None:
    assert isinstance(chordal.load(SQUARE, format="obj", kind=chordal.Mesh), chordal.Mesh)
    assert isinstance(chordal.load(TEAPOT, kind=chordal.Shape), chordal.Shape)
    with pytest.raises(chordal.ReadError, match=r"teapot.bpt: this holds .*patches, which are a Shape and not a Mesh: mesh it") as raised:
        chordal.load(TEAPOT, kind=chordal.Mesh)
    assert raised.value.code == "other-kind"
    with pytest.raises(chordal.ReadError, match="a Mesh and not a Volume$"):
        chordal.load(SQUARE, format="obj", kind=chordal.Volume)


@pytest.mark.parametrize(
    ("make", "error", "part"),
    [
        (lambda: ANY.scene({"a": []}), ValueError, "things: there is no mesh in them"),
        (lambda: ANY.scene(chordal.Placed({}, (1, 0, 0))), ValueError, "things: there is no mesh in them"),
        (lambda: ANY.load(SQUARE, format="obj", kind="mesh"), TypeError, "kind: a class, as in .*, not 'mesh'"),
        (lambda: ANY.verify("a.glb", ["a.stl", 3]), TypeError, "against: a shape, a path.*, not int"),
        (lambda: ANY.verify("a.glb", 3), TypeError, "against: a shape, a path.*, not int"),
        (lambda: ANY.verify("a.glb", chordal.shapes.sphere(1), options={"surface": "loop"}), TypeError, "options: they are of"),
        (lambda: ANY.batch("fly", "a.stl", "out"), ValueError, "verb: one of mesh, .*, not 'fly'"),
        (lambda: ANY.batch("mesh", "a.stl", "out", tol=0.1), TypeError, "'tol': what the verb is told stands in options"),
    ],
)
def test_what_is_wrong_is_one_sentence(make: Any, error: type[Exception], part: str) -> None:
    with pytest.raises(error, match=part):
        make()


def test_an_option_of_a_batch_is_answered(tmp_path: Path) -> None:
    (tmp_path / "a.obj").write_bytes(SQUARE)
    with pytest.raises(ValueError, match="options: mesh has no 'tolerance': here it is tol="):
        chordal.batch("mesh", tmp_path / "a.obj", tmp_path / "out", options={"tolerance": 0.1})


def test_one_file_is_enough_to_verify(tmp_path: Path) -> None:
    (tmp_path / "a.obj").write_bytes(SQUARE)
    chordal.load(tmp_path / "a.obj").mesh(tol=0.1).export(tmp_path / "a.glb")
    assert chordal.verify(tmp_path / "a.glb", str(tmp_path / "a.obj"))["verdict"] == "re-proved"


def test_a_length_of_a_volume_read_by_blocks_may_have_a_unit() -> None:
    i, j, k = np.indices((12, 12, 12)) - 5.5
    samples = np.sqrt(i * i + j * j + k * k) - 4
    volume = chordal.block_volume(samples, spacing=0.5, unit="mm")
    said, plain = (volume.mesh(iso=0, inside="low", tol=tol, block=8) for tol in ("200um", 0.2))
    assert np.array_equal(said.vertices, plain.vertices)
    for tol, message in (("0.1", None), ("wide", "a length in units"), ("1%", "a length in units"), ("--1mm", "a length in units")):
        if message is None:
            assert volume.mesh(iso=0, inside="low", tol=tol, block=8).bound.is_within(0.1)
        else:
            with pytest.raises(chordal.BudgetError, match=message):
                volume.mesh(iso=0, inside="low", tol=tol)
    with pytest.raises(chordal.BudgetError, match="nothing says the unit of the volume"):
        chordal.block_volume(samples).mesh(iso=0, inside="low", tol="0.1mm")


def test_a_formula_is_not_compared() -> None:
    x: Any = chordal.shapes.x
    with pytest.raises(TypeError, match="a formula is not compared: field"):
        x > 1
    with pytest.raises(TypeError, match="a formula is not compared: field"):
        1 <= x < chordal.shapes.y
