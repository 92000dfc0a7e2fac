"""Names and keywords of other libraries: what is said of them, and that nothing else changes by that."""

from __future__ import annotations

import copy
import inspect
import io
import pickle
import re
import types
from typing import Any

import numpy as np
import pytest

import chordal
from chordal import _hints
from chordal._errors import plain_numbers
from chordal._guessed_names import NOUNS

CORNERS = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
FACES = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]
# Not of their types, for these refuse what is guessed.
SOLID: Any = chordal.Mesh(CORNERS, FACES)
OPEN: Any = chordal.Mesh(CORNERS, FACES[:3])
VOLUME: Any = chordal.volume(np.ones((3, 3, 3)))
BALL: Any = chordal.shapes.sphere(1)
ARCH: Any = chordal.shapes.bezier([(0, 0), (0, 1), (1, 1), (1, 0)])
TENT: Any = chordal.Cage(CORNERS, FACES)
LINES: Any = ARCH.flatten(tol=0.1)
BLOCKS: Any = chordal.block_volume(np.ones((3, 3, 3)))
ANY: Any = chordal
THINGS: dict[str, Any] = {
    "Mesh": SOLID,
    "Shape": chordal.shapes.arc(0.5, center=(2, 0)).revolve(),
    "Volume": VOLUME,
    "Field": BALL,
    "Picture": BALL.render(size=(8, 8)),
    "Levels": BALL.lod(tol=0.1),
    "Deviation": SOLID.deviation(SOLID),
    "Part": SOLID.parts[0],
    "Bound": SOLID.bound,
    "Curve": ARCH,
    "Cage": TENT,
    "BlockVolume": BLOCKS,
    "Polylines": LINES,
    "chordal": chordal,
    "chordal.shapes": chordal.shapes,
}


@pytest.mark.parametrize("owner", THINGS)
def test_every_guessed_name_is_answered(owner: str) -> None:
    thing = THINGS[owner]
    for table in NOUNS[owner]:
        for name in table:
            if name in dir(type(thing)) or name in dir(thing):
                continue
            assert not hasattr(thing, name)
            with pytest.raises(AttributeError) as raised:
                getattr(thing, name)
            assert f"has no attribute '{name}': " in str(raised.value)


@pytest.mark.parametrize(
    ("thing", "name", "answer"),
    [
        (SOLID, "simplify", "mesh(triangles="),
        (SOLID, "fill_holes", "mend(fill_holes=True)"),
        (SOLID, "apply_transform", "transform(matrix)"),
        (SOLID, "convex_hull", "to_trimesh().convex_hull"),
        (SOLID, "smooth", "to_pyvista().smooth"),
        (SOLID, "hausdorff", "deviation(other)"),
        (SOLID, "invert", "chordal.Mesh(mesh.vertices, mesh.faces[:, ::-1])"),
        (SOLID, "shell", "mesh.to_field().shell(thickness)"),
        (SOLID, "to_obj", 'export("a.obj")'),
        (SOLID, "save_stl", 'export("a.stl")'),
        (SOLID, "recenter", "mesh.translate(-mesh.bounds.mean(axis=0))"),
        (BALL, "onion", "field.shell(thickness)"),
        (BALL, "show", "field.mesh(tol=0.01).show()"),
        (VOLUME, "pitch", "volume.spacing"),
        (chordal, "NURBS", "chordal.shapes.nurbs"),
        (SOLID, "vertice", "is vertices meant?"),
        (SOLID, "mass", "mesh.volume and mesh.center_mass"),
        (SOLID, "is_convex", "to_trimesh().is_convex"),
        (SOLID, "triangle_normals", "mesh.face_normals"),
        (SOLID, "get_axis_aligned_bounding_box", "mesh.bounds"),
        (SOLID, "is_edge_manifold", 'report["certificate"]["valid"]'),
        (SOLID, "metadata", "mesh.attributes"),
        (SOLID, "add_geometry", "chordal.scene("),
        (SOLID, "warp_by_scalar", "to_pyvista().warp_by_scalar"),
        (SOLID, "filter_smooth_taubin", "to_open3d().filter_smooth_taubin"),
        (VOLUME, "point_data", "volume.array"),
        (BALL, "twist", "chordal.shapes.twist("),
        (BALL, "faces", "field.mesh(tol=0.01)"),
        (chordal, "Scene", "chordal.scene("),
        (chordal, "creation", "chordal.shapes"),
        (chordal, "Plotter", "mesh.show()"),
        (chordal, "read_triangle_mesh", "chordal.load("),
        (VOLUME, "contour", "mesh(iso=0.5)"),
        (BALL, "contains", "field(points) < 0"),
        (THINGS["Picture"], "save", 'export("a.png")'),
        (chordal, "marching_cubes", "chordal.volume(array).mesh(iso="),
        (chordal, "sphere", "chordal.shapes.sphere"),
        (chordal, "lods", "is lod meant?"),
        (chordal.shapes, "cube", "box(x, y, z)"),
        (chordal.Mesh, "from_trimesh", "chordal.Mesh.from_(thing)"),
        (chordal.Mesh, "from_file", "chordal.load"),
    ],
)
def test_a_name_of_another_library_is_answered_by_the_call(thing: Any, name: str, answer: str) -> None:
    with pytest.raises(AttributeError) as raised:
        getattr(thing, name)
    assert answer in str(raised.value)


