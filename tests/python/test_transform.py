"""Meshes that are moved, turned and scaled: where their points go, what stays, and what their bound is then."""

from __future__ import annotations

import base64
import json
import pickle
from typing import Any

import numpy as np
import pytest

import chordal
from chordal import shapes

CORNERS = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], dtype=float)
FACES = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]
NORMALS = np.array([(0, 0, 1), (1, 0, 0), (0, 1, 0), (0.6, 0.8, 0)])
UV = np.random.default_rng(3).random((4, 2))
SOLID = chordal.Mesh(CORNERS, FACES, normals=NORMALS, uv=UV, colors=np.eye(4), unit="mm")


def gltf_of(node: dict[str, Any]) -> bytes:
    """A triangle with normals along z under a node."""
    positions = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0)], dtype="<f4").tobytes()
    normals = np.array([(0, 0, 1)] * 3, dtype="<f4").tobytes()
    data = base64.b64encode(positions + normals).decode()
    accessor = {"componentType": 5126, "count": 3, "type": "VEC3"}
    return json.dumps(
        {
            "asset": {"version": "2.0"},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0, **node}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1}, "material": 0}]}],
            "materials": [{"name": "red", "pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 1]}}],
            "buffers": [{"byteLength": 72, "uri": f"data:application/octet-stream;base64,{data}"}],
            "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 36}],
            "accessors": [
                {**accessor, "bufferView": 0, "min": [0, 0, 0], "max": [1, 1, 0]},
                {**accessor, "bufferView": 1},
            ],
        }
    ).encode()


def test_points_go_where_the_matrix_takes_them_within_the_bound() -> None:
    random = np.random.default_rng(1)
    for _ in range(50):
        matrix = np.eye(4)
        matrix[:3] = random.normal(size=(3, 4)) * 10.0 ** random.integers(-3, 4)
        moved = SOLID.transform(matrix)
        wide = matrix.astype(np.longdouble)
        wanted = CORNERS @ wide[:3, :3].T + wide[:3, 3]
        assert moved.bound.at_most is not None
        assert np.linalg.norm((moved.vertices - wanted).astype(float), axis=1).max() <= moved.bound.at_most
        assert moved.volume == pytest.approx(abs(np.linalg.det(matrix)) / 6)
        assert moved.is_watertight and moved.unit == "mm"
        assert moved.uv is not None and np.array_equal(moved.uv, UV)
        assert moved.colors is not None and np.array_equal(moved.colors, np.eye(4))
        turned = NORMALS @ np.linalg.inv(matrix[:3, :3])
        turned /= np.linalg.norm(turned, axis=1, keepdims=True)
        assert moved.normals is not None and np.allclose(moved.normals, turned, atol=1e-9)


def test_the_bound_is_scaled_along() -> None:
    ball = shapes.sphere(1).mesh(tol=0.05)
    for moved, center, radius in (
        (ball.translate(3, 0, 0), (3, 0, 0), 1),
        (ball.scale(2.5), (0, 0, 0), 2.5),
        (ball.rotate((1, 2, 3), 33, about=(0, 1, 0)).scale(-4, about=(1, 0, 0)), None, 4),
    ):
        assert moved.bound.evidence == "proved" and moved.bound.reference == ball.bound.reference
        assert moved.bound.at_most is not None and ball.bound.at_most is not None
        assert moved.bound.at_most == pytest.approx(radius * ball.bound.at_most)
        assert moved.bound.at_most >= radius * ball.bound.at_most
        assert moved.bound.at_least == pytest.approx(radius * ball.bound.at_least)
        if center is not None:
            off = np.abs(np.linalg.norm(moved.vertices - center, axis=1) - radius)
            assert off.max() <= moved.bound.at_most
        assert pickle.loads(pickle.dumps(moved)).bound == moved.bound
    flat = ball.scale((1, 1, 0.5)).bound
    assert flat.at_least == pytest.approx(0.5 * ball.bound.at_least) and flat.at_most == pytest.approx(ball.bound.at_most)


