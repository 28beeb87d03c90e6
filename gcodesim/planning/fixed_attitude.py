"""Posing of arms: a three-axis program with the tool in a fixed attitude, under the limits of the joints.

The path is cut into nodes; joints at the nodes come from the inverse
kinematics, joint rates from the Jacobian, and the time law gets caps on speed
and acceleration for every segment between two nodes. Moves away from home and
to it are run in joint space.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from gcodesim.canon import Axes
from gcodesim.diagnostics import Findings
from gcodesim.frames import Array, Pose
from gcodesim.frozen import frozen
from gcodesim.kinematics.protocol import Status
from gcodesim.motion.blend import blend
from gcodesim.motion.blend_kernels import NORMAL_SHARE
from gcodesim.motion.pieces import OVERLAP, Pieces
from gcodesim.motion.timing import Caps
from gcodesim.motion.tool_path import HOME, Commanded, ToolPath
from gcodesim.motion.trajectory import Samples
from gcodesim.planning import joint_moves
from gcodesim.planning.arm_kernels import JointCaps, SegmentRates, joint_caps, joint_rates
from gcodesim.planning.axis_posing import offsets
from gcodesim.planning.configuration import on_branches
from gcodesim.planning.flange_poses import flange_origins, flange_poses, spin_of, turned
from gcodesim.planning.joint_rows import with_joint_rows
from gcodesim.planning.nodes import Nodes
from gcodesim.planning.plan import JointExtremes, JointPath
from gcodesim.planning.posing import Posed
from gcodesim.planning.reach import report_poses, report_slow_joints
from gcodesim.planning.route import TRIALS, dead_end, route_along
from gcodesim.planning.route_findings import report_dead_end, report_route
from gcodesim.planning.spin_along import SpinAlong
from gcodesim.planning.spin_choice import SampledPath, SpinChoice, choose_spin
from gcodesim.planning.travel import report_missing_axes

if TYPE_CHECKING:
    from gcodesim.kinematics.protocol import Kinematics

Solved: TypeAlias = tuple[Nodes, Array, NDArray[np.uint8]]  # nodes, joints (k, j) and status (k,) at them

_REFINEMENTS: Final = 3
_CLOSE: Final = 1e-6  # [m]
# A joint is nowhere this much faster than on average between its nodes: on a singularity the Jacobian says infinity,
# while the joint only turns by what lies between the nodes.
_STEEPEST: Final = 10.0
_REACH: Final = 1  # statuses of the inverse kinematics that leave the path
_FLIP: Final = 4


@frozen(kw_only=False, eq=False)
class Flange:
    """Where the flange has to be when the controlled point is somewhere on the pieces."""

    pieces: Pieces
    R_BO: Array  # of every row (n, 3, 3)
    offset: Array  # of every row (n, 3) [m]
    spin: float
    turning: SpinAlong | None = None  # of the tool about itself along the path, on top of `spin`

    def poses(self, piece: NDArray[np.int64], s: Array, positions: Array) -> Array:
        """X_BF (k, 4, 4) with the controlled point at `positions` (k, 3), which are at `s` (k,) of `piece` (k,)."""
        row = self.pieces.row_first[piece]
        R = self.R_BO[row]
        X = flange_poses(flange_origins(positions, self.offset[row], R), R, self.spin)
        return X if self.turning is None else turned(X, self.turning.at(piece, s)[0])

    def at(self, piece: NDArray[np.int64], s: Array) -> Array:
        """X_BF (k, 4, 4) at places `s` (k,) of `piece` (k,)."""
        return self.poses(piece, s, self.pieces.points(piece, s)[0][:, :3])

    def velocities(self, piece: NDArray[np.int64], s: Array) -> Array:
        """Velocity (k, 3) of the flange by the way, or (k, 6) with the angular one, where it turns."""
        v = self.pieces.points(piece, s)[1][:, :3]
        if self.turning is None:
            return v
        rate = self.turning.at(piece, s)[1]
        return np.concatenate([v, -rate[:, None] * self.R_BO[self.pieces.row_first[piece]][:, :, 2]], axis=1)

    def unturned(self) -> Flange:
        """The same with a spin of 0 all along."""
        return replace(self, spin=0.0, turning=None)

    @property
    def last_spin(self) -> float:
        """The spin [rad] at the end of the path."""
        return self.spin if self.turning is None else self.spin + float(self.turning.spin[-1])


@frozen(slots=False, kw_only=False, eq=False)
class ArmJoints:
    """Joints along a trajectory: exact inverse kinematics from the nearest node, straight lines in joint moves.

    Where the path is out of reach (`bridged`, by the node that ends the segment) joints run straight between nodes.
    """

    kinematics: Kinematics
    flange: Flange
    nodes: Nodes
    q_nodes: Array
    bridged: NDArray[np.bool_]
    home: Array
    moves: dict[int, tuple[Array, Array]]  # joints at start and end of pieces in joint space

    def joints(self, samples: Samples) -> Array:
        """Joint values (n, j) [rad, m] at samples in order of time."""
        q = np.tile(self.home, (len(samples), 1))
        pieces = self.flange.pieces
        if not len(pieces) or not len(samples):
            return q
        own = pieces.fixed[samples.piece]
        after = self.nodes.at_or_after(self._keys, samples.piece, samples.s, pieces.length)
        bridge = ~own & self.bridged[after]
        # runs of samples on one joint move, on one bridge, or of exact joints between them
        run = np.where(own, 3 * samples.piece, 3 * np.cumsum(pieces.fixed)[samples.piece] + 1 + bridge)
        starts = np.flatnonzero(np.append(True, run[1:] != run[:-1]))
        for a, b in zip(starts, np.append(starts[1:], len(run)), strict=True):
            if own[a]:
                q[a:b] = self._in_joint_space(int(samples.piece[a]), samples.s[a:b])
            elif bridge[a]:
                q[a:b] = self._on_bridge(after[a:b], samples.piece[a:b], samples.s[a:b])
            else:
                X = self.flange.poses(samples.piece[a:b], samples.s[a:b], samples.position[a:b, :3])
                seed = int(after[a]) - (not self.nodes.head[after[a]])
                q[a:b] = self.kinematics.inverse(X, self.q_nodes[seed])[0]
        return q

    @cached_property
    def _keys(self) -> Array:
        return self.nodes.keys(self.flange.pieces.length)

    def _on_bridge(self, node: NDArray[np.intp], piece: NDArray[np.int64], s: Array) -> Array:
        nodes = self.nodes
        begin = np.where(nodes.piece[node] == nodes.piece[node - 1], nodes.s[node - 1], 0.0)
        share = np.clip((s - begin) / np.maximum(nodes.s[node] - begin, 1e-300), 0.0, 1.0)[:, None]
        q: Array = self.q_nodes[node - 1] + share * (self.q_nodes[node] - self.q_nodes[node - 1])
        return q

    def _in_joint_space(self, piece: int, t: Array) -> Array:
        q0, q1 = self.moves[piece]
        step = q1 - q0
        if not np.any(np.abs(step) > joint_moves.STILL):
            return np.tile(q1, (len(t), 1))
        share = joint_moves.share_at(t, *joint_moves.law(step, self.kinematics.joints))
        q: Array = q0 + share[:, None] * step
        return q

    def extremes(self) -> JointExtremes:
        """How far each joint goes at the nodes and at the ends of joint moves."""
        q, piece = [self.home[None], self.q_nodes], [np.zeros(1, dtype=np.int64), self.nodes.piece]
        for move, (_, end) in self.moves.items():
            q.append(end[None])
            piece.append(np.array([move]))
        table = np.concatenate(q)
        rows = self.flange.pieces.row_first
        row = rows[np.concatenate(piece)].astype(np.int64) if len(rows) else np.zeros(len(table), dtype=np.int64)
        low, high = table.argmin(axis=0), table.argmax(axis=0)
        return JointExtremes(table.min(axis=0), table.max(axis=0), row[low], row[high])


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
    """

    frames: Mapping[int, Array] = field(default_factory=dict)
    upright: Array = field(default_factory=lambda: np.eye(3))
    spin: float | None = None
    X_BM: Pose = field(default_factory=Pose.identity)
    joint_rapids: bool = False
    home: Array | None = None
    held: Array | None = None
    branches: tuple[int, ...] | None = None

    @property
    def understands(self) -> frozenset[Commanded]:
        return frozenset((Commanded.AXES,))

    def start(self, kinematics: Kinematics, home: Array) -> Axes:
        """Where the flange stands at `home` (j,), seen from M."""
        p_BF = kinematics.forward(np.asarray(home, dtype=float)[None])[0, :3, 3]
        x, y, z = self.X_BM.inverse().apply(p_BF)
        return (float(x), float(y), float(z), 0.0, 0.0, 0.0)

    def pose(self, path: ToolPath, kinematics: Kinematics, home: Array, findings: Findings) -> Posed:
        """Where poses are out of reach, the joints run straight to where they are in reach again; a finding says so."""
        home = np.asarray(home, dtype=float)
        path = path.transform(self.X_BM)
        report_missing_axes(path, np.arange(3), findings)
        rows = with_joint_rows(path, self.R_BO(path), joint_rapids=self.joint_rapids, held=self.held)
        path = rows.path
        R_BO = self.R_BO(path)
        probe = SampledPath.of(rows, R_BO)
        near = spin_of(kinematics.forward(home[None])[0, :3, :3], R_BO[0] if len(path) else self.upright)
        choice = choose_spin(kinematics, probe, home, near, self.spin)
        pieces = blend(path, choice.limits, own_time=np.where(rows.joint, 1.0, np.nan))
        flange = Flange(pieces, R_BO, offsets(path)[:, :3], choice.spin)
        at_home = pieces.fixed & rows.home[pieces.row_first]
        solved = _solve(kinematics, flange, Nodes.of(pieces, at_home), choice, home)
        part = ""
        if not self._will_do(kinematics, flange, *solved):
            flange, solved, part = self._searched(
                kinematics, flange, Nodes.of(pieces, at_home), choice, home, solved, findings
            )
        nodes, q_nodes, status = solved
        report_poses(kinematics, flange, nodes, q_nodes, status, probe, choice, home, part, findings)
        bridged = _bridge(nodes, q_nodes, status)
        moves = _joint_moves(kinematics, pieces, nodes, q_nodes, home, home if self.home is None else self.home)
        caps = _caps(kinematics, flange, nodes, q_nodes, bridged, findings)
        return Posed(pieces, ArmJoints(kinematics, flange, nodes, q_nodes, bridged, home, moves), caps)

    def _will_do(
        self, kinematics: Kinematics, flange: Flange, nodes: Nodes, q: Array, status: NDArray[np.uint8]
    ) -> bool:
        """Whether all poses are reached, on the branches that are wanted."""
        if np.any(_is_bad(status)):
            return False
        return self.branches is None or on_branches(kinematics, flange.at(nodes.piece, nodes.s), q, self.branches)

    def _searched(
        self,
        kinematics: Kinematics,
        flange: Flange,
        nodes: Nodes,
        choice: SpinChoice,
        home: Array,
        simple: Solved,
        findings: Findings,
    ) -> tuple[Flange, Solved, str]:
        """Flange and joints by the search over all configurations.

        Where there is none, they are as they were, and the text says which part of the path can be run.
        """
        free = self.spin is None
        straight = flange.unturned() if free else flange
        dense = simple[0] if len(simple[0]) > len(nodes) else nodes
        chains = 0
        for trial in TRIALS:
            route = route_along(kinematics, straight, dense, home, trial, free=free, branches=self.branches)
            chains = max(chains, route.chains)
            if route.chains == len(dense.chains):
                turning = replace(straight, turning=route.turning)
                solved = _solve(kinematics, turning, nodes, replace(choice, seeds=route.seeds), home)
                if self._will_do(kinematics, turning, *solved):
                    report_route(flange, route.turning, solved[0], findings)
                    return turning, solved, ""
        if not dense.chains:
            return flange, simple, ""
        guilty = min(chains, len(dense.chains) - 1)
        end = dead_end(kinematics, straight, dense, guilty, free=free, branches=self.branches)
        return flange, simple, report_dead_end(kinematics, straight, dense, end, findings)

    def after(self, leg: JointPath, path: ToolPath, home: Array) -> FixedAttitude:
        """The spin stays as chosen, and the attitude is held except at home."""
        if not isinstance(leg, ArmJoints) or not len(path):
            return self
        held = None if path.kind[-1] == HOME else self.R_BO(path)[-1]
        return replace(self, spin=leg.flange.last_spin, home=home, held=held)

    def R_BO(self, path: ToolPath) -> Array:
        """Axes of O in B for every row of `path` (n, 3, 3)."""
        table = np.array([self.frames.get(state.system, self.upright) for state in path.states]).reshape(-1, 3, 3)
        rows: Array = table[path.state]
        return rows


