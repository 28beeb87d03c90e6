"""Posing of arms: a three-axis program with the tool in a fixed attitude, under the limits of the joints.

The path is cut into nodes; joints at the nodes come from the inverse
kinematics, joint rates from the Jacobian, and the time law gets caps on speed
and acceleration for every segment between two nodes. Moves away from home and
to it are run in joint space.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field, replace
from functools import partial
from typing import TYPE_CHECKING, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.distinct import distinct
from gcodesim.arithmetic.matrices import greatest, multiplied
from gcodesim.canon import Axes
from gcodesim.frames import Array, Pose
from gcodesim.frozen import frozen
from gcodesim.kinematics.attitude import Direction, WordTurns
from gcodesim.kinematics.path_kernels import JUMP
from gcodesim.kinematics.pointing import PointingArm
from gcodesim.kinematics.protocol import Status
from gcodesim.motion.blend import blend
from gcodesim.motion.pieces import AxisLimits, Pieces
from gcodesim.motion.tool_path import HOME, Commanded, ToolPath
from gcodesim.planning.arm_caps import ArmCaps
from gcodesim.planning.arm_joints import ArmJoints
from gcodesim.planning.axis_posing import offsets
from gcodesim.planning.bent_ways import report_turning_joints
from gcodesim.planning.borne_work import BorneWork
from gcodesim.planning.configuration import Hindrance, on_branches
from gcodesim.planning.external_choice import ChosenPlaces, choose_places
from gcodesim.planning.flange import Flange
from gcodesim.planning.flange_poses import spin_of
from gcodesim.planning.guide import CHOSEN, GROUND, Guide, Outside
from gcodesim.planning.joint_moves import SHORTEST, JointMove
from gcodesim.planning.joint_rows import JointRows, with_joint_rows
from gcodesim.planning.loads import Loads, Slowing
from gcodesim.planning.moments import PathFindings
from gcodesim.planning.nodes import Nodes
from gcodesim.planning.obstacles import Around, Obstacles
from gcodesim.planning.plan import JointPath
from gcodesim.planning.posing import Posed
from gcodesim.planning.reach import report_poses, report_slow_motors
from gcodesim.planning.route import TRIALS, DeadEnd, dead_end, route_along
from gcodesim.planning.route_findings import ToldEnd, report_dead_end, report_route
from gcodesim.planning.spin_choice import SampledPath, SpinChoice, choose_spin
from gcodesim.planning.stands import Stands
from gcodesim.planning.surface_axis import SurfaceAxis, Tipped
from gcodesim.planning.travel import TravelEnds, report_missing_axes, report_travel

if TYPE_CHECKING:
    from gcodesim.kinematics.attitude import AttitudeLaw
    from gcodesim.kinematics.chain import Joints
    from gcodesim.kinematics.protocol import Kinematics
    from gcodesim.planning.grips import Grips

Solved: TypeAlias = tuple[Nodes, Array, NDArray[np.uint8]]  # nodes, joints (k, j) and status (k,) at them

_REFINEMENTS: Final = 3  # of nodes by the steps of joints
_ROUNDS: Final = 8  # the same by what changes within a step; they end by themselves, at steps of a few micrometres
_LOOKS: Final = 400  # nodes at which is looked whether the arm hits anything
_CLOSER: Final = 2e-3  # [m, rad] between nodes to begin with, where more than the tip moves the flange
_PARTS: Final = 0.25  # between nodes, of the way over which a tool turns at an edge
_REACH: Final = 1  # statuses of the inverse kinematics that leave the path
_FLIP: Final = 4


@frozen(eq=False)
class FixedAttitude:
    """An arm that runs a three-axis program: the tool's Z is along −Z of the frame O; `spin` turns it about itself.

    R_BO (3, 3) is `frames[system]` for the work system in force, else `upright`. `spin` [rad] None: free, one angle is
    chosen for the whole program. The flange stands at end + length offset, the offset in axes of O, so that Z pulls the
    flange back. `X_BM` is where the axes of the program stand in the base. `joint_rapids`: every G0 is a joint move.

    Of a leg that goes on, `home` (j,) is where G28 goes, and `held` (3, 3) is the R_BO that the tool has already; else
    home is where the arm stands first, and it goes from there to its attitude by joints. `branches` are those of a
    closed form on which the arm has to be; None: all.

    Where one spin and one branch do not do, all configurations are searched, and a free spin changes along the path.

    With a `law` the words a, b, c of the path lean O: about `axes[system]` in B, or those of B. It counts for the
    whole program when `words_lean`, else once the tip is commanded. `outside` are external axes; `platforms` says
    which of them carries the work of a system, so that points of that system go along with it.

    `bends` are X_NF (4, 4) of bent tools by their numbers: what is said above of the flange holds for their nose N.
    `held_bend` is that of the tool with which a leg goes on. With `stands` the arm drives for its tool changes.

    Spin, configuration and chosen external axes keep clear of `obstacles` where they can.

    With a `surface` the words are directions along its normals.

    What `grips` hold weighs on the motors.

    `borne` is work that other programs move: the arm goes by joints to where it stands then.
    """

    frames: Mapping[int, Array] = field(default_factory=dict)
    upright: Array = field(default_factory=lambda: np.eye(3))
    spin: float | None = None
    X_BM: Pose = field(default_factory=Pose.identity)
    joint_rapids: bool = False
    home: Array | None = None
    held: Array | None = None
    branches: tuple[int, ...] | None = None
    law: AttitudeLaw | None = None
    words_lean: bool = False
    axes: Mapping[int, Array] = field(default_factory=dict)
    outside: Outside | None = None
    platforms: Mapping[int, int] = field(default_factory=dict)
    loads: Loads | None = None
    bends: Mapping[int, Array] = field(default_factory=dict)
    held_bend: Array | None = None
    stands: Stands | None = None
    obstacles: Obstacles | None = None
    surface: SurfaceAxis | None = None
    grips: Grips | None = None
    borne: BorneWork | None = None

    @property
    def understands(self) -> frozenset[Commanded]:
        if self.law is None and self.outside is None:
            return frozenset((Commanded.AXES,))
        return frozenset((Commanded.AXES, Commanded.POINT))

    def start(self, kinematics: Kinematics, home: Array) -> Axes:
        """Where the flange stands at `home` (j,), seen from M."""
        p_BF = kinematics.forward(np.asarray(home, dtype=float)[None])[0, :3, 3]
        x, y, z = self.X_BM.inverse().apply(p_BF)
        words = [0.0, 0.0, 0.0]
        if self.outside is not None:
            values = np.asarray(home)[self.outside.assembly.externals]
            for column, value in zip(self.outside.columns, values, strict=True):
                if column != CHOSEN:
                    words[column] = float(value)
        return (float(x), float(y), float(z), words[0], words[1], words[2])

    def pose(self, path: ToolPath, kinematics: Kinematics, home: Array, findings: PathFindings) -> Posed:
        """Where poses are out of reach, the joints run straight to where they are in reach again; a finding says so."""
        home = np.asarray(home, dtype=float)
        arm, own = (kinematics, home) if self.outside is None else self._arm_alone(home)
        goals: dict[int, Array] = {}
        if self.stands is not None:
            at_rest = home if self.home is None else self.home
            path, goals = self.stands.driven(path, kinematics, at_rest, findings)
        path = _seen_from_base(path, self.X_BM)
        self._report_words(path, kinematics, findings)
        shifts = None
        if self.borne is not None:
            path, shifts = self.borne.carried(path), self.borne.shifts_between(path)
        bend = self._bends(path)
        held = self.held if self._holds_bend(bend) else None
        rows = with_joint_rows(
            path, self.R_BO(path), joint_rapids=self.joint_rapids, held=held, bend=bend, shifts=shifts
        )
        path = rows.path
        R_BO, bend = self.R_BO(path), self._bends(path)
        guide = self._guide(path)
        places = self._places(rows, R_BO, guide, home, bend)
        probe = SampledPath.of(rows, R_BO, guide, bend) if places is None else places[0]
        at_start = arm.forward(own[None])[0, :3, :3]
        if bend is not None and len(bend):
            at_start = multiplied(at_start, bend[0, :3, :3].T)
        near = spin_of(at_start, R_BO[0] if len(path) else self.upright)
        around = Around.on_rows(self.obstacles, path, probe.row) if self.outside is None else None
        pointing = self._pointing(arm, bend)
        arm = arm if pointing is None else pointing
        choice = choose_spin(arm, probe, own, near, self.spin if pointing is None else near, around)
        limits = choice.limits if guide is None else _with_words(choice.limits, guide, kinematics.joints)
        path = self._in_the_work(path)
        soft = bool(np.isfinite(kinematics.joints.jerk).any())
        pieces = blend(path, limits, own_time=np.where(rows.joint, 1.0, np.nan), even=soft, sampled=False)
        loose = pointing is not None
        flange = Flange(pieces, R_BO, offsets(path)[:, :3], choice.spin, guide=guide, bend=bend, loose=loose)
        at_home = pieces.fixed & rows.home[pieces.row_first]
        if self.surface is not None and guide is not None:
            tipped = Tipped(rows=np.ones(len(path), dtype=bool), X_MB=self.X_BM.inverse(), joint_heads=True)
            turning = self.surface.along(pieces, tipped, _directions, findings)
            guide = replace(guide, turning=turning)
            flange = replace(flange, guide=guide)
        if places is not None and guide is not None and guide.outside is not None:
            heads = np.flatnonzero(pieces.fixed & ~at_home)
            guide = replace(guide, outside=places[1].along(guide.outside, pieces, heads))
            flange = replace(flange, guide=guide)
        if guide is None:
            begun = Nodes.of(pieces, at_home)
        else:
            begun = Nodes.of(pieces, at_home, self._spacing, guide.parts(pieces))
        solved = _solve(arm, flange, begun, choice, own)
        told = ToldEnd()
        if not self._will_do(arm, flange, *solved) or self._hit(flange, *solved) is not None:
            flange, solved, choice, told = self._searched(arm, flange, begun, choice, own, solved, findings)
        for refinement in range(_ROUNDS):
            nodes, q_own, status = solved
            bridged = _bridge(nodes, q_own, status)
            q_nodes = q_own if self.outside is None else self._together(flange, nodes, q_own)
            caps = ArmCaps.of(kinematics if self.outside is not None else arm, flange, nodes, q_nodes, bridged)
            finer = nodes.split(caps.parts(refinement)) if refinement + 1 < _ROUNDS else None
            if finer is None:
                break
            solved = _solved_at(arm, flange, finer, choice, own)
        report_poses(arm, flange, nodes, q_own, status, probe, choice, own, told, findings)
        rest = home if self.home is None else self.home
        ends = {rows.row(row): q for row, q in goals.items()}
        moves = _joint_moves(kinematics, pieces, nodes, q_nodes, home, rest, ends)
        caps.report(kinematics, findings)
        report_turning_joints(kinematics, flange, nodes, q_nodes, ~bridged, findings)
        grips = self.grips
        if self.loads is not None and self.loads.matter:
            loads = self.loads
            if grips is not None:
                found, grips = grips.along(path, partial(_joints_before, pieces, nodes, q_nodes, moves, home))
                loads = loads.with_grips(path, found)
            caps, slow = caps.within(loads, nodes, q_nodes)
            moves, slower = _moves_within(moves, loads, pieces)
            if slow or slower:
                report_slow_motors(kinematics, pieces, Slowing.together([*slow, *slower]), findings)
        caps = caps.softened(nodes, kinematics.joints.jerk)
        for piece, move in moves.items():
            pieces.length[piece] = pieces.curves.length[pieces.curve[piece]] = max(move.duration, SHORTEST)
        joints = ArmJoints(arm, flange, nodes, q_nodes, bridged, home, moves, grips)
        return Posed(pieces, joints, caps.with_moves())

    def _pointing(self, arm: Kinematics, bend: Array | None) -> PointingArm | None:
        """The arm as one that only points its tool, where its joints are too few for more and nobody asks for more."""
        if self.spin is not None or self.outside is not None or bend is not None:
            return None
        return PointingArm.of(arm)

    def _bends(self, path: ToolPath) -> Array | None:
        """X_NF (n, 4, 4) of the tool of each row; None where all tools are straight."""
        if not any(state.tool in self.bends for state in path.states):
            return None
        table = np.array([self.bends.get(state.tool, np.eye(4)) for state in path.states])
        rows: Array = table[path.state]
        return rows

    def _holds_bend(self, bend: Array | None) -> bool:
        """Whether a leg begins with the tool, or one that is bent alike, with which the last one ended."""
        begins = np.eye(4) if bend is None or not len(bend) else bend[0]
        holds = np.eye(4) if self.held_bend is None else self.held_bend
        return bool(np.all(np.abs(begins - holds) < 1e-12))

    def _places(
        self, rows: JointRows, R_BO: Array, guide: Guide | None, home: Array, bend: Array | None
    ) -> tuple[SampledPath, ChosenPlaces] | None:
        """Some poses as the arm sees them with external axes where they are chosen to stand; None: none is chosen."""
        if guide is None or guide.outside is None or not (guide.outside.columns == CHOSEN).any() or not len(rows.path):
            return None
        work = SampledPath.of(rows, R_BO, replace(guide, outside=None), bend)
        chosen = choose_places(
            rows.path,
            work,
            guide,
            spin=self.spin,
            home=home,
            held=self.held is not None,
            branches=self.branches,
            obstacles=self.obstacles,
        )
        p, R = guide.from_arm(work.p_BO, work.R_BO, work.row, chosen.values)
        return replace(work, p_BO=p, R_BO=R), chosen

    def _in_the_work(self, path: ToolPath) -> ToolPath:
        """Rows whose work an external axis carries command the tip in that work."""
        if not self.platforms:
            return path
        states = (replace(s, control=Commanded.POINT) if s.system in self.platforms else s for s in path.states)
        return replace(path, states=tuple(states))

    def _arm_alone(self, home: Array) -> tuple[Kinematics, Array]:
        assert self.outside is not None
        return self.outside.assembly.arm, home[self.outside.assembly.own]

    def _together(self, flange: Flange, nodes: Nodes, q: Array) -> Array:
        """All joints (k, j) at nodes, of those of the arm."""
        assert self.outside is not None and flange.guide is not None
        values = flange.guide.externals(nodes.piece, nodes.s, flange.pieces.points(nodes.piece, nodes.s)[0])
        assert values is not None
        return self.outside.assembly.together(q, values)

    def _report_words(self, path: ToolPath, kinematics: Kinematics, findings: PathFindings) -> None:
        """WordTurns that mean nothing to this arm, and external axes that leave their travel."""
        known = {0, 1, 2} | (set() if self.outside is None else {3 + int(c) for c in self.outside.columns if c >= 0})
        if self._leans(path):
            known |= {3 + turn.word for turn in self.law.turns} if isinstance(self.law, WordTurns) else {3, 4, 5}
        report_missing_axes(path, np.array(sorted(known)), findings)
        if self.outside is not None:
            chosen = np.flatnonzero(self.outside.columns != CHOSEN)
            travel = TravelEnds.of(kinematics.joints, self.outside.assembly.externals[chosen])
            report_travel(path, 3 + self.outside.columns[chosen], travel, findings)

    def _leans(self, path: ToolPath) -> bool:
        """Whether words of the path lean the tool."""
        if self.law is None:
            return False
        return self.words_lean or any(state.control is Commanded.POINT for state in path.states)

    def _guide(self, path: ToolPath) -> Guide | None:
        """What else than the tip changes the place of the flange; None for a fixed attitude in still work."""
        law = self.law if self._leans(path) else None
        if law is None and self.outside is None:
            return None
        table = np.array([self.axes.get(state.system, np.eye(3)) for state in path.states]).reshape(-1, 3, 3)
        axes = table.take(path.state, axis=0)
        numbers = np.array([self.platforms.get(state.system, GROUND) for state in path.states], dtype=np.int64)
        return Guide(
            law=law,
            axes=axes if self.borne is None else self.borne.turned(path, axes),
            outside=self.outside,
            platform=numbers[path.state],
            words_at=None if self.surface is None else self._words_at,
        )

    @property
    def _spacing(self) -> float:
        """[m, rad] between nodes to begin with, where a guide moves the flange."""
        return _CLOSER if self.surface is None else min(_CLOSER, _PARTS * self.surface.smooth)

    def _words_at(self, points: Array) -> Array:
        """Words (k, 3) at points (k, 3) in B, as the surface beside them has it."""
        assert self.surface is not None
        return Direction.values(self.surface.directions(self.X_BM.inverse().apply(points)))

    def _will_do(
        self, kinematics: Kinematics, flange: Flange, nodes: Nodes, q: Array, status: NDArray[np.uint8]
    ) -> bool:
        """Whether all poses are reached, on the branches that are wanted."""
        if np.any(_is_bad(status)):
            return False
        return self.branches is None or on_branches(kinematics, flange.at(nodes.piece, nodes.s), q, self.branches)

    def _hit(self, flange: Flange, nodes: Nodes, q: Array, status: NDArray[np.uint8]) -> tuple[str, str] | None:
        """What hits what first at some of the nodes; None: nothing, as far as is known."""
        some = distinct(np.rint(np.linspace(0, len(nodes) - 1, min(len(nodes), _LOOKS))).astype(np.int64))
        around = Around.at(self.obstacles, flange, nodes.piece[some], nodes.s[some]) if len(nodes) else None
        if around is None:
            return None
        hits = around.hit(q[some], np.arange(len(some))) & ~_is_bad(status[some])
        first = int(np.argmax(hits))
        return around.pair(q[some[first]], first) if hits[first] else None

    def _searched(
        self,
        kinematics: Kinematics,
        flange: Flange,
        nodes: Nodes,
        choice: SpinChoice,
        home: Array,
        simple: Solved,
        findings: PathFindings,
    ) -> tuple[Flange, Solved, SpinChoice, ToldEnd]:
        """Flange, joints and where they begin, by the search over all configurations.

        It keeps clear of obstacles, or else passes through them. Where there is no way, they are as they were, with
        what has been told of that.
        """
        free = self.spin is None and not flange.loose
        straight = flange.unturned() if free else flange
        dense = simple[0] if len(simple[0]) > len(nodes) else nodes
        if not dense.chains:
            return flange, simple, choice, ToldEnd()
        will_do = self._will_do(kinematics, flange, *simple)
        hit = self._hit(flange, *simple) if will_do else None
        blocked: DeadEnd | None = None
        for obstacles in dict.fromkeys((self.obstacles, None)):
            if obstacles is None and will_do:
                break
            chains = 0
            for trial in TRIALS:
                route = route_along(
                    kinematics, straight, dense, home, trial, free=free, branches=self.branches, obstacles=obstacles
                )
                chains = max(chains, route.chains)
                if route.chains < len(dense.chains):
                    continue
                turning = replace(straight, turning=route.turning)
                found = replace(choice, seeds=route.seeds)
                solved = _solve(kinematics, turning, nodes, found, home)
                clear = obstacles is None or self._hit(turning, *solved) is None
                if self._will_do(kinematics, turning, *solved) and clear:
                    if blocked is None:
                        report_route(flange, route.turning, solved[0], hit, findings)
                    else:
                        report_dead_end(kinematics, straight, blocked, findings)
                    return turning, solved, found, ToldEnd()
            guilty = min(chains, len(dense.chains) - 1)
            end = dead_end(kinematics, straight, dense, guilty, free=free, branches=self.branches, obstacles=obstacles)
            if end.obstacle is Hindrance.COLLISION or obstacles is None:
                blocked = end
        told = ToldEnd() if blocked is None else report_dead_end(kinematics, straight, blocked, findings)
        return flange, simple, choice, told

    def after(self, leg: JointPath, path: ToolPath, home: Array) -> FixedAttitude:
        """The spin stays as chosen, and the attitude is held except at home."""
        borne = None if self.borne is None else self.borne.after(path)
        if not isinstance(leg, ArmJoints) or not len(path):
            return replace(self, borne=borne)
        held = None if path.kind[-1] == HOME else self.R_BO(path)[-1]
        outside = self.outside
        if outside is not None and len(leg.q_nodes):
            last = leg.home if held is None else leg.q_nodes[-1]
            outside = replace(outside, rest=last[outside.assembly.externals])
        bend = self._bends(path)
        return replace(
            self,
            spin=leg.flange.last_spin,
            home=home,
            held=held,
            outside=outside,
            held_bend=None if bend is None else bend[-1],
            stands=None if self.stands is None else self.stands.after(path),
            grips=leg.grips,
            borne=borne,
        )

    def R_BO(self, path: ToolPath) -> Array:
        """Axes of O in B for every row of `path` (n, 3, 3)."""
        table = np.array([self.frames.get(state.system, self.upright) for state in path.states]).reshape(-1, 3, 3)
        rows: Array = table.take(path.state, axis=0)
        return rows if self.borne is None else self.borne.turned(path, rows)


def _directions(directions: Array, before: Array) -> Array:
    """Words (n, 3) of directions (n, 3) of an arm's tool, which do not depend on those `before`."""
    del before
    return Direction.values(directions)


