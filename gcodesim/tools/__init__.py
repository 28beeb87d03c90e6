"""Tools: one file a kind, its parameters on top; `TOOLS[kind]` is the dataclass."""

from gcodesim.family import Family

TOOLS = Family(
    "tools",
    of="gcodesim.tools.tool:Tool",
    called="kind",
    flat_end_mill="gcodesim.tools.flat_end_mill:FlatEndMill",
    ball_end_mill="gcodesim.tools.ball_end_mill:BallEndMill",
    bull_nose_end_mill="gcodesim.tools.bull_nose_end_mill:BullNoseEndMill",
    drill="gcodesim.tools.drill:Drill",
    extruder="gcodesim.tools.extruder:Extruder",
    probe="gcodesim.tools.probe:Probe",
)

__all__ = ["TOOLS"]
