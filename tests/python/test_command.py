"""The command that comes with the package is the command."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import SQUARE, TEAPOT, Command

import chordal
from chordal import _chordal
from chordal._batch_child import INTERRUPTED, start

SCRIPT = Path(sys.executable).parent / "chordal"


def run(*args: str | Path, stdin: bytes = b"") -> subprocess.CompletedProcess[bytes]:
    return subprocess.run([SCRIPT, *args], input=stdin, capture_output=True, check=False, timeout=300)


@pytest.mark.parametrize(
    "args",
    [
        ["--help"],
        ["mesh", "--help"],
        ["--version"],
        [],
        ["mesh"],
        ["mesh", TEAPOT, "-o", "a.glb"],
        ["mesh", TEAPOT, "-o", "a.glb", "--tol", "-1"],
        ["inspect", "missing.obj"],
        ["inspect", TEAPOT],
        ["inspect", "-", "--from", "obj"],
        ["mesh", "-", "--from", "obj", "--tol", "1", "-o", "-", "--to", "stl", "-q"],
        ["mesh", "-", "--from", "obj", "--triangles", "1", "-o", "-", "--to", "stl", "-q"],
        ["completions", "bash"],
    ],
)
def test_does_what_the_program_does(cargo_chordal: Command, args: list[str | Path]) -> None:
    ours, theirs = run(*args, stdin=SQUARE), cargo_chordal(*args, stdin=SQUARE)
    assert (ours.returncode, ours.stdout, ours.stderr) == (theirs.returncode, theirs.stdout, theirs.stderr)


def test_the_process_of_a_file_ends_with_whoever_holds_its_stdin(tmp_path: Path) -> None:
    (tmp_path / "square.obj").write_bytes(SQUARE)
    words = ["bake", str(tmp_path / "square.obj"), "-o", str(tmp_path / "square.nrrd"), "--cells", "300", "--threads", "1"]
    process = subprocess.Popen([*start(_chordal.__file__), *words], stdin=subprocess.PIPE)
    assert process.stdin is not None
    process.stdin.close()
    assert process.wait(60) == INTERRUPTED and not (tmp_path / "square.nrrd").exists()
    # Without a pipe it ends by itself.
    done = subprocess.run([*start(_chordal.__file__), *words[:4], "--cells", "4"], stdin=subprocess.DEVNULL, check=False)
    assert done.returncode == 0 and (tmp_path / "square.nrrd").exists()


def test_says_the_version_of_the_package() -> None:
    assert run("--version").stdout.decode() == f"chordal {chordal.__version__}\n"


def test_runs_as_a_module() -> None:
    done = subprocess.run([sys.executable, "-m", "chordal", "--version"], capture_output=True, check=True, timeout=60)
    assert done.stdout == run("--version").stdout


@pytest.mark.skipif(sys.platform != "linux", reason="only /proc shows when it waits for signals")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_it_with_130_and_leaves_nothing(tmp_path: Path, number: signal.Signals) -> None:
    # More than any machine has, so that it is not refused for its memory instead.
    args: list[str | Path] = ["mesh", TEAPOT, "--tol", "2e-7", "--max-memory", "1000G"]
    args += ["-o", tmp_path / "a.ply"]
    with subprocess.Popen([SCRIPT, *args], stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        while not waits_for_signals(process.pid):
            assert process.poll() is None, "it ended before anybody asked"
        process.send_signal(number)
        _, stderr = process.communicate(timeout=60)
    assert (process.returncode, stderr) == (130, b"chordal: interrupted\n")
    assert list(tmp_path.iterdir()) == []


def waits_for_signals(pid: int) -> bool:
    try:
        return any((task / "comm").read_text() == "ctrl-c\n" for task in Path(f"/proc/{pid}/task").iterdir())
    except FileNotFoundError:
        return False
