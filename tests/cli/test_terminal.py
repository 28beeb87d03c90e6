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
OWN = ("NO_COLOR", "FORCE_COLOR", "COLUMNS", "TERM")
COLOUR = re.compile(r"\x1b\[[0-9;]+m")


def shown(*arguments: str, columns: int = 80, **environment: str) -> tuple[int, str]:
    """Exit status and screen output of the command on a terminal of that width."""
    pid, terminal = pty.fork()
    if pid == 0:  # pragma: no cover
        fcntl.ioctl(1, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
        kept = {name: value for name, value in os.environ.items() if name not in OWN}
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
    assert status == 1 and "\x1b[31;1merror GS501\x1b[0m" in coloured
    status, plain = shown(*arguments, TERM="xterm", NO_COLOR="1")
    assert status == 1 and " error GS501" in plain and not COLOUR.search(plain)
    status, dumb = shown(*arguments, TERM="dumb")
    assert status == 1 and " error GS501" in dumb and "\x1b" not in dumb
    outcome = cli(*arguments)
    assert outcome.status == 1 and "\x1b" not in outcome.out + outcome.err and "block " not in outcome.err


BOLD, CYAN, RED, BLUE, LABEL, END = (f"\x1b[{code}m" for code in ("1", "36", "31;1", "34;1", "36;1", "0"))
CALLING = "G21 G90\nT1 M6\no100 sub\n  G1 X5\no100 endsub\no100 call\nG1 X\nM2\n"


def test_the_picture_of_findings_in_colour(cli, write, monkeypatch: pytest.MonkeyPatch) -> None:
    """Path, place, severity with its code, caret and labels, character by character."""
    write("calling.nc", CALLING)
    monkeypatch.setenv("FORCE_COLOR", "1")
    done = cli("lint", "calling.nc")

    assert done.status == 1
    assert done.out == (
        f"{BOLD}calling.nc{END}{CYAN}:4:3{END}: {RED}error GS107{END}: G1 without a feed: F is 0\n"
        f"  {BLUE}4 |{END}   G1 X5\n"
        f"  {BLUE}  |{END}   {RED}^^{END}\n"
        f"  {LABEL}called from{END} calling.nc:6 (o100)\n"
        f"  {LABEL}hint:{END} write F before or in this block\n"
        f"{BOLD}calling.nc{END}{CYAN}:7:4{END}: {RED}error GS004{END}: X has no number\n"
        f"  {BLUE}7 |{END} G1 X\n"
        f"  {BLUE}  |{END}    {RED}^{END}\n"
        f"  {LABEL}hint:{END} write a number after X, or drop the word\n"
        f"{BOLD}calling.nc{END}: {RED}2 errors{END}, no warnings\n"
    )
    monkeypatch.delenv("FORCE_COLOR")
    assert cli("lint", "calling.nc").out == COLOUR.sub("", done.out)


@pytest.mark.parametrize(
    ("environment", "expected"),
    [
        ({}, False),
        ({"FORCE_COLOR": "1"}, True),
        ({"FORCE_COLOR": ""}, False),
        ({"FORCE_COLOR": "1", "TERM": "dumb"}, True),
        ({"FORCE_COLOR": "1", "NO_COLOR": "1"}, False),
        ({"NO_COLOR": "", "FORCE_COLOR": "3"}, True),
    ],
)
def test_who_decides_about_colour_in_a_pipe(cli, write, monkeypatch, environment, expected: bool) -> None:
    write("wrong.nc", "G21 G90\nG1 X\nM2\n")
    for name, value in environment.items():
        monkeypatch.setenv(name, value)

    for command in (("lint", "wrong.nc"), ("canon", "wrong.nc"), ("check", "wrong.nc", "--cell", "cell.yaml")):
        done = cli(*command)
        assert done.status == 1 and ("\x1b[31;1merror GS" in done.out) == expected
    assert "\x1b" not in cli("lint", "wrong.nc", "--format", "json").out


def test_a_stranger_gets_no_colours_of_his_own(cli, write, monkeypatch: pytest.MonkeyPatch) -> None:
    write("ev\x1b[2Jil.nc", "G21 G90\n(\x1b[2J\n::stop-commands::x) G1 X\x1b[31m\nM2\n")
    monkeypatch.setenv("FORCE_COLOR", "1")
    done = cli("lint", "ev\x1b[2Jil.nc")

    assert done.status == 1
    assert "\x1b" not in COLOUR.sub("", done.out)
    assert set(COLOUR.findall(done.out)) <= {BOLD, CYAN, RED, BLUE, LABEL, END}


def test_a_suite_in_colour(cli, write, monkeypatch: pytest.MonkeyPatch) -> None:
    write("wrong.nc", LONG.replace("S8000 M3", "M5"))
    write("wrong.test.yaml", "cell: cell.yaml\n")
    monkeypatch.setenv("FORCE_COLOR", "1")
    done = cli("test", ".")

    assert done.status == 1
    assert f"{RED}FAILED{END} wrong\n" in done.out and f"{RED}error GS501{END}" in done.out
    assert f"{RED}1 failed{END}" in done.out
