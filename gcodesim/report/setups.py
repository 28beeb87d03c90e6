"""The set-ups of a job for the page: what `setups.json` says, and the runs that have logs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from gcodesim.files.output_folder import LOG_NAME, SETUPS_NAME
from gcodesim.frozen import frozen
from gcodesim.numbers import read_json
from gcodesim.playback import Recording, RecordingError
from gcodesim.report.page import SetupRow


@frozen(eq=False)
class StoredSetups:
    """The runs of a job, by the names of their set-ups, and a row for each set-up."""

    recordings: Sequence[Recording]
    names: Sequence[str]
    rows: Sequence[SetupRow]


def stored_setups(folder: Path) -> StoredSetups:
    """What the run of a job left in `folder`. RecordingError if that cannot be read."""
    path = folder / SETUPS_NAME
    try:
        setups = read_json(path.read_bytes())["setups"]
        rows = [_row(str(name), results) for name, results in setups.items()]
    except OSError as error:
        raise RecordingError(f"{path} cannot be read: {error.strerror}") from None
    except (ValueError, LookupError, TypeError, AttributeError):
        raise RecordingError(f"{path} is damaged; run the job again") from None
    names = [row.name for row in rows if (folder / row.name / LOG_NAME).is_file()]
    if not names:
        raise RecordingError(f"no set-up in {folder} has a log")
    return StoredSetups(recordings=[Recording.open(folder / name) for name in names], names=names, rows=rows)


def _row(name: str, results: Mapping[str, Any]) -> SetupRow:
    stocks, target = results["stocks"].values(), results.get("target")
    found = [finding["severity"] for finding in results["findings"]]
    return SetupRow(
        name=name,
        status=str(results["status"]),
        time_s=float(results["time"]["total_s"]),
        removed_mm3=float(sum(stock["removed_mm3"] for stock in stocks)),
        remaining_mm3=float(sum(stock["remaining_mm3"] for stock in stocks)),
        deviation_mm=(target["least_deviation_mm"], target["most_deviation_mm"]) if target else None,
        errors=found.count("error"),
        warnings=found.count("warning"),
    )
