"""Runs that die: of SIGKILL at a given place, or of a file that may not grow.

    python crashes.py DEATHS PROGRAM CELL

`DEATHS` is JSON: a list of {"out": folder, "killed": s} (as soon as the log has the share s of a whole one; below 0 at
once, from 1 on when it has got its name) or
{"out": folder, "full": s} (no file may grow beyond 4 kB and the share s of a whole log, which acts like a full disk;
Python ignores the signal that comes with it). A whole run into `whole` comes first. The answer is a JSON list: status,
words, and how much of the log could be read just before the end.

One process forks them all, so that a death costs a run and not the start of an interpreter.
"""

from __future__ import annotations

import json
import os
import resource
import signal
import sys
import time
from contextlib import suppress
from pathlib import Path
from typing import Any

from gcodesim.cli import main
from gcodesim.log.logfile import LogFile, LogReadError


def readable(out: Path) -> int:
    """Bytes of whole records in the log of a folder."""
    try:
        return LogFile.open(out / "run.mcap").whole
    except (FileNotFoundError, LogReadError):
        return 0


def run(out: Path, program: str, cell: str) -> int:
    return main(["run", program, "--cell", cell, "--out", str(out)])


def has_logged(out: Path, share: float) -> bool:
    """Whether the log of a folder has come to the share of a whole one."""
    if share < 0.0 or (out / "run.mcap").exists():
        return True
    with suppress(FileNotFoundError):
        return share < 1.0 and (out / "run.mcap.part").stat().st_size >= share * os.stat("whole/run.mcap").st_size
    return False


def is_alive(child: int) -> bool:
    """Whether it has not ended; if it has, it can still be killed and waited for."""
    return os.waitid(os.P_PID, child, os.WEXITED | os.WNOHANG | os.WNOWAIT) is None


def die(death: dict[str, Any], program: str, cell: str) -> dict[str, Any]:
    out = Path(death["out"])
    out.mkdir()
    said = out.with_suffix(".txt")
    stream = os.open(said, os.O_WRONLY | os.O_CREAT)  # here, since it may be killed before its first step
    child = os.fork()
    if not child:
        os.dup2(stream, 1)
        os.dup2(stream, 2)
        if "full" in death:
            room = 4096 + int(death["full"] * os.stat("whole/run.mcap").st_size)
            resource.setrlimit(resource.RLIMIT_FSIZE, (room, room))
        status = run(out, program, cell)
        sys.stdout.flush()
        os._exit(status)
    os.close(stream)
    seen = 0
    if "killed" in death:
        while not has_logged(out, death["killed"]) and is_alive(child):
            time.sleep(0.001)
        seen = readable(out)
        os.kill(child, signal.SIGKILL)
    status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    return {"status": status, "said": said.read_text(), "seen": seen}


def deaths(asked: list[dict[str, Any]], program: str, cell: str) -> list[dict[str, Any]]:
    run(Path("warm"), program, cell)
    assert run(Path("whole"), program, cell) == 0
    return [die(death, program, cell) for death in asked]


if __name__ == "__main__":
    answer = deaths(json.loads(sys.argv[1]), *sys.argv[2:])
    print("\nDEATHS", json.dumps(answer))
