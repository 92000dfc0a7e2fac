"""Scenes that are put together: parts, nodes, materials, and what is known of their distance to the truth."""

from __future__ import annotations

import json
import math
import types
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import ROOT

import chordal
from chordal.shapes import box, move, sphere

CORNERS = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
FACES = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]
SOLID = chordal.Mesh(CORNERS, FACES)
PAINTED = chordal.Mesh(CORNERS, FACES, uv=[(0, 0), (1, 0), (0, 1), (1, 1)])
ANY: Any = chordal


def again(scene: chordal.Mesh) -> chordal.Mesh:
    return chordal.load(scene.to_bytes("glb"), format="glb")


def materials_of(part: chordal.Part) -> list[float] | None:
    found = part.attribute("group", "material")
    return None if found is None else np.unique(found.values).tolist()


def test_meshes_become_parts_with_names_and_stay_where_they_are() -> None:
    moved = SOLID.translate(5, 0, 0)
    for scene in (chordal.scene({"a": SOLID, "b": moved}), again(chordal.scene({"a": SOLID, "b": moved}, unit="m", up="y"))):
        assert [part.name for part in scene.parts] == ["a", "b"] and [node.part for node in scene.nodes] == [0, 1]
        assert np.array_equal(scene.vertices, np.vstack([SOLID.vertices, moved.vertices]))
        assert np.array_equal(scene.faces, np.vstack([SOLID.faces, SOLID.faces + 4]))
    assert repr(chordal.scene(SOLID, SOLID)) == "<Mesh: 8 triangles, 8 vertices, from arrays>"
    assert len(chordal.scene([SOLID, moved]).parts) == 2


def test_one_mesh_in_several_places_is_one_part() -> None:
    turned = [[0, -1, 0, 7], [1, 0, 0, 0], [0, 0, 1, 0]]
    scene = chordal.scene(chordal.Placed(SOLID, [(2, 0, 0), (0, 3, 0)], name="leg"), chordal.Placed(SOLID, turned), SOLID)
    assert len(scene.parts) == 1 and [node.name for node in scene.nodes] == ["leg", "leg", "triangles", "triangles"]
    expected = [SOLID.translate(2, 0, 0), SOLID.translate(0, 3, 0), SOLID.transform(turned), SOLID]
    assert np.array_equal(scene.vertices, np.vstack([one.vertices for one in expected]))
    assert scene.nodes[2].matrix == tuple(tuple(map(float, row)) for row in [*turned, [0, 0, 0, 1]])
    assert len(scene.to_bytes("glb")) < 1.5 * len(SOLID.to_bytes("glb")) + 500


def test_groups_are_nodes_with_children() -> None:
    pair = chordal.Placed({"left": SOLID, "right": chordal.Placed(SOLID, (3, 0, 0))}, np.diag([2.0, 2, 2, 1]), name="pair")
    scene = chordal.scene({"both": chordal.Placed([pair], (0, 0, 1)), "one": SOLID})
    assert len(scene.parts) == 1 and len(scene.roots) == 2
    top = scene.nodes[scene.roots[0]]
    (below,) = (scene.nodes[child] for child in top.children)
    assert (top.name, below.name, [scene.nodes[child].name for child in below.children]) == ("both", "pair", ["left", "right"])
    up = np.array([0, 0, 1.0])
    expected = np.vstack([SOLID.vertices * 2 + up, (SOLID.vertices + (3, 0, 0)) * 2 + up, SOLID.vertices])
    assert np.array_equal(scene.vertices, expected)
    assert np.allclose(again(chordal.scene(scene, unit="m", up="y")).vertices, expected)
    # A dictionary in a dictionary is a group, too, and a matrix over another multiplies it.
    nested = chordal.scene({"pair": {"a": SOLID, "b": chordal.Placed(chordal.Placed(SOLID, (1, 0, 0)), (0, 1, 0))}})
    assert np.array_equal(nested.vertices[4:], SOLID.vertices + (1, 1, 0))
    assert nested.nodes[nested.roots[0]].name == "pair"


