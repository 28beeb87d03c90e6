"""`gcodesim process MODEL NAME=VALUE …`: the physics of a run as a calculator."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gcodesim.cli.exits import FINDINGS, OK, UsageError
from gcodesim.cli.nearest import no_such
from gcodesim.cli.options import add_format, read_source
from gcodesim.cli.outline import may_be
from gcodesim.diagnostics.plain import one_line

if TYPE_CHECKING:
    from gcodesim.calculator.model import Model


def add_parser(commands: Any) -> None:
    parser = commands.add_parser(
        "process",
        help="a calculator: forces, torque, power, chips, beads, times …",
        description="Compute with the laws of force, edges, beads and time laws that a run uses. Without MODEL: what"
        " there is; with a MODEL alone: its inputs and results.",
        epilog="Values are written as in a cell: gcodesim process endmill diameter='10 mm' flutes=4 ap=5mm"
        " feed_per_tooth=0.05mm spindle='4000 rpm' material=42CrMo4",
    )
    model = parser.add_argument("model", nargs="?", metavar="MODEL", help="what to compute")
    may_be(model, _names)
    parser.add_argument("inputs", nargs="*", metavar="NAME=VALUE", help="an input with its unit, diameter='10 mm'")
    add_format(parser)
    parser.add_argument("--chart", type=Path, metavar="FILE", help="draw one revolution as .svg, .png or .pdf")
    parser.add_argument("--cases", type=Path, metavar="FILE", help="compute a whole file of cases (JSON)")
    parser.add_argument(
        "-o", "--out", type=Path, metavar="FILE", help="where the results of --cases go (default: stdout)"
    )
    parser.set_defaults(run=run)


def _names() -> list[str]:
    from gcodesim.calculator.answers import names_of_models

    return names_of_models()


def run(arguments: argparse.Namespace) -> int:
    if arguments.cases is not None:
        return _run_cases(arguments)
    if arguments.out is not None:
        raise UsageError("--out is for the results of --cases")
    if arguments.model is None:
        return _list()
    from gcodesim.calculator.answers import model_named
    from gcodesim.calculator.model import CannotComputeError
    from gcodesim.calculator.reading import InputsRefusedError, model_of_words

    cls = model_named(arguments.model)
    if cls is None:
        raise UsageError(no_such("model", arguments.model, _names()))
    if not arguments.inputs:
        return _describe(cls)
    try:
        model = model_of_words(cls, arguments.inputs)
        return _print(model, arguments)
    except (InputsRefusedError, CannotComputeError) as reason:
        raise UsageError(str(reason)) from None


def _list() -> int:
    from gcodesim.calculator import CALCULATORS

    names = _names()
    width = max(len(name) for name in names)
    for name in names:
        print(f"{name.ljust(width)}  {CALCULATORS[name].says}")
    return OK


def _describe(cls: type[Model]) -> int:
    """Inputs, results and source of a model."""
    from gcodesim.calculator.model import inputs_of

    print(f"{cls.kind}: {cls.says}")
    print(f"source: {cls.source}\n\ninputs")
    keys = inputs_of(cls)
    width = max(len(name) for name in keys)
    for name, key in sorted(keys.items(), key=lambda pair: not pair[1].required):
        default = "" if key.required or key.default in (None, ()) else f"; default {_shown(key.kind.show(key.default))}"
        needed = "" if not key.required else f", {key.kind.expected}"
        print(f"  {name.ljust(width)}  {key.doc}{needed}{default}")
    print("\nresults")
    width = max(len(result.name) for result in cls.gives)
    for result in cls.gives:
        unit = f" [{result.unit}]" if result.unit else ""
        print(f"  {result.name.ljust(width)}  {result.says}{unit}".rstrip())
    return OK


def _shown(value: Any) -> str:
    return f"[{', '.join(map(str, value))}]" if isinstance(value, list) else str(value)


def _print(model: Model, arguments: argparse.Namespace) -> int:
    from gcodesim.calculator.answers import answers_of
    from gcodesim.calculator.model import shown_value
    from gcodesim.declarations.record import Record

    answers = answers_of(model)
    if arguments.chart is not None:
        _draw(model, arguments.chart)
    if arguments.format == "json":
        said = {
            "schema": "gcodesim-process/1",
            "model": model.kind,
            "inputs": Record(type(model), model.kind).plain(model)[1],
            "results": {answer.key: answer.value for answer in answers},
            "source": model.source,
            "remarks": model.remarks(),
        }
        print(json.dumps(said, indent=2, ensure_ascii=False))
        return OK
    width = max(len(answer.name) for answer in answers)
    values = [shown_value(answer.value, answer.unit) for answer in answers]
    room = max(len(value) for value in values)
    for answer, value in zip(answers, values, strict=True):
        print(f"{answer.name.ljust(width)}  {value.ljust(room)}  {answer.says}".rstrip())
    print(f"source: {model.source}")
    for remark in model.remarks():
        print(one_line(remark))
    return OK


def _draw(model: Model, out: Path) -> None:
    from gcodesim.extras import require_extra
    from gcodesim.files.whole_file import write_whole

    turn = model.turn()
    if turn is None:
        raise UsageError(f"{model.kind} has no chart; endmill has one")
    require_extra("plot", "a chart")
    from gcodesim.report.plot import FORMATS
    from gcodesim.report.turn_chart import draw_turn

    kind = out.suffix.lower().lstrip(".")
    if kind not in FORMATS:
        raise UsageError(f"{out.name}: a picture ends in .svg, .png or .pdf")
    try:
        write_whole(out, draw_turn(turn, kind))
    except OSError as error:
        raise UsageError(f"{out} cannot be written: {error.strerror}") from None


def _run_cases(arguments: argparse.Namespace) -> int:
    """Case id → quantity → value; 1 where something could not be computed, which stderr says."""
    import sys

    from gcodesim.calculator.answers import answer_cases
    from gcodesim.files.whole_file import write_whole
    from gcodesim.numbers import read_json

    if arguments.model is not None or arguments.chart is not None:
        raise UsageError("--cases stands alone: each case names its model")
    source = read_source(arguments.cases, "the cases")
    try:
        cases = read_json(source.text)
    except ValueError as error:
        raise UsageError(f"{arguments.cases} is no JSON: {error}") from None
    cases = cases.get("cases") if isinstance(cases, dict) else cases
    if not isinstance(cases, list) or not all(isinstance(case, dict) for case in cases):
        raise UsageError(f'{arguments.cases}: {{"cases": […]}} is expected')
    found = answer_cases(cases)
    text = json.dumps(found.results, indent=1, ensure_ascii=False) + "\n"
    if arguments.out is None:
        print(text, end="")
    else:
        write_whole(arguments.out, text.encode())
    for line in found.told:
        print(one_line(line), file=sys.stderr)
    return OK if found.complete else FINDINGS
