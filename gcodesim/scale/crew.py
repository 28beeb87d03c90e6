"""Workers on Dask: a cluster of processes on this machine, or a scheduler that stands somewhere.

A task is a function by its name, and bytes. The files of tasks travel as tasks of their own, whose results the
scheduler hands on and makes again where they are lost. No more tasks than the workers need soon are under way, so the
memory of this process does not grow with their number. Who does not have the same code gets no work.
"""

from __future__ import annotations

import logging
import math
import time
import warnings
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from threading import Timer
from typing import TYPE_CHECKING, Any, Final

from gcodesim.extras import require_extra
from gcodesim.frozen import frozen
from gcodesim.numbers import read_json
from gcodesim.scale.abilities import abilities, misfits
from gcodesim.scale.bundle import FileBundle
from gcodesim.scale.hands import Ended, WorkerTask, ended
from gcodesim.scale.interrupts import interrupts_wait
from gcodesim.scale.worker import UNFIT, Work, carried, hello, work

if TYPE_CHECKING:
    from distributed import Client, Future, LocalCluster, Security

_AHEAD: Final = 3  # tasks a thread of a worker has waiting, so that it is never idle
_LEAST_AHEAD: Final = 16
_PARCELS: Final = 8  # of which none of the tasks under way needs one
_LOOK_AGAIN_S: Final = 2.0  # at who has joined
_LOOK_S: Final = 0.5  # between two looks at whether all is well, while nothing ends
_WAIT_FOR_WORKERS_S: Final = 30.0
ABANDONED_S: float = 60.0
"""How long tasks wait for a worker after all have left."""
_WAIT_FOR_SCHEDULER_S: Final = 30.0  # it may have much to do
_SAY_AFTER_S: Final = 3.0  # what is waited for
_ARRIVE_S: Final = 2.0  # what results that are on their way get when nobody wants them any more
_LOGGERS: Final = ("distributed", "tornado", "bokeh", "asyncio")  # of the engine, with all below them
_NOTHING_KEPT: Final = {  # for developers of the engine: the last thousand messages, with what they carried, and more
    "distributed.admin.log-length": 0,
    "distributed.admin.low-level-log-length": 0,
    "distributed.admin.system-monitor.log-length": 1,
    "distributed.diagnostics.computations.max-history": 1,
    "distributed.diagnostics.erred-tasks.max-history": 1,
}


class NoWorkersError(Exception):
    """Nobody can be reached who may do the work; the text says why."""


class SchedulerLostError(Exception):
    """The scheduler is gone; tasks that had not ended by then are not done."""


@frozen
class Keys:
    """Files (PEM) of a TLS connection: the authority that signed both sides, own certificate and own key."""

    authority: Path
    certificate: Path
    key: Path


@contextmanager
def local_crew(jobs: int, tell: Callable[[str], None] = print) -> Iterator[Crew]:
    """`jobs` processes on this machine, which end with this one. They talk by TLS with keys made for them alone."""
    require_extra("scale", "work in several processes")
    import dask
    from distributed import LocalCluster, Security

    _be_quiet()
    secret = Security.temporary()
    settings = {
        **_NOTHING_KEPT,
        "distributed.scheduler.worker-saturation": float(_AHEAD),
        "distributed.scheduler.http.routes": [],  # nobody is told of the tasks without TLS
    }
    with ExitStack() as stack:
        stack.enter_context(dask.config.set(settings))
        with interrupts_wait():  # threads and processes that begin here leave a Ctrl-C to us, also those begun later
            cluster = stack.enter_context(
                LocalCluster(
                    n_workers=jobs,
                    threads_per_worker=1,
                    processes=True,
                    host="127.0.0.1",
                    protocol="tls://",
                    security=secret,
                    scheduler_kwargs={"dashboard": False, "dashboard_address": "127.0.0.1:0"},  # else all want one port
                    worker_dashboard_address=None,
                    silence_logs=logging.CRITICAL,
                )
            )
            client = stack.enter_context(_client_of(cluster, secret))
        yield Crew(client, tell)


@contextmanager
def crew_at(address: str, keys: Keys | None = None, tell: Callable[[str], None] = print) -> Iterator[Crew]:
    """The workers of the scheduler at `address`. NoWorkersError if it cannot be reached or has none that may work."""
    require_extra("scale", "work on a scheduler")
    import dask
    from distributed import Security

    _be_quiet()
    secret = None
    if keys is not None:
        secret = Security(
            tls_ca_file=str(keys.authority),
            tls_client_cert=str(keys.certificate),
            tls_client_key=str(keys.key),
            require_encryption=True,
        )
    with dask.config.set(_NOTHING_KEPT):
        try:
            with _said_if_slow(tell, f"waiting up to {_WAIT_FOR_SCHEDULER_S:.0f} s for the scheduler at {address}"):
                client = _client_of(address, secret)
        except (OSError, ValueError, TypeError, RuntimeError) as error:
            raise NoWorkersError(f"the scheduler at {address} cannot be reached: {error}") from None
        try:
            yield Crew(client, tell)
        finally:
            with suppress(Exception):  # it may be gone
                client.close(timeout=2)


