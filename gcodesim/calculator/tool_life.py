"""Tool life by Taylor."""

from __future__ import annotations

from typing import ClassVar

from gcodesim.calculator.model import Model, Result, Value
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import POSITIVE, Range
from gcodesim.declarations.quantity import Quantity
from gcodesim.frozen import frozen
from gcodesim.processes.wear import taylor_life

_SPEED = Quantity("speed", POSITIVE)


@frozen
class ToolLife(Model):
    """How long an edge lasts; an estimate."""

    kind: ClassVar[str] = "wear.taylor"
    says: ClassVar[str] = "life of an edge at a cutting speed"
    source: ClassVar[str] = "Taylor 1907: v T^n = C, T in minutes"
    also: ClassVar[tuple[str, ...]] = ("taylor", "tool_life", "wear", "tool.life", "tool.wear")
    spellings: ClassVar[dict[str, str]] = {
        "vc": "cutting_speed", "v": "cutting_speed", "C": "constant", "n": "exponent", "taylor_C": "constant",
        "taylor_n": "exponent", "time": "cutting_time",
    }  # fmt: skip
    gives: ClassVar[tuple[Result, ...]] = (
        Result("life", "time", "of the edge", ("T", "tool_life")),
        Result("used", "", "share of the life that `cutting_time` takes", ("wear_share", "used_share")),
    )

    cutting_speed: float = key(_SPEED, "of the edge", example="150 m/min")
    constant: float = key(_SPEED, "C, the speed at which an edge lasts a minute", example="400 m/min")
    exponent: float = key(
        Quantity("ratio", Range(above=0.0, most=1.0)), "n; about 0.12 for HSS, 0.25 for carbide", example="0.25"
    )
    cutting_time: float | None = key("time", "in the cut", default=None)

    def compute(self) -> dict[str, Value]:
        life = taylor_life(self.cutting_speed, self.constant, self.exponent)
        found: dict[str, Value] = {"life": life}
        if self.cutting_time is not None:
            found["used"] = self.cutting_time / life
        return found
