"""Words that a control has in force before the first block of a program."""

from __future__ import annotations

import re
from typing import Any, Final

from gcodesim.declarations.kind import Json, Kind, scalar, short
from gcodesim.declarations.nodes import Node
from gcodesim.declarations.reading import UNREAD, Path, Reading, Unread
from gcodesim.diagnostics import SourceText, Span
from gcodesim.frozen import frozen

_MODAL: Final = (
    *("7", "8", "15", "17", "18", "19", "17.1", "18.1", "19.1", "20", "21", "40", "49", "50", "50.1", "54", "55", "56"),
    *("57", "58", "59", "59.1", "59.2", "59.3", "61", "61.1", "64", "67", "69", "70", "71", "80", "90", "90.1", "91"),
    *("91.1", "92.2", "93", "94", "95", "96", "97", "98", "99"),
)
"""G-words that move nothing and need no axis words in any dialect; which of them it knows, a dialect says itself."""

_FILAMENT: Final = r"M8[23](?![0-9.])"
"""Whether E words of a printer are places or steps."""

_ONE: Final = r"G0*(?:" + "|".join(re.escape(number) for number in _MODAL) + rf")(?![0-9.])|{_FILAMENT}|[FSPQD][0-9.]+"
_WORD: Final = re.compile(_ONE, re.IGNORECASE)
_OWNERS: Final = {
    letter: re.compile(rf"G0*{code}(?![0-9.])", re.IGNORECASE) for letter, code in (("P", 64), ("Q", 64), ("D", 96))
}
"""Words that say something only beside a G-word that is in the same block."""
_WORDS: Final = rf"\s*(?:{_ONE})(?:\s*(?:{_ONE}))*\s*"


@frozen
class Startup:
    """A block of modal `words`, and where it stands in the cell."""

    words: str
    span: Span

    def source(self) -> SourceText:
        """A program of this block, whose lines and columns are those of the cell."""
        indent = "\n" * (self.span.line - 1) + " " * (self.span.column - 1)
        return SourceText(self.span.file, f"{indent}{self.words}\n".encode())


@frozen(kw_only=False)
class StartupKind(Kind):
    """`G20 G64 P0.001`."""

    @property
    def expected(self) -> str:
        return "a block of words that stay in force and move nothing, such as `G20 G64 P0.001`"

    def read(self, node: Node, to: Reading, path: Path) -> Startup | Unread:
        text = scalar(self, node, to, path)
        if isinstance(text, Unread):
            return UNREAD
        words, others = modal_words(text.text)
        if others or not words:
            message = f"`{path[-1]}` is `{short(text.text)}`; {self.expected} is expected"
            hint = f"`{short(others)}` belongs into the program" if others else ""
            return to.fault("GS711", text.span, message, hint)
        return Startup(words=text.text, span=text.span)

    def schema(self, definitions: dict[str, Json]) -> Json:
        return {"type": "string", "pattern": f"^{_either_case(_WORDS)}$", "examples": ["G20 G64 P0.001"]}

    def show(self, value: Any) -> Any:
        return value.words

    def plain(self, value: Any) -> tuple[str, Any]:
        return "", value.words


def modal_words(block: str) -> tuple[str, str]:
    """Those words of a block that may stand in `startup`, and the rest of it."""
    words, others = list[str](), block
    for match in reversed(list(_WORD.finditer(block))):
        owner = _OWNERS.get(match[0][0].upper())
        if owner is None or owner.search(block):
            words.insert(0, match[0])
            others = f"{others[: match.start()]} {others[match.end() :]}"
    return " ".join(words), " ".join(others.split())


def _either_case(pattern: str) -> str:
    """The pattern with letters in either case, as JSON Schema has no flag for that."""
    either = {"G": "[Gg]", "M": "[Mm]", "[FSPQD]": "[FfSsPpQqDd]"}
    return re.sub(r"[GM]|\[FSPQD\]", lambda found: either[found[0]], pattern)
