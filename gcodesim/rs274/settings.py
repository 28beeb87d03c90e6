"""What the reading of a program depends on besides its text."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import field
from pathlib import Path
from typing import Any, Literal

from gcodesim.canon import Axes
from gcodesim.diagnostics import SourceText
from gcodesim.frozen import frozen
from gcodesim.rs274.tilt import Tilt
from gcodesim.rs274.tool_point import ToolPointLaw
from gcodesim.rs274.tool_table import ToolTable


@frozen
class MappedAction:
    """What a mapped M-code does: `verb` on `target`, as close on gripper."""

    target: str
    verb: str


@frozen
class Settings:
    """Everything besides the text. Lengths of the tool table in SI; `parameters` as on the control (mm).

    `presets` are parameters, by number or name, that whoever starts the program gives a value in program units; it is
    told if that cannot have an effect.
    `m_codes` maps `M10` or `M62 P1` to actions. `wired` are outputs that the cell
    listens to, digital such as `P1`, analog such as `E0`. `auto_length` gives the true
    length [m] of each tool of the cell, `auto_aside` X and Y [m] of those whose tip is beside the axis of the spindle;
    with `tool_length="auto"` a program without any G43 or G49 applies them at M6. `path_control` is in force before
    the program's first G61 or G64; `startup` is a text whose blocks are executed before the first one of the program.
    `has_cell` makes user M-codes legal;
    `turns`: the machine is a lathe.
    `unturned`: tools that no spindle turns.
    `loaded_tool` is in the spindle before the first block, 0 for none; in a program
    without G43 its length counts from there on.
    `answered`: whoever iterates the run answers each `canon.ProbeMove` and
    `canon.Input`; else a probe trips at the end of its move and inputs read 0.
    `unplaced`: nobody has said where the work is; a printer then is taken to be homed before its first move.
    `start` [m, rad] is where the axes stand before the first block; with `joint_home` that is also where all of them
    go together (G28, G30) as long as no home was stored.
    `options` are settings that one kind of control alone has, as its dialect declares them
    (`Dialect.options`); those of other dialects are passed over.
    `travel` says from where to where X, Y and Z of the machine go [m], as its letters count.
    `limits` are those of a printer's planner that differ from the dialect's, by the names of `canon.MotionLimits`.
    `tool_point` says how tip and axes belong together; None where no rotary axis of the machine has a place.
    `tip_first`: where M-codes switch the control of the tip, it is on before the first block.
    `c_goes_round`: which way round the work the tool goes where C grows, 1 counterclockwise as seen from +Z, else -1.
    `columns` says for u, v and w that move an external axis which of a, b, c of the events (0 to 2) holds their value
    [m]; that letter means nothing else then.
    `leans` are the axes of work systems that are not just turned about Z of the machine, with a zero of nothing;
    `length_leans`: the tool, and with it its length, leans along.
    `lane` "grammar" reads every line by itself, "compiled" all that its kernels know as arrays; "auto" chooses by the
    length of the text and by how much has been executed.
    Both give the same result.
    `max_blocks` and `time_limit` [s] end an endless program; without the first, the
    dialect and the program's length say how much is too much.
    `until` is a line of the program before which reading ends, when it is reached for the first time (`Run.halted`).
    """

    dialect: str = "linuxcnc"
    tool_table: ToolTable = field(default_factory=ToolTable)
    parameters: Mapping[int, float] = field(default_factory=dict)
    presets: Mapping[int | str, float] = field(default_factory=dict)
    subroutines: tuple[Path, ...] = ()
    block_delete: bool = False
    optional_stop: bool = False
    m_codes: Mapping[str, MappedAction] = field(default_factory=dict)
    wired: frozenset[str] = frozenset()
    has_cell: bool = False
    turns: bool = False
    unturned: frozenset[int] = frozenset()
    answered: bool = False
    unplaced: bool = False
    start: Axes = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    joint_home: bool = False
    tool_length: Literal["auto", "strict"] = "auto"
    loaded_tool: int = 0
    auto_length: Mapping[int, float] | None = None
    auto_aside: Mapping[int, tuple[float, float]] = field(default_factory=dict)
    path_control: str = "G64"
    startup: SourceText | None = None
    options: Mapping[str, str] = field(default_factory=dict)
    travel: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    limits: Mapping[str, Any] = field(default_factory=dict)
    tool_point: ToolPointLaw | None = None
    tip_first: bool = False
    c_goes_round: float = 1.0
    columns: Mapping[str, int] = field(default_factory=dict)
    leans: Mapping[int, Tilt] = field(default_factory=dict)
    length_leans: bool = False
    lane: Literal["auto", "grammar", "compiled"] = "auto"
    max_blocks: int | None = None
    time_limit: float | None = None
    until: int | None = None


def canonical_m_code(text: str) -> str:
    """`m62p1`, `M062 P1.0` → `M62 P1`; ValueError if it is not an M-code with at most a P."""
    match = re.fullmatch(r"\s*[Mm]\s*0*(\d{1,3})(?:\s*[Pp]\s*(\d+)(?:\.0*)?)?\s*", text, re.ASCII)
    if match is None:
        raise ValueError(f"`{text}` is no M-code")
    return f"M{int(match[1])}" + (f" P{int(match[2])}" if match[2] is not None else "")