def _is_bad(status: NDArray[np.uint8]) -> NDArray[np.bool_]:
    """Whether poses are not on a way that can be run."""
    bad: NDArray[np.bool_] = (status != Status.OK) & (status != Status.SINGULAR)
    return bad


def _solve(kinematics: Kinematics, flange: Flange, nodes: Nodes, choice: SpinChoice, home: Array) -> Solved:
    """Joints (k, j) and status (k,) at nodes, with extra nodes where joints move far."""
    solved = _solved_at(kinematics, flange, nodes, choice, home)
    for _ in range(_REFINEMENTS - 1):
        finer = solved[0].refined(solved[1])
        if finer is None:
            break
        solved = _solved_at(kinematics, flange, finer, choice, home)
    return solved


def _solved_at(kinematics: Kinematics, flange: Flange, nodes: Nodes, choice: SpinChoice, home: Array) -> Solved:
    """Joints (k, j) and status (k,) at just these nodes."""
    X = flange.at(nodes.piece, nodes.s)
    q = np.empty((len(X), len(home)))
    status = np.zeros(len(X), dtype=np.uint8)
    previous = home
    for k, (a, b) in enumerate(nodes.chains):
        q[a:b], status[a:b] = _from_start(kinematics, X[a:b], choice.seeds.get(k, previous))
        previous = q[b - 1]
    return nodes, q, status


