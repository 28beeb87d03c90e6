"""What the joints of an arm allow along a path: caps on speed and acceleration of every segment between two nodes."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.diagnostics import Findings
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.motion.blend_kernels import NORMAL_SHARE
from gcodesim.motion.pieces import OVERLAP, Pieces
from gcodesim.motion.timing import Caps, Softness
from gcodesim.planning.arm_kernels import JointCaps, SegmentRates, joint_caps, joint_rates
from gcodesim.planning.flange import Flange
from gcodesim.planning.guide import Outside
from gcodesim.planning.jerk import softer
from gcodesim.planning.kinks import Kinks
from gcodesim.planning.loads import Loads, Slowing
from gcodesim.planning.nodes import Nodes
from gcodesim.planning.reach import report_slow_joints

if TYPE_CHECKING:
    from gcodesim.kinematics.protocol import Kinematics

_CLOSE: Final = 1e-6  # [m] between nodes, where the difference of joints is only rounding
_SHARE: Final = 0.99  # of each limit, where more than the tip moves the flange; the rest is for what changes besides
# A joint is nowhere this much faster than on average between its nodes: on a singularity the Jacobian says infinity,
# while the joint only turns by what lies between the nodes.
_STEEPEST: Final = 10.0
_ROUGH: Final = 0.05  # of an acceleration limit, by which q'' may change within half a segment before that is cut
_SHORTEST: Final = 4e-6  # [m] of a segment that is cut


@frozen(kw_only=False, eq=False)
class ArmCaps:
    """Caps of the k segments between `nodes`, `found`; `wanted` (k,) is the speed that the program asks for [m/s].

    `exact` (k,) marks those on which the arm follows the path; `junction` (k,) caps the speed at their ends, and
    `kinks` does so where the rates of joints step.
    """

    pieces: Pieces
    piece: NDArray[np.int64]
    begin: Array
    length: Array
    wanted: Array
    exact: NDArray[np.bool_]
    rates: SegmentRates
    found: JointCaps
    junction: Array
    kinks: Kinks
    soft: Softness | None = None

    @staticmethod
    def of(kinematics: Kinematics, flange: Flange, nodes: Nodes, q: Array, bridged: NDArray[np.bool_]) -> ArmCaps:
        """Caps with all joints at `q` (k, j) at the nodes; segments that end at nodes `bridged` (k,) run straight."""
        pieces, joints, i = flange.pieces, kinematics.joints, nodes.segments
        piece, begin = nodes.piece[i], nodes.begin
        length = nodes.s[i] - begin
        rates = _rates(kinematics, flange, nodes, q, bridged)
        wanted = _wanted_speed(pieces)[piece]
        share = 1.0 if flange.guide is None and flange.turning is None else _SHARE
        speed, acceleration = share * np.minimum(joints.speed, 1e6), share * np.minimum(joints.acceleration, 1e6)
        found = JointCaps(
            wanted=wanted.copy(),
            speed=np.empty(len(i)),
            # an overlap is run evenly; under jerk, as any other curve
            acceleration=np.where((pieces.kind[piece] == OVERLAP) & np.isinf(joints.jerk).all(), 0.0, np.inf),
            joint=np.empty(len(i), dtype=np.int64),
            unresolved=np.empty(len(i)),
        )
        joint_caps(rates, length, NORMAL_SHARE, speed, acceleration, found)
        exact = ~bridged[i]
        changes = (piece[1:] != piece[:-1]) | ~exact[1:] | ~exact[:-1]
        follows = np.diff(i) == 1
        last = np.append(piece[1:] != piece[:-1], True)[: len(piece)]
        junction = np.minimum(np.where(last, pieces.junction[piece], np.inf), found.speed)
        kinks = Kinks.between(rates, junction, pieces.ratio[piece], changes & follows, acceleration)
        return ArmCaps(pieces, piece, begin, length, wanted, exact, rates, found, junction, kinks)

    def softened(self, nodes: Nodes, limit: Array) -> ArmCaps:
        """The caps that keep the jerk of joints within `limit` (j,) too; as they are if there is none."""
        if np.isinf(limit).all():
            return self
        follows = np.append(np.diff(nodes.segments) == 1, False)[: len(self.piece)]
        goes_on = np.append((self.piece[1:] == self.piece[:-1]) & self.exact[1:] & self.exact[:-1], False)
        goes_on = goes_on[: len(self.piece)]
        lower = softer(self.rates, self.length, follows, goes_on, limit, self.found, self.junction)
        return replace(self, found=lower.found, junction=lower.junction, soft=lower.soft)

    @property
    def parts(self) -> Array:
        """Into how many parts each segment (k,) has to be cut, so that q'' changes little within each."""
        # halves leave a quarter of the change
        parts = np.ceil(np.sqrt(self.found.unresolved / _ROUGH))
        return np.where(self.exact & (self.length > _SHORTEST), np.maximum(parts, 1.0), 1.0)

    def report(self, kinematics: Kinematics, findings: Findings) -> None:
        """Tell where joints keep the feed down."""
        exact, found = self.exact, self.found
        report_slow_joints(
            kinematics,
            self.pieces,
            self.piece[exact],
            self.wanted[exact],
            found.wanted[exact],
            found.joint[exact],
            findings,
        )

    def within(self, loads: Loads, nodes: Nodes, q: Array) -> tuple[ArmCaps, list[Slowing]]:
        """The caps slowed so that motors can give the efforts of joints q (k, j), and what that is needed for.

        Efforts are M q' a + (M q'' + C) v² + G. Those of both ends of a segment, at its top speed and at rest, with its
        acceleration forwards and backwards, are looked at: everything in between lies between them.
        """
        i, path = nodes.segments, self.pieces.path
        tool = loads.on_rows(path)[self.pieces.row_first[self.piece]]
        v, a = self.found.speed[:, None], np.minimum(self.found.acceleration, 1e6)[:, None]
        r0, r1, mean = self.rates
        step, twice, h = r1 - r0, 6.0 * mean - 3.0 * (r0 + r1), self.length[:, None]
        feeding = np.isfinite(path.feed[self.pieces.row_first[self.piece]])
        share, why = np.ones(len(i)), []
        for at, rate, bend in ((i - 1, r0, (step + twice) / h), (i, r1, (step - twice) / h)):
            qd, along, across = rate * v, rate * a, bend * v * v
            static, ahead, behind = loads.efforts(tool, q[at], (0.0, 0.0), (qd, along + across), (qd, across - along))
            push = 0.5 * (ahead - behind)
            reserve = loads.reserve(tool, q[at], qd, feeding)
            slowing = loads.slowing(self.piece, static, ahead, behind, static + push, static - push, reserve=reserve)
            share = np.minimum(share, slowing.share)
            why.append(slowing.needed)
        found = self.found._replace(
            speed=self.found.speed * np.sqrt(share), acceleration=self.found.acceleration * share
        )
        return replace(self, found=found, junction=np.minimum(self.junction, found.speed)), why

    def with_moves(self) -> Caps:
        """The caps of everything: a joint move is one segment that takes its own time."""
        pieces, piece = self.pieces, self.piece
        fixed = np.flatnonzero(pieces.fixed)
        zeros = np.zeros(len(fixed))
        order = np.argsort(np.concatenate([piece, fixed]), kind="stable")
        soft = None if self.soft is None else self.soft.with_fixed(len(fixed), order)
        columns = (
            (piece, fixed),
            (self.begin, zeros),
            (self.length, pieces.length[fixed]),
            (self.found.speed, zeros),
            (self.found.acceleration * self.kinks.left, zeros),
            (np.minimum(self.junction, self.kinks.cap), zeros),
        )
        segment, start, way, speed, acceleration, end = (np.concatenate(pair)[order] for pair in columns)
        return Caps(segment, start, way, speed, acceleration, end, soft)


def _rates(kinematics: Kinematics, flange: Flange, nodes: Nodes, q: Array, bridged: NDArray[np.bool_]) -> SegmentRates:
    """Rates of all joints by the way, at both ends of each segment and on average."""
    i = nodes.segments
    piece, begin = nodes.piece[i], nodes.begin
    length = nodes.s[i] - begin
    outside = None if flange.guide is None else flange.guide.outside
    own = q if outside is None else q[:, outside.assembly.own]
    J = np.ascontiguousarray((kinematics if outside is None else outside.assembly.arm).jacobian(own))
    out, back = flange.velocities(piece, begin), flange.velocities(piece, begin + length)
    leaving, arriving = np.zeros((len(nodes), out.shape[1])), np.zeros((len(nodes), out.shape[1]))
    leaving[i - 1], arriving[i] = out, back
    rates = joint_rates(J, leaving, arriving)
    if outside is not None:
        rates = _with_outside(rates, outside, flange, (i, piece, begin, length))
    first, last = rates[0][i - 1], rates[1][i]
    far = (length > _CLOSE)[:, None]
    mean = np.where(far, (q[i] - q[i - 1]) / length[:, None], 0.5 * (first + last))
    bridge = bridged[i, None]
    most = np.where(far, _STEEPEST * _neighbourhood(np.abs(mean)), np.inf)
    start, end = (np.where(bridge, mean, np.clip(rate, -most, most)) for rate in (first, last))
    return SegmentRates(start, end, mean)


def _with_outside(
    rates: tuple[Array, Array],
    outside: Outside,
    flange: Flange,
    segments: tuple[NDArray[np.intp], NDArray[np.int64], Array, Array],
) -> tuple[Array, Array]:
    """Rates of all joints by the way: those of the arm at each node, leaving and arriving, and those outside."""
    i, piece, begin, length = segments
    leaving, arriving = (np.zeros((len(rates[0]), len(outside.columns))) for _ in range(2))
    for table, node, s in ((leaving, i - 1, begin), (arriving, i, begin + length)):
        table[node] = outside.slopes(piece, s, flange.pieces.points(piece, s)[1])
    return outside.assembly.together(rates[0], leaving), outside.assembly.together(rates[1], arriving)


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
