"""The notebooks of examples/notebooks run from top to bottom, and are notebooks."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import ROOT

NOTEBOOKS = sorted((ROOT / "examples" / "notebooks").glob("*.py"))


def test_there_are_six() -> None:
    assert len(NOTEBOOKS) == 6


# Runs each cell as a notebook does: the value of a last line is shown, in the richest way that it has.
RUNNER = """
import ast, re, sys

names, shown = {"__name__": "__main__"}, []
for cell in re.split(r"^# %%.*$", open(sys.argv[1], encoding="utf-8").read(), flags=re.M)[1:]:
    body = ast.parse(cell).body
    last = body.pop() if body and isinstance(body[-1], ast.Expr) else None
    exec(compile(ast.Module(body, []), sys.argv[1], "exec"), names)
    if last is None:
        continue
    value = eval(compile(ast.Expression(last.value), sys.argv[1], "eval"), names)
    for way in ("_repr_mimebundle_", "_repr_html_", "_repr_png_"):
        if hasattr(value, way):
            shown.append(f"{type(value).__name__} {way} {len(str(getattr(value, way)()))}")
            break
    else:
        repr(value)
print("shown:", "; ".join(shown))
"""


@pytest.mark.parametrize("path", NOTEBOOKS, ids=[path.stem for path in NOTEBOOKS])
def test_a_notebook_runs_from_top_to_bottom_and_shows_something(path: Path) -> None:
    words = [sys.executable, "-c", RUNNER, str(path)]
    done = subprocess.run(words, capture_output=True, text=True, check=False, timeout=300, cwd=ROOT)
    assert done.returncode == 0, done.stderr[-2000:]
    *said, shown = done.stdout.splitlines()
    assert len(said) >= 2, done.stdout
    assert shown.count("_repr_") >= 1, shown


@pytest.mark.parametrize("path", NOTEBOOKS, ids=[path.stem for path in NOTEBOOKS])
def test_a_notebook_begins_with_a_title_and_has_text_between_its_cells(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    cells = re.split(r"^# %%", text, flags=re.M)[1:]
    assert cells[0].startswith(" [markdown]\n# # ") and sum(cell.startswith(" [markdown]") for cell in cells) >= 2
