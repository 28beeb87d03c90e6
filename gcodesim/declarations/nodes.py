"""YAML text → nodes with places; nothing is interpreted, every scalar stays the text it is.

Built on the parser's events instead of its object constructor, because a cell
is stricter than YAML: duplicate keys, merge keys, tags, several documents and
aliases that blow up are findings, and `on`, dates and numbers are read by the
kinds (`kind.py`) that know what is expected.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from gcodesim.diagnostics import Diagnostic, Findings, SourceText, Span
from gcodesim.frozen import frozen

_LINE_END = re.compile(r"\r\n|\n|\r")
# what YAML 1.2 forbids anywhere in a file
_FORBIDDEN = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f\ufffe\uffff]")
_HALF = re.compile("[\ud800-\udfff]")
_PAIR = re.compile("[\ud800-\udbff][\udc00-\udfff]")
# C1 controls come from Windows code pages read as Latin-1; the others end no line in YAML 1.2, but do in the parser
_HARMLESS = dict.fromkeys((*range(128, 160), 8232, 8233, 65279), "�")
# A cell has some hundred nodes. Copies made by aliases beyond this number are an attack or a mistake.
CELL = "cell"
"""How people call the file that most is read from."""

_MOST_COPIES = 10_000
_DEEPEST = 60


@frozen
class Scalar:
    """A text; `plain` when it stands without quotes."""

    span: Span
    text: str
    plain: bool = True

    @property
    def empty(self) -> bool:
        """Nothing was written (`key:`), or YAML's word for it."""
        return self.plain and self.text in ("", "~", "null", "Null", "NULL")


@frozen
class Listing:
    """`[a, b]` or lines that begin with a dash."""

    span: Span
    items: tuple[Node, ...]


@frozen
class Mapping:
    """`{key: value}` or lines of `key: value`, in their order; keys are unique."""

    span: Span
    entries: tuple[tuple[Scalar, Node], ...]

    def get(self, key: str) -> Node | None:
        return next((value for name, value in self.entries if name.text == key), None)


Node = Scalar | Listing | Mapping


@dataclass(slots=True)
class _Open:
    """A container whose end has not come yet."""

    event: Any
    is_map: bool
    anchor: str | None
    children: list[Node] = field(default_factory=list)
    size: int = 1


class TextPlaces:
    """Index in the text → line and column from 1."""

    def __init__(self, file: str, text: str) -> None:
        self.file = file
        self._starts = [0, *(m.end() for m in _LINE_END.finditer(text))]

    def at(self, index: int) -> tuple[int, int]:
        line = bisect_right(self._starts, index)
        return line, index - self._starts[line - 1] + 1

    def span(self, start: int, end: int) -> Span:
        line, column = self.at(start)
        end_line, end_column = self.at(max(end, start + 1))
        if end_line > line and end_column == 1:  # a block ends before the next line begins
            end_line, end_column = line, column + 1
        return Span(self.file, line, column, end_line, end_column)


def compose(
    source: SourceText, findings: Findings, *, what: str = CELL, example: str = "machine: gantry_xyz"
) -> Mapping | None:
    """The mapping that `source` holds; None when there is none to go on with. Faults go to `findings`.

    `what` is how they call the file, `example` a line that it may hold.
    """
    text = source.text
    places = TextPlaces(source.name, text)
    if bad := _FORBIDDEN.search(text):
        findings.add(
            Diagnostic(
                code="GS701",
                span=places.span(bad.start(), bad.end()),
                message=f"the control character U+{ord(bad.group()):04X} may not stand in YAML",
                hint="delete it; is this a text file?",
            )
        )
        return None
    composer = _Composer(places, findings, what)
    root = composer.run(_events(text.translate(_HARMLESS), places, findings))
    if isinstance(root, Mapping) or (root is None and findings.has_errors()):
        return root
    if root is None or (isinstance(root, Scalar) and root.empty):
        told = "; `gcodesim init DIR` writes an example" if what == CELL else ""
        findings.add(
            Diagnostic(
                code="GS705",
                span=Span(source.name, 1, 1, 1, 2),
                message=f"the {what} is empty",
                hint=f"the shortest one is `{example}`{told}",
            )
        )
        return None
    findings.add(
        Diagnostic(
            code="GS706",
            span=root.span,
            message=f"a {what} is a mapping of keys to values",
            hint=f"write lines such as `{example}`",
        )
    )
    return None


