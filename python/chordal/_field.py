"""`Field` and `Formula`: shapes as functions of a point, and what can be asked of them."""

from __future__ import annotations

import math
import operator
import warnings
from collections.abc import Callable, Sequence
from numbers import Real
from typing import TYPE_CHECKING, Any, Literal, NoReturn, SupportsFloat

from chordal import _chordal
from chordal._arguments import number
from chordal._arguments import text as _text
from chordal._arrays import coordinates
from chordal._curve import Curve
from chordal._devices import parameter_of
from chordal._functions import Sided, of_bytes, try_at_points, warn_of_complement
from chordal._hints import keywords_hinted, refuse_own
from chordal._recipe import Recipe, Remakeable
from chordal._shape import Shape
from chordal._table import table

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    from chordal._mesh import Mesh

#: The lowest and the highest corner of a box.
Box = tuple[tuple[float, float, float], tuple[float, float, float]]


def _value(value: Any) -> Any:
    """What the compiled part knows of a value, or of those in a list."""
    if isinstance(value, (Field, Formula)):
        return value._value
    if isinstance(value, Curve):
        return value._source
    if isinstance(value, Shape):
        raise ValueError(f"a field is needed, not a {type(value).__name__}: {_field_by(value)}")
    if hasattr(value, "__array_interface__"):
        return value.tolist()
    if isinstance(value, (list, tuple)):
        return [_value(item) for item in value]
    return value


def called(name: str, *args: Any, **named: Any) -> Any:
    """What a function of the language makes of these arguments."""
    made = _chordal.ScriptValue.call(name, *map(_value, args), **{key: _value(arg) for key, arg in named.items()})
    return _made(made, (called, (name, *args), named))


def _made(made: _chordal.ScriptValue | float, recipe: Recipe) -> Any:
    if isinstance(made, float):
        return made
    return Field(made, None, recipe) if made.is_shape else Formula(made, recipe)


def _operated(word: str, a: Any, b: Any) -> Any:
    made = _chordal.ScriptValue.operate(word, _value(a), _value(b))
    return NotImplemented if made is None else _made(made, (_operated, (word, a, b), {}))


def coordinate(k: int) -> Formula:
    """The coordinate of that number."""
    return Formula(_chordal.ScriptValue.axis(k), (coordinate, (k,), {}))


def field_of_mesh(mesh: Mesh) -> Field:
    """The signed distance to triangles."""
    value, source = _chordal.mesh_field(mesh._source)
    return Field(value, source, (field_of_mesh, (mesh,), {}))


def _points(points: ArrayLike) -> NDArray[np.float64]:
    found = coordinates("points", points)
    if found.ndim == 0 or found.shape[-1] != 3:
        raise ValueError(f"points: rows of 3, as in (n, 3), not {found.shape}")
    return found


def _values(value: _chordal.ScriptValue, points: ArrayLike) -> NDArray[np.float64]:
    import numpy as np

    found = _points(points)
    return np.frombuffer(value.values(found.tobytes())).reshape(found.shape[:-1])


