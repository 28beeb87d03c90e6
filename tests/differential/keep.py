"""Keep a program as a small case that the fast suite runs: `python tests/differential/keep.py PROGRAM.ngc NAME`.

What LinuxCNC's interpreter makes of it is stored beside it, in the form of the conformance corpus.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

from linuxcnc import CORPUS, Interpreter

FOLDER = CORPUS.parent / "differences"


def keep(program: bytes, name: str) -> Path:
    """Store `program` and its verdict as `name`; returns the path of the program."""
    with Interpreter() as interpreter:
        verdict = interpreter.run(program)
    assert verdict.status in ("ok", "error") and not verdict.complaint, verdict
    folder = FOLDER / ("valid" if verdict.status == "ok" else "invalid")
    folder.mkdir(parents=True, exist_ok=True)
    error = None
    if verdict.status == "error":
        lines = program.decode("latin-1").split("\n")
        found = [n for n, line in enumerate(lines, 1) if line.split() == verdict.text.split()]
        error = {"message": verdict.message, "line": found[0] if found else len(lines)}
    expected = {
        "status": verdict.status,
        "error": error,
        "events": verdict.events,
        "setup": {"dialect": "linuxcnc", "parameters": None, "block_delete": False},
    }
    path = folder / f"{name}.ngc"
    path.write_bytes(program)
    path.with_suffix(".json").write_text(json.dumps(expected) + "\n")
    return path


if __name__ == "__main__":
    print(keep(Path(sys.argv[1]).read_bytes(), sys.argv[2]))
