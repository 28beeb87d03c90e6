"""JSON Schema of the results of a run or a check."""

from __future__ import annotations

from typing import Final

from gcodesim.declarations.kind import Json
from gcodesim.formats.json_schema import (
    array,
    choice,
    nullable,
    number,
    optional,
    record,
    ref,
    table,
    text,
    truth,
    whole,
)

LINE: Final = nullable(whole("line of the program", least=1))
WHOSE: Final = optional(text("of several programs at once, whose"))


def results() -> Json:
    """`results.json`, and `run` and `check` with `--format json`; `finding` is a definition of the document."""
    hashed = record("a file that was read", name=text("its name"), sha256=text("hash of its bytes"))
    return record(
        "a run or a check",
        schema=choice("name of this form", "gcodesim-results/1"),
        status=choice("`findings`: one at or above --fail-on; `failed`: stopped early", "ok", "findings", "failed"),
        stopped_at=nullable(
            record("where a run stopped before the end", file=text("the file"), line=whole("the line"))
        ),
        inputs=_inputs(hashed),
        findings=array("all findings by place", ref("finding", "a finding")),
        time=_times(),
        distance=record("ways of the tool", feed_mm=number("at feed"), rapid_mm=number("in rapid")),
        stocks=table("each stock by its name; empty for `check`", _stock()),
        tools=array("each tool that was in the spindle while something moved", _tool()),
        operations=array(
            "from one tool change, or one comment that stands alone, to the next; those that feed", _operation()
        ),
        joints=array("each joint or axis", _joint()),
        not_simulated=array(
            "words that were read but have no effect here",
            record(
                "a word",
                word=text("such as `M8`"),
                count=whole("how often", least=1),
                first_line=whole("where"),
                channel=WHOSE,
            ),
        ),
        probings=optional(array("probing moves in order; only of a program that probes", _probing())),
        sensors=optional(
            table(
                "each sensor of the cell by its name, tools that are sensors as `T9`; only of a cell that has some",
                _sensor(),
            )
        ),
        printing=optional(_printing()),
        coating=optional(_coating()),
        target=optional(_target()),
        path_accuracy=optional(_path_accuracy()),
        parts=optional(_parts()),
        **_several_programs(hashed),
    )


def _inputs(hashed: Json) -> Json:
    """All that decides the results."""
    return record(
        "all that decides the results",
        gcodesim=text("version"),
        seed=nullable(whole("of the cell")),
        world=text("kinematic or bullet"),
        only=optional(choice("what the run was about, if not all (`run --only`)", "shape", "motion", "force")),
        from_line=optional(whole("line at which the program was taken up (`run --from-line`)")),
        program=hashed,
        cell=hashed,
        files=array("subprograms, meshes, tables", hashed),
    )


def _stock() -> Json:
    """A stock at the end."""
    return record(
        "a stock at the end",
        material=text("name of the material, may be empty"),
        initial_mm3=number("volume at the start"),
        removed_mm3=number("taken away"),
        deposited_mm3=number("put on"),
        remaining_mm3=number("volume at the end, with the pieces that fell"),
        resolution_mm=number("distance of its columns"),
        error_bound_mm3=number("by how much the volumes may be wrong"),
        doses=optional(_doses()),
        body=optional(_body()),
        fallen=optional(_fallen()),
        parted_off=optional(
            truth("lathe only: whether the part was parted off; then the volume at the end is its own")
        ),
        in_chuck_mm3=optional(number("lathe only: what the chuck still holds after that")),
        scrap_mm3=optional(number("lathe only: other pieces that came loose")),
        thread_mm3=optional(number("lathe only: what grooves of threads take; not in the other volumes")),
        profiles_z_r_mm=optional(
            array(
                "lathe only: outlines of the finished part in its half plane, closed, material on the right",
                array("an outline", array("z and radius", number("mm"))),
            )
        ),
    )


def _doses() -> Json:
    """What beams gave a stock."""
    return table(
        "beams only: what they gave the stock, each with a map",
        record(
            "a dose",
            unit=text("of `greatest` and of the map"),
            greatest=number("of the place that got most"),
            total_unit=text("of `total`"),
            total=number("summed over the stock"),
            corner_mm=array("where the map begins", number("x and y in the stock's columns")),
            cell_mm=array("size of a cell of the map", number("along x and y")),
        ),
    )


