"""Fields: the language of shape scripts in Python, functions of points, and what can be asked of a field."""

from __future__ import annotations

import ast
import contextlib
import inspect
import sys
import threading
import types
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import chordal
from chordal import _chordal, _language

EXAMPLES = sorted((Path(__file__).parents[2] / "examples").glob("*.star"))
POINTS = np.random.default_rng(4).uniform(-3, 3, (500, 3))


def in_python(text: str) -> chordal.Field:
    """What the last expression of a text is after `from chordal.shapes import *`."""
    names: dict[str, object] = {}
    exec("from chordal.shapes import *", names)
    tree = ast.parse(text)
    last = tree.body.pop()
    assert isinstance(last, ast.Expr)
    exec(compile(tree, "script", "exec"), names)
    found = eval(compile(ast.Expression(last.value), "script", "eval"), names)
    assert isinstance(found, chordal.Field)
    return found


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_examples_are_the_same_in_starlark_and_in_python(path: Path) -> None:
    text = path.read_text()
    one, two = chordal.script(text), in_python(text)
    assert one(POINTS).tobytes() == two(POINTS).tobytes()
    assert (one.distance, one.bounds) == (two.distance, two.bounds)


@pytest.mark.parametrize(
    "text",
    [
        "sphere(7 // 2 + 7 % 4 - -7 // 2 + 1 / 3)",
        "field(2 * x - 3 / (y + 1) + abs(z) * -x)",
        "displace(sphere(1), sin(9 * x) * cos(9 * y) / 10, 0.1)",
        "union([rotate_z(move(box(1, 2, 3), 2 * k, 0), 10 * k) for k in range(5)])",
        "twist(stretch(torus(2, 0.5), 1, 2), 30) & plane([1, 1, 1], offset=0.5)",
        "field(maximum(minimum(x, y), atan2(z, x)) - sqrt(x * x) + floor(y) - ceil(z) + exp(x) - log(3))",
        "mirror(capsule((0, 0, 0), [1, 1, 1], 0.3), 1, 0) | repeat(sphere(0.2), x=1, nx=3)",
        "b = box_of(rotate_z(box(1, 2, 3), 30))\nmove(sphere(b['size'][0]), b['max'][0], b['min'][1], b['center'][2])",
    ],
)
def test_texts_are_the_same_in_starlark_and_in_python(text: str) -> None:
    assert chordal.script(text)(POINTS).tobytes() == in_python(text)(POINTS).tobytes()


def declared(usage: str) -> dict[str, object]:
    """The parameters of a usage as in `arc(radius, start=0)`, with their defaults."""
    function = ast.parse(f"def {usage}: ...").body[0]
    assert isinstance(function, ast.FunctionDef)
    names = [argument.arg for argument in function.args.args]
    defaults = [ast.literal_eval(default) for default in function.args.defaults]
    return {**dict.fromkeys(names, inspect.Parameter.empty), **dict(zip(names[len(names) - len(defaults) :], defaults, strict=True))}


def test_every_function_of_the_language_is_there_with_its_arguments() -> None:
    n_by_hand = 0
    for name, usage, _, _ in _chordal.language():
        function = getattr(chordal.shapes, name)
        assert name in chordal.shapes.__all__
        # The others are written from the table. `field` also takes functions of points.
        if name in _language.__all__ or name == "field":
            continue
        taken = inspect.signature(function).parameters.values()
        assert {p.name: p.default for p in taken if p.kind is p.POSITIONAL_OR_KEYWORD} == declared(usage)
        n_by_hand += 1
    assert n_by_hand == 5


def test_what_a_function_does_is_said_in_the_same_words_as_by_the_command() -> None:
    n_same = 0
    for name, _, does, worth in _chordal.language():
        function = getattr(chordal.shapes, name)
        # Paths take arrays, and `field` takes functions of points: of these Python says more.
        if name not in _language.__all__:
            continue
        said = inspect.getdoc(function)
        assert said is not None
        first = " ".join(said.split("\n\n")[0].split())
        assert first.split(". ")[0].rstrip(".") == does.split(". ")[0].rstrip("."), name
        assert not worth or said.endswith(f"\n\nThe value is: {worth}."), name
        n_same += 1
    assert n_same > 50


