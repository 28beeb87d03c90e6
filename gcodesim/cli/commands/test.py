"""`gcodesim test [PATHS]`: programs against what was accepted and expected of them."""

from __future__ import annotations

import argparse
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gcodesim.cli import exits
from gcodesim.cli.formats import add_verdict_formats, write_formats
from gcodesim.cli.judging import add_baseline, read_baseline, write_baseline
from gcodesim.cli.suite import Bar, add_selection, jobs_of, selected, workers_are_safe

if TYPE_CHECKING:
    from gcodesim.regress import SuiteVerdict
    from gcodesim.regress.cache import Cache
    from gcodesim.regress.judge import Judging

_DESCRIPTION = """Run programs in their cells and compare with what was accepted of them (NAME.golden.json, written by
`gcodesim accept`) and with what test files (NAME.test.yaml) and comments `(expect: GS501)` expect. A case fails for
findings at or above --fail-on, for motion, results or surfaces beyond tolerance, and for expectations that are not met.
`docs/regression.md` has it all."""


def add_parser(commands: Any) -> None:
    parser = commands.add_parser(
        "test", help="compare programs with what was accepted and expected of them", description=_DESCRIPTION
    )
    add_selection(parser)
    parser.add_argument("-x", dest="fail_fast", action="store_true", help="stop at the first case that fails")
    parser.add_argument("-v", dest="verbose", action="store_true", help="name each case, and all that differs")
    parser.add_argument(
        "--changed", action="store_true", help="run only cases that have not passed before with the same inputs"
    )
    parser.add_argument(
        "--cache", type=Path, metavar="DIR", help="where it is remembered what passed (default: in the user's cache)"
    )
    add_baseline(parser)
    add_verdict_formats(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    from gcodesim.cli.output import note
    from gcodesim.regress.suite import INTERNAL, baseline_of, run_suite

    begin = time.perf_counter()
    collected, how = selected(arguments)
    cache = _cache(arguments, how)
    with workers_are_safe(), Bar(len(collected.cases)) as step:
        verdict = run_suite(
            collected,
            how,
            jobs=jobs_of(arguments),
            fail_fast=arguments.fail_fast,
            cache=cache,
            reuse=arguments.changed,
            baseline=read_baseline(arguments),
            progress=lambda case: step(case.name),
        )
    cache.tidy()
    if arguments.write_baseline is not None:
        write_baseline(arguments.write_baseline, baseline_of(verdict, how.root))
    _report(verdict, how, arguments)
    note(f"{time.perf_counter() - begin:.1f} s")
    if any(one.finding.code == INTERNAL for case in verdict.cases for one in case.found):
        return exits.INTERNAL
    return exits.FINDINGS if verdict.failed and arguments.write_baseline is None else exits.OK


def _cache(arguments: argparse.Namespace, how: Judging) -> Cache:
    from gcodesim.cli.output import note
    from gcodesim.regress.cache import Cache, default_folder

    cache = Cache(arguments.cache or default_folder(), how.root, how.settings)
    if cache.refused:
        note(f"what passes is not remembered: {cache.refused}")
    return cache


def _report(verdict: SuiteVerdict, how: Judging, arguments: argparse.Namespace) -> None:
    from gcodesim.cli.output import print_json
    from gcodesim.cli.verdicts import print_suite
    from gcodesim.regress.suite_json import suite_as_json

    if arguments.format == "json":
        print_json(suite_as_json(verdict))
    elif arguments.format == "text":
        print_suite(verdict, how.root, verbose=arguments.verbose)
    write_formats(verdict, arguments)
