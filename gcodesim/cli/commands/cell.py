"""`gcodesim cell validate|show|schema`: cell files."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

from gcodesim.cli.exits import FINDINGS, OK, status_of
from gcodesim.cli.formats import add_verdict_formats, write_formats
from gcodesim.cli.judging import Met, add_baseline, settle
from gcodesim.cli.options import add_fail_on, add_format, read_source


def add_parser(commands: Any) -> None:
    parser = commands.add_parser("cell", help="validate or show a cell file, print the schema")
    actions = parser.add_subparsers(title="actions", metavar="ACTION", required=True)
    for name, what, function in (
        ("validate", "find what is wrong with a cell file", _validate),
        ("show", "print a cell with all defaults that are used", _show),
    ):
        action = actions.add_parser(name, help=what)
        action.add_argument("cell", type=Path, metavar="CELL", help="the cell file (YAML)")
        action.add_argument(
            "--allow-path",
            type=Path,
            action="append",
            default=[],
            metavar="DIR",
            help="a folder besides the cell's own from which it may take files",
        )
        if function is _validate:
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
    from gcodesim.cell import load_cell
    from gcodesim.cli.output import findings_as_json, print_json, print_verdict

    read_source(arguments.cell, "cell")
    loaded = load_cell(arguments.cell, arguments.allow_path)
    if loaded.cell is not None:
        from gcodesim.simulation import layout_findings

        loaded.findings.extend(layout_findings(loaded.cell))
    met = Met(
        program=arguments.cell,
        findings=list(loaded.findings),
        sources=loaded.sources,
        files=lambda: {file.name: file.path for file in loaded.files},
    )
    settled = settle([met], arguments)
    if arguments.format == "json":
        print_json({"findings": findings_as_json(loaded.findings)})
    elif arguments.format == "text":
        print_verdict(met.name, settled.shown[0].findings, loaded.sources)
        for remark in settled.remarks:
            print(remark)
    write_formats(settled.verdict, arguments)
    return settled.status


def _show(arguments: argparse.Namespace) -> int:
    from gcodesim.cell import load_cell
    from gcodesim.cell.show import cell_as_json, cell_as_text
    from gcodesim.cli.output import print_findings, print_json

    read_source(arguments.cell, "cell")
    loaded = load_cell(arguments.cell, arguments.allow_path)
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
        from gcodesim.cell.schema import units_as_text

        print(units_as_text())
    elif arguments.tests:
        from gcodesim.regress.case_file import case_schema

        print(json.dumps(case_schema(), indent=2, ensure_ascii=False))
    else:
        from gcodesim.cell.schema import cell_schema

        print(json.dumps(cell_schema(), indent=2, ensure_ascii=False))
    return OK
