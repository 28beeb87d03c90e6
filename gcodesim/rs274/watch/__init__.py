"""What a control accepts but a machinist would not: warnings about a program, each rule in a file of its own."""

from gcodesim.rs274.watch.watches import Watches

__all__ = ["Watches"]
