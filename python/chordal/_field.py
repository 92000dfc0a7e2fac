"""`Field` and `Formula`: shapes as functions of a point, and their operations."""

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
from chordal._html import table
from chordal._recipe import Recipe, Remakeable
from chordal._registry import registered
from chordal._shape import Shape

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    from chordal._mesh import Mesh

#: The lowest and the highest corner of a box.
Box = tuple[tuple[float, float, float], tuple[float, float, float]]


def _value(value: Any) -> Any:
    """The value, or list of values, in the form that the compiled part takes."""
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
    """The result of calling a function of the language."""
    result = _chordal.ScriptValue.call(name, *map(_value, args), **{key: _value(arg) for key, arg in named.items()})
    return _wrapped(result, (called, (name, *args), named))


def _wrapped(result: _chordal.ScriptValue | float, recipe: Recipe) -> Any:
    """A result of the language as a `Field`, a `Formula` or a number."""
    if isinstance(result, float):
        return result
    return Field(result, None, recipe) if result.is_shape else Formula(result, recipe)


def _operated(operator: str, a: Any, b: Any) -> Any:
    result = _chordal.ScriptValue.operate(operator, _value(a), _value(b))
    return NotImplemented if result is None else _wrapped(result, (_operated, (operator, a, b), {}))


def coordinate(k: int) -> Formula:
    """The coordinate with index `k`."""
    return Formula(_chordal.ScriptValue.axis(k), (coordinate, (k,), {}))


def field_of_mesh(mesh: Mesh) -> Field:
    """The signed distance to triangles."""
    value, source = _chordal.mesh_field(mesh._source)
    return Field(value, source, (field_of_mesh, (mesh,), {}))


def _points(points: ArrayLike) -> NDArray[np.float64]:
    rows = coordinates("points", points)
    if rows.ndim == 0 or rows.shape[-1] != 3:
        raise ValueError(f"points: rows of 3, as in (n, 3), not {rows.shape}")
    return rows


def _values(value: _chordal.ScriptValue, points: ArrayLike) -> NDArray[np.float64]:
    import numpy as np

    rows = _points(points)
    return np.frombuffer(value.values(rows.tobytes())).reshape(rows.shape[:-1])


