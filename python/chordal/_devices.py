"""Functions of arrays that are not numpy's: on their device, and back."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable
from typing import Any


def with_arrays(function: Callable[[Any], Any], like: Any | None) -> Callable[[Any], Any]:
    """A function of numpy's arrays that calls another one with arrays like `like`."""
    if like is None:
        like = parameter_of(function)
    if like is None:
        return lambda points: to_numpy(function(points))
    if not hasattr(like, "new_tensor") and not hasattr(like, "__array_namespace__"):
        raise TypeError(f"like: a tensor of PyTorch, or an array of a library with the array API, not {type(like).__name__}")

    def called(points: Any) -> Any:
        with _no_gradients(like):
            if hasattr(like, "new_tensor"):
                # PyTorch would warn of an array that may not be written to.
                return to_numpy(function(like.new_tensor(points.copy())))
            return to_numpy(function(_padded(points, like)))[: len(points)]

    return called


def parameter_of(function: Any) -> Any | None:
    """The first parameter of a module of PyTorch; None for any other function."""
    if not (hasattr(function, "parameters") and hasattr(function, "forward")):
        return None
    return next(iter(function.parameters()), None)


#: Functions that are compiled for a number of points get few numbers: powers of two, from this one on. Chosen.
_FEWEST = 256


def _padded(points: Any, like: Any) -> Any:
    """Points as an array of that type, on that device; the last of them again up to a power of two, since JAX compiles its
    functions anew for every length.
    """
    import numpy as np

    n = max(_FEWEST, 1 << (len(points) - 1).bit_length())
    rows = np.concatenate([points, np.broadcast_to(points[-1], (n - len(points), 3))])
    xp = like.__array_namespace__()
    return xp.asarray(rows, dtype=like.dtype, device=like.device)


def wants_tensors(function: Callable[[Any], Any], points: Any) -> bool:
    """Whether a function that fails with arrays of numpy's is one of tensors: where PyTorch is loaded it is tried."""
    torch: Any = sys.modules.get("torch")
    try:
        with torch.no_grad():
            # Networks have single precision, as a rule.
            return hasattr(function(torch.as_tensor(points, dtype=torch.float32)), "detach")
    except Exception:
        return False


def _no_gradients(like: Any) -> Any:
    """Where PyTorch records nothing."""
    torch = sys.modules.get("torch")
    return torch.no_grad() if torch is not None and hasattr(like, "new_tensor") else contextlib.nullcontext()


def to_numpy(values: Any) -> Any:
    """An array of any library as numpy's, from whatever device."""
    if hasattr(values, "detach"):
        values = values.detach().cpu()
        # bfloat16 has no equal in numpy.
        return values.double().numpy() if hasattr(values, "double") else values.numpy()
    # CuPy asks for its arrays to be fetched by name.
    return values.get() if hasattr(values, "get") and hasattr(values, "device") else values
