"""What an arm cannot reach, or only slowly: findings with place in the program, reason and remedy."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING, Final, Protocol

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.distinct import distinct
from gcodesim.diagnostics import Diagnostic
from gcodesim.frames import Array
from gcodesim.kinematics.pointing import ALL_SIDES
from gcodesim.kinematics.protocol import Status
from gcodesim.motion.pieces import Pieces
from gcodesim.planning.loads import PLANNED
from gcodesim.planning.moments import OnPiece, PathFindings
from gcodesim.planning.nodes import Nodes
from gcodesim.planning.spin_choice import SampledPath, SpinChoice
from gcodesim.units import DEG, MM, MM_PER_MINUTE

if TYPE_CHECKING:
    from gcodesim.kinematics.chain import Joints
    from gcodesim.kinematics.protocol import Kinematics, Reason
    from gcodesim.planning.loads import Slowing
    from gcodesim.planning.route_findings import ToldEnd

# status of the inverse kinematics -> code
_CODES: Final = {1: "GS202", 2: "GS203", 4: "GS205"}
_SLOW: Final = 0.5  # of the feed: below, the arm is near a singularity
_WORTH_A_NOTE: Final = 0.99
_BISECTIONS: Final = 30
_FARTHEST: Final = 32  # nodes of a block at which is looked how far beyond a limit it goes
# shifts of the part that are tried [m]
_SHIFTS: Final = (0.025, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.6, 0.8)


class FlangePoses(Protocol):
    """Where the flange has to be."""

    @property
    def pieces(self) -> Pieces: ...

    def at(self, piece: NDArray[np.int64], s: Array) -> Array:
        """X_BF (k, 4, 4) at places `s` (k,) of `piece` (k,)."""
        ...

    def bend_of(self, piece: NDArray[np.int64]) -> Array | None:
        """X_NF (k, 4, 4) of bent tools on `piece` (k,)."""
        ...


def report_poses(
    kinematics: Kinematics,
    flange: FlangePoses,
    nodes: Nodes,
    q: Array,
    status: NDArray[np.uint8],
    probe: SampledPath,
    choice: SpinChoice,
    home: Array,
    told: ToldEnd,
    findings: PathFindings,
) -> None:
    """One finding for each kind of pose out of reach: where, why, how many blocks, and which shift would help.

    `told` is what a search over all configurations has said already.
    """
    shift: str | None = None
    part, (begin, end) = told.part, told.pieces
    blamed = (nodes.piece >= begin) & (nodes.piece < end)
    for value, code in _CODES.items():
        bad = (status == value) & ~(blamed & (value != Status.REACH))
        if not bad.any():
            continue
        if shift is None:
            shift = _shift_that_fits(kinematics, probe, choice, home)
        first = int(np.argmax(bad))
        s, previous = _where_it_begins(kinematics, flange, nodes, q, first, value, home)
        reason = _farthest(kinematics, flange, nodes, q, bad, value, previous)
        pieces = flange.pieces
        piece = int(nodes.piece[first])
        row, share = int(pieces.row_last[piece]), _share_of(pieces, piece, s)
        blocks = _blocks(pieces, nodes.piece[bad])
        further = f", and {blocks - 1} further block{'s' if blocks > 2 else ''}" if blocks > 1 else ""
        findings.add(
            Diagnostic(
                code=code,
                message=f"{why(kinematics, reason)}, from {100.0 * share:.0f} % of the block on{further}",
                span=pieces.path.span(row),
                hint=f"{part}; {shift}" if part else shift,
                count=blocks,
                value=None if reason.what is None else reason.value,
                limit=None if reason.what is None else reason.limit,
                unit=None if reason.what is None else reason.unit,
            ),
            at=OnPiece(piece, s),
        )


def why(kinematics: Kinematics, reason: Reason) -> str:
    """The facts behind a status in words."""
    unit, factor = ("mm", MM) if reason.unit == "m" else ("deg", DEG)
    value, limit = reason.value / factor, reason.limit / factor
    if reason.what is None:
        return f"out of reach: no position of the joints holds the tool so at this place{_too_few(kinematics.joints)}"
    if reason.status == 1:
        side = "at most" if reason.value > reason.limit else "at least"
        return f"out of reach: {reason.what} would be {value:.1f} {unit}, {side} {limit:.1f} {unit} can be had"
    if reason.status == 2:
        return f"joint limit: {reason.what} would go to {value:.1f} {unit}, its limit is {limit:.1f} {unit}"
    return f"the arm has to flip: {reason.what} by {value:.1f} {unit}"


def _too_few(joints: Joints) -> str:
    """Why joints that are fewer than six do not bring a tool to any attitude."""
    count = len(joints)
    if count >= ALL_SIDES:
        return ""
    if "revolute" not in joints.kinds:
        return "; none of them turns it"
    return f"; {count} joint{'s' if count > 1 else ''} cannot turn it to all sides"


def _where_it_begins(
    kinematics: Kinematics, flange: FlangePoses, nodes: Nodes, q: Array, node: int, value: int, home: Array
) -> tuple[float, Array]:
    """Where on its piece the status `value` of a node begins, and the joints (j,) before that."""
    piece = nodes.piece[node : node + 1]
    if nodes.head[node]:
        return np.inf, q[node - 1] if node else home
    high = float(nodes.s[node])
    low = float(nodes.s[node - 1]) if nodes.piece[node - 1] == piece[0] else 0.0
    previous = q[node - 1]
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        found, status = kinematics.inverse(flange.at(piece, np.array([middle])), previous, on_path=True)
        if status[0] == value:
            high = middle
        else:
            low, previous = middle, found[0]
    return high, previous


def _farthest(
    kinematics: Kinematics,
    flange: FlangePoses,
    nodes: Nodes,
    q: Array,
    bad: NDArray[np.bool_],
    value: int,
    previous: Array,
) -> Reason:
    """The facts behind the status `value` of the first node that is `bad` (k,), coming from joints `previous` (j,).

    The number is the farthest one on the rest of the block: where it begins, it is hardly beyond its limit.
    """
    first = int(np.argmax(bad))
    row = flange.pieces.row_last[nodes.piece]
    goes_on = np.append(bad[first:] & (row[first:] == row[first]), False)
    some = first + distinct(np.linspace(0, int(np.argmin(goes_on)) - 1, _FARTHEST).astype(np.int64))

    def reason(node: int, before: Array) -> Reason:
        X = flange.at(nodes.piece[node : node + 1], nodes.s[node : node + 1])[0]
        return kinematics.reason(X, before, value)

    found = [reason(int(node), previous if node == first else q[node - 1]) for node in some]
    same = [each for each in found if each.what == found[0].what and each.limit == found[0].limit]
    return max(same, key=lambda each: abs(each.value - each.limit))


def _share_of(pieces: Pieces, piece: int, s: float) -> float:
    """How much of its block is done at `s` of a piece."""
    whole = max(float(pieces.curves.length[pieces.curve[piece]]), 1e-300)
    return min((float(pieces.begin[piece]) + s) / whole, 1.0)


def _blocks(pieces: Pieces, piece: NDArray[np.int64]) -> int:
    """How many program blocks the pieces belong to."""
    touched = distinct(piece)
    cover = np.zeros(len(pieces.path) + 1, dtype=np.int64)
    np.add.at(cover, pieces.row_first[touched], 1)
    np.add.at(cover, pieces.row_last[touched] + 1, -1)
    return len(distinct(pieces.path.block[np.cumsum(cover[:-1]) > 0]))


def _shift_that_fits(kinematics: Kinematics, probe: SampledPath, choice: SpinChoice, home: Array) -> str:
    """The smallest of several shifts of the part with which the whole program can be run."""
    ways = [np.array(way, dtype=float) for way in product((-1, 0, 1), repeat=3) if any(way)]
    ways.sort(key=lambda way: (np.abs(way).sum(), *(-way)))
    for size in _SHIFTS:
        for way in ways:
            step = size * way
            if _fits(kinematics, probe, choice, home, step):
                parts = [f"{'XYZ'[k]}{step[k] / MM:+.0f}" for k in range(3) if step[k]]
                return f"with the part shifted by {' '.join(parts)} mm all of the program can be reached"
    return f"no shift of the part up to {_SHIFTS[-1] / MM:.0f} mm was found that would do"


def _fits(kinematics: Kinematics, probe: SampledPath, choice: SpinChoice, home: Array, step: Array) -> bool:
    previous = home
    moved = probe.poses(choice.spin)
    moved[:, :3, 3] += step
    for number, (a, b) in zip(probe.number, probe.chains, strict=True):
        X = moved[a:b]
        q, status = kinematics.inverse(X, choice.seeds.get(number, previous))
        if np.any(status):
            return False
        previous = q[-1]
    return True


def report_slow_joints(
    kinematics: Kinematics,
    pieces: Pieces,
    place: tuple[NDArray[np.int64], Array],
    wanted: Array,
    possible: Array,
    slowest: NDArray[np.int64],
    findings: PathFindings,
) -> None:
    """Report segments on which a joint's top speed keeps the feed down: near singularities, and otherwise.

    A segment begins at a `place`: s (k,) of a piece (k,).
    """
    piece, begin = place
    with np.errstate(invalid="ignore", divide="ignore"):
        share = np.where(np.isfinite(wanted), possible / wanted, 1.0)
    for code, segments in (
        ("GS204", np.flatnonzero(share < _SLOW)),
        ("GS206", np.flatnonzero((share >= _SLOW) & (share < _WORTH_A_NOTE))),
    ):
        if not len(segments):
            continue
        first, worst = int(segments[0]), int(segments[np.argmin(share[segments])])
        j = int(slowest[worst])
        joints = kinematics.joints
        unit, factor = ("deg/s", DEG) if joints.kinds[j] == "revolute" else ("mm/s", MM)
        need = float(joints.speed[j] / factor / share[worst])
        row = int(pieces.row_last[piece[first]])
        where = pieces.path.span(int(pieces.row_last[piece[worst]]))
        findings.add(
            Diagnostic(
                code=code,
                message=f"feed falls to {100.0 * share[worst]:.0f} % of {wanted[worst] / MM_PER_MINUTE:.0f} mm/min:"
                f" {joints.names[j]} would need {need:.0f} {unit} and can do {joints.speed[j] / factor:.0f} {unit}",
                span=pieces.path.span(row),
                hint=f"slowest in line {where.line}" if where.line != pieces.path.span(row).line else "",
                count=_blocks(pieces, piece[segments]),
                value=float(need * factor),
                limit=float(joints.speed[j]),
                unit="rad/s" if joints.kinds[j] == "revolute" else "m/s",
            ),
            at=OnPiece(int(piece[first]), float(begin[first])),
        )


def report_slow_motors(kinematics: Kinematics, pieces: Pieces, slowing: Slowing, findings: PathFindings) -> None:
    """Note once that motions are slower than speeds and accelerations allow, because a motor can give no more (GS231).

    Another note tells where a motor cannot bear what the tool expects, however slow the motion is, and an error where
    it cannot bear the weight alone (GS230).
    """
    _report_overweight(kinematics, pieces, slowing, findings)
    _report_overborne(kinematics, pieces, slowing, findings)
    needed = slowing.at(np.flatnonzero(slowing.joint >= 0))
    if not len(needed.piece):
        return
    worst = int(needed.share.argmin())
    joints, j = kinematics.joints, int(needed.joint[worst])
    unit = "N·m" if joints.kinds[j] == "revolute" else "N"
    begin = needed.first
    at, worst_at = (pieces.path.span(int(pieces.row_last[p])) for p in (begin.piece, int(needed.piece[worst])))
    effort, limit, spare = float(needed.effort[worst]), PLANNED * float(joints.effort[j]), float(needed.reserve[worst])
    besides = f", and {spare:.1f} {unit} of it for friction and the force of the work," if spare > 0.0 else ""
    findings.add(
        Diagnostic(
            code="GS231",
            message=f"accelerates with {100.0 * needed.share[worst]:.0f} %: {joints.names[j]} would need"
            f" {effort:.1f} {unit} for its weight and inertia{besides} and can give {limit:.1f} {unit}"
            f" ({100.0 * PLANNED:g} % of its limit)",
            span=at,
            hint=f"most of all in line {worst_at.line}" if worst_at.line != at.line else "",
            count=_blocks(pieces, needed.piece),
            value=effort,
            limit=limit,
            unit=unit,
        ),
        at=begin,
    )


def _report_overweight(kinematics: Kinematics, pieces: Pieces, slowing: Slowing, findings: PathFindings) -> None:
    """Tell of each joint whose motor cannot bear it at rest."""
    joints, path = kinematics.joints, pieces.path
    for j in np.flatnonzero(slowing.overweight.any(axis=0)).tolist():
        over = slowing.overweight[:, j]
        places = np.flatnonzero(over)
        unit, limit = "N·m" if joints.kinds[j] == "revolute" else "N", float(joints.effort[j])
        worst = int(over.argmax())
        needed, begin = limit + float(over[worst]), slowing.at(places).first
        at, worst_at = (path.span(int(pieces.row_last[p])) for p in (begin.piece, slowing.piece[worst]))
        findings.add(
            Diagnostic(
                code="GS230",
                message=f"{joints.names[j]} cannot bear its weight: it would need {needed:.1f} {unit} at rest, its"
                f" limit is {limit:.1f} {unit}",
                span=at,
                hint="use a lighter tool or payload, stand nearer to the robot, also at `home`, or check `effort` of"
                " the joint" + (f"; most of all in line {worst_at.line}" if worst_at.line != at.line else ""),
                count=_blocks(pieces, slowing.piece[places]),
                value=needed,
                limit=limit,
                unit=unit,
            ),
            at=begin,
        )


def _report_overborne(kinematics: Kinematics, pieces: Pieces, slowing: Slowing, findings: PathFindings) -> None:
    """Note where a motor that bears its joint at rest cannot bear the force that is expected, from its worst side."""
    places = np.flatnonzero(slowing.overborne.any(axis=1))
    if not len(places):
        return
    worst, j = (int(k) for k in np.unravel_index(slowing.overborne.argmax(), slowing.overborne.shape))
    joints, path = kinematics.joints, pieces.path
    unit, limit = "N·m" if joints.kinds[j] == "revolute" else "N", float(joints.effort[j])
    needed = limit + float(slowing.overborne[worst, j])
    begin = slowing.at(places).first
    at, worst_at = (path.span(int(pieces.row_last[p])) for p in (begin.piece, slowing.piece[worst]))
    findings.add(
        Diagnostic(
            code="GS231",
            message=f"no slowness helps: {joints.names[j]} would need {needed:.1f} {unit} for its weight and the force"
            f" that its tool expects, if that comes from the worst side, and can give {limit:.1f} {unit}",
            span=at,
            hint="cut less deep, hold the tool closer to the robot, or check `expected_force` of the tool"
            + (f"; most of all in line {worst_at.line}" if worst_at.line != at.line else ""),
            count=_blocks(pieces, slowing.piece[places]),
            value=needed,
            limit=limit,
            unit=unit,
        ),
        key=("GS231", "overborne"),
        at=begin,
    )
