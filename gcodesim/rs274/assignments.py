"""Parameters that a block sets."""

from __future__ import annotations

from gcodesim.rs274.block import Block, Name
from gcodesim.rs274.control import Control
from gcodesim.rs274.expressions import checked, names_in
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.parameters import Parameters


def declare(block: Block, control: Control) -> None:
    """As on the control, a named parameter that a block sets for the first time is 0 in the rest of the block."""
    for setting in block.settings:
        if not isinstance(setting.parameter, Name) or not control.parameters.declare(setting.parameter.name):
            continue
        name = setting.parameter.name
        before = [node for (_, node), place in zip(block.words, block.places, strict=True) if place < setting.place]
        before += [other.value for other in block.settings if other.place < setting.place]
        if any(names_in(node, name) for node in before):
            control.parameters.roll_back()
            raise Fault("GS120", f"#<{name}> has no value before it is set", at=setting.place)
        after = [setting.value, *(node for _, node in block.words), *(other.value for other in block.settings)]
        if any(names_in(node, name) for node in after):
            control.warn("GS120", f"#<{name}> is used in the block that sets it first, where it counts as 0")


Assignments = list[tuple[int | str, float, tuple[int, int]]]
"""Number or name of a parameter, its new value, and where in the line that stands."""


def assign(settings: Assignments, parameters: Parameters) -> None:
    """Carry out the settings of a block."""
    for number, value, _place in settings:
        if isinstance(number, str):
            parameters.set_named(number, value)
        else:
            parameters.set_by_program(number, value)


def evaluated(block: Block, parameters: Parameters) -> Assignments:
    """The settings of a block; all values are those from before the block."""
    out: Assignments = []
    for index, value, place in block.settings:
        try:
            if isinstance(index, Name):
                parameters.check_setting(index.name)
                out.append((index.name, checked(value, parameters), place))
            else:
                out.append((parameters.index(checked(index, parameters)), checked(value, parameters), place))
        except Fault as fault:
            fault.at = place
            raise
    return out
