"""Functions of arrays of other libraries: moves points to their device, and values back."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable
from typing import Any


def with_arrays(function: Callable[[Any], Any], like: Any | None) -> Callable[[Any], Any]:
    """Wraps a function so that it takes numpy's arrays, and is called with arrays like `like`."""
    if like is None:
        like = parameter_of(function)
    if like is None:
        return lambda points: to_numpy(function(points))
    if not hasattr(like, "new_tensor") and not hasattr(like, "__array_namespace__"):
        raise TypeError(f"like: a tensor of PyTorch, or an array of a library with the array API, not {type(like).__name__}")

    def called(points: Any) -> Any:
        with _no_gradients(like):
            if hasattr(like, "new_tensor"):
                # A copy, since PyTorch warns of read-only arrays.
                return to_numpy(function(like.new_tensor(points.copy())))
            return to_numpy(function(_padded(points, like)))[: len(points)]

    return called


def parameter_of(function: Any) -> Any | None:
    """The first parameter of a module of PyTorch; None for any other function."""
    if not (hasattr(function, "parameters") and hasattr(function, "forward")):
        return None
    return next(iter(function.parameters()), None)


#: The smallest padded number of points. Chosen: smaller values let JAX compile a function for more lengths, larger ones waste
#: evaluations on short batches.
_FEWEST = 256


def _padded(points: Any, like: Any) -> Any:
    """Points as an array of the type and on the device of `like`. The last point is repeated up to a power of two, since JAX
    compiles a function again for every length.
    """
    import numpy as np

    n = max(_FEWEST, 1 << (len(points) - 1).bit_length())
    rows = np.concatenate([points, np.broadcast_to(points[-1], (n - len(points), 3))])
    xp = like.__array_namespace__()
    return xp.asarray(rows, dtype=like.dtype, device=like.device)


def wants_tensors(function: Callable[[Any], Any], points: Any) -> bool:
    """Whether a function that fails with numpy's arrays takes tensors. It is tried only if PyTorch is loaded."""
    torch: Any = sys.modules.get("torch")
    try:
        with torch.no_grad():
            # Most networks use single precision.
            return hasattr(function(torch.as_tensor(points, dtype=torch.float32)), "detach")
    except Exception:
        return False


def _no_gradients(like: Any) -> Any:
    """A context in which PyTorch records no gradients; a null context for other libraries."""
    torch = sys.modules.get("torch")
    return torch.no_grad() if torch is not None and hasattr(like, "new_tensor") else contextlib.nullcontext()


def to_numpy(values: Any) -> Any:
    """An array of any library, on any device, as an array of numpy."""
    if hasattr(values, "detach"):
        values = values.detach().cpu()
        # In double precision, since numpy has no bfloat16.
        return values.double().numpy() if hasattr(values, "double") else values.numpy()
    # CuPy requires an explicit `get` to copy an array from its device.
    return values.get() if hasattr(values, "get") and hasattr(values, "device") else values
