"""A channel: one program, the robot or machine that it moves, and how its words are read."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any, Final, Literal

from gcodesim.actions import ACTIONS
from gcodesim.cell.firmware import Firmware
from gcodesim.cell.inputs import INPUTS, InputKind, InputSource
from gcodesim.cell.orientation import Orientation
from gcodesim.cell.placing import SYSTEM_NAMES, Place
from gcodesim.cell.signals import SIGNALS, SignalSource
from gcodesim.cell.startup import Startup, StartupKind
from gcodesim.declarations.composed import Either, ListOf
from gcodesim.declarations.file_kind import File, FileValue
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import POSITIVE, Json, Kind, Range, scalar, short
from gcodesim.declarations.map_of import MapOf, NameRule
from gcodesim.declarations.nodes import Mapping as MappingNode
from gcodesim.declarations.nodes import Node, Scalar
from gcodesim.declarations.plain_kinds import Choice, Switch, Text, Whole
from gcodesim.declarations.quantity import Quantity
from gcodesim.declarations.reading import UNREAD, Path, Reading, Unread, suggestion
from gcodesim.declarations.record import Record, not_a_mapping
from gcodesim.declarations.scalars import measured
from gcodesim.frozen import frozen
from gcodesim.processes.signal import actions_of_all
from gcodesim.rs274.dialects import DIALECTS
from gcodesim.rs274.settings import canonical_m_code
from gcodesim.sensors.orders import orders_of_all

DEFAULT_PATH_CONTROL: Final = "G64"

_PATH_CONTROL = re.compile(r"\s*[Gg]\s*(61\.1|61|64)\s*(?:[Pp]\s*([0-9.]+))?\s*(?:[Qq]\s*([0-9.]+))?\s*")

VERBS: Final[dict[str, tuple[str, ...]]] = {"tool": ("activate", "deactivate"), "gripper": ("open", "close")}
"""What an M-code may do, and to what, before processes of third parties add to it."""

WAIT: Final = "wait"
"""The target of an M-code at which the program waits for those of other channels; its verb is the name of a mark."""


CALL: Final = "call"
"""The target of an M-code that calls an action in Python; its verb is the action's name."""


def all_verbs() -> dict[str, tuple[str, ...]]:
    """`VERBS`, whatever any process receives by the signals that it reads, and what has sensors read."""
    more = {**actions_of_all(), **orders_of_all()}
    names = dict.fromkeys([*VERBS, *more])
    return {name: tuple(dict.fromkeys([*VERBS.get(name, ()), *more.get(name, ())])) for name in names}


@frozen(kw_only=False)
class _DialectKind(Kind):
    """A dialect of the program reader."""

    @property
    def expected(self) -> str:
        return f"one of {', '.join(f'`{name}`' for name in DIALECTS)}"

    def read(self, node: Node, to: Reading, path: Path) -> str | Unread:
        text = scalar(self, node, to, path)
        if isinstance(text, Unread):
            return UNREAD
        if text.text in DIALECTS:
            return text.text
        message = f"`{path[-1]}` cannot be `{short(text.text)}`"
        return to.fault("GS711", text.span, message, suggestion(text.text, list(DIALECTS)))

    def schema(self, definitions: dict[str, Json]) -> Json:
        return {"enum": list(DIALECTS)}


@frozen
class MCode:
    """What an M-code does: `verb` on `target`.

    For the target `wait`, `verb` is the mark at which programs meet; for `call`, the name of an action.
    """

    target: str
    verb: str


_MARK: Final = Text(pattern=r"[\w.-]+", form="the name of a mark, such as `part_in`")


