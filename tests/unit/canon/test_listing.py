"""The listing: units of the shop floor, no negative zero, every kind printable."""

import json
import math

from gcodesim import canon
from gcodesim.canon import listing
from gcodesim.diagnostics import Span

SPAN = Span("p.ngc", 3, 1, 3, 5)


def test_units_are_mm_degrees_and_per_minute():
    event = canon.LinearFeed(span=SPAN, end=(0.01, 0.0, -0.0, math.pi / 2, 0.0, 0.0), feed=0.1 / 60)

    assert listing.as_json(event) == {
        "kind": "line",
        "end": [10, 0, 0, 90, 0, 0],
        "feed": 100,
        "feed_unit": "mm/min",
        "line": 3,
    }


def test_no_negative_zero_is_printed():
    text = json.dumps(listing.as_json(canon.Rapid(span=SPAN, end=(-0.0, -1e-15, 0.0, 0.0, 0.0, -0.0))))

    assert "-0" not in text


def test_threading_has_a_pitch_and_no_feed():
    fields = listing.as_json(canon.LinearFeed(span=SPAN, end=canon.events.ZERO_AXES, feed=0.0, pitch=1.5e-3))

    assert fields["pitch"] == 1.5
    assert "feed" not in fields


def test_every_event_can_be_printed():
    """A new event needs a line in the listing."""
    kinds = {cls for cls in vars(canon.events).values() if isinstance(cls, type) and issubclass(cls, canon.Event)}

    assert kinds - {canon.Event, canon.Move} == set(listing._KINDS)


def test_text_form_is_one_line():
    event = canon.ArcFeed(
        span=SPAN,
        end=(0.01, 0, 0, 0, 0, 0),
        center=(0.005, 0, 0),
        normal=(0, 0, 1),
        ccw=True,
        turns=1,
        sweep=math.pi,
        feed=1e-3,
    )

    expected = "3 arc X10 Y0 Z0 center=(5, 0, 0) normal=(0, 0, 1) ccw=yes turns=1 sweep=180 feed=60 feed_unit=mm/min"
    assert " ".join(listing.as_text(event).split()) == expected


def test_the_listing_says_ok_or_error():
    assert listing.listing([])["status"] == "ok"
    assert listing.listing([], ("bad", 4)) == {"status": "error", "error": {"message": "bad", "line": 4}, "events": []}
