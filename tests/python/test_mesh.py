"""`Shape.mesh` and `Mesh`: the same triangles as the command's, in arrays that do not change."""

from __future__ import annotations

import gc
import json
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import SQUARE, TEAPOT, Command
from numpy.typing import NDArray

import chordal

VIEW = "1920x1080 fov=45 dist=4"


def read_ply(content: bytes) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """The rows of a PLY file, read without Chordal."""
    header, body = content.split(b"end_header\n", 1)
    words = [line.split() for line in header.decode().splitlines()]
    assert ["format", "binary_little_endian", "1.0"] in words
    (n, m) = (int(line[2]) for line in words if line[0] == "element")
    kinds = {"double": "<f8", "float": "<f4", "uchar": "u1"}
    row = np.dtype([(line[2], kinds[line[1]]) for line in words if line[0] == "property" and line[1] != "list"])
    lists = [line for line in words if line[:2] == ["property", "list"]]
    assert row.names is not None and row.names[:3] == ("x", "y", "z") and len(lists) == 1
    rows = np.frombuffer(body, row, n)
    faces = np.frombuffer(body, np.dtype([("n", "u1"), ("index", "<u4", 3)]), m, row.itemsize * n)
    assert row["x"] == np.float64 and (faces["n"] == 3).all()
    return np.stack([rows["x"], rows["y"], rows["z"]], axis=1), faces["index"].astype(np.int64)


@pytest.mark.parametrize(
    ("options", "budget"),
    [
        (["--tol", "0.001"], {"tol": 0.001}),
        (["--tol", "0.1%"], {"rel": 0.001}),
        (["--tol", "0.1%"], {"rel": "0.1%"}),
        (["--px", "1", "--view", VIEW], {"pixels": 1, "view": VIEW}),
        (["--triangles", "1000"], {"triangles": 1000}),
        (["--tol", "0.02", "--px", "9", "--view", VIEW], {"tol": 0.02, "pixels": 9.0, "view": chordal.View(VIEW)}),
    ],
)
def test_the_vertices_are_those_of_the_command_bit_for_bit(
    cargo_chordal: Command, tmp_path: Path, options: list[str], budget: dict[str, Any]
) -> None:
    done = cargo_chordal("mesh", TEAPOT, *options, "-o", tmp_path / "a.ply", "--json")
    assert done.returncode == 0, done.stderr
    mesh = chordal.load(TEAPOT).mesh(**budget)
    vertices, faces = read_ply((tmp_path / "a.ply").read_bytes())
    assert mesh.vertices.tobytes() == vertices.tobytes()
    assert np.array_equal(mesh.faces, faces)
    assert mesh.report["certificate"] == json.loads(done.stdout)["certificate"]


@pytest.mark.parametrize("extension", ["glb", "obj", "stl", "ply"])
def test_a_file_is_that_of_the_command_byte_for_byte(
    cargo_chordal: Command, tmp_path: Path, extension: str
) -> None:
    ours, theirs = tmp_path / f"ours.{extension}", tmp_path / f"theirs.{extension}"
    done = cargo_chordal("mesh", TEAPOT, "--tol", "0.003", "-o", theirs, "--json")
    assert done.returncode == 0, done.stderr
    report = chordal.load(TEAPOT).mesh(tol=0.003).export(ours)
    assert ours.read_bytes() == theirs.read_bytes()
    assert report["certificate"] == json.loads(done.stdout)["certificate"]
    assert report["run"]["bytes"] == theirs.stat().st_size


def test_a_shape_of_several_parts_has_the_rows_of_its_file(cargo_chordal: Command, tmp_path: Path) -> None:
    parts = b"o one\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\no two\nv 0 0 1\nv 1 0 1\nv 0 1 1\nf 4 5 6\n"
    glb = chordal.load(parts, format="obj").mesh(tol=0.01).to_bytes("glb")
    done = cargo_chordal("mesh", "-", "--from", "glb", "--tol", "0.01", "-o", tmp_path / "a.ply", stdin=glb)
    assert done.returncode == 0, done.stderr
    vertices, faces = read_ply((tmp_path / "a.ply").read_bytes())
    mesh = chordal.load(glb).mesh(tol=0.01)
    assert np.array_equal(mesh.vertices, vertices)
    assert np.array_equal(mesh.faces, faces)


