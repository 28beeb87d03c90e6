"""Findings GS1xx: a program says something that cannot be done."""

from gcodesim.diagnostics.catalogue.code import Code
from gcodesim.diagnostics.finding import Severity

CODES: tuple[Code, ...] = (
    Code(
        code="GS101",
        severity=Severity.ERROR,
        title="Axis words without a motion",
        what="X, Y, Z … stand in a block, but no motion code is active.",
        why="The control cannot know whether to move at rapid or to cut.",
        remedy="Write G0 or G1 into the block.",
    ),
    Code(
        code="GS102",
        severity=Severity.ERROR,
        title="Axis words claimed twice",
        what="Two codes of the block both want the axis words, as G1 and G92.",
        why="Only one of them can be meant.",
        remedy="Put the codes into two blocks.",
    ),
    Code(
        code="GS103",
        severity=Severity.ERROR,
        title="Axis words missing",
        what="The code needs at least one axis word.",
        why="Without one it would do nothing, so something was forgotten.",
        remedy="Add the axis words.",
    ),
    Code(
        code="GS104",
        severity=Severity.ERROR,
        title="Word that nothing uses",
        what=(
            "No code of the block uses this word. RS274 controls refuse the block; Fanuc passes over the word without "
            "a message, and of two G codes of one group takes the last, so there it is a warning."
        ),
        why="A forgotten code changes what the block does; dropping the word silently would hide it.",
        remedy="Add the code that the word belongs to, or remove the word.",
    ),
    Code(
        code="GS105",
        severity=Severity.ERROR,
        title="Word missing",
        what="A code lacks a word that it needs, as the P of G4.",
        why="The code cannot be executed.",
        remedy="Add the word.",
    ),
    Code(
        code="GS106",
        severity=Severity.ERROR,
        title="Value not allowed",
        what="A word has a value that its code does not take: negative, not whole, or out of range.",
        why="The control would refuse the block.",
        remedy="Correct the value.",
    ),
    Code(
        code="GS107",
        severity=Severity.ERROR,
        title="Feed missing",
        what="A feed move starts and F is 0, or under G93 the block has no F of its own.",
        why="The machine would stand still forever.",
        remedy="Write F before the move. G93, G94 and G95 discard the F before them when the mode changes.",
    ),
    Code(
        code="GS108",
        severity=Severity.ERROR,
        title="Spindle does not turn",
        what="The move depends on the spindle, but it stands still or turns the wrong way.",
        why="Feeds per revolution, threads and taps need a turning spindle.",
        remedy="Write S and M3 or M4 before the move.",
    ),
    Code(
        code="GS109",
        severity=Severity.ERROR,
        title="G53 used wrongly",
        what=(
            "G53 needs G0 or G1 in the same block, and G90. On Fanuc it is a rapid by itself, and in G91 the control "
            "passes over it: a warning."
        ),
        why="Machine coordinates make sense for straight moves only.",
        remedy="Write G90 G53 G0 X… .",
    ),
    Code(
        code="GS110",
        severity=Severity.ERROR,
        title="Arc described wrongly",
        what=(
            "The words of G2 or G3 do not describe an arc: centre and radius together, neither, or a centre "
            "outside the plane."
        ),
        why="The control cannot know where the arc goes.",
        remedy="Give I J K for the two axes of the plane, or R and an end point.",
    ),
    Code(
        code="GS111",
        severity=Severity.ERROR,
        title="Arc ends off its circle",
        what="Start and end of the arc have different distances from the centre.",
        why="The tool would have to jump; usually a sign or an offset of the centre is wrong.",
        remedy="Check I J K and the end point. Without G90.1 the centre counts from the start of the arc.",
    ),
    Code(
        code="GS112",
        severity=Severity.ERROR,
        title="Arc without a fitting radius",
        what="The radius is zero, or too small to reach the end point.",
        why="There is no such arc. Grbl goes straight to the end where that is the start, too (a warning).",
        remedy="Correct R or the end point.",
    ),
    Code(
        code="GS120",
        severity=Severity.ERROR,
        title="Parameter without a value",
        what="The program reads a named parameter or a variable that was never set, or a value that only the running "
        "machine knows, such as those of RepRapFirmware's object model.",
        why="Taking it for 0 would move the machine to a place that nobody chose.",
        remedy="Set it first, or ask with EXISTS[#<name>].",
    ),
    Code(
        code="GS121",
        severity=Severity.ERROR,
        title="Parameter number out of range",
        what="A parameter's number is not whole or not within 1 to 5601.",
        why="There is no such parameter.",
        remedy="Correct the number; an index that is computed may have gone astray.",
    ),
    Code(
        code="GS122",
        severity=Severity.ERROR,
        title="Parameter that cannot be set",
        what="The parameter shows the state of the machine, or stands in its INI file.",
        why="Writing it would not move the machine.",
        remedy="Use another parameter.",
    ),
    Code(
        code="GS123",
        severity=Severity.ERROR,
        title="Value that cannot be computed",
        what="A division by zero, a root of a negative number, a value beyond all bounds.",
        why="The word has no value.",
        remedy="Check the values that go into the expression.",
    ),
    Code(
        code="GS144",
        severity=Severity.WARNING,
        title="Value given beforehand without effect",
        what="A parameter was given a value before the program began (--set, or by a study), and nothing reads it.",
        why="The run is not the one that was asked for: all values that were tried would give the same part.",
        remedy="Read the parameter in the program, or remove the line that sets it anew.",
    ),
    Code(
        code="GS130",
        severity=Severity.ERROR,
        title="Flow that does not fit together",
        what=(
            "An O-word lacks its partner, is used twice, or stands where it cannot; on Fanuc a DO has no END, loops "
            "cross, or M99 leads nowhere; in RepRapFirmware an `else` has no `if`, a `break` no loop, or a variable is "
            "defined twice."
        ),
        why="The flow of the program is broken.",
        remedy=(
            "Give each if, while, do, repeat and sub a label of its own, closed with the same one; on Fanuc close DO m "
            "by END m, one inside the other."
        ),
    ),
    Code(
        code="GS131",
        severity=Severity.ERROR,
        title="Subroutine not found",
        what="The program calls a subroutine that is not in its file, beside it, or in a folder of subroutines.",
        why="The control would stop in mid-program.",
        remedy="Define it in the file, put its file beside the program, or name the folder in which it lies.",
    ),
    Code(
        code="GS132",
        severity=Severity.ERROR,
        title="Calls too deep",
        what="Subroutines call each other deeper than the control allows.",
        why="Mostly a subroutine that calls itself without an end.",
        remedy="End the recursion with an `if`.",
    ),
    Code(
        code="GS133",
        severity=Severity.ERROR,
        title="Too many arguments",
        what="A call has more than 30 arguments.",
        why="There are only 30 numbered parameters for them.",
        remedy="Pass the rest in global parameters #<_name>.",
    ),
    Code(
        code="GS134",
        severity=Severity.ERROR,
        title="Program does not end",
        what=(
            "The control is in exactly the state in which it was before, so the program goes on forever; or "
            "it executed more blocks, or made more moves, than the budget allows, and the hint says what "
            "still changes."
        ),
        why="Mostly a loop whose condition never becomes false.",
        remedy="Correct the loop; where it does end, raise --max-blocks.",
    ),
    Code(
        code="GS135",
        severity=Severity.ERROR,
        title="Reading took too long",
        what="The time limit was reached before the program ended.",
        why="Mostly a loop whose condition never becomes false.",
        remedy="Correct the loop, or raise the time limit.",
    ),
    Code(
        code="GS138",
        severity=Severity.ERROR,
        title="Probe without contact",
        what="G38.2 came to the end of its move without touching anything, or G38.4 without leaving what it touched.",
        why="The control stops the program there: the part is not where it was expected, or is missing.",
        remedy=(
            "Begin nearer to the surface, or probe further. G38.3 and G38.5 go on without contact; the program then "
            "asks #5070 whether there was any. `gcodesim check` probes the stock as it comes into the cell; only "
            "`gcodesim run` knows what the program itself has cut by then."
        ),
    ),
    Code(
        code="GS139",
        severity=Severity.ERROR,
        title="Probe begins in the wrong state",
        what="The probe touches something already where G38.2 or G38.3 begins, or nothing where G38.4 or G38.5 begins.",
        why="The control refuses the move and stops the program.",
        remedy="Back off before probing towards a surface; touch it before probing away from it.",
    ),
    Code(
        code="GS140",
        severity=Severity.ERROR,
        title="Canned cycle wrong",
        what="A drilling cycle lacks a word, or its values contradict each other.",
        why="The hole would be drilled wrong or not at all.",
        remedy="Give R and the depth, P where it dwells, Q where it pecks; R must lie above the depth.",
    ),
    Code(
        code="GS142",
        severity=Severity.ERROR,
        title="Corner that cannot be made",
        what=(
            "A chamfer ,C or a rounding ,R is put in where two feeds meet. Here there is no second feed in the plane, "
            "or the corner needs more of one of them than there is."
        ),
        why="The control stops with an alarm in the middle of the contour.",
        remedy="Write the move behind the corner into the next block, or make the corner smaller.",
    ),
    Code(
        code="GS148",
        severity=Severity.ERROR,
        title="No place to take a program up",
        what="A run or a file was asked for from this line on, and the control cannot be brought into the state that "
        "it has there: the line is inside a loop, a branch, a subroutine, a chain of cycles or arcs, cutter "
        "compensation, or a turned or tilted plane; or the program never comes to it.",
        why="A preamble sets modes, tool and place. What a control remembers of a loop or a contour it cannot set.",
        remedy="Begin at an earlier line that moves at rapid, best where the tool was changed; the hint names one.",
    ),
    Code(
        code="GS149",
        severity=Severity.WARNING,
        title="Not repeated when the program is taken up",
        what="The lines before have switched something, gripped parts, laid a film, homed Z of a printer or called a "
        "macro, which the preamble does not do.",
        why="What an M-code of the cell means is known to its builder alone, so nobody can say that it may come twice.",
        remedy="Bring clamps, grippers and the like into the state that the program expects there; on a printer, keep "
        "it switched on so that it knows its Z.",
    ),
    Code(
        code="GS150",
        severity=Severity.ERROR,
        title="Refused in cutter compensation",
        what="The code cannot be executed while cutter compensation is on.",
        why="The offset path would jump.",
        remedy="Switch the compensation off with G40 first.",
    ),
    Code(
        code="GS151",
        severity=Severity.ERROR,
        title="Cutter compensation left or entered wrongly",
        what="The first move is too short, or the move after G40 is an arc.",
        why="The tool cannot reach the offset path without marking the part.",
        remedy="Enter with a straight move longer than the tool radius, leave with a straight move.",
    ),
    Code(
        code="GS152",
        severity=Severity.ERROR,
        title="Corner or arc too tight for the tool",
        what="With compensation the tool does not fit into an inside corner or arc.",
        why="It would cut into the part.",
        remedy="Use a smaller tool, or larger radii.",
    ),
    Code(
        code="GS153",
        severity=Severity.ERROR,
        title="Cutter compensation cannot be switched on",
        what="The plane does not allow it, it is on already, or the diameter is missing.",
        why="The control would refuse the block.",
        remedy=(
            "Use G17 or G18 (on Fanuc G19 as well), write G40 before the other side, and give D the number of a tool "
            "in the table."
        ),
    ),
    Code(
        code="GS160",
        severity=Severity.ERROR,
        title="Tool not in the tool table",
        what="The program names a tool number that the table does not have.",
        why="The control would stop at the change, or use wrong lengths.",
        remedy="Add the tool to the tool table, or correct the number.",
    ),
    Code(
        code="GS170",
        severity=Severity.ERROR,
        title="Spline described wrongly",
        what="G5, G5.1, G5.2 or G5.3 lacks words or stands at the wrong place.",
        why="The curve is not determined.",
        remedy="G5 needs I J at the start of a chain and P Q always; G5.2 … G5.3 enclose the control points.",
    ),
    Code(
        code="GS175",
        severity=Severity.ERROR,
        title="Thread described wrongly",
        what="G33, G33.1 or G76 lacks words, or they contradict each other.",
        why="The thread would be wrong.",
        remedy="K is the travel per turn of G33 and G33.1; G76 needs P Z I J K.",
    ),
    Code(
        code="GS180",
        severity=Severity.ERROR,
        title="Probing impossible",
        what="The probing move is too short or moves rotary axes.",
        why="The control would refuse it.",
        remedy="Start further away from the end point.",
    ),
    Code(
        code="GS185",
        severity=Severity.ERROR,
        title="Polar words used wrongly",
        what="@ and ^ stand outside the XY plane, together with X or Y, or without an angle at the origin.",
        why="The end point is not determined.",
        remedy="Use polar words in G17, with the angle ^ when the tool is at the origin.",
    ),
    Code(
        code="GS190",
        severity=Severity.ERROR,
        title="Stopped by the program",
        what="The program itself asks to stop, by (ABORT, …).",
        why="It found a condition under which it must not go on.",
        remedy="See the message.",
    ),
    Code(
        code="GS191",
        severity=Severity.ERROR,
        title="Saved modes missing",
        what="M72 has nothing to restore, or M73 stands outside a subroutine.",
        why="Modes would stay as they happen to be.",
        remedy="Write M70 before M72; M73 only inside a subroutine.",
    ),
    Code(
        code="GS192",
        severity=Severity.WARNING,
        title="Spline without a starting direction",
        what="The first G5 of a chain has no I and J.",
        why="The curve leaves its start in a direction that nobody gave.",
        remedy="Give I and J, the first control point counted from the start.",
    ),
    Code(
        code="GS193",
        severity=Severity.WARNING,
        title="Tool change without a tool",
        what="M6 stands in the program, but no T word came before it.",
        why="The control would empty the spindle; the next cut runs without a tool.",
        remedy="Write the tool: T1 M6.",
    ),
    Code(
        code="GS194",
        severity=Severity.WARNING,
        title="Words that the control passes over",
        what=(
            "A block with M98 holds other codes, or L0; a block with M72 holds more than that; Grbl, which "
            "has no switch for it, meets M1; or a Fanuc block has a slash inside. In an M code of a printer, a value "
            "stands without its letter."
        ),
        why=(
            "What stands there is never done. L0 calls nothing, and yet the next M99 comes back to this "
            "block. Grbl does not stop at M1. Many Fanuc controls read nothing behind such a slash. `M203 80` "
            "leaves all speeds of a printer as they were."
        ),
        remedy="Put the other words into a block of their own; on Grbl write M0 to stop; write `M203 E80`.",
    ),
    Code(
        code="GS195",
        severity=Severity.NOTE,
        title="Tool length taken along by M6",
        what="The program never says G43 or G49, so M6 acts like M6 G43.",
        why="On a control without such a setting the lengths would be missing.",
        remedy="Write G43 after each M6, or set `tool_length: strict` in the cell.",
    ),
)

