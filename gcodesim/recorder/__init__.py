"""From a run to its log: steps and stock go in, columns and scenes of the log come out.

`Recorder` is imported on first use: a run without a log writes its other files without what the log needs.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from gcodesim.recorder.recorder import Recorder

__all__ = ["Recorder"]


def __getattr__(name: str) -> Any:
    if name != "Recorder":
        raise AttributeError(name)
    from gcodesim.recorder.recorder import Recorder

    return Recorder
