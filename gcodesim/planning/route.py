"""Joints for a whole path by the search over all configurations, where the simple choice finds no way.

Each chain of nodes between two joint moves is a cut of its own. Some of the nodes become the rungs of a ladder; what
the search finds there says how the tool turns along the path and where the joints begin, and the nodes between follow.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.distinct import distinct
from gcodesim.arithmetic.matrices import inverse_pose, multiplied
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.kinematics.path_kernels import JUMP
from gcodesim.planning.configuration import Hindrance, even_way, grid, hindrance, way_with
from gcodesim.planning.ladder import Passage, Rungs, rungs_of
from gcodesim.planning.ladder_kernels import TURN, earliest, link
from gcodesim.planning.nodes import Nodes
from gcodesim.planning.obstacles import Around, Obstacles
from gcodesim.planning.spin_along import SpinAlong

if TYPE_CHECKING:
    from gcodesim.kinematics.protocol import Kinematics
    from gcodesim.planning.flange import Flange

TRIALS: Final = ((300, 36), (300, 144), (1200, 36))
"""Rungs of all ladders of a path together and spins all around, tried one after the other."""

_FEWEST: Final = 12  # rungs of one ladder
_ROOM: Final = 0.25  # [rad] from limits beyond which more is no better
_SMOOTHING: Final = 6  # times that each spin is averaged with its neighbours: the grid of spins leaves steps


@frozen(kw_only=False, eq=False)
class Route:
    """How the tool turns along the path (None: it does not), and the joints (j,) with which each chain of nodes begins.

    `chains` counts the chains that have a way, one after the other; the route is complete if all have.
    """

    turning: SpinAlong | None
    seeds: dict[int, Array]
    chains: int


@frozen(kw_only=False, eq=False)
class DeadEnd:
    """Where no route leads on: of its nodes, `first` to `last` are the longest part of a chain that can be run.

    `obstacle` says why the one at node `next_node` cannot be added, coming from joints `q` (j,) (None: there are none),
    and `hits` what would hit what there.
    """

    nodes: Nodes
    chain: tuple[int, int]
    first: int
    last: int
    next_node: int
    obstacle: Hindrance
    q: Array | None
    hits: tuple[str, str] | None = None


def route_along(
    kinematics: Kinematics,
    flange: Flange,
    nodes: Nodes,
    home: Array,
    trial: tuple[int, int],
    *,
    free: bool,
    branches: tuple[int, ...] | None,
    obstacles: Obstacles | None,
) -> Route:
    """The route along all `nodes`, by one of the `TRIALS`; `flange` has the spin from which a free tool turns."""
    pieces, places, spins = [], [], []
    seeds: dict[int, Array] = {}
    previous = home
    for k in range(len(nodes.chains)):
        a, b = nodes.chains[k]
        chosen, cut = cut_through(kinematics, flange, nodes, k, trial[0] * (b - a) // len(nodes), free, obstacles)
        way = even_way(kinematics, cut, margin=_ROOM, start=previous, spins=trial[1], branches=branches)
        if way is None:
            return Route(None, seeds, k)
        seeds[k], previous = way.q[0], way.q[-1]
        pieces.append(nodes.piece[chosen])
        places.append(nodes.s[chosen])
        spins.append(_smooth(way.spins))
    if not (free and spins):
        return Route(None, seeds, len(nodes.chains))
    soft = bool(np.isfinite(kinematics.joints.jerk).any())
    turning = SpinAlong.through(flange.pieces, pieces, places, spins, soft=soft)
    return Route(turning, seeds, len(nodes.chains))


def _evenly(nodes: Nodes, first: int, end: int, most: int) -> NDArray[np.int64]:
    """At most so many nodes from `first` to the one before `end`, both among them, as even by the way as they lie.

    Of nodes that lie close together, as beside a blended corner, one is taken: a spline through all would ring.
    """
    way = nodes.way(first, end)
    wanted = np.linspace(0.0, way[-1], min(most, end - first))
    after = np.clip(np.searchsorted(way, wanted), 1, max(len(way) - 1, 1))
    after = np.minimum(after, len(way) - 1)
    before = np.maximum(after - 1, 0)
    nearest = np.where(wanted - way[before] < way[after] - wanted, before, after)
    nearest[0], nearest[-1] = 0, len(way) - 1
    return first + distinct(nearest)


def cut_through(
    kinematics: Kinematics,
    flange: Flange,
    nodes: Nodes,
    chain: int,
    rungs: int,
    free: bool,
    obstacles: Obstacles | None = None,
) -> tuple[NDArray[np.int64], Passage]:
    """The nodes of a chain that become so many rungs, or the fewest of a ladder, and the cut through them."""
    a, b = nodes.chains[chain]
    chosen = _evenly(nodes, a, b, max(_FEWEST, rungs))
    piece, s = nodes.piece[chosen], nodes.s[chosen]
    X, X_FN = flange.at(piece, s), np.eye(4)
    bend = flange.bend_of(piece)
    if bend is not None:  # the tool turns about the Z of its nose, and all of a chain has one
        X_FN = inverse_pose(bend[:1])[0]
        X = multiplied(X, X_FN)
    step = np.full(len(kinematics.joints), JUMP)
    return chosen, Passage(X_BT=X, X_FT=X_FN, free=free, step=step, around=Around.at(obstacles, flange, piece, s))


def _smooth(spins: Array) -> Array:
    """Spins (k,) [rad] that go on from one to the next, averaged with their neighbours; the ends stay."""
    spins = np.concatenate([spins[:1], spins[0] + np.cumsum(_shorter(np.diff(spins)))])
    for _ in range(_SMOOTHING):
        spins[1:-1] = 0.25 * spins[:-2] + 0.5 * spins[1:-1] + 0.25 * spins[2:]
    return spins


def _shorter(steps: Array) -> Array:
    """The same turns [rad] the shorter way round."""
    shorter: Array = steps - TURN * np.floor(0.5 + steps / TURN)
    return shorter


class _LongestPart(NamedTuple):
    """What a search over the `chosen` of some `nodes` finds of a chain: the cut through them, all of its rungs.

    `run` is what `earliest` says of these: how far from the start, and the first and last pose of the longest part.
    """

    nodes: Nodes
    chosen: NDArray[np.int64]
    cut: Passage
    rungs: Rungs
    run: tuple[int, int, int]

    @staticmethod
    def on(
        kinematics: Kinematics,
        flange: Flange,
        nodes: Nodes,
        chain: int,
        *,
        free: bool,
        branches: tuple[int, ...] | None,
        obstacles: Obstacles | None,
    ) -> _LongestPart:
        """By the first of the `TRIALS`."""
        count, spins = TRIALS[0]
        chosen, cut = cut_through(kinematics, flange, nodes, chain, count, free, obstacles)
        rungs = rungs_of(kinematics, cut, grid(cut, spins), branches)
        return _LongestPart(nodes, chosen, cut, rungs, earliest(rungs.ladder, link(rungs.ladder, cut.step, False)))

    @property
    def whole(self) -> bool:
        """Whether the rungs can be run from the first to the last."""
        return self.run[2] - self.run[1] + 1 == len(self.cut)


def dead_end(
    kinematics: Kinematics,
    flange: Flange,
    nodes: Nodes,
    chain: int,
    *,
    free: bool,
    branches: tuple[int, ...] | None,
    obstacles: Obstacles | None,
) -> DeadEnd:
    """How far the `chain` of nodes can be run that ends a route, a round tool in an obstacle being an end, too.

    Nodes may be far apart; so there are more, unless these have a way where the route has none.
    """
    if obstacles is not None:
        obstacles = obstacles.with_round_tools()
    dense = nodes.denser(chain, TRIALS[0][0])
    look = partial(_LongestPart.on, kinematics, flange, chain=chain, free=free, branches=branches, obstacles=obstacles)
    looked = look(nodes=dense)
    if looked.whole:
        looked = look(nodes=nodes)
    places, chosen, cut, ladder, (prefix, first, last) = looked
    if looked.whole:  # rungs have a way, the nodes between do not
        end = int(chosen[-1])
        return DeadEnd(places, places.chains[chain], int(chosen[0]), end, end, Hindrance.WAY, None)
    spins = TRIALS[0][1]
    after = last + 1 if last + 1 < len(cut) else first - 1
    q = None
    if last >= first:
        part = cut.part(first, last + 1)
        some = rungs_of(kinematics, part, grid(part, spins), branches)
        way = way_with(some, link(some.ladder, part.step, False), 0.0)
        q = way.q[-1] if after > last else way.q[0]
    why = hindrance(kinematics, cut, ladder, after, (prefix, first, last), spins=spins, branches=branches)
    return DeadEnd(
        places,
        places.chains[chain],
        int(chosen[first]),
        int(chosen[max(last, first)]),
        int(chosen[after]),
        why,
        q,
        _first_hit(kinematics, cut, after, q, spins, branches) if why is Hindrance.COLLISION else None,
    )


def _first_hit(
    kinematics: Kinematics, cut: Passage, pose: int, q: Array | None, spins: int, branches: tuple[int, ...] | None
) -> tuple[str, str] | None:
    """What hits what at a pose of a cut with those joints that come nearest to q (j,), or with the first ones."""
    one = cut.part(pose, pose + 1).without_obstacles()
    found = rungs_of(kinematics, one, grid(one, spins), branches).ladder.q
    if cut.around is None or not len(found):
        return None
    if q is not None:
        away = found - q
        away -= TURN * np.floor(0.5 + away / TURN)
        found = found[np.argsort(np.sum(away * away, axis=1), kind="stable")]
    return next((pair for each in found if (pair := cut.around.pair(each, pose)) is not None), None)
