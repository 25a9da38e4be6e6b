"""The program `kinetarium`, the same as the one that cargo builds."""

import signal
import sys

from kinetarium._engine import run_program


def main() -> None:
    """Runs the program with the command line of this process."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # Python's own handler waits for Python code
    sys.exit(run_program(["kinetarium", *sys.argv[1:]]))


if __name__ == "__main__":
    main()
