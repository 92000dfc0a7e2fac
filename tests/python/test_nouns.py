"""Whatever class the package names: pickled, copied, compared, hashed, and as Python and a notebook show it."""

from __future__ import annotations

import copy
import json
import pickle
import re
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import TEAPOT

import chordal
from chordal import _html
from chordal.shapes import arc, bezier, move, sphere, x

CORNERS = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
FACES = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]
#: What is nothing by itself, or is known by a test of its own.
ABSTRACT = {"Error"}


@pytest.fixture(scope="module")
def nouns(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    folder = tmp_path_factory.mktemp("nouns")
    solid = chordal.Mesh(CORNERS, FACES, uv=[(0, 0), (1, 0), (0, 1), (1, 1)])
    blocks = chordal.block_volume(np.linspace(0, 1, 9**3).reshape(9, 9, 9))
    levels = sphere(1).lod(tol=0.1)
    lines = bezier([(0, 0), (0, 1), (1, 1), (1, 0)]).flatten(tol=0.1)
    deviation = solid.deviation(solid)
    return {
        "Attribute": solid.attributes[0],
        "Block": next(blocks.blocks(4)),
        "BlockVolume": blocks,
        "Bound": sphere(1).mesh(tol=0.1).bound,
        "BudgetError": chordal.BudgetError("no limit"),
        "BudgetUnmet": chordal.BudgetUnmet("not met", solid),
        "Cage": chordal.Cage(CORNERS, FACES),
        "Curve": arc(1),
        "Deviation": deviation,
        "ErrorCurve": chordal.plot_error(sphere(1), rel=[0.03, 0.01]),
        "Field": sphere(1),
        "Formula": x * x,
        "InternalError": chordal.InternalError("broken"),
        "Level": levels[0],
        "Levels": levels,
        "Material": chordal.Material("red", color="#f00", texture=b"1234"),
        "Mesh": solid,
        "MeshLevel": chordal.MeshLevel(solid.bound, 4, 1),
        "Node": solid.nodes[0],
        "OneSided": deviation.forward,
        "Part": solid.parts[0],
        "Picture": sphere(1).render(size=(16, 12)),
        "Placed": chordal.Placed(solid, (1, 0, 0), name="a"),
        "Polyline": lines[0],
        "Polylines": lines,
        "ReadError": chordal.ReadError("code", "line 1", "wrong"),
        "Refused": chordal.Refused("code", "no"),
        "Report": solid.export(folder / "a.glb"),
        "Shape": chordal.load(TEAPOT),
        "Tileset": blocks.tileset(folder / "tiles", iso=0.5, inside="high"),
        "View": chordal.View("640x480 fov=45 dist=4"),
        "Volume": chordal.volume(np.arange(27.0).reshape(3, 3, 3)).surface(iso=4, inside="high"),
        "WriteError": chordal.WriteError("none"),
    }


CLASSES = [name for name in chordal.__all__ if isinstance(getattr(chordal, name), type) and name not in ABSTRACT]
#: Values, which are what they say: two of them are equal where all of that is.
VALUES = {"Block", "Bound", "Deviation", "Material", "MeshLevel", "Node", "OneSided", "Report", "Tileset", "View"}


@pytest.mark.parametrize("name", CLASSES)
def test_it_is_pickled_copied_compared_and_shown(name: str, nouns: dict[str, Any]) -> None:
    thing = nouns[name]
    assert type(thing).__name__ == name
    back = pickle.loads(pickle.dumps(thing))
    for again in (back, copy.copy(thing), copy.deepcopy(thing)):
        assert type(again) is type(thing) and str(again) == str(thing)
        if name in VALUES:
            assert again == thing and (name == "Report" or hash(again) == hash(thing))
    # Whatever is no value is itself and nothing else; all but a report, which may be changed, can be in a set.
    assert thing == thing and thing != object()
    if name not in VALUES:
        assert len({thing, copy.copy(thing), back}) in (2, 3)
    # Some lines at most, and no address in memory.
    shown = repr(thing)
    assert len(shown) < 700 and not re.search(r"0x[0-9a-f]{6}", shown)


@pytest.mark.parametrize(
    "name",
    ["BlockVolume", "Bound", "Deviation", "ErrorCurve", "Field", "Levels", "Part", "Polylines", "Report", "Shape", "Volume"],
)
def test_a_notebook_shows_a_small_table_without_colours(name: str, nouns: dict[str, Any]) -> None:
    shown = nouns[name]._repr_html_()
    assert "<table>" in shown and len(shown) < 5000
    assert not re.search(r"(?<!-)color:(?!inherit)|background|<style|<script", shown)


def test_a_picture_comes_back_with_its_files(nouns: dict[str, Any]) -> None:
    picture = nouns["Picture"]
    back = pickle.loads(pickle.dumps(picture))
    assert np.array_equal(back.array, picture.array) and back.report == picture.report
    assert back.view == picture.view and back.darkest == picture.darkest
    for format in ("png", "jpg", "webp"):
        assert back.to_bytes(format) == picture.to_bytes(format)
    with pytest.raises(ValueError, match="bytes are not 16 × 12 pixels"):
        chordal._chordal.Picture.of_state(((16, 12), b"", [], "", "", None))


def test_a_part_comes_back_without_the_others(nouns: dict[str, Any]) -> None:
    halves = np.ones((4, 4, 4), np.uint8)
    halves[2:] = 2
    scene = chordal.labels(halves).mesh()
    for part in (*scene.parts, nouns["Part"]):
        back = pickle.loads(pickle.dumps(part))
        assert back.name == part.name and np.array_equal(back.vertices, part.vertices)
        assert np.array_equal(back.faces, part.faces) and len(back.attributes) == len(part.attributes)
        for one, other in zip(back.attributes, part.attributes, strict=True):
            assert (one.kind, one.of, one.domain) == (other.kind, other.of, other.domain)
            assert np.array_equal(one.values, other.values)
    assert len(pickle.dumps(scene.parts[0])) < len(pickle.dumps(scene))


def test_a_report_is_a_dictionary_of_which_a_few_lines_are_shown(tmp_path: Path) -> None:
    report = chordal.load(TEAPOT).mesh(tol=0.1).export(tmp_path / "a.glb")
    assert isinstance(report, dict) and json.loads(json.dumps(report)) == report == dict(report)
    lines = repr(report).splitlines()
    assert lines[0] == "<Report: mesh of patches" and len(lines) < 10
    assert report.bound is not None and report.bound.sentence() in lines[1] and "a.glb, " in lines[-1]
    report["certificate"]["bound"] = None
    assert report.bound is None and "bound" not in repr(report)
    assert repr(chordal.Report()) == "<Report>" and repr(chordal.Report(run=None, certificate=[])) == "<Report>"
    # It may be changed, so that nothing of it is sure to be there.
    broken = chordal.Report(certificate={"bound": {"at_least": 1}, "notes": "n", "input": {"warnings": [{"count": 1}]}})
    assert repr(broken) == "<Report>" and broken.bound is None
    for again in (report.copy(), report | {}, {} | report):
        assert type(again) is chordal.Report and again == report and again is not report


def test_what_a_file_has_wrong_is_in_the_report() -> None:
    report = chordal.load(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 0\nf 1 2 3\nf 1 1 1\n", format="obj").inspect()
    assert "found: 3 boundary edges, 1 collapsed triangle" in repr(report) and "and 1 more" in repr(report)
    assert "box: (0, 0, 0) to (1, 1, 0)" in repr(report)


def test_a_length_is_within_the_bound_or_not() -> None:
    bound = sphere(1).mesh(tol=0.01).bound
    assert bound.at_most is not None
    assert bound.is_within(0.01) and bound.is_within(bound.at_most) and not bound.is_within(bound.at_most * 0.999)
    measured = (sphere(1) | move(sphere(1), 1, 0, 0)).mesh(tol=0.01, require="measured").bound
    assert measured.at_most is None and not measured.is_within(1e9)


def test_layers_of_samples_are_drawn_from_the_least_to_the_most() -> None:
    layer = np.array([[0.0, 1.0], [2.0, np.nan], [1e308, -1e308]])
    content = _html.slice_to_png(layer)
    assert content[12:24] == b"IHDR" + (3).to_bytes(4, "big") + (2).to_bytes(4, "big")
    start = content.index(b"IDAT") + 4
    shown = np.frombuffer(zlib.decompressobj().decompress(content[start:]), np.uint8).reshape(2, 4)[:, 1:]
    # Rows from above: y = 1, y = 0; columns are x.
    assert shown[1, 2] == 255 and shown[0, 2] == 0 and shown[1, 0] in (127, 128)
