"""The lesson's examples in Python run, and do what its text says."""

import io
from collections.abc import Callable
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any

import numpy as np
import pytest

ROOT = Path(__file__).parents[2]
CODE = ROOT / "studio" / "src" / "lesson" / "code"


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch) -> Callable[[str], tuple[dict[str, Any], str]]:
    """Runs an example beside the files of examples/; returns its names and its output."""
    monkeypatch.chdir(ROOT / "examples")

    def run(name: str) -> tuple[dict[str, Any], str]:
        names: dict[str, Any] = {}
        said = io.StringIO()
        with redirect_stdout(said):
            exec(compile((CODE / f"{name}.py").read_text(), name, "exec"), names)
        return names, said.getvalue()

    return run


@pytest.mark.parametrize("name", sorted(path.stem for path in CODE.glob("*.py")))
def test_runs(run: Callable[[str], tuple[dict[str, Any], str]], name: str) -> None:
    run(name)


def test_does_what_the_text_says(run: Callable[[str], tuple[dict[str, Any], str]]) -> None:
    inside = run("inside")[0]["inside"]
    assert inside((0, 0), (1, 0), (0, 1), (0.2, 0.2)) and inside((0, 0), (0, 1), (1, 0), (0.2, 0.2))
    assert not inside((0, 0), (1, 0), (0, 1), (1, 1))
    weights, value = run("blend")[0]["blend"]([(0, 0), (1, 0), (0, 1)], [0, 4, 8], (0.25, 0.25))
    assert sum(weights) == pytest.approx(1) and value == pytest.approx(3)
    assert list(run("normal")[0]["normal"]((0, 0, 0), (2, 0, 0), (0, 2, 0))) == [0, 0, 1]
    has_inside = run("check")[0]["has_inside"]
    tetrahedron = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]
    assert has_inside(tetrahedron) and not has_inside(tetrahedron[1:])
    assert not has_inside([(0, 1, 2), *tetrahedron[1:]])
    assert run("casteljau")[0]["casteljau"]([(0, 0), (0, 4), (4, 4), (4, 0)], 0.5) == [2, 3]
    names, said = run("fan")
    assert names["fan"](3) == [(0, 1, 2)] and len(names["fan"](6)) == 4
    # The corner that points inwards, the last one, is on both triangles.
    ears = [[int(word) for word in line.strip(" []").split()] for line in said.splitlines()]
    assert len(ears) == 2 and all(3 in face for face in ears)
    corners = np.array([(1.0, 0, 0), (0, 1, 0), (0, 0, 1), (0, 0, 0)])
    normals = run("normals")[0]["smooth"](corners, np.array([(3, 1, 0), (3, 2, 1), (3, 0, 2), (0, 1, 2)]))
    assert normals[3] == pytest.approx([-(3**-0.5)] * 3) and np.linalg.norm(normals, axis=1) == pytest.approx(np.ones(4))
    names, _ = run("patch")
    assert names["patch"](names["spout"], 1, 0) == pytest.approx(names["spout"][0, 3])
    # Points in equal steps, so that u and v are places.
    net = np.array([[(j, i, i * j) for j in range(4)] for i in range(4)])
    assert names["patch"](net, 0.5, 1 / 3) == pytest.approx([1.5, 1, 1.5])
    back, both = [float(line.split()[-1]) for line in run("baking")[1].splitlines()[1:]]
    assert 0 < back < both < 1  # of a teapot 6.4 wide
    ball = run("field")[0]["ball"]
    distance, _ = run("trace")[0]["trace"](lambda p: float(ball([p])[0]), (-3, 0.5, 0), (1, 0, 0))
    assert distance == pytest.approx(3 - 0.75**0.5, abs=0.01)
    assert "watertight: True" in run("csg")[1]
    counts = [int(line.split()[0]) for line in run("budget")[1].splitlines()]
    assert all(1.5 < finer / coarser < 2.2 for coarser, finer in zip(counts, counts[1:], strict=False))
    gaps = [float(line.split()[-3]) for line in run("segments")[1].splitlines()]
    assert all(coarser / finer == pytest.approx(4, rel=0.05) for coarser, finer in zip(gaps, gaps[1:], strict=False))
