"""The table of the laser, with its URDF beside it."""

from pathlib import Path

from gcodesim.kinematics.models import ShippedModel

TABLE = ShippedModel(
    name="bright_table",
    title="Bright engraving table",
    kind="machine",
    home=(0.0, 0.0, 0.0),
    urdf=Path(__file__).with_name("table.urdf"),
)
