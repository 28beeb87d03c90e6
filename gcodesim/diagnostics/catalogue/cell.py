"""Findings GS7xx."""

from gcodesim.diagnostics.catalogue.code import Code
from gcodesim.diagnostics.finding import Severity

CODES: tuple[Code, ...] = ()

# the cell file itself
CODES += (
    Code(
        code="GS701",
        severity=Severity.ERROR,
        title="The cell is not YAML",
        what="The text breaks a rule of YAML, so nothing behind this place could be read.",
        why="Half of a cell would be a different cell.",
        remedy=(
            "Look at the line named here and at the one above: brackets and quotes closed, spaces instead of "
            "tabs, one column for the keys of one mapping, quotes around a text that contains `: ` or begins with"
            " a sign."
        ),
    ),
    Code(
        code="GS702",
        severity=Severity.ERROR,
        title="A key stands twice",
        what="Two lines of one mapping have the same key; `01` and `1`, or `m62p1` and `M62 P1`, are the same key too.",
        why="Other readers take the last one silently, and nobody sees which value holds.",
        remedy="Delete or rename one of them.",
    ),
    Code(
        code="GS703",
        severity=Severity.ERROR,
        title="A feature of YAML that cells do not use",
        what=(
            "Merge keys (`<<`), tags (`!!float`), a second document, keys that are lists, aliases that contain "
            "themselves or multiply the file."
        ),
        why="What a cell says should be visible where it stands.",
        remedy="Write the values out. Plain aliases (`&name`, `*name`) are allowed.",
    ),
    Code(
        code="GS704",
        severity=Severity.ERROR,
        title="Unknown key",
        what="A key that gcodesim does not read here, usually a misspelling or wrong indentation.",
        why="A misspelled key that is skipped would leave its default in force.",
        remedy=(
            "Take the suggestion, or see `gcodesim cell schema`. Keys that begin with `x-` are free for notes of "
            "your own."
        ),
    ),
    Code(
        code="GS705",
        severity=Severity.ERROR,
        title="Something is missing",
        what="A key that is needed is absent, or a key has no value.",
        why="There is no sensible default for it.",
        remedy="Write the key; the message says what it expects.",
    ),
    Code(
        code="GS706",
        severity=Severity.ERROR,
        title="A value of the wrong form",
        what=(
            "A list where a text is expected, a mapping where a number is, a list with too few or too many "
            "entries, or something else where `true` or `false` is expected."
        ),
        why="The value cannot be understood.",
        remedy="Write it as the message shows. YAML 1.2 knows `true` and `false`, not `on` and `yes`.",
    ),
    Code(
        code="GS707",
        severity=Severity.ERROR,
        title="Not a number",
        what=(
            "A number is expected. Numbers are decimal, with a point, without grouping: `10`, `0.25`, `9e5`; "
            "never infinite."
        ),
        why="`1_0`, `1,5` or `0x10` mean different things to different readers.",
        remedy="Write the number plainly, its unit behind it.",
    ),
    Code(
        code="GS708",
        severity=Severity.ERROR,
        title="A unit is missing",
        what=(
            "Only lengths, angles, counts and ratios may be plain numbers; every other quantity but 0 carries its unit."
        ),
        why="3000 may be W or rpm, mm/min or mm/s, and the wrong guess is off by a factor of sixty.",
        remedy="Write the unit behind the number; in a list, that of the last entry holds for those without one.",
    ),
    Code(
        code="GS709",
        severity=Severity.ERROR,
        title="A wrong or unknown unit",
        what="The unit measures something other than the key does, or does not exist.",
        why="A length of 10 deg has no meaning.",
        remedy="Take a unit that the message names; `gcodesim cell schema` prints the table.",
    ),
    Code(
        code="GS710",
        severity=Severity.ERROR,
        title="A value out of range",
        what="The number is outside what the key can mean, such as a negative length.",
        why="No machine, tool or stock has such a value.",
        remedy="Correct the number or its unit.",
    ),
    Code(
        code="GS711",
        severity=Severity.ERROR,
        title="A word that is none of the choices",
        what="The key expects one of a few words, or a text of a certain form.",
        why="The value cannot be understood.",
        remedy="Take one of the words in the message.",
    ),
    Code(
        code="GS712",
        severity=Severity.ERROR,
        title="A name that nothing has",
        what="The cell refers to a frame, link, robot, axis, material or model that is not there, or that moves.",
        why="What is meant cannot be found.",
        remedy="Correct the name, or define it; the message names similar ones.",
    ),
    Code(
        code="GS713",
        severity=Severity.ERROR,
        title="Frames stand in a circle",
        what="Each of these frames stands in the next one, and the last in the first.",
        why="None of them has a place in the world.",
        remedy="Let one of them stand in `world`.",
    ),
    Code(
        code="GS714",
        severity=Severity.ERROR,
        title="A file is missing",
        what="A file or folder that the cell names is not there or cannot be read.",
        why="The run would go on without a part of the cell.",
        remedy="Names are relative to the cell file; the message shows the path that was tried.",
    ),
    Code(
        code="GS715",
        severity=Severity.ERROR,
        title="A file outside the allowed folders",
        what=(
            "A cell may read files in its own folder, and in those that whoever runs gcodesim allows by --allow-path "
            "or GCODESIM_ALLOW_PATH. This holds for the folders of `packages:`, too, and behind symbolic links. "
            "Tests read programs and cells in the repository of the run (without one: in its folder), and where the "
            "command line names them."
        ),
        why="A cell or a test from elsewhere must not be able to read any file of this machine.",
        remedy="Move the file beside the cell, or run with `--allow-path DIR`.",
    ),
    Code(
        code="GS716",
        severity=Severity.ERROR,
        title="Not a mesh",
        what="The file is no mesh format that is read, is cut off, or holds no triangle.",
        why="The body would be missing.",
        remedy="Export it as STL (binary or ASCII) or OBJ.",
    ),
    Code(
        code="GS717",
        severity=Severity.WARNING,
        title="A mesh without a unit",
        what="Mesh files do not say whether a number is a millimetre, a metre or an inch; `mm` was assumed.",
        why="A vise a thousand times too large or small collides with everything or nothing.",
        remedy="Write `unit: mm` (or `m`, `in`) beside the mesh; the message shows its size.",
    ),
    Code(
        code="GS718",
        severity=Severity.WARNING,
        title="A mesh of a strange size",
        what="The mesh is a hundred times larger or smaller than the rest of the cell.",
        why="Mostly its unit is wrong.",
        remedy="Compare the size in the message with the real one and correct `unit`.",
    ),
    Code(
        code="GS719",
        severity=Severity.ERROR,
        title="Two keys contradict each other",
        what=(
            "Two keys of one mapping say the same thing in different ways, such as `box` and `mesh`, or `model` "
            "and `urdf`."
        ),
        why="It is not clear which one holds.",
        remedy="Delete one of them.",
    ),
    Code(
        code="GS720",
        severity=Severity.ERROR,
        title="An impossible tool",
        what=(
            "The tool's values contradict each other or geometry: a corner radius greater than the tool, "
            "flutes longer than the tool, an impossible point angle."
        ),
        why="Such a tool cannot be made; a simulation with another one in its place would be worth nothing.",
        remedy="Correct the value; `gcodesim cell show` prints what follows from the others.",
    ),
    Code(
        code="GS721",
        severity=Severity.ERROR,
        title="The step does not divide the log period",
        what=(
            "The simulation step is a whole number of nanoseconds and fits a whole number of times into the log period."
        ),
        why="Times would drift, and two runs would not be equal.",
        remedy="Take one of the rates in the message, or another log period.",
    ),
    Code(
        code="GS722",
        severity=Severity.ERROR,
        title="Nobody runs the program",
        what="The cell has neither a machine nor a robot, or several and does not say which one runs the program.",
        why="A program needs axes to move.",
        remedy="Write `machine:` or `robots:`; with several, `channels:` says which robot runs which program.",
    ),
    Code(
        code="GS723",
        severity=Severity.ERROR,
        title="Home outside the travel",
        what="An axis or joint starts outside its own limits.",
        why="The first move would already be a fault.",
        remedy="Correct `home`, or the travel.",
    ),
    Code(
        code="GS724",
        severity=Severity.ERROR,
        title="Stock without a place",
        what="On an arm, stock needs a frame (`in:`), or the channel `work_offsets`.",
        why="A machine tool has a travel in whose middle a part can be put; for an arm there is no such place.",
        remedy="Write `in:` with a frame of the cell, and `work_offsets: {G54: {in: …}}`.",
    ),
    Code(
        code="GS725",
        severity=Severity.NOTE,
        title="A work system was placed by a rule",
        what=(
            "The cell does not say where G54 is. With stock that has no place either, it is put in the "
            "middle of the travel; otherwise it is at machine zero."
        ),
        why="On the real machine you touch off the part; limits and rapids depend on where it lies.",
        remedy="Nothing, if only the part matters. Otherwise give `work_offsets: {G54: {xyz: […]}}`.",
    ),
    Code(
        code="GS726",
        severity=Severity.WARNING,
        title="A work system that leans against the machine",
        what=(
            "A work offset of a machine tool is tilted against its Z. Moves, arcs, cycles and compensation go by the "
            "axes of the system; the tool only turns where rotary axes turn it. On a lathe it is an error, and so is "
            "a system of Fanuc that is turned."
        ),
        why="Most controls only shift work systems and turn them about Z, so there the program runs somewhere else.",
        remedy="Lay the plane in the program (G68.2), or tilt the frame of the whole work.",
    ),
    Code(
        code="GS727",
        severity=Severity.NOTE,
        title="A code that no finding has",
        what="`checks` or `suppress` names a code that this version does not know.",
        why="A slip here would leave a severity unchanged without a word.",
        remedy="Compare with `gcodesim list codes`.",
    ),
    Code(
        code="GS728",
        severity=Severity.ERROR,
        title="The bullet world is not available",
        what="The cell asks for `world: bullet`, and pybullet is not installed.",
        why="What gravity, inertia and the limits of motors do to the motion comes from pybullet.",
        remedy="Install pybullet (there are wheels for Python 3.11 on x86-64 Linux), or write `world: kinematic`.",
    ),
    Code(
        code="GS729",
        severity=Severity.WARNING,
        title="A material whose source is in doubt",
        what="The constants of this material are listed, but their source is doubtful.",
        why="Forces may be wrong by a factor.",
        remedy="Take another material, or give constants of your own under `materials:`.",
    ),
)

