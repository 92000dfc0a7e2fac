"""The verbs of the command on shapes, and as functions of files."""

from __future__ import annotations

import inspect
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import ROOT, SQUARE, TEAPOT, Command

import chordal
from chordal.shapes import box, sphere

CORNERS = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
OPEN = [(0, 2, 1), (0, 1, 3), (1, 2, 3)]
WHOLE = [*OPEN, (2, 0, 3)]


def test_verbs_take_shapes_files_and_bytes() -> None:
    by_shape = chordal.load(TEAPOT).mesh(tol=0.1)
    for source in (TEAPOT, str(TEAPOT), TEAPOT.read_bytes()):
        assert chordal.mesh(source, tol=0.1).bound == by_shape.bound
    assert chordal.inspect(TEAPOT)["certificate"] == chordal.load(TEAPOT).inspect()["certificate"]
    with pytest.raises(TypeError, match="shape: a shape, a path, bytes, or a mesh of another library, not int"):
        chordal.mesh(3, tol=0.1)


def test_a_verb_has_the_arguments_of_its_method() -> None:
    for name in ("mesh", "flatten", "lod", "inspect", "mend", "bake", "render"):
        ours, method = getattr(chordal, name), getattr(chordal.Shape, name)
        own = list(inspect.signature(method).parameters)[1:]
        assert list(inspect.signature(ours).parameters)[1:] == own
        assert ours.__doc__ and method.__doc__


def test_a_file_of_levels_is_that_of_the_command(tmp_path: Path, cargo_chordal: Command) -> None:
    levels = chordal.lod(TEAPOT, pixels=1, tol=0.02)
    report = levels.export(tmp_path / "ours.glb")
    done = cargo_chordal("lod", TEAPOT, "--px", "1", "--tol", "0.02", "-o", tmp_path / "theirs.glb")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "ours.glb").read_bytes() == (tmp_path / "theirs.glb").read_bytes()
    assert report["run"]["bytes"] == (tmp_path / "ours.glb").stat().st_size
    assert levels.to_bytes("glb") == (tmp_path / "ours.glb").read_bytes()


def test_levels_say_from_where_each_may_be_shown() -> None:
    levels = chordal.load(TEAPOT).lod(pixels=1, tol=0.02)
    assert len(levels) > 3 and levels[0].bound.at_most is not None and levels[0].bound.at_most <= 0.02
    counts = [len(level.mesh.faces) for level in levels]
    assert counts == sorted(counts, reverse=True)
    for level in levels[1:]:
        assert level.distance is not None and level.mesh.bound == level.bound
        assert levels.at(level.distance) is level and len(levels.at(level.distance * 0.999).mesh.faces) > len(level.mesh.faces)
    assert levels.at(0) is levels[0] and levels.at(1e9) is levels[len(levels) - 1]


def test_tiles_stand_in_a_folder(tmp_path: Path, cargo_chordal: Command) -> None:
    mesh = chordal.load(TEAPOT).mesh(tol=0.01)
    levels = mesh.lod(pixels=1, tol=0.005, tile_triangles=1000)
    levels.export(tmp_path / "tiles")
    tileset = json.loads((tmp_path / "tiles/tileset.json").read_text())
    assert tileset["root"]["children"] and len(list((tmp_path / "tiles").glob("*.glb"))) > 4
    with pytest.raises(LookupError, match="3D Tiles"):
        levels[0]
    with pytest.raises(ValueError, match="as .glb, .gltf, or into a folder"):
        levels.export(tmp_path / "levels.stl")


def test_arguments_of_levels_are_named() -> None:
    shape = chordal.load(TEAPOT)
    for named, kind, says in (
        ({"pixels": 0}, chordal.BudgetError, "pixels"),
        ({"view": "fov=60"}, chordal.BudgetError, "view"),
        ({"view": "1920x1080 fov=60 dist=3", "nearest": 2.0}, chordal.BudgetError, "nearest"),
        ({"errors": "some"}, ValueError, "errors"),
        ({"at": "nowhere"}, ValueError, "at"),
        ({"compress": "zip"}, ValueError, "meshopt"),
    ):
        with pytest.raises(kind, match=says):
            shape.lod(**named)


