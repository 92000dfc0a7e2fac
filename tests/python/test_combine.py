"""Solids combined as triangles."""

from __future__ import annotations

import numpy as np
import pytest

import chordal

Corner = tuple[float, float, float]


def cuboid(low: Corner, high: Corner, turned: bool = False) -> chordal.Shape:
    """A box as triangles."""
    corners = [[(low, high)[i >> k & 1][k] for k in range(3)] for i in range(8)]
    sides = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    faces = np.array([face for a, b, c, d in sides for face in ((a, b, c), (a, c, d))])
    return chordal.Mesh(corners, faces[:, ::-1] if turned else faces)


def volume(mesh: chordal.Mesh) -> float:
    """The signed volume by the determinants of all triangles."""
    corners = mesh.vertices[mesh.faces]
    return float(np.linalg.det(corners).sum() / 6)


A, B = cuboid((0, 0, 0), (2, 2, 2)), cuboid((1, 1, 1), (3, 3, 3))


def test_operators_are_union_difference_and_intersection() -> None:
    """Volumes of boxes, and chains that go on with what was made."""
    assert volume(A | B) == pytest.approx(15)
    assert volume(A - B) == pytest.approx(7)
    made = A & B
    assert volume(made) == pytest.approx(1)
    assert volume((A - B) | made) == pytest.approx(8)
    assert made.bound.evidence == "proved-if" and (made.bound.at_most or 0) < 1e-14
    assert made.report["certificate"]["boolean"]["method"] == "floating-point"


def test_steps_go_from_left_to_right_and_other_shapes_take_a_length() -> None:
    """As on the command line."""
    ball = chordal.shapes.sphere(0.5)
    with pytest.raises(chordal.Refused, match="within a length"):
        A.combine(("difference", ball))
    made = A.combine(("union", B), ("difference", ball), tol=0.01)
    assert volume(made) == pytest.approx(15 - np.pi * 0.5**3 / 6, abs=0.01)
    assert made.bound.metric == "solid" and 0 < (made.bound.at_most or 0) <= 0.01


def test_what_is_wrong_is_said() -> None:
    """Types, names and open meshes."""
    with pytest.raises(TypeError):
        A | 3
    with pytest.raises(ValueError, match="union, difference, intersection"):
        A.combine(("xor", B))  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="at least one"):
        A.combine()
    with pytest.raises(chordal.Refused, match="one triangle only"):
        A - chordal.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    assert volume(cuboid((0, 0, 0), (2, 2, 2), turned=True) - B) == pytest.approx(7)


def test_what_is_left_of_nothing_is_an_empty_mesh() -> None:
    """A solid without itself, and solids that are apart; and nothing is a solid as any other."""
    far = cuboid((10, 10, 10), (11, 11, 11))
    for made in (A - A, A & far, A.difference(cuboid((-1, -1, -1), (5, 5, 5))), chordal.intersection(A, far)):
        assert made.faces.shape == (0, 3) and made.volume == 0 and made.area == 0
        assert made.bound.at_most is None, "nobody has looked at what is not there"
    nothing = A - A
    assert volume(nothing | B) == volume(B | nothing) == volume(B - nothing) == 8
    for made in (nothing - B, nothing & B, B & nothing):
        assert len(made.faces) == 0
    assert volume(A.combine(("difference", A), ("union", B))) == 8
    with pytest.raises(chordal.Refused):
        chordal.shapes.sphere(1).combine(("difference", nothing))
