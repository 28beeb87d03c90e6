"""Findings GS3xx: what touches what must not be touched."""

from gcodesim.diagnostics.catalogue.code import Code
from gcodesim.diagnostics.finding import Severity

_HOW = (
    " The check sweeps the exact body of the tool along the path and needs no world; the run goes on as if nothing had"
    " been there."
)

_MOVING = (
    " Shapes are those for collisions of the description, round ones exactly; the whole way between two points of the"
    " program is looked at, so nothing is missed in between."
)

CODES: tuple[Code, ...] = (
    Code(
        code="GS301",
        severity=Severity.ERROR,
        title="Cutter hits a fixture",
        what="The cutting part of the tool enters a fixture." + _HOW,
        why="The cutter breaks, the clamp is cut or torn off, and the part comes loose.",
        remedy="Go round the fixture or above it, or move the fixture. The message says where in the work system; when"
        " rapids of the machine move axis by axis, the way of the tool is not the straight line (`rapids`).",
    ),
    Code(
        code="GS302",
        severity=Severity.ERROR,
        title="Shank hits a fixture",
        what="The part of the tool between flutes and holder enters a fixture." + _HOW,
        why="The tool bends or breaks.",
        remedy="Keep more distance to the fixture, or use a longer tool.",
    ),
    Code(
        code="GS303",
        severity=Severity.ERROR,
        title="Holder hits a fixture",
        what="The tool holder enters a fixture." + _HOW,
        why="The holder is much stronger than the tool: spindle, fixture and part are damaged.",
        remedy="Use a longer tool or a slimmer holder, or a lower fixture.",
    ),
    Code(
        code="GS304",
        severity=Severity.ERROR,
        title="Process tool hits a fixture",
        what="The nozzle or body of a process tool enters a fixture." + _HOW,
        why="The tool is bent or torn off, and its calibration is lost.",
        remedy="Lift the tool before it passes the fixture, or move the fixture.",
    ),
    Code(
        code="GS305",
        severity=Severity.ERROR,
        title="Link hits a fixture",
        what="A link of the arm or of the machine, or a fixture that a machine carries, enters a fixture, or a tool"
        " that waits in its stand." + _MOVING,
        why="The arm stops with a fault at best; the fixture is torn off, and the arm has to be measured again.",
        remedy="Move the fixture or the work, turn the tool about its axis (`spin`), or choose another `home`, so that"
        " the arm comes another way. The base of the arm is not checked: it stands still beside what stands still.",
    ),
    Code(
        code="GS306",
        severity=Severity.ERROR,
        title="Machine hits itself",
        what="Two links of a machine meet that are no neighbours, or its tool meets a link other than the one that"
        " carries it." + _MOVING,
        why="A control stops before that, or the machine is damaged.",
        remedy="Turn the tool about its axis, or place the work farther from the base.",
    ),
    Code(
        code="GS307",
        severity=Severity.ERROR,
        title="Link hits the stock",
        what="A link, a fixture that the machine carries, such as the head of its spindle, or the `body` of a tool"
        " but for what touches the work by design (its `tip`) enters a stock. A run"
        " looks at the stock as it stands by then, to half a cell; the depth is that in the deepest of its columns."
        " `check`, which cuts nothing, knows only the shape at the start: there it is a warning." + _MOVING,
        why="The link pushes against the part, which moves or breaks.",
        remedy="Use a longer tool, cut more away before, or place the work so that the arm reaches it from outside.",
    ),
    Code(
        code="GS308",
        severity=Severity.WARNING,
        title="Near miss",
        what="A link, a tool or a fixture that the machine carries comes nearer to a fixture than `clearance` under"
        " `limits` allows, without touching it; in a run also a link or such a fixture to a stock as it is cut by then."
        " The message has the least distance of one passing, and where.",
        why="Fixtures stand, and arms go, some tenths of a millimetre or some millimetres beside where they are drawn.",
        remedy="Keep more distance. Without `clearance` in the cell nothing is said of near misses.",
    ),
    Code(
        code="GS309",
        severity=Severity.ERROR,
        title="A part hits something",
        what="A part that is held or carried enters a link, a tool, a fixture, a stock, a device or another part, or"
        " one of these enters a part that lies, where it is at that time. Fingers or cups around the part that they"
        " hold are no finding, nor is what a part stands on or beside where it is taken and let go, as long as they"
        " enter each other by no more than 0.5 mm. In the `bullet` world a piece that came loose from a stock (GS440)"
        " counts as a part where it lies, to one cell; what its own cutter trims of it on the next way of a diameter"
        " is no finding." + _MOVING,
        why="The part is pushed out of the gripper, or it damages what it hits.",
        remedy="Go round it or above it. A path that is free without a part may not be so with one: a part reaches"
        " farther down than the fingers.",
    ),
    Code(
        code="GS310",
        severity=Severity.ERROR,
        title="A device hits something",
        what="A door, a clamp, a feeder or what else stands under `devices` enters a link, a tool, a fixture or a"
        " stock, or one of these enters it, at the time at which it is there. A clamp may press into a stock or a"
        " fixture by 0.5 mm." + _MOVING,
        why="A door that closes on an arm damages both.",
        remedy="Wait until the device is there: `M66` reads an input that the cell ties to it. The finding is at the"
        " word that switched the device if the machine stands still, else at the move.",
    ),
    Code(
        code="GS311",
        severity=Severity.ERROR,
        title="Two machines meet",
        what="A link, a tool or something else that one machine carries enters that of another at the same time, on the"
        " common clock of their programs." + _MOVING,
        why="Both stop with a fault at best.",
        remedy="Let the programs wait for each other at marks (`m_codes: {M200: {wait: NAME}}`), or keep each machine"
        " in a zone of its own (`zones:`).",
    ),
)
