"""Light barriers and proximity switches: what is on their line."""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.sensors.light_barrier import LightBarrier
from gcodesim.sensors.noise import Noise
from gcodesim.sensors.proximity_switch import ProximitySwitch
from gcodesim.sensors.scenery import Scenery
from gcodesim.sensors.sensor import Sight
from gcodesim.sensors.switch import SightSwitch
from gcodesim.solids import Box, triangles_of


def state(sensor: SightSwitch, lower: tuple[float, float, float], X: np.ndarray | None = None) -> dict[str, float]:
    """What a sensor says of a cube with sides of 0.1 m."""
    skin = triangles_of(Box(lower=lower, upper=tuple(value + 0.1 for value in lower)))
    scenery = Scenery.of([(skin.points[skin.faces], np.array([90, 120, 150], np.uint8))])
    sight = Sight(X_WC=np.eye(4) if X is None else X, scenery=scenery, noise=Noise(1, "s", 1))
    return dict(sensor.read(sight)["state"].values)


@pytest.mark.parametrize(
    ("lower", "broken"),
    [
        ((0.2, -0.05, -0.05), 1.0),
        ((0.2, 0.001, -0.05), 0.0),  # beside the beam by 1 mm
        ((0.2, -0.099, -0.05), 1.0),  # in it by 1 mm
        ((0.401, -0.05, -0.05), 0.0),  # behind the receiver
        ((-0.101, -0.05, -0.05), 0.0),  # behind the sender
    ],
)
def test_a_beam_is_broken_by_what_is_between_its_ends(lower: tuple[float, float, float], broken: float) -> None:
    light, dark = (LightBarrier(beam=(0.4, 0.0, 0.0), normally_closed=closed) for closed in (False, True))

    assert state(light, lower) == {"broken": broken, "input": broken}
    assert state(dark, lower) == {"broken": broken, "input": 1.0 - broken}


def test_a_proximity_switch_tells_how_far_it_is() -> None:
    switch = ProximitySwitch(range=0.02)
    turned = np.eye(4)
    turned[:3, :3] = [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]  # Z along X of the world

    near = state(switch, (0.015, -0.05, -0.05), turned)

    assert near["detected"] == 1.0 and near["distance_m"] == pytest.approx(0.015, rel=1e-12)
    assert state(switch, (0.021, -0.05, -0.05), turned)["detected"] == 0.0
    assert state(switch, (-0.05, -0.05, 0.015))["detected"] == 1.0


def test_a_line_through_the_edge_between_two_triangles_meets_the_face() -> None:
    """The faces of a box are two triangles each; the line through the middle of a face meets their common side."""
    assert all(
        state(LightBarrier(beam=(0.4, 0.0, 0.0)), (0.2, -0.05 + shift, -0.05 + shift))["broken"]
        for shift in np.linspace(-0.049, 0.049, 99)
    )


def test_a_beam_without_length_is_none() -> None:
    assert [key for key, _ in LightBarrier(beam=(0.0, 0.0, 0.0)).problems()] == ["beam"]