def _events(text: str, places: TextPlaces, findings: Findings) -> Iterator[Any]:
    """The parser's events until its end or its first complaint, which becomes a finding."""
    from ruamel.yaml import YAML
    from ruamel.yaml.error import MarkedYAMLError, YAMLError

    try:
        yield from YAML(typ="safe", pure=True).parse(text)
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        index = mark.index if mark is not None else 0
        message, hint = _in_own_words(error, text, index, places)
        related = error.context_mark
        findings.add(
            Diagnostic(
                code="GS701",
                span=places.span(min(index, max(len(text.rstrip()) - 1, 0)), index + 1),
                message=message,
                hint=hint,
                related=places.span(related.index, related.index + 1)
                if related is not None and related.index != index
                else None,
            )
        )
        yield None
    except (YAMLError, RecursionError, ValueError) as error:
        findings.add(
            Diagnostic(code="GS701", span=Span(places.file, 1, 1, 1, 2), message=f"not YAML: {type(error).__name__}")
        )
        yield None


def _in_own_words(error: Any, text: str, index: int, places: TextPlaces) -> tuple[str, str]:
    """Message and hint for the complaints that people meet."""
    problem = error.problem or error.context or "not YAML"
    found = text[index : index + 1]
    if found == "\t":
        return "a tab may not indent or separate in YAML", "use spaces"
    if "cannot start any token" in problem:
        return f"a value may not begin with `{found}`", "put the text between quotes"
    if "mapping values are not allowed" in problem:
        return (
            "a `:` where no key can stand",
            "is the line indented deeper than its neighbours, or does a text with `: ` in it lack quotes?",
        )
    if "expected ',' or" in problem:
        opened = error.context_mark
        where = f" of line {places.at(opened.index)[0]}" if opened is not None else ""
        bracket = "}" if "mapping" in (error.context or "") else "]"
        return f"a comma or `{bracket}` is missing", f"the bracket{where} is still open here"
    if "expected <block end>" in problem or "unindent" in problem:
        return "this line is indented like none of the lines above", "keys of one mapping begin in the same column"
    if "end of stream" in problem and "scalar" in (error.context or ""):
        return "a quoted text never ends", "close it with the same quote"
    if "could not find expected ':'" in problem:
        return "a key without a `:`", "write `key: value`"
    return problem[:1].lower() + problem[1:], ""