def test_what_moves_nothing_is_the_mesh_itself() -> None:
    assert SOLID.transform(np.eye(4)) is SOLID and SOLID.translate(0, 0, 0) is SOLID and SOLID.rotate("x", 360) is SOLID
    assert SOLID.to_unit("mm") is SOLID and SOLID.scale(1) is SOLID


def test_quarter_turns_and_mirrors_are_exact() -> None:
    turned = SOLID.rotate("x", -270)
    assert turned.vertices.tolist() == [[0, 0, 0], [1, 0, 0], [0, 0, 1], [0, -1, 0]]
    mirrored = SOLID.scale((-1, 1, 1))
    assert mirrored.volume == SOLID.volume and mirrored.faces.tolist()[0] == [0, 1, 2]
    around = SOLID.rotate("z", 180, about=(1, 0, 0))
    assert around.vertices[1].tolist() == [1, 0, 0]
    assert SOLID.translate(np.array([0, 0, 2])).vertices[0].tolist() == [0, 0, 2]


def test_a_scene_with_nodes_keeps_its_parts_and_materials() -> None:
    turned = chordal.load(gltf_of({"rotation": [0.5**0.5, 0, 0, 0.5**0.5]}), format="gltf")
    # What the only part says is in the space of the vertices.
    assert turned.normals is not None and np.allclose(turned.normals, (0, -1, 0), atol=1e-6)
    assert turned.parts[0].normals is not None and turned.parts[0].normals[0].tolist() == [0, 0, 1]
    assert np.allclose(turned.vertex_normals, turned.face_normals[0], atol=1e-6)
    moved = turned.translate(0, 0, 5)
    assert np.array_equal(moved.parts[0].vertices, turned.parts[0].vertices)
    assert np.allclose(moved.vertices, turned.vertices + (0, 0, 5)) and moved.materials[0]["name"] == "red"
    again = chordal.load(moved.to_bytes("glb"), format="glb")
    assert np.allclose(again.vertices, moved.vertices) and again.materials[0]["name"] == "red"


def test_all_parts_move() -> None:
    halves = np.ones((6, 6, 6), np.uint8)
    halves[3:] = 2
    mesh = chordal.labels(halves).mesh()
    moved = mesh.scale(2).translate(1, 1, 1)
    assert [part.name for part in moved.parts] == ["label 1", "label 2"]
    assert np.array_equal(moved.vertices, mesh.vertices * 2 + 1)
    assert np.array_equal(moved.parts[1].vertices, mesh.parts[1].vertices * 2 + 1)


def test_a_unit_is_another_one() -> None:
    inches = chordal.Mesh(CORNERS, FACES, unit="in")
    assert inches.unit == "in" and inches.to_unit("mm").vertices[1].tolist() == [25.4, 0, 0]
    assert inches.to_unit("mm").mesh(tol="1mm").bound.at_most is not None
    assert inches.to_unit("ft").to_unit("in").extents == pytest.approx([1, 1, 1])
    assert chordal.load(gltf_of({}), format="gltf").unit == "m"
    bare = chordal.Mesh(CORNERS, FACES)
    assert bare.unit is None
    with pytest.raises(ValueError, match="nothing says the unit"):
        bare.to_unit("mm")
    with pytest.raises(ValueError, match="one of um, mm"):
        inches.to_unit("inch")  # type: ignore[arg-type]


def test_what_is_no_map_is_refused() -> None:
    for wrong in (np.eye(3), np.ones((4, 4)), np.zeros((4, 4)), np.diag([1, 1, 0, 1]), np.full((4, 4), np.nan)):
        with pytest.raises(ValueError, match="matrix: "):
            SOLID.transform(wrong)
    with pytest.raises(ValueError, match="by: three numbers"):
        SOLID.translate(1, 2)
    with pytest.raises(ValueError, match="axis: x, y, z or a vector"):
        SOLID.rotate("w", 90)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="no direction"):
        SOLID.rotate((0, 0, 0), 90)
    with pytest.raises(ValueError, match="matrix: "):
        SOLID.scale(1e308).scale(1e308)