def test_whatever_trimesh_does_with_a_mesh_is_there_or_answered() -> None:
    trimesh = pytest.importorskip("trimesh", reason="trimesh is not installed: its names are not looked at")
    # How it keeps what it has computed, and what belongs to cameras.
    own = {"eval_cached", "mutable", "register", "source"}
    names = {name for name in dir(trimesh.Trimesh) if not name.startswith("_")} - own
    assert len(names) > 120
    unknown = [name for name in sorted(names) if not hasattr(SOLID, name) and _hints.found_hint("Mesh", name) is None]
    assert unknown == []


@pytest.mark.parametrize(
    ("call", "answer"),
    [
        (lambda: SOLID.mesh(faces=5), "triangles="),
        (lambda: SOLID.mesh(target_count=5), "triangles="),
        (lambda: SOLID.mesh(tolerance=5), "tol="),
        (lambda: BALL.mesh(resolution=0.1), "say how far it may be off, as in tol=0.01"),
        (lambda: SOLID.mesh(500), "takes these by name: tol=, rel="),
        (lambda: VOLUME.mesh(level=0), "iso="),
        (lambda: ANY.mesh(VOLUME, threshold=0), "iso="),
        (lambda: SOLID.bake(resolution=5), "cells="),
        (lambda: SOLID.mend(fillholes=True), "fill_holes="),
        (lambda: SOLID.mend(orientt=True), "is orient= meant?"),
        (lambda: SOLID.lod(levels=3), "shape.mesh(triangles=n)"),
        (lambda: ANY.volume(VOLUME.array, voxel_size=1), "spacing="),
        (lambda: ANY.load(b"", file_type="stl"), "format="),
        (lambda: ANY.Mesh(CORNERS, FACES, color="red"), "colors="),
        (lambda: ANY.shapes.sphere(r=1), "radius"),
        (lambda: ANY.shapes.cylinder(r=1, h=2), "radius"),
        (lambda: SOLID.render(width=64), "size="),
        (lambda: SOLID.export("a.stl", file_type="stl"), "it has "),
    ],
)
def test_a_keyword_of_another_library_is_answered(call: Any, answer: str) -> None:
    with pytest.raises(TypeError) as raised:
        call()
    assert answer in str(raised.value)


def test_guesses_leave_copies_pickles_and_lists_of_names_as_they_are() -> None:
    for thing in (SOLID, VOLUME, BALL):
        assert copy.copy(thing) is thing and copy.deepcopy(thing) is thing
        assert type(pickle.loads(pickle.dumps(thing))) is type(thing)
        assert "simplify" not in dir(thing) and not hasattr(thing, "__array_struct__")
    assert pickle.loads(pickle.dumps(chordal.shapes.sphere)) is chordal.shapes.sphere
    assert getattr(SOLID, "simplify", None) is None
    with pytest.raises(AttributeError, match="_report_text"):
        chordal.Mesh.__new__(chordal.Mesh)._text
    with pytest.raises(ImportError):
        from chordal import marching_cubes  # type: ignore[attr-defined]  # noqa: F401


