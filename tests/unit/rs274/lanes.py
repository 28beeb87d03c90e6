"""A program read by each lane."""

from pathlib import Path

from gcodesim.canon.batch import MoveBatch
from gcodesim.diagnostics import SourceText
from gcodesim.rs274 import Settings, ToolTable, interpret

CORPUS = Path(__file__).parents[2] / "data" / "conformance" / "rs274"
TOOLS, _ = ToolTable.read(SourceText.read(CORPUS / "tools.tbl"))


def run_of(text, **settings):
    """A run of a program with the corpus' tools and subroutines."""
    source = SourceText("p.ngc", text if isinstance(text, bytes) else text.encode())
    return interpret(source, Settings(tool_table=TOOLS, subroutines=(CORPUS / "subs",), **settings))


def both(text, **settings):
    """What each lane makes of a program: events, findings, what else a run tells; and the compiled lane's stream."""
    said = []
    for lane in ("grammar", "compiled"):
        run = run_of(text, lane=lane, **settings)
        stream = list(run.stream())
        events = [event for item in stream for event in (item.events() if isinstance(item, MoveBatch) else [item])]
        said.append(
            (
                [repr(event) for event in events],
                [repr(finding) for finding in run.findings],
                (run.failed, run.failed_line, run.blocks, run.parameters, run.not_simulated),
            )
        )
    return said[0], said[1], stream


def assert_same(text, **settings):
    grammar, compiled, stream = both(text, **settings)
    for slow, fast in zip(grammar, compiled, strict=True):
        assert fast == slow, text if len(text) < 3000 else ""
    return stream


def moves_in_batches(stream):
    return sum(len(item) for item in stream if isinstance(item, MoveBatch))


def mutated(rng, text):
    chars = list(text)
    for _ in range(rng.randint(1, 4)):
        at = rng.randrange(len(chars))
        what = rng.random()
        if what < 0.4:
            chars[at] = rng.choice("XYZGFIJKR0123456789.-+ ()[];#\n\t/%äN")
        elif what < 0.7:
            del chars[at]
        else:
            chars.insert(at, rng.choice("XYZGFIJKRMN0123456789.-+ (),;#\n"))
    return "".join(chars)