def _is_bad(status: NDArray[np.uint8]) -> NDArray[np.bool_]:
    """Whether poses are not on a way that can be run."""
    bad: NDArray[np.bool_] = (status != Status.OK) & (status != Status.SINGULAR)
    return bad


def _solve(kinematics: Kinematics, flange: Flange, nodes: Nodes, choice: SpinChoice, home: Array) -> Solved:
    """Joints (k, j) and status (k,) at nodes, with extra nodes where joints move far."""
    for refinement in range(_REFINEMENTS):
        X = flange.at(nodes.piece, nodes.s)
        q = np.empty((len(X), len(home)))
        status = np.zeros(len(X), dtype=np.uint8)
        previous = home
        for k, (a, b) in enumerate(nodes.chains):
            q[a:b], status[a:b] = kinematics.inverse(X[a:b], choice.seeds.get(k, previous))
            previous = q[b - 1]
        finer = nodes.refined(q) if refinement + 1 < _REFINEMENTS else None
        if finer is None:
            break
        nodes = finer
    return nodes, q, status


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
    bridged[nodes.head] = False
    return bridged


def _joint_moves(
    kinematics: Kinematics, pieces: Pieces, nodes: Nodes, q_nodes: Array, start: Array, home: Array
) -> dict[int, tuple[Array, Array]]:
    """Joints at both ends of every joint move by piece; the time it takes is written into the pieces.

    The first one begins at `start` (j,); those of G28 end at `home` (j,).
    """
    moves: dict[int, tuple[Array, Array]] = {}
    ends = np.searchsorted(nodes.piece, np.arange(len(pieces)), side="right")  # after the last node of each piece
    for piece in np.flatnonzero(pieces.fixed):
        own_node = int(ends[piece]) - 1
        before = start
        if piece > 0 and ends[piece - 1] > 0 and nodes.piece[ends[piece - 1] - 1] == piece - 1:
            before = q_nodes[ends[piece - 1] - 1]
        elif piece > 0:
            before = moves[int(piece) - 1][1]
        has_node = own_node >= 0 and nodes.piece[own_node] == piece
        after = q_nodes[own_node] if has_node else home
        moves[int(piece)] = (before, after)
        time = max(joint_moves.duration(after - before, kinematics.joints), joint_moves.SHORTEST)
        pieces.length[piece] = time
        pieces.curves.length[pieces.curve[piece]] = time
    return moves


