"""Who does the work of a command: this process, processes on this machine, or the workers of a scheduler."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gcodesim.cli.exits import UsageError

if TYPE_CHECKING:
    from gcodesim.scale.crew import Keys
    from gcodesim.scale.hands import Hands


def add_scheduler(group: Any) -> None:
    """Options for a scheduler of Dask that stands somewhere."""
    group.add_argument(
        "--scheduler", metavar="ADDRESS", help="a Dask scheduler, tcp://HOST:8786 or tls://HOST:8786, in place of -j"
    )
    for name, what in (("ca", "certificate of the authority"), ("cert", "own certificate"), ("key", "own key")):
        group.add_argument(f"--tls-{name}", type=Path, metavar="FILE", help=f"{what} (PEM), for tls://")


@contextmanager
def scheduler_of(arguments: argparse.Namespace) -> Iterator[Hands | None]:
    """The workers of the scheduler that the command line names; None if it names none. UsageError as `hands_of`."""
    if arguments.scheduler is None:
        _refuse_keys(arguments)
        yield None
    else:
        with hands_of(arguments, 0) as hands:
            yield hands


@contextmanager
def hands_of(arguments: argparse.Namespace, most: int) -> Iterator[Hands]:
    """Who does up to `most` tasks. UsageError if a scheduler cannot be reached, or is lost on the way."""
    from gcodesim.cli.output import note
    from gcodesim.cli.suite import jobs_of
    from gcodesim.scale.crew import NoWorkersError, SchedulerLostError, crew_at, local_crew
    from gcodesim.scale.hands import Alone

    jobs = min(jobs_of(arguments), max(most, 1))
    if arguments.scheduler is None:
        _refuse_keys(arguments)
        if jobs == 1:
            yield Alone()
            return
    try:
        if arguments.scheduler is not None:
            with crew_at(arguments.scheduler, _keys(arguments), note) as crew:
                yield crew
        else:
            with local_crew(jobs, note) as crew:
                yield crew
    except (NoWorkersError, SchedulerLostError) as reason:
        raise UsageError(str(reason)) from None


def _keys(arguments: argparse.Namespace) -> Keys | None:
    from gcodesim.scale.crew import Keys

    files = (arguments.tls_ca, arguments.tls_cert, arguments.tls_key)
    if not arguments.scheduler.startswith("tls://"):
        _refuse_keys(arguments)
        return None
    if None in files:
        raise UsageError("tls:// needs --tls-ca, --tls-cert and --tls-key")
    for path in files:
        if not path.is_file():
            raise UsageError(f"{path} is not there")
    return Keys(authority=arguments.tls_ca, certificate=arguments.tls_cert, key=arguments.tls_key)


def _refuse_keys(arguments: argparse.Namespace) -> None:
    if any(path is not None for path in (arguments.tls_ca, arguments.tls_cert, arguments.tls_key)):
        raise UsageError("--tls-ca, --tls-cert and --tls-key go with --scheduler tls://…")
