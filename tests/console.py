"""Commands that pages of the documentation show, run in turn and compared with what the page says they print.

A page is a folder: a block with a title is a file in it, a block of language `console` has commands behind `$ ` and
what they print. A line `…` stands for any lines, `…` inside a line for any text. A block that cannot be run here has a
comment above it that says why: `<!-- not run: it needs a network -->`.
"""

from __future__ import annotations

import contextlib
import io
import os
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from gcodesim.cli import main

_BLOCK = re.compile(
    r"(?:^<!-- not run: (?P<reason>[^\n]+?) -->\n\n?)?^```(?P<language>\w+)(?P<info>[^\n]*)\n(?P<text>.*?)^```$",
    re.MULTILINE | re.DOTALL,
)
_TITLE = re.compile(r'title="([^"]+)"')
_REMARK = re.compile(r"\s+# .*$")


@dataclass(frozen=True, slots=True, kw_only=True)
class Block:
    """A file (`title`), or commands; `reason` is why they are not run, `line` where the block is."""

    line: int
    language: str
    title: str
    text: str
    reason: str

    def commands(self) -> Iterator[tuple[str, list[str]]]:
        """Each command and the lines that it prints, as the page has them."""
        command, said = "", list[str]()
        for line in self.text.splitlines():
            if line.startswith("$ "):
                if command:
                    yield command, said
                command, said = _REMARK.sub("", line[2:]), []
            else:
                said.append(line)
        if command:
            yield command, said


def blocks_of(page: str) -> list[Block]:
    """The files and commands of a page, in order."""
    found = []
    for block in _BLOCK.finditer(page):
        title = _TITLE.search(block["info"])
        if block["language"] == "console" or title is not None:
            found.append(
                Block(
                    line=page.count("\n", 0, block.start("language")) + 1,
                    language=block["language"],
                    title="" if title is None else title[1],
                    text=block["text"],
                    reason=block["reason"] or "",
                )
            )
    return found


def without_blocks(page: str) -> str:
    """The prose and tables of a page."""
    return re.sub(r"^```.*?^```$", "", page, flags=re.MULTILINE | re.DOTALL)


@dataclass(slots=True)
class Console:
    """A folder in which commands are run."""

    folder: Path
    said: str = field(default="", init=False)

    def put(self, name: str, text: str) -> None:
        """A file of the page."""
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def run(self, command: str) -> int:
        """Run a command; what it printed is in `said`: stdout, or stderr when the usage was wrong."""
        command, _, target = command.partition(" > ")
        for part in command.split(" && "):
            status = self._run(part.strip())
            if status:
                break
        if target:
            (self.folder / target.strip()).write_text(self.said, encoding="utf-8")
            self.said = ""
        return status

    def _run(self, command: str) -> int:
        words = shlex.split(command)
        if words[0] == "cd":
            self.folder /= words[1]
            self.said = ""
            return 0
        if words[0] == "gcodesim":
            return self._gcodesim(words[1:])
        words = [sys.executable, *words[1:]] if words[0] == "python" else words
        done = subprocess.run(words, cwd=self.folder, capture_output=True, text=True, check=False)
        self.said = done.stdout or done.stderr
        return done.returncode

    def _gcodesim(self, words: list[str]) -> int:
        before, out, errors = Path.cwd(), io.StringIO(), io.StringIO()
        os.chdir(self.folder)
        try:
            with contextlib.redirect_stdout(out), contextlib.redirect_stderr(errors):
                status = main(words)
        except SystemExit as end:
            status = int(end.code or 0)
        finally:
            os.chdir(before)
        self.said = out.getvalue() or errors.getvalue()
        return status


def differs(said: str, shown: list[str]) -> str:
    """Why `said` is not what the page shows; empty when it is."""
    pattern = "".join(_pattern(line) for line in shown)
    if re.fullmatch(pattern, "".join(f"{line.rstrip()}\n" for line in said.splitlines())):
        return ""
    lines = "\n".join(f"  {line}" for line in said.splitlines())
    return f"it prints\n{lines}\nwhere the page has\n" + "\n".join(f"  {line}" for line in shown)


def _pattern(line: str) -> str:
    if line.strip() == "…":
        return r"(?:.*\n)*?"
    # figures are aligned by blanks, whose number follows from what is left out
    return r"\s+".join(_piece(word) for word in re.split(r"\s+", line.rstrip())) + r" *\n"


def _piece(word: str) -> str:
    return ".*?".join(re.escape(part) for part in word.split("…"))
