"""Numbers and switches out of a scalar's text, read by us and not by YAML.

`9e5` and `1e3` are numbers although YAML 1.1 readers take them for text; `1_0`,
`0x10`, `.inf` and digits of other scripts are none.
"""

from __future__ import annotations

import re

from gcodesim.frozen import frozen

_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
_INTEGER = re.compile(r"[+-]?[0-9]+")
_TRUE = ("true", "True", "TRUE")
_FALSE = ("false", "False", "FALSE")
_DOUBTFUL = ("on", "off", "yes", "no", "y", "n")


@frozen(kw_only=False)
class Measured:
    """A number and the text of its unit, empty when there is none. `value` may be infinite when it is too large."""

    value: float
    unit: str


def measured(text: str) -> Measured | None:
    """`10 mm`, `1e3`, `9e5N·m/rad` → number and unit; None when the text does not begin with a number."""
    text = text.strip()
    match = _NUMBER.match(text)
    if match is None:
        return None
    rest = text[match.end() :]
    if rest and ((rest[0].isalnum() and not rest[0].isalpha()) or rest[0] in "._,+-"):
        return None  # `1_0`, `1.2.3`, `1,5`, `1-2`: no number with something behind it
    if rest[:1] in ("x", "o", "b") and rest[1:2].isdigit():
        return None  # `0x10`
    unit = rest.strip()
    return None if unit[:1].isdigit() else Measured(float(match.group()), unit)


def integer(text: str) -> int | None:
    """A whole number written as one: `3`, `+3`, not `3.0`."""
    text = text.strip()
    return int(text) if _INTEGER.fullmatch(text) and len(text) < 20 else None


def switch(text: str) -> bool | None:
    """`true` or `false` as YAML 1.2 has them."""
    if text in _TRUE:
        return True
    return False if text in _FALSE else None


def why_no_number(text: str) -> str:
    """A hint for texts that look like numbers elsewhere."""
    bare = text.strip()
    if "_" in bare and _NUMBER.fullmatch(bare.replace("_", "")):
        return f"digits are not grouped: write `{bare.replace('_', '')}`"
    if "," in bare and _NUMBER.match(bare.replace(",", ".", 1)):
        return f"the decimal sign is a point: write `{bare.replace(',', '.', 1)}`"
    if bare.lower().lstrip("+-") in (".inf", ".nan", "inf", "nan", "infinity"):
        return "only finite numbers are read"
    if bare[:2].lower() in ("0x", "0o", "0b"):
        return "numbers are decimal"
    if any(c.isdigit() and not c.isascii() for c in bare):
        return "digits are 0 to 9"
    return ""


def why_no_switch(text: str) -> str:
    """A hint for words that were switches in YAML 1.1."""
    if text.lower() in _DOUBTFUL:
        return f"`{text}` is a text in YAML 1.2: write `true` or `false`"
    return "write `true` or `false`"
