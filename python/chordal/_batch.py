"""`batch`: one verb for many files, each in a process of its own."""

from __future__ import annotations

import inspect
import json
import os
import re
import subprocess
import sys
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Literal, SupportsFloat, SupportsIndex

from chordal import _verbs
from chordal._arguments import number, whole
from chordal._errors import Error
from chordal._hints import keywords_hinted, meant_keyword

_VERBS = ("mesh", "lod", "mend", "bake", "render", "convert", "inspect")
# The exit codes after which the manifest has the result of each file: all succeeded, or some failed. With other codes the batch
# itself failed, and a manifest is that of an earlier one.
_DONE = (0, 1)
# The command's message for an unknown option.
_UNKNOWN_OPTION = re.compile(r"unexpected argument '--([\w-]+)")


@keywords_hinted
def batch(
    verb: Literal["mesh", "lod", "mend", "bake", "render", "convert", "inspect"],
    files: str | os.PathLike[str] | Iterable[str | os.PathLike[str]],
    output: str | os.PathLike[str],
    *,
    options: Sequence[str] | Mapping[str, Any] = (),
    to: str | None = None,
    base: str | os.PathLike[str] | None = None,
    jobs: SupportsIndex | None = None,
    timeout: SupportsFloat | None = None,
    redo: bool = False,
    force: bool = False,
    executor: Any | None = None,
    cluster: str | None = None,
) -> list[dict[str, Any]]:
    """Runs one verb on many files, as `chordal batch` does. An interrupted batch is resumed.

    `files` are files, folders or patterns, as in "assets/**/*.glb"; `output` is the folder of the results. `options` are
    those of the verb, as for the command: `["--px", "1"]` or `{"px": 1}`. `to` is the extension of the results, `base` the
    folder to which the paths of inputs are relative, `jobs` the number of files that are processed at once, and `timeout`
    the most seconds for one file. `redo` processes finished files again, and `force` replaces files that no batch wrote.

    With `cluster`, the address of a Dask scheduler as in "tcp://10.0.0.1:8786", or with `executor`, a `dask.distributed.Client`
    of it, the workers process the files. They need the same files under the same names, and the same version of Chordal.

    Returns the last line of the manifest for each file: "input", "output", "exit" (0 for success), "error",
    "triangles_out", "bound" and more. Raises `Error` if the batch could not start. The cost is a process for each file.
    """
    if verb not in _VERBS:
        raise ValueError(f"verb: one of {', '.join(_VERBS)}, not {verb!r}")
    inputs = [files] if isinstance(files, (str, os.PathLike)) else list(files)
    words = [sys.executable, "-m", "chordal", "batch", verb, *(os.fspath(file) for file in inputs), "-o", os.fspath(output)]
    words += ["--redo"] * redo + ["--force"] * force
    for name, value in (("to", to), ("base", base)):
        words += [] if value is None else [f"--{name}", os.fspath(value)]
    address = _scheduler(executor, cluster)
    words += [] if address is None else ["--dask", address]
    words += [] if jobs is None else ["--jobs", str(whole("jobs", jobs))]
    words += [] if timeout is None else ["--timeout", repr(number("timeout", timeout))]
    done = subprocess.run([*words, "--", *_words(options)], capture_output=True, encoding="utf-8", check=False)
    manifest = os.path.join(os.fspath(output), "manifest.jsonl")
    if done.returncode not in _DONE or not os.path.exists(manifest):
        message = done.stderr.strip().removeprefix("chordal: ")
        unknown = _UNKNOWN_OPTION.search(message)
        if unknown is not None:
            raise ValueError(f"options: {verb} has no {unknown[1]!r}: {_meant_option(verb, unknown[1])}")
        raise Error(message)
    # A file that was done again has a further line, and the last one counts.
    last: dict[str, dict[str, Any]] = {}
    with open(manifest, encoding="utf-8") as lines:
        for line in lines:
            row = json.loads(line)
            if isinstance(row.get("input"), str):
                last[row["input"]] = row
    return list(last.values())


def _meant_option(verb: str, name: str) -> str:
    """A hint at the option that is meant by an unknown one."""
    parameters = inspect.signature(getattr(_verbs, verb)).parameters.values()
    return meant_keyword(name.replace("-", "_"), [p.name for p in parameters if p.kind is p.KEYWORD_ONLY])


def _scheduler(executor: Any | None, cluster: str | None) -> str | None:
    """The address of the scheduler, if there is one."""
    if executor is None:
        return cluster
    if cluster is not None:
        raise TypeError("executor, cluster: give one of them")
    # Only a client of Dask: other executors are of no use, since each file gets a process of its own here anyway.
    scheduler = getattr(executor, "scheduler", None)
    if not isinstance(getattr(scheduler, "address", None), str):
        raise TypeError(f"executor: {type(executor).__name__} is no dask.distributed.Client")
    return str(scheduler.address)  # type: ignore[union-attr]


def _words(options: Sequence[str] | Mapping[str, Any]) -> list[str]:
    """Options as arguments of the command: `{"tol": 0.1, "normals": True}` becomes --tol 0.1 --normals."""
    if isinstance(options, str):
        raise TypeError(f'options: words, as in ["--tol", "0.1"], or {{"tol": 0.1}}, not {options!r}')
    if not isinstance(options, Mapping):
        return list(options)
    words: list[str] = []
    for name, value in options.items():
        if value is None or value is False:
            continue
        words.append("--" + str(name).lstrip("-").replace("_", "-"))
        words += [] if value is True else [str(value)]
    return words
