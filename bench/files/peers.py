"""The readers of readers.py in a process that is started again where one of them ends it."""

import json
import selectors
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
# The longest that any of them takes on a file of the folder is 3 s.
MOST_SECONDS = 60


class Peers:
    """Asks readers by name; `{"error": …}` where one cannot read a file."""

    def __init__(self):
        self.process = None

    def start(self):
        """A fresh process."""
        self.process = subprocess.Popen(
            [sys.executable, str(HERE / "readers.py")], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL, text=True,
        )

    def stop(self):
        """Ends the process, if there is one."""
        if self.process is not None:
            self.process.kill()
            self.process.wait()
            self.process = None

    def ask(self, reader, path):
        """What that reader counts."""
        if self.process is None:
            self.start()
        self.process.stdin.write(f"{reader}\t{path}\n")
        self.process.stdin.flush()
        ready = selectors.DefaultSelector()
        ready.register(self.process.stdout, selectors.EVENT_READ)
        line = self.process.stdout.readline() if ready.select(MOST_SECONDS) else ""
        if line:
            return json.loads(line)
        over_time = self.process.poll() is None and not ready.select(0)
        self.stop()
        return {"error": "over time" if over_time else "crashed"}
