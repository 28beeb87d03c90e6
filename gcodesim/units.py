"""Factors from shop-floor units to SI; the only place where they are written.

Inside gcodesim everything is SI. A value in another unit carries the unit in
its name and is converted here, at the border: program text, cell file, command
line, report.
"""

from math import pi
from typing import Final

MM: Final = 1e-3
INCH: Final = 25.4e-3
FOOT: Final = 0.3048
UM: Final = 1e-6
MINUTE: Final = 60.0
DEG: Final = pi / 180.0
RPM: Final = 2.0 * pi / 60.0
MM_PER_MINUTE: Final = MM / MINUTE
N_PER_MM2: Final = 1e6
N_PER_MM: Final = 1e3
KW: Final = 1e3
HP: Final = 745.6998715822702
"""The mechanical horsepower of 550 foot pounds of force a second."""
PS: Final = 735.49875
"""The metric horsepower of 75 kilopond metres a second."""
MM2: Final = 1e-6
MM3: Final = 1e-9
CM3: Final = 1e-6
CM3_PER_MINUTE: Final = CM3 / MINUTE

NS_PER_SECOND: Final = 1_000_000_000
"""Times are counted in whole nanoseconds."""
