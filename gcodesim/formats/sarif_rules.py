"""The catalogue of findings as SARIF rules."""

from __future__ import annotations

from typing import Any, Final

from gcodesim.diagnostics import Code, Severity, codes, subject_of

LEVELS: Final = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.NOTE: "note"}
_GITHUB: Final = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.NOTE: "recommendation"}


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
        "properties": {"tags": [subject_of(code.code).replace(" ", "-")], "problem.severity": _GITHUB[code.severity]},
    }


def _name(title: str) -> str:
    """A title as an identifier: `Feed into stock` is `FeedIntoStock`."""
    words = "".join(c if c.isalnum() else " " for c in title).split()
    return "".join(word[:1].upper() + word[1:] for word in words)
