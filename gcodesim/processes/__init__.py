"""Processes: what a tool does to material, and the wrench that this takes; `PROCESSES[name]` is the class."""

from gcodesim.family import Family

PROCESSES = Family(
    "processes",
    of="gcodesim.processes.protocol:Process",
    called="kind",
    milling="gcodesim.processes.milling:Milling",
    extrusion="gcodesim.processes.extrusion:Extrusion",
    arc_welding="gcodesim.processes.arc_welding:ArcWelding",
    ablation="gcodesim.processes.ablation:Ablation",
    erosion="gcodesim.processes.erosion:Erosion",
    spraying="gcodesim.processes.spraying:Spraying",
    gripping="gcodesim.processes.gripping:Gripping",
    sensing="gcodesim.processes.sensing:Sensing",
    turning="gcodesim.processes.turning:Turning",
    loading="gcodesim.processes.loading:Loading",
)

__all__ = ["PROCESSES"]
