"""The command `chordal` of the package, which is the same as the program that is built without Python."""

import signal
import sys
from typing import NoReturn

from chordal import _chordal
from chordal._batch_child import start


def main() -> NoReturn:
    """Run the command line and end the process with its exit code."""
    # Until the command has its own handler, a signal ends the process without a traceback.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    bridge = [sys.executable, "-m", "chordal._dask_bridge"]
    sys.exit(_chordal.command(["chordal", *sys.argv[1:]], start(_chordal.__file__), bridge))
