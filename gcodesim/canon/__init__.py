"""Canonical events: what a program asks a machine to do, free of language and of machine."""

from gcodesim.canon import events
from gcodesim.canon.answers import Answer, Heard, Noticed, Pause, ToolAwaited, ToolReturned, Touched, Trip, Waited
from gcodesim.canon.events import *  # noqa: F403

__all__ = ["Answer", "Heard", "Noticed", "Pause", "ToolAwaited", "ToolReturned", "Touched", "Trip", "Waited"]
__all__ += events.__all__