def test_repairs_are_asked_for_by_name(tmp_path: Path, cargo_chordal: Command) -> None:
    sick = chordal.Mesh(CORNERS, OPEN)
    assert not sick.is_watertight
    whole = sick.mend(fill_holes=True)
    assert whole.is_watertight and whole.report["run"]["verb"] == "mend"
    assert [facts["cure"] for facts in whole.report["certificate"]["mended"]][0] == "fill-holes"
    with pytest.raises(ValueError, match="name a repair"):
        sick.mend()
    with pytest.raises(ValueError, match="drop_duplicates"):
        sick.mend(drop_duplicates="some")  # type: ignore[arg-type]
    with pytest.raises(chordal.Refused):
        chordal.load(TEAPOT).mend(all=True)
    sick.export(tmp_path / "sick.ply")
    done = cargo_chordal("mend", tmp_path / "sick.ply", "--all", "-o", tmp_path / "theirs.glb")
    assert done.returncode == 0, done.stderr
    chordal.mend(tmp_path / "sick.ply", all=True).export(tmp_path / "ours.glb")
    assert (tmp_path / "ours.glb").read_bytes() == (tmp_path / "theirs.glb").read_bytes()


def test_a_picture_is_that_of_the_command(tmp_path: Path, cargo_chordal: Command) -> None:
    picture = chordal.render(TEAPOT, size=(64, 48))
    assert picture.array.shape == (48, 64, 4) and picture.array.dtype == np.uint8 and picture.array.std() > 10
    picture.export(tmp_path / "ours.png")
    done = cargo_chordal("render", TEAPOT, "--size", "64x48", "-o", tmp_path / "theirs.png")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "ours.png").read_bytes() == (tmp_path / "theirs.png").read_bytes()
    assert np.array_equal(chordal.render(TEAPOT, view=picture.view).array, picture.array)
    assert picture._repr_png_()[:4] == b"\x89PNG"


def test_a_picture_shows_how_far_two_shapes_are_apart() -> None:
    fine, coarse = (chordal.load(TEAPOT).mesh(tol=tol) for tol in (0.01, 0.1))
    picture = coarse.render(show="deviation", against=fine, size=(64, 48))
    assert picture.darkest is not None and 0 < picture.darkest <= 0.11
    for named in ({"show": "deviation"}, {"against": fine}, {"show": "x-rays"}, {"cull": "some"}):
        with pytest.raises(ValueError):
            coarse.render(**named)


@pytest.mark.parametrize("extension", ["stl", "ply", "off", "obj", "glb", "gltf", "3mf", "vtp", "usda"])
def test_a_mesh_goes_to_every_format_and_back(tmp_path: Path, extension: str) -> None:
    mesh = chordal.Mesh(CORNERS, WHOLE)
    path = tmp_path / f"one.{extension}"
    report = chordal.convert(mesh, path)
    assert report["certificate"]["bound"]["at_most"] == 0 and report["run"]["verb"] == "convert"
    back = chordal.load(path)
    assert isinstance(back, chordal.Mesh) and back.is_watertight and abs(back.volume - 1 / 6) < 1e-15


def test_what_is_no_mesh_is_not_written_as_one(tmp_path: Path) -> None:
    for shape in (chordal.load(TEAPOT), sphere(1)):
        with pytest.raises(chordal.Refused, match="budget|tol"):
            shape.export(tmp_path / "one.glb")
    volume = sphere(1).bake(cells=8)
    volume.export(tmp_path / "one.npy")
    assert np.array_equal(np.load(tmp_path / "one.npy"), volume.array)
    volume.export(tmp_path / "one.nrrd")
    assert np.array_equal(chordal.volume(tmp_path / "one.nrrd").affine, volume.affine)


def test_solids_are_combined_by_name() -> None:
    one, two = (box(2, 2, 2).mesh(tol=0.1), chordal.shapes.move(box(2, 2, 2), 1, 0, 0).mesh(tol=0.1))
    volumes = [op(one, two).volume for op in (chordal.union, chordal.difference, chordal.intersection)]
    assert np.allclose(volumes, (12, 4, 4))
    assert np.isclose(one.union(two).volume, 12) and np.isclose((one - two).volume, 4)
    assert np.isclose(chordal.difference(one, sphere(0.5), tol=0.01).volume, 8 - np.pi / 6, atol=0.03)


def test_the_distance_to_triangles_is_a_field() -> None:
    solid = chordal.Mesh(CORNERS, WHOLE, unit="mm")
    field = solid.to_field()
    assert field([[0.25, 0.25, -2.0]])[0] == 2 and field([[0.25, 0.25, 0.125]])[0] == -0.125
    cut = (field - sphere(0.3)).mesh(tol=0.1)
    assert cut.is_watertight and cut.volume < solid.volume
    assert solid.to_field().mesh(tol="0.01mm").is_watertight
    ring = chordal.load(TEAPOT).to_field(tol=0.5)
    assert abs(ring([[100.0, 0, 0]])[0]) > 90
    with pytest.raises(chordal.BudgetError):
        chordal.load(TEAPOT).to_field()


