"""What the motors of an arm have to give along a path, and by how much it has to be slowed so that they can."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import field, replace
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.distinct import distinct
from gcodesim.arithmetic.matrices import applied, multiplied, norm
from gcodesim.frames import Array, Pose
from gcodesim.frozen import frozen
from gcodesim.kinematics.chain import Chain, Inertial
from gcodesim.kinematics.dynamics import GRAVITY, efforts_of, inverse_dynamics, merge
from gcodesim.kinematics.effort_bounds import ROUNDING, EffortBounds, effort_bounds
from gcodesim.planning.moments import OnPiece

if TYPE_CHECKING:
    from gcodesim.motion.tool_path import ToolPath
    from gcodesim.planning.arm_kernels import SegmentRates
    from gcodesim.planning.grips import Grip
    from gcodesim.planning.load_kernels import Needs

PLANNED: Final = 0.98
"""The share of an effort limit that plans use; the rest is for what changes between the places that are looked at."""

_FOR_WORK: Final = 0.99  # of what a joint at rest leaves its motor; the rest is for motion, however much the work asks
_LEAST: Final = 1e-4  # of speed squared: slower than a hundredth nothing is run


@frozen(eq=False)
class TipPush:
    """What acts on a tool at its tip, T seen from the flange, besides weight.

    `wrench` (6,) [N, N·m] is always there, in base axes, or in those of the tool where it `turns`. `force` [N] is what
    the work may push with in feed moves, in any direction.
    """

    X_FT: Pose
    wrench: Array = field(default_factory=lambda: np.zeros(6))
    turns: bool = False
    force: float = 0.0


@frozen(eq=False)
class Motors:
    """What motors of joints (j,) need for themselves: friction and inertia of rotors.

    `coulomb` [N·m, N], `viscous` [N·m·s/rad, N·s/m] and `rotor` [kg·m², kg], seen from the links.
    """

    coulomb: Array
    viscous: Array
    rotor: Array


@frozen(eq=False)
class Loads:
    """What motors of an arm bear: masses of its `chain`, a payload among them, and of `tools` by number, in axes of F.

    `gravity` (3,) [m/s²] is in base axes. `pushes` act on tools by number, `motors` are those of a controller, None for
    ideal ones. How deep a tool will be in the work no plan knows: of its process, only the force that it is expected to
    make counts.

    Along one path grippers may hold something besides: then `cases` (n,) says of each row which entry of `tools` and
    `pushes` counts, negative ones being tools with what they hold.
    """

    chain: Chain
    gravity: Array = field(default_factory=lambda: np.array(GRAVITY))
    tools: Mapping[int, Inertial | None] = field(default_factory=dict)
    pushes: Mapping[int, TipPush] = field(default_factory=dict)
    motors: Motors | None = None
    cases: NDArray[np.int64] | None = None

    def on_rows(self, path: ToolPath) -> NDArray[np.int64]:
        """Which load each row (n,) of the path is run with."""
        if self.cases is not None:
            return self.cases
        tools = np.array([state.tool for state in path.states], dtype=np.int64)
        return tools[path.state]

    def with_grips(self, path: ToolPath, grips: Sequence[Grip]) -> Loads:
        """The loads along `path` with what grippers hold from rows on."""
        if not any(grip.payload is not None for grip in grips):
            return self
        tools, pushes, cases = dict(self.tools), dict(self.pushes), self.on_rows(path)
        own = cases.copy()
        for k, grip in enumerate(grips):
            end = grips[k + 1].row if k + 1 < len(grips) else len(path)
            if grip.payload is None or end <= grip.row:
                continue
            for number in distinct(own[grip.row : end]).tolist():
                held = [(each, np.eye(4)) for each in (self.tools.get(number), grip.payload) if each is not None]
                case = -1 - len(tools)
                tools[case] = merge(held)
                if number in self.pushes:
                    pushes[case] = self.pushes[number]
                rows = cases[grip.row : end]
                rows[own[grip.row : end] == number] = case
        return replace(self, tools=tools, pushes=pushes, cases=cases)

    @property
    def limit(self) -> Array:
        """Effort limits (j,) [N·m, N]; infinite: none."""
        limit: Array = self.chain.driven_joints.effort
        return limit

    @property
    def matter(self) -> bool:
        """Whether there is a limit and a mass."""
        return bool(np.isfinite(self.limit).any()) and any(link.inertial is not None for link in self.chain.links)

    def ample(self, tool: NDArray[np.int64], static: Array, qd: Array, qdd: Array) -> NDArray[np.bool_]:
        """Where (n,) motors surely have what motions need with `tool` (n,), of no greater qd and qdd (n, j).

        There `slowing` would say 1 for each of these motions and for what is between them and rest. `static` (n, j) are
        the efforts at rest.
        """
        from gcodesim.planning.load_kernels import ample_motions

        weight, qd, qdd = ROUNDING * static, np.ascontiguousarray(qd), np.ascontiguousarray(qdd)

        def ask(bounds: EffortBounds, found: NDArray[np.uint8]) -> None:
            ample_motions(weight, qd, qdd, self._needs(bounds), found)

        return self._within_bounds(tool, ask)

    def ample_anywhere(
        self, tool: NDArray[np.int64], rates: SegmentRates, length: Array, speed: Array, most: Array, *, at_end: bool
    ) -> NDArray[np.bool_]:
        """The same of segments (n,) of `length` (n,) at their ends or where they begin, wherever the arm stands there.

        They are run at `speed` (n,) at most and with accelerations of no more than `most` (n,).
        """
        from gcodesim.planning.load_kernels import ample_segments

        room = np.empty((2, rates.start.shape[1]))

        def ask(bounds: EffortBounds, found: NDArray[np.uint8]) -> None:
            weight = ROUNDING * norm(self.gravity) * bounds.weight
            ample_segments(rates, length, speed, most, at_end, weight, self._needs(bounds), room, found)

        return self._within_bounds(tool, ask)

    def _within_bounds(
        self, tool: NDArray[np.int64], ask: Callable[[EffortBounds, NDArray[np.uint8]], None]
    ) -> NDArray[np.bool_]:
        """Where (n,) what is asked with the bounds of the `tool` (n,) is 1; nowhere with tools that have none."""
        ample, found = np.zeros(len(tool), dtype=bool), np.empty(len(tool), dtype=np.uint8)
        for number in distinct(tool).tolist():
            bounds = None if number in self.pushes else effort_bounds(self.chain, self.tools.get(number))
            if bounds is not None:
                ask(bounds, found)
                ample |= (tool == number) & (found == 1)
        return ample

    def _needs(self, bounds: EffortBounds) -> Needs:
        """What motions need at most within `bounds` besides weight, friction and rotors too."""
        from gcodesim.planning.load_kernels import Needs

        own, none = self.motors, np.zeros(len(self.limit))
        return Needs(
            inertia=ROUNDING * bounds.inertia,
            swing=ROUNDING * bounds.swing,
            coulomb=none if own is None else own.coulomb,
            viscous=none if own is None else own.viscous,
            rotor=none if own is None else own.rotor,
            limit=PLANNED * self.limit,
        )

    def efforts(
        self, tool: NDArray[np.int64], q: Array, *motions: tuple[Array | float, Array | float]
    ) -> tuple[Array, ...]:
        """Efforts (n, j) with `tool` (n,) on the flange at q (n, j), for each of several `motions` (qd, qdd)."""
        rates, changes = (np.empty((len(motions), *q.shape)) for _ in range(2))
        for m, (qd, qdd) in enumerate(motions):
            rates[m], changes[m] = qd, qdd
        numbers = distinct(tool).tolist()
        if len(numbers) == 1:
            return tuple(self._efforts_with(numbers[0], q, rates, changes))
        out = np.empty(rates.shape)
        for number in numbers:
            here = tool == number
            out[:, here] = self._efforts_with(number, q[here], rates[:, here], changes[:, here])
        return tuple(out)

    def _efforts_with(self, number: int, q: Array, qd: Array, qdd: Array) -> Array:
        """Efforts (m, n, j) with one tool at q (n, j), for m motions qd, qdd (m, n, j)."""
        push = self.pushes.get(number)
        found = efforts_of(
            self.chain,
            q,
            np.ascontiguousarray(qd),
            np.ascontiguousarray(qdd),
            self.tools.get(number),
            None if push is None else self._wrench(push, q),
            p_FT=np.zeros(3) if push is None else push.X_FT.p,
            gravity=self.gravity,
        )
        return found if self.motors is None else found + self.motors.rotor * qdd

    def reserve(self, tool: NDArray[np.int64], q: Array, qd: Array, feeding: NDArray[np.bool_]) -> Array:
        """Efforts (n, j) needed besides, in either direction: for friction, and where `feeding` (n,) for the work.

        A force F of any direction at the tip asks joint i for F times the length of its column of the Jacobian there.
        """
        out = np.zeros(q.shape)
        if self.motors is not None:
            moves = np.abs(qd)
            out += np.where(moves > 0.0, self.motors.coulomb, 0.0) + self.motors.viscous * moves
        for number, push in self.pushes.items():
            here = feeding & (tool == number)
            if push.force > 0.0 and here.any():
                unit = np.tile(np.eye(3, 6), (int(here.sum()), 1))
                at = np.repeat(q[here], 3, axis=0)
                each = inverse_dynamics(self.chain, at, 0.0, 0.0, None, unit, p_FT=push.X_FT.p, gravity=np.zeros(3))
                out[here] += push.force * np.sqrt(np.square(each.reshape(-1, 3, q.shape[1])).sum(axis=1))
        return out

    def _wrench(self, push: TipPush, q: Array) -> Array:
        """The constant load at the tip (n, 6) in base axes, at joints `q` (n, j)."""
        if not push.turns or not push.wrench.any():
            return np.tile(push.wrench, (len(q), 1))
        from gcodesim.kinematics.tree_kernels import poses_along

        tree, flange = self.chain.tree, np.empty((len(q), 1, 4, 4))
        carrier, offset = np.array([tree.flange_carrier]), np.ascontiguousarray(tree.flange_offset[None])
        poses_along(np.ascontiguousarray(q), tree, carrier, offset, np.empty((q.shape[1], 4, 4)), flange)
        R_BT = multiplied(flange[:, 0, :3, :3], push.X_FT.R)
        return np.concatenate([applied(R_BT, push.wrench[:3]), applied(R_BT, push.wrench[3:])], axis=1)

    def slowing(
        self, place: tuple[NDArray[np.int64], Array], static: Array, *moved: Array, reserve: Array | float = 0.0
    ) -> Slowing:
        """The share of speed squared and of acceleration that is allowed at n places `s` (n,) of `piece` (n,).

        Efforts (n, j) are `static` at rest and each of `moved` at full speed and acceleration. A motion that is slowed
        evenly by k in speed squared and in acceleration takes ``static + k (moved - static)``, and `reserve` (n, j) of
        a limit stays free. Where rest alone is too much, nothing is gained by going slower; where the reserve is,
        motion is as slow as with the largest that can be had, so that a little more of it never makes it quicker.
        """
        with np.errstate(invalid="ignore"):
            left = np.maximum(PLANNED * self.limit - np.abs(static), 0.0)
        kept = np.minimum(reserve, _FOR_WORK * left)
        limit = PLANNED * self.limit - kept
        rows = np.arange(len(static))
        share, joint, most = np.ones(len(static)), np.full(len(static), -1), np.zeros(len(static))
        for efforts in moved:
            if not (np.abs(efforts) > limit).any():
                continue
            change = efforts - static
            room = np.where(change >= 0.0, limit - static, limit + static)
            with np.errstate(divide="ignore", invalid="ignore"):
                allowed = np.where((np.abs(efforts) > limit) & (room > 0.0), room / np.abs(change), 1.0)
            least = allowed.argmin(axis=1)
            value = allowed[rows, least]
            lower = value < share
            share, joint = np.where(lower, value, share), np.where(lower, least, joint)
            most = np.where(lower, np.abs(efforts[rows, least]) + kept[rows, least], most)
        spare = np.where(joint >= 0, kept[rows, joint], 0.0)
        over = np.abs(static) + reserve - self.limit
        overborne = np.where((over > 0.0) & (np.abs(static) <= self.limit), over, 0.0)
        overweight = np.maximum(np.abs(static) - self.limit, 0.0)
        return Slowing(*place, np.maximum(share, _LEAST), joint, most, spare, overborne, overweight)


@frozen(kw_only=False, eq=False)
class Slowing:
    """At n places `s` (n,) of `piece` (n,): the `share` (n,) of speed squared that motors allow.

    `joint` (n,) is the one that needs it, -1: none does. `effort` (n,) [N·m, N] is what that joint would have to give
    otherwise, `reserve` (n,) of it for friction and the work. `overborne` (n, j) is by how much a motor that bears its
    joint at rest cannot bear the work, `overweight` (n, j) by how much one cannot even do that.
    """

    piece: NDArray[np.int64]
    s: Array
    share: Array
    joint: NDArray[np.int64]
    effort: Array
    reserve: Array
    overborne: Array
    overweight: Array

    def at(self, places: NDArray[np.intp]) -> Slowing:
        """That of some of the places."""
        return Slowing(*(getattr(self, name)[places] for name in Slowing.__dataclass_fields__))

    @property
    def needed(self) -> Slowing:
        """That of the places where motors need it, or cannot bear the work or the weight."""
        return self.at(np.flatnonzero((self.joint >= 0) | (self.overborne + self.overweight).any(axis=1)))

    @property
    def first(self) -> OnPiece:
        """The first of the places."""
        piece = int(self.piece.min())
        return OnPiece(piece, float(self.s[self.piece == piece].min()))

    @staticmethod
    def together(some: Sequence[Slowing]) -> Slowing:
        """All places of several, at least one."""
        return Slowing(
            *(np.concatenate([getattr(each, name) for each in some]) for name in Slowing.__dataclass_fields__)
        )
