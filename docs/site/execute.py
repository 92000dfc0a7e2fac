"""Runs notebooks under a kernel of Jupyter, from top to bottom, and keeps them with all that they have shown.

    python docs/site/execute.py FOLDER [NOTEBOOK …]

Without names it is all of them, save those that FOLDER holds as they are and run with the package as it is.
"""

from __future__ import annotations

import os
import sys
import tempfile
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
NOTEBOOKS = ROOT / "examples" / "notebooks"
#: Seconds that a cell may take. Chosen: ten times what the longest takes, so that only one that hangs is ended.
LONGEST_S = 300


def place(notebook: Path, folder: Path) -> Path:
    """Where a notebook that was run is kept: below the folder as it is below its own."""
    return folder / notebook.relative_to(NOTEBOOKS).with_suffix(".ipynb")


def executed(notebook: Path) -> Any:
    """The notebook with its outputs. An error in a cell is raised."""
    import jupytext
    from nbclient import NotebookClient

    read = jupytext.read(notebook)
    # As Jupyter starts a kernel: in the notebook's own folder. It warns of a connection within this machine.
    settings = {"metadata": {"path": str(notebook.parent)}}
    client = NotebookClient(
        read, timeout=LONGEST_S, kernel_name="python3", resources=settings, extra_arguments=["--log-level=ERROR"]
    )
    # Matrices are small, and threads of BLAS that wait for each other took twelve times as long on two busy processors.
    with tempfile.TemporaryDirectory() as home:
        own = {"OPENBLAS_NUM_THREADS": "1", "IPYTHONDIR": home, "JUPYTER_CONFIG_DIR": home}
        return client.execute(env={**os.environ, **own})


def _is_fresh(notebook: Path, kept: Path) -> bool:
    import chordal

    newest = max(path.stat().st_mtime for path in (notebook, *Path(chordal.__file__).parent.iterdir()))
    return kept.exists() and kept.stat().st_mtime > newest


def main() -> None:
    import nbformat

    folder, names = Path(sys.argv[1]), [Path(name).resolve() for name in sys.argv[2:]]
    for notebook in names or sorted(NOTEBOOKS.rglob("*.py")):
        kept = place(notebook, folder)
        if names or not _is_fresh(notebook, kept):
            kept.parent.mkdir(parents=True, exist_ok=True)
            nbformat.write(executed(notebook), kept)


if __name__ == "__main__":
    main()
