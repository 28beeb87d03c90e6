"""Findings GS6xx: what a test run finds different from what was accepted or expected; programs that wait in vain."""

from gcodesim.diagnostics.catalogue.code import Code
from gcodesim.diagnostics.finding import Severity

CODES: tuple[Code, ...] = (
    Code(
        code="GS601",
        severity=Severity.ERROR,
        title="Expected finding did not come",
        what="A test file or a comment of the program says that a finding comes here, and none does.",
        why="A check that has gone silent no longer protects anybody.",
        remedy=(
            "If the fault is mended, delete the expectation. If it moved, correct the line. Otherwise find "
            "out why the check no longer sees it; `gcodesim run` shows what it does see."
        ),
    ),
    Code(
        code="GS602",
        severity=Severity.ERROR,
        title="Value is not as expected",
        what="A quantity of the results lies outside what the test file allows under `expect: values`.",
        why="Somebody wrote down what this program has to do.",
        remedy="Mend the program or the cell, or correct the test file when the new value is right.",
    ),
    Code(
        code="GS603",
        severity=Severity.ERROR,
        title="Motion differs from what was accepted",
        what=(
            "A move or a state of the machine was added, removed or changed beyond tolerance. Numbering, "
            "comments, blanks and number formats do not count, nor do moves that are only divided "
            "differently."
        ),
        why="The machine will not do what it did when somebody looked at it.",
        remedy="Look at the pair of lines. `gcodesim accept` takes the new motion over, after showing what it takes.",
    ),
    Code(
        code="GS604",
        severity=Severity.ERROR,
        title="Result differs from what was accepted",
        what="A time, distance, volume, force or joint figure is further from the accepted one than its tolerance.",
        why="Cycle time, load or part changed, even where the program did not: a cell or a version may be the cause.",
        remedy=(
            "Compare with `gcodesim diff`. `tolerances:` in the test file says how much may differ; `gcodesim accept` "
            "takes the new result over."
        ),
    ),
    Code(
        code="GS605",
        severity=Severity.ERROR,
        title="Surface differs from what was accepted",
        what=(
            "Somewhere the stock is higher or lower than accepted, beyond the tolerance `surface`. Accepted surfaces "
            "are coarse: the place is that of a cell, and walls that move by less than a cell show in the volume only."
        ),
        why="The part has another shape.",
        remedy="Look at the place in the part. `gcodesim accept` takes the new surface over.",
    ),
    Code(
        code="GS606",
        severity=Severity.ERROR,
        title="Findings differ from what was accepted",
        what="A warning or error is new, gone, or has other numbers than when the results were accepted.",
        why="A new one is a new fault; one that is gone may mean that a check went silent.",
        remedy="Look at the finding. `gcodesim accept` takes the change over.",
    ),
    Code(
        code="GS607",
        severity=Severity.NOTE,
        title="Nothing accepted yet",
        what="The case has no accepted results beside it, so only its findings and its expectations are judged.",
        why="A change of motion, time or part would not be seen.",
        remedy="Look at the run, then `gcodesim accept` it and put the file under version control.",
    ),
    Code(
        code="GS608",
        severity=Severity.ERROR,
        title="Expectation cannot be read",
        what="A comment begins like an expectation, but is none.",
        why="A test that is not understood tests nothing.",
        remedy='Write `(expect: GS501)`, `(expect@+1: error GS401 "rapid move")`, or another word than `expect:`.',
    ),
    Code(
        code="GS609",
        severity=Severity.ERROR,
        title="Accepted results cannot be read",
        what="The file of accepted results is damaged, of another form, or was changed by hand.",
        why="Nothing can be compared with it.",
        remedy="Take the file from version control again, or `gcodesim accept` the case anew.",
    ),
    Code(
        code="GS610",
        severity=Severity.ERROR,
        title="Test has no program or no cell",
        what="A test file names a program or a cell that is not there, or none at all.",
        why="Nothing was tested.",
        remedy="Correct the name. Names are seen from the folder of the test file; `--cell` gives a cell for all.",
    ),
    Code(
        code="GS611",
        severity=Severity.ERROR,
        title="Expected quantity does not exist",
        what="A path under `expect: values` names nothing in the results of this run.",
        why="A value that is not there cannot be tested.",
        remedy="`gcodesim run --format json` shows all paths; entries of lists go by number or name: `tools.1.time_s`.",
    ),
    Code(
        code="GS612",
        severity=Severity.ERROR,
        title="Case cannot be run here",
        what="The case asks for something that this computer does not have, such as the world `bullet`.",
        why="Nothing was tested.",
        remedy="Install what is missing, or let the test file ask for `world: kinematic`.",
    ),
    Code(
        code="GS613",
        severity=Severity.ERROR,
        title="gcodesim failed on a case",
        what="The case ended in a fault of gcodesim or of a plugin, not of the program or the cell.",
        why="There is no verdict on it; those on the other cases stand. The exit status is 70.",
        remedy="Report it with the trace on stderr, the program and the cell.",
    ),
    Code(
        code="GS614",
        severity=Severity.ERROR,
        title="Part of a log cannot be read",
        what=(
            "A chunk or an attached file of a log does not agree with its checksum, or (a warning) the log ends before "
            "its time. What could be read was used."
        ),
        why="Tables, charts and pages have a gap there, and behind it the part may look older than it is.",
        remedy=(
            "`gcodesim info` tells what is damaged and which time it covers. Copy the file again, or run the"
            " program again: the same inputs give the same log."
        ),
    ),
    Code(
        code="GS615",
        severity=Severity.ERROR,
        title="Two tests have one name",
        what="Two test files, or two programs of one, would keep their accepted results in the same file.",
        why="Each would be compared with what was accepted for the other; so only the first one runs.",
        remedy="Rename a test file (NAME.test.yaml, NAME.test.yml) or a program.",
    ),
    Code(
        code="GS616",
        severity=Severity.ERROR,
        title="The run was interrupted",
        what="Somebody stopped the run: Ctrl-C, or a system that ended it (SIGTERM), as CI systems do at a time limit.",
        why="Log and results end there. They are whole as files, but say nothing about the rest of the program; "
        "nothing is compared with them and nothing is accepted.",
        remedy="Run the program again. A CI job that is cancelled needs a longer time limit.",
    ),
    Code(
        code="GS620",
        severity=Severity.ERROR,
        title="Programs wait for each other in a circle",
        what=(
            "Each of these channels waits for the next one: at a mark, or for a tool that the other has. The finding "
            "names the line of every one of them."
        ),
        why="None of them will ever go on. The machines stand still until somebody resets them.",
        remedy=(
            "Let all programs come to their marks in the same order. A channel that is not needed at a mark does not "
            "have to come to it: a mark is used only by programs that reach it. A tool that another program wants is "
            "put back (T0 M6) before waiting for that program; where no arm drives to stands, a change takes the new "
            "tool before it gives the old one back."
        ),
    ),
    Code(
        code="GS621",
        severity=Severity.ERROR,
        title="Program waits for one that has ended",
        what=(
            "A channel has come to a mark once more than another one that uses it, and that other program has ended. "
            "The n-th time of one program meets the n-th time of all others that use the mark. Or it waits for a tool "
            "that the other had in its spindle when it ended."
        ),
        why="The program waits for ever, and whatever stands behind it is never done.",
        remedy="Compare how often the loops of both programs come to the mark; both have to come equally often. A tool "
        "that others need is put back (T0 M6) before the end.",
    ),
    Code(
        code="GS622",
        severity=Severity.WARNING,
        title="Mark that no other program uses",
        what=(
            "A program comes to a mark at which no other program of this run ever waits. It goes on at once. Where "
            "only one program runs, this is a note."
        ),
        why="Where a wait was meant, this program starts too early: nobody has said that the way is free.",
        remedy=(
            "Compare the names of marks under `m_codes` of both channels: the name counts, not the M word. Name the "
            "programs of further channels with `--channel NAME=PROGRAM` or `program:` in the cell."
        ),
    ),
    Code(
        code="GS623",
        severity=Severity.ERROR,
        title="Two machines in one zone",
        what=(
            "Two programs have their machines in a zone of the cell at the same time. Of a machine, the lines between "
            "its joints count and its tool up to the flange; of a zone, the box around it. Looked at every 10 ms."
        ),
        why="A zone says where machines would run into each other. Nothing keeps them apart there.",
        remedy=(
            "Let the second program wait at a mark (`m_codes: {M200: {wait: zone_free}}`) to which the first one comes "
            "when it has left the zone."
        ),
    ),
    Code(
        code="GS624",
        severity=Severity.WARNING,
        title="One tool in two spindles",
        what=(
            "Two programs have the same tool of the cell in their spindles at the same time, because it is in one of "
            "them at the start (`loaded_tool`) or was put in by hand (M61). For an M6 a machine waits instead, until "
            "the tool is back."
        ),
        why="`tools:` lists what is there, and each tool is there once.",
        remedy=(
            "Give each machine a tool of its own, with a number of its own, or let both fetch it with M6 and put it "
            "back with T0 M6."
        ),
    ),
    Code(
        code="GS625",
        severity=Severity.ERROR,
        title="An empty stand",
        what="The program has the arm take a tool out of its stand, and the tool is not there: it was loaded or taken"
        " out by hand (`loaded_tool`, M61), and no tool change has put it back. The run goes on as if it were there.",
        why="The flange couples nothing, and the next cut is made with no tool.",
        remedy="Put the tool back with an M6, which drives to its stand, or take it to be on the flange at the start.",
    ),
    Code(
        code="GS626",
        severity=Severity.WARNING,
        title="A tool without a stand",
        what="The cell has stands to which the arm drives, and none for this tool. The tool is changed where the arm"
        " is, in the time of a tool change.",
        why="On the machine somebody has to bring the tool; the time of that is not counted.",
        remedy="Add the stand to `stands` of the magazine.",
    ),
    Code(
        code="GS627",
        severity=Severity.ERROR,
        title="Work moves under another program",
        what=(
            "An arm works in a system that stands on a positioner of another program, and that program moves it "
            "meanwhile. The arm goes to where the work stands at each of its waits and takes it to stand still until "
            "the next one; it does not follow a motion in between. Looked at every 10 ms."
        ),
        why="The tool is elsewhere on the work than the program says, and cuts there.",
        remedy=(
            "Let both programs come to a mark before the positioner moves and to another one when it has come to rest. "
            "Where the tool has to work while the positioner turns, let one program command both: `robot:` of the "
            "external names the arm that works there, and its letters become words of that program."
        ),
    ),
    Code(
        code="GS630",
        severity=Severity.ERROR,
        title="Run beyond a limit of its study",
        what="A figure of a run is on the side of a limit of `fail` on which it must not be.",
        why="The study says that no part is to be made with such values.",
        remedy="Keep to values whose runs stay within all limits: the table of the sweep has them.",
    ),
    Code(
        code="GS631",
        severity=Severity.ERROR,
        title="Input that cannot travel",
        what="A cell names a file by its absolute path.",
        why="Runs of a study are done wherever there is a worker, and no disk is shared: files travel by their names.",
        remedy="Put the file beside the cell, and name it relative to that.",
    ),
    Code(
        code="GS632",
        severity=Severity.ERROR,
        title="Run that was not done",
        what="Several workers died, one after the other, while they were doing this run.",
        why="It probably needs more memory than a worker has.",
        remedy="Give workers more memory or the stock a coarser resolution, then go on with --resume.",
    ),
)