def test_arrays_are_typed_shared_and_for_reading_only() -> None:
    mesh = chordal.load(TEAPOT).mesh(tol=0.05)
    for array, kind in ((mesh.vertices, np.float64), (mesh.faces, np.int32)):
        assert array.dtype == kind and array.shape[1] == 3 and array.flags.c_contiguous
        with pytest.raises(ValueError, match="read-only"):
            array[0, 0] = 1
        with pytest.raises(ValueError, match="WRITEABLE"):
            array.flags.writeable = True
    assert np.shares_memory(mesh.vertices, mesh.vertices)
    assert mesh.faces.min() == 0 and mesh.faces.max() == len(mesh.vertices) - 1


def test_an_array_outlives_its_mesh() -> None:
    vertices = chordal.load(TEAPOT).mesh(tol=0.05).vertices
    before = vertices.copy()
    gc.collect()
    chordal.load(TEAPOT).mesh(tol=0.01)
    assert np.array_equal(vertices, before)


def test_the_bound_is_that_of_the_report_and_within_the_budget() -> None:
    mesh = chordal.load(TEAPOT).mesh(tol=0.01, pixels=5, view=VIEW)
    facts = mesh.report["certificate"]["bound"]
    assert mesh.bound.at_least == facts["at_least"] and mesh.bound.at_most == facts["at_most"]
    assert mesh.bound.at_most is not None and mesh.bound.pixels is not None and mesh.bound.at is not None
    assert 0 < mesh.bound.at_least <= mesh.bound.at_most <= 0.01 and mesh.bound.pixels <= 5
    assert mesh.bound.at == tuple(facts["at"])
    assert (mesh.bound.evidence, mesh.bound.metric) == ("proved", "hausdorff")
    assert mesh.bound.reference == "bezier patches"


def test_a_bound_is_shown_wider_than_it_is() -> None:
    bound = chordal.Bound(0.12345678, 0.98712345, "proved", "hausdorff", "curves", pixels=1.2301)
    shown = "between 0.123 and 0.988, proved; hausdorff distance to the curves; at most 1.24 px"
    assert repr(bound) == f"<Bound: {shown}>"
    sampled = chordal.Bound(3.999e-7, None, "measured", "hausdorff", "curves", samples=12)
    assert sampled.sentence() == "at least 3.99e-07, measured (12 samples); hausdorff distance to the curves"


def test_nothing_about_a_mesh_changes() -> None:
    mesh = chordal.load(SQUARE).mesh(tol=0.1)
    mesh.report["certificate"]["bound"] = None
    assert mesh.report["certificate"]["bound"] is not None
    for thing, name in ((mesh, "bound"), (mesh, "vertices"), (mesh.bound, "at_most"), (chordal.View(VIEW), "_text")):
        with pytest.raises(AttributeError):
            setattr(thing, name, 0)


def test_a_budget_that_is_not_met_brings_the_best() -> None:
    solid = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
    shape = chordal.load(solid, format="obj")
    with pytest.raises(chordal.BudgetUnmet, match="4 triangles") as caught:
        shape.mesh(triangles=3)
    best = caught.value.best
    assert isinstance(best, chordal.Mesh) and len(best.faces) == 4
    assert caught.value.bound == best.bound
    assert best.to_bytes("ply").startswith(b"ply\n"), "who has the best in hand may write it"


def test_a_file_that_rounds_past_the_budget_is_refused(tmp_path: Path) -> None:
    mesh = chordal.load(TEAPOT).mesh(tol=0.05)
    far = chordal.load(SQUARE.replace(b"v 1 0", b"v 123456789.123456 0")).mesh(tol=1e-3)
    with pytest.raises(chordal.Refused) as caught:
        far.export(tmp_path / "far.stl")
    assert caught.value.code == "below-precision"
    assert list(tmp_path.iterdir()) == []
    mesh.export(tmp_path / "fine.stl")


def test_what_cannot_be_done_is_refused_with_a_code() -> None:
    shape = chordal.load(TEAPOT)
    with pytest.raises(chordal.Refused) as caught:
        shape.mesh(tol=1e-13)
    assert caught.value.code in ("too-many-triangles", "below-precision")
    with pytest.raises(chordal.Refused) as caught:
        shape.mesh(tol=1).to_bytes("bpt")
    assert caught.value.code == "unsupported" and "bpt" in str(caught.value)


