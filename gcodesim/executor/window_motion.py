"""How a machine goes through one window: behind what is cut already, or together with the cut."""

from __future__ import annotations

from typing import Final

import numpy as np

from gcodesim.executor.ahead import CutThread, WindowCut
from gcodesim.executor.coupling import Stretch
from gcodesim.executor.track import Track
from gcodesim.frames import Array
from gcodesim.world import NotAtOnce, WorldSteps

NOTHING: Final[Array] = np.zeros(0)
"""In place of what a stretch pushes with, which the world has felt already."""


def move_through(
    track: Track, cutter: CutThread, cut: WindowCut, following: WindowCut | None
) -> tuple[WorldSteps, bool]:
    """Move through a window, tool by tool; also returns whether the next window may be cut before it is moved."""
    if track.world.keeps_to_command:
        return _after_the_cut(track, cutter, cut, following)
    return _with_the_cut(track, cutter, cut), False


def _after_the_cut(
    track: Track, cutter: CutThread, cut: WindowCut, following: WindowCut | None
) -> tuple[WorldSteps, bool]:
    """Where motors keep up, the cut is known; else it is undone, and world and process go step by step."""
    moved: list[WorldSteps] = []
    world, follows, index = track.world, True, 0
    while index < len(cut.stretches):  # more of them when the rest of the window is cut anew
        stretch = cut.stretches[index]
        if not stretch.pushes:
            moved.extend(track.move(stretch, cut.window))
        else:
            track.attach(stretch.tool)
            q = cut.window.q[stretch.begin : stretch.end]
            if world.keeps_up(q, cut.wrenches[index]):
                moved.append(track.run_world(cut.window, stretch.begin, stretch.end, cut.wrenches[index]))
            else:
                follows = False
                if following is not None:
                    cutter.take_back(following)
                cutter.take_back(cut, first=index)
                moved.append(world.run(q, stretch))
                _end(track, cut, stretch, moved[-1])
                cutter.cut(cut)
            track.carry_on(stretch)
        index += 1
    return WorldSteps.joined(moved), follows


def _with_the_cut(track: Track, cutter: CutThread, cut: WindowCut) -> WorldSteps:
    """Where the machine goes depends on what it feels, so each stretch is cut while it is moved."""
    moved: list[WorldSteps] = []
    index = 0
    while index < len(cut.stretches):
        stretch = cut.ready(index)
        if stretch.pushes_alone and not stretch.pushes:  # nobody feels anything
            stretch.take_parts()
            moved.append(WorldSteps.joined(list(track.move(stretch, cut.window))))
            _end(track, cut, stretch, moved[-1])
        else:
            track.attach(stretch.tool)
            try:
                moved.append(track.world.run(cut.window.q[stretch.begin : stretch.end], stretch))
            except NotAtOnce as some:
                cut.stretches[index : index + 1] = stretch.divided(some.after)
                continue
            _end(track, cut, stretch, moved[-1])
            track.carry_on(stretch)
        index += 1
    cutter.see(cut)
    return WorldSteps.joined(moved)


def _end(track: Track, cut: WindowCut, stretch: Stretch, steps: WorldSteps) -> None:
    """A stretch has gone together with its cut; what nobody feels acts where the tip then was."""
    stretch.finish(track.off_command(cut.window, stretch, steps))
    stretch.settle()
    cut.wrenches.append(NOTHING)
