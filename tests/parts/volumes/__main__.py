"""Compares the volumes that the scripts name with those that are calculated, or writes them."""

from __future__ import annotations

import argparse
import re
import sys
from pathlib import Path

from . import KINDS
from .solids import Estimate

FOLDER = Path(__file__).resolve().parent.parent
#: A volume and, where it was sampled, its standard error.
LINE = re.compile(r"^# volume: (\S+)(?: # monte carlo, standard error (\S+))?$", re.MULTILINE)


def line_of(volume: float) -> str:
    """The line of a script: seven digits, or as many as its error leaves."""
    error = getattr(volume, "error", 0.0)
    if error == 0:
        return f"# volume: {float(volume):.7g}"
    return f"# volume: {float(volume):.6g} # monte carlo, standard error {error:.1g}"


def main() -> int:
    arguments = argparse.ArgumentParser(prog="volumes", description=__doc__)
    arguments.add_argument("--write", action="store_true", help="write the lines, instead of comparing them")
    arguments.add_argument("parts", nargs="*", help="the names of parts; all of them unless some are named")
    asked = arguments.parse_args()
    known = {path.stem for path in FOLDER.glob("*.star")}
    wrong = 0
    for module in KINDS.values():
        for name in sorted(known & set(vars(module))):
            known.discard(name)
            if asked.parts and name not in asked.parts:
                continue
            volume = getattr(module, name)()
            path = FOLDER / f"{name}.star"
            text = path.read_text(encoding="utf-8")
            if asked.write:
                path.write_text(re.sub(r"^# volume: .*$", line_of(volume), text, flags=re.MULTILINE), encoding="utf-8")
            elif not (found := LINE.search(text)) or line_of(volume) != found.group(0):
                wrong += 1
                print(f"{name}: {found and found.group(0)}, and it is {line_of(volume)}")
            if isinstance(volume, Estimate) and volume.error > 1e-3 * volume:
                wrong += 1
                print(f"{name}: a standard error of {volume.error:.3g} in {float(volume):.6g} is too much")
    for name in sorted(known):
        wrong += 1
        print(f"{name}: no function calculates its volume")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
