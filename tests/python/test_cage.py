"""Polygon cages: from lists and arrays, refined, and through files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import chordal

CORNERS = [(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]
SIDES = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]


def test_a_cube_is_refined() -> None:
    cube = chordal.Cage(CORNERS, np.array(SIDES))
    once = cube.refined()
    assert once.positions.shape == (26, 3) and isinstance(once.faces, np.ndarray) and once.faces.shape == (24, 4)
    # A corner goes to 5/9 of itself.
    assert np.allclose(once.positions[:8], np.array(CORNERS) * 5 / 9, rtol=1e-15)
    assert np.array_equal(cube.refined(0).faces, SIDES)
    assert not once.positions.flags.writeable
    again, twice = once.refined(1), cube.refined(2)
    assert np.allclose(np.sort(again.positions, axis=0), np.sort(twice.positions, axis=0), atol=1e-14)


def test_faces_of_any_length() -> None:
    roof = chordal.Cage([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0.5, 2, 0)], [[0, 1, 2, 3], (3, 2, 4)])
    assert [list(face) for face in roof.faces] == [[0, 1, 2, 3], [3, 2, 4]]
    assert roof.offsets.tolist() == [0, 4, 7] and roof.indices.tolist() == [0, 1, 2, 3, 3, 2, 4]
    assert len(roof.refined().faces) == 7
    assert repr(roof) == "<Cage: 2 faces, 5 vertices, catmull-clark>"
    assert len(chordal.Cage(np.zeros((0, 3)), []).faces) == 0


def test_tags_are_kept_and_fade() -> None:
    cube = chordal.Cage(
        CORNERS,
        SIDES,
        creases=[(1, 0, 1.5), (0, 2, 12)],
        corners=[(7, 2)],
        holes=[5, 0],
        boundary="edge-and-corner",
        creasing="chaikin",
    )
    assert cube.creases == [(0, 1, 1.5), (0, 2, 12.0)] and cube.corners == [(7, 2.0)] and cube.holes == [0, 5]
    assert (cube.scheme, cube.boundary, cube.creasing) == ("catmull-clark", "edge-and-corner", "chaikin")
    assert (7, 1.0) in cube.refined().corners and len(cube.refined().holes) == 8
    read = cube.shape().inspect()["inspection"]["cage"]
    assert read["creases"] == {"count": 2, "infinite": 1, "range": [1.5, 1.5]} and read["holes"] == 2


def test_loop_takes_triangles() -> None:
    tetrahedron = chordal.Cage(CORNERS[:4], [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)], scheme="loop")
    assert len(tetrahedron.refined(2).faces) == 64
    with pytest.raises(ValueError, match="faces: face 0 is no triangle"):
        chordal.Cage(CORNERS, SIDES, scheme="loop")


def test_files_are_cages_where_they_say_so(tmp_path: Path) -> None:
    text = "".join(f"v {x} {y} {z}\n" for x, y, z in CORNERS)
    text += "".join("f " + " ".join(str(v + 1) for v in face) + "\n" for face in SIDES)
    assert chordal.load(text.encode(), format="obj").kind == "triangles"
    tagged = chordal.load((text + "t crease 2/1/0 0 1 2\n").encode(), format="obj")
    assert tagged.kind == "cage" and tagged.cage().creases == [(0, 1, 2.0)]
    assert chordal.load(text.encode(), format="obj", surface="bilinear").cage().scheme == "bilinear"
    with pytest.raises(chordal.Refused, match="surface="):
        chordal.load(text.encode(), format="obj").cage()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"faces": [(0, 1)]}, "faces: face 0 has fewer than three"),
        ({"faces": [(0, 1, 8)]}, "faces: face 0 uses vertex 8"),
        ({"faces": [(0, 1, 0)]}, "faces: face 0 uses vertex 0 twice"),
        ({"faces": [(0, 1, -1)]}, "faces: the number at"),
        ({"positions": [(0, 0)]}, "positions: rows of 3"),
        ({"positions": [(0, 0, np.nan)]}, "positions: .* not finite"),
        ({"creases": [(0, 7, 1)]}, "creases: there is no edge"),
        ({"creases": [(0, 1, -1)]}, "a sharpness is 0 or more"),
        ({"corners": [(8, 1)]}, "corners: there is no vertex 8"),
        ({"holes": [6]}, "holes: there is no face 6"),
        ({"holes": [-1]}, "holes: -1 is no index"),
        ({"scheme": "doo-sabin"}, "scheme: one of 'catmull-clark'"),
        ({"boundary": "x"}, "boundary: one of 'none'"),
    ],
)
def test_what_is_no_cage_is_refused(change: dict[str, object], words: str) -> None:
    arguments: dict[str, object] = {"positions": CORNERS, "faces": SIDES}
    with pytest.raises(ValueError, match=words):
        chordal.Cage(**{**arguments, **change})  # type: ignore[arg-type]


def test_too_many_rounds_are_refused_before_the_work() -> None:
    with pytest.raises(chordal.Refused, match="6442450944 faces"):
        chordal.Cage(CORNERS, SIDES).refined(15)
