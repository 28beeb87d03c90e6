"""Settings of controls and robots, as cells; `IMPORTERS[kind]` is the class."""

from gcodesim.family import Family

IMPORTERS = Family(
    "importers",
    of="gcodesim.importers.importer:Importer",
    called="kind",
    linuxcnc="gcodesim.importers.linuxcnc:LinuxCnc",
    grbl="gcodesim.importers.grbl:Grbl",
    klipper="gcodesim.importers.klipper:Klipper",
    marlin="gcodesim.importers.marlin:Marlin",
    moveit="gcodesim.importers.moveit:MoveIt",
)

__all__ = ["IMPORTERS"]
