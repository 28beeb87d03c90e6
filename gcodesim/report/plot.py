"""Charts of a run as PNG or SVG, with the program lines as a second axis."""

from __future__ import annotations

from collections.abc import Sequence
from io import BytesIO
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.diagnostics.plain import one_line
from gcodesim.extras import require_extra
from gcodesim.log.event import settled
from gcodesim.playback.quantities import NEGLIGIBLE, Chart, thinned
from gcodesim.playback.recording import Recording

if TYPE_CHECKING:
    from matplotlib.axes import Axes

FORMATS: Final = ("svg", "png", "pdf")
_WIDTH, _HEIGHT, _HEAD = 11.0, 1.9, 1.1  # inches: of the picture, of one chart, of title and line axis
_SLOTS: Final = 1500  # two points in each: finer than a screen is wide
_INK, _MUTED, _GRID = "#1f2933", "#66727f", "#e4e8ec"
COLOURS: Final = ("#1768ac", "#d1495b", "#2e933c", "#edae49", "#7b4fb5", "#e07a9c", "#8d5524", "#66727f")
_FAINT: Final = "#b9c3cd"
_BANDS: Final = ("#f5f8fb", "#fdf8ef")  # one tool, the next tool
_SEVERE: Final = {"error": "#d1495b", "warning": "#edae49"}
STYLE: Final = {
    "font.family": "DejaVu Sans",  # ships with the library, so that every machine draws the same
    "font.size": 9.0,
    "svg.hashsalt": "gcodesim",
    "svg.fonttype": "path",
    "pdf.compression": 6,
    "axes.edgecolor": _MUTED,
    "axes.labelcolor": _INK,
    "axes.linewidth": 0.6,
    "axes.unicode_minus": True,
    "text.color": _INK,
    "text.parse_math": False,  # names are not formulas
    "xtick.color": _MUTED,
    "ytick.color": _MUTED,
    "xtick.labelcolor": _INK,
    "ytick.labelcolor": _INK,
    "grid.color": _GRID,
    "grid.linewidth": 0.7,
    "path.simplify": True,
}
METADATA: Final[dict[str, dict[str, Any]]] = {
    "svg": {"Date": None, "Creator": "gcodesim"},
    "png": {"Software": "gcodesim"},
    "pdf": {"CreationDate": None, "Creator": "gcodesim", "Producer": None},
}


class NoPlotError(Exception):
    """There is nothing to draw."""


def draw(
    recording: Recording, charts: Sequence[Chart], kind: str, *, first_ns: int = 0, last_ns: int | None = None
) -> bytes:
    """A picture (`kind` svg, png or pdf) of charts one above the other over the time first ≤ t ≤ last.

    The same log gives the same bytes, with the same version of the library.
    ExtraMissingError without matplotlib; NoPlotError when no chart has a value in that time.
    """
    require_extra("plot", "a chart")
    import matplotlib
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    last_ns = recording.end_ns if last_ns is None else last_ns
    shown = [chart for chart in charts if any(_within(c.t_ns, first_ns, last_ns).any() for c in chart.curves)]
    if not shown:
        raise NoPlotError("the log has no such numbers in that time")
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(STYLE)
        height = _HEAD + _HEIGHT * len(shown)
        figure = Figure(figsize=(_WIDTH, height), dpi=110, facecolor="white")
        FigureCanvasAgg(figure)
        axes = figure.subplots(len(shown), 1, sharex=True, squeeze=False)[:, 0]
        for axis, chart in zip(axes, shown, strict=True):
            _chart(axis, chart, first_ns, last_ns, recording.gaps)
            _background(axis, recording, first_ns, last_ns)
        axes[-1].set_xlabel("time [s]")
        axes[0].set_xlim(first_ns * 1e-9, max(last_ns, first_ns + 1) * 1e-9)
        _line_axis(axes[0], recording, first_ns, last_ns)
        figure.align_ylabels(list(axes))
        figure.subplots_adjust(left=0.092, right=0.885, bottom=0.5 / height, top=1.0 - 0.72 / height, hspace=0.16)
        figure.text(0.092, 1.0 - 0.26 / height, one_line(recording.name), weight="bold", fontsize=11)
        cell, world = one_line(recording.run.get("cell", "")), one_line(recording.run.get("world", ""))
        subtitle = f"{cell}, {world} world" if world else cell
        figure.text(0.885, 1.0 - 0.26 / height, subtitle, ha="right", color=_MUTED)
        out = BytesIO()
        figure.savefig(out, format=kind, metadata=METADATA[kind])
    return out.getvalue()


def _within(t_ns: NDArray[np.int64], first_ns: int, last_ns: int) -> NDArray[np.bool_]:
    inside: NDArray[np.bool_] = (t_ns >= first_ns) & (t_ns <= last_ns)
    return inside


