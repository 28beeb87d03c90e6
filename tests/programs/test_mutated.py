"""Mutated programs of all dialects: findings, never a traceback, never a hang, and no growth of memory.

The programs of the conformance corpora with one to six seeded changes each, of bytes, words and lines. A failure names
its seed: `write(seed)` gives the program.
"""

from __future__ import annotations

import os
import sys
import time
from functools import cache, partial
from pathlib import Path

import pytest

from gcodesim.diagnostics import SourceText
from gcodesim.diagnostics.show import as_text
from gcodesim.rs274 import Settings, ToolTable, interpret
from tests.effort import calls_of

sys.path.insert(0, str(Path(__file__).parent))
sys.path.insert(0, str(Path(__file__).parents[1] / "differential"))

from corpus import CORPORA, FOLDER, programs
from mutations import mutated

DIALECTS = ("linuxcnc", "fanuc", "linuxcnc", "grbl", "linuxcnc", "fanuc", "linuxcnc", "rs274")
PROGRAMS, CHUNKS = 200_000, 100
MOST_BLOCKS = 5_000
SUSPICIOUS = 2.0  # [s] of computing for one program, after which its work is counted; 99.9 % take less than 0.1 s
MOST_CALLS = 20_000_000
_LONG = b"F100\no1 while [1]\nG81 X1 Z-1 R1\no1 endwhile\nM2\n"
"""Goes on for so long that the compiled lane is opened."""
LEAP = 5_000_000
MOST_GROWTH = 40e6  # bytes over 2000 programs


@cache
def _corpus(dialect: str) -> list[bytes]:
    folders = ("fanuc",) if dialect == "fanuc" else ("rs274", "differences")
    found = [path for folder in folders for kind in ("valid", "invalid") for path in programs(kind, folder)]
    return [path.read_bytes() for path in found]


@cache
def _settings(dialect: str) -> Settings:
    table, _ = ToolTable.read(SourceText.read(CORPORA / ("fanuc" if dialect == "fanuc" else "rs274") / "tools.tbl"))
    return Settings(dialect=dialect, tool_table=table, subroutines=(FOLDER / "subs",), max_blocks=MOST_BLOCKS)


def write(seed: int) -> tuple[str, bytes]:
    """Dialect and text of program `seed`."""
    dialect = DIALECTS[seed % len(DIALECTS)]
    corpus = _corpus(dialect)
    return dialect, mutated(corpus[seed // len(DIALECTS) % len(corpus)], f"{dialect} {seed}", most=6)


def read(dialect: str, text: bytes) -> None:
    """Read a program to its end, and print what is found as a user sees it."""
    run = interpret(SourceText("p.nc", text), _settings(dialect))
    for _ in run.stream():
        pass
    places = {(finding.code, finding.span) for finding in run.findings}
    assert run.failed is None or (run.failed.code, run.failed.span) in places
    for finding in list(run.findings)[:5]:
        assert "\n" not in finding.message
        as_text(finding, run.sources)


def memory() -> int:
    """Bytes that this process has in memory."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def read_all(first: int, count: int) -> None:
    read("linuxcnc", _LONG)  # what is loaded once is no growth
    grown, last = 0, memory()
    for seed in range(first, first + count):
        dialect, text = write(seed)
        begin = time.process_time()
        try:
            read(dialect, text)
        except Exception as problem:
            raise AssertionError(f"seed {seed} ({dialect}): {problem!r}") from problem
        if time.process_time() - begin > SUSPICIOUS:  # the clock only picks whom to count
            calls_of(partial(read, dialect, text), MOST_CALLS)
        now = memory()
        if now - last > LEAP:  # a hundred thousand pecks stretch the heap once; what is lost is lost again
            last = now
            read(dialect, text)
            now = memory()
        if seed > first + count // 10:
            grown += now - last
        last = now
    if count >= 1000:
        assert grown < MOST_GROWTH


def test_some() -> None:
    read_all(0, 400)


@pytest.mark.slow
@pytest.mark.parametrize("chunk", range(CHUNKS))
def test_many(chunk: int) -> None:
    count = PROGRAMS // CHUNKS
    read_all(chunk * count, count)
