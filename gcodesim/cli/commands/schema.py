"""`gcodesim schema NAME`: the JSON Schema of a file or of what a command prints."""

from __future__ import annotations

import argparse
import json
from typing import Any

from gcodesim.cli.exits import OK, UsageError
from gcodesim.cli.nearest import no_such
from gcodesim.cli.outline import may_be

NAMES = (
    *("results", "setups", "findings", "test", "mutants", "diff", "canon", "process", "optimise", "baseline", "info"),
    *("cell", "test-file", "job-file", "study", "settings", "sweep"),
)
"""Those of `SCHEMAS`, which help and completion need not load."""


def add_parser(commands: Any) -> None:
    parser = commands.add_parser(
        "schema",
        help="the JSON Schema of results, findings, verdicts, cells …",
        description="Print a JSON Schema (2020-12). results: results.json and what run and check print as JSON; "
        "setups: setups.json; findings: lint and cell validate; test, diff, canon, process, optimise, info: these "
        "commands; mutants: test --mutate; baseline, cell, test-file, job-file, study, settings (gcodesim.yaml): files "
        "that are read; sweep: sweep.json.",
    )
    may_be(parser.add_argument("name", metavar="NAME", help=", ".join(NAMES)), lambda: NAMES)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    from gcodesim.formats.schemas import SCHEMAS, schema_of

    if arguments.name not in SCHEMAS:
        raise UsageError(no_such("schema", arguments.name, SCHEMAS))
    print(json.dumps(schema_of(arguments.name), indent=2, ensure_ascii=False))
    return OK
