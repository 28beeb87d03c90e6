"""Where the output goes when nobody reads it any more."""

from __future__ import annotations

import os
import sys
from contextlib import suppress


def drop_output() -> None:
    """Discard what is still in the buffer of stdout, even when the interpreter flushes it at its end."""
    with suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