def _client_of(scheduler: str | LocalCluster, secret: Security | None) -> Client:
    """A client that leaves nothing behind: neither when it cannot connect, nor of the tasks that it submits.

    One that cannot connect would be closed whenever it is collected: also while another opens, and each would wait for
    the other. And a scheduler keeps what each submission says of the collections behind it as long as tasks of the same
    name go on; ours have none behind them.
    """
    from distributed import Client

    class LeavesNothing(Client):  # type: ignore[misc]
        def start(self, **named: Any) -> None:
            try:
                super().start(**named)
            except BaseException:
                self.close(timeout=2)
                raise

        def _graph_to_futures(self, *given: Any, **named: Any) -> Any:
            if "span_metadata" in named:
                named["span_metadata"] = {}
            return super()._graph_to_futures(*given, **named)

    return LeavesNothing(scheduler, security=secret, set_as_default=False, timeout=_WAIT_FOR_SCHEDULER_S)


@contextmanager
def _said_if_slow(tell: Callable[[str], None], text: str) -> Iterator[None]:
    """Tell `text` when what is done meanwhile takes a while."""
    timer = Timer(_SAY_AFTER_S, tell, [text])
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()


def _forget_names() -> None:
    """Clear where the engine remembers 100,000 names of tasks, 40 MB of them; of ours none comes a second time."""
    from dask.utils import key_split

    with suppress(AttributeError):  # other versions may remember none
        key_split.cache_clear()