def test_a_material_is_written_as_gltf_describes_it(tmp_path: Path) -> None:
    picture = sphere(1).render(size=(8, 8))
    (tmp_path / "a.png").write_bytes(picture.to_bytes("png"))
    red = chordal.Material("red", color="#f00", metallic=0.25, roughness=0.5, double_sided=True)
    wood = chordal.Material(
        "wood", (0.5, 0.5, 0.5, 0.5), texture=picture, normal_texture=tmp_path / "a.png", alpha="mask", cutoff=0.25
    )
    lamp = chordal.Material("lamp", emissive=(1, 0.5, 0), emissive_texture=picture.to_bytes("jpg"), alpha="blend")
    things = [chordal.Placed(SOLID, material=red), chordal.Placed(PAINTED, material=wood), chordal.Placed(PAINTED, material=lamp)]
    scene = chordal.scene(*things, unit="m", up="y")
    assert [materials_of(part) for part in scene.parts] == [[1], [2], [3]]
    for one in (scene, again(scene)):
        assert one.materials[0] == {
            "name": "red",
            "pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 1], "metallicFactor": 0.25, "roughnessFactor": 0.5},
            "doubleSided": True,
        }
        assert one.materials[1]["alphaMode"] == "MASK" and one.materials[1]["alphaCutoff"] == 0.25
        # The picture and the file are the same, and there once.
        index = one.materials[1]["pbrMetallicRoughness"]["baseColorTexture"]["index"]
        assert one.materials[1]["normalTexture"]["index"] == index and len(one.images) == 2
        assert one.images[one.textures[index]["source"]] == picture.to_bytes("png")
        assert one.materials[2]["emissiveFactor"] == [1, 0.5, 0] and one.materials[2]["alphaMode"] == "BLEND"
    uv = again(scene).parts[1].uv
    # A file of glTF counts v from above, and here it is up.
    assert uv is not None and np.array_equal(uv, PAINTED.uv)  # type: ignore[arg-type]


def test_colours_are_light_or_srgb() -> None:
    assert chordal.Material(color="#ffffff") == chordal.Material() and repr(chordal.Material()) == "Material()"
    half: Any = chordal.Material(color="#80808080").color
    assert half[3] == 128 / 255 and abs(half[0] - 0.215861) < 1e-6
    assert chordal.Material(color=np.array([0, 0.5, 1])).color == (0, 0.5, 1, 1)
    assert repr(chordal.Material("a", color=(1, 0, 0), texture=b"1234")) == "Material('a', color=(1.0, 0.0, 0.0), texture=<4 bytes>)"


def test_scenes_in_a_scene_keep_what_they_have() -> None:
    painted = chordal.load(ROOT / "tests/web/painted.gltf", kind=chordal.Mesh)
    green = chordal.Placed(SOLID, material=chordal.Material("green", color="#0f0"))
    with pytest.warns(UserWarning, match="animations, cameras: these stay behind") as told:
        scene = chordal.scene({"green": green, "painted": painted}, unit="m")
    assert told[0].filename == __file__
    assert [material["name"] for material in scene.materials] == ["green", *(one["name"] for one in painted.materials)]
    assert scene.materials[1]["pbrMetallicRoughness"]["baseColorTexture"] == {"index": 0} and scene.images == painted.images
    assert [materials_of(part) for part in scene.parts] == [[1], [2, 3]]
    assert np.array_equal(scene.vertices, np.vstack([SOLID.vertices, painted.vertices]))
    assert [node.name for node in scene.nodes] == ["green", *(node.name for node in painted.nodes), "painted"]
    # One with another material has no other, and no picture that is shown.
    with pytest.warns(UserWarning, match="stay behind"):
        plain = chordal.scene(chordal.Placed(painted, material=chordal.Material("blue")))
    assert [one["name"] for one in plain.materials] == ["blue"] and materials_of(plain.parts[0]) == [1] and not plain.images
    # Twice the same is one part, and twice the textures are two sets of them.
    with pytest.warns(UserWarning, match="stay behind"):
        twice = chordal.scene(painted, chordal.Placed(painted, (9, 0, 0)), again(chordal.scene(painted)))
    assert len(twice.parts) == 2 and len(twice.materials) == 4
    assert twice.materials[2]["pbrMetallicRoughness"]["baseColorTexture"] == {"index": 1}
    assert twice.textures[1]["source"] == 1 and materials_of(twice.parts[1]) == [3, 4]


