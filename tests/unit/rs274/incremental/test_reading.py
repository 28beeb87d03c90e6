"""A program under changes: what is read again, and that it comes to the same."""

import random
from dataclasses import replace
from pathlib import Path

import pytest

from gcodesim.diagnostics import SourceText
from gcodesim.rs274 import Settings, lint
from gcodesim.rs274.assumed import assumed_tools
from gcodesim.rs274.incremental import LiveReading
from gcodesim.rs274.program_file import _o_word
from gcodesim.rs274.skipped import _defect_of

TESTS = Path(__file__).parents[3]
HEAD = ["G21 G90 G17", "T1 M6", "G43 H1", "S8000 M3", "G0 X0 Y0 Z5", "G1 Z-1 F300"]
TAIL = ["G0 Z50", "M5", "M2"]


def source(lines, name="p.nc", folder=None):
    return SourceText(name, ("\n".join(lines) + "\n").encode("utf-8", "surrogateescape"), folder)


def settings(text, dialect="linuxcnc", **more):
    return Settings(dialect=dialect, tool_table=assumed_tools(text), **more)


def long_program(count):
    return [*HEAD, *(f"G1 X{n % 97}.5 Y{n % 89}" for n in range(count)), *TAIL]


def state(moment):
    if moment is None:
        return None
    return [
        (one.state.current, one.state.feed, one.state.motion) for one in (moment.before, moment.after)
    ], moment.events


@pytest.mark.parametrize(("dialect", "count"), [("linuxcnc", 20_000), ("fanuc", 10_000), ("marlin", 20_000)])
def test_one_change_of_a_long_program_is_a_small_part_of_the_work(dialect, count):
    """After a change at most two stretches between copies are executed, for findings and for a hover."""
    lines = long_program(count)
    reading = LiveReading(source(lines), settings(source(lines), dialect))
    reading.finish()
    whole = reading.work

    lines[9_000] = "G1 X1.25 Y2 (changed)"
    reading.update(source(lines), settings(source(lines), dialect))
    reading.finish()
    again = reading.work
    moment = reading.moment(9_000)

    assert whole >= count
    assert again <= 2 * reading.every
    assert reading.work - again <= reading.every + 1
    assert moment.after.state.current[:2] == (1.25, 2.0)
    assert list(reading.findings) == list(lint(source(lines), settings(source(lines), dialect)))


def test_questions_cost_no_later_change_anything():
    lines = long_program(2_000)
    reading = LiveReading(source(lines), settings(source(lines)))
    reading.finish()
    for text in ("G1 X1", "G1 X2", "G1 X3"):
        lines[900] = text
        reading.update(source(lines), settings(source(lines)))
        reading.finish()
        assert reading.work <= 2 * reading.every
        reading.moment(900)


def test_findings_behind_a_change_stay_until_they_are_read_again():
    lines = long_program(5_000)
    lines[4_000] = "G1 X"
    reading = LiveReading(source(lines), settings(source(lines)))
    reading.finish()
    lines.insert(100, "G1 X3 F500")
    reading.update(source(lines), settings(source(lines)))
    reading.go_on(300)

    assert not reading.is_done
    assert [(one.code, one.span.line) for one in reading.findings] == [("GS004", 4_002)]
    reading.finish()
    assert [(one.code, one.span.line) for one in reading.findings] == [("GS004", 4_002)]


def test_a_loop_that_comes_to_the_change_again_is_read_again():
    lines = [*HEAD, "#1=0", "o1 while [#1 LT 9]", "#1=[#1+1]", "G1 X1", "o1 endwhile", "F[100/[#1-9]]", *TAIL]
    reading = LiveReading(source(lines), settings(source(lines)), every=1)
    reading.finish()
    lines[9] = "G1 X[1/[#1-5]]"
    reading.update(source(lines), settings(source(lines)))
    reading.finish()

    assert list(reading.findings) == list(lint(source(lines), settings(source(lines))))
    assert any(one.span.line == 10 for one in reading.findings)


def test_nothing_is_read_again_without_a_change():
    lines = long_program(100)
    reading = LiveReading(source(lines), settings(source(lines)))
    reading.finish()
    reading.update(source(lines), settings(source(lines)))

    assert reading.is_done
    assert reading.work == 0


