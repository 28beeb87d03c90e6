"""The elementary functions of single numbers, for code that must start fast.

Their tables are arrays, and numpy takes longer to load than a short program to be read. So `elementary` is loaded by
the first call, which most programs never make.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final


def _late(name: str) -> Callable[..., Any]:
    known: list[Callable[..., Any]] = []

    def function(*values: float) -> Any:
        if not known:
            from gcodesim.arithmetic import elementary

            known.append(getattr(elementary, name))
        return known[0](*values)

    return function


sin: Final[Callable[[float], float]] = _late("sin")
cos: Final[Callable[[float], float]] = _late("cos")
tan: Final[Callable[[float], float]] = _late("tan")
asin: Final[Callable[[float], float]] = _late("asin")
acos: Final[Callable[[float], float]] = _late("acos")
atan: Final[Callable[[float], float]] = _late("atan")
atan2: Final[Callable[[float, float], float]] = _late("atan2")
exp: Final[Callable[[float], float]] = _late("exp")
log: Final[Callable[[float], float]] = _late("log")
power: Final[Callable[[float, float], float]] = _late("power")
cos_sin: Final[Callable[[float], tuple[float, float]]] = _late("cos_sin")
