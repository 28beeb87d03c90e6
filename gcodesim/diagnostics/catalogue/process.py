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
        code="GS507",
        severity=Severity.WARNING,
        title="Switched on without its tool",
        what="A word that the cell maps to a tool or gripper (`{tool: activate}`, `{gripper: close}`), or an output or "
        "code that is the signal of one (`{beam: {word: M62 P0}}`), comes while the spindle is empty, or has a tool "
        "that it does not switch. Or a word has sensors read (`{camera: shoot}`), and none does: a camera in the "
        "magazine sees nothing.",
        why="Nothing is laid, sprayed, cut, gripped or seen, and a tool that is taken later begins switched on.",
        remedy="Put the tool change before the word. A gripper that holds its part through the program is named as "
        "`loaded_tool`.",
    ),
    Code(
        code="GS508",
        severity=Severity.WARNING,
        title="Switched on with nothing to work on",
        what="A tool that lays, cuts or burns is switched on, and the cell describes no `stock`.",
        why="Nothing is laid or taken, so the run says nothing about the part.",
        remedy="Describe the work as `stock`; of a print that is the bed, with room above it.",
    ),
    Code(
        code="GS509",
        severity=Severity.WARNING,
        title="A signal out of range",
        what="A word of the program sets a signal of a process to what it cannot be, such as a share above 1 or a flow "
        "below 0. The message gives the value after `per` and `zero` of the cell.",
        why="The output of the machine stops at its limit, or the process runs backwards; neither is simulated.",
        remedy="Correct the number in the program, or `per` of the signal in the cell.",
    ),
    Code(
        code="GS510",
        severity=Severity.ERROR,
        title="Spindle power exceeded",
        what="The mean cutting power of a revolution is above the limit of the cell. The message says for how long; "
        "where that is never more than 50 ms at a time, as in the blend of a corner, it is a note.",
        why="The spindle slows down or stalls in the cut; through a short peak its inertia carries it on.",
        remedy="Reduce feed, depth or width of the cut on this line; power grows with the removal rate.",
    ),
    Code(
        code="GS511",
        severity=Severity.ERROR,
        title="Spindle torque exceeded",
        what="The mean cutting torque of a revolution is above the limit of the cell. The message says for how long; "
        "where that is never more than 50 ms at a time it is a note.",
        why="The spindle slows down or stalls in the cut, the more so at low speed.",
        remedy="Reduce feed per tooth or depth, or use a cutter of smaller diameter.",
    ),
    Code(
        code="GS512",
        severity=Severity.ERROR,
        title="Process force exceeded",
        what="The mean force on the tool is above the limit of the cell. The message says for how long.",
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
        code="GS514",
        severity=Severity.WARNING,
        title="Tool changed while it is on",
        what="A tool goes back to its place while its process is switched on.",
        why="It goes on laying or burning on its way to the magazine, and the tool that comes begins switched on.",
        remedy="Switch it off before the change.",
    ),
    Code(
        code="GS515",
        severity=Severity.WARNING,
        title="Chips thicker than the tool takes",
        what="The thickest chip of a tooth is above the `chip_load` of its tool; run-out and thinning are included.",
        why="Edges chip off, and flutes that are full of chips break the tool.",
        remedy="Lower the feed, raise the speed, or correct `chip_load` and `runout` of the tool.",
    ),
    Code(
        code="GS516",
        severity=Severity.WARNING,
        title="Chips thinner than the tool needs",
        what="In whole moves the thickest chip of a tooth stays below the `chip_load` of its tool. In a narrow cut "
        "chips are thinner than the feed per tooth.",
        why="An edge that is pressed instead of cutting rubs, gets hot and wears.",
        remedy="Raise the feed by as much as the chip is thinner, or lower the speed.",
    ),
    Code(
        code="GS517",
        severity=Severity.WARNING,
        title="Cut that may chatter",
        what="The depth of cut is above the limit of stability at this speed, by the lobes of the mode in `dynamics` "
        "of the tool (Altintas and Budak 1995), taken as the same in both directions of the plane.",
        why="Waves on the surface grow from tooth to tooth: noise, marks, broken edges.",
        remedy="Cut less deep or less wide, or take a speed at which a tooth passes once in one, two, three … swings.",
    ),
    Code(
        code="GS518",
        severity=Severity.WARNING,
        title="Cut that chatters on the gears of its arm",
        what="In more than a tenth of the steps of 0.4 s of cutting or more the tip of the tool goes back against its "
        "command, since the links of the arm swing on the springs of their gears and the cut feeds the swing (mode "
        "coupling: Pan, Zhang, Zhu and Wang 2006). It is looked for in `bullet`, and with a `controller` "
        "in the cell: gears without mass do not swing.",
        why="The wall gets waves, edges break, and the gears are shaken.",
        remedy="Cut less deep or less wide, stand the arm where it is stiffer, or give measured values as `stiffness` "
        "and `gear_damping`.",
    ),
    Code(
        code="GS519",
        severity=Severity.NOTE,
        title="Blobs",
        what="Material comes out of a nozzle that stands: more filament than was drawn back before, or from a pump "
        "that runs. It stays there as a blob or, with nothing below, falls and is not kept.",
        why="Blobs are in the way of what comes next; what falls is in no volume of the part.",
        remedy="Nothing where the nozzle is primed or purged; else check retraction, E words and where the pump is "
        "switched.",
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
        what="More material came out than fits under the nozzle and beside its bead; or a bead of the tool's own size "
        "met material that was there already.",
        why="It swells up beside the nozzle, which then runs into it; beads of fixed size lose that part.",
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
    Code(
        code="GS525",
        severity=Severity.ERROR,
        title="Arc on in a rapid",
        what="The arc of a welding torch burns while a rapid moves it.",
        why="Drops of wire lie all over the part, and the arc strikes whatever is on the way.",
        remedy="Switch the arc off before the move, and on behind it.",
    ),
    Code(
        code="GS526",
        severity=Severity.WARNING,
        title="Arc on nothing",
        what="Wire is melted where no work is within the reach of the arc.",
        why="A real arc breaks there, or the drops fall through; that volume is not in the part.",
        remedy="Correct the path or its height. `reach` of the torch says how far from its tip the work may be.",
    ),
    Code(
        code="GS527",
        severity=Severity.WARNING,
        title="Weld bead higher than wide",
        what="Wire speed and travel speed give a section for which a bead of this width would be higher than wide.",
        why="A melt does not stand like that: it runs off to the sides.",
        remedy="Travel faster, feed less wire, or correct `bead_width` of the torch.",
    ),
    Code(
        code="GS528",
        severity=Severity.ERROR,
        title="Beads of a paste slump",
        what="A bead is higher than its paste stands as it leaves the nozzle: its own weight passes the yield stress,"
        " density g h / sqrt(3).",
        why="Concrete or clay that is too soft runs flat, and the wall is lost with its first layer.",
        remedy="Lay thinner beads, or use a stiffer paste. Its constants stand under `paste` of the extruder.",
    ),
    Code(
        code="GS529",
        severity=Severity.ERROR,
        title="Lowest beads of a paste yield",
        what="What was laid on the lowest beads weighs more than their yield stress carries at their age.",
        why="A wall that grows faster than its foot sets collapses. Buckling, which comes earlier in slender walls, is"
        " not computed.",
        remedy="Build more slowly, wait between layers, or use a paste that sets faster.",
    ),
    Code(
        code="GS530",
        severity=Severity.ERROR,
        title="Film too thin",
        what="What was sprayed on a body is thinner in places than the cell wants it; the message names the thinnest.",
        why="A thin film does not hide, protect or wear as it should.",
        remedy="Bring the passes nearer together, spray slower or with more flow, begin and end beyond the edges. "
        "`faces` and `inside` of the key `film` say where it counts.",
    ),
    Code(
        code="GS531",
        severity=Severity.ERROR,
        title="Film too thick",
        what="What was sprayed on a body is thicker in places than the cell allows; the message names the thickest.",
        why="A thick film runs, cracks, takes long to dry and costs paint.",
        remedy="Spray faster or with less flow; keep passes apart; do not turn round above the part.",
    ),
    Code(
        code="GS532",
        severity=Severity.WARNING,
        title="Paint runs",
        what="Wet film is thicker than what stays on a face as steep as that. All coats count as wet at once.",
        why="It flows down under its own weight and dries as tears and curtains.",
        remedy="Lay thinner coats and let them dry, use less solvent, or turn the part so that the face lies flatter.",
    ),
    Code(
        code="GS533",
        severity=Severity.WARNING,
        title="Spray on nothing",
        what="A gun was on for whole moves in which hardly anything of its spray met a body that is to be coated.",
        why="The paint is lost, and where a part should have been it stays bare.",
        remedy="Switch the gun off beside the part. If it should meet it: check where gun and part are, what stands "
        "between them, and that the faces of its mesh point outwards.",
    ),
    Code(
        code="GS534",
        severity=Severity.WARNING,
        title="Gun too near or too far",
        what="Film was laid from a distance that is not right for the gun.",
        why="From too near it is thick and runs; from too far it is dry, rough and mostly lost.",
        remedy="Correct the height of the passes, or `distances` of the gun if they are wrong.",
    ),
    Code(
        code="GS535",
        severity=Severity.ERROR,
        title="Gun on without flow",
        what="A gun is on and nothing flows: the tool has no `flow`, and no signal gives one.",
        why="The part stays bare.",
        remedy="Give the tool its `flow`, or set that of the program before the gun is switched on; `signals` of "
        "the cell say how: `flow: {word: M67 E0, per: 1 cm^3/s}`.",
    ),
    Code(
        code="GS536",
        severity=Severity.WARNING,
        title="Nothing to coat",
        what="The cell has a spray gun, and no body that it could coat.",
        why="Nothing is computed of what it sprays.",
        remedy="Describe the work as `stock` or under `parts`. A fixture is coated if it has the key `film`.",
    ),
    Code(
        code="GS537",
        severity=Severity.ERROR,
        title="Film too fine",
        what="The film of a body would need more faces than are allowed, so nothing was laid on it.",
        why="Each face costs memory and time.",
        remedy="Give a coarser `resolution` under `film` of the body; a third of the spread of the gun is fine enough.",
    ),
    Code(
        code="GS538",
        severity=Severity.WARNING,
        title="Cut after it was coated",
        what="A stock lost material after a gun had sprayed on it. Its film is told for the surface that it had then.",
        why="The film is gone where it was cut, which is not taken off.",
        remedy="Coat it after it is machined, or in a run of its own from what this one leaves (`stock: {from: DIR}`).",
    ),
    Code(
        code="GS539",
        severity=Severity.WARNING,
        title="Switched on in a rapid",
        what="An extruder or a spray gun is on while the machine goes from place to place in rapids.",
        why="It lays a thread or a stripe across the part, thinner than meant, since nobody chose the speed.",
        remedy="Switch it off before the rapid and on again behind it.",
    ),
    Code(
        code="GS540",
        severity=Severity.ERROR,
        title="Beam on in a rapid",
        what="A laser, jet, torch or blasting gun was on while the machine made a rapid move.",
        why="It marks or cuts a line across the work, and may strike what nobody expects it to.",
        remedy="Switch it off before the G0. With `laser_mode` in the cell the control does so by itself.",
    ),
    Code(
        code="GS541",
        severity=Severity.WARNING,
        title="Beam strikes nothing",
        what="A beam was on for whole moves in which none of it met the stock.",
        why="The path, the height or the place of the stock is wrong, or the beam is switched on too early.",
        remedy="Check `work_offsets`, Z and the place of the stock; switch the beam on where it begins to work.",
    ),
    Code(
        code="GS542",
        severity=Severity.WARNING,
        title="Tool is never on",
        what="A tool that is switched, such as a laser, an extruder, a torch or a spray gun, feeds along its path and "
        "is off all the time.",
        why="The part comes out untouched. Often the cell does not say which word switches the tool.",
        remedy="Name the word in the cell: `signals: {power: {word: S, per: 1 W}}`, `m_codes: {M10: {tool: activate}}` "
        "or `laser_mode`.",
    ),
    Code(
        code="GS543",
        severity=Severity.WARNING,
        title="Beam strikes far from its focus",
        what="The nearest place that a beam strikes is farther from where it is meant to strike than its `tolerance`.",
        why="Out of focus a laser is wide and weak; a jet loses its force, a torch its arc.",
        remedy="Correct the height of the tool, or `stand_off`, `focus` and `tolerance` if they are wrong.",
    ),
    Code(
        code="GS544",
        severity=Severity.WARNING,
        title="More power than there is",
        what="A word asks for more power than the tool has.",
        why="The machine gives what it has, or refuses; the cut is shallower than the program means.",
        remedy="Correct the power in the program, `per` of the signal, or `power` of the tool.",
    ),
    Code(
        code="GS545",
        severity=Severity.WARNING,
        title="Beam without gas",
        what="A beam cuts while the signal `gas` of the cell says that no gas flows.",
        why="Melt stays in the kerf, the lens gets dirty, and what is cut may burn.",
        remedy="Switch the gas on before the beam, and off after it.",
    ),
    Code(
        code="GS546",
        severity=Severity.NOTE,
        title="No removal without its energy",
        what="A beam gives energy to a material for which no specific energy is known, so nothing is removed; its dose "
        "is kept.",
        why="How much energy takes how much material depends on both; no figure is better than a wrong one.",
        remedy="Give the tool its `specific_energy`, from an own test: power times time over the volume that is gone.",
    ),
    Code(
        code="GS547",
        severity=Severity.WARNING,
        title="Beam strikes a fixture",
        what="In a move in which part of a beam goes by the stock, or through it, its axis meets a fixture.",
        why="A jet or a laser that is through the plate goes on, and cuts what holds it.",
        remedy="Move the fixture or the cut; let the plate lie on a grid that is meant to wear.",
    ),
    Code(
        code="GS548",
        severity=Severity.WARNING,
        title="Filament without a nozzle",
        what="E words push filament while the tool in the head is no extruder, or there is none.",
        why="Nothing is laid, so the run says nothing about the print: neither volume, nor beads in the air.",
        remedy="Describe the nozzle as a tool of type `extruder`, tool 0 for T0, or choose it with T before the first "
        "E word.",
    ),
    Code(
        code="GS549",
        severity=Severity.WARNING,
        title="Switched on with nothing to give",
        what="A tool is switched on while what it needs is 0 as long as it is in use: the flow of a pump, the speed of "
        "a wire, the opening of fingers. The cell gives it by a word that the program never says, or by S while the "
        "spindle stands.",
        why="Nothing is laid, or the fingers never open.",
        remedy="Say the word before the tool is switched on; S counts with M3 or M4. Or leave the signal out of the "
        "cell: then the value of the tool holds.",
    ),
    Code(
        code="GS560",
        severity=Severity.ERROR,
        title="A part is lost",
        what="Holding the part took more force than the gripper has, so it slipped out and fell. The force needed "
        "follows from its weight in the attitude of the tool and from the acceleration of its centre of mass.",
        why="A part that falls is lost, hits something, and whatever is done with it afterwards is done without it.",
        remedy="Accelerate less, give the gripper more `force` or `vacuum`, or more friction. Once a part slips it "
        "counts as lost, even if friction would catch it again.",
    ),
    Code(
        code="GS561",
        severity=Severity.ERROR,
        title="A gripper closes on nothing",
        what="The gripper was told to close, or its vacuum was switched on, where no part is between its fingers or "
        "under its cups. A cup holds only where all of its rim is on the part.",
        why="The program goes on without the part.",
        remedy="Compare the place of the part with that of the tip at this line; look for an earlier loss.",
    ),
    Code(
        code="GS562",
        severity=Severity.ERROR,
        title="A part is wider than the gripper opens",
        what="A part is between the fingers, but the opening that it takes about the tip is more than they have.",
        why="The fingers come down on the part.",
        remedy="Grip it nearer to its middle or across its narrow side, or use a gripper with more `stroke`.",
    ),
    Code(
        code="GS563",
        severity=Severity.ERROR,
        title="Two grippers take one part",
        what="A gripper closes on a part that another gripper holds. The part stays with the first one.",
        why="Two arms that hold one rigid part pull at each other.",
        remedy="Let the first gripper open before the second one closes; programs wait for each other at marks.",
    ),
    Code(
        code="GS564",
        severity=Severity.WARNING,
        title="A part is let go in the air",
        what="The gripper opened while the part was more than 0.5 mm above whatever is below it, so it fell. In the "
        "kinematic world it falls straight down to the next thing below; in `bullet` it is a free body.",
        why="A part that falls does not lie where the program puts it.",
        remedy="Go down until the part stands on something. What it stands on can be a fixture or another part; a "
        "place that has nothing drawn below counts as a level floor where a part stands there at the start or by its "
        "`goal`.",
    ),
    Code(
        code="GS565",
        severity=Severity.WARNING,
        title="A grip has too little reserve",
        what="The gripper holds the part, but with less of a reserve than its `safety` asks for.",
        why="Friction and vacuum vary; data sheets ask for a factor of 1.5 to 4.",
        remedy="Accelerate less, or use a stronger gripper.",
    ),
    Code(
        code="GS566",
        severity=Severity.NOTE,
        title="Program ends with a part held",
        what="A gripper holds a part when its program ends.",
        why="Somebody will take it, or the next program begins with it; this is only said.",
        remedy="Set it down before the end, if that is not meant.",
    ),
    Code(
        code="GS567",
        severity=Severity.ERROR,
        title="Tool changed while a part is held",
        what="The gripper goes into the magazine while it holds a part. The run leaves the part where the gripper had"
        " it on the flange, so what comes after that is of no use.",
        why="Without air or power from the flange a gripper opens, and the part falls into the magazine.",
        remedy="Set the part down and open the gripper before the tool is changed.",
    ),
    Code(
        code="GS580",
        severity=Severity.NOTE,
        title="An action has something to say",
        what="An M-code called an action in Python (`m_codes: {M150: {call: NAME}}`), and this is what it said.",
        why="It is the word of that action, not of gcodesim.",
        remedy="Nothing, or what the action asks for.",
    ),
    Code(
        code="GS581",
        severity=Severity.ERROR,
        title="An action found a fault",
        what="An M-code called an action in Python, and the action said that something is wrong at this moment.",
        why="It is the verdict of that action, not of gcodesim.",
        remedy="Do what the message asks for; lower the severity by `checks: {GS581: warning}` if it is only a remark.",
    ),
    Code(
        code="GS590",
        severity=Severity.WARNING,
        title="Sensor reads too often",
        what="A sensor that has to see the scene would read more than 10,000 times in this run; the rest is left out.",
        why="Each reading takes milliseconds, and stands whole in the log.",
        remedy="Give it a longer `period`, or have it read by words of the program where something is to be seen.",
    ),
    Code(
        code="GS591",
        severity=Severity.WARNING,
        title="Sensor has read nothing",
        what="A sensor of the cell was not asked in the whole run: it has no `period`, and no word of the program has "
        "it read; or it is a tool that was not in use when it was asked.",
        why="An inspection that never takes place looks like one that finds nothing.",
        remedy="Give it a `period` or a `trigger`, or map an M-code: `m_codes: {M110: {camera: shoot}}`.",
    ),
    Code(
        code="GS592",
        severity=Severity.WARNING,
        title="Wait for a sensor in vain",
        what="M66 waits for a light barrier or a proximity switch, and its time Q runs out before the sensor answers.",
        why="On the machine the program goes on with #5399 at -1, as if something had come; or it stands there.",
        remedy="Look at what should come and when, at the place of the sensor and at `normally_closed`; make Q longer.",
    ),
    Code(
        code="GS593",
        severity=Severity.WARNING,
        title="Sensor asked while other programs run",
        what="Several programs run at once, and one asks a sensor with M66. All are planned before anything moves: "
        "the sensor sees parts and machines as they stand at the start.",
        why="What the program then does may differ from what it does on the machine.",
        remedy="Let programs wait for each other at marks, which are planned in time.",
    ),
    Code(
        code="GS594",
        severity=Severity.WARNING,
        title="Sensor sees nothing",
        what="A camera or a scanner has read, and nothing was in front of it each time: its pictures are empty, no "
        "pixel has a depth.",
        why="An inspection of nothing looks like one that finds nothing.",
        remedy="Check where it stands and that Z of its frame points at the work; describe what there is to be seen as "
        "stock, fixtures or parts.",
    ),
)
