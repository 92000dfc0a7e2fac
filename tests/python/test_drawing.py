"""Drawings: SVG in, polylines or filled triangles out, and what is wrong in one is said with its place."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT, Command

import chordal

DRAWING = ROOT / "examples" / "drawing.svg"
RING = b"""<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 10 10">
<path fill-rule="evenodd" d="M0 0H10V10H0Z M2 2H8V8H2Z"/></svg>"""


def area(mesh: chordal.Mesh) -> float:
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    return float(np.abs(np.cross(b - a, c - a)[:, 2]).sum() / 2)


def test_a_drawing_is_filled_by_its_rule() -> None:
    ring = chordal.load(RING)
    mesh = ring.mesh(tol=0.01)
    assert ring.kind == "drawing" and (mesh.vertices[:, 2] == 0).all()
    assert area(mesh) == 64
    lines = ring.flatten(tol=0.01)
    assert [line.closed for line in lines] == [True, True] and [line.source for line in lines] == [0, 0]
    assert lines.bound.at_most == 0


@pytest.mark.parametrize("extension", ["obj", "glb"])
def test_a_filled_drawing_is_that_of_the_command(cargo_chordal: Command, tmp_path: Path, extension: str) -> None:
    theirs = tmp_path / f"theirs.{extension}"
    done = cargo_chordal("mesh", DRAWING, "--tol", "0.25", "-o", theirs)
    assert done.returncode == 0, done.stderr
    assert chordal.load(DRAWING).mesh(tol=0.25).to_bytes(extension) == theirs.read_bytes()


def test_what_is_not_supported_is_listed() -> None:
    text = RING.replace(b"</svg>", b"<text>hello</text></svg>")
    warnings = chordal.load(text).inspect()["certificate"]["input"]["warnings"]
    assert any("text" in warning["message"] for warning in warnings)


def test_a_wrong_drawing_names_the_place() -> None:
    with pytest.raises(chordal.ReadError) as caught:
        chordal.load(b"<svg xmlns='http://www.w3.org/2000/svg'>\n<path d='M 0 0 L nan 1'/></svg>", format="svg")
    assert caught.value.place is not None and "line 2" in str(caught.value)
