"""`gcodesim test [PATHS]`: compare programs with their accepted results and expectations."""

from __future__ import annotations

import argparse
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gcodesim.cli import exits
from gcodesim.cli.exits import UsageError
from gcodesim.cli.formats import add_verdict_formats, write_formats
from gcodesim.cli.judging import add_baseline, read_baseline, write_baseline
from gcodesim.cli.suite import Bar, add_selection, jobs_of, selected, workers_are_safe
from gcodesim.cli.workers import add_scheduler, scheduler_of

if TYPE_CHECKING:
    from gcodesim.regress import SuiteVerdict
    from gcodesim.regress.cache import Cache
    from gcodesim.regress.outcome import Judging

_DESCRIPTION = """Run programs in their cells and compare with what was accepted of them (NAME.golden.json, written by
`gcodesim accept`) and with what test files (NAME.test.yaml) and comments `(expect: GS501)` expect. A case fails for
findings at or above --fail-on, for motion, results or surfaces beyond tolerance, and for expectations that are not met.
`docs/regression.md` has it all."""


def add_parser(commands: Any) -> None:
    parser = commands.add_parser(
        "test", help="compare programs with what was accepted and expected of them", description=_DESCRIPTION
    )
    add_selection(parser)
    add_scheduler(parser.add_argument_group("workers", "who runs the cases in place of -j; the verdict is the same"))
    parser.add_argument("-x", dest="fail_fast", action="store_true", help="stop at the first case that fails")
    parser.add_argument("-v", dest="verbose", action="store_true", help="name each case, and all that differs")
    parser.add_argument(
        "--changed", action="store_true", help="run only cases that have not passed before with the same inputs"
    )
    parser.add_argument(
        "--cache", type=Path, metavar="DIR", help="where it is remembered what passed (default: in the user's cache)"
    )
    parser.add_argument(
        "--mutate",
        type=int,
        metavar="N",
        help="change programs and cells in N ways, one at a time, and tell which changes no case sees",
    )
    parser.add_argument("--seed", type=int, default=1, metavar="S", help="which changes --mutate draws (default: 1)")
    add_baseline(parser)
    add_verdict_formats(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    from gcodesim.cli.output import note
    from gcodesim.regress.suite import INTERNAL, baseline_of, run_suite

    begin = time.perf_counter()
    if arguments.mutate is not None:
        return _mutate(arguments)
    collected, how = selected(arguments)
    cache = _cache(arguments, how)
    with workers_are_safe(), Bar(len(collected.cases)) as step, scheduler_of(arguments) as hands:
        verdict = run_suite(
            collected,
            how,
            jobs=jobs_of(arguments),
            fail_fast=arguments.fail_fast,
            cache=cache,
            reuse=arguments.changed,
            baseline=read_baseline(arguments),
            hands=hands,
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


def _mutate(arguments: argparse.Namespace) -> int:
    """Find out what the suite would not see. Status 1 if a change that has an effect passes."""
    from gcodesim.cli.output import note, print_json
    from gcodesim.cli.verdicts import print_mutants
    from gcodesim.regress.mutants import draw, judge_mutants, mutants_as_json
    from gcodesim.regress.suite import run_suite

    if arguments.mutate < 1:
        raise UsageError("--mutate takes a number from 1 on")
    if arguments.scheduler is not None:
        raise UsageError("--mutate changes files here, so it takes -j and no --scheduler")
    begin = time.perf_counter()
    collected, how = selected(arguments)
    with workers_are_safe(), Bar(len(collected.cases)) as step:
        suite = run_suite(collected, how, jobs=jobs_of(arguments), progress=lambda case: step(case.name))
    passed = {case.name for case in suite.with_status("passed")}
    sound = [case for case in collected.cases if case.name in passed]
    for case in suite.with_status("failed"):
        note(f"{case.name} fails as it is and is left out")
    if not sound:
        raise UsageError("no case passes as it is, so none can tell a change")
    mutants = draw(sound, how.root, arguments.mutate, arguments.seed)
    with workers_are_safe(), Bar(len(mutants)) as step:
        verdicts = judge_mutants(mutants, how, jobs=jobs_of(arguments), progress=lambda one: step(one.case.name))
    if arguments.format == "json":
        print_json(mutants_as_json(verdicts, arguments.seed))
    else:
        print_mutants(verdicts, arguments.seed, verbose=arguments.verbose)
    note(f"{time.perf_counter() - begin:.1f} s")
    return exits.FINDINGS if any(one.fate == "not_seen" for one in verdicts) else exits.OK


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