class Formula(Remakeable):
    """An expression in the coordinates `x`, `y` and `z`: a number for every point. `field` makes it a shape.

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
        """The values at points, an array with a last axis of length 3."""
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
        """A power: whole exponents by multiplication, 0.5 as a square root, others by exp and log, for positive values."""
        if isinstance(exponent, bool) or not isinstance(exponent, Real):
            return NotImplemented
        exponent = float(exponent)
        # Still a formula, which the number 1 would not be.
        if exponent == 0:
            return self * 0 + 1
        if exponent == 0.5:
            return called("sqrt", self)
        if exponent.is_integer() and 1 <= abs(exponent) <= _LARGEST_POWER:
            power = _power(self, abs(int(exponent)))
            return power if exponent > 0 else 1 / power
        return called("exp", exponent * called("log", self))

    def __rpow__(self, base: float) -> Formula:
        """A positive number to the power of a formula."""
        if isinstance(base, bool) or not isinstance(base, Real):
            return NotImplemented
        return called("exp", self * math.log(float(base)))

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **named: Any) -> Any:
        """Applies functions of numpy to a formula, as in `numpy.sin(x)`."""
        import numpy as np

        if not all(isinstance(operand, (Formula, Real, np.ndarray)) for operand in inputs):
            return NotImplemented
        name = _UFUNCS.get(ufunc.__name__)
        if method != "__call__" or named or name is None:
            raise _no_function(ufunc.__name__ if method == "__call__" else f"{ufunc.__name__}.{method}")
        if any(getattr(operand, "ndim", 0) for operand in inputs):
            raise TypeError("a formula and an array are no formula: a formula is called with points, as in x(points)")
        # Numbers of numpy become Python's own: an operator of numpy's would call this method again.
        operands = [operand if isinstance(operand, Formula) else float(operand) for operand in inputs]
        return name(*operands)

    def __array_function__(self, function: Any, types: Any, args: Any, named: Any) -> Any:
        """Refuses the other functions of numpy, which would treat a formula as an opaque object."""
        raise _no_function(function.__name__)

    def __bool__(self) -> bool:
        """Refused: a formula is a number for every point."""
        raise TypeError(
            "a formula has no truth value, for it is a number for every point: minimum and maximum of chordal.shapes choose"
        )

    def __lt__(self, other: object) -> NoReturn:
        """Refused: the points where a formula is below a number are a field, not a condition."""
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
        # The value without the box that a function was given with: `within` cuts this one instead.
        self._uncut = value if uncut is None else uncut

    def __call__(self, points: ArrayLike) -> NDArray[np.float64]:
        """The values at points, an array with a last axis of length 3: negative inside, NaN where undefined."""
        return _values(self._value, points)

    def gradient(self, points: ArrayLike) -> NDArray[np.float64]:
        """The gradients at points, in an array of the same shape. At a kink it is the gradient of one side."""
        import numpy as np

        rows = _points(points)
        return np.frombuffer(self._value.gradients(rows.tobytes())).reshape(rows.shape)

    @property
    def distance(self) -> tuple[str, str]:
        """The quality of the value as a distance, outside and inside: "exact distance", "lower bound" or "sign"."""
        return self._value.distance

    @property
    def evidence(self) -> str:
        """The best evidence that bounds of this field can have: "proved", "proved-if" or "measured"."""
        return self._value.evidence[0]

    @property
    def assumptions(self) -> tuple[str, ...]:
        """The assumptions of proofs about this field, in sentences."""
        return tuple(self._value.evidence[1])

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes about how it was built, in sentences, as the distance of polygons from the curves that they approximate.

        >>> import chordal
        >>> disc = chordal.shapes.polygon(chordal.shapes.arc(1), tolerance=0.01)
        >>> disc.notes[0].endswith("(proved)")
        True
        """
        return tuple(self._value.notes)

    @property
    def bounds(self) -> Box:
        """The lowest and highest corner of a box that contains the shape; infinite on sides without a known bound."""
        (a, b, c), (d, e, f) = self._value.bounds
        return (a, b, c), (d, e, f)

    def within(self, low: Sequence[SupportsFloat], high: Sequence[SupportsFloat]) -> Field:
        """The same shape; meshes and other results of it are cut off at a box."""
        least, most = _box("box", (low, high))
        region = _chordal.region_of(self._source)
        # Boxes of repeated calls are intersected: a second one does not undo the first.
        if region is not None:
            least = [max(a, b) for a, b in zip(least, region[0], strict=True)]
            most = [min(a, b) for a, b in zip(most, region[1], strict=True)]
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
        """The shape scaled about the origin: `shapes.scale`."""
        return called("scale", self, factor)  # type: ignore[no-any-return]

    def rotate(self, axis: Literal["x", "y", "z"] | Sequence[SupportsFloat] | NDArray[Any], degrees: SupportsFloat) -> Field:
        """The shape rotated around an axis through the origin, a letter or a vector: `shapes.rotate`."""
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

        Raises `ValueError` if the value is not a distance on that side.
        """
        return called("offset", self, by)  # type: ignore[no-any-return]

    def shell(self, thickness: SupportsFloat) -> Field:
        """A wall along the surface, with half of its thickness on each side: `shapes.shell`. Raises as `offset`."""
        return called("shell", self, thickness)  # type: ignore[no-any-return]

    def __add__(self, other: object) -> NoReturn:
        """Refused: the union of shapes is `|`."""
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


def _spread(args: tuple[Any, ...]) -> Sequence[Any]:
    """Arguments that are numbers, or the components of a single vector."""
    vector = args[0] if len(args) == 1 else args
    parts: Sequence[Any] = vector.tolist() if hasattr(vector, "tolist") else vector
    return parts if isinstance(parts, (list, tuple)) else args


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
        description = f"numbers of shape {rows.shape}" if rows.size or rows.ndim == 0 else repr(value)
        raise ValueError(f"{name}: a lowest and a highest corner, as in ((-1, -1, -1), (1, 1, 1)), not {description}")
    if not all(rows[0] < rows[1]):
        raise ValueError(f"{name}: the lowest corner is below the highest along x, y and z: {rows.tolist()}")
    corners: list[list[float]] = rows.tolist()
    return corners


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

    A function is called with an n × 3 array in double precision: a batch of one to some hundred thousand points. It returns
    n numbers: negative inside, NaN outside. If its surface is not at 0, `iso` is the value there; if its values are larger
    inside, as of occupancies and densities, `inside` is "high". The resulting field has its surface at 0 and is negative
    inside. The function is called from other threads, and an exception that it raises is passed on.

    `bounds` is a box that contains the shape, which is cut off there. With `lipschitz` you promise that the values of two
    points differ by no more than this number times their distance; proofs then assume it. Without it, meshes are measured
    at samples. `gradient` is a function that returns the derivatives along x, y and z, n × 3; without it they are estimated
    from four values near each point. `report["run"]["evaluations"]` of a mesh is the number of points that were evaluated.

    With `like`, an array of another library, the functions are called with such arrays instead of numpy's, of its type and on
    its device: a tensor of PyTorch, or an array of JAX, CuPy or any library with the array API, padded to a power of two so
    that JAX compiles for few lengths. A module of PyTorch is called with tensors like its parameters even without `like`, and
    no gradients are recorded. Values in single precision keep their rounding errors.

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
    turn = None if sided is None else sided.slope
    slopes = None if gradient is None else of_bytes(gradient, "gradient", lambda n: ((n, 3),), like, turn)
    words = {"bounds": bounds, "lipschitz": lipschitz, "gradient": gradient, "like": like, "iso": level, "inside": inside}
    recipe: Recipe = (field, (what,), words)
    uncut = _chordal.ScriptValue.callable(values, slopes, slope)
    if bounds is None:
        return Field(uncut, None, recipe)
    box = _box("bounds", bounds)
    warn_of_complement(values, box)
    # Far from its training data a network may have any value: results of this field alone are cut off at the box, and do not
    # rely on the promise that the shape lies within it.
    return Field(uncut.with_bounds(box), uncut.source(box), recipe, uncut)


def _is_high(inside: str) -> bool:
    if inside not in ("low", "high"):
        raise ValueError(f"inside: 'low' or 'high', not {inside!r}")
    return inside == "high"


def _field_by(shape: Shape) -> str:
    return "this is a Field already" if isinstance(shape, Field) else "to_field() of a mesh is its signed distance"


def script(source: str, **parameters: SupportsFloat) -> Field:
    """The shape of a shape script: a few lines of Starlark, run within limits and without any files.

    Keyword arguments set the script's parameters. Raises `ReadError` with line and column; warns with a
    `UserWarning` of a line that is likely a mistake, as `a | b - c`.

    >>> import chordal
    >>> chordal.script("box(2, 2, 1) - cylinder(param('r', 0.4), 2)", r=0.5)([[0, 0, 0]])
    array([0.5])
    """
    script_text = _text("source", source)
    if script_text is None:
        raise TypeError("source: a text, not None")
    value, _, likely_mistakes = _chordal.script(script_text, [(name, float(value)) for name, value in parameters.items()])
    for line, message in likely_mistakes:
        warnings.warn(f"line {line}: {message}", stacklevel=2)
    return Field(value, None, (script, (source,), dict(parameters)))


#: The largest exponent that is expanded. Chosen: larger whole powers are rare, and cost a multiplication for each bit.
_LARGEST_POWER = 1024


def _power(base: Formula, exponent: int) -> Formula:
    """A whole power by squaring, so that equal factors are shared."""
    product: Formula | None = None
    while exponent:
        if exponent & 1:
            product = base if product is None else product * base
        exponent >>= 1
        if exponent:
            base = base * base
    assert product is not None
    return product


#: Equivalents of functions that formulas do not have, by their names in numpy.
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
    """The error for a function of numpy that formulas do not have."""
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
    "square": lambda value: value * value,
    "reciprocal": lambda value: 1 / value,
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


registered.field = Field
registered.field_of_mesh = field_of_mesh
