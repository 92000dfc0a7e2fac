"""Splines, arcs, NURBS and fitted paths, and the shapes made of them: against what numpy computes of them here."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from font import bar_font
from numpy.typing import NDArray

import chordal

SEED = 20_260_102


def sampled(curve: chordal.Curve, steps: int = 200) -> NDArray[np.float64]:
    return curve.points_at(np.linspace(0, curve.n_pieces, curve.n_pieces * steps + 1))


@pytest.mark.parametrize("width", [2, 3])
@pytest.mark.parametrize("knots", ["centripetal", "chordal", "uniform"])
def test_splines_pass_their_points_and_are_smooth_by_their_knots(width: int, knots: Any) -> None:
    points = np.random.default_rng(SEED).uniform(-1, 1, (8, width))
    for closed in (False, True):
        path = chordal.shapes.spline(points, closed, knots)
        n = len(points) if closed else len(points) - 1
        assert (path.n_pieces, path.closed) == (n, closed)
        assert np.array_equal(path.points_at(np.arange(len(points))), points)
        steps = np.linalg.norm(np.diff(np.vstack([points, points[:1]]), axis=0), axis=1)[:n]
        widths = {"uniform": np.ones(n), "chordal": steps, "centripetal": np.sqrt(steps)}[knots]
        # Derivatives by the knots, at the end of each piece and the start of the next. The end is that of the reversed cubic.
        control = [path.points_at([k + t for t in (0, 1 / 3, 2 / 3, 1 - 1e-16)]) for k in range(n)]
        assert len(control) == n
        for order, power in ((1, 1), (2, 2)):
            before = path.derivatives(np.arange(1, n) - 1e-9, order)  # type: ignore[arg-type]
            after = path.derivatives(np.arange(1, n), order)  # type: ignore[arg-type]
            scale = widths[:, None] ** power
            assert np.allclose(before / scale[:-1], after / scale[1:], rtol=1e-5, atol=1e-5), f"seed {SEED}"
        if not closed:
            assert np.allclose(path.derivatives([0, n], 2), 0, atol=1e-9)


def test_tangents_are_those_at_the_ends() -> None:
    path = chordal.shapes.spline([(0, 0), (1, 1), (2, 0)], knots="uniform", tangents=[(1, 0), (0, -2)])
    assert np.allclose(path.derivatives([0, 2]), [(1, 0), (0, -2)])


def test_a_nurbs_is_the_sum_of_its_basis() -> None:
    random = np.random.default_rng(SEED)
    control, weights = random.uniform(-1, 1, (7, 3)), random.uniform(0.5, 2, 7)
    knots = np.array([0, 0, 0, 0, 1, 2, 3, 4, 4, 4, 4])

    def basis(i: int, p: int, t: float) -> float:
        if p == 0:
            return float(knots[i] <= t < knots[i + 1])
        found = 0.0
        for a, b, j in ((knots[i], knots[i + p], i), (knots[i + p + 1], knots[i + 1], i + 1)):
            found += 0 if a == b else (t - a) / (b - a) * basis(j, p - 1, t)
        return found

    curve = chordal.shapes.nurbs(control, 3, weights, knots)
    for t in np.linspace(0, 3.99, 40):
        shares = weights * [basis(i, 3, t) for i in range(7)]
        assert np.allclose(curve.points_at(t), shares @ control / shares.sum(), atol=1e-13)
    assert np.allclose(chordal.shapes.nurbs(control, 3, weights).points_at(curve.points_at(0)[:0]), np.zeros((0, 3)))


def test_arcs_are_circles_and_end_where_quarters_do() -> None:
    circle = chordal.shapes.arc(2, center=(1, 0))
    assert circle.closed and np.allclose(np.linalg.norm(sampled(circle) - (1, 0), axis=1), 2, atol=1e-14)
    half = chordal.shapes.arc(1, start=-90, degrees=180)
    assert half.points_at([0, 1]).tolist() == [[0, -1], [0, 1]]
    assert chordal.shapes.arc(1, 30, 20).flatten(tol=1e-3).bound.evidence == "proved"


def test_cubics_are_within_their_bound() -> None:
    for curve in (chordal.shapes.arc(3), chordal.shapes.nurbs([(1, 0), (1, 1), (0, 1)], 2, [1, 0.5**0.5, 1])):
        radius = np.linalg.norm(curve.points_at(0))
        for tol in (1e-2, 1e-5, 1e-9):
            cubics = curve.to_cubics(tol=tol)
            assert cubics.bound is not None and cubics.bound.at_most is not None
            assert cubics.bound.evidence == "proved" and 0 < cubics.bound.at_most <= tol
            off = np.abs(np.linalg.norm(sampled(cubics), axis=1) - radius)
            assert 0.5 * cubics.bound.at_most < off.max() <= cubics.bound.at_most
    plain = chordal.shapes.bezier([(0, 0), (0, 1), (1, 1), (1, 0)])
    kept = plain.to_cubics(tol=1e-3)
    assert plain.bound is None and kept.bound is not None and kept.bound.at_most == 0
    assert np.array_equal(sampled(kept), sampled(plain))


def test_a_fitted_path_is_near_its_points_and_no_nearer_than_it_says() -> None:
    t = np.linspace(0, 2 * np.pi, 500, endpoint=False)
    points = np.column_stack([3 * np.cos(t), 2 * np.sin(t)])
    path = chordal.shapes.fit(points, 1e-3, closed=True)
    assert path.closed and path.n_pieces < 12
    assert path.bound is not None and path.bound.at_most is not None
    line = sampled(path, 1000)
    a, d = line[:-1], np.diff(line, axis=0)
    s = np.clip(((points[:, None] - a) * d).sum(axis=2) / (d * d).sum(axis=1), 0, 1)
    found = np.linalg.norm(points[:, None] - (a + s[..., None] * d), axis=2).min(axis=1).max()
    # Chords of a few thousandths are off by a millionth.
    assert 0.9 * path.bound.at_most < found <= path.bound.at_most + 1e-6 and path.bound.at_most <= 1e-3


@pytest.mark.parametrize(
    ("surface", "value"),
    [
        (chordal.shapes.arc(0.5, center=(2, 0)).revolve(), lambda x, y, z: np.hypot(np.hypot(x, y) - 2, z) - 0.5),
        (chordal.shapes.arc(1, start=-90, degrees=180).revolve(), lambda x, y, z: np.sqrt(x * x + y * y + z * z) - 1),
        (chordal.shapes.nurbs([(1, 0), (1, 2)], 1).revolve(), lambda x, y, z: np.hypot(x, y) - 1),
        (chordal.shapes.nurbs([(1, 0), (0, 2)], 1).revolve(), lambda x, y, z: (np.hypot(x, y) - 1 + z / 2) / np.hypot(1, 0.5)),
        (chordal.shapes.arc(1).extrude((0, 0, 3)), lambda x, y, z: np.hypot(x, y) - 1),
    ],
    ids=["torus", "sphere", "cylinder", "cone", "tube"],
)
def test_surfaces_of_curves_are_meshed_within_a_proved_bound(surface: chordal.Shape, value: Any) -> None:
    assert surface.kind == "surfaces"
    mesh = surface.mesh(tol=1e-3)
    assert mesh.bound.evidence == "proved" and mesh.bound.at_most is not None and mesh.bound.at_most <= 1e-3
    corners = mesh.vertices[mesh.faces]
    weights = np.random.default_rng(SEED).dirichlet((1, 1, 1), 4)
    places = np.vstack([mesh.vertices, *(np.einsum("k,nkd->nd", w, corners) for w in weights)])
    assert np.abs(value(*places.T)).max() <= mesh.bound.at_most


def test_the_torus_and_the_ball_are_closed_and_face_outwards() -> None:
    for surface in (chordal.shapes.arc(0.5, center=(2, 0)).revolve(), chordal.shapes.arc(1, -90, 180).revolve()):
        mesh = surface.mesh(tol=0.01)
        valid = mesh.report["certificate"]["valid"]
        assert valid["closed"] and valid["manifold"]
        a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
        assert np.einsum("nd,nd->", a, np.cross(b, c)) > 0


def test_a_surface_is_the_one_of_its_arrays() -> None:
    control = np.zeros((4, 5, 3))
    control[..., 0], control[..., 1] = np.meshgrid(np.arange(5), np.arange(4))
    control[..., 2] = np.random.default_rng(SEED).uniform(-1, 1, (4, 5))
    mesh = chordal.shapes.surface(control, degrees=(2, 3)).mesh(tol=1e-2)
    assert mesh.bound.evidence == "proved"
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    assert np.allclose(low[:2], 0) and np.allclose(high[:2], (4, 3))
    same = chordal.shapes.surface(control, weights=np.ones((4, 5)), knots=([0, 0, 0, 1, 2, 3, 3, 3], [0] * 4 + [1] * 4), degrees=(2, 3))
    assert np.array_equal(same.mesh(tol=1e-2).vertices, mesh.vertices)


def test_curves_are_shapes_of_fields_as_in_scripts() -> None:
    points = [[2, 0], [0, 2], [-2, 0], [0, -1]]
    outline = chordal.shapes.spline(points, closed=True)
    places = np.random.default_rng(SEED).uniform(-3, 3, (2000, 3))
    for made, text in [
        (chordal.shapes.polygon(outline, 0.01), f"polygon(spline({points}, closed=True), 0.01)"),
        (chordal.shapes.polygon(chordal.shapes.arc(2)), "polygon(arc(2))"),
        (chordal.shapes.polygon(np.array(points)), f"polygon({points})"),
        (chordal.shapes.extrude(chordal.shapes.circle(1), 2, bevel=0.25), "extrude(circle(1), 2, bevel=0.25)"),
        (chordal.shapes.extrude(chordal.shapes.circle(1), 2, rounded=0.25), "extrude(circle(1), 2, rounded=0.25)"),
        (chordal.shapes.sweep(outline, 0.5, 0.01), f"sweep(spline({points}, closed=True), 0.5, 0.01)"),
        (chordal.shapes.sweep(chordal.shapes.arc(2), chordal.shapes.rectangle(1, 0.5)), "sweep(arc(2), rectangle(1, 0.5))"),
        (
            chordal.shapes.sweep(chordal.shapes.fit(points, 0.1, True), chordal.shapes.circle(0.25), 0.05),
            f"sweep(fit({points}, 0.1, True), circle(0.25), 0.05)",
        ),
    ]:
        script = chordal.script(text)
        assert np.array_equal(made(places), script(places)), text
        assert set(made.notes) <= set(script.notes)
    solid = chordal.shapes.extrude(chordal.shapes.polygon(outline, 0.01), 1, bevel=0.2)
    assert len(solid.notes) == 1 and "straight lines within" in solid.notes[0]
    warnings = solid.inspect()["certificate"]["input"]["warnings"]
    assert [warning["code"] for warning in warnings] == ["script-said"]


def test_shapes_along_curves_are_meshed_within_a_proved_bound() -> None:
    path = chordal.shapes.spline([(0, 0, 0), (2, 0, 1), (2, 2, 2)])
    for field in (
        chordal.shapes.sweep(path, 0.25, 0.01),
        chordal.shapes.sweep(path, chordal.shapes.rectangle(0.5, 0.25), 0.01),
        chordal.shapes.extrude(chordal.shapes.polygon(chordal.shapes.spline([(2, 0), (0, 2), (-2, 0)], True), 0.02), 1, bevel=0.2),
    ):
        mesh = field.mesh(tol=0.02)
        assert mesh.bound.evidence == "proved" and mesh.bound.at_most is not None and mesh.bound.at_most <= 0.02
        assert mesh.report["certificate"]["valid"]["closed"]


def test_a_font_sets_a_text_as_a_solid_and_as_a_field(tmp_path: Path) -> None:
    font = tmp_path / "bar.ttf"
    font.write_bytes(bar_font())
    letters = chordal.load(font, text="A A", em=10)
    assert letters.kind == "drawing"
    mesh = letters.mesh(tol=1e-3, extrude=2)
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    assert np.allclose(low, 0) and np.allclose(high, (14, 7, 2))
    assert mesh.report["certificate"]["input"]["letters"]["text"] == "A A"
    cut = letters.mesh(tol=1e-2, extrude="2", bevel=0.5)
    assert cut.report["certificate"]["valid"]["closed"] and cut.bound.evidence in ("proved", "proved-if")
    assert len(letters.flatten(tol=1e-3)) == 2
    field = chordal.shapes.text("A A", font, 0.01, em=10)
    assert field([[2.5, 3.5, 0], [7, 3.5, 0], [11.5, 3.5, 0]]).tolist() == [-2.5, 2, -2.5]
    # An advance of a letter is 6 and that of a space 3, so that the line is 15 long.
    for align, start in [("left", 0.0), ("center", -7.5), ("right", -15.0)]:
        moved = chordal.shapes.text("A A", font, 0.01, 10, align)  # type: ignore[arg-type]
        assert moved([[start + 2.5, 3.5, 0], [start + 7, 3.5, 0], [start + 14, 3.5, 0]]).tolist() == [-2.5, 2, 0]
    with pytest.raises(ValueError, match="'left', 'center' or 'right'"):
        chordal.shapes.text("A", font, 0.01, align="middle")  # type: ignore[arg-type]
    # Straight lines, but for the rounding of where they are placed.
    assert float(field.notes[0].split("within ")[1].split()[0]) < 1e-12
    drawing = tmp_path / "a.svg"
    drawing.write_text("<svg xmlns='http://www.w3.org/2000/svg'><circle r='2'/></svg>")
    disc = chordal.shapes.svg(drawing, 0.01)
    assert abs(disc([[0, 0, 0]])[0] + 2) <= 0.01 and "polygons within" in disc.notes[0]


def test_texts_that_a_font_cannot_set_are_one_sentence(tmp_path: Path) -> None:
    whole = bar_font()
    with pytest.raises(chordal.ReadError, match="more than 10,000 characters"):
        chordal.load(whole, text="A" * 1_000_000)
    with pytest.raises(chordal.ReadError, match="no glyph for 'B'"):
        chordal.load(whole, text="AB")
    with pytest.raises(chordal.ReadError):
        chordal.load(whole)
    with pytest.raises(chordal.ReadError, match="does not apply to obj"):
        chordal.load(b"v 0 0 0\n", format="obj", text="A")
    with pytest.raises(ValueError, match="em, axes: they are for the text"):
        chordal.load(whole, em=2)
    with pytest.raises(chordal.ReadError):
        chordal.load(whole, text="A", axes={"wght": 700})
    with pytest.raises(TypeError, match="tolerance: a number"):
        chordal.shapes.text("A", tmp_path / "none.ttf", "much")  # type: ignore[arg-type]
    with pytest.raises(FileNotFoundError):
        chordal.shapes.text("A", tmp_path / "none.ttf", 0.1)
    random = np.random.default_rng(SEED)
    outcomes = set()
    for _ in range(300):
        broken = bytearray(whole)
        for at in random.integers(0, len(whole), random.integers(1, 9)):
            broken[at] = random.integers(0, 256)
        try:
            outcomes.add(chordal.load(bytes(broken), format="ttf", text="A A").kind)
        except chordal.ReadError as error:
            outcomes.add("refused")
            assert "\n" not in error.message, f"seed {SEED}"
    assert outcomes == {"drawing", "refused"}


@pytest.mark.parametrize(
    ("make", "part"),
    [
        (lambda: chordal.shapes.spline([(0, 0)]), "at least 2 points"),
        (lambda: chordal.shapes.spline([[0, 1, 2, 3], [0, 1, 2, 3]]), "rows of 2 or 3 coordinates"),
        (lambda: chordal.shapes.spline([(0, 0), (1, 1)], knots="odd"), "chordal. or .uniform"),  # type: ignore[arg-type]
        (lambda: chordal.shapes.nurbs([(0, 0), (1, 1)], 3), "control points"),
        (lambda: chordal.shapes.nurbs([(0, 0), (1, 1)], 1, [1, 0]), "weight"),
        (lambda: chordal.shapes.arc(0), "radius above 0"),
        (lambda: chordal.shapes.arc(1).points_at(np.nan), "not finite"),
        (lambda: chordal.shapes.arc(1).derivatives(0, 3), "order: 1 or 2"),  # type: ignore[arg-type]
        (lambda: chordal.shapes.arc(2).revolve(), "radius"),
        (lambda: chordal.shapes.spline([(0, 0, 0), (1, 1, 1)]).revolve(), "a path in the plane"),
        (lambda: chordal.shapes.arc(2).extrude((0, 1)), "three numbers"),
        (lambda: chordal.shapes.arc(2).to_cubics(tol=-1), "tol"),
        (lambda: chordal.shapes.bezier(np.zeros((2, 4, 2))).points_at(0), "not 2"),
        (lambda: chordal.shapes.polygon(chordal.shapes.spline([(0, 0, 0), (1, 1, 1)])), "a 2D path"),
        (lambda: chordal.shapes.surface(np.zeros((2, 2))), "rows of points in space"),
        (lambda: chordal.shapes.surface(np.zeros((2, 2, 3))), "control points"),
        (lambda: chordal.shapes.surface(np.zeros((2, 2, 3)), degrees=(1,)), "two of them"),
        (lambda: chordal.shapes.surface(np.zeros((2, 2, 3)), weights=[1, 1], degrees=(1, 1)), "one for each control point"),
        (lambda: chordal.shapes.fit([(0, 0), (1, 1)], 0), "tolerance"),
        (lambda: chordal.shapes.fit(np.zeros(3), 1), "rows of 2 or 3"),
    ],
)
def test_what_is_no_path_is_a_sentence(make: Any, part: str) -> None:
    with pytest.raises(ValueError, match=part):
        make()
