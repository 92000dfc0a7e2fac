"""`within=`: a field whose proof goes on and on is returned after that time, with what is known of it."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import chordal

BOX = ((-1.25, -1.25, -1.25), (1.25, 1.25, 1.25))


def ball(points: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    return np.asarray(np.linalg.norm(points, axis=1) - 1, dtype=np.float64)


def test_time_that_ends_leaves_a_measured_mesh_and_the_places_without_a_proof() -> None:
    # A Lipschitz constant alone proves by values on pieces as small as the length: that takes minutes, and its mesh a second.
    field = chordal.field(ball, bounds=BOX, lipschitz=1)
    stages: set[str] = set()
    words: dict[str, Any] = {"tol": 5e-4, "effort": "best", "progress": lambda stage, *_: stages.add(stage)}
    try:
        mesh = field.mesh(**words, within="3s")
    except chordal.BudgetUnmet as unmet:
        # Whether the length is reached by then depends on the machine.
        mesh = unmet.best
    assert mesh.bound.evidence == "measured" and mesh.bound.at_most is None
    assert (mesh.bound.samples or 0) > 0 and mesh.bound.at_least < 0.1
    assert mesh.is_watertight and len(mesh.faces) > 12
    certificate = mesh.report["certificate"]
    assert any('effort="best" continues the proof' in note for note in certificate["notes"])
    if "prove" in stages:
        places = certificate["bound"]["open"]
        assert places["count"] > 0 and places["area"] > 0 and places["largest"]


def test_a_proof_that_ends_sooner_is_one() -> None:
    part = chordal.shapes.box(4, 4, 2) - chordal.shapes.sphere(1.2).move(0, 0, 1)
    several: list[dict[str, Any]] = [{"within": 600}, {"within": np.float64(600)}, {"within": "10m"}, {"effort": "best"}]
    for words in several:
        mesh = part.mesh(tol=0.01, **words)
        assert mesh.bound.evidence == "proved" and mesh.bound.is_within(0.01)


def test_times_that_are_none_are_refused() -> None:
    part: Any = chordal.shapes.sphere(1)
    for time in (0, -1.5, "5", "soon", "0s", float("nan"), float("inf")):
        with pytest.raises(chordal.BudgetError, match="within: a "):
            part.mesh(tol=0.1, within=time)
    for wrong in (True, [20]):
        with pytest.raises(TypeError, match="within: a number"):
            part.mesh(tol=0.1, within=wrong)
    with pytest.raises(TypeError, match="within="):
        part.mesh(tol=0.1, timeout=5)
    with pytest.raises(ValueError, match="effort: 'best' or 'fast', not 'most'"):
        part.mesh(tol=0.1, effort="most")
