"""Command ``amberfield``."""

import signal
import sys

from . import _native


def main() -> None:
    """Run the command with the arguments of this process, and end with its exit code."""
    # The command watches for Ctrl-C itself; Python's own handler would wait for the command to end.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    sys.exit(_native.command(["amberfield", *sys.argv[1:]]))
