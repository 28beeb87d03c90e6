"""Who does the work of a command: this process, processes on this machine, or the workers of a scheduler."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from gcodesim.cli.exits import UsageError
from gcodesim.cli.output import note
from gcodesim.cli.suite import jobs_of

if TYPE_CHECKING:
    from gcodesim.scale.crew import Keys
    from gcodesim.scale.hands import Hands


@contextmanager
def hands_of(arguments: argparse.Namespace, most: int) -> Iterator[Hands]:
    """Who does up to `most` tasks. UsageError if a scheduler cannot be reached, or is lost on the way."""
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
