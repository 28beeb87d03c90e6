from gcodesim.actions import WordAction, Wrong


class Height(WordAction):
    kind = "height"

    def act(self, moment):
        return Wrong("the door of the cell is open")
