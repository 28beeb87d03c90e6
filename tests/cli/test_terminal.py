"""What only a terminal shows: the progress bar and colours."""

from __future__ import annotations

import fcntl
import os
import pty
import re
import struct
import sys
import termios
from pathlib import Path

import pytest

LONG = "G21 G90 G17 G94\nT1 M6\nG43 H1\nS8000 M3\nG0 X5 Y5\nG0 Z2\nG1 Z-1 F400\n"
LONG += "".join(f"G1 X{5 + 80 * (i % 2)} Y{5 + i / 40:.3f} F1000\n" for i in range(400)) + "G0 Z20\nM5\nM2\n"
COLOUR = re.compile(r"\x1b\[[0-9;]+m")


def shown(*arguments: str, columns: int = 80, **environment: str) -> tuple[int, str]:
    """Exit status and screen output of the command on a terminal of that width."""
    pid, terminal = pty.fork()
    if pid == 0:  # pragma: no cover
        fcntl.ioctl(1, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
        kept = {name: value for name, value in os.environ.items() if name not in ("NO_COLOR", "COLUMNS", "TERM")}
        os.execve(sys.executable, [sys.executable, "-m", "gcodesim", *arguments], {**kept, **environment})
    said = b""
    while True:
        try:
            more = os.read(terminal, 65536)
        except OSError:  # the other end is closed
            break
        if not more:
            break
        said += more
    os.close(terminal)
    return os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]), said.decode()


@pytest.mark.parametrize("columns", [80, 24])
def test_a_bar_with_block_and_time_left(cli, write, tmp_path: Path, columns: int) -> None:
    write("long.nc", LONG)
    status, screen = shown("run", "long.nc", "--cell", "cell.yaml", columns=columns, TERM="xterm")

    assert status == 0
    assert "reading" in screen
    bars = re.findall(r"block (\d+) .*?(\d+) %", COLOUR.sub("", screen))
    assert bars and {int(block) for block, _ in bars} - {0, 1}
    assert max(int(block) for block, _ in bars) <= 408
    if columns == 80:
        assert re.search(r"% +(\d:\d\d:\d\d|-:--:--)", COLOUR.sub("", screen))
    assert screen.rindex("\x1b[?25h") < screen.index("no errors, no warnings")  # it is gone before the verdict


def test_no_bar_and_no_colour_where_they_are_not_wanted(cli, write, tmp_path: Path) -> None:
    write("wrong.nc", LONG.replace("S8000 M3", "M5"))
    arguments = ("run", "wrong.nc", "--cell", "cell.yaml")
    status, coloured = shown(*arguments, TERM="xterm")
    assert status == 1 and "\x1b[31;1merror\x1b[0m GS501" in coloured
    status, plain = shown(*arguments, TERM="xterm", NO_COLOR="1")
    assert status == 1 and " error GS501" in plain and not COLOUR.search(plain)
    status, dumb = shown(*arguments, TERM="dumb")
    assert status == 1 and " error GS501" in dumb and "\x1b" not in dumb
    outcome = cli(*arguments)
    assert outcome.status == 1 and "\x1b" not in outcome.out + outcome.err and "block " not in outcome.err
