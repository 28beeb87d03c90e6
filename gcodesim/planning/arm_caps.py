"""What the joints of an arm allow along a path: caps on speed and acceleration of every segment between two nodes."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.batches import batches
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.motion.blend_kernels import NORMAL_SHARE
from gcodesim.motion.pieces import OVERLAP, Pieces
from gcodesim.motion.timing import Caps, Softness
from gcodesim.planning.arm_kernels import (
    JointCaps,
    SegmentRates,
    hold_rates,
    hurry_shares,
    joint_caps,
    joint_rates,
    mean_rates,
)
from gcodesim.planning.flange import Flange
from gcodesim.planning.jerk import softer
from gcodesim.planning.kinks import Kinks
from gcodesim.planning.loads import Loads, Slowing
from gcodesim.planning.moments import PathFindings
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
_CLOSELY: Final = 2  # looks at all segments of a path
_SHORTEST: Final = 4e-6  # [m] of a segment that is cut
_PLENTY: Final = 1e6  # [m/s²] that stand for any acceleration


@frozen(kw_only=False, eq=False)
class ArmCaps:
    """Caps of the k segments between `nodes`, `found`; `wanted` (k,) is the speed that the program asks for [m/s].

    `exact` (k,) marks those on which the arm follows the path; `junction` (k,) caps the speed at their ends, and
    `kinks` does so where the rates of joints step. The arm `rests` (k,) before segments that begin a chain, and
    `swings` along splines through many directions.
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
    rests: NDArray[np.bool_]
    swings: bool
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
        rests = np.append(True, ~follows)[: len(piece)]
        swings = flange.guide is not None and flange.guide.turning is not None
        return ArmCaps(pieces, piece, begin, length, wanted, exact, rates, found, junction, kinks, rests, swings)

    def softened(self, nodes: Nodes, limit: Array) -> ArmCaps:
        """The caps that keep the jerk of joints within `limit` (j,) too; as they are if there is none."""
        if np.isinf(limit).all():
            return self
        follows = np.append(np.diff(nodes.segments) == 1, False)[: len(self.piece)]
        goes_on = np.append((self.piece[1:] == self.piece[:-1]) & self.exact[1:] & self.exact[:-1], False)
        goes_on = goes_on[: len(self.piece)]
        lower = softer(self.rates, self.length, follows, goes_on, limit, self.found, self.junction)
        return replace(self, found=lower.found, junction=lower.junction, soft=lower.soft)

    def parts(self, looks: int) -> Array:
        """Into how many parts each segment (k,) has to be cut, so that q'' changes little within each.

        After the first `looks` twice as much will do, since steps of a few micrometres tell noise, and what counts is
        the speed that motion can have there: where q'' passes zero, any speed would be allowed, in steps of any size.
        Along splines that make the arm swing, that counts at once.
        """
        rough = self.found.unresolved / (_ROUGH if looks < _CLOSELY else 2.0 * _ROUGH)
        if looks >= _CLOSELY or self.swings:
            shares = np.empty(len(self.piece))
            end = np.minimum(self.junction, self.kinks.cap)
            acceleration = self.found.acceleration * self.kinks.left
            hurry_shares(self.length, self.found.speed, acceleration, end, self.rests, shares)
            rough = rough * shares
        # halves leave a half of the change, or a quarter where it is a bow
        parts = np.ceil(np.sqrt(rough))
        return np.where(self.exact & (self.length > _SHORTEST), np.maximum(parts, 1.0), 1.0)

    def report(self, kinematics: Kinematics, findings: PathFindings) -> None:
        """Tell where joints keep the feed down."""
        exact, found = self.exact, self.found
        report_slow_joints(
            kinematics,
            self.pieces,
            (self.piece[exact], self.begin[exact]),
            self.wanted[exact],
            found.wanted[exact],
            found.joint[exact],
            findings,
        )

    def within(self, loads: Loads, nodes: Nodes, q: Array) -> tuple[ArmCaps, list[Slowing]]:
        """The caps slowed so that motors can give the efforts of joints q (k, j), and what that is needed for.

        Efforts are M q' a + (M q'' + C) v² + G. Those of both ends of a segment, at its top speed and at rest, with its
        acceleration forwards and backwards, are looked at: everything in between lies between them. Where bounds say
        that motors have enough, anywhere or with the weight of the arm as it stands, efforts are not worked out.
        """
        path, row = self.pieces.path, self.pieces.row_first[self.piece]
        tool, feeding = loads.on_rows(path)[row], np.isfinite(path.feed[row])
        share, why = np.ones(len(row)), []
        for at_end in (False, True):
            for part in batches(len(row)):
                ample = loads.ample_anywhere(tool[part], *self._run(part), at_end=at_end)
                k = part.start + np.flatnonzero(~ample)
                if not len(k):
                    continue
                at = q[nodes.segments[k] - (not at_end)]
                (static,) = loads.efforts(tool[k], at, (0.0, 0.0))
                qd, along, across = self._motions(k, at_end=at_end)
                scarce = np.flatnonzero(~loads.ample(tool[k], static, qd, np.abs(along) + np.abs(across)))
                if not len(scarce):
                    continue
                k, at, static, qd, along, across = (each[scarce] for each in (k, at, static, qd, along, across))
                s = self.begin[k] + self.length[k] if at_end else self.begin[k]
                ahead, behind = loads.efforts(tool[k], at, (qd, across + along), (qd, across - along))
                push = 0.5 * (ahead - behind)
                moved = (ahead, behind, static + push, static - push)
                reserve = loads.reserve(tool[k], at, qd, feeding[k])
                slowing = loads.slowing((self.piece[k], s), static, *moved, reserve=reserve)
                share[k] = np.minimum(share[k], slowing.share)
                why.append(slowing.needed)
        found = self.found._replace(
            speed=self.found.speed * np.sqrt(share), acceleration=self.found.acceleration * share
        )
        return replace(self, found=found, junction=np.minimum(self.junction, found.speed)), why

    def _run(self, some: slice | NDArray[np.intp]) -> tuple[SegmentRates, Array, Array, Array]:
        """Rates on some segments, their lengths, and the greatest speeds and accelerations there."""
        rates = SegmentRates(*(column[some] for column in self.rates))
        return rates, self.length[some], self.found.speed[some], np.minimum(self.found.acceleration[some], _PLENTY)

    def _motions(self, some: NDArray[np.intp], *, at_end: bool) -> tuple[Array, Array, Array]:
        """Speeds (k, j) of joints at top speed on some segments, and accelerations along the way and across.

        Where they begin, or end.
        """
        from gcodesim.planning.load_kernels import motions_at

        rates, length, speed, most = self._run(some)
        qd, along, across = (np.empty(rates.start.shape) for _ in range(3))
        motions_at(rates, length, speed, most, at_end, qd, along, across)
        return qd, along, across

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
    length = nodes.s[i] - nodes.begin
    rates = SegmentRates(*(np.empty((len(i), q.shape[1])) for _ in range(3)))
    for some in batches(len(i)):
        first, last = _exact_rates(kinematics, flange, nodes, q, some)
        rates.start[some], rates.end[some] = first, last
    mean_rates(np.ascontiguousarray(q), i, length, _CLOSE, rates)
    hold_rates(rates, length, bridged[i], _CLOSE, _STEEPEST)
    return rates


