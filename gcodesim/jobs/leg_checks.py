"""What is checked of each leg of a machine once it is planned: what it hits on the way, and what it cannot do."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import TYPE_CHECKING

from gcodesim.checks.idle import blind_axis_findings
from gcodesim.checks.machine_collisions import STOCK_HIT
from gcodesim.checks.speed import speed_findings
from gcodesim.diagnostics import Diagnostic
from gcodesim.processes import PROCESSES
from gcodesim.shop import Shop
from gcodesim.tools.gripper import Gripper

if TYPE_CHECKING:
    from gcodesim.checks.machine_collisions import MachineChecks
    from gcodesim.checks.stock_watch import StockWatch
    from gcodesim.jobs.job import Job
    from gcodesim.planning import Plan


class LegChecks:
    """Checks the legs of one machine one after the other, of a program as of a session."""

    def __init__(self, shop: Shop) -> None:
        self._shop = shop
        self._watched: frozenset[str] = frozenset()  # stocks that are looked at while they are cut

    def hits(self, plan: Plan) -> Iterator[Diagnostic]:
        """What is wrong with the plan of a leg; times are its own."""
        shop = self._shop
        yield from blind_axis_findings(plan.path, shop.mover)
        yield from speed_findings(plan, shop.cell.limits.spindle_speed)
        if shop.cell.fixtures:
            from gcodesim.checks.clearance import clearance_findings, standing_bodies

            beside = self.of_machine.fixtures_beside(plan)
            standing = [some.only(beside) for some in standing_bodies(shop.scene, shop.name)]
            tools = {number: tool for number, tool in shop.cell.tools.items() if not isinstance(tool, Gripper)}
            hits = clearance_findings(plan, tools, standing, X_BM=shop.X_BM)
            apart = shop.cell.limits.apart
            yield from (hit for hit in hits if frozenset(hit.bodies) not in apart)
        yield from (hit for hit in self.of_machine.findings(plan) if not self._is_watched(hit))

    def watch(self, job: Job, shop: Shop) -> StockWatch | None:
        """Who looks in the run of `job` at what the machine does to the stocks of `shop` as they then are.

        Findings about stocks as they are at the start are withdrawn. None where there is nothing to look at.
        """
        from gcodesim.checks.stock_watch import StockWatch, WatchedStock

        lays = any(PROCESSES[kind].lays for tool in shop.cell.tools.values() for kind in tool.processes)
        found = [
            WatchedStock.of(shop.scene, shop.name, name, placed.frame, placed.stock, grows=lays)
            for name, placed in shop.stocks.items()
            if not placed.revolved
        ]
        stocks = [stock for stock in found if stock is not None]
        if not stocks or job.plan is None:
            return None
        self._watched = frozenset(stock.name for stock in stocks)
        job.findings.withdraw([finding for finding in job.findings if self._is_watched(finding)])
        return StockWatch(self.of_machine, stocks, job.plan)

    @cached_property
    def of_machine(self) -> MachineChecks:
        """The links of the machine, its tools, and what it carries."""
        from gcodesim.checks.machine_bodies import MachineBodies
        from gcodesim.checks.machine_collisions import MachineChecks

        shop = self._shop
        machine = MachineBodies.of(shop.scene, shop.name)
        limits = shop.cell.limits
        return MachineChecks(machine, shop.cell.tools, shop.X_BM, limits.clearance, apart=limits.apart)

    def _is_watched(self, hit: Diagnostic) -> bool:
        """Whether a finding is about a stock as it is at the start, while a run looks at it as it then is.

        What says that an arm could not avoid it stays.
        """
        return hit.code == STOCK_HIT and hit.related is None and not self._watched.isdisjoint(hit.bodies)
