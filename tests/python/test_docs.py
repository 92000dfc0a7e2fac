"""The examples in the pages and docstrings run."""

from __future__ import annotations

import ast
import doctest
import importlib
import pkgutil
import shutil
from pathlib import Path

import pytest
from conftest import ROOT
from font import bar_font

import chordal

PAGES = ["README.md", *(path.relative_to(ROOT).as_posix() for path in sorted((ROOT / "docs").rglob("*.md")))]


def examples() -> list[tuple[str, str]]:
    found = []
    for page in PAGES:
        blocks = (ROOT / page).read_text(encoding="utf-8").split("```python\n")[1:]
        found += [(f"{page} {number}", block.split("```")[0]) for number, block in enumerate(blocks, 1)]
    return found


@pytest.mark.parametrize(("name", "code"), examples())
def test_the_example_of_a_page_runs(
    name: str, code: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copytree(ROOT / "examples", tmp_path / "examples", ignore=shutil.ignore_patterns("*.png"))
    (tmp_path / "font.ttf").write_bytes(bar_font())
    monkeypatch.chdir(tmp_path)
    if "import chordal" in code or "from chordal" in code:
        exec(compile(code, name, "exec"), {"__name__": "example"})
    else:
        assert shapes_of_a_script(code)


def shapes_of_a_script(code: str) -> list[chordal.Field]:
    """The shapes of a shape script, which runs in Python too. What stands for its files is here."""
    *before, last = ast.parse(code).body
    assert isinstance(last, ast.Expr | ast.Assign)
    words = {name: getattr(chordal.shapes, name) for name in chordal.shapes.__all__}
    # The font of the tests has one letter and no axes, and scripts open meshes by a word of their own.
    words["text"] = lambda text, font, tolerance, em=1, align="left", **axes: chordal.shapes.text("A", font, tolerance, em, align)
    words["mesh"] = lambda name: chordal.shapes.sphere(1).mesh(tol=0.1).to_field()
    words["__name__"] = "script"
    exec(compile(ast.Module([*before], []), "script", "exec"), words)
    found = eval(compile(ast.Expression(last.value), "script", "eval"), words)
    found = list(found.values()) if isinstance(found, dict) else [found]
    assert all(isinstance(shape, chordal.Field) for shape in found)
    return found


MODULES = ["chordal", *(module.name for module in pkgutil.walk_packages(chordal.__path__, "chordal."))]


@pytest.mark.parametrize("name", [name for name in MODULES if name != "chordal.__main__"])
def test_the_examples_of_the_docstrings_run(name: str) -> None:
    assert doctest.testmod(importlib.import_module(name)).failed == 0


def test_every_public_name_is_documented() -> None:
    for name in chordal.__all__:
        thing = getattr(chordal, name)
        if not isinstance(thing, str):
            assert thing.__doc__, name
            for attribute, value in vars(thing).items() if isinstance(thing, type) else ():
                if not attribute.startswith("_") and (callable(value) or isinstance(value, property)):
                    assert value.__doc__, f"{name}.{attribute}"