def _exact_rates(kinematics: Kinematics, flange: Flange, nodes: Nodes, q: Array, some: slice) -> tuple[Array, Array]:
    """Rates of all joints by the way (k, j) where some segments begin and where they end, by the Jacobian."""
    i = nodes.segments[some]
    low, high = i[0] - 1, i[-1] + 1
    piece, begin, end = nodes.piece[i], nodes.begin[some], nodes.s[i]
    outside = None if flange.guide is None else flange.guide.outside
    arm = kinematics if outside is None else outside.assembly.arm
    J = np.ascontiguousarray(arm.jacobian(q[low:high] if outside is None else q[low:high, outside.assembly.own]))
    # most segments begin as the one before ends
    own = np.append(True, (piece[1:] != piece[:-1]) | (begin[1:] != end[:-1]))
    back = flange.velocities(piece, end)
    out = np.empty_like(back)
    out[1:] = back[:-1]
    out[own] = flange.velocities(piece[own], begin[own])
    leaving, arriving = (np.zeros((high - low, out.shape[1])) for _ in range(2))
    whole = high - low == len(i) + 1  # no chain begins between them
    begins, ends = (slice(-1), slice(1, None)) if whole else (i - 1 - low, i - low)
    leaving[begins], arriving[ends] = out, back
    rates = joint_rates(J, leaving, arriving)
    first, last = rates[0][begins], rates[1][ends]
    if outside is None:
        return first, last
    slopes = (outside.slopes(piece, s, flange.pieces.points(piece, s)[1]) for s in (begin, end))
    return outside.assembly.together(first, next(slopes)), outside.assembly.together(last, next(slopes))


def _wanted_speed(pieces: Pieces) -> Array:
    """What the program asks for on each piece [m/s]; corner arcs take the faster of their two rows."""
    feed = pieces.path.feed
    wanted: Array = np.maximum(feed[pieces.row_first], feed[pieces.row_last])
    return np.where(pieces.kind == OVERLAP, pieces.speed, wanted)
