"""The site of docs/ has all that it should: every public name, every page, and each tutorial in both languages."""

from __future__ import annotations

import importlib.util
import re
from typing import Any

import pytest
from conftest import ROOT

import chordal

REFERENCE = {path.name: path.read_text(encoding="utf-8") for path in sorted((ROOT / "docs" / "reference").glob("*.md"))}
NOTEBOOKS = sorted((ROOT / "examples" / "notebooks").glob("*.py"))
#: What only a bug of Chordal raises.
WITHOUT_EXAMPLE = {"chordal.InternalError"}


def public_names() -> list[str]:
    names = [f"chordal.{name}" for name in chordal.__all__ if name not in ("__version__", "shapes")]
    return names + [f"chordal.shapes.{name}" for name in chordal.shapes.__all__]


def loaded() -> Any:
    """What makes the pages of the site, which needs nothing of what builds it."""
    spec = importlib.util.spec_from_file_location("pages", ROOT / "docs" / "site" / "pages.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


pages = loaded()


def test_every_public_name_is_on_one_page_of_the_reference() -> None:
    shown = [name for text in REFERENCE.values() for name in re.findall(r"^::: (chordal\.[\w.]+)$", text, flags=re.M)]
    # Methods that meshes and volumes have of classes without a public name.
    inherited = ["chordal._interop.Interoperable", "chordal._images.Imaged"]
    assert sorted(shown) == sorted([*public_names(), *inherited])


def test_every_public_name_has_an_example_that_runs() -> None:
    code = "\n".join(block.split("```")[0] for text in REFERENCE.values() for block in text.split("```python\n")[1:])
    used = set(re.findall(r"\w+", code))
    for name in public_names():
        word = name.rpartition(".")[2]
        thing = getattr(chordal.shapes if name.startswith("chordal.shapes.") else chordal, word)
        has_example = ">>>" in (getattr(thing, "__doc__", None) or "") or word in used
        assert has_example != (name in WITHOUT_EXAMPLE), name


def test_live_exhibits_are_of_pages_that_exist() -> None:
    listed = (ROOT / "studio" / "src" / "exhibits" / "index.ts").read_text(encoding="utf-8")
    ids = {*re.findall(r'^    id: "(\w+)",$', listed, flags=re.M), "index", "zh"}
    made = [pages.site_path(f"{folder}/{path.name}") for folder in pages.NOTEBOOKS for path in NOTEBOOKS]
    for place, exhibit in pages.EXHIBITS.items():
        assert place in made or (ROOT / "docs" / place).is_file(), place
        assert exhibit in ids, exhibit


def test_an_exhibit_is_below_the_introduction() -> None:
    framed = pages.with_exhibit("# Levels\n\nWhat they are.\n\n## How\n\nSo.\n", "../a.html?b=1&c", 'Near "and" far')
    frame = '<iframe class="exhibit" src="../a.html?b=1&amp;c" title="Near &quot;and&quot; far" loading="lazy"></iframe>'
    assert framed == f"# Levels\n\nWhat they are.\n\n{frame}\n\n## How\n\nSo.\n"


def test_every_page_is_in_the_navigation() -> None:
    navigation = (ROOT / "mkdocs.yml").read_text(encoding="utf-8").partition("\nnav:\n")[2]
    listed = re.findall(r"[\w/-]+\.md", navigation)
    there = [path.relative_to(ROOT / "docs").as_posix() for path in (ROOT / "docs").rglob("*.md")]
    made = [pages.site_path(f"{folder}/{path.name}") for folder in pages.NOTEBOOKS for path in NOTEBOOKS]
    assert sorted(listed) == sorted([*there, *made, *pages.PAGES.values(), pages.HOME])


@pytest.mark.parametrize("path", NOTEBOOKS, ids=[path.stem for path in NOTEBOOKS])
def test_a_tutorial_has_the_same_code_in_both_languages(path: Any) -> None:
    english = pages.cells(path.read_text(encoding="utf-8"))
    chinese = pages.cells((path.parent / "zh" / path.name).read_text(encoding="utf-8"))
    assert [is_text for is_text, _ in english] == [is_text for is_text, _ in chinese]
    for (is_text, one), (_, other) in zip(english, chinese, strict=True):
        assert bool(re.search("[\u4e00-\u9fff]", other)) if is_text else one == other
        # What is code, a formula of numbers or a heading stays what it is.
        assert one.startswith("# ") == other.startswith("# ")
        assert set(re.findall(r"`[^`]+`", one)) == set(re.findall(r"`[^`]+`", other)) if is_text else True


def test_there_are_no_other_tutorials() -> None:
    chinese = (ROOT / "examples" / "notebooks" / "zh").glob("*.py")
    assert sorted(path.name for path in chinese) == [path.name for path in NOTEBOOKS]


def test_links_lead_to_the_same_files_as_in_the_repository() -> None:
    text = "[a](docs/budget.md#what) [b](GLOSSARY.md) [c](https://example.org/x.md) [d](#top) [e](examples/notebooks)\n"
    assert pages.for_site(text, "README.md") == (
        "[a](budget.md#what) [b](project/glossary.md) [c](https://example.org/x.md) [d](#top) [e](tutorials/index.md)\n"
    )
    assert pages.for_site("![a](pictures/b.png) [c](../crates/d.rs)", "docs/e.md") == "![a](pictures/b.png) [c](source/crates/d.rs)"
    assert pages.for_site("```\n[a](../README.md)\n```", "docs/e.md") == "```\n[a](../README.md)\n```"
    assert pages.for_site("[a](part_to_print.py)", "examples/notebooks/zh/README.md") == "[a](part_to_print.md)"
    assert list(pages.links("[a](b.md#c) [d](https://example.org) ![e](f.png)")) == ["b.md", "f.png"]


def test_marks_are_those_of_python_markdown() -> None:
    assert pages.for_python_markdown("text:\n| a |\n|---|\n| `b \\| c` |") == "text:\n\n| a |\n|---|\n| `b | c` |"
    assert pages.for_python_markdown("text:\n- one\n  more\n- two\n") == "text:\n\n- one\n  more\n- two\n"
    unchanged = "## Head\n| a |\n|---|\n\n```\nx\n- y\n```\n\nbroken at\n4. This is no list.\n"
    assert pages.for_python_markdown(unchanged) == unchanged
    assert pages.without_breaks("断开\n的行 and\nothers") == "断开的行 and\nothers"


def test_a_notebook_becomes_a_page() -> None:
    assert pages.of_notebook("# ---\n# %% [markdown]\n# # Head\n#\n# Text\n\n# %%\nx = 1\n") == (
        "# Head\n\nText\n\n```python\nx = 1\n```\n"
    )


def test_outputs_stand_below_the_code_that_has_shown_them() -> None:
    text = "# %% [markdown]\n# # Head\n\n# %%\nx = 1\nx\n\n# %%\ny = 2\n"

    def cell(source: str, *outputs: dict[str, Any]) -> dict[str, Any]:
        return {"cell_type": "code", "source": source, "outputs": list(outputs)}

    framed = {"text/plain": ["<Mesh>"], "text/html": ['<iframe srcdoc="&lt;p&gt;&amp;amp;"></iframe>\n\n<b>a</b>']}
    shown = (
        {"output_type": "stream", "name": "stdout", "text": ["a\n", "b\n"]},
        {"output_type": "stream", "name": "stdout", "text": "c\n"},
        {"output_type": "execute_result", "data": framed},
        {"output_type": "display_data", "data": {"image/png": "AA==\n", "text/plain": "<Figure>"}},
        {"output_type": "execute_result", "data": {"text/plain": ["1"]}},
    )
    ran = {"cells": [{"cell_type": "markdown", "source": "# Head"}, cell("x = 1\nx", *shown), cell("y = 2")]}
    outputs, frames = pages.outputs_of(text, ran)
    assert frames == {"1.html": "<p>&amp;"}
    assert pages.of_notebook(text, outputs) == (
        "# Head\n\n```python\nx = 1\nx\n```\n\n```text\na\nb\nc\n```\n\n"
        '<div class="output"><iframe src="1.html" loading="lazy"></iframe> <b>a</b></div>\n\n'
        '<div class="output"><img alt="&lt;Figure&gt;" src="data:image/png;base64,AA=="></div>\n\n'
        "```text\n1\n```\n\n```python\ny = 2\n```\n"
    )
    assert pages.outputs_of(text.replace("y = 2", "y = 3"), ran) is None