class Formula(Remakeable):
    """A number for every point, made of the coordinates `x`, `y` and `z`. `field` makes a shape of it.

    >>> from chordal.shapes import field, x, y, z
    >>> bowl = field(x * x + y * y - z)
    >>> bowl([[0, 0, 1], [1, 1, 1]])
    array([-1.,  1.])
    """

    __slots__ = ("_recipe", "_value")

    def __init__(self, value: _chordal.ScriptValue, recipe: Recipe | None = None) -> None:
        refuse_own(self, value, _chordal.ScriptValue)
        self._value = value
        self._recipe = recipe

    def __call__(self, points: ArrayLike) -> NDArray[np.float64]:
        """The values at points, whose last axis is 3 long."""
        return _values(self._value, points)

    def __add__(self, other: Formula | float) -> Formula:
        return _operated("+", self, other)  # type: ignore[no-any-return]

    def __radd__(self, other: float) -> Formula:
        return _operated("+", other, self)  # type: ignore[no-any-return]

    def __sub__(self, other: Formula | float) -> Formula:
        return _operated("-", self, other)  # type: ignore[no-any-return]

    def __rsub__(self, other: float) -> Formula:
        return _operated("-", other, self)  # type: ignore[no-any-return]

    def __mul__(self, other: Formula | float) -> Formula:
        return _operated("*", self, other)  # type: ignore[no-any-return]

    def __rmul__(self, other: float) -> Formula:
        return _operated("*", other, self)  # type: ignore[no-any-return]

    def __truediv__(self, other: Formula | float) -> Formula:
        return _operated("/", self, other)  # type: ignore[no-any-return]

    def __rtruediv__(self, other: float) -> Formula:
        return _operated("/", other, self)  # type: ignore[no-any-return]

    def __neg__(self) -> Formula:
        return _operated("neg", self, self)  # type: ignore[no-any-return]

    def __pos__(self) -> Formula:
        return self

    def __pow__(self, exponent: float) -> Formula:
        """A whole power from 1 on by multiplication, 0.5 as the square root; others are exp and log, for positive values."""
        from chordal import _formulas

        if isinstance(exponent, bool) or not isinstance(exponent, Real):
            return NotImplemented
        exponent = float(exponent)
        if exponent == 0:
            return self * 0 + 1
        if exponent == 0.5:
            return _formulas.sqrt(self)
        if exponent.is_integer() and 1 <= abs(exponent) <= _LARGEST_POWER:
            power = _power(self, abs(int(exponent)))
            return power if exponent > 0 else 1 / power
        return _formulas.exp(exponent * _formulas.log(self))

    def __rpow__(self, base: float) -> Formula:
        """A positive number to the power of a formula."""
        from chordal import _formulas

        if isinstance(base, bool) or not isinstance(base, Real):
            return NotImplemented
        return _formulas.exp(self * math.log(float(base)))

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **named: Any) -> Any:
        """What numpy's functions make of a formula, as in `numpy.sin(x)`."""
        import numpy as np

        if not all(isinstance(one, (Formula, Real, np.ndarray)) for one in inputs):
            return NotImplemented
        name = _UFUNCS.get(ufunc.__name__)
        if method != "__call__" or named or name is None:
            raise _no_function(ufunc.__name__ if method == "__call__" else f"{ufunc.__name__}.{method}")
        if any(getattr(one, "ndim", 0) for one in inputs):
            raise TypeError("a formula and an array are no formula: a formula is called with points, as in x(points)")
        # numpy's numbers as Python's own, so that they do not ask here again.
        own = [one if isinstance(one, Formula) else float(one) for one in inputs]
        return name(*own)

    def __array_function__(self, function: Any, types: Any, args: Any, named: Any) -> Any:
        """Refuses numpy's other functions, which would take a formula for an object without numbers."""
        raise _no_function(function.__name__)

    def __bool__(self) -> bool:
        """Refused: it is a number for every point."""
        raise TypeError(
            "a formula has no truth value, for it is a number for every point: minimum and maximum of chordal.shapes choose"
        )

    def __lt__(self, other: object) -> NoReturn:
        """Refused: what is below a number is a field, and no condition."""
        raise TypeError("a formula is not compared: field(x - 1) is the shape where x - 1 is below 0, and so x < 1")

    def __le__(self, other: object) -> NoReturn:
        """Refused, as `<`."""
        self.__lt__(other)

    def __gt__(self, other: object) -> NoReturn:
        """Refused, as `<`."""
        self.__lt__(other)

    def __ge__(self, other: object) -> NoReturn:
        """Refused, as `<`."""
        self.__lt__(other)

    def __abs__(self) -> Formula:
        return _operated("abs", self, self)  # type: ignore[no-any-return]

    def __repr__(self) -> str:
        return f"<Formula: {self._value.terms} terms>"


