"""What every sensor promises, whoever adds it."""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.log.schema import message_class
from gcodesim.observation.schedule import Station
from gcodesim.recorder.sensed import _SCHEMAS, sensor_message
from gcodesim.sensors import SENSORS
from gcodesim.sensors.noise import Noise
from gcodesim.sensors.outputs import digest
from gcodesim.sensors.scenery import Scenery
from gcodesim.sensors.sensor import Sensor, Sight
from gcodesim.solids import Box, triangles_of

EVERY = pytest.mark.parametrize("kind", SENSORS)


def _sight(number: int = 1) -> Sight:
    skin = triangles_of(Box(lower=(-0.1, -0.1, 0.3), upper=(0.1, 0.1, 0.4)))
    scenery = Scenery.of([(skin.points[skin.faces], np.array([90, 120, 150], np.uint8))])
    return Sight(X_WC=np.eye(4), scenery=scenery, noise=Noise(1, "s", number), load=np.arange(1.0, 7.0))


def _blind() -> Sight:
    return Sight(X_WC=np.eye(4), scenery=Scenery.of(()), noise=Noise(1, "s", 1))


def _sensor(kind: str) -> Sensor:
    sensor: Sensor = SENSORS[kind]()
    assert not sensor.problems()
    return sensor


@EVERY
def test_its_name_stands_in_the_table_and_nothing_is_required(kind: str) -> None:
    assert SENSORS[kind].kind == kind
    assert len(_sensor(kind).order) == 2


@EVERY
@pytest.mark.parametrize("sight", [_sight(), _blind()])
def test_it_gives_what_it_says(kind: str, sight: Sight) -> None:
    sensor = _sensor(kind)

    found = sensor.read(sight)

    assert {name: type(output) for name, output in found.items()} == dict(sensor.outputs)
    assert all(form in _SCHEMAS for form in sensor.outputs.values())


@EVERY
def test_the_same_sight_gives_the_same_bits_and_without_noise_every_reading_does(kind: str) -> None:
    sensor = _sensor(kind)

    first, again, later = (sensor.read(_sight(number)) for number in (1, 1, 2))

    digests = [[digest(output) for output in found.values()] for found in (first, again, later)]
    assert digests[0] == digests[1] == digests[2]


@EVERY
def test_it_changes_nothing_of_what_it_sees(kind: str) -> None:
    sight = _sight()
    before = sight.scenery.triangles.tobytes(), sight.scenery.colors.tobytes(), sight.X_WC.tobytes()

    _sensor(kind).read(sight)

    assert before == (sight.scenery.triangles.tobytes(), sight.scenery.colors.tobytes(), sight.X_WC.tobytes())


@EVERY
def test_its_messages_are_those_of_the_schema(kind: str) -> None:
    """Read back by protobuf, with its frame and its time."""
    sensor = _sensor(kind)
    station = Station(name="s", sensor=sensor, frame="sensor/s")

    for output in sensor.read(_sight()).values():
        message = message_class(_SCHEMAS[type(output)]).FromString(sensor_message(station, 1_500_000_000, output))
        assert (message.timestamp.seconds, message.timestamp.nanos) == (1, 500_000_000)
        if hasattr(message, "frame_id"):
            assert message.frame_id == f"{sensor.order[0]}/s"
        assert message.ByteSize() == len(sensor_message(station, 1_500_000_000, output))
