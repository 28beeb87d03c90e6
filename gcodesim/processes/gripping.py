"""Gripping: a gripper takes a part, carries it as long as statics allows, and lets it go.

A part counts as rigidly held while the force that the grip has is at least the force that it needs; the step in which
it needs more, the part slips out and is lost. What it needs follows from the weight in the attitude of the tool and
from the acceleration that the command gives to the part's centre of mass (`tools.grip_laws`). As long as the tool has
not moved since it closed, whatever the part lies on carries it.

A gripper that holds by contacts leaves all that to the contact forces of a world that has them: there the part slides,
turns between the pads, and is lost when nothing touches it any more.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Final, Protocol

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import applied, inverse_pose, multiplied, norms
from gcodesim.frozen import frozen
from gcodesim.processes.column import FINDINGS, LINES, LOG, RESULTS, Column
from gcodesim.processes.protocol import ActsOn, Process
from gcodesim.processes.signal import SetBy, Signal
from gcodesim.processes.window import ProcessState, ProcessStep, Window
from gcodesim.tools.grip_laws import load_of

if TYPE_CHECKING:
    from gcodesim.processes.materials import Material
    from gcodesim.solids.mesh_file import Triangles
    from gcodesim.tools.gripper import Gripper, PadFaces

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

GRIP: Final = Signal("grip", set_by=(SetBy("gripper", "close", 1.0), SetBy("gripper", "open", 0.0)))
"""1: close the fingers, switch on the vacuum; 0: open, switch off."""

OPENING: Final = Signal("opening", default=1.0, least=0.0, most=1.0)
"""How far the fingers open, 0 to 1 of their stroke."""

STILL: Final = 1e-6
"""[m] by which the tool may have moved since it closed and still leaves the part to what it lies on."""

Found = tuple[float, int, str, Array, Array, float]
"""A part that could be taken: how far off it is [m], its index and name, X_TP, contacts, and the opening then."""

Slid = tuple[Array, int | None]
"""X_TP (m, 4, 4) of a part that may slide, and the step in which it is lost."""

SLIDING_TURN: Final = 2e-3
"""[rad] by which it has to turn."""

SLIPS: Final = 5e-5
"""[m] by which a part has to move in the grip to count as sliding: less is the give of the contacts."""

OPEN, CLOSING, EMPTY, HOLDING = 0.0, 1.0, 2.0, 3.0
_CONTACTS: Final = 64  # rows of contacts that a state has room for


@frozen(eq=False)
class GripEvent:
    """Something that happened to a part in step `step` of a window.

    `kind` is `taken`, `lost`, `released`, `nothing`, `wide`, `held` (another gripper holds it) or `reserve`. `needs`
    and `has` are forces [N], of a `wide` part openings [m]; `height` [m] and `support` say how far it falls, and onto
    what ("": the floor).
    """

    step: int
    kind: str
    part: str = ""
    needs: float = 0.0
    has: float = 0.0
    height: float = 0.0
    support: str = ""
    other: str = ""


class PartsAtHand(Protocol):
    """The parts of the cell in the steps of one window, for one gripper; poses in the world W, which is the frame S."""

    names: tuple[str, ...]
    gravity: Array

    def skin(self, name: str) -> Triangles:
        """In the part's frame P."""

    def center(self, name: str) -> Array:
        """Its centre of mass (3,) [m] in P."""

    def mass(self, name: str, step: int) -> float:
        """[kg], with what stands on it."""

    def friction(self, name: str) -> float | None:
        """Its coefficient of friction, if it has one."""

    def poses(self, name: str) -> Array:
        """X_WP (n, 4, 4) at the ends of the steps."""

    def holder(self, name: str, step: int) -> str:
        """The other gripper that holds it, as `arm T7`; empty: none."""

    def tip_at_change(self, step: int) -> Array:
        """X_WT (4, 4) where the tip was when the command changed to what it is in the step."""

    def row_end(self, step: int) -> int:
        """The first later step that belongs to another row."""

    def take(self, step: int, name: str, X_TP: Array) -> None:
        """From the step on the gripper holds the part."""

    def slid(self, step: int, name: str, press: tuple[PadFaces, float, float], loads: Array) -> Slid | None:
        """Where contacts let a part go that pads hold, with a force [N] and friction, from the step on under `loads`

        (m, 3) [N] in T; None: this world knows no contacts.
        """

    def shift(self, step: int, name: str, X_WP: Array, X_TP: Array) -> None:
        """From the step on the part is at X_WP (m, 4, 4), and then held at X_TP (4, 4)."""

    def let_go(self, step: int, name: str, X_WP: Array, velocity: Array) -> tuple[float, str]:
        """From the step on nobody holds the part; how far [m] it falls, and onto what."""


