"""Values without a unit: whole numbers, switches, texts, words of a choice."""

from __future__ import annotations

import re

from gcodesim.declarations.kind import ANY, Json, Kind, Range, key_name, scalar, short
from gcodesim.declarations.nodes import Node
from gcodesim.declarations.reading import UNREAD, Path, Reading, Unread, suggestion
from gcodesim.declarations.scalars import integer, switch, why_no_number, why_no_switch
from gcodesim.frozen import frozen


@frozen(kw_only=False)
class Whole(Kind):
    """A whole number."""

    range: Range = ANY

    @property
    def expected(self) -> str:
        return "a whole number"

    def read(self, node: Node, to: Reading, path: Path) -> int | Unread:
        text = scalar(self, node, to, path)
        if isinstance(text, Unread):
            return UNREAD
        value = integer(text.text)
        if value is None:
            message = f"`{key_name(path)}` is `{short(text.text)}`; a whole number is expected"
            return to.fault("GS707", text.span, message, why_no_number(text.text))
        broken = self.range.broken(value)
        if broken is not None:
            return to.fault("GS710", text.span, f"`{key_name(path)}` is {value}; it must be {broken[0]} {broken[1]:g}")
        return value

    def schema(self, definitions: dict[str, Json]) -> Json:
        return {"type": "integer", **{key: int(bound) for key, bound in self.range.schema().items()}}


@frozen(kw_only=False)
class Switch(Kind):
    """`true` or `false`."""

    @property
    def expected(self) -> str:
        return "`true` or `false`"

    def read(self, node: Node, to: Reading, path: Path) -> bool | Unread:
        text = scalar(self, node, to, path)
        if isinstance(text, Unread):
            return UNREAD
        value = switch(text.text)
        if value is None:
            message = f"`{key_name(path)}` is `{short(text.text)}`; {self.expected} is expected"
            return to.fault("GS706", text.span, message, why_no_switch(text.text))
        return value

    def schema(self, definitions: dict[str, Json]) -> Json:
        return {"type": "boolean"}


@frozen(kw_only=False)
class Text(Kind):
    """Any text; with `pattern` one of a certain form, which `form` describes."""

    pattern: str = ""
    form: str = "a text"

    @property
    def expected(self) -> str:
        return self.form

    def read(self, node: Node, to: Reading, path: Path) -> str | Unread:
        text = scalar(self, node, to, path)
        if isinstance(text, Unread):
            return UNREAD
        if self.pattern and not re.fullmatch(self.pattern, text.text):
            message = f"`{key_name(path)}` is `{short(text.text)}`; {self.form} is expected"
            return to.fault("GS711", text.span, message)
        return text.text

    def schema(self, definitions: dict[str, Json]) -> Json:
        return {"type": "string", **({"pattern": f"^({self.pattern})$"} if self.pattern else {})}


@frozen(kw_only=False)
class Choice(Kind):
    """One of a few words."""

    words: tuple[str, ...]
    what: str = "one"

    @property
    def expected(self) -> str:
        return f"{self.what} of {', '.join(f'`{word}`' for word in self.words)}"

    def read(self, node: Node, to: Reading, path: Path) -> str | Unread:
        text = scalar(self, node, to, path)
        if isinstance(text, Unread):
            return UNREAD
        if text.text not in self.words:
            return to.fault(
                "GS711",
                text.span,
                f"`{key_name(path)}` cannot be `{short(text.text)}`",
                suggestion(text.text, self.words),
            )
        return text.text

    def schema(self, definitions: dict[str, Json]) -> Json:
        return {"enum": list(self.words)}
