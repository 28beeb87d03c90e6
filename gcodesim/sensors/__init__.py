"""Sensors: one file a kind, its keys on top; `SENSORS[kind]` is the dataclass.

A sensor is given what it may know of one moment (`sensor.Sight`, or `sensor.Load` for a while of steps) and answers
with values of the kinds in `outputs`. It knows no cell, no program and no log.
"""

from gcodesim.family import Family

SENSORS = Family(
    "sensors",
    of="gcodesim.sensors.sensor:Sensor",
    called="kind",
    camera="gcodesim.sensors.camera:Camera",
    depth_camera="gcodesim.sensors.camera:DepthCamera",
    line_scanner="gcodesim.sensors.line_scanner:LineScanner",
    force_sensor="gcodesim.sensors.force_sensor:ForceSensor",
    light_barrier="gcodesim.sensors.light_barrier:LightBarrier",
    proximity_switch="gcodesim.sensors.proximity_switch:ProximitySwitch",
)

__all__ = ["SENSORS"]
