"""Canonical events: what a program asks a machine to do, free of language and of machine."""

from gcodesim.canon.events import *  # noqa: F403
from gcodesim.canon.events import __all__ as __all__
