"""M70 to M73: modes saved and restored."""

from __future__ import annotations

from gcodesim.rs274.control import Control
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.state import Modes

MODE_NAMES = tuple(Modes.__dataclass_fields__)


def save(control: Control) -> None:
    """M70."""
    control.frames[-1].saved = control.state.copy()


def discard(control: Control) -> None:
    """M71."""
    control.frames[-1].saved = None


def restore(control: Control) -> None:
    """M72."""
    saved = control.frames[-1].saved
    if saved is None:
        raise Fault("GS191", "nothing was saved: M72 needs an M70 before it", at="m72")
    bring_back(control, saved)


def save_for_return(control: Control) -> None:
    """M73: like M70, and the end of the subroutine restores; in the main program nothing ever does."""
    save(control)
    control.frames[-1].restores = True


def bring_back(control: Control, saved: object) -> None:
    """The modes of `saved` are in force again; position and offsets stay as they are."""
    from gcodesim.rs274.state import State

    assert isinstance(saved, State)
    state = control.state
    now = state.copy()
    control.change_unit(saved.unit)
    for name in MODE_NAMES:
        setattr(state, name, getattr(saved, name))
    state.speed, state.speed_unit = saved.speed, saved.speed_unit
    state.feed, state.feed_unit = saved.feed, saved.feed_unit
    state.spindle = saved.spindle
    state.feed_override = state.speed_override = True  # whatever was saved: the control says M48 here
    if saved.system != state.system:
        control.use_system(saved.system)
    if (now.spindle, now.speed, now.surface_speed) != (state.spindle, state.speed, state.surface_speed):
        control.say_spindle()
    if (now.flood, now.mist) != (state.flood, state.mist):
        control.say_coolant()
    if (now.path, now.path_tolerance, now.path_naive) != (state.path, state.path_tolerance, state.path_naive):
        control.say_path()
    control.say_overrides()


CODES = {70: save, 71: discard, 72: restore, 73: save_for_return}
