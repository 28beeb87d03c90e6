"""`NAME.test.yaml`: which program runs in which cell, and what must result. Read like a cell, with places."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path as FilePath
from typing import Any, Final

from gcodesim.cell.placing import names_of
from gcodesim.cell.settings import CODE_PATTERNS, code_pattern
from gcodesim.declarations.composed import ListOf
from gcodesim.declarations.files import Shelf
from gcodesim.declarations.form_version import form_version
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import POSITIVE, Json, Kind, Range, document, short
from gcodesim.declarations.map_of import MapOf
from gcodesim.declarations.nodes import Mapping as MappingNode
from gcodesim.declarations.nodes import Node, Scalar, compose
from gcodesim.declarations.plain_kinds import Choice, Switch, Text, Whole
from gcodesim.declarations.quantity import Quantity
from gcodesim.declarations.reading import UNREAD, Path, Reading, Unread
from gcodesim.declarations.record import Record, known_keys, not_a_mapping
from gcodesim.declarations.scalars import measured
from gcodesim.diagnostics import Findings, SourceText, Span
from gcodesim.frozen import frozen
from gcodesim.regress.tolerance import Tolerance, quantity_of
from gcodesim.regress.tolerance_kind import TolerancesKind, tolerance_from

SUFFIXES: Final = (".test.yaml", ".test.yml")
MODES: Final = ("run", "check", "lint")

_SEVERITIES: Final = ("error", "warning", "note")
_CODE: Final = Text(pattern=CODE_PATTERNS.pattern, form="a code such as `GS501` or `GS9xx`")


@frozen
class ExpectedFinding:
    """A finding that must occur. What is not given may be anything; `line` is in `file` (default: the program)."""

    code: str = key(_CODE, "the finding's code, or a class of them")
    line: int | None = key(Whole(Range(least=1.0)), "its line", default=None, quiet=True)
    file: str | None = key(Text(), "the file that it names, such as a subprogram or the cell", default=None, quiet=True)
    severity: str | None = key(Choice(_SEVERITIES), "how severe it is", default=None, quiet=True)
    message: str | None = key(Text(), "a part of its message", default=None, quiet=True)
    count: int | None = key(Whole(Range(least=1.0)), "how often it comes", default=None, quiet=True)

    def checked(self, to: Reading, path: Path) -> ExpectedFinding:
        return replace(self, code=code_pattern(self.code) or self.code)


@frozen
class ExpectedValue:
    """What a quantity of the results must be: `value` within `tolerance`, or between `least` and `most`."""

    value: float | str | None = None
    tolerance: Tolerance | None = None
    least: float | None = None
    most: float | None = None


@frozen(kw_only=False)
class _ValuesKind(Kind):
    """Values by their path in `results.json`."""

    @property
    def expected(self) -> str:
        return "values by path, such as `stocks.stock.removed_mm3: 656.5` or `time.total_s: {most: 60}`"

    def read(self, node: Node, to: Reading, path: Path) -> Mapping[str, ExpectedValue] | Unread:
        if not isinstance(node, MappingNode):
            return not_a_mapping(node, self.expected, to, path)
        values = {}
        for name, value in node.entries:
            at = (*path, name.text)
            to.named(at, name.span)
            values[name.text] = self._value(name.text, value, to, at)
        good = {name: value for name, value in values.items() if not isinstance(value, Unread)}
        return good if len(good) == len(values) else UNREAD

    def _value(self, name: str, node: Node, to: Reading, path: Path) -> ExpectedValue | Unread:
        if isinstance(node, Scalar):
            number = self._number(node, to, path)
            return UNREAD if isinstance(number, Unread) else ExpectedValue(value=number)
        if not isinstance(node, MappingNode):
            return not_a_mapping(node, "a number or a mapping with `least`, `most`, `value`, `tolerance`", to, path)
        fields: dict[str, Any] = {}
        for known, key_node, value in known_keys(
            node.entries, ["value", "tolerance", "least", "most"], "the value", to
        ):
            if not isinstance(value, Scalar):
                return not_a_mapping(value, "a number", to, (*path, known))
            if known == "tolerance":
                tolerance = tolerance_from(quantity_of(name), value.text)
                if isinstance(tolerance, str):
                    return to.fault("GS707", value.span, tolerance)
                fields[known] = tolerance
            else:
                fields[known] = self._number(value, to, (*path, known))
            to.named((*path, known), key_node.span)
        if any(isinstance(value, Unread) for value in fields.values()):
            return UNREAD
        if not fields.keys() & {"value", "least", "most"}:
            return to.fault("GS705", node.span, f"`{name}` says nothing: give `value`, `least` or `most`")
        return ExpectedValue(**fields)

    def _number(self, node: Scalar, to: Reading, path: Path) -> float | str | Unread:
        number = measured(node.text)
        if number is None and path[-1] == "status":
            return node.text
        if number is None or number.unit:
            message = f"`{path[-1]}` is `{short(node.text)}`; a number is expected, in the unit that the path names"
            return to.fault("GS707", node.span, message)
        return number.value

    def schema(self, definitions: dict[str, Json]) -> Json:
        bounds = {name: {"type": "number"} for name in ("value", "least", "most")}
        tolerance = {"tolerance": {"type": ["string", "number"]}}
        return {
            "type": "object",
            "additionalProperties": {
                "anyOf": [
                    {"type": ["number", "string"]},
                    {"type": "object", "properties": {**bounds, **tolerance}, "additionalProperties": False},
                ]
            },
        }


@frozen
class Expected:
    """What must result from a case, besides what was accepted."""

    findings: tuple[ExpectedFinding, ...] = key(
        ListOf(Record(ExpectedFinding, "the expected finding")), "findings that must come", default=(), quiet=True
    )
    values: Mapping[str, ExpectedValue] = key(_ValuesKind(), "what quantities must be", default={}, quiet=True)
    status: str | None = key(Choice(("ok", "findings", "failed")), "how the run must end", default=None, quiet=True)


@frozen
class CaseOptions:
    """How a case is run; options that are not given are as on the command line."""

    mode: str = key(Choice(MODES), "`run` it, `check` it without material, or `lint` the program alone", default="run")
    world: str | None = key(Choice(("kinematic", "bullet")), "instead of what the cell says", default=None)
    dialect: str | None = key(Text(), "instead of what the cell says", default=None)
    block_delete: bool | None = key(Switch(), "whether blocks with / are skipped", default=None)
    max_blocks: int | None = key(Whole(Range(least=1.0)), "stop after so many blocks", default=None)
    fail_on: str | None = key(Choice((*_SEVERITIES, "never")), "least severity that fails the case", default=None)
    time_limit: float | None = key(Quantity("time", POSITIVE), "stop reading after so long", default=None)


@frozen
class CaseFile:
    """A test file. Without `program` it is about the program of the same name."""

    gcodesim_test: int = form_version("gcodesim-test")
    program: tuple[str, ...] = key(
        ListOf(Text(), single=True),
        "the program, or several: names and patterns such as `*.nc`",
        default=(),
        quiet=True,
    )
    cell: str | None = key(Text(), "the cell, seen from this file", default=None, quiet=True)
    channels: Mapping[str, str] = key(
        MapOf(names_of("channel"), Text(), "programs by channel, such as `feeder: feeder.nc`"),
        "programs that run at the same time in further channels, seen from this file",
        default={},
        quiet=True,
    )
    allow_path: tuple[str, ...] = key(
        ListOf(Text(), single=True), "folders from which the cell may take files", default=(), quiet=True
    )
    options: CaseOptions = key(Record(CaseOptions, "`options`"), "how it is run", default=CaseOptions(), quiet=True)
    tolerances: Mapping[str, Tolerance] = key(
        TolerancesKind(), "how much may differ from what was accepted", default={}, quiet=True
    )
    expect: Expected = key(Record(Expected, "`expect`"), "what must come of it", default=Expected(), quiet=True)


_ROOT: Final = Record(CaseFile, "the test file")


@frozen
class ReadCaseFile:
    """The result of reading a test file; `content` is None when a finding is an error. `spans` are places by path."""

    content: CaseFile | None
    findings: Findings
    spans: Mapping[Path, Span]

    def span(self, *path: str | int) -> Span | None:
        return self.spans.get(path)


def read_case_file(source: SourceText, folder: FilePath) -> ReadCaseFile:
    """Read a test file in `folder`."""
    findings = Findings()
    to = Reading(file=source.name, findings=findings, shelf=Shelf(folder=folder))
    root = compose(source, findings, what="test file", example="cell: cell.yaml")
    content = None
    if root is not None:
        read = _ROOT.read(root, to, ())
        content = None if isinstance(read, Unread) or findings.has_errors() else read
    return ReadCaseFile(content=content, findings=findings, spans=to.spans)


def case_schema() -> Json:
    """JSON Schema (2020-12) of test files, for editors."""
    definitions: dict[str, Json] = {}
    root = _ROOT.schema(definitions)
    return document("gcodesim test file", root, definitions)
