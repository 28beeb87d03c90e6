from typing import ClassVar

from gcodesim.actions import Moment, WordAction, Wrong


class Doorman(WordAction):
    kind: ClassVar[str] = "doorman"

    def act(self, moment: Moment) -> str:
        return Wrong("the door of the cell is open")
