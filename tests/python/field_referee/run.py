"""What the command makes of a script."""

from __future__ import annotations

import json
import resource
import signal
import subprocess
from dataclasses import dataclass
from pathlib import Path

from .mesh import Mesh, read_ply
from .random_scripts import Case

#: Memory that the command may use for one case.
MEMORY = "2G"


@dataclass(frozen=True)
class Made:
    """How it went: `met`, `unmet` (exit code 5), `slow` (stopped), or `refused` with another exit code."""

    how: str
    said: str = ""
    mesh: Mesh | None = None
    at_most: float = float("inf")
    evidence: str = ""


def mesh_of(command: str, case: Case, folder: Path, seconds: int) -> Made:
    """The mesh of a case with its bound, if it takes no more seconds of the processor. What the clock says would depend on
    what else the machine does."""
    script, out = folder / f"{case.name}.star", folder / f"{case.name}.ply"
    script.write_text(case.text + "\n")
    asked = ["--tol", repr(case.tol), "--force", "--json", "--max-memory", MEMORY]
    words: list[str | Path] = [command, "mesh", script, "-o", out, *asked]
    limit = lambda: resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 1))  # noqa: E731
    done = subprocess.run(words, capture_output=True, text=True, check=False, preexec_fn=limit)
    if done.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
        return Made("slow", f"stopped after {seconds} s of the processor")
    if done.returncode:
        return Made("unmet" if done.returncode == 5 else "refused", f"exit {done.returncode}: {done.stderr.strip()}")
    bound = json.loads(done.stdout)["certificate"]["bound"]
    return Made("met", done.stderr.strip(), read_ply(out), bound["at_most"], bound["evidence"])
