"""The viewer layout that a log carries: the shipped one, with the plots of this cell's joints."""

from __future__ import annotations

import json
from collections.abc import Sequence
from importlib.resources import files


def default_layout(joint_names: Sequence[str]) -> bytes:
    """The layout as JSON; the joint plot names each of `joint_names`."""
    layout = json.loads((files("gcodesim") / "data" / "log" / "layout.json").read_text(encoding="utf-8"))
    plot = layout["configById"]["Plot!joints"]
    plot["paths"] = [
        {
            "value": f'/joint_states.joints[:]{{name=="{name}"}}.position',
            "enabled": True,
            "label": name.rpartition("/")[2],
            "timestampMethod": "receiveTime",
        }
        for name in joint_names
    ]
    return (json.dumps(layout, indent=1) + "\n").encode()
