"""Write `docs/findings.md` from the catalogue of findings: `python scripts/make_findings_page.py [FILE]`."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from itertools import groupby
from pathlib import Path

from gcodesim.diagnostics import Code, own_codes

PAGE = Path(__file__).resolve().parent.parent / "docs" / "findings.md"

HUNDREDS = {
    "0": "Reading",
    "1": "Meaning of the program",
    "2": "Limits and reach",
    "3": "Collision",
    "4": "Material",
    "5": "Process",
    "6": "Time and regression",
    "7": "Cell",
    "8": "Programs for other controls",
    "9": "Not simulated",
}

HEAD = """# Findings

What gcodesim may say about a program or a cell. `gcodesim explain CODE` prints one entry,
`gcodesim list codes` all titles. A cell changes a severity by `checks: {GS304: warning, GS9xx: error}`
and silences one place by `suppress:` (see `cell.md`).

This page is written by `scripts/make_findings_page.py` from `gcodesim/diagnostics/catalogue/`; edit it there.
"""


def entry(code: Code) -> str:
    """One code with its three paragraphs."""
    paragraphs = [
        f"### {code.code}: {code.title}",
        f"*{code.severity.word}* {_line(code.what)}",
        f"Why it matters: {_line(code.why)}",
        f"What to do: {_line(code.remedy)}",
    ]
    return "\n\n".join(text for text in paragraphs if not text.endswith(": "))


def _line(text: str) -> str:
    return " ".join(text.split())


def page() -> str:
    """The whole file."""

    def parts() -> Iterator[str]:
        yield HEAD
        for digit, members in groupby(own_codes(), key=lambda code: code.code[2]):
            yield f"## GS{digit}xx: {HUNDREDS[digit]}\n"
            for code in members:
                yield entry(code) + "\n"

    return "\n".join(parts())


if __name__ == "__main__":
    (Path(sys.argv[1]) if len(sys.argv) > 1 else PAGE).write_text(page(), encoding="utf-8")
