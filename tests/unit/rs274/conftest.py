"""Helpers: run a few lines and look at the events or the findings."""

import pytest

from gcodesim.canon.listing import as_json
from gcodesim.diagnostics import Severity, SourceText
from gcodesim.rs274 import Settings, ToolEntry, ToolTable, interpret

TOOLS = ToolTable(
    {
        1: ToolEntry(number=1, pocket=1, offset=(0, 0, 0.05, 0, 0, 0, 0, 0, 0), diameter=6e-3),
        2: ToolEntry(number=2, pocket=2, offset=(0, 0, 0.0625, 0, 0, 0, 0, 0, 0), diameter=10e-3),
    }
)


def run_of(text, **settings):
    source = SourceText("p.ngc", text if isinstance(text, bytes) else text.encode())
    return interpret(source, Settings(**{"tool_table": TOOLS, **settings}))


@pytest.fixture
def program():
    """The run of a program, executed; its events are in `run.events` as printed."""

    class Done:
        def __init__(self, text, **settings):
            self.run = run_of(text, **settings)
            self.raw = list(self.run)
            self.events = [as_json(event) for event in self.raw]
            self.findings = list(self.run.findings)
            self.errors = [f for f in self.findings if f.level is Severity.ERROR]

        def acts(self, *kinds):
            return [event for event in self.events if event["kind"] in kinds]

        @property
        def ends(self):
            """X Y Z of every move."""
            return [event["end"][:3] for event in self.events if "end" in event]

    return Done