@frozen(kw_only=False)
class _ActionKind(Kind):
    """`{tool: activate}`, `{wait: part_in}`."""

    @property
    def expected(self) -> str:
        return "a target and what it does, such as `{tool: activate}` or `{wait: part_in}`"

    def read(self, node: Node, to: Reading, path: Path) -> MCode | Unread:
        if not isinstance(node, MappingNode):
            return not_a_mapping(node, self.expected, to, path)
        if len(node.entries) != 1:
            return to.fault(
                "GS706", node.span, f"`{path[-1]}` has {len(node.entries)} targets; {self.expected} is expected"
            )
        target, value = node.entries[0]
        if target.text == WAIT:
            mark = _MARK.read(value, to, (*path, WAIT))
            return UNREAD if isinstance(mark, Unread) else MCode(target=WAIT, verb=mark)
        if target.text == CALL:
            names = Choice(tuple(ACTIONS), "the name of an action")
            name = names.read(value, to, (*path, CALL))
            return UNREAD if isinstance(name, Unread) else MCode(target=CALL, verb=name)
        verbs = VERBS
        if target.text not in VERBS or not isinstance(value, Scalar) or value.text not in VERBS[target.text]:
            verbs = all_verbs()
        if target.text not in verbs:
            return to.fault(
                "GS711",
                target.span,
                f"an M-code cannot act on `{short(target.text)}`",
                suggestion(target.text, [*verbs, WAIT, CALL]),
            )
        verb = Choice(verbs[target.text]).read(value, to, (*path, target.text))
        return UNREAD if isinstance(verb, Unread) else MCode(target=target.text, verb=verb)

    def schema(self, definitions: dict[str, Json]) -> Json:
        properties: dict[str, Json] = {target: {"enum": list(verbs)} for target, verbs in all_verbs().items()}
        properties[WAIT] = _MARK.schema(definitions)
        properties[CALL] = {"type": "string", "description": "the name of an action of one's own"}
        return {
            "type": "object",
            "properties": properties,
            "minProperties": 1,
            "maxProperties": 1,
            "additionalProperties": False,
        }

    def show(self, value: Any) -> Any:
        return {value.target: value.verb}

    def plain(self, value: Any) -> tuple[str, Any]:
        return "", self.show(value)


def m_code(text: str) -> str | None:
    """`m62p1` → `M62 P1`; None if it is not an M-code."""
    try:
        return canonical_m_code(text)
    except ValueError:
        return None


M_CODES: Final = NameRule(
    what="M-code (such as `M10` or `M62 P1`)",
    pattern=r"\s*[Mm]\s*[0-9]{1,3}(\s*[Pp]\s*[0-9]+(\.0*)?)?\s*",
    canonical=m_code,
)


@frozen(kw_only=False)
class _PathControl(Kind):
    """`G64 P0.02`."""

    @property
    def expected(self) -> str:
        return "`G61`, `G61.1` or `G64` with P and Q, such as `G64 P0.02`"

    def read(self, node: Node, to: Reading, path: Path) -> str | Unread:
        text = scalar(self, node, to, path)
        if isinstance(text, Unread):
            return UNREAD
        match = _PATH_CONTROL.fullmatch(text.text)
        numbers = [] if match is None else [n for n in match.groups()[1:] if n is not None]
        if match is None or any(measured(n) is None for n in numbers) or (match[1] != "64" and numbers):
            return to.fault("GS711", text.span, f"`{path[-1]}` is `{short(text.text)}`; {self.expected} is expected")
        words = [f"G{match[1]}"]
        words += [
            f"{letter}{float(number):.10g}"
            for letter, number in zip("PQ", match.groups()[1:], strict=True)
            if number is not None
        ]
        return " ".join(words)

    def schema(self, definitions: dict[str, Json]) -> Json:
        return {"type": "string", "pattern": f"^{_PATH_CONTROL.pattern}$", "examples": ["G64 P0.02"]}


