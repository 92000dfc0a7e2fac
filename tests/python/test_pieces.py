"""Pieces of meshes, meshes as one, and facts of meshes that other libraries have, too."""

from __future__ import annotations

import types
from typing import Any

import numpy as np
import pytest
from test_transform import CORNERS, FACES, NORMALS, UV, gltf_of

import chordal

SOLID = chordal.Mesh(CORNERS, FACES, normals=NORMALS, uv=UV, unit="mm")


def test_meshes_stand_next_to_each_other_and_come_apart_again() -> None:
    random = np.random.default_rng(1)
    for _ in range(20):
        pieces = [SOLID.translate(3 * k, *random.normal(size=2)) for k in range(int(random.integers(1, 6)))]
        whole = chordal.concatenate(pieces)
        assert whole.is_watertight and whole.unit == "mm" and whole.volume == pytest.approx(len(pieces) / 6)
        assert len(whole.parts) == 1 and whole.uv is not None and len(whole.uv) == 4 * len(pieces)
        apart = whole.split()
        assert len(apart) == len(pieces)
        for one, other in zip(apart, pieces, strict=True):
            assert np.array_equal(one.vertices, other.vertices) and np.array_equal(one.faces, other.faces)
            assert one.uv is not None and np.array_equal(one.uv, UV) and one.unit == "mm"
            assert one.normals is not None and np.allclose(one.normals, NORMALS) and one.is_watertight


def test_faces_in_any_order_are_split_by_what_joins_them() -> None:
    random = np.random.default_rng(2)
    sizes = [30, 1, 7, 100]
    corners, rows, start = [], [], 0
    for k, size in enumerate(sizes):
        # A strip, whose vertices have random numbers.
        corners.append(np.column_stack([np.arange(size + 2), np.arange(size + 2) % 2, np.full(size + 2, k)]))
        rows.append(start + np.arange(size)[:, None] + [0, 1, 2])
        start += size + 2
    points, faces = np.concatenate(corners), np.concatenate(rows)
    order = random.permutation(len(points))
    mesh = chordal.Mesh(points[order], np.argsort(order)[faces[random.permutation(len(faces))]])
    assert sorted(len(piece.faces) for piece in mesh.split()) == sorted(sizes)
    assert sum(piece.area for piece in mesh.split()) == pytest.approx(mesh.area)


def test_positions_join_where_a_format_has_no_indices() -> None:
    solid = chordal.load(SOLID.to_bytes("stl"), format="stl")
    assert isinstance(solid, chordal.Mesh)
    both = chordal.concatenate([solid, solid.translate(3, 0, 0)])
    assert both.is_watertight and [len(piece.faces) for piece in both.split()] == [4, 4]
    assert len(solid.split()) == 1 and solid.split()[0].is_watertight


def test_pieces_of_a_scene_keep_their_place_and_material() -> None:
    lying = chordal.load(gltf_of({"translation": [1, 2, 3]}), format="gltf")
    [piece] = lying.split()
    assert np.array_equal(piece.vertices, lying.vertices) and piece.materials[0]["name"] == "red" and piece.unit == "m"
    halves = np.ones((6, 6, 6), np.uint8)
    halves[3:] = 2
    assert [piece.parts[0].name for piece in chordal.labels(halves).mesh().split()] == ["label 1", "label 2"]


def test_the_bound_of_all_is_the_largest() -> None:
    fine, coarse = (chordal.shapes.sphere(1).mesh(tol=tol) for tol in (0.01, 0.1))
    both = fine + coarse
    assert both.bound.at_most == coarse.bound.at_most and both.bound.evidence == "proved"
    ball = chordal.shapes.sphere(1)
    measured = (ball | chordal.shapes.move(ball, 1, 0, 0)).mesh(tol=0.1, require="measured")
    assert (fine + measured).bound.evidence == "measured" and (fine + measured).bound.at_most is None
    assert (SOLID + SOLID).bound.at_most == 0
    other = types.SimpleNamespace(vertices=CORNERS, faces=np.array(FACES))
    assert len((fine + other).faces) == len(fine.faces) + 4


def test_what_does_not_go_together_is_refused() -> None:
    with pytest.raises(ValueError, match="there is none"):
        chordal.concatenate([])
    with pytest.raises(ValueError, match="different units"):
        chordal.concatenate([SOLID, SOLID.to_unit("cm")])
    with pytest.raises(TypeError, match="triangles, not fields: mesh them first"):
        chordal.concatenate([SOLID, chordal.shapes.sphere(1)])
    with pytest.raises(TypeError, match="unsupported operand"):
        SOLID + 1


def test_facts_are_those_of_the_shape() -> None:
    assert SOLID.center_mass == pytest.approx([0.25] * 3)
    far: Any = SOLID.translate(1e6, 0, 0)
    assert far.center_mass == pytest.approx([1e6 + 0.25, 0.25, 0.25], abs=1e-9)
    flat = chordal.Mesh(CORNERS[:3], [(0, 1, 2)])
    assert flat.center_mass == pytest.approx([1 / 3, 1 / 3, 0])
    assert (SOLID.euler_number, flat.euler_number) == (2, 1)
    ring = chordal.shapes.arc(0.5, center=(2, 0)).revolve().mesh(tol=0.1)
    assert ring.euler_number == 0 and ring.center_mass == pytest.approx([0, 0, 0], abs=1e-9)
    assert SOLID.is_winding_consistent
    assert not chordal.Mesh(CORNERS, [FACES[0][::-1], *FACES[1:]]).is_winding_consistent
    with pytest.raises(ValueError, match="no centre"):
        chordal.Mesh(np.zeros((0, 3)), np.zeros((0, 3), int)).center_mass


def test_texture_coordinates_of_files_that_count_from_other_ends_are_one() -> None:
    from_glb = chordal.load(SOLID.to_bytes("glb"), format="glb")
    given = SOLID.to_unit("m")
    both = chordal.concatenate([given, from_glb])
    assert both.uv is not None and from_glb.uv is not None
    # Single precision, which a GLB holds.
    assert np.allclose(both.uv[:4], UV) and np.allclose(both.uv[4:], UV[_order_of(from_glb)], atol=1e-6)


def _order_of(mesh: Any) -> list[int]:
    """For each vertex the one that it was."""
    near = np.linalg.norm(mesh.vertices[:, None] - SOLID.to_unit("m").vertices[None], axis=2)
    return [int(k) for k in near.argmin(axis=1)]
