"""Draw how far the tip was from its command in several runs: `python scripts/error_chart.py out/a out/b chart.png`.

Each run is a curve with the name of its folder. All mill the same path, so their times agree.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import matplotlib
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from gcodesim.playback.quantities import charts_of
from gcodesim.playback.recording import Recording
from gcodesim.report.plot import COLOURS, METADATA, STYLE

SIZE, DPI = (6.4, 4.8), 100  # inches, pixels an inch: as large as the pictures of `cell_picture.py`
NAMED = ("error", "force")


def draw(runs: list[Path], png: Path) -> None:
    """Chart of the errors, and below it the forces, over the same time."""
    matplotlib.rcdefaults()
    matplotlib.rcParams.update(STYLE)
    figure = Figure(figsize=SIZE, dpi=DPI, facecolor="white")
    FigureCanvasAgg(figure)
    axes = figure.subplots(len(NAMED), 1, sharex=True, height_ratios=(3, 2))
    for run, colour in zip(runs, COLOURS, strict=False):
        for axis, chart in zip(axes, charts_of(Recording.open(run), NAMED), strict=True):
            (curve,) = chart.curves
            axis.plot(curve.t_ns * 1e-9, curve.values, color=colour, linewidth=1.1, label=run.name)
            axis.set_ylabel(f"{chart.title} [{chart.unit}]")
    for axis in axes:
        axis.grid(True)
        axis.set_ylim(bottom=0.0)
        axis.margins(x=0.0)
        for side in ("top", "right"):
            axis.spines[side].set_visible(False)
    axes[0].legend(frameon=False, loc="upper left")
    axes[-1].set_xlabel("time [s]")
    figure.align_ylabels(list(axes))
    figure.tight_layout()
    figure.savefig(png, format="png", metadata=METADATA["png"])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("runs", type=Path, nargs="+", help="folders of the runs")
    parser.add_argument("png", type=Path)
    said = parser.parse_args()
    draw(said.runs, said.png)


if __name__ == "__main__":
    main()