def test_a_length_in_a_unit_needs_a_shape_in_one() -> None:
    bare = chordal.load(TEAPOT).mesh(tol=0.01)
    metric = chordal.load(TEAPOT, unit="cm").mesh(tol="0.1mm")
    assert np.array_equal(bare.vertices, metric.vertices)
    with pytest.raises(chordal.BudgetError, match="give unit="):
        chordal.load(TEAPOT).mesh(tol="0.1mm")


def test_inspect_is_the_command_s(cargo_chordal: Command) -> None:
    done = cargo_chordal("inspect", TEAPOT, "--json")
    theirs, ours = json.loads(done.stdout), chordal.load(TEAPOT).inspect()
    assert ours["certificate"] == theirs["certificate"] and ours["inspection"] == theirs["inspection"]


def test_what_is_shown_is_short_and_escaped() -> None:
    mesh = chordal.load(SQUARE, format="obj").mesh(tol=0.1)
    assert repr(mesh).startswith("<Mesh: 2 triangles, 4 vertices; between 0 and 0, proved")
    assert mesh._repr_mimebundle_()["text/html"].count("<tr>") == 2
    assert repr(chordal.load(TEAPOT)).startswith("<Shape: patches, from bpt")


def test_coordinates_whose_sum_is_too_large_are_taken_and_those_that_are_not_finite_are_named() -> None:
    large = np.array([[1.7e308, 0, 0], [1.7e308, 1, 0], [1.7e308, 0, 1]])
    assert np.array_equal(chordal.Mesh(large, [(0, 1, 2)]).vertices, large)
    for bad in (np.inf, -np.inf, np.nan):
        wrong = large.copy()
        wrong[2, 1] = bad
        with pytest.raises(ValueError, match=r"vertices: the number at \(2, 1\) is not finite"):
            chordal.Mesh(wrong, [(0, 1, 2)])
    for index in (-1, 2**32):
        with pytest.raises(ValueError, match=r"faces: the number at \(0, 2\) is no index"):
            chordal.Mesh(large, [(0, 1, index)])


def test_curvature_is_that_of_the_surface() -> None:
    n, m = 120, 60
    u, v = np.meshgrid(np.arange(n) * 2 * np.pi / n, np.arange(m) * 2 * np.pi / m, indexing="ij")
    ring = 2 + 0.5 * np.cos(v)
    points = np.stack([ring * np.cos(u), ring * np.sin(u), 0.5 * np.sin(v)], axis=-1).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(n), np.arange(m), indexing="ij")

    def at(di: int, dj: int) -> Any:
        return ((i + di) % n * m + (j + dj) % m).ravel()

    faces = np.concatenate([np.stack([at(0, 0), at(1, 0), at(1, 1)], 1), np.stack([at(0, 0), at(1, 1), at(0, 1)], 1)])
    torus = chordal.Mesh(points, faces)
    gaussian = np.cos(v) / (0.5 * ring)
    mean = (2 + np.cos(v)) / (2 * 0.5 * ring)
    assert np.allclose(torus.vertex_curvature("gaussian"), gaussian.ravel(), atol=2e-3)
    assert np.allclose(torus.vertex_curvature(), mean.ravel(), atol=2e-3)
    assert np.allclose(torus.vertex_curvature("maximum"), 2.0, atol=0.05)
    assert np.allclose(torus.vertex_curvature("minimum"), (np.cos(v) / ring).ravel(), atol=0.05)
    # Turned inside out it bends the other way, and as much.
    inside_out = chordal.Mesh(points, faces[:, ::-1])
    assert np.allclose(inside_out.vertex_curvature(), -torus.vertex_curvature())
    assert np.allclose(inside_out.vertex_curvature("gaussian"), torus.vertex_curvature("gaussian"))
    # Vertices at one place are one, and borders have none.
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        soup = chordal.Mesh(points[faces.ravel()], np.arange(faces.size).reshape(-1, 3))
    assert np.allclose(soup.vertex_curvature(), torus.vertex_curvature()[faces.ravel()])
    half = chordal.Mesh(points, faces[: len(faces) // 2])
    assert np.isnan(half.vertex_curvature()).any()
    with pytest.raises(ValueError, match="kind"):
        torus.vertex_curvature("total")  # type: ignore[arg-type]