def _from_start(kinematics: Kinematics, X_BF: Array, seed: Array) -> tuple[Array, NDArray[np.uint8]]:
    """Joints (n, j) and status (n,) along flange poses (n, 4, 4), begun near `seed` (j,).

    Where the first pose is singular, a joint may stand anywhere there. It stands where the way goes on from, as a way
    back to the start shows, not where the machine happens to come from.
    """
    q, status = kinematics.inverse(X_BF, seed)
    clear = np.flatnonzero(status == Status.OK)
    if status[0] != Status.SINGULAR or not len(clear):
        return q, status
    back, _ = kinematics.inverse(np.ascontiguousarray(X_BF[clear[0] :: -1]), q[clear[0]])
    begun = kinematics.inverse(X_BF, back[-1])
    leap, own = (np.abs(np.diff(each[: clear[0] + 1], axis=0)).max() for each in (q, begun[0]))
    return begun if own < leap and not _is_bad(begun[1][: clear[0] + 1]).any() else (q, status)


def _bridge(nodes: Nodes, q: Array, status: NDArray[np.uint8]) -> NDArray[np.bool_]:
    """Interpolate joints at nodes out of reach, in place; returns which nodes end a segment off the exact path."""
    away = status == _REACH
    for a, b in nodes.chains if away.any() else ():
        here = np.flatnonzero(~away[a:b])
        if len(here):
            at = np.arange(b - a)
            for j in range(q.shape[1]):
                q[a:b, j] = np.interp(at, here, q[a + here, j])
    bridged: NDArray[np.bool_] = away | (status == _FLIP)
    bridged[1:] |= away[:-1]
    # where no branch is within limits, the next pose may be had in another one only
    bad = _is_bad(status)
    if bad.any():
        leaps = greatest(np.abs(np.diff(q, axis=0))) > JUMP
        bridged[1:] |= leaps & (bad[1:] | bad[:-1])
    bridged[nodes.head] = False
    return bridged


