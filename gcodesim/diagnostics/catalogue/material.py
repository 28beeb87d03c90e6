"""Findings GS4xx: the stock and what runs into it."""

from gcodesim.diagnostics.catalogue.code import Code
from gcodesim.diagnostics.finding import Severity

CODES: tuple[Code, ...] = (
    Code(
        code="GS401",
        severity=Severity.ERROR,
        title="Rapid move through stock",
        what="A G0 move took away more material than the error bound of the simulated stock can explain.",
        why="At rapid speed a chip is many times thicker than a cutter can stand: the cutter breaks, or "
        "pulls the part out of the vise.",
        remedy="Retract higher before the move, or make it a feed move (G1). Check work offset and tool length if the "
        "height looks right; on machines that move rapids axis by axis, the path is not the straight line.",
    ),
    Code(
        code="GS402",
        severity=Severity.ERROR,
        title="Tool inside stock at the start",
        what="When the program begins, the tool already stands in the stock. It cuts nothing until it has left it.",
        why="On the machine this would be a crash before the first block; here it usually means that stock, work "
        "offset or home position of the cell do not belong together.",
        remedy="Check `stock`, `work_offsets` and `home` in the cell; the message says where the tip stands.",
    ),
    Code(
        code="GS403",
        severity=Severity.ERROR,
        title="Tool inside stock after a tool change",
        what="A tool was changed, or its length offset took effect, where the new tool stands in the stock.",
        why="The new tool would have to be pushed into solid material. It cuts nothing until it has left the stock.",
        remedy="Retract before M6, far enough for the longest tool.",
    ),
    Code(
        code="GS404",
        severity=Severity.ERROR,
        title="Shank in stock",
        what="The part of the tool above its flutes ran into material.",
        why="A shank rubs, burns and pushes the tool aside; it does not cut.",
        remedy="Use a longer flute or take the depth in steps that clear the walls; check `flute_length` of the tool.",
    ),
    Code(
        code="GS405",
        severity=Severity.ERROR,
        title="Holder in stock",
        what="The tool holder ran into material.",
        why="The holder collides with the full force of the drives; tool, spindle or part are damaged.",
        remedy="Use a longer tool or a slimmer holder, or cut less deep beside a wall; check `length` and `holder`.",
    ),
    Code(
        code="GS407",
        severity=Severity.ERROR,
        title="Cut while an axis of unknown place turns",
        what="A rotary axis of the machine has no `at`, so the cell does not say where it is: it costs time and moves "
        "nothing. The program cuts while this axis turns.",
        why="Where the tool meets the stock during such a move cannot be computed; volume and forces of these lines "
        "are those of a machine whose axis stands still.",
        remedy="Give the axis `at: [x, y, z]`, a point on its axis in machine coordinates, and `side`.",
    ),
    Code(
        code="GS408",
        severity=Severity.ERROR,
        title="Probe runs into stock",
        what="A probe enters the stock by a rapid or a feed that does not probe.",
        why="Nothing stops the machine there: the stylus breaks, and what it measures afterwards is wrong.",
        remedy="Go there with G38.3 (Fanuc: G31), which stops where it touches, or keep more distance.",
    ),
    Code(
        code="GS409",
        severity=Severity.WARNING,
        title="Drill mills sideways",
        what="A drill, spot drill, step drill, countersink, reamer, tap or boring bar takes material while it does not"
        " go along its axis: its path leaves that by more than a twentieth. The cut is simulated as if its sides had"
        " edges.",
        why="Such tools cut with their point or lead alone. Fed sideways they rub, run off and break.",
        remedy="Lift the tool before it goes across, or use a mill; for a groove or an edge with a spot drill say"
        " `type: chamfer_mill` in the cell.",
    ),
    Code(
        code="GS410",
        severity=Severity.ERROR,
        title="No stock of an earlier run",
        what="`stock: {from: …}` names a folder that holds no stock, or a damaged one.",
        why="Without it the next setup would start from the wrong part.",
        remedy="Name the folder that `gcodesim run --out` wrote, and run the earlier setup first.",
    ),
    Code(
        code="GS411",
        severity=Severity.ERROR,
        title="Stock too fine for the memory",
        what="The stock has so many cells at this `resolution` that they would not fit into memory.",
        why="The run would be killed by the system after minutes; so it does not begin.",
        remedy="Take the resolution that the hint names, or a smaller stock.",
    ),
    Code(
        code="GS412",
        severity=Severity.WARNING,
        title="Stock too coarse for a tool",
        what="Fewer than two cells of the stock lie across a cutter that feeds. Material goes by columns whose centre "
        "the cutter passes, so whole cuts may leave no trace.",
        why="Volumes, forces and the shape of the part are then far off, and the error bound does not cover it.",
        remedy="Take the `resolution` that the hint names. On a large stock with a fine tool, describe only the piece "
        "that is cut.",
    ),
    Code(
        code="GS413",
        severity=Severity.WARNING,
        title="Part beside its stock",
        what="A stock with `inside` takes the place of a part of another stock, but the two do not overlap.",
        why="A screw that lies beside its plate is never met; the cut in the plate feels the plate alone.",
        remedy="`xyz` of the part counts from the frame of the stock that it is inside of; `cell show` prints both.",
    ),
    Code(
        code="GS431",
        severity=Severity.ERROR,
        title="Back edge of a turning tool cuts",
        what="While a turning tool goes down a slope, its back edge, or an edge beside the cutting one, takes material "
        "that the tip does not reach.",
        why="The finished contour is gouged there, and the edge is made to cut on a side where it has no clearance.",
        remedy="Use an insert with a smaller tip angle (VBMT instead of CNMG), a holder with another lead angle, or "
        "turn the slope from the other side.",
    ),
    Code(
        code="GS432",
        severity=Severity.ERROR,
        title="Shank of a lathe tool in the work",
        what="The shank of a turning tool or a boring bar is inside of the material.",
        why="It cannot cut: it rubs, bends, or breaks.",
        remedy="Cut less deep, use longer edges, a thinner boring bar, or drill a wider hole before.",
    ),
    Code(
        code="GS433",
        severity=Severity.ERROR,
        title="Lathe tool in chuck or tailstock",
        what="The tool runs into the jaws of the chuck, or into the tailstock, that the stock names.",
        why="The jaws turn: tool and chuck are destroyed, and parts of them fly off.",
        remedy="Let the work stand out farther, end the cut earlier, or go to the tool change by another way.",
    ),
    Code(
        code="GS434",
        severity=Severity.ERROR,
        title="Drill beside the middle",
        what="A drill on a lathe feeds into the work beside the axis of the spindle.",
        why="The work turns about that axis, so the drill is bent and breaks; the hole that is shown is too wide.",
        remedy="Go to X0 first. Holes beside the middle need a driven tool: `driven: true`.",
    ),
    Code(
        code="GS435",
        severity=Severity.WARNING,
        title="Tool cuts nothing on this machine",
        what="A mill on a lathe that is not driven, a lathe tool on a machine whose work does not turn, or a beam, a "
        "jet, a torch or an extruder on a lathe, where the stock is a profile of revolution.",
        why="Its moves are run, but the material that it would take or add is as before.",
        remedy="Say `driven: true` for a driven tool of a lathe. Else put the work of that tool into a cell of its "
        "own, with the machine that does it; `stock: {from: out1}` takes what was turned there.",
    ),
    Code(
        code="GS436",
        severity=Severity.ERROR,
        title="Stock does not fit a lathe",
        what="The stock of a lathe is no cylinder, stands beside the axis of the spindle, or its bore is too wide.",
        why="A lathe keeps its stock as a profile of revolution about the axis of the spindle.",
        remedy="Give `cylinder: [diameter, length]`, for a tube `bore` as well, and leave X and Y of G54 at 0.",
    ),
    Code(
        code="GS440",
        severity=Severity.WARNING,
        title="A piece comes loose",
        what="A cut has parted a piece from its stock. It falls out of the stock with the step that frees it, so "
        "later moves cut air where it was; of what hung together before, the greatest piece stays. Pieces of less "
        "than 16 columns stay too, and so do parts of prints. The line is that of the move that freed it. In the "
        "`bullet` world the piece is a body of its own from then on, which falls onto what is below it and lies there, "
        "seen in the log and the replay; what a tool or a link does to it there is GS309.",
        why="A piece that nothing holds is caught by the cutter, thrown, or jammed below the head.",
        remedy="Leave tabs, hold it by a vacuum or tape, or cut it free last. After a laser or a jet, which is "
        "meant to cut free, this is a note.",
    ),
    Code(
        code="GS441",
        severity=Severity.ERROR,
        title="Gouge: less than the target is left",
        what="After the run, material of the target is missing, deeper than `tolerance`. Each place is one "
        "finding, with the greatest distance from the target's skin, the missing volume, the skin of the "
        "target that it spoils, and the lines whose tool made the faces there. The line of the finding is "
        "the first of those that went as deep as the place is deep; further lines that go there would gouge "
        "the part once this one is mended.",
        why="What was cut away does not come back: the part is scrap, or has to be welded.",
        remedy="Compare the end of that line with the drawing: a slipped digit, a missing retract, G0 in place "
        "of G1. If all is off by the same, look at the tool's diameter and length, at the work offset, "
        "and at `unit` and `in` of the target.",
    ),
    Code(
        code="GS442",
        severity=Severity.WARNING,
        title="Excess: more than the target is left",
        what="After the run, material stands farther than `tolerance` above the skin of the target. Each place "
        "is one finding. Its line is one that left the deepest face there; where no tool made that face, "
        "the line that came nearest, with the distance between both.",
        why="The part does not fit, and the next tool meets material that it was not meant to cut.",
        remedy="Look for an operation that is missing or was left out, for a tool that is too large for a "
        "corner, or for a path that ends early. Material that is meant to stay for a later set-up belongs "
        "into the target.",
    ),
    Code(
        code="GS443",
        severity=Severity.NOTE,
        title="Loose pieces beside the part",
        what="Bodies of the stock that hang together with nothing of the target are left at the end of the "
        "run. They do not count as excess.",
        why="On the machine a piece that is cut free may be thrown, or jam the cutter.",
        remedy="Leave tabs, hold the piece, or clear it away.",
    ),
    Code(
        code="GS444",
        severity=Severity.WARNING,
        title="Part not compared with its target",
        what="The cell has a `target`, but the finished part could not be compared with it, or not with all of "
        "it: the run ended early, the mesh is not closed, or the target stands out of the stock.",
        why="Nothing is known about the part where it was not compared.",
        remedy="Do what the message asks for. The place of the target is that of `in` and `xyz`; without `in` it "
        "is G54.",
    ),
)
