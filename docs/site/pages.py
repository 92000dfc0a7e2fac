"""Pages of the site that are no file of docs/ as they stand, as plain text: nothing here knows MkDocs.

A page of the repository is read by two programs. What they disagree about is settled here, so that the pages stay as they
are: where links lead that leave docs/, and two marks that Python-Markdown reads in another way than CommonMark does.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from html import escape, unescape
from pathlib import PurePosixPath
from posixpath import normpath, relpath
from typing import Any

#: Files outside of docs/ that are pages of the site, and their places there.
PAGES = {
    "README.md": "overview.md",
    "CONTRIBUTING.md": "project/contributing.md",
    "SECURITY.md": "project/security.md",
    "GLOSSARY.md": "project/glossary.md",
    "ARCHITECTURE.md": "project/architecture.md",
    "STYLE.md": "project/style.md",
    "CHANGELOG.md": "project/changelog.md",
    "bench/RESULTS.md": "project/results.md",
    "examples/README.md": "project/examples.md",
    "examples/notebooks/README.md": "tutorials/index.md",
    "examples/notebooks/zh/README.md": "zh/tutorials/index.md",
}
#: The page that one comes to first: it is the lesson, in a site with the studio's pages.
HOME = "index.md"
#: Where the studio's pages are in the site.
STUDIO = "studio"
#: The exhibit that shows the idea of a page, live; the widget is "index".
EXHIBITS = {
    "bake.md": "baking",
    "booleans.md": "csg",
    "budget.md": "budget",
    "cages.md": "cage",
    "field_to_mesh.md": "squares",
    "fields.md": "field",
    "gpu_buffers.md": "indexed",
    "grid_to_mesh.md": "cubes",
    "lod.md": "levels",
    "mend.md": "doctor",
    "normals.md": "normals",
    "overshade.md": "overshade",
    "patches_to_mesh.md": "cracks",
    "polygons.md": "fan",
    "render_fields.md": "tracing",
    "segments.md": "index",
    "splines.md": "joins",
    "triangle.md": "inside",
    "tutorials/segments_until_smooth.md": "index",
    "view.md": "mountain",
    "zh/tutorials/segments_until_smooth.md": "zh",
}
#: The folders of notebooks, and of the tutorials that they become.
NOTEBOOKS = {"examples/notebooks": "tutorials", "examples/notebooks/zh": "zh/tutorials"}
#: Where files lie that pages link to and that are no pages: below this, by their paths in the repository.
SOURCES = "source"

_LINK = re.compile(r"(?<=\]\()([^)\s#]+)(#[^)\s]*)?(?=\))")
#: A break between characters, or punctuation, of Chinese.
_BREAK = re.compile("(?<=[\u3000-\u9fff\uff00-\uffef])\n(?=[\u3000-\u9fff\uff00-\uffef])")
#: The page that a frame holds.
_FRAME = re.compile(r'srcdoc="([^"]*)"')
#: What ends a block of HTML in Markdown.
_BLANK = re.compile(r"\s*\n\s*")
_CODE = re.compile(r"(`+)(.+?)\1")
#: What begins a list in the middle of a paragraph; a number other than 1 does not.
_LIST = re.compile(r"(?:[-*+]|1[.)]) ")


def links(text: str) -> Iterator[str]:
    """The targets of the links of a page that are paths, without their fragments."""
    for line, is_code in _lines(text):
        if not is_code:
            yield from (link[1] for link in _LINK.finditer(line) if ":" not in link[1])


def repository_path(target: str, path: str) -> str:
    """The file of the repository that a relative link of the page at `path` leads to."""
    return normpath(str(PurePosixPath(path).parent / target))


def site_path(path: str) -> str:
    """Where a file of the repository is in the site, before its pages have become HTML."""
    if path in PAGES:
        return PAGES[path]
    if path in NOTEBOOKS:
        return f"{NOTEBOOKS[path]}/index.md"
    folder, name = str(PurePosixPath(path).parent), PurePosixPath(path)
    if folder in NOTEBOOKS and name.suffix == ".py":
        return f"{NOTEBOOKS[folder]}/{name.stem}.md"
    if path.startswith("docs/"):
        return path.removeprefix("docs/")
    return f"{SOURCES}/{path}"


def for_site(text: str, path: str) -> str:
    """The text of the page at `path` of the repository, as the site's."""
    own = PurePosixPath(site_path(path)).parent.as_posix()

    def moved(link: re.Match[str]) -> str:
        target, fragment = link[1], link[2] or ""
        if ":" in target:
            return link[0]
        return relpath(site_path(repository_path(target, path)), own) + fragment

    return _mapped(text, lambda line: _LINK.sub(moved, line))


def for_python_markdown(text: str) -> str:
    """The same page for Python-Markdown: a blank line before a list or a table that follows a paragraph or code, and no
    backslash before a bar in the code of a table.
    """
    found: list[str] = []
    was = ""
    for line, is_code in _lines(text):
        is_now = "code" if is_code else "table" if line.startswith("|") else "list" if _LIST.match(line) else "text"
        if is_now == "table":
            line = _CODE.sub(lambda code: code[0].replace("\\|", "|"), line)
        if is_now in ("table", "list") and was in ("text", "code") and found[-1].strip() and not found[-1].startswith("#"):
            found.append("")
        # The lines of an item that are broken belong to its list.
        is_item = was == "list" and is_now == "text" and line.startswith(" ")
        was = was if is_item else is_now
        found.append(line)
    return "\n".join(found)


