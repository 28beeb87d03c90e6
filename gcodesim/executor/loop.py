"""The run: windows of steps, one after another, each planned, moved, processed and recorded."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Final

import numpy as np

from gcodesim.diagnostics import Diagnostic
from gcodesim.executor.ahead import CutThread, WindowCut
from gcodesim.executor.behind import Behind
from gcodesim.executor.made_by import passes_of
from gcodesim.executor.record import StepRecord
from gcodesim.executor.track import (
    Execution,
    Inspect,
    Part,
    Progress,
    Track,
    Watcher,
    add_volumes,
    attach,
    windows,
)
from gcodesim.shop import Shop
from gcodesim.world import WorldSteps

if TYPE_CHECKING:
    from gcodesim.planning import Plan
    from gcodesim.world import World

MOST_STEPS: Final = 2000
"""Steps of one window: enough to spread the cost of a window, few enough to stay small in memory."""


def execute(
    plan: Plan,
    shop: Shop,
    *,
    world_name: str,
    dt_ns: int,
    inspect: Inspect | None = None,
    watcher: Watcher | None = None,
    progress: Callable[[Progress], None] | None = None,
    onward: Callable[[], Plan | None] | None = None,
) -> Execution:
    """Run the whole plan in a world; stock changes in place.

    At the end of a plan, `onward` may say how the program goes on: with the plan of all
    legs so far and the next one, which begins with a whole step.

    KeyboardInterrupt ends the run after the windows in progress; what was done until
    then is in the result. It is passed on to the caller when nothing was done. Raises
    `WorldUnavailable` when the world cannot be opened here.
    """
    part = Part(plan=plan, shop=shop, inspect=inspect, watcher=watcher)
    return execute_together([part], world_name=world_name, dt_ns=dt_ns, progress=progress, onward=onward)


def execute_together(
    parts: Sequence[Part],
    *,
    world_name: str,
    dt_ns: int,
    progress: Callable[[Progress], None] | None = None,
    onward: Callable[[], Plan | None] | None = None,
) -> Execution:
    """Run the plans of several channels at once, all until the last of them ends; the first one looks at the stocks.

    Everything else is as in `execute`. Cuts go by steps, then in the order of the parts, so no number depends on which
    thread is faster. `onward` is for a run of one part. The result is that of the first part and has the others.
    """
    passes = passes_of(parts[0].shop)
    tracks = [Track(part, world_name, dt_ns, passes, number) for number, part in enumerate(parts)]
    first_track = tracks[0]
    watcher = first_track.watcher
    most = MOST_STEPS if watcher is None else max(1, min(MOST_STEPS, watcher.interval_steps))
    planned, interrupted = 0, False
    cutter = CutThread(None if watcher is None else watcher.look, undoable=any(track.world.may_lag for track in tracks))
    behind = Behind()
    in_hand: list[tuple[Track, WindowCut]] = []
    try:
        for track in tracks:
            track.begin()
        follows, leg = True, True
        while leg:
            first, planned = planned, max(track.steps for track in tracks)
            stops = () if watcher is None else watcher.stops([track.plan for track in tracks], first, planned)
            cuts = windows(tracks, sorted({*range(first, planned, most), *stops, planned}))
            now = next(cuts, None)
            taken: list[tuple[Track, StepRecord, Sequence[Diagnostic]]] = []
            while now is not None:
                track, cut = now
                if track.world.keeps_to_command:
                    cutter.begin(cut)
                following = next(cuts, None)
                in_hand = [now] if following is None else [now, following]
                cutter.wait(cut)
                if following is not None and follows and following[0].world.keeps_to_command:
                    cutter.begin(following[1])
                ahead = None if following is None else following[1]
                steps, follows = _move(track.world, track.shop, cutter, cut, ahead)
                record = track.take(cut, steps)
                del in_hand[0]
                taken.append((track, record, track.found(record)))
                if cut.looks:
                    for each, its, found in taken:
                        if each.watcher is not None:
                            behind.do(each.watcher.take(its, found, cut.seen if each is first_track else ()))
                    taken = []
                now = following
                if progress is not None:
                    row = first_track.last_row
                    progress(Progress(step=track.done, steps=planned, time=track.done * dt_ns * 1e-9, row=row))
            plan = onward() if onward is not None else None
            leg = plan is not None
            if plan is not None:
                if watcher is not None:
                    behind.do(partial(watcher.follow, plan))
                first_track.follow(plan)
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
        add_volumes(track.volumes, cut.stints)
    own, *others = (track.execution(planned, interrupted=interrupted) for track in tracks)
    return replace(own, others=others)


def _move(
    world: World, shop: Shop, cutter: CutThread, cut: WindowCut, following: WindowCut | None
) -> tuple[WorldSteps, bool]:
    """Move through a window, tool by tool; also returns whether the motors kept up.

    Where they do, the cut is known already; otherwise it is undone, and world and process go step by step.
    """
    moved: list[WorldSteps] = []
    follows = True
    for index, stretch in enumerate(cut.stretches):
        attach(world, shop, int(cut.window.tool[stretch.begin]))
        q = cut.window.q[stretch.begin : stretch.end]
        if not world.keeps_to_command:
            follows = False
            moved.append(world.run(q, stretch if stretch.pushes else None))
            stretch.finish()
            cut.wrenches.append(np.zeros(0))
        elif not stretch.pushes:
            moved.append(world.run(q))
        elif world.keeps_up(q, cut.wrenches[index]):
            moved.append(world.run(q, cut.wrenches[index]))
        else:
            follows = False
            if following is not None:
                cutter.take_back(following)
            cutter.take_back(cut, first=index)
            moved.append(world.run(q, stretch))
            stretch.finish()
            cut.wrenches.append(np.zeros(0))
            cutter.cut(cut)
    if not world.keeps_to_command:
        cutter.see(cut)
    return moved[0] if len(moved) == 1 else _joined(moved), follows


def _joined(parts: list[WorldSteps]) -> WorldSteps:
    names = ["q", "qd", "qdd", "effort", "saturated", "reaction"]
    if parts[0].gear is not None:
        names.append("gear")
    return WorldSteps(**{name: np.concatenate([getattr(part, name) for part in parts]) for name in names})