@frozen
class Channel:
    """The settings of one program. Lengths P and Q of `path_control` are in mm, as on the control."""

    robot: str | None = key(Text(form="the name of a robot, or `machine`"), "who runs the program", default=None)
    program: FileValue | None = key(
        File("a program"), "its program, where the command line names none", default=None, quiet=True
    )
    dialect: str = key(_DialectKind(), "the control whose language is used", default="linuxcnc")
    work_offsets: Mapping[str, Place] = key(
        MapOf(
            SYSTEM_NAMES,
            Record(Place, "a work offset"),
            "work systems and where they are, such as `G54: {in: table, xyz: [100, 50, 20]}`",
        ),
        "where G54 to G59.3 are; for `fanuc` also `G54.1 P1` to `G54.1 P300`",
        default={},
        quiet=True,
    )
    orientation: Orientation | None = key(
        Record(Orientation, "an orientation"), "how an arm holds the tool", default=None
    )
    path_control: str = key(_PathControl(), "path control until the program sets its own", default=DEFAULT_PATH_CONTROL)
    look_ahead: int | None = key(
        Either((("unlimited", 0),), Whole(Range(least=2, most=100_000))),
        "how many blocks the control knows behind the one that runs: it is never faster than it can come to rest over "
        "them; default: as the control is delivered, without end for arms and where that is not known",
        default=None,
        example="200",
        quiet=True,
    )
    startup: Startup | None = key(
        StartupKind(),
        "what the control has in force before the first block, such as `G20` on a machine in inches, `M83` on a "
        "printer whose start macro says so",
        default=None,
        quiet=True,
    )
    tool_table: FileValue | None = key(File("a tool table"), "tool lengths that the control uses", default=None)
    parameters: FileValue | None = key(File("a parameter file"), "values of # parameters at the start", default=None)
    subroutines: tuple[FileValue, ...] = key(
        ListOf(File("a folder of subroutines", is_folder=True), single=True),
        "folders searched for subroutines",
        default=(),
    )
    decimal_point: Literal["calculator", "increments"] = key(
        Choice(("calculator", "increments")),
        "what X10 is to a Fanuc program: 10 mm, or 10 increments of 0.001 mm",
        default="calculator",
    )
    compensation_start: Literal["A", "B"] = key(
        Choice(("A", "B")),
        "start and end of Fanuc's cutter compensation: at right angles to the next move (A), or round its corner",
        default="A",
    )
    compensation_blocks: int = key(
        Whole(Range(least=3, most=8)),
        "how many blocks a Fanuc control reads in cutter compensation: all but two may be without a move in the plane,"
        " and so far it looks for places narrower than the tool",
        default=3,
    )
    block_delete: bool = key(Switch(), "blocks that begin with `/` are skipped", default=False)
    optional_stop: bool = key(Switch(), "M1 stops; without effect, as nobody would go on", default=False)
    m_codes: Mapping[str, MCode] = key(
        MapOf(M_CODES, _ActionKind(), "M-codes and what they do, such as `M10: {tool: activate}`"),
        "M-codes of this cell; at `{wait: NAME}` programs of several channels wait for each other",
        default={},
        quiet=True,
    )
    signals: Mapping[str, SignalSource] = key(
        SIGNALS, "words of the program that give values to processes of the tools", default={}, quiet=True
    )
    laser_mode: float | None = key(
        Quantity("ratio", POSITIVE),
        "S for full power (grbl's `$30`) where the control drives a laser as grbl does with `$32=1`: power follows S, "
        "none in G0, and with M4 it follows the speed too; an S beside a move goes along with it without a stop",
        default=None,
        example="1000",
        quiet=True,
    )
    firmware: Firmware | None = key(
        Record(Firmware, "limits of a printer's planner, or of grbl's"),
        "what the control of a printer is set to, until the program says otherwise, or grbl's `$11` as "
        "`junction_deviation`; default: as it is delivered",
        default=None,
        quiet=True,
    )
    inputs: Mapping[str, InputSource] = key(
        MapOf(INPUTS, InputKind(), "inputs and what they read"),
        "what M66 reads; inputs that are not named read 0",
        default={},
        quiet=True,
    )
    tool_length: Literal["auto", "strict"] = key(
        Choice(("auto", "strict")), "`auto`: in a program without G43 and G49, M6 acts like M6 G43", default="auto"
    )
    loaded_tool: int | None = key(
        Whole(), "number of the tool in the spindle at the start; default: none", default=None, quiet=True
    )