CODES += (
    Code(
        code="GS731",
        severity=Severity.NOTE,
        title="The kinematic world runs, because pybullet is not there",
        what="The cell names no world and pybullet is not installed, so the robot follows its program exactly.",
        why="What gravity, inertia and the limits of motors do to the motion is left out; process forces and"
        " elastic gears are not.",
        remedy="Install pybullet (there are wheels for Python 3.11 on x86-64 Linux), or write `world: kinematic`.",
    ),
    Code(
        code="GS732",
        severity=Severity.WARNING,
        title="The tool table believes another length",
        what="The control's tool table and `tools:` of the cell give one tool different lengths.",
        why="The tip is off by the difference, on the machine as in the simulation: into the part or into the air.",
        remedy="Measure the tool, and correct the tool table or `length` in the cell.",
    ),
    Code(
        code="GS733",
        severity=Severity.NOTE,
        title="A suppression without effect",
        what="An entry of `suppress` covers this program, or all programs, and matches none of its findings.",
        why="It may hide tomorrow what nobody has looked at; or the finding has moved by now.",
        remedy="Remove the entry, or correct its code, line, N number or block.",
    ),
    Code(
        code="GS734",
        severity=Severity.WARNING,
        title="Stock out of reach",
        what=(
            "The whole stock lies where no tool of the cell can come: beyond the travel of an axis, or farther away "
            "than all links of the arm and the longest tool in one line."
        ),
        why="Nothing would be cut, whatever the program says. Mostly a unit, a sign or a frame is wrong.",
        remedy="Look where `gcodesim cell show` puts stock and work systems, and correct the place.",
    ),
    Code(
        code="GS735",
        severity=Severity.ERROR,
        title="An action that nothing receives",
        what="`m_codes` says what an M-code does, and no process of the cell's tools takes it: the tool is missing.",
        why="The code would be accepted and do nothing: no bead, no grip, and no word about it.",
        remedy="Add the tool that is meant to `tools:`, or delete the entry.",
    ),
)

