"""Programs out of a seed: the whole of LinuxCNC's language by a grammar of snippets, wrong use included.

An `Author` keeps a light picture of the modal state, so that most blocks make
sense where they stand; now and then one does not, on purpose. Every program is
a function of its seed alone.
"""

from __future__ import annotations

import random
from collections.abc import Callable

_AXES = "XYZABCUVW"
_PLANES = {17: ("X", "Y", "Z", "I", "J"), 18: ("Z", "X", "Y", "K", "I"), 19: ("Y", "Z", "X", "J", "K")}
_TOOLS = (1, 2, 3, 4, 5, 6, 7, 10, 12, 99, 21)
_SYSTEMS = ("G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3")
_CYCLES = ("G73", "G74", "G81", "G82", "G83", "G84", "G85", "G86", "G87", "G88", "G89")
_FUNCTIONS = ("ABS", "ACOS", "ASIN", "COS", "EXP", "FIX", "FUP", "LN", "ROUND", "SIN", "SQRT", "TAN")
_OPERATORS = ("+", "-", "*", "/", "MOD", "**", "EQ", "NE", "GT", "GE", "LT", "LE", "AND", "OR", "XOR")
_CODES = (
    *("G0", "G1", "G2", "G3", "G4", "G5", "G5.1", "G5.2", "G5.3", "G7", "G8", "G10", "G17", "G18", "G19", "G20", "G21"),
    *("G28", "G28.1", "G30", "G30.1", "G33", "G33.1", "G40", "G41", "G41.1", "G42"),
    *("G42.1", "G43", "G43.1", "G43.2", "G49", "G50", "G51", "G52", "G53", *_SYSTEMS, "G61", "G61.1", "G64", "G65"),
    *("G68", "G73", "G74", "G76", "G80", "G81", "G82", "G83", "G84", "G85", "G86", "G87", "G88", "G89", "G90", "G90.1"),
    *("G91", "G91.1", "G92", "G92.1", "G92.2", "G92.3", "G93", "G94", "G95", "G96", "G97", "G98", "G99", "G17.1"),
    *("M0", "M1", "M2", "M3", "M4", "M5", "M7", "M8", "M9", "M19", "M30", "M48", "M49", "M50", "M51", "M52", "M53"),
    *("M60", "M61", "M62", "M63", "M64", "M65", "M66", "M67", "M68", "M70", "M71", "M72", "M73", "M98", "M99", "M101"),
)
_PREDEFINED = (
    *("_x", "_y", "_z", "_a", "_b", "_c", "_feed", "_rpm", "_metric", "_imperial", "_absolute", "_incremental"),
    *("_plane", "_ccomp", "_coord_system", "_motion_mode", "_current_tool", "_selected_tool", "_tool_offset"),
    *("_inverse_time", "_units_per_minute", "_units_per_rev", "_retract_r_plane", "_retract_old_z", "_spindle_on"),
    *("_spindle_cw", "_mist", "_flood", "_speed_override", "_feed_override", "_adaptive_feed", "_feed_hold", "_u"),
    *("_spindle_rpm_mode", "_spindle_css_mode", "_ijk_absolute_mode", "_lathe_diameter_mode", "_lathe_radius_mode"),
    *("_value", "_value_returned", "_call_level", "_current_pocket", "_selected_pocket", "_vmajor", "_task", "_line"),
)
_WRONG = 0.02  # share of blocks with a fault put in


