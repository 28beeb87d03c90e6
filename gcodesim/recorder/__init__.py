"""From a run to its log: steps and stock go in, columns and scenes of the log come out."""

from gcodesim.recorder.recorder import Recorder

__all__ = ["Recorder"]