def _body() -> Json:
    """A stock as a body."""
    return record(
        "the stock at the end as a body of even density, without what fell; not where nothing is left",
        density_kg_m3=nullable(number("what the cell says, or that of the pure metal; null: not known")),
        density_of=text("the pure metal whose density was taken, empty where the cell gives one"),
        mass_kg=nullable(number("kg")),
        center_mm=array("the centre of mass in the stock's own frame", number("x, y, z")),
        inertia_kg_mm2=nullable(array("moments of inertia about it, three rows", array("a row", number("kg·mm²")))),
    )


def _fallen() -> Json:
    """Pieces that came loose."""
    return array(
        "pieces that came loose and fell out of the stock, if any",
        record(
            "a piece",
            volume_mm3=number("mm³"),
            file=text("of the program"),
            line=whole("of the move that cut it loose"),
            low_mm=array("lowest corner of its box", number("in the stock's columns")),
            high_mm=array("highest corner", number("in the stock's columns")),
            body=optional(text("`bullet` only: its frame in the log")),
            fell_mm=optional(number("`bullet` only: how much lower it came to rest")),
            lies_on=optional(text("`bullet` only: what on; empty for a floor that nobody has drawn")),
        ),
    )


def _tool() -> Json:
    """What a tool did."""
    figures = record(
        "a tool",
        number=whole("T number"),
        name=text("name in the cell"),
        time_s=number("in the spindle"),
        feed_mm=number("way at feed"),
        **_paces(),
        removed_mm3=number("volume removed"),
        max_force_N=number("greatest force, a mean over each revolution"),
        max_torque_Nm=number("greatest torque, a mean over each revolution"),
        max_power_W=number("greatest power"),
        line_of_max_force=LINE,
        channel=WHOSE,
    )
    figure = (
        "a figure of a process of the cell: of cutters `max_peak_force_N` and `max_peak_torque_Nm`, the "
        "greatest within a revolution; of another one such as `max_film_thickness_mm`"
    )
    return figures | {"additionalProperties": number(figure)}


def _operation() -> Json:
    """What an operation took."""
    return record(
        "an operation",
        name=text("its comment, or its tool"),
        tool=whole("T number", least=0),
        first_line=whole("of its moves"),
        last_line=whole("of its moves"),
        time_s=number("all of it: moves, dwells, tool change"),
        feed_mm=number("way at feed"),
        rapid_mm=number("way in rapid"),
        removed_mm3=number("material taken"),
        **_paces(),
    )


def _joint() -> Json:
    """How far and how fast a joint went."""
    return record(
        "a joint",
        name=text("as in the log"),
        unit=choice("of all its figures; effort is in N·m or N", "deg", "mm"),
        least=number("least position"),
        most=number("greatest position"),
        margin=nullable(number("least distance from a limit; null: unlimited")),
        line_of_margin=LINE,
        max_speed=nullable(number("per s; null with `--only shape`")),
        max_acceleration=nullable(number("per s²; null as `max_speed`")),
        max_effort=nullable(number("N·m, or N of a linear axis; null as `max_speed`")),
    )


def _probing() -> Json:
    """A probing move."""
    return record(
        "a move of G38.2 to G38.5 or G31",
        file=text("of the program"),
        line=whole("where"),
        move=text("such as `G38.2`"),
        time_s=number("when it tripped, or came to its end"),
        tripped=truth("whether the probe changed"),
        touched=nullable(text("the stock or fixture")),
        x_mm=number("where the tip was then, in the world"),
        y_mm=number("mm"),
        z_mm=number("mm"),
    )


def _sensor() -> Json:
    """What a sensor read."""
    return record(
        "a sensor",
        type=text("such as `camera`"),
        readings=whole("how often it has read"),
        sha256=text("of all values that it has read"),
    )


def _path_accuracy() -> Json:
    """How far an arm was off its path."""
    return record(
        "how far the tip of an arm was off its path while it fed (ISO 9283); only of arms that give way",
        AT_mm=number("greatest distance between the commanded and the attained path"),
        line_of_AT=nullable(whole("where")),
        time_of_AT_s=number("when"),
        AT_engaged_mm=number("the greatest while a process was engaged"),
        rms_mm=number("root of the mean square distance, by time"),
    )


def _paces() -> dict[str, Json]:
    """How fast feed moves ran."""
    return {
        "mean_feed_mm_min": number("mean speed of feed moves"),
        "least_feed_mm_min": number("least speed of feed moves"),
        "share_at_feed": number("share of the time of feed moves at the programmed feed, to 1 %"),
        "air_share": nullable(number("share of the time of feed moves in the air; null where nothing was cut")),
    }


