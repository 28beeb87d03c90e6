"""A first cell for an existing program, as text with comments: what `gcodesim init --from` writes."""

from __future__ import annotations

import math
from typing import Final, cast

from gcodesim.canon.systems import name_of_system
from gcodesim.diagnostics import SourceText
from gcodesim.frozen import frozen
from gcodesim.rs274.program_source import why_unreadable
from gcodesim.starter.lathe_cell import LatheCell
from gcodesim.starter.named_beam import NamedBeam
from gcodesim.starter.printer_cell import PrinterCell, is_print
from gcodesim.starter.scan import Scan, ScannedTool, scan
from gcodesim.starter.survey import Bounds, Reach, Survey, survey
from gcodesim.tools.cutter import usual_length
from gcodesim.units import INCH, MM

_ROUTER: Final = (1.2, 0.8)  # m, travel of the shipped router in X and Y
_ROUTER_Z: Final = 0.4
_ABOVE: Final = 0.09  # m, left above the stock on the router where nothing says where the work is
_INCHES: Final = "G20"
_GAP: Final = 50.0 * MM
_THIN: Final = 1.0 * MM  # a shallower cut says nothing about the thickness
_NEAR_A_SIDE: Final = 0.25
_SHEET: Final = 3.0 * MM
_RIM: Final = 5.0 * MM  # of a sheet around what a beam cuts
_COLUMNS: Final = 1_000_000
_FLOOR: Final = 1.0 * MM  # left below the deepest cut: a slot as deep as a guessed stock would part it
_NO_END: Final = "GS010"
_GUESSED: Final = {"drill": 5.0 * MM, "flat_end_mill": 6.0 * MM}


class NoCellError(Exception):
    """A cell for this program would make no sense; the text says why."""


@frozen
class FirstTool:
    """A tool of the cell [m], and where its size comes from."""

    scanned: ScannedTool
    diameter: float
    guessed: bool

    @property
    def length(self) -> float:
        other = self.scanned.other
        return usual_length(self.diameter) if other is None else other.length


def cell_for(program: SourceText) -> bytes:
    """A cell in which `program` runs: dialect, machine, stock and tools from its moves, words and comments.

    Everything else is guessed and marked as a guess. NoCellError for a program that no dialect can read.
    """
    return first_cell(program).text()


def first_cell(program: SourceText) -> FirstCell | PrinterCell | LatheCell:
    """What `program` says about its cell. NoCellError for a program that no dialect can read."""
    if reason := why_unreadable(program):
        raise NoCellError(f"{program.name} is binary G-code that cannot be read: {reason}")
    if not is_print(program):
        return LatheCell.of(program) or FirstCell.of(program)
    printer = PrinterCell.of(program)
    if not printer.lays:
        stopped = f" before the error in line {printer.failed}; `gcodesim lint` shows it" if printer.failed else ""
        raise NoCellError(f"{program.name} is a program for a printer, but it lays nothing{stopped}")
    return printer


def _tools(found: Scan, seen: Survey) -> list[FirstTool]:
    """The tools that the program calls; the one in the spindle when it calls none."""
    scanned = list(found.tools)
    named = {tool.number for tool in scanned}
    scanned += [ScannedTool(number=number, line=0) for number in seen.called if number not in named]
    if not scanned and any(use.sideways or use.down for use in seen.uses.values()) and _depth(seen) > 0.0:
        scanned = [ScannedTool(number=1, line=0)]
    unit = INCH if found.inch else MM
    tools = []
    for tool in scanned:
        use = seen.uses.get(tool.number) or (seen.uses.get(0) if not seen.changes else None)
        if use is not None and use.makes_holes and tool.type == "flat_end_mill" and not tool.comment:
            tool = ScannedTool(number=tool.number, line=tool.line, type="drill")
        if tool.other is not None:
            tools.append(FirstTool(scanned=tool, diameter=0.0, guessed=True))
            continue
        if tool.diameter is not None:
            tools.append(FirstTool(scanned=tool, diameter=tool.diameter * unit, guessed=False))
            continue
        guess = 0.25 * INCH if found.inch else _GUESSED.get(tool.type, 6.0 * MM)
        if 0.0 < _depth(seen) < _THIN:
            guess = 0.5 * MM  # an engraving, or tracks of a board
        tools.append(FirstTool(scanned=tool, diameter=guess, guessed=True))
    return tools