def _joint_moves(
    kinematics: Kinematics,
    pieces: Pieces,
    nodes: Nodes,
    q_nodes: Array,
    start: Array,
    home: Array,
    goals: Mapping[int, Array],
) -> dict[int, JointMove]:
    """Every joint move by its piece.

    The first one begins at `start` (j,); those of G28 end at `home` (j,), those at stands at the `goals` of their rows.
    """
    moves: dict[int, JointMove] = {}
    ends = np.searchsorted(nodes.piece, np.arange(len(pieces)), side="right")  # after the last node of each piece
    for piece in np.flatnonzero(pieces.fixed):
        own_node = int(ends[piece]) - 1
        before = start
        if piece > 0 and ends[piece - 1] > 0 and nodes.piece[ends[piece - 1] - 1] == piece - 1:
            before = q_nodes[ends[piece - 1] - 1]
        elif piece > 0:
            before = moves[int(piece) - 1].end
        has_node = own_node >= 0 and nodes.piece[own_node] == piece
        after = q_nodes[own_node] if has_node else goals.get(int(pieces.row_last[piece]), home)
        moves[int(piece)] = JointMove.between(before, after, kinematics.joints)
    return moves


def _joints_before(
    pieces: Pieces, nodes: Nodes, q_nodes: Array, moves: Mapping[int, JointMove], start: Array, row: int
) -> Array:
    """The joints (j,) with which a row begins; `start` before the first one."""
    piece = int(np.searchsorted(pieces.row_last, row, side="left")) - 1
    if piece < 0:
        return start
    if piece in moves:
        return moves[piece].end
    joints: Array = q_nodes[int(np.searchsorted(nodes.piece, piece, side="right")) - 1]
    return joints


