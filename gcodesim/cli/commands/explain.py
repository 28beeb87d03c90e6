"""`gcodesim explain CODE`: what a finding means, why it matters, what to do, and an example."""

from __future__ import annotations

import argparse
import re
import textwrap
from typing import Any, Final

from gcodesim.cli.exits import OK, UsageError
from gcodesim.cli.nearest import did_you_mean, nearest
from gcodesim.cli.outline import may_be


def add_parser(commands: Any) -> None:
    parser = commands.add_parser(
        "explain",
        help="what a finding means, why it matters, what to do; what a G or M code means",
        description="Explain a finding by its code: what it means, why it matters, what to do, and a small example "
        "with what is printed about it; `gcodesim list codes` shows all. Of a word such as G43 or M6, say what it "
        "means to each dialect.",
    )
    may_be(parser.add_argument("code", metavar="CODE", help="a code such as GS203, or a word such as G43"), _codes)
    parser.set_defaults(run=run)


_WORD: Final = re.compile(r"([GM])0*([0-9]{1,4}(?:\.[0-9])?)")


def _explain_word(text: str) -> int:
    """What a G or M code means, by dialects."""
    from gcodesim.rs274.dialects import DIALECTS
    from gcodesim.rs274.dialects.meanings import meanings_of

    match = _WORD.fullmatch(text)
    assert match is not None
    code = f"{match[1]}{float(match[2]):g}"
    dialects: dict[str, list[str]] = {}
    for name in DIALECTS:
        if (meaning := meanings_of(DIALECTS[name]).get(code)) is not None:
            dialects.setdefault(meaning, []).append(name)
    if not dialects:
        raise UsageError(f"no dialect has a code {code}")
    print(f"{code}:")
    for meaning, names in dialects.items():
        print(f"  {meaning} ({', '.join(names)})")
    return OK


def _codes() -> list[str]:
    from gcodesim.diagnostics import codes

    return [code.code for code in codes()]


def run(arguments: argparse.Namespace) -> int:
    from gcodesim.diagnostics import code_of, codes

    wanted = arguments.code.upper()
    if _WORD.fullmatch(wanted) is not None:
        return _explain_word(wanted)
    try:
        code = code_of(wanted)
    except KeyError:
        guess = did_you_mean(nearest(wanted, [c.code for c in codes()]))
        raise UsageError(f"there is no finding {arguments.code}{guess} (`gcodesim list codes` names all)") from None
    print(f"{code.code}: {code.title} ({code.severity.word})")
    for head, text in (("", code.what), ("Why it matters", code.why), ("What to do", code.remedy)):
        if text:
            print()
            if head:
                print(f"{head}:")
            print(textwrap.fill(" ".join(text.split()), 88, initial_indent="  ", subsequent_indent="  "))
    _print_example(code.code)
    return OK


def _print_example(code: str) -> None:
    from gcodesim.diagnostics.examples import example_of

    example = example_of(code)
    if example is None:
        return
    for name, text in example.files.items():
        print(f"\nExample {name}:")
        print(textwrap.indent(text.rstrip("\n"), "  ", lambda _: True))
    print(f"\nWhat `gcodesim {example.command}` prints:")
    print(textwrap.indent(example.printed.rstrip("\n"), "  ", lambda _: True))
