"""The run: windows of steps, one after another, each planned, moved, processed and recorded."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Final

from gcodesim.executor.ahead import CutThread, WindowCut
from gcodesim.executor.behind import Behind
from gcodesim.executor.execution import Execution, Progress
from gcodesim.executor.halt import RunHalt
from gcodesim.executor.made_by import passes_of
from gcodesim.executor.pacing import Pacing
from gcodesim.executor.part_run import PartRun
from gcodesim.executor.record import StepRecord
from gcodesim.executor.stock_change import add_changes
from gcodesim.executor.track import Inspect, Track, TrackPlan
from gcodesim.executor.watcher import Watcher
from gcodesim.executor.weave import Weave
from gcodesim.executor.window_motion import move_through
from gcodesim.executor.window_order import Windows
from gcodesim.shop import Shop
from gcodesim.tools.gripper import Gripper

if TYPE_CHECKING:
    from gcodesim.executor.loose_bodies import LooseBodies
    from gcodesim.planning import Plan

Onward = Callable[[RunHalt], "Sequence[Plan] | None"]
"""The plans of all channels with their next legs, from where the run stands; None: there are no further ones."""

MANY_TICKS: Final = 1 << 31
"""More than a run has: nobody wants to look at the stocks before a window is full."""


def execute(
    plan: Plan,
    shop: Shop,
    *,
    world_name: str,
    dt_ns: int,
    pacing: Pacing | None = None,
    inspect: Inspect | None = None,
    watcher: Watcher | None = None,
    progress: Callable[[Progress], None] | None = None,
    onward: Onward | None = None,
) -> Execution:
    """Run the whole plan in a world; stock changes in place. `pacing` says what its steps are: else ticks of `dt_ns`.

    At the end of a plan, `onward` may say how the program goes on: with the plan of all
    legs so far and the next one, which begins with a whole step, as the only one. It is told where the run stands.

    KeyboardInterrupt ends the run after the windows in progress; what was done until
    then is in the result. It is passed on to the caller when nothing was done. Raises
    `WorldUnavailable` when the world cannot be opened here.
    """
    brought = TrackPlan(plan=plan, shop=shop, inspect=inspect, watcher=watcher)
    pacing = pacing or Pacing(dt_ns=dt_ns)
    return execute_together([brought], world_name=world_name, pacing=pacing, progress=progress, onward=onward)


def execute_together(
    channels: Sequence[TrackPlan],
    *,
    world_name: str,
    pacing: Pacing,
    progress: Callable[[Progress], None] | None = None,
    onward: Onward | None = None,
) -> Execution:
    """Run the plans of several channels at once, all until the last of them ends; the first one looks at the stocks.

    Everything else is as in `execute`. Cuts go by steps, then in the order of the channels, so no number depends on
    which thread is faster. `onward` gives the plans of all channels, whose next legs begin together. The result is that
    of the first channel and has the others.
    """
    passes = passes_of(channels[0].shop)
    dt_ns = pacing.dt_ns
    things = _parts_of(channels, world_name, dt_ns)
    loose = _loose_of(channels, world_name, dt_ns)
    tracks = [
        Track(brought, world_name, pacing, passes, number, things, loose) for number, brought in enumerate(channels)
    ]
    first_track = tracks[0]
    watcher = first_track.watcher
    most = MANY_TICKS if watcher is None else max(1, watcher.interval_steps)
    planned, interrupted = 0, False
    cutter = CutThread(None if watcher is None else watcher.look, undoable=any(track.world.may_lag for track in tracks))
    behind = Behind()
    in_hand: list[tuple[Track, WindowCut]] = []
    try:
        for track in tracks:
            track.begin()
        follows, leg, record = True, True, None
        while leg:
            first, planned = planned, max(track.steps for track in tracks)
            stops = () if watcher is None else watcher.stops([track.plan for track in tracks], first, planned)
            steps = pacing.windows(first_track.plan, first_track.rows.rapid, first, planned, most, stops)
            cuts = Windows(tracks, first, steps)
            now = next(cuts, None)
            taken: Taken = []
            while now is not None:
                track, cut = now
                if track.world.keeps_to_command:
                    cutter.begin(cut)
                following = next(cuts, None)
                in_hand = _in_hand(tracks, now, following)
                cutter.wait(cut)
                if cut.weave is not None and cut is cut.weave.cuts[0] and not _holds(tracks, cut.weave):
                    cutter.take_back(cut)
                    cuts.divide()
                    in_hand, now = [], next(cuts)
                    continue
                if following is not None and follows and following[0].world.keeps_to_command:
                    cutter.begin(following[1])
                ahead = None if following is None else following[1]
                done, follows = move_through(track, cutter, cut, ahead)
                record = track.take(cut, done)
                in_hand = [each for each in in_hand if each[1] is not cut]
                taken.append((track, record))
                if cut.looks:
                    if things is not None and things.things:
                        taken = _with_parts(things, taken)
                    taken = _with_others(taken)
                    for each, its in taken:
                        found = each.found(its)
                        if each.watcher is not None:
                            behind.do(each.watcher.take(its, found, cut.seen if each is first_track else ()))
                    taken = []
                now = following
                if progress is not None:
                    row = first_track.last_row
                    progress(Progress(step=track.done, steps=planned, time=track.done * dt_ns * 1e-9, row=row))
            plans = onward(_halt(first_track, things, record)) if onward is not None else None
            leg = plans is not None
            for track, plan in zip(tracks, plans or (), strict=leg):
                if track.watcher is not None:
                    behind.do(partial(track.watcher.follow, plan))
                track.follow(plan)
    except KeyboardInterrupt:
        if not first_track.done:  # there is nothing yet that could be told
            raise
        interrupted = True
    finally:
        for track in tracks:
            track.world.close()
        cutter.close()
        behind.close()
    for track, cut in in_hand:  # what an interrupted run has cut ahead of its motion
        add_changes(track.changes, cut.stints)
    for track in tracks:
        if not interrupted:
            track.let_go_at_end()
    own, *others = (track.execution(planned, interrupted=interrupted) for track in tracks)
    ends, stays = {}, []
    if things is not None and things.names:
        stays = things.stays()
        last = {track.shop.name: track.stands_at[None] for track in tracks}
        ends = things.ends(first_track.done - 1, last)
    return replace(own, others=others, parts=ends, stays=stays, loose=() if loose is None else tuple(loose.bodies))


def _in_hand(
    tracks: Sequence[Track], now: tuple[Track, WindowCut], following: tuple[Track, WindowCut] | None
) -> list[tuple[Track, WindowCut]]:
    """What may be cut before it is taken over: this window and the next, with those that are cut together with it."""
    if following is None:
        return [now]
    weave = following[1].weave
    if weave is None:
        return [now, following]
    together = list(zip(tracks, weave.cuts, strict=True))
    return [now, *(each for each in together[weave.cuts.index(following[1]) :])]


def _holds(tracks: Sequence[Track], weave: Weave) -> bool:
    """Whether what was cut together is what the machines will do; nothing of it has been moved yet."""
    if not weave.is_cut:
        return False
    for track, cut in zip(tracks, weave.cuts, strict=True):
        stretch = cut.stretches[0]
        if stretch.pushes:
            track.attach(stretch.tool)
            if not track.world.keeps_up(cut.window.q, cut.wrenches[0]):
                return False
    return True


def _halt(track: Track, things: PartRun | None, record: StepRecord | None) -> RunHalt:
    """Where a run stands whose last window is `record`."""
    joints = {track.shop.name: track.stands_at}
    if record is None:
        return RunHalt(joints=joints, tool=int(track.rows.tool[0]), opening=1.0, moving={})
    number = int(record.window.tool[-1])
    tool = track.shop.tool(number)
    return RunHalt(
        joints=joints,
        tool=number,
        opening=record.opening(-1, tool.widest) if isinstance(tool, Gripper) else 1.0,
        moving={} if things is None else things.going_on(track.done - 1, joints),
    )


def _parts_of(channels: Sequence[TrackPlan], world_name: str, dt_ns: int) -> PartRun | None:
    """The parts of the cell; None where nothing would move one."""
    shop = channels[0].shop
    return PartRun(shop, world_name, dt_ns * 1e-9) if shop.moves_parts else None


def _loose_of(channels: Sequence[TrackPlan], world_name: str, dt_ns: int) -> LooseBodies | None:
    """What becomes of pieces that come loose; None where nothing but the machines is moved by an engine."""
    shop = channels[0].shop
    if world_name == "kinematic" or all(placed.revolved for placed in shop.stocks.values()):
        return None
    from gcodesim.executor.loose_bodies import LooseBodies

    return LooseBodies(shop, world_name, dt_ns * 1e-9)


Taken = list[tuple[Track, StepRecord]]


def _with_others(taken: Taken) -> Taken:
    """The records of all channels in the same steps, the first with those of the others."""
    (track, record), *others = taken
    return [(track, replace(record, beside={each.shop.name: its for each, its in others})), *others]


def _with_parts(parts: PartRun, taken: Taken) -> Taken:
    """The records of all channels in the same steps, the first with the places of the parts."""
    track, record = taken[0]
    q = {each.shop.name: its.world.q for each, its in taken}
    poses = parts.poses(record.window.first, q)
    parts.ran.forget(record.window.end)
    return [(track, replace(record, parts=poses, things=parts.things)), *taken[1:]]
