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
    """How it went: `met`, `unmet` (exit code 5, with the best mesh), `slow` (stopped), or `refused` without a mesh."""

    how: str
    said: str = ""
    mesh: Mesh | None = None
    #: What the mesh claims; without an upper end it is infinite.
    at_most: float = float("inf")
    evidence: str = ""

    @property
    def proved(self) -> bool:
        """Whether the budget is met by a bound that is proved."""
        return self.how == "met" and self.evidence.startswith("proved")


def mesh_of(command: str, case: Case, folder: Path, seconds: int) -> Made:
    """The mesh of a case with its bound, if it takes no more seconds of the processor. What the clock says would depend on
    what else the machine does."""
    script, out = folder / f"{case.name}.star", folder / f"{case.name}.ply"
    script.write_text(case.text + "\n")
    asked = ["--tol", repr(case.tol), "--require", "proved", "--keep-best", "--force", "--json", "--max-memory", MEMORY]
    words: list[str | Path] = [command, "mesh", script, "-o", out, *asked]
    limit = lambda: resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 1))  # noqa: E731
    done = subprocess.run(words, capture_output=True, encoding="utf-8", check=False, preexec_fn=limit)
    if done.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
        return Made("slow", f"stopped after {seconds} s of the processor")
    said = f"exit {done.returncode}: {done.stderr.strip()}"
    report = json.loads(done.stdout) if done.returncode in (0, 5) else {}
    if "certificate" not in report:
        return Made("refused", said)
    bound = report["certificate"]["bound"]
    at_most = float("inf") if bound["at_most"] is None else bound["at_most"]
    return Made("unmet" if done.returncode else "met", said, read_ply(out), at_most, bound["evidence"])
