"""Seeded changes of programs that mean nothing: the other side of `regress.mutation`."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from random import Random
from typing import Final

from gcodesim.arithmetic.elementary import cos, sin
from gcodesim.diagnostics import SourceText
from gcodesim.regress.motion import steps_of
from gcodesim.regress.mutation import _ARC_PLACES, _CALLS, _WORD, Mutation, Operator, _applied, _code, _number
from gcodesim.rs274 import Settings, interpret
from gcodesim.rs274.assumed import assumed_tools


def _numbered(random: Random, lines: list[str]) -> tuple[str, tuple[str, ...]] | None:
    number, step = random.randrange(1, 50), random.choice((1, 5, 10))
    for index, line in enumerate(lines):
        bare = re.sub(r"^\s*[nN]\s*[0-9]+\s*", "", line)
        if _code(bare).strip():
            lines[index] = f"N{number} {bare}"
            number += step
    return f"numbered by {step}", ()


def _plain_words(code: str) -> list[str]:
    """The words of a block, if it consists of nothing else."""
    words = [match[0] for match in _WORD.finditer(code)]
    return words if "".join("".join(words).split()) == "".join(code.split()) else []


def _spaced(random: Random, lines: list[str]) -> tuple[str, tuple[str, ...]] | None:
    blank = random.choice(("", " ", "   ", "\t"))
    for index, line in enumerate(lines):
        code = _code(line)
        if _plain_words(code):
            words = blank.join(f"{m[1]}{random.choice(('', ' '))}{m[2]}" for m in _WORD.finditer(code))
            lines[index] = f"{random.choice(('', ' '))}{words} {line[len(code) :]}".rstrip()
    return f"words {len(blank)} blanks apart", ()


def _cased(random: Random, lines: list[str]) -> tuple[str, tuple[str, ...]] | None:
    for index, line in enumerate(lines):
        code = _code(line)
        lines[index] = "".join(random.choice((c.lower(), c.upper())) for c in code) + line[len(code) :]
    return "letters of either case", ()


def _reordered(random: Random, lines: list[str]) -> tuple[str, tuple[str, ...]] | None:
    """Words of a block in another order, which does not matter to the control; a number N stays in front."""
    count = 0
    for index, line in enumerate(lines):
        words = _plain_words(_code(line))
        # to some controls the place of a call in its block does matter
        if len(words) < 2 or _CALLS & {word[0].upper() for word in words} or random.random() < 0.4:
            continue
        front = 1 if words[0][0] in "Nn" else 0
        moved = words[front:]
        random.shuffle(moved)
        lines[index] = " ".join([*words[:front], *moved]) + _tail(line)
        count += 1
    return f"words of {count} lines in another order", ()


def _line_ends(random: Random, lines: list[str]) -> tuple[str, tuple[str, ...]] | None:
    """Line ends of another system."""
    lines[:] = [f"{line}\r" for line in lines]
    return "lines end with CR LF", ()


def _commented(random: Random, lines: list[str]) -> tuple[str, tuple[str, ...]] | None:
    count = 0
    for index in range(len(lines) - 1, 0, -1):
        if random.random() < 0.5:
            text = f"remark {random.randrange(1000)}: X1 Y2 G0"
            if _code(lines[index]).strip() and random.random() < 0.5:
                lines[index] += random.choice((f" ({text})", f" ; {text}"))
            else:
                lines.insert(index, random.choice((f"({text})", f"; {text}", "")))
            count += 1
    return f"{count} comments and blank lines", ()


def _spelled(random: Random, lines: list[str]) -> tuple[str, tuple[str, ...]] | None:
    """Leading and trailing zeros, signs: the same numbers."""

    def other(match: re.Match[str]) -> str:
        letter, text = match[1], match[2]
        if letter.upper() in "GMTHDNS":
            whole = "." not in text and "+" not in text and letter.upper() in "GM"
            return f"{letter}{text.zfill(2)}" if whole else match[0]
        sign = "-" if text.startswith("-") else random.choice(("", "+"))
        digits = text.lstrip("+-")
        digits += "" if "." in digits else "."
        return f"{letter}{sign}{random.choice(('', '0', '00'))}{digits}{random.choice(('0', '00', '000'))}"

    for index, line in enumerate(lines):
        code = _code(line)
        if code:
            lines[index] = _WORD.sub(other, code) + line[len(code) :]
    return "numbers written otherwise", ()


def _modal(random: Random, lines: list[str]) -> tuple[str, tuple[str, ...]] | None:
    """The motion word that is in force, repeated where it was left out."""
    motion = None
    count = 0
    for index, line in enumerate(lines):
        code = _code(line)
        if not code and line.strip()[:1] not in ("", "(", ";"):
            motion = None  # a line that computes may name another
            continue
        words = [(m[1].upper(), float(m[2])) for m in _WORD.finditer(code)]
        codes = [value for letter, value in words if letter == "G"]
        motion = next((value for value in codes if value in (0.0, 1.0, 2.0, 3.0)), None if codes else motion)
        if motion in (0.0, 1.0) and not codes and any(letter in "XYZ" for letter, _ in words) and random.random() < 0.7:
            match = re.match(r"\s*(?:[nN]\s*[0-9]+\s*)?", line)
            at = match.end() if match else 0
            lines[index] = f"{line[:at]}G{int(motion)} {line[at:]}"
            count += 1
    return f"{count} motion words said again", ()


def _arcs_by_radius(random: Random, lines: list[str]) -> tuple[str, tuple[str, ...]] | None:
    """Arcs by centre become arcs by radius on the same path."""
    count = 0
    for index, (_, _, radius, sweep) in _plain_arcs(lines).items():
        if 5.0 < abs(sweep) < 170.0 and random.random() < 0.8:
            line = lines[index]
            code = re.sub(r"\s*[IJij]\s*[+-]?[0-9.]+", "", _code(line))
            lines[index] = f"{code.rstrip()} R{_number(radius, _ARC_PLACES)}{_tail(line)}"
            count += 1
    return f"{count} arcs by radius", ()


def _arcs_divided(random: Random, lines: list[str]) -> tuple[str, tuple[str, ...]] | None:
    """Arcs in two parts about the same centre."""
    count = 0
    for index, (start, center, _, sweep) in sorted(_plain_arcs(lines).items(), reverse=True):
        if abs(sweep) < 20.0 or random.random() < 0.3:
            continue
        line = lines[index]
        angle = math.radians(sweep) * random.uniform(0.3, 0.7)
        rx, ry = start[0] - center[0], start[1] - center[1]
        x = center[0] + rx * cos(angle) - ry * sin(angle)
        y = center[1] + rx * sin(angle) + ry * cos(angle)
        words = {m[1].upper(): m[2] for m in _WORD.finditer(_code(line))}
        g, feed = words["G"], f" F{words['F']}" if "F" in words else ""

        def part(x_text: str, y_text: str, i: float, j: float, g: str = g, feed: str = feed) -> str:
            return f"G{g} X{x_text} Y{y_text} I{_number(i, _ARC_PLACES)} J{_number(j, _ARC_PLACES)}{feed}"

        first = part(_number(x, _ARC_PLACES), _number(y, _ARC_PLACES), -rx, -ry)
        end_x = words.get("X", _number(start[0], _ARC_PLACES))
        end_y = words.get("Y", _number(start[1], _ARC_PLACES))
        lines[index : index + 1] = [first, part(end_x, end_y, center[0] - x, center[1] - y) + _tail(line)]
        count += 1
    return f"{count} arcs in two parts", ()


def _tail(line: str) -> str:
    """The comment of a line."""
    rest = line[len(_code(line)) :]
    return f" {rest}" if rest else ""


def _plain_arcs(lines: list[str]) -> dict[int, tuple[tuple[float, float], tuple[float, float], float, float]]:
    """Arcs in XY that a line gives by X, Y, I, J alone: start, centre, radius [mm] and sweep [deg] in the program."""
    source = SourceText("program", ("\n".join(lines) + "\n").encode())
    run = interpret(source, Settings(tool_table=assumed_tools(source)))
    arcs = {}
    for step in steps_of(run):
        arc = step.arc
        if arc is None or abs(arc.normal[2] - 1.0) > 1e-9 or step.end is None:
            continue
        code = _code(lines[step.line - 1])
        words = [m[1].upper() for m in _WORD.finditer(code)]
        plain = set(words) <= set("NGXYIJF") and words.count("G") == 1 and {"I", "J"} & set(words)
        if plain and step.line - 1 not in arcs:
            start, center = step.system.to_program(step.start), step.system.to_program(arc.center)
            radius = math.dist(start[:2], center[:2])
            said = {m[1].upper(): float(m[2]) for m in _WORD.finditer(code)}
            asked = (center[0] - start[0], center[1] - start[1])
            if max(abs(said.get(letter, 0.0) - way) for letter, way in zip("IJ", asked, strict=True)) > 1e-4:
                continue  # in inches, or moved by a compensation
            arcs[step.line - 1] = ((start[0], start[1]), (center[0], center[1]), radius, arc.sweep)
    return arcs


NEUTRAL_OPERATORS: Final[Mapping[str, Operator]] = {
    "line ends": _line_ends,
    "numbering": _numbered,
    "spaces": _spaced,
    "case": _cased,
    "word order": _reordered,
    "comments": _commented,
    "number formats": _spelled,
    "modal words": _modal,
    "arcs by radius": _arcs_by_radius,
    "arcs divided": _arcs_divided,
}


def edit_neutrally(random: Random, text: str, operators: tuple[str, ...] = ()) -> Mutation:
    """A program that means the same: one or several neutral edits, drawn where `operators` names none."""
    names = operators or tuple(random.sample(list(NEUTRAL_OPERATORS), random.randint(1, 3)))
    # edits that read words come before those that spell them in odd ways
    ordered = [name for name in reversed(tuple(NEUTRAL_OPERATORS)) if name in names]
    told = []
    for name in ordered:
        done = _applied(name, NEUTRAL_OPERATORS[name], random, text)
        if done is not None:
            text = done.text
            told.append(done.what)
    return Mutation(operator=" + ".join(ordered), text=text, what="; ".join(told))