class Author:
    """Writes one program."""

    def __init__(self, seed: int | str) -> None:
        self.random = random.Random(seed)
        self.lines: list[str] = []
        self.plane = 17
        self.inch = False
        self.incremental = False
        self.turning = ""
        self.known: list[str] = []  # names of parameters that have a value
        self.labels = 100
        self.depth = 0
        self.focus = self.random.sample(list(SNIPPETS), self.random.randint(2, 6))

    # -- small parts

    def chance(self, share: float) -> bool:
        return self.random.random() < share

    def pick(self, *choices: str) -> str:
        return self.random.choice(choices)

    def digits(self, low: float, high: float, places: int | None = None) -> str:
        """A plain number in one of its spellings."""
        rng = self.random
        if self.inch:
            low, high = low / 25.4, high / 25.4
        value = rng.choice((rng.uniform(low, high), float(rng.randint(round(low), max(round(high), round(low))))))
        if self.chance(0.05):
            value = 0.0
        text = f"{value:.{rng.choice((0, 1, 2, 3, 4, 6)) if places is None else places}f}"
        if self.chance(0.05) and text.startswith("0."):
            text = text[1:]
        if self.chance(0.03):
            text += "" if "." in text else "."
        if self.chance(0.03) and not text.startswith("-"):
            text = "+" + text
        return text

    def number(self, low: float = -50.0, high: float = 50.0) -> str:
        """A number, or something that has a value."""
        if self.chance(0.88):
            return self.digits(low, high)
        if self.chance(0.2):
            return self.pick("-", "") + f"#{self.random.randint(1, 12)}"
        if self.known and self.chance(0.3):
            return f"#<{self.random.choice(self.known)}>"
        return f"[{self.digits(low, high)}{self.pick('+', '-')}{self.expression(2)}]"

    def expression(self, depth: int = 3) -> str:
        """An expression without its outer brackets."""
        rng = self.random
        if depth <= 0 or self.chance(0.25):
            roll = rng.random()
            if roll < 0.6:
                return self.digits(-20, 20)
            if roll < 0.8:
                return f"#{rng.randint(1, 12)}"
            if roll < 0.85:
                return f"#{rng.choice((5161, 5181, 5210, 5211, 5213, 5220, 5221, 5223, 5230, 5241, 5400))}"
            if roll < 0.9:
                return f"#{rng.choice((5401, 5403, 5410, 5411, 5420, 5421, 5422, 5423, 5424, 5428, 5399, 31, 5000))}"
            if roll < 0.95 and self.known:
                return f"#<{rng.choice(self.known)}>"
            return f"#<{rng.choice(_PREDEFINED)}>"
        roll = rng.random()
        if roll < 0.55:
            spaced = self.pick(" ", "")
            return self.expression(depth - 1) + spaced + rng.choice(_OPERATORS) + spaced + self.expression(depth - 1)
        if roll < 0.7:
            return f"[{self.expression(depth - 1)}]"
        if roll < 0.85:
            return f"{rng.choice(_FUNCTIONS)}[{self.expression(depth - 1)}]"
        if roll < 0.9:
            return f"ATAN[{self.expression(depth - 1)}]/[{self.expression(depth - 1)}]"
        if roll < 0.93:
            return f"EXISTS[#<{rng.choice([*self.known, 'nothing', '_x', '_nothing'])}>]"
        if roll < 0.96:
            return f"#[{rng.randint(1, 9)}+{rng.randint(0, 3)}]"
        return self.pick("-", "+") + self.expression(depth - 1)

    def axes(self, letters: str = "XYZ", most: int = 3, low: float = -50.0, high: float = 50.0) -> list[str]:
        chosen = self.random.sample(letters, self.random.randint(1, min(most, len(letters))))
        return [letter + self.number(low, high) for letter in chosen]

    def rotary(self) -> list[str]:
        return [letter + self.digits(-180, 180) for letter in self.random.sample("ABC", self.random.randint(1, 2))]

    def system(self) -> str:
        return self.random.choice(_SYSTEMS)

    # -- blocks

    def block(self, *words: str) -> None:
        """Write a block: words in any order, spelt in any of the ways that mean the same."""
        rng = self.random
        parts = [word for word in words if word]
        if self.chance(_WRONG):
            parts = self._spoilt(parts)
        if self.chance(0.3):
            rng.shuffle(parts)
        if self.chance(0.04):
            parts.append(rng.choice(("S1000", "F200", "M8", "M9", "M7", "G61", "G64", "G17", "G90", "T1", "F0", "M3")))
        text = rng.choice((" ", " ", "", "  ", "\t")).join(parts)
        if self.chance(0.05):
            text = text.lower()
        if self.chance(0.04):
            text = f"N{rng.randint(0, 99999)} " + text
        if self.chance(0.02):
            text = "/" + text
        if self.chance(0.03):
            text += rng.choice((" (a comment)", " ; a comment", "(MSG, hello)", " (debug, #1 #<_x>)", " ()"))
        self.lines.append(text)

    def raw(self, text: str) -> None:
        self.lines.append(text)

    def _spoilt(self, parts: list[str]) -> list[str]:
        rng = self.random
        kind = rng.randrange(7)
        if kind == 0 and len(parts) > 1:
            parts.pop(rng.randrange(len(parts)))
        elif kind == 1:
            parts.insert(rng.randrange(len(parts) + 1), rng.choice(_CODES))
        elif kind == 2:
            parts.append(rng.choice("ABCDEFHIJKLMPQRSTXYZ") + self.digits(-5, 5))
        elif kind == 3 and parts:
            at = rng.randrange(len(parts))
            parts[at] = parts[at][0] + self.digits(-9, 9)
        elif kind == 4 and parts:
            parts.append(rng.choice(parts))
        elif kind == 5 and parts:
            at = rng.randrange(len(parts))
            where = rng.randrange(len(parts[at]) + 1)
            parts[at] = parts[at][:where] + rng.choice("[]#=<>()*/+-.%;@^&!\"'_0123456789AXGMO") + parts[at][where:]
        else:
            parts = [rng.choice(_CODES) for _ in range(rng.randint(1, 3))] + self.axes()
        return parts

    def soup(self) -> None:
        """Codes and words at random."""
        rng = self.random
        parts = [rng.choice(_CODES) for _ in range(rng.choice((1, 1, 2)))]
        for letter in rng.sample("ABCDEFHIJKLPQRSTXYZ", rng.randint(0, 4)):
            whole = letter in "DHLPTQ" and self.chance(0.7)
            parts.append(letter + (str(rng.randint(1, 9)) if whole else self.digits(-9, 20)))
        self.block(*parts)

    def program(self) -> str:
        """The whole text."""
        rng = self.random
        wrapped = self.chance(0.1)
        if wrapped:
            self.raw("%")
        if self.chance(0.2):
            self.block(*rng.sample(("G21", "G90", "G17", "G40", "G49", "G80", "G94", "G54"), 4))
        self.block("F" + str(rng.randint(50, 2000)), "S" + str(rng.randint(100, 6000)))
        if self.chance(0.6):
            self.spindle()
        if self.chance(0.8):
            self.block("G0", "X0", "Y0", "Z5")
        for _ in range(rng.randint(4, 22)):
            self.snippet()
        for text, share in ((("M2", "M30")[rng.randrange(2)], 0.97), ("%", 0.02)):
            if self.chance(share):
                self.raw(text)
        if wrapped:
            self.raw("%")
        return "\n".join(self.lines) + "\n"

    def somewhere(self) -> None:
        """A move of X, Y and Z. After a tool change, a probe or a spline the standalone interpreter does not know
        where it stands: it backs off, forgets changes of offsets since the last move, or is not told by `oracle.py`."""
        self.incremental = False
        self.raw(f"G90 G0 X{self.random.randint(1, 99)} Y{self.random.randint(1, 99)} Z{self.random.randint(1, 99)}.5")

    def snippet(self) -> None:
        names = self.focus if self.chance(0.6) else list(SNIPPETS)
        if self.chance(0.03):
            self.soup()
        else:
            SNIPPETS[self.random.choice(names)](self)

    # -- snippets

    def straight(self) -> None:
        for _ in range(self.random.randint(1, 4)):
            words = self.axes()
            if self.chance(0.1):
                words += self.rotary()
            if self.chance(0.1):
                words.append("F" + str(self.random.randint(10, 3000)))
            self.block(self.pick("G0", "G1", "G1", "", "", "G01", "G00"), *words)

    def turn_axes(self) -> None:
        self.block(self.pick("G0", "G1"), *self.rotary())

    def arc(self) -> None:
        rng = self.random
        first, second, third, offset_1, offset_2 = _PLANES[self.plane]
        words = []
        if self.chance(0.15):
            words.append("F" + str(rng.randint(10, 3000)))
        if self.chance(0.35):
            words += [*self.axes(first + second, 2, -9, 9), "R" + self.pick("-", "") + self.digits(9, 40)]
        else:  # there and back by half a circle or a whole one, so that the radii agree
            x, y = rng.randint(-20, 20) / 2, rng.randint(1, 20) / 2
            whole = self.chance(0.4)
            far = self.incremental and not whole
            words += [offset_1 + f"{x}", offset_2 + f"{y}"]
            if far:
                words += [first + f"{2 * x}", second + f"{2 * y}"]
            elif not whole:
                words += [f"{first}[#542{'XYZ'.index(first)}+{2 * x}]", f"{second}[#542{'XYZ'.index(second)}+{2 * y}]"]
            if self.chance(0.3):
                words.append("P" + self.pick("1", "2", "3", "0", "5", "1.5", "-1"))
            if self.chance(0.05):
                words.pop(0)
        if self.chance(0.3):
            words += [third + self.number(-9, 9)]
        if self.chance(0.1):
            words += self.rotary()
        self.block(self.pick("G2", "G3", "G2", "G3", ""), *words)

    def centre_mode(self) -> None:
        self.block(self.pick("G90.1", "G91.1"))
        if self.chance(0.5):
            self.block("G2", *self.axes("XYZ", 2), "I" + self.number(-9, 9), "J" + self.number(-9, 9))
            self.block("G91.1")

    def change_plane(self) -> None:
        self.plane = self.random.choice((17, 18, 19))
        self.block(f"G{self.plane}")

    def change_unit(self) -> None:
        self.inch = not self.inch
        self.block("G20" if self.inch else "G21", *([] if self.chance(0.7) else ["G0", *self.axes()]))

    def change_distance(self) -> None:
        self.incremental = not self.incremental
        self.block("G91" if self.incremental else "G90")

    def feed_mode(self) -> None:
        mode = self.pick("G93", "G94", "G95", "G94")
        self.block(mode, "" if self.chance(0.1) else "F" + self.digits(0.1, 300))
        for _ in range(self.random.randint(0, 3)):
            self.block("G1", *self.axes(), "F" + self.digits(0.5, 20) if self.chance(0.9) else "")
        if mode != "G94" and self.chance(0.8):
            self.block("G94", "F500")

    def dwell(self) -> None:
        self.block("G4", "P" + self.number(0, 3))

    def spindle(self) -> None:
        rng = self.random
        kind = rng.randrange(8)
        if kind == 0:
            self.block("G96", "S" + self.digits(50, 300), "D" + self.digits(500, 4000) if self.chance(0.7) else "")
        elif kind == 1:
            self.block("G97", "S" + self.digits(50, 3000))
        elif kind == 2:
            self.block("M19", "R" + self.digits(0, 360), "P" + self.pick("0", "1", "2") if self.chance(0.5) else "")
        elif kind == 3:
            self.block("M5")
        else:
            self.turning = self.pick("M3", "M4", "M3")
            self.block(self.turning, "S" + self.digits(0, 5000) if self.chance(0.8) else "")
            if self.chance(0.05):
                self.block("M3", "$" + self.pick("0", "1", "-1", "2"))

    def tool(self) -> None:
        rng = self.random
        number = rng.choice(_TOOLS) if self.chance(0.93) else rng.choice((0, 8, 11, 100, -1))
        kind = rng.randrange(9)
        if kind < 3:
            self.block(f"T{number}", "M6")
            self.somewhere()
        elif kind == 3:
            self.block(f"T{number}")
        elif kind == 4:
            self.raw("G40")
            self.raw(f"M61 Q{number}")
            self.raw(f"T{number} M6")  # the standalone interpreter forgets the tool of M61
            self.somewhere()
        elif kind == 5:
            self.block("G43", f"H{number}" if self.chance(0.7) else "")
        elif kind == 6:
            self.block("G43.1", *self.axes("XYZ", 3))
        elif kind == 7:
            self.block("G43.2", f"H{number}")
        else:
            self.block("G49")

    def tool_table(self) -> None:
        rng = self.random
        level = rng.choice((1, 1, 10, 11))
        words = self.axes("XYZ", 3)
        for letter, share in (("R", 0.3), ("I", 0.1), ("J", 0.1), ("Q", 0.1)):
            if self.chance(share):
                words.append(letter + (str(rng.randint(0, 10)) if letter == "Q" else self.digits(-3, 9)))
        self.block("G10", f"L{level}", f"P{rng.choice(_TOOLS)}", *words)
        if self.chance(0.6):
            self.block("G43", f"H{rng.choice(_TOOLS)}")

    def work_system(self) -> None:
        rng = self.random
        level = rng.choice((2, 2, 20))
        turn = "R" + self.digits(-90, 90) if self.chance(0.3) else ""
        self.block("G10", f"L{level}", f"P{rng.randint(0, 9)}", *self.axes("XYZABC", 4), turn)
        if self.chance(0.7):
            self.block(self.system())

    def use_system(self) -> None:
        self.block(self.system(), *([] if self.chance(0.6) else ["G0", *self.axes()]))

    def shift(self) -> None:
        kind = self.random.randrange(6)
        if kind < 2:
            self.block("G92", *self.axes("XYZABC", 4))
        elif kind == 2:
            self.block("G52", *self.axes("XYZA", 3))
        else:
            self.block(self.pick("G92.1", "G92.2", "G92.3"))

    def home(self) -> None:
        self.block(self.pick("G28", "G30", "G28.1", "G30.1"), *([] if self.chance(0.5) else self.axes("XYZA", 2)))

    def machine(self) -> None:
        self.block("G53", self.pick("G0", "G1", "G0", ""), *self.axes())

    def compensated(self) -> None:
        """A contour to the left or right of which the tool runs."""
        rng = self.random
        if self.plane == 19 and self.chance(0.9):
            self.plane = 17
            self.block("G17")
        first, second, third, offset_1, offset_2 = _PLANES[self.plane]
        if self.chance(0.8) and self.incremental:
            self.incremental = False
            self.block("G90")
        code = self.pick("G41", "G42")
        if self.chance(0.4):
            self.block(code + ".1", "D" + self.digits(-0.5, 9))
        else:
            self.block(code, f"D{rng.choice((1, 2, 3, 4, 7, 12, 21))}" if self.chance(0.8) else "")
        here = (rng.randint(-30, 30), rng.randint(-30, 30))
        self.block("G1", f"{first}{here[0]}", f"{second}{here[1]}", "F300" if self.chance(0.2) else "")
        for _ in range(rng.randint(2, 7)):
            step = (rng.randint(-24, 24), rng.randint(-24, 24))
            there = (here[0] + step[0], here[1] + step[1])
            ends = [f"{first}{there[0]}", f"{second}{there[1]}"]
            roll = rng.random()
            if roll < 0.6:
                self.block(self.pick("G1", "", "G0"), *ends)
            elif roll < 0.75:
                self.block(self.pick("G2", "G3"), *ends, f"{offset_1}{step[0] / 2}", f"{offset_2}{step[1] / 2}")
            elif roll < 0.85:
                self.block(self.pick("G2", "G3"), *ends, "R" + self.pick("-", "") + f"{rng.randint(18, 40)}")
            elif roll < 0.92:
                self.block(self.pick("G1", "G0"), third + self.digits(-9, 9))
                continue
            else:
                self.snippet()
                continue
            here = there
        self.block("G40", *([] if self.chance(0.5) else ["G0", f"{first}{here[0] + 20}"]))

    def smooth_contour(self) -> None:
        """Compensation round a shape that leaves room for the tool."""
        rng = self.random
        self.plane = rng.choice((17, 17, 18))
        first, second, third, offset_1, offset_2 = _PLANES[self.plane]
        self.incremental = False
        self.block("G90", f"G{self.plane}", "G40")
        width, height, corner = rng.randint(20, 60), rng.randint(20, 60), rng.randint(4, 9)
        self.block("G0", f"{first}-20", f"{second}-20")
        self.block(self.pick("G41.1", "G42.1"), "D" + self.digits(0.5, 7))
        self.block("G1", f"{first}0", f"{second}{corner}", "F400")
        self.block(f"{second}{height - corner}")
        code = self.pick("G2", "G3") if self.plane == 17 else self.pick("G3", "G2")
        self.block(code, f"{first}{corner}", f"{second}{height}", f"{offset_1}{corner}", f"{offset_2}0")
        self.block("G1", f"{first}{width}")
        if self.chance(0.4):
            self.block("G1", third + self.digits(-5, 5))
        self.block(f"{second}0", f"{first}{width + rng.randint(-8, 8)}")
        self.block(f"{first}{rng.randint(2, 12)}", f"{second}{rng.randint(-5, 5)}")
        self.block("G40", *(["G0", f"{second}-30"] if self.chance(0.6) else []))

    def cycle(self) -> None:
        rng = self.random
        first, second, third, *_ = _PLANES[self.plane]
        code = rng.choice(_CYCLES)
        if self.chance(0.7):
            self.block("G40", "G94", "F200")
        if code in ("G84", "G87", "G86", "G88") and self.chance(0.9):
            self.block("M3", "S500")
        elif code == "G74" and self.chance(0.9):
            self.block("M4", "S500")
        top = rng.randint(1, 6)
        words = [third + self.digits(-12, -1), f"R{top}" if self.chance(0.95) else f"R-{top}"]
        if code in ("G82", "G86", "G88", "G89") or (code in ("G84", "G74") and self.chance(0.3)):
            words.append("P" + self.digits(0, 2))
        if code in ("G73", "G83"):
            words.append("Q" + self.digits(1, 6))
        if code == "G87":
            words += ["I" + self.digits(-2, 2), "J" + self.digits(-2, 2), "K" + self.digits(-8, 0)]
        if self.chance(0.15):
            words.append(f"L{rng.randint(0, 4)}")
        self.block(self.pick("G98", "G99", "", ""), code, *self.axes(first + second, 2), *words)
        for _ in range(rng.randint(0, 4)):
            extra = []
            if self.chance(0.2):
                extra.append(third + self.digits(-12, -1))
            if self.chance(0.15):
                extra.append(f"R{rng.randint(0, 8)}")
            if self.chance(0.1):
                extra.append(f"L{rng.randint(0, 4)}")
            self.block(self.pick("", "", code, "G98", "G99"), *self.axes(first + second, 2), *extra)
        if self.chance(0.85):
            self.block("G80", *([] if self.chance(0.8) else ["G0", *self.axes()]))

    def retract(self) -> None:
        self.block(self.pick("G98", "G99"))

    def spline(self) -> None:
        rng = self.random
        if self.chance(0.9):
            self.plane = 17
            self.block("G17", "G40", "G94", "F300")
        self.somewhere()
        kind = rng.randrange(3)
        if kind == 0:
            self.block("G5", "I" + self.digits(-9, 9), "J" + self.digits(1, 9), "P-4", "Q-6", *self._ends())
            for _ in range(rng.randint(0, 2)):
                start = [] if self.chance(0.7) else ["I2", "J3"]
                self.block(
                    self.pick("G5", "G5", ""), *start, "P" + self.digits(-9, 9), "Q" + self.digits(-9, 9), *self._ends()
                )
        elif kind == 1:
            self.block("G5.1", *self._ends(), "I" + self.digits(-9, 9), "J" + self.digits(1, 9))
        else:
            order = rng.choice(("", "L3", "L4", "L2", "L3"))
            self.block("G5.2", *(self._ends() if self.chance(0.8) else []), "P" + self.digits(0.5, 3), order)
            for _ in range(rng.randint(1, 5)):
                self.block(*self._ends(), "P" + self.digits(0.5, 3) if self.chance(0.95) else "")
            self.block("G5.3")
        self.somewhere()

    def _ends(self) -> list[str]:
        return ["X" + self.digits(-30, 30), "Y" + self.digits(-30, 30)]

    def thread(self) -> None:
        rng = self.random
        if self.chance(0.9):
            self.block("M3", "S300")
        kind = rng.randrange(3)
        if kind == 0:
            self.block("G33", *self.axes(), "K" + self.digits(0.5, 3))
        elif kind == 1:
            self.block("G33.1", *self.axes(), "K" + self.digits(0.5, 3), "I2" if self.chance(0.1) else "")
        else:
            if self.chance(0.9):
                self.plane = 18
                self.block("G18")
            self.block("G0", "X" + str(rng.randint(10, 30)), "Z5")
            words = ["P" + self.digits(0.7, 3), "Z" + str(-rng.randint(10, 40))]
            words += [f"I{self.pick('-', '')}{rng.randint(1, 4)}", f"J0.{rng.randint(1, 9)}", f"K{rng.randint(1, 3)}"]
            if self.chance(0.3):
                words.append(f"R{rng.choice(('1', '1.5', '2', '0.5'))}")
            if self.chance(0.3):
                words.append(f"Q{rng.choice(('29.5', '30', '0', '60'))}")
            if self.chance(0.3):
                words.append(f"H{rng.randint(0, 3)}")
            if self.chance(0.3):
                words += [f"E{rng.randint(0, 3)}", f"L{rng.randint(0, 4)}"]
            self.block("G76", *words)

    def probe(self) -> None:
        self.incremental = False
        self.raw("G90 G40 G0 X1 Y2 Z3")
        self.block(self.pick("G38.2", "G38.3", "G38.4", "G38.5"), *self.axes("XYZ", 3, 5, 50))
        if self.chance(0.5):
            self.block("#1=#5063", "#2=#5061")
        self.somewhere()

    def polar(self) -> None:
        if self.chance(0.8):
            self.plane = 17
            self.block("G17")
        words = []
        if self.chance(0.8):
            words.append("@" + self.number(0, 40))
        if self.chance(0.8):
            words.append("^" + self.number(-180, 180))
        if self.chance(0.2):
            words.append("Z" + self.digits(-5, 5))
        self.block(self.pick("G0", "G1", "G1", "G81 Z-3 R2", "G2 R30"), *words)

    def diameter(self) -> None:
        self.block(self.pick("G7", "G8"))
        if self.chance(0.5):
            self.block(self.pick("G0", "G1"), *self.axes("XZ", 2))
        if self.chance(0.7):
            self.block("G8")

    def path(self) -> None:
        kind = self.pick("G61", "G61.1", "G64", "G64")
        extra = ["P" + self.digits(0, 1), "Q" + self.digits(0, 1) if self.chance(0.4) else ""]
        self.block(kind, *(extra if kind == "G64" and self.chance(0.7) else []))

    def switches(self) -> None:
        code = self.pick("M48", "M49", "M50", "M51", "M52", "M53", "M7", "M8", "M9", "M0", "M1", "M60")
        self.block(
            code, "P" + self.pick("0", "1", "2") if code in ("M50", "M51", "M52", "M53") and self.chance(0.6) else ""
        )

    def outputs(self) -> None:
        code = self.pick("M62", "M63", "M64", "M65", "M66", "M67", "M68")
        if code == "M66":
            words = [self.pick("P", "E") + str(self.random.randint(0, 3))]
            if self.chance(0.5):
                words += ["L" + self.pick("0", "1", "2", "3", "4"), "Q" + self.digits(0, 5)]
        elif code in ("M67", "M68"):
            words = [f"E{self.random.randint(0, 3)}", "Q" + self.digits(-9, 9)]
        else:
            words = [f"P{self.random.randint(0, 63)}"]
        self.block(code, *words)

    def saved_state(self) -> None:
        self.block("M70")
        self.snippet()
        self.block(self.pick("M72", "M71", "M72", "M73"))

    def setting(self) -> None:
        rng = self.random
        kind = rng.randrange(6)
        if kind < 3:
            self.block(f"#{rng.randint(1, 12)}={self.pick('', '-')}[{self.expression()}]")
        elif kind == 3:
            name = self.pick("a", "depth", "_global", "long name", "_G2")
            self.block(f"#<{name}>={self.number()}")
            self.known.append(name)
        elif kind == 4:
            self.block(
                f"#{rng.randint(1, 4)}={self.number()}",
                f"#{rng.randint(1, 4)}=[{self.expression(2)}]",
                "G0",
                *self.axes(),
            )
        else:
            number = rng.choice(
                (5161, 5163, 5181, 5211, 5213, 5221, 5222, 5223, 5230, 5241, 5250, 5220, 5210, 5420, 5399)
            )
            self.block(f"#{number}={self.number()}")

    def note(self) -> None:
        text = self.pick(
            "MSG,", "DEBUG,", "PRINT,", "LOG,", "msg ,", "", "LOGOPEN,x", "PROBEOPEN y", "PROBECLOSE", "debug,"
        )
        body = "".join(
            self.random.choice(
                (" a", "#1", "#<_x>", "%d", "%.2f", "%f", "#<nothing>", " #2", "[#1+1]", "#5420", "%", "# ")
            )
            for _ in range(self.random.randint(0, 5))
        )
        self.raw(f"({text}{body}.)" if self.chance(0.95) else f";{text}{body}")

    def label(self) -> str:
        self.labels += 1
        return self.pick(f"o{self.labels}", f"O{self.labels}", f"o<lab{self.labels}>", f"o {self.labels}")

    def nested(self, most: int = 3) -> None:
        self.depth += 1
        for _ in range(self.random.randint(1, most)):
            if self.depth < 4:
                self.snippet()
            else:
                self.straight()
        self.depth -= 1

    def branch(self) -> None:
        name = self.label()
        self.raw(f"{name} if [{self.expression(2)}]")
        self.nested(2)
        for _ in range(self.random.choice((0, 0, 1, 2))):
            self.raw(f"{name} elseif [{self.expression(2)}]")
            self.nested(1)
        if self.chance(0.5):
            self.raw(f"{name} else")
            self.nested(2)
        if self.chance(0.98):
            self.raw(f"{name} endif")

    def loop(self) -> None:
        rng = self.random
        name, count = self.label(), 20 + self.labels % 10
        kind = rng.randrange(3)
        leave = self.chance(0.3)
        if kind == 0:
            self.raw(f"{name} repeat [{self.random.choice(('2', '3', '0', '1', '2.4', '2.5', '-1'))}]")
        else:
            self.raw(f"#{count}=0")
            self.raw(f"{name} while [#{count} lt {rng.randint(0, 4)}]" if kind == 1 else f"{name} do")
            self.raw(f"#{count}=[#{count}+1]")
        self.nested(2)
        if leave:
            inner = self.label()
            self.raw(f"{inner} if [#{count} eq {rng.randint(1, 3)}]")
            self.raw(f"{name} {self.pick('break', 'continue')}")
            self.raw(f"{inner} endif")
        self.straight()
        if self.chance(0.98):
            self.raw(
                f"{name} endrepeat"
                if kind == 0
                else f"{name} endwhile"
                if kind == 1
                else f"{name} while [#{count} lt {rng.randint(1, 4)}]"
            )

    def subroutine(self) -> None:
        rng = self.random
        if self.depth:
            return self.straight()
        name = self.label()
        call = f"{name} call" + "".join(f" [{self.expression(1)}]" for _ in range(rng.choice((0, 1, 1, 2, 2, 3, 4, 7))))
        first = self.chance(0.2)
        if first:
            self.raw(call)
        self.raw(f"{name} sub")
        known = self.known
        self.known = [name for name in known if name.startswith("_")]
        self.nested(3)
        self.block("G0", "X#1", "Y#2")
        if self.chance(0.15):
            inner = self.label()
            self.raw(f"{inner} if [#1 gt 0]")
            self.raw(f"{name} return" + (f" [{self.expression(1)}]" if self.chance(0.5) else ""))
            self.raw(f"{inner} endif")
        self.known = known
        if self.chance(0.98):
            self.raw(f"{name} endsub" + (f" [{self.expression(1)}]" if self.chance(0.4) else ""))
        for _ in range(rng.randint(0, 2)):
            self.raw(call)
            if self.chance(0.3):
                self.block("#3=#<_value>", "#4=#<_value_returned>")
        return None

    def file_call(self) -> None:
        self.raw(
            self.pick(
                "o<vis_square> call [1] [2] [3]", "o777 call [5]", "o<nothing> call", "o<vis_square> call", "M98 P777"
            )
        )

    def m98(self) -> None:
        number = self.random.randint(1000, 1009)
        if self.depth or self.chance(0.7):
            self.raw(f"M98 P{number}" + (f" L{self.random.randint(0, 3)}" if self.chance(0.4) else ""))
            return
        self.raw(f"O{number}")
        self.straight()
        self.raw("M99")

    def empty(self) -> None:
        self.raw(
            self.pick("", "   ", "(only a comment)", ";only a comment", "N10", "/", "%", "(", ")", "N", "o", "N10 N20")
        )


