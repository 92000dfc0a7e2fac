"""`python -m chordal` is the command `chordal`."""

from chordal._command import main

main()
