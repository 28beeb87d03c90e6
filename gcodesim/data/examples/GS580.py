from typing import ClassVar

from gcodesim.actions import Moment, WordAction


class Height(WordAction):
    kind: ClassVar[str] = "height"

    def act(self, moment: Moment) -> str:
        return f"the tip is at {1000 * moment.X_WT[2, 3]:.1f} mm"
