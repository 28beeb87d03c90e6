"""`gcodesim cell validate|show|schema`: cell files."""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from gcodesim.cli.exits import FINDINGS, OK, status_of
from gcodesim.cli.formats import add_verdict_formats
from gcodesim.cli.judging import Met, add_baseline, print_findings_of, settle
from gcodesim.cli.options import add_allow_code, add_fail_on, add_format, read_source


def add_parser(commands: Any) -> None:
    parser = commands.add_parser("cell", help="validate or show a cell file, print the schema")
    actions = parser.add_subparsers(title="actions", metavar="ACTION", required=True)
    for name, what, function in (
        ("validate", "find what is wrong with a cell file", _validate),
        ("show", "print a cell with all defaults that are used", _show),
    ):
        action = actions.add_parser(name, help=what)
        many = function is _validate
        action.add_argument(
            "cells" if many else "cell",
            type=Path,
            metavar="CELL",
            nargs="+" if many else None,
            help="cell files (YAML)" if many else "the cell file (YAML)",
        )
        action.add_argument(
            "--allow-path",
            type=Path,
            action="append",
            default=[],
            metavar="DIR",
            help="a folder besides the cell's own from which it may take files",
        )
        add_allow_code(action)
        if many:
            add_verdict_formats(action)
            add_baseline(action)
        else:
            add_format(action)
        add_fail_on(action)
        action.set_defaults(run=function)
    schema = actions.add_parser("schema", help="print the JSON Schema of cell files, or the units")
    schema.add_argument("--tests", action="store_true", help="print the schema of test files (NAME.test.yaml) instead")
    schema.add_argument("--units", action="store_true", help="print units and their spellings instead")
    schema.set_defaults(run=_schema)


def _validate(arguments: argparse.Namespace) -> int:
    settled = settle([_met(path, arguments.allow_path, arguments.allow_code) for path in arguments.cells], arguments)
    print_findings_of(settled, arguments)
    return settled.status


def _met(path: Path, allow_paths: Sequence[Path], allow_code: bool) -> Met:
    from gcodesim.cell import load_cell

    read_source(path, "cell")
    loaded = load_cell(path, allow_paths, allow_code=allow_code)
    if loaded.cell is not None:
        from gcodesim.simulation import layout_findings

        loaded.findings.extend(layout_findings(loaded.cell))
    files = {file.name: file.path for file in loaded.files}
    return Met(program=path, findings=list(loaded.findings), sources=loaded.sources, files=lambda: files)


def _show(arguments: argparse.Namespace) -> int:
    from gcodesim.cell import load_cell
    from gcodesim.cell.show import cell_as_json, cell_as_text
    from gcodesim.cli.output import print_findings, print_json

    read_source(arguments.cell, "cell")
    loaded = load_cell(arguments.cell, arguments.allow_path, allow_code=arguments.allow_code)
    if loaded.cell is None:
        print_findings(loaded.findings, loaded.sources)
        return FINDINGS
    if arguments.format == "json":
        print_json(cell_as_json(loaded.cell))
    else:
        print(cell_as_text(loaded.cell))
    return status_of(loaded.findings, arguments.fail_on)


def _schema(arguments: argparse.Namespace) -> int:
    if arguments.units:
        from gcodesim.declarations.tables import units_as_text

        print(units_as_text())
    elif arguments.tests:
        from gcodesim.regress.case_file import case_schema

        print(json.dumps(case_schema(), indent=2, ensure_ascii=False))
    else:
        from gcodesim.cell.schema import cell_schema

        print(json.dumps(cell_schema(), indent=2, ensure_ascii=False))
    return OK
