"""The examples in the pages and docstrings run."""

from __future__ import annotations

import doctest
import importlib
import pkgutil
import shutil
from pathlib import Path

import pytest
from conftest import ROOT

import chordal

PAGES = ["docs/python.md", "README.md"]


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
    monkeypatch.chdir(tmp_path)
    exec(compile(code, name, "exec"), {"__name__": "example"})


def test_the_examples_of_the_docstrings_run() -> None:
    failed = attempted = 0
    for module in pkgutil.walk_packages(chordal.__path__, "chordal."):
        result = doctest.testmod(importlib.import_module(module.name))
        failed, attempted = failed + result.failed, attempted + result.attempted
    result = doctest.testmod(chordal)
    assert failed + result.failed == 0
    assert attempted + result.attempted > 20


def test_every_public_name_is_documented() -> None:
    for name in chordal.__all__:
        thing = getattr(chordal, name)
        if not isinstance(thing, str):
            assert thing.__doc__, name
            for attribute, value in vars(thing).items() if isinstance(thing, type) else ():
                if not attribute.startswith("_") and (callable(value) or isinstance(value, property)):
                    assert value.__doc__, f"{name}.{attribute}"