def test_texture_coordinates_from_different_ends_are_of_one() -> None:
    loaded = again(chordal.scene(PAINTED, unit="m", up="y"))
    both = chordal.scene(PAINTED, loaded, unit="m")
    one, other = (part.uv for part in both.parts)
    assert one is not None and other is not None and np.array_equal(one, other)


def test_groups_of_files_are_numbered_on() -> None:
    text = b"mtllib x.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\ng a\nusemtl red\nf 1 2 3\ng b\nusemtl blue\nf 1 3 2\n"
    two = [chordal.load(text, format="obj", kind=chordal.Mesh) for _ in range(2)]
    scene = chordal.scene(two)
    assert [material["name"] for material in scene.materials] == ["red", "blue", "red", "blue"]
    assert [materials_of(part) for part in scene.parts] == [[1, 2], [3, 4]]
    groups = [part.attribute("group", "g") for part in scene.parts]
    assert [one.values.ravel().tolist() for one in groups if one is not None] == [[1, 2], [3, 4]]


def test_the_bound_is_stretched_by_all_that_is_above() -> None:
    ball = sphere(1).mesh(tol=0.05)
    most = ball.bound.at_most
    assert most is not None
    assert chordal.scene(ball).bound.at_most == most and chordal.scene(SOLID).bound.at_most == 0
    scene = chordal.scene(chordal.Placed([chordal.Placed(ball, np.diag([3.0, 2, 1, 1]))], np.diag([2.0, 2, 2, 1])), SOLID)
    assert scene.bound.at_most is not None and 6 * most < scene.bound.at_most < 6 * most * (1 + 1e-12)
    assert scene.bound.evidence == "proved" and scene.bound.at_least == 0
    # An oracle: the sphere as a field, moved in the same way.
    moved = chordal.scene(chordal.Placed(ball, [[0, -2, 0, 5], [2, 0, 0, 0], [0, 0, 2, 1]]))
    assert moved.bound.at_most is not None
    off = sphere(2).move(5, 0, 1)(moved.vertices)
    assert np.abs(off).max() <= moved.bound.at_most
    measured = (sphere(1) | move(sphere(1), 1, 0, 0)).mesh(tol=0.05, require="measured")
    assert chordal.scene(measured, ball).bound.at_most is None and chordal.scene(measured, ball).bound.evidence == "measured"


