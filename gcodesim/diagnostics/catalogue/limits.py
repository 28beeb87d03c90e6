"""Findings GS2xx: what a machine cannot do, or not as fast as the program asks."""

from gcodesim.diagnostics.catalogue.code import Code
from gcodesim.diagnostics.finding import Severity

CODES: tuple[Code, ...] = (
    Code(
        code="GS201",
        severity=Severity.ERROR,
        title="Travel exceeded",
        what="A move takes an axis beyond its travel. What counts is the axis itself, that is, the programmed"
        " point plus the active tool length offset, in machine coordinates; arcs count with their bulge.",
        why="The control refuses the block or the axis runs into its limit switch, often late in a long job.",
        remedy="Shift the part as the hint says, choose a shorter tool, or set the program's zero elsewhere."
        " Check `travel` of the axis in the cell and the active work offset.",
    ),
    Code(
        code="GS202",
        severity=Severity.ERROR,
        title="Out of reach",
        what="From a point of this block on, the arm cannot bring the tool there: the wrist centre would be farther"
        " from the shoulder than upper arm and forearm together, or closer than they can fold.",
        why="The robot stops in the middle of the block, with the tool in the cut.",
        remedy="Move the part or the base as the hint says, tilt the tool, or use a longer one.",
    ),
    Code(
        code="GS203",
        severity=Severity.ERROR,
        title="Joint limit",
        what="The pose can be reached, but a joint would have to turn beyond its limit, with the spin of the tool"
        " that suits the whole program best.",
        why="The robot stops in the middle of the block.",
        remedy="Move or turn the part, start from another configuration (`home`), or let `spin` be free.",
    ),
    Code(
        code="GS204",
        severity=Severity.WARNING,
        title="Singularity slows the tool",
        what="Near this point the arm loses a direction of motion: a joint would have to move faster than it can, and"
        " the feed falls below half of what is programmed.",
        why="The tool dwells in the cut, chips become thin, marks remain; some controls stop with a fault.",
        remedy="Keep the path away from the singularity: shift the part, tilt the tool, or start from another"
        " configuration (`home`).",
    ),
    Code(
        code="GS205",
        severity=Severity.ERROR,
        title="Arm has to flip",
        what="The path can only be continued with the arm in another configuration (elbow, wrist, shoulder or turn of"
        " an axis), which cannot be reached without leaving the path.",
        why="The robot stops, or swings through the cell.",
        remedy="Split the program with a rapid at a safe height, or start from another configuration (`home`).",
    ),
    Code(
        code="GS206",
        severity=Severity.NOTE,
        title="Feed above what the machine can do",
        what="The programmed feed is more than the axes or joints allow in this direction; the block runs slower.",
        why="Machining time and chip load differ from what the program intends.",
        remedy="Nothing, if this is known; otherwise program the feed that the machine can do.",
    ),
    Code(
        code="GS207",
        severity=Severity.ERROR,
        title="No such axis",
        what="The program moves an axis that this machine does not have.",
        why="The control refuses the block; here the word has no effect.",
        remedy="Add the axis to the cell, or choose a post-processor for this machine.",
    ),
    Code(
        code="GS208",
        severity=Severity.ERROR,
        title="Feed is zero",
        what="A feed move has no speed: F is 0, or the feed is per revolution and the spindle stands.",
        why="The machine would wait in this block forever. Here the block is run as slowly as 1 mm/min.",
        remedy="Program F, or start the spindle before the block.",
    ),
    Code(
        code="GS209",
        severity=Severity.ERROR,
        title="Thread faster than its axes",
        what="A thread or a rigid tap needs pitch times spindle speed, and the axes cannot go so fast.",
        why="The axis falls behind the spindle: the pitch is wrong, or the tap breaks.",
        remedy="Turn the spindle more slowly on this line; the hint says how slowly.",
    ),
    Code(
        code="GS210",
        severity=Severity.NOTE,
        title="Limits of a printer are assumed",
        what="The program does not say how fast its printer may speed up and pass corners. Values were taken from the "
        "slicer's settings in its comments, or from the defaults of the firmware.",
        why="The printing time depends on them, above all with many short moves.",
        remedy="Let the slicer write the limits (M201, M203, M204, M205, or SET_VELOCITY_LIMIT), write them at the "
        "top of the program, or say in the cell what the printer is set to (`firmware`).",
    ),
    Code(
        code="GS211",
        severity=Severity.NOTE,
        title="A rapid on a bent way",
        what="The machine's axes go at their own speed in a rapid (`rapids: independent`). The one with the shorter way"
        " is there first, so the tool does not go straight from one end to the other.",
        why="A straight line that clears a clamp or a wall may not be what the machine does. Here the bent way is"
        " timed, cut and checked for collisions.",
        remedy="Nothing, if no collision is found. Otherwise go up before going across, or write `rapids: linear` if"
        " the control interpolates its rapids.",
    ),
    Code(
        code="GS212",
        severity=Severity.WARNING,
        title="The tool turns on the spot",
        what="Within one feed move of the tip, a rotary axis turns by far more than the direction of the tool in the"
        " work changes: it rewinds, the axes change their branch, or the tool passes the pole. On an arm, a joint turns"
        " by so much more than the tool within 20 mm of a feed: its wrist flips beside a singularity. Where a joint is"
        " too slow for that, GS204 says so instead.",
        why="The other axes swing along with it while the tool hardly moves on: it rubs or gouges, and the block"
        " takes longer than its feed says.",
        remedy="Retract before the turn and come back after it, command the other branch from the start, or tilt the"
        " work so that the tool keeps clear of the axis.",
    ),
    Code(
        code="GS215",
        severity=Severity.NOTE,
        title="Configuration searched over the whole path",
        what="With the configuration of the arm nearest to home, and one spin of the tool for the whole program, the"
        " path cannot be run, or the arm hits something. A search over all configurations, turns of joints and spins"
        " along the path has found another way.",
        why="The arm moves otherwise than a control would by itself: start the program on the machine from the same"
        " joints, and let the tool turn as here.",
        remedy="Nothing, if the machine is run with these joints. `configuration` of the robot or `spin` of the"
        " orientation pins what is wanted; a part that lies more conveniently needs no search (`gcodesim place`).",
    ),
    Code(
        code="GS216",
        severity=Severity.ERROR,
        title="No configuration leads through",
        what="No configuration of the arm (shoulder, elbow, wrist, whole turns of joints, spin of the tool where it is"
        " free) leads through this part of the path without a jump, although each pose alone can be reached. The"
        " message names the longest part that can be run, by its share of the way, and what the arm would have to do to"
        " go on: pass a limit, jump, as at a singularity, or hit a link, a fixture or the stock as it is at the start."
        " It stands for limits and jumps on all of that part of the path (GS203, GS205). Where the arm cannot but hit"
        " something, the collision itself (GS301 to GS307) says this in its hint, and no GS216 stands beside it. A part"
        " of the path on which a tool is in a fixture does not count as one that can be run; but where the arm hits"
        " nothing and the tool does, no configuration is to blame, and the collision says where it begins.",
        why="The robot stops there, or swings through the cell.",
        remedy="Shift the part (`gcodesim place` searches), tilt the tool, let its spin free, or split the program with"
        " a rapid at a safe height.",
    ),
    Code(
        code="GS217",
        severity=Severity.WARNING,
        title="Feed away from the surface",
        what="The tool axis is the normal of a surface (`tool_axis: normal of …`), and a feed is farther away from"
        " that surface than `within` of the orientation, all along its block. The tool stands on the normal of the"
        " place that is nearest.",
        why="Far away, the nearest place may be an edge or the other side: the tool leans by a part that is not meant.",
        remedy="Look at where the body stands, and at the work system. Raise `within` where so much distance is meant,"
        " as of a spray gun.",
    ),
    Code(
        code="GS218",
        severity=Severity.WARNING,
        title="Surface leaves the tool axis open",
        what="The tool axis is the normal of a surface, and beside this place the surface faces ways more than 120"
        " degrees apart: the edge of a thin sheet, a point. Their mean says little about where the tool should stand.",
        why="The tool swings over the edge, and a small change of the path sends it another way.",
        remedy="Lift the tool and go to the other side by a rapid, give the axis in the block (I J K under G43.5), or"
        " take a smaller `smooth`.",
    ),
    Code(
        code="GS219",
        severity=Severity.ERROR,
        title="Tool cannot stand on the surface",
        what="The tool axis is the normal of a surface, and no position of the rotary axes within their travel brings"
        " the tool there. It stays at the end of the travel, as near as it can. The message names the direction on"
        " these feeds that is farthest beyond, and the axis that would have to go there. Of an arm GS202, GS203 or"
        " GS216 says it, with the joint.",
        why="The tool does not stand on the surface there, and its side or holder may meet it.",
        remedy="Clamp the work so that this side faces the tool, or lean the tool back with `lead` and `tilt`.",
    ),
    Code(
        code="GS230",
        severity=Severity.ERROR,
        title="Joint effort at its limit",
        what="Gravity, inertia and process together ask a joint for more torque or force than its motor can give. It is"
        " a note where a world with motors has them at their limit for 0.05 s at most at a time. Before a run, `check`"
        " tells it where weight alone is too much: of links, tool and payload, with the arm at rest on its path or at"
        " `home`.",
        why="The joint falls behind its command: the tool leaves its path, or the control stops with a servo error.",
        remedy="Take less depth, width or feed on this line, accelerate less, or move the part to where the arm is less"
        " stretched. Check `effort` of the joint in the URDF or the cell when the limit looks wrong.",
    ),
    Code(
        code="GS231",
        severity=Severity.NOTE,
        title="Slowed for a motor",
        what="Speeds and accelerations of the joints would allow a quicker motion, but a motor could not give its"
        " torque or force: weight, inertia, payload, tool and its `load`, and the friction and rotors of a `controller`"
        " need more than the effort limit. The motion is slowed there until they do not; the message names the least"
        " share of the acceleration that is left. How deep a tool cuts no plan knows before the run: of its process,"
        " only `expected_force` of the tool counts, in feed moves and from the worst side. Where a motor could not"
        " bear that even at rest, another note says so, and the motion is as slow as for what it just can.",
        why="Machine time is longer than speeds and accelerations alone say.",
        remedy="Nothing, if the time is right. A lighter tool or payload, or a part nearer to the arm, makes it"
        " quicker. Check `effort` of the joint in the URDF, `payload` and `expected_force` if the torque looks wrong.",
    ),
    Code(
        code="GS232",
        severity=Severity.ERROR,
        title="A tool stand out of reach",
        what="The arm cannot bring its flange to the stand of a tool, to where it waits before it, or to where the tool"
        " has left it: out of reach, or a joint would leave its travel. The message says which and why. The run changes"
        " the tool where the arm is.",
        why="The control stops on the way to the stand.",
        remedy="Move or turn the stand (`stands` of the magazine): its place is that of the flange, whose Z points into"
        " the tool.",
    ),
)