def _chart(axis: Axes, chart: Chart, first_ns: int, last_ns: int, gaps: Sequence[tuple[int, int]]) -> None:
    plain = [curve for curve in chart.curves if not curve.faint]
    for curve in chart.curves:
        inside = _within(curve.t_ns, first_ns, last_ns)
        t_ns, values = thinned(curve.t_ns[inside], curve.values[inside], _SLOTS)
        colour = _FAINT if curve.faint else COLOURS[plain.index(curve) % len(COLOURS)]
        t_ns, values = _broken(t_ns, values, gaps)
        seconds = t_ns * 1e-9
        above = 2 if curve.faint else 3
        axis.plot(seconds, values, color=colour, linewidth=0.9, label=one_line(curve.label), zorder=above)
        if len(chart.curves) == 1 and len(values) and np.nanmin(values) >= 0.0:
            axis.fill_between(seconds, values, 0.0, color=colour, alpha=0.12, linewidth=0.0, zorder=2)
    axis.set_ylabel(f"{chart.title}\n[{chart.unit}]")
    axis.grid(True, axis="both")
    axis.set_axisbelow(True)
    for side in ("top", "right"):
        axis.spines[side].set_visible(False)
    axis.margins(y=0.08)
    if not chart.speaks:  # rounding must not fill a chart
        axis.set_ylim(-NEGLIGIBLE, NEGLIGIBLE)
    if all(curve.values.min(initial=0.0) >= 0.0 for curve in chart.curves):
        axis.set_ylim(bottom=0.0)
    if len(chart.curves) > 1:
        axis.legend(loc="center left", bbox_to_anchor=(1.005, 0.5), frameon=False, fontsize=8.5, handlelength=1.3)


def _broken(
    t_ns: NDArray[np.int64], values: NDArray[np.float64], gaps: Sequence[tuple[int, int]]
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """A curve that is interrupted where the log cannot be read, rather than drawn straight across."""
    places = np.searchsorted(t_ns, [begin for begin, _ in gaps], side="right")
    within = [(place, gap) for place, gap in zip(places, gaps, strict=True) if 0 < place < len(t_ns)]
    if not within:
        return t_ns, values
    at = [place for place, _ in within]
    return np.insert(t_ns, at, [begin for _, (begin, _) in within]), np.insert(values, at, np.nan)


def _background(axis: Axes, recording: Recording, first_ns: int, last_ns: int) -> None:
    """Bands of the tools, and a line at each warning or error."""
    timeline = recording.timeline
    if len(timeline):
        tools = np.array([modal.tool for modal in timeline.modals])[timeline.modal]
        changes = np.flatnonzero(np.diff(tools, prepend=tools[0] - 1))
        for i, start in enumerate(changes):
            begin = int(timeline.t_ns[start])
            end = int(timeline.t_ns[changes[i + 1]]) if i + 1 < len(changes) else recording.end_ns
            if end > first_ns and begin < last_ns and end > begin:
                left, right = max(begin, first_ns) * 1e-9, min(end, last_ns) * 1e-9
                axis.axvspan(left, right, color=_BANDS[i % 2], linewidth=0.0, zorder=0)
                if right - left > 0.03 * (last_ns - first_ns) * 1e-9:
                    axis.annotate(
                        f"T{tools[start]}",
                        (left, 1.0),
                        xycoords=("data", "axes fraction"),
                        xytext=(3, -3),
                        textcoords="offset points",
                        va="top",
                        fontsize=7.5,
                        color=_MUTED,
                    )
    for begin, end in recording.gaps:
        left, right = max(begin, first_ns) * 1e-9, min(end, last_ns) * 1e-9
        if right > left:
            axis.axvspan(left, right, facecolor="none", edgecolor=_MUTED, hatch="////", linewidth=0.0, zorder=1)
    for event in settled(recording.events):
        if event.severity in _SEVERE and first_ns <= event.t_ns <= last_ns:
            axis.axvline(
                event.t_ns * 1e-9, color=_SEVERE[event.severity], linewidth=1.0, linestyle=(0, (4, 2)), zorder=1
            )


def _line_axis(axis: Axes, recording: Recording, first_ns: int, last_ns: int) -> None:
    """Program lines along the top: each tick where a block begins, as evenly as blocks allow."""
    timeline = recording.timeline
    if not len(timeline):
        return
    top = axis.secondary_xaxis("top")
    ticks, labels, shown = [], [], -1
    files = timeline.files()
    for target in np.linspace(first_ns, last_ns, 16)[:-1]:
        index = int(timeline.at(np.array([round(target)]))[0])
        if index < 0 or index == shown:
            continue
        shown = index
        file = timeline.modals[timeline.modal[index]].file
        name = str(timeline.line[index])
        ticks.append(max(int(timeline.t_ns[index]), first_ns) * 1e-9)
        labels.append(name if not files or file == files[0] or not file else f"{one_line(file)}:{name}")
    kept = [i for i in range(len(ticks)) if not i or ticks[i] - ticks[i - 1] > 0.032 * (last_ns - first_ns) * 1e-9]
    top.set_xticks([ticks[i] for i in kept], [labels[i] for i in kept])
    top.set_xlabel("program line", labelpad=3, color=_MUTED)
    top.spines["top"].set_visible(False)
