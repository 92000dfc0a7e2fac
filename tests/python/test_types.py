"""What an editor knows of the package: pyright takes its types for whole, and programs that use it for right."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from conftest import ROOT
from test_docs import PAGES

import chordal

#: Programs as users write them, judged as strictly as there is.
STRICT = ("tests/python/smoke.py", "tests/python/typed.py")


def pyright(*words: str, folder: Path) -> tuple[int, dict[str, Any]]:
    """Runs pyright on the package that is imported here; skips where it or its Node is not there."""
    pytest.importorskip("pyright", reason="pyright is not installed")
    if shutil.which("node") is None:
        pytest.skip("there is no Node, which pyright runs in")
    # It has all that it needs, and asks nobody whether there is a newer one.
    own = {"PYRIGHT_PYTHON_IGNORE_WARNINGS": "1", "PYTHONPATH": os.pathsep.join(sys.path)}
    command = [sys.executable, "-m", "pyright", "--outputjson", *words]
    done = subprocess.run(command, cwd=folder, env=os.environ | own, capture_output=True, encoding="utf-8", timeout=300, check=False)
    found: dict[str, Any] = json.loads(done.stdout)
    return done.returncode, found


def judged(files: dict[str, str], mode: str, folder: Path) -> list[str]:
    """The places of errors in some programs, with the errors."""
    for name, code in files.items():
        (folder / name).write_text(code, encoding="utf-8")
    # A star takes all words of shape scripts, as these pages say.
    settings = {"typeCheckingMode": mode, "pythonVersion": "3.10", "reportWildcardImportFromLibrary": False}
    (folder / "pyrightconfig.json").write_text(json.dumps(settings), encoding="utf-8")
    _, found = pyright("--pythonpath", sys.executable, folder=folder)
    return [
        f"{Path(one['file']).name}:{one['range']['start']['line'] + 1}: {one['message']}"
        for one in found["generalDiagnostics"]
        if one["severity"] == "error"
    ]


def test_all_types_of_the_package_are_known(tmp_path: Path) -> None:
    code, found = pyright("--pythonpath", sys.executable, "--verifytypes", "chordal", "--ignoreexternal", folder=tmp_path)
    facts = found["typeCompleteness"]
    assert Path(facts["packageRootDirectory"]).samefile(Path(chordal.__path__[0]))
    unknown = [one["name"] for one in facts["symbols"] if one["isExported"] and not one["isTypeKnown"]]
    assert facts["completenessScore"] == 1 and not unknown and code == 0, unknown


def test_programs_are_right_when_judged_strictly(tmp_path: Path) -> None:
    files = {Path(name).name: (ROOT / name).read_text(encoding="utf-8") for name in STRICT}
    assert judged(files, "strict", tmp_path) == []


def test_examples_of_the_pages_are_right(tmp_path: Path) -> None:
    files = {}
    for page in PAGES:
        blocks = (ROOT / page).read_text(encoding="utf-8").split("```python\n")[1:]
        for number, block in enumerate(blocks, 1):
            code = block.split("```")[0]
            if "import chordal" in code or "from chordal" in code:
                files[f"{Path(page).stem}_{number}.py".replace("-", "_")] = code
    assert len(files) > 20 and judged(files, "standard", tmp_path) == []


def test_wrong_programs_are_found(tmp_path: Path) -> None:
    code = 'import chordal\nchordal.load("a.stl", format="stl").vertice\nchordal.mesh("a.stl", tolerance=1)\n'
    assert [line.split(":")[1] for line in judged({"wrong.py": code}, "standard", tmp_path)] == ["2", "3"]
