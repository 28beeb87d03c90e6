"""A log in the formats of other programs: tables, JSON lines, meshes, ROS 2 bags; `EXPORTERS[kind]` is the class."""

from gcodesim.family import Family

EXPORTERS = Family(
    "exporters",
    of="gcodesim.export.exporter:Exporter",
    called="kind",
    csv="gcodesim.export.table:Csv",
    jsonl="gcodesim.export.lines:JsonLines",
    stl="gcodesim.export.part:Stl",
    glb="gcodesim.export.model:Glb",
    rosbag2="gcodesim.export.rosbag:RosBag",
)

__all__ = ["EXPORTERS"]