def test_a_function_of_points_is_called_with_many_at_once() -> None:
    sizes: list[int] = []

    def ball(points: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        sizes.append(len(points))
        assert points.dtype == np.float64
        return np.asarray(np.linalg.norm(points, axis=1) - 1, dtype=np.float64)

    field = chordal.field(ball, bounds=((-1, -1, -1), (1, 1, 1)), lipschitz=1)
    # It was asked for two points, to see that it takes more than one, and for some more, whether it has more than two values;
    # and for some around its box and within, whether it is positive inside.
    assert sizes == [2, 64, 168]
    sizes.clear()
    many = np.zeros((200_000, 3))
    assert (field(many) == -1).all()
    assert min(sizes) >= 1 << 16 or len(sizes) == 1
    assert (field.evidence, field.distance) == ("proved-if", ("lower bound", "lower bound"))
    assert "changes by no more than 1" in field.assumptions[0]
    assert chordal.field(ball).evidence == "measured"
    both = field - chordal.shapes.box(1, 1, 9)
    assert both(np.array([[0, 0, 0], [0.75, 0, 0]])).tolist() == [0.5, -0.25]
    assert np.allclose(field.gradient([[3, 0, 0]]), [[1, 0, 0]], atol=1e-6)


def test_a_function_without_a_slope_is_measured_and_its_calls_are_counted() -> None:
    asked = {"values": 0, "gradients": 0}

    def ball(points: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        asked["values"] += len(points)
        return np.asarray(np.linalg.norm(points, axis=1) - 1, dtype=np.float64)

    def gradient(points: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        asked["gradients"] += len(points)
        return np.asarray(points / np.linalg.norm(points, axis=1)[:, None], dtype=np.float64)

    field = chordal.field(ball, bounds=((-1.25, -1.25, -1.25), (1.25, 1.25, 1.25)), gradient=gradient)
    asked["values"] = 0
    mesh = field.mesh(tol=0.1)
    assert mesh.bound.evidence == "measured"
    assert mesh.bound.at_most is None and mesh.bound.at_least <= 0.1
    assert asked["gradients"] > 0
    assert mesh.report["run"]["evaluations"] == asked["values"] + asked["gradients"]
    assert np.allclose(field.gradient([[3, 0, 0]]), [[1, 0, 0]])
    with pytest.raises(chordal.BudgetUnmet):
        field.mesh(tol=0.1, require="proved")
    with pytest.raises(ValueError, match="require"):
        field.mesh(tol=0.1, require="sure")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="the gradient gave back"):
        chordal.field(ball, gradient=ball).gradient(POINTS)


def test_what_a_function_raises_comes_back_as_it_is() -> None:
    class Mine(Exception):
        pass

    def broken(points: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        raise Mine("no")

    with pytest.raises(Mine, match="no"):
        (chordal.field(broken) | chordal.shapes.sphere(1))(POINTS)
    with pytest.raises(ValueError, match="gave back"):
        chordal.field(lambda points: points)(POINTS)


def test_what_is_wrong_is_said() -> None:
    with pytest.raises(ValueError, match=r"box\(\) needs a number for 'z', not a shape"):
        chordal.shapes.box(1, 2, chordal.shapes.sphere(1))  # type: ignore[call-overload]
    with pytest.raises(TypeError):
        chordal.shapes.sphere(1) | 2  # type: ignore[operator]
    with pytest.raises(chordal.ReadError, match="line 2, column 1"):
        chordal.script("a = 1\nbox(1, 2)")
    with pytest.raises(chordal.ReadError, match="no parameter 'q'"):
        chordal.script("sphere(param('r', 1))", q=2)
    with pytest.raises(ValueError, match="rows of 3"):
        chordal.shapes.sphere(1)([[1, 2]])
    assert chordal.script("sphere(param('r', 1))", r=2)([[0, 0, 0]]).tolist() == [-2]


def test_a_script_whose_last_shape_alone_is_cut_warns_with_its_line() -> None:
    with pytest.warns(UserWarning, match=r"^line 2: '-' binds tighter than '\|'"):
        shape = chordal.script("a, b, c = sphere(1), box(1, 1, 1), sphere(0.5)\na | b - c")
    assert shape([[0, 0, 0]]).tolist() == [-1]


def test_powers_and_functions_of_numpy_are_formulas() -> None:
    x: Any = chordal.shapes.x
    y: Any = chordal.shapes.y
    points = np.array([(-1.5, 0.3, 0.0), (2.0, 1.2, 0.0), (0.7, -3.0, 0.0)])
    a, b = points[:, 0], points[:, 1]
    for made, expected in (
        (x**2, a**2),
        (x**5 - y**0, a**5 - 1),
        (x**-3, a**-3.0),
        (2**y, 2**b),
        ((x * x + 1) ** 0.5, np.sqrt(a * a + 1)),
        (x ** np.int64(3), a**3),
        (np.sin(x) + np.hypot(x, y) * np.float64(2), np.sin(a) + 2 * np.hypot(a, b)),
        (np.maximum(x, y) / np.exp(np.abs(y)), np.maximum(a, b) / np.exp(np.abs(b))),
    ):
        assert np.allclose(made(points), expected, rtol=1e-14)
    with pytest.raises(TypeError):
        x ** True  # noqa: B015


@pytest.mark.parametrize("lipschitz", [None, 1.0])
def test_a_function_that_goes_on_beyond_its_box_is_cut_off_there(lipschitz: float | None) -> None:
    normal = np.array([0.6, 0.64, 0.48])
    half = chordal.field(lambda p: p @ normal - 0.05, bounds=((-1, -1, -1), (1, 1, 1)), lipschitz=lipschitz)
    mesh = half.mesh(tol=0.05)
    assert mesh.is_watertight and np.allclose(mesh.bounds, [[-1] * 3, [1] * 3])
    assert not any("no interior points outside" in sentence for sentence in mesh.bound.assumptions)
    # Smaller boxes go on from there, larger ones change nothing.
    assert np.allclose(half.within((-2, -2, -2), (2, 2, 0)).mesh(tol=0.05).bounds, [[-1, -1, -1], [1, 1, 0]], atol=0.05)
    with pytest.raises(ValueError, match="box: the lowest corner"):
        half.within((2, 2, 2), (3, 3, 3))


@pytest.mark.parametrize("length", [5, 30, 100])
def test_a_function_in_a_long_thin_box_is_found(length: float) -> None:
    def rod(points: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        return np.asarray(np.hypot(points[:, 0], points[:, 1]) - 0.4, dtype=np.float64)

    mesh = chordal.field(rod, bounds=((-0.5, -0.5, 0), (0.5, 0.5, length))).mesh(tol=0.03)
    assert mesh.is_watertight and 0.95 < mesh.volume / (np.pi * 0.16 * length) < 1
    with pytest.raises(chordal.Refused, match="no sample is inside.*tighter bounds"):
        chordal.field(lambda p: rod(p - [3, 2, 0]), bounds=((-200, -200, 0), (200, 200, 1))).mesh(tol=0.03)


@pytest.mark.parametrize("seed", [6, 8])
def test_a_function_with_creases_is_meshed_to_the_length(seed: int) -> None:
    random = np.random.default_rng(seed)
    n = random.integers(1, 9)
    centres, radii = random.uniform(-0.85, 0.85, (n, 3)), random.uniform(0.1, 0.45, n)

    def balls(points: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        away: npt.NDArray[np.float64] = np.linalg.norm(points[:, None] - centres, axis=2) - radii
        return np.asarray(away.min(axis=1), dtype=np.float64)

    mesh = chordal.field(balls, bounds=((-1.4,) * 3, (1.4,) * 3)).mesh(tol=0.02)
    assert mesh.is_watertight and 0 < mesh.bound.at_least <= 0.02
    shares = random.dirichlet([1, 1, 1], (len(mesh.faces), 20))
    points = np.einsum("fsk,fkd->fsd", shares, np.asarray(mesh.vertices)[np.asarray(mesh.faces)]).reshape(-1, 3)
    # The function is no larger than the distance. One point in ten thousand may be at a crease between the samples.
    assert np.mean(np.abs(balls(points)) > 0.02) < 1e-4


def test_last_digits_that_other_points_of_a_call_change_do_not_tear_a_surface() -> None:
    random, lock = np.random.default_rng(5), threading.Lock()

    def ball(points: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        with lock:
            noise = 1e-7 * random.standard_normal(len(points))
        # Zero, but for that, at many corners of cells.
        box: npt.NDArray[np.float64] = np.abs(points).max(axis=1) - 0.5 + noise
        return box

    assert chordal.field(ball, bounds=((-1, -1, -1), (1, 1, 1))).mesh(tol=0.05).is_watertight


def test_a_function_of_tensors_is_told_how_it_gets_them(monkeypatch: pytest.MonkeyPatch) -> None:
    class Tensor:
        def norm(self, dim: int) -> Any:
            return self

        def detach(self) -> Any:
            return self

        def __sub__(self, other: float) -> Any:
            return self

    torch: Any = types.ModuleType("torch")
    torch.float32, torch.as_tensor, torch.no_grad = "f4", lambda points, dtype: Tensor(), contextlib.nullcontext
    monkeypatch.setitem(sys.modules, "torch", torch)
    with pytest.raises(TypeError, match=r"like=torch\.empty\(0\)"):
        chordal.field(lambda points: points.norm(dim=-1) - 1)
    # What fails with tensors, too, is what it is where it is used.
    wrong = chordal.field(lambda points: points.nrom(dim=-1) - 1, bounds=((-1, -1, -1), (1, 1, 1)))
    with pytest.raises(AttributeError, match="nrom"):
        wrong.mesh(tol=0.1)


def test_what_formulas_have_not_is_said() -> None:
    shapes: Any = chordal.shapes
    x = shapes.x
    there = "they have acos, .* and"
    for call, said in (
        (lambda: np.tanh(x), r"no tanh; here it is 1 - 2 / \(exp"),
        (lambda: np.sign(x), "no sign; "),
        (lambda: np.mod(x, 2), r"no remainder; here it is x - n \* floor"),
        (lambda: np.cbrt(x), "no cbrt; "),
        (lambda: np.where(x, 1, 0), "no where; here it is minimum and maximum; "),
        (lambda: np.clip(x, 0, 1), r"no clip; here it is minimum\(maximum"),
        (lambda: np.add.reduce(x), r"no add.reduce; "),
    ):
        with pytest.raises(TypeError, match=f"formulas have {said}.*{there}"):
            call()
    with pytest.raises(TypeError, match="a formula and an array are no formula"):
        np.ones(3) * x
    with pytest.raises(TypeError, match="a formula has no truth value"):
        bool(x)
    with pytest.raises(TypeError, match="a formula has no truth value"):
        shapes.check(x, "never")
    assert x == x and len({x, shapes.y}) == 2


def test_an_occupancy_is_no_distance() -> None:
    box = ((-2, -2, -2), (2, 2, 2))
    with pytest.raises(TypeError, match="truth values; .* samples on a lattice"):
        chordal.field(lambda p: np.linalg.norm(p, axis=1) < 1.5, bounds=box)
    with pytest.warns(UserWarning, match="two values alone, as it seems; .*chordal.volume"):
        chordal.field(lambda p: np.where(np.linalg.norm(p, axis=1) < 1.5, -1.0, 1.0), bounds=box)


BOX = ((-1.3, -1.3, -1.3), (1.3, 1.3, 1.3))


def test_a_function_says_where_its_surface_is_and_which_side_is_inside() -> None:
    def hill(points: Any) -> Any:
        return 5 - 2 * np.linalg.norm(points, axis=1)

    def slope(points: Any) -> Any:
        return -2 * points / np.linalg.norm(points, axis=1, keepdims=True)

    ball = chordal.field(hill, bounds=BOX, iso=3, inside="high")
    assert np.allclose(ball(POINTS), 2 * np.linalg.norm(POINTS, axis=1) - 2)
    assert ball.mesh(tol=0.3).volume == pytest.approx(4 / 3 * np.pi, rel=0.4)
    sloped = chordal.field(hill, bounds=BOX, gradient=slope, lipschitz=2, iso=3, inside="high")
    assert np.allclose(sloped.gradient(POINTS), -slope(POINTS))
    assert sloped.evidence == "proved-if"
    x, y, z = chordal.shapes.x, chordal.shapes.y, chordal.shapes.z
    for formula, words in ((x * x + y * y + z * z, {"iso": 4}), (7 - x * x - y * y - z * z, {"iso": 3, "inside": "high"})):
        two = chordal.field(formula, **words)
        assert two([[2, 0, 0], [0, 1, 0]]).tolist() == [0, -3]
    with pytest.raises(ValueError, match="inside: 'low' or 'high', not 'out'"):
        chordal.field(hill, inside="out")  # type: ignore[arg-type]
    with pytest.raises(chordal.BudgetError, match="iso: a finite number"):
        chordal.field(hill, iso=float("nan"))


def test_a_function_that_is_positive_inside_is_warned_of() -> None:
    def hill(points: Any) -> Any:
        return 1 - np.linalg.norm(points, axis=1)

    with pytest.warns(UserWarning, match="negative all around its bounds and positive within.*inside='high'"):
        chordal.field(hill, bounds=BOX)
    # What is said is not warned of, and nor is what reaches its box, is in it, or fills it.
    chordal.field(hill, bounds=BOX, inside="high")
    chordal.field(lambda p: -hill(p), bounds=BOX)
    chordal.field(lambda p: p[:, 2], bounds=BOX)
    chordal.field(lambda p: -1 - p[:, 0] ** 2, bounds=BOX)
