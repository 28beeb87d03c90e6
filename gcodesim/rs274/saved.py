"""M70 to M73: modes saved and restored."""

from __future__ import annotations

from gcodesim.rs274.control import Control
from gcodesim.rs274.dialects import g_name
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.parameters import G92_ON
from gcodesim.rs274.reader import read_plain
from gcodesim.rs274.state import ZERO, ModalState
from gcodesim.rs274.words import read_words
from gcodesim.units import INCH


def save(control: Control) -> None:
    """M70."""
    frame = control.frames[-1]
    frame.saved = control.state.copy()
    frame.saved_g92 = _has_g92(control)


def discard(control: Control) -> None:
    """M71."""
    control.frames[-1].saved = None


def restore(control: Control) -> bool:
    """M72; whether anything had to come back, and then the control forgets the rest of the block."""
    saved = control.frames[-1].saved
    if saved is None:
        raise Fault("GS191", "nothing was saved: M72 needs an M70 before it", at="m72")
    return bring_back(control, saved, control.frames[-1].saved_g92)


def save_for_return(control: Control) -> None:
    """M73: like M70, and the end of the subroutine restores; in the main program nothing ever does."""
    save(control)
    control.frames[-1].restores = True


def bring_back(control: Control, saved: ModalState, g92: bool) -> bool:
    """The modes of `saved` come back by codes, as on the control: first the unit, then one block and M codes.

    So G43 means the tool in the spindle again, F comes back with one decimal and S with none, and what a code
    cannot do is a fault.
    """
    codes = _codes_back(control.state, saved, _has_g92(control), g92)
    if saved.unit != control.state.unit:
        codes.insert(0, "G20" if saved.unit == INCH else "G21")
    for code in codes:
        _execute(code, control)
    return bool(codes)


def _execute(text: str, control: Control) -> None:
    from gcodesim.rs274.execute import execute

    block = read_plain(0, text)
    assert block is not None
    settings = control.settings
    try:
        execute(read_words(block, control.dialect, control.parameters, settings.m_codes, settings.has_cell), control)
    except Fault as fault:
        message = f"the saved modes cannot come back by `{text.strip()}`: {fault.message}"
        raise Fault(fault.code, message, hint=fault.hint) from None


def _codes_back(now: ModalState, saved: ModalState, g92_now: bool, g92: bool) -> list[str]:
    """The blocks that lead from the modes of now to those saved."""
    first: list[str] = []
    feed, feed_now = (state.feed * state.feed_unit / state.unit for state in (saved, now))
    if feed != feed_now:
        first.append(f"F{feed:.1f}")
    if saved.speed != now.speed:
        first.append(f"S{saved.speed:.0f}")
    for mode, mode_now in zip(_g_modes(saved, g92), _g_modes(now, g92_now), strict=True):
        if mode != mode_now:
            first.append(mode)
    first += _path_back(now, saved)
    rest = _m_codes_back(now, saved)
    return [" ".join([*first, *rest[:1]]), *rest[1:]] if first or rest else []


def _g_modes(state: ModalState, g92: bool) -> tuple[str, ...]:
    side = {0: "G40", 1: "G41", -1: "G42"}[state.side]
    return (
        g_name(state.plane).upper(),
        side,
        "G91" if state.incremental else "G90",
        g_name(state.feed_mode).upper(),
        f"G{53 + state.system}" if state.system < 7 else f"G59.{state.system - 6}",
        "G43" if state.tool_offset != ZERO else "G49",
        g_name(state.retract).upper(),
        "G96" if state.surface_speed else "G97",
        "G90.1" if state.centre_absolute else "G91.1",
        "G7" if state.diameter else "G8",
        "G92.3" if g92 else "G92.2",
    )


def _path_back(now: ModalState, saved: ModalState) -> list[str]:
    if saved.path != 640:
        return [] if saved.path == now.path else [g_name(saved.path).upper()]
    if (now.path, now.path_tolerance, now.path_naive) == (saved.path, saved.path_tolerance, saved.path_naive):
        return []
    return [f"G64 P{saved.path_tolerance / saved.unit:f} Q{saved.path_naive / saved.unit:f}"]


def _m_codes_back(now: ModalState, saved: ModalState) -> list[str]:
    """As on the control: flood alone is not switched off, M52 and M53 come back only where they were in force,
    and of the overrides that of the feed decides."""
    codes = []
    if saved.spindle != now.spindle:
        codes.append({0: "M5", 1: "M3", -1: "M4"}[saved.spindle])
    if saved.mist and not now.mist:
        codes.append("M7")
    if not (saved.mist or saved.flood) and (now.mist or now.flood):
        codes.append("M9")
    if saved.flood and not now.flood:
        codes.append("M8")
    if saved.feed_override != now.feed_override:
        codes.append("M48" if saved.feed_override else "M51")
    if saved.adaptive_feed and not now.adaptive_feed:
        codes.append("M52")
    if saved.feed_hold and not now.feed_hold:
        codes.append("M53")
    return codes


def _has_g92(control: Control) -> bool:
    return control.parameters.get(G92_ON) != 0.0


CODES = {70: save, 71: discard, 72: restore, 73: save_for_return}