def test_other_settings_read_everything_again():
    lines = long_program(1_000)
    reading = LiveReading(source(lines), settings(source(lines)))
    reading.finish()
    reading.update(source(lines), replace(settings(source(lines)), block_delete=True))
    reading.finish()

    assert reading.work > 1_000


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("(nothing)", "G76 P1 Z-26 I-3 J0.9 K2"),  # this is for a lathe
        ("G76 P1 Z-26 I-3 J0.9 K2", "(nothing)"),
        ("(nothing)", "CYCLE832(0.1)"),  # this is for a Sinumerik
        ("CYCLE832(0.1)", "(nothing)"),
    ],
)
def test_what_shows_only_in_the_whole_program_is_told_from_its_beginning(before, after):
    lines = ["G18 G90 G21", "G0 X10 Z2", "G1 Xb F100", *["G1 X10", "G1 X20"] * 200, before, "M2"]
    text = source(lines)
    reading = LiveReading(text, settings(text, "linuxcnc"))
    reading.finish()
    lines[-2] = after
    text = source(lines)
    reading.update(text, settings(text, "linuxcnc"))
    reading.finish()

    assert list(reading.findings) == list(lint(text, settings(text, "linuxcnc")))


def changed(lines, pool, pick):
    """The lines after one stroke of an editor."""
    lines = list(lines)
    at = pick.randrange(len(lines))
    stroke = pick.randrange(5)
    if stroke == 0:
        lines[at] = pick.choice(pool)
    elif stroke == 1:
        lines.insert(at, pick.choice(pool))
    elif stroke == 2 and len(lines) > 1:
        del lines[at]
    elif stroke == 3 and lines[at]:
        place = pick.randrange(len(lines[at]))
        lines[at] = lines[at][:place] + pick.choice("0123456789XYZ.#[](GM ") + lines[at][place + 1 :]
    else:
        lines[at] += pick.choice([" (x)", " F100", "X1", "1", ""])
    return lines


def random_strokes(seed, programs):
    """Programs of the corpus under random changes: findings are those of `lint`, states those of a fresh reading."""
    pick = random.Random(seed)
    corpus = TESTS / "data/conformance"
    paths = [path for path in sorted(corpus.glob("*/*/*.ngc")) if path.stat().st_size < 20_000]
    pool = [line for path in paths[::7] for line in SourceText.read(path).lines]
    work = whole = 0
    for _ in range(programs):
        path = pick.choice(paths)
        dialect = pick.choice(
            ["fanuc", "fanuc_lathe"] if "fanuc" in path.parts else ["linuxcnc", "linuxcnc", "grbl", "marlin"]
        )
        how = {"max_blocks": 3_000, "subroutines": (corpus / "rs274/subs",)}
        lines = list(SourceText.read(path).lines)
        first = source(lines, path.name, path.parent)
        reading = LiveReading(first, settings(first, dialect, **how), every=pick.choice([1, 3, 10, 50]))
        reading.finish()
        for _ in range(6):
            lines = changed(lines, pool, pick)
            text = source(lines, path.name, path.parent)
            reading.update(text, settings(text, dialect, **how))
            if pick.random() < 0.2:  # the next stroke comes before the end
                reading.go_on(20)
                continue
            reading.finish()
            fresh = LiveReading(text, settings(text, dialect, **how))
            fresh.finish()
            work, whole = work + reading.work, whole + fresh.work
            where = f"seed {seed}, {path.name} as {dialect}"
            assert list(reading.findings) == list(lint(text, settings(text, dialect, **how))), where
            for line in pick.sample(range(len(lines)), min(2, len(lines))):
                assert state(reading.moment(line)) == state(fresh.moment(line)), f"{where}, line {line + 1}"
    return work, whole


def test_random_strokes():
    work, whole = random_strokes(1, 12)

    assert work < whole


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2, 8))
def test_many_random_strokes(seed):
    random_strokes(seed, 200)


def test_a_change_among_branches_looks_at_few_lines_again():
    """What an O-word says, and what is broken in a line that is passed over, is known of all lines that stayed."""
    lines = ["#1=1", *(text for n in range(300) for text in (f"o{n} if [#1 GT 2]", "G1 X1", f"o{n} endif")), *TAIL]
    reading = LiveReading(source(lines), settings(source(lines)))
    reading.finish()
    counts = [_o_word.cache_info().misses, _defect_of.cache_info().misses]
    lines[450] = "G0 X7"
    reading.update(source(lines), settings(source(lines)))
    reading.finish()

    assert [_o_word.cache_info().misses, _defect_of.cache_info().misses] == counts
    assert list(reading.findings) == list(lint(source(lines), settings(source(lines))))
