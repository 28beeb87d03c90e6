"""Findings GS9xx: words that are read, but change nothing in the simulation."""

from gcodesim.diagnostics.catalogue.code import Code
from gcodesim.diagnostics.finding import Severity

CODES: tuple[Code, ...] = (
    Code(
        code="GS901",
        severity=Severity.NOTE,
        title="Coolant not simulated",
        what="Coolant is read and shown in the listing, but has no effect on the simulated process.",
        why="What depends on it on the real machine is not in the results.",
        remedy=(
            "Map the code in the cell under `m_codes` if it matters, or make it an error with `checks: {GS9xx: error}`."
        ),
    ),
    Code(
        code="GS902",
        severity=Severity.NOTE,
        title="Overrides not simulated",
        what="Override switches are read, but the simulation has no operator who would turn a knob.",
        why="What depends on it on the real machine is not in the results.",
        remedy=(
            "Map the code in the cell under `m_codes` if it matters, or make it an error with `checks: {GS9xx: error}`."
        ),
    ),
    Code(
        code="GS903",
        severity=Severity.NOTE,
        title="Spindle orientation not simulated",
        what="The spindle's angle is read, but does not matter to a rotating tool.",
        why="What depends on it on the real machine is not in the results.",
        remedy=(
            "Map the code in the cell under `m_codes` if it matters, or make it an error with `checks: {GS9xx: error}`."
        ),
    ),
    Code(
        code="GS904",
        severity=Severity.NOTE,
        title="Output without meaning not simulated",
        what="An output is set, and the cell does not say what it does.",
        why="What depends on it on the real machine is not in the results.",
        remedy=(
            "Map the code in the cell under `signals` or `m_codes` if it matters, or make it an error with "
            "`checks: {GS9xx: error}`."
        ),
    ),
    Code(
        code="GS905",
        severity=Severity.NOTE,
        title="Input not simulated",
        what="M66 reads an input that nothing sets: it is 0, and a wait for it runs out.",
        why="What depends on it on the real machine is not in the results.",
        remedy=(
            "Say in the cell what it reads, under `inputs` of the channel: `{P0: 1}`, by time "
            "`{P1: [[0, 0], [5 s, 1]]}`, or wired to an output `{P2: {output: P1}}`. `checks: {GS9xx: error}` lets no "
            "program pass that reads others."
        ),
    ),
    Code(
        code="GS906",
        severity=Severity.NOTE,
        title="Pallet shuttle not simulated",
        what="Pallets are not simulated.",
        why="What depends on it on the real machine is not in the results.",
        remedy=(
            "Map the code in the cell under `m_codes` if it matters, or make it an error with `checks: {GS9xx: error}`."
        ),
    ),
    Code(
        code="GS907",
        severity=Severity.NOTE,
        title="User M code not simulated",
        what="The control would run a program of its own for this code; the cell maps nothing to it.",
        why="What depends on it on the real machine is not in the results.",
        remedy=(
            "Map the code in the cell under `m_codes` if it matters, or make it an error with `checks: {GS9xx: error}`."
        ),
    ),
    Code(
        code="GS908",
        severity=Severity.NOTE,
        title="Axes U, V, W not simulated",
        what="Moves of U, V and W are read, but no simulated machine has these axes.",
        why="What depends on it on the real machine is not in the results.",
        remedy=(
            "Map the code in the cell under `m_codes` if it matters, or make it an error with `checks: {GS9xx: error}`."
        ),
    ),
)

# keys of the cell
CODES += (
    Code(
        code="GS909",
        severity=Severity.NOTE,
        title="A part of the cell has no effect",
        what="The cell describes something that this run leaves out.",
        why="Whoever wrote it counts on it.",
        remedy="Do what the hint says, or make it an error with `checks: {GS9xx: error}`.",
    ),
    Code(
        code="GS910",
        severity=Severity.WARNING,
        title="A channel does not run",
        what="The cell has a channel for which nobody has named a program. Its robot is left out of the run.",
        why="Robots that work beside each other may meet, and this run cannot see it.",
        remedy=(
            "Name its program with `--channel NAME=PROGRAM`, or under `program:` in the cell. Then all programs run "
            "at once."
        ),
    ),
    Code(
        code="GS911",
        severity=Severity.NOTE,
        title="A rotary axis turns nothing",
        what="The program moves a rotary axis of the machine for which the cell gives no point (`at`).",
        why="Without its place the axis takes time only. What is cut while it moves or stands turned is not right.",
        remedy="Give `at: [x, y, z]`, a point on the axis in machine coordinates.",
    ),
    Code(
        code="GS930",
        severity=Severity.NOTE,
        title="Bodies of a machine overlap at the start",
        what="Two links, or a tool and a link, are in each other where the program begins. Shapes of links are often"
        " drawn with an overlap, so this pair is left out of the check; all others are looked at.",
        why="Should the two really hit each other later, nothing would be said.",
        remedy="Look at the start of the replay: shapes that overlap by design may stay so. If the machine stands in"
        " itself, change its `home`. `checks: {GS930: error}` lets no pair be left out unseen.",
    ),
)

