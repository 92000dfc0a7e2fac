"""Occupancies: functions that are flat beside their surface, meshed within lengths from coarse to fine."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest

import chordal

LENGTHS = (0.01, 0.02, 0.05, 0.1)
#: The balls' centres, and how sharply the function goes from 0 to 1.
PLACES, RADIUS, SHARPNESS = ((-0.5, 0, 0), (0.5, 0, 0)), 0.8, 40


def outside(points: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """The distance to two balls, as it is outside of them."""
    return np.asarray(np.min([np.linalg.norm(points - place, axis=1) for place in PLACES], axis=0) - RADIUS, np.float64)


def occupancy(points: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    return np.asarray(0.5 - 0.5 * np.tanh(0.5 * SHARPNESS * outside(points)), np.float64)


@pytest.mark.parametrize("side", [1.5, 4.0])
def test_an_occupancy_is_met_within_every_length_and_longer_ones_take_no_more(side: float) -> None:
    field = chordal.field(occupancy, bounds=((-side,) * 3, (side,) * 3), iso=0.5, inside="high")
    counts = []
    for length in LENGTHS:
        # What is not met raises.
        mesh = field.mesh(tol=length)
        assert mesh.bound.evidence == "measured" and mesh.bound.at_least <= length
        assert mesh.is_watertight
        # By the distance itself, which the library is not told of.
        assert np.abs(outside(mesh.vertices)).max() <= length
        counts.append(len(mesh.faces))
    assert counts == sorted(counts, reverse=True), counts
