"""What MkDocs asks while it builds the site: which files there are beside those of docs/, and what their text is."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from mkdocs.structure.files import File, Files

sys.path.insert(0, str(Path(__file__).parent))
import pages

if TYPE_CHECKING:
    from mkdocs.config.defaults import MkDocsConfig
    from mkdocs.structure.pages import Page

ROOT = Path(__file__).parents[2]


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Adds the pages that are made of other files, and the files that pages link to."""
    for path, place in pages.PAGES.items():
        files.append(File.generated(config, place, abs_src_path=str(ROOT / path)))
    without = 0
    for folder, place in pages.NOTEBOOKS.items():
        for notebook in sorted((ROOT / folder).glob("*.py")):
            text, frames, has_outputs = _tutorial(notebook)
            without += not has_outputs
            files.append(File.generated(config, f"{place}/{notebook.stem}.md", content=text))
            for name, page in frames.items():
                files.append(File.generated(config, f"{place}/{notebook.stem}/{name}", content=page))
    if without:
        print(f"NOTE: {without} tutorials have no outputs, for nothing has run them as they are: make test-python does", file=sys.stderr)
    for linked in sorted(_linked_files()):
        if files.get_file_from_path(pages.site_path(linked)) is None and (ROOT / linked).is_file():
            files.append(File.generated(config, pages.site_path(linked), abs_src_path=str(ROOT / linked)))
    return files


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """The text of a page, with its links as they lead in the site."""
    place = page.file.src_uri
    paths = {place: path for path, place in pages.PAGES.items()}
    path = paths.get(place, f"docs/{place}")
    if (ROOT / path).is_file():
        markdown = pages.for_python_markdown(pages.for_site(markdown, path))
    if place.startswith("zh/"):
        # So that browsers take the letterforms of Chinese. The title is seen by nobody in there.
        page.meta.setdefault("title", markdown.partition("\n")[0].removeprefix("# "))
        markdown = f'<div lang="zh-Hans" markdown="1">\n\n{pages.without_breaks(markdown)}\n\n</div>\n'
    return markdown


def _tutorial(notebook: Path) -> tuple[str, dict[str, str], bool]:
    """The page of a notebook, those in its frames, and whether it has outputs: they are of the notebook as it was run, in the
    folder that `CHORDAL_NOTEBOOKS` names.
    """
    text = notebook.read_text(encoding="utf-8")
    folder = Path(os.environ.get("CHORDAL_NOTEBOOKS", "nowhere"))
    kept = folder / notebook.relative_to(ROOT / "examples/notebooks").with_suffix(".ipynb")
    found = pages.outputs_of(text, json.loads(kept.read_text(encoding="utf-8"))) if kept.is_file() else None
    outputs, frames = found or ([], {})
    return pages.of_notebook(text, outputs), frames, found is not None


def _linked_files() -> set[str]:
    """The files outside of docs/ that pages link to, by their paths in the repository."""
    found = set()
    for path in [*pages.PAGES, *(file.relative_to(ROOT).as_posix() for file in (ROOT / "docs").rglob("*.md"))]:
        for target in pages.links((ROOT / path).read_text(encoding="utf-8")):
            found.add(pages.repository_path(target, path))
    return {path for path in found if not path.startswith(("docs/", "../"))}