class Field(Shape):
    """A shape as a function: a number for every point, negative inside. `|`, `&` and `-` combine shapes.

    >>> from chordal.shapes import box, cylinder
    >>> block = box(2, 2, 1) - cylinder(0.4, 2)
    >>> block([[0, 0, 0], [0.75, 0, 0]])
    array([ 0.4 , -0.25])
    >>> block.distance
    ('lower bound', 'exact distance')
    """

    __slots__ = ("_uncut", "_value")

    def __init__(
        self,
        value: _chordal.ScriptValue,
        source: _chordal.Source | None = None,
        recipe: Recipe | None = None,
        uncut: _chordal.ScriptValue | None = None,
    ) -> None:
        refuse_own(self, value, _chordal.ScriptValue)
        super().__init__(value.source(None) if source is None else source, recipe)
        self._value = value
        # What is cut off at a box; of a function without the box that is said to hold it, so that it is cut there.
        self._uncut = value if uncut is None else uncut

    def __call__(self, points: ArrayLike) -> NDArray[np.float64]:
        """The values at points, whose last axis is 3 long: negative inside, NaN where there is none."""
        return _values(self._value, points)

    def gradient(self, points: ArrayLike) -> NDArray[np.float64]:
        """The gradients at points, in the shape of the points; at a kink that of one side."""
        import numpy as np

        found = _points(points)
        return np.frombuffer(self._value.gradients(found.tobytes())).reshape(found.shape)

    @property
    def distance(self) -> tuple[str, str]:
        """What the value is worth as a distance outside and inside: "exact distance", "lower bound" or "sign"."""
        return self._value.distance

    @property
    def evidence(self) -> str:
        """What proofs about it are worth: "proved", "proved-if" or "measured"."""
        return self._value.evidence[0]

    @property
    def assumptions(self) -> tuple[str, ...]:
        """What proofs about it assume, in sentences."""
        return tuple(self._value.evidence[1])

    @property
    def notes(self) -> tuple[str, ...]:
        """What was said of what it is made of, in sentences: how far the polygons are off that stand for curves.

        >>> import chordal
        >>> disc = chordal.shapes.polygon(chordal.shapes.arc(1), tolerance=0.01)
        >>> disc.notes[0].endswith("(proved)")
        True
        """
        return tuple(self._value.notes)

    @property
    def bounds(self) -> Box:
        """The lowest and highest corner of a box that holds the shape; infinite where none is known."""
        (a, b, c), (d, e, f) = self._value.bounds
        return (a, b, c), (d, e, f)

    def within(self, low: Sequence[SupportsFloat], high: Sequence[SupportsFloat]) -> Field:
        """The same shape, cut off at a box for whatever is made of it."""
        least, most = _box("box", (low, high))
        known = _chordal.region_of(self._source)
        if known is not None:
            least = [max(a, b) for a, b in zip(least, known[0], strict=True)]
            most = [min(a, b) for a, b in zip(most, known[1], strict=True)]
        cut = self._uncut.source(_box("box", (least, most)))
        recipe: Recipe = (Field.within, (self, tuple(map(float, low)), tuple(map(float, high))), {})
        return Field(self._value, cut, recipe, self._uncut)

    def move(self, *by: SupportsFloat | Sequence[SupportsFloat] | NDArray[Any]) -> Field:
        """The shape moved by a vector, or by two or three numbers: `shapes.move`.

        >>> import chordal
        >>> chordal.shapes.sphere(1).move((2, 0, 0))([[2, 0, 0]])
        array([-1.])
        """
        return called("move", self, *_spread(by))  # type: ignore[no-any-return]

    def scale(self, factor: SupportsFloat) -> Field:
        """The shape made larger or smaller, about the origin: `shapes.scale`."""
        return called("scale", self, factor)  # type: ignore[no-any-return]

    def rotate(self, axis: Literal["x", "y", "z"] | Sequence[SupportsFloat] | NDArray[Any], degrees: SupportsFloat) -> Field:
        """The shape turned around an axis through the origin, a letter or a vector: `shapes.rotate`."""
        if isinstance(axis, str):
            if axis not in ("x", "y", "z"):
                raise ValueError(f"axis: x, y, z or a vector, not {axis!r}")
            return called(f"rotate_{axis}", self, degrees)  # type: ignore[no-any-return]
        return called("rotate", self, axis, degrees)  # type: ignore[no-any-return]

    def mirror(self, *normal: SupportsFloat | Sequence[SupportsFloat] | NDArray[Any]) -> Field:
        """The mirror image in the plane through the origin with this normal: `shapes.mirror`."""
        return called("mirror", self, *_spread(normal))  # type: ignore[no-any-return]

    def offset(self, by: SupportsFloat) -> Field:
        """The shape grown by a distance, or shrunk by a negative one: `shapes.offset`.

        Raises `ValueError` where the value is no distance on that side.
        """
        return called("offset", self, by)  # type: ignore[no-any-return]

    def shell(self, thickness: SupportsFloat) -> Field:
        """A wall along the surface, half of its thickness to each side: `shapes.shell`. Raises as `offset`."""
        return called("shell", self, thickness)  # type: ignore[no-any-return]

    def __add__(self, other: object) -> NoReturn:
        """Refused: `|` is both shapes together."""
        raise TypeError("shapes are not added: a | b is both together, a & b what is in both, a - b what is only in a")

    def __radd__(self, other: object) -> NoReturn:
        """Refused, as `+`."""
        self.__add__(other)

    def __or__(self, other: Field) -> Field:  # type: ignore[override]
        _only_fields(other)
        return _operated("|", self, other)  # type: ignore[no-any-return]

    def __and__(self, other: Field) -> Field:  # type: ignore[override]
        _only_fields(other)
        return _operated("&", self, other)  # type: ignore[no-any-return]

    def __sub__(self, other: Field) -> Field:  # type: ignore[override]
        _only_fields(other)
        return _operated("-", self, other)  # type: ignore[no-any-return]

    def _repr_html_(self) -> str:
        outside, inside = self.distance
        box = " to ".join(f"({', '.join(f'{x:.6g}' for x in corner)})" for corner in self.bounds)
        rows = [("outside", outside), ("inside", inside), ("evidence", self.evidence), ("box", box)]
        rows += [("terms", f"{self._value.terms:,}"), *(("assumed", text) for text in self.assumptions)]
        return table("Field", [*rows, *(("note", text) for text in self.notes)])

    def __repr__(self) -> str:
        outside, inside = self.distance
        return f"<Field: outside {outside}, inside {inside}, {self._value.terms} terms>"