class _Composer:
    """Nodes from events, without recursion, so that no depth of a file can exhaust the stack."""

    def __init__(self, places: TextPlaces, findings: Findings, what: str) -> None:
        self._what = what
        self._places = places
        self._findings = findings
        self._anchors: dict[str, tuple[Node, int]] = {}
        self._copies = 0
        self._stack: list[_Open] = []
        self._root: Node | None = None

    def run(self, events: Iterator[Any]) -> Node | None:
        documents = 0
        for event in events:
            if event is None:
                return None
            name = type(event).__name__
            if name == "DocumentStartEvent":
                documents += 1
                if not self._document_start(event, documents):
                    return self._root
            elif name == "ScalarEvent":
                self._check_tag(event)
                text = self._whole(event)
                self._finish(Scalar(span=self._span(event), text=text, plain=event.style is None), event.anchor, 1)
            elif name == "AliasEvent":
                if not self._alias(event):
                    return None
            elif name in ("MappingStartEvent", "SequenceStartEvent"):
                self._check_tag(event)
                if len(self._stack) == _DEEPEST:
                    self._add(
                        "GS703", event, f"nested deeper than {_DEEPEST} levels", f"no key of a {self._what} needs that"
                    )
                    return None
                self._stack.append(_Open(event, name == "MappingStartEvent", event.anchor))
            elif name in ("MappingEndEvent", "SequenceEndEvent"):
                self._close(event)
        return self._root

    def _add(self, code: str, event: Any, message: str, hint: str = "", related: Span | None = None) -> None:
        span = event if isinstance(event, Span) else self._span(event)
        self._findings.add(Diagnostic(code=code, span=span, message=message, hint=hint, related=related))

    def _span(self, event: Any) -> Span:
        return self._places.span(event.start_mark.index, event.end_mark.index)

    def _document_start(self, event: Any, count: int) -> bool:
        if count > 1:
            self._add("GS703", event, "a second document begins here", f"one file holds one {self._what}")
            return False
        if event.version is not None and tuple(event.version) != (1, 2):
            wanted = ".".join(str(part) for part in event.version)
            message = f"YAML {wanted} is asked for; cells are YAML 1.2"
            self._add("GS703", Span(self._places.file, 1, 1, 1, 2), message, "delete the line that begins with `%`")
        return True

    def _check_tag(self, event: Any) -> None:
        if event.ctag is not None:
            self._add(
                "GS703",
                event,
                f"the tag `{_shorthand(event.tag)}` is not read",
                "delete it: each key knows what it expects",
            )

    def _whole(self, event: Any) -> str:
        """The text of a scalar. JSON escapes a character beyond U+FFFF in two halves, which no file can hold alone."""
        text: str = event.value
        if text.isascii() or not _HALF.search(text):
            return text
        joined = text.encode("utf-16", "surrogatepass").decode("utf-16", "replace")
        if lost := _HALF.search(_PAIR.sub("", text)):
            self._add(
                "GS701",
                event,
                f"`\\u{ord(lost[0]):04x}` is half a character",
                "write the character itself, or both halves: `\\ud83d\\ude00`",
            )
        return joined

    def _alias(self, event: Any) -> bool:
        if any(container.anchor == event.anchor for container in self._stack):
            self._add(
                "GS703", event, f"`*{event.anchor}` stands inside of what it names", "a cell cannot contain itself"
            )
            return False
        if event.anchor not in self._anchors:
            self._add(
                "GS701",
                event,
                f"`*{event.anchor}` names nothing above",
                f"write `&{event.anchor}` before the value it means",
            )
            return False
        node, size = self._anchors[event.anchor]
        self._copies += size
        if self._copies > _MOST_COPIES:
            self._add(
                "GS703", event, f"aliases blow the cell up to more than {_MOST_COPIES} values", "write the values out"
            )
            return False
        self._finish(node, None, size)
        return True

    def _finish(self, node: Node, anchor: str | None, size: int) -> None:
        if anchor is not None:
            self._anchors[anchor] = (node, size)
        if self._stack:
            self._stack[-1].children.append(node)
            self._stack[-1].size += size
        elif self._root is None:
            self._root = node

    def _close(self, event: Any) -> None:
        done = self._stack.pop()
        span = self._places.span(done.event.start_mark.index, event.end_mark.index)
        if done.is_map:
            pairs = zip(done.children[::2], done.children[1::2], strict=True)
            node: Node = Mapping(span=span, entries=tuple(self._unique(pairs)))
        else:
            node = Listing(span=span, items=tuple(done.children))
        self._finish(node, done.anchor, done.size)

    def _unique(self, pairs: Iterator[tuple[Node, Node]]) -> Iterator[tuple[Scalar, Node]]:
        seen: dict[str, Span] = {}
        for key, value in pairs:
            if not isinstance(key, Scalar):
                self._add("GS703", key.span, "a list or mapping cannot be a key", "write a name before the colon")
            elif key.text == "<<" and key.plain:
                self._add("GS703", key.span, "merge keys are not part of YAML 1.2", "write the keys out")
            elif key.text in seen:
                line = seen[key.text].line
                self._add(
                    "GS702",
                    key.span,
                    f"the key `{key.text}` stands a second time",
                    f"the first is in line {line}",
                    seen[key.text],
                )
            else:
                seen[key.text] = key.span
                yield key, value


def _shorthand(tag: str | None) -> str:
    prefix = "tag:yaml.org,2002:"
    return f"!!{tag.removeprefix(prefix)}" if tag is not None and tag.startswith(prefix) else str(tag)
