"""Fanuc 0i-TF and its like: lathes with G-code system A or B; see `gcodesim/rs274/fanuc/lathe.py`."""

from __future__ import annotations

import dataclasses

from gcodesim.rs274.dialects.fanuc import FANUC

FANUC_LATHE = dataclasses.replace(
    FANUC,
    name="fanuc_lathe",
    executor="gcodesim.rs274.fanuc.lathe:FanucLatheExecutor",
    lathe=None,
    further_systems=(),  # those of the milling control
    turret=True,
    unsimulated={code: what for code, what in FANUC.unsimulated.items() if what != "polar coordinate interpolation"},
)

FANUC_LATHE_B = dataclasses.replace(
    FANUC_LATHE,
    name="fanuc_lathe_b",
    executor="gcodesim.rs274.fanuc.lathe_system_b:FanucLatheSystemBExecutor",
)