def _spread(given: tuple[Any, ...]) -> Sequence[Any]:
    """Numbers, or those of one vector."""
    one = given[0] if len(given) == 1 else given
    parts: Sequence[Any] = one.tolist() if hasattr(one, "tolist") else one
    return parts if isinstance(parts, (list, tuple)) else given


def _only_fields(other: object) -> None:
    if isinstance(other, Shape) and not isinstance(other, Field):
        raise TypeError(f"fields are combined with fields; {_field_by(other)}, and two meshes are combined as triangles")


def _box(name: str, value: Any) -> list[list[float]]:
    import numpy as np

    try:
        rows = np.array(value, dtype=np.float64)
    except (TypeError, ValueError):
        rows = np.zeros(0)
    if rows.shape != (2, 3):
        given = f"numbers of shape {rows.shape}" if rows.size or rows.ndim == 0 else repr(value)
        raise ValueError(f"{name}: a lowest and a highest corner, as in ((-1, -1, -1), (1, 1, 1)), not {given}")
    if not all(rows[0] < rows[1]):
        raise ValueError(f"{name}: the lowest corner is below the highest along x, y and z: {rows.tolist()}")
    found: list[list[float]] = rows.tolist()
    return found


@keywords_hinted
def field(
    what: Formula | float | Callable[[Any], Any],
    *,
    bounds: tuple[Sequence[SupportsFloat], Sequence[SupportsFloat]] | None = None,
    lipschitz: SupportsFloat | None = None,
    gradient: Callable[[Any], Any] | None = None,
    like: Any | None = None,
    iso: SupportsFloat = 0,
    inside: Literal["low", "high"] = "low",
) -> Field:
    """A shape from a formula, or from a function of points.

    A function is called with an array n × 3 of double precision, all points at a time that are asked for at once: from
    one to some hundred thousand. It gives back n numbers: negative inside, NaN outside. `iso` is the value of the surface where
    it is not 0, and `inside` is "high" where values are larger inside, as occupancies and densities are; what comes back has
    its surface at 0 and is negative inside. It is called from other threads.
    What it raises comes back as it is. `bounds` is a box that holds the shape, which is cut off there. With `lipschitz`
    you promise that values of two points differ by no more than that many times their distance, and what is proved is proved under that
    promise; without it a mesh is measured, at samples. `gradient` gives back the derivatives along x, y and z, n × 3;
    without it they come from four values beside each point. `report["run"]["evaluations"]` of a mesh says how many
    points were asked for.

    With `like`, an array of another library, the functions get such arrays instead of numpy's, of its type and on its
    device: a tensor of PyTorch, or an array of JAX, CuPy or whatever knows the array API, padded to a power of two, so that
    JAX compiles for few lengths. A module of PyTorch gets tensors like its parameters without that, and no gradients are
    recorded. Values of single precision are worth no more than that.

    >>> import chordal, numpy
    >>> ball = chordal.field(lambda p: numpy.linalg.norm(p, axis=1) - 1, bounds=((-1, -1, -1), (1, 1, 1)), lipschitz=1)
    >>> ball([[3, 0, 0]]), ball.evidence
    (array([2.]), 'proved-if')
    """
    is_alone = bounds is None and lipschitz is None and gradient is None and like is None
    level, is_high = number("iso", iso), _is_high(inside)
    is_plain = level == 0 and not is_high
    if isinstance(what, Field) and is_alone and is_plain:
        return what
    if isinstance(what, Shape) and not isinstance(what, Field):
        raise TypeError(f"what: a formula or a function of points; {_field_by(what)}")
    if isinstance(what, str):
        raise TypeError("what: a formula or a function of points; chordal.script takes the text of a script")
    if isinstance(what, Formula) or not callable(what):
        if not is_alone:
            raise TypeError("bounds, lipschitz, gradient and like are for functions")
        return called("field", what if is_plain else level - what if is_high else what - level)  # type: ignore[no-any-return]
    slope = None if lipschitz is None else float(lipschitz)
    if slope is not None and not 0 <= slope < float("inf"):
        raise ValueError(f"lipschitz: a number that is not negative, not {slope}")
    if gradient is not None and not callable(gradient):
        raise TypeError("gradient: a function of points")
    if like is None and parameter_of(what) is None:
        try_at_points(what, None if bounds is None else _box("bounds", bounds))
    sided = None if is_plain else Sided(level, is_high)
    values = of_bytes(what, "function", lambda n: ((n,), (n, 1)), like, None if sided is None else sided.value)
    turned = None if sided is None else sided.slope
    slopes = None if gradient is None else of_bytes(gradient, "gradient", lambda n: ((n, 3),), like, turned)
    words = {"bounds": bounds, "lipschitz": lipschitz, "gradient": gradient, "like": like, "iso": level, "inside": inside}
    recipe: Recipe = (field, (what,), words)
    uncut = _chordal.ScriptValue.callable(values, slopes, slope)
    if bounds is None:
        return Field(uncut, None, recipe)
    box = _box("bounds", bounds)
    warn_of_complement(values, box)
    # A network is anything far from what it has learned: what is made of this one alone does not rest on the box.
    return Field(uncut.with_bounds(box), uncut.source(box), recipe, uncut)