def _times(**more: Json) -> Json:
    """Where the time goes."""
    return record(
        "where the time goes; total = feed + rapid + dwell + tool_change + spindle + devices",
        total_s=number("all of it"),
        feed_s=number("moves at feed"),
        engaged_s=number("the part of feed in which material is removed or added"),
        rapid_s=number("rapid moves"),
        dwell_s=number("dwells, waiting"),
        tool_change_s=number("tool changes"),
        **more,
        spindle_s=optional(number("until the spindle turned as commanded; only where that took time")),
        devices_s=optional(number("until devices had arrived; only where that took time")),
    )


def _coating() -> Json:
    """What was sprayed; only of a run in which a gun was on."""
    return record(
        "what was sprayed; only of a run in which a gun was on",
        sprayed_mm3=number("what left the guns"),
        solids_mm3=number("share of it that stays when it is dry; the volumes that follow add up to it"),
        film_mm3=number("on bodies: thickness times area of all faces"),
        bounced_mm3=number("met a body and did not stay"),
        overspray_mm3=number("met no body that is coated"),
        transfer_share=number("film over solids"),
        overspray_share=number("overspray over solids"),
        bodies=table(
            "bodies on which a gun sprayed, by name",
            record(
                "a body; all but `volume_mm3` are of the faces that count, by `faces` and `inside` of its `film`",
                faces=whole("of the film in all"),
                resolution_mm=number("greatest edge of a face"),
                volume_mm3=number("of film, on all faces"),
                area_mm2=number("of the faces that count"),
                least_um=nullable(number("least thickness; null: no face counts")),
                mean_um=nullable(number("mean by area")),
                most_um=nullable(number("greatest thickness")),
                uncovered_mm2=number("thinner than `bare`"),
                uncovered_share=number("of the area"),
                below_mm2=number("thinner than `least`"),
                above_mm2=number("thicker than `most`"),
                runs_mm2=number("where wet film runs, by `sag`"),
            ),
        ),
    )


def _target() -> Json:
    """The finished part against its target; only of a run of a cell with one."""
    corner = array("X, Y, Z in the work system", number("mm"))
    place = {
        "system": text("work system of the place, such as `G54`"),
        "x_mm": number("as the program would write it"),
        "y_mm": number("mm"),
        "z_mm": number("mm"),
    }
    return record(
        "the finished part against the `target` of the cell; only where both were compared",
        stock=text("the stock that was compared"),
        mesh=text("file of the target"),
        tolerance_mm=number("greatest distance that is allowed"),
        least_deviation_mm=number("the deepest gouge, 0 or below"),
        most_deviation_mm=number("the highest excess, 0 or above"),
        area_mm2=number("skin of the target"),
        share_outside=number("share of the target's skin that is out of tolerance"),
        gouge_mm3=number("missing in all gouges"),
        excess_mm3=number("left standing in all places of excess"),
        gouges=whole("number of places", least=0),
        excesses=whole("number of places", least=0),
        regions=array(
            "up to 50 gouges, then up to 50 places of excess, each kind by volume",
            record(
                "a place out of tolerance",
                kind=choice("too little or too much", "gouge", "excess"),
                volume_mm3=number("between part and target"),
                area_mm2=number("skin of the target beside it"),
                depth_mm=number("greatest distance from the skin of the target"),
                **place,
                low_mm=corner,
                high_mm=corner,
                file=nullable(text("of the line that is to blame; null: there is none")),
                line=LINE,
                tool=nullable(whole("its tool", least=0)),
                gap_mm=nullable(number("no tool made a face here, this one came so near; null: it made it")),
                lines=array(
                    "the lines that made its faces, up to 20, the greatest share first",
                    record(
                        "a line",
                        file=text("of the program"),
                        line=whole("where"),
                        tool=whole("its tool", least=0),
                        share=number("of the volume"),
                    ),
                ),
                others=array(
                    "of a gouge: further lines, up to 20, that go through it and would make one there themselves",
                    record("a line", file=text("of the program"), line=whole("where")),
                ),
            ),
        ),
        loose=array(
            "bodies of the stock that hang together with nothing of the target, up to 100",
            record("a loose piece", volume_mm3=number("its volume"), **place),
        ),
        scallops=array(
            "ridges between passes of each operation that made some of the part with a round edge, by patches of skin",
            record(
                "an operation",
                tool=whole("its tool", least=0),
                operation=text("its name, as in `operations`"),
                area_mm2=number("skin of the patches that were looked at"),
                typical_mm=number("half of this area has lower ridges: highest less lowest distance from the target"),
                most_mm=number("the highest"),
            ),
        ),
    )


