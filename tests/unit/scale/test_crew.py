"""Workers that are processes of their own: who may work, who dies, and what comes back."""

from __future__ import annotations

import asyncio
import gc
import logging
import math
import socket
import time
import tracemalloc
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest

from gcodesim.scale.crew import Crew, Keys, NoWorkersError, SchedulerLostError, crew_at, local_crew
from gcodesim.scale.hands import Alone, WorkerTask
from gcodesim.scale.worker import stand_in
from tests.cluster import Cluster, cluster, kill

__all__ = ["cluster"]
OTHER_VERSION = "import gcodesim.version\ngcodesim.version.__version__ = '9.9.9'\n"
NO_COLLADA = """import importlib.metadata
version = importlib.metadata.version
def known(name):
    if name == 'pycollada':
        raise importlib.metadata.PackageNotFoundError(name)
    return version(name)
importlib.metadata.version = known
"""
NOT_INSTALLED = """import sys
class No:
    def find_spec(self, name, path=None, target=None):
        if name.split('.')[0] == 'gcodesim':
            raise ModuleNotFoundError("No module named 'gcodesim'")
sys.meta_path.insert(0, No())
"""


def tasks(count: int, takes_s: float = 0.01):
    return (
        WorkerTask(key=f"{takes_s}-{number}", said={"number": number, "takes_s": takes_s}) for number in range(count)
    )


def numbers(ends) -> list[int]:
    return sorted(end.made.said["number"] for end in ends)


def test_where_nobody_fits_the_reasons_are_told(cluster):
    one = cluster()
    one.add(OTHER_VERSION)
    one.add(NOT_INSTALLED)
    one.wait_for_workers(2)
    told: list[str] = []

    with pytest.raises(NoWorkersError, match="no worker may work"), crew_at(one.address, tell=told.append):
        pass

    for words in ("gcodesim 9.9.9 in place of", "cannot be imported"):
        assert any(words in text for text in told), told


def test_whoever_joins_later_and_does_not_fit_does_not_begin(standing: Cluster, monkeypatch: pytest.MonkeyPatch):
    """It gets a task before it was asked what it can do, and refuses by itself."""
    monkeypatch.setattr("gcodesim.scale.crew._LOOK_AGAIN_S", math.inf)
    told: list[str] = []
    given: list[WorkerTask] = []

    def until_told() -> Iterator[WorkerTask]:
        """Whom the engine gives the next task is its own affair."""
        for task in tasks(10_000):
            if len(told) == 2:
                return
            given.append(task)
            yield task

    with crew_at(standing.address, tell=told.append) as crew:
        strangers = [standing.add(OTHER_VERSION), standing.add(NO_COLLADA)]
        try:
            standing.wait_for_workers(4)

            assert numbers(crew.do(stand_in, until_told())) == list(range(len(given)))
        finally:
            for stranger in strangers:
                kill(stranger)
            standing.wait_for_workers(2)

    assert any("gcodesim 9.9.9 in place of" in text for text in told)
    assert any("no pycollada" in text for text in told), told


def test_a_killed_worker_costs_no_task_and_without_any_nobody_waits_for_ever(cluster, monkeypatch: pytest.MonkeyPatch):
    one = cluster(workers=2)
    with crew_at(one.address) as crew:
        ends = crew.do(stand_in, tasks(40, 0.05))
        first = [next(ends) for _ in range(5)]
        kill(one.workers[0])
        assert numbers([*first, *ends]) == list(range(40))

        monkeypatch.setattr("gcodesim.scale.crew.ABANDONED_S", 0.0)
        ends = crew.do(stand_in, tasks(1000, 0.06))
        assert len([next(ends) for _ in range(50)]) == 50  # who is there has not left between two looks at who is
        kill(one.workers[1])
        with pytest.raises(NoWorkersError, match="no worker"):
            list(ends)


