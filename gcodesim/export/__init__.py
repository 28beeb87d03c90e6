"""A log in the formats of others: tables, meshes, sections, heights, ROS 2 bags; `EXPORTERS[kind]` is the class."""

from typing import Any

from gcodesim.family import Family

_NOT_WORDS: dict[str, Any] = {"3mf": "gcodesim.export.painted:ThreeMf"}

EXPORTERS = Family(
    "exporters",
    of="gcodesim.export.exporter:Exporter",
    called="kind",
    csv="gcodesim.export.table:Csv",
    jsonl="gcodesim.export.lines:JsonLines",
    stl="gcodesim.export.part:Stl",
    ply="gcodesim.export.painted:Ply",
    glb="gcodesim.export.model:Glb",
    svg="gcodesim.export.section:SectionDrawing",
    png="gcodesim.export.heights:HeightPicture",
    npz="gcodesim.export.heights:HeightNumbers",
    rosbag2="gcodesim.export.rosbag:RosBag",
    usd="gcodesim.export.usd:Usd",
    usdc="gcodesim.export.usd:PackedUsd",
    **_NOT_WORDS,
)

__all__ = ["EXPORTERS"]
