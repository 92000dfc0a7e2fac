"""Shape scripts drawn by a seed, of the kinds that are hard to mesh."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Case:
    """A script, and the length that its mesh is asked to keep to."""

    name: str
    text: str
    tol: float


class Draw:
    """Random numbers and shapes as text; all shapes are about as large as 1."""

    def __init__(self, seed: int) -> None:
        self.random = np.random.default_rng(seed)

    def number(self, low: float, high: float) -> float:
        """A number with four digits, as a person would write it."""
        return float(f"{self.random.uniform(low, high):.4g}")

    def power(self, low: float, high: float) -> float:
        """A number whose logarithm is spread evenly."""
        return float(f"{10 ** self.random.uniform(math.log10(low), math.log10(high)):.4g}")

    def one(self, of: list[str]) -> str:
        """One of some texts."""
        return of[int(self.random.integers(len(of)))]

    def solid(self) -> str:
        """A solid around the origin."""
        n = self.number
        return self.one(
            [
                f"sphere({n(0.3, 0.8)})",
                f"box({n(0.5, 1.5)}, {n(0.5, 1.5)}, {n(0.5, 1.5)})",
                f"rounded_box({n(0.8, 1.5)}, {n(0.8, 1.5)}, {n(0.8, 1.5)}, {n(0.05, 0.35)})",
                f"cylinder({n(0.2, 0.6)}, {n(0.6, 1.6)})",
                f"cone({n(0.3, 0.7)}, {n(0.1, 0.3)}, {n(0.5, 1.2)})",
                f"cone({n(0.3, 0.7)}, 0, {n(0.5, 1.2)})",
                f"torus({n(0.5, 0.8)}, {n(0.1, 0.3)})",
                f"capsule([{n(-0.7, 0)}, 0, {n(-0.3, 0.3)}], [{n(0.1, 0.7)}, {n(-0.3, 0.3)}, 0], {n(0.1, 0.3)})",
                f"ellipsoid({n(0.3, 0.9)}, {n(0.3, 0.9)}, {n(0.3, 0.9)})",
                f"prism({int(n(3, 9))}, {n(0.4, 0.8)}, {n(0.4, 1.2)})",
                f"octahedron({n(0.5, 0.9)})",
                f"tetrahedron({n(0.6, 1.2)})",
            ]
        )

    def placed(self, reach: float = 0.5) -> str:
        """A solid somewhere, turned."""
        n = self.number
        turned = f"rotate({self.solid()}, [{n(-1, 1)}, {n(-1, 1)}, {n(0.1, 1)}], {n(0, 180)})"
        return f"move({turned}, {n(-reach, reach)}, {n(-reach, reach)}, {n(-reach, reach)})"

    def sharp(self) -> str:
        """Solids joined and cut, with edges at all angles."""
        text = self.placed(0.2)
        for _ in range(int(self.random.integers(2, 6))):
            text = f"({text} {self.one(['|', '|', '-', '&'])} {self.placed()})"
            if "&" in text[-200:]:
                text = f"({text} | {self.placed(0.3)})"
        return text

    def acute(self) -> str:
        """A wedge whose rim has an angle of 1 to 20 degrees, cut by a ball or a box."""
        angle = self.power(1, 20)
        wedge = f"plane([0, 0, 1]) & rotate_y(plane([0, 0, -1]), {angle})"
        tilted = f"rotate({wedge}, [{self.number(-1, 1)}, 1, {self.number(-1, 1)}], {self.number(0, 90)})"
        around = self.one(["sphere(1)", "box(1.7, 1.7, 1.7)", "cylinder(0.8, 1.6)"])
        return f"{tilted} & move({around}, {self.number(-0.3, 0.3)}, {self.number(-0.3, 0.3)}, 0)"

    def tangent(self) -> str:
        """Solids that touch in a point or along a line, or nearly."""
        r, gap = self.number(0.3, 0.6), self.one(["0", "1e-9", "-1e-6", "1e-4", "-0.001"])
        return self.one(
            [
                f"move(sphere({r}), {r}, 0) | move(sphere({r}), -{r} - {gap}, 0)",
                f"sphere({2 * r}) - move(sphere({r}), {r} + {gap}, 0)",
                f"box(1.5, 1.5, 0.5) | move(sphere({r}), 0, 0, {r} + 0.25 + {gap})",
                f"box(1.5, 1.5, 1) - move(rotate_x(cylinder({r}, 3), 90), 0, 0, {0.5 - r} + {gap})",
                f"cylinder({r}, 1) | move(cylinder({r}, 0.7), 2 * {r} + {gap}, 0)",
            ]
        )

    def thin(self) -> str:
        """Walls and slits down to a thousandth."""
        t = self.power(1e-3, 0.05)
        return self.one(
            [
                f"shell(sphere({self.number(0.5, 0.9)}), {t}) & plane([{self.number(-1, 1)}, 0.3, 1], {self.number(-0.2, 0.3)})",
                f"box(1.5, 1.2, 1) - move(box(2, 2, {t}), 0.3, 0.3, {self.number(-0.2, 0.2)})",
                f"box(1.4, {self.number(0.5, 1)}, {t}) | move(box({t}, 0.6, 1), 0.2, 0)",
                f"(sphere(0.9) & shell(gyroid({self.number(0.7, 1.2)}), {max(t, 0.01)}))",
                f"shell({self.one(['box(1, 1, 1)', 'cylinder(0.6, 1)', 'torus(0.6, 0.25)'])}, {t})",
                f"extrude(rectangle(1.5, {t}), 1) | move(cylinder({t}, 1.2), 0.3, 0)",
            ]
        )

    def blends(self) -> str:
        """Chains of smooth unions, differences and intersections."""
        text = self.placed(0.2)
        for _ in range(int(self.random.integers(2, 7))):
            word = self.one(["smooth_union", "smooth_union", "smooth_union", "smooth_difference"])
            text = f"{word}({text}, {self.placed()}, {self.number(0.05, 0.4)})"
        return f"{text} & sphere(1.4)"

    def twists(self) -> str:
        """Twisted and bent solids, revolved and extruded profiles."""
        n = self.number
        star = ", ".join(
            f"[{(0.6 if k % 2 else 0.35) * math.cos(k * math.pi / 5):.4f}, {(0.6 if k % 2 else 0.35) * math.sin(k * math.pi / 5):.4f}]"
            for k in range(10)
        )
        return self.one(
            [
                f"twist(box({n(0.4, 0.9)}, {n(0.4, 0.9)}, 1.6), {n(-120, 120)})",
                f"twist(extrude(polygon([{star}]), 1.2), {n(-90, 90)})",
                f"bend(box(1.6, 0.3, 0.4), {n(20, 60)})",
                f"revolve(polygon([[0, -0.6], [{n(0.3, 0.6)}, -0.6], [{n(0.2, 0.8)}, 0], [{n(0.1, 0.5)}, 0.6], [0, 0.6]]))",
                f"revolve(move(circle({n(0.1, 0.3)}), {n(0.35, 0.7)}, 0)) - move(box(1, 1, 1), 0.5, 0.5)",
                f"twist(extrude(move(circle({n(0.3, 0.5)}), {n(0.05, 0.2)}, 0), 1.5), {n(180, 540)})",
            ]
        )

    def patterns(self) -> str:
        """Repeated solids, and plates with rows of holes."""
        n = self.number
        counts = [int(c) for c in self.random.integers(1, 4, 3)]
        ball = self.one([f"sphere({n(0.1, 0.16)})", f"box({n(0.15, 0.3)}, 0.2, 0.2)", f"cylinder({n(0.05, 0.15)}, 0.3)"])
        several = f"repeat({ball}, x=0.4, y=0.4, z=0.4, nx={counts[0]}, ny={counts[1]}, nz={counts[2]})"
        holes = f"repeat(cylinder({n(0.05, 0.15)}, 1), x=0.4, y=0.4, nx={counts[0]}, ny={counts[1]})"
        return self.one([several, f"box(2, 2, {n(0.1, 0.4)}) - {holes}", "sphere(0.8) - repeat(box(0.1, 0.1, 3), x=0.35, y=0.35)"])

    def close(self) -> str:
        """Faces that nearly coincide, or do."""
        gap = self.one(["0", "1e-12", "1e-9", "1e-6", "1e-4", "-1e-6", "-1e-4", "0.001"])
        return self.one(
            [
                f"box(1, 1, 1) | move(box(0.6, 0.6, 0.5), 0.1, 0.1, 0.75 + {gap})",
                f"box(1, 1, 1) - move(box(0.5, 0.5, 0.5), 0, 0, 0.25 + {gap})",
                f"cylinder(0.6, 1) | move(cylinder(0.6 + {gap}, 0.5), 0, 0, 0.5)",
                f"sphere(0.8) & sphere(0.8 + {gap})",
                f"box(1, 1, 1) | rotate_z(box(1, 1, 1), {gap} * 100)",
            ]
        )

    def formulas(self) -> str:
        """Formulas within a ball, and displaced solids."""
        n = self.number
        return self.one(
            [
                f"field(x*x*x*x - 5*x*x + y*y*y*y - 5*y*y + z*z*z*z - 5*z*z + {n(10.5, 11.8)}) & box(5, 5, 5)",
                f"field(x*x + {n(1, 3)}*y*y - z*z*z + {n(-0.2, 0.5)}*x*y - {n(0.1, 0.3)}) & sphere(1)",
                f"displace(sphere(0.7), {n(0.02, 0.06)} * sin({n(4, 9)}*x) * sin({n(4, 9)}*y) * cos(7*z), 0.06)",
                f"field(sqrt(x*x + y*y) - {n(0.3, 0.5)} - 0.1*sin({n(3, 8)}*z)) & box(2, 2, 1.8)",
                f"gyroid({n(0.8, 1.4)}) & sphere({n(0.6, 0.9)})",
            ]
        )


KINDS: list[Callable[[Draw], str]] = [
    Draw.sharp, Draw.acute, Draw.blends, Draw.thin, Draw.twists, Draw.tangent, Draw.patterns, Draw.close, Draw.formulas,
]


def case(seed: int) -> Case:
    """The case of a seed: kinds in turn, every third one at another scale."""
    draw = Draw(seed)
    kind = KINDS[seed % len(KINDS)]
    text, size = kind(draw), 1.0
    if seed % 3 == 1:
        size = 10.0 ** int(draw.random.integers(-6, 7))
        text = f"scale({text}, {size:g})"
    tol = size * draw.power(5e-3, 4e-2)
    return Case(f"{seed}-{kind.__name__}", text, tol)