class Crew:
    """The workers behind a client of Dask."""

    def __init__(self, client: Client, tell: Callable[[str], None]) -> None:
        self._client = client
        self._tell = tell
        self._threads: dict[str, int] = {}  # of workers that may work, by address
        self._refused: set[str] = set()
        self._parcels: dict[str, Future[bytes]] = {}
        self._looked = -math.inf
        self._seen = time.monotonic()  # when there was somebody to work
        with _said_if_slow(tell, f"waiting up to {_WAIT_FOR_WORKERS_S:.0f} s for workers to join the scheduler"):
            self._meet(wait=True)

    @property
    def count(self) -> int:
        return max(sum(self._threads.values()), 1)

    def do(self, what: Work, tasks: Iterable[WorkerTask]) -> Generator[Ended, None, None]:
        """As `Hands` has it. SchedulerLostError, NoWorkersError."""
        from distributed import as_completed

        ahead = iter(tasks)
        under_way: dict[Any, tuple[WorkerTask, Future[bytes]]] = {}
        done = as_completed(loop=self._client.loop, with_results=True, raise_errors=False)
        try:
            while True:
                self._meet()
                while len(under_way) < max(_AHEAD * self.count, _LEAST_AHEAD) and (task := next(ahead, None)):
                    future = self._submit(what, task)
                    under_way[future.key] = task, future
                    done.add(future)
                if not under_way:
                    return
                for future, reply in self._next(done):
                    task, _ = under_way.pop(future.key)
                    end = self._ended(what, task, future, reply)
                    if end is None:  # somebody else does it
                        again = self._submit(what, task, again=True)
                        under_way[again.key] = task, again
                        done.add(again)
                    else:
                        yield end
        finally:
            futures = [future for _, future in under_way.values()]
            if futures and self._client.status == "running":
                with suppress(Exception):  # whatever keeps it from hearing that nobody wants them any more
                    self._client.cancel(futures, force=True)
                    _let_arrive(done)

    def _next(self, done: Any) -> list[tuple[Any, Any]]:
        """What has ended since; waits for something. NoWorkersError when nobody has been there for a while.

        SchedulerLostError also where the engine still looks for the scheduler: what was asked is forgotten there.
        """
        while not done.has_ready():
            with done.thread_condition:
                if not done.has_ready():
                    done.thread_condition.wait(timeout=_LOOK_S)
            self._check_that_the_scheduler_stands()
            self._meet()
            if not self._threads and time.monotonic() - self._seen > ABANDONED_S:
                raise NoWorkersError(f"no worker has been there for {ABANDONED_S:.0f} s")
        batch: list[tuple[Any, Any]] = done.next_batch()
        return batch

    def _submit(self, what: Work, task: WorkerTask, again: bool = False) -> Future[bytes]:
        self._check_that_somebody_may()
        key = f"gcodesim-{task.key}" + (f"-{time.monotonic_ns()}" if again else "")
        who = list(self._threads) if self._refused else None
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)  # it says that a parcel of more than 10 MB is large
            return self._client.submit(
                work, what, task.request, self._parcel(task), key=key, pure=False, workers=who, retries=0
            )

    def _parcel(self, task: WorkerTask) -> Future[bytes]:
        digest = task.parcel.digest
        if digest not in self._parcels:
            while len(self._parcels) >= _PARCELS:  # tasks under way keep the scheduler from forgetting theirs
                del self._parcels[next(iter(self._parcels))]
            self._parcels[digest] = self._client.submit(
                carried, task.parcel.data, key=f"gcodesim-files-{digest}", pure=False
            )
        return self._parcels[digest]

    def _ended(self, what: Work, task: WorkerTask, future: Future[bytes], reply: Any) -> Ended | None:
        """The end of a task; None if its worker must not work, so that somebody else has to."""
        status = future.status
        future.release()
        if isinstance(reply, bytes):  # has come, whatever has become of its worker since
            said = FileBundle.unpack(reply).said
            if said.get("state") != UNFIT:
                return ended(task, reply)
            self._looked = -math.inf
            self._meet()
            self._check_that_somebody_may()
            return None
        if status in ("cancelled", "lost"):
            raise SchedulerLostError("the scheduler is gone")
        self._check_that_the_scheduler_stands()
        reason = reply[1] if isinstance(reply, tuple) and len(reply) == 3 else reply
        if type(reason).__name__ == "KilledWorker":
            return Ended(task=task, lost="each worker that began it died, perhaps for want of memory")
        return Ended(task=task, fault=f"{type(reason).__name__}: {reason}")

    def _meet(self, wait: bool = False) -> None:
        """Ask those who have joined what they can do, and tell of those who must not work."""
        if time.monotonic() - self._looked < _LOOK_AGAIN_S and not wait:
            return
        until = time.monotonic() + (_WAIT_FOR_WORKERS_S if wait else 0.0)
        while True:
            present = self._present()
            self._threads = {address: n for address, n in self._threads.items() if address in present}
            self._refused &= set(present)
            new = [address for address in present if address not in self._threads and address not in self._refused]
            if new:
                self._ask(new, present)
            if self._threads or self._refused or time.monotonic() > until:
                break
            time.sleep(0.1)
        self._looked = time.monotonic()
        _forget_names()
        if self._threads:
            self._seen = self._looked
        if wait:
            self._check_that_somebody_may(joining=True)

    def _present(self) -> dict[str, int]:
        with suppress(Exception):  # it is told when a task is lost
            return dict(self._client.nthreads())
        return dict(self._threads)

    def _ask(self, addresses: list[str], threads: Mapping[str, int]) -> None:
        try:
            replies = self._client.run(hello, workers=addresses, on_error="return")
        except Exception as error:  # whatever keeps it from asking: they are asked again soon
            if self._client.status != "running":
                raise SchedulerLostError("the scheduler is gone") from error
            return
        for address in addresses:
            if isinstance(replies.get(address), OSError):  # it has gone meanwhile; if it has not, it is asked again
                continue
            reasons = _why_not(replies.get(address))
            if reasons:
                self._refused.add(address)
                self._tell(f"the worker at {address} gets no work: {'; '.join(reasons)}")
            else:
                self._threads[address] = threads[address]

    def _check_that_the_scheduler_stands(self) -> None:
        if self._client.status != "running":
            raise SchedulerLostError("the scheduler is gone")

    def _check_that_somebody_may(self, joining: bool = False) -> None:
        self._check_that_the_scheduler_stands()
        if self._threads:
            return
        if self._refused:
            raise NoWorkersError(
                "no worker may work: each needs the same version of gcodesim, its libraries and extras as are here"
            )
        if joining:
            raise NoWorkersError(f"no worker has joined the scheduler within {_WAIT_FOR_WORKERS_S:.0f} s")


def _why_not(reply: Any) -> list[str]:
    """Why the worker that gave this reply must not work."""
    if isinstance(reply, bytes):
        with suppress(ValueError, TypeError, AttributeError):
            known = read_json(reply)
            return misfits({str(name): str(value) for name, value in known.items()}, abilities())
    if isinstance(reply, Exception) and "No module named" in str(reply):
        return [f"gcodesim cannot be imported there ({reply})"]
    return [f"it does not answer as a worker of gcodesim does ({type(reply).__name__})"]


def _let_arrive(done: Any) -> None:
    """Wait until no result is on its way here: a client that closes meanwhile breaks off the connections they use."""
    until = time.monotonic() + _ARRIVE_S
    while not done.is_empty() and time.monotonic() < until:
        if not done.next_batch(block=False):
            time.sleep(0.01)


def _be_quiet() -> None:
    """Whatever is worth saying we say ourselves.

    The engine gives some of its loggers a level of their own when it is imported, `tornado.application` among them,
    which tells of each result that was on its way when a connection broke. So each logger is set, not only the roots.
    """
    for name in [*_LOGGERS, *logging.root.manager.loggerDict]:
        if name.split(".")[0] in _LOGGERS:
            logging.getLogger(name).setLevel(logging.CRITICAL)
