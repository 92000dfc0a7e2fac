"""`python -m chordal` is the command `chordal`."""

from chordal._command import main

if __name__ == "__main__":
    main()
