from typing import ClassVar

from gcodesim.actions import Moment, WordAction, Wrong


class Height(WordAction):
    kind: ClassVar[str] = "height"

    def act(self, moment: Moment) -> str:
        return Wrong("the door of the cell is open")
