"""Other libraries, imported when they are asked for."""

from __future__ import annotations

import importlib
from typing import Any


def library(name: str) -> Any:
    """A library that this package does not need; `ImportError` where it is not installed."""
    return importlib.import_module(name)
