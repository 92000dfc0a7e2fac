"""A program that uses what most programs use, for checkers of types: nothing in it is unknown or `Any` to them. It is not run."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from typing_extensions import assert_type

import chordal


def distance(points: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.hypot(points[:, 0], points[:, 1]) - 1


# What a file holds: nobody but its reader knows, unless it is said.
assert_type(chordal.load("a.nrrd"), chordal.Shape)
assert_type(chordal.load("a.nrrd", kind=chordal.Volume), chordal.Volume)
assert_type(chordal.load(Path("a.glb"), kind=chordal.Mesh), chordal.Mesh)
assert_type(chordal.load(b"", format="glb"), chordal.Mesh)
assert_type(chordal.load(b"", format="nii"), chordal.Volume)
assert_type(chordal.load(b"", format="star"), chordal.Field)
assert_type(chordal.volume("a.nrrd"), chordal.Volume)
assert_type(chordal.load("a.nrrd").mesh(iso=0.5), chordal.Mesh)

# Verbs, as functions and as methods.
mesh = chordal.mesh("a.stl", tol=0.1)
assert_type(mesh, chordal.Mesh)
assert_type(chordal.deviation(mesh, "b.stl"), chordal.Deviation)
assert_type(chordal.deviation(mesh, "b.stl", max=1).verdict, str | None)
assert_type(chordal.convert(mesh, "a.glb"), chordal.Report)
assert_type(chordal.inspect("a.stl"), chordal.Report)
assert_type(chordal.union(mesh, mesh, tol=0.1), chordal.Mesh)
assert_type(mesh - mesh, chordal.Mesh)
assert_type(chordal.bake(mesh, cells=8), chordal.Volume)
assert_type(chordal.render(mesh).array, NDArray[np.uint8])
assert_type(mesh.lod(pixels=1).at(5).mesh, chordal.Mesh)
assert_type([level.distance for level in mesh.lod()], list[float | None])

# What is known of a mesh.
assert_type(mesh.vertices, NDArray[np.float64])
assert_type(mesh.faces, NDArray[np.int32])
assert_type(mesh.parts[0].uv, NDArray[np.float64] | None)
assert_type(mesh.bound.at_most, float | None)
assert_type(mesh.bound.is_within(0.1), bool)
assert_type(mesh.report.bound, chordal.Bound | None)
assert_type(mesh.export("a.stl").bound, chordal.Bound | None)

# Scenes.
steel = chordal.Material("steel", color="#889", metallic=1)
table = chordal.scene({"top": mesh, "leg": chordal.Placed(mesh, [(0, 0, 0), (1, 0, 0)], material=steel)}, unit="mm")
assert_type(table, chordal.Mesh)
assert_type(table.nodes[0].children, tuple[int, ...])

# Fields, formulas, curves, volumes.
assert_type(chordal.field(distance, bounds=((-1, -1, -1), (1, 1, 1))), chordal.Field)
assert_type(chordal.field(lambda p: p[:, 2])([[0, 0, 0]]), NDArray[np.float64])
assert_type(chordal.shapes.box(1, 2, 3) - chordal.shapes.sphere(1), chordal.Field)
assert_type(chordal.shapes.x * chordal.shapes.y + 1, chordal.Formula)
assert_type(chordal.shapes.sin(0.5), float)
assert_type(chordal.shapes.arc(1).flatten(tol=0.1)[0].points, NDArray[np.float64])
assert_type(chordal.shapes.arc(1).revolve(), chordal.Shape)
assert_type(chordal.volume(np.zeros((2, 2, 2))).spacing, tuple[float, float, float])
assert_type(chordal.block_volume(np.zeros((2, 2, 2))).labels(), dict[int, chordal.Mesh])
