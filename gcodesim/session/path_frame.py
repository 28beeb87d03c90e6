"""In what a script gives a path: a work system, or a frame of the cell that stands still, such as the world."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from gcodesim.canon.systems import system_index, system_name
from gcodesim.frames import Pose
from gcodesim.frozen import frozen
from gcodesim.session.misuse import MisuseError

if TYPE_CHECKING:
    from gcodesim.shop import Shop

_WORLD: Final = "world"


@frozen
class PathFrame:
    """`X_MP` is the frame in M; the tool is held as the cell says it of the work system `system`."""

    system: int
    X_MP: Pose


def path_frame_of(shop: Shop, name: str) -> PathFrame:
    """The frame of this name for what `shop` runs.

    In a frame that is no work system the tool is held as in the first work system that rests. MisuseError for an
    unknown name, and where every work system is carried by other axes.
    """
    offsets, frames = shop.placement.work_offsets, shop.placement.frames
    given = name if isinstance(name, str) else ""
    work_system = system_name(given)
    if work_system is not None and system_index(work_system) in offsets:
        system = system_index(work_system)
        return PathFrame(system=system, X_MP=offsets[system])
    if given not in frames:
        listed = "".join(f", `{each}`" for each in frames if each != _WORLD)
        raise MisuseError(f"there is no frame `{name}`; use G54 to G59.3, `{_WORLD}`{listed}")
    moved = {*shop.placement.platforms, *shop.placement.borne}
    resting = [system for system in sorted(offsets) if system not in moved]
    if not resting:
        raise MisuseError(f"a path in `{name}` needs a work system that rests, by which the tool is held")
    X_WM, X_WP = shop.placement.X_WM, frames[name]
    return PathFrame(system=resting[0], X_MP=X_WM.inverse() @ X_WP)
