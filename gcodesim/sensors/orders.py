"""What M-codes of a cell may tell sensors: `camera: shoot` and the like."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from gcodesim.sensors import SENSORS

if TYPE_CHECKING:
    from gcodesim.sensors.sensor import Sensor


def orders_of(sensors: Iterable[Sensor]) -> set[tuple[str, str]]:
    """Targets and verbs at which any of these sensors reads: those of its kind, and `sensor: read` for all."""
    from gcodesim.sensors.sensor import ORDER

    found = {sensor.order for sensor in sensors}
    return found | {ORDER} if found else found


def orders_of_all() -> dict[str, tuple[str, ...]]:
    """All verbs by target that any sensor obeys, those of third parties too."""
    from gcodesim.sensors.sensor import ORDER

    found: dict[str, dict[str, None]] = {}
    for target, verb in (ORDER, *(SENSORS[kind].order for kind in SENSORS)):
        found.setdefault(target, {})[verb] = None
    return {target: tuple(verbs) for target, verbs in found.items()}
