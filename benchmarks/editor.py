"""One change of a long program in an editor: until its findings are known, and until a hover is answered.

    python -m benchmarks.editor [LINES]

The document of the language server alone, without the protocol. Yardstick: reading the whole text, in the same run.
The change is near the top, in the middle and near the end; told is the slowest. Collections of memory are left out, as
the server leaves them to pauses.
"""

from __future__ import annotations

import gc
import sys
import tempfile
import time
from pathlib import Path
from typing import Final

from gcodesim.editor.hover import hover
from gcodesim.editor.program_document import Choices, ProgramDocument

LINES: Final = 20_000
_ALL: Final = 10**9
_CELL: Final = """gcodesim: 1
machine: gantry_xyz
stock: {box: [100, 60, 20], zero: top-front-left, material: al6082_t6, resolution: 1}
tools: {1: {type: flat_end_mill, diameter: 6 mm}}
"""


def raster(count: int) -> list[str]:
    """Moves alone."""
    return ["G21 G90", "F100", *(f"G1 X{n % 90} Y{n % 7}" for n in range(count - 3)), "M2"]


def branches(count: int) -> list[str]:
    """A branch, a call and a parameter in every ten lines."""
    lines = ["G21 G90", "F100", "o<hole> sub", "G1 Z[0-#1]", "G0 Z5", "o<hole> endsub"]
    for n in range(count // 10):
        lines += [f"G0 X{n % 90} Y{n % 7}", f"#100=[{n % 5}+1]", "o<hole> call [#100]", f"o{1000 + n} if [#100 GT 2]"]
        lines += [
            f"G1 X{n % 80} Y3",
            f"o{1000 + n} endif",
            f"G1 X[#100*2] Y{n % 9}",
            f"G1 X{n % 11}",
            f"(n {n})",
            "G0 Z5",
        ]
    return [*lines, "M2"]


def loop(count: int) -> list[str]:
    """One loop around all that is there, three rounds."""
    moves = [f"G1 X{n % 90} Y[{n % 7}+#1]" for n in range(count - 7)]
    return ["G21 G90", "F100", "#1=0", "o1 while [#1 LT 3]", *moves, "#1=[#1+1]", "o1 endwhile", "M2"]


def numbered(count: int) -> list[str]:
    """A Fanuc program with an N in every line."""
    return [
        "%",
        "O1000",
        "G21 G90 G54",
        "F100.",
        *(f"N{n} G1 X{n % 90}. Y{n % 7}.5" for n in range(1, count)),
        "M30",
        "%",
    ]


CASES: Final = {
    "moves": (raster, "linuxcnc", ""),
    "moves, with a cell": (raster, None, _CELL),
    "branches and calls": (branches, "linuxcnc", ""),
    "a loop around all": (loop, "linuxcnc", ""),
    "fanuc": (numbered, "fanuc", ""),
}


def main(count: int = LINES) -> None:
    for name, (made, dialect, cell) in CASES.items():
        with tempfile.TemporaryDirectory() as folder:
            if cell:
                (Path(folder) / "cell.yaml").write_text(cell)
            lines = made(count)
            begin = time.process_time()
            document = ProgramDocument(Path(folder) / "part.nc", _text(lines), Choices(dialect=dialect))
            document.go_on(_ALL)
            whole, blocks = time.process_time() - begin, document.reading.work if document.reading else 0
            changes = [_change(document, lines, at) for at in (9, len(lines) // 2, len(lines) - 9) for _ in range(3)]
            findings, answer, work = (max(column) for column in zip(*changes, strict=True))
            print(
                f"{name:20s} read {whole * 1e3:5.0f} ms; after one change findings {findings * 1e3:4.0f} ms "
                f"({whole / findings:3.0f} x), hover {answer * 1e3:4.0f} ms, {work} of {blocks} blocks"
            )


def _text(lines: list[str]) -> str:
    return "\n".join(lines) + "\n"


def _change(document: ProgramDocument, lines: list[str], at: int) -> tuple[float, float, int]:
    """Seconds of the processor until the findings, and for a hover behind the change, and blocks executed for both."""
    lines[at] = f"G1 X{len(lines[at]) % 7 + 1}."
    gc.collect()
    gc.disable()
    begin = time.process_time()
    document.update(_text(lines))
    document.findings  # noqa: B018
    then = time.process_time()
    hover(document, at + 1, 0)
    end = time.process_time()
    gc.enable()
    work = document.reading.work if document.reading else 0
    document.go_on(_ALL)
    return then - begin, end - then, work


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
