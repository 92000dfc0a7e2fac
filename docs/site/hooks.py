"""What MkDocs asks while it builds the site: which files there are beside those of docs/, and what their text is."""

from __future__ import annotations

import json
import os
import shutil
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from mkdocs.structure.files import File, Files
from mkdocs.utils import get_relative_url

sys.path.insert(0, str(Path(__file__).parent))
import pages

if TYPE_CHECKING:
    from mkdocs.config.defaults import MkDocsConfig
    from mkdocs.structure.pages import Page

ROOT = Path(__file__).parents[2]
#: The pages that `make studio` builds.
STUDIO = ROOT / "studio/dist/page"


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Adds the pages that are made of other files, and the files that pages link to."""
    files.append(File.generated(config, pages.HOME, content=pages.home((STUDIO / "lesson.html").is_file())))
    if not (STUDIO / "index.html").is_file():
        print("NOTE: the site has no live exhibits, for the studio's pages are not built: make studio does", file=sys.stderr)
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
    if place in pages.EXHIBITS and (STUDIO / "index.html").is_file():
        file = f"{pages.EXHIBITS[place]}.html"
        title = pages.title_of((STUDIO / file).read_text(encoding="utf-8"))
        markdown = pages.with_exhibit(markdown, get_relative_url(f"{pages.STUDIO}/{file}?embed=1", page.url), title)
    if place.startswith("zh/"):
        # So that browsers take the letterforms of Chinese. The title is seen by nobody in there.
        page.meta.setdefault("title", markdown.partition("\n")[0].removeprefix("# "))
        markdown = f'<div lang="zh-Hans" markdown="1">\n\n{pages.without_breaks(markdown)}\n\n</div>\n'
    return markdown


def on_post_page(output: str, page: Page, config: MkDocsConfig) -> str:
    """The language of a page, which the theme takes to be that of the site."""
    return output.replace('<html lang="en"', '<html lang="zh-Hans"', 1) if page.file.src_uri.startswith("zh/") else output


def on_post_build(config: MkDocsConfig) -> None:
    """Puts the studio's pages into the site, whose home is the lesson then."""
    if not (STUDIO / "index.html").is_file():
        return
    site = Path(config.site_dir)
    shutil.copytree(STUDIO, site / pages.STUDIO, dirs_exist_ok=True)
    if (STUDIO / "lesson.html").is_file():
        (site / "index.html").write_text(pages.going_to(f"{pages.STUDIO}/lesson.html"), encoding="utf-8")


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
