"""The machines that ship: what a URDF cannot say about them, and where their URDFs are."""

from __future__ import annotations

from pathlib import Path
from typing import Final, Literal

from gcodesim.family import Family
from gcodesim.frozen import frozen
from gcodesim.units import DEG

_FOLDER: Final = Path(__file__).resolve().parent.parent / "models"


@frozen
class ShippedModel:
    """A shipped machine: `stiffness` [N·m/rad] a joint or None for a rigid machine, `home` [rad, m], `payload` [kg].

    `lathe`: the work turns about Z at X0. `urdf` is the file of a model that another package brings; ours are found
    by their name.

    Travel, speed, effort and, where a source names it, acceleration stand in
    the URDF; `stiffness_source` says where the stiffness comes from.
    """

    name: str
    title: str
    kind: Literal["arm", "machine"]
    home: tuple[float, ...]
    payload: float | None = None
    stiffness: tuple[float, ...] | None = None
    stiffness_source: str = ""
    urdf: Path | None = None
    lathe: bool = False

    @property
    def path(self) -> Path:
        """The URDF file."""
        return _FOLDER / f"{self.name}.urdf" if self.urdf is None else self.urdf


def _degrees(*values: float) -> tuple[float, ...]:
    return tuple(v * DEG for v in values)


_SCALED = (
    "own estimate: 200 kg class arms lie between 2e5 (wrist) and 4e6 N·m/rad (shoulder), "
    "10 kg class arms are 10 to 30 times softer"
)
_STIFF_10_KG = (1.5e5, 1.4e5, 9e4, 3e4, 2.5e4, 1.5e4)
_STIFF_200_KG = (3.5e6, 3.8e6, 2.5e6, 6e5, 4e5, 2.5e5)

_SHIPPED: Final = {
    model.name: model
    for model in (
        ShippedModel(
            name="abb_irb1200_5_90",
            title="ABB IRB 1200-5/0.9",
            kind="arm",
            home=_degrees(0, 0, 0, 0, 90, 0),
            payload=5.0,
            stiffness=(1.2e5, 1.1e5, 7e4, 2.5e4, 2e4, 1.2e4),
            stiffness_source=_SCALED,
        ),
        ShippedModel(
            name="abb_irb6700_200_260",
            title="ABB IRB 6700-200/2.60",
            kind="arm",
            home=_degrees(0, 0, 0, 0, 90, 0),
            payload=200.0,
            stiffness=_STIFF_200_KG,
            stiffness_source=_SCALED,
        ),
        ShippedModel(
            name="fanuc_m20ia",
            title="FANUC M-20iA",
            kind="arm",
            home=_degrees(0, 0, 0, 0, -90, 0),
            payload=20.0,
            stiffness=(4e5, 4e5, 2.5e5, 8e4, 6e4, 3e4),
            stiffness_source=_SCALED,
        ),
        ShippedModel(name="gantry_xyz", title="three-axis gantry router", kind="machine", home=(0.0, 0.0, 0.0)),
        ShippedModel(
            name="kuka_kr10_r1100_2",
            title="KUKA KR 10 R1100-2",
            kind="arm",
            home=_degrees(0, -90, 90, 0, 90, 0),
            payload=10.0,
            stiffness=_STIFF_10_KG,
            stiffness_source=_SCALED,
        ),
        ShippedModel(
            name="kuka_kr10_r1100_sixx",
            title="KUKA KR 10 R1100 sixx",
            kind="arm",
            home=_degrees(0, -90, 90, 0, 90, 0),
            payload=10.0,
            stiffness=_STIFF_10_KG,
            stiffness_source=_SCALED,
        ),
        ShippedModel(
            name="kuka_kr210_r2700_2",
            title="KUKA KR 210 R2700-2",
            kind="arm",
            home=_degrees(0, -90, 90, 0, 90, 0),
            payload=210.0,
            stiffness=_STIFF_200_KG,
            stiffness_source=_SCALED,
        ),
        ShippedModel(
            name="lathe_xyzc",
            title="lathe with C axis, Y axis and driven tools",
            kind="machine",
            home=(0.15, 0.0, 0.6, 0.0),
            lathe=True,
        ),
        ShippedModel(name="lathe_xz", title="two-axis lathe", kind="machine", home=(0.15, 0.6), lathe=True),
        ShippedModel(
            name="mill_xyzac_trunnion",
            title="five-axis mill with tilting rotary table",
            kind="machine",
            home=(0.0, 0.0, 0.4, 0.0, 0.0),
        ),
        ShippedModel(
            name="staubli_tx2_90",
            title="Staubli TX2-90",
            kind="arm",
            home=_degrees(0, 0, 90, 0, 90, 0),
            payload=14.0,
            stiffness=(2.5e5, 2.2e5, 1.3e5, 4e4, 3.5e4, 2e4),
            stiffness_source=_SCALED,
        ),
        ShippedModel(
            name="ur10e",
            title="Universal Robots UR10e",
            kind="arm",
            home=_degrees(0, -90, 90, -90, -90, 0),
            payload=12.5,
            stiffness=(5e4, 5e4, 3e4, 1e4, 1e4, 1e4),
            stiffness_source="own estimate: strain wave gears of the joints' size classes",
        ),
    )
}

MODELS: Final = Family("machines", _SHIPPED, of="gcodesim.kinematics.models:ShippedModel", called="name")
"""Models by name; an entry point of group `gcodesim.machines` adds one that has its own `urdf`."""


def model_path(name: str) -> Path:
    """The URDF of a shipped model; KeyError when there is none of that name."""
    path: Path = MODELS[name].path
    return path