def of_notebook(text: str, outputs: list[str] | None = None) -> str:
    """The page of a notebook: a script with cells, each of code with what it has shown below it, in Markdown, where that is
    known. What is before its first cell is for Jupyter alone.
    """
    below = iter(outputs or ())
    found = []
    for is_text, cell in cells(text):
        found.append(cell if is_text else f"```python\n{cell}\n```")
        shown = "" if is_text else next(below, "")
        found += [shown] if shown else []
    return "\n\n".join(found) + "\n"


def outputs_of(text: str, executed: dict[str, Any]) -> tuple[list[str], dict[str, str]] | None:
    """What each cell of code of a notebook has shown, and by their names the pages that frames in it hold; of the notebook as
    Jupyter keeps it. None where that one was run with other code.
    """
    ran = [cell for cell in executed["cells"] if cell["cell_type"] == "code"]
    if [cell for is_text, cell in cells(text) if not is_text] != ["".join(cell["source"]).strip("\n") for cell in ran]:
        return None
    frames: dict[str, str] = {}

    def framed(page: re.Match[str]) -> str:
        name = f"{len(frames) + 1}.html"
        frames[name] = unescape(page[1])
        return f'src="{name}" loading="lazy"'

    below = []
    for cell in ran:
        shown, printed = [], ""
        for output in [*cell["outputs"], {"output_type": "end"}]:
            # What is printed comes in pieces.
            if output["output_type"] == "stream":
                printed += "".join(output["text"])
                continue
            if printed:
                shown.append(f"```text\n{printed.rstrip()}\n```")
                printed = ""
            data = {kind: "".join(value) for kind, value in output.get("data", {}).items() if isinstance(value, (str, list))}
            if "text/html" in data:
                shown.append(f'<div class="output">{_BLANK.sub(" ", _FRAME.sub(framed, data["text/html"]))}</div>')
            elif "image/png" in data:
                picture = data["image/png"].replace("\n", "")
                name = escape(data.get("text/plain", ""), quote=True)
                shown.append(f'<div class="output"><img alt="{name}" src="data:image/png;base64,{picture}"></div>')
            elif "text/plain" in data:
                shown.append(f"```text\n{data['text/plain']}\n```")
        below.append("\n\n".join(shown))
    return below, frames


def home(has_lesson: bool) -> str:
    """The first page. Browsers without a lesson to go to, and search, see this one."""
    links = f"[Read the lesson]({STUDIO}/lesson.html) · [阅读中文版]({STUDIO}/lesson.zh.html)"
    lesson = links if has_lesson else "`make studio` builds it."
    return f"""# The lesson

How do you write a shape down: as points that can be listed and drawn, or as a rule that tests any point? {lesson}

Then the [gallery](gallery.md), [what Chordal is and how to install it](overview.md), and the [tutorials](tutorials/index.md).
"""


def with_exhibit(text: str, address: str, title: str) -> str:
    """A page with a live exhibit below its introduction."""
    frame = f'<iframe class="exhibit" src="{escape(address)}" title="{escape(title)}" loading="lazy"></iframe>'
    heading = re.search(r"^## ", text, flags=re.M)
    at = heading.start() if heading else len(text)
    return f"{text[:at].rstrip()}\n\n{frame}\n\n{text[at:]}"


def title_of(html: str) -> str:
    """The title of a page of the studio."""
    found = re.search(r"<title>(.*?)</title>", html, flags=re.S)
    return unescape(found[1]) if found else ""


def going_to(address: str) -> str:
    """A page that leads to another one at once."""
    return (
        '<!doctype html>\n<html lang="en">\n<meta charset="utf-8">\n<title>Chordal</title>\n'
        f'<meta http-equiv="refresh" content="0; url={address}">\n<p><a href="{address}">Chordal: the lesson</a>\n'
    )


def cells(text: str) -> list[tuple[bool, str]]:
    """The cells of a notebook: whether each is text, and what is in it."""
    found = []
    for cell in re.split(r"^# %%", text, flags=re.M)[1:]:
        kind, _, body = cell.partition("\n")
        is_text = kind.strip() == "[markdown]"
        lines = body.strip("\n").split("\n")
        found.append((is_text, "\n".join(line.removeprefix("#").removeprefix(" ") if is_text else line for line in lines)))
    return found


def without_breaks(text: str) -> str:
    """Lines of Chinese put together where they were broken, which browsers would show as a space."""
    return _BREAK.sub("", text)


def _lines(text: str) -> Iterator[tuple[str, bool]]:
    """The lines, and whether each belongs to a fenced block."""
    fence = ""
    for line in text.split("\n"):
        mark = re.match(r" *(`{3,}|~{3,})", line)
        if mark and not fence:
            fence = mark[1]
            yield line, True
        elif fence:
            if line.strip() == fence:
                fence = ""
            yield line, True
        else:
            yield line, False


def _mapped(text: str, change: Callable[[str], str]) -> str:
    return "\n".join(line if is_code else change(line) for line, is_code in _lines(text))
