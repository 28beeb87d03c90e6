"""What hits what in the cell of a run: parts, devices and machines beside each other, once all plans are known."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from gcodesim.arithmetic.distinct import distinct
from gcodesim.arithmetic.matrices import multiplied, norms
from gcodesim.cell.device import Device, DeviceHistory
from gcodesim.cell.placement import DEVICE
from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.frames import Array, Pose
from gcodesim.planning.switched import history_of, switches_of
from gcodesim.scene import Body, Stand, Stay
from gcodesim.shop import Shop, side_by_side
from gcodesim.solids import Mesh, Placed, triangles_of
from gcodesim.tools.gripper import Gripper

if TYPE_CHECKING:
    from gcodesim.checks.cell_bodies import CellBody
    from gcodesim.checks.cell_collisions import Running
    from gcodesim.checks.cell_meetings import Docking, Mounted
    from gcodesim.executor.loose_bodies import LooseBody
    from gcodesim.jobs.job import Job
    from gcodesim.planning import Plan

_BLOCK: Final = 50_000  # times whose joints are asked for at once
_JUMP: Final = 1e-6  # [s] that a device without a time of travel takes
_HALVINGS: Final = 60
_TRIM_STEP: Final = 2e-3  # [s] in which the way of a cutter is added up
_TRIM_STEPS: Final = 2000
_LONGEST_TRIM: Final = 120.0  # [s]

_KEYS: Final = {"part": "parts", "device": "devices", "fixture": "fixtures", "stock": "stock"}


def _with_loose(shop: Shop, loose: Sequence[LooseBody]) -> Shop:
    """A shop in whose scene are the pieces that came loose, where they lie."""
    bodies = [Body(name=each.name, solids=(Placed(Mesh(source=each.skin)),), role="loose") for each in loose]
    stands = {each.name: Stand(each.parent, each.X) for each in loose}
    scene = shop.scene.with_frames(stands)
    return replace(shop, scene=replace(scene, bodies=(*scene.bodies, *bodies)))


def _lying(loose: LooseBody, plan: Plan, tick: float) -> Stay:
    """Where a piece lies, and from when on it is in the way of anything; `tick` [s].

    What stands before the very cutter that frees it is still trimmed on the next way of a diameter.
    """
    begin, left = loose.begin * tick, 2.0 * loose.freed.radius
    last = min(plan.trajectory.duration, begin + _LONGEST_TRIM)
    while left > 0.0 and begin < last:
        times = begin + _TRIM_STEP * np.arange(1, _TRIM_STEPS + 1)
        way = np.cumsum(norms(plan.trajectory.sample(np.minimum(times, last)).velocity[:, :3])) * _TRIM_STEP
        at = min(int(np.searchsorted(way, left)), len(times) - 1)
        begin, left = float(times[at]), left - float(way[at])
    return Stay(body=loose.name, parent=loose.parent, X=loose.X, begin=max(begin, loose.end * tick))


def meets_others(shop: Shop, channels: int) -> bool:
    """Whether there is anything in a cell that only `collisions` looks at."""
    cell = shop.cell
    grips = bool(cell.fixtures) and any(isinstance(tool, Gripper) for tool in cell.tools.values())
    things = bool(cell.parts or cell.devices or cell.magazine.stands)
    return things or grips or channels > 1 or len(shop.scene.movers) > 1


def collisions(
    job: Job, stays: Sequence[Stay] | None, end: float | None = None, loose: Sequence[LooseBody] = ()
) -> Iterator[Diagnostic]:
    """Findings about all channels of a run, up to `end` [s].

    `stays` are those of parts, None: they have not moved; `loose` are the pieces of stocks that came loose.
    """
    assert job.shop is not None and job.cell is not None
    if not (loose or meets_others(job.shop, len(job.all))) or any(
        each.plan is None or each.shop is None for each in job.all
    ):
        return
    from gcodesim.checks.cell_bodies import CellBodies, CellTree
    from gcodesim.checks.cell_collisions import CellWords, changes_with_a_part
    from gcodesim.checks.cell_meetings import CellSearch

    shops = side_by_side(job.shop, [each.shop for each in job.others if each.shop is not None])
    plans = [each.plan for each in job.all if each.plan is not None]
    shop, cell = _with_loose(shops[0], loose), shops[0].cell
    running = [_running(own, plan) for own, plan in zip(shops, plans, strict=True)]
    devices = {f"{DEVICE}/{name}": device for name, device in cell.devices.items()}
    histories = {name: _history(name, device, shops, plans) for name, device in devices.items()}
    last = max([plan.trajectory.duration for plan in plans])
    last = last if end is None else min(end, last)
    if last <= 0.0:
        return
    if stays is None:
        stays = [_at_rest(shop, body.name) for body in shop.scene.bodies if body.role == "part"]
    stays = [_gripped(shop, part) for stay in stays for part in _up_to_the_end(stay, devices, histories, shop)]
    mounted = [each for own, plan in zip(shops, plans, strict=True) for each in _mounted(own, plan, last)]
    plan_of = {own.name: plan for own, plan in zip(shops, plans, strict=True)}
    stays += [_lying(each, plan_of[each.mover], cell.simulation.step_ns * 1e-9) for each in loose]
    yield from changes_with_a_part(running, stays, {n: tool.name for n, tool in cell.tools.items()}, last)
    tree = CellTree(shop.scene, devices)
    tools = {
        own.name: [
            (number, tool, _openings(own, tool, stays))
            for number in dict.fromkeys(each.tool for each in mounted if each.mover == own.name)
            if (tool := own.tool(number)) is not None
        ]
        for own in shops
    }
    parked = [(n, tool, shop.stand(n) @ tool.X_FT) for n in cell.magazine.stands if (tool := shop.tool(n)) is not None]
    bodies = CellBodies.of(tree, tools, parked)
    joints = _joints_of(shop, shops, plans, devices, histories)
    times = [0.0, last, *(t for plan in plans for t in plan.trajectory.boundaries(0.0, last))]
    times += [t for history in histories.values() for t in _nodes(history)]
    times += [t for stay in stays for t in (stay.begin, stay.end)] + [
        t for own in mounted for t in (own.begin, own.end)
    ]
    nodes = distinct(np.array([t for t in times if 0.0 <= t <= last]))
    from gcodesim.checks.timed_way import TimedWay

    travel = np.abs(joints(nodes)).max(axis=0)
    places = [(*_carrier(tree, stay), stay) for stay in stays if stay.parent not in tree.part]
    reach = bodies.reach(travel, [(at, stay.body, X @ stay.X) for at, X, stay in places])

    def span_of(body: CellBody) -> Span:
        kind, _, name = body.frame.partition("/")
        return cell.span(_KEYS[kind], name) if kind in _KEYS else Span(cell.name)

    words = CellWords(running, span_of)
    search = CellSearch(
        cell=bodies,
        way=TimedWay.of(joints, nodes, reach),
        stays=stays,
        mounted=mounted,
        grippers={n: getattr(tool, "reach", 0.0) for n, tool in cell.tools.items() if isinstance(tool, Gripper)},
        clearance=cell.limits.clearance,
        dockings=[each for own, plan in zip(shops, plans, strict=True) for each in _dockings(own, plan)],
        apart=cell.limits.apart,
        grain={each.name: each.grain for each in loose},
        keys=words.keys,
    )

    found = search.meetings()
    yield from words.overlaps(search.overlaps)
    yield from words.collisions(found)
    if cell.limits.clearance:
        yield from words.near_misses(search.near_misses(), cell.limits.clearance)


def _running(shop: Shop, plan: Plan) -> Running:
    from gcodesim.checks.cell_collisions import Running

    first = next(iter(shop.cell.channels))
    switched = {
        f"{DEVICE}/{name}": switches_of(device, plan.trajectory.events)
        for name, device in shop.cell.devices.items()
        if (device.channel or first) == shop.channel
    }
    return Running(name=shop.name, plan=plan, X_BM=shop.X_BM, switched=switched)


def _history(name: str, device: Device, shops: Sequence[Shop], plans: Sequence[Plan]) -> DeviceHistory:
    """What a device does in a run; the first channel that is named for it switches it."""
    channel = device.channel or next(iter(shops[0].cell.channels))
    for shop, plan in zip(shops, plans, strict=True):
        if shop.channel == channel:
            return history_of(device, plan.trajectory.events)
    return DeviceHistory(device, [], [])


def _nodes(history: DeviceHistory) -> list[float]:
    """Times [s] at which a device begins to move, or comes to rest."""
    jumps = [] if history.device.travel_time > 0.0 else [time - _JUMP for time in history.times]
    return [*jumps, *history.turns()]


def _at_rest(shop: Shop, frame: str) -> Stay:
    stand = shop.scene.frames[frame]
    return Stay(body=frame, parent=stand.parent, X=stand.X)


def _carrier(tree: Any, stay: Stay) -> tuple[int, Pose]:
    found: tuple[int, Pose] = tree.carrier(stay.parent)
    return found


def _up_to_the_end(
    stay: Stay, devices: Mapping[str, Device], histories: Mapping[str, DeviceHistory], shop: Shop
) -> Iterator[Stay]:
    """A stay on a belt, divided where the part comes to the belt's end and stops there; others as they are.

    `Stay.X` of a part on a belt is seen from the belt at the beginning of the stay.
    """
    device = devices.get(stay.parent)
    if device is None or device.speed <= 0.0:
        yield stay
        return
    history = histories[stay.parent]

    def gone(time: float) -> float:
        return float(history.shifts(np.array([time]))[0, 0])

    start = gone(stay.begin)
    latest = min(stay.end, history.times[-1] + stay.room / device.speed + 1.0)
    if gone(latest) - start <= stay.room:
        yield stay
        return
    low, high = stay.begin, latest
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if gone(middle) - start < stay.room else (low, middle)
    yield replace(stay, end=high)
    shift = np.eye(4)
    shift[0, 3] = start + stay.room
    X_WP = multiplied(shop.scene.at_rest(stay.parent).matrix, shift, stay.X.matrix)
    yield replace(stay, parent="world", X=Pose.from_matrix(X_WP), begin=high)


def _gripped(shop: Shop, stay: Stay) -> Stay:
    """The stay of a part that fingers hold, with how far open these are."""
    name = stay.holder.partition(" ")[2]
    tool = next((tool for tool in shop.cell.tools.values() if tool.name == name), None)
    body = next((body for body in shop.scene.bodies if body.name == stay.body), None)
    if not isinstance(tool, Gripper) or body is None:
        return stay
    X_TP = tool.X_FT.inverse() @ stay.X
    skins = [(placed.X, triangles_of(placed.solid)) for placed in body.solids]
    corners = [X_TP.apply(X.apply(skin.points))[skin.faces] for X, skin in skins]
    contact = tool.contacts(np.concatenate(corners), 1.0)
    return stay if contact is None else replace(stay, opening=round(float(contact[1]), 6))


def _openings(shop: Shop, tool: Any, stays: Sequence[Stay]) -> list[float]:
    """How far open a tool is seen: wide, and as with each part that it holds."""
    if not isinstance(tool, Gripper):
        return [1.0]
    holder = f"{shop.name} {tool.name}"
    return sorted({1.0, *(stay.opening for stay in stays if stay.holder == holder)})


def _mounted(shop: Shop, plan: Plan, last: float) -> list[Mounted]:
    """Which tool the mover of a plan has when."""
    from gcodesim.checks.cell_meetings import Mounted

    path = plan.path
    if not len(path):
        numbers, starts = np.array([path.states[0].tool if path.states else 0]), np.zeros(1)
    else:
        of_row = np.array([state.tool for state in path.states])[path.state]
        rows = np.flatnonzero(np.diff(of_row, prepend=of_row[0] - 1) != 0)
        numbers, starts = of_row[rows], plan.trajectory.row_start[rows].copy()
        starts[0] = 0.0
    ends = np.append(starts[1:], max(last, float(starts[-1])) + 1.0)
    return [
        Mounted(mover=shop.name, tool=int(number), begin=float(begin), end=float(end))
        for number, begin, end in zip(numbers, starts, ends, strict=True)
        if begin < last
    ]


def _dockings(shop: Shop, plan: Plan) -> Iterator[Docking]:
    """When the flange of an arm comes to a tool in its stand, or leaves it there: in the row beside each change."""
    from gcodesim.checks.cell_meetings import Docking

    path, law = plan.path, plan.trajectory
    if not shop.cell.magazine.stands or not len(path):
        return
    of_row = np.array([state.tool for state in path.states])[path.state]
    for row in np.flatnonzero(np.diff(of_row) != 0).tolist():
        before, after = int(of_row[row]), int(of_row[row + 1])
        if after:
            yield Docking(mover=shop.name, tool=after, begin=float(law.row_start[row]), end=float(law.row_end[row]))
        if before:
            begin, end = float(law.row_end[row]), float(law.row_end[row + 1])
            yield Docking(mover=shop.name, tool=before, begin=begin, end=end)


def _joints_of(
    shop: Shop,
    shops: Sequence[Shop],
    plans: Sequence[Plan],
    devices: Mapping[str, Device],
    histories: Mapping[str, DeviceHistory],
) -> Callable[[Array], Array]:
    """The joints of `CellTree`, those of parts left out, at times (n,) [s]."""
    by_name = {own.name: plan for own, plan in zip(shops, plans, strict=True)}

    def block(times: Array) -> Array:
        columns = []
        for name, mover in shop.scene.movers.items():
            plan = by_name.get(name)
            if plan is None:
                columns.append(np.tile(mover.home, (len(times), 1)))
            else:
                at = np.clip(times, 0.0, plan.trajectory.duration)
                columns.append(plan.joints(plan.trajectory.sample(at)))
        for name, device in devices.items():
            columns.append(_way_of(device, histories[name], times)[:, None])
        return np.hstack(columns) if columns else np.zeros((len(times), 0))

    def joints(times: Array) -> Array:
        blocks = [block(times[i : i + _BLOCK]) for i in range(0, len(times), _BLOCK)]
        return np.concatenate(blocks) if blocks else np.zeros((0, 0))

    return joints


def _way_of(device: Device, history: DeviceHistory, times: Array) -> Array:
    """How far (n,) [m] a device, or its belt, has gone along its direction; what jumps, in a moment before it."""
    nodes = distinct(np.array(_nodes(history)))
    if device.speed > 0.0:
        nodes = np.append(nodes, max(float(times.max(initial=0.0)), float(nodes[-1])) + 1.0)
        shifts = history.shifts(nodes)[:, 0]
    else:
        far = float(np.sqrt(np.sum(np.square(device.travel))))
        shifts = far * np.array([history.share(float(t)) for t in nodes])
    way: Array = np.interp(times, nodes, shifts)
    return way