# the output folder
CODES += (
    Code(
        code="GS736",
        severity=Severity.ERROR,
        title="Python of the cell is not run",
        what="The cell names a Python file under `code`, and nobody has allowed it to be run.",
        why="Whoever can write a cell could otherwise do on this machine whatever you may do.",
        remedy="Read the file. If you trust it, give the command `--allow-code`, or a function of your own program "
        "`allow_code=True`. Nothing in a cell or a program can do that for you.",
    ),
    Code(
        code="GS737",
        severity=Severity.ERROR,
        title="Python of the cell cannot be used",
        what="A file under `code` failed when it was run, adds nothing, or adds a name that is taken.",
        why="Without what it adds the cell is not what it is meant to be.",
        remedy="Mend the line that the message names. A file adds classes with a `kind` below Tool, Process, Sensor, "
        "Controller or WordAction, and objects Material.",
    ),
    Code(
        code="GS738",
        severity=Severity.WARNING,
        title="A rake that corrects no force",
        what="A tool says the rake of its edges, and the table of a material does not say for which rake it holds.",
        why="Forces are those of the table, whatever rake the tool has: about 1 % a degree too high or too low.",
        remedy="Give constants of your own under `materials:`, with the `rake` of the edges that they hold for.",
    ),
    Code(
        code="GS750",
        severity=Severity.ERROR,
        title="The run would overwrite a file",
        what="The output folder already has a file that the run would write. It is one that the run reads, or"
        " one that gcodesim did not write.",
        why="Your own mesh, or the stock of an earlier run, would be lost. Nothing was simulated.",
        remedy="Name another folder with `--out`. With `--force` the file is overwritten.",
    ),
    Code(
        code="GS751",
        severity=Severity.ERROR,
        title="Two runs into one folder",
        what="Another run that has not ended writes into the output folder.",
        why="The files of both would be mixed. Nothing was simulated.",
        remedy="Wait for the other run, or name another folder with `--out`.",
    ),
    Code(
        code="GS752",
        severity=Severity.NOTE,
        title="The cell was made from the program",
        what="`--cell auto` was given, so dialect, machine, tools and stock are those that `gcodesim init --from` "
        "would write for this program. The message names what is only a guess.",
        why="Forces, removed volume and collisions are those of the guessed tools and stock. The real ones may differ.",
        remedy="The run writes this cell into its folder as `cell.yaml`. Check every line of it, and name it with "
        "`--cell` from then on.",
    ),
)