def test_triangles_that_stand_alone_are_told_of_and_welded_on_request() -> None:
    corners = np.array(CORNERS, dtype=float)[np.array(FACES)].reshape(-1, 3)
    alone = np.arange(12).reshape(4, 3)
    with pytest.warns(UserWarning, match=r"no two triangles share a vertex.* weld=True") as told:
        soup = chordal.Mesh(corners, alone)
    assert told[0].filename == __file__ and soup.vertices.shape == (12, 3) and not soup.is_watertight
    with pytest.warns(UserWarning, match="weld=True"):
        chordal.Mesh.from_(types.SimpleNamespace(vertices=corners, faces=alone))
    for solid in (
        chordal.Mesh(corners, alone, weld=True),
        chordal.Mesh.from_(types.SimpleNamespace(vertices=corners, faces=alone), weld=True),
    ):
        assert solid.vertices.tolist() == [[0, 0, 0], [0, 1, 0], [1, 0, 0], [0, 0, 1]]
        assert solid.is_watertight and solid.volume == SOLID.volume
    # Vertices that differ in what they say stay apart, and belong to one position.
    uv = np.random.default_rng(1).random((12, 2))
    dressed = chordal.Mesh(corners, alone, uv=uv, weld=True)
    assert dressed.is_watertight and dressed.uv is not None and np.array_equal(dressed.uv, uv)
    signs = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, -0.0, 0), (0, 1, 0), (-1, 0, 0)]
    signed = chordal.Mesh(signs, [(0, 1, 2), (3, 4, 5)], weld=True)
    assert len(signed.vertices) == 4
    # Triangles that do not touch are no soup.
    chordal.Mesh(np.arange(18).reshape(6, 3), [(0, 1, 2), (3, 4, 5)])


def test_holes_that_are_left_are_counted() -> None:
    octagon = [(np.cos(a), np.sin(a), 0) for a in np.linspace(0, 2 * np.pi, 9)[:8]]
    fan = chordal.Mesh([*octagon, (0, 0, 1)], [(k, (k + 1) % 8, 8) for k in range(8)])
    with pytest.warns(UserWarning, match=r"1 hole is left, of 8 edges: fill_holes=True fills those of more than 4 edges, too"):
        fan.mend(fill_holes=4)
    assert fan.mend(fill_holes=True).is_watertight and fan.mend(orient=True) is not None


def test_what_only_one_part_says_is_no_attribute_of_several() -> None:
    halves = np.ones((4, 4, 4), np.uint8)
    halves[2:] = 2
    several: Any = chordal.labels(halves).mesh()
    assert len(several.parts) == 2
    for name in ("uv", "colors", "normals", "tangents", "attributes"):
        assert not hasattr(several, name) and getattr(several, name, None) is None
        for kind in (AttributeError, ValueError):
            with pytest.raises(kind, match=r"this scene has 2 parts: look at those of mesh\.parts"):
                getattr(several, name)
    assert "uv" not in dict(inspect.getmembers(several)) and several.vertex_normals.shape == several.vertices.shape
    part = several.parts[0]
    assert part.uv is None and part.normals is None and part.bounds.shape == (2, 3)
    assert part.colors is None or len(part.colors) == len(part.vertices)


def test_an_empty_mesh_says_that_it_is_empty() -> None:
    empty: Any = chordal.Mesh(np.zeros((0, 3)), np.zeros((0, 3), int))
    assert empty.extents.tolist() == [0, 0, 0] and empty.area == 0 and empty.volume == 0
    with pytest.raises(ValueError, match="an empty mesh has no bounds"):
        empty.bounds
    assert empty.translate(1, 0, 0).vertices.shape == (0, 3)


