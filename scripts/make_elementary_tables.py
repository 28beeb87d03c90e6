"""Write gcodesim/arithmetic/table_kernels.py: elementary functions as pairs of doubles, from decimal arithmetic.

python scripts/make_elementary_tables.py
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable
from decimal import Decimal, getcontext
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from tests.decimal_functions import arctangent, cosine, exponential, logarithm, pi_with, sine

PAGE = Path(__file__).resolve().parent.parent / "gcodesim" / "arithmetic" / "table_kernels.py"
DIGITS = 60
BITS_OF_INVERSE = 24 * 52  # of 2/pi: enough for the greatest double


def pair(value: Decimal) -> tuple[float, float]:
    """The nearest double and the nearest double of the rest."""
    high = float(value)
    return high, float(value - Decimal(high))


def short(value: Decimal, bits: int) -> float:
    """The first `bits` bits of a value."""
    mantissa, exponent = math.frexp(float(value))
    return math.ldexp(math.floor(math.ldexp(mantissa, bits)), exponent - bits)


def rows(name: str, values: Iterable[tuple[float, ...]]) -> str:
    lines = "\n".join(f"        ({', '.join(map(repr, row))})," for row in values)
    return f"{name}: Final = np.array(\n    (\n{lines}\n    )\n)\n"


def parts(value: Decimal, *bits: int) -> tuple[float, ...]:
    """Doubles whose sum is the value: all but the last have no more than so many bits."""
    found = []
    for count in bits:
        found.append(short(value, count))
        value -= Decimal(found[-1])
    return *found, float(value)


def inverse_chunks() -> list[int]:
    """2/pi in pieces of 24 bits."""
    getcontext().prec = 420
    whole = int(2 / pi_with(410) * 2**BITS_OF_INVERSE)
    getcontext().prec = DIGITS
    return [(whole >> (BITS_OF_INVERSE - 24 * (i + 1))) & 0xFFFFFF for i in range(BITS_OF_INVERSE // 24)]


def reciprocal(j: int) -> float:
    """About 1/(1 + j/128), in twelve bits, for j from -38 to 53; exactly 1 near 1."""
    return 1.0 if j == 0 else round(2048.0 / (1.0 + j / 128.0)) / 2048.0


def main() -> None:
    chunks = inverse_chunks()
    getcontext().prec = DIGITS
    pi, two = pi_with(DIGITS), logarithm(Decimal(2))
    lines = [chunks[i : i + 10] for i in range(0, len(chunks), 10)]
    text = [
        '"""Elementary functions as pairs of doubles, high and low; made by scripts/make_elementary_tables.py."""\n',
        "from typing import Final\n\nimport numpy as np\n",
        f"PI: Final = {pair(pi)!r}",
        f"HALF_PI: Final = {pair(pi / 2)!r}",
        f"QUARTER_PI: Final = {pair(pi / 4)!r}",
        f"\n# pi/2 in three parts; the first two have 33 bits\nHALF_PI_PARTS: Final = {parts(pi / 2, 33, 33)!r}",
        "\n# ln 2 in three parts, and the 64th part of it in two; the first ones have 32 bits",
        f"LN2_PARTS: Final = {parts(two, 32, 32)!r}",
        f"LN2_64TH_PARTS: Final = {parts(two / 64, 32)!r}",
        f"INVERSE_LN10: Final = {pair(1 / logarithm(Decimal(10)))!r}",
        "\n# sine (high, low) and cosine (high, low) of k / 128",
        rows("SINES", ((*pair(sine(Decimal(k) / 128)), *pair(cosine(Decimal(k) / 128))) for k in range(102))),
        "# arcus tangent of k / 128",
        rows("ARCTANGENTS", (pair(arctangent(Decimal(k) / 128)) for k in range(129))),
        "# 2 to the power of k / 64",
        rows("POWERS_OF_TWO", (pair(exponential(two * k / 64)) for k in range(64))),
        "# c, about 1 / (1 + j / 128), in twelve bits, and -ln c, for j from -38 to 53",
        rows("LOGARITHMS", ((c, *pair(-logarithm(Decimal(c)))) for c in map(reciprocal, range(-38, 54)))),
        "# 2/pi in pieces of 24 bits",
        "INVERSE_OF_HALF_PI: Final = np.array(\n    (",
        *(f"        {', '.join(map(str, line))}," for line in lines),
        "    )\n)",
    ]
    PAGE.write_text("\n".join(text) + "\n")


if __name__ == "__main__":
    main()