def test_results_that_have_come_stay_when_their_worker_dies(cluster, monkeypatch: pytest.MonkeyPatch):
    """They wait for their turn while earlier ones are written."""
    one = cluster(workers=1)
    next_batch = Crew._next

    def when_all_have_come(crew, done):
        while len(done.queue.queue) < 10:
            time.sleep(0.01)
        return next_batch(crew, done)

    monkeypatch.setattr(Crew, "_next", when_all_have_come)
    with crew_at(one.address) as crew:
        ends = crew.do(stand_in, tasks(10))
        first = next(ends)
        kill(one.workers[0])
        while not any(state.status == "lost" for state in list(crew._client.futures.values())):
            time.sleep(0.01)

        assert numbers([first, *ends]) == list(range(10))


def test_a_scheduler_that_goes_between_two_tasks_is_lost(cluster, monkeypatch: pytest.MonkeyPatch):
    """What is asked while the engine still looks for it would wait until that gives up."""
    monkeypatch.setattr("gcodesim.scale.crew._WAIT_FOR_SCHEDULER_S", 600.0)
    one = cluster(workers=1)

    def late() -> Iterator[WorkerTask]:
        kill(one.scheduler)
        while crew._client.status == "running":
            time.sleep(0.01)
        yield from tasks(3)

    with crew_at(one.address) as crew:
        with pytest.raises(SchedulerLostError):
            list(crew.do(stand_in, late()))
        assert crew._client.status == "connecting"


def test_a_worker_that_goes_while_it_is_asked_is_not_refused(standing: Cluster, monkeypatch: pytest.MonkeyPatch):
    """It may come back, and others may join: they are waited for."""
    from distributed import Client
    from distributed.comm import CommClosedError

    monkeypatch.setattr(Client, "run", lambda self, *_, workers, **__: dict.fromkeys(workers, CommClosedError("gone")))
    monkeypatch.setattr("gcodesim.scale.crew._WAIT_FOR_WORKERS_S", 0.0)

    with pytest.raises(NoWorkersError, match="no worker has joined"), crew_at(standing.address, tell=pytest.fail):
        pass


def test_tls_keeps_strangers_out(cluster, tmp_path: Path):
    from distributed import Security

    secret = Security.temporary()
    files = {"ca-file": secret.tls_ca_file, "cert": secret.tls_client_cert, "key": secret.tls_client_key}
    words = ["--protocol", "tls"]
    for name, text in files.items():
        (tmp_path / f"{name}.pem").write_text(text)
        words += [f"--tls-{name}", str(tmp_path / f"{name}.pem")]
    one = cluster(workers=1, words=words, secret=secret)
    authority, certificate, key = (tmp_path / f"{name}.pem" for name in files)
    keys = Keys(authority=authority, certificate=certificate, key=key)

    assert one.address.startswith("tls://")
    with crew_at(one.address, keys) as crew:
        assert numbers(crew.do(stand_in, tasks(5))) == list(range(5))
    with pytest.raises(NoWorkersError, match="cannot be reached"), crew_at(one.address):
        pass


def test_a_fault_comes_back_as_text_not_as_an_object():
    (end,) = Alone().do(stand_in, [WorkerTask(key="a", said={"number": 1, "takes_s": "x"})])

    assert "could not convert string to float" in end.fault
    assert isinstance(end.fault, str)


@contextmanager
def taken(port: int) -> Iterator[None]:
    with socket.socket() as other:
        with suppress(OSError):  # somebody else has it
            other.bind(("127.0.0.1", port))
            other.listen()
        yield


@pytest.mark.slow
def test_ten_thousand_tasks_need_no_more_memory_than_one_thousand():
    """Also beside another sweep, which has the usual port of a scheduler's pages."""
    with taken(8787), local_crew(2, tell=pytest.fail) as crew:
        assert numbers(crew.do(stand_in, tasks(500, 0.001))) == list(range(500))
        tracemalloc.start()
        kept = []
        for count in (1000, 10_000):
            before, most = memory_in_use(), 0
            for number, _ in enumerate(crew.do(stand_in, tasks(count, 0.002)), start=1):
                if number % 500 == 0:
                    most = max(most, memory_in_use() - before)
            assert number == count
            kept.append(most)
        tracemalloc.stop()

    assert kept[1] < kept[0] + 0.5e6, kept


