"""G51 scaling and G51.1 mirror image: they change the words of a block before it moves anything.

As on the control the mirror comes first, then the scale, then the turn of
G68, which is a matter of frames and lives in `control.py`.
"""

from __future__ import annotations

from gcodesim.rs274.arcs import PLANE_AXES
from gcodesim.rs274.dialects.fanuc import CYCLES, MIRROR, SCALING, TURN
from gcodesim.rs274.dialects.linuxcnc import COMPENSATION, MOTION
from gcodesim.rs274.fanuc import tilted
from gcodesim.rs274.fanuc.control import FanucControl
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.words import Words

_THOUSANDTHS = 1e-3  # P, I, J, K of G51 without a point count thousandths
_SWAPPED = {20: 30, 30: 20}
_SWAPPED_SIDES = {410: 420, 420: 410}


def switch(words: Words, control: FanucControl, has_point: dict[str, bool]) -> None:
    """G50, G51, G50.1, G51.1, G68, G69; they take their words out of the block."""
    code = words.g.get(SCALING)
    if code == 500:
        control.state.scale = (1.0, 1.0, 1.0)
    elif code == 510:
        _scale(words, control, has_point)
    code = words.g.get(MIRROR)
    if code is not None:
        _mirror(words, control, on=code == 511)
    code = words.g.get(TURN)
    if code == 690:
        tilted.off(control)
        control.reframe(turn=None)
    elif code == tilted.PLANE:
        tilted.switch(words, control)
    elif code == 680:
        _turn(words, control)


def _refuse_in_compensation(control: FanucControl, who: str) -> None:
    if control.state.side:
        raise Fault("GS150", f"{who} is refused in cutter compensation", at=who.lower(), hint="say G40 first")


def _centre(words: Words, control: FanucControl) -> list[float]:
    """The named point, absolute in G90 and G91 alike; axes not named: where the tool stands."""
    return [words.values.pop(letter, control.state.current[axis]) for axis, letter in enumerate("xyz")]


def _scale(words: Words, control: FanucControl, has_point: dict[str, bool]) -> None:
    _refuse_in_compensation(control, "G51")

    def factor(letter: str) -> float | None:
        value = words.values.pop(letter, None)
        if value is None:
            return None
        return value if has_point.get(letter) else value * _THOUSANDTHS

    common = factor("p")
    each = [factor(letter) for letter in "ijk"]
    if common is None and all(value is None for value in each):
        raise Fault("GS105", "G51 needs P, or I J K, the factors", at="g51", hint="P2000 or P2. is twice the size")
    factors = [common if common is not None else value if value is not None else 1.0 for value in each]
    if any(value == 0.0 for value in factors):
        raise Fault("GS106", "a scale of 0 leaves nothing", at="g51")
    control.state.scale_centre = tuple(_centre(words, control))  # type: ignore[assignment]
    control.state.scale = tuple(factors)  # type: ignore[assignment]


def _mirror(words: Words, control: FanucControl, *, on: bool) -> None:
    who = "G51.1" if on else "G50.1"
    _refuse_in_compensation(control, who)
    named = [letter in words.values for letter in "xyz"]
    if not any(named):
        raise Fault("GS103", f"{who} needs at least one axis word", at=who.lower())
    mirror = list(control.state.mirror)
    for axis, letter in enumerate("xyz"):
        if named[axis]:
            value = words.values.pop(letter)
            mirror[axis] = value if on else None
    control.state.mirror = tuple(mirror)  # type: ignore[assignment]


def _turn(words: Words, control: FanucControl) -> None:
    _refuse_in_compensation(control, "G68")
    if control.state.tilt is not None:
        raise Fault("GS106", "G68 in a tilted plane is not simulated", at="g68", hint="K of G68.2 turns it")
    angle = words.need("r", "GS105", "G68", "R is the angle in degrees")
    del words.values["r"]
    here = control.unturned(control.tip(control.state.current))
    axes = PLANE_AXES[control.state.plane][:2]
    centre = tuple(words.values.pop("xyz"[axis], here[axis]) for axis in axes)
    control.reframe(turn=None)  # a turn in force gives way
    control.reframe(turn=angle, turn_axes=axes, turn_centre=centre)


def apply(words: Words, control: FanucControl, motion: int) -> int:
    """The words as they are after mirror and scale, and the motion: G2 and G3 change places in a mirror."""
    state = control.state
    if state.scale == (1.0, 1.0, 1.0) and state.mirror == (None, None, None):
        return motion
    first, second, normal = PLANE_AXES[state.plane]
    values = words.values
    factors = [s if m is None else -s for s, m in zip(state.scale, state.mirror, strict=True)]
    drilling = motion in CYCLES
    for axis, letter in enumerate("xyz"):
        if letter in values and not (drilling and axis == normal):
            values[letter] = _scaled(values[letter], axis, control)
    if motion in (20, 30):
        if abs(abs(factors[first]) - abs(factors[second])) > 1e-9:
            hint = "use the same factor for both axes of the plane"
            raise Fault("GS110", "an arc cannot be scaled by two different factors", at="g51", hint=hint)
        for axis, letter in enumerate("ijk"):
            if letter in values:
                values[letter] *= factors[axis]
        if "r" in values:
            values["r"] *= abs(factors[first])
    if factors[first] * factors[second] < 0.0:
        motion = _SWAPPED.get(motion, motion)
        if words.g.get(MOTION) in _SWAPPED:
            words.names.add(f"g{motion // 10}")
    return motion


def side(words: Words, control: FanucControl) -> None:
    """G41 and G42 change places where the figure is mirrored."""
    code = words.g.get(COMPENSATION)
    if code not in _SWAPPED_SIDES:
        return
    first, second, _ = PLANE_AXES[control.state.plane]
    scale, mirror = control.state.scale, control.state.mirror
    turned = [(scale[axis] < 0.0) != (mirror[axis] is not None) for axis in (first, second)]
    if turned[0] != turned[1]:
        words.g[COMPENSATION] = _SWAPPED_SIDES[code]


def _scaled(value: float, axis: int, control: FanucControl) -> float:
    state = control.state
    line, factor, centre = state.mirror[axis], state.scale[axis], state.scale_centre[axis]
    if state.incremental:
        return factor * (value if line is None else -value)
    mirrored = value if line is None else 2.0 * line - value
    return centre + factor * (mirrored - centre)
