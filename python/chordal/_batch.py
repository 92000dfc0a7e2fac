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

from chordal._arguments import number, whole
from chordal._errors import Error
from chordal._hints import keywords_hinted, meant_keyword

_VERBS = ("mesh", "lod", "mend", "bake", "render", "convert", "inspect")
# The exit codes of the command after which the manifest says how each file went: all well, or some not. With others the
# batch could not be done, whatever an earlier one has left.
_DONE = (0, 1)
# What the command says of an option that it does not have.
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
    """One verb for many files: what `chordal batch` does, which goes on where it was interrupted.

    `files` are files, folders or patterns, as in "assets/**/*.glb"; `output` is the folder of the results. `options` are
    those of the verb, in the command's words, as in `["--px", "1"]` or `{"px": 1}`. `to` is the extension of the
    results, `base` the folder that the places of inputs are counted from, `jobs` how many files are done at once, and
    `timeout` the most seconds for one. `redo` does again what was done, and `force` replaces files that no batch wrote.

    `cluster` is the address of a Dask scheduler, as in "tcp://10.0.0.1:8786", or `executor` a `dask.distributed.Client` of it:
    then its workers do the files. They see the same files under the same names and have the same version of Chordal.

    Gives back the last line of the manifest for each file: "input", "output", "exit" (0 where it went well), "error",
    "triangles_out", "bound" and more. Raises `Error` where nothing was begun. It costs a process for each file.
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
    done = subprocess.run([*words, "--", *_words(options)], capture_output=True, text=True, check=False)
    manifest = os.path.join(os.fspath(output), "manifest.jsonl")
    if done.returncode not in _DONE or not os.path.exists(manifest):
        said = done.stderr.strip().removeprefix("chordal: ")
        unknown = _UNKNOWN_OPTION.search(said)
        if unknown is not None:
            raise ValueError(f"options: {verb} has no {unknown[1]!r}: {_meant_option(verb, unknown[1])}")
        raise Error(said)
    last: dict[str, dict[str, Any]] = {}
    with open(manifest, encoding="utf-8") as lines:
        for line in lines:
            row = json.loads(line)
            if isinstance(row.get("input"), str):
                last[row["input"]] = row
    return list(last.values())


def _meant_option(verb: str, name: str) -> str:
    """What stands for an option that the command does not know."""
    import chordal

    known = inspect.signature(getattr(chordal, verb)).parameters
    return meant_keyword(name.replace("-", "_"), [one.name for one in known.values() if one.kind is one.KEYWORD_ONLY])


def _scheduler(executor: Any | None, cluster: str | None) -> str | None:
    """The address of the scheduler, where there is one."""
    if executor is None:
        return cluster
    if cluster is not None:
        raise TypeError("executor, cluster: give one of them")
    # A client and nothing else: each file has a process of its own here, too.
    scheduler = getattr(executor, "scheduler", None)
    if not isinstance(getattr(scheduler, "address", None), str):
        raise TypeError(f"executor: {type(executor).__name__} is no dask.distributed.Client")
    return str(scheduler.address)  # type: ignore[union-attr]


def _words(options: Sequence[str] | Mapping[str, Any]) -> list[str]:
    """Options as the command's words: of `{"tol": 0.1, "normals": True}` they are --tol 0.1 --normals."""
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