# robot descriptions (URDF, MJCF)
CODES += (
    Code(
        code="GS760",
        severity=Severity.ERROR,
        title="The robot description cannot be read",
        what="The file that `urdf:` or `mjcf:` names is missing, is not well-formed XML, is of another kind, or MuJoCo "
        "refuses it.",
        why="Without a description there is no robot that could move.",
        remedy=(
            "Check the path and the line named here. A xacro template has to be expanded first: `xacro FILE > "
            "robot.urdf`. The command comes with `pip install 'gcodesim[xacro]'`. An MJCF is read by MuJoCo's own "
            "loader: `pip install 'gcodesim[mjcf]'`."
        ),
    ),
    Code(
        code="GS761",
        severity=Severity.ERROR,
        title="A mesh of the robot is missing",
        what="A <mesh>, or an MJCF, names a file that is not there, or a package whose folder is not known.",
        why="The link would be invisible and would collide with nothing.",
        remedy="Correct the file name, or name the folder of a package:// address under `packages:` in the cell. "
        "A package is also found if its folder is above the URDF, or beside a folder above it.",
    ),
    Code(
        code="GS762",
        severity=Severity.ERROR,
        title="A mesh lies outside the folders that may be read",
        what="A <mesh>, or an MJCF, names a file outside the cell's folder and the folders of --allow-path.",
        why="A description from elsewhere must not make gcodesim read any file of this machine.",
        remedy="Move the mesh beside the cell, or allow its folder with --allow-path.",
    ),
    Code(
        code="GS763",
        severity=Severity.WARNING,
        title="A joint has no limits",
        what="A joint has no <limit>, an empty travel, or no speed (no MJCF has any); what is missing is unlimited.",
        why="The program may drive the joint where, or as fast as, the real one cannot go, and nothing would say so.",
        remedy='Write `<limit lower="…" upper="…" velocity="…" effort="…"/>` from the data sheet; rad, m, rad/s, N·m. '
        "Beside `mjcf:`, write `speed:`.",
    ),
    Code(
        code="GS764",
        severity=Severity.ERROR,
        title="Links and joints make no tree",
        what=(
            "A joint names a link that is not there, two joints hold one link, a name is used twice, or there is "
            "not one root."
        ),
        why="The pose of the flange is defined only by one unbroken chain from one base.",
        remedy=(
            "Correct the `parent` and `child` of the joints; every link but the base is the child of exactly one joint."
        ),
    ),
    Code(
        code="GS765",
        severity=Severity.ERROR,
        title="A value in the robot description cannot be",
        what=(
            "An attribute is not a number or not as many numbers as it should be, a body is unknown, or the axis "
            "of a joint that moves is zero."
        ),
        why="Guessing a dimension would move the tool somewhere else than on the real robot.",
        remedy="Write plain decimal numbers in m, rad and kg, separated by spaces.",
    ),
    Code(
        code="GS766",
        severity=Severity.ERROR,
        title="A kind of joint that is not simulated",
        what="A joint is floating, planar or a ball, or follows another one inside the chain to the flange; or a loop "
        "of bodies is closed there.",
        why="The flange would not go where the real one goes.",
        remedy="Describe the robot with revolute, continuous, prismatic and fixed joints, each driven by itself. If "
        "the tool hangs on a link before the joint named here, write `flange: LINK` beside `urdf:`.",
    ),
    Code(
        code="GS767",
        severity=Severity.ERROR,
        title="Nothing in the robot description can move",
        what="All joints between the base and the flange are fixed.",
        why="A program needs at least one axis.",
        remedy="Check the joint types, and that a link named `tool0`, `flange` or `tcp` stands at the end of the arm; "
        "`flange: LINK` beside `urdf:` names another one. A body that nothing moves is a fixture.",
    ),
    Code(
        code="GS768",
        severity=Severity.NOTE,
        title="A joint stands still",
        what=(
            "A movable joint is not on the way from the base to the flange (a finger, a second arm); it stays at zero."
        ),
        why="Its link is drawn and collides where it stands at zero.",
        remedy="Nothing, if that is meant; describe a gripper as a tool of its own.",
    ),
    Code(
        code="GS769",
        severity=Severity.NOTE,
        title="A moving link has no mass",
        what="A link that moves has no <inertial>, so joint efforts do not contain its weight and inertia.",
        why="Margins to the torque limits look better than they are.",
        remedy="Add <inertial> with mass, centre of mass and inertia from the maker or an estimate.",
    ),
    Code(
        code="GS770",
        severity=Severity.WARNING,
        title="A body that cannot be drawn",
        what="A mesh file of the robot or of a tool is damaged, or of a kind that cannot be read; or a body of an MJCF "
        "is a plane, an ellipsoid or a field of heights.",
        why="Everything moves as it should, but the log does not show this link, and collisions do not see it.",
        remedy="Convert the mesh to STL or OBJ. Collada files (.dae) are read with `pip install 'gcodesim[dae]'`.",
    ),
    Code(
        code="GS771",
        severity=Severity.NOTE,
        title="Where the tool hangs was chosen",
        what="No link of the robot description is called `tool0`, `flange` or `tcp` (of an MJCF: `attachment_site`), "
        "and the cell names none; the tool hangs on the end of the longest chain of links.",
        why="On a description with fingers, the longest chain may end at a finger.",
        remedy="Write `flange: LINK` beside `urdf:`, with the link whose Z axis points out of the flange.",
    ),
)