def test_what_does_not_fit_together_is_said() -> None:
    inches, plain = chordal.Mesh(CORNERS, FACES, unit="in"), SOLID
    with pytest.raises(ValueError, match=r"in different units \(in, none\)"):
        chordal.scene(inches, plain)
    assert chordal.scene(inches, plain, unit="in").unit == "in"
    with pytest.raises(ValueError, match="y is up in some and z in others"):
        chordal.scene(again(chordal.scene(SOLID, unit="m", up="y")), unit="m", up="z")
    with pytest.raises(ValueError, match="no texture coordinates"):
        chordal.scene(chordal.Placed(SOLID, material=chordal.Material(texture=sphere(1).render(size=(8, 8)))))
    with pytest.raises(ValueError, match="PNG or JPEG"):
        chordal.scene(chordal.Placed(PAINTED, material=chordal.Material(texture=b"GIF89a")))
    wrong: list[tuple[Any, type[Exception], str]] = [
        (lambda: ANY.scene(), ValueError, "there is none"),
        (lambda: ANY.scene([]), ValueError, "there is none"),
        (lambda: ANY.scene(sphere(1)), TypeError, "mesh them first"),
        (lambda: ANY.scene(3), TypeError, "things: a shape"),
        (lambda: ANY.scene(SOLID, units="mm"), TypeError, "unit="),
        (lambda: ANY.scene(SOLID, up="x"), ValueError, "up: y or z"),
        (lambda: ANY.scene(ANY.Placed(SOLID, (1, 2))), ValueError, "at: a vector"),
        (lambda: ANY.scene(ANY.Placed(SOLID, np.zeros((4, 4)))), ValueError, "last row"),
        (lambda: ANY.scene(ANY.Placed(SOLID, np.diag([1.0, 1, 0, 1]))), ValueError, "flattens"),
        (lambda: ANY.scene(ANY.Placed(SOLID, material="red")), TypeError, "material: a Material"),
        (lambda: ANY.Material(color="red"), ValueError, 'color: a text as in "#d33"'),
        (lambda: ANY.Material(color=(1, 2, 3)), ValueError, "color: from 0 to 1, not 2"),
        (lambda: ANY.Material(color=(1, 1)), ValueError, "color: three or four numbers"),
        (lambda: ANY.Material(emissive=(1, 1, 1, 1)), ValueError, "emissive: three numbers"),
        (lambda: ANY.Material(roughness=2), ValueError, "roughness: from 0 to 1"),
        (lambda: ANY.Material(alpha="see-through"), ValueError, "alpha: opaque"),
    ]
    for call, error, said in wrong:
        with pytest.raises(error, match=said):
            call()


def test_a_material_of_another_scene_is_taken_as_gltf_has_it() -> None:
    red = {"name": "red", "extensions": {"KHR_materials_clearcoat": {"clearcoatFactor": 1}}}
    scene = chordal.scene(chordal.Placed([SOLID, SOLID], material=red))
    assert scene.materials == [red] and len(scene.parts) == 1
    with pytest.raises(ValueError, match="textures of a dictionary"):
        chordal.scene(chordal.Placed(PAINTED, material={"normalTexture": {"index": 0}}))


def test_meshes_of_other_libraries_and_files_are_taken(tmp_path: Path) -> None:
    other = types.SimpleNamespace(vertices=SOLID.vertices, faces=SOLID.faces)
    (tmp_path / "a.ply").write_bytes(SOLID.to_bytes("ply"))
    scene = chordal.scene({"theirs": other, "again": other, "file": tmp_path / "a.ply"})
    assert len(scene.parts) == 2 and [node.name for node in scene.nodes] == ["theirs", "again", "file"]


def test_a_scene_is_a_mesh_for_all_else(tmp_path: Path) -> None:
    pair = chordal.Placed(sphere(1).mesh(tol=0.01), [(0, 0, 0), (3, 0, 0)])
    balls = chordal.scene(pair, chordal.Placed(box(1, 1, 1).mesh(tol=0.01), (1.5, 0, 0)))
    assert balls.is_watertight and math.isclose(balls.volume, 2 * 4 / 3 * math.pi + 1, rel_tol=0.02)
    assert len(balls.split()) == 3 and len(balls.mesh(triangles=200).faces) <= 200
    assert json.loads(json.dumps(balls.export(tmp_path / "a.glb")))["certificate"]["bound"]["at_most"] < 1e-6


def test_triangles_that_are_moved_far_away_are_rounded_there() -> None:
    triangle = chordal.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    assert chordal.scene({"a": triangle, "b": triangle}).bound.at_most == 0
    far = chordal.scene(chordal.Placed(triangle, (1e10, 1 / 3, 0))).bound
    assert far.evidence == "proved" and far.is_within(1e-4) and not far.is_within(1e-6)
