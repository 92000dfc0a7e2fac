"""The process for one file of a batch. It runs the command from its library alone, which takes a tenth of the time of importing
the package and numpy. It is run as a file: `python -I -S _batch_child.py LIBRARY WORD…`."""

import importlib.util
import os
import signal
import stat
import sys
import threading
from typing import Final, NoReturn

#: The exit code of an interrupted command, as in `fault.rs`.
INTERRUPTED: Final = 130


def start(library: str) -> list[str]:
    """The arguments that start such a process; those of the command follow."""
    return [sys.executable, "-I", "-S", os.path.abspath(__file__), library]


def main() -> NoReturn:
    """Runs the command until its end. If stdin is a pipe, the process also ends when its other end is closed, and thus with the
    process that started it; the command itself has an empty stdin."""
    library, *words = sys.argv[1:]
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    if stat.S_ISFIFO(os.fstat(0).st_mode):
        # The pipe is watched through `held`; the command gets an empty stdin in its place, so that it cannot read from the
        # pipe.
        held = os.dup(0)
        empty = os.open(os.devnull, os.O_RDONLY)
        os.dup2(empty, 0)
        os.close(empty)
        threading.Thread(target=_end_with, args=(held,), daemon=True).start()
    spec = importlib.util.spec_from_file_location("chordal._chordal", library)
    assert spec is not None and spec.loader is not None, library
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    sys.exit(module.command(["chordal", *words], [], []))


def _end_with(held: int) -> None:
    os.read(held, 1)
    os._exit(INTERRUPTED)


if __name__ == "__main__":
    main()
