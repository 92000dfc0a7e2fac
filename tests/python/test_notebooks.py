"""The notebooks of examples/notebooks run from top to bottom under a kernel of Jupyter, and show what they should."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import ROOT

from chordal import _notebook

FOLDER = ROOT / "examples" / "notebooks"
NOTEBOOKS = sorted(FOLDER.rglob("*.py"))
EXECUTE = ROOT / "docs" / "site" / "execute.py"
#: Notebooks whose last word is a plot of matplotlib; the others show meshes to be turned.
PLOTS = {"segments_until_smooth"}


def name(notebook: Path) -> str:
    return notebook.relative_to(FOLDER).with_suffix("").as_posix()


def run(notebook: Path, folder: Path) -> dict[str, Any]:
    """The notebook after a kernel has run it; `make docs-site` takes what is in `CHORDAL_NOTEBOOKS`."""
    words = [sys.executable, str(EXECUTE), str(folder), str(notebook)]
    done = subprocess.run(words, capture_output=True, encoding="utf-8", check=False, timeout=600)
    assert done.returncode == 0, done.stderr[-3000:]
    made: dict[str, Any] = json.loads((folder / f"{name(notebook)}.ipynb").read_text(encoding="utf-8"))
    return made


def outputs(made: dict[str, Any]) -> list[dict[str, Any]]:
    return [output for cell in made["cells"] for output in cell.get("outputs", [])]


def test_there_are_six_in_two_languages() -> None:
    assert len(NOTEBOOKS) == 12


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=name)
def test_a_kernel_runs_it_from_top_to_bottom_and_it_shows_what_it_should(notebook: Path, tmp_path: Path) -> None:
    made = run(notebook, Path(os.environ.get("CHORDAL_NOTEBOOKS") or tmp_path))
    code = [cell for cell in made["cells"] if cell["cell_type"] == "code"]
    assert [cell["execution_count"] for cell in code] == list(range(1, len(code) + 1))
    shown = outputs(made)
    assert not [output for output in shown if output["output_type"] == "error" or output.get("name") == "stderr"]
    printed = "".join("".join(output["text"]) for output in shown if output["output_type"] == "stream")
    assert len(printed.splitlines()) >= 2
    data = [output["data"] for output in shown if "data" in output]
    assert all("text/plain" in one for one in data)
    pages = ["".join(one.get("text/html", "")) for one in data]
    if notebook.stem in PLOTS:
        assert sum("image/png" in one for one in data) == 2
    else:
        kind = "<iframe sandbox" if _notebook._viewer() is not None else "<img"
        assert any(page.startswith(kind) for page in pages)


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=name)
def test_it_begins_with_a_title_and_every_code_has_text_before_it(notebook: Path) -> None:
    cells = re.split(r"^# %%", notebook.read_text(encoding="utf-8"), flags=re.M)[1:]
    assert cells[0].startswith(" [markdown]\n# # ")
    is_text = [cell.startswith(" [markdown]") for cell in cells]
    assert all(one or before for before, one in pairwise(is_text)), "two cells of code follow each other"


def run_text(text: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """What came of a notebook of one's own, which is kept as `made.ipynb` in the folder."""
    made, copy = folder / "examples" / "notebooks" / "made.py", folder / "docs" / "site" / "execute.py"
    for path in (made, copy):
        path.parent.mkdir(parents=True)
    made.write_text(text, encoding="utf-8")
    shutil.copy(EXECUTE, copy)
    words = [sys.executable, str(copy), str(folder), str(made)]
    return subprocess.run(words, capture_output=True, encoding="utf-8", check=False, timeout=600)


def test_an_error_in_a_cell_ends_the_run(tmp_path: Path) -> None:
    done = run_text("# %%\nimport chordal\n\nchordal.nothing\n", tmp_path)
    assert done.returncode != 0 and "nothing" in done.stderr and not (tmp_path / "made.ipynb").exists()


def colourful(page: Path) -> float:
    """The share of a page's pixels that have a colour, as a browser draws it without network."""
    from PIL import Image

    browser = os.environ.get("CHROMIUM") or shutil.which("chromium")
    if browser is None:
        pytest.skip("there is no Chromium: the page of nbconvert is not drawn")
    words = ["--headless=new", "--no-sandbox", "--enable-unsafe-swiftshader", "--use-angle=swiftshader"]
    words += ["--host-resolver-rules=MAP * ~NOTFOUND", f"--user-data-dir={page.with_suffix('.profile')}", "--window-size=900,700"]
    # The budget is of one process, so the frame stays in it.
    words += ["--disable-features=IsolateSandboxedIframes", "--virtual-time-budget=8000", f"--screenshot={page.with_suffix('.png')}"]
    subprocess.run([browser, *words, page.as_uri()], check=True, capture_output=True, timeout=120)
    with Image.open(page.with_suffix(".png")) as picture:
        seen = np.asarray(picture.convert("RGB"), dtype=np.int64)
    # Chosen: the paint of faces is a bluish grey, 40 and more apart; letters, lines and tables are grey.
    return float(np.mean(seen.max(axis=2) - seen.min(axis=2) > 20))


def test_the_viewer_draws_in_a_page_of_nbconvert_without_network(tmp_path: Path) -> None:
    if _notebook._viewer() is None:
        pytest.skip("the package was built without the viewer of notebooks: make studio-page builds it")
    done = run_text("# %%\nimport chordal\n\nchordal.shapes.sphere(1).mesh(tol=0.05)\n", tmp_path)
    assert done.returncode == 0, done.stderr[-3000:]
    words = [sys.executable, "-m", "nbconvert", "--to", "html", "--log-level=ERROR", str(tmp_path / "made.ipynb")]
    subprocess.run(words, check=True, capture_output=True, timeout=120)
    text = (tmp_path / "made.html").read_text(encoding="utf-8")
    # The ball fills a twentieth of the page, and the letters of code in colours a thousandth.
    for page, drawn in ((text, True), (text.replace("&lt;script&gt;", "&lt;script type=off&gt;"), False)):
        path = tmp_path / f"{drawn}.html"
        path.write_text(page, encoding="utf-8")
        assert (colourful(path) > 1 / 50) is drawn
