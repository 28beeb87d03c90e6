"""Chart of one revolution of a mill: force and torque over the angle of its first tooth."""

from __future__ import annotations

from io import BytesIO
from typing import TYPE_CHECKING

import numpy as np

from gcodesim.report.plot import COLOURS, METADATA, STYLE
from gcodesim.units import DEG

if TYPE_CHECKING:
    from gcodesim.processes.constant_cut import OneTurn

_SIZE = (9.0, 4.6)  # inches


def draw_turn(turn: OneTurn, kind: str) -> bytes:
    """A picture (`kind` svg, png or pdf); ExtraMissingError without matplotlib is the caller's to ask."""
    import matplotlib
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    angle = np.append(turn.angle, turn.angle[0] + 360.0 * DEG) / DEG
    force = np.vstack([turn.force, turn.force[:1]])
    torque = np.append(turn.torque, turn.torque[0])
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(STYLE)
        figure = Figure(figsize=_SIZE, dpi=110, facecolor="white", layout="constrained")
        FigureCanvasAgg(figure)
        upper, lower = figure.subplots(2, 1, sharex=True)
        for i, name in enumerate(("along the feed", "to its left", "towards the holder")):
            upper.plot(angle, force[:, i], color=COLOURS[i], linewidth=1.0, label=name)
        upper.plot(angle, np.sqrt((force * force).sum(axis=1)), color=COLOURS[-1], linewidth=1.0, label="size")
        upper.set_ylabel("force on the tool\n[N]")
        upper.legend(loc="center left", bbox_to_anchor=(1.005, 0.5), frameon=False, fontsize=8.5, handlelength=1.3)
        lower.plot(angle, torque, color=COLOURS[0], linewidth=1.0)
        lower.set_ylabel("torque\n[N·m]")
        lower.set_xlabel("angle of the first tooth, clockwise from left of the feed [°]")
        for axis in (upper, lower):
            axis.set_xlim(0.0, 360.0)
            axis.set_xticks(range(0, 361, 45))
            axis.grid(True)
            axis.set_axisbelow(True)
            for side in ("top", "right"):
                axis.spines[side].set_visible(False)
        out = BytesIO()
        figure.savefig(out, format=kind, metadata=METADATA[kind])
    return out.getvalue()
