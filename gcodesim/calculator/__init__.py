"""Physics as a calculator: one file a model, over the functions that a run uses; `CALCULATORS[name]` is the class."""

from typing import Any, Final

from gcodesim.family import Family

# some names have a dot, so that they cannot be keywords
_PLACES: Final[dict[str, Any]] = {
    "kienzle": "gcodesim.calculator.chip:KienzleChip",
    "linear_edge": "gcodesim.calculator.chip:LinearEdgeChip",
    "endmill": "gcodesim.calculator.endmill:EndMill",
    "drill": "gcodesim.calculator.drill:Drilling",
    "tapping": "gcodesim.calculator.tapping:Tapping",
    "turning": "gcodesim.calculator.turning:TurningCut",
    "cutting_data": "gcodesim.calculator.cutting_data:CuttingData",
    "chip_thinning": "gcodesim.calculator.chip_thinning:ChipThinning",
    "scallop": "gcodesim.calculator.scallop:Scallop",
    "deflection": "gcodesim.calculator.bending:ToolBending",
    "stability.milling": "gcodesim.calculator.chatter:MillingLobes",
    "stability.turning": "gcodesim.calculator.chatter:TurningStability",
    "wear.taylor": "gcodesim.calculator.tool_life:ToolLife",
    "additive.fdm": "gcodesim.calculator.bead:FilamentLine",
    "additive.bead": "gcodesim.calculator.bead:BeadSection",
    "remove.jet": "gcodesim.calculator.beams:JetCut",
    "remove.gaussian": "gcodesim.calculator.beams:GaussianSpot",
    "remove.energy": "gcodesim.calculator.beams:EnergyBalance",
    "additive.particles": "gcodesim.calculator.particles:ParticleFlow",
    "additive.spiral": "gcodesim.calculator.spiral_wall:SpiralWall",
    "additive.weld": "gcodesim.calculator.welding:ArcWeld",
    "spray.gaussian": "gcodesim.calculator.spray:SprayStripe",
    "spray.overlap": "gcodesim.calculator.spray:SprayOverlap",
    "spray.tilted_cone": "gcodesim.calculator.spray:TiltedCone",
    "grip.suction": "gcodesim.calculator.grip:SuctionLoad",
    "grip.friction": "gcodesim.calculator.grip:FrictionGrip",
    "motion.trapezoid": "gcodesim.calculator.motion:Trapezoid",
    "motion.corner": "gcodesim.calculator.motion:RoundedCorner",
    "robot.compliance": "gcodesim.calculator.arm:ArmCompliance",
}

CALCULATORS = Family("calculators", of="gcodesim.calculator.model:Model", called="kind", **_PLACES)
"""The order is that in which they are listed."""

__all__ = ["CALCULATORS"]
