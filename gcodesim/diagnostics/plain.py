r"""Makes text of others harmless: text that a terminal, build server or reader would take for something else.

Names, comments and messages come from programs and cells that may be a stranger's. A control character in them moves
the cursor or hides text, a mark of writing direction reverses words, and a line that begins with `::`,
or holds `##[`, is a command to a build server. Each is shown as its number, `\u001b`, which JSON and YAML read back.
"""

from __future__ import annotations

import re
from typing import Any, Final

# control characters except tab and line feed; line and paragraph separators; writing direction; invisible characters
_HIDDEN: Final = (
    "\x00-\x08\x0b-\x1f\x7f-\x9f\u00ad\u061c\u180e\u200b\u200e\u200f\u2028-\u202e\u2060-\u206f\ufeff\ufff9-\ufffb"
    "\U000e0000-\U000e0fff"
)
_UNFIT: Final = re.compile(rf"[{_HIDDEN}]|(?<=#)#(?=\[|vso\[|teamcity\[)")
_UNFIT_LINE: Final = re.compile(rf"[\t\n{_HIDDEN}]|(?<=#)#(?=\[|vso\[|teamcity\[)|^[^\S\t\n]*::")
_COMMAND: Final = re.compile(r"^[^\S\n]*::", re.MULTILINE)


def one_line(text: str) -> str:
    """A name, message or other piece of a line: no line ends in it and no command begins with it."""
    if text.isascii() and text.isprintable() and "::" not in text and "##" not in text:
        return text
    return _UNFIT_LINE.sub(_number, text)


_MARKDOWN: Final = re.compile(r"[\\`\[\]<|]")


def markdown_text(text: str) -> str:
    """A piece of a line of Markdown that stays text: no link, no picture of another host, no HTML, no end of a cell."""
    return _MARKDOWN.sub(r"\\\g<0>", one_line(text))


def lines(text: str) -> str:
    """A text of several lines, none of which is a command; line feeds and tabs stay."""
    return _COMMAND.sub(_number, _UNFIT.sub(_number, text))


def plain_tree(value: Any) -> Any:
    """What JSON holds, with each text in it as `lines` shows it."""
    if isinstance(value, str):
        return value if value.isascii() and value.isprintable() and ":" not in value else lines(value)
    if isinstance(value, dict):
        return {plain_tree(key): plain_tree(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [plain_tree(one) for one in value]
    return value


def excerpt_of(text: str) -> str:
    """A line of a file, character by character, with a sign in place of each unfit character; tabs stay."""
    if text.isprintable() and "##" not in text:
        return text
    shown = "".join(c if c == "\t" or c.isprintable() else _UNKNOWN for c in text)
    return _UNFIT.sub(_UNKNOWN, shown) if "##" in shown else shown


_UNKNOWN: Final = "\N{REPLACEMENT CHARACTER}"


def _number(match: re.Match[str]) -> str:
    found = match[0]
    if found.endswith("::"):
        return f"{found[:-2]}{_number_of(':')}:"
    return _SHORT.get(found) or _number_of(found)


_SHORT: Final = {"\t": "\\t", "\n": "\\n", "\r": "\\r"}


def _number_of(character: str) -> str:
    data = character.encode("utf-16-be")
    return "".join(f"\\u{data[i]:02x}{data[i + 1]:02x}" for i in range(0, len(data), 2))


_FORMULA: Final = tuple("=+-@\uff1d\uff0b\uff0d\uff20")


def table_text(text: str) -> str:
    """A text for a CSV cell: as `one_line` shows it, and behind a `'` if a spreadsheet would take it for a formula."""
    fit = one_line(text)
    return f"'{fit}" if fit.lstrip("'").startswith(_FORMULA) else fit


def text_of_table(text: str) -> str:
    """The text that `table_text` was given, where that had no unfit characters."""
    return text[1:] if text.startswith("'") and text.lstrip("'").startswith(_FORMULA) else text


class PlainStream:
    """A stream whose text is made harmless; our own colours and commands go to `raw`."""

    def __init__(self, raw: Any) -> None:
        self.raw = raw
        self._begins = True  # only blanks since the last line end

    def write(self, text: str) -> int:
        """Write a text; commands and hidden characters are shown as numbers."""
        fit = text
        if not (text.isascii() and text.isprintable()) or "##" in text:
            fit = _UNFIT.sub(_number, fit)
        if "::" in fit:
            first, end, rest = fit.partition("\n")
            fit = (lines(first) if self._begins else first) + end + lines(rest)
        if fit:
            tail = fit[fit.rfind("\n") + 1 :]
            self._begins = (self._begins or "\n" in fit) and not tail.strip()
        self.raw.write(fit)
        return len(text)

    def writelines(self, texts: Any) -> None:
        """Write one text after the other."""
        for text in texts:
            self.write(text)

    def __getattr__(self, name: str) -> Any:
        return getattr(self.raw, name)


def raw(stream: Any) -> Any:
    """The stream below, for text that is ours or has been made fit already."""
    return getattr(stream, "raw", stream) if isinstance(stream, PlainStream) else stream
