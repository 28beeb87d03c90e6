"""Settings of the language reader from the command line, and from the cell when there is one."""

from __future__ import annotations

import argparse
from dataclasses import replace

from gcodesim.cli.exits import UsageError
from gcodesim.cli.options import read_source
from gcodesim.cli.output import print_findings
from gcodesim.rs274 import Settings, ToolTable, read_parameters


def settings_of(arguments: argparse.Namespace) -> Settings | None:
    """What the options and the cell say; None when the cell or a file has errors, which are then printed."""
    settings = Settings()
    if arguments.cell is not None:
        from gcodesim.cell import load_cell
        from gcodesim.language import settings_of_cell

        read_source(arguments.cell, "cell")
        loaded = load_cell(arguments.cell, arguments.allow_path)
        if loaded.cell is None:
            print_findings(loaded.findings, loaded.sources)
            return None
        settings, findings = settings_of_cell(loaded.cell)
        if findings:
            print_findings(findings, loaded.sources)
    return with_options(settings, arguments)


def with_options(settings: Settings, arguments: argparse.Namespace) -> Settings:
    """`settings` with what the command line says besides; UsageError for what cannot be read."""
    from gcodesim.rs274.dialects import DIALECTS

    if arguments.dialect is not None:
        if arguments.dialect not in DIALECTS:
            raise UsageError(f"there is no dialect {arguments.dialect}; there are {', '.join(DIALECTS)}")
        settings = replace(settings, dialect=arguments.dialect)
    if arguments.tools is not None:
        table, problems = ToolTable.read(source := read_source(arguments.tools, "tool table"))
        print_findings(problems, {source.name: source})
        settings = replace(settings, tool_table=table)
    if arguments.parameters is not None:
        values, problems = read_parameters(source := read_source(arguments.parameters, "parameter file"))
        print_findings(problems, {source.name: source})
        settings = replace(settings, parameters={**settings.parameters, **values})
    if arguments.subs:
        for folder in arguments.subs:
            if not folder.is_dir():
                raise UsageError(f"the folder of subroutines {folder} is not there")
        settings = replace(settings, subroutines=(*settings.subroutines, *arguments.subs))
    if arguments.block_delete is not None:
        settings = replace(settings, block_delete=arguments.block_delete)
    if arguments.max_blocks is not None:
        settings = replace(settings, max_blocks=arguments.max_blocks)
    if arguments.time_limit is not None:
        settings = replace(settings, time_limit=arguments.time_limit)
    return settings
