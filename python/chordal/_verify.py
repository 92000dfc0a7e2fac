"""`verify`: the certificate of a written file, proved again."""

import json
import subprocess
import sys
from collections.abc import Mapping, Sequence
from os import PathLike, fspath

from chordal._errors import ReadError
from chordal._report import Report

__all__ = ["verify"]

# The exit codes of the command with a verdict in its report.
_JUDGED = (0, 1, 6)


def verify(
    path: str | PathLike[str],
    against: str | PathLike[str] | Sequence[str | PathLike[str]],
    *,
    certificate: str | PathLike[str] | None = None,
    options: Mapping[str, str] | None = None,
) -> Report:
    """Prove the certificate of the file at `path` again, from the file or the files that it was made of.

    `certificate` is a report for formats that hold none, and `options` are more options of the command by their
    names, as in `{"surface": "catmull-clark"}`. The verdict is "re-proved", "not re-proved" or "refuted"; every claim
    has one of its own. It runs the command in a process of its own, since judges may take long.
    """
    files = [against] if isinstance(against, (str, PathLike)) else against
    wrong = next((one for one in files if not isinstance(one, (str, PathLike))), None) if isinstance(files, Sequence) else files
    if wrong is not None:
        raise TypeError(f"against: the path of the file that it was made of, or a list of them, not {type(wrong).__name__}")
    words = [sys.executable, "-m", "chordal", "verify", fspath(path), "--json"]
    for name, value in (options or {}).items():
        words.append(f"--{name}={value}")
    if certificate is not None:
        words += ["--certificate", fspath(certificate)]
    words += ["--against", *(fspath(file) for file in files)]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode not in _JUDGED:
        raise ReadError("unverifiable", None, done.stderr.strip().removeprefix("chordal: "))
    return Report(json.loads(done.stdout))