def memory_in_use() -> int:
    """Without what waits for the collector of garbage, which comes when it likes.

    Nor with pieces of a megabyte or more: Python's table of interned names is one of 2 MB, which is made anew at times,
    and is counted from then on. Messages and tasks are small.
    """
    gc.collect()
    return sum(trace.size for trace in tracemalloc.take_snapshot().traces if trace.size < 1_000_000)


def test_who_leaves_waits_for_results_that_are_on_their_way(standing: Cluster, monkeypatch: pytest.MonkeyPatch):
    """Else the client closes below them, and tornado tells of each."""
    from distributed import Client

    from gcodesim.scale import crew as module

    under_way: list[object] = []
    at_the_close: list[int] = []
    may_arrive = asyncio.Event()
    gather, close, let_arrive = Client._gather, Client.close, module._let_arrive
    first = iter([True])

    async def slow(self, futures, *args, **named):
        if next(first, False):
            return await gather(self, futures, *args, **named)
        under_way.append(futures)
        await may_arrive.wait()
        try:
            return await gather(self, futures, *args, **named)
        finally:
            under_way.remove(futures)

    def leaving(done):
        done.loop.add_callback(may_arrive.set)
        let_arrive(done)

    def closing(self, *args, **named):
        at_the_close.append(len(under_way))
        close(self, *args, **named)

    monkeypatch.setattr(Client, "_gather", slow)
    monkeypatch.setattr(Client, "close", closing)
    monkeypatch.setattr(module, "_let_arrive", leaving)
    monkeypatch.setattr(module, "_ARRIVE_S", 600.0)
    with crew_at(standing.address) as crew:
        ends = crew.do(stand_in, tasks(30, takes_s=0.012))
        next(ends)
        while not under_way:
            time.sleep(0.01)
        ends.close()

    assert at_the_close[0] == 0


def test_the_engine_tells_nothing_by_itself(standing: Cluster):
    logging.getLogger("tornado.application").setLevel(logging.ERROR)  # as the engine does when it is imported
    with crew_at(standing.address):
        pass

    names = [name for name in logging.root.manager.loggerDict if name.startswith(("distributed.", "tornado."))]
    assert len(names) > 10
    assert [name for name in names if logging.getLogger(name).isEnabledFor(logging.ERROR)] == []


def test_a_client_that_cannot_connect_is_closed_at_once(monkeypatch: pytest.MonkeyPatch):
    """Not whenever it is collected, which may be while the next one opens."""
    from distributed import Client

    begun: list[Client] = []
    start = Client.start

    def starting(self, **named):
        begun.append(self)
        start(self, **named)

    monkeypatch.setattr(Client, "start", starting)
    with pytest.raises(NoWorkersError, match="cannot be reached"), crew_at("tls://127.0.0.1:9"):
        pass

    assert [client.status for client in begun] == ["closed"]


def test_who_waits_for_a_scheduler_or_for_workers_says_so(cluster, monkeypatch: pytest.MonkeyPatch):
    alone = cluster(workers=0)
    monkeypatch.setattr("gcodesim.scale.crew._WAIT_FOR_SCHEDULER_S", 0.5)
    monkeypatch.setattr("gcodesim.scale.crew._WAIT_FOR_WORKERS_S", 0.5)
    monkeypatch.setattr("gcodesim.scale.crew._SAY_AFTER_S", 0.01)
    told: list[str] = []

    with pytest.raises(NoWorkersError, match="cannot be reached"), crew_at("tcp://127.0.0.1:9", tell=told.append):
        pass
    with pytest.raises(NoWorkersError, match="no worker has joined"), crew_at(alone.address, tell=told.append):
        pass

    assert "for the scheduler at tcp://127.0.0.1:9" in told[0]
    assert any("for workers to join" in text for text in told)
