"""Controllers of robots: how motors follow the command. One file each; `CONTROLLERS[kind]` is the dataclass."""

from gcodesim.controllers.controller import Controller, RobotModel, Sense
from gcodesim.family import Family

CONTROLLERS = Family(
    "controllers",
    of="gcodesim.controllers.controller:Controller",
    called="kind",
    ideal="gcodesim.controllers.ideal:Ideal",
    flexible="gcodesim.controllers.flexible:Flexible",
    pd="gcodesim.controllers.pd:PD",
    computed_torque="gcodesim.controllers.computed_torque:ComputedTorque",
)

__all__ = ["CONTROLLERS", "Controller", "RobotModel", "Sense"]
