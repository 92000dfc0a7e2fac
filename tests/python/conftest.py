"""What the tests share: the teapot, some small shapes, and the command that cargo built."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
TEAPOT = ROOT / "examples" / "teapot.bpt"

#: Two triangles that make a square.
SQUARE = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n"

#: Runs a command and gives what came of it.
Command = Callable[..., "subprocess.CompletedProcess[bytes]"]


@pytest.fixture(scope="session")
def cargo_chordal() -> Command:
    """The command that cargo built, which knows nothing of Python. `make test-python` says where it is."""
    path = os.environ.get("CHORDAL")
    if path is None:
        pytest.skip("CHORDAL does not name the command that cargo built")

    def run(*args: str | Path, stdin: bytes = b"") -> subprocess.CompletedProcess[bytes]:
        return subprocess.run([path, *args], input=stdin, capture_output=True, check=False, timeout=300)

    return run
