"""`gcodesim place PROGRAM --cell CELL`: where the part, or the arm, may stand so that the whole program can be run."""

from __future__ import annotations

import argparse
import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gcodesim.cli.exits import FINDINGS, OK, UsageError
from gcodesim.cli.language import Language
from gcodesim.cli.options import add_cell, add_format, add_language, add_program, read_source

if TYPE_CHECKING:
    from collections.abc import Callable

    from gcodesim.cell.shifting import Shifted
    from gcodesim.checks.postures import Postures
    from gcodesim.diagnostics import SourceText
    from gcodesim.frames import Array
    from gcodesim.kinematics.protocol import Kinematics
    from gcodesim.planning.place import Spot
    from gcodesim.planning.plan import Plan
    from gcodesim.shop import Shop

_PICTURE, _MESH = "reach.svg", "reach.stl"


def add_parser(commands: Any) -> None:
    parser = commands.add_parser(
        "place",
        help="where the part may stand so that an arm can run the whole program",
        description="Try places of the part on a grid, all configurations of the arm at each of them, and propose the"
        " one with the most room to the limits of the joints, where it hits nothing. Draws the region that the tip"
        " reaches.",
        epilog="Everything that the program commands is shifted together, with the stock and the fixtures that stand"
        " on the same frame. A place is good if no link hits another link, the tool, a fixture or the stock as it"
        " is at the start, and no tool a fixture that stays; ways between cuts are not asked: look at the proposal with"
        " `gcodesim check`. External axes stand as commanded, or where the arm has most room.",
    )
    add_program(parser)
    add_cell(parser, required=True)
    parser.add_argument("--arm", action="store_true", help="move the arm instead of the part")
    parser.add_argument(
        "--within",
        type=_lengths,
        default=(300.0, 300.0, 200.0),
        metavar="X,Y,Z",
        help="how far it may be shifted each way [mm] (default: 300,300,200); one number for all three",
    )
    parser.add_argument("--step", type=_length, default=100.0, metavar="MM", help="between places (default: 100 mm)")
    parser.add_argument(
        "-o", "--out", type=Path, metavar="DIR", help=f"write {_PICTURE} and {_MESH} of the region into this folder"
    )
    parser.add_argument("--write", action="store_true", help="write the proposed place into the cell file")
    add_language(parser)
    add_format(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    import numpy as np

    from gcodesim.cell import load_cell
    from gcodesim.cli.options import is_auto
    from gcodesim.cli.output import print_json
    from gcodesim.jobs.job import Options
    from gcodesim.planning.fixed_attitude import FixedAttitude
    from gcodesim.planning.place import (
        arm_of,
        best_place,
        cuts_of,
        margin_at,
        margin_outside,
        outside_cuts_of,
        places,
    )
    from gcodesim.planning.shop_posing import posing_of
    from gcodesim.simulation import prepare
    from gcodesim.units import MM

    if arguments.cell is None or is_auto(arguments.cell):
        raise UsageError("a place is proposed for the cell of --cell CELL")
    program = read_source(arguments.program, "program")
    source = read_source(arguments.cell, "cell")
    language = Language.of(arguments)
    loaded = load_cell(arguments.cell, arguments.allow_path, allow_code=arguments.allow_code)
    job = prepare(program, loaded, Options(settings=language.over, sources=language.sources))
    if job.shop is None or job.plan is None:
        first = next((f for f in job.findings if f.level.name == "ERROR"), None)
        raise UsageError("the program cannot be planned in this cell" + (f": {first.message}" if first else ""))
    shop, posing = job.shop, posing_of(job.shop)
    if not isinstance(posing, FixedAttitude):
        raise UsageError("`place` is for arms; on a machine tool GS201 names the shift that fits")
    if posing.outside is not None and arguments.out is not None:
        raise UsageError("the region of an arm with external axes is not drawn: leave out --out")
    systems = sorted({state.system for state in job.plan.path.states})
    along = _goes_along(shop, systems, arguments.arm)
    posing = replace(posing, obstacles=_obstacles(shop, along, round_tools=posing.outside is not None))
    cuts = cuts_of(job.plan, posing) if posing.outside is None else []
    outside = [] if posing.outside is None else outside_cuts_of(job.plan, posing)
    if not (cuts or outside):
        raise UsageError("the program moves nothing along a path")
    arm, R_BW = arm_of(job.plan), shop.X_WB.inverse().R
    within, step = np.array(arguments.within) * MM, arguments.step * MM
    if outside:
        found = places(lambda shift: margin_outside(outside, shift), R_BW, within, step)
    else:
        found = places(
            _where_tools_are_clear(job.plan, shop, along, lambda shift: margin_at(arm, cuts, shift, posing.branches)),
            R_BW,
            within,
            step,
        )
    now, best = found[0], best_place(found, step)
    shift = None if best is None else (-best.shift if arguments.arm else best.shift)
    moved = [] if shift is None else _moved(shop, systems, shift, arguments.arm)
    files = [] if arguments.out is None else _draw(arguments.out, shop, arm, cuts, R_BW, best, posing.branches)
    if arguments.write and best is not None:
        _write(arguments.cell, source, moved)
    good = [place for place in found if place.good]
    if arguments.format == "json":
        print_json(
            {
                "schema": "gcodesim-place/1",
                "moved": "arm" if arguments.arm else "part",
                "tried": len(found),
                "good": len(good),
                "good_shifts_mm": [_mm(-p.shift if arguments.arm else p.shift) for p in good],
                "now": {"good": now.good, "margin_deg": _degrees(now)},
                "best": None
                if best is None or shift is None
                else {"shift_mm": _mm(shift), "margin_deg": _degrees(best)},
                "places": [{"key": ".".join(m.keys), "xyz_mm": [round(v / MM, 1) + 0.0 for v in m.xyz]} for m in moved],
                "written": bool(arguments.write and best is not None),
                "files": files,
            }
        )
        return OK if best is not None else FINDINGS
    what = "arm" if arguments.arm else "part"
    print(f"{len(good)} of {len(found)} places of the {what} are good")
    print(f"now: {_in_words(now)}")
    if best is None or shift is None:
        print("no place was found; try --within and --step, or a smaller tool")
        return FINDINGS
    parts = " ".join(f"{'XYZ'[k]}{shift[k] / MM:+.0f}" for k in range(3) if abs(shift[k]) > 0.5 * MM)
    print(f"best: {f'the {what} shifted by {parts} mm' if parts else 'where it is'}, {_in_words(best)}")
    for place in moved:
        print(f"  {'.'.join(place.keys)}: xyz {place.text}")
    if arguments.write:
        print(f"wrote {arguments.cell}")
    for file in files:
        print(f"wrote {arguments.out / file}")
    return OK


def _goes_along(shop: Shop, systems: list[int], arm: bool) -> frozenset[str]:
    """The names of what is shifted together with the work; seen from an arm that is shifted, all that stands around."""
    import numpy as np

    from gcodesim.cell.shifting import standing_on
    from gcodesim.checks.machine_bodies import BASE_JOINT, MachineBodies

    if not arm:
        return standing_on(shop.cell, shop.channel, _moved(shop, systems, np.zeros(3), arm))
    bodies = MachineBodies.of(shop.scene, shop.name).bodies
    return frozenset(body.rigid.name for body in bodies if body.carrier == BASE_JOINT)


def _obstacles(shop: Shop, along: frozenset[str], *, round_tools: bool) -> Postures:
    """What the arm may hit."""
    from gcodesim.checks.machine_bodies import MachineBodies
    from gcodesim.checks.postures import Postures

    return Postures(
        machine=MachineBodies.of(shop.scene, shop.name),
        tools=shop.cell.tools,
        home=shop.home,
        apart=shop.cell.limits.apart,
        along=along,
        round_tools=round_tools,
    )


def _where_tools_are_clear(
    plan: Plan, shop: Shop, along: frozenset[str], margin: Callable[[Array], float]
) -> Callable[[Array], float]:
    """The `margin` [rad] of each shift (3,) [m] in B, `NOWHERE` where a tool would enter a fixture that stays."""
    from gcodesim.checks.clearance import standing_bodies
    from gcodesim.checks.moved_work import MovedWork
    from gcodesim.planning.place import NOWHERE, paths_of

    work = MovedWork.of(paths_of(plan), shop.cell.tools, standing_bodies(shop.scene, shop.name), along)

    def where_clear(shift: Array) -> float:
        room = margin(shift)
        return room if room < 0.0 or not work.enters(shift) else NOWHERE

    return where_clear


def _moved(shop: Shop, systems: list[int], shift: Array, arm: bool) -> list[Shifted]:
    """The places in the cell that have to change."""
    from gcodesim.canon.systems import name_of_system
    from gcodesim.cell.shifting import NotMovableError, shifted_robot, shifted_work

    try:
        if arm:
            return [shifted_robot(shop.cell, shop.name, shift)]
        every = [shifted_work(shop.cell, shop.channel, name_of_system(system), shift) for system in systems]
    except NotMovableError as reason:
        raise UsageError(str(reason)) from None
    return list(dict.fromkeys(every))


def _write(path: Path, source: SourceText, moved: list[Shifted]) -> None:
    from gcodesim.cell.shifting import NotMovableError, rewritten
    from gcodesim.files.whole_file import write_whole

    try:
        for place in moved:
            source = rewritten(source, place)
        write_whole(path, source.raw)
    except NotMovableError as reason:
        raise UsageError(str(reason)) from None
    except OSError as error:
        raise UsageError(f"{path} cannot be written: {error.strerror}") from None


def _draw(
    folder: Path,
    shop: Shop,
    arm: Kinematics,
    cuts: list[Any],
    R_BW: Array,
    best: Spot | None,
    branches: tuple[int, ...] | None,
) -> list[str]:
    """Picture and mesh of what the tip reaches; their names."""
    from io import BytesIO

    import numpy as np

    from gcodesim.files.whole_file import write_whole
    from gcodesim.material.stl import write_stl
    from gcodesim.planning.place import region_of
    from gcodesim.report.reach_picture import mesh_of, picture_of

    base = shop.X_WB.p
    region = region_of(arm, cuts, R_BW, base, branches)
    path = shop.X_WB.apply(np.concatenate([cut.X_BT[:, :3, 3] for cut in cuts]))
    mesh = BytesIO()
    write_stl(mesh_of(region), mesh)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        write_whole(folder / _PICTURE, picture_of(region, path, None if best is None else best.shift, base).encode())
        write_whole(folder / _MESH, mesh.getvalue())
    except OSError as error:
        raise UsageError(f"{folder} cannot be written: {error.strerror}") from None
    return [_PICTURE, _MESH]


def _in_words(place: Spot) -> str:
    from gcodesim.units import DEG

    if not place.good:
        return "the program cannot be run whole; `gcodesim check` says where and why"
    if math.isinf(place.margin):
        return "no joint has limits"
    return f"joints stay {place.margin / DEG:.1f} deg from their limits"


def _degrees(place: Spot) -> float | None:
    from gcodesim.units import DEG

    return round(place.margin / DEG, 3) if place.good and math.isfinite(place.margin) else None


def _mm(shift: Array) -> list[float]:
    from gcodesim.units import MM

    return [round(float(v) / MM, 3) + 0.0 for v in shift]


def _length(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 1.0 <= value <= 1e5:
        raise argparse.ArgumentTypeError(f"{text} is no length in mm from 1 on")
    return value


def _lengths(text: str) -> tuple[float, float, float]:
    parts = text.split(",")
    values = tuple(0.0 if part.strip() in ("0", "0.0") else _length(part) for part in parts)
    if len(values) == 1:
        return (values[0], values[0], values[0])
    if len(values) != 3:
        raise argparse.ArgumentTypeError("three lengths X,Y,Z in mm, or one, are expected")
    return (values[0], values[1], values[2])