@pytest.mark.parametrize(
    ("call", "error", "said"),
    [
        (lambda: ANY.Volume(VOLUME.array), TypeError, r"chordal\.volume\(array"),
        (lambda: ANY.Curve([0]), TypeError, "bezier, spline, nurbs"),
        (lambda: ANY.Field("x"), TypeError, r"chordal\.field\(function"),
        (lambda: ANY.Shape("a.stl"), TypeError, r"chordal\.load\(path\)"),
        (lambda: ANY.Mesh("a.stl"), TypeError, r"Mesh\(\) needs vertices and faces: .* chordal\.load reads files"),
        (lambda: ANY.mesh(lambda p: p, tol=1), TypeError, r"chordal\.field makes one of functions"),
        (lambda: VOLUME.export("v.nii.gz"), ValueError, r"nothing is compressed as \.gz; volumes are written as npy, nrrd"),
        (lambda: VOLUME.export("v.tif"), ValueError, "'tif' is no format; volumes are written as npy, nrrd"),
        (lambda: SOLID.export("a.xyz"), ValueError, "'xyz' is no format; triangles are written as obj, ply"),
        (lambda: BALL.mesh(tol=0.1).to_bytes("xyz"), ValueError, "'xyz' is no format; triangles are written as obj, ply"),
        (lambda: SOLID.export(io.BytesIO()), TypeError, "to_bytes"),
        (lambda: SOLID.export("no_such_folder/a.stl"), FileNotFoundError, "no such folder .*no_such_folder'"),
        (lambda: BALL.export("a.stl"), chordal.Refused, "^fields become triangles"),
        (lambda: BALL.flatten(tol=1), chordal.Refused, "^fields hold no curves"),
        (lambda: SOLID.render(view="top"), chordal.BudgetError, "begins with the size of the screen"),
        (lambda: SOLID.lod(view="top"), chordal.BudgetError, "begins with the size of the screen"),
        (lambda: SOLID.mesh(pixels=1, view="top"), chordal.BudgetError, r"chordal\.View\.camera"),
        (lambda: SOLID.render(size=32), TypeError, r"size: columns and rows, as in \(1280, 960\), not 32"),
        (lambda: ANY.field(len, bounds=1.5), ValueError, r"bounds: a lowest and a highest corner, as in \(\(-1"),
        (lambda: ANY.field(len, bounds=(-1, 1, -1, 1, -1, 1)), ValueError, r"not numbers of shape \(6,\)"),
        (lambda: ANY.field(lambda x, y, z: x), TypeError, "a function of one array of points, n × 3"),
        (lambda: ANY.field(np.linalg.norm), ValueError, r"gave back \(\) for 2 points"),
        (lambda: ANY.field(SOLID), TypeError, r"to_field\(\) of a mesh"),
        (lambda: ANY.field("x"), TypeError, r"chordal\.script"),
        (lambda: ANY.shapes.move(SOLID, 1, 0, 0), ValueError, r"a field is needed, not a Mesh: to_field\(\) of a mesh"),
        (lambda: ANY.field(lambda p: p[:, 0] * 1j)([[0, 0, 0]]), TypeError, "complex numbers"),
        (lambda: BALL | SOLID, TypeError, r"to_field\(\) of a mesh"),
        (lambda: SOLID - BALL, TypeError, r"a\.difference\(b, tol=0\.01\)"),
        (lambda: SOLID - OPEN, chordal.Refused, r"mend it \(mend\(fill_holes=True\)\)"),
    ],
)
def test_what_is_wrong_is_said_in_the_words_of_python(call: Any, error: type[Exception], said: str) -> None:
    with pytest.raises(error, match=said):
        call()


def test_whatever_is_a_mesh_is_taken_beside_one() -> None:
    moved = SOLID.translate(0.25, 0.25, 0.25)
    other = types.SimpleNamespace(vertices=moved.vertices, faces=moved.faces)
    wanted = (SOLID - moved).volume
    for made in (SOLID - other, SOLID.difference(other), SOLID.difference([other]), SOLID.combine(("difference", other))):
        assert made.volume == wanted
    assert chordal.union([SOLID, moved]).volume == (SOLID | other).volume == SOLID.union([moved, other]).volume
    assert SOLID.deviation(other).at_most == SOLID.deviation(moved).bound.at_most
    assert SOLID.deviation(other).at_least == SOLID.deviation(moved).bound.at_least
    assert np.array_equal(SOLID.vertex_deviation(other), SOLID.vertex_deviation(moved))
    with pytest.raises(TypeError, match="unsupported operand"):
        SOLID | {1}


def test_a_budget_that_is_not_met_is_said_in_plain_numbers_and_where_the_best_is() -> None:
    with pytest.raises(chordal.BudgetUnmet) as raised:
        BALL.mesh(tol=0.001, triangles=10)
    assert "`best` of this error holds it" in str(raised.value) and "e-" not in str(raised.value)
    assert plain_numbers("between 1.250e-3 and 2.5e-9, -3.8047e-1, 1.0e3") == "between 0.001250 and 2.5e-9, -0.38047, 1000"


def test_arrays_are_no_file() -> None:
    assert repr(SOLID) == "<Mesh: 4 triangles, 4 vertices, from arrays>" and SOLID.format == "arrays"
    assert repr(pickle.loads(pickle.dumps(SOLID))) == repr(SOLID)


