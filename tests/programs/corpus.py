"""The conformance corpora in one process: run a program as its setup says and compare with what is expected."""

import importlib.util
import sys
from collections import Counter
from functools import cache
from pathlib import Path
from types import ModuleType

from gcodesim.canon.listing import listing
from gcodesim.diagnostics import SourceText
from gcodesim.rs274 import Settings, ToolTable, interpret, read_parameters
from gcodesim.rs274.parameters import KEPT

CORPORA = Path(__file__).parent.parent / "data" / "conformance"
FOLDER = CORPORA / "rs274"


@cache
def compare() -> ModuleType:
    """The corpus' own comparison."""
    spec = importlib.util.spec_from_file_location("conformance_compare", FOLDER / "compare.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def programs(kind: str, corpus: str = "rs274") -> list[Path]:
    return sorted((CORPORA / corpus / kind).glob("*.ngc"))


def settings_of(program: Path, setup: dict) -> Settings:
    own = program.parent.parent / "tools.tbl"
    table, problems = ToolTable.read(SourceText.read(own if own.exists() else FOLDER / "tools.tbl"))
    assert not problems
    parameters = {}
    if setup.get("parameters"):
        parameters, problems = read_parameters(SourceText.read(program.parent / setup["parameters"]))
        assert not problems
    return Settings(
        dialect=setup.get("dialect") or "linuxcnc",
        tool_table=table,
        parameters=parameters,
        subroutines=(FOLDER / "subs",),
        block_delete=bool(setup["block_delete"]),
    )


def differences(program: Path, level: str = "all") -> list[str]:
    """What differs between the expected and the actual listing, error lines included."""
    expected = compare().load(str(program.with_suffix(".json")))
    run = interpret(SourceText.read(program), settings_of(program, expected["setup"]))
    events = list(run)
    error = None if run.failed is None else (run.failed.message, run.failed_line)
    found = compare().compare(expected, listing(events, error), level, lines=True)
    return found or _left_over(expected, run.parameters)


def _left_over(expected: dict, parameters: dict[int, float]) -> list[str]:
    """How the stored positions and offsets at the end differ from those of LinuxCNC's parameter file."""
    theirs = {int(number): value for number, value in (expected.get("parameters") or {}).items()}
    if not theirs:
        return []
    pairs = [(number, theirs.get(number, 0.0), parameters.get(number, 0.0)) for number in KEPT]
    return [f"#{number} is {ours}, not {want}" for number, want, ours in pairs if abs(ours - want) > 1e-5]


def by_feature() -> list[str]:
    """Pass counts, one line a feature: the first part of the programs' names."""
    good, all_ = Counter(), Counter()
    for kind in ("valid", "invalid"):
        for program in programs(kind):
            feature = f"{kind} {program.stem.split('_')[0]}"
            all_[feature] += 1
            good[feature] += not differences(program)
    return [f"{name:<24}{good[name]:>4} of {all_[name]}" for name in sorted(all_)]


if __name__ == "__main__":
    print("\n".join(by_feature()))
