"""Keyword arguments and the tables of options: each keyword is an option, and each option a keyword of some method."""

from __future__ import annotations

import inspect

import pytest

import chordal
from chordal._option_tables import LOD, MESH, REPAIRS, SURFACE

#: What is another method's: `export` writes a format with normals, `BudgetUnmet.best` keeps the best, `Cage.refined` has levels.
ELSEWHERE = {"format", "normals", "keep_best", "level"}
#: Keywords that are no options: a share of the diagonal is a length, and a border is one of two flags.
OWN = {"self", "rel", "progress", "border"}


def keywords(method: object) -> set[str]:
    return set(inspect.signature(method).parameters) - OWN  # type: ignore[arg-type]


def test_the_keywords_of_mesh_and_flatten_are_options_of_meshes_and_volumes() -> None:
    of_mesh, of_flatten = keywords(chordal.Shape.mesh), keywords(chordal.Shape.flatten)
    assert of_mesh | of_flatten == (set(MESH) - ELSEWHERE) | (set(SURFACE) - {"cap", "open"})


def test_the_keywords_of_lod_are_options_of_levels() -> None:
    of_packing = {"quantize", "compress"}
    assert keywords(chordal.Shape.lod) - of_packing == set(LOD) - {"keep_best"}


def test_the_keywords_of_mend_are_options_of_repairs() -> None:
    assert keywords(chordal.Shape.mend) == set(REPAIRS) - {"format"}


def test_a_value_without_sense_names_its_keyword() -> None:
    shape = chordal.load(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", format="obj")
    with pytest.raises(chordal.BudgetError, match="^angle: "):
        shape.mesh(tol=1, angle=400)
    with pytest.raises(ValueError, match="^require: "):
        shape.mesh(tol=1, require="hoped")  # type: ignore[arg-type]
    with pytest.raises(chordal.BudgetError, match='^a budget in pixels needs a view: add view=".*" to pixels=2$'):
        shape.mesh(pixels=2)
    with pytest.raises(chordal.BudgetError, match="^a view is for a budget in pixels: add pixels=1$"):
        shape.mesh(tol=1, view="100x100 fov=45 dist=4")
