"""Findings GS5xx: the process and its limits."""

from gcodesim.diagnostics.catalogue.code import Code
from gcodesim.diagnostics.finding import Severity

CODES: tuple[Code, ...] = (
    Code(
        code="GS501",
        severity=Severity.ERROR,
        title="Feed into stock with the spindle stopped",
        what="A feed move took material away while the spindle stood still. No force is computed for it.",
        why="A cutter that does not turn is pushed through the material and breaks.",
        remedy="Start the spindle with S and M3 before the first cut; look for an M5, M6 or M0 in between.",
    ),
    Code(
        code="GS502",
        severity=Severity.ERROR,
        title="Feed into stock with the spindle reversed",
        what="A feed move took material away while the spindle ran counter-clockwise (M4). No force is "
        "computed for it.",
        why="Right-hand cutters turning backwards rub with the back of their teeth and burn.",
        remedy="Use M3. Left-hand cutters cannot be described yet.",
    ),
    Code(
        code="GS503",
        severity=Severity.WARNING,
        title="Program ends with the spindle on",
        what="The program ends while the spindle is running.",
        why="M2 and M30 stop the spindle on most controls, but not on all of them, and the next tool change or a hand "
        "in the machine may come before somebody notices.",
        remedy="Put M5 before the end of the program.",
    ),
    Code(
        code="GS504",
        severity=Severity.WARNING,
        title="Program ends with a process on",
        what="The program ends while a process tool that an M-code switched on is still active.",
        why="An extruder, jet or gun that is left on goes on spending material at the last point.",
        remedy="Switch it off before the end; the cell's `m_codes` or `signals` say which word does it.",
    ),
    Code(
        code="GS505",
        severity=Severity.WARNING,
        title="Program ends with coolant on",
        what="The program ends while flood or mist coolant is on.",
        why="M2 and M30 stop coolant on most controls, but not on all of them.",
        remedy="Put M9 before the end of the program.",
    ),
    Code(
        code="GS506",
        severity=Severity.WARNING,
        title="Feeds with an empty spindle",
        what="The program has feed moves, the cell has stock, and no move of the program has a tool in the spindle.",
        why="Programs for small controls call no tool: somebody puts it in by hand. As long as the cell does not say "
        "which one that is, nothing is cut and nothing can be found wrong with the cut.",
        remedy="Name the tool under `loaded_tool` of the cell, or call one in the program with T and M6.",
    ),
    Code(
        code="GS510",
        severity=Severity.ERROR,
        title="Spindle power exceeded",
        what="The mean cutting power of a revolution is above the limit of the cell.",
        why="The spindle slows down or stalls in the cut.",
        remedy="Reduce feed, depth or width of the cut on this line; power grows with the removal rate.",
    ),
    Code(
        code="GS511",
        severity=Severity.ERROR,
        title="Spindle torque exceeded",
        what="The mean cutting torque of a revolution is above the limit of the cell.",
        why="The spindle slows down or stalls in the cut, the more so at low speed.",
        remedy="Reduce feed per tooth or depth, or use a cutter of smaller diameter.",
    ),
    Code(
        code="GS512",
        severity=Severity.ERROR,
        title="Process force exceeded",
        what="The mean force on the tool is above the limit of the cell.",
        why="Forces of this size overload the tool, the clamping or the robot.",
        remedy="Reduce feed per tooth, depth or width of the cut on this line.",
    ),
    Code(
        code="GS513",
        severity=Severity.ERROR,
        title="Spindle speed outside its range",
        what="S asks for a speed that the spindle of the cell does not reach.",
        why="The control refuses the program, or turns at its limit and changes chip load and cutting speed.",
        remedy="Change S, or the limits of the spindle in the cell if they are wrong.",
    ),
    Code(
        code="GS520",
        severity=Severity.WARNING,
        title="Bead in the air",
        what="A bead was laid where nothing lies below it, and it does not rest on something at both of its ends.",
        why="It falls down, or curls up and is torn off by the nozzle.",
        remedy="Print a support or the layer below first; look for a layer that is missing, or a wrong height.",
    ),
    Code(
        code="GS521",
        severity=Severity.NOTE,
        title="Bridges",
        what="Stretches of bead lie over something empty and rest on something at both ends.",
        why="Bridges sag; how far depends on material, cooling and speed, which are not simulated.",
        remedy="Nothing for short bridges and for layers over sparse infill; support long ones.",
    ),
    Code(
        code="GS522",
        severity=Severity.WARNING,
        title="Printed beside the stock",
        what="Beads were laid where the stock, which is the bed of a print, has no columns.",
        why="They are not kept: volumes and shapes leave them out.",
        remedy="Make the stock as large as the print, or put it where the print is.",
    ),
    Code(
        code="GS523",
        severity=Severity.WARNING,
        title="No room below the nozzle",
        what="More material came out than fits under the nozzle and beside its bead.",
        why="It swells up beside the nozzle, which then runs into it.",
        remedy="Check the flow, `filament_diameter`, the height of layers and paths that lie on each other.",
    ),
    Code(
        code="GS524",
        severity=Severity.WARNING,
        title="Flow that the bead cannot be",
        what="Flow and speed give another cross-section than a bead of the width and height that the slicer's comments "
        "or the tool name.",
        why="Too little leaves gaps between beads, too much swells up.",
        remedy="Correct the flow, the speed, `filament_diameter`, or the size of the bead.",
    ),
)
