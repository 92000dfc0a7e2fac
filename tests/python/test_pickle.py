"""Whatever there is goes to another process and comes back the same."""

from __future__ import annotations

import copy
import pickle
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import ROOT, SQUARE, TEAPOT

import chordal
from chordal.shapes import box, cylinder, sphere, x, y


def again(thing: Any) -> Any:
    return pickle.loads(pickle.dumps(thing))


def test_a_mesh_keeps_its_numbers_its_bound_and_its_report() -> None:
    mesh = chordal.load(TEAPOT).mesh(tol=0.02)
    back = again(mesh)
    assert np.array_equal(back.vertices, mesh.vertices) and np.array_equal(back.faces, mesh.faces)
    assert back.bound == mesh.bound and back.report == mesh.report and repr(back) == repr(mesh)
    assert copy.deepcopy(mesh) is mesh and copy.copy(mesh) is mesh


def test_what_is_made_of_a_mesh_that_came_back_adds_to_its_bound() -> None:
    mesh = chordal.load(TEAPOT).mesh(tol=0.02)
    for start in (mesh, again(mesh)):
        history = start.mesh(tol=0.05).report["certificate"]["history"]
        assert [step["verb"] for step in history["steps"]] == ["mesh", "mesh"]
        assert history["total"]["reference"] == "bezier patches" and history["total"]["at_most"] <= 0.07


def test_a_scene_keeps_parts_nodes_materials_and_pictures() -> None:
    scene = chordal.load(ROOT / "tests/web/painted.gltf")
    assert isinstance(scene, chordal.Mesh)
    back = again(scene)
    assert back.nodes == scene.nodes and back.roots == scene.roots and back.materials == scene.materials
    assert [part.name for part in back.parts] == [part.name for part in scene.parts]
    for own, other in zip(scene.parts, back.parts, strict=True):
        assert np.array_equal(own.vertices, other.vertices) and len(own.attributes) == len(other.attributes)
        for one, two in zip(own.attributes, other.attributes, strict=True):
            assert (one.kind, one.of, one.domain) == (two.kind, two.of, two.domain)
            assert np.array_equal(one.values, two.values)
    assert back.to_bytes("glb") == scene.to_bytes("glb")


def test_a_volume_keeps_its_samples_its_place_and_the_surface_that_is_meant() -> None:
    samples = np.random.default_rng(1).integers(0, 900, (5, 6, 7), dtype=np.uint16)
    volume = chordal.volume(samples, spacing=(1, 2, 3), origin=(4, 5, 6), unit="mm").surface(iso=400.5, border="open")
    back = again(volume)
    assert np.array_equal(back.array, samples) and back.array.dtype == np.uint16
    assert back.spacing == (1, 2, 3) and back.origin == (4, 5, 6)
    assert np.array_equal(back.mesh().vertices, volume.mesh().vertices) and back.mesh().bound == volume.mesh().bound


@pytest.mark.parametrize(
    "field",
    [
        box(2, 2, 1) - cylinder(0.4, 2),
        chordal.field(x * x + y * y - 1) & sphere(2),
        chordal.script("move(sphere(param('r', 1)), 1, 2, 3)", r=0.5),
        sphere(1).within((0, 0, 0), (1, 1, 1)),
        chordal.load(ROOT / "examples/block.star"),
    ],
    ids=["csg", "formula", "script", "within", "file"],
)
def test_a_field_is_made_again(field: chordal.Field) -> None:
    points = np.random.default_rng(2).normal(size=(50, 3))
    back = again(field)
    assert isinstance(back, chordal.Field)
    assert back(points).tobytes() == field(points).tobytes() and back.bounds == field.bounds


def test_a_field_of_ten_thousand_steps_takes_no_deep_stack() -> None:
    field: Any = sphere(0.1)
    for k in range(3000):
        field = field | chordal.shapes.move(sphere(0.1), k, 0, 0)
    assert again(field)([[2999, 0, 0]])[0] == field([[2999, 0, 0]])[0]


def height(points: Any) -> Any:
    """A function with a name."""
    return points[:, 2]


def test_a_function_is_pickled_as_python_pickles_it() -> None:
    named = chordal.field(height, bounds=((-1, -1, -1), (1, 1, 1)))
    assert again(named)._recipe is not None
    with pytest.raises((pickle.PicklingError, AttributeError), match="lambda"):
        pickle.dumps(chordal.field(lambda p: p[:, 0], bounds=((-1, -1, -1), (1, 1, 1))))


def test_curves_cages_drawings_and_lines_come_back() -> None:
    curves = chordal.shapes
    wave = curves.spline([(0, 0), (1, 2), (3, 1)])
    for curve in (wave, curves.arc(2), curves.bezier([(0, 0), (0, 1), (1, 1), (1, 0)]), wave.to_cubics(tol=0.1)):
        assert again(curve).flatten(tol=0.01).points.tobytes() == curve.flatten(tol=0.01).points.tobytes()
    ring = curves.arc(0.5, center=(2, 0)).revolve()
    assert again(ring).mesh(tol=0.1).bound == ring.mesh(tol=0.1).bound
    cage = chordal.Cage([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [(0, 1, 2, 3)], creases=[(0, 1, 2.5)])
    assert again(cage).creases == cage.creases and np.array_equal(again(cage).positions, cage.positions)
    assert again(cage.shape()).mesh(tol=0.1).bound == cage.shape().mesh(tol=0.1).bound
    drawing = chordal.load(ROOT / "examples/drawing.svg")
    lines = drawing.flatten(tol=0.25)
    back = again(again(lines))
    assert np.array_equal(back.points, lines.points) and back.bound == lines.bound and len(back) == len(lines)
    assert back.to_bytes("json") == lines.to_bytes("json")
    assert again(drawing).flatten(tol=0.25).bound == lines.bound


def mesh_of(shape: chordal.Shape) -> chordal.Mesh:
    """Here, so that another process finds it."""
    return shape.mesh(tol=0.05)


def test_processes_mesh_for_one_another() -> None:
    shapes = [chordal.load(SQUARE, format="obj"), sphere(1), chordal.load(TEAPOT)]
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        found = list(pool.map(mesh_of, shapes))
    assert [mesh.bound for mesh in found] == [mesh_of(shape).bound for shape in shapes]


def test_a_pickle_is_read_without_the_file(tmp_path: Path) -> None:
    copied = tmp_path / "teapot.bpt"
    copied.write_bytes(TEAPOT.read_bytes())
    kept = tmp_path / "kept.pickle"
    kept.write_bytes(pickle.dumps(chordal.load(copied)))
    copied.unlink()
    words = f"import pickle; print(pickle.load(open({str(kept)!r}, 'rb')).mesh(tol=0.1).bound.evidence)"
    done = subprocess.run([sys.executable, "-c", words], capture_output=True, encoding="utf-8", check=True)
    assert done.stdout == "proved\n"
