"""What a notebook shows of a mesh."""

from __future__ import annotations

import base64
import html
import json
import os
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import TEAPOT

import chordal
from chordal import _notebook


def mesh() -> chordal.Mesh:
    return chordal.load(TEAPOT).mesh(tol=0.05)


def page_in(text: str) -> str:
    if _notebook._viewer() is None:
        pytest.skip("the package was built without the viewer of notebooks: make studio-page builds it")
    found = re.search(r'srcdoc="([^"]*)"', text)
    assert found is not None
    return html.unescape(found[1])


def facts_in(page: str) -> dict[str, Any]:
    found = re.search(r'<script type="application/json" id="mesh">(.*?)</script>', page, re.S)
    assert found is not None
    facts: dict[str, Any] = json.loads(found[1])
    return facts


def test_a_mesh_says_its_bound_and_carries_its_triangles() -> None:
    made = mesh()
    bundle = made._repr_mimebundle_()
    assert bundle["text/plain"] == repr(made) and html.escape(made.bound.sentence()) in bundle["text/html"]
    facts = facts_in(page_in(bundle["text/html"]))
    faces = np.frombuffer(base64.b64decode(facts["faces"]), "<u4").reshape(-1, 3)
    places = np.frombuffer(base64.b64decode(facts["positions"]), "<f4").reshape(-1, 3)
    assert np.array_equal(faces, made.faces)
    assert np.allclose(places + made.bounds.mean(axis=0), made.vertices, atol=1e-5)


def numbers(text: str, kind: str) -> Any:
    return np.frombuffer(base64.b64decode(text), kind)


def test_it_shows_edges_and_how_far_another_shape_is() -> None:
    made, fine = mesh(), chordal.load(TEAPOT).mesh(tol=0.01)
    facts = facts_in(page_in(made.show(wire=True, deviation=fine)._repr_html_()))
    values, faces = numbers(facts["values"], "<f4"), numbers(facts["faces"], "<u4").reshape(-1, 3)
    assert facts["wire"] is True and 3 * len(values) == len(numbers(facts["positions"], "<f4")) and faces.max() < len(values)
    assert facts["range"] == [0, pytest.approx(float(values.max()))]
    # The edges are those of the mesh, whatever it was cut into.
    assert np.array_equal(numbers(facts["edges"]["faces"], "<u4").reshape(-1, 3), made.faces)


@pytest.mark.parametrize("most", [60_000, 1])
def test_what_is_far_between_vertices_is_coloured(most: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """A chord of a cylinder: all vertices are on it, and the middles of the faces are not."""
    monkeypatch.setattr("chordal._deviation_samples._MOST_DRAWN", most)
    angles = 2 * np.pi * np.arange(6) / 6
    ring = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    points = np.vstack([np.column_stack([ring, np.full(6, z)]) for z in (0.0, 2.0)])
    sides = [(k, (k + 1) % 6, 6 + (k + 1) % 6) for k in range(6)] + [(k, 6 + (k + 1) % 6, 6 + k) for k in range(6)]
    prism, tube = chordal.Mesh(points, sides), chordal.shapes.cylinder(1, 10).mesh(tol=1e-4)
    assert prism.vertex_deviation(tube).max() < 1e-3
    facts = facts_in(page_in(prism.show(deviation=tube)._repr_html_()))
    # 1 - cos 30°: the sagitta of a sixth.
    assert facts["range"][1] == pytest.approx(1 - np.cos(np.pi / 6), rel=0.02 if most > 1 else 0.15)


CORNERS = np.eye(3)


def test_labels_materials_and_vertices_have_their_colours() -> None:
    halves = np.ones((6, 6, 6), np.uint8)
    halves[3:] = 2
    labels = chordal.labels(halves).mesh()
    facts = facts_in(page_in(labels.show()._repr_html_()))
    groups = numbers(facts["groups"], "<u4")
    first = len(labels.parts[0].faces)
    one, two = ({facts["paints"][group] for group in some} for some in (groups[:first], groups[first:]))
    assert len(groups) == len(labels.faces) and len(one) == len(two) == 1 and one != two
    assert all(re.fullmatch("#[0-9a-f]{6}", paint) for paint in facts["paints"])
    # The same parts without materials: a colour for each.
    bare = chordal.scene({"a": chordal.Mesh(CORNERS, [(0, 1, 2)]), "b": chordal.Mesh(CORNERS + 1, [(0, 1, 2)])})
    facts = facts_in(page_in(bare.show()._repr_html_()))
    assert numbers(facts["groups"], "<u4").tolist() == [0, 1] and len(set(facts["paints"])) == 2
    red = np.array([(255, 0, 0)] * 3, np.uint8)
    facts = facts_in(page_in(chordal.Mesh(CORNERS, [(0, 1, 2)], colors=red).show()._repr_html_()))
    assert numbers(facts["colors"], "<f4").tolist() == [1, 0, 0] * 3 and facts["groups"] is None
    plain = facts_in(page_in(mesh().show()._repr_html_()))
    assert plain["colors"] is None and plain["groups"] is None and plain["values"] is None


def test_the_page_needs_nothing_from_elsewhere() -> None:
    page = page_in(mesh().show()._repr_html_())
    assert not re.search(r'(src|href)="(?!data:)', page.split("<script>")[0])
    assert page.count("<script>") == 1 and page.count("</script>") == 2


def test_large_meshes_and_packages_without_a_viewer_show_a_picture(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_notebook, "MOST_FACES", 10)
    assert '<img alt="' in mesh().show()._repr_html_()
    monkeypatch.setattr(_notebook, "MOST_FACES", 10**6)
    monkeypatch.setattr(_notebook, "_viewer", lambda: None)
    assert 'src="data:image/png;base64,' in mesh().show()._repr_html_()


def test_a_browser_draws_it(tmp_path: Path) -> None:
    browser = os.environ.get("CHROMIUM") or shutil.which("chromium")
    if browser is None:
        pytest.skip("there is no Chromium: what a notebook shows is not drawn")
    page = tmp_path / "notebook.html"
    page.write_text(page_in(mesh().show(wire=True)._repr_html_()), encoding="utf-8")
    words = ["--headless=new", "--no-sandbox", "--enable-unsafe-swiftshader", "--use-angle=swiftshader"]
    words += [f"--user-data-dir={tmp_path / 'profile'}", "--virtual-time-budget=8000", "--window-size=760,480"]
    done = subprocess.run([browser, *words, "--dump-dom", page.as_uri()], check=True, capture_output=True, timeout=120)
    shown = done.stdout.decode()
    assert 'data-settled="true"' in shown and re.search(r'<div id="view"[^>]*><canvas', shown)
