"""What differs between two runs, as values: moves, quantities, surfaces, findings."""

from __future__ import annotations

from typing import Any, Final, Literal

from gcodesim.frozen import frozen

MoveKind = Literal["changed", "inserted", "removed"]
FindingKind = Literal["new", "gone", "changed"]


@frozen
class ChangedLine:
    """A line of a program; `text` is empty where only its number is known, as in accepted results."""

    file: str
    line: int
    text: str = ""

    def __str__(self) -> str:
        return f"{self.file}:{self.line}" if self.line else self.file


@frozen
class FieldChange:
    """One word of a step that differs: `Z`, `feed`, `spindle` …; `tolerance` names what it breaks.

    Numbers are in `unit` as programs have them (mm, deg, mm/min, rpm, s); a field that one side lacks is None.
    """

    name: str
    old: float | str | None
    new: float | str | None
    unit: str = ""
    allowed: float | None = None
    tolerance: str = ""

    @property
    def delta(self) -> float | None:
        if isinstance(self.old, float) and isinstance(self.new, float):
            return self.new - self.old
        return None


@frozen
class MoveChange:
    """Steps that change in the same way: `count` of them from `old`/`new` to the `last_` ones.

    `changed` has both places and `fields` (those of the first step), `inserted` only new ones, `removed` only old
    ones. `what` is the kind of the first step (`line`, `spindle`, …), `detail` its content if it is not a
    move (`cw, 8000 rpm`), `way_mm` the length of all inserted or removed moves.
    `near` is where to look for it in the new program: the step itself, else the one that it followed.
    """

    kind: MoveKind
    what: str
    detail: str = ""
    count: int = 1
    old: ChangedLine | None = None
    new: ChangedLine | None = None
    last_old: ChangedLine | None = None
    last_new: ChangedLine | None = None
    near: ChangedLine | None = None
    fields: tuple[FieldChange, ...] = ()
    way_mm: float = 0.0

    @property
    def quantities(self) -> tuple[str, ...]:
        """`Z`, `feed` … of a changed step; `moves` where steps were inserted or removed."""
        return tuple(field.name for field in self.fields) if self.kind == "changed" else ("moves", self.what)


@frozen
class Change:
    """A quantity of the results that differs, by its path: ``stocks.stock.removed_mm3``; None where it is missing.

    `allowed` is what `tolerance` admits for the old value, in the unit of the quantity.
    """

    quantity: str
    old: Any
    new: Any
    allowed: float | None = None
    tolerance: str = ""
    unit: str = ""

    @property
    def delta(self) -> float | None:
        if isinstance(self.old, (int, float)) and isinstance(self.new, (int, float)):
            return float(self.new) - float(self.old)
        return None

    @property
    def text(self) -> str:
        """One line for people."""
        if self.delta is not None:
            limit = "" if self.allowed is None else f", {self.allowed:.4g} is allowed"
            return f"{self.quantity}: {self.old:.6g} → {self.new:.6g} ({self.delta:+.4g}{limit})"
        return f"{self.quantity}: {shown(self.old)} → {shown(self.new)}"


@frozen
class SurfaceChange:
    """Where the surface of a stock differs most: height `old_mm` → `new_mm` at `x_mm`, `y_mm` of the stock's axes.

    `None` heights mean that no material is there. `area_mm2` is how much of the plan view differs by more than
    `allowed_mm`; `exact` says whether columns were compared, or the coarse surface of accepted results.
    """

    stock: str
    x_mm: float
    y_mm: float
    old_mm: float | None
    new_mm: float | None
    deviation_mm: float
    area_mm2: float
    allowed_mm: float
    exact: bool

    @property
    def quantity(self) -> str:
        return f"surface.{self.stock}"


@frozen
class FindingChange:
    """A finding that is `new`, `gone`, or `changed` in its numbers; each as it stands in `results.json`."""

    kind: FindingKind
    old: dict[str, Any] | None = None
    new: dict[str, Any] | None = None

    @property
    def shown(self) -> dict[str, Any]:
        """The new one, or the one that is gone."""
        found = self.new or self.old
        assert found is not None
        return found


@frozen
class Comparison:
    """Everything that differs beyond tolerance.

    `totals` are the quantities that people ask for first, if they changed at all; `remarks` say what could not
    be compared. Neither counts as a difference.
    """

    moves: tuple[MoveChange, ...] = ()
    changes: tuple[Change, ...] = ()
    surfaces: tuple[SurfaceChange, ...] = ()
    findings: tuple[FindingChange, ...] = ()
    totals: tuple[Change, ...] = ()
    remarks: tuple[str, ...] = ()

    @property
    def same(self) -> bool:
        return not (self.moves or self.changes or self.surfaces or self.findings)

    @property
    def count(self) -> int:
        return len(self.moves) + len(self.changes) + len(self.surfaces) + len(self.findings)

    @property
    def quantities(self) -> tuple[str, ...]:
        """Names of all differences, each once: `Z`, `feed`, `moves`, `time.total_s`, `surface.stock`, `findings`."""
        names = [name for move in self.moves for name in move.quantities]
        names += [change.quantity for change in self.changes]
        names += [surface.quantity for surface in self.surfaces]
        names += ["findings"] * bool(self.findings)
        return tuple(dict.fromkeys(names))


SAME: Final = Comparison()


def shown(value: Any) -> str:
    return "nothing" if value is None else str(value)
