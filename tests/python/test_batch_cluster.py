"""`batch` on a Dask cluster of three processes on this machine: as without one, whatever dies meanwhile."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from conftest import SQUARE, TEAPOT

import chordal
from chordal import _batch_job

distributed: Any = pytest.importorskip(
    "distributed", reason="distributed is not installed: batches on a cluster are not tried"
)

#: A verb that takes long, on one thread: distances at some ten million points.
LONG = ["--cells", "250"]


@pytest.fixture(name="cluster", scope="module")
def three_workers() -> Iterator[Any]:
    with distributed.LocalCluster(
        n_workers=3, threads_per_worker=1, processes=True, dashboard_address=":0", silence_logs=50
    ) as cluster:
        with distributed.Client(cluster) as client:
            client.run(_find_chordal, sys.path)
        yield cluster


def _find_chordal(path: list[str]) -> None:
    """The workers look for modules where this process does."""
    sys.path[:] = path


@pytest.fixture(name="inputs")
def teapots(tmp_path: Path) -> Path:
    (tmp_path / "in").mkdir()
    for number in range(8):
        (tmp_path / "in" / f"{number}.bpt").write_bytes(TEAPOT.read_bytes())
    (tmp_path / "in" / "wrong.obj").write_bytes(b"v 0 0 0\nf 1 2 3\n")
    (tmp_path / "in" / "square ä.obj").write_bytes(SQUARE)
    (tmp_path / "in" / os.fsdecode(b"no unicode \xff.obj")).write_bytes(SQUARE)
    (tmp_path / "in" / "gone.obj").symlink_to("nowhere")
    return tmp_path


def start(folder: Path, cluster: Any, *words: str) -> subprocess.Popen[str]:
    """A batch as a process, inside a folder."""
    return subprocess.Popen(
        [sys.executable, "-m", "chordal", "batch", *words[:3], "--dask", cluster.scheduler_address, *words[3:]],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        encoding="utf-8",
    )


def lines(folder: Path) -> list[dict[str, Any]]:
    path = folder / "manifest.jsonl"
    return [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []


def until(what: str, holds: Callable[[], object]) -> None:
    started = time.monotonic()
    while not holds():
        assert time.monotonic() < started + 60, f"{what} did not come"
        time.sleep(0.02)


def processes(word: str) -> list[int]:
    """The processes of files that have a word in their command line, by what Linux says of all."""
    found = []
    for path in Path("/proc").glob("[0-9]*/cmdline"):
        with contextlib.suppress(OSError):
            words = path.read_bytes().split(b"\0")
            if any(one.endswith(b"_batch_child.py") for one in words) and any(os.fsencode(word) in one for one in words):
                found.append(int(path.parent.name))
    return sorted(found)


def parent(process: int) -> int:
    return int(Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()[1])


def outputs(folder: Path) -> dict[str, bytes]:
    found = {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    return {name: data for name, data in found.items() if name not in ("manifest.jsonl", ".chordal-batch/lock")}


def test_files_and_lines_are_those_of_a_batch_without_a_cluster(inputs: Path, cluster: Any) -> None:
    arguments: Any = {"options": ["--tol", "0.1%"], "base": inputs / "in", "to": "obj"}
    here = chordal.batch("mesh", inputs / "in", inputs / "here", **arguments)
    there = chordal.batch("mesh", inputs / "in", inputs / "there", cluster=cluster.scheduler_address, **arguments)
    assert len(there) == 12 and sum(row["exit"] == 0 for row in there) == 10
    for row in (*here, *there):
        row["seconds"] = 0
    by_input: Any = {"key": lambda row: row["input"]}
    assert sorted(here, **by_input) == sorted(there, **by_input)
    assert outputs(inputs / "here") == outputs(inputs / "there")
    # Again: nothing but what went wrong.
    with distributed.Client(cluster) as client:
        assert chordal.batch("mesh", inputs / "in", inputs / "there", executor=client, **arguments)
    assert sorted(row["input"] for row in lines(inputs / "there")[12:]) == ["gone.obj", "wrong.obj"]


def test_files_beside_an_output_and_reports_come_along(tmp_path: Path, cluster: Any) -> None:
    painted = Path(__file__).parents[1] / "web" / "painted.gltf"
    (tmp_path / "a.gltf").write_bytes(painted.read_bytes())
    for verb, to in (("convert", "obj"), ("inspect", None)):
        arguments: Any = {"to": to, "base": tmp_path}
        chordal.batch(verb, tmp_path / "a.gltf", tmp_path / f"here-{verb}", **arguments)  # type: ignore[arg-type]
        there = tmp_path / f"there-{verb}"
        chordal.batch(verb, tmp_path / "a.gltf", there, cluster=cluster.scheduler_address, **arguments)  # type: ignore[arg-type]
        made = outputs(there)
        if verb == "convert":
            assert made == outputs(tmp_path / f"here-{verb}") and len(made) > 2
        else:
            assert json.loads(made["a.json"])["certificate"]


def test_a_worker_that_is_killed_loses_no_file(tmp_path: Path, cluster: Any) -> None:
    for number in range(6):
        (tmp_path / f"{number}.obj").write_bytes(SQUARE)
    batch = start(tmp_path, cluster, "bake", "*.obj", "-oout", "--", "--cells", "100")
    until("a process", lambda: processes("0.obj"))
    with distributed.Client(cluster) as client:
        pids = client.run(os.getpid)
    victim, *_ = processes("0.obj")
    worker = parent(victim)
    assert worker in pids.values()
    os.kill(worker, signal.SIGKILL)
    # What it had started ends with it.
    until("the end of its process", lambda: not Path(f"/proc/{victim}").exists())
    told = batch.communicate(timeout=60)
    assert batch.returncode == 0, told
    assert sorted(row["input"] for row in lines(tmp_path / "out")) == [f"{number}.obj" for number in range(6)]
    assert len(set(outputs(tmp_path / "out").values())) == 1


def test_a_file_whose_workers_are_all_killed_has_a_line_that_says_so(tmp_path: Path, cluster: Any) -> None:
    for number in range(6):
        (tmp_path / f"{number}.obj").write_bytes(SQUARE)
    before, cluster.scheduler.allowed_failures = cluster.scheduler.allowed_failures, 0
    batch = start(tmp_path, cluster, "bake", "*.obj", "-oout", "--jobs", "3", "--", "--cells", "100")
    until("a process", lambda: processes("0.obj"))
    os.kill(parent(processes("0.obj")[0]), signal.SIGKILL)
    told = batch.communicate(timeout=60)
    cluster.scheduler.allowed_failures = before
    assert batch.returncode == 1, told
    rows = {row["input"]: row for row in lines(tmp_path / "out")}
    killed = rows["0.obj"]
    assert len(rows) == 6 and (killed["exit"], killed["code"]) == (None, "killed-worker") and "tcp://" in killed["error"]
    assert [name for name, row in rows.items() if row["exit"] != 0] == ["0.obj"]


def test_no_more_files_are_done_at_once_than_is_said(tmp_path: Path, cluster: Any) -> None:
    for number in range(3):
        (tmp_path / f"{number}.obj").write_bytes(SQUARE)
    batch = start(tmp_path, cluster, "bake", "*.obj", "-oout", "--jobs", "1", "--", "--cells", "60")
    counts = set()
    while batch.poll() is None:
        counts.add(len(processes(f"{tmp_path.name}/out")))
    assert batch.communicate() and batch.returncode == 0 and counts == {0, 1}


def test_a_scheduler_that_goes_away_loses_nothing(tmp_path: Path) -> None:
    for number in range(4):
        (tmp_path / f"{number}.obj").write_bytes(SQUARE)
    words = ("bake", "*.obj", "-oout", "--", "--cells", "100")
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=1, processes=True, dashboard_address=":0", silence_logs=50
    ) as cluster:
        with distributed.Client(cluster) as client:
            client.run(_find_chordal, sys.path)
        batch = start(tmp_path, cluster, *words)
        until("a line", lambda: lines(tmp_path / "out"))
    told = batch.communicate(timeout=60)
    assert batch.returncode == 4 and "the Dask scheduler is gone" in told[1], told
    done = lines(tmp_path / "out")
    assert 0 < len(done) < 4 and all(row["exit"] == 0 for row in done)
    until("the end of all processes", lambda: not processes(f"{tmp_path.name}/out"))
    assert len(chordal.batch("bake", tmp_path / "*.obj", tmp_path / "out", options=["--cells", "100"], base=tmp_path)) == 4
    assert len(outputs(tmp_path / "out")) == 4


def test_a_worker_that_sees_other_files_or_has_another_version_is_named(tmp_path: Path, cluster: Any) -> None:
    (tmp_path / "a.obj").write_bytes(SQUARE)
    # The same name is another folder for each process.
    odd = os.fsdecode(b"no unicode \xff.obj")
    (tmp_path / odd).write_bytes(SQUARE)
    for inputs, output in (
        ("/proc/self/cwd/a.obj", "out"),
        ("a.obj", "/proc/self/cwd/out"),
        (f"/proc/self/cwd/{odd}", "out"),
    ):
        batch = start(tmp_path, cluster, "convert", inputs, f"-o{output}")
        _, told = batch.communicate(timeout=60)
        assert batch.returncode == 4 and "worker tcp://" in told and "does not see the f" in told, told
        assert "/proc/self/cwd/" in told and socket.gethostname() in told and not lines(tmp_path / "out")
    with distributed.Client(cluster) as client:
        job: Any = {"version": "0.0.9", "cwd": str(tmp_path), "work": str(tmp_path)}
        said = client.submit(_batch_job.do_job, job).result()
    assert f"has Chordal {chordal.__version__}, and this batch is of 0.0.9" in said["fault"]


def test_a_file_that_takes_too_long_is_stopped_there(tmp_path: Path, cluster: Any) -> None:
    (tmp_path / "a.obj").write_bytes(SQUARE)
    row, *more = chordal.batch(
        "bake", tmp_path / "a.obj", tmp_path / "out", options=LONG, timeout=0.4, cluster=cluster.scheduler_address
    )
    assert not more and row["exit"] is None and "0.4 s" in row["error"] and row["seconds"] >= 0.4
    assert not processes("a.obj") and not outputs(tmp_path / "out")


@pytest.mark.parametrize("how", ["SIGINT", "SIGTERM", "SIGKILL"])
def test_a_batch_that_is_stopped_leaves_no_process_and_goes_on(tmp_path: Path, cluster: Any, how: str) -> None:
    for number in range(4):
        (tmp_path / f"{number}.obj").write_bytes(SQUARE)
    words = ("bake", "*.obj", "-oout", "--", "--cells", "120")
    batch = start(tmp_path, cluster, *words)
    until("a line", lambda: lines(tmp_path / "out"))
    until("a process", lambda: processes(f"{tmp_path.name}/out"))
    # One that would not end by itself.
    os.kill(processes(f"{tmp_path.name}/out")[-1], signal.SIGSTOP)
    batch.send_signal(getattr(signal, how))
    stdout, stderr = batch.communicate(timeout=60)
    done = lines(tmp_path / "out")
    if how != "SIGKILL":
        assert (batch.returncode, stdout, stderr) == (130, "", "chordal: interrupted\n")
    assert 0 < len(done) < 4 and all(row["exit"] == 0 for row in done)
    until("the end of all processes", lambda: not processes(f"{tmp_path.name}/out"))
    again = start(tmp_path, cluster, *words)
    told = again.communicate(timeout=60)
    assert again.returncode == 0, told
    assert len({row["input"] for row in lines(tmp_path / "out")}) == len(outputs(tmp_path / "out")) == 4


def test_what_the_cluster_cannot_do_is_said_in_a_sentence(tmp_path: Path, cluster: Any) -> None:
    (tmp_path / "a.obj").write_bytes(SQUARE)
    for address, part in (("nowhere", "nowhere: no Dask scheduler"), ("tcp://127.0.0.1:1", "tcp://127.0.0.1:1: no Dask")):
        with pytest.raises(chordal.Error, match=part):
            chordal.batch("convert", tmp_path / "a.obj", tmp_path / "out", cluster=address)
    assert not lines(tmp_path / "out")
    with pytest.raises(TypeError, match="executor, cluster"):
        chordal.batch("convert", tmp_path / "a.obj", tmp_path / "out", cluster="tcp://a:1", executor=object())
    with pytest.raises(TypeError, match="executor"):
        chordal.batch("convert", tmp_path / "a.obj", tmp_path / "out", executor=object())
    rows = chordal.batch("convert", tmp_path / "a.obj", tmp_path / "out", cluster=cluster.scheduler_address)
    assert [row["exit"] for row in rows] == [0]
