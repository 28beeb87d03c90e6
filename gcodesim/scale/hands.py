"""Who does tasks, as those who have some see it: a task, its end, and this process as the simplest who does them."""

from __future__ import annotations

import json
from collections.abc import Generator, Iterable
from typing import Any, Final, Protocol

from gcodesim.frozen import frozen
from gcodesim.scale.abilities import abilities
from gcodesim.scale.bundle import FileBundle, digest_of
from gcodesim.scale.worker import NEEDED, Work, work


@frozen(eq=False)
class Parcel:
    """A packed bundle of files that tasks share; it travels once to each worker."""

    data: bytes
    digest: str

    @staticmethod
    def of(bundle: FileBundle) -> Parcel:
        data = bundle.pack()
        return Parcel(data=data, digest=digest_of(data))


NO_FILES: Final = Parcel.of(FileBundle(files={}))


@frozen(eq=False)
class WorkerTask:
    """What a worker is told (JSON), with its files; `key` is a hash of all that decides its result."""

    key: str
    said: Any
    parcel: Parcel = NO_FILES

    @property
    def request(self) -> bytes:
        asked = {NEEDED: dict(abilities()), "said": self.said}
        return json.dumps(asked, allow_nan=False, sort_keys=True).encode()


@frozen(eq=False)
class Ended:
    """A task and what came of it; `lost` says why nothing did, `fault` is the trace of a fault in the code itself."""

    task: WorkerTask
    made: FileBundle = FileBundle(files={})
    took_s: float = 0.0
    lost: str = ""
    fault: str = ""


class Hands(Protocol):
    """Does tasks."""

    @property
    def count(self) -> int:
        """How many tasks are done at once, as far as is known."""

    def do(self, what: Work, tasks: Iterable[WorkerTask]) -> Generator[Ended, None, None]:
        """Do `what` with each task; they end in any order. Closing it gives up what is not done."""


class Alone:
    """This process does one task after the other, without an engine."""

    count = 1

    def do(self, what: Work, tasks: Iterable[WorkerTask]) -> Generator[Ended, None, None]:
        for task in tasks:
            yield ended(task, work(what, task.request, task.parcel.data))


def ended(task: WorkerTask, reply: bytes) -> Ended:
    """The end of a task from the reply of its worker; BundleError if that is none."""
    bundle = FileBundle.unpack(reply)
    said = bundle.said
    if said.get("fault"):
        return Ended(task=task, fault=str(said["fault"]))
    return Ended(task=task, made=FileBundle(files=bundle.files, said=said["said"]), took_s=float(said["took_s"]))
