"""What a run was made from, planned again: the very path that was checked, at every point instead of every sample."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from gcodesim.cell.cell import MAIN
from gcodesim.cell.loader import load_cell, read_cell
from gcodesim.diagnostics import Diagnostic, SourceText
from gcodesim.files.whole_file import write_whole
from gcodesim.jobs.job import Job, Options
from gcodesim.simulation import prepare

if TYPE_CHECKING:
    from gcodesim.cell import LoadedCell
    from gcodesim.playback import Recording
    from gcodesim.rs274 import Settings

_OTHER_FILES: Final = ("layout.json", "results.json", "cell.yaml", "program.nc")
_MOST_LOOKS: Final = 400  # samples of the log that are compared with the plan
_SAME: Final = 1e-9  # [rad, m] that count as equal


class OtherInputsError(ValueError):
    """What is here is not what the run was made from; the text says why."""


def job_of(
    recording: Recording,
    cell: Path | None,
    scratch: Path,
    *,
    allow_paths: Sequence[Path] = (),
    allow_code: bool = False,
    settings: Callable[[Settings], Settings] = lambda settings: settings,
) -> Job:
    """The job of a run, read and planned again from what its log carries.

    A cell that names further files is taken from `cell`; it has to be the one of the run. Subprograms of the log are
    put into the folder `scratch`. OtherInputsError where this is another job than that of the run.
    """
    raw = recording.log.attached("program.nc")
    if raw is None:
        raise OtherInputsError("the log does not carry its program")
    program = SourceText(recording.name, raw)
    loaded = _cell_of(recording, cell, scratch, allow_paths, allow_code)
    for name in recording.log.attachments:
        if name not in _OTHER_FILES and not name.endswith(".urdf") and Path(name).name == name:
            text = recording.log.attached(name)
            if text is not None:
                write_whole(scratch / name, text)

    def with_subprograms(own: Settings) -> Settings:
        return settings(replace(own, subroutines=(*own.subroutines, scratch)))

    channels = {}
    for name, channel in recording.results.get("channels", {}).items():
        text = recording.log.attached(channel["program"]["name"])
        if name != MAIN and text is not None:
            channels[name] = SourceText(channel["program"]["name"], text)
    job = prepare(program, loaded, Options(settings=with_subprograms, channels=channels))
    for one in job.all:
        _compare(recording, one, "/motion" if one is job else f"/{one.channel}/motion")
    return job


def _cell_of(
    recording: Recording, cell: Path | None, scratch: Path, allow_paths: Sequence[Path], allow_code: bool
) -> LoadedCell:
    raw, name = recording.log.attached("cell.yaml"), recording.run.get("cell", "cell.yaml")
    if cell is not None:
        loaded = load_cell(cell, allow_paths, allow_code=allow_code)
        if raw is not None and SourceText.read(cell).raw != raw:
            raise OtherInputsError(f"{cell} is not the cell of this run; it has changed since")
    elif raw is None:
        raise OtherInputsError("the log does not carry its cell: name it by --cell")
    else:
        loaded = read_cell(SourceText(name, raw), scratch / name, allow_paths, allow_code=allow_code)
    if loaded.cell is None:
        first: Diagnostic = next(finding for finding in loaded.findings if finding.level.word == "error")
        further = "" if cell is not None else "; if it names further files, say where it is: --cell CELL"
        raise OtherInputsError(f"the cell cannot be read here: {first.message}{further}")
    return loaded


def _compare(recording: Recording, job: Job, topic: str) -> None:
    """The plan against where the log says that each joint was told to be."""
    if job.plan is None or job.shop is None:
        raise OtherInputsError("the program cannot be planned as in the run")
    if job.legs is not None and not job.legs.ended:
        return  # it is refused for what it asks the run
    motion = recording.series(topic)
    names = [f"joints[{name}].command" for name in job.shop.joint_names]
    if not len(motion.t_ns) or not set(names) <= set(motion.names):
        raise OtherInputsError("the log does not say where the joints were told to be")
    last = max(len(motion.t_ns) - 2, 0)  # the sample at the end may repeat the one before
    looks = np.unique(np.linspace(0, last, _MOST_LOOKS).astype(np.int64))
    told = motion.columns(*names)[looks]
    planned = job.plan.joints(job.plan.trajectory.sample(np.asarray(motion.t_ns[looks] * 1e-9, dtype=np.float64)))
    off = np.abs(told - planned).max(axis=1)
    if off.max() > _SAME:
        when = float(motion.t_ns[looks[int(off.argmax())]]) * 1e-9
        raise OtherInputsError(
            f"at {when:.3f} s the run was elsewhere than this cell and program say; run it again with this version"
        )
