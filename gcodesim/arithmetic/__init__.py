"""Numbers with the same bits on every processor.

Functions of the library of C, of numpy and of BLAS choose their code by the processor, and the last bits of what
they return differ. Here are functions and products of small matrices made of additions, multiplications, divisions
and square roots alone, which IEEE 754 defines to the bit, always in the same order. Compiled and interpreted they
give the same bits.

    sin_kernels, atan_kernels, power_kernels     scalars, for kernels
    scalars                                      functions of single numbers that are loaded when they are needed
    elementary                                   the same functions for Python: scalars and arrays
    matrices                                     products, lengths, inverses of small matrices
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from numpy import float64
    from numpy.typing import NDArray

    Array = NDArray[float64]
else:
    Array = Any  # numpy takes 0.1 s to load, and readers of short programs do without it
