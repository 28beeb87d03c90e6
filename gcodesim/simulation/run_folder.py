"""The folder of a run: what stands in it, what is written there, and what must not be touched."""

from __future__ import annotations

from pathlib import Path

from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.files.output_folder import CELL_NAME, RESULTS_NAME, forget, names_of, other_cell, overwriting
from gcodesim.files.whole_file import write_whole
from gcodesim.jobs.coating import film_names
from gcodesim.jobs.job import Job
from gcodesim.jobs.results import Results
from gcodesim.processes import PROCESSES
from gcodesim.shop import Shop


class RunFolder:
    """The folder `path` into which a run of a job writes; it is the caller's alone by `claimed`."""

    def __init__(self, job: Job, path: Path) -> None:
        self.job, self.path = job, path

    def losses(self) -> list[Diagnostic]:
        """GS750: what would be lost there, if the job may not `force` it."""
        if self.job.options.force:
            return []
        span = Span(self.job.program.name)
        lost = overwriting(self.path, _names(self.job.shop, self.path), _inputs(self.job), span)
        if self.job.loaded.made:
            lost += other_cell(self.path, self._made_cell(), span)
        return lost

    def keep_made_cell(self) -> None:
        """Write a cell that was made for this run, if it was."""
        if self.job.loaded.made:
            write_whole(self.path / CELL_NAME, self._made_cell())

    def forget(self) -> None:
        """Delete what an earlier run has left, so that nothing old stands beside the results of one that fails."""
        forget(self.path, _names(self.job.shop, self.path))

    def keep_results(self, results: Results) -> None:
        """Write results and nothing else: those of a job that did not run."""
        self.forget()
        write_whole(self.path / RESULTS_NAME, results.text().encode())

    def _made_cell(self) -> bytes:
        return self.job.loaded.sources[self.job.loaded.files[0].name].raw


def _names(shop: Shop | None, out: Path) -> list[str]:
    """The files that a run in this shop writes into `out`, and those that its sensors have left there."""
    if shop is None:
        return names_of(())
    from gcodesim.observation.files import names_left
    from gcodesim.observation.schedule import stations_of

    kinds = [kind for kind in shop.sheet.kinds[1:] if getattr(PROCESSES[kind], "dose", "")]
    doses = {name: [PROCESSES[kind].dose for kind in kinds] for name in shop.cell.stocks}
    painted = shop.cell.stocks if shop.cell.target is not None else ()
    own = names_of(shop.cell.stocks, film_names(shop.cell.coats), doses, painted)
    return [*own, *names_left(out, stations_of(shop.cell))]


def _inputs(job: Job) -> list[Path]:
    """All inputs of a job that were read from files."""
    read = [source.folder / source.name for source in job.sources.values() if source.folder is not None]
    return [*read, *(file.path for file in job.loaded.files)]
