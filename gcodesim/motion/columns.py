"""The type of a column of any number type, as kernels take them."""

from typing import Any

from numpy.typing import NDArray

Column = NDArray[Any]