def _parts() -> Json:
    """What became of the parts of the cell; only of a run in a cell that has some."""
    return table(
        "what became of each part; only where the cell has some",
        record(
            "a part at the end of the run",
            x_mm=number("of its frame in the world"),
            y_mm=number("mm"),
            z_mm=number("mm"),
            quaternion_xyzw=array("its attitude", number("of unit length")),
            held_by=nullable(text("the gripper, such as `arm T7`")),
            on=nullable(text("what it lies on or hangs above, if that has a name, or the link with which it goes")),
            above_mm=nullable(number("from there up to it; 0: it lies there; null: it is held")),
            moved_mm=number("from where it was at the start"),
            grips=whole("how often it was taken", least=0),
            falls=whole("how often it was lost or let go in the air", least=0),
            pose_error_mm=nullable(number("distance from where it is meant to be")),
            pose_error_deg=nullable(number("angle from how it is meant to be")),
            error_from=nullable(text("`goal`, or `release`: where it was let go last")),
        ),
    )


def _printing() -> Json:
    """What a print took; only of a program with E words."""
    volume, length = number("mm³, from the diameter of the filament"), number("mm of filament that went forward so")
    return record(
        "what a print took; only of a program with E words",
        filament_mm=number("sum of all E words"),
        filament_forward_mm=number("what goes forward, retraction not taken off"),
        filament_laid_mm=number("what goes forward while the head moves"),
        laid_mm3=volume,
        slicer_time_s=optional(number("how long it takes, as the slicer says in a comment")),
        model_time_s=optional(number("without the code at the start and the end; where the slicer tells such a time")),
        slicer_model_time_s=optional(number("the same as the slicer says in a comment")),
        slicer_filament_mm=optional(number("filament of all nozzles, as the slicer says in a comment")),
        nozzles=array(
            "the tools that extrude",
            record(
                "a nozzle",
                tool=whole("its number"),
                filament_mm=number("sum of its E words"),
                forward_mm=number("what goes forward"),
                laid_mm=length,
                laid_mm3=volume,
            ),
        ),
        layers=array(
            "in order",
            record(
                "a layer, by the slicer's comments, else by height",
                layer=whole("from 1; 0: before the first", least=0),
                z_mm=number("height of most of it"),
                time_s=number("moves, and filament alone"),
                laid_mm=length,
                laid_mm3=volume,
            ),
        ),
        features=array(
            "in the order in which they come first",
            record(
                "a feature",
                feature=text("as the slicer calls it; empty: before the first"),
                time_s=number("moves, and filament alone"),
                laid_mm=length,
                laid_mm3=volume,
            ),
        ),
    )


def _several_programs(hashed: Json) -> dict[str, Json]:
    """Keys of results that only several programs at once have."""
    place = {
        "channel": text("who stands there"),
        "file": text("of its program"),
        "line": whole("of the mark"),
        "mark": text("its name; `T1` where it waits for a tool that another channel has"),
    }
    wait = record(
        "a mark that the program came to, or a tool for which it waited",
        mark=text("its name; `T1` of a tool"),
        file=text("of the program"),
        line=whole("where"),
        begin_s=number("when it came there"),
        end_s=nullable(number("when all had come and it went on; null: never")),
    )
    block = record(
        "a block that takes time or waits",
        file=text("of the program"),
        line=whole("where"),
        begin_s=number("when it began"),
        end_s=nullable(number("when it ended; null: never")),
        mark=optional(text("the mark at which it waits, or the tool for which; only of a wait")),
    )
    channel = record(
        "one of several programs that run at once",
        program=hashed,
        mover=text("the robot that it moves, or `machine`"),
        status=choice("of this program alone", "ok", "findings", "failed"),
        end_s=nullable(number("when it ends; null: it waits for ever")),
        time=_times(wait_s=number("the part of dwell in which it waits for other programs")),
        distance=record("ways of its tool", feed_mm=number("at feed"), rapid_mm=number("in rapid")),
        waits=array("the marks that it came to and the tools that it waited for, in order", wait),
        blocks=optional(array("all blocks in the order of execution; only of a check", block)),
    )
    return {
        "channels": optional(table("each of several programs at once, by the name of its channel", channel)),
        "meetings": optional(
            record(
                "how several programs at once wait for each other",
                total_s=nullable(number("when the last program ends; null: one never does")),
                stopped_at_s=number("the last time at which anything happens"),
                circle=array(
                    "channels of which each waits for the next, the last for the first", record("one", **place)
                ),
                ended=array("who waits for a program that has ended", record("one", **place, by=text("that channel"))),
                lone=array("first places of marks that no other program uses", record("one", **place)),
            )
        ),
    }