def _is_high(inside: str) -> bool:
    if inside not in ("low", "high"):
        raise ValueError(f"inside: 'low' or 'high', not {inside!r}")
    return inside == "high"


def _field_by(shape: Shape) -> str:
    return "this is a Field already" if isinstance(shape, Field) else "to_field() of a mesh is its signed distance"


def script(source: str, **parameters: SupportsFloat) -> Field:
    """The shape of a shape script: a few lines of Starlark, run within limits and without any files.

    Keyword arguments set the script's parameters. Raises `ReadError` with line and column; gives a
    `UserWarning` for a line that is likely to mean something else, as in `a | b - c`.

    >>> import chordal
    >>> chordal.script("box(2, 2, 1) - cylinder(param('r', 0.4), 2)", r=0.5)([[0, 0, 0]])
    array([0.5])
    """
    found = _text("source", source)
    if found is None:
        raise TypeError("source: a text, not None")
    value, _, oddities = _chordal.script(found, [(name, float(value)) for name, value in parameters.items()])
    for line, message in oddities:
        warnings.warn(f"line {line}: {message}", stacklevel=2)
    return Field(value, None, (script, (source,), dict(parameters)))


#: Larger whole powers are rare, and cost a multiplication for each bit.
_LARGEST_POWER = 1024


