"""The processors that machine code is made for: a few named sets of instructions, not the one that is here.

Code of two sets gives the same bytes: no operation is put in place of others (no fused multiply-add), and sums keep
their order. So a kept or shipped kernel says the same on every machine, and a newer set is only quicker.
"""

from __future__ import annotations

import platform
from functools import cache
from typing import Final

LEVELS: Final = {
    "x86-64-v4": frozenset(["avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"]),
    "x86-64-v3": frozenset(["avx", "avx2", "bmi1", "bmi2", "f16c", "fma", "abm", "movbe", "xsave"]),
    "x86-64-v2": frozenset(["cx16", "lahf_lm", "popcnt", "sse4_1", "sse4_2", "ssse3"]),
}
"""Sets of instructions of the x86-64 psABI, the quickest first, and the flags that Linux shows for them."""


@cache
def levels() -> tuple[str, ...]:
    """Names, as LLVM has them, of the sets of instructions that work here; the quickest first."""
    if platform.machine().lower() not in ("x86_64", "amd64"):
        return ("generic",)
    flags = _flags()
    if flags is None:
        return ("x86-64-v2",)  # as numpy's own packages demand
    needed: set[str] = set()
    usable = []
    for name, more in reversed(LEVELS.items()):
        needed |= more
        if needed <= flags:
            usable.append(name)
    return (*reversed(usable), "x86-64")


def level() -> str:
    """The set of instructions for which this process compiles."""
    return _chosen[-1] if _chosen else levels()[0]


def tuning() -> str:
    """What LLVM is told beside the set of instructions.

    Processors with vectors of 512 bits may use all of them: the kernel of milling takes a sixth less time than with
    the halves that LLVM prefers. The width of vectors changes no bit, since sums keep their order.
    """
    return "-prefer-256-bit" if level() == "x86-64-v4" else ""


def choose(level: str) -> None:
    """Compile for another set of instructions than the best of this machine, before the first kernel is compiled."""
    _chosen.append(level)


_chosen: list[str] = []


def _flags() -> set[str] | None:
    """What the first processor says of itself; the others are the same. None on systems that do not tell."""
    try:
        with open("/proc/cpuinfo", encoding="ascii", errors="replace") as file:
            for line in file:
                if line.startswith("flags"):
                    return set(line.partition(":")[2].split())
    except OSError:
        pass
    return None
