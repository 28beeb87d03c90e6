"""`gcodesim` and `python -m gcodesim`."""

import os
import signal
import sys
from types import FrameType


def main() -> int:
    """Run the command line; returns its status. A Ctrl-C ends it in order also while its modules are being loaded."""
    # numpy's BLAS keeps a thread for each core that waits for work by spinning; no sum of ours goes there
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    _fill_standard_streams()
    heard = signal.getsignal(signal.SIGINT) is signal.default_int_handler  # in the background it is ignored
    if heard:
        signal.signal(signal.SIGINT, _leave)
    from gcodesim.cli import main as run

    if heard:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    return run()


def _fill_standard_streams() -> None:
    """Nothing stands where the input or stderr is closed; else the next file opened would get its number.

    A worker would then write what it says of itself into a pipe to another process. A closed stdout is told of.
    """
    for number in (0, 2):
        try:
            os.fstat(number)
        except OSError:
            nothing = os.open(os.devnull, os.O_RDWR)
            if nothing != number:
                os.dup2(nothing, number)
                os.close(nothing)
            else:
                os.set_inheritable(number, True)


def _leave(number: int, frame: FrameType | None) -> None:
    """End at once: nothing is open yet, and an exception might come where the interpreter passes over it."""
    os.write(2, b"gcodesim: interrupted\n")
    os._exit(130)


if __name__ == "__main__":
    sys.exit(main())
