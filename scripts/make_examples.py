"""Print the findings of all examples anew: `python scripts/make_examples.py [GSnnn …]`.

`gcodesim/data/examples/GSnnn.txt` is a transcript: `$ gcodesim …` and what that command prints about the files
beside it. A new example is its files and a transcript of that first line alone. Read the difference like code.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from gcodesim.cli.examples import FOLDER, transcript_of
from gcodesim.diagnostics.examples import command_of


def main(codes: list[str]) -> int:
    """Rewrite the transcripts of `codes`, or all; the number of examples that do not show their code."""
    silent = 0
    for path in sorted(FOLDER.glob("GS*.txt")):
        if codes and path.stem not in codes:
            continue
        with tempfile.TemporaryDirectory() as folder:
            text = transcript_of(command_of(path.read_text(encoding="utf-8")), Path(folder))
        path.write_text(text, encoding="utf-8")
        if f" {path.stem}: " not in text:
            print(f"{path.name} does not show {path.stem}", file=sys.stderr)
            silent += 1
    return silent


if __name__ == "__main__":
    sys.exit(min(main(sys.argv[1:]), 1))
