"""Results of a process, one after the other."""

import numpy as np

from gcodesim.processes.window import ProcessStep


def test_a_part_in_which_nothing_happened_keeps_the_kinds_of_columns():
    """A beam that is off gives no columns; the next part says whether it is on."""
    lit = ProcessStep.free(2, {"beam": np.array([True, False]), "dose": np.array([0.5, 0.0])})

    both = ProcessStep.joined([ProcessStep.free(3), lit])

    assert both["beam"].dtype == bool
    assert both["beam"].tolist() == [False, False, False, True, False]
    assert both["dose"].tolist() == [0.0, 0.0, 0.0, 0.5, 0.0]
