"""Actions: Python that runs at an M-code of the program; `ACTIONS[kind]` is the class. None ship."""

from gcodesim.actions.action import Moment, WordAction, Wrong
from gcodesim.family import Family

ACTIONS = Family("actions", of="gcodesim.actions.action:WordAction", called="kind")

__all__ = ["ACTIONS", "Moment", "WordAction", "Wrong"]