def test_a_scene_has_parts_nodes_materials_and_attributes() -> None:
    scene: Any = chordal.load(ROOT / "tests/web/painted.gltf")
    assert scene.materials and scene.nodes and scene.roots
    sources = [texture["source"] for texture in scene.textures]
    assert sources and all(scene.images[source][:4] in (b"\x89PNG", b"\xff\xd8\xff\xe0", b"RIFF") for source in sources)
    shown = [node.part for node in scene.nodes if node.part is not None]
    assert set(shown) <= set(range(len(scene.parts)))
    kinds = {attribute.kind for part in scene.parts for attribute in part.attributes}
    assert {"uv", "group"} <= kinds
    for part in scene.parts:
        rows = {"vertex": len(part.vertices), "corner": 3 * len(part.faces), "face": len(part.faces)}
        for attribute in part.attributes:
            assert len(attribute.values) == rows[attribute.domain]
        groups = part.attribute("group", "material")
        assert groups is None or groups.values.max() <= len(scene.materials)
    if len(scene.parts) > 1:
        with pytest.raises(ValueError, match="parts"):
            scene.normals  # noqa: B018


def test_attributes_that_are_given_are_those_that_are_read(tmp_path: Path) -> None:
    uv, normals = np.random.default_rng(1).random((4, 2)), np.tile((0.0, 0.6, 0.8), (4, 1))
    mesh = chordal.Mesh(CORNERS, WHOLE, normals=normals, uv=uv, colors=np.full((4, 3), 0.5))
    mesh.export(tmp_path / "one.ply")
    back: Any = chordal.load(tmp_path / "one.ply")
    assert np.array_equal(back.uv, uv) and np.allclose(back.normals, normals) and np.allclose(back.colors[:, :3], 0.5)
    for named, says in (
        ({"uv": uv[:3]}, "uv: a row of 2 for each of 4 vertices"),
        ({"normals": uv}, "normal: a row of 3"),
        ({"colors": uv}, "color: a row of 3"),
    ):
        with pytest.raises(ValueError, match=says):
            chordal.Mesh(CORNERS, WHOLE, **named)  # type: ignore[arg-type]


def test_the_words_of_volumes_are_for_volumes() -> None:
    with pytest.raises(TypeError, match="iso: for samples on a lattice; these are patches"):
        chordal.load(TEAPOT).mesh(tol=0.1, iso=3)
    samples = 1000 - 200 * np.linalg.norm(np.indices((9, 9, 9)) - 4.0, axis=0)
    scan = chordal.volume(samples)
    by_mesh, by_surface = scan.mesh(iso=500, triangles=60), scan.surface(iso=500).mesh(triangles=60)
    assert len(by_mesh.faces) <= 60 and by_mesh.to_bytes("ply") == by_surface.to_bytes("ply")
    assert scan.surface(iso=500).render(size=(32, 24)).array.std() > 5


def test_a_batch_says_how_each_file_went(tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    (tmp_path / "in/one.obj").write_bytes(SQUARE)
    (tmp_path / "in/bad.obj").write_bytes(b"v 0 0\n")
    rows = chordal.batch("mesh", tmp_path / "in", tmp_path / "out", options=["--tol", "1%"], base=tmp_path / "in")
    by_name = {Path(row["input"]).name: row for row in rows}
    assert by_name["one.obj"]["exit"] == 0 and by_name["one.obj"]["triangles_out"] == 2
    assert by_name["bad.obj"]["exit"] != 0 and "line 1" in by_name["bad.obj"]["error"]
    assert (tmp_path / "out/one.glb").exists()
    with pytest.raises(chordal.Error, match="nothing"):
        chordal.batch("mesh", tmp_path / "nothing", tmp_path / "out2")


def test_half_the_error_takes_twice_the_triangles() -> None:
    found = chordal.plot_error(chordal.load(TEAPOT), rel=[0.003, 0.001, 0.0003])
    assert len(found.counts) == 3 and (np.diff(found.counts) > 0).all() and (np.diff(found.errors) < 0).all()
    assert -1.3 < found.slope < -0.7
    with pytest.raises(ValueError, match="nothing is lost"):
        chordal.plot_error(chordal.Mesh(CORNERS, WHOLE), rel=[1e-9])
