"""What a page needs to replay a run in three dimensions: bodies, motion, path, and the part as it changes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.distinct import distinct
from gcodesim.arithmetic.matrices import dots, inverse_pose, multiplied
from gcodesim.files.output_folder import SKIN_SUFFIX
from gcodesim.frames import quaternion_from_rotation
from gcodesim.log import DrawnMesh, DrawnShape
from gcodesim.playback import Drawing, RecordedFrames, Recording
from gcodesim.playback.columns import peak_of
from gcodesim.playback.quantities import NEGLIGIBLE
from gcodesim.report.motion import key_moments
from gcodesim.report.pack import Pack
from gcodesim.solids import Box, Cone, Cylinder, Sphere
from gcodesim.units import DEG, MM, MM_PER_MINUTE, UM

if TYPE_CHECKING:
    from gcodesim.material.skin import PaintedSkin

Array = NDArray[np.float64]

TICK_NS: Final = 100_000
"""Times of a page are whole numbers of 0.1 ms: 32 bits hold five days."""

FINEST_NS: Final = 2_000_000
"""A replay looks at the log no more often than this; charts look at every sample."""

TILE_BYTES: Final = 60_000_000
"""Log bytes of stock that a page takes at most; about a tenth of them remains in the page."""

_TIP_TOLERANCE: Final = 1.0 / 10_000.0  # of the extent of the work: less than a pixel
_LEAST_TOLERANCE: Final = 2e-6  # [m]
_TURN_TOLERANCE: Final = 0.05 * DEG
RAPID, FEED, CUT = 0, 1, 2

COLOURS: Final = (
    ("feed", "mm/min", "/motion", "feed_m_s", MM_PER_MINUTE),
    ("force", "N", "/process", "force_n", 1.0),
    ("deviation", "µm", "/motion", "position_error_m", UM),
)
"""What the path can be coloured by: name, unit, where it is in the log, SI in one unit."""


def ticks(t_ns: NDArray[np.int64] | Sequence[int]) -> NDArray[np.int64]:
    """Times [ns] in the unit of a page, rounded."""
    return (np.asarray(t_ns, dtype=np.int64) + TICK_NS // 2) // TICK_NS


def replay_of(recording: Recording, pack: Pack) -> dict[str, Any]:
    """Moments, frames, bodies, tools, path, force and stock of a run; arrays go into `pack`."""
    every_ns = _thinning(recording)
    tree = recording.frames(every_ns)
    cell = [drawing for _, content in recording.drawings("/scene/cell") for drawing in content]
    tools = recording.tools()
    stock = _stock_frames(tree)
    home = stock[0] if stock else "world"
    t_ns = tree.t_ns
    if not len(t_ns):
        t_ns = np.zeros(1, dtype=np.int64)
    X_WT, X_WS = tree.in_world("tcp"), tree.in_world(home)
    track = _seen_from(X_WS, X_WT)[:, :3, 3]
    track = np.broadcast_to(track, (len(t_ns), 3))
    kind = _kinds(recording, t_ns, every_ns)
    kept = key_moments(*_signals(recording, track, kind, every_ns), np.flatnonzero(np.diff(kind)) + 1)
    used = sorted({d.frame for d in cell} | {d.frame for _, content in tools for d in content} | set(stock))
    return {
        "times": pack.integers(ticks(t_ns[kept])),
        "frames": {name: _frame(tree, name, kept, pack) for name in used if name != "world"},
        "cell": [_entity(drawing, pack) for drawing in cell],
        "tools": [
            {"t": int(ticks([time])[0]), "shapes": [_entity(drawing, pack) for drawing in content]}
            for time, content in tools
        ],
        "track": {"frame": home, "points": pack.numbers(track[kept]), "kind": pack.integers(kind[kept])},
        "force": pack.numbers(_force(recording, t_ns[kept], every_ns)),
        "colours": _colours(recording, t_ns[kept], pack),
        "tip": pack.numbers(np.broadcast_to(X_WT[:, :3, 3], (len(t_ns), 3))[kept]),
        "work": pack.integers(np.rint(_work(recording, t_ns[kept], every_ns) / UM).astype(np.int64)),
        "stock": _stock(recording, pack),
        "skins": [_skin(name, frame, skin, pack) for name, frame, skin in _skins(recording)],
    }


def _thinning(recording: Recording) -> int:
    """Time between two looks at the periodic topics [ns], 0 for every sample."""
    period = recording.period_ns
    if not period or period >= FINEST_NS:
        return 0
    return -(-FINEST_NS // period) * period


def _stock_frames(tree: RecordedFrames) -> list[str]:
    return [name for name in tree.poses if name == "stock" or name.startswith("stock/")]


def _seen_from(X_WA: Array, X_WB: Array) -> Array:
    """X_AB of two stacks of poses (n or 1, 4, 4)."""
    return multiplied(inverse_pose(X_WA), X_WB)


def _signals(recording: Recording, track: Array, kind: NDArray[np.int64], every_ns: int) -> tuple[Array, Array]:
    """What has to be right between the kept moments, and how exactly: the path of the tip and the joints."""
    work = track[kind != RAPID] if (kind != RAPID).any() else track
    extent = float(np.ptp(work, axis=0).max(initial=0.0))
    length = max(extent * _TIP_TOLERANCE, _LEAST_TOLERANCE)
    slides = {joint["name"] for joint in recording.results.get("joints", ()) if joint["unit"] == "mm"}
    tolerance = [length] * 3
    columns = [track]
    for series in recording.joints(every_ns):
        names = [name for name in series.names if name.endswith("].position")]
        if len(series.t_ns) != len(track):
            continue
        columns.append(series.columns(*names) if names else np.zeros((len(track), 0)))
        tolerance += [
            length if name[len("joints[") : -len("].position")] in slides else _TURN_TOLERANCE for name in names
        ]
    return np.concatenate(columns, axis=1), np.array(tolerance)


def _kinds(recording: Recording, t_ns: NDArray[np.int64], every_ns: int) -> NDArray[np.int64]:
    """What the tool does at each instant (n,): rapid, feed, or feed in material."""
    timeline = recording.timeline
    kind = np.full(len(t_ns), FEED, dtype=np.int64)
    if len(timeline):
        fast = np.array([modal.motion in ("", "G0", "G28", "G30") for modal in timeline.modals])
        block = timeline.at(t_ns - 1)  # a sample is the end of the steps that led to it
        kind[(block >= 0) & fast[timeline.modal[block]]] = RAPID
    process = recording.series("/process", every_ns)
    if "engaged" in process.names and len(process.t_ns) == len(t_ns):
        kind[process.column("engaged") > 0.0] = CUT
    return kind


def _colours(recording: Recording, t_ns: NDArray[np.int64], pack: Pack) -> list[dict[str, Any]]:
    """Figures by which the path can be coloured, for each kept moment the greatest since the one before.

    A figure that is the same everywhere is left out: how far the tip is from its command, where a run has no such.
    """
    found = []
    for name, unit, topic, field, divisor in COLOURS:
        series = recording.series(topic)
        field = peak_of(series, field)
        if field not in series.names or not len(series.t_ns):
            continue
        last = np.clip(np.searchsorted(series.t_ns, t_ns, side="right"), 1, len(series.t_ns))
        first = np.minimum(np.concatenate([[0], last[:-1]]), last - 1)
        values = np.array([series.column(field)[a:b].max() for a, b in zip(first.tolist(), last.tolist(), strict=True)])
        if np.ptp(values) > NEGLIGIBLE * divisor:
            found.append({"name": name, "unit": unit, "values": pack.numbers(values / divisor)})
    return found


def _force(recording: Recording, t_ns: NDArray[np.int64], every_ns: int) -> Array:
    """Force on the tool (n, 3) in the world [N]."""
    series = recording.series("/wrench", every_ns)
    return _at(series.t_ns, series.columns("force.x", "force.y", "force.z"), t_ns)


def _work(recording: Recording, t_ns: NDArray[np.int64], every_ns: int) -> Array:
    """The tip (n, 3) in the current work coordinates [m]."""
    series = recording.series("/motion", every_ns)
    return _at(series.t_ns, series.columns("x_m", "y_m", "z_m"), t_ns)


def _at(known: NDArray[np.int64], values: Array, t_ns: NDArray[np.int64]) -> Array:
    if not len(known):
        return np.zeros((len(t_ns), values.shape[1]))
    return values[np.clip(np.searchsorted(known, t_ns, side="right") - 1, 0, len(known) - 1)]


def _frame(tree: RecordedFrames, name: str, kept: NDArray[np.int64], pack: Pack) -> dict[str, Any]:
    """Poses in the world: one when the frame stands still, else one for each kept moment."""
    X = tree.in_world(name)
    still = len(X) == 1 or bool(np.array_equal(X, np.broadcast_to(X[:1], X.shape)))
    X = X[:1] if still else X[kept]
    if still:
        return {"p": X[0, :3, 3].tolist(), "q": quaternion_from_rotation(X[0, :3, :3]).tolist()}
    q = quaternion_from_rotation(X[:, :3, :3])
    # neighbours on the same side of the sphere, so that a page may blend them
    flips = np.cumprod(np.where(dots(q[1:], q[:-1]) < 0.0, -1.0, 1.0))
    q[1:] *= flips[:, None]
    return {"positions": pack.numbers(X[:, :3, 3]), "quaternions": pack.numbers(q)}


def _entity(drawing: Drawing, pack: Pack) -> dict[str, Any]:
    shapes = [_shape(shape, pack) for shape in drawing.shapes]
    return {"id": drawing.id, "frame": drawing.frame, "shapes": shapes}


def _shape(shape: DrawnShape, pack: Pack) -> dict[str, Any]:
    place = {"p": shape.p.tolist(), "q": shape.q.tolist(), "color": list(shape.color)}
    if isinstance(shape, DrawnMesh):
        points, triangles = pack.numbers(shape.points), pack.integers(shape.triangles)
        return {"kind": "mesh", "points": points, "triangles": triangles, **place}
    match shape.solid:
        case Box(size=size):
            return {"kind": "box", "size": list(size), **place}
        case Cylinder(radius=radius, length=length):
            return {"kind": "cone", "top": radius, "bottom": radius, "length": length, **place}
        case Cone(bottom_radius=bottom, top_radius=top, length=length):
            return {"kind": "cone", "top": top, "bottom": bottom, "length": length, **place}
        case Sphere(radius=radius):
            return {"kind": "sphere", "radius": radius, **place}


# ---- stock


def _stock(recording: Recording, pack: Pack) -> dict[str, Any]:
    """Tiles: for each a list of states with the time from which they are shown."""
    times = recording.tile_times()
    shown = chosen_states(times)
    corners = np.array([np.full(3, np.inf), np.full(3, -np.inf)])
    tiles: dict[str, list[dict[str, Any]]] = {topic: [] for topic in times}
    wanted = {topic: list(states.values()) for topic, states in shown.items()}
    begin = {(topic, sent): moment for topic, states in shown.items() for moment, sent in states.items()}
    for t_ns, topic, content in recording.tiles(wanted):
        parts = []
        for drawing in content:
            for shape in drawing.shapes:
                if isinstance(shape, DrawnMesh) and len(shape.triangles):
                    corners[0] = np.minimum(corners[0], shape.points.min(axis=0))
                    corners[1] = np.maximum(corners[1], shape.points.max(axis=0))
                    parts.append({"frame": drawing.frame, **_tile(shape, pack)})
        state = {"t": int(ticks([begin[topic, t_ns]])[0]), "parts": parts}
        if tiles[topic] and tiles[topic][-1]["t"] == state["t"]:  # sent twice at the same time: the last one counts
            tiles[topic].pop()
        tiles[topic].append(state)
    found = bool(np.isfinite(corners).all())
    return {"corners": corners.tolist() if found else None, "tiles": [states for states in tiles.values() if states]}


def _tile(mesh: DrawnMesh, pack: Pack) -> dict[str, Any]:
    used = np.zeros(len(mesh.points), dtype=bool)
    used[mesh.triangles] = True
    points, triangles, _ = _in_order(mesh.points[used], (np.cumsum(used) - 1)[mesh.triangles])
    return {"color": list(mesh.color), "points": pack.numbers(points), "triangles": pack.integers(triangles)}


def _in_order(points: Array, triangles: NDArray[np.int64]) -> tuple[Array, NDArray[np.int64], NDArray[np.intp]]:
    """Points, triangles (t, 3), and which of the given ones each is, in an order that packs well."""
    # triangles in the order of their points, each beginning at its first, so that differences are small
    turn = triangles.argmin(axis=1)
    triangles = triangles[np.arange(len(triangles))[:, None], (turn[:, None] + np.arange(3)) % 3]
    n = len(points)  # three numbers below n as one, which sorts like the three
    order = np.argsort((triangles[:, 0] * n + triangles[:, 1]) * n + triangles[:, 2], kind="stable")
    return points, triangles[order], order


def _skins(recording: Recording) -> Iterator[tuple[str, str, PaintedSkin]]:
    """Painted skins beside the log, each with the name of its stock and the frame in which it stands."""
    from gcodesim.material.skin_file import SkinFileError, read_skin

    if recording.folder is None:
        return
    for k, name in enumerate(recording.results.get("stocks", {})):
        file = recording.folder / f"{Path(name).name}{SKIN_SUFFIX}"
        try:
            yield name, "stock" if k == 0 else f"stock/{name}", read_skin(file.read_bytes(), file.name)
        except (OSError, SkinFileError):  # the page is about the log; what stands beside it may be missing
            continue


def _skin(name: str, frame: str, skin: PaintedSkin, pack: Pack) -> dict[str, Any]:
    points, triangles, order = _in_order(skin.vertices, skin.faces.astype(np.int64))
    # steps as fine as a viewer can tell apart: a twentieth of the tolerance, within some tolerances
    step = skin.tolerance / 20.0
    most = 32_000
    return {
        "name": name,
        "frame": frame,
        "points": pack.numbers(points),
        "triangles": pack.integers(triangles),
        "deviation": pack.integers(np.clip(np.rint(skin.deviation[order] / step), -most, most).astype(np.int64)),
        "step_mm": step / MM,
        "tolerance_mm": skin.tolerance / MM,
        "maker": pack.integers(skin.maker[order].astype(np.int64)),
        "makers": [[maker.file, maker.line, maker.tool] for maker in skin.makers],
        "spots": skin.spots.tolist(),
    }


def chosen_states(
    times: Mapping[str, Sequence[tuple[int, int]]], most_bytes: int = TILE_BYTES
) -> dict[str, dict[int, int]]:
    """For each tile the times [ns] from which a state is shown, and when that state was sent.

    All states, if together they are not too large. Otherwise the stock is shown as
    it was at as many moments as fit, spread evenly over its changes, the first
    and the last among them; every tile shows its state of such a moment, so
    that neighbours go together.
    """
    total = sum(size for states in times.values() for _, size in states)
    if total <= most_bytes:
        return {topic: {t: t for t, _ in states} for topic, states in times.items()}
    moments = sorted({t for states in times.values() for t, _ in states})
    count = len(moments)
    while True:
        count = max(int(count * min(0.9, most_bytes / total)), 2)
        at = [moments[i] for i in distinct(np.linspace(0, len(moments) - 1, count).round().astype(int))]
        chosen: dict[str, dict[int, int]] = {}
        total = 0
        for topic, states in times.items():
            chosen[topic] = {}
            sent = [t for t, _ in states]
            before = -1
            for moment in at:
                index = int(np.searchsorted(sent, moment, side="right")) - 1
                if index > before:
                    chosen[topic][moment] = sent[index]
                    total += states[index][1]
                    before = index
        if total <= most_bytes or count == 2:
            return chosen
