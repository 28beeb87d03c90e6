"""`gcodesim diff OLD NEW`: what changed between two runs, by quantity and tolerance."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

from gcodesim.cli.exits import FINDINGS, OK, UsageError
from gcodesim.cli.options import add_format


def add_parser(commands: Any) -> None:
    parser = commands.add_parser("diff", help="what changed between two runs: times, volumes, forces, findings")
    parser.add_argument("old", type=Path, metavar="OLD", help="folder of the earlier run, or its results.json")
    parser.add_argument("new", type=Path, metavar="NEW", help="folder of the later run, or its results.json")
    add_format(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    from gcodesim.cli.output import print_json
    from gcodesim.regress import compare_results

    changes = compare_results(_read(arguments.old), _read(arguments.new))
    if arguments.format == "json":
        print_json({"changes": [{"quantity": c.quantity, "old": c.old, "new": c.new} for c in changes]})
    elif changes:
        for change in changes:
            print(change.text)
        print(f"{len(changes)} difference{'' if len(changes) == 1 else 's'} beyond tolerance")
    else:
        print("no difference in motion or result")
    return FINDINGS if changes else OK


def _read(path: Path) -> dict[str, Any]:
    file = path / "results.json" if path.is_dir() else path
    try:
        value = json.loads(file.read_bytes())
    except FileNotFoundError:
        raise UsageError(f"there are no results at {file}") from None
    except (OSError, ValueError) as error:
        raise UsageError(f"{file} cannot be read: {error}") from None
    if not isinstance(value, dict) or not str(value.get("schema", "")).startswith("gcodesim-results/"):
        raise UsageError(f"{file} holds no results of gcodesim")
    return value
