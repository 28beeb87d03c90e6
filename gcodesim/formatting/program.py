"""A whole program in the style, and the proof that it still does the same."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from typing import Final

from gcodesim.diagnostics import Diagnostic, SourceText, Span
from gcodesim.formatting.comments import CommentedLine, ends_in_comment, joined, place_of_comment
from gcodesim.formatting.indentation import depths_of
from gcodesim.formatting.line import line_text
from gcodesim.formatting.numbering import Numbering, renumbered
from gcodesim.formatting.proof import difference
from gcodesim.formatting.style import Style
from gcodesim.frozen import frozen
from gcodesim.rs274 import Settings, file_of, lint
from gcodesim.rs274.dialects import DIALECTS, Dialect
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.program_file import ProgramFile
from gcodesim.rs274.tokens import VERBATIM

_LINE_END: Final = re.compile(r"\r\n|\n|\r")


class CannotFormatError(Exception):
    """A program is left alone; `findings` say why, errors first of all."""

    def __init__(self, findings: Sequence[Diagnostic]) -> None:
        super().__init__(findings[0].message)
        self.findings = tuple(findings)


@frozen
class Formatted:
    """`program` in the style, with the lines that `changed` (from 1); `unread` lines nobody reads stay as they were."""

    program: SourceText
    changed: tuple[int, ...]
    unread: tuple[int, ...]


def formatted(program: SourceText, settings: Settings, style: Style) -> Formatted:
    """The program in the style, line for line, after the proof that it says and does the same.

    Raises `CannotFormatError` for a program with errors, and where N numbers cannot be made anew.
    """
    errors = [finding for finding in lint(program, settings) if finding.level >= finding.level.ERROR]
    if errors:
        raise CannotFormatError(errors)
    file = file_of(program, settings)
    numbering = Numbering() if style.step is None else renumbered(file, style.step)
    if numbering.problems:
        raise CannotFormatError(numbering.problems)
    texts, unread = _lines(file, style, DIALECTS[settings.dialect], numbering)
    changed = tuple(n for n, (old, new) in enumerate(zip(file.lines, texts, strict=True), 1) if old != new)
    written = _written(program, texts)
    is_new = bool(changed) or written.raw != program.raw
    if is_new and (reason := difference(program, written, settings, numbering)):
        raise AssertionError(f"formatting {program.name} would change it: {reason}")
    return Formatted(program=written, changed=changed, unread=unread)


def _lines(
    file: ProgramFile, style: Style, dialect: Dialect, numbering: Numbering
) -> tuple[list[str], tuple[int, ...]]:
    indents = style.indent and dialect.flow_words and not dialect.statements and not dialect.prints
    depths = depths_of(file) if indents else [0] * len(file.lines)
    lines, unread = list[CommentedLine](), []
    for index, depth in enumerate(depths):
        try:
            lines.append(_parts(file, index, depth, style, dialect, numbering))
        except Fault:
            lines.append(CommentedLine(file.lines[index]))
            unread.append(index + 1)
    return joined(lines, dialect.longest_line), tuple(unread)


def _parts(
    file: ProgramFile, index: int, depth: int, style: Style, dialect: Dialect, numbering: Numbering
) -> CommentedLine:
    """The line in the style; without blanks where it would become too long for the control."""
    tokens = file.tokens(index)
    if not tokens or (len(tokens) == 1 and tokens[0].kind == VERBATIM):
        return CommentedLine(tokens[0].text if tokens else "")
    numbers = numbering.texts.get(index, {})
    indent = " " * (style.indent * depth)
    text = indent + line_text(tokens, style, dialect, numbers)
    if len(text) > dialect.longest_line:
        return CommentedLine(line_text(tokens, replace(style, spaces=False), dialect, numbers))
    if not (style.spaces and ends_in_comment(tokens)):
        return CommentedLine(text)
    column, gap = place_of_comment(file.lines[index], tokens)
    code = indent + line_text(tokens[:-1], style, dialect, numbers)
    return CommentedLine(code, tokens[-1].text.rstrip(), column, gap)


def _written(program: SourceText, texts: Sequence[str]) -> SourceText:
    """The bytes of the lines: encoding, byte order mark and the usual end of a line are those of the old text."""
    ends = Counter(_LINE_END.findall(program.text))
    end = max(ends, key=lambda one: (ends[one], one)) if ends else "\n"
    mark = b"\xef\xbb\xbf" if program.encoding == "utf-8" and program.raw.startswith(b"\xef\xbb\xbf") else b""
    raw = mark + "".join(text + end for text in texts).encode(program.encoding)
    return SourceText(program.name, raw, program.folder)


def not_formatted(program: SourceText, found: Formatted) -> Diagnostic:
    """The finding of a program that the style would change."""
    count = len(found.changed)
    what = f"{count} line{'' if count == 1 else 's'}" if count else "the ends of lines"
    line = found.changed[0] if found.changed else 1
    span = Span.of_line(program.name, line, program.line(line))
    message = f"{what} would change, from here on" if count > 1 else f"{what} would change"
    hint = "`gcodesim fmt` writes it; `--diff` shows what changes"
    return Diagnostic(code="GS023", message=message, span=span, hint=hint)
