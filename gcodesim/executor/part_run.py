"""Parts in a run: where they are planned to be, where they are, and how they fall."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import inf
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.elementary import acos
from gcodesim.arithmetic.matrices import inverse_pose, multiplied, norm
from gcodesim.executor.device_run import DeviceRun
from gcodesim.executor.halt import Going
from gcodesim.executor.switching import Switching
from gcodesim.frames import WORLD, Array, Pose
from gcodesim.frozen import frozen
from gcodesim.processes.gripping import GRIP, GripEvent, Slid
from gcodesim.scene import CarriedParts, Fall, Hold, PartChange, Past, Stay
from gcodesim.shop import BODIES, Shop, skin_of
from gcodesim.solids.mass import MassOfSkin, mass_of_skin
from gcodesim.solids.mesh_file import Triangles
from gcodesim.solids.resting import SUNK, Ground, gap_below, is_bare_below
from gcodesim.tools.gripper import PadFaces
from gcodesim.world import fall_of
from gcodesim.world.body import Inertia, ToolBody
from gcodesim.world.contact_hold import ContactHold, Press
from gcodesim.world.falling import Drop
from gcodesim.world.protocol import STANDARD_GRAVITY

SET_DOWN: Final = 0.5e-3
"""A part that is let go at most this far [m] above something is set down on it; from higher up it falls."""


@frozen(eq=False)
class PartEnd:
    """What became of a part: `X_W` at the end, its place in `parent`, who holds it, and how often it was what.

    `support` is the body on which it lies, or the next one below it, empty for a floor, or the link with which it goes;
    `height` [m] is how far it is above that.
    `error` [m] and `turn` [rad] say how far it is from its goal, or, without one, from where it was let go last.
    """

    X_W: Pose
    parent: str
    support: str
    height: float
    holder: str
    moved: float
    grips: int
    falls: int
    error: float | None
    turn: float | None
    to_goal: bool


@dataclass(slots=True, eq=False)
class _Count:
    grips: int = 0
    falls: int = 0
    let_go: Array | None = None


class PartRun:
    """All parts of a cell in one run, of all its channels.

    `planned` is ahead, as far as grippers have been computed; `ran` is as far as the world has moved.
    """

    def __init__(self, shop: Shop, world_name: str, dt: float) -> None:
        self.shop, self.world_name, self.dt = shop, world_name, dt
        self.devices = DeviceRun(shop, dt)
        moving = self.devices.frames
        self.planned, self.ran = CarriedParts(shop.scene, moving), CarriedParts(shop.scene, moving)
        self.names = tuple(self.planned.bodies)
        self.gravity = np.array(STANDARD_GRAVITY)
        self.skins = {name: skin_of(body) for name, body in self.planned.bodies.items()}
        self.masses: dict[str, MassOfSkin] = {
            name: mass_of_skin(skin.points, skin.faces, self.planned.bodies[name].mass or 0.0)
            for name, skin in self.skins.items()
        }
        self._fixtures = {
            body.name: skin_of(body)
            for body in shop.scene.bodies
            if body.role in ("fixture", "obstacle") and body.solids
        }
        self._counts = {name: _Count() for name in self.names}
        self._past = {name: Past(name) for name in self.names}
        self._start = {name: shop.scene.at_rest(name) for name in self.names}
        self._floors = self._levels()
        self._holds: dict[str, tuple[int, Array, ContactHold | None]] = {}
        self._lay()

    # ---- how parts come to rest

    def _levels(self) -> tuple[float, ...]:
        """Heights [m] of level floors: the lowest thing there is, and what parts stand on that nobody has drawn."""
        scene = self.shop.scene
        fixtures = {name: skin.moved(scene.at_rest(name)) for name, skin in self._fixtures.items()}
        lying = {name: skin.moved(self._start[name]) for name, skin in self.skins.items()}
        lowest = [skin.lowest for skin in (*fixtures.values(), *lying.values())]
        levels = {min([*lowest, *(float(mover.X_WB.p[2]) for mover in scene.movers.values())])}
        goals = {name: skin.moved(goal) for name, skin in self.skins.items() if (goal := self.goal(name)) is not None}
        for skins, beside in ((lying, {}), (goals, goals)):
            for name, skin in skins.items():
                others = [own for each in (lying, beside) for other, own in each.items() if other != name]
                if is_bare_below(skin, [*fixtures.values(), *others]):
                    levels.add(skin.lowest)
        return tuple(sorted(levels))

    def _lay(self) -> None:
        """What lies on a device, or on another part, at the start goes with it."""
        if len(self.names) < 2 and not self.devices.frames:
            return
        frames = {name: self.shop.scene.at_rest(name).matrix for name in (BODIES, *self._fixtures, *self.names)}
        placed = self._placed(frames)
        for name in self.names:
            height, support = self._below(name, placed, -1)
            if height <= SET_DOWN and support in (*self.devices.frames, *self.names):
                change = self._stays_on(support, -1, name, frames[name], frames)
                self.planned.apply(change)
                self.happens(change)

    def _placed(self, poses: Mapping[str, Array]) -> dict[str, Triangles]:
        """The skins of fixtures and parts where everything is by `poses` (4, 4), in the world."""
        return {n: own.moved(Pose.from_matrix(poses[n])) for n, own in {**self._fixtures, **self.skins}.items()}

    def _below(self, name: str, placed: Mapping[str, Triangles], step: int) -> tuple[float, str]:
        """How far [m] a part is above what lies below it, and the body that this is; the name of a floor is empty."""
        skin, riders = placed[name], {name, *self.planned.riders(name, step)}
        others = {n: own for n, own in placed.items() if n not in riders}
        return gap_below(skin, Ground(others=others, floor=self._floor_below(skin)))

    def goal(self, name: str) -> Pose | None:
        """X_W where a part is meant to be in the end."""
        part = self.shop.cell.parts[self.planned.bodies[name].label]
        if part.goal is None:
            return None
        frame = part.goal.frame or WORLD
        known = self.shop.placement
        at = self.shop.scene.at_rest(frame) if frame in self.shop.cell.link_names else known.X_W(frame)
        return at @ part.goal.X

    def come_to_rest(
        self,
        step: int,
        name: str,
        X_W: Array,
        velocity: Array,
        poses: Mapping[str, Array],
    ) -> tuple[PartChange, float, str]:
        """What becomes of a part that nobody holds from a step on; how far [m] it goes down, and the body it ends on.

        `poses` (4, 4) are where everything else is. The name of a body is empty for a floor.
        """
        skin = self.skins[name].moved(Pose.from_matrix(X_W))
        riders = {name, *self.planned.riders(name, step)}
        others = {n: own for n, own in self._placed(poses).items() if n not in riders}
        ground = Ground(others=others, floor=self._floor_below(skin))
        height, support = gap_below(skin, ground)
        if height <= SET_DOWN:
            end = X_W.copy()
            end[2, 3] -= height
            track = None
        else:
            drop = Drop(self.skins[name], self.masses[name], X_W, velocity, height)
            rows = fall_of(self.world_name)(drop, ground, self.gravity, self.dt)
            end, track = rows[-1], Fall(step=step, X=rows)
            if self.world_name != "kinematic":
                landed = self.skins[name].moved(Pose.from_matrix(end))
                support = gap_below(landed, replace(ground, floor=self._floor_below(landed)))[1]
        return replace(self._stays_on(support, step, name, end, poses), fall=track), height, support

    def _stays_on(self, support: str, step: int, name: str, end: Array, poses: Mapping[str, Array]) -> PartChange:
        """A part that comes to rest at `end` (4, 4) in the world, on a body; everything else is at `poses`."""
        parent = support or BODIES
        X_WS = self.devices.frames[parent](step, 1)[0] if parent in self.devices.frames else poses[parent]
        X = Pose.from_matrix(multiplied(inverse_pose(X_WS[None])[0], end))
        room = inf
        if parent in self.devices.frames and self.devices.devices[parent].speed > 0.0:
            X_DP = multiplied(inverse_pose(poses[parent][None])[0], end)
            front = float(self.skins[name].moved(Pose.from_matrix(X_DP)).points[:, 0].max())
            room = max(float(self._fixtures[parent].points[:, 0].max()) - front, 0.0)
        return PartChange(hold=Hold(step=step, body=name, parent=parent, X=X), room=room)

    def _floor_below(self, skin: Triangles) -> float:
        return max((level for level in self._floors if level <= skin.lowest + SUNK), default=self._floors[0])

    def frames_at(self, step: int, q: Mapping[str, Array]) -> dict[str, Array]:
        """X_WF (4, 4) of fixtures, parts and `BODIES` at the end of a step, with joints `q[mover]` (1, j)."""
        scene = self.shop.scene
        found = {name: scene.track(name, q)[0] for name in (BODIES, *self._fixtures)}
        found |= {name: self.devices.drawn(name, step, 1)[0] for name in self.devices.frames}
        return found | {name: self.planned.poses(name, step, q)[0] for name in self.names}

    # ---- what is done

    def happens(self, change: PartChange) -> None:
        """Take over what has become of a part in steps that the world has moved through."""
        self.ran.apply(change)
        hold, fall = change.hold, change.fall
        begin = max(hold.step if fall is None else fall.end, 0) * self.dt
        stay = Stay(body=hold.body, parent=hold.parent, X=hold.X, begin=begin, holder=change.holder, room=change.room)
        past = self._past[hold.body]
        past.leave(max(hold.step, 0) * self.dt)
        past.add(stay)

    def stays(self) -> list[Stay]:
        """Where each part has been, in the order of time; nowhere while it falls."""
        found = []
        for name, kept in self._past.items():
            stand, past = self.shop.scene.frames[name], list(kept)
            first = past[0].begin if past else inf
            if first > 0.0:
                found.append(Stay(body=name, parent=stand.parent, X=stand.X, end=first))
            found += [stay for stay in past if stay.end > stay.begin]
        return found

    def count(self, events: Sequence[GripEvent]) -> None:
        """Take note of what grippers have done in steps that the world has moved through."""
        for event in events:
            if event.part in self._counts:
                count = self._counts[event.part]
                count.grips += event.kind == "taken"
                count.falls += event.kind == "lost" or (event.kind == "released" and event.height > SET_DOWN)

    def is_taken(self, step: int, name: str, X_TP: Array) -> None:
        """A gripper closes on a part."""
        self._holds[name] = (step, X_TP.copy(), None)

    def slid(self, step: int, name: str, press: tuple[PadFaces, float, float], loads: Array) -> Slid | None:
        """See `processes.gripping.PartsAtHand`."""
        if self.world_name != "bullet" or name not in self._holds:
            return None
        taken, X_TP, hold = self._holds[name]
        if hold is None:
            mass = replace(self.masses[name], mass=self.planned.mass(name, step))
            hold = ContactHold(self.skins[name], mass, X_TP, Press(*press), self.dt)
            self._holds[name] = (taken, X_TP, hold)
        return hold.run(step - taken, loads)

    def was_let_go(self, name: str, X_W: Array) -> None:
        self._counts[name].let_go = X_W

    @property
    def things(self) -> tuple[str, ...]:
        """The frames of parts, then those of devices."""
        return (*self.names, *self.devices.frames)

    def before(self, name: str, step: int) -> int:
        """The step before this one; this one itself if a part is taken or let go in it: where it was is forgotten."""
        return step if self.planned.changes_in(name, step) else step - 1

    def seen_from(self, shop: Shop, frame: str, first: int, q: Mapping[str, Array]) -> Array | None:
        """X_BF (n, 4, 4) of a part or a device at the ends of steps, from the base of a shop, as planned by now."""
        if frame in self.devices.frames:
            X_WF = self.devices.drawn(frame, first, len(next(iter(q.values()))))
        elif frame in self.planned.bodies:
            X_WF = self.planned.poses(frame, first, q)
        else:
            return None
        X_BF: Array = multiplied(shop.X_WB.inverse().matrix, X_WF)
        return X_BF

    def poses(self, first: int, q: Mapping[str, Array]) -> Array:
        """X_W (n, parts and devices, 4, 4) at the ends of steps that have been run."""
        count = len(next(iter(q.values())))
        parts = [self.ran.poses(name, first, q) for name in self.names]
        return np.stack([*parts, *(self.devices.drawn(name, first, count) for name in self.devices.frames)], axis=1)

    def going_on(self, step: int, joints: Mapping[str, Array]) -> dict[str, Going]:
        """How parts and devices move from the end of a step on, while machines stand with these joints (j,)."""

        def of_part(name: str, first: int, count: int) -> Array:
            q = {mover: np.tile(at, (count, 1)) for mover, at in joints.items()}
            return self.ran.poses(name, step + first, q)

        def of_device(name: str, first: int, count: int) -> Array:
            return self.devices.drawn(name, step + first, count)

        found: dict[str, Going] = {name: partial(of_part, name) for name in self.names}
        return found | {name: partial(of_device, name) for name in self.devices.frames}

    def _is_borne(self, parent: str) -> bool:
        """Whether what stands in this frame goes with it: with what it lies on, or with a link."""
        return parent in self._fixtures or parent in self.skins or (parent != BODIES and self.shop.scene.moves(parent))

    def ends(self, step: int, q: Mapping[str, Array]) -> dict[str, PartEnd]:
        """What became of each part, with joints `q[mover]` (1, j) at the end."""
        found = {}
        placed = self._placed(self.frames_at(step, q))
        for name in self.names:
            X = Pose.from_matrix(self.ran.poses(name, step, q)[0])
            goal, count = self.goal(name), self._counts[name]
            meant = goal if goal is not None else None if count.let_go is None else Pose.from_matrix(count.let_go)
            holder = self.ran.holder(name, step)
            if goal is None and holder:
                meant = None
            parent = self.ran.parent(name, step)
            height, support = (0.0, parent) if self._is_borne(parent) else self._below(name, placed, step)
            found[name] = PartEnd(
                X_W=X,
                parent=parent,
                support=support,
                height=height,
                holder=holder,
                moved=norm(X.p - self._start[name].p),
                grips=count.grips,
                falls=count.falls,
                error=None if meant is None else norm(X.p - meant.p),
                turn=None if meant is None else angle_between(X.R, meant.R),
                to_goal=goal is not None,
            )
        return found


class PartsInWindow:
    """The parts as one gripper sees them in the steps of a window; see `processes.gripping.PartsAtHand`."""

    def __init__(
        self,
        run: PartRun,
        shop: Shop,
        holder: str,
        X_FT: Pose,
        first: int,
        q: Mapping[str, Array],
        rows: NDArray[np.int64],
        middle: Array,
        switching: Switching,
    ) -> None:
        self._run, self._shop, self._holder, self._X_FT = run, shop, holder, X_FT
        self._first, self._q, self._rows, self._middle, self._switching = first, q, rows, middle, switching
        self.names, self.gravity = run.names, run.gravity
        self.changes: list[PartChange] = []
        self.let_go_at: list[tuple[str, Array]] = []

    def begin(self) -> None:
        """The window is about to be computed, perhaps once more."""
        self.changes.clear()
        self.let_go_at.clear()
        self._run.planned.forget(self._first)

    def skin(self, name: str) -> Triangles:
        return self._run.skins[name]

    def center(self, name: str) -> Array:
        return self._run.masses[name].center

    def mass(self, name: str, step: int) -> float:
        return self._run.planned.mass(name, self._first + step)

    def friction(self, name: str) -> float | None:
        return self._run.planned.bodies[name].friction

    def poses(self, name: str) -> Array:
        return self._run.planned.poses(name, self._first, self._q)

    def holder(self, name: str, step: int) -> str:
        return self._run.planned.holder(name, self._first + step)

    def tip_at_change(self, step: int) -> Array:
        return self._switching.tip_at_change(GRIP, float(self._middle[step]))

    def row_end(self, step: int) -> int:
        others = np.flatnonzero(self._rows[step:] != self._rows[step])
        return step + int(others[0]) if len(others) else len(self._rows)

    def take(self, step: int, name: str, X_TP: Array) -> None:
        flange = f"{self._shop.name}/{self._shop.kinematics.chain.flange_name}"
        X_FP = Pose.from_matrix(multiplied(self._X_FT.matrix, X_TP))
        hold = Hold(step=self._first + step, body=name, parent=flange, X=X_FP)
        self._apply(PartChange(hold=hold, holder=self._holder))
        self._run.is_taken(self._first + step, name, X_TP)

    def slid(self, step: int, name: str, press: tuple[PadFaces, float, float], loads: Array) -> Slid | None:
        return self._run.slid(self._first + step, name, press, loads)

    def shift(self, step: int, name: str, X_WP: Array, X_TP: Array) -> None:
        flange = f"{self._shop.name}/{self._shop.kinematics.chain.flange_name}"
        X_FP = Pose.from_matrix(multiplied(self._X_FT.matrix, X_TP))
        now = self._first + step
        hold = Hold(step=now, body=name, parent=flange, X=X_FP)
        self._apply(PartChange(hold=hold, fall=Fall(step=now, X=X_WP), holder=self._holder))

    def let_go(self, step: int, name: str, X_WP: Array, velocity: Array) -> tuple[float, str]:
        now = self._first + step
        row = {mover: joints[step : step + 1] for mover, joints in self._q.items()}
        self.let_go_at.append((name, X_WP))
        frames = self._run.frames_at(now, row)
        change, height, support = self._run.come_to_rest(now, name, X_WP, velocity, frames)
        self._apply(change)
        return height, support.rpartition("/")[2]

    def _apply(self, change: PartChange) -> None:
        self._run.planned.apply(change)
        self.changes.append(change)


@frozen(kw_only=False, eq=False)
class PartsTarget:
    """All parts of the cell, for the gripper `holder` of a shop."""

    run: PartRun
    shop: Shop
    holder: str
    X_FT: Pose

    name = "parts"
    holds = (("parts", Pose.identity()),)
    frame = WORLD
    material = None
    given = None
    room = None

    def filled(self) -> None:
        return None

    def memento(self) -> Callable[[], None]:
        return self.run.planned.memento()

    def during(
        self, first: int, q: Mapping[str, Array], rows: NDArray[np.int64], middle: Array, switching: Switching
    ) -> PartsInWindow:
        """The parts in steps from `first` on, which belong to path rows `rows` (n,), and whose `middle` (n,) is [s]."""
        return PartsInWindow(self.run, self.shop, self.holder, self.X_FT, first, q, rows, middle, switching)


def laden(tool: ToolBody, held: Sequence[tuple[Pose, MassOfSkin]]) -> ToolBody:
    """A tool and the parts that it holds, at X_FP, as one body."""
    if not held:
        return tool
    pieces = [(tool.mass, np.array(tool.com), _tensor(tool.inertia))]
    for X_FP, part in held:
        R = X_FP.R
        pieces.append((part.mass, X_FP.apply(part.center), multiplied(R, part.inertia, R.T)))
    mass = sum(m for m, _, _ in pieces)
    com = sum((m * c for m, c, _ in pieces), np.zeros(3)) / mass
    total = np.zeros((3, 3))
    for m, c, inertia in pieces:
        d = c - com
        total += inertia + m * (float((d * d).sum()) * np.eye(3) - np.outer(d, d))
    x, y, z = com.tolist()
    own = tuple(float(total[i, j]) for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)))
    return ToolBody(
        name=tool.name,
        length=tool.length,
        mass=mass,
        com=(x, y, z),
        inertia=(own[0], own[1], own[2], own[3], own[4], own[5]),
        solids=tool.solids,
        tip=tool.tip,
    )


def _tensor(inertia: Inertia) -> Array:
    xx, yy, zz, xy, xz, yz = inertia
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def angle_between(one: Array, other: Array) -> float:
    """Angle [rad] of the turn from one rotation matrix to another."""
    R = multiplied(one.T, other)
    skew = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    sine = 0.5 * norm(skew)
    cosine = 0.5 * (float(np.trace(R)) - 1.0)
    return sine if cosine > 0.999999 else float(acos(np.clip(cosine, -1.0, 1.0)))
