"""`bezier`, `flatten` and `Polylines`: the same points as the command's, within the bound."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import ROOT, TEAPOT, Command
from numpy.typing import NDArray

import chordal

ARCH = np.array([[0, 0], [0, 1], [1, 1], [1, 0]], dtype=np.float64)
SEED = 20_260_101
DRAWING = ROOT / "examples" / "drawing.svg"


def at(control: NDArray[np.float64], t: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
    """Points of a cubic, by Bernstein's polynomials: nothing of this is Chordal's."""
    t = t[:, None]
    basis = ((1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t**2 * (1 - t), t**3)
    return sum((b * p for b, p in zip(basis, control, strict=True)), start=np.zeros((len(t), control.shape[1])))


def distance(points: NDArray[np.float64], line: NDArray[np.float64]) -> NDArray[np.float64]:
    """From each point to a polyline."""
    a, d = line[:-1], np.diff(line, axis=0)
    squares = np.maximum((d * d).sum(axis=1), np.finfo(float).tiny)
    t = np.clip(((points[:, None] - a) * d).sum(axis=2) / squares, 0, 1)
    found: NDArray[np.float64] = np.linalg.norm(points[:, None] - (a + t[..., None] * d), axis=2).min(axis=1)
    return found


@pytest.mark.parametrize("n_coordinates", [2, 3])
@pytest.mark.parametrize("spacing", ["fewest", "even"])
@pytest.mark.parametrize("budget", [{"tol": 0.01}, {"rel": 0.001}, {"segments": 400}])
def test_no_point_of_a_curve_is_farther_away_than_the_bound(
    n_coordinates: int, spacing: Any, budget: dict[str, Any]
) -> None:
    control = np.random.default_rng(SEED).uniform(-1, 1, (40, 4, n_coordinates))
    lines = chordal.shapes.bezier(control).flatten(spacing=spacing, **budget)
    bound = lines.bound
    assert bound.at_most is not None and bound.evidence == "proved" and bound.reference == "curves"
    assert bound.at_most <= budget.get("tol", np.inf)
    found = [distance(at(c, np.linspace(0, 1, 500)), s.points).max() for c, s in zip(control, lines, strict=True)]
    assert 0.99 * bound.at_least <= max(found) <= bound.at_most, f"seed {SEED}"


@pytest.mark.parametrize("spacing", ["fewest", "even"])
def test_points_lie_at_their_places(spacing: Any) -> None:
    lines = chordal.shapes.bezier(ARCH).flatten(tol=1e-4, spacing=spacing)
    assert np.allclose(lines.points, at(ARCH, lines.places), rtol=0, atol=1e-15)
    assert (np.diff(lines.places) > 0).all() and lines.places[[0, -1]].tolist() == [0, 1]
    assert lines.starts.tolist() == [0, len(lines.points)]


def test_even_spacing_with_a_count_is_equal_steps() -> None:
    lines = chordal.shapes.bezier(ARCH).flatten(segments=8, spacing="even")
    assert lines.places.tolist() == [i / 8 for i in range(9)]


def test_a_chain_is_one_polyline_and_a_batch_many() -> None:
    chain = np.concatenate([ARCH, ARCH[1:] + [1, 0]])
    lines = chordal.shapes.bezier(chain).flatten(tol=0.01)
    assert len(lines) == 1 and lines.places[-1] == 2
    assert [1, 0] in lines.points.tolist(), "where pieces join there is a point"
    batch = chordal.shapes.bezier(np.stack([ARCH, ARCH + [1, 0]])).flatten(tol=0.01)
    assert len(batch) == 2
    assert np.array_equal(batch[0].points, chordal.shapes.bezier(ARCH).flatten(tol=0.01).points)
    assert np.array_equal(np.concatenate([line.points for line in batch]), batch.points)


def test_a_curve_in_the_plane_is_that_of_space_at_z_0() -> None:
    flat, space = chordal.shapes.bezier(ARCH), chordal.shapes.bezier(np.pad(ARCH, ((0, 0), (0, 1))))
    view = chordal.View.camera(eye=(0, 0, 5), target=(0, 0, 0), fov_deg=40, size_px=(800, 600))
    budgets: list[dict[str, Any]] = [{"tol": 0.001}, {"pixels": 0.5, "view": view}]
    for budget in budgets:
        a, b = flat.flatten(**budget), space.flatten(**budget)
        assert np.array_equal(a.points, b.points[:, :2]) and (b.points[:, 2] == 0).all()
    assert a.bound.pixels is not None and a.bound.pixels <= 0.5


def test_shares_are_of_the_diagonal_of_the_curve_s_own_box() -> None:
    relative = chordal.shapes.bezier(ARCH).flatten(rel=0.01)
    assert relative.report["certificate"]["budget"]["length"] == pytest.approx(0.01 * np.hypot(1, 0.75))
    assert relative.bound == chordal.shapes.bezier(ARCH).flatten(rel="1%").bound


def test_a_length_in_a_unit_needs_a_curve_in_one() -> None:
    metric = chordal.shapes.bezier(ARCH, unit="cm").flatten(tol="0.1mm")
    assert np.array_equal(metric.points, chordal.shapes.bezier(ARCH).flatten(tol=0.01).points)
    with pytest.raises(chordal.BudgetError, match="give unit="):
        chordal.shapes.bezier(ARCH).flatten(tol="0.1mm")
    with pytest.raises(ValueError, match="unit"):
        chordal.shapes.bezier(ARCH, unit="ell")


def test_polylines_are_a_sequence() -> None:
    lines = chordal.shapes.bezier(np.stack([ARCH, ARCH + 1, ARCH + 2])).flatten(tol=0.1)
    assert [line.source for line in lines] == [0, 1, 2] and not any(line.closed for line in lines)
    assert np.array_equal(lines[-1].points, lines[2].points) and [line.source for line in lines[1:]] == [1, 2]
    assert np.shares_memory(lines[1].points, lines.points) and len(lines[1].places) == len(lines[1].points)
    with pytest.raises(IndexError):
        lines[3]
    with pytest.raises(AttributeError):
        lines[0].closed = True  # type: ignore[misc]


CURVES = [
    np.random.default_rng(SEED).uniform(-10, 10, (50, 4, 2)),
    np.random.default_rng(SEED).uniform(-10, 10, (50, 4, 3)),
    np.random.default_rng(SEED).uniform(-10, 10, (1, 31, 2)),
]


@pytest.mark.parametrize("curves", CURVES)
@pytest.mark.parametrize(
    ("options", "budget"),
    [
        (["--tol", "0.01"], {"tol": 0.01}),
        (["--tol", "0.1%", "--spacing", "even"], {"rel": 0.001, "spacing": "even"}),
        (["--segments", "700"], {"segments": 700}),
        (["--px", "1", "--view", "800x600 fov=45 dist=30"], {"pixels": 1, "view": "800x600 fov=45 dist=30"}),
    ],
)
def test_the_points_are_those_of_the_command_bit_for_bit(
    cargo_chordal: Command, curves: NDArray[np.float64], options: list[str], budget: dict[str, Any]
) -> None:
    text = json.dumps({"curves": [{"control": curve.tolist()} for curve in curves]})
    done = cargo_chordal(
        "mesh", "-", "--from", "json", *options, "-o", "-", "--to", "json", "-q", stdin=text.encode()
    )
    assert done.returncode == 0, done.stderr
    theirs = json.loads(done.stdout)
    ours = chordal.shapes.bezier(curves if curves.shape[1] == 4 else curves[0]).flatten(**budget)
    assert np.array_equal(ours.points, np.concatenate([line["points"] for line in theirs["polylines"]]))
    assert [len(line.points) for line in ours] == [len(line["points"]) for line in theirs["polylines"]]
    certificate, other = ours.report["certificate"], theirs["report"]["certificate"]
    for part in ("budget", "bound", "output", "frame", "notes"):
        assert certificate[part] == other[part]


@pytest.mark.parametrize("extension", ["json", "svg"])
def test_a_drawing_is_cut_as_the_command_cuts_it(cargo_chordal: Command, tmp_path: Path, extension: str) -> None:
    theirs, ours = tmp_path / f"theirs.{extension}", tmp_path / f"ours.{extension}"
    done = cargo_chordal("mesh", DRAWING, "--tol", "0.25", "-o", theirs)
    assert done.returncode == 0, done.stderr
    lines = chordal.load(DRAWING).flatten(tol=0.25)
    lines.export(ours)
    assert ours.read_bytes() == theirs.read_bytes() == lines.to_bytes(extension)
    if extension == "json":
        listed = json.loads(theirs.read_text())["polylines"]
        assert len(listed) == len(lines) > 1
        for line, other in zip(lines, listed, strict=True):
            assert line.points.tolist() == other["points"]
            assert (line.closed, line.source) == (other["closed"], other["source"])


def test_shapes_without_curves_are_not_flattened_and_curves_in_space_not_meshed(tmp_path: Path) -> None:
    path = tmp_path / "space.json"
    path.write_text(json.dumps({"curves": [{"control": np.pad(ARCH, ((0, 0), (0, 1))).tolist()}]}))
    with pytest.raises(chordal.Refused, match="flatten") as caught:
        chordal.load(path).mesh(tol=1)
    assert caught.value.code == "unsupported"
    with pytest.raises(chordal.Refused, match="mesh") as caught:
        chordal.load(TEAPOT).flatten(tol=1)
    assert caught.value.code == "unsupported"
    assert len(chordal.load(path).flatten(tol=0.01).points) == 10


def test_a_budget_that_is_not_met_brings_the_best() -> None:
    with pytest.raises(chordal.BudgetUnmet) as caught:
        chordal.shapes.bezier(ARCH).flatten(tol=1e-6, segments=3)
    best = caught.value.best
    assert isinstance(best, chordal.Polylines) and len(best.points) <= 4
    assert best.bound.at_most is not None and best.bound.at_most > 1e-6 and caught.value.bound == best.bound


@pytest.mark.parametrize(
    ("budget", "part"),
    [
        ({}, "segments=5000"),
        ({"segments": 0}, "segments"),
        ({"tol": -1}, "tol"),
        ({"pixels": 1}, "view"),
        ({"tol": 1, "spacing": "odd"}, "spacing: 'fewest' or 'even', not 'odd'"),
    ],
)
def test_a_budget_without_sense_is_a_value_error(budget: dict[str, Any], part: str) -> None:
    with pytest.raises(ValueError, match=part):
        chordal.shapes.bezier(ARCH).flatten(**budget)


def test_curves_without_size_need_a_length_in_units() -> None:
    point = chordal.shapes.bezier(np.ones((4, 3)))
    assert point.flatten(tol=1).points.tolist() == [[1, 1, 1]]
    with pytest.raises(chordal.Refused) as caught:
        point.flatten(rel=0.1)
    assert caught.value.code == "empty"


def test_arrays_are_for_reading_only_and_outlive_their_polyline() -> None:
    lines = chordal.shapes.bezier(ARCH).flatten(tol=0.01)
    arrays = (lines.points, lines.starts, lines.places)
    assert [array.dtype for array in arrays] == [np.float64, np.int64, np.float64]
    del lines
    for array in arrays:
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1
    assert arrays[0][-1].tolist() == [1, 0]


def test_what_is_shown_is_short() -> None:
    curve = chordal.shapes.bezier(np.zeros((3, 4, 2)))
    assert repr(curve) == "<Curve: 3 curves of 1 piece, 2-D>"
    lines = chordal.shapes.bezier(ARCH).flatten(segments=1)
    assert repr(lines).startswith("<Polylines: 1 polyline, 1 segment; between 0.7")
    assert lines._repr_html_().count("<tr>") == 2