def _depth(seen: Survey) -> float:
    return max((float(r.cut[1][2] - r.cut[0][2]) for r in seen.systems.values() if r.cut is not None), default=0.0)


@frozen
class FirstCell:
    """What a program says about the cell that it needs, and that cell as lines of text."""

    program: str
    found: Scan
    seen: Survey
    tools: list[FirstTool]
    beam: NamedBeam | None

    @staticmethod
    def of(program: SourceText) -> FirstCell:
        """From moves, words and comments; NoCellError for a program that no dialect can read."""
        found = scan(program)
        seen = survey(program, SourceText("startup", f"{_INCHES}\n".encode()) if found.unit_is_guessed else None)
        if seen.foreign:
            raise NoCellError(f"{program.name} is a program for {seen.foreign}")
        beam = None if seen.lathe or seen.rotary else NamedBeam.of(program)
        tools = [] if beam is not None else _tools(found, seen)
        return FirstCell(program=program.name, found=found, seen=seen, tools=tools, beam=beam)

    def text(self) -> bytes:
        """The cell file."""
        lines = [
            f"# A cell for {self.program}, made from its moves, words and comments: look at every line.",
            "gcodesim: 1",
            *(["units: {length: in}"] if self.found.inch else []),
            *self.language(),
            "",
            *self.machine(),
            "",
            *self.stock(),
            "",
            *self.tools_lines(),
        ]
        return ("\n".join(lines) + "\n").encode()

    @property
    def boxes(self) -> dict[int, tuple[list[float], list[float]]]:
        """Least and greatest corner of the material in each work system that needs some [m]."""
        reaches = self.seen.systems.items()
        return {index: box for index, reach in reaches if (box := self._stock_box(reach)) is not None}

    @property
    def told_stock(self) -> int:
        """The line in which the program tells the size of its stock; 0 if it is a guess from what is cut."""
        told = self.found.corners is not None or self.found.stock is not None
        return self.found.stock_line if told else 0

    @property
    def _unit(self) -> float:
        return INCH if self.found.inch else MM

    def _list(self, values: object, digits: int = 4) -> str:
        """Lengths [m] as a list in the program's unit."""
        return ", ".join(f"{round(float(v) / self._unit, digits):g}" for v in values)  # type: ignore[attr-defined]

    def language(self) -> list[str]:
        lines = [f"dialect: {self.seen.dialect:<10} # {self.seen.why}"]
        if self.found.unit_is_guessed:
            lines.append(f"startup: {_INCHES}        # it says neither G20 nor G21, and sizes of tools in inches")
        elif self.beam is not None and self.beam.kind != "laser" and self.beam.greatest == 0.0:
            lines.append("startup: S1         # the program never says S, and M3 without it turns nothing")
        checks = []
        whole = self.seen.failed is None or self.seen.failed.code == _NO_END  # else what is missing may come later
        if self.seen.failed is not None and whole:
            checks.append((f"{_NO_END}: warning", "a control would stop at the end of the file: it has no M2 or M30"))
        elif self.seen.failed is not None:
            where = self.seen.failed.span.line
            lines.append(f"# line {where} of the program has an error, so a run stops there: see `gcodesim lint`")
            lines.append("# nothing behind that line is known here: mend it, and make this cell again")
        if self.seen.lathe:
            lines.append("# it is a program for a lathe: paths and times are right, material is not")
        # an error hides what may come later, and a tool is needed for what is fed before it
        fed = any(use.sideways or use.down for use in self.seen.uses.values())
        known = whole or (fed and not self.seen.changes)
        if known and self.tools and not (self.seen.changes and self.seen.measured):
            number = self.tools[0].scanned.number
            why = "no G43 puts a length in force: Z counts as touched off with the tool"
            if not self.seen.changes:
                why = "the program changes no tool: this one is there from the start"
            lines.append(f"loaded_tool: {number}    # {why}")
        if whole and self.tools and not self.seen.changes and not self.seen.spins:
            checks.append(("GS501: note", "the program never starts the spindle: somebody does it by hand"))
        switched = {tool.scanned.other.switches for tool in self.tools if tool.scanned.other is not None} - {None}
        if len(switched) == 1:
            [(on, off)] = cast(set[tuple[int, int]], switched)
            lines.append(f"m_codes: {{M{on}: {{tool: activate}}, M{off}: {{tool: deactivate}}}}")
        if self.beam is not None:
            lines += [f"loaded_tool: {self.beam.number}", self.beam.switch_line(self.seen.dialect)]
        if checks:
            codes, reasons = zip(*checks, strict=True)
            lines.append(f"checks: {{{', '.join(codes)}}}    # {'; '.join(reasons)}")
        return lines

    # -- machine

    def machine(self) -> list[str]:
        if self._router_suffices():
            return ["machine: gantry_xyz"]
        zeros, travel = self._layout()
        lines = [
            "# as large as the program asks for; put in the travel, speeds and accelerations of your machine",
            "machine:",
            "  axes:",
        ]
        first = next(iter(zeros.values()), (0.0, 0.0, 0.0))
        longest = self._longest
        for k, letter in enumerate("XYZ"):
            low, high = travel[k]
            speed = "30 m/min, acceleration: 3 m/s^2" if k < 2 else "15 m/min, acceleration: 2 m/s^2"
            home = first[k] + (longest if k == 2 else 0.0) + 0.0
            begins_high = k == 2 and bool(self.seen.own) and not self.seen.from_zero
            if begins_high:  # zero may be low, and the first rapid then goes up through the stock
                home = high
            stays = k == 2 and self._stays_level
            at = f", home: {home / MM:g} mm" if self.seen.from_zero or begins_high or stays else ""
            lines.append(f"    {letter}: {{travel: [{low / MM:g}, {high / MM:g} mm], speed: {speed}{at}}}")
        for letter in self.seen.rotary:
            lines.append(
                f"    {letter}: {{travel: unlimited, speed: 90 deg/s, side: table}}  # time only without `at:`"
            )
        if self._stays_level:
            lines.append("# the program never moves Z: the tip is at its height from the start")
        if self.seen.from_zero:
            lines.append("# the program counts from where it starts: `home` is its zero, the tool on the material")
        if self.seen.own:
            names = ", ".join(name_of_system(index) for index in self.seen.own)
            lines.append(f"# the program sets {names} itself: so it stands here, for the stock to be where it cuts")
        lines.append("work_offsets:")
        for index, zero in self._zeros_by_system(zeros):
            place = ", ".join(f"{value / MM + 0.0:g}" for value in zero)
            lines.append(f"  {name_of_system(index)}: {{xyz: [{place} mm]}}")
        return lines

    @property
    def _stays_level(self) -> bool:
        """Whether a beam is never moved up or down."""
        heights = [reach.all for reach in self.seen.systems.values()]
        return self.beam is not None and all(high[2] - low[2] < 1e-6 for low, high in heights)

    @property
    def _longest(self) -> float:
        """The longest tool [m], by the cell or by words of the program."""
        beam = 0.0 if self.beam is None else self.beam.length
        return max([self.seen.lift, beam, *(tool.length for tool in self.tools)])

    def _zeros_by_system(
        self, zeros: dict[int, tuple[float, float, float]]
    ) -> list[tuple[int, tuple[float, float, float]]]:
        return sorted(zeros.items()) or [(1, (0.0, 0.0, 0.0))]

    def _router_suffices(self) -> bool:
        seen = self.seen
        if not any(self._stock_box(reach) for reach in seen.systems.values()):
            return not seen.systems  # without stock nothing places the work
        if seen.rotary or seen.lathe or seen.from_zero or seen.own or list(seen.systems) != [1] or self._stays_level:
            return False
        if seen.machine is not None:
            low, high = seen.machine
            if low[2] < -_ROUTER_Z or high[2] > 0.0 or (low[:2] < 0.0).any() or (high[:2] > _ROUTER).any():
                return False
        for reach in seen.systems.values():
            low, high = reach.all
            box = self._stock_box(reach)
            body = (low, high) if box is None else box
            middle = [0.5 * (a + b) for a, b in zip(*body, strict=True)]
            for k in range(2):
                if max(high[k] - middle[k], middle[k] - low[k]) > 0.48 * _ROUTER[k]:
                    return False
            top = 0.0 if box is None else float(box[1][2])
            beam = 0.0 if self.beam is None else self.beam.length
            longest = max((tool.length for tool in self.tools), default=beam)
            if seen.lift > longest or high[2] - top > _ABOVE or top - low[2] > _ROUTER_Z - 0.1 - longest:
                return False
        return True

    def _layout(self) -> tuple[dict[int, tuple[float, float, float]], list[tuple[float, float]]]:
        """Zeros of the work systems side by side along X, and a travel that holds them all [m]."""
        longest = self._longest
        highest = max((float(r.all[1][2]) for r in self.seen.systems.values()), default=0.0)
        lowest = min((float(r.all[0][2]) for r in self.seen.systems.values()), default=0.0)
        z = -_up(highest + longest + 10.0 * MM)
        zeros, x, widest = {}, _GAP, 0.0
        for index, reach in self.seen.systems.items():
            low, high = self._room(reach)
            if index in self.seen.own:
                continue
            zeros[index] = (_up(x - low[0]), _up(_GAP - low[1]), z)
            x = zeros[index][0] + high[0] + _GAP
            widest = max(widest, zeros[index][1] + high[1] + _GAP)
        travel = [[0.0, _up(x)], [0.0, _up(widest)], [-_up(-(z + min(lowest, 0.0)) + 10.0 * MM), 0.0]]
        for index, zero in self.seen.own.items():
            zeros[index] = zero
            if index not in self.seen.systems:
                continue
            low, high = self._room(self.seen.systems[index])
            for k in range(3):
                margin = 10.0 * MM + (longest if k == 2 else 0.0)
                travel[k][0] = min(travel[k][0], -_up(-(zero[k] + low[k])))
                travel[k][1] = max(travel[k][1], _up(zero[k] + high[k] + margin))
        if self.seen.machine is not None:
            for k in range(3):
                travel[k][0] = min(travel[k][0], -_up(-float(self.seen.machine[0][k])))
                travel[k][1] = max(travel[k][1], _up(float(self.seen.machine[1][k])))
        return zeros, [(low + 0.0, high + 0.0) for low, high in travel]

    def _room(self, reach: Reach) -> tuple[list[float], list[float]]:
        low, high = [float(v) for v in reach.all[0]], [float(v) for v in reach.all[1]]
        if (box := self._stock_box(reach)) is not None:
            low = [min(a, float(b)) for a, b in zip(low, box[0], strict=True)]
            high = [max(a, float(b)) for a, b in zip(high, box[1], strict=True)]
        return low, high

    # -- stock

    def _stock_box(self, reach: Reach) -> tuple[list[float], list[float]] | None:
        """The box of material in a work system [m]; None where nothing is cut into a depth."""
        if self.found.corners is not None:
            return tuple([v * self._unit for v in corner] for corner in self.found.corners)  # type: ignore[return-value]
        if self.beam is not None:
            return None if reach.fed is None else _sheet(reach.fed)
        if reach.cut is None or reach.cut[1][2] - reach.cut[0][2] < 1e-6:
            return None
        low, high = [float(v) for v in reach.cut[0]], [float(v) for v in reach.cut[1]]
        if self.found.stock is not None:
            return _around(low, high, [side * self._unit for side in self.found.stock])
        if high[2] - low[2] < _THIN:
            low[2] = high[2] - _SHEET
        radii = {tool.scanned.number: 0.5 * tool.diameter for tool in self.tools}
        radius = max(radii.values(), default=0.0)
        drills = all(use.makes_holes for use in self.seen.uses.values())
        for k in range(2):
            if drills or high[k] - low[k] < 2.0 * radius + 1e-6:  # holes, or a line
                low[k], high[k] = low[k] - 2.0 * radius, high[k] + 2.0 * radius
        for x, y, number in reach.plunges.tolist():
            _keep_out((x, y), radii.get(int(number), radius), low, high)
        for x, y, z in reach.early.tolist():
            if low[0] < x < high[0] and low[1] < y < high[1]:
                high[2] = min(high[2], z)
        return (low, high) if all(b - a > 1e-6 for a, b in zip(low, high, strict=True)) else None

    def stock(self) -> list[str]:
        boxes = self.boxes
        if not boxes:
            return [
                "# nothing is fed into a depth: a pen, a beam that no comment names, or no cut at all",
                "# stock: {box: [100, 60, 20], zero: top-front-left, material: al6082_t6}",
            ]
        if self.seen.rotary or self.seen.lathe:
            turns = f"the work turns with {', '.join(self.seen.rotary) or 'the spindle'}"
            return [
                f"# {turns}, where to is not known, so there is no stock:",
                "# stock: {box: [100, 60, 20], in: G54}",
            ]
        if self.beam is not None:
            return self._sheets(boxes, self.beam)
        if self.found.corners is not None or self.found.stock is not None:
            source = f"# size from line {self.found.stock_line}; "
            source += (
                "put in the material" if self.found.corners is not None else "its place and the material are guesses"
            )
        else:
            source = "# a guess from what is cut: put in the real size and material"
            boxes = {index: ([x, y, z - _FLOOR], high) for index, ((x, y, z), high) in boxes.items()}
        if len(boxes) == 1:
            [(index, (low, high))] = boxes.items()
            own = "" if index == 1 else f", in: {name_of_system(index)}"
            return [source, f"stock: {{min: [{self._list(low)}], max: [{self._list(high)}]{own}, material: al6082_t6}}"]
        lines = [source, "stock:"]
        for index, (low, high) in boxes.items():
            name = name_of_system(index)
            key = "in_" + name.lower().replace(".", "_").replace(" ", "_")
            lines.append(
                f"  {key}: {{min: [{self._list(low)}], max: [{self._list(high)}], in: {name}, material: al6082_t6}}"
            )
        return lines

    def _sheets(self, boxes: dict[int, tuple[list[float], list[float]]], beam: NamedBeam) -> list[str]:
        """A sheet under each system in which the beam works."""
        sheets = []
        for index, (low, high) in boxes.items():
            area = (high[0] - low[0]) * (high[1] - low[1])
            grain = max(beam.diameter / 4.0, math.sqrt(area / _COLUMNS))
            own = "" if index == 1 else f", in: {name_of_system(index)}"
            corners = f"min: [{self._list(low)}], max: [{self._list(high)}]{own}"
            resolution = f"{round(grain / MM, 2):g} mm"
            sheets.append((index, f"{{{corners}, material: {beam.material}, resolution: {resolution}}}"))
        source = "# a guess from where the beam goes, its top where the tip is: put in the real sheet"
        if len(sheets) == 1:
            return [source, f"stock: {sheets[0][1]}"]
        return [source, "stock:", *(f"  sheet_{index}: {text}" for index, text in sheets)]

    # -- tools

    def tools_lines(self) -> list[str]:
        if self.beam is not None:
            return self.beam.tool_lines()
        if not self.tools:
            return ["# no tool cuts, so none is needed:", "# tools:", "#   1: {type: flat_end_mill, diameter: 6 mm}"]
        lines = ["tools:"]
        unit = "in" if self.found.inch else "mm"
        written = {tool.scanned.number for tool in self.tools}  # two tools may share an offset
        for tool in self.tools:
            told = tool.scanned
            asked = "; ITS DIAMETER IS A GUESS" if tool.guessed else ""
            asked = asked if told.other is None else "; OTHER NUMBERS ARE A GUESS"
            source = "nothing says what is in the spindle"
            if told.line or told.number in self.seen.called:
                source = f"called in line {told.line}" if told.line else "its number is computed"
            if told.comment:
                source = f"line {told.line}: {told.comment}"
            values = [f"type: {told.type}", f"diameter: {round(tool.diameter / self._unit, 4):g} {unit}"]
            if told.corner_radius:
                values.append(f"corner_radius: {told.corner_radius:g} {unit}")
            if told.point_angle is not None:
                values.append(f"point_angle: {told.point_angle:g} deg")
            if told.angle is not None:
                values.append(f"angle: {told.angle:g} deg")
            text = f"{{{', '.join(values) if told.other is None else told.other.keys}}}"
            lines += [f"  # {source}{asked}", f"  {told.number}: {text}"]
            for number, of in self.found.offsets.items():
                if number in written:
                    continue
                if of == told.number or (of == 0 and not self.seen.changes):
                    lines += [
                        f"  # H{number} or D{number}, the offset with which T{told.number} is used",
                        f"  {number}: {text}",
                    ]
                    written.add(number)
        return lines


