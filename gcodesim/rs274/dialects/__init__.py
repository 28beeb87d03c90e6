"""Dialects: what one control accepts and another does not. One file each."""

from gcodesim.family import Family
from gcodesim.rs274.dialects.dialect import Dialect, Lathe, SystemBlock, g_name

DIALECTS = Family(
    "dialects",
    of="gcodesim.rs274.dialects.dialect:Dialect",
    called="name",
    fanuc="gcodesim.rs274.dialects.fanuc:FANUC",
    fanuc_lathe="gcodesim.rs274.dialects.fanuc_lathe:FANUC_LATHE",
    fanuc_lathe_b="gcodesim.rs274.dialects.fanuc_lathe:FANUC_LATHE_B",
    grbl="gcodesim.rs274.dialects.grbl:GRBL",
    klipper="gcodesim.rs274.dialects.marlin:KLIPPER",
    linuxcnc="gcodesim.rs274.dialects.linuxcnc:LINUXCNC",
    marlin="gcodesim.rs274.dialects.marlin:MARLIN",
    reprapfirmware="gcodesim.rs274.dialects.marlin:REPRAPFIRMWARE",
    rs274="gcodesim.rs274.dialects.rs274:RS274",
)

__all__ = ["DIALECTS", "Dialect", "Lathe", "SystemBlock", "g_name"]
