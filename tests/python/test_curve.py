"""`bezier`, `Curve.flatten` and `Polyline`."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import chordal

ARCH = np.array([[0, 0], [0, 1], [1, 1], [1, 0]], dtype=np.float64)
SEED = 20_260_101


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
    lines = chordal.bezier(control).flatten(spacing=spacing, **budget)
    bound = lines.bound
    assert bound.at_most is not None and bound.evidence == "proved" and bound.reference == "curves"
    assert bound.at_most <= budget.get("tol", np.inf)
    found = [distance(at(c, np.linspace(0, 1, 500)), s).max() for c, s in zip(control, lines.strands, strict=True)]
    assert 0.99 * bound.at_least <= max(found) <= bound.at_most, f"seed {SEED}"


@pytest.mark.parametrize("spacing", ["fewest", "even"])
def test_points_lie_at_their_places(spacing: Any) -> None:
    lines = chordal.bezier(ARCH).flatten(tol=1e-4, spacing=spacing)
    assert np.allclose(lines.points, at(ARCH, lines.places), rtol=0, atol=1e-15)
    assert (np.diff(lines.places) > 0).all() and lines.places[[0, -1]].tolist() == [0, 1]
    assert lines.starts.tolist() == [0, len(lines.points)]


def test_even_spacing_with_a_count_is_equal_steps() -> None:
    lines = chordal.bezier(ARCH).flatten(segments=8, spacing="even")
    assert lines.places.tolist() == [i / 8 for i in range(9)]


def test_a_chain_is_one_polyline_and_a_batch_many() -> None:
    chain = np.concatenate([ARCH, ARCH[1:] + [1, 0]])
    lines = chordal.bezier(chain).flatten(tol=0.01)
    assert len(lines.strands) == 1 and lines.places[-1] == 2
    assert [1, 0] in lines.points.tolist(), "where pieces join there is a point"
    batch = chordal.bezier(np.stack([ARCH, ARCH + [1, 0]])).flatten(tol=0.01)
    assert len(batch.strands) == 2
    assert np.array_equal(batch.strands[0], chordal.bezier(ARCH).flatten(tol=0.01).points)
    assert np.array_equal(np.concatenate(batch.strands), batch.points)


def test_a_curve_in_the_plane_is_that_of_space_at_z_0() -> None:
    flat, space = chordal.bezier(ARCH), chordal.bezier(np.pad(ARCH, ((0, 0), (0, 1))))
    view = chordal.View.camera(eye=(0, 0, 5), target=(0, 0, 0), fov_deg=40, size_px=(800, 600))
    budgets: list[dict[str, Any]] = [{"tol": 0.001}, {"pixels": 0.5, "view": view}]
    for budget in budgets:
        a, b = flat.flatten(**budget), space.flatten(**budget)
        assert np.array_equal(a.points, b.points[:, :2]) and (b.points[:, 2] == 0).all()
    assert a.bound.pixels is not None and a.bound.pixels <= 0.5


def test_shares_are_of_the_diagonal_of_the_curve_s_own_box() -> None:
    relative = chordal.bezier(ARCH).flatten(rel=0.01)
    assert relative.report["budget"]["length"] == pytest.approx(0.01 * np.hypot(1, 0.75))
    assert relative.bound == chordal.bezier(ARCH).flatten(rel="1%").bound


def test_a_length_in_a_unit_needs_a_curve_in_one() -> None:
    metric = chordal.bezier(ARCH, unit="cm").flatten(tol="0.1mm")
    assert np.array_equal(metric.points, chordal.bezier(ARCH).flatten(tol=0.01).points)
    with pytest.raises(chordal.BudgetError, match="give unit="):
        chordal.bezier(ARCH).flatten(tol="0.1mm")
    with pytest.raises(ValueError, match="unit"):
        chordal.bezier(ARCH, unit="ell")


def test_a_budget_that_is_not_met_brings_the_best() -> None:
    with pytest.raises(chordal.BudgetUnmet) as caught:
        chordal.bezier(ARCH).flatten(tol=1e-6, segments=3)
    best = caught.value.best
    assert isinstance(best, chordal.Polyline) and len(best.points) <= 4
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
        chordal.bezier(ARCH).flatten(**budget)


def test_curves_without_size_need_a_length_in_units() -> None:
    point = chordal.bezier(np.ones((4, 3)))
    assert point.flatten(tol=1).points.tolist() == [[1, 1, 1]]
    with pytest.raises(chordal.Refused) as caught:
        point.flatten(rel=0.1)
    assert caught.value.code == "empty"


def test_arrays_are_for_reading_only_and_outlive_their_polyline() -> None:
    lines = chordal.bezier(ARCH).flatten(tol=0.01)
    arrays = (lines.points, lines.starts, lines.places)
    assert [array.dtype for array in arrays] == [np.float64, np.int64, np.float64]
    del lines
    for array in arrays:
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1
    assert arrays[0][-1].tolist() == [1, 0]


def test_what_is_shown_is_short() -> None:
    curve = chordal.bezier(np.zeros((3, 4, 2)))
    assert repr(curve) == "<Curve: 3 curves of 1 piece, 2-D>"
    lines = chordal.bezier(ARCH).flatten(segments=1)
    assert repr(lines).startswith("<Polyline: 1 segment; between 0.7")
    assert lines._repr_html_().count("<tr>") == 2
