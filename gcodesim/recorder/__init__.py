"""What a run shows: steps and stock on one side, columns and scenes of the log on the other."""

from gcodesim.recorder.recorder import Recorder

__all__ = ["Recorder"]
