from gcodesim.actions import WordAction


class Height(WordAction):
    kind = "height"

    def act(self, moment):
        return f"the tip is at {1000 * moment.X_WT[2, 3]:.1f} mm"
