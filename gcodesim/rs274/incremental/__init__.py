"""A program that is read while it is written: after a change only what may differ is read again."""

from gcodesim.rs274.incremental.reading import LineMoment, LiveReading

__all__ = ["LineMoment", "LiveReading"]
