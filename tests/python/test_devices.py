"""Functions of other libraries' arrays: of JAX where it is installed, and of what behaves like PyTorch."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import chordal

BOUNDS: Any = ((-1.3, -1.3, -1.3), (1.3, 1.3, 1.3))


class Tensor:
    """What a tensor of PyTorch does of what is asked of it: it refuses numpy while it records gradients."""

    def __init__(self, array: Any, records: bool = False, on: str = "cpu") -> None:
        self.array, self.records, self.on = np.asarray(array, np.float32), records, on

    def new_tensor(self, array: Any) -> Tensor:
        return Tensor(array, on=self.on)

    def detach(self) -> Tensor:
        return Tensor(self.array, on=self.on)

    def cpu(self) -> Tensor:
        return Tensor(self.array, self.records)

    def double(self) -> Tensor:
        return self

    def numpy(self) -> Any:
        if self.records or self.on != "cpu":
            raise TypeError("can't convert this tensor to numpy")
        return self.array.astype(np.float64)

    def __array__(self, dtype: Any = None, copy: Any = None) -> Any:
        raise TypeError("can't convert this tensor to numpy")


class Module:
    """A network with one parameter, on a device of its own."""

    def __init__(self) -> None:
        self.seen: list[str] = []

    def parameters(self) -> Any:
        return iter([Tensor([0.0], records=True, on="cuda:1")])

    def forward(self, points: Tensor) -> Tensor:
        self.seen.append(points.on)
        return Tensor(np.linalg.norm(points.array, axis=1, keepdims=True) - 1, records=True, on=points.on)

    def __call__(self, points: Tensor) -> Tensor:
        return self.forward(points)


def test_a_module_gets_tensors_on_its_own_device() -> None:
    network = Module()
    ball = chordal.field(network, bounds=BOUNDS)
    assert np.allclose(ball([[2, 0, 0], [0, 0, 0]]), (1, -1)) and set(network.seen) == {"cuda:1"}
    mesh = ball.mesh(tol=0.05)
    assert mesh.is_watertight and mesh.bound.evidence == "measured"
    assert np.allclose(np.linalg.norm(mesh.vertices, axis=1), 1, atol=0.05)


def test_a_function_gets_arrays_like_one_that_is_shown() -> None:
    def norm(points: Any) -> Any:
        assert isinstance(points, Tensor)
        return Tensor(np.linalg.norm(points.array, axis=1) - 1, records=True)

    ball = chordal.field(norm, bounds=BOUNDS, lipschitz=1, like=Tensor([0.0]))
    assert np.allclose(ball([[2, 0, 0]]), 1)
    with pytest.raises(TypeError, match="like: a tensor of PyTorch, or an array"):
        chordal.field(norm, bounds=BOUNDS, like=3)
    with pytest.raises(TypeError, match="are for functions"):
        chordal.field(chordal.shapes.x, like=Tensor([0.0]))


def test_jax_is_called_with_its_own_arrays() -> None:
    jax: Any = pytest.importorskip("jax", reason="jax is not installed: its functions are not tried")
    import jax.numpy as jnp  # type: ignore[import-not-found, unused-ignore]

    @jax.jit  # type: ignore[untyped-decorator, unused-ignore]
    def torus(points: Any) -> Any:
        return jnp.hypot(jnp.hypot(points[:, 0], points[:, 1]) - 0.8, points[:, 2]) - 0.3

    def slopes(points: Any) -> Any:
        return jax.vmap(jax.grad(lambda p: torus(p[None])[0]))(points)

    bounds: Any = ((-1.2, -1.2, -0.4), (1.2, 1.2, 0.4))
    shown = chordal.field(torus, bounds=bounds, gradient=slopes, lipschitz=1, like=jnp.zeros(3))
    assert np.allclose(shown([[0.8, 0, 0]]), -0.3) and np.allclose(shown.gradient([[1.5, 0, 0]]), [[1, 0, 0]])
    mesh = shown.mesh(tol=0.1)
    assert mesh.is_watertight and mesh.bound.evidence == "proved-if"