def _sheet(fed: Bounds) -> tuple[list[float], list[float]]:
    """A sheet [m] around feeds, its top at the lowest of them."""
    low, high = [float(v) - _RIM for v in fed[0]], [float(v) + _RIM for v in fed[1]]
    top = float(fed[0][2])
    return [*low[:2], top - _SHEET], [*high[:2], top]


def _around(low: list[float], high: list[float], size: list[float]) -> tuple[list[float], list[float]]:
    """A box of this size [m] in the most likely place around the cuts: with a zero in a corner or in the middle."""
    least, most = [0.0] * 3, [0.0] * 3
    for k in range(2):
        centred = low[k] < -0.05 * size[k]
        least[k] = -0.5 * size[k] if centred else 0.0
        most[k] = least[k] + size[k]
        if low[k] < least[k] - 0.1 * size[k] or high[k] > most[k] + 0.1 * size[k]:
            least[k] = 0.5 * (low[k] + high[k] - size[k])
            most[k] = least[k] + size[k]
    most[2] = 0.0 if low[2] < -1e-6 else size[2]
    least[2] = most[2] - size[2]
    return least, most


def _keep_out(point: tuple[float, float], radius: float, low: list[float], high: list[float]) -> None:
    """Move a side of the box near which a tool comes down in a rapid."""
    if any(not a - radius < p < b + radius for p, a, b in zip(point, low, high, strict=False)):
        return
    costs = [(point[k] + radius - low[k], k, True) for k in range(2)]
    costs += [(high[k] - point[k] + radius, k, False) for k in range(2)]
    cost, axis, is_low = min(costs)
    if cost > _NEAR_A_SIDE * (high[axis] - low[axis]):
        return
    if is_low:
        low[axis] = point[axis] + radius
    else:
        high[axis] = point[axis] - radius


def _up(value: float) -> float:
    """Up to whole 10 mm [m]."""
    return math.ceil(value / (10.0 * MM) - 1e-9) * 10.0 * MM
