"""M66 that asks a sensor of the cell: where things stand if nothing is run, and what is told of a wait in vain."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from gcodesim.diagnostics import Diagnostic
from gcodesim.executor.device_run import DeviceRun
from gcodesim.executor.halt import RunHalt

if TYPE_CHECKING:
    from gcodesim.canon import Input
    from gcodesim.frames import Array
    from gcodesim.planning import Plan
    from gcodesim.shop import Shop

_SAYS = {"rise": "to rise (L1)", "fall": "to fall (L2)", "high": "to be 1 (L3)", "low": "to be 0 (L4)"}


def standing_still(shop: Shop, plan: Plan, joints: Array, steps: int, step_ns: int) -> RunHalt:
    """The halt after so many steps of a plan that nobody runs: devices as it has switched them, parts at rest."""
    devices = DeviceRun(shop, step_ns * 1e-9)
    devices.follow(shop.channel, plan)

    def going(name: str) -> Callable[[int, int], Array]:
        return lambda first, count: devices.drawn(name, steps - 1 + first, count)

    number = plan.path.state_of(len(plan.path) - 1).tool if len(plan.path) else 0
    return RunHalt(
        joints={shop.name: joints}, tool=int(number), opening=1.0, moving={name: going(name) for name in devices.frames}
    )


def waited_in_vain(question: Input, name: str, where: str, what: str) -> Diagnostic:
    """GS592: the time of an M66 has run out before its sensor answered. `what` is there in the end, by name."""
    body = what.rpartition("/")[2]
    there = (f"`{body}`" if body else "nothing") + f" is {where}"
    return Diagnostic(
        code="GS592",
        span=question.span,
        message=f"M66 waits {question.timeout:g} s for `{name}` {_SAYS[question.wait]} in vain: {there}",
        hint="look at where the sensor stands, at what should come, and at Q; #5399 is -1 then",
        value=question.timeout,
        unit="s",
    )


def not_heard(question: Input, name: str) -> Diagnostic:
    """GS593: a sensor is asked by one of several programs at once."""
    return Diagnostic(
        code="GS593",
        span=question.span,
        message=f"M66 asks `{name}` while other programs run: what they move is taken to stand as it did at the start",
        hint="let programs wait for each other at marks: `m_codes: {M200: {wait: ready}}`",
    )