def _moves_within(
    moves: dict[int, JointMove], loads: Loads, pieces: Pieces
) -> tuple[dict[int, JointMove], list[Slowing]]:
    """The joint moves by their pieces, slower where motors need it, and what they need it for."""
    found, why = {}, []
    cases = loads.on_rows(pieces.path)
    for piece, move in moves.items():
        tool = int(cases[pieces.row_last[piece]])
        found[piece], slowing = move.within(loads, tool, piece)
        why += [] if slowing is None else [slowing]
    return found, why


def _seen_from_base(path: ToolPath, X_BM: Pose) -> ToolPath:
    """The path in B; its words stay as they are."""
    start, end = path.start.copy(), path.end.copy()
    for points in (start, end):
        points[:, :3] = X_BM.apply(points[:, :3])
    return replace(path, start=start, end=end, center=X_BM.apply(path.center), normal=X_BM.rotate(path.normal))


def _with_words(limits: AxisLimits, guide: Guide, joints: Joints) -> AxisLimits:
    """Limits of a, b, c too: of an external axis its own, of a leaning tool those of the slowest joint."""
    speed, acceleration = limits.speed.copy(), limits.acceleration.copy()
    turning = np.array([kind == "revolute" for kind in joints.kinds])
    if guide.law is not None and turning.any():
        speed[3:], acceleration[3:] = joints.speed[turning].min(), joints.acceleration[turning].min()
    if guide.outside is not None:
        for joint, column in zip(guide.outside.assembly.externals, guide.outside.columns, strict=True):
            if column != CHOSEN:
                speed[3 + column], acceleration[3 + column] = joints.speed[joint], joints.acceleration[joint]
    return AxisLimits(speed=speed, acceleration=acceleration)
