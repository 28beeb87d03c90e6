"""Parts of a tool's body: their names in messages, how they are drawn, and the finding when they hit something.

A kind of tool may name its parts as it likes. Those in `PARTS` have their own wording; a package may add more by
entry points of the group `gcodesim.parts`. Any other part is called by its name and drawn grey.
"""

from __future__ import annotations

from typing import Final

from gcodesim.family import Family
from gcodesim.frozen import frozen

Color = tuple[float, float, float, float]


@frozen
class BodyPart:
    """One part: `words` as in "the cutter hits the vise", the `code` and `hint` of that finding, and red to alpha.

    `acts`: it is what touches the work, and so it is there beside a body that the tool has from a file, too.
    """

    words: str
    color: Color = (0.5, 0.55, 0.6, 1.0)
    code: str = "GS304"
    hint: str = "keep more distance, or lift the tool before it passes"
    acts: bool = False


CUTTING: Final = BodyPart(
    words="the cutter", color=(0.85, 0.65, 0.2, 1.0), code="GS301", hint="retract higher or go round it", acts=True
)
SHANK: Final = BodyPart(
    words="the shank",
    color=(0.7, 0.72, 0.75, 1.0),
    code="GS302",
    hint="use a longer tool, or keep more distance",
    acts=True,
)
HOLDER: Final = BodyPart(
    words="the holder", color=(0.3, 0.32, 0.36, 1.0), code="GS303", hint="use a longer tool or a slimmer holder"
)
TIP: Final = BodyPart(
    words="the ball",
    color=(0.8, 0.1, 0.15, 1.0),
    hint="go there with G38.3, which stops where it touches, or keep more distance",
    acts=True,
)
NOZZLE: Final = BodyPart(words="the nozzle", color=(0.75, 0.55, 0.3, 1.0), hint="lift the tool before it passes")
OBJECTIVE: Final = BodyPart(words="the objective", color=(0.1, 0.12, 0.2, 1.0))

FINGER: Final = BodyPart(
    words="the finger", color=(0.25, 0.27, 0.3, 1.0), hint="open less wide, or keep more distance", acts=True
)
CUP: Final = BodyPart(words="the cup", color=(0.15, 0.15, 0.17, 1.0), hint="keep more distance", acts=True)
GRIPPER: Final = BodyPart(words="the gripper", color=(0.55, 0.58, 0.62, 1.0))

SPRAY: Final = BodyPart(words="the spray", color=(0.35, 0.55, 0.95, 0.35))
LIGHT: Final = BodyPart(words="the beam", color=(1.0, 0.2, 0.1, 0.8))
FLAME: Final = BodyPart(words="the arc", color=(0.55, 0.8, 1.0, 0.85))
STREAM: Final = BodyPart(words="the stream", color=(0.45, 0.7, 0.95, 0.6))
STRAND: Final = BodyPart(words="the strand", color=(0.95, 0.5, 0.1, 0.9))
SUCTION: Final = BodyPart(words="the suction", color=(0.3, 0.85, 0.45, 0.8))

PARTS = Family(
    "parts",
    of="gcodesim.tools.parts:BodyPart",
    cutting="gcodesim.tools.parts:CUTTING",
    shank="gcodesim.tools.parts:SHANK",
    holder="gcodesim.tools.parts:HOLDER",
    nozzle="gcodesim.tools.parts:NOZZLE",
    tip="gcodesim.tools.parts:TIP",
    objective="gcodesim.tools.parts:OBJECTIVE",
    finger="gcodesim.tools.parts:FINGER",
    cup="gcodesim.tools.parts:CUP",
    gripper="gcodesim.tools.parts:GRIPPER",
    spray="gcodesim.tools.parts:SPRAY",
    light="gcodesim.tools.parts:LIGHT",
    flame="gcodesim.tools.parts:FLAME",
    stream="gcodesim.tools.parts:STREAM",
    strand="gcodesim.tools.parts:STRAND",
    suction="gcodesim.tools.parts:SUCTION",
)


def body_part(name: str) -> BodyPart:
    """The part of this name; a plain grey one for names that nobody has described."""
    found: BodyPart | None = PARTS.get(name)
    return BodyPart(words=f"the {name.replace('_', ' ')}") if found is None else found