# comments
CODES += (
    Code(
        code="GS912",
        severity=Severity.NOTE,
        title="An active comment not simulated",
        what=(
            "On LinuxCNC (PROBEOPEN …), (LOGOPEN, …), (LOGAPPEND, …) write files and (PY, …) runs code. A simulation "
            "does neither."
        ),
        why="Whoever looks for that file after the run does not find it.",
        remedy="Texts of (LOG, …) are events in the log of a run; `gcodesim canon` lists them, and where probes end.",
    ),
    Code(
        code="GS913",
        severity=Severity.NOTE,
        title="A G code is not simulated",
        what="The code is read, but what it does on the control is not modelled: look-ahead, stroke limits, "
        "and the like.",
        why="What depends on it on the real machine is not in the results.",
        remedy="The hint says what the simulation does instead. `checks: {GS9xx: error}` makes it an error.",
    ),
    Code(
        code="GS915",
        severity=Severity.ERROR,
        title="A code that cannot be left out",
        what="The control has this code, the simulation has not, and the moves behind it mean something else with it.",
        why="Simulated without it they would be other moves than those of the machine.",
        remedy="Simulate the rest of the program by itself, or let the post write plain moves.",
    ),
    Code(
        code="GS916",
        severity=Severity.WARNING,
        title="A turning program without a lathe",
        what="The program is for a lathe: it has codes of turning and never names Y. The cell has none, or there is no "
        "cell.",
        why="The work stands still then, and a tool is a cutter that turns. Material, forces and collisions would be "
        "those of milling.",
        remedy="Run it in a cell with `machine: lathe_xz` or a lathe of your own. On a mill look at paths and times "
        "only, and leave out the stock.",
    ),
    Code(
        code="GS919",
        severity=Severity.NOTE,
        title="Uncut stock in a check",
        what="`gcodesim check` cuts nothing: probes of the program meet the stock as it comes into the cell, and a "
        "later set-up of a job gets the stock uncut.",
        why="Where the program probes what it has cut itself, `run` trips at other places, and may go on in "
        "other lines. What an earlier set-up takes away is still there.",
        remedy="Use `gcodesim run` for such a program.",
    ),
    Code(
        code="GS926",
        severity=Severity.NOTE,
        title="Forces in this material are not simulated",
        what="The material of the stock is known by name, but no source gives constants of its cutting force.",
        why="Woods, plastics, foams, wax and graphite are cut; force, torque and power of these lines are 0.",
        remedy="Give constants from own tests under `materials:`, with their source, and name that material.",
    ),
    Code(
        code="GS921",
        severity=Severity.NOTE,
        title="Heaters are not simulated",
        what="The program sets or waits for temperatures (M104, M109, M140, M190, G10 S).",
        why="Waiting takes no time here, so that the printing time leaves out heating up.",
        remedy="Nothing. Add the time of heating up to the total where it matters.",
    ),
    Code(
        code="GS922",
        severity=Severity.NOTE,
        title="Fans are not simulated",
        what="The program switches fans (M106, M107).",
        why="Beads are as large as their filament says, whether they are cooled or not.",
        remedy="Nothing.",
    ),
    Code(
        code="GS923",
        severity=Severity.NOTE,
        title="Display and counters are not simulated",
        what="The program shows something or counts (M73, M75 …).",
        why="It changes no motion.",
        remedy="Nothing.",
    ),
    Code(
        code="GS924",
        severity=Severity.NOTE,
        title="A macro of the printer is not simulated",
        what="The program calls a macro (START_PRINT, EXCLUDE_OBJECT_START …) that is defined in the printer's own "
        "configuration, a command of Klipper that is not simulated, or a G code of the maker's own (G2814 of Bambu).",
        why="What it does is not known here: it may home, heat, move, or lay a line of filament.",
        remedy="Put the moves of the macro into the program if they matter.",
    ),
    Code(
        code="GS914",
        severity=Severity.NOTE,
        title="Lines left out by block delete",
        what="Lines that begin with a slash are left out, because the switch for them is on.",
        why="On a machine whose switch is off they run, and the part comes out different.",
        remedy="Set the switch as it stands on the machine; without `--block-delete` the lines run.",
    ),
)
