"""A finished run read back: what the program did, where everything was and what it looked like at any moment."""

from gcodesim.playback.frames import RecordedFrames
from gcodesim.playback.recording import Recording, RecordingError
from gcodesim.playback.scenes import Drawing, Lines, drawing_of
from gcodesim.playback.timeline import Timeline

__all__ = ["Drawing", "Lines", "RecordedFrames", "Recording", "RecordingError", "Timeline", "drawing_of"]
