"""Where parts are while grippers carry them: the holds of each in order, and its falls."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from math import inf

import numpy as np

from gcodesim.arithmetic.matrices import multiplied, norms
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.scene.scene import Hold, Scene


@frozen(eq=False)
class Fall:
    """A part on its way down: where it is in the world, X (n, 4, 4), at the ends of steps `step` and those after it."""

    step: int
    X: Array

    @property
    def end(self) -> int:
        """The first step that it is over."""
        return self.step + len(self.X)


@frozen(eq=False)
class PartChange:
    """What becomes of one part from the hold's step on. `holder` is who holds it, empty when nobody does.

    In a frame that moves by itself it goes along for at most `room` [m].
    """

    hold: Hold
    holder: str = ""
    fall: Fall | None = None
    room: float = inf


Moving = Callable[[int, int], Array]
"""Of a frame that moves by itself: X_WF (n, 4, 4) at the ends of n steps from a step on."""


class CarriedParts:
    """The parts of a scene, as far as steps are known. It changes by `apply` alone.

    `moving` are frames that no machine moves, such as those of conveyors, by name.

    Only changes that still matter are kept, so it stays small however often parts are carried.
    """

    def __init__(self, scene: Scene, moving: Mapping[str, Moving] | None = None) -> None:
        self.scene, self.moving = scene, dict(moving or {})
        self.bodies = {body.name: body for body in scene.bodies if body.role == "part"}
        self._changes: dict[str, tuple[PartChange, ...]] = dict.fromkeys(self.bodies, ())

    def apply(self, change: PartChange) -> None:
        """From here on `change` holds for its part; those after its step are void."""
        name, step = change.hold.body, change.hold.step
        kept = tuple(each for each in self._changes[name] if each.hold.step < step)
        self._changes[name] = (*kept, change)

    def forget(self, step: int) -> None:
        """Nobody will ask about steps before this one."""
        for name, changes in self._changes.items():
            first = max((i for i, each in enumerate(changes) if each.hold.step <= step), default=0)
            if first:
                self._changes[name] = changes[first:]

    def memento(self) -> Callable[[], None]:
        """Remember the state; calling the result restores it."""
        kept = dict(self._changes)

        def restore() -> None:
            self._changes = dict(kept)

        return restore

    def holder(self, name: str, step: int) -> str:
        """Who holds a part in a step; empty: it lies or falls."""
        now = self._now(name, step)
        return "" if now is None else now.holder

    def parent(self, name: str, step: int) -> str:
        """The frame in which the part stands."""
        now = self._now(name, step)
        return self.scene.frames[name].parent if now is None else now.hold.parent

    def _now(self, name: str, step: int) -> PartChange | None:
        return next((each for each in reversed(self._changes[name]) if each.hold.step <= step), None)

    def changes_in(self, name: str, step: int) -> bool:
        """Whether something becomes of a frame in a step; False for what is no part."""
        return any(each.hold.step == step for each in self._changes.get(name, ()))

    def riders(self, name: str, step: int) -> list[str]:
        """All parts that stand on this one, or on one that does."""
        found = [other for other in self.bodies if other != name and self.parent(other, step) == name]
        return found + [more for other in found for more in self.riders(other, step)]

    def mass(self, name: str, step: int) -> float:
        """[kg] of a part and of those that stand on it."""
        return sum(self.bodies[each].mass or 0.0 for each in (name, *self.riders(name, step)))

    def poses(self, name: str, first: int, q: Mapping[str, Array]) -> Array:
        """X_WP (n, 4, 4) of a part at the ends of steps `first` and after it, with joints `q[mover]` (n, j)."""
        changes = [each for all_of in self._changes.values() for each in all_of]
        holds = [replace(each.hold, step=each.hold.step - first) for each in changes]
        X = self.scene.track(name, q, holds)
        own = self._changes[name]
        for index, change in enumerate(own):
            later = own[index + 1].hold.step - first if index + 1 < len(own) else len(X)
            begin, end = max(change.hold.step - first, 0), min(later, len(X))
            if change.hold.parent in self.moving and begin < end:
                moving = self.moving[change.hold.parent]
                belt = moving(first + begin, end - begin)
                start = moving(change.hold.step, 1)[0, :3, 3]
                way = belt[:, :3, 3] - start
                gone = norms(way)
                share = np.where(gone > change.room, change.room / np.where(gone > 0.0, gone, 1.0), 1.0)
                belt[:, :3, 3] = start + way * share[:, None]
                X[begin:end] = multiplied(belt, change.hold.X.matrix)
        for change in own:
            fall = change.fall
            if fall is not None:
                begin, end = max(fall.step - first, 0), min(fall.end - first, len(X))
                if begin < end:
                    X[begin:end] = fall.X[begin + first - fall.step : end + first - fall.step]
        return X
