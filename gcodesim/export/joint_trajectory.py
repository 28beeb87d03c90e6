"""The commanded joints of a run as one trajectory of ROS, and how far a real arm was off it."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.declarations.scalars import measured
from gcodesim.export.select import TimeRange
from gcodesim.frozen import frozen
from gcodesim.playback.recording import Recording
from gcodesim.units import NS_PER_SECOND

Array = NDArray[np.float64]

KIND: Final = "trajectory_msgs/msg/JointTrajectory"
TOPIC: Final = "/joint_trajectory"
_SEARCH: Final = 401  # shifts in time that are tried, coarse and then fine


@frozen(kw_only=False, eq=False)
class JointTrajectory:
    """Joints by the `names` of their description at times `t_ns` (n,) from the start: `position` and `velocity` (n, j)
    [rad, m, and per s]."""

    names: tuple[str, ...]
    t_ns: NDArray[np.int64]
    position: Array
    velocity: Array

    @staticmethod
    def of(recording: Recording, part: TimeRange) -> JointTrajectory:
        """What the first channel of a run was told, in a part of it. Velocities are slopes through the neighbours, and
        0 at both ends, as controllers ask for."""
        series = recording.series("/motion")
        names = [name for key, (name, *_) in series.texts.items() if key.endswith("].name")]
        if not names:
            return JointTrajectory((), np.zeros(0, dtype=np.int64), np.zeros((0, 0)), np.zeros((0, 0)))
        chosen = np.asarray(part.chosen(series.t_ns), dtype=np.int64)
        t_ns = series.t_ns[chosen]
        position = series.columns(*(f"joints[{name}].command" for name in names))[chosen]
        velocity = np.zeros_like(position)
        if len(t_ns) > 2:
            seconds = (t_ns[2:] - t_ns[:-2]) / NS_PER_SECOND
            velocity[1:-1] = (position[2:] - position[:-2]) / seconds[:, None]
        return JointTrajectory(_plain(names), t_ns - t_ns[:1], position, velocity)

    def as_json(self) -> dict[str, Any]:
        """The message as rosbridge takes it."""
        points = [
            {
                "positions": [float(v) for v in q],
                "velocities": [float(v) for v in v_q],
                "accelerations": [],
                "effort": [],
                "time_from_start": {"sec": int(t) // NS_PER_SECOND, "nanosec": int(t) % NS_PER_SECOND},
            }
            for t, q, v_q in zip(self.t_ns, self.position, self.velocity, strict=True)
        ]
        header = {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": ""}
        return {"header": header, "joint_names": list(self.names), "points": points}

    def at(self, t: Array) -> Array:
        """Joints (n, j) at times `t` (n,) [s] from the start, straight between points."""
        own = self.t_ns / NS_PER_SECOND
        return np.column_stack([np.interp(t, own, column) for column in self.position.T])


@frozen
class JointDeviation:
    """How far one joint was off [rad, m] at most, when [s from the start of the run], and as root mean square."""

    name: str
    most: float
    at: float
    mean: float


@frozen(kw_only=False, eq=False)
class StateRecord:
    """What a real arm told: `position` (n, j) of joints `names` at times `t` (n,) [s], from any zero."""

    names: tuple[str, ...]
    t: Array
    position: Array

    @staticmethod
    def of(messages: Sequence[Mapping[str, Any]]) -> StateRecord:
        """From messages sensor_msgs/JointState as JSON; those that lack a joint of the first one are left out."""
        names = _plain(messages[0]["name"]) if messages else ()
        rows, times = [], []
        for message in messages:
            told = dict(zip(_plain(message["name"]), message["position"], strict=False))
            if set(names) <= set(told):
                stamp = message["header"]["stamp"]
                times.append(
                    stamp.get("sec", stamp.get("secs", 0)) + 1e-9 * stamp.get("nanosec", stamp.get("nsecs", 0))
                )
                rows.append([float(told[name]) for name in names])
        return StateRecord(names, np.array(times), np.array(rows).reshape(len(rows), len(names)))


def read_state_table(path: Path) -> StateRecord:
    """Joint states of a CSV file: a column `time_s`, and one a joint by its name, in rad or m.

    OSError, or ValueError with the line that is wrong.
    """
    with path.open(encoding="utf-8-sig", newline="") as file:
        rows = [(number, row) for number, row in enumerate(csv.reader(file), 1) if any(row)]
    names = tuple(name.strip() for name in rows[0][1]) if rows else ()
    if "time_s" not in names or len(set(names)) < len(names):
        raise ValueError("the first line has to name the columns, `time_s` and each joint once")
    table = np.array([_numbers(row, len(names), number) for number, row in rows[1:]]).reshape(-1, len(names))
    time = names.index("time_s")
    return StateRecord(_plain(names[:time] + names[time + 1 :]), table[:, time], np.delete(table, time, axis=1))


def _numbers(row: Sequence[str], count: int, line: int) -> list[float]:
    values = [read.value for cell in row if (read := measured(cell.strip())) is not None and not read.unit]
    if len(values) != len(row) or len(row) != count:
        raise ValueError(f"line {line} has not {count} numbers")
    return values


def _plain(names: Iterable[str]) -> tuple[str, ...]:
    """Names of joints without that of their robot before them."""
    return tuple(name.rpartition("/")[2] for name in names)


def deviations(told: JointTrajectory, states: StateRecord) -> tuple[float, list[JointDeviation]]:
    """By how much later than the trajectory the arm's clock has to be read [s], and how far each joint was off then.

    A controller begins when the message has come, and its clock has another zero: the shift is the one with the least
    squares. ValueError where the states do not have the joints of the run.
    """
    missing = [name for name in told.names if name not in states.names]
    if missing or not len(states.t) or not len(told.t_ns):
        raise ValueError(f"the states do not tell joint {missing[0]}" if missing else "there is nothing to compare")
    seen = states.position[:, [states.names.index(name) for name in told.names]]
    end = told.t_ns[-1] / NS_PER_SECOND
    first, width = float(states.t[0]), float(states.t[-1] - states.t[0])
    low, high = first - end, first + width

    def off(shift: float) -> Array:
        found: Array = seen - told.at(states.t - shift)
        return found

    best = first
    for _ in range(3):
        tried = np.linspace(low, high, _SEARCH)
        best = float(min(tried, key=lambda shift: float(np.sum(np.square(off(shift))))))
        step = (high - low) / (_SEARCH - 1)
        low, high = best - step, best + step
    error = off(best)
    worst = np.abs(error).argmax(axis=0)
    return best, [
        JointDeviation(
            name=name,
            most=float(abs(error[worst[k], k])),
            at=float(np.clip(states.t[worst[k]] - best, 0.0, end)),
            mean=float(np.sqrt(np.mean(np.square(error[:, k])))),
        )
        for k, name in enumerate(told.names)
    ]
