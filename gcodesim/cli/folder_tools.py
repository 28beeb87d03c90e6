"""Commands on the files of one folder, for programs that ask: each is the command line in a process of its own."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable, Coroutine, Iterator
from contextvars import ContextVar
from dataclasses import dataclass, field
from functools import partial, wraps
from pathlib import Path
from typing import Any, Final

from gcodesim.cli.exits import USAGE
from gcodesim.diagnostics.plain import plain_tree

LONGEST: Final = 600.0
"""Seconds after which a command is ended."""

Answer = dict[str, Any]


@dataclass(eq=False)
class _Call:
    """What a call of a tool has started; `stopped`: nobody waits for it any more."""

    processes: list[subprocess.Popen[bytes]] = field(default_factory=list)
    stopped: bool = False

    def started(self, process: subprocess.Popen[bytes]) -> None:
        self.processes.append(process)
        if self.stopped:
            process.kill()

    def stop(self) -> None:
        self.stopped = True
        for process in self.processes:
            process.kill()


_CALL: Final[ContextVar[_Call]] = ContextVar("call")
_CALLS: Final[set[_Call]] = set()
"""Those that a server waits for."""


class OutsideError(ValueError):
    """A path leads out of the folder; the text names it."""


class FolderTools:
    """lint, check, run, diff and explain in `folder`. Answers have `exit_status`, `output` and `messages`.

    `output` is what the command prints with `--format json`, so findings are those of the command line; of `explain` it
    is text. Paths are relative to the folder; one that leads out of it, also by a link or by the `packages:` of a cell,
    is refused with exit status 2, and nothing is read.
    """

    def __init__(self, folder: Path, longest: float = LONGEST) -> None:
        self._folder, self._longest = folder.resolve(strict=True), longest

    def lint(self, program: str, cell: str = "", dialect: str = "") -> Answer:
        """Find every fault of a G-code program; with `cell`, its tools, offsets and M-codes are known.

        `dialect` is the language of the control, such as fanuc, grbl or marlin; without it that of the cell, else
        linuxcnc.
        """
        return self._asked("lint", program, cell=cell, dialect=dialect)

    def check(self, program: str, cell: str) -> Answer:
        """Find what is wrong with a program in a cell, without material: limits, reach, collisions, time."""
        return self._asked("check", program, cell=cell)

    def run(self, program: str, cell: str, out: str = "out") -> Answer:
        """Simulate a program in a cell, with material and forces; log and results are written into the folder `out`."""
        return self._asked("run", program, cell=cell, out=out)

    def diff(self, old: str, new: str, cell: str = "") -> Answer:
        """Compare two programs, folders of runs, results or logs; with `cell`, both programs are run in it."""
        return self._asked("diff", old, new, cell=cell)

    def explain(self, code: str) -> Answer:
        """What a finding such as GS203 means, why it matters and what to do."""
        if code.startswith("-") or not code.strip():
            return _refused(f"`{code}` is no code of a finding")
        return self._done(["explain", code], as_json=False)

    def _asked(self, command: str, *paths: str, cell: str, out: str = "", dialect: str = "") -> Answer:
        try:
            words = [command, *(self._inside(path) for path in paths)]
            if cell:
                words += ["--cell", self._inside(cell)]
                self._look_into(self._folder / cell)
            if out:
                words += ["--out", self._inside(out)]
            if dialect:
                words.append(f"--dialect={dialect}")
        except OutsideError as outside:
            return _refused(str(outside))
        return self._done([*words, "--format", "json"], as_json=True)

    def _inside(self, path: str) -> str:
        """The path below the folder, in a form that is no option."""
        if "\0" in path or not (self._folder / path).resolve().is_relative_to(self._folder):
            raise OutsideError(f"`{path}` is outside the folder that is served")
        return f"./{(self._folder / path).resolve().relative_to(self._folder).as_posix()}"

    def _look_into(self, cell: Path) -> None:
        """Folders that a cell names for packages, programs and stocks may be anywhere on the command line; here not."""
        from ruamel.yaml import YAML
        from ruamel.yaml.error import YAMLError

        try:
            keys = YAML(typ="safe", pure=True).load(cell.read_bytes())
        except (OSError, ValueError, YAMLError):
            return  # the command says what is wrong with it
        for text in _texts(keys):
            if ("/" in text or "\\" in text or ".." in text) and not _stays(cell.parent / text, self._folder):
                raise OutsideError(f"`{text}` in {cell.name} is outside the folder that is served")

    def _done(self, words: list[str], *, as_json: bool) -> Answer:
        # -P: a file of the folder is never taken for a module of Python
        command = [sys.executable, "-P", "-m", "gcodesim", *words]
        pipe = subprocess.PIPE
        with subprocess.Popen(command, cwd=self._folder, stdin=subprocess.DEVNULL, stdout=pipe, stderr=pipe) as process:
            _CALL.get(_Call()).started(process)
            try:
                printed, told = process.communicate(timeout=self._longest)
            except subprocess.TimeoutExpired:
                process.kill()
                return _refused(f"ended after {self._longest:g} s")
        text = printed.decode("utf-8", "replace")
        output: Any = text
        if as_json and text.strip():
            try:
                output = plain_tree(json.loads(text))  # a reader of these answers may do what hidden text says
            except ValueError:
                output = text
        return {
            "exit_status": process.returncode,
            "output": output,
            "messages": told.decode("utf-8", "replace"),
        }


def stoppable(tool: Callable[..., Answer]) -> Callable[..., Coroutine[Any, Any, Answer]]:
    """The same tool for a server that may cancel a call, or end: then the process of the call ends, too."""
    from anyio.to_thread import run_sync

    @wraps(tool)
    async def called(**words: str) -> Answer:
        call = _Call()
        _CALL.set(call)
        _CALLS.add(call)
        try:
            return await run_sync(partial(tool, **words), abandon_on_cancel=True)
        finally:
            _CALLS.discard(call)
            call.stop()

    return called


def stop_calls() -> None:
    """End the processes of all calls: the server leaves at once."""
    for call in list(_CALLS):
        call.stop()


def _refused(why: str) -> Answer:
    return {"exit_status": USAGE, "output": None, "messages": why}


def _stays(path: Path, folder: Path) -> bool:
    try:
        return path.resolve().is_relative_to(folder)
    except (OSError, ValueError):
        return False


def _texts(value: Any) -> Iterator[str]:
    """All texts in a value of YAML, keys left out."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict):
        for item in value.values():
            yield from _texts(item)
    elif isinstance(value, (list, tuple)):
        for item in value:
            yield from _texts(item)