class _State:
    """The numbers of a `ProcessState`, by names."""

    SIZE: Final = 6 + 3 * 16 + 4 * _CONTACTS + 1

    def __init__(self, values: Array) -> None:
        self.v = values

    def _matrix(self, index: int) -> Array:
        first = 6 + 16 * index
        return self.v[first : first + 16].reshape(4, 4)

    @property
    def contacts(self) -> Array:
        return self.v[54 : 54 + 4 * int(self.v[4])].reshape(-1, 4)

    @contacts.setter
    def contacts(self, rows: Array) -> None:
        count = min(len(rows), _CONTACTS)
        self.v[4] = count
        self.v[54 : 54 + 4 * count] = rows[:count].ravel()


@frozen(slots=False, eq=False)
class Gripping(Process):
    """What a gripper does with parts."""

    kind: ClassVar[str] = "gripping"
    acts_on: ClassVar[ActsOn] = "parts"
    reads: ClassVar[tuple[Signal, ...]] = (GRIP, OPENING)
    writes: ClassVar[tuple[Column, ...]] = (
        Column("held", of="any", says="a part is held"),
        Column("grip_needed", "N", "greatest", LOG | LINES | RESULTS, "force that holding the part takes"),
        Column("grip_load", "", "greatest", RESULTS, "part of the force that is used"),
        Column("opening", "m", "last", LOG, "of the fingers"),
        Column("grip_event", "", "any", FINDINGS, "something happened to a part"),
    )

    gripper: Gripper

    @classmethod
    def of(cls, tool: Gripper, material: Material | None) -> Gripping:
        return cls(gripper=tool)

    @classmethod
    def is_seen_on(cls, signals: Mapping[str, NDArray[Any]], tool: Gripper) -> Flags:
        """While it is told to be closed; only a vacuum shows that, fingers are seen by themselves."""
        return signals[GRIP.name] > 0.5

    @classmethod
    def needs(cls, tool: Gripper) -> tuple[Signal, ...]:
        return (OPENING,) if tool.widest else ()

    def begin(self) -> ProcessState:
        values = np.zeros(_State.SIZE)
        values[3] = -1.0
        return ProcessState(values=values)

    def run(self, parts: PartsAtHand, window: Window, state: ProcessState) -> ProcessStep:
        """See the module; the wrench of a part is not in here, since it belongs to the body on the flange."""
        assert window.pose is not None and window.pose_before is not None
        return _Shift(self.gripper, parts, window, _State(state.values)).done()


