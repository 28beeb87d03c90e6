"""The file of accepted results: small, readable line by line in a repository, with nothing but results."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from typing import Any, Final

from gcodesim.diagnostics import SourceText
from gcodesim.numbers import read_json, rounded
from gcodesim.regress.compare import TOOL_PACES
from gcodesim.regress.facts import Facts, coarse
from gcodesim.regress.step_text import lines_of, steps_from
from gcodesim.regress.surfaces import Coarse

SCHEMA: Final = "gcodesim-golden/1"
SUFFIX: Final = ".golden.json"

_DIGITS: Final = 7
_RESULTS: Final = (
    *("status", "time", "distance", "stocks", "tools", "joints", "not_simulated", "probings", "sensors"),
    *("channels", "meetings", "coating", "target", "parts", "printing", "path_accuracy"),
)
_PLACES: Final = (
    *TOOL_PACES,
    *("line_of_max_force", "line_of_margin", "first_line", "error_bound_mm3", "file", "line"),
    *("body", "program", "blocks", "line_of_AT", "time_of_AT_s"),
)
_OF_FINDING: Final = ("code", "severity", "file", "line", "count", "message")


class GoldenError(ValueError):
    """The file does not hold accepted results, or is damaged; the text says which."""


def golden_text(facts: Facts) -> str:
    """The file that `gcodesim accept` writes for these facts."""
    content: dict[str, Any] = {
        "results": _kept(facts.results),
        "findings": [{key: finding[key] for key in _OF_FINDING} for finding in facts.results.get("findings", ())],
        "surfaces": {name: surface.as_json() for name, surface in coarse(facts).items()},
        "motion": lines_of(facts.steps or ()),
    }
    content = {"schema": SCHEMA, "digest": _digest(content), **content}
    return _laid_out(content, 0) + "\n"


def _kept(results: Mapping[str, Any]) -> dict[str, Any]:
    """The part of the results that is accepted; of a job, that of each of its set-ups."""
    kept = {key: _short(results[key]) for key in _RESULTS if key in results}
    if "setups" in results:
        kept["setups"] = {name: _kept(own) for name, own in results["setups"].items()}
    return kept


def read_golden(source: SourceText, name: str) -> Facts:
    """The facts in a file of accepted results, called `name` in messages. GoldenError if it holds none."""
    try:
        value = read_json(source.raw)
        if not isinstance(value, dict) or value.get("schema") != SCHEMA:
            raise GoldenError(f"it holds no accepted results of the form {SCHEMA}")
        content = {key: value[key] for key in ("results", "findings", "surfaces", "motion")}
        if value["digest"] != _digest(content):
            raise GoldenError("it was changed by hand or by a merge: its digest does not fit")
        return Facts(
            name=name,
            is_alone="status" not in content["results"],
            steps=tuple(steps_from(content["motion"])),
            results={**content["results"], "findings": content["findings"]},
            surfaces={stock: Coarse.from_json(surface) for stock, surface in content["surfaces"].items()},
        )
    except GoldenError:
        raise
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise GoldenError(f"it is damaged: {error}") from error


def _short(value: Any) -> Any:
    """Numbers to a few digits, without places in the program, which may move while the meaning stays the same."""
    if isinstance(value, Mapping):
        return {key: _short(item) for key, item in value.items() if key not in _PLACES}
    if isinstance(value, list):
        return [_short(item) for item in value]
    return rounded(value, _DIGITS) if isinstance(value, float) else value


def _digest(content: Mapping[str, Any]) -> str:
    text = json.dumps(content, sort_keys=True, ensure_ascii=False)
    return hashlib.sha256(text.encode()).hexdigest()[:32]


def _laid_out(value: Any, depth: int) -> str:
    """JSON with a line for each list entry and for each key of the outer mappings."""
    pad = " " * (depth + 1)
    if isinstance(value, dict) and value and (depth < 2 or any(isinstance(v, (dict, list)) for v in value.values())):
        parts = [
            f"{pad}{json.dumps(key, ensure_ascii=False)}: {_laid_out(item, depth + 1)}" for key, item in value.items()
        ]
        return "{\n" + ",\n".join(parts) + f"\n{' ' * depth}}}"
    if isinstance(value, list) and any(isinstance(item, (dict, str)) for item in value):
        return "[\n" + ",\n".join(f"{pad}{_laid_out(item, depth + 1)}" for item in value) + f"\n{' ' * depth}]"
    return json.dumps(value, ensure_ascii=False, allow_nan=False)
