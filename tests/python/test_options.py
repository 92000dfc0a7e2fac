"""Keyword arguments and the tables of options: each keyword is an option, and each option a keyword of some method."""

from __future__ import annotations

import inspect

import numpy as np
import pytest

import chordal
from chordal._option_tables import BAKE, DEVIATION, LOD, MESH, OUTPUT, PICTURE, READING, REPAIRS, SURFACE
from chordal._options import options

#: Keywords that are no options: a share of the diagonal is a length.
OWN = {"self", "rel", "progress"}


def keywords(method: object) -> set[str]:
    return set(inspect.signature(method).parameters) - OWN  # type: ignore[arg-type]


def test_the_keywords_of_mesh_and_flatten_are_options_of_meshes_and_volumes() -> None:
    of_mesh, of_flatten = keywords(chordal.Shape.mesh), keywords(chordal.Shape.flatten)
    assert of_mesh | of_flatten == set(MESH) | set(SURFACE)


def test_the_keywords_of_lod_are_options_of_levels() -> None:
    assert keywords(chordal.Shape.lod) == set(LOD) | set(OUTPUT)


def test_the_keywords_of_export_are_options_of_outputs() -> None:
    assert keywords(chordal.Shape.export) - {"path", "tol"} == set(OUTPUT)
    assert keywords(chordal.Shape.to_bytes) - {"format", "tol"} == set(OUTPUT)


def test_the_keywords_of_bake_deviation_and_render_are_options_of_theirs() -> None:
    assert keywords(chordal.Shape.bake) == set(BAKE)
    assert keywords(chordal.Shape.deviation) - {"other"} == set(DEVIATION)
    assert keywords(chordal.Shape.render) - {"against"} == set(PICTURE)


def test_the_keywords_of_mend_are_options_of_repairs() -> None:
    assert keywords(chordal.Shape.mend) == set(REPAIRS)


def test_the_keywords_of_load_are_options_of_inputs() -> None:
    assert keywords(chordal.load) - {"source", "kind"} == set(READING)


def test_a_flag_is_set_if_it_is_true_and_another_value_if_it_is_there() -> None:
    assert options(LOD, merge=False) == options(LOD, merge=np.False_) == options(LOD, merge=0) == []
    assert options(LOD, merge=np.True_, nearest=None) == [("merge", "merge", "")]
    with pytest.raises(TypeError, match="^pixels: "):
        options(MESH, pixels=False)


def test_a_value_without_sense_names_its_keyword() -> None:
    shape = chordal.load(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", format="obj")
    with pytest.raises(chordal.BudgetError, match="^angle: "):
        shape.mesh(tol=1, angle=400)
    with pytest.raises(ValueError, match="^show: 'shaded', .* or 'deviation', not 'x-rays'$"):
        shape.render(show="x-rays")  # type: ignore[arg-type]
    with pytest.raises(chordal.BudgetError, match='^a picture needs a camera with a position: view=".*"$'):
        shape.render(view="100x100 fov=45 dist=4")
    with pytest.raises(ValueError, match="^quantize=True is for .glb and .gltf; stl holds plain numbers$"):
        shape.to_bytes("stl", quantize=True)
    with pytest.raises(ValueError, match="^compress: 'meshopt', not 'draco'$"):
        shape.to_bytes("glb", compress="draco")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="^require: "):
        shape.mesh(tol=1, require="hoped")  # type: ignore[arg-type]
    with pytest.raises(chordal.BudgetError, match='^a budget in pixels needs a view: add view=".*" to pixels=2$'):
        shape.mesh(pixels=2)
    with pytest.raises(chordal.BudgetError, match="^a view is for a budget in pixels: add pixels=1$"):
        shape.mesh(tol=1, view="100x100 fov=45 dist=4")
