"""The tip of a tool that is not straight: an angle head, a welding torch with a bent neck, a gripper on a plate."""

from __future__ import annotations

from gcodesim.declarations.keys import key
from gcodesim.declarations.quantity import Quantity, Vector
from gcodesim.frames import Pose
from gcodesim.frozen import frozen


@frozen
class Tcp:
    """The tool frame T seen from the flange: `xyz` [m] is the tip, `rpy` [rad] turns Z from that of the flange to the
    way in which the tool points."""

    xyz: tuple[float, ...] = key(
        Vector(Quantity("length"), 3, "[60, 0, 320 mm]"), "where the tip is", example="[60, 0, 320 mm]"
    )
    rpy: tuple[float, ...] = key(
        Vector(Quantity("angle"), 3, "[0, 22, 0]"),
        "roll, pitch and yaw of the tool: about X, then Y, then Z of the flange",
        default=(0.0, 0.0, 0.0),
        example="[0, 22, 0]",
    )

    @property
    def X_FT(self) -> Pose:
        """Pose of the tool frame seen from the flange."""
        x, y, z = self.xyz
        roll, pitch, yaw = self.rpy
        return Pose.from_xyz_rpy((x, y, z), (roll, pitch, yaw))