def test_fields_are_moved_by_methods_and_by_vectors() -> None:
    points = np.random.default_rng(5).uniform(-2, 2, (200, 3))
    words = chordal.shapes
    box = words.box((1, 2, 3))
    for one, other in (
        (box, words.box(1, 2, 3)),
        (words.box(np.array([1, 2, 3])), words.box(1, 2, 3)),
        (words.ellipsoid((1, 2, 3)), words.ellipsoid(1, 2, 3)),
        (words.move(box, (1, 0, 2)), words.move(box, 1, 0, 2)),
        (words.move(box, (1, 0)), words.move(box, 1, 0)),
        (words.stretch(box, [1, 2]), words.stretch(box, 1, 2)),
        (words.mirror(box.move(1, 2), (1, 1, 0)), words.mirror(words.move(box, 1, 2), 1, 1)),
        (box.move((1, 0, 2)), words.move(box, 1, 0, 2)),
        (box.scale(2), words.scale(box, 2)),
        (box.rotate("y", 30), words.rotate_y(box, 30)),
        (box.rotate((1, 1, 0), 30), words.rotate(box, (1, 1, 0), 30)),
        (box.move(3, 0, 0).mirror(1, 0, 0), box.move(-3, 0, 0)),
        (box.move(3, 0, 0).mirror((1, 0, 0)), box.move(-3, 0, 0)),
        (box.offset(0.1), words.offset(box, 0.1)),
        (box.shell(0.1), words.shell(box, 0.1)),
    ):
        assert np.array_equal(one(points), other(points))
        assert np.array_equal(pickle.loads(pickle.dumps(one))(points), one(points))
    loose: Any = words
    for word, wrong in ((loose.box, (1,)), (loose.box, ((1, 2),)), (loose.box, (1, 2)), (loose.move, (box, 1))):
        with pytest.raises(TypeError, match="three numbers, or one vector"):
            word(*wrong)
    with pytest.raises(ValueError, match="axis: x, y, z or a vector"):
        ANY.shapes.box(1, 1, 1).rotate("w", 1)


def test_answers_name_what_there_is() -> None:
    things = {"mesh": SOLID, "shape": SOLID, "volume": VOLUME, "field": BALL, "picture": THINGS["Picture"], "chordal": chordal}
    things |= {"part": SOLID.parts[0], "bound": SOLID.bound}
    things |= {"levels": THINGS["Levels"], "deviation": THINGS["Deviation"], "curve": ARCH, "cage": TENT, "lines": LINES}
    n_names = 0
    for owner, tables in NOUNS.items():
        things["volume"] = BLOCKS if owner == "BlockVolume" else VOLUME
        for answer in {answer for table in tables for answer in table.values()}:
            for noun, name in re.findall(r"(?<![\w)])(\w+)\.(\w+)", answer):
                if noun in things:
                    n_names += 1
                    assert hasattr(things[noun], name), f"{owner}: {answer}"
    assert n_names > 100


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (lambda: ANY.Placed(SOLID, translation=(1, 0, 0)), r"Placed.* has no argument 'translation': here it is at="),
        (lambda: ANY.Material(opacity=0.5), "the fourth number of color"),
        (lambda: ANY.Material(metalness=0.5), "here it is metallic="),
        (lambda: BALL + BALL, r"a \| b is both together"),
        (lambda: sum([BALL, BALL]), r"a \| b is both together"),
        (lambda: SOLID.export("a.glb", compress=True), "compress: a text, not bool"),
        (lambda: SOLID.bake(cells=(4, 5, 6)), "cells: a whole number, not tuple"),
    ],
)
def test_keywords_and_operators_are_answered(make: Any, told: str) -> None:
    with pytest.raises(TypeError, match=told):
        make()


@pytest.mark.parametrize(
    ("thing", "name", "told"),
    [
        (SOLID, "connected_components", "split"),
        (SOLID, "certificate", "history"),
        (VOLUME, "zooms", "spacing"),
        (BLOCKS, "to_trimesh", "mesh"),
        (ARCH, "mesh", "flatten"),
        (ARCH, "evaluate", "points_at"),
        (TENT, "mesh", r"cage\.shape\(\)\.mesh"),
        (TENT, "catmull_clark", "refined"),
        (LINES, "vertices", r"lines\.points"),
        (BLOCKS, "lod", "tileset"),
        (BLOCKS, "marching_cubes", "mesh"),
    ],
)
def test_curves_cages_lines_and_block_volumes_say_what_is_meant(thing: Any, name: str, told: str) -> None:
    assert not hasattr(thing, name)
    with pytest.raises(AttributeError, match=told):
        getattr(thing, name)


