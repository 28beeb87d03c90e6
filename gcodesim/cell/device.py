"""`devices:` of the cell: clamps, doors, feeders and conveyors that words of the program switch."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from typing import ClassVar, Final

import numpy as np

from gcodesim.cell.placing import names_of
from gcodesim.cell.signals import WORD, SignalWord
from gcodesim.cell.stock import Fixture
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import NOT_NEGATIVE, WITHIN_REACH, Range
from gcodesim.declarations.map_of import MapOf
from gcodesim.declarations.quantity import Quantity, Vector
from gcodesim.declarations.reading import Path, Reading, Unread
from gcodesim.declarations.record import Record
from gcodesim.frames import Array
from gcodesim.frozen import frozen


@frozen
class Device(Fixture):
    """What a word switches: it goes by `travel` when it is on, or moves what lies on it while it is on."""

    what: ClassVar[str] = "device"

    word: SignalWord = key(WORD, "what switches it: an output such as `M62 P1`, `M3/M5`, or codes such as `M10/M11`")
    travel: tuple[float, float, float] = key(
        Vector(Quantity("length", WITHIN_REACH), 3),
        "where it goes when it is switched on, in its frame; a clamp, a door, a feeder",
        default=(0.0, 0.0, 0.0),
        quiet=True,
        example="[0, 0, 300 mm]",
    )
    travel_time: float = key(Quantity("time", NOT_NEGATIVE), "that it takes there, and back", default=0.0, quiet=True)
    awaited: bool = key(
        "switch", "the program waits `travel_time` each time it switches it, as for a clamp", default=False, quiet=True
    )
    speed: float = key(
        Quantity("speed", Range(least=0.0, most=100.0)),
        "of a conveyor along X of its frame while it is on; what lies on it goes along, up to its end",
        default=0.0,
        quiet=True,
        example="0.2 m/s",
    )
    channel: str | None = key(
        "text", "the channel whose program switches it", default=None, rule="the first", quiet=True
    )

    def checked(self, to: Reading, path: Path) -> Device | Unread:
        shaped = Fixture.checked(self, to, path)
        if isinstance(shaped, Unread):
            return shaped
        if self.speed > 0.0 and any(self.travel):
            return to.fault(
                "GS719",
                to.key((*path, "speed")),
                "a device has `travel` or `speed`, not both",
                "make it two devices",
            )
        return shaped  # type: ignore[return-value]


DEVICES: Final = MapOf(
    names_of("device"),
    Record(Device, "the device"),
    "devices by name, such as `door: {box: [20, 600, 400], in: table, word: M64 P3, travel: [0, 600, 0]}`",
    lenient=True,
)


class DeviceHistory:
    """What a device does when it is switched at `times` (c,) [s] to `values` (c,), 0 before; see `Device`."""

    def __init__(self, device: Device, times: Sequence[float], values: Sequence[float]) -> None:
        self.device = device
        self.times = [0.0, *times]
        self._on = [0.0, *(float(value != 0.0) for value in values)]
        self._value = [0.0, *values]
        self._share, self._way = [0.0], [0.0]
        for i in range(1, len(self.times)):
            after = self.times[i] - self.times[i - 1]
            self._share.append(self._share_after(i - 1, after))
            self._way.append(self._way[-1] + device.speed * self._on[i - 1] * after)

    def _share_after(self, i: int, seconds: float) -> float:
        if self.device.travel_time <= 0.0:
            return self._on[i]
        change = seconds / self.device.travel_time
        now = self._share[i]
        return min(now + change, 1.0) if self._on[i] else max(now - change, 0.0)

    def share(self, time: float) -> float:
        """How much of its travel it has made at `time` [s]: 0 to 1."""
        i = max(bisect_right(self.times, time) - 1, 0)
        return self._share_after(i, max(time - self.times[i], 0.0))

    def turns(self) -> list[float]:
        """Times [s] at which it is switched, and at which it then comes to rest unless it is switched before."""
        left = [1.0 - share if on else share for share, on in zip(self._share, self._on, strict=True)]
        rests = [t + part * self.device.travel_time for t, part in zip(self.times, left, strict=True)]
        return [*self.times, *rests]

    def shifts(self, time: Array) -> Array:
        """Where it is (n, 3) [m] in its frame at times (n,), seen from where it starts; of a conveyor, the belt."""
        device = self.device
        if device.speed > 0.0:
            begins, on, way = np.array(self.times), np.array(self._on), np.array(self._way)
            i = np.maximum(np.searchsorted(begins, time, side="right") - 1, 0)
            belt = way[i] + device.speed * on[i] * np.maximum(time - begins[i], 0.0)
            return np.column_stack([belt, np.zeros((len(time), 2))])
        shares = np.array([self.share(float(t)) for t in time])
        shifts: Array = shares[:, None] * np.array(device.travel)
        return shifts

    def state(self, time: float) -> tuple[float, float | None]:
        """What an input reads at `time` [s], 1 when it has arrived, and when it will [s] if it is on the way there."""
        device = self.device
        i = max(bisect_right(self.times, time) - 1, 0)
        if device.speed > 0.0:
            return self._on[i], None
        share = self.share(time)
        if share >= 1.0:
            return 1.0, None
        return 0.0, time + (1.0 - share) * device.travel_time if self._on[i] else None
