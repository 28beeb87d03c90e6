"""`gcodesim accept [PATHS]`: show what changed, then record it as what programs have to do from now on."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from gcodesim.cli.exits import FINDINGS, OK, UsageError
from gcodesim.cli.options import add_format
from gcodesim.cli.streams import drop_output
from gcodesim.cli.suite import Bar, add_selection, jobs_of, selected, workers_are_safe

if TYPE_CHECKING:
    from gcodesim.regress.accept import Proposal

_DESCRIPTION = """Run the cases that `gcodesim test` would run and take their results as accepted: a file
NAME.golden.json beside each test, for version control. Each difference is printed before it is written; results within
tolerance leave the file as it is. Status 1 when a case cannot be accepted because an expectation written by hand is not
met."""


def add_parser(commands: Any) -> None:
    parser = commands.add_parser(
        "accept", help="show what changed and take it as what tests compare with", description=_DESCRIPTION
    )
    add_selection(parser)
    parser.add_argument("-n", "--dry-run", action="store_true", help="show what would be accepted and write nothing")
    add_format(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    from gcodesim.cli.output import findings_as_json, print_findings, print_json
    from gcodesim.regress.accept import propose
    from gcodesim.regress.sources import Sources
    from gcodesim.regress.workers import in_parallel

    collected, how = selected(arguments)
    proposals = []
    with workers_are_safe(), Bar(len(collected.cases)) as step:
        for proposal in in_parallel(propose, collected.cases, how, jobs_of(arguments)):
            step(proposal.name)
            proposals.append(proposal)
    refused = collected.found or any(proposal.against for proposal in proposals)
    arguments.status = FINDINGS if refused else OK
    if arguments.format == "text":
        with _readers_may_go():
            _print(proposals, arguments.dry_run)
            sys.stdout.flush()
    if not arguments.dry_run:
        _take(proposals)
    with _readers_may_go():  # what was accepted is told when it has been written
        if arguments.format == "json":
            print_json(
                {
                    "dry_run": arguments.dry_run,
                    "cases": [_as_json(proposal) for proposal in proposals],
                    "findings": findings_as_json(one.finding for one in collected.found),
                }
            )
        else:
            _print_count(proposals, arguments.dry_run)
            for one in collected.found:
                print_findings([one.finding], Sources(how.root))
        sys.stdout.flush()
    return int(arguments.status)


def _take(proposals: list[Proposal]) -> None:
    """Write what is accepted; UsageError at the first file that cannot be written."""
    from gcodesim.regress.accept import take

    for proposal in proposals:
        try:
            take(proposal)
        except OSError as error:
            raise UsageError(f"{proposal.shown} cannot be written: {error.strerror}") from None


@contextmanager
def _readers_may_go() -> Iterator[None]:
    """Go on when the reader of the output goes away (`| head`): the task is to accept, not to print."""
    try:
        yield
    except BrokenPipeError:
        drop_output()


def _print(proposals: list[Proposal], is_dry: bool) -> None:
    from gcodesim.diagnostics.show import as_text
    from gcodesim.regress import show

    will = "would accept" if is_dry else "accepting"
    for proposal in proposals:
        if proposal.against:
            print(f"{proposal.name}: not accepted, because an expectation that is written by hand is not met")
            for finding in proposal.against:
                print("\n".join(f"  {line}" for line in as_text(finding, {}).splitlines()))
        elif proposal.comparison is None:
            print(f"{proposal.name}: {will} {proposal.shown} for the first time")
            print(f"  {', '.join([f'{proposal.steps} steps', *show.totals(proposal.results or {})])}")
        elif not proposal.comparison.same:
            print(f"{proposal.name}: {will} {proposal.shown}")
            print("\n".join(f"  {line}" for line in show.comparison_lines(proposal.comparison)))
            print(f"  {show.summary(proposal.comparison)}")
        if proposal.text is not None and proposal.comparison is None:
            for finding in proposal.faulty:
                print(f"  with {finding.level.word} {finding.code} in line {finding.span.line}: {finding.message}")


def _print_count(proposals: list[Proposal], is_dry: bool) -> None:
    accepted = sum(proposal.text is not None for proposal in proposals)
    refused = sum(bool(proposal.against) for proposal in proposals)
    equal = len(proposals) - accepted - refused
    print(f"{accepted} {'to accept' if is_dry else 'accepted'}, {equal} as before, {refused} not accepted")


def _as_json(proposal: Proposal) -> dict[str, Any]:
    from gcodesim.diagnostics.show import as_json
    from gcodesim.regress import show

    return {
        "name": proposal.name,
        "file": proposal.shown,
        "accepted": proposal.text is not None,
        "new": proposal.comparison is None,
        "comparison": None if proposal.comparison is None else show.as_json(proposal.comparison),
        "findings": [as_json(finding) for finding in proposal.faulty],
        "against": [as_json(finding) for finding in proposal.against],
    }
