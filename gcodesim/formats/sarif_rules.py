"""The catalogue of findings as SARIF rules."""

from __future__ import annotations

from typing import Any, Final

from gcodesim.diagnostics import Code, Severity, codes

LEVELS: Final = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.NOTE: "note"}
_GITHUB: Final = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.NOTE: "recommendation"}

_TAGS: Final = {
    "0": "reading",
    "1": "meaning",
    "2": "limits",
    "3": "collision",
    "4": "material",
    "5": "process",
    "6": "regression",
    "7": "cell",
    "9": "not-simulated",
}


def rules() -> list[dict[str, Any]]:
    """All rules, in the order of their codes."""
    return [_rule(code) for code in codes()]


def _rule(code: Code) -> dict[str, Any]:
    sections = [("Why it matters", code.why), ("What to do", code.remedy)]
    written = [(head, text) for head, text in sections if text]
    explain = f"gcodesim explain {code.code}"
    return {
        "id": code.code,
        "name": _name(code.title),
        "shortDescription": {"text": code.title},
        "fullDescription": {"text": code.what},
        "help": {
            "text": "\n".join([code.what, *(f"{head}: {text}" for head, text in written), f"See `{explain}`."]),
            "markdown": "\n\n".join(
                [code.what, *(f"**{head}.** {text}" for head, text in written), f"`{explain}` shows an example."]
            ),
        },
        "defaultConfiguration": {"level": LEVELS[code.severity]},
        "properties": {"tags": [_TAGS[code.code[2]]], "problem.severity": _GITHUB[code.severity]},
    }


def _name(title: str) -> str:
    """A title as an identifier: `Feed into stock` is `FeedIntoStock`."""
    words = "".join(c if c.isalnum() else " " for c in title).split()
    return "".join(word[:1].upper() + word[1:] for word in words)