def _caps(
    kinematics: Kinematics, flange: Flange, nodes: Nodes, q: Array, bridged: NDArray[np.bool_], findings: Findings
) -> Caps:
    """Caps of every segment between nodes; a joint move is one segment."""
    pieces, joints, i = flange.pieces, kinematics.joints, nodes.segments
    piece, begin = nodes.piece[i], nodes.begin
    length = nodes.s[i] - begin
    J = np.ascontiguousarray(kinematics.jacobian(q))
    speed_limit = np.minimum(joints.speed, 1e6)
    acceleration_limit = np.minimum(joints.acceleration, 1e6)
    out, back = flange.velocities(piece, begin), flange.velocities(piece, begin + length)
    leaving, arriving = np.zeros((len(nodes), out.shape[1])), np.zeros((len(nodes), out.shape[1]))
    leaving[i - 1], arriving[i] = out, back
    rates = joint_rates(J, leaving, arriving)
    # between close nodes the difference of joints is only rounding; the rates at their ends are enough
    mean_rate = np.where(length[:, None] > _CLOSE, (q[i] - q[i - 1]) / length[:, None], 0.0)
    bridge = bridged[i, None]
    most = _STEEPEST * _neighbourhood(np.abs(mean_rate))
    most[length <= _CLOSE] = np.inf
    start_rate, end_rate = (
        np.where(bridge, mean_rate, np.clip(rate, -most, most)) for rate in (rates[0][i - 1], rates[1][i])
    )
    wanted = _wanted_speed(pieces)[piece]
    caps = JointCaps(
        wanted=wanted.copy(),
        speed=np.empty(len(i)),
        acceleration=np.where(pieces.kind[piece] == OVERLAP, 0.0, np.inf),
        joint=np.empty(len(i), dtype=np.int64),
    )
    joint_caps(
        SegmentRates(start_rate, end_rate, mean_rate), length, NORMAL_SHARE, speed_limit, acceleration_limit, caps
    )
    exact = ~bridged[i]
    report_slow_joints(kinematics, pieces, piece[exact], wanted[exact], caps.wanted[exact], caps.joint[exact], findings)
    last = np.append(piece[1:] != piece[:-1], True)[: len(i)]
    junction = np.where(last, pieces.junction[piece], np.inf)
    fixed = np.flatnonzero(pieces.fixed)
    zeros = np.zeros(len(fixed))
    order = np.argsort(np.concatenate([piece, fixed]), kind="stable")
    columns = (
        (piece, fixed),
        (begin, zeros),
        (length, pieces.length[fixed]),
        (caps.speed, zeros),
        (caps.acceleration, zeros),
        (junction, zeros),
    )
    return Caps(*(np.concatenate(pair)[order] for pair in columns))


def _neighbourhood(values: Array) -> Array:
    """The greatest values of each row (k, j) and its neighbours."""
    most = values.copy()
    most[1:] = np.maximum(most[1:], values[:-1])
    most[:-1] = np.maximum(most[:-1], values[1:])
    return most


def _wanted_speed(pieces: Pieces) -> Array:
    """What the program asks for on each piece [m/s]; corner arcs take the faster of their two rows."""
    feed = pieces.path.feed
    wanted: Array = np.maximum(feed[pieces.row_first], feed[pieces.row_last])
    return np.where(pieces.kind == OVERLAP, pieces.speed, wanted)