class _Shift:
    """One window of a gripper. `track` (n + 2, 4, 4) are X_WT from one step before the window on."""

    def __init__(self, gripper: Gripper, parts: PartsAtHand, window: Window, state: _State) -> None:
        self.gripper, self.parts, self.window, self.state = gripper, parts, window, state
        assert window.pose is not None and window.pose_before is not None
        n = window.steps
        previous = state._matrix(0) if state.v[0] else window.pose_before
        self.track = np.concatenate([previous[None], window.pose_before[None], window.pose])
        self.command: Flags = window.signals[GRIP.name] > 0.5
        self.events: list[GripEvent] = []
        wide = np.clip(window.signals[OPENING.name], 0.0, 1.0)
        self.open_to = wide
        self.columns: dict[str, Any] = {
            "held": np.zeros(n, dtype=bool),
            "engaged": np.zeros(n, dtype=bool),
            "grip_needed": np.zeros(n),
            "grip_load": np.zeros(n),
            "opening": np.zeros(n),
            "grip_event": np.zeros(n, dtype=bool),
        }

    def done(self) -> ProcessStep:
        """Go through the window from change to change."""
        v, n, k = self.state.v, self.window.steps, 0
        acts = {OPEN: self._open, CLOSING: self._closing, EMPTY: self._empty, HOLDING: self._holding}
        while k < n:
            k = acts[float(v[1])](k)
        v[0] = 1.0
        self.state._matrix(0)[:] = self.track[-2]
        for event in self.events:
            self.columns["grip_event"][event.step] = True
        return ProcessStep(
            wrench=np.zeros((n, 6)), deflection=np.zeros((n, 3)), columns=self.columns, changes=tuple(self.events)
        )

    def _next(self, k: int, wanted: bool) -> int:
        """The first step from `k` on in which the command is `wanted`; n: none."""
        found = np.flatnonzero(self.command[k:] == wanted)
        return k + int(found[0]) if len(found) else len(self.command)

    # ---- between takes

    def _open(self, k: int) -> int:
        end = self._next(k, True)
        self.columns["opening"][k:end] = self.open_to[k:end] * self.gripper.widest
        if end < len(self.command):
            v = self.state.v
            v[1], v[5] = CLOSING, self.open_to[end]
            found, _ = self._between(end, self.track[end + 1])
            v[-1] = found[0][-1] if found else 0.0
            v[2] = float(round(self.gripper.closing_time * (v[5] - v[-1]) / self.window.dt))
        return end

    def _closing(self, k: int) -> int:
        v, n = self.state.v, len(self.command)
        end, arrive = self._next(k, False), k + int(v[2])
        stop = min(end, arrive, n)
        left = (v[2] - 1.0 - np.arange(stop - k)) * self.window.dt / max(self.gripper.closing_time, self.window.dt)
        self.columns["opening"][k:stop] = (v[-1] + left) * self.gripper.widest
        if end < arrive:
            v[1] = OPEN
            return end
        if arrive >= n:
            v[2] -= n - k
            return n
        self._take(arrive, self.gripper.closing_time == 0.0)
        return arrive

    def _empty(self, k: int) -> int:
        end = self._next(k, False)
        if end < len(self.command):
            self.state.v[1] = OPEN
        return end

    def _take(self, k: int, at_change: bool) -> None:
        """Close on whatever is there."""
        v, parts = self.state.v, self.parts
        X_WT = parts.tip_at_change(k) if at_change else self.track[k + 1]
        found, wide = self._between(k, X_WT)
        v[1] = EMPTY
        if not found:
            kind = ("wide", wide[1], wide[0], float(v[5]) * self.gripper.widest) if wide else ("nothing", "", 0.0, 0.0)
            self.events.append(GripEvent(step=k, kind=kind[0], part=kind[1], needs=kind[2], has=kind[3]))
            return
        _, index, name, X_TP, contacts, opening = found[0]
        other = parts.holder(name, k)
        if other:
            self.events.append(GripEvent(step=k, kind="held", part=name, other=other))
            return
        v[1], v[2], v[3], v[5] = HOLDING, 0.0, float(index), opening
        self.state.contacts = contacts
        self.state._matrix(1)[:] = X_TP
        self.state._matrix(2)[:] = X_WT
        parts.take(k, name, X_TP)
        self.events.append(GripEvent(step=k, kind="taken", part=name))

    def _between(self, k: int, X_WT: Array) -> tuple[list[Found], tuple[float, str] | None]:
        """The parts that it could take in step `k` with its tip at X_WT, the nearest first; and the first too wide."""
        v, parts = self.state.v, self.parts
        X_TW = inverse_pose(X_WT[None])[0]
        found: list[Found] = []
        wide: tuple[float, str] | None = None
        for index, name in enumerate(parts.names):
            body = parts.skin(name)
            X_TP = multiplied(X_TW, parts.poses(name)[k])
            skin = (applied(X_TP[:3, :3], body.points) + X_TP[:3, 3])[body.faces]
            contact = self.gripper.contacts(skin, float(v[5]))
            if contact is not None:
                off = float(np.abs(contact[0][:, :3].mean(axis=0)).max())
                found.append((off, index, name, X_TP, *contact))
            elif (width := self.gripper.too_wide(skin, float(v[5]))) is not None:
                wide = min(wide or (width, name), (width, name))
        return sorted(found, key=lambda each: each[:2]), wide

    # ---- with a part

    def _holding(self, k: int) -> int:
        v, gripper, parts = self.state.v, self.gripper, self.parts
        n, end, dt = len(self.command), self._next(k, False), self.window.dt
        name = parts.names[int(v[3])]
        X_TP, taken_at = self.state._matrix(1).copy(), self.state._matrix(2)
        carried = multiplied(self.track, X_TP)
        center = applied(carried[:, :3, :3], parts.center(name)) + carried[:, :3, 3]
        needs = self._needs(name, k, center, X_TP)
        way = norms(self.track[2:, :3, 3] - taken_at[:3, 3])
        turned = np.abs(self.track[2:, :3, :3] - taken_at[:3, :3]).max(axis=(1, 2))
        lifted = np.zeros(n, dtype=bool)
        lifted[k:] = np.logical_or.accumulate((way[k:] > STILL) | (turned[k:] > STILL)) | (v[2] < 0.0)
        needs = np.where(lifted, needs, 0.0)
        has = gripper.has(self.state.contacts)
        slid = self._slid(name, k, end, X_TP, np.where(lifted[:, None], self._load(name, k, center), 0.0))
        if slid is None:
            lost = np.flatnonzero(needs[k:end] > has * (1.0 + 1e-9))
        else:
            lost = np.array([] if slid[1] is None else [slid[1]], dtype=np.intp)
        stop = k + int(lost[0]) if len(lost) else end
        if slid is not None and stop > k:
            X_TP = self._shifted(name, k, stop, X_TP, slid[0])
        held = slice(k, stop)
        self.columns["held"][held] = self.columns["engaged"][held] = True
        self.columns["grip_needed"][held] = needs[held]
        self.columns["grip_load"][held] = needs[held] / has
        self.columns["opening"][held] = v[5] * gripper.widest
        if stop > k and lifted[stop - 1]:
            v[2] = -1.0  # in the air
        short = np.flatnonzero(needs[held] * gripper.safety > has * (1.0 + 1e-9))
        if len(short):
            worst = k + int(short[0])
            most = float(needs[worst : min(parts.row_end(worst), stop)].max())
            self.events.append(GripEvent(step=worst, kind="reserve", part=name, needs=most, has=has))
        if stop >= n:
            return n
        at_change = not len(lost)
        X_WT = parts.tip_at_change(stop) if at_change else self.track[stop + 1]
        velocity = np.zeros(3) if at_change else (center[stop + 1] - center[stop]) / dt
        if slid is not None and not at_change and stop > k + 1:
            way = multiplied(self.track[stop : stop + 2], slid[0][stop - k - 2 : stop - k])
            at = applied(way[:, :3, :3], parts.center(name)) + way[:, :3, 3]
            velocity = (at[1] - at[0]) / dt
        height, support = parts.let_go(stop, name, multiplied(X_WT, X_TP), velocity)
        v[3] = -1.0
        if at_change:
            v[1] = OPEN
            event = GripEvent(step=stop, kind="released", part=name, height=height, support=support)
        else:
            v[1], v[2] = EMPTY, 0.0
            most = float(needs[stop : max(parts.row_end(stop), stop + 1)].max())
            event = GripEvent(step=stop, kind="lost", part=name, needs=most, has=has, height=height, support=support)
        self.events.append(event)
        return stop

    def _slid(self, name: str, k: int, end: int, X_TP: Array, load: Array) -> Slid | None:
        """Where contacts let the part go in steps `k` to `end`; None where statics decides."""
        pads = self.gripper.pads(self.state.contacts)
        if pads is None:
            return None
        friction = self.gripper.mu(self.parts.friction(name))
        return self.parts.slid(k, name, (pads, self.gripper.has(self.state.contacts), friction), load[k:end])

    def _shifted(self, name: str, k: int, stop: int, X_TP: Array, rows: Array) -> Array:
        """Where a part is held at the end of steps `k` to `stop`, in which it went through `rows` (m, 4, 4) in T."""
        rows = rows[: stop - k]
        across = norms((rows[:, :3, 3] - X_TP[:3, 3]) * np.array([0.0, 1.0, 1.0]))
        moved = np.flatnonzero(
            (across > SLIPS) | (np.abs(rows[:, :3, :3] - X_TP[:3, :3]).max(axis=(1, 2)) > SLIDING_TURN)
        )
        if not len(moved):
            return X_TP
        first, last = int(moved[0]), np.array(rows[-1])
        X_WP = multiplied(self.track[k + 2 + first : stop + 2], rows[first:])
        self.parts.shift(k + first, name, X_WP, last)
        self.state._matrix(1)[:] = last
        return last

    def _load(self, name: str, k: int, center: Array) -> Array:
        """Force (n, 3) [N] of the part on the gripper, in T; `center` (n + 2, 3) is the way of its centre of mass."""
        parts = self.parts
        acceleration = (center[2:] - 2.0 * center[1:-1] + center[:-2]) / (self.window.dt * self.window.dt)
        load = load_of(parts.mass(name, k), acceleration, parts.gravity)
        load_T: Array = applied(self.track[2:, :3, :3].transpose(0, 2, 1), load)
        return load_T

    def _needs(self, name: str, k: int, center: Array, X_TP: Array) -> Array:
        """Force (n,) [N] that holds the part."""
        parts, load_T = self.parts, self._load(name, k, center)
        arm = applied(X_TP[:3, :3], parts.center(name)) + X_TP[:3, 3]
        moment = np.cross(np.broadcast_to(arm, load_T.shape), load_T)
        return self.gripper.needs(load_T, moment, self.gripper.mu(parts.friction(name)), self.state.contacts)
