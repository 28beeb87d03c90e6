"""`gcodesim list FAMILY`: the available choices."""

from __future__ import annotations

import argparse
from typing import Any

from gcodesim.cli.exits import OK

WHAT = (
    "calculators",
    "codes",
    "controllers",
    "dialects",
    "exporters",
    "importers",
    "kinematics",
    "machines",
    "materials",
    "posts",
    "processes",
    "sensors",
    "tolerances",
    "tools",
    "worlds",
)


def add_parser(commands: Any) -> None:
    parser = commands.add_parser("list", help="what there is to choose from: tools, materials …")
    parser.add_argument("what", choices=WHAT, metavar="WHAT", help=", ".join(WHAT))
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    rows = _rows(arguments.what)
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    for row in rows:
        print("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip())
    return OK


def _rows(what: str) -> list[list[str]]:
    if what == "codes":
        from gcodesim.diagnostics import codes

        return [[code.code, code.severity.word, code.title] for code in codes()]
    if what == "materials":
        from gcodesim.processes.materials import LIBRARY

        return [[name, material.name] for name, material in sorted(LIBRARY.items())]
    if what == "machines":
        from gcodesim.kinematics.models import MODELS

        return [[name, model.title] for name, model in MODELS.items()]
    if what == "calculators":
        from gcodesim.calculator import CALCULATORS

        return [[name, CALCULATORS[name].says] for name in CALCULATORS.in_order(CALCULATORS)]
    if what == "exporters":
        from gcodesim.export import EXPORTERS

        return [[name, EXPORTERS[name].says] for name in EXPORTERS]
    if what == "importers":
        from gcodesim.importers import IMPORTERS

        return [[name, IMPORTERS[name].says] for name in IMPORTERS]
    if what == "posts":
        from gcodesim.post import LANGUAGES

        return [[name, LANGUAGES[name].says] for name in LANGUAGES]
    if what == "tolerances":
        from gcodesim.regress.tolerance_kind import table

        return table()
    from importlib import import_module

    place = {
        "controllers": ("gcodesim.controllers", "CONTROLLERS"),
        "dialects": ("gcodesim.rs274.dialects", "DIALECTS"),
        "kinematics": ("gcodesim.kinematics", "KINEMATICS"),
        "processes": ("gcodesim.processes", "PROCESSES"),
        "sensors": ("gcodesim.sensors", "SENSORS"),
        "tools": ("gcodesim.tools", "TOOLS"),
        "worlds": ("gcodesim.world", "WORLDS"),
    }[what]
    return [[name] for name in getattr(import_module(place[0]), place[1])]
