"""What every model of the calculator declares: its inputs as keys, its results with units, its source."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar

from gcodesim.declarations.keys import Key, all_keys
from gcodesim.declarations.units import DIMENSIONS
from gcodesim.frozen import frozen

if TYPE_CHECKING:
    from gcodesim.processes.constant_cut import OneTurn

Value = float | bool | str | Sequence[float]
"""What a model finds: SI numbers, alone or in lists, or words."""


class CannotComputeError(Exception):
    """The inputs are each sound, but there is no result; the text says why."""


@frozen(kw_only=False)
class Result:
    """One quantity that a model finds. `dimension` is one of `declarations.units`, empty for numbers and words.

    A name with `{}` stands for several, such as `Fx_theta{}` for each angle that was asked for. `also` are other names
    under which it is known.
    """

    name: str
    dimension: str = ""
    says: str = ""
    also: tuple[str, ...] = ()

    def means(self, name: str) -> bool:
        """Whether `name` is this quantity, without unit."""
        return any(
            re.fullmatch(re.escape(own).replace(r"\{\}", r"-?[0-9][0-9.]*"), name) for own in (self.name, *self.also)
        )

    @property
    def unit(self) -> str:
        """The unit in which it is shown."""
        return DIMENSIONS[self.dimension].shown if self.dimension else ""


@frozen
class Model:
    """The base of all models: a frozen class whose fields, declared by `key`, are the inputs in SI.

    `also` are other names of the model, `spellings` those of inputs. A group of inputs in a file of cases (`tool: {…}`)
    is only an order: its keys are those of the model.
    """

    kind: ClassVar[str] = ""
    says: ClassVar[str] = ""
    source: ClassVar[str] = ""
    also: ClassVar[tuple[str, ...]] = ()
    spellings: ClassVar[Mapping[str, str]] = {}
    gives: ClassVar[tuple[Result, ...]] = ()

    def compute(self) -> dict[str, Value]:
        """The results in SI by their names; CannotComputeError where there are none."""
        raise NotImplementedError

    def turn(self) -> OneTurn | None:
        """One revolution for a chart; None for a model that has none."""
        return None

    def remarks(self) -> list[str]:
        """What was assumed, for people."""
        return []

    @classmethod
    def result_named(cls, name: str) -> Result | None:
        """The declaration of a quantity."""
        return next((result for result in cls.gives if result.means(name)), None)


def inputs_of(cls: type) -> dict[str, Key]:
    """The declared inputs of a model by name."""
    return all_keys(cls)


def all_spellings(cls: type[Model]) -> dict[str, str]:
    """Other names of inputs, also those that bases declare."""
    found: dict[str, str] = {}
    for base in reversed(cls.__mro__):
        found |= vars(base).get("spellings", {})
    return found


def shown_value(value: Any, unit: str) -> str:
    """A value in its unit for people."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, str):
        return value
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(f'{one:.6g}' for one in value)}]" + (f" {unit}" if unit else "")
    return f"{value:.6g} {unit}".strip()
