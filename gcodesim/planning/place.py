"""Where a part may stand so that an arm can run its whole program, and how much room to joint limits that leaves."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import product
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import applied, dot, norm
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.planning.arm_joints import ArmJoints
from gcodesim.planning.configuration import grid
from gcodesim.planning.external_choice import OutsideCut
from gcodesim.planning.fixed_attitude import FixedAttitude
from gcodesim.planning.joint_rows import JointRows
from gcodesim.planning.ladder import Passage, rungs_of
from gcodesim.planning.ladder_kernels import link, widest
from gcodesim.planning.legs import LegJoints
from gcodesim.planning.nodes import Nodes
from gcodesim.planning.route import cut_through
from gcodesim.planning.spin_choice import SampledPath

if TYPE_CHECKING:
    from gcodesim.kinematics.protocol import Kinematics
    from gcodesim.planning.plan import Plan

_RUNGS: Final = 120  # of all ladders together
_SPINS: Final = 36
_FIRST_LOOK: Final = 12  # poses that are looked at before a ladder is built
_CELLS: Final = 22  # of a region, from the base to its border
_ROUND: Final = 0.01  # [m] of which the size of a cell is a multiple
NOWHERE: Final = -1.0
"""The margin of a place where the program cannot be run."""


@frozen(kw_only=False, eq=False)
class Spot:
    """A `shift` (3,) [m] in axes of the world, and the least distance [rad] of a joint from its limits there."""

    shift: Array
    margin: float

    @property
    def good(self) -> bool:
        """Whether the program can be run there."""
        return self.margin >= 0.0


def paths_of(plan: Plan) -> list[ArmJoints]:
    """The joints of each leg."""
    legs = plan.joint_path.legs if isinstance(plan.joint_path, LegJoints) else (plan,)
    return [leg.joint_path for leg in legs if isinstance(leg.joint_path, ArmJoints)]


def arm_of(plan: Plan) -> Kinematics:
    """What finds the joints of an arm on the cuts of its plan."""
    return next((path.kinematics for path in paths_of(plan)), plan.kinematics)


def cuts_of(plan: Plan, posing: FixedAttitude) -> list[Passage]:
    """What an arm has to run without a jump, one cut for each stretch between joint moves, and what stands around."""
    paths = paths_of(plan)
    total = sum(len(path.nodes) for path in paths)
    cuts = []
    for path in paths:
        free = posing.spin is None and not path.flange.loose
        flange = path.flange.unturned() if free else path.flange
        nodes, length = path.nodes, flange.pieces.length
        # joint moves have got their times since nodes were placed at their ends
        nodes = Nodes(nodes.piece, np.where(nodes.head, length[nodes.piece], nodes.s), nodes.head)
        cuts += [
            cut_through(path.kinematics, flange, nodes, chain, _RUNGS * (b - a) // total, free, posing.obstacles)[1]
            for chain, (a, b) in enumerate(nodes.chains)
        ]
    return cuts


def outside_cuts_of(plan: Plan, posing: FixedAttitude) -> list[OutsideCut]:
    """The same of an arm with external axes."""
    cuts = []
    for path in paths_of(plan):
        pieces, guide = path.flange.pieces, path.flange.guide
        assert guide is not None
        joint = np.zeros(len(pieces.path), dtype=bool)
        joint[pieces.row_first[pieces.fixed]] = True
        at_home = pieces.fixed.copy()
        at_home[path.nodes.piece[path.nodes.head]] = False
        home = np.zeros(len(joint), dtype=bool)
        home[pieces.row_first[at_home]] = True
        rows = JointRows(pieces.path, joint, home)
        work = SampledPath.of(rows, path.flange.R_BO, replace(guide, outside=None), path.flange.bend)
        cuts += OutsideCut.of(
            pieces.path, work, guide, spin=posing.spin, branches=posing.branches, obstacles=posing.obstacles
        )
    return cuts


def margin_outside(cuts: list[OutsideCut], shift: Array) -> float:
    """The most room [rad] to joint limits with all cuts shifted by (3,) [m] in B; `NOWHERE` without a way."""
    least = np.inf
    for cut in cuts:
        margin = cut.margin(shift)
        if margin < 0.0:
            return NOWHERE
        least = min(least, margin)
    return float(least)


def margin_at(kinematics: Kinematics, cuts: list[Passage], shift: Array, branches: tuple[int, ...] | None) -> float:
    """The most room [rad] to joint limits with all cuts shifted by (3,) [m] in B; `NOWHERE` without a way."""
    for cut in cuts:
        few = cut.without_obstacles().shifted(shift)
        few = few.taken(slice(None, None, max(len(cut) // _FIRST_LOOK, 1)))
        if not rungs_of(kinematics, few, grid(few, _SPINS), branches).counts.all():
            return NOWHERE
    least = np.inf
    for cut in [cut.shifted(shift) for cut in cuts]:
        rungs = rungs_of(kinematics, cut, grid(cut, _SPINS), branches)
        if not rungs.counts.all():
            return NOWHERE
        margin = widest(rungs.ladder, link(rungs.ladder, cut.step, False))
        if margin < 0.0:
            return NOWHERE
        least = min(least, margin)
    return float(least)


def places(margin: Callable[[Array], float], R_BW: Array, within: Array, step: float) -> list[Spot]:
    """All places on a grid of `step` [m] whose shifts are `within` (3,) [m] of the present one, the nearest first.

    `margin` [rad] is that of a shift (3,) [m] in B.
    """
    counts = [int(np.floor(w / step + 1e-9)) for w in within]
    shifts = [step * np.array(c, dtype=float) for c in product(*(range(-n, n + 1) for n in counts))]
    shifts.sort(key=lambda shift: (dot(shift, shift), *(-shift)))
    return [Spot(shift, margin(applied(R_BW, shift))) for shift in shifts]


def best_place(found: list[Spot], step: float) -> Spot | None:
    """The place with the most room to limits, there and one step away in each axis; the nearest among equals.

    So that the part may stand a little off it. Where no place is good with all of its neighbours, the best alone.
    """
    margins = {_key(place.shift, step): place.margin for place in found}

    def around(place: Spot) -> float:
        x, y, z = _key(place.shift, step)
        beside = ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))
        return min(place.margin, *(margins.get((x + a, y + b, z + c), place.margin) for a, b, c in beside))

    good = [place for place in found if place.good]
    if not good:
        return None
    return max(good, key=lambda place: (round(around(place), 6), round(place.margin, 6)))


def _key(shift: Array, step: float) -> tuple[int, int, int]:
    x, y, z = np.rint(shift / step).astype(int).tolist()
    return x, y, z


@frozen(eq=False)
class Region:
    """Cells of size `cell` [m] around points, in axes of the world, that the tip can reach in one attitude: `inside`.

    The first cell has its lower corner at `corner` (3,) [m].
    """

    corner: Array
    cell: float
    inside: NDArray[np.bool_]


def region_of(
    kinematics: Kinematics, cuts: list[Passage], R_BW: Array, p_WB: Array, branches: tuple[int, ...] | None
) -> Region:
    """Where in the world the tip can be in the attitude in which the program begins, with some spin if that is free."""
    first = cuts[0]
    reach = _reach(kinematics) + norm(first.X_FT[:3, 3])
    cell = float(np.ceil(reach / _CELLS / _ROUND) * _ROUND)
    axis = cell * np.arange(-_CELLS, _CELLS + 1)
    layers = []
    for x in axis:  # a layer at a time, because all poses together take much memory
        y, z = np.meshgrid(axis, axis, indexing="ij")
        points = np.stack([np.full_like(y, x), y, z], axis=-1).reshape(-1, 3)
        X_BT = np.tile(first.X_BT[0], (len(points), 1, 1))
        X_BT[:, :3, 3] = applied(R_BW, points)
        cut = Passage(X_BT=X_BT, X_FT=first.X_FT, free=first.free, step=first.step)  # collisions are not asked
        layers.append(rungs_of(kinematics, cut, grid(cut, _SPINS // 3), branches).counts.reshape(y.shape) > 0)
    inside = np.array(layers)
    if not inside.any():
        return Region(corner=p_WB + axis[0] - 0.5 * cell, cell=cell, inside=inside)
    used = np.argwhere(inside)
    low, high = used.min(axis=0), used.max(axis=0) + 1
    inside = np.ascontiguousarray(inside[low[0] : high[0], low[1] : high[1], low[2] : high[2]])
    return Region(corner=p_WB + axis[low] - 0.5 * cell, cell=cell, inside=inside)


def _reach(kinematics: Kinematics) -> float:
    """A length [m] that the flange is never farther than from the base."""
    chain = kinematics.chain
    return float(sum(norm(joint.X[:3, 3]) for joint in chain.joints))
