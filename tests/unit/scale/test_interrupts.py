"""Signals that come while processes are started."""

from __future__ import annotations

import signal

import pytest

from gcodesim.scale.interrupts import interrupts_wait

SIGNALS = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP]


@pytest.fixture
def heard() -> list[int]:
    """The signals that their own handlers have heard."""
    came: list[int] = []
    before = {number: signal.signal(number, lambda number, _: came.append(number)) for number in SIGNALS}
    yield came
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.mark.parametrize("number", SIGNALS)
def test_a_signal_is_heard_when_all_have_been_started(heard: list[int], number: signal.Signals) -> None:
    """A SIGTERM while Dask starts its workers ended with a traceback: Dask closed what was not open yet."""
    with interrupts_wait():
        signal.raise_signal(number)
        assert heard == []
    assert heard == [number]


def test_what_is_ignored_stays_so_where_processes_begin(heard: list[int]) -> None:
    """As under `nohup`; workers inherit that, and would not inherit a handler."""
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    with interrupts_wait():
        assert signal.getsignal(signal.SIGHUP) == signal.SIG_IGN
        signal.raise_signal(signal.SIGHUP)
    assert heard == []