SNIPPETS: dict[str, Callable[[Author], None]] = {
    "straight": Author.straight,
    "turn axes": Author.turn_axes,
    "arc": Author.arc,
    "centre mode": Author.centre_mode,
    "plane": Author.change_plane,
    "unit": Author.change_unit,
    "distance": Author.change_distance,
    "feed mode": Author.feed_mode,
    "dwell": Author.dwell,
    "spindle": Author.spindle,
    "tool": Author.tool,
    "tool table": Author.tool_table,
    "work system": Author.work_system,
    "use system": Author.use_system,
    "shift": Author.shift,
    "home": Author.home,
    "machine coordinates": Author.machine,
    "compensation": Author.compensated,
    "contour": Author.smooth_contour,
    "cycle": Author.cycle,
    "retract": Author.retract,
    "spline": Author.spline,
    "thread": Author.thread,
    "probe": Author.probe,
    "polar": Author.polar,
    "diameter": Author.diameter,
    "path": Author.path,
    "switches": Author.switches,
    "outputs": Author.outputs,
    "saved state": Author.saved_state,
    "setting": Author.setting,
    "note": Author.note,
    "branch": Author.branch,
    "loop": Author.loop,
    "subroutine": Author.subroutine,
    "file call": Author.file_call,
    "m98": Author.m98,
    "empty": Author.empty,
}


def write(seed: int | str) -> bytes:
    """The program of `seed`."""
    return Author(seed).program().encode()