def _power(base: Formula, exponent: int) -> Formula:
    """By squaring, so that equal factors are shared."""
    made: Formula | None = None
    while exponent:
        if exponent & 1:
            made = base if made is None else made * base
        exponent >>= 1
        if exponent:
            base = base * base
    assert made is not None
    return made


#: What numpy calls otherwise, or what stands for it, by its names.
_INSTEAD: dict[str, str] = {
    "clip": "minimum(maximum(x, low), high)",
    "where": "minimum and maximum",
    "cbrt": "x ** (1 / 3), of what is positive",
    "tanh": "1 - 2 / (exp(2 * x) + 1)",
    "sinh": "(exp(x) - exp(-x)) / 2",
    "cosh": "(exp(x) + exp(-x)) / 2",
    "log2": "log(x) / log(2)",
    "log10": "log(x) / log(10)",
    "exp2": "2 ** x",
    **dict.fromkeys(("remainder", "mod", "fmod"), "x - n * floor(x / n)"),
    **dict.fromkeys(("rint", "round", "around"), "floor(x + 0.5)"),
    **dict.fromkeys(("max", "amax", "fmax"), "maximum(a, b)"),
    **dict.fromkeys(("min", "amin", "fmin"), "minimum(a, b)"),
}


def _no_function(name: str) -> TypeError:
    """What is raised for a function of numpy that formulas have not."""
    way = f"; here it is {_INSTEAD[name]}" if name in _INSTEAD else ""
    return TypeError(f"formulas have no {name}{way}; they have {', '.join(_OF_LANGUAGE)}, abs, +, -, *, / and **")


def _named(name: str) -> Callable[..., Any]:
    return lambda *args: called(name, *args)


_UFUNCS: dict[str, Callable[..., Any]] = {
    "add": operator.add,
    "subtract": operator.sub,
    "multiply": operator.mul,
    "divide": operator.truediv,
    "true_divide": operator.truediv,
    "negative": operator.neg,
    "positive": operator.pos,
    "absolute": abs,
    "fabs": abs,
    "power": pow,
    "float_power": pow,
    "square": lambda one: one * one,
    "reciprocal": lambda one: 1 / one,
    "hypot": lambda a, b: called("sqrt", a * a + b * b),
    "arcsin": _named("asin"),
    "arccos": _named("acos"),
    "arctan": _named("atan"),
    "arctan2": _named("atan2"),
    "minimum": _named("minimum"),
    "maximum": _named("maximum"),
    "deg2rad": _named("radians"),
}
#: The functions of formulas, as `chordal.shapes` has them.
_OF_LANGUAGE = ("acos", "asin", "atan", "atan2", "ceil", "cos", "exp", "floor", "log", "maximum", "minimum", "radians") + (
    "sin",
    "sqrt",
    "tan",
)
_UFUNCS |= {name: _named(name) for name in ("sqrt", "exp", "log", "sin", "cos", "tan", "floor", "ceil", "radians")}
