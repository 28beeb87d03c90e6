#!/usr/bin/env python3
"""Run cases of several programs at once with `gcodesim check`, and write what `compare.py` reads.

    scripts/channel_cases.py CASES.json [CASES.json ...] RESULTS.json

Each case becomes a folder with its programs and a cell: one arm for each channel, with the dialect and the marks of the
case. What the command prints with `--format json` is put into the form of `expected`.
"""

from __future__ import annotations

import io
import json
import sys
import tempfile
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent.parent
if str(HERE) not in sys.path:
    sys.path.insert(0, str(HERE))

from gcodesim.cli.main import main as gcodesim  # noqa: E402

Json = dict[str, Any]


def result_of(case: Json, folder: Path) -> Json:
    """What gcodesim makes of a case, in the form of `expected`; its files are written into `folder`."""
    command = files_of(case, folder)
    printed = io.StringIO()
    with redirect_stdout(printed):
        status = gcodesim(["check", *command, "--format", "json"])
    if status not in (0, 1):
        raise RuntimeError(f"{case['id']}: status {status}")
    return expected_form(json.loads(printed.getvalue()))


def files_of(case: Json, folder: Path) -> list[str]:
    """Write the programs and the cell of a case; the arguments of `check` and `run` that name them."""
    folder.mkdir(parents=True, exist_ok=True)
    channels = {}
    for name, text in case["programs"].items():
        (folder / f"{name}.nc").write_text(text + "\n", encoding="utf-8")
        channels[name] = {
            "robot": f"arm_{name}",
            "dialect": case["dialect"],
            "m_codes": case["m_codes"].get(name, {}),
        }
    robots = {
        f"arm_{name}": {"model": "ur10e", "base": {"in": "world", "xyz": [3000 * place, 0, 0]}}
        for place, name in enumerate(channels)
    }
    cell = {"gcodesim": 1, "robots": robots, "channels": channels, "simulation": {"world": "kinematic"}}
    (folder / "cell.yaml").write_text(json.dumps(cell, indent=1), encoding="utf-8")
    first, *others = sorted(channels)
    named = [word for name in others for word in ("--channel", f"{name}={folder / name}.nc")]
    return [str(folder / f"{first}.nc"), "--cell", str(folder / "cell.yaml"), *named]


def expected_form(results: Json) -> Json:
    """The JSON of a check in the form of `expected`."""
    meetings = results["meetings"]
    found: list[Json] = []
    if meetings["circle"]:
        circle = [{key: place[key] for key in ("channel", "line", "mark")} for place in meetings["circle"]]
        found.append({"kind": "deadlock", "circle": circle})
    for kind in ("ended", "lone"):
        for place in meetings[kind]:
            told = {key: place[key] for key in ("mark", "channel", "line", "by") if key in place}
            found.append({"kind": "lone_mark" if kind == "lone" else kind, **told})
    return {
        "blocks": {
            name: [[block["line"], block["begin_s"], block["end_s"]] for block in channel["blocks"]]
            for name, channel in results["channels"].items()
        },
        "total": meetings["total_s"],
        "stopped_at": meetings["stopped_at_s"],
        "deadlock": bool(meetings["circle"]),
        "findings": found,
    }


def main() -> int:
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    *paths, out = map(Path, sys.argv[1:])
    results = {}
    with tempfile.TemporaryDirectory() as folder:
        for path in paths:
            for case in json.loads(path.read_text(encoding="utf-8"))["cases"]:
                results[case["id"]] = result_of(case, Path(folder, case["id"]))
    out.write_text(json.dumps(results, indent=1) + "\n", encoding="utf-8")
    print(f"{len(results)} results in {out}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
