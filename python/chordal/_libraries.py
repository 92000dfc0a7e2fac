"""Optional libraries, imported on demand."""

from __future__ import annotations

import importlib
from typing import Any


def library(name: str) -> Any:
    """Imports a library that the package does not require; raises `ImportError` if it is not installed."""
    return importlib.import_module(name)
