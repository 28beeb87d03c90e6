"""Findings of other packages: codes `NAME-123`, of which `NAME` belongs to the package that adds them.

An entry point `engraver` of group `gcodesim.findings` names a list of `Code`, whose codes are `ENGRAVER-000` to
`ENGRAVER-999`. They never clash with ours, which have no hyphen, and one name has one package.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import fields
from typing import Final

from gcodesim.diagnostics.catalogue.code import Code
from gcodesim.diagnostics.finding import Severity
from gcodesim.family import ExtensionError, Family

FINDINGS: Final = Family("findings")

OTHERS: Final = "[A-Z][A-Z0-9]{2,15}-[0-9]{3}"
"""The pattern of a code of another package."""

_SHAPE: Final = re.compile(OTHERS)


def is_of_others(code: str) -> bool:
    """Whether a code has the shape of those that other packages add."""
    return _SHAPE.fullmatch(code) is not None


def table_of(name: str) -> dict[str, Code]:
    """Codes of the package with this name, `engraver`; KeyError when there is none."""
    table: dict[str, Code] = {}
    listed = FINDINGS[name]
    if not isinstance(listed, (list, tuple)) or not all(isinstance(each, Code) for each in listed):
        raise ExtensionError(f"the findings `{name}` of another package are no list of `Code`")
    for code in listed:
        for field in fields(Code):
            kind, value = Severity if field.name == "severity" else str, getattr(code, field.name)
            if not isinstance(value, kind):
                wanted = "one of `Severity`, such as `Severity.WARNING`" if kind is Severity else "a text"
                raise ExtensionError(
                    f"the findings `{name}` of another package: `{field.name}` of {code.code} is {value!r}; "
                    f"it has to be {wanted}"
                )
        if not is_of_others(code.code) or code.code.partition("-")[0] != name.upper():
            raise ExtensionError(
                f"the findings `{name}` of another package have the code {code.code}; "
                f"theirs are `{name.upper()}-` and three digits, of a name with 3 to 16 letters and digits"
            )
        table[code.code] = code
    return table


def code_of_others(code: str) -> Code:
    """The entry of `code`, such as `ENGRAVER-101`; KeyError when there is none."""
    return table_of(code.partition("-")[0].lower())[code]


def codes_of_others() -> Iterator[Code]:
    """All codes of other packages, in order."""
    for name in FINDINGS:
        yield from sorted(table_of(name).values(), key=lambda code: code.code)