# what a control accepts and a machinist would not
CODES += (
    Code(
        code="GS136",
        severity=Severity.WARNING,
        title="Subroutine that nothing calls",
        what="The file defines a subroutine, and no line of it calls that name or number.",
        why="Mostly the call is misspelt or was lost, and a part of the job is missing.",
        remedy="Call it, or remove it. A file that holds a subroutine of its own name serves other programs.",
    ),
    Code(
        code="GS137",
        severity=Severity.WARNING,
        title="Lines behind the end",
        what="Blocks stand behind the M2 or M30 that ends the program, and nothing leads to them.",
        why="They never run: an M30 left over from a test cuts off the rest of the job.",
        remedy="Move the end behind them, or remove them.",
    ),
    Code(
        code="GS141",
        severity=Severity.WARNING,
        title="Word without effect in a canned cycle",
        what=(
            "On Fanuc a drilling cycle with K0 (or L0) stores its data and goes nowhere, yet the block names a place; "
            "or Q stands in a cycle that drills in one go."
        ),
        why="The hole that is written there is not drilled, or drilled without breaking the chip.",
        remedy="Leave K0 away to drill it, or the place to store the data only. G83 and G73 drill in steps of Q.",
    ),
    Code(
        code="GS154",
        severity=Severity.WARNING,
        title="Rapid along the contour",
        what=(
            "With cutter compensation on, a G0 goes sideways lower than where the last rapid went before it was "
            "switched on."
        ),
        why="The tool is at the contour there; a G0 in place of a G1 breaks it, or marks the part.",
        remedy="Retract first, or write G1. A rapid straight up sets a new safe height.",
    ),
    Code(
        code="GS155",
        severity=Severity.WARNING,
        title="Cutter compensation on at the end",
        what="The program ends in G41 or G42.",
        why="The tool stays beside the contour, and the last corner is not finished as the drawing has it.",
        remedy="Leave the contour and say G40 before the end.",
    ),
    Code(
        code="GS156",
        severity=Severity.WARNING,
        title="A corner is lost in cutter compensation",
        what=(
            "Between two moves of the contour stand more blocks without a move in the plane than the control reads "
            "ahead, or G41 or G42 is said once more."
        ),
        why=(
            "The control cannot work out where both offset paths meet: the tool goes to the end of the first move, and "
            "from there straight to the end of the next, into the part or away from it."
        ),
        remedy="Put one block between them at most, or set `compensation_blocks` to what the control reads.",
    ),
    Code(
        code="GS161",
        severity=Severity.WARNING,
        title="Length of another tool",
        what=(
            "G43 names an H that is not the number of the tool in the spindle. H twenty, thirty … above it counts as a "
            "second set of offsets of the same tool."
        ),
        why="The tip ends too high or too deep by the difference of the two lengths: scrap, or a crash.",
        remedy="Use the same number for T and H.",
    ),
    Code(
        code="GS162",
        severity=Severity.WARNING,
        title="Tool without its length",
        what=(
            "After a tool change the tool moves along Z or cuts before G43, in a program that uses G43 "
            "elsewhere. Moves to machine positions (G28, G30, G53) and probing do not count."
        ),
        why="M6 leaves the length of the previous tool in force; the new tip is off by the difference.",
        remedy="Say G43 H… in the first move along Z after each tool change.",
    ),
    Code(
        code="GS176",
        severity=Severity.WARNING,
        title="Cut with the spindle off",
        what=(
            "The spindle is off, and the tool is fed sideways, or down into a hole, no higher than where the"
            " same program cuts with the spindle on (or below part zero if all its cuts are). Or it is fed "
            "after M3 or M4 without any S. It is only a note if no cell says what the tool is, and a program"
            " that never says M3 or M4 goes down and along below part zero."
        ),
        why="A standing cutter is pushed into the material. M6 stops the spindle, so it has to be started again.",
        remedy="Write S and M3 or M4 before the cut.",
    ),
    Code(
        code="GS177",
        severity=Severity.WARNING,
        title="Spindle on after the end",
        what="The program ends with the closing % (Grbl: with its last line), which, unlike M2 and M30, stops nothing.",
        why="The spindle goes on turning when the operator opens the door.",
        remedy="Write M5, or end with M2 or M30.",
    ),
    Code(
        code="GS178",
        severity=Severity.WARNING,
        title="Filament drawn back while a bead should be laid",
        what="E falls while the head moves: on more than a quarter of the moves with filament, or by more than 25 mm,"
        " which no wipe does; or it falls by more than 1.5 m while the head stands, which no unloading does.",
        why="The control takes E words for places, so an E that begins anew, or counts steps, pulls filament out of"
        " the nozzle where it should push; the print fails at this line.",
        remedy="Write M83 where E words are steps, and G92 E0 where they begin anew.",
    ),
    Code(
        code="GS186",
        severity=Severity.WARNING,
        title="Unit changes in mid-program",
        what="G20 or G21 stands after cuts in the other unit.",
        why="Mostly two programs were put together; one number now means 25.4 times as much or as little.",
        remedy="Write the whole program in one unit and name it in the first lines.",
    ),
    Code(
        code="GS187",
        severity=Severity.WARNING,
        title="Shift of the origin left in force",
        what="The program ends while its G92 or G52 is in force; on Fanuc also G51, G51.1 or G68.",
        why="Controls keep it beyond the end, so the next program, or the same one again, runs at another place.",
        remedy="Cancel it before the end: G92.1, G52 of zero, G50, G50.1, G69. Work systems G54 … do not need it.",
    ),
    Code(
        code="GS196",
        severity=Severity.WARNING,
        title="Active comment passed over",
        what="A block has several comments, and one that is not the last would do something, as (MSG, …).",
        why="Controls keep the last comment of a block only, so the message never appears and the abort never comes.",
        remedy="Put the active comment last, or into a block of its own.",
    ),
    Code(
        code="GS197",
        severity=Severity.WARNING,
        title="Number read otherwise than it looks",
        what="A number has a blank inside, as in X5 5, or two signs, as in Y--5.",
        why="Controls drop blanks and multiply signs: X5 5 is X55. Mostly a letter was lost.",
        remedy="Write the missing letter, or the number in one piece with one sign.",
    ),
    Code(
        code="GS198",
        severity=Severity.NOTE,
        title="Tool without its length, as the program has it",
        what="The program only takes lengths away, by G49 or, where that is no length, G43 H0, and the tool in the"
        " spindle is long. It is an error if that tool cuts and the zero of its work system is not higher by as much.",
        why="The programmed positions are then those of the spindle nose, and the tip is lower by the length"
        " of the tool.",
        remedy="Say G43 H… after M6. Where Z is touched off with the tool, put its length into the work offset.",
    ),
)
