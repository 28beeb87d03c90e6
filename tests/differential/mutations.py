"""Seeded mutations of programs: bytes, words, lines."""

from __future__ import annotations

import random
import re

_TOKEN = re.compile(rb"[A-Za-z@^$][ \t]*[+-]?[0-9.]+|#<[^>]*>|#[0-9]+|\[|\]|[A-Za-z]+|[0-9.]+|.", re.DOTALL)
_NUMBERS = (
    b"0",
    b"1",
    b"-1",
    b"0.0001",
    b"1e5",
    b"99999999999",
    b"-0.5",
    b"2",
    b"1.5",
    b"#1",
    b"[1/0]",
    b".",
    b"1000000000000",
)
_BITS = (
    *(
        b"[",
        b"]",
        b"#",
        b"<",
        b">",
        b"=",
        b"(",
        b")",
        b"%",
        b";",
        b"/",
        b"*",
        b"-",
        b"+",
        b".",
        b"\t",
        b" ",
        b"\r",
        b"\n",
    ),
    *(
        b"G41",
        b"G42 D1",
        b"G40",
        b"G91",
        b"G20",
        b"G18",
        b"G93",
        b"G10 L2 P1",
        b"M6 T1",
        b"M3 S100",
        b"G81",
        b"G80",
        b"G92",
    ),
    *(
        b"o1 if [1]",
        b"o1 endif",
        b"o2 sub",
        b"o2 endsub",
        b"o2 call",
        b"M98 P1000",
        b"M99",
        b"M2",
        b"o3 while [#1 LT 9]",
    ),
    *(b"R5", b"I1", b"J-1", b"K2", b"P3", b"L2", b"Q1", b"F0", b"H2", b"@5", b"^30", b"G5.2", b"G5.3", b"G33", b"G76"),
)


def mutated(program: bytes, seed: int | str, *, most: int = 4) -> bytes:
    """`program` with one to `most` changes."""
    rng = random.Random(seed)
    for _ in range(rng.randint(1, most)):
        program = rng.choice(_KINDS)(program, rng)
    return program


def _byte(program: bytes, rng: random.Random) -> bytes:
    """One byte more, less or another one."""
    at = rng.randrange(len(program) + 1)
    new = bytes((rng.randrange(256),)) if rng.random() < 0.3 else rng.choice(_BITS[:19])
    return program[:at] + rng.choice((b"", new, new)) + program[at + rng.randint(0, 1) :]


def _token(program: bytes, rng: random.Random) -> bytes:
    """A word or number dropped, doubled, swapped with the next or replaced."""
    tokens = _TOKEN.findall(program)
    if len(tokens) < 2:
        return program
    at = rng.randrange(len(tokens) - 1)
    kind = rng.randrange(5)
    if kind == 0:
        tokens.pop(at)
    elif kind == 1:
        tokens.insert(at, tokens[at])
    elif kind == 2:
        tokens[at], tokens[at + 1] = tokens[at + 1], tokens[at]
    elif kind == 3:
        tokens[at] = rng.choice(tokens)
    else:
        tokens.insert(at, b" " + rng.choice(_BITS[19:]) + b" ")
    return b"".join(tokens)


def _number(program: bytes, rng: random.Random) -> bytes:
    """A number replaced by an odd one, or moved a little."""
    places = list(re.finditer(rb"[+-]?[0-9]+\.?[0-9]*", program))
    if not places:
        return program
    place = rng.choice(places)
    new = rng.choice(_NUMBERS)
    if rng.random() < 0.5:
        new = f"{float(place.group()) * rng.choice((-1, 0.5, 2, 1.001)) + rng.choice((0, 1, -1)):.4f}".encode()
    return program[: place.start()] + new + program[place.end() :]


def _line(program: bytes, rng: random.Random) -> bytes:
    """A line dropped, doubled, moved, cut, joined with the next or made of bits."""
    lines = program.split(b"\n")
    at = rng.randrange(len(lines))
    kind = rng.randrange(6)
    if kind == 0:
        lines.pop(at)
    elif kind == 1:
        lines.insert(at, lines[rng.randrange(len(lines))])
    elif kind == 2:
        lines.insert(rng.randrange(len(lines)), lines.pop(at))
    elif kind == 3:
        lines[at] = lines[at][: rng.randrange(len(lines[at]) + 1)]
    elif kind == 4 and at + 1 < len(lines):
        lines[at] += b" " + lines.pop(at + 1)
    else:
        lines.insert(at, b" ".join(rng.choice(_BITS[19:]) for _ in range(rng.randint(1, 3))))
    return b"\n".join(lines)


_KINDS = (_byte, _token, _token, _number, _line)