def test_the_verbs_take_curves_and_cages() -> None:
    assert chordal.flatten(ARCH, tol=0.01).points.shape == ARCH.flatten(tol=0.01).points.shape
    assert len(chordal.mesh(TENT, tol=0.1).faces) == len(TENT.shape().mesh(tol=0.1).faces)
    with pytest.raises(TypeError, match=r"volume\.mesh"):
        chordal.inspect(BLOCKS)


@pytest.mark.parametrize(
    ("call", "told"),
    [
        (lambda: SOLID.mesh(target_reduction=0.9), r"triangles=len\(mesh\.faces\)"),
        (lambda: SOLID.mesh(ratio=0.5), r"triangles=len\(mesh\.faces\)"),
        (lambda: SOLID.lod(levels=3), r"shape\.mesh\(triangles=n\)"),
        (lambda: SOLID.lod(triangles=[10]), r"shape\.mesh\(triangles=n\)"),
        (lambda: SOLID.rotate(90, "z"), r"rotate\('z', 90\)"),
        (lambda: SOLID.rotate(axis="z", angle=90), "degrees="),
        (lambda: BLOCKS.mesh(labels=True, iso=0), r"volume\.labels\(\)"),
        (lambda: BLOCKS.mesh(level=0), "iso="),
        (lambda: SOLID.render(resolution=(8, 8)), "size="),
    ],
)
def test_keywords_that_have_no_equal_are_answered_with_the_way(call: Any, told: str) -> None:
    with pytest.raises(TypeError, match=told):
        call()


def test_several_meshes_may_stand_one_after_the_other() -> None:
    assert len(chordal.concatenate(SOLID, SOLID).faces) == len(chordal.concatenate([SOLID, SOLID]).faces) == 8


def test_pictures_and_lines_are_arrays_for_numpy() -> None:
    picture = THINGS["Picture"]
    assert np.array_equal(np.asarray(picture), picture.array) and np.array(picture, copy=True).flags.writeable
    assert np.array_equal(np.asarray(LINES[0]), LINES[0].points)


def test_samples_that_are_positive_inside_are_told_of() -> None:
    i, j, k = np.indices((12, 12, 12)) - 5.5
    ball = 4 - np.sqrt(i * i + j * j + k * k)
    # What is positive at no end of the lattice is no distance: what is above is inside.
    guessed = chordal.volume(ball).mesh(iso=0)
    right = chordal.volume(ball).mesh(iso=0, inside="high")
    assert guessed.volume == right.volume < 300
    assert len(chordal.volume(-ball).mesh(iso=0).faces) == len(right.faces)


def test_a_volume_on_disk_is_sent_to_who_reads_it(tmp_path: Any) -> None:
    (tmp_path / "zarr.json").write_text("{}")
    with pytest.raises(TypeError, match="chordal.block_volume"):
        chordal.load(tmp_path)


def test_options_of_a_batch_may_be_named(tmp_path: Any) -> None:
    SOLID.export(tmp_path / "a.stl")
    rows = chordal.batch("mesh", tmp_path / "a.stl", tmp_path / "out", options={"tol": 0.1, "normals": "flat", "quantize": False})
    assert [row["exit"] for row in rows] == [0], rows
    with pytest.raises(TypeError, match="options: words"):
        chordal.batch("mesh", tmp_path / "a.stl", tmp_path / "out", options="--tol 0.1")


@pytest.mark.parametrize("module", [chordal, chordal.shapes])
def test_modules_list_what_they_give(module: types.ModuleType) -> None:
    assert [name for name in dir(module) if not name.startswith("__")] == sorted(set(module.__all__) - {"__version__"})


@pytest.mark.parametrize(
    ("name", "here"),
    [
        ("select_interior_points", "to_field()"),
        ("voxelize_binary_mask", ".bake("),
        ("merge_points", "mend(weld=True)"),
        ("remove_non_manifold_edges", "mend(split_nonmanifold=True)"),
        ("crop", "mesh.intersection("),
        ("is_intersecting", "mesh.intersection("),
        ("submesh", "mesh.faces[keep]"),
        ("remove_triangles_by_mask", "mesh.faces[keep]"),
        ("flip_normal_vectors", "[:, ::-1]"),
        ("append_polydata", "chordal.concatenate"),
        ("plot_normals", 'show="normals"'),
    ],
)
def test_what_is_here_is_not_sent_to_other_libraries(name: str, here: str) -> None:
    with pytest.raises(AttributeError) as raised:
        getattr(SOLID, name)
    said = str(raised.value)
    assert here in said and "Chordal has none" not in said
