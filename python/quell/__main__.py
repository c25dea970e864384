"""The command line: `quell`, or `python -m quell`."""

from __future__ import annotations

import signal
import sys


def main() -> int:
    """
    Run the command that the process was started with.

    Returns
    -------
    int
        The exit code: 0 done, 1 failed, 2 bad input.
    """
    from ._quell import main as run

    # The command line is not Python: an interrupt ends it as any program.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return run(["quell", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
