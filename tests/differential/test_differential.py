"""Generated and mutated programs mean the same here and to LinuxCNC's own interpreter, to 0.0001 mm.

Needs the program `rs274` of Debian's package `linuxcnc-uspace`, which is installed when it is missing and may be.
Each seed is one program. Where both refuse it in the same line, that line is taken out and the rest tried again, so
that one fault does not hide what follows; every try counts as a program.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

from agreement import compared, settings, without_guilty_line
from author import write
from explained import explanation
from linuxcnc import CORPUS, Interpreter
from mutations import mutated

pytestmark = pytest.mark.slow

_CHUNKS = 40
_PROGRAMS = 20_000
_MOST_TRIES = 8  # of one seed


def _corpus() -> list[bytes]:
    found = [path.read_bytes() for kind in ("valid", "invalid") for path in sorted((CORPUS / kind).glob("*.ngc"))]
    return [program for program in found if b"setup:" not in program]


def _programs(chunk: int) -> Iterator[tuple[str, bytes]]:
    """Without end: three generated programs, then one made of the corpus by mutation."""
    corpus = _corpus()
    number = 0
    while True:
        seed = f"{chunk}/{number}"
        yield seed, mutated(corpus[number % len(corpus)], seed) if number % 4 == 3 else write(seed)
        number += 1


@pytest.mark.parametrize("chunk", range(_CHUNKS))
def test_programs_agree(chunk: int, interpreter: Interpreter) -> None:
    ours = settings()
    unexplained: list[str] = []
    count = 0
    for seed, first in _programs(chunk):
        if count >= _PROGRAMS // _CHUNKS:
            break
        program: bytes | None = first
        for _ in range(_MOST_TRIES):
            assert program is not None
            verdict = interpreter.run(program)
            found = compared(program, verdict, ours)
            count += 1
            if found.differences and not explanation(program, verdict, found):
                unexplained.append(f"seed {seed}: {found.differences[0]}\n{program.decode('latin-1')}")
            if found.differences or verdict.status != "error":
                break
            program = without_guilty_line(program, verdict)
            if program is None:
                break
    assert not unexplained, f"{len(unexplained)} of {count} differ\n\n" + "\n\n".join(unexplained[:5])
