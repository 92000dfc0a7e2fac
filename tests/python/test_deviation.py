"""`deviation`: the ends of the command, from arrays and from meshes that were made."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from conftest import TEAPOT, Command

import chordal

SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
FACES = np.array([[0, 1, 2], [0, 2, 3]])


def test_a_shifted_square_is_as_far_as_it_was_shifted() -> None:
    below, above = chordal.Mesh(SQUARE, FACES), chordal.Mesh(SQUARE + [0, 0, 0.25], FACES[:, ::-1])
    found = below.deviation(above)
    assert found.bound.evidence == "proved" and found.reached and found.verdict is None
    assert found.bound.at_most is not None
    assert found.bound.at_least <= 0.25 <= found.bound.at_most <= 1.1 * found.bound.at_least
    for side in (found.forward, found.backward):
        assert abs(side.point[2] - side.nearest[2]) == 0.25
    assert below.deviation(below).bound.at_most == 0
    assert below.deviation(above, max=0.26).verdict == "within"
    assert below.deviation(above, max="10%").verdict == "exceeds"
    assert "proved" in repr(found)


def test_the_ends_are_those_of_the_command(cargo_chordal: Command, tmp_path: Path) -> None:
    mesh = chordal.load(TEAPOT).mesh(tol=0.02)
    mesh.export(tmp_path / "a.ply")
    done = cargo_chordal("deviation", tmp_path / "a.ply", TEAPOT, "--json")
    assert done.returncode == 0, done.stderr
    said = json.loads(done.stdout)
    found = mesh.deviation(chordal.load(TEAPOT))
    assert found.report["certificate"]["bound"] == said["certificate"]["bound"]
    assert found.report["deviation"] == said["deviation"]
    assert mesh.bound.at_most is not None and found.bound.at_least <= mesh.bound.at_most
    read = chordal.load(tmp_path / "a.ply")
    assert read.deviation(mesh).bound.at_most == 0


@pytest.mark.parametrize(
    ("vertices", "faces", "error", "said"),
    [
        (SQUARE, [[0, 1, 4]], ValueError, "position 4"),
        (SQUARE, [[0, 1, -1]], ValueError, "no index: -1"),
        (SQUARE, [[0, 1]], ValueError, "rows of 3"),
        (SQUARE[:, :2], FACES, ValueError, "rows of 3"),
        (SQUARE * np.nan, FACES, ValueError, "not finite"),
        (SQUARE, FACES * 1.0, TypeError, "whole numbers"),
        ("abc", FACES, TypeError, "real numbers"),
    ],
)
def test_arrays_that_are_no_mesh_are_named(vertices: object, faces: object, error: type[Exception], said: str) -> None:
    with pytest.raises(error, match=said):
        chordal.Mesh(vertices, faces)  # type: ignore[arg-type]


def test_arguments_that_make_no_sense_are_named() -> None:
    shape = chordal.Mesh(SQUARE, FACES)
    with pytest.raises(TypeError, match="other: a shape, a path"):
        shape.deviation(SQUARE)
    with pytest.raises(chordal.BudgetError, match="relative"):
        shape.deviation(shape, relative=-1)
    with pytest.raises(ValueError, match="max"):
        shape.deviation(shape, max="abc")
    with pytest.raises(chordal.Refused, match="no triangle"):
        shape.deviation(chordal.Mesh(SQUARE, np.zeros((0, 3), int)))
    drawing = chordal.load(b'<svg xmlns="http://www.w3.org/2000/svg"><circle r="1"/></svg>')
    with pytest.raises(chordal.Refused, match="no surface"):
        drawing.deviation(shape)


def test_arrays_of_any_kind_will_do() -> None:
    shape = chordal.Mesh(SQUARE.astype(np.float32)[::1], FACES.astype(np.uint8))
    assert shape.inspect()["certificate"]["output"]["triangles"] == 2
    assert chordal.Mesh(SQUARE.tolist(), FACES.tolist()).deviation(shape).bound.at_most == 0
